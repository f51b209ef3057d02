"""Whole files or none: signals, full disks, limits."""

import os
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from support import BAD_INPUT, BIN, MESH, OK, ApplicationTest, ball, main, noise, write_nifti
from BemSurfacesTest import RADII, globe
from headDefects import write_off


class Signals(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("noise.nii"), noise())
        self.path("out").mkdir()
        self.path("out/noise-100.obj").write_text("the file of an earlier run")

    def start(self, **options):
        """Two surfaces as text: there are seconds between the first temporary file and the end."""
        arguments = ["noise.nii", "--iso", "100", "--iso", "150", "--method", "mc", "-o",
                     "out/noise-{iso}.obj"]
        return subprocess.Popen([MESH, *arguments], cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, **options)

    def wait_for_temporary(self, process):
        while process.poll() is None:
            if any(p.name.startswith(".adaptiso") for p in self.path("out").iterdir()):
                return
            time.sleep(0.001)
        self.fail("the program ended before a temporary file was seen")

    def assert_nothing_left(self):
        self.assertEqual([p.name for p in self.path("out").iterdir()], ["noise-100.obj"])
        self.assertEqual(self.path("out/noise-100.obj").read_text(), "the file of an earlier run")

    def test_while_writing(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number):
                process = self.start()
                self.wait_for_temporary(process)
                process.send_signal(number)
                output, error = process.communicate(timeout=60)
                # the shell must see that a signal ended it, or a script's loop goes on
                self.assertEqual(process.returncode, -number)
                self.assertEqual(output, b"")
                self.assert_nothing_left()

    def test_at_any_time(self):
        for delay in (0, 0.02, 0.1, 0.3, 0.6):
            with self.subTest(delay):
                process = self.start()
                time.sleep(delay)
                process.send_signal(signal.SIGTERM)
                process.communicate(timeout=60)
                self.assertEqual(process.returncode, -signal.SIGTERM)
                self.assert_nothing_left()

    def test_ignored_signals_stay_ignored(self):
        def ignore():
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = self.start(preexec_fn=ignore)
        self.wait_for_temporary(process)
        process.send_signal(signal.SIGHUP)
        process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0)
        self.assertEqual(len(list(self.path("out").iterdir())), 2)


class AllPrograms(ApplicationTest):
    """A command of each program that writes files, with a report on stdout."""

    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(24, 9))
        self.mesh("ball.nii", "--iso", "100", "-o", "ball.vtp")
        for n, radius in enumerate(RADII):
            write_off(self.path(f"s{n}.off"), globe(radius), None)
        self.path("out").mkdir()
        self.commands = {
            "adaptiso-mesh": ("ball.nii", "--iso", "100", "--iso", "90", "-o", "out/{iso}.vtp"),
            "adaptiso-check": ("ball.vtp", "--report", "out/page.html", "--pictures", "out/p"),
            "adaptiso-compare": ("ball.vtp", "ball.vtp", "--colored", "out/colored.vtp"),
            "adaptiso-simplify": ("ball.vtp", "--max-error", "0.2", "-o", "out/small.vtp"),
            "adaptiso-bem": ("--surfaces", "s0.off", "s1.off", "s2.off", "-o", "out/model")}

    def run_program(self, program, *arguments, **options):
        return subprocess.run([str(BIN / program), *self.commands[program], *arguments],
                              cwd=self.folder, text=True, stderr=subprocess.PIPE, timeout=300,
                              **options)


