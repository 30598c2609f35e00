# SPDX-License-Identifier: BSD-3-Clause
"""The fronts that belong to their event's nucleation or trigger, and those of their points that count."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from events import TAIL_M, Collapse, Event, Front, Mask, collapse, longest
from slipfront.figures.main_fronts import NUCLEATION_M, slow_end


@dataclass(frozen=True)
class MainFront:
    """A front and its points that count, neighbours in the order of travel."""

    event: Event
    front: Front
    points: Front

    @property
    def in_tail(self) -> Mask:
        """Whether points lie in the last TAIL_M before their end. A front that may still run when the record
        ends has no such end."""
        x, slows_down = self.points.x_m, self.points.x_m[-1] != self.front.x_m[-1]
        if not slows_down and self.front.end == "record_end":
            return np.zeros(len(x), dtype=bool)
        return np.abs(x - x[-1]) <= TAIL_M * (1 + 1e-9)


def starts_the_event(event: Event, front: Front) -> bool:
    start_m = front.x_m[0]
    if event.triggered:
        return bool(event.near_trigger(start_m))
    return bool(abs(start_m - event.first_onset_x_m) <= NUCLEATION_M)


def first_front(event: Event, direction: int) -> Front | None:
    """The longest front in a direction that starts at its event's nucleation or trigger. In a triggered
    event: that starts in the trigger zone or in the margin beyond it, where points do not count. In any
    other: that starts within NUCLEATION_M of the first onset. Fronts in the wake of others, and those
    that nucleate ahead of them, are none."""
    return longest(f for f in event.fronts if f.direction == direction and starts_the_event(event, f))


def counted_points(event: Event, front: Front) -> Front:
    """From beyond the trigger zone and its margin, or NUCLEATION_M from where a front nucleated by itself, to
    the front's slow_end."""
    end = slow_end(front.v_m_per_s / event.c_L)
    counted = np.flatnonzero(event.counts(front, NUCLEATION_M)[:end])
    return front.part(slice(counted[0] if counted.size else end, end))


def main_fronts(events: Iterable[Event]) -> list[MainFront]:
    """Of each event the first_front against the shear and along it, where there is one with points that
    count."""
    found = []
    for event in events:
        for direction in (-1, 1):
            front = first_front(event, direction)
            if front is not None and len((points := counted_points(event, front)).x_m):
                found.append(MainFront(event, front, points))
    return found


def collapse_without_tails(mains: Iterable[MainFront]) -> Collapse:
    """How well each criterion orders the speeds of main fronts without their tails."""
    fronts: dict[int, tuple[Event, list[Front]]] = {}
    for main in mains:
        kept = main.points.part(~main.in_tail)
        of_event = fronts.setdefault(id(main.event), (main.event, []))[1]
        if len(kept.x_m):
            of_event.append(kept)
    return collapse([replace(event, fronts=kept) for event, kept in fronts.values()])
