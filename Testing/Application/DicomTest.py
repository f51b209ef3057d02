"""DICOM folders: tilt, what a folder holds, volumes, uneven slices."""

import gzip
import json
import math
import re
import struct

from support import BAD_INPUT, SOURCE, USAGE, ApplicationTest, ball, main, write_nifti

SECRETS = ("Doe", "Head first", "1.2.3")


def element(group, number, vr, value):
    """An element in explicit little-endian form; text is padded to even length."""
    if isinstance(value, str):
        value = value.encode() + (b"\0" if vr == "UI" else b" ") * (len(value) % 2)
    head = struct.pack("<HH", group, number) + vr.encode()
    if vr in ("OB", "OW", "SQ"):
        return head + struct.pack("<HI", 0, len(value)) + value
    return head + struct.pack("<H", len(value)) + value


def number(value):
    return f"{value:.10g}"


def slice_file(samples, columns, rows, position, along_column=(0, 1, 0), uid="1.2.3", echo=None,
               image_type="ORIGINAL\\PRIMARY\\AXIAL", time=None, patient="Doe^Jane", modality="CT"):
    """A CT slice of signed 16-bit samples, 1 mm pixels, rows along x."""
    us = lambda value: struct.pack("<H", value)
    data = b"".join([
        element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1"),
        element(0x0008, 0x0008, "CS", image_type),
        element(0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.2"),
        element(0x0008, 0x0032, "TM", time) if time else b"",
        element(0x0008, 0x0060, "CS", modality),
        element(0x0008, 0x103E, "LO", "Head first"),
        element(0x0010, 0x0010, "PN", patient),
        element(0x0018, 0x0086, "IS", str(echo)) if echo else b"",
        element(0x0020, 0x000E, "UI", uid),
        element(0x0020, 0x0032, "DS", "\\".join(map(number, position))),
        element(0x0020, 0x0037, "DS", "1\\0\\0\\" + "\\".join(map(number, along_column))),
        element(0x0028, 0x0002, "US", us(1)),
        element(0x0028, 0x0004, "CS", "MONOCHROME2"),
        element(0x0028, 0x0010, "US", us(rows)),
        element(0x0028, 0x0011, "US", us(columns)),
        element(0x0028, 0x0030, "DS", "1\\1"),
        element(0x0028, 0x0100, "US", us(16)),
        element(0x0028, 0x0101, "US", us(16)),
        element(0x0028, 0x0102, "US", us(15)),
        element(0x0028, 0x0103, "US", us(1)),
        element(0x0028, 0x1052, "DS", "-1000"),
        element(0x0028, 0x1053, "DS", "1"),
        element(0x7FE0, 0x0010, "OW", struct.pack(f"<{len(samples)}h", *samples))])
    return bytes(128) + b"DICM" + data


def sequence(group, number, items):
    """A sequence of data sets, each the bytes of its elements."""
    return element(group, number, "SQ", b"".join(
        struct.pack("<HHI", 0xFFFE, 0xE000, len(item)) + item for item in items))


def segmentation(heights, columns, rows, is_inside):
    """A DICOM SEG of one bit a pixel, a frame at each of the heights, 1 mm pixels; its segments
    by number are those of is_inside(segment, i, j, height)."""
    us = lambda value: struct.pack("<H", value)
    bits = [is_inside(segment, i, j, z) for segment in (1, 2) for z in heights[segment]
            for j in range(rows) for i in range(columns)]
    packed = bytes(sum(bit << n for n, bit in enumerate(bits[at:at + 8]))
                   for at in range(0, len(bits), 8))
    frames = [(segment, z) for segment in (1, 2) for z in heights[segment]]
    data = b"".join([
        element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1"),
        element(0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.66.4"),
        element(0x0008, 0x0060, "CS", "SEG"),
        element(0x0010, 0x0010, "PN", "Doe^Jane"),
        element(0x0020, 0x000E, "UI", "1.2.3.6"),
        element(0x0028, 0x0002, "US", us(1)),
        element(0x0028, 0x0004, "CS", "MONOCHROME2"),
        element(0x0028, 0x0008, "IS", str(len(frames))),
        element(0x0028, 0x0010, "US", us(rows)),
        element(0x0028, 0x0011, "US", us(columns)),
        element(0x0028, 0x0100, "US", us(1)),
        element(0x0028, 0x0101, "US", us(1)),
        element(0x0028, 0x0102, "US", us(0)),
        element(0x0028, 0x0103, "US", us(0)),
        sequence(0x0062, 0x0002, [
            element(0x0062, 0x0004, "US", us(n + 1)) + element(0x0062, 0x0005, "LO", name)
            for n, name in enumerate(("Liver", "Left kidney"))]),
        sequence(0x5200, 0x9229, [
            sequence(0x0020, 0x9116, [element(0x0020, 0x0037, "DS", "1\\0\\0\\0\\1\\0")]) +
            sequence(0x0028, 0x9110, [element(0x0018, 0x0088, "DS", "2") +
                                      element(0x0028, 0x0030, "DS", "1\\1")])]),
        sequence(0x5200, 0x9230, [
            sequence(0x0020, 0x9113, [element(0x0020, 0x0032, "DS", f"0\\0\\{z}")]) +
            sequence(0x0062, 0x000A, [element(0x0062, 0x000B, "US", us(segment))])
            for segment, z in frames]),
        element(0x7FE0, 0x0010, "OB", packed + b"\0" * (len(packed) % 2))])
    return bytes(128) + b"DICM" + data


class Sphere:
    """A ball whose values fall by 40 a mm, 250 HU at its radius of 20 mm."""
    center, radius, side = (3.0, -4.0, 40.0), 20.0, 60

    def write(self, folder, heights, tilt_degrees=0, **options):
        """Slices at these z; the table moves along z, the gantry is tilted about x."""
        folder.mkdir(exist_ok=True)
        tilt = math.radians(tilt_degrees)
        along = (0, math.cos(tilt), math.sin(tilt))
        for n, z in enumerate(heights):
            first = (self.center[0] - 30, self.center[1] - 30 * along[1], z - 30 * along[2])
            samples = []
            for j in range(self.side):
                for i in range(self.side):
                    point = (first[0] + i, first[1] + j * along[1], first[2] + j * along[2])
                    value = 250 + 40 * (self.radius - math.dist(point, self.center))
                    samples.append(round(min(3000, max(-1000, value))) + 1000)
            name = "".join(str(options.get(key, "")) for key in ("uid", "echo", "time"))
            name += str(n * 7 % 101)
            (folder / name).write_bytes(
                slice_file(samples, self.side, self.side, first, along, **options))


class DicomImages(ApplicationTest):
    def vertices(self, *arguments):
        self.mesh(*arguments, "--iso", "250", "--method", "mc", "--coordinates", "lps",
                  "-o", "out.obj")
        return [tuple(map(float, line.split()[1:4]))
                for line in self.path("out.obj").read_text().splitlines()
                if line.startswith("v ")]

    def assert_is_sphere(self, points, tolerance_mm):
        self.assertGreater(len(points), 1000)
        worst = max(abs(math.dist(p, Sphere.center) - Sphere.radius) for p in points)
        self.assertLess(worst, tolerance_mm)
        for axis in range(3):  # all of it
            extent = max(p[axis] for p in points) - min(p[axis] for p in points)
            self.assertAlmostEqual(extent, 2 * Sphere.radius, delta=0.4)  # (2 mm)^2 / 2 r, twice

    def test_a_tilted_gantry_keeps_the_sphere_round_and_in_place(self):
        Sphere().write(self.path("ct"), range(0, 81, 2), tilt_degrees=16)
        # linear between voxels up to 2 mm apart: (2 mm)^2 / 8 r = 0.025 mm, values to 1/80 mm
        self.assert_is_sphere(self.vertices("ct"), 0.1)
        done = self.mesh("ct", "--iso", "250", "-o", "again.ply")
        self.assertRegex(done.stderr, r"tilted by 16\.00 degrees")

    def test_uneven_slices_are_resampled_when_asked(self):
        heights = [*range(0, 30, 2), *range(30, 50, 1), *range(50, 81, 2)]
        Sphere().write(self.path("ct"), heights)
        self.assert_fails(BAD_INPUT, "uneven slice spacing.*--resample-slices", "ct", "--iso", "250")
        # blended and interpolated: 0.025 mm each, and the values' rounding
        self.assert_is_sphere(self.vertices("ct", "--resample-slices"), 0.1)

    def test_a_slice_that_is_there_only_compressed_is_refused(self):
        Sphere().write(self.path("ct"), range(10, 71, 2))
        last = self.path("ct") / str(30 * 7 % 101)  # no gap would tell of it
        compressed = gzip.compress(last.read_bytes())
        (self.path("ct") / f"{last.name}.dcm.gz").write_bytes(compressed)
        last.rename(self.path("ct") / f"{last.name}.dcm")
        self.assertIn("left out 1 compressed", self.mesh("ct", "--iso", "250", "-o", "a.ply").stderr)
        self.path("a.ply").unlink()
        (self.path("ct") / f"{last.name}.dcm").unlink()
        self.assert_fails(BAD_INPUT, r"ct: file \d+ \(by name\): is a compressed DICOM file", "ct", "--iso", "250")

    def test_a_volume_is_chosen_by_its_index(self):
        for echo in (1, 2):
            Sphere().write(self.path("ct"), range(10, 71, 2), echo=echo)
        self.assert_fails(BAD_INPUT, "2 volumes.*echoes.*--volume-index 0 to 1", "ct", "--iso", "250")
        self.assert_is_sphere(self.vertices("ct", "--volume-index", "1"), 0.1)
        for wrong in ("-1", "x", "1.5"):
            self.assert_fails(USAGE, "--volume-index", "ct", "--iso", "250",
                              f"--volume-index={wrong}")

    def test_passes_over_the_same_places_are_told_apart_by_their_times(self):
        Sphere().write(self.path("ct"), range(10, 71, 2), time="120000")
        smaller = Sphere()
        smaller.radius = 10.0
        smaller.write(self.path("ct"), range(10, 71, 2), time="120030")
        self.assert_fails(BAD_INPUT, "2 volumes.*acquisition times.*--volume-index 0 to 1", "ct",
                          "--iso", "250")
        self.assert_is_sphere(self.vertices("ct", "--volume-index", "0"), 0.1)

    def test_two_patients_in_one_series_are_not_mixed(self):
        for first, patient in ((10, "Doe^Jane"), (12, "Doe^John")):
            Sphere().write(self.path("ct"), range(first, 71, 4), patient=patient, echo=first)
        done = self.assert_fails(BAD_INPUT, "2 groups of slices.*Patient 1; 2:.*Patient 2.*--series",
                                 "ct", "--iso", "250")
        listed = self.mesh("ct", "--list-series").stdout
        self.assertIn("Patient 2", listed)
        for secret in SECRETS:
            self.assertNotIn(secret, done.stderr + listed)

    def test_the_list_of_a_refusal_names_the_modality(self):
        Sphere().write(self.path("study"), range(10, 41, 2), uid="1.2.3")
        Sphere().write(self.path("study"), range(10, 41, 2), uid="1.2.4", modality="PT")
        self.assert_fails(BAD_INPUT, r"2 groups of slices.*\(1: CT, 16 slices.*; 2: PT, 16 slices.*--list-series",
                          "study", "--iso", "250")

    def test_a_folder_of_other_images_is_a_batch(self):
        self.path("in").mkdir()
        write_nifti(self.path("ball.nii"), ball(12, 4))
        for name in ("a.nii.gz", "b.nii.gz", "c.nii.gz"):
            (self.path("in") / name).write_bytes(gzip.compress(self.path("ball.nii").read_bytes()))
        self.path("in/notes.txt").write_text("x")
        self.path("in/a.json").write_text("{}")
        self.assert_fails(BAD_INPUT, r"no DICOM file found in this folder: it holds 3 NIfTI files; give one of them; "
                                     r"a batch takes all: in/\*\.nii\.gz", "in", "--iso", "50")
        self.path("study").mkdir()
        self.path("in").rename(self.path("study/sub-1"))
        self.assert_fails(BAD_INPUT, r"a batch takes all: --list takes what find study -name '\*\.nii\.gz' prints",
                          "study", "--iso", "50")

    def test_frames_left_out_of_a_segmentation_are_empty(self):
        boxes = {1: (2, 4, 6, 16, 18), 2: (8, 10, 12)}
        inside = lambda segment, i, j, z: 2 <= i < 10 and 2 <= j < 9
        self.path("seg.dcm").write_bytes(segmentation(boxes, 13, 11, inside))
        self.assert_fails(BAD_INPUT, "segment 1 'Liver'.*segment 2 'Left kidney'.*--series",
                          "seg.dcm", "--iso", "0.5")
        done = self.mesh("seg.dcm", "--series", "1", "--iso", "0.5", "--method", "mc",
                         "--coordinates", "lps", "--json", "out.json", "-o", "out.obj")
        self.assertEqual(done.stderr, "")
        heights = {float(line.split()[3]) for line in self.path("out.obj").read_text().splitlines()
                   if line.startswith("v ")}
        # half a step above and below each box
        self.assertEqual(heights, {1, 2, 4, 6, 7, 15, 16, 18, 19})

    def test_a_pointer_in_a_slices_place_is_refused(self):
        Sphere().write(self.path("ct"), range(10, 71, 2))
        (self.path("ct") / "7").write_text("version https://git-lfs.github.com/spec/v1\nsize 9\n")
        self.assert_fails(BAD_INPUT, r"ct: file \d+ \(by name\): is a git-lfs pointer.*git lfs pull", "ct", "--iso", "250")

    def write_study(self):
        Sphere().write(self.path("study"), (0, 2, 4))
        Sphere().write(self.path("study"), (0, 2, 5), uid="1.2.3.2")
        Sphere().write(self.path("study"), (0,), uid="1.2.3.3",
                       image_type="ORIGINAL\\PRIMARY\\LOCALIZER")
        self.path("study/Doe.dcm").write_bytes(b"no DICOM")

    def test_series_are_listed_without_a_trace_of_the_patient(self):
        self.write_study()
        done = self.mesh("study", "--list-series")
        self.assertIn("study holds 3 series", done.stdout)
        self.assertIn("1: CT, 3 slices of 60 x 60 voxels, 1 x 1 x 2 mm, axial", done.stdout)
        self.assertIn("uneven slice spacing", done.stdout)
        self.assertIn("localizer", done.stdout)
        for secret in SECRETS:
            self.assertNotIn(secret, done.stdout + done.stderr)
        self.assertEqual(self.names(), ["study"])

    def test_series_are_listed_as_json(self):
        self.write_study()
        report = json.loads(self.mesh("study", "--list-series", "--json", "-").stdout)
        self.assertEqual(report["schema"], "adaptiso-series/1")
        first, second, third = report["series"]
        self.assertEqual(first["number"], 1)
        self.assertEqual(first["modality"], "CT")
        self.assertEqual(first["sizeVoxels"], [60, 60, 3])
        self.assertEqual(first["spacingMm"], [1, 1, 2])
        self.assertTrue(first["readable"])
        self.assertIsNone(first["fault"])
        self.assertFalse(second["readable"])
        self.assertIsNone(second["spacingMm"][2])
        self.assertRegex(second["fault"], "uneven")
        self.assertTrue(third["localizer"])
        self.assertEqual(len(report["damagedFiles"]), 1)
        for secret in SECRETS:
            self.assertNotIn(secret, json.dumps(report))
        self.mesh("study", "--list-series", "--json", "list.json", "--quiet")
        self.assertEqual(json.loads(self.path("list.json").read_text()), report)

    def test_keys_of_the_list_are_the_documented_ones(self):
        readme = (SOURCE / "Applications" / "adaptiso-mesh" / "README.md").read_text()
        section = readme.split("## The list of series")[1].split("## ")[0]
        documented = {key for row in re.findall(r"^\| (`.*?`) \|", section, re.MULTILINE)
                      for key in re.findall(r"`([^`]+)`", row)}
        self.write_study()
        report = json.loads(
            self.mesh("study", "--list-series", "--show-phi", "--json", "-").stdout)
        keys = {f".{key}" for key in report["series"][0]}
        for key, value in report.items():
            keys |= {f"{key}.{k}" for k in value} if isinstance(value, dict) else {key}
        self.assertEqual(keys, documented)

    def test_what_identifies_the_patient_is_listed_when_asked(self):
        self.write_study()
        done = self.mesh("study", "--list-series", "--show-phi")
        for shown in ("1.2.3.2", "Head first", "Doe.dcm"):
            self.assertIn(shown, done.stdout)
        report = json.loads(
            self.mesh("study", "--list-series", "--show-phi", "--json", "-").stdout)
        self.assertEqual(report["series"][1]["uid"], "1.2.3.2")
        self.assertEqual(report["series"][1]["description"], "Head first")
        self.assert_fails(USAGE, "--list-series", "study", "--iso", "1", "--show-phi")

    def test_localizers_are_left_aside_with_a_warning(self):
        Sphere().write(self.path("ct"), range(10, 71, 2))
        Sphere().write(self.path("ct"), (0,), uid="1.2.3.3",
                       image_type="ORIGINAL\\PRIMARY\\LOCALIZER")
        self.assert_is_sphere(self.vertices("ct"), 0.1)
        done = self.mesh("ct", "--iso", "250", "-o", "again.ply")
        self.assertRegex(done.stderr, "left aside: 1 slice of 60 x 60 voxels.*localizer")
        self.assertIsNone(re.search(r"1\.2\.3", done.stderr))

    def test_iso_is_required_unless_series_are_listed(self):
        self.write_study()
        self.assert_fails(USAGE, "--iso is missing", "study")


if __name__ == "__main__":
    main()
