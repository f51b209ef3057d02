"""Makes the site: the pages of the sources, the reference of the headers and of the Python package, with search.

    site.py SOURCE BUILD VERSION [PYTHON]

SOURCE is the folder of the sources, BUILD one of its own: BUILD/xml holds what Doxygen made, BUILD/html gets the
site. PYTHON is the folder that `import adaptiso` is found in; without it the site has no reference of Python. A
link that leads nowhere and every other warning of Sphinx is an error. A page that index.md.in does not list comes last. Pages are
copied; links from them to files that are no pages become plain text.
"""

import csv
import fnmatch
import os
import re
import shutil
import subprocess
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "Applications/*/README.md",
         "Applications/web/npm/README.md", "Data/README.md",
         "Examples/README.md", "Examples/*/README.md", "Documentation/*.md", "Documentation/Decisions/*.md",
         "Testing/Benchmark/README.md", "Testing/Fuzz/README.md", "Wrapping/Python/README.md",
         "Modules/Extraction/src/adaptive/README.md")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
TABLE = re.compile(r"(?m)^\{([\w-]+)\}$")


def linked(text, page, source, pages):
    """The text with its links as the site has them; a link to a file that is not there is an error."""
    def link(found):
        picture, words, target = found.groups()
        name, mark, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target) or not name:
            return found.group()
        path = (page.parent / name).resolve()
        if not path.exists():
            raise SystemExit(f"{page.relative_to(source)}: {target}: there is no such file")
        if path.is_dir() and (path / "README.md") in pages:
            return f"[{words}]({name.rstrip('/')}/README.md)"
        return found.group() if picture or path in pages else words
    parts = re.split(r"(?ms)(^```.*?^```$)", text)
    return "".join(part if part.startswith("```") else LINK.sub(link, part) for part in parts)


