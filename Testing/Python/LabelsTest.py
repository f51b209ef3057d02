"""labels(): the walls of a label map. Truth on paper, the bytes of adaptiso-labels, what is refused."""

import json
import pickle
import struct
import unittest

import adaptiso
import numpy as np
from support import InFolder, needs, program

SHEARED = np.array([[-1, 0.2, 0, 20], [0, 1.5, 0.3, -30], [0.1, 0, 2, 12], [0, 0, 0, 1]],
                   np.float32).astype(float)  # as NIfTI's sform holds it


def boxes():
    """Two boxes side by side, a third one on top of both, within 0."""
    volume = np.zeros((16, 12, 14), np.int16, order="F")
    volume[3:8, 3:9, 3:7], volume[8:13, 3:9, 3:7], volume[3:13, 3:9, 7:11] = 1, 2, 7
    return volume


class Truth(unittest.TestCase):
    def setUp(self):
        self.volume = boxes()
        self.walls = adaptiso.labels(self.volume, max_error=0, affine=SHEARED)

    def test_voxels_that_are_needles_are_refused(self):
        """There is no memory for what they ask for; found by arguments made up."""
        for thin in (1e-5, 5.96e-8, 1e-29):
            with self.assertRaisesRegex(adaptiso.Error, "mm thin, must be at most"):
                adaptiso.labels(self.volume, affine=np.diag([1, thin, 1, 1]))

    def test_far_from_the_origin_there_are_walls_or_an_error(self):
        """There rounding bends what is cut; it was a crash."""
        noise = np.random.default_rng(3).normal(size=(16, 16, 16))
        volume = np.asarray(np.clip(noise, 0, 3), np.uint8)
        for far in (1e5, 1e7):
            affine = np.eye(4)
            affine[1, 3] = far
            walls = adaptiso.labels(volume, affine=affine)
            self.assertTrue(np.isfinite(walls.error_bound))

    def test_regions_have_the_volumes_of_their_voxels(self):
        voxel = abs(np.linalg.det(SHEARED[:3, :3]))
        self.assertEqual(list(self.walls.regions), [1, 2, 7])
        for label, region in self.walls.regions.items():
            truth = (self.volume == label).sum() * voxel
            # walls are smooth at the boxes' edges: the program's test allows as much
            self.assertAlmostEqual(region.volume, truth, delta=0.1 * truth)
            self.assertEqual((region.label, region.euler_characteristic, region.components),
                             (label, 2, 1))
            self.assertEqual(region.name, f"region {label}")
            self.assertAlmostEqual(sum(region.neighbours.values()), region.area, places=6)
        self.assertEqual(set(self.walls.regions[1].neighbours), {0, 2, 7})
        self.assertAlmostEqual(self.walls.regions[1].neighbours[2],
                               self.walls.regions[2].neighbours[1], places=9)
        self.assertEqual(self.walls.error_bound, 0)

    def test_walls_are_shared_to_the_bit(self):
        walls = self.walls
        self.assertEqual((walls.vertices.dtype, walls.faces.dtype, walls.label0.dtype),
                         (np.float64, np.int64, np.int32))
        self.assertEqual(len(walls.label0), len(walls.faces))
        for array in (walls.vertices, walls.faces, walls.label0, walls.label1):
            self.assertFalse(array.flags.writeable)
        self.assertTrue(((walls.label0 < walls.label1) | (walls.label1 == 0)).all())
        for label in walls.regions:
            mesh = walls.region(label)
            own = (walls.label0 == label) | (walls.label1 == label)
            self.assertEqual(len(mesh.faces), own.sum())
            np.testing.assert_array_equal(mesh.vertices,
                                          walls.vertices[np.unique(walls.faces[own])])
            self.assertGreater(mesh.volume, 0)
            self.assertEqual(adaptiso.check(mesh).failed, [])
            self.assertAlmostEqual(mesh.volume, walls.regions[label].volume, places=6)
        self.assertEqual(len(walls.walls.faces), len(walls.faces))

    def test_views_outlive_the_walls(self):
        walls = adaptiso.labels(self.volume)
        label0, vertices = walls.label0, walls.vertices
        copies = label0.copy(), vertices.copy()
        del walls
        np.testing.assert_array_equal(label0, copies[0])
        np.testing.assert_array_equal(vertices, copies[1])

    def test_orders_types_and_threads_give_the_same_walls(self):
        truth = adaptiso.labels(self.volume)
        for volume in (np.ascontiguousarray(self.volume), self.volume.astype(np.uint8),
                       self.volume.astype(np.float32), self.volume.astype(">i4")):
            for threads in (1, 2):
                self.assertEqual(adaptiso.labels(volume, threads=threads), truth)

    def test_bounds_and_counts_are_met(self):
        self.assertLessEqual(adaptiso.labels(self.volume, max_error=0.4).error_bound, 0.4)
        few = adaptiso.labels(self.volume, triangles=200)
        self.assertLessEqual(len(few.faces), 200)
        self.assertEqual(few.report["walls"]["wantedTriangles"], 200)
        half = adaptiso.labels(self.volume, reduction=0.5)
        self.assertLessEqual(len(half.faces), 0.5 * half.report["walls"]["fullTriangles"] + 1)

    def test_some_regions_alone(self):
        some = adaptiso.labels(self.volume, labels=[7, 2])
        self.assertEqual(list(some.regions), [2, 7])
        whole = adaptiso.labels(self.volume)
        self.assertEqual(set(some.regions[7].neighbours), set(whole.regions[7].neighbours))
        self.assertLess(some.report["walls"]["fullTriangles"], whole.report["walls"]["fullTriangles"])
        # within 0.15 voxel of full walls that are alike: of a block 4 voxels thick a tenth at most
        self.assertAlmostEqual(some.regions[7].volume / whole.regions[7].volume, 1, delta=0.1)
        with self.assertRaises(adaptiso.Error):
            some.region(1)

    def test_nothing_of_them_changes(self):
        self.walls.regions.clear()
        self.assertGreater(len(self.walls.regions), 0)

    def test_pickles_are_whole(self):
        walls = adaptiso.labels(self.volume, affine=SHEARED, names={2: "two"})
        again = pickle.loads(pickle.dumps(walls))
        self.assertEqual(again, walls)
        self.assertEqual(again.regions, walls.regions)
        self.assertEqual(again.report, walls.report)
        self.assertEqual(again.region(2), walls.region(2))
        self.assertRegex(repr(again), r"^<adaptiso.LabelSurfaces of 3 regions, [\d,]+ triangles in "
                                      r"walls, within 0\.\d+ mm, RAS mm>$")

    def test_progress_is_told_and_can_stop(self):
        told = []
        adaptiso.labels(self.volume, progress=lambda stage, done: told.append(stage))
        self.assertGreater(len(told), 0)

        def stop(stage, done):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            adaptiso.labels(self.volume, progress=stop)
        self.assertTrue(self.volume.flags.writeable)

    def test_regions_are_taken_by_name(self):
        walls = adaptiso.labels(boxes(), names={1: "left", 2: "right", 7: "Right"})
        self.assertEqual(walls.region("left"), walls.region(1))
        self.assertEqual(walls.region("LEFT"), walls.region(1))
        self.assertEqual(walls.region("Right"), walls.region(7))
        self.assertEqual(adaptiso.labels(boxes()).region("region 7"), walls.region(7))
        for name, answer in (("lef", "label 'lef': no label has this name; did you mean left"),
                             ("RIGHT", "label 'RIGHT': is the name of 2, 7; give a number"), ("xyzzy", "see regions")):
            with self.assertRaisesRegex(adaptiso.Error, answer):
                walls.region(name)


