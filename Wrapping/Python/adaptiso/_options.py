"""Keyword arguments that are rows of the library's tables, as the programs' options are."""

from __future__ import annotations

import difflib
import functools
import inspect
import json
import re
import textwrap
from typing import Any, Callable, Dict, List, Mapping, Optional, TypeVar, cast

from . import _adaptiso
from ._adaptiso import Error
from ._arguments import LARGEST_COUNT, count, flag, number, shown, word

_Row = Dict[str, Any]
_ROWS: Dict[str, List[_Row]] = json.loads(_adaptiso.option_rows())
# of refusals in which users know the argument by an older name
_NAMES = {"refuse-missing-chunks": "all_chunks"}
# `level` is the isovalue there
_OWN_NAMES = {("giant", "level"): "zarr_level"}
_TYPES = {"flag": "bool", "number": "float", "count": "int", "choice": "str", "text": "str"}
# texts that may be slices: numpy.s_[10:90, :, 20:] for "10:90,:,20:"
_SLICED = ("crop",)
# functions by the names of programs, where they differ
_FUNCTIONS = {"mesh": "surface"}

_Function = TypeVar("_Function", bound=Callable[..., Any])


def _name(subject: str, row: _Row) -> str:
    name = str(row["name"])
    plain = _NAMES.get(name, name.replace("-", "_"))
    return _OWN_NAMES.get((subject, name), plain)


def rows(subject: str) -> Dict[str, _Row]:
    """The rows of a function, by the names of its arguments."""
    return {_name(subject, row): row for row in _ROWS[subject]}


def checked(subject: str, given: Mapping[str, Any], function: str = "") -> Dict[str, Any]:
    """The arguments in `given` for C++; those left out, or None, are left to it. \\raises Error"""
    known = rows(subject)
    options = {}
    for name, value in given.items():
        if name not in known:
            raise TypeError(f"{function or subject}() got an unexpected keyword argument '{name}'")
        row = known[name]
        if value is not None or not _may_be_none(row):
            options[str(row["name"]).replace("-", "_")] = _checked(name, value, row)
    return options


def program_options(subject: str, given: Mapping[str, Any], function: str = "") -> List[str]:
    """The same for a program. \\raises Error"""
    options = []
    for name, value in checked(subject, given, function).items():
        option = "--" + name.replace("_", "-")
        if value is not False:
            options.append(option if value is True else f"{option}={value}")
    return options


def _may_be_none(row: _Row) -> bool:
    """A default of 0 that is stated in words stands for not given."""
    return row["default"] is None or (row["default"] == 0 and "standard" in row)


def _checked(name: str, value: Any, row: _Row) -> Any:
    kind = row["kind"]
    if kind == "number":
        return number(name, value, row["rule"], lambda given: _allows(row, given))
    if kind == "count":
        return count(name, value, row.get("least", 0), row.get("most", LARGEST_COUNT))
    if kind == "choice":
        return word(name, value, row["words"])
    if kind == "flag":
        return flag(name, value)
    if name in _SLICED and isinstance(value, tuple):
        value = ",".join(map(_range, value))
    if not isinstance(value, (str, int)) or isinstance(value, bool):
        raise Error(f"{name} {shown(value)}: must be {row['rule']}")
    return str(value)


def _range(part: Any) -> str:
    """A slice as the programs have it; else what they refuse."""
    if not isinstance(part, slice) or part.step not in (None, 1):
        return shown(part)
    return ":".join("" if bound is None else str(bound) for bound in (part.start, part.stop))


def _allows(row: _Row, value: float) -> bool:
    return ("least" not in row or value >= row["least"]) and \
        ("above" not in row or value > row["above"]) and ("most" not in row or value <= row["most"])


def _documented(name: str, row: _Row) -> str:
    words = row.get("words")
    kind = "{" + ", ".join(f'"{each}"' for each in words) + "}" if words else \
        "three slices or str" if name in _SLICED else _TYPES[row["kind"]]
    text = re.sub(r"--([a-z-]+)", lambda option: f"`{option[1].replace('-', '_')}`", row["help"])
    text = re.sub(r"\bMethod adaptive: (.)", lambda first: first[1].upper(), text)
    body = textwrap.fill(f"{text}.", 92, initial_indent="    ",
                         subsequent_indent="    ")
    return f"{name} : {kind}, optional\n{body}"


