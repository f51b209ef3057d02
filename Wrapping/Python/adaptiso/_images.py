"""Images as users have them (arrays, nibabel's, SimpleITK's and ITK's images, files) as samples and
an affine, uncopied where they can be."""

from __future__ import annotations

import contextlib
import re
import sys
import threading
import weakref
from typing import (TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, NamedTuple, Optional,
                    Tuple)

import numpy as np
import numpy.typing as npt

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import Warned, is_path, path, shown, warn
from ._options import checked, rows, takes

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import ReadOptions

Array = npt.NDArray[Any]
Affine = npt.NDArray[np.float64]

#: Types of samples that are used as they are; others are converted.
_NATIVE = frozenset("u1 i1 u2 i2 u4 i4 u8 i8 f4 f8".split())
#: GDCM's switches are global: one DICOM at a time.
_reading = threading.Lock()


class Image(NamedTuple):
    """An image as read: what `read` returns.

    Attributes
    ----------
    array : ndarray, shape (I, J, K)
        Samples in the file's own type, scaled as the file says. Read-only, Fortran order.
    affine : ndarray, shape (4, 4)
        Takes voxel indices (i, j, k, 1) to scanner RAS millimetres.
    warnings : list of str
        Doubts about the reading, one line each; each has a `code` as well
        (Documentation/Warnings.md).
    format : str
        "NIfTI-1", "NRRD", "MetaImage", "MGH", "DICOM", ...
    """

    array: Array
    affine: Affine
    warnings: List[Warned]
    format: str

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.array.shape))
        return f"<adaptiso.Image of {shape} voxels, {self.array.dtype}, {self.format}>"

    def __eq__(self, other: object) -> bool:
        """The same samples (NaN too), affine, warnings and format."""
        if not isinstance(other, Image):
            return NotImplemented
        return (self.format == other.format and self.warnings == other.warnings
                and np.array_equal(self.affine, other.affine)
                and np.array_equal(self.array, other.array, equal_nan=self.array.dtype.kind == "f"))

    def __ne__(self, other: object) -> bool:  # of a tuple it would be the tuple's own
        return not self == other


@takes("read")
def read(file: Any, **options: Unpack[ReadOptions]) -> Image:
    """Read a scan: NIfTI, NRRD, MetaImage, MGH, Zarr, or DICOM (a file, a folder, a DICOMDIR); MINC
    and others by ITK's readers, where libadaptisoItkIO.so (package adaptiso-itk) is installed.

    Files are taken for hostile: every length is checked, nothing is padded or guessed, and
    DICOM's compressed pixels are decoded in a child process, so that a damaged file is an
    exception and no crash.

    Parameters
    ----------
    file : str or path
        A file, or the folder with the slices of a DICOM series. What it is follows from its
        content, not from its name.
    **options

    Returns
    -------
    Image
        (array, affine, warnings, format); warnings go to the logger "adaptiso" as well.

    Raises
    ------
    Error
        The file is missing, damaged, of an unknown format, or without geometry.

    Examples
    --------
    >>> import adaptiso
    >>> image = adaptiso.read("/usr/share/mricron/templates/ch2bet.nii.gz")
    >>> image.array.shape, image.array.dtype.name, image.format
    ((181, 217, 181), 'uint8', 'NIfTI-1')
    >>> image.affine.diagonal()
    array([1., 1., 1., 1.])
    """
    return _read(file, options)[0]


def _read(file: Any, options: Mapping[str, Any] = {}) -> Tuple[Image, str]:
    """`read`, and how the header scales stored values ("": it does not)."""
    name = path("file", file)
    given = checked("read", options, "read")
    try:
        with _reading:
            array, affine, kind, warnings, scaling = _adaptiso.read_image(name, given)
    except Error as error:
        raise Error(_in_python(str(error), name)) from None
    warn(warnings, file=base_name(name))
    return Image(array, affine, warnings, kind), scaling


def _in_python(message: str, name: str) -> str:
    """A reader's message, which names options as the programs have them, and functions."""
    if "not a format that is read here" in message:
        with contextlib.suppress(Error):
            _adaptiso.read_mesh(name, None, None, True, None)
            return re.sub(": [^:]*not a format that is read here.*", ": is a surface; adaptiso.load reads it", message)
    message = message.replace("--level, --channel, --time, --refuse-missing-chunks",
                              "level, channel, time, all_chunks")
    message = message.replace("; adaptiso-mesh --list-series prints what is known of each", "")
    message = message.replace("leave --refuse-missing-chunks out", "leave all_chunks=True out")
    for name, row in rows("read").items():
        message = re.sub(rf"--{row['name']}\b", f"{name}= of adaptiso.read", message)
    return message


