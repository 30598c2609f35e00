# SPDX-License-Identifier: BSD-3-Clause
"""The paper's events on deformable bases: speeds at equal traction ratio and energy rise, tip pressure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.files import Table, read_json_table, read_table
from slipfront.folder import result_file

from drawing import paper_style
from drawing.results import PAPER_BAND, PAPER_FIT

SUMMARY = "bases.json"
POINTS = "bases_points.csv"
#: Fronts against and along the imposed shear.
DIRECTIONS = {-1: ("against the shear", "#d55e00"), 1: ("along it", "#0072b2")}


def points_of(table: Table, base: str) -> dict[str, np.ndarray]:
    """Columns of the points on one base, undefined cells as NaN."""
    here = np.array(table.texts("base")) == base
    names = ("direction", "x_m", "v_tip_over_c_L", "t_d_over_p_d", "energy_rise", "p_r_over_p_s", "in_tail")
    return {name: table.numbers(name, finite=False)[here] for name in names}


def draw_points(ax: Axes, points: dict[str, np.ndarray], x: str, y: str, base: str) -> None:
    for direction, (_, colour) in DIRECTIONS.items():
        for tail, marker in ((0, "o"), (1, "x")):
            here = (points["direction"] == direction) & (points["in_tail"] == tail)
            gid = f"{base}:{x}:{direction}:{tail}"
            ax.plot(
                points[x][here],
                points[y][here],
                marker,
                color=colour,
                markersize=1.8,
                markeredgewidth=0.4,
                gid=gid,
            )


def draw_paper(ax: Axes) -> tuple[Artist, ...]:
    """The paper's curve in its band; returns parts of a legend entry."""
    rise = np.linspace(0, 2, 200)
    curve = PAPER_FIT(rise)
    ax.fill_between(rise, curve - PAPER_BAND, curve + PAPER_BAND, color="0.85", linewidth=0)
    (line,) = ax.plot(rise, curve, color="0.3", linewidth=0.7, label="the paper's fit and band")
    return Patch(facecolor="0.85"), line


def words(value: float | None, digits: int = 2) -> str:
    if value is None:
        return "-"
    return f"{round(value, digits) + 0.0:.{digits}f}"  # no -0


def draw(folder: Path) -> Drawing:
    summary: dict[str, Any] = read_json_table(result_file(folder / SUMMARY))
    table = read_table(result_file(folder / POINTS))
    bases = summary["bases"]
    figure = style.new_figure(style.PAGE_MM, 45 * len(bases) + 12)
    axes = figure.subplots(len(bases), 3, squeeze=False, sharex="col")
    for row, base in zip(axes, bases, strict=True):
        points = points_of(table, base["name"])
        draw_points(row[0], points, "t_d_over_p_d", "v_tip_over_c_L", base["name"])
        paper = draw_paper(row[1])
        draw_points(row[1], points, "energy_rise", "v_tip_over_c_L", base["name"])
        points["x_mm"] = style.mm(points["x_m"])
        draw_points(row[2], points, "x_mm", "p_r_over_p_s", base["name"])
        row[2].axhline(1, **style.REFERENCE)
        ratio = base["speed_ratio"]
        row[0].set_title(f"{base['name']}: $V$ against / along = {words(ratio['median'])}", loc="left")
        share = base["share_in_paper_band"]
        within = "-" if share is None else f"{100 * share:.0f} %"
        row[1].set_title(f"{within} of the points in the paper's band", loc="left")
        change = base["pressure_change"]
        percent = [words(None if change[k] is None else 100 * change[k], 0) for k in ("against", "along")]
        row[2].set_title(f"pressure: {percent[0]} % against, {percent[1]} % along", loc="left")
        row[0].set(ylabel=style.V_LABEL, ylim=(0, 3), xlim=(0, 1.3))
        row[1].set(ylabel=style.V_LABEL, ylim=(0, 3), xlim=(0, 2))
        row[2].set(ylabel="$p_r / p_s$", ylim=(0, 3), xlim=(0, 200))
    for ax, label in zip(
        axes[-1], (paper_style.DYNAMIC_LABEL, paper_style.ENERGY_LABEL, "$x$ (mm)"), strict=True
    ):
        ax.set_xlabel(label)
    handles = [
        axes[0, 0].plot([], [], "o", color=colour, markersize=2.5, label=f"fronts {name}")[0]
        for name, colour in DIRECTIONS.values()
    ]
    tails = axes[0, 0].plot([], [], "x", color="0.4", markersize=2.5, label="last 20 mm before a front's end")
    style.legend_below(figure, [*handles, *tails, paper], 4)
    return Drawing("bases", figure, "")
