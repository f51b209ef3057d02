"""Warnings: on stderr and in the reports unless --no-warnings is given; failures with --strict."""

import json
import re
import struct
import subprocess
import unittest

from support import (BAD_INPUT, BIN, CHECK_FAILED, OK, SOURCE, ApplicationTest, ball, lines, main,
                     write_nifti)
from bemSupport import QUICK, LABELS
from headDefects import icosphere, write_off

CONFLICT = r"ball.nii: .*qform.*sform|ball.nii: .*sform.*qform"


def write_conflict(path, image):
    """A NIfTI file whose qform, moved by 50 mm, contradicts its sform."""
    write_nifti(path, image)
    content = bytearray(path.read_bytes())
    struct.pack_into("<2h", content, 252, 1, 1)
    struct.pack_into("<3f", content, 268, 50, 0, 0)
    path.write_bytes(content)


class WithWarnings(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_conflict(self.path("ball.nii"), ball(12, 4))
        write_nifti(self.path("good.nii"), ball(12, 4))
        write_off(self.path("bare.off"), icosphere(40), None)
        write_off(self.path("ras.off"), icosphere(40))

    def run_program(self, program, *arguments):
        return subprocess.run([BIN / program, *map(str, arguments)], cwd=self.folder, text=True,
                              capture_output=True, timeout=300)


class Warnings(WithWarnings):
    # each: program, arguments that bring about one warning, what it says
    RUNS = (("adaptiso-mesh", ("ball.nii", "--iso", "100", "-o", "a.vtp"), CONFLICT),
            ("adaptiso-mesh", ("ball.nii", "--info"), CONFLICT),
            ("adaptiso-check", ("ras.off", "--volume", "ball.nii"), CONFLICT),
            ("adaptiso-compare", ("bare.off", "bare.off"),
             "bare.off and bare.off don't say their coordinate frame"),
            ("adaptiso-simplify", ("ras.off", "--triangles", "2", "-o", "small.vtp"),
             "small.vtp: "))

    def test_are_told_with_the_files_name_also_when_quiet(self):
        for program, arguments, pattern in self.RUNS:
            for quiet in ((), ("--quiet",)):
                with self.subTest((program, quiet)):
                    done = self.run_program(program, *arguments, *quiet)
                    self.assertEqual(done.returncode, OK, done.stderr)
                    self.assertRegex(done.stderr, f"^{program}: warning: ({pattern})")
                    self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                    self.assertEqual(bool(done.stdout), not quiet)

    def test_are_silenced_on_demand_but_stay_in_the_report(self):
        for program, arguments, pattern in self.RUNS:
            with self.subTest(program):
                done = self.run_program(program, *arguments, "--no-warnings", "--json", "-")
                self.assertEqual((done.returncode, done.stderr), (OK, ""))
                report = json.loads(done.stdout)
                self.assertRegex("\n".join(lines(report["warnings"])), pattern)
                self.assertEqual(report["failedByWarnings"], False)

    def test_fail_a_strict_run_in_one_line_that_says_which(self):
        for program, arguments, pattern in self.RUNS:
            with self.subTest(program):
                done = self.run_program(program, *arguments, "--strict", "--no-warnings", "--json",
                                        "r.json")
                self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
                self.assertRegex(done.stderr, f"^{program}: --strict: 1 warning.*: ({pattern})")
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                report = json.loads(self.path("r.json").read_text())
                self.assertEqual(report["failedByWarnings"], True)
                self.assertRegex("\n".join(lines(report["warnings"])), pattern)

    def test_strict_without_warnings_changes_nothing(self):
        self.mesh("good.nii", "--iso", "100", "-o", "a.vtp")
        done = self.mesh("good.nii", "--iso", "100", "-o", "b.vtp", "--strict")
        self.assertEqual(done.stderr, "")
        self.assertEqual(self.path("a.vtp").read_bytes(), self.path("b.vtp").read_bytes())

    def test_strict_writes_reports_and_no_surface(self):
        self.path("a.vtp").write_text("of an earlier run")
        done = self.run_mesh("ball.nii", "--iso", "100", "-o", "a.vtp",
                             "--strict", "--json", "r.json", "--report", "page.html")
        self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
        self.assertRegex(done.stderr.splitlines()[-1], "--strict: 1 warning, so no surface was "
                                                       "written: ball.nii: ")
        self.assertIn("a.vtp (not written)", done.stdout)
        self.assertEqual(self.path("a.vtp").read_text(), "of an earlier run")
        self.assertEqual(self.names(), ["a.vtp", "ball.nii", "bare.off", "good.nii", "page.html",
                                        "r.json", "ras.off"])
        report = json.loads(self.path("r.json").read_text())
        self.assertEqual(report["surfaces"][0]["output"]["written"], False)
        self.assertIn("--strict: 1 warning", self.path("page.html").read_text())

    def test_check_is_not_passed_when_strict_fails(self):
        done = self.run_program("adaptiso-check", "ras.off", "--volume", "ball.nii", "--strict",
                                "--json", "-")
        self.assertEqual((done.returncode, json.loads(done.stdout)["passed"]),
                         (CHECK_FAILED, False))

    def test_of_bad_input_do_not_hide_the_error(self):
        done = self.run_mesh("ball.nii", "--iso", "99999", "--strict")
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertRegex(done.stderr.splitlines()[-1], "no voxel reaches it")

    def test_strict_head_models_are_reports_alone(self):
        write_conflict(self.path("seg.nii"), LABELS)
        model = ("--labels", "seg.nii", "--tissue", "brain=1", "--tissue", "skull=2", "--tissue",
                 "scalp=3", *QUICK, "-o", "model", "--quiet")
        done = self.run_program("adaptiso-bem", *model, "--strict")
        self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
        self.assertRegex(done.stderr.splitlines()[-1],
                         "^adaptiso-bem: --strict: 1 warning, so no model was written: seg.nii: ")
        self.assertEqual([p.name for p in self.path("model").iterdir()], ["report.json"])
        report = json.loads((self.path("model") / "report.json").read_text())
        self.assertEqual((report["model"], report["failedByWarnings"]), (False, True))


class Codes(unittest.TestCase):
    """Of Modules/Core/src/Warning.cxx, of Documentation/Warnings.md, and of all sources."""

    def setUp(self):
        table = (SOURCE / "Modules/Core/src/Warning.cxx").read_text()
        self.codes = dict(re.findall(r'\{"([^"]+)",\s*"([^"]+)"(?:,\s*true)?\}', table))

    def test_are_short_hyphenated_and_in_order(self):
        self.assertGreater(len(self.codes), 30)
        self.assertEqual(list(self.codes), sorted(self.codes))
        for code in self.codes:
            self.assertRegex(code, "^(?=.{5,24}$)[a-z0-9]+(-[a-z0-9]+)+$")

    def test_are_documented_in_the_same_words(self):
        page = (SOURCE / "Documentation/Warnings.md").read_text().split("## Reports")[0]
        self.assertEqual(dict(re.findall(r"(?m)^\| `([^`]+)` \| (.+) \|$", page)), self.codes)

    def test_that_are_used_are_those_of_the_table(self):
        used = set()
        for folder in ("Modules", "Applications", "Wrapping"):
            for path in (SOURCE / folder).rglob("*"):
                if path.suffix not in (".cxx", ".h", ".py"):
                    continue
                text = path.read_text()
                if path.name == "Warning.cxx":
                    text = text.split("\n};\n")[-1]  # behind the table
                used.update(re.findall(
                    r'(?:warnings\.push_back\(\s*\{|Warning ?\{|return \{|\.warning = |Warned\(.*)\s*'
                    r'"([a-z0-9]+(?:-[a-z0-9]+)+)",?', text))
        self.assertEqual({code for code in used if not code.startswith("adaptiso-")},  # programs
                         set(self.codes))


class Allowed(WithWarnings):
    RUN = ("ball.nii", "--iso", "100", "-o", "a.vtp", "--strict")

    def test_codes_pass_a_strict_run(self):
        for allow in (("--allow", "qform-sform-differ"), ("--allow=gantry-tilt,qform-sform-differ",),
                      ("--allow", "gantry-tilt", "--allow", "qform-sform-differ")):
            with self.subTest(allow):
                done = self.run_mesh(*self.RUN, *allow, "--json", "r.json")
                self.assertEqual(done.returncode, OK, done.stderr)
                self.assertRegex(done.stderr, f"^adaptiso-mesh: warning: ({CONFLICT})")
                report = json.loads(self.path("r.json").read_text())
                self.assertEqual((report["passed"], report["failedByWarnings"]), (True, False))
                self.assertEqual(report["warnings"][0]["code"], "qform-sform-differ")
                self.path("a.vtp").unlink()

    def test_other_codes_do_not(self):
        done = self.run_mesh(*self.RUN, "--allow", "gantry-tilt", "--json", "-")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(json.loads(done.stdout)["error"]["text"], "^--strict: 1 warning, so no "
                                                                   "surface was written: ball.nii: ")

    def test_batches_hand_them_on(self):
        self.mesh("ball.nii", "good.nii", "--iso", "100", "--output-dir", "out", "--strict",
                  "--allow", "qform-sform-differ")


class Batches(WithWarnings):
    RUN = ("ball.nii", "good.nii", "--iso", "100", "--output-dir", "out")

    def test_tell_the_warnings_of_every_run(self):
        for quiet in ((), ("--quiet",)):
            done = self.mesh(*self.RUN, *quiet)
            self.assertRegex(done.stderr, f"^adaptiso-mesh: warning: ({CONFLICT})")
            self.assertEqual(len(done.stderr.splitlines()), 1)
        again = self.mesh(*self.RUN, "--skip-existing")
        self.assertEqual(again.stderr, done.stderr)
        self.assertEqual(self.mesh(*self.RUN, "--no-warnings").stderr, "")

    def test_fail_those_with_warnings_when_strict(self):
        done = self.run_mesh(*self.RUN, "--strict", "--no-warnings")
        self.assertEqual((done.returncode, done.stderr), (CHECK_FAILED, ""))
        self.assertRegex(done.stdout, f"FAILED  ball.nii: --strict: 1 warning: ({CONFLICT})")
        self.assertRegex(done.stdout, "done    good.nii: good-iso100.vtp")
        self.assertFalse(self.path("out/ball-iso100.vtp").exists())
        self.assertTrue(self.path("out/good-iso100.vtp").exists())
        self.assertIn("--strict: 1 warning", self.path("out/summary.html").read_text())

    def test_keep_what_failed_apart_when_going_on(self):
        self.mesh(*self.RUN)
        done = self.run_mesh(*self.RUN, "--strict", "--skip-existing", "--json", "-")
        rows = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual([row["passed"] for row in rows], [False, True])
        self.assertEqual(rows[0]["outputs"], [])

    def test_of_checks_too(self):
        done = self.run_program("adaptiso-check", "ras.off", "--volume", "ball.nii", "--strict",
                                "--no-warnings", "--output-dir", "out")
        self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
        self.assertRegex(done.stdout, "FAILED  ras.off: --strict: 1 warning")


if __name__ == "__main__":
    main()
