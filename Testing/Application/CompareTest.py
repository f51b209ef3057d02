"""adaptiso-compare: numbers known on paper, overlaps, colours, checks and reports."""

import json
import math
import re
import subprocess
import unittest

from support import BAD_INPUT, BIN, CHECK_FAILED, Image, ball, main, write_4d_nifti, write_nifti
from compareSupport import README, CompareTest, plane, sphere
from headDefects import cube

try:
    import vtk
except ImportError:  # Debian's python3-vtk9
    vtk = None


class Truth(CompareTest):
    def test_a_surface_with_itself(self):
        self.write("a.off", sphere(10))
        report = self.compare("a.off", "a.off", "--samples", "5000")
        for direction in ("aToB", "bToA", "combined"):
            distances = report["distances"][direction]
            # samples are rounded off their triangle's plane by some 1e-15 of 10 mm
            self.assertLess(distances["maxMm"], 1e-13)
            # a sample on an edge may have the neighbour as its nearest: rounding decides
            self.assertLess(distances["p95NormalDeviationDeg"], 1e-5)
        for difference in report["differences"].values():
            self.assertEqual(set(difference.values()), {0})

    def test_shifted_planes(self):
        self.write("a.off", plane(0))
        self.write("b.off", plane(0.75))
        report = self.compare("a.off", "b.off", "--voxel", "0.5", "--samples", "1000")
        diagonal = math.sqrt(200)
        self.assertAlmostEqual(report["b"]["boundingBoxDiagonalMm"], diagonal, 12)
        for direction, samples in (("aToB", 1000), ("bToA", 1000), ("combined", 2000)):
            distances = report["distances"][direction]
            self.assertEqual(distances["samples"], samples)
            for key in ("mean", "rms", "p95", "p99", "max"):  # all of them exactly the shift
                self.assertAlmostEqual(distances[key + "Mm"], 0.75, 12)
                self.assertAlmostEqual(distances["inVoxels"][key], 1.5, 12)
                self.assertAlmostEqual(distances["percentOfDiagonal"][key], 75 / diagonal, 12)
            self.assert_encloses(distances, 0.75, diagonal)
            self.assertEqual(distances["meanNormalDeviationDeg"], 0)
        self.assertEqual(report["differences"]["area"], {"mm2": 0, "percent": 0})
        self.assertEqual(report["differences"]["volume"], {"mm3": None, "percent": None})

    def test_concentric_spheres(self):
        self.write("a.off", sphere(12, 96))
        self.write("b.off", sphere(10, 96))
        report = self.compare("a.off", "b.off", "--samples", "20000")
        # facets of pi/48 lie at most 1 - cos(pi/48) = 0.2 % within the sphere (twice that at the
        # middle of a quad's diagonal)
        sag = 12 * 2 * (1 - math.cos(math.pi / 48))
        for direction in ("aToB", "bToA", "combined"):
            distances = report["distances"][direction]
            for key in ("meanMm", "rmsMm", "p95Mm", "p99Mm", "maxMm"):
                self.assertAlmostEqual(distances[key], 2, delta=sag)
            self.assert_encloses(distances, distances["maxMm"], 35)
            # two facets that overlap differ by at most their own angles
            self.assertLess(distances["p95NormalDeviationDeg"], 2 * 180 / 48)
        area, volume = report["differences"]["area"], report["differences"]["volume"]
        self.assertAlmostEqual(area["percent"], 44, 9)  # the same polyhedron: 1.2^2, 1.2^3
        self.assertAlmostEqual(volume["percent"], 72.8, 9)
        self.assertAlmostEqual(volume["mm3"] / (4 / 3 * math.pi * 728), 1, delta=0.01)

    def test_one_sided(self):
        """A small plane above a large one: 0.75 one way, up to the far corner the other."""
        self.write("a.off", plane(0.75, 5))
        self.write("b.off", plane(0, 10))
        report = self.compare("a.off", "b.off", "--one-sided", "--samples", "1000")
        self.assertIsNone(report["distances"]["bToA"])
        self.assertEqual(report["distances"]["combined"], report["distances"]["aToB"])
        self.assertAlmostEqual(report["distances"]["combined"]["maxMm"], 0.75, 12)
        report = self.compare("a.off", "b.off", "--samples", "1000")
        self.assertAlmostEqual(report["distances"]["combined"]["maxMm"],
                               math.sqrt(50 + 0.75 ** 2), 12)
        self.assertEqual(report["distances"]["combined"]["maxPointMm"], [10, 10, 0])
        hausdorff = report["distances"]["combined"]["hausdorff"]
        self.assertEqual((hausdorff["pointMm"], hausdorff["nearestMm"]), ([10, 10, 0], [5, 5, 0.75]))

    def assert_encloses(self, distances, truth, size):
        hausdorff = distances["hausdorff"]
        self.assertIs(hausdorff["isComplete"], True)
        self.assertLessEqual(hausdorff["lowerMm"], truth)
        self.assertGreaterEqual(hausdorff["upperMm"], truth)
        self.assertAlmostEqual(hausdorff["toleranceMm"], max(1e-3 * hausdorff["lowerMm"], 1e-6 * size), places=12)
        self.assertLessEqual(hausdorff["upperMm"] - hausdorff["lowerMm"], hausdorff["toleranceMm"])

    def test_the_farthest_point_need_be_no_vertex(self):
        """Between three small triangles, farthest from a point on an edge that no sample hits."""
        self.write("a.off", ([(0, 0, 0), (8, 0, 0), (0, 6, 0)], [(0, 1, 2)]))
        points, triangles = [], []
        for x, y in ((0, 0), (8, 0), (0, 6)):
            triangles.append(tuple(range(len(points), len(points) + 3)))
            points += [(x, y, 0), (x, y, 1), (x, y, 2)]
        points[2] = (-1, -1, 2)  # one has area
        self.write("b.off", (points, triangles))
        report = self.compare("a.off", "b.off", "--one-sided", "--samples", "1")
        distances = report["distances"]["combined"]
        self.assert_encloses(distances, 5, 15)  # of a right angle, half the longest side
        self.assertLess(distances["maxMm"], 4.9)

    @unittest.skipIf(vtk is None, "needs python3-vtk9")
    def test_vertex_distances_are_those_of_vtk(self):
        self.write("a.off", sphere(12, 24, (1, 2, 3)))
        self.write("b.off", cube((-8, -8, -8), (9, 7, 8)))
        self.compare("a.off", "b.off", "--colored", "out.vtp")
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(str(self.path("out.vtp")))
        reader.Update()
        data = reader.GetOutput()
        distances = data.GetPointData().GetScalars()
        self.assertEqual(distances.GetName(), "DistanceMm")
        points, triangles = cube((-8, -8, -8), (9, 7, 8))
        surface = vtk.vtkPolyData()
        corners, cells = vtk.vtkPoints(), vtk.vtkCellArray()
        corners.SetDataTypeToDouble()
        for p in points:
            corners.InsertNextPoint(p)
        for t in triangles:
            cells.InsertNextCell(3, t)
        surface.SetPoints(corners)
        surface.SetPolys(cells)
        locator = vtk.vtkCellLocator()
        locator.SetDataSet(surface)
        locator.BuildLocator()
        cell, part, squared = vtk.reference(0), vtk.reference(0), vtk.reference(0.0)
        self.assertEqual(data.GetNumberOfPoints(), len(sphere(12, 24)[0]))
        for n in range(data.GetNumberOfPoints()):
            locator.FindClosestPoint(data.GetPoint(n), [0, 0, 0], cell, part, squared)
            # rounding of squares of some 100 mm2 is some 1e-14 mm2, its root 1e-7 mm at 0 mm
            self.assertAlmostEqual(distances.GetValue(n), math.sqrt(squared.get()), delta=1e-6)

    def test_of_thousands_that_all_cross_some_samples_are_measured(self):
        points, triangles = [], []
        for n in range(2000):
            a, b = 2 * math.pi * n * 0.618034, math.acos(1 - 2 * ((n * 0.7548777) % 1))
            u = (math.cos(a) * math.sin(b), math.sin(a) * math.sin(b), math.cos(b))
            v = (-math.sin(a), math.cos(a), 0)
            points += [tuple(50 * x for x in u), tuple(50 * x for x in v),
                       tuple(-50 * (x + y) for x, y in zip(u, v))]
            triangles.append((3 * n, 3 * n + 1, 3 * n + 2))
        self.write("a.off", (points, triangles))
        self.write("b.off", ([(x + 0.1, y, z) for x, y, z in points], triangles))
        report = self.compare("a.off", "b.off", "--samples", "20000", "--one-sided")
        both = report["distances"]["combined"]
        self.assertIn(both["measured"], range(100, 10000))
        self.assertLessEqual(both["maxMm"], 0.1 + 1e-9)  # the shift: rough distances were of millimetres
        self.assertGreater(both["meanErrorMm"], 0)
        self.assertLess(both["meanErrorMm"], both["meanMm"] / 4)
        hausdorff = both["hausdorff"]
        self.assertLessEqual(hausdorff["lowerMm"], 0.1)
        warning, *others = (w for w in report["warnings"] if w["code"] == "distance-rough")
        self.assertEqual([w["text"] for w in others], [] if hausdorff["isComplete"] else [
            f"the maximum distance is known to lie between {hausdorff['lowerMm']:.4g} and "
            f"{hausdorff['upperMm']:.4g} mm only: many triangles lie about as far from each point"])
        self.assertRegex(warning["text"], r"^[\d,]+ points lie near more than 500 triangles each, more than are "
                                          r"measured: [\d,]+ of 20,000 samples are, which gives the mean to within "
                                          r"0\.\d+ mm \(two standard errors\)$")


