"""adaptiso-check, profile bem: what is unusual of a head model is noted, with its place, and fails nothing."""

import math

from support import OK, Image, main, write_nifti
from checkSupport import NAMES, CheckTest
from headDefects import icosphere, moved, normalized, pushed, scaled

RADII = (68, 75, 82)  # of a usual head; edges of 10 mm, no longer than two gaps
PAIR = "inner.off in middle.off"


def usual():
    return [icosphere(radius) for radius in RADII]


def cut_at(mesh, z):
    points, triangles = mesh
    return [(p[0], p[1], max(p[2], z)) for p in points], triangles


class Notes(CheckTest):
    def notes(self, model, *arguments, passes=True):
        self.write_model(model)
        report = self.check("--nested", *NAMES, *arguments)
        if passes:
            self.assertTrue(report["passed"])
        self.assertEqual({note["pointsIn"] for note in report["plausibility"]}, {"ras"})
        return {(note["name"], note["of"]): note for note in report["plausibility"]}

    def noted(self, *arguments, **options):
        return {key: note for key, note in self.notes(*arguments, **options).items()
                if note["outcome"] == "noted"}

    def test_a_usual_model_has_none(self):
        notes = self.notes(usual())
        self.assertEqual({note["outcome"] for note in notes.values()}, {"passed"})
        self.assertEqual({name for name, _ in notes},
                         {"necks", "notCutFlat", "edgesInProportion", "innerSkullVolume", "dents",
                          "skullThickness", "scalpThickness", "edgesAgainstGap", "vertexCounts"})
        self.assertRegex(notes["innerSkullVolume", "inner.off"]["finding"], "^1[23][0-9]{2} cm3, of")
        # faces lie as parallel as the spheres: the difference of their radii
        self.assertRegex(notes["skullThickness", PAIR]["finding"], r"^median 7\.0 mm")

    def test_a_tongue_of_the_inner_skull(self):
        # a pyramid on a ring of edges of 10 mm: in a cone of its 18 degrees the ball would stop
        # 17 mm before the tip, 30 mm is all of it
        last = len(usual()[0][0]) - 1
        model = [pushed(mesh, last, radius + 30) for mesh, radius in zip(usual(), RADII)]
        neck = self.noted(model)["necks", "inner.off"]
        self.assertRegex(neck["finding"], r"^a part narrower than 16 mm reaches (1[7-9]|2\d) mm")
        tip = scaled(normalized(usual()[0][0][last]), RADII[0] + 30)
        self.assertLess(math.dist(neck["pointsMm"][0], tip), 5)  # the last voxel that fits into the tip

    def test_one_vertex_far_off(self):
        # 92 mm off the skin: nothing crosses, all is nested
        inner, middle, outer = usual()
        notes = self.noted([inner, middle, pushed(outer, 5, 82 + 92)])
        note = notes.pop(("edgesInProportion", "outer.off"))
        self.assertEqual(notes, {})
        self.assertRegex(note["finding"], r"^1 vertex stands out: edges of 9\d\.\d mm where those "
                                          r"round it have 1\d\.\d mm$")
        far = scaled(normalized(outer[0][5]), 174)
        self.assertLess(math.dist(note["pointsMm"][0], far), 1e-6)

    def test_cut_flat_by_the_edge_of_an_image(self):
        model = [cut_at(mesh, -radius + 25) for mesh, radius in zip(usual(), RADII)]
        by_plane = self.noted(model)
        for name in NAMES:
            self.assertRegex(by_plane["notCutFlat", name]["finding"],
                             r"^\d+ of 642 vertices \(\d+ % of the area, \d+ cm2\) lie on one plane "
                             "across z: cut by the edge of an image")
        self.assertAlmostEqual(by_plane["notCutFlat", "outer.off"]["pointsMm"][0][2], -57, delta=1)
        # an image of 4 mm whose lowest face is at z = -57, where the skin alone is cut
        write_nifti(self.path("image.nii"),
                    Image((50, 50, 50), "B", bytes(125000), (4, 4, 4), (-98, -98, -55)))
        by_face = self.noted(model, "--volume", "image.nii")
        self.assertRegex(by_face["notCutFlat", "outer.off"]["finding"],
                         "lie on the image's lower face: the head is cut there$")
        self.assertNotIn(("notCutFlat", "inner.off"), by_face)

    def test_sizes_that_adults_do_not_have(self):
        notes = self.noted([icosphere(radius) for radius in (50, 52.2, 53.8)])
        self.assertRegex(notes["innerSkullVolume", "inner.off"]["finding"],
                         "^5[0-9]{2} cm3; adults have 950 to 1900 cm3; of a child give adaptiso-bem --age$")
        self.assertRegex(notes["skullThickness", PAIR]["finding"],
                         r"^median [12]\.\d mm .* adults have 3 to 12 mm; of a child give adaptiso-bem --age$")
        self.assertRegex(notes["scalpThickness", "middle.off in outer.off"]["finding"],
                         r"^median 1\.\d mm .* adults have 2 to 15 mm; of a child give adaptiso-bem --age$")
        # edges of 7.5 mm in a layer of 2
        self.assertRegex(notes["edgesAgainstGap", PAIR]["finding"],
                         r"^edges longer than 2 gaps at 100 % of the vertices, up to \d\.\d")

    def test_an_inner_skull_out_of_its_place(self):
        """The median is right: 7 mm. By 5 mm to the left the skull has 2 to 12 mm."""
        inner, middle, outer = usual()
        notes = self.noted([([(p[0] + 5, *p[1:]) for p in inner[0]], inner[1]), middle, outer])
        self.assertRegex(notes["skullThickness", PAIR]["finding"], "times as thick as its thin ones")
        self.assertNotIn(("scalpThickness", "middle.off in outer.off"), notes)

    def test_a_dent_of_the_vault(self):
        """As a lesion at the cortex makes it: a pit of 30 mm radius, 26 mm deep; what lies below is not asked."""
        def dented(mesh, radius, direction):
            place = scaled(normalized(direction), radius)
            return [scaled(normalized(p), radius - 26 * max(0, 1 - math.dist(p, place) / 30)) for p in mesh[0]], mesh[1]

        inner, middle, outer = usual()
        notes = self.noted([dented(inner, 68, (1, 0, 1)), dented(middle, 75, (1, 0, 1)), outer])
        self.assertRegex(notes["dents", "inner.off"]["finding"], r"^at most [12]\d\.\d mm below its convex hull; ")
        self.assertLess(math.dist(notes["dents", "inner.off"]["pointsMm"][0], scaled(normalized((1, 0, 1)), 42)), 12)
        self.assertRegex(notes["scalpThickness", "middle.off in outer.off"]["finding"], "thicker than 20 mm on more than 1 %")
        notes = self.noted([dented(inner, 68, (1, 0, -3)), dented(middle, 75, (1, 0, -3)), outer])
        self.assertNotIn(("dents", "inner.off"), notes)

    def test_numbers_of_vertices_that_do_not_match(self):
        inner, middle, _ = usual()
        notes = self.noted([inner, middle, icosphere(84, 4)])
        self.assertEqual(list(notes), [("vertexCounts", "middle.off in outer.off")])
        self.assertRegex(notes["vertexCounts", "middle.off in outer.off"]["finding"],
                         "^642 and 2562 vertices: one has 4.0 times as many")

    def test_text_and_page_tell_them_and_quiet_does_not(self):
        inner, middle, outer = usual()
        self.write_model([inner, middle, pushed(outer, 5, 174)])
        done = self.run_check("--nested", *NAMES, "--report", "page.html")
        self.assertEqual((done.returncode, done.stderr), (OK, ""))
        self.assertRegex(done.stdout, r"\nplausibility \(RAS mm; .*noted, and may be right\)\n")
        self.assertRegex(done.stdout, r"\n  edges in proportion       noted   outer\.off: 1 vertex "
                                      r"stands out.*; at -?\d+\.\d, -?\d+\.\d, -?\d+\.\d\n")
        self.assertRegex(done.stdout, r"\n  no narrow neck            ok      inner\.off: no part")
        page = self.path("page.html").read_text()
        self.assertIn("1 thing is unusual of a head model: worth a look.", page)
        self.assertRegex(page, r'class="worth">.*edges in proportion, noted')
        self.assertRegex(page, r"▲ noted.*edges in proportion")
        quiet = self.run_check("--nested", *NAMES, "--quiet")
        self.assertEqual((quiet.returncode, quiet.stdout, quiet.stderr), (OK, "", ""))

    def test_only_the_profile_bem_asks(self):
        self.write_model(usual())
        for arguments in (("--profile", "print", NAMES[0]),
                          ("--nested", "--profile", "view", *NAMES)):
            self.assertEqual(self.check(*arguments)["plausibility"], [])
        alone = self.check("--profile", "bem", NAMES[0])["plausibility"]
        self.assertEqual([note["name"] for note in alone], ["notCutFlat", "edgesInProportion"])

    def test_broken_surfaces_are_asked_what_makes_sense(self):
        inner, middle, outer = usual()
        nan = moved(inner, 5, (math.nan, 0, 0))
        notes = self.notes([nan, (middle[0], middle[1][1:]), ([(1, 2, 3)], [(0, 9, 0)])],
                           passes=False)
        self.assertNotIn(("necks", "inner.off"), notes)
        self.assertIn(("edgesInProportion", "middle.off"), notes)

    def test_doubled_surfaces_are_named(self):
        inner, middle, outer = usual()
        self.write_model([inner, inner, outer])
        report = self.check("--nested", *NAMES)
        pair = report["nesting"]["pairs"][0]
        self.assertEqual(pair["relation"], "identical")
        self.assertEqual(pair["failed"], ["noCrossing", "strictlyNested", "minGap"])
        found = {check["name"]: check["finding"] for check in pair["checks"]}
        self.assertRegex(found["strictlyNested"], "^identical: inner.off and middle.off are the")
        # one file that holds its surface twice: that is its fault, not the nesting's
        points, triangles = middle
        doubled = (points + points,
                   triangles + [tuple(v + len(points) for v in t) for t in triangles])
        self.write_model([inner, doubled, outer])
        report = self.check("--nested", *NAMES)
        self.assertEqual([pair["relation"] for pair in report["nesting"]["pairs"]],
                         ["nested", "nested"])
        self.assertIn("noDuplicateTriangles", report["surfaces"][1]["failed"])


if __name__ == "__main__":
    main()
