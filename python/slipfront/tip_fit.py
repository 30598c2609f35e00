# SPDX-License-Identifier: BSD-3-Clause
"""The steadily moving near-tip field of a front fitted to records of strain gauges. docs/gauges.md

K is positive where the body above slips to +x."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import least_squares

from slipfront import _core
from slipfront.errors import CaseError
from slipfront.fracture import case_of_bodies
from slipfront.gauges import COMPONENTS, Gauge, gaussian, smooth, some_gauges, weights
from slipfront.given import array, flag, instance, number, shown, whole
from slipfront.opened import OpenRun
from slipfront.running import CaseLike
from slipfront.units import beyond

LARGE_RESIDUAL = 0.3  # of the record: it is not that of such a tip
LARGE_ERROR = 0.5  # of Gamma
LEAST_SIGNAL = 5  # of K, the tip's speed and time given, over its error: below, none has passed
#: By so many joint errors, and by this share, the speed from gauge to gauge misses those fitted at both.
SEVERAL, OTHER_SPEED = 3, 0.1
LEAST_APART = 2.0  # heights that a front runs between two passages; a cohesive zone is nearer to its tip
SHARES = (0.3, 0.6, 0.85, 0.95)  # of the limiting speed, from which a fit may start
STARTS = 3  # the best of them are refined
LEAST_TIMES = 8
#: Metals are elastic up to some 0.2 %, rock breaks at 0.2 to 0.5 %; glassy polymers alone of what is above
#: this modulus bear more. Fronts change strains by 1e-5 to 1e-3: more, if these are numbers of percent.
STIFF_STRAIN, STIFF_PA = 0.002, 1e9
NORMAL_MEDIAN = 0.6745  # of the size of a normal variable, over its standard deviation
ROUNDING = 1e-24  # of squares: a record that changes less is constant
LEAST_GAIN, MOST_TRIALS = 1e-9, 60  # of least squares: share of the square that a step is to take off it
ROUNDS = 3  # of fits of several tips, each without the others
LEAST_SQUARE = 0.25  # of a passage's record, over that of the largest
#: Lag of a low-pass, in the time that the front takes for a height: where the search begins, and its end. It
#: lasts for so many lags.
LAG, LONGEST_LAG, LAGS = 0.3, 2.0, 6
REACH = 5.0  # of a fit from the tip, in heights of the gauge


@dataclass(frozen=True)
class TipFit:
    """The tip of a front as a gauge saw it pass. Errors are standard ones; NaN of what was given. Where no
    front passed: numbers NaN, direction 0, and why in doubts."""

    gauge: str
    x_m: float
    y_m: float
    direction: int  # of the front along x
    tip_s: float  # when the tip is below, or above, the gauge
    tip_error_s: float
    speed_m_per_s: float
    speed_error_m_per_s: float
    K_Pa_sqrt_m: float
    K_error_Pa_sqrt_m: float
    Gamma_J_per_m2: float
    Gamma_error_J_per_m2: float
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


def no_tip(gauge: Gauge, why: str, unchanged: str, doubts: list[str], limit: float) -> TipFit:
    numbers = (np.nan,) * 8
    change = largest_change(gauge, limit)
    said = f"no tip is found, though {change}: {why}" if change else f"no front passes: {unchanged}"
    return TipFit(
        gauge.name, gauge.x_m, gauge.y_m, 0, *numbers, {}, {}, {}, np.nan, 0,
        [said, *flat_tops_within(gauge, -np.inf, np.inf), *doubts, *gauge.doubts],
        np.empty(0), {},
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


class Trial(NamedTuple):
    """How the model does at a speed and time of the tip."""

    square: float  # of the record about its means
    left: float  # the share that the model leaves
    slips_to_x: bool  # K is positive


def ranked(trials: list[Trial]) -> list[int]:
    """Those where the record changes much, from the one that leaves least. Without xy both directions leave
    the same: then slip to +x comes first."""
    most = max((t.square for t in trials), default=0.0)
    changing = [k for k, t in enumerate(trials) if t.square > LEAST_SQUARE * most]
    return sorted(changing, key=lambda k: (round(trials[k].left, 9), not trials[k].slips_to_x))


class Tip:
    """The model: a gauge, the bodies, a direction."""

    def __init__(
        self, gauge: Gauge, case: _core.Case, along_x: int, step: bool, r_m: tuple[float, float]
    ) -> None:
        self.gauge, self.case, self.along_x, self.step, self.r_m = gauge, case, along_x, step, r_m
        self.parts = gauge.parts
        self.weights = [weights(part) for part in self.parts]
        self.places_m = [gauge.places_m.get(part, (gauge.x_m, gauge.y_m)) for part in self.parts]
        self.data = np.array([gauge.values[part] for part in self.parts])
        self.time_s = gauge.time_s
        self.step_s = float(np.median(np.diff(self.time_s)))
        self.own_kernel = gaussian(gauge.smoothing_s / self.step_s)
        # Of a low-pass of first order that the record is taken to have passed; and whether of a high-pass.
        self.lag_s, self.leaks = 0.0, False

    def kernel(self) -> tuple[np.ndarray, int]:
        """Weights of what the record has passed, and how many of them are of times to come."""
        weights, n = self.own_kernel, len(self.own_kernel) // 2
        if self.lag_s > 0:
            past = np.exp(-np.arange(np.ceil(LAGS * self.lag_s / self.step_s)) * self.step_s / self.lag_s)
            weights = np.convolve(weights, past / past.sum())
        return weights, n

    def inside(self, speed: float, tip_s: float) -> np.ndarray:
        """Indices of the times at which the gauge is in reach of the tip and outside of r_min."""
        far_s = np.sqrt(self.r_m[1] ** 2 - self.gauge.y_m**2) / speed
        at = np.arange(*np.searchsorted(self.time_s, [tip_s - far_s, tip_s + far_s]))
        return at[np.hypot(speed * (self.time_s[at] - tip_s), self.gauge.y_m) >= self.r_m[0]]

    def shapes(self, speed: float, tip_s: float, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The field over K of each component or arm, and the step that goes with it, at the times of these
        indices. [parts, times] both"""
        time_s = self.time_s[at]
        kernel, n = self.kernel()
        if len(kernel) > 1:
            around = np.arange(at[0] - (len(kernel) - 1 - n), at[-1] + n + 1)
            time_s = self.time_s[0] + self.step_s * around
        tip = _core.TipField(self.case, speed, self.along_x)
        of = tip.strain_per_K if self.gauge.is_strain else tip.stress_per_K
        at_place: dict[tuple[float, float], list[np.ndarray]] = {}
        for place in self.places_m:
            if place not in at_place:
                x_m = self.along_x * speed * (tip_s - time_s) + (place[0] - self.gauge.x_m)
                at_place[place] = list(of(x_m, np.full_like(x_m, place[1])))
                # 0 ahead and 1 behind on the interface, and harmonic above it.
                at_place[place].append(np.arctan2(abs(place[1]), self.along_x * x_m) / np.pi)
        rows = [w @ np.array(at_place[p][:3]) for w, p in zip(self.weights, self.places_m, strict=True)]
        steps = [at_place[place][3] for place in self.places_m]
        if len(kernel) > 1:
            rows, steps = ([smooth(row, kernel)[at - at[0]] for row in of] for of in (rows, steps))
        return np.array(rows), np.array(steps)

    def columns(self, speed: float, tip_s: float, at: np.ndarray) -> np.ndarray:
        """Of the linear parameters: K; offset of each component; step of each. [components x times, ...]"""
        per_K, stepped = self.shapes(speed, tip_s, at)
        each = np.eye(len(self.parts))
        level = np.repeat(each, len(at), axis=0)
        columns = [per_K.reshape(-1, 1), level]
        if self.step:
            columns.append(level * stepped.reshape(-1, 1))
        if self.leaks:  # dy/dt = dx/dt - 2 pi f y: what it takes is the integral of what it leaves
            gone = cumulative_trapezoid(self.data, self.time_s, initial=0)
            columns.append(gone[:, at].reshape(-1, 1))
        return np.hstack(columns)

    def trial(self, speed: float, tip_s: float) -> Trial:
        at = self.inside(speed, tip_s)
        if len(at) < LEAST_TIMES:
            return Trial(0.0, 1.0, False)
        columns, data = self.columns(speed, tip_s, at), self.data[:, at].ravel()
        n = len(self.parts)
        q, r = np.linalg.qr(np.roll(columns / np.linalg.norm(columns, axis=0), -1, axis=1))  # K last
        along = q.T @ data
        square = float(data @ data - along[:n] @ along[:n])
        if square <= ROUNDING * float(data @ data):
            return Trial(0.0, 1.0, False)
        left = float(data @ data - along @ along) / max(square, 1e-300)
        return Trial(square, left, bool(along[-1] * r[-1, -1] > 0))


