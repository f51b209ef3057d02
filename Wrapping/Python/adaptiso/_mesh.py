"""Triangle meshes: arrays that C++ owns, files, and other packages' meshes."""

from __future__ import annotations

import json
import os
import sys
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, is_path, path as checked_path, progress as checked_progress, shown,
                         threads as checked_threads, warn, word)
from ._images import affine_of, base_name, read
from ._options import checked, takes
from ._triangles import Faces, Triangles, Vertices

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import SimplifyOptions


#: The frame of what was made of an array without an affine, in words.
IN_VOXELS = "voxel indices (identity affine)"


def is_identity(affine: Any) -> bool:
    """The affine is there, and points in RAS mm are voxel indices."""
    return affine is not None and np.array_equal(affine, np.eye(4))


class Mesh(Triangles[_adaptiso.MeshData]):
    """A triangle surface in scanner RAS millimetres (of an array without affine: in voxel indices).

    Returned by `surface`, `Index.surface` and `load`, and made of arrays by ``Mesh(vertices,
    faces)``. Nothing of it changes, so threads may share it, and copies are not needed.

    Parameters
    ----------
    vertices : array_like of shape (n, 3)
        mm; copied.
    faces : array_like of integers of shape (m, 3)
        Rows of `vertices`, counter-clockwise seen from outside; copied.
    normals : array_like of shape (n, 3), optional
        Unit vectors that point outside.

    Attributes
    ----------
    frame : str
        "ras" (voxel indices of an array without affine); "tkras" for a FreeSurfer surface
        whose volume is not known; "unknown" where a file does not say its frame.

    Raises
    ------
    Error
        Shapes that don't fit, vertices that are not finite, faces that name none.

    Examples
    --------
    >>> import adaptiso
    >>> mesh = adaptiso.Mesh([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]],
    ...                      [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> mesh
    <adaptiso.Mesh of 4 triangles, 4 vertices, RAS mm>
    >>> mesh.volume
    121.5
    """

    __slots__ = ("_normals", "_report")

    def __init__(self, vertices: Any, faces: Any, normals: Any = None) -> None:
        self._data = _adaptiso.MeshData.from_arrays(
            _table("vertices", vertices, np.float64), _table("faces", faces, np.int64),
            None if normals is None else _table("normals", normals, np.float32))
        self._normals: Optional[Vertices] = None
        self._report: Optional[Dict[str, Any]] = None

    @classmethod
    def _of(cls, data: _adaptiso.MeshData, report: Optional[Dict[str, Any]] = None) -> "Mesh":
        mesh = cls.__new__(cls)
        mesh._data = data
        mesh._normals = None
        mesh._report = report
        if report is not None:
            data.report = json.dumps(report)
        return mesh

    @classmethod
    def from_vtk(cls, data: Any) -> "Mesh":
        """The mesh of a vtkPolyData, or PyVista's, of triangles in RAS mm, with its normals at points;
        copied.

        Raises
        ------
        Error
            Other data, polygons, strips, and as of ``Mesh(vertices, faces)``.
        """
        if not hasattr(data, "GetPolys"):
            raise Error(f"data {shown(data)}: must be a vtkPolyData")
        from ._vtk_data import arrays_of, normals_of
        return cls(*arrays_of(data), normals_of(data))

    @property
    def normals(self) -> Vertices:
        """float64, shape (n, 3), unit vectors that point outside; shape (0, 3) where the mesh has
        none. Read-only; kept in single precision and converted the first time."""
        if self._normals is None:
            normals = self._data.normals.astype(np.float64)
            normals.flags.writeable = False
            self._normals = normals.view()  # which can't be made writable again
        return self._normals

    @property
    def error_bound(self) -> Optional[float]:
        """Proved: no point of the mesh lies farther (mm) from the surface of marching cubes (of
        `simplify`: from the mesh that it was given), nor that surface from the mesh. None of meshes
        that neither the method "adaptive" nor `simplify` has made."""
        return self._data.error_bound

    @property
    def report(self) -> Dict[str, Any]:
        """How the mesh was made, and that it is sound: the report adaptiso-mesh/1, as
        ``adaptiso-mesh --json`` writes it (of `surface`, with ``--search linear``). Of `simplify`:
        what was found of the mesh that it was given. Empty of other meshes."""
        if self._report is None:
            text = self._data.report
            self._report = json.loads(text) if text else {}
        return self._report

    @property
    def frame(self) -> str:
        """The frame of `vertices`."""
        return self._data.frame

    @property
    def area(self) -> float:
        """mm2."""
        return self._data.area

    @property
    def volume(self) -> float:
        """mm3 that a closed mesh encloses; below 0 where it is inside out."""
        return self._data.volume

    @property
    def is_closed(self) -> bool:
        """Every edge belongs to two triangles or more."""
        edges = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        return len(edges) == 0 or bool(np.unique(edges, axis=0, return_counts=True)[1].min() > 1)

    @property
    def is_watertight(self) -> bool:
        """Closed, manifold and oriented, as `check` finds; that also looks for triangles that cross."""
        return self._data.is_watertight

    @takes("simplify")
    def simplify(self, *, threads: int = 0, progress: Optional[Progress] = None,
                 **options: Unpack[SimplifyOptions]) -> "Mesh":
        """The mesh with fewer triangles, as `adaptiso.simplify` makes it.

        Parameters
        ----------
        **options
        threads, progress
            As for `surface`.
        """
        if all(options.get(aim) is None for aim in ("max_error", "triangles", "reduction")):
            raise Error("simplify: one of max_error, triangles and reduction must be given")
        made, found = _adaptiso.simplify_mesh(self._data, checked("simplify", options),
                                              checked_threads(threads), checked_progress(progress))
        warn(found["warnings"], "simplify")
        return Mesh._of(made, found)

    def transform(self, matrix: Any) -> "Mesh":
        """The mesh moved: of a mirroring `matrix` too the triangles are counter-clockwise seen from
        outside, and normals point outside.

        ``error_bound`` is of the surface moved alike. The mesh no longer knows its image, nor has it a
        ``report``; ``frame`` stays. `save` keeps a surface that was made here sound in single precision, or
        refuses.

        Parameters
        ----------
        matrix : array_like of shape (4, 4)
            Takes points (x, y, z, 1) of the mesh to new ones; the last row is 0, 0, 0, 1.
        """
        affine = affine_of(matrix, "matrix", "points to points")
        data = self._data.moved(affine)
        if self.error_bound is not None:
            data.error_bound = self.error_bound * float(np.linalg.norm(affine[:3, :3], 2))
        return Mesh._of(data)

    def plot(self, file: Any = None, **options: Any) -> None:
        """Show the mesh in a window, by PyVista where it is installed, else by VTK; or draw it.

        Parameters
        ----------
        file : str or path, optional
            A PNG file to draw the mesh into, seen from the front, in place of a window. Needs no
            display and no other package.
        **options
            Of pyvista.PolyData.plot (``color="w"``, ``show_edges=True``), which they need.

        Raises
        ------
        Error
            No triangles, no display, or neither PyVista nor VTK.
        """
        if len(self.faces) == 0:
            raise Error("plot: the mesh has no triangles")
        if file is not None:
            name = checked_path("file", file)
            if options or not name.lower().endswith(".png"):
                raise Error(f"plot: file={shown(name)}: is drawn as .png, without other options")
            self._data.draw(name)
            return
        try:
            picture = self.to_pyvista()
        except ImportError:
            picture = None
        is_headless = sys.platform == "linux" and not os.environ.get("DISPLAY")
        no_display = Error("plot: there is no display; plot(file=\"mesh.png\") needs none")
        if picture is not None:
            is_off_screen = (options.get("off_screen") or options.get("notebook") or options.get("jupyter_backend")
                             or getattr(sys.modules.get("pyvista"), "OFF_SCREEN", False))
            if is_headless and not is_off_screen:
                raise no_display
            picture.plot(**options)
            return
        if options:
            raise Error(f"plot: {next(iter(options))}= needs PyVista (pip install pyvista)")
        try:
            from ._vtk_data import show
        except ImportError:
            raise Error("plot: needs PyVista (pip install pyvista) or VTK (Debian: python3-vtk9); "
                        "plot(file=\"mesh.png\") needs neither") from None
        if is_headless:  # VTK would end the process
            raise no_display
        show(self.to_vtk())

    def save(self, path: Any, frame: Optional[str] = None) -> None:
        """Write the mesh in a format of adaptiso-mesh.

        The file is whole or not there, and the same as the program adaptiso-mesh writes. Where the
        format's digits take it noticeably beyond the bound that was asked for, the logger
        "adaptiso" states the file's.

        Parameters
        ----------
        path : str or path
            The extension chooses the format; the message about an unknown one lists all.
        frame : {"ras", "lps", "tkras", "voxel"}, optional
            Of the points written. Default: "tkras" for FreeSurfer's formats, else "ras" (of an array
            without affine: voxel indices, as if they were mm). A mesh of unknown frame is written as it
            is, and its file says no frame.

        Raises
        ------
        Error
            An unknown extension, a frame that the format can't hold or that needs an image that
            the mesh does not know, a mesh of unknown frame with `frame` or in FreeSurfer's formats,
            a format that keeps too few digits of the coordinates for a
            surface made here to stay sound or within its bound, a file that can't be written.
        """
        self._save(checked_path("path", path), frame)

    def to_vtk(self) -> Any:
        """The mesh as a vtkPolyData, in RAS mm; shares the vertices' memory.

        Needs Debian's python3-vtk9, or VTK from elsewhere."""
        from vtkmodules.vtkCommonDataModel import vtkPolyData

        from ._vtk_data import fill
        data = vtkPolyData()
        fill(data, [self], None, True)
        return data

    def to_pyvista(self) -> Any:
        """The mesh as a pyvista.PolyData, in RAS mm. Needs PyVista."""
        import pyvista
        return pyvista.PolyData(self.to_vtk())

    def to_trimesh(self) -> Any:
        """The mesh as a trimesh.Trimesh, in RAS mm, vertices in the same order. Needs trimesh."""
        import trimesh
        normals = self.normals if len(self._data.normals) else None
        return trimesh.Trimesh(vertices=self.vertices, faces=self.faces, vertex_normals=normals,
                               process=False)

    def to_gifti(self) -> Any:
        """The mesh as nibabel's GiftiImage, single precision as GIFTI has it. Only of a mesh in
        "ras" it says that points are in scanner space.

        Needs nibabel."""
        from nibabel import gifti
        space = "NIFTI_XFORM_SCANNER_ANAT" if self._data.frame == "ras" else "NIFTI_XFORM_UNKNOWN"
        points = gifti.GiftiDataArray(
            self.vertices.astype(np.float32), intent="NIFTI_INTENT_POINTSET",
            datatype="NIFTI_TYPE_FLOAT32",
            coordsys=gifti.GiftiCoordSystem(space, space))
        triangles = gifti.GiftiDataArray(
            self.faces.astype(np.int32), intent="NIFTI_INTENT_TRIANGLE",
            datatype="NIFTI_TYPE_INT32")
        return gifti.GiftiImage(darrays=[points, triangles])

    def to_nibabel_freesurfer(self) -> Tuple[Vertices, npt.NDArray[np.int32], Dict[str, Any]]:
        """(coords, faces, volume_info) as nibabel.freesurfer.write_geometry takes and
        read_geometry gives them: tkRAS mm of the image, as FreeSurfer and MNE have surfaces.

        Raises
        ------
        Error
            The mesh does not know its image.
        """
        if self._data.frame_volume is None:
            raise Error("the mesh does not know its image, so there is no tkRAS")
        shape, affine = self._data.frame_volume
        data = self._data if self.frame == "tkras" else self._data.in_frame("tkras")
        step = np.linalg.norm(affine[:3, :3], axis=0)
        centre = affine[:3, :3] @ (np.array(shape) / 2) + affine[:3, 3]
        directions = affine[:3, :3] / step
        info = {"head": np.array([2, 0, 20]), "valid": "1  # volume info valid",
                "filename": "unknown", "volume": np.array(shape), "voxelsize": step,
                "xras": directions[:, 0], "yras": directions[:, 1], "zras": directions[:, 2],
                "cras": centre}
        return data.vertices.copy(), data.faces.astype(np.int32), info

    def __repr__(self) -> str:
        bound = self.error_bound
        is_in_voxels = self.frame == "ras" and is_identity(self._data.affine)
        frame = IN_VOXELS if is_in_voxels else {
            "ras": "RAS mm", "tkras": "tkRAS mm", "lps": "LPS mm", "unknown": "unknown frame"}[self.frame]
        unit = "" if is_in_voxels else " mm"
        within = "" if bound is None else f", within {bound:.4g}{unit}"
        return (f"<adaptiso.Mesh of {len(self.faces):,} triangles, {len(self.vertices):,} "
                f"vertices{within}, {frame}>")

    def _repr_html_(self) -> str:
        """The mesh in a viewer, for notebooks: needs no network, and 1.6 to 3 MB. A mesh of more
        than 40,000 triangles is shown coarser, which the line below it says. Where scripts are off
        (a notebook that is not trusted) there is a picture from six sides."""
        title = repr(self)[1:-1]
        if len(self.faces) == 0:
            return f"<p>{title}</p>"
        return self._data.notebook(title)

    def __eq__(self, other: object) -> bool:
        """The same vertices, faces and normals in the same frame."""
        if not isinstance(other, Mesh):
            return NotImplemented
        return (self.frame == other.frame and np.array_equal(self.faces, other.faces)
                and np.array_equal(self.vertices, other.vertices)
                and np.array_equal(self._data.normals, other._data.normals))

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> Tuple[Any, ...]:
        data = self._data
        normals = data.normals if len(data.normals) else None
        return _unpickled, (data.vertices, data.faces, normals, data.frame, data.shape, data.affine,
                            data.error_bound, data.report)

    def __copy__(self) -> "Mesh":
        return self

    def __deepcopy__(self, memo: Any) -> "Mesh":
        return self


