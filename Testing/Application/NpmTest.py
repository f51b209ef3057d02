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
    "no pictures and HTML reports": (
        "BemElectrodesTest.Electrodes.test_a_page_shows_them",
        "BemSurfacesTest.Surfaces.test_what_cannot_be_guaranteed_gives_the_report_alone_and_says_where",
        "CheckNotesTest.Notes.test_text_and_page_tell_them_and_quiet_does_not", "CheckTest.Readme.test_examples_run",
        "CheckTest.Profiles.test_walls_are_measured_for_a_printer", "InfoTest.Page",
        "CompareTest.Readme.test_examples_run", "InfoTest.Info.test_ends_with_commands_that_make_surfaces_of_this_input",
        "LabelsTest.OutputTest.test_another_image_behind_the_regions", "LabelsTest.OutputTest.test_report_page",
        "SelfTestTest.SelfTest.test_measures_and_passes",
        "SimplifyTest.Reports.test_a_page_tells_what_was_read_from_what_was_written", "SimplifyTest.Reports.test_pages",
        "SimplifyTest.Reports.test_keys_are_the_documented_ones",
        "WarningsTest.Warnings.test_strict_writes_reports_and_no_surface"),
    "no child processes: meshers and batches": (
        "BemTetrahedraTest.Tetrahedra.test_a_hole_in_the_skull_stays_open",
        "BemTetrahedraTest.Tetrahedra.test_a_size_that_the_surfaces_do_not_allow_is_noted",
        "BemTetrahedraTest.Tetrahedra.test_meshio_reads_all_formats_alike",
        "BemTetrahedraTest.Tetrahedra.test_a_mesher_that_fails_is_told",
        "BemTetrahedraTest.Tetrahedra.test_a_signal_leaves_neither_files_nor_the_mesher",
        "BemTetrahedraTest.Tetrahedra.test_meshers_fill_the_layers",
        "BemTetrahedraTest.Tetrahedra.test_the_files_for_duneuro_hold_the_same",
        "LabelsTest.BatchTest.test_many_inputs", "MistakesTest.Batches",
        "MistakesTest.Reports.test_of_batches_are_alike_for_each_input",
        "MistakesTest.Resources.test_one_thread_where_no_process_may_start",
        "SimplifyDataTest.FreeSurfer.test_in_a_batch_each_has_its_own", "SimplifyTest.Batches",
        "WarningsTest.Allowed.test_batches_hand_them_on", "WarningsTest.Batches"),
    "no MATLAB files": (
        "BemElectrodesTest.Electrodes.test_brainstorms_coordinates", "BemTest.Model.test_four_layers"),
    "no oneTBB": ("CommandLineTest.Help.test_version_names_the_library_of_threads",),
    "runs adaptiso-bids and adaptiso-giant too": (
        "CommandLineTest.Help.test_h_is_one_screen_with_every_option",
        "CommandLineTest.Help.test_readmes_name_the_options_of_every_program",
        "CommandLineTest.Help.test_version_has_the_same_letter_in_every_program",
        "CommandLineTest.OneCommand.test_starts_each_program", "MistakesTest.Mistakes.test_a_folder_in_a_files_place",
        "MistakesTest.Mistakes.test_a_pipe_in_a_files_place", "MistakesTest.Mistakes.test_an_input_that_is_not_there",
        "MistakesTest.Mistakes.test_an_output_whose_name_is_taken", "MistakesTest.Mistakes.test_no_input",
        "MistakesTest.Mistakes.test_unknown_and_incomplete_options", "MistakesTest.Reports.test_of_runs_that_pass_begin_alike"),
}

#: Fewer that pass are a failure: a package that is not tried must not look tried.
FEWEST = 150


def cases(suite):
    for part in suite:
        if isinstance(part, unittest.TestSuite):
            yield from cases(part)
        else:
            yield part


class Result(unittest.TextTestResult):
    """Counts tests that pass as a whole; failed subtests are many for one test."""
    passed = 0

    def addSuccess(self, test):
        super().addSuccess(test)
        self.passed += 1


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
        import WordsTest  # a batch is refused before its folder is looked at
        WordsTest.WRONG[:] = [row for row in WordsTest.WRONG if "--output-dir" not in row[3]]
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
        result = unittest.TextTestRunner(verbosity=2, resultclass=Result).run(suite)
    print(f"{result.passed} tests passed on the npm package, {len(every) - suite.countTestCases()} left out", file=sys.stderr)
    return 0 if result.wasSuccessful() and (files or result.passed >= FEWEST) else 1


if __name__ == "__main__":
    if NODE is None or not STARTER.exists():
        print("skipped: Applications/web/run.sh has built no WebAssembly here", file=sys.stderr)
        sys.exit(77)
    sys.exit(main(sys.argv[1:]))
