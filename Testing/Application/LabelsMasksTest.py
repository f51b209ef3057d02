"""adaptiso-labels on masks: a folder of them, several files, what overlaps, what is refused."""

import gzip
import json
import os

from DicomTest import segmentation
from labelsSupport import LabelsTest, label_map
from support import BAD_INPUT, USAGE, main, write_metaimage, write_nifti, write_nrrd

SIZE = (14, 10, 8)
# [first, last) along each axis: a and b share 2 x 6 x 4 voxels, c lies in both of them and outside
BOXES = {"a": ((2, 8), (2, 8), (2, 6)), "b": ((6, 12), (2, 8), (2, 6)), "c": ((6, 8), (2, 4), (5, 7))}


def holds(box, *index):
    return all(first <= x < last for x, (first, last) in zip(index, box))


def mask(box, value=1, kind="B", size=SIZE, origin=(0, 0, 0)):
    return label_map(size, lambda i, j, k: value if holds(box, i, j, k) else 0, kind, origin=origin)


def joint(order, numbers):
    """The map where the first of `order` keeps a voxel."""
    return label_map(SIZE, lambda i, j, k: next(
        (numbers[name] for name in order if holds(BOXES[name], i, j, k)), 0), "B")


class MasksTest(LabelsTest):
    def setUp(self):
        super().setUp()
        self.masks = self.path("masks")
        self.masks.mkdir()
        for name, box in BOXES.items():
            write_nifti(self.masks / f"{name}.nii", mask(box))

    def surfaces(self, folder):
        return {name: data for name, data in self.files(folder).items()
                if name.endswith((".vtp", ".surf.gii"))}

    def regions(self, folder):
        return {region["name"]: region for region in self.folder_report(folder)["regions"]}

    def voxels(self, folder):
        return {name: region["voxels"] for name, region in self.regions(folder).items()}


