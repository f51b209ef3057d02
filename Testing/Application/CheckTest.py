"""adaptiso-check: the defects planted in a head model, numbers known on paper, frames, formats,
profiles, reports and refusals."""

import json
import math
import re
import struct
import subprocess
import sys
import unittest

from support import (BAD_INPUT, BIN, CHECK_FAILED, OK, SOURCE, USAGE, ApplicationTest, Image, ball,
                     main, write_4d_nifti, write_nifti)

sys.path.insert(0, str(SOURCE / "Testing" / "Support"))
from headDefects import (DEFECTS, NAN, add_repeated_index, flipped, good, icosphere, moved,
                         resized, soup, with_handle, write_off)  # noqa: E402

CHECK = str(BIN / "adaptiso-check")
README = SOURCE / "Applications" / "adaptiso-check" / "README.md"
NAMES = ["inner.off", "middle.off", "outer.off"]


def cube(low, high):
    """Closed, outward, between two corners."""
    points = [tuple((high if n >> axis & 1 else low)[axis] for axis in range(3)) for n in range(8)]
    return points, [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
                    (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def together(*meshes):
    points, triangles = [], []
    for more, others in meshes:
        triangles += [tuple(v + len(points) for v in t) for t in others]
        points += more
    return points, triangles


def write_ply(path, mesh):
    points, triangles = mesh
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
              "property double x\nproperty double y\nproperty double z\n"
              f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + b"".join(struct.pack("<3d", *p) for p in points) +
                     b"".join(struct.pack("<B3i", 3, *t) for t in triangles))


def write_stl(path, mesh):
    points, triangles = mesh
    path.write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for v in t for x in points[v]), 0) for t in triangles))


def write_surf(path, mesh):
    points, triangles = mesh
    path.write_bytes(b"\xff\xff\xfetest\n\n" + struct.pack(">2i", len(points), len(triangles)) +
                     b"".join(struct.pack(">3f", *p) for p in points) +
                     b"".join(struct.pack(">3i", *t) for t in triangles))


class CheckTest(ApplicationTest):
    def write(self, name, mesh, frame="RAS mm"):
        write_off(self.path(name), mesh, frame)

    def write_model(self, model):
        for name, mesh in zip(NAMES, model):
            self.write(name, mesh)

    def run_check(self, *arguments):
        return subprocess.run([CHECK, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)

    def check(self, *arguments, code=None):
        """The report; the exit code is what the report says, or `code`."""
        done = self.run_check(*arguments, "--json", "-")
        report = json.loads(done.stdout)
        expected = (OK if report["passed"] else CHECK_FAILED) if code is None else code
        self.assertEqual(done.returncode, expected, done.stderr)
        return report

    def surface(self, mesh, *arguments):
        """What is said of one surface."""
        self.write("surface.off", mesh)
        return self.check("surface.off", *arguments)["surfaces"][0]

    def refused(self, code, pattern, *arguments):
        before = self.contents()
        done = self.run_check(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, pattern)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 2 if code == USAGE else 1, done.stderr)
        self.assertTrue(lines[0].startswith("adaptiso-check: "), lines[0])
        self.assertEqual(self.contents(), before)


def finding(subject, name):
    return next(check["finding"] for check in subject["checks"] if check["name"] == name)


def outcome(subject, name):
    return next(check["outcome"] for check in subject["checks"] if check["name"] == name)