def limiting_speed_m_per_s(bodies: _core.Case) -> float:
    """From which on there is no such field."""
    return float(_core.TipField(bodies, 0.0, 1).limiting_speed_m_per_s)


def bodies_of(given: OpenRun | CaseLike | _core.Case) -> _core.Case:
    """See case_of_bodies; refused where they differ."""
    case = case_of_bodies(given)
    one = np.ones(1)
    if np.isnan(_core.TipField(case, 0.0, 1).stress_per_K(one, one)[0][0]):
        raise CaseError("the bodies differ: the field is that of equal bodies or of one on a rigid plane")
    return case


def tip_field(
    bodies: OpenRun | CaseLike,
    x_m: ArrayLike,
    y_m: ArrayLike,
    *,
    speed_m_per_s: float,
    Gamma_J_per_m2: float,
    direction: int = 1,
    stress: bool = False,
) -> dict[str, np.ndarray]:
    """Strain, or stress in Pa, that the tip of a front along direction adds to the state with the residual
    traction: xx, yy, xy at places from the tip. The body above slips to +x. NaN below a rigid plane."""
    case = bodies_of(bodies)
    V = number(speed_m_per_s, "speed_m_per_s", least=0)
    if direction not in (1, -1):
        raise CaseError(f"direction is {shown(direction)}; it must be 1 or -1")
    tip = _core.TipField(case, V, direction)
    if not tip.limiting_speed_m_per_s > V:
        raise CaseError(f"speed_m_per_s is {V:g} m/s; the field ends at {tip.limiting_speed_m_per_s:.5g} m/s")
    K = np.sqrt(number(Gamma_J_per_m2, "Gamma_J_per_m2", least=0) / tip.energy_per_K2)
    shapes = [
        np.asarray(number(of, name)) if np.ndim(of) == 0 else array(np.ravel(of), name).reshape(np.shape(of))
        for name, of in (("x_m", x_m), ("y_m", y_m))
    ]
    try:
        x, y = np.broadcast_arrays(*shapes)
    except ValueError:
        raise CaseError(
            f"x_m has the shape {shapes[0].shape}, y_m {shapes[1].shape}: give one of both"
        ) from None
    per_K = tip.stress_per_K if flag(stress, "stress") else tip.strain_per_K
    found = per_K(np.ascontiguousarray(x.ravel()), np.ascontiguousarray(y.ravel()))
    return {part: K * of.reshape(x.shape) for part, of in zip(COMPONENTS, found, strict=True)}


