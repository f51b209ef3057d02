"""Inputs: formats, and what is refused as bad (exit code 3)."""

import re

from support import (BAD_INPUT, ApplicationTest, Image, ball, main, write_metaimage, write_nifti,
                     write_nrrd)


class GoodInput(ApplicationTest):
    def test_formats_give_the_same_mesh(self):
        image = ball(16, 5, spacing=(1, 1.5, 2), origin=(-3, 4, 5))
        write_metaimage(self.path("a.mha"), image)
        write_nrrd(self.path("b.nrrd"), image)
        self.mesh("a.mha", "--iso", "100", "-o", "a.ply")
        self.mesh("b.nrrd", "--iso", "100", "-o", "b.ply")
        self.assertEqual(self.path("a.ply").read_bytes(), self.path("b.ply").read_bytes())

    def test_negative_isovalues_are_numbers_not_options(self):
        image = ball(16, 5)
        image.samples = [value - 200 for value in image.samples]
        write_nifti(self.path("ct.nii"), image)
        self.mesh("ct.nii", "--iso", "-100")
        self.mesh("--iso", "-100.5", "ct.nii")
        self.assertEqual(self.names(), ["ct-iso-100.5.vtp", "ct-iso-100.vtp", "ct.nii"])

    def test_otsu_chooses_between_two_values_and_says_what(self):
        ones = [200 if 2 < n % 10 < 7 and 2 < n // 10 % 10 < 7 and 2 < n // 100 < 7 else 50
                for n in range(1000)]
        write_nifti(self.path("two.nii"), Image((10, 10, 10), "B", ones))
        done = self.mesh("two.nii", "--iso", "auto")
        isovalue = re.search(r"isovalue ([\d.]+) \(chosen by Otsu", done.stdout).group(1)
        self.assertTrue(50 < float(isovalue) < 200, isovalue)
        self.assertEqual(self.names(), [f"two-iso{isovalue}.vtp", "two.nii"])


class BadInput(ApplicationTest):
    def refused(self, pattern, *arguments):
        self.assert_fails(BAD_INPUT, pattern, *arguments)

    def test_missing_file(self):
        self.refused(r"nowhere\.nii", "nowhere.nii", "--iso", "100")

    def test_no_image(self):
        self.path("text.nii").write_text("no image at all\n" * 100)
        self.path("empty.nii").write_bytes(b"")
        self.path("folder").mkdir()
        for name in ("text.nii", "empty.nii", "folder"):
            with self.subTest(name):
                self.refused(re.escape(name), name, "--iso", "100")

    def test_truncated_image(self):
        write_nifti(self.path("ball.nii"), ball(16, 5))
        whole = self.path("ball.nii").read_bytes()
        self.path("ball.nii").write_bytes(whole[:len(whole) // 2])
        self.refused(r"ball\.nii", "ball.nii", "--iso", "100")

    def test_isovalue_outside_the_values_names_them(self):
        write_nifti(self.path("two.nii"), Image((2, 2, 2), "B", [10, 20, 20, 20, 20, 20, 20, 30]))
        self.refused("no voxel reaches it; the range of two.nii is 10 to 30", "two.nii",
                     "--iso", "30.5")
        self.refused("every voxel reaches it.*the range of two.nii is 10 to 30", "two.nii", "--iso", "10")
        self.refused("every voxel reaches it.*the range of two.nii is 10 to 30", "two.nii", "--iso=-5")
        self.mesh("two.nii", "--iso", "30")
        self.mesh("two.nii", "--iso", "10.5")

    def test_one_bad_isovalue_of_several_writes_nothing(self):
        write_nifti(self.path("ball.nii"), ball(16, 5))
        self.refused("no voxel reaches it", "ball.nii", "--iso", "100", "--iso", "9999")

    def test_automatic_isovalue_of_a_constant_image(self):
        write_nifti(self.path("flat.nii"), Image((4, 4, 4), "B", [7] * 64))
        self.refused("otsu|Otsu", "flat.nii", "--iso", "auto")

    def test_image_without_a_number(self):
        write_nifti(self.path("nan.nii"), Image((3, 3, 3), "f", [float("nan")] * 27))
        self.refused("nan.nii holds no numbers", "nan.nii", "--iso", "1")

    def test_no_piece_is_large_enough(self):
        write_nifti(self.path("ball.nii"), ball(16, 5))
        self.refused("--min-volume 9999", "ball.nii", "--iso", "100", "--min-volume", "9999")

    def test_messages_stay_on_one_line(self):
        for arguments in (["odd\nname\x1b[2J.nii"], ["a.nii", "-o", "odd\nname\x1b[2J/a.ply"]):
            with self.subTest(arguments):
                done = self.assert_fails(BAD_INPUT, "odd.*name", *arguments, "--iso", "100")
                self.assertNotIn("\x1b", done.stderr)


if __name__ == "__main__":
    main()