INNER, FIRST_PAIR, LAST_PAIR = "inner.off", "inner.off in middle.off", "middle.off in outer.off"
ALL = NAMES
# What must be said of each planted defect: of whom, which checks fail (and no other that is
# required does), and words of the first one's finding.
EXPECTED = {
    "an inner vertex pokes out":
        ({FIRST_PAIR: ["noCrossing", "strictlyNested", "minGap"]}, "pairs of triangles cross"),
    "a narrow dent of the outer surface goes through an inner face":
        ({FIRST_PAIR: ["noCrossing", "strictlyNested", "minGap"]}, "3 pairs of triangles cross"),
    "a hole": ({INNER: ["closed", "solidAngle"]}, "3 boundary edges"),
    "all triangles are flipped":
        ({name: ["outward", "solidAngle"] for name in ALL}, "all triangles are flipped"),
    "one triangle is flipped":
        ({INNER: ["consistentOrientation", "solidAngle"]}, r"3 edges .*flipped"),
    "inner and outer are swapped":
        ({FIRST_PAIR: ["strictlyNested"], LAST_PAIR: ["strictlyNested"]},
         "swapped order: middle.off lies inside inner.off"),
    "all in metres": ({**{name: ["plausibleSize"] for name in ALL}, FIRST_PAIR: ["minGap"],
                       LAST_PAIR: ["minGap"]}, "too small; in metres"),
    "the inner surface in metres": ({INNER: ["plausibleSize"]}, "too small; in metres"),
    "all in micrometres":
        ({name: ["plausibleSize"] for name in ALL}, "too large; in micrometres"),
    "an isolated vertex":
        ({INNER: ["noUnusedVertices"]}, "1 vertex that no triangle uses; first: vertex 642"),
    "a triangle soup":
        ({INNER: ["closed", "oneComponent", "noDuplicateVertices"]}, "a triangle soup"),
    "a gap of 0.05 mm": ({FIRST_PAIR: ["minGap"]}, r"smallest 0\.050 mm"),
    "a triangle names a vertex twice":
        ({INNER: ["noDegenerateTriangles"]}, "1 names a vertex twice; first: triangle 1280"),
    "two triangles without area, of a collapsed vertex":
        ({INNER: ["noDegenerateTriangles", "noDuplicateVertices", "minAngle"]},
         "2 have zero area"),
    "a handle": ({INNER: ["genusZero"]}, "genus 1: 1 handle"),
    "a spike crosses its own surface":
        ({INNER: ["noSelfIntersections"]}, "pairs of triangles cross"),
    "a second closed component": ({INNER: ["outward", "oneComponent"]}, "component 1"),
    "the inner surface is 300 mm away": ({FIRST_PAIR: ["strictlyNested"]}, "apart"),
    "a coordinate is NaN": ({INNER: ["finiteCoordinates", "solidAngle"]},
                            "1 vertex is NaN or infinite; first: vertex 5"),
}


