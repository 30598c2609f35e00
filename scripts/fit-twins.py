# SPDX-License-Identifier: BSD-3-Clause
"""How often intervals of `slipfront fit` hold the truth: runs of known values, with noise, as records;
renews the table of docs/fit.md."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import slipfront
from fit_runs import POSTERIOR, WORKERS, first_runs, fit, share_of_range, width
from shared import renew_from_runs, run_case
from slipfront.compare.onsets import onsets_at
from slipfront.fit.command import FIRST_A_KEY
from slipfront.fit.space import space_of
from slipfront.gauges import gauges_of
from slipfront.pages import table
from slipfront.program import find_program

TWINS = 40
LAW = 'law = "slip_weakening"\nmu_s = 0.6\nmu_k = 0.3\nd_c_m = 4e-6\n'
CASE = f"""title = "rupture between equal bodies, beside which twins are fitted"
[plate]
width_m = 0.2
height_m = 0.05
element_size_m = 2e-3
corner = "none"
sides = "absorbing"
top = "absorbing"
[base]
kind = "body"
sides = "absorbing"
bottom = "absorbing"
[material]
youngs_modulus_Pa = 2.6e9
poissons_ratio = 0.37
density_kg_per_m3 = 1200
plane = "stress"
[loading]
method = "prestress"
[prestress]
t_Pa = 2.2e6
p_Pa = 5e6
[friction]
{LAW}[event]
kind = "nucleation"
[nucleation]
x_m = 0.06
half_length_m = 0.02
taper_m = 0.01
[time]
end_s = 200e-6
[probes]
x_m = [0.101, 0.141]
y_m = [0.005, 0.005]
"""
FREE = {
    "friction.mu_k": "0.2:0.4",
    "friction.d_c_m": "2e-6:8e-6:log",
    "prestress.t_Pa": "1.9e6:2.5e6",
}
PLACES_M = np.linspace(0.02, 0.18, 15)
LEAST_PLACES = 12  # that a rupture reaches
ONSET_ERROR_S = 0.5e-6  # half a sample of a recorder of 1 MHz
INTERVAL_S = 1e-6  # of its samples
NOISE = 0.05  # of a gauge, over the range of its strain
LEVELS = (90, 68)


@dataclass(frozen=True)
class Twin:
    number: int
    truth: dict[str, float]
    records: list[Path]


def truth_of(rng: np.random.Generator) -> dict[str, float]:
    """Drawn as the fit's prior has it."""
    space = space_of(FREE)
    return dict(zip(space.keys, map(float, space.values(rng.random(space.n))), strict=True))


def case_of(folder: Path) -> Path:
    file = folder / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    return file


def record_of(run: Any, folder: Path, rng: np.random.Generator) -> list[Path]:
    """Onsets and strain of a run with noise, each on a clock of its own; none where it reaches few places."""
    onset_s = onsets_at(run, PLACES_M)
    if np.isfinite(onset_s).sum() < LEAST_PLACES:
        return []
    folder.mkdir(parents=True, exist_ok=True)
    measured_s = onset_s + ONSET_ERROR_S * rng.normal(size=len(onset_s)) + rng.uniform(-1e-3, 1e-3)
    onsets = pd.DataFrame({"x_m": PLACES_M, "time_s": measured_s, "error_s": ONSET_ERROR_S})
    onsets.to_csv(folder / "onsets.csv", index=False)
    clock_s, tables = rng.uniform(-1e-3, 1e-3), []
    for gauge in gauges_of(run):
        time_s = np.arange(gauge.time_s[0], gauge.time_s[-1], INTERVAL_S)
        columns: dict[str, Any] = {"gauge": gauge.name, "x_m": gauge.x_m, "y_m": gauge.y_m,
                                   "time_s": time_s + clock_s}  # fmt: skip
        for part, values in gauge.values.items():
            noise = NOISE * np.ptp(values) * rng.normal(size=len(time_s))
            columns[f"strain_{part}"] = np.interp(time_s, gauge.time_s, values) + noise
        tables.append(pd.DataFrame(columns))
    pd.concat(tables).to_csv(folder / "gauges.csv", index=False)
    return [folder / "onsets.csv", folder / "gauges.csv"]


def twins(count: int, folder: Path) -> list[Twin]:
    """Truths and records, the same at each call."""
    found: list[Twin] = []
    case, drawn = case_of(folder), 0
    while len(found) < count:
        rng = np.random.default_rng([1, drawn])
        drawn += 1
        truth = truth_of(rng)
        run_case(str(find_program()), case, folder / "truth", *(f"{k}={v!r}" for k, v in truth.items()))
        number = len(found) + 1
        records = record_of(slipfront.open(folder / "truth"), folder / f"record_{number:02d}", rng)
        if records:
            found.append(Twin(number, truth, records))
    return found


def fit_twin(twin: Twin, folder: Path) -> dict[str, Any]:
    own = folder / f"fit_{twin.number:02d}"
    return fit(folder / "case.toml", twin.records, FREE, own, "--workers", "1", first=folder / "first")


def fit_twins(count: int, folder: Path) -> list[tuple[Twin, dict[str, Any]]]:
    every = twins(count, folder)
    first_runs(folder / "case.toml", FREE, folder / "first")
    with ThreadPoolExecutor(WORKERS) as pool:
        return list(zip(every, pool.map(lambda twin: fit_twin(twin, folder), every), strict=True))


