# SPDX-License-Identifier: BSD-3-Clause
"""The claims of the paper as one table: what it says, where, how that is tested, and by what."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import circle
import numpy as np
import slipfront
import xarray as xr
from events import (
    BINS,
    CRITERIA,
    NEAR_NUCLEATION_M,
    PAPER_A,
    PAPER_B,
    PAPER_BAND,
    PAPER_C,
    TAIL_M,
    Collapse,
    Event,
    Front,
    Mask,
    Series,
    collapse,
    count_kinds,
    in_paper_band,
    in_tail,
    joined,
    kind_of_slip,
    main_front,
    median,
    pick,
)
from main_fronts import MainFront, collapse_without_tails, first_front, main_fronts

from cases import Study, Variation

MM = 1e3
KINDS = ("crack", "pulse", "mixed")
# What tests of claims ask for.
MIN_CORRELATION = 0.8  # rank correlation that is a tendency
MIN_SPREAD = 0.2  # of V_tip at equal t_s/p_s that leaves no unique one
MOST_LEFT = 0.6  # C11: left-triggered maximum of speed over the others'
WANTED_IN_BAND = 0.8  # C18: of the points, in the paper's band
WANTED_NEAR_END = 0.7  # C19: of the points outside, before a front's end
FALL_LENGTH_M, FALL_SHARE = 5e-3, 0.1  # C19b: V_tip falls rapidly: by the share within the length
INITIATION_M = 5e-3  # C22b: from the start of the stretch that two fronts cover
ARREST_M = 10e-3  # C22b: before the slower front's end

Figure = tuple[str, float, str]  # name, distinct within its row, value, unit
# What is measured in words, the numbers of it, and whether the claim holds; None: it is not tested.
Found = tuple[str, list[Figure], bool | None]


@dataclass(frozen=True)
class StudyEvents:
    study: Study
    points: list[list[Event]]  # as study.points


@dataclass(frozen=True)
class TriggerSample:
    """How many of the triggers that were sampled within the ranges the paper leaves open let C1 to C10 hold
    and keep the left-triggered maximum at most at 60 % of the other two."""

    n_triggers: int
    n_holding: int


@dataclass(frozen=True)
class LoadedOn:
    """The plate loaded on until all of it has slipped in one event."""

    mu_s: float
    mu_k: float
    largest_friction: float  # F_S/F_N
    n_events: int


@dataclass(frozen=True)
class Reproduction:
    """All runs of a reproduction."""

    spontaneous: Event
    left: Event
    right: Event
    spontaneous_mu_k_1: Event
    studies: dict[str, StudyEvents] = field(default_factory=dict)
    experiment: xr.Dataset | None = None  # its speeds beside the mu_k = 1.0 run's, by compare_speeds
    triggers: TriggerSample | None = None  # where the open choices were studied
    loaded_on: list[LoadedOn] = field(default_factory=list)  # of both mu_k, where all of it slipped

    @property
    def three(self) -> list[Event]:
        return [self.spontaneous, self.left, self.right]

    @cached_property
    def collapse(self) -> Collapse:
        return collapse(self.three)

    @cached_property
    def mains(self) -> list[MainFront]:
        return main_fronts(self.three)

    @cached_property
    def collapse_of_mains(self) -> Collapse:
        return collapse_without_tails(self.mains)


@dataclass(frozen=True)
class ClaimVariation:
    """A row at another value of a numerical parameter."""

    variation: Variation
    measured: str  # there
    holds: bool | None  # there
    differences: list[float]  # |difference| of each figure of the row; NaN where undefined


@dataclass
class Claim:
    """A claim of the paper against this program's figure."""

    id: str
    claim: str
    paper: str  # where it stands
    measured: str  # our figure
    holds: bool | None  # None: not tested
    how: str  # the test
    figures: list[Figure]  # the numbers of `measured`
    second_test_of: str = ""  # id of the row whose test this one corrects
    why: str = ""  # that row's test misjudges the claim
    used_to_choose: bool = False  # the paper's cases were chosen so that it holds, see open_choices.py
    counts: bool = True  # whether the verdict is the claim's, see choose_verdicts
    variations: list[ClaimVariation] = field(default_factory=list)

    @property
    def is_first_test(self) -> bool:
        return not self.second_test_of and not self.id.endswith("+")

    @property
    def verdict(self) -> str:
        if self.holds is None:
            return "not tested"
        if not self.holds:
            return "does not hold"
        return "used to choose" if self.used_to_choose else "holds"


def percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else math.nan


def peak_speed(event: Event, front: Front | None) -> tuple[float, float]:
    """Highest speed of a front over c_L and where; zero without points."""
    points = None if front is None else event.with_speed(front, NEAR_NUCLEATION_M)
    if points is None or not len(points.x_m):
        return 0.0, math.nan
    at = points.v_m_per_s.argmax()
    return float(points.v_m_per_s[at] / event.c_L), float(points.x_m[at])


def max_speed(event: Event) -> float:
    return max((peak_speed(event, front)[0] for front in event.fronts), default=0.0)


def longest_stretch_m(event: Event, leave_out_m: float, condition: Callable[[np.ndarray], Mask]) -> float:
    """Length of the longest run of neighbouring points whose speeds over c_L satisfy a condition."""
    longest = 0.0
    for front in event.fronts:
        inside = event.counts(front, leave_out_m) & front.has_speed & condition(front.v_m_per_s / event.c_L)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]])))
        lengths = np.abs(front.x_m[edges[1::2] - 1] - front.x_m[edges[::2]])
        longest = max(longest, lengths.max(initial=0.0))
    return longest


def correlation(event: Event, direction: int) -> float:
    """Rank correlation of V_tip and t_s/p_s of the longest front in a direction."""
    front = main_front(event, direction)
    if front is None:
        return math.nan
    points = event.with_speed(front)
    return slipfront.rank_correlation(points.static_ratio, points.v_m_per_s)


def wave_speeds(r: Reproduction) -> Found:
    c_L, c_S = r.spontaneous.c_L, r.spontaneous.c_S
    return (
        f"c_L = {c_L:.1f} m/s, c_S = {c_S:.1f} m/s",
        [("c_L", c_L, "m/s"), ("c_S", c_S, "m/s")],
        abs(c_L - 1584) <= 1 and abs(c_S - 890) <= 1,
    )


