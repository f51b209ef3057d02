"""What the application tests share: images made on the spot, and a case that runs the programs in
a folder of its own."""

import json
import math
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BIN = Path(os.environ["ADAPTISO_BIN"])
SOURCE = Path(os.environ["ADAPTISO_SOURCE"])
MESH = str(BIN / "adaptiso-mesh")
sys.path.insert(0, str(SOURCE / "Testing" / "Support"))  # headDefects

OK, CHECK_FAILED, USAGE, BAD_INPUT, INTERNAL = range(5)


class Image:
    """Samples (x fastest) of an image of `size` voxels; `kind` as struct has it: B, h, f."""

    def __init__(self, size, kind, samples, spacing=(1, 1, 1), origin=(0, 0, 0)):
        self.size, self.kind, self.samples = size, kind, samples
        self.spacing, self.origin = spacing, origin

    def packed(self):
        if isinstance(self.samples, bytes):
            return self.samples
        return struct.pack(f"<{len(self.samples)}{self.kind}", *self.samples)


def from_function(n, kind, value, spacing=(1, 1, 1), origin=(0, 0, 0)):
    """An image of n^3 voxels; value(x, y, z) of the offset from its middle, in voxels."""
    middle = (n - 1) / 2
    return Image((n, n, n), kind,
                 [value(i - middle, j - middle, k - middle)
                  for k in range(n) for j in range(n) for i in range(n)], spacing, origin)


def ball(n=24, radius=8, spacing=(1, 1, 1), origin=(0, 0, 0)):
    """int16: 100 on the sphere of `radius` voxels, 10 more for each voxel inwards."""
    return from_function(
        n, "h", lambda x, y, z: round(100 + 10 * (radius - math.sqrt(x * x + y * y + z * z))),
        spacing, origin)


def onion():
    """float: a ball of radius 4 in a hollow of radius 8 in a ball of radius 13, at isovalue 0."""
    def value(x, y, z):
        r = math.sqrt(x * x + y * y + z * z)
        return max(4 - r, min(r - 8, 13 - r))
    return from_function(32, "f", value)


def without_progress(stderr):
    """Printed text without the progress lines that come each minute."""
    return re.sub(r"(?m)^.*, \d+ s\n", "", stderr)


def noise(n=72):
    """uint8 noise: millions of triangles, so that writing them takes a while."""
    return Image((n, n, n), "B", random.Random(2).randbytes(n ** 3))


def write_nifti(path, image):
    """A NIfTI-1 file with an sform; origin and axes are RAS there."""
    code, bits = {"B": (2, 8), "h": (4, 16), "f": (16, 32)}[image.kind]
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *image.size, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, code, bits)
    struct.pack_into("<8f", header, 76, 1, *image.spacing, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352)
    header[123] = 2  # mm
    struct.pack_into("<2h", header, 252, 0, 1)
    for axis in range(3):
        row = [0.0] * 4
        row[axis], row[3] = image.spacing[axis], image.origin[axis]
        struct.pack_into("<4f", header, 280 + 16 * axis, *row)
    header[344:348] = b"n+1\0"
    Path(path).write_bytes(bytes(header) + image.packed())


def write_4d_nifti(path, images):
    """A NIfTI-1 file of several images of one geometry."""
    write_nifti(path, images[0])
    content = bytearray(Path(path).read_bytes())
    struct.pack_into("<h", content, 40, 4)
    struct.pack_into("<h", content, 48, len(images))
    Path(path).write_bytes(bytes(content) + b"".join(image.packed() for image in images[1:]))


def write_metaimage(path, image):
    kind = {"B": "MET_UCHAR", "h": "MET_SHORT", "f": "MET_FLOAT"}[image.kind]
    def text(values): return " ".join(str(v) for v in values)
    header = (f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
              f"CompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n"
              f"Offset = {text(image.origin)}\nCenterOfRotation = 0 0 0\n"
              f"ElementSpacing = {text(image.spacing)}\nDimSize = {text(image.size)}\n"
              f"ElementType = {kind}\nElementDataFile = LOCAL\n")
    Path(path).write_bytes(header.encode() + image.packed())


def write_nrrd(path, image):
    kind = {"B": "uint8", "h": "int16", "f": "float"}[image.kind]
    sx, sy, sz = image.spacing
    header = (f"NRRD0004\ntype: {kind}\ndimension: 3\nspace: left-posterior-superior\n"
              f"sizes: {image.size[0]} {image.size[1]} {image.size[2]}\n"
              f"space directions: ({sx},0,0) (0,{sy},0) (0,0,{sz})\nkinds: domain domain domain\n"
              f"endian: little\nencoding: raw\n"
              f"space origin: ({image.origin[0]},{image.origin[1]},{image.origin[2]})\n\n")
    Path(path).write_bytes(header.encode() + image.packed())


def lines(warnings):
    """The warnings of a report, each as stderr has it."""
    return [f"{w['file']}: {w['text']}" if w["file"] else w["text"] for w in warnings]


class ApplicationTest(unittest.TestCase):
    """Each test runs in a new folder, `self.folder`, that goes when it ends."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="adaptiso-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return self.folder / name

    def run_mesh(self, *arguments, **options):
        """Runs adaptiso-mesh in the test's folder; stdout and stderr are kept apart."""
        return subprocess.run([MESH, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300,
                              **options)

    def mesh(self, *arguments, **options):
        """The same, and it must succeed."""
        done = self.run_mesh(*arguments, **options)
        self.assertEqual(done.returncode, OK, done.stderr)
        return done

    def report(self, *arguments):
        """The JSON report of a run that must succeed."""
        return json.loads(self.mesh(*arguments, "--json", "-").stdout)

    def assert_fails(self, code, pattern, *arguments, **options):
        """Fails with `code`, with one line on stderr that matches `pattern`,
        with nothing on stdout, and leaves the folder as it was, to the byte."""
        before = self.contents()
        done = self.run_mesh(*arguments, **options)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, pattern)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("adaptiso-mesh: "), lines[0])
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.contents(), before)
        return done

    def take_failure_report(self, name):
        """Removes the report that a failed run leaves where --json names a file."""
        if self.path(name).exists():
            self.assertFalse(json.loads(self.path(name).read_text())["passed"])
            self.path(name).unlink()

    def contents(self):
        return {str(p.relative_to(self.folder)): p.read_bytes()
                for p in self.folder.rglob("*") if p.is_file()}

    def names(self):
        return sorted(p.name for p in self.folder.iterdir())


def main():
    unittest.main(verbosity=2)