def scan(tip: Tip, speed: float, tip_s: float | None) -> float | None:
    """The best time of the tip at a speed."""
    fine_s = 0.25 * abs(tip.gauge.y_m) / speed
    ends = (tip.time_s[0], tip.time_s[-1]) if tip_s is None else (tip_s - 8 * fine_s, tip_s + 8 * fine_s)
    step_s = max(fine_s, (ends[1] - ends[0]) / (2 * len(tip.time_s)))  # finer than the record is no use
    tips = np.arange(ends[0], ends[1] + step_s, step_s)
    order = ranked([tip.trial(speed, t) for t in tips])
    return float(tips[order[0]]) if order else None


def fit_tip(
    gauge: Gauge,
    bodies: OpenRun | CaseLike | _core.Case,
    *,
    speed_m_per_s: float | None = None,
    direction: int | None = None,
    tip_s: float | None = None,
    r_min_m: float = 0.0,
    r_max_m: float | None = None,
    step: bool = True,
) -> TipFit:
    """The steadily moving mode II field fitted to a gauge's record: K and with it the fracture energy Gamma,
    the speed unless it is given, the time of the tip, and of each component an offset and a step of the
    residual stress or strain.

    bodies: see bodies_of. direction: +1 or -1 along x, None: the one that explains more. tip_s: about when
    the tip passes, None: where the field explains most of the record.
    The fit takes the times at which the gauge is from r_min_m, beyond the cohesive zone, to r_max_m from the
    tip, by default 5 times the gauge's height.
    Errors follow from the Jacobian and the scatter, with the correlation of neighbouring residuals."""
    instance(gauge, Gauge, "gauge")
    flag(step, "step")
    if tip_s is not None:
        tip_s = number(tip_s, "tip_s", finite=True)
    case = bodies_of(bodies)
    limit = limiting_speed_m_per_s(case)
    height = abs(gauge.y_m)
    r_m = (
        number(r_min_m, "r_min_m", least=0),
        number(REACH * height if r_max_m is None else r_max_m, "r_max_m"),
    )
    if not max(r_m[0], height) < r_m[1]:
        raise CaseError(
            f"gauge {gauge.name}: r_max_m is {r_m[1]:g} m; it must be above r_min_m, {r_m[0]:g} m, and the "
            f"gauge's height, {height:g} m"
        )
    if direction not in (None, 1, -1):
        raise CaseError(f"direction is {shown(direction)}; it must be 1, -1 or None")
    speeds = [share * limit for share in SHARES]
    if speed_m_per_s is not None:
        speeds = [number(speed_m_per_s, "speed_m_per_s", above=0)]
        if not speeds[0] < limit:
            raise CaseError(f"speed_m_per_s is {speeds[0]:g} m/s; the field ends at {limit:.5g} m/s")
    try:
        with np.errstate(all="ignore"):
            fit = sought(gauge, case, speeds, speed_m_per_s is not None, direction, tip_s, step, r_m)
    except (np.linalg.LinAlgError, OverflowError):
        raise CaseError(
            f"gauge {gauge.name}: cannot be fitted: its numbers are too large or too small"
        ) from None
    if direction is None and fit.has_tip and gauge.parts == ["xy"]:  # the same in a mirror
        return replace(fit, doubts=[*fit.doubts, "xy alone does not tell which way: give direction"])
    return fit


