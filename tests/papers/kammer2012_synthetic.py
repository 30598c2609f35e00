# SPDX-License-Identifier: BSD-3-Clause
"""Events made by formula instead of by computation: the speed, the ratios and the energy rise of every point
are given, so that what each claim's test has to answer is known."""

from dataclasses import replace

import numpy as np
from circle import wave_times_s
from events import PAPER_A, PAPER_B, PAPER_C, Event, Front, Wave
from scorecard import LoadedOn, Reproduction, StudyEvents

from cases import Point, Study

PEAK_X_M = 0.145
CONTACT_M = (0.008, 0.196)
SPACING_M = 1e-3
C_L, C_S = 1584.4, 889.2
EVENTS = ("spontaneous", "left", "right")


def static_ratio(x_m):
    """Greatest at PEAK_X_M, falling linearly to both sides."""
    return 0.999 * 1.3 - 6 * np.abs(x_m - PEAK_X_M)


def shape(x_m):
    """The same from about 0 at the left edge to 1 at the peak."""
    return (static_ratio(x_m) - 0.45) / 0.85


def linear(base, rise):
    return lambda x: base + rise * shape(x)


def square(base, rise):
    return lambda x: base + rise * shape(x) ** 2


def energy_rise_for(v_over_c_L):
    """At which the paper's fit gives these speeds."""
    fits = (v_over_c_L > 0.77) & (v_over_c_L < 2.55)
    inside = np.where(fits, v_over_c_L, 1.0)
    return np.where(fits, (np.log(PAPER_B / (inside - PAPER_A)) / PAPER_C) ** 2, np.nan)


def make_front(from_m, to_m, v_over_c_L, against=1.1, accelerating=1.05):
    """With the given speed over c_L, crack-like; nothing is defined at its first point. The energy rise is
    the paper's for that speed. At equal t_d/p_d it is `against` times faster against the shear and
    `accelerating` times faster while it accelerates."""
    direction = 1 if to_m > from_m else -1
    n = round(abs(to_m - from_m) / SPACING_M) + 1
    x = from_m + direction * np.arange(n) * SPACING_M
    v = np.vectorize(v_over_c_L, otypes=[float])(x)
    faster = np.vectorize(v_over_c_L, otypes=[float])(x + direction * SPACING_M) > v
    first = np.arange(n) == 0
    factor = (against if direction < 0 else 1.0) * np.where(faster, accelerating, 1.0)

    def behind_first(values):
        return np.where(first, np.nan, values)

    return Front(
        direction,
        "arrest",
        "crack",
        node=np.arange(n),
        x_m=x,
        onset_s=np.concatenate([[0], np.cumsum(SPACING_M / (v * C_L))[:-1]]),
        v_m_per_s=behind_first(v * C_L),
        static_ratio=static_ratio(x),
        dynamic_ratio=behind_first(v / (2 * factor)),
        energy_rise=behind_first(energy_rise_for(v)),
        pressure_ratio=np.ones(n),
        slipping_share=behind_first(0.8),
        accelerating=faster & ~first,
    )


def make_event(kind, fronts=(), name=None, mu_k=0.6):
    x = np.arange(201) * SPACING_M
    return Event(
        name=name or kind,
        kind=kind,
        mu_s=1.3,
        mu_k=mu_k,
        width_m=0.2,
        zone_m=10e-3,
        trigger_margin_m=10e-3,
        crack_share=0.5,
        pulse_share=0.2,
        c_L=C_L,
        c_S=C_S,
        fronts=list(fronts),
        x_m=x,
        static_ratio=static_ratio(x),
        contact_m=CONTACT_M,
        inside_m=(CONTACT_M[0] + 10e-3, CONTACT_M[1] - 10e-3),
        peak_x_m=PEAK_X_M,
        first_onset_x_m=PEAK_X_M + 1e-3,
        critical_shear_m=0.47e-3,
    )


def make_spontaneous(against=None, along=None, to_m=(0.01, 0.194)):
    """With fronts of these speeds to both sides."""
    speeds = against or linear(0.8, 1.5), along or linear(0.8, 1.2)
    return make_event("spontaneous", [make_front(PEAK_X_M, x, v) for x, v in zip(to_m, speeds, strict=True)])


