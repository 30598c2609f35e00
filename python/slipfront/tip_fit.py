# SPDX-License-Identifier: BSD-3-Clause
"""The near-tip field of a front fitted to records of strain gauges. docs/gauges.md

K is positive where the body above slips to +x."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

from slipfront import _core
from slipfront.errors import CaseError
from slipfront.gauges import COMPONENTS, Gauge, amplifier, gaussian, smooth, some_gauges, weights
from slipfront.given import flag, instance, number, shown, whole
from slipfront.near_tip import Bodies, TipField, bodies_of, require_field
from slipfront.opened import OpenRun
from slipfront.running import CaseLike
from slipfront.units import beyond

LARGE_RESIDUAL = 0.3  # of the record: it is not that of such a tip
LARGE_ERROR = 0.5  # of Gamma
LEAST_SIGNAL = 5  # of the root of Gamma, tip and speed given, over its error: below, none has passed
#: By so many joint errors, and by this share, the speed from gauge to gauge misses those fitted at both.
SEVERAL, OTHER_SPEED = 3, 0.1
LEAST_APART = 2.0  # heights that a front runs between two passages; a cohesive zone is nearer to its tip
#: Of the range of speeds below c_S, and of that above, from which a fit may start.
SHARES, FAST_SHARES = (0.3, 0.6, 0.85, 0.95), (0.2, 0.5, 0.8)
START_ZONES = (0.0, 3.0, 12.0)  # lengths of the zone from which a fit may start, in heights
STARTS = 3  # the best of them are refined
#: Times of a start while the front runs the gauge's height, or a quarter of the zone; and most of them.
FINE, MOST_EDGES = 8, 10**6
LEAST_TIMES = 8
#: Metals are elastic up to some 0.2 %, rock breaks at 0.2 to 0.5 %; glassy polymers alone of what is above
#: this modulus bear more. Fronts change strains by 1e-5 to 1e-3: more, if these are numbers of percent.
STIFF_STRAIN, STIFF_PA = 0.002, 1e9
NORMAL_MEDIAN = 0.6745  # of the size of a normal variable, over its standard deviation
#: Shares of squares: a record that changes less is constant; one of which less is left is explained.
CONSTANT, ROUNDING = 1e-24, 1e-12
#: Of least squares: the share of the square that a step is to take off it, along a profile and at its end;
#: and other tolerances, which end nothing.
PROFILE_GAIN, LEAST_GAIN, LEAST = 1e-5, 1e-7, 1e-15
ROUNDS = 3  # of fits of several tips, each without the others
#: Reach of a fit from the tip: so many heights of the gauge and cohesive zones.
REACH_HEIGHTS, REACH_ZONES = 3.0, 2.0
WINDOWS = 6  # of times, each for the zone that the one before has found
#: Lengths of the zone that are tried, from this share of the height to this of the reach, one over the other.
SHORTEST, LONGEST, RATIO = 0.1, 2.0, 1.6
BESIDE = (0.86, 0.97, 1.03, 1.16)  # and beside the best one, over that, for its interval


@dataclass(frozen=True)
class TipFit:
    """The tip of a front as a gauge saw it pass. Errors are standard ones; NaN of what was given. Where no
    front passed: numbers NaN, direction 0, and why in doubts."""

    gauge: str
    x_m: float
    y_m: float
    together: int  # gauges that share V along x, Gamma and tau_p - tau_r with this one, itself among them
    direction: int  # of the front along x
    tip_s: float  # when the tip is below, or above, the gauge
    tip_error_s: float
    speed_m_per_s: float
    speed_error_m_per_s: float
    K_Pa_sqrt_m: float  # NaN above c_S
    Gamma_J_per_m2: float
    Gamma_error_J_per_m2: float
    cohesive_zone_m: float  # X_c at this gauge; 0: none is seen
    zone_low_m: float  # from and to which the record says no more, by one error
    zone_high_m: float
    strength_drop_Pa: float  # tau_p - tau_r; inf without a zone
    offset: dict[str, float]  # by component: the level ahead of the tip that the field adds to
    step: dict[str, float]  # and by how much it changes until far behind
    residual: dict[str, float]  # rms of the residuals over that of the record in the fit, about its mean
    residual_of_all: float
    n_times: int
    doubts: list[str]  # why the fit is not fit for use; empty where nothing speaks against it
    time_s: np.ndarray = field(repr=False)  # of the fit
    fitted: dict[str, np.ndarray] = field(repr=False)

    @property
    def has_tip(self) -> bool:
        return self.direction != 0


@dataclass(frozen=True)
class Settings:
    """How a fit is done: see fit_tip."""

    speed_m_per_s: float | None = None
    direction: int | None = None
    tip_s: float | None = None
    zone: str = "linear"
    zone_m: float | None = None
    r_max_m: float | None = None
    step: bool = True

    def checked(self, bodies: Bodies, gauges: list[Gauge]) -> Settings:
        flag(self.step, "step")
        made = replace(
            self,
            speed_m_per_s=number_or_none(self.speed_m_per_s, "speed_m_per_s", above=0),
            zone_m=number_or_none(self.zone_m, "zone_m", least=0),
            r_max_m=number_or_none(self.r_max_m, "r_max_m", above=0),
            tip_s=number_or_none(self.tip_s, "tip_s"),
        )
        if self.direction not in (None, 1, -1):
            raise CaseError(f"direction is {shown(self.direction)}; it must be 1, -1 or None")
        for gauge in gauges:
            if made.r_max_m is not None and not made.r_max_m > abs(gauge.y_m):
                raise CaseError(
                    f"gauge {gauge.name}: r_max_m is {made.r_max_m:g} m; it must be above the gauge's "
                    f"height, {abs(gauge.y_m):g} m"
                )
        # At rest there is a field in any case: without a speed the zone's name alone is checked.
        require_field(bodies, made.speed_m_per_s or 0.0, made.zone_m, self.zone, "zone_m")
        return made

    def reach_m(self, height_m: float, zone_m: float) -> float:
        return self.r_max_m or REACH_HEIGHTS * height_m + REACH_ZONES * zone_m


def number_or_none(given: Any, name: str, **bounds: float) -> float | None:
    return None if given is None else number(given, name, finite=True, **bounds)


class Trial(NamedTuple):
    """How the model does at some parameters."""

    signal: float  # the root of Gamma over its error, squared, the parameters given
    slips_to_x: bool  # K is positive


def ranked(trials: list[Trial]) -> list[int]:
    """From the clearest one. Without xy both directions are alike: then slip to +x comes first."""
    seen = [k for k, t in enumerate(trials) if t.signal > 0]
    return sorted(seen, key=lambda k: (-round(np.log10(trials[k].signal), 6), not trials[k].slips_to_x))


def squares(of: list[np.ndarray]) -> float:
    return sum(float((a**2).sum()) for a in of)


class Record:
    """A gauge as the model sees it."""

    def __init__(self, gauge: Gauge) -> None:
        self.gauge = gauge
        self.height_m = abs(gauge.y_m)
        self.parts = gauge.parts
        self.weights = [weights(part) for part in self.parts]
        self.places_m = [gauge.places_m.get(part, (gauge.x_m, gauge.y_m)) for part in self.parts]
        self.data = np.array([gauge.values[part] for part in self.parts])
        self.time_s = gauge.time_s
        self.step_s = float(np.median(np.diff(self.time_s)))
        self.leaked: np.ndarray | None = None  # integrals of the data, where a high-pass is sought
        #: Weights of what the record has passed, and how many of them are of times to come.
        self.kernel = gaussian(gauge.smoothing_s / self.step_s)
        self.n_to_come = len(self.kernel) // 2
        if gauge.bandwidth_Hz < np.inf:
            self.kernel = np.convolve(
                self.kernel, amplifier(gauge.bandwidth_Hz, self.step_s, len(self.time_s))
            )

    def inside(self, speed: float, tip_s: float, reach_m: float) -> np.ndarray:
        """Indices of the times at which the gauge is in reach of the tip."""
        far_s = np.sqrt(max(reach_m**2 - self.height_m**2, 0)) / speed
        return np.arange(*np.searchsorted(self.time_s, [tip_s - far_s, tip_s + far_s]))

    def shapes(
        self, tip: TipField, speed: float, tip_s: float, at: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The field of each component or arm, and the step that goes with it, at these times. [parts,
        times]"""
        time_s = self.time_s[at]
        if len(self.kernel) > 1:
            before = len(self.kernel) - 1 - self.n_to_come
            time_s = self.time_s[0] + self.step_s * np.arange(at[0] - before, at[-1] + self.n_to_come + 1)
        of = tip.strain if self.gauge.is_strain else tip.stress
        at_place: dict[tuple[float, float], tuple[np.ndarray, np.ndarray]] = {}
        for place in self.places_m:
            if place not in at_place:
                x_m = tip.direction * speed * (tip_s - time_s) + (place[0] - self.gauge.x_m)
                # 0 ahead and 1 behind on the interface, and harmonic above it.
                step = np.arctan2(abs(place[1]), tip.direction * x_m) / np.pi
                at_place[place] = of(x_m, np.full_like(x_m, place[1])), step
        rows = [w @ at_place[p][0] for w, p in zip(self.weights, self.places_m, strict=True)]
        steps = [at_place[place][1] for place in self.places_m]
        if len(self.kernel) > 1:
            rows, steps = ([smooth(row, self.kernel)[at - at[0]] for row in of] for of in (rows, steps))
        return np.array(rows), np.array(steps)

    def levels(self, steps: np.ndarray | None, at: np.ndarray) -> np.ndarray:
        """Columns of what each component has of its own: offset, and step. [parts x times, ...]"""
        level = np.repeat(np.eye(len(self.parts)), len(at), axis=0)
        columns = [level] if steps is None else [level, level * steps.reshape(-1, 1)]
        if self.leaked is not None:  # dy/dt = dx/dt - 2 pi f y: it takes the integral of what it leaves
            columns.append(self.leaked[:, at].reshape(-1, 1))
        return np.hstack(columns)

    def rest(self, of: list[np.ndarray], steps: np.ndarray | None, at: np.ndarray) -> np.ndarray:
        """Rows [parts, times], one after the other, without what the levels can make of them. [..., parts,
        times]"""
        rows = np.array(of if self.leaked is None else [*of, self.leaked[:, at]])
        rows = rows - rows.mean(axis=2, keepdims=True)
        if steps is not None:
            one = steps - steps.mean(axis=1, keepdims=True)
            one /= np.maximum(np.sqrt((one**2).sum(axis=1, keepdims=True)), 1e-300)
            rows -= (rows * one).sum(axis=2, keepdims=True) * one
        if self.leaked is None:
            return rows
        *rest, leaked = rows
        return np.array([row - ((row * leaked).sum() / (leaked**2).sum()) * leaked for row in rest])


