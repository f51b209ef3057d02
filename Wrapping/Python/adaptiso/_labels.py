"""Surfaces of all regions of a label map at once, from one set of walls."""

from __future__ import annotations

import difflib
import fnmatch
import json
from typing import (TYPE_CHECKING, Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple,
                    Union)

import numpy as np
import numpy.typing as npt

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, count, is_path, listed, path as checked_path,
                         progress as checked_progress, shown, threads as checked_threads, warn, word)
from ._images import Samples, base_name, prepared, read_only, samples_of
from ._mesh import IN_VOXELS, Mesh, is_identity
from ._options import checked, takes
from ._triangles import FRAMES, Triangles

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import LabelsOptions

LabelArray = npt.NDArray[np.int32]
#: Larger labels coincide in single precision; 0 is the outside.
_MOST = 2147483520


class Region(NamedTuple):
    """One region of a label map: an entry of `LabelSurfaces.regions`.

    Attributes
    ----------
    label : int
    name : str
        By the table of names, or "region 5".
    color : (int, int, int)
        Red, green, blue, 0 to 255: the table's, or one far from those of labels near it.
    volume : float
        mm3 that the region's surface encloses.
    area : float
        mm2.
    vertices, triangles : int
        Of its surface.
    euler_characteristic : int
        2 for a ball, 0 for a ring, 4 for a shell.
    components : int
        Pieces of the surface; the wall of a cavity is one of its own.
    neighbours : dict of int to float
        mm2 shared with each other label, 0 (the outside) among them.
    """

    label: int
    name: str
    color: Tuple[int, int, int]
    volume: float
    area: float
    vertices: int
    triangles: int
    euler_characteristic: int
    components: int
    neighbours: Dict[int, float]