class PlantedDefects(CheckTest):
    def test_good_model_passes(self):
        self.write_model(good())
        report = self.check("--nested", *NAMES)
        self.assertTrue(report["passed"])
        for subject in report["surfaces"] + report["nesting"]["pairs"]:
            self.assertEqual([c["name"] for c in subject["checks"] if c["outcome"] != "passed"], [])
        done = self.run_check("--nested", *NAMES, "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (OK, "", ""))

    def test_each_is_found_by_name(self):
        self.assertEqual(set(EXPECTED), set(DEFECTS))
        self.assertEqual(len(DEFECTS), 19)
        for name, plant in DEFECTS.items():
            failing, words = EXPECTED[name]
            self.write_model(plant(good()))
            report = self.check("--nested", *NAMES, code=CHECK_FAILED)
            subjects = {surface["file"]: surface for surface in report["surfaces"]}
            for pair in report["nesting"]["pairs"]:
                subjects[f"{pair['inner']} in {pair['outer']}"] = pair
            found = {subject: said["failed"] for subject, said in subjects.items()
                     if said["failed"]}
            with self.subTest(name):
                self.assertEqual(found, failing)
                first, checks = next(iter(failing.items()))
                self.assertRegex(finding(subjects[first], checks[0]), words)

    def test_text_names_them_too(self):
        self.write_model(DEFECTS["a hole"](good()))
        done = self.run_check("--nested", *NAMES)
        self.assertEqual((done.returncode, done.stderr), (CHECK_FAILED, ""))
        self.assertRegex(done.stdout, r"\n  closed +FAILED +3 boundary edges")
        self.assertRegex(done.stdout, r"\n  => FAILED as bem: closed, MNE's solid angle\n")
        self.assertEqual(done.stdout.count("=> passed as bem\n"), 4)
        quiet = self.run_check("--nested", *NAMES, "-q")
        self.assertEqual((quiet.returncode, quiet.stdout), (CHECK_FAILED, ""))
        self.assertRegex(quiet.stderr.splitlines()[0],
                         "^adaptiso-check: check failed: inner.off: closed: 3 boundary edges")


class Truth(CheckTest):
    def test_cube(self):
        """8 vertices, 12 triangles: half squares of 100 mm; angles of 45 degrees."""
        said = self.surface(cube((-50, -50, -50), (50, 50, 50)), "--profile", "bem")
        self.assertEqual((said["vertices"], said["edges"], said["triangles"]), (8, 18, 12))
        self.assertEqual((said["genus"], said["areaMm2"]), (0, 60000))
        self.assertAlmostEqual(said["volumeMm3"], 1e6, delta=1e-8)  # sums of sixths are rounded
        self.assertEqual(said["size"], {"extentMm": [100, 100, 100], "verdict": "plausible",
                                        "guessedUnit": None})
        self.assertAlmostEqual(said["solidAngleShare"], 1, 12)
        self.assertAlmostEqual(said["shape"]["minAngleDeg"]["maximum"], 45, 9)
        # inscribed circle of a half square of side 1: (2 - sqrt 2) / 2
        ratio = math.sqrt(2) / (2 * math.sqrt(3) * (2 - math.sqrt(2)) / 2)
        self.assertAlmostEqual(said["shape"]["aspectRatio"]["median"], ratio, 12)
        self.assertAlmostEqual(said["shape"]["edgeMm"]["maximum"], 100 * math.sqrt(2), 12)
        self.assertEqual(said["shape"]["edgeMm"]["minimum"], 100)

    def test_cavity_and_components(self):
        hollow = together(icosphere(50), flipped(icosphere(40)))
        said = self.surface(hollow)
        self.assertEqual((said["passed"], said["componentCount"]), (True, 2))
        self.assertEqual(said["componentsInsideOut"], [])
        self.assertEqual([c["signedVolumeMm3"] > 0 for c in said["components"]], [True, False])
        self.assertEqual(self.surface(hollow, "--profile", "bem")["failed"],
                         ["oneComponent", "solidAngle"])  # the vertices' mean is in the cavity
        said = self.surface(together(icosphere(50), icosphere(40)))
        self.assertEqual((said["failed"], said["componentsInsideOut"]), (["outward"], [1]))

    def test_pairs_that_intersect(self):
        """A bar through a cube's front and back, past all edges: the bar's four sides are eight
        triangles; each diagonal is on a side of a face once."""
        bar = cube((20, 10, -10), (30, 20, 110))
        said = self.surface(together(cube((0, 0, 0), (100, 100, 100)), bar))
        crossings = said["selfIntersections"]
        self.assertEqual(len(crossings["pairs"]), crossings["pairCount"])
        self.assertEqual({(a < 12, b >= 12) for a, b in crossings["pairs"]}, {(True, True)})
        # triangles of z = 0 and z = 100 only, each side of the bar meeting one or both
        self.assertEqual({a for a, _ in crossings["pairs"]} - {0, 1, 2, 3}, set())
        self.assertEqual(len({b for _, b in crossings["pairs"]}), 8)
        few = self.surface(together(cube((0, 0, 0), (100, 100, 100)), bar), "--max-pairs", 1)
        self.assertEqual(few["selfIntersections"]["pairCount"], crossings["pairCount"])
        self.assertEqual(few["selfIntersections"]["pairs"], crossings["pairs"][:1])

    def test_touching_is_intersecting(self):
        base = cube((0, 0, 0), (100, 100, 100))
        above = cube((20, 20, 100), (40, 40, 140))
        self.assertIn("noSelfIntersections", self.surface(together(base, above))["failed"])
        apart = cube((20, 20, 100.00000000000003), (40, 40, 140))  # two units in the last place
        self.assertEqual(self.surface(together(base, apart))["failed"], [])

    def test_gap_between_cubes(self):
        self.write("inner.off", cube((10, 12, 14), (80, 80, 80)))
        self.write("outer.off", cube((0, 0, 0), (100, 100, 100)))
        pair = self.check("--nested", "inner.off", "outer.off")["nesting"]["pairs"][0]
        self.assertEqual((pair["relation"], pair["gap"]["mm"]), ("nested", 10))
        self.assertEqual(pair["gap"]["innerPointMm"][0], 10)
        self.assertEqual(pair["gap"]["outerPointMm"][0], 0)
        self.assertEqual((pair["innerVertices"], pair["innerVerticesNotInside"],
                          pair["outerVerticesInside"]), (8, 0, 0))
        report = self.check("--nested", "inner.off", "outer.off", "--min-gap", "10")
        self.assertTrue(report["passed"])
        report = self.check("--nested", "inner.off", "outer.off", "--min-gap", "10.1")
        self.assertEqual(report["nesting"]["pairs"][0]["failed"], ["minGap"])

    def test_isosurface(self):
        """100 at 8 voxels of 2 mm from the middle, 10 less for each further out."""
        write_nifti(self.path("ball.nii"), ball(24, 8, (2, 2, 2), (5, 6, 7)))
        self.mesh("ball.nii", "--iso", "100", "--method", "mc", "--quiet", "-o", "a.vtp")
        self.mesh("ball.nii", "--iso", "90", "--method", "mc", "--quiet", "-o", "b.vtp")
        on = self.check("a.vtp", "--volume", "ball.nii", "--iso", "100")["surfaces"][0]
        # the very surface; near slivers the nearest point is known to 1e-10 of a side
        self.assertLess(on["isosurface"]["maxMm"], 1e-9)
        self.assertTrue(on["passed"])
        off = self.check("b.vtp", "--volume", "ball.nii", "--iso", "100")["surfaces"][0]
        # samples are rounded to whole numbers: a tenth of the step between two voxels
        self.assertAlmostEqual(off["isosurface"]["meanMm"], 2, delta=0.1)
        self.assertEqual(off["failed"], ["onIsosurface"])
        for limit, failed in ((1.5, ["onIsosurface"]), (3, [])):
            report = self.check("b.vtp", "--volume", "ball.nii", "--iso", "100",
                                "--max-off", limit)
            self.assertEqual(report["surfaces"][0]["failed"], failed)

    def test_isosurface_of_a_preprocessed_volume(self):
        write_nifti(self.path("ball.nii"), ball(24, 8, spacing=(1, 1, 2)))
        steps = ["--crop", "2:,:,1:", "--smooth", "1", "--resample", "0.8"]
        self.mesh("ball.nii", "--iso", "100", *steps, "--method", "mc", "--quiet",
                  "--coordinates", "voxel", "-o", "a.vtp")
        report = self.check("a.vtp", "--volume", "ball.nii", "--iso", "100", *steps)
        # the points went through voxel indices: a few times 1e-7 of 24 voxels
        self.assertLess(report["surfaces"][0]["isosurface"]["maxMm"], 1e-4)
        self.assertEqual(report["volume"]["preprocessing"],
                         {"crop": [[2, 24], [0, 24], [1, 24]], "smoothSigmaMm": 1,
                          "resampleMm": 0.8, "interpolation": "linear"})
        # unsmoothed, the surface lies further out: by 1 / 8 mm and more across the longer voxels
        plain = self.check("a.vtp", "--volume", "ball.nii", "--iso", "100")
        self.assertGreater(plain["surfaces"][0]["isosurface"]["meanMm"], 0.05)
        self.assertIsNone(plain["volume"]["preprocessing"])

    def test_isosurface_of_one_of_several_volumes(self):
        dark = ball(24, 8, (2, 2, 2))
        dark.samples = [0] * len(dark.samples)
        write_4d_nifti(self.path("4d.nii"), [dark, ball(24, 8, (2, 2, 2))])
        self.mesh("4d.nii", "--volume-index", "1", "--iso", "100", "--method", "mc", "--quiet",
                  "-o", "a.vtp")
        self.assertTrue(self.check("a.vtp", "--volume", "4d.nii", "--volume-index", "1", "--iso",
                                   "100")["passed"])
        self.refused(BAD_INPUT, "100", "a.vtp", "--volume", "4d.nii", "--volume-index", "0",
                     "--iso", "100")
        self.refused(USAGE, "--series.*--volume", "a.vtp", "--series", "1")


class Profiles(CheckTest):
    def test_require_what_they_say(self):
        """README.md's table: what it marks, and only that, is required."""
        rows = re.findall(r"^\| `(\w+)` \| .* \| (x?) ?\| (x?) ?\| (x?) ?\|$",
                          README.read_text(), re.MULTILINE)
        write_nifti(self.path("ball.nii"), ball(24, 8))
        self.write_model(good())
        for column, profile in enumerate(("bem", "print", "view")):
            report = self.check("--nested", *NAMES, "--profile", profile, "--volume", "ball.nii",
                                "--iso", "100")
            required = {check["name"]: check["required"]
                        for subject in (report["surfaces"][0], report["nesting"]["pairs"][0])
                        for check in subject["checks"]}
            self.assertEqual(required, {row[0]: row[1 + column] == "x" for row in rows})

    def test_default_is_print_and_nested_bem(self):
        self.write_model(good())
        self.assertEqual(self.check(NAMES[0])["options"]["profile"], "print")
        self.assertEqual(self.check("--nested", *NAMES)["options"]["profile"], "bem")

    def test_handle_may_be_printed_and_a_hole_viewed(self):
        said = self.surface(with_handle(icosphere(80)))
        self.assertEqual((said["passed"], outcome(said, "genusZero")), (True, "failed"))
        points, triangles = icosphere(80)
        said = self.surface((points, triangles[1:]), "--profile", "view")
        self.assertEqual((said["passed"], outcome(said, "closed"), outcome(said, "outward")),
                         (True, "failed", "undecided"))

    def test_min_angle_is_required_where_given(self):
        half = cube((0, 0, 0), (60, 60, 60))
        self.assertEqual(self.surface(half, "--min-angle", 44)["failed"], [])
        self.assertEqual(self.surface(half, "--min-angle", 46)["failed"], ["minAngle"])


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
        report = self.check("--nested", "inner.off", "outer.off")
        self.assertRegex(report["warnings"][0], "inner.off does not say its coordinate frame")
        self.write("inner.off", inner, "tkRAS mm")
        self.refused(BAD_INPUT, "inner.off is in tkRAS mm and outer.off is in RAS mm.*--volume",
                     "--nested", "inner.off", "outer.off")

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
                ("--iso 7: the volume has no surface", "a.off", "--volume", "i.nii", "--iso", "7"),
                ("a.off", "a.off", "--json", "a.off"),
                ("no/r.json", "a.off", "--json", "no/r.json")):
            with self.subTest(arguments):
                self.refused(BAD_INPUT, pattern, *arguments)


