#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs Problem A (docs/prestress.md), F (docs/two-bodies.md), R-A or TPV101 in 2D
(docs/friction/rate_and_state.md) on several meshes and compares it with other codes: table and figure."""

import argparse
import csv
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from reference_runs import (
    CASES,
    InterfaceRun,
    Measured,
    add_options,
    draw_lateness,
    magnitude_s,
    picture_of,
    read_columns,
    run_comparison,
    run_with,
    verdict,
)
from shared import write_figure

FIELDS = {"tau": "t_Pa", "p": "p_Pa", "v": "slip_rate_m_per_s", "slip": "slip_m"}


@dataclass
class Units:
    """Of what is printed and drawn."""

    length: str = "mm"
    length_m: float = 1e-3
    time: str = "us"
    time_s: float = 1e-6


@dataclass
class Problem:
    """A rupture along x from a patch in the middle of the interface."""

    name: str
    case: str
    centre_m: float  # of the nucleation patch in the case; x = 0 of the problem
    least_arrival_limit_s: float  # at the finest mesh; else max(1 %, 0.5 us)
    units: Units = field(default_factory=Units)
    sizes: tuple[float, ...] = (2, 1, 0.5, 0.25)  # of elements
    end_s: float = 145e-6  # until when the domain is free of reflections
    snapshots_s: tuple[float, ...] = (60e-6, 90e-6, 120e-6)
    other: str = "sem2dpack_1mm"  # the second code's arrivals
    other_name: str = "SEM2DPACK, 1 mm"
    from_m: float = 0.06
    to_m: float = 0.14
    tips: bool = False  # arrivals are those of fronts' tips, not the first slip rate of 1 mm/s
    limits: dict[str, float] = field(  # rms over range
        default_factory=lambda: {"tau": 0.03, "p": 0.03, "v": 0.03, "slip": 0.01}
    )

    def arrival_limit_s(self, t: np.ndarray, finest: bool) -> np.ndarray:
        coarse = max(self.least_arrival_limit_s, 0.5e-6)
        if finest and (self.tips or self.least_arrival_limit_s < coarse):
            return np.full_like(t, self.least_arrival_limit_s)
        return np.maximum(0.01 * t, coarse)


PROBLEMS = {
    "a": Problem("problem_a", "rigid_flat_a.toml", 0.2, 0.5e-6),
    "f": Problem("bimaterial_f", "bimaterial_f.toml", 0.25, 0.2e-6),
    "r": Problem(
        "rate_and_state_a",
        "rate_and_state_a.toml",
        0.22,
        0.3e-6,
        sizes=(1, 0.5, 0.25),
        other="sem2dpack_extrap",
        other_name="SEM2DPACK, extrapolated",
        from_m=0.035,
        to_m=0.12,
        tips=True,
        limits={"tau": 0.015, "v": 0.015, "slip": 0.002},
    ),
    "t": Problem(
        "tpv101",
        "tpv101.toml",
        36e3,
        0.005,
        units=Units("km", 1e3, "s", 1),
        sizes=(0.1, 0.05, 0.025),
        end_s=8,
        snapshots_s=(3, 4, 5),
        other="uguca_25m",
        other_name="uguca, 25 m",
        from_m=5e3,
        to_m=15e3,
        tips=True,
        limits={"tau": 0.02, "v": 0.022, "slip": 0.0027},  # twice what uguca differs by at 50 and 25 m
    ),
}


class Run(InterfaceRun):
    def tips_s(self, x_m: np.ndarray) -> np.ndarray:
        """Arrivals of fronts, linear between nodes."""
        with open(self.folder / "fronts.csv", newline="") as file:
            rows = [(float(row["x_m"]), float(row["onset_s"])) for row in csv.DictReader(file)]
        own_x_m, own_s = np.array(sorted(rows)).T
        return np.interp(x_m, own_x_m - self.centre_m, own_s)

    def field(self, name: str, t_s: np.ndarray, x_m: np.ndarray) -> np.ndarray:
        own_t_s = self.v_t_s if name == "v" else self.t_s
        at_times = np.array([np.interp(t_s, own_t_s, column) for column in self.fields[name].T]).T
        return np.array([np.interp(x_m, self.x_m, row) for row in at_times])


class Reference:
    def __init__(self, problem: Problem) -> None:
        column = read_columns(f"{problem.name}_arrivals.csv")
        x_m = column["x_m"]
        self.problem = problem
        here = (np.abs(x_m) > problem.from_m - 1e-6) & (np.abs(x_m) < problem.to_m + 1e-6)
        self.x_m = x_m[here]
        self.arrivals_s = column["t_slip_uguca_extrap_s"][here]
        self.other_s = column[f"t_slip_{problem.other}_s"][here]
        fields = np.load(CASES / f"data/{problem.name}_fields.npz")
        self.t_s = fields["t"][fields["t"] < problem.end_s * (1 + 1e-5)]
        inside = np.abs(fields["x"]) < problem.to_m + 1e-6
        self.fields_x_m = fields["x"][inside]
        self.fields = {name: fields[name][: len(self.t_s), inside] for name in problem.limits}


Compared = tuple[float, Run, Measured]  # with the element size, in the problem's unit


def compare(run: Run, reference: Reference, limit_s: np.ndarray) -> Measured:
    problem = reference.problem
    arrivals_s = run.tips_s if problem.tips else run.arrivals_s
    late_s = arrivals_s(reference.x_m) - reference.arrivals_s
    measured: Measured = {"late_s": late_s}
    size_s = magnitude_s(late_s)
    measured["largest_s"] = size_s.max()
    measured["beyond"] = int(np.sum(size_s > limit_s))
    outside = np.abs(reference.fields_x_m) > problem.from_m - 1e-6
    for name, expected in reference.fields.items():
        error = run.field(name, reference.t_s, reference.fields_x_m) - expected
        measured[name] = np.sqrt(np.mean(error**2)) / np.ptp(expected)
        measured[f"{name} outside"] = np.sqrt(np.mean(error[:, outside] ** 2)) / np.ptp(expected[:, outside])
    return measured


def table(results: list[Compared], problem: Problem, n_points: int) -> str:
    fields, units = problem.limits, problem.units
    lines = [
        f"| h ({units.length}) | arrival, largest difference ({units.time}) | beyond its limit | "
        f"{' | '.join(fields)} | stepping (s) |",
        "|---" * (4 + len(fields)) + "|",
    ]
    for h, run, m in results:
        rms = " | ".join(f"{100 * m[name]:.2f} %, {100 * m[f'{name} outside']:.2f} %" for name in fields)
        lines.append(
            f"| {h:g} | {m['largest_s'] / units.time_s:.3g} | {m['beyond']} of {n_points} | {rms} | "
            f"{run.wall_s:.2g} |"
        )
    return "\n".join(lines)


def draw(results: list[Compared], reference: Reference, limit_s: np.ndarray, picture: Path) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained", dpi=110)
    problem, units = reference.problem, reference.problem.units
    x, limit = reference.x_m / units.length_m, limit_s / units.time_s
    for side in (x < 0, x > 0):
        left.fill_between(x[side], -limit[side], limit[side], color="0.9", lw=0, label="limit")
    other = (reference.other_s - reference.arrivals_s) / units.time_s
    late = {f"h = {h:g} {units.length}": m["late_s"] / units.time_s for h, _, m in results}
    draw_lateness(left, x, {problem.other_name: other}, late)
    left.set(xlabel=f"x ({units.length})", ylabel=f"arrival less that of uguca, extrapolated ({units.time})")
    for time_s in problem.snapshots_s:
        row = np.argmin(np.abs(reference.t_s - time_s))
        right.plot(reference.fields_x_m / units.length_m, reference.fields["v"][row], "k--", lw=1.4, zorder=3)
        peak_m = reference.fields_x_m[np.argmax(reference.fields["v"][row])]
        right.text(
            peak_m / units.length_m,
            1.01,  # above the frame, where it hides nothing
            f"{time_s / units.time_s:.0f} {units.time}",
            transform=right.get_xaxis_transform(),
            ha="center",
            fontsize=7,
        )
        for k, (_, run, _) in enumerate(results):
            v = run.field("v", np.array([time_s]), run.x_m)[0]
            right.plot(run.x_m / units.length_m, v, color=f"C{k}", lw=0.8)
    right.plot([], [], "k--", lw=1.4, label="uguca")
    edge = np.ceil(problem.to_m / units.length_m)
    right.set(xlabel=f"x ({units.length})", ylabel="slip rate (m/s)", xlim=(-edge, edge))
    right.legend(fontsize=7)
    write_figure(picture, figure)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("problem", choices=PROBLEMS)
    add_options(parser, "reference_PROBLEM.png", "--h", None)
    return run_comparison(parser, compare_all)


def compare_all(options: argparse.Namespace) -> int:
    """Exit code: 0 where the finest mesh keeps the limits."""
    problem = PROBLEMS[options.problem]
    picture = picture_of(options, f"reference_{options.problem}.png")
    reference = Reference(problem)
    results: list[Compared] = []
    units, sizes = problem.units, options.h or problem.sizes
    for h in sizes:
        folder = run_with(options, problem.case, f"{problem.name}_h_{h:g}_{units.length}", h * units.length_m)
        run = Run(folder, problem.centre_m, FIELDS)
        limit_s = problem.arrival_limit_s(reference.arrivals_s, h == min(sizes))
        results.append((h, run, compare(run, reference, limit_s)))
    print(table(results, problem, len(reference.x_m)))
    between = np.nanmax(np.abs(reference.other_s - reference.arrivals_s))
    print(
        f"\nBetween the two references ({problem.other_name}): {between / units.time_s:.2g} {units.time} in "
        "arrivals."
    )
    draw(results, reference, limit_s, picture)
    finest = results[-1][2]
    holds = finest["beyond"] == 0 and all(
        max(finest[name], finest[f"{name} outside"]) < limit for name, limit in problem.limits.items()
    )
    return verdict(f"h = {results[-1][0]:g} {units.length}", holds)


if __name__ == "__main__":
    raise SystemExit(main())
