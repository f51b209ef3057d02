"""adaptiso-compare: frames, formats and refusals."""

import subprocess

from support import BAD_INPUT, BIN, OK, USAGE, ball, lines, main, write_nifti
from compareSupport import LPS, TKRAS, VOXEL, CompareTest, plane, sphere, to_lps


class Frames(CompareTest):
    def setUp(self):
        super().setUp()
        self.write("ras.off", sphere(10, 24, (3, 5, 7)))

    def assert_same(self, *arguments, warnings=()):
        report = self.compare(*arguments, "--samples", "2000")
        self.assertLess(report["distances"]["combined"]["maxMm"], 1e-5)  # .surf is float: 1e-6
        self.assertGreater(report["b"]["volumeMm3"], 0)
        self.assertEqual(len(report["warnings"]), len(warnings), report["warnings"])
        for warning, pattern in zip(lines(report["warnings"]), warnings):
            self.assertRegex(warning, pattern)
        return report

    def test_ras_and_lps_meet(self):
        self.write("lps.off", to_lps(sphere(10, 24, (3, 5, 7))), LPS)
        report = self.assert_same("ras.off", "lps.off")
        self.assertEqual((report["a"]["coordinates"], report["b"]["coordinates"],
                          report["coordinates"]), ("ras", "lps", "ras"))

    def test_unknown_is_not_compared_with_known(self):
        self.write("bare.off", sphere(10, 24, (3, 5, 7)), None)
        self.write("tk.off", sphere(10, 24, (3, 5, 7)), TKRAS)
        for names, pattern in (
                (("ras.off", "bare.off"), "bare.off does not say its coordinate frame, and ras.off "
                 "is in RAS mm; .*--input-coordinates ras --input-coordinates FRAME"),
                (("bare.off", "ras.off"), "--input-coordinates FRAME --input-coordinates ras"),
                (("tk.off", "bare.off"), "--input-coordinates tkras --input-coordinates FRAME")):
            self.refused(BAD_INPUT, pattern, *names)
        report = self.assert_same("ras.off", "bare.off", "--input-coordinates", "ras")
        self.assertEqual(report["options"]["inputCoordinates"], ["ras"])
        self.assertEqual(report["b"]["coordinates"], "ras")

    def test_unknown_of_one_format_share_a_frame(self):
        self.write("bare.off", sphere(10, 24, (3, 5, 7)), None)
        report = self.assert_same("bare.off", "bare.off", "--colored", "c.vtp",
                                  warnings=["bare.off and bare.off don't say"])
        self.assertIsNone(report["a"]["coordinates"])
        self.assertIsNone(report["coordinates"])
        self.assertNotIn(b"CoordinateFrame", self.path("c.vtp").read_bytes())
        self.assertNotIn(b"SPACE", self.path("c.vtp").read_bytes())
        for name in ("bare.stl", "bare.3mf"):
            subprocess.run([BIN / "adaptiso-simplify", "bare.off", "--max-error", "1e-6", "-o", name], cwd=self.folder, check=True,
                           capture_output=True)
        self.assert_same("bare.stl", "bare.3mf", warnings=["bare.stl and bare.3mf don't say"])
        self.path("bare.obj").write_text("v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n")
        self.refused(BAD_INPUT, "bare.off and bare.obj don't say .*different formats.*"
                     "--input-coordinates ras, lps, tkras or voxel", "bare.off", "bare.obj")
        write_nifti(self.path("ball.nii"), ball(20, 6, (1, 2, 3), (-40, 5, 11)))
        self.refused(BAD_INPUT, "so where it lies in the image is not known.*--input-coordinates",
                     "bare.off", "bare.off", "--volume", "ball.nii")

    def test_frame_is_stated_for_each(self):
        self.write("bare.off", to_lps(sphere(10, 24, (3, 5, 7))), None)
        report = self.assert_same("ras.off", "bare.off", "--input-coordinates", "ras",
                                  "--input-coordinates=lps")
        self.assertEqual(report["options"]["inputCoordinates"], ["ras", "lps"])
        self.assertEqual(report["b"]["coordinates"], "lps")
        # over what the file says: (3, 5, 7) and its image at (-3, -5, 7)
        report = self.compare("ras.off", "ras.off", "--input-coordinates", "ras",
                              "--input-coordinates", "lps")
        self.assertAlmostEqual(report["distances"]["combined"]["maxMm"], 34**0.5 * 2, delta=0.2)
        self.refused(USAGE, "--input-coordinates: is given 3 times for 2 surfaces", "ras.off",
                     "ras.off", *["--input-coordinates", "ras"] * 3)
        self.refused(USAGE, "--input-coordinates up: must be", "ras.off", "ras.off",
                     "--input-coordinates", "up")
        self.refused(BAD_INPUT, "voxel indices.*--volume", "ras.off", "ras.off",
                     "--input-coordinates", "voxel")

    def test_slicers_surfaces_lie_where_they_say(self):
        def obj(name, mesh, comment):
            points, triangles = mesh
            self.path(name).write_text(
                f"# {comment}\n" + "".join("v %.17g %.17g %.17g\n" % tuple(p) for p in points)
                + "".join("f %d %d %d\n" % tuple(v + 1 for v in t) for t in triangles))
        obj("lps.obj", to_lps(sphere(10, 24, (3, 5, 7))), "3D Slicer output. SPACE=LPS")
        obj("ras.obj", sphere(10, 24, (3, 5, 7)), "3D Slicer output. SPACE=RAS")
        for name, frame in (("lps.obj", "lps"), ("ras.obj", "ras")):
            self.assertEqual(self.assert_same("ras.off", name)["b"]["coordinates"], frame)
        obj("both.obj", sphere(10, 24, (3, 5, 7)), "CoordinateFrame: RAS mm SPACE=LPS")
        self.refused(BAD_INPUT, "both.obj: it says two coordinate frames.*--input-coordinates",
                     "ras.off", "both.obj")
        self.assert_same("ras.off", "both.obj", "--input-coordinates", "ras")

    def test_quiet_says_warnings_alone(self):
        self.write("bare.off", sphere(10, 24), None)
        done = self.run_compare("bare.off", "bare.off", "--quiet")
        self.assertEqual((done.returncode, done.stdout), (OK, ""))
        self.assertRegex(done.stderr, r"^adaptiso-compare: warning: [^\n]*\n$")

    def test_tkras_without_a_volume_meets_its_like_only(self):
        self.write("tk.off", sphere(10, 24), TKRAS)
        report = self.assert_same("tk.off", "tk.off", warnings=["taken for surfaces of one volume"])
        self.assertEqual(report["coordinates"], "tkras")
        self.refused(BAD_INPUT, r"tk.off is in tkRAS mm and ras.off is in RAS mm.*--volume",
                     "tk.off", "ras.off")

    def test_tkras_is_reported_and_coloured_in_tkras(self):
        self.write("tk.off", plane(0), TKRAS)
        points, triangles = plane(0)
        self.write("peak.off", ([points[0], points[1], (12, 10, 1), points[3]], triangles), TKRAS)
        report = self.compare("peak.off", "tk.off", "--colored", "out.vtp")
        self.assertEqual(report["distances"]["combined"]["maxPointMm"], [12, 10, 1])
        self.assertEqual(self.compare("out.vtp", "tk.off")["a"]["coordinates"], "tkras")
        self.assertLess(self.compare("out.vtp", "peak.off")["distances"]["combined"]["maxMm"],
                        1e-12)

    def test_voxel_indices_need_the_image(self):
        self.write("voxel.off", sphere(10, 24), VOXEL)
        self.refused(BAD_INPUT, "voxel.off is in voxel indices.*--volume", "voxel.off", "ras.off")
        self.refused(BAD_INPUT, "voxel.off is in voxel indices.*--volume", "voxel.off", "voxel.off")

    def test_every_frame_and_format_of_adaptiso_mesh(self):
        """One surface, written in all frames, is one surface again; of an image off the
        origin, its voxels 1 x 2 x 3 mm large."""
        write_nifti(self.path("ball.nii"), ball(20, 6, (1, 2, 3), (-40, 5, 11)))
        make = ("ball.nii", "--iso", "100", "--quiet")
        self.mesh(*make, "-o", "ras.vtp")
        for name in ("a.vtk", "a.ply", "a.stl", "a.obj", "a.off", "a.gii", "lh.pial"):
            self.mesh(*make, "-o", name)
            with self.subTest(name):
                self.assert_same("ras.vtp", name)
        self.mesh(*make, "-o", "a.tri")  # says no frame
        self.refused(BAD_INPUT, "a.tri does not say", "ras.vtp", "a.tri")
        self.assert_same("ras.vtp", "a.tri", "--input-coordinates", "ras")
        self.assert_same("lh.pial", "a.tri", "--input-coordinates", "tkras",
                         "--input-coordinates", "ras")
        for frame in ("lps", "tkras", "voxel"):
            self.mesh(*make, "--coordinates", frame, "-o", f"{frame}.vtp")
            with self.subTest(frame):
                self.assert_same("ras.vtp", f"{frame}.vtp", "--volume", "ball.nii")
        self.assert_same("lh.pial", "tkras.vtp", warnings=["taken for surfaces of one volume"])
        self.refused(BAD_INPUT, "--volume", "ras.vtp", "tkras.vtp")


