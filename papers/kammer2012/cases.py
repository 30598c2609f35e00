# SPDX-License-Identifier: BSD-3-Clause
"""The runs of the reproduction: changes of the paper's four events, whose case files lie beside this."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import slipfront

HERE = Path(__file__).parent
WIDTH_M = 0.2
C_L_M_PER_S = math.sqrt(2.6e9 / (1 - 0.37**2) / 1200)  # of the plate
# The paper's four events; the last is spontaneous, too.
EVENTS = ("spontaneous", "left", "right", "spontaneous_mu_k_1.0")
TRIGGERED = ("left", "right")
ALL = ("spontaneous", *TRIGGERED)
SCORECARD_STUDIES = ("mu_k", "alpha")  # that the scorecard reads
QUICK = {"plate.element_size_m": 2e-3}
# At a history spacing that keeps the files small.
SMALL: dict[str, Any] = {"output.snapshot_times_s": [], "output.history_interval_s": 2e-6}

Changes = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """A run of the reproduction: an event with changes of its case."""

    name: str  # its folder below that of the results
    event: str  # of EVENTS
    changes: Changes

    def case(self) -> Any:
        return slipfront.case(HERE / f"{self.event}.toml", self.changes)


@dataclass(frozen=True)
class Point:
    """One value of a study's parameter, with its runs, named by their event."""

    value: str  # as it stands in the case file
    number: float  # NaN for words
    runs: list[Run]


@dataclass(frozen=True)
class Study:
    """Runs that differ from the paper's in one parameter."""

    name: str
    key: str  # of the case file
    why: str
    points: list[Point]
    own_reference: bool = False  # changes are counted from the first point instead of the paper's runs


@dataclass(frozen=True)
class Variation:
    """The runs of the scorecard at another value of a numerical parameter."""

    name: str  # its folder in variations/
    key: str  # of the case file
    value: float
    events: list[Run]  # those of paper_cases
    studies: list[Study]  # SCORECARD_STUDIES


@cache
def title_of(event: str) -> str:
    return str(tomllib.loads((HERE / f"{event}.toml").read_text())["title"])


def paper_cases(quick: bool) -> list[Run]:
    """The paper's four events. quick: elements of 2 mm."""
    return [Run(event, event, QUICK if quick else {}) for event in EVENTS]


def sequences(quick: bool) -> list[Run]:
    """The paper's plate with both values of mu_k, loaded on until all nodes inside have slipped in one
    event."""
    return [
        Run(
            f"sequences/mu_k_{mu_k:.1f}",
            "spontaneous",
            SMALL
            | (QUICK if quick else {})
            | {
                "title": f"loaded on to global sliding, mu_k = {mu_k:.1f}",
                "friction.mu_k": mu_k,
                "loading.shear_speed_m_per_s": 1e-9 * C_L_M_PER_S,
                "sequence.max_events": 1000,
                "sequence.to_global_sliding": True,
                "time.end_s": 10e-3,
            },
        )
        for mu_k in (0.6, 1.0)
    ]


@dataclass(frozen=True)
class Values:
    """A study as it stands in the tables below: values of a key, or words with the changes they stand for."""

    name: str
    key: str
    why: str
    values: tuple[Any, ...]  # numbers, or triples of word, number and changes
    events: tuple[str, ...] = ALL
    also: Changes = field(default_factory=dict)  # changes of all its runs
    own_reference: bool = False
    digits: str = "g"  # of the numbers as words

    def study(self, quick: bool) -> Study:
        points = []
        for value in self.values:
            if isinstance(value, tuple):
                word, number, changes = value
            else:
                word, number, changes = format(value, self.digits), value, {self.key: value}
            base = SMALL | (QUICK if quick else {}) | self.also | changes
            runs = [Run(event, event, base | {"title": f"{event}, {word}"}) for event in self.events]
            points.append(Point(word, number, runs))
        return Study(self.name, self.key, self.why, points, self.own_reference)


def mesh(name: str, why: str, columns: tuple[int, ...], **options: Any) -> Values:
    """Over element sizes, each named by three digits of it."""
    sizes = tuple(WIDTH_M / n for n in columns)
    return Values(name, "plate.element_size_m", why, sizes, digits=".3g", **options)


