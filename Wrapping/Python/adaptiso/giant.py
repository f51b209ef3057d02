"""Surfaces of volumes that no memory holds, tile by tile.

>>> from adaptiso import giant
>>> report = giant.run("work", "brain.zarr", 120, "brain.pvtp", workers=2)  # doctest: +SKIP
>>> report["componentCount"], report["volumeMm3"]                           # doctest: +SKIP

Nothing of such a surface passes through Python: what the steps make are files, so that they may
run on many machines, and be killed and run again. The work is done by processes of the program
adaptiso-giant, which has to be on the PATH. What fits into memory is better made by
`adaptiso.surface`.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, Mapping, NamedTuple, Optional

from ._adaptiso import Error, InternalError
from ._arguments import (Warned, count, listed, number, optional_number, path as checked_path, shown,
                         threads as checked_threads, warn, word)
from ._options import program_options, takes

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._option_types import GiantOptions

__all__ = ["Plan", "join", "plan", "read_plan", "run", "seam", "tile"]

PROGRAM = "adaptiso-giant"
METHODS = ("adaptive", "mc")
FRAMES = ("ras", "lps", "voxel")


class Plan(NamedTuple):
    """What the steps of one surface agree on.

    Attributes
    ----------
    tiles, seams : list of str
        What is to be made by `tile` and by `seam`, as "3_0_12". No seams with the method "mc".
    """

    tiles: List[str]
    seams: List[str]


@takes("giant")
def plan(work: Any, image: Any, level: float, *, method: str = "adaptive",
         max_error: Optional[float] = None, side: int = 384,
         **options: Unpack[GiantOptions]) -> Plan:
    """Cut a volume into tiles, and find those that may hold surface.

    Parameters
    ----------
    work : str or path
        The folder of the plan and of what the steps leave; made where it is not there.
    image : str or path
        A Zarr, OME-Zarr or N5, of which only what a tile needs is read; or any other file.
    level : float
        The isovalue; inside is where samples are >= level.
    method : {"adaptive", "mc"}
        Few triangles within a distance of the surface of marching cubes, or that surface.
    max_error : float, optional
        Of "adaptive": largest distance in mm, both ways. Default: 0.15 of the least distance
        between planes of voxels.
    side : int
        Of a tile, in cells; a multiple of 32.
    **options

    Returns
    -------
    Plan

    Raises
    ------
    Error
        An image or an option that can't be used; no program adaptiso-giant.
    """
    folder = _folder(work)
    _run(["plan", folder, *_planned("plan", image, level, method, max_error, side, options)])
    return read_plan(folder)


def read_plan(work: Any) -> Plan:
    """The plan that a folder holds.

    Parameters
    ----------
    work : str or path

    Raises
    ------
    Error
        There is none.
    """
    file = os.path.join(checked_path("work", work), "plan.json")
    try:
        with open(file, encoding="utf-8") as stream:
            told = json.load(stream)
        return Plan([str(id) for id in told["tiles"]], [str(id) for id in told["seams"]])
    except (OSError, ValueError, KeyError, TypeError):
        raise Error(f"{file}: there is no plan; make one with giant.plan") from None


def tile(work: Any, ids: Optional[Iterable[str]] = None, *, threads: int = 0) -> Dict[str, Any]:
    """Make the surfaces in tiles; those that are there already of the same input are left.

    Parameters
    ----------
    work : str or path
        Several processes may work on it at once.
    ids : iterable of str, optional
        Of `Plan.tiles`; default: all.
    threads : int
        0: as many as the machine has.

    Returns
    -------
    dict
        ``made``, ``found`` (counts of tiles), ``triangles``, ``peakMemoryMb``.

    Raises
    ------
    Error
        No such tile, an image that has changed, no room on the disk; a killed process.
    """
    return _step("tile", work, ids, threads)


def seam(work: Any, ids: Optional[Iterable[str]] = None, *, threads: int = 0) -> Dict[str, Any]:
    """Simplify what lies across the walls of tiles (method "adaptive").

    Parameters
    ----------
    work, threads
        As for `tile`.
    ids : iterable of str, optional
        Of `Plan.seams`; default: all. Each needs the tiles around it.

    Returns
    -------
    dict
        As of `tile`.

    Raises
    ------
    Error
        As of `tile`; a tile that is missing.
    """
    return _step("seam", work, ids, threads)


def join(work: Any, output: Any = None, *, preview: Any = None, frame: str = "ras",
         threads: int = 0) -> Dict[str, Any]:
    """Count and measure the whole surface, prove it closed, and write it.

    Parameters
    ----------
    work, threads
        As for `tile`.
    output : str or path, optional
        A .ply, or a .pvtp: a list of pieces, which ParaView reads. None: it is measured only.
    preview : str or path, optional
        A copy of at most 200,000 triangles for `adaptiso.load`.
    frame : {"ras", "lps", "voxel"}
        Of the points written.

    Returns
    -------
    dict
        ``triangles``, ``closed``, ``areaMm2``, ``volumeMm3``, ``genus``, ``componentCount``,
        ``cavities``, ``components`` (the largest 1,000), ``errorBoundMm`` and more: the report of
        ``adaptiso-giant --json``.

    Raises
    ------
    Error
        A piece that is missing; a file that can't be written.
    """
    return _run(["join", _folder(work), *_result(output, preview, frame),
                 *_threads(threads)])


@takes("giant")
def run(work: Any, image: Any, level: float, output: Any = None, *, workers: int = 1,
        preview: Any = None, frame: str = "ras", threads: int = 0, method: str = "adaptive",
        max_error: Optional[float] = None, side: int = 384,
        **options: Unpack[GiantOptions]) -> Dict[str, Any]:
    """All steps on this machine. Called again after it was stopped, it goes on where it was.

    Parameters
    ----------
    workers : int
        Tiles at a time, each by a process of its own.
    work, image, level, method, max_error, side
        As for `plan`.
    **options
    output, preview, frame, threads
        As for `join`.

    Returns
    -------
    dict
        As of `join`.

    Raises
    ------
    Error
        As of the steps.
    """
    planned = _planned("run", image, level, method, max_error, side, options)
    return _run(["run", _folder(work), *planned, *_result(output, preview, frame),
                 f"--workers={count('workers', workers, 1, 1024)}", *_threads(threads)])


def _planned(function: str, image: Any, level: Any, method: Any, max_error: Any, side: Any,
             options: Mapping[str, Any]) -> List[str]:
    """Options of the program. \\raises Error"""
    planned = [f"--input={checked_path('image', image)}",
               f"--iso={number('level', level)!r}",
               f"--method={word('method', method, METHODS)}",
               f"--tile={count('side', side, 32, 4096)}"]
    largest = optional_number("max_error", max_error, "a number above 0, in mm",
                              lambda value: value > 0)
    if largest is not None:
        planned.append(f"--max-error={largest!r}")
    return planned + program_options("giant", options, function)


def _result(output: Any, preview: Any, frame: Any) -> List[str]:
    options = [f"--coordinates={word('frame', frame, FRAMES)}"]
    for name, option, value in (("output", "output", output), ("preview", "preview", preview)):
        if value is not None:
            options.append(f"--{option}={checked_path(name, value)}")
    return options


def _threads(value: Any) -> List[str]:
    number_of = checked_threads(value)
    return [f"--threads={number_of}"] if number_of > 0 else []


def _step(step: str, work: Any, ids: Any, threads: Any) -> Dict[str, Any]:
    folder = _folder(work)
    names: List[str] = []
    if ids is not None:
        names = listed("ids", ids, "a sequence of names, as of the plan")
        for name in names:
            if not isinstance(name, str) or not re.fullmatch(r"\d+_\d+_\d+", name):
                raise Error(f"ids {shown(name)}: must be a name of the plan, as '3_0_12'")
        if not names:  # to the program none would be all of them
            return {"step": step, "made": 0, "found": 0, "triangles": 0, "peakMemoryMb": 0}
    return _run([step, folder, *names, *_threads(threads)])


def _folder(work: Any) -> str:
    """Absolute, so that it is never taken for an option."""
    return os.path.abspath(checked_path("work", work))


def _run(arguments: List[str]) -> Dict[str, Any]:
    """Runs the program. \\return its report \\raises Error, InternalError"""
    program = shutil.which(PROGRAM)
    if program is None:
        raise Error(f"{PROGRAM}: is not on the PATH; install the package adaptiso")
    with subprocess.Popen([program, *arguments, "--quiet", "--json=-"], text=True,
                          encoding="utf-8", errors="replace", stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            told, complaints = process.communicate()
        except BaseException:  # Ctrl+C among them
            process.terminate()
            raise
    lines = [line.replace(PROGRAM + ": ", "", 1) for line in complaints.splitlines() if line]
    if process.returncode in (0, 1):
        warn(Warned(line.replace("warning: ", "", 1)) for line in lines)
        report = json.loads(told)
        if not isinstance(report, dict):
            raise InternalError(f"{PROGRAM}: its report is none")
        return report
    raise _error_of(process.returncode, lines)


def _error_of(code: int, lines: List[str]) -> Exception:
    if code < 0:
        return Error(f"{PROGRAM}: was ended by {signal.Signals(-code).name}; it may need more "
                     "memory: take a smaller side, or fewer workers")
    said = lines[0].replace(f" (see {PROGRAM} --help)", "") if lines else f"{PROGRAM}: ended with code {code}"
    return InternalError(said) if code == 4 else Error(said)
