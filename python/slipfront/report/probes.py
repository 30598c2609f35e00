# SPDX-License-Identifier: BSD-3-Clause
"""Records of a run's probes, thinned to what a screen shows, and the part of the page that shows them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from slipfront.opened import OpenRun
from slipfront.read import BLEW_UP, PROBE_FIELDS, n_finite, require, require_ascending
from slipfront.report.numbers import listed, packed, unit
from slipfront.report.page import plot, section
from slipfront.units import quantity

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


def probes_of(run: OpenRun) -> xr.Dataset | None:
    """The records of a run, of one that blew up as far as they are finite; None of a run without any."""
    file, probes = run.folder / "probes.h5", None if run.place.growing else run.probes
    if probes is None:
        return None
    require_ascending(file, "time_s", probes["time_s"].to_numpy())
    if run.status == BLEW_UP:
        probes = probes.isel(time_s=slice(n_finite(*(probes[name].to_numpy() for name in PROBE_FIELDS))))
    if min(probes.sizes["time_s"], probes.sizes["probe"]) == 0:
        return None
    if run.records_prestress:  # the page shows the change, and adds what is known of the state before
        states = [name for name in PROBE_FIELDS if name.startswith(("strain", "stress"))]
        probes = probes.assign(
            {name: probes[name] - probes[name].isel(time_s=0, drop=True) for name in states}
        )
    for name in PROBE_FIELDS:
        require(np.isfinite(probes[name]), file, f"a value of {name} is not finite")
    return probes


def step_of(n: int, most: int) -> int:
    return max(1, -(-n // most))


def before_start(field: str, before: dict[str, float] | None) -> float | None:
    """What is to be added to the record of a field for the whole of it; None where that is not known.
    `before`: what recorded stress adds to, or None where the records are whole."""
    if before is None or field.startswith("v_"):
        return 0.0
    added = before.get(field, np.nan)
    return float(added) if np.isfinite(added) else None


def scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else factor * value


def probe_data(
    probes: xr.Dataset, time_factor: float, length_factor: float, before: dict[str, float] | None
) -> dict[str, Any]:
    """The records as values of JSON, in units that suit them; components that are zero throughout are only
    named."""
    shown_times = slice(None, None, step_of(probes.sizes["time_s"], MOST_TIMES))
    drawn = probes.isel(time_s=shown_times, probe=slice(0, MOST_PROBES))
    choices = []
    for name, (measure, fields) in CHOICES.items():
        values = {field: drawn[field].to_numpy() for field in fields}
        added = {field: before_start(field, before) for field in fields}
        shown = unit(measure, np.concatenate([values[field] + (added[field] or 0) for field in fields]))
        zero = [label for field, label in fields.items() if not values[field].any() and not added[field]]
        choices.append(
            {
                "name": name,
                "unit": shown.name,
                "zero": zero,
                "parts": [
                    {
                        "label": label,
                        "values": packed(shown.factor * values[field]),
                        "before": scaled(added[field], shown.factor),
                    }
                    for field, label in fields.items()
                    if label not in zero
                ],
            }
        )
    return {
        "are_changes": before is not None,
        "names": drawn["probe"].to_numpy().tolist(),
        "x": listed(drawn["x_m"], length_factor),
        "y": listed(drawn["y_m"], length_factor),
        "time": listed(drawn["time_s"], time_factor),
        "choices": choices,
    }


def left_out(probes: xr.Dataset) -> str:
    """What of the records the page does not have."""
    n_times, n_probes = probes.sizes["time_s"], probes.sizes["probe"]
    step = step_of(n_times, MOST_TIMES)
    skipped = []
    if n_probes > MOST_PROBES:
        skipped.append(f"the first {MOST_PROBES} of {n_probes} probes")
    if step > 1:
        skipped.append(f"one in {step} of {n_times} times")
    return f" The page holds {' and '.join(skipped)}; all are in probes.h5." if skipped else ""


def what_is_recorded(before: dict[str, float] | None) -> str:
    """What strain and stress count from, by the loading."""
    if before is None:
        return (
            "The records hold the whole strain and stress: the state before the event, from the unloaded "
            "body on, and what has changed since. The button leaves the change since the start (Δ)."
        )
    change = (
        "With prescribed tractions displacement, strain and stress are shown as changes since the start of "
        "the event (Δ)"
    )
    yy, xy = (before[f"stress_{name}_Pa"] for name in ("yy", "xy"))
    if not np.isfinite([yy, xy]).all():
        return f"{change}: tractions that vary along the interface leave the state in the bulk unknown."
    return (
        f"{change}. Stress without Δ is absolute: the uniform state of the prescribed tractions, "
        f"σ<sub>yy</sub> = −p = {quantity(yy, 'Pa')} and σ<sub>xy</sub> = t = {quantity(xy, 'Pa')}, and the "
        "change. They determine neither σ<sub>xx</sub> nor the strain before the event. The button leaves "
        "the changes."
    )


def probes_section(probes: xr.Dataset, data: dict[str, Any], before: dict[str, float] | None) -> str:
    choices = [choice for choice in data["choices"] if choice["parts"]]
    buttons = "".join(
        f'<button type="button" data-probes="{choice["name"]}" aria-pressed="false">{choice["name"]}</button>'
        for choice in choices
    )
    has_both = before is None or any(part["before"] for choice in choices for part in choice["parts"])
    change = '<button type="button" id="probes-change" aria-pressed="false">change since the start</button>'
    zero = [label for choice in data["choices"] for label in choice["zero"]]
    told = f" {', '.join(zero)}: zero at all probes and times." if zero else ""
    return section(
        "probes",
        "Probes",
        f'<p class="buttons" role="group" aria-label="what the probes record">{buttons}'
        f"{change if has_both else ''}</p>",
        plot("probes-plot", "Records of the probes over time"),
        f"<p>At the places of [probes]. {what_is_recorded(before)} Stress is positive in tension, "
        f"ε<sub>xy</sub> half the engineering shear strain.{told} A click on a name hides or shows the "
        f"probe.{left_out(probes)}</p>",
    )
