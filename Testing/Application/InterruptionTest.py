"""Whole files or none: signals, full disks, limits."""

import os
import resource
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from support import BAD_INPUT, MESH, ApplicationTest, ball, main, noise, write_nifti


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


class NoRoom(ApplicationTest):
    EXTENSIONS = (".vtp", ".vtk", ".ply", ".stl", ".obj", ".off", ".gii", ".pial", ".tri")

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
        self.assertEqual(self.contents(), before)

    @unittest.skipIf(os.geteuid() != 0, "only root can mount")
    def test_a_full_disk(self):
        disk = Path(tempfile.mkdtemp(prefix="adaptiso-disk-"))
        self.addCleanup(disk.rmdir)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", disk],
                          stderr=subprocess.DEVNULL).returncode != 0:
            self.skipTest("this machine lets nobody mount")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
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
