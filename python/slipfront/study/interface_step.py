# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront study interface-step CASE -o DIR`: error of the front speeds against the cost of sub-cycling the
interface.

The reference is the whole plate with the case's step over 16, 32 and 64, extrapolated to 0 at each station.
Compared with it are the plain scheme with the step over 1, 2, 4, 8, and all pairs of rows and sub-steps that
fit into the plate."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from slipfront.read import median
from slipfront.study.runs import Printed, Study, make_parser, number, numbers, printed
from slipfront.study.runs import main as study_main
from slipfront.study.speeds import FEWEST_STATIONS, UNDEFINED, Place, Run, extrapolate, p90
from slipfront.sweep.points import Value

NAME = "interface-step"
FACTOR, ROWS, SUBSTEPS = "time.step_factor", "time.interface_rows", "time.interface_substeps"
REFERENCE, PLAIN = (16, 32, 64), (1, 2, 4, 8)  # divisors of the step factor
#: Columns of the table with their formats.
COLUMNS = {"kind": "", "step_factor": ".10g", "interface_rows": "", "interface_substeps": "",
           "cost_over_plain": ".6g", "time_s": ".4g", "median_error": ".6g", "p90_error": ".6g",
           "n_stations": ""}  # fmt: skip
CHOSEN = ("step_factor", "interface_rows", "interface_substeps", "cost_over_plain", "p90_error")


@dataclass(frozen=True)
class Stepping:
    """A way of stepping, its cost, and how far its speeds are from the limit of small steps."""

    #: plain: the whole plate with one step; layer: rows of cells at the interface sub-cycled; extrapolated:
    #: 2 V(2 n) - V(n) of two layers' runs, linear in the sub-step.
    kind: str
    step_factor: float
    interface_rows: int = 0
    interface_substeps: int = 1
    cost_over_plain: float = 0  # node updates over those of the case's step factor with one step
    time_s: float = 0  # of the steps, on this machine
    median_error: float = UNDEFINED
    p90_error: float = UNDEFINED  # at least nine tenths of the stations are within it
    n_stations: int = 0  # where both have a speed
    v_m_per_s: np.ndarray = field(default_factory=lambda: np.empty(0))  # [stations]

    @property
    def settings(self) -> dict[str, Value]:
        rows = max(self.interface_rows, 1)
        return {FACTOR: self.step_factor, ROWS: rows, SUBSTEPS: self.interface_substeps}

    @property
    def words(self) -> str:
        n, rows = self.interface_substeps, f"{self.interface_rows} rows"
        if self.kind == "plain":
            return f"plain, step_factor {self.step_factor:.4g}"
        return f"{rows}, {n} sub-steps" if self.kind == "layer" else f"{rows}, {n // 2} and {n}, extrapolated"

    def against(self, limit_m_per_s: np.ndarray) -> Stepping:
        """With its errors."""
        errors = np.abs(self.v_m_per_s / limit_m_per_s - 1)
        n = int(np.isfinite(errors).sum())
        return replace(self, median_error=median(errors), p90_error=p90(errors), n_stations=n)


def updates_per_s(run: Run) -> float:
    """Node updates per simulated time: runs end at different times."""
    i = run.info
    return float(i["node_updates_per_s"] * i["wall_s"] / i["steps"] / i["dt_s"])


def limits(reference: list[Run], spacing_m: float) -> tuple[dict[Place, float], float]:
    """Speeds at the limit of small steps, where one is seen, and the median order of the approach to it."""
    q = [1 / divisor for divisor in REFERENCE]
    found = {
        place: extrapolate(q, [run.speed_m_per_s(place) for run in reference])
        for place in reference[-1].stations(spacing_m)
    }
    known = {place: limit for place, limit in found.items() if math.isfinite(limit.value)}
    order = median(np.array([limit.order for limit in known.values()]))
    return {place: limit.value for place, limit in known.items()}, order


def extrapolated(ways: list[Stepping]) -> list[Stepping]:
    """Of each two layers of which one has twice the sub-steps."""
    return [
        replace(
            fine,
            kind="extrapolated",
            cost_over_plain=coarse.cost_over_plain + fine.cost_over_plain,
            time_s=coarse.time_s + fine.time_s,
            v_m_per_s=2 * fine.v_m_per_s - coarse.v_m_per_s,
        )
        for coarse in ways
        for fine in ways
        if coarse.kind == "layer"
        and (fine.interface_rows, fine.interface_substeps)
        == (coarse.interface_rows, 2 * coarse.interface_substeps)
    ]


