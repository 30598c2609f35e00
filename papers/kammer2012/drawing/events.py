# SPDX-License-Identifier: BSD-3-Clause
"""The three events: snapshots of the velocity, and front speed against the static stress ratio."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.patches import FancyArrowPatch
from matplotlib.tri import Triangulation
from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.figures.main_fronts import drawn_fronts, start
from slipfront.files import DataError
from slipfront.opened import OpenRun
from slipfront.read import Front

from drawing import paper_style
from drawing.criteria import SELECTION, finish, speed_over_static_ratio
from drawing.results import Results
from drawing.setup import NO_FIELDS, draw_edges, edges

COLOURS = "Blues_r"
SPEED_RANGE_M_PER_S = (0.0, 2.0)
AIM_OVER_WIDTH = {"left": 0.60, "right": 0.52}  # where the leading tip of a triggered event is shown
SPONTANEOUS_AIM_S = 30e-6  # after nucleation ...
WELL_INSIDE_OVER_WIDTH = 0.05  # ... with both tips at least this far from the edges, if there is such a step


def tips(run: OpenRun, time_s: float) -> list[tuple[Front, float]]:
    """The drawn fronts that run at an instant, with the positions of their tips."""
    positions = [(front, front.tip_m(time_s)) for front in drawn_fronts(run)]
    return [(front, x) for front, x in positions if x is not None]


def choose_step(run: OpenRun) -> int:
    """The snapshot that shows the event best; the last one in a run without fronts.

    Triggered: the tip of the first front nearest to its aim. Spontaneous: nearest to 30 us after nucleation,
    of those with the most tips well inside the interface.
    """
    if run.fields is None:
        raise DataError(f"{run.name}: no snapshots")
    times = run.fields.time_s
    if len(times) == 0:
        raise DataError(f"{run.fields.file}: no snapshots")
    began = start(run)
    if began is None:
        return len(times) - 1
    width_m = run.parameter("plate.width_m")

    def poorness(step: int) -> tuple[float, float]:
        running = tips(run, times[step])
        if run.name in AIM_OVER_WIDTH:
            first = drawn_fronts(run)[0]
            distances = [
                abs(x / width_m - AIM_OVER_WIDTH[run.name]) for front, x in running if front is first
            ]
            return (min(distances, default=np.inf), abs(times[step] - began[1]))
        inside = [WELL_INSIDE_OVER_WIDTH < x / width_m < 1 - WELL_INSIDE_OVER_WIDTH for _, x in running]
        return (-sum(inside), abs(times[step] - began[1] - SPONTANEOUS_AIM_S))

    return min(range(len(times)), key=poorness)


def draw_missing(ax: Axes, run: OpenRun) -> None:
    """In place of the snapshot of a run without any."""
    label = f"{paper_style.EVENT_STYLES[run.name].label}:\n{NO_FIELDS}"
    ax.text(0.5, 0.5, label, transform=ax.transAxes, ha="center", va="center", color="0.45", gid="no_fields")
    ax.set(xticks=[], yticks=[])


def draw_snapshot(ax: Axes, run: OpenRun) -> None:
    """The snapshot that shows the event best."""
    fields = run.fields
    if fields is None:
        draw_missing(ax, run)
        return
    step = choose_step(run)
    points = style.mm(fields.points_m)
    width, height = 1e3 * run.parameter("plate.width_m"), 1e3 * run.parameter("plate.height_m")
    triangles = fields.cells[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    ax.tripcolor(
        Triangulation(points[:, 0], points[:, 1], triangles),
        fields.speed_m_per_s(step),
        shading="gouraud",
        cmap=COLOURS,
        norm=Normalize(*SPEED_RANGE_M_PER_S),
        rasterized=True,
    )
    ends, boundary = edges(fields.cells)
    draw_edges(ax, points[ends[boundary]], color="black", linewidth=0.5)

    event = paper_style.EVENT_STYLES[run.name]
    began = start(run)
    if began is not None:
        ax.plot(
            1e3 * began[0],
            0,
            marker=event.marker,
            markersize=6,
            color="black",
            markerfacecolor=event.colour,
            markeredgewidth=0.6,
            clip_on=False,
            zorder=6,
            gid="start",
        )
    for front, x_m in tips(run, fields.time_s[step]):
        # The triangle points down to the tip; the arrow ahead of it tells where the front goes.
        ax.plot(
            1e3 * x_m,
            0,
            marker=paper_style.TIP_MARKER,
            markersize=9,
            color="black",
            markerfacecolor="white",
            markeredgewidth=0.5,
            linestyle="none",
            zorder=7,
            gid=f"tip:{front.id}",
        )
        length, y = 0.13 * height, 0.17 * height
        from_x = 1e3 * x_m
        if not 0 <= from_x + front.direction * length <= width:
            from_x -= front.direction * length  # no room ahead of the tip: the arrow ends at it
        ax.add_patch(
            FancyArrowPatch(
                (from_x, y),
                (from_x + front.direction * length, y),
                facecolor="white",
                arrowstyle="simple,head_width=4.5,head_length=4,tail_width=1.4",
                edgecolor="black",
                linewidth=0.5,
                shrinkA=0,
                shrinkB=0,
                zorder=7,
                gid=f"way:{front.id}",
            )
        )
    ax.annotate(
        "",
        (0.62 * width, 1.07 * height),
        (0.38 * width, 1.07 * height),
        arrowprops={"arrowstyle": "-|>,head_width=0.2,head_length=0.4", "lw": 1.2, "color": "black"},
        annotation_clip=False,
    )
    ax.text(
        width, 1.03 * height, f"{event.label}, {1e6 * fields.time_s[step]:.0f} µs", ha="right", va="bottom"
    )
    ax.set(ylim=(-0.02 * height, height), aspect="equal", ylabel="$y$ (mm)")
    style.x_axis(ax, run)
    ax.locator_params(axis="y", nbins=2)
    ax.tick_params(top=False, right=False, direction="out")
    ax.spines[:].set_visible(False)


def three_events(results: Results) -> Drawing:
    width_mm, height_mm = style.PAGE_MM, 128.0
    figure = style.new_figure(width_mm, height_mm, constrained=False)

    def axes(x: float, y: float, w: float, h: float) -> Axes:
        return figure.add_axes((x / width_mm, y / height_mm, w / width_mm, h / height_mm))

    panels = [axes(11, 83, 72, 37), axes(97, 83, 72, 37), axes(11, 31, 72, 37)]
    for ax, letter, run in zip(panels, "abc", results.events, strict=True):
        draw_snapshot(ax, run)
        ax.text(0, 1.05, f"({letter})", transform=ax.transAxes, fontweight="bold", va="bottom")
    bar = figure.colorbar(
        ScalarMappable(Normalize(*SPEED_RANGE_M_PER_S), COLOURS),
        cax=axes(16, 16, 50, 2.2),
        orientation="horizontal",
        extend="max",
    )
    bar.set_ticks(np.linspace(*SPEED_RANGE_M_PER_S, 5).tolist())
    bar.ax.annotate("$|v|$ (m/s)", (1.06, 0.5), xycoords="axes fraction", va="center")
    d = axes(103, 27.5, 64, 42.5)
    speed_over_static_ratio(d, results.events)
    outside = finish(d, results.events[0])
    handles = [
        *paper_style.event_handles(results.events),
        *paper_style.fill_handles(),
        paper_style.pale_handle(),
    ]
    d.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.46, -0.2), ncols=2, columnspacing=1.6)
    d.text(-0.16, 1.03, "(d)", transform=d.transAxes, fontweight="bold", va="bottom")
    return Drawing(
        "fig3_three_events",
        figure,
        f"Magnitude of the material velocity, blue to white for 0 to {SPEED_RANGE_M_PER_S[1]:g} m/s and "
        "more, in the event (a) triggered at the left edge, (b) nucleated spontaneously, (c) triggered at "
        "the right edge; the deformation is not drawn. Square, circle and triangle: where the first front "
        "starts; small white triangles: tips of the fronts that run, white arrows: where they go; black "
        "arrow: the imposed "
        "shear. Instants: of the snapshots, the one with the first front nearest to "
        f"{100 * AIM_OVER_WIDTH['left']:.0f} % (a) and {100 * AIM_OVER_WIDTH['right']:.0f} % (c) of the "
        f"width, and (b) nearest to {1e6 * SPONTANEOUS_AIM_S:.0f} µs after nucleation with both tips inside. "
        "(d) Front speed against the static stress ratio for the three events; thin horizontal lines: wave "
        f"speeds. {SELECTION}{outside}",
    )
