# SPDX-License-Identifier: BSD-3-Clause
"""What is read off events: points that count, main fronts, series over criteria, the wave of Fig. 3 (a)."""

import math
from dataclasses import replace
from types import SimpleNamespace

import circle
import numpy as np
import pytest

pytest.importorskip("slipfront._core")

import slipfront
from events import (
    BINS,
    CRITERIA,
    SHORTEST_M,
    collapse,
    criterion_series,
    event_of,
    main_front,
    speed_change,
)
from kammer2012_synthetic import (
    C_L,
    CONTACT_M,
    PEAK_X_M,
    linear,
    make_event,
    make_front,
    make_good,
    make_left,
    make_right,
    make_spontaneous,
)
from main_fronts import first_front, main_fronts

from cases import HERE

NAN = math.nan


def constant(_):
    return 1.0


def counts_at(event, x_m):
    return not event.near_trigger(np.array([x_m]))[0]


def test_the_trigger_zone_and_its_margin_do_not_count():
    left, right = make_left(linear(0.8, 0.4)), make_right(linear(0.8, 0.4))
    for at_m in (19.9e-3, 20.1e-3, CONTACT_M[1] - CONTACT_M[0]):
        assert counts_at(left, CONTACT_M[0] + at_m) == (at_m > 20e-3)
        assert counts_at(right, CONTACT_M[1] - at_m) == (at_m > 20e-3)
    wide = replace(left, zone_m=30e-3)
    assert not counts_at(wide, CONTACT_M[0] + 39e-3)
    assert counts_at(replace(wide, trigger_margin_m=0), CONTACT_M[0] + 31e-3)


def test_the_neighbourhood_of_spontaneous_nucleation_can_be_left_out():
    event, right = make_spontaneous(), make_right(linear(0.8, 1.5))
    front = event.fronts[0]
    assert event.counts(front)[0]
    assert event.counts(front, 5e-3 + 1e-9)[[4, 6]].tolist() == [False, True]
    assert right.counts(right.fronts[0], 50e-3)[30]


@pytest.mark.parametrize("criterion", CRITERIA)
def test_series_have_the_same_points_for_every_criterion(criterion):
    event = make_spontaneous()
    first, second = event.fronts
    first.v_m_per_s[10] = NAN
    first.energy_rise[20] = NAN
    ((a, b),) = criterion_series([event], criterion)
    assert len(a[0]) == len(first.x_m) - 3  # nor the first point
    assert len(b[0]) == len(second.x_m) - 1
    assert b[1][5] == second.v_m_per_s[6] / C_L
    assert b[0][5] == getattr(second, criterion)[6]


def test_the_share_within_the_band_is_counted():
    event = make_spontaneous()
    for front in event.fronts:
        # In turn on the curve, just inside, just outside, and a fall of energy, which no point of it has.
        front.v_m_per_s[2::4] += 0.069 * C_L
        front.v_m_per_s[3::4] -= 0.071 * C_L
        front.energy_rise[4::4] = -0.1
    n = sum(len(front.x_m) - 1 for front in event.fronts)
    off = sum(len(front.x_m[3::4]) + len(front.x_m[4::4]) for front in event.fronts)
    found = collapse([event])
    assert found.n_points == n
    assert found.share_in_band == pytest.approx((n - off) / n)
    assert found.fronts["energy_rise"].n_bins <= BINS


