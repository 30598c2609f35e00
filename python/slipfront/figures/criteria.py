# SPDX-License-Identifier: BSD-3-Clause
"""Front speed against static ratio, dynamic ratio and energy, and the dynamic ratio along x."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.figures.results import DRAWN_LENGTH_M, HIGH_MU_K, Results, drawn_fronts
from slipfront.read import Run

SELECTION = (
    f"Every front at least {1e3 * DRAWN_LENGTH_M:g} mm long is drawn, shorter ones are not; lines break "
    "where a value is undefined, so close to the trigger zones for t<sub>d</sub>/p<sub>d</sub> and what "
    "follows from it."
)
HIGHEST_V = 3.0  # the speed diverges where a front nucleates: the axis must end somewhere
LARGEST_RISE = 5.0  # the relative energy rise as well, where the stored energy vanishes
DIRECTIONS = "Filled markers: the front runs against the imposed shear; open markers: along it."


def speed_over_static_ratio(ax: Axes, runs: list[Run]) -> None:
    for run in runs:
        for front in drawn_fronts(run):
            style.draw_front(ax, run, front, front.static_ratio, front.v_tip_m_per_s / run.c_L_m_per_s)
    ax.set(xlabel=style.STATIC_LABEL, ylabel=style.V_LABEL)


def drawn_points(ax: Axes) -> np.ndarray:
    """All points of the fronts drawn, without undefined ones. [points, 2]"""
    lines = [np.column_stack(line.get_data()) for line in ax.lines if ":" in (line.get_gid() or "")]
    points = np.concatenate([np.empty((0, 2)), *lines])
    return points[np.isfinite(points).all(axis=1)]


def finish(ax: Axes, run: Run) -> str:
    """Speed axis from zero to the fastest point but at most HIGHEST_V, with the wave speeds as thin lines.

    Returns a sentence for the caption where points lie outside the axes, else nothing.
    """
    points = drawn_points(ax)
    ax.set_ylim(0, np.clip(1.06 * np.max(points[:, 1], initial=0.0), 1.15, HIGHEST_V))
    style.wave_speed_lines(ax, run)
    beyond = ((points[:, 1] > ax.get_ylim()[1]) | (points[:, 0] > ax.get_xlim()[1])).sum()
    return f" {beyond} of {len(points)} points lie outside the axes." if beyond else ""


def static_ratio_mu_k(results: Results) -> Drawing:
    run = results.runs[HIGH_MU_K]
    colour = style.EVENT_STYLES[run.name].colour
    figure = style.new_figure(style.COLUMN_MM, 66)
    ax = figure.subplots()
    lines = {-1: "-", 1: (0, (4.5, 1.8))}
    for front in drawn_fronts(run):
        v = front.v_tip_m_per_s / run.c_L_m_per_s
        style.draw_front(ax, run, front, front.static_ratio, v, line=lines[front.direction])
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
        f"{SELECTION}{outside} {measured}",
    )


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
        for front in drawn_fronts(run):
            style.draw_front(ax, run, front, style.mm(front.x_m), front.dynamic_ratio)
    mu_s = reference.parameter("friction.mu_s")
    ax.axhline(mu_s, gid="mu_s", **style.REFERENCE)
    ax.annotate(
        r"$\mu_s$",
        (0.02, mu_s),
        xycoords=ax.get_yaxis_transform(),
        xytext=(0, 1.5),
        textcoords="offset points",
    )
    style.x_axis(ax, reference)
    ax.set_ylabel(style.DYNAMIC_LABEL)
    ax.set_ylim(0, max(ax.get_ylim()[1], 1.12 * mu_s))
    ax.legend(handles=[*style.event_handles(results.events), static], loc="lower center", ncols=2)
    return Drawing(
        "fig4_dynamic_ratio",
        figure,
        "Dynamic stress ratio t<sub>d</sub>/p<sub>d</sub> at each point of the interface at the moment the "
        "front is l* short of it: not one instant but the whole passage. Thick grey line: the static ratio "
        f"t<sub>s</sub>/p<sub>s</sub> before the events; thin line: μ<sub>s</sub>. {DIRECTIONS} {SELECTION}",
    )


def dynamic_criterion(results: Results) -> Drawing:
    figure = style.new_figure(style.COLUMN_MM, 66)
    ax = figure.subplots()
    for run in results.events:
        for front in drawn_fronts(run):
            style.draw_front(ax, run, front, front.dynamic_ratio, front.v_tip_m_per_s / run.c_L_m_per_s)
    ax.set(xlabel=style.DYNAMIC_LABEL, ylabel=style.V_LABEL)
    outside = finish(ax, results.events[0])
    ax.legend(handles=style.event_handles(results.events), loc="upper left")
    return Drawing(
        "fig5_dynamic_criterion",
        figure,
        "Front speed against the dynamic stress ratio t<sub>d</sub>/p<sub>d</sub> for the three events. "
        f"Thin lines: wave speeds. {DIRECTIONS} {SELECTION}{outside}",
    )


def energy(results: Results) -> Drawing:
    figure = style.new_figure(style.COLUMN_MM, 66)
    ax = figure.subplots()
    for run in results.events:
        for front in drawn_fronts(run):
            style.draw_front(ax, run, front, front.energy_rise, front.v_tip_m_per_s / run.c_L_m_per_s)
    right = np.clip(1.05 * np.max(drawn_points(ax)[:, 0], initial=0.0), 1.0, LARGEST_RISE)
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
            linewidth=1.3,
            label="fit, this program",
            gid="fit",
            zorder=3,
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
        f"{DIRECTIONS} {SELECTION}{outside}",
    )
