"""The package gives the bytes and the reports of the programs, for the same input and options."""

import json
import unittest

import adaptiso
import numpy as np
from support import BRAIN, InFolder, ball, needs, program

#: options of adaptiso-mesh, and the same in Python
OPTIONS = {
    "default": ([], {}),
    "bound": (["--max-error", 0.4], {"max_error": 0.4}),
    "count": (["--triangles", 900], {"triangles": 900}),
    "reduction": (["--reduction", 0.8], {"reduction": 0.8}),
    "angle": (["--min-angle", 15], {"min_angle": 15}),
    "boxes": (["--method", "boxes"], {"method": "boxes"}),
    "dmc": (["--method", "dmc"], {"method": "dmc"}),
    "asc": (["--method", "asc"], {"method": "asc"}),
    "mc": (["--method", "mc"], {"method": "mc"}),
    "open": (["--border", "open", "--largest"], {"border": "open", "largest": True}),
    "pieces": (["--min-volume", 150, "--fill-cavities"],
               {"min_volume": 150, "fill_cavities": True}),
    "preprocessed": (["--crop", "2:34,:,1:", "--smooth", 0.8, "--resample", 1.3],
                     {"crop": np.s_[2:34, :, 1:], "smooth": 0.8, "resample": 1.3}),
}
OBLIQUE = np.array([[1.1, 0.2, 0, -7], [-0.2, 0.9, 0.3, 40], [0.1, 0, -1.2, -3.5], [0, 0, 0, 1]],
                   np.float32).astype(float)  # as a NIfTI file holds it


def bumpy():
    """Several pieces, a cavity, surfaces at the border; whole numbers, so that ties happen too."""
    i, j, k = np.indices((36, 30, 26), dtype=float)
    waves = np.sin(i / 3) * np.cos(j / 4) + np.sin(k / 3.5) * np.cos(i / 5)
    return np.asfortranarray(np.round(40 * waves + 100).astype(np.int16))


