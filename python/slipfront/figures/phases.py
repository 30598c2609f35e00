# SPDX-License-Identifier: BSD-3-Clause
"""Slow slip and events of a sequence one after another, under a law with a state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from slipfront.opened_sequence import OpenSequence
from slipfront.read import even

LEAST_ROWS = 4  # of a phase
RATE_RANGE_M_PER_S = (1e-12, 1.0)


@dataclass(frozen=True)
class Phases:
    """Slip rates of phase after phase, slow slip and events alternately. Phase k goes from level k to k + 1:
    slow slip evenly over the steps of its history, which are shorter where it is faster, an event over
    time."""

    x_m: np.ndarray  # [nodes]
    borders: np.ndarray  # levels between rows [rows + 1]
    time_s: np.ndarray  # since normal loading [rows]
    slip_rate_m_per_s: np.ndarray  # magnitude, NaN where contact is open [rows, nodes]


def phases(sequence: OpenSequence, most_rows: int, most_nodes: int) -> Phases:
    """Of a sequence with slow slip."""
    begin_s = sequence.events["begin_s"].to_numpy()
    histories: list[tuple[xr.Dataset, float]] = []
    for k, slow in enumerate(sequence.slow):
        histories.append((slow, 0.0))
        if k < len(begin_s):
            histories.append((sequence.runs[k].history, begin_s[k]))
    each = max(LEAST_ROWS, most_rows // len(histories))
    nodes = even(histories[0][0].sizes["x_m"], most_nodes)
    borders, times, rates = [np.zeros(1)], [], []
    for k, (history, from_s) in enumerate(histories):
        rows = history.isel(time_s=even(history.sizes["time_s"], each)).load().isel(x_m=nodes)
        borders.append(k + np.linspace(0, 1, rows.sizes["time_s"] + 1)[1:])
        times.append(from_s + rows["time_s"].to_numpy())
        touch = rows["p_Pa"].to_numpy() > 0
        rates.append(np.where(touch, np.abs(rows["slip_rate_m_per_s"].to_numpy()), np.nan))
    x_m = histories[0][0]["x_m"].to_numpy()[nodes]
    return Phases(x_m, np.concatenate(borders), np.concatenate(times), np.concatenate(rates))


def slip_after_events(sequence: OpenSequence) -> np.ndarray:
    """Since the tilt; under a law with a state with the slow slip before each event. [events, nodes]"""
    slip, slow = sequence.slip.to_numpy(), sequence.slow
    if len(slow) == 0:
        return np.asarray(np.cumsum(slip, axis=0))
    before = [history["slip_m"][-1].to_numpy() for history in slow[: len(slip)]]
    return np.asarray(slip + before)
