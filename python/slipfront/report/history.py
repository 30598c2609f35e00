# SPDX-License-Identifier: BSD-3-Clause
"""A run's history along the interface, thinned to what a screen shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.files import dataset, open_hdf5
from slipfront.folder import result_file
from slipfront.read import (
    HISTORY_FIELDS,
    History,
    HistoryReader,
    checked_history,
    is_open,
    n_finite,
    open_history,
    require,
    require_same_nodes,
)

ROWS_AT_ONCE = 2**22  # numbers of a field that are in memory while it is read


@dataclass(frozen=True)
class ThinHistory(History):
    """A number for each block of times and nodes: the largest slip rate, else what is amid it."""

    slip_m: np.ndarray  # [times, nodes]
    t_Pa: np.ndarray  # [times, nodes]
    n_times: int  # of the record
    n_nodes: int
    times_in_block: int
    nodes_in_block: int


def starts(n: int, size: int) -> np.ndarray:
    return np.arange(0, n, size)


def middles(n: int, size: int) -> np.ndarray:
    """Index of the middle of each block, the last one of which may be shorter."""
    first = starts(n, size)
    return (first + np.minimum(first + size, n) - 1) // 2


def largest_of_blocks(values: np.ndarray, n_rows: int, n_columns: int) -> np.ndarray:
    """Of each block the number of largest magnitude, with its sign; NaN where one is in it."""
    rows, columns = (starts(n, size) for n, size in zip(values.shape, (n_rows, n_columns), strict=True))
    high, low = (
        f.reduceat(f.reduceat(values, rows, axis=0), columns, axis=1) for f in (np.maximum, np.minimum)
    )
    return np.where(-low > high, low, high)


def thin_field(field: Any, name: str, n_rows: int, n_columns: int) -> np.ndarray:
    """A field of the record, some of its rows at a time; `field` is an array or a data set."""
    n_times, n_nodes = field.shape
    at_once = max(1, ROWS_AT_ONCE // (n_nodes * n_rows)) * n_rows
    parts = []
    for first in range(0, n_times, at_once):
        rows = np.asarray(field[first : first + at_once], dtype=float)
        if name == "slip_rate_m_per_s":
            parts.append(largest_of_blocks(rows, n_rows, n_columns))
        else:
            parts.append(rows[middles(len(rows), n_rows)][:, middles(n_nodes, n_columns)])
    return np.concatenate(parts)


def thinned(
    time_s: np.ndarray, x_m: np.ndarray, fields: Mapping[str, Any], most: tuple[int, int]
) -> ThinHistory:
    """At most so many times and nodes of the record."""
    n_rows, n_columns = (
        max(1, -(-n // limit)) for n, limit in zip((len(time_s), len(x_m)), most, strict=True)
    )
    thin = {name: thin_field(fields[name], name, n_rows, n_columns) for name in HISTORY_FIELDS}
    return ThinHistory(
        time_s=time_s[middles(len(time_s), n_rows)],
        x_m=x_m[middles(len(x_m), n_columns)],
        n_times=len(time_s),
        n_nodes=len(x_m),
        times_in_block=n_rows,
        nodes_in_block=n_columns,
        **thin,
    )


def checked(file: Path, thin: ThinHistory, blew_up: bool) -> ThinHistory:
    """The history, of a run that blew up as far as it is finite."""
    fields = {name: getattr(thin, name) for name in HISTORY_FIELDS}
    n = n_finite(thin.time_s, *fields.values()) if blew_up else len(thin.time_s)
    cut = {name: values[:n] for name, values in fields.items()}
    for name in ("slip_m", "t_Pa"):
        require(np.isfinite(cut[name]), file, f"a value of {name} is not finite")
    checked_history(file, History(thin.time_s[:n], thin.x_m, cut["slip_rate_m_per_s"], cut["p_Pa"]), False)
    sizes = {name: getattr(thin, name) for name in ("n_times", "n_nodes", "times_in_block", "nodes_in_block")}
    return ThinHistory(time_s=thin.time_s[:n], x_m=thin.x_m, **cut, **sizes)


def thin_history(most: tuple[int, int]) -> HistoryReader:
    """A reader of histories with at most so many times and nodes, for read_run."""

    def read(file: Path, x_m: np.ndarray, blew_up: bool) -> ThinHistory:
        file = result_file(file)
        if is_open(file):
            time_s, fields = open_history(file, x_m)
            require(len(time_s) >= 2, file, "fewer than two times")
            return checked(file, thinned(time_s, x_m, fields, most), blew_up)
        with open_hdf5(file) as hdf5:
            time_s, nodes_m = (dataset(hdf5, name, 1)[()] for name in ("time_s", "x_m"))
            require_same_nodes(file, nodes_m, x_m)
            shape = (len(time_s), len(x_m))
            require(min(shape) >= 2, file, "fewer than two times or nodes")
            sets = {name: dataset(hdf5, name, 2) for name in HISTORY_FIELDS}
            for name, field in sets.items():
                require(field.shape == shape, file, f"{name} is {field.shape}, not {shape}")
            return checked(file, thinned(time_s, x_m, sets, most), blew_up)

    return read
