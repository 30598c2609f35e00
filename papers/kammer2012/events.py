# SPDX-License-Identifier: BSD-3-Clause
"""What the claims look at: events with their fronts, and how well the criteria order the fronts' speeds."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
import slipfront
from slipfront.read import ratio

SHORTEST_M = 10e-3  # shorter fronts are left out of the claims
TAIL_M = 20e-3  # before a front's end, where the paper sees its speed leave the energy criterion
NEAR_NUCLEATION_M = 5e-3  # next to a spontaneous nucleation, left out of maxima
BINS = 20  # of a criterion's range in spreads and ratios
FEWEST_TO_FIT = 10
CRITERIA = ("static_ratio", "dynamic_ratio", "energy_rise")
# The paper's fit of Fig. 6, V_tip/c_L = a + b exp(-c sqrt((U_r - U_s)/U_s)), and its band.
PAPER_A, PAPER_B, PAPER_C, PAPER_BAND = 0.76, 1.80, 3.05, 0.07

Mask = np.ndarray  # [points], booleans
Series = tuple[np.ndarray, np.ndarray]


def median(values: Any) -> float:
    """Of those that are numbers; NaN without any."""
    known = np.asarray(values, dtype=float)
    known = known[~np.isnan(known)]
    return float(np.median(known)) if known.size else math.nan


@dataclass(frozen=True)
class Front:
    """A front's passage over the nodes of the interface, in the order of travel. [points]"""

    direction: int  # +1 along the shear
    end: str
    mode: str
    node: np.ndarray
    x_m: np.ndarray
    onset_s: np.ndarray
    v_m_per_s: np.ndarray  # V_tip
    static_ratio: np.ndarray  # t_s/p_s
    dynamic_ratio: np.ndarray  # t_d/p_d
    energy_rise: np.ndarray  # (U_r - U_s)/U_s
    pressure_ratio: np.ndarray  # p_r/p_s
    slipping_share: np.ndarray  # of the path behind the tip
    accelerating: np.ndarray

    @property
    def length_m(self) -> float:
        return float(abs(self.x_m[-1] - self.x_m[0])) if len(self.x_m) else 0.0

    @property
    def has_speed(self) -> Mask:
        return np.isfinite(self.v_m_per_s)

    def part(self, which: Mask | slice) -> Front:
        """Some of its points."""
        return replace(self, **{name: getattr(self, name)[which] for name in POINT_FIELDS})


POINT_FIELDS = tuple(f.name for f in fields(Front) if f.type == "np.ndarray")


def front_of(found: Any) -> Front:
    """Of a front as the program finds it."""
    return Front(
        direction=found.direction,
        end=found.end,
        mode=found.mode,
        node=np.array(found.node),
        x_m=np.array(found.x_m),
        onset_s=np.array(found.onset_s),
        v_m_per_s=np.array(found.v_tip_m_per_s),
        static_ratio=ratio(found.t_s_Pa, found.p_s_Pa),
        dynamic_ratio=ratio(found.t_d_Pa, found.p_d_Pa),
        energy_rise=ratio(found.U_r_J_per_m3 - found.U_s_J_per_m3, found.U_s_J_per_m3),
        pressure_ratio=ratio(found.p_r_Pa, found.p_s_Pa),
        slipping_share=np.array(found.slipping_share),
        accelerating=np.array(found.accelerating),
    )


@dataclass(frozen=True)
class Wave:
    """The outermost maximum of |v| on a ray from the plate's left corner; NaN: there is none."""

    time_s: float
    angle_deg: float
    distance_m: float = math.nan  # from the nearest place of the trigger zone
    peak_m_per_s: float = math.nan  # |v| there
    lowest_behind_m_per_s: float = math.nan  # least |v| on the way back to where it is exceeded


