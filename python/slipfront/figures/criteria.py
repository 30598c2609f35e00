# SPDX-License-Identifier: BSD-3-Clause
"""Front speed against static ratio, dynamic ratio and energy, and the dynamic ratio along x."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.figures.results import (
    DRAWN_LENGTH_M,
    HIGH_MU_K,
    MAIN_LENGTH_M,
    NUCLEATION_M,
    TAIL_M,
    Results,
    at_nucleation,
    away_from_trigger,
    drawn_fronts,
    in_tail,
    main_fronts,
)
from slipfront.read import Front, Run

SELECTION = (
    "Strong lines: main fronts, that is, the longest of an event in each direction if at least "
    f"{1e3 * MAIN_LENGTH_M:g} mm long; thin pale lines: other fronts of at least {1e3 * DRAWN_LENGTH_M:g} mm"
)
NUCLEATION = f", and the first {1e3 * NUCLEATION_M:g} mm of a front that nucleates by itself"
TAIL = f", and the last {1e3 * TAIL_M:g} mm before a front arrests or runs out of contact"
OMITTED = "Points in and next to the trigger zones are left out."
HIGHEST_V = 3.0  # the axis ends there at the latest: the speed diverges where fronts nucleate or meet
LARGEST_RISE = 5.0  # the relative energy rise as well, where the stored energy vanishes
DIRECTIONS = "Filled markers: the front runs against the imposed shear; open markers: along it."

Measure = Callable[[Front], np.ndarray]


def speed(run: Run) -> Measure:
    return lambda front: front.v_tip_m_per_s / run.c_L_m_per_s


def draw_fronts(ax: Axes, run: Run, x: Measure, y: Measure, weak=None, lines: dict | None = None) -> None:
    """Two measures of a run's fronts against each other, without points next to a trigger zone.

    weak(run, front) tells which points of main fronts are drawn pale; lines gives dashes by direction.
    """
    main = {front.id for front in main_fronts(run)}
    for front in drawn_fronts(run):
        shown = away_from_trigger(run, front.x_m)
        x_shown, y_shown = np.where(shown, x(front), np.nan), np.where(shown, y(front), np.nan)
        if front.id not in main:
            style.draw_pale(ax, run, x_shown, y_shown, f"{run.name}:{front.id}:other")
            continue
        pale = weak(run, front) if weak is not None else np.full(len(shown), False)
        style.draw_front(
            ax, run, front, x_shown, y_shown, pale, lines[front.direction] if lines is not None else None
        )


def speed_over_static_ratio(ax: Axes, runs: list[Run]) -> None:
    for run in runs:
        draw_fronts(ax, run, lambda front: front.static_ratio, speed(run), at_nucleation)
    ax.set(xlabel=style.STATIC_LABEL, ylabel=style.V_LABEL)


def drawn_points(ax: Axes) -> np.ndarray:
    """All points of the fronts drawn, each once, without undefined ones. [points, 2]"""
    lines = [np.column_stack(line.get_data()) for line in ax.lines if ":" in (line.get_gid() or "")]
    points = np.concatenate([np.empty((0, 2)), *lines])
    return np.unique(points[np.isfinite(points).all(axis=1)], axis=0)


def largest(ax: Axes, axis: int) -> float:
    """Largest coordinate along the strong lines; a running median of three passes over single outliers."""
    top = 0.0
    for line in ax.lines:
        if (line.get_gid() or "").count(":") != 1:
            continue
        values = np.column_stack(line.get_data())
        values = values[np.isfinite(values).all(axis=1), axis]
        if len(values) >= 3:
            values = np.median(np.lib.stride_tricks.sliding_window_view(values, 3), axis=1)
        top = max(top, np.max(values, initial=0.0))
    return float(top)


def finish(ax: Axes, run: Run) -> str:
    """Speed axis from zero to the fastest main front but at most HIGHEST_V, with thin lines at wave speeds.

    Returns a sentence for the caption where points lie outside the axes, else nothing.
    """
    points = drawn_points(ax)
    ax.set_ylim(0, np.clip(1.08 * largest(ax, 1), 1.15, HIGHEST_V))
    style.wave_speed_lines(ax, run)
    beyond = ((points[:, 1] > ax.get_ylim()[1]) | (points[:, 0] > ax.get_xlim()[1])).sum()
    return f" {beyond} of {len(points)} points lie outside the axes." if beyond else ""


def static_ratio_mu_k(results: Results) -> Drawing:
    run = results.runs[HIGH_MU_K]
    colour = style.EVENT_STYLES[run.name].colour
    figure = style.new_figure(style.COLUMN_MM, 66)
    ax = figure.subplots()
    lines = {-1: "-", 1: (0, (4.5, 1.8))}
    draw_fronts(ax, run, lambda front: front.static_ratio, speed(run), at_nucleation, lines)
    handles = [
        Line2D([], [], color=colour, linestyle=lines[-1], marker="o", label="against the shear"),
        Line2D(
            [],
            [],
            color=colour,
            linestyle=lines[1],
            marker="o",
            markerfacecolor="white",
            label="along the shear",
        ),
    ]
    measured = "No file of experimental data was given, so none are drawn."
    if results.experiment is not None:
        x, y = results.experiment
        points = ax.plot(
            x, y, linestyle="none", marker="x", color="0.3", label="experiment", gid="experiment", zorder=1
        )
        handles += points
        measured = f"Crosses: the {np.isfinite(x * y).sum()} points of the experimental data file given."
    else:
        ax.annotate(
            "no experimental data given",
            (0.02, 0.02),
            xycoords="axes fraction",
            color="0.45",
            fontsize=5.5,
            va="bottom",
        )
    ax.set(xlabel=style.STATIC_LABEL, ylabel=style.V_LABEL)
    outside = finish(ax, run)
    ax.legend(handles=handles, loc="upper left")
    return Drawing(
        "fig2_static_ratio_mu_k_1.0",
        figure,
        f"Front speed against the static stress ratio, μ<sub>k</sub> = {run.parameter('friction.mu_k')}: "
        f"solid against the imposed shear, dashed along it. Thin lines: wave speeds. "
        f"{SELECTION}{NUCLEATION}.{outside} {measured}",
    )


def weak(run: Run, front: Front) -> np.ndarray:
    """Points where no criterion is expected to hold: at nucleation and before the end. [points]"""
    return at_nucleation(run, front) | in_tail(run, front)


def dynamic_ratio_along_x(results: Results) -> Drawing:
    reference = results.runs["spontaneous"]
    figure = style.new_figure(style.COLUMN_MM, 62)
    ax = figure.subplots()
    (static,) = ax.plot(
        style.mm(reference.static_x_m),
        reference.static_ratio,
        color="0.6",
        linewidth=1.8,
        solid_capstyle="butt",
        label=style.STATIC_LABEL + ", all",
        gid="static",
        zorder=1,
    )
    for run in results.events:
        draw_fronts(ax, run, lambda front: style.mm(front.x_m), lambda front: front.dynamic_ratio)
    mu_s = reference.parameter("friction.mu_s")
    ax.axhline(mu_s, gid="mu_s", **style.REFERENCE)
    style.name_level(ax, mu_s, r"$\mu_s$")
    style.x_axis(ax, reference)
    ax.set_ylabel(style.DYNAMIC_LABEL)
    ax.set_ylim(0, max(ax.get_ylim()[1], 1.12 * mu_s))
    ax.legend(handles=[*style.event_handles(results.events), static], loc="lower center", ncols=2)
    return Drawing(
        "fig4_dynamic_ratio",
        figure,
        "Dynamic stress ratio t<sub>d</sub>/p<sub>d</sub> at each point of the interface at the moment the "
        "front is l* short of it: not one instant but the whole passage. Thick grey line: the static ratio "
        f"t<sub>s</sub>/p<sub>s</sub> before the events; thin line: μ<sub>s</sub>. {DIRECTIONS} "
        f"{SELECTION}. {OMITTED}",
    )


def dynamic_criterion(results: Results) -> Drawing:
    figure = style.new_figure(style.COLUMN_MM, 66)
    ax = figure.subplots()
    for run in results.events:
        draw_fronts(ax, run, lambda front: front.dynamic_ratio, speed(run), weak)
    ax.set(xlabel=style.DYNAMIC_LABEL, ylabel=style.V_LABEL)
    outside = finish(ax, results.events[0])
    ax.legend(handles=style.event_handles(results.events), loc="upper left")
    return Drawing(
        "fig5_dynamic_criterion",
        figure,
        "Front speed against the dynamic stress ratio t<sub>d</sub>/p<sub>d</sub> for the three events. "
        f"Thin lines: wave speeds. {DIRECTIONS} {SELECTION}{NUCLEATION}{TAIL}. {OMITTED}{outside}",
    )


def energy(results: Results) -> Drawing:
    figure = style.new_figure(style.COLUMN_MM, 66)
    ax = figure.subplots()
    for run in results.events:
        draw_fronts(ax, run, lambda front: front.energy_rise, speed(run), weak)
    right = np.clip(1.1 * largest(ax, 0), 1.0, LARGEST_RISE)
    r = right * np.linspace(0, 1, 400) ** 2  # closer at zero, where the fit is steep
    band = ax.fill_between(
        r,
        results.paper_fit(r) - results.paper_a_band,
        results.paper_fit(r) + results.paper_a_band,
        color="0.85",
        linewidth=0,
        label="fit and band of the paper",
        gid="paper_band",
        zorder=0,
    )
    handles = [*style.event_handles(results.events), band]
    text = "Too few points for a fit of our own."
    if results.fit is not None:
        (line,) = ax.plot(
            r,
            results.fit(r),
            color="#7b3294",
            linestyle=(0, (1, 1)),
            linewidth=1.6,
            label="fit, this program",
            gid="fit",
            zorder=1.5,  # below the fronts
        )
        handles.insert(3, line)
        text = (
            f"Dotted: a + b exp(−c √r) fitted to the program's points, a = {results.fit.a:.2f}, "
            f"b = {results.fit.b:.2f}, c = {results.fit.c:.2f}."
        )
    ax.set(xlabel=style.ENERGY_LABEL, ylabel=style.V_LABEL)
    ax.set_xlim(0, right)
    outside = finish(ax, results.events[0])
    ax.legend(handles=handles, loc="upper right")
    paper = results.paper_fit
    return Drawing(
        "fig6_energy",
        figure,
        "Front speed against the relative rise of the energy density at the tip, r = (U<sub>r</sub> − "
        f"U<sub>s</sub>)/U<sub>s</sub>. Grey: the paper's fit, a = {paper.a:.2f} ± "
        f"{results.paper_a_band:.2f}, b = {paper.b:.2f}, c = {paper.c:.2f}. {text} Thin lines: wave speeds. "
        f"{DIRECTIONS} {SELECTION}{NUCLEATION}{TAIL}. {OMITTED}{outside}",
    )
