"""adaptiso-check: numbers known on paper, profiles, reports and the README."""

import json
import math
import re
import subprocess

from support import BAD_INPUT, BIN, USAGE, ball, main, write_4d_nifti, write_nifti
from checkSupport import NAMES, README, CheckTest, finding, outcome, together
from headDefects import DEFECTS, cube, flipped, good, icosphere, with_handle


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

    def test_cube_of_quadrangles(self):
        """Six faces, cut into twelve triangles; a note, which --strict passes."""
        points = [(x, y, z) for z in (0, 9) for x, y in ((0, 0), (9, 0), (9, 9), (0, 9))]
        faces = ["0 3 2 1", "4 5 6 7", "0 1 5 4", "1 2 6 5", "2 3 7 6", "3 0 4 7"]
        self.path("quads.off").write_text(
            "OFF\n8 6 0\n" + "".join("%d %d %d\n" % point for point in points) +
            "".join(f"4 {face}\n" for face in faces))
        done = self.run_check("quads.off", "--strict", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        [said] = json.loads(done.stdout)["surfaces"]
        self.assertEqual((said["triangles"], said["volumeMm3"], said["areaMm2"]), (12, 729, 486))
        self.assertEqual(done.stderr, "adaptiso-check: note: quads.off: 6 polygons were cut into "
                         "12 triangles\n")

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
        examples = [e for e in said["examples"] if e["defect"] == "crossing"]
        self.assertEqual([e["triangle"] for e in examples], [a for a, _ in crossings["pairs"]][:10])
        self.assertIn(examples[0]["pointMm"][2], (0, 100))
        self.assertIn({"name": "noSelfIntersections", "text": "no self-intersection"},
                      [{key: check[key] for key in ("name", "text")} for check in said["checks"]])
        few = self.surface(together(cube((0, 0, 0), (100, 100, 100)), bar), "--max-pairs", 1)
        self.assertEqual(few["selfIntersections"]["pairCount"], crossings["pairCount"])
        self.assertEqual(few["selfIntersections"]["pairs"], crossings["pairs"][:1])

    def test_thousands_that_all_intersect_are_counted_up_to_a_limit(self):
        """Triangles through one point, and one vertex of as many triangles that do not cross."""
        points, triangles = [], []
        for n in range(6000):
            a, b = 2 * math.pi * n * 0.618034, math.acos(1 - 2 * ((n * 0.7548777) % 1))
            u = (math.cos(a) * math.sin(b), math.sin(a) * math.sin(b), math.cos(b))
            v = (-math.sin(a), math.cos(a), 0)
            points += [tuple(50 * x for x in u), tuple(50 * x for x in v),
                       tuple(-50 * (x + y) for x, y in zip(u, v))]
            triangles.append((3 * n, 3 * n + 1, 3 * n + 2))
        said = self.surface((points, triangles))
        self.assertFalse(said["selfIntersections"]["isComplete"])
        self.assertGreater(said["selfIntersections"]["pairCount"], 100000)
        self.assertRegex(finding(said, "noSelfIntersections"),
                         r"^more than [\d,]+00,000 pairs of triangles cross; first: triangles ")
        self.assertIn("noSelfIntersections", said["failed"])

        rim = [(50 * math.cos(2 * math.pi * n / 6000), 50 * math.sin(2 * math.pi * n / 6000), 0)
               for n in range(6000)]
        triangles = [t for n in range(6000)
                     for t in ((0, 2 + n, 2 + (n + 1) % 6000), (1, 2 + (n + 1) % 6000, 2 + n))]
        said = self.surface(([(0, 0, 50), (0, 0, -50)] + rim, triangles))
        self.assertEqual((said["selfIntersections"], said["failed"]),
                         ({"pairCount": 0, "isComplete": True, "pairs": []}, []))

    def test_limits_as_large_as_the_surface_are_a_warning(self):
        self.write("metres.off", icosphere(0.1))
        said = self.check("metres.off", "--min-wall", 0.8)
        self.assertIn("bound-over-size", [w["code"] for w in said["warnings"]])

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
        done = self.run_check("--nested", "inner.off", "outer.off", "--min-gap", "10.1")
        self.assertIn("adaptiso-mend outer.off --around inner.off --gap 10.1 -o mended-outer.off\n", done.stdout)

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
            self.assertEqual(required, {row[0]: row[1 + column] == "x" for row in rows
                                        if row[0] != "minWall" or profile == "print"})

    def test_default_is_print_and_nested_bem(self):
        self.write_model(good())
        self.assertEqual(self.check(NAMES[0])["options"]["profile"], "print")
        self.assertEqual(self.check("--nested", *NAMES)["options"]["profile"], "bem")

    def test_a_surface_of_a_micro_ct_fails_as_a_head_or_a_print_alone(self):
        for profile, verdict in (((), (True, "undecided")), (("--profile", "print"), (False, "failed")),
                                 (("--profile", "bem"), (False, "failed"))):
            said = self.surface(icosphere(0.015), *profile)  # mm
            self.assertEqual((said["passed"], outcome(said, "plausibleSize")), verdict)
        self.write("small.off", icosphere(0.08))  # a head in metres
        notes = self.check("small.off", "--strict")["warnings"]
        self.assertEqual([note["code"] for note in notes], ["size-doubtful"])
        self.assertIn("or in metres", notes[0]["text"])

    def test_handle_may_be_printed_and_a_hole_viewed(self):
        said = self.surface(with_handle(icosphere(80)))
        self.assertEqual((said["passed"], outcome(said, "genusZero")), (True, "failed"))
        points, triangles = icosphere(80)
        said = self.surface((points, triangles[1:]), "--profile", "view")
        self.assertEqual((said["passed"], outcome(said, "closed"), outcome(said, "outward")),
                         (True, "failed", "undecided"))

    def test_walls_are_measured_for_a_printer(self):
        shell = together(cube((0, 0, 0), (30, 20, 10)), flipped(cube((2, 2, 0.5), (28, 18, 8))))
        self.write("shell.off", shell)
        thin = self.check("shell.off", "--profile", "print", "--report", "page.html")
        walls = thin["surfaces"][0]["walls"]
        self.assertAlmostEqual(walls["leastMm"], 0.5)
        self.assertIn(walls["pointMm"][2], (0, 0.5))
        self.assertGreaterEqual(walls["thinAreaMm2"], 26 * 16)
        self.assertEqual((thin["passed"], thin["options"]["minWallMm"], outcome(thin["surfaces"][0], "minWall"),
                          [warning["code"] for warning in thin["warnings"]]), (True, 0.8, "failed", ["thin-walls"]))
        to_print = "30 x 20 x 10 mm, 2 shells, 0 handles, thinnest wall 0.50 mm"
        self.assertIn(to_print, self.path("page.html").read_text())
        # a wall that is thick enough has its place too
        self.check("shell.off", "--profile", "print", "--min-wall", 0.4, "--report", "thick.html")
        self.assertIn('data-spot="1">thinnest wall, 0.50 mm, in shell.off</button>', self.path("thick.html").read_text())
        text = self.run_check("shell.off", "--profile", "print").stdout
        self.assertIn("  to print: " + to_print, text)
        self.assertIn("adaptiso-mend --largest --fill-cavities leaves one", text)
        self.assertNotIn("angle", text.replace("triangle", ""))  # nor MNE's
        self.assertEqual(self.surface(shell, "--min-wall", 0.4, "--profile", "view")["failed"], [])
        self.assertEqual(self.surface(shell, "--min-wall", 0.6)["failed"], ["minWall"])
        self.assertIsNone(self.surface(shell)["walls"])  # not asked for
        points, triangles = shell
        hole = self.surface((points, triangles[1:]), "--min-wall", 0.6, "--profile", "view")
        self.assertEqual(outcome(hole, "minWall"), "failed")
        self.assertEqual(hole["failed"], ["minWall"])

    def test_min_angle_is_required_where_given(self):
        half = cube((0, 0, 0), (60, 60, 60))
        self.assertEqual(self.surface(half, "--min-angle", 44)["failed"], [])
        self.assertEqual(self.surface(half, "--min-angle", 46)["failed"], ["minAngle"])


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


LISTS = re.compile(r"(surfaces|plausibility|nesting\.pairs|\.checks|\.examples|\.components)$")
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
        report = self.check("--nested", "a.off", "b.off", "--volume", "ball.nii", "--iso", "100", "--min-wall", "1")
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
            results.append((report, [line for line in text.splitlines() if " s (" not in line]))
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