@dataclass(frozen=True)
class Event:
    """What the claims need of a run, without its histories and fields."""

    name: str
    kind: str  # left, right or spontaneous
    mu_s: float
    mu_k: float
    width_m: float
    zone_m: float  # of the trigger
    trigger_margin_m: float  # behind the zone
    crack_share: float
    pulse_share: float
    c_L: float
    c_S: float
    fronts: list[Front]  # at least SHORTEST_M long
    x_m: np.ndarray  # [nodes]
    static_ratio: np.ndarray  # [nodes], t_s/p_s
    contact_m: tuple[float, float]
    inside_m: tuple[float, float]
    peak_x_m: float  # of t_s/p_s inside
    first_onset_x_m: float  # inside; of several at once the farthest from the peak; NaN: none
    critical_shear_m: float
    ramp_critical_shear_m: float = math.nan  # NaN where there was no ramp
    ramp_onsets: int = 0  # beginnings of slip at the edges during the ramp
    trigger_work_J_per_m: float = math.nan  # NaN without energies
    waves: list[Wave] = field(default_factory=list)  # of each snapshot; triggered at the left edge alone

    @property
    def triggered(self) -> bool:
        return self.kind in ("left", "right")

    def with_fronts(self, direction: int) -> Event:
        """With those in a direction alone."""
        return replace(self, fronts=[front for front in self.fronts if front.direction == direction])

    def near_trigger(self, x_m: Any) -> Any:
        """Whether places are in the trigger zone or its margin."""
        omitted = self.zone_m + self.trigger_margin_m
        if self.kind == "left":
            return x_m < self.contact_m[0] + omitted
        if self.kind == "right":
            return x_m > self.contact_m[1] - omitted
        return x_m != x_m

    def counts(self, front: Front, leave_out_m: float = 0) -> Mask:
        """Whether points count: outside the trigger zone and its margin, and not nearer than leave_out_m to
        the start of a spontaneously nucleated front."""
        x = front.x_m
        if not len(x):
            return np.zeros(0, dtype=bool)
        return ~self.near_trigger(x) & (self.near_trigger(x[0]) | (np.abs(x - x[0]) >= leave_out_m))

    def with_speed(self, front: Front, leave_out_m: float = 0) -> Front:
        """The points that count and have a speed."""
        return front.part(self.counts(front, leave_out_m) & front.has_speed)


def event_of(name: str, case: Any, found: Any) -> Event:
    """Of what a batch found for a case."""
    keys = tomllib.loads(case.toml)
    inside = found.inside_from_m, found.inside_to_m
    margin = keys["loading"]["edge_margin_m"]
    x, onset = found.onset_x_m, found.onset_s
    at = (x >= inside[0]) & (x <= inside[1])
    first_x = math.nan
    if at.any():
        first = x[at][onset[at] == onset[at].min()]
        first_x = float(first[np.abs(first - found.peak_x_m).argmax()])
    return Event(
        name=name,
        kind=keys["event"]["kind"],
        mu_s=keys["friction"]["mu_s"],
        mu_k=keys["friction"]["mu_k"],
        width_m=keys["plate"]["width_m"],
        zone_m=keys["event"].get("trigger_zone_m", 0.0),  # of triggered events
        trigger_margin_m=keys["fronts"]["trigger_margin_m"],
        crack_share=keys["fronts"]["crack_share"],
        pulse_share=keys["fronts"]["pulse_share"],
        c_L=found.speeds.c_L_m_per_s,
        c_S=found.speeds.c_S_m_per_s,
        fronts=[front_of(f) for f in found.fronts if f.length_m >= SHORTEST_M * (1 - 1e-9)],
        x_m=np.array(found.x_m),  # the original keeps snapshots alive
        static_ratio=ratio(found.t_s_Pa, found.p_s_Pa),
        contact_m=(inside[0] - margin, inside[1] + margin),
        inside_m=inside,
        peak_x_m=found.peak_x_m,
        first_onset_x_m=first_x,
        critical_shear_m=found.critical_shear_m,
        ramp_critical_shear_m=found.ramp_critical_shear_m,
        ramp_onsets=found.ramp_onsets,
        trigger_work_J_per_m=found.trigger_work_J_per_m,
    )


def longest(fronts: Iterable[Front]) -> Front | None:
    return max(fronts, key=lambda front: front.length_m, default=None)


def main_front(event: Event, direction: int) -> Front | None:
    """The longest front in a direction."""
    return longest(front for front in event.fronts if front.direction == direction)


def in_tail(front: Front) -> Mask:
    """Whether points lie within TAIL_M of the end of a front that arrests or runs out of contact."""
    stops = front.end in ("arrest", "contact_end")
    return stops & (np.abs(front.x_m - front.x_m[-1:]) <= TAIL_M)


def paper_fit(energy_rise: Any) -> Any:
    with np.errstate(invalid="ignore"):
        return PAPER_A + PAPER_B * np.exp(-PAPER_C * np.sqrt(energy_rise))


def in_paper_band(energy_rise: Any, v_over_c_L: Any) -> Any:
    """Whether speeds lie within the paper's band; not where the rise is negative or undefined."""
    return (energy_rise >= 0) & (np.abs(v_over_c_L - paper_fit(energy_rise)) <= PAPER_BAND)