def static_state(r: Reproduction) -> Found:
    event = r.spontaneous
    inside = event.static_ratio[(event.x_m >= event.inside_m[0]) & (event.x_m <= event.inside_m[1])]
    from_edge_m = min(event.peak_x_m, event.width_m - event.peak_x_m)
    least = inside.min() / inside.max()
    return (
        f"maximum {from_edge_m * MM:.1f} mm from the nearer edge, minimum inside {percent(least)} of it",
        [("maximum", from_edge_m * MM, "mm"), ("minimum", 100 * least, "%")],
        from_edge_m > 0.2 * event.width_m and least < 0.6,
    )


def nucleation(r: Reproduction) -> Found:
    off_m = abs(r.spontaneous.first_onset_x_m - r.spontaneous.peak_x_m)
    figures = [("distance", off_m * MM, "mm")]
    return f"first onset {off_m * MM:.2f} mm from it", figures, off_m <= 2e-3


def correlations(event: Event) -> Found:
    against, along = correlation(event, -1), correlation(event, 1)
    return (
        f"rank correlation {against:.2f} against the shear, {along:.2f} along",
        [("against", against, ""), ("along", along, "")],
        against > MIN_CORRELATION and along > MIN_CORRELATION,
    )


def in_words(ratio: Any) -> str:
    return f"{ratio.median:.2f} ({ratio.low:.2f} to {ratio.high:.2f} over {ratio.n_bins} bins)"


def by_direction(events: Sequence[Event], criterion: str, over: int) -> Any:
    """V_tip of fronts in a direction over that of the others at equal criterion."""
    above, below = (
        pick([event.with_fronts(direction) for event in events], criterion) for direction in (over, -over)
    )
    return slipfront.ratio_at_equal_x(above, below, bins=BINS)


def slower_along(r: Reproduction) -> Found:
    ratio = by_direction([r.spontaneous_mu_k_1], "static_ratio", 1)
    return f"V along / V against = {in_words(ratio)}", [("ratio", ratio.median, "")], ratio.median < 0.9


def arrest(r: Reproduction) -> Found:
    front = main_front(r.spontaneous_mu_k_1, -1)
    if front is None:
        return "no front against the shear", [], False
    run_m, edge_m = front.length_m, float(front.x_m[-1])
    return (
        f"{front.end} after {run_m * MM:.1f} mm, {edge_m * MM:.1f} mm from the edge",
        [("length", run_m * MM, "mm"), ("from the edge", edge_m * MM, "mm")],
        front.end == "arrest" and run_m < 50e-3 and edge_m > 20e-3,
    )


def no_slow_fronts(r: Reproduction) -> Found:
    four = [*r.three, r.spontaneous_mu_k_1]
    all_run = all(event.fronts for event in four)
    slow_m = max(longest_stretch_m(event, 0, lambda v: v < 0.1) for event in four)
    without = "" if all_run else "; an event without a front"
    return (
        f"longest stretch below 0.1 c_L: {slow_m * MM:.1f} mm{without}",
        [("stretch", slow_m * MM, "mm")],
        all_run and slow_m <= 10e-3,
    )


def supersonic(r: Reproduction) -> Found:
    fast_m = max(longest_stretch_m(event, NEAR_NUCLEATION_M, lambda v: v > 1) for event in r.three)
    figures = [("stretch", fast_m * MM, "mm")]
    return f"longest stretch above c_L: {fast_m * MM:.1f} mm", figures, fast_m >= 10e-3


def edge_triggered(r: Reproduction) -> Found:
    texts, figures, holds = [], [], True
    for event, direction in ((r.left, 1), (r.right, -1)):
        front = main_front(event, direction)
        points = None if front is None else event.with_speed(front)
        if points is None or not len(points.x_m):
            holds = False
            texts.append(f"{event.name}: no front")
            continue
        peak, at_m = peak_speed(event, front)
        near = (np.abs(points.x_m - end_m) <= 10e-3 for end_m in (points.x_m[0], points.x_m[-1]))
        first, last = (mean(points.v_m_per_s[at] / event.c_L) / (peak or math.nan) for at in near)
        off_m = abs(at_m - event.peak_x_m)
        holds = holds and off_m <= 10e-3 and first < 0.9 and last < 0.9
        texts.append(
            f"{event.name}: peak {peak:.2f} c_L {off_m * MM:.1f} mm from the maximum, first 10 mm at "
            f"{percent(first)} and last at {percent(last)} of it"
        )
        figures += [
            (f"{event.name} peak", peak, "c_L"),
            (f"{event.name} from the maximum", off_m * MM, "mm"),
            (f"{event.name} first", 100 * first, "%"),
            (f"{event.name} last", 100 * last, "%"),
        ]
    return "; ".join(texts), figures, holds


def left_maximum(r: Reproduction) -> Found:
    spontaneous, left, right = map(max_speed, r.three)
    shares = [left / other if other > 0 else math.nan for other in (spontaneous, right)]
    first, second = (percent(s) if s == s else "no share" for s in shares)
    return (
        f"left {left:.2f}, spontaneous {spontaneous:.2f}, right {right:.2f} c_L: {first} and {second}",
        [
            ("left", left, "c_L"),
            ("spontaneous", spontaneous, "c_L"),
            ("right", right, "c_L"),
            ("left/spontaneous", 100 * shares[0], "%"),
            ("left/right", 100 * shares[1], "%"),
        ],
        left > 0 and left <= MOST_LEFT * spontaneous and left <= MOST_LEFT * right,
    )


def trigger_choice(r: Reproduction) -> Found:
    sample = r.triggers
    if sample is None or sample.n_triggers == 0:
        return "not tested: no study of the open choices", [], None
    share = sample.n_holding / sample.n_triggers
    return (
        f"{sample.n_holding} of {sample.n_triggers} triggers ({percent(share)})",
        [("share", 100 * share, "%")],
        sample.n_holding > 0,
    )


def not_unique(spreads: dict[str, Any]) -> Found:
    spread = spreads["static_ratio"]
    value = spread.median_relative
    words = f"median relative spread {percent(value)} over {spread.n_bins} bins"
    return words, [("spread", 100 * value, "%")], value > MIN_SPREAD