def load(path: Any, *, volume: Any = None, input_coordinates: Optional[str] = None) -> Mesh:
    """Read a surface file, in any of the formats that `Mesh.save` writes.

    Points come in scanner RAS mm, by what the file says of its frame. A FreeSurfer surface without
    a footer stays in tkRAS (``mesh.frame == "tkras"``) unless `volume` is given. Points of a file
    that does not say its frame are as stored (``mesh.frame == "unknown"``), and the logger
    "adaptiso" says so.

    Parameters
    ----------
    path : str or path
    volume : path, nibabel image or Image, optional
        The image that tkRAS and voxel indices refer to.
    input_coordinates : {"ras", "lps", "tkras", "voxel"}, optional
        The frame of the file's points, overriding the file's own. Default: as the file says.

    Raises
    ------
    Error
        The file is missing, damaged, of an unknown format, in voxels without `volume`, or of
        unknown frame with it.
    """
    name = checked_path("path", path)
    shape, affine = (None, None) if volume is None else _geometry_of(volume)
    return Mesh._of(_read_file(name, shape, affine, False, _stated(input_coordinates)))


def _read_file(name: str, shape: Any, affine: Any, keeps_faults: bool,
               input_coordinates: Optional[str]) -> _adaptiso.MeshData:
    """\\raises Error"""
    try:
        data, warnings = _adaptiso.read_mesh(name, shape, affine, keeps_faults, input_coordinates)
    except Error as error:
        raise Error(str(error).replace("adaptiso-mesh makes", "adaptiso.surface makes")) from None
    warn(warnings, file=base_name(name))
    return data


