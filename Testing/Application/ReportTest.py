"""The JSON report: its keys are those of README.md, its numbers are those known on paper."""

import json
import math
import re

from support import SOURCE, ApplicationTest, ball, main, noise, onion, write_nifti

README = SOURCE / "Applications" / "adaptiso-mesh" / "README.md"

NUMBER, COUNT, TEXT, FLAG = (int, float), int, str, bool
COMPONENT = {"vertices": COUNT, "triangles": COUNT, "genus": COUNT, "areaMm2": NUMBER,
             "volumeMm3": NUMBER}


def documented_keys():
    """The keys in the first column of README.md's table; ".x" is a key of every surface."""
    section = README.read_text().split("## The report")[1]
    keys = set()
    for row in re.findall(r"^\| (`.*?`) \|", section, re.MULTILINE):
        for key in re.findall(r"`([^`]+)`", row):
            keys.add("surfaces" + key if key.startswith(".") else key)
    return keys - {"surfaces", "preprocessing"}


def keys_of(value, path=""):
    """The paths of all leaves; lists of numbers, texts, boxes and components are leaves."""
    if isinstance(value, dict):
        return {leaf for key, inner in value.items()
                for leaf in keys_of(inner, f"{path}.{key}" if path else key)}
    if path == "surfaces":
        return {leaf for surface in value for leaf in keys_of(surface, path)}
    return {path}


class Schema(ApplicationTest):
    def test_keys_are_the_documented_ones(self):
        write_nifti(self.path("onion.nii"), onion())
        report = self.report("onion.nii", "--iso", "0", "--iso", "1", "--largest", "--verify",
                             "--crop", ":,:,:")
        self.assertEqual(documented_keys() - keys_of(report), {"seconds.crossings"})
        report = self.report("onion.nii", "--iso", "0", "--largest", "--crop", ":,:,:",
                             "--method", "boxes")
        self.assertEqual(documented_keys() - keys_of(report), {"seconds.verify"})
        self.assertEqual(keys_of(report) - documented_keys(), set())

    def test_optional_stages_are_not_there_when_not_asked_for(self):
        write_nifti(self.path("ball.nii"), ball())
        report = self.report("ball.nii", "--iso", "100", "--method", "mc", "--no-check-crossings")
        missing = documented_keys() - keys_of(report)
        self.assertEqual({key for key in missing if not key.startswith("preprocessing.")},
                         {"seconds.preprocess", "seconds.pieces", "seconds.crossings",
                          "seconds.verify"})
        self.assertIsNone(report["preprocessing"])

    def test_types(self):
        write_nifti(self.path("onion.nii"), onion())
        report = self.report("onion.nii", "--iso", "0")
        surface = report["surfaces"][0]
        for component in surface["components"]:
            self.assertEqual(component.keys(), COMPONENT.keys())
            for key, kind in COMPONENT.items():
                self.assertIsInstance(component[key], kind, key)
        for box in surface["boxes"]:
            self.assertEqual(set(box), {"size", "shared", "unshared"})
        for key in ("triangles", "vertices", "marchingCubesTriangles", "boxesChangingTopology",
                    "genus", "componentCount"):
            self.assertIsInstance(surface[key], COUNT, key)
        self.assertIsInstance(surface["soundness"].pop("closed"), FLAG)
        for key, value in surface["soundness"].items():
            self.assertIsInstance(value, COUNT, key)
        for key, value in report["seconds"].items():
            self.assertIsInstance(value, NUMBER, key)
            self.assertGreaterEqual(value, 0, key)

    def test_file_and_stdout_hold_the_same_keys(self):
        write_nifti(self.path("ball.nii"), ball())
        self.mesh("ball.nii", "--iso", "100", "--json", "report.json")
        self.assertEqual(keys_of(json.loads(self.path("report.json").read_text())),
                         keys_of(self.report("ball.nii", "--iso", "100")))


