"""adaptiso-simplify: bounds, soundness, frames, refusals, batches and reports."""

import json
import math
import re
import struct

from support import BAD_INPUT, CHECK_FAILED, OK, USAGE, lines, main
from compareSupport import LPS, RAS, TKRAS, VOXEL
from headDefects import cube, icosphere
from simplifySupport import (SimplifyTest, border_points, documented_keys, keys_of, patch, ply,
                             read_pial, write_pial)

NAN = float("nan")
BALL = icosphere(10, 4)  # 5,120 triangles


class Bounds(SimplifyTest):
    def test_a_ball_within_a_bound(self):
        self.write("ball.off", BALL)
        report = self.simplify("ball.off", "--max-error", "0.1", "-o", "out.vtp")
        output = report["output"]
        self.assertTrue(report["input"]["sound"])
        self.assertLess(output["triangles"], 1500)
        self.assertLessEqual(output["errorBoundMm"], 0.1)
        self.assertLessEqual(output["verification"]["maxMm"], output["errorBoundMm"] + 1e-9)
        self.assertEqual((output["genus"], output["components"], output["closed"]), (0, 1, True))
        # by another program, and by another sampler: every vertex lies within the bound
        self.assertLessEqual(self.compare("out.vtp", "ball.off")["maxMm"], 0.1)
        checked = self.check("out.vtp")["surfaces"][0]
        self.assertTrue(checked["passed"], checked["failed"])

    def test_the_bound_is_confirmed_by_points_of_our_own(self):
        """The ball on paper: facets of the input lie at least r cos(a) out."""
        self.write("ball.off", BALL)
        self.simplify("ball.off", "--max-error", "0.2", "-o", "out.off")
        lines = [line for line in self.path("out.off").read_text().splitlines()
                 if line and not line.startswith("#")]
        points, triangles = map(int, lines[1].split()[:2])
        for line in lines[2:2 + points]:
            radius = math.sqrt(sum(float(x) ** 2 for x in line.split()))
            self.assertLess(abs(radius - 10), 0.2 + 0.02)
        self.assertEqual(len(lines), 2 + points + triangles)

    def test_a_bound_as_large_as_the_surface_is_a_warning(self):
        points, triangles = icosphere(0.1, 2)  # a head in metres
        self.write("metres.off", (points, triangles))
        report = self.simplify("metres.off", "--max-error", "0.2", "-o", "out.off")
        self.assertEqual([w["code"] for w in report["warnings"]], ["bound-over-size"])
        self.assertRegex(lines(report["warnings"])[0],
                         r"^metres.off: --max-error of 0.2 mm is more than a tenth of the surface's "
                         r"diagonal, 0\.3\d* mm; are its coordinates in mm\?$")
        report = self.simplify("metres.off", "--max-error", "0.03", "-o", "out.off")
        self.assertEqual(report["warnings"], [])

    def test_counts(self):
        self.write("ball.off", BALL)
        report = self.simplify("ball.off", "--triangles", "600", "-o", "a.vtp")
        self.assertLessEqual(report["output"]["triangles"], 600)
        self.assertGreater(report["output"]["triangles"], 500)
        self.assertEqual((report["output"]["wantedTriangles"], report["output"]["countMet"]),
                         (600, True))
        report = self.simplify("ball.off", "--reduction", "0.75", "-o", "b.vtp")
        self.assertEqual(report["output"]["wantedTriangles"], 1280)
        self.assertTrue(report["output"]["countMet"])

    def test_a_count_that_cannot_be_met_is_a_warning(self):
        self.write("cube.off", cube((0, 0, 0), (1, 1, 1)))
        report = self.simplify("cube.off", "--triangles", "2", "-o", "out.vtp")
        self.assertFalse(report["output"]["countMet"])
        self.assertRegex(lines(report["warnings"])[0], "^out.vtp: has .* triangles, not 2 as asked for")
        # with a bound as well, that may end it before: asked for
        report = self.simplify("cube.off", "--triangles", "2", "--max-error", "0.001", "-o", "o.vtp")
        self.assertEqual(report["warnings"], [])

    def test_units_do_not_matter(self):
        """Metres and micrometres: about as many triangles, the bound scaled. Roundings differ, and what goes
        first with them: of a ball, where all edges are as good, a tenth more or fewer; so it is a bent one."""
        counts = set()
        for scale in (1e-3, 1, 1e3):
            points, triangles = BALL
            bent = [(x + 0.03 * y * z, 0.7 * y + 0.02 * x * x, z) for x, y, z in points]
            mesh = [tuple(x * scale for x in p) for p in bent], triangles
            self.path("in.ply").write_text(ply(mesh))
            report = self.simplify("in.ply", "--max-error", 0.1 * scale, "-o", "out.ply")
            counts.add(report["output"]["triangles"])
            self.assertLessEqual(report["output"]["errorBoundMm"], 0.1 * scale)
        self.assertLess(max(counts), 1.05 * min(counts))

    def test_threads_give_the_same_bytes(self):
        self.write("ball.off", BALL)
        files = []
        for threads in (1, 2):
            self.simplify("ball.off", "--max-error", "0.05", "--threads", threads, "-o", "out.vtp")
            files.append(self.path("out.vtp").read_bytes())
        self.assertEqual(files[0], files[1])

    def test_angles(self):
        self.write("ball.off", BALL)
        self.simplify("ball.off", "--max-error", "0.1", "--min-angle", "20", "-o", "out.vtp")
        shape = self.check("out.vtp")["surfaces"][0]["shape"]
        self.assertGreaterEqual(shape["minAngleDeg"]["minimum"], 20 - 1e-6)


