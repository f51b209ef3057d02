"""Surfaces of arrays: truth on paper, every order and type of samples, every affine, bad input."""

import copy
import logging
import pathlib
import pickle
import subprocess
import sys
import threading
import time
import unittest

import adaptiso
import numpy as np
from support import InFolder, ball, needs, place

MIRRORED = np.diag([-1.0, 1, 1, 1])
SHEARED = np.array([[1.1, 0.2, 0, -7], [0, 0.9, 0.3, 40], [0.1, 0, 1.2, -3.5], [0, 0, 0, 1]])


class Truth(unittest.TestCase):
    def test_a_sphere_lies_within_the_proved_bound(self):
        mesh = adaptiso.surface(ball((40, 40, 40)), -15, max_error=0.2)
        radius = np.linalg.norm(mesh.vertices - 19.5, axis=1)
        self.assertLessEqual(mesh.error_bound, 0.2)
        # vertices of marching cubes lie within h^2 / 8r of a sphere of radius r: 0.0083 at h = 1
        self.assertLess(np.abs(radius - 15).max(), 0.2 + 0.0084)
        # flat triangles within the bound of a sphere of radius 15 lose at most 3 * 0.2084 / 15
        truth = 4 / 3 * np.pi * 15**3
        self.assertLess(abs(mesh.volume / truth - 1), 3 * 0.2084 / 15)
        self.assertTrue(mesh.is_closed)
        self.assertTrue(adaptiso.check(mesh))

    def test_normals_are_unit_vectors_that_point_outside(self):
        mesh = adaptiso.surface(ball(), -8)
        outward = mesh.vertices - 11.5
        outward /= np.linalg.norm(outward, axis=1)[:, None]
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)  # float32
        # central differences of a distance turn less than 5 degrees from its gradient at r = 8
        self.assertGreater((mesh.normals * outward).sum(axis=1).min(), np.cos(np.radians(5)))

    def test_arrays_have_the_documented_types_and_cannot_be_written(self):
        mesh = adaptiso.surface(ball(), -8)
        for array, dtype in ((mesh.vertices, np.float64), (mesh.faces, np.int64),
                             (mesh.normals, np.float64)):
            self.assertEqual(array.dtype, dtype)
            self.assertEqual(array.shape[1], 3)
            self.assertFalse(array.flags.writeable)
        self.assertTrue(np.shares_memory(mesh.vertices, mesh.vertices))
        self.assertTrue(np.shares_memory(mesh.faces, mesh.faces))

    def test_views_outlive_the_mesh(self):
        mesh = adaptiso.surface(ball(), -8)
        vertices, copy = mesh.vertices, mesh.vertices.copy()
        del mesh
        adaptiso.surface(ball(), -9)  # may take the memory, had it been freed
        np.testing.assert_array_equal(vertices, copy)

    def test_every_method_makes_a_closed_surface(self):
        for method in ("adaptive", "boxes", "dmc", "asc", "mc"):
            mesh = adaptiso.surface(ball(), -8, method=method)
            self.assertTrue(mesh.is_closed, method)
            self.assertGreater(mesh.volume, 0, method)

    def test_counts_reductions_and_angles_are_met(self):
        volume = ball((40, 40, 40))
        full = len(adaptiso.surface(volume, -15, method="mc").faces)
        self.assertLessEqual(len(adaptiso.surface(volume, -15, triangles=500).faces), 500)
        self.assertLessEqual(len(adaptiso.surface(volume, -15, reduction=0.9).faces), 0.1 * full)
        angles = adaptiso.check(adaptiso.surface(volume, -15, min_angle=20))
        self.assertGreaterEqual(angles.report["shape"]["minAngleDeg"]["minimum"], 20)

    def test_pieces_and_cavities_are_chosen(self):
        volume = np.maximum(ball((48, 24, 24), (12, 11.5, 11.5)) + 8,
                            ball((48, 24, 24), (36, 11.5, 11.5)) + 5)
        self.assertEqual(pieces(adaptiso.surface(volume, 0)), 2)
        largest = adaptiso.surface(volume, 0, largest=True)
        self.assertEqual(pieces(largest), 1)
        self.assertLess(largest.vertices[:, 0].max(), 24)
        self.assertEqual(pieces(adaptiso.surface(volume, 0, min_volume=1000)), 1)
        hollow = 3 - np.abs(ball() + 7)
        self.assertEqual(pieces(adaptiso.surface(hollow, 0)), 2)
        self.assertEqual(pieces(adaptiso.surface(hollow, 0, fill_cavities=True)), 1)

    def test_the_border_is_closed_or_open(self):
        volume = ball(center=(0, 11.5, 11.5))
        self.assertTrue(adaptiso.surface(volume, -8).is_closed)
        opened = adaptiso.surface(volume, -8, border="open")
        self.assertFalse(opened.is_closed)
        self.assertEqual(opened.report["options"]["border"], "open")

    def test_otsu_chooses_a_level(self):
        volume = np.zeros((9, 9, 9), np.uint8)
        volume[3:6, 3:6, 3:6] = 100
        mesh = adaptiso.surface(volume, "auto")
        self.assertEqual(mesh.report["surfaces"][0]["isovalue"], 50)
        self.assertEqual(mesh.report["surfaces"][0]["isovalueChosenBy"], "otsu")


