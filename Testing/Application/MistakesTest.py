"""One mistake, one exit code, one line and one report, whatever the program."""

import json
import os
import shutil
import subprocess
import time
import unittest

from bemSupport import LABELS, QUICK
from headDefects import icosphere, write_off
from support import (BAD_INPUT, BIN, OK, USAGE, ApplicationTest, ball, from_function, main,
                     write_nifti)

HEAD = ("--tissue", "brain=1", "--tissue", "skull=2", "--tissue", "scalp=3", *QUICK)
# each: a command, in which IN stands for its input and OUT for what it writes
PROGRAMS = {
    "adaptiso-mesh": ("IN", "--iso", "100", "-o", "OUT"),
    "adaptiso-labels": ("IN", "-o", "OUT"),
    "adaptiso-bem": ("--labels", "IN", *HEAD, "-o", "OUT"),
    "adaptiso-check": ("IN", "--report", "OUT"),
    "adaptiso-compare": ("IN", "good.off", "--colored", "OUT"),
    "adaptiso-simplify": ("IN", "--triangles", "60", "-o", "OUT"),
    "adaptiso-mend": ("IN", "-o", "OUT"),
    "adaptiso-giant": ("plan", "OUT", "--input", "IN", "--iso", "100"),
    "adaptiso-bids": ("IN", "OUT", "participant", "--surfaces", "iso=100", "--no-pictures"),
}
GOOD = {"adaptiso-mesh": "ball.nii", "adaptiso-labels": "seg.nii", "adaptiso-bem": "seg.nii",
        "adaptiso-giant": "ball.nii", "adaptiso-bids": "study"}
FOLDERS = ("adaptiso-labels", "adaptiso-bem", "adaptiso-giant", "adaptiso-bids")
IMAGES = ("adaptiso-mesh", "adaptiso-labels", "adaptiso-bem")
KEYS = ["schema", "program", "passed", "exitCode", "error", "warnings"]


class WithInputs(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(12, 4))
        write_nifti(self.path("seg.nii"), LABELS)
        write_off(self.path("good.off"), icosphere(40))
        anat = self.path("study/sub-01/anat")
        anat.mkdir(parents=True)
        write_nifti(anat / "sub-01_T1w.nii", ball(12, 4))
        self.path("study/dataset_description.json").write_text(
            '{"Name": "x", "BIDSVersion": "1.8.0"}')

    def command(self, program, given=None, out=None):
        given = given or GOOD.get(program, "good.off")
        out = out or program + ("" if program in FOLDERS else
                                ".html" if program == "adaptiso-check" else ".vtp")
        return [{"IN": given, "OUT": out}.get(word, word) for word in PROGRAMS[program]]

    def run_program(self, program, *arguments, **options):
        return subprocess.run([BIN / program, *map(str, arguments)], cwd=self.folder, text=True,
                              capture_output=True, timeout=120, **options)

    def fails(self, code, program, *arguments, pattern="", file=None, **options):
        """With `code`, one line on stderr, and the same in a report that holds no folders."""
        with self.subTest((program, arguments)):
            done = self.run_program(program, *arguments, "--json", "-", **options)
            self.assertEqual(done.returncode, code, done.stdout + done.stderr)
            self.assertRegex(done.stderr, rf"^{program}: {pattern}")
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            report = json.loads(done.stdout)
            self.assertEqual(list(report)[:6], KEYS)
            self.assertEqual((report["passed"], report["exitCode"], report["warnings"]),
                             (False, code, []))
            self.assertTrue(report["error"]["text"])
            self.assertNotIn(str(self.folder), done.stdout)
            if file:
                self.assertEqual(report["error"]["file"], file)