def smaller_spread(spreads: dict[str, Any]) -> Found:
    by_static, by_dynamic, by_energy = (spreads[c].median_relative for c in CRITERIA)
    return (
        f"median relative spread {percent(by_dynamic)} against t_d/p_d, {percent(by_static)} against t_s/p_s "
        f"({percent(by_energy)} against the energy rise)",
        [
            ("t_d/p_d", 100 * by_dynamic, "%"),
            ("t_s/p_s", 100 * by_static, "%"),
            ("energy", 100 * by_energy, "%"),
        ],
        by_dynamic < by_static,
    )


def far_from_strength(r: Reproduction) -> Found:
    differences, below = [np.empty(0)], [np.empty(0)]
    for event in r.three:
        for front in event.fronts:
            s, d = front.static_ratio, front.dynamic_ratio
            use = event.counts(front) & np.isfinite(s) & np.isfinite(d)
            differences.append(np.abs(d[use] - s[use]) / s[use])
            below.append(d[use] < 0.9 * event.mu_s)
    difference, share = mean(np.concatenate(differences)), mean(np.concatenate(below))
    return (
        f"mean relative difference {percent(difference)}, below 0.9 mu_s over {percent(share)} of the path",
        [("difference", 100 * difference, "%"), ("below", 100 * share, "%")],
        difference > 0.1 and share > 0.5,
    )


def faster_against(r: Reproduction) -> Found:
    ratio = by_direction(r.three, "dynamic_ratio", -1)
    return f"V against / V along = {in_words(ratio)}", [("ratio", ratio.median, "")], ratio.median > 1


def faster_accelerating(r: Reproduction) -> Found:
    texts, figures, holds = [], [], True
    for event, direction in ((r.left, 1), (r.right, -1)):
        main = main_front(event, direction)
        of_main = [replace(event, fronts=[] if main is None else [main])]
        faster = pick(of_main, "dynamic_ratio", lambda _, front: front.accelerating)
        slower = pick(of_main, "dynamic_ratio", lambda _, front: ~front.accelerating)
        ratio = slipfront.ratio_at_equal_x(faster, slower, bins=BINS)
        holds = holds and ratio.median > 1
        texts.append(f"{event.name}: {in_words(ratio)}")
        figures.append((event.name, ratio.median, ""))
    return "; ".join(texts), figures, holds


def falls_while_rising(r: Reproduction) -> Found:
    lengths: dict[int, list[float]] = {-1: [], 1: []}
    for event in r.three:
        for front in event.fronts:
            p = front.part(event.counts(front))
            s_m = np.abs(p.x_m - p.x_m[:1])
            lengths[front.direction] += list(slipfront.falls_while_rises(s_m, p.v_m_per_s, p.dynamic_ratio))
    (n_against, against), (n_along, along) = ((len(v), max(v, default=0.0)) for v in lengths.values())
    return (
        f"against: {n_against} stretches, longest {against * MM:.1f} mm; along: {n_along}, "
        f"longest {along * MM:.1f} mm",
        [
            ("stretches against", float(n_against), ""),
            ("longest against", against * MM, "mm"),
            ("stretches along", float(n_along), ""),
            ("longest along", along * MM, "mm"),
        ],
        n_against > 0 and n_along == 0,
    )


def collapses(c: Collapse, compared: bool = False) -> Found:
    """compared: with the paper's fit in words."""
    if c.fit is None:
        return "too few points for a fit", [], None
    abc = {name: getattr(c.fit, name) for name in "abc"}
    fit = ", ".join(f"{name} = {e.value:.2f} [{e.low:.2f}, {e.high:.2f}]" for name, e in abc.items())
    paper = f"; the paper: a = {PAPER_A:.2f}, b = {PAPER_B:.2f}, c = {PAPER_C:.2f}" if compared else ""
    return (
        f"(a) rms {c.fit.rms:.3f} c_L about {fit}; (b) {percent(c.share_in_band)} of {c.n_points} points "
        f"within the paper's band{paper}",
        [
            ("rms", c.fit.rms, "c_L"),
            *((name, e.value, "") for name, e in abc.items()),
            ("within the band", 100 * c.share_in_band, "%"),
        ],
        c.fit.rms <= PAPER_BAND and c.share_in_band >= WANTED_IN_BAND,
    )


def orders_main_fronts(c: Collapse) -> Found:
    if c.fit is None:
        return "too few points for a fit", [], None
    by_static, by_dynamic, by_energy = (c.fronts[name].median_relative for name in CRITERIA)
    return (
        f"spread {percent(by_energy)} at equal (U_r-U_s)/U_s, {percent(by_dynamic)} at equal t_d/p_d, "
        f"{percent(by_static)} at equal t_s/p_s",
        [
            ("energy", 100 * by_energy, "%"),
            ("t_d/p_d", 100 * by_dynamic, "%"),
            ("t_s/p_s", 100 * by_static, "%"),
        ],
        by_energy < by_dynamic and by_energy < by_static,
    )


def outside_the_band(r: Reproduction) -> Found:
    outside = near_end = 0
    for event in r.three:
        for front in event.fronts:
            use = event.counts(front) & front.has_speed & np.isfinite(front.energy_rise)
            out = use & ~in_paper_band(front.energy_rise, front.v_m_per_s / event.c_L)
            outside += int(out.sum())
            near_end += int((out & in_tail(front)).sum())
    if r.collapse.n_points == 0:
        return "no points", [], None
    share = near_end / outside if outside else math.nan
    return (
        f"{percent(share)} of {outside} points outside the band" if outside else "no points outside",
        [("share", 100 * share, "%")],
        outside == 0 or near_end >= WANTED_NEAR_END * outside,
    )


def where_speed_falls(points: Front) -> Mask:
    """Whether points lie on a stretch of at most FALL_LENGTH_M from whose first to whose last point V_tip
    falls by more than FALL_SHARE."""
    x, v = points.x_m, points.v_m_per_s
    n = len(x)
    # Lengths that are whole numbers of elements do not fall on either side of a limit by rounding.
    within = np.abs(x[None, :] - x[:, None]) <= FALL_LENGTH_M * (1 + 1e-9)
    begins, ends = np.nonzero(np.triu(within & (v[None, :] < (1 - FALL_SHARE) * v[:, None]), 1))
    steps = np.zeros(n + 1, dtype=int)
    np.add.at(steps, begins, 1)
    np.add.at(steps, ends + 1, -1)
    return np.cumsum(steps[:n]) > 0