def pieces(mesh):
    return mesh.report["surfaces"][0]["componentCount"]


class Samples(unittest.TestCase):
    """Whatever way the samples lie, the surface is that of the same numbers."""

    def setUp(self):
        self.volume = np.round(ball((20, 24, 28)) * 8)  # whole numbers that 8 bits hold: -> 0..127
        self.volume = np.clip(self.volume + 127, 0, 127)
        self.level = 127 - 8 * 7.5
        self.mesh = adaptiso.surface(np.asfortranarray(self.volume), self.level)

    def test_every_type_gives_the_same_mesh(self):
        for dtype in ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8", "f2"):
            volume = np.asfortranarray(self.volume.astype(dtype))
            self.assertEqual(adaptiso.surface(volume, self.level), self.mesh, dtype)

    def test_longlong_is_a_64_bit_integer(self):
        volume = np.asfortranarray(self.volume.astype(np.longlong))
        self.assertEqual(adaptiso.surface(volume, self.level), self.mesh)

    def test_foreign_byte_order_gives_the_same_mesh(self):
        for dtype in (">i2", ">f4", ">f8"):
            volume = np.asfortranarray(self.volume.astype(dtype))
            self.assertEqual(adaptiso.surface(volume, self.level), self.mesh, dtype)

    def test_booleans_are_zero_and_one(self):
        inside = np.asfortranarray(self.volume >= self.level)
        self.assertEqual(adaptiso.surface(inside, 0.5),
                         adaptiso.surface(inside.astype(np.uint8), 0.5))

    def test_gaps_and_backward_axes_give_the_mesh_of_a_copy(self):
        for view in (self.volume[::2, :, 1:], self.volume[::-1], self.volume[:, ::-1, ::-1]):
            self.assertEqual(adaptiso.surface(view, self.level),
                             adaptiso.surface(np.asfortranarray(view), self.level))

    def test_any_order_of_axes_gives_a_surface_within_the_bound(self):
        truth = adaptiso.surface(np.asfortranarray(self.volume), self.level, method="mc")
        for order in ((0, 1, 2), (2, 1, 0), (1, 0, 2), (2, 0, 1), (0, 2, 1), (1, 2, 0)):
            lying = np.ascontiguousarray(self.volume.transpose(order))
            view = lying.transpose(np.argsort(order))
            np.testing.assert_array_equal(view, self.volume)
            mesh = adaptiso.surface(view, self.level)
            self.assertGreater(mesh.volume, 0, order)
            # measured distances are below the truth; 1e-9 for rounding in other orders of sums
            self.assertLessEqual(adaptiso.compare(mesh, truth).max, mesh.error_bound + 1e-9, order)
            self.assertEqual(mesh.report["input"]["sizeVoxels"], [20, 24, 28], order)

    def test_samples_are_not_copied(self):
        for volume in (self.volume, np.asfortranarray(self.volume)):
            samples = adaptiso._images.samples_of(volume, None)
            self.assertIs(samples.user, volume)
            address = volume.__array_interface__["data"][0]
            self.assertEqual(samples.volume.address, address)

    def test_a_read_only_array_serves_and_stays_so(self):
        volume = np.asfortranarray(self.volume)
        volume.flags.writeable = False
        self.assertEqual(adaptiso.surface(volume, self.level), self.mesh)
        self.assertFalse(volume.flags.writeable)

    def test_an_array_is_read_only_during_a_call_and_writable_after_it(self):
        volume = np.asfortranarray(self.volume)
        seen = []
        adaptiso.surface(volume, self.level,
                         progress=lambda stage, done: seen.append(volume.flags.writeable))
        self.assertGreater(len(seen), 0)
        self.assertFalse(any(seen))
        self.assertTrue(volume.flags.writeable)
        with self.assertRaises(adaptiso.Error):
            adaptiso.surface(volume, 1e9)
        self.assertTrue(volume.flags.writeable)

    def test_an_index_pickles_with_its_image(self):
        for border, order in (("closed", "F"), ("open", "C")):
            volume = np.array(ball(), np.float32, order=order)
            index = adaptiso.Index(volume, affine=SHEARED, border=border)
            again = pickle.loads(pickle.dumps(index))
            self.assertEqual(repr(again), repr(index))
            self.assertEqual(again.surface(-8), index.surface(-8))
            self.assertEqual(copy.deepcopy(index).surface(-8), index.surface(-8))

    def test_an_index_keeps_its_array_read_only(self):
        volume = np.asfortranarray(self.volume)
        index = adaptiso.Index(volume)
        self.assertFalse(volume.flags.writeable)
        self.assertEqual(index.surface(self.level), self.mesh)
        self.assertEqual(index.surface(self.level), adaptiso.surface(volume, self.level))
        del index
        self.assertTrue(volume.flags.writeable)

    def test_nan_counts_as_outside_and_is_told(self):
        volume = np.asfortranarray(self.volume)
        volume[10, 12, 14] = np.nan
        with self.assertLogs("adaptiso", "WARNING") as logs:
            mesh = adaptiso.surface(volume, self.level)
        self.assertIn("1 voxels are NaN", logs.output[0])
        self.assertEqual(pieces(mesh), 2)  # a bubble around the sample
        self.assertEqual(len(mesh.report["warnings"]), 1)

    def test_any_number_of_threads_gives_the_same_mesh(self):
        for threads in (1, 2, 3):
            self.assertEqual(adaptiso.surface(np.asfortranarray(self.volume), self.level,
                                              threads=threads), self.mesh)