class Refusals(CompareTest):
    def setUp(self):
        super().setUp()
        self.write("a.off", plane(0))

    def test_wrong_usage(self):
        for pattern, *arguments in (
                ("B", "a.off"),
                ("c.off", "a.off", "a.off", "c.off"),
                ("frobnicate", "a.off", "a.off", "--frobnicate"),
                ("--samples", "a.off", "a.off", "--samples", "0"),
                ("--samples", "a.off", "a.off", "--samples", "1.5"),
                ("--voxel 0: .*above 0", "a.off", "a.off", "--voxel", "0"),
                ("--max-mean nan: ", "a.off", "a.off", "--max-mean", "nan"),
                ("--max-hausdorff -1: .*0 or more", "a.off", "a.off", "--max-hausdorff=-1"),
                ("--voxel", "a.off", "a.off", "--voxel", "1", "--volume", "i.nii"),
                ("--volume-index.*--volume", "a.off", "a.off", "--volume-index", "0"),
                ("--one-sided", "a.off", "a.off", "--one-sided", "--symmetric"),
                (r"--colored out.ply: must be a .vtp", "a.off", "a.off", "--colored", "out.ply"),
                ("--json", "a.off", "a.off", "--colored", "o.vtp", "--json", "./o.vtp")):
            with self.subTest(arguments):
                self.refused(USAGE, pattern, *arguments)

    def test_bad_input(self):
        self.path("broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
        self.write("flat.off", ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]))
        self.path("a.vtp").write_text("in use")
        for pattern, *arguments in (
                ("missing.off: no such file", "missing.off", "a.off"),
                ("broken.off", "a.off", "broken.off"),
                ("flat.off: .*no area", "a.off", "flat.off"),
                ("missing.nii", "a.off", "a.off", "--volume", "missing.nii"),
                ("no/out.vtp", "a.off", "a.off", "--colored", "no/out.vtp"),
                ("a.off", "a.off", "a.off", "--json", "a.off"),
                ("a.vtp", "a.vtp", "a.off", "--colored", "a.vtp")):
            with self.subTest(arguments):
                self.refused(BAD_INPUT, pattern, *arguments)


if __name__ == "__main__":
    main()
