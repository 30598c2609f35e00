# SPDX-License-Identifier: BSD-3-Clause
"""From the first runs to the posterior: Sobol's points over the ranges; then, round by round, an emulator
of what the runs computed, samples of the posterior that it gives, and runs at some of them, until these agree
with what was expected of them. At last least squares of runs alone, from the most probable place.

Each step follows from those before it alone: a fit that begins again comes to the same points, and takes the
runs that are there."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.compare.command import in_words
from slipfront.compare.kinds import Kind, Record
from slipfront.compare.misfit import Observed
from slipfront.errors import Error
from slipfront.files import DataError
from slipfront.fit.emulator import Emulator
from slipfront.fit.likelihood import Part, alike_of, part_of
from slipfront.fit.posterior import sampled
from slipfront.fit.space import Space, spread_out
from slipfront.opened_sequence import opened
from slipfront.program import cost_of, find_program
from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep
from slipfront.sweep.points import Point, text_of
from slipfront.sweep.sweeping import How, carry_out, refused

RUNS = "runs"
PLAUSIBLE = 20.0  # below the best logarithm of the likelihood, within which runs train the emulator
MOST_TRAINING = 300
MARGIN = 0.5  # of the emulator's box
MOST_NOISE = 0.5  # of log L that the runs' own noise excuses: a poor emulator takes what it misses for noise
AGREE = 0.4  # root mean square of what is expected of log L less what runs have
DOUBTFUL = 1.0  # the same, beyond which a fit that has no runs left is in doubt
STEPS, LAST_STEPS = 300, 1500
BEYOND = 0.02  # share of samples at the end of the emulator's box that the posterior leaves
HEAT = 4.0  # by which log L is divided for the wider posterior
FALL = 5.0  # of log L, over differences of runs for least squares: beyond their noise, and nearly linear
WIDTHS = (1e-4, 0.05)  # of these, shares of the ranges
MOST_STEPS = 6  # of least squares in a round
BETTER = 1.0  # of log L, by which least squares of runs may not surpass the place that was expected
MOST_NAMED = 5  # places
NEAR = 6.0  # below the best, within which these are compared


def runs_of_a_round(batch: int) -> int:
    """At most: at samples of the posterior, and of a wider one."""
    return batch + batch // 2


def runs_of_a_step(n: int) -> int:
    """At most, of least squares of n keys: the place, two beside it for each key, the step."""
    return 2 * n + 2


@dataclass(frozen=True)
class Asked:
    """Records, which of them are fitted, and how they are read."""

    records: list[tuple[Kind, Record]]
    is_fitted: list[bool]
    options: argparse.Namespace

    @property
    def predicted(self) -> list[tuple[Kind, Record]]:
        return [of for of, fitted in zip(self.records, self.is_fitted, strict=True) if not fitted]


@dataclass
class Ran:
    """A point with what its run makes of each record's parts, or why there is none."""

    point: Point
    share: np.ndarray
    observed: list[list[Observed]] = field(default_factory=list)  # [records][parts]
    why_not: str = ""


@dataclass(frozen=True)
class Check:
    """Least squares of runs alone from the most probable place on."""

    share: np.ndarray  # of the best of its runs
    gain: float  # of log L over where it began
    deviations: np.ndarray  # of the keys' shares, by the runs' derivatives
    moved: np.ndarray  # the share less where it began
    falls: np.ndarray  # of log L from there to the runs beside it, of each key


@dataclass(frozen=True)
class Result:
    space: Space
    parts: list[Part]
    ran: list[Ran]
    log_likelihood: np.ndarray  # of ran, -inf without a comparison
    samples: np.ndarray  # shares
    n_independent: float
    disagreement: float  # root mean square, log L expected less that of runs, in the last round
    noise: float  # how much of it is the runs' own
    check: Check | None
    rounds: int
    at_ends: list[str]  # keys whose posterior goes on beyond the runs
    left_out: list[str]  # runs and places of the record that do not count, in words

    @property
    def agrees(self) -> bool:
        """Whether runs are as probable as was expected of them."""
        return self.disagreement < DOUBTFUL

    @property
    def best(self) -> Ran:
        return self.ran[int(np.argmax(self.log_likelihood))]


