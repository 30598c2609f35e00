# SPDX-License-Identifier: BSD-3-Clause
"""Writes made-up output folders of the studies and of `slipfront-verify`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from synthetic import write_csv

C_L = 1500.0
X_LEFT_M, X_RIGHT_M = 2e-3 * np.arange(10, 60), 2e-3 * np.arange(75, 95)
SIZES, OWN = [2e-3, 1e-3, 0.5e-3], 1
HEADER = [
    "x_m", "direction", "parameter", "value", "v_tip_m_per_s", "extrapolated_m_per_s", "error_m_per_s",
    "order",
]  # fmt: skip
SUMMARY = ("verdict", "median_relative_error", "median_order", "growth", "n_stations", "n_stations_of_case")
WITHOUT = dict(zip(SUMMARY, ("too few stations", None, None, None, 0, 0), strict=True))


def limit_left(x_m: float) -> float:
    return 1000 + 4000 * x_m


def rows_of_sizes() -> list[list]:
    """To -x, V = V_0 + 1e5 h: first order. To +x, V rises by 200 with each halving: no limit."""
    rows = []
    for x in X_LEFT_M:
        for h in SIZES:
            v_0 = limit_left(x)
            rows.append([x, -1, "plate.element_size_m", h, v_0 + 1e5 * h, v_0, 1e5 * h, 1])
    for x in X_RIGHT_M:
        for h, v, error in zip(SIZES, (1000, 1200, 1400), (400, 200, 400), strict=True):
            rows.append([x, 1, "plate.element_size_m", h, v, "", error, ""])
    return rows


def rows_of_substeps() -> list[list]:
    """Both directions: V = V_0 (1 + 0.1/n); nothing known at the first station."""
    rows = []
    for direction, stations in ((-1, X_LEFT_M), (1, X_RIGHT_M)):
        for x in stations:
            for n in (9, 18, 36, 72):
                if x == stations[0]:
                    v = 1000 if n == 18 else ""
                    rows.append([x, direction, "time.interface_substeps", n, v, "", "", ""])
                else:
                    rows.append(
                        [x, direction, "time.interface_substeps", n, 1000 * (1 + 0.1 / n), 1000, 100 / n, 1]
                    )
    return rows


def rows_of_damping() -> list[list]:
    rows = []
    for x in X_LEFT_M:
        for beta in (2e-7, 1e-7, 5e-8, 0):
            v = 1000 + 1e15 * beta**2
            rows.append([x, -1, "material.stiffness_damping_s", beta, v, 1000, v - 1000, 2])
    return rows


def summary(verdict: str, error: float, order: float | None, n: int) -> dict:
    return dict(zip(SUMMARY, (verdict, error, order, 0.5, n, n), strict=True))


def write_study(folder: Path) -> Path:
    """A convergence study whose speeds have known limits, and in one direction none."""
    folder.mkdir(exist_ok=True)
    write_csv(folder / "convergence.csv", HEADER, rows_of_sizes() + rows_of_substeps() + rows_of_damping())
    mesh = (summary("not converged", 0.08, 1, 50), summary("no limit", 0.1667, None, 20))
    step = (summary("converged", 0.0055, 1, 49), summary("converged", 0.0055, 1, 19))
    damping = (summary("converged", 0.0099, 2, 50), WITHOUT)
    sequences = [
        {
            "parameter": parameter,
            "values": values,
            "case_value": case_value,
            "extrapolated_from": values[:3],
            **left,
            "direction_-1": left,
            "direction_+1": right,
        }
        for parameter, values, case_value, (left, right) in (
            ("plate.element_size_m", SIZES, 1e-3, mesh),
            ("time.interface_substeps", [9, 18, 36, 72], 18, step),
            ("material.stiffness_damping_s", [2e-7, 1e-7, 5e-8, 0], 1e-7, damping),
        )
    ]
    result = {"version": "0", "title": "made up", "tolerance": 0.02, "station_spacing_m": 2e-3}
    result |= {"l_star_m": 2e-3, "c_L_m_per_s": C_L, "n_runs": 9, "sequences": sequences, "warnings": []}
    (folder / "convergence.json").write_text(json.dumps(result))
    return folder


def write_verification(folder: Path) -> Path:
    """A problem of `slipfront-verify` with a chart of two curves."""
    folder.mkdir()
    curves = [
        {"label": "closed form", "kind": "theory", "x": [1.0, 2.0, 4.0], "y": [1.0, 0.5, 0.25]},
        {"label": "program", "kind": "program", "x": [1.0, 2.0, 4.0], "y": [1.1, 0.51, 0.26]},
    ]
    chart = {"x_label": "$n$", "y_label": "error", "log_x": True, "log_y": True, "curves": curves}
    results = {"version": "0", "name": "column", "title": "Column", "holds": True, "checks": []}
    results["charts"] = [chart]
    (folder / "column.json").write_text(json.dumps(results))
    return folder


def write_interface_step(folder: Path, title: str = "made up") -> Path:
    """A study of the step at the interface."""
    folder.mkdir()
    header = ["kind", "interface_rows", "interface_substeps", "cost_over_plain", "median_error", "p90_error"]
    rows = [
        ["plain", 0, 1, 1, 0.07, 0.27],
        ["plain", 0, 1, 2, 0.02, 0.05],
        ["layer", 4, 9, 2.6, 0.001, 0.005],
    ]
    write_csv(folder / "interface_step.csv", header, rows)
    (folder / "interface_step.json").write_text(json.dumps({"title": title, "tolerance": 0.01}))
    return folder


def open_choice(name: str, levels: list, standard) -> dict:
    form = {"left_added": ["added"]}.get(name, [])
    decides = {"decided_by": "left_form" if form else "", "counts_with": form}
    return {
        "name": name,
        "key": f"event.{name}",
        "why": "open",
        "levels": levels,
        "standard": standard,
    } | decides


def write_open_choices(folder: Path) -> Path:
    """A study of the open choices: four of the left trigger are varied by themselves, the corner is not."""
    folder.mkdir()
    standard = {"left_form": "added", "left_zone_m": 0.01, "left_added": 5.0, "left_end": "held"}
    standard |= {"left_duration_s": 5e-6, "corner": "relief", "right_form": "weakened", "right_zone_m": 0.01}
    standard["element_size_m"] = 0.001
    levels = {
        "left_form": ["added", "weakened"],
        "left_zone_m": [0.01, 0.015],
        "left_added": [5.0, 10.0],
        "left_end": ["taken away", "held"],
        "left_duration_s": [2e-6, 5e-6],
        "corner": ["relief", "fillet 10 mm"],
        "element_size_m": [0.001, 0.002],
    }
    chosen = standard | {"left_added": 10.0, "left_end": "taken away"}
    samples = [
        # set, values, constraints, those but C25, largest left, spontaneous, right speed, share in the band
        ("standard", standard, "do not", "do not", 1.8, 2.0, 3.0, 0.66),
        ("known", standard | {"left_added": 20.0}, "do not", "hold", 1.2, 2.0, 3.0, 0.82),
        ("left trigger", chosen, "hold", "hold", 1.0, 2.0, 3.0, 0.75),
        ("left trigger", chosen | {"left_zone_m": 0.012346}, "do not", "hold", 1.1, 2.0, 3.0, 0.76),
        ("right trigger", chosen | {"right_zone_m": 0.02}, "hold", "hold", 0.9, 2.0, 3.0, 0.8),
        ("all", standard | {"corner": "fillet 10 mm"}, "do not", "do not", 3.2, 2.0, 3.0, 0.31),
        ("all", standard, "do not", "do not", 1.0, 2.0, 0, 0.35),
        ("about the chosen", chosen | {"left_form": "weakened"}, "do not", "do not", 0, 2.0, 3.0, 0.83),
        ("about the chosen", chosen | {"left_zone_m": 0.015}, "hold", "hold", 0.9, 2.0, 3.0, 0.8),
        ("about the chosen", chosen | {"left_added": 5.0}, "do not", "do not", 1.8, 2.0, 3.0, 0.66),
        ("about the chosen", chosen | {"left_end": "held"}, "do not", "hold", 1.0, 2.0, 3.0, 0.7),
        ("about the chosen", chosen | {"left_duration_s": 2e-6}, "hold", "hold", 1.0, 2.0, 3.0, 0.7),
        ("about the chosen", chosen | {"element_size_m": 0.002}, "do not", "do not", 1.1, 2.0, 3.0, 0.6),
        ("finer", chosen | {"element_size_m": 0.0005}, "hold", "hold", 1.1, 2.0, 3.0, 0.7),
    ]
    largest = [f"{event}_max_over_c_L" for event in ("left", "spontaneous", "right")]
    header = ["set", *standard, "constraints", "constraints_but_C25", *largest]
    rows = [
        [name, *(v if isinstance(v, str) else f"{v:g}" for v in values.values()), *rest]
        for name, values, *rest in samples
    ]
    write_csv(folder / "open_choices.csv", [*header, "share_in_band"], rows)

    def turns(*levels: tuple) -> list:
        return [{"choice": choice, "level": level} for choice, level in levels]

    def claim(name: str, holds: bool, turns: list) -> dict:
        shares = {"share_of_triggers": 1.0, "share_of_triggers_with_fronts": None, "share_of_all": 0.5}
        return {"id": name, "holds": holds, **shares, "turns": turns}

    def outcome(name: str, values: dict, hold: bool) -> dict:
        fit = {
            k: {"value": v, "low": v - 0.1, "high": v + 0.1} for k, v in zip("abc", (0.8, 2, 3), strict=True)
        }
        spreads = {"energy_rise": 0.12, "t_d_over_p_d": 0.15, "t_s_over_p_s": 0.18}
        return {
            "set": name,
            "values": values,
            "constraints_hold": hold,
            "claims": {"C2": True, "C11": hold, "C25": hold},
            **{f"{k}_max_over_c_L": v for k, v in (("left", 1.2), ("spontaneous", 2), ("right", 3))},
            "left_work_J_per_m": 156.4,
            "circle_peak_m_per_s": 2.4 if hold else None,
            "circle_gap": 0.25 if hold else None,
            **{f"spread_at_{k}": v for k, v in spreads.items()},
            "share_in_band": 0.75,
            "fit": fit | {"rms_over_c_L": 0.0601},
        }

    def outcomes_of(wanted: str) -> list:
        return [outcome(name, values, hold == "hold") for name, values, hold, *_ in samples if name == wanted]

    def evidence(samples: str, n: int, spreads: list) -> dict:
        spread = {f"spread_at_{name}": spreads for name in ("energy_rise", "t_d_over_p_d", "t_s_over_p_s")}
        return {
            "samples": samples,
            "n": n,
            "n_paper_fit_in_intervals": 0,
            "claims": {"C18c": {"n": n, "n_holding": n - 1}} if n else {},
            **spread,
            **{name: [0.7, 0.8, 0.9] if n else 3 * [None] for name in ("a", "b", "c", "share_in_band")},
            "difference_of_kinds_over_c_L": [0.1, 0.2, 0.3] if n else 3 * [None],
        }

    counts = "runs samples impossible triggers triggers_slow_left left left_with_fronts left_others_hold"
    counts += " left_region left_alike right right_region right_alike"
    summary = {
        "version": "0",
        "quick": False,
        **{f"n_{name}": n for n, name in enumerate(counts.split())},
        "wanted_share_in_band": 0.8,
        "choices": [open_choice(name, values, standard[name]) for name, values in levels.items()],
        "matrix": [
            claim("C2", True, turns(("left_form", "weakened"))),
            claim("C11", False, turns(("left_added", 5.0))),
        ],
        "constraints": ["C2", "C11", "C25"],
        "evidence": [
            evidence("the region", 2, [0.021, 0.037, 0.052]),
            evidence("held, all constraints but C25", 0, 3 * [None]),
        ],
        "region": {name: [] for name in levels if name.startswith("left")} | {"left_added": [9.0, 10.0]},
        **{name.split()[0]: outcomes_of(name) for name in ("known", "finer", "about the chosen")},
        "standard": outcome("standard", standard, False),
        "chosen": outcome("left trigger", chosen, True),
    }
    (folder / "open_choices.json").write_text(json.dumps(summary))
    return folder
