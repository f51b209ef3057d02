"""adaptiso-labels as its users call it: what it writes, what it refuses, names, choices, batches."""

import base64
import json
import math
import random
import re
import struct
import subprocess
import zipfile
import zlib

from labelsSupport import LabelsTest, label_map, three_boxes
from support import (BAD_INPUT, BIN, CHECK_FAILED, OK, USAGE, Image, write_4d_nifti, write_metaimage,
                     main, write_nifti, write_nrrd)


class OutputTest(LabelsTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("boxes.nii"), three_boxes(spacing=(1, 1.5, 2), origin=(-5, 3, 20)))

    def test_writes_the_folder(self):
        done = self.labels("boxes.nii", "-o", "out")
        self.assertEqual(set(self.files("out")),
                         {"walls.vtp", "regions/1.vtp", "regions/2.vtp", "regions/7.vtp", "all.vtm",
                          "all.surf.gii", "all.label.gii", "regions.tsv", "report.json"})
        self.assertIn("3 regions", done.stdout)
        self.assertEqual(done.stdout.count("holds:"), 4)
        self.assertNotIn("FAILED", done.stdout)

    def test_refuses_formats_of_too_few_digits(self):
        # 1 km from the origin coordinates of single precision are 1/16 mm apart
        write_nifti(self.path("far.nii"),
                    three_boxes(spacing=(0.01, 0.01, 0.01), origin=(1e6, 0, 0)))
        self.refused(BAD_INPUT, r"regions/\*\.stl: STL keeps 24 bits of a coordinate",
                     "far.nii", "-o", "out", "--format", "stl")
        done = self.labels("far.nii", "-o", "out")
        self.assertIn("all.surf.gii is left out", done.stderr)
        self.assertIn("regions/1.vtp", self.files("out"))
        self.assertNotIn("all.surf.gii", self.files("out"))

    def test_is_named_after_the_input_by_default(self):
        self.labels("boxes.nii", "--quiet")
        self.assertTrue((self.path("boxes-labels") / "walls.vtp").is_file())

    def test_measures_agree_with_the_voxels_and_each_other(self):
        self.labels("boxes.nii", "-o", "out", "--max-error", "0")
        rows = self.table("out")
        self.assertEqual(set(rows), {1, 2, 7})
        voxel = 1 * 1.5 * 2
        self.assertEqual(int(rows[7]["voxels"]), 6 * 4 * 4)
        whole = sum(float(row["volume_mm3"]) for row in rows.values())
        # walls are smooth at the boxes' edges: that takes away less than a twentieth
        self.assertAlmostEqual(whole, 12 * 10 * 8 * voxel, delta=0.05 * 12 * 10 * 8 * voxel)
        for row in rows.values():
            self.assertEqual(row["euler_characteristic"], "2")
            self.assertEqual(row["components"], "1")
        self.assertEqual(rows[1]["neighbours"], "0,2,7")
        self.assertEqual(rows[7]["neighbours"], "1,2")

        report = self.folder_report("out")
        self.assertEqual(report["schema"], "adaptiso-labels/1")
        self.assertTrue(report["passed"])
        contacts = {}
        for region in report["regions"]:
            row = rows[region["label"]]
            self.assertEqual(region["triangles"], int(row["triangles"]))
            self.assertEqual(region["volumeMm3"], float(row["volume_mm3"]))
            shares = [each["areaMm2"] for each in region["neighbours"]]
            self.assertAlmostEqual(sum(shares), region["areaMm2"], delta=1e-6 * sum(shares))
            for each in region["neighbours"]:
                contacts[region["label"], each["label"]] = (each["areaMm2"], each["triangles"])
        for (a, b), (area, triangles) in contacts.items():
            if b != 0:
                # the same triangles, added up in another order
                self.assertAlmostEqual(contacts[b, a][0], area, delta=1e-12 * area)
                self.assertEqual(contacts[b, a][1], triangles)

    def test_every_format(self):
        for extension in ("vtk", "ply", "stl", "obj", "off", "gii", "tri", "surf", "glb",
                          "3mf"):
            with self.subTest(extension):
                self.labels("boxes.nii", "-o", extension, "--format", extension, "--quiet")
                files = self.files(extension)
                for label in (1, 2, 7):
                    self.assertIn(f"regions/{label}.{extension}", files)
                    self.assertIn(f"all/{label}.vtp", files)
                self.assertIn(b'file="all/7.vtp"', files["all.vtm"])
                frame = self.folder_report(extension)["output"]["coordinates"]
                self.assertEqual(frame, "tkras" if extension == "surf" else "ras")

    def assert_closed(self, corners):
        edges = set()
        for a, b, c in zip(*[iter(corners)] * 3):
            for edge in ((a, b), (b, c), (c, a)):
                self.assertNotIn(edge, edges)
                edges.add(edge)
        self.assertEqual({(b, a) for a, b in edges}, edges)

    def test_all_regions_in_one_file(self):
        self.path("boxes.tsv").write_text("index\tname\tcolor\n1\tA & B\t#ff8000\n7\tCore\t#0000ff\n")
        for name in ("body.glb", "body.3mf"):
            report = json.loads(self.labels("boxes.nii", "-o", name, "--json", "-").stdout)
            self.assertEqual(report["output"]["files"],
                             [{"file": name, "bytes": len(self.files()[name])}])
            self.assertIsNone(report["output"]["folder"])
            self.assertEqual({region["file"] for region in report["regions"]}, {name})
            self.labels("boxes.nii", "-o", "again." + name, "--threads", "1", "--quiet")
            self.assertEqual(self.files()["again." + name], self.files()[name])
        triangles = [region["triangles"] for region in report["regions"]]
        self.assertIn("body.glb: 3 regions of boxes.nii, GLB (glTF 2.0), RAS mm",
                      self.labels("boxes.nii", "-o", "body.glb").stdout)

        for name in ("body.glb", "body.3mf"):  # their shared walls are no faults
            checked = json.loads(subprocess.run([BIN / "adaptiso-check", name, "--profile", "print", "--json", "-"],
                                                cwd=self.folder, capture_output=True, check=True).stdout)
            self.assertEqual(checked["surfaces"][0]["solids"], 3)
            self.assertGreater(checked["surfaces"][0]["sharedWallTriangles"], 0)
            self.assertEqual([warning["code"] for warning in checked["warnings"]], ["several-solids"])
        glb = self.files()["body.glb"]
        length = struct.unpack_from("<I", glb, 12)[0]
        scene, bin_chunk = json.loads(glb[20:20 + length]), glb[28 + length:]
        self.assertEqual([node["name"] for node in scene["nodes"][1:]],
                         ["A & B", "region 2", "Core"])
        self.assertEqual(scene["materials"][2]["pbrMetallicRoughness"]["baseColorFactor"],
                         [0, 0, 1, 1])
        for mesh, due in zip(scene["meshes"], triangles):
            accessor = scene["accessors"][mesh["primitives"][0]["indices"]]
            self.assertEqual(accessor["count"], 3 * due)
            view = scene["bufferViews"][accessor["bufferView"]]
            self.assert_closed(struct.unpack_from(f"<{3 * due}I", bin_chunk, view["byteOffset"]))

        with zipfile.ZipFile(self.path("body.3mf")) as archive:
            model = archive.read("3D/3dmodel.model").decode()
        self.assertEqual(re.findall('<object .* name="(.*?)"', model), ["A &amp; B", "region 2", "Core"])
        self.assertEqual(re.findall('displaycolor="(.*?)"', model)[::2], ["#FF8000", "#0000FF"])
        self.assertEqual(model.count("<triangle "), sum(triangles))

    def test_one_stl_of_all_regions_scaled(self):
        whole, half = (json.loads(self.labels("boxes.nii", "-o", name, *scale, "--json", "-").stdout)
                       for name, scale in (("body.stl", ()), ("half.stl", ("--scale", "0.5"))))
        triangles = sum(region["triangles"] for region in whole["regions"])
        self.assertEqual(struct.unpack_from("<I", self.files()["body.stl"], 80), (triangles,))
        for one, other in zip(whole["regions"], half["regions"]):
            self.assertAlmostEqual(other["volumeMm3"], one["volumeMm3"] / 8)
            self.assertAlmostEqual(other["neighbours"][0]["areaMm2"], one["neighbours"][0]["areaMm2"] / 4)
        first, scaled = (struct.unpack_from("<3f", self.files()[name], 96) for name in ("body.stl", "half.stl"))
        self.assertEqual(first, tuple(2 * v for v in scaled))
        self.assertEqual((half["output"]["coordinates"], half["output"]["scale"]), (None, 0.5))
        self.assertEqual([warning["code"] for warning in half["warnings"]], ["surface-scaled"])
        self.refused(BAD_INPUT, r"--fit 9,9,9: body.3mf would be .* x .* x .* mm; --scale 0.\d+ fits", "boxes.nii", "-o", "body.3mf",
                     "--fit", "9,9,9")

    def test_one_file_refuses_what_needs_a_folder(self):
        for option in (["--format", "stl"], ["--write-map"], ["--layers"],
                       ["--file-names", "name"], ["--tetrahedra", "gmsh"]):
            self.refused(USAGE, f"{option[0]}: is for a folder, and -o a.glb is one file of all "
                         "regions; give -o a", "boxes.nii", "-o", "a.glb", *option)
        self.refused(USAGE, "voxel: 3MF holds points in mm only", "boxes.nii", "-o", "a.3mf",
                     "--coordinates", "voxel")
        self.refused(USAGE, "give -o a --format ply", "boxes.nii", "-o", "a.ply")
        self.refused(USAGE, "--scale, --fit: are for one file", "boxes.nii", "-o", "a", "--scale", "2")
        self.labels("boxes.nii", "-o", "{name}.glb", "--quiet")
        self.assertIn("boxes.glb", self.files())

    def test_frames(self):
        for frame in ("ras", "lps", "tkras", "voxel"):
            self.labels("boxes.nii", "-o", frame, "--coordinates", frame, "--quiet")
            self.assertEqual(self.folder_report(frame)["output"]["coordinates"], frame)
        self.refused(USAGE, "voxel: FreeSurfer holds points in mm only", "boxes.nii", "-o", "out",
                     "--format", "surf", "--coordinates", "voxel")

    def test_the_same_bytes_for_any_number_of_threads(self):
        write_nifti(self.path("noise.nii"),
                    Image((14, 14, 14), "B", [random.Random(5).randrange(5) for _ in range(14**3)]))
        for threads in (1, 2, 5):
            self.labels("noise.nii", "-o", f"t{threads}", "--threads", threads, "--quiet")
        self.assertEqual(self.files("t1"), self.files("t2"))
        self.assertEqual(self.files("t1"), self.files("t5"))

    def test_whole_numbered_floats_are_labels(self):
        write_nifti(self.path("floats.nii"),
                    three_boxes("f", spacing=(1, 1.5, 2), origin=(-5, 3, 20)))
        self.labels("boxes.nii", "-o", "a", "--quiet")
        self.labels("floats.nii", "-o", "b", "--quiet")
        a, b = self.files("a"), self.files("b")
        del a["report.json"], b["report.json"]  # these name the type of the samples
        self.assertEqual(a, b)

    def test_other_formats_of_images(self):
        for name, write in (("boxes.nrrd", write_nrrd), ("boxes.mha", write_metaimage)):
            write(self.path(name), three_boxes())
            self.labels(name, "-o", name + "-out", "--quiet")

    def test_replaces_its_own_folder_when_asked_to(self):
        self.labels("boxes.nii", "-o", "out", "--quiet")
        self.refused(BAD_INPUT, "out: exists and is not empty; --force replaces", "boxes.nii", "-o", "out")
        self.labels("boxes.nii", "-o", "out", "--force", "--labels", "1", "--format", "stl",
                    "--quiet")
        self.assertEqual({name for name in self.files("out") if name.startswith("regions/")},
                         {"regions/1.stl"})
        self.path("out/notes.txt").write_text("mine")
        self.refused(BAD_INPUT, "out: holds notes.txt, which this program does not write",
                     "boxes.nii", "-o", "out", "--force")

    def test_never_overwrites_an_input(self):
        self.path("in").mkdir()
        write_nifti(self.path("in/boxes.nii"), three_boxes())
        self.refused(BAD_INPUT, "in: holds an input", "in/boxes.nii", "-o", "in", "--force")
        self.refused(BAD_INPUT, "boxes.nii", "boxes.nii", "-o", "out", "--json", "boxes.nii")

    def test_json_report(self):
        done = self.labels("boxes.nii", "-o", "out", "--json", "-")
        report = json.loads(done.stdout)
        self.assertEqual(report["output"]["folder"], "out")
        self.assertTrue(report["output"]["written"])
        sizes = {each["file"]: each["bytes"] for each in report["output"]["files"]}
        self.assertEqual(sizes, {name: len(data) for name, data in self.files("out").items()})
        self.assertIn("crossings", report["seconds"])
        inside = self.folder_report("out")
        for key in inside:  # that of the folder differs in what differs from run to run alone
            if key not in ("output", "options"):
                self.assertEqual(inside[key], report[key], key)

    def test_report_page(self):
        self.path("boxes.tsv").write_text("index\tname\n1\tleft <b>\n2\tright\n7\tinner\n")
        self.labels("boxes.nii", "-o", "out", "--report", "page.html", "--pictures", "pictures",
                    "--quiet")
        page = self.path("page.html").read_text()
        self.assertIn("3 regions of boxes.nii", page)
        self.assertIn("left &lt;b&gt;", page)
        self.assertIn('"areRegions":true', page)
        self.assertNotIn("left <b>", page)
        pictures = {path.name for path in self.path("pictures").iterdir()}
        self.assertIn("regions.png", pictures)
        self.assertIn("contours-axial.png", pictures)
        self.assertNotIn("surface-1.png", pictures)

    def test_another_image_behind_the_regions(self):
        write_nifti(self.path("t1.nii"), Image((16, 14, 12), "h", list(range(16 * 14 * 12))))
        self.path("boxes.tsv").write_text("index\tname\n1\touter\n7\tinner\n")
        self.labels("boxes.nii", "-o", "out", "--report", "page.html", "--volume", "t1.nii", "-q", "--labels", "7")
        self.assertIn("outer (1) ", self.path("page.html").read_text())  # a neighbour that is not wanted
        self.path("broken.nii").write_text("no map")
        self.refused(BAD_INPUT, "none.nii", "broken.nii", "-o", "two", "--report", "p.html", "--volume", "none.nii")
        write_4d_nifti(self.path("4d.nii"), [three_boxes(), three_boxes()])
        self.refused(BAD_INPUT, "4d.nii: holds 2 volumes, must hold one here", "boxes.nii", "-o", "two", "--report",
                     "p.html", "--volume", "4d.nii")
        self.refused(USAGE, "--volume: is shown on the page", "boxes.nii", "-o", "two", "--volume",
                     "t1.nii")


