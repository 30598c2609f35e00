# SPDX-License-Identifier: BSD-3-Clause
"""The look of all figures: sizes of a journal's columns, fonts, and one colour, line and marker per event."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import matplotlib.patheffects as path_effects
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from slipfront.read import Front, Run

COLUMN_MM = 84.0
TEXT_MM = 120.0
PAGE_MM = 174.0

#: Matplotlib's keyword arguments for lines, patches and texts.
Look = dict[str, Any]
#: A line style: a name, or an offset and the lengths of dashes and gaps.
Line = Literal["-", "--", ":", "none"] | tuple[float, tuple[float, ...]]
Colour = tuple[float, float, float]

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


@dataclass(frozen=True)
class FrontStyle:
    colour: str
    line: Line


@dataclass(frozen=True)
class EventStyle:
    """The look of an event and of its main fronts, by their direction."""

    label: str
    marker: str
    fronts: dict[int, FrontStyle]

    def front(self, direction: int) -> FrontStyle:
        """Of the main front in a direction; of a front in another one as of the event's own."""
        return self.fronts.get(direction, next(iter(self.fronts.values())))

    @property
    def colour(self) -> str:
        return next(iter(self.fronts.values())).colour


EVENT_STYLES = {
    "left": EventStyle("left-triggered", "s", {1: FrontStyle("#0072b2", (0, (4.5, 1.8)))}),
    "spontaneous": EventStyle(
        "spontaneous", "o", {-1: FrontStyle("#000000", "-"), 1: FrontStyle("#cc79a7", "-")}
    ),
    "right": EventStyle("right-triggered", "^", {-1: FrontStyle("#d55e00", (0, (6, 1.5, 1, 1.5)))}),
    "spontaneous_mu_k_1.0": EventStyle(
        "spontaneous, $\\mu_k = 1.0$", "o", {-1: FrontStyle("#117733", "-"), 1: FrontStyle("#999933", "-")}
    ),
}
#: Of fronts of any other run, by their direction: readable on white and, outlined, on the slip rate.
DIRECTION_COLOURS = {-1: "#d55e00", 1: "#882255"}
DIRECTION_WORDS = {-1: "to $-x$", 1: "to $+x$"}
TIP_MARKER = [(0, 0), (-0.5, 1.0), (0.5, 1.0), (0, 0)]  # a triangle that stands on the tip
REFERENCE: Look = {"color": "0.45", "linewidth": 0.5, "zorder": 0.5}  # wave speeds, mu_s

V_NAME = r"$V_\mathrm{tip}$"
V_LABEL = r"$V_\mathrm{tip} / c_\mathrm{L}$"
STATIC_LABEL = r"$t_s / p_s$"
DYNAMIC_LABEL = r"$t_d / p_d$"
ENERGY_LABEL = r"$(U_r - U_s) / U_s$"


def mm(length_m: ArrayLike) -> np.ndarray:
    return np.asarray(length_m) * 1e3


def new_figure(width_mm: float, height_mm: float, constrained: bool = True) -> Figure:
    return Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained" if constrained else None)


def x_axis(ax: Axes, run: Run) -> None:
    """The axis along the interface, in mm over the width of the plate."""
    ax.set(xlabel="$x$ (mm)", xlim=(0, 1e3 * run.parameter("plate.width_m")))
    ax.locator_params(axis="x", nbins=4)


def panel_letter(ax: Axes, letter: str) -> None:
    ax.set_title(f"({letter})", loc="left", fontweight="bold", pad=3)


def outlined(colour: str, width: float) -> list[path_effects.AbstractPathEffect]:
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
        annotation_clip=False,
    )


def wave_speed_lines(ax: Axes, run: Run, waves: tuple[str, ...] = ("c_L", "c_S", "c_R")) -> None:
    """Wave speeds over c_L as thin horizontal lines, named at the right end."""
    for wave in waves:
        level = run.fact(f"wave_speeds.{wave}_m_per_s") / run.c_L_m_per_s
        ax.axhline(level, linestyle=":" if wave == "c_R" else "-", gid=wave, **REFERENCE)
        name_level(ax, level, rf"$c_\mathrm{{{wave[-1]}}}$", below=wave == "c_R")