def is_within(found: dict[str, Any], key: str, truth: float, level: int) -> bool:
    low, high = found["parameters"][key][f"interval_{level}"]
    return bool(low <= truth <= high)


def off_by(found: dict[str, Any], folder: Path, key: str, truth: float) -> float:
    """The truth less the posterior's mean, over its standard deviation; of logarithms where the range is."""
    samples = share_of_range(found, key, pd.read_csv(folder / POSTERIOR)[key].to_numpy())
    return float((share_of_range(found, key, [truth])[0] - samples.mean()) / samples.std())


def table_of(fits: list[tuple[Twin, dict[str, Any]]], folder: Path) -> str:
    rows = []
    for key in FREE:
        within = [
            str(sum(is_within(found, key, twin.truth[key], level) for twin, found in fits))
            for level in LEVELS
        ]
        off = [off_by(found, folder / f"fit_{twin.number:02d}", key, twin.truth[key]) for twin, found in fits]
        wide = [width(found, key) for _, found in fits]
        spread = f"{np.median(wide):.2f} ({min(wide):.2f} to {max(wide):.2f})"
        rows.append([f"`{key}`", *within, spread, f"{np.sqrt(np.mean(np.square(off))):.2f}"])
    of = f"of {len(fits)} truths, within"
    header = ["key", *(f"{of} {level} %" for level in LEVELS), "interval of 90 % over the range",
              "truth less mean over deviation, rms"]  # fmt: skip
    runs = [found["runs"]["all"] for _, found in fits]
    doubted = sum(any("agree" in note for note in found["notes"]) for _, found in fits)
    return table(header, rows) + (
        f"\n{np.median(runs):.0f} runs a twin ({min(runs)} to {max(runs)}), the first "
        f"{FIRST_A_KEY * len(FREE)} in common. "
        f"{doubted} fits end in doubt whether their runs agree with what was expected.\n"
    )


@dataclass(frozen=True)
class Law:
    """A law by which records of slip weakening are fitted; t is free under all."""

    name: str
    lines: str  # of the case
    free: dict[str, str]


T = "prestress.t_Pa"
LAWS = (
    Law("slip_weakening", LAW, FREE),
    Law(
        "slip_weakening_exponential",
        'law = "slip_weakening_exponential"\nmu_s = 0.6\n',
        {"friction.mu_k": FREE["friction.mu_k"], "friction.d_c_m": "1e-6:4e-6:log", T: FREE[T]},
    ),
    Law(
        "velocity_weakening",
        'law = "velocity_weakening"\nmu_s = 0.6\n',
        {"friction.mu_k": FREE["friction.mu_k"], "friction.alpha_m2_per_s2": "0.03:1:log", T: FREE[T]},
    ),
)


def fit_law(law: Law, records: list[Path], folder: Path) -> dict[str, Any]:
    folder.mkdir(parents=True, exist_ok=True)
    case = folder / "case.toml"
    case.write_text(CASE.replace(LAW, law.lines), encoding="utf-8")
    return fit(case, records, law.free, folder / f"fit_{len(records)}", "--workers", "1")


def left_by(found: dict[str, Any]) -> tuple[str, str]:
    """What the best run leaves of onsets, over their error, and of strain, over its deviation, rms."""
    of_onsets, squares = "", []
    for part in found["parts"].values():
        if part["standard_error"] is None:
            squares.append(part["rms_over_deviation"] ** 2)
        else:
            over = part["rms_left"] / part["standard_error"]
            of_onsets = f"{over:.2f} ({part['probability_of_chi2']:.2g})"
    return of_onsets, f"{100 * np.sqrt(np.mean(squares)):.1f} %" if squares else ""


def laws_table(folder: Path) -> str:
    """One twin in the middle of the ranges, fitted by each law: by its onsets alone, and by all records."""
    rng = np.random.default_rng([2, 0])
    own = folder / "laws"
    own.mkdir(exist_ok=True)
    run_case(str(find_program()), case_of(own), own / "truth")
    records = record_of(slipfront.open(own / "truth"), own / "record", rng)
    asked = [(law, n) for n in (1, len(records)) for law in LAWS]
    with ThreadPoolExecutor(WORKERS) as pool:
        found = list(pool.map(lambda of: fit_law(of[0], records[: of[1]], own / of[0].name), asked))
    rows = []
    for (law, n), of in zip(asked, found, strict=True):
        told = sum("does not explain" in line or "is no noise" in line for line in of["findings"])
        what = "onsets" if n == 1 else "onsets and strain"
        of_parts = f"{told} of {len(of['parts'])}"
        rows.append([f"`{law.name}`", what, *left_by(of), of_parts, str(of["runs"]["all"])])
    header = ["law of the fit", "records", "left of onsets over their error (chance)",
              "left of strain over its deviation", "parts said not to be explained", "runs"]  # fmt: skip
    return table(header, rows)


def write(folder: Path, _: Path) -> dict[str, str]:
    return {"twins": table_of(fit_twins(TWINS, folder), folder), "laws": laws_table(folder)}


if __name__ == "__main__":
    sys.exit(renew_from_runs(__file__, __doc__, "fit.md", write))
