"""Meshes with fewer triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

from ._arguments import Progress
from ._mesh import Mesh, mesh_data_of, stated_frames, whole
from ._options import takes

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import SimplifyOptions


@takes("simplify")
def simplify(mesh: Any, faces: Any = None, *, input_coordinates: Optional[str] = None,
             threads: int = 0, progress: Optional[Progress] = None,
             **options: Unpack[SimplifyOptions]) -> Mesh:
    """Give any triangle mesh fewer triangles, within a proved distance.

    A closed surface stays closed, of the same pieces and genus, and crosses itself nowhere. Open
    borders stay open. Where the mesh is no manifold or crosses itself it is kept as it is, and
    ``report`` says where. The same mesh and options give the same result, for any number of
    threads: that of the program adaptiso-simplify for a file with the same coordinates.

    One of `max_error`, `triangles` and `reduction` must be given; with several, triangles are
    dropped until any of them ends it.

    Parameters
    ----------
    mesh : Mesh, (vertices, faces), path, vtkPolyData, object with vertices and faces, or vertices
        In any unit: `max_error` is in the same. Vertices have the shape (n, 3).
    faces : array_like of integers of shape (m, 3), optional
        Where `mesh` holds vertices alone.
    **options
    input_coordinates : {"ras", "lps", "tkras", "voxel"}, optional
        The frame of a file's points, overriding the file's own.
    threads, progress
        As for `surface`.

    Returns
    -------
    Mesh
        In the frame of `mesh`. ``error_bound`` is proved against `mesh`. ``report`` has
        ``border_edges``, ``non_manifold_vertices``, ``crossing_triangles``,
        ``undecided_triangles`` (near too many others to be tested with all),
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
    given = whole(mesh, faces, "max_error")
    data = mesh_data_of(given, False, stated_frames(input_coordinates, [given])[0])
    return Mesh._of(data).simplify(threads=threads, progress=progress, **options)
