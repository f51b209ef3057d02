"""What others make of the files of adaptiso-labels: VTK, nibabel, tetgen, gmsh, and where it is
installed the checker check_labels.py. What is missing is skipped by name."""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from labelsSupport import LabelsTest, three_boxes
from support import BAD_INPUT, SOURCE, write_nifti

SKIPPED = 77
try:
    import nibabel
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataReader, vtkXMLPolyDataReader
except ImportError as missing:
    print(f"skipped: needs python3-nibabel and python3-vtk9 ({missing})")
    sys.exit(SKIPPED)

try:
    import meshio
except ImportError:
    meshio = None

CHECKER = Path(os.environ.get("ADAPTISO_CHECK_LABELS",
                              SOURCE.parent / "shared/tools/labels/check_labels.py"))
TEMPLATES = Path("/usr/share/mricron/templates")


def read_vtp(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def triangles_of(data):
    return vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)


class ClientTest(LabelsTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("boxes.nii"), three_boxes(spacing=(1, 1.5, 2), origin=(-5, 3, 20)))
        self.path("boxes.tsv").write_text(
            "index\tname\tcolor\n1\tleft/one\t#ff8000\n2\tright & more\t#0000ff\n7\tinner\tn/a\n")

    def test_vtk_reads_walls_and_regions(self):
        self.labels("boxes.nii", "-o", "out", "-q")
        walls = read_vtp(self.path("out/walls.vtp"))
        cells = walls.GetCellData()
        sides = [vtk_to_numpy(cells.GetArray(name)) for name in ("label0", "label1")]
        for name in ("label0", "label1"):
            self.assertEqual(cells.GetArray(name).GetDataTypeAsString(), "int")
        self.assertEqual(set(sides[0]) | set(sides[1]), {0, 1, 2, 7})
        points, triangles = points_of(walls), triangles_of(walls)
        self.assertEqual(len(np.unique(points, axis=0)), len(points), "points are stored once")
        for label in (1, 2, 7):
            region = read_vtp(self.path(f"out/regions/{label}.vtp"))
            # the very doubles of the walls, each triangle with its normal out of the region
            own = points_of(region)[triangles_of(region)]
            forward, backward = sides[0] == label, sides[1] == label
            wanted = points[np.concatenate([triangles[forward], triangles[backward][:, ::-1]])]
            def keys(corners):
                turns = [np.roll(corners, turn, axis=1).reshape(-1, 9) for turn in range(3)]
                return sorted(min(map(tuple, each)) for each in np.stack(turns, axis=1))
            self.assertEqual(keys(own), keys(wanted))

    def test_normals_point_from_the_first_label_into_the_second(self):
        self.labels("boxes.nii", "-o", "out", "-q")
        walls = read_vtp(self.path("out/walls.vtp"))
        points, triangles = points_of(walls), triangles_of(walls)
        sides = np.stack([vtk_to_numpy(walls.GetCellData().GetArray(name))
                          for name in ("label0", "label1")], axis=1)
        image = nibabel.load(self.path("boxes.nii"))
        labels, to_index = np.asarray(image.dataobj), np.linalg.inv(image.affine)
        corners = points[triangles]
        middle = corners.mean(axis=1)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        # a step of 0.8 mm leads into the voxel beyond where a wall is flat: nearly everywhere
        for side, sign in ((0, -1), (1, 1)):
            at = middle + sign * 0.8 * normal
            index = np.rint(at @ to_index[:3, :3].T + to_index[:3, 3]).astype(int)
            index = np.clip(index, 0, np.array(labels.shape) - 1)
            found = labels[tuple(index.T)]
            self.assertGreater(np.mean(found == sides[:, side]), 0.8)

    def test_vtk_reads_the_multiblock(self):
        for arguments in ((), ("--format", "stl")):
            self.labels("boxes.nii", "-o", "out", "--force", "-q", *arguments)
            reader = vtkXMLMultiBlockDataReader()
            reader.SetFileName(str(self.path("out/all.vtm")))
            reader.Update()
            blocks = reader.GetOutput()
            self.assertEqual(blocks.GetNumberOfBlocks(), 3)
            names = [blocks.GetMetaData(n).Get(blocks.NAME()) for n in range(3)]
            self.assertEqual(names, ["left/one", "right & more", "inner"])
            rows = self.table("out")
            for n, label in enumerate((1, 2, 7)):
                self.assertEqual(blocks.GetBlock(n).GetNumberOfCells(),
                                 int(rows[label]["triangles"]))

    def test_nibabel_reads_the_labels(self):
        self.labels("boxes.nii", "-o", "out", "-q")
        surface = nibabel.load(self.path("out/all.surf.gii"))
        points, triangles = surface.agg_data("pointset"), surface.agg_data("triangle")
        labels = nibabel.load(self.path("out/all.label.gii"))
        keys = labels.agg_data("label")
        self.assertEqual(len(surface.darrays), 2, "Connectome Workbench takes no more")
        self.assertEqual(len(keys), len(points))
        table = {each.key: (each.label, each.rgba) for each in labels.labeltable.labels}
        self.assertEqual(set(table), {0, 1, 2, 7})
        self.assertEqual(table[1][0], "left/one")
        self.assertEqual(table[2][0], "right & more")
        np.testing.assert_allclose(table[1][1], (1, 128 / 255, 0, 1), atol=1e-6)
        rows = self.table("out")
        for label in (1, 2, 7):
            own = (keys[triangles] == label).all(axis=1)
            self.assertEqual(own.sum(), int(rows[label]["triangles"]))
        self.assertTrue((keys[triangles] == keys[triangles][:, :1]).all())

    def test_vtk_and_nibabel_read_regions_of_other_formats(self):
        self.labels("boxes.nii", "-o", "gii", "--format", "gii", "-q")
        region = nibabel.load(self.path("gii/regions/7.gii"))
        self.assertEqual(len(region.agg_data("triangle")), int(self.table("gii")[7]["triangles"]))
        self.labels("boxes.nii", "-o", "surf", "--format", "surf", "-q")
        _, triangles = nibabel.freesurfer.read_geometry(self.path("surf/regions/7.surf"))
        self.assertEqual(len(triangles), int(self.table("surf")[7]["triangles"]))


