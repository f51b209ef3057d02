"""Meshes with fewer triangles."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, aim, flag, progress as checked_progress, shown, smallest_angle,
                         threads as checked_threads)
from ._mesh import Mesh, mesh_data_of, stated_frames


def simplify(mesh: Any, faces: Any = None, *, max_error: Optional[float] = None,
             triangles: Optional[int] = None, reduction: Optional[float] = None,
             min_angle: Optional[float] = None, keep_borders: bool = False,
             input_coordinates: Optional[str] = None, threads: int = 0,
             progress: Optional[Progress] = None) -> Mesh:
    """Give any triangle mesh fewer triangles, within a proved distance.

    A closed surface stays closed, of the same pieces and genus, and crosses itself nowhere. Open
    borders stay open. Where the mesh is no manifold or crosses itself it is kept as it is, and
    ``report`` says where. The same mesh and options give the same result, for any number of
    threads: that of the program adaptiso-simplify for a file with the same coordinates.

    Parameters
    ----------
    mesh : Mesh, (vertices, faces), path, object with vertices and faces, or vertices
        In any unit: `max_error` is in the same. Vertices have the shape (n, 3).
    faces : array_like of integers of shape (m, 3), optional
        Where `mesh` holds vertices alone.
    max_error : float, optional
        Largest distance, both ways, between the mesh and the result.
    triangles : int, optional
        Simplify to so many triangles, as close to the mesh as the method gets.
    reduction : float, optional
        Share of the triangles to drop, 0 to 1. One of these three must be given; with several,
        triangles are dropped until any of them ends it.
    min_angle : float, optional
        Make no angle below this, 0 to 40 degrees, except those that are there, at the price of more
        triangles.
    keep_borders : bool
        Vertices on open borders stay, bit by bit.
    input_coordinates : {"ras", "lps", "tkras", "voxel"}, optional
        The frame of a file's points, overriding the file's own.
    threads, progress
        As for `surface`.

    Returns
    -------
    Mesh
        In the frame of `mesh`. ``error_bound`` is proved against `mesh`. ``report`` has
        ``border_edges``, ``non_manifold_vertices``, ``crossing_triangles``,
        ``degenerate_triangles`` and ``duplicate_triangles`` of `mesh` (the last two were dropped),
        ``wanted_triangles``, and ``warnings``: lines with a ``code``, as
        Documentation/Warnings.md lists them.

    Raises
    ------
    Error
        A mesh without triangles, with indices out of range or coordinates that are not finite; an
        option that can't be used.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> i, j, k = np.indices((32, 32, 32))
    >>> ball = -np.sqrt((i - 15.5) ** 2 + (j - 15.5) ** 2 + (k - 15.5) ** 2)
    >>> fine = adaptiso.surface(ball, -12, method="mc")
    >>> coarse = adaptiso.simplify(fine.vertices, fine.faces, max_error=0.2)
    >>> len(coarse.faces) < len(fine.faces) / 10, coarse.is_closed, coarse.error_bound <= 0.2
    (True, True, True)
    """
    if faces is not None and np.ndim(faces) == 0:
        raise Error(f"faces {shown(faces)}: must be a table of integers"
                    + (f"; max_error={faces}?" if isinstance(faces, (int, float)) else ""))
    if max_error is None and triangles is None and reduction is None:
        raise Error("simplify: one of max_error, triangles and reduction must be given")
    given = mesh if faces is None else (mesh, faces)
    data = mesh_data_of(given, False, *stated_frames(input_coordinates, [given]))
    made, found = _adaptiso.simplify_mesh(
        data, **aim(max_error, triangles, reduction, unit=""), min_angle=smallest_angle(min_angle),
        keep_borders=flag("keep_borders", keep_borders), threads=checked_threads(threads),
        progress=checked_progress(progress))
    return Mesh._of(made, found)
