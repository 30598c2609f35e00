# SPDX-License-Identifier: BSD-3-Clause
"""How much the results depend on each parameter: small multiples, one pair of panels per study."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Annotation
from matplotlib.transforms import blended_transform_factory
from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.figures.main_fronts import main_fronts
from slipfront.opened import OpenRun

from drawing import paper_style
from drawing.results import EVENTS, Results
from drawing.study import Study, StudyPoint

COLUMNS = 3
CELL_MM = 45.0
LEGEND_MM = 19.0  # above the panels, where they leave no room for it
BESIDE_MARKERS_PT = 12.0  # from a value to a number written beside its markers
NUMBER_PT = 7.5  # width of such a number
MOST_WITH_ROOM = 4  # values of a panel that leave room for one right of the last
HIGHEST_V = 4.5
HIGHEST_RMS = 0.3
HIGHEST_SPREAD = 1.0
SAME_START_M = 10e-3  # a main front that starts farther off is another than the paper's run has
NAMES = {
    "mu_k": r"kinetic friction $\mu_k$",
    "alpha": r"transition $\alpha$",
    "element_size": "element size",
    "substeps": "sub-steps at the interface",
    "damping": r"stiffness damping $\beta_R$",
    "corner": "rounding of the corners",
    "top": "top edge while tilted",
    "left_amount": "strength of the left trigger",
    "right_amount": "strength of the right trigger",
    "trigger_zone": "length of the trigger zone",
    "trigger_ramp": "rise time of the trigger",
    "trigger_duration": "duration of the trigger",
    "l_star": "length $l^*$",
    "loading_method": "way to the critical state",
    "element_size_strength": "element size, strength relaxed",
    "element_size_pressure": "element size, pressure relaxed",
    "element_size_undamped": "element size, also undamped",
    "relaxation_time_strength": "relaxation time of the strength",
    "relaxation_time_pressure": "relaxation time of the pressure",
    "relaxation_length_strength": "relaxation length of the strength",
}

# The main fronts followed: event, direction, and the shift of its markers over the width of the panel,
# without which they would cover each other.
FRONTS = (("left", 1, -0.033), ("spontaneous", -1, -0.011), ("spontaneous", 1, 0.011), ("right", -1, 0.033))
SPREADS = (
    ("t_s_over_p_s", paper_style.STATIC_LABEL, "0.45", "D"),
    ("t_d_over_p_d", paper_style.DYNAMIC_LABEL, "#0072b2", "v"),
    ("energy", paper_style.ENERGY_LABEL, "#d55e00", "P"),
)


def paper_value(study: Study, run: OpenRun) -> int | None:
    """Index of the value that the paper's run has; None where it is not among the study's."""
    value: Any = run.case
    for part in study.parameter.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    for i, point in enumerate(study.points):
        if isinstance(value, str):
            same = point.value == value
        else:
            same = value is not None and point.number is not None and bool(np.isclose(point.number, value))
        if same:
            return i
    return None


def paper_values(results: Results, study: Study) -> dict[str, int]:
    """For each event of the study whose paper's run has one of its values, the index of that."""
    told = {event for point in study.points for event, _ in point.fronts}
    found = {event: paper_value(study, results.runs[event]) for event in EVENTS if event in told}
    return {event: index for event, index in found.items() if index is not None}


def draw_paper_values(ax: Axes, results: Results, study: Study) -> None:
    """A grey stripe, or, where the events have different values, one in the colour of each."""
    values = paper_values(results, study)
    events = {index: [event for event in values if values[event] == index] for index in values.values()}
    for index, same in events.items():
        colour = "0.75" if len(events) == 1 else paper_style.EVENT_STYLES[same[0]].colour
        alpha = 0.4 if len(events) == 1 else 0.2
        gid = "paper_value" if len(events) == 1 else f"paper_value:{','.join(same)}"
        ax.axvline(index, color=colour, linewidth=6, alpha=alpha, zorder=0.2, gid=gid)


