"""adaptiso-mend: broken meshes with known solids, what is refused, frames, values, reports and the README."""

import json
import math
import os
import re
import struct
import subprocess

from support import BAD_INPUT, BIN, CHECK_FAILED, OK, SOURCE, USAGE, lines, main
from headDefects import cube, flipped, icosphere, soup
from checkSupport import together, write_stl
from compareSupport import LPS
from simplifySupport import SimplifyTest, documented_keys, keys_of, ply, write_pial, read_pial

MEND = str(BIN / "adaptiso-mend")
README = SOURCE / "Applications" / "adaptiso-mend" / "README.md"
BALL = icosphere(40)


def shifted(mesh, by):
    return [(x + by, y, z) for x, y, z in mesh[0]], mesh[1]


def cup(mesh, height):
    """Without what lies above."""
    points, triangles = mesh
    return points, [t for t in triangles if max(points[v][2] for v in t) < height]


def ring(radius=30, tube=10, steps=36, around=16):
    """A torus: genus 1."""
    points = [((radius + tube * math.cos(b)) * math.cos(a), (radius + tube * math.cos(b)) * math.sin(a),
               tube * math.sin(b)) for a in (2 * math.pi * i / steps for i in range(steps))
              for b in (2 * math.pi * j / around for j in range(around))]
    def at(i, j): return i % steps * around + j % around
    triangles = []
    for i in range(steps):
        for j in range(around):
            triangles += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    return points, triangles


class MendTest(SimplifyTest):
    def run_mend(self, *arguments):
        return subprocess.run([MEND, *map(str, arguments)], cwd=self.folder, text=True,
                              capture_output=True, timeout=300)

    def mend(self, *arguments, code=OK):
        """The report of a run, without a word on stderr but warnings and its error."""
        done = self.run_mend(*arguments, "--json", "-")
        self.assertEqual(done.returncode, code, done.stderr)
        report = json.loads(done.stdout)
        said = [f"warning: {warning}" for warning in lines(report["warnings"])]
        said += [report["error"]["text"]] if report["error"] else []
        self.assertEqual(done.stderr, "".join(f"adaptiso-mend: {line}\n" for line in said))
        return report

    def mended(self, mesh, *arguments, name="out.vtp"):
        """The report; what was written passes every check of a solid."""
        self.write("in.off", mesh)
        report = self.mend("in.off", *arguments, "-o", name)
        self.assertTrue(report["output"]["written"])
        checked = self.check(name)
        self.assertTrue(checked["passed"], checked["surfaces"][0]["failed"])
        return report, checked["surfaces"][0]

    def stays_out(self, code, pattern, *arguments):
        before = self.contents()
        done = self.run_mend(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, "^adaptiso-mend: " + pattern + ".*\n$")
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertEqual(self.contents(), before)


class Solids(MendTest):
    def test_crossing_balls_become_their_union(self):
        """Two balls of radius r at a distance d: their lens has the volume
        pi (4 r + d) (2 r - d)^2 / 12."""
        report, checked = self.mended(together(BALL, shifted(icosphere(40), 30)), "--max-error", 1)
        self.assertGreater(report["found"]["crossingTriangles"], 0)
        r, d = 40, 30
        union = 2 * 4 / 3 * math.pi * r ** 3 - math.pi * (4 * r + d) * (2 * r - d) ** 2 / 12
        # 1280 triangles enclose 1 % less than their ball; the bound is 1 mm of an area of 34,000 mm2
        self.assertAlmostEqual(checked["volumeMm3"] / union, 0.99, delta=0.02)
        self.assertEqual((report["output"]["genus"], report["output"]["components"]), (0, 1))
        self.assertEqual(len(report["output"]["inner"]), 2)
        self.assertLessEqual(max(report["output"]["resultToInputMm"],
                                 report["output"]["inputToResultMm"]), 1)

    def test_a_small_hole_is_closed_and_told(self):
        points, triangles = BALL
        report, checked = self.mended((points, triangles[1:]), "--max-hole", 20)
        self.assertEqual(report["found"]["borderEdges"], 3)
        [hole] = report["output"]["filled"]
        middle = [sum(points[v][axis] for v in triangles[0]) / 3 for axis in range(3)]
        middle = [-middle[0], -middle[1], middle[2]] if report["input"]["coordinates"] == "lps" else middle
        self.assertLess(math.dist(hole["middleMm"], middle), 2)
        self.assertEqual(checked["genus"], 0)

    def test_triangles_that_share_no_vertices_and_flipped_ones(self):
        report, checked = self.mended(soup(BALL))
        self.assertEqual((checked["vertices"], checked["triangles"]), (642, 1280))
        self.assertGreater(report["found"]["mergedPoints"], 0)
        report, checked = self.mended(flipped(BALL))
        self.assertEqual(report["found"]["flippedTriangles"], 1280)
        self.assertGreater(checked["volumeMm3"], 0)

    def test_an_inner_shell_is_dropped_and_told(self):
        report, checked = self.mended(together(BALL, icosphere(20)))
        self.assertEqual(checked["componentCount"], 1)
        [inner] = report["output"]["inner"]
        self.assertAlmostEqual(inner["areaMm2"], 4 * math.pi * 400, delta=60)


