"""What nibabel and VTK make of the files that writeMesh() writes: clients.py <writeClientFiles>

Exits 77 (skipped) when nibabel or VTK's Python module is missing.
"""
import subprocess
import sys
import tempfile
import unittest
import warnings
import xml.etree.ElementTree
import zipfile
from pathlib import Path

try:
    import nibabel
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOGeometry import vtkGLTFReader, vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

# the sphere of WriteClientFiles.cxx: centre (12, -34, 56) in LPS mm, 20 * 4^3 triangles
CENTRE_RAS = np.array([-12.0, 34.0, 56.0])
RADIUS = 40.0
TRIANGLES = 1280
POINTS = 642
# float32 of coordinates below 256: 8e-6; the rest is the ninth digit of matrices
TOLERANCE = 3e-5


def moved(matrix, points):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def signed_volume(points, triangles):
    a, b, c = (points[triangles[:, corner]] - points[0] for corner in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def slicer_mark(reader):
    """The text in which 3D Slicer looks for its mark (vtkMRMLModelStorageNode::ReadDataInternal)."""
    if isinstance(reader, vtkXMLPolyDataReader):
        return "SPACE=" + reader.GetOutput().GetFieldData().GetAbstractArray("SPACE").GetValue(0)
    if isinstance(reader, vtkOBJReader):
        return reader.GetComment()
    if isinstance(reader, vtkPLYReader):
        comments = reader.GetComments()
        return "\n".join(comments.GetValue(i) for i in range(comments.GetNumberOfValues()))
    return reader.GetHeader()


class ClientTest(unittest.TestCase):
    folder = None

    def assert_sphere(self, points, triangles, outward=True):
        self.assertEqual(points.shape, (POINTS, 3))
        self.assertEqual(triangles.shape, (TRIANGLES, 3))
        radii = np.linalg.norm(points - CENTRE_RAS, axis=1)
        self.assertLess(np.abs(radii - RADIUS).max(), TOLERANCE)
        self.assertEqual(signed_volume(points, triangles) > 0, outward)

    def read_surface(self, name):
        """Points as stored, triangles, and the footer's tkRAS -> scanner RAS."""
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # nibabel only warns of a footer that it can't read
            points, triangles, info = nibabel.freesurfer.read_geometry(
                self.folder / name, read_metadata=True)
        self.assertEqual(list(info["head"]), [2, 0, 20])
        self.assertEqual(info["valid"].split()[0], "1")
        header = nibabel.freesurfer.MGHImage(
            np.zeros(info["volume"], np.uint8), np.eye(4)).header
        header["delta"] = info["voxelsize"]
        axes = np.array([info["xras"], info["yras"], info["zras"]])
        header["Mdc"] = axes
        header["Pxyz_c"] = info["cras"]
        # the header keeps float32: 4e-6 mm at 100 mm
        to_scanner = header.get_vox2ras() @ np.linalg.inv(header.get_vox2ras_tkr())
        return points, triangles, to_scanner, info

    def test_nibabel_gets_scanner_ras_through_the_footer(self):
        for name in ("ras.surf", "lps.surf", "oblique.surf", "mirrored.surf", "conformed.surf"):
            with self.subTest(name):
                points, triangles, to_scanner, _ = self.read_surface(name)
                self.assertGreater(signed_volume(points, triangles), 0)
                # a tkRAS that mirrors space turns what is outward there inward here
                rigid = np.linalg.det(to_scanner) > 0
                self.assertEqual(rigid, name != "oblique.surf")
                self.assert_sphere(moved(to_scanner, points), triangles, outward=rigid)

    def test_nibabel_reads_the_frame_that_was_asked_for(self):
        points, _, to_scanner, info = self.read_surface("ras.surf")
        np.testing.assert_allclose(to_scanner, np.eye(4), atol=1e-12)
        self.assertLess(np.abs(points.mean(axis=0) - CENTRE_RAS).max(), TOLERANCE)
        points, _, _, info = self.read_surface("conformed.surf")
        self.assertEqual(info["filename"], "orig.mgz")
        self.assertLess(np.abs(points.mean(axis=0) - (CENTRE_RAS - info["cras"])).max(), TOLERANCE)

    def test_nibabel_reads_gifti(self):
        for name in ("ras.gii", "lps.gii", "voxel.gii", "oblique.gii"):
            with self.subTest(name):
                image = nibabel.load(self.folder / name)
                points_array = image.get_arrays_from_intent("NIFTI_INTENT_POINTSET")[0]
                triangles = image.agg_data("triangle")
                self.assertEqual(points_array.data.dtype, np.float32)
                self.assertEqual(triangles.dtype, np.int32)
                system = points_array.coordsys
                codes = nibabel.nifti1.xform_codes
                self.assertEqual(system.xformspace, codes["NIFTI_XFORM_SCANNER_ANAT"])
                self.assertEqual(system.dataspace, codes[
                    "NIFTI_XFORM_SCANNER_ANAT" if name == "ras.gii" else "NIFTI_XFORM_UNKNOWN"])
                points = points_array.data.astype(float)
                self.assertGreater(signed_volume(points, triangles), 0)
                rigid = np.linalg.det(system.xform) > 0
                self.assert_sphere(moved(system.xform, points), triangles, outward=rigid)
        self.assertEqual(dict(nibabel.load(self.folder / "ras.gii").meta),
                         {"CoordinateFrame": "RAS mm"})

    def test_vtk_reads(self):
        readers = {"ras.vtp": vtkXMLPolyDataReader, "ras.vtk": vtkPolyDataReader,
                   "ras.ply": vtkPLYReader, "ras.stl": vtkSTLReader, "ras.obj": vtkOBJReader}
        for name, make_reader in readers.items():
            with self.subTest(name):
                reader = make_reader()
                reader.SetFileName(str(self.folder / name))
                reader.Update()
                self.assertEqual(reader.GetErrorCode(), 0)
                data = reader.GetOutput()
                self.assertIn("SPACE=RAS", slicer_mark(reader))
                points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
                triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
                self.assert_sphere(points, triangles)
                if name == "ras.stl":
                    continue
                normals = vtk_to_numpy(data.GetPointData().GetNormals())
                radial = (points - CENTRE_RAS) / RADIUS
                self.assertLess(np.abs(normals - radial).max(), TOLERANCE)

    def test_vtk_places_glb_upright_in_metres(self):
        for name in ("ras.glb", "lps.glb"):
            with self.subTest(name):
                reader = vtkGLTFReader()
                reader.SetFileName(str(self.folder / name))
                reader.Update()
                parts = reader.GetOutput().NewIterator()
                data = parts.GetCurrentDataObject()
                x, y, z = 1000 * vtk_to_numpy(data.GetPoints().GetData()).astype(float).T
                triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
                self.assert_sphere(np.column_stack((-x, z, y)), triangles)  # Y up, Z to the front
                parts.GoToNextItem()
                self.assertEqual(parts.GetCurrentDataObject().GetNumberOfPolys(), 4)

    def test_3mf_is_a_zip_of_xml(self):
        archive = zipfile.ZipFile(self.folder / "ras.3mf")
        self.assertIsNone(archive.testzip())
        model = xml.etree.ElementTree.fromstring(archive.read("3D/3dmodel.model"))
        core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
        self.assertEqual(model.get("unit"), "millimeter")
        ball, cell = model.iter(core + "object")
        self.assertEqual((ball.get("name"), cell.get("name")), ("ball", "cell"))
        self.assertEqual(model.find(f".//{core}base").get("displaycolor"), "#FF0000")
        self.assertEqual([item.get("objectid") for item in model.iter(core + "item")], ["2", "3"])
        self.assert_sphere(
            np.array([[float(v.get(axis)) for axis in "xyz"] for v in ball.iter(core + "vertex")]),
            np.array([[int(t.get(v)) for v in ("v1", "v2", "v3")] for t in ball.iter(core + "triangle")]))

    def test_vtk_finds_the_frame_in_field_data(self):
        for name, make_reader in (("ras.vtp", vtkXMLPolyDataReader), ("ras.vtk", vtkPolyDataReader)):
            reader = make_reader()
            reader.SetFileName(str(self.folder / name))
            reader.Update()
            fields = reader.GetOutput().GetFieldData()
            self.assertEqual(fields.GetAbstractArray("CoordinateFrame").GetValue(0), "RAS mm")
            self.assertEqual(fields.GetAbstractArray("AdaptisoSurfaceVersion").GetValue(0), "1")

    def test_vtp_and_vtk_keep_doubles(self):
        for name, make_reader in (("ras.vtp", vtkXMLPolyDataReader), ("ras.vtk", vtkPolyDataReader)):
            reader = make_reader()
            reader.SetFileName(str(self.folder / name))
            reader.Update()
            self.assertEqual(vtk_to_numpy(reader.GetOutput().GetPoints().GetData()).dtype, np.float64)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], folder], check=True)
        ClientTest.folder = Path(folder)
        unittest.main(argv=sys.argv[:1], verbosity=2)
