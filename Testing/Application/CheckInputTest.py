"""adaptiso-check: broken meshes in every format, frames, and refusals."""

import json
import math
import struct
import subprocess

from support import BAD_INPUT, BIN, USAGE, Image, ball, lines, main, write_nifti
from checkSupport import NAMES, CheckTest, write_ply, write_stl, write_surf
from headDefects import NAN, add_repeated_index, flipped, good, icosphere, moved, soup, write_off


class Input(CheckTest):
    def test_broken_meshes_are_read_from_every_kind_of_file(self):
        nan = moved(icosphere(80), 7, (NAN, 1, 2))
        for write, name in ((write_off, "a.off"), (write_ply, "a.ply"), (write_stl, "a.stl"),
                            (write_surf, "a.surf")):
            write(self.path(name), nan)
            with self.subTest(name):
                said = self.check(name)["surfaces"][0]
                self.assertEqual(said["failed"], ["finiteCoordinates"])
        points, triangles = icosphere(80)
        for write, name in ((write_off, "b.off"), (write_ply, "b.ply"), (write_surf, "b.surf")):
            write(self.path(name), (points, triangles + [(0, 1, 5000), (0, 1, -1)]))
            with self.subTest(name):
                said = self.check(name)["surfaces"][0]
                self.assertEqual(said["failed"], ["indicesInRange"])
                self.assertEqual(said["defects"]["indexOutOfRange"], 2)
                self.assertEqual(said["selfIntersections"]["pairCount"], 0)

    def test_every_check_survives_every_defect_at_once(self):
        points, triangles = soup(add_repeated_index(icosphere(80, 2)))
        points = points[:-1] + [(NAN, NAN, NAN), (math.inf, 0, 0), (1e300, 1e300, 1e300)]
        triangles = triangles + [(0, 1, 10**12), (-1, -1, -1), (3, 3, 3)]
        triangles.append((len(points) - 1, len(points) - 2, 4))
        self.write("a.off", (points, triangles))
        self.write("b.off", icosphere(86))
        write_nifti(self.path("ball.nii"), ball(24, 8))
        report = self.check("--nested", "a.off", "b.off", "--volume", "ball.nii", "--iso", "100")
        self.assertFalse(report["passed"])
        self.write("nothing.off", ([(NAN, 0, 0), (0, 0, 0)], [(0, 0, 1)]))
        report = self.check("--nested", "nothing.off", "b.off", "--volume", "ball.nii", "--iso",
                            "100")
        self.assertEqual(report["nesting"]["pairs"][0]["relation"], "unknown")

    def test_stl_soup_is_welded(self):
        write_stl(self.path("a.stl"), soup(icosphere(80)))
        self.assertEqual(self.check("a.stl")["surfaces"][0]["vertices"], 642)

    def test_counts_of_triangles_are_held_against_the_file(self):
        write_stl(self.path("a.stl"), icosphere(80))
        stl = self.path("a.stl").read_bytes()
        count = struct.unpack_from("<I", stl, 80)[0]

        def counting(name, number, behind=b""):
            self.path(name).write_bytes(stl[:80] + struct.pack("<I", number) + stl[84:] + behind)

        for program, more in (("adaptiso-check", ()), ("adaptiso-compare", ("a.stl",)),
                              ("adaptiso-simplify", ("--max-error", "1", "-o", "out.stl"))):
            counting("joined.stl", count, stl)
            counting("half.stl", count // 2)
            for name, what in (("joined.stl", "another surface"),
                               ("half.stl", f"{count - count // 2} more behind the {count // 2} triangles")):
                done = subprocess.run([BIN / program, name, *more], cwd=self.folder, text=True,
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
                self.assertRegex(done.stderr, f"{name}: .*{what}.*are two files joined")
                self.assertFalse(self.path("out.stl").exists())
        for number in (0, 0xFFFFFFFF):
            counting("unset.stl", number)
            report = self.check("unset.stl")
            self.assertTrue(report["passed"])
            self.assertEqual(report["surfaces"][0]["triangles"], count)
            self.assertEqual([w["code"] for w in report["warnings"]], ["count-unset"])
            self.assertEqual(report["warnings"][0]["file"], "unset.stl")
        counting("zeros.stl", count, bytes(100))
        self.assertEqual([w["code"] for w in self.check("zeros.stl")["warnings"]],
                         ["trailing-bytes"])

    def test_one_bad_file_does_not_stop_the_others(self):
        self.write("good.off", icosphere(80))
        self.write("flipped.off", flipped(icosphere(80)))
        self.path("cut.off").write_text("OFF\n3 1 0\n0 0 0\n")
        self.path("what.xyz").write_text("0 0 0\n")
        done = self.run_check("cut.off", "good.off", "missing.off", "what.xyz", "flipped.off",
                              "--json", "report.json")
        self.assertEqual(done.returncode, BAD_INPUT)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 3, done.stderr)
        for line, pattern in zip(lines, ("cut.off: ", "missing.off: no such file", "what.xyz")):
            self.assertRegex(line, "^adaptiso-check: .*" + pattern)
        self.assertIn("cut.off: NOT READ\n", done.stdout)
        self.assertIn("next: --report check.html shows where; "
                      "adaptiso-mend flipped.off -o mended-flipped.off\n", done.stdout)
        # of what was not read a page shows nothing
        self.assertNotIn("--report", self.run_check("cut.off", "missing.off").stdout)
        report = json.loads(self.path("report.json").read_text())
        self.assertEqual([s["passed"] for s in report["surfaces"]],
                         [False, True, False, False, False])
        self.assertEqual([s["error"] is None for s in report["surfaces"]],
                         [False, True, False, False, True])

    def test_unread_surface_leaves_the_other_pairs(self):
        self.write_model(good())
        self.path(NAMES[0]).write_text("no")
        report = self.check("--nested", *NAMES, code=BAD_INPUT)
        self.assertEqual([(p["inner"], p["outer"]) for p in report["nesting"]["pairs"]],
                         [("middle.off", "outer.off")])

    def test_frames_are_brought_together(self):
        inner = icosphere(80, centre=(10, 20, 30))
        lps = [(-x, -y, z) for x, y, z in inner[0]], inner[1]
        self.write("inner.off", lps, "LPS mm")
        self.write("outer.off", icosphere(86, centre=(10, 20, 30)))
        report = self.check("--nested", "inner.off", "outer.off")
        self.assertTrue(report["passed"])
        self.assertEqual(report["surfaces"][0]["pointsIn"], "lps")
        self.assertEqual(report["nesting"]["pointsIn"], "ras")
        point = report["nesting"]["pairs"][0]["gap"]["innerPointMm"]
        self.assertAlmostEqual(math.dist(point, (10, 20, 30)), 80, delta=1)  # 1: facets' depth
        self.write("inner.off", inner, None)
        self.refused(BAD_INPUT, "inner.off does not say its coordinate frame, and outer.off is in "
                     "RAS mm.*--input-coordinates FRAME --input-coordinates ras", "--nested",
                     "inner.off", "outer.off")
        report = self.check("--nested", "inner.off", "outer.off", "--input-coordinates", "ras")
        self.assertTrue(report["passed"])
        self.assertEqual(report["options"]["inputCoordinates"], ["ras"])
        self.write("bare.off", icosphere(86, centre=(10, 20, 30)), None)
        report = self.check("--nested", "inner.off", "bare.off")
        self.assertTrue(report["passed"])
        self.assertIsNone(report["nesting"]["pointsIn"])
        self.assertEqual({note["pointsIn"] for note in report["plausibility"]}, {None})
        self.write("inner.off", inner, "tkRAS mm")
        self.refused(BAD_INPUT, "inner.off is in tkRAS mm and outer.off is in RAS mm.*--volume",
                     "--nested", "inner.off", "outer.off")

    def test_a_surface_without_a_frame_does_not_meet_an_image(self):
        """As 3D Slicer and others write a sphere of 8 mm at (2, -6, 9) in RAS."""
        write_nifti(self.path("ball.nii"), ball(24, 8, (1, 1, 1), (-9.5, -17.5, -2.5)))
        self.write("bare.off", icosphere(8, centre=(2, -6, 9)), None)
        done = self.run_check("bare.off", "--volume", "ball.nii", "--iso", "100")
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertRegex(done.stderr, "bare.off: does not say its coordinate frame, so where it lies "
                         "in the image is not known; state it by --input-coordinates ras, lps")
        self.write("slicer.off", icosphere(8, centre=(-2, 6, 9)), "sideways SPACE=LPS")
        for name, stated in (("bare.off", ("--input-coordinates", "ras")), ("slicer.off", ())):
            with self.subTest(name):
                report = self.check(name, "--volume", "ball.nii", "--iso", "100", *stated)
                # facets lie below the sphere by 0.3 mm at most, samples of 1 mm by as much
                self.assertLess(report["surfaces"][0]["isosurface"]["meanMm"], 0.5)
        lps = self.check("bare.off", "--volume", "ball.nii", "--iso", "100", "--input-coordinates",
                         "lps")
        self.assertGreater(lps["surfaces"][0]["isosurface"]["maxMm"], 5)
        self.refused(USAGE, "--input-coordinates: is given 2 times for 1 surface; give it once",
                     "bare.off", *["--input-coordinates", "ras"] * 2)

    def test_voxel_indices_need_the_image(self):
        write_nifti(self.path("ball.nii"), ball(24, 8, (2, 3, 4)))
        self.mesh("ball.nii", "--iso", "100", "--coordinates", "voxel", "--method", "mc", "--quiet",
                  "-o", "v.vtp")
        done = self.run_check("v.vtp")
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertRegex(done.stderr, "v.vtp is in voxel indices.*--volume")
        said = self.check("v.vtp", "--volume", "ball.nii")["surfaces"][0]
        self.assertEqual((said["passed"], said["pointsIn"]), (True, "ras"))
        for extent, spacing in zip(said["size"]["extentMm"], (2, 3, 4)):
            self.assertAlmostEqual(extent, 16 * spacing, delta=spacing / 5)  # whole samples: 0.1 a side


class Refusals(CheckTest):
    def setUp(self):
        super().setUp()
        self.write("a.off", icosphere(80))
        write_nifti(self.path("i.nii"), Image((4, 4, 4), "B", bytes(64)))

    def test_wrong_usage(self):
        for pattern, *arguments in (
                ("FILE", ),
                ("--nested: needs at least two", "--nested", "a.off"),
                ("--profile", "a.off", "--profile", "cake"),
                ("--min-gap: needs --nested", "a.off", "--min-gap", "1"),
                ("--min-gap x: must be", "--nested", "a.off", "a.off", "--min-gap", "x"),
                ("--min-angle -1: must be", "a.off", "--min-angle=-1"),
                ("--iso: needs --volume", "a.off", "--iso", "1"),
                ("--iso nan: must be", "a.off", "--volume", "i.nii", "--iso", "nan"),
                ("--resample: need --iso", "a.off", "--volume", "i.nii", "--smooth", "1"),
                ("--max-off: needs --iso", "a.off", "--volume", "i.nii", "--max-off", "1"),
                ("--max-pairs", "a.off", "--max-pairs", "-1"),
                ("frobnicate", "a.off", "--frobnicate")):
            with self.subTest(arguments):
                self.refused(USAGE, pattern, *arguments)

    def test_bad_input(self):
        for pattern, *arguments in (
                ("missing.nii", "a.off", "--volume", "missing.nii"),
                ("--iso 7: i.nii: there is no surface", "a.off", "--volume", "i.nii", "--iso", "7"),
                ("a.off", "a.off", "--json", "a.off"),
                ("no/r.json", "a.off", "--json", "no/r.json")):
            with self.subTest(arguments):
                self.refused(BAD_INPUT, pattern, *arguments)


if __name__ == "__main__":
    main()
