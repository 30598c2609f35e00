# SPDX-License-Identifier: BSD-3-Clause
"""What is read off one run for the table: from run.json, fronts.csv, static.csv and the resolved case, by the
definitions of docs/theory.md. Fronts count from where they leave the trigger zone or the nucleation patch.
Of a sequence of events it is read off sequence.json and events.csv."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.files import DataError, is_number, number, read_json_table
from slipfront.folder import RUN, SEQUENCE, result_file
from slipfront.notes import notes_of
from slipfront.opened import OpenRun, open_run
from slipfront.read import SPEED_KINDS, Front, is_sequence, median, ratio, read_columns

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


class Slipped:
    """What the fronts of a run have run over by themselves. Its histories are not needed."""

    def __init__(self, run: OpenRun) -> None:
        self.run = run

    @cached_property
    def contact_m(self) -> Interval:
        """Outermost nodes under pressure before the event."""
        pressed = self.run.x_m[self.run.tractions["p_s_Pa"].to_numpy() > 0]
        if len(pressed) < 2:
            raise DataError(
                f"{self.run.folder / 'static.csv'}: fewer than two nodes are in contact before the event"
            )
        return float(pressed[0]), float(pressed[-1])

    @cached_property
    def driven_m(self) -> list[Interval]:
        """The trigger zone, or the nucleation patch, which a periodic plate continues at the other edge."""
        run = self.run
        if run.kind in ("left", "right"):
            zone_m = run.parameter("event.trigger_zone_m")
            from_m, to_m = self.contact_m
            return [(from_m, from_m + zone_m) if run.kind == "left" else (to_m - zone_m, to_m)]
        if run.kind != "nucleation":
            return []
        names = ("x_m", "half_length_m", "taper_m")
        x_m, half_m, taper_m = (run.parameter(f"nucleation.{name}") for name in names)
        is_periodic = run.entry("plate", "sides") == "periodic"
        period_m = run.parameter("plate.width_m") if is_periodic else 0.0
        reach_m = half_m + taper_m
        return [(x_m + shift - reach_m, x_m + shift + reach_m) for shift in {0.0, -period_m, period_m}]

    @cached_property
    def heard_m(self) -> list[Interval]:
        """Within l* of absorbing edges, whose dashpots take part in the onsets of the last nodes."""
        if "absorbing" not in (self.run.entry("plate", "sides"), self.run.entry("base", "sides")):
            return []
        x_m = self.run.x_m
        reach_m = max(self.run.parameter("fronts.l_star_m"), float(np.diff(x_m).max()))
        reach_m += ROUNDING * float(x_m[-1] - x_m[0])
        return [(float(x_m[0]), float(x_m[0]) + reach_m), (float(x_m[-1]) - reach_m, float(x_m[-1]))]

    @property
    def rounding_m(self) -> float:
        return ROUNDING * (self.contact_m[1] - self.contact_m[0])

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
        return [front for front in self.run.front_list if self.length_m(front) > self.rounding_m]

    def travels(self, front: Front) -> np.ndarray:
        """Where something travels: where `speed_kind` says so, away from absorbing edges. [points]"""
        is_speed = np.isin(front.speed_kind, (SPEED_KINDS[0], ""))  # empty where the file has none
        for from_m, to_m in self.heard_m:
            is_speed &= (front.x_m < from_m) | (front.x_m > to_m)
        return is_speed & ~np.isnan(front.v_tip_m_per_s)

    def speeds(self, front: Front) -> np.ndarray:
        """V_tip/c_L where something travels."""
        return front.v_tip_m_per_s[self.travels(front)] / self.run.c_L_m_per_s

    def points(self, front: Front) -> np.ndarray:
        """t_s/p_s and V_tip in m/s where something travels by itself. [2, points]"""
        own = self.travels(front)
        for from_m, to_m in self.driven_m:
            own &= (front.x_m < from_m) | (front.x_m > to_m)
        return np.array([front.static_ratio[own], front.v_tip_m_per_s[own]])

    @property
    def longest(self) -> Front | None:
        return max(self.fronts, key=self.length_m, default=None)

    def slipped_by(self, front: Front) -> Interval:
        """What a front has run over, and what it met ahead."""
        from_m, to_m = float(front.x_m.min()), float(front.x_m.max())
        meets = self.run.told(front, "end") == "meets_front"
        # It may be too short for a front of its own.
        met_m = self.run.parameter("fronts.min_length_m") if meets else 0.0
        return (from_m, to_m + met_m) if front.direction > 0 else (from_m - met_m, to_m)

    def is_reached(self, direction: int) -> bool:
        """Whether slip has come to the end of contact in a direction without a gap, from the trigger zone or
        the patch, else from where the longest front starts. An end inside the zone is not reached."""
        if self.longest is None:
            return False
        ahead = direction * self.run.x_m  # positions along the direction
        end_m = direction * self.contact_m[direction > 0] - self.rounding_m
        edges = [direction * edge for zone in self.driven_m if self.touches(zone) for edge in zone]
        if edges and max(edges) >= end_m:
            return False
        at_m = max(edges, default=direction * float(self.longest.x_m[0]))
        parts = [sorted(direction * x for x in self.slipped_by(front)) for front in self.run.front_list]
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
    words: tuple[str, ...] = ()


OF_RUNS = (
    Quantity("n_fronts", "1", "fronts that run beyond the trigger zone"),
    Quantity("n_arrested", "1", "fronts that end by arrest"),
    Quantity("v_tip_largest_over_c_L", "1", "largest V_tip/c_L at any node of any front"),
    Quantity("longest_front_v_tip_largest_over_c_L", "1", "largest V_tip/c_L of the longest front"),
    Quantity("longest_front_v_tip_median_over_c_L", "1", "median V_tip/c_L of the longest front's nodes"),
    Quantity("longest_front_slip", "", "kind of slip of the longest front",
             ("crack", "pulse", "mixed", NONE)),
    Quantity("longest_front_end", "", "how the longest front ends",
             ("arrest", "meets_front", "contact_end", "record_end", NONE)),
    Quantity("longest_front_length_m", "m", "length of the longest front's path beyond the trigger zone"),
    Quantity("longest_front_direction", "1", "direction of the longest front along x, +1 or -1"),
    Quantity("longest_front_start_x_m", "m", "where the longest front starts"),
    Quantity("longest_front_fracture_energy_median_J_per_m2", "J m-2",
             "median fracture energy of the longest front, its breakdown work"),
    Quantity("longest_front_G_slip_over_fracture_energy_median", "1",
             "median energy release rate by the slip over fracture energy, of the longest front"),
    Quantity("longest_front_cohesive_zone_median_m", "m", "median cohesive zone of the longest front"),
    Quantity("slipped_length_m", "m", "length beyond the trigger zone that fronts have run over"),
    Quantity("slipped_share", "1", "slipped share beyond the trigger zone"),
    Quantity("reached_ends", "", "ends of the contact that slip has reached without a gap",
             ("left", "right", BOTH, NONE)),
    Quantity("strength_excess_S_median", "1", "median strength excess S before the event"),
    Quantity("nucleation_length_m", "m", "nucleation length expected before the event"),
    Quantity("critical_crack_length_m", "m", "critical crack length expected before the event"),
    Quantity("strain_energy_change_J_per_m", "J m-1", "strain energy at the end less that at the start"),
    Quantity("kinetic_energy_J_per_m", "J m-1", "kinetic energy at the end"),
    Quantity("friction_work_J_per_m", "J m-1", "work of friction"),
    Quantity("trigger_work_J_per_m", "J m-1", "work of the trigger's forces"),
    Quantity("damping_work_J_per_m", "J m-1", "work of the stiffness damping"),
    Quantity("end_s", "s", "time at the end of the event"),
    Quantity("end_reason", "", "why the event ended", ("end_time", "quiet")),
)  # fmt: skip
OF_SEQUENCES = (
    Quantity("n_events", "1", "events of the sequence"),
    Quantity("n_global_events", "1", "events in which all nodes inside slip"),
    Quantity("first_global_event", "1", "number of the first global event"),
    Quantity("largest_friction", "1", "largest F_S/F_N up to the first global event"),
    Quantity("friction_at_rest_median", "1", "median F_S/F_N at rest after global events"),
    Quantity("longest_precursor_m", "m", "longest event before the first global one"),
    Quantity("global_mean_slip_median_m", "m", "median mean slip of global events"),
    Quantity("imbalance_over_largest_energy", "1", "imbalance of energy over the largest term"),
)
QUANTITIES = (*OF_RUNS, *OF_SEQUENCES)


def undefined_or(found: Any) -> float:
    return float(found) if is_number(found) else np.nan


def as_a_crack(slipped: Slipped, front: Front) -> dict[str, Cell]:
    """Medians over the nodes beyond the trigger zone where the front's breakdown came to its end."""
    breakdown = slipped.run.breakdown
    if breakdown is None:
        return {}
    is_own = np.full(len(front.x_m), True)
    for from_m, to_m in slipped.driven_m:
        is_own &= (front.x_m < from_m) | (front.x_m > to_m)
    own = {name: values[is_own] for name, values in breakdown[front.id].items()}
    energy = own["breakdown_work_J_per_m2"]
    return {
        "longest_front_fracture_energy_median_J_per_m2": median(energy),
        "longest_front_G_slip_over_fracture_energy_median": median(ratio(own["G_slip_J_per_m2"], energy)),
        "longest_front_cohesive_zone_median_m": median(own["cohesive_zone_m"]),
    }