FRICTION = (
    Values("mu_k", "friction.mu_k", "kind of slip (C20, C21)", (0.4, 0.6, 0.8, 1.0, 1.1, 1.2)),
    Values("alpha", "friction.alpha_m2_per_s2", "speed of fronts (C22)", (0.01, 0.03, 0.1, 0.3, 1)),
)
MESH_WHY = "dependence on the mesh"
QUICK_STUDIES = (*FRICTION, mesh("element_size", MESH_WHY, (50, 100)))
STUDIES = (
    *FRICTION,
    mesh("element_size", MESH_WHY, (300, 200, 150, 100)),
    Values(
        "substeps",
        "time.interface_substeps",
        "dependence on the time step at the interface",
        (1, 3, 9, 18, 36, 72),
    ),
    Values(
        "damping",
        "material.stiffness_damping_s",
        "dependence on the damping",
        (0.05e-6, 0.1e-6, 0.2e-6, 0.4e-6),
    ),
    Values(
        "corner",
        "plate.corner",
        "rounding of the corners, not given in the paper",
        (
            ("relief", math.nan, {}),
            ("none", math.nan, {"plate.corner": "none"}),
            *(
                (f"fillet_{1e3 * r:g}mm", r, {"plate.corner": "fillet", "plate.fillet_radius_m": r})
                for r in (2e-3, 5e-3, 10e-3)
            ),
        ),
    ),
    Values(
        "top",
        "loading.top_during_tilt",
        "top edge held or free along x while it is tilted",
        tuple((word, math.nan, {"loading.top_during_tilt": word}) for word in ("held", "free")),
    ),
    Values(
        "left_amount", "event.trigger_over_missing", "strength of the trigger", (5, 10, 20, 40, 80), ("left",)
    ),
    # The pressure has its peak at the right edge: more than 20 tears it off the plane.
    Values(
        "right_amount", "event.trigger_over_missing", "strength of the trigger", (2, 5, 10, 20), ("right",)
    ),
    Values(
        "trigger_zone",
        "event.trigger_zone_m",
        "length of the trigger zone",
        (5e-3, 10e-3, 15e-3, 20e-3),
        TRIGGERED,
    ),
    Values(
        "trigger_ramp",
        "event.trigger_ramp_s",
        "rise time of the trigger",
        (0.1e-6, 0.5e-6, 1.5e-6),
        TRIGGERED,
    ),
    Values(
        "trigger_duration",
        "event.trigger_duration_s",
        "how long the trigger lasts",
        (2e-6, 5e-6, 15e-6, math.inf),
        TRIGGERED,
    ),
    Values(
        "l_star",
        "fronts.l_star_m",
        "length over which speed and tractions are taken",
        (0.67e-3, 1.33e-3, 2.67e-3, 5.33e-3),
    ),
    # The ramp takes a third of a second of physical time: elements of 2 mm.
    Values(
        "loading_method",
        "loading.method",
        "critical state by equilibria or by the explicit ramp, elements of 2 mm",
        tuple((word, math.nan, {"loading.method": word}) for word in ("direct", "ramp")),
        ("spontaneous",),
        QUICK,
        own_reference=True,
    ),
)


def delayed(what: str, time_s: float) -> Changes:
    return {"friction.regularisation": what, "friction.relaxation_time_s": time_s}


def fine_mesh(name: str, why: str, also: Changes) -> Values:
    return mesh(name, why, (600, 300, 150, 100), also=also, own_reference=True)


def relaxation_time(what: str) -> Values:
    return Values(
        f"relaxation_time_{what}",
        "friction.relaxation_time_s",
        f"{what} relaxed at a constant rate",
        (0.02e-6, 0.05e-6, 0.1e-6, 0.2e-6, 0.5e-6, 1e-6, 2e-6),
        also={"friction.regularisation": what},
        own_reference=True,
    )


# What becomes of the paper's events when friction responds to pressure with a delay: over the element size
# without and with it, over the relaxation time and length. Changes are counted from each study's first point:
# the finest mesh, the shortest delay.
REGULARISED = (
    fine_mesh("element_size", "the paper's law, without a length scale", {}),
    fine_mesh("element_size_strength", "strength relaxed over 0.5 us", delayed("strength", 0.5e-6)),
    fine_mesh("element_size_pressure", "pressure relaxed over 0.5 us", delayed("pressure", 0.5e-6)),
    fine_mesh(
        "element_size_undamped",
        "strength relaxed over 0.5 us, no bulk damping",
        delayed("strength", 0.5e-6) | {"material.stiffness_damping_s": 0},
    ),
    relaxation_time("strength"),
    relaxation_time("pressure"),
    Values(
        "relaxation_length_strength",
        "friction.relaxation_length_m",
        "strength relaxed at the rate (|v| + 0.1 m/s)/L",
        (0.01e-6, 0.03e-6, 0.1e-6, 0.3e-6, 1e-6, 3e-6),
        also={"friction.regularisation": "strength", "friction.relaxation_slip_rate_m_per_s": 0.1},
        own_reference=True,
    ),
)


def studies(quick: bool) -> list[Study]:
    """Friction (mu_k, alpha), mesh, time step, damping, corner, top edge, trigger, l*, loading method. quick:
    friction and mesh alone, with elements of 2 mm and, for the mesh, 4 and 2 mm."""
    return [values.study(quick) for values in (QUICK_STUDIES if quick else STUDIES)]


def regularised_studies() -> list[Study]:
    return [values.study(False) for values in REGULARISED]


def variations(quick: bool) -> list[Variation]:
    """Elements of 1 mm, and half the sub-steps. Both are coarser than the paper's runs, so that they take
    less time. quick: elements of 4 mm."""
    found = []
    for name, key, value in (
        ("mesh", "plate.element_size_m", 4e-3 if quick else 1e-3),
        ("step", "time.interface_substeps", 9),
    ):

        def varied(run: Run, key: str = key, value: float = value) -> Run:
            title = f"{run.changes.get('title', title_of(run.event))}, {key} = {value:g}"
            return replace(run, changes=run.changes | {key: value, "title": title})

        events = [
            varied(run if run.event == "left" else replace(run, changes=run.changes | without_snapshots))
            for run in paper_cases(quick)
        ]
        of_scorecard = [
            replace(study, points=[replace(p, runs=[varied(run) for run in p.runs]) for p in study.points])
            for study in studies(quick)
            if study.name in SCORECARD_STUDIES
        ]
        found.append(Variation(name, key, value, events, of_scorecard))
    return found


without_snapshots: Changes = {"output.snapshot_times_s": []}