def sought(
    gauge: Gauge, case: _core.Case, speeds: list[float], given: bool, direction: int | None,
    tip_s: float | None, step: bool, r_m: tuple[float, float],
) -> TipFit:  # fmt: skip
    """The best fit from starts at these speeds; `given`: the one speed is kept."""
    limit = limiting_speed_m_per_s(case)
    starts = []
    for way in (1, -1) if direction is None else (direction,):
        tip = Tip(gauge, case, way, step, r_m)
        times_s = [(v, scan(tip, v, tip_s)) for v in speeds]
        starts += [(tip.trial(v, t), tip, v, t) for v, t in times_s if t is not None]
    ended = []
    for k in ranked([start[0] for start in starts])[:STARTS]:
        _, tip, v, t = starts[k]
        t, v, at = refined(tip, v, t, given, limit)
        ended.append((tip.trial(v, t), tip, v, t, at))
    order = ranked([end[0] for end in ended])
    if not order:
        few = (
            f"fewer than {LEAST_TIMES} times are within r_max_m = {r_m[1]:g} m of a tip: give a larger one, "
            "or check the units of y and time"
        )
        doubts = beyond({"limiting_speed_m_per_s": limit})
        return no_tip(gauge, few, f"nothing changes, or {few}", doubts, limit)
    _, tip, v, t, at = ended[order[0]]
    return result(tip, v, t, at, given, limit)


def nearest(
    tip: Tip, speed: float, at_s: float, at: np.ndarray, given: bool, limit: float, lag_s: float = 0.0
) -> tuple[float, float, float]:
    """Time of the tip, speed, and lag where it is above 0, that leave least of the record at these times."""
    data, takes_s, reach_s = tip.data[:, at].ravel(), abs(tip.gauge.y_m) / speed, tip.r_m[1] / speed

    def residual(p: np.ndarray) -> np.ndarray:
        tip.lag_s = float(p[-1]) if lag_s > 0 else 0.0
        columns = tip.columns(speed if given else p[1], p[0], at)
        q, _ = np.linalg.qr(columns / np.linalg.norm(columns, axis=0))
        return data - q @ (q.T @ data)

    sought = [(at_s, 1e-3 * takes_s, at_s - reach_s, at_s + reach_s)]  # start, step, ends
    if not given:
        sought.append((speed, 1e-4 * limit, 0.02 * limit, 0.999 * limit))
    if lag_s > 0:
        sought.append((lag_s, 1e-2 * lag_s, 0.25 * tip.step_s, LONGEST_LAG * takes_s))
    start, steps, low, high = np.array(sought).T

    def slopes(p: np.ndarray) -> np.ndarray:
        return np.array([(residual(p + m) - residual(p - m)) / (2 * m.sum()) for m in np.diag(steps)]).T

    if not np.isfinite(residual(start)).all():
        return at_s, speed, lag_s
    # Ended by what is gained alone: other tolerances are of numbers that are near 1.
    options = {"x_scale": steps, "ftol": LEAST_GAIN, "xtol": None, "gtol": None, "max_nfev": MOST_TRIALS}
    found = least_squares(residual, start, slopes, (low, high), **options).x
    tip.lag_s = float(found[-1]) if lag_s > 0 else 0.0
    return float(found[0]), speed if given else float(found[1]), tip.lag_s


