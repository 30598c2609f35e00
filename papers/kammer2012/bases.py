# SPDX-License-Identifier: BSD-3-Clause
"""What remains of the paper's directionality, which its rigid base explains, and of its energy criterion when
the base is deformable, down to a base of the plate's own material.

    python papers/kammer2012/bases.py -o DIR [--quick]

writes bases.csv (a row per base), bases_points.csv (a row per point of the main fronts) and bases.json."""

from __future__ import annotations

import csv
import math
import sys
from argparse import Namespace
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import slipfront
from analysis import cell, fit_json, number, write_json
from commands import Progress, parser_of, run_command
from events import BINS, CRITERIA, Collapse, Event, event_of, joined, median
from main_fronts import MainFront, collapse_without_tails, first_front, main_fronts

from cases import QUICK, Run, paper_cases

# The plate's own material, aluminium, steel, and the rigid plane: E, nu, rho at room temperature of
# handbooks.
BASES: dict[str, tuple[float, float, float] | None] = {
    "PMMA": (2.6e9, 0.37, 1200),
    "aluminium": (70e9, 0.33, 2700),
    "steel": (210e9, 0.30, 7850),
    "rigid": None,
}
HEIGHT_M, YOUNGS_MODULUS_PA, TILT_M = 0.1, 2.6e9, (0.37e-3, 0.037e-3)  # of the paper's plate
# Held triggers: the brief left one of the plate on the plane tears it off a base of PMMA.
TRIGGERS = {
    "left": {"event.trigger_zone_m": 20e-3, "event.trigger_over_missing": 20},
    "right": {"event.trigger_zone_m": 10e-3, "event.trigger_over_missing": 5},
}
HELD = {"event.trigger_ramp_s": 5e-6, "event.trigger_duration_s": math.inf}


def tilt_factor(base: str) -> float:
    """The compliance of plate and base in uniform compression, over that of the plate."""
    material = BASES[base]
    return 1 if material is None else 1 + HEIGHT_M / material[0] / (HEIGHT_M / YOUNGS_MODULUS_PA)


def runs_on(base: str, quick: bool) -> list[Run]:
    """The paper's four events on a base: a body as high and wide as the plate, held at its bottom. The tilt
    is larger by the share of compression that the base takes, so that the nominal pressure is the paper's."""
    changes: dict[str, Any] = {
        "output.snapshot_times_s": [],
        "output.history_interval_s": 1e-5,
        "output.energy_interval_s": 1e-5,
    }
    material = BASES[base]
    if material is not None:
        E, nu, rho = material
        changes |= {
            "base.kind": "body",
            "base.height_m": HEIGHT_M,
            "base.youngs_modulus_Pa": E,
            "base.poissons_ratio": nu,
            "base.density_kg_per_m3": rho,
            "loading.tilt_left_m": TILT_M[0] * tilt_factor(base),
            "loading.tilt_right_m": TILT_M[1] * tilt_factor(base),
        }
    return [
        Run(
            run.name,
            run.event,
            run.changes
            | changes
            | {"title": f"{run.name} on {base}"}
            | (TRIGGERS[run.event] | HELD if run.event in TRIGGERS else {}),
        )
        for run in paper_cases(quick)
    ]


@dataclass(frozen=True)
class OnBase:
    """The events on one base."""

    name: str
    events: list[Event]

    @property
    def mains(self) -> list[MainFront]:
        return main_fronts(self.events)

    @property
    def low_mu_k(self) -> list[MainFront]:
        return [main for main in self.mains if main.event.mu_k < 0.9]

    def by_direction(self) -> dict[int, list[MainFront]]:
        return {d: [main for main in self.low_mu_k if main.front.direction == d] for d in (1, -1)}

    def speed_ratio(self) -> Any:
        """V_tip against the shear over V_tip along it at equal t_d/p_d: main fronts of mu_k = 0.6."""
        along, against = (
            joined([(m.points.dynamic_ratio, m.points.v_m_per_s) for m in mains])
            for mains in self.by_direction().values()
        )
        return slipfront.ratio_at_equal_x(against, along, bins=BINS)

    def pressure_change(self) -> tuple[float, float]:
        """From the state before the event to the onset, over that before it: medians over the points of the
        main fronts along and against the shear."""
        along, against = (
            median(np.concatenate([np.empty(0), *(m.points.pressure_ratio for m in mains)]) - 1)
            for mains in self.by_direction().values()
        )
        return along, against


def fastest_over_c_L(event: Event) -> float:
    speeds = [event.with_speed(front).v_m_per_s / event.c_L for front in event.fronts]
    return float(np.concatenate(speeds).max()) if any(v.size for v in speeds) else math.nan


def event_json(event: Event) -> dict[str, Any]:
    fronts = [first_front(event, direction) for direction in (-1, 1)]
    return {
        "name": event.name,
        "critical_shear_m": number(event.critical_shear_m),
        "peak_x_m": event.peak_x_m,
        "fastest_over_c_L": number(fastest_over_c_L(event)),
        "main_fronts": [
            {"direction": f.direction, "length_m": f.length_m, "mode": f.mode, "end": f.end}
            for f in fronts
            if f is not None
        ],
    }


