"""Writes the bill of materials of programs as an SPDX 2.3 document (JSON).

    sbom.py NAME VERSION SUPPLIER FACTS.json OUTPUT PROGRAM...

Which libraries are linked is read from the programs themselves (readelf, ldd), and which Debian
packages these are, with their versions, from dpkg. FACTS.json says what a linked program no longer
shows: {"headers": [Debian package, ...], "tools": [Debian package, ...], "bundled": [{"name",
"version", "license", "url", "purl", "sha512"}, ...], "licenses": {Debian source package: SPDX
expression}}.

The same programs on the same Debian give the same bytes; the time of creation is what
SOURCE_DATE_EPOCH says, else now. Python's standard library only.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
import time
from datetime import datetime, timezone
from pathlib import Path


def output(*command):
    return subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE,
                          env={**os.environ, "LC_ALL": "C"}).stdout


def needed(file):
    """Names of the libraries that `file` itself asks for."""
    return re.findall(r"\(NEEDED\).*\[(.+)\]", output("readelf", "-dW", str(file)))


def resolved(program):
    """Where the loader finds each library that `program` takes, also by way of others."""
    found = dict(re.findall(r"^\s*(\S+) => (/\S+)", output("ldd", str(program)), re.MULTILINE))
    missing = re.findall(r"^\s*(\S+) => not found", output("ldd", str(program)), re.MULTILINE)
    if missing:
        raise SystemExit(f"sbom.py: {program}: {', '.join(missing)} not found")
    for loader in re.findall(r"^\s*(/\S+) \(0x", output("ldd", str(program)), re.MULTILINE):
        found[Path(loader).name] = loader
    return found


def package_names(paths):
    """The Debian package of each path; dpkg knows some under the folder that /lib stands for."""
    asked = {}
    for path in paths:
        real = os.path.realpath(path)
        for name in {path, real, real.removeprefix("/usr"), "/usr" + path}:
            asked[name] = path
    told = subprocess.run(["dpkg-query", "-S", *sorted(asked)], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, env={**os.environ, "LC_ALL": "C"}).stdout
    found = {}
    for line in told.splitlines():
        names, separator, path = line.rpartition(": ")
        if separator and path in asked and not line.startswith("diversion "):
            found[asked[path]] = names.split(",")[0].split(":")[0]
    return found


def debian(name, licenses):
    """The SPDX package of an installed Debian package."""
    asked = ["dpkg-query", "-W", "-f", "${Status}|${Package}|${Version}|${Architecture}|"
             "${source:Package}|${Maintainer}\n", name]
    told = subprocess.run(asked, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
    lines = [line for line in told.splitlines() if line.startswith("install ok installed|")]
    if not lines:
        return {**foreign(name), "comment": "not from a Debian package"}
    _, package, version, architecture, source, maintainer = sorted(lines)[0].split("|", 5)
    quoted = version.replace("+", "%2B").replace(":", "%3A").replace("~", "~")
    license_ = licenses.get(source, "NOASSERTION")
    return {"SPDXID": spdx_id(package), "name": package, "versionInfo": version,
            "supplier": "Organization: Debian",
            "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "sourceInfo": f"Debian source package {source}; maintained by {maintainer}",
            "licenseConcluded": "NOASSERTION", "licenseDeclared": license_,
            "copyrightText": "NOASSERTION",
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                              "referenceLocator":
                              f"pkg:deb/debian/{package.replace('+', '%2B')}@{quoted}"
                              f"?arch={architecture}"}]}


def foreign(name):
    """The SPDX package of what Debian's packages do not say."""
    return {"SPDXID": spdx_id(name), "name": name, "supplier": "NOASSERTION",
            "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION",
            "copyrightText": "NOASSERTION"}


def library(path):
    """The SPDX package of a linked library that is in no Debian package."""
    return {**foreign(Path(path).name), "primaryPackagePurpose": "LIBRARY",
            "checksums": [{"algorithm": "SHA256",
                           "checksumValue": hashlib.sha256(Path(path).read_bytes()).hexdigest()}]}


