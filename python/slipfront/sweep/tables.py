# SPDX-License-Identifier: BSD-3-Clause
"""The sweep's own results: sweep.nc and sweep.csv, with the list of checksums of these and of all points."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slipfront.files import DataError, exists
from slipfront.folder import LIST, located, publication, result_file, sha256
from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep
from slipfront.sweep.engine import DONE, FAILED
from slipfront.sweep.outcome import (
    OF_RUNS,
    QUANTITIES,
    Cell,
    notes_on,
    read_outcome,
    teller,
    waves_over_c_L,
)
from slipfront.sweep.points import Point, as_array, short_names, text_of, values_of
from slipfront.units import Unit, engineering, name_of, unit_of

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

TABLE = "sweep.csv"
DATA = "sweep.nc"
MISSING = "missing"
UNDEFINED = "undefined"
MOST_ROWS = 30  # that are printed
#: Printed results by the head of their column.
PRINTED = {
    "n_fronts": "fronts",
    "longest_front_slip": "slip",
    "longest_front_length_m": "length_m",
    "longest_front_v_tip_median_over_c_L": "V_tip/c_L",
    "longest_front_end": "end",
    "slipped_share": "slipped",
    "reached_ends": "reached",
    "n_events": "events",
    "n_global_events": "global",
    "first_global_event": "first_global",
    "largest_friction": "F_S/F_N",
    "friction_at_rest_median": "at_rest",
    "longest_precursor_m": "precursor_m",
}
OF_LONGEST = "longest_front_slip"
TEXTS = {
    "status": "whether the run came to its end",
    "message": "why a point has no results, or the notes on its run",
    "folder": "results of the run",
}


def row_of(folder: Path, point: Point) -> dict[str, Cell]:
    """A point's values as texts and what came out of it; `message` has notes or says why nothing did."""
    place = places.place_of(folder, point)
    values: dict[str, Cell] = {key: text_of(value) for key, value in point.values.items()}
    row = values | {"folder": f"{places.POINTS}/{point.name}"}
    try:
        wrong = places.what_is_wrong(place, point)
        if wrong is None:
            notes = "; ".join(notes_on(place))
            return row | {"status": DONE, "message": notes} | read_outcome(place)
    except DataError as error:
        wrong = str(error)
    failure = places.failure_of(folder, point)
    return row | {"status": MISSING if failure is None else FAILED, "message": failure or wrong}


def table_of(sweep: Sweep, rows: list[dict[str, Cell]]) -> pd.DataFrame:
    """A row per point: folder, values of the keys, status, quantities, message. The quantities are those of
    runs, of sequences, or both, as the points are."""
    import pandas as pd

    quantities = [q for q in QUANTITIES if any(q.name in row for row in rows)] or OF_RUNS
    names = ["folder", *sweep.vary, "status", *(q.name for q in quantities), "message"]
    table = pd.DataFrame(rows, columns=names)
    for q in quantities:
        cells = [row.get(q.name, "" if q.words else np.nan) for row in rows]
        table[q.name] = pd.Series(cells, dtype=object if q.words else float)
    return table


def table_lines(table: pd.DataFrame, folder: Path) -> list[str]:
    """The keys that vary and what is asked first, a line per point of the first ones."""
    keys = list(table.columns[1 : table.columns.get_loc("status")])
    heads = short_names(keys) | {"status": "status"} | {n: head for n, head in PRINTED.items() if n in table}
    if (table.status == DONE).all():
        del heads["status"]
    shown = table[list(heads)].rename(columns=heads).head(MOST_ROWS)
    text = shown.to_string(
        index=False, na_rep="-", float_format="{:.3g}".format, line_width=120, max_colwidth=24
    )
    n_noted = int(((table.status == DONE) & (table.message != "")).sum())
    lines = [f"note: {n_noted} runs have notes: message in {folder / TABLE}"] if n_noted else []
    if OF_LONGEST in heads:
        lines.append("slip, length_m, V_tip/c_L (median) and end are of the longest front:")
    lines += text.split("\n")
    if len(table) > MOST_ROWS:
        lines.append(f"... {len(table) - MOST_ROWS} more in {folder / TABLE}")
    return lines


def attributes(unit: str, long_name: str, **others: str) -> dict[str, str]:
    return {"units": unit or "1", "long_name": long_name} | others


