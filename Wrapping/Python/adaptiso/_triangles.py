"""Shared by meshes and the walls of label maps: views of C++'s memory, and files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Generic, Optional, TypeVar, Union

import numpy as np
import numpy.typing as npt

from . import _adaptiso
from ._arguments import Warned, warn, word

Vertices = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]

FRAMES = ("ras", "lps", "tkras", "voxel")

Data = TypeVar("Data", bound=Union[_adaptiso.MeshData, _adaptiso.LabelData])


#: What PyVista's and trimesh's users type first; texts that begin with a method of the object's class
#: are left out where the class has none.
_MEANT = {"export": "save(path)", "write": "save(path)", "show": "plot()", "decimate": "simplify()",
          "decimate_pro": "simplify()", "simplify_quadric_decimation": "simplify()",
          "n_points": "len(mesh.vertices)", "n_vertices": "len(mesh.vertices)",
          "n_cells": "len(mesh.faces)", "n_faces": "len(mesh.faces)", "triangles": "faces",
          "point_normals": "normals", "vertex_normals": "normals", "apply_transform": "transform(matrix)",
          "is_manifold": "adaptiso.check(mesh)", "fill_holes": "adaptiso.mend(mesh)",
          "area_faces": "to_trimesh()", "face_normals": "to_trimesh()", "centroid": "to_trimesh()"}


class Triangles(Generic[Data]):
    """Triangles that C++ owns."""

    __slots__ = ("_data", "__weakref__")

    _data: Data

    @property
    def vertices(self) -> Vertices:
        """float64, shape (n, 3), mm: a read-only view of the object's own memory."""
        return self._data.vertices

    @property
    def faces(self) -> Faces:
        """int64, shape (m, 3), rows of `vertices`: a read-only view of the object's own memory."""
        return self._data.faces

    if not TYPE_CHECKING:
        def __getattr__(self, name: str) -> object:
            meant = _MEANT.get(name, "")
            is_there = "mesh" in meant or hasattr(type(self), meant.partition("(")[0])
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'"
                                 + (f"; did you mean {meant}?" if is_there else ""))

    @property
    def points(self) -> Vertices:
        """`vertices`, by PyVista's name."""
        return self._data.vertices

    @property
    def bounds(self) -> Vertices:
        """float64, shape (2, 3): the least and the largest coordinates of `vertices`, in their unit
        and frame, as trimesh has them (PyVista: ``mesh.bounds.T.ravel()``). NaN without vertices."""
        points = self._data.vertices
        if len(points) == 0:
            return np.full((2, 3), np.nan)
        return np.array([points.min(axis=0), points.max(axis=0)])

    def _save(self, name: str, frame: Optional[str]) -> None:
        """\\raises Error"""
        if frame is not None:
            word("frame", frame, FRAMES)
        warning = self._data.write(name, frame)
        if warning:
            warn([Warned(warning)], file=os.path.basename(name))
