# SPDX-License-Identifier: BSD-3-Clause
"""All that the figures are drawn from, read and checked before the first is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from slipfront.files import DataError, is_folder, is_number, number, read_json, read_json_table
from slipfront.folder import belongs, located, result_file
from slipfront.opened import OpenRun, open_run

from drawing.study import Study, read_studies

EVENTS = ("left", "spontaneous", "right")  # the three events of one initial state
FITTED_CLAIM = "C18"  # the energy criterion
HIGH_MU_K = "spontaneous_mu_k_1.0"
# Columns of `reproduce.py --sensitivity`.
VARIATIONS = {"mesh_variation": "With the mesh, moves by", "step_variation": "With the step, moves by"}


@dataclass(frozen=True)
class Fit:
    """V_tip / c_L = a + b exp(-c sqrt(r)), r = (U_r - U_s) / U_s."""

    a: float
    b: float
    c: float

    def __call__(self, r: np.ndarray) -> np.ndarray:
        return self.a + self.b * np.exp(-self.c * np.sqrt(r))


PAPER_FIT, PAPER_BAND = Fit(0.76, 1.80, 3.05), 0.07


@dataclass(frozen=True)
class MainFrontsFit:
    """The fit to the main fronts without their ends, of the scorecard's second test."""

    id: str
    fit: Fit
    measured: str  # the same with intervals, as the scorecard words it


def read_main_fronts_fit(row: dict[str, Any]) -> MainFrontsFit | None:
    """From a scorecard's row, where it has all three numbers."""
    figures = row.get("figures")
    entries = [entry for entry in figures if isinstance(entry, dict)] if isinstance(figures, list) else []
    values = {entry.get("name"): entry["value"] for entry in entries if is_number(entry.get("value"))}
    if not {"a", "b", "c"} <= values.keys():
        return None
    fit = Fit(values["a"], values["b"], values["c"])
    return MainFrontsFit(row["id"], fit, str(row["measured"]))


@dataclass(frozen=True)
class Results:
    folder: Path
    runs: dict[str, OpenRun]
    scorecard: list[dict[str, Any]]
    analysis: dict[str, Any]
    fit: Fit | None  # of this program's points; None where it found too few
    fit_interval: np.ndarray  # of the fitted curve: energy rise, low, high; empty where not told. [points, 3]
    paper_fit: Fit
    paper_a_band: float
    studies: list[Study]
    timings: list[tuple[str, float]]  # part of the work, wall time in s; empty where none are told

    @property
    def events(self) -> list[OpenRun]:
        return [self.runs[name] for name in EVENTS]

    def interval_of_fit(self, name: str) -> tuple[float, float] | None:
        """Of a, b or c of our own fit; None where it is not told."""
        entry = self.analysis["fit"].get(name)
        if not isinstance(entry, dict) or not is_number(entry.get("low")) or not is_number(entry.get("high")):
            return None
        return entry["low"], entry["high"]

    def claims(self, name: str) -> list[dict[str, Any]]:
        """The scorecard's rows of a claim: its first test and, where there is one, its second."""
        return [row for row in self.scorecard if name in (row["id"], row.get("second_test_of"))]

    @property
    def main_fronts_fit(self) -> MainFrontsFit | None:
        """The fit of the second test of the energy criterion; None where it was not done."""
        rows = [row for row in self.scorecard if row.get("second_test_of") == FITTED_CLAIM]
        return read_main_fronts_fit(rows[0]) if rows else None

    @property
    def mark(self) -> str:
        """For titles: the runs that did not come to their end, a line each; empty where all did."""
        return "\n".join(f"{name}: {run.mark}" for name, run in self.runs.items() if run.mark)

    @property
    def remarks(self) -> list[str]:
        """Lines to print beside the figures."""
        return [line for run in self.runs.values() for line in run.remarks]


def read_fit(file: Path, table: dict[str, Any], part: str) -> Fit:
    def value(key: str) -> float:
        group = table.get(part)
        entry = group.get(key) if isinstance(group, dict) else None
        return number(file, table, f"{part}.{key}.value" if isinstance(entry, dict) else f"{part}.{key}")

    return Fit(value("a"), value("b"), value("c"))


def read_fit_interval(file: Path, analysis: dict[str, Any]) -> np.ndarray:
    points = analysis.get("fit_curve", [])
    if not isinstance(points, list) or not all(isinstance(point, dict) for point in points):
        raise DataError(f"{file}: 'fit_curve' is not a list of points")
    rows = [[number(file, point, key) for key in ("x", "low", "high")] for point in points]
    return np.array(rows).reshape(-1, 3)


def read_scorecard(file: Path) -> list[dict[str, Any]]:
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


def is_variation(entry: Any) -> bool:
    return isinstance(entry, dict) and "parameter" in entry and is_number(entry.get("value"))


def read_timings(file: Path) -> list[tuple[str, float]]:
    if not belongs(file):  # written last: a folder may lack it
        return []
    rows = read_json(result_file(file))
    if not isinstance(rows, list) or not all(isinstance(row, dict) and "part" in row for row in rows):
        raise DataError(f"{file}: not a list of parts")
    return [(str(row["part"]), number(file, row, "wall_s")) for row in rows]


def read_results(folder: Path) -> Results:
    """A folder of `reproduce.py`."""
    if not is_folder(folder):
        raise DataError(f"{folder}: no such folder; DIR is of `reproduce.py`, `study` or `run`")
    runs = {name: open_run(located(folder / name)).checked() for name in (*EVENTS, HIGH_MU_K)}
    file = folder / "analysis.json"
    analysis = read_json_table(result_file(file))
    if not isinstance(analysis.get("fit", 0), dict | None):
        raise DataError(f"{file}: no entry 'fit'")
    return Results(
        folder=folder,
        runs=runs,
        scorecard=read_scorecard(folder / "scorecard.json"),
        analysis=analysis,
        fit=read_fit(file, analysis, "fit") if analysis["fit"] is not None else None,
        fit_interval=read_fit_interval(file, analysis),
        paper_fit=read_fit(file, analysis, "paper_fit"),
        paper_a_band=number(file, analysis, "paper_fit.a_band"),
        studies=read_studies(file, analysis),
        timings=read_timings(folder / "timings.json"),
    )
