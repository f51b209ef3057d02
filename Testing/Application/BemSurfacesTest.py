"""adaptiso-bem --surfaces: ready ones taken as they are, mended, made anew or refused."""

import json
import math
import os
import re
import subprocess
from pathlib import Path

from support import CHECK_FAILED, OK, main
from bemSupport import CHECK, NAMES, RADII, BemTest, read_tri, volume
from headDefects import write_off


def globe(radius, rings=12, steps=24, centre=(0, 0, 0)):
    """A closed outward sphere of triangles."""
    points = [(0, 0, -radius)]
    for ring in range(1, rings):
        t = math.pi * ring / rings - math.pi / 2
        for step in range(steps):
            p = 2 * math.pi * step / steps
            points.append((radius * math.cos(t) * math.cos(p), radius * math.cos(t) * math.sin(p),
                           radius * math.sin(t)))
    points.append((0, 0, radius))
    def at(ring, step): return 1 + (ring - 1) * steps + step % steps
    triangles = []
    for step in range(steps):
        triangles.append((0, at(1, step + 1), at(1, step)))
        triangles.append((len(points) - 1, at(rings - 1, step), at(rings - 1, step + 1)))
        for ring in range(1, rings - 1):
            a, b = at(ring, step), at(ring, step + 1)
            c, d = at(ring + 1, step), at(ring + 1, step + 1)
            triangles += [(a, b, d), (a, d, c)]
    return [tuple(v + o for v, o in zip(p, centre)) for p in points], triangles


