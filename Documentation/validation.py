"""Makes Validation.md: what is claimed, the tests that hold it, and what came of them.

    validation.py SOURCE --results JUNIT.xml --version VERSION --system TEXT --date YYYY-MM-DD
    validation.py SOURCE --check

SOURCE is the folder of the sources. The claims are in Documentation/validation.toml. JUNIT.xml is what
`ctest --output-junit` writes; a test that did not run there is told as such, and exit code 1 says that
one failed. --check changes nothing: it exits with 1, and a line for each fault, when a test that is
named is not there, or when the page is not what the claims make. Python's standard library only.
"""

import argparse
import re
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

GOOGLE_TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", re.MULTILINE)
SCRIPT = re.compile(r"^adaptiso_(application|package)_test\((\w+)\)", re.MULTILINE)
RUN = re.compile(r"^Made from (?P<told>.+)\.$", re.MULTILINE)
PASSED, FAILED, NOT_RUN = "passed", "**failed**", "not run"


def sources(top):
    """{name of a test: path of its source from `top`}."""
    found = {}
    for path in sorted((top / "Testing").rglob("*.cxx")):
        for suite, name in GOOGLE_TEST.findall(path.read_text(encoding="utf-8")):
            found[f"{suite}.{name}"] = path.relative_to(top)
    for kind, folder, prefix in (("application", "Application", "Application"),
                                 ("package", "Package", "package")):
        lists = (top / "Testing" / folder / "CMakeLists.txt").read_text(encoding="utf-8")
        for called, name in SCRIPT.findall(lists):
            path = top / "Testing" / folder / f"{name}.py"
            if called == kind and path.exists():
                found[f"{prefix}.{name}"] = path.relative_to(top)
    return found


def plain(name):
    """A test's name without what an instantiation adds: "All/Suite.Name/adaptive"."""
    suite, _, test = name.partition(".")
    return f"{suite.rpartition('/')[2]}.{test.partition('/')[0]}" if test else name


def results(junit):
    """{plain name: passed, failed or not run}; of several instances the worst."""
    found = {}
    for case in ElementTree.parse(junit).iter("testcase"):
        skipped = case.find("skipped") is not None or case.get("status") in ("notrun", "disabled")
        outcome = (FAILED if case.find("failure") is not None or case.find("error") is not None
                   else NOT_RUN if skipped else PASSED)
        found.setdefault(plain(case.get("name")), set()).add(outcome)
    return {name: next(outcome for outcome in (FAILED, NOT_RUN, PASSED) if outcome in outcomes)
            for name, outcomes in found.items()}


def all_tests(claims):
    return [test for section in claims["section"] for claim in section.get("claim", [])
            for test in claim["tests"]]


def page(claims, where, outcomes, run):
    """The page. `outcomes`: by test; `run`: "CTest's results of ...", or None."""
    lines = [f"# {claims['title']}", claims["intro"].strip(), ""]
    tests = sorted(set(all_tests(claims)))
    if run:
        lines += [f"Made from {run}.", ""]
    for section in claims["section"]:
        lines += [f"## {section['title']}", section["text"].strip(), ""]
        if "claim" not in section:
            continue
        lines += ["| claim | accepted when | held by |", "|---|---|---|"]
        for claim in section["claim"]:
            held = "<br>".join(f"[{test}](../{where[test].as_posix()}): "
                               f"{outcomes.get(test, NOT_RUN)}" for test in claim["tests"])
            lines.append(f"| {claim['claim']} | {claim['accepted']} | {held} |")
        lines.append("")
    return "\n".join(lines).rstrip() + "\n", tests


def told_outcomes(text):
    """What a page says of each test, by name."""
    return dict(re.findall(r"\[([\w.]+)\]\(\.\./Testing/[^)]+\): (passed|\*\*failed\*\*|not run)",
                           text))


def check(claims, where, path):
    faults = [f"{test}: there is no such test" for test in sorted(set(all_tests(claims)))
              if test not in where]
    if not faults:
        text = path.read_text(encoding="utf-8")
        run = RUN.search(text)
        made, _ = page(claims, where, told_outcomes(text), run and run["told"])
        if made != text:
            faults.append(f"{path.name} is not what validation.toml makes: "
                          "cmake --build --preset release --target validation")
        faults += [f"{path.name} says that {test} failed"
                   for test, outcome in told_outcomes(text).items() if outcome == FAILED]
    return faults


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("source", type=Path)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--results", type=Path)
    for name in ("version", "system", "date"):
        parser.add_argument(f"--{name}", default="not said")
    given = parser.parse_args()
    claims = tomllib.loads((given.source / "Documentation" / "validation.toml")
                           .read_text(encoding="utf-8"))
    where = sources(given.source)
    path = given.source / "Documentation" / "Validation.md"
    if given.check:
        faults = check(claims, where, path)
        print("\n".join(faults) or f"{path.name} is in step")
        return 1 if faults else 0
    missing = sorted(set(all_tests(claims)) - set(where))
    if missing:
        raise SystemExit("validation.py: no such test: " + ", ".join(missing))
    outcomes = results(given.results)
    tests = sorted(set(all_tests(claims)))
    counts = {word: sum(outcomes.get(test, NOT_RUN) == word for test in tests)
              for word in (PASSED, FAILED, NOT_RUN)}
    run = (f"CTest's results of adaptiso {given.version}, {given.date}, {given.system}: "
           f"of {len(tests)} tests named here {counts[PASSED]} passed, {counts[FAILED]} failed, "
           f"{counts[NOT_RUN]} did not run")
    path.write_text(page(claims, where, outcomes, run)[0], encoding="utf-8")
    print(run)
    return 1 if counts[FAILED] else 0


if __name__ == "__main__":
    sys.exit(main())
