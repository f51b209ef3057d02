"""Solids made of any mesh."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any, Dict, Optional, Sequence, Union

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, number, progress as checked_progress,
                         threads as checked_threads, warn)
from ._mesh import Mesh, mesh_data_of, stated_frames, whole
from ._options import checked, takes
from ._quality import names_of, require_one_frame

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import MendOptions


@takes("mend")
def mend(mesh: Any, faces: Any = None, *, around: Any = None, gap: Optional[float] = None,
         input_coordinates: Union[str, Sequence[Optional[str]], None] = None, threads: int = 0, progress: Optional[Progress] = None,
         **options: Unpack[MendOptions]) -> Mesh:
    """Make a solid of any mesh: closed, 2-manifold, oriented, crossing itself nowhere.

    Holes, crossings, doubled walls, inner shells, flipped parts and triangles that share no
    vertices are mended around their places, within a proved distance. A sound mesh comes back as
    it is. The same mesh and options give the same result, for any number of threads: that of the
    program adaptiso-mend for a file with the same coordinates.

    Parameters
    ----------
    mesh : Mesh, (vertices, faces), path, vtkPolyData, object with vertices and faces, or vertices
        In any unit: `max_error` and `max_hole` are in the same. Vertices have the shape (n, 3).
    faces : array_like of integers of shape (m, 3), optional
        Where `mesh` holds vertices alone.
    around : like `mesh`, optional
        A closed surface in one piece, in the frame of `mesh`: the result is moved outward where it
        must, to lie around it.
    gap : float, optional
        Least distance to `around`.
    **options
    input_coordinates : {"ras", "lps", "tkras", "voxel"} or one for each file, optional
        The frame of a file's points, overriding the file's own.
    threads, progress
        As for `surface`.

    Returns
    -------
    Mesh
        In the frame of `mesh`. ``report`` has ``was_sound``; what was found: ``border_edges``,
        ``bad_edges``, ``bad_vertices``, ``crossing_triangles``, ``flipped_triangles``,
        ``degenerate_triangles``, ``duplicate_triangles``, ``merged_points``, ``broken_triangles``
        (0, as such meshes are refused here) and, by `ball`, ``handles``; ``kept_triangles`` and ``cut_triangles`` of `mesh`; lists of the places
        ``filled`` (holes closed), ``left_open``, ``inner`` (dropped: inside the solid), ``thin``
        (dropped: too thin for the bound), ``cut_handles`` and ``filled_handles``, each with
        ``middle``, ``span`` and ``area``; ``max_error``; and, by `around`, ``gap``,
        ``moved_vertices`` and ``largest_move``. No point of the result is farther than
        ``result_to_input`` from `mesh`, but for those of ``filled`` and the discs at handles; no
        point of `mesh` is farther than ``input_to_result`` from the result, but for ``inner`` and
        ``thin``. ``warnings`` are lines with a ``code``, as Documentation/Warnings.md lists them.

    Raises
    ------
    Error
        A mesh without a triangle that has an area, with indices out of range or coordinates that
        are not finite; one that encloses nothing, has a hole wider than `max_hole`, or can't be
        mended within `max_error`, or has a handle without a flat disc; one that can't be moved to lie
        around `around`; an option that can't be used.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> i, j, k = np.indices((32, 32, 32))
    >>> ball = -np.sqrt((i - 15.5) ** 2 + (j - 15.5) ** 2 + (k - 15.5) ** 2)
    >>> whole = adaptiso.surface(ball, -12, method="mc")
    >>> torn = (whole.vertices, whole.faces[1:])
    >>> mended = adaptiso.mend(torn)
    >>> mended.is_closed, mended.report["border_edges"], len(mended.report["filled"])
    (True, 3, 1)
    """
    surfaces = [whole(mesh, faces, "max_error")] + ([] if around is None else [around])
    stated = input_coordinates
    if isinstance(stated, str) and around is not None:
        stated = [stated, None]  # of the mesh alone
    data = [mesh_data_of(each, False, frame)
            for each, frame in zip(surfaces, stated_frames(stated, surfaces))]
    require_one_frame(data, surfaces, names_of(surfaces, None))
    if (around is None) != (gap is None):
        raise Error("around, gap: each needs the other")
    distance = 0 if gap is None else number("gap", gap, "a number above 0", lambda value: value > 0)
    made, text, warnings = _adaptiso.mend_mesh(
        data[0], checked("mend", options), None if around is None else data[1], distance,
        checked_threads(threads), checked_progress(progress))
    warn(warnings, "mend")
    return Mesh._of(made, {**json.loads(text, object_hook=_named), "warnings": warnings})


def _named(found: Dict[str, Any]) -> Dict[str, Any]:
    """Figures of adaptiso-mend's report by Python's names: "middleMm" is "middle"."""
    return {re.sub("([A-Z])", r"_\1", re.sub("Mm2?$", "", key)).lower(): tuple(value) if key == "middleMm" else value
            for key, value in found.items()}