class MesherTest(LabelsTest):
    """Meshers take the walls as they are: one volume for each region."""

    def walls(self):
        write_nifti(self.path("boxes.nii"), three_boxes())
        self.labels("boxes.nii", "-o", "out", "-q", "--max-error", "0.3")
        return read_vtp(self.path("out/walls.vtp"))

    def test_tetgen(self):
        if not shutil.which("tetgen"):
            self.skipTest("needs tetgen")
        walls = self.walls()
        points, triangles = points_of(walls), triangles_of(walls)
        lines = [f"{len(points)} 3 0 0"]
        lines += [f"{n} {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(points.tolist())]
        lines += [f"{len(triangles)} 0"]
        lines += [f"1\n3 {a} {b} {c}" for a, b, c in triangles.tolist()]
        # a point in each box: RAS is the image's own frame here
        seeds = {1: (3, 4, 3), 2: (12, 4, 3), 7: (8, 7, 6)}
        lines += ["0", str(len(seeds))]
        lines += [f"{n} {x} {y} {z} {label} 0"
                  for n, (label, (x, y, z)) in enumerate(seeds.items())]
        self.path("walls.poly").write_text("\n".join(lines) + "\n")
        done = subprocess.run(["tetgen", "-pA", "walls.poly"], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        nodes = np.loadtxt(self.path("walls.1.node"), skiprows=1)[:, 1:4]
        elements = np.loadtxt(self.path("walls.1.ele"), skiprows=1).astype(int)
        corners = nodes[elements[:, 1:5] - elements[:, 1:5].min()]
        volumes = np.abs(np.einsum("ij,ij->i", corners[:, 1] - corners[:, 0],
                                   np.cross(corners[:, 2] - corners[:, 0],
                                            corners[:, 3] - corners[:, 0]))) / 6
        rows = self.table("out")
        self.assertEqual(set(elements[:, 5]), {1, 2, 7})
        for label in (1, 2, 7):
            volume = volumes[elements[:, 5] == label].sum()
            wanted = float(rows[label]["volume_mm3"])
            # tetgen takes facets that are nearly in one plane for one
            self.assertAlmostEqual(volume, wanted, delta=1e-5 * wanted)

    def test_gmsh(self):
        if not shutil.which("gmsh"):
            self.skipTest("needs gmsh")
        walls = self.walls()
        points, triangles = points_of(walls), triangles_of(walls)
        sides = np.stack([vtk_to_numpy(walls.GetCellData().GetArray(name))
                          for name in ("label0", "label1")], axis=1)
        # one discrete surface a wall, one volume a region, bounded by its walls
        pairs = sorted({tuple(pair) for pair in sides.tolist()})
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(points))]
        lines += [f"{n + 1} {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(points.tolist())]
        lines += ["$EndNodes", "$Elements", str(len(triangles))]
        for n, (corners, pair) in enumerate(zip(triangles.tolist(), sides.tolist())):
            wall = pairs.index(tuple(pair)) + 1
            lines.append(f"{n + 1} 2 2 {wall} {wall} " + " ".join(str(v + 1) for v in corners))
        self.path("walls.msh").write_text("\n".join(lines + ["$EndElements"]) + "\n")
        geometry = ['Merge "walls.msh";']
        for n, label in enumerate((1, 2, 7)):
            own = [str(wall + 1) for wall, pair in enumerate(pairs) if label in pair]
            geometry.append(f"Surface Loop({n + 1}) = {{{', '.join(own)}}};")
            geometry.append(f"Volume({n + 1}) = {{{n + 1}}};")
            geometry.append(f"Physical Volume({label}) = {{{n + 1}}};")
        self.path("walls.geo").write_text("\n".join(geometry) + "\n")
        done = subprocess.run(["gmsh", "-3", "walls.geo", "-o", "volumes.msh", "-format", "msh2"],
                              cwd=self.folder, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        self.assertNotIn("Error", done.stdout)
        text = self.path("volumes.msh").read_text().split("\n")
        at = text.index("$Nodes")
        nodes = {}
        for line in text[at + 2:at + 2 + int(text[at + 1])]:
            number, *xyz = line.split()
            nodes[number] = [float(each) for each in xyz]
        at = text.index("$Elements")
        volumes = {1: 0.0, 2: 0.0, 7: 0.0}
        for line in text[at + 2:at + 2 + int(text[at + 1])]:
            words = line.split()
            if words[1] == "4":
                corners = np.array([nodes[each] for each in words[-4:]])
                volumes[int(words[3])] += abs(np.linalg.det(corners[1:] - corners[0])) / 6
        rows = self.table("out")
        for label, volume in volumes.items():
            wanted = float(rows[label]["volume_mm3"])
            self.assertAlmostEqual(volume, wanted, delta=1e-6 * wanted)


class TetrahedraTest(LabelsTest):
    """--tetrahedra: the mesher is run by the program."""

    def volumes(self, folder, key="gmsh:physical", name="tetrahedra.msh"):
        made = meshio.read(self.path(folder) / name)
        cells = np.concatenate([c.data for c in made.cells if c.type == "tetra"])
        labels = np.concatenate([d for d, c in zip(made.cell_data[key], made.cells) if c.type == "tetra"])
        corners = made.points[cells]
        six = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
                        corners[:, 3] - corners[:, 0])
        self.assertGreater(six.min(), 0)
        return corners, labels, six / 6

    def test_each_region_is_one_volume(self):
        """Two pieces of region 1, one with a cavity that region 2 fills in part: what is 0 stays empty."""
        if meshio is None:
            self.skipTest("needs python3-meshio")
        labels = np.zeros((20, 14, 14), np.uint8)
        labels[1:12, 1:13, 1:13] = 1
        labels[4:10, 4:10, 4:10] = 0
        labels[4:7, 4:10, 4:10] = 2
        labels[14:18, 3:9, 3:9] = 1
        labels[12:14, 2:6, 2:6] = 3
        affine = np.diag([-1.0, 1.5, 2, 1])
        affine[:3, 3] = 40, -7, 3
        nibabel.save(nibabel.Nifti1Image(labels, affine), self.path("pieces.nii.gz"))
        for mesher in filter(shutil.which, ("tetgen", "gmsh")):
            for frame in ("ras", "lps"):
                with self.subTest(mesher=mesher, frame=frame):
                    folder = f"{mesher}-{frame}"
                    self.labels("pieces.nii.gz", "-o", folder, "-q", "--tetrahedra", mesher, "--element-size",
                                "4", "--coordinates", frame)
                    corners, found, volumes = self.volumes(folder)
                    rows = self.table(folder)
                    self.assertEqual(set(found), {1, 2, 3})
                    for label in (1, 2, 3):
                        wanted = float(rows[label]["volume_mm3"])
                        self.assertAlmostEqual(volumes[found == label].sum(), wanted,
                                               delta=1e-4 * wanted + 1e-3 * float(rows[label]["area_mm2"]))
                    sign = -1 if frame == "lps" else 1
                    self.look(corners * (sign, sign, 1), found, labels, np.linalg.inv(affine))
                    for name, key in (("tetrahedra-4.1.msh", "gmsh:physical"), ("tetrahedra.vtu", "tissue")):
                        again = self.volumes(folder, key, name)
                        self.assertEqual(sorted(again[1]), sorted(found))
                        self.assertAlmostEqual(again[2].sum(), volumes.sum(), places=3)
                    regions = self.folder_report(folder)["tetrahedra"]["regions"]
                    self.assertEqual([r["label"] for r in regions], [1, 2, 3])
                    self.assertEqual([round(r["voxelsMm3"]) for r in regions],
                                     [3 * (labels == n).sum() for n in (1, 2, 3)])

    def look(self, corners, found, labels, to_index):
        """Each voxel centre lies in an element of its label, or in none where it is 0."""
        corners = corners @ to_index[:3, :3].T + to_index[:3, 3]
        inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
        for index in np.ndindex(labels.shape):
            shares = np.einsum("tij,tj->ti", inverse, np.array(index) - corners[:, 0])
            inside = (shares.min(axis=1) > -1e-9) & (shares.sum(axis=1) < 1 + 1e-9)
            self.assertEqual(set(found[inside]), {labels[index]} - {0}, index)

    def test_labels_below_one_are_refused(self):
        if not shutil.which("tetgen"):
            self.skipTest("needs tetgen")
        labels = np.zeros((9, 9, 9), np.int16)
        labels[2:7, 2:7, 2:7] = -3
        nibabel.save(nibabel.Nifti1Image(labels, np.eye(4)), self.path("negative.nii"))
        self.refused(BAD_INPUT, "--tetrahedra: the map has the label -3", "negative.nii", "-o", "n",
                   "--tetrahedra", "tetgen")


class AtlasTest(LabelsTest):
    """Debian's atlases, judged by the checker that has no part in this project."""

    def judged(self, image, *arguments):
        if not CHECKER.is_file():
            self.skipTest(f"needs {CHECKER}")
        if not Path("/usr/include/CGAL").is_dir():
            self.skipTest("needs libcgal-dev, which that checker is compiled with")
        if not Path(image).is_file():
            self.skipTest("needs mricron-data")
        self.labels(image, "-o", "out", "-q", "--no-warnings", *arguments)
        self.labels(image, "-o", "full", "-q", "--no-warnings", "--max-error", "0")
        bound = self.folder_report("out")["walls"]["errorBoundMm"]
        done = subprocess.run(["/usr/bin/python3", str(CHECKER), str(image), "out", "--max-error",
                               repr(bound), "--against", "full/walls.vtp"], cwd=self.folder,
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=1700)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_three_boxes(self):
        write_nifti(self.path("boxes.nii"), three_boxes(spacing=(1, 1.5, 2)))
        self.judged(self.path("boxes.nii"))

    def test_white_matter(self):
        self.judged(TEMPLATES / "JHU-WhiteMatter-labels-2mm.nii.gz")


if __name__ == "__main__":
    program = unittest.main(exit=False)
    for test, why in program.result.skipped:
        print(f"skipped: {test}: {why}")
    sys.exit(not program.result.wasSuccessful())