class Colored(CompareTest):
    def test_holds_the_surface_and_its_colours(self):
        points, triangles = plane(0)
        self.write("a.off", ([(x, y, x / 10) for x, y, _ in points], triangles))
        self.write("b.off", plane(0, 20))
        report = self.compare("a.off", "b.off", "--colored", "out.vtp")
        self.assertAlmostEqual(report["colored"]["maximumMm"], 1, 12)
        self.assertEqual(report["colored"]["bytes"], self.path("out.vtp").stat().st_size)
        # it is a surface as any other: A
        again = self.compare("out.vtp", "a.off")
        self.assertEqual(again["a"]["coordinates"], "ras")
        self.assertLess(again["distances"]["combined"]["maxMm"], 1e-12)
        if vtk is None:
            return
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(str(self.path("out.vtp")))
        reader.Update()
        data = reader.GetOutput().GetPointData()
        distances, colors = data.GetScalars(), data.GetArray("DistanceColor")
        self.assertEqual([round(distances.GetValue(n), 12) for n in range(4)], [0, 1, 1, 0])
        self.assertEqual(colors.GetDataTypeAsString(), "unsigned char")
        dark, yellow = (68, 1, 84), (253, 231, 37)  # the ends of viridis
        self.assertEqual([colors.GetTuple(n) for n in range(4)], [dark, yellow, yellow, dark])

    def test_no_distance_is_dark_everywhere(self):
        self.write("a.off", plane(0))
        self.assertEqual(self.compare("a.off", "a.off", "--colored",
                                      "out.vtp")["colored"]["maximumMm"], 0)


