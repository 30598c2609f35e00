# SPDX-License-Identifier: BSD-3-Clause
"""Front speed against static ratio, dynamic ratio and energy, and the dynamic ratio along x."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.figures.main_fronts import (
    DRAWN_LENGTH_M,
    NUCLEATION_M,
    SLOW_OVER_C_L,
    away_from_trigger,
    counted,
    drawn_fronts,
    main_fronts,
    slow_end,
)
from slipfront.opened import OpenRun
from slipfront.read import Front
from slipfront.report.run_data import HIGHEST_V, LARGEST_RISE

from drawing import paper_style, sketch
from drawing.results import HIGH_MU_K, Fit, MainFrontsFit, Results

SELECTION = (
    "Strong: main fronts, the longest in each direction that starts at the event's nucleation or trigger, to "
    f"the last node before V<sub>tip</sub> stays below {SLOW_OVER_C_L:g} c<sub>L</sub> or the front ends, "
    "without the trigger zone and its margin or the "
    f"{1e3 * NUCLEATION_M:g} mm around a spontaneous nucleation. Thin and light: their other nodes, and "
    f"other fronts of at least {1e3 * DRAWN_LENGTH_M:g} mm."
)
WAVES: dict[str, style.Line] = {"c_L": "-", "c_S": "-", "c_R": ":"}
TAIL_M = 20e-3  # the last stretch before a front is over, where the paper sees fronts leave its criterion
SHORTEST_FALL_M = 5e-3  # a stretch over which V_tip falls while t_d / p_d rises
FIT_COLOUR = "#7b3294"

Measure = Callable[[Front], np.ndarray]


def speed(run: OpenRun) -> Measure:
    return lambda front: front.v_tip_m_per_s / run.c_L_m_per_s


def tail(run: OpenRun, front: Front) -> np.ndarray:
    """Whether a main front's nodes count and lie in the last TAIL_M of those that do. [points]

    A front that may still run when the record ends has no such end.
    """
    count = counted(run, front)
    if slow_end(speed(run)(front)) == len(count) and run.told(front, "end") == "record_end":
        return np.full(len(count), False)
    return count & (np.abs(front.x_m - front.x_m[count][-1]) <= TAIL_M * (1 + 1e-9))


def draw_fronts(
    ax: Axes,
    run: OpenRun,
    x: Measure,
    y: Measure,
    lines: dict[int, style.Line] | None = None,
    as_points: bool = False,
) -> None:
    """Two measures of a run's fronts against each other, without points next to a trigger zone.

    Main fronts are lines, with dashes by direction where `lines` gives them, or points, their tails pale.
    """
    main = main_fronts(run)
    for front in main + [front for front in drawn_fronts(run) if front not in main]:
        shown = away_from_trigger(run, front.x_m)

        def where(
            part: np.ndarray, front: Front = front, shown: np.ndarray = shown
        ) -> tuple[np.ndarray, np.ndarray]:
            counts = part & shown
            return np.where(counts, x(front), np.nan), np.where(counts, y(front), np.nan)

        if front not in main:
            paper_style.draw_pale(ax, run, front, *where(shown), "other")
            continue
        count = counted(run, front)
        if not count[shown].all():
            paper_style.draw_pale(ax, run, front, *where(widened(~count)), "weak")
        if as_points:
            end = tail(run, front)
            paper_style.draw_points(ax, run, front, *where(count & ~end))
            paper_style.draw_points(ax, run, front, *where(end), "tail")
        else:
            paper_style.draw_line(
                ax, run, front, *where(count), lines[front.direction] if lines is not None else None
            )


def widened(part: np.ndarray) -> np.ndarray:
    """With one more point at each side, so that its line meets the other's."""
    wider = part.copy()
    wider[1:] |= part[:-1]
    wider[:-1] |= part[1:]
    return wider


def speed_over_static_ratio(ax: Axes, runs: list[OpenRun]) -> None:
    for run in runs:
        draw_fronts(ax, run, lambda front: front.static_ratio, speed(run))
    ax.set(xlabel=paper_style.STATIC_LABEL, ylabel=style.V_LABEL)


