"""adaptiso-check: the defects planted in a head model, each found by name."""

from support import CHECK_FAILED, OK, main
from checkSupport import NAMES, CheckTest, finding
from headDefects import DEFECTS, good

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
    "a gap of 0.05 mm": ({FIRST_PAIR: ["minGap"]}, r"smallest 0\.0498 mm"),
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


if __name__ == "__main__":
    main()