class JoinTest(MasksTest):
    def test_a_folder_gives_the_surfaces_of_the_joint_map(self):
        done = self.labels("masks", "-o", "out", "--write-map", "--strict")
        self.assertIn("3 regions", done.stdout)
        self.assertIn("joined of 3 masks, 0 of them empty; 48 voxels lie in more than one",
                      done.stdout)
        write_nifti(self.path("joint.nii"), joint("cba", {"a": 1, "b": 2, "c": 3}))
        self.labels("joint.nii", "-o", "joint", "-q")
        self.assertEqual(self.surfaces("out"), self.surfaces("joint"))
        # the map that is written is that one, to the byte
        self.assertEqual(gzip.decompress((self.path("out") / "map.nii.gz").read_bytes())[352:],
                         joint("cba", {"a": 1, "b": 2, "c": 3}).packed())
        self.labels("out/map.nii.gz", "-o", "again", "-q")
        self.assertEqual(self.surfaces("out"), self.surfaces("again"))

    def test_overlaps_are_counted_by_pair(self):
        done = self.labels("masks", "-o", "out")
        # a and b share 48, c lies in 4 of these and in 0 others: of 8 voxels 4 lie above the boxes
        self.assertEqual(self.folder_report("out")["input"]["masks"], {
            "priority": "name",
            "files": [{"file": "a.nii", "label": 1, "voxels": 144, "keptVoxels": 96},
                      {"file": "b.nii", "label": 2, "voxels": 144, "keptVoxels": 140},
                      {"file": "c.nii", "label": 3, "voxels": 8, "keptVoxels": 8}],
            "sharedVoxels": 48,
            "overlaps": [{"winner": 2, "loser": 1, "voxels": 44},
                         {"winner": 3, "loser": 1, "voxels": 4},
                         {"winner": 3, "loser": 2, "voxels": 4}]})
        self.assertEqual(self.voxels("out"), {"a": 96, "b": 140, "c": 8})
        self.assertIn("note: masks: 48 voxels lie in more than one mask; the last by name keeps "
                      "them: b 44 of a, c 4 of a, c 4 of b", done.stderr)

    def test_priority(self):
        self.path("order.txt").write_text("# these first\n\nb\na\n")
        for priority, voxels, order in (
                ("largest", {"a": 96, "b": 144, "c": 4}, "bac"),  # of equal ones the last by name
                ("smallest", {"a": 96, "b": 140, "c": 8}, "cba"),
                ("order.txt", {"a": 96, "b": 144, "c": 4}, "bac")):
            with self.subTest(priority):
                self.labels("masks", "--priority", priority, "-o", priority + "-out", "-q",
                            "--write-map")
                self.assertEqual(self.voxels(priority + "-out"), voxels)
                packed = (self.path(priority + "-out") / "map.nii.gz").read_bytes()
                self.assertEqual(gzip.decompress(packed)[352:],
                                 joint(order, {"a": 1, "b": 2, "c": 3}).packed())

    def test_priority_of_the_first_by_a_list(self):
        self.path("order.txt").write_text("a\n")
        self.labels("masks", "--priority", "order.txt", "-o", "out", "-q")
        self.assertEqual(self.voxels("out"), {"a": 144, "b": 96, "c": 4})

    def test_files_that_are_joined(self):
        self.path("c").mkdir()
        os.rename(self.masks / "c.nii", self.path("c") / "c.nii")
        self.labels("c/c.nii", "masks/b.nii", "masks/a.nii", "--join", "-o", "files", "-q")
        os.rename(self.path("c") / "c.nii", self.masks / "c.nii")
        self.labels("masks", "-o", "folder", "-q")
        self.assertEqual(self.surfaces("files"), self.surfaces("folder"))

    def test_one_mask_of_a_folder(self):
        for name in "bc":
            (self.masks / f"{name}.nii").unlink()
        self.labels("masks", "-o", "out", "-q")
        self.assertEqual(self.voxels("out"), {"a": 144})

    def test_any_format_and_value(self):
        (self.masks / "b.nii").unlink()
        (self.masks / "c.nii").unlink()
        write_nrrd(self.masks / "b.seg.nrrd", mask(BOXES["b"], 255, "h"))
        write_metaimage(self.masks / "c.mha", mask(BOXES["c"], -1.5, "f"))
        (self.masks / "a.nii").unlink()  # RAS, others LPS
        write_nrrd(self.masks / "a.nrrd", mask(BOXES["a"]))
        self.labels("masks", "-o", "out", "-q")
        self.assertEqual(self.voxels("out"), {"a": 96, "b.seg": 140, "c": 8})

    def test_what_else_lies_in_the_folder(self):
        (self.masks / "statistics.json").write_text("{}")
        (self.masks / "._a.nii").write_bytes(b"\0\5\x16\7")  # of macOS
        (self.masks / "more").mkdir()
        write_nifti(self.masks / "more" / "d.nii", mask(BOXES["a"]))
        self.labels("masks", "-o", "out", "-q")
        self.assertEqual(set(self.regions("out")), {"a", "b", "c"})

    def test_empty_and_covered_masks_are_told(self):
        write_nifti(self.masks / "0.nii", mask(((0, 0),) * 3))
        self.labels("masks", "-o", "out", "-q", "--strict")  # a note: organs may be missing
        self.assertEqual({name: region["label"] for name, region in self.regions("out").items()},
                         {"a": 2, "b": 3, "c": 4})
        self.assertEqual([w["code"] for w in self.folder_report("out")["warnings"]],
                         ["mask-empty", "masks-overlap"])
        write_nifti(self.masks / "d.nii", mask(((0, 14), (0, 10), (0, 7))))
        done = self.labels("masks", "-o", "covered")
        self.assertEqual(self.voxels("covered"), {"d": 980})
        self.assertRegex(done.stderr, "warning: masks: 3 masks lie wholly within others that keep "
                                      "the voxels, so they have no region: a, b, c; --priority")

    def test_names_of_files(self):
        os.rename(self.masks / "a.nii", self.masks / "a b\tc\n\x1b[1m../=1.nii".replace("/", "_"))
        self.labels("masks", "-o", "out", "-q", "--file-names", "name")
        self.assertEqual(set(self.regions("out")), {"a b c  [1m.._=1", "b", "c"})
        self.assertEqual(len(self.path("out/regions.tsv").read_text().splitlines()), 4)
        self.assertIn("regions/a_b_c___1m..__1.vtp", set(self.files("out")))

    def test_a_table_numbers_the_masks(self):
        self.path("names.tsv").write_text("index\tname\tcolor\n70\tB\t#102030\n5\tc\t#ff0000\n")
        done = self.labels("masks", "--names", "names.tsv", "--labels", "b,5,a", "-o", "out")
        self.assertEqual({name: (region["label"], region["color"])
                          for name, region in self.regions("out").items() if name != "a"},
                         {"b": (70, "#102030"), "c": (5, "#ff0000")})
        self.assertEqual(self.regions("out")["a"]["label"], 71)
        self.assertIn("names.tsv: has no row for 1 mask: a; numbered behind its rows", done.stderr)

    def test_folders_of_a_batch(self):
        self.path("other").mkdir()
        write_nifti(self.path("other/b.nii"), mask(BOXES["b"]))
        self.labels("masks", "other", "--output-dir", "made", "--priority", "largest")
        self.assertEqual(self.voxels("made/masks-labels"), {"a": 96, "b": 144, "c": 4})
        self.assertEqual(self.voxels("made/other-labels"), {"b": 144})
        report = json.loads(self.labels("masks", "other", "--output-dir", "made", "--priority",
                                        "largest", "--skip-existing", "--json", "-").stdout
                            .splitlines()[0])
        self.assertEqual(report["error"], None)


