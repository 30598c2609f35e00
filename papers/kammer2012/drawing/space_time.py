# SPDX-License-Identifier: BSD-3-Clause
"""Slip rate along the interface over time."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.figures.main_fronts import DRAWN_LENGTH_M, drawn_fronts, start
from slipfront.opened import OpenRun, drawn_history

from drawing import paper_style
from drawing.results import Results

RATE_RANGE_M_PER_S = (0.1, 30.0)
WAVES: dict[str, style.Line] = {"c_L": "-", "c_S": (0, (4, 2)), "c_R": (0, (1, 1.2))}


def draw_waves(ax: Axes, run: OpenRun) -> None:
    """Lines of the wave speeds from the start of the first front, both ways where there is room."""
    began = start(run)
    if began is None:
        return
    width_m = run.parameter("plate.width_m")
    for direction in (-1, 1):
        room_m = width_m - began[0] if direction > 0 else began[0]
        if room_m < 0.1 * width_m:
            continue
        for wave, line in WAVES.items():
            end_s = began[1] + room_m / run.fact(f"wave_speeds.{wave}_m_per_s")
            ax.plot(
                style.mm([began[0], began[0] + direction * room_m]),
                1e6 * np.array([began[1], end_s]),
                color="0.25",
                linestyle=line,
                linewidth=0.6,
                path_effects=style.outlined("white", 1.4),
                gid=f"{wave}:{direction}",
            )


def front_handles(colours: dict[int, str]) -> list[Artist]:
    """Legend entries of fronts by their direction; one for all where the colours are the same."""
    look: style.Look = {"linewidth": 1.2}
    if len(set(colours.values())) == 1:
        return [Line2D([], [], color=next(iter(colours.values())), label="front", **look)]
    names = {way: f"front {words}" for way, words in style.DIRECTION_WORDS.items()}
    return [Line2D([], [], color=colour, label=names[way], **look) for way, colour in colours.items()]


def add_legend(figure: Figure, colours: dict[int, str]) -> None:
    """Above the axes: wave speeds under fronts and the open contact."""
    upper = [*front_handles(colours), Patch(facecolor=style.OPEN_COLOUR, label="contact open")]
    upper += [Line2D([], [], linestyle="none", label="")] * (len(WAVES) - len(upper))
    lower = [
        Line2D([], [], color="0.25", linestyle=line, linewidth=0.6, label=rf"$c_\mathrm{{{wave[-1]}}}$")
        for wave, line in WAVES.items()
    ]
    columns = [handle for pair in zip(upper, lower, strict=True) for handle in pair]
    labels = [str(handle.get_label()) for handle in columns]
    figure.legend(columns, labels, loc="outside upper center", ncols=len(WAVES))


def space_time(results: Results, name: str) -> Drawing:
    run = results.runs[name]
    history = drawn_history(run)
    time_s, x_m = (history[name].to_numpy() for name in ("time_s", "x_m"))
    figure = style.new_figure(style.COLUMN_MM, 76)
    ax = figure.subplots()
    # A floor below the range: the logarithm of zero would be drawn as open.
    rate = np.maximum(np.abs(history["slip_rate_m_per_s"].to_numpy()), 0.1 * RATE_RANGE_M_PER_S[0])
    image = ax.pcolorfast(
        style.mm(style.cell_edges(x_m)),
        1e6 * style.cell_edges(time_s),
        np.ma.masked_where(history["p_Pa"].to_numpy() <= 0, rate),
        cmap=colormaps["YlGnBu"].with_extremes(under="white", bad=style.OPEN_COLOUR),
        norm=LogNorm(*RATE_RANGE_M_PER_S),
        gid="rate",
    )
    draw_waves(ax, run)
    event = paper_style.EVENT_STYLES[name]
    fronts = drawn_fronts(run)
    for front in fronts:
        colour = event.front(front.direction).colour
        style.draw_front(ax, style.mm(front.x_m), 1e6 * front.onset_s, colour, f"{name}:{front.id}")
    style.x_axis(ax, run)
    ax.set(ylabel="$t$ (µs)", ylim=(1e6 * time_s[0], 1e6 * time_s[-1]))
    ways = sorted({front.direction for front in fronts})
    add_legend(figure, {way: event.front(way).colour for way in ways})
    figure.colorbar(image, ax=ax, label="slip rate $|v|$ (m/s)", extend="max", pad=0.02, aspect=30)
    label = paper_style.EVENT_STYLES[name].label.replace("$\\mu_k", "μ<sub>k</sub>").replace("$", "")
    return Drawing(
        f"space_time_{name}",
        figure,
        f"Slip rate along the interface over time, {label} event; logarithmic scale, white below "
        f"{RATE_RANGE_M_PER_S[0]:g} m/s, grey where the contact is open. Outlined: onsets of the fronts at "
        f"least {1e3 * DRAWN_LENGTH_M:g} mm long, in the colours of the other figures. Thin lines from the "
        "start of the first front: c<sub>L</sub> (solid), c<sub>S</sub> (dashed), c<sub>R</sub> (dotted).",
    )
