"""Shared by meshes and the walls of label maps: views of C++'s memory, and files."""

from __future__ import annotations

import contextlib
import logging
import os
import uuid
from typing import Callable, Generic, Optional, TypeVar, Union

import numpy as np
import numpy.typing as npt

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import word

Vertices = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]

FRAMES = ("ras", "lps", "tkras", "voxel")

logger = logging.getLogger("adaptiso")

Result = TypeVar("Result")
Data = TypeVar("Data", bound=Union[_adaptiso.MeshData, _adaptiso.LabelData])


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

    def _save(self, name: str, frame: Optional[str]) -> None:
        """\\raises Error"""
        if frame is not None:
            word("frame", frame, FRAMES)
        warning = save_whole(name, lambda temporary: self._data.write(temporary, frame))
        if warning:
            logger.warning("%s: %s", os.path.basename(name), warning)


def save_whole(path: str, write: Callable[[str], Result]) -> Result:
    """Writes a file by `write` under a temporary name beside it, and renames it; returns what
    `write` returns. \\raises Error"""
    if os.path.basename(path) in ("", ".", ".."):
        raise Error(f"{path}: is a folder's name; give a file's")
    name = os.path.realpath(path)
    if os.path.exists(name) and not os.path.isfile(name):
        raise Error(f"{name}: is no regular file; give another name")
    folder, file = os.path.split(name)
    stem, extension = os.path.splitext(file)
    temporary = os.path.join(folder, f".{stem[:80]}-{uuid.uuid4().hex}{extension}")
    try:
        result = write(temporary)
        os.replace(temporary, name)
        return result
    except BaseException as error:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        if isinstance(error, Error):
            raise Error(str(error).replace(temporary, name)) from None
        if isinstance(error, OSError):
            raise Error(f"{name}: can't be written: {error.strerror}") from None
        raise
