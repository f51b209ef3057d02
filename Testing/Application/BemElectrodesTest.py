"""Electrodes and landmarks of adaptiso-bem: formats, frames, projection, positions, refusals."""

import json
import math
import os
import re
import signal
import subprocess
import time
from pathlib import Path

from support import BAD_INPUT, USAGE, main
from bemSupport import BEM, RADII, BemTest, read_tri

SKIN = RADII[-1]
LANDMARKS = ("--nasion", f"0,{SKIN},0", f"--left-ear=-{SKIN},0,0", "--right-ear", f"{SKIN},0,0")
# the phantom's voxels are of 4 mm, and chords of 19 mm lie up to 0.6 mm inside of its skin
NEAR = 2.6


def directions():
    return {"Cz": (0, 0, 1), "C3": (-0.6, 0, 0.8), "Fz": (0, 0.6, 0.8), "O2": (0.28, -0.96, 0)}


class Electrodes(BemTest):
    def table(self, folder="model"):
        rows = (self.path(folder) / "electrodes.tsv").read_text().splitlines()
        self.assertEqual(rows[0], "name\tx\ty\tz")
        cells = [row.split("\t") for row in rows[1:]]
        return {row[0]: tuple(map(float, row[1:])) for row in cells}

    def write_bids(self, scale=1.0, system="ScanRAS", unit="mm", landmarks=None):
        lines = ["name\tx\ty\tz\ttype"]
        for name, d in directions().items():
            lines.append("\t".join([name, *(str(scale * 80 * v) for v in d), "cup"]))
        self.path("sub-1_electrodes.tsv").write_text("\n".join([*lines, "EOG\tn/a\tn/a\tn/a\tcup", ""]))
        system = {"EEGCoordinateSystem": system, "EEGCoordinateUnits": unit}
        if landmarks:
            system["AnatomicalLandmarkCoordinates"] = landmarks
        self.path("sub-1_coordsystem.json").write_text(json.dumps(system))

    def assert_on_skin(self, table):
        for name, d in directions().items():
            self.assertLess(math.dist(table[name], [SKIN * v for v in d]), NEAR, name)

    def test_bids_electrodes_are_moved_onto_the_skin(self):
        self.write_bids(scale=0.1, unit="cm")
        done = self.bem(*self.labels(), "--electrodes", "sub-1_electrodes.tsv", "-o", "model")
        self.assert_on_skin(self.table())
        report = self.report()
        self.assertEqual([p["name"] for p in report["electrodes"]["points"]], list(directions()))
        self.assertFalse(report["electrodes"]["computed"])
        # 80 mm from the middle, the skin at 72
        self.assertAlmostEqual(report["electrodes"]["farthestMovedMm"], 8, delta=NEAR)
        self.assertRegex(done.stdout, r"4 moved onto the skin, by \d+\.\d mm on average, the farthest")
        self.assertIsNone(report["landmarks"])
        self.assertIn("ScanRAS", (self.path("model") / "coordsystem.json").read_text())
        lines = (self.path("model") / "electrodes.txt").read_text().splitlines()
        for line, place in zip(lines, self.table().values(), strict=True):
            self.assertLess(math.dist(tuple(map(float, line.split())), place), 1e-5)

    def test_electrodes_without_a_place_are_left_out_with_a_warning(self):
        self.write_bids()
        path = self.path("sub-1_electrodes.tsv")
        rows = path.read_text().replace("EOG\tn/a\tn/a\tn/a", "EOG\tNaN\t\tn/a")
        path.write_text(rows + "ECG\t\t\t\tcup\n", encoding="utf-8-sig", newline="\r\n")
        done = self.bem(*self.labels(), "--electrodes", "sub-1_electrodes.tsv", "-o", "model")
        self.assertRegex(done.stderr, r"sub-1_electrodes.tsv: 2 of its \d+ points have no place and "
                                      r"were left out: EOG, ECG")
        self.assertEqual(set(self.table()), set(directions()))
        self.assertEqual([w["code"] for w in self.report()["warnings"]], ["electrodes-left-out"])
        path.write_text(rows + next(row for row in rows.splitlines()[1:]) + "\n")
        self.fails(BAD_INPUT, "two of its points have the name '.*'; rename or remove one",
                   *self.labels(), "--electrodes", "sub-1_electrodes.tsv", "-o", "m")

    def test_what_was_written_is_read_again(self):
        self.write_bids()
        self.bem(*self.labels(), "--electrodes", "sub-1_electrodes.tsv", *LANDMARKS, "-o", "model")
        expected = self.table()
        for name in ("electrodes.tsv", "electrodes.elc", "electrodes.sfp", "electrodes-dig.fif"):
            with self.subTest(name):
                frame = () if name.endswith((".tsv", ".fif")) else ("--electrodes-in", "ras")
                self.bem(*self.labels(), "--electrodes", f"model/{name}", *frame, "-o", "again",
                         "--force")
                again = self.table("again")
                for a, b in zip(expected.values(), again.values()):
                    self.assertLess(math.dist(a, b), 0.01)  # on the skin already
                origin = self.report("again")["landmarks"]
                self.assertEqual(origin["origin"], "file")
                self.assertLess(math.dist(origin["nasionMm"], (0, -SKIN, 0)), 0.01)  # LPS

    def test_a_cap_that_is_moved_far_is_a_warning(self):
        for off, is_far in ((8, False), (15, True)):
            self.write_bids(scale=(SKIN + off) / 80)
            self.bem(*self.labels(), "--electrodes", "sub-1_electrodes.tsv", "-o", "model", "--force")
            report = self.report()
            self.assertAlmostEqual(report["electrodes"]["meanMovedMm"], off, delta=1.5)
            self.assertEqual("cap-moved-far" in [w["code"] for w in report["warnings"]], is_far)

    def test_a_frame_of_its_own_follows_from_landmarks(self):
        # CTF: x to the nose, y to the left; cm; no unit is said
        lines = [f"FidNz {SKIN / 10} 0 0", f"FidT9 0 {SKIN / 10} 0", f"FidT10 0 -{SKIN / 10} 0"]
        for name, (x, y, z) in directions().items():
            lines.append(f"{name} {8 * y} {-8 * x} {8 * z}")
        self.path("cap.sfp").write_text("\n".join(lines) + "\n")
        done = self.bem(*self.labels(), "--electrodes", "cap.sfp", *LANDMARKS, "-o", "model")
        self.assert_on_skin(self.table())
        self.assertIn("cap.sfp: does not say its unit; taken for cm", done.stderr)
        self.assertEqual([note for note in self.report()["notes"] if note.startswith("landmarks")],
                         ["landmarks: those given are kept; the file's lie off: nasion by 0.0 mm, left ear by 0.0 mm, right ear by 0.0 mm"])

    def test_directions_are_taken_for_a_sphere(self):
        nasion, left, right = "1 0 .5 Nz\n", "2 -90 .5 LPA\n", "3 90 .5 RPA\n"
        self.path("cap.loc").write_text(nasion + left + right + "4 0 0 Cz\n5 -90 .2048 C3\n6 0 .2048 Fz\n7 163.74 .5 O2\n")
        done = self.bem(*self.labels(), "--electrodes", "cap.loc", *LANDMARKS, "-o", "model")
        self.assert_on_skin(self.table())
        self.assertIn("cap.loc: gives directions, not places; taken for a sphere of 95 mm", done.stderr)

    # exchanged ears turn "up" round, as a mirrored axis does; the ball's skin is as near below
    def test_a_cap_below_its_own_nasion_and_ears_is_refused(self):
        lines = [f"Nz 0 {SKIN} 0", f"LPA {SKIN} 0 0", f"RPA -{SKIN} 0 0"]
        for name, (x, y, z) in directions().items():
            lines.append(f"{name} {80 * x} {80 * y} {80 * z}")
        self.path("cap.sfp").write_text("\n".join(lines) + "\n")
        for frame in ((), ("--electrodes-in", "ras")):
            self.fails(BAD_INPUT, r"--electrodes cap.sfp: the electrodes lie \d\d mm below nasion and ears on average",
                       *self.labels(), "--electrodes", "cap.sfp", *frame, *(LANDMARKS if not frame else ()), "-o", "model")

    def test_exchanged_ears_are_refused_without_electrodes_too(self):
        side, low = 0.8 * SKIN, -0.6 * SKIN
        left, right = f"-{side},0,{low}", f"{side},0,{low}"
        landmarks = ["--nasion", f"0,{side},{low}", "--montage", "10-20", "-o", "model"]
        self.bem(*self.labels(), f"--left-ear={left}", f"--right-ear={right}", *landmarks, "--force")
        self.assertGreater(self.table()["Cz"][2], 0)
        self.fails(BAD_INPUT, r"the inner skull's vertices lie \d\d mm below nasion and ears on average",
                   *self.labels(), f"--left-ear={right}", f"--right-ear={left}", *landmarks[:-1], "again")

    def test_names_on_the_wrong_side_are_refused(self):
        """Of 75 mm electrodes were off, without a word; where landmarks are right only names can say it."""
        def write(directions_of, landmarks=True):
            rows = [f"{name} {80 * x} {80 * y} {80 * z}" for name, (x, y, z) in directions_of.items()]
            marks = [f"Nz 0 {SKIN} 0", f"LPA -{SKIN} 0 0", f"RPA {SKIN} 0 0"] if landmarks else []
            self.path("cap.sfp").write_text("\n".join(rows + marks) + "\n")

        def take(*frame, **options):
            return self.bem(*self.labels(), "--electrodes", "cap.sfp", *frame, "-o", "model", "--force", **options)

        right = {**directions(), "C4": (0.6, 0, 0.8), "F7": (-0.8, 0.6, 0)}
        refusal = r"4 of 4 electrodes beside the middle lie on the side that their names exclude.*C3 48 mm to the right"
        mirrored = {name: (-x, y, z) for name, (x, y, z) in right.items()}
        for landmarks, frame in ((True, LANDMARKS), (False, ("--electrodes-in", "ras"))):
            write(right, landmarks)
            self.assertNotIn("exclude", take(*frame).stderr)
            write(mirrored, landmarks)
            self.fails(BAD_INPUT, refusal, *self.labels(), "--electrodes", "cap.sfp", *frame, "-o", "m")
        # turned by half a turn: x and y have the wrong sign, as of LPS taken for RAS
        write({name: (-x, -y, z) for name, (x, y, z) in right.items()}, False)
        self.fails(BAD_INPUT, refusal, *self.labels(), "--electrodes", "cap.sfp", "--electrodes-in", "ras", "-o", "m")
        # with nasion and ears turned too names are right beside these, but these beside the image
        write(right)
        self.assertIn("the left ear lies on the image's right", take("--electrodes-in", "lps").stderr)
        # one of four is a doubt
        write({**right, "C4": right["C3"], "C3": right["C4"], "P3": (-0.6, -0.6, 0.5), "P4": (0.6, -0.6, 0.5), "P8": (0.8, -0.6, 0)})
        self.assertRegex(take(*LANDMARKS).stderr, r"2 of 7 electrodes beside the middle lie on the side that their names "
                                                  r"exclude .*C4 48 mm to the left.*are these names exchanged\?")
        # other names say no side
        write({name + "x": place for name, place in mirrored.items()})
        self.assertNotIn("exclude", take(*LANDMARKS).stderr)

    def test_electrodes_are_as_uncertain_as_guessed_landmarks(self):
        arguments = [*self.labels(), "--montage", "10-20", *LANDMARKS, "-o", "model", "--force"]
        self.assertRegex(self.bem(*arguments).stderr, r"the inion was guessed by nasion and ears, to 20 mm; give it where that "
                                                      r"matters; electrodes may be off by 8 mm on average, Oz by 18 mm")
        points = {p["name"]: p for p in self.report()["electrodes"]["points"]}
        # the inion at 20 mm up or down of 72: Cz moves by half of the arc, Oz by 9 tenths
        arc = SKIN * math.atan(20 / SKIN)
        self.assertAlmostEqual(points["Cz"]["uncertaintyMm"], 0.5 * arc, delta=1)
        self.assertAlmostEqual(points["Oz"]["uncertaintyMm"], 0.9 * arc, delta=1)
        self.assertNotIn("guessed", self.bem(*arguments, f"--inion=0,-{SKIN},0").stderr)
        self.assertEqual(self.report()["electrodes"]["points"][0]["uncertaintyMm"], 0)

    def test_a_frame_that_nothing_tells_is_refused(self):
        self.path("cap.elc").write_text("UnitPosition mm\nPositions\n0 0 80\nLabels\nCz\n")
        missing = ("--t1", "missing.nii", "-o", "model", "--electrodes", "cap.elc")  # refused before the head is read
        self.fails(BAD_INPUT, "--electrodes cap.elc: the file says no coordinate frame.*--electrodes-in ras, lps or tkras",
                   *missing, *LANDMARKS)
        self.path("cap.elc").write_text("UnitPosition mm\nPositions\n0 80 0\nLabels\nNAS\n")
        self.fails(BAD_INPUT, "--electrodes cap.elc: the file holds no electrode", *missing, "--electrodes-in", "ras")

    def test_positions_of_the_systems(self):
        for system, count in (("10-20", 21), ("10-10", 73), ("10-05", 277)):
            self.bem(*self.labels(), "--montage", system, *LANDMARKS, f"--inion=0,-{SKIN},0", "-o", "model", "--force")
            table = self.table()
            self.assertEqual(len(table), count)
            self.assertLess(math.dist(table["Cz"], (0, 0, SKIN)), NEAR)
            s, c = math.sin(math.radians(36)), math.cos(math.radians(36))
            self.assertLess(math.dist(table["C3"], (-SKIN * s, 0, SKIN * c)), 2 * NEAR)
            self.assertLess(math.dist(table["Fz"], (0, SKIN * s, SKIN * c)), 2 * NEAR)
            self.bem(*self.labels(), "--electrodes", "model/electrodes.elc", "--electrodes-in", "ras", "-o", "again", "--force")
        self.assertTrue(self.report()["electrodes"]["computed"])

    def test_guesses_are_told(self):
        arguments = self.labels()
        # a ball has no nose, and its ears are above the image's end: nothing is guessed
        done = self.run_bem(*arguments, "--montage", "10-20", "-o", "model")
        if done.returncode == 0:
            self.assertRegex(done.stderr, r"guessed by the shape of the head: nasion to \d+ mm")
            self.assertGreaterEqual(self.report()["landmarks"]["earUncertaintyMm"], 10)
        else:
            self.assertEqual(done.returncode, BAD_INPUT)
            self.assertIn("positions need nasion and ears", done.stderr)

    def test_brainstorms_coordinates(self):
        self.bem(*self.labels(), "--brainstorm", "--besa", *LANDMARKS, "-o", "model")
        self.assertIn("| Brainstorm | SCS; metres |", (self.path("model") / "README.md").read_text())
        first = (self.path("model") / "head.sfp").read_text().splitlines()[:4]
        self.assertEqual([line.split("\t")[0] for line in first], ["FidNz", "FidT9", "FidT10", "S1"])

    def test_a_page_shows_them(self):
        self.bem(*self.labels(), "--montage", "10-20", *LANDMARKS, "--dry-run", "--report", "page.html")
        page = self.path("page.html").read_text()
        self.assertIn("Electrodes and landmarks", page)
        self.assertIn("T7", page)

    def test_refusals(self):
        labels = self.labels()
        self.write_bids(scale=2)
        self.fails(BAD_INPUT, r"--electrodes sub-1_electrodes.tsv: the electrode \w+ lies \d+ mm from the "
                   r"skin, must be at most 60", *labels, "--electrodes", "sub-1_electrodes.tsv", "-o", "m")
        self.path("bad.elc").write_text("Positions\n1 2 3\nLabels\n")
        self.fails(BAD_INPUT, r"bad.elc: it has 1 positions and 0 labels", *labels, "--electrodes",
                   "bad.elc", "-o", "m")
        self.path("cap.abc").write_text("1 2 3 Cz\n")
        self.fails(BAD_INPUT, r"cap.abc: electrodes are not read from '.abc' files", *labels,
                   "--electrodes", "cap.abc", "-o", "m")
        self.fails(USAGE, r"--nasion, --left-ear and --right-ear need each other", *labels, "--nasion",
                   "0,1,2", "-o", "m")
        self.fails(USAGE, r"--electrodes and --montage exclude", *labels, "--electrodes", "bad.elc",
                   "--montage", "10-20", "-o", "m")
        self.fails(USAGE, r"need a skin: not with --meg", *labels, "--meg", "--montage", "10-20", "-o",
                   "m")
        self.fails(BAD_INPUT, r"--montage: a landmark lies \d+ mm from the skin", *labels, "--montage",
                   "10-20", "--nasion", "0,200,0", "--left-ear=-72,0,0", "--right-ear", "72,0,0", "-o",
                   "m")
        self.fails(BAD_INPUT, r"--montage: a landmark lies [\d.]+ mm from the skin.*: is it in metres\?", *labels, "--montage", "10-20",
                   "--nasion", "0,0.072,0", "--left-ear=-0.072,0,0", "--right-ear", "0.072,0,0", "-o", "m")


