# SPDX-License-Identifier: BSD-3-Clause
"""The look of the paper's figures: one colour, line and marker per event."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from slipfront.figures.style import Line, Look
from slipfront.opened import OpenRun
from slipfront.read import Front

Colour = tuple[float, float, float]


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
TIP_MARKER = [(0, 0), (-0.5, 1.0), (0.5, 1.0), (0, 0)]  # a triangle that stands on the tip
STATIC_LABEL = r"$t_s / p_s$"
DYNAMIC_LABEL = r"$t_d / p_d$"
ENERGY_LABEL = r"$(U_r - U_s) / U_s$"


def pale(colour: str) -> Colour:
    """The colour mixed with white."""
    red, green, blue = (1 - 0.5 * (1 - part) for part in to_rgb(colour))
    return red, green, blue


def front_gid(run: OpenRun, front: Front, part: str = "") -> str:
    """What a front's line is called: the plain name for the nodes that count, a part for others."""
    return f"{run.name}:{front.id}" + (f":{part}" if part else "")


def fill(event: EventStyle, direction: int) -> str:
    """Markers are filled for fronts against the imposed shear, open for those along it."""
    return event.front(direction).colour if direction < 0 else "white"


def draw_line(
    ax: Axes, run: OpenRun, front: Front, x: np.ndarray, y: np.ndarray, line: Line | None = None
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


def draw_points(ax: Axes, run: OpenRun, front: Front, x: np.ndarray, y: np.ndarray, part: str = "") -> None:
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


def draw_pale(ax: Axes, run: OpenRun, front: Front, x: np.ndarray, y: np.ndarray, part: str) -> None:
    """What is shown for completeness only: thin, light and behind all else."""
    look: Look = {"color": pale(EVENT_STYLES[run.name].colour), "linewidth": 0.5, "zorder": 1.2}
    ax.plot(x, y, gid=front_gid(run, front, part), **look)


def event_handles(runs: list[OpenRun]) -> list[Line2D]:
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
