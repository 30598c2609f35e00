# SPDX-License-Identifier: BSD-3-Clause
"""V_tip of the main fronts of a run, the longest in each direction, at stations x; and how a quantity behaves
as a step size goes to 0, by three values of it: Richardson extrapolation (Roache, Annu. Rev. Fluid Mech. 29,
123-160, 1997)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from slipfront.read import Front, median
from slipfront.sweep.outcome import Interval

#: Stations nearer than this to the start of a front are left out: the speed diverges there.
NUCLEATION_M = 5e-3


class Place(NamedTuple):
    """Where speeds are compared: x and the direction of the front, +1 or -1 along x."""

    x_m: float
    direction: int


@dataclass(frozen=True)
class Run:
    """What is kept of a run. One that blew up counts as one without fronts."""

    info: dict[str, Any]  # run.json
    fronts: dict[int, Front]  # by direction
    left_out_m: list[Interval]  # a trigger's zone or patch with its margin
    blow_up: str = ""  # what happened

    def speed_m_per_s(self, place: Place) -> float:
        """NaN where no main front goes that way, or none passes."""
        front = self.fronts.get(place.direction)
        return math.nan if front is None else v_tip_at(front, place.x_m)

    def stations(self, spacing_m: float) -> list[Place]:
        """Whole multiples of the spacing where its fronts have a speed of their own."""
        places = []
        for direction, front in sorted(self.fronts.items()):
            low_m, high_m = sorted((float(front.x_m[0]), float(front.x_m[-1])))
            for k in range(math.ceil(low_m / spacing_m), math.floor(high_m / spacing_m) + 2):
                x_m = k * spacing_m
                near = abs(x_m - front.x_m[0]) < NUCLEATION_M or any(a < x_m < b for a, b in self.left_out_m)
                if x_m <= high_m and not near and math.isfinite(v_tip_at(front, x_m)):
                    places.append(Place(x_m, direction))
        return places


def v_tip_at(front: Front, x_m: float) -> float:
    """V_tip where the tip passes x, linear between its nodes; NaN beyond them."""
    share = (x_m - front.x_m[:-1]) / np.diff(front.x_m)
    found = np.flatnonzero((share >= 0) & (share <= 1))
    if not found.size:
        return math.nan
    k = found[0]
    before, after = front.v_tip_m_per_s[k : k + 2].tolist()
    if share[k] in (0, 1):  # the other one may be undefined
        return float(after if share[k] else before)
    return float(before + share[k] * (after - before))


UNDEFINED = math.nan
#: The scheme is of second order: a higher observed order is an accident of three values, and extrapolation
#: with it would claim too small an error.
HIGHEST_ORDER = 2.0
#: Fewer stations, or less than half of the case's, do not make a verdict.
FEWEST_STATIONS = 5

MONOTONE = "monotone"  # differences shrink with one sign
ALTERNATING = "alternating"  # differences shrink with changing sign
GROWING = "growing"  # the last difference is not smaller than the steps let it be: no limit to be seen
UNKNOWN = "unknown"  # a value is missing
CONVERGED, NOT_CONVERGED, NO_LIMIT = "converged", "not converged", "no limit"
TOO_FEW = "too few stations"


@dataclass(frozen=True)
class Limit:
    """What three values tend to."""

    values: Sequence[float]
    trend: str
    order: float = UNDEFINED  # observed p in f = f_0 + C q^p; of a monotone sequence
    value: float = UNDEFINED  # extrapolated to q = 0; none of a growing one

    def error(self, value: float) -> float:
        """Of a value of the sequence. Monotone: the distance from the limit; alternating: that plus half the
        last difference; growing: the largest distance from the three values, a lower bound."""
        if self.trend == GROWING:
            return max(abs(value - each) for each in self.values)
        between = 0.5 * abs(self.values[1] - self.values[2]) if self.trend == ALTERNATING else 0.0
        return abs(value - self.value) + between


def extrapolate(q: Sequence[float], f: Sequence[float]) -> Limit:
    """Limit of values f at step sizes q1 > q2 > q3 > 0 in any ratio.

    The observed order p solves (f1 - f2)/(f2 - f3) = (q1^p - q2^p)/(q2^p - q3^p); extrapolated with
    min(p, HIGHEST_ORDER). As p goes to 0 the right side goes to ln(q1/q2)/ln(q2/q3), so that a smaller ratio
    of differences has no order: growing. Alternating values enclose their limit: it is put midway between the
    last two. Equal values have the highest order."""
    if not all(map(math.isfinite, f)):
        return Limit(f, UNKNOWN)
    first, last = f[0] - f[1], f[1] - f[2]
    if last == 0:
        return Limit(f, MONOTONE, HIGHEST_ORDER, f[2])
    ratio = first / last
    if abs(ratio) <= math.log(q[0] / q[1]) / math.log(q[1] / q[2]):
        return Limit(f, GROWING)
    if ratio < 0:
        return Limit(f, ALTERNATING, value=0.5 * (f[1] + f[2]))

    def excess(order: float) -> float:
        """Of the ratio of an order, which rises with it."""
        return math.expm1(order * math.log(q[0] / q[1])) / -math.expm1(order * math.log(q[2] / q[1])) - ratio

    high = 1.0
    while excess(high) < 0:
        high *= 2
    order = float(brentq(excess, 1e-12, high, xtol=1e-14)) if excess(1e-12) < 0 else 0.0
    return Limit(f, MONOTONE, order, f[2] - last / ((q[1] / q[2]) ** min(order, HIGHEST_ORDER) - 1))


def p90(values: np.ndarray) -> float:
    """Nine tenths of the defined ones are at most so large."""
    defined = np.sort(values[np.isfinite(values)])
    return float(defined[(9 * len(defined) + 9) // 10 - 1]) if defined.size else UNDEFINED


@dataclass(frozen=True)
class Summary:
    """A sequence over its stations; medians, so that single stations do not decide."""

    verdict: str
    median_relative_error: float
    p90_relative_error: float  # at least nine tenths of the stations are within it
    median_order: float  # of the stations that have one
    growth: float  # last difference over the first one, per ln q
    n_stations: int  # with all values
    n_stations_of_case: int


def summarise(error: np.ndarray, order: np.ndarray, differences: np.ndarray, tolerance: float) -> Summary:
    """Converged: median error at most `tolerance`. Otherwise no limit where the last differences are not
    smaller than the first ones (growth >= 1), else not converged.

    error: of the case, relative. [stations] differences: |f1 - f2| / ln(q1/q2) and the last. [stations, 2]"""
    known = np.isfinite(error)
    n, of_case = int(known.sum()), median(error[known])
    first, last = (median(column[known]) for column in differences.T)
    growth = last / first if first > 0 else UNDEFINED
    verdict = CONVERGED if of_case <= tolerance else NOT_CONVERGED if growth < 1 else NO_LIMIT
    if n < FEWEST_STATIONS or 2 * n < len(error):
        verdict = TOO_FEW
    return Summary(verdict, of_case, p90(error), median(order[known]), growth, n, len(error))
