# SPDX-License-Identifier: BSD-3-Clause
"""Stretches of fronts with a speed of their own. docs/python.md"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.special import chdtrc, fdtrc

from slipfront.errors import CaseError
from slipfront.given import instance
from slipfront.measures import Errors, errors_of, on_own_line, slices_of, slope_of_line, speed_of
from slipfront.units import variables

LEAST = 3  # onsets of a stretch
MOST = 6  # stretches of a front
LEVEL = 0.02  # chance that a front of one speed is parted
WITHIN = 0.05  # chance of a scatter that errors do not explain
ROUNDING = 1e-6  # of a front's duration, below which scatter tells nothing


LEFT, RIGHT, BOTH, INSIDE = "from the left", "from the right", "from both ends", "from inside"


class Break(NamedTuple):
    at: int  # first onset of the second part
    chance: float  # that onsets of one speed, with this scatter, would gain so much by two lines
    gain: float  # squares that two lines take away


class Onsets(NamedTuple):
    """Those on a front's line, in the order of travel."""

    run_m: np.ndarray
    onset_s: np.ndarray
    step_s: float  # of the clock
    errors: Errors | None

    def between(self, first: int, end: int) -> Onsets:
        own = self.errors and (self.errors[0], self.errors[1][first:end])
        return Onsets(self.run_m[first:end], self.onset_s[first:end], self.step_s, own)