class Fitting:
    """A fit in its folder."""

    def __init__(
        self,
        case: Path,
        settings: dict[str, Any],
        space: Space,
        asked: Asked,
        folder: Path,
        how: How,
        most_runs: int,
    ) -> None:
        self.case, self.settings, self.space, self.asked = case, settings, space, asked
        self.folder, self.how, self.most_runs = folder, how, most_runs
        self.ran: list[Ran] = []
        self.parts: list[Part] = []
        self.rng = np.random.default_rng(0)
        self.widths = self.summit = np.zeros(0)  # of differences in `climb`, and where it has ended
        self.swept = {point.words: point for point in places.points_in(folder / RUNS)}

    # Runs.

    def sweep(self, points: Iterable[Point]) -> Sweep:
        return Sweep.of_points(self.case, points, self.settings)

    def add(self, shares: np.ndarray) -> None:
        """Runs points that are new, if the program accepts them, and compares them with the records."""
        known = {ran.point.words for ran in self.ran}
        wanted = zip(self.space.points(shares), shares, strict=True)
        every = {point.words: (point, share) for point, share in wanted}
        fresh = {words: of for words, of in every.items() if words not in known}
        if not fresh:
            return
        points = [point for point, _ in fresh.values()]
        to_check = [p for p in points if not places.is_done(self.folder / RUNS, p)]
        with closing(refused(self.sweep(points), find_program(), to_check, True)) as found:
            why_not = {point.name: told for point, told in found}
        if len(why_not) == len(points) and not self.ran:
            reason = why_not[points[0].name].removeprefix("--set ")
            raise DataError(f"--free: all points are refused; the first, {points[0].words}: {reason}")
        valid = {point.words: point for point in points if point.name not in why_not}
        if valid:
            if not self.ran:
                self.require_kinds(next(iter(valid.values())))
            self.swept |= valid
            finished = carry_out(
                self.sweep(self.swept.values()),
                self.folder / RUNS,
                replace(self.how, is_checked=bool(self.ran)),
            )
            if finished.is_interrupted:
                raise KeyboardInterrupt
        for point, share in fresh.values():
            ran = Ran(point, share)
            if point.name in why_not:
                ran.why_not = why_not[point.name]
            else:
                self.observe(ran, self.folder / RUNS)
            self.ran.append(ran)

    def require_kinds(self, point: Point) -> None:
        """Refuses records of a sequence beside a case of one event, and the other way round."""
        cost = cost_of(find_program(), self.case, self.sweep([point]).settings() + point.settings())
        for kind, record in self.asked.records:
            if kind.of_sequence is not None and kind.of_sequence != cost.is_sequence:
                has, wants = ("a sequence of events", "one event")[:: 1 if cost.is_sequence else -1]
                raise DataError(f"{record.label}: is compared with {wants}, and {self.case} has {has}")

    def observe(self, ran: Ran, folder: Path) -> None:
        """folder: of the sweep that has the run."""
        place = places.place_of(folder, ran.point)
        wrong = places.what_is_wrong(place, ran.point)
        if wrong is not None:
            ran.why_not = places.failure_of(folder, ran.point) or wrong
            return
        run = opened(place)
        try:
            ran.observed = [
                kind.observed([run], record.content, self.asked.options)
                for kind, record in self.asked.records
            ]
        except Error as error:
            ran.why_not = in_words(str(error))

    # Likelihood.

    def mismatched(self, ran: Ran) -> list[tuple[Observed, np.ndarray]]:
        """Parts of fitted records, and at which places one of record and run has a front and the other has
        none."""
        return [
            (of, np.isfinite(of.measured) != np.isfinite(of.computed))
            for parts, is_fitted in zip(ran.observed, self.asked.is_fitted, strict=True)
            for of in parts
            if is_fitted
        ]

    def n_mismatched(self, ran: Ran) -> int:
        return sum(int(differs.sum()) for _, differs in self.mismatched(ran))

    @property
    def usable(self) -> list[Ran]:
        """Runs that have fronts where the records have them, as far as any has."""
        compared = [(ran, self.n_mismatched(ran)) for ran in self.ran if not ran.why_not]
        least = min((n for _, n in compared), default=0)
        return [ran for ran, n in compared if n == least]

    def find_parts(self) -> None:
        """Parts of the fitted records, of the values that all usable runs have, with c of the best run."""
        usable, self.parts = self.usable, []
        for k, (_, record) in enumerate(self.asked.records):
            for j, of in enumerate(usable[0].observed[k] if self.asked.is_fitted[k] else []):
                rows = np.array([ran.observed[k][j].computed for ran in usable])
                used = np.isfinite(of.measured) & np.isfinite(rows).all(axis=0)
                if used.sum() > of.has_offset + of.has_gain:
                    self.parts.append(part_of(of, f"{record.label}, {of.name}", (k, j), used))
        if not self.parts:
            raise DataError("no value of the records is there in the runs as well: nothing to fit")
        # Where errors are not known, and what is alike, follow from the best run, and this from them.
        computed = self.computed(usable)
        for _ in range(2):
            best = int(np.argmax(self.of_runs(computed)))
            found = []
            for part, rows in zip(self.parts, computed, strict=True):
                if not part.has_error:
                    left = part.left(part.reduced(part.measured), part.reduced(rows[best]))
                    rms = float(np.sqrt((left**2).mean())) * part.sigma
                    part = replace(part, sigma=np.maximum(rms, 1e-3 * float(np.ptp(part.measured)) or 1e-300))
                found.append(replace(part, alike=alike_of(part, rows[best])))
            self.parts = found

    def computed(self, ran: Sequence[Ran]) -> list[np.ndarray]:
        """What runs make of the parts. [runs, values of the part]"""
        return [np.array([one.observed[k][j].computed[part.used] for one in ran])
                for part in self.parts for k, j in [part.place]]  # fmt: skip

    def of_runs(self, computed: Sequence[np.ndarray]) -> np.ndarray:
        """log L of runs; -inf where one lacks a value. [runs]"""
        return log_likelihood(self.parts, computed)

    # Rounds.

    def emulator(self) -> tuple[Emulator, np.ndarray, np.ndarray]:
        """With the shares of usable runs and their log L."""
        self.find_parts()
        return self.trained(self.parts)

    def trained(self, parts: list[Part]) -> tuple[Emulator, np.ndarray, np.ndarray]:
        """The same of parts with other measured values."""
        usable = self.usable
        computed = self.computed(usable)
        shares = np.array([ran.share for ran in usable])
        logs = log_likelihood(parts, computed)
        n = self.space.n
        least = (n + 1) * (n + 2)  # twice the terms of the emulator's polynomial
        order = np.argsort(-logs)
        chosen = order[: max(least, int((logs > logs.max() - PLAUSIBLE).sum()))][:MOST_TRAINING]
        low, high = shares[chosen].min(axis=0), shares[chosen].max(axis=0)
        inside = ((shares >= low) & (shares <= high)).all(axis=1)
        extra = [k for k in order if inside[k] and k not in set(chosen)][: MOST_TRAINING - len(chosen)]
        training = np.array([*chosen, *extra], dtype=int)
        used = {id(ran) for ran in usable}
        lost = np.array([ran.share for ran in self.ran if id(ran) not in used]).reshape(-1, n)
        made = Emulator(parts, shares[training], [rows[training] for rows in computed], lost, MARGIN)
        return made, shares, logs

    def sample(self, emulator: Emulator, shares: np.ndarray, logs: np.ndarray, steps: int, heat: float = 1.0
               ) -> tuple[np.ndarray, float]:  # fmt: skip
        start = shares[np.argsort(-logs)[: max(4 * self.space.n, 8)]]
        start = start[np.isfinite(emulator.log_likelihood(start))]
        return sampled(lambda s: emulator.log_likelihood(s) / heat, start, steps, self.rng)

    def has_room(self, *runs: int) -> bool:
        """Whether so many more runs are within those allowed."""
        return len(self.ran) + sum(runs) <= self.most_runs

    def carry_out(self, first: int, batch: int, tell: Callable[[str], None]) -> Result:
        self.add(self.space.sobol(first))
        least = self.space.n + 2
        if len(self.usable) < least:
            reasons = [ran.why_not for ran in self.ran if ran.why_not]
            reason = f": {reasons[0]}" if reasons else ""
            raise DataError(
                f"only {len(self.usable)} of {len(self.ran)} runs can be compared with the records, {least} "
                f"are needed{reason}; choose other ranges or more first runs"
            )
        rounds, disagreement, noise = 0, np.inf, 0.0
        round_, step = runs_of_a_round(batch), runs_of_a_step(self.space.n)
        while True:
            emulator, shares, logs = self.emulator()
            off = ""
            if disagreement < np.inf:
                off = (
                    f"; log L of the last ones was expected to {disagreement:.2g}, their noise is {noise:.2g}"
                )
            tell(f"round {rounds}: {len(self.ran)} runs, {len(shares)} of them like the record{off}")
            excused = min(noise, MOST_NOISE)
            if disagreement < float(np.hypot(AGREE, excused)) or not self.has_room(round_, step):
                samples, n_independent = self.sample(emulator, shares, logs, LAST_STEPS)
                check = self.least_squares(emulator, samples, tell)
                is_best = check is None or check.gain < np.hypot(BETTER, 2 * excused)
                is_spent = not self.has_room(round_, step)
                if not is_best:
                    emulator, shares, logs = self.emulator()
                if is_spent and not is_best:
                    samples, n_independent = self.sample(emulator, shares, logs, LAST_STEPS)
                ends = self.at_ends(emulator, samples)
                if is_spent or (is_best and not ends):
                    return self.result(samples, n_independent, disagreement, noise, check, rounds, ends)
            rounds += 1
            disagreement, noise = self.round(emulator, shares, logs, batch)
            if disagreement > DOUBTFUL:
                self.climb(tell)

    def round(
        self, emulator: Emulator, shares: np.ndarray, logs: np.ndarray, batch: int
    ) -> tuple[float, float]:
        """Runs at samples of the posterior and at some of a wider one. Returns by how much log L was expected
        wrongly, root mean square, infinite where few runs are near the best; and how much of it is the runs'
        own noise."""
        cold, _ = self.sample(emulator, shares, logs, STEPS)
        known = np.array([ran.share for ran in self.ran])
        some = cold[self.rng.integers(len(cold), size=400)]
        likely = some[np.argmax(emulator.log_likelihood(some))][None]
        others = np.concatenate([known, likely])
        chosen = np.concatenate([likely, spread_out(some, others, batch - 1)])
        hot, _ = self.sample(emulator, shares, logs, STEPS // 2, heat=HEAT)
        wider = hot[self.rng.integers(len(hot), size=400)]
        beyond = spread_out(wider, np.concatenate([others, chosen]), runs_of_a_round(batch) - batch)
        expected = emulator.log_likelihood(chosen)
        self.add(np.concatenate([chosen, beyond]))
        usable = {ran.point.words: k for k, ran in enumerate(self.usable)}
        found = self.of_runs(self.computed(self.usable))
        at = [usable.get(point.words) for point in self.space.points(chosen)]
        pairs = [(e, found[k]) for e, k in zip(expected, at, strict=True) if k is not None]
        near = [(e, log) for e, log in pairs if log > found.max() - NEAR]
        noise = emulator.noise_of_log_likelihood(chosen, self.rng)
        if len(near) < max(2, len(chosen) // 3):
            return np.inf, noise
        return float(np.sqrt(np.mean([(e - log) ** 2 for e, log in near]))), noise

    def at_ends(self, emulator: Emulator, samples: np.ndarray) -> list[str]:
        """Keys whose posterior goes on beyond the emulator's box."""
        side = 0.02 * (emulator.high - emulator.low)
        below = (samples < emulator.low + side).mean(axis=0) * (emulator.low > 0)
        above = (samples > emulator.high - side).mean(axis=0) * (emulator.high < 1)
        shares = zip(self.space.keys, np.maximum(below, above), strict=True)
        return [key for key, share in shares if share > BEYOND]

    def climb(self, tell: Callable[[str], None]) -> None:
        """Least squares from the best run on, where the emulator does not lead: step by step as long as they
        gain, by differences over which log L falls by about FALL. At first these are as wide as the best runs
        are apart."""
        step = runs_of_a_step(self.space.n)
        for _ in range(MOST_STEPS):
            self.find_parts()
            usable = self.usable
            logs = self.of_runs(self.computed(usable))
            shares = np.array([ran.share for ran in usable])
            near = shares[np.argsort(-logs)[: self.space.n + 2]]
            at_summit = logs[[np.array_equal(share, self.summit) for share in shares]]
            if not self.has_room(step, step) or logs.max() < at_summit.max(initial=-np.inf) + BETTER:
                return
            if not self.widths.size:
                self.widths = np.clip(near.std(axis=0), *WIDTHS)
            check = self.step(near[0], self.widths, tell)
            if check is None:
                return
            falls = np.clip(check.falls, FALL / 10, FALL * 100)
            self.widths = np.clip(self.widths * np.sqrt(FALL / falls), *WIDTHS)
            if check.gain < BETTER and (check.falls < 4 * FALL).all():
                self.summit = check.share

    def least_squares(
        self, emulator: Emulator, samples: np.ndarray, tell: Callable[[str], None]
    ) -> Check | None:
        """From the most probable place."""
        some = samples[self.rng.integers(len(samples), size=500)]
        start = some[int(np.argmax(emulator.log_likelihood(some)))]
        # Deviations of each key while the others stay: ranges of keys that trade off are far wider.
        of_each = 1 / np.sqrt(np.diag(np.linalg.pinv(np.atleast_2d(np.cov(samples, rowvar=False)))))
        return self.step(start, np.clip(np.sqrt(2 * FALL) * of_each, *WIDTHS), tell)

    def step(self, start: np.ndarray, widths: np.ndarray, tell: Callable[[str], None]) -> Check | None:
        """Gauss's and Newton's step by central differences of runs within the ranges."""
        after, before = np.minimum(widths, 1 - start), np.minimum(widths, start)
        tried = np.concatenate([start[None], start + np.diag(after), start - np.diag(before)])
        tell(f"least squares: {len(tried) + 1} runs")
        logs, left = self.logs_and_residuals(tried)
        n, known = self.space.n, np.isfinite(logs)
        if not known[0] or not (known[1 : n + 1] | known[n + 1 :]).all():
            return None
        of_after, of_before = (np.where(known[k : k + n], np.arange(k, k + n), 0) for k in (1, n + 1))
        apart = np.array(
            [tried[i, k] - tried[j, k] for k, (i, j) in enumerate(zip(of_after, of_before, strict=True))]
        )
        if not apart.all():  # at an end of a range, and the run beside it has no comparison
            return None
        slopes = (left[of_after] - left[of_before]) / apart[:, None]
        normal = slopes @ slopes.T + np.diag(1e-9 / widths**2)
        at = np.clip(start - np.linalg.solve(normal, slopes @ left[0]), 0, 1)
        of_step, _ = self.logs_and_residuals(at[None])
        places, values = np.concatenate([tried, at[None]]), np.concatenate([logs, of_step])
        best = int(np.argmax(values))
        deviations = np.sqrt(np.diag(np.linalg.inv(normal)))
        falls = logs[0] - np.minimum(logs[of_after], logs[of_before])
        return Check(places[best], float(values[best] - logs[0]), deviations, places[best] - start, falls)

    def logs_and_residuals(self, shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """log L, -inf of runs without a comparison, and residuals over the first run's most probable errors.
        [points], [points, values]"""
        self.add(shares)
        by_words = {ran.point.words: ran for ran in self.ran if not ran.why_not}
        at = [by_words.get(point.words) for point in self.space.points(shares)]
        known = [k for k, ran in enumerate(at) if ran is not None]
        logs, left = (
            np.full(len(shares), -np.inf),
            np.full((len(shares), sum(p.n for p in self.parts)), np.nan),
        )
        if known:
            computed = self.computed([ran for ran in at if ran is not None])
            logs[known] = self.of_runs(computed)
            rows = []
            for part, of in zip(self.parts, computed, strict=True):
                of_part = part.left(part.reduced(part.measured), part.reduced(of))
                scale = part.scale(float((of_part[0] ** 2).sum()))
                rows.append(of_part / scale / np.sqrt(part.alike))
            left[known] = np.concatenate(rows, axis=1)
        return logs, left

    def result(
        self,
        samples: np.ndarray,
        n_independent: float,
        disagreement: float,
        noise: float,
        check: Check | None,
        rounds: int,
        at_ends: list[str],
    ) -> Result:
        usable = {id(ran) for ran in self.usable}
        logs = iter(self.of_runs(self.computed(self.usable)))
        of_ran = np.array([next(logs) if id(ran) in usable else -np.inf for ran in self.ran])
        return Result(
            self.space,
            self.parts,
            self.ran,
            of_ran,
            samples,
            n_independent,
            disagreement,
            noise,
            check,
            rounds,
            at_ends,
            self.left_out(),
        )

    def left_out(self) -> list[str]:
        """Runs that failed or have no front where the record has one, and places that no run explains."""
        told = []
        failed = [ran for ran in self.ran if ran.why_not]
        if failed:
            first = f"{failed[0].point.words}: {failed[0].why_not}"
            told.append(f"{len(failed)} of {len(self.ran)} runs are left out; the first, at {first}")
        usable = self.usable
        unlike = len(self.ran) - len(failed) - len(usable)
        if unlike:
            told.append(
                f"{unlike} runs have fronts at other places of the record than the rest: "
                "their points are ruled out"
            )
        without = [
            of.labels[k] for of, differs in self.mismatched(usable[0]) for k in np.flatnonzero(differs)
        ]
        if without:
            named = ", ".join(without[:MOST_NAMED]) + (", ..." if len(without) > MOST_NAMED else "")
            told.append(
                f"{len(without)} places of the record do not count, as no run has a front there, or all have "
                f"one where the record has none: {named}"
            )
        return told


def log_likelihood(parts: Sequence[Part], computed: Sequence[np.ndarray]) -> np.ndarray:
    """Of runs that computed values [runs, values of the part] for each part. [runs]"""
    total = np.zeros(len(computed[0]))
    for part, rows in zip(parts, computed, strict=True):
        left = part.left(part.reduced(part.measured), part.reduced(rows))
        total += part.log_likelihood((left**2).sum(axis=1), part.least_scale**2)
    return np.where(np.isfinite(total), total, -np.inf)


def words(share: np.ndarray, space: Space) -> str:
    (point,) = space.points(share[None])
    return ", ".join(f"{key} = {text_of(value)}" for key, value in point.values.items())
