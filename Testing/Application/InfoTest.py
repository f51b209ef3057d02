"""--info: what it tells of an image agrees with what is known on paper, and with reading it."""

import html
import json
import math
import re
import shlex

from DicomTest import SECRETS, Sphere
from support import (BAD_INPUT, CHECK_FAILED, SOURCE, USAGE, ApplicationTest, Image, ball, from_function,
                     main, write_nifti)


def write_nrrd_with(path, directions, size=(4, 5, 6), origin=(10, 20, 30)):
    def text(v): return "(" + ",".join(map(str, v)) + ")"
    header = (f"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
              f"sizes: {size[0]} {size[1]} {size[2]}\n"
              f"space directions: {' '.join(map(text, directions))}\n"
              f"kinds: domain domain domain\nencoding: raw\nspace origin: {text(origin)}\n\n")
    path.write_bytes(header.encode() + bytes(n % 100 for n in range(math.prod(size))))


class Info(ApplicationTest):
    def info(self, *arguments):
        return json.loads(self.mesh(*arguments, "--info", "--json", "-").stdout)

    def test_geometry(self):
        tilt = math.radians(16)
        kinds = {  # directions, orientation, right-handed, sheared, tilt
            "axes": (((1, 0, 0), (0, 2, 0), (0, 0, 3)), "LPS", True, False, 0),
            "ras": (((-1, 0, 0), (0, -2, 0), (0, 0, 3)), "RAS", True, False, 0),
            "mirrored": (((-1, 0, 0), (0, 2, 0), (0, 0, 3)), "RPS", False, False, 0),
            "coronal": (((1, 0, 0), (0, 0, -2), (0, 3, 0)), "LIP", True, False, 0),
            "oblique": (((0.8, 0.6, 0), (-1.2, 1.6, 0), (0, 0, 3)), "LPS", True, False, 0),
            "tilted": (((1, 0, 0), (0, 2, 0),
                        (0, 3 * math.sin(tilt), 3 * math.cos(tilt))), "LPS", True, True, 16),
        }
        for kind, (directions, orientation, is_right, is_sheared, tilt_deg) in kinds.items():
            with self.subTest(kind):
                write_nrrd_with(self.path("in.nrrd"), directions)
                image = self.info("in.nrrd")["image"]
                self.assertEqual(image["sizeVoxels"], [4, 5, 6])
                self.assertEqual(image["originMm"], [10, 20, 30])
                self.assertEqual(image["frame"], "lps")
                self.assertEqual(image["orientation"], orientation)
                self.assertEqual(image["rightHanded"], is_right)
                self.assertEqual(image["sheared"], is_sheared)
                self.assertAlmostEqual(image["tiltDeg"], tilt_deg, places=6)
                self.assertAlmostEqual(image["axisAnglesDeg"][0], 90 - tilt_deg, places=6)
                for axis, spacing in enumerate((1, 2, 3)):
                    self.assertAlmostEqual(image["spacingMm"][axis], spacing, places=9)
                    for row in range(3):
                        self.assertAlmostEqual(image["direction"][row][axis],
                                               directions[axis][row] / spacing, places=9)
                text = self.mesh("in.nrrd", "--info").stdout
                self.assertIn("4 x 5 x 6 voxels, uint8", text)
                self.assertIn("right-handed" if is_right else "left-handed (mirrored)", text)
                self.assertIn("tilted by 16.00 degrees" if is_sheared else "at right angles", text)

    def test_values_known_on_paper(self):
        # 0 ... 9999 once each, in some order: percentile p is the rank p * 100, less 1
        size, values = (100, 10, 10), [(n * 37) % 10000 for n in range(10000)]
        write_nifti(self.path("in.nii"), Image(size, "h", values))
        told = self.info("in.nii")["values"]
        self.assertEqual((told["finite"], told["notFinite"]), (10000, 0))
        self.assertEqual((told["minimum"], told["maximum"]), (0, 9999))
        for entry in told["percentiles"]:
            self.assertEqual(entry["value"], max(0, round(entry["percent"] * 100) - 1))
        histogram = told["histogram"]  # from 9 to 9989: 39 values a bin
        self.assertEqual((histogram["lower"], histogram["below"]), (8.5, 9))
        self.assertEqual(set(histogram["counts"]), {39})
        self.assertEqual(sum(histogram["counts"]) + histogram["below"] + histogram["above"], 10000)

    def test_thresholds_are_those_of_auto(self):
        write_nifti(self.path("in.nii"), from_function(
            20, "h", lambda x, y, z: 0 if x < -5 else 100 if x < 3 else 1000))
        otsu = self.info("in.nii")["values"]["otsu"]
        self.assertEqual(otsu[1:], [[50, 550]])  # three values: no third threshold
        surface = self.report("in.nii", "--iso", "auto", "-o", "a.ply")["surfaces"][0]
        self.assertEqual(otsu[0], [surface["isovalue"]])
        self.assertRegex(self.mesh("in.nii", "--info").stdout, "3 classes: 50, 550")

    def test_ends_with_commands_that_make_surfaces_of_this_input(self):
        image = from_function(20, "h", lambda x, y, z: 0 if x < -5 else 100 if x < 3 else 1000)
        for name, options in (("its name.nii", ()), ("-x.nii", ("--smooth", "1", "--crop", ":,2:18,:"))):
            write_nifti(self.path(name), image)
            text = self.mesh(*options, "--info", "--", name).stdout
            commands = text.partition("\nnext        ")[2].splitlines()
            self.assertEqual(len(commands), 2)
            for command in commands:
                words = shlex.split(command)
                self.assertEqual([word for word in words if word.startswith(("--smooth", "--crop"))],
                                 ["--crop=:,2:18,:", "--smooth=1"] if options else [])
                self.mesh(*words[1:])
        self.assertTrue(self.path("its name-iso50.vtp").exists())

    def test_the_commands_name_the_input_as_it_was_typed(self):
        self.path("scans of today").mkdir()
        name = "scans of today/in.nii"
        write_nifti(self.path(name), from_function(20, "h", lambda x, y, z: 0 if x < -5 else 100 if x < 3 else 1000))
        for typed in (name, str(self.path(name))):
            text = self.mesh("--info", "--report", "page.html", typed).stdout
            *commands, end = text.partition("\nnext        ")[2].splitlines()
            self.assertEqual([shlex.split(command)[-1] for command in commands], [typed] * 2)
            self.assertEqual(end, "Wrote page.html; next: open page.html in a browser")
            self.mesh(*shlex.split(commands[0])[1:])
            self.assertNotIn("scans of today", self.path("page.html").read_text())

    def test_ends_with_a_command_for_a_mask_and_for_a_label_map(self):
        for name, label in (("mask.nii", 1), ("-map.nii", 7)):
            write_nifti(self.path(name), from_function(
                20, "B", lambda x, y, z: label if x < -5 else 1 if x < 3 else 0))
        mask, labels = (self.mesh("--info", "--", name).stdout.partition("\nnext        ")[2].splitlines()
                        for name in ("mask.nii", "-map.nii"))
        self.assertEqual((mask, labels), (["adaptiso-mesh --iso auto mask.nii"], ["adaptiso-labels -- -map.nii"]))
        self.mesh(*shlex.split(mask[0])[1:])

    def test_the_histogram_has_a_row_for_each_value_of_a_mask(self):
        write_nifti(self.path("in.nii"), from_function(
            10, "B", lambda x, y, z: 1 if x < -3 else 0))  # 2 of 10 columns
        text = self.mesh("in.nii", "--info").stdout
        rows = re.findall(r"^ +(\S+)  +([\d,]+)  #+$", text, re.MULTILINE)
        self.assertEqual(rows, [("0", "800"), ("1", "200")])

    def test_values_that_are_not_finite_are_left_aside(self):
        write_nifti(self.path("in.nii"), from_function(
            10, "f", lambda x, y, z: math.nan if x < -4 else math.inf if x > 4 else y))
        told = self.info("in.nii")["values"]
        self.assertEqual((told["finite"], told["notFinite"]), (800, 200))
        self.assertEqual((told["minimum"], told["maximum"]), (-4.5, 4.5))
        self.assertIn("200 voxels (NaN or infinity)", self.mesh("in.nii", "--info").stdout)

    def test_what_has_no_surface_is_told(self):
        write_nifti(self.path("flat.nii"), Image((3, 3, 3), "h", [7] * 27))
        write_nifti(self.path("nan.nii"), Image((3, 3, 3), "f", [math.nan] * 27))
        self.assertRegex(self.info("flat.nii")["refusals"][0], "all voxels hold 7")
        self.assertRegex(self.info("nan.nii")["refusals"][0], "no voxel holds a finite number")
        self.assertRegex(self.mesh("flat.nii", "--info").stdout, "refused +any isovalue: all")
        self.assertIsNone(self.info("flat.nii")["values"]["histogram"])
        self.assertEqual(self.info("nan.nii")["values"]["percentiles"], [])

    def test_the_image_is_told_as_preprocessed(self):
        write_nifti(self.path("in.nii"), ball(24, 8, spacing=(1, 1, 2)))
        told = self.info("in.nii", "--crop", "2:22,:,1:", "--resample", "1")
        self.assertEqual(told["preprocessing"]["crop"], [[2, 22], [0, 24], [1, 24]])
        self.assertEqual(told["image"]["sizeVoxels"], [20, 24, 45])
        self.assertEqual(told["image"]["pixelType"], "float32")
        text = self.mesh("in.nii", "--info", "--resample", "1").stdout
        self.assertIn("after       resample 1 mm (linear)", text)

    def test_it_writes_nothing_but_the_report(self):
        write_nifti(self.path("in.nii"), ball())
        self.mesh("in.nii", "--info")
        self.assertEqual(self.mesh("in.nii", "--info", "--quiet").stdout, "")
        self.assertEqual(self.names(), ["in.nii"])
        self.mesh("in.nii", "--info", "--quiet", "--json", "out.json")
        self.assertEqual(json.loads(self.path("out.json").read_text()), self.info("in.nii"))

    def test_a_files_name_does_not_talk_to_the_terminal(self):
        write_nifti(self.path("a\x1b[31m.nii"), ball())
        self.assertTrue(self.mesh("a\x1b[31m.nii", "--info").stdout.startswith("a [31m.nii: NIfTI"))

    def test_keys_are_the_documented_ones(self):
        readme = (SOURCE / "Applications" / "adaptiso-mesh" / "README.md").read_text()
        section = readme.split("## What is reported of an image")[1].split("## ")[0]
        documented = {key for row in re.findall(r"^\| (`.*?`) \|", section, re.MULTILINE)
                      for key in re.findall(r"`([^`]+)`", row)}
        Sphere().write(self.path("ct"), range(10, 71, 2))
        told = self.info("ct", "--show-phi", "--crop", ":,:,:")
        keys = set()
        for key, value in told.items():
            inner = isinstance(value, dict) and key != "series"
            keys |= {f"{key}.{k}" for k in value} if inner else {key}
        self.assertEqual(keys, documented - {"preprocessing"})

    def test_it_makes_no_surface(self):
        write_nifti(self.path("in.nii"), ball())
        for option in (["--iso", "100"], ["-o", "a.ply"], ["--list-series"]):
            with self.subTest(option):
                self.assert_fails(USAGE, "--info", "in.nii", "--info", *option)