class SegmentsTest(LabelsTest):
    def voxels(self, folder):
        return {region["name"]: (region["label"], region["voxels"])
                for region in self.folder_report(folder)["regions"]}

    def test_of_dicom(self):
        # frames at 2 mm: 4 of the liver, 3 of the kidney; they share 4 x 5 pixels of two
        boxes = {1: (2, 4, 6, 8), 2: (6, 8, 10)}
        inside = lambda segment, i, j, z: 2 <= j < 7 and (2 <= i < 8 if segment == 1 else 4 <= i < 10)
        self.path("seg.dcm").write_bytes(segmentation(boxes, 13, 11, inside))
        done = self.labels("seg.dcm", "--segments", "all", "-o", "out")
        self.assertIn("40 voxels lie in more than one mask; the last by name keeps them: Liver 40 of "
                      "Left kidney", done.stderr)
        self.assertEqual(self.voxels("out"), {"Liver": (1, 120), "Left kidney": (2, 90 - 40)})
        self.labels("seg.dcm", "--segments", "all", "--labels", "left kidney", "--priority",
                    "smallest", "-o", "one", "-q")
        self.assertEqual(self.voxels("one"), {"Left kidney": (2, 90)})
        self.refused(USAGE, "--segments all: segments bring their names and numbers; leave --names out",
                     "seg.dcm", "--segments", "all", "--names", "names.tsv")
        self.refused(USAGE, "--segments all: takes all of one input", "seg.dcm", "--segments", "all",
                     "--series", "1", "-o", "x")

    def test_of_layers(self):
        # layer 0 has liver (1) and spleen (2), layer 1 a tumour (1) that lies in both
        labels = ("Segment0_Name:=liver\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Color:=1 0 0\n"
                  "Segment1_Name:=spleen\nSegment1_LabelValue:=2\nSegment1_Layer:=0\nSegment1_Color:=0 1 0\n"
                  "Segment2_Name:=tumour\nSegment2_LabelValue:=1\nSegment2_Layer:=1\nSegment2_Color:=0 0 1\n")
        header = ("NRRD0004\ntype: uchar\ndimension: 4\nspace: left-posterior-superior\n"
                  f"sizes: 2 {SIZE[0]} {SIZE[1]} {SIZE[2]}\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
                  "kinds: list domain domain domain\nencoding: raw\nspace origin: (0,0,0)\n")
        samples = bytes(value for k in range(SIZE[2]) for j in range(SIZE[1]) for i in range(SIZE[0])
                        for value in ((2 if i >= 6 else 1) if holds(((2, 10), (2, 8), (2, 6)), i, j, k)
                                      else 0, int(holds(((4, 8), (4, 6), (3, 5)), i, j, k))))
        self.path("two.seg.nrrd").write_bytes((header + labels + "\n").encode() + samples)
        self.labels("two.seg.nrrd", "--segments", "all", "-o", "out", "-q")
        self.assertEqual(self.voxels("out"), {"liver": (1, 96 - 8), "spleen": (2, 96 - 8),
                                              "tumour": (3, 16)})
        self.assertEqual([region["color"] for region in self.folder_report("out")["regions"]],
                         ["#ff0000", "#00ff00", "#0000ff"])