class Soundness(SimplifyTest):
    def findings(self, report):
        return {finding["what"]: finding["count"] for finding in report["input"]["findings"]}

    def test_open_borders_stay_open(self):
        self.path("patch.ply").write_text(ply(patch()))
        report = self.simplify("patch.ply", "--max-error", "0.05", "-o", "out.ply")
        self.assertFalse(report["input"]["sound"])
        self.assertEqual(self.findings(report), {"borderEdges": 96})
        self.assertEqual(report["warnings"], [])  # some surfaces are open
        self.assertEqual((report["output"]["components"], report["output"]["closed"]), (1, False))
        self.assertLess(report["output"]["triangles"], 1152)
        self.assertLessEqual(self.compare("out.ply", "patch.ply")["maxMm"], 0.05)

    def test_borders_that_are_kept_are_kept_to_the_bit(self):
        mesh = patch()
        self.path("patch.ply").write_text(ply(mesh))
        self.simplify("patch.ply", "--max-error", "0.2", "--keep-borders", "-o", "out.off")
        self.simplify("patch.ply", "--max-error", "0.2", "--keep-borders", "-o", "out.ply")
        content = self.path("out.ply").read_bytes()
        header, body = content.split(b"end_header\n", 1)
        count = int(re.search(rb"element vertex (\d+)", header).group(1))
        points = {struct.unpack_from("<3d", body, 24 * n) for n in range(count)}
        for n in border_points():
            self.assertIn(mesh[0][n], points)

    def test_what_is_broken_is_told_and_kept(self):
        points, triangles = icosphere(10, 3)
        spheres = (points + [(x + 12, y, z) for x, y, z in points],
                   triangles + [tuple(v + len(points) for v in t) for t in triangles])
        self.write("two.off", spheres)
        report = self.simplify("two.off", "--max-error", "0.3", "-o", "out.vtp")
        self.assertIn("crossingTriangles", self.findings(report))
        self.assertRegex(lines(report["warnings"])[0],
                         r"^two.off: \d+ triangles that cross others, the first at [-\d., e]+$")
        self.assertLess(report["output"]["triangles"], 2 * 1280)
        crossing = [self.check(name)["surfaces"][0]["selfIntersections"]["pairCount"]
                    for name in ("two.off", "out.vtp")]
        self.assertLessEqual(crossing[1], crossing[0])

    def test_of_more_crossings_than_are_tested_some_are_counted(self):
        """Closed needles in all directions, hundreds near each, few of which cross."""
        points, triangles = [], []
        for n in range(1200):
            a, b = 2 * math.pi * n * 0.618034, math.acos(1 - 2 * ((n * 0.7548777) % 1))
            u = (math.cos(a) * math.sin(b), math.sin(a) * math.sin(b), math.cos(b))
            v = (-math.sin(a), math.cos(a), 0)
            w = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            c = [3 * math.sin(n * k) for k in (1.1, 2.3, 3.7)]
            points += [tuple(p + x * 60 + y * 1e-3 + z * 1e-3 for p, x, y, z in zip(c, *ends))
                       for ends in ([[-x for x in u], v, w], [u, v, w], [u, [-x for x in v], w],
                                    [u, v, [-x for x in w]])]
            triangles += [tuple(4 * n + k for k in face)
                          for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
        self.path("hay.ply").write_text(ply((points, triangles)))
        done = self.run_simplify("hay.ply", "--max-error", "1", "--require-sound", "--json", "-", "-o", "out.ply")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(done.stderr, r": more than [\d,]+0 triangles that cross others, the first at [-\d., e]+\n")
        found, = (f for f in json.loads(done.stdout)["input"]["findings"] if f["what"] == "crossingTriangles")
        self.assertFalse(found["isComplete"])
        self.assertIn(found["count"], range(2, len(triangles)))
        checked = self.check("hay.ply")["surfaces"][0]["selfIntersections"]
        self.assertFalse(checked["isComplete"])
        self.assertIn(found["count"], range(2, 2 * checked["pairCount"] + 1))

    def test_triangles_without_area_and_doubles_are_dropped_and_counted(self):
        points, triangles = icosphere(10, 2)
        a, b, c = triangles[0]
        mesh = points + [points[a]], triangles + [(a, b, c), (a, b, b)]
        self.write("bad.off", mesh)
        report = self.simplify("bad.off", "--max-error", "0.01", "-o", "out.vtp")
        found = self.findings(report)
        self.assertEqual((found["degenerateTriangles"], found["duplicateTriangles"],
                          found["unusedVertices"]), (1, 1, 1))
        self.assertTrue(report["output"]["closed"])
        self.assertEqual(report["output"]["genus"], 0)
        self.assertEqual(self.check("out.vtp")["surfaces"][0]["failed"], [])

    def test_two_triangles_that_face_opposite_sides_stay(self):
        points, triangles = icosphere(10, 2)
        a, b, _ = triangles[0]
        tip = len(points)
        self.write("flap.off", (points + [(15, 0, 0)],
                                triangles + [(a, b, tip), (b, a, tip)]))
        report = self.simplify("flap.off", "--max-error", "0.01", "-o", "out.off")
        found = self.findings(report)
        self.assertEqual(found["oppositeTriangles"], 1)
        self.assertNotIn("duplicateTriangles", found)
        self.assertIn("flap.off: 1 triangle on the corners of another, facing the other way, at ",
                      "\n".join(lines(report["warnings"])))
        for name in ("flap.off", "out.off"):
            defects = self.check(name)["surfaces"][0]["defects"]
            self.assertEqual((defects["boundaryEdge"], defects["inconsistentlyOrientedEdge"],
                              defects["duplicateTriangle"]), (0, 0, 1), name)

    def test_triangles_between_two_points_of_one_place_leave_a_flap(self):
        self.write("needle.off", ([(0, 0, 0), (0, 0, 0), (1, 0, 0), (0, 1, 0)],
                                  [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]))
        report = self.simplify("needle.off", "--max-error", "0.1", "-o", "out.off")
        self.assertEqual(report["output"]["triangles"], 2)
        self.assertTrue(report["output"]["closed"])

    def test_a_triangle_without_area_that_lies_alone_is_dropped(self):
        points, triangles = icosphere(10, 2)
        n = len(points)
        self.write("bad.off", (points + [(70, 1, 1), (71, 1, 1), (72, 1, 1)],
                               triangles + [(n, n + 1, n + 2)]))
        report = self.simplify("bad.off", "--max-error", "0.5", "-o", "out.vtp")
        self.assertEqual(self.findings(report)["degenerateTriangles"], 1)
        self.assertLessEqual(report["output"]["verification"]["maxMm"], 0.5)
        self.assertEqual(report["output"]["components"], 1)

    def test_a_fin_stays(self):
        """An edge with three triangles."""
        points, triangles = icosphere(10, 3)
        a, b, _ = triangles[0]
        far = tuple(1.5 * x for x in points[a])
        self.write("fin.off", (points + [far], triangles + [(a, b, len(points))]))
        report = self.simplify("fin.off", "--max-error", "0.2", "-o", "out.vtp")
        self.assertEqual(self.findings(report)["nonManifoldEdges"], 1)
        self.assertLess(report["output"]["triangles"], 1281)
        topology = self.check("out.vtp")["surfaces"][0]
        self.assertIn("manifoldEdges", topology["failed"])

    def test_a_soup_is_told(self):
        points, triangles = icosphere(10, 2)
        corners = [points[v] for t in triangles for v in t]
        alone = [(3 * n, 3 * n + 1, 3 * n + 2) for n in range(len(triangles))]
        self.path("soup.ply").write_text(ply((corners, alone)))
        report = self.simplify("soup.ply", "--max-error", "1", "-o", "out.ply")
        self.assertEqual(lines(report["warnings"])[0],
                         "soup.ply: 798 points lie on a border at the place of another, and "
                         "triangles do not go across; --weld joins them")
        self.assertEqual(report["output"]["triangles"], 320)
        joined = self.simplify("soup.ply", "--max-error", "1", "--weld", "-o", "joined.ply")
        self.assertEqual((joined["warnings"], joined["input"]["sound"]), ([], True))
        self.assertEqual(self.findings(joined), {"joinedVertices": 798})
        self.write("whole.off", (points, triangles))
        whole = self.simplify("whole.off", "--max-error", "1", "-o", "whole.ply")
        for key in ("triangles", "closed", "components"):
            self.assertEqual(joined["output"][key], whole["output"][key])

    def test_require_sound_refuses_with_the_reason(self):
        points, triangles = icosphere(10, 2)
        self.write("hole.off", (points, triangles[1:]))
        self.write("ball.off", (points, triangles))
        done = self.run_simplify("hole.off", "--max-error", "1", "--require-sound", "-o", "out.vtp",
                                 "--json", "report.json", "--quiet")
        self.assertEqual((done.returncode, done.stdout), (CHECK_FAILED, ""))
        self.assertRegex(done.stderr, r"^adaptiso-simplify: hole.off: is not sound, .*: 3 open "
                                      r"border edges, the first at [^\n]*\n$")
        self.assertEqual(self.names(), ["ball.off", "hole.off", "report.json"])
        report = json.loads(self.path("report.json").read_text())
        self.assertEqual((report["failedBySoundness"], report["output"]), (True, None))
        report = self.simplify("ball.off", "--max-error", "1", "--require-sound", "-o", "out.vtp")
        self.assertFalse(report["failedBySoundness"])

    def test_require_sound_finds_what_crosses(self):
        points, triangles = icosphere(10, 2)
        mesh = (points + [(x + 12, y, z) for x, y, z in points],
                triangles + [tuple(v + len(points) for v in t) for t in triangles])
        self.write("two.off", mesh)
        done = self.run_simplify("two.off", "--max-error", "1", "--require-sound", "-o", "out.vtp")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(done.stderr, "triangles that cross others")
        self.assertEqual(self.names(), ["two.off"])

    def test_strict(self):
        self.write("cube.off", cube((0, 0, 0), (1, 1, 1)))
        done = self.run_simplify("cube.off", "--triangles", "2", "--strict", "-o", "out.vtp")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(done.stderr.splitlines()[-1], "--strict: .*so no surface was written")
        self.assertEqual(self.names(), ["cube.off"])

    def test_a_format_with_too_few_digits_is_refused(self):
        """A ball of 1 mm, 30 km from the origin: float32 is 2 mm there."""
        points, triangles = icosphere(1, 2)
        self.path("far.ply").write_text(ply(([(x + 3e7, y, z) for x, y, z in points], triangles)))
        self.refused(BAD_INPUT, "out.stl: STL keeps too few digits.*write .vtp or .ply",
                     "far.ply", "--max-error", "0.01", "-o", "out.stl")
        self.simplify("far.ply", "--max-error", "0.01", "-o", "out.vtp")


class Frames(SimplifyTest):
    def test_are_kept(self):
        for frame, word in ((RAS, "ras"), (LPS, "lps"), (TKRAS, "tkras"), (VOXEL, "voxel"),
                            (None, None)):
            text = ply(icosphere(10, 2), comment=f"CoordinateFrame: {frame}" if frame else "")
            self.path("in.ply").write_text(text)
            for name in ("out.ply", "out.vtp", "out.stl", "out.gii", "out.off", "out.obj"):
                with self.subTest(f"{frame} {name}"):
                    report = self.simplify("in.ply", "--max-error", "0.2", "-o", name)
                    self.assertEqual(report["input"]["coordinates"], word)
                    self.assertEqual(report["output"]["coordinates"], word)
                    self.assertEqual(report["warnings"], [])
                    content = self.path(name).read_bytes()
                    if word is None:
                        self.assertNotIn(b"CoordinateFrame", content)
                    again = self.simplify(name, "--max-error", "0.2", "-o", "again.ply")
                    self.assertEqual(again["input"]["coordinates"], word)

    def test_freesurfer_keeps_tkras_and_its_volume_but_no_names(self):
        write_pial(self.path("lh.pial"), BALL)
        self.path("out").mkdir()
        self.simplify("lh.pial", "--max-error", "0.2", "-o", "out/")
        points, triangles, footer = read_pial(self.path("out/lh.pial"))
        self.assertLess(len(triangles), 5120)
        for point in points:
            self.assertLess(abs(math.sqrt(sum(x * x for x in point)) - 10), 0.25)
        text = footer[12:].decode()
        self.assertRegex(text, "valid = 1 .*")
        self.assertRegex(text, "cras +=  ?3 -4 5\n")
        self.assertRegex(text, "volume = 256 256 256\n")
        self.assertNotIn(b"jane", self.path("out/lh.pial").read_bytes())

    def test_can_be_changed(self):
        self.write("ras.off", BALL)
        report = self.simplify("ras.off", "--max-error", "0.1", "--coordinates", "lps", "-o",
                               "lps.off")
        self.assertEqual(report["output"]["coordinates"], "lps")
        self.assertLessEqual(self.compare("lps.off", "ras.off")["maxMm"], 0.1)
        write_pial(self.path("lh.pial"), BALL)
        report = self.simplify("lh.pial", "--max-error", "0.1", "--coordinates", "ras", "-o",
                               "lh.vtp")
        self.assertLessEqual(self.compare("lh.vtp", "lh.pial")["maxMm"], 0.1)  # c_ras and all
        # away from the first, at c_ras
        self.assertGreater(self.compare("lh.vtp", "ras.off")["maxMm"], 4)

    def test_that_are_not_known_are_refused(self):
        self.write("tk.off", BALL, TKRAS)
        self.refused(BAD_INPUT, "tk.off: is in tkRAS mm, and does not say the volume", "tk.off",
                     "--max-error", "1", "--coordinates", "ras", "-o", "out.vtp")
        self.write("voxel.off", BALL, VOXEL)
        self.refused(USAGE, "lh.pial: FreeSurfer holds points in mm only", "voxel.off",
                     "--max-error", "1", "-o", "lh.pial")
        report = self.simplify("tk.off", "--max-error", "1", "-o", "lh.pial")
        self.assertEqual(report["warnings"], [])
        self.assertIn(b"valid = 0", self.path("lh.pial").read_bytes())
        self.path("none.ply").write_text(ply(BALL))
        for out in (("--coordinates", "lps", "-o", "out.vtp"), ("-o", "rh.pial")):
            self.refused(BAD_INPUT, "none.ply: does not say its coordinate frame.*"
                         "--input-coordinates", "none.ply", "--max-error", "1", *out)
        report = self.simplify("none.ply", "--max-error", "1", "--input-coordinates", "lps", "-o",
                               "lps.off")
        self.assertEqual(report["options"]["inputCoordinates"], ["lps"])
        self.assertEqual((report["input"]["coordinates"], report["output"]["coordinates"]),
                         ("lps", "lps"))
        self.refused(USAGE, "--input-coordinates: is given 2 times", "none.ply", "--max-error", "1",
                     *["--input-coordinates", "ras"] * 2, "-o", "out.vtp")
        self.refused(BAD_INPUT, "tkRAS mm, and does not say the volume", "none.ply", "--max-error",
                     "1", "--input-coordinates", "tkras", "--coordinates", "ras", "-o", "out.vtp")


class Refusals(SimplifyTest):
    def setUp(self):
        super().setUp()
        self.write("a.off", icosphere(10, 1))

    def test_default_is_in_the_current_folder(self):
        self.simplify("a.off", "--max-error", "1")
        self.assertTrue(self.path("a-simplified.off").exists())

    def test_usage(self):
        aim, out = ("--max-error", "1"), ("-o", "b.off")
        for pattern, arguments in (
                ("MESH is missing", (*aim, *out)),
                ("--max-error, --triangles or --reduction is missing", ("a.off", *out)),
                ("two ways to ask", ("a.off", "--triangles", "5", "--reduction", "0.5", *out)),
                ("--max-error 0: must be a number above 0, in mm", ("a.off", "--max-error", "0",
                                                                    *out)),
                ("--max-error nan: must be", ("a.off", "--max-error", "nan", *out)),
                ("--reduction 2: must be a number from 0 to 1", ("a.off", "--reduction", "2",
                                                                 *out)),
                ("--min-angle 41: must be", ("a.off", *aim, "--min-angle", "41", *out)),
                ("no surface format has the extension '.xyz'", ("a.off", *aim, "-o", "b.xyz")),
                ("needs {name} in it", ("a.off", "c.off", *aim, *out)),
                ("is a folder, and --output-dir", ("a.off", *aim, "-o", "x/", "--output-dir", "y")),
                ("--coordinates up: must be", ("a.off", *aim, "--coordinates", "up", *out)),
                ("did you mean --max-error", ("a.off", "--max-err", "1", *out)),
                ("keeps no order of points", ("a.off", *aim, "--data", "lh.curv", "-o", "b.stl")),
                ("is the name of another output", ("a.off", *aim, *out, "--json", "b.off"))):
            with self.subTest(pattern):
                self.refused(USAGE, pattern, *arguments)

    def test_input(self):
        aim, out = ("--max-error", "1"), ("-o", "b.off")
        points, triangles = icosphere(10, 1)
        self.write("nan.off", ([(NAN, 0, 0)] + points[1:], triangles))
        self.write("range.off", (points, triangles + [(0, 1, 4242)]))
        self.path("empty.off").write_text("OFF\n0 0 0\n")
        for pattern, name in (("nan.off: .*not a number", "nan.off"),
                              ("range.off: .*uses point 4242", "range.off"),
                              ("empty.off: .*no triangle", "empty.off"),
                              ("none.off: no such file", "none.off")):
            with self.subTest(name):
                self.refused(BAD_INPUT, pattern, name, *aim, *out)
        self.refused(BAD_INPUT, "a.off.*never overwritten|is an input", "a.off", *aim, "-o", "a.off")
        self.refused(BAD_INPUT, "no such folder|does not exist|there is no folder", "a.off", *aim,
                     "-o", "none/b.off")

    def test_a_bound_that_no_coordinate_can_tell(self):
        self.refused(BAD_INPUT, r"--max-error 1e-14: is less than 1e-12 of the diagonal of a.off",
                     "a.off", "--max-error", "1e-14", "-o", "b.off")

    def test_a_surface_without_area(self):
        self.write("flat.off", ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]))
        self.refused(BAD_INPUT, "flat.off", "flat.off", "--max-error", "1", "-o", "b.off")