def criterion_series(
    events: Iterable[Event], criterion: str, without_tails: bool = False
) -> list[list[Series]]:
    """V_tip/c_L against a criterion, a series for each front of each event; points that count and for which
    the speed and all criteria are defined. [events][fronts]"""
    found = []
    for event in events:
        of_event = []
        for front in event.fronts:
            x = getattr(front, criterion)
            use = event.counts(front) & front.has_speed & np.isfinite(front.energy_rise) & np.isfinite(x)
            if without_tails:
                use &= ~in_tail(front)
            if use.any():
                of_event.append((x[use], front.v_m_per_s[use] / event.c_L))
        found.append(of_event)
    return found


def joined(series: Sequence[Series]) -> Series:
    """Several as one."""
    empty = [np.empty(0)]
    return np.concatenate([s[0] for s in series] or empty), np.concatenate([s[1] for s in series] or empty)


@dataclass(frozen=True)
class Collapse:
    """How well each criterion orders the speeds of a set of events."""

    cases: dict[str, Any]  # spread of V_tip/c_L at equal criterion between the events
    fronts: dict[str, Any]  # and between all their fronts
    fit: Any  # of V_tip/c_L against the energy rise; None below FEWEST_TO_FIT points
    share_in_band: float
    n_points: int


def collapse(events: Sequence[Event], without_tails: bool = False) -> Collapse:
    cases, fronts = {}, {}
    for criterion in CRITERIA:
        of_events = [joined(s) for s in criterion_series(events, criterion) if s]
        cases[criterion] = slipfront.spread_at_equal_x(of_events, bins=BINS)
        energy = [s for part in criterion_series(events, criterion, without_tails) for s in part]
        fronts[criterion] = slipfront.spread_at_equal_x(energy, bins=BINS)
    x, y = joined(energy)  # of the last criterion
    fit = slipfront.fit_exponential(energy) if (x >= 0).sum() >= FEWEST_TO_FIT else None
    share = float(in_paper_band(x, y).mean()) if len(x) else math.nan
    return Collapse(cases, fronts, fit, share, len(x))


def pick(
    events: Iterable[Event], criterion: str, which: Callable[[Event, Front], Any] = lambda *_: True
) -> Series:
    """Speed over c_L against a criterion, of all points that count and have both, as one series.

    which: tells of a front's points that count and have a speed which are taken."""
    series = []
    for event in events:
        for front in event.fronts:
            points = event.with_speed(front)
            x = getattr(points, criterion)
            use = np.isfinite(x) & which(event, points)
            series.append((x[use], points.v_m_per_s[use] / event.c_L))
    return joined(series)


def speed_change(event: Event, reference: Event) -> dict[str, float | int]:
    """Change of V_tip against a run of the same event at equal x: over the nodes of the reference's longest
    front in each direction where both count."""
    changes = [np.empty(0)]
    for direction in (-1, 1):
        ours, theirs = main_front(event, direction), main_front(reference, direction)
        if ours is None or theirs is None:
            continue
        a = event.with_speed(ours, NEAR_NUCLEATION_M)
        b = reference.with_speed(theirs, NEAR_NUCLEATION_M)
        if len(a.x_m) < 2:
            continue
        order = np.argsort(a.x_m)
        x, v = a.x_m[order], a.v_m_per_s[order]
        at = (b.x_m >= x[0]) & (b.x_m <= x[-1])
        changes.append(np.interp(b.x_m[at], x, v) / b.v_m_per_s[at] - 1)
    all_changes = np.concatenate(changes)
    sizes = np.abs(all_changes)
    return {
        "median": median(all_changes),
        "median_absolute": median(sizes),
        "largest": float(sizes.max()) if sizes.size else math.nan,
        "n_points": sizes.size,
    }


def kind_of_slip(event: Event, front: Front) -> np.ndarray:
    """Of points: 0 crack, 1 pulse, 2 mixed. [points]"""
    share = front.slipping_share
    return np.where(share > event.crack_share, 0, np.where(share < event.pulse_share, 1, 2))


def count_kinds(events: Iterable[Event]) -> np.ndarray:
    """Points of each kind along the fronts of events: crack, pulse, mixed."""
    n = np.zeros(3, dtype=int)
    for event in events:
        for front in event.fronts:
            known = np.isfinite(front.slipping_share)
            n += np.bincount(kind_of_slip(event, front)[known], minlength=3)
    return n