class Broken(MendTest):
    def test_triangles_that_name_no_point_are_dropped(self):
        points, triangles = BALL
        lost = sum(5 in t for t in triangles)
        hole = ("--max-hole", 30)
        for mesh, dropped in (((points[:5] + [(math.nan, 0, 0)] + points[6:], triangles), lost),
                              ((points, triangles[:-1] + [(0, 1, 9999)]), 1), ((points + [(math.inf, 0, 0)], triangles), 0)):
            report, checked = self.mended(mesh, "--max-error", 1, *hole)
            self.assertEqual(report["found"]["brokenTriangles"], dropped)
            self.assertEqual(report["input"]["triangles"], len(triangles) - dropped)
            self.assertEqual(report["output"]["copied"], False)
            self.assertEqual(checked["defects"]["unusedVertex"], 0)
        self.write("nan.off", ([(math.nan, 0, 0)] * len(points), triangles))
        done = self.run_mend("nan.off", "-o", "out.off")
        self.assertEqual((done.returncode, self.path("out.off").exists()), (BAD_INPUT, False))
        self.assertIn("nan.off: its triangles have no area", done.stderr)


class Sound(MendTest):
    def test_keeps_its_bytes(self):
        self.write("ball.off", BALL)
        report = self.mend("ball.off", "-o", "same.off")
        self.assertEqual((report["found"]["sound"], report["output"]["copied"]), (True, True))
        self.assertEqual(self.path("same.off").read_bytes(), self.path("ball.off").read_bytes())
        write_pial(self.path("lh.pial"), BALL)
        self.mend("lh.pial", "-o", "rh.pial")
        self.assertEqual(self.path("rh.pial").read_bytes(), self.path("lh.pial").read_bytes())

    def test_is_written_in_another_format_and_frame(self):
        self.write("ball.off", BALL)
        report = self.mend("ball.off", "-o", "ball.ply")
        self.assertEqual((report["found"]["sound"], report["output"]["copied"]), (True, False))
        report = self.mend("ball.off", "--coordinates", "lps", "-o", "lps.off")
        self.assertFalse(report["output"]["copied"])
        self.assertEqual(report["output"]["coordinates"], "lps")
        self.assertLess(self.compare("ball.off", "lps.off")["maxMm"], 1e-6)

    def test_of_tkras_keeps_its_volume(self):
        points, triangles = BALL
        write_pial(self.path("lh.pial"), (points, triangles[1:]))
        self.mend("lh.pial", "--max-hole", 20, "--max-error", 0.5, "-o", "rh.pial")
        footer = read_pial(self.path("rh.pial"))[2]
        self.assertIn(b"valid = 1", footer)
        self.assertNotIn(b"doe_jane", footer)


