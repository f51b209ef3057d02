"""Outputs: names, formats, frames, what goes to stdout, and the same bytes for every number of
threads."""

import json
import math
import os
import re
import struct
import subprocess

from support import BAD_INPUT, MESH, OK, ApplicationTest, ball, main, noise, onion, write_nifti

FORMATS = (".vtp", ".vtk", ".ply", ".stl", ".obj", ".off", ".gii", ".surf", ".pial", ".white",
           ".tri", ".glb", ".3mf")


def stl_points(path):
    """The corners of a binary STL, three a triangle."""
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    return [struct.unpack_from("<3f", data, 84 + 50 * t + 12 + 12 * corner)
            for t in range(count) for corner in range(3)]


def off_points(path):
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    count = int(lines[1].split()[0])
    return [tuple(map(float, line.split())) for line in lines[2:2 + count]]


class Digits(ApplicationTest):
    """Bounds are of the files: their digits are part of them."""

    def surface(self, name, *arguments):
        done = self.run_mesh("far.nii", "--iso", 100, *arguments, "-o", name, "--json", "report.json")
        self.assertEqual(done.returncode, OK, done.stderr)
        report = json.loads(self.path("report.json").read_text())
        return done, report, report["surfaces"][0]

    def test_rounding_beyond_the_bound_is_refused(self):
        # at 4e6 mm single precision has steps of a quarter of a millimetre
        write_nifti(self.path("far.nii"), ball(origin=(4e6, 4e6, 0)))
        for name in ("far.stl", "far.gii"):
            self.assert_fails(BAD_INPUT, f"{name}: .* keeps 24 bits of a coordinate: points would "
                                         r"move by up to 0.\d+ mm, more than the bound of 0.05 mm",
                              "far.nii", "--iso", 100, "--max-error", 0.05, "-o", name)
            self.assert_fails(BAD_INPUT, "more than the bound of 0.15 mm", "far.nii", "--iso", 100,
                              "-o", name)

    def test_the_bound_has_the_rounding_in_it(self):
        # at 4e4 mm steps of 1/256 mm, nine digits of 1e-4 mm
        write_nifti(self.path("far.nii"), ball(origin=(4e4, -3e4, 2e4)))
        _, _, exact = self.surface("exact.vtp", "--max-error", 0.1)
        self.assertEqual(exact["roundingMm"], 0)
        self.assertLessEqual(exact["errorBoundMm"], 0.1)
        done, report, surface = self.surface("far.stl", "--max-error", 0.1, "--verify")
        self.assertGreater(surface["roundingMm"], 1e-3)
        self.assertLess(surface["roundingMm"], 3 ** 0.5 / 512)
        self.assertAlmostEqual(surface["errorBoundMm"], exact["errorBoundMm"] + surface["roundingMm"],
                               places=12)
        self.assertLessEqual(surface["verifiedMaxMm"], surface["errorBoundMm"])
        told = float(re.search(r"no point farther than (\S+) mm", done.stdout)[1])
        self.assertGreaterEqual(told, surface["errorBoundMm"])
        self.assertLess(told, surface["errorBoundMm"] + 1e-4)
        self.assertEqual([(w["code"], w["file"]) for w in report["warnings"]],
                         [("bound-exceeded", "far.stl")])
        self.assertRegex(done.stderr, "far.stl: lies within 0.10\\d+ mm, not 0.1 mm: STL")
        done, _, _ = self.surface("far.stl", "--triangles", 300)
        self.assertEqual(done.stderr, "")  # nothing was asked of the distance
        done, _, surface = self.surface("far.obj", "--max-error", 0.1)
        self.assertEqual(done.stderr, "")  # less than a hundredth of the bound

    def test_the_rounding_is_that_of_the_file(self):
        write_nifti(self.path("far.nii"), ball(origin=(4e5, -3e5, 2e5)))
        _, _, surface = self.surface("far.off", "--max-error", 0.1)
        self.surface("exact.vtk", "--max-error", 0.1)
        points = struct.iter_unpack(">3d", self.vtk_points())
        moved = max(math.dist(p, q) for p, q in zip(points, off_points(self.path("far.off"))))
        self.assertAlmostEqual(surface["roundingMm"], moved, places=9)
        self.assertGreater(moved, 1e-4)

    def vtk_points(self):
        """Those of exact.vtk, big-endian doubles."""
        content = self.path("exact.vtk").read_bytes()
        at = content.index(b"POINTS ")
        end = content.index(b"\n", at)
        count, kind = content[at:end].split()[1:3]
        self.assertEqual(kind, b"double")
        return content[end + 1:end + 1 + 24 * int(count)]