class Refused(InFolder):
    def test_with_one_line(self):
        volume = boxes()
        for call in (lambda: adaptiso.labels(volume * 0.5), lambda: adaptiso.labels(volume * 0),
                     lambda: adaptiso.labels(volume, labels=[3]), lambda: adaptiso.labels(volume, labels=[]),
                     lambda: adaptiso.labels(volume, labels=[0]), lambda: adaptiso.labels(volume, labels="1"),
                     lambda: adaptiso.labels(volume, labels=[1.5]), lambda: adaptiso.labels(volume, labels=1),
                     lambda: adaptiso.labels(volume, max_error=-1), lambda: adaptiso.labels(volume, triangles=-1),
                     lambda: adaptiso.labels(volume, reduction=2), lambda: adaptiso.labels(volume, names=3),
                     lambda: adaptiso.labels(volume, names={1: 2}), lambda: adaptiso.labels(volume, names={"a": "b"}),
                     lambda: adaptiso.labels(volume, names=self.folder / "none.tsv"),
                     lambda: adaptiso.labels(np.full((4, 4, 4), np.nan)), lambda: adaptiso.labels(volume[0]),
                     lambda: adaptiso.labels(np.full((4, 4, 4), 2**40)), lambda: adaptiso.labels("nowhere.nii"),
                     lambda: adaptiso.labels(volume).region("one"), lambda: adaptiso.labels(volume).region(2**70),
                     lambda: adaptiso.labels(volume).save(self.folder / "a.ply"),
                     lambda: adaptiso.labels(volume).save(self.folder / "a.vtp", frame="scanner"),
                     lambda: adaptiso.labels(volume).save(self.folder / "no" / "a.vtp")):
            with self.assertRaises(adaptiso.Error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))
        self.assertEqual(list(self.folder.iterdir()), [])


    @needs("nibabel")
    def test_scaling_is_named_as_the_cause(self):
        """As of labels that were saved as floats scaled to int16."""
        import nibabel
        path = self.folder / "scaled.nii"
        nibabel.save(nibabel.Nifti1Image(boxes(), np.eye(4)), path)
        stored = bytearray(path.read_bytes())
        stored[112:120] = struct.pack("<ff", 0.03125, 0)
        path.write_bytes(stored)
        for given, cause in ((path, "scl_slope 0.03125, scl_inter 0"),
                             (nibabel.load(path), "slope 0.03125, intercept 0"),
                             (adaptiso.read(path), "scl_slope")):
            with self.assertRaisesRegex(adaptiso.Error, cause):
                adaptiso.labels(given)