class Values(MendTest):
    def test_come_from_the_nearest_place(self):
        """A height is linear on every triangle: where the surface is kept it stays the height."""
        points, triangles = soup(BALL)
        file = ply((points, triangles), "property double height", [(p[2],) for p in points])
        self.path("in.ply").write_text(file)
        report = self.mend("in.ply", "-o", "out.ply")
        self.assertEqual(report["output"]["values"], ["height"])
        report = self.mend("in.ply", "-o", "out.stl")
        self.assertEqual([warning["code"] for warning in report["warnings"]], ["array-left-out"])
        self.mend("out.ply", "--dry-run")


class Balls(MendTest):
    def test_a_ring_is_cut_across(self):
        self.write("ring.off", ring())
        report = self.mend("ring.off", "--ball", "-o", "ball.off")
        self.assertEqual((report["input"]["genus"], report["output"]["genus"]), (1, 0))
        self.assertEqual((report["found"]["handles"], report["output"]["filledHandles"]), (1, []))
        cut, = report["output"]["cutHandles"]
        self.assertAlmostEqual(cut["areaMm2"], 8 * 100 * math.sin(math.pi / 8), delta=2)  # of 16 corners, on a chord of 36
        self.assertAlmostEqual(math.hypot(*cut["middleMm"]), 30, delta=1)
        self.assertGreater(report["output"]["verification"]["samples"], 0)
        self.assertIn("1 handle cut, ", self.run_mend("ring.off", "--ball", "--dry-run").stdout)
        self.assertTrue(self.check("ball.off")["passed"])
        again = self.mend("ball.off", "--ball", "-o", "again.off")
        self.assertTrue(again["found"]["sound"] and again["output"]["copied"])

    def test_a_handle_thinner_than_the_bound_is_cut(self):
        """Both caps of a cut, 0.8 times the bound apart, lie off the rest of the proof."""
        self.write("wire.off", ring(30, 0.5, 144, 8))
        report = self.mend("wire.off", "--ball", "--max-error", 2, "-o", "ball.off")
        self.assertEqual((len(report["output"]["cutHandles"]), report["output"]["genus"]), (1, 0))
        self.assertTrue(self.check("ball.off")["passed"])

    def test_takes_closed_surfaces(self):
        self.stays_out(USAGE, "--ball takes closed surfaces", "ring.off", "--ball", "--open", "-o", "out.off")


