"""Filters for VTK's pipelines: the program's mesh to the bit, frames, errors, point data. Exit code 77:
VTK's Python package is not there."""

import sys
import unittest

import numpy as np
from support import BIN, BRAIN, InFolder, ball, program

import adaptiso

try:
    from adaptiso.vtk import Isosurface, Simplify
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOImage import vtkNIFTIImageReader
except ImportError:
    print("not installed: vtkmodules")
    sys.exit(77)

OBLIQUE = np.array([[0.9, -0.3, 0.1, 4], [0.28, 1.1, -0.2, -30], [0, 0.2, 1.3, 7], [0, 0, 0, 1]])


def image_of(array, affine):
    """A vtkImageData that shares the samples."""
    image = vtkImageData()
    image.SetDimensions(array.shape)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    image.SetSpacing(spacing)
    image.SetOrigin(affine[:3, 3])
    for row in range(3):
        for axis in range(3):
            image.GetDirectionMatrix().SetElement(row, axis, affine[row, axis] / spacing[axis])
    scalars = numpy_to_vtk(array.ravel(order="F"))
    scalars.SetName("T1")
    image.GetPointData().SetScalars(scalars)
    return image


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def faces_of(data):
    return vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def bound_of(data):
    return data.GetFieldData().GetArray("ErrorBound").GetTuple1(0)


def errors_of(algorithm):
    """The texts of its error events at an update."""
    errors = []

    def keep(caller, event, text):
        errors.append(text)

    keep.CallDataType = "string0"
    tags = [(each, each.AddObserver("ErrorEvent", keep))
            for each in (algorithm, algorithm.GetExecutive())]
    algorithm.Update()
    for each, tag in tags:
        each.RemoveObserver(tag)
    return errors


class IsosurfaceTest(InFolder):
    def test_the_mesh_is_the_surface_functions_and_the_programs_to_the_bit(self):
        array = np.asfortranarray(ball((40, 36, 32), affine=OBLIQUE).astype(np.float32))
        image = image_of(array, OBLIQUE)
        affine = np.eye(4)  # as VTK keeps it
        for row in range(3):
            for axis in range(3):
                affine[row, axis] = (image.GetDirectionMatrix().GetElement(row, axis)
                                     * image.GetSpacing()[axis])
        affine[:3, 3] = image.GetOrigin()
        wanted = adaptiso.surface(array, -10, affine=affine)
        filter = Isosurface()
        filter.SetInputData(image)
        filter.SetValue(0, -10)
        filter.SetCoordinateFrame(1)
        filter.Update()
        made = filter.GetOutput()
        self.assertGreater(made.GetNumberOfPolys(), 100)
        np.testing.assert_array_equal(points_of(made), wanted.vertices)
        np.testing.assert_array_equal(faces_of(made), wanted.faces)
        np.testing.assert_array_equal(vtk_to_numpy(made.GetPointData().GetNormals()),
                                      wanted.normals.astype(np.float32))
        self.assertEqual(bound_of(made), wanted.error_bound)
        self.assertEqual(made.GetFieldData().GetAbstractArray("SPACE").GetValue(0), "RAS")

        filter.SetCoordinateFrame(2)  # the same place in another frame
        image.SetOrigin(affine[:3, 3] * (-1, -1, 1))
        for row in range(2):
            for axis in range(3):
                image.GetDirectionMatrix().SetElement(
                    row, axis, -image.GetDirectionMatrix().GetElement(row, axis))
        image.Modified()
        filter.Update()
        np.testing.assert_array_equal(points_of(filter.GetOutput()) * (-1, -1, 1), wanted.vertices)
        np.testing.assert_array_equal(faces_of(filter.GetOutput()), wanted.faces)

    @unittest.skipUnless(BRAIN.exists() and (BIN / "adaptiso-mesh").exists(), "no scan or program")
    def test_the_quickstarts_scan_gives_the_programs_bytes(self):
        program("adaptiso-mesh", BRAIN, "--iso", 100, "-o", self.folder / "program.vtp")
        wanted = adaptiso.load(self.folder / "program.vtp")
        scan = adaptiso.read(BRAIN)
        filter = Isosurface()
        filter.SetInputDataObject(image_of(scan.array, scan.affine))
        filter.SetValue(0, 100)
        filter.Update()
        self.assertEqual(points_of(filter.GetOutput()).tobytes(), wanted.vertices.tobytes())
        self.assertEqual(faces_of(filter.GetOutput()).tobytes(), wanted.faces.tobytes())
        # and by VTK's own reader, which keeps the place in a matrix of its own
        reader = vtkNIFTIImageReader()
        reader.SetFileName(str(BRAIN))
        filter.SetInputConnection(reader.GetOutputPort())
        filter.Update()
        self.assertEqual(filter.GetOutput().GetNumberOfPolys(), 228_714)

    def test_values_that_are_not_reached_have_no_surface(self):
        filter = Isosurface()
        filter.SetInputDataObject(image_of(ball(), np.eye(4)))
        filter.GenerateValues(3, -8, 2)  # -8, -3, 2
        filter.SetComputeNormals(0)
        self.assertEqual(errors_of(filter), [])
        made = filter.GetOutput()
        radius = np.linalg.norm(points_of(made) - 11.5, axis=1)
        values = vtk_to_numpy(made.GetPointData().GetScalars())
        self.assertEqual(made.GetPointData().GetScalars().GetName(), "T1")
        self.assertEqual(set(values), {-8, -3})
        np.testing.assert_allclose(radius, -values, atol=0.3)  # the bound, and the sphere's bend
        self.assertIsNone(made.GetPointData().GetNormals())
        self.assertEqual(vtk_to_numpy(made.GetFieldData().GetArray("ErrorBound"))[2], 0)
        filter.SetNumberOfContours(1)
        filter.SetValue(0, 99)
        self.assertEqual(errors_of(filter), [])
        self.assertEqual(filter.GetOutput().GetNumberOfPoints(), 0)

    def test_abort_leaves_nothing(self):
        filter = Isosurface()
        filter.SetInputDataObject(image_of(ball((80, 80, 80)), np.eye(4)))
        filter.SetValue(0, -24)
        seen = []

        def stop(caller, event):
            seen.append(caller.GetProgress())
            if caller.GetProgress() > 0.2:
                caller.AbortExecuteOn()

        filter.AddObserver("ProgressEvent", stop)
        self.assertEqual(errors_of(filter), [])
        self.assertEqual(filter.GetOutput().GetNumberOfPoints(), 0)
        if seen[-1] == 1:  # VTK 9.3's own
            del seen[-1]
        self.assertGreater(len(seen), 1)
        self.assertLess(max(seen), 0.9)
        filter.RemoveAllObservers()
        filter.AbortExecuteOff()  # VTK 9.1 does it itself
        filter.Modified()
        filter.Update()
        self.assertGreater(filter.GetOutput().GetNumberOfPoints(), 0)

    def test_what_cannot_be_used_is_an_error_event(self):
        image = image_of(ball(), np.eye(4))
        filter = Isosurface()
        filter.SetInputDataObject(image)
        filter.SetValue(0, float("nan"))
        self.assertIn("level", errors_of(filter)[0])
        filter.SetValue(0, -8)
        image.GetPointData().SetScalars(numpy_to_vtk(np.zeros((image.GetNumberOfPoints(), 3))))
        self.assertIn("3 components", errors_of(filter)[0])
        self.assertEqual(filter.GetOutput().GetNumberOfPoints(), 0)