class LabelSurfaces(Triangles[_adaptiso.LabelData]):
    """The walls between the regions of a label map, each stored once: what `labels` makes.

    Where two regions meet, their surfaces have the same triangles. Nothing of it changes, so
    threads may share it; it pickles.

    `vertices` are in scanner RAS mm (of an array without affine: voxels); `faces` run
    counter-clockwise seen from the second region: normals point from `label0` into `label1`, the
    larger label but for 0, which comes last.
    """

    __slots__ = ("_names", "_masks", "_report", "_regions")

    def __init__(self, data: _adaptiso.LabelData, names: "_Names", masks: str = "null") -> None:
        self._data = data
        self._names = names
        self._masks = masks
        self._report: Optional[Dict[str, Any]] = None
        self._regions: Optional[Dict[int, Region]] = None

    @property
    def label0(self) -> LabelArray:
        """int32, shape (m,): the region that a face's normal points out of; a read-only view."""
        return self._data.label0

    @property
    def label1(self) -> LabelArray:
        """int32, shape (m,): the region that a face's normal points into; a read-only view."""
        return self._data.label1

    @property
    def report(self) -> Dict[str, Any]:
        """``walls`` and ``regions`` as ``adaptiso-labels --json`` has them, and ``masks`` as its
        ``input`` has them: None of a map."""
        if self._report is None:
            report = json.loads(self._data.report)
            report["masks"] = json.loads(self._masks)
            entries = report["regions"]
            for entry, (name, color) in zip(entries, self._names.of(
                    [entry["label"] for entry in entries])):
                entry["name"], entry["color"] = name, "#%02x%02x%02x" % color
            self._report = report
        return self._report

    @property
    def regions(self) -> Dict[int, Region]:
        """By label: names, measures, neighbours."""
        if self._regions is None:
            self._regions = {entry["label"]: self._region_of(entry)
                             for entry in self.report["regions"]}
        return dict(self._regions)

    def _region_of(self, entry: Dict[str, Any]) -> Region:
        red, green, blue = bytes.fromhex(entry["color"][1:])
        neighbours = {other["label"]: other["areaMm2"] for other in entry["neighbours"]}
        return Region(entry["label"], entry["name"], (red, green, blue), entry["volumeMm3"], entry["areaMm2"], entry["vertices"],
                      entry["triangles"], entry["eulerCharacteristic"], entry["components"],
                      neighbours)

    @property
    def error_bound(self) -> float:
        """Proved: no point of a wall at full resolution is farther (mm) from the same wall here,
        nor the other way round."""
        return float(self.report["walls"]["errorBoundMm"])

    @property
    def walls(self) -> Mesh:
        """All walls as one mesh: faces in the order of `label0` and `label1`. More than two faces
        meet at edges where regions do."""
        return Mesh._of(self._data.walls())

    def region(self, label: Union[int, str]) -> Mesh:
        """The surface of one region: closed, outward; its vertices are those of `vertices`, to the
        bit, in their order.

        Parameters
        ----------
        label : int or str
            Number or name.

        Raises
        ------
        Error
            There is no such region, or several have the name.
        """
        if isinstance(label, str):
            names = _Names({region.label: (region.name, None) for region in self.regions.values()})
            found = names.labels_of(label, "label")
            if len(found) > 1:
                raise Error(f"label {shown(label)}: is the name of {', '.join(map(str, found))}; give a number")
            label = found[0]
        number = count("label", label, -_MOST, _MOST)
        if number not in self.regions:
            raise Error(f"label {number}: is no region here")
        mesh = self._data.region(number)
        mesh.error_bound = self.error_bound
        return Mesh._of(mesh)

    def plot(self, file: Any = None, **options: Any) -> None:
        """Show or draw all walls, in one colour, as `Mesh.plot` does a mesh."""
        self.walls.plot(file, **options)

    def save(self, path: Any, frame: Optional[str] = None) -> None:
        """Write the walls as a .vtp with the arrays label0 and label1 of its cells, or all regions
        with names and colours as .glb or .3mf: the files of the program adaptiso-labels, to the byte.
        The file is whole or not there. One region is saved by ``region(label).save(path)``, in any
        format.

        Parameters
        ----------
        path : str or path
            With the extension .vtp, .glb or .3mf.
        frame : {"ras", "lps", "tkras", "voxel"}, optional
            Of the points written; default "ras". Only .vtp holds voxel indices.

        Raises
        ------
        Error
            Another extension, a frame that can't be had, a file that can't be written.
        """
        name = checked_path("path", path)
        if name.lower().endswith((".glb", ".3mf")):
            if frame is not None:
                word("frame", frame, FRAMES[:3])
            self._data.write_regions(name, frame, [(region.label, region.name, region.color)
                                                   for region in self.regions.values()])
            return
        if not name.lower().endswith(".vtp"):
            raise Error(f"{name}: walls are saved as .vtp, all regions as .glb or .3mf; "
                        "region(label).save(path) takes others")
        self._save(name, frame)

    def __len__(self) -> int:
        return len(self.regions)

    def __repr__(self) -> str:
        unit, frame = ("", IN_VOXELS) if is_identity(self._data.affine) else (" mm", "RAS mm")
        return (f"<adaptiso.LabelSurfaces of {len(self):,} regions, {len(self.faces):,} triangles "
                f"in walls, within {self.error_bound:.4g}{unit}, {frame}>")

    def __eq__(self, other: object) -> bool:
        """The same vertices, faces and labels."""
        if not isinstance(other, LabelSurfaces):
            return NotImplemented
        return (np.array_equal(self.vertices, other.vertices)
                and np.array_equal(self.faces, other.faces)
                and np.array_equal(self.label0, other.label0)
                and np.array_equal(self.label1, other.label1))

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> Tuple[Any, ...]:
        data = self._data
        both = np.stack([data.label0, data.label1], axis=1)
        return _unpickled, (data.vertices, data.faces, both, data.shape, data.affine, data.report,
                            self._names.table, self._masks)