class Numbers(ApplicationTest):
    def test_input_is_described(self):
        self.path("folder").mkdir()
        write_nifti(self.path("folder/ball.nii"), ball(spacing=(1, 1.5, 2), origin=(10, -20, 30)))
        self.mesh("folder/ball.nii", "--iso", "100", "--json", "report.json", "-o", "folder/a.ply")
        text = self.path("report.json").read_text()
        report = json.loads(text)
        self.assertEqual(report["schema"], "adaptiso-mesh/1")
        self.assertEqual(report["input"]["file"], "ball.nii")
        self.assertEqual(report["input"]["sizeVoxels"], [24, 24, 24])
        self.assertEqual(report["input"]["spacingMm"], [1, 1.5, 2])
        self.assertEqual(report["input"]["originMm"], [-10, 20, 30])  # RAS -> LPS
        self.assertEqual(report["input"]["direction"], [[-1, 0, 0], [0, -1, 0], [0, 0, 1]])
        self.assertEqual(report["input"]["pixelType"], "int16")
        self.assertEqual(report["surfaces"][0]["output"]["file"], "a.ply")
        self.assertNotIn("folder", text)

    def test_area_and_volume_of_a_ball(self):
        write_nifti(self.path("ball.nii"), ball(40, 16, spacing=(0.5, 0.5, 0.5)))
        for method in ("adaptive", "boxes", "asc", "mc"):
            with self.subTest(method):
                surface = self.report("ball.nii", "--iso", "100", "--method",
                                      method)["surfaces"][0]
                # vertices lie on the sphere, so the mesh lies inside it. Marching cubes' chords
                # are at most sqrt(3) voxels: 3 / (8 * 16^2) of the radius. The adaptive mesh lies
                # within 0.15 voxel of it, on both sides, of 16. The boxes know no bound: where a
                # box is simple its surface is taken as flat
                bound = 3 * 0.15 / 16
                least = {"mc": 0.99, "adaptive": 0.99 - bound}.get(method, 0.8)
                for value, truth in ((surface["volumeMm3"], 4 / 3 * math.pi * 8 ** 3),
                                     (surface["areaMm2"], 4 * math.pi * 8 ** 2)):
                    self.assertGreater(value / truth, least)
                    # samples are rounded to 0.1 voxel
                    most = 1 + bound if method == "adaptive" else 1.001
                    self.assertLess(value / truth, most)
                self.assertEqual(surface["genus"], 0)
                self.assertEqual(surface["componentCount"], 1)
                self.assertEqual(surface["vertices"] - surface["triangles"] / 2, 2)  # Euler
                if method == "mc":
                    self.assertEqual(surface["triangles"], surface["marchingCubesTriangles"])
                else:
                    self.assertLess(surface["triangles"], surface["marchingCubesTriangles"])

    def test_discretized_marching_cubes_of_a_ball(self):
        write_nifti(self.path("ball.nii"), ball(40, 16, spacing=(0.5, 0.5, 0.5)))
        triangles = {}
        for adjust in ([], ["--adjust-vertices"], ["--merge-within-blocks"]):
            with self.subTest(adjust):
                report = self.report("ball.nii", "--iso", "100", "--method", "dmc", *adjust)
                surface = report["surfaces"][0]
                self.assertEqual(report["options"]["adjustVertices"], "--adjust-vertices" in adjust)
                self.assertEqual(report["options"]["mergeWithinBlocks"],
                                 "--merge-within-blocks" in adjust)
                triangles[" ".join(adjust)] = surface["triangles"]
                self.assertEqual(surface["method"], "dmc")
                self.assertEqual(surface["genus"], 0)
                self.assertEqual(surface["componentCount"], 1)
                self.assertEqual([box["size"] for box in surface["boxes"]], [1])
                self.assertLess(surface["triangles"], surface["marchingCubesTriangles"] / 2)
                # half a voxel from the sphere at most, of a radius of 16
                self.assertAlmostEqual(surface["volumeMm3"] / (4 / 3 * math.pi * 8 ** 3), 1,
                                       delta=3.1 * 0.5 / 16)
        self.assertGreater(triangles["--merge-within-blocks"], triangles[""])

    def test_soundness(self):
        write_nifti(self.path("noise.nii"), noise(16))
        for method in ("boxes", "dmc"):
            for border in ("closed", "open"):
                with self.subTest(method=method, border=border):
                    soundness = self.report("noise.nii", "--iso", "180", "--border", border,
                                            "--method", method)["surfaces"][0]["soundness"]
                    self.assertEqual(soundness.pop("closed"), border == "closed")
                    self.assertEqual(soundness.pop("boundaryEdges") == 0, border == "closed")
                    # the methods do not exclude them; noise has some
                    self.assertGreaterEqual(soundness.pop("crossingPairs"), 0)
                    self.assertEqual(soundness.pop("insideOutPieces") is None, border == "open")
                    self.assertEqual(set(soundness.values()), {0})

    def test_crossings_are_proved_absent_or_counted_or_not_known(self):
        write_nifti(self.path("ball.nii"), ball())
        for method, counted, uncounted in (("adaptive", 0, 0), ("mc", 0, None)):
            for options, expected in (([], counted), (["--no-check-crossings"], uncounted)):
                with self.subTest(method=method, options=options):
                    report = self.report("ball.nii", "--iso", "100", "--method", method, *options)
                    self.assertEqual(report["surfaces"][0]["soundness"]["crossingPairs"], expected)
                    self.assertEqual("crossings" in report["seconds"],
                                     method == "mc" and not options)

    def test_statistics_of_boxes_are_empty_without_boxes(self):
        write_nifti(self.path("ball.nii"), ball())
        for method in ("adaptive", "mc"):
            surface = self.report("ball.nii", "--iso", "100", "--method", method)["surfaces"][0]
            self.assertEqual((surface["boxes"], surface["boxesChangingTopology"],
                              surface["edgesSplit"]), ([], 0, 0), method)

    def test_open_surfaces_have_no_volume(self):
        write_nifti(self.path("ball.nii"), ball(12, 8))  # cut by the border
        surface = self.report("ball.nii", "--iso", "100", "--border", "open")["surfaces"][0]
        self.assertIsNone(surface["volumeMm3"])
        self.assertIsNone(surface["genus"])
        self.assertIsNone(surface["components"][0]["volumeMm3"])

    def test_component_list_is_capped_and_sorted(self):
        write_nifti(self.path("noise.nii"), noise(32))
        surface = self.report("noise.nii", "--iso", "240")["surfaces"][0]
        self.assertGreater(surface["componentCount"], 100)
        self.assertEqual(len(surface["components"]), 100)
        volumes = [abs(component["volumeMm3"]) for component in surface["components"]]
        self.assertEqual(volumes, sorted(volumes, reverse=True))


