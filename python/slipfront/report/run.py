# SPDX-License-Identifier: BSD-3-Clause
"""The page of a single run, and the parts of it that other pages use."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from slipfront.figures.main_fronts import DRAWN_LENGTH_M
from slipfront.files import is_number
from slipfront.folder import UNFINISHED, belongs
from slipfront.opened import OpenRun, drawn_history, open_run
from slipfront.read import STATUSES, Front, median
from slipfront.report import setup
from slipfront.report.fracture import ENERGIES, fracture_data, fracture_section
from slipfront.report.history import ThinHistory, thinned
from slipfront.report.page import Page, facts_table, plot, section, warnings_list, words
from slipfront.report.probes import probe_data, probes_of, probes_section
from slipfront.report.run_data import (
    MOST_FRAMES,
    constant_fields,
    has_snapshots,
    run_data,
    units_of,
)
from slipfront.report.sketch import sketch
from slipfront.report.tables import formatted, front_cells, table
from slipfront.units import quantity, velocity

MOST_TIMES, MOST_NODES = 400, 320  # of a page with one run
ENDS = {
    "end_time": "its time was over (time.end_s)",
    "quiet": "nothing had slipped for time.quiet_s",
    "interrupted": "it was interrupted",
    "blow_up": "the motion blew up",
    "observer": "an observer ended it",
}
DEFINITIONS = (
    "V<sub>tip</sub>: speed of the front's tip. t<sub>s</sub>, p<sub>s</sub>: tractions before the event; "
    "t<sub>d</sub>, p<sub>d</sub>: when the tip is l* short of the point; U<sub>s</sub>, U<sub>r</sub>: "
    "energy density there when the tip arrives and when it is about to go on. Definitions: docs/theory.md."
)


def is_kind(folder: Path) -> bool:
    return belongs(folder / "energy.csv") or belongs(folder / UNFINISHED / "run.json")


def number_words(value: Any, form: str, factor: float = 1.0, unit: str = "") -> str:
    return f"{factor * value:{form}}{unit}" if is_number(value) else "not given"


def mesh_words(run: OpenRun) -> str:
    mesh = run.info.get("mesh", {})
    size = number_words(run.entry("plate", "element_size_m"), ".4g", 1e3, " mm")
    counts = [number_words(mesh.get(key), ",.0f") for key in ("columns", "rows", "nodes", "cells")]
    return (
        f"plate of {counts[0]} × {counts[1]} cells, {size} at the interface; {counts[2]} nodes, {counts[3]} "
        "cells in all"
    )


def ending(run: OpenRun) -> str:
    """Whether a run is complete, and why it ended, in plain words."""
    if STATUSES[run.status] is not None:
        return f"<b>{words(run.place.with_reason(run.mark))}</b>"
    end = str(run.info.get("end", ""))
    return "complete: " + words(ENDS.get(end, end) or "why it ended is not given")


def sessions_words(info: dict[str, Any]) -> str:
    n = info.get("sessions")
    return f", in {n} parts" if isinstance(n, int) and n > 1 else ""


def program_words(info: dict[str, Any]) -> str:
    return words(
        f"slipfront {info.get('version')}, commit {info.get('commit')}, {info.get('compiler')}, "
        f"on {info.get('host')}"
    )


def quantity_words(value: Any, unit: str, digits: int = 4) -> str:
    return quantity(value, unit, digits) if is_number(value) else "not given"


def facts(run: OpenRun) -> str:
    info, steps = run.info, number_words(run.info.get("steps"), ",.0f")
    step, interface_step = (quantity_words(info.get(key), "s", 3) for key in ("dt_s", "interface_dt_s"))
    return facts_table(
        [
            ("Folder", words(run.name)),
            ("End", ending(run)),
            ("Mesh", mesh_words(run)),
            ("Time", f"{quantity_words(info.get('time_s'), 's')} in {steps} steps of {step}; "
                     f"{interface_step} at the interface"),
            ("Computed in", quantity_words(info.get("wall_s"), "s", 3) + sessions_words(info)),
            ("Program", program_words(info)),
        ]
    )  # fmt: skip


def warnings_of(run: OpenRun) -> str:
    return warnings_list(run.remarks, "mark") + warnings_list([note.text for note in run.notes])


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
        "largest in each block of them. Fronts are drawn in full. The whole record: interface.h5."
    )


#: What can be drawn along the interface over time, in the order of the buttons.
FIELDS = {"slip_rate": "slip rate", "ratio": "t/p", "p": "pressure p", "slip": "slip"}


def field_buttons(shown: list[str]) -> str:
    return "".join(
        f'<button type="button" data-field="{field}" aria-pressed="false">{FIELDS[field]}</button>'
        for field in shown
    )


def time_slider(name: str, play: bool = False) -> str:
    button = f'<button type="button" id="{name}-play">play</button>' if play else ""
    return (
        f'<p class="slider">{button}<label for="{name}-time">time</label>'
        f'<input type="range" id="{name}-time" min="0" value="0" step="1">'
        f'<output id="{name}-now" for="{name}-time"></output></p>'
    )


def space_time_section(note: str, constant: dict[str, str]) -> str:
    """Fields that are the same everywhere, by what to say of each, have no diagram."""
    shown = [field for field in FIELDS if field not in constant]
    told = "".join(f"<p>{words}</p>" for words in constant.values())
    heading = "Along the interface over time"
    if not shown:
        return section("space-time", heading, told)
    return section(
        "space-time",
        heading,
        f'<p class="buttons" role="group" aria-label="what is drawn">{field_buttons(shown)}</p>',
        plot("space-time-plot", "Field along the interface over time, with the fronts"),
        "<p>Lines: onsets of slip along the fronts of at least "
        f"{1e3 * DRAWN_LENGTH_M:g} mm; from the start of the first of them, what would run at a wave speed. "
        "A click on a name of the legend hides or shows its lines. Drag to zoom, double-click to go back. A "
        f"click into the diagram sets the time of the next plot. {note}</p>",
        told,
    )


def profiles_section(history: ThinHistory) -> str:
    n_times, n_nodes = history.times_in_block, history.nodes_in_block
    rate = (
        ""
        if n_times == n_nodes == 1
        else f", of the slip rate the largest of {n_times} times and {n_nodes} nodes"
    )
    return section(
        "profiles",
        "Tractions and slip rate at a time",
        time_slider("profiles"),
        '<p class="buttons"><button type="button" id="profiles-keep">keep this curve</button>'
        '<button type="button" id="profiles-clear">remove kept curves</button></p>',
        plot("profiles-plot", "Shear over normal traction, and slip rate, along the interface"),
        f"<p>The data as computed, not smoothed{rate}: steps and ripples over a few elements are the mesh's. "
        "t/p is left out where the contact is open. Triangles: tips of fronts, pointing where they go.</p>",
    )


def criteria_section(panels: list[str], folded: bool = False, more: str = "") -> str:
    """`panels`: the measures that differ between points; folded: all but the first wait for a button."""
    heading = "Front speed" if folded or len(panels) < 2 else "Front speed against position and criteria"
    if not panels:
        return section("criteria", heading, "<p>No front has a speed to be drawn.</p>")
    unfold = (
        '<p class="buttons"><button type="button" id="criteria-more" aria-pressed="false">against the '
        "criteria "
        "of Kammer et al. 2012</button></p>"
    )
    return section(
        "criteria",
        heading,
        unfold if folded and len(panels) > 1 else "",
        plot("criteria-plot", "Front speed against position and criteria"),
        '<p id="criteria-point" class="readout" aria-live="polite">Point at a node of a front: it is marked '
        "in all panels and in the diagrams above. A click keeps it. Box or lasso (in the bar above the plot) "
        "select many.</p>",
        f"<p>{DEFINITIONS} Full colour: nodes of main fronts, beyond the trigger and before they arrest; "
        f"pale: all others. Lines: wave speeds. {more}</p>",
    )


def energy_section(is_zero: bool = False) -> str:
    if is_zero:
        return section("energy", "Energy", "<p>No energy changes and no work is done.</p>")
    return section(
        "energy",
        "Energy",
        plot("energy-plot", "Energies and works over time, stacked, and what they leave open"),
        "<p>Per unit thickness, since the start. Above zero: where energy comes from, such as strain energy "
        "that is released; below: where it goes. Both sides are equally large but for the imbalance, which "
        "is drawn below over the largest term: each term is computed by itself. Closing gaps: kinetic energy "
        "lost where the bodies meet again. Sub-steps: an error of the time stepping, where the layer at the "
        "interface moves in smaller steps than the rest.</p>",
    )


SNAPSHOTS = "Snapshots: particle velocity"


def snapshots_section(has_any: bool, n_of: str = "", is_still: bool = False) -> str:
    if not has_any:
        text = "<p>The run has no snapshots; they come with output.snapshot_times_s in its case.</p>"
        return section("snapshots", SNAPSHOTS, text)
    if is_still:
        return section("snapshots", SNAPSHOTS, "<p>Nothing moves in any snapshot.</p>")
    return section(
        "snapshots",
        SNAPSHOTS,
        time_slider("snapshots", play=True),
        plot("snapshots-plot", "Magnitude of the particle velocity in the bodies"),
        "<p>Means over square pixels; colours go with the square root of the velocity's magnitude, within 1 "
        f"% of the scale's end. Triangles: tips of fronts, pointing where they go. {n_of}</p>",
    )


def frames_words(run: OpenRun) -> str:
    n = len(run.fields.time_s) if run.fields is not None else 0
    return f"{MOST_FRAMES} of {n} snapshots are shown." if n > MOST_FRAMES else ""


def speed_words(m_per_s: float, info: dict[str, Any]) -> str:
    """In m/s, over c_L and over c_S, as a piece of HTML."""
    waves = info.get("wave_speeds")
    over = []
    for name in ("c_L", "c_S"):
        c: Any = waves.get(f"{name}_m_per_s") if isinstance(waves, dict) else None
        if is_number(c) and c > 0:
            over.append(f"{m_per_s / c:.2f} {setup.WAVES[name]}")
    return velocity(m_per_s) + (f" ({', '.join(over)})" if over else "")


def median_speeds(run: OpenRun) -> dict[int, str]:
    """Of each front that has one, by its id."""
    medians = {front.id: median(front.v_tip_m_per_s) for front in run.front_list}
    return {front: speed_words(v, run.info) for front, v in medians.items() if np.isfinite(v)}


def is_of_trigger(front: Front) -> bool:
    """Whether all of its speeds are the trigger's."""
    return bool((front.speed_kind == "triggered").all())


