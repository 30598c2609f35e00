# SPDX-License-Identifier: BSD-3-Clause
"""A run at a glance: slip rate along the interface over time, and the speed of its fronts.

usage: python -m slipfront.figures.rupture PICTURE DIR, output folder of `slipfront run`"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, command_to_draw, write_results
from slipfront.opened import OpenRun, drawn_history, open_run

DECADES = 3.0  # of slip rate below the highest that are told apart
WAVES: dict[str, style.Line] = {"c_L": "-", "c_S": "--", "c_R": ":"}


def unit(largest: float, name: str) -> tuple[float, str]:
    """Factor and unit in which numbers up to the largest have few digits."""
    for power, prefix in ((0, ""), (3, "m"), (6, "µ")):
        if largest * 10**power >= 0.3:
            return 10.0**power, prefix + name
    return 1e9, "n" + name


def draw_slip_rate(ax: Axes, run: OpenRun) -> AxesImage | QuadMesh:
    history = drawn_history(run)
    time_s, x_m = (history[name].to_numpy() for name in ("time_s", "x_m"))
    rate = np.abs(history["slip_rate_m_per_s"].to_numpy())
    highest = float(np.max(rate)) or 1.0
    lowest = highest / 10**DECADES
    to_x, x_unit = unit(run.parameter("plate.width_m"), "m")
    to_t, t_unit = unit(float(time_s[-1]), "s")
    image = ax.pcolorfast(
        to_x * style.cell_edges(x_m),
        to_t * style.cell_edges(time_s),
        # A floor below the range: the logarithm of zero would be drawn as open.
        np.ma.masked_where(history["p_Pa"].to_numpy() <= 0, np.maximum(rate, 0.1 * lowest)),
        cmap=colormaps["YlGnBu"].with_extremes(under="white", bad=style.OPEN_COLOUR),
        norm=LogNorm(lowest, highest),
        gid="rate",
    )
    for front in run.front_list:
        colour = style.DIRECTION_COLOURS[front.direction]
        style.draw_front(ax, to_x * front.x_m, to_t * front.onset_s, colour, f"front:{front.id}")
    ax.set(
        xlabel=f"$x$ ({x_unit})",
        ylabel=f"$t$ ({t_unit})",
        xlim=(0, to_x * run.parameter("plate.width_m")),
        ylim=(0, to_t * time_s[-1]),
    )
    return image


def draw_speeds(ax: Axes, run: OpenRun) -> None:
    """Front speeds over c_S, with the plate's wave speeds; faster nodes than the axis has are counted."""
    c_S = run.fact("wave_speeds.c_S_m_per_s")
    to_x, x_unit = unit(run.parameter("plate.width_m"), "m")
    for front in run.front_list:
        colour = style.DIRECTION_COLOURS[front.direction]
        ax.plot(to_x * front.x_m, front.v_tip_m_per_s / c_S, color=colour, gid=f"speed:{front.id}")
    style.wave_speed_lines(ax, run, c_S, WAVES)
    highest = 1.3 * run.c_L_m_per_s / c_S
    ax.set(
        xlabel=f"$x$ ({x_unit})",
        ylabel=r"$V_\mathrm{tip} / c_\mathrm{S}$",
        xlim=(0, to_x * run.parameter("plate.width_m")),
        ylim=(0, highest),
    )
    above = sum(int(np.sum(front.v_tip_m_per_s / c_S > highest)) for front in run.front_list)
    if above:
        ax.set_title(f"{above} {'node' if above == 1 else 'nodes'} above the axis", loc="right", pad=3)


def handles_of(run: OpenRun) -> list[Artist]:
    """Legend entries of what is in both panels."""
    colours = {way: style.DIRECTION_COLOURS[way] for way in sorted({f.direction for f in run.front_list})}
    names = {way: f"fronts {words}" for way, words in style.DIRECTION_WORDS.items()}
    fronts = [Line2D([], [], color=colours[way], linewidth=1.2, label=names[way]) for way in colours]
    has_open = bool((run.history["p_Pa"] <= 0).any())
    return [*fronts, *([Patch(facecolor=style.OPEN_COLOUR, label="contact open")] if has_open else [])]


def rupture(run: OpenRun) -> Drawing:
    figure = style.new_figure(style.PAGE_MM, 77)
    left, right = figure.subplots(1, 2)
    bar: style.Look = {"label": "slip rate $|v|$ (m/s)", "extend": "min", "pad": 0.02, "aspect": 30}
    figure.colorbar(draw_slip_rate(left, run), ax=left, **bar)
    draw_speeds(right, run)
    handles = handles_of(run)
    if handles:
        style.legend_below(figure, handles, len(handles))
    caption = (
        "Left: slip rate along the interface over time, on a logarithmic scale, white a thousand times below "
        "its largest value, grey where the contact is open; outlined: onsets of the fronts. Right: their "
        "speed over c<sub>S</sub> of the plate, with its wave speeds."
    )
    return Drawing("rupture", figure, caption)


def draw(folder: Path) -> Drawing:
    run = open_run(folder)
    return rupture(run).marked(run.mark)


main = command_to_draw(
    "slipfront.figures.rupture",
    "Draws slip rate and front speeds of a run.",
    "slipfront run",
    partial(write_results, draw=draw),
)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