def outside_rapid_falls(r: Reproduction) -> Found:
    n = np.zeros(5, dtype=int)  # all, outside; of these near an end, where V_tip falls, or either
    for main in r.mains:
        p = main.points
        use = p.has_speed & np.isfinite(p.energy_rise)
        out = use & ~in_paper_band(p.energy_rise, p.v_m_per_s / main.event.c_L)
        near, falls = out & main.in_tail, out & where_speed_falls(p)
        n += [mask.sum() for mask in (use, out, near, falls, near | falls)]
    total, outside, near_end, falling, explained = map(int, n)
    if total == 0:
        return "no points", [], None
    figures: list[Figure] = [
        ("points outside", float(outside), ""),
        ("near an end", float(near_end), ""),
        ("where V_tip falls", float(falling), ""),
    ]
    if outside == 0:
        return f"none of {total} points outside", figures, True
    figures.append(("share", 100 * explained / outside, "%"))
    return (
        f"{percent(explained / outside)} of the {outside} points outside the band ({near_end} near an end, "
        f"{falling} where V_tip falls), of {total} in all",
        figures,
        explained >= WANTED_NEAR_END * outside,
    )


def spontaneous_of(events: Iterable[Event]) -> list[Event]:
    return [event for event in events if not event.triggered]


def shares_of_kinds(n: np.ndarray) -> list[float]:
    return [float(each / n.sum()) if n.sum() else math.nan for each in n]


def kinds_in_words(n: np.ndarray) -> str:
    return ", ".join(
        f"{kind} {percent(share)}" for kind, share in zip(KINDS, shares_of_kinds(n), strict=True)
    )


def kind_figures(n: np.ndarray) -> list[Figure]:
    return [(kind, 100 * share, "%") for kind, share in zip(KINDS, shares_of_kinds(n), strict=True)]


def crack_share(r: Reproduction, spontaneous_only: bool) -> Found | None:
    mu_k = r.studies.get("mu_k")
    if mu_k is None:
        return None if spontaneous_only else ("not tested: no studies", [], None)
    texts, figures, shares, total = [], [], [], np.zeros(3, dtype=int)
    for point, events in zip(mu_k.study.points, mu_k.points, strict=True):
        n = count_kinds(spontaneous_of(events) if spontaneous_only else events)
        total += n
        if n.sum():
            shares.append(float(n[0] / n.sum()))
            figures.append((point.value, 100 * shares[-1], "%"))
        texts.append(f"{point.value}: {percent(shares[-1]) if n.sum() else 'no front'}")
    falls = len(shares) > 1 and all(b <= a for a, b in zip(shares, shares[1:], strict=False))
    return (
        f"share of crack-like path at mu_k = {', '.join(texts)}; of all: {kinds_in_words(total)}",
        figures + (kind_figures(total) if total.sum() else []),
        bool(falls and shares[-1] < shares[0] and total.min() > 0),
    )


def crack_trend(r: Reproduction) -> Found:
    mu_k = r.studies.get("mu_k")
    if mu_k is None:
        return "not tested: no studies", [], None
    values, shares, texts, figures, total = [], [], [], [], np.zeros(3, dtype=int)
    for point, events in zip(mu_k.study.points, mu_k.points, strict=True):
        total += count_kinds(events)
        n = count_kinds(spontaneous_of(events))
        if not n.sum():
            continue
        values.append(point.number)
        shares.append(float(n[0] / n.sum()))
        texts.append(f"{point.value}: {percent(shares[-1])}")
        figures.append((point.value, 100 * shares[-1], "%"))
    if len(shares) < 3:
        return "not tested: fronts at fewer than 3 values of mu_k", [], None
    trend = slipfront.rank_correlation(values, shares)
    words = f"rank correlation {trend:.2f}" if math.isfinite(trend) else "the same share throughout"
    return (
        f"{words} (share of crack-like path at mu_k = {', '.join(texts)}); of the study's path: "
        f"{kinds_in_words(total)}",
        [*figures, ("rank correlation", trend, ""), *kind_figures(total)],
        bool(trend <= -MIN_CORRELATION and total.min() > 0),
    )


def by_kind(events: Iterable[Event]) -> list[Series]:
    """Speeds against the energy rise by kind of slip."""
    events = list(events)

    def of(kind: int) -> Series:
        return pick(
            events,
            "energy_rise",
            lambda event, front: np.isfinite(front.slipping_share) & (kind_of_slip(event, front) == kind),
        )

    return [of(kind) for kind in range(len(KINDS))]


def median_difference(kinds: Sequence[Series]) -> float:
    """Median over bins of x of the largest difference of the series' medians of y, in bins that at least two
    reach."""
    all_x = joined(kinds)[0]
    if not all_x.size or all_x.min() == all_x.max():
        return math.nan
    low, high = all_x.min(), all_x.max()
    bins = [np.clip(((x - low) / (high - low) * BINS).astype(int), 0, BINS - 1) for x, _ in kinds]
    differences = []
    for k in range(BINS):
        medians = [median(y[at == k]) for (_, y), at in zip(kinds, bins, strict=True) if (at == k).any()]
        if len(medians) > 1:
            differences.append(max(medians) - min(medians))
    return median(differences)


def independent_of_kind(difference: float, more: str) -> Found:
    figures = [("difference", difference, "c_L")]
    if not math.isfinite(difference):
        return "only one kind of slip", figures, None
    words = f"median difference between kinds {difference:.3f} c_L{more}"
    return words, figures, difference < 2 * PAPER_BAND


def kinds_together(r: Reproduction) -> Found:
    mu_k = r.studies.get("mu_k")
    if mu_k is None:
        return "not tested: no studies", [], None
    kinds = by_kind(event for events in mu_k.points for event in events)
    n = ", ".join(f"{len(x)} {kind}" for (x, _), kind in zip(kinds, KINDS, strict=True))
    return independent_of_kind(median_difference(kinds), f" ({n} points)")


def kinds_one_by_one(r: Reproduction) -> Found | None:
    mu_k = r.studies.get("mu_k")
    if mu_k is None:
        return None
    of_points = zip(mu_k.study.points, map(median_difference, map(by_kind, mu_k.points)), strict=True)
    known = {point.value: difference for point, difference in of_points if math.isfinite(difference)}
    texts = ", ".join(f"{value}: {difference:.3f}" for value, difference in known.items())
    return independent_of_kind(median(list(known.values())), f" ({texts})" if known else "")