def refined(
    tip: Tip, speed: float, at_s: float, given: bool, limit: float
) -> tuple[float, float, np.ndarray]:
    """Time of the tip, speed and the times of the fit, which follow the tip."""

    at = tip.inside(speed, at_s)
    for _ in range(8):
        to_s, v, _ = nearest(tip, speed, at_s, at, given, limit)
        moved = tip.inside(v, to_s)
        if len(moved) < LEAST_TIMES:
            break
        at_s, speed = to_s, v
        if np.array_equal(moved, at):
            break
        at = moved
    return at_s, speed, at


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


def filters_that_explain_more(
    tip: Tip, speed: float, at_s: float, at: np.ndarray, given: bool, limit: float,
    found: tuple[float, float, float],
) -> list[str]:  # fmt: skip
    """What an amplifier, which the fit does not know, may have done: a high-pass or low-pass of first order
    that leaves LEAST_SIGNAL errors less of the record, where its Gamma is two errors from the one found.

    found: Gamma, its error, and the square of what the fit leaves."""
    Gamma, error, square = found
    # A filter goes by even steps; a record of other times than those of a tip has no lag.
    takes_s, uneven_s = abs(tip.gauge.y_m) / speed, float(np.ptp(np.diff(tip.time_s)))
    has_lag = uneven_s < 0.01 * tip.step_s < tip.step_s < takes_s < len(tip.time_s) * tip.step_s
    told = []
    for word, like in (("high", "an amplifier"), ("low", "an amplifier or a cohesive zone")):
        other, lag_s = copy(tip), LAG * takes_s if word == "low" else 0.0
        other.leaks = word == "high"
        if lag_s > 0 and not has_lag:
            continue
        to_s, v, lag_s = nearest(other, speed, at_s, at, given, limit, lag_s)
        columns, data = other.columns(v, to_s, at), tip.data[:, at]
        size = np.linalg.norm(columns, axis=0)
        linear = np.linalg.lstsq(columns / size, data.ravel(), rcond=None)[0] / size
        left = data - (columns @ linear).reshape(data.shape)
        variance = (left**2).sum() / max(data.size / correlated(left) - columns.shape[1] - 2, 1)
        own = float(linear[0]) ** 2 * _core.TipField(tip.case, v, tip.along_x).energy_per_K2
        cut_off = 1 / lag_s if lag_s > 0 else -float(linear[-1])
        if (
            square - (left**2).sum() > LEAST_SIGNAL**2 * variance
            and abs(own - Gamma) > 2 * error
            and cut_off > 0
        ):
            told.append(
                f"a {word}-pass of {cut_off / (2 * np.pi):.2g} Hz, as of {like}, explains more, and makes "
                f"Gamma {own:.3g} J/m2"
            )
    return told