class Volumes(CompareTest):
    """An image of 20 x 20 x 20 voxels of 1 x 1 x 2 mm; the first voxel's centre is 0, 0, 0."""

    def setUp(self):
        super().setUp()
        write_nifti(self.path("image.nii"), Image((20, 20, 20), "B", bytes(8000), (1, 1, 2)))

    def overlap(self, a, b):
        self.write("a.off", a)
        self.write("b.off", b)
        return self.compare("a.off", "b.off", "--volume", "image.nii",
                            "--samples", "1000")["overlap"]

    def test_shifted_cubes(self):
        # between centres: 6 x 6 x 3 voxels each, shifted by 2 along each axis in turn
        for axis, both in ((0, 4 * 6 * 3), (1, 6 * 4 * 3), (2, 6 * 6 * 2)):
            shift = [0.0] * 3
            shift[axis] = 2
            low, high = (3.5, 3.5, 5), (9.5, 9.5, 11)
            overlap = self.overlap(cube(low, high), cube([x + s for x, s in zip(low, shift)],
                                                         [x + s for x, s in zip(high, shift)]))
            with self.subTest(axis):
                self.assertEqual(overlap["voxelsA"], 108)
                self.assertEqual(overlap["voxelsB"], 108)
                self.assertEqual(overlap["voxelsBoth"], both)
                self.assertAlmostEqual(overlap["dice"], both / 108, 12)
                # voxels in one of both, 2 mm3 each, over 6 faces of 36 mm2
                self.assertAlmostEqual(overlap["meanBoundaryOffsetMm"],
                                       2 * (108 - both) * 2 / 216, 12)

    def test_faces_edges_and_corners_on_voxel_centres(self):
        """Rows through edges, corners and within faces: each cube has a half-open share of the
        centres on its faces, so that cubes side by side share none and leave none out."""
        for corner in ((9, 3, 4), (3, 9, 4), (3, 3, 10)):
            overlap = self.overlap(cube((3, 3, 4), (9, 9, 10)),
                                   cube(corner, [x + 6 for x in corner]))
            with self.subTest(corner):
                self.assertEqual((overlap["voxelsA"], overlap["voxelsB"], overlap["voxelsBoth"]),
                                 (108, 108, 0))

    def test_rows_through_the_vertices_of_a_sphere(self):
        """Its poles, meridians and equator lie on rows; a row that leaks would add ten voxels."""
        overlap = self.overlap(sphere(7, 48, (10, 10, 20)), cube((-9, -9, -9), (90, 90, 90)))
        squares = [(x - 10) ** 2 + (y - 10) ** 2 + (2 * z - 20) ** 2
                   for x in range(20) for y in range(20) for z in range(20)]
        # facets are at most pi/24 wide and high: the circles around them have at most half that
        # diagonal, so that they lie at least cos(pi/24/sqrt(2)) r = 6.97 mm out: 6.97^2 = 48.6
        self.assertGreaterEqual(overlap["voxelsA"], sum(square <= 48 for square in squares))
        self.assertLessEqual(overlap["voxelsA"], sum(square <= 49 for square in squares))
        self.assertEqual(overlap["voxelsBoth"], overlap["voxelsA"])

    def test_offset_of_concentric_spheres(self):
        overlap = self.overlap(sphere(8, 96, (10, 10, 20)), sphere(6, 96, (10, 10, 20)))
        exact = 4 / 3 * (8 ** 3 - 6 ** 3) / (2 * (8 ** 2 + 6 ** 2))  # 1.973
        # voxels that the surface cuts err by chance: some 1 % of 1240 mm3
        self.assertAlmostEqual(overlap["meanBoundaryOffsetMm"], exact, delta=0.06)
        self.assertAlmostEqual(overlap["dice"], 2 * 6 ** 3 / (8 ** 3 + 6 ** 3), delta=0.02)

    def test_the_grid_ends_where_the_image_does(self):
        overlap = self.overlap(cube((-50, -50, -50), (50, 50, 50)),
                               cube((4.5, -9, -9), (90, 90, 90)))
        self.assertEqual((overlap["voxelsA"], overlap["voxelsB"], overlap["voxelsBoth"]),
                         (8000, 6000, 6000))

    def test_open_surfaces_have_no_overlap(self):
        self.write("a.off", plane(0))
        report = self.compare("a.off", "a.off", "--volume", "image.nii")
        self.assertIsNone(report["overlap"])
        self.assertRegex(report["warnings"][0]["text"], "not closed, so the overlap")

    def test_of_a_4d_image_one_is_chosen(self):
        self.write("a.off", cube((3.5, 3.5, 5), (9.5, 9.5, 11)))
        still = Image((20, 20, 20), "B", bytes(8000))
        write_4d_nifti(self.path("4d.nii"), [still, still])
        self.refused(BAD_INPUT, "4d.nii.*2 volumes.*--volume-index", "a.off", "a.off", "--volume",
                     "4d.nii")
        report = self.compare("a.off", "a.off", "--volume", "4d.nii", "--volume-index", "1")
        self.assertEqual(report["overlap"]["dice"], 1)

    def test_voxel_is_a_cube_of_the_same_volume(self):
        self.write("a.off", plane(0))
        report = self.compare("a.off", "a.off", "--volume", "image.nii")
        self.assertAlmostEqual(report["voxelMm"], 2 ** (1 / 3), 12)
        self.assertEqual(report["volume"], {"file": "image.nii", "format": "NIfTI-1",
                                            "sizeVoxels": [20, 20, 20], "spacingMm": [1, 1, 2]})


