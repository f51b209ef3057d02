"""adaptiso-simplify: values at points come along, in the surface's file and in files beside it."""

import math
import struct
import unittest

from support import BAD_INPUT, lines, main
from headDefects import icosphere
from simplifySupport import (SimplifyTest, annot_table, ply, read_annot, read_curv, read_pial,
                             write_annot, write_curv, write_pial)

try:
    import nibabel
    import numpy
except ImportError:  # Debian's python3-nibabel
    nibabel = None
try:
    import vtk
except ImportError:  # Debian's python3-vtk9
    vtk = None

BALL = icosphere(10, 4)
# edges are below 1.6 mm, so that a value with slope 1 differs by less at neighbours
EDGE = 1.6


def label_of(point):
    """Three regions: slices by height."""
    return 1 if point[2] < -3 else 2 if point[2] < 3 else 3


class FreeSurfer(SimplifyTest):
    def setUp(self):
        super().setUp()
        points = BALL[0]
        write_pial(self.path("lh.pial"), BALL)
        write_curv(self.path("lh.thickness"), [p[2] for p in points], len(BALL[1]))
        self.table = annot_table(["low", "middle", "high"])
        write_annot(self.path("lh.aparc.annot"), [label_of(p) for p in points], self.table)

    def simplified(self, *arguments):
        self.path("out").mkdir()
        report = self.simplify("lh.pial", "--max-error", "0.2", "-o", "out/", *arguments)
        return report, read_pial(self.path("out/lh.pial"))

    def test_numbers_are_interpolated_and_labels_are_the_nearest(self):
        report, (points, triangles, _) = self.simplified("--data", "lh.thickness", "--data",
                                                         "lh.aparc.annot")
        self.assertEqual([data["output"] for data in report["data"]],
                         ["lh.thickness", "lh.aparc.annot"])
        self.assertEqual([data["labels"] for data in report["data"]], [False, True])
        values, faces = read_curv(self.path("out/lh.thickness"))
        self.assertEqual((len(values), faces), (len(points), len(triangles)))
        for point, value in zip(points, values):
            # the value is the height of the nearest place, 0.2 mm off at most
            self.assertLess(abs(value - point[2]), 0.2 + 1e-5)
        labels, table = read_annot(self.path("out/lh.aparc.annot"))
        self.assertEqual(table, self.table)
        for point, label in zip(points, labels):
            if min(abs(point[2] + 3), abs(point[2] - 3)) > EDGE:
                self.assertEqual(label, label_of(point))
            self.assertIn(label, (1, 2, 3))

    def test_frames_of_an_mgh_come_along(self):
        heights = [p[2] for p in BALL[0]]
        header = struct.pack(">6i", 1, len(heights), 1, 1, 2, 3) + bytes(260)
        both = struct.pack(f">{2 * len(heights)}f", *heights, *(-z for z in heights))
        self.path("lh.z.mgh").write_bytes(header + both + b"mri_surf2surf --s jane")
        report, (points, _, _) = self.simplified("--data", "lh.z.mgh")
        self.assertEqual(report["data"][0]["format"], "FreeSurfer mgh")
        content = self.path("out/lh.z.mgh").read_bytes()
        count = len(points)
        self.assertEqual(struct.unpack(">6i", content[:24]), (1, count, 1, 1, 2, 3))
        self.assertEqual(len(content), 284 + 8 * count)  # no command
        values = struct.unpack(f">{2 * count}f", content[284:])
        for point, value, turned in zip(points, values[:count], values[count:]):
            self.assertLess(abs(value - point[2]), 0.2 + 1e-5)
            self.assertEqual(turned, -value)
        self.path("lh.z.mgz").write_bytes(b"")
        self.refused(BAD_INPUT, "lh.z.mgz: is packed; unpack it", "lh.pial", "--max-error", "1",
                     "--data", "lh.z.mgz", "-o", "out/b.pial")

    def test_points_that_stay_keep_their_values_to_the_bit(self):
        _, (points, _, _) = self.simplified("--data", "lh.thickness")
        values, _ = read_curv(self.path("out/lh.thickness"))
        exact = {struct.pack(">3f", *p): struct.unpack(">f", struct.pack(">f", p[2]))[0]
                 for p in BALL[0]}
        stayed = 0
        for point, value in zip(points, values):
            key = struct.pack(">3f", *point)
            if key in exact:
                stayed += 1
                self.assertAlmostEqual(value, exact[key], 5)

    def test_in_the_same_folder_names_are_marked(self):
        report = self.simplify("lh.pial", "--max-error", "0.2", "-o", "lh.white", "--data",
                               "lh.thickness", "--data", "lh.aparc.annot")
        self.assertEqual([data["output"] for data in report["data"]],
                         ["lh.simplified.thickness", "lh.aparc.simplified.annot"])
        self.assertTrue(self.path("lh.simplified.thickness").is_file())

    def test_values_of_another_surface_are_refused(self):
        write_curv(self.path("rh.thickness"), [1, 2, 3])
        self.refused(BAD_INPUT, "rh.thickness: has values for 3 points; lh.pial has 2,562",
                     "lh.pial", "--max-error", "1", "-o", "lh.vtp", "--data", "rh.thickness")
        self.path("rh.curv").write_bytes(b"solid x\n")
        self.refused(BAD_INPUT, "rh.curv: .*FF FF FF", "lh.pial", "--max-error", "1", "-o",
                     "lh.vtp", "--data", "rh.curv")
        self.refused(BAD_INPUT, "none.curv: no such file", "lh.pial", "--max-error", "1", "-o",
                     "lh.vtp", "--data", "none.curv")

    def test_in_a_batch_each_has_its_own(self):
        for name in ("a", "b"):
            self.path(name + ".ply").write_text(ply(BALL))
            write_curv(self.path(name + ".curv"), [p[2] for p in BALL[0]])
        arguments = ("a.ply", "b.ply", "--max-error", "0.2", "--data", "{name}.curv", "-o", "out/",
                     "--skip-existing")
        self.assertEqual(self.run_simplify(*arguments).returncode, 0)
        self.assertTrue(self.path("out/a.curv").is_file() and self.path("out/b.curv").is_file())
        self.assertEqual(self.run_simplify(*arguments).stdout.count("before "), 2)
        write_curv(self.path("a.curv"), [p[1] for p in BALL[0]])
        self.path("out/b.curv").unlink()
        again = self.run_simplify(*arguments).stdout
        self.assertRegex(again, "a.ply: .*made again: the input a.curv has changed")
        self.assertRegex(again, "b.ply: .*made again: b.curv is gone")

    @unittest.skipIf(nibabel is None, "needs python3-nibabel")
    def test_nibabel_reads_them(self):
        _, (points, _, _) = self.simplified("--data", "lh.thickness", "--data", "lh.aparc.annot")
        values = nibabel.freesurfer.read_morph_data(self.path("out/lh.thickness"))
        self.assertEqual(len(values), len(points))
        labels, colors, names = nibabel.freesurfer.read_annot(self.path("out/lh.aparc.annot"))
        self.assertEqual(names, [b"low", b"middle", b"high"])
        self.assertEqual(len(labels), len(points))
        read, faces = nibabel.freesurfer.read_geometry(self.path("out/lh.pial"))
        self.assertEqual(read.shape, (len(points), 3))
        # and their files are read here
        nibabel.freesurfer.write_morph_data(str(self.path("lh.sulc")),
                                            numpy.arange(2562, dtype="f4"))
        nibabel.freesurfer.write_annot(str(self.path("lh.x.annot")),
                                       numpy.arange(2562) % 2,
                                       numpy.array([[1, 2, 3, 0, 0], [4, 5, 6, 0, 0]]),
                                       ["a", "b"], fill_ctab=True)
        self.simplify("lh.pial", "--max-error", "0.2", "-o", "out/lh.white", "--data", "lh.sulc",
                      "--data", "lh.x.annot")
        _, _, names = nibabel.freesurfer.read_annot(self.path("out/lh.x.annot"))
        self.assertEqual(names, [b"a", b"b"])