FRONT_ENDS = {
    "arrest": "where it arrested",
    "meets_front": "where it met another front",
    "contact_end": "the end of the contact",
    "record_edge": "the edge of the record",
    "record_end": "still running at the end",
}


def outcome(run: OpenRun) -> str:
    """How far the longest front went, how fast, and where it ended, as a piece of HTML."""
    fronts = [front for front in run.front_list if not is_of_trigger(front)]
    if not fronts:
        return "No front left the trigger: slip stopped within it." if run.front_list else "No front."
    front = max(fronts, key=lambda f: f.length_m)
    found: dict[str, Any] = next((f for f in run.info.get("fronts", []) if f.get("id") == front.id), {})
    mode, end = found.get("mode"), FRONT_ENDS.get(str(found.get("end")), "")
    start_m, end_m = (quantity(float(front.x_m[k]), "m") for k in (0, -1))
    parts = [
        f"A {mode if mode in ('crack', 'pulse') else 'front'} ran from x = {start_m} to {end_m}",
        end,
        f"at {told} in the median" if (told := median_speeds(run).get(front.id)) else "",
    ]
    gamma = median((run.breakdown or {}).get(front.id, {}).get(ENERGIES[0], np.empty(0)))
    if gamma > 0:
        parts.append(f"Γ = {gamma:.3g} J/m²")
    return ", ".join(part for part in parts if part) + "."