class Warnings(unittest.TestCase):
    def logged(self, image, level, **options):
        with self.assertLogs("adaptiso", "WARNING") as logs:
            mesh = adaptiso.surface(image, level, **options)
        codes = [warning["code"] for warning in mesh.report["warnings"]]
        return logs.output, codes

    def test_labels_are_named_where_the_level_lies_among_them(self):
        labels = np.zeros((16, 16, 16), np.int64)
        labels[4:8], labels[8:12], labels[12:] = 1, 2, 7
        for image in (labels, np.asfortranarray(labels), labels.astype(float)):
            lines, codes = self.logged(image, 1)
            self.assertEqual(codes, ["looks-like-labels"])
            self.assertRegex(lines[0], "surface: holds 4 different whole numbers.*adaptiso.labels()")
        with self.assertNoLogs("adaptiso", "WARNING"):
            adaptiso.surface(labels, 0.5)
            adaptiso.surface(labels > 0, 1)

    def test_noise_that_the_default_bound_leaves_is_named(self):
        noise = np.random.default_rng(1).random((24, 24, 24))
        lines, codes = self.logged(noise, 0.7)
        self.assertEqual(codes, ["noise-kept"])
        self.assertRegex(lines[0], "surface: 100 % of the triangles are noise.*max_error=0.5")
        with self.assertNoLogs("adaptiso", "WARNING"):
            adaptiso.surface(noise, 0.7, max_error=0.5)