def paper_value_handles(results: Results) -> list[Patch]:
    """Legend entries of the stripes."""
    handles = [Patch(facecolor="0.75", alpha=0.4, label="value of the paper's runs")]
    differing = set()
    for study in results.studies:
        values = paper_values(results, study)
        differing |= set(values) if len(set(values.values())) > 1 else set()
    for event in EVENTS:
        if event in differing:
            look = paper_style.EVENT_STYLES[event]
            handles.append(Patch(facecolor=look.colour, alpha=0.2, label=f"value of the {look.label} run"))
    return handles


def title(study: Study) -> str:
    """Name of the parameter, with the unit of its values."""
    unit = f" ({study.unit[0]})" if study.unit[0] and study.numeric else ""
    return NAMES.get(study.name, study.name.replace("_", " ")) + unit


def draw_values(
    ax: Axes, study: Study, values: Iterable[float | None], offset: float, top: float, gid: str, **look: Any
) -> None:
    """One number per value of the study, at equal distances; one above the axis is written at its end."""
    x = np.arange(len(study.points)) + offset * len(study.points)
    y = np.array([np.nan if v is None else v for v in values], dtype=float)
    line = look.pop("linestyle")
    inside = np.where(y > top, np.nan, y)
    ax.plot(x, inside, linestyle=line if study.numeric else "none", gid=gid, **look)
    for i in np.flatnonzero(y > top):
        # Beside the markers, and beside the numbers that other fronts have at the same value.
        n_there = sum(
            str(t.get_gid()).endswith(":above") and t.xy[0] == i
            for t in ax.texts
            if isinstance(t, Annotation)
        )
        side = -1 if i == len(y) - 1 and len(y) > MOST_WITH_ROOM else 1
        ax.annotate(
            f"{y[i]:.3g}↑",
            (i, 1),
            xycoords=blended_transform_factory(ax.transData, ax.transAxes),
            xytext=(side * (BESIDE_MARKERS_PT + NUMBER_PT * n_there), -1),
            textcoords="offset points",
            ha="center",
            va="top",
            color=look["color"],
            rotation=90,
            path_effects=style.outlined("white", 2.0),
            zorder=5,
            gid=f"{gid}:above",
        )


def is_another(results: Results, point: StudyPoint, event: str, direction: int) -> bool:
    """Whether the main front starts elsewhere than that of the paper's run."""
    own = point.fronts.get((event, direction))
    theirs = [f for f in main_fronts(results.runs[event]) if f.direction == direction]
    return own is not None and bool(theirs) and abs(own.start_x_m - theirs[0].x_m[0]) > SAME_START_M


def front_look(event: str, direction: int) -> dict[str, Any]:
    look = paper_style.EVENT_STYLES[event]
    return {
        "color": look.front(direction).colour,
        "linestyle": look.front(direction).line,
        "marker": look.marker,
        "markerfacecolor": paper_style.fill(look, direction),
        "linewidth": 0.8,
    }


def draw_speeds(ax: Axes, results: Results, study: Study) -> None:
    for event, direction, offset in FRONTS:
        found = [point.fronts.get((event, direction)) for point in study.points]
        another = [is_another(results, point, event, direction) for point in study.points]
        look = front_look(event, direction)
        key = f"{event}:{direction}"
        largest = [f.max_over_c_L if f else None for f in found]
        mean = [f.mean_over_c_L if f else None for f in found]
        same = [None if other else v for v, other in zip(largest, another, strict=True)]
        draw_values(ax, study, same, offset, HIGHEST_V, f"max:{key}", markersize=3.0, **look)
        others = [v if other else None for v, other in zip(largest, another, strict=True)]
        cross = look | {"marker": "x", "linestyle": "none"}
        draw_values(ax, study, others, offset, HIGHEST_V, f"other:{key}", markersize=3.0, **cross)
        dash = look | {"marker": "_", "color": look["color"], "linestyle": "none"}
        draw_values(ax, study, mean, offset, HIGHEST_V, f"mean:{key}", markersize=5.0, **dash)
    ax.axhline(1.0, **style.REFERENCE)
    ax.set(ylim=(0, HIGHEST_V), yticks=[0, 1, 2, 3, 4])