class NoResults(AllPrograms):
    """Results that can't be told take the files with them."""

    def assert_nothing_made(self, done, before):
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertRegex(done.stderr.splitlines()[-1], r"^adaptiso-\w+: standard output: can't be written")
        self.assert_as_before(before)

    def assert_as_before(self, before):
        for name in ("out/report.json", "out/info.json"):
            self.take_failure_report(name)
        self.assertEqual(self.contents(), before)
        self.assertEqual(list(self.path("out").iterdir()), [])

    def test_a_full_disk_behind_stdout(self):
        before = self.contents()
        for program in self.commands:
            for json in ((), ("--json", "-"), ("--json", "out/report.json")):
                with self.subTest(program + str(json)), open("/dev/full", "w") as full:
                    self.assert_nothing_made(self.run_program(program, *json, stdout=full), before)

    def test_a_stdout_that_is_closed(self):
        before = self.contents()
        for program in self.commands:
            with self.subTest(program):
                done = self.run_program(program, "--json", "-", preexec_fn=lambda: os.close(1))
                self.assert_nothing_made(done, before)

    def test_a_pipe_that_nobody_reads(self):
        before = self.contents()
        for program in self.commands:
            # Python's children ignore no SIGPIPE unless told to
            for ignores, code in ((False, -signal.SIGPIPE), (True, BAD_INPUT)):
                with self.subTest(f"{program}, SIGPIPE ignored: {ignores}"):
                    reader, writer = os.pipe()
                    os.close(reader)
                    done = self.run_program(program, "--json", "-", stdout=writer,
                                            restore_signals=not ignores)
                    os.close(writer)
                    self.assertEqual(done.returncode, code, done.stderr)
                    self.assert_as_before(before)

    def test_quiet_runs_need_no_stdout(self):
        for program in self.commands:
            with self.subTest(program):
                done = self.run_program(program, "--quiet", preexec_fn=lambda: os.close(1))
                self.assertEqual(done.returncode, OK, done.stderr)
                self.assertNotEqual(list(self.path("out").iterdir()), [])

    def test_help_and_version(self):
        for program in self.commands:
            for option in ("--help", "--version", "--help-json"):
                with self.subTest(program + option), open("/dev/full", "w") as full:
                    done = subprocess.run([str(BIN / program), option], stdout=full, text=True,
                                          stderr=subprocess.PIPE, timeout=60)
                    self.assertEqual(done.returncode, BAD_INPUT)
                    self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_a_listing_without_stdout_leaves_no_json(self):
        before = self.contents()
        with open("/dev/full", "w") as full:
            done = subprocess.run([MESH, "ball.nii", "--info", "--json", "out/info.json"],
                                  cwd=self.folder, stdout=full, stderr=subprocess.PIPE, text=True)
        self.assert_nothing_made(done, before)


class NoThreads(AllPrograms):
    """A limit of processes, which counts threads too, that is reached."""

    NOBODY = 65534

    def setUp(self):
        super().setUp()
        self.folder.chmod(0o777)
        self.path("out").chmod(0o777)

    def limit(self):
        """What a user has who has no process left; root has no limit."""
        if os.geteuid() == 0:
            os.setgid(self.NOBODY)
            os.setuid(self.NOBODY)
        # after it: else it can't exec while this user has other processes
        resource.setrlimit(resource.RLIMIT_NPROC, (0, 0))

    def test_one_does(self):
        for program in self.commands:
            with self.subTest(program):
                done = self.run_program(program, stdout=subprocess.PIPE, preexec_fn=self.limit)
                self.assertEqual(done.returncode, OK, done.stderr)
                self.assertNotIn("thread", done.stderr)

    def test_makes_the_same_bytes(self):
        self.run_program("adaptiso-mesh", stdout=subprocess.DEVNULL, preexec_fn=self.limit)
        self.mesh(*self.commands["adaptiso-mesh"][:-1], "with-{iso}.vtp")
        for iso in (90, 100):
            self.assertEqual(self.path(f"out/{iso}.vtp").read_bytes(),
                             self.path(f"with-{iso}.vtp").read_bytes())

    def test_itk_too(self):
        for more in (("--smooth", "1"), ("--resample", "2")):
            with self.subTest(more):
                done = self.run_mesh("ball.nii", "--iso", "100", *more, "-o", "out/smooth.vtp",
                                     preexec_fn=self.limit)
                self.assertEqual(done.returncode, OK, done.stderr)

    def test_a_decoder_that_can_not_be_started_is_one_line(self):
        self.path("scan.nrrd").write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
                                           b"encoding: ascii\nspace: RAS\nspace directions: (1,0,0) "
                                           b"(0,1,0) (0,0,1)\n\n0 0 0 0 9 9 9 9\n")
        before = self.contents()
        done = self.run_mesh("scan.nrrd", "--iso", "5", "-o", "out/scan.vtp", preexec_fn=self.limit)
        if done.returncode != OK:  # OK: this kind is read without a process of its own
            self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
            self.assertRegex(done.stderr, r"^adaptiso-mesh: scan.nrrd: can't be read: no process [^\n]*\n$")
            self.assertEqual(self.contents(), before)

    def test_a_batch_is_one_line(self):
        for program, files in (("adaptiso-mesh", ("ball.nii", "--iso", "100")),
                               ("adaptiso-check", ("ball.vtp",))):
            with self.subTest(program):
                done = subprocess.run([str(BIN / program), *files, "--output-dir", "out"],
                                      cwd=self.folder, text=True, stdout=subprocess.PIPE,
                                      stderr=subprocess.PIPE, timeout=300, preexec_fn=self.limit)
                self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
                self.assertRegex(done.stderr, r"^adaptiso-\w+: [^\n]*ulimit -u[^\n]*\n$")
                self.assertEqual(list(self.path("out").glob("*.vtp")), [])