class _Names:
    """Names and colours of labels."""

    def __init__(self, table: Mapping[int, Tuple[str, Optional[Tuple[int, int, int]]]]) -> None:
        self.table = dict(table)

    def of(self, labels: Sequence[int]) -> List[Tuple[str, Tuple[int, int, int]]]:
        """Names and colours of the labels of a map."""
        entries = [self.table.get(label, ("", None)) for label in labels]
        colors = _adaptiso.label_colors(labels, [color for _, color in entries])
        return [(name or f"region {label}", (red, green, blue))
                for label, (name, _), (red, green, blue) in zip(labels, entries, colors)]

    def labels_of(self, name: str, argument: str = "labels") -> List[int]:
        """\\raises Error"""
        known = {label: entry[0] for label, entry in self.table.items() if label != 0}
        found = ([label for label, other in known.items() if other == name]
                 or [label for label, other in known.items() if other.lower() == name.lower()]
                 or [label for label, other in known.items() if fnmatch.fnmatchcase(other.lower(), name.lower())])
        if found:
            return found
        near = [other for other in known.values() if name.lower() in other.lower()][:5]
        near = near or difflib.get_close_matches(name, known.values())
        raise Error(f"{argument} {shown(name)}: no label has this name; "
                    + (f"did you mean {', '.join(near)}?" if near
                       else "names= takes a table of names" if not known else "see regions"))


@takes("labels")
def labels(image: Any, *, labels: Optional[Iterable[Union[int, str]]] = None,
           names: Union[Mapping[int, str], Any] = None,
           priority: Union[str, Sequence[str], None] = None, segments: Optional[str] = None,
           affine: Any = None, threads: int = 0, progress: Optional[Progress] = None,
           **options: Unpack[LabelsOptions]) -> LabelSurfaces:
    """Make the surfaces of all regions of a segmentation at once: neighbours share one wall.

    Each region's surface is closed, outward and 2-manifold; no two triangles of all walls cross;
    every voxel's centre lies in the region of its label. The same samples, affine and options give
    the bytes that the program adaptiso-labels gives, for any number of threads.

    Parameters
    ----------
    image : ndarray of shape (I, J, K), nibabel, SimpleITK or ITK image, path, or list of paths
        Whole numbers, of any type; 0 is what lies outside of all regions. As for `surface`; an
        array in C order is copied here. A folder of masks, a file for each region, or a list of
        such files is joined to one map, each mask a region that goes by its file's name.
    **options
    labels : iterable of int or str, optional
        The regions that are wanted, by number or name; time and memory go with their walls. Default:
        all.
    names : path or mapping of int to str, optional
        Names by label, or a table of names and colours in a format that adaptiso-labels
        takes. Default: of a path, what lies beside the file, or in it (3D
        Slicer's segments, the LabelTable of a NIfTI extension).
    priority : {"largest", "smallest"} or sequence of str, optional
        Which mask keeps a voxel that several hold: by size, or the first of these names. Default:
        the last by name.
    segments : {"all"}, optional
        Take all segments of a DICOM segmentation, or all layers of a 3D Slicer .seg.nrrd, for masks.
    affine : array_like of shape (4, 4), optional
        Takes voxel indices to scanner RAS mm. Default: the image's own; of an array the identity.
    threads, progress
        As for `surface`.

    Returns
    -------
    LabelSurfaces

    Raises
    ------
    Error
        An image that is no label map, labels that it does not have, an option that can't be used.

    Examples
    --------
    Two halves of a box:

    >>> import adaptiso, numpy as np
    >>> box = np.zeros((12, 8, 8), np.uint8)
    >>> box[2:6, 2:6, 2:6], box[6:10, 2:6, 2:6] = 1, 2
    >>> walls = adaptiso.labels(box, names={1: "left", 2: "right"})
    >>> [region.name for region in walls.regions.values()]
    ['left', 'right']
    >>> sorted(walls.regions[1].neighbours) == [0, 2]
    True
    >>> walls.region(1).is_closed, bool(adaptiso.check(walls.region(2)))
    (True, True)
    """
    aims = checked("labels", options)
    checked_threads(threads)
    checked_progress(progress)
    joined = _joined(image, names, priority, segments, affine)
    table, masks = (joined.names, joined.masks) if joined else (_names(names, image), "null")
    chosen = _chosen(labels, table)
    samples = joined.samples if joined else samples_of(image, affine, True)
    subject = samples.file or "image"
    with read_only(samples.user):
        data = _adaptiso.make_labels(samples.volume, aims, chosen, threads, progress, subject,
                                     _advice_on(samples))
    if len(data.faces) == 0:
        raise Error(f"{subject}: holds no label: all voxels are 0")
    return LabelSurfaces(data, table, masks)


