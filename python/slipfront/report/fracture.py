# SPDX-License-Identifier: BSD-3-Clause
"""The fronts of a run as cracks: fracture energy, energy release rate, and the speeds that these predict."""

from __future__ import annotations

from typing import Any

import numpy as np

import slipfront
from slipfront.errors import Error
from slipfront.opened import OpenRun
from slipfront.read import BLEW_UP
from slipfront.report.history import ThinHistory
from slipfront.report.numbers import Unit, listed
from slipfront.report.page import plot, section, words
from slipfront.report.run_data import units_of

ENERGIES = ("breakdown_work_J_per_m2", "G_slip_J_per_m2")
LOG_FROM = 10.0  # the largest energy over the median fracture energy


def prediction(run: OpenRun, x_unit: Unit) -> tuple[dict[str, Any] | None, str]:
    """Curves of the equation of motion with the run's own friction, a gap between directions; and what to say
    of them."""
    if run.status == BLEW_UP:
        return None, "No prediction: the run blew up."
    try:
        found = slipfront.predict_fronts(run)
    except (Error, ImportError) as error:
        return None, f"No prediction: {words(error)}."
    told = found.attrs

    def place(length_m: float) -> str:
        return f"{x_unit.factor * length_m:.4g} {x_unit.name}"

    directions = found["direction"].to_numpy()
    gaps = np.flatnonzero(np.diff(directions)) + 1

    def curve(name: str, factor: float) -> list[float | None]:
        return listed(np.insert(found[name].to_numpy(), gaps, np.nan), factor)

    arrests = [] if told["doubts_of_arrest"] else told["arrests"]
    arrests_m = [float(found["x_m"][directions == way][-1]) for way in arrests]
    first = f"a first crack of {place(told['first_length_m'])}"
    if told["starts"]:
        start = f"{first} runs"
    elif np.isnan(told["critical_length_m"]):
        start = f"{first} does not run, however long it grows"
    else:
        start = f"{first} does not run before it has grown to {place(told['critical_length_m'])}"
    ends = f"; arrest at x = {' and '.join(map(place, arrests_m))}" if arrests_m else ""
    said = [
        "Black, predicted by G at rest times g(V<sub>tip</sub>) = Γ, with Γ and residual coefficient of the "
        f"run and statics of {words(told['bodies'])}: {start}{ends}.",
        *(f"Note: {words(note)}." for note in told["notes"]),
    ]
    curves = {
        "x": curve("x_m", x_unit.factor),
        "at_rest": curve("G_static_J_per_m2", 1.0),
        "v": curve("v_tip_m_per_s", 1 / run.c_L_m_per_s),
        "arrests": listed(arrests_m, x_unit.factor),
    }
    return curves, " ".join(said)


def fracture_data(run: OpenRun, history: ThinHistory, fronts: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Adds energies to the data of the fronts; None where no front's breakdown came to its end."""
    if run.breakdown is None or not fronts:
        return None
    of_drawn = [run.breakdown[front["id"]] for front in fronts]
    energy, by_slip = (np.concatenate([of[name] for of in of_drawn]) for name in ENERGIES)
    energy = energy[np.isfinite(energy) & (energy > 0)]
    by_slip = by_slip[np.isfinite(by_slip)]
    if len(energy) == 0:
        return None
    for front, of in zip(fronts, of_drawn, strict=True):
        front["gamma"], front["g_slip"] = (listed(of[name]) for name in ENERGIES)
    curves, said = prediction(run, units_of(history)["x"])
    at_rest = [g for g in curves["at_rest"] if g is not None] if curves else []
    typical = float(np.median(energy))
    largest = float(max(*energy, *by_slip, *at_rest))
    is_log = largest > LOG_FROM * typical
    return {
        "prediction": curves,
        "said": said,
        "is_log": is_log,
        "range": [typical / 10 if is_log else 0.0, (1.5 if is_log else 1.1) * largest],
    }


def fracture_section(data: dict[str, Any] | None) -> str:
    heading = "G against Γ"
    if data is None:
        return section("fracture", heading, "<p>The breakdown of no front that is drawn came to its end.</p>")
    return section(
        "fracture",
        heading,
        plot(
            "fracture-plot", "Fracture energy and energy release rate, and front speed, along the interface"
        ),
        '<p class="readout" aria-live="polite">Point at a node of a front.</p>',
        "<p>Points: breakdown work, which is the fracture energy Γ, where the breakdown came to its end. "
        f"Coloured lines: energy release rate G by the slip behind the tip. {data['said']} Definitions: "
        "docs/fracture.md.</p>",
    )
