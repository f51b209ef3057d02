"""scikit-image's marching_cubes, by adaptiso's method "mc"."""

from __future__ import annotations

import operator
from typing import Any, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import number, shown
from ._images import read_only, samples_of

Array = npt.NDArray[Any]
Triangles = Tuple[Array, Array, Array]


class NoSurface(Error, RuntimeError):
    """No surface lies at the level: a RuntimeError, as scikit-image raises."""


def marching_cubes(volume: Any, level: Optional[float] = None, *, spacing: Any = (1., 1., 1.),
                   gradient_direction: str = "descent", step_size: int = 1,
                   allow_degenerate: bool = True, method: str = "lewiner",
                   mask: Any = None) -> Any:
    """Marching cubes with the arguments and results of `skimage.measure.marching_cubes`.

    The surface is that of ``surface(volume, level, method="mc", border="open")``: manifold, with
    the faces of ambiguous cells decided alike from both sides, without degenerate triangles:
    vertices keep a thousandth of a step away from samples.

    Parameters
    ----------
    volume : ndarray of shape (M, N, P)
    level : float, optional
        Default: the middle of the smallest and the largest sample.
    spacing : three floats
        Voxel size along the axes.
    gradient_direction : {"descent", "ascent"}
        "descent": the object's samples are the larger ones, and faces are clockwise seen from
        outside, as scikit-image has it; "ascent" turns the faces.
    step_size : int
        Take every step_size-th sample along each axis.
    allow_degenerate : bool
        Makes no difference: there are no degenerate triangles.
    method : {"lewiner", "lorensen", "_lorensen"}
        Makes no difference but for the last, which returns vertices and faces alone.
    mask : ndarray of bool, shape (M, N, P), optional
        Cells whose last corner is False give no triangles.

    Returns
    -------
    verts : ndarray of float, shape (V, 3)
        Places along the array's axes, times spacing.
    faces : ndarray of int32, shape (F, 3)
    normals : ndarray of float32, shape (V, 3)
        Unit vectors from larger to smaller samples.
    values : ndarray of float32, shape (V,)
        The largest range of samples of the cells around each vertex.

    Raises
    ------
    Error
        Unusable input (a ValueError); NoSurface (a RuntimeError too) for a result without triangles.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> i, j, k = np.indices((9, 9, 9)) - 4.0
    >>> verts, faces, normals, values = adaptiso.marching_cubes(i**2 + j**2 + k**2, 9.0)
    >>> bool(np.abs(np.linalg.norm(verts - 4, axis=1) - 3).max() < 0.1)
    True
    """
    if method not in ("lewiner", "lorensen", "_lorensen"):
        raise Error("method should be one of 'lewiner', 'lorensen' or '_lorensen'.")
    if method == "_lorensen" and mask is not None:
        raise NotImplementedError("mask: is not for the method '_lorensen'")
    if gradient_direction not in ("descent", "ascent"):
        raise Error(f"gradient_direction {shown(gradient_direction)}: must be descent or ascent")
    samples, steps, step = _checked(volume, spacing, step_size)
    masked = _checked_mask(mask, volume)
    coarse = samples[::step, ::step, ::step]
    low, high = float(coarse.min()), float(coarse.max())
    isovalue = 0.5 * (low + high) if level is None else number("level", level)
    if not low <= isovalue <= high:
        raise Error("Surface level must be within volume data range.")

    vertices, faces, normals = _extracted(coarse, isovalue)
    if masked is not None:
        vertices, faces, normals = _where(masked, step, vertices, faces, normals)
    if len(faces) == 0:
        raise NoSurface("No surface found at the given iso value.")
    if gradient_direction == "descent":
        faces = np.fliplr(faces)
    places = (vertices * step).astype(np.float32)
    verts = places if np.array_equal(steps, (1, 1, 1)) else places * steps
    if method == "_lorensen":
        return verts, faces
    return verts, faces, normals, _values(coarse, vertices, masked, step)


def _checked(volume: Any, spacing: Any, step_size: Any) -> Tuple[Array, Array, int]:
    if not isinstance(volume, np.ndarray) or volume.ndim != 3:
        raise Error("Input volume should be a 3D numpy array.")
    if volume.dtype.kind not in "biuf":
        raise Error(f"volume: samples of type {volume.dtype} can't be used")
    if min(volume.shape) < 2:
        raise Error("Input array must be at least 2x2x2.")
    try:
        steps = np.array(spacing, dtype=np.float64)
    except (TypeError, ValueError):
        steps = np.empty(0)
    if steps.shape != (3,) or not np.isfinite(steps).all():
        raise Error("`spacing` must consist of three floats.")
    try:
        step = operator.index(step_size)
    except TypeError:
        raise Error(f"step_size {shown(step_size)}: must be a whole number") from None
    if step < 1:
        raise Error("step_size must be at least one.")
    if min((n - 1) // step for n in volume.shape) < 1:
        raise NoSurface("No surface found at the given iso value.")
    return volume, steps, step


def _checked_mask(mask: Any, volume: Array) -> Optional[Array]:
    if mask is None:
        return None
    array = np.asarray(mask)
    if array.shape != volume.shape:
        raise Error("volume and mask must have the same shape.")
    return array.astype(bool)


def _extracted(samples: Array, isovalue: float) -> Triangles:
    """Vertices (in steps along the axes), faces with the smaller samples outside, normals."""
    prepared = samples_of(samples, None)
    with read_only(prepared.user):
        try:
            mesh = _adaptiso.make_surface(prepared.volume, None, isovalue,
                                          {"border": "open", "method": "mc"}, 0, None, "", "", [])
        except _adaptiso.InternalError:
            raise
        except Error as error:
            raise NoSurface(f"No surface found at the given iso value. {error}") from None
    return mesh.vertices, mesh.faces.astype(np.int32), mesh.normals.copy()


def _where(mask: Array, step: int, vertices: Array, faces: Array, normals: Array) -> Triangles:
    """Keeps the part in cells whose last corner is in the mask."""
    cells = np.floor(vertices[faces].mean(axis=1)).astype(np.int64)
    kept = faces[_in_mask(mask, step, cells)]
    used, numbers = np.unique(kept, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3).astype(np.int32), normals[used]


def _in_mask(mask: Array, step: int, cells: Array) -> Array:
    i, j, k = np.minimum((cells + 1) * step, np.array(mask.shape) - 1).T
    kept: Array = mask[i, j, k]
    return kept


def _values(samples: Array, vertices: Array, mask: Optional[Array], step: int) -> Array:
    """For every vertex the largest range of samples in a cell of the mask that it belongs to."""
    last = np.array(samples.shape) - 2
    first = np.clip(np.ceil(vertices).astype(np.int64) - 1, 0, last)
    second = np.clip(np.floor(vertices).astype(np.int64), 0, last)
    corners = np.array(list(np.ndindex(2, 2, 2)))
    values = np.zeros(len(vertices), np.float32)
    for choice in corners:
        cell = np.where(choice == 0, first, second)
        around = cell[:, None, :] + corners[None]
        held = samples[around[..., 0], around[..., 1], around[..., 2]].astype(np.float32)
        ranges = held.max(axis=1) - held.min(axis=1)
        if mask is not None:
            ranges = np.where(_in_mask(mask, step, cell), ranges, 0)
        np.maximum(values, ranges, out=values)
    return values