def draw_changes(ax: Axes, results: Results, study: Study) -> None:
    for event in ("left", "spontaneous", "right"):
        look = front_look(event, -1)
        offset = next(offset for name, _, offset in FRONTS if name == event)
        change = [point.change.get(event) for point in study.points]
        percent = [None if v is None else 100 * v for v in change]
        draw_values(ax, study, percent, offset, np.inf, f"change:{event}", markersize=3.0, **look)
    ax.axhspan(-1, 1, color="0.9", linewidth=0, zorder=0)
    ax.axhline(0, **style.REFERENCE)
    ax.set_yscale("symlog", linthresh=1, linscale=0.6)
    ax.set_ylim(-70, 70)
    ax.set_yticks([-50, -10, -1, 1, 10, 50], labels=["−50", "", "−1", "+1", "", "+50"])
    ax.minorticks_off()


def draw_rms(ax: Axes, results: Results, study: Study) -> None:
    look: style.Look = {
        "color": "black",
        "linestyle": "-",
        "marker": "o",
        "markersize": 3.0,
        "linewidth": 0.8,
    }
    rms = [point.rms_over_c_L for point in study.points]
    draw_values(ax, study, rms, 0.0, HIGHEST_RMS, "rms", **look)
    ax.axhspan(0, results.paper_a_band, color="0.9", linewidth=0, zorder=0)
    ax.set(ylim=(0, HIGHEST_RMS), yticks=[0, 0.1, 0.2, 0.3])


def draw_spreads(ax: Axes, results: Results, study: Study) -> None:
    for (name, _, colour, marker), offset in zip(SPREADS, (-0.045, 0.0, 0.045), strict=True):
        look: style.Look = {
            "color": colour,
            "linestyle": "-",
            "marker": marker,
            "markersize": 3.0,
            "linewidth": 0.8,
        }
        values = [point.spread[name] for point in study.points]
        draw_values(ax, study, values, offset, HIGHEST_SPREAD, f"spread:{name}", **look)
    ax.set(ylim=(0, HIGHEST_SPREAD), yticks=[0, 0.5])


#: Draws a study into axes.
Panel = Callable[[Axes, Results, Study], None]


