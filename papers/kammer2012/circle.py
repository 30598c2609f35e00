# SPDX-License-Identifier: BSD-3-Clause
"""The longitudinal wave ahead of the left-triggered front: the circular white zone of Fig. 3 (a)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from events import Event, Wave, event_of, main_front, median

# The wave is looked for at multiples of this time while the front's tip is between these places.
INTERVAL_S = 5e-6
TIP_FROM_M, TIP_TO_M = 60e-3, 130e-3
ANGLES_DEG = (30.0, 45.0)
# What the wave has to be, in this share of the snapshots and on both rays.
MIN_SHARE = 0.8
MIN_PEAK_M_PER_S = 1  # the light half of the paper's colours
MAX_OFF_C_L_T = 0.1  # share of c_L t between wave and trigger zone
MAX_GAP = 0.5  # lowest velocity behind the wave, over the wave's


def wave_on(speed_m_per_s: np.ndarray) -> tuple[int, float] | None:
    """On a ray outwards the place of the outermost maximum that is light enough, and the lowest speed behind
    it before it is exceeded."""
    inner, outer = speed_m_per_s[:-1], speed_m_per_s[1:]
    peaks = np.flatnonzero((outer >= MIN_PEAK_M_PER_S) & (inner < outer))
    if not peaks.size:
        return None
    place = int(peaks[-1]) + 1
    behind = speed_m_per_s[: place + 1]
    above = np.flatnonzero(behind > speed_m_per_s[place])
    return place, float(behind[above[-1] + 1 if above.size else 0 :].min())


def waves_on_rays(
    snapshots: list[tuple[float, np.ndarray]],
    x_m: np.ndarray,
    y_m: np.ndarray,
    element_m: float,
    zone_m: tuple[float, float],
) -> list[Wave]:
    """The wave on each ray of each snapshot, its time and |v| at the nodes, of an event triggered at the left
    edge. zone_m: ends of the trigger zone."""
    waves = []
    for angle_deg in ANGLES_DEG:
        c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
        ray = np.flatnonzero(np.abs(c * y_m - s * x_m) <= 0.5 * element_m)
        ray = ray[np.argsort(c * x_m[ray] + s * y_m[ray])]
        for time_s, speed in snapshots:
            found = wave_on(speed[ray])
            if found is None:
                waves.append(Wave(time_s, angle_deg))
                continue
            place, lowest = found
            x, y = float(x_m[ray[place]]), float(y_m[ray[place]])
            distance = math.hypot(x - min(max(x, zone_m[0]), zone_m[1]), y)
            waves.append(Wave(time_s, angle_deg, distance, float(speed[ray[place]]), lowest))
    return waves


def event_with_waves(name: str, case: Any, found: Any) -> Event:
    """Of what a batch found for a case; an event triggered at the left edge with its waves."""
    event = event_of(name, case, found)
    if event.kind == "left" and found.snapshots:
        speeds = [(s.time_s, np.hypot(s.x_m_per_s, s.y_m_per_s)) for s in found.snapshots]
        zone_m = event.contact_m[0], event.contact_m[0] + event.zone_m
        element_m = event.x_m[1] - event.x_m[0]
        event.waves.extend(waves_on_rays(speeds, found.node_x_m, found.node_y_m, element_m, zone_m))
    return event


def is_apart(wave: Wave, c_L: float) -> bool:
    return (
        abs(wave.distance_m / (c_L * wave.time_s) - 1) <= MAX_OFF_C_L_T
        and wave.lowest_behind_m_per_s <= MAX_GAP * wave.peak_m_per_s
    )


def wave_times_s(left: Event) -> list[float]:
    """When a run of the left-triggered event needs snapshots; none without a front."""
    front = main_front(left, 1)
    if front is None:
        return []
    onsets = front.onset_s[(front.x_m >= TIP_FROM_M) & (front.x_m <= TIP_TO_M)]
    if not onsets.size:
        return []
    times = [k * INTERVAL_S for k in range(1, int(onsets.max() / INTERVAL_S) + 2)]
    return [time for time in times if onsets.min() <= time <= onsets.max()]


@dataclass(frozen=True)
class Circle:
    """How clearly the wave stands apart. Medians over rays and snapshots; NaN without a wave."""

    n_snapshots: int  # at wave_times_s
    n_apart: int  # of them, with the wave as it has to be on both rays
    peak_m_per_s: float  # the wave's velocity
    gap: float  # the lowest velocity behind it over its own
    over_c_L_t: float  # its distance from the trigger zone over c_L t

    @property
    def holds(self) -> bool:
        return self.n_snapshots > 0 and self.n_apart >= MIN_SHARE * self.n_snapshots


def circle_of(left: Event) -> Circle | None:
    """None without snapshots at wave_times_s."""
    by_time: dict[int, list[Wave]] = {}
    for wave in left.waves:
        by_time.setdefault(round(wave.time_s / INTERVAL_S), []).append(wave)
    places = [round(time / INTERVAL_S) for time in wave_times_s(left)]
    if not left.waves and not places or any(place not in by_time for place in places):
        return None
    seen = [wave for place in places for wave in by_time[place]]
    found = [wave for wave in seen if not math.isnan(wave.peak_m_per_s)]
    return Circle(
        len(places),
        sum(all(is_apart(wave, left.c_L) for wave in by_time[place]) for place in places),
        median([w.peak_m_per_s for w in found]),
        median([w.lowest_behind_m_per_s / w.peak_m_per_s for w in found]),
        median([w.distance_m / (left.c_L * w.time_s) for w in found]),
    )