def stated_frames(input_coordinates: Any, surfaces: Sequence[Any]) -> List[Optional[str]]:
    """A word for each surface: of one word for all, or a sequence of words. \\raises Error"""
    words = ([input_coordinates] * len(surfaces)
             if input_coordinates is None or isinstance(input_coordinates, str)
             else list(input_coordinates))
    if len(words) != len(surfaces):
        raise Error(f"input_coordinates {shown(input_coordinates)}: must be one word, or one for "
                    "each surface")
    return [_stated(each) for each in words]


def _stated(input_coordinates: Any) -> Optional[str]:
    if input_coordinates is None:
        return None
    return word("input_coordinates", input_coordinates, ("ras", "lps", "tkras", "voxel"))


def require_known_frames(frames: Sequence[str], names: Sequence[str]) -> None:
    """Frames are all known, or all unknown. \\raises Error"""
    unknown = [name for frame, name in zip(frames, names) if frame == "unknown"]
    if unknown and len(unknown) < len(frames):
        raise Error(f"{unknown[0]}: is of a file that does not say its coordinate frame; state it "
                    "by input_coordinates=")


def whole(mesh: Any, faces: Any, hint: str = "") -> Any:
    """A function's first two arguments as `mesh_data_of` takes them: vertices and faces, or one mesh.
    \\raises Error"""
    if faces is None:
        return mesh
    if np.isscalar(faces):
        raise Error(f"faces {shown(faces)}: must be a table of integers"
                    + (f"; {hint}={shown(faces)}?" if hint and not isinstance(faces, (str, bytes)) else ""))
    return mesh, faces


