"""Inputs: formats, and what is refused as bad (exit code 3)."""

import json
import math
import re
import struct

from support import (BAD_INPUT, ApplicationTest, Image, ball, from_function, main, write_metaimage,
                     write_nifti, write_nrrd)


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

    def test_a_label_map_is_named_where_the_isovalue_lies_among_its_labels(self):
        def labels(values):
            return from_function(16, "B", lambda x, y, z: values[(x > -4) + (x > 0) + (x > 4)])
        write_nifti(self.path("map.nii"), labels((0, 1, 2, 7)))
        for isovalue, of_it in ((0.5, 0), (1, 1), (1.5, 1), (2, 1), (6, 1)):
            warnings = self.report("map.nii", "--iso", isovalue, "-o", "a.ply")["warnings"]
            self.assertEqual([w["code"] for w in warnings], of_it * ["looks-like-labels"], isovalue)
        self.assertRegex(warnings[0]["text"], "holds 4 different whole numbers.*for regions: adaptiso-labels$")
        self.assertEqual(warnings[0]["file"], "map.nii")
        several = self.report("map.nii", "--iso", 1, "--iso", 2, "-o", "a.ply")["warnings"]
        self.assertEqual(len(several), 1)
        for values in ((0, 1, 1, 1), (0, 255, 0, 255), (0, 100, 200, 255 - 5)):  # masks, a phantom
            write_nifti(self.path("other.nii"), labels(values))
            self.assertEqual(self.report("other.nii", "--iso", max(values), "-o", "a.ply")["warnings"], [])
        write_nifti(self.path("ball.nii"), ball())  # whole numbers, from voxel to voxel
        self.assertEqual(self.report("ball.nii", "--iso", 100, "-o", "a.ply")["warnings"], [])

    def test_otsu_chooses_between_two_values_and_says_what(self):
        ones = [200 if 2 < n % 10 < 7 and 2 < n // 10 % 10 < 7 and 2 < n // 100 < 7 else 50
                for n in range(1000)]
        write_nifti(self.path("two.nii"), Image((10, 10, 10), "B", ones))
        done = self.mesh("two.nii", "--iso", "auto")
        isovalue = re.search(r"isovalue ([\d.]+) \(chosen by Otsu", done.stdout).group(1)
        self.assertTrue(50 < float(isovalue) < 200, isovalue)
        self.assertEqual(self.names(), [f"two-iso{isovalue}.vtp", "two.nii"])


def write_with_affine(path, image, rows):
    """A NIfTI file whose sform is `rows` (3 x 4, RAS)."""
    write_nifti(path, image)
    content = bytearray(path.read_bytes())
    for axis, row in enumerate(rows):
        struct.pack_into("<4f", content, 280 + 16 * axis, *row)
    path.write_bytes(bytes(content))


def read_obj(path):
    """Points, normals and triangles (from 0) of an OBJ file."""
    lines = [line.split() for line in path.read_text().splitlines()]
    def numbers(kind): return [tuple(map(float, line[1:])) for line in lines if line[:1] == [kind]]
    faces = [tuple(int(corner.split("/")[0]) - 1 for corner in line[1:])
             for line in lines if line[:1] == ["f"]]
    return numbers("v"), numbers("vn"), faces


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