def appendix(folder):
    """The tables of Documentation/benchmarks as one page, with what appendix.toml says of them."""
    def table(found):
        with (folder / f"{found[1]}.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        rows.insert(1, ["---"] * len(rows[0]))
        return f"*{found[1]}*\n\n" + "\n".join("| " + " | ".join(row) + " |" for row in rows)

    told = tomllib.loads((folder / "appendix.toml").read_text(encoding="utf-8"))["section"]
    named = {name for section in told for name in TABLE.findall(section["text"])}
    unnamed = {path.stem for path in folder.glob("*.csv")} - named
    if unnamed:
        raise SystemExit(f"appendix.toml names no {', '.join(sorted(unnamed))}")
    lines = ["# Appendix: all measurements", "The tables behind [Benchmarks](Benchmarks.md).", ""]
    for section in told[1:]:
        lines += ["#" * section["level"] + " " + section["title"], TABLE.sub(table, section["text"]), ""]
    lines[2:2] = [told[0]["text"], ""]
    return "\n".join(lines)


def headers(source):
    """{module: its public headers}."""
    found = {}
    for path in sorted(source.glob("Modules/*/include/adaptiso/*/*.h")):
        found.setdefault(path.parent.name, []).append(path.relative_to(path.parents[2]).as_posix())
    return found


def by_header(xml):
    """Changes Doxygen's XML to what Breathe shows header by header: functions of the namespace stand in their
    headers, as structs do; an exception has an entry of its own."""
    trees = {path: ElementTree.ElementTree(ElementTree.fromstring(re.sub(  # 1'000
        r"(?<=\d) (?:'|&apos;)(?=\d)", "'", path.read_text(encoding="utf-8")))) for path in sorted(xml.glob("*.xml"))}
    sections = {}  # {header's path: {kind: members}}
    for path, tree in trees.items():
        if not path.name.startswith("namespaceadaptiso"):
            continue
        for section in tree.iter("sectiondef"):
            for member in section.iter("memberdef"):
                header = member.find("location").get("file")
                sections.setdefault(header, {}).setdefault(section.get("kind"), []).append(member)
    for path, tree in trees.items():
        for compound in tree.iter("compounddef"):
            if compound.get("kind") != "file":
                continue
            for inner in compound.findall("innernamespace"):
                compound.remove(inner)
            at = list(compound).index(compound.find("location"))
            for kind, members in sections.get(compound.find("location").get("file"), {}).items():
                section = ElementTree.Element("sectiondef", kind=kind)
                section.extend(members)
                compound.insert(at, section)
        for exceptions in tree.iterfind(".//parameterlist[@kind='exception']"):
            for item in list(exceptions):
                for extra in item.findall("parameternamelist/parametername")[1:]:
                    item.find("parameternamelist").remove(extra)
                    alone = ElementTree.SubElement(exceptions, "parameteritem")
                    ElementTree.SubElement(alone, "parameternamelist").append(extra)
                    alone.append(item.find("parameterdescription"))
        tree.write(path, encoding="utf-8", xml_declaration=True)


def titled(text, line="="):
    return f"{text}\n{line * len(text)}\n\n"


def assemble(source, site, python):
    pages = [page for pattern in PAGES for page in sorted(source.glob(pattern))]
    for page in pages:
        copy = site / page.relative_to(source)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text(linked(page.read_text(encoding="utf-8"), page, source, set(pages)), encoding="utf-8")
    for picture in [*source.glob("Documentation/*.png"), *source.glob("Documentation/*.svg"),
                    *source.glob("Documentation/gallery/*.png")]:
        (site / picture.relative_to(source)).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(picture, site / picture.relative_to(source))
    here = source / "Documentation" / "site"
    (site / "_static").mkdir()
    shutil.copy(here / "site.css", site / "_static")
    shutil.copy(here / "conf.py", site)
    index = (here / "index.md.in").read_text(encoding="utf-8")  # its links are those of the site
    names = [page.relative_to(source).with_suffix("").as_posix() for page in pages]
    listed = [line for line in index.splitlines() if re.fullmatch(r"[\w/*.-]+", line)]
    more = [name for name in names if not any(fnmatch.fnmatch(name, line) for line in listed)]
    if more:
        index += "\n".join(["", "```{toctree}", ":caption: More", ":maxdepth: 1", *more, "```", ""])
    (site / "index.md").write_text(index, encoding="utf-8")
    page = source / "Documentation" / "Appendix.md"
    (site / "Documentation" / "Appendix.md").write_text(
        linked(appendix(source / "Documentation" / "benchmarks"), page, source, {*pages, page}), encoding="utf-8")
    by_header(site.parent / "xml")
    modules = headers(source)
    (site / "cpp").mkdir()
    for module, files in modules.items():
        (site / "cpp" / f"{module}.rst").write_text(titled(module) + "".join(
            titled(file.rpartition("/")[2], "-") + f"``#include \"{file}\"``\n\n.. doxygenfile:: {file}\n   :sections: briefdescription detaileddescription innerclass enum func typedef var\n\n"
            for file in files), encoding="utf-8")
    (site / "cpp" / "index.rst").write_text(
        titled("C++ reference") + "By module; the folder of a header is its module.\n\n.. toctree::\n\n"
        + "".join(f"   {module}\n" for module in modules), encoding="utf-8")
    (site / "python.rst").write_text(
        titled("Python reference") + (".. automodule:: adaptiso\n   :members:\n   :imported-members:\n   :exclude-members: giant\n\n.. automodule:: adaptiso.giant\n   :members:\n"
                                      if python else "This site was made without the Python package.\n"), encoding="utf-8")


def take_normalize(html):
    """Debian's furo imports normalize.css from /javascript, an alias of its web server."""
    alias = "/javascript/normalize.css/normalize.css"
    for style in (html / "_static" / "styles").glob("*.css"):
        text = style.read_text(encoding="utf-8")
        if alias in text:
            shutil.copy(f"/usr/share{alias}", html / "_static")
            style.write_text(text.replace(alias, "../normalize.css"), encoding="utf-8")


def main():
    source, build, version, *python = sys.argv[1:]
    source, build = Path(source).resolve(), Path(build).resolve()
    site = build / "pages"
    shutil.rmtree(site, ignore_errors=True)
    site.mkdir(parents=True)
    assemble(source, site, python)
    code = subprocess.run([sys.executable, "-m", "sphinx", "-q", "-E", "-W", "--keep-going", "-b", "html", "-d", build / "doctrees", site, build / "html"],
                          env={**os.environ, "ADAPTISO_VERSION": version, "ADAPTISO_XML": str(build / "xml"),
                               "ADAPTISO_PYTHON": python[0] if python else ""}).returncode
    take_normalize(build / "html")
    return code


if __name__ == "__main__":
    sys.exit(main())