@unittest.skipIf(nibabel is None, "needs python3-nibabel")
class Gifti(SimplifyTest):
    def write_gifti(self, name, arrays, labels=()):
        image = nibabel.gifti.GiftiImage()
        image.meta["AnatomicalStructurePrimary"] = "CortexLeft"
        image.meta["UserName"] = "jane"
        table = nibabel.gifti.GiftiLabelTable()
        for key, word in labels:
            label = nibabel.gifti.GiftiLabel(key, 1, 0, 0, 1)
            label.label = word
            table.labels.append(label)
        image.labeltable = table
        for array, intent, kind in arrays:
            image.add_gifti_data_array(nibabel.gifti.GiftiDataArray(
                numpy.asarray(array, kind), intent, datatype=kind,
                meta=nibabel.gifti.GiftiMetaData(Name="depth")))
        nibabel.save(image, str(self.path(name)))

    def test_shapes_and_labels_come_along(self):
        points = numpy.array(BALL[0])
        self.write_gifti("in.surf.gii", [(points, "NIFTI_INTENT_POINTSET", "float32"),
                                         (BALL[1], "NIFTI_INTENT_TRIANGLE", "int32")])
        self.write_gifti("in.shape.gii", [(points[:, 2], "NIFTI_INTENT_SHAPE", "float32"),
                                          (points[:, 0], "NIFTI_INTENT_SHAPE", "float32")])
        labels = [label_of(p) for p in BALL[0]]
        self.write_gifti("in.label.gii", [(labels, "NIFTI_INTENT_LABEL", "int32")],
                         [(1, "low"), (2, "middle"), (3, "high & <far>")])
        self.path("out").mkdir()
        self.simplify("in.surf.gii", "--max-error", "0.2", "-o", "out/in.surf.gii", "--data",
                      "in.shape.gii", "--data", "in.label.gii")
        surface = nibabel.load(str(self.path("out/in.surf.gii")))
        after = surface.darrays[0].data
        shape = nibabel.load(str(self.path("out/in.shape.gii")))
        self.assertEqual([a.intent for a in shape.darrays], [2005, 2005])
        self.assertEqual(shape.darrays[0].meta["Name"], "depth")
        self.assertEqual(shape.meta["AnatomicalStructurePrimary"], "CortexLeft")
        self.assertNotIn(b"jane", self.path("out/in.shape.gii").read_bytes())
        self.assertLess(abs(shape.darrays[0].data - after[:, 2]).max(), 0.2 + 1e-5)
        self.assertLess(abs(shape.darrays[1].data - after[:, 0]).max(), 0.2 + 1e-5)
        label = nibabel.load(str(self.path("out/in.label.gii")))
        self.assertEqual(label.labeltable.get_labels_as_dict(),
                         {1: "low", 2: "middle", 3: "high & <far>"})
        self.assertEqual(set(label.darrays[0].data), {1, 2, 3})
        self.assertEqual(len(label.darrays[0].data), len(after))


