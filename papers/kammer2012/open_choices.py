# SPDX-License-Identifier: BSD-3-Clause
"""What the paper leaves open, varied: which of its statements depend on it. open-choices.md

    python papers/kammer2012/open_choices.py -o DIR [--quick]

runs the four events of every sample (equal ones once) and judges them; the samples that give evidence by the
kinds of slip over mu_k (C20, C21), too. Writes open_choices.csv, a row per sample, and open_choices.json:
choices with ranges and reasons, rule, matrix of claims and choices, region, chosen values."""

from __future__ import annotations

import csv
import math
import sys
import tomllib
from argparse import Namespace
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from os import cpu_count
from pathlib import Path
from typing import Any

import slipfront
from analysis import cell, estimate, number, write_json
from circle import Circle, circle_of, event_with_waves, wave_times_s
from commands import Progress, parser_of, run_command
from events import PAPER_A, PAPER_B, PAPER_C, median
from scipy.stats import qmc
from scorecard import WANTED_IN_BAND, Claim, Reproduction, StudyEvents, TriggerSample, scorecard
from slipfront.files import DataError, read_json_table
from slipfront.folder import LIST, verify_checksums

from cases import EVENTS, HERE, WIDTH_M, Changes, studies

SUMMARY = "open_choices.json"
QUICK_ELEMENT_M = 4e-3
N_TRIGGERS, N_MORE, N_ALL, N_QUICK = 512, 1024, 256, 4
N_THIN = 50  # a region with fewer triggers gets more samples
SHORT_S, LONGEST_S = 5e-6, 15e-6  # triggers that are taken away
# Claims that decide which triggers are possible: statements about the fronts, and C25 about the wave ahead of
# one. The paper's conclusions, C12 and C14 to C22, are none.
CONSTRAINTS = ("C2", "C3", "C4", "C5", "C6", "C7", "C8", "C9", "C10", "C11", "C13", "C23", "C25")
OF_STUDY = ("C20+", "C21+")  # rows that only the study of mu_k has
PAPER_FIT = {"a": PAPER_A, "b": PAPER_B, "c": PAPER_C}

Value = float | str
Values = dict[str, Value]  # of each choice, by its name


@dataclass(frozen=True)
class Choice:
    """A choice that the paper leaves open."""

    name: str  # column of the tables
    key: str  # of the case file
    event: str | None  # the only event that it concerns
    why: str  # reason of the range
    levels: tuple[Value, ...]  # values tried by themselves, numbers ascending
    standard: Value  # of this program
    continuous: bool = False  # between the levels, by logarithms; else the levels alone
    changes: dict[str, Changes] = field(default_factory=dict)  # of words, where they are not the key's values
    # The choice whose value decides whether this one counts, and the words with which it does.
    decided_by: str = ""
    counts_with: tuple[str, ...] = ()
    at_most: str = ""  # the choice whose value, where it counts, ends the range

    def at(self, share: float) -> Value:
        """The value at a share of the range, 0 to 1."""
        if not self.continuous:
            return self.levels[min(int(share * len(self.levels)), len(self.levels) - 1)]
        first, last = self.levels[0], self.levels[-1]
        assert isinstance(first, float) and isinstance(last, float)
        return float(first * (last / first) ** share)

    def share_of(self, value: Any) -> float:
        """The share of the range, of a continuous choice, at which a value lies."""
        if len(self.levels) == 1:
            return 0
        first, last = map(float, (self.levels[0], self.levels[-1]))
        return math.log(value / first) / math.log(last / first)

    def changes_of(self, value: Value) -> Changes:
        return self.changes[value] if isinstance(value, str) and self.changes else {self.key: value}


def text(value: Value) -> str:
    """As it stands in tables."""
    return value if isinstance(value, str) else repr(float(value)).removesuffix(".0")


def shown(value: Value) -> Value:
    """In JSON: numbers as they are, infinity as in case files."""
    return text(value) if isinstance(value, str) or math.isinf(value) else float(value)


