"""Isosurfaces of images."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple, Union

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, Warned, aim, flag, number, progress as checked_progress, shown,
                         smallest_angle, threads as checked_threads, word)
from ._images import Samples, keep_read_only, prepared, read_only, samples_of
from ._mesh import Mesh, logger

METHODS = ("adaptive", "boxes", "dmc", "asc", "mc")
BORDERS = ("closed", "open")


def surface(image: Any, level: Union[float, str], *, max_error: Optional[float] = None,
            triangles: Optional[int] = None, reduction: Optional[float] = None,
            min_angle: Optional[float] = None, method: str = "adaptive", affine: Any = None,
            border: str = "closed", largest: bool = False, min_volume: float = 0,
            fill_cavities: bool = False, threads: int = 0,
            progress: Optional[Progress] = None) -> Mesh:
    """Make the isosurface of an image: a closed, oriented mesh with few triangles where it is flat.

    The same samples, affine and options give the bytes that the program adaptiso-mesh gives, for
    any number of threads.

    Parameters
    ----------
    image : ndarray of shape (I, J, K), nibabel, SimpleITK or ITK image, or path
        Samples of any real type, in C or Fortran order, not copied: read-only arrays will do, and
        others are read-only meanwhile. Only arrays with gaps (image[::2]), in a foreign byte order
        or of float16 are copied. NaN counts as outside. A C-ordered array is read with its axes
        the other way round: the surface lies within the same bound, cut into other triangles than
        that of ``numpy.asfortranarray(image)``.
    level : float or "auto"
        The isovalue; inside is where samples are >= level. "auto": chosen by Otsu's method.
    max_error : float, optional
        Largest distance in mm, both ways, to the surface of marching cubes. Default: 0.15 of the
        least distance between planes of voxels, unless `triangles` or `reduction` is given; that
        leaves noise at full resolution, with a warning.
    triangles : int, optional
        Simplify to so many triangles, as close to that surface as the method gets; of the pieces
        that are kept.
    reduction : float, optional
        Share of marching cubes' triangles to drop, 0 to 1.
    min_angle : float, optional
        Make no angle below this, 0 to 40 degrees, except those that are there, at the price of more
        triangles.
    method : {"adaptive", "boxes", "dmc", "asc", "mc"}
        "mc" is marching cubes at full resolution. The four options above are for "adaptive".
    affine : array_like of shape (4, 4), optional
        Takes voxel indices to scanner RAS mm, as nibabel's; may mirror and shear. Default: the
        image's own; of an array the identity, so that vertices are voxel indices.
    border : {"closed", "open"}
        Where the surface meets the border of the image.
    largest : bool
        Keep the piece with the most material only.
    min_volume : float
        Drop pieces, and fill cavities, with less than so many mm3.
    fill_cavities : bool
        Drop inner surfaces, and all that lies inside them.
    threads : int
        0: as many as the machine has.
    progress : callable, optional
        Called as ``progress(stage, fraction)`` now and then; what it raises ends the call.

    Returns
    -------
    Mesh
        In scanner RAS mm (of an array without affine: voxels), triangles counter-clockwise seen
        from outside, also where the affine mirrors.

    Raises
    ------
    Error
        An image, a level or an option that can't be used.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> i, j, k = np.indices((32, 32, 32))
    >>> distance = np.sqrt((i - 15.5) ** 2 + (j - 15.5) ** 2 + (k - 15.5) ** 2)
    >>> mesh = adaptiso.surface(-distance, -10, max_error=0.1)
    >>> mesh.vertices.shape[1], mesh.error_bound <= 0.1, mesh.is_closed
    (3, True, True)
    >>> round(float(np.linalg.norm(mesh.vertices - 15.5, axis=1).mean()), 1)
    10.0
    """
    border = word("border", border, BORDERS)
    options = _options(level, max_error, triangles, reduction, min_angle, method, largest,
                       min_volume, fill_cavities, threads, progress)
    samples = samples_of(image, affine)
    with read_only(samples.user):
        return _make(samples, None, border, options)


class Index:
    """An index over an image's blocks, for surfaces at many levels: built once, it finds what a
    level touches without a walk through the image.

    Parameters
    ----------
    image, affine, border, threads
        As for `surface`. An array stays read-only as long as the index lives.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> index = adaptiso.Index(np.indices((9, 9, 9)).sum(axis=0))
    >>> [len(index.surface(level).faces) > 0 for level in (8, 12.5)]
    [True, True]
    """

    def __init__(self, image: Any, *, affine: Any = None, border: str = "closed",
                 threads: int = 0) -> None:
        border = word("border", border, BORDERS)
        self._build(samples_of(image, affine), border, checked_threads(threads))

    def _build(self, samples: Samples, border: str, threads: int) -> None:
        keep_read_only(samples.user, self)
        self._samples = samples
        self._index = _adaptiso.build_index(samples.volume, border, threads)
        self._border = border

    def surface(self, level: Union[float, str], *, max_error: Optional[float] = None,
                triangles: Optional[int] = None, reduction: Optional[float] = None,
                min_angle: Optional[float] = None, method: str = "adaptive",
                largest: bool = False, min_volume: float = 0, fill_cavities: bool = False,
                threads: int = 0, progress: Optional[Progress] = None) -> Mesh:
        """The surface at a level: as `adaptiso.surface` makes it."""
        options = _options(level, max_error, triangles, reduction, min_angle, method, largest,
                           min_volume, fill_cavities, threads, progress)
        return _make(self._samples, self._index, self._border, options)

    @property
    def range(self) -> "tuple[float, float]":
        """Smallest and largest sample; levels lie above the first and up to the second."""
        return self._samples.volume.value_range()

    def __reduce__(self) -> Tuple[Any, ...]:
        # the index itself is built again, which takes less time than to send it
        samples = self._samples
        return (_unpickled, (samples.user, samples.affine, samples.file, samples.format,
                             samples.warnings if samples.file else [], self._border))

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self._samples.user.shape))
        return (f"<adaptiso.Index of {shape} voxels, {self._samples.user.dtype}, "
                f"{self._index.blocks} blocks, border {self._border}>")


def _unpickled(array: Any, affine: Any, file: str, kind: str, warnings: List[Warned],
               border: str) -> Index:
    index = Index.__new__(Index)
    index._build(prepared(array, affine, file, kind, warnings), border, 0)
    return index


def _options(level: Any, max_error: Any, triangles: Any, reduction: Any, min_angle: Any,
             method: Any, largest: Any, min_volume: Any, fill_cavities: Any, threads: Any,
             progress: Any) -> Dict[str, Any]:
    """Arguments for C++. \\raises Error"""
    if isinstance(level, str) and level != "auto":
        raise Error(f"level {shown(level)}: must be a number or 'auto'")
    return {
        "level": None if isinstance(level, str) else number("level", level, "a number or 'auto'"),
        **aim(max_error, triangles, reduction),
        "min_angle": smallest_angle(min_angle),
        "method": word("method", method, METHODS),
        "largest": flag("largest", largest),
        "min_volume": number("min_volume", min_volume, "a number from 0, in mm3",
                             lambda value: value >= 0),
        "fill_cavities": flag("fill_cavities", fill_cavities),
        "threads": checked_threads(threads),
        "progress": checked_progress(progress),
    }


def _make(samples: Samples, index: Optional[_adaptiso.ArrayIndex], border: str,
          options: Dict[str, Any]) -> Mesh:
    data = _adaptiso.make_surface(samples.volume, index, border, file=samples.file,
                                  format=samples.format, warnings=samples.warnings, **options)
    for warning in data.surface_warnings:
        logger.warning("surface: %s", warning.of(samples.file))
    return Mesh._of(data)
