# SPDX-License-Identifier: BSD-3-Clause
"""What channels recorded of events."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from slipfront.channels import KINDS
from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.records import Event

MOST_EVENTS, MOST_ROWS = 6, 12
POINTS = 2000  # of a trace


def trace(time_s: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and values, the least and the largest of each piece of a long record."""
    n = len(values)
    width = -(-n // POINTS)
    if width < 2:
        return time_s, values
    starts = np.arange(0, n, width)
    ends = [of.reduceat(values, starts) for of in (np.fmin, np.fmax)]
    return np.repeat(time_s[starts], 2), np.ravel(ends, order="F")


def draw_records(events: Iterable[Event]) -> Drawing:
    """A column per event, a row per gauge or channel: the first of each."""
    shown = [event for _, event in zip(range(MOST_EVENTS), events, strict=False)]
    rows: dict[str, str] = {}
    for event in shown:
        rows |= {channel.gauge: KINDS[channel.kind].unit for channel in event.channels.values()}
    names = list(rows)[:MOST_ROWS]
    figure = style.new_figure(max(style.COLUMN_MM, 58 * len(shown)), 20 + 30 * max(len(names), 1))
    axes = figure.subplots(max(len(names), 1), max(len(shown), 1), squeeze=False)
    for k, event in enumerate(shown):
        axes[0, k].set_title(f"event {event.number}, {event.time_s:.7g} s", loc="left")
        axes[-1, k].set_xlabel("$t$ (ms)")
        for row, name in enumerate(names):
            ax, of = axes[row, k], [c for c in event.channels.values() if c.gauge == name]
            factor, unit = (1e6, "µε") if of and of[0].kind.startswith("strain") else (1.0, rows[name])
            for channel in of:
                time_s, values = trace(channel.time_s, channel.values)
                ax.plot(1e3 * time_s, factor * values, label=plain(channel.name), linewidth=0.5)
            if k == 0:
                ax.set_ylabel(f"{plain(name)} ({unit})" if unit != "1" else plain(name))
            if len(of) > 1 and k == len(shown) - 1:
                ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return Drawing("records", figure, "")