class Around(MendTest):
    def test_two_crossing_shells_lie_apart_by_the_gap(self):
        """A ball of radius 30 shifted by 9, and one of 40 about the origin: they are 1 apart on one side."""
        self.write("inner.off", shifted(icosphere(30), 9))
        self.write("outer.off", BALL)
        fixed = self.path("inner.off").read_bytes()
        report = self.mend("outer.off", "--around", "inner.off", "--gap", 2, "-o", "around.off")
        self.assertEqual((report["found"]["sound"], report["output"]["copied"]), (True, False))
        self.assertIn("1,280 triangles of the input kept, then moved",
                      self.run_mend("outer.off", "--around", "inner.off", "--gap", 2, "--dry-run").stdout)
        around = report["output"]["around"]
        self.assertEqual((around["file"], self.path("inner.off").read_bytes()), ("inner.off", fixed))
        self.assertTrue(2 <= around["gapMm"] < 2.1, around)
        self.assertTrue(0.9 < around["largestMoveMm"] < 2, around)
        # all that separates the two is the move, and the digits of the file
        self.assertAlmostEqual(report["output"]["resultToInputMm"], around["largestMoveMm"], delta=1e-3)
        self.assertTrue(report["output"]["verification"]["maxMm"] <= report["output"]["inputToResultMm"])
        self.assertTrue(self.check("around.off")["passed"])
        nested = self.check("inner.off", "around.off", "--nested")
        self.assertTrue(nested["passed"], nested)
        again = self.mend("around.off", "--around", "inner.off", "--gap", 2, "-o", "again.off")
        self.assertEqual((again["output"]["copied"], again["output"]["around"]["movedVertices"]), (True, 0))

    def test_a_stated_frame_is_of_the_mesh_alone(self):
        """FIXED says LPS: to the right of the middle in RAS, where the mesh is pushed out."""
        self.write("inner.off", shifted(icosphere(30), 9), LPS)
        self.write("outer.off", BALL)
        arguments = ("outer.off", "--around", "inner.off", "--gap", 2, "--input-coordinates", "ras", "-o")
        self.mend(*arguments, "out.vtp")
        self.mend("outer.off", "--around", "inner.off", "--gap", 2, "-o", "own.vtp")
        self.assertEqual(self.path("out.vtp").read_bytes(), self.path("own.vtp").read_bytes())

    def test_values_are_those_of_where_a_point_was(self):
        self.write("inner.off", shifted(icosphere(30), 9))
        self.path("in.ply").write_text(ply(BALL, "property double height", [(p[0],) for p in BALL[0]]))
        self.mend("in.ply", "--around", "inner.off", "--gap", 2, "-o", "out.ply", "--input-coordinates", "ras",
                  "--input-coordinates", "ras")
        header, _, body = self.path("out.ply").read_bytes().partition(b"end_header\n")
        kinds = [{b"float": "f", b"double": "d"}[kind] for kind in re.findall(rb"property (float|double) ", header)]
        self.assertEqual(len(kinds), 4)
        rows = struct.iter_unpack("<" + "".join(kinds), body[:struct.calcsize("<" + "".join(kinds)) * len(BALL[0])])
        self.assertEqual([row[3] for row in rows], [p[0] for p in BALL[0]])

    def test_what_can_not_lie_around(self):
        self.write("ball.off", BALL)
        self.write("apart.off", shifted(icosphere(10), 200))
        self.write("two.off", together(icosphere(5), shifted(icosphere(5), 20)))
        given = ("ball.off", "-o", "out.off")
        self.stays_out(CHECK_FAILED, "ball.off: can't be mended as asked: --around apart.off: they are apart",
                       *given, "--around", "apart.off", "--gap", 2)
        self.stays_out(BAD_INPUT, "two.off: --around takes a closed, .*; mend it first", *given, "--around", "two.off",
                       "--gap", 1)
        self.stays_out(CHECK_FAILED, ".* the surface to move is not closed, or in pieces", "two.off", "-o", "out.off",
                       "--around", "ball.off", "--gap", 1)
        for more in (("--gap", 2), ("--around", "apart.off")):
            self.stays_out(USAGE, "--around FIXED, --gap MM: each needs the other", *given, *more)
        self.stays_out(USAGE, "--around takes closed surfaces", *given, "--around", "apart.off", "--gap", 2, "--open")


