"""Surfaces tile by tile: what the steps tell and leave, against the surface of the whole; bad input."""

import os
import signal
import subprocess
import sys
import unittest
from unittest import mock

import adaptiso
import numpy as np
from adaptiso import giant
from support import BIN, InFolder, ball, program

os.environ["PATH"] = f"{BIN}{os.pathsep}{os.environ.get('PATH', '')}"


class Steps(InFolder):
    def setUp(self):
        super().setUp()
        self.image = str(self.folder / "image.nii")
        self.work = self.folder / "work"
        # two balls of radius 20 in 100 x 60 x 50 voxels of 1 mm
        distance = np.maximum(ball((100, 60, 50), (25, 30, 25)), ball((100, 60, 50), (72, 30, 25)))
        write_nifti(self.image, distance.astype(np.float32))
        self.whole = adaptiso.surface(self.image, -20, method="mc")

    def test_run_gives_the_whole_surface(self):
        for method in giant.METHODS:
            output = self.folder / f"{method}.ply"
            report = giant.run(self.folder / method, self.image, -20, output, method=method, side=32)
            self.assertEqual((report["componentCount"], report["genus"], report["closed"]),
                             (2, 0, True))
            self.assertAlmostEqual(report["volumeMm3"], self.whole.volume, delta=0.01 * self.whole.volume)
            mesh = adaptiso.load(output)
            self.assertTrue(adaptiso.check(mesh))
            self.assertEqual(len(mesh.faces), report["triangles"])
            if method == "mc":
                self.assertEqual(sorted(map(tuple, mesh.vertices)), sorted(map(tuple, self.whole.vertices)))
            else:
                self.assertLess(len(mesh.faces), 0.5 * len(self.whole.faces))
                found = adaptiso.compare(mesh, self.whole, samples=20000)
                self.assertLessEqual(found.max, report["errorBoundMm"] * (1 + 1e-6))

    def test_steps_are_those_of_the_program_to_the_byte(self):
        plan = giant.plan(self.work, self.image, -20, side=32)
        self.assertEqual(giant.read_plan(self.work), plan)
        self.assertGreater(len(plan.tiles), 4)
        first = giant.tile(self.work, plan.tiles[:3], threads=1)
        self.assertEqual((first["made"], first["found"]), (3, 0))
        rest = giant.tile(self.work)
        self.assertEqual((rest["made"], rest["found"]), (len(plan.tiles) - 3, 3))
        self.assertEqual(giant.seam(self.work, plan.seams)["made"], len(plan.seams))
        report = giant.join(self.work, self.folder / "ours.ply", preview=self.folder / "small.ply")
        program("adaptiso-giant", "run", self.folder / "theirs", "--input", self.image, "--iso", -20,
                "--tile", 32, "-o", self.folder / "theirs.ply", "-q")
        self.assertEqual((self.folder / "ours.ply").read_bytes(),
                         (self.folder / "theirs.ply").read_bytes())
        self.assertEqual(len(adaptiso.load(self.folder / "small.ply").faces), report["triangles"])

    def test_no_ids_are_none_of_them(self):
        giant.plan(self.work, self.image, -20, side=32)
        self.assertEqual(giant.tile(self.work, [])["made"], 0)
        self.assertEqual(list((self.work / "tiles").iterdir()), [])

    def test_warnings_go_to_the_logger(self):
        with self.assertLogs("adaptiso", "WARNING") as logs:
            giant.plan(self.work, self.image, -20, side=32)
        self.assertIn("is no Zarr", logs.output[0])

    def test_frames(self):
        for frame, sign in (("ras", 1), ("lps", -1)):
            giant.run(self.work, self.image, -20, self.folder / "a.ply", side=32, frame=frame)
            text = (self.folder / "a.ply").read_bytes()[:400].decode("latin-1")
            self.assertIn(frame.upper(), text.upper())

    def refuse(self, part, call, *arguments, **named):
        with self.assertRaises(adaptiso.Error) as caught:
            call(*arguments, **named)
        self.assertIn(part, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_bad_input_is_one_line(self):
        self.refuse("no such file", giant.plan, self.work, "nowhere.zarr", 1)
        self.refuse("level", giant.plan, self.work, self.image, "high")
        self.refuse("method", giant.plan, self.work, self.image, 1, method="boxes")
        self.refuse("multiple of 32", giant.plan, self.work, self.image, 1, side=40)
        self.refuse("side", giant.plan, self.work, self.image, 1, side=0)
        self.refuse("max_error", giant.plan, self.work, self.image, 1, max_error=-1)
        self.refuse("zarr_level", giant.plan, self.work, self.image, 1, zarr_level="0")
        self.refuse("there is no plan", giant.read_plan, self.folder)
        self.refuse("there is no plan", giant.tile, self.folder)
        plan = giant.plan(self.work, self.image, -20, side=32)
        self.refuse("9_9_9", giant.tile, self.work, ["9_9_9"])
        self.refuse("ids", giant.tile, self.work, ["--output=x"])
        self.refuse("ids", giant.tile, self.work, [5])
        self.refuse("run: adaptiso-giant tile", giant.seam, self.work, plan.seams[:1])
        self.refuse("frame", giant.join, self.work, frame="mm")
        self.refuse(".ply", giant.join, self.work, self.folder / "a.stl")
        self.refuse("workers", giant.run, self.work, self.image, -20, workers=0)

    def test_a_missing_program_is_named(self):
        with mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            self.refuse("adaptiso-giant: is not on the PATH", giant.plan, self.work, self.image, 1)

    def test_a_killed_process_is_an_error(self):
        for name in ("SIGKILL", "SIGSEGV"):
            error = giant._error_of(-getattr(signal, name), [])
            self.assertIsInstance(error, adaptiso.Error)
            self.assertIn(name, str(error))
        self.assertIsInstance(giant._error_of(4, ["broken"]), adaptiso.InternalError)

    def test_an_interruption_ends_the_program(self):
        script = ("import os, signal, sys, threading, time\n"
                  "from adaptiso import giant\n"
                  "threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
                  "began = time.monotonic()\n"
                  "try:\n"
                  "    giant._run(['--help'])\n"
                  "except KeyboardInterrupt:\n"
                  "    print('interrupted', time.monotonic() - began < 20)\n")
        slow = self.folder / "adaptiso-giant"
        slow.write_text("#!/bin/sh\nexec sleep 30\n")
        slow.chmod(0o755)
        done = subprocess.run([sys.executable, "-c", script], text=True, capture_output=True,
                              env={**os.environ, "PATH": f"{self.folder}{os.pathsep}{os.environ['PATH']}"})
        self.assertEqual(done.stdout.strip(), "interrupted True", done.stderr)


def write_nifti(path, samples):
    """A NIfTI-1 file of 1 mm voxels."""
    header = np.zeros(352, np.uint8)
    header[:4].view("<i4")[0] = 348
    header[40:56].view("<i2")[:4] = (3, *samples.shape)
    header[56:56] = 0
    header[70:74].view("<i2")[:] = (16, 32)
    header[76:92].view("<f4")[:] = (1, 1, 1, 1)
    header[108:112].view("<f4")[0] = 352
    header[123] = 2
    header[254:256].view("<i2")[0] = 1
    header[280:328].view("<f4")[:] = np.eye(4)[:3].ravel()
    header[344:348] = np.frombuffer(b"n+1\0", np.uint8)
    with open(path, "wb") as stream:
        stream.write(header.tobytes())
        stream.write(samples.tobytes(order="F"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
