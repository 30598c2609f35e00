# SPDX-License-Identifier: BSD-3-Clause
"""The look of all figures: sizes of a journal's columns, fonts, and one colour, line and marker per event."""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib.patheffects as path_effects
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slipfront.read import Front, Run

COLUMN_MM = 84.0
PAGE_MM = 174.0

RC = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with Matplotlib: the same figure on every machine
    "mathtext.fontset": "dejavusans",
    "font.size": 7.0,
    "axes.titlesize": 7.0,
    "axes.labelsize": 7.0,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.edgecolor": "none",
    "legend.fancybox": False,
    "legend.framealpha": 0.85,
    "legend.handlelength": 2.8,
    "legend.borderaxespad": 0.3,
    "axes.linewidth": 0.5,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.2,
    "lines.markeredgewidth": 0.6,
    "hatch.linewidth": 0.4,
    "pdf.fonttype": 42,
    "savefig.dpi": 250,
}


@dataclass(frozen=True)
class EventStyle:
    label: str
    colour: str
    line: str | tuple
    marker: str


EVENT_STYLES = {
    "left": EventStyle("left-triggered", "#0072b2", (0, (4.5, 1.8)), "s"),
    "spontaneous": EventStyle("spontaneous", "#000000", "-", "o"),
    "right": EventStyle("right-triggered", "#d55e00", (0, (6, 1.5, 1, 1.5)), "^"),
    "spontaneous_mu_k_1.0": EventStyle("spontaneous, $\\mu_k = 1.0$", "#117733", "-", "o"),
}
REFERENCE = {"color": "0.45", "linewidth": 0.5, "zorder": 0.5}  # wave speeds, mu_s

V_LABEL = r"$V_\mathrm{tip} / c_\mathrm{L}$"
STATIC_LABEL = r"$t_s / p_s$"
DYNAMIC_LABEL = r"$t_d / p_d$"
ENERGY_LABEL = r"$(U_r - U_s) / U_s$"


def mm(length_m):
    return np.asarray(length_m) * 1e3


def new_figure(width_mm: float, height_mm: float, constrained: bool = True) -> Figure:
    return Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained" if constrained else None)


def x_axis(ax: Axes, run: Run) -> None:
    """The axis along the interface, in mm over the width of the plate."""
    ax.set(xlabel="$x$ (mm)", xlim=(0, 1e3 * run.parameter("plate.width_m")))
    ax.locator_params(axis="x", nbins=4)


def panel_letter(ax: Axes, letter: str) -> None:
    ax.set_title(f"({letter})", loc="left", fontweight="bold", pad=3)


def outlined(colour: str, width: float) -> list:
    """Path effects that keep a thin line or letter readable on any ground."""
    return [path_effects.withStroke(linewidth=width, foreground=colour)]


def name_level(ax: Axes, level: float, label: str, below: bool = False) -> None:
    """A label outside the right end of a horizontal line, where it hides nothing."""
    ax.annotate(
        label,
        (1, level),
        xycoords=ax.get_yaxis_transform(),
        xytext=(2.5, 1.5 if below else -1.5),
        textcoords="offset points",
        ha="left",
        va="top" if below else "bottom",
        color="0.3",
        fontsize=6,
        annotation_clip=False,
    )


def wave_speed_lines(ax: Axes, run: Run, waves: tuple[str, ...] = ("c_L", "c_S", "c_R")) -> None:
    """Wave speeds over c_L as thin horizontal lines, named at the right end."""
    for wave in waves:
        level = run.fact(f"wave_speeds.{wave}_m_per_s") / run.c_L_m_per_s
        ax.axhline(level, linestyle=":" if wave == "c_R" else "-", gid=wave, **REFERENCE)
        name_level(ax, level, rf"$c_\mathrm{{{wave[-1]}}}$", below=wave == "c_R")


def pale(colour: str) -> tuple:
    """The colour mixed with white."""
    return tuple(1 - 0.5 * (1 - np.array(to_rgb(colour))))


def draw_front(
    ax: Axes, run: Run, front: Front, x: np.ndarray, y: np.ndarray, weak: np.ndarray, line=None
) -> None:
    """A main front's path in a plane of two of its measures; broken where one is undefined.

    Markers, every 10 mm of path, are filled for a front against the imposed shear and open for one along it.
    Its weak points are drawn as a thin pale line.
    """
    style = EVENT_STYLES[run.name]
    name = f"{run.name}:{front.id}"
    every = max(1, round(10e-3 / np.median(np.abs(np.diff(front.x_m)))))
    ax.plot(
        np.where(weak, np.nan, x),
        np.where(weak, np.nan, y),
        color=style.colour,
        linestyle=style.line if line is None else line,
        marker=style.marker,
        markevery=(every // 2, every),
        markerfacecolor=style.colour if front.direction < 0 else "white",
        gid=name,
    )
    if weak.any():
        # With one more point at each side the two lines meet.
        wider = weak | np.roll(weak, 1) | np.roll(weak, -1)
        wider[[0, -1]] = weak[[0, -1]]
        draw_pale(ax, run, np.where(wider, x, np.nan), np.where(wider, y, np.nan), f"{name}:weak")


def draw_pale(ax: Axes, run: Run, x: np.ndarray, y: np.ndarray, gid: str) -> None:
    ax.plot(x, y, color=pale(EVENT_STYLES[run.name].colour), linewidth=0.5, zorder=1.2, gid=gid)


def event_handles(runs: list[Run]) -> list[Line2D]:
    """Legend entries of events."""
    styles = [EVENT_STYLES[run.name] for run in runs]
    return [Line2D([], [], color=s.colour, linestyle=s.line, marker=s.marker, label=s.label) for s in styles]
