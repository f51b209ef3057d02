"""Head models for boundary elements: nested surfaces of images, for MNE, FreeSurfer and OpenMEEG."""

from __future__ import annotations

import contextlib
import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, Warned, count, flag, is_path, listed, number,
                         path as checked_path, progress as checked_progress, shown,
                         threads as checked_threads, warn, word)
from ._images import Samples, base_name, read_only, samples_of
from ._mesh import Mesh, mesh_data_of, require_known_frames, stated_frames
from ._options import checked, takes
from ._quality import Check

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import BemOptions

PRESETS = tuple(_adaptiso.tissue_presets())
TISSUES = ("white", "brain", "csf", "skull", "spongy", "scalp")
MONTAGES = tuple(_adaptiso.montage_names())
MESHERS = ("tetgen", "gmsh")
#: From inside out; models have the inner skull alone, or the last three to five of them.
SURFACES = ("white_matter", "brain", "inner_skull", "outer_skull", "outer_skin")

#: MNE's numbers of the surfaces (FIFFV_BEM_SURF_ID_*) and of the frame (FIFFV_COORD_MRI).
_MNE_SURFACES = {"inner_skull": 1, "outer_skull": 3, "outer_skin": 4}
_MNE_MRI = 5

_LANDMARKS = ("nasion", "left_ear", "right_ear")

Point = Tuple[float, float, float]


class NoModel(Error):
    """No head model could be guaranteed; the message says why and where.

    Attributes
    ----------
    model : HeadModel
        The model's input: its ``surfaces``, ``report`` and ``report_html()`` show the places.
    """

    def __init__(self, message: str, model: "HeadModel") -> None:
        super().__init__(message)
        self.model = model

    def __reduce__(self) -> Tuple[Any, ...]:
        return type(self), (str(self), self.model)


class _Carried:
    """A pickled model's data, in place of C++'s: without the image and the way it was made."""

    def __init__(self, state: Dict[str, Any]) -> None:
        self.state = state

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["state"][name]
        except KeyError:
            raise AttributeError(name) from None

    @property
    def surfaces(self) -> List[_adaptiso.MeshData]:
        return [mesh._data for mesh in self.state["meshes"]]

    def check(self, threads: int) -> str:
        return str(self.state["check_text"])

    def report(self) -> str:
        return str(self.state["report_text"])

    def write(self, folder: str, options: Dict[str, Any], replace: bool) -> None:
        raise Error("save: this model was pickled; save it in the process that made it")

    def page(self, deface: bool) -> str:
        raise Error("report_html: this model was pickled; ask for the page in the process that made "
                    "it")


def _unpickled(state: Dict[str, Any], threads: int) -> "HeadModel":
    return HeadModel(_Carried(state), threads)


