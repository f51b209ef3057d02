"""Tetrahedra of adaptiso-bem by tetgen and gmsh, as programs: what meshio and gmsh read back, and what is said
where a mesher is missing. What is not installed is skipped by name."""

import math
import os
import shutil
import signal
import subprocess
import time
import unittest

from support import BAD_INPUT, USAGE, Image, main, write_nifti
from bemSupport import BEM, BemTest, head

try:
    import meshio
    import numpy as np
except ImportError:
    meshio = None

MESHERS = [mesher for mesher in ("tetgen", "gmsh") if shutil.which(mesher)]
RADII = (54, 60, 66, 72)
FOUR = [word for pair in ("brain=4", "csf=1", "skull=2", "scalp=3") for word in ("--tissue", pair)]


def read_msh22(path, expected=frozenset((1002, 1003, 1004, 1005))):
    """Points, corners (from 1) and tissues of the tetrahedra; the tissues' surfaces have other numbers."""
    lines = path.read_text().split("\n")
    at = lines.index("$Nodes")
    count = int(lines[at + 1])
    points = [tuple(map(float, line.split()[1:])) for line in lines[at + 2:at + 2 + count]]
    at = lines.index("$Elements")
    rows = [list(map(int, line.split())) for line in lines[at + 2:at + 2 + int(lines[at + 1])]]
    surfaces = {row[3] for row in rows if row[1] == 2}
    assert surfaces == expected, surfaces  # as SimNIBS looks for them
    rows = [row for row in rows if row[1] == 4]
    return points, [row[5:] for row in rows], [row[3] for row in rows]


