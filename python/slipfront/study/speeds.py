# SPDX-License-Identifier: BSD-3-Clause
"""V_tip of the main fronts of a run, the longest in each direction, at stations x."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from slipfront.read import Front
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
