"""The examples of the docstrings run, the docstrings are complete, and the types hold."""

import ast
import contextlib
import doctest
import importlib
import importlib.util
import inspect
import io
import json
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

import adaptiso
import numpy as np
from adaptiso import _options
from support import BIN, BRAIN, InFolder, ball, needs

ROOT = Path(os.environ["ADAPTISO_SOURCE"])
SOURCE = ROOT / "Wrapping" / "Python"


class Docstrings(unittest.TestCase):
    @unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
    def test_examples_run(self):
        tried = 0
        for name in ("adaptiso", *(f"adaptiso.{part}" for part in (
                "_bem", "_images", "_labels", "_surface", "_mesh", "_quality", "_marching_cubes",
                "_mend", "_simplify", "giant", "vtk"))):
            if name == "adaptiso.vtk" and importlib.util.find_spec("vtkmodules") is None:
                continue
            module = importlib.import_module(name)
            result = doctest.testmod(module)
            self.assertEqual(result.failed, 0, name)
            tried += result.attempted
        self.assertGreater(tried, 30)

    def test_everything_public_is_documented(self):
        for name in adaptiso.__all__:
            thing = getattr(adaptiso, name)
            if name == "__version__" or inspect.ismodule(thing):
                continue
            self.assertGreater(len(inspect.getdoc(thing) or ""), 30, name)
            if inspect.isclass(thing) and not issubclass(thing, (tuple, Exception)):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (callable(value)
                                                       or isinstance(value, property)):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{member}")

    def test_every_parameter_is_documented(self):
        for function in (adaptiso.surface, adaptiso.bem, adaptiso.labels, adaptiso.simplify, adaptiso.mend,
                         adaptiso.read, adaptiso.check, adaptiso.check_nested,
                         adaptiso.compare, adaptiso.marching_cubes, adaptiso.load,
                         *(getattr(adaptiso.giant, name) for name in adaptiso.giant.__all__
                           if name != "Plan")):
            text = inspect.getdoc(function)
            for parameter in inspect.signature(function).parameters:
                self.assertRegex(text, rf"(?m)^[\w, ]*\b{parameter}\b", f"{function.__name__}")


class Package(unittest.TestCase):
    def test_no_module_imports_one_that_imports_it(self):
        needed = {}
        for file in (SOURCE / "adaptiso").glob("*.py"):
            found = needed[file.stem] = set()
            for node in ast.walk(ast.parse(file.read_text())):
                if isinstance(node, ast.ImportFrom) and node.level == 1:
                    found.update([node.module] if node.module else [each.name for each in node.names])
        while free := [name for name, found in needed.items() if not found & needed.keys()]:
            for name in free:
                del needed[name]
        self.assertEqual(needed, {})


def blocks_of(page, *changes):
    """The page's blocks of Python, in their order. \\param changes  pairs of texts: the first, which is
    somewhere in a block, becomes the second"""
    blocks = re.findall(r"(?ms)^```python\n(.*?)^```$", (ROOT / page).read_text())
    for before, after in changes:
        if not any(before in block for block in blocks):
            raise AssertionError(f"{page}: nothing says {before}")
        blocks = [block.replace(before, after) for block in blocks]
    return blocks


@unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
@needs("nibabel")
class Pages(InFolder):
    """Blocks of pages run as they stand there, one after the other, in a folder with the files they name."""

    def setUp(self):
        super().setUp()
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        self.write_coarse("T1.nii.gz", BRAIN.with_name("ch2.nii.gz"))
        for name in ("brain.nii.gz", "scan.nii.gz"):
            self.write_coarse(name, BRAIN)

    def write_coarse(self, name, scan):
        """Every other voxel along each axis, so that what a page does with a whole head takes seconds."""
        import nibabel
        image = nibabel.load(scan)
        nibabel.save(nibabel.Nifti1Image(np.asarray(image.dataobj)[::2, ::2, ::2],
                                         image.affine @ np.diag([2, 2, 2, 1])), name)

    def run_blocks(self, blocks):
        """\\return what they have named"""
        names = {}
        for block in blocks:
            with self.subTest(block=block.splitlines()[0]), contextlib.redirect_stdout(io.StringIO()):
                exec(compile(block, "page", "exec"), names)
        return names

    def write_labels(self):
        """A part of an atlas, every other voxel, with the label that the page asks for."""
        import nibabel
        atlas = nibabel.load(BRAIN.with_name("aal.nii.gz"))
        labels = np.asarray(atlas.dataobj)[::2, ::2, ::2]
        at = np.argwhere(labels == 17)
        part = tuple(slice(low, high) for low, high in zip(at.min(axis=0) - 2, at.max(axis=0) + 3))
        nibabel.save(nibabel.Nifti1Image(labels[part], atlas.affine @ np.diag([2, 2, 2, 1])),
                     "aparc+aseg.nii.gz")

    def write_zarr(self):
        """A ball of radius 30 mm in one chunk of 80 voxels a side."""
        array = self.folder / "brain.zarr"
        array.mkdir()
        (array / ".zarray").write_text(json.dumps({
            "zarr_format": 2, "shape": [80] * 3, "chunks": [80] * 3, "dtype": "<f4", "compressor": None,
            "filters": None, "fill_value": 0, "order": "C"}))
        (array / "0.0.0").write_bytes((150 + ball((80, 80, 80))).astype("<f4").tobytes())

    def assert_like_a_sphere(self, forward, info):
        """Lead fields of a head and of the sphere that fits its electrodes are alike: no frame or order is mixed up."""
        import mne
        sphere = mne.make_sphere_model("auto", "auto", info, verbose=False)
        other = mne.make_forward_solution(info, forward["mri_head_t"], forward["src"], sphere, meg=False, verbose=False)
        fields = [one["sol"]["data"] - one["sol"]["data"].mean(axis=0) for one in (forward, other)]
        self.assertEqual(fields[0].shape, (21, 3 * forward["nsource"]))
        alike = [np.corrcoef(a, b)[0, 1] for a, b in zip(fields[0].T, fields[1].T)]
        self.assertGreater(np.median(alike), 0.9)

    @needs("mne", "tqdm")
    @unittest.skipUnless((BIN / "adaptiso-giant").exists(), "built without programs")
    def test_python(self):
        self.write_labels()
        self.write_zarr()
        # MNE's solution of 2,562 vertices takes minutes
        blocks = blocks_of("Documentation/Python.md", ("vertices=2562", "vertices=162"))
        self.assertEqual(len(blocks), 7)
        path = f"{BIN}{os.pathsep}{os.environ.get('PATH', '')}"
        with mock.patch.dict(os.environ, {"PATH": path}), contextlib.redirect_stderr(io.StringIO()):
            made = self.run_blocks(blocks)
        self.assertIn("solution", made["bem"])
        self.assert_like_a_sphere(made["forward"], made["info"])
        self.assertTrue(adaptiso.check(made["walls"].region(17)))
        self.assertAlmostEqual(made["report"]["volumeMm3"], 4 / 3 * np.pi * 30**3, delta=1000)
        for name in ("head.stl", "hippocampus.stl", "walls.vtp", "brain.pvtp", "coarse.ply", "brain.ply"):
            self.assertTrue((self.folder / name).exists(), name)

    def test_the_first_example_prints_what_the_page_says(self):
        """Compares the line about ch2; ADAPTISO_RENEW_PAGES=1 writes the line anew instead."""
        page = ROOT / "Documentation" / "Python.md"
        scan = BRAIN.with_name("ch2.nii.gz")
        made = self.run_blocks(blocks_of("Documentation/Python.md", ('"T1.nii.gz"', f'"{scan}"'))[:1])
        text = page.read_text()
        said = re.search(r"print\(mesh\) +# (.*)", text).group(1)
        if os.environ.get("ADAPTISO_RENEW_PAGES"):
            page.write_text(text.replace(said, str(made["mesh"])))
        else:
            self.assertEqual(said, str(made["mesh"]))

    @needs("vtkmodules")
    def test_readme(self):
        made = self.run_blocks(blocks_of("README.md"))
        self.assertEqual(made["polydata"].GetNumberOfCells(), len(made["mesh"].faces))

    @needs("vtkmodules")
    def test_vtk(self):
        made = self.run_blocks(blocks_of("Documentation/Vtk.md"))
        self.assertGreater(made["polydata"].GetNumberOfCells(), 100)


class Types(unittest.TestCase):
    @unittest.skipIf(importlib.util.find_spec("mypy") is None, "not installed: mypy")
    def test_mypy_is_content(self):
        done = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", os.devnull,
                               "--config-file", SOURCE / "mypy.ini", SOURCE / "adaptiso"],
                              text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_types_of_options_are_those_of_the_rows(self):
        """ADAPTISO_RENEW_PAGES=1 writes them anew."""
        made = _options.type_text()
        file = SOURCE / "adaptiso" / "_option_types.py"
        if os.environ.get("ADAPTISO_RENEW_PAGES"):
            file.write_text(made)
        self.assertEqual(file.read_text(), made)

    def test_the_package_says_that_it_has_types(self):
        self.assertTrue((Path(adaptiso.__file__).parent / "py.typed").is_file())


if __name__ == "__main__":
    unittest.main(verbosity=2)
