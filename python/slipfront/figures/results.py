# SPDX-License-Identifier: BSD-3-Clause
"""All that the figures are drawn from, read and checked before the first is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slipfront.read import DataError, Front, Run, number, read_experiment, read_json, read_run

EVENTS = ("left", "spontaneous", "right")  # the three events of one initial state
HIGH_MU_K = "spontaneous_mu_k_1.0"
# Shorter fronts, mostly secondary ones late in a record, would hide the events' own in the plots of V_tip.
DRAWN_LENGTH_M = 10e-3


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
    experiment: tuple[np.ndarray, np.ndarray] | None  # measured t_s / p_s, V_tip / c_L

    @property
    def events(self) -> list[Run]:
        return [self.runs[name] for name in EVENTS]


def drawn_fronts(run: Run) -> list[Front]:
    """The fronts long enough to be drawn, in the order of their start."""
    return sorted((f for f in run.fronts if f.length_m >= DRAWN_LENGTH_M), key=lambda f: f.onset_s[0])


def start(run: Run) -> tuple[float, float] | None:
    """Where (m) and when (s) the first drawn front starts; None in a run without one."""
    fronts = drawn_fronts(run)
    return (float(fronts[0].x_m[0]), float(fronts[0].onset_s[0])) if fronts else None


def read_fit(file: Path, table: dict, part: str) -> Fit:
    def value(key: str) -> float:
        entry = table.get(part, {}).get(key)
        return number(file, table, f"{part}.{key}.value" if isinstance(entry, dict) else f"{part}.{key}")

    return Fit(value("a"), value("b"), value("c"))


def read_scorecard(file: Path) -> list[dict]:
    rows = read_json(file)
    if not isinstance(rows, list):
        raise DataError(f"{file}: not a list")
    for i, row in enumerate(rows):
        for key in ("id", "claim", "paper", "measured", "holds", "how"):
            if not isinstance(row, dict) or key not in row:
                raise DataError(f"{file}: entry {i + 1} has no '{key}'")
    return rows


def read_results(folder: Path, experiment: Path | None = None) -> Results:
    if not folder.is_dir():
        raise DataError(f"{folder}: no such folder; DIR is the output folder of `slipfront reproduce`")
    runs = {name: read_run(folder / name) for name in (*EVENTS, HIGH_MU_K)}
    file = folder / "analysis.json"
    analysis = read_json(file)
    if not isinstance(analysis, dict) or "fit" not in analysis:
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
        experiment=points,
    )