def pale(colour: str) -> Colour:
    """The colour mixed with white."""
    red, green, blue = (1 - 0.5 * (1 - part) for part in to_rgb(colour))
    return red, green, blue


def front_gid(run: Run, front: Front, part: str = "") -> str:
    """What a front's line is called: the plain name for the nodes that count, a part for others."""
    return f"{run.name}:{front.id}" + (f":{part}" if part else "")


def fill(event: EventStyle, direction: int) -> str:
    """Markers are filled for fronts against the imposed shear, open for those along it."""
    return event.front(direction).colour if direction < 0 else "white"


def draw_line(
    ax: Axes, run: Run, front: Front, x: np.ndarray, y: np.ndarray, line: Line | None = None
) -> None:
    """A main front as a line with a marker every 10 mm of path; broken where it is undefined."""
    style = EVENT_STYLES[run.name]
    every = max(1, round(10e-3 / np.median(np.abs(np.diff(front.x_m)))))
    ax.plot(
        x,
        y,
        color=style.front(front.direction).colour,
        linestyle=style.front(front.direction).line if line is None else line,
        marker=style.marker,
        markevery=(every // 2, every),
        markerfacecolor=fill(style, front.direction),
        gid=front_gid(run, front),
    )


def draw_points(ax: Axes, run: Run, front: Front, x: np.ndarray, y: np.ndarray, part: str = "") -> None:
    """A main front as a marker per node; those of a part in a pale colour."""
    style = EVENT_STYLES[run.name]
    own = style.front(front.direction).colour
    colour = pale(own) if part else own
    ax.plot(
        x,
        y,
        linestyle="none",
        marker=style.marker,
        markersize=2.4,
        markeredgewidth=0.5,
        color=colour,
        markerfacecolor=colour if front.direction < 0 else "white",
        zorder=1.6 if part else 2.0,
        gid=front_gid(run, front, part),
    )


def draw_pale(ax: Axes, run: Run, front: Front, x: np.ndarray, y: np.ndarray, part: str) -> None:
    """What is shown for completeness only: thin, light and behind all else."""
    look: Look = {"color": pale(EVENT_STYLES[run.name].colour), "linewidth": 0.5, "zorder": 1.2}
    ax.plot(x, y, gid=front_gid(run, front, part), **look)


def event_handles(runs: list[Run]) -> list[Line2D]:
    """Legend entries of the events' main fronts, with their direction where an event has two."""
    names = {-1: ", against", 1: ", along"}
    return [
        Line2D(
            [],
            [],
            color=look.colour,
            linestyle=look.line,
            marker=event.marker,
            markerfacecolor=fill(event, way),
            label=event.label + (names[way] if len(event.fronts) > 1 else ""),
        )
        for event in (EVENT_STYLES[run.name] for run in runs)
        for way, look in event.fronts.items()
    ]


def fill_handles() -> list[Line2D]:
    """Legend entries that tell what filled and open markers mean."""
    look: Look = {"color": "0.35", "linestyle": "none", "marker": "o"}
    return [
        Line2D([], [], markerfacecolor="0.35", label="filled: against the shear", **look),
        Line2D([], [], markerfacecolor="white", label="open: along the shear", **look),
    ]


def pale_handle(colour: str = "#000000") -> Line2D:
    return Line2D([], [], color=pale(colour), linewidth=0.5, label="other fronts and nodes")


def legend_below(figure: Figure, handles: list[Any], n_columns: int) -> None:
    """A legend under the axes, where it hides nothing; of handles in a tuple the last one has the label."""
    labels = [(handle[-1] if isinstance(handle, tuple) else handle).get_label() for handle in handles]
    figure.legend(handles, labels, loc="outside lower center", ncols=n_columns, columnspacing=1.2)
