"""Head models for boundary elements: nested surfaces of images, for MNE, FreeSurfer and OpenMEEG."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import shutil
import uuid
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, count, flag, is_path, number, path as checked_path,
                         progress as checked_progress, shown, threads as checked_threads, word)
from ._images import Samples, base_name, read_only, samples_of
from ._mesh import Mesh, load
from ._quality import Check

logger = logging.getLogger("adaptiso")

PRESETS = ("charm", "headreco", "aseg")
TISSUES = ("brain", "skull", "scalp")

#: MNE's numbers of the surfaces (FIFFV_BEM_SURF_ID_*) and of the frame (FIFFV_COORD_MRI).
_MNE_SURFACES = {"inner_skull": 1, "outer_skull": 3, "outer_skin": 4}
_MNE_MRI = 5

#: What a folder of a model may hold, as adaptiso-bem has it.
_OWN_FILES = frozenset(
    [f"{name}.{kind}" for name in _MNE_SURFACES for kind in ("surf", "tri", "gii", "vtp")]
    + ["model.geom", "model.cond", "report.json", "spots.png", "README.md"])


class NoModel(Error):
    """No head model could be guaranteed; the message says why and where.

    Attributes
    ----------
    model : HeadModel
        What it was tried from: its ``surfaces``, ``report`` and ``report_html()`` show the places.
    """

    def __init__(self, message: str, model: "HeadModel") -> None:
        super().__init__(message)
        self.model = model


class HeadModel:
    """The nested surfaces of a head, for boundary elements: what `bem` makes.

    Attributes
    ----------
    surfaces : dict of str to Mesh
        "inner_skull", "outer_skull", "outer_skin", from inside out (of MEG the first alone), in
        scanner RAS mm. Each is closed, in one piece, of genus 0, and does not cross itself; each
        lies strictly inside the next, with the gaps asked for.
    check : Check
        That this is so, found anew.
    report : dict
        What was made, measured and checked: the report adaptiso-bem/1, points in LPS mm.
    """

    __slots__ = ("_data", "_surfaces", "_check", "_report", "_conductivity", "_threads",
                 "__weakref__")

    def __init__(self, data: _adaptiso.HeadModelData, conductivity: Tuple[float, ...],
                 threads: int) -> None:
        self._data = data
        self._conductivity = conductivity
        self._threads = threads
        self._surfaces: Optional[Dict[str, Mesh]] = None
        self._check: Optional[Check] = None
        self._report: Optional[Dict[str, Any]] = None

    @property
    def surfaces(self) -> Dict[str, Mesh]:
        """The surfaces by name, from inside out, in scanner RAS mm."""
        if self._surfaces is None:
            self._surfaces = dict(zip(_MNE_SURFACES, map(Mesh._of, self._data.surfaces)))
        return self._surfaces

    @property
    def check(self) -> Check:
        """What `adaptiso.check_nested` finds with the profile "bem" and the gaps asked for."""
        if self._check is None:
            self._check = Check(json.loads(self._data.check(self._threads)))
        return self._check

    @property
    def report(self) -> Dict[str, Any]:
        """The report adaptiso-bem/1, as ``adaptiso-bem --json`` writes it."""
        if self._report is None:
            self._report = json.loads(self._data.report())
        return self._report

    def to_mne(self) -> List[Dict[str, Any]]:
        """The surfaces as ``mne.make_bem_model`` gives them, for ``mne.make_bem_solution``.

        In metres, in MNE's frame "MRI": FreeSurfer's surface RAS (tkRAS) of the image, or of the
        volume that FreeSurfer makes of it. Needs no FreeSurfer folder and no ``SUBJECTS_DIR``.

        Returns
        -------
        list of dict
            From outside in, as MNE has them.
        """
        list_ = []
        for name, mesh in reversed(list(self.surfaces.items())):
            knows_tkras = self._data.has_volume and mesh.frame != "tkras"
            data = mesh._data.in_frame("tkras") if knows_tkras else mesh._data
            sigma = self._conductivity[list(_MNE_SURFACES).index(name)]
            list_.append({"rr": data.vertices / 1000, "tris": data.faces.astype(np.int32),
                          "np": len(data.vertices), "ntri": len(data.faces),
                          "id": _MNE_SURFACES[name], "sigma": sigma, "coord_frame": _MNE_MRI})
        return list_

    def save(self, folder: Any, *, replace: bool = False, units: str = "mm", frame: str = "ras",
             gifti: bool = False, vtp: bool = False) -> None:
        """Write the folder that adaptiso-bem writes: files for FreeSurfer, MNE and OpenMEEG, a
        README.md that says how to use them, and report.json.

        The folder is whole or not there; its files are read back and checked. The surfaces are the
        program's to the byte.

        Parameters
        ----------
        folder : str or path
            To be made; the one above it must be there.
        replace : bool
            Replace a folder that holds nothing but a model's files.
        units : {"mm", "m"}
            Of OpenMEEG's files (.tri).
        frame : {"ras", "lps", "tkras"}
            Of all files but FreeSurfer's (.surf), which are in tkRAS.
        gifti, vtp : bool
            Write .gii and .vtp files too.

        Raises
        ------
        Error
            The folder is there and may not be replaced, or can't be written.
        """
        target = os.path.realpath(checked_path("folder", folder))
        options = (word("units", units, ("mm", "m")), word("frame", frame, ("ras", "lps", "tkras")),
                   flag("gifti", gifti), flag("vtp", vtp))
        if not self._data.has_model:
            raise Error("there is no model to save")
        if frame == "tkras" and not self._data.has_volume:
            raise Error("frame tkras: the model does not know its image; give volume= to bem")
        _require_replaceable(target, flag("replace", replace))
        temporary = f"{target}-{uuid.uuid4().hex}"
        try:
            os.mkdir(temporary)
            self._data.write(temporary, *options)
            _put_in_place(temporary, target)
        except OSError as error:
            raise Error(f"{target}: can't be written: {error.strerror}") from None
        except Error as error:
            raise Error(str(error).replace(temporary, target)) from None
        finally:
            shutil.rmtree(temporary, ignore_errors=True)

    def report_html(self, *, deface: bool = False) -> str:
        """The page of ``adaptiso-bem --report``: verdict, surfaces on the image and in 3-D, gaps,
        checks. One file that needs no network; of some MB with an image.

        Parameters
        ----------
        deface : bool
            Leave out the face, of the image and of the surfaces.

        Returns
        -------
        str
            HTML, to be written as UTF-8.
        """
        return self._data.page(flag("deface", deface))

    def __repr__(self) -> str:
        if not self._data.has_model:
            return f"<adaptiso.HeadModel: none: {self._data.failure}>"
        told = ", ".join(f"{name} of {len(mesh.vertices):,} vertices"
                         for name, mesh in self.surfaces.items())
        return f"<adaptiso.HeadModel: {told}>"


class _Source(NamedTuple):
    """What a model is made from, as C++ takes it."""

    kind: str
    images: List[Samples]
    mask: Optional[Samples]
    surfaces: List[Mesh]
    inputs: List[List[str]]
    warnings: List[str]


def bem(t1: Any = None, *, brain_mask: Any = None, labels: Any = None,
        tissues: Union[str, Mapping[str, Sequence[int]], None] = None,
        probabilities: Optional[Sequence[Any]] = None, ct: Any = None,
        surfaces: Optional[Sequence[Any]] = None, volume: Any = None, affine: Any = None,
        vertices: Union[int, Sequence[int], None] = None,
        edge_length: Optional[Tuple[float, float]] = None, meg: bool = False,
        min_gap: Union[float, Tuple[float, float]] = 2, csf: float = 2, skull: float = 6,
        max_skull: float = 20, skull_hu: float = 300, skin_hu: float = -300, closing: float = 10,
        smoothing: float = 1.5, cut_necks: float = 8, voxel: Optional[float] = None,
        conductivity: Tuple[float, float, float] = (0.3, 0.006, 0.3), threads: int = 0,
        progress: Optional[Progress] = None) -> HeadModel:
    """Make the nested surfaces of a head model: inner skull, outer skull, outer skin.

    What the program adaptiso-bem does: the same samples and options give the same surfaces, to the
    byte, for any number of threads. One of `t1`, `labels`, `probabilities`, `ct` and `surfaces` is
    given; images as for `surface`.

    Parameters
    ----------
    t1 : image, optional
        A T1-weighted MRI of the whole head.
    brain_mask : image, optional
        With `t1`: the brain, from any brain extraction (a mask, or the T1 with the skull removed).
        Without it the brain is guessed, good enough for a clean T1; look at the result.
    labels : image, optional
        A segmentation; `tissues` says of what.
    tissues : {"charm", "headreco", "aseg"} or dict, optional
        With `labels`: whose they are, or ``{"brain": [1, 2, 3], "skull": [4], "scalp": [5]}``; CSF
        belongs to the brain.
    probabilities : sequence of images, optional
        Tissue maps in SPM's order: grey, white, CSF, bone, soft tissue.
    ct : image, optional
        A CT of the whole head, in Hounsfield units.
    surfaces : sequence, optional
        Ready surfaces from inside out, each a Mesh, (vertices, faces), a path, or an object with
        vertices and faces. Checked, mended where need be, kept as they are where not.
    volume : image, optional
        With `surfaces`: the image they belong to, for tkRAS.
    affine : array_like of shape (4, 4), optional
        Of images that are plain arrays: voxel indices to scanner RAS mm.
    vertices : int or sequence of int, optional
        Of each surface, evenly spread, 42 to 200,000; or one number for each, from inside out.
        Default: 2562.
    edge_length : (float, float), optional
        Shortest and longest edge, mm: short where a surface bends or another is near.
    meg : bool
        The inner skull alone.
    min_gap : float or (float, float)
        Least thickness of skull and scalp, mm, 0.5 to 20; guaranteed.
    csf : float
        T1: from the brain to the inner skull, mm.
    skull : float
        T1: thickness of the skull where the image does not show it, mm.
    max_skull : float
        Bone farther than this from the inner skull (face, neck) counts as scalp, mm.
    skull_hu, skin_hu : float
        CT: isovalues of bone and skin, Hounsfield units.
    closing : float
        Gaps and canals narrower than twice this are closed, mm.
    smoothing : float
        Standard deviation of the Gaussian that boundaries are smoothed with, mm.
    cut_necks : float
        Cut off what of the inner skull a ball of this radius (mm) can't enter, as leaks down a
        foramen are; 0: cut nothing.
    voxel : float, optional
        Side of the voxels that the head is worked on, mm. Default: the image's own if they are
        cubes of 0.7 to 1.5 mm, else 1.
    conductivity : (float, float, float)
        Of brain, skull and scalp, S/m.
    threads : int
        0: as many as the machine has.
    progress : callable, optional
        Called as ``progress(stage, fraction)`` now and then; what it raises ends the call.

    Returns
    -------
    HeadModel

    Raises
    ------
    NoModel
        A guarantee can't be had; its ``model`` shows where.
    Error
        An image without a head, or an option that can't be used.

    Examples
    --------
    Three spheres, of 60, 66 and 72 mm:

    >>> import adaptiso, numpy as np
    >>> place = np.indices((40, 40, 40)) * 4.0 - 78
    >>> radius = np.sqrt((place ** 2).sum(axis=0))
    >>> labels = (3 - np.searchsorted([60, 66, 72], radius)).clip(0).astype(np.uint8)
    >>> model = adaptiso.bem(labels=labels, tissues={"brain": [3], "skull": [2], "scalp": [1]},
    ...                      affine=[[4, 0, 0, -78], [0, 4, 0, -78], [0, 0, 4, -78], [0, 0, 0, 1]],
    ...                      vertices=162, voxel=3, closing=4)
    >>> model
    <adaptiso.HeadModel: inner_skull of 162 vertices, outer_skull of 162 vertices, outer_skin of 162 vertices>
    >>> model.check
    <adaptiso.Check: passed>
    >>> [surface["id"] for surface in model.to_mne()]
    [4, 3, 1]
    """
    is_meg = flag("meg", meg)
    layers = 1 if is_meg else 3
    gaps = _gaps(min_gap)
    options: Dict[str, Any] = {
        "meg": is_meg,
        "vertices": _vertices(vertices, layers),
        "edge_length": _edge_length(edge_length),
        "min_gap": gaps,
        "csf": _length("csf", csf, 20),
        "skull": _length("skull", skull, 200),
        "max_skull": _length("max_skull", max_skull, 200),
        "skull_hu": number("skull_hu", skull_hu),
        "skin_hu": number("skin_hu", skin_hu),
        "closing": _length("closing", closing, 30),
        "smoothing": _length("smoothing", smoothing, 10),
        "cut_necks": _length("cut_necks", cut_necks, 20),
        "voxel": 0.0 if voxel is None else _length("voxel", voxel, 5),
        "conductivity": _three("conductivity", conductivity),
        "threads": checked_threads(threads),
        "progress": checked_progress(progress),
    }
    _require_thicknesses(options, t1 is not None, ct is not None)
    preset, lists = _tissues(tissues, labels is not None, is_meg)
    source = _source(t1, brain_mask, labels, probabilities, ct, surfaces, volume, affine, layers)
    with contextlib.ExitStack() as meanwhile:
        for image in source.images + ([] if source.mask is None else [source.mask]):
            meanwhile.enter_context(read_only(image.user))
        data = _adaptiso.make_bem(
            source=source.kind, images=[image.volume for image in source.images],
            brain_mask=None if source.mask is None else source.mask.volume, preset=preset,
            tissues=lists, surfaces=[surface._data for surface in source.surfaces],
            inputs=source.inputs, warnings=source.warnings, **options)
    for warning in data.warnings[len(source.warnings):]:
        logger.warning("bem: %s", warning)
    model = HeadModel(data, options["conductivity"], options["threads"])
    if not data.has_model:
        raise NoModel(f"no model: {data.failure}", model)
    return model


def _source(t1: Any, brain_mask: Any, labels: Any, probabilities: Any, ct: Any, surfaces: Any,
            volume: Any, affine: Any, layers: int) -> _Source:
    """The one that is given. \\raises Error"""
    given = {"t1": t1, "labels": labels, "probabilities": probabilities, "ct": ct,
             "surfaces": surfaces}
    kinds = [kind for kind, value in given.items() if value is not None]
    if len(kinds) != 1:
        raise Error("one of t1, labels, probabilities, ct and surfaces must be given, and one only")
    kind = kinds[0]
    if brain_mask is not None and kind != "t1":
        raise Error("brain_mask: needs t1")
    if volume is not None and kind != "surfaces":
        raise Error("volume: needs surfaces")
    source = _Source(kind, [], None, [], [], [])
    if kind == "surfaces":
        if volume is not None:
            source.images.append(_image("volume", volume, affine, source))
        source.surfaces.extend(_surfaces(surfaces, layers, source))
        return source
    images = _listed(kind, probabilities) if kind == "probabilities" else [given[kind]]
    if not images:
        raise Error("probabilities: no map is given; must be grey, white, CSF, bone, soft tissue")
    source.images.extend(_image(kind, image, affine, source) for image in images)
    mask = None
    if brain_mask is not None:
        mask = _image("brain_mask", brain_mask, affine, source)
    return source._replace(mask=mask)


def _image(name: str, image: Any, affine: Any, source: _Source) -> Samples:
    """An image as bem takes it, i fastest as files have it. \\raises Error"""
    try:
        samples = samples_of(image, affine if isinstance(image, np.ndarray) else None, True)
    except Error as error:
        told = str(error)
        raise Error(name + told[5:] if told.startswith("image") else f"{name}: {told}") from None
    role = name.replace("_", " ")
    source.inputs.append([samples.file, role, samples.format])
    source.warnings.extend(f"{samples.file or role}: {warning}" for warning in samples.warnings)
    return samples


def _surfaces(surfaces: Any, layers: int, source: _Source) -> List[Mesh]:
    meshes = []
    for surface in _listed("surfaces", surfaces):
        file = base_name(checked_path("surfaces", surface)) if is_path(surface) else ""
        source.inputs.append([file, "surface", "file" if file else type(surface).__name__])
        if isinstance(surface, Mesh):
            meshes.append(surface)
        elif file:
            meshes.append(load(surface))
        elif isinstance(surface, (tuple, list)) and len(surface) == 2:
            meshes.append(Mesh(*surface))
        elif hasattr(surface, "vertices") and hasattr(surface, "faces"):
            meshes.append(Mesh(surface.vertices, surface.faces))
        else:
            raise Error(f"surfaces {shown(surface)}: must be a Mesh, (vertices, faces), or a file's "
                        "name")
    if len(meshes) != layers:
        raise Error(f"surfaces: are {len(meshes)}, must be {layers}, from inside out")
    if len({mesh.frame for mesh in meshes}) > 1:
        raise Error("surfaces: are not in one frame; load those in tkras with volume=")
    return meshes


def _listed(name: str, value: Any) -> List[Any]:
    if is_path(value) or isinstance(value, (np.ndarray, Mesh)) or not hasattr(value, "__iter__"):
        raise Error(f"{name} {shown(value)}: must be a sequence")
    return list(value)


def _length(name: str, value: Any, most: float) -> float:
    return number(name, value, f"a number from 0 to {most}, in mm",
                  lambda length: 0 <= length <= most)


def _three(name: str, value: Any) -> Tuple[float, ...]:
    values = tuple(number(name, part) for part in _listed(name, value))
    if len(values) != 3:
        raise Error(f"{name} {shown(value)}: must be three numbers: brain, skull, scalp")
    return values


def _gaps(value: Any) -> Tuple[float, ...]:
    parts = list(value) if isinstance(value, (tuple, list)) else [value, value]
    if len(parts) != 2:
        raise Error(f"min_gap {shown(value)}: must be one number, or two: skull, scalp")
    return tuple(number("min_gap", part, "a number from 0.5 to 20, in mm",
                        lambda gap: 0.5 <= gap <= 20) for part in parts)


def _vertices(value: Any, layers: int) -> List[int]:
    if value is None:
        return []
    parts = _listed("vertices", value) if hasattr(value, "__iter__") else [value]
    if len(parts) not in (1, layers):
        raise Error(f"vertices {shown(value)}: must be one number, or {layers}")
    return [count("vertices", part, 42, 200000) for part in parts]


def _edge_length(value: Any) -> Optional[Tuple[float, float]]:
    if value is None:
        return None
    parts = [number("edge_length", part) for part in _listed("edge_length", value)]
    if len(parts) != 2 or not 0 < parts[0] <= parts[1]:
        raise Error(f"edge_length {shown(value)}: must be two lengths in mm, 0 < shortest <= "
                    "longest")
    return parts[0], parts[1]


def _require_thicknesses(options: Dict[str, Any], is_t1: bool, is_ct: bool) -> None:
    """What one option alone can't tell. \\raises Error"""
    least, most = options["min_gap"][0], options["max_skull"]
    if not most > least:
        raise Error("max_skull: must be more than min_gap")
    if is_t1 and not least <= options["skull"] <= most:
        raise Error("skull: must lie between min_gap and max_skull")
    if is_ct and not -1000 < options["skin_hu"] < options["skull_hu"] > 40:
        raise Error("skin_hu: must lie above air (-1000 HU) and below skull_hu, and that above "
                    "soft tissue (40 HU)")


