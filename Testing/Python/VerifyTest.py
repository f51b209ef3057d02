"""Examples/verify/verify.py accepts what adaptiso-mesh makes, and finds planted faults of each kind."""

import importlib.util
import os
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

from support import BRAIN, InFolder, ball, needs, program

SCRIPT = Path(os.environ["ADAPTISO_SOURCE"]) / "Examples" / "verify" / "verify.py"


def write_ply(path, points, triangles):
    faces = np.zeros(len(triangles), [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, triangles
    header = ("ply\nformat binary_little_endian 1.0\n"
              f"element vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z\n"
              f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + points.astype("<f8").tobytes() + faces.tobytes())


@needs("nibabel", "scipy")
class Verify(InFolder):
    def make(self, samples, affine, isovalue, *options, bound):
        import nibabel
        self.image, self.isovalue, self.bound = self.folder / "image.nii", isovalue, bound
        nibabel.save(nibabel.Nifti1Image(samples, affine), self.image)
        for name, words in (("mc", ("--method", "mc")), ("adaptive", ("--max-error", bound, *options))):
            program("adaptiso-mesh", self.image, "--iso", isovalue, *words, "-o", self.folder / f"{name}.ply", "--quiet")

    def verify(self, mc="mc.ply", adaptive="adaptive.ply", bound=None):
        return subprocess.run([sys.executable, "-B", SCRIPT, self.image, str(self.isovalue), mc, adaptive,
                               str(bound or self.bound)], cwd=self.folder, text=True, capture_output=True)

    def accept(self):
        done = self.verify()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("each lies within", done.stdout)

    def refuse(self, claim, **arguments):
        done = self.verify(**arguments)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertRegex(done.stderr, "NOT shown: " + claim)

    def noisy_ball(self):
        noise = np.random.default_rng(1).normal(0, 0.4, (26, 24, 22))
        affine = [[0, -2, 0, 20], [1.5, 0, 0, -9], [0, 0, 2.5, -30], [0, 0, 0, 1]]
        self.make((ball(noise.shape) + noise).astype(np.float32), affine, -8, bound=0.5)

    def test_a_noisy_ball_of_a_turned_image(self):
        self.noisy_ball()
        self.accept()

    def test_a_surface_that_meets_the_images_border(self):
        x, y, z = np.indices((20, 18, 16)) * 0.5
        values = 100 * (np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x))
        self.make(values.astype(np.int16), np.eye(4), 7, bound=0.2)
        self.accept()

    @unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
    def test_a_brain(self):
        import nibabel
        image = nibabel.load(BRAIN).slicer[::4, ::4, ::4]
        self.make(np.asarray(image.dataobj), image.affine, 100, bound=0.6)
        self.accept()

    def test_planted_faults_are_found(self):
        self.noisy_ball()
        spec = importlib.util.spec_from_file_location("verify", SCRIPT)
        script = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(script)
        points, triangles = script.read_ply(self.folder / "mc.ply")
        own, own_triangles = script.read_ply(self.folder / "adaptive.ply")
        affine = script.nibabel.load(self.image).affine
        index = script.nibabel.affines.apply_affine(np.linalg.inv(affine), points)
        along = np.argmax(np.abs(index[0] - np.rint(index[0])))

        def mc(claim, points=points, triangles=triangles):
            write_ply(self.folder / "planted.ply", points, triangles)
            self.refuse(claim, mc="planted.ply")

        def adaptive(claim, points=own, triangles=own_triangles, **arguments):
            write_ply(self.folder / "planted.ply", points, triangles)
            self.refuse(claim, adaptive="planted.ply", **arguments)

        def moved(all_points, vertex, offset):
            copy = all_points.copy()
            copy[vertex] += offset
            return copy

        step = affine[:3, along] * 0.01
        with self.subTest("a vertex of marching cubes elsewhere on its edge"):
            mc("mc: vertices lie where linear interpolation", moved(points, 0, step))
        with self.subTest("a vertex of marching cubes beside its edge"):
            mc("mc: every vertex lies on one lattice edge", moved(points, 0, affine[:3, (along + 1) % 3] * 0.01))
        with self.subTest("a triangle of marching cubes missing"):
            mc("mc: every edge has two sides", triangles=triangles[1:])
        with self.subTest("a triangle of marching cubes over more than a cell"):
            far = np.argmax(np.linalg.norm(points - points[triangles[0, 0]], axis=1))
            mc("mc: every triangle lies within one cell", triangles=np.vstack([triangles, [*triangles[0, :2], far]]))
        with self.subTest("a surface of another isovalue"):
            self.isovalue = -7.9
            self.refuse("mc: ")
            self.isovalue = -8
        with self.subTest("a piece of marching cubes missing"):
            least = np.arange(len(points))
            for _ in range(len(points)):
                small = least[triangles].min(1)
                lower = least.copy()
                np.minimum.at(lower, triangles.ravel(), np.repeat(small, 3))
                if (lower == least).all():
                    break
                least = lower
            pieces, counts = np.unique(least, return_counts=True)
            self.assertGreater(len(pieces), 1)
            kept = least != pieces[np.argmin(counts)]
            number = np.cumsum(kept) - 1
            mc("mc: every crossed lattice edge has one vertex", points[kept],
               number[triangles[kept[triangles[:, 0]]]])
        with self.subTest("a triangle missing"):
            adaptive("adaptive: every edge has two sides", triangles=own_triangles[1:])
        with self.subTest("a triangle turned"):
            adaptive("adaptive: no edge is run through twice", triangles=np.vstack([own_triangles[:1, ::-1], own_triangles[1:]]))
        with self.subTest("two fans at one vertex"):
            a, b = own_triangles[0, 0], own_triangles[len(own_triangles) // 2, 0]
            joined = np.where(own_triangles == b, a, own_triangles)
            joined[joined > b] -= 1
            adaptive("adaptive: every vertex is used, by one fan", np.delete(own, b, 0), joined)
        with self.subTest("a vertex moved beyond the far side of a triangle"):
            a, b, c = own[own_triangles[0]]
            adaptive("adaptive: no two triangles cross", moved(own, own_triangles[0, 0], 1.05 * ((b + c) / 2 - a)))
        with self.subTest("a triangle without area"):
            a, b, c = own[own_triangles[0]]
            adaptive("adaptive: every triangle has an area", moved(own, own_triangles[0, 0], (b + c) / 2 - a))
        with self.subTest("a bound that is too small"):
            self.refuse("(adaptive|mc): every point lies within the bound", bound=0.2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
