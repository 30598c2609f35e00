#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs TPV205-2D (docs/two-bodies.md) on several meshes and compares it with three other codes."""

import argparse
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from reference_runs import (
    InterfaceRun,
    Measured,
    add_options,
    draw_lateness,
    magnitude_s,
    passing_s,
    picture_of,
    read_columns,
    run_comparison,
    run_with,
    verdict,
)
from shared import write_figure

CENTRE_M = 40e3  # the problem's x = 0 in the case
STATIONS_M = (-12000, -7500, -4500, 0, 4500, 7500, 12000)
PASSING_M_PER_S = 1.0  # slip rate of an arrival at a station
FROM_M, TO_M = 2e3, 15e3  # where arrivals are compared: outside the patch that begins by itself
FIELDS = {"v": "slip_rate_m_per_s", "slip": "slip_m"}
COLOURS = {"PyLith, 200 m": "0.6", "uguca, 50 m": "k"}


class Station:
    def __init__(self, t: np.ndarray, rate: np.ndarray, slip: np.ndarray) -> None:
        self.t, self.rate, self.slip = t, rate, slip
        self.pass_s = passing_s(t, rate, PASSING_M_PER_S)
        self.peak = rate.max()
        self.end = slip[-1]


Stations = dict[int, Station]  # by x, m


def reference_stations(name: str) -> Stations:
    table = read_columns(name)
    return {x: Station(table["t_s"], table[f"sliprate_{x}_m_s"], table[f"slip_{x}_m"]) for x in STATIONS_M}


class Run(InterfaceRun):
    def __init__(self, folder: Path) -> None:
        super().__init__(folder, CENTRE_M, FIELDS)
        self.stations = {x: self.station(x) for x in STATIONS_M}

    def station(self, x: int) -> Station:
        rate, slip = self.fields["v"], self.fields["slip"]
        at = int(np.argmin(np.abs(self.x_m - x)))
        if abs(self.x_m[at] - x) < 1e-6:
            return Station(self.v_t_s, rate[:, at], slip[:, at])
        # Between two nodes, as at 7.5 km with elements of 200 m.
        left = int(np.searchsorted(self.x_m, x)) - 1
        pair = slice(left, left + 2)
        share = (x - self.x_m[left]) / (self.x_m[left + 1] - self.x_m[left])
        weights = np.array([1 - share, share])
        return Station(self.v_t_s, rate[:, pair] @ weights, slip[:, pair] @ weights)


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
    size_s = magnitude_s(late_s)
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
    late_s = {f"h = {h:g} m": m["late_s"] for h, _, m in results}
    draw_lateness(axes[0, 0], 1e-3 * arrivals[0], {"SEM2DPACK, 50 m": between_s}, late_s)
    axes[0, 0].set(xlabel="x (km)", ylabel="arrival less that of uguca, extrapolated (s)")
    for axis, station in zip(axes.flat[1:], (-12000, 0, 7500), strict=True):
        for name, stations in references.items():
            axis.plot(stations[station].t, stations[station].rate, color=COLOURS[name], lw=1.6, label=name)
        for k, (h, run, _) in enumerate(results):
            axis.plot(run.v_t_s, run.stations[station].rate, f"C{k}", lw=0.7, label=f"h = {h:g} m")
        axis.set(xlabel="t (s)", ylabel="slip rate (m/s)", title=f"x = {1e-3 * station:g} km", xlim=(0, 12))
        axis.legend(fontsize=7)
    write_figure(picture, figure)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    add_options(parser, "reference_tpv205.png", "--h-m", [200, 100, 50])
    return run_comparison(parser, compare_all)


def compare_all(options: argparse.Namespace) -> int:
    """Exit code: 0 where the finest mesh keeps the limits."""
    picture = picture_of(options, "reference_tpv205.png")
    table = read_columns("tpv205_arrivals_uguca_sem2dpack.csv")
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
        run = Run(run_with(options, "tpv205.toml", f"tpv205_h_{h:g}_m", h))
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
    return verdict(f"h = {results[-1][0]:g} m", holds)


if __name__ == "__main__":
    raise SystemExit(main())