def make_left(v):
    event = make_event("left", [make_front(CONTACT_M[0], 0.194, v)])
    for time_s in wave_times_s(event):
        event.waves.extend(Wave(time_s, angle, 0.95 * C_L * time_s, 2, 0.5) for angle in (30.0, 45.0))
    return event


def make_right(v):
    return make_event("right", [make_front(CONTACT_M[1], 0.01, v)])


def let_ratio_rise(front, from_m=0.08, to_m=0.05):
    """The dynamic ratio rises there while the speed goes on falling."""
    into = front.direction * (front.x_m - from_m)
    at = (into >= -1e-9) & (into <= abs(to_m - from_m) + 1e-9)
    front.dynamic_ratio[at] = front.dynamic_ratio[at][0] + 8 * into[at]


def set_kinds(event, crack_share):
    """A share of every 20 neighbours is crack-like; the rest alternates between pulse-like and mixed."""
    for front in event.fronts:
        k = np.arange(1, len(front.x_m))
        rest = np.where(k % 2 == 0, 0.1, 0.35)
        front.slipping_share[1:] = np.where((k % 20) / 20 < crack_share - 1e-9, 0.8, rest)


def study_of(name, events):
    """A study with an event, or several, for each value."""
    points = [Point(f"{value:g}", value, []) for value in events]
    of_points = [list(e) if isinstance(e, tuple) else [e] for e in events.values()]
    return StudyEvents(Study(name, f"friction.{name}", "", points), of_points)


def mu_k_study(crack_shares):
    """Of spontaneous events with these shares of crack-like path."""
    events = {}
    for k, share in enumerate(crack_shares):
        events[0.4 + 0.2 * k] = event = make_spontaneous()
        set_kinds(event, share)
    return study_of("mu_k", events)


def alpha_study(drops, ends):
    """Of spontaneous events; each speed is cut by a drop in the middle of the path and by the drop times
    `ends` in its first and last fifth."""

    def slowed(rise, to_m, cut):
        def speed(x):
            part = abs(x - PEAK_X_M) / abs(to_m - PEAK_X_M)
            return (0.8 + rise * shape(x)) * (1 - cut * (ends if part < 0.2 or part >= 0.8 else 1.0))

        return speed

    return study_of(
        "alpha",
        {
            10.0**k: make_spontaneous(slowed(1.5, 0.01, cut), slowed(1.2, 0.194, cut))
            for k, cut in enumerate(drops)
        },
    )


def make_good():
    """Runs for which every claim of the paper holds."""
    spontaneous = make_spontaneous()
    let_ratio_rise(spontaneous.fronts[0])
    mu_k_1 = make_event(
        "spontaneous",
        [make_front(PEAK_X_M, 0.115, linear(0.8, 1.0)), make_front(PEAK_X_M, 0.194, linear(0.6, 0.75))],
        "spontaneous_mu_k_1.0",
        1.0,
    )
    studies = {"mu_k": mu_k_study([0.9, 0.8, 0.6, 0.5, 0.3]), "alpha": alpha_study([0, 0.02, 0.05], 2)}
    return Reproduction(
        spontaneous,
        make_left(square(0.8, 0.4)),
        make_right(square(0.8, 1.6)),
        mu_k_1,
        studies,
        loaded_on=[LoadedOn(1.3, 0.6, 0.8, 1), LoadedOn(1.3, 1.0, 1.1, 9)],
    )


def changed(runs, event, **values):
    """The runs with other values of an event."""
    return replace(runs, **{event: replace(getattr(runs, event), **values)})


def with_front(runs, event, k, v, against=1.1, accelerating=1.05):
    """Gives every point of a front its speed again, with all that follows from it."""
    old = getattr(runs, event).fronts[k]
    made = make_front(old.x_m[0], old.x_m[-1], v, against, accelerating)
    getattr(runs, event).fronts[k] = replace(made, end=old.end)
    return runs


def for_three(runs, change):
    """Calls a function with each event and front of the three cases."""
    for name in EVENTS:
        event = getattr(runs, name)
        for front in event.fronts:
            change(event, front)
    return runs
