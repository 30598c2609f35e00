#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs TPV205-2D (docs/two-bodies.md) on several meshes and compares it with three other codes."""

import argparse
import csv
import json
from pathlib import Path
from typing import Any

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from shared import DataError, checked, run_case, write_figure

CASES = Path(__file__).resolve().parent.parent / "cases/reference"
CENTRE_M = 40e3  # the problem's x = 0 in the case
STATIONS_M = (-12000, -7500, -4500, 0, 4500, 7500, 12000)
ARRIVAL_M_PER_S = 1e-3  # slip rate of an arrival in the reference data
PASSING_M_PER_S = 1.0  # the same at a station
FROM_M, TO_M = 2e3, 15e3  # where arrivals are compared: outside the patch that begins by itself
COLOURS = {"PyLith, 200 m": "0.6", "uguca, 50 m": "k"}


def read_csv(name: str) -> dict[str, np.ndarray]:
    with open(CASES / "data" / name, newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def passing_s(t: np.ndarray, v: np.ndarray, threshold: float) -> float:
    """First time that a slip rate passes a threshold, linear between samples; nan where it does not."""
    after = int(np.argmax(v > threshold))
    if v[after] <= threshold:
        return np.nan
    if after == 0:
        return float(t[0])
    return float(np.interp(threshold, v[after - 1 : after + 1], t[after - 1 : after + 1]))


class Station:
    def __init__(self, t: np.ndarray, rate: np.ndarray, slip: np.ndarray) -> None:
        self.t, self.rate, self.slip = t, rate, slip
        self.pass_s = passing_s(t, rate, PASSING_M_PER_S)
        self.peak = rate.max()
        self.end = slip[-1]


Stations = dict[int, Station]  # by x, m


def reference_stations(name: str) -> Stations:
    table = read_csv(name)
    return {x: Station(table["t_s"], table[f"sliprate_{x}_m_s"], table[f"slip_{x}_m"]) for x in STATIONS_M}


class Run:
    def __init__(self, folder: Path) -> None:
        with open(folder / "run.json") as file:
            facts = json.load(file)
        self.wall_s = facts["wall_s"]
        with h5py.File(folder / "interface.h5") as file:
            self.x_m = file["x_m"][:] - CENTRE_M
            self.t_s = file["time_s"][:]
            self.rate = file["slip_rate_m_per_s"][:]
            self.slip = file["slip_m"][:]
        self.rate_t_s = self.t_s + 0.5 * facts["interface_dt_s"]
        self.stations = {x: self.station(x) for x in STATIONS_M}

    def station(self, x: int) -> Station:
        at = int(np.argmin(np.abs(self.x_m - x)))
        if abs(self.x_m[at] - x) < 1e-6:
            return Station(self.rate_t_s, self.rate[:, at], self.slip[:, at])
        # Between two nodes, as at 7.5 km with elements of 200 m.
        left = int(np.searchsorted(self.x_m, x)) - 1
        pair = slice(left, left + 2)
        share = (x - self.x_m[left]) / (self.x_m[left + 1] - self.x_m[left])
        weights = np.array([1 - share, share])
        return Station(self.rate_t_s, self.rate[:, pair] @ weights, self.slip[:, pair] @ weights)

    def arrivals_s(self, x_m: np.ndarray) -> np.ndarray:
        own = [passing_s(self.rate_t_s, column, ARRIVAL_M_PER_S) for column in self.rate.T]
        return np.interp(x_m, self.x_m, own)


Measured = dict[str, Any]  # of a run against the references, by name
Compared = tuple[float, Run, Measured]  # with the element size, m
Arrivals = tuple[np.ndarray, np.ndarray]  # x, m, and time, s


def station_table(runs: dict[str, Run], references: dict[str, Stations]) -> str:
    lines = [
        "| x (km) | " + " | ".join(f"{name}" for name in [*references, *runs]) + " |",
        "|---" * (1 + len(references) + len(runs)) + "|",
    ]
    everyone = [*references.values(), *[run.stations for run in runs.values()]]
    for x in STATIONS_M:
        cells = [f"{s[x].pass_s:.2f} s, {s[x].peak:.2f} m/s, {s[x].end:.2f} m" for s in everyone]
        lines.append(f"| {1e-3 * x:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def compare(run: Run, references: dict[str, Stations], arrivals: Arrivals, spread: float) -> Measured:
    """Largest differences: of arrivals (s, and relative), of peaks and of final slip, and how many arrivals
    are beyond the codes' own spread."""
    x, expected = arrivals
    late_s = run.arrivals_s(x) - expected
    # Where the front does not arrive at all, it is late without bound.
    size_s = np.where(np.isfinite(late_s), np.abs(late_s), np.inf)
    slips = [run.stations[s].end / references["uguca, 50 m"][s].end - 1 for s in STATIONS_M]
    peaks = [run.stations[s].peak / references["uguca, 50 m"][s].peak - 1 for s in STATIONS_M]
    passes = [run.stations[s].pass_s - references["uguca, 50 m"][s].pass_s for s in STATIONS_M]
    return {
        "late_s": late_s,
        "median_s": float(np.median(size_s)),
        "largest_s": float(np.max(size_s[np.isfinite(size_s)])),
        "slip": float(np.max(np.abs(slips))),
        "peak": float(np.max(np.abs(peaks))),
        "pass_s": float(np.max(np.abs(passes))),
        "beyond": int(np.sum(size_s > np.maximum(0.01 * expected, spread))),
    }


def summary(results: list[Compared], n_points: int) -> str:
    lines = [
        "| h (m) | arrivals: median, largest difference (s) | beyond the limit | v > 1 m/s at stations (s) | "
        "peak slip rate | final slip | stepping (s) |",
        "|---|---|---|---|---|---|---|",
    ]
    for h, run, m in results:
        lines.append(
            f"| {h:g} | {m['median_s']:.3f}, {m['largest_s']:.3f} | {m['beyond']} of {n_points} | "
            f"{m['pass_s']:.3f} | {100 * m['peak']:.1f} % | {100 * m['slip']:.2f} % | {run.wall_s:.2g} |"
        )
    return "\n".join(lines)


def draw(
    results: list[Compared],
    references: dict[str, Stations],
    arrivals: Arrivals,
    between_s: np.ndarray,
    picture: Path,
) -> None:
    figure, axes = plt.subplots(2, 2, figsize=(10, 7), layout="constrained", dpi=110)
    x, _ = arrivals
    for side in (x < 0, x > 0):
        axes[0, 0].plot(1e-3 * x[side], between_s[side], "k:", lw=1, label="SEM2DPACK, 50 m")
        for k, (h, _, m) in enumerate(results):
            axes[0, 0].plot(1e-3 * x[side], m["late_s"][side], f"C{k}", lw=1, label=f"h = {h:g} m")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    axes[0, 0].legend(once.values(), once.keys(), fontsize=7)
    axes[0, 0].axhline(0, color="0.5", lw=0.5)
    axes[0, 0].set(xlabel="x (km)", ylabel="arrival less that of uguca, extrapolated (s)")
    for axis, station in zip(axes.flat[1:], (-12000, 0, 7500), strict=True):
        for name, stations in references.items():
            axis.plot(stations[station].t, stations[station].rate, color=COLOURS[name], lw=1.6, label=name)
        for k, (h, run, _) in enumerate(results):
            axis.plot(run.rate_t_s, run.stations[station].rate, f"C{k}", lw=0.7, label=f"h = {h:g} m")
        axis.set(xlabel="t (s)", ylabel="slip rate (m/s)", title=f"x = {1e-3 * station:g} km", xlim=(0, 12))
        axis.legend(fontsize=7)
    write_figure(picture, figure)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/slipfront")
    parser.add_argument("--results", type=Path, default=Path("results-reference"))
    parser.add_argument(
        "--figure", type=Path, help="default: reference_tpv205.png in the folder of the results"
    )
    parser.add_argument("--h-m", type=float, nargs="+", default=[200, 100, 50])
    options = parser.parse_args()
    try:
        return compare_all(options)
    except DataError as error:
        parser.error(str(error))


def compare_all(options: argparse.Namespace) -> int:
    """Exit code: 0 where the finest mesh keeps the limits."""
    picture = options.figure or options.results / "reference_tpv205.png"
    checked(picture)  # before the runs
    table = read_csv("tpv205_arrivals_uguca_sem2dpack.csv")
    inside = (np.abs(table["x_m"]) > FROM_M) & (np.abs(table["x_m"]) < TO_M)
    arrivals = table["x_m"][inside], table["t_slip_uguca_extrap_s"][inside]
    between_s = table["t_slip_sem2dpack_50m_s"][inside] - arrivals[1]
    references = {
        "PyLith, 200 m": reference_stations("tpv205_stations_pylith_200m.csv"),
        "uguca, 50 m": reference_stations("tpv205_stations_uguca_50m.csv"),
    }
    spread = float(np.max(np.abs(between_s)))
    results: list[Compared] = []
    for h in options.h_m:
        folder = options.results / f"tpv205_h_{h:g}_m"
        run_case(options.program, CASES / "tpv205.toml", folder, f"plate.element_size_m={h!r}")
        run = Run(folder)
        results.append((h, run, compare(run, references, arrivals, spread)))
    print("First slip rate above 1 m/s, highest slip rate, slip at 12 s:\n")
    print(station_table({f"h = {h:g} m": run for h, run, _ in results}, references))
    print("\nLargest differences from uguca (arrivals: extrapolated; stations: 50 m):\n")
    print(summary(results, len(arrivals[0])))
    print(
        f"\nBetween uguca and SEM2DPACK (50 m): {np.median(np.abs(between_s)):.3f} s in the median of the "
        f"arrivals, {spread:.3f} s at most."
    )
    draw(results, references, arrivals, between_s, picture)
    finest = results[-1][2]
    holds = finest["beyond"] == 0 and finest["slip"] < 0.015
    print(f"At h = {results[-1][0]:g} m the limits {'hold' if holds else 'DO NOT HOLD'}.")
    return 0 if holds else 1


if __name__ == "__main__":
    raise SystemExit(main())
