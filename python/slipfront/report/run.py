# SPDX-License-Identifier: BSD-3-Clause
"""The page of a single run, and the parts of it that other pages use."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from slipfront.figures.main_fronts import DRAWN_LENGTH_M
from slipfront.figures.report import front_row, table
from slipfront.files import is_number
from slipfront.folder import UNFINISHED, belongs
from slipfront.read import STATUSES, Run, entry, read_run
from slipfront.report.history import ThinHistory, thin_history
from slipfront.report.page import Page, facts_table, plot, section, warnings_list, words
from slipfront.report.probes import probe_data, probes_of, probes_section
from slipfront.report.run_data import MOST_FRAMES, has_snapshots, history_of, run_data, units_of

MOST_TIMES, MOST_NODES = 400, 320  # of a page with one run
ENDS = {
    "end_time": "its time was over (time.end_s)",
    "quiet": "nothing had slipped for time.quiet_s",
    "interrupted": "it was interrupted",
    "blow_up": "the motion blew up",
}
EVENTS = {
    "left": "triggered at the left edge",
    "right": "triggered at the right edge",
    "spontaneous": "spontaneous",
    "nucleation": "in a nucleation patch",
}
OF_RANDOM_FIELDS = (
    "random_key",
    "random_share",
    "random_correlation_length_m",
    "random_seed",
    "between_rows",
)
DEFINITIONS = (
    "V<sub>tip</sub>: speed of the front's tip. t<sub>s</sub>, p<sub>s</sub>: tractions before the event; "
    "t<sub>d</sub>, p<sub>d</sub>: when the tip is l* short of the point; U<sub>s</sub>, U<sub>r</sub>: "
    "energy density "
    "there when the tip arrives and when it is about to go on. Definitions: docs/theory.md."
)


def is_kind(folder: Path) -> bool:
    return belongs(folder / "energy.csv") or belongs(folder / UNFINISHED / "run.json")


def number_words(value: Any, form: str, factor: float = 1.0, unit: str = "") -> str:
    return f"{factor * value:{form}}{unit}" if is_number(value) else "not given"


def mesh_words(run: Run) -> str:
    mesh = run.info.get("mesh", {})
    size = number_words(entry(run.case, "plate", "element_size_m"), ".4g", 1e3, " mm")
    bodies = "two bodies" if entry(run.case, "base", "kind") == "body" else "one body on a rigid plane"
    counts = [number_words(mesh.get(key), ",.0f") for key in ("columns", "rows", "nodes", "cells")]
    return (
        f"{counts[0]} × {counts[1]} cells of {size} at the interface; {counts[2]} nodes, {counts[3]} cells "
        "in all; "
        f"{bodies}"
    )


def ending(run: Run) -> str:
    """Whether a run is complete, and why it ended, in plain words."""
    if STATUSES[run.status] is not None:
        return f"<b>{words(run.mark)}</b>" + (f": {words(run.reason)}" if run.reason else "")
    end = str(run.info.get("end", ""))
    return "complete: " + words(ENDS.get(end, end) or "why it ended is not given")


def waves_words(run: Run) -> str:
    names = {"c_L": "c<sub>L</sub>", "c_S": "c<sub>S</sub>", "c_R": "c<sub>R</sub>"}
    speeds = (f"{name} = {run.fact(f'wave_speeds.{wave}_m_per_s'):.0f} m/s" for wave, name in names.items())
    return ", ".join(speeds) + " (of the plate)"


def settings_words(run: Run, table: str, left_out: tuple[str, ...] = ()) -> str:
    """Words and numbers of a table of the case, by their keys."""
    settings = run.case.get(table)
    told = []
    for key, value in settings.items() if isinstance(settings, dict) else ():
        if is_number(value) and key not in left_out:
            told.append(f"{key} = {value:g}")
        elif isinstance(value, str) and value not in ("", "none") and key not in left_out:
            told.append(value if key == "law" else f"{key} = {value}")
    return words(", ".join(told))


def rupture_words(run: Run) -> str:
    """S before the event, and what it lets expect; of runs that tell it."""
    rupture = run.info.get("rupture")
    if not isinstance(rupture, dict):
        return "not given"
    S = rupture.get("strength_excess_S")
    spread = [
        number_words(S.get(k) if isinstance(S, dict) else None, ".3g") for k in ("min", "median", "max")
    ]
    lengths = [
        f"{name} {number_words(rupture[key], '.3g', 1e3, ' mm')}"
        for key, name in (
            ("nucleation_length_m", "nucleation length"),
            ("griffith_half_length_m", "half the critical crack"),
            ("process_zone_m", "process zone"),
        )
        if is_number(rupture.get(key))
    ]
    least, median, most = spread
    of_S = f"S {median}" if least == most else f"S {least} to {most}, median {median}"
    told = [of_S, *lengths, str(rupture.get("regime", ""))]
    return words("; ".join(text for text in told if text))


def facts(run: Run) -> str:
    info, steps = run.info, number_words(run.info.get("steps"), ",.0f")
    step = number_words(info.get("dt_s"), ".3g", 1e6, " µs")
    interface_step = number_words(info.get("interface_dt_s"), ".3g", 1e6, " µs")
    n_sessions = info.get("sessions")
    sessions = f", in {n_sessions} parts" if isinstance(n_sessions, int) and n_sessions > 1 else ""
    return facts_table(
        [
            ("Case", words(info.get("title", "") or "without a title")),
            ("Folder", words(run.name)),
            ("End", ending(run)),
            ("Program", words(f"slipfront {info.get('version')}, commit {info.get('commit')}, "
                              f"{info.get('compiler')}, on {info.get('host')}")),
            ("Mesh", mesh_words(run)),
            ("Material", settings_words(run, "material")),
            ("Friction", settings_words(run, "friction", OF_RANDOM_FIELDS)),
            ("Before the event", rupture_words(run)),
            ("Start of the event", EVENTS.get(run.kind, words(run.kind))),
            ("Time", f"{number_words(info.get('time_s'), '.4g', 1e6, ' µs')} in {steps} steps of {step}; "
                     f"{interface_step} at the interface"),
            ("Computed in", number_words(info.get("wall_s"), ".3g", 1, " s") + sessions),
            ("Wave speeds", waves_words(run)),
        ]
    )  # fmt: skip


def warnings_of(run: Run) -> str:
    told = run.info.get("warnings", [])
    return warnings_list(run.remarks, "mark") + warnings_list(told if isinstance(told, list) else [])


def thinning(history: ThinHistory) -> str:
    """What of the record the page does not have."""
    skipped = []
    if history.times_in_block > 1:
        skipped.append(f"one in {history.times_in_block} of {history.n_times} times")
    if history.nodes_in_block > 1:
        skipped.append(f"one in {history.nodes_in_block} of {history.n_nodes} nodes")
    if not skipped:
        return "Every time and node of the record is drawn, to three digits."
    return (
        f"To keep this page small it holds {' and '.join(skipped)}, to three digits; of the slip rate the "
        "largest in "
        "each block of them. Fronts are drawn in full. The whole record: interface.h5."
    )


FIELD_BUTTONS = "".join(
    f'<button type="button" data-field="{field}" aria-pressed="false">{name}</button>'
    for field, name in (("slip_rate", "slip rate"), ("ratio", "t/p"), ("p", "pressure p"), ("slip", "slip"))
)


def time_slider(name: str, play: bool = False) -> str:
    button = f'<button type="button" id="{name}-play">play</button>' if play else ""
    return (
        f'<p class="slider">{button}<label for="{name}-time">time</label>'
        f'<input type="range" id="{name}-time" min="0" value="0" step="1">'
        f'<output id="{name}-now" for="{name}-time"></output></p>'
    )


def space_time_section(note: str) -> str:
    return section(
        "space-time",
        "Along the interface over time",
        f'<p class="buttons" role="group" aria-label="what is drawn">{FIELD_BUTTONS}</p>',
        plot("space-time-plot", "Field along the interface over time, with the fronts"),
        "<p>Lines: onsets of slip along the fronts of at least "
        f"{1e3 * DRAWN_LENGTH_M:g} mm; from the start of the first of them, what would run at a wave speed. "
        "A click on "
        "a name of the legend hides or shows its lines. Drag to zoom, double-click to go back. A click into "
        "the "
        f"diagram sets the time of the next plot. {note}</p>",
    )


def profiles_section() -> str:
    return section(
        "profiles",
        "Tractions and slip rate at a time",
        time_slider("profiles"),
        '<p class="buttons"><button type="button" id="profiles-keep">keep this curve</button>'
        '<button type="button" id="profiles-clear">remove kept curves</button></p>',
        plot("profiles-plot", "Shear over normal traction, and slip rate, along the interface"),
        "<p>t/p is left out where the contact is open. Triangles: tips of fronts, pointing where they "
        "go.</p>",
    )


def criteria_section(more: str = "") -> str:
    return section(
        "criteria",
        "Front speed against position and three criteria",
        plot("criteria-plot", "Front speed against position, static ratio, dynamic ratio and energy rise"),
        '<p id="criteria-point" class="readout" aria-live="polite">Point at a node of a front: it is marked '
        "in all "
        "panels and in the diagrams above. A click keeps it. Box or lasso (in the bar above the plot) "
        "select many.</p>",
        f"<p>{DEFINITIONS} Strong points: main fronts, where they count for the criteria; pale: all others. "
        f"Lines: wave speeds. {more}</p>",
    )


def energy_section() -> str:
    return section(
        "energy",
        "Energy",
        plot("energy-plot", "Energies and works over time, stacked, and what they leave open"),
        "<p>Per unit thickness, since the start. Above zero: where energy comes from, such as strain "
        "energy that is released; below: where it goes. "
        "Both sides "
        "are equally large but for the imbalance, which is drawn below over the largest term: each term is "
        "computed by "
        "itself. Closing gaps: what is lost where the bodies meet again. Coupling: between the layer at the "
        "interface, which moves in smaller steps, and the rest; an error of the time stepping.</p>",
    )


def snapshots_section(has_any: bool, n_of: str = "") -> str:
    if not has_any:
        text = "<p>The run has no snapshots; they come with output.snapshot_times_s in its case.</p>"
        return section("snapshots", "Speed of the particles", text)
    return section(
        "snapshots",
        "Speed of the particles",
        time_slider("snapshots", play=True),
        plot("snapshots-plot", "Speed of the particles in the bodies"),
        "<p>Means over square pixels; colours go with the square root of the speed, within 1 % of the "
        "scale's end. "
        f"Triangles: tips of fronts, pointing where they go. {n_of}</p>",
    )


def frames_words(run: Run) -> str:
    n = len(run.fields.time_s) if run.fields is not None else 0
    return f"{MOST_FRAMES} of {n} snapshots are shown." if n > MOST_FRAMES else ""


def median_speeds(run: Run) -> dict[int, str]:
    """Of each front, over c_L and c_S, by its id; empty words where it has no speed."""
    c_L, c_S = (run.info.get("wave_speeds", {}).get(f"{name}_m_per_s") for name in ("c_L", "c_S"))
    told = {}
    for front in run.fronts:
        v_m_per_s = front.v_tip_m_per_s[np.isfinite(front.v_tip_m_per_s)]
        if len(v_m_per_s) > 0 and is_number(c_L) and is_number(c_S):
            median = float(np.median(v_m_per_s))
            told[front.id] = f"{median / c_L:.2f} c_L, {median / c_S:.2f} c_S"
    return told


def fronts_section(run: Run) -> str:
    header = [
        "Front",
        "Direction",
        "From (mm)",
        "at (µs)",
        "to (mm)",
        "at (µs)",
        "End",
        "Slip",
        "Median V_tip",
    ]
    speeds = median_speeds(run)
    rows = [[*front_row("", f)[1:], speeds.get(f.get("id"), "–")] for f in run.info.get("fronts", [])]
    text = table(header, rows) if rows else "<p>None was found.</p>"
    return section("fronts", "Fronts", "<p>All that were found, short ones too.</p>", text)


def navigation(places: list[tuple[str, str]]) -> str:
    links = "".join(f'<a href="#{place}">{name}</a>' for place, name in places)
    return f'<nav aria-label="parts of this page">{links}</nav>'


PLACES = [
    ("facts", "Facts"),
    ("space-time", "Space-time"),
    ("profiles", "t/p at a time"),
    ("criteria", "Criteria"),
    ("energy", "Energy"),
    ("snapshots", "Snapshots"),
    ("probes", "Probes"),
    ("fronts", "Fronts"),
]


def thin_run(folder: Path, most: tuple[int, int] = (MOST_TIMES, MOST_NODES)) -> Run:
    return read_run(folder, thin_history(most))


def page(folder: Path) -> Page:
    run = thin_run(folder)
    probes = probes_of(run.place)
    data = run_data(run)
    if probes is not None:
        units = units_of(run)
        data["probes"] = probe_data(probes, units["time"].factor, units["x"].factor)
    title = str(run.info.get("title", "")) or run.name
    return Page(
        title=f"{title}: {run.mark}" if run.mark else title,
        parts=[
            navigation([place for place in PLACES if place[0] != "probes" or probes is not None]),
            section("facts", "Facts", warnings_of(run), facts(run)),
            space_time_section(thinning(history_of(run))),
            profiles_section(),
            criteria_section(),
            energy_section(),
            snapshots_section(has_snapshots(run), frames_words(run)),
            probes_section(probes) if probes is not None else "",
            fronts_section(run),
        ],
        data={"runs": [data]},
        notes=run.remarks,
    )
