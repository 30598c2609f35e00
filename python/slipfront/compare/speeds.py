# SPDX-License-Identifier: BSD-3-Clause
"""Front speeds of runs over the ratio of shear to normal stress, beside measured points."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.integrate import trapezoid

from slipfront.compare.misfit import median_of, of_all
from slipfront.errors import CaseError
from slipfront.files import DataError, read_table
from slipfront.given import column, holds, in_order, instance, number
from slipfront.measures import Arrays
from slipfront.opened import OpenRun
from slipfront.opened_sequence import OpenSequence
from slipfront.read import median
from slipfront.sweep.outcome import Slipped

RATIOS = ("static_ratio", "friction_before")
SPEEDS = ("v_m_per_s", "v_over_c_L")
WITHIN = 0.02  # of the ratio


def runs_of(opened: Iterable[OpenRun | OpenSequence]) -> list[OpenRun]:
    """The runs themselves, of sequences those of their events."""
    found: list[OpenRun] = []
    for k, one in enumerate(in_order(opened, "runs", "a list of runs")):
        found += one.runs if isinstance(one, OpenSequence) else [instance(one, OpenRun, f"runs[{k}]")]
    return found


def points_of(run: OpenRun, ratio: str, speed: str) -> np.ndarray:
    """Ratios, and speeds in m/s or over the run's c_L, of what its fronts do outside the trigger zone or the
    patch: at each node for static_ratio; for friction_before the median of the longest front over the ratio
    of the forces. [2, points]"""
    slipped = Slipped(run)
    found = np.concatenate([np.empty((2, 0)), *map(slipped.points, slipped.fronts)], axis=1)
    if ratio == "friction_before" and slipped.longest is not None:
        speeds = slipped.points(slipped.longest)[1:, :]
        shear, normal = (trapezoid(run.tractions[name].to_numpy(), run.x_m) for name in ("t_s_Pa", "p_s_Pa"))
        found = np.array([[shear / normal], [np.median(speeds)]]) if speeds.size else np.empty((2, 0))
    return found / np.array([[1.0], [run.c_L_m_per_s if speed == "v_over_c_L" else 1.0]])


def read_points(file: Path) -> dict[str, np.ndarray]:
    """The measured points of a CSV file, as compare_speeds takes them."""
    columns = read_table(file, by_hand=True, separators=";\t,")
    record = {name: columns.numbers(name) for name in (*RATIOS, *SPEEDS) if name in columns.header}
    try:
        one_of(record, RATIOS), one_of(record, SPEEDS)
    except CaseError as error:
        raise DataError(f"{file}: {error}") from None
    return record


def one_of(record: Arrays, names: tuple[str, str]) -> str:
    has = [name for name in names if holds(record, "the record", name)]
    if len(has) != 1:
        raise CaseError(
            f"the record has {' and '.join(has) or 'none'} of {', '.join(names)}; give one of them"
        )
    return has[0]


def compare_speeds(
    runs: Iterable[OpenRun | OpenSequence], record: Arrays, *, ratio_within: float = WITHIN
) -> xr.Dataset:
    """Speeds of the runs' fronts, all together, at the stress ratios of measured points.

    record: v_m_per_s, or v_over_c_L, over static_ratio, t_s/p_s at the place of the front, or over
    friction_before, shear over normal force before the event. [points]
    ratio_within: nodes, or for friction_before events, count whose ratio is off by no more.

    Returns a Dataset over `point`: the ratio; v_record and v_runs, the median of those that count, NaN
    without any, in the record's unit; deviation = v_runs/v_record - 1. Of all: misfit_of_all, the median of
    its magnitude, and deviation_of_all, its median, each with _error, the standard error by the scatter,
    NaN below three points; n, of points that have both."""
    opened = runs_of(runs)
    if not opened:
        raise CaseError("there is no run to compare")
    ratio, speed = one_of(record, RATIOS), one_of(record, SPEEDS)
    at, v_record = column(record, "record", ratio), column(record, "record", speed)
    within = number(ratio_within, "ratio_within", above=0, finite=True)
    if len(at) != len(v_record) or not len(at):
        raise CaseError(f"{ratio} and {speed} of the record must be of one length, 1 or more")
    known = ~(np.isnan(at) | np.isnan(v_record))
    notes = [] if known.all() else [f"{(~known).sum()} of {len(at)} points lack a number: left out"]
    at, v_record = at[known], v_record[known]
    if not known.any() or not ((v_record > 0) & np.isfinite(v_record) & np.isfinite(at)).all():
        raise CaseError(f"{speed} of the record must be above 0 and finite, and so must be {ratio}")
    unit = "m s-1" if speed == "v_m_per_s" else "1"
    of_runs = np.concatenate([points_of(run, ratio, speed) for run in opened], axis=1)
    v_runs = np.array([median(of_runs[1][np.abs(of_runs[0] - r) <= within]) for r in at])
    deviation = v_runs / v_record - 1
    of_deviation = median_of(deviation)
    return xr.Dataset(
        {
            ratio: ("point", at, {"units": "1"}),
            "v_record": ("point", v_record, {"units": unit}),
            "v_runs": ("point", v_runs, {"units": unit}),
            "deviation": ("point", deviation, {"units": "1"}),
        }
        | of_all(median_of(np.abs(deviation)), "1")
        | {
            "deviation_of_all": ((), of_deviation.value, {"units": "1"}),
            "deviation_of_all_error": ((), of_deviation.error, {"units": "1"}),
            "n": ((), int(np.isfinite(deviation).sum()), {"long_name": "points that both have"}),
        },
        attrs={"notes": notes, "ratio": ratio, "speed": speed},
    )