def test_the_speed_change_of_a_scaled_run_is_the_scale():
    reference, run = make_spontaneous(), make_spontaneous()
    for front in run.fronts:
        front.v_m_per_s[:] *= 1.2 if front.direction > 0 else 0.7
    change = speed_change(run, reference)
    # More nodes against the shear than along it.
    assert [change[key] for key in ("median", "median_absolute", "largest")] == pytest.approx(
        [-0.3, 0.3, 0.3]
    )
    # Every second node: the speed is linear in x on both sides of the peak, so that interpolation is exact.
    left, sparse = make_left(linear(0.8, 0.4)), make_left(linear(0.8, 0.4))
    sparse.fronts[0] = sparse.fronts[0].part(slice(None, None, 2))
    sparse.fronts[0].v_m_per_s[:] *= 1.1
    change = speed_change(sparse, left)
    assert change["median"] == pytest.approx(0.1)
    assert change["n_points"] > 100
    # No place is common to these.
    change = speed_change(left, make_right(linear(0.8, 0.4)))
    assert change["n_points"] == 0
    assert math.isnan(change["median"])
    assert math.isnan(change["largest"])


def found_of(onsets, fronts=()):
    """What a batch finds, of pairs of node and time, and ends of fronts."""
    event = make_event("spontaneous")
    points = dict.fromkeys(
        ("t_s_Pa", "p_s_Pa", "t_d_Pa", "p_d_Pa", "p_r_Pa", "U_s_J_per_m3", "U_r_J_per_m3"), np.ones(2)
    )
    return SimpleNamespace(
        speeds=SimpleNamespace(c_L_m_per_s=C_L, c_S_m_per_s=889.2),
        fronts=[
            SimpleNamespace(
                direction=1 if b > a else -1,
                end="arrest",
                mode="crack",
                length_m=abs(b - a),
                node=np.arange(2),
                x_m=np.array([a, b]),
                onset_s=np.arange(2.0),
                v_tip_m_per_s=np.ones(2),
                slipping_share=np.ones(2),
                accelerating=np.ones(2, bool),
                **points,
            )
            for a, b in fronts
        ],
        x_m=event.x_m,
        t_s_Pa=event.static_ratio,
        p_s_Pa=np.ones_like(event.x_m),
        inside_from_m=event.inside_m[0],
        inside_to_m=event.inside_m[1],
        peak_x_m=PEAK_X_M,
        critical_shear_m=0.47e-3,
        ramp_critical_shear_m=NAN,
        ramp_onsets=0,
        onset_x_m=np.array([event.x_m[node] for node, _ in onsets]),
        onset_s=np.array([time for _, time in onsets]),
        trigger_work_J_per_m=NAN,
    )


def event_found(*arguments):
    return event_of("run", slipfront.case(HERE / "spontaneous.toml"), found_of(*arguments))


def test_events_have_the_first_onset_inside():
    event = event_found([(5, 0), (150, 2e-6), (144, 1e-6)])  # node 5 is outside
    assert event.first_onset_x_m == pytest.approx(0.144)
    assert event.contact_m == pytest.approx(CONTACT_M)
    # Of several the farthest from the peak.
    several = event_found([(145, 1e-6), (147, 1e-6), (144, 1e-6), (170, 2e-6)])
    assert several.first_onset_x_m == pytest.approx(0.147)
    assert math.isnan(event_found([(5, 0)]).first_onset_x_m)


def test_events_leave_out_short_fronts():
    fronts = event_found([(145, 0)], [(0.1, to_m) for to_m in (0.109, 0.11, 0.05)]).fronts
    assert [front.length_m >= SHORTEST_M * (1 - 1e-9) for front in fronts] == [True, True]


# Main fronts.


def counted(event):
    (main,) = main_fronts([event])
    return main.points.x_m[0], main.points.x_m[-1]


def left_ending_with(*speeds):
    """Over c_L, at the last points."""
    event = make_left(constant)
    event.fronts[0].v_m_per_s[-len(speeds) :] = np.array(speeds) * C_L
    return event


def test_main_fronts_are_of_each_event_those_of_its_start():
    runs = make_good()
    mains = main_fronts(runs.three)
    expected = [*runs.spontaneous.fronts, *runs.left.fronts, *runs.right.fronts]
    assert all(main.front is front for main, front in zip(mains, expected, strict=True))
    assert all(main.points.x_m[-1] == main.front.x_m[-1] for main in mains)
    longest = make_spontaneous()
    longest.fronts.insert(0, make_front(0.05, 0.03, linear(0.8, 1)))
    assert main_front(longest, -1) is longest.fronts[1]