class Pieces(ApplicationTest):
    """The onion: walls of radius 13 and 4, a hollow of radius 8 between them."""

    def setUp(self):
        super().setUp()
        write_nifti(self.path("onion.nii"), onion())

    def radii(self, *arguments):
        """Radii of the components, from their volumes; negative for a cavity."""
        surface = self.report("onion.nii", "--iso", "0", "--method", "mc",
                              *arguments)["surfaces"][0]
        return [round(math.copysign((abs(c["volumeMm3"]) * 3 / 4 / math.pi) ** (1 / 3),
                                    c["volumeMm3"])) for c in surface["components"]]

    def test_all(self):
        self.assertEqual(self.radii(), [13, -8, 4])
        self.assertIn(", 2 pieces, 1 cavity;", self.mesh("onion.nii", "--iso", "0").stdout)

    def test_fill_cavities(self):
        self.assertEqual(self.radii("--fill-cavities"), [13])

    def test_largest_keeps_its_cavity(self):
        self.assertEqual(self.radii("--largest"), [13, -8])

    def test_min_volume(self):
        self.assertEqual(self.radii("--min-volume", "200"), [13, -8, 4])  # 4/3 pi 4^3 = 268
        self.assertEqual(self.radii("--min-volume", "350"), [13, -8])
        self.assertEqual(self.radii("--min-volume", "3000"), [13])  # 4/3 pi 8^3 = 2145

    def test_all_together(self):
        self.assertEqual(self.radii("--largest", "--fill-cavities", "--min-volume", "1"), [13])


if __name__ == "__main__":
    main()