class Refusals(MendTest):
    def test_what_can_not_be_mended_as_asked(self):
        self.write("cup.off", cup(BALL, 20))
        self.stays_out(CHECK_FAILED, "cup.off: can't be mended as asked: a hole near .* more than "
                       "--max-hole, 6.39 mm", "cup.off", "--max-error", 1, "-o", "out.off")
        report = self.mend("cup.off", "--max-error", 1, "-o", "out.off", code=CHECK_FAILED)
        self.assertEqual((report["passed"], report["output"], report["found"]["sound"]), (False, None, False))
        self.assertIn(f"; found: {report['found']['borderEdges']} open border edges; a larger --max-hole closes it",
                      report["error"]["text"])
        report = self.mend("cup.off", "--max-error", 1, "--open", "-o", "open.off")
        self.assertEqual((len(report["output"]["leftOpen"]), report["output"]["closed"]), (1, False))
        self.mend("cup.off", "--max-error", 1, "--max-hole", 120, "-o", "closed.off")
        self.assertTrue(self.check("closed.off")["passed"])

    def test_the_command_of_adaptiso_check_closes_a_wide_hole(self):
        for name, mesh, width in (("cup.off", cup(BALL, 20), r" --max-hole 75"),
                                  ("chip.off", (BALL[0], BALL[1][1:]), "")):
            self.write(name, mesh)
            done = subprocess.run([BIN / "adaptiso-check", name], cwd=self.folder, text=True, capture_output=True)
            command = re.search(rf"adaptiso-mend {name}{width} -o mended-{name}$", done.stdout, re.MULTILINE)
            self.assertTrue(command, done.stdout)
            self.mend(*command[0].split()[1:])
            self.assertTrue(self.check(f"mended-{name}")["passed"])

    def test_crumbs_are_left_out_as_adaptiso_check_advises(self):
        self.write("crumbs.off", together(BALL, shifted(icosphere(2), 60)))
        done = subprocess.run([BIN / "adaptiso-check", "crumbs.off", "--profile", "print"], cwd=self.folder, text=True,
                              capture_output=True)
        self.assertIn("each is printed: adaptiso-mend --largest --fill-cavities leaves one", done.stdout)
        report = self.mend("crumbs.off", "--largest", "--fill-cavities", "-o", "ball.off")
        self.assertEqual((report["output"]["components"], report["output"]["triangles"]), (1, len(BALL[1])))
        [piece] = report["output"]["droppedPieces"]
        self.assertAlmostEqual(piece["middleMm"][0], 60 if report["input"]["coordinates"] == "ras" else -60, delta=0.1)
        self.stays_out(CHECK_FAILED, "crumbs.off: can't be mended as asked: no piece has --min-volume of material",
                       "crumbs.off", "--min-volume", 1e7, "-o", "none.off")

    def test_a_sheet_that_is_dropped_is_warned_of(self):
        square = [(50, 0, 0), (90, 0, 0), (90, 40, 0), (50, 40, 0)]
        sheet = square + square, [(0, 1, 2), (0, 2, 3), (6, 5, 4), (7, 6, 4)]  # both its sides
        for size, codes in ((10, ["parts-dropped"]), (200, [])):
            self.write("both.off", together(cube((-size, 0, 0), (0, size, size)), sheet))
            report = self.mend("both.off", "--max-error", 0.1, "-o", "out.off")
            self.assertEqual([each["code"] for each in report["warnings"]], codes)
            self.assertAlmostEqual(report["output"]["areaMm2"], 6 * size * size, 3)
        self.write("both.off", together(cube((-10, 0, 0), (0, 10, 10)), sheet))
        done = self.run_mend("both.off", "--strict", "-o", "strict.off")
        self.assertEqual((done.returncode, self.path("strict.off").exists()), (CHECK_FAILED, False), done.stderr)

    def test_boxes_that_share_an_edge_by_place_are_none_in_stl(self):
        self.write("touch.off", together(cube((0, 0, 0), (1, 1, 1)), cube((1, 1, 0), (2, 2, 1))))
        self.mend("touch.off", "-o", "same.off")
        self.stays_out(BAD_INPUT, "out.stl: STL joins points .* no oriented 2-manifold; write .vtp or .ply",
                       "touch.off", "-o", "out.stl")

    def test_usage_and_bad_input(self):
        self.write("ball.off", BALL)
        self.path("out").mkdir()
        for output, file in (((), "ball-mended.off"), (("-o", "out"), "out/ball.off")):
            self.mend("ball.off", *output)
            self.assertTrue(self.path(file).exists(), file)
        self.stays_out(USAGE, "MESH is missing")
        self.stays_out(USAGE, "--max-error", "ball.off", "--max-error", 0, "-o", "out.off")
        self.stays_out(BAD_INPUT, "", "none.off", "-o", "out.off")
        self.stays_out(BAD_INPUT, "", "ball.off", "-o", "ball.off")
        self.write("flat.off", ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]))
        self.stays_out(BAD_INPUT, "flat.off: its triangles have no area", "flat.off", "-o", "out.off")
        self.write("voxel.off", BALL, "voxel indices")
        self.stays_out(BAD_INPUT, "voxel.off: is in voxel indices", "voxel.off", "-o", "out.off")


