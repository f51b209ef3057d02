"""The application tests on the npm package's programs under Node, in the place of the native ones.

    NpmTest.py [FILE...]     CheckTest, CompareTest, ...; all of TESTS unless named

Builds nothing: skipped where Applications/web/run.sh has built nothing. ADAPTISO_WEB names another build,
ADAPTISO_NODE another Node."""

import os
import shutil
import stat
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ["ADAPTISO_SOURCE"])
STARTER = Path(os.environ.get("ADAPTISO_WEB", SOURCE / "build/web")) / "npm/adaptiso/bin.mjs"
NODE = os.environ.get("ADAPTISO_NODE", shutil.which("node"))
PROGRAMS = ("bem", "check", "compare", "labels", "mesh", "simplify")

#: What the package's programs are tested by; the others are of batches, BIDS, adaptiso-giant, pages, ITK and kills.
TESTS = ("BemElectrodesTest", "BemSurfacesTest", "BemTest", "BemTetrahedraTest", "CheckDefectsTest", "CheckInputTest",
         "CheckNotesTest", "CheckTest", "CommandLineTest", "CompareInputTest", "CompareTest", "CountTest", "DicomTest",
         "InfoTest", "InputTest", "LabelsTest", "MistakesTest", "OutputTest", "PhantomTest", "PreprocessTest",
         "ReportTest", "SearchTest", "SelfTestTest", "SimplifyDataTest", "SimplifyTest", "WarningsTest", "WordsTest")

#: Tests that the package cannot pass, by the reason; "CheckTest" or "CheckTest.Truth" stands for all of it.
LEFT_OUT = {
    "no resampling": (),
    "no pictures and HTML reports": (),
    "no child processes": (),
}

#: Fewer that pass are a failure: a package that is not tried must not look tried.
FEWEST = 150


def cases(suite):
    for part in suite:
        if isinstance(part, unittest.TestSuite):
            yield from cases(part)
        else:
            yield part


def write_launchers(folder):
    """The programs by their native names."""
    for name, first in [("adaptiso", ""), *((f"adaptiso-{program}", program) for program in PROGRAMS)]:
        launcher = folder / name
        launcher.write_text(f'#!/bin/sh\nexec "{NODE}" "{STARTER}" {first} "$@"\n')
        launcher.chmod(launcher.stat().st_mode | stat.S_IXUSR)


def main(files):
    with tempfile.TemporaryDirectory(prefix="adaptiso-npm-") as folder:
        write_launchers(Path(folder))
        os.environ["ADAPTISO_BIN"] = folder
        sys.path.insert(0, str(Path(__file__).parent))
        every = list(cases(unittest.defaultTestLoader.loadTestsFromNames(files or TESTS)))
        reasons = {name: reason for reason, names in LEFT_OUT.items() for name in names}
        unknown = [name for name in reasons if name.split(".")[0] in (files or TESTS)
                   and not any(f"{case.id()}.".startswith(f"{name}.") for case in every)]
        if unknown:
            sys.exit(f"NpmTest.py: LEFT_OUT names tests that are not there: {', '.join(unknown)}")
        suite = unittest.TestSuite()
        for case in every:
            reason = next((reason for name, reason in reasons.items() if f"{case.id()}.".startswith(f"{name}.")), None)
            if reason is None:
                suite.addTest(case)
            else:
                print(f"left out: {case.id()}: {reason}", file=sys.stderr)
        result = unittest.TextTestRunner(verbosity=2).run(suite)
    passed = result.testsRun - len(result.failures) - len(result.errors) - len(result.skipped)
    print(f"{passed} tests passed on the npm package, {len(every) - suite.countTestCases()} left out", file=sys.stderr)
    return 0 if result.wasSuccessful() and (files or passed >= FEWEST) else 1


if __name__ == "__main__":
    if NODE is None or not STARTER.exists():
        print("skipped: Applications/web/run.sh has built no WebAssembly here", file=sys.stderr)
        sys.exit(77)
    sys.exit(main(sys.argv[1:]))