def _advice(subject: str, typed: str, known: List[str]) -> str:
    """The argument that is meant by one that there is not, by what the programs know of other
    packages' names."""
    if "spacing" in known and typed.replace("_", "").lower() in ("voxelsize", "voxelspacing", "pixdim", "zooms"):
        return "; did you mean spacing=? (resample= makes new samples)"
    program = {each: name for name, each in _FUNCTIONS.items()}.get(subject, subject)
    stored = {name: str(row["name"]) for name, row in rows(subject).items()}
    options = {stored.get(name, name.replace("_", "-")): name for name in known}
    if "level" in known and subject != "read":
        options["iso"] = "level"
    if typed.replace("_", "-") in options:
        return f"; did you mean {options[typed.replace('_', '-')]}=?"
    answer = _adaptiso.habit_answer(f"adaptiso-{program}", typed, list(options))
    if answer is None:
        near = difflib.get_close_matches(typed, known, 1, 0.7)
        return f"; did you mean {near[0]}=?" if near else ""
    for option, name in options.items():
        answer = re.sub(rf"--{option}(?![a-z-])( (?=[A-Z0-9]))?", name + "=", answer)
    for program, name in _FUNCTIONS.items():
        answer = answer.replace(f"adaptiso-{program}", f"adaptiso-{name}")
    return "; " + answer.replace("adaptiso-", "adaptiso.")


def _checks_names(subject: str, function: _Function, positional: List[str],
                  known: List[str]) -> _Function:
    """The function, which refuses arguments that it has not by one hint."""
    options = known[len(positional):]

    @functools.wraps(function)
    def checking(*arguments: Any, **given: Any) -> Any:
        for name in given:
            if name not in known:
                raise TypeError(f"{function.__name__}() got an unexpected keyword argument '{name}'"
                                + _advice(subject, name, known))
        if len(arguments) > len(positional):
            own = [name for name in positional if name != "self"]
            raise TypeError(f"{function.__name__}() takes {', '.join(own) or 'nothing'} by position; "
                            f"give the others by name: {'=, '.join(options[:4])}=, ...")
        return function(*arguments, **given)

    return cast(_Function, checking)


def takes(subject: str, only: Optional[List[str]] = None) -> Callable[[_Function], _Function]:
    """Decorates a function that takes ``**options`` of a subject: its signature and its docstring, where
    that has a line ``**options``, name them."""
    def decorate(function: _Function) -> _Function:
        known = {name: row for name, row in rows(subject).items() if only is None or name in only}
        signature = inspect.signature(function)
        own = [each for each in signature.parameters.values()
               if each.kind is not inspect.Parameter.VAR_KEYWORD]
        added = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=row["default"],
                                   annotation=_TYPES[row["kind"]])
                 for name, row in known.items() if name not in signature.parameters]
        positional = [each for each in own if each.kind is not inspect.Parameter.KEYWORD_ONLY]
        function.__signature__ = signature.replace(  # type: ignore[attr-defined]
            parameters=positional + added + own[len(positional):])
        text = "\n".join(_documented(name, row) for name, row in known.items())
        function.__doc__ = (function.__doc__ or "").replace(
            "    **options\n", textwrap.indent(text, "    ") + "\n")
        return _checks_names(subject, function, [each.name for each in positional],
                             list(inspect.signature(function).parameters))
    return decorate


def type_text() -> str:
    """The text of _option_types.py."""
    lines = ['"""Generated from the library\'s rows of options: types of keyword arguments. Do not edit."""',
             "", "from typing import Literal, Optional, Tuple, TypedDict, Union"]
    for subject in _ROWS:
        name = subject.title().replace("_", "")
        lines += ["", "", f"class {name}Options(TypedDict, total=False):"]
        for name, row in rows(subject).items():
            words = row.get("words")
            kind = f"Literal[{', '.join(json.dumps(each) for each in words)}]" if words else \
                "Union[str, Tuple[slice, slice, slice]]" if name in _SLICED else _TYPES[row["kind"]]
            lines.append(f"    {name}: Optional[{kind}]")
    return "\n".join(lines) + "\n"