class Mistakes(WithInputs):
    def test_an_input_that_is_not_there(self):
        for program in PROGRAMS:
            for name in ("none.nii", "no folder/none.off", self.path("none.vtp")):
                self.fails(BAD_INPUT, program, *self.command(program, name),
                           file=os.path.basename(name))

    def test_a_folder_in_a_files_place(self):
        self.path("folder").mkdir()
        for program in PROGRAMS:
            self.fails(BAD_INPUT, program, *self.command(program, "folder"), file="folder")

    def test_a_pipe_in_a_files_place(self):
        os.mkfifo(self.path("pipe.nii"))
        os.mkfifo(self.path("pipe.off"))
        for program in PROGRAMS:
            name = "pipe.nii" if program in (*IMAGES, "adaptiso-giant") else "pipe.off"
            self.fails(BAD_INPUT, program, *self.command(program, name), file=name)

    @unittest.skipIf(os.geteuid() == 0, "root reads all")
    def test_an_input_that_may_not_be_read(self):
        for name in ("seg.nii", "ball.nii", "good.off"):
            self.path(name).chmod(0)
        for program in PROGRAMS:
            if program != "adaptiso-bids":
                self.fails(BAD_INPUT, program, *self.command(program))

    def test_no_input(self):
        for program in PROGRAMS:
            self.fails(USAGE, program)

    def test_an_output_in_a_folder_that_is_not_there(self):
        for program in PROGRAMS:
            if program not in ("adaptiso-giant", "adaptiso-bids"):  # they make theirs
                out = "none/" + self.command(program)[-1].split("/")[-1]
                out = "none/out" if program in FOLDERS else out if "." in out else "none/o.vtp"
                self.fails(BAD_INPUT, program, *self.command(program, out=out))

    def test_an_output_whose_name_is_taken(self):
        self.path("taken.vtp").mkdir()
        self.path("taken").write_text("mine")
        for program in PROGRAMS:
            out = "taken" if program in FOLDERS else "taken.vtp"
            if program == "adaptiso-simplify":
                continue  # it writes into folders
            self.fails(BAD_INPUT, program, *self.command(program, out=out))
        self.assertEqual(self.path("taken").read_text(), "mine")

    def test_two_outputs_of_one_name(self):
        """However the name is spelt; nothing is written."""
        self.path("there").mkdir()
        for program in PROGRAMS:
            if program in ("adaptiso-giant", "adaptiso-bids"):
                continue
            with self.subTest(program):
                name = "x.ply" if program == "adaptiso-mend" else "x.html"  # it writes no page
                command = [*self.command(program), "--json", f"there/../{name}"]
                own = {"adaptiso-check": "--report", "adaptiso-mend": "-o"}.get(program)
                if own is None:
                    command += ["--report", name]
                else:
                    command[command.index(own) + 1] = name
                done = self.run_program(program, *command)
                self.assertEqual(done.returncode, USAGE, done.stderr)
                self.assertIn(f"{name}: is the name of another output too", done.stderr)
                self.assertFalse(self.path(name).exists())

    def test_a_folder_of_others_is_kept(self):
        self.path("full").mkdir()
        self.path("full/mine.txt").write_text("mine")
        for program in ("adaptiso-labels", "adaptiso-bem"):
            for force in ((), ("--force",)):
                self.fails(BAD_INPUT, program, *self.command(program, out="full"), *force)
        self.assertEqual(sorted(os.listdir(self.path("full"))), ["mine.txt"])

    def test_unknown_and_incomplete_options(self):
        for program in PROGRAMS:
            command = self.command(program)
            self.fails(USAGE, program, *command, "--no-such-option")
            self.fails(USAGE, program, *command, "--threads")
            self.fails(USAGE, program, *command, "--threads", "none")
            self.fails(USAGE, program, *command, "--threads=")
            self.fails(USAGE, program, *command, "--strict", "--allow", "count-mised",
                       pattern="--allow count-mised: .*did you mean count-missed")
            self.fails(USAGE, program, *command, "--allow", "count-missed",
                       pattern="--allow needs --strict")

    def test_empty_lists(self):
        self.path("list").write_text("# none\n\n")
        for program, more in (("adaptiso-mesh", ("--iso", "1")), ("adaptiso-labels", ()),
                              ("adaptiso-check", ()), ("adaptiso-simplify", ("--triangles", 9))):
            for name in ("list", "none"):
                self.fails(BAD_INPUT, program, "--list", name, "--output-dir", "out", *more)