def drawn_points(ax: Axes) -> np.ndarray:
    """All points of the fronts drawn, each once, without undefined ones. [points, 2]"""
    lines = [np.column_stack(line.get_data()) for line in ax.lines if ":" in (line.get_gid() or "")]
    points = np.concatenate([np.empty((0, 2)), *lines])
    return np.unique(points[np.isfinite(points).all(axis=1)], axis=0)


def largest(ax: Axes, axis: int) -> float:
    """Largest coordinate of the main fronts; a running median of three passes over single outliers."""
    top = 0.0
    for line in ax.lines:
        name = (line.get_gid() or "").split(":")
        if len(name) == 1 or name[-1] in ("weak", "other"):
            continue
        values = np.column_stack(line.get_data())
        values = values[np.isfinite(values).all(axis=1), axis]
        if len(values) >= 3:
            values = np.median(np.lib.stride_tricks.sliding_window_view(values, 3), axis=1)
        top = max(top, np.max(values, initial=0.0))
    return float(top)


def finish(ax: Axes, run: OpenRun) -> str:
    """Speed axis from zero to the fastest main front but at most HIGHEST_V, with thin lines at wave speeds.

    Returns a sentence for the caption where points lie outside the axes, else nothing.
    """
    points = drawn_points(ax)
    ax.set_ylim(0, np.clip(1.08 * largest(ax, 1), 1.15, HIGHEST_V))
    style.wave_speed_lines(ax, run, run.c_L_m_per_s, WAVES)
    beyond = ((points[:, 1] > ax.get_ylim()[1]) | (points[:, 0] > ax.get_xlim()[1])).sum()
    return f" {beyond} of {len(points)} points lie outside the axes." if beyond else ""


def static_ratio_mu_k(results: Results) -> Drawing:
    run = results.runs[HIGH_MU_K]
    figure = style.new_figure(style.TEXT_MM, 84)
    ax = figure.subplots()
    lines: dict[int, style.Line] = {-1: (0, (4.5, 1.8)), 1: "-"}
    draw_fronts(ax, run, lambda front: front.static_ratio, speed(run), lines)
    event = paper_style.EVENT_STYLES[run.name]
    handles = [
        Line2D(
            [],
            [],
            color=event.front(way).colour,
            linestyle=lines[way],
            marker=event.marker,
            markerfacecolor=paper_style.fill(event, way),
            label=words,
        )
        for way, words in ((1, "front along the shear"), (-1, "front against the shear"))
    ]
    handles.append(paper_style.pale_handle(event.colour))
    ax.set(xlabel=paper_style.STATIC_LABEL, ylabel=style.V_LABEL)
    outside = finish(ax, run)
    style.legend_below(figure, handles, 3)
    return Drawing(
        "fig2_static_ratio_mu_k_1.0",
        figure,
        f"Front speed against the static stress ratio, μ<sub>k</sub> = {run.parameter('friction.mu_k')}: "
        "solid along the imposed shear, dashed against it. Thin horizontal lines: wave speeds. "
        f"{SELECTION}{outside}",
    )


def dynamic_ratio_along_x(results: Results) -> Drawing:
    reference = results.runs["spontaneous"]
    figure = style.new_figure(style.TEXT_MM, 90)
    ax = figure.subplots()
    (static,) = ax.plot(
        style.mm(reference.x_m),
        reference.static_ratio,
        color="0.6",
        linewidth=1.8,
        solid_capstyle="butt",
        label=paper_style.STATIC_LABEL + ", all events",
        gid="static",
        zorder=1,
    )
    for run in results.events:
        draw_fronts(ax, run, lambda front: style.mm(front.x_m), lambda front: front.dynamic_ratio)
    mu_s = reference.parameter("friction.mu_s")
    ax.axhline(mu_s, gid="mu_s", **style.REFERENCE)
    style.name_level(ax, mu_s, r"$\mu_s$")
    style.x_axis(ax, reference)
    ax.set_ylabel(paper_style.DYNAMIC_LABEL)
    ax.set_ylim(0, max(ax.get_ylim()[1], 1.12 * mu_s))
    sketch.dynamic_ratio(ax.inset_axes((0.16, 0.035, 0.5, 0.3)))
    handles = [
        *paper_style.event_handles(results.events),
        *paper_style.fill_handles(),
        paper_style.pale_handle(),
        static,
    ]
    style.legend_below(figure, handles, 3)
    return Drawing(
        "fig4_dynamic_ratio",
        figure,
        "Dynamic stress ratio t<sub>d</sub>/p<sub>d</sub> at each point of the interface at the moment the "
        "front is l* short of it: not one instant but the whole passage. Thick grey line: the static ratio "
        "t<sub>s</sub>/p<sub>s</sub> before the events; thin line: μ<sub>s</sub>. Inset, a sketch: "
        "t<sub>d</sub> and p<sub>d</sub> belong to the sticking node ahead (in the ring) when the one "
        f"before it begins to slip (filled). {SELECTION}",
    )