def dataset(sweep: Sweep, table: pd.DataFrame, program: str, waves: dict[str, float]) -> xr.Dataset:
    """A grid has a dimension for each key that varies, other sweeps the dimension `point`."""
    import xarray as xr

    short = short_names(list(sweep.vary))
    taken = {q.name for q in QUANTITIES} | TEXTS.keys()
    short = {key: key if name in taken else name for key, name in short.items()}
    points = sweep.points()
    if is_grid := sweep.combine == "grid":
        columns = {key: as_array(values_of(key, spec)) for key, spec in sweep.vary.items()}
    else:
        columns = {key: as_array([point.values[key] for point in points]) for key in sweep.vary}
    dims = list(short.values()) if is_grid else ["point"]
    shape = [len(values) for values in columns.values()] if is_grid else [len(points)]
    coords = {
        name: (name if is_grid else "point", columns[key], attributes(unit_of(key), key, key=key))
        for key, name in short.items()
    }
    attrs = {
        q.name: attributes(q.unit, q.long_name, words=" ".join(q.words))
        for q in QUANTITIES
        if q.name in table
    }
    attrs |= {name: attributes("", long_name) for name, long_name in TEXTS.items()}
    variables = {}
    for name, told in attrs.items():
        cells = np.array(table[name], dtype=float if table[name].dtype == float else object)
        variables[name] = (dims, cells.reshape(shape), {k: text for k, text in told.items() if text})
    about: dict[str, Any] = {
        "title": f"sweep of {sweep.case.name} over {', '.join(sweep.vary)}",
        "source": program,
        "combine": sweep.combine,
        "set": ", ".join(sweep.settings()),
        "definitions": "docs/theory.md",
    }
    return xr.Dataset(variables, coords, about | waves)


def publish(folder: Path, table: pd.DataFrame, data: xr.Dataset) -> None:
    """Both files, and a list that has the points that are done as well."""
    done = [f"{place}/{LIST}" for place in table.folder[table.status == DONE]]
    others = {name: sha256(folder / name) for name in (places.DEFINITION, *done)}
    with publication(folder, others) as made:
        table.to_csv(made / TABLE, index=False, float_format="%.12g", lineterminator="\n")
        data.to_netcdf(made / DATA, engine="h5netcdf")


def collect(folder: Path, sweep: Sweep, program: str) -> pd.DataFrame:
    """Reads all points and publishes the tables."""
    table = table_of(sweep, [row_of(folder, point) for point in sweep.points()])
    done = table.folder[table.status == DONE]
    varies = any(key.startswith("material.") for key in sweep.vary)
    waves = {} if varies or done.empty else waves_over_c_L(teller(folder / done.iloc[0]))
    publish(folder, table, dataset(sweep, table, program, waves))
    return table


def is_sweep(folder: Path) -> bool:
    return exists(folder / places.DEFINITION) and exists(located(folder / DATA))


def read_dataset(folder: Path) -> xr.Dataset:
    """sweep.nc in memory, compared with its checksum."""
    import xarray as xr

    if not is_sweep(folder):
        begun = exists(folder / places.DEFINITION)
        hint = f"the sweep is not done; slipfront sweep --restart {folder}" if begun else "holds no sweep"
        raise DataError(f"{folder}: {hint}")
    file = result_file(folder / DATA)
    try:
        with xr.open_dataset(file, engine="h5netcdf") as data:
            found: Any = data.load()
    except (OSError, ValueError, KeyError) as error:
        raise DataError(f"{file}: damaged, or not of a sweep: {error}") from None
    if not keys_of(found):
        raise DataError(f"{file}: not of a sweep")
    return found


@dataclass(frozen=True)
class Axis:
    """How a key is written at an axis: its name with a unit that suits its values, `d_c (µm)`."""

    label: str
    factor: float  # from the values of the table


def axes_of(data: xr.Dataset) -> dict[str, Axis]:
    """By the names of the coordinates of keys_of."""
    keys = keys_of(data)
    names = {name: name_of(key) for name, key in keys.items()}
    axes = {}
    for name, key in keys.items():
        is_alone = list(names.values()).count(names[name]) == 1
        whole = names[name] if is_alone else f"{key.partition('.')[0]} {names[name]}"
        is_text = data[name].dtype.kind not in "fiu"
        shown = Unit("1", 1.0) if is_text else engineering(unit_of(key), data[name].to_numpy())
        axes[name] = Axis(whole if shown.name == "1" else f"{whole} ({shown.name})", shown.factor)
    return axes


def cells_of(result: xr.DataArray, digits: int = 4) -> list[str]:
    """What is read of a result at each point: words, or numbers in a unit that suits them all; `undefined`
    without any."""
    if "words" in result.attrs:
        return [str(value).replace("_", " ") or UNDEFINED for value in result.to_numpy().flat]
    factor = shown_in(result).factor
    return [
        f"{factor * value:.{digits}g}" if np.isfinite(value) else UNDEFINED
        for value in result.to_numpy().flat
    ]


def shown_in(result: xr.DataArray) -> Unit:
    """The unit that suits the numbers of a result."""
    if "words" in result.attrs:
        return Unit("1", 1.0)
    return engineering(result.attrs["units"], result.to_numpy())


def constant(result: xr.DataArray) -> str | None:
    """What a result is at all points of a sweep, where it is the same; None where it differs."""
    found = set(cells_of(result))
    if len(found) > 1:
        return None
    unit = shown_in(result).name
    told = found.pop() if found else UNDEFINED
    return told if unit == "1" or told == UNDEFINED else f"{told} {unit}"


def keys_of(data: xr.Dataset) -> dict[str, str]:
    """Keys that vary, by the names of their coordinates."""
    return {str(name): column.attrs["key"] for name, column in data.coords.items() if "key" in column.attrs}
