# SPDX-License-Identifier: BSD-3-Clause
"""Record sections: traces of an event at their places, picked onsets and the lines of fronts."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slipfront import command
from slipfront.figures import style
from slipfront.figures.drawing import Drawing, checked, guarded, plain, write_drawing
from slipfront.figures.records import trace as thinned
from slipfront.files import DataError
from slipfront.measures import find_fronts
from slipfront.onsets import NONE
from slipfront.picks import WORDS, Trace, onsets_of, traces_of
from slipfront.records import Event
from slipfront.stretches import speed_stretches
from slipfront.units import engineering

HEIGHT = 1.2  # of a trace, in spacings of places
MARGIN = 0.4  # of the time of all picks that is shown before and behind
LEAST_SAMPLES = 40  # shown before and behind


def rounded(speed: float) -> str:
    """To three digits, without a power of ten."""
    return f"{float(f'{speed:.3g}'):.10g}"


def shown_traces(
    event: Event, picks: xr.Dataset, quiet_s: tuple[float, float] | None
) -> tuple[str, list[Trace]]:
    """The kind that is picked, and all traces of it."""
    picked = set(picks["gauge"].to_numpy().tolist())
    found = list(traces_of(event, quiet_s))
    kind = next((k for k, name, _ in found if name in picked), "")
    made = [make() for k, _, make in found if k == kind]
    return kind, [trace for trace in made if isinstance(trace, Trace)]


def draw_lines(ax: Axes, picks: xr.Dataset, of_time: float, of_place: float) -> None:
    """The stretches of fronts in the picks, with their speeds."""
    (record,) = onsets_of(picks).values()
    if record.sizes["node"] < 2:
        return
    error_s = record["error_s"].to_numpy()
    fronts = find_fronts(record["x_m"], record["onset_s"], time_error_s=error_s, never_slipped=NONE)
    parts = speed_stretches(fronts, time_error_s=error_s)
    of_point = parts["stretch_of_point"].to_numpy()
    for k in range(parts.sizes["stretch"]):
        of = parts.isel(stretch=k)
        at = np.flatnonzero(of_point == k)
        speed, way = float(of["speed_m_per_s"]), int(of["direction"])
        if not np.isfinite(speed):
            continue
        x = fronts["x_m"].to_numpy()[at]
        middle = len(x) // 2
        # The label is amid two traces.
        places = np.array([x.min(), x.max(), (x[middle - 1] + x[middle]) / 2])
        time_s = float(of["at_s"]) + way * (places - float(of["at_m"])) / speed
        ax.plot(
            of_time * time_s[:2], of_place * places[:2], color=style.DIRECTION_COLOURS[way],
            linewidth=1.2, zorder=3, path_effects=style.outlined("white", 2.4), gid=f"stretch {k}",
        )  # fmt: skip
        low, high = float(of["speed_low_m_per_s"]), float(of["speed_high_m_per_s"])
        interval = f" ({rounded(low)} to {rounded(high)})" if np.isfinite(high) else ""
        ax.annotate(
            f"{rounded(speed)} m/s{interval}", (of_time * time_s[2], of_place * places[2]), xytext=(-5, 0),
            textcoords="offset points", va="center", ha="right", color=style.DIRECTION_COLOURS[way], zorder=4,
            path_effects=style.outlined("white", 2.4),
        )  # fmt: skip


def draw_section(event: Event, picks: xr.Dataset, quiet_s: tuple[float, float] | None = None) -> Figure:
    """An event; picks: its own. Each trace is over its own range, its zero at its place."""
    kind, traces = shown_traces(event, picks, quiet_s)
    onset, error = picks["onset_s"].to_numpy(), picks["error_s"].to_numpy()
    x = np.unique([trace.x_m for trace in traces])
    spacing = float(np.median(np.diff(x))) if len(x) > 1 else 1.0
    step_s = max((trace.step_s for trace in traces), default=0.0)
    margin_s = max(MARGIN * float(np.ptp(onset)), LEAST_SAMPLES * step_s, 3 * float(error.max()))
    ends_s = float(onset.min()) - margin_s, float(onset.max()) + margin_s
    time, place = engineering("s", ends_s), engineering("m", x)
    figure = style.new_figure(style.TEXT_MM, 35 + min(max(7 * len(x), 60), 190))
    ax = figure.subplots()
    picked = dict(zip(picks["gauge"].to_numpy().tolist(), range(len(onset)), strict=True))
    for trace in traces:
        inside = (trace.time_s >= ends_s[0]) & (trace.time_s <= ends_s[1])
        if not inside.any():
            continue
        t, v = thinned(trace.time_s[inside], trace.values[inside])
        range_ = float(np.ptp(v)) or 1.0
        y = trace.x_m + HEIGHT * spacing * v / range_
        ax.plot(time.factor * t, place.factor * y, color="0.35" if trace.name in picked else "0.75",
                linewidth=0.5, zorder=1)  # fmt: skip
        ax.annotate(
            plain(trace.name), (1, place.factor * trace.x_m), xycoords=ax.get_yaxis_transform(),
            xytext=(3, 0), textcoords="offset points", va="center", color="0.3",
        )  # fmt: skip
        if trace.name in picked:
            k = picked[trace.name]
            at = onset[k] + trace.lag_s  # where it is seen
            height = np.interp(at, trace.time_s, trace.values)
            ax.plot(
                time.factor * np.array([onset[k], onset[k]]),
                place.factor * (trace.x_m + HEIGHT * spacing / range_ * np.array([0.0, height])),
                color="0.1", linewidth=0.6, linestyle=":", zorder=2,
            )  # fmt: skip
    for doubtful in (False, True):
        of = (picks["doubt"].to_numpy() != "") == doubtful
        if of.any():
            ax.errorbar(
                time.factor * onset[of], place.factor * picks["x_m"].to_numpy()[of],
                xerr=time.factor * error[of], fmt="o", color="0.1", markersize=2.6, elinewidth=0.8,
                markerfacecolor="white" if doubtful else "0.1", zorder=5,
                gid="doubtful" if doubtful else "picks",
            )  # fmt: skip
    draw_lines(ax, picks, time.factor, place.factor)
    by = ", ".join(np.unique(picks["by"].to_numpy()))
    ax.set(
        xlabel=f"$t$ ({time.name})", ylabel=f"$x$ ({place.name})", xlim=time.factor * np.array(ends_s),
        title=f"event {event.number}, {event.time_s:.7g} s: {WORDS.get(kind, '')}, picked by {by}",
    )  # fmt: skip
    if (picks["doubt"].to_numpy() != "").any():
        marks = (("0.1", "pick"), ("white", "pick with a doubt"))
        handles = [Line2D([], [], marker="o", color="0.1", linestyle="none", markersize=2.6,
                          markerfacecolor=colour, label=label) for colour, label in marks]  # fmt: skip
        style.legend_below(figure, handles, 2)
    return figure


def write_sections(
    picture: Path, events: Iterable[Event], picks: xr.Dataset, quiet_s: tuple[float, float] | None = None
) -> None:
    """A page per event that has picks; of kinds other than pdf one event alone."""
    kind = checked(picture).suffix.lower()
    numbers = np.unique(picks["event"].to_numpy())
    if kind != ".pdf" and len(numbers) > 1:
        raise DataError(f"{picture}: one picture of {len(numbers)} events: give one by --event, or a .pdf")

    def drawn(event: Event) -> Figure:
        own = picks.isel(pick=picks["event"].to_numpy() == event.number)
        return guarded(picture, lambda: draw_section(event, own, quiet_s))

    with matplotlib.rc_context(style.RC):
        figures = (drawn(event) for event in events if event.number in numbers)
        if kind != ".pdf":
            write_drawing(picture, Drawing(picture.stem, next(figures), ""))
            return
        with (
            command.publishing_into(picture.parent) as folder,
            PdfPages(folder / picture.name, metadata={"CreationDate": None}) as pages,
        ):
            for figure in figures:
                pages.savefig(figure)