class Batches(SimplifyTest):
    def setUp(self):
        super().setUp()
        self.write("a.off", BALL)
        write_pial(self.path("lh.pial"), BALL)
        self.write("bad.off", ([(0, 0, 0)], []))

    def test_into_a_folder(self):
        done = self.run_simplify("a.off", "lh.pial", "bad.off", "--max-error", "0.2", "--jobs", "2",
                                 "-o", "small/")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(done.stdout, r"done +a.off: [\d,]+ triangles of 5,120")
        self.assertRegex(done.stdout, r"FAILED +bad.off: .*no triangle")
        small = self.path("small")
        self.assertEqual({p.name for p in small.iterdir()},
                         {"a.off", "lh.pial", "summary.html", "a.adaptiso-simplify.json",
                          "lh.pial.adaptiso-simplify.json", "bad.adaptiso-simplify.json"})
        before = (small / "a.off").read_bytes()
        arguments = ("a.off", "lh.pial", "--max-error", "0.2", "--skip-existing", "-o", "small/")
        done = self.run_simplify(*arguments)
        self.assertEqual(done.stdout.count("before "), 2, done.stdout)
        (small / "a.off").unlink()
        done = self.run_simplify(*arguments)
        self.assertRegex(done.stdout, "a.off: .*made again: a.off is gone")
        self.assertEqual((small / "a.off").read_bytes(), before)
        done = self.run_simplify("a.off", "lh.pial", "--max-error", "0.3", "--skip-existing", "-o",
                                 "small/")
        self.assertEqual(done.stdout.count("another --max-error was given"), 2, done.stdout)

    def test_names_and_lists(self):
        self.path("list.txt").write_text("a.off\tone\nlh.pial\ttwo\n")
        done = self.run_simplify("--list", "list.txt", "--max-error", "0.2", "-o", "x-{name}.vtp",
                                 "--json", "-")
        self.assertEqual(done.returncode, OK, done.stderr)
        self.assertTrue(self.path("x-one.vtp").is_file() and self.path("x-two.vtp").is_file())
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual(lines[0]["outputs"], ["x-one.vtp"])