def base_name(file: str) -> str:
    """Without folders, as messages and reports have it."""
    return file.rstrip("/").rsplit("/", 1)[-1] or file


class Samples(NamedTuple):
    """An image, ready for C++."""

    user: Array  #: the array that users gave, or one made for them
    volume: _adaptiso.ArrayVolume
    affine: Affine
    file: str
    format: str
    warnings: List[Warned]
    scaling: str = ""  #: how a file's header scales its values, where that is known


def samples_of(image: Any, affine: Any, in_file_order: bool = False) -> Samples:
    """`image` as `surface` and `Index` take it; `in_file_order`: copied where its samples don't lie
    with i fastest, as files have them. \\raises Error"""
    if is_path(image):
        if affine is not None:
            raise Error("affine: a file has its own, and its spacing; read it with adaptiso.read and give the array")
        found, scaling = _read(image)
        return prepared(found.array, found.affine, base_name(path("image", image)), found.format,
                        found.warnings)._replace(scaling=scaling)
    array, own_affine, kind = _array_of(image)
    stored = getattr(image, "dataobj", None)  # of nibabel
    slope, intercept = getattr(stored, "slope", 1), getattr(stored, "inter", 0)
    scaling = "" if (slope, intercept) == (1, 0) else f"slope {slope:g}, intercept {intercept:g}"
    if affine is None:
        affine = np.eye(4) if own_affine is None else own_affine
    elif own_affine is not None:
        raise Error("affine: the image has its own, and its spacing; give its array and the affine")
    return prepared(np.asfortranarray(array) if in_file_order else array, affine, "", kind,
                    [])._replace(scaling=scaling)


def stated_affine(affine: Any, spacing: Any) -> Any:
    """The affine that the arguments `affine` and `spacing` state, or None. \\raises Error"""
    if spacing is None:
        return affine
    if affine is not None:
        raise Error("affine and spacing: give one of the two")
    try:
        steps = np.array(spacing, np.float64)
    except (TypeError, ValueError, OverflowError):
        steps = np.empty(0)
    if steps.shape != (3,) or not (steps > 0).all():
        raise Error(f"spacing {shown(spacing)}: must be three numbers above 0, in mm")
    return np.diag([*steps, 1.0])


def affine_of(value: Any, name: str = "affine", what: str = "voxel indices to RAS mm") -> Affine:
    """A matrix of voxel indices to scanner RAS mm. \\raises Error"""
    try:
        affine = np.array(value, dtype=np.float64) if _is_plain(value) else np.empty(0)
    except (TypeError, ValueError, OverflowError):
        affine = np.empty(0)
    if affine.shape != (4, 4):
        raise Error(f"{name} {shown(value)}: must be a 4 x 4 matrix, {what}")
    return affine


def _is_plain(value: Any) -> bool:
    """No part of it would be lost without a word."""
    return not isinstance(value, np.ma.MaskedArray) and not np.iscomplexobj(value)


def _array_of(image: Any) -> Tuple[Array, Optional[Affine], str]:
    if isinstance(image, np.ma.MaskedArray):
        raise Error("image: is a masked array; fill it first (image.filled(value))")
    if isinstance(image, np.ndarray):
        return image, None, "array"
    if isinstance(image, Image):
        return image.array, image.affine, image.format
    if hasattr(image, "dataobj") and hasattr(image, "affine"):
        if image.affine is None:
            raise Error("image: the nibabel image has no affine; give its array and one")
        array = np.asanyarray(image.dataobj)
        single = all(size == 1 for size in array.shape[3:])  # as files of one volume may have it
        return (array.reshape(array.shape[:3]) if single else array, affine_of(image.affine),
                type(image).__name__)
    if hasattr(image, "GetSpacing") and hasattr(image, "GetDirection"):
        return _itk_array(image), _itk_affine(image), type(image).__name__
    raise Error(f"image {shown(image)}: must be a NumPy array, a nibabel, SimpleITK or ITK image, "
                "or a file's name")


def _itk_array(image: Any) -> Array:
    """A view of an image of SimpleITK or of ITK's own Python package: i, j, k."""
    package = type(image).__module__.split(".")[0]
    module = sys.modules.get(package)
    view = getattr(module, "GetArrayViewFromImage", None) or getattr(
        module, "array_view_from_image", None)
    if view is None:
        raise Error(f"image: of {package} nothing is known that gives its samples")
    array = np.asarray(view(image))
    if array.ndim != 3:
        raise Error(f"image: has {array.ndim} axes, or several values a voxel; must be 3-D, scalar")
    return array.transpose()


