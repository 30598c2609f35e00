# SPDX-License-Identifier: BSD-3-Clause
"""Records of a run's probes, thinned to what a screen shows, and the part of the page that shows them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from slipfront.folder import belongs
from slipfront.read import BLEW_UP, Place, Probes, n_finite, read_probes, require, require_ascending
from slipfront.report.numbers import listed, packed, unit
from slipfront.report.page import plot, section

MOST_PROBES, MOST_TIMES = 24, 1200
#: What can be chosen: its name, the quantity of its unit, and the fields that are drawn below each other.
CHOICES = {
    "velocity": ("speed", {"v_x_m_per_s": "v<sub>x</sub>", "v_y_m_per_s": "v<sub>y</sub>"}),
    "strain": (
        "strain",
        {
            "strain_xx": "ε<sub>xx</sub>",
            "strain_yy": "ε<sub>yy</sub>",
            "strain_xy": "ε<sub>xy</sub>",
        },
    ),
    "stress": (
        "traction",
        {
            "stress_xx_Pa": "σ<sub>xx</sub>",
            "stress_yy_Pa": "σ<sub>yy</sub>",
            "stress_xy_Pa": "σ<sub>xy</sub>",
        },
    ),
    "displacement": ("slip", {"u_x_m": "u<sub>x</sub>", "u_y_m": "u<sub>y</sub>"}),
}


def probes_of(place: Place) -> Probes | None:
    """The records of a run, of one that blew up as far as they are finite; None of a run without any."""
    file = place.folder / "probes.h5"
    if place.growing or not belongs(file):
        return None
    probes = read_probes(file)
    require_ascending(file, "time_s", probes.time_s)
    if place.status == BLEW_UP:
        n = n_finite(*probes.fields.values())
        cut = {name: values[:n] for name, values in probes.fields.items()}
        probes = replace(probes, time_s=probes.time_s[:n], fields=cut)
    for name, values in probes.fields.items():
        require(np.isfinite(values), file, f"a value of {name} is not finite")
    return probes if len(probes.time_s) > 0 and probes.names else None


def step_of(n: int, most: int) -> int:
    return max(1, -(-n // most))


def probe_data(probes: Probes, time_factor: float, length_factor: float) -> dict[str, Any]:
    """The records as values of JSON, in units that suit them."""
    times = slice(None, None, step_of(len(probes.time_s), MOST_TIMES))
    every = slice(0, MOST_PROBES)
    choices = []
    for name, (quantity, fields) in CHOICES.items():
        values = {field: probes.fields[field][times, every] for field in fields}
        shown = unit(quantity, np.concatenate(list(values.values())))
        choices.append(
            {
                "name": name,
                "unit": shown.name,
                "parts": [
                    {"label": label, "values": packed(shown.factor * values[field])}
                    for field, label in fields.items()
                ],
            }
        )
    return {
        "names": list(probes.names[every]),
        "x": listed(probes.x_m[every], length_factor),
        "y": listed(probes.y_m[every], length_factor),
        "time": listed(probes.time_s[times], time_factor),
        "choices": choices,
    }


def left_out(probes: Probes) -> str:
    """What of the records the page does not have."""
    step = step_of(len(probes.time_s), MOST_TIMES)
    skipped = []
    if len(probes.names) > MOST_PROBES:
        skipped.append(f"the first {MOST_PROBES} of {len(probes.names)} probes")
    if step > 1:
        skipped.append(f"one in {step} of {len(probes.time_s)} times")
    return f" The page holds {' and '.join(skipped)}; all are in probes.h5." if skipped else ""


def probes_section(probes: Probes) -> str:
    buttons = "".join(
        f'<button type="button" data-probes="{name}" aria-pressed="false">{name}</button>' for name in CHOICES
    )
    change = '<button type="button" id="probes-change" aria-pressed="false">change since the start</button>'
    return section(
        "probes",
        "Probes",
        f'<p class="buttons" role="group" aria-label="what the probes record">{buttons}{change}</p>',
        plot("probes-plot", "Records of the probes over time"),
        "<p>At the places of [probes], as strain gauges record: the sum of the state before the event and of "
        "what has changed since, or the change alone. Stress is positive in tension, ε<sub>xy</sub> half the "
        f"engineering shear strain. A click on a name hides or shows the probe.{left_out(probes)}</p>",
    )
