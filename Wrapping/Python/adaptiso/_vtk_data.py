"""Meshes as VTK's data."""

from __future__ import annotations

from typing import Any, List, Tuple

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray

from ._adaptiso import Error


def show(data: Any) -> None:
    """Opens a window with a vtkPolyData; returns when it is closed."""
    import vtkmodules.vtkInteractionStyle
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer,
                                             vtkRenderWindow, vtkRenderWindowInteractor)
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtkActor()
    actor.SetMapper(mapper)
    renderer = vtkRenderer()
    renderer.AddActor(actor)
    window = vtkRenderWindow()
    window.AddRenderer(renderer)
    interactor = vtkRenderWindowInteractor()
    interactor.SetRenderWindow(window)
    interactor.Start()


def arrays_of(data: Any) -> Tuple[Any, Any]:
    """Vertices and faces of a vtkPolyData. \\raises Error"""
    cells, points = data.GetPolys(), data.GetPoints()
    sizes = np.diff(vtk_to_numpy(cells.GetOffsetsArray()))
    if data.GetNumberOfStrips() or (sizes != 3).any():
        raise Error("the data have polygons or strips, must have triangles (vtkTriangleFilter makes "
                    "them)")
    return (np.empty((0, 3)) if points is None else vtk_to_numpy(points.GetData()),
            vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 3))


def normals_of(data: Any) -> Any:
    """Those at the points of a vtkPolyData, or None."""
    normals = data.GetPointData().GetNormals()
    return None if normals is None else vtk_to_numpy(normals)


def fill(output: Any, meshes: List[Any], turn: Any, with_normals: bool) -> None:
    """Puts meshes into a vtkPolyData, one behind the other. \\param turn  signs of x, y, z, or None"""
    def joined(parts: List[Any], dtype: Any) -> Any:
        whole = parts[0] if len(parts) == 1 else np.concatenate([np.empty((0, 3), dtype), *parts])
        return whole if turn is None or dtype is np.int64 else (whole * turn + 0.0).astype(dtype)

    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = joined([mesh.faces + start for mesh, start in zip(meshes, first)], np.int64)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(joined([mesh.vertices for mesh in meshes], np.float64)))
    cells = vtkCellArray()
    # copies: a vtkCellArray shares such arrays' memory without keeping what owns it
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(faces) + 1, 3), deep=1),
                  numpy_to_vtkIdTypeArray(faces.ravel(), deep=1))
    output.SetPoints(points)
    output.SetPolys(cells)
    if with_normals and all(len(mesh._data.normals) for mesh in meshes):
        normals = numpy_to_vtk(joined([mesh._data.normals for mesh in meshes], np.float32))
        normals.SetName("Normals")
        output.GetPointData().SetNormals(normals)
