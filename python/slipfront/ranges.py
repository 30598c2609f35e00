# SPDX-License-Identifier: BSD-3-Clause
"""What numbers of solids and slip fronts are, widely: beyond that a unit is wrong."""

from __future__ import annotations

from collections.abc import Mapping

from slipfront.units import unit_of

#: Lowest, highest, and what it follows from: from gels to diamond, from the laboratory to great earthquakes.
RANGES = {
    "limiting_speed_m_per_s": (0.5, 2e4, "modulus and density"),
    "strain": (1e-6, 0.02, "strain"),  # what gauges with amplifiers of 1 MHz resolve
    "stress_Pa": (10.0, 1e10, "stress"),
    "peak_t_Pa": (10.0, 1e10, "t_Pa"),
    "residual_coefficient": (-1.0, 10.0, "t_Pa and p_Pa"),
    "weakening_distance_m": (1e-10, 100.0, "slip_m"),
    "breakdown_work_J_per_m2": (1e-5, 1e9, "t_Pa and slip_m"),
    "Gamma_J_per_m2": (1e-5, 1e9, "strain or stress, modulus and y"),
}


def beyond(values: Mapping[str, float]) -> list[str]:
    """What is said of each value out of its range; NaN passes."""
    doubts = []
    for name, value in values.items():
        low, high, of = RANGES[name]
        if value < low or value > high:
            unit = "" if unit_of(name) == "1" else f" {unit_of(name)}"
            doubts.append(
                f"{name} is {value:.3g}, not from {low:g} to {high:g}{unit}: check the units of {of}"
            )
    return doubts