def squares_of_lines(x: np.ndarray, t: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Weighted squares about the line of time on place through the first 1, 2, ... points."""
    x, t = x - x[0], t - t[0]
    w, wx, wt, wxx, wxt, wtt = (
        np.cumsum(weight * part) for part in (np.ones_like(x), x, t, x * x, x * t, t * t)
    )
    xx, xt, tt = wxx - wx**2 / w, wxt - wx * wt / w, wtt - wt**2 / w
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.maximum(np.where(xx > 0, tt - xt**2 / xx, 0.0), 0.0)


def best_break(onsets: Onsets) -> Break | None:
    """The two lines of time on place that take most squares away from one, by an F test.

    F is half of what they take over the variance of the scatter about them, of n - 4 degrees of freedom; that
    of the clock's step and of rounding is the least. Where errors are given, and the scatter about two lines
    is within them (95 % of chi squared), they stand for it, and the test is that of chi squared. Its chance
    times the number of places at which the lines may part bounds that of the best one (Bonferroni)."""
    x, t, step_s, errors = onsets
    n = len(x)
    places = np.arange(LEAST, n - LEAST + 1)
    if not places.size:
        return None
    floor = step_s**2 / 12 + (ROUNDING * float(np.ptp(t))) ** 2
    variance = np.full(n, floor)
    if errors is not None:
        slope = slope_of_line(x, t, errors)
        variance += errors[1] ** 2 + ((slope if slope > 0 else 0.0) * errors[0]) ** 2
    if not variance.min() > 0:  # at one time
        return None
    before = squares_of_lines(x, t, 1 / variance)
    behind = squares_of_lines(x[::-1], t[::-1], 1 / variance[::-1])[::-1]
    two = before[places - 1] + behind[places]
    k = int(np.argmin(two))
    gain, freedom = float(before[-1] - two[k]), n - 4
    scatter = float(two[k]) / freedom
    if errors is not None and chdtrc(freedom, two[k]) > WITHIN:
        chance = float(chdtrc(2, gain))
    else:
        chance = float(fdtrc(2, freedom, gain / 2 / max(scatter, 1.0)))
    return Break(int(places[k]), min(chance * places.size, 1.0), gain * float(variance.mean()))


def stretches_of(onsets: Onsets) -> list[int]:
    """First onset of each stretch, and the number of onsets.

    The stretch that gains most is parted at its best break, as long as a chance is below LEVEL. Then each
    border is sought again between its neighbours, and goes where it has become one of chance."""
    ends = [0, len(onsets.run_m)]
    while len(ends) <= MOST:
        found = [(first, best_break(onsets.between(first, end)))
                 for first, end in zip(ends, ends[1:], strict=False)]  # fmt: skip
        borne = [(of.gain, first + of.at) for first, of in found if of is not None and of.chance < LEVEL]
        if not borne:
            break
        ends = sorted([*ends, max(borne)[1]])
    made = ends[:1]
    for k, end in enumerate(ends[1:-1], start=1):
        of = best_break(onsets.between(made[-1], ends[k + 1]))
        if of is not None and of.chance < LEVEL:
            made.append(made[-1] + of.at)
        elif of is None:
            made.append(end)
    return [*made, ends[-1]]


def type_of(fronts: xr.Dataset) -> str:
    """Of an event, by the longest front each way: both ways they come from both ends where the one to +x
    begins to the left of the other one, else from inside. Empty where no front is."""
    x = fronts["x_m"].to_numpy()
    longest: dict[int, tuple[float, float]] = {}  # by direction, length and start
    for part, way in zip(slices_of(fronts), fronts["direction"].to_numpy(), strict=True):
        of = float(abs(x[part.stop - 1] - x[part.start])), float(x[part.start])
        longest[int(way)] = max(longest.get(int(way), of), of, key=lambda one: one[0])
    if len(longest) < 2:
        return next((LEFT if way > 0 else RIGHT for way in longest), "")
    return BOTH if longest[1][1] < longest[-1][1] else INSIDE


def speed_stretches(
    fronts: xr.Dataset, *, place_error_m: float | None = None, time_error_s: ArrayLike | None = None
) -> xr.Dataset:
    """Stretches of the fronts that `find_fronts` found, each with a line and its speed, as many as the onsets
    bear: 3 onsets or more each, 6 of a front at most.

    A front is parted where two lines through its onsets fit so much better than one that onsets of one
    speed, with errors that are normal and independent, would do so in less than 2 % of cases: an F test of
    the squares of times about lines of time on place, its chance times the number of places where the lines
    may part. Errors that are given take the place of the scatter, where this is within them; the step of the
    times is the least scatter. So are the stretches parted, as long as they bear it. Places that two
    fronts share are on no line.

    place_error_m, time_error_s: as find_fronts has them; time_error_s may be that of each of its nodes.

    Returns a Dataset over `stretch`: front, direction, x_from_m, x_to_m in the order of travel, onsets on
    its line, speed_m_per_s with its interval, as find_fronts has it, at_m and at_s, a point of the line,
    and wait_s, the time from the line of the stretch before to its own midway between both; and over
    `point`, as the fronts: stretch_of_point. Its attribute `type` says where the fronts come from: "from the
    left", "from the right", "from both ends", "from inside" to both sides."""
    instance(fronts, xr.Dataset, "fronts")
    if "time_step_s" not in fronts.attrs:
        raise CaseError("fronts are not those of find_fronts: their steps of time are not known")
    node = fronts["node"].to_numpy()
    n = int(node.max(initial=-1)) + 1
    if time_error_s is not None and np.ndim(time_error_s):
        n = len(np.asarray(time_error_s))
    errors = errors_of(place_error_m, time_error_s, n)
    step_s = float(fronts.attrs["time_step_s"])
    x, onset = fronts["x_m"].to_numpy(), fronts["onset_s"].to_numpy()
    own = on_own_line(fronts)
    of_point = np.zeros(len(x), dtype=np.int64)
    rows: list[tuple[float, ...]] = []
    for front, part in enumerate(slices_of(fronts)):
        at = np.arange(part.start, part.stop)[own[part]]
        onsets = Onsets(np.abs(x[at] - x[part.start]), onset[at], step_s,
                        errors and (errors[0], errors[1][node[at]]))  # fmt: skip
        ends = stretches_of(onsets)
        before: tuple[float, float, float] | None = None  # of its line: place, time there, slowness
        for k, (first, end) in enumerate(zip(ends, ends[1:], strict=False)):
            points = at[first:end]
            begin = part.start if k == 0 else points[0]
            stop = part.stop if k == len(ends) - 2 else points[-1] + 1
            of_point[begin:stop] = len(rows)
            speed, low, high = speed_of(fronts, points, step_s, errors)
            own_errors = errors and errors[1][node[points]]
            weight = None if own_errors is None or not own_errors.all() else own_errors**-2
            at_m = at_s = np.nan
            if len(points):
                at_m, at_s = (float(np.average(v[points], weights=weight)) for v in (x, onset))
            slowness = float(fronts["direction"][front]) / speed
            wait_s = np.nan
            if before is not None:
                middle = (x[at[first - 1]] + x[at[first]]) / 2
                ends_s = [t + (middle - m) * slow for m, t, slow in (before, (at_m, at_s, slowness))]
                wait_s = ends_s[1] - ends_s[0]
            before = at_m, at_s, slowness
            rows.append((front, x[begin], x[stop - 1], end - first, speed, low, high, wait_s, at_m, at_s))
    names = ("front", "x_from_m", "x_to_m", "onsets", "speed_m_per_s", "speed_low_m_per_s",
             "speed_high_m_per_s", "wait_s", "at_m", "at_s")  # fmt: skip
    columns = dict(zip(names, np.array(rows, dtype=float).reshape(-1, len(names)).T, strict=True))
    made = {name: v.astype(np.int64) if name in ("front", "onsets") else v for name, v in columns.items()}
    made["direction"] = fronts["direction"].to_numpy()[made["front"]]
    of = variables(("stretch",), made) | variables(("point",), {"stretch_of_point": of_point})
    return xr.Dataset(of, attrs={"type": type_of(fronts)})
