"""What the tests of adaptiso-simplify share: a case that runs it, meshes, and FreeSurfer's files."""

import json
import math
import re
import struct
import subprocess

from support import BIN, OK, SOURCE, ApplicationTest, lines
from compareSupport import RAS
from headDefects import write_off

SIMPLIFY = str(BIN / "adaptiso-simplify")
README = SOURCE / "Applications" / "adaptiso-simplify" / "README.md"


def patch(steps=24, size=12.0):
    """A bumpy square with an open border, 2 steps^2 triangles."""
    points = [(size * i / steps, size * j / steps,
               0.8 * math.sin(5 * i / steps) * math.cos(4 * j / steps))
              for j in range(steps + 1) for i in range(steps + 1)]
    triangles = []
    for j in range(steps):
        for i in range(steps):
            a = j * (steps + 1) + i
            b, c, d = a + 1, a + steps + 2, a + steps + 1
            triangles += [(a, b, c), (a, c, d)]
    return points, triangles


def border_points(steps=24):
    n = steps + 1
    return [j * n + i for j in range(n) for i in range(n) if i in (0, steps) or j in (0, steps)]


def ply(mesh, properties="", values=None, comment=""):
    """PLY text; `values` of each point follow its coordinates, as `properties` name them."""
    points, triangles = mesh
    lines = ["ply", "format ascii 1.0", *([f"comment {comment}"] if comment else []),
             f"element vertex {len(points)}", "property double x", "property double y",
             "property double z", *properties.splitlines(), f"element face {len(triangles)}",
             "property list uchar int vertex_indices", "end_header"]
    for n, point in enumerate(points):
        lines.append(" ".join(map(repr, [*point, *(values[n] if values else ())])))
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    return "\n".join(lines) + "\n"


def write_curv(path, values, triangles=0):
    path.write_bytes(b"\xff\xff\xff" + struct.pack(">3i", len(values), triangles, 1) +
                     struct.pack(f">{len(values)}f", *values))


def read_curv(path):
    content = path.read_bytes()
    assert content[:3] == b"\xff\xff\xff"
    points, triangles, each = struct.unpack(">3i", content[3:15])
    assert each == 1 and len(content) == 15 + 4 * points
    return list(struct.unpack(f">{points}f", content[15:])), triangles


def annot_table(names):
    """A table of version 2; the label of the n-th name is n + 1 (its red)."""
    def text(word):
        return struct.pack(">i", len(word) + 1) + word.encode() + b"\0"
    entries = b"".join(struct.pack(">i", n) + text(name) + struct.pack(">4i", n + 1, 0, 0, 0)
                       for n, name in enumerate(names))
    return (struct.pack(">3i", 1, -2, len(names)) + text("table") +
            struct.pack(">i", len(names)) + entries)


def write_annot(path, labels, table):
    path.write_bytes(struct.pack(">i", len(labels)) +
                     b"".join(struct.pack(">2i", n, label) for n, label in enumerate(labels)) +
                     table)


def read_annot(path):
    content = path.read_bytes()
    count = struct.unpack(">i", content[:4])[0]
    pairs = struct.unpack(f">{2 * count}i", content[4:4 + 8 * count])
    assert list(pairs[::2]) == list(range(count))
    return list(pairs[1::2]), content[4 + 8 * count:]


def write_pial(path, mesh, cras=(3.0, -4.0, 5.0)):
    """A FreeSurfer surface in tkRAS of a conformed volume, whose file has a telling name."""
    points, triangles = mesh
    footer = ("valid = 1  # volume info valid\nfilename = /data/doe_jane/mri/T1.mgz\n"
              "volume = 256 256 256\nvoxelsize = 1.0 1.0 1.0\nxras   = -1 0 0\n"
              "yras   = 0 0 -1\nzras   = 0 1 0\ncras   = {} {} {}\n".format(*cras))
    path.write_bytes(
        b"\xff\xff\xfecreated by jane\n\n" + struct.pack(">2i", len(points), len(triangles)) +
        b"".join(struct.pack(">3f", *p) for p in points) +
        b"".join(struct.pack(">3i", *t) for t in triangles) +
        struct.pack(">3i", 2, 0, 20) + footer.encode())


def read_pial(path):
    """Points, triangles, footer."""
    content = path.read_bytes()
    assert content[:3] == b"\xff\xff\xfe"
    at = content.index(b"\n\n") + 2
    count, faces = struct.unpack(">2i", content[at:at + 8])
    at += 8
    points = [struct.unpack(">3f", content[at + 12 * n:at + 12 * n + 12]) for n in range(count)]
    at += 12 * count
    triangles = [struct.unpack(">3i", content[at + 12 * n:at + 12 * n + 12]) for n in range(faces)]
    return points, triangles, content[at + 12 * faces:]


def documented_keys(readme=README):
    """The keys in the first column of a README.md's table; a key that begins with a dot belongs to
    each of the parents of the row that ends in a colon before it."""
    section = readme.read_text().split("## The report")[1]
    keys, parents = set(), []
    for cell, what in re.findall(r"^\| (`.*?`) \| (.*) \|$", section, re.MULTILINE):
        names = re.findall(r"`([^`]+)`", cell)
        if what.endswith(":"):
            parents = names
            continue
        for name in names:
            keys |= {parent + name for parent in parents} if name.startswith(".") else {name}
    return keys


def keys_of(value, path=""):
    """The paths of all leaves; lists are leaves."""
    if not isinstance(value, dict):
        return {path}
    return {leaf for key, inner in value.items()
            for leaf in keys_of(inner, f"{path}.{key}" if path else key)}


class SimplifyTest(ApplicationTest):
    def write(self, name, mesh, frame=RAS):
        write_off(self.path(name), mesh, frame)

    def run_simplify(self, *arguments, **options):
        return subprocess.run([SIMPLIFY, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300,
                              **options)

    def simplify(self, *arguments):
        """The report of a run that must succeed, without a word on stderr but warnings."""
        done = self.run_simplify(*arguments, "--json", "-")
        self.assertEqual(done.returncode, OK, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual(done.stderr, "".join(f"adaptiso-simplify: warning: {warning}\n"
                                              for warning in lines(report["warnings"])))
        return report

    def refused(self, code, pattern, *arguments):
        """It must fail with this code and one line, and write nothing."""
        before = self.contents()
        done = self.run_simplify(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, pattern)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("adaptiso-simplify: "), lines[0])
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.contents(), before)

    def check(self, *arguments):
        """The report of adaptiso-check, whether it passed or not."""
        done = subprocess.run([str(BIN / "adaptiso-check"), *map(str, arguments), "--json", "-"],
                              cwd=self.folder, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=300)
        return json.loads(done.stdout)

    def compare(self, a, b):
        done = subprocess.run([str(BIN / "adaptiso-compare"), a, b, "--json", "-"],
                              cwd=self.folder, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=300)
        self.assertEqual(done.returncode, OK, done.stderr)
        return json.loads(done.stdout)["distances"]["combined"]