class Checks(CompareTest):
    def setUp(self):
        super().setUp()
        self.write("a.off", plane(0, 10))
        self.write("b.off", plane(0.5, 10))

    def test_passed(self):
        report = self.compare("a.off", "b.off", "--max-mean", "0.5", "--max-hausdorff", "0.500001")
        mean, hausdorff = report["checks"]
        self.assertEqual(mean, {"name": "maxMean", "limitMm": 0.5, "valueMm": 0.5, "passed": True})
        self.assertEqual(hausdorff["valueMm"], report["distances"]["combined"]["hausdorff"]["upperMm"])
        self.assertEqual((hausdorff["name"], hausdorff["passed"]), ("maxHausdorff", True))
        self.assertLessEqual(hausdorff["valueMm"], 0.500001)

    def test_what_is_not_shown_does_not_pass(self):
        done = self.run_compare("a.off", "b.off", "--max-hausdorff", "0.5")  # but for rounding it is
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(done.stderr, r"^adaptiso-compare: check failed: maximum distance may be "
                                      r"0\.50000000\d* mm, at most 0\.5 mm\n$")

    def test_failed_says_so_and_still_writes(self):
        done = self.run_compare("a.off", "b.off", "--max-mean", "0.4", "--max-hausdorff", "0.6",
                                "--json", "report.json", "--colored", "out.vtp", "--quiet")
        self.assertEqual((done.returncode, done.stdout), (CHECK_FAILED, ""))
        self.assertEqual(done.stderr, "adaptiso-compare: check failed: mean distance 0.5 mm, "
                                      "at most 0.4 mm\n")
        self.assertEqual(self.names(), ["a.off", "b.off", "out.vtp", "report.json"])
        checks = json.loads(self.path("report.json").read_text())["checks"]
        self.assertEqual([check["passed"] for check in checks], [False, True])

    def test_hausdorff_fails_alone(self):
        done = self.run_compare("a.off", "b.off", "--max-mean", "1", "--max-hausdorff", "0.4")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertRegex(done.stderr, "^adaptiso-compare: check failed: maximum distance 0.5 mm")


