"""Filters for VTK's pipelines in Python, and in ParaView.

>>> from adaptiso.vtk import Isosurface, Simplify
>>> from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
>>> source, isosurface, simplify = vtkRTAnalyticSource(), Isosurface(), Simplify()
>>> isosurface.SetInputConnection(source.GetOutputPort())
>>> isosurface.SetValue(0, 150)
>>> simplify.SetInputConnection(isosurface.GetOutputPort())
>>> simplify.SetMaximumError(0.3)
>>> simplify.Update()
>>> 0 < simplify.GetOutput().GetNumberOfPolys() < isosurface.GetOutput().GetNumberOfPolys()
True

They have the properties, fields and results of the C++ classes vtkAdaptisoIsosurface and
vtkAdaptisoSimplify. An input that can't be used is an error event, which VTK prints unless it is
observed, and an empty output. AbortExecute ends the work at the next progress event, with an empty
output. Needs VTK's Python package: Debian's python3-vtk9, ParaView's own, or pip's vtk.
"""

from __future__ import annotations

from typing import Any, Callable, List, Optional, Tuple

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import (VTK_DOUBLE, VTK_FLOAT, VTK_UNSIGNED_CHAR, vtkOutputWindow,
                                      vtkStringArray)
from vtkmodules.vtkCommonDataModel import (vtkDataObject, vtkDataSetAttributes, vtkImageData,
                                           vtkPolyData)
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

from . import _adaptiso, _surface
from ._adaptiso import Error
from ._images import read_only, samples_of
from ._mesh import Mesh
from ._options import checked
from ._simplify import simplify
from ._vtk_data import arrays_of, fill

__all__ = ["Isosurface", "Simplify"]


class _Aborted(Exception):
    pass


class _Filter(VTKPythonAlgorithmBase):  # type: ignore[misc]
    """Properties, errors and progress as VTK has them."""

    def __init__(self, input_type: str) -> None:
        super().__init__(nInputPorts=1, inputType=input_type, nOutputPorts=1,
                         outputType="vtkPolyData")
        self._maximum_error = self._target_reduction = 0.0

    def SetInputData(self, data: Any) -> None:
        """The input, as data instead of another filter's output."""
        self.SetInputDataObject(0, data)

    def GetOutput(self) -> Any:
        """The vtkPolyData."""
        return self.GetOutputDataObject(0)

    def SetMaximumError(self, error: float) -> None:
        """Largest distance, both ways, in the unit of the input's points; 0: as the class says."""
        self._set("_maximum_error", max(float(error), 0.0))

    def GetMaximumError(self) -> float:
        """As set."""
        return self._maximum_error

    def SetTargetReduction(self, share: float) -> None:
        """Share of the triangles to drop, 0 to 1; 0: as many as MaximumError allows."""
        self._set("_target_reduction", min(max(float(share), 0.0), 1.0))

    def GetTargetReduction(self) -> float:
        """As set."""
        return self._target_reduction

    def _set(self, name: str, value: Any) -> None:
        if getattr(self, name) != value:
            setattr(self, name, value)
            self.Modified()

    def _aims(self) -> Tuple[Optional[float], Optional[float]]:
        return self._maximum_error or None, self._target_reduction or None

    def _run(self, work: Callable[[], None]) -> int:
        """\\return VTK's verdict"""
        # from VTK 9.3 on filters tell those downstream that they were aborted
        if getattr(self, "GetAbortOutput", bool)():
            return 1
        try:
            work()
        except _Aborted:
            getattr(self, "SetAbortOutput", bool)(True)
        except Error as error:
            text = f"{type(self).__name__}: {error}"
            if self.HasObserver("ErrorEvent"):
                self.InvokeEvent("ErrorEvent", text)
            else:
                vtkOutputWindow.GetInstance().DisplayErrorText(f"ERROR: {text}\n")
            return 0
        return 1

    def _progress(self, part: int = 0, parts: int = 1) -> Callable[[str, float], None]:
        def tell(stage: str, fraction: float) -> None:
            self.SetProgressText(stage)
            # a stage after the first starts at 0 again; progress never goes back
            self.UpdateProgress(max(self.GetProgress(), (part + fraction) / parts))
            if self.GetAbortExecute():
                raise _Aborted
        return tell