def result(tip: Tip, speed: float, at_s: float, at: np.ndarray, given: bool, limit: float) -> TipFit:
    gauge, n = tip.gauge, len(tip.parts)
    columns, data = tip.columns(speed, at_s, at), tip.data[:, at].ravel()
    if not np.isfinite(columns).all():
        raise np.linalg.LinAlgError  # of which LAPACK would print a line
    size = np.linalg.norm(columns, axis=0)
    linear = np.linalg.lstsq(columns / size, data, rcond=None)[0] / size
    K = float(linear[0])
    fitted = columns @ linear
    left = (data - fitted).reshape(n, -1)
    about_mean = tip.data[:, at] - tip.data[:, at].mean(axis=1, keepdims=True)

    def rms(values: np.ndarray) -> Any:
        return np.sqrt((values**2).mean(axis=-1))

    def per_K2(v: float) -> float:
        return _core.TipField(tip.case, v, tip.along_x).energy_per_K2

    ds, dv = 1e-3 * abs(gauge.y_m) / speed, 1e-4 * limit
    moved = [(tip.columns(speed, at_s + d, at) @ linear) for d in (ds, -ds)]
    slopes = [columns, ((moved[0] - moved[1]) / (2 * ds))[:, None]]
    if not given:
        moved = [(tip.columns(speed + d, at_s, at) @ linear) for d in (dv, -dv)]
        slopes.append(((moved[0] - moved[1]) / (2 * dv))[:, None])
    jacobian = np.hstack(slopes)
    scale = np.linalg.norm(jacobian, axis=0)
    variance = (left**2).sum() / max(data.size / correlated(left) - jacobian.shape[1], 1)
    largest = "strain" if gauge.is_strain else "stress_Pa"
    most = float(np.abs(about_mean).max())
    doubts = beyond({"limiting_speed_m_per_s": limit, largest: most})
    if gauge.is_strain and most > STIFF_STRAIN and per_K2(0.0) * STIFF_PA < 1:
        doubts.append(
            f"strain changes by {most:.2g}, beyond the elastic range of bodies as stiff: check its units"
        )
    of_K = np.linalg.pinv((columns / size).T @ (columns / size))[0, 0] / size[0] ** 2
    signal = abs(K) / float(np.sqrt(max(variance * of_K, 1e-300)))
    if signal < LEAST_SIGNAL:
        return no_tip(
            gauge,
            f"a tip's field fits by {signal:.1f} errors, {LEAST_SIGNAL} are needed. Perhaps the cohesive "
            "zone is longer than the gauge is high (give r_min_m beyond the zone, and r_max_m), or the front "
            f"is faster than {limit:.5g} m/s (its field is another)",
            "no change stands out of the noise; if you see one, check the units of y and time",
            doubts,
            limit,
        )
    covariance = variance * np.linalg.pinv((jacobian / scale).T @ (jacobian / scale)) / np.outer(scale, scale)
    errors = np.sqrt(np.diag(covariance))
    i_tip, i_speed = columns.shape[1], columns.shape[1] + 1

    slope = np.zeros(jacobian.shape[1])
    slope[0] = 2 * K * per_K2(speed)
    if not given:
        slope[i_speed] = K**2 * (per_K2(speed + dv / 10) - per_K2(speed - dv / 10)) / (dv / 5)
    Gamma, Gamma_error = K**2 * per_K2(speed), float(np.sqrt(slope @ covariance @ slope))
    of_all = float(np.sqrt((left**2).sum() / max((about_mean**2).sum(), 1e-300)))
    doubts += beyond({"Gamma_J_per_m2": Gamma})
    if of_all > LARGE_RESIDUAL:
        doubts.append(f"the residual is {100 * of_all:.0f} % of the record: it is not that of such a tip")
    if not given and not 0.03 * limit < speed < 0.997 * limit:
        doubts.append(f"V went to the end of its range, 0 to {limit:.5g} m/s: give speed_m_per_s")
    if not Gamma_error <= LARGE_ERROR * Gamma:
        doubts.append("the record hardly determines Gamma" + ("" if given else ": give speed_m_per_s"))
    if K < 0 and not gauge.doubts:  # of arms at wrong places, which turn it
        doubts.append("K is negative: the body above slips to -x")
    time_s = tip.time_s[at]
    doubts += flat_tops_within(gauge, time_s[0], time_s[-1])
    doubts += filters_that_explain_more(
        tip, speed, at_s, at, given, limit, (Gamma, Gamma_error, float((left**2).sum()))
    )
    gap_s = float(np.diff(tip.time_s[at[0] : at[-1] + 1]).max())
    if gap_s * speed > abs(gauge.y_m):
        doubts.append(
            f"times of the record are up to {1e6 * gap_s:.3g} us apart, in which the front runs farther than "
            "the gauge is high"
        )
    if not given and n == 1:
        doubts.append(f"{tip.parts[0]} alone hardly tells V: give speed_m_per_s, a number or gauges")
    doubts += gauge.doubts
    if min(np.count_nonzero(time_s < at_s), np.count_nonzero(time_s > at_s)) < 4:
        doubts.append("the record has hardly any times on one side of the tip")
    return TipFit(
        gauge.name, gauge.x_m, gauge.y_m, tip.along_x, at_s, float(errors[i_tip]), speed,
        np.nan if given else float(errors[i_speed]), K, float(errors[0]), Gamma, Gamma_error,
        dict(zip(tip.parts, linear[1 : 1 + n].tolist(), strict=True)),
        dict(zip(tip.parts, (linear[1 + n :] if tip.step else np.zeros(n)).tolist(), strict=True)),
        dict(zip(tip.parts, (rms(left) / np.maximum(rms(about_mean), 1e-300)).tolist(), strict=True)),
        of_all, len(at), doubts, time_s, dict(zip(tip.parts, fitted.reshape(n, -1), strict=True)),
    )  # fmt: skip