class InTheFile(SimplifyTest):
    PROPERTIES = ("property float nx\nproperty float ny\nproperty float nz\n"
                  "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                  "property double depth\nproperty int part")

    def setUp(self):
        super().setUp()
        values = [(*(x / 10 for x in p), 255 if p[0] > 0 else 0, 128, round(127 + 12 * p[2]),
                   p[2], label_of(p)) for p in BALL[0]]
        self.path("in.ply").write_text(ply(BALL, self.PROPERTIES, values))

    def test_values_go_from_ply_to_ply(self):
        report = self.simplify("in.ply", "--max-error", "0.2", "-o", "out.ply")
        self.assertEqual(report["output"]["values"], ["RGB", "depth", "part"])
        header, body = self.path("out.ply").read_bytes().split(b"end_header\n", 1)
        kinds = dict(reversed(line.split()[1:]) for line in header.decode().splitlines()
                     if line.startswith("property ") and "list" not in line)
        self.assertEqual({name: kinds[name] for name in ("red", "depth", "part", "nx")},
                         {"red": "uchar", "depth": "double", "part": "uchar", "nx": "float"})
        count = report["output"]["vertices"]
        codes = {"double": "d", "float": "f", "uchar": "B"}
        row = struct.Struct("<" + "".join(codes[kind] for kind in kinds.values()))
        for n in range(count):
            value = dict(zip(kinds, row.unpack_from(body, n * row.size)))
            point = value["x"], value["y"], value["z"]
            self.assertLess(abs(value["depth"] - point[2]), 0.2 + 1e-9)
            self.assertLess(abs(value["blue"] - 127 - 12 * point[2]), 0.2 * 12 + 1.5)
            self.assertEqual(value["green"], 128)
            if min(abs(point[2] + 3), abs(point[2] - 3)) > EDGE:
                self.assertEqual(value["part"], label_of(point))
            normal = value["nx"], value["ny"], value["nz"]
            self.assertAlmostEqual(math.sqrt(sum(x * x for x in normal)), 1, 5)
            self.assertGreater(sum(a * b for a, b in zip(normal, point)), 9.5)

    @unittest.skipIf(vtk is None, "needs python3-vtk9")
    def test_values_go_to_vtk_and_back(self):
        self.simplify("in.ply", "--max-error", "0.1", "-o", "one.vtp")
        self.simplify("one.vtp", "--max-error", "0.1", "-o", "two.vtk")
        reader = vtk.vtkPolyDataReader()
        reader.SetFileName(str(self.path("two.vtk")))
        reader.ReadAllScalarsOn()
        reader.ReadAllFieldsOn()
        reader.ReadAllNormalsOn()
        reader.Update()
        data = reader.GetOutput()
        arrays = data.GetPointData()
        depth, part, colors = (arrays.GetArray(name) for name in ("depth", "part", "RGB"))
        self.assertEqual(colors.GetNumberOfComponents(), 3)
        for n in range(data.GetNumberOfPoints()):
            point = data.GetPoint(n)
            self.assertLess(abs(depth.GetValue(n) - point[2]), 0.2 + 1e-9)
            self.assertIn(part.GetValue(n), (1, 2, 3))

    def test_each_format_holds_what_it_can(self):
        everything, colors, nothing = ["RGB", "depth", "part"], ["RGB"], []
        held = {"vtp": everything, "vtk": everything, "ply": everything, "obj": colors,
                "off": colors, "stl": nothing, "gii": nothing, "pial": nothing, "tri": nothing}
        for ending, kept in held.items():
            with self.subTest(ending):
                first = self.simplify("in.ply", "--max-error", "0.2", "--input-coordinates", "ras",
                                      "-o", f"a.{ending}")
                self.assertEqual(first["output"]["values"], kept)
                left = [name for name in everything if name not in kept]
                told = [text for text in lines(first["warnings"]) if "left out" in text]
                self.assertEqual([text.endswith(": " + ", ".join(left)) for text in told],
                                 [True] if left else [])
                again = self.simplify(f"a.{ending}", "--max-error", "0.2", "-o", "b.vtp")
                self.assertEqual(again["output"]["values"], kept)
                self.assertEqual(again["input"]["triangles"], first["output"]["triangles"])
                self.assertLessEqual(again["output"]["triangles"], first["output"]["triangles"])

    def test_values_of_triangles_are_left_out_with_a_warning(self):
        (self.folder / "colored.ply").write_text(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
            "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
            "property uchar red\nproperty int part\nend_header\n"
            "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
            "3 0 2 1 255 1\n3 0 1 3 255 1\n3 1 2 3 255 1\n3 0 3 2 255 1\n")
        report = self.simplify("colored.ply", "--max-error", "0.1", "-o", "out.ply")
        self.assertEqual([(w["code"], w["file"]) for w in report["warnings"]],
                         [("array-left-out", "colored.ply")])
        self.assertTrue(report["warnings"][0]["text"].endswith("left out: red, part"))

    def test_a_format_without_values_is_a_warning(self):
        report = self.simplify("in.ply", "--max-error", "0.2", "-o", "out.stl")
        self.assertEqual(lines(report["warnings"]), ["out.stl: STL holds no values at points; "
                                              "left out: RGB, depth, part"])
        self.assertEqual(report["output"]["values"], [])


if __name__ == "__main__":
    main()