class ShearedInput(ApplicationTest):
    """An affine map takes the surface in voxels to that in space, to the last vertex and normal."""

    STRAIGHT = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0))
    # columns are the steps along i, j and k; gantry tilt is the second row's last but one
    SHEARED = ((1.5, 0.25, 0, -10), (0, 2, 0.75, 20), (0.5, 0, 1.25, 30))

    def transformed(self, name, rows, method):
        write_with_affine(self.path("x.nii"), ball(16, 5), rows)
        report = self.report("x.nii", "--iso", "100", "--method", method, "-o", name)
        return report["surfaces"][0], read_obj(self.path(name))

    def test_points_normals_winding_and_volume(self):
        mirrored = tuple((-row[0],) + row[1:] for row in self.SHEARED)
        for method in ("mc", "boxes"):
            straight, (points, normals, faces) = self.transformed("a.obj", self.STRAIGHT, method)
            for rows in (self.SHEARED, mirrored):
                with self.subTest(method=method, rows=rows):
                    a, b, c = (tuple(row[axis] for row in rows) for axis in range(3))
                    determinant = dot(a, cross(b, c))
                    inverse_transpose = tuple(  # its columns; sign and length do not matter here
                        tuple(x / determinant for x in cross(*pair))
                        for pair in ((b, c), (c, a), (a, b)))
                    report, (moved, moved_normals, moved_faces) = self.transformed(
                        "b.obj", rows, method)
                    self.assertEqual(len(moved), len(points))
                    for point, other in zip(points, moved):
                        for row, coordinate in zip(rows, other):
                            # nine digits of numbers below 100, from a float32 header
                            self.assertAlmostEqual(dot(row[:3], point) + row[3], coordinate,
                                                   delta=2e-5)
                    for normal, other in zip(normals, moved_normals):
                        expected = unit(tuple(sum(column[axis] * n for column, n in
                                                  zip(inverse_transpose, normal))
                                              for axis in range(3)))
                        self.assertGreater(dot(expected, unit(other)), 1 - 1e-5)  # float normals
                    # an affine map multiplies volumes by its determinant
                    self.assertAlmostEqual(report["volumeMm3"],
                                           abs(determinant) * straight["volumeMm3"],
                                           delta=1e-4 * report["volumeMm3"])
                    self.assertGreater(report["volumeMm3"], 0)
                    if method == "mc":  # the same triangles, turned round in a mirrored image
                        def canonical(face): return min(face[n:] + face[:n] for n in range(3))
                        turned = [face[::-1] if determinant < 0 else face for face in faces]
                        self.assertEqual(sorted(map(canonical, turned)),
                                         sorted(map(canonical, moved_faces)))


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

    def test_more_than_the_header_says(self):
        write_nifti(self.path("two.nii"), ball(16, 5))
        whole = self.path("two.nii").read_bytes()
        self.path("two.nii").write_bytes(whole + whole[352:])
        self.refused(r"two\.nii: holds .* behind the image .*1 more image", "two.nii", "--iso", "100")
        write_metaimage(self.path("wide.mha"), ball(16, 5))
        header = self.path("wide.mha").read_bytes().partition(b"LOCAL\n")[0]
        self.path("wide.mha").write_bytes(header.replace(b"MET_SHORT", b"MET_LONG") + b"LOCAL\n" +
                                          struct.pack("<4096q", *range(4096)))  # 16^3
        self.refused("MET_LONG has 4 bytes", "wide.mha", "--iso", "100")

    def test_what_is_harmless_is_said_and_read(self):
        write_metaimage(self.path("ball.mha"), ball(16, 5))
        content = self.path("ball.mha").read_bytes()
        start, end = content.index(b"Offset"), content.index(b"CenterOfRotation")
        self.path("ball.mha").write_bytes(content[:start] + content[end:] + b"a note")
        done = self.mesh("ball.mha", "--iso", "100")
        self.assertIn("no Offset", done.stderr)
        self.assertIn("6 bytes follow", done.stderr)

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
        self.refused("--iso auto: flat.nii: .*nothing to separate", "flat.nii", "--iso", "auto")

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


class N5(ApplicationTest):
    def test_levels_are_chosen_by_number(self):
        """A cube of 4 mm in two resolutions; --level was once taken for Zarr's alone."""
        for level, side in enumerate((8, 4)):
            array = self.path("v") / f"s{level}"
            (array / "0/0").mkdir(parents=True)
            (array / "attributes.json").write_text(json.dumps({
                "dimensions": [side] * 3, "blockSize": [side] * 3, "dataType": "uint8",
                "compression": {"type": "raw"}, "downsamplingFactors": [8 // side] * 3}))
            inside = range(side // 4, 3 * side // 4)
            samples = bytes(100 if {i, j, k} <= set(inside) else 0 for k in range(side) for j in range(side)
                            for i in range(side))
            (array / "0/0/0").write_bytes(struct.pack(">HHIII", 0, 3, side, side, side) + samples)
        (self.path("v") / "attributes.json").write_text(json.dumps({
            "n5": "2.5.0", "scales": [[1, 1, 1], [2, 2, 2]],
            "pixelResolution": {"unit": "mm", "dimensions": [1, 1, 1]}}))
        for level, spacing in ((0, 1), (1, 2)):
            report = self.report("v", "--iso", "50", "--level", str(level), "--channel", "0", "-o", "o.ply")
            self.assertEqual(report["input"]["format"], "N5")
            self.assertEqual(report["input"]["spacingMm"], [spacing] * 3)


if __name__ == "__main__":
    main()
