"""Isosurfaces of images."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple, Union

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, Warned, number, progress as checked_progress, shown,
                         threads as checked_threads, warn)
from ._images import (Samples, keep_read_only, prepared, read_only, samples_of, stated_affine)
from ._mesh import Mesh
from ._options import checked, rows, takes

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import SurfaceOptions


#: Options of `surface` that an index was built with, or without.
_OF_IMAGES = ("border", "crop", "smooth", "resample", "interpolation")


@takes("surface")
def surface(image: Any, level: Union[float, str], *, affine: Any = None, spacing: Any = None,
            threads: int = 0, progress: Optional[Progress] = None,
            **options: Unpack[SurfaceOptions]) -> Mesh:
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
    **options
    affine : array_like of shape (4, 4), optional
        Takes voxel indices to scanner RAS mm, as nibabel's; may mirror and shear. Default: the
        image's own; of an array the identity, so that vertices are voxel indices.
    spacing : three floats, optional
        Of an array, in place of `affine`: mm between its voxels along i, j, k; the first lies at 0.
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
    given = checked("surface", options)
    # crop counts along the axes as they are given, and the program smooths along i first
    samples = samples_of(image, stated_affine(affine, spacing),
                         in_file_order=any(name in given for name in _OF_IMAGES[1:]))
    with read_only(samples.user):
        return _make(samples, None, level, given, threads, progress)


class Index:
    """An index over an image's blocks, for surfaces at many levels: built once, it finds what a
    level touches without a walk through the image.

    Parameters
    ----------
    image, affine, spacing, border, threads
        As for `surface`. An array stays read-only as long as the index lives.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> index = adaptiso.Index(np.indices((9, 9, 9)).sum(axis=0))
    >>> [len(index.surface(level).faces) > 0 for level in (8, 12.5)]
    [True, True]
    """

    def __init__(self, image: Any, *, affine: Any = None, spacing: Any = None,
                 border: str = "closed", threads: int = 0) -> None:
        options = checked("surface", {"border": border})
        self._build(samples_of(image, stated_affine(affine, spacing)), options,
                    checked_threads(threads))

    def _build(self, samples: Samples, options: Dict[str, Any], threads: int) -> None:
        keep_read_only(samples.user, self)
        self._samples = samples
        self._index = _adaptiso.build_index(samples.volume, options, threads)
        self._options = options

    @takes("surface", [name for name in rows("surface") if name not in _OF_IMAGES])
    def surface(self, level: Union[float, str], *, threads: int = 0,
                progress: Optional[Progress] = None, **options: Unpack[SurfaceOptions]) -> Mesh:
        """The surface at a level: as `adaptiso.surface` makes it."""
        return _make(self._samples, self._index, level, checked("surface", options), threads,
                     progress)

    @property
    def range(self) -> "tuple[float, float]":
        """Smallest and largest sample; levels lie above the first and up to the second."""
        return self._samples.volume.value_range()

    def __reduce__(self) -> Tuple[Any, ...]:
        # the index itself is built again, which takes less time than to send it
        samples = self._samples
        return (_unpickled, (samples.user, samples.affine, samples.file, samples.format,
                             samples.warnings if samples.file else [], self._options))

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self._samples.user.shape))
        return (f"<adaptiso.Index of {shape} voxels, {self._samples.user.dtype}, "
                f"{self._index.blocks} blocks, border {self._options['border']}>")


def _unpickled(array: Any, affine: Any, file: str, kind: str, warnings: List[Warned],
               options: Dict[str, Any]) -> Index:
    index = Index.__new__(Index)
    index._build(prepared(array, affine, file, kind, warnings), options, 0)
    return index


def _make(samples: Samples, index: Optional[_adaptiso.ArrayIndex], level: Any,
          options: Dict[str, Any], threads: Any, progress: Any) -> Mesh:
    if isinstance(level, str) and level != "auto":
        raise Error(f"level {shown(level)}: must be a number or 'auto'")
    isovalue = None if isinstance(level, str) else number("level", level, "a number or 'auto'")
    data = _adaptiso.make_surface(
        samples.volume, index, isovalue, options, checked_threads(threads),
        checked_progress(progress), file=samples.file, format=samples.format,
        warnings=samples.warnings)
    warn(data.surface_warnings, "surface", samples.file)
    return Mesh._of(data)
