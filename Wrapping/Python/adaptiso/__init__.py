"""Adaptive, watertight isosurfaces from MRI and CT scans.

>>> import adaptiso
>>> mesh = adaptiso.surface("/usr/share/mricron/templates/ch2bet.nii.gz", 100, method="boxes")
>>> mesh.vertices.dtype, mesh.faces.dtype
(dtype('float64'), dtype('int64'))

Points are in scanner RAS millimetres. Unusable input raises `adaptiso.Error`, a ValueError
whose message is one line. C++ works without the interpreter's lock, so threads run side by side;
Ctrl+C ends a call. Warnings go to the logger "adaptiso", which prints them to stderr unless logging
is configured; ``logging.getLogger("adaptiso").setLevel("ERROR")`` hides them.
"""

import atexit as _atexit
import os as _os
from typing import TYPE_CHECKING

from . import _adaptiso, giant
from ._adaptiso import Error, InternalError, __version__
from ._bem import HeadModel, NoModel, bem
from ._images import Image, read
from ._labels import LabelSurfaces, Region, labels
from ._marching_cubes import marching_cubes
from ._mend import mend
from ._mesh import Mesh, load
from ._quality import Check, Comparison, check, check_nested, compare
from ._simplify import simplify
from ._surface import Index, surface

__all__ = ["Check", "Comparison", "Error", "HeadModel", "Image", "Index", "InternalError",
           "LabelSurfaces", "Mesh", "NoModel", "Region", "bem", "check", "check_nested", "compare",
           "giant", "labels", "load", "marching_cubes", "mend", "read", "simplify", "surface", "__version__"]

if not TYPE_CHECKING:
    def __getattr__(name: str) -> object:
        meant = {"mesh": "surface", "isosurface": "surface", "contour": "surface",
                 "decimate": "simplify", "repair": "mend", "load_mesh": "load"}.get(name)
        raise AttributeError(f"module 'adaptiso' has no attribute '{name}'"
                             + (f"; did you mean adaptiso.{meant}?" if meant else ""))

if hasattr(_os, "register_at_fork"):
    _os.register_at_fork(before=_adaptiso.before_fork,
                         after_in_parent=_adaptiso.after_fork_in_parent,
                         after_in_child=_adaptiso.after_fork_in_child)

# daemon threads, which Python does not wait for, must not work with what the process's end frees
_atexit.register(_adaptiso.end_calls_of_other_threads)

Error.__module__ = InternalError.__module__ = "adaptiso"
InternalError.__doc__ = "A promise of the library is broken: a bug of adaptiso, not of the input."