class Page(ApplicationTest):
    def tables(self, *arguments):
        """The rows of both tables: isovalues and bounds."""
        self.mesh(*arguments[:-1], "--info", "--report", "p.html", "--quiet", "--", arguments[-1])
        text = self.path("p.html").read_text()
        tables = re.findall(r"<tbody>\n(.*?)</tbody>", text, re.DOTALL)
        return [[[html.unescape(cell) for cell in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row)]
                 for row in re.findall(r"<tr>(.*?)</tr>", table)] for table in tables]

    def info_otsu(self, name, *options):
        return json.loads(self.mesh(*options, "--info", "--json", "-", "--", name).stdout)["values"]["otsu"]

    def test_isovalues_come_with_commands_that_make_their_surfaces(self):
        image = from_function(20, "h", lambda x, y, z: 0 if x < -5 else 100 if x < 3 else 1000)
        for name, options in (("its name.nii", ()), ("-x.nii", ("--smooth", "1", "--crop", ":,2:18,:"))):
            write_nifti(self.path(name), image)
            otsu = self.info_otsu(name, *options)
            rows, _ = self.tables(*options, "--pictures", "pics/", name)
            self.assertTrue(self.path("pics/histogram.png").exists())
            self.assertEqual(rows[0][0], f"{otsu[0][0]:g}")
            self.assertGreater(len(rows), 1)
            for value, _, triangles, command in rows:
                words = shlex.split(command)
                self.assertFalse([w for w in words if w.startswith(("--info", "--report", "--pictures"))])
                made = self.mesh("--method", "mc", "-o", "a.ply", "--json", "-", *words[1:])
                surface = json.loads(made.stdout)["surfaces"][0]
                self.assertEqual(f"{surface['isovalue']:g}", value)
                self.assertEqual(f"{surface['triangles']:,}", triangles)
                self.mesh(*words[1:])

    def test_estimates_of_triangles_are_near_what_bounds_give(self):
        # over 100,000 triangles at full resolution: the estimate is from some of the slices
        write_nifti(self.path("in.nii"), from_function(124, "h", lambda x, y, z: round(
            100 + 10 * (53 + 2 * (math.sin(x / 3) + math.sin(y / 4) + math.sin(z / 5))
                        - math.sqrt(x * x + y * y + z * z)))))
        isovalues, bounds = self.tables("in.nii")
        value = isovalues[0][0]
        self.assertGreater(int(bounds[0][1].replace(",", "")), 100_000)
        for bound, triangles, megabytes in bounds[1:]:
            estimate = int(triangles.replace(",", ""))
            surface = self.report("in.nii", "--iso", value, "--largest", "--fill-cavities",
                                  "--max-error", bound.split()[0], "-o", "a.stl")["surfaces"][0]
            self.assertLess(max(estimate / surface["triangles"], surface["triangles"] / estimate), 1.5, bound)
            size = self.path("a.stl").stat().st_size
            self.assertAlmostEqual(float(megabytes), size / 1e6, delta=0.5 * size / 1e6 + 0.1)

    def test_nothing_identifies_the_patient(self):
        Sphere().write(self.path("ct"), range(10, 71, 2))
        self.tables("--show-phi", "ct")
        text = re.sub(r"<script.*?</script>|base64,[^\"]*", "", self.path("p.html").read_text(),
                      flags=re.DOTALL)
        self.assertIn("Isovalues of ct", text)
        for secret in SECRETS:
            self.assertNotIn(secret, text)

    def test_there_is_no_page_of_an_image_without_surfaces(self):
        write_nifti(self.path("flat.nii"), Image((3, 3, 3), "h", [7] * 27))
        write_nifti(self.path("nan.nii"), Image((3, 3, 3), "f", [math.nan] * 27))
        self.path("short.nii").write_bytes(self.path("flat.nii").read_bytes()[:-9])
        write_nifti(self.path("in.nii"), ball())
        for name, code, page, pattern in (
                ("flat.nii", CHECK_FAILED, "p.html", "flat.nii was read; the report failed: its values"),
                ("nan.nii", CHECK_FAILED, "p.html", "no isovalue to choose"),
                ("short.nii", BAD_INPUT, "p.html", "short.nii"),
                ("in.nii", BAD_INPUT, "missing/p.html", "missing"),
                ("in.nii", BAD_INPUT, "in.nii", "never overwritten")):
            with self.subTest(name, page=page):
                self.assert_fails(code, pattern, name, "--info", "--quiet",
                                  "--report", page, "--pictures", "pics")
                self.assertEqual(self.names(), ["flat.nii", "in.nii", "nan.nii", "short.nii"])

    def test_thin_images_have_a_page_too(self):
        for size in ((9, 9, 2), (9, 2, 9)):
            write_nifti(self.path("in.nii"), Image(size, "h", [
                100 * (n % 9 > 4) for n in range(math.prod(size))]))
            self.assertEqual(self.tables("in.nii")[0][0][0], "50")