def of_longest(slipped: Slipped) -> dict[str, Cell]:
    """What there is without a front, and of the longest one."""
    run, front = slipped.run, slipped.longest
    if front is None:
        return {"longest_front_slip": NONE, "longest_front_end": NONE, "longest_front_length_m": 0.0}
    speeds = slipped.speeds(front)
    measured: dict[str, Cell] = {
        "longest_front_slip": run.told(front, "mode") or "",
        "longest_front_end": run.told(front, "end") or "",
        "longest_front_length_m": slipped.length_m(front),
        "longest_front_direction": front.direction,
        "longest_front_start_x_m": float(front.x_m[0]),
        **as_a_crack(slipped, front),
    }
    if len(speeds):
        measured["longest_front_v_tip_largest_over_c_L"] = float(speeds.max())
        measured["longest_front_v_tip_median_over_c_L"] = float(np.median(speeds))
    return measured


def measured(run: OpenRun) -> dict[str, Cell]:
    """By the names of OF_RUNS; NaN where undefined."""
    slipped, info = Slipped(run), run.info
    slipped_m = length_of([part for front in slipped.fronts for part in slipped.path(front)])
    whole_m = length_of(without(slipped.contact_m, slipped.driven_m))
    ends = [name for name, direction in (("left", -1), ("right", 1)) if slipped.is_reached(direction)]
    speeds = np.concatenate([np.empty(0), *map(slipped.speeds, slipped.fronts)])
    expected = info.get("rupture") or {}  # null lengths under a law that does not weaken over a slip
    at_end = {
        term: run.fact(f"energy_at_end.{term}_J_per_m")
        for term in ("strain", "kinetic", "friction_work", "trigger_work", "damping_work")
    }
    cells: dict[str, Cell] = {
        **{quantity.name: np.nan for quantity in OF_RUNS},
        **of_longest(slipped),
        "n_fronts": len(slipped.fronts),
        "n_arrested": sum(run.told(front, "end") == "arrest" for front in slipped.fronts),
        "v_tip_largest_over_c_L": float(speeds.max()) if len(speeds) else np.nan,
        "slipped_length_m": slipped_m,
        "slipped_share": slipped_m / whole_m if whole_m > 0 else np.nan,
        "reached_ends": BOTH if len(ends) == 2 else (*ends, NONE)[0],
        "strength_excess_S_median": undefined_or((expected.get("strength_excess_S") or {}).get("median")),
        "nucleation_length_m": undefined_or(expected.get("nucleation_length_m")),
        "critical_crack_length_m": 2 * undefined_or(expected.get("griffith_half_length_m")),
        "strain_energy_change_J_per_m": at_end["strain"] - run.fact("energy_at_start.strain_J_per_m"),
        "kinetic_energy_J_per_m": at_end["kinetic"],
        "friction_work_J_per_m": at_end["friction_work"],
        "trigger_work_J_per_m": at_end["trigger_work"],
        "damping_work_J_per_m": at_end["damping_work"],
        "end_s": run.fact("time_s"),
        "end_reason": str(info.get("end", "")),
    }
    return cells