class RefusalTest(MasksTest):
    def test_images_that_are_no_masks(self):
        write_nifti(self.masks / "b.nii", label_map(SIZE, lambda i, j, k: i % 3, "B"))
        self.refused(BAD_INPUT, r"masks/b\.nii: holds 1 and 2 besides 0, so it is no mask",
                     "masks", "-o", "out")
        write_nifti(self.masks / "b.nii", label_map(SIZE, lambda i, j, k: i / 16, "f"))
        self.refused(BAD_INPUT, r"masks/b\.nii: holds 0\.0625 and 0\.125 besides 0", "masks", "-o",
                     "out")

    def test_other_grids(self):
        write_nifti(self.masks / "c.nii", mask(BOXES["c"], size=(14, 10, 9)))
        self.refused(BAD_INPUT, r"b\.nii: has 14 x 10 x 8 voxels, c\.nii 14 x 10 x 9; all masks need "
                                r"one grid", "masks", "-o", "out")
        write_nifti(self.masks / "c.nii", mask(BOXES["c"], origin=(0, 0, 0.25)))
        self.refused(BAD_INPUT, r"b\.nii: lies elsewhere than c\.nii, by up to 0\.25 mm", "masks",
                     "-o", "out")
        # the digits of headers do not count
        write_nifti(self.masks / "c.nii", mask(BOXES["c"], origin=(0, 0, 0.0001)))
        self.labels("masks", "-o", "out", "-q")

    def test_two_masks_of_one_name(self):
        (self.masks / "a.nii.gz").write_bytes(gzip.compress((self.masks / "a.nii").read_bytes()))
        self.refused(BAD_INPUT, r"masks/a\.nii and a\.nii\.gz: are two masks of one name, a;",
                     "masks", "-o", "out")

    def test_files_that_cannot_be_read(self):
        (self.masks / "d.nii.gz").write_bytes(b"")
        self.refused(BAD_INPUT, r"masks/d\.nii\.gz: ", "masks", "-o", "out")
        (self.masks / "d.nii.gz").unlink()
        os.mkfifo(self.masks / "d.nii")
        self.refused(BAD_INPUT, r"masks/d\.nii: .*not a regular file", "masks", "-o", "out")

    def test_links_out_of_the_folder(self):
        write_nifti(self.path("secret.nii"), mask(BOXES["a"]))
        (self.masks / "d.nii").symlink_to("../secret.nii")
        self.refused(BAD_INPUT, r"masks/d\.nii", "masks", "-o", "out")
        (self.masks / "d.nii").unlink()
        (self.masks / "d.nii").symlink_to("nowhere.nii")
        self.refused(BAD_INPUT, r"masks/d\.nii", "masks", "-o", "out")
        (self.masks / "d.nii").unlink()
        (self.masks / "d.nii").symlink_to("a.nii")  # within: a mask as any other
        self.labels("masks", "-o", "out", "-q")
        self.assertEqual(self.voxels("out"), {"b": 96, "c": 4, "d": 144})

    def test_a_folder_with_dicom_in_it_is_a_series(self):
        (self.masks / "slices").mkdir()
        (self.masks / "slices" / "1").write_bytes(bytes(128) + b"DICM" + bytes(64))
        self.refused(BAD_INPUT, r"masks: file \d \(by name\).*DICOM", "masks", "-o", "out")

    def test_priorities_that_are_none(self):
        self.refused(BAD_INPUT, r"--priority large: there is no such file", "masks", "--priority",
                     "large", "-o", "out")
        self.path("order.txt").write_text("a\naa\n")
        self.refused(BAD_INPUT, r"--priority order\.txt: line 2: aa is no mask; did you mean a\?",
                     "masks", "--priority", "order.txt", "-o", "out")
        self.path("order.txt").write_text("a\na\n")
        self.refused(BAD_INPUT, r"--priority order\.txt: line 2: a stands there twice", "masks",
                     "--priority", "order.txt", "-o", "out")
        self.refused(USAGE, r"--priority: is for masks", "masks/a.nii", "--priority", "largest",
                     "-o", "out")

    def test_joins_that_make_no_sense(self):
        self.refused(USAGE, r"--join: needs -o DIR", "--join", "masks/a.nii", "masks/b.nii")
        self.refused(USAGE, r"--join: makes one map", "--join", "masks/a.nii", "--output-dir", "x",
                     "-o", "out")

    def test_an_output_that_is_a_mask(self):
        self.refused(BAD_INPUT, r"masks/a\.nii", "masks", "-o", "out", "--json", "masks/a.nii")
        self.refused(BAD_INPUT, r"masks", "masks", "-o", "masks", "--force")


main()