class HeadModel:
    """The nested surfaces of a head, for boundary elements: what `bem` makes.

    It pickles, so that a pool of processes can return it; `save` and `report_html` need the image,
    and are for the process that made it.
    """

    __slots__ = ("_data", "_surfaces", "_check", "_report", "_threads", "__weakref__")

    def __init__(self, data: Union[_adaptiso.HeadModelData, _Carried], threads: int) -> None:
        self._data = data
        self._threads = threads
        self._surfaces: Optional[Dict[str, Mesh]] = None
        self._check: Optional[Check] = None
        self._report: Optional[Dict[str, Any]] = None

    @property
    def surfaces(self) -> Dict[str, Mesh]:
        """By name, from inside out, scanner RAS mm: "inner_skull", "outer_skull", "outer_skin" (of
        MEG the first alone, of four layers "brain" before them, of five "white_matter" too). Each is closed, in one piece, of
        genus 0, and does not cross itself; each lies strictly inside the next, with the gaps asked
        for."""
        if self._surfaces is None:
            meshes = list(map(Mesh._of, self._data.surfaces))
            names = ("inner_skull",) if len(meshes) == 1 else SURFACES[-len(meshes):]
            self._surfaces = dict(zip(names, meshes))
        return dict(self._surfaces)

    @property
    def electrodes(self) -> Dict[str, Point]:
        """On the skin, by name, scanner RAS mm; empty where none were asked for."""
        return dict(self._data.electrodes)

    @property
    def landmarks(self) -> Dict[str, Point]:
        """By name ("Nasion", "LPA", "RPA"), scanner RAS mm; empty where they are not known. As exact
        as they were given, or, where they were guessed, as the warnings say."""
        return dict(self._data.landmarks)

    @property
    def check(self) -> Check:
        """Result of `adaptiso.check_nested` with the profile "bem" and the gaps asked for."""
        if self._check is None:
            self._check = Check(json.loads(self._data.check(self._threads)))
        return self._check

    @property
    def report(self) -> Dict[str, Any]:
        """The report adaptiso-bem/1, as ``adaptiso-bem --json`` writes it; points in LPS mm."""
        if self._report is None:
            self._report = json.loads(self._data.report())
        return self._report

    def to_mne(self) -> List[Dict[str, Any]]:
        """The surfaces as ``mne.make_bem_model`` gives them, for ``mne.make_bem_solution``.

        In metres, in MNE's frame "MRI": FreeSurfer's surface RAS (tkRAS) of the image, or of the
        volume that FreeSurfer makes of it. Needs no FreeSurfer folder and no ``SUBJECTS_DIR``. Of
        four or five layers MNE takes three: all within the inner skull has the brain's conductivity.

        Returns
        -------
        list of dict
            From outside in, as MNE has them.
        """
        conductivity = self.report["options"]["conductivity"]
        sigmas = dict(zip(_MNE_SURFACES, map(conductivity.get, ("brain", "skull", "scalp"))))
        list_ = []
        for name, mesh in reversed(list(self.surfaces.items())):
            if name not in _MNE_SURFACES:
                continue
            knows_tkras = self._data.has_volume and mesh.frame != "tkras"
            data = mesh._data.in_frame("tkras") if knows_tkras else mesh._data
            sigma = sigmas[name]
            list_.append({"rr": data.vertices / 1000, "tris": data.faces.astype(np.int32),
                          "np": len(data.vertices), "ntri": len(data.faces),
                          "id": _MNE_SURFACES[name], "sigma": sigma, "coord_frame": _MNE_MRI})
        return list_

    def save(self, folder: Any, *, replace: bool = False, units: str = "mm", frame: str = "ras",
             gifti: bool = False, vtp: bool = False, fif: bool = False, fieldtrip: bool = False,
             brainstorm: bool = False, simnibs: bool = False, bem_fmm: bool = False, besa: bool = False) -> None:
        """Write the folder that adaptiso-bem writes: files for FreeSurfer, MNE and OpenMEEG,
        electrodes where there are, a README.md that says how to use them, and report.json.

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
        fif, fieldtrip, brainstorm, simnibs, bem_fmm, besa : bool
            Write the files of MNE (bem.fif; head-dense.fif and head-sparse.fif of a model made with
            ``head_shape=True``), FieldTrip, Brainstorm, SimNIBS, BEM-FMM and BESA too, as the
            program's options of these names do. BESA's needs landmarks.

        Raises
        ------
        Error
            The folder is there and may not be replaced, or can't be written.
        """
        target = os.path.realpath(checked_path("folder", folder))
        options: Dict[str, Any] = {"units": word("units", units, ("mm", "m")),
                                   "frame": word("frame", frame, ("ras", "lps", "tkras"))}
        for name, value in (("gifti", gifti), ("vtp", vtp), ("fif", fif), ("fieldtrip", fieldtrip),
                            ("brainstorm", brainstorm), ("simnibs", simnibs), ("bem_fmm", bem_fmm), ("besa", besa)):
            options[name] = flag(name, value)
        if not self._data.has_model:
            raise Error("there is no model to save")
        if frame == "tkras" and not self._data.has_volume:
            raise Error("frame tkras: the model does not know its image; give volume= to bem")
        if besa and not self._data.landmarks:
            raise Error("besa: the model has no landmarks; give landmarks= to bem")
        if not flag("replace", replace) and os.path.isdir(target) and os.listdir(target):
            raise Error(f"{target}: exists and is not empty; replace=True replaces a model")
        self._data.write(target, options, replace)

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

    def __copy__(self) -> "HeadModel":
        return self  # nothing of it changes

    def __deepcopy__(self, memo: Any) -> "HeadModel":
        return self

    def __reduce__(self) -> Tuple[Any, ...]:
        data = self._data
        state = {name: getattr(data, name) for name in
                 ("has_model", "failure", "warnings", "has_volume", "has_head_shape", "electrodes",
                  "landmarks")}
        state["meshes"] = list(self.surfaces.values())
        state["check_text"], state["report_text"] = data.check(self._threads), data.report()
        return _unpickled, (state, self._threads)

    def __repr__(self) -> str:
        if not self._data.has_model:
            return f"<adaptiso.HeadModel: none: {self._data.failure}>"
        sizes = ", ".join(f"{name} of {len(mesh.vertices):,} vertices"
                         for name, mesh in self.surfaces.items())
        guessed = any(warning.code == "guessed-brain" for warning in self._data.warnings)
        return f"<adaptiso.HeadModel: {sizes}{'; the brain was guessed' if guessed else ''}>"


