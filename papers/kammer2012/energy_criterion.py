# SPDX-License-Identifier: BSD-3-Clause
"""Draws what the energy criterion orders, and renews the table of energy-criterion.md."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import matplotlib
import numpy as np
from drawing import paper_style
from drawing.criteria import tail
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from slipfront.figures import style
from slipfront.figures.drawing import write_figure
from slipfront.figures.main_fronts import counted, main_fronts
from slipfront.files import DataError
from slipfront.opened import OpenRun, open_run
from slipfront.pages import Tables, command_to_renew, expecting, read_result, table
from slipfront.read import Front, ratio

AMOUNTS = ("5", "10", "20", "40", "80")
CHOSEN, HELD = "chosen", "chosen, but held"
TRIGGERS = (*(f"amount {amount}" for amount in AMOUNTS), CHOSEN, HELD)
COLOURS = dict(
    zip(TRIGGERS, ("#d55e00", "#e69f00", "#009e73", "#56b4e9", "#332288", "#0072b2", "#cc79a7"), strict=True)
)
#: Line by l* in mm.
SPEED_LENGTH_LINES: dict[str, style.Line] = {
    "0.67": "-",
    "1.33": "--",
    "2.67": (0, (6, 1.5, 1, 1.5)),
    "5.33": ":",
}
BINS = 20  # of a criterion's range, as in the scorecard
CRITERIA = {"energy": "energy_rise", "t_d/p_d": "dynamic_ratio", "t_s/p_s": "static_ratio"}


@dataclass(frozen=True)
class MainFront:
    run: OpenRun
    front: Front
    pressure_d_over_s: np.ndarray  # p_d / p_s [points]

    @cached_property
    def counts(self) -> np.ndarray:
        """Whether a node counts for C18c. [points]"""
        f = self.front
        finite = np.isfinite([f.v_tip_m_per_s, f.static_ratio, f.dynamic_ratio, f.energy_rise]).all(axis=0)
        return counted(self.run, f) & ~tail(self.run, f) & finite

    @property
    def speed(self) -> np.ndarray:
        """V_tip / c_L. [points]"""
        return self.front.v_tip_m_per_s / self.run.c_L_m_per_s

    @property
    def accelerates(self) -> np.ndarray:
        """Whether V_tip rises over the two nodes before and behind a node. [points]"""
        rises = np.full(len(self.front.x_m), False)
        rises[2:-2] = self.speed[4:] > self.speed[:-4]
        return rises


def read_main_fronts(folder: Path) -> list[MainFront]:
    run = open_run(folder)
    ids = run.fronts["front_id"].to_numpy()
    # There is no pressure at the ends of contact.
    pressures = ratio(run.fronts["p_d_Pa"].to_numpy(), run.fronts["p_s_Pa"].to_numpy())
    return [MainFront(run, f, pressures[ids == f.id]) for f in main_fronts(run)]


def first_front(folder: Path, parameter: str, value: float) -> MainFront:
    """The first main front of a study's run.

    :raises DataError: where there is none, or the run has another value of the parameter"""
    fronts = read_main_fronts(folder)
    if not fronts or not np.isclose(fronts[0].run.parameter(parameter), value):
        raise DataError(f"{folder}: not a run with a main front and {parameter} = {value:g}")
    return fronts[0]


def bins_of(fronts: list[MainFront], criterion: str) -> list[dict[int, float]]:
    """In each bin that at least two fronts reach the median V_tip / c_L of each, by its place in the list."""
    x = [getattr(f.front, criterion)[f.counts] for f in fronts]
    low, high = (limit(np.concatenate(x)) for limit in (np.min, np.max))
    medians: list[dict[int, float]] = [{} for _ in range(BINS)]
    for k, (front, values) in enumerate(zip(fronts, x, strict=True)):
        place = np.minimum((BINS * (values - low) / (high - low)).astype(int), BINS - 1)
        for b in np.unique(place):
            medians[b][k] = float(np.median(front.speed[front.counts][place == b]))
    return [bin_ for bin_ in medians if len(bin_) > 1]


def spread(bins: list[dict[int, float]]) -> float:
    """Median over the bins of (largest - smallest)/mean, as a percentage; NaN without bins."""
    relative = [(max(b.values()) - min(b.values())) / np.mean(list(b.values())) for b in bins]
    return 100 * float(np.median(relative)) if relative else np.nan


def percent(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.0f} %"


def row(trigger: str, others: list[MainFront], left: MainFront) -> list[str]:
    fronts = [*others, left]
    by_energy = bins_of(fronts, "energy_rise")
    shared = [bin_ for bin_ in by_energy if len(others) in bin_]
    peak = int(np.argmax(np.where(left.counts, left.front.static_ratio, -np.inf)))
    return [
        f"with the left-triggered front, {trigger}",
        f"{left.speed[left.counts].max():.2f} c_L",
        f"{left.pressure_d_over_s[peak]:.2f}",
        *(percent(spread(bins_of(fronts, criterion))) for criterion in CRITERIA.values()),
        f"{len(shared)} of {len(by_energy)}",
        percent(spread(shared)),
    ]


def row_without(others: list[MainFront]) -> list[str]:
    """Of the fronts of the other two events, in the bins that those of both directions reach."""

    def ways(bin_: dict[int, float]) -> set[int]:
        return {others[k].front.direction for k in bin_}

    bins = ([b for b in bins_of(others, c) if len(ways(b)) == 2] for c in CRITERIA.values())
    return [
        "without it, where both directions occur",
        "-",
        "-",
        *(percent(spread(b)) for b in bins),
        "-",
        "-",
    ]


def tables(others: list[MainFront], lefts: dict[str, MainFront]) -> Tables:
    header = [
        "main fronts",
        "left: maximum",
        "left: p_d/p_s at the maximum of t_s/p_s",
        *(f"spread at equal {name}" for name in ("(U_r-U_s)/U_s", "t_d/p_d", "t_s/p_s")),
        "bins of the energy rise that left shares",
        "spread in these",
    ]
    rows = [row(trigger, others, left) for trigger, left in lefts.items()]
    return {"table": table(header, [*rows, row_without(others)])}


def check_against(scorecard: Path, others: list[MainFront], left: MainFront) -> None:
    """The spreads with the chosen trigger are those of the scorecard's C18c.

    :raises DataError: where they are not"""
    (claim,) = (c for c in read_result(scorecard) if c["id"] == "C18c")
    for figure in claim["figures"]:
        own = spread(bins_of([*others, left], CRITERIA[figure["name"]]))
        if abs(own - figure["value"]) > 0.01:
            raise DataError(
                f"{scorecard}: C18c at equal {figure['name']} is {figure['value']:g} %, here {own:g} %"
            )


def draw_over_x(speeds: Axes, pressures: Axes, lefts: dict[str, MainFront]) -> None:
    for trigger, left in lefts.items():
        x, shown = style.mm(left.front.x_m), left.counts
        for ax, y in ((speeds, left.speed), (pressures, left.pressure_d_over_s)):
            ax.plot(x[shown], y[shown], color=COLOURS[trigger], label=trigger)
    speeds.axhline(1, **style.REFERENCE)
    run = lefts[CHOSEN].run
    peak_mm = style.mm(run.x_m[np.nanargmax(np.where(run.x_m > 0.1, run.static_ratio, np.nan))])
    for ax in (speeds, pressures):
        style.x_axis(ax, run)
        ax.axvline(float(peak_mm), **style.REFERENCE)
    speeds.set(ylabel=style.V_LABEL)
    speeds.legend()
    pressures.set(ylabel="$p_d / p_s$", yscale="log")
    pressures.set_yticks([1, 2, 4], labels=["1", "2", "4"])
    pressures.minorticks_off()


def draw_over_rise(
    ax: Axes, others: list[MainFront], lefts: dict[str, MainFront], paper: dict[str, float]
) -> None:
    rise = np.geomspace(3e-3, 5, 300)
    curve = paper["a"] + paper["b"] * np.exp(-paper["c"] * np.sqrt(rise))
    ax.fill_between(rise, curve - paper["a_band"], curve + paper["a_band"], color="0.9", zorder=0)
    points = [("black", front) for front in others]
    points += [(COLOURS[trigger], lefts[trigger]) for trigger in (CHOSEN, HELD)]
    for colour, front in points:
        for rises, face in ((True, colour), (False, "none")):
            part = front.counts & (front.accelerates == rises)
            ax.plot(
                front.front.energy_rise[part], front.speed[part], "o", color=colour,
                markerfacecolor=face, markersize=2, markeredgewidth=0.4,
            )  # fmt: skip
    ax.set(xlabel=paper_style.ENERGY_LABEL, ylabel=style.V_LABEL, xscale="log", xlim=(3e-3, 5))
    ax.legend(
        loc="upper right",
        handles=[
            Line2D(
                [],
                [],
                color=colour,
                marker="o",
                markersize=3,
                linestyle="none",
                markerfacecolor=face,
                label=label,
            )
            for colour, face, label in (
                ("black", "black", "the other fronts, accelerating"),
                ("black", "none", "and decelerating"),
                (COLOURS[CHOSEN], COLOURS[CHOSEN], f"left, {CHOSEN}"),
                (COLOURS[HELD], COLOURS[HELD], f"left, {HELD}"),
            )
        ],
    )


def draw_speed_lengths(ax: Axes, results: Path) -> None:
    for length, line in SPEED_LENGTH_LINES.items():
        for event, colour in (("spontaneous", "black"), ("left", COLOURS[CHOSEN])):
            length_m = 1e-3 * float(length)
            front = first_front(
                results / "studies/l_star" / f"{length_m:.5f}" / event, "fronts.l_star_m", length_m
            )
            part = front.counts
            ax.plot(front.front.energy_rise[part], front.speed[part], linestyle=line, color=colour)
    ax.set(xlabel=paper_style.ENERGY_LABEL, ylabel=style.V_LABEL, xscale="log")
    ax.axhline(1, **style.REFERENCE)
    ax.legend(
        loc="upper right",
        handles=[
            *(
                Line2D([], [], color="0.4", linestyle=line, label=f"$l^\\ast$ = {mm} mm")
                for mm, line in SPEED_LENGTH_LINES.items()
            ),
            Line2D([], [], color="black", label="spontaneous, to $-x$"),
            Line2D([], [], color=COLOURS[CHOSEN], label="left"),
        ],
    )


def write(results: Path, picture: Path) -> Tables:
    with expecting("results of a reproduction", results), matplotlib.rc_context(style.RC):
        others = [front for event in ("spontaneous", "right") for front in read_main_fronts(results / event)]
        lefts = {
            f"amount {amount}": first_front(
                results / "studies/left_amount" / amount / "left", "event.trigger_over_missing", float(amount)
            )
            for amount in AMOUNTS
        }
        lefts[CHOSEN] = read_main_fronts(results / "left")[0]
        lefts[HELD] = read_main_fronts(results / "studies/trigger_duration/inf/left")[0]
        check_against(results / "scorecard.json", others, lefts[CHOSEN])
        figure = style.new_figure(style.PAGE_MM, 140)
        axes = figure.subplots(2, 2)
        draw_over_x(axes[0, 0], axes[0, 1], lefts)
        draw_over_rise(axes[1, 0], others, lefts, read_result(results / "analysis.json")["paper_fit"])
        draw_speed_lengths(axes[1, 1], results)
        for ax, letter in zip(axes.flat, "abcd", strict=True):
            ax.set_title(f"({letter})", loc="left")
        made = tables(others, lefts)
        write_figure(picture, figure)
    return made


if __name__ == "__main__":
    page = Path(__file__).with_name("energy-criterion.md")
    sys.exit(command_to_renew(__file__, __doc__, page, write, "reproduce.py"))