class Sources(BemTest):
    def test_a_grid_is_written_in_the_frame_and_unit_asked_for(self):
        self.bem(*self.labels(), "--source-grid", 15, "-o", "mm")
        self.bem(*self.labels(), "--source-grid", 15, "--coordinates", "lps", "--units", "m", "-o", "m")
        places = [[tuple(map(float, line.split())) for line in (self.path(folder) / "dipoles.txt").read_text().splitlines()]
                  for folder in ("mm", "m")]
        self.assertEqual(len(places[0]), 3 * self.report("mm")["sources"]["counts"][0])
        for n, (mm, m) in enumerate(zip(*places, strict=True)):
            self.assertEqual(mm[3:], tuple(float(axis == n % 3) for axis in range(3)))
            self.assertEqual(m[3:], mm[3:])
            self.assertLess(math.dist([-1000 * m[0], -1000 * m[1], 1000 * m[2]], mm[:3]), 0.002)
            self.assertLess(math.hypot(*mm[:3]), RADII[0] - 10)  # edges of 162 vertices are 18 to 26 mm; chords
        self.assertIn("-DSM model.geom model.cond dipoles.txt", (self.path("mm") / "README.md").read_text())
        self.assertFalse((self.path("mm") / "head-mri-trans.fif").exists())  # nasion and ears are not known

    def test_sources_outside_the_head_are_refused(self):
        self.bem(*self.labels(), "-o", "model")
        self.assertFalse((self.path("model") / "dipoles.txt").exists())
        self.assertNotRegex((self.path("model") / "README.md").read_text(), r"dipoles\.txt|electrodes\.txt")
        self.fails(BAD_INPUT, r"--sources: 100.0 % of the sources lie outside inner_skull; are the surfaces of this head",
                   *self.labels(), "--sources", "model/outer_skin.surf", "-o", "again")
        done = self.bem(*self.labels(), "--sources", "model/inner_skull.surf", "--source-count", 40, "-o", "again")
        self.assertRegex(done.stderr, r"sources nearer to inner_skull than one edge were moved by up to \d+\.\d mm; more vertices")
        report = self.report("again")["sources"]
        self.assertEqual((report["counts"], report["moved"], report["dropped"]), ([40], 40, 0))

    def write_stl(self, name, points, triangles):
        facets = ("facet normal 0 0 0 outer loop " + " ".join(f"vertex {x} {y} {z}" for x, y, z in (points[v] for v in t))
                  + " endloop endfacet" for t in triangles)
        self.path(name).write_text("\n".join(["solid s", *facets, "endsolid s", ""]))

    def test_an_open_surface_keeps_its_orientation(self):
        """A part of a ball: it encloses nothing that could say which side is out."""
        self.bem(*self.labels(), "-o", "model")
        points, triangles = read_tri(self.path("model") / "inner_skull.tri")
        low = [(x / 3, y / 3, z / 3 - 25) for x, y, z in points]
        bowl = [t for t in triangles if all(low[v][2] < -25 for v in t)]
        for name, sign, kept in (("out", 1, bowl), ("in", -1, [t[::-1] for t in bowl])):
            self.write_stl("half.stl", low, kept)
            done = self.bem(*self.labels(), "--sources", "half.stl", "--input-coordinates", "ras", "-o", name)
            self.assertIn("sources: surface 1 is open, so its orientation is not checked", done.stdout)
            for line in (self.path(name) / "dipoles.txt").read_text().splitlines():
                x, y, z, *normal = map(float, line.split())
                self.assertGreater(sign * sum(a * b for a, b in zip((x, y, z + 25), normal)), 0)

    def test_a_surface_without_room_for_sources_asks_for_more_vertices(self):
        """A disc 60 mm thick and 240 mm wide with 42 vertices: edges of 40 to 120 mm, and no place is deeper than 30 mm."""
        self.bem(*self.labels()[:4], "--meg", "--voxel", 3, "--closing", 4, "--vertices", 42, "-o", "ball")
        points, triangles = read_tri(self.path("ball") / "inner_skull.tri")
        self.write_stl("flat.stl", [(2 * x, 2 * y, z / 2) for x, y, z in points], triangles)
        self.write_stl("in.stl", [(x, y, z / 4) for x, y, z in points], triangles)
        self.fails(BAD_INPUT, r"--sources: no source finds a place within inner_skull, one edge away from it; give more vertices",
                   "--surfaces", "flat.stl", "--meg", "--vertices", 42, "--sources", "in.stl",
                   "--input-coordinates", "ras", "-o", "m")

    def test_refusals(self):
        labels = self.labels()
        self.fails(USAGE, "--source-count needs --sources", *labels, "--source-count", 100, "-o", "m")
        self.fails(USAGE, "exclude each other", *labels, "--sources", "a.surf", "--source-grid", 10, "-o", "m")
        self.fails(USAGE, "must be one or two surfaces", *labels, "--sources", "a", "b", "c", "-o", "m")
        self.fails(USAGE, "--source-grid 0.5: must be", *labels, "--source-grid", 0.5, "-o", "m")
        self.fails(BAD_INPUT, "a.surf: ", *labels, "--sources", "a.surf", "-o", "m")
        self.bem(*labels, "-o", "model")
        self.fails(BAD_INPUT, "--sources: both surfaces are the same; give one for each hemisphere", *labels, "--sources",
                   "model/inner_skull.surf", "model/inner_skull.surf", "-o", "m")


