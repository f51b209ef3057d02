"""adaptiso-giant: steps in any order, killed steps, the surface of the whole volume, refusals."""

import json
import math
import random
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from support import (BAD_INPUT, BIN, MESH, OK, SOURCE, USAGE, ApplicationTest, ball, main,
                     write_nifti)

GIANT = str(BIN / "adaptiso-giant")
CHECK = str(BIN / "adaptiso-check")
N, CHUNK, SPACING = 96, 24, (0.02, 0.01, 0.01)  # z, y, x
ISO = 0


def depth(x, y, z):
    """Balls across walls, edges and a corner of tiles (at 16, 48, 80), one hollow, one cut off by
    the volume's border, one of a few voxels."""
    def at(cx, cy, cz, r, hollow=0.0):
        q = math.sqrt((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2)
        return min(r - q, q - hollow) if hollow else r - q
    return max(at(48.3, 47.8, 48.1, 17), at(16, 30, 70, 12.5, hollow=6), at(80, 80, 16.4, 9),
               at(94, 20, 48, 10.2), at(79.5, 80.5, 80.5, 1.4), at(20, 80, 20, 11))


COMPONENTS, CAVITIES = 7, 1


def write_zarr(path):
    """Version 2, raw; chunks that are all outside are missing."""
    (path / "0").mkdir(parents=True)
    (path / ".zgroup").write_text('{"zarr_format": 2}')
    (path / ".zattrs").write_text(json.dumps({"multiscales": [{
        "version": "0.4", "axes": [{"name": a, "type": "space", "unit": "millimeter"}
                                   for a in "zyx"],
        "datasets": [{"path": "0", "coordinateTransformations":
                      [{"type": "scale", "scale": SPACING}]}]}]}))
    (path / "0" / ".zarray").write_text(json.dumps({
        "zarr_format": 2, "shape": [N] * 3, "chunks": [CHUNK] * 3, "dtype": "<f4",
        "compressor": None, "fill_value": -4, "order": "C", "filters": None}))
    for cz in range(N // CHUNK):
        for cy in range(N // CHUNK):
            for cx in range(N // CHUNK):
                values = [max(-4.0, min(4.0, depth(cx * CHUNK + i, cy * CHUNK + j, cz * CHUNK + k)))
                          for k in range(CHUNK) for j in range(CHUNK) for i in range(CHUNK)]
                if max(values) > -4:
                    (path / "0" / f"{cz}.{cy}.{cx}").write_bytes(
                        struct.pack(f"<{len(values)}f", *values))


def read_ply(path):
    """Points by their bytes, and triangles as those, each from its least corner on."""
    data = path.read_bytes()
    head, body = data.split(b"end_header\n", 1)
    vertices = int(head.split(b"element vertex ")[1].split()[0])
    faces = int(head.split(b"element face ")[1].split()[0])
    points = [body[36 * v:36 * v + 24] for v in range(vertices)]
    triangles = set()
    for t in range(faces):
        _, *corners = struct.unpack_from("<B3i", body, 36 * vertices + 13 * t)
        named = [points[c] for c in corners]
        least = named.index(min(named))
        triangles.add(tuple(named[least:] + named[:least]))
    assert len(body) == 36 * vertices + 13 * faces and len(triangles) == faces
    return set(points), triangles


class GiantTest(ApplicationTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.shared = Path(tempfile.mkdtemp())
        write_zarr(cls.shared / "balls.zarr")
        cls.zarr = str(cls.shared / "balls.zarr")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared)
        super().tearDownClass()

    def giant(self, *arguments, code=OK):
        done = subprocess.run([GIANT, *map(str, arguments)], cwd=self.path("."), text=True,
                              capture_output=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def refuse(self, code, pattern, *arguments):
        done = self.giant(*arguments, code=code)
        lines = [line for line in done.stderr.splitlines() if "warning:" not in line]
        self.assertRegex(lines[0], pattern)
        self.assertLessEqual(len(lines), 2)

    def plan(self, work, *options):
        self.giant("plan", work, "--input", self.zarr, "--iso", ISO, "--tile", 32, *options,
                   "--no-warnings")
        return json.loads(self.path(f"{work}/plan.json").read_text())

    def join(self, work, output, *options):
        self.giant("join", work, "-o", output, "--json", "report.json", *options)
        return json.loads(self.path("report.json").read_text())


class MarchingCubes(GiantTest):
    def test_tiles_are_the_surface_of_the_whole_volume(self):
        plan = self.plan("work", "--method", "mc")
        self.assertLess(len(plan["tiles"]), 64)
        self.giant("tile", "work")
        report = self.join("work", "tiles.ply")
        subprocess.run([MESH, self.zarr, "--iso", str(ISO), "--method", "mc", "-o", "one.ply", "-q",
                        "--no-warnings", "--json", "one.json"], cwd=self.path("."), check=True)
        self.assertEqual(read_ply(self.path("tiles.ply")), read_ply(self.path("one.ply")))
        one = json.loads(self.path("one.json").read_text())["surfaces"][0]
        for key in ("triangles", "vertices", "genus", "componentCount"):
            self.assertEqual(report[key], one[key], key)
        for key in ("areaMm2", "volumeMm3"):
            self.assertAlmostEqual(report[key] / one[key], 1, 12)
        self.assertEqual((report["componentCount"], report["cavities"], report["closed"]),
                         (COMPONENTS, CAVITIES, True))
        self.assertEqual(sum(c["cavity"] for c in report["components"]), CAVITIES)

    def test_pieces_for_paraview_and_a_preview(self):
        self.giant("run", "work", "--input", self.zarr, "--iso", ISO, "--tile", 32, "--method",
                   "mc", "-o", "balls.pvtp", "--preview", "coarse.vtp", "--report", "balls.html",
                   "--no-warnings")
        page = self.path("balls.html").read_text()
        for words in ("7 components, closed", "of them cavities", "coarse copy"):
            self.assertIn(words, page)
        self.assertNotIn(str(self.folder), page)
        text = self.path("balls.pvtp").read_text()
        pieces = sorted(self.path("balls").iterdir())
        self.assertEqual(text.count("<Piece "), len(pieces))
        for piece in pieces:
            self.assertIn(f'Source="balls/{piece.name}"', text)
        self.assertTrue(self.path("coarse.vtp").is_file())
        checked = subprocess.run([CHECK, "coarse.vtp", "--json", "-", "-q"], cwd=self.path("."),
                                 capture_output=True, text=True)
        self.assertIn(checked.returncode, (0, 1), checked.stderr)

    def test_other_images_are_read_too(self):
        write_nifti(self.path("ball.nii"), ball(40, 15))
        for command in (["run", "work", "--input", "ball.nii", "--iso", 100, "--tile", 32,
                         "--method", "mc", "-o", "tiles.ply", "--no-warnings"],):
            self.giant(*command)
        subprocess.run([MESH, "ball.nii", "--iso", "100", "--method", "mc", "-o", "one.ply", "-q"],
                       cwd=self.path("."), check=True)
        self.assertEqual(read_ply(self.path("tiles.ply")), read_ply(self.path("one.ply")))


class Adaptive(GiantTest):
    def test_the_bytes_do_not_depend_on_order_workers_or_kills(self):
        self.giant("run", "first", "--input", self.zarr, "--iso", ISO, "--tile", 32, "-o",
                   "first.ply", "--json", "first.json", "--no-warnings")
        report = json.loads(self.path("first.json").read_text())
        self.assertEqual((report["componentCount"], report["cavities"], report["closed"],
                          report["unchangedPieces"]), (COMPONENTS, CAVITIES, True, 0))
        self.assertLessEqual(report["errorBoundMm"], report["maxErrorMm"])
        truth = self.path("first.ply").read_bytes()

        self.giant("run", "two", "--input", self.zarr, "--iso", ISO, "--tile", 32, "--workers", 2,
                   "-o", "two.ply", "--no-warnings")
        self.assertEqual(self.path("two.ply").read_bytes(), truth)

        chance = random.Random(5)
        for order in range(5):
            work = f"order{order}"
            plan = self.plan(work)
            for stage in ("tile", "seam"):
                left = list(plan[stage + "s"])
                chance.shuffle(left)
                for begin in range(0, len(left), 5):
                    group = left[begin:begin + 5]
                    child = subprocess.Popen([GIANT, stage, work, *group, "-q", "--no-warnings"],
                                             cwd=self.path("."))
                    if chance.random() < 0.4:
                        time.sleep(chance.uniform(0, 0.15))
                        child.send_signal(signal.SIGKILL)
                    child.wait()
                self.giant(stage, work)
            self.join(work, f"{work}.ply")
            self.assertEqual(self.path(f"{work}.ply").read_bytes(), truth, order)

    def test_the_surface_is_sound_and_within_the_bound(self):
        self.giant("run", "work", "--input", self.zarr, "--iso", ISO, "--tile", 32, "--max-error",
                   "0.004", "-o", "small.ply", "--no-warnings")
        self.giant("run", "full", "--input", self.zarr, "--iso", ISO, "--tile", 32, "--method",
                   "mc", "-o", "full.ply", "--no-warnings")
        done = subprocess.run([CHECK, "small.ply", "--json", "-", "-q"], cwd=self.path("."),
                              capture_output=True, text=True)
        surface = json.loads(done.stdout)["surfaces"][0]
        self.assertTrue(surface["passed"], surface["failed"])
        compared = subprocess.run([str(BIN / "adaptiso-compare"), "small.ply", "full.ply", "--json",
                                   "-", "-q"], cwd=self.path("."), capture_output=True, text=True)
        distance = json.loads(compared.stdout)
        self.assertLessEqual(distance["distances"]["combined"]["maxMm"], 0.004)
        small, full = read_ply(self.path("small.ply")), read_ply(self.path("full.ply"))
        self.assertLess(4 * len(small[1]), len(full[1]))


class Restart(GiantTest):
    def test_what_is_there_is_not_made_again(self):
        self.plan("work", "--method", "mc")
        first = json.loads(self.giant("tile", "work", "--json", "-", "-q").stdout)
        again = json.loads(self.giant("tile", "work", "--json", "-", "-q").stdout)
        self.assertEqual((again["made"], again["found"]), (0, first["made"]))

    def test_changed_inputs_options_and_damage_are_noticed(self):
        shutil.copytree(self.zarr, self.path("mine.zarr"))
        plan = ["plan", "work", "--input", "mine.zarr", "--tile", 32, "--method", "mc",
                "--no-warnings", "--iso"]
        def made():
            return json.loads(self.giant("tile", "work", "--json", "-", "-q").stdout)["made"]
        self.giant(*plan, 0)
        count = made()
        chunk = self.path("mine.zarr/0/2.2.2")
        chunk.write_bytes(chunk.read_bytes()[:-4] + struct.pack("<f", 3))
        self.assertIn(made(), range(1, 9))  # the tiles that the chunk lies in
        self.giant(*plan, 1)
        self.assertEqual(made(), count)
        piece = sorted(self.path("work/tiles").iterdir())[3]
        piece.write_bytes(piece.read_bytes()[:100])
        self.assertEqual(made(), 1)
        piece.unlink()
        self.refuse(BAD_INPUT, r"1 of \d+ pieces are not there.*run: adaptiso-giant tile", "join",
                    "work")

    def test_seams_of_tiles_that_were_made_again_are_not_joined(self):
        shutil.copytree(self.zarr, self.path("mine.zarr"))
        self.giant("run", "work", "--input", "mine.zarr", "--iso", ISO, "--tile", 32, "-o", "a.ply",
                   "--no-warnings")
        chunk = self.path("mine.zarr/0/1.1.1")  # within the hollow ball, off all walls
        chunk.write_bytes(chunk.read_bytes()[:-4] + struct.pack("<f", 3))
        self.giant("tile", "work", "-q")
        self.refuse(BAD_INPUT, r"its tiles were made again since; run: adaptiso-giant seam", "join",
                    "work", "-o", "b.ply")
        self.assertFalse(self.path("b.ply").exists())
        self.giant("seam", "work", "-q")
        self.giant("join", "work", "-o", "b.ply", "-q")
        self.giant("run", "new", "--input", "mine.zarr", "--iso", ISO, "--tile", 32, "-o", "c.ply",
                   "--no-warnings")
        self.assertEqual(self.path("b.ply").read_bytes(), self.path("c.ply").read_bytes())

    def test_a_damaged_piece_is_refused_by_the_join(self):
        self.plan("work", "--method", "mc")
        self.giant("tile", "work")
        piece = max(self.path("work/tiles").iterdir(), key=lambda p: p.stat().st_size)
        data = bytearray(piece.read_bytes())
        data[-100] ^= 1
        piece.write_bytes(data)
        self.refuse(BAD_INPUT, r"is damaged \(checksum\); remove it", "join", "work", "-o", "a.ply")
        self.assertFalse(self.path("a.ply").exists())


class Workflow(GiantTest):
    @unittest.skipUnless(shutil.which("snakemake"), "no snakemake")
    def test_the_snakefile_makes_the_same_bytes(self):
        self.giant("run", "here", "--input", self.zarr, "--iso", ISO, "--tile", 32, "-o",
                   "here.ply", "--no-warnings")
        for method in ("adaptive", "mc"):
            folder = self.path(method)
            shutil.copytree(SOURCE / "Examples/giant", folder)
            (folder / "config.yaml").write_text(
                f"image: {self.zarr}\niso: {ISO}\noptions: --tile 32 --method {method}\n"
                f"program: {GIANT}\nwork: work\noutput: out.ply\ngroup: 9\n")
            done = subprocess.run(["snakemake", "--cores", "2", "--nocolor", "-q"], cwd=folder,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, OK, done.stderr)
        self.assertEqual(self.path("adaptive/out.ply").read_bytes(),
                         self.path("here.ply").read_bytes())
        report = json.loads(self.path("mc/out.ply.json").read_text())
        self.assertEqual((report["componentCount"], report["closed"]), (COMPONENTS, True))


class Refusals(GiantTest):
    def test_usage(self):
        zarr = self.zarr
        self.refuse(USAGE, "--input is missing", "plan", "work", "--iso", 0)
        self.refuse(USAGE, "--iso is missing", "run", "work", "--input", zarr)
        self.refuse(USAGE, "multiple of 32", "plan", "work", "--input", zarr, "--iso", 0, "--tile",
                    100)
        self.refuse(USAGE, "--max-error: is for", "plan", "work", "--input", zarr, "--iso", 0,
                    "--method", "mc", "--max-error", 1)
        for words, reason in (("--method boxes", "may be as long as the volume"),
                              ("--method dnc", "must be adaptive or mc"),
                              ("--triangles 100", "over the whole volume; take --max-error"),
                              ("--reduction 0.9", "over the whole volume"),
                              ("--largest", "known when tiles are joined"),
                              ("--min-volume 3", "known when tiles are joined"),
                              ("--border open", "join proves that the surface is closed")):
            self.refuse(USAGE, f"{words.split()[0]}.*{reason}", "plan", "work", "--input", zarr,
                        "--iso", 0, *words.split())
        self.refuse(USAGE, "--iso: the plan says it", "tile", "work", "--iso", 3)
        self.refuse(USAGE, "must end in .ply or .pvtp", "join", "work", "-o", "a.stl")
        self.refuse(USAGE, "ID: only the steps", "join", "work", "0_0_0")

    def test_bad_input(self):
        self.refuse(BAD_INPUT, "there is no plan", "tile", "work")
        self.plan("work", "--method", "mc")
        self.refuse(USAGE, "--preview ./a.ply: is the name of another output too", "join", "work",
                    "-o", "a.ply", "--preview", "./a.ply")
        self.refuse(USAGE, "9_9_9: the plan has no tile", "tile", "work", "9_9_9")
        self.refuse(USAGE, "whose tiles need none", "seam", "work")
        self.path("work/plan.json").write_text('{"schema": "adaptiso-giant-plan/1"}')
        self.refuse(BAD_INPUT, "is no plan of adaptiso-giant, or damaged", "tile", "work")
        self.plan("adaptive")
        plan = json.loads(self.path("adaptive/plan.json").read_text())
        self.refuse(BAD_INPUT, "is not there.*run: adaptiso-giant tile adaptive", "seam",
                    "adaptive", plan["seams"][0])

    def test_another_plan_in_the_same_folder_meanwhile(self):
        command = [GIANT, "run", "work", "--input", self.zarr, "--tile", "32", "--method", "mc", "-q",
                   "--no-warnings"]
        first = subprocess.Popen([*command, "--iso", "0", "-o", "a.ply"], cwd=self.path("."),
                                 stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + 60
        while not self.path("work/plan.json").exists() and time.monotonic() < end:
            time.sleep(0.005)
        subprocess.run([*command, "--iso", "1", "-o", "b.ply"], cwd=self.path("."), check=False,
                       capture_output=True)
        errors = first.communicate()[1]
        if first.returncode == OK:  # it was done before the other planned
            return
        self.assertEqual(first.returncode, BAD_INPUT, errors)
        self.assertEqual(len(errors.splitlines()), 1)
        self.assertFalse(self.path("a.ply").exists())

    def test_no_surface(self):
        self.giant("plan", "work", "--input", self.zarr, "--iso", 100, "--tile", 32,
                   "--no-warnings")
        self.giant("tile", "work")
        self.giant("seam", "work")
        self.refuse(BAD_INPUT, "no surface", "join", "work", "-o", "a.ply")
        self.giant("join", "work")


if __name__ == "__main__":
    main()