class Surfaces(BemTest):
    def write(self, *meshes):
        names = []
        for n, mesh in enumerate(meshes):
            names.append(f"s{n}.off")
            write_off(self.path(names[-1]), mesh, None)
        return names

    def test_good_ones_stay_to_the_bit(self):
        names = self.write(*(globe(r) for r in RADII))
        self.bem("--surfaces", *names, "-o", "model")
        for name, radius in zip(NAMES, RADII):
            points, triangles = read_tri(self.path("model") / f"{name}.tri")
            expected, corners = globe(radius)
            self.assertEqual(triangles, corners)
            for p, q in zip(points, expected):
                self.assertLess(math.dist(p, q), 1e-6)  # nine digits

    def test_what_no_head_has_is_no_model(self):
        """A third of adults' least inner skull (317 cm3) is a ball of 42.3 mm; three times the thickest scalp is 45 mm."""
        names = self.write(*(globe(r) for r in (42, 66, 72)), globe(60), globe(144))
        for inner, skin, said in ((0, 2, r"inner_skull: 30\d cm3; adults have 950 to 1900 cm3; .*no head has such a volume of the inner skull"),
                                  (3, 4, r"outer_skull in outer_skin: median 7\d\.\d mm .*no head has such a thickness of the scalp")):
            done = self.run_bem("--surfaces", names[inner], names[1], names[skin], "--input-coordinates", "ras", "--dry-run")
            self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
            self.assertRegex(done.stderr, r"\A.*no model: " + said)  # alone: what is unusual besides is beside the point
        for radii in ((43.5, 66, 72), (60, 66, 108)):  # unusual alone
            done = self.bem("--surfaces", *self.write(*(globe(r) for r in radii)), "-o", f"model{radii[0]}")
            self.assertRegex(done.stderr, "outer_skull in outer_skin: median 4|inner_skull in outer_skull: median 2")

    def test_inside_out_ones_are_turned(self):
        points, triangles = globe(60)
        names = self.write((points, [(a, c, b) for a, b, c in triangles]), globe(66), globe(72))
        self.bem("--surfaces", *names, "-o", "model")
        self.assertGreater(volume(*read_tri(self.path("model") / "inner_skull.tri")), 0)
        self.assertRegex(" ".join(self.report()["notes"]), "inside out")

    def test_crossing_ones_are_pushed_apart(self):
        names = self.write(globe(60, centre=(4, 0, 0)), globe(62), globe(72))
        self.bem("--surfaces", *names, "-o", "model")
        report = self.report()
        self.assertGreaterEqual(report["gaps"][0]["mm"], 2 - 1e-9)
        self.assertEqual(report["surfaces"][0]["nesting"]["movedVertices"], 0)
        self.assertGreater(report["surfaces"][1]["nesting"]["movedVertices"], 0)

    def test_given_ones_that_are_moved_are_a_warning_with_count_length_and_place(self):
        names = self.write(globe(60, centre=(10, 0, 0)), globe(66), globe(72))
        done = self.bem("--surfaces", *names, "-o", "model", "--report", "page.html")
        report = self.report()
        moved = {w["text"].split(":")[0]: w for w in report["input"]["warnings"]
                 if w["code"] == "surface-moved"}
        self.assertEqual(set(moved), {"outer_skull", "outer_skin"})
        for n, name in ((1, "outer_skull"), (2, "outer_skin")):
            nesting = report["surfaces"][n]["nesting"]
            given = globe((66, 72)[n - 1])[0]
            points = read_tri(self.path("model") / f"{name}.tri")[0]
            lengths = [math.dist(p, q) for p, q in zip(given, points)]
            self.assertEqual(nesting["movedVertices"], sum(mm > 1e-6 for mm in lengths))
            self.assertAlmostEqual(nesting["maximumMm"], max(lengths), places=5)
            at = given[lengths.index(max(lengths))]
            self.assertLess(math.dist(nesting["maximumPointMm"], (-at[0], -at[1], at[2])), 1e-6)
            self.assertRegex(moved[name]["text"],
                             rf"^{name}: {nesting['movedVertices']} of {len(given)} vertices were "
                             rf"moved by up to {nesting['maximumMm']:.2f} mm, at \(")
            self.assertIn("warning: " + moved[name]["text"], done.stderr)
            place = re.search(r"at (\(.*?\)) mm RAS", moved[name]["text"])[1]
            self.assertIn(f'<span class="where">{place}</span>', self.path("page.html").read_text())
        self.assertEqual(self.run_bem("--surfaces", *names, "-o", "strict", "--strict").returncode,
                         CHECK_FAILED)
        self.assertFalse((self.path("strict") / "inner_skull.tri").exists())
        # and none where they stay
        names = self.write(*(globe(r) for r in RADII))
        self.bem("--surfaces", *names, "-o", "kept")
        self.assertNotIn("surface-moved", [w["code"] for w in self.report("kept")["input"]["warnings"]])

    def test_broken_ones_are_mended_alone(self):
        points, triangles = globe(60)
        names = self.write((points, triangles[5:]), globe(66), globe(72))
        self.bem("--surfaces", *names, "-o", "model")
        report = self.report()
        self.assertRegex(" ".join(report["notes"]), r"inner_skull: mended .*: 9 open border edges; 2 holes closed, .*\(proved\)")
        self.assertTrue(all(check["passed"] for check in report["checks"]))
        mending, *others = [surface["mending"] for surface in report["surfaces"]]
        self.assertEqual((len(mending["filled"]), mending["inputToResultMm"], others), (2, 0, [None, None]))
        for name, radius in zip(NAMES[1:], RADII[1:]):
            self.assertEqual(read_tri(self.path("model") / f"{name}.tri")[1], globe(radius)[1])

    def test_what_cannot_be_guaranteed_gives_the_report_alone_and_says_where(self):
        # the outer skull lies far from the inner one
        names = self.write(globe(60), globe(66, centre=(300, 0, 0)), globe(72))
        done = self.run_bem("--surfaces", *names, "-o", "model", "--json", "-")
        self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
        self.assertRegex(done.stderr.splitlines()[-1],
                         r"no model: .* at \(-?[\d.]+, -?[\d.]+, -?[\d.]+\) mm RAS")
        self.assertEqual(sorted(os.listdir(self.path("model"))), ["report.json", "spots.png"])
        self.assertTrue(Path(self.path("model"), "spots.png").read_bytes()
                        .startswith(b"\x89PNG"))
        report = json.loads(done.stdout)
        self.assertEqual(report["model"], False)
        self.assertGreater(len(report["findings"]), 0)

    def test_metres_are_refused(self):
        names = self.write(*(globe(r / 1000) for r in RADII))
        done = self.run_bem("--surfaces", *names, "-o", "model")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(done.stderr, "too small; in metres?")
        self.assertLessEqual(set(os.listdir(self.path("model"))), {"report.json", "spots.png"})

    def test_needles_and_flat_triangles_are_remeshed_to_the_same_number(self):
        # one vertex moved almost onto its neighbour
        points, triangles = globe(60)
        a, b = triangles[40][:2]
        points[a] = tuple(p + 1e-4 * (q - p) for p, q in zip(points[b], points[a]))
        names = self.write((points, triangles), globe(66), globe(72))
        self.bem("--surfaces", *names, "-o", "model")
        report = self.report()
        self.assertRegex(" ".join(report["notes"]), "inner_skull: .*; remeshed")
        self.assertEqual(report["surfaces"][0]["vertices"], len(points))
        self.assertGreater(report["surfaces"][0]["minAngleDeg"]["p5"], 30)
        self.assertEqual(report["surfaces"][1]["denseTriangles"], 0)  # taken as it came

    def test_good_surfaces_of_more_vertices_than_mne_likes_are_told(self):
        names = self.write(globe(60, 60, 60), globe(66, 60, 60), globe(72, 60, 60))
        done = self.bem("--surfaces", *names, "-o", "model")
        self.assertRegex(done.stderr, "10,626 vertices in all; MNE and OpenMEEG store their square")

    def test_a_gap_that_rounding_of_the_files_would_lessen_is_kept(self):
        # exactly the gap asked for: floats in the .surf files would fall short of it
        names = self.write(globe(60), globe(62), globe(72))
        self.bem("--surfaces", *names, "--min-gap", "1.5,2", "-o", "model")
        gap = self.report()["gaps"][0]["mm"]
        self.bem("--surfaces", *names, "--min-gap", f"{gap:.17g},2", "-o", "again")
        files = [self.path("again") / f"{name}.surf" for name in NAMES]
        check = subprocess.run([CHECK, "--nested", *files, "--min-gap", f"{gap:.17g}"],
                               capture_output=True, text=True)
        self.assertEqual(check.returncode, OK, check.stdout)


if __name__ == "__main__":
    main()
