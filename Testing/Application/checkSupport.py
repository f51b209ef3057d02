"""What the tests of adaptiso-check share: a case that runs it, and files of meshes."""

import json
import struct
import subprocess

from support import BIN, CHECK_FAILED, OK, SOURCE, ApplicationTest
from headDefects import write_off

CHECK = str(BIN / "adaptiso-check")
README = SOURCE / "Applications" / "adaptiso-check" / "README.md"
NAMES = ["inner.off", "middle.off", "outer.off"]


def together(*meshes):
    points, triangles = [], []
    for more, others in meshes:
        triangles += [tuple(v + len(points) for v in t) for t in others]
        points += more
    return points, triangles


def write_ply(path, mesh):
    points, triangles = mesh
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
              "property double x\nproperty double y\nproperty double z\n"
              f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + b"".join(struct.pack("<3d", *p) for p in points) +
                     b"".join(struct.pack("<B3i", 3, *t) for t in triangles))


def write_stl(path, mesh):
    points, triangles = mesh
    path.write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for v in t for x in points[v]), 0) for t in triangles))


def write_surf(path, mesh):
    points, triangles = mesh
    path.write_bytes(b"\xff\xff\xfetest\n\n" + struct.pack(">2i", len(points), len(triangles)) +
                     b"".join(struct.pack(">3f", *p) for p in points) +
                     b"".join(struct.pack(">3i", *t) for t in triangles))


class CheckTest(ApplicationTest):
    def write(self, name, mesh, frame="RAS mm"):
        write_off(self.path(name), mesh, frame)

    def write_model(self, model):
        for name, mesh in zip(NAMES, model):
            self.write(name, mesh)

    def run_check(self, *arguments):
        return subprocess.run([CHECK, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)

    def check(self, *arguments, code=None):
        """The report; the exit code is what the report says, or `code`."""
        done = self.run_check(*arguments, "--json", "-")
        report = json.loads(done.stdout)
        expected = (OK if report["passed"] else CHECK_FAILED) if code is None else code
        self.assertEqual(done.returncode, expected, done.stderr)
        return report

    def surface(self, mesh, *arguments):
        """What is said of one surface."""
        self.write("surface.off", mesh)
        return self.check("surface.off", *arguments)["surfaces"][0]

    def refused(self, code, pattern, *arguments):
        before = self.contents()
        done = self.run_check(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, pattern)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("adaptiso-check: "), lines[0])
        self.assertEqual(self.contents(), before)


def finding(subject, name):
    return next(check["finding"] for check in subject["checks"] if check["name"] == name)


def outcome(subject, name):
    return next(check["outcome"] for check in subject["checks"] if check["name"] == name)
