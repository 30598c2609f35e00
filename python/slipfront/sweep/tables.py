# SPDX-License-Identifier: BSD-3-Clause
"""The sweep's own results: sweep.nc and sweep.csv, with the list of checksums of these and of all points."""

from __future__ import annotations

import csv
import io
import os
import shutil
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slipfront.files import DataError, is_folder
from slipfront.folder import LIST, PUBLISHING, UNFINISHED, located, result_file, sha256
from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep
from slipfront.sweep.outcome import QUANTITIES, Cell, Quantity, read_outcome
from slipfront.sweep.points import Point, short_names
from slipfront.sweep.program import KeyFacts, version_of
from slipfront.sweep.values import as_array, short_text, text_of, values_of
from slipfront.sweep.work import DONE, FAILED

if TYPE_CHECKING:
    import xarray as xr

TABLE = "sweep.csv"
DATA = "sweep.nc"
MISSING = "missing"


@dataclass(frozen=True)
class Row:
    """A point and what came out of it; without results, `message` says why."""

    point: Point
    status: str
    message: str
    cells: dict[str, Cell]


def row_of(folder: Path, point: Point) -> Row:
    place = places.place_of(folder, point)
    try:
        wrong = places.what_is_wrong(place, point)
        if wrong is None:
            return Row(point, DONE, "", read_outcome(place))
    except DataError as error:
        wrong = str(error)
    failure = places.failure_of(folder, point)
    return Row(point, MISSING if failure is None else FAILED, failure or wrong, {})


def without(quantity: Quantity) -> Cell:
    """What stands for a quantity of a point without results."""
    return "" if quantity.words else np.nan


def csv_text(cell: Cell) -> str:
    if isinstance(cell, float):
        return "" if np.isnan(cell) else short_text(cell)
    return text_of(cell)


def table_text(sweep: Sweep, rows: list[Row]) -> str:
    """sweep.csv: keys with their values, status, quantities; a row per point, undefined cells empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["folder", *sweep.keys, "status", *(q.name for q in QUANTITIES), "message"])
    for row in rows:
        cells = [row.cells.get(q.name, without(q)) for q in QUANTITIES]
        folder = f"{places.POINTS}/{row.point.name}"
        values = [text_of(value) for value in row.point.values.values()]
        writer.writerow([folder, *values, row.status, *map(csv_text, cells), row.message])
    return text.getvalue()


def column(quantity: Quantity, rows: list[Row]) -> np.ndarray:
    cells = [row.cells.get(quantity.name, without(quantity)) for row in rows]
    return np.array(cells, dtype=object if quantity.words else float)


def attributes(unit: str, long_name: str, **others: str) -> dict[str, str]:
    return {"units": unit or "1", "long_name": long_name} | others


def coordinate_attributes(key: str, facts: dict[str, KeyFacts]) -> dict[str, str]:
    known = facts.get(key, KeyFacts("", key))
    return attributes(known.unit, known.meaning, key=key)


def dataset(sweep: Sweep, rows: list[Row], facts: dict[str, KeyFacts], program: str) -> xr.Dataset:
    """A grid has a dimension for each key that varies, other sweeps the dimension `point`."""
    import xarray as xr

    short = short_names(sweep.keys)
    is_grid = sweep.combine == "grid"
    arrays = {q.name: (column(q, rows), attributes(q.unit, q.long_name, **flags(q))) for q in QUANTITIES}
    texts = {
        "status": ([row.status for row in rows], "whether the run came to its end"),
        "message": ([row.message for row in rows], "why a point has no results"),
        "folder": ([f"{places.POINTS}/{row.point.name}" for row in rows], "results of the run"),
    }
    for name, (cells, long_name) in texts.items():
        arrays[name] = (np.array(cells, dtype=object), attributes("", long_name))
    if is_grid:
        axes = {key: as_array(values_of(key, spec)) for key, spec in sweep.vary.items()}
        dims = [short[key] for key in axes]
        shape = [len(values) for values in axes.values()]
        coords = {short[k]: (short[k], v, coordinate_attributes(k, facts)) for k, v in axes.items()}
    else:
        dims, shape = ["point"], [len(rows)]
        columns = {key: as_array([row.point.values[key] for row in rows]) for key in sweep.keys}
        coords = {short[k]: ("point", v, coordinate_attributes(k, facts)) for k, v in columns.items()}
    variables = {name: (dims, cells.reshape(shape), attrs) for name, (cells, attrs) in arrays.items()}
    about = {
        "title": f"sweep of {sweep.case.name} over {', '.join(sweep.keys)}",
        "source": program,
        "set": ", ".join(sweep.settings()),
        "definitions": "docs/theory.md",
    }
    return xr.Dataset(variables, coords, about)


def flags(quantity: Quantity) -> dict[str, str]:
    return {"words": " ".join(quantity.words)} if quantity.words else {}


def listed(folder: Path, made: Path, rows: list[Row]) -> str:
    """checksums.sha256 of the sweep's own files, and of the lists of the points that are done."""
    sums = {name: sha256(made / name) for name in (TABLE, DATA)}
    sums[places.DEFINITION] = sha256(folder / places.DEFINITION)
    for row in rows:
        if row.status == DONE:
            sums[f"{places.POINTS}/{row.point.name}/{LIST}"] = sha256(
                places.place_of(folder, row.point) / LIST
            )
    return "".join(f"{value}  {name}\n" for name, value in sums.items())


def synced(file: Path) -> None:
    with open(file, "rb") as stream:
        os.fsync(stream.fileno())


def end_publication(folder: Path) -> None:
    """Moves a complete set, whose move may have been cut off, to its place; its list comes last."""
    publishing = folder / PUBLISHING
    if not is_folder(publishing):
        return
    for file in sorted(publishing.iterdir(), key=lambda file: file.name == LIST):
        os.replace(file, folder / file.name)
    publishing.rmdir()


def publish(folder: Path, sweep: Sweep, rows: list[Row], data: xr.Dataset) -> None:
    """Both files and their list appear together; earlier ones stay until then."""
    made = folder / UNFINISHED
    try:
        end_publication(folder)
        with suppress(FileNotFoundError):
            shutil.rmtree(made)
        made.mkdir()
        (made / TABLE).write_text(table_text(sweep, rows), encoding="utf-8")
        data.to_netcdf(made / DATA, engine="h5netcdf")
        (made / LIST).write_text(listed(folder, made, rows), encoding="utf-8")
        for file in made.iterdir():
            synced(file)
        os.rename(made, folder / PUBLISHING)
        end_publication(folder)
    except OSError as error:
        raise DataError(f"{folder}: cannot be written: {error.strerror or error}") from None


def collect(folder: Path, sweep: Sweep, program: Path, facts: dict[str, KeyFacts]) -> list[Row]:
    """Reads all points and publishes the tables."""
    rows = [row_of(folder, point) for point in sweep.points()]
    publish(folder, sweep, rows, dataset(sweep, rows, facts, version_of(program)))
    return rows


def read_dataset(folder: Path) -> xr.Dataset:
    """sweep.nc in memory, compared with its checksum."""
    import xarray as xr

    file = result_file(folder / DATA)
    if not located(file).exists():
        raise DataError(f"{folder}: holds no sweep that is done")
    try:
        with xr.open_dataset(file, engine="h5netcdf") as data:
            found: Any = data.load()
    except (OSError, ValueError, KeyError) as error:
        raise DataError(f"{file}: damaged, or not of a sweep: {error}") from None
    return found
