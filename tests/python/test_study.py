# SPDX-License-Identifier: BSD-3-Clause
"""Studies of a case: limits of sequences, what is varied, where speeds are compared, what is chosen."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from slipfront.files import DataError
from slipfront.read import Front, longest_each_way
from slipfront.study.convergence import DAMPING, FACTOR, SIZE, SUBSTEPS, plans_of, points_of
from slipfront.study.interface_step import Stepping, cheapest, extrapolated
from slipfront.study.speeds import (
    ALTERNATING,
    CONVERGED,
    FEWEST_STATIONS,
    GROWING,
    HIGHEST_ORDER,
    MONOTONE,
    NO_LIMIT,
    NOT_CONVERGED,
    TOO_FEW,
    UNKNOWN,
    Place,
    Run,
    extrapolate,
    summarise,
)

Q = (4.0, 2.0, 1.0)
NAN = math.nan
# 60 halvings leave 1e-15 of the order; differences of values of order 1 lose six digits at most.
ROUNDING = 1e-9


def power_law(q, limit, factor, order):
    return [limit + factor * each**order for each in q]


@pytest.mark.parametrize("q", [Q, (0.3, 0.2, 0.15), (1.0, 0.9, 0.2)])
@pytest.mark.parametrize("order", [0.5, 1.0, 1.7, 2.0])
@pytest.mark.parametrize("factor", [0.3, -0.02])
def test_order_and_limit_of_a_power_law(q, order, factor):
    limit = extrapolate(q, power_law(q, 5, factor, order))
    assert limit.trend == MONOTONE
    assert limit.order == pytest.approx(order, abs=ROUNDING)
    assert limit.value == pytest.approx(5, abs=ROUNDING)


def test_no_order_above_the_schemes_is_trusted():
    f = power_law(Q, 5, 0.1, 6)
    limit = extrapolate(Q, f)
    assert limit.order == pytest.approx(6, abs=ROUNDING)
    assert limit.value == pytest.approx(f[2] - (f[1] - f[2]) / 3, abs=ROUNDING)  # 2^2 - 1


@pytest.mark.parametrize(
    "f",
    [power_law(Q, 5, 0.1, -1), [-math.log(4), -math.log(2), 0], [1, 1.1, 0.9]],
    ids=("power", "log", "wild"),
)
def test_growing_differences_have_no_limit(f):
    limit = extrapolate(Q, f)
    assert limit.trend == GROWING and math.isnan(limit.value) and math.isnan(limit.order)


def test_alternating_values_enclose_their_limit():
    limit = extrapolate(Q, [1.4, 0.8, 1.1])
    assert (limit.trend, limit.value) == (ALTERNATING, pytest.approx(0.95))
    assert math.isnan(limit.order)
    assert limit.error(0.8) == pytest.approx(0.15 + 0.15)


def test_equal_values_are_their_limit_and_a_missing_one_leaves_none():
    limit = extrapolate(Q, [3, 3, 3])
    assert (limit.value, limit.order) == (3, HIGHEST_ORDER)
    missing = extrapolate(Q, [3, NAN, 3])
    assert missing.trend == UNKNOWN and math.isnan(missing.error(3))


def test_an_error_is_the_distance_from_the_limit_or_without_one_the_spread():
    f = power_law(Q, 5, 0.1, 1)
    assert extrapolate(Q, f).error(f[1]) == pytest.approx(0.2)
    assert extrapolate(Q, [1, 1.1, 0.7]).error(1.1) == pytest.approx(0.4)


HALVED = (2.0, 1.0, 0.5)


def summary_of(n, values, tolerance=0.02):
    """Of stations of one sequence, as the study makes them: the case is the middle value."""
    f = np.array([values(k) for k in range(n)])
    limits = [extrapolate(HALVED, each.tolist()) for each in f]
    errors = np.array([limit.error(own) for limit, own in zip(limits, f[:, 1], strict=True)]) / f[:, 1]
    orders = np.array([limit.order for limit in limits])
    return summarise(errors, orders, np.abs(np.diff(f)) / f[:, [1]] / math.log(2), tolerance)


def test_a_verdict_follows_from_error_and_growth():
    def second(factor):
        return summary_of(20, lambda k: power_law(HALVED, 1 + 0.1 * k, factor, 2))

    assert second(0.01).verdict == CONVERGED
    assert second(0.01).median_order == pytest.approx(2, abs=1e-6)
    assert second(0.01).growth == pytest.approx(0.25)
    assert second(0.2).verdict == NOT_CONVERGED
    diverging = summary_of(20, lambda k: power_law(HALVED, 1 + 0.1 * k, 0.2, -1))
    assert (diverging.verdict, diverging.growth) == (NO_LIMIT, pytest.approx(2))


def test_noise_on_a_first_order_sequence_does_not_turn_its_verdict():
    dice = random.Random(1)
    s = summary_of(80, lambda _: [v + dice.gauss(0, 0.003) for v in power_law(HALVED, 1, 0.1, 1)])
    assert s.verdict == NOT_CONVERGED
    # A difference of 0.05 carries noise of 0.003 sqrt(2), a tenth: the order is known to about 0.2 at one
    # station; the median of 80 to a small part of that, and biased by less than it.
    assert s.median_order == pytest.approx(1, abs=0.1)
    assert s.median_relative_error == pytest.approx(0.1 / 1.1, abs=0.01)


def test_a_verdict_needs_enough_stations():
    f = power_law(HALVED, 1, 0.01, 2)
    assert summary_of(FEWEST_STATIONS - 1, lambda _: f).verdict == TOO_FEW
    s = summary_of(30, lambda k: f if k % 3 == 0 else [*f[:2], NAN])
    assert (s.n_stations, s.n_stations_of_case, s.verdict) == (10, 30, TOO_FEW)


# --- What is varied

CASE = {SIZE: 2.5e-3, FACTOR: 0.9, SUBSTEPS: 18, DAMPING: 1e-7}


def test_element_step_and_damping_are_refined():
    plans = plans_of(CASE, [])
    assert [(plan.key, plan.values, plan.own) for plan in plans] == [
        (SIZE, [5e-3, 2.5e-3, 1.25e-3], 1),
        (SUBSTEPS, [9, 18, 36, 72], 1),
        (DAMPING, [2e-7, 1e-7, 5e-8, 0], 1),
    ]
    assert [plan.values[plan.last] for plan in plans] == [
        [5e-3, 2.5e-3, 1.25e-3],
        [18, 36, 72],
        [2e-7, 1e-7, 5e-8],
    ]
    points = points_of(plans)
    assert points[0][1] == points[1][1] == points[2][1] == {SIZE: 2.5e-3, SUBSTEPS: 18, DAMPING: 1e-7}
    assert points[1][3] == {SIZE: 2.5e-3, SUBSTEPS: 72, DAMPING: 1e-7}


def test_without_sub_cycling_the_step_is_refined_and_damping_that_is_not_there_is_left_out():
    plans = plans_of(CASE | {SUBSTEPS: 1, DAMPING: 0.0}, [])
    assert [plan.key for plan in plans] == [SIZE, FACTOR]
    assert plans[1].values == [0.9, 0.45, 0.225]


@pytest.mark.parametrize("sizes", [[5e-3, 2.5e-3], [4e-3, 2e-3, 1e-3], [5e-3, 2.5e-3, 2.5e-3]])
def test_sizes_that_make_no_sequence_are_refused(sizes):
    with pytest.raises(DataError, match="--element-sizes"):
        plans_of(CASE, sizes)


# --- Where speeds are compared


def front(x_m, v, direction=-1):
    ones = np.ones(len(x_m))
    return Front(0, direction, np.array(x_m), ones, np.array(v), ones, ones, ones, ones)


def run(*fronts, left_out_m=()):
    return Run({}, longest_each_way(list(fronts)), list(left_out_m))


def test_a_speed_is_linear_between_the_nodes_of_a_front():
    of = run(front([0.03, 0.02, 0.01], [100.0, 200.0, NAN]))
    assert of.speed_m_per_s(Place(0.0225, -1)) == pytest.approx(175)
    assert of.speed_m_per_s(Place(0.02, -1)) == 200
    for x_m, direction in ((0.015, -1), (0.031, -1), (0.0225, 1)):
        assert math.isnan(of.speed_m_per_s(Place(x_m, direction)))


def test_the_longest_front_of_each_direction_counts():
    fronts = [
        front([0.03, 0.02], [1.0, 1.0]),
        front([0.09, 0.04], [2.0, 2.0]),
        front([0.02, 0.04], [3.0, 3.0], 1),
    ]
    assert longest_each_way(fronts) == {-1: fronts[1], 1: fronts[2]}


def test_stations_are_beyond_nucleation_and_what_is_left_out():
    x = np.arange(101) * 1e-3
    of = run(front(x, 500 + x, 1), left_out_m=[(-0.01, 0.011), (0.0295, 0.041)])
    # 5 mm from the start, and not in a zone.
    assert [place.x_m for place in of.stations(2e-3)] == pytest.approx(
        [k * 2e-3 for k in range(6, 51) if not 15 <= k <= 20]
    )
    assert len(run(front(x, 500 + x, 1)).stations(2e-3)) == 51 - 3
    assert run(front(x, np.full(101, NAN), 1)).stations(2e-3) == []


# --- The step at the interface


def test_errors_are_those_of_nine_tenths_of_the_stations():
    way = Stepping("plain", 0.9, v_m_per_s=np.array([*range(101, 110), NAN])).against(np.full(10, 100.0))
    assert (way.n_stations, way.median_error, way.p90_error) == (9, pytest.approx(0.05), pytest.approx(0.09))
    way = Stepping("plain", 0.9, v_m_per_s=np.arange(101.0, 121)).against(np.full(20, 100.0))
    assert way.p90_error == pytest.approx(0.18)
    assert math.isnan(Stepping("plain", 0.9).against(np.empty(0)).p90_error)


def test_two_layers_are_extrapolated_linearly_in_the_sub_step():
    ways = [
        Stepping("layer", 0.9, rows, n, n, 1.0, v_m_per_s=np.array([100 + 10 / n, NAN]))
        for rows in (2, 4)
        for n in (2, 4, 9)
    ]
    found = extrapolated(ways)
    told = [(way.interface_rows, way.interface_substeps, way.cost_over_plain, way.time_s) for way in found]
    assert told == [(2, 4, 6, 2), (4, 4, 6, 2)]
    np.testing.assert_allclose(found[0].v_m_per_s, [100, NAN])


def test_the_cheapest_is_compared_at_nine_tenths_of_the_stations():
    def way(kind, cost, p90_error, n_stations):
        return Stepping(kind, 0.9, cost_over_plain=cost, p90_error=p90_error, n_stations=n_stations)

    ways = [way("layer", 1, 0.01, 17), way("layer", 2, 0.011, 20), way("extrapolated", 3, 0, 20)]
    assert cheapest(ways, 20, 0.01) is None
    ways += [way("plain", 5, 0, 20), way("layer", 4, 0.01, 18)]
    assert cheapest(ways, 20, 0.01) is ways[4]