class Refused(ApplicationTest):
    def test_one_line_and_the_exit_code_as_in_reading(self):
        write_nifti(self.path("in.nii"), ball())
        whole = self.path("in.nii").read_bytes()
        self.path("short.nii").write_bytes(whole[:-100])
        self.path("empty.nii").write_bytes(b"")
        for name in ("short.nii", "empty.nii", "missing.nii"):
            with self.subTest(name):
                line = self.assert_fails(BAD_INPUT, name, name, "--info").stderr
                self.assertEqual(line, self.run_mesh(name, "--iso", "100").stderr)

    def test_the_report_says_why(self):
        self.path("folder").mkdir()
        self.path("folder/short.nii").write_bytes(b"\x5c\x01\0\0" + bytes(300))
        done = self.run_mesh("folder/short.nii", "--info", "--json", "-")
        self.assertEqual(done.returncode, BAD_INPUT)
        told = json.loads(done.stdout)
        self.assertFalse(told["input"]["readable"])
        self.assertEqual(done.stderr, f"adaptiso-mesh: folder/short.nii: {told['input']['fault']}\n")
        self.assertIsNone(told["image"])
        self.assertIsNone(told["values"])
        again = self.run_mesh("folder/short.nii", "--info", "--json", "why.json")
        self.assertEqual(again.returncode, BAD_INPUT)
        self.assertEqual(again.stdout, "")
        self.assertEqual(json.loads(self.path("why.json").read_text()), told)

    def test_so_are_steps_that_can_not_be_done(self):
        write_nifti(self.path("in.nii"), ball())
        done = self.run_mesh("in.nii", "--info", "--crop", ":,:,0:99", "--json", "-")
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertRegex(json.loads(done.stdout)["input"]["fault"], "0:99 along k")


class Dicom(ApplicationTest):
    def test_nothing_identifies_the_patient_unless_asked_for(self):
        Sphere().write(self.path("ct"), range(10, 71, 2), tilt_degrees=16)
        done = self.mesh("ct", "--info")
        self.assertRegex(done.stdout, r"tilted by 16\.00 degrees")
        report = self.mesh("ct", "--info", "--json", "-").stdout
        for secret in SECRETS:
            self.assertNotIn(secret, done.stdout + done.stderr + report)
        self.assertNotIn("series", json.loads(report))

    def test_series_uid_and_description_when_asked(self):
        Sphere().write(self.path("ct"), range(10, 71, 2), uid="1.2.3.2")
        Sphere().write(self.path("ct"), (0,), uid="1.2.3.3",
                       image_type="ORIGINAL\\PRIMARY\\LOCALIZER")
        text = self.mesh("ct", "--info", "--show-phi").stdout
        self.assertRegex(text, "UID 1.2.3.2, description 'Head first'")
        series = json.loads(self.mesh("ct", "--info", "--show-phi", "--json", "-").stdout)["series"]
        self.assertEqual((series["uid"], series["description"], series["modality"]),
                         ("1.2.3.2", "Head first", "CT"))


if __name__ == "__main__":
    main()
