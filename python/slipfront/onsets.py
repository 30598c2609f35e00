# SPDX-License-Identifier: BSD-3-Clause
"""Records of an experiment: the times at which slip began at places along an interface."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from slipfront.errors import CaseError
from slipfront.files import DataError, Table, one_line, open_file, read_table
from slipfront.given import path, whole
from slipfront.read import require, require_ascending
from slipfront.units import attributes

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "km": 1e3}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
PRESSURES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}
WORDS = {
    "metres": "m", "meters": "m", "centimetres": "cm", "centimeters": "cm", "millimetres": "mm",
    "millimeters": "mm", "micrometres": "um", "micrometers": "um", "kilometres": "km", "kilometers": "km",
    "seconds": "s", "sec": "s", "milliseconds": "ms", "microseconds": "us", "nanoseconds": "ns",
}  # fmt: skip
#: Quantities by their names here: what a column of each may be called, and its units.
QUANTITIES: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    "x_m": (("x", "position", "place", "distance"), LENGTHS),
    "onset_s": (("time", "t", "onset", "onset_time", "arrival", "arrival_time"), TIMES),
    "t_s_Pa": (("t_s",), PRESSURES),
    "p_s_Pa": (("p_s",), PRESSURES),
}
#: Those of events, and of picks of their onsets.
OF_EVENTS: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    **QUANTITIES,
    "event": (("event",), {"": 1.0}),
    "error_s": (("error", "onset_error", "time_error"), TIMES),
}
WANTED = "x and time with their units, such as x_m or x (mm), and time_s or time (us)"
NEVER = ("", "nan", "na", "n/a", "none", "-", "inf", "+inf", "-inf")
NONE = "none"  # in place of a mark: every number is a time


def name_and_unit(column: str) -> tuple[str, str]:
    """Of `x_mm`, `x (mm)`, `x [mm]`, `x / mm` and `x mm`; the unit is empty where there is none."""
    text = column.strip().replace("µ", "u").replace("μ", "u").replace("%", "percent")
    found = re.fullmatch(r"(.+?)(?:\s*[(\[]\s*|\s*/\s*|[_\s]+)([A-Za-z]+)\s*[)\]]?", text)
    if found is None:
        return text.lower(), ""
    return found[1].strip().lower().replace(" ", "_"), WORDS.get(found[2].lower(), found[2])


def columns_of(
    where: Any,
    names: list[str],
    quantities: dict[str, tuple[tuple[str, ...], dict[str, float]]] = QUANTITIES,
    needed: tuple[str, ...] = ("x_m", "onset_s"),
    wanted: str = WANTED,
) -> dict[str, tuple[str, float]]:
    """The column of each quantity, and the factor to its SI unit. What needs no unit has the unit ""."""
    chosen: dict[str, tuple[str, float]] = {}
    without_unit: dict[str, str] = {}
    for name in names:
        forms = dict([name_and_unit(name), (name.strip().lower(), "")])
        for quantity, (called, units) in quantities.items():
            unit = next((forms[bare] for bare in forms if bare in called and forms[bare] in units), None)
            if unit is None:
                if any(bare in called for bare in forms):
                    without_unit[quantity] = name
                continue
            if quantity in chosen:
                raise DataError(
                    f"{where}: '{chosen[quantity][0]}' and '{one_line(name)}' both may be {quantity}; "
                    "rename one of them"
                )
            chosen[quantity] = name, units[unit]
    if any(name not in chosen for name in needed):
        has = ", ".join(f"'{one_line(name)}'" for name in names) or "none"
        raise DataError(f"{where}: has the columns {has}; wanted are {wanted}")
    for quantity, name in without_unit.items():
        if quantity not in chosen:
            called, units = quantities[quantity]
            raise DataError(
                f"{where}: column '{one_line(name)}' names none of the units {', '.join(units)}: call it "
                f"{called[0]}_{next(iter(units))} or so"
            )
    return chosen


def is_sentinel(value: float) -> bool:
    """Whether a number is one that programs write for nothing: -1, -9, -99, 999, powers of ten from 1e6."""
    size = f"{abs(value):.15g}"  # 1e300 is no double
    usual = r"1|9+" if value < 0 else r"999+"
    return re.fullmatch(rf"{usual}|1(0{{6,}}|e\+\d+)", size) is not None


def without_marks(
    times: np.ndarray, never_slipped: float | str | None, unit: str = "s"
) -> tuple[Any, list[str]]:
    """Times, NaN where a place never slips, and what is said of that.

    never_slipped: the number that marks such a place; "none": there is none; None: -1, -99 and the like where
    all others are at least 0, and 999, 1e9 and the like farther from the others than these are from each
    other."""
    made = np.where(np.isfinite(times), times, np.nan)
    missing = np.isnan(made)
    notes = [f"{n_places(missing.sum())} without a time: never slipped"] if missing.any() else []
    if never_slipped == NONE:
        return made, notes
    if isinstance(never_slipped, str):
        raise CaseError(f"never_slipped is {never_slipped!r}; it must be a number or 'none'")
    if never_slipped is not None:
        marked = made == never_slipped
        return np.where(marked, np.nan, made), [
            *notes,
            f"{n_places(marked.sum())} marked {never_slipped:g}: never slipped",
        ]
    for value in (np.nanmin(made), np.nanmax(made)) if not missing.all() else ():
        rest = made[np.isfinite(made) & (made != value)]
        if not is_sentinel(float(value)) or rest.size == 0:
            continue
        gap = max(rest.min() - value, value - rest.max())
        if (value < 0 <= rest.min()) or gap > rest.max() - rest.min():
            marked = made == value
            notes.append(
                f"{n_places(marked.sum())} with the time {value:g} {unit} taken as never slipped; "
                "if it is a time, set never_slipped to none"
            )
            made[marked] = np.nan
    zero = np.flatnonzero(made == 0)
    if zero.size > 1 and np.diff(zero).max() > 1:
        notes.append(
            f"{n_places(zero.size)} apart from one another with the time 0; if nothing slips there, set "
            "never_slipped to 0"
        )
    return made, notes


def in_si(values: np.ndarray, factor: float) -> np.ndarray:
    """Rounded once, as the decimal number in SI units would be."""
    return values / round(1 / factor) if factor < 1 else values * factor


def n_places(n: int) -> str:
    return f"{n} place" if n == 1 else f"{n} places"


def numbers_of(table: Table, column: str, may_miss: bool) -> np.ndarray:
    """NaN for what stands in place of a number, where this may miss. [rows]"""
    if not may_miss:
        return table.numbers(column)
    texts = ("" if cell.lower() in NEVER else cell for cell in table.texts(column))
    return np.array(
        [table.number(line, column, text, True) for (line, _), text in zip(table.rows, texts, strict=True)]
    )


def csv_columns(file: Path) -> tuple[list[str], Callable[[str, bool], np.ndarray]]:
    table = read_table(file, by_hand=True, separators=";\t,")
    return [name for name in table.header if name], lambda name, may_miss: numbers_of(table, name, may_miss)


def texts_of(file: Path, column: str) -> list[str]:
    """Of a CSV file, empty where it has no such column."""
    table = read_table(file, by_hand=True, separators=";\t,")
    return table.texts(column) if column in table.header else [""] * len(table.rows)


def mat_columns(file: Path) -> tuple[list[str], Callable[[str, bool], np.ndarray]]:
    from scipy.io import loadmat

    with open_file(file) as stream:
        try:
            held = loadmat(stream)
        except NotImplementedError:
            raise DataError(f"{file}: a .mat file of version 7.3; save it with -v7, or as CSV") from None
        except Exception as error:  # scipy raises what it happens to
            raise DataError(f"{file}: damaged, or not a .mat file: {one_line(str(error))}") from None

    def numbers(name: str, may_miss: bool) -> np.ndarray:
        values = np.asarray(held[name])
        if values.dtype.kind not in "fiu" or max(values.shape, default=0) != values.size:
            raise DataError(f"{file}: '{name}' is not a vector of real numbers")
        made = values.ravel().astype(float)
        require(may_miss or bool(np.isfinite(made).all()), file, f"'{name}' holds a value that is not finite")
        return made

    return [name for name in held if not name.startswith("__")], numbers


def at_places(
    file: Any, column: str, read: dict[str, np.ndarray], is_of_events: bool
) -> tuple[np.ndarray, list[str]]:
    """Rows in the order of their places, those of a file of events in any; of several at one place that with
    the least error."""
    x = read["x_m"]
    if not is_of_events:
        order = np.arange(len(x))[:: -1 if np.all(np.diff(x) < 0) else 1]
        require_ascending(file, column, x[order])
        return order, []
    require(bool(np.isfinite(x).all()), file, f"a value of {column} is missing")
    order = np.lexsort((read.get("error_s", np.zeros(len(x))), x))
    is_first = np.diff(x[order], prepend=-np.inf) > 0
    if is_first.all():
        return order, []
    twice = x[order][np.flatnonzero(~is_first)[0]]
    if "error_s" not in read:
        raise DataError(f"{file}: two onsets at x = {twice:.6g} m in one event; delete one of their rows")
    n = int((~is_first).sum())
    return order[is_first], [f"{n} more at a place that has one: that with the least error counts"]


def record_of(
    where: Any, column: str, read: dict[str, np.ndarray], doubts: np.ndarray, is_of_events: bool,
    never_slipped: float | str | None, unit: str,
) -> tuple[dict[str, np.ndarray], list[str]]:  # fmt: skip
    """Columns of one event in the order of its places, and notes."""
    order, notes = at_places(where, column, read, is_of_events)
    of = {quantity: values[order] for quantity, values in read.items()}
    of["onset_s"], told = without_marks(of["onset_s"], never_slipped, unit)
    if "error_s" in of:
        of["error_s"], without = known_errors(where, of)
        if np.isnan(of["error_s"]).all():
            del of["error_s"]
        elif without:
            told.append(f"{n_places(without)} without an error of its time: the median of the others counts")
    if n_doubts := int((doubts[order] != "").sum()):
        told.append(f"{n_places(n_doubts)} with a doubt on the onset")
    return of, [*told, *notes]


def records_of_events(
    where: Any, read: dict[str, np.ndarray], event: np.ndarray, doubts: np.ndarray
) -> dict[int | None, xr.Dataset]:
    """Records in SI units, by their events."""
    made: dict[int | None, xr.Dataset] = {}
    for k in np.unique(event):
        own = {quantity: values[event == k] for quantity, values in read.items()}
        of, notes = record_of(where, "x_m", own, doubts[event == k], True, NONE, "s")
        variables = {quantity: ("node", values, attributes(quantity)) for quantity, values in of.items()}
        made[int(k)] = xr.Dataset(variables, attrs={"notes": notes})
    return made


def read_each(
    file: Path, never_slipped: float | str | None = None, event: int | None = None
) -> dict[int | None, xr.Dataset]:
    """The record of each event in a file, or of the one that is named; of a file without events the only one,
    as that of None."""
    is_mat = file.suffix.lower() == ".mat"
    names, numbers = mat_columns(file) if is_mat else csv_columns(file)
    chosen = columns_of(file, names, OF_EVENTS)
    read = {
        quantity: numbers(name, quantity in ("onset_s", "error_s")) for quantity, (name, _) in chosen.items()
    }
    lengths = {len(values) for values in read.values()}
    require(len(lengths) == 1, file, "its columns differ in length")
    n = len(read["x_m"])
    require(n > 0, file, "fewer than two rows")
    numbered = read.pop("event", None)
    if numbered is None and event is not None:
        raise DataError(f"{file}: has no column 'event'; leave the event out")
    if numbered is not None and not ((numbered % 1 == 0) & (numbered >= 0)).all():
        raise DataError(f"{file}: column 'event' holds what is no whole number from 0")
    own = np.full(n, -1) if numbered is None else numbered.astype(np.int64)
    if event is not None and event not in own:
        raise DataError(f"{file}: has no event {event}; it has {', '.join(map(str, np.unique(own)))}")
    doubts = np.array([""] * n if is_mat else texts_of(file, "doubt"), dtype=np.str_)
    unit = name_and_unit(chosen["onset_s"][0])[1]
    made: dict[int | None, xr.Dataset] = {}
    for k in np.unique(own) if event is None else (event,):
        rows = {quantity: values[own == k] for quantity, values in read.items()}
        of, notes = record_of(file, chosen["x_m"][0], rows, doubts[own == k], numbered is not None,
                              never_slipped, unit)  # fmt: skip
        if numbered is None:
            require(len(of["x_m"]) >= 2, file, "fewer than two rows")
            require(bool(np.isfinite(of["onset_s"]).any()), file, "no row has a time: nothing slips")
        variables = {
            quantity: ("node", in_si(values, chosen[quantity][1]), attributes(quantity))
            for quantity, values in of.items()
        }
        made[None if numbered is None else int(k)] = xr.Dataset(variables, attrs={"notes": notes})
    return made


def known_errors(file: Any, of: dict[str, np.ndarray]) -> tuple[np.ndarray, int]:
    """What is missing is the median of the others; and of how many times."""
    error, is_known = of["error_s"], np.isfinite(of["error_s"])
    if (wrong := error <= 0).any():
        x = of["x_m"][wrong][0]
        raise DataError(f"{file}: holds an error of a time that is not above 0, at x = {x:.6g}")
    if not is_known.any():
        return error, 0
    missing = int((~is_known & np.isfinite(of["onset_s"])).sum())
    return np.where(is_known, error, np.median(error[is_known])), missing


def read_onsets(
    file: str | Path, *, never_slipped: float | str | None = None, event: int | None = None
) -> xr.Dataset:
    """The record in a CSV file (commas, or semicolons or tabs with decimal points or commas) or a .mat file.

    Columns are found by their names with their units: `x_m`, `x (mm)`, `time_us`, `onset [ms]`, and
    perhaps `t_s_MPa`, `p_s_MPa`, the tractions before the event, and `error_us`, the standard error of a
    time. With a column `event`, as in the files of `slipfront picks`, it holds several records, whose rows
    are in any order.
    never_slipped: see find_fronts; in the file's unit. Empty cells, nan, inf, NA and - mean never slipped.
    event: the one to read; by default all, of which find_fronts takes one at a time.

    Returns a Dataset over `node`, in SI units: x_m, ascending in each event; onset_s, NaN where a place never
    slips; t_s_Pa, p_s_Pa, error_s and event, where the file has them. Its attribute `notes` says how many
    never slip, and by what mark.
    Raises Error where the file is no such record."""
    wanted = None if event is None else whole(event, "event", least=0)
    made = read_each(path(file, "file"), never_slipped, wanted)
    if None in made:
        return made[None]
    notes = [f"event {k}: {note}" for k, record in made.items() for note in record.attrs["notes"]]
    each = [
        record.assign(event=("node", np.full(record.sizes["node"], k), {"units": "1", "long_name": "event"}))
        for k, record in made.items()
    ]
    return xr.concat(each, "node", join="outer", combine_attrs="drop").assign_attrs(notes=notes)