def fit_tips(
    gauges: Iterable[Gauge],
    bodies: OpenRun | CaseLike,
    *,
    speed_m_per_s: float | str | None = None,
    passages: int = 1,
    **options: Any,
) -> list[TipFit]:
    """fit_tip of each gauge and each of so many passages of fronts, in the order of time. Doubts of it, too:
    one more passage, and the times of the tip at the gauges beside it, which make another speed.

    speed_m_per_s: a number; None: of each fit; "gauges": by the times of the tip at the gauges beside it, in
    the same passage and direction, fitted first. options: of fit_tip. Of one passage, the order of arrivals
    at the gauges beside it gives a direction that a record does not tell by xy with xx or yy."""
    case, n = bodies_of(bodies), whole(passages, "passages", least=1)
    if isinstance(speed_m_per_s, str) and speed_m_per_s != "gauges":
        raise CaseError(f"speed_m_per_s is {shown(speed_m_per_s)}; it must be a number, None or 'gauges'")
    speed = None if isinstance(speed_m_per_s, str) else speed_m_per_s
    given = some_gauges(gauges)
    options["speed_m_per_s"] = speed
    found = [passing(gauge, case, n, options) for gauge in given]
    if n == 1 and options.get("direction") is None:
        ways = ways_by_arrivals([fits[0] for fits in found])
        for k, gauge in enumerate(given):
            if (
                ways[k]
                and not ("xy" in gauge.parts and len(gauge.parts) > 1)
                and gauge.parts[0] in COMPONENTS
            ):
                known = {**options, "direction": ways[k], "tip_s": found[k][0].tip_s}
                found[k] = [fit_tip(gauge, case, **known)]
    told = doubts_of_arrivals(found, case)
    if speed_m_per_s == "gauges":
        speeds = [speeds_between(found, own) for own in found]
        for k, gauge in enumerate(given):
            found[k] = refitted(gauge, case, found[k], options, speeds[k])
    for k, gauge in enumerate(given):
        another = doubts_of_another(gauge, case, found[k], options)
        found[k] = [
            replace(f, doubts=[*f.doubts, *t, *another]) for f, t in zip(found[k], told[k], strict=True)
        ]
    return [fit for own in found for fit in own]


def passing(gauge: Gauge, case: _core.Case, n: int, options: dict[str, Any]) -> list[TipFit]:
    """The tips that pass a gauge: each is sought in what those before it leave of the record."""
    found: list[TipFit] = []
    rest = gauge
    for _ in range(n):
        found.append(fit_tip(rest, case, **options))
        rest = without(rest, case, found[-1])
    return each_without_the_others(gauge, case, found, options)


def each_without_the_others(
    gauge: Gauge, case: _core.Case, fits: list[TipFit], options: dict[str, Any]
) -> list[TipFit]:
    found = sorted(fits, key=lambda fit: fit.tip_s if fit.has_tip else np.inf)
    for _ in range(ROUNDS if len(found) > 1 else 0):
        found = refitted(gauge, case, found, options, [options["speed_m_per_s"]] * len(found))
    return found


def doubts_of_another(
    gauge: Gauge, case: _core.Case, fits: list[TipFit], options: dict[str, Any]
) -> list[str]:
    """One where what the fits leave of the record is the passage of one more front, apart from theirs."""
    rest = gauge
    for fit in fits:
        rest = without(rest, case, fit)
    if not largest_change(rest, limiting_speed_m_per_s(case)):
        return []
    other = fit_tip(rest, case, **options)
    height_s = LEAST_APART * abs(gauge.y_m)
    if not other.has_tip or not all(
        f.has_tip and abs(other.tip_s - f.tip_s) * f.speed_m_per_s > height_s for f in fits
    ):
        return []
    both = each_without_the_others(gauge, case, [*fits, other], options)
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


