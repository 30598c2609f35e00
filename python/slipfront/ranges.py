# SPDX-License-Identifier: BSD-3-Clause
"""What numbers of solids and slip fronts are, widely: beyond that a unit is wrong."""

from __future__ import annotations

from collections.abc import Mapping

from slipfront.units import unit_of

#: From gels to diamond, from the laboratory to the largest earthquakes.
RANGES = {
    "youngs_modulus_Pa": (1e3, 2e12),
    "density_kg_per_m3": (10.0, 3e4),
    "strain": (1e-8, 0.1),
    "stress_Pa": (10.0, 1e10),
    "peak_t_Pa": (10.0, 1e10),
    "residual_coefficient": (-1.0, 10.0),
    "weakening_distance_m": (1e-10, 100.0),
    "breakdown_work_J_per_m2": (1e-5, 1e9),
    "Gamma_J_per_m2": (1e-5, 1e9),
}


def beyond(values: Mapping[str, float]) -> list[str]:
    """What is said of each value out of its range; NaN and names without one pass."""
    told = []
    for name in (name for name in RANGES if name in values):
        (low, high), value = RANGES[name], values[name]
        if value < low or value > high:
            unit = unit_of(name)
            after = "" if unit == "1" else f" {unit}"
            told.append(
                f"{name} is {value:.3g}{after}, not from {low:g} to {high:g}{after}: is a unit wrong?"
            )
    return told
