# SPDX-License-Identifier: BSD-3-Clause
"""A run's history along the interface, thinned to what a screen shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from slipfront.read import HISTORY_FIELDS

ROWS_AT_ONCE = 2**22  # numbers of a field that are in memory while it is read


@dataclass(frozen=True)
class ThinHistory:
    """A number for each block of times and nodes: the largest slip rate, else what is amid it."""

    time_s: np.ndarray  # [times]
    x_m: np.ndarray  # [nodes]
    slip_m: np.ndarray  # [times, nodes]
    slip_rate_m_per_s: np.ndarray  # [times, nodes]
    t_Pa: np.ndarray  # [times, nodes]
    p_Pa: np.ndarray  # [times, nodes]
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
    """A field of the record, some of its rows at a time; `field` may lie in a file."""
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


def thinned(history: xr.Dataset, most: tuple[int, int]) -> ThinHistory:
    """At most so many times and nodes of a record."""
    time_s, x_m = (history[name].to_numpy() for name in ("time_s", "x_m"))
    n_rows, n_columns = (
        max(1, -(-n // limit)) for n, limit in zip((len(time_s), len(x_m)), most, strict=True)
    )
    thin = {name: thin_field(history[name], name, n_rows, n_columns) for name in HISTORY_FIELDS}
    return ThinHistory(
        time_s=time_s[middles(len(time_s), n_rows)],
        x_m=x_m[middles(len(x_m), n_columns)],
        n_times=len(time_s),
        n_nodes=len(x_m),
        times_in_block=n_rows,
        nodes_in_block=n_columns,
        **thin,
    )
