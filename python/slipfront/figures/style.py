# SPDX-License-Identifier: BSD-3-Clause
"""The look of all figures: sizes of a journal's columns, fonts, and one colour, line and marker per event."""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib.patheffects as path_effects
import numpy as np
from matplotlib.axes import Axes
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
    "savefig.dpi": 300,
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


def wave_speed_lines(ax: Axes, run: Run, waves: tuple[str, ...] = ("c_L", "c_S", "c_R")) -> None:
    """Wave speeds over c_L as thin horizontal lines, named at the right end."""
    for wave in waves:
        level = run.fact(f"wave_speeds.{wave}_m_per_s") / run.c_L_m_per_s
        ax.axhline(level, linestyle=":" if wave == "c_R" else "-", gid=wave, **REFERENCE)
        ax.annotate(
            rf"$c_\mathrm{{{wave[-1]}}}$",
            (1, level),
            xycoords=ax.get_yaxis_transform(),
            xytext=(-2, -1.5 if wave == "c_R" else 2.5),
            textcoords="offset points",
            ha="right",
            va="top" if wave == "c_R" else "bottom",
            color="0.35",
            fontsize=6,
        )


def draw_front(ax: Axes, run: Run, front: Front, x: np.ndarray, y: np.ndarray, line=None) -> Line2D:
    """A front's path in a plane of two of its measures; broken where one is undefined.

    Markers, every 10 mm of path, are filled for a front against the imposed shear and open for one along it.
    """
    style = EVENT_STYLES[run.name]
    spacing_m = np.median(np.abs(np.diff(front.x_m)))
    every = max(1, round(10e-3 / spacing_m))
    (drawn,) = ax.plot(
        x,
        y,
        color=style.colour,
        linestyle=style.line if line is None else line,
        marker=style.marker,
        markevery=(every // 2, every),
        markerfacecolor=style.colour if front.direction < 0 else "white",
        gid=f"{run.name}:{front.id}",
    )
    return drawn


def event_handles(runs: list[Run]) -> list[Line2D]:
    """Legend entries of events."""
    styles = [EVENT_STYLES[run.name] for run in runs]
    return [Line2D([], [], color=s.colour, linestyle=s.line, marker=s.marker, label=s.label) for s in styles]