@needs("nibabel")
class Bytes(InFolder):
    def setUp(self):
        super().setUp()
        import nibabel
        self.volume = bumpy()
        self.input = self.folder / "bumpy.nii"
        nibabel.save(nibabel.Nifti1Image(self.volume, OBLIQUE), self.input)

    def by_program(self, extension, *options):
        output = self.folder / ("theirs" + extension)
        program("adaptiso-mesh", self.input, "--iso", 118, "-o", output,
                "--json", self.folder / "report.json", *options)
        return output.read_bytes()

    def saved(self, mesh, extension, **options):
        mesh.save(self.folder / ("ours" + extension), **options)
        return (self.folder / ("ours" + extension)).read_bytes()

    def test_of_an_array_with_its_affine(self):
        for name, (arguments, options) in OPTIONS.items():
            with self.subTest(name):
                mesh = adaptiso.surface(self.volume, 118, affine=OBLIQUE, **options)
                self.assertEqual(self.saved(mesh, ".vtp"), self.by_program(".vtp", *arguments))

    def test_of_a_path_a_nibabel_image_and_what_read_gives(self):
        import nibabel
        truth = self.by_program(".vtp")
        for image in (self.input, str(self.input), nibabel.load(self.input),
                      adaptiso.read(self.input)):
            self.assertEqual(self.saved(adaptiso.surface(image, 118), ".vtp"), truth)
        self.assertEqual(self.saved(adaptiso.Index(self.input).surface(118), ".vtp"), truth)

    def test_in_every_format_and_frame(self):
        mesh = adaptiso.surface(self.volume, 118, affine=OBLIQUE)
        for extension in (".vtp", ".vtk", ".ply", ".stl", ".obj", ".off", ".gii", ".surf", ".tri",
                          ".glb", ".3mf"):
            with self.subTest(extension):
                if extension not in (".surf",):  # tkRAS of this sheared image can't be had
                    self.assertEqual(self.saved(mesh, extension), self.by_program(extension))
                for frame in ("ras", "lps"):
                    self.assertEqual(self.saved(mesh, extension, frame=frame),
                                     self.by_program(extension, "--coordinates", frame))
        self.assertEqual(self.saved(mesh, ".vtp", frame="voxel"),
                         self.by_program(".vtp", "--coordinates", "voxel"))

    def test_in_tkras(self):
        import nibabel
        affine = np.array([[-1, 0, 0, 20], [0, 0, 1.5, -30], [0, -1, 0, 12], [0, 0, 0, 1.0]])
        nibabel.save(nibabel.Nifti1Image(self.volume, affine), self.input)
        mesh = adaptiso.surface(self.volume, 118, affine=affine)
        for extension, frame in ((".surf", None), (".pial", "tkras"), (".ply", "tkras")):
            self.assertEqual(self.saved(mesh, extension, frame=frame),
                             self.by_program(extension, *(["--coordinates", frame] if frame else [])))

    def test_the_report_is_the_program_s(self):
        for name in ("default", "mc", "count", "pieces", "preprocessed"):
            arguments, options = OPTIONS[name]
            reports = [("linear", adaptiso.surface(self.input, 118, **options).report)]
            # of one level every block is looked at, and none kept; an Index has the program's tree
            if name != "preprocessed":
                reports.append(("kdtree", adaptiso.Index(self.input).surface(118, **options).report))
            for search, ours in reports:
                self.by_program(".vtp", *arguments, "--search", search)
                theirs = json.loads((self.folder / "report.json").read_text())
                if search == "linear":
                    self.assertEqual(ours["index"].pop("memoryBytes"), 0)
                    theirs["index"].pop("memoryBytes")
                self.compare_reports(ours, theirs, name)

    def compare_reports(self, ours, theirs, name):
        theirs.pop("result")  # for a batch, which Python has none of
        self.assertEqual(list(ours), list(theirs))
        # who made it, how long that took, and what was written to which file
        for key in ("program", "seconds", "peakMemoryMb"):
            ours.pop(key), theirs.pop(key)
        for key in ("picture", "scale", "fitMm"):  # Python draws none, and has transform()
            theirs["options"].pop(key, None)
        for key in ("output", "roundingMm"):
            ours["surfaces"][0].pop(key), theirs["surfaces"][0].pop(key)
        self.assertEqual(ours, theirs, name)

    def test_otsu_chooses_as_the_program_does(self):
        program("adaptiso-mesh", self.input, "--iso", "auto", "-o", self.folder / "auto.ply")
        self.assertEqual(self.saved(adaptiso.surface(self.volume, "auto", affine=OBLIQUE), ".ply"),
                         (self.folder / "auto.ply").read_bytes())

    @unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
    def test_of_a_real_scan(self):
        program("adaptiso-mesh", BRAIN, "--iso", 100, "--method", "boxes", "--largest",
                "--no-check-crossings", "-o", self.folder / "brain.ply")
        mesh = adaptiso.surface(BRAIN, 100, method="boxes", largest=True)
        self.assertEqual(self.saved(mesh, ".ply"), (self.folder / "brain.ply").read_bytes())


