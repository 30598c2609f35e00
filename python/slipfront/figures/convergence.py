# SPDX-License-Identifier: BSD-3-Clause
"""Front speed over the numerical parameters, from a folder of `slipfront study convergence`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from slipfront.figures.drawing import Drawing, plain
from slipfront.figures.style import DIRECTION_WORDS as WAYS
from slipfront.figures.style import PAGE_MM, V_LABEL, Look
from slipfront.files import DataError, is_number, number, read_json_table, read_table
from slipfront.folder import result_file

NUMBERS = (
    "x_m", "direction", "value", "v_tip_m_per_s", "extrapolated_m_per_s", "error_m_per_s", "order",
)  # fmt: skip
NAMES = {
    "plate.element_size_m": "element size",
    "time.interface_substeps": "sub-steps",
    "time.step_factor": "step factor",
    "material.stiffness_damping_s": "damping",
}
MARKERS: dict[int, Look] = {-1: {"marker": "o"}, 1: {"marker": "o", "markerfacecolor": "white"}}
HIGHEST_PERCENTILE = 98  # the speed diverges where fronts meet: the axis ends at this share of the points


@dataclass(frozen=True)
class Summary:
    """Verdict over the stations of one direction; None where undefined."""

    verdict: str
    relative_error: float | None
    order: float | None
    n_stations: int


@dataclass(frozen=True)
class Stations:
    """Speeds of the fronts in one direction over c_L, for each value of the parameter."""

    x_m: np.ndarray  # [stations]
    v: np.ndarray  # [values, stations]
    error: np.ndarray  # [values, stations], a lower bound where nothing could be extrapolated
    extrapolated: np.ndarray  # [stations], NaN where there is no limit to be seen
    order: np.ndarray  # [stations]


@dataclass(frozen=True)
class Sequence:
    parameter: str  # key of the case file
    values: np.ndarray
    own: int  # index of the case's own value
    summaries: dict[int, Summary]  # by direction
    stations: dict[int, Stations]  # by direction

    @property
    def step_size(self) -> np.ndarray:
        """What goes to 0: the value, or one over the number of sub-steps."""
        return 1 / self.values if self.parameter == "time.interface_substeps" else self.values

    def shown(self, value: float) -> str:
        for ending, unit, factor in (("_m", " mm", 1e3), ("_s", " µs", 1e6)):
            if self.parameter.endswith(ending):
                return f"{factor * value:.3g}{unit}"
        return f"{value:.3g}"

    def median_error(self, direction: int) -> np.ndarray:
        """Of each value, relative to the case's own speed as in convergence.json; NaN where none. [values]"""
        stations = self.stations[direction]
        errors = stations.error / stations.v[self.own]
        return np.array([np.median(e[np.isfinite(e)]) if np.isfinite(e).any() else np.nan for e in errors])


@dataclass(frozen=True)
class Study:
    title: str
    tolerance: float
    l_star_m: float
    sequences: list[Sequence]

    def directions(self) -> list[int]:
        """Those with enough stations for a verdict; where none has, those with any."""
        decided = [
            d for d in WAYS if any(s.summaries[d].verdict != "too few stations" for s in self.sequences)
        ]
        return decided or [d for d in WAYS if any(s.stations[d].x_m.size for s in self.sequences)]


def read_rows(file: Path) -> pd.DataFrame:
    table = read_table(result_file(file))
    try:
        rows = pd.DataFrame({key: table.numbers(key) for key in NUMBERS})
        for key in ("x_m", "direction", "value"):
            if rows[key].isna().any():
                raise DataError(f"{file}: empty cell in column '{key}'")
        return rows.assign(parameter=table.texts("parameter"))
    except DataError as error:
        raise DataError(f"{error}; not a table of `slipfront study convergence`") from None