def mean_speeds(values: Iterable[str], means: Iterable[float]) -> tuple[str, list[Figure]]:
    """In words and as figures."""
    pairs = list(zip(values, means, strict=True))
    texts = (f"{value}: {f'{v:.2f}' if math.isfinite(v) else 'no front'}" for value, v in pairs)
    return f"mean V_tip/c_L at alpha = {', '.join(texts)}", [(value, v, "c_L") for value, v in pairs]


def falls_at_every_step(means: Sequence[float]) -> bool:
    return all(b < a for a, b in zip(means, means[1:], strict=False))


def speeds_by_fifths(events: Iterable[Event]) -> tuple[np.ndarray, float]:
    """Mean speeds over c_L of both fronts of the spontaneous event in fifths of their path, and of all."""
    fifths, speeds = [np.empty(0, dtype=int)], [np.empty(0)]
    for event in spontaneous_of(events):
        for direction in (-1, 1):
            front = main_front(event, direction)
            if front is None:
                continue
            p = event.with_speed(front, NEAR_NUCLEATION_M)
            fifths.append(np.minimum(4, (5 * np.abs(p.x_m - front.x_m[0]) / front.length_m).astype(int)))
            speeds.append(p.v_m_per_s / event.c_L)
    place, v = np.concatenate(fifths), np.concatenate(speeds)
    return np.array([mean(v[place == k]) for k in range(5)]), mean(v)


def slower_at_ends(r: Reproduction) -> Found:
    alpha = r.studies.get("alpha")
    if alpha is None:
        return "not tested: no studies", [], None
    fifths, means = zip(*map(speeds_by_fifths, alpha.points), strict=True)
    words, figures = mean_speeds((p.value for p in alpha.study.points), means)
    figures = [figure for figure in figures if math.isfinite(figure[1])]
    known = [k for k, v in enumerate(means) if math.isfinite(v)]
    if len(known) < 2:
        return words, figures, False
    drop = 1 - fifths[known[-1]] / fifths[known[0]]
    first, between, last = float(drop[0]), float(drop[1:4].sum() / 3), float(drop[4])
    return (
        f"{words}; relative drop in the first fifth {percent(first)}, between {percent(between)}, in the "
        "last "
        f"{percent(last)}",
        [
            *figures,
            ("first fifth", 100 * first, "%"),
            ("between", 100 * between, "%"),
            ("last fifth", 100 * last, "%"),
        ],
        falls_at_every_step([means[k] for k in known]) and first > between and last > between,
    )


def drops_at_equal_x(fast: Front, slow: Front) -> dict[str, float]:
    """Relative drop of V_tip from one front to another, in one direction on one mesh, at the same nodes:
    medians over the first INITIATION_M, the middle third and the last ARREST_M before the slower front's end
    of the stretch that both cover. NaN where a part has no node at which both have a speed."""
    begin = max(slow.direction * front.x_m[0] for front in (fast, slow))
    end = min(slow.direction * front.x_m[-1] for front in (fast, slow))
    a, b = fast.part(fast.has_speed), slow.part(slow.has_speed)
    _, at_a, at_b = np.intersect1d(a.node, b.node, return_indices=True)
    along = slow.direction * b.x_m[at_b]
    s, length = along - begin, end - begin
    drop = 1 - b.v_m_per_s[at_b] / a.v_m_per_s[at_a]
    covered = (s >= 0) & (s <= length)
    parts = {
        "first": s <= INITIATION_M * (1 + 1e-9),
        "middle": (s >= length / 3) & (s <= 2 * length / 3),
        "last": slow.direction * slow.x_m[-1] - along <= ARREST_M * (1 + 1e-9),
    }
    return {name: median(drop[covered & part]) for name, part in parts.items()}


WHERE = {
    "first": f"in the first {INITIATION_M * MM:g} mm",
    "middle": "in the middle third",
    "last": f"in the last {ARREST_M * MM:g} mm",
}


def drops_with_alpha(r: Reproduction, ends: tuple[str, ...]) -> Found:
    """ends: of "first" and "last", those where the drop has to be larger than in the middle; with both the
    mean speed has to fall, too."""
    alpha = r.studies.get("alpha")
    if alpha is None:
        return "not tested: no studies", [], None
    spontaneous = [next(iter(spontaneous_of(events)), None) for events in alpha.points]
    texts, figures, holds = [], [], True
    for direction, name in ((-1, "against"), (1, "along")):
        fast, slow = (
            None if event is None else first_front(event, direction)
            for event in (spontaneous[0], spontaneous[-1])
        )
        if fast is None or slow is None:
            return "not tested: no fronts to compare", [], None
        drops = drops_at_equal_x(fast, slow)
        told = [part for part in WHERE if part in ends or part == "middle"]
        parts = ", ".join(f"{percent(drops[part])} {WHERE[part]}" for part in told)
        texts.append(f"drop {name} the shear: {parts}")
        figures += [(f"{name} {part}", 100 * drops[part], "%") for part in told]
        holds = holds and all(drops[end] > drops["middle"] for end in ends)
    if len(ends) > 1:
        means = [mean_speed(event) for event in spontaneous]
        words, of_means = mean_speeds((point.value for point in alpha.study.points), means)
        texts.append(words)
        figures += of_means
        holds = holds and means[0] < math.inf and falls_at_every_step(means)
    return "; ".join(texts), figures, holds


def mean_speed(event: Event | None) -> float:
    """Mean V_tip/c_L over both fronts of a spontaneous event; NaN without points."""
    fronts = [first_front(event, direction) for direction in (-1, 1)] if event is not None else []
    speeds = [
        event.with_speed(front, NEAR_NUCLEATION_M).v_m_per_s / event.c_L
        for front in fronts
        if event is not None and front is not None
    ]
    return mean(np.concatenate([np.empty(0), *speeds]))


def behind_the_wave(r: Reproduction) -> Found:
    event, front = r.left, main_front(r.left, 1)
    points = None if front is None else event.with_speed(front)
    fast = None if points is None else points.part(points.v_m_per_s > event.c_S)
    if fast is None or not len(fast.x_m):
        return "no super-shear points", [], False
    lag_m = event.contact_m[0] + event.zone_m + event.c_L * fast.onset_s - fast.x_m
    share, least = mean(lag_m > 0), float(lag_m.min()) * MM
    return (
        f"tip behind c_L (t - t_trigger) at {percent(share)} of the super-shear points, by at least "
        f"{least:.1f} mm",
        [("share", 100 * share, "%"), ("least distance", least, "mm")],
        bool((lag_m > 0).all()),
    )