def fronts_section(run: OpenRun) -> str:
    header = [
        "Front",
        "Direction",
        "From",
        "at",
        "to",
        "at",
        "End",
        "Slip",
        "Median V_tip",
        *(["Median Γ (J/m²)", "G by slip (J/m²)"] if run.breakdown else []),
    ]
    speeds = median_speeds(run)
    energies = {
        front: [formatted(median(of[name]), ".3g") for name in ENERGIES]
        for front, of in (run.breakdown or {}).items()
    }
    rows = {
        f.get("id"): [*front_cells(f), speeds.get(f.get("id"), "–"), *energies.get(f.get("id"), [])]
        for f in run.info.get("fronts", [])
    }
    triggers = {front.id for front in run.front_list if is_of_trigger(front)}
    left = [row for front, row in rows.items() if front not in triggers]
    stayed = [row for front, row in rows.items() if front in triggers]
    folded = (
        f"<details><summary>Fronts that did not leave the trigger: {len(stayed)}</summary>"
        f"{table(header, stayed)}</details>"
        if stayed
        else ""
    )
    text = table(header, left) if left else "<p>None left the trigger.</p>" if stayed else "<p>None.</p>"
    return section("fronts", "Fronts", text, folded)


def navigation(places: list[tuple[str, str]]) -> str:
    links = "".join(f'<a href="#{place}">{name}</a>' for place, name in places)
    return f'<nav aria-label="parts of this page">{links}</nav>'


