# SPDX-License-Identifier: BSD-3-Clause
"""What the comparisons with other codes share: their data, our runs, arrivals, options, verdict."""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from matplotlib.axes import Axes
from shared import DataError, checked, run_case

CASES = Path(__file__).resolve().parent.parent / "cases/reference"
ARRIVAL_M_PER_S = 1e-3  # slip rate of an arrival in the reference data

Measured = dict[str, Any]  # of a run against the references, by name


def read_columns(name: str) -> dict[str, np.ndarray]:
    """A table of numbers among the references' data."""
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


class InterfaceRun:
    """Fields along the interface, each [t, x]; x = 0 is the problem's."""

    def __init__(self, folder: Path, centre_m: float, fields: dict[str, str]) -> None:
        """Fields by their names here, with the keys in the file; "v" is the slip rate."""
        self.folder, self.centre_m = folder, centre_m
        with open(folder / "run.json") as file:
            facts = json.load(file)
        self.wall_s = facts["wall_s"]
        with h5py.File(folder / "interface.h5") as file:
            self.x_m = file["x_m"][:] - centre_m
            self.t_s = file["time_s"][:]
            self.fields = {name: file[key][:] for name, key in fields.items()}
        # Slip rates are those of half a sub-step later.
        self.v_t_s = self.t_s + 0.5 * facts["interface_dt_s"]

    def arrivals_s(self, x_m: np.ndarray) -> np.ndarray:
        """Linear between nodes; nan where the front does not arrive."""
        own = [passing_s(self.v_t_s, v, ARRIVAL_M_PER_S) for v in self.fields["v"].T]
        return np.interp(x_m, self.x_m, own)


def magnitude_s(late_s: np.ndarray) -> np.ndarray:
    """Of differences in arrival; a front that does not arrive is late without bound."""
    return np.where(np.isfinite(late_s), np.abs(late_s), np.inf)


def draw_lateness(
    axis: Axes, x: np.ndarray, other: dict[str, np.ndarray], runs: dict[str, np.ndarray]
) -> None:
    """Differences in arrival of another code (dotted) and of runs, by name, with a gap around x = 0."""
    for side in (x < 0, x > 0):
        for name, late in other.items():
            axis.plot(x[side], late[side], "k:", lw=1, label=name)
        for k, (name, late) in enumerate(runs.items()):
            axis.plot(x[side], late[side], f"C{k}", lw=1, label=name)
    axis.axhline(0, color="0.5", lw=0.5)
    handles, labels = axis.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    axis.legend(once.values(), once.keys(), fontsize=7)


def add_options(parser: argparse.ArgumentParser, picture: str, size: str, sizes: list[float] | None) -> None:
    parser.add_argument("--program", default="build/release/slipfront")
    parser.add_argument("--results", type=Path, default=Path("results-reference"))
    parser.add_argument("--figure", type=Path, help=f"default: {picture} in the folder of the results")
    parser.add_argument(size, type=float, nargs="+", default=sizes)


def picture_of(options: argparse.Namespace, name: str) -> Path:
    """Where the picture goes; refused before the runs where it cannot be written."""
    return checked(options.figure or options.results / name)


def run_with(options: argparse.Namespace, case: str, name: str, element_size_m: float) -> Path:
    """Runs a case on one mesh; the folder of its results."""
    folder: Path = options.results / name
    run_case(options.program, CASES / case, folder, f"plate.element_size_m={element_size_m!r}")
    return folder


def verdict(mesh: str, holds: bool) -> int:
    """Exit code: 0 where this, the finest mesh, keeps the limits."""
    print(f"At {mesh} the limits {'hold' if holds else 'DO NOT HOLD'}.")
    return 0 if holds else 1


def run_comparison(parser: argparse.ArgumentParser, work: Callable[[argparse.Namespace], int]) -> int:
    """Exit code of a comparison; its error is told as one of the options."""
    options = parser.parse_args()
    try:
        return work(options)
    except DataError as error:
        parser.error(str(error))