def refitted(
    gauge: Gauge, case: _core.Case, fits: list[TipFit], options: dict[str, Any], speeds: list[Any]
) -> list[TipFit]:
    """Each tip again, about where it was, in the record without the others."""
    found = list(fits)
    for k, speed in enumerate(speeds):
        if not fits[k].has_tip:
            continue
        rest = gauge
        for other in found[:k] + found[k + 1 :]:
            rest = without(rest, case, other)
        known = {"speed_m_per_s": speed, "direction": fits[k].direction, "tip_s": fits[k].tip_s}
        fit = fit_tip(rest, case, **{**options, **known})
        if not fit.has_tip:
            found[k] = fit
            continue
        at = np.searchsorted(gauge.time_s, fit.time_s)
        others = {part: (gauge.values[part] - rest.values[part])[at] for part in fit.fitted}
        found[k] = replace(fit, fitted={part: fit.fitted[part] + others[part] for part in others})
    return found


def without(gauge: Gauge, case: _core.Case, fit: TipFit) -> Gauge:
    """The record less the field and the step of a tip."""
    if not fit.has_tip:
        return gauge
    per_K, stepped = Tip(gauge, case, fit.direction, True, (0, 1)).shapes(
        fit.speed_m_per_s, fit.tip_s, np.arange(len(gauge.time_s))
    )
    less = {
        part: fit.K_Pa_sqrt_m * of + fit.step[part] * step
        for part, of, step in zip(fit.step, per_K, stepped, strict=True)
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


def doubts_of_arrivals(every: list[list[TipFit]], case: _core.Case) -> list[list[list[str]]]:
    """Of each fit of each gauge: where the times of a front's tip at neighbouring gauges make a speed that is
    not between those fitted there, or that no such tip has."""
    told: list[list[list[str]]] = [[[] for _ in own] for own in every]
    limit, c_L = limiting_speed_m_per_s(case), case.wave_speeds.c_L_m_per_s
    places = {id(f): at for own, of in zip(every, told, strict=True) for f, at in zip(own, of, strict=True)}
    for own in every:
        for k, fit in enumerate(own):
            ahead = [f for f in of_same_front(every, own, k) if fit.has_tip and f.x_m > fit.x_m]
            for other in ahead:
                if other.x_m > min(f.x_m for f in ahead):
                    continue
                doubt = doubt_of_arrivals(fit, other, limit, c_L)
                for each in (fit, other) if doubt else ():
                    places[id(each)].append(doubt)
    return told


def doubt_of_arrivals(fit: TipFit, other: TipFit, limit: float, c_L: float) -> str:
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
    if (between or not differs) and not slowness + SEVERAL * error < 1 / limit:
        return ""
    speed = f"{1 / slowness:.4g} m/s" if slowness > 0 else "a front the other way"
    above = f", above c_L, {c_L:.4g} m/s," if 0 < slowness < 1 / c_L else ""
    or_fast = ", or the front is supershear" if 1 / c_L <= slowness < 1 / limit else ""
    return (
        f"the tip's times at {fit.gauge} and {other.gauge} make {speed}{above} where the fits have "
        f"V = {fit.speed_m_per_s:.4g} and {other.speed_m_per_s:.4g} m/s: check their clocks, places and "
        f"heights y{or_fast}"
    )


def speeds_between(every: list[list[TipFit]], own: list[TipFit]) -> list[float]:
    """Of each fit of a gauge: the slope of the tips' times over x, by the parabola through three gauges side
    by side, or the line through two."""
    made = []
    for k, fit in enumerate(own):
        way = fit.direction
        if not fit.has_tip:
            made.append(np.nan)
            continue
        same = of_same_front(every, own, k)
        x, first = np.unique([f.x_m for f in same], return_index=True)
        if len(x) < 2:
            raise CaseError(
                f"gauge {fit.gauge}: speeds of gauges need two gauges of one front; give speed_m_per_s in m/s"
            )
        tips = np.array([f.tip_s for f in same])[first]
        slowness = np.gradient(tips, x, edge_order=2 if len(x) > 2 else 1)[np.searchsorted(x, fit.x_m)]
        if not slowness * way > 0:
            raise CaseError(
                f"gauge {fit.gauge}: its neighbours' tips do not follow one another: give speed_m_per_s, m/s"
            )
        made.append(float(way / slowness))
    return made
