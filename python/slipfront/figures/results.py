# SPDX-License-Identifier: BSD-3-Clause
"""All that the figures are drawn from, read and checked before the first is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slipfront.figures.study import Study, read_studies
from slipfront.files import DataError, is_folder, is_number, number, read_json, read_json_table
from slipfront.folder import belongs, located, result_file
from slipfront.read import Front, Run, read_experiment, read_run

EVENTS = ("left", "spontaneous", "right")  # the three events of one initial state
HIGH_MU_K = "spontaneous_mu_k_1.0"
# Shorter fronts, mostly secondary ones late in a record, would hide the events' own in the plots of V_tip.
DRAWN_LENGTH_M = 10e-3
MAIN_LENGTH_M = 25e-3
NUCLEATION_M = 5e-3  # the speed diverges where a front nucleates
TAIL_M = 20e-3  # the last stretch before a front stops, where the paper sees it leave the energy criterion
STOPS = ("arrest", "contact_end")
# Columns of `slipfront reproduce --sensitivity`.
VARIATIONS = {"mesh_variation": "With the mesh, moves by", "step_variation": "With the step, moves by"}


@dataclass(frozen=True)
class Fit:
    """V_tip / c_L = a + b exp(-c sqrt(r)), r = (U_r - U_s) / U_s."""

    a: float
    b: float
    c: float

    def __call__(self, r: np.ndarray) -> np.ndarray:
        return self.a + self.b * np.exp(-self.c * np.sqrt(r))


@dataclass(frozen=True)
class Results:
    folder: Path
    runs: dict[str, Run]
    scorecard: list[dict]
    analysis: dict
    fit: Fit | None  # of this program's points; None where it found too few
    paper_fit: Fit
    paper_a_band: float
    studies: list[Study]
    timings: list[tuple[str, float]]  # part of the work, wall time in s; empty where none are told
    experiment: tuple[np.ndarray, np.ndarray] | None  # measured t_s / p_s, V_tip / c_L

    @property
    def events(self) -> list[Run]:
        return [self.runs[name] for name in EVENTS]

    @property
    def mark(self) -> str:
        """For titles: the runs that did not come to their end, a line each; empty where all did."""
        return "\n".join(f"{name}: {run.mark}" for name, run in self.runs.items() if run.mark)

    @property
    def remarks(self) -> list[str]:
        """Lines to print beside the figures."""
        return [line for run in self.runs.values() for line in run.remarks]


def drawn_fronts(run: Run) -> list[Front]:
    """The fronts long enough to be drawn, in the order of their start."""
    return sorted((f for f in run.fronts if f.length_m >= DRAWN_LENGTH_M), key=lambda f: f.onset_s[0])


def main_fronts(run: Run) -> list[Front]:
    """The longest front in each direction, where it is at least MAIN_LENGTH_M long."""
    longest = [
        max((f for f in run.fronts if f.direction == way), key=lambda f: f.length_m, default=None)
        for way in (-1, 1)
    ]
    return [f for f in longest if f is not None and f.length_m >= MAIN_LENGTH_M]


def away_from_trigger(run: Run, x_m: np.ndarray) -> np.ndarray:
    """Whether points lie outside the trigger zone or patch and its margin; everywhere in other events."""
    if run.kind == "nucleation":
        reach_m = run.parameter("nucleation.half_length_m") + run.parameter("nucleation.taper_m")
        distance_m = np.abs(x_m - run.parameter("nucleation.x_m"))
        return distance_m > reach_m + run.parameter("fronts.trigger_margin_m")
    if run.kind not in ("left", "right"):
        return np.full(np.shape(x_m), True)
    # The zone begins at the end of the contact, an edge margin outside of what counts as inside.
    edge_m = 0.0 if run.prescribed else run.parameter("loading.edge_margin_m")
    omitted_m = run.parameter("event.trigger_zone_m") + run.parameter("fronts.trigger_margin_m")
    if run.kind == "left":
        return x_m >= run.fact("statics.inside_from_m") - edge_m + omitted_m
    return x_m <= run.fact("statics.inside_to_m") + edge_m - omitted_m


def at_nucleation(run: Run, front: Front) -> np.ndarray:
    """Whether a front's points are near to where it nucleated by itself. [points]"""
    if run.kind in ("left", "right"):
        return np.full(len(front.x_m), False)
    return np.abs(front.x_m - front.x_m[0]) < NUCLEATION_M