class Affines(unittest.TestCase):
    def check(self, affine, order="F"):
        volume = np.array(ball((30, 28, 26), affine=affine), order=order)
        mesh = adaptiso.surface(volume, -9, affine=affine)
        center = place(affine, [14.5, 13.5, 12.5])
        radius = np.linalg.norm(mesh.vertices - center, axis=1)
        # 0.15 of a voxel at most, and h^2 / 8r of linear interpolation, h up to 1.8 along diagonals
        self.assertLess(np.abs(radius - 9).max(), mesh.error_bound + 1.8**2 / (8 * 9))
        self.assertGreater(mesh.volume, 0)
        self.assertEqual(adaptiso.check(mesh).failed, [])
        self.assertGreater(((mesh.vertices - center) * mesh.normals).sum(axis=1).min(), 0)

    def test_translated(self):
        affine = np.eye(4)
        affine[:3, 3] = (100, -20, 7.5)
        self.check(affine)

    def test_mirrored_faces_outward(self):
        self.check(MIRRORED)
        self.check(MIRRORED, order="C")
        self.check(np.diag([-1.0, -1, -1, 1]))

    def test_sheared(self):
        self.check(SHEARED)
        self.check(SHEARED, order="C")
        self.check(SHEARED @ MIRRORED)

    def test_permuted_axes(self):
        self.check(np.eye(4)[[2, 0, 1, 3]])
        self.check(np.eye(4)[[1, 0, 2, 3]])  # mirrors

    @needs("nibabel")
    def test_a_nibabel_image_brings_its_own(self):
        import nibabel
        volume = np.asfortranarray(ball((30, 28, 26), affine=SHEARED).astype(np.float32))
        image = nibabel.Nifti1Image(volume, SHEARED)
        self.assertEqual(adaptiso.surface(image, -9), adaptiso.surface(volume, -9, affine=SHEARED))
        with self.assertRaisesRegex(adaptiso.Error, "has its own"):
            adaptiso.surface(image, -9, affine=SHEARED)

    @needs("nibabel")
    def test_a_nibabel_image_may_have_further_axes_of_one(self):
        import nibabel
        volume = ball()
        image = nibabel.Nifti1Image(volume[..., None, None], np.eye(4))
        self.assertEqual(adaptiso.surface(image, -8), adaptiso.surface(volume, -8))
        with self.assertRaisesRegex(adaptiso.Error, "one volume"):
            adaptiso.surface(nibabel.Nifti1Image(np.stack([volume] * 2, -1), np.eye(4)), -8)

    def test_an_itk_image_is_taken_as_its_package_shows_it(self):
        """By a stand-in for SimpleITK, which Debian does not have: its documented conventions,
        direction by rows, spacing and origin in LPS mm, views with k first."""
        volume = np.asfortranarray(ball((30, 28, 26), affine=SHEARED))
        lps = np.diag([-1.0, -1, 1, 1]) @ SHEARED
        spacing = np.linalg.norm(lps[:3, :3], axis=0)

        class Image:
            def GetSpacing(self):
                return tuple(spacing)

            def GetOrigin(self):
                return tuple(lps[:3, 3])

            def GetDirection(self):
                return tuple((lps[:3, :3] / spacing).ravel())

        module = type(sys)("standInForSimpleITK")
        module.GetArrayViewFromImage = lambda image: volume.transpose()
        Image.__module__ = module.__name__
        sys.modules[module.__name__] = module
        self.addCleanup(sys.modules.pop, module.__name__)
        mesh = adaptiso.surface(Image(), -9)
        truth = adaptiso.surface(volume, -9, affine=SHEARED)
        np.testing.assert_array_equal(mesh.faces, truth.faces)
        # spacing times direction rounds once more than the matrix: 1e-12 at 100 mm
        np.testing.assert_allclose(mesh.vertices, truth.vertices, atol=1e-11)