def documented_keys():
    """The keys in the first column of README.md's table; a key that begins with a dot belongs to
    the parent of the row that ends in a colon before it."""
    section = README.read_text().split("## The report")[1]
    keys, parent = set(), None
    for cell, what in re.findall(r"^\| (`.*?`) \| (.*) \|$", section, re.MULTILINE):
        names = re.findall(r"`([^`]+)`", cell)
        if what.endswith(":"):
            parent, = names
            continue
        for name in names:
            keys.add(parent + name if name.startswith(".") else name)
    return keys


LISTS = re.compile(r"(surfaces|nesting\.pairs|\.checks|\.examples|\.components)$")
LEAVES = re.compile(r"\.(minAngleDeg|aspectRatio|edgeMm|isosurface)$")


def keys_of(value, path=""):
    """The paths of all leaves; lists of objects are walked into, as are objects but some."""
    if isinstance(value, dict) and not LEAVES.search(path):
        return {leaf for key, inner in value.items()
                for leaf in keys_of(inner, f"{path}.{key}" if path else key)}
    if isinstance(value, list) and LISTS.search(path):
        return {leaf for item in value for leaf in keys_of(item, path)}
    return {path}


class Report(CheckTest):
    def test_keys_are_the_documented_ones(self):
        write_nifti(self.path("ball.nii"), ball(24, 8))
        self.write("a.off", DEFECTS["a hole"](good())[0])
        self.write("b.off", icosphere(86))
        report = self.check("--nested", "a.off", "b.off", "--volume", "ball.nii", "--iso", "100")
        self.assertEqual(report["schema"], "adaptiso-check/1")
        self.assertEqual(keys_of(report), documented_keys())

    def test_holds_names_without_folders(self):
        self.path("folder").mkdir()
        self.write("folder/a.off", icosphere(80))
        report = self.check("folder/a.off", "folder/missing.off", code=BAD_INPUT)
        self.assertNotIn("folder", json.dumps(report))

    def test_is_the_same_whatever_the_number_of_threads(self):
        self.write_model(DEFECTS["an inner vertex pokes out"](good()))
        results = []
        for threads in (1, 2):
            report = self.check("--nested", *NAMES, "--threads", threads)
            for key in ("seconds", "peakMemoryMb"):
                del report[key]
            self.assertEqual(report["options"].pop("threads"), threads)
            text = self.run_check("--nested", *NAMES, "--threads", threads).stdout
            results.append((report, text.splitlines()[:-1]))  # the last tells seconds
        self.assertEqual(results[0], results[1])


class Readme(CheckTest):
    def test_examples_run(self):
        write_nifti(self.path("head.nii"), ball(24, 9))
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={"PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertEqual(self.names(), ["check.html", "head.nii", "head.stl", "inner.ply",
                                        "report.json"])


if __name__ == "__main__":
    main()