def read_stations(rows: pd.DataFrame, values: np.ndarray, c_L: float) -> Stations:
    """The rows of one sequence and direction."""
    x_m, at = np.unique(rows["x_m"], return_inverse=True)
    of_value = np.abs(values[:, None] - rows["value"].to_numpy()).argmin(axis=0)
    v, error = (np.full((len(values), len(x_m)), np.nan) for _ in range(2))
    v[of_value, at], error[of_value, at] = rows["v_tip_m_per_s"] / c_L, rows["error_m_per_s"] / c_L
    extrapolated, order = (np.full(len(x_m), np.nan) for _ in range(2))
    extrapolated[at], order[at] = rows["extrapolated_m_per_s"] / c_L, rows["order"]
    return Stations(x_m, v, error, extrapolated, order)


def read_sequence(entry: dict[str, Any], rows: pd.DataFrame, c_L: float) -> Sequence:
    values = np.array(entry["values"], dtype=float)
    if values.ndim != 1 or values.size == 0 or not np.isfinite(values).all():
        raise ValueError("'values' is not a list of numbers")
    own = int(np.argmin(np.abs(values - entry["case_value"])))
    summaries, stations = {}, {}
    for direction in WAYS:
        s = entry[f"direction_{direction:+d}"]
        error, order = s["median_relative_error"], s["median_order"]
        if not all(value is None or is_number(value) for value in (error, order)):
            raise TypeError("an error or an order is not a number")
        summaries[direction] = Summary(str(s["verdict"]), error, order, s["n_stations"])
        near = (rows["parameter"] == entry["parameter"]) & (rows["direction"] == direction)
        stations[direction] = read_stations(rows[near], values, c_L)
    return Sequence(entry["parameter"], values, own, summaries, stations)


def read_study(folder: Path) -> Study:
    file = result_file(folder / "convergence.json")
    summary, rows = read_json_table(file), read_rows(folder / "convergence.csv")
    try:
        c_L = number(file, summary, "c_L_m_per_s")
        sequences = [read_sequence(entry, rows, c_L) for entry in summary["sequences"]]
        tolerance, l_star_m = (number(file, summary, key) for key in ("tolerance", "l_star_m"))
        study = Study(str(summary["title"]), tolerance, l_star_m, sequences)
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise DataError(f"{file}: not a result of `slipfront study convergence`: {error}") from None
    if not study.directions():
        raise DataError(f"{file}: no front has a station")
    return study


def percent(value: float) -> str:
    return f"{100 * value:.2g} %"


def verdict_text(summary: Summary) -> str:
    if summary.relative_error is None:
        return summary.verdict
    bound = "at least " if summary.verdict == "no limit" else ""
    return f"{summary.verdict},\nerror {bound}{percent(summary.relative_error)}"


def draw_speeds(ax: Axes, sequence: Sequence, direction: int, colours: np.ndarray) -> None:
    stations = sequence.stations[direction]
    x = 1e3 * stations.x_m
    for k, (value, colour) in enumerate(zip(sequence.values, colours, strict=True)):
        ax.plot(
            x,
            stations.v[k],
            color=colour,
            linewidth=1.5 if k == sequence.own else 0.7,
            label=sequence.shown(value),
            gid=f"speed:{direction}:{k}",
        )
    own, error = stations.v[sequence.own], stations.error[sequence.own]
    has_limit = np.isfinite(stations.extrapolated)
    for which, colour, name in ((has_limit, "0.45", "error"), (~has_limit, "#d55e00", "bound")):
        ax.vlines(
            x[which],
            (own - error)[which],
            (own + error)[which],
            color=colour,
            linewidth=0.5,
            zorder=1.5,
            gid=f"{name}:{direction}",
        )
    ax.plot(
        x,
        stations.extrapolated,
        "k.",
        markersize=2.2,
        zorder=3,
        label="extrapolated",
        gid=f"limit:{direction}",
    )
    ax.set_title(f"{WAYS[direction]}: {verdict_text(sequence.summaries[direction])}", loc="left")
    ax.locator_params(axis="x", nbins=4)


