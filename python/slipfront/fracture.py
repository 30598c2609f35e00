# SPDX-License-Identifier: BSD-3-Clause
"""Fronts as cracks: docs/fracture.md."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

import slipfront.printed  # noqa: F401
from slipfront import _core
from slipfront.errors import CaseError
from slipfront.given import array, number
from slipfront.opened import OpenRun
from slipfront.running import CaseLike, make_case
from slipfront.units import attributes

#: At places x_m, or one value for all.
AlongX = float | tuple[ArrayLike, ArrayLike]


#: Columns of fracture.csv that a prediction by a run takes.
MEASURED = ("breakdown_work_J_per_m2", "residual_coefficient", "breakdown_complete")


def along_x(given: AlongX | None, name: str, *, above: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Places and values; no values where nothing is given."""
    if given is None:
        return np.zeros(1), np.zeros(0)
    if not isinstance(given, tuple | list):
        return np.zeros(1), np.array([number(given, name, above=above, finite=True)])
    if len(given) != 2:
        raise CaseError(f"{name} has {len(given)} parts; give a number, or places and values")
    x_m = array(given[0], f"the places of {name}", finite=True)
    values = array(given[1], name, finite=True)
    if len(x_m) != len(values) or len(x_m) == 0 or not (np.diff(x_m) > 0).all():
        raise CaseError(f"{name} has {len(x_m)} places and {len(values)} values; give as many, x ascending")
    if above is not None and not (values > above).all():
        raise CaseError(f"a value of {name} is {values.min()}; it must be above {above:g}")
    return x_m, values


def measured_friction(run: OpenRun) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, breakdown work and residual coefficient where a front's breakdown came to its end."""
    table = run.fracture
    numeric = all(name in table and table[name].dtype.kind == "f" for name in MEASURED)
    if not numeric:
        raise CaseError(f"{run.folder}: no fracture.csv with numbers of {', '.join(MEASURED)}")
    done = table["breakdown_complete"].to_numpy() == 1
    for name in MEASURED[:2]:
        done &= np.isfinite(table[name].to_numpy())
    if not done.any():
        raise CaseError(f"{run.folder}: no front's breakdown came to its end")
    x_m, first = np.unique(table["x_m"].to_numpy()[done], return_index=True)
    work = table["breakdown_work_J_per_m2"].to_numpy()[done][first]
    return x_m, np.maximum(work, np.finfo(float).tiny), table["residual_coefficient"].to_numpy()[done][first]


def predict_fronts(
    case: CaseLike | OpenRun,
    changes: Mapping[str, Any] | None = None,
    /,
    *,
    fracture_energy_J_per_m2: AlongX | None = None,
    residual_coefficient: AlongX | None = None,
    at_x_m: float | None = None,
    **tables: Any,
) -> xr.Dataset:
    """Fronts of a case before it runs, as cracks: whether they start, how fast they run, where they arrest.

    The front's tip moves so that g(v) G_static, the energy release rate of the crack at rest between both
    tips, with the residual traction on it, times a function of the speed, is the fracture energy (Freund
    1990). G_static is by statics of the sample, or of half-spaces where its edges absorb waves.

    case: as for `run`; or an opened run, whose breakdown work and residual coefficients are then those of the
    prediction unless they are given.
    fracture_energy_J_per_m2, residual_coefficient: a number, or places and values, instead of those of the
    friction law, which has none where it does not weaken over a slip. Residual traction: this coefficient
    times p, and the cohesion.
    at_x_m: where the crack begins, instead of at the case's trigger.

    Returns, over `point` in the order of travel of each front: x_m, direction, length_m of the crack,
    G_static_J_per_m2, fracture_energy_J_per_m2, v_tip_m_per_s, time_s since the fronts began; the last point
    of a front that arrests is the node that it does not break. In the attributes: starts, first_length_m,
    critical_length_m, nucleation_length_m (slow slip over it runs away), arrests (directions), bodies, notes.
    Raises CaseError."""
    energy, residual = fracture_energy_J_per_m2, residual_coefficient
    if isinstance(case, OpenRun):
        x_m, work, coefficient = measured_friction(case)
        energy = (x_m, work) if energy is None else energy
        residual = (x_m, coefficient) if residual is None else residual
        case = case.case
    energies = along_x(energy, "fracture_energy_J_per_m2", above=0)
    residuals = along_x(residual, "residual_coefficient", above=None)
    places = np.union1d(energies[0], residuals[0])

    def at_places(given: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        return np.interp(places, *given) if len(given[1]) else given[1]

    at = None if at_x_m is None else number(at_x_m, "at_x_m", finite=True)
    prepared = make_case(case, changes, tables)
    found = _core.predict_fronts(prepared, places, at_places(energies), at_places(residuals), at)
    points = {
        name: xr.Variable(("point",), values, attributes(name))
        for name, values in found.pop("points").items()
    }
    points["direction"] = points["direction"].astype(np.int64)
    return xr.Dataset({k: v for k, v in points.items() if k != "x_m"}, {"x_m": points["x_m"]}, found)