def base_json(on: OnBase, collapse: Collapse) -> dict[str, Any]:
    material, r, (along, against) = BASES[on.name], on.speed_ratio(), on.pressure_change()
    found: dict[str, Any] = {"name": on.name, "rigid": material is None}
    if material is not None:
        names = ("youngs_modulus_Pa", "poissons_ratio", "density_kg_per_m3")
        found |= {name: float(value) for name, value in zip(names, material, strict=True)}
    return found | {
        "tilt_factor": float(tilt_factor(on.name)),
        "speed_ratio": {
            "median": number(r.median),
            "low": number(r.low),
            "high": number(r.high),
            "n_bins": r.n_bins,
        },
        "pressure_change": {"along": number(along), "against": number(against)},
        "share_in_paper_band": number(collapse.share_in_band),
        "n_points": collapse.n_points,
        "fit": fit_json(collapse),
        "spread": {name: number(collapse.fronts[name].median_relative) for name in CRITERIA},
        "events": [event_json(event) for event in on.events],
    }


def write_csv(file: Path, header: str, rows: Iterable[Iterable[Any]]) -> None:
    """Numbers to six digits, empty where undefined."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header.split(","))
        writer.writerows([cell(v) if isinstance(v, float) else v for v in row] for row in rows)


def base_row(found: dict[str, Any]) -> list[Any]:
    """Of bases.csv, from what bases.json has."""
    values = [
        found["name"],
        found["tilt_factor"],
        *found["speed_ratio"].values(),
        *found["pressure_change"].values(),
        found["share_in_paper_band"],
        found["n_points"],
        *found["spread"].values(),
    ]
    return ["" if value is None else value for value in values]


def point_rows(on: OnBase) -> list[list[Any]]:
    """Of bases_points.csv."""
    return [
        [
            on.name,
            m.event.name,
            m.front.direction,
            f"{x:.10g}",
            float(v / m.event.c_L),
            *map(float, others),
            int(tail),
        ]
        for m in on.mains
        for x, v, *others, tail in zip(
            m.points.x_m,
            m.points.v_m_per_s,
            m.points.dynamic_ratio,
            m.points.energy_rise,
            m.points.pressure_ratio,
            m.in_tail,
            strict=True,
        )
    ]


def lines_of(bases: list[dict[str, Any]]) -> list[str]:
    """For people."""

    def text(value: float | None, unit: str = "", factor: float = 1) -> str:
        return "-" if value is None else f"{factor * value:.3g}{unit}"

    lines = [
        f"{'base':<10} {'V against / along (range)':>26} {'pressure along, against':>22} {'in band':>8} "
        f"{'spread: t/p, energy':>20}"
    ]
    for b in bases:
        r, p, s = b["speed_ratio"], b["pressure_change"], b["spread"]
        ratio = f"{text(r['median'])} ({text(r['low'])} to {text(r['high'])})"
        pressure = f"{text(p['along'], ' %', 100)}, {text(p['against'], ' %', 100)}"
        spread = f"{text(s['dynamic_ratio'])}, {text(s['energy_rise'])}"
        band = text(b["share_in_paper_band"], " %", 100)
        lines.append(f"{b['name']:<10} {ratio:>26} {pressure:>22} {band:>8} {spread:>20}")
    return lines


def study(options: Namespace) -> list[str]:
    """Lines to print."""
    runs = {base: runs_on(base, options.quick) for base in BASES}
    every = [run for of_base in runs.values() for run in of_base]
    cases = [run.case() for run in every]
    events: list[Any] = [None] * len(every)
    progress, warnings = Progress(len(every)), list[str]()
    work = f"study base{' --quick' if options.quick else ''}"
    with slipfront.Batch(options.output, work, threads=options.threads, overwrite=options.overwrite) as batch:

        def done(k: int, found: slipfront.BatchEvent) -> None:
            events[k] = event_of(every[k].name, cases[k], found)
            if found.blew_up:
                warnings.append(f"{every[k].changes['title']}: {found.reason}")
            progress.step()

        batch.run(cases, done)
        rest = iter(events)
        on_bases = [OnBase(base, [next(rest) for _ in of_base]) for base, of_base in runs.items()]
        bases = [base_json(on, collapse_without_tails(on.mains)) for on in on_bases]
        found = {
            "version": slipfront.version(),
            "quick": options.quick,
            "n_runs": batch.n_runs,
            "n_quiet": batch.n_quiet,
            "warnings": warnings,
            "bases": bases,
        }
        write_json(batch.folder / "bases.json", found)
        write_csv(
            batch.folder / "bases.csv",
            "base,tilt_factor,speed_ratio,speed_ratio_low,speed_ratio_high,n_bins,pressure_change_along,"
            "pressure_change_against,share_in_paper_band,n_points,spread_static_ratio,spread_dynamic_ratio,"
            "spread_energy_rise",
            map(base_row, bases),
        )
        write_csv(
            batch.folder / "bases_points.csv",
            "base,event,direction,x_m,v_tip_over_c_L,t_d_over_p_d,energy_rise,p_r_over_p_s,in_tail",
            (row for on in on_bases for row in point_rows(on)),
        )
    return [
        *lines_of(bases),
        f"{batch.n_runs} runs, {batch.n_quiet} of which ended before time.end_s since nothing moved",
        *(f"note: {text}" for text in warnings),
        f"results: {options.output}",
    ]


def main() -> int:
    parser = parser_of("The events of Kammer et al. (2012) on deformable bases.")
    size = QUICK["plate.element_size_m"] * 1e3
    parser.add_argument("--quick", action="store_true", help=f"elements of {size:g} mm, to try the command")
    return run_command(parser, study)


if __name__ == "__main__":
    sys.exit(main())
