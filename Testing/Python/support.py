"""What the tests of the Python package share: volumes with truth on paper, the programs."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

BIN = Path(os.environ["ADAPTISO_BIN"])
BRAIN = Path("/usr/share/mricron/templates/ch2bet.nii.gz")


def ball(shape=(24, 24, 24), center=None, affine=np.eye(4), dtype=np.float64):
    """Distance in mm from a voxel's place, negative: the level -r is a sphere of radius r."""
    center = (np.array(shape) - 1) / 2 if center is None else np.array(center, float)
    index = np.stack(np.indices(shape), axis=-1)
    step = np.asarray(affine)[:3, :3]
    return -np.linalg.norm((index - center) @ step.T, axis=-1).astype(dtype)


def place(affine, index):
    return np.asarray(affine)[:3, :3] @ np.array(index, float) + np.asarray(affine)[:3, 3]


def program(name, *arguments):
    """Runs a program. \\return its stdout"""
    done = subprocess.run([str(BIN / name), *map(str, arguments)], text=True, capture_output=True)
    if done.returncode not in (0, 1):
        raise AssertionError(done.stderr)
    return done.stdout


def needs(*modules):
    """Skips a test, by the module's name, where an optional package is missing."""
    import importlib.util
    missing = [name for name in modules if importlib.util.find_spec(name) is None]
    return unittest.skipIf(missing, "not installed: " + ", ".join(missing))


class InFolder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="adaptiso-python-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