def cheapest(ways: list[Stepping], n_stations: int, tolerance: float) -> Stepping | None:
    """Within the tolerance at nine tenths of the stations or more, without extrapolation."""
    within = [
        way
        for way in ways
        if way.kind != "extrapolated" and way.p90_error <= tolerance and 10 * way.n_stations >= 9 * n_stations
    ]
    return min(within, key=lambda way: way.cost_over_plain, default=None)


def csv(ways: list[Stepping]) -> str:
    rows = [",".join(format(getattr(way, name), form) for name, form in COLUMNS.items()) for way in ways]
    return "\n".join([",".join(COLUMNS), *rows]) + "\n"


def table(ways: list[Stepping]) -> list[str]:
    form = "{:<34}{:>8}{:>10}{:>12}{:>12}"
    lines = [form.format("stepping", "cost", "time", "median", "90 % within")]
    for way in ways:
        errors = printed(way.median_error, " %", 100), printed(way.p90_error, " %", 100)
        lines.append(form.format(way.words, f"{way.cost_over_plain:.2f}", printed(way.time_s, " s"), *errors))
    return [*lines, "", "cost: node updates over those of the plain scheme at the case's step_factor"]


def work(study: Study) -> Printed:
    options = study.options
    factor = study.case[FACTOR]
    height_rows = study.case["plate.height_m"] / study.case["plate.element_size_m"]
    # The smallest step takes longest: first.
    reference = [Stepping("plain", factor / divisor) for divisor in reversed(REFERENCE)]
    tried = [Stepping("plain", factor / divisor) for divisor in PLAIN]
    tried += [
        Stepping("layer", factor, n, m) for n in options.rows if n < height_rows for m in options.substeps
    ]
    points = [way.settings for way in (*reference, *tried)]
    runs = study.run(points, {}, {ROWS: "--rows", SUBSTEPS: "--substeps"})
    of_reference, of_tried = runs[: len(reference)], runs[len(reference) :]
    limit, order = limits(of_reference[::-1], options.station_spacing)
    ways = [
        replace(
            way,
            cost_over_plain=updates_per_s(run) / updates_per_s(of_tried[0]),
            time_s=run.info["wall_s"],
            v_m_per_s=np.array([run.speed_m_per_s(place) for place in limit]),
        )
        for way, run in zip(tried, of_tried, strict=True)
    ]
    ways = [way.against(np.array(list(limit.values()))) for way in (*ways, *extrapolated(ways))]
    chosen = cheapest(ways, len(limit), options.tolerance)
    warnings = [
        f"step_factor {point[FACTOR]:.3g}, {point[ROWS]} rows, {point[SUBSTEPS]} sub-steps: {run.blow_up}"
        for point, run in zip(points, runs, strict=True)
        if run.blow_up
    ]
    if len(limit) < FEWEST_STATIONS:
        warnings.insert(0, f"only {len(limit)} stations have a speed with a limit at small steps")
    found = {
        "n_stations": len(limit),
        "median_order_of_reference": number(order),
        "chosen": None if chosen is None else {name: getattr(chosen, name) for name in CHOSEN},
    }
    texts = {"interface_step.csv": csv(ways), "interface_step.json": study.summary(runs, warnings, found)}
    within = f"within {100 * options.tolerance:g} %"
    verdict = f"none is {within}"
    if chosen is not None:
        texts["chosen.toml"] = study.resolved(chosen.settings)
        values = ", ".join(f"{key} = {value:.4g}" for key, value in chosen.settings.items())
        verdict = f"cheapest {within}: {values}; the case with it: {study.folder}/chosen.toml"
    study.publish(texts)
    first = (
        f"V_tip at {len(limit)} stations against the limit of small steps (observed order {printed(order)})"
    )
    return first, [*table(ways), verdict], warnings, runs


def main(arguments: list[str]) -> int:
    what = "Error of the front speeds against the cost of sub-cycling the interface; the cheapest way."
    parser = make_parser(NAME, what, 0.01, "relative error of V_tip that nine of ten stations keep", 1)
    add, preset = parser.add_argument, "to try (default: %(default)s)"
    add("--rows", metavar="N,N", type=numbers(int), default="1,2,4,8", help=f"rows of cells {preset}")
    add("--substeps", metavar="N,N", type=numbers(int), default="2,4,9,18,36", help=f"sub-steps {preset}")
    return study_main(parser, arguments, work)