def small_multiples(
    results: Results, upper: Panel, lower: Panel, labels: tuple[str, str], handles: list[Any]
) -> Figure:
    """Two panels above each other for every study: upper(ax, results, study) and lower(...)."""
    n_rows = -(-len(results.studies) // COLUMNS)
    n_free = n_rows * COLUMNS - len(results.studies)
    height_mm = CELL_MM * n_rows + (LEGEND_MM if n_free == 0 else 0)
    figure = style.new_figure(style.PAGE_MM, height_mm, constrained=False)
    for i, study in enumerate(results.studies):
        row, column = divmod(i, COLUMNS)
        left, bottom = 14 + 54.5 * column, CELL_MM * (n_rows - 1 - row)

        def axes(y: float, h: float, left: float = left, bottom: float = bottom) -> Axes:
            place = (left / style.PAGE_MM, (bottom + y) / height_mm, 48.5 / style.PAGE_MM, h / height_mm)
            return figure.add_axes(place)

        pair = axes(23, 17), axes(7.5, 13)
        for ax, draw, label in zip(pair, (upper, lower), labels, strict=True):
            draw(ax, results, study)
            ax.set_xlim(-0.5, len(study.points) - 0.5)
            ax.set_xticks(range(len(study.points)), labels=[])
            ax.tick_params(axis="x", top=False, direction="out")
            if column == 0:
                ax.set_ylabel(label)
                ax.yaxis.set_label_coords(-0.17, 0.5)
            else:
                ax.tick_params(axis="y", labelleft=False)
            draw_paper_values(ax, results, study)
        pair[1].set_xticklabels([study.shown(point).replace("fillet ", "fillet\n") for point in study.points])
        pair[0].set_title(title(study), loc="left", fontweight="bold", pad=3)
    place_legend(figure, [*handles, *paper_value_handles(results)], n_free, height_mm)
    return figure


def place_legend(figure: Figure, handles: list[Any], n_free: int, height_mm: float) -> None:
    """In the cells that the studies leave free at the end, or above the panels."""
    if n_free == 0:
        at: style.Look = {"loc": "upper center", "bbox_to_anchor": (0.5, 1 - 1 / height_mm), "ncols": 3}
    else:
        left = (14 + 54.5 * (COLUMNS - n_free)) / style.PAGE_MM
        at = {"loc": "upper left", "bbox_to_anchor": (left, (CELL_MM - 5) / height_mm), "ncols": n_free}
    figure.legend(handles=handles, labelspacing=0.3, **at)


def handle(label: str, **look: Any) -> Line2D:
    return Line2D([], [], label=label, **look)


SETTING = (
    "One pair of panels per parameter, all else as in the paper's runs; its values at equal distances. Broad "
    "grey stripe: the value of the paper's runs; where their triggers differ, a stripe in the colour of each."
)
LEFT_OUT = (
    "Numbers with an arrow lie above the axis, at the value to their left, at the last of many to their "
    "right. Left out as in the scorecard: points in and next to trigger "
    "zones and within 5 mm of spontaneous nucleation."
)


def speeds(results: Results) -> Drawing:
    names = {-1: "against the shear", 1: "along the shear"}
    handles: list[Artist] = [
        handle(
            paper_style.EVENT_STYLES[event].label + (f", {names[way]}" if event == "spontaneous" else ""),
            markersize=3.0,
            **front_look(event, way),
        )
        for event, way, _ in FRONTS
    ]
    grey: style.Look = {"color": "0.3", "linestyle": "none"}
    handles.append(handle("maximum", marker="o", markersize=3.0, **grey))
    handles.append(handle("mean", marker="_", markersize=5.0, **grey))
    handles.append(handle("maximum, other front", marker="x", markersize=3.0, **grey))
    handles.append(handle(r"$c_\mathrm{L}$; no change", **style.REFERENCE))
    handles.append(Patch(facecolor="0.9", label="band: change within 1 %"))
    labels = (style.V_LABEL, "change (%)")
    return Drawing(
        "studies",
        small_multiples(results, draw_speeds, draw_changes, labels, handles),
        f"Dependence of the front speeds on what the paper leaves open or varies. {SETTING} Upper panels: "
        "largest and mean V<sub>tip</sub> of the longest front of an event in its direction, a cross where "
        "that front starts more than 10 mm from that of the paper's run (a daughter front); line: "
        "c<sub>L</sub>. Lower panels: median over the interface of the change of V<sub>tip</sub> against the "
        f"reference run at equal x, in per cent; grey: within 1 %, where the scale is linear. {LEFT_OUT}",
    )


def criteria(results: Results) -> Drawing:
    handles: list[Artist] = [
        handle("rms about the own fit", color="black", linestyle="-", marker="o", markersize=3.0)
    ]
    for _, label, colour, marker in SPREADS:
        handles.append(handle(f"spread, {label}", color=colour, linestyle="-", marker=marker, markersize=3.0))
    handles.append(Patch(facecolor="0.9", label="band: half width of the paper's"))
    labels = (r"rms / $c_\mathrm{L}$", "spread")
    return Drawing(
        "studies_criteria",
        small_multiples(results, draw_rms, draw_spreads, labels, handles),
        f"Dependence of the collapse on the same parameters. {SETTING} Upper panels: rms of "
        "V<sub>tip</sub>/c<sub>L</sub> about the fit of a + b exp(−c √r) to each value's own runs; grey: "
        "the half width of the paper's band. Lower panels: median relative spread of V<sub>tip</sub> between "
        "the fronts at equal t<sub>s</sub>/p<sub>s</sub>, t<sub>d</sub>/p<sub>d</sub> and (U<sub>r</sub> − "
        "U<sub>s</sub>)/U<sub>s</sub>. The studies of the trigger have two events instead of three, that of "
        "the loading method one: their levels compare only among themselves. "
        f"{LEFT_OUT.split(' Left out')[0][:-1]}.",
    )