OPENMEEG = """#!/bin/sh
# stands for OpenMEEG, which Debian lacks: takes the files that it takes, numbers its gain
echo "${0##*/} $*" >>"$MARK"
echo "${0##*/} version 2.5.16 compiled at noon"
for last; do :; done
while [ $# -gt 1 ]; do
    case $1 in -*) ;; *) [ -s "$1" ] || exit 4 ;; esac
    shift
done
case $last in
h2em.mat) [ -z "$STOPS" ] || { echo 'no such interface' >&2; exit 3; } ;;
hm_inv.mat) [ -z "$WAITS" ] || { echo $$ >"$WAITS"; exec sleep 600; } ;;
gain.txt) awk -v n="$(wc -l <dipoles.txt)" '{for (c = 1; c <= n; ++c) printf "%g%s", -NR - c / 1e4, c < n ? "\\t" : "\\n"}' \
    electrodes.txt >gain.txt; exit ;;
esac
echo made >"$last"
"""


class OpenMeeg(BemTest):
    """--lead-field openmeeg by programs that stand for it."""

    def setUp(self):
        super().setUp()
        for name in ("om_assemble", "om_minverser", "om_gain"):
            self.path(name).write_text(OPENMEEG)
            self.path(name).chmod(0o755)
        self.path("scratch").mkdir()
        self.command = (*self.labels(), "--montage", "10-20", *LANDMARKS, "--source-grid", "30", "--lead-field", "openmeeg", "-o",
                        "model")
        self.environment = {**os.environ, "PATH": f"{self.folder}:/usr/bin:/bin", "TMPDIR": str(self.path("scratch")),
                            "MARK": str(self.path("mark")), "STOPS": "", "WAITS": ""}

    def test_its_gain_is_the_lead_field(self):
        try:
            from scipy.io import loadmat
        except ImportError:
            self.skipTest("needs python3-scipy")
        self.bem(*self.command, "--threads", "2", env=self.environment)
        self.assertEqual(self.path("mark").read_text().splitlines(), [
            "om_assemble -HM model.geom model.cond hm.mat", "om_minverser hm.mat hm_inv.mat",
            "om_assemble -DSM model.geom model.cond dipoles.txt dsm.mat",
            "om_assemble -H2EM model.geom model.cond electrodes.txt h2em.mat",
            "om_gain -EEG hm_inv.mat dsm.mat h2em.mat gain.txt"])
        field = loadmat(self.path("model/lead-field.mat"), simplify_cells=True)
        rows = [line.split("\t")[0] for line in (self.path("model/electrodes.tsv")).read_text().splitlines()[1:]]
        dipoles = [tuple(map(float, line.split())) for line in self.path("model/dipoles.txt").read_text().splitlines()]
        self.assertEqual((list(field["label"]), field["solver"]), (rows, "OpenMEEG 2.5.16"))
        self.assertEqual(field["gain"].shape, (21, len(dipoles)))
        self.assertAlmostEqual(field["gain"][4, 6], -5.0007)
        self.assertEqual((self.report()["leadField"]["electrodes"], self.report()["options"]["leadField"]), (21, "openmeeg"))
        self.assertFalse(list(self.path("scratch").iterdir()))

    def test_failures_leave_no_model_and_a_log(self):
        done = self.run_bem(*self.command, env={**self.environment, "STOPS": "1"})
        self.assertEqual(done.returncode, BAD_INPUT)
        line = done.stderr.splitlines()[-1]  # after warnings
        log = re.search(r"^adaptiso-bem: --lead-field openmeeg: om_assemble made no lead field \(exit code 3, 'no such interface'\); what it "
                        r"printed is in (\S+)$", line).group(1)
        self.assertIn("no such interface", Path(log).read_text())
        self.assertEqual([str(path) for path in self.path("scratch").iterdir()], [log])
        self.assertFalse(self.path("model").exists())

    def test_a_signal_leaves_neither_files_nor_the_solver(self):
        mark = self.path("waits")
        process = subprocess.Popen([BEM, *self.command], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   env={**self.environment, "WAITS": str(mark)})
        while process.poll() is None and not (mark.exists() and mark.read_text().endswith("\n")):
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, -signal.SIGINT)
        self.assertEqual(list(self.path("scratch").iterdir()), [])
        self.assertFalse(self.path("model").exists())
        with self.assertRaises(ProcessLookupError):
            os.kill(int(mark.read_text()), 0)

    def test_what_is_missing_is_told_before_the_work(self):
        def needs(what, *arguments):
            done = self.run_bem("--t1", "missing.nii", *self.command[-4:], *arguments, env=self.environment)
            self.assertEqual((done.returncode, done.stderr.split("--lead-field needs ")[1:]), (USAGE, [what + " (see adaptiso-bem --help)\n"]), done.stderr)

        needs("--electrodes or --montage", "--source-grid", "30")
        needs("--sources or --source-grid", "--montage", "10-20")
        self.path("om_gain").unlink()
        needs("om_gain of OpenMEEG (from openmeeg.github.io)", "--montage", "10-20", "--source-grid", "30")
        self.path("om_assemble").unlink()
        needs("--electrodes or --montage; --sources or --source-grid; a skin (not with --meg); om_assemble, om_gain of OpenMEEG "
              "(from openmeeg.github.io)", "--meg")

    def test_sources_are_read_before_the_head_is_worked_on(self):
        self.path("lh.white").write_text("no surface")
        self.fails(BAD_INPUT, "lh.white", *self.labels(), "--tissue", "brain=9", "--sources", "lh.white", "-o", "model")


if __name__ == "__main__":
    main()
