"""adaptiso-labels on maps that are all walls: minutes each, so that it is no part of CI."""

import random

from labelsSupport import LabelsTest, label_map
from support import Image, main, write_nifti


class LabelsNoiseTest(LabelsTest):
    def made(self, name, image):
        """The program's own checks judge: that they can fail is tested in LabelsCheckTest.cxx."""
        write_nifti(self.path(name + ".nii"), image)
        self.labels(name + ".nii", "-o", name, "--any-map", "--quiet", timeout=3600)
        report = self.folder_report(name)
        self.assertTrue(report["passed"], report["checks"])
        self.assertEqual(len(report["regions"]), report["input"]["labels"])
        return report

    def test_noise_of_five_labels_on_64_voxels_a_side(self):
        values = random.Random(64)
        report = self.made("noise", Image((64, 64, 64), "B",
                                          [values.randrange(5) for _ in range(64 ** 3)]))
        self.assertLess(report["walls"]["triangles"], report["walls"]["fullTriangles"] / 2)

    def test_checkerboard_of_40_voxels_a_side(self):
        self.made("checkers", label_map((40, 40, 40), lambda i, j, k: 1 + (i + j + k) % 2))


if __name__ == "__main__":
    main()
