"""Documentation/Recipes.md and the tutorials but that of EEG, every command of them, on images made here. Needs Debian's python3-nibabel;
exits 77 (skipped) without it."""

import csv
import importlib.util
import json
import subprocess
import sys
import unittest
from pathlib import Path

from documents import commands, run
from support import ApplicationTest, Image, ball, from_function, main, write_nifti


def radius(x, y, z):
    return (x * x + y * y + z * z) ** 0.5


def ct():
    """int16, HU: a ball of soft tissue with a ball of bone in it, and a speck of bone beside that."""
    def value(x, y, z):
        depth = max(8.3 - radius(x, y, z), 2.2 - radius(x, y + 11, z))  # voxels
        bone = min(1000, 400 * max(depth, 0))
        return round(40 + bone) if radius(x, y, z) < 13.6 else -1000
    return from_function(32, "h", value, spacing=(2, 2, 2))


def atlas():
    """Three regions that share borders: labels 1, 2 and 7 of a ball."""
    def value(x, y, z):
        return 0 if radius(x, y, z) > 10 else 1 if x < -2 else 2 if y < 0 else 7
    image = from_function(26, "B", value)
    return Image(image.size, "B", bytes(image.samples))


class Recipes(ApplicationTest):
    def make(self, name, image):
        path = self.path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_nifti(path, image)
        subprocess.run(["gzip", path], check=True)

    def make_study(self):
        for subject in ("01", "02"):
            self.make(f"study/sub-{subject}/anat/sub-{subject}_T1w.nii", ball(24, 8))
        self.path("study/dataset_description.json").write_text('{"Name": "x", "BIDSVersion": "1.8.0"}')

    def test_commands_run(self):
        self.make("ct.nii", ct())
        self.make("atlas.nii", atlas())
        self.make_study()
        done = run(commands("Recipes.md"), self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

        # 250 HU is at 8.3 - 210 / 400 = 7.775 voxels of 2 mm: 15,750 mm3. A mesh 0.3 mm off, and
        # chords 0.1 mm off (0.05 voxels), make 3 * 0.4 / 15.55 of that; the speck is gone
        bone = self.surface("bone.ply")
        self.assertAlmostEqual(bone["volumeMm3"], 15_750, delta=0.08 * 15_750)
        self.assertEqual(bone["componentCount"], 1)
        self.assertLessEqual(self.surface("bone-600.ply")["triangles"], 600)
        # less bone the higher the value
        volumes = [self.surface(f"bone-{value}.vtp")["volumeMm3"] for value in (200, 250, 300)]
        self.assertEqual(volumes, sorted(volumes, reverse=True))
        # a Gaussian of 1 mm, half a voxel, moves the surface by a few hundredths of a voxel
        self.assertAlmostEqual(self.surface("print.stl")["volumeMm3"], volumes[1],
                               delta=0.03 * volumes[1])
        self.assertEqual(sorted(path.name for path in self.path("regions/regions").iterdir()), ["1.gii", "2.gii", "7.gii"])
        self.assertEqual(sorted(path.name for path in self.path("two-regions/regions").iterdir()), ["1.vtp", "7.vtp"])
        # both subjects have the same image
        distance = json.loads(self.path("distance.json").read_text())
        self.assertLess(distance["distances"]["combined"]["maxMm"], 1e-12)  # rounding
        self.assertIn('<html', self.path("print.html").read_text())
        self.assertIn("bone.stl: 0", done.stdout)
        with open(self.path("app/quality.tsv"), newline="") as table:
            rows = list(csv.DictReader(table, delimiter="\t"))
        self.assertEqual([(row["participant_id"], row["check"]) for row in rows],
                         [("sub-01", "passed"), ("sub-02", "passed")])

    def test_print_tutorial_ends_in_a_solid(self):
        self.make("ct.nii", ct())
        done = run(commands("TutorialPrint.md"), self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("=> passed as print", done.stdout)

    @unittest.skipUnless(Path("/usr/share/mricron/templates/aal.nii.gz").exists(), "mricron-data is not installed")
    def test_atlas_tutorial_ends_in_regions(self):
        done = run(commands("TutorialAtlas.md"), self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"(?m)^37 +Hippocampus_L ")
        self.assertRegex(done.stdout, r"(?m)^38 +Hippocampus_R ")

    def test_quality_tutorial_ends_in_a_table(self):
        self.make_study()
        done = run(commands("TutorialQuality.md"), self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("qa/quality.tsv and qa/summary.html are written", done.stdout)

    def surface(self, name):
        done = run(f"adaptiso-check {name} --profile view --json -", self.folder)
        return json.loads(done.stdout)["surfaces"][0]


if __name__ == "__main__":
    if not importlib.util.find_spec("nibabel"):
        print("skipped: needs python3-nibabel")
        sys.exit(77)
    main()
