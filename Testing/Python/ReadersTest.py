"""Images read by nibabel, as a package built without readers (ADAPTISO_PYTHON_READERS=OFF) does."""

import unittest

import adaptiso
import numpy as np
from adaptiso import _adaptiso
from support import BRAIN, InFolder, needs

AFFINE = np.array([[-1.5, 0.2, 0, 20], [0, 0.9, 1.1, -30], [0.1, -1, 1.2, 12], [0, 0, 0, 1]],
                  np.float32).astype(float)  # as NIfTI's sform holds it


@needs("nibabel")
class WithoutReaders(InFolder):
    def setUp(self):
        super().setUp()
        self.own = getattr(_adaptiso, "read_image", None)
        if self.own is not None:
            del _adaptiso.read_image
            self.addCleanup(setattr, _adaptiso, "read_image", self.own)

    def by_own(self, *arguments, **options):
        """What adaptiso's own readers make of it."""
        if self.own is None:
            self.skipTest("built without readers")
        _adaptiso.read_image = self.own
        try:
            return adaptiso.read(*arguments, **options)
        finally:
            del _adaptiso.read_image

    def saved(self, name, samples, kind="Nifti1Image", scaling=None):
        import nibabel
        image = getattr(nibabel, kind)(samples, AFFINE)
        if scaling is not None:
            image.header.set_slope_inter(*scaling)
        nibabel.save(image, self.folder / name)
        return self.folder / name

    def test_gives_what_the_own_readers_give(self):
        samples = np.random.default_rng(1).integers(0, 200, (7, 6, 5))
        for file in (self.saved("a.nii", samples.astype(np.uint8)),
                     self.saved("b.nii.gz", samples.astype(np.float32)),
                     self.saved("c.nii", samples.astype(np.int16), scaling=(0.5, -3)),
                     self.saved("d.mgz", samples.astype(np.int16), "MGHImage")):
            ours, theirs = self.by_own(file), adaptiso.read(file)
            np.testing.assert_array_equal(theirs.array, ours.array)
            self.assertEqual(theirs.array.dtype, ours.array.dtype)
            np.testing.assert_allclose(theirs.affine, ours.affine, atol=1e-5)  # float32 in the file
            self.assertTrue(theirs.array.flags.f_contiguous)
            self.assertFalse(theirs.array.flags.writeable)

    def test_takes_one_volume_of_four_dimensions(self):
        samples = np.random.default_rng(1).integers(0, 200, (4, 4, 4, 3)).astype(np.uint8)
        file = self.saved("a.nii", samples)
        np.testing.assert_array_equal(adaptiso.read(file, volume_index=2).array, samples[..., 2])
        with self.assertRaisesRegex(adaptiso.Error, "give volume_index"):
            adaptiso.read(file)

    def test_refuses_with_one_line(self):
        (self.folder / "no.nii").write_text("no image")
        for arguments, options in (((self.folder / "no.nii",), {}), ((self.folder / "none.nii",), {}),
                                   ((self.folder,), {}), ((self.folder / "a.dcm",), {"series": 1})):
            with self.assertRaises(adaptiso.Error) as caught:
                adaptiso.read(*arguments, **options)
            self.assertNotIn("\n", str(caught.exception))

    @unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
    def test_surfaces_of_files_are_the_same(self):
        ours = self.by_own(BRAIN)
        self.assertEqual(adaptiso.surface(BRAIN, 100, method="boxes"),
                         adaptiso.surface(ours, 100, method="boxes"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