def waves_over_c_L(file: Path) -> dict[str, float]:
    """The plate's wave speeds by run.json or sequence.json, ascending."""
    info = read_json_table(result_file(file))
    speeds = {wave: number(file, info, f"wave_speeds.{wave}_m_per_s") for wave in ("c_R", "c_S", "c_L")}
    return {f"{wave}_over_c_L": speed / speeds["c_L"] for wave, speed in speeds.items()}


def read_sequence(place: Path) -> dict[str, Cell]:
    """By the names of OF_SEQUENCES; NaN where undefined."""
    names = ("is_global", "length_m", "mean_slip_m", "friction_before", "friction_after")
    events = read_columns(place / "events.csv", names)
    info = read_json_table(result_file(place / SEQUENCE))
    is_global = events["is_global"] == 1
    n_before = int(np.argmax(is_global)) if is_global.any() else len(is_global)
    return {
        "n_events": len(is_global),
        "n_global_events": int(is_global.sum()),
        "first_global_event": n_before + 1 if is_global.any() else np.nan,
        "largest_friction": float(max(events["friction_before"][: n_before + 1], default=np.nan)),
        "friction_at_rest_median": median(events["friction_after"][is_global]),
        "longest_precursor_m": float(max(events["length_m"][:n_before], default=0.0)),
        "global_mean_slip_median_m": median(events["mean_slip_m"][is_global]),
        "imbalance_over_largest_energy": undefined_or(info.get("imbalance_over_largest_energy")),
    }


def teller(place: Path) -> Path:
    """The file that tells of a run or a sequence."""
    return place / (SEQUENCE if is_sequence(place) else RUN)


def notes_on(place: Path) -> list[str]:
    """Those on a run; of a sequence those on each of its events, which are of the case."""
    told = [place / RUN] if not is_sequence(place) else sorted(place.glob(f"events/*/{RUN}"))
    first, *others = [[note.text for note in notes_of(read_json_table(file))] for file in told] or [[]]
    return [note for note in first if all(note in notes for notes in others)]


def read_outcome(place: Path) -> dict[str, Cell]:
    """By the names of OF_RUNS or OF_SEQUENCES."""
    return read_sequence(place) if is_sequence(place) else measured(open_run(place))
