"""adaptiso-compare: frames, formats and refusals."""

from support import BAD_INPUT, OK, USAGE, ball, lines, main, write_nifti
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

    def test_unknown_is_taken_for_the_other_with_a_warning(self):
        self.write("bare.off", sphere(10, 24, (3, 5, 7)), None)
        self.assert_same("ras.off", "bare.off", warnings=["bare.off: does not say .*RAS mm"])
        self.assert_same("bare.off", "ras.off", warnings=["bare.off: does not say .*RAS mm"])
        report = self.assert_same("bare.off", "bare.off", warnings=["bare.off and bare.off don't say"])
        self.assertIsNone(report["a"]["coordinates"])

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
        self.assert_same("ras.vtp", "a.tri", warnings=["a.tri: does not say"])
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