class Findings(InFolder):
    def setUp(self):
        super().setUp()
        self.inner = adaptiso.surface(ball((40, 40, 40), (19.4, 19.5, 19.6)), -12)
        self.outer = adaptiso.surface(ball((40, 40, 40), (20, 19.5, 19.6)), -16)
        self.files = [self.folder / "inner.ply", self.folder / "outer.ply"]
        self.inner.save(self.files[0]), self.outer.save(self.files[1])

    def report(self, name, *arguments):
        return json.loads(program(name, *arguments, "--json", "-"))

    def test_check_says_what_adaptiso_check_says(self):
        # and of a mesh with a hole and a flipped triangle
        faces = self.inner.faces[1:].copy()
        faces[5] = faces[5][::-1]
        broken = self.folder / "broken.ply"
        adaptiso.Mesh(self.inner.vertices, faces).save(broken)
        for mesh, file in ((self.inner, self.files[0]), ((self.inner.vertices, faces), broken)):
            for profile in ("bem", "print", "view"):
                # print is the default; only where it is given does the program measure walls
                asked = () if profile == "print" else ("--profile", profile)
                theirs = self.report("adaptiso-check", file, *asked)["surfaces"][0]
                ours = adaptiso.check(mesh, profile)
                for key, value in ours.report.items():
                    self.assertEqual(value, theirs[key], key)
                self.assertEqual(bool(ours), theirs["passed"])
                self.assertEqual(adaptiso.check(file, profile).report, ours.report)

    def test_check_nested_says_what_adaptiso_check_says(self):
        theirs = self.report("adaptiso-check", "--nested", *self.files)
        ours = adaptiso.check_nested(self.files)
        self.assertEqual(ours.passed, theirs["passed"])
        for key, value in ours.report["nesting"]["pairs"][0].items():
            self.assertEqual(value, theirs["nesting"]["pairs"][0][key], key)
        self.assertEqual(ours.failed[0].split(":")[0], "inner.ply")  # smaller than a head
        self.assertTrue(adaptiso.check_nested([self.inner, self.outer], "print").passed)
        swapped = adaptiso.check_nested({"brain": self.outer, "skull": self.inner}, "print")
        self.assertFalse(swapped)
        self.assertEqual(swapped.failed, ["brain in skull: strictlyNested"])
        self.assertIn("swapped order", swapped.findings[0])

    def test_compare_says_what_adaptiso_compare_says(self):
        theirs = self.report("adaptiso-compare", *self.files)
        ours = adaptiso.compare(*self.files).report
        for direction in ("aToB", "bToA", "combined"):
            for key, value in ours["distances"][direction].items():
                self.assertEqual(value, theirs["distances"][direction][key], (direction, key))
        for key, value in ours["a"].items():
            self.assertEqual(value, theirs["a"][key], key)

    def test_bad_arguments_are_refused(self):
        mesh = self.inner
        for call in (lambda: adaptiso.check(None), lambda: adaptiso.check((1, 2)),
                     lambda: adaptiso.check("nowhere.ply"), lambda: adaptiso.check(mesh, "head"),
                     lambda: adaptiso.check(mesh, min_angle=90),
                     lambda: adaptiso.check(mesh, max_pairs=-1),
                     lambda: adaptiso.check((np.zeros((3, 2)), [[0, 1, 2]])),
                     lambda: adaptiso.check((np.zeros((3, 3)), [[0.5, 1, 2]])),
                     lambda: adaptiso.check_nested([mesh]), lambda: adaptiso.check_nested(mesh),
                     lambda: adaptiso.check_nested([mesh, mesh], names=["one"]),
                     lambda: adaptiso.check_nested([mesh, mesh], min_gap=-1),
                     lambda: adaptiso.compare(mesh, None),
                     lambda: adaptiso.compare(mesh, mesh, samples=0),
                     lambda: adaptiso.compare(mesh, ([[0, 0, 0]], [[0, 0, 0]])),
                     lambda: adaptiso.compare(mesh, (np.zeros((0, 3)), np.zeros((0, 3), int))),
                     lambda: adaptiso.compare(mesh, ([[0, 0, 0]], [[0, 0, 7]]))):
            with self.assertRaises(adaptiso.Error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))

    def test_faults_that_load_refuses_are_found(self):
        points = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, np.nan]])
        found = adaptiso.check((points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 77]]))
        self.assertIn("finiteCoordinates", found.failed)
        self.assertIn("indicesInRange", found.failed)
        with self.assertRaises(adaptiso.Error):
            adaptiso.Mesh(points, [[0, 1, 2]])


if __name__ == "__main__":
    unittest.main(verbosity=2)
