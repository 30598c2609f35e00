# SPDX-License-Identifier: BSD-3-Clause
"""Fronts as cracks: docs/fracture.md."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.integrate import trapezoid

import slipfront.printed  # noqa: F401
from slipfront import _core
from slipfront.errors import CaseError
from slipfront.given import array, column, number, refusing
from slipfront.measures import Arrays, field_of, history_arrays
from slipfront.opened import OpenRun
from slipfront.running import CaseLike, make_case
from slipfront.units import RANGES, beyond, variables

#: At places x_m, or one value for all.
AlongX = float | tuple[ArrayLike, ArrayLike]


#: Columns of fracture.csv that a prediction by a run takes.
MEASURED = ("breakdown_work_J_per_m2", "residual_coefficient", "breakdown_complete")
#: Samples of a history in the time in which friction weakens: fewer do not tell the work, or roughly.
FEWEST_SAMPLES, FEW_SAMPLES = 2, 8
#: Slip over the integral of its rate, from its inverse to this: beyond the first it is worth a note, since
#: the work is wrong by as much, beyond the second a unit is wrong.
SLIP_AGREES, SLIP_IN_UNITS = 1.1, 10
#: G by slip over breakdown work, from its inverse to this, of fronts that are steady enough.
G_AGREES = 2


def along_x(given: AlongX | None, name: str, *, above: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Places and values; no values where nothing is given."""
    if given is None:
        return np.zeros(1), np.zeros(0)
    if not isinstance(given, tuple | list):
        return np.zeros(1), np.array([number(given, name, above=above, finite=True)])
    if len(given) != 2 or any(np.ndim(part) != 1 for part in given):
        raise CaseError(f"{name} must be a number, or a pair of arrays: places in m, and values")
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
    prediction unless they are given; of an event of a sequence the tractions before it, too.
    fracture_energy_J_per_m2, residual_coefficient: a number, or places and values, instead of those of the
    friction law, which has none where it does not weaken over a slip. Residual traction: this coefficient
    times p, and the cohesion.
    at_x_m: where the crack begins, instead of at the case's trigger.

    Returns, over `point` in the order of travel of each front: x_m, direction, length_m of the crack,
    G_static_J_per_m2, fracture_energy_J_per_m2, v_tip_m_per_s, time_s since the fronts began; the last point
    of a front that arrests is the node that it does not break. In the attributes: starts (1 or 0),
    first_length_m, critical_length_m, nucleation_length_m (slow slip over it runs away), arrests, which are
    directions, bodies, notes, doubts_of_arrest: why fronts may run on where they arrest by it.
    Raises CaseError."""
    energy, residual = fracture_energy_J_per_m2, residual_coefficient
    notes = []
    energy_is_of_run = False
    before = None
    if isinstance(case, OpenRun):
        if any(str(name).startswith("friction") for name in (*(changes or {}), *tables)):
            raise CaseError("friction of an opened run is what it came to: give its case to change friction")
        if energy is None or residual is None:
            x_m, work, coefficient = measured_friction(case)
            ends = f"{x_m[0]:.4g} to {x_m[-1]:.4g} m"
            notes = [f"friction beyond {ends}, where no front broke it down, is that at these ends"]
            energy_is_of_run = energy is None
            energy = (x_m, work) if energy is None else energy
            residual = (x_m, coefficient) if residual is None else residual
        if case.is_of_sequence:
            tractions = case.tractions
            before = (
                tractions.x_m.to_numpy(), tractions.t_s_Pa.to_numpy(), tractions.p_s_Pa.to_numpy()
            )  # fmt: skip
            at_x_m = case.info["statics"]["peak_x_m"] if at_x_m is None else at_x_m
        case = case.case
    energies = along_x(energy, "fracture_energy_J_per_m2", above=0)
    residuals = along_x(residual, "residual_coefficient", above=None)
    places = np.union1d(energies[0], residuals[0])

    def at_places(given: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        return np.interp(places, *given) if len(given[1]) else given[1]

    at = None if at_x_m is None else number(at_x_m, "at_x_m", finite=True)
    prepared = make_case(case, changes, tables)
    found = _core.predict_fronts(prepared, places, at_places(energies), at_places(residuals), at, before)
    points = xr.Dataset(variables(("point",), found.pop("points"))).set_coords("x_m")
    points["direction"] = points["direction"].astype(np.int64)
    if not found.pop("law_has_length") and energy_is_of_run:
        notes.append("the friction law has no length: its fracture energy is that of the run's mesh")
    found["notes"] += notes
    found["starts"] = int(found["starts"])  # netCDF has no truth values
    return points.assign_attrs(found)


def case_of_bodies(given: OpenRun | CaseLike | _core.Case) -> _core.Case:
    """The bodies of a run, a case, or a dictionary of its tables material and base, such as {"material":
    {...}, "base": {"kind": "rigid"}}. Without base: an equal body, as in a case. No size counts."""
    if isinstance(given, OpenRun):
        given = {name: table for name, table in given.case.items() if name in ("material", "base")}
    if isinstance(given, Mapping) and isinstance(base := given.get("base"), Mapping):
        given = {**given, "base": {"height_m": 0.1, **base}} if base.get("kind") == "body" else given
    return given if isinstance(given, _core.Case) else make_case(given, None, {})


def fracture_of_history(
    history: Arrays,
    fronts: Arrays,
    bodies: OpenRun | CaseLike | _core.Case,
    *,
    threshold_m_per_s: float = 1e-3,
    cohesion_Pa: float = 0.0,
) -> xr.Dataset:
    """Fracture mechanics of the fronts in a history of an interface, as OpenRun.fracture has it of a run's.

    history: time_s [times], x_m [nodes], slip_m, slip_rate_m_per_s, t_Pa and p_Pa [times, nodes].
    fronts: of find_fronts_in_history; places are nodes of the history.
    bodies: on both sides of the interface, see case_of_bodies.
    threshold_m_per_s: a node slips while its slip rate is above it. cohesion_Pa: of t, beside what goes with
    p.

    Slip begins with the sample before the first one above the threshold; integrals are trapezoids over the
    samples. In the attribute notes: what speaks against the numbers. Raises CaseError, also where the
    breakdown falls between two samples."""
    time_s, x_m, rate, t, p = history_arrays(history)
    slip = field_of(history, "slip_m", finite=True)
    slip = slip - slip[:1]
    for name, values in {"t_Pa": t, "p_Pa": p}.items():
        array(values, f"history['{name}']", dims=2, finite=True)
    threshold = number(threshold_m_per_s, "threshold_m_per_s", above=0, finite=True)
    cohesion = number(cohesion_Pa, "cohesion_Pa", least=0, finite=True)
    places = ("front_id", "direction_of_point", "x_m", "onset_s")
    points = {name: column(fronts, "fronts", name, finite=True) for name in places}
    points |= {name: column(fronts, "fronts", name) for name in ("v_tip_m_per_s", "t_s_Pa")}
    node = nodes_of(points, x_m)
    case = case_of_bodies(bodies)
    with refusing():
        found = _core.fracture_of_history(
            case, time_s, x_m, slip, rate, t, p, points["front_id"], points["direction_of_point"], node,
            points["x_m"], points["onset_s"], points["v_tip_m_per_s"], points["t_s_Pa"], threshold, cohesion,
        )  # fmt: skip
    notes = notes_on_slip(time_s, slip, rate)
    done = found["breakdown_complete"] == 1
    if not done.any():
        raise CaseError(
            "history: no front's breakdown came to its end within it: it is too short, friction does not "
            "fall behind its fronts, or signs are others: t drives the slip, p is positive in compression"
        )
    limit = case.limiting_speed_m_per_s
    notes += beyond({"limiting_speed_m_per_s": limit}) + notes_on(
        float(np.median(np.diff(time_s))), {name: of[done] for name, of in found.items()}
    )
    columns = {
        "front_id": points["front_id"].astype(np.int64), "x_m": points["x_m"], "onset_s": points["onset_s"],
        "direction": points["direction_of_point"], "v_tip_m_per_s": points["v_tip_m_per_s"], **found,
    }  # fmt: skip
    made = xr.Dataset(variables(("point",), columns), attrs={"notes": notes})
    return made.set_coords(["front_id", "x_m", "onset_s"])


def nodes_of(points: Mapping[str, np.ndarray], x_m: np.ndarray) -> np.ndarray:
    """Numbers of the nodes at which the points of fronts are."""
    lengths = ", ".join(f"{name} {len(values)}" for name, values in points.items())
    if len({len(values) for values in points.values()}) > 1:
        raise CaseError(f"fronts: its arrays differ in length: {lengths}")
    at = points["x_m"]
    if len(at) == 0:
        raise CaseError("fronts: there are none")
    if len(x_m) < 2 or not (np.diff(x_m) > 0).all():
        raise CaseError("history['x_m'] must ascend and have two values or more")
    node = np.searchsorted(0.5 * (x_m[1:] + x_m[:-1]), at)
    away = np.abs(x_m[node] - at) > 0.01 * np.diff(x_m).min()
    if away.any():
        raise CaseError(
            f"fronts['x_m']: {at[away][0]:g} m is no place of the history; give fronts found in it"
        )
    same = np.diff(points["front_id"]) == 0
    if not (np.diff(at) * points["direction_of_point"][1:] > 0)[same].all():
        raise CaseError("fronts['x_m']: the points of a front do not follow its direction")
    return node.astype(np.float64)


def notes_on_slip(time_s: np.ndarray, slip_m: np.ndarray, rate: np.ndarray) -> list[str]:
    """Where slip and slip rate disagree; refuses those of different units."""
    by_rate = np.abs(trapezoid(rate, time_s, axis=0)).sum()
    own = np.abs(slip_m[-1] - slip_m[0]).sum()
    more = float(max(own, by_rate) / max(min(own, by_rate), 1e-300))
    told = (
        f"slip_m grows by {own:.3g} m in all, the integral of slip_rate_m_per_s over time_s by "
        f"{by_rate:.3g} m"
    )
    if more > SLIP_IN_UNITS:
        raise CaseError(f"history: {told}; give m, m/s and s")
    return (
        [f"{told}: one of them may be that of one side, or times too far apart"] if more > SLIP_AGREES else []
    )


def notes_on(interval_s: float, found: Mapping[str, np.ndarray]) -> list[str]:
    """What speaks against the numbers of breakdowns that came to their end."""
    weakens_s = float(np.median(found["weakening_time_s"]))
    samples = weakens_s / interval_s
    sampling = (
        f"friction weakens within {weakens_s:.3g} s, samples of the history are {interval_s:.3g} s apart"
    )
    if samples < FEWEST_SAMPLES:
        raise CaseError(f"history: {sampling}: the breakdown falls between them; give finer ones")
    notes = [f"{sampling}: Gamma is rough"] if samples < FEW_SAMPLES else []
    by_slip = found["G_slip_J_per_m2"] / found["breakdown_work_J_per_m2"]
    if np.isfinite(by_slip).any() and not 1 / G_AGREES < np.nanmedian(by_slip) < G_AGREES:
        notes.append(
            f"G by slip is {np.nanmedian(by_slip):.2g} times the breakdown work: check units, bodies, that "
            "slip is that of both sides, and that t and p are no changes"
        )
    return notes + beyond({name: float(np.median(of)) for name, of in found.items() if name in RANGES})