class SimplifyTest(unittest.TestCase):
    def setUp(self):
        self.fine = adaptiso.surface(ball((48, 48, 48)), -20, method="mc")
        self.data = self.fine.to_vtk()

    def test_the_mesh_is_the_functions_to_the_bit(self):
        wanted = adaptiso.simplify(self.fine, max_error=0.2)
        filter = Simplify()
        filter.SetInputDataObject(self.data)
        filter.SetMaximumError(0.2)
        filter.Update()
        np.testing.assert_array_equal(points_of(filter.GetOutput()), wanted.vertices)
        np.testing.assert_array_equal(faces_of(filter.GetOutput()), wanted.faces)
        self.assertEqual(bound_of(filter.GetOutput()), wanted.error_bound)

    def test_point_data_come_along(self):
        x, y, z = self.fine.vertices.T
        for name, values in (("height", z), ("label", np.where(x < 23, 7, 1000)),
                             ("color", np.stack([5 * y, 0 * y, 0 * y + 255], 1).astype(np.uint8))):
            array = numpy_to_vtk(values, deep=1)
            array.SetName(name)
            self.data.GetPointData().AddArray(array)
        side = vtkStringArray()
        side.SetName("side")
        for each in x:
            side.InsertNextValue("left" if each < 23 else "right")
        self.data.GetPointData().AddArray(side)
        self.data.GetPointData().SetActiveScalars("label")
        filter = Simplify()
        filter.SetInputDataObject(self.data)
        filter.SetTargetReduction(0.8)
        filter.Update()
        made = filter.GetOutput()
        values = made.GetPointData()
        x, y, z = points_of(made).T
        bound = bound_of(made)
        self.assertLessEqual(made.GetNumberOfPolys(), 0.2 * len(self.fine.faces) + 1)
        np.testing.assert_allclose(vtk_to_numpy(values.GetArray("height")), z, atol=bound + 1e-9)
        np.testing.assert_allclose(vtk_to_numpy(values.GetArray("color"))[:, 0], 5 * y,
                                   atol=5 * bound + 2)
        labels = vtk_to_numpy(values.GetScalars())
        self.assertEqual(set(labels), {7, 1000})
        far = abs(x - 23) > 2  # input edges are shorter
        np.testing.assert_array_equal(labels[far], np.where(x < 23, 7, 1000)[far])
        sides = values.GetAbstractArray("side")
        self.assertEqual([sides.GetValue(n) for n in range(len(x))],
                         ["left" if each == 7 else "right" for each in labels])

    def test_what_cannot_be_used_is_an_error_event(self):
        filter = Simplify()
        filter.SetInputDataObject(self.data)
        self.assertIn("max_error", errors_of(filter)[0])
        self.data.GetPolys().InsertNextCell(4, [0, 1, 2, 3])
        filter.SetMaximumError(0.2)
        self.data.Modified()
        self.assertIn("vtkTriangleFilter", errors_of(filter)[0])


if __name__ == "__main__":
    unittest.main(verbosity=2)