def trigger_choices(event: str) -> list[Choice]:
    """Of the trigger at one edge."""
    form, end, duration = f"{event}_form", f"{event}_end", f"{event}_duration_s"

    def of(name: str, key: str, why: str, levels: tuple[Value, ...], standard: Value, **more: Any) -> Choice:
        name, key, continuous = f"{event}_{name}", f"event.trigger_{key}", not isinstance(standard, str)
        return Choice(name, key, event, why, levels, standard, continuous, **more)

    return [
        of(
            "form",
            "form",
            'the traction is "increased manually": by an amount, to a level, or against a lowered strength',
            ("added", "raised", "weakened"),
            "added",
        ),
        of(
            "zone_m",
            "zone_m",
            '"small": 1 to 10 % of the interface; 2 mm are 3 elements',
            (2e-3, 5e-3, 10e-3, 15e-3, 20e-3),
            10e-3,
        ),
        of(
            "added",
            "over_missing",
            "from just enough for a front, to 80 times what is missing to the strength",
            (2.0, 5.0, 10.0, 20.0, 40.0, 80.0),
            5.0,
            decided_by=form,
            counts_with=("added",),
        ),
        of(
            "raised",
            "over_strength",
            "from just above the strength to 80 times it",
            (1.05, 2.0, 5.0, 10.0, 20.0, 40.0, 80.0),
            2.0,
            decided_by=form,
            counts_with=("raised",),
        ),
        of(
            "end",
            "duration_s",
            "nothing is said of its end",
            ("taken away", "held"),
            "held",
            changes={
                "taken away": {"event.trigger_duration_s": SHORT_S},
                "held": {"event.trigger_duration_s": math.inf},
            },
            decided_by=form,
            counts_with=("added", "raised"),
        ),
        of(
            "duration_s",
            "duration_s",
            "brief: a wave crosses 1 to 24 mm meanwhile, an eighth of the plate at most",
            (0.5e-6, 1.5e-6, 5e-6, LONGEST_S),
            SHORT_S,
            decided_by=end,
            counts_with=("taken away",),
        ),
        of(
            "ramp_s",
            "ramp_s",
            "from within a step, up to the duration",
            (0.1e-6, 0.5e-6, 1.5e-6, 5e-6, LONGEST_S),
            5e-6,
            decided_by=form,
            counts_with=("added", "raised"),
            at_most=duration,
        ),
    ]


def fillet(radius_m: float) -> Changes:
    return {"plate.corner": "fillet", "plate.fillet_radius_m": radius_m}


def open_choices(quick: bool) -> list[Choice]:
    """All of them, in the order in which they are set. quick: with elements of 4 mm alone."""
    sizes = (QUICK_ELEMENT_M,) if quick else tuple(WIDTH_M / n for n in (300, 200, 150, 100))
    return [
        *trigger_choices("left"),
        *trigger_choices("right"),
        Choice(
            "top",
            "loading.top_during_tilt",
            None,
            "a vertical displacement is imposed; nothing is said of the horizontal one",
            ("held", "free"),
            "held",
        ),
        Choice(
            "corner",
            "plate.corner",
            None,
            "rounded, without a radius; the relief is this program's standard, right angles a limit",
            ("none", "relief", "fillet 2 mm", "fillet 5 mm", "fillet 10 mm"),
            "relief",
            changes={
                "none": {"plate.corner": "none"},
                "relief": {"plate.corner": "relief"},
                "fillet 2 mm": fillet(2e-3),
                "fillet 5 mm": fillet(5e-3),
                "fillet 10 mm": fillet(10e-3),
            },
        ),
        Choice(
            "element_size_m",
            "plate.element_size_m",
            None,
            "the paper's meshes have 0.67 to 2 mm; which figure has which is not said",
            sizes,
            sizes[0],
        ),
        Choice(
            "step_factor",
            "time.step_factor",
            None,
            "the step is not given; the velocity on which the damping acts is half a step old, so this "
            "choice holds "
            "that one as well",
            (0.225, 0.45, 0.9),
            0.9,
            continuous=True,
        ),
        Choice(
            "substeps",
            "time.interface_substeps",
            None,
            "the paper's scheme has one step; this program's resolves the change of friction",
            (1, 3, 9, 18),
            18,
        ),
        Choice(
            "contact",
            "contact.algorithm",
            None,
            "an energy conserving algorithm, of which there are several",
            ("direct", "predictor_corrector"),
            "direct",
        ),
        Choice(
            "speed_interval",
            "fronts.speed_interval",
            None,
            "V_tip belongs to the advance over l* or to the node at its end",
            ("centred", "approach"),
            "centred",
        ),
    ]