def falls(run: OpenRun, front: Front) -> np.ndarray:
    """Whether a main front's nodes belong to a stretch where V_tip falls while t_d / p_d rises. [points]"""
    count = counted(run, front)
    step = (np.diff(front.v_tip_m_per_s) < 0) & (np.diff(front.dynamic_ratio) > 0) & count[1:] & count[:-1]
    borders = np.flatnonzero(np.diff(step, prepend=False, append=False))
    part = np.full(len(count), False)
    for first, last in borders.reshape(-1, 2):
        part[first : last + 1] = abs(front.x_m[last] - front.x_m[first]) >= SHORTEST_FALL_M
    return part


def underlay_falls(ax: Axes, runs: list[OpenRun]) -> list[Line2D]:
    """A broad light line under stretches where the general trend is reversed; returns its legend entry."""
    look: style.Look = {"color": "#f0e442", "linewidth": 6, "alpha": 0.75, "solid_capstyle": "butt"}
    found = False
    for run in runs:
        for front in main_fronts(run):
            part = falls(run, front)
            found = found or bool(part.any())
            x, y = (np.where(part, values, np.nan) for values in (front.dynamic_ratio, speed(run)(front)))
            ax.plot(x, y, gid=paper_style.front_gid(run, front, "falls"), zorder=0.8, **look)
    return (
        [Line2D([], [], label=f"{style.V_NAME} falls, {paper_style.DYNAMIC_LABEL} rises", **look)]
        if found
        else []
    )


def dynamic_criterion(results: Results) -> Drawing:
    figure = style.new_figure(style.TEXT_MM, 90)
    ax = figure.subplots()
    for run in results.events:
        draw_fronts(ax, run, lambda front: front.dynamic_ratio, speed(run))
    ax.set(xlabel=paper_style.DYNAMIC_LABEL, ylabel=style.V_LABEL)
    outside = finish(ax, results.events[0])
    reversed_trend = underlay_falls(ax, results.events)
    handles = [
        *paper_style.event_handles(results.events),
        *paper_style.fill_handles(),
        paper_style.pale_handle(),
        *reversed_trend,
    ]
    style.legend_below(figure, handles, 3)
    return Drawing(
        "fig5_dynamic_criterion",
        figure,
        "Front speed against the dynamic stress ratio t<sub>d</sub>/p<sub>d</sub> for the three events. "
        f"Yellow: stretches of main fronts, at least {1e3 * SHORTEST_FALL_M:g} mm long, where "
        "V<sub>tip</sub> falls while t<sub>d</sub>/p<sub>d</sub> rises. "
        f"Thin horizontal lines: wave speeds. {SELECTION}{outside}",
    )


def draw_paper_fit(ax: Axes, results: Results, r: np.ndarray) -> tuple[Artist, ...]:
    """The paper's curve in its band; returns parts of a legend entry."""
    fit = results.paper_fit(r)
    low, high = fit - results.paper_a_band, fit + results.paper_a_band
    ax.fill_between(r, low, high, color="0.85", linewidth=0, gid="paper_band", zorder=0)
    look: style.Look = {"color": "0.55", "linewidth": 0.8}
    ax.plot(r, fit, gid="paper_fit", zorder=0.4, **look)
    return Patch(facecolor="0.85"), Line2D([], [], label="the paper's fit and band", **look)