def global_friction(r: Reproduction) -> Found:
    if not r.loaded_on:
        return "not tested: no sequences", [], None
    texts = (
        f"mu_k = {p.mu_k:g}: {p.largest_friction:.3f}, {percent(p.largest_friction / p.mu_s)} of {p.mu_s:g}, "
        f"after {p.n_events} events"
        for p in r.loaded_on
    )
    figures = [(f"mu_k = {p.mu_k:g}", p.largest_friction, "") for p in r.loaded_on]
    return "; ".join(texts), figures, all(p.largest_friction <= 0.9 * p.mu_s for p in r.loaded_on)


def wave_apart(r: Reproduction) -> Found:
    wave = circle.circle_of(r.left)
    if wave is None:
        return "not tested: no snapshots", [], None
    n = wave.n_snapshots
    return (
        f"in {wave.n_apart} of {n} snapshots; medians: {wave.peak_m_per_s:.1f} m/s, at {wave.over_c_L_t:.2f} "
        f"c_L (t - t_trigger), lowest behind {wave.gap:.2f} of it",
        [
            ("share", 100 * wave.n_apart / n if n else math.nan, "%"),
            ("peak", wave.peak_m_per_s, "m/s"),
            ("lowest behind", wave.gap, ""),
        ],
        wave.holds,
    )


def agrees_with_experiment(r: Reproduction) -> Found:
    if r.experiment is None:
        return "not tested: no data", [], None
    deviation, n = float(r.experiment["misfit_of_all"]), int(r.experiment["n"])
    if n == 0:
        return "not tested: no point within the range of t_s/p_s of our fronts", [], None
    return (
        f"median relative deviation {percent(deviation)} over the {n} of {r.experiment.sizes['point']} "
        "points within the range of t_s/p_s of our fronts",
        [("deviation", 100 * deviation, "%")],
        deviation <= 0.2,
    )


@dataclass(frozen=True)
class Row:
    """A row of the table. A second test says why the first one misjudges its claim."""

    id: str
    claim: str
    paper: str
    how: str
    test: Callable[[Reproduction], Found | None]  # None: no row
    second_test_of: str = ""
    why: str = ""
    used_to_choose: bool = False


CRITERIA_CLAIM = "no unique V_tip for a given t_s/p_s"
SPREAD_CLAIM = "the spread of V_tip is smaller against t_d/p_d than against t_s/p_s"
LEFT_CLAIM = f"the left-triggered maximum is at most {percent(MOST_LEFT)} of that of the other two"
COLLAPSE_CLAIM = "all three cases collapse against (U_r-U_s)/U_s on a + b exp(-c sqrt(.))"
OUTSIDE_CLAIM = "points outside the band are fronts decelerating rapidly before arrest"
MODES_CLAIM = "larger mu_s - mu_k: crack-like; smaller: pulse-like; mixed modes exist"
KIND_CLAIM = "V_tip against the stress state does not depend on the type of slip"
ALPHA_CLAIM = "higher alpha: slower, above all at initiation and arrest"
LONGER_PATHS = (
    "a slower front arrests earlier, so that the same fifth of two fronts' own paths lies at different "
    "stresses"
)
COMPARED = (
    "spontaneous, from the least to the largest alpha, at equal x on the stretch that both fronts cover, in "
    "each "
    "direction: the median relative drop of V_tip is larger "
)
AT_ARREST = f"{WHERE['last']} before the slower front's end"

