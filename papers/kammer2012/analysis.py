# SPDX-License-Identifier: BSD-3-Clause
"""scorecard.json and analysis.json, see docs/files.md."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from events import (
    NEAR_NUCLEATION_M,
    PAPER_A,
    PAPER_B,
    PAPER_BAND,
    PAPER_C,
    Collapse,
    Event,
    Front,
    collapse,
    speed_change,
)
from scorecard import Claim, Reproduction, StudyEvents, describe

SHORT_NAMES = {"static_ratio": "t_s_over_p_s", "dynamic_ratio": "t_d_over_p_d", "energy_rise": "energy"}


def number(value: float) -> float | None:
    """As files show a number that may be undefined."""
    return float(value) if math.isfinite(value) else None


def estimate(e: Any) -> dict[str, float | None]:
    """With its interval."""
    return {"value": number(e.value), "low": number(e.low), "high": number(e.high)}


def cell(value: float) -> str:
    """Of a CSV table: empty where undefined."""
    return f"{value:.6g}" if math.isfinite(value) else ""


def write_json(file: Path, value: Any) -> None:
    file.write_text(json.dumps(value, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def figures_json(claim: Claim) -> list[dict[str, Any]]:
    return [{"name": name, "value": number(value), "unit": unit} for name, value, unit in claim.figures]


def claim_json(c: Claim) -> dict[str, Any]:
    row: dict[str, Any] = {
        name: getattr(c, name) for name in ("id", "claim", "paper", "measured", "holds", "how", "counts")
    }
    if c.used_to_choose:
        row["used_to_choose"] = True
    if c.second_test_of:
        row |= {"second_test_of": c.second_test_of, "why": c.why}
    row["figures"] = figures_json(c)
    for v in c.variations:
        row[f"{v.variation.name}_variation"] = {
            "parameter": v.variation.key,
            "value": float(v.variation.value),
            "measured": v.measured,
            "holds": v.holds,
            "differences": [number(d) for d in v.differences],
            "moves": describe(c, v),
        }
    return row


def write_scorecard(file: Path, claims: Iterable[Claim]) -> None:
    """A list of id, claim, paper, measured, holds (true, false, or null where not tested), how, counts
    (whether the verdict is the claim's), figures; of second tests also second_test_of and why."""
    write_json(file, [claim_json(claim) for claim in claims])


def fit_json(c: Collapse) -> dict[str, Any] | None:
    if c.fit is None:
        return None
    return {name: estimate(getattr(c.fit, name)) for name in "abc"} | {"rms_over_c_L": number(c.fit.rms)}


def collapse_json(c: Collapse) -> dict[str, Any]:
    """How well the criteria order the speeds."""

    def spread(spreads: dict[str, Any], value: Callable[[Any], float]) -> dict[str, float | None]:
        return {short: number(value(spreads[name])) for name, short in SHORT_NAMES.items()}

    fit = fit_json(c)
    return {
        "fit": None if fit is None else fit | {"n_points": c.fit.n_points},
        "share_in_paper_band": number(c.share_in_band),
        "n_points": c.n_points,
        "spread": spread(c.cases, lambda s: s.median_relative),
        "spread_of_fronts": spread(c.fronts, lambda s: s.median_relative),
        "spread_rms": spread(c.cases, lambda s: s.rms_relative),
    }


def front_json(event: Event, front: Front) -> dict[str, Any]:
    p = event.with_speed(front, NEAR_NUCLEATION_M)
    v = p.v_m_per_s / event.c_L
    at = int(v.argmax()) if v.size else 0
    return {
        "direction": front.direction,
        "start_x_m": float(front.x_m[0]),
        "end_x_m": float(front.x_m[-1]),
        "end": front.end,
        "mode": front.mode,
        "mean_v_over_c_L": number(v.mean()) if v.size else None,
        "max_v_over_c_L": number(v[at]) if v.size else None,
        "x_of_max_m": number(p.x_m[at]) if v.size else None,
    }


def event_json(event: Event, reference: Event | None) -> dict[str, Any]:
    found: dict[str, Any] = {
        "event": event.name,
        "critical_shear_m": event.critical_shear_m,
        "peak_x_m": event.peak_x_m,
        "fronts": [front_json(event, front) for front in event.fronts],
    }
    if math.isfinite(event.ramp_critical_shear_m):
        found["ramp_critical_shear_m"] = event.ramp_critical_shear_m
        found["ramp_onsets_at_edges"] = event.ramp_onsets
    if reference is not None:
        change = speed_change(event, reference)
        found["speed_change"] = {k: v if k == "n_points" else number(v) for k, v in change.items()}
    return found


def reference_of(event: Event, study: StudyEvents, runs: Reproduction) -> Event | None:
    """The run of the same event that a study's changes are counted from."""
    if study.study.own_reference:
        return next((first for first in study.points[0] if first.kind == event.kind), None)
    return {"left": runs.left, "right": runs.right}.get(event.kind, runs.spontaneous)


def study_json(study: StudyEvents, runs: Reproduction) -> dict[str, Any]:
    points = [
        {
            "value": point.value,
            "number": number(point.number),
            "events": [event_json(event, reference_of(event, study, runs)) for event in events],
        }
        | collapse_json(collapse(events))
        for point, events in zip(study.study.points, study.points, strict=True)
    ]
    about = study.study
    return {"name": about.name, "parameter": about.key, "why": about.why, "points": points}


def write_analysis(file: Path, runs: Reproduction) -> None:
    """The fit of V_tip/c_L against the energy rise with its intervals, the paper's fit, the spreads against
    the three criteria, and for every study point the speeds, kinds of slip, changes against the paper's runs,
    fit and spreads."""
    fit = runs.collapse.fit
    curve = [] if fit is None else np.transpose(fit.curve()).tolist()
    found = collapse_json(runs.collapse)
    found["fit_curve"] = [
        {"x": x, "value": number(y), "low": number(low), "high": number(high)} for x, y, low, high in curve
    ]
    found["paper_fit"] = {"a": PAPER_A, "a_band": PAPER_BAND, "b": PAPER_B, "c": PAPER_C}
    with np.errstate(invalid="ignore", divide="ignore"):
        found["studies"] = [study_json(study, runs) for study in runs.studies.values()]
    write_json(file, found)
