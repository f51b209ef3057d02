"""Arguments as users give them, checked: what can't be used is an `adaptiso.Error`."""

from __future__ import annotations

import logging
import math
import operator
import os
import re
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, TypeVar

import numpy as np

from ._adaptiso import Error

Result = TypeVar("Result")
Progress = Callable[[str, float], object]

LARGEST_COUNT = 2**53


class Warned(str):
    """A warning: the line that the programs print, as a str.

    Attributes
    ----------
    code : str
        Its kind, as listed in Documentation/Warnings.md; never changes.
    file : str
        The file's name; empty where it concerns none, or several.
    text : str
        The line without the file's name.
    """

    code: str
    file: str
    text: str

    def __new__(cls, text: str, code: str = "", file: str = "") -> Warned:
        self = super().__new__(cls, f"{file}: {text}" if file else text)
        self.text, self.code, self.file = text, code, file
        return self

    def __reduce__(self) -> Tuple[Any, ...]:
        return Warned, (self.text, self.code, self.file)

    def of(self, file: str) -> Warned:
        """The warning, of `file` where it names none."""
        return self if self.file else Warned(self.text, self.code, file)


def warn(warnings: Iterable[Warned], call: str = "", file: str = "") -> None:
    """Hands warnings to the logger "adaptiso"; without a handler Python prints them to stderr.
    Options are named as arguments."""
    for warning in warnings:
        text = re.sub(r"(?<![\w-])--([a-z][a-z-]+)", lambda option: option[1].replace("-", "_") + "=", warning.text)
        logging.getLogger("adaptiso").warning("%s%s", f"{call}: " if call else "", Warned(text, file=warning.file or file))


def shown(value: Any) -> str:
    """`value` as a message has it: one short line."""
    try:
        text = repr(value.item() if isinstance(value, np.generic) else value)  # NumPy 2: np.True_
    except Exception:
        text = f"<{type(value).__name__}>"
    text = " ".join(text.split())
    return text if len(text) <= 60 else text[:57] + "..."


def number(name: str, value: Any, rule: str = "a finite number",
           holds: Callable[[float], bool] = lambda value: True) -> float:
    """`value` as a float that `holds`. \\raises Error"""
    if is_truth(value) or isinstance(value, (str, bytes)) or not hasattr(value, "__float__"):
        raise Error(f"{name} {shown(value)}: must be {rule}")
    try:
        result = float(value)
    except (TypeError, ValueError, OverflowError):
        raise Error(f"{name} {shown(value)}: must be {rule}") from None
    if not math.isfinite(result) or not holds(result):
        raise Error(f"{name} {shown(value)}: must be {rule}")
    return result


def optional_number(name: str, value: Any, rule: str,
                    holds: Callable[[float], bool]) -> Optional[float]:
    return None if value is None else number(name, value, rule, holds)


def count(name: str, value: Any, least: int = 0, most: int = LARGEST_COUNT) -> int:
    """`value` as a whole number from `least` to `most`. \\raises Error"""
    rule = f"a whole number from {least}" + (f" to {most}" if most < LARGEST_COUNT else "")
    if isinstance(value, bool):
        raise Error(f"{name} {shown(value)}: must be {rule}")
    try:
        result = operator.index(value)
    except TypeError:
        raise Error(f"{name} {shown(value)}: must be {rule}") from None
    if not least <= result <= most:
        raise Error(f"{name} {shown(value)}: must be {rule}")
    return result


def listed(name: str, value: Any, rule: str = "a sequence") -> List[Any]:
    """The parts of a sequence, which text is not. \\raises Error"""
    try:
        parts = None if isinstance(value, (str, bytes, os.PathLike)) else list(value)
    except TypeError:  # no sequence, or an array without axes
        parts = None
    if parts is None:
        raise Error(f"{name} {shown(value)}: must be {rule}")
    return parts


def is_truth(value: Any) -> bool:
    """It is Python's or NumPy's True or False."""
    return isinstance(value, bool) or type(value).__name__ in ("bool_", "bool")


def flag(name: str, value: Any) -> bool:
    """`value` as a truth value; a NumPy one will do. \\raises Error"""
    if is_truth(value):
        return bool(value)
    raise Error(f"{name} {shown(value)}: must be True or False")


def word(name: str, value: Any, words: Sequence[str]) -> str:
    """`value`, one of `words`. \\raises Error"""
    if not isinstance(value, str) or value not in words:
        raise Error(f"{name} {shown(value)}: must be one of {', '.join(words)}")
    return str(value)


def threads(value: Any) -> int:
    """A number of threads; 0 means all of the machine's."""
    return count("threads", value, 0, 1024)


def progress(value: Any) -> Optional[Progress]:
    """A function of a stage's name and the part of it done, or None."""
    if value is not None and not callable(value):
        raise Error(f"progress {shown(value)}: must be a function of (stage, fraction), or None")
    result: Optional[Progress] = value
    return result


def path(name: str, value: Any) -> str:
    """A file's or folder's name, as text. \\raises Error"""
    try:
        text = os.fspath(value)
    except TypeError:
        raise Error(f"{name} {shown(value)}: must be a file's name") from None
    file: str = os.fsdecode(text)
    if not file or "\0" in file:
        raise Error(f"{name} {shown(value)}: must be a file's name")
    try:
        file.encode("utf-8")
    except UnicodeEncodeError:
        raise Error(f"{name} {shown(value)}: is no UTF-8; rename it") from None
    return file


def is_path(value: Any) -> bool:
    return isinstance(value, (str, bytes, os.PathLike))