# Rows whose id ends in + are further tests beside the first one, rows that end in b or c second tests; second
# tests (C21+ is one, too) say why the first one misjudges its claim.
TABLE = (
    Row(
        "C1",
        "c_L = 1584 m/s and c_S = 890 m/s follow from E, nu, rho in plane stress",
        "Table 1",
        "each within 1 m/s",
        wave_speeds,
    ),
    Row(
        "C2",
        "t_s/p_s is nonuniform with its maximum far from the edges",
        "Set-up",
        "maximum more than 0.2 w from both edges; minimum inside below 0.6 of it",
        static_state,
    ),
    Row(
        "C3",
        "slip nucleates spontaneously at that maximum",
        "Set-up",
        "first onset inside within 2 mm of it (of several at once, the farthest)",
        nucleation,
    ),
    Row(
        "C4",
        "mu_k = 1.0: V_tip grows with t_s/p_s",
        "Fig. 2",
        f"rank correlation above {MIN_CORRELATION} for each direction",
        lambda r: correlations(r.spontaneous_mu_k_1),
    ),
    Row(
        "C5",
        "mu_k = 1.0: the front along the shear is considerably slower",
        "Fig. 2",
        "median over bins of t_s/p_s of V along / V against below 0.9",
        slower_along,
    ),
    Row(
        "C6",
        "mu_k = 1.0: the front against the shear arrests not far from the initiation zone",
        "Results",
        "arrest within 50 mm of nucleation, more than 20 mm from the edge",
        arrest,
    ),
    Row(
        "C7",
        "no slow fronts under this loading",
        "Results",
        "V_tip below 0.1 c_L nowhere over more than 10 mm, in all four events",
        no_slow_fronts,
    ),
    Row(
        "C8",
        "mu_k = 0.6, spontaneous: fast toward both edges, slower as t_s/p_s falls",
        "Fig. 3d",
        f"rank correlation of V_tip and t_s/p_s above {MIN_CORRELATION}, both directions",
        lambda r: correlations(r.spontaneous),
    ),
    Row(
        "C9",
        "supersonic fronts occur",
        "Results",
        f"V_tip above c_L over at least 10 mm, {NEAR_NUCLEATION_M * MM:g} mm next to spontaneous nucleation "
        "left "
        "out",
        supersonic,
    ),
    Row(
        "C10",
        "edge-triggered fronts start slowly, accelerate, peak at the maximal t_s/p_s, decelerate",
        "Fig. 3d",
        "peak within 10 mm of the maximum; means of the first and last 10 mm below 0.9 of the peak; trigger "
        "zone "
        "and margin left out",
        edge_triggered,
    ),
    Row(
        "C11",
        LEFT_CLAIM,
        "Results",
        f"ratio of maxima to each at most {MOST_LEFT}; {NEAR_NUCLEATION_M * MM:g} mm next to spontaneous "
        "nucleation, trigger zones and margins left out",
        left_maximum,
        used_to_choose=True,
    ),
    Row(
        "C11b",
        LEFT_CLAIM,
        "Results",
        "of the triggers sampled within the stated ranges there is one for which the left-triggered maximum "
        "is at "
        f"most {percent(MOST_LEFT)} of the other two while C1 to C10 hold",
        trigger_choice,
        "C11",
        "the paper does not give its trigger, and the left-triggered maximum follows it: the first test "
        "judges our "
        "choice",
    ),
    Row(
        "C12",
        CRITERIA_CLAIM,
        "Fig. 3d",
        f"spread at equal t_s/p_s over the three cases above {percent(MIN_SPREAD)}: (largest - smallest "
        "median of "
        "a case) / mean of the medians, median over bins",
        lambda r: not_unique(r.collapse.cases),
    ),
    Row(
        "C12+",
        CRITERIA_CLAIM,
        "Fig. 3d",
        "as C12 over all fronts of the three cases, each direction and each later front for itself",
        lambda r: not_unique(r.collapse.fronts),
    ),
    Row(
        "C13",
        "t_d/p_d differs significantly from t_s/p_s and is far from mu_s over most of the path",
        "Fig. 4",
        "mean relative difference above 10 %; below 0.9 mu_s over more than half the path",
        far_from_strength,
    ),
    Row(
        "C14",
        SPREAD_CLAIM,
        "Fig. 5",
        "same measure as C12, smaller",
        lambda r: smaller_spread(r.collapse.cases),
    ),
    Row(
        "C14+",
        SPREAD_CLAIM,
        "Fig. 5",
        "same measure as C12+, smaller",
        lambda r: smaller_spread(r.collapse.fronts),
    ),
    Row(
        "C15",
        "at equal t_d/p_d fronts against the sliding are faster",
        "Fig. 5",
        "median over bins of t_d/p_d above 1, the three cases together",
        faster_against,
    ),
    Row(
        "C16",
        "at equal t_d/p_d accelerating fronts are faster than decelerating ones",
        "Fig. 5",
        "V accelerating / V decelerating above 1 within each edge-triggered front",
        faster_accelerating,
    ),
    Row(
        "C17",
        "V_tip drops while t_d/p_d rises only for fronts against the sliding",
        "Fig. 5",
        "stretches of at least 5 mm: found against the sliding, none along it",
        falls_while_rising,
    ),
    Row(
        "C18",
        COLLAPSE_CLAIM,
        "Fig. 6",
        f"(a) rms about our own fit at most {PAPER_BAND} c_L; (b) at least {percent(WANTED_IN_BAND)} of the "
        "points "
        f"within a = {PAPER_A:.2f} +- {PAPER_BAND}, b = {PAPER_B:.2f}, c = {PAPER_C:.2f}",
        lambda r: collapses(r.collapse),
    ),
    Row(
        "C18+",
        COLLAPSE_CLAIM,
        "Fig. 6",
        f"as C18 without the last {TAIL_M * MM:g} mm before a front's end, which the paper sees fall "
        "outside (C19)",
        lambda r: collapses(collapse(r.three, True)),
    ),
    Row(
        "C18b",
        COLLAPSE_CLAIM,
        "Fig. 6",
        f"main fronts without their last {TAIL_M * MM:g} mm: (a) and (b) as C18",
        lambda r: collapses(r.collapse_of_mains, compared=True),
        "C18",
        "its points are those of late fronts in the wake of others, too",
    ),
    Row(
        "C18c",
        "the energy rise orders the speeds of fronts, the ratios of the tractions do not",
        "Conclusions",
        f"main fronts without their last {TAIL_M * MM:g} mm: the median relative spread of V_tip between the "
        "fronts is smaller at equal (U_r-U_s)/U_s than at equal t_d/p_d and at equal t_s/p_s",
        lambda r: orders_main_fronts(r.collapse_of_mains),
        "C18",
        "a curve is one thing, which quantity orders the speeds another",
    ),
    Row(
        "C19",
        OUTSIDE_CLAIM,
        "Fig. 6",
        f"at least {percent(WANTED_NEAR_END)} of them lie in the last {TAIL_M * MM:g} mm before arrest",
        outside_the_band,
    ),
    Row(
        "C19b",
        OUTSIDE_CLAIM,
        "Fig. 6",
        f"of the main fronts' points outside the band at least {percent(WANTED_NEAR_END)} lie in the last "
        f"{TAIL_M * MM:g} mm before a front's end, or on a stretch of at most {FALL_LENGTH_M * MM:g} mm "
        "along which "
        f"V_tip falls by more than {percent(FALL_SHARE)}",
        outside_rapid_falls,
        "C19",
        "rapid deceleration is a matter of speed, not of a fixed distance from the arrest",
    ),
    Row(
        "C20",
        MODES_CLAIM,
        "Results",
        "mu_k = 0.4 to 1.2, three events each: share of crack-like path falls at every step; each kind "
        "occurs",
        lambda r: crack_share(r, False),
    ),
    Row(
        "C20+",
        MODES_CLAIM,
        "Results",
        "as C20 for the spontaneous event alone: behind the right-hand trigger, which is held, the "
        "interface slips "
        "whatever mu_k",
        lambda r: crack_share(r, True),
    ),
    Row(
        "C20b",
        MODES_CLAIM,
        "Results",
        f"spontaneous events: rank correlation of mu_k with the share of crack-like path at most "
        f"{-MIN_CORRELATION}; each kind occurs over the study",
        crack_trend,
        "C20",
        "the paper tells a tendency, which one step against it does not refute; and behind a trigger that "
        "is held "
        "the interface slips whatever mu_k",
    ),
    Row(
        "C21",
        KIND_CLAIM,
        "Results",
        "over the mu_k study: at equal (U_r-U_s)/U_s the largest difference of the kinds' medians, median "
        "over "
        f"bins, below the band's full width, {2 * PAPER_BAND:.2f} c_L",
        kinds_together,
    ),
    Row(
        "C21+",
        KIND_CLAIM,
        "Results",
        "as C21 at one mu_k at a time, median over mu_k: the relation itself changes with mu_k",
        kinds_one_by_one,
        "C21",
        "the relation of speed and stress state changes with mu_k, whatever the kind of slip",
    ),
    Row(
        "C22",
        ALPHA_CLAIM,
        "Results",
        "alpha = 0.01 to 1 m2/s2, spontaneous: mean V_tip falls at every step; from least to largest alpha "
        "it "
        "drops more in the first and last fifth of the path than between",
        slower_at_ends,
    ),
    Row(
        "C22b",
        ALPHA_CLAIM,
        "Results",
        f"{COMPARED}{WHERE['first']} and {AT_ARREST} than in the middle third; mean V_tip falls at every "
        "step of "
        "alpha",
        lambda r: drops_with_alpha(r, ("first", "last")),
        "C22",
        LONGER_PATHS,
    ),
    Row(
        "C22b1+",
        "higher alpha: slower, above all at initiation",
        "Results",
        f"{COMPARED}{WHERE['first']} than in the middle third",
        lambda r: drops_with_alpha(r, ("first",)),
    ),
    Row(
        "C22b2+",
        "higher alpha: slower, above all at arrest",
        "Results",
        f"{COMPARED}{AT_ARREST} than in the middle third",
        lambda r: drops_with_alpha(r, ("last",)),
    ),
    Row(
        "C23",
        "the super-shear tip follows the longitudinal wave front",
        "Fig. 3a",
        "left-triggered: wherever V_tip exceeds c_S the tip is behind the wave from the trigger zone's "
        "inner end",
        behind_the_wave,
    ),
    Row(
        "C24",
        "the local mu_s is considerably higher than the global static coefficient of friction",
        "Set-up",
        "the plate loaded on until all nodes inside slip in one event: largest F_S/F_N before it at most "
        "0.9 mu_s, "
        "for both mu_k",
        global_friction,
    ),
    Row(
        "C25",
        "the longitudinal wave of the left trigger is a light circle apart from what follows",
        "Fig. 3a",
        f"snapshots every {circle.INTERVAL_S * 1e6:g} us while the left-triggered tip is between "
        f"{circle.TIP_FROM_M * MM:g} and {circle.TIP_TO_M * MM:g} mm, rays of 30 and 45 degrees from the "
        "left "
        f"corner: in at least {percent(circle.MIN_SHARE)} of the snapshots, on both rays, the outermost "
        "maximum of "
        f"the velocity from {circle.MIN_PEAK_M_PER_S:g} m/s on lies within {percent(circle.MAX_OFF_C_L_T)} "
        "of "
        "c_L (t - t_trigger) from the trigger zone, and the lowest velocity behind it, before it is "
        "exceeded, is "
        f"at most {circle.MAX_GAP:g} of it",
        wave_apart,
        used_to_choose=True,
    ),
    Row(
        "E1",
        "mu_k = 1.0 agrees quantitatively with the experiments",
        "Fig. 2",
        "only with a user's file of points: median over the points of |V - V_measured| / V_measured at most "
        "20 %, "
        "V the median speed of the mu_k = 1.0 run within 0.02 of the point's t_s/p_s",
        agrees_with_experiment,
    ),
)