class Choices:
    """All choices by their names, and what depends on several of them."""

    def __init__(self, choices: Iterable[Choice]) -> None:
        self.all = list(choices)
        self.by_name = {choice.name: choice for choice in self.all}
        self.standard: Values = {choice.name: choice.standard for choice in self.all}

    def of(self, event: str) -> list[Choice]:
        return [choice for choice in self.all if choice.event == event]

    def in_use(self, name: str, values: Values) -> bool:
        """Whether a choice has a part among such values: an amount counts with its form of trigger alone, and
        a weakened zone has neither ramp nor end."""
        choice = self.by_name[name]
        decider = choice.decided_by
        return not decider or self.in_use(decider, values) and values[decider] in choice.counts_with

    def limit(self, choice: Choice, values: Values) -> float:
        """What ends a choice's range."""
        other = choice.at_most
        return float(values[other]) if other and self.in_use(other, values) else math.inf

    def words(self, values: Values, event: str) -> str:
        """A trigger's words that are in use."""
        return " ".join(
            str(values[c.name]) for c in self.of(event) if not c.continuous and self.in_use(c.name, values)
        )

    def with_words_of(self, values: Values, event: str) -> Choices:
        """Those of an edge's trigger that are words with the word of a sample alone."""
        fixed = {c.name: replace(c, levels=(values[c.name],)) for c in self.of(event) if not c.continuous}
        return Choices(fixed.get(choice.name, choice) for choice in self.all)

    def cases(self, values: Values) -> list[Any]:
        """The four events of a sample."""
        return [self.case(event, values) for event in EVENTS]

    def case(self, event: str, values: Values, more: Changes | None = None) -> Any:
        tables, kind = tables_of(event), "spontaneous" if event not in ("left", "right") else event
        changes: Changes = {
            "title": "",
            "output.snapshot_times_s": [],
            "output.history_interval_s": 1e-5,
            "output.energy_interval_s": 1e-5,
        }
        for choice in self.all:
            if choice.event in (None, kind) and self.in_use(choice.name, values):
                changes |= choice.changes_of(values[choice.name])
        # Keys of the choices are set by them alone.
        for key in {choice.key for choice in self.all} | set(changes):
            table, _, name = key.rpartition(".")
            (tables[table] if table else tables).pop(name, None)
        return slipfront.case(tables, changes | (more or {}))

    def space_filling(
        self, varied: list[Choice], kind: str, first: int, n: int, others: Values
    ) -> list[Sample]:
        """Points of Sobol's sequence, counted from the one behind the origin. Choices that are not varied are
        as given."""
        sequence = qmc.Sobol(len(varied), scramble=False)
        sequence.fast_forward(first + 1)
        samples = []
        for shares in sequence.random(n):
            values = dict(others)
            for choice, share in zip(varied, shares, strict=True):
                limit = self.limit(choice, values)
                if math.isfinite(limit):
                    last = min(float(choice.levels[-1]), limit)
                    ended = replace(choice, levels=(*choice.levels[:-1], last))
                    values[choice.name] = min(float(ended.at(share)), limit)
                else:
                    values[choice.name] = choice.at(share)
            samples.append(Sample(kind, values))
        return samples

    def triggers(self, event: str, first: int, n: int, others: Values) -> list[Sample]:
        """Triggers at an edge, the other choices as given: over their ranges, two digits each, so that a case
        file can state what is chosen."""
        samples = self.space_filling(self.of(event), f"{event} trigger", first, n, others)
        for sample in samples:
            for choice in self.of(event):
                value = sample.values[choice.name]
                if not isinstance(value, str):
                    sample.values[choice.name] = float(f"{value:.2g}")
        return samples

    def about(self, chosen: Values) -> list[Sample]:
        """One other level of one choice at a time, about the chosen triggers."""
        samples = []
        for choice in self.all:
            used = self.in_use(choice.name, chosen)
            for level in choice.levels:
                if used and level == chosen[choice.name]:
                    continue
                values = chosen | {choice.name: level}
                if not used:  # it comes with one that lets it count
                    values[choice.decided_by] = choice.counts_with[0]
                exceeds = any(
                    self.in_use(c.name, values) and float(values[c.name]) > self.limit(c, values)
                    for c in self.all
                    if c.at_most
                )
                if self.in_use(choice.name, values) and not exceeds:
                    samples.append(Sample("about the chosen", values))
        return samples

    def known(self) -> list[Sample]:
        """Left triggers by which it was found what to ask for, added over 0.1 us."""
        samples = []
        for zone_m, added, duration_s in (
            (20e-3, 20.0, None),
            (15e-3, 10.0, None),
            (15e-3, 20.0, 5e-6),
            (10e-3, 40.0, 4e-6),
            (10e-3, 20.0, 5e-6),
            (20e-3, 10.0, 5e-6),
        ):
            values = self.standard | {"left_zone_m": zone_m, "left_added": added, "left_ramp_s": 0.1e-6}
            values["left_end"] = "held" if duration_s is None else "taken away"
            if duration_s is not None:
                values["left_duration_s"] = duration_s
            samples.append(Sample("known", values))
        return samples

    def finer(self, chosen: Values) -> list[Sample]:
        """The chosen triggers on meshes that are finer than the paper's."""
        return [Sample("finer", chosen | {"element_size_m": WIDTH_M / columns}) for columns in (400, 600)]


def tables_of(event: str) -> dict[str, Any]:
    """Of the case file of one of the paper's events, without its trigger."""
    tables = tomllib.loads((HERE / f"{event}.toml").read_text())
    tables["event"] = {"kind": tables["event"]["kind"]}
    tables["contact"] = {}
    return tables