def mesh_data_of(value: Any, keeps_faults: bool, input_coordinates: Optional[str] = None,
                 name: str = "mesh") -> _adaptiso.MeshData:
    """A mesh, (vertices, faces), a file's name, VTK's or PyVista's data, or an object with vertices and
    faces (trimesh's)."""
    if input_coordinates is not None and not is_path(value):
        raise Error("input_coordinates: is for files; a mesh in memory has its frame")
    if isinstance(value, Mesh):
        return value._data
    if is_path(value):
        return _read_file(checked_path(name, value), None, None, keeps_faults, input_coordinates)
    if isinstance(value, (tuple, list)) and len(value) == 2:
        vertices, faces = value
    elif hasattr(value, "GetPolys"):
        from ._vtk_data import arrays_of
        vertices, faces = arrays_of(value)
    elif hasattr(value, "vertices") and hasattr(value, "faces"):
        vertices, faces = value.vertices, value.faces
    else:
        raise Error(f"{name} {shown(value)}: must be a Mesh, (vertices, faces), or a file's name")
    return _adaptiso.MeshData.from_arrays(_table("vertices", vertices, np.float64),
                                          _table("faces", faces, np.int64),
                                          keeps_faults=keeps_faults)


def _geometry_of(volume: Any) -> Tuple[Any, Any]:
    if is_path(volume):
        volume = read(volume)
    array = getattr(volume, "array", None)
    shape = getattr(volume, "shape", None) if array is None else array.shape
    if shape is None or not hasattr(volume, "affine") or len(shape) < 3:
        raise Error(f"volume {shown(volume)}: must be an image file, a nibabel image or "
                    "adaptiso.Image")
    return [int(n) for n in shape[:3]], affine_of(volume.affine)