def documented_keys():
    """The keys in the first column of README.md's table; a key that begins with a dot belongs to
    each of the parents of the row that ends in a colon before it."""
    section = README.read_text().split("## The report")[1]
    keys, parents = set(), []
    for cell, what in re.findall(r"^\| (`.*?`) \| (.*) \|$", section, re.MULTILINE):
        names = re.findall(r"`([^`]+)`", cell)
        if what.endswith(":"):
            parents = names
        for name in names:
            if name.startswith("."):
                keys |= {parent + name for parent in parents}
            elif not what.endswith(":"):
                keys.add(name)
    return keys


def keys_of(value, path=""):
    """The paths of all leaves; lists of numbers and texts are leaves."""
    if isinstance(value, dict):
        return {leaf for key, inner in value.items()
                for leaf in keys_of(inner, f"{path}.{key}" if path else key)}
    if path == "checks":
        return {leaf for check in value for leaf in keys_of(check, path)}
    return {path}


class Report(CompareTest):
    def setUp(self):
        super().setUp()
        self.write("a.off", sphere(7, 32, (10, 10, 10)))
        self.write("b.off", sphere(6.5, 24, (10, 10, 10)))
        write_nifti(self.path("image.nii"), Image((20, 20, 20), "B", bytes(8000)))

    def test_keys_are_the_documented_ones(self):
        report = self.compare("a.off", "b.off", "--volume", "image.nii", "--colored", "out.vtp",
                              "--max-mean", "9")
        self.assertEqual(report["schema"], "adaptiso-compare/1")
        self.assertEqual(keys_of(report), documented_keys())

    def test_holds_names_without_folders(self):
        self.path("folder").mkdir()
        self.write("folder/a.off", sphere(7, 16))
        report = self.compare("folder/a.off", "b.off", "--colored", "folder/out.vtp")
        self.assertNotIn("folder", json.dumps(report))

    def test_text_and_threads(self):
        """The same numbers, texts and files, to the byte, whatever the number of threads."""
        results = []
        for threads in (1, 2):
            report = self.compare("a.off", "b.off", "--volume", "image.nii", "--colored", "c.vtp",
                                  "--samples", "20000", "--threads", threads)
            for key in ("seconds", "peakMemoryMb"):
                del report[key]
            self.assertEqual(report["options"].pop("threads"), threads)
            text = self.run_compare("a.off", "b.off", "--voxel", "0.5", "--threads", threads).stdout
            lines = text.splitlines()[:-1]  # the last tells seconds
            self.assertRegex(text, r"mean, mm +0\.\d{4} +0\.\d{4} +0\.\d{4}\n")
            results.append((json.dumps(report), lines, self.path("c.vtp").read_bytes()))
        self.assertEqual(results[0], results[1])


class Readme(CompareTest):
    def test_examples_run(self):
        write_nifti(self.path("head.nii"), ball(24, 9))
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={"PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.names(), ["adaptive.vtp", "difference.html", "difference.vtp",
                                        "head.nii", "lh.pial",
                                        "reference.ply", "report.json"])


if __name__ == "__main__":
    main()
