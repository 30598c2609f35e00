# SPDX-License-Identifier: BSD-3-Clause
"""Which fronts are an event's own, and which of their nodes count."""

from __future__ import annotations

import numpy as np

from slipfront.opened import OpenRun
from slipfront.read import Front, longest_each_way

# Shorter fronts, mostly secondary ones late in a record, would hide the events' own in the plots of V_tip.
DRAWN_LENGTH_M = 10e-3
NUCLEATION_M = 5e-3  # the speed diverges where a front nucleates
SLOW_OVER_C_L = 0.1  # a front is over where its speed stays below this


def drawn_fronts(run: OpenRun) -> list[Front]:
    """The fronts long enough to be drawn, in the order of their start."""
    return sorted((f for f in run.front_list if f.length_m >= DRAWN_LENGTH_M), key=lambda f: f.onset_s[0])


def start(run: OpenRun) -> tuple[float, float] | None:
    """Where (m) and when (s) the first drawn front starts; None in a run without one."""
    fronts = drawn_fronts(run)
    return (float(fronts[0].x_m[0]), float(fronts[0].onset_s[0])) if fronts else None


def away_from_trigger(run: OpenRun, x_m: np.ndarray) -> np.ndarray:
    """Whether points lie outside the trigger zone or patch and its margin; everywhere in other events."""
    if run.kind == "nucleation":
        reach_m = run.parameter("nucleation.half_length_m") + run.parameter("nucleation.taper_m")
        distance_m = np.abs(x_m - run.parameter("nucleation.x_m"))
        return distance_m > reach_m + run.parameter("fronts.trigger_margin_m")
    if run.kind not in ("left", "right"):
        return np.full(np.shape(x_m), True)
    # The zone begins at the end of the contact, an edge margin outside of what counts as inside.
    edge_m = 0.0 if run.prescribed else run.parameter("loading.edge_margin_m")
    omitted_m = run.parameter("event.trigger_zone_m") + run.parameter("fronts.trigger_margin_m")
    if run.kind == "left":
        return x_m >= run.fact("statics.inside_from_m") - edge_m + omitted_m
    return x_m <= run.fact("statics.inside_to_m") + edge_m - omitted_m


def beyond_origin(run: OpenRun, x_m: np.ndarray) -> np.ndarray:
    """Whether points lie outside the trigger zone and its margin, or off a spontaneous nucleation."""
    began = start(run)
    if run.kind in ("left", "right", "nucleation") or began is None:
        return away_from_trigger(run, x_m)
    return np.abs(x_m - began[0]) >= NUCLEATION_M


def slow_end(v_over_c_L: np.ndarray) -> int:
    """Index of the first node from which V_tip stays slow to the end; undefined speeds decide nothing. A slow
    stretch behind which the front is fast again is part of it."""
    fast = np.flatnonzero(v_over_c_L >= SLOW_OVER_C_L)
    behind = fast[-1] + 1 if len(fast) > 0 else 0
    slow = np.flatnonzero(v_over_c_L[behind:] < SLOW_OVER_C_L)
    return int(behind + slow[0]) if len(slow) > 0 else len(v_over_c_L)


def counted(run: OpenRun, front: Front) -> np.ndarray:
    """Whether nodes of a front count: beyond the origin, to the last before V_tip stays slow. [points]"""
    end = slow_end(front.v_tip_m_per_s / run.c_L_m_per_s)
    return beyond_origin(run, front.x_m) & (np.arange(len(front.x_m)) < end)


def main_fronts(run: OpenRun) -> list[Front]:
    """The longest front in each direction that starts at the event's origin, where any of its nodes count."""
    own = [f for f in run.front_list if not beyond_origin(run, f.x_m[:1])[0] and counted(run, f).any()]
    return [front for _, front in sorted(longest_each_way(own).items())]