class Path(NamedTuple):
    """When the tip passes the places x: times, s, and slownesses, s/m, are linear in the parameters, which
    are times but for a last one, a slowness, where the speed is free."""

    of_times: np.ndarray  # [places, parameters]
    of_slowness: np.ndarray
    slowness: float = 0.0  # that is given
    is_free: bool = False


def path_of(x_m: np.ndarray, direction: int, speed_m_per_s: float | None, one_speed: bool) -> Path:
    """A given speed; a free one, of one place or of all; or that of the tips' times along x: of two places
    the line through them, of three the parabola, of more the cubic spline."""
    n = len(x_m)
    if speed_m_per_s is not None:
        return Path(np.eye(n), np.zeros((n, n)), slowness=1 / speed_m_per_s)
    if n == 1 or one_speed:
        along = direction * (x_m - x_m[0])
        return Path(np.column_stack([np.ones(n), along]), np.tile([0.0, 1.0], (n, 1)), is_free=True)
    each = np.eye(n)
    return Path(each, direction * CubicSpline(x_m, each).derivative()(x_m))


class Front:
    """The model: gauges that the tip of one front passes, with one Gamma and one tau_p - tau_r."""

    def __init__(
        self, gauges: list[Gauge], bodies: Bodies, settings: Settings, direction: int, fast: bool,
        one_speed: bool = False,
    ) -> None:  # fmt: skip
        self.records = [Record(gauge) for gauge in gauges]
        self.bodies, self.settings, self.direction, self.fast = bodies, settings, direction, fast
        self.x_m, self.place = np.unique([g.x_m for g in gauges], return_inverse=True)
        self.path = path_of(self.x_m, direction, settings.speed_m_per_s, one_speed)
        low, high = bodies.ranges_m_per_s()[fast]
        self.range = low + 0.001 * (high - low), high - 0.001 * (high - low)
        self.at: list[np.ndarray] = []  # times of the fit, of each gauge

    def times_and_speeds(self, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of the tip at each gauge; speeds within their range."""
        slowness = self.path.of_slowness @ c + self.path.slowness
        speeds = 1 / np.clip(slowness, 1 / self.range[1], 1 / self.range[0])
        return (self.path.of_times @ c)[self.place], speeds[self.place]

    def fields(self, speeds: np.ndarray, zone_m: float) -> list[TipField]:
        """zone_m: X_c at the least speed. With Gamma and tau_p - tau_r it changes with the speed."""
        of = partial(TipField, self.bodies, direction=self.direction, zone=self.settings.zone)
        drop = of(min(speeds), zone_m=zone_m).drop_per_root if zone_m > 0 else np.inf
        one = {v: of(v, zone_m=1.0).drop_per_root if zone_m > 0 else 0.0 for v in set(speeds)}
        made = {v: of(v, zone_m=(one[v] / drop) ** 2) for v in one}
        return [made[v] for v in speeds]

    def look(self, c: np.ndarray, zone_m: float) -> bool:
        """Takes the times in reach of the tip; whether these are enough."""
        tips, speeds = self.times_and_speeds(c)
        fields = self.fields(speeds, zone_m)
        reach = [
            self.settings.reach_m(r.height_m, f.zone_m) for r, f in zip(self.records, fields, strict=True)
        ]
        self.at = [r.inside(v, t, m) for r, v, t, m in zip(self.records, speeds, tips, reach, strict=True)]
        return all(len(at) >= LEAST_TIMES for at in self.at)

    def system(self, c: np.ndarray, zone_m: float) -> tuple[np.ndarray, np.ndarray]:
        """Field over the root of Gamma, and records, both without what offsets and steps can make of them."""
        tips, speeds = self.times_and_speeds(c)
        made = []
        for r, tip, v, t, at in zip(
            self.records, self.fields(speeds, zone_m), speeds, tips, self.at, strict=True
        ):
            rows, steps = r.shapes(tip, v, t, at)
            rest = r.rest([rows, r.data[:, at]], steps if self.settings.step else None, at)
            made.append(rest.reshape(2, -1))
        shape, data = np.concatenate(made, axis=1)
        return shape, data

    def solved(self, c: np.ndarray, zone_m: float) -> tuple[float, np.ndarray, np.ndarray]:
        """The best root of Gamma, what it leaves of the records, and the field over it."""
        shape, data = self.system(c, zone_m)
        root = float(shape @ data) / float(shape @ shape)
        return root, data - root * shape, shape

    def data(self) -> list[np.ndarray]:
        return [r.data[:, at] for r, at in zip(self.records, self.at, strict=True)]

    def changes(self) -> list[np.ndarray]:
        """The records in the fit about their means."""
        return [d - d.mean(axis=1, keepdims=True) for d in self.data()]

    def split(self, rows: np.ndarray) -> list[np.ndarray]:
        """Of all gauges, to each [parts, times]."""
        shapes = [(len(r.parts), len(at)) for r, at in zip(self.records, self.at, strict=True)]
        ends = np.cumsum([n * m for n, m in shapes])[:-1]
        return [a.reshape(shape) for a, shape in zip(np.split(rows, ends), shapes, strict=True)]

    def scale(self, c: np.ndarray) -> np.ndarray:
        """Changes of the parameters that a record feels."""
        _, speeds = self.times_and_speeds(c)
        takes_s = min(r.height_m / v for r, v in zip(self.records, speeds, strict=True))
        scale = np.full(len(c), 0.1 * takes_s)
        if self.path.is_free:
            scale[-1] = 0.1 / min(speeds)
        return scale

    def start(self, tips_s: np.ndarray, speed: float) -> np.ndarray:
        """Parameters of times at the places, and of a speed where it is free."""
        return np.array([tips_s[0], 1 / speed]) if self.path.is_free else tips_s

    def n_columns(self, c: np.ndarray) -> int:
        """Parameters of the model, linear ones among them."""
        return sum(len(r.parts) * (1 + self.settings.step) for r in self.records) + len(c) + 1

    def trial(self, c: np.ndarray, zone_m: float) -> Trial:
        square = squares(self.changes())
        if square <= CONSTANT * squares(self.data()):  # of a record that does not change
            return Trial(0.0, False)
        root, rest, shape = self.solved(c, zone_m)
        left = self.split(rest)
        n_apart = sum(a.size / correlated(a) for a in left) - self.n_columns(c)
        explained, of_left = root**2 * float(shape @ shape), max(squares(left), ROUNDING * square)
        return Trial(explained / of_left * max(n_apart, 1), root > 0)

    def nearest(
        self, c: np.ndarray, zone_m: float, free_zone: bool = False, gain: float = LEAST_GAIN
    ) -> tuple[np.ndarray, float]:
        """Parameters, and the zone where it is free, that leave least of the records at these times."""
        scale = self.scale(c)

        def grown(u: np.ndarray) -> float:
            return float(np.exp(np.clip(0.1 * u[-1], -5, 5)))

        def left(u: np.ndarray) -> np.ndarray:
            return self.solved(c + scale * u[: len(c)], zone_m * grown(u) if free_zone else zone_m)[1]

        start = np.zeros(len(c) + free_zone)
        if not np.isfinite(left(start)).all():
            return c, zone_m
        # Ended by what is gained alone: other tolerances are of numbers that are near 1.
        u = least_squares(left, start, method="lm", ftol=gain, xtol=LEAST, gtol=LEAST).x
        return c + scale * u[: len(c)], zone_m * grown(u) if free_zone else zone_m


class Profile(NamedTuple):
    """What is left of the records over the length of the cohesive zone, all else sought at each.
    Ascending."""

    zone_m: np.ndarray
    square: np.ndarray
    others: np.ndarray  # the root of Gamma, and the parameters [zones, ...]

    def ends(self, variance: float) -> tuple[list[float], np.ndarray]:
        """Zones at which the square is above the least one by the variance, on both sides, or where the range
        ends; and the others there."""
        k = int(self.square.argmin())
        more = np.sqrt((self.square - self.square[k]) / variance)
        zones, others = [], []
        for side in (np.arange(k, -1, -1), np.arange(k, len(more))):
            beyond = np.flatnonzero(more[side] > 1)
            last = int(beyond[0]) if beyond.size else len(side) - 1
            two = side[max(last - 1, 0) : last + 1]
            share = np.interp(1.0, more[two], np.arange(len(two)))
            at = two[0], two[-1]
            zones.append(float((1 - share) * self.zone_m[at[0]] + share * self.zone_m[at[1]]))
            others.append((1 - share) * self.others[at[0]] + share * self.others[at[1]])
        return zones, np.array(others)


def profile_of(front: Front, c: np.ndarray, zone_m: float) -> tuple[Profile, np.ndarray, float]:
    """At the times of the fit; with the parameters and the zone that leave least."""
    height_m = min(r.height_m for r in front.records)
    reach_m = max(front.settings.reach_m(r.height_m, zone_m) for r in front.records)
    n = int(np.ceil(np.log(LONGEST * reach_m / (SHORTEST * height_m)) / np.log(RATIO)))
    lengths = SHORTEST * height_m * RATIO ** np.arange(n + 1)
    begin = int(np.abs(np.log(lengths / max(zone_m, lengths[0]))).argmin())
    found: dict[float, tuple[float, np.ndarray]] = {}

    def add(at_m: float, start: np.ndarray, free: bool = False) -> np.ndarray:
        near, at_m = front.nearest(start, at_m, free, LEAST_GAIN if free else PROFILE_GAIN)
        root, left, _ = front.solved(near, at_m)
        found[at_m] = float((left**2).sum()), np.append(root, near)
        return near

    for side in (lengths[begin:], [*lengths[:begin][::-1], *([] if front.fast else [0.0])]):
        near = c
        for length in side:
            near = add(float(length), near)
    best = min(found, key=lambda length: found[length][0])
    if best > 0:
        add(best, found[best][1][1:], free=True)
    best = min(found, key=lambda length: found[length][0])
    for share in BESIDE:
        add(share * best, found[best][1][1:])
    best = min(found, key=lambda length: found[length][0])
    zones = np.array(sorted(found))
    squares_left = np.array([found[z][0] for z in zones])
    made = Profile(zones, squares_left, np.array([found[z][1] for z in zones]))
    return made, found[best][1][1:], best


class Fitted(NamedTuple):
    front: Front
    c: np.ndarray
    zone_m: float
    profile: Profile | None = None


def refined(front: Front, c: np.ndarray, zone_m: float) -> Fitted | None:
    """The nearest fit, whose times follow the tip and the zone; None where these are too few."""
    given = front.settings.zone_m
    zone_m = zone_m if given is None else given
    if not front.look(c, zone_m):
        return None
    for _ in range(WINDOWS):
        before = front.at
        c, zone_m = front.nearest(c, zone_m, free_zone=given is None and zone_m > 0)
        if not front.look(c, zone_m):
            front.at = before
            break
        if all(np.array_equal(a, b) for a, b in zip(before, front.at, strict=True)):
            break
    return Fitted(front, c, zone_m)


def profiled(found: Fitted) -> Fitted:
    """With the zone that leaves least of all, where it is not given."""
    front, c, zone_m, profile = found
    if front.settings.zone_m is not None:
        return found
    for _ in range(WINDOWS):
        profile, c, zone_m = profile_of(front, c, zone_m)
        before = front.at
        if not front.look(c, zone_m) or all(
            abs(len(a) - len(b)) <= 0.05 * len(b) for a, b in zip(before, front.at, strict=True)
        ):
            front.at = before
            break
    return Fitted(front, c, zone_m, profile)


@contextmanager
def solvable(what: str) -> Iterator[None]:
    """Refuses numbers that linear algebra or their size makes useless."""
    try:
        with np.errstate(all="ignore"):
            yield
    except (np.linalg.LinAlgError, OverflowError):
        raise CaseError(f"{what}: cannot be fitted: its numbers are too large or too small") from None


def fit_tip(gauge: Gauge, bodies: OpenRun | CaseLike | _core.Case | Bodies, **settings: Any) -> TipFit:
    """The field of the tip of a front fitted to a gauge's record: Gamma, the cohesive zone X_c, the speed,
    the time of the tip, and of each component an offset and a step of the residual stress or strain.

    bodies: see bodies_of. Settings: speed_m_per_s, where it is known. direction: +1 or -1 along x, None: the
    one that explains more. tip_s: about when the tip passes, None: where the field explains most. zone: how
    the strength falls, "linear" over the distance from the tip, or over "slip". zone_m: X_c where it is
    known, 0: a singular tip. r_max_m: how far from the tip the gauge is in the fit, by default 3 heights and
    2 zones. step: False: none. Errors follow from the Jacobian, the scatter with the correlation of
    neighbouring residuals, and from what lengths of the zone do as well. Raises CaseError."""
    instance(gauge, Gauge, "gauge")
    of = bodies_of(bodies)
    made = Settings(**settings).checked(of, [gauge])
    with solvable(f"gauge {gauge.name}"):
        fit = sought(gauge, of, made)
    if made.direction is None and fit.has_tip and gauge.parts == ["xy"]:  # the same in a mirror
        return replace(fit, doubts=[*fit.doubts, "xy alone does not tell which way: give direction"])
    return fit


def starts_of(
    gauge: Gauge, bodies: Bodies, settings: Settings
) -> list[tuple[Trial, Front, np.ndarray, float]]:
    """The best time of the tip at each direction, speed and zone."""
    ranges = bodies.ranges_m_per_s()[: len(gauge.parts)]  # one component does not tell a V above c_S
    shares = zip(ranges, (SHARES, FAST_SHARES), strict=False)
    speeds = [low + share * (high - low) for (low, high), of in shares for share in of]
    if settings.speed_m_per_s is not None:
        speeds = [settings.speed_m_per_s]
    zones = [n * abs(gauge.y_m) for n in START_ZONES] if settings.zone_m is None else [settings.zone_m]
    ways = (1, -1) if settings.direction is None else (settings.direction,)
    found = []
    for way, V, zone_m in product(ways, speeds, zones):
        fast = bodies.c_S_m_per_s < V
        if fast and zone_m == 0:
            continue
        front = Front([gauge], bodies, settings, way, fast)
        tip_s = time_of_tip(gauge, TipField(bodies, V, way, zone_m, settings.zone), V, settings)
        if tip_s is None:
            continue
        c = front.start(np.array([tip_s]), V)
        if front.look(c, zone_m):
            found.append((front.trial(c, zone_m), front, c, zone_m))
    return found


def time_of_tip(gauge: Gauge, tip: TipField, speed: float, settings: Settings) -> float | None:
    """When a field explains most of the record: on even times, as fine as the field asks for, whose values
    are means about them. The record goes on as it ends. None where it is too long or too short for that."""
    record = Record(gauge)
    reach_m = settings.reach_m(record.height_m, tip.zone_m)
    step_s = max(max(record.height_m, tip.zone_m / 4) / speed / FINE, record.step_s)
    n = int(np.sqrt(reach_m**2 - record.height_m**2) / speed / step_s)
    ends = record.time_s[[0, -1]]
    if settings.tip_s is not None:
        ends = settings.tip_s + np.array([-2, 2]) * FINE * step_s
    edges = ends[0] + step_s * (np.arange(-n, int(np.ptp(ends) / step_s) + n + 2) - 0.5)
    if n < 2 or len(edges) > MOST_EDGES:
        return None
    gone = cumulative_trapezoid(record.data, record.time_s, initial=0)
    # Integrals, linear beyond the ends, and from them means.
    integrals = [
        np.interp(edges, record.time_s, row)
        + v[0] * np.minimum(edges - record.time_s[0], 0)
        + v[-1] * np.maximum(edges - record.time_s[-1], 0)
        for row, v in zip(gone, record.data, strict=True)
    ]
    means = np.diff(integrals, axis=1) / step_s
    windows = np.lib.stride_tricks.sliding_window_view(means, 2 * n + 1, axis=1)  # [parts, tips, times]
    windows = windows.transpose(1, 0, 2).reshape(windows.shape[1], -1)
    none = dict.fromkeys(record.parts, np.arange(2 * n + 1.0))  # the model asks for the times alone
    even = gauge.changed((), time_s=step_s * np.arange(-n, n + 1.0), values=none)
    model, at = Record(even), np.arange(2 * n + 1)
    rows, steps = model.shapes(tip, speed, 0.0, at)
    levels = np.repeat(np.eye(len(rows)), len(at), axis=0) / np.sqrt(len(at))
    shape = model.rest([rows], steps if settings.step else None, at).ravel()
    changes = (windows**2).sum(axis=1) - ((windows @ levels) ** 2).sum(axis=1)
    q, _ = np.linalg.qr(model.levels(steps if settings.step else None, at))
    explained = (windows @ shape) ** 2 / (shape @ shape)
    left = (windows**2).sum(axis=1) - ((windows @ q) ** 2).sum(axis=1) - explained
    left = np.maximum(left, np.maximum(ROUNDING * changes, CONSTANT * (windows**2).sum(axis=1).max()))
    return float(ends[0] + step_s * int((explained / np.maximum(left, 1e-300)).argmax()))


def sought(gauge: Gauge, bodies: Bodies, settings: Settings) -> TipFit:
    """The best fit from several starts."""
    starts = starts_of(gauge, bodies, settings)
    ended = [refined(*starts[k][1:]) for k in ranked([start[0] for start in starts])[:STARTS]]
    fits = [fit for fit in ended if fit is not None]
    order = ranked([f.front.trial(f.c, f.zone_m) for f in fits])
    if not order:
        few = (
            f"fewer than {LEAST_TIMES} times are in reach of a tip: give a larger r_max_m, or check the "
            "units of y and time"
        )
        doubts = beyond({"limiting_speed_m_per_s": bodies.limit_m_per_s})
        return no_tip(gauge, few, f"nothing changes, or {few}", doubts, bodies)
    (fit,) = result(profiled(fits[order[0]]))
    return fit


class Estimate(NamedTuple):
    """What the gauges of a fit share."""

    root: float  # of Gamma, negative where the body above slips to -x
    Gamma_error_J_per_m2: float
    signal: float  # the root over its error, tip and speed given
    #: X_c over that of the best fit, and from and to; lengths where that is 0.
    zones: tuple[float, float, float]
    of_c: np.ndarray  # covariance of the parameters
    left: list[np.ndarray]  # of each record
    of_all: float  # rms of what is left over that of the records
    doubts: list[str]


def estimate(found: Fitted) -> Estimate:
    front, c, zone_m, profile = found
    bodies, given = front.bodies, front.settings
    root, rest, shape = front.solved(c, zone_m)
    if not np.isfinite(shape).all():
        raise np.linalg.LinAlgError  # of which LAPACK would print a line
    left = front.split(rest)
    n_columns = front.n_columns(c) + (profile is not None)
    n_apart = sum(a.size / correlated(a) for a in left)
    variance = max(squares(left) / max(n_apart - n_columns, 1), 1e-300)

    slopes = [shape]
    for move in np.diag(1e-2 * front.scale(c)):
        up, down = (d - root * k for k, d in (front.system(c + move, zone_m), front.system(c - move, zone_m)))
        slopes.append((up - down) / (2 * move.sum()))
    jacobian = np.column_stack(slopes)
    size = np.linalg.norm(jacobian, axis=0)
    size[size == 0] = 1
    covariance = variance * np.linalg.pinv((jacobian / size).T @ (jacobian / size)) / np.outer(size, size)
    zones, instead = (float(zone_m > 0),) * 3, "" if given.speed_m_per_s else ": give speed_m_per_s"
    is_open = False
    if profile is not None:
        (low, high), others = profile.ends(variance)
        zones = (1.0, low / zone_m, high / zone_m) if zone_m > 0 else (0.0, low, high)
        traded = 0.5 * (others[1] - others[0])  # what the zone makes of the others
        is_open = high >= profile.zone_m[-1]
        if traded[0] ** 2 > covariance[0, 0]:
            from_to = " to ".join(f"{root**2:.3g}" for root in others[:, 0])
            zone = f"{1e3 * low:.3g} to {1e3 * high:.3g} mm{' and more' if is_open else ''}"
            instead = (
                f": a cohesive zone of {zone} does as well, with {from_to} J/m2: give zone_m, or gauges "
                "nearer and farther together"
            )
        covariance = covariance + np.outer(traded, traded)
    Gamma, Gamma_error = root**2, 2 * abs(root) * float(np.sqrt(covariance[0, 0]))

    doubts = beyond({"limiting_speed_m_per_s": bodies.limit_m_per_s, "Gamma_J_per_m2": Gamma})
    of_all = float(np.sqrt(squares(left) / max(squares(front.changes()), 1e-300)))
    if of_all > LARGE_RESIDUAL:
        doubts.append(f"the residual is {100 * of_all:.0f} % of the record: it is not that of such a tip")
    low, high = bodies.ranges_m_per_s()[front.fast]
    _, speeds = front.times_and_speeds(c)
    least = low if front.fast else 0.03 * high
    if given.speed_m_per_s is None and not all(least < V < high - 0.003 * (high - low) for V in speeds):
        doubts.append(f"V went to the end of its range, {low:.4g} to {high:.5g} m/s: give speed_m_per_s")
    if is_open or not Gamma_error <= LARGE_ERROR * Gamma:
        doubts.append(f"the record hardly determines Gamma{instead}")
    if root < 0 and not any(r.gauge.doubts for r in front.records):  # of arms at wrong places, which turn it
        doubts.append("K is negative: the body above slips to -x")
    signal = abs(root) * float(np.sqrt(shape @ shape / variance))
    return Estimate(root, Gamma_error, signal, zones, covariance[1:, 1:], left, of_all, doubts)


def result(found: Fitted) -> list[TipFit]:
    """Of each gauge, with errors and doubts."""
    front, c, zone_m, _ = found
    shared = estimate(found)
    tips, speeds = front.times_and_speeds(c)
    fields = front.fields(speeds, zone_m)
    of_each = (front.records, fields, tips, speeds, front.at, shared.left, front.place)
    return [of_gauge(front, shared, *each) for each in zip(*of_each, strict=True)]


def of_gauge(
    front: Front, shared: Estimate, record: Record, tip: TipField, tip_s: float, speed: float, at: np.ndarray,
    left: np.ndarray, place: int,
) -> TipFit:  # fmt: skip
    gauge, bodies, given, n = record.gauge, front.bodies, front.settings, len(record.parts)
    data, time_s = record.data[:, at], record.time_s[at]
    about_mean = data - data.mean(axis=1, keepdims=True)
    largest, most = "strain" if gauge.is_strain else "stress_Pa", float(np.abs(about_mean).max())
    doubts = shared.doubts + beyond({largest: most})
    if gauge.is_strain and most > STIFF_STRAIN and bodies.youngs_modulus_Pa > STIFF_PA:
        doubts.append(
            f"strain changes by {most:.2g}, beyond the elastic range of bodies as stiff: check its units"
        )
    if shared.signal < LEAST_SIGNAL:
        return no_tip(
            gauge,
            f"a tip's field fits by {shared.signal:.1f} errors, {LEAST_SIGNAL} are needed: give "
            "speed_m_per_s, or more gauges together",
            "no change stands out of the noise; if you see one, check the units of y and time",
            doubts,
            bodies,
        )
    doubts += flat_tops_within(gauge, time_s[0], time_s[-1])
    doubts += high_pass_that_explains_more(front, record, shared, tip, tip_s, speed, at, left)
    gap_s = float(np.diff(record.time_s[at[0] : at[-1] + 1]).max())
    if gap_s * speed > max(record.height_m, tip.zone_m):
        doubts.append(
            f"times of the record are up to {1e6 * gap_s:.3g} us apart, in which the front runs farther than "
            "the gauge is high"
        )
    if front.path.is_free and n == 1 and len(front.records) == 1:
        doubts.append(f"{record.parts[0]} alone hardly tells V: give speed_m_per_s, or more gauges together")
    doubts += gauge.doubts
    if min(np.count_nonzero(time_s < tip_s), np.count_nonzero(time_s > tip_s)) < 4:
        doubts.append("the record has hardly any times on one side of the tip")

    rows, steps = record.shapes(tip, speed, tip_s, at)
    levels = record.levels(steps if given.step else None, at)
    own = np.linalg.lstsq(levels, (data - shared.root * rows).ravel(), rcond=None)[0]
    fitted = shared.root * rows + (levels @ own).reshape(n, -1)
    of_time, of_slowness = front.path.of_times[place], front.path.of_slowness[place]
    speed_error = float(np.sqrt(of_slowness @ shared.of_c @ of_slowness)) * speed**2
    residual = np.sqrt((left**2).mean(axis=1) / np.maximum((about_mean**2).mean(axis=1), 1e-300))
    zone_m, low_m, high_m = (z * (tip.zone_m or 1.0) for z in shared.zones)
    return TipFit(
        gauge=gauge.name, x_m=gauge.x_m, y_m=gauge.y_m, together=len(front.records),
        direction=front.direction, tip_s=tip_s,
        tip_error_s=float(np.sqrt(of_time @ shared.of_c @ of_time)), speed_m_per_s=speed,
        speed_error_m_per_s=np.nan if given.speed_m_per_s else speed_error,
        K_Pa_sqrt_m=shared.root * tip.K_per_root, Gamma_J_per_m2=shared.root**2,
        Gamma_error_J_per_m2=shared.Gamma_error_J_per_m2, cohesive_zone_m=zone_m, zone_low_m=low_m,
        zone_high_m=high_m, strength_drop_Pa=shared.root * tip.drop_per_root,
        offset=dict(zip(record.parts, own[:n].tolist(), strict=True)),
        step=dict(zip(record.parts, (own[n:] if given.step else np.zeros(n)).tolist(), strict=True)),
        residual=dict(zip(record.parts, residual.tolist(), strict=True)), residual_of_all=shared.of_all,
        n_times=len(at), doubts=doubts, time_s=time_s, fitted=dict(zip(record.parts, fitted, strict=True)),
    )  # fmt: skip


def high_pass_that_explains_more(
    front: Front, record: Record, shared: Estimate, tip: TipField, tip_s: float, speed: float, at: np.ndarray,
    left: np.ndarray,
) -> list[str]:  # fmt: skip
    """A doubt where an amplifier that lets no constant pass, which the fit does not know, would leave
    LEAST_SIGNAL errors less of a record and make Gamma two errors another one."""
    alone = Front([record.gauge], front.bodies, front.settings, front.direction, front.fast)
    (own,), alone.at = alone.records, [at]
    own.leaked = cumulative_trapezoid(own.data, own.time_s, initial=0)
    c, zone_m = alone.nearest(alone.start(np.array([tip_s]), speed), tip.zone_m, free_zone=tip.zone_m > 0)
    root, rest, _ = alone.solved(c, zone_m)
    (less,) = alone.split(rest)
    variance = squares([less]) / max(less.size / correlated(less) - 10, 1)
    tips, speeds = alone.times_and_speeds(c)
    rows, steps = own.shapes(alone.fields(speeds, zone_m)[0], speeds[0], tips[0], at)
    levels = own.levels(steps if front.settings.step else None, at)
    linear = np.linalg.lstsq(levels, (own.data[:, at] - root * rows).ravel(), rcond=None)[0]
    cut_off = -float(linear[-1]) / (2 * np.pi)
    if (
        cut_off > 0
        and squares([left]) - squares([less]) > LEAST_SIGNAL**2 * variance
        and abs(root**2 - shared.root**2) > 2 * shared.Gamma_error_J_per_m2
    ):
        return [
            f"a high-pass of {cut_off:.2g} Hz, as of an amplifier, explains more, and makes Gamma "
            f"{root**2:.3g} J/m2"
        ]
    return []


def no_tip(gauge: Gauge, why: str, unchanged: str, doubts: list[str], bodies: Bodies) -> TipFit:
    change = largest_change(gauge, bodies.limit_m_per_s)
    said = f"no tip is found, though {change}: {why}" if change else f"no front passes: {unchanged}"
    return TipFit(
        gauge.name, gauge.x_m, gauge.y_m, 1, 0, *(np.nan,) * 11, {}, {}, {}, np.nan, 0,
        [said, *flat_tops_within(gauge, -np.inf, np.inf), *doubts, *gauge.doubts], np.empty(0), {},
    )  # fmt: skip


def flat_tops_within(gauge: Gauge, from_s: float, to_s: float) -> list[str]:
    """A doubt where there are any: of the longest."""
    inside = [f for f in gauge.flat_s if f[0] <= to_s and f[1] >= from_s]
    first_s, last_s = max(inside, key=lambda f: f[1] - f[0], default=(0.0, 0.0))
    told = f"the record is flat at an extreme from {1e6 * first_s:.4g} to {1e6 * last_s:.4g} us"
    then = "leave that component out, or that time by window_s"
    return [f"{told}, as of an amplifier at its limit: {then}"] if inside else []


def largest_change(gauge: Gauge, limit: float) -> str:
    """In words; empty where means over the time that the fastest front takes for a height stay within
    LEAST_SIGNAL standard deviations, of what they differ by from one such time to the next for most of the
    record, on either side."""
    height_m, time_s = abs(gauge.y_m), gauge.time_s
    n = min(max(1, round(height_m / limit / float(np.median(np.diff(time_s))))), len(time_s) // 3)
    most, told = 2.0 * LEAST_SIGNAL, ""
    for part, values in gauge.values.items():
        means = np.convolve(values, np.ones(n) / n, "valid")
        usual = float(np.median(np.abs(means[n:] - means[:-n]))) / NORMAL_MEDIAN / np.sqrt(2)
        i, j = sorted((int(means.argmin()), int(means.argmax())))
        size = abs(float(means[j] - means[i]))
        if size <= max(most * usual, 1e-12 * float(np.abs(values).max())):
            continue
        most = size / max(usual, 1e-300)
        done = (means[i : j + 1] - means[i]) / (means[j] - means[i])
        begins, ends = np.flatnonzero(done <= 0.25)[-1], np.flatnonzero(done >= 0.75)[0]
        takes_s = abs(float(time_s[i + ends] - time_s[i + begins]))
        amount = f"{1e6 * size:.3g} ustrain" if gauge.is_strain else f"{1e-6 * size:.3g} MPa"
        told = (
            f"{part} {'rises' if means[j] > means[i] else 'falls'} by {amount}, half of it within "
            f"{1e6 * takes_s:.3g} us"
        )
    return told


def correlated(left: np.ndarray) -> float:
    """How much residuals that follow one another add to the variance of a mean of them: 1 + 2 times the sum
    of their autocorrelation up to its first zero, over all components. White noise adds to its first term
    alone. [components, times]"""
    n = left.shape[1]
    power = (np.abs(np.fft.rfft(left, 2 * n, axis=1)) ** 2).sum(axis=0)
    follow = np.fft.irfft(power)[:n]
    ends = np.flatnonzero(follow <= 0)
    last = ends[0] if ends.size else n
    return max(1.0, float(2 * follow[:last].sum() / max(follow[0], 1e-300) - 1))


def fit_tips(
    gauges: Iterable[Gauge],
    bodies: OpenRun | CaseLike | _core.Case | Bodies,
    *,
    passages: int = 1,
    **settings: Any,
) -> list[TipFit]:
    """fit_tip of each gauge and each of so many passages of fronts, in the order of time. Doubts of it, too:
    one more passage, and the times of the tip at the gauges beside it, which make another speed.

    settings: of fit_tip. Of one passage, the order of arrivals at the gauges beside it gives a direction that
    a record does not tell by xy with xx or yy."""
    of, n = bodies_of(bodies), whole(passages, "passages", least=1)
    given = some_gauges(gauges)
    found = [passing(gauge, of, n, settings) for gauge in given]
    if n == 1 and settings.get("direction") is None:
        ways = ways_by_arrivals([fits[0] for fits in found])
        for k, gauge in enumerate(given):
            tells = "xy" in gauge.parts and len(gauge.parts) > 1
            if ways[k] and not tells and gauge.parts[0] in COMPONENTS:
                known = {**settings, "direction": ways[k], "tip_s": found[k][0].tip_s}
                found[k] = [fit_tip(gauge, of, **known)]
    told = doubts_of_arrivals(found, of)
    for k, gauge in enumerate(given):
        another = doubts_of_another(gauge, of, found[k], settings)
        found[k] = [
            replace(f, doubts=[*f.doubts, *t, *another]) for f, t in zip(found[k], told[k], strict=True)
        ]
    return [fit for own in found for fit in own]


def times_along_x(gauges: list[Gauge], fits: dict[str, TipFit]) -> tuple[np.ndarray, np.ndarray]:
    """Places of gauges, ascending, and the mean time of the tip at each."""
    x_m = np.unique([g.x_m for g in gauges])
    return x_m, np.array([np.mean([fits[g.name].tip_s for g in gauges if g.x_m == x]) for x in x_m])


def fit_front(
    gauges: Iterable[Gauge],
    bodies: OpenRun | CaseLike | _core.Case | Bodies,
    *,
    alone: Iterable[TipFit] | None = None,
    one_speed: bool = False,
    **settings: Any,
) -> list[TipFit]:
    """The field of one front fitted to all gauges together: one Gamma and one tau_p - tau_r, with which X_c
    changes with the speed; offsets and steps of each. The speed is that of the tip's times along x, by the
    line through two places, the parabola through three, the cubic spline through more; or one_speed of all;
    or given.

    alone: fit_tips of the gauges; those without a tip, or in the other direction than most, are left out.
    settings: of fit_tip. Raises CaseError where no front passes two gauges or more, one after the other."""
    of, given = bodies_of(bodies), some_gauges(gauges)
    made = Settings(**settings).checked(of, given)
    fits = list(alone) if alone is not None else fit_tips(given, of, **settings)
    seen = [f for f in fits if f.has_tip]
    way = made.direction or (1 if sum(f.direction for f in seen) >= 0 else -1)
    by_name = {f.gauge: f for f in seen if f.direction == way}
    given = [g for g in given if g.name in by_name]
    if len(given) < 2:
        raise CaseError("no front passes two gauges or more the same way: there is nothing to fit together")
    x_m, tips = times_along_x(given, by_name)
    V = made.speed_m_per_s or float(np.median([by_name[g.name].speed_m_per_s for g in given]))
    if len(x_m) > 1 and made.speed_m_per_s is None:
        slowness = way * float(np.polyfit(x_m, tips, 1)[0])
        V = 1 / slowness if slowness > 0 else -1.0
        if not any(low < V < high for low, high in of.ranges_m_per_s()):
            told = f"make {V:.4g} m/s, at which there is no field" if V > 0 else "do not follow one another"
            raise CaseError(
                f"the tip's times at the gauges {told}: check clocks and places, or give speed_m_per_s"
            )
    fast = of.c_S_m_per_s < V
    # A gauge alone may be fitted by a field above c_S, or below, where the times at all say otherwise.
    for gauge in given:
        if (of.c_S_m_per_s < by_name[gauge.name].speed_m_per_s) != fast:
            known = {"speed_m_per_s": V, "direction": way, "tip_s": by_name[gauge.name].tip_s}
            by_name[gauge.name] = fit_tip(gauge, of, **{**settings, **known})
    given = [g for g in given if by_name[g.name].has_tip]
    if len(given) < 2:
        raise CaseError("no front passes two gauges or more at one speed: there is nothing to fit together")
    x_m, tips = times_along_x(given, by_name)
    ended = []
    heights = [height * min(abs(g.y_m) for g in given) for height in START_ZONES]
    zones = {float(np.median([by_name[g.name].cohesive_zone_m for g in given])), *heights}
    with solvable("the gauges together"):
        for zone_m in sorted(zones) if made.zone_m is None else [made.zone_m]:
            front = Front(given, of, made, way, fast, flag(one_speed, "one_speed"))
            fit = refined(front, front.start(tips, V), zone_m) if not fast or zone_m > 0 else None
            if fit is not None:
                ended.append((front.trial(fit.c, fit.zone_m), fit))
        order = ranked([trial for trial, _ in ended])
        if not order:
            raise CaseError(
                f"fewer than {LEAST_TIMES} times of a gauge are in reach of the tip: give r_max_m"
            )
        return result(profiled(ended[order[0]][1]))


def passing(gauge: Gauge, bodies: Bodies, n: int, settings: dict[str, Any]) -> list[TipFit]:
    """The tips that pass a gauge: each is sought in what those before it leave of the record."""
    found: list[TipFit] = []
    rest = gauge
    for _ in range(n):
        found.append(fit_tip(rest, bodies, **settings))
        rest = without(rest, bodies, found[-1], settings.get("zone", "linear"))
    return each_without_the_others(gauge, bodies, found, settings)


def each_without_the_others(
    gauge: Gauge, bodies: Bodies, fits: list[TipFit], settings: dict[str, Any]
) -> list[TipFit]:
    found = sorted(fits, key=lambda fit: fit.tip_s if fit.has_tip else np.inf)
    for _ in range(ROUNDS if len(found) > 1 else 0):
        found = refitted(gauge, bodies, found, settings)
    return found


def doubts_of_another(
    gauge: Gauge, bodies: Bodies, fits: list[TipFit], settings: dict[str, Any]
) -> list[str]:
    """One where what the fits leave of the record is the passage of one more front, apart from theirs."""
    rest = gauge
    for fit in fits:
        rest = without(rest, bodies, fit, settings.get("zone", "linear"))
    if not largest_change(rest, bodies.limit_m_per_s):
        return []
    other = fit_tip(rest, bodies, **{**settings, "zone_m": 0.0})
    height_s = LEAST_APART * abs(gauge.y_m)
    if not other.has_tip or not all(
        f.has_tip and abs(other.tip_s - f.tip_s) * f.speed_m_per_s > height_s for f in fits
    ):
        return []
    both = each_without_the_others(gauge, bodies, [*fits, other], {**settings, "zone_m": 0.0})
    if not all(
        f.has_tip
        and f.K_Pa_sqrt_m > 0
        and f.residual_of_all < LARGE_RESIDUAL
        and f.Gamma_error_J_per_m2 < LARGE_ERROR * f.Gamma_J_per_m2
        for f in both
    ):
        return []
    times, Gammas = (
        ", ".join(f"{v:.4g}" for v in of)
        for of in ([1e6 * f.tip_s for f in both], [f.Gamma_J_per_m2 for f in both])
    )
    return [f"fronts at {times} us explain more, with Gamma {Gammas} J/m2: give passages {len(both)}"]


def refitted(gauge: Gauge, bodies: Bodies, fits: list[TipFit], settings: dict[str, Any]) -> list[TipFit]:
    """Each tip again, about where it was, in the record without the others."""
    found = list(fits)
    for k in range(len(found)):
        if not fits[k].has_tip:
            continue
        rest = gauge
        for other in found[:k] + found[k + 1 :]:
            rest = without(rest, bodies, other, settings.get("zone", "linear"))
        fit = fit_tip(rest, bodies, **{**settings, "direction": fits[k].direction, "tip_s": fits[k].tip_s})
        if not fit.has_tip:
            found[k] = fit
            continue
        at = np.searchsorted(gauge.time_s, fit.time_s)
        others = {part: (gauge.values[part] - rest.values[part])[at] for part in fit.fitted}
        found[k] = replace(fit, fitted={part: fit.fitted[part] + others[part] for part in others})
    return found


def without(gauge: Gauge, bodies: Bodies, fit: TipFit, zone: str = "linear") -> Gauge:
    """The record less the field and the step of a tip."""
    if not fit.has_tip:
        return gauge
    tip = TipField(bodies, fit.speed_m_per_s, fit.direction, fit.cohesive_zone_m, zone)
    rows, steps = Record(gauge).shapes(tip, fit.speed_m_per_s, fit.tip_s, np.arange(len(gauge.time_s)))
    root = np.copysign(np.sqrt(fit.Gamma_J_per_m2), fit.strength_drop_Pa)
    less = {
        part: root * of + fit.step[part] * step for part, of, step in zip(fit.step, rows, steps, strict=True)
    }
    return gauge.changed(gauge.flat_s, values={part: v - less[part] for part, v in gauge.values.items()})


def ways_by_arrivals(fits: list[TipFit]) -> list[int]:
    """The direction of the front at each gauge, +1 or -1, by the gauges on its sides; 0 where there are none
    or their times differ by less than LEAST_SIGNAL errors."""
    x, first = np.unique([f.x_m for f in fits if f.has_tip], return_index=True)
    at = [[f for f in fits if f.has_tip][k] for k in first]
    ways = []
    for fit in fits:
        k = int(np.searchsorted(x, fit.x_m))
        before, after = at[max(k - 1, 0) : k + 1], at[k : k + 2]
        if not fit.has_tip or len(x) < 2:
            ways.append(0)
            continue
        later_s = after[-1].tip_s - before[0].tip_s
        error_s = np.hypot(after[-1].tip_error_s, before[0].tip_error_s)
        ways.append(int(np.sign(later_s)) if abs(later_s) > LEAST_SIGNAL * error_s else 0)
    return ways


def of_same_front(every: list[list[TipFit]], own: list[TipFit], k: int) -> list[TipFit]:
    """The fits of all gauges to the front of one: fronts are the same by their direction and their order."""
    way = own[k].direction
    order = sum(f.direction == way for f in own[:k])
    of_way = [[f for f in fits if f.direction == way] for fits in every]
    return [fits[order] for fits in of_way if len(fits) > order]


def doubts_of_arrivals(every: list[list[TipFit]], bodies: Bodies) -> list[list[list[str]]]:
    """Of each fit of each gauge: where the times of a front's tip at neighbouring gauges make a speed that is
    not between those fitted there."""
    told: list[list[list[str]]] = [[[] for _ in own] for own in every]
    places = {id(f): at for own, of in zip(every, told, strict=True) for f, at in zip(own, of, strict=True)}
    for own in every:
        for k, fit in enumerate(own):
            ahead = [f for f in of_same_front(every, own, k) if fit.has_tip and f.x_m > fit.x_m]
            for other in ahead:
                if other.x_m > min(f.x_m for f in ahead):
                    continue
                doubt = doubt_of_arrivals(fit, other, bodies.c_L_m_per_s)
                for each in (fit, other) if doubt else ():
                    places[id(each)].append(doubt)
    return told


def doubt_of_arrivals(fit: TipFit, other: TipFit, c_L: float) -> str:
    """Of two gauges side by side; empty where there is none. Slownesses are compared: their errors are those
    of times."""
    apart_m = (other.x_m - fit.x_m) * fit.direction
    slowness = (other.tip_s - fit.tip_s) / apart_m
    error = float(np.hypot(fit.tip_error_s, other.tip_error_s)) / abs(apart_m)
    fast, slow = sorted((fit, other), key=lambda f: -f.speed_m_per_s)
    near = fast if slowness < 1 / fast.speed_m_per_s else slow
    own = 1 / near.speed_m_per_s
    own_error = np.nan_to_num(near.speed_error_m_per_s) * own**2
    between = 1 / fast.speed_m_per_s <= slowness <= 1 / slow.speed_m_per_s
    differs = abs(slowness - own) > max(OTHER_SPEED * own, SEVERAL * float(np.hypot(error, own_error)))
    if between or not differs:
        return ""
    speed = f"{1 / slowness:.4g} m/s" if slowness > 0 else "a front the other way"
    above = f", above c_L, {c_L:.4g} m/s," if 0 < slowness < 1 / c_L else ""
    return (
        f"the tip's times at {fit.gauge} and {other.gauge} make {speed}{above} where the fits have "
        f"V = {fit.speed_m_per_s:.4g} and {other.speed_m_per_s:.4g} m/s: check their clocks, places and "
        "heights y"
    )