@needs("nibabel")
class Bytes(InFolder):
    """Those of adaptiso-labels, for the same input and options."""

    def setUp(self):
        super().setUp()
        import nibabel
        self.input = self.folder / "seg.nii"
        nibabel.save(nibabel.Nifti1Image(boxes(), SHEARED), self.input)
        (self.folder / "seg.tsv").write_text(
            "index\tname\tcolor\n1\tleft\t#ff0000\n2\tright\t#00ff00\n7\ttop\t#0000ff\n")

    def compare(self, arguments, **options):
        folder = self.folder / "theirs"
        program("adaptiso-labels", self.input, "-o", folder, "--force", "--quiet", *arguments)
        frame = options.pop("frame", None)
        for image, affine in ((self.input, None), (boxes(), SHEARED)):
            walls = adaptiso.labels(image, affine=affine, **options)
            walls.save(self.folder / "walls.vtp", frame=frame)
            self.assertEqual((self.folder / "walls.vtp").read_bytes(),
                             (folder / "walls.vtp").read_bytes())
            for file in (folder / "regions").iterdir():
                ours = self.folder / ("ours" + file.suffix)
                walls.region(int(file.stem)).save(ours, frame=frame)
                self.assertEqual(ours.read_bytes(), file.read_bytes(), file.name)
        return walls, json.loads((folder / "report.json").read_text())

    def test_of_walls_and_regions(self):
        self.compare([])
        self.compare(["--max-error", 0.4, "--format", "stl"], max_error=0.4)
        self.compare(["--triangles", 300, "--coordinates", "lps"], triangles=300, frame="lps")
        self.compare(["--reduction", 0.7, "--labels", "2,7"], reduction=0.7, labels=(2, 7))
        self.compare(["--max-error", 0, "--coordinates", "voxel"], max_error=0, frame="voxel")

    def test_of_one_file_of_all_regions(self):
        walls = adaptiso.labels(self.input)
        for name in ("body.glb", "body.3mf"):
            program("adaptiso-labels", self.input, "-o", self.folder / name, "--quiet")
            walls.save(self.folder / ("our" + name))
            self.assertEqual((self.folder / ("our" + name)).read_bytes(), (self.folder / name).read_bytes())
            checked = adaptiso.check(self.folder / name)  # each solid alone: they share walls
            self.assertTrue(checked)
            self.assertGreater(checked.report["sharedWallTriangles"], 0)
        with self.assertRaisesRegex(adaptiso.Error, "frame 'voxel': must be one of ras, lps, tkras"):
            walls.save(self.folder / "body.glb", frame="voxel")

    def test_the_report_says_the_same(self):
        _, theirs = self.compare([])
        ours = adaptiso.labels(self.input).report
        self.assertEqual(ours["walls"], theirs["walls"])
        for our, their in zip(ours["regions"], theirs["regions"]):
            for key, value in our.items():
                self.assertEqual(value, their[key], key)
        self.assertEqual(len(ours["regions"]), len(theirs["regions"]))

    def test_names_are_found_given_or_read(self):
        self.assertEqual([region.name for region in adaptiso.labels(self.input).regions.values()],
                         ["left", "right", "top"])
        self.assertEqual(adaptiso.labels(self.input).regions[7].color, (0, 0, 255))
        named = adaptiso.labels(boxes(), names=self.folder / "seg.tsv")
        self.assertEqual(named.regions[2].name, "right")
        self.assertEqual(adaptiso.labels(self.input, names={2: "two"}).regions[2].name, "two")

    def test_labels_are_chosen_by_names(self):
        chosen = adaptiso.labels(self.input, labels=["LEFT", 7])
        self.assertEqual(set(chosen.regions), {1, 7})
        with self.assertRaisesRegex(adaptiso.Error, "labels 'righ': .*did you mean right"):
            adaptiso.labels(self.input, labels=["righ"])
        with self.assertRaisesRegex(adaptiso.Error, "names= takes a table of names"):
            adaptiso.labels(boxes(), labels=["left"])


