"""The scripts of Examples/python do what they say."""

import os
import subprocess
import sys
import unittest
from pathlib import Path

import adaptiso
from support import BRAIN, InFolder, ball, needs

EXAMPLES = Path(os.environ["ADAPTISO_SOURCE"]) / "Examples" / "python"


class Scripts(InFolder):
    def run_script(self, name, *arguments, code=0):
        """\\return what it prints"""
        environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
        done = subprocess.run([sys.executable, "-B", EXAMPLES / name, *map(str, arguments)], text=True,
                              cwd=self.folder, env=environment, capture_output=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout

    @needs("vtkmodules")
    @unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
    def test_brain_surface(self):
        out = self.run_script("brainSurface.py")
        mesh = adaptiso.load(self.folder / "brain.vtp")
        self.assertTrue(adaptiso.check(mesh))
        self.assertIn(f"brain.vtp: {len(mesh.faces):,} triangles, {mesh.volume / 1000:.0f} cm3", out)
        self.assertTrue(800e3 < mesh.volume < 2000e3, mesh.volume)  # of a brain, mm3

    @needs("mne")
    @unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
    def test_forward_solution(self):
        out = self.run_script("forwardSolution.py")
        self.assertIn("<adaptiso.HeadModel: inner_skull of 642 vertices", out)
        self.assertRegex(out, r"leadfield of 94 electrodes and \d{3} dipoles in 3 directions each")
        # ten lines, from the model to the forward solution
        text = (EXAMPLES / "forwardSolution.py").read_text()
        lines = text[text.index("model ="):text.index("\nprint(model)")].strip().splitlines()
        self.assertEqual(len(lines), 10)

    def test_cohort(self):
        scans = []
        for name, radius in (("small", 6), ("large", 9)):
            # inside 1, outside -1, so that the level between them is chosen
            scans.append(self.nrrd(name, (ball() + radius).clip(-1, 1).astype("<f4")))
        (self.folder / "broken.nrrd").write_text("no scan")
        self.assertIn("2 of 2 made", self.run_script("cohort.py", "surfaces", *scans))
        out = self.run_script("cohort.py", "surfaces", *scans, self.folder / "broken.nrrd", code=1)
        self.assertIn("2 of 3 made", out)
        self.assertIn("broken.nrrd: ", out)
        meshes = {name: adaptiso.load(self.folder / "surfaces" / f"{name}.stl")
                  for name in ("small", "large")}
        self.assertLess(meshes["small"].volume, meshes["large"].volume)

    def test_scripts_fail_where_they_make_nothing(self):
        self.run_script("cohort.py", "surfaces", code=1)
        self.run_script("cohort.py", "surfaces", "a/T1.nii", "b/T1.nii", code=1)  # both T1.stl
        self.run_script("qualityTable.py", code=1)
        self.run_script("qualityTable.py", "missing.ply", code=1)

    @needs("vtkmodules")
    def test_a_file_that_cannot_be_written_is_a_failure(self):
        scan = self.nrrd("scan", (ball() + 8).clip(-1, 1).astype("<f4"))
        (self.folder / "brain.vtp").mkdir()
        self.run_script("brainSurface.py", scan, 0, code=1)

    def nrrd(self, name, volume):
        """A file of a volume, RAS."""
        file = self.folder / f"{name}.nrrd"
        sizes = " ".join(map(str, volume.shape))
        file.write_bytes(
            f"NRRD0004\ntype: float\ndimension: 3\nspace: right-anterior-superior\nsizes: {sizes}\n"
            "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nendian: little\n"
            "encoding: raw\n\n".encode() + volume.tobytes(order="F"))
        return file

    @needs("pandas")
    def test_quality_table(self):
        mesh = adaptiso.surface(ball(), -8)
        mesh.save(self.folder / "whole.ply")
        adaptiso.Mesh(mesh.vertices, mesh.faces[1:]).save(self.folder / "open.ply")
        self.assertIn("1 of 1 pass", self.run_script("qualityTable.py", "whole.ply"))
        out = self.run_script("qualityTable.py", "whole.ply", "open.ply", code=1)
        self.assertIn("1 of 2 pass", out)
        table = (self.folder / "quality.csv").read_text().splitlines()
        self.assertTrue(table[0].startswith("mesh,passed,failed,triangles,genus"))
        self.assertTrue(table[1].startswith(f"whole.ply,True,,{len(mesh.faces)},0.0,"))
        self.assertTrue(table[2].startswith("open.ply,False,closed,"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