def draw_own_fit(ax: Axes, results: Results, fit: Fit, r: np.ndarray) -> tuple[Artist, ...]:
    """Our curve, its interval where its points are; returns parts of a legend entry."""
    look: style.Look = {"color": FIT_COLOUR, "linestyle": (0, (1, 1)), "linewidth": 1.4}
    ax.plot(r, fit(r), gid="fit", zorder=2.2, **look)
    if len(results.fit_interval) == 0:
        return (Line2D([], [], label="fit to all points (C18)", **look),)
    shade: style.Look = {"color": FIT_COLOUR, "alpha": 0.22, "linewidth": 0}
    ax.fill_between(*results.fit_interval.T, gid="fit_interval", zorder=0.3, **shade)
    return Patch(**shade), Line2D([], [], label="fit to all points (C18)", **look)


def draw_main_fronts_fit(ax: Axes, main_fit: MainFrontsFit, r: np.ndarray) -> Line2D:
    """The curve of the second test; returns its legend entry."""
    look: style.Look = {"color": FIT_COLOUR, "linestyle": "-", "linewidth": 1.0}
    ax.plot(r, main_fit.fit(r), gid="main_fronts_fit", zorder=2.3, **look)
    return Line2D([], [], label=f"fit to main fronts ({main_fit.id})", **look)


def main_fronts_sentence(main_fit: MainFrontsFit | None) -> str:
    if main_fit is None:
        return ""
    return (
        f" Solid: fitted to the main fronts without their last {1e3 * TAIL_M:g} mm ({main_fit.id}): "
        f"{escape(main_fit.measured)}."
    )


def fit_sentence(results: Results) -> str:
    """Both fits in numbers."""
    paper, own = results.paper_fit, results.fit
    text = (
        f"Grey: a + b exp(−c √r) as the paper gives it, a = {paper.a:.2f} ± {results.paper_a_band:.2f}, "
        f"b = {paper.b:.2f}, c = {paper.c:.2f}. "
    )
    if own is None:
        return text + "Too few points for a fit of our own."
    intervals = [results.interval_of_fit(name) for name in "abc"]
    values = (
        f"{name} = {getattr(own, name):.2f}" + (f" [{i[0]:.2f}, {i[1]:.2f}]" if i is not None else "")
        for name, i in zip("abc", intervals, strict=True)
    )
    return (
        f"{text}Dotted: the same law fitted to all points of the program's fronts, those of the thin lines "
        f"too (C18, the first test), {', '.join(values)}; shaded: the curve's bootstrap interval."
        f"{main_fronts_sentence(results.main_fronts_fit)}"
    )


def energy(results: Results) -> Drawing:
    figure = style.new_figure(style.TEXT_MM, 94)
    ax = figure.subplots()
    for run in results.events:
        draw_fronts(ax, run, lambda front: front.energy_rise, speed(run), as_points=True)
    right = np.clip(1.1 * largest(ax, 0), 1.0, LARGEST_RISE)
    r = right * np.linspace(0, 1, 400) ** 2  # closer at zero, where the fit is steep
    fits: list[Any] = [draw_paper_fit(ax, results, r)]
    if results.fit is not None:
        fits.append(draw_own_fit(ax, results, results.fit, r))
    if results.fit is not None and results.main_fronts_fit is not None:
        fits.append(draw_main_fronts_fit(ax, results.main_fronts_fit, r))
    ax.set(xlabel=paper_style.ENERGY_LABEL, ylabel=style.V_LABEL)
    ax.set_xlim(0, right)
    outside = finish(ax, results.events[0])
    sketch.energies(ax.inset_axes((0.4, 0.66, 0.57, 0.3)))
    events = paper_style.event_handles(results.events)
    for handle in events:
        handle.set_linestyle("none")
        handle.set_markersize(4)
    tails = Line2D([], [], color="0.6", linestyle="none", marker="o", label=f"pale: last {1e3 * TAIL_M:g} mm")
    handles = [*events, tails, *paper_style.fill_handles(), paper_style.pale_handle(), *fits]
    style.legend_below(figure, handles, 3)
    return Drawing(
        "fig6_energy",
        figure,
        "Front speed against the relative rise of the energy density at the tip, r = (U<sub>r</sub> − "
        f"U<sub>s</sub>)/U<sub>s</sub>. {fit_sentence(results)} Thin horizontal lines: wave speeds. Inset, a "
        "sketch: U<sub>s</sub> is stored at the node in the ring when the tip reaches it, U<sub>r</sub> when "
        f"it is about to slip. {SELECTION} Pale markers: the last {1e3 * TAIL_M:g} mm of a main "
        f"front.{outside}",
    )