@dataclass(frozen=True)
class Sample:
    """What is chosen."""

    # standard: this program's default triggers; known; left trigger, right trigger: space-filling over them;
    # about the chosen; finer; all: space-filling over all choices.
    kind: str
    values: Values


@dataclass
class Judged:
    """What comes out for one sample."""

    sample: Sample
    holds: dict[str, bool | None]  # by the ids of the claims
    maxima: dict[str, float]  # V_tip/c_L of each event, see C11
    left_work_J_per_m: float  # of the left trigger
    circle: Circle | None
    fit: Any  # of the main fronts without their tails, see C18b
    share_in_band: float  # of their points within the paper's band
    spreads: dict[str, Any]  # between them at equal criterion, see C18c
    distance: float
    difference_of_kinds: float = math.nan  # V_tip/c_L, see C21+; NaN where it was not tested

    @property
    def others_hold(self) -> bool:
        """All CONSTRAINTS but C25."""
        return all(self.holds[id] is True for id in CONSTRAINTS if id != "C25")

    @property
    def constrained(self) -> bool:
        """All of them: C25 is tested where the others hold."""
        return self.others_hold and self.circle is not None and self.circle.holds

    @property
    def slow_left(self) -> bool:
        """C1 to C11."""
        return all(self.holds[f"C{k}"] is True for k in range(1, 12))

    def spread(self, criterion: str) -> float:
        return float(self.spreads[criterion].median_relative)


def figure(claims: Iterable[Claim], id: str, name: str) -> float:
    found = (value for c in claims if c.id == id for own, value, _ in c.figures if own == name)
    return next(found, math.nan)


def distance_from_paper(fit: Any) -> float:
    """Largest distance of a, b and c from the paper's in units of our interval on that side: at most 1 where
    the paper's lie inside our intervals."""

    def units(ours: Any, theirs: float) -> float:
        interval = ours.high - ours.value if theirs > ours.value else ours.value - ours.low
        return abs(theirs - ours.value) / interval if interval > 0 else math.nan

    return max(units(getattr(fit, name), theirs) for name, theirs in PAPER_FIT.items())


def judged_by(sample: Sample, runs: Reproduction, claims: list[Claim]) -> Judged:
    mains = runs.collapse_of_mains
    return Judged(
        sample,
        {claim.id: claim.holds for claim in claims},
        {name: figure(claims, "C11", name) for name in ("left", "spontaneous", "right")},
        runs.left.trigger_work_J_per_m,
        circle_of(runs.left),
        mains.fit,
        mains.share_in_band,
        mains.fronts,
        math.nan if mains.fit is None else distance_from_paper(mains.fit),
    )


class Events:
    """Runs events, by the text of their case each once, and keeps what analysis needs of them."""

    def __init__(self, batch: slipfront.Batch) -> None:
        self.batch = batch
        self.places: dict[str, int] = {}
        self.cases: list[Any] = []
        self.events: list[Any] = []

    def place(self, case: Any) -> int:
        place = self.places.setdefault(case.toml, len(self.cases))
        if place == len(self.cases):
            self.cases.append(case)
        return place

    def run(self) -> None:
        """Those placed since the last call."""
        first = len(self.events)
        self.events += [None] * (len(self.cases) - first)
        progress = Progress(len(self.cases) - first)

        def done(k: int, found: slipfront.BatchEvent) -> None:
            event = event_with_waves("", self.cases[first + k], found)
            self.events[first + k] = replace(event, fronts=[]) if found.blew_up else event
            progress.step()

        self.batch.run(self.cases[first:], done)

    def of(self, places: Sequence[int]) -> Reproduction:
        """Of the paper's four events."""
        return Reproduction(*(self.events[place] for place in places))


@dataclass(frozen=True)
class Region:
    """The triggers at an edge for which the constraints hold, and what is chosen of them."""

    all: list[Judged]
    # At the left those of the most frequent form and end, of several the first; at the right those of the
    # left trigger's.
    alike: list[Judged]
    # Of these the one nearest to their middle, the medians of the logarithms, in shares of the ranges.
    chosen: Judged | None


def region_of(choices: Choices, outcomes: Iterable[Judged], event: str) -> Region:
    found = [o for o in outcomes if o.sample.kind == f"{event} trigger" and o.constrained]
    if not found:
        return Region([], [], None)

    def with_words(wanted: str) -> list[Judged]:
        return [o for o in found if choices.words(o.sample.values, event) == wanted]

    if event == "right":
        alike = with_words(choices.words(found[0].sample.values, "left"))
    else:
        alike = max((with_words(choices.words(o.sample.values, event)) for o in found), key=len)
    if not alike:
        return Region(found, [], None)
    distances = [0.0] * len(alike)
    for choice in choices.of(event):
        if not choice.continuous or not choices.in_use(choice.name, alike[0].sample.values):
            continue
        shares = [choice.share_of(o.sample.values[choice.name]) for o in alike]
        middle = median(shares)
        distances = [d + (s - middle) ** 2 for d, s in zip(distances, shares, strict=True)]
    return Region(found, alike, alike[distances.index(min(distances))])