def choose_verdicts(claims: Sequence[Claim]) -> None:
    """Decides which row's verdict counts for its claim: that of the first of its second tests that was done,
    else that of the first test. Rows that are only further tests do not count."""
    by_id = {claim.id: claim for claim in claims}
    for claim in claims:
        claim.counts = claim.is_first_test
    for second in claims:
        first = by_id.get(second.second_test_of)
        if first is not None and second.holds is not None and first.counts:
            second.counts, first.counts = True, False


def scorecard(runs: Reproduction) -> list[Claim]:
    """Tests every claim."""
    claims = []
    for row in TABLE:
        with np.errstate(invalid="ignore", divide="ignore"):
            found = row.test(runs)
        if found is None:
            continue
        measured, figures, holds = found
        verdict = None if holds is None else bool(holds)
        about = row.second_test_of, row.why, row.used_to_choose and verdict is not None
        claims.append(Claim(row.id, row.claim, row.paper, measured, verdict, row.how, figures, *about))
    choose_verdicts(claims)
    return claims


def add_variation(claims: Iterable[Claim], variation: Variation, varied: Iterable[Claim]) -> None:
    """Tells each claim by how much its figures differ from those of the same claim in the variation's runs.
    Rows are matched by id, figures by name."""
    others = {claim.id: claim for claim in varied}
    for claim in claims:
        other = others.get(claim.id)
        if other is None:
            continue
        there = {name: value for name, value, _ in other.figures}
        differences = [abs(there.get(name, math.nan) - value) for name, value, _ in claim.figures]
        claim.variations.append(ClaimVariation(variation, other.measured, other.holds, differences))


def summary(claims: Iterable[Claim]) -> str:
    """How many of the paper's claims hold, do not, and are not tested: by the rows that count, and by the
    first tests alone. For people. Without the comparison with experiments (E1)."""
    of_paper = [claim for claim in claims if claim.id.startswith("C")]

    def text(rows: list[Claim]) -> str:
        n = {
            word: sum(row.verdict == word for row in rows)
            for word in ("holds", "does not hold", "not tested")
        }
        used = sum(row.verdict == "used to choose" for row in rows)
        more = f", {used} used to choose" if used else ""
        return f"{n['holds']} hold, {n['does not hold']} do not, {n['not tested']} not tested{more}"

    counted = [claim for claim in of_paper if claim.counts]
    first = [claim for claim in of_paper if claim.is_first_test]
    return (
        f"Of the paper's {len(counted)} claims {text(counted)}, where second tests take the place of first "
        "ones; "
        f"by the first tests alone {text(first)}."
    )


def describe(claim: Claim, variation: ClaimVariation) -> str:
    """How far a row moves, for people: the differences with their units, and the verdict where it is
    another."""

    def difference(value: float, unit: str) -> str:
        ending = f" {unit}" if unit else ""
        if not math.isfinite(value):
            return "undefined"
        if 0 < value < 1e-3:
            return f"< 0.001{ending}"
        return (f"{value:.2g}" if value < 10 else f"{value:.0f}") + ending

    if claim.holds is not None and variation.holds is None:
        return "not tested"
    texts = [
        (f"{name}: " if len(claim.figures) > 1 else "") + difference(value, unit)
        for (name, _, unit), value in zip(claim.figures, variation.differences, strict=True)
    ]
    text = ", ".join(texts)
    if variation.holds != claim.holds:
        text += f"{'; ' if text else ''}there {'holds' if variation.holds else 'does not hold'}"
    return text
