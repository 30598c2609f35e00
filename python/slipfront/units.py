# SPDX-License-Identifier: BSD-3-Clause
"""Units and words of the quantities that keys and columns name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

#: Endings of names, the longest first.
ENDINGS = {
    "_Pa_sqrt_m": "Pa m1/2",
    "_kg_per_m3": "kg/m3",
    "_kg_per_m2": "kg/m2",
    "_J_per_m3": "J/m3",
    "_J_per_m2": "J/m2",
    "_m2_per_s2": "m2/s2",
    "_m2_per_s": "m2/s",
    "_N_per_s": "N/s",
    "_J_per_m": "J/m",
    "_Pa_per_m": "Pa/m",
    "_N_per_m": "N/m",
    "_m_per_s": "m/s",
    "_per_s": "1/s",
    "_bytes": "bytes",
    "_m2": "m2",
    "_Pa": "Pa",
    "_s": "s",
    "_m": "m",
}
SYMBOLS = ("mu_s", "mu_k", "d_c", "l_star")  # their underscores are subscripts
PREFIXED = ("m", "s", "Pa", "Pa/m", "N/m")
PREFIXES = {"G": 1e-9, "M": 1e-6, "k": 1e-3, "": 1.0, "m": 1e3, "µ": 1e6, "n": 1e9}
WRITTEN = {"m2": "m²", "kg/m2": "kg/m²", "kg/m3": "kg/m³", "m2/s2": "m²/s²", "m2/s": "m²/s"}
WRITTEN |= {"J/m3": "J/m³", "J/m2": "J/m²"}
WRITTEN |= {"J m-1": "J/m", "J m-2": "J/m²"}  # of NetCDF

#: What columns of tables and arrays hold.
LONG_NAMES = {
    "x_m": "position along the interface from the left edge",
    "y_m": "position above the interface; below 0 in the base",
    "time_s": "time since the start of the event",
    "slip_m": "displacement of the plate along x relative to its base, since the start",
    "slip_rate_m_per_s": "velocity of the plate along x relative to its base",
    "t_Pa": "tangential traction, positive against sliding to +x",
    "p_Pa": "contact pressure, positive in compression",
    "t_s_Pa": "tangential traction before the event",
    "p_s_Pa": "contact pressure before the event",
    "t_d_Pa": "tangential traction when the tip is l* short of the point",
    "p_d_Pa": "contact pressure when the tip is l* short of the point",
    "t_r_Pa": "tangential traction at the onset of slip",
    "p_r_Pa": "contact pressure at the onset of slip",
    "U_s_J_per_m3": "energy density when the tip arrives",
    "U_r_J_per_m3": "energy density when the tip is about to go on",
    "front_id": "number of the front",
    "front": "number of the front",
    "onset_s": "time at which slip begins",
    "v_tip_m_per_s": "speed of the front's tip",
    "breakdown_work_J_per_m2": "breakdown work: fracture energy",
    "peak_t_Pa": "largest tangential traction, where slip begins",
    "residual_t_Pa": "residual tangential traction",
    "residual_coefficient": "least ratio of t, less the cohesion, to p behind the tip",
    "weakening_distance_m": "slip of a linear fall to the residual traction with the same breakdown work",
    "weakening_time_s": "time of a fall linear in time with the same impulse above the residual traction",
    "breakdown_complete": "1 where the breakdown came to its end",
    "stress_drop_Pa": "tangential traction before the event less the residual one",
    "cohesive_zone_m": "length behind the tip in which friction weakens",
    "K_Pa_sqrt_m": "stress intensity factor of the breakdown work",
    "G_slip_J_per_m2": "energy release rate by the slip behind the tip",
    "G_static_J_per_m2": "energy release rate of the crack at rest",
    "fracture_energy_J_per_m2": "fracture energy",
    "length_m": "length of the crack",
    "speed_kind": "what begins to slip over the length of the speed",
    "direction": "direction of the front along x",
    "direction_of_point": "direction of the front along x",
    "end": "how the front ends",
    "mode": "kind of slip",
    "slipping_share": "slipping length over the distance run",
    "accelerating": "whether the front speeds up",
    "node": "number of the node",
    "static_ratio": "static ratio t_s/p_s",
    "dynamic_ratio": "dynamic ratio t_d/p_d",
    "energy_rise": "relative rise of the energy density (U_r - U_s)/U_s",
    "strain_J_per_m": "strain energy",
    "kinetic_J_per_m": "kinetic energy",
    "machine_J_per_m": "energy in the loading machine",
    "top_work_J_per_m": "work of the moving top edge or machine",
    "trigger_work_J_per_m": "work of the trigger's forces",
    "prestress_work_J_per_m": "work of the prescribed tractions",
    "friction_work_J_per_m": "work of the tangential traction",
    "contact_work_J_per_m": "work of the pressure",
    "damping_work_J_per_m": "work of the stiffness damping",
    "boundary_work_J_per_m": "work of the absorbing edges",
    "coupling_work_J_per_m": "error of the sub-steps",
    "imbalance_J_per_m": "change of the stored energies less the works",
    "mu_s": "friction coefficient at rest",
    "mu_k": "friction coefficient in full slip",
    "cell_nodes": "nodes of the cell, counterclockwise",
    "component": "component of a vector",
    "probe": "name of the probe",
}


#: What numbers of solids and slip fronts are, from gels to diamond, from the laboratory to great earthquakes:
#: lowest, highest, and what it follows from; beyond that a unit is wrong.
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


@dataclass(frozen=True)
class Unit:
    """What a quantity is shown in; `factor` is from SI to it."""

    name: str
    factor: float


def unit_of(name: str) -> str:
    """The unit that the name of a quantity ends with; "1" for a number without one."""
    if name in ("mu_s", "mu_k"):  # static and kinetic
        return "1"
    return next((unit for ending, unit in ENDINGS.items() if name.endswith(ending)), "1")


def name_of(key: str) -> str:
    """A key or column in words, without its unit: `friction.d_c_m` is `d_c`, `plate.width_m` `width`."""
    leaf = key.rsplit(".", 1)[-1]
    unit = unit_of(leaf)
    ending = next((ending for ending in ENDINGS if ENDINGS[ending] == unit), "")
    bare = leaf.removesuffix(ending)
    return bare if bare in SYMBOLS else bare.replace("_", " ")


def attributes(name: str, **found: str) -> dict[str, str]:
    """`units` and `long_name`, by the CF conventions, of what goes by a name; what is `found` wins."""
    return {"units": unit_of(name), "long_name": LONG_NAMES.get(name, name_of(name))} | found


def variables(dims: tuple[str, ...], columns: Mapping[str, Any]) -> dict[str, xr.Variable]:
    """Arrays by their names, with units and words."""
    return {name: xr.Variable(dims, values, attributes(name)) for name, values in columns.items()}


def engineering(unit: str, values: ArrayLike) -> Unit:
    """The prefix with which the largest of the values is from 1 to below 1000; none but of m, s, Pa."""
    numbers = np.abs(np.asarray(values, dtype=float))
    largest = float(f"{np.max(numbers[np.isfinite(numbers)], initial=0.0):.4g}")
    if unit not in PREFIXED or largest == 0:
        return Unit(WRITTEN.get(unit, unit), 1.0)
    fitting = (prefix for prefix, factor in PREFIXES.items() if largest * factor >= 1 - 1e-9)
    prefix = next(fitting, "n")
    return Unit(prefix + unit, PREFIXES[prefix])


def quantity(value: float, unit: str, digits: int = 4) -> str:
    """A number in engineering units: 2.4e9 Pa is `2.4 GPa`."""
    shown = engineering(unit, value)
    number = f"{value * shown.factor:.{digits}g}"
    return number if unit == "1" else f"{number} {shown.name}"


def velocity(m_per_s: float, digits: int = 4) -> str:
    """A speed: of slow ones in mm/s, µm/s or nm/s."""
    return f"{m_per_s:.{digits}g} m/s" if abs(m_per_s) >= 1 else f"{quantity(m_per_s, 'm', digits)}/s"


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