class Study:
    """Runs all samples and judges them."""

    def __init__(self, batch: slipfront.Batch, quick: bool, threads: int | None) -> None:
        self.quick = quick
        self.choices = Choices(open_choices(quick))
        self.events = Events(batch)
        self.threads = threads or cpu_count() or 1
        self.n_impossible = 0
        self.n_first = N_QUICK if quick else N_TRIGGERS
        self.possible: dict[tuple[Value, ...], bool] = {}
        self.claims: list[str] = []
        self.outcomes: list[Judged] = []

    def run(self) -> None:
        standard = self.choices.standard
        lefts = self.sampled("left", standard)
        rights = self.sampled("right", self.chosen_of(lefts, "left", standard))
        with_right = {
            name: value
            for name, value in self.chosen_of(rights, "right", standard).items()
            if self.choices.by_name[name].event == "right"
        }

        def add(samples: list[Sample], every_circle: bool) -> None:
            self.outcomes += self.judged(
                [Sample(s.kind, s.values | (with_right if s.kind in WITH_RIGHT else {})) for s in samples],
                every_circle,
            )

        add([Sample("standard", standard)], True)
        if not self.quick:
            add(self.choices.known(), True)
        add([o.sample for o in lefts], False)
        self.left = region_of(self.choices, self.outcomes, "left")
        self.outcomes += rights
        self.right = region_of(self.choices, self.outcomes, "right")
        first = [o for o in self.outcomes if o.sample.kind == "left trigger"][: self.n_first]
        self.triggers = TriggerSample(len(first), sum(o.slow_left for o in first))
        if self.left.chosen is not None:
            chosen = self.left.chosen.sample.values
            add(self.choices.about(chosen), True)
            if not self.quick:
                add(self.choices.finer(chosen), True)
        n_all = N_QUICK if self.quick else N_ALL
        add(self.choices.space_filling(self.choices.all, "all", 0, n_all, standard), False)
        self.judge_kinds_of_slip()

    def sampled(self, event: str, others: Values) -> list[Judged]:
        """Triggers at an edge over their ranges; where few of them are possible, more that are like most of
        these."""
        outcomes = self.judged(self.choices.triggers(event, 0, self.n_first, others), False)
        region = region_of(self.choices, outcomes, event)
        if not region.alike or len(region.all) >= N_THIN:
            return outcomes
        alike = self.choices.with_words_of(region.alike[0].sample.values, event)
        more = alike.triggers(event, self.n_first, N_QUICK if self.quick else N_MORE, others)
        return outcomes + self.judged(more, False)

    def chosen_of(self, outcomes: list[Judged], event: str, otherwise: Values) -> Values:
        """The values of the sample in the middle of an edge's region."""
        chosen = region_of(self.choices, outcomes, event).chosen
        return otherwise if chosen is None else chosen.sample.values

    def is_possible(self, cases: list[Any], values: Values) -> bool:
        """Whether a sample's plate can be meshed: small fillets need small elements."""
        key = values["corner"], values["element_size_m"]
        if key not in self.possible:
            try:
                cases[0].check()
                self.possible[key] = True
            except slipfront.CaseError:
                self.possible[key] = False
        return self.possible[key]

    def judged(self, samples: list[Sample], every_circle: bool) -> list[Judged]:
        """Runs the events of samples and judges them. every_circle: C25 is tested for all of them, else where
        the other constraints hold."""
        possible, places = [], []
        for sample in samples:
            cases = self.choices.cases(sample.values)
            if self.is_possible(cases, sample.values):
                possible.append(sample)
                places.append([self.events.place(case) for case in cases])
            else:
                self.n_impossible += 1
        self.events.run()
        outcomes = self.judge(possible, places)
        again = []
        for k, (sample, of_sample) in enumerate(zip(possible, places, strict=True)):
            if not every_circle and not outcomes[k].others_hold:
                continue
            times_s = wave_times_s(self.events.events[of_sample[1]])
            if times_s:
                case = self.choices.case("left", sample.values, {"output.snapshot_times_s": times_s})
                of_sample[1] = self.events.place(case)
                again.append(k)
        self.events.run()
        better = self.judge([possible[k] for k in again], [places[k] for k in again])
        for k, outcome in zip(again, better, strict=True):
            outcomes[k] = outcome
        return outcomes

    def judge(self, samples: list[Sample], places: list[list[int]]) -> list[Judged]:
        """Side by side: most of the time goes into fits, which other threads go on beside."""

        def one(sample: Sample, of_sample: list[int]) -> Judged:
            runs = self.events.of(of_sample)
            return judged_by(sample, runs, scorecard(runs))

        with ThreadPoolExecutor(self.threads) as pool:
            outcomes = list(pool.map(one, samples, places))
        if outcomes and not self.claims:
            self.claims = list(outcomes[0].holds)
        return outcomes

    @staticmethod
    def is_of_region(outcome: Judged) -> bool:
        return outcome.sample.kind == "left trigger" and outcome.constrained

    def is_held(self, outcome: Judged) -> bool:
        """Whether a left trigger is held, for which the constraints but C25 hold."""
        values = outcome.sample.values
        return (
            outcome.sample.kind == "left trigger"
            and outcome.others_hold
            and self.choices.in_use("left_end", values)
            and values["left_end"] == "held"
        )

    def evidence(self) -> dict[str, list[Judged]]:
        """The region of left triggers, and held ones for which the constraints but C25 hold."""
        return {"the region": self.left.all, "held, all constraints but C25": self.held}

    def judge_kinds_of_slip(self) -> None:
        """The kinds of slip over mu_k (C20, C21) of the samples that give evidence."""
        self.held = [o for o in self.outcomes if self.is_held(o)]
        about = next(study for study in studies(False) if study.name == "mu_k")
        wanted = [o for o in self.outcomes if self.is_held(o) or self.is_of_region(o)]
        places = []
        for outcome in wanted:
            values = outcome.sample.values
            four = [self.events.place(case) for case in self.choices.cases(values)]
            of_points = [
                [
                    self.events.place(self.choices.case(run.event, values, {"friction.mu_k": point.number}))
                    for run in point.runs
                ]
                for point in about.points
            ]
            places.append((four, of_points))
        self.events.run()
        self.claims += OF_STUDY
        for outcome in self.outcomes:
            outcome.holds |= dict.fromkeys(OF_STUDY)
        for outcome, (four, of_points) in zip(wanted, places, strict=True):
            points = [[self.events.events[place] for place in of_point] for of_point in of_points]
            runs = replace(self.events.of(four), studies={"mu_k": StudyEvents(about, points)})
            claims = scorecard(runs)
            outcome.holds |= {c.id: c.holds for c in claims if c.holds is not None and c.id in outcome.holds}
            outcome.difference_of_kinds = figure(claims, "C21+", "difference")