class Isosurface(_Filter):
    """Adaptive isosurfaces of a vtkImageData, in place of vtkFlyingEdges3D + vtkQuadricDecimation.

    MaximumError 0 is 0.15 of the least distance between planes of samples, or no bound where
    TargetReduction is above 0.
    """

    def __init__(self) -> None:
        super().__init__("vtkImageData")
        self._values = [0.0]
        self._computes_normals = self._computes_scalars = True
        self._frame = 0

    def SetValue(self, i: int, value: float) -> None:
        """The i-th isovalue; inside is where scalars are >= it."""
        values = self._values + [0.0] * (i + 1 - len(self._values))
        values[i] = float(value)
        self._set("_values", values)

    def GetValue(self, i: int) -> float:
        """The i-th isovalue."""
        return self._values[i]

    def SetNumberOfContours(self, count: int) -> None:
        """Keeps the first isovalues; new ones are 0."""
        self._set("_values", (self._values + [0.0] * count)[:count])

    def GetNumberOfContours(self) -> int:
        """The number of isovalues."""
        return len(self._values)

    def GenerateValues(self, count: int, first: Any, last: Optional[float] = None) -> None:
        """`count` isovalues at equal distances from `first` to `last`, or of a range."""
        low, high = first if last is None else (first, last)
        self._set("_values", [float(value) for value in np.linspace(low, high, count)])

    def SetComputeNormals(self, computes: int) -> None:
        """Point normals from the image's gradient, towards lower scalars; on by default."""
        self._set("_computes_normals", bool(computes))

    def SetComputeScalars(self, computes: int) -> None:
        """Point scalars that hold the isovalue; on by default."""
        self._set("_computes_scalars", bool(computes))

    def SetCoordinateFrame(self, frame: int) -> None:
        """What the image's coordinates are: 0 as its field data say, 1 RAS mm, 2 LPS mm."""
        self._set("_frame", min(max(int(frame), 0), 2))

    def RequestUpdateExtent(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Asks for the image as a whole."""
        wanted = inputs[0].GetInformationObject(0)
        wanted.Set(Pipeline.UPDATE_EXTENT(), wanted.Get(Pipeline.WHOLE_EXTENT()), 6)
        return 1

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Makes the surfaces."""
        if outputs.GetInformationObject(0).Get(Pipeline.UPDATE_PIECE_NUMBER()) > 0:
            return 1  # the whole surface is piece 0
        return self._run(lambda: self._make(vtkImageData.GetData(inputs[0]),
                                            vtkPolyData.GetData(outputs)))

    def _make(self, image: Any, output: Any) -> None:
        scalars = self._scalars_of(image)
        frame = self._frame or _stated_frame(image)
        affine = _affine_of(image)
        if frame == 2:
            affine[:2] *= -1
        samples = samples_of(_array_of(image, scalars), affine)
        low, high = samples.volume.value_range()
        index = (_adaptiso.build_index(samples.volume, {}, 0)
                 if len(self._values) > 1 else None)
        meshes: List[Optional[Mesh]] = []
        with read_only(samples.user):
            for part, level in enumerate(self._values):
                error, reduction = self._aims()
                options = checked("surface", {"max_error": error, "reduction": reduction})
                progress = self._progress(part, len(self._values))
                is_missed = level <= low or level > high
                meshes.append(None if is_missed else
                              _surface._make(samples, index, level, options, 0, progress))
        made = [mesh for mesh in meshes if mesh is not None]
        turn = np.array([-1.0, -1.0, 1.0]) if frame == 2 else None
        fill(output, made, turn, self._computes_normals)
        if self._computes_scalars:
            values = numpy_to_vtk(np.concatenate([np.empty(0)] + [
                np.full(len(mesh.vertices), level) for mesh, level in zip(meshes, self._values)
                if mesh is not None]), deep=1)
            values.SetName(scalars.GetName())
            output.GetPointData().SetScalars(values)
        _add_bounds(output, [(mesh and mesh.error_bound) or 0.0 for mesh in meshes])
        if frame:
            name = "RAS" if frame == 1 else "LPS"
            _add_text(output, "CoordinateFrame", f"{name} mm")
            _add_text(output, "SPACE", name)

    def _scalars_of(self, image: Any) -> Any:
        """\\raises Error"""
        data = image.GetPointData()
        chosen = self.GetInputArrayInformation(0)
        scalars = (data.GetArray(chosen.Get(vtkDataObject.FIELD_NAME()))
                   if chosen.Has(vtkDataObject.FIELD_NAME()) else data.GetScalars())
        if scalars is None:
            raise Error("the image has no point scalars")
        if scalars.GetNumberOfComponents() != 1:
            raise Error(f"the scalars have {scalars.GetNumberOfComponents()} components, must have "
                        "1 (vtkImageExtractComponents takes one)")
        if scalars.GetNumberOfTuples() != image.GetNumberOfPoints():
            raise Error("the scalars are not one a point of the image")
        if image.HasAnyBlankPoints() or image.HasAnyBlankCells():
            raise Error("the image has blanked points, which have no place in a closed surface")
        return scalars


class Simplify(_Filter):
    """Fewer triangles of a vtkPolyData, in place of vtkQuadricDecimation and vtkDecimatePro.

    MaximumError 0 is no bound; then TargetReduction must be above 0. Of the point data,
    floating-point values and colours are interpolated, all others taken from the nearest corner.
    """

    def __init__(self) -> None:
        super().__init__("vtkPolyData")
        self._keeps_borders = False

    def SetKeepBorders(self, keeps: int) -> None:
        """Vertices on open borders stay, bit by bit; off by default."""
        self._set("_keeps_borders", bool(keeps))

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Makes the surface."""
        return self._run(lambda: self._make(vtkPolyData.GetData(inputs[0]),
                                            vtkPolyData.GetData(outputs)))

    def _make(self, given: Any, output: Any) -> None:
        if given.GetNumberOfPolys() == 0 and given.GetNumberOfStrips() == 0:
            return
        mesh = _mesh_of(given)
        error, reduction = self._aims()
        made = simplify(mesh, max_error=error, reduction=reduction,
                        keep_borders=self._keeps_borders, progress=self._progress())
        fill(output, [made], None, True)
        _carry_point_data(given.GetPointData(), mesh, made, output.GetPointData())
        _add_bounds(output, [made.error_bound or 0.0])


def _affine_of(image: Any) -> Any:
    """The matrix of indices, from 0, to the image's coordinates."""
    affine = np.eye(4)
    direction, spacing = image.GetDirectionMatrix(), image.GetSpacing()
    for axis in range(3):
        for row in range(3):
            affine[row, axis] = direction.GetElement(row, axis) * spacing[axis]
    image.TransformIndexToPhysicalPoint(image.GetExtent()[::2], corner := [0.0, 0.0, 0.0])
    affine[:3, 3] = corner
    return affine


def _array_of(image: Any, scalars: Any) -> Any:
    """The samples, in place. \\raises Error"""
    try:
        return vtk_to_numpy(scalars).reshape(image.GetDimensions(), order="F")
    except Exception as error:
        raise Error(f"the scalars can't be used: {error}") from None


def _stated_frame(image: Any) -> int:
    """The frame that an image's field data name, as SetCoordinateFrame takes it."""
    for name in ("CoordinateFrame", "SPACE"):
        array = image.GetFieldData().GetAbstractArray(name)
        if isinstance(array, vtkStringArray) and array.GetNumberOfValues() == 1:
            text = array.GetValue(0)[:3]
            if text in ("RAS", "LPS"):
                return ("RAS", "LPS").index(text) + 1
    return 0


def _add_text(output: Any, name: str, text: str) -> None:
    array = vtkStringArray()
    array.SetName(name)
    array.InsertNextValue(text)
    output.GetFieldData().AddArray(array)


def _add_bounds(output: Any, bounds: List[float]) -> None:
    array = numpy_to_vtk(np.array(bounds, float), deep=1)
    array.SetName("ErrorBound")
    output.GetFieldData().AddArray(array)


def _mesh_of(data: Any) -> Mesh:
    """\\raises Error"""
    normals = data.GetPointData().GetNormals()
    return Mesh(*arrays_of(data), None if normals is None else vtk_to_numpy(normals))


def _carry_point_data(given: Any, mesh: Mesh, made: Mesh, output: Any) -> None:
    corners, weights, nearest = _adaptiso.point_transfer(made._data, mesh._data)
    for n in range(given.GetNumberOfArrays()):
        values, attribute = given.GetAbstractArray(n), given.IsArrayAnAttribute(n)
        if attribute == vtkDataSetAttributes.NORMALS:  # simplify() has them
            output.GetNormals().SetName(values.GetName())
            continue
        place = output.AddArray(_carried(values, corners, weights, nearest))
        if attribute >= 0:
            output.SetActiveAttribute(place, attribute)


def _carried(values: Any, corners: Any, weights: Any, nearest: Any) -> Any:
    carried = values.NewInstance()
    carried.SetName(values.GetName())
    carried.SetNumberOfComponents(values.GetNumberOfComponents())
    carried.CopyComponentNames(values)
    carried.SetNumberOfTuples(len(corners))
    kind = values.GetDataType()
    is_color = kind == VTK_UNSIGNED_CHAR and values.GetNumberOfComponents() in (3, 4)
    if kind not in (VTK_DOUBLE, VTK_FLOAT) and not is_color:
        for point, corner in enumerate(nearest):
            carried.SetTuple(point, corner, values)
        return carried
    numbers = vtk_to_numpy(values).reshape(values.GetNumberOfTuples(), -1).astype(np.float64)
    # a corner without weight may hold NaN
    mixed = sum(np.where(weights[:, c, None] == 0, 0, weights[:, c, None] * numbers[corners[:, c]])
                for c in range(3))
    vtk_to_numpy(carried).reshape(len(corners), -1)[:] = np.rint(mixed) if is_color else mixed
    return carried