class _Joined(NamedTuple):
    """Masks that were joined to a map."""

    samples: Samples
    names: _Names
    masks: str  #: JSON


def _joined(image: Any, names: Any, priority: Any, segments: Any, affine: Any) -> Optional[_Joined]:
    """The map that masks make; None where `image` is a map. \\raises Error"""
    if segments is not None:
        word("segments", segments, ["all"])
    is_list = isinstance(image, (list, tuple)) and len(image) > 0 and all(map(is_path, image))
    if not is_list and not is_path(image):
        if priority is not None or segments is not None:
            raise Error("priority, segments: are for a folder of masks, their files, or a segmentation's file")
        return None
    if is_list and segments is not None:
        raise Error("segments: takes those of one file, and a list of files was given")
    if segments is not None and names is not None:
        raise Error("segments: they bring their names and numbers; leave names out")
    files = [checked_path("image", file) for file in (image if is_list else [image])]
    kind = "files" if is_list else "folder" if segments is None else "segments"
    by, listed_names = _priority(priority)
    table = checked_path("names", names) if names is not None and not isinstance(names, Mapping) else ""
    found = _adaptiso.join_masks(files, kind, by, listed_names, table)
    if found is None:
        if priority is not None:
            raise Error(f"priority: is for masks, and {base_name(files[0])} is one image")
        return None
    if isinstance(names, Mapping):
        raise Error("names: masks go by their files' names; a table of names gives them numbers")
    if affine is not None:
        raise Error("affine: a file has its own")
    array, own, format, warnings, entries, masks = found
    subject = "image" if is_list else base_name(files[0])
    warn(warnings, file=subject)
    return _Joined(prepared(array, own, subject, format, warnings),
                   _Names({label: (name, None if color is None else (color[0], color[1], color[2]))
                           for label, name, color in entries}), masks)


def _priority(priority: Any) -> Tuple[str, List[str]]:
    """Its word, and the names of a list. \\raises Error"""
    if priority is None:
        return "name", []
    if isinstance(priority, str):
        return word("priority", priority, ["largest", "smallest"]), []
    rule = '"largest", "smallest" or a sequence of names'
    names = listed("priority", priority, rule)
    if not all(isinstance(name, str) for name in names):
        raise Error(f"priority {shown(priority)}: must be {rule}")
    return "list", names


def _advice_on(samples: Samples) -> str:
    """What may have made labels of an image others than whole numbers."""
    if samples.scaling:
        return (f"its header scales the stored values ({samples.scaling}): save a label map as "
                "integers, without scaling")
    return "save a label map as integers, without scaling (scl_slope)"


def _chosen(labels: Any, names: _Names) -> List[int]:
    if labels is None:
        return []
    parts = listed("labels", labels, "a sequence of whole numbers and names")
    chosen = sorted({number for label in parts
                     for number in (names.labels_of(label) if isinstance(label, str)
                                    else [count("labels", label, -_MOST, _MOST)])})
    if not chosen or 0 in chosen:
        raise Error(f"labels {shown(labels)}: must be one or more, without 0, the outside")
    return chosen


def _names(names: Any, image: Any) -> _Names:
    """\\raises Error"""
    if isinstance(names, Mapping):
        for label, name in names.items():
            if not isinstance(name, str):
                raise Error(f"names {shown(name)}: must be text")
            count("names", label, -_MOST, _MOST)
        return _Names({int(label): (name, None) for label, name in names.items()})
    if names is not None:
        file = checked_path("names", names)
        entries, warnings = _adaptiso.read_label_table(file)
    elif is_path(image):
        file = checked_path("image", image)
        entries, warnings = _adaptiso.find_label_table(file)
    else:
        return _Names({})
    warn(warnings, file=base_name(file))
    return _Names({value: (name, None if color is None else (color[0], color[1], color[2]))
                   for value, name, _, color in entries})


def _unpickled(vertices: Any, faces: Any, both: Any, shape: Any, affine: Any, report: str,
               table: Any, masks: str = "null") -> LabelSurfaces:
    data = _adaptiso.LabelData.from_arrays(vertices, faces, np.ascontiguousarray(both, np.int32),
                                           list(shape), affine, report)
    return LabelSurfaces(data, _Names(table), masks)