def draw_errors(ax: Axes, sequence: Sequence, directions: list[int], tolerance: float) -> None:
    """Median error of each value against its step size, in per cent.

    Dashed: the observed order through the case's own error; none where the speeds have no limit.
    """
    above = sequence.step_size > 0  # the limit itself has no place on the axis
    q = sequence.step_size[above]
    for direction, colour in zip(directions, ("#0072b2", "#d55e00"), strict=False):
        error = 100 * sequence.median_error(direction)
        summary = sequence.summaries[direction]
        order = summary.order
        n_order = int(np.isfinite(sequence.stations[direction].order).sum())
        n = len(sequence.stations[direction].x_m)
        text = "no order" if order is None else f"order {order:.2g} ({n_order} of {n})"
        ax.plot(
            q,
            np.where(error > 0, error, np.nan)[above],
            color=colour,
            linewidth=0.7,
            label=f"{WAYS[direction]}, {text}",
            gid=f"median:{direction}",
            **MARKERS[direction],
        )
        if order is not None and summary.verdict != "no limit" and error[sequence.own] > 0:
            through = error[sequence.own] * (q / sequence.step_size[sequence.own]) ** order
            ax.plot(q, through, color=colour, linestyle="--", linewidth=0.6, gid=f"order:{direction}")
    ax.axhline(100 * tolerance, color="0.45", linestyle=":", linewidth=0.6, gid="tolerance")
    ax.set(xscale="log", yscale="log")
    ax.set_xticks(q, [sequence.shown(value) for value in sequence.values[above]])
    ax.xaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ax.yaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    ax.set_ylabel("median error (%)")
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0.1, handlelength=1.4, frameon=False)


def convergence(folder: Path) -> Drawing:
    """A row per sequence: V_tip(x) for each value by direction, and the median error over the step size."""
    study = read_study(folder)
    directions = study.directions()
    n = len(study.sequences)
    spans = [
        max(np.ptp(s.stations[d].x_m) if s.stations[d].x_m.size else 0 for s in study.sequences)
        for d in directions
    ]
    widths = [max(0.7, 2.6 * span / (sum(spans) or 1)) for span in spans]
    figure = Figure(figsize=(PAGE_MM / 25.4, 2.0 * n + 0.3), layout="constrained")
    axes = figure.subplots(n, len(directions) + 1, squeeze=False, width_ratios=[*widths, 1.5])
    speeds = np.concatenate([s.stations[d].v.ravel() for s in study.sequences for d in directions])
    speeds = speeds[np.isfinite(speeds)]
    top = 1.3 * np.percentile(speeds, HIGHEST_PERCENTILE) if speeds.size else 1
    for row, sequence in zip(axes, study.sequences, strict=True):
        colours = matplotlib.colormaps["viridis"](np.linspace(0.85, 0.1, len(sequence.values)))
        for ax, direction in zip(row, directions, strict=False):
            draw_speeds(ax, sequence, direction, colours)
            ax.set_ylim(0, top)
        row[0].set_ylabel(f"{V_LABEL}, {NAMES.get(sequence.parameter, sequence.parameter)}")
        widest = int(np.argmax(widths))
        row[widest].legend(ncols=2, loc="best", handlelength=1.4, columnspacing=1.0)
        draw_errors(row[-1], sequence, directions, study.tolerance)
    for ax in axes[-1][:-1]:
        ax.set_xlabel("$x$ (mm)")
    figure.suptitle(
        f"{plain(study.title)}; $V_\\mathrm{{tip}}$ over {1e3 * study.l_star_m:.3g} mm, "
        f"tolerance {percent(study.tolerance)}",
        fontsize=7.5,
    )
    caption = (
        "Front speed for each value of a numerical parameter, the case's own thick; dots: extrapolated; "
        "bars: error of the case's own, grey against the extrapolated value, orange where there is none: a "
        "lower bound. Right: median error of each value, and the observed order (of the stations that have "
        "one)."
    )
    return Drawing("convergence", figure, caption)
