# SPDX-License-Identifier: BSD-3-Clause
"""Solutions of other codes as records of `slipfront fit`, whose values are known;
renews a table of docs/fit.md."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
from fit_runs import WORKERS, first_runs, fit
from reference_runs import CASES, read_columns
from shared import renew_from_runs
from slipfront.files import read_toml
from slipfront.pages import table
from slipfront.records import Channel, Event, Writer

ONSET_ERROR_S = 0.1e-6  # rms by which the codes differ in Problem A, more than in the others
SLIP_AT_M = (-0.1, -0.06, 0.06, 0.1)
END_S = 145e-6  # until when the domain is free of reflections


@dataclass(frozen=True)
class Problem:
    """A rupture along x from a patch in the middle of the interface, x = 0."""

    title: str
    case: str
    data: str
    centre_m: float  # of the patch in the case
    from_m: float  # |x| of the onsets
    to_m: float
    free: dict[str, str]
    element_mm: float


SLIP_WEAKENING = {"friction.mu_k": "0.2:0.38", "friction.d_c_m": "1.5e-6:10e-6:log"}
TWO_BODIES = {"friction.mu_k": "0.2:0.38", "friction.d_c_m": "5e-6:30e-6:log"}
RATE_AND_STATE = {
    "friction.a": "0.005:0.012",
    "friction.b": "0.012:0.024",
    "friction.d_c_m": "0.2e-6:1.2e-6:log",
}
PROBLEMS = (
    Problem("A", "rigid_flat_a.toml", "problem_a", 0.2, 0.06, 0.14, SLIP_WEAKENING, 0.5),
    Problem("A", "rigid_flat_a.toml", "problem_a", 0.2, 0.06, 0.14, SLIP_WEAKENING, 0.25),
    Problem("F", "bimaterial_f.toml", "bimaterial_f", 0.25, 0.06, 0.14, TWO_BODIES, 1),
    Problem("R-A", "rate_and_state_a.toml", "rate_and_state_a", 0.22, 0.04, 0.12, RATE_AND_STATE, 0.5),
)
RECORDS = {"onsets": ("onsets.csv",), "onsets and slip": ("onsets.csv", "slip.nc")}


def write_onsets(problem: Problem, file: Path) -> None:
    """Every 10 mm: where the slip rate first passes 1 mm/s, or that of the program's tips under a law with a
    state."""
    column = read_columns(f"{problem.data}_arrivals.csv")
    x_mm = np.round(1e3 * column["x_m"]).astype(int)
    far = (abs(x_mm) >= 1e3 * problem.from_m) & (abs(x_mm) <= 1e3 * problem.to_m)
    at = far & (x_mm % 10 == 0)
    onsets = {"x_m": column["x_m"][at] + problem.centre_m, "time_s": column["t_slip_uguca_extrap_s"][at]}
    pd.DataFrame(onsets | {"error_s": ONSET_ERROR_S}).to_csv(file, index=False)


def write_slip(problem: Problem, file: Path) -> None:
    fields = np.load(CASES / f"data/{problem.data}_fields.npz")
    early = fields["t"] <= END_S * (1 + 1e-5)
    channels = {}
    for x_m in SLIP_AT_M:
        name, k = f"slip_{1e3 * x_m:+.0f}", int(np.argmin(abs(fields["x"] - x_m)))
        slip_m = fields["slip"][early, k].astype(float)
        channels[name] = Channel(
            name, "slip", name, fields["t"][early], slip_m, x_m=float(fields["x"][k]) + problem.centre_m
        )
    with h5py.File(file, "w") as hdf5:
        writer = Writer(hdf5, {})
        for channel in channels.values():
            writer.put(1, 0.0, channel)
        writer.end(Event(1, 0.0, channels))


def case_of(problem: Problem, folder: Path) -> Path:
    """The reference's case with elements of its own size, and a history as fine as the records."""
    text = (CASES / problem.case).read_text(encoding="utf-8")
    for name, value in (("element_size_m", 1e-3 * problem.element_mm), ("history_interval_s", 0.5e-6)):
        lines = [
            f"{name} = {value!r}" if line.startswith(f"{name} =") else line for line in text.splitlines()
        ]
        text = "\n".join(lines) + "\n"
    file = folder / "case.toml"
    file.write_text(text, encoding="utf-8")
    return file


def fits_of(problem: Problem, folder: Path) -> list[tuple[str, dict[str, Any]]]:
    own = folder / f"{problem.data}_{problem.element_mm:g}_mm"
    own.mkdir(exist_ok=True)
    case = case_of(problem, own)
    write_onsets(problem, own / "onsets.csv")
    write_slip(problem, own / "slip.nc")
    first_runs(case, problem.free, own / "first")
    found = []
    for k, (name, files) in enumerate(RECORDS.items()):
        records, options = [own / file for file in files], ("--workers", str(WORKERS))
        of_fit = fit(case, records, problem.free, own / f"fit_{k}", *options, first=own / "first")
        found.append((name, of_fit))
    return found


def rows_of(problem: Problem, name: str, found: dict[str, Any]) -> list[list[str]]:
    """A row per free key."""
    known = read_toml(CASES / problem.case)["friction"]
    begun = [f"{problem.title}, {problem.element_mm:g} mm", name]
    ended = [str(found["runs"]["all"])]
    rows = []
    for key in problem.free:
        of, truth = found["parameters"][key], known[key.removeprefix("friction.")]
        low, high = of["interval_90"]
        off = f"{of['median'] / truth - 1:+.1%}" if of["is_determined"] else "not determined"
        finer = f"{found['finer_mesh'][key]['median'] / truth - 1:+.1%}"
        rows.append(
            [
                *begun,
                f"`{key}`",
                f"{truth:.4g}",
                f"{of['median']:.4g}",
                f"{low:.4g} to {high:.4g}",
                off,
                finer,
                *ended,
            ]
        )
        begun, ended = ["", ""], [""]
    return rows


def table_of(problems: Sequence[Problem], folder: Path) -> str:
    rows = []
    for problem in problems:
        for name, found in fits_of(problem, folder):
            rows += rows_of(problem, name, found)
    header = ["problem, elements", "records", "key", "known", "median", "90 %", "off by",
              "elements half as large", "runs"]  # fmt: skip
    return table(header, rows)


def write(folder: Path, _: Path) -> dict[str, str]:
    return {"references": table_of(PROBLEMS, folder)}


if __name__ == "__main__":
    sys.exit(renew_from_runs(__file__, __doc__, "fit.md", write))