def in_tail(run: Run, front: Front) -> np.ndarray:
    """Whether a front's points are within TAIL_M of where it arrests or runs out of contact. [points]"""
    if run.end_of(front) not in STOPS:
        return np.full(len(front.x_m), False)
    return np.abs(front.x_m - front.x_m[-1]) <= TAIL_M


def start(run: Run) -> tuple[float, float] | None:
    """Where (m) and when (s) the first drawn front starts; None in a run without one."""
    fronts = drawn_fronts(run)
    return (float(fronts[0].x_m[0]), float(fronts[0].onset_s[0])) if fronts else None


def read_fit(file: Path, table: dict, part: str) -> Fit:
    def value(key: str) -> float:
        group = table.get(part)
        entry = group.get(key) if isinstance(group, dict) else None
        return number(file, table, f"{part}.{key}.value" if isinstance(entry, dict) else f"{part}.{key}")

    return Fit(value("a"), value("b"), value("c"))


def read_scorecard(file: Path) -> list[dict]:
    rows = read_json(result_file(file))
    if not isinstance(rows, list):
        raise DataError(f"{file}: not a list")
    for i, row in enumerate(rows):
        for key in ("id", "claim", "paper", "measured", "holds", "how"):
            if not isinstance(row, dict) or key not in row:
                raise DataError(f"{file}: entry {i + 1} has no '{key}'")
        if not isinstance(row["id"], str) or row["holds"] not in (True, False, None):
            raise DataError(f"{file}: entry {i + 1}: 'id' is not a text, or 'holds' not true, false or null")
        if not isinstance(row.get("counts", True), bool):
            raise DataError(f"{file}: entry {i + 1}: 'counts' is not true or false")
        for key in ("second_test_of", "why"):
            if not isinstance(row.get(key, ""), str):
                raise DataError(f"{file}: entry {i + 1}: '{key}' is not a text")
        for key in VARIATIONS:
            if key in row and not is_variation(row[key]):
                raise DataError(f"{file}: entry {i + 1}: '{key}' is not as expected")
    return rows


def is_variation(entry) -> bool:
    return isinstance(entry, dict) and "parameter" in entry and is_number(entry.get("value"))


def read_timings(file: Path) -> list[tuple[str, float]]:
    if not belongs(file):  # written last: a folder may lack it
        return []
    rows = read_json(result_file(file))
    if not isinstance(rows, list) or not all(isinstance(row, dict) and "part" in row for row in rows):
        raise DataError(f"{file}: not a list of parts")
    return [(str(row["part"]), number(file, row, "wall_s")) for row in rows]


def read_results(folder: Path, experiment: Path | None = None) -> Results:
    if not is_folder(folder):
        raise DataError(f"{folder}: no such folder; DIR is the output folder of `slipfront reproduce`")
    runs = {name: read_run(located(folder / name)) for name in (*EVENTS, HIGH_MU_K)}
    file = folder / "analysis.json"
    analysis = read_json_table(result_file(file))
    if not isinstance(analysis.get("fit", 0), dict | None):
        raise DataError(f"{file}: no entry 'fit'")
    points = read_experiment(experiment, runs[HIGH_MU_K].c_L_m_per_s) if experiment else None
    return Results(
        folder=folder,
        runs=runs,
        scorecard=read_scorecard(folder / "scorecard.json"),
        analysis=analysis,
        fit=read_fit(file, analysis, "fit") if analysis["fit"] is not None else None,
        paper_fit=read_fit(file, analysis, "paper_fit"),
        paper_a_band=number(file, analysis, "paper_fit.a_band"),
        studies=read_studies(file, analysis),
        timings=read_timings(folder / "timings.json"),
        experiment=points,
    )