WITH_RIGHT = ("standard", "known", "left trigger")  # kinds of samples that get the chosen right trigger
SPREADS = {
    "spread_at_energy_rise": "energy_rise",
    "spread_at_t_d_over_p_d": "dynamic_ratio",
    "spread_at_t_s_over_p_s": "static_ratio",
}


def circle_value(o: Judged, name: str) -> float:
    return math.nan if o.circle is None else float(getattr(o.circle, name))


def measures(o: Judged) -> dict[str, float]:
    """Numbers of a sample by their columns, in their order in the table."""
    return {
        **{name: o.spread(criterion) for name, criterion in SPREADS.items()},
        "difference_of_kinds_over_c_L": o.difference_of_kinds,
        **{f"{name}_max_over_c_L": value for name, value in o.maxima.items()},
        "left_work_J_per_m": o.left_work_J_per_m,
        "circle_peak_m_per_s": circle_value(o, "peak_m_per_s"),
        "circle_gap": circle_value(o, "gap"),
    }


def row_of(study: Study, o: Judged) -> dict[str, str]:
    """Of open_choices.csv."""
    fit = {f"{name}{end}": math.nan for name in "abc" for end in ("", "_low", "_high")}
    if o.fit is not None:
        estimates = {name: estimate(getattr(o.fit, name)).values() for name in "abc"}
        values = [value for each in estimates.values() for value in each]
        fit = {name: math.nan if v is None else v for name, v in zip(fit, values, strict=True)}
    fit["rms_over_c_L"] = math.nan if o.fit is None else o.fit.rms
    verdicts = {True: "holds", False: "does not", None: ""}
    return {
        "set": o.sample.kind,
        **{name: text(value) for name, value in o.sample.values.items()},
        "constraints": "hold" if o.constrained else "do not",
        "constraints_but_C25": "hold" if o.others_hold else "do not",
        "distance": cell(o.distance),
        "share_in_band": cell(o.share_in_band),
        **{name: cell(value) for name, value in (fit | measures(o)).items()},
        **{id: verdicts[o.holds[id]] for id in study.claims},
    }


def choice_json(choice: Choice) -> dict[str, Any]:
    return {
        "name": choice.name,
        "key": choice.key,
        "why": choice.why,
        "levels": [shown(level) for level in choice.levels],
        "standard": shown(choice.standard),
        "decided_by": choice.decided_by,
        "counts_with": list(choice.counts_with),
    }