class HardMapsTest(LabelsTest):
    """Maps that other programs fail on. The program's own checks judge; that they can fail is
    tested in LabelsCheckTest.cxx."""

    def made(self, name, image):
        write_nifti(self.path(name + ".nii"), image)
        for error in ("0", "0.4"):
            out = f"{name}-{error}"
            self.labels(name + ".nii", "-o", out, "--max-error", error, "--quiet")
            report = self.folder_report(out)
            self.assertTrue(report["passed"], report["checks"])
            self.assertEqual(len(report["regions"]), report["input"]["labels"])
            self.assertLessEqual(report["walls"]["errorBoundMm"], float(error))
        return report

    def test_a_map_without_background(self):
        report = self.made("full", label_map((6, 5, 4), lambda i, j, k: 1 + i // 3))
        self.assertEqual(len(report["regions"]), 2)

    def test_one_voxel(self):
        self.made("voxel", label_map((3, 3, 3), lambda i, j, k: 4 * (i == j == k == 1)))

    def test_one_slice_is_refused_as_an_image_of_two_dimensions(self):
        write_nifti(self.path("slice.nii"), label_map((9, 8, 1), lambda i, j, k: i > 2))
        self.refused(BAD_INPUT, "slice.nii: is a 2-D image or a single slice", "slice.nii", "-o",
                     "out")

    def test_checkerboard(self):
        self.made("checkers", label_map((6, 6, 6), lambda i, j, k: 1 + (i + j + k) % 2))
        self.made("holes", label_map((6, 6, 6), lambda i, j, k: (i + j + k) % 2))

    def test_touching_in_an_edge_and_in_a_corner(self):
        self.made("edge", label_map((6, 6, 4), lambda i, j, k: 3 if (i in (1, 2)) == (j in (1, 2))
                                    and 0 < i < 5 and 0 < j < 5 and 0 < k < 3 else 0))
        self.made("corner", label_map((6, 6, 6), lambda i, j, k: 3 if (i, j, k) in
                                      ((2, 2, 2), (3, 3, 3)) else 0))

    def test_sheet_of_one_voxel(self):
        self.made("sheet", label_map((12, 12, 9), lambda i, j, k: 2 if k == 4 else 1 if k < 4
                                     else 3))

    def test_noise(self):
        for seed in range(3):
            values = random.Random(seed)
            self.made(f"noise{seed}",
                      Image((10, 10, 10), "B", [values.randrange(5) for _ in range(1000)]))

    def test_negative_and_large_labels(self):
        write_nrrd(self.path("large.nrrd"), three_boxes())
        data = self.path("large.nrrd").read_bytes().replace(b"type: int16", b"type: int32")
        head, samples = data.split(b"\n\n", 1)
        numbers = {0: 0, 1: -5, 2: 614454277, 7: 2147483647}
        labels = [numbers[each] for each in struct.unpack(f"<{len(samples) // 2}h", samples)]
        self.path("large.nrrd").write_bytes(head + b"\n\n" +
                                            struct.pack(f"<{len(labels)}i", *labels))
        self.labels("large.nrrd", "-o", "out", "-q")
        self.assertEqual(set(self.table("out")), {-5, 614454277, 2147483647})
        self.assertTrue((self.path("out") / "regions" / "-5.vtp").is_file())


class IdsTest(LabelsTest):
    """Ids of connectomes, which 32 bits do not hold."""
    BIG, LARGEST, FAR = 720575940621039145, 2 ** 64 - 1, -2 ** 40

    def write_map(self, name, kind, numbers):
        """The three boxes with other labels, in 64 bits."""
        write_nrrd(self.path(name), three_boxes())
        head, samples = self.path(name).read_bytes().split(b"\n\n", 1)
        labels = [numbers[each] for each in struct.unpack(f"<{len(samples) // 2}h", samples)]
        self.path(name).write_bytes(head.replace(b"type: int16", b"type: " + kind.encode())
                                    + b"\n\n" + struct.pack(f"<{len(labels)}{'Q' if kind[0] == 'u' else 'q'}",
                                                            *labels))

    def walls(self, folder):
        """Types and values of the arrays of labels in walls.vtp."""
        text = (self.path(folder) / "walls.vtp").read_text()
        data = text.split("\n_", 1)[1]
        found = []
        for kind, offset in re.findall(r'type="(\w+)" Name="label\d" format="appended" offset="(\d+)"', text):
            at = int(offset)
            (blocks,) = struct.unpack("<Q", base64.b64decode(data[at:at + 12])[:8])
            table = 4 * -(-8 * (3 + blocks) // 3)
            lengths = struct.unpack(f"<{blocks}Q", base64.b64decode(data[at:at + table])[24:])
            packed = base64.b64decode(data[at + table:at + table + 4 * -(-sum(lengths) // 3)])
            raw = b""
            for length in lengths:
                raw, packed = raw + zlib.decompress(packed[:length]), packed[length:]
            letter = {"Int32": "i", "Int64": "q", "UInt64": "Q"}[kind]
            found.append((kind, set(struct.unpack(f"<{len(raw) // struct.calcsize(letter)}{letter}", raw))))
        return found

    def test_come_back_exactly(self):
        self.write_map("ids.nrrd", "uint64", {0: 0, 1: self.BIG, 2: 5, 7: self.LARGEST})
        self.path("ids.tsv").write_text(f"index\tname\n{self.BIG}\tbig\n5\tfive\n")
        done = self.labels("ids.nrrd", "-o", "out", "--write-map", "--names", "ids.tsv")
        self.assertIn(f"not {self.LARGEST}", done.stderr)  # has no name
        rows = self.table("out")
        self.assertEqual({label: row["name"] for label, row in rows.items()},
                         {5: "five", self.BIG: "big", self.LARGEST: f"region {self.LARGEST}"})
        self.assertEqual(rows[5]["neighbours"], f"0,{self.BIG},{self.LARGEST}")
        self.assertEqual({name for name in self.files("out") if name.startswith("regions/")},
                         {f"regions/{label}.vtp" for label in rows})
        regions = self.folder_report("out")["regions"]
        self.assertEqual([region["label"] for region in regions], [5, str(self.BIG), str(self.LARGEST)])
        self.assertEqual([each["label"] for each in regions[0]["neighbours"]],
                         [0, str(self.BIG), str(self.LARGEST)])
        self.assertEqual(self.walls("out"), [("UInt64", {5, self.BIG}),
                                             ("UInt64", {0, self.BIG, self.LARGEST})])
        # the surfaces are those of small labels in the same order
        self.write_map("small.nrrd", "uint64", {0: 0, 1: 2, 2: 1, 7: 3})
        self.labels("small.nrrd", "-o", "small", "-q")
        self.assertEqual([kind for kind, _ in self.walls("small")], ["Int32", "Int32"])
        for large, small in ((5, 1), (self.BIG, 2), (self.LARGEST, 3)):
            self.assertEqual((self.path("out/regions") / f"{large}.vtp").read_bytes(),
                             (self.path("small/regions") / f"{small}.vtp").read_bytes())
        # and so are those of the map that was written
        self.labels("out/map.nii.gz", "-o", "again", "-q", "--names", "ids.tsv")
        self.assertEqual((self.path("out/walls.vtp")).read_bytes(),
                         (self.path("again/walls.vtp")).read_bytes())
        self.labels("small.nrrd", "-o", "out", "-q", "--force")

    def test_negative_ones(self):
        self.write_map("ids.nrrd", "int64", {0: 0, 1: self.FAR, 2: 5, 7: self.BIG})
        self.labels("ids.nrrd", "-o", "out", "-q")
        self.assertEqual(list(self.table("out")), [self.FAR, 5, self.BIG])
        self.assertEqual(self.walls("out")[0][0], "Int64")
        self.assertEqual(self.walls("out")[0][1] | self.walls("out")[1][1], {0, self.FAR, 5, self.BIG})

    def test_are_chosen_and_merged_by_number(self):
        self.write_map("ids.nrrd", "uint64", {0: 0, 1: self.BIG, 2: 5, 7: self.LARGEST})
        self.labels("ids.nrrd", "-o", "one", "-q", "--labels", f"{self.BIG}-{self.LARGEST - 1}")
        self.assertEqual(set(self.table("one")), {self.BIG})
        new = self.BIG - 1  # a number that the map does not have
        self.labels("ids.nrrd", "-o", "two", "-q", "--merge", f"both={new},{self.LARGEST},5")
        self.assertEqual({label: row["name"] for label, row in self.table("two").items()},
                         {new: "both", self.BIG: f"region {self.BIG}"})
        self.refused(BAD_INPUT, f"--labels {self.BIG + 1}: ids.nrrd has no such label", "ids.nrrd",
                     "--labels", str(self.BIG + 1), "-o", "out")
        self.refused(USAGE, "--labels 18446744073709551616: must be labels", "ids.nrrd", "--labels",
                     "18446744073709551616", "-o", "out")
        self.refused(BAD_INPUT, "--layers: the map has labels beyond 2147483647", "ids.nrrd",
                     "--layers", "-o", "out")


class ChoiceTest(LabelsTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("boxes.nii"), three_boxes())
        self.path("boxes.tsv").write_text(
            "index\tname\tcolor\n1\tleft/one\t#ff0000\n2\tright\t#00ff00\n7\tinner\tn/a\n")

    def test_chosen_regions_are_those_of_the_whole_map(self):
        self.labels("boxes.nii", "-o", "whole", "-q", "--max-error", "0.3")
        done = self.labels("boxes.nii", "-o", "some", "--max-error", "0.3", "--labels", "1,5-9")
        self.assertEqual(done.stdout.count("holds:"), 4)
        self.assertEqual({name for name in self.files("some") if name.startswith("regions/")},
                         {"regions/1.vtp", "regions/7.vtp"})
        whole, some = self.table("whole"), self.table("some")
        self.assertEqual(set(some), {1, 7})
        for label, row in some.items():
            for key in ("name", "color", "voxels", "euler_characteristic", "components", "neighbours"):
                self.assertEqual(row[key], whole[label][key])
            # both lie within 0.3 mm of full walls that are alike: of boxes 6 voxels wide a tenth
            self.assertAlmostEqual(float(row["volume_mm3"]) / float(whole[label]["volume_mm3"]), 1,
                                   delta=0.1)
        walls = self.folder_report("some")["walls"]
        self.assertLess(walls["fullTriangles"], self.folder_report("whole")["walls"]["fullTriangles"])

    def test_merged_labels_are_one_region(self):
        self.labels("boxes.nii", "-o", "out", "-q", "--merge", "both=2,7")
        rows = self.table("out")
        self.assertEqual(set(rows), {1, 2})
        self.assertEqual(rows[2]["name"], "both")
        self.assertEqual(rows[2]["color"], "#00ff00")
        self.assertEqual(int(rows[2]["voxels"]), 6 * 10 * 8 + 3 * 4 * 4)
        self.assertEqual(rows[1]["neighbours"], "0,2")
        # a label that is merged stands for its region
        self.labels("boxes.nii", "-o", "chosen", "-q", "--merge", "both=2,7", "--labels", "7")
        self.assertEqual(set(self.table("chosen")), {2})
        self.labels("boxes.nii", "-o", "named", "-q", "--merge", "both=2,7", "--labels", "Both")
        self.assertEqual(set(self.table("named")), {2})

    def test_refuses_choices_that_make_no_sense(self):
        for pattern, *arguments in (
                (r"--labels 1,,2: must be labels", "--labels", "1,,2"),
                (r"--labels 1.5: must be labels", "--labels", "1.5"),
                (r"--labels 9-3: must be labels", "--labels", "9-3"),
                (r"--labels 0: holds 0", "--labels", "0"),
                (r"--merge both: must be a name and labels", "--merge", "both"),
                (r"--merge =1: must be a name", "--merge", "=1"),
                (r"a and b both take label 2", "--merge", "a=1,2", "--merge", "b=2-5"),
                (r"--merge a: given twice", "--merge", "a=1", "--merge", "a=2"),
                (r"--triangles and --reduction", "--triangles", "9", "--reduction", "0.5"),
                (r"--max-error -1: must be a number, 0 or more", "--max-error=-1"),
                (r"--format png: must be vtp", "--format", "png")):
            with self.subTest(pattern):
                self.refused(USAGE, pattern, "boxes.nii", "-o", "out", *arguments)
        self.refused(USAGE, "SEG is missing", "-o", "out")
        self.refused(BAD_INPUT, "--labels 5: boxes.nii has no such label", "boxes.nii", "-o", "out",
                     "--labels", "1,5")
        self.refused(BAD_INPUT, "--labels x: boxes.tsv names no label so", "boxes.nii", "-o", "out",
                     "--labels", "1,x")

    def test_a_merge_of_nothing_is_told(self):
        done = self.labels("boxes.nii", "-o", "out", "-q", "--merge", "x=50,51")
        self.assertIn("has none of the labels of --merge x", done.stderr)

    def test_a_label_of_a_merge_that_is_not_there_is_told(self):
        done = self.labels("boxes.nii", "-o", "out", "-q", "--merge", "x=1,2,50,60-70")
        self.assertIn("boxes.nii: has no label 50, 60-70 of --merge x", done.stderr)
        done = self.labels("boxes.nii", "-o", "all", "-q", "--merge", "x=1-50")
        self.assertEqual(done.stderr, "")

    def test_a_count_is_of_the_regions_that_are_chosen(self):
        walls = json.loads(self.labels("boxes.nii", "-o", "a", "--triangles", "120", "--labels", "1",
                                       "--json", "-").stdout)["walls"]
        self.assertEqual(walls["triangles"], walls["mapTriangles"])
        self.assertLessEqual(walls["triangles"], 120)
        done = self.labels("boxes.nii", "-o", "b", "--triangles", "9", "--labels", "1")
        self.assertRegex(done.stderr, r"has \d+ triangles in its walls, not 9")

    def test_counts(self):
        full = json.loads(self.labels("boxes.nii", "-o", "a", "--max-error", "0", "--json",
                                      "-").stdout)["walls"]
        self.assertEqual(full["triangles"], full["fullTriangles"])
        self.assertEqual(full["errorBoundMm"], 0)
        for name, wanted, *arguments in (("b", full["triangles"] // 2, "--reduction", "0.5"),
                                         ("c", 200, "--triangles", "200")):
            done = self.labels("boxes.nii", "-o", name, *arguments, "--json", "-")
            walls = json.loads(done.stdout)["walls"]
            self.assertEqual(walls["wantedTriangles"], wanted)
            if walls["triangles"] > wanted:  # then it says so
                self.assertRegex(done.stderr, f"triangles in its walls, not {wanted:,} as asked")


class RefusalTest(LabelsTest):
    def test_real_valued_images_are_refused_by_name_value_and_place(self):
        image = three_boxes("f")
        image.samples[3 + 16 * (4 + 14 * 5)] = 0.375
        write_nifti(self.path("real.nii"), image)
        self.refused(BAD_INPUT, r"real.nii: voxel \(3, 4, 5\) holds 0.375, which is no whole number",
                     "real.nii", "-o", "out")
        image.samples[0] = 3 + 2 ** -21  # a float of its own, which six digits write as 3
        write_nifti(self.path("near.nii"), image)
        self.refused(BAD_INPUT, r"near.nii: voxel \(0, 0, 0\) holds 3.0000005, which is no whole number",
                     "near.nii", "-o", "out")
        scaled = bytearray(self.path("real.nii").read_bytes())
        scaled[112:120] = struct.pack("<ff", 0.03125, 0)  # scl_slope, scl_inter
        self.path("scaled.nii").write_bytes(scaled)
        self.refused(BAD_INPUT, r"which is no whole number.*scl_slope 0.03125, scl_inter 0.*save a label map as integers",
                     "scaled.nii", "-o", "out")
        image.samples[0] = float("nan")
        write_nifti(self.path("nan.nii"), image)
        self.refused(BAD_INPUT, r"nan.nii: voxel \(0, 0, 0\) holds not a number", "nan.nii", "-o",
                     "out")
        image.samples[0] = 2.0 ** 40
        write_nifti(self.path("far.nii"), image)
        self.refused(BAD_INPUT, r"holds 1099511627776, beyond the labels", "far.nii", "-o", "out")

    def test_scans_are_refused(self):
        values = random.Random(1)
        scan = Image((20, 20, 20), "h", [values.randrange(300) for _ in range(8000)])
        write_nifti(self.path("t1.nii"), scan)
        self.refused(BAD_INPUT, "t1.nii: is an image, no label map: it has 299 values", "t1.nii",
                     "-o", "out")

    def test_any_map_takes_them_all_the_same(self):
        values = random.Random(1)
        write_nifti(self.path("many.nii"),
                    Image((5, 5, 5), "h", [values.randrange(60) for _ in range(125)]))
        self.refused(BAD_INPUT, "--any-map", "many.nii", "-o", "out")
        self.labels("many.nii", "-o", "out", "--any-map", "-q")

    def test_other_wrong_inputs(self):
        write_nifti(self.path("empty.nii"), label_map((4, 4, 4), lambda i, j, k: 0))
        self.refused(BAD_INPUT, "empty.nii: holds no label: all voxels are 0", "empty.nii", "-o",
                     "out")
        self.refused(BAD_INPUT, "gone.nii", "gone.nii", "-o", "out")
        write_4d_nifti(self.path("4d.nii"), [three_boxes(), three_boxes()])
        self.refused(BAD_INPUT, "4d.nii", "4d.nii", "-o", "out")
        self.labels("4d.nii", "-o", "out", "--volume-index", "1", "-q")


class NamesTest(LabelsTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("boxes.nii"), three_boxes())

    def names(self, *arguments):
        """Names and colours of 1, 2 and 7."""
        self.labels("boxes.nii", "-o", "out", "--force", "-q", *arguments)
        return [(row["name"], row["color"]) for row in self.table("out").values()]

    def test_without_a_table(self):
        names = self.names()
        self.assertEqual([name for name, _ in names], ["region 1", "region 2", "region 7"])
        colors = [[int(color[at:at + 2], 16) for at in (1, 3, 5)] for _, color in names]
        for n, one in enumerate(colors):  # 2 and 7 have hues 30 degrees apart by themselves
            for other in colors[:n]:
                self.assertGreater(math.dist(one, other), 100)
        self.assertIsNone(self.folder_report("out")["names"]["format"])

    def test_of_every_kind(self):
        wanted = [("left/one", "#ff8000"), ("right", "#0000ff"), ("inner", "#00ff00")]
        for name, text in (
                ("a.tsv", "index\tname\tcolor\n1\tleft/one\t#ff8000\n2\tright\t#0000ff\n"
                          "7\tinner\t#00ff00\n"),
                ("a.txt", "0 Unknown 0 0 0 0\n1 left/one 255 128 0 0\n2 right 0 0 255 0\n"
                          "7 inner 0 255 0 0\n"),
                ("a.label", '0 0 0 0 0 0 0 "Clear"\n1 255 128 0 1 1 1 "left/one"\n'
                            '2 0 0 255 1 1 1 "right"\n7 0 255 0 1 1 1 "inner"\n'),
                ("a.ctbl", "# Color table file x\n1 left/one 255 128 0 255\n2 right 0 0 255 255\n"
                           "7 inner 0 255 0 255\n"),
                ("a.csv", "LabelValue,Name,Color_R,Color_G,Color_B,Color_A\n1,left/one,255,128,0,1\n"
                          "2,right,0,0,255,1\n7,inner,0,255,0,1\n"),
                ("a.json", json.dumps({"1": {"name": "left/one", "color": [255, 128, 0]},
                                       "2": {"name": "right", "color": "#0000ff"},
                                       "7": {"name": "inner", "color": [0, 255, 0]}}))):
            with self.subTest(name):
                self.path(name).write_text(text)
                self.assertEqual(self.names("--names", name), wanted)
                self.assertEqual(self.folder_report("out")["names"]["files"], [name])

    def test_one_bad_colour_costs_no_name(self):
        self.path("boxes.tsv").write_text("index\tname\tcolor\n1\tA\tred\n2\tB\t#0f0\n7\tC\treddish\n")
        self.assertEqual(self.names()[:2], [("A", "#ff0000"), ("B", "#00ff00")])
        self.assertEqual(self.names()[2][0], "C")
        (warning,) = self.folder_report("out")["warnings"]
        self.assertEqual(warning["code"], "colors-not-read")
        self.assertIn("that of line 4 is 'reddish'", warning["text"])

    def test_unknown_columns_are_refused_and_beside_the_map_left(self):
        rows = "1 2001 A\n2 2002 B\n7 2003 C\n"
        self.path("other").write_text(rows)
        self.refused(BAD_INPUT, "other: its columns are those of no table that is read: numbers stand "
                     "between index and name", "boxes.nii", "-o", "no", "--names", "other")
        self.path("boxes.txt").write_text(rows)
        self.assertEqual([name for name, _ in self.names()], ["region 1", "region 2", "region 7"])
        self.assertEqual([w["code"] for w in self.folder_report("out")["warnings"]], ["names-not-used"])

    def test_names_are_no_formulas_in_the_table(self):
        names = ['=HYPERLINK("http://x/"&A1,"click")', "-left", "@SUM(1)"]
        self.path("boxes.tsv").write_text("index\tname\n" + "".join(
            f"{label}\t{name}\n" for label, name in zip((1, 2, 7), names)))
        self.labels("boxes.nii", "-o", "out", "-q")
        written = (self.path("out") / "regions.tsv").read_text()
        for name in names:
            self.assertIn(f"\t'{name}\t", written)
        self.path("boxes.tsv").unlink()
        self.labels("boxes.nii", "-o", "again", "-q", "--names", "out/regions.tsv")
        self.assertEqual((self.path("again") / "regions.tsv").read_text(), written)
        self.assertEqual([region["name"] for region in self.folder_report("again")["regions"]], names)

    def test_files_are_named_by_number(self):
        self.path("boxes.txt").write_text("1 ../../evil/name\n2 a/b\n7 <&\"'>\n")
        self.assertEqual([name for name, _ in self.names()], ["../../evil/name", "a/b", "<&\"'>"])
        self.assertEqual({name for name in self.files("out") if name.startswith("regions/")},
                         {"regions/1.vtp", "regions/2.vtp", "regions/7.vtp"})
        self.assertIn(b"&lt;&amp;&quot;", self.files("out")["all.vtm"])

    def test_found_beside_the_image_as_mricron_has_them(self):
        self.path("boxes.nii.txt").write_text("1 left 2001\r\n2 right 2002\r\n7 inner 2003\r\n")
        colors = bytearray(768)
        colors[1], colors[256 + 2], colors[512 + 7] = 255, 255, 255
        self.path("boxes.nii.lut").write_bytes(colors)
        self.assertEqual(self.names(), [("left", "#ff0000"), ("right", "#00ff00"),
                                        ("inner", "#0000ff")])

    def test_names_may_be_patterns(self):
        self.path("boxes.tsv").write_text(
            "index\tname\n1\tLung_upper\n2\tlung_lower\n7\tlung*\n")
        self.labels("boxes.nii", "-o", "ribs", "-q", "--labels", "lung_*")
        self.assertEqual(set(self.table("ribs")), {1, 2})
        self.labels("boxes.nii", "-o", "one", "-q", "--merge", "lung=LUNG_?????")
        self.assertEqual({label: row["name"] for label, row in self.table("one").items()},
                         {1: "lung", 7: "lung*"})
        self.labels("boxes.nii", "-o", "exact", "-q", "--labels", "lung*")  # a name comes first
        self.assertEqual(set(self.table("exact")), {7})
        self.refused(BAD_INPUT, r"--labels kidney\*: boxes.tsv names no label so", "boxes.nii", "-o",
                     "out", "--labels", "kidney*")

    def test_labels_and_merges_take_names(self):
        self.refused(BAD_INPUT, "--labels x: boxes.nii has no table of names; give one", "boxes.nii",
                     "-o", "out", "--labels", "1,x")
        self.path("boxes.txt").write_text("1 Hippocampus_L\n2 Hippocampus_R\n7 Caudate\n")
        self.labels("boxes.nii", "-o", "out", "-q", "--labels", "Caudate,1")
        self.assertEqual(set(self.table("out")), {1, 7})
        self.labels("boxes.nii", "-o", "lower", "-q", "--labels", "hippocampus_r")
        self.assertEqual(set(self.table("lower")), {2})
        self.labels("boxes.nii", "-o", "both", "-q", "--merge", "Hippocampus=Hippocampus_L,2")
        self.assertEqual({label: row["name"] for label, row in self.table("both").items()},
                         {1: "Hippocampus", 7: "Caudate"})
        for pattern, *arguments in (
                (r"--labels Hippocampus: boxes.txt names no label so; did you mean Hippocampus_L or "
                 r"Hippocampus_R\?", "--labels", "Hippocampus"),
                (r"--labels Caudatte: .*did you mean Caudate\?", "--labels", "Caudatte"),
                (r"--labels Spleen: boxes.txt names no label so; regions.tsv", "--labels", "Spleen"),
                (r"--merge a Spleen: ", "--merge", "a=1,Spleen")):
            with self.subTest(pattern):
                self.refused(BAD_INPUT, pattern, "boxes.nii", "-o", "no", *arguments)
        self.refused(USAGE, "a and b both take label 7", "boxes.nii", "-o", "no", "--merge",
                     "a=Caudate", "--merge", "b=7")

    def test_files_go_by_names_where_wanted(self):
        def files(folder):
            return sorted(path.name for path in (self.path(folder) / "regions").iterdir())
        self.path("boxes.txt").write_text("1 Left/Lobe\n2 left_lobe\n7 Caudate\n")
        self.labels("boxes.nii", "-o", "out", "-q", "--file-names", "name")
        self.assertEqual(files("out"), ["Caudate.vtp", "Left_Lobe-1.vtp", "left_lobe-2.vtp"])
        self.assertEqual({row["label"]: row["file"] for row in self.folder_report("out")["regions"]},
                         {1: "regions/Left_Lobe-1.vtp", 2: "regions/left_lobe-2.vtp",
                          7: "regions/Caudate.vtp"})
        self.labels("boxes.nii", "-o", "numbers", "-q")
        self.assertEqual(files("numbers"), ["1.vtp", "2.vtp", "7.vtp"])
        for name, other in (("Caudate.vtp", "7.vtp"), ("Left_Lobe-1.vtp", "1.vtp")):
            self.assertEqual((self.path("out") / "regions" / name).read_bytes(),
                             (self.path("numbers") / "regions" / other).read_bytes())
        # a folder with such names is this program's own; one with another file in it is not
        self.labels("boxes.nii", "-o", "out", "-q", "--force")
        self.assertEqual(files("out"), ["1.vtp", "2.vtp", "7.vtp"])
        (self.path("out") / "regions" / "mine.vtp").write_text("x")
        self.assertEqual(self.run_labels("boxes.nii", "-o", "out", "-q", "--force").returncode,
                         BAD_INPUT)

    def test_names_inside_a_file_are_read(self):
        boxes = three_boxes("B")
        header = ("NRRD0004\ntype: uchar\ndimension: {}\nspace: left-posterior-superior\n"
                  "sizes: {}16 14 12\nspace directions: {}(1,0,0) (0,1,0) (0,0,1)\nkinds: {}domain "
                  "domain domain\nencoding: raw\nspace origin: (0,0,0)\n")
        segments = ("Segment0_Name:=liver\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
                    "Segment0_Color:=1 0 0\nSegment1_Name:=tumour\nSegment1_LabelValue:=7\n"
                    "Segment1_Layer:={}\nSegment1_Color:=0 1 0\n\n")
        data = bytes(boxes.samples)
        self.path("one.seg.nrrd").write_bytes(
            (header.format(3, "", "", "") + segments.format(0)).encode() + data)
        done = self.labels("one.seg.nrrd", "-o", "out", "--labels", "liver,tumour")
        self.assertIn("names and colours of one.seg.nrrd (3D Slicer segmentation)", done.stdout)
        self.assertEqual({label: (row["name"], row["color"])
                          for label, row in self.table("out").items()},
                         {1: ("liver", "#ff0000"), 7: ("tumour", "#00ff00")})
        layers = bytes(value for sample in data for value in (int(sample == 1), 7 * (sample == 7)))
        self.path("two.seg.nrrd").write_bytes(
            (header.format(4, "2 ", "none ", "list ") + segments.format(1)).encode() + layers)
        self.refused(BAD_INPUT, r"2 layers of segments that overlap \(0: liver; 1: tumour\)",
                     "two.seg.nrrd", "-o", "b")
        self.labels("two.seg.nrrd", "-o", "b", "-q", "--volume-index", "1")
        self.assertEqual(self.table("b")[7]["name"], "tumour")

    def test_regions_tsv_names_the_same_regions_again(self):
        self.path("boxes.txt").write_text("1 c\u00f4t\u00e9\n2 right\n7 inner\n")
        first = self.names()
        self.path("again.tsv").write_bytes(self.files("out")["regions.tsv"])
        self.assertEqual(self.names("--names", "again.tsv"), first)

    def test_what_has_no_name_is_told(self):
        self.path("boxes.txt").write_text("1 left\n2 right\n")
        done = self.labels("boxes.nii", "-o", "out", "-q")
        self.assertRegex(done.stderr, r"boxes.txt: names all but 1 of the 3 regions, not 7")
        done = self.run_labels("boxes.nii", "-o", "strict", "-q", "--strict")
        self.assertEqual(done.returncode, CHECK_FAILED)
        self.assertFalse(self.path("strict").exists())

    def test_damaged_tables_are_refused_by_line(self):
        self.path("bad.tsv").write_text("index\tname\n1\ta\nx\tb\n")
        self.refused(BAD_INPUT, r"bad.tsv: line 3: the index is 'x'", "boxes.nii", "-o", "out",
                     "--names", "bad.tsv")
        self.path("bad.md").write_text("# Title\nno table\n")
        self.refused(BAD_INPUT, r"bad.md: is no table of labels", "boxes.nii", "-o", "out",
                     "--names", "bad.md")
        # one that was not asked for costs a warning
        self.path("boxes.tsv").write_text("index\tname\n1\ta\nx\tb\n")
        done = self.labels("boxes.nii", "-o", "out", "-q")
        self.assertRegex(done.stderr, r"names are not used: .*boxes.tsv: line 3")


class BatchTest(LabelsTest):
    def test_many_inputs(self):
        for name in ("a", "b"):
            write_nifti(self.path(name + ".nii"), three_boxes())
        write_nifti(self.path("c.nii"), three_boxes("f"))
        data = bytearray(self.path("c.nii").read_bytes())
        data[-4:] = b"\0\0\0\x3f"  # 0.5
        self.path("c.nii").write_bytes(data)
        done = self.run_labels("a.nii", "b.nii", "c.nii", "--output-dir", "made", "--jobs", "2")
        self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
        self.assertIn("3 regions", done.stdout)
        self.assertRegex(done.stdout + done.stderr, "c.nii: voxel")
        made = {path.name for path in self.path("made").iterdir() if path.is_dir()}
        self.assertEqual(made, {"a-labels", "b-labels"})
        again = self.run_labels("a.nii", "b.nii", "--output-dir", "made", "--skip-existing")
        self.assertEqual(again.returncode, OK, again.stderr)
        self.assertTrue(self.path("made/summary.html").is_file())


class LayersTest(LabelsTest):
    """The walls as OpenMEEG takes them."""

    def setUp(self):
        super().setUp()
        write_nifti(self.path("boxes.nii"), three_boxes(spacing=(1, 1.5, 2), origin=(-5, 3, 20)))

    def read_tri(self, path):
        words = path.read_text().split()
        self.assertEqual(words[0], "-")
        count = int(words[1])
        numbers = words[2:2 + 6 * count]
        points = [tuple(map(float, numbers[6 * n:6 * n + 3])) for n in range(count)]
        rest = words[2 + 6 * count:]
        self.assertEqual(rest[0], "-")
        self.assertEqual(len(rest), 4 + 3 * int(rest[1]))
        corners = list(map(int, rest[4:]))
        return [tuple(points[v] for v in corners[3 * t:3 * t + 3]) for t in range(int(rest[1]))]

    def read_geometry(self, folder):
        """Sections of the .geom: name -> what stands behind the colon."""
        lines = (folder / "layers.geom").read_text().split("\n")
        self.assertEqual(lines[0], "# Domain Description 1.1")
        sections, kind = {}, None
        for line in filter(None, lines[1:]):
            words = line.split()
            if len(words) == 2 and words[1].isdigit():
                kind = words[0][:-1] if words[0] != "Meshes" else "Mesh"
                sections[kind] = {}
                left = int(words[1])
                continue
            left -= 1
            self.assertGreaterEqual(left, 0)
            self.assertEqual(words[0], kind)
            sections[kind][words[1].rstrip(":")] = words[2:]
        return sections

    def surface(self, folder, sections, interface):
        """The triangles of a signed sum of meshes."""
        triangles = []
        for term in sections["Interface"][interface]:
            sign, mesh = term[0], term[1:]
            own = self.read_tri(folder / sections["Mesh"][mesh][0].strip('"'))
            triangles += own if sign == "+" else [t[::-1] for t in own]
        return triangles

    def assert_closed(self, triangles):
        edges = [(t[c], t[(c + 1) % 3]) for t in triangles for c in range(3)]
        self.assertEqual(len(edges), len(set(edges)))
        self.assertEqual(set(edges), {(b, a) for a, b in edges})

    def volume(self, triangles):
        return sum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]) for a, b, c in triangles) / 6

    def test_interfaces_are_closed_and_hold_their_regions(self):
        self.labels("boxes.nii", "-o", "out", "--layers", "--conductivities", "7=1.79,1=0.33,2=0.0066")
        folder = self.path("out") / "layers"
        sections = self.read_geometry(folder)
        self.assertEqual(set(sections["Mesh"]),
                         {"wall_1_0", "wall_2_0", "wall_1_2", "wall_1_7", "wall_2_7"})
        rows = self.table("out")
        whole = 0
        for label in (1, 2, 7):
            self.assertEqual(sections["Domain"][f"Region{label}"], [f"-Region{label}"])
            surface = self.surface(folder, sections, f"Region{label}")
            self.assert_closed(surface)
            volume = float(rows[label]["volume_mm3"])
            # coordinates have nine digits or more
            self.assertAlmostEqual(self.volume(surface), volume, delta=1e-6 * volume)
            whole += volume
        self.assertEqual(sections["Domain"]["Air"], ["+Outside"])
        outside = self.surface(folder, sections, "Outside")
        self.assert_closed(outside)
        self.assertAlmostEqual(self.volume(outside), whole, delta=1e-6 * whole)
        # each wall lies between two domains, inside of one interface each way
        for mesh in sections["Mesh"]:
            signs = [term[0] for name, terms in sections["Interface"].items() for term in terms
                     if term[1:] == mesh]
            self.assertEqual(len(signs), 2, mesh)
        self.assertEqual((folder / "layers.cond").read_text().split("\n")[2:],
                         ["Region1 0.33", "Region2 0.0066", "Region7 1.79", "Air 0", ""])

    def test_folder_with_layers_can_be_replaced(self):
        self.labels("boxes.nii", "-o", "out", "--layers")
        self.assertFalse((self.path("out") / "layers" / "layers.cond").exists())
        self.labels("boxes.nii", "-o", "out", "--force")
        self.assertFalse((self.path("out") / "layers").exists())

    def test_refuses_what_makes_no_model(self):
        refused = lambda *arguments, code=USAGE, says: self.refused(
            code, says, "boxes.nii", "-o", "out", *arguments)
        refused("--layers", "--labels", "1", says="--layers: needs all regions")
        refused("--conductivities", "1=0.3", says="written with --layers")
        refused("--layers", "--coordinates", "voxel", says="voxel")
        for bad in ("1=0", "1=-2", "1=nan", "1=inf", "1", "0=1", "x=1", "1=1,1=2", "1=1,", ""):
            refused("--layers", "--conductivities", bad, says="--conductivities")
        refused("--layers", "--conductivities", "1=1,2=1", code=BAD_INPUT,
                says="boxes.nii: 7 has no conductivity")
        refused("--layers", "--conductivities", "1=1,2=1,7=1,8=1", code=BAD_INPUT,
                says="no region 8")


if __name__ == "__main__":
    main()