class Reports(SimplifyTest):
    def setUp(self):
        super().setUp()
        self.write("ball.off", BALL)

    def test_keys_are_the_documented_ones(self):
        report = self.simplify("ball.off", "--max-error", "0.1", "-o", "out.vtp", "--report",
                               "page.html")
        self.assertEqual(report["schema"], "adaptiso-simplify/1")
        self.assertEqual(keys_of(report), documented_keys() | {"seconds.report"})

    def test_names_are_without_folders(self):
        self.path("folder").mkdir()
        self.write("folder/a.off", BALL)
        report = self.simplify("folder/a.off", "--max-error", "0.1", "-o", "folder/out.vtp")
        self.assertNotIn("folder", json.dumps(report))

    def test_pages(self):
        points, triangles = BALL
        self.write("hole.off", (points, triangles[1:]))
        for name, arguments, words in (
                ("ball.off", (), "no point farther than"),
                ("hole.off", (), "open border edges"),
                ("hole.off", ("--require-sound",), "Not simplified")):
            with self.subTest(words):
                self.run_simplify(name, "--max-error", "0.1", "-o", "out.vtp", "--report",
                                  "page.html", *arguments)
                self.assertIn(words, self.path("page.html").read_text())
                self.path("page.html").unlink()

    def test_a_page_tells_what_was_read_from_what_was_written(self):
        # also where both have one name, as in a folder of FreeSurfer's
        self.path("out").mkdir()
        self.run_simplify("ball.off", "--max-error", "0.1", "-o", "out/", "--report", "page.html")
        page = self.path("page.html").read_text()
        for word in ("read", "written"):
            self.assertRegex(page, rf'<th scope="row">{word}</th><td data-label="[^"]+">ball.off</td>')

    def test_text_tells_what_came_of_it(self):
        done = self.run_simplify("ball.off", "--max-error", "0.1", "-o", "out.vtp")
        self.assertRegex(done.stdout, r"ball.off: 5,120 triangles, OFF, RAS mm\n"
                                      r"  closed, 2-manifold, oriented, nothing crosses\n"
                                      r"out.vtp: [\d,]+ triangles \(\d+\.\d %\), VTK XML PolyData, "
                                      r"RAS mm\n  no point farther than ")
        self.assertEqual(done.stderr, "")
        done = self.run_simplify("ball.off", "--max-error", "0.1", "-o", "out.vtp", "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))


if __name__ == "__main__":
    main()
