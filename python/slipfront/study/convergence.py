# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront study convergence CASE -o DIR`: front speeds over element size, interface step and damping, with
their limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from slipfront.files import DataError
from slipfront.read import median
from slipfront.study.runs import Printed, Study, make_parser, number, numbers, printed
from slipfront.study.runs import main as study_main
from slipfront.study.speeds import Limit, Place, Run, Summary, extrapolate, summarise
from slipfront.sweep.engine import default_workers
from slipfront.sweep.points import Value

NAME = "convergence"
SIZE, FACTOR, SUBSTEPS = "plate.element_size_m", "time.step_factor", "time.interface_substeps"
DAMPING = "material.stiffness_damping_s"
HEADER = "x_m,direction,parameter,value,v_tip_m_per_s,extrapolated_m_per_s,error_m_per_s,order"
FRONTS = {0: "both", -1: "to -x", 1: "to +x"}


@dataclass(frozen=True)
class Plan:
    """The case with one numerical parameter changed."""

    key: str
    values: Sequence[float]  # in the order of falling step size; a limit itself comes last
    own: int  # index of the case's own

    @property
    def step_sizes(self) -> np.ndarray:
        """q of extrapolate: falls towards the limit; 0 at the limit itself. [values]"""
        return np.array([1 / value if self.key == SUBSTEPS else value for value in self.values])

    @property
    def last(self) -> slice:
        """The last three with a step size above 0."""
        n = int((self.step_sizes > 0).sum())
        return slice(n - 3, n)


@dataclass(frozen=True)
class Comparison:
    """Speeds at the stations where the case itself has one."""

    plan: Plan
    places: list[Place]
    v_m_per_s: np.ndarray  # [stations, values]; NaN where the front does not pass or has no speed there

    @cached_property
    def limits(self) -> list[Limit]:
        q = self.plan.step_sizes[self.plan.last].tolist()
        return [extrapolate(q, v[self.plan.last].tolist()) for v in self.v_m_per_s]

    @cached_property
    def errors_m_per_s(self) -> np.ndarray:
        """[stations, values]"""
        pairs = zip(self.limits, self.v_m_per_s, strict=True)
        return np.array([[limit.error(value) for value in v] for limit, v in pairs]).reshape(
            self.v_m_per_s.shape
        )

    def summary(self, direction: int, tolerance: float) -> Summary:
        """Of the fronts in a direction; 0: of all."""
        here = np.array([direction in (0, place.direction) for place in self.places], dtype=bool)
        v, own, q = self.v_m_per_s[here], self.plan.own, self.plan.step_sizes[self.plan.last]
        differences = np.abs(np.diff(v[:, self.plan.last])) / v[:, [own]] / np.log(q[:-1] / q[1:])
        orders = np.array([limit.order for limit in self.limits])[here]
        return summarise(self.errors_m_per_s[here, own] / v[:, own], orders, differences, tolerance)

    @property
    def difference_at_limit(self) -> float:
        """Median |extrapolated - computed at q = 0| over the case's own speed."""
        if self.plan.step_sizes[-1] > 0:
            return math.nan
        extrapolated = np.array([limit.value for limit in self.limits])
        return median(np.abs(self.v_m_per_s[:, -1] - extrapolated) / self.v_m_per_s[:, self.plan.own])


def same(a: float, b: float) -> bool:
    return abs(a - b) <= 1e-9 * abs(b)


def element_plan(h_m: float, sizes_m: Sequence[float]) -> Plan:
    """The case's own size is so to the last digit."""
    sizes: list[float] = []
    for size in sorted(sizes_m or [2 * h_m, h_m, h_m / 2], reverse=True):
        if not any(same(size, known) for known in sizes):
            sizes.append(h_m if same(size, h_m) else size)
    if len(sizes) < 3:
        raise DataError("--element-sizes: give at least three different sizes in m")
    if h_m not in sizes:
        raise DataError(f"--element-sizes: the case's own {SIZE} = {h_m:.8g} must be among them")
    return Plan(SIZE, sizes, sizes.index(h_m))


