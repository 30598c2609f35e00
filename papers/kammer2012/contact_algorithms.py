# SPDX-License-Identifier: BSD-3-Clause
"""Runs the paper's events with each contact algorithm; renews tables and picture of contact-algorithms.md."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import slipfront
from matplotlib.figure import Figure
from slipfront.figures.drawing import write_figure
from slipfront.figures.style import PAGE_MM, RC
from slipfront.files import read_json
from slipfront.opened import open_run
from slipfront.pages import Tables, command_to_renew, table
from slipfront.read import Front

EVENTS = ("left", "spontaneous", "right", "spontaneous_mu_k_1.0")
LAWS: dict[str, dict[str, Any]] = {
    "paper's law": {},
    "strength relaxed over 0.5 us": {
        "friction.regularisation": "strength",
        "friction.relaxation_time_s": 0.5e-6,
        "friction.relaxation_length_m": np.inf,
    },
}
OUTPUT = {"output.snapshot_times_s": [], "output.history_interval_s": 1e-5}
BASE = "direct 18"  # the cases' own
SUBSTEPS = (9, 18, 36, 72)
ALGORITHMS = ("direct", "predictor_corrector")
PERTURBED = "direct 18, E larger by 1e-9"
VARIANTS: dict[str, dict[str, Any]] = {
    f"{algorithm} {n}": {"contact.algorithm": algorithm, "time.interface_substeps": n}
    for algorithm in ALGORITHMS
    for n in SUBSTEPS
} | {PERTURBED: {"material.youngs_modulus_Pa": 2.6000000026e9}}
# What is compared: change, from, to.
SPEED_PAIRS = (
    ("E larger by 1e-9", BASE, PERTURBED),
    ("direct, 72 for 18 sub-steps", BASE, "direct 72"),
    ("predictor_corrector, 72 for 18", "predictor_corrector 18", "predictor_corrector 72"),
    *((f"algorithm, at {n}", f"direct {n}", f"predictor_corrector {n}") for n in (18, 36, 72)),
)
NEAR_NUCLEATION_M = 5e-3  # the speed diverges there


@dataclass(frozen=True)
class Event:
    fronts: list[Front]
    friction_work_J_per_m: float

    def main(self, direction: int) -> Front | None:
        """The longest front in a direction, where it is longer than 20 mm."""
        long = [f for f in self.fronts if f.direction == direction and f.length_m > 20e-3]
        return max(long, key=lambda f: f.length_m, default=None)


def run(event: str, folder: Path, changes: dict[str, Any]) -> Event:
    if not folder.exists():
        case = Path(__file__).with_name(f"{event}.toml")
        slipfront.run(case, changes | OUTPUT, output=folder, progress=False)
    found = open_run(folder)
    return Event(found.front_list, found.fact("energy_at_end.friction_work_J_per_m"))


def compare(a: Front, b: Front) -> np.ndarray:
    """|V' - V|/V at nodes of both, without those beside nucleation and triggers."""
    _, i, j = np.intersect1d(np.round(1e9 * a.x_m), np.round(1e9 * b.x_m), return_indices=True)
    counts = np.abs(a.x_m[i] - a.x_m[0]) > NEAR_NUCLEATION_M
    counts &= np.isfinite(a.dynamic_ratio[i])
    v, w = a.v_tip_m_per_s[i][counts], b.v_tip_m_per_s[j][counts]
    dv = np.abs(w - v) / v
    return dv[np.isfinite(dv)]


def arrow(direction: int) -> str:
    return "to +x" if direction > 0 else "to -x"


def two(values: np.ndarray) -> str:
    """Median and 90th percentile, as percentages."""
    return f"{100 * np.median(values):.2g}, {100 * np.percentile(values, 90):.2g}"


def rows_of(law: str, event: str, results: dict[str, Event]) -> list[list[str]]:
    rows = []
    for direction in (-1, 1):
        of_variant = {name: result.main(direction) for name, result in results.items()}
        if of_variant[BASE] is None:
            continue
        cells = [law, f"{event} {arrow(direction)}"]
        for _, from_, to in SPEED_PAIRS:
            a, b = of_variant[from_], of_variant[to]
            cells.append(two(compare(a, b)) if a is not None and b is not None else "no such front")
        rows.append(cells)
    return rows


def draw(all_results: dict[str, dict[str, dict[str, Event]]], c_L: float) -> Figure:
    styles = {
        "direct 18": ("#000000", "-"),
        "direct 36": ("#88ccee", "-"),
        "predictor_corrector 18": ("#d55e00", "--"),
    }
    figure = Figure(figsize=(PAGE_MM / 25.4, 6.5), layout="constrained")
    axes = figure.subplots(len(EVENTS), len(LAWS), sharex=True, sharey="col", squeeze=False)
    for column, (law, of_event) in enumerate(all_results.items()):
        for row, (event, results) in enumerate(of_event.items()):
            ax = axes[row, column]
            for name, (colour, line) in styles.items():
                for direction in (-1, 1):
                    front = results[name].main(direction)
                    if front is None:
                        continue
                    v = np.where(np.isfinite(front.dynamic_ratio), front.v_tip_m_per_s, np.nan) / c_L
                    ax.plot(
                        1e3 * front.x_m,
                        v,
                        color=colour,
                        linestyle=line,
                        linewidth=0.9,
                        label=f"{name} sub-steps" if direction > 0 or event == "left" else None,
                    )
            ax.set_title(f"{event}, {law}", loc="left")
            ax.set_ylim(0, 3.2)
        axes[-1, column].set_xlabel("$x$ (mm)")
    for ax in axes[:, 0]:
        ax.set_ylabel("$V_\\mathrm{tip}/c_\\mathrm{L}$")
    axes[0, 0].legend()
    return figure


def write(folder: Path, picture: Path) -> Tables:
    speeds: list[list[str]] = []
    works: list[list[str]] = []
    all_results: dict[str, dict[str, dict[str, Event]]] = {law: {} for law in LAWS}
    c_L = np.nan
    for law, law_changes in LAWS.items():
        for event in EVENTS:
            results = {}
            for name, changes in VARIANTS.items():
                out = folder / f"{law}, {event}, {name}".replace(", ", "-").replace(" ", "_")
                results[name] = run(event, out, law_changes | changes)
                c_L = read_json(out / "run.json")["wave_speeds"]["c_L_m_per_s"]
            all_results[law][event] = results
            speeds += rows_of(law, event, results)
            cells = [
                ", ".join(f"{results[f'{algorithm} {n}'].friction_work_J_per_m:.1f}" for n in SUBSTEPS)
                for algorithm in ALGORITHMS
            ]
            works.append([law, event, *cells])
            print(f"{law}, {event}: done", flush=True)
    with matplotlib.rc_context(RC):
        write_figure(picture, draw(all_results, c_L))
    header = ["law", "main front", *(what for what, _, _ in SPEED_PAIRS)]
    return {"table": table(header, speeds) + "\n" + table(["law", "event", *ALGORITHMS], works)}


if __name__ == "__main__":
    page = Path(__file__).with_name("contact-algorithms.md")
    sys.exit(command_to_renew(__file__, __doc__, page, write))
