# SPDX-License-Identifier: BSD-3-Clause
"""The look of all figures: sizes of a journal's columns, fonts, axes along the interface, wave speeds.

For figures of one's own: `matplotlib.rc_context(RC)` while they are drawn, and the functions below."""

from __future__ import annotations

from typing import Any, Literal

import matplotlib.patheffects as path_effects
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from slipfront.opened import OpenRun

COLUMN_MM = 84.0
TEXT_MM = 120.0
PAGE_MM = 174.0

#: Matplotlib's keyword arguments for lines, patches and texts.
Look = dict[str, Any]
#: A line style: a name, or an offset and the lengths of dashes and gaps.
Line = Literal["-", "--", ":", "none"] | tuple[float, tuple[float, ...]]

#: Matplotlib types the keys of its settings one by one.
RC: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with Matplotlib: the same figure on every machine
    "mathtext.fontset": "dejavusans",
    "font.size": 7.0,
    "axes.titlesize": 7.0,
    "axes.labelsize": 7.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
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


#: Of fronts by their direction: readable on white and, outlined, on the slip rate.
DIRECTION_COLOURS = {-1: "#d55e00", 1: "#882255"}
DIRECTION_WORDS = {-1: "to $-x$", 1: "to $+x$"}
OPEN_COLOUR = "0.8"  # of open contact, over place and time
REFERENCE: Look = {"color": "0.45", "linewidth": 0.5, "zorder": 0.5}  # wave speeds, mu_s

V_NAME = r"$V_\mathrm{tip}$"
V_LABEL = r"$V_\mathrm{tip} / c_\mathrm{L}$"


def mm(length_m: ArrayLike) -> np.ndarray:
    """Lengths in mm."""
    return np.asarray(length_m) * 1e3


def new_figure(width_mm: float, height_mm: float, constrained: bool = True) -> Figure:
    """A figure whose axes find their places, or, unconstrained, are placed by hand."""
    return Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained" if constrained else None)


def x_axis(ax: Axes, run: OpenRun) -> None:
    """The axis along the interface, in mm over the width of the plate."""
    ax.set(xlabel="$x$ (mm)", xlim=(0, 1e3 * run.parameter("plate.width_m")))
    ax.locator_params(axis="x", nbins=4)


def panel_letter(ax: Axes, letter: str) -> None:
    """A bold (a) above the left end of a panel."""
    ax.set_title(f"({letter})", loc="left", fontweight="bold", pad=3)


def outlined(colour: str, width: float) -> list[path_effects.AbstractPathEffect]:
    """Path effects that keep a thin line or letter readable on any ground."""
    return [path_effects.withStroke(linewidth=width, foreground=colour)]


def cell_edges(x: np.ndarray) -> np.ndarray:
    """Borders of the cells around ascending points, half-way between them."""
    half = 0.5 * np.diff(x)
    return np.concatenate([[x[0] - half[0]], x[:-1] + half, [x[-1] + half[-1]]])


def draw_front(ax: Axes, x: np.ndarray, time: np.ndarray, colour: str, gid: str) -> None:
    """The onsets along a front, outlined: its colour is seen on any slip rate."""
    ax.plot(x, time, color=colour, linewidth=1.0, path_effects=outlined("white", 2.2), gid=gid)


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
        annotation_clip=False,
    )


def wave_speed_lines(ax: Axes, run: OpenRun, unit_m_per_s: float, lines: dict[str, Line]) -> None:
    """Wave speeds of the plate, by their names, as thin horizontal lines, named at the right end."""
    for wave, line in lines.items():
        level = run.fact(f"wave_speeds.{wave}_m_per_s") / unit_m_per_s
        ax.axhline(level, linestyle=line, gid=wave, **REFERENCE)
        name_level(ax, level, rf"$c_\mathrm{{{wave[-1]}}}$", below=wave == "c_R")


def legend_below(figure: Figure, handles: list[Any], n_columns: int) -> None:
    """A legend under the axes, where it hides nothing; of handles in a tuple the last one has the label."""
    labels = [(handle[-1] if isinstance(handle, tuple) else handle).get_label() for handle in handles]
    figure.legend(handles, labels, loc="outside lower center", ncols=n_columns, columnspacing=1.2)