def _itk_affine(image: Any) -> Affine:
    direction = np.array(image.GetDirection(), dtype=np.float64).reshape(3, 3)
    affine = np.eye(4)
    affine[:3, :3] = direction * np.array(image.GetSpacing(), dtype=np.float64)
    affine[:3, 3] = np.array(image.GetOrigin(), dtype=np.float64)
    affine[:2] *= -1  # LPS to RAS
    return affine


def _usable(array: Array) -> Array:
    """In a type that C++ knows, native byte order. \\raises Error"""
    if array.ndim != 3:
        raise Error(f"image: has the shape {array.shape}, must have three axes"
                    + ("; of a 4-D image give one volume" if array.ndim == 4 else ""))
    if array.size == 0:
        raise Error(f"image: has the shape {array.shape}, so there is no sample")
    dtype = array.dtype
    if dtype.kind == "b":
        return array.view(np.uint8)
    if dtype.kind in "iuf" and dtype.str[1:] in _NATIVE:
        return array if dtype.isnative else array.astype(dtype.newbyteorder("="))
    if dtype == np.float16:
        return array.astype(np.float32)
    raise Error(f"image: samples of type {dtype} can't be used; convert them "
                "(image.astype(numpy.float32))")


def _fortran_axes(array: Array) -> Optional[List[int]]:
    """The order of axes in which the samples lie tightly, the fastest first; None: in none."""
    axes = sorted(range(3), key=lambda axis: (array.strides[axis], array.shape[axis]))
    # axes of one sample have no stride of their own; they keep their place as far as they can
    axes = [axis for axis in axes if array.shape[axis] > 1]
    step = array.itemsize
    for axis in axes:
        if array.strides[axis] != step:
            return None
        step *= array.shape[axis]
    single = [axis for axis in range(3) if array.shape[axis] == 1]
    if axes == sorted(axes):
        return [0, 1, 2]
    if axes == sorted(axes, reverse=True):
        return [2, 1, 0]
    return axes + single


def prepared(array: Array, affine: Any, file: str, kind: str, warnings: List[Warned]) -> Samples:
    usable = _usable(array)
    matrix = affine_of(affine)
    axes = _fortran_axes(usable)
    if axes is None:  # with gaps, or backwards
        usable, axes = np.asfortranarray(usable), [0, 1, 2]
    turned = usable.transpose(axes)
    if not turned.flags.f_contiguous:  # pragma: no cover - NumPy's flags are by the same rule
        turned = np.asfortranarray(turned)
    own = matrix[:, axes + [3]]
    volume = _adaptiso.ArrayVolume(np.asarray(turned), np.ascontiguousarray(own),
                                   list(usable.shape), matrix)
    told = [Warned(w) if type(w) is str else w for w in warnings]
    if not file and usable.dtype.kind == "f":
        bad = volume.count_not_finite()
        if bad:
            told.append(Warned(f"{bad} voxels are NaN or infinite; NaN counts as outside", "not-finite"))
            warn(told[-1:], "image")
    return Samples(array, volume, matrix, file, kind, told)


# how many calls are looking at an array; it may be written to again after the last one
_lookers: Dict[int, int] = {}
_lookers_lock = threading.Lock()


def _look_at(array: Array) -> bool:
    """Makes an array read-only. \\returns whether `_look_away` is to be called"""
    key = id(array)
    with _lookers_lock:
        if key in _lookers:
            _lookers[key] += 1
            return True
        if not array.flags.writeable:
            return False
        try:
            array.flags.writeable = True  # refused where it could not be set back, as of pickled ones
        except ValueError:
            return False
        array.flags.writeable = False
        _lookers[key] = 1
        return True


def _look_away(array: Array) -> None:
    key = id(array)
    with _lookers_lock:
        _lookers[key] -= 1
        if _lookers[key] == 0:
            del _lookers[key]
            array.flags.writeable = True


@contextlib.contextmanager
def read_only(array: Array) -> Iterator[None]:
    """Write-protects `array` meanwhile."""
    is_held = _look_at(array)
    try:
        yield
    finally:
        if is_held:
            _look_away(array)


def keep_read_only(array: Array, owner: Any) -> None:
    """Write-protects `array` as long as `owner` lives."""
    if _look_at(array):
        weakref.finalize(owner, _look_away, array)