def bundled(facts):
    """The SPDX package of what is built into the programs."""
    return {"SPDXID": spdx_id(facts["name"]), "name": facts["name"],
            "versionInfo": facts["version"], "supplier": "NOASSERTION",
            "downloadLocation": facts["url"], "filesAnalyzed": False,
            "checksums": [{"algorithm": "SHA512", "checksumValue": facts["sha512"]}],
            "licenseConcluded": "NOASSERTION", "licenseDeclared": facts["license"],
            "copyrightText": "NOASSERTION",
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                              "referenceLocator": facts["purl"]}]}


def spdx_id(name):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", name.replace("+", "p")).strip("-")


def links(programs):
    """(packages that the programs ask for themselves, what package asks for what package, paths of
    libraries that are in no package: their names stand for packages)."""
    where = {}
    for program in programs:
        where.update(resolved(program))
    names = package_names(sorted(set(where.values())))
    unknown = sorted(set(where.values()) - set(names))
    names.update({path: Path(path).name for path in unknown})
    of = {library: names[path] for library, path in where.items()}
    direct = {of[library] for program in programs for library in needed(program) if library in of}
    edges = {(names[path], of[library]) for path in sorted(set(where.values()))
             for library in needed(path) if library in of and of[library] != names[path]}
    return direct, edges, unknown


def relationship(element, kind, related):
    return {"spdxElementId": element, "relationshipType": kind, "relatedSpdxElement": related}


def document(name, version, supplier, facts, programs):
    direct, edges, unknown = links(programs)
    own = spdx_id(name)
    linked = direct | {package for edge in edges for package in edge}
    described = {
        "SPDXID": own, "name": name, "versionInfo": version,
        "supplier": f"Organization: {supplier}", "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False, "primaryPackagePurpose": "APPLICATION",
        "licenseConcluded": "Apache-2.0", "licenseDeclared": "Apache-2.0",
        "copyrightText": "2026 the adaptiso developers",
        "comment": "The programs " + ", ".join(sorted(Path(p).name for p in programs)) + "."}
    debs = sorted((linked | set(facts["headers"]) | set(facts["tools"]))
                  - {Path(path).name for path in unknown})
    packages = [described, *(debian(deb, facts["licenses"]) for deb in debs),
                *map(library, unknown),
                *map(bundled, facts["bundled"])]
    relations = [relationship("SPDXRef-DOCUMENT", "DESCRIBES", own)]
    relations += [relationship(own, "DYNAMIC_LINK", spdx_id(deb)) for deb in sorted(direct)]
    relations += [relationship(spdx_id(a), "DEPENDS_ON", spdx_id(b)) for a, b in sorted(edges)]
    relations += [relationship(own, "STATIC_LINK", spdx_id(deb))
                  for deb in sorted(facts["headers"])]
    relations += [relationship(own, "CONTAINS", spdx_id(part["name"])) for part in facts["bundled"]]
    relations += [relationship(spdx_id(deb), "BUILD_TOOL_OF", own) for deb in sorted(facts["tools"])]
    content = hashlib.sha256(json.dumps([packages, relations], sort_keys=True).encode()).hexdigest()
    moment = datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())),
                                    timezone.utc)
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
            "name": f"{name}-{version}",
            "documentNamespace": f"https://example.org/adaptiso/spdx/{name}-{version}-{content}",
            "creationInfo": {"created": moment.strftime("%Y-%m-%dT%H:%M:%SZ"),
                             "creators": [f"Organization: {supplier}", "Tool: sbom.py"]},
            "packages": packages, "relationships": relations}


def main():
    name, version, supplier, facts, path, *programs = sys.argv[1:]
    made = document(name, version, supplier, json.loads(Path(facts).read_text()), programs)
    Path(path).write_text(json.dumps(made, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
