"""What the tests of adaptiso-bem share: a case that runs it, and a head of three spheres."""

import json
import subprocess

from support import BIN, OK, SOURCE, ApplicationTest, Image, write_nifti

BEM = str(BIN / "adaptiso-bem")
CHECK = str(BIN / "adaptiso-check")
README = SOURCE / "Applications" / "adaptiso-bem" / "README.md"
NAMES = ("inner_skull", "outer_skull", "outer_skin")
RADII = (60, 66, 72)
STEP = 4
# voxels of 4 mm, so that Python makes them quickly; the working grid is 3 mm
QUICK = ("--voxel", "3", "--vertices", "162", "--closing", "4")


def head(centre=(0, 0, 0), radii=RADII, n=44, origin=None, values=(1, 2, 3)):
    """uint8 labels of three spheres; `centre` in RAS mm."""
    origin = origin or (-STEP * (n - 1) / 2,) * 3
    samples = bytearray()
    squares = [r * r for r in radii]
    for k in range(n):
        for j in range(n):
            for i in range(n):
                d = sum((o + STEP * v - c) ** 2 for o, v, c in zip(origin, (i, j, k), centre))
                samples.append(next((v for s, v in zip(squares, values) if d <= s), 0))
    return Image((n, n, n), "B", bytes(samples), (STEP,) * 3, origin)


LABELS = head()


def read_tri(path):
    """Points and triangles of an OpenMEEG .tri."""
    words = path.read_text().split()
    count = int(words[1])
    values = list(map(float, words[2:2 + 6 * count]))
    points = [tuple(values[6 * n:6 * n + 3]) for n in range(count)]
    at = 2 + 6 * count
    corners = list(map(int, words[at + 4:]))
    return points, [tuple(corners[n:n + 3]) for n in range(0, len(corners), 3)]


def volume(points, triangles):
    return sum(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0])
               for a, b, c in ((points[i], points[j], points[k]) for i, j, k in triangles)) / 6


class BemTest(ApplicationTest):
    program = BEM

    def run_bem(self, *arguments, **options):
        return subprocess.run([BEM, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300,
                              **options)

    def bem(self, *arguments, **options):
        done = self.run_bem(*arguments, **options)
        self.assertEqual(done.returncode, OK, done.stderr)
        return done

    def fails(self, code, pattern, *arguments):
        before = self.contents()
        done = self.run_bem(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, pattern)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.contents(), before)
        self.assertFalse([p for p in self.names() if p.startswith(".adaptiso")])

    def report(self, folder="model"):
        return json.loads((self.folder / folder / "report.json").read_text())

    def labels(self, name="seg.nii", image=LABELS):
        write_nifti(self.path(name), image)
        return ("--labels", name, "--tissue", "brain=1", "--tissue", "skull=2", "--tissue",
                "scalp=3", *QUICK)