class Reports(WithInputs):
    def test_of_runs_that_pass_begin_alike(self):
        for program in PROGRAMS:
            if program == "adaptiso-bids":
                continue
            with self.subTest(program):
                done = self.run_program(program, *self.command(program), "--json", "r.json")
                self.assertEqual(done.returncode, OK, done.stderr)
                report = json.loads(self.path("r.json").read_text())
                self.assertEqual(list(report)[:6], KEYS)
                self.assertEqual(report["program"]["name"], program)
                self.assertEqual((report["passed"], report["exitCode"], report["error"]),
                                 (True, OK, None))
                for warning in report["warnings"]:
                    self.assertEqual(list(warning), ["code", "file", "text"])

    def test_of_runs_that_fail_are_files_too(self):
        self.path("r.json").write_text('{"of": "an earlier run"}')
        done = self.run_mesh("none.nii", "--iso", "1", "--json", "r.json")
        self.assertEqual(done.returncode, BAD_INPUT)
        report = json.loads(self.path("r.json").read_text())
        self.assertEqual(report["schema"], "adaptiso-failure/1")
        self.assertEqual(report["error"]["file"], "none.nii")

    def test_tell_warnings_that_came_before_the_error(self):
        content = bytearray(self.path("ball.nii").read_bytes())
        content[252:256] = bytes(4)  # neither sform nor qform
        self.path("ball.nii").write_bytes(content)
        done = self.run_mesh("ball.nii", "--iso", "99999", "--json", "-")
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertEqual([(w["code"], w["file"]) for w in json.loads(done.stdout)["warnings"]],
                         [("guessed-orientation", "ball.nii")])

    def test_of_failures_replace_no_input_and_no_output(self):
        for name, arguments in (("ball.nii", ("ball.nii", "--iso", "1")),
                                ("o.vtp", ("none.nii", "--iso", "1", "-o", "o.vtp")),
                                ("./text", ("none.nii", "--iso", "1"))):
            with self.subTest(name):
                if name != "ball.nii":
                    self.path(name).write_text("mine")
                before = self.path(name).read_bytes()
                done = self.run_mesh(*arguments, "--json", name)
                self.assertIn(done.returncode, (USAGE, BAD_INPUT))
                self.assertEqual(self.path(name).read_bytes(), before)
        self.run_mesh("ball.nii", "--iso", "1", "-o", "new.vtp", "--json", "new.vtp")
        self.assertFalse(self.path("new.vtp").exists())

    def test_of_batches_are_alike_for_each_input(self):
        self.path("bad.nii").write_text("no image")
        done = self.run_mesh("ball.nii", "bad.nii", "--iso", "100", "--output-dir", "out",
                             "--json", "-")
        good, bad = map(json.loads, done.stdout.splitlines())
        self.assertEqual((good["passed"], good["exitCode"], good["error"], good["warnings"]),
                         (True, OK, None, []))
        self.assertEqual((bad["passed"], bad["exitCode"], bad["error"]["file"], bad["report"]),
                         (False, BAD_INPUT, "bad.nii", None))
        self.assertIn("truncated", bad["error"]["text"])


class Batches(WithInputs):
    """A pipe or a device among several inputs fails alone, at once."""

    def test_pipes_and_devices_fail_alone(self):
        write_nifti(self.path("map.nii"), from_function(
            12, "B", lambda x, y, z: 1 if x * x + y * y + z * z < 16 else 0))
        for make in (os.mkfifo, lambda path: os.symlink("/dev/zero", path)):
            for program, good, more in (("adaptiso-mesh", "ball.nii", ("--iso", "100")),
                                        ("adaptiso-labels", "map.nii", ()),
                                        ("adaptiso-check", "good.off", ()),
                                        ("adaptiso-simplify", "good.off", ("--triangles", "60"))):
                with self.subTest(program):
                    bad = self.path("bad" + good[good.index("."):])
                    bad.unlink(missing_ok=True)
                    make(bad)
                    start = time.monotonic()
                    done = self.run_program(program, good, bad.name, *more, "--output-dir", "out")
                    self.assertLess(time.monotonic() - start, 60)
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertRegex(done.stdout, f"done    {good}")
                    self.assertRegex(done.stdout, f"FAILED  {bad.name}")
                    shutil.rmtree(self.path("out"))


class Resources(WithInputs):
    def test_no_folder_for_temporary_files(self):
        environment = dict(os.environ, TMPDIR="/nonexistent")
        done = self.run_program("adaptiso-check", "--self-test", "--json", "-", env=environment)
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertEqual(done.stderr, "adaptiso-check: TMPDIR (/nonexistent): is no folder that can "
                                      "be written to; set it to one that can\n")
        self.assertEqual(json.loads(done.stdout)["exitCode"], BAD_INPUT)
        for program in ("adaptiso-labels", "adaptiso-bem"):
            self.fails(BAD_INPUT, program, *self.command(program), "--tetrahedra", "tetgen",
                       env=environment, pattern="TMPDIR ")

    @unittest.skipUnless(os.geteuid() == 0, "takes another user's id")
    def test_one_thread_where_no_process_may_start(self):
        self.folder.chmod(0o777)
        self.path("ball.nii").chmod(0o644)

        def limited():
            import resource
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)
            resource.setrlimit(resource.RLIMIT_NPROC, (0, 0))  # after it: else it can't exec
        for threads in ((), ("--threads", 1), ("--threads", 2)):
            done = self.run_program("adaptiso-mesh", "ball.nii", "--iso", "100", "-o", "o.ply",
                                    *threads, preexec_fn=limited)
            self.assertEqual((done.returncode, done.stderr), (OK, ""), threads)


if __name__ == "__main__":
    main()