def outcome_json(study: Study, o: Judged) -> dict[str, Any]:
    numbers = {name: number(value) for name, value in measures(o).items()}
    of_kinds = ("spread_at", "difference_of")
    fit = None
    if o.fit is not None:
        fit = {name: estimate(getattr(o.fit, name)) for name in "abc"} | {"rms_over_c_L": o.fit.rms}
    return {
        "set": o.sample.kind,
        "values": {name: shown(value) for name, value in o.sample.values.items()},
        "constraints_hold": o.constrained,
        "claims": {id: o.holds[id] for id in study.claims},
        **{name: value for name, value in numbers.items() if not name.startswith(of_kinds)},
        **{name: value for name, value in numbers.items() if name.startswith(of_kinds)},
        "distance": number(o.distance),
        "share_in_band": number(o.share_in_band),
        "fit": fit,
    }


def matrix_json(study: Study) -> list[dict[str, Any]]:
    """For each claim: its verdict with the chosen triggers, how often it holds, and the levels of single
    choices at which the verdict changes."""
    centre = study.left.chosen or study.outcomes[0]

    def share(kind: str, id: str, with_fronts: bool = False) -> float | None:
        """Samples of a kind for which a claim holds, over those for which it is tested."""
        tested = [
            o.holds[id]
            for o in study.outcomes
            if o.sample.kind == kind
            and o.holds[id] is not None
            and not (with_fronts and (o.maxima["left"] <= 0 or o.maxima["right"] <= 0))
        ]
        return sum(map(bool, tested)) / len(tested) if tested else None

    def changed(values: Values) -> str:
        """An amount comes with its form, which stands before it."""
        return [name for name, value in values.items() if value != centre.sample.values[name]][-1]

    def turns(id: str) -> list[dict[str, Any]]:
        about = [
            o.sample.values
            for o in study.outcomes
            if o.sample.kind == "about the chosen" and o.holds[id] != centre.holds[id]
        ]
        return [{"choice": changed(values), "level": shown(values[changed(values)])} for values in about]

    return [
        {
            "id": id,
            "holds": bool(centre.holds[id]),
            "share_of_triggers": share("left trigger", id),
            "share_of_triggers_with_fronts": share("left trigger", id, True),
            "share_of_all": share("all", id),
            "turns": turns(id),
        }
        for id in study.claims
        if study.outcomes[0].holds[id] is not None  # else it needs studies
    ]


def evidence_json(study: Study, name: str, samples: list[Judged]) -> dict[str, Any]:
    """What was not used to choose, of some of the samples."""

    def ranged(values: Iterable[float]) -> list[float | None]:
        """Least, median, largest."""
        known = [value for value in values if math.isfinite(value)]
        return [min(known), median(known), max(known)] if known else [None] * 3

    holds = {id: [o.holds[id] for o in samples if o.holds[id] is not None] for id in study.claims}
    return {
        "samples": name,
        "n": len(samples),
        "n_paper_fit_in_intervals": sum(o.distance <= 1 for o in samples),
        "claims": {id: {"n": len(v), "n_holding": sum(map(bool, v))} for id, v in holds.items() if v},
        **{column: ranged(o.spread(criterion) for o in samples) for column, criterion in SPREADS.items()},
        "difference_of_kinds_over_c_L": ranged(o.difference_of_kinds for o in samples),
        **{abc: ranged(getattr(o.fit, abc).value for o in samples if o.fit is not None) for abc in "abc"},
        "share_in_band": ranged(o.share_in_band for o in samples),
    }


def region_json(study: Study) -> dict[str, list[Value]]:
    """Least and largest value in use of each choice of a trigger in its region, numbers only; words that
    occur."""
    found = {}
    for event, region in (("left", study.left), ("right", study.right)):
        for choice in study.choices.of(event):
            values = {
                o.sample.values[choice.name]
                for o in region.all
                if study.choices.in_use(choice.name, o.sample.values)
            }
            if choice.continuous:
                order: list[Value] = sorted(values)
                order = order if len(order) < 3 else [order[0], order[-1]]
            else:
                order = [level for level in choice.levels if level in values]
            found[choice.name] = [shown(value) for value in order]
    return found


