# SPDX-License-Identifier: BSD-3-Clause
"""What is read off one run for the table: from run.json, fronts.csv, static.csv and the resolved case, by the
definitions of docs/theory.md. Fronts count from where they leave the trigger zone or the nucleation patch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.files import DataError, is_number, number, read_json_table, read_toml
from slipfront.folder import result_file
from slipfront.read import SPEED_KINDS, Front, entry, read_fronts, read_static

Cell = float | int | str
Interval = tuple[float, float]
BOTH, NONE = "both", "none"
ROUNDING = 1e-9  # of positions, over the length in contact


def without(path: Interval, zones: list[Interval]) -> list[Interval]:
    """Parts of a path outside zones, in ascending order."""
    parts, start = [], path[0]
    for from_m, to_m in sorted(zones):
        if from_m > start:
            parts.append((start, min(from_m, path[1])))
        start = max(start, to_m)
    parts.append((start, path[1]))
    return [(a, b) for a, b in parts if b > a]


def length_of(parts: list[Interval]) -> float:
    """Length of the union."""
    covered, reached = 0.0, -np.inf
    for from_m, to_m in sorted(parts):
        covered += max(0.0, to_m - max(from_m, reached))
        reached = max(reached, to_m)
    return covered


@dataclass(frozen=True)
class Run:
    """What there is of a run without its histories."""

    info: dict[str, Any]
    file: Path  # run.json
    all_fronts: list[Front]
    x_m: np.ndarray  # nodes, ascending
    least_front_m: float  # length below which slip that spreads is no front of its own
    contact_m: Interval  # outermost nodes under pressure before the event
    driven_m: list[Interval]  # where the event's trigger makes the nodes slip
    heard_m: list[Interval]  # next to absorbing edges, where these change the onsets

    def fact(self, key: str) -> float:
        return number(self.file, self.info, key)

    @property
    def rounding_m(self) -> float:
        return ROUNDING * (self.contact_m[1] - self.contact_m[0])

    @property
    def c_L_m_per_s(self) -> float:
        return self.fact("wave_speeds.c_L_m_per_s")

    def path(self, front: Front) -> list[Interval]:
        """What a front has run over by itself, of what was in contact."""
        from_m, to_m = self.contact_m
        path_m = max(float(front.x_m.min()), from_m), min(float(front.x_m.max()), to_m)
        return without(path_m, self.driven_m)

    def length_m(self, front: Front) -> float:
        return length_of(self.path(front))

    @cached_property
    def fronts(self) -> list[Front]:
        """Those that leave the zone in which the trigger makes the nodes slip."""
        return [front for front in self.all_fronts if self.length_m(front) > self.rounding_m]

    def speeds(self, front: Front) -> np.ndarray:
        """V_tip/c_L where something travels: where `speed_kind` says so, away from absorbing edges."""
        is_speed = np.isin(front.speed_kind, (SPEED_KINDS[0], ""))  # empty where the file has none
        for from_m, to_m in self.heard_m:
            is_speed &= (front.x_m < from_m) | (front.x_m > to_m)
        found = front.v_tip_m_per_s[is_speed] / self.c_L_m_per_s
        return found[~np.isnan(found)]

    @property
    def longest(self) -> Front | None:
        return max(self.fronts, key=self.length_m, default=None)

    def told(self, front: Front, entry: str) -> str:
        """What run.json says of a front in words."""
        for known in self.info.get("fronts", []):
            if known.get("id") == front.id:
                return str(known.get(entry, ""))
        return ""

    def slipped_by(self, front: Front) -> Interval:
        """What a front has run over, and what it met ahead: that may be too short for a front of its own."""
        from_m, to_m = float(front.x_m.min()), float(front.x_m.max())
        met_m = self.least_front_m if self.told(front, "end") == "meets_front" else 0.0
        return (from_m, to_m + met_m) if front.direction > 0 else (from_m - met_m, to_m)

    def is_reached(self, direction: int) -> bool:
        """Whether slip has come to the end of contact in a direction without a gap, from the trigger zone or
        the patch, else from where the longest front starts. An end inside the zone is not reached."""
        if self.longest is None:
            return False
        ahead = direction * self.x_m  # positions along the direction
        end_m = direction * self.contact_m[direction > 0] - self.rounding_m
        edges = [direction * edge for zone in self.driven_m if self.touches(zone) for edge in zone]
        if edges and max(edges) >= end_m:
            return False
        at_m = max(edges, default=direction * float(self.longest.x_m[0]))
        parts = [sorted(direction * x for x in self.slipped_by(front)) for front in self.all_fronts]
        for from_m, to_m in sorted(parts):
            if not ((ahead > at_m + self.rounding_m) & (ahead < from_m - self.rounding_m)).any():
                at_m = max(at_m, to_m)
        return at_m >= end_m

    def touches(self, zone: Interval) -> bool:
        return zone[0] < self.contact_m[1] and zone[1] > self.contact_m[0]


@dataclass(frozen=True)
class Quantity:
    """A column of the table. `words`: the values it may have, of one that is no number."""

    name: str
    unit: str
    long_name: str
    of: Callable[[Run], Cell]
    words: tuple[str, ...] = ()


def largest(values: np.ndarray) -> float:
    return float(values.max()) if len(values) else np.nan


def median(values: np.ndarray) -> float:
    return float(np.median(values)) if len(values) else np.nan


def of_longest(measure: Callable[[Run, Front], Cell], otherwise: Cell) -> Callable[[Run], Cell]:
    """A measure of the longest front; `otherwise` where there is none."""

    def value(run: Run) -> Cell:
        front = run.longest
        return otherwise if front is None else measure(run, front)

    return value


def largest_of_all(run: Run) -> float:
    return largest(np.concatenate([np.empty(0), *map(run.speeds, run.fronts)]))


def slipped_length_m(run: Run) -> float:
    return length_of([part for front in run.fronts for part in run.path(front)])


def slipped_share(run: Run) -> float:
    whole_m = length_of(without(run.contact_m, run.driven_m))
    return slipped_length_m(run) / whole_m if whole_m > 0 else np.nan


def reached_ends(run: Run) -> str:
    """Ends of the contact that slip has come to without a gap."""
    ends = [name for name, direction in (("left", -1), ("right", 1)) if run.is_reached(direction)]
    return BOTH if len(ends) == 2 else (*ends, NONE)[0]


def expected(key: str) -> Callable[[Run], Cell]:
    """What the tractions before the event let expect, by run.json; NaN where undefined or not told."""

    def value(run: Run) -> Cell:
        found: Any = run.info.get("rupture")
        for part in key.split("."):
            found = found.get(part) if isinstance(found, dict) else None
        return float(found) if is_number(found) else np.nan

    return value


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
    Quantity("n_fronts", "1", "fronts that run beyond the trigger zone", lambda run: len(run.fronts)),
    Quantity("n_arrested", "1", "fronts that end by arrest", n_that("end", "arrest")),
    Quantity("v_tip_largest_over_c_L", "1", "largest V_tip/c_L at any node of any front", largest_of_all),
    Quantity("longest_front_v_tip_largest_over_c_L", "1", "largest V_tip/c_L of the longest front",
             of_longest(lambda run, f: largest(run.speeds(f)), np.nan)),
    Quantity("longest_front_v_tip_median_over_c_L", "1", "median V_tip/c_L of the longest front's nodes",
             of_longest(lambda run, f: median(run.speeds(f)), np.nan)),
    Quantity("longest_front_slip", "", "kind of slip of the longest front",
             of_longest(lambda run, f: run.told(f, "mode"), NONE), MODES),
    Quantity("longest_front_end", "", "how the longest front ends",
             of_longest(lambda run, f: run.told(f, "end"), NONE), ENDS),
    Quantity("longest_front_length_m", "m", "length of the longest front's path beyond the trigger zone",
             of_longest(lambda run, f: run.length_m(f), 0.0)),
    Quantity("longest_front_direction", "1", "direction of the longest front along x, +1 or -1",
             of_longest(lambda run, f: f.direction, np.nan)),
    Quantity("longest_front_start_x_m", "m", "where the longest front starts",
             of_longest(lambda run, f: float(f.x_m[0]), np.nan)),
    Quantity("slipped_length_m", "m", "length beyond the trigger zone that fronts have run over",
             slipped_length_m),
    Quantity("slipped_share", "1", "slipped share beyond the trigger zone", slipped_share),
    Quantity("reached_ends", "", "ends of the contact that slip has reached without a gap", reached_ends,
             ("left", "right", BOTH, NONE)),
    Quantity("strength_excess_S_median", "1", "median strength excess S before the event",
             expected("strength_excess_S.median")),
    Quantity("nucleation_length_m", "m", "nucleation length expected before the event",
             expected("nucleation_length_m")),
    Quantity("griffith_half_length_m", "m", "half the critical crack length expected before the event",
             expected("griffith_half_length_m")),
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


def driven_zones(case: dict[str, Any], file: Path, contact_m: Interval) -> list[Interval]:
    """The trigger zone, or the nucleation patch, which a periodic plate may continue at the other edge."""
    kind = entry(case, "event", "kind")
    if kind in ("left", "right"):
        zone_m = number(file, case, "event.trigger_zone_m")
        from_m, to_m = contact_m
        return [(from_m, from_m + zone_m) if kind == "left" else (to_m - zone_m, to_m)]
    if kind != "nucleation":
        return []
    names = ("x_m", "half_length_m", "taper_m")
    x_m, half_m, taper_m = (number(file, case, f"nucleation.{name}") for name in names)
    is_periodic = entry(case, "plate", "sides") == "periodic"
    period_m = number(file, case, "plate.width_m") if is_periodic else 0.0
    reach_m = half_m + taper_m
    return [(x_m + shift - reach_m, x_m + shift + reach_m) for shift in {0.0, -period_m, period_m}]


def heard_zones(case: dict[str, Any], file: Path, static: dict[str, np.ndarray]) -> list[Interval]:
    """Within l* of absorbing edges, whose dashpots take part in the onsets of the last nodes."""
    if "absorbing" not in (entry(case, "plate", "sides"), entry(case, "base", "sides")):
        return []
    x_m = static["x_m"]
    reach_m = max(number(file, case, "fronts.l_star_m"), float(np.diff(x_m).max()))
    reach_m += ROUNDING * float(x_m[-1] - x_m[0])
    return [(float(x_m[0]), float(x_m[0]) + reach_m), (float(x_m[-1]) - reach_m, float(x_m[-1]))]


def waves_over_c_L(file: Path) -> dict[str, float]:
    """The plate's wave speeds by run.json, ascending."""
    info = read_json_table(result_file(file))
    speeds = {wave: number(file, info, f"wave_speeds.{wave}_m_per_s") for wave in ("c_R", "c_S", "c_L")}
    return {f"{wave}_over_c_L": speed / speeds["c_L"] for wave, speed in speeds.items()}


def read_outcome(place: Path) -> dict[str, Cell]:
    """By the names of QUANTITIES."""
    file = place / "case.resolved.toml"
    case, static = read_toml(result_file(file)), read_static(place / "static.csv")
    contact_m = contact_of(static, place / "static.csv")
    run = Run(
        info=read_json_table(result_file(place / "run.json")),
        file=place / "run.json",
        all_fronts=read_fronts(place / "fronts.csv"),
        x_m=static["x_m"],
        least_front_m=number(file, case, "fronts.min_length_m"),
        contact_m=contact_m,
        driven_m=driven_zones(case, file, contact_m),
        heard_m=heard_zones(case, file, static),
    )
    return {quantity.name: quantity.of(run) for quantity in QUANTITIES}