class Names(ApplicationTest):
    def setUp(self):
        super().setUp()
        self.path("scans").mkdir()
        write_nifti(self.path("scans/ball.v2.nii"), ball(12, 4))

    def test_default_is_in_the_current_folder(self):
        done = self.mesh("scans/ball.v2.nii", "--iso", "100")
        self.assertEqual(self.names(), ["ball.v2-iso100.vtp", "scans"])
        self.assertIn("ball.v2-iso100.vtp", done.stdout)
        self.assertEqual(done.stderr, "")
        for folder in ("scans", "scans/"):
            self.mesh("scans/ball.v2.nii", "--iso", "100", "-o", folder)
            self.path("scans/ball.v2-iso100.vtp").unlink()
        self.assert_fails(BAD_INPUT, "new", "scans/ball.v2.nii", "--iso", "100", "-o", "new/")

    def test_isovalues_are_written_short(self):
        for text in ("100.50", "1e2", "+99", "101.0", "102.04567"):
            self.mesh("scans/ball.v2.nii", f"--iso={text}")
        names = ["ball.v2-iso100.5.vtp", "ball.v2-iso100.vtp", "ball.v2-iso101.vtp", "ball.v2-iso102.05.vtp",
                 "ball.v2-iso99.vtp", "scans"]
        self.assertEqual(self.names(), names)

    def test_isovalues_that_five_digits_do_not_tell_apart_are_written_whole(self):
        self.mesh("scans/ball.v2.nii", "--iso", "98.04567", "--iso", "98.046", "--iso", "99.04567", "-o", "a.ply")
        self.mesh("scans/ball.v2.nii", "--iso", "98.04567", "-o", "a-{isolabel}.ply")
        self.assertEqual(self.names(), ["a-98p04567.ply", "a-iso98.04567.ply", "a-iso98.046.ply",
                                        "a-iso99.046.ply", "scans"])

    def test_several_isovalues(self):
        self.mesh("scans/ball.v2.nii", "--iso", "90", "--iso", "100", "-o", "out.stl")
        self.mesh("scans/ball.v2.nii", "--iso", "90", "--iso", "100", "-o", "at{iso}mm.off")
        self.mesh("scans/ball.v2.nii", "--iso", "90", "--iso", "100", "-o", "lh.surf.gii")
        self.assertEqual(self.names(), ["at100mm.off", "at90mm.off", "lh-iso100.surf.gii",
                                        "lh-iso90.surf.gii", "out-iso100.stl", "out-iso90.stl",
                                        "scans"])

    def test_several_isovalues_give_what_each_gives_alone(self):
        self.mesh("scans/ball.v2.nii", "--iso", "110", "--iso", "100", "-o", "{iso}.ply")
        self.mesh("scans/ball.v2.nii", "--iso", "100", "-o", "alone.ply")
        self.assertEqual(self.path("100.ply").read_bytes(), self.path("alone.ply").read_bytes())
        self.assertNotEqual(self.path("110.ply").read_bytes(), self.path("alone.ply").read_bytes())

    def test_existing_file_is_replaced_through_a_link_too(self):
        self.path("real.ply").write_text("old")
        self.path("link.ply").symlink_to("real.ply")
        self.mesh("scans/ball.v2.nii", "--iso", "100", "-o", "link.ply")
        self.assertTrue(self.path("link.ply").is_symlink())
        self.assertTrue(self.path("real.ply").read_bytes().startswith(b"ply"))

    def test_new_files_get_the_rights_that_the_user_wants(self):
        self.mesh("scans/ball.v2.nii", "--iso", "100", "-o", "a.ply",
                  preexec_fn=lambda: os.umask(0o027))
        self.assertEqual(self.path("a.ply").stat().st_mode & 0o777, 0o640)


