"""Checks of meshes: soundness, nesting, distance."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import (Progress, Warned, count, flag, is_path, listed, path as checked_path,
                         progress as checked_progress, shown, threads as checked_threads, warn, word)
from ._images import base_name
from ._mesh import mesh_data_of, require_known_frames, stated_frames, whole
from ._options import checked, takes

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import CheckNestedOptions, CheckOptions

PROFILES = ("bem", "print", "view")


class _Report:
    """A report as a value."""

    __slots__ = ("report",)

    def __init__(self, report: Dict[str, Any]) -> None:
        self.report = report

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return NotImplemented
        return self.report == other.report

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> "tuple[Any, ...]":
        return type(self), (self.report,)


class Check(_Report):
    """Result of `check` and `check_nested`; true when all required checks hold.

    Attributes
    ----------
    report : dict
        Everything, as ``adaptiso-check --json`` has it: of one surface an entry of its
        ``surfaces``, of nested ones ``surfaces`` and ``nesting``.
    """

    __slots__ = ()

    @property
    def passed(self) -> bool:
        """All that is required holds."""
        return bool(self.report["passed"])

    def _judged(self) -> "List[tuple[str, Dict[str, Any]]]":
        if "surfaces" not in self.report:
            return [("", self.report)]
        pairs = self.report["nesting"]["pairs"]
        return ([(surface["name"], surface) for surface in self.report["surfaces"]]
                + [(f"{pair['inner']} in {pair['outer']}", pair) for pair in pairs])

    @property
    def failed(self) -> List[str]:
        """Names of what is required and does not hold; of nested surfaces "inner_skull: closed"."""
        return [f"{subject}: {name}" if subject else str(name)
                for subject, judged in self._judged() for name in judged["failed"]]

    @property
    def findings(self) -> List[str]:
        """The same in words, with the place."""
        return [(f"{subject}: " if subject else "") + f"{check['name']}: {check['finding']}"
                for subject, judged in self._judged() for check in judged["checks"]
                if check["name"] in judged["failed"]]

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        if self.passed:
            return "<adaptiso.Check: passed>"
        return f"<adaptiso.Check: failed: {', '.join(self.failed)}>"


class Comparison(_Report):
    """The distance between two surfaces, both ways together, mm: of points spread evenly over both.

    Attributes
    ----------
    report : dict
        ``a``, ``b``, ``distances`` and ``warnings`` as ``adaptiso-compare --json`` has them; the
        warnings go to the logger "adaptiso" as well.
    """

    __slots__ = ()

    def _of(self, key: str) -> float:
        return float(self.report["distances"]["combined"][key])

    @property
    def mean(self) -> float:
        """Mean distance, mm."""
        return self._of("meanMm")

    @property
    def rms(self) -> float:
        """Root mean square distance, mm."""
        return self._of("rmsMm")

    @property
    def p95(self) -> float:
        """The distance, mm, that 95 % of the points do not exceed."""
        return self._of("p95Mm")

    @property
    def p99(self) -> float:
        """The distance, mm, that 99 % of the points do not exceed."""
        return self._of("p99Mm")

    @property
    def max(self) -> float:
        """The largest distance measured, mm: of points and vertices."""
        return self._of("maxMm")

    @property
    def hausdorff(self) -> Tuple[float, float]:
        """The Hausdorff distance, mm, of all points of both: it is proved to lie between the two."""
        interval = self.report["distances"]["combined"]["hausdorff"]
        return float(interval["lowerMm"]), float(interval["upperMm"])

    def __repr__(self) -> str:
        return (f"<adaptiso.Comparison: mean {self.mean:.4g} mm, 95 % {self.p95:.4g} mm, "
                f"max {self.max:.4g} mm, proved at most {self.hausdorff[1]:.4g} mm>")


@takes("check")
def check(mesh: Any, faces: Any = None, profile: str = "print", *, input_coordinates: Optional[str] = None,
          threads: int = 0, **options: Unpack[CheckOptions]) -> Check:
    """Check whether a surface is sound: closed, manifold, oriented, without crossing triangles, of
    a plausible size.

    Parameters
    ----------
    mesh : Mesh, (vertices, faces), path, vtkPolyData, object with vertices and faces, or vertices
        mm, in any frame; may be broken in any way.
    faces : array_like of integers of shape (m, 3), optional
        Where `mesh` holds vertices alone; else the profile may stand here.
    profile : {"bem", "print", "view"}
        Use of the surface, which determines the required checks.
    **options
    input_coordinates : {"ras", "lps", "tkras", "voxel"}, optional
        The frame of a file's points, overriding the file's own.
    threads : int
        0: as many as the machine has.

    Returns
    -------
    Check

    Examples
    --------
    >>> import adaptiso
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    >>> points = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]
    >>> adaptiso.check((points, faces))
    <adaptiso.Check: passed>
    >>> adaptiso.check((points, faces[:3])).failed
    ['closed']
    """
    if isinstance(faces, str):
        faces, profile = None, faces
    mesh = whole(mesh, faces)
    rules = {"profile": word("profile", profile, PROFILES), **checked("check", options)}
    text = _adaptiso.check(mesh_data_of(mesh, True, stated_frames(input_coordinates, [mesh])[0]), rules,
                           checked_threads(threads))
    return Check(json.loads(text))


@takes("check_nested")
def check_nested(meshes: Union[Sequence[Any], Mapping[str, Any]], profile: str = "bem", *,
                 names: Optional[Sequence[str]] = None,
                 input_coordinates: Union[str, Sequence[Optional[str]], None] = None,
                 threads: int = 0, **options: Unpack[CheckNestedOptions]) -> Check:
    """Check surfaces that lie in each other, and each of them.

    Parameters
    ----------
    meshes : sequence of what `check` takes, or a dict of them by name
        From inside out; all in one frame. ``HeadModel.surfaces`` is such a dict.
    profile, threads
        As for `check`.
    **options
    names : sequence of str, optional
        Their names in findings; default the dict's keys, the files' names, or "surface 1" and so on.
    input_coordinates : {"ras", "lps", "tkras", "voxel"}, or a sequence of one for each, optional
        The frame of a file's points, overriding the file's own (None: as it says).

    Returns
    -------
    Check

    Raises
    ------
    Error
        Fewer than two surfaces, or frames that differ.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> i, j, k = np.indices((32, 32, 32))
    >>> ball = -np.sqrt((i - 15.5) ** 2 + (j - 15.5) ** 2 + (k - 15.5) ** 2)
    >>> inner, outer = adaptiso.surface(ball, -8), adaptiso.surface(ball, -12)
    >>> adaptiso.check_nested([inner, outer], "print")
    <adaptiso.Check: passed>
    >>> adaptiso.check_nested([outer, inner], "print").failed
    ['surface 1 in surface 2: strictlyNested']
    """
    if names is None and isinstance(meshes, Mapping):
        names = list(map(str, meshes))
    surfaces = listed("meshes", meshes.values() if isinstance(meshes, Mapping) else meshes,
                      "a sequence of surfaces, from inside out")
    if len(surfaces) < 2:
        raise Error(f"meshes: are {len(surfaces)}, must be two or more")
    told = names_of(surfaces, names)
    data = [mesh_data_of(mesh, not is_path(mesh), stated)
            for mesh, stated in zip(surfaces, stated_frames(input_coordinates, surfaces))]
    require_one_frame(data, surfaces, told)
    rules = {"profile": word("profile", profile, PROFILES), **checked("check_nested", options)}
    text = _adaptiso.check_nested(data, told, rules, checked_threads(threads))
    return Check(json.loads(text))


def compare(a: Any, b: Any, *, samples: int = 200000, symmetric: bool = True,
            input_coordinates: Union[str, Sequence[Optional[str]], None] = None, threads: int = 0,
            progress: Optional[Progress] = None) -> Comparison:
    """Measure how far apart two surfaces lie.

    Parameters
    ----------
    a, b : Mesh, (vertices, faces), path, or an object with vertices and faces
        mm, in one frame.
    samples : int
        Points spread over a surface, for each direction.
    symmetric : bool
        From b to a too.
    input_coordinates : {"ras", "lps", "tkras", "voxel"}, or two, optional
        The frame of a file's points, overriding the file's own (None: as it says).
    threads : int
        0: as many as the machine has.
    progress : callable, optional
        As for `surface`.

    Returns
    -------
    Comparison

    Raises
    ------
    Error
        A surface without area, or frames that differ or of which one is not known.

    Examples
    --------
    >>> import adaptiso, numpy as np
    >>> i, j, k = np.indices((32, 32, 32))
    >>> ball = -np.sqrt((i - 15.5) ** 2 + (j - 15.5) ** 2 + (k - 15.5) ** 2)
    >>> two = adaptiso.compare(adaptiso.surface(ball, -8), adaptiso.surface(ball, -9))
    >>> round(two.mean, 1)
    1.0
    """
    data = [mesh_data_of(mesh, False, stated)
            for mesh, stated in zip((a, b), stated_frames(input_coordinates, (a, b)))]
    require_one_frame(data, (a, b), ["a", "b"])
    text = _adaptiso.compare(data[0], data[1], count("samples", samples, 1, 10**9),
                             flag("symmetric", symmetric), checked_threads(threads),
                             checked_progress(progress))
    comparison = Comparison(json.loads(text))
    warn((Warned(each["text"]) for each in comparison.report["warnings"]), "compare")
    return comparison


def names_of(surfaces: Sequence[Any], names: Optional[Sequence[str]]) -> List[str]:
    if names is None:
        return [base_name(checked_path("mesh", mesh)) if is_path(mesh) else f"surface {n + 1}"
                for n, mesh in enumerate(surfaces)]
    told = [] if isinstance(names, str) else list(names)
    if len(told) != len(surfaces) or not all(isinstance(name, str) for name in told):
        raise Error(f"names {shown(names)}: must be one text for each surface")
    return told


def require_one_frame(data: Sequence[_adaptiso.MeshData], surfaces: Sequence[Any],
                       names: Sequence[str]) -> None:
    require_known_frames([mesh.frame for mesh in data], names)
    endings = {checked_path("mesh", surface).rpartition(".")[2].lower()
               for surface in surfaces if is_path(surface)}
    if data[0].frame == "unknown" and len(endings) > 1:
        raise Error(f"{names[0]} and {names[1]}: are of files that don't say their coordinate "
                    "frame, and files of different formats may differ in it; state it by "
                    "input_coordinates=")
    for mesh, name in zip(data, names):
        if mesh.frame != data[0].frame:
            raise Error(f"{names[0]} is in {data[0].frame} and {name} in {mesh.frame}; load the "
                        "one in tkras with volume=")
