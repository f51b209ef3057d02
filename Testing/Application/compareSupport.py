"""What the tests of adaptiso-compare share: a case that runs it, and meshes."""

import json
import math
import subprocess

from support import BIN, OK, SOURCE, ApplicationTest, lines
from headDefects import write_off

COMPARE = str(BIN / "adaptiso-compare")
README = SOURCE / "Applications" / "adaptiso-compare" / "README.md"
RAS, LPS, TKRAS, VOXEL = "RAS mm", "LPS mm", "tkRAS mm", "voxel indices"


def sphere(radius, steps=48, centre=(0, 0, 0)):
    """Closed, outward: `steps` meridians, half as many parallels, vertices on the sphere."""
    rings = steps // 2
    points = [(0, 0, 1)]
    for ring in range(1, rings):
        polar = math.pi * ring / rings
        for step in range(steps):
            azimuth = 2 * math.pi * step / steps
            points.append((math.sin(polar) * math.cos(azimuth),
                           math.sin(polar) * math.sin(azimuth), math.cos(polar)))
    points.append((0, 0, -1))
    last = len(points) - 1
    triangles = []
    for step in range(steps):
        after = (step + 1) % steps
        triangles.append((0, 1 + step, 1 + after))
        triangles.append((last, last - steps + after, last - steps + step))
        for ring in range(rings - 2):
            upper, lower = 1 + ring * steps, 1 + (ring + 1) * steps
            triangles.append((upper + step, lower + step, lower + after))
            triangles.append((upper + step, lower + after, upper + after))
    return [tuple(radius * x + c for x, c in zip(p, centre)) for p in points], triangles


def plane(height, size=10):
    """The square [0, size]^2 at z = height, facing up."""
    return ([(0, 0, height), (size, 0, height), (size, size, height), (0, size, height)],
            [(0, 1, 2), (0, 2, 3)])


def to_lps(mesh):
    points, triangles = mesh
    return [(-x, -y, z) for x, y, z in points], triangles


class CompareTest(ApplicationTest):
    def write(self, name, mesh, frame=RAS):
        write_off(self.path(name), mesh, frame)

    def run_compare(self, *arguments):
        return subprocess.run([COMPARE, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)

    def compare(self, *arguments):
        """The report of a run that must succeed, without a word on stderr but warnings."""
        done = self.run_compare(*arguments, "--json", "-")
        self.assertEqual(done.returncode, OK, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual(done.stderr, "".join(f"adaptiso-compare: warning: {warning}\n"
                                              for warning in lines(report["warnings"])))
        return report

    def refused(self, code, pattern, *arguments):
        before = self.contents()
        done = self.run_compare(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, pattern)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("adaptiso-compare: "), lines[0])
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.contents(), before)
