# SPDX-License-Identifier: BSD-3-Clause
"""Runs beside records: onsets, traces, speeds over the stress ratio, cycles of stick-slip."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from matplotlib.lines import Line2D

from slipfront.compare.cycles import NAMES
from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.units import engineering

if TYPE_CHECKING:
    from slipfront.compare.traces import Trace
    from slipfront.opened import OpenRun

RECORD, RUN = "0.35", "#d55e00"
POINTS: style.Look = {"marker": "o", "markersize": 3, "linestyle": "none"}
LINE: style.Look = {"linestyle": "-"}
MOST_ROWS = 8
UNITS = {"1": (1e6, "µε"), "Pa": (1e-6, "MPa"), "m": (1e6, "µm")}  # of traces


def legend(figure: Any, record: style.Look, run: style.Look) -> None:
    of = (("record", RECORD, record), ("run", RUN, run))
    style.legend_below(figure, [Line2D([], [], color=c, label=name, **look) for name, c, look in of], 2)


def draw_onsets(run: OpenRun, found: xr.Dataset) -> Drawing:
    """Left: the fronts of the run, and the record on the run's clock; right: run less record."""
    figure = style.new_figure(style.PAGE_MM, 78)
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    record_s = found["record_s"].to_numpy() + float(found["shift_s"])
    x_m, known = found["x_m"].to_numpy(), np.isfinite(found["record_s"].to_numpy())
    place, time = engineering("m", run.x_m), engineering("s", record_s[known])
    for front in run.front_list:
        left.plot(place.factor * front.x_m, time.factor * front.onset_s, color=RUN)
    left.plot(place.factor * x_m, time.factor * record_s, "o", color=RECORD, markersize=3.5)
    left.set(xlabel=f"$x$ ({place.name})", ylabel=f"onset on the run's clock ({time.name})")
    residual_s = found["residual_s"].to_numpy()
    some = residual_s[np.isfinite(residual_s)]
    rest = engineering("s", some if some.size else np.array([1.0]))
    right.axhline(0, **style.REFERENCE)
    error_s = rest.factor * found["error_s"].to_numpy() if "error_s" in found else None
    look = {"color": RECORD, "markersize": 3.5, "elinewidth": 0.7}
    right.errorbar(place.factor * x_m, rest.factor * residual_s, yerr=error_s, fmt="o", **look)
    right.set(xlabel=f"$x$ ({place.name})", ylabel=f"run less record ({rest.name})")
    legend(figure, POINTS, LINE)
    return Drawing("onsets", figure, "")


def draw_traces(traces: Sequence[Trace], found: xr.Dataset) -> Drawing:
    """A row per trace, a column per part of it, on the run's clock, each about its mean."""
    shown = traces[:MOST_ROWS]
    columns = max(len(trace.parts) for trace in shown)
    figure = style.new_figure(style.PAGE_MM, 18 + 32 * len(shown))
    axes = figure.subplots(len(shown), columns, squeeze=False)
    for row, trace in enumerate(shown):
        own_s, record, computed = trace.both(float(found["shift_s"]))
        factor, unit = UNITS[trace.unit]
        for k, ax in enumerate(axes[row]):
            if k >= len(trace.parts):
                ax.set_axis_off()
                continue
            misfit = float(found["misfit"].sel(trace=trace.name, component=trace.parts[k]))
            ax.plot(1e6 * own_s, factor * record[k], color=RECORD)
            ax.plot(1e6 * own_s, factor * computed[k], color=RUN)
            ax.set_ylabel(f"{trace.parts[k]} ({unit})")
            told = f"misfit {100 * misfit:.0f} %"
            head = f"{plain(trace.name)}, $x$ = {1e3 * trace.x_m:.4g} mm: " if k == 0 else ""
            ax.set_title(head + told, loc="left")
            if row == len(shown) - 1:
                ax.set_xlabel("$t$ (µs)")
    legend(figure, LINE, LINE)
    return Drawing("traces", figure, "")


def draw_speeds(points: np.ndarray, found: xr.Dataset) -> Drawing:
    """Measured points over all of the runs'. points: ratios and speeds. [2, points]"""
    ratio, speed = found.attrs["ratio"], found.attrs["speed"]
    figure = style.new_figure(style.PAGE_MM, 90)
    ax = figure.subplots()
    ax.plot(*points, ".", color=RUN, markersize=2)
    ax.plot(found[ratio], found["v_record"], "o", color=RECORD, markersize=3.5)
    of = {"static_ratio": r"$t_\mathrm{s}/p_\mathrm{s}$", "friction_before": "shear over normal force before"}
    ax.set(xlabel=of[ratio], ylabel=style.V_LABEL if speed == "v_over_c_L" else f"{style.V_NAME} (m/s)")
    legend(figure, POINTS, POINTS | {"marker": "."})
    return Drawing("speeds", figure, "")


def sawtooth(of: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Shear over time, linear between events."""
    return np.repeat(of["begin_s"], 2), np.column_stack([of["before"], of["after"]]).ravel()


def draw_cycles(sides: dict[str, dict[str, np.ndarray]], found: xr.Dataset) -> Drawing:
    """Above: the shear of record and sequence over time, from the first event that counts; below: means over
    those of the record, with standard errors."""
    names = [str(name) for name in found["quantity"].values]
    has_curve = all({"before", "after"} <= of.keys() for of in sides.values())
    figure = style.new_figure(style.PAGE_MM, 110 if has_curve else 60)
    axes = figure.subplots(2 if has_curve else 1, 1, squeeze=False)[:, 0]
    if has_curve:
        unit = found.unit.sel(quantity="before").item()
        shown = engineering("" if unit == "1" else unit, sides["record"]["before"])
        for of, colour in zip(sides.values(), (RECORD, RUN), strict=True):
            time_s, shear = sawtooth(of)
            axes[0].plot(time_s - time_s[0], shown.factor * shear, color=colour)
        axes[0].set(xlabel="time since the first event that counts (s)",
                    ylabel="shear over normal force" if unit == "1" else f"shear ({shown.name})")  # fmt: skip
    ax = axes[-1]
    at = np.arange(len(names))
    for side, colour, off in (("record", RECORD, -0.1), ("sequence", RUN, 0.1)):
        scale = found["mean_record"].to_numpy()
        mean, error, spread = (
            found[f"{n}_{side}"].to_numpy() / scale for n in ("mean", "mean_error", "deviation")
        )
        ax.errorbar(at + off, mean, yerr=spread, fmt="none", ecolor=colour, elinewidth=0.6, alpha=0.6)
        ax.errorbar(at + off, mean, yerr=error, fmt="o", color=colour, markersize=3.5, elinewidth=1.6)
    ax.axhline(1, **style.REFERENCE)
    ax.set_xticks(at, [NAMES[name] for name in names])
    ax.set(ylabel="over the record's mean", xlim=(-0.5, len(names) - 0.5))
    legend(figure, POINTS | LINE, POINTS | LINE)
    return Drawing("cycles", figure, "")