def test_there_is_no_main_front_without_one_that_is_fast():
    assert main_fronts([make_event("left")]) == []
    assert first_front(make_left(constant), -1) is None
    assert main_fronts([make_left(lambda x: 0.09)]) == []
    # Fast in front of the points that count alone.
    assert main_fronts([make_left(lambda x: 1.0 if x < 0.02 else 0.09)]) == []


def test_main_fronts_count_from_beyond_nucleation_and_trigger_zone():
    mains = main_fronts([make_spontaneous(constant, constant)])
    assert len(mains) == 2
    for main in mains:
        assert abs(main.points.x_m[0] - PEAK_X_M) == pytest.approx(5.5e-3, abs=0.6e-3)
        assert abs(main.points.x_m[0] - PEAK_X_M) >= 5e-3
    for zone_m in (9.5e-3, 14.5e-3):
        left, right = (replace(event, zone_m=zone_m) for event in (make_left(constant), make_right(constant)))
        assert counted(left)[0] == pytest.approx(CONTACT_M[0] + zone_m + 10.5e-3)
        assert counted(right)[0] == pytest.approx(CONTACT_M[1] - zone_m - 10.5e-3)


def test_main_fronts_are_not_those_of_other_starts():
    # Longer than the one along the shear from the nucleation, but in the wake of the other.
    event = make_spontaneous(constant, constant)
    event.fronts.append(make_front(0.02, 0.12, constant))
    mains = main_fronts([event])
    assert len(mains) == 2
    assert mains[1].front is event.fronts[1]
    # Ahead of the trigger's front, which meets it.
    left = make_event("left", [make_front(CONTACT_M[0], 0.09, constant), make_front(0.092, 0.194, constant)])
    assert counted(left)[1] == pytest.approx(0.09)


def test_main_fronts_start_within_reach_of_the_first_onset_or_in_the_margin_of_the_zone():
    for distance_m, n in ((4.9e-3, 2), (5.1e-3, 0), (NAN, 0)):
        event = replace(make_spontaneous(constant, constant), first_onset_x_m=PEAK_X_M + distance_m)
        assert len(main_fronts([event])) == n
    margin_end_m = CONTACT_M[0] + 20e-3
    inside = make_event("left", [make_front(margin_end_m - 0.5e-3, 0.1, constant)])
    assert counted(inside)[0] == pytest.approx(margin_end_m + 0.5e-3)
    assert main_fronts([make_event("left", [make_front(margin_end_m + 0.5e-3, 0.1, constant)])]) == []


@pytest.mark.parametrize(
    ("speeds", "cut_m"),
    [
        ((0.11, 0.099, 0.01, 0.05), 3e-3),
        ((0.05, 0.05, 0.05, 0.11), 0),  # slow for a while only
        ((0.05, 0.11, 0.05, 0.05), 2e-3),
        ((NAN, NAN, NAN), 0),  # neither low nor high
        ((0.05, NAN, 0.05, NAN), 4e-3),
        ((0.5, NAN, 0.05), 1e-3),  # not known to be slow until the point behind it
    ],
)
def test_main_fronts_end_where_the_speed_stays_low(speeds, cut_m):
    assert counted(left_ending_with(*speeds))[1] == pytest.approx(0.194 - cut_m)


def test_the_tail_is_the_last_twenty_millimetres_that_count():
    def in_tail(event, end):
        event.fronts[0] = replace(event.fronts[0], end=end)
        (main,) = main_fronts([event])
        return main.in_tail

    for end in ("arrest", "meets_front", "contact_end"):
        assert in_tail(make_left(constant), end).sum() == 21  # a point each millimetre, both ends included
    assert in_tail(make_left(constant), "record_end").sum() == 0  # it may still run
    tail = in_tail(left_ending_with(0.05, 0.05, 0.05), "record_end")
    assert tail.tolist() == [False] * (len(tail) - 21) + [True] * 21