def _tissues(value: Any, is_needed: bool, is_meg: bool) -> Tuple[str, List[List[int]]]:
    """A preset's name, or the labels of brain, skull and scalp. \\raises Error"""
    if value is None:
        if is_needed:
            raise Error("labels: need tissues, whose they are or which labels: 'charm', "
                        "{'brain': [1], 'skull': [2], 'scalp': [3]}")
        return "", [[], [], []]
    if not is_needed:
        raise Error("tissues: need labels")
    if isinstance(value, str):
        return word("tissues", value, PRESETS), [[], [], []]
    if not isinstance(value, Mapping) or not set(value) <= set(TISSUES):
        raise Error(f"tissues {shown(value)}: must be one of {', '.join(PRESETS)}, or a dict of "
                    "brain, skull and scalp")
    lists = []
    for name in TISSUES:
        labels = value.get(name, [])
        labels = list(labels) if hasattr(labels, "__iter__") else [labels]
        lists.append([count(f"tissues, {name}", label, -2**63, 2**63 - 1) for label in labels])
        if not lists[-1] and (name == "brain" or not is_meg):
            raise Error(f"tissues: {name} has no label")
    return "", lists


def _require_replaceable(target: str, replace: bool) -> None:
    if not os.path.lexists(target):
        return
    if not os.path.isdir(target):
        raise Error(f"{target}: exists and is no folder")
    names = os.listdir(target)
    if names and not replace:
        raise Error(f"{target}: exists and is not empty; replace=True replaces a model")
    for name in names:
        file = os.path.join(target, name)
        if name not in _OWN_FILES or os.path.islink(file) or not os.path.isfile(file):
            raise Error(f"{target}: holds {name}, which is not of a model; it is not replaced")


def _put_in_place(folder: str, target: str) -> None:
    """`folder` under the name of `target`, whose files, if any, go. \\raises OSError"""
    if not os.path.isdir(target) or not os.listdir(target):
        os.rename(folder, target)
        return
    old = f"{target}-{uuid.uuid4().hex}"
    os.rename(target, old)
    try:
        os.rename(folder, target)
    except OSError:
        os.rename(old, target)
        raise
    with contextlib.suppress(OSError):
        shutil.rmtree(old)
