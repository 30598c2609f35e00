# SPDX-License-Identifier: BSD-3-Clause
"""The page of a sequence of slip events."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import to_hex

from slipfront.figures.sequence import RATE_RANGE_M_PER_S, phases, slip_after_events
from slipfront.files import is_number, number
from slipfront.folder import SEQUENCE
from slipfront.opened_sequence import OpenSequence, open_sequence
from slipfront.read import STATUSES, Place, entry, even, is_sequence
from slipfront.report import setup
from slipfront.report.numbers import Unit, listed, packed_bytes, unit
from slipfront.report.page import Page, facts_table, plot, section, warnings_list, words
from slipfront.report.run import MOST_NODES, navigation, program_words, sessions_words, speed_words
from slipfront.report.sketch import sketch
from slipfront.report.study import MOST_ROWS
from slipfront.report.tables import formatted, table
from slipfront.units import quantity, unit_of

is_kind = is_sequence  # of the folders of `slipfront report`
PLACES = [
    ("setup", "Set-up"),
    ("computation", "Computation"),
    ("forces", "Loads"),
    ("extents", "Extents"),
    ("slips", "Slip"),
    ("phases", "Slip rates"),
    ("events", "Events"),
]
MOST_CURVES = 60  # of slip, each after an event
MOST_ROWS_OF_PHASES, MOST_CREEPS = 1000, 2000  # of slip rates, and of loads in slow slip
NO_CONTACT = 255  # code of an open node among those of slip rates
COLOURS, LIGHTEST = "viridis", 0.9  # from the first event to the last
PHASES = {
    "tilted": "before any shear",
    "event_begins": "where event {} begins",
    "slip_ends": "where event {} ends",
    "at_rest": "at rest behind event {}",
    "loaded": "at the end of the loading",
    "creeps": "in slow slip before event {}",
}
RATIO = "F<sub>S</sub>/F<sub>N</sub>"


def mark(place: Place, n_events: int) -> str:
    """How a sequence ended that did not come to its end; empty for a complete one."""
    ending = STATUSES[place.status]
    if ending is None:
        return ""
    return f"{ending} event {n_events if place.status == 'running' else n_events + 1}"


def ending(place: Place, n_events: int) -> str:
    """Whether a sequence is complete, and why it ended, in plain words."""
    told = mark(place, n_events)
    if told:
        return f"<b>{words(place.with_reason(told))}</b>"
    return f"complete: {words(place.info.get('end') or 'why it ended is not given')}"


def state_words(place: Place, key: str) -> str:
    """Of a state of the loading that sequence.json tells."""
    file, info = place.folder / SEQUENCE, place.info
    names = ("shear_over_normal", "shear_force_N_per_m", "normal_force_N_per_m", "time_s", "shear_m", "event")
    if key not in info:
        return "not known yet"
    ratio, *rest, event = (number(file, info, f"{key}.{name}") for name in names)
    shear, normal, time, moved = (quantity(v, unit_of(n)) for n, v in zip(names[1:5], rest, strict=True))
    phase = str(info[key].get("phase"))
    phase = PHASES.get(phase, "").format(round(event) + (phase == "creeps"))
    return f"{ratio:.4f}, {words(phase)}: {shear} over {normal}, at {time} and a displacement of {moved}"


def outcome(sequence: OpenSequence) -> str:
    """How many events, and how far they slip, as a piece of HTML."""
    events = sequence.events
    n = events.sizes["event"]
    if n == 0:
        return "No event."
    n_global = int((events["is_global"] == 1).sum())
    slips_m = events["mean_slip_m"].to_numpy()
    least, most = (quantity(float(of(slips_m)), "m", 3) for of in (np.nanmin, np.nanmax))
    longest = int(np.nanargmax(events["length_m"].to_numpy()))
    speed = float(events["median_speed_m_per_s"][longest])
    parts = [
        f"{n} event{'' if n == 1 else 's'}, {n_global or 'none'} of them over the whole interface",
        f"mean slip {least}" + ("" if least == most else f" to {most}"),
        f"fronts of the longest at {speed_words(speed, sequence.info)}" if np.isfinite(speed) else "",
    ]
    return ", ".join(part for part in parts if part) + "."


def facts(sequence: OpenSequence) -> str:
    place, events = sequence.place, sequence.events
    imbalance = place.info.get("imbalance_over_largest_energy")
    n = events.sizes["event"]
    n_global = int((events["is_global"] == 1).sum())
    return facts_table(
        [
            ("Folder", words(place.name)),
            ("End", ending(place, n) + sessions_words(place.info)),
            ("Events", f"{n}, {n_global} of them over the whole interface"),
            (f"Largest {RATIO}", state_words(place, "largest_friction")),
            (f"Last {RATIO}", state_words(place, "last")),
            ("Imbalance of energy", f"{formatted(imbalance, '.2g')} of the largest term"),
            ("Program", program_words(place.info)),
        ]
    )


def setup_section(sequence: OpenSequence, remarks: list[str]) -> str:
    told = warnings_list(remarks, "mark") + warnings_list([note.text for note in sequence.notes])
    if len(sequence.runs) == 0:
        known = [told, sketch(sequence), facts_table(setup.rows_of_case(sequence))]
        return section("setup", "Set-up", *known, "<p>No event is complete.</p>")
    first = sequence.runs[0]
    return section(
        "setup",
        "Set-up",
        told,
        sketch(first),
        facts_table(setup.rows(first)),
        "<p>Loads, and what was expected, are of event 1.</p>",
    )


def local_strength(case: dict[str, Any]) -> float | None:
    """mu_s, where it is one number along the interface."""
    mu_s, varied = entry(case, "friction", "mu_s"), entry(case, "friction", "random_key")
    is_one = not entry(case, "friction", "file") and varied in (None, "", "none")
    return mu_s if is_number(mu_s) and is_one else None


def shown_rows(phase: np.ndarray) -> np.ndarray:
    """Of the loading: all equilibria, and of those in slow slip no more than a plot can show. [rows]"""
    creeps = np.flatnonzero(phase == "creeps")
    left_out = np.setdiff1d(creeps, creeps[even(len(creeps), MOST_CREEPS)])
    return np.setdiff1d(np.flatnonzero(phase != "slip_ends"), left_out)


def phases_data(sequence: OpenSequence, length: Unit) -> dict[str, Any] | None:
    """Slip rates of all phases as bytes on a logarithmic scale; none under a law without a state."""
    if len(sequence.slow) == 0:
        return None
    found = phases(sequence, MOST_ROWS_OF_PHASES, MOST_NODES)
    low, high = np.log10(RATE_RANGE_M_PER_S)
    share = (np.log10(np.clip(found.slip_rate_m_per_s, *RATE_RANGE_M_PER_S)) - low) / (high - low)
    codes = np.where(np.isnan(share), NO_CONTACT, np.round((NO_CONTACT - 1) * np.nan_to_num(share)))
    return {
        "x": listed(found.x_m, length.factor),
        "borders": listed(found.borders),
        "time": [f"{t:.10g}" for t in found.time_s],
        "powers": [low, high],
        "rates": packed_bytes(codes),
    }


def sequence_data(sequence: OpenSequence) -> dict[str, Any]:
    """All that the plots show."""
    events, slip = sequence.events, sequence.slip
    static = sequence.loading.isel(row=shown_rows(sequence.loading["phase"].to_numpy()))
    after = slip_after_events(sequence)
    nodes, curves = even(slip.sizes["x_m"], MOST_NODES), even(len(after), MOST_CURVES)
    units = {
        "x": unit("length", slip["x_m"]),
        "time": unit("time", static["time_s"]),
        "force": unit("force", static["shear_force_N_per_m"]),
        "slip": unit("slip", after),
    }
    at_rest = static.isel(row=(static["phase"] == "at_rest").to_numpy())
    colours = matplotlib.colormaps[COLOURS](np.linspace(0, LIGHTEST, events.sizes["event"]))
    columns = {
        "time": listed(events["begin_s"], units["time"].factor),
        "before": listed(events["friction_before"]),
        "after": listed(events["friction_after"]),
        "force_before": listed(events["shear_force_N_per_m"], units["force"].factor),
        "force_after": listed(at_rest["shear_force_N_per_m"], units["force"].factor),
        **{part: listed(events[f"{part}_x_m"], units["x"].factor) for part in ("begin", "from", "to")},
        "number": events["event"].to_numpy().tolist(),
        "colour": [to_hex(colour) for colour in colours],
    }
    return {
        "units": {name: unit.name for name, unit in units.items()},
        "loading": {
            "time": listed(static["time_s"], units["time"].factor),
            "ratio": listed(static["shear_over_normal"]),
            "force": listed(static["shear_force_N_per_m"], units["force"].factor),
        },
        "strength": local_strength(sequence.case),
        "events": [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)],
        "slip": {
            "x": listed(slip["x_m"][nodes], units["x"].factor),
            "events": (1 + curves).tolist(),
            "after": [listed(row, units["slip"].factor) for row in after[np.ix_(curves, nodes)]],
        },
        "phases": phases_data(sequence, units["x"]),
    }


def thinning(data: dict[str, Any], n_nodes: int) -> str:
    """What of the slip the page does not have."""
    slip = data["slip"]
    counts = ((len(slip["events"]), len(data["events"]), "events"), (len(slip["x"]), n_nodes, "nodes"))
    return "".join(f" {shown} of {n} {name} are drawn." for shown, n, name in counts if shown < n)


PHASES_SECTION = section(
    "phases",
    "Slip rates",
    plot("phases-plot", "Slip rate over place and over slow slip and events alternately"),
    "<p>Upward slow slip and events alternately: slow slip evenly over the steps of the computation, which "
    "are shorter where it is faster; above each orange line an event over its time. Grey: contact is open. "
    "Rows are left out evenly.</p>",
)


def plots(data: dict[str, Any], n_nodes: int) -> dict[str, str]:
    """Sections by name; without an event none of what events do."""
    strength = f"; dashed: {setup.MU_S} of a node" if data["strength"] is not None else ""
    found = {
        "forces": section(
            "forces",
            "Loads",
            plot("forces-plot", "Shear over normal force, and shear force, over time"),
            f"<p>{RATIO}: shear over normal force of the interface in static equilibria, the coefficient of "
            f"friction of the sample{strength}. Filled: an event begins; open: the equilibrium at rest "
            "behind it. "
            + (
                "Between events: slow slip, a point where the fastest slip rate has doubled or halved, and "
                "where the ratio turns.</p>"
                if data["phases"]
                else "From event to event the line is straight, whatever happens there.</p>"
            ),
        ),
    }
    if data["events"]:
        found["extents"] = section(
            "extents",
            "Extents",
            plot("extents-plot", "Where each event slips, over the load at which it begins, and in order"),
            "<p>Bars: from where to where an event slips. Diamonds: where slip begins inside.</p>",
        )
        found["slips"] = section(
            "slips",
            "Slip",
            plot("slips-plot", "Slip along the interface after each event"),
            "<p>Slip since normal loading, after each event: the sum of what the records end with. Dark: the "
            f"first event, light: the last.{thinning(data, n_nodes)}</p>",
        )
    if data["phases"]:
        found["phases"] = PHASES_SECTION
    return found


def events_section(sequence: OpenSequence) -> str:
    place, events = sequence.place, sequence.events
    n_events = events.sizes["event"]
    if n_events == 0:
        return section("events", "Events", "<p>None is complete.</p>")
    events = events.isel(event=slice(MOST_ROWS))
    left_out = f"<p>The first {MOST_ROWS} of {n_events} events.</p>" if n_events > MOST_ROWS else ""
    units = {
        "length": unit("length", [events[name].max() for name in ("to_x_m", "length_m")]),
        "slip": unit("slip", events["max_slip_m"]),
        "traction": unit("traction", events["stress_drop_Pa"]),
        "shear": unit("slip", events["shear_m"]),
        "time": unit("time", events["slip_s"]),
        "1": Unit("", 1.0),
    }
    columns = [
        ("begin_s", "At", unit("time", events["begin_s"]), ".6g"),
        ("shear_m", "shear", units["shear"], ".5g"),
        ("from_x_m", "From", units["length"], ".4g"),
        ("to_x_m", "to", units["length"], ".4g"),
        ("begin_x_m", "begins at", units["length"], ".4g"),
        ("friction_before", RATIO, units["1"], ".4f"),
        ("friction_after", "at rest", units["1"], ".4f"),
        ("mean_slip_m", "Mean slip", units["slip"], ".3g"),
        ("max_slip_m", "largest", units["slip"], ".3g"),
        ("stress_drop_Pa", "Stress drop", units["traction"], ".3g"),
        ("released_J_per_m", "Released", Unit("J/m", 1.0), ".3g"),
        ("breakdown_work_J_per_m", "breakdown", Unit("J/m", 1.0), ".3g"),
        ("wave_loss_J_per_m", "waves left", Unit("J/m", 1.0), ".3g"),
        ("slip_s", "Slips for", units["time"], ".4g"),
        ("n_fronts", "Fronts", units["1"], ".0f"),
        ("median_speed_m_per_s", "speed", Unit("m/s", 1.0), ".4g"),
    ]
    for wave in ("c_L", "c_S"):
        c = place.info.get("wave_speeds", {}).get(f"{wave}_m_per_s")
        if is_number(c) and c > 0:
            columns.append(("median_speed_m_per_s", "speed", Unit(setup.WAVES[wave], 1 / c), ".2f"))
    header = ["Event", *(f"{name} ({of.name})" if of.name else name for _, name, of, _ in columns)]
    cells = [[formatted(float(v), form, of.factor) for v in events[key]] for key, _, of, form in columns]
    numbers = [str(int(n)) for n in events["event"]]
    example = words(place.folder / "events" / "0001")
    return section(
        "events",
        "Events",
        left_out,
        table(header, [list(row) for row in zip(numbers, *cells, strict=True)], kind="dense"),
        "<p>Speed: the median of the longest front. All columns: events.csv, docs/files.md. A page of one "
        f"event: <code>slipfront report {example}</code>.</p>",
    )


def page(folder: Path, _file: Path) -> Page:
    sequence = open_sequence(folder)
    place = sequence.place
    n_events = sequence.events.sizes["event"]
    told = mark(place, n_events)
    title = str(place.info.get("title", "")) or place.name
    data = sequence_data(sequence) if sequence.loading.sizes["row"] > 1 else {}
    drawn = plots(data, sequence.slip.sizes["x_m"]) if data else {}
    remarks = [*([place.with_reason(told)] if told else []), *place.notes]
    always = ("setup", "computation", "events")
    return Page(
        title=f"{title}: {told}" if told else title,
        parts=[
            f'<p class="outcome">{outcome(sequence)}</p>',
            navigation([part for part in PLACES if part[0] in (*always, *drawn)]),
            setup_section(sequence, remarks),
            section("computation", "Computation", facts(sequence)),
            *drawn.values(),
            events_section(sequence),
        ],
        data={"runs": [], "sequence": data} if data else {},
        notes=remarks,
    )
