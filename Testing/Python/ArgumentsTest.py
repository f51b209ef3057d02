"""Arguments made up by hypothesis: a result or an adaptiso.Error, never a crash. How many there are is
ADAPTISO_EXAMPLES (200). Exit code 77: hypothesis is not there."""

import importlib.util
import logging
import os
import sys
import tempfile
import unittest

# hypothesis keeps tables in the working folder, unless told
os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = os.path.join(tempfile.gettempdir(), "hypothesis")

if importlib.util.find_spec("hypothesis") is None:
    print("not installed: hypothesis")
    sys.exit(77)

import adaptiso
import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

logging.getLogger("adaptiso").setLevel(logging.ERROR)

SETTINGS = settings(max_examples=int(os.environ.get("ADAPTISO_EXAMPLES", "200")), deadline=None,
                    database=None, derandomize="ADAPTISO_EXAMPLES" not in os.environ,
                    suppress_health_check=list(HealthCheck))

anything = st.one_of(
    st.none(), st.booleans(), st.integers(), st.integers(-2**70, 2**70), st.floats(), st.text(),
    st.binary(), st.complex_numbers(), st.lists(st.integers(), max_size=4), st.just(object()),
    st.just(np.float32(0.5)), st.just(np.int64(3)), st.just(np.array(0.5)), st.just(np.nan))
dtypes = st.one_of(arrays.scalar_dtypes(), arrays.floating_dtypes(), arrays.integer_dtypes())
images = st.one_of(
    arrays.arrays(dtypes, arrays.array_shapes(min_dims=3, max_dims=3, max_side=6)),
    arrays.arrays(np.float32, arrays.array_shapes(min_dims=3, max_dims=3, min_side=2, max_side=9),
                  elements=st.floats(-4, 4, width=32)),
    arrays.arrays(dtypes, arrays.array_shapes(min_dims=0, max_dims=5, min_side=0, max_side=4)),
    anything)
views = st.sampled_from([lambda a: a, np.asfortranarray, lambda a: a[::-1], lambda a: a.T,
                         lambda a: a[..., ::2], lambda a: a.swapaxes(0, -1)])
affines = st.one_of(st.none(), anything,
                    arrays.arrays(np.float64, (4, 4)),
                    arrays.arrays(np.float64, (3, 4), elements=st.floats(-3, 3)).map(
                        lambda rows: np.vstack([rows, [0, 0, 0, 1]])))
levels = st.one_of(st.floats(-5, 5), st.just("auto"), anything)
options = st.fixed_dictionaries({}, optional={
    "max_error": st.one_of(st.floats(0.01, 3), anything),
    "triangles": st.one_of(st.integers(0, 500), anything),
    "reduction": st.one_of(st.floats(0, 1), anything),
    "min_angle": st.one_of(st.floats(0, 40), anything),
    "method": st.one_of(st.sampled_from(["adaptive", "boxes", "dmc", "asc", "mc"]), anything),
    "border": st.one_of(st.sampled_from(["closed", "open"]), anything),
    "largest": st.one_of(st.booleans(), anything),
    "min_volume": st.one_of(st.floats(0, 20), anything),
    "fill_cavities": st.one_of(st.booleans(), anything),
    "threads": st.one_of(st.integers(0, 3), anything.filter(
        lambda value: not (isinstance(value, (int, np.integer)) and 3 < value)))})
tables = st.one_of(
    arrays.arrays(np.float64, st.tuples(st.integers(0, 6), st.just(3))),
    arrays.arrays(np.float64, st.tuples(st.integers(0, 6), st.just(3)), elements=st.floats(-9, 9)),
    arrays.arrays(np.int64, st.tuples(st.integers(0, 9), st.just(3)), elements=st.integers(-1, 6)),
    arrays.arrays(dtypes, arrays.array_shapes(min_dims=0, max_dims=3, max_side=4)), anything)


def attempt(call, *arguments, **named):
    """What a call gives, or None where the arguments are refused with one line."""
    try:
        return call(*arguments, **named)
    except adaptiso.Error as error:
        assert "\n" not in str(error) and len(str(error)) > 3, str(error)
        return None


class Arguments(unittest.TestCase):
    @SETTINGS
    @given(images, views, levels, affines, options)
    def test_of_surface(self, image, view, level, affine, named):
        if isinstance(image, np.ndarray) and image.ndim > 0:
            image = view(image)
        before = image.copy() if isinstance(image, np.ndarray) else None
        mesh = attempt(adaptiso.surface, image, level, affine=affine, **named)
        if before is not None:
            np.testing.assert_array_equal(before, image)
            self.assertEqual(before.flags.writeable, True)
        if mesh is not None:
            self.assertGreater(len(mesh.faces), 0)
            self.assertTrue(np.isfinite(mesh.vertices).all())
            self.assertLess(mesh.faces.max(), len(mesh.vertices))
            self.assertEqual(mesh.is_closed or named.get("border") == "open", True)

    @SETTINGS
    @given(tables, tables, st.one_of(st.none(), tables))
    def test_of_mesh_and_check(self, vertices, faces, normals):
        mesh = attempt(adaptiso.Mesh, vertices, faces, normals)
        if mesh is not None:
            repr(mesh), mesh.is_closed, mesh.area, mesh.volume
            attempt(adaptiso.compare, mesh, mesh, samples=10)
        found = attempt(adaptiso.check, (vertices, faces))
        if found is not None:
            repr(found), found.failed, found.findings

    @SETTINGS
    @given(images, st.one_of(st.none(), levels), st.fixed_dictionaries({}, optional={
        "spacing": st.one_of(st.tuples(*[st.floats(0.1, 3)] * 3), anything),
        "gradient_direction": st.one_of(st.sampled_from(["descent", "ascent"]), anything),
        "step_size": st.one_of(st.integers(1, 3), anything),
        "mask": st.one_of(st.none(), arrays.arrays(bool, (4, 4, 4)), anything)}))
    def test_of_marching_cubes(self, volume, level, options):
        attempt(adaptiso.marching_cubes, volume, level, **options)


if __name__ == "__main__":
    unittest.main(verbosity=2)