class BadInput(unittest.TestCase):
    """Every one is an adaptiso.Error with one line that names the argument."""

    def refuse(self, words, *arguments, **options):
        with self.assertRaises(adaptiso.Error) as caught:
            adaptiso.surface(*arguments, **options)
        message = str(caught.exception)
        self.assertRegex(message, words)
        self.assertNotIn("\n", message)
        self.assertIsInstance(caught.exception, ValueError)

    def test_images(self):
        for image, words in (
                (None, "image None"), (3.5, "image 3.5"), ([[1]], "image"), (object(), "image"),
                (np.zeros((4, 4)), "three axes"), (np.zeros((4, 4, 4, 2)), "one volume"),
                (np.zeros((0, 4, 4)), "no sample"), (np.zeros((4, 4, 4), complex), "complex128"),
                (np.zeros((4, 4, 4), object), "object"), (np.zeros((4, 4, 4), "U3"), "U3"),
                (np.zeros((4, 4, 4), "M8[s]"), "datetime64"),
                (np.zeros((4, 4, 4), np.longdouble), "float128|longdouble"),
                (np.zeros((4, 4, 4), [("a", "f4")]), "type"),
                (np.ma.zeros((4, 4, 4)), "masked")):
            self.refuse(words, image, 1)

    def test_files(self):
        self.refuse("nowhere.nii.*(no such|does not exist|not exist|missing|there is no)",
                    "nowhere.nii", 1)
        self.refuse("image ''|file ''", "", 1)
        self.refuse("file", "a\0b", 1)
        self.refuse("its own", pathlib.Path("nowhere.nii"), 1, affine=np.eye(4))

    def test_levels(self):
        volume = ball()
        for level in (None, "otsu", float("nan"), float("inf"), True, [1], 1j, "1", b"auto",
                      np.array([1, 2])):
            self.refuse("level", volume, level)
        for level in (True, np.True_):
            self.refuse("level True: must be a number", volume > -8, level)
        self.refuse("level 5: no voxel reaches it; the range of the image is -19.9", volume, 5)
        self.refuse("level -100: every voxel reaches it", volume, -100)
        self.refuse("level 1: no voxel reaches it; the image holds no numbers",
                    np.full((4, 4, 4), np.nan), 1)
        self.refuse("level 'auto'", np.zeros((4, 4, 4)), "auto")

    def test_affines(self):
        for affine in (np.eye(3), 1, "ras", np.zeros((4, 4)), np.full((4, 4), np.nan),
                       np.ones((4, 4)), [[1, 2], [3]], np.eye(4)[::-1], [object()] * 4,
                       np.eye(4) + 1j, np.ma.masked_equal(np.eye(4), 0)):
            self.refuse("affine", ball(), -8, affine=affine)

    def test_voxels_that_are_needles(self):
        """They would take hours, or give triangles without height; found by arguments made up."""
        needle = np.diag([1e-7, 2, 1, 1])
        self.refuse("a voxel is 2 mm long and 1e-07 mm thin", ball(), -8, affine=needle, max_error=3)
        flat = np.array([[1, 1, 0, 0], [0, 1e-7, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        self.refuse("a voxel is 1 mm long", ball(), -8, affine=flat)
        for method in ("mc", "dmc"):
            self.refuse("long", ball(), -8, affine=np.diag([1, 1e-38, 1, 1]), method=method)
        self.assertTrue(adaptiso.surface(ball(), -8, affine=np.diag([1e-3, 2, 1, 1])).is_closed)

    def test_affines_beyond_all_numbers(self):
        """Their squares are none, or voxels not told apart; found by arguments made up."""
        for step in (1e-100, 1e-31, 1e31, 1e100):
            self.refuse("affine: a voxel is", ball(), -8, affine=np.diag([step] * 3 + [1]))
        for step in (1e-30, 1e-9, 1e9, 1e30):
            mesh = adaptiso.surface(ball(), -8, affine=np.diag([step] * 3 + [1]))
            self.assertLess(mesh.error_bound, 0.16 * step)
        far = np.eye(4)
        far[:3, 3] = (0, 2e10, 0)
        self.refuse("affine: the image lies 2e.10 mm off", ball(), -8, affine=far)
        far[:3, 3] = (0, 1e10, 0)
        self.assertTrue(adaptiso.surface(ball(), -8, affine=far).is_closed)

    def test_options(self):
        for option, values in {
                "max_error": (0, -1, "0.1", float("nan"), float("inf"), [1], True),
                "triangles": (-1, 1.5, "5", 2**70, True), "reduction": (-0.1, 1.1, "half"),
                "min_angle": (-1, 41, "20"), "method": ("mc33", None, 1), "border": ("shut", None),
                "largest": (1, "yes", None), "fill_cavities": (1, None),
                "min_volume": (-1, "1", float("nan"), None),
                "threads": (-1, 1.5, 10**6, "2", None), "progress": (1, "yes")}.items():
            for value in values:
                self.refuse(option, ball(), -8, **{option: value})

    def test_options_that_do_not_go_together(self):
        self.refuse("adaptive", ball(), -8, method="mc", max_error=1)
        self.refuse("closed surfaces", ball(), -8, border="open", fill_cavities=True)
        self.refuse("min_volume 1000000: no piece", ball(), -8, min_volume=1e6)

    def test_arguments_that_there_are_not_are_answered_by_ours(self):
        for call, answer in (
                (lambda: adaptiso.surface(ball(), -8, maxerror=1), r"'maxerror'; did you mean max_error=\?$"),
                (lambda: adaptiso.surface(ball(), isovalue=-8), r"did you mean level=\?$"),
                (lambda: adaptiso.surface(ball(), iso=-8), r"did you mean level=\?$"),
                (lambda: adaptiso.read("a.zarr", refuse_missing_chunks=True), r"did you mean all_chunks=\?$"),
                (lambda: adaptiso.surface(ball(), threshold=-8), r"did you mean level=\?$"),
                (lambda: adaptiso.surface(ball(), -8, decimate=0.9), r"did you mean reduction=\?$"),
                (lambda: adaptiso.surface(ball(), -8, sigma=1), r"did you mean smooth=\?$"),
                (lambda: adaptiso.surface(ball(), -8, fwhm=1), r"smooth= takes the standard deviation"),
                (lambda: adaptiso.surface(ball(), -8, labels=[1]), r"; adaptiso.labels makes"),
                (lambda: adaptiso.surface(ball(), -8, xyzzy=1), r"keyword argument 'xyzzy'$"),
                (lambda: adaptiso.surface(ball(), -8, 0.2), r"takes image, level by position; give the "
                                                            r"others by name: max_error=, "),
                (lambda: adaptiso.Index(ball()).surface(-8, border="open"), r"argument 'border'$"),
                (lambda: adaptiso.simplify(ball(), target_reduction=0.9), r"did you mean reduction=\?$"),
                (lambda: adaptiso.mend(ball(), smooth=1), r"; .*adaptiso.surface smooths images$")):
            with self.assertRaisesRegex(TypeError, answer):
                call()
        with self.assertRaisesRegex(AttributeError, "did you mean adaptiso.surface"):
            adaptiso.mesh

    def test_preprocessing_that_cannot_be_done(self):
        for message, options in (("crop 0:99,:,:: 0:99 along i: the image has", {"crop": "0:99,:,:"}),
                                 ("crop '0:9': must be three ranges|crop 0:9: must be", {"crop": "0:9"}),
                                 ("crop -9:,:,:: must be three", {"crop": np.s_[-9:, :, :]}),
                                 ("crop .*: must be three", {"crop": np.s_[::2, :, :]}),
                                 ("crop 7: must be three|must be", {"crop": 7.5}),
                                 ("smooth 99: ", {"smooth": 99}), ("resample 99: ", {"resample": 99}),
                                 ("interpolation: is for resample", {"interpolation": "nearest"}),
                                 ("spacing 2: must be three", {"spacing": 2}),
                                 ("affine and spacing", {"spacing": (1, 1, 2), "affine": np.eye(4)})):
            self.refuse(message, ball(), -8, **options)

    def test_steps_count_along_the_array_s_own_axes(self):
        """Of a C-ordered array too, whose samples are read with its axes the other way round."""
        volume = ball((24, 30, 36), (11, 14, 17))
        mesh = adaptiso.surface(volume, -8, crop=np.s_[:, :, 17:], spacing=(1, 2, 3))
        self.assertEqual(mesh.frame, "ras")
        np.testing.assert_allclose(mesh.bounds, [(3, 12, 49.5), (19, 44, 75)], atol=0.3)  # closed half a voxel out
        smooth = adaptiso.surface(volume, -8, smooth=1, resample=0.8)
        self.assertAlmostEqual(smooth.volume / (4 / 3 * np.pi * 7.875**3), 1, delta=0.03)  # 1/8 voxel less of the radius


class Interruption(unittest.TestCase):
    def test_progress_is_told_and_what_it_raises_comes_out(self):
        told = []
        adaptiso.surface(ball((40, 40, 40)), -15,
                         progress=lambda stage, done: told.append((stage, done)))
        self.assertIn("extract", [stage for stage, _ in told])
        self.assertTrue(all(0 <= done <= 1 for _, done in told))

        class Enough(Exception):
            pass

        def stop(stage, done):
            raise Enough

        with self.assertRaises(Enough):
            adaptiso.surface(ball((40, 40, 40)), -15, progress=stop)

    def test_control_c_ends_a_call(self):
        """In a process of its own: KeyboardInterrupt comes out within three seconds of the processor, of the
        twenty or so that the call would take, and the interpreter goes on."""
        script = """
import adaptiso, numpy as np, signal, threading, os, time
noise = np.asfortranarray(np.random.default_rng(1).normal(size=(120, 120, 120)))
sent = []
def send():
    sent.append(time.process_time())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(1.0, send).start()
try:
    adaptiso.surface(noise, 0.0)
except KeyboardInterrupt:
    print("interrupted in time:", time.process_time() - sent[0] < 3)
print(len(adaptiso.surface(noise[:9, :9, :9], 0.0).faces) > 0, noise.flags.writeable)
"""
        done = subprocess.run([sys.executable, "-c", script], text=True, capture_output=True,
                              timeout=600)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("interrupted in time: True", done.stdout)
        self.assertTrue(done.stdout.endswith("True True\n"), done.stdout)
        self.assertEqual(done.stderr, "")

    def test_control_c_ends_a_check(self):
        script = """
import adaptiso, numpy as np, signal, threading, os
mesh = adaptiso.surface(np.random.default_rng(1).normal(size=(60, 60, 60)), 0.0, method="mc")
threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    while True:
        adaptiso.check(mesh)
        print("whole")
except KeyboardInterrupt:
    print("interrupted")
"""
        done = subprocess.run([sys.executable, "-c", script], text=True, capture_output=True,
                              timeout=600)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("interrupted", done.stdout)


class Quiet(unittest.TestCase):
    def test_warnings_alone_are_printed_and_no_optional_package_is_imported(self):
        script = """
import logging, sys, adaptiso, numpy as np
volume = np.zeros((8, 8, 8)); volume[2:5, 2:5, 2:5] = 1; volume[0, 0, 0] = np.nan
adaptiso.surface(volume, 0.5).report
logging.getLogger("adaptiso").setLevel("ERROR")
adaptiso.surface(volume, 0.5)
found = {name.split(".")[0] for name in sys.modules}
assert not found & {"vtk", "vtkmodules", "nibabel", "pyvista", "trimesh", "skimage", "mne"}, found
"""
        done = subprocess.run([sys.executable, "-c", script], text=True, capture_output=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr),
                         (0, "", "image: 1 voxels are NaN or infinite; NaN counts as outside\n"))


class Threads(unittest.TestCase):
    def test_calls_of_several_threads_give_what_one_gives(self):
        volumes = [ball((30, 30, 30), (14 + n, 14.5, 14.5)) for n in range(4)]
        alone = [adaptiso.surface(volume, -9) for volume in volumes]
        together = [None] * 4

        def make(n):
            together[n] = adaptiso.surface(volumes[n], -9)

        threads = [threading.Thread(target=make, args=(n,)) for n in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(together, alone)

    def test_one_array_serves_several_threads_and_is_writable_after_the_last(self):
        volume = ball((30, 30, 30))
        threads = [threading.Thread(target=adaptiso.surface, args=(volume, -9)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(volume.flags.writeable)

    def test_python_goes_on_while_cpp_works(self):
        """Without the interpreter's lock: another thread counts on meanwhile."""
        noise = np.asfortranarray(np.random.default_rng(1).normal(size=(60, 60, 60)))
        ticks, stop = [], threading.Event()

        def tick():
            while not stop.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.005)

        thread = threading.Thread(target=tick)
        thread.start()
        start = time.monotonic()
        adaptiso.surface(noise, 0.0, method="boxes")
        end = time.monotonic()
        stop.set()
        thread.join()
        during = [time for time in ticks if start < time < end]
        self.assertGreater(len(during), 0.1 * (end - start) / 0.005)


if __name__ == "__main__":
    logging.getLogger("adaptiso").setLevel(logging.WARNING)
    unittest.main(verbosity=2)