# The longitudinal wave.

ZONE_M = (5e-3, 20e-3)
X_M, Y_M = (axis.ravel() for axis in np.meshgrid(np.arange(201) * 1e-3, np.arange(101) * 1e-3))


def waves_of(speed):
    """Of |v| over the distance from the trigger zone."""
    r = np.hypot(X_M - np.clip(X_M, *ZONE_M), Y_M)
    return circle.waves_on_rays([(50e-6, speed(r))], X_M, Y_M, 1e-3, ZONE_M)


def bump(r, at):
    return np.exp(-((r - at) ** 2) / 16e-6)


def test_the_wave_is_the_outermost_light_maximum_on_each_ray():
    # Ahead of it a dark forerunner, behind it a dark zone and then lighter slip.
    waves = waves_of(lambda r: 0.9 * bump(r, 95e-3) + 2 * bump(r, 80e-3) + 5 * bump(r, 40e-3))
    assert [wave.angle_deg for wave in waves] == [30, 45]
    for wave in waves:
        assert wave.time_s == 50e-6
        assert wave.distance_m == pytest.approx(80e-3, abs=1e-3)  # the nodes are 1 to 1.4 mm apart
        assert wave.peak_m_per_s == pytest.approx(2, abs=0.05)  # bump(0.7 mm from its top) is 0.97
        assert wave.lowest_behind_m_per_s < 2 * 2e-2  # between bumps, 20 mm from both
    assert all(math.isnan(wave.peak_m_per_s) for wave in waves_of(lambda r: 0.99 * bump(r, 80e-3)))


def test_behind_the_wave_is_where_it_is_not_yet_exceeded():
    # The velocity falls to 1.5 m/s, rises above the wave's, and falls to 0 farther behind.
    def speed(r):
        return np.select([r < 20e-3, r < 60e-3, r < 70e-3], [0, 4, 1.5], 2 * bump(r, 80e-3))

    for wave in waves_of(speed):
        assert wave.lowest_behind_m_per_s == pytest.approx(2 * bump(70e-3, 80e-3), abs=0.05)


def test_snapshots_are_those_while_the_tip_is_between_two_places():
    left = make_left(linear(1, 0))  # c_L from 8 mm on
    times_s = circle.wave_times_s(left)
    assert len(times_s) == 9  # 32.8 to 77.0 us
    for time_s in times_s:
        assert circle.TIP_FROM_M - 1e-9 <= CONTACT_M[0] + C_L * time_s <= circle.TIP_TO_M + 1e-9
        assert time_s / 5e-6 == pytest.approx(round(time_s / 5e-6))
    left.fronts.clear()
    assert circle.wave_times_s(left) == []


def test_four_of_five_snapshots_are_enough():
    def circle_with(n_spoilt):
        left = make_left(linear(1, 0))
        for k in range(n_spoilt):
            left.waves[2 * k] = replace(left.waves[2 * k], distance_m=NAN)
        return circle.circle_of(left)

    whole = circle_with(0)
    assert (whole.n_snapshots, whole.n_apart) == (9, 9)
    assert (whole.peak_m_per_s, whole.gap, whole.over_c_L_t) == pytest.approx((2, 0.25, 0.95))
    assert circle_with(1).holds
    assert circle_with(2).n_apart == 7  # 78 %
    assert not circle_with(2).holds


def test_without_a_snapshot_that_is_wanted_there_is_no_verdict():
    left = make_left(linear(1, 0))
    left.waves[:] = [wave for wave in left.waves if abs(wave.time_s - 50e-6) > 1e-9]
    assert circle.circle_of(left) is None
    left.waves.clear()
    assert circle.circle_of(left) is None