class Reports(MendTest):
    def test_keys_are_the_documented_ones(self):
        self.write("two.off", together(BALL, shifted(BALL, 30)))
        self.write("inner.off", icosphere(20))
        report = self.mend("two.off", "--max-error", 1, "--around", "inner.off", "--gap", 1, "-o", "out.vtp")
        self.assertEqual(report["schema"], "adaptiso-mend/1")
        self.assertEqual(keys_of(report), documented_keys(README))

    def test_a_dry_run_writes_nothing_and_says_the_same(self):
        self.write("two.off", together(BALL, shifted(BALL, 30)))
        before = self.contents()
        planned = self.mend("two.off", "--max-error", 1, "--dry-run", "-o", "out.vtp")
        self.assertEqual(self.contents(), before)
        self.assertFalse(planned["output"]["written"])
        done = self.mend("two.off", "--max-error", 1, "-o", "out.vtp")
        for key in ("triangles", "keptTriangles", "inner", "resultToInputMm"):
            self.assertEqual(planned["output"][key], done["output"][key], key)

    def test_a_page_shows_what_was_changed(self):
        points, triangles = BALL
        self.write("holed.off", (points, triangles[1:]))
        self.write("cup.off", cup(BALL, 20))
        self.mend("holed.off", "-o", "out.off", "--report", "out.html", "--pictures", "pictures")
        page = self.path("out.html").read_text()
        for words in ("PASSED", "holed.off mended", "3 open border edges", "hole closed, ", "not crossing itself"):
            self.assertIn(words, page)
        self.assertTrue(list(self.path("pictures").glob("*.png")))
        self.mend("cup.off", "--dry-run", "--report", "cup.html", code=CHECK_FAILED)
        page = self.path("cup.html").read_text()
        for words in ("FAILED", "Not mended: a hole near", "more than --max-hole"):
            self.assertIn(words, page)

    def test_many_are_runs_of_their_own(self):
        for name, mesh in (("two", together(BALL, shifted(BALL, 30))), ("cup", cup(BALL, 20)), ("ball", BALL)):
            self.write(f"{name}.off", mesh)
        names = ("two.off", "cup.off", "ball.off", "--max-error", 1)
        done = self.run_mend(*names, "-o", "out/")
        self.assertEqual(done.returncode, CHECK_FAILED)
        for line in (r"^done +two\.off: mended: \d+", r"^FAILED +cup\.off: can't be mended as asked: a hole near \(0, ",
                     r"^done +ball\.off: is sound", "^3 inputs, 1 failed$"):
            self.assertRegex(done.stdout, re.compile(line, re.M))
        self.assertEqual({path.name for path in self.path("out").glob("*.off")}, {"two.off", "ball.off"})
        self.assertIn("--output-dir out --skip-existing", self.path("out/summary.html").read_text())
        self.mend("two.off", "--max-error", 1, "-o", "one.off")
        self.assertEqual(self.path("one.off").read_bytes(), self.path("out/two.off").read_bytes())
        before = self.contents()
        for output in ((), ("-o", "out/"), ("-o", "new/")):
            self.assertEqual(self.run_mend(*names, "--dry-run", *output).returncode, CHECK_FAILED)
            self.assertEqual(self.contents(), before)
        self.stays_out(USAGE, "--output is missing", *names)

    def test_is_the_same_whatever_the_number_of_threads(self):
        self.write("two.off", together(BALL, shifted(BALL, 30)))
        for threads in (1, 3):
            self.mend("two.off", "--max-error", 1, "--threads", threads, "-o", f"{threads}.ply")
        self.assertEqual(self.path("1.ply").read_bytes(), self.path("3.ply").read_bytes())


class Readme(MendTest):
    def test_examples_run(self):
        small = icosphere(40, 2)
        write_stl(self.path("two.stl"), together(small, shifted(small, 30)))
        self.write("cup.off", cup(small, 20))
        self.write("ring.off", ring())
        self.path("in.ply").write_text(ply(soup(small), "property double height",
                                           [(p[2],) for p in soup(small)[0]]))
        self.mend("in.ply", "-o", "heights.vtp")
        self.path("in.ply").unlink()
        self.write("inner.off", shifted(icosphere(30), 9))
        self.write("outer.off", BALL)
        given = set(self.names())
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, "the hole is wider\n"), done.stderr)
        self.assertEqual(set(self.names()) - given, {"one.stl", "plan.json", "mended.vtp",
                                                     "closed.off", "open.off", "ball.off", "around.off",
                                                     "mended.html", "mended"})
        self.assertEqual({path.name for path in self.path("mended").glob("[!.]*")} & {"two.stl", "ring.off"},
                         {"two.stl", "ring.off"})


if __name__ == "__main__":
    main()