class BadOutput(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(12, 4))

    def refused(self, pattern, *arguments):
        self.assert_fails(BAD_INPUT, pattern, *arguments)

    def refused_to_a_user(self, pattern, *arguments):
        """As refused(), but not as root, who may write everywhere."""
        if os.geteuid() != 0:
            return self.refused(pattern, *arguments)
        self.folder.chmod(0o777)
        nobody = {"user": 65534, "group": 65534, "extra_groups": []}
        try:
            self.assert_fails(BAD_INPUT, pattern, *arguments, **nobody)
        except PermissionError:
            self.skipTest("the program lies where root alone may go")

    def test_missing_folder_is_told_before_the_input_is_read(self):
        self.refused("there is no folder nowhere", "missing.nii", "--iso", "100", "-o",
                     "nowhere/a.ply")
        self.refused("there is no folder nowhere", "missing.nii", "--iso", "100", "--json",
                     "nowhere/a.json")

    def test_write_protected_folder(self):
        self.path("locked").mkdir(mode=0o555)
        self.refused_to_a_user("folder can't be written", "missing.nii", "--iso", "100", "-o",
                     "locked/a.ply")

    def test_write_protected_file(self):
        self.path("a.ply").write_text("precious")
        self.path("a.ply").chmod(0o444)
        self.refused_to_a_user("write-protected", "missing.nii", "--iso", "100", "-o", "a.ply")

    def test_names_that_are_no_regular_file(self):
        self.path("folder.ply").mkdir()
        os.mkfifo(self.path("pipe.ply"))
        for name in ("folder.ply", "pipe.ply"):
            with self.subTest(name):
                done = self.run_mesh("ball.nii", "--iso", "100", "-o", name)
                self.assertEqual(done.returncode, BAD_INPUT)
                self.assertIn("not a regular file", done.stderr)

    def test_input_is_never_overwritten(self):
        # a legacy VTK file can be image and mesh; what it holds is not looked at
        self.path("image.vtk").write_text("# vtk DataFile Version 3.0\n")
        self.path("link.vtk").symlink_to("image.vtk")
        for name in ("image.vtk", "./image.vtk", "link.vtk"):
            with self.subTest(name):
                self.refused("is the input", "image.vtk", "--iso", "100", "-o", name)
        self.refused("is the input", "ball.nii", "--iso", "100", "--json", "ball.nii")

    def test_full_standard_output(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run([MESH, "ball.nii", "--iso", "100"], cwd=self.folder, stdout=full,
                                  stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertIn("standard output", done.stderr)
        self.assertEqual(self.names(), ["ball.nii"])  # as README.md says

    def test_reader_that_stops_early_leaves_no_file(self):
        subprocess.run(f"{MESH} ball.nii --iso 100 | true", cwd=self.folder, shell=True, check=True)
        self.assertEqual(self.names(), ["ball.nii"])


class Formats(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(16, 5, origin=(10, -20, 30)))

    def test_every_format_is_written(self):
        for extension in FORMATS:
            with self.subTest(extension):
                report = self.report("ball.nii", "--iso", "100", "-o", f"lh{extension}")
                size = self.path(f"lh{extension}").stat().st_size
                triangles = report["surfaces"][0]["triangles"]
                self.assertEqual(report["surfaces"][0]["output"]["bytes"], size)
                # no format takes less than an index of 4 bytes, or digit and space, a corner
                self.assertGreater(size, 6 * triangles)

    def test_a_format_with_too_few_digits_is_refused(self):
        # at 1e8 mm single precision has steps of 8 mm
        write_nifti(self.path("far.nii"), ball(16, 5, origin=(1e8, 1e8, 1e8)))
        for extension in (".stl", ".gii"):
            with self.subTest(extension):
                self.assert_fails(BAD_INPUT, "^adaptiso-mesh: far" + extension + ": .* keeps 24 "
                                  "bits of a coordinate: .* triangles would lose their area",
                                  "far.nii", "--iso", "100", "-o", f"far{extension}")
        for name in ("far.ply", "far.vtp", "far.surf"):  # tkRAS is measured from the middle
            self.mesh("far.nii", "--iso", "100", "-o", name)

    def test_the_help_lists_no_other_format(self):
        text = self.mesh("--help").stdout
        for extension in FORMATS:
            self.assertIn(extension, text)

    def test_files_hold_no_trace_of_input_user_or_folder(self):
        self.path("ball.nii").rename(self.path("Mustermann.nii"))
        for extension in FORMATS:
            with self.subTest(extension):
                self.mesh("Mustermann.nii", "--iso", "100", "-o", f"lh{extension}")
                data = self.path(f"lh{extension}").read_bytes()
                self.assertNotIn(b"Mustermann", data)
                self.assertNotIn(self.folder.name.encode(), data)

    def test_frames_are_where_the_ball_is(self):
        # voxel (i, j, k) is at RAS (10 + i, j - 20, 30 + k); the ball's middle is voxel 7.5
        # tkRAS: RAS less that of the image's middle, voxel (8, 8, 8), at (18, -12, 38)
        middles = {"ras": (17.5, -12.5, 37.5), "lps": (-17.5, 12.5, 37.5),
                   "tkras": (-0.5, -0.5, -0.5)}
        for frame, middle in middles.items():
            with self.subTest(frame):
                self.mesh("ball.nii", "--iso", "100", "-o", "a.stl", "--coordinates", frame,
                          "--method", "mc")
                points = stl_points(self.path("a.stl"))
                for axis in range(3):
                    values = [p[axis] for p in points]
                    # the image is symmetric, so the mesh's box is to rounding in float
                    self.assertAlmostEqual((min(values) + max(values)) / 2, middle[axis], 4)
                    self.assertAlmostEqual(max(values) - min(values), 10, delta=0.5)

    def test_default_frames(self):
        for extension, frame in ((".ply", "ras"), (".gii", "ras"), (".pial", "tkras")):
            report = self.report("ball.nii", "--iso", "100", "-o", f"lh{extension}")
            self.assertEqual(report["surfaces"][0]["output"]["coordinates"], frame)

    def test_triangles_are_outward_in_every_frame(self):
        for frame in ("ras", "lps", "tkras"):
            self.mesh("ball.nii", "--iso", "100", "-o", "a.stl", "--coordinates", frame,
                      "--method", "mc")
            points = stl_points(self.path("a.stl"))
            volume = 0
            for a, b, c in zip(points[0::3], points[1::3], points[2::3]):
                volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                           a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
            # chords of up to sqrt(3) mm lie 3 / (8 * 5) mm inside the sphere: 1.5 % of the radius
            self.assertAlmostEqual(volume / (4 / 3 * math.pi * 5 ** 3), 1, delta=0.045, msg=frame)


class Streams(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(12, 4))

    def test_quiet_prints_nothing(self):
        done = self.mesh("ball.nii", "--iso", "100", "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_json_on_stdout_takes_the_place_of_the_text(self):
        done = self.mesh("ball.nii", "--iso", "100", "--json", "-")
        self.assertTrue(done.stdout.startswith("{") and done.stdout.endswith("}\n"))

    def test_json_file_leaves_the_text(self):
        done = self.mesh("ball.nii", "--iso", "100", "--json", "report.json")
        self.assertIn("ball-iso100.vtp", done.stdout)
        self.assertTrue(self.path("report.json").read_text().startswith("{"))

    def test_a_log_has_steps_and_errors_with_their_times(self):
        self.mesh("ball.nii", "--iso", "100", "--quiet", "--log", "run.log")
        self.run_mesh("ball.nii", "--iso", "7000", "--log", "run.log")
        lines = self.path("run.log").read_text().splitlines()
        for line in lines:
            self.assertRegex(line, r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ \d+\.\d s  \S")
        texts = [line.split("  ", 1)[1] for line in lines]
        self.assertRegex(texts[0], r"^adaptiso-mesh \d")
        self.assertEqual(texts[1:4], ["read", "index", "extract"])
        end = texts.index("ended with exit code 0")
        self.assertRegex(texts[end + 1], "^adaptiso-mesh ")
        self.assertRegex(texts[-2], "^--iso 7000: no voxel reaches it")
        self.assertEqual(texts[-1], "ended with exit code 3")

    def test_progress_is_for_terminals_only(self):
        leader, follower = os.openpty()
        done = subprocess.run([MESH, "ball.nii", "--iso", "100"], cwd=self.folder, stderr=follower,
                              stdout=subprocess.PIPE)
        os.close(follower)
        shown = os.read(leader, 100000)
        os.close(leader)
        self.assertEqual(done.returncode, OK)
        self.assertRegex(shown, rb"read \.\.\., \d+ s\r")
        self.assertTrue(shown.endswith(b"\r\x1b[K"), shown)


class Threads(ApplicationTest):
    def test_same_bytes_for_every_number(self):
        write_nifti(self.path("noise.nii"), noise(24))
        write_nifti(self.path("onion.nii"), onion())
        for name, isovalue in (("noise", 200), ("onion", 0)):
            for threads in (1, 2, 7):
                self.mesh(f"{name}.nii", "--iso", isovalue, "--threads", threads, "-o",
                          f"{name}{threads}.ply")
            one = self.path(f"{name}1.ply").read_bytes()
            self.assertEqual(one, self.path(f"{name}2.ply").read_bytes())
            self.assertEqual(one, self.path(f"{name}7.ply").read_bytes())


if __name__ == "__main__":
    main()
