"""--scale and --fit of adaptiso-mesh, -simplify and -mend: the file, what is reported of it, and what is refused."""

import json
import subprocess

from support import BAD_INPUT, BIN, OK, USAGE, ApplicationTest, from_function, main, write_nifti


def two_balls(x, y, z):
    """Of radius 8 and 2, 24 mm across together."""
    return max(8 - (x * x + y * y + z * z) ** 0.5, 2 - ((x - 14) ** 2 + y * y + z * z) ** 0.5)


class Scale(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("in.nii"), from_function(36, "f", two_balls))
        self.assertEqual(self.call("mesh", "in.nii", "--iso", 0, "--largest", "-o", "in.ply").returncode, OK)
        self.inputs = {"mesh": ("in.nii", "--iso", 0, "--largest", "--max-error", 0.3),
                       "simplify": ("in.ply", "--max-error", 0.3),
                       "mend": ("torn.off", "--max-hole", 9, "--max-error", 0.3)}
        self.assertEqual(self.call("simplify", "in.ply", "--max-error", 0.1, "-o", "torn.off").returncode, OK)
        text = self.path("torn.off").read_text().splitlines()
        counts = next(n for n, line in enumerate(text) if len(line.split()) == 3 and line[0].isdigit())
        points, triangles, _ = text[counts].split()
        text[counts] = f"{points} {int(triangles) - 1} 0"
        self.path("torn.off").write_text("\n".join(text[:-1]) + "\n")

    def call(self, program, *arguments):
        return subprocess.run([BIN / f"adaptiso-{program}", *map(str, arguments)], cwd=self.folder, text=True,
                              capture_output=True)

    def made(self, program, *options):
        """(points, entry of the surface, warnings)"""
        done = self.call(program, *self.inputs[program], "--json", "-", "--strict", "-o", "out.off", *options)
        self.assertEqual(done.returncode, OK, done.stderr)
        report = json.loads(done.stdout)
        entry = report["output"] if program != "mesh" else report["surfaces"][0]
        self.text = self.path("out.off").read_text()
        rows = [line.split() for line in self.text.splitlines() if line[0] in "-0123456789"][1:]
        return [tuple(map(float, row)) for row in rows if row[0] != "3"], entry, report["warnings"]

    def test_scales_the_file_and_what_is_reported_of_it(self):
        for program in self.inputs:
            with self.subTest(program):
                points, plain, _ = self.made(program)
                self.assertIn("CoordinateFrame", self.text)
                halves, entry, warnings = self.made(program, "--scale", 0.5)
                self.assertNotIn("CoordinateFrame", self.text)
                self.assertEqual([each["code"] for each in warnings], ["surface-scaled"])
                self.assertIn("scaled by 0.5 about the origin", warnings[0]["text"])
                self.assertEqual(len(points), len(halves))
                for whole, half in zip(points, halves):
                    for a, b in zip(whole, half):  # nine digits
                        self.assertAlmostEqual(a / 2, b, delta=1e-7)
                output = entry["output"] if program == "mesh" else entry
                self.assertEqual((output["scale"], output["coordinates"]), (0.5, None))
                self.assertAlmostEqual(entry["areaMm2"] * 4 / plain["areaMm2"], 1, delta=1e-6)
                for key in ("errorBoundMm", "resultToInputMm", "inputToResultMm"):
                    if key in entry:  # the digits' rounding is another
                        self.assertAlmostEqual(2 * entry[key], plain[key], delta=1e-6)
                        self.assertGreater(entry[key], 0)
                if program == "mesh":
                    self.assertAlmostEqual(entry["volumeMm3"] * 8 / plain["volumeMm3"], 1, delta=1e-6)
                    self.assertAlmostEqual(entry["components"][0]["volumeMm3"], entry["volumeMm3"], 6)

    def test_fits_the_printer_s_bed(self):
        """16 mm across, as the small ball does not count."""
        for program in self.inputs:
            with self.subTest(program):
                arguments = (*self.inputs[program], "-o", "x.stl", "--fit", "20,12.5,20")
                self.path("x.stl").unlink(missing_ok=True)
                done = self.call(program, *arguments)
                self.assertEqual(done.returncode, BAD_INPUT)
                self.assertRegex(done.stderr, r": --fit 20,12.5,20: x.stl would be 1[56]\.\d+ x 1[56]\.\d+ x 1[56]\.\d+ "
                                              r"mm; --scale 0\.7\d+ fits, or --scale auto\n$")
                self.assertFalse(self.path("x.stl").exists())
                factor = float(done.stderr.split("--scale ")[1].split()[0])
                self.assertEqual(self.call(program, *arguments, "--scale", factor).returncode, OK)
                self.assertEqual(self.call(program, *arguments, "--scale", factor + 0.002).returncode, BAD_INPUT)
                points, entry, _ = self.made(program, "--fit", "20,12.5,20", "--scale", "auto")
                self.assertEqual((entry["output"] if program == "mesh" else entry)["scale"], factor)
                span = max(p[1] for p in points) - min(p[1] for p in points)
                self.assertTrue(12.4 < span <= 12.5, span)
                _, entry, warnings = self.made(program, "--fit", "20,20,20", "--scale", "auto")
                self.assertEqual(((entry["output"] if program == "mesh" else entry)["scale"], warnings), (1, []))

    def test_what_is_wrong_is_refused(self):
        for program in self.inputs:
            for options, words in ((("--scale", "0"), "--scale 0: must be a number from 0.001 to 1000, or auto"),
                                   (("--scale", "half"), "--scale half: must be"),
                                   (("--scale", "auto"), "--scale auto: needs --fit X,Y,Z"),
                                   (("--fit", "220"), "--fit 220: must be three lengths in mm above 0"),
                                   (("--fit", "1,2,0"), "--fit 1,2,0: must be"),
                                   (("--fit", "1", "2", "3"), "--fit: its numbers have commas"),
                                   (("--scale", "2", "-o", "x.pial"), "FreeSurfer's surfaces lie in an image")):
                with self.subTest((program, options)):
                    output = () if "-o" in options else ("-o", "x.stl")
                    done = self.call(program, *self.inputs[program], *output, *options)
                    self.assertEqual(done.returncode, USAGE)
                    self.assertIn(words, done.stderr)


if __name__ == "__main__":
    main()
