# SPDX-License-Identifier: BSD-3-Clause
"""A sequence of events at a glance: its force, the extents of its events, the slip that they leave, and under
a law with a state the slip rates of all phases.

usage: python -m slipfront.figures.sequence PICTURE DIR, output folder of `slipfront run` with
sequence.max_events above 1"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, command_to_draw, write_results
from slipfront.opened_sequence import OpenSequence, open_sequence
from slipfront.read import even

LOCAL, GLOBAL, PREDICTED = "#0072b2", "#d55e00", "#000000"
MOST_ROWS, MOST_NODES, MOST_LABELS = 1200, 400, 24  # of all phases
LEAST_ROWS = 4  # of a phase
RATE_RANGE_M_PER_S = (1e-12, 1.0)
FORCE_LABEL = r"$F_\mathrm{S} / F_\mathrm{N}$"


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
    """Slip since normal loading, with the slow slip of a law with a state. [events, nodes]"""
    slip, slow = sequence.slip.to_numpy(), sequence.slow
    if len(slow) == 0:
        return np.asarray(np.cumsum(slip, axis=0))
    before = [history["slip_m"][-1].to_numpy() for history in slow[: len(slip)]]
    return np.asarray(slip + before)


def colours(sequence: OpenSequence) -> list[str]:
    """Of each event, by whether it breaks all of the interface."""
    return [GLOBAL if whole else LOCAL for whole in sequence.events["is_global"].to_numpy() == 1]


def draw_force(ax: Axes, sequence: OpenSequence) -> None:
    loading = sequence.loading
    ax.plot(
        style.mm(loading["shear_m"]), loading["shear_over_normal"], linewidth=0.7, color=LOCAL, gid="force"
    )
    pushed = sequence.case["loading"]["pusher_to_m"] > 0
    ax.set(xlabel=f"displacement of the {'pusher' if pushed else 'top edge'} (mm)", ylabel=FORCE_LABEL)


def draw_extents(ax: Axes, sequence: OpenSequence) -> None:
    events = sequence.events
    force = events["friction_before"].to_numpy()
    ends = style.mm(np.stack((events["from_x_m"], events["to_x_m"]), axis=1))
    lines = [np.column_stack((end, (level, level))) for end, level in zip(ends, force, strict=True)]
    ax.add_collection(LineCollection(lines, colors=colours(sequence), linewidths=0.9, gid="extents"))
    look: style.Look = {"linestyle": "none", "marker": "|", "markersize": 4, "color": PREDICTED}
    for column in ("predicted_from_x_m", "predicted_to_x_m"):
        ax.plot(style.mm(events[column]), force, gid=column, **look)
    ax.autoscale_view()
    ax.set(xlabel="$x$ (mm)", ylabel=f"{FORCE_LABEL} where an event begins")


def draw_slip(ax: Axes, sequence: OpenSequence) -> None:
    """What has slipped after each event."""
    slip = sequence.slip
    for number, row, colour in zip(
        slip["event"].to_numpy(), slip_after_events(sequence), colours(sequence), strict=True
    ):
        ax.plot(style.mm(slip["x_m"]), 1e6 * row, linewidth=0.6, color=colour, gid=f"slip:{number}")
    ax.set(xlabel="$x$ (mm)", ylabel="slip after each event (µm)")


def draw_phases(figure: Figure, ax: Axes, sequence: OpenSequence) -> None:
    """Slip rate over place and phase, with the number of each event and when it begins."""
    of = phases(sequence, MOST_ROWS, MOST_NODES)
    image = ax.pcolormesh(
        style.mm(style.cell_edges(of.x_m)),
        of.borders,
        np.clip(of.slip_rate_m_per_s, *RATE_RANGE_M_PER_S),
        cmap=colormaps["YlGnBu"].with_extremes(bad=style.OPEN_COLOUR),
        norm=LogNorm(*RATE_RANGE_M_PER_S),
        rasterized=True,
        gid="phases",
    )
    for level in range(1, round(of.borders[-1])):
        ax.axhline(level, color=GLOBAL if level % 2 == 1 else "black", linewidth=0.5)
    shown = even(sequence.events.sizes["event"], MOST_LABELS)
    begin_s = sequence.events["begin_s"].to_numpy()[shown]
    labels = [f"{1 + k}: {t:.6g} s" for k, t in zip(shown, begin_s, strict=True)]
    ax.set_yticks(1.5 + 2 * shown, labels)
    ax.tick_params(axis="y", length=0)
    ax.set(xlabel="$x$ (mm)", ylabel="slow slip and events, alternately")
    figure.colorbar(image, ax=ax, label="slip rate $|v|$ (m/s)", extend="min", pad=0.02, aspect=40)


def sequence(of: OpenSequence) -> Drawing:
    is_slow, has_events = len(of.slow) > 0, of.events.sizes["event"] > 0
    left, right = ("abc", "d") if has_events else ("a", "b")
    figure = style.new_figure(style.PAGE_MM, 150 if is_slow and has_events else 62)
    if is_slow:
        panels = figure.subplot_mosaic(";".join(letter + right for letter in left), width_ratios=(1, 1.5))
    else:
        panels = figure.subplot_mosaic(left)
    draw_force(panels["a"], of)
    caption = "(a) Shear over normal force along the loading."
    if has_events:
        draw_extents(panels["b"], of)
        draw_slip(panels["c"], of)
        caption += (
            " (b) Extent of each event over that ratio where it begins, orange where all nodes inside slip; "
            "ticks: ends predicted from the tractions before. (c) Slip along the interface after each event."
        )
    if is_slow:
        draw_phases(figure, panels[right], of)
        caption += (
            f" ({right}) Slip rate of phase after phase: slow slip evenly over steps, which are shorter "
            "where it is faster, and above each orange line an event over time; grey: contact is open."
        )
    for letter, ax in panels.items():
        style.panel_letter(ax, letter)
        if letter != "a":
            ax.set_xlim(0, 1e3 * of.case["plate"]["width_m"])
    return Drawing("sequence", figure, caption)


def draw(folder: Path) -> Drawing:
    return sequence(open_sequence(folder))


main = command_to_draw(
    "slipfront.figures.sequence",
    "Draws the force of a sequence of events, their extents and their slip.",
    "`slipfront run` with sequence.max_events above 1",
    partial(write_results, draw=draw),
)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
