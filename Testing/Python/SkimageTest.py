"""scikit-image's own tests of marching_cubes, with adaptiso.marching_cubes in its place; and that the
two agree on signature, conventions and values. Exit code 77: scikit-image is not there."""

import importlib.util
import inspect
import sys
import unittest

if importlib.util.find_spec("skimage") is None or importlib.util.find_spec("pytest") is None:
    print("not installed: skimage, or pytest")
    sys.exit(77)

import adaptiso
import numpy as np
import pytest
from scipy.spatial import cKDTree
from skimage import measure
from skimage.draw import ellipsoid

#: Tests that can't hold here, and why.
EXCEPTIONS = {
    # asks that three algorithms differ where a cell is ambiguous; here there is one, whatever
    # `method` says
    "test_both_algs_same_result_donut",
}


class Swap:
    """A plugin that puts ours into scikit-image's test module."""

    def pytest_collection_modifyitems(self, items):
        for item in items:
            item.module.marching_cubes = adaptiso.marching_cubes
        self.names = [item.name for item in items]
        items[:] = [item for item in items if item.name not in EXCEPTIONS]

    def pytest_runtest_logreport(self, report):
        if report.failed:
            print(report.longreprtext)


class TheirTests(unittest.TestCase):
    def test_pass_but_for_the_exceptions(self):
        swap = Swap()
        file = importlib.util.find_spec("skimage.measure.tests.test_marching_cubes").origin
        code = pytest.main(["-q", "-p", "no:cacheprovider", "--rootdir", "/", file],
                           plugins=[swap])
        self.assertEqual(code, 0)
        self.assertGreaterEqual(len(swap.names), 9)  # of scikit-image 0.19
        self.assertLessEqual(EXCEPTIONS, set(swap.names))


class Agreement(unittest.TestCase):
    def setUp(self):
        # no sample at the levels, no ambiguous cell
        self.volume = (ellipsoid(6, 10, 7, levelset=True) + 0.0123).astype(np.float32)

    def both(self, **options):
        return (adaptiso.marching_cubes(self.volume, **options),
                measure.marching_cubes(self.volume, **options))

    def test_the_signature_is_the_same(self):
        theirs = inspect.signature(measure.marching_cubes).parameters
        ours = inspect.signature(adaptiso.marching_cubes).parameters
        self.assertEqual([(p.name, p.kind, p.default) for p in ours.values()],
                         [(p.name, p.kind, p.default) for p in theirs.values()])

    def test_vertices_normals_values_and_types_agree(self):
        for options in ({"level": 0.0}, {"level": 0.25, "spacing": (1, 2.5, 0.7)},
                        {"level": 0.0, "step_size": 2}, {"level": -0.125,
                                                         "gradient_direction": "ascent"},
                        {"level": 0.0, "mask": self.mask()}):
            with self.subTest(options.keys()):
                ours, theirs = self.both(**options)
                self.assertEqual([part.dtype for part in ours], [part.dtype for part in theirs])
                self.assertEqual([part.shape for part in ours], [part.shape for part in theirs])
                near = self.match(ours[0], theirs[0])
                np.testing.assert_allclose(ours[3], theirs[3][near], rtol=1e-5)
                cosines = (ours[2] * theirs[2][near]).sum(axis=1)
                # theirs are sums over cells, ours differences between samples
                self.assertGreater(cosines.min(), np.cos(np.radians(15)))

    def test_faces_turn_the_same_way(self):
        for direction in ("descent", "ascent"):
            ours, theirs = self.both(level=0.0, gradient_direction=direction)
            volumes = [np.linalg.det(parts[0][parts[1]].astype(float)).sum() / 6
                       for parts in (ours, theirs)]
            # the same corners; quadrangles are halved along either diagonal
            self.assertAlmostEqual(volumes[0] / volumes[1], 1, places=2)

    def test_without_a_level_it_is_the_middle_of_the_range(self):
        ours, theirs = self.both()
        self.match(ours[0], theirs[0])

    def test_errors_are_of_the_same_kind(self):
        blank = np.zeros((4, 4, 4), np.float32)
        for arguments, options in (((blank, 0.0), {}), ((self.volume, 1e9), {}),
                                   ((self.volume, 0.0), {"step_size": 0}),
                                   ((self.volume, 0.0), {"gradient_direction": "up"}),
                                   ((self.volume, 0.0), {"method": "mc33"}),
                                   ((self.volume, 0.0), {"spacing": (1, 2)}),
                                   ((self.volume[0], 0.0), {})):
            with self.assertRaises((ValueError, RuntimeError)) as theirs:
                measure.marching_cubes(*arguments, **options)
            with self.assertRaises(type(theirs.exception)):
                adaptiso.marching_cubes(*arguments, **options)

    def mask(self):
        mask = np.zeros(self.volume.shape, bool)
        mask[3:, :12] = True
        return mask

    def match(self, ours, theirs):
        """For each of our vertices the one of theirs at the same place."""
        distances, near = cKDTree(theirs).query(ours)
        # ours stay a thousandth of a step (2.5 at most) away from samples; float32 places up to 70
        self.assertLess(distances.max(), 2.5 * 0.001 + 2e-5)
        self.assertEqual(len(np.unique(near)), len(theirs))
        return near


if __name__ == "__main__":
    unittest.main(verbosity=2)