PLACES = [
    ("setup", "Set-up"),
    ("computation", "Computation"),
    ("space-time", "Space-time"),
    ("profiles", "t/p at a time"),
    ("criteria", "Front speed"),
    ("fracture", "G against Γ"),
    ("energy", "Energy"),
    ("snapshots", "Snapshots"),
    ("probes", "Probes"),
    ("fronts", "Fronts"),
]


def page(folder: Path, _file: Path) -> Page:
    run = open_run(folder)
    history = thinned(drawn_history(run), (MOST_TIMES, MOST_NODES))
    probes, before = probes_of(run), run.prestress
    data = run_data(run, history)
    constant = constant_fields([history])
    if probes is not None:
        units = units_of(history)
        data["probes"] = probe_data(probes, units["time"].factor, units["x"].factor, before)
    data["fracture"] = fracture_data(run, history, data["fronts"])
    missing = {"probes"} if probes is None else set()
    missing |= {"fracture"} if run.breakdown is None else set()
    snapshots = data["snapshots"]
    title = str(run.info.get("title", "")) or run.name
    return Page(
        title=f"{title}: {run.mark}" if run.mark else title,
        parts=[
            f'<p class="outcome">{outcome(run)}</p>',
            navigation([place for place in PLACES if place[0] not in missing]),
            section("setup", "Set-up", warnings_of(run), sketch(run), facts_table(setup.rows(run))),
            section("computation", "Computation", facts(run)),
            space_time_section(thinning(history), constant),
            profiles_section(history),
            criteria_section(data["panels"], data["folded"]),
            fracture_section(data["fracture"]) if run.breakdown is not None else "",
            energy_section(not data["energy"]["terms"]),
            snapshots_section(
                has_snapshots(run), frames_words(run), snapshots is not None and snapshots["still"]
            ),
            probes_section(probes, data["probes"], before) if probes is not None else "",
            fronts_section(run),
        ],
        data={
            "runs": [data],
            "fields": [field for field in FIELDS if field not in constant],
            "panels": data["panels"],
            "folded": data["folded"],
        },
        notes=run.remarks,
    )
