# SPDX-License-Identifier: BSD-3-Clause
"""A series of events: where their fronts run, how fast, and which way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.measures import slices_of
from slipfront.units import engineering

if TYPE_CHECKING:
    from slipfront.fronts_command import Found

MARKS = {1: ">", -1: "<"}
MOST_NAMES = 40  # of events at the axis
ROW = 0.34  # between fronts of one event, in events


def speeds_along(x: np.ndarray, onset: np.ndarray) -> np.ndarray:
    """Between neighbouring onsets of a front; those at one time are infinitely fast."""
    with np.errstate(divide="ignore"):
        return np.abs(np.diff(x)) / np.abs(np.diff(onset))


def draw_series(found: list[Found]) -> Drawing:
    """Left: the fronts of each event over place, coloured by the speed between neighbouring onsets, a mark
    at the front's end that points its way. Right: speeds of the stretches, with their intervals."""
    figure = style.new_figure(style.PAGE_MM, 42 + min(max(6 * len(found), 40), 180))
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.4, 1))
    segments, speeds = [], []
    x_all = np.concatenate([of.record["x_m"].to_numpy() for of in found])
    place = engineering("m", x_all)
    for number, of in enumerate(found):
        x, onset = (of.fronts[name].to_numpy() for name in ("x_m", "onset_s"))
        parts = slices_of(of.fronts)
        for k, (part, way) in enumerate(zip(parts, of.fronts["direction"].to_numpy(), strict=True)):
            at = place.factor * x[part]
            y = number + (ROW * (k / (len(parts) - 1) - 0.5) if len(parts) > 1 else 0.0)
            segments += [[(a, y), (b, y)] for a, b in zip(at, at[1:], strict=False)]
            speeds += speeds_along(x[part], onset[part]).tolist()
            left.plot(
                at, np.full(len(at), y), "|", color="0.2", markersize=2.5, markeredgewidth=0.4, zorder=3
            )
            left.plot(at[-1], y, MARKS[int(way)], color="0.1", markersize=4, zorder=4)
        for k in range(of.stretches.sizes["stretch"]):
            stretch = of.stretches.isel(stretch=k)
            speed, low, high = (float(stretch[f"speed_{end}m_per_s"]) for end in ("", "low_", "high_"))
            if not np.isfinite(speed):
                continue
            way = int(stretch["direction"])
            colour = style.DIRECTION_COLOURS[way]
            share = of.stretches.sizes["stretch"]
            y = number + ROW * ((k + 0.5) / share - 0.5)
            ends = np.array([[speed - low], [high - speed if np.isfinite(high) else 0.0]])
            right.errorbar(
                [speed], [y], xerr=ends, fmt=MARKS[way], color=colour, markersize=4, elinewidth=0.7
            )
            if not np.isfinite(high):
                right.annotate(
                    "", (speed * 1.5, y), (speed, y), arrowprops={"arrowstyle": "->", "color": colour}
                )
    known = np.array([v for v in speeds if np.isfinite(v) and v > 0])
    if known.size:
        fast = np.where(np.isfinite(speeds), speeds, known.max())
        limits = LogNorm(float(known.min()), float(known.max()) * (1 + 1e-9))
        lines = LineCollection(segments, cmap="viridis", norm=limits, linewidths=3, zorder=2)
        lines.set_array(fast)
        left.add_collection(lines)
        figure.colorbar(lines, ax=left, location="top", label="speed between neighbours (m/s)", aspect=40)
    margin = 0.03 * float(np.ptp(place.factor * x_all))
    left.set(xlabel=f"$x$ ({place.name})", ylabel="event",
             xlim=(place.factor * x_all.min() - margin, place.factor * x_all.max() + margin),
             ylim=(len(found) - 0.4, -0.6))  # fmt: skip
    each = -(-len(found) // MOST_NAMES)
    names = ["" if of.event is None else str(of.event) for of in found]
    left.set_yticks(range(0, len(found), each), names[::each])
    right.set(xlabel="speed of a stretch (m/s)", xscale="log")
    ways = {int(way) for of in found for way in of.fronts["direction"].to_numpy()}
    handles = [
        Line2D([], [], marker=MARKS[way], color=style.DIRECTION_COLOURS[way], linestyle="none",
               label=style.DIRECTION_WORDS[way])
        for way in sorted(ways)
    ]  # fmt: skip
    right.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    right.xaxis.set_major_formatter(ScalarFormatter())
    right.xaxis.set_minor_formatter(NullFormatter())
    right.grid(axis="y", color="0.9", linewidth=0.4)
    if handles:
        style.legend_below(figure, handles, 2)
    return Drawing("front_series", figure, "")