class _Source(NamedTuple):
    """Input of a model, for C++."""

    kind: str
    images: List[Samples]
    masks: Dict[str, Samples]
    pial: List[Mesh]
    white: List[Mesh]
    sources: List[Mesh]
    surfaces: List[Mesh]
    inputs: List[List[str]]
    warnings: List[Warned]

    def as_dict(self) -> Dict[str, Any]:
        """Arguments for C++."""
        return {"kind": self.kind, "images": [image.volume for image in self.images],
                "masks": {name: image.volume for name, image in self.masks.items()},
                "pial": [mesh._data for mesh in self.pial],
                "white": [mesh._data for mesh in self.white],
                "sources": [mesh._data for mesh in self.sources],
                "surfaces": [mesh._data for mesh in self.surfaces], "inputs": self.inputs,
                "warnings": self.warnings}


@takes("bem")
def bem(t1: Any = None, *, brain_mask: Any = None, aseg: Any = None, lesion: Any = None,
        pial: Optional[Sequence[Any]] = None, white: Optional[Sequence[Any]] = None, labels: Any = None,
        tissues: Union[str, Mapping[str, Sequence[int]], None] = None, head_mask: Any = None,
        probabilities: Optional[Sequence[Any]] = None, ct: Any = None,
        surfaces: Union[Sequence[Any], Mapping[str, Any], None] = None, volume: Any = None,
        input_coordinates: Union[str, Sequence[Optional[str]], None] = None,
        affine: Any = None, layers: int = 3, vertices: Union[int, Sequence[int], None] = None,
        edge_length: Optional[Tuple[float, float]] = None, meg: bool = False,
        min_gap: Union[float, Sequence[float]] = (2, 2, 1, 1), conductivity: Optional[Sequence[float]] = None,
        electrodes: Union[Mapping[str, Point], Any] = None, electrodes_in: Optional[str] = None,
        montage: Optional[str] = None, landmarks: Union[Mapping[str, Point], str, None] = None,
        sources: Optional[Sequence[Any]] = None, head_shape: bool = False,
        tetrahedra: Optional[str] = None, threads: int = 0,
        progress: Optional[Progress] = None, **numbers: Unpack[BemOptions]) -> HeadModel:
    """Make the nested surfaces of a head model: inner skull, outer skull, outer skin, with four
    layers the brain, with five the white matter; electrodes on the skin.

    Does what the program adaptiso-bem does: the same samples and options give the same surfaces, to the
    byte, for any number of threads. One of `t1`, `labels`, `probabilities`, `ct` and `surfaces` is
    given; images as for `surface`.

    Parameters
    ----------
    t1 : image, optional
        A T1-weighted MRI of the whole head.
    brain_mask : image, optional
        With `t1`: the brain, from any brain extraction (a mask, or the T1 with the skull removed).
        Without it the brain is guessed, good enough for a clean T1; look at the result.
    aseg : image, optional
        With `t1`: FreeSurfer's or FastSurfer's aseg: the brain mask where `brain_mask` is missing, and with
        four or five layers the surfaces of brain and white matter.
    lesion : image, optional
        With `t1`: a mask of lesions within the skull; they count as brain, whatever their values.
    pial : sequence, optional
        With `t1`: the cortex, as `surfaces`: ``["lh.pial", "rh.pial"]``. The inner skull holds it,
        and with four or five layers the brain's own surface.
    white : sequence, optional
        With `t1` and five layers: the white matter's surfaces, as `pial`, besides `aseg` or instead.
    labels : image, optional
        A segmentation; `tissues` says of what.
    tissues : str or dict, optional
        With `labels`: whose they are, by a preset of adaptiso-bem ("charm", ...), or ``{"brain": [1, 2, 3], "skull": [4], "scalp": [5]}``; CSF
        belongs to the brain, or with four layers is named apart: ``"csf": [3]``, with
        five the white matter too: ``"white": [1]``. Spongy bone (``"spongy": [8]``) counts as skull, and `save` writes its surface.
    head_mask : image, optional
        With `labels`: what is not 0 there lies within the skin; needed where no label is the
        scalp's, as with "totalsegmentator" (its task body, on the same grid).
    probabilities : sequence of images, optional
        Tissue maps in SPM's order: grey, white, CSF, bone, soft tissue.
    ct : image, optional
        A CT of the whole head, in Hounsfield units.
    surfaces : sequence or dict, optional
        Ready surfaces from inside out, each a Mesh, (vertices, faces), a path, or an object with
        vertices and faces; of a dict (as ``HeadModel.surfaces``) its values. Checked, mended where need be, kept as they are where not.
    volume : image, optional
        With `surfaces`: the image they belong to, for tkRAS.
    input_coordinates : {"ras", "lps", "tkras", "voxel"}, or a sequence of one for each, optional
        The frame of the files of `surfaces`, `pial`, `white` and `sources`, in this order, whatever the file
        says of it.
    affine : array_like of shape (4, 4), optional
        Of images that are plain arrays: voxel indices to scanner RAS mm.
    layers : {3, 4, 5, 1}
        4: the brain's own surface as well, CSF between it and the inner skull; 5: the white
        matter's within it; 1: as `meg`.
    vertices : int or sequence of int, optional
        Of each surface, evenly spread, 42 to 200,000; or one number for each, from inside out.
        Default: 2562; with four or five layers by the layers' thickness, 10,000 in all at most.
    edge_length : (float, float), optional
        Shortest and longest edge, mm: short where a surface bends or another is near.
    meg : bool
        The inner skull alone.
    min_gap : float or sequence of two to four floats
        Least thickness of skull, scalp and, with four layers, CSF, with five grey matter, mm, 0.5 to 20; guaranteed.
    **options
    conductivity : sequence of three to five floats, optional
        Of brain, skull and scalp, S/m (default: 0.3, 0.006, 0.3); with four layers of brain, CSF,
        skull and scalp (CSF: 1.79); with five of white and grey matter, CSF, skull and scalp
        (default: 0.126, 0.275, 1.654, 0.01, 0.465).
    electrodes : path or mapping of str to (float, float, float), optional
        Electrodes, moved onto the skin: a file (BIDS, FIFF and those of other toolboxes), or
        places by name, scanner RAS mm. Those without a place (None, NaN) are left out with a warning.
    electrodes_in : {"ras", "lps", "tkras"}, optional
        The frame of the file. Default: what it says; else by its nasion and ears; else
        it is refused.
    montage : str, optional
        Instead of `electrodes`: the positions of this system or cap, computed on the skin: "10-20", "10-10", "10-05",
        "biosemi64", "GSN-HydroCel-128", ... as MNE-Python names them.
    landmarks : mapping of "nasion", "left_ear", "right_ear" to (float, float, float), or "guess"
        Scanner RAS mm; "inion" may be among them. Default: those of the electrodes' file; guessed,
        with a warning, where they are needed or this is "guess".
    sources : sequence, optional
        The cortex, as `surfaces`: ``["lh.white", "rh.white"]``: dipoles along its normals, none
        nearer to the innermost surface than one edge; `save` writes dipoles.txt (OpenMEEG) and
        sources-src.fif (MNE).
    head_shape : bool
        Keep the skin alone as well, as finely as it was found, for ``save(folder, fif=True)``.
    tetrahedra : {"tetgen", "gmsh"}, optional
        Fill the layers with tetrahedra by this program, which must be installed: ``report["tetrahedra"]``
        measures them, and `save` writes head.msh, head-4.1.msh, head.vtu, head.dgf and head.cond.
    threads, progress
        As for `surface`.

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
    given = {name: value for name, value in (
        ("t1", t1), ("labels", labels), ("probabilities", probabilities), ("ct", ct),
        ("surfaces", surfaces), ("brain_mask", brain_mask), ("aseg", aseg), ("lesion", lesion),
        ("head_mask", head_mask), ("pial", pial), ("white", white), ("volume", volume), ("tissues", tissues),
        ("input_coordinates", input_coordinates), ("electrodes", electrodes),
        ("electrodes_in", electrodes_in), ("montage", montage), ("landmarks", landmarks),
        ("sources", sources), *numbers.items())
        if value is not None}
    options: Dict[str, Any] = {
        "layers": count("layers", layers),
        "meg": flag("meg", meg),
        "vertices": [] if vertices is None else [
            count("vertices", part) for part in _one_or_more("vertices", vertices)],
        "edge_length": None if edge_length is None else _numbers("edge_length", edge_length),
        "min_gap": _numbers("min_gap", min_gap if isinstance(min_gap, (tuple, list)) else [min_gap]),
        "conductivity": None if conductivity is None else _numbers("conductivity", conductivity),
        "head_shape": flag("head_shape", head_shape),
        "input_coordinates": ([input_coordinates] if isinstance(input_coordinates, str)
                              else [frame for frame in input_coordinates or () if frame]),
        **checked("bem", numbers),
        **_electrodes(electrodes, electrodes_in, montage, landmarks),
    }
    mesher = None if tetrahedra is None else word("tetrahedra", tetrahedra, MESHERS)
    element_mm = options.pop("element_size", 5.0)
    if mesher and not shutil.which(mesher):
        raise Error(f"tetrahedra {mesher}: {mesher} is not installed; on Debian: apt install {mesher}")
    given_threads, callback = checked_threads(threads), checked_progress(progress)
    named = _tissues(tissues)
    _adaptiso.check_bem(list(given), named, options,
                        0 if surfaces is None else len(_listed_surfaces("surfaces", surfaces)),
                        0 if sources is None else len(_listed_surfaces("sources", sources)))
    source = _source(given, input_coordinates, affine)
    with contextlib.ExitStack() as meanwhile:
        for image in (*source.images, *source.masks.values()):
            meanwhile.enter_context(read_only(image.user))
        data = _adaptiso.make_bem({**source.as_dict(), **named}, options, given_threads, callback)
    if mesher and data.has_model:
        _fill(data, mesher, element_mm)
    warn(data.warnings[len(source.warnings):], "bem")
    model = HeadModel(data, given_threads)
    if not data.has_model:
        raise NoModel(f"no model: {data.failure}", model)
    return model


def _fill(data: _adaptiso.HeadModelData, mesher: str, element_mm: float) -> None:
    """Fills a model's layers with tetrahedra, by a program in a folder of its own. \\raises Error"""
    begin = time.monotonic()
    program, arguments, inputs, names = data.mesher_run(mesher, element_mm)
    with tempfile.TemporaryDirectory(prefix="adaptiso-") as folder:
        for name, text in inputs:
            pathlib.Path(folder, name).write_text(text, encoding="ascii")
        done = subprocess.run([program, *arguments], cwd=folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        made = [pathlib.Path(folder, name) for name in names]
        results = [path.read_bytes() if path.is_file() else b"" for path in made]
    reason = f"exit code {done.returncode}" if done.returncode else None
    data.take_tetrahedra(mesher, element_mm, results, reason, time.monotonic() - begin)


def _source(given: Dict[str, Any], input_coordinates: Any, affine: Any) -> _Source:
    """The input that is given. \\raises Error"""
    kind = next(name for name in ("t1", "labels", "probabilities", "ct", "surfaces")
                if name in given)
    source = _Source(kind, [], {}, [], [], [], [], [], [])
    if kind != "surfaces":
        images = listed(kind, given[kind]) if kind == "probabilities" else [given[kind]]
        source.images.extend(_image(kind, image, affine, source) for image in images)
    elif "volume" in given:
        source.images.append(_image("volume", given["volume"], affine, source))
    for name in ("brain_mask", "aseg", "lesion", "head_mask"):
        if name in given:
            source.masks[name] = _image(name, given[name], affine, source)
    groups = [(name, meshes, _listed_surfaces(name, given[name]))
              for name, meshes in (("surfaces", source.surfaces), ("pial", source.pial), ("white", source.white),
                                   ("sources", source.sources)) if name in given]
    frames = iter(stated_frames(input_coordinates,
                                [surface for _, _, group in groups for surface in group]))
    for name, meshes, group in groups:
        meshes.extend(_surfaces(name, [(surface, next(frames)) for surface in group], source))
    return source


def _image(name: str, image: Any, affine: Any, source: _Source) -> Samples:
    """An image as bem takes it, i fastest as files have it. \\raises Error"""
    try:
        samples = samples_of(image, affine if isinstance(image, np.ndarray) else None, True)
    except Error as error:
        text = str(error)
        raise Error(name + text[5:] if text.startswith("image") else f"{name}: {text}") from None
    role = "lesion mask" if name == "lesion" else name.replace("_", " ")
    source.inputs.append([samples.file, role, samples.format])
    source.warnings.extend(warning.of(samples.file or role) for warning in samples.warnings)
    return samples


def _listed_surfaces(name: str, surfaces: Any) -> List[Any]:
    return listed(name, surfaces.values() if isinstance(surfaces, Mapping) else surfaces)


def _surfaces(name: str, framed: List[Tuple[Any, Optional[str]]], source: _Source) -> List[Mesh]:
    """Meshes of surfaces, each with the frame stated for it. \\raises Error"""
    role = {"surfaces": "surface", "pial": "pial surface", "white": "white surface", "sources": "source surface"}[name]
    meshes = []
    for surface, stated in framed:
        file = base_name(checked_path(name, surface)) if is_path(surface) else ""
        source.inputs.append([file, role, "file" if file else type(surface).__name__])
        meshes.append(Mesh._of(mesh_data_of(surface, False, stated, name)))
    require_known_frames([mesh.frame for mesh in meshes],
                         [f"{name}: number {n + 1}" for n in range(len(meshes))])
    if source.images and any(mesh.frame == "unknown" for mesh in meshes):
        raise Error(f"{name}: are of files that don't say their coordinate frame, so where they lie "
                    "in the image is not known; state it by input_coordinates=")
    if len({mesh._data.frame for mesh in meshes}) > 1:
        raise Error(f"{name}: are not in one frame; load those in tkras with volume=")
    return meshes


def _one_or_more(name: str, value: Any) -> List[Any]:
    """The parts of a sequence, or the one value: an array without axes is one. \\raises Error"""
    is_sequence = hasattr(value, "__iter__") and getattr(value, "ndim", 1) > 0
    return listed(name, value) if is_sequence else [value]


def _numbers(name: str, value: Any) -> List[float]:
    return [number(name, part) for part in listed(name, value)]


def _point(name: str, value: Any) -> Point:
    parts = listed(name, value, "3 numbers")
    if len(parts) != 3:
        raise Error(f"{name} {shown(value)}: must be 3 numbers")
    x, y, z = (number(name, part) for part in parts)
    return x, y, z


def _place(name: str, value: Any) -> Optional[Point]:
    """None without a place: None, or NaN as MNE has it. \\raises Error"""
    if value is None:
        return None
    parts = listed(name, value, "3 numbers")
    is_missing = any(isinstance(part, (float, np.floating)) and math.isnan(part) for part in parts)
    return None if is_missing else _point(name, parts)


def _electrodes(electrodes: Any, frame: Any, montage: Any, landmarks: Any) -> Dict[str, Any]:
    """Electrodes and landmarks, for C++. \\raises Error"""
    options: Dict[str, Any] = {"electrodes": None, "electrodes_name": "", "electrodes_in": None,
                               "montage": None, "landmarks": None, "inion": None,
                               "guesses_landmarks": landmarks == "guess"}
    if isinstance(electrodes, Mapping):
        for name in electrodes:
            if not isinstance(name, str) or not name.isprintable() or not name:
                raise Error(f"electrodes {shown(name)}: must be text")
        options["electrodes"] = [(name, _place(f"electrodes, {name}", place))
                                 for name, place in electrodes.items()]
        options["electrodes_name"] = "electrodes"
    elif electrodes is not None:
        options["electrodes"] = checked_path("electrodes", electrodes)
        options["electrodes_name"] = base_name(options["electrodes"])
    if frame is not None:
        if isinstance(electrodes, Mapping):
            raise Error("electrodes_in: needs a file of electrodes")
        options["electrodes_in"] = word("electrodes_in", frame, ("ras", "lps", "tkras"))
    if montage is not None:
        options["montage"] = word("montage", montage, MONTAGES)
    if isinstance(landmarks, Mapping) and set(landmarks) - {"inion"} == set(_LANDMARKS):
        options["landmarks"] = [_point(name, landmarks[name]) for name in _LANDMARKS]
        if "inion" in landmarks:
            options["inion"] = _point("inion", landmarks["inion"])
    elif landmarks is not None and not options["guesses_landmarks"]:
        raise Error(f"landmarks {shown(landmarks)}: must be 'guess', or a dict of "
                    + ", ".join(_LANDMARKS))
    return options


def _tissues(value: Any) -> Dict[str, Any]:
    """A preset's name, or the labels of tissues, for C++. \\raises Error"""
    if value is None or isinstance(value, str):
        return {"preset": "" if value is None else word("tissues", value, PRESETS), "tissues": {}}
    if not isinstance(value, Mapping) or not set(value) <= set(TISSUES):
        raise Error(f"tissues {shown(value)}: must be one of {', '.join(PRESETS)}, or a dict of "
                    "white, brain, csf, skull and scalp")
    return {"preset": "", "tissues": {
        name: [count(f"tissues, {name}", label, -2**63, 2**63 - 1)
               for label in _one_or_more(f"tissues, {name}", labels)]
        for name, labels in value.items()}}
