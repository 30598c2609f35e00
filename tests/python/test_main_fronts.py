# SPDX-License-Identifier: BSD-3-Clause
"""Which fronts are an event's own, and which of their nodes count."""

from __future__ import annotations

import numpy as np
import pytest
from drawing.criteria import falls, tail
from slipfront.figures.main_fronts import counted, main_fronts
from slipfront.opened import open_run
from synthetic import FRONTS_HEADER, WAVE_SPEEDS, case_text, make_front, write_csv, write_run

C_L = WAVE_SPEEDS["c_L_m_per_s"]
COLUMNS = 300
X_M = np.linspace(0, 0.2, COLUMNS + 1)
PEAK_M = X_M[217]  # 144.67 mm


@pytest.fixture
def run_of(tmp_path):
    """A run of a kind with the fronts given."""

    def make(kind: str, fronts: list[list]):
        folder = tmp_path / kind
        write_run(folder, kind, 0.6, COLUMNS, 4, 4, 2)
        write_csv(folder / "fronts.csv", FRONTS_HEADER, [row for front in fronts for row in front])
        return open_run(folder)

    return make


def with_speeds(front: list, change: dict[float, float]) -> list:
    """The front with other speeds, in c_L, at the nodes nearest to some places in mm."""
    x = np.array([row[1] for row in front])
    for place_mm, v in change.items():
        front[int(np.argmin(np.abs(x - 1e-3 * place_mm)))][4] = v * C_L
    return front


def span_mm(run, front) -> tuple[float, float]:
    x = 1e3 * front.x_m[counted(run, front)]
    return round(x[0], 1), round(x[-1], 1)


LEFT, RIGHT = (1, X_M, 1, 0.008, 0.19, 1e-6), (1, X_M, -1, 0.195, 0.02, 1e-6)


@pytest.mark.parametrize(
    "kind, fronts, spans",
    [
        # Contact from 5 mm, zone 10 mm, margin 10 mm; 5 mm beyond the nucleation.
        ("left", [LEFT], [(25.3, 190.0)]),
        ("right", [RIGHT], [(180.0, 20.0)]),
        (
            "spontaneous",
            [(1, X_M, -1, PEAK_M, 0.02, 0.0), (2, X_M, 1, PEAK_M, 0.19, 0.0)],
            [(139.3, 20.0), (150.0, 190.0)],
        ),
    ],
)
def test_fronts_count_from_some_way_beyond_where_they_begin(run_of, kind, fronts, spans):
    run = run_of(kind, [make_front(*front) for front in fronts])
    assert [span_mm(run, front) for front in main_fronts(run)] == spans


@pytest.mark.parametrize(
    "kind, fronts, main",
    [
        ("spontaneous", [], []),
        # The longer one starts elsewhere.
        ("spontaneous", [(1, X_M, -1, PEAK_M, 0.11, 0.0), (2, X_M, -1, 0.10, 0.01, 60e-6)], [1]),
        # Of two from the trigger the longer one.
        ("left", [(1, X_M, 1, 0.012, 0.05, 1e-6), (2, X_M, 1, 0.01, 0.15, 40e-6)], [2]),
        # One stays at its trigger.
        ("right", [(1, X_M, 1, 0.186, 0.19, 1e-6), (2, X_M, -1, 0.19, 0.1, 1e-6)], [2]),
    ],
)
def test_main_fronts_are_the_longest_from_the_trigger(run_of, kind, fronts, main):
    run = run_of(kind, [make_front(*front) for front in fronts])
    assert [front.id for front in main_fronts(run)] == main


def test_margin_and_zone_are_those_of_the_case(run_of):
    run = run_of("left", [make_front(*LEFT)])
    text = case_text("left", 0.6, COLUMNS).replace("trigger_zone_m = 10e-3", "trigger_zone_m = 15e-3")
    folder = run.place.folder
    (folder / "case.resolved.toml").write_text(text.replace("margin_m = 10e-3\n", "margin_m = 4e-3\n"))
    run = open_run(folder)
    # The edge margin of the statics changes with it: the zone begins 4 mm outside of 15 mm.
    assert span_mm(run, main_fronts(run)[0])[0] == pytest.approx(11 + 15 + 4, abs=0.7)


def test_a_front_counts_up_to_where_it_stays_slow(run_of):
    """A slow stretch behind which it is fast again belongs to it."""
    front = make_front(*LEFT)
    slow = {60.0: 0.05, 60.667: 0.05} | {1e3 * row[1]: 0.09 for row in front if row[1] > 0.1599}
    slow |= {12.0: 0.01, 12.667: 0.01, 13.333: 0.01}  # a slow beginning at the trigger does not end it
    run = run_of("left", [with_speeds(front, slow)])
    (front,) = main_fronts(run)
    assert span_mm(run, front) == (25.3, 159.3)
    assert np.flatnonzero(np.diff(counted(run, front))).size == 2  # in one piece


def test_undefined_speeds_decide_nothing(run_of):
    front = make_front(*LEFT)
    for row in front[60:64]:
        row[4] = ""
    assert front[-1][4] == ""
    run = run_of("left", [with_speeds(front, {1e3 * front[-3][1]: 0.01, 1e3 * front[-2][1]: 0.01})])
    assert span_mm(run, main_fronts(run)[0]) == (25.3, 188.0)


def test_tail_is_the_last_stretch_that_counts(run_of):
    front = make_front(*LEFT)
    slow = {1e3 * row[1]: 0.05 for row in front if row[1] > 0.0999}
    run = run_of("left", [with_speeds(front, slow)])
    (front,) = main_fronts(run)
    x = 1e3 * front.x_m[tail(run, front)]
    assert (x[0], x[-1]) == pytest.approx((99.333 - 20, 99.333), abs=0.001)


def test_a_front_that_runs_when_the_record_ends_has_no_tail(run_of):
    run = run_of("left", [make_front(1, X_M, 1, 0.008, 0.15, 1e-6)])
    (front,) = main_fronts(run)
    assert tail(run, front).any()
    run.place.info["fronts"][0]["end"] = "record_end"
    assert not tail(run, front).any()


def test_falls_are_stretches_of_five_millimetres_where_speed_falls_and_ratio_rises(run_of):
    front = make_front(*LEFT)
    for row in front:
        x_mm = 1e3 * row[1]
        if row[7] != "":
            row[7], row[8] = x_mm * 1e4, 1e6  # t_d / p_d rises with x
        falling = 60.3 < x_mm < 70.3 or 100.3 < x_mm < 103.3
        row[4] = (2 - 1e-3 * x_mm if falling else 1 + 1e-3 * x_mm) * C_L
    run = run_of("left", [front])
    (front,) = main_fronts(run)
    x = 1e3 * front.x_m[falls(run, front)]
    # The step up before 60.667 mm is none, the step down behind 70 mm is; the second stretch is too short.
    assert (x[0], x[-1]) == pytest.approx((60.667, 70.667), abs=0.01) and len(x) == 16