def plans_of(case: dict[str, Any], sizes_m: Sequence[float]) -> list[Plan]:
    plans = [element_plan(case[SIZE], sizes_m)]
    n, beta_s = case[SUBSTEPS], case[DAMPING]
    if n == 1:
        plans.append(Plan(FACTOR, [share * case[FACTOR] for share in (1.0, 0.5, 0.25)], 0))
    else:
        plans.append(Plan(SUBSTEPS, [n // 2, n, 2 * n, 4 * n], 1))
    if beta_s > 0:
        plans.append(Plan(DAMPING, [share * beta_s for share in (2.0, 1.0, 0.5, 0.0)], 1))
    return plans


def points_of(plans: list[Plan]) -> list[list[dict[str, Value]]]:
    """Settings of the runs of each plan, all of which set the same keys. [plans][values]"""
    own: dict[str, Value] = {plan.key: plan.values[plan.own] for plan in plans}
    return [[own | {plan.key: value} for value in plan.values] for plan in plans]


def compare(plan: Plan, runs: list[Run], spacing_m: float) -> Comparison:
    """runs: [values]"""
    found = runs[plan.own].stations(spacing_m)
    v = [[run.speed_m_per_s(place) for run in runs] for place in found]
    return Comparison(plan, found, np.array(v).reshape(len(found), len(runs)))


def csv(comparisons: list[Comparison]) -> str:
    """A row per sequence, station and value; what is undefined is empty."""
    lines = [HEADER]
    for c in comparisons:
        for place, limit, v, errors in zip(c.places, c.limits, c.v_m_per_s, c.errors_m_per_s, strict=True):
            for value, speed, error in zip(c.plan.values, v, errors, strict=True):
                cells = (place.x_m, value, speed, limit.value, error, limit.order)
                x, *others = (f"{cell:.10g}" if math.isfinite(cell) else "" for cell in cells)
                lines.append(",".join([x, str(place.direction), c.plan.key, *others]))
    return "\n".join(lines) + "\n"


def entry(summary: Summary) -> dict[str, Any]:
    return {name: number(value) for name, value in asdict(summary).items()}


def entry_of(c: Comparison, tolerance: float) -> dict[str, Any]:
    return {
        "parameter": c.plan.key,
        "values": c.plan.values,
        "case_value": c.plan.values[c.plan.own],
        "extrapolated_from": c.plan.values[c.plan.last],
        **entry(c.summary(0, tolerance)),
        "relative_difference_at_limit": number(c.difference_at_limit),
        "direction_-1": entry(c.summary(-1, tolerance)),
        "direction_+1": entry(c.summary(1, tolerance)),
    }


def table(comparisons: list[Comparison], tolerance: float) -> list[str]:
    form = "{:<30}{:<7}{:>9}  {:>7}  {:>7}  {:>7}  {:>8}  {}"
    heads = ("parameter", "fronts", "error", "of 90 %", "order", "growth", "stations", "verdict")
    lines = [form.format(*heads)]
    for c in comparisons:
        for direction, fronts in FRONTS.items():
            s, key = c.summary(direction, tolerance), "" if direction else c.plan.key
            errors = printed(s.median_relative_error, " %", 100), printed(s.p90_relative_error, " %", 100)
            seen = *errors, printed(s.median_order), printed(s.growth)
            lines.append(form.format(key, fronts, *seen, f"{s.n_stations}/{s.n_stations_of_case}", s.verdict))
        values = " ".join(f"{value:.4g}" for value in c.plan.values)
        at_limit = printed(c.difference_at_limit, " % from the extrapolated", 100)
        lines.append(f"  values {values}; the case's {c.plan.values[c.plan.own]:.4g}")
        lines[-1] += "" if at_limit == "-" else f"; computed at 0: {at_limit}"
    return lines


def work(study: Study) -> Printed:
    options = study.options
    plans = plans_of(study.case, options.element_sizes)
    l_star_m = max(study.case["fronts.l_star_m"], plans[0].values[0])
    points = points_of(plans)
    line = "--element-sizes" if options.element_sizes else "give --element-sizes that fit"
    # The finest mesh takes longest: first.
    unique = {tuple(point.values()): point for of_plan in points for point in reversed(of_plan)}
    runs = study.run(list(unique.values()), {"fronts.l_star_m": l_star_m}, {SIZE: line})
    by_point = dict(zip(unique, runs, strict=True))
    comparisons, warnings = [], []
    for plan, of_plan in zip(plans, points, strict=True):
        own = [by_point[tuple(point.values())] for point in of_plan]
        comparisons.append(compare(plan, own, options.station_spacing))
        pairs = zip(plan.values, own, strict=True)
        warnings += [f"{plan.key} = {value:g}: {run.blow_up}" for value, run in pairs if run.blow_up]
    if not any(comparison.places for comparison in comparisons):
        far = "no front of the case's own run goes far enough beyond its beginning to be measured"
        warnings.append(f"{far}: nothing is compared")
    found = {
        "l_star_m": l_star_m,
        "c_L_m_per_s": runs[0].info["wave_speeds"]["c_L_m_per_s"],
        "sequences": [entry_of(comparison, options.tolerance) for comparison in comparisons],
    }
    told_all = study.summary(runs, warnings, found)
    study.publish({"convergence.csv": csv(comparisons), "convergence.json": told_all})
    where = f"V_tip over {l_star_m:.4g} m at stations every {options.station_spacing:.4g} m"
    first = f"{where}; tolerance {100 * options.tolerance:g} %"
    return first, table(comparisons, options.tolerance), warnings, runs


def main(arguments: list[str]) -> int:
    what = "Front speeds of a case over element size, interface step and damping, and their limits."
    converged = "median relative error that counts as converged"
    parser = make_parser(NAME, what, 0.02, converged, default_workers())
    sizes = "element sizes in m, the case's among them; by default it times 2, 1, 1/2"
    parser.add_argument("--element-sizes", metavar="H,H,H", type=numbers(float), default=[], help=sizes)
    return study_main(parser, arguments, work)