class Tetrahedra(BemTest):
    def four_layers(self):
        write_nifti(self.path("seg.nii"), head(radii=RADII, values=(4, 1, 2, 3)))
        return ("--labels", "seg.nii", *FOUR, "--layers", "4", "--voxel", "3", "--vertices", "200",
                "--closing", "4")

    def test_meshers_fill_the_layers(self):
        for mesher in MESHERS:
            with self.subTest(mesher):
                self.bem(*self.four_layers(), "--tetrahedra", mesher, "--element-size", "8", "-o", mesher)
                report = self.report(mesher)
                self.assertEqual(report["tetrahedra"]["mesher"], mesher)
                layers = report["tetrahedra"]["layers"]
                self.assertEqual([(l["tissue"], l["number"]) for l in layers],
                                 [("brain", 2), ("csf", 3), ("skull", 4), ("scalp", 5)])
                within = 0
                for layer, radius in zip(layers, RADII):
                    ball = 4 / 3 * math.pi * radius ** 3
                    # 200 vertices lie on the sphere, faces within it; voxels of 4 mm
                    self.assertAlmostEqual(layer["volumeMm3"] / (ball - within), 0.97, delta=0.13)
                    self.assertAlmostEqual(layer["volumeMm3"] / layer["betweenSurfacesMm3"], 1, 4)
                    within = ball
                self.assertGreater(report["tetrahedra"]["dihedralDeg"]["minimum"], 1)
                self.assertTrue(all(check["passed"] for check in report["checks"]))

    def test_a_hole_in_the_skull_stays_open(self):
        """A craniotomy: the surfaces close it, its tetrahedra are scalp. Beside it the skull is whole."""
        radii, hole = (60, 68, 76), 30
        image = head(radii=radii)
        n, step = image.size[0], image.spacing[0]
        samples = bytearray(image.samples)
        for at, label in enumerate(samples):
            x, y, z = (step * (v - (n - 1) / 2) for v in (at % n, at // n % n, at // n // n))
            if label == 2 and x > 0 and y * y + z * z < hole * hole:
                samples[at] = 3
        write_nifti(self.path("holed.nii"), Image(image.size, "B", bytes(samples), image.spacing, image.origin))
        for mesher in MESHERS:
            self.bem("--labels", "holed.nii", "--tissue", "brain=1", "--tissue", "skull=2", "--tissue", "scalp=3", "--voxel", "3",
                     "--vertices", "642", "--closing", "4", "--tetrahedra", mesher, "--element-size", "6", "--force", "-o", "holed")
            note, = [note for note in self.report("holed")["notes"] if "are scalp" in note]
            self.assertRegex(note, r"^tetrahedra: [\d,]+ of the skull's \([\d.]+ cm3\), in holes")
            points, corners, tissues = read_msh22(self.path("holed") / "head.msh", {1002, 1004, 1005})
            for corner, tissue in zip(corners, tissues):
                x, y, z = (sum(points[v - 1][a] for v in corner) / 4 for a in range(3))
                beside = math.hypot(y, z)
                # voxels of 4 mm, elements of 6 mm on both sides of the rim
                if x > 0 and beside < hole - 7:
                    self.assertNotEqual(tissue, 4, (mesher, x, y, z))
                elif beside > hole + 7 and 62 < math.dist((x, y, z), (0, 0, 0)) < 66:
                    self.assertEqual(tissue, 4, (mesher, x, y, z))
            layers = {l["tissue"]: l["volumeMm3"] for l in self.report("holed")["tetrahedra"]["layers"]}
            cap = (1 - math.cos(math.asin(hole / 64))) / 2  # of a sphere
            shell = 4 / 3 * math.pi * (68 ** 3 - 60 ** 3)
            self.assertAlmostEqual(layers["skull"] / ((1 - cap) * shell), 1, delta=0.06)

    def test_a_size_that_the_surfaces_do_not_allow_is_noted(self):
        # 200 vertices on a sphere of 60 mm: edges of 16 mm
        for mesher, size, layers in (("tetgen", "8", set()), ("gmsh", "8", {"csf", "skull", "scalp"}), ("gmsh", "16", set())):
            if mesher not in MESHERS:
                continue
            self.bem(*self.four_layers(), "--tetrahedra", mesher, "--element-size", size, "--force", "-o", mesher)
            noted = {note.split(":")[0] for note in self.report(mesher)["notes"] if "--element-size" in note}
            self.assertEqual(noted - {"brain"}, layers, (mesher, size))

    @unittest.skipUnless(meshio, "needs python3-meshio")
    def test_meshio_reads_all_formats_alike(self):
        if not MESHERS:
            self.skipTest("needs tetgen or gmsh")
        self.bem(*self.four_layers(), "--tetrahedra", MESHERS[0], "--element-size", "10", "-o", "model")
        total = sum(l["tetrahedra"] for l in self.report()["tetrahedra"]["layers"])
        centroids = []
        for name, key in (("head.msh", "gmsh:physical"), ("head-4.1.msh", "gmsh:physical"),
                          ("head.vtu", "tissue")):
            mesh = meshio.read(self.path("model") / name)
            cells = np.concatenate([c.data for c in mesh.cells if c.type == "tetra"])
            tissues = np.concatenate([data for data, c in zip(mesh.cell_data[key], mesh.cells)
                                      if c.type == "tetra"])
            self.assertEqual(len(cells), total)
            self.assertEqual(set(tissues), {2, 3, 4, 5})
            corners = mesh.points[cells]
            volumes = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0],
                                                     corners[:, 2] - corners[:, 0]),
                                corners[:, 3] - corners[:, 0]) / 6
            self.assertGreater(volumes.min(), 0)
            distance = np.linalg.norm(corners.mean(axis=1), axis=1)
            self.assertLess(distance[tissues == 2].max(), 56)
            self.assertGreater(distance[tissues == 5].min(), 62)
            centroids.append(sorted(map(tuple, np.round(corners.mean(axis=1), 4))))
        self.assertEqual(centroids[0], centroids[1])
        self.assertEqual(centroids[0], centroids[2])
        if shutil.which("gmsh"):
            done = subprocess.run(["gmsh", "-check", "head-4.1.msh"], cwd=self.path("model"), text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
            self.assertNotIn("Error", done.stdout)

    def test_the_files_for_duneuro_hold_the_same(self):
        """The parameters of .dgf are places in head.cond."""
        if not MESHERS:
            self.skipTest("needs tetgen or gmsh")
        self.bem(*self.four_layers(), "--tetrahedra", MESHERS[0], "--element-size", "20", "--conductivity",
                 "0.33,1.79,0.01,0.43", "-o", "model")
        folder = self.path("model")
        conductivities = [float(line) for line in (folder / "head.cond").read_text().split()]
        self.assertEqual(conductivities, [0.33, 1.79, 0.01, 0.43])
        points, corners, tissues = read_msh22(folder / "head.msh")
        vertices, simplices = (folder / "head.dgf").read_text().split("#\n")[:2]
        rows = [list(map(int, line.split())) for line in simplices.splitlines()[2:]]
        self.assertEqual([row[:4] for row in rows], [[v - 1 for v in row] for row in corners])
        self.assertEqual([row[4] for row in rows], [t - 2 for t in tissues])
        self.assertEqual([tuple(map(float, line.split())) for line in vertices.splitlines()[2:]], points)

    def test_a_signal_leaves_neither_files_nor_the_mesher(self):
        fake, scratch = self.path("tetgen"), self.path("scratch")
        fake.write_text("#!/bin/sh\necho $$ >\"$MARK\"\nexec sleep 600\n")
        fake.chmod(0o755)
        scratch.mkdir()
        mark = self.path("mark")
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(number):
                mark.unlink(missing_ok=True)
                process = subprocess.Popen(
                    [BEM, *map(str, self.labels()), "--tetrahedra", "tetgen", "-o", "m"], cwd=self.folder,
                    stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                    env={**os.environ, "PATH": f"{self.folder}:/usr/bin:/bin", "TMPDIR": str(scratch),
                         "MARK": str(mark)})
                while process.poll() is None and not (mark.exists() and mark.read_text().endswith("\n")):
                    time.sleep(0.01)
                self.assertEqual(len(list(scratch.iterdir())), 1)
                process.send_signal(number)
                process.communicate(timeout=60)
                self.assertEqual(process.returncode, -number)
                self.assertEqual(list(scratch.iterdir()), [])
                self.assertFalse(self.path("m").exists())
                with self.assertRaises(ProcessLookupError):
                    os.kill(int(mark.read_text()), 0)

    def test_a_missing_mesher_is_told_at_once(self):
        labels = self.labels()
        done = subprocess.run([BEM, *map(str, labels), "--tetrahedra", "tetgen", "-o", "m"],
                              cwd=self.folder, text=True, capture_output=True,
                              env={**os.environ, "PATH": str(self.folder)})
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertIn("tetgen is not installed; on Debian: apt install tetgen", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_a_mesher_that_fails_is_told(self):
        fake = self.path("tetgen")
        fake.write_text("#!/bin/sh\necho 'Error: self-intersection'\nexit 3\n")
        fake.chmod(0o755)
        labels = self.labels()
        done = subprocess.run([BEM, *map(str, labels), "--tetrahedra", "tetgen", "-o", "m"],
                              cwd=self.folder, text=True, capture_output=True,
                              env={**os.environ, "PATH": f"{self.folder}:/usr/bin:/bin"})
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertIn("tetgen: made no tetrahedra (exit code 3, 'Error: self-intersection')", done.stderr)
        self.assertFalse(self.path("m").exists())

    def test_usage(self):
        self.fails(USAGE, r"--tetrahedra", *self.labels(), "--tetrahedra", "cgal", "-o", "m")
        self.fails(USAGE, r"--element-size 0.1: must be a number from 0.5 to 50, in mm", *self.labels(), "--element-size",
                   "0.1", "-o", "m")


if __name__ == "__main__":
    main()
