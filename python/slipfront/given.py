# SPDX-License-Identifier: BSD-3-Clause
"""What a caller hands in, checked before it is used: refused by a CaseError of one line that names it."""

from __future__ import annotations

import math
import os
import reprlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.errors import CaseError, Error

LARGEST_INT = 2**31 - 1  # of the compiled module


def shown(value: Any) -> str:
    """A value in a message: short, in one line."""
    try:
        return " ".join(reprlib.repr(value).split())
    except ValueError:  # a number of more digits than Python writes
        return f"of type {type(value).__name__}"


@contextmanager
def refusing() -> Iterator[None]:
    """What the compiled module has against arrays becomes a CaseError."""
    try:
        yield
    except Error:
        raise
    except ValueError as error:
        raise CaseError(str(error)) from None


def text(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise CaseError(f"{name} is {shown(value)}; it must be a text")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise CaseError(f"{name} is {shown(value)}: half a surrogate pair is no sign of a text") from None
    return value


def path(value: Any, name: str) -> Path:
    """Of a file or folder that need not be there; refused where the system can have none of that name."""
    if not isinstance(value, str | os.PathLike) or not isinstance(os.fspath(value), str):
        raise CaseError(f"{name} is {shown(value)}; it must be a path")
    try:
        os.stat(value)
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError as error:
        raise CaseError(f"{name} is {shown(value)}: {error.strerror}") from None
    except ValueError:  # a byte 0, or half a surrogate pair
        raise CaseError(f"{name} is {shown(value)}; no file has such a name") from None
    return Path(value)


def kept_path(value: Any, name: str) -> Path:
    """The same, which holds when the working folder is another one."""
    try:
        return path(value, name).absolute()
    except OSError as error:
        raise CaseError(f"{name} is {shown(value)}: the working folder is gone ({error.strerror})") from None


def number(
    value: Any, name: str, *, above: float | None = None, least: float | None = None, finite: bool = False
) -> float:
    """NaN passes where there is no bound. An array without dimensions is a number."""
    if hasattr(value, "__array__") and np.ndim(value) == 0:
        value = np.asarray(value).item()
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CaseError(f"{name} is {shown(value)}; it must be a number")
    try:
        made = float(value)
    except OverflowError:
        raise CaseError(f"{name} is {shown(value)}: too large") from None
    if above is not None and not made > above:
        raise CaseError(f"{name} is {value}; it must be above {above:g}")
    if least is not None and not made >= least:
        raise CaseError(f"{name} is {value}; it must be at least {least:g}")
    if finite and not math.isfinite(made):
        raise CaseError(f"{name} is {value}; it must be finite")
    return made


def whole(value: Any, name: str, *, least: int, most: int = LARGEST_INT) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise CaseError(f"{name} is {shown(value)}; it must be a whole number")
    if not least <= value <= most:
        bound = f"at least {least}" if value < least else f"at most {most}"
        raise CaseError(f"{name} is {shown(int(value))}; it must be {bound}")
    return int(value)


def flag(value: Any, name: str) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise CaseError(f"{name} is {shown(value)}; it must be True or False")
    return bool(value)


def table(value: Any, name: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise CaseError(f"{name} is {shown(value)}; it must be a dictionary")
    return value


def instance(value: Any, kind: type, name: str) -> Any:
    if not isinstance(value, kind):
        raise CaseError(f"{name} is {shown(value)}; it must be a slipfront.{kind.__name__}")
    return value


def in_order(values: Any, name: str, what: str) -> list[Any]:
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise CaseError(f"{name} is {shown(values)}; it must be {what}")
    try:
        return list(values)
    except TypeError:  # an array without dimensions
        raise CaseError(f"{name} is {shown(values)}; it must be {what}") from None


def array(values: Any, name: str, *, dims: int = 1, finite: bool = False) -> np.ndarray:
    """Doubles side by side; masked ones are NaN. A single number is an array of one."""
    if np.ma.isMaskedArray(values):
        values = np.ma.filled(np.ma.asarray(values, dtype=np.float64), np.nan)
    try:
        given = np.asarray(values)
        if given.dtype.kind == "c":
            raise CaseError(f"{name} holds complex numbers: give real ones")
        if given.dtype.kind in "mM" or values is None:
            raise CaseError(f"{name} is {shown(values)}; it must be an array of numbers")
        made = np.ascontiguousarray(given, dtype=np.float64)
    except CaseError:
        raise
    except (TypeError, ValueError, OverflowError) as error:
        raise CaseError(f"{name} is not an array of numbers: {error}") from None
    if made.ndim != dims:
        raise CaseError(f"{name} has {made.ndim} dimensions; it must have {dims}")
    if finite and not np.isfinite(made).all():
        raise CaseError(f"{name} holds a value that is not finite")
    return made


def holds(values: Any, of: str, name: str) -> bool:
    """Whether a dictionary or data set has an array of this name."""
    try:
        return name in values
    except TypeError:
        raise CaseError(f"{of} is {shown(values)}; it must be a dictionary or data set of arrays") from None


def column(values: Any, of: str, name: str, *, dims: int = 1, finite: bool = False) -> np.ndarray:
    """An array of a dictionary or data set of arrays, by its name."""
    try:
        found = values[name]
    except (KeyError, TypeError, IndexError, ValueError):
        raise CaseError(f"{of} has no '{name}': give a dictionary or data set of arrays") from None
    return array(found, f"{of}['{name}']", dims=dims, finite=finite)
