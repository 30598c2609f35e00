# SPDX-License-Identifier: BSD-3-Clause
"""What is read off one run for the table: from run.json, fronts.csv, energy.csv and static.csv, by the
definitions of docs/theory.md."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.files import DataError, number, read_json_table
from slipfront.folder import result_file
from slipfront.read import Front, read_fronts, read_static

Cell = float | int | str
BOTH, NONE = "both", "none"


@dataclass(frozen=True)
class Run:
    """What there is of a run without its histories."""

    info: dict[str, Any]
    file: Path  # run.json
    fronts: list[Front]
    contact_m: tuple[float, float]  # outermost nodes under pressure before the event

    def fact(self, key: str) -> float:
        return number(self.file, self.info, key)

    @property
    def c_L_m_per_s(self) -> float:
        return self.fact("wave_speeds.c_L_m_per_s")

    @property
    def longest(self) -> Front | None:
        return max(self.fronts, key=lambda front: front.length_m, default=None)

    def told(self, front: Front, entry: str) -> str:
        """What run.json says of a front in words."""
        for known in self.info.get("fronts", []):
            if known.get("id") == front.id:
                return str(known.get(entry, ""))
        return ""


@dataclass(frozen=True)
class Quantity:
    """A column of the table. `words`: the values it may have, of one that is no number."""

    name: str
    unit: str
    long_name: str
    of: Callable[[Run], Cell]
    words: tuple[str, ...] = ()


def largest(values: np.ndarray) -> float:
    defined = values[~np.isnan(values)]
    return float(defined.max()) if len(defined) else np.nan


def median(values: np.ndarray) -> float:
    defined = values[~np.isnan(values)]
    return float(np.median(defined)) if len(defined) else np.nan


def of_longest(measure: Callable[[Run, Front], Cell], without: Cell) -> Callable[[Run], Cell]:
    """A measure of the longest front; `without` where there is none."""

    def value(run: Run) -> Cell:
        front = run.longest
        return without if front is None else measure(run, front)

    return value


def largest_of_all(run: Run) -> float:
    return largest(np.concatenate([[np.nan], *(f.v_tip_m_per_s for f in run.fronts)])) / run.c_L_m_per_s


def slipped_length_m(run: Run) -> float:
    """Length of the union of the fronts' paths."""
    covered, reached = 0.0, -np.inf
    for from_m, to_m in sorted((float(f.x_m.min()), float(f.x_m.max())) for f in run.fronts):
        covered += max(0.0, to_m - max(from_m, reached))
        reached = max(reached, to_m)
    return covered


def slipped_share(run: Run) -> float:
    return slipped_length_m(run) / (run.contact_m[1] - run.contact_m[0])


def reached_ends(run: Run) -> str:
    """Ends of the contact at which a front has arrived."""
    ends = {front.direction for front in run.fronts if run.told(front, "end") == "contact_end"}
    if len(ends) == 2:
        return BOTH
    return {frozenset({1}): "right", frozenset({-1}): "left"}.get(frozenset(ends), NONE)


def n_that(entry: str, word: str) -> Callable[[Run], Cell]:
    return lambda run: sum(run.told(front, entry) == word for front in run.fronts)


def energy(term: str) -> Callable[[Run], Cell]:
    return lambda run: run.fact(f"energy_at_end.{term}_J_per_m")


def energy_change(term: str) -> Callable[[Run], Cell]:
    key = f"{term}_J_per_m"
    return lambda run: run.fact(f"energy_at_end.{key}") - run.fact(f"energy_at_start.{key}")


def work(name: str, meaning: str) -> Quantity:
    return Quantity(f"{name}_J_per_m", "J m-1", meaning, energy(name))


MODES = ("crack", "pulse", "mixed", NONE)
ENDS = ("arrest", "meets_front", "contact_end", "record_end", NONE)

QUANTITIES = (
    Quantity("n_fronts", "1", "fronts found", lambda run: len(run.fronts)),
    Quantity("n_arrested", "1", "fronts that end by arrest", n_that("end", "arrest")),
    Quantity("v_tip_largest_over_c_L", "1", "largest V_tip/c_L at any node of any front", largest_of_all),
    Quantity("longest_front_v_tip_largest_over_c_L", "1", "largest V_tip/c_L of the longest front",
             of_longest(lambda run, f: largest(f.v_tip_m_per_s) / run.c_L_m_per_s, np.nan)),
    Quantity("longest_front_v_tip_median_over_c_L", "1", "median V_tip/c_L of the longest front's nodes",
             of_longest(lambda run, f: median(f.v_tip_m_per_s) / run.c_L_m_per_s, np.nan)),
    Quantity("longest_front_slip", "", "kind of slip of the longest front",
             of_longest(lambda run, f: run.told(f, "mode"), NONE), MODES),
    Quantity("longest_front_end", "", "how the longest front ends",
             of_longest(lambda run, f: run.told(f, "end"), NONE), ENDS),
    Quantity("longest_front_length_m", "m", "length of the longest front's path",
             of_longest(lambda run, f: f.length_m, 0.0)),
    Quantity("longest_front_direction", "1", "direction of the longest front along x, +1 or -1",
             of_longest(lambda run, f: f.direction, np.nan)),
    Quantity("longest_front_start_x_m", "m", "where the longest front starts",
             of_longest(lambda run, f: float(f.x_m[0]), np.nan)),
    Quantity("slipped_length_m", "m", "length of interface that fronts have run over", slipped_length_m),
    Quantity("slipped_share", "1", "slipped length over the length in contact before", slipped_share),
    Quantity("reached_ends", "", "ends of the contact that a front has reached", reached_ends,
             ("left", "right", BOTH, NONE)),
    Quantity("strain_energy_change_J_per_m", "J m-1", "strain energy at the end less that at the start",
             energy_change("strain")),
    Quantity("kinetic_energy_J_per_m", "J m-1", "kinetic energy at the end", energy("kinetic")),
    work("friction_work", "work of friction"),
    work("trigger_work", "work of the trigger's forces"),
    work("damping_work", "work of the stiffness damping"),
    Quantity("end_s", "s", "time at the end of the event", lambda run: run.fact("time_s")),
    Quantity("end_reason", "", "why the event ended", lambda run: str(run.info.get("end", "")),
             ("end_time", "quiet")),
)  # fmt: skip


def contact_of(columns: dict[str, np.ndarray], file: Path) -> tuple[float, float]:
    pressed = columns["x_m"][columns["p_s_Pa"] > 0]
    if len(pressed) < 2:
        raise DataError(f"{file}: fewer than two nodes are in contact before the event")
    return float(pressed[0]), float(pressed[-1])


def read_outcome(place: Path) -> dict[str, Cell]:
    """By the names of QUANTITIES."""
    run = Run(
        info=read_json_table(result_file(place / "run.json")),
        file=place / "run.json",
        fronts=read_fronts(place / "fronts.csv"),
        contact_m=contact_of(read_static(place / "static.csv"), place / "static.csv"),
    )
    return {quantity.name: quantity.of(run) for quantity in QUANTITIES}