class Masks(InFolder):
    """A folder of masks, or their files, is the map that adaptiso-labels makes of them."""

    def setUp(self):
        super().setUp()
        import nibabel
        self.masks = self.folder / "masks"
        self.masks.mkdir()
        volume = boxes()
        self.files = []
        for label, name in ((1, "left"), (2, "right"), (7, "top")):
            mask = (volume == label).astype(np.uint8)
            if name == "left":
                mask[8, 3:9, 3:7] = 1  # 24 voxels of the right one's
            self.files.append(self.masks / f"{name}.nii")
            nibabel.save(nibabel.Nifti1Image(mask, SHEARED), self.files[-1])

    def compare(self, walls, *arguments):
        folder = self.folder / "theirs"
        program("adaptiso-labels", *arguments, "-o", folder, "--force", "--quiet")
        walls.save(self.folder / "walls.vtp")
        self.assertEqual((self.folder / "walls.vtp").read_bytes(), (folder / "walls.vtp").read_bytes())
        theirs = json.loads((folder / "report.json").read_text())
        self.assertEqual(walls.report["masks"], theirs["input"]["masks"])
        self.assertEqual([region.name for region in walls.regions.values()],
                         [region["name"] for region in theirs["regions"]])

    def test_a_folder_and_its_files(self):
        with self.assertLogs("adaptiso") as log:
            walls = adaptiso.labels(self.masks)
        self.assertIn("24 voxels lie in more than one mask; the last by name keeps them: right 24 of left",
                      log.output[0])
        self.compare(walls, self.masks)
        self.assertEqual(walls.report["masks"]["sharedVoxels"], 24)
        self.assertEqual([region.name for region in walls.regions.values()], ["left", "right", "top"])
        self.assertEqual(walls, adaptiso.labels(list(map(str, self.files))))
        self.assertEqual(pickle.loads(pickle.dumps(walls)).report, walls.report)
        self.assertIsNone(adaptiso.labels(boxes()).report["masks"])

    def test_priorities_and_tables(self):
        self.compare(adaptiso.labels(self.masks, priority="largest"), self.masks, "--priority", "largest")
        (self.folder / "order.txt").write_text("left\n")
        self.compare(adaptiso.labels(self.masks, priority=["left"]), self.masks,
                     "--priority", self.folder / "order.txt")
        (self.folder / "names.tsv").write_text("index\tname\n5\ttop\n9\tleft\n")
        walls = adaptiso.labels(self.masks, names=self.folder / "names.tsv", labels=["top", "left"])
        self.assertEqual({label: region.name for label, region in walls.regions.items()}, {5: "top", 9: "left"})

    def test_segments_of_layers_keep_their_numbers(self):
        layers = np.zeros((2, *boxes().shape), np.uint8)
        layers[0] = boxes() % 7
        layers[1, 4:7, 4:8, 4:6] = 1
        names = ("Segment0_Name:=left\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
                 "Segment1_Name:=right\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n"
                 "Segment2_Name:=tumour\nSegment2_LabelValue:=1\nSegment2_Layer:=1\n")
        header = ("NRRD0004\ntype: uchar\ndimension: 4\nspace: left-posterior-superior\n"
                  f"sizes: {' '.join(map(str, layers.shape))}\n"
                  "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\n"
                  "encoding: raw\nspace origin: (0,0,0)\n")
        file = self.folder / "two.seg.nrrd"
        file.write_bytes((header + names + "\n").encode() + layers.tobytes("F"))
        walls = adaptiso.labels(file, segments="all")
        self.compare(walls, file, "--segments", "all")
        self.assertEqual({label: region.name for label, region in walls.regions.items()},
                         {1: "left", 2: "right", 3: "tumour"})

    def test_what_is_refused(self):
        for message, image, options in (
                ("priority: is for masks, and left.nii is one image", self.files[0], {"priority": "largest"}),
                ("priority 'lef': must be one of largest, smallest", self.masks, {"priority": "lef"}),
                ("priority 'lef': is no mask", self.masks, {"priority": ["lef"]}),
                ("priority 'top': stands there twice", self.masks, {"priority": ["top", "top"]}),
                ("priority, segments: are for a folder", boxes(), {"priority": "largest"}),
                ("segments 'some': must be one of all", self.masks, {"segments": "some"}),
                ("segments: they bring their names", self.files[0], {"segments": "all", "names": "names.tsv"}),
                ("segments: takes those of one file", self.files, {"segments": "all"}),
                ("names: masks go by their files' names", self.masks, {"names": {1: "a"}}),
                ("affine: a file has its own", self.masks, {"affine": SHEARED}),
                ("are two masks of one name, left", [self.files[0], self.files[0]], {})):
            with self.subTest(message), self.assertRaisesRegex(adaptiso.Error, message):
                adaptiso.labels(image, **options)


if __name__ == "__main__":
    unittest.main(verbosity=2)