class NoRoom(ApplicationTest):
    EXTENSIONS = (".vtp", ".vtk", ".ply", ".stl", ".obj", ".off", ".gii", ".pial", ".tri", ".glb",
                  ".3mf")

    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(24, 9))

    def limited(self, limit):
        return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    def test_a_file_beyond_the_limit_of_size(self):
        for extension in self.EXTENSIONS:
            with self.subTest(extension):
                self.assert_fails(BAD_INPUT, rf"lh\{extension}", "ball.nii", "--iso", "100", "-o",
                                  f"lh{extension}", "--method", "mc",
                                  preexec_fn=self.limited(5000))

    def test_a_limit_reached_at_the_very_end(self):
        for extension in self.EXTENSIONS:
            with self.subTest(extension):
                self.mesh("ball.nii", "--iso", "100", "-o", f"lh{extension}")
                size = self.path(f"lh{extension}").stat().st_size
                self.assert_fails(BAD_INPUT, rf"lh\{extension}", "ball.nii", "--iso", "100", "-o",
                                  f"lh{extension}", preexec_fn=self.limited(size - 1))

    def test_report_without_room_takes_the_mesh_with_it(self):
        self.mesh("ball.nii", "--iso", "100", "-o", "a.tri")
        size = self.path("a.tri").stat().st_size
        self.path("a.tri").unlink()
        self.path("many").mkdir()
        isovalues = [text for n in range(60) for text in ("--iso", f"{100 + n / 10}")]
        # small meshes, a report of many surfaces that is larger than each of them
        write_nifti(self.path("small.nii"), ball(6, 2))
        before = self.contents()
        done = self.run_mesh("small.nii", *isovalues, "-o", "many/{iso}.stl", "--json",
                             "report.json", preexec_fn=self.limited(size))
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertIn("report.json", done.stderr)
        self.take_failure_report("report.json")
        self.assertEqual(self.contents(), before)

    def small_disk(self, size):
        disk = Path(tempfile.mkdtemp(prefix="adaptiso-disk-"))
        self.addCleanup(disk.rmdir)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=" + size, "tmpfs", disk],
                          stderr=subprocess.DEVNULL).returncode != 0:
            self.skipTest("this machine lets nobody mount")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        return disk

    @unittest.skipIf(os.geteuid() != 0, "only root can mount")
    def test_a_batch_that_fills_the_disk_leaves_no_record_of_what_it_has_not_made(self):
        disk = self.small_disk("32k")
        for n in range(20):
            shutil.copy(self.path("ball.nii"), self.path(f"ball-{n}.nii"))
        done = self.run_mesh(*(f"ball-{n}.nii" for n in range(20)), "--iso", "100",
                             "--output-dir", disk)
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertEqual(list(disk.iterdir()), [])

    @unittest.skipIf(os.geteuid() != 0, "only root can mount")
    def test_a_full_disk(self):
        disk = self.small_disk("16k")
        for extension in self.EXTENSIONS:
            with self.subTest(extension):
                done = self.run_mesh("ball.nii", "--iso", "100", "-o", disk / f"lh{extension}",
                                     "--method", "mc")
                self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
                self.assertIn(f"lh{extension}", done.stderr)
                self.assertEqual(list(disk.iterdir()), [])

    @unittest.skipIf(os.environ.get("ADAPTISO_SANITIZE"), "sanitizers map terabytes")
    def test_too_little_memory_is_told_as_such(self):
        # all that the program maps is some hundred MB; the image asks for 2.7 GB more
        write_nifti(self.path("large.nii"), ball(4, 1))
        header = bytearray(self.path("large.nii").read_bytes()[:352])
        header[40:56] = (3).to_bytes(2, "little") + 3 * (1100).to_bytes(2, "little") + \
            4 * (1).to_bytes(2, "little")
        with open(self.path("large.nii"), "wb") as file:
            file.write(header)
            file.truncate(352 + 2 * 1100 ** 3)  # sparse: takes no room
        limit = 2 << 30
        done = self.run_mesh("large.nii", "--iso", "100", preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_AS, (limit, limit)))
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertRegex(done.stderr, "memory")
        self.assertEqual(self.names(), ["ball.nii", "large.nii"])


if __name__ == "__main__":
    main()