def write(study: Study, batch: slipfront.Batch) -> list[dict[str, Any]]:
    """The evidence that was written."""
    lefts = [o for o in study.outcomes if o.sample.kind == "left trigger"]
    evidence = [evidence_json(study, name, samples) for name, samples in study.evidence().items()]

    def of_kind(kind: str) -> list[dict[str, Any]]:
        return [outcome_json(study, o) for o in study.outcomes if o.sample.kind == kind]

    found = {
        "version": slipfront.version(),
        "quick": study.quick,
        "n_runs": batch.n_runs,
        "n_quiet": batch.n_quiet,
        "n_samples": len(study.outcomes),
        "n_impossible": study.n_impossible,
        "constraints": list(CONSTRAINTS),
        "wanted_share_in_band": WANTED_IN_BAND,
        "choices": [choice_json(choice) for choice in study.choices.all],
        "matrix": matrix_json(study),
        "n_triggers": study.triggers.n_triggers,
        "n_triggers_slow_left": study.triggers.n_holding,
        "n_left": len(lefts),
        "n_left_with_fronts": sum(o.maxima["left"] > 0 for o in lefts),
        "n_left_others_hold": sum(o.others_hold for o in lefts),
        "n_left_region": len(study.left.all),
        "n_left_alike": len(study.left.alike),
        "n_right": sum(o.sample.kind == "right trigger" for o in study.outcomes),
        "n_right_region": len(study.right.all),
        "n_right_alike": len(study.right.alike),
        "evidence": evidence,
        "region": region_json(study),
        "standard": outcome_json(study, study.outcomes[0]),
        "known": of_kind("known"),
        "finer": of_kind("finer"),
        "about": of_kind("about the chosen"),
        "chosen": study.left.chosen and outcome_json(study, study.left.chosen),
    }
    write_json(batch.folder / SUMMARY, found)
    rows = [row_of(study, o) for o in study.outcomes]
    with (batch.folder / "open_choices.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return evidence


def lines_of(study: Study, evidence: list[dict[str, Any]]) -> list[str]:
    """For people."""

    def share(value: float | None) -> str:
        return "-" if value is None else f"{100 * value:.3g} %"

    lines = [
        f"{len(study.outcomes)} samples of {len(study.choices.all)} choices",
        f"C1 to C11 hold for {study.triggers.n_holding} of {study.triggers.n_triggers} triggers",
        f"region: {len(study.left.all)} left triggers, {len(study.right.all)} right ones",
    ]
    chosen = study.left.chosen
    if chosen is not None:
        lines.append("chosen, in its middle:")
        values = chosen.sample.values
        lines += [
            f"  {c.name:<20} {text(values[c.name])} instead of {text(c.standard)}"
            for c in study.choices.all
            if values[c.name] != c.standard and study.choices.in_use(c.name, values)
        ]
        if chosen.fit is not None:
            abc = {name: getattr(chosen.fit, name) for name in "abc"}
            fit = ", ".join(f"{name} = {e.value:.2f} [{e.low:.2f}, {e.high:.2f}]" for name, e in abc.items())
            lines.append(f"  {fit}; {share(chosen.share_in_band)} in the band")
    for e in evidence:
        spreads = (share(e[column][1]) for column in SPREADS)
        text = "; spread of V_tip {} at equal energy rise, {} at equal t_d/p_d, {} at equal t_s/p_s (medians)"
        lines.append(f"{e['samples']}: {e['n']} samples{text.format(*spreads) if e['n'] else ''}")
    return lines


def study_open_choices(options: Namespace) -> list[str]:
    """Lines to print."""
    work = f"study open-choices{' --quick' if options.quick else ''}"
    with slipfront.Batch(options.output, work, threads=options.threads, overwrite=options.overwrite) as batch:
        study = Study(batch, options.quick, options.threads)
        study.run()
        evidence = write(study, batch)
    first, *rest = lines_of(study, evidence)
    counts = f"{batch.n_runs} runs, {batch.n_quiet} of which ended before time.end_s since nothing moved"
    return [first, counts, *rest, f"results: {options.output}"]


def read_trigger_sample(folder: Path, quick: bool) -> TriggerSample:
    """What the folder of such a study says of its triggers, for C11b. quick: whether a quick one is
    wanted."""
    again = "create it again with open_choices.py"
    if not (folder / SUMMARY).is_file() or not (folder / LIST).is_file():
        raise DataError(f"{folder}: holds no {SUMMARY} with its {LIST}; give the folder of open_choices.py")
    problems = verify_checksums(folder)
    if problems:
        raise DataError(problems[0])
    found = read_json_table(folder / SUMMARY)
    if found.get("quick") is not quick:
        own, other = ("full", "quick") if quick else ("quick", "full")
        raise DataError(f"{folder}: is a {own} study, which does not suit a {other} reproduction")
    n, holding = found.get("n_triggers"), found.get("n_triggers_slow_left")
    if not isinstance(n, int) or not isinstance(holding, int) or not 0 <= holding <= n or n == 0:
        raise DataError(f"{folder / SUMMARY}: {holding} of {n} triggers cannot be; {again}")
    return TriggerSample(n, holding)


def main() -> int:
    parser = parser_of("What Kammer et al. (2012) leave open, varied: which statements depend on it.")
    parser.add_argument(
        "--quick", action="store_true", help="a few samples on a coarse mesh, to try the command"
    )
    return run_command(parser, study_open_choices)


if __name__ == "__main__":
    sys.exit(main())