def _table(name: str, value: Any, dtype: Any) -> Any:
    """Rows of three numbers. \\raises Error"""
    if isinstance(value, np.ma.MaskedArray):
        raise Error(f"{name}: is a masked array; fill it first, or take the rows that are not masked")
    try:
        table = np.asarray(value)
    except (TypeError, ValueError, OverflowError):
        raise Error(f"{name} {shown(value)}: must have the shape (n, 3)") from None
    if table.size == 0 and table.ndim < 2:
        table = np.empty((0, 3), dtype)
    if table.ndim != 2 or table.shape[1] != 3:
        raise Error(f"{name}: has the shape {table.shape}, must have (n, 3)")
    kinds = "iu" if dtype is np.int64 else "iuf"
    if table.dtype.kind not in kinds:
        kind = "whole numbers" if dtype is np.int64 else "numbers"
        raise Error(f"{name}: holds {table.dtype}, must hold {kind}")
    if dtype is np.int64 and table.dtype == np.uint64 and table.size and table.max() > 2**62:
        raise Error(f"{name}: holds numbers that are too large")
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(table, dtype)


def _unpickled(vertices: Any, faces: Any, normals: Any, frame: str, shape: Any, affine: Any,
               error_bound: Optional[float], report: str) -> Mesh:
    data = _adaptiso.MeshData.from_arrays(vertices, faces, normals, frame,
                                          None if shape is None else list(shape), affine)
    data.error_bound = error_bound
    data.report = report
    return Mesh._of(data)
