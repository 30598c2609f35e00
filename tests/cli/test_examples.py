# SPDX-License-Identifier: BSD-3-Clause
"""The worked cases of examples/ on coarser meshes: they run to their end and show what their pages say."""

from pathlib import Path

import h5py
import numpy as np
import pytest
import slipfront
from common import ROOT, require_done, rows_of, sets
from slipfront.opened import OpenRun, open_run
from slipfront.read import Front

pytestmark = pytest.mark.slow

EXAMPLES = ROOT / "examples"

# Twice to four times the case's own; with the base's, which follows.
COARSE_M = {
    "granite": 20e-3,
    "steel": 2e-3,
    "gel": 1e-3,
    "pmma": 1e-3,
    "rate-and-state": 1e-3,
    "supershear": 0.5e-3,
    "pulse": 0.5e-3,
    "arrest": 1e-3,
    "barrier": 1e-3,
    "two-bodies": 0.5e-3,
    "experiment": 1e-3,
    "precursors": 2e-3,
    "stick-slip": 8e-3,
}


def c_S(run: OpenRun) -> float:
    return run.fact("wave_speeds.c_S_m_per_s")


def longest(run: OpenRun, direction: int) -> Front:
    return max((f for f in run.front_list if f.direction == direction), key=lambda front: front.length_m)


def speed_at(front: Front, x_m: float) -> float:
    """Mean speed over 10 mm around a place."""
    near = np.abs(front.x_m - x_m) < 5e-3
    return float(np.nanmean(front.v_tip_m_per_s[near]))


def onset_s(run: OpenRun, x_m: float) -> float:
    return min(
        float(np.interp(x_m, f.x_m[:: f.direction], f.onset_s[:: f.direction], left=np.inf, right=np.inf))
        for f in run.front_list
    )


def modes(run: OpenRun) -> set[str]:
    return {front["mode"] for front in run.info["fronts"]}


@pytest.fixture
def folder(program, tmp_path):
    def go(name: str, *changes: str) -> Path:
        case = [EXAMPLES / name / "case.toml", *sets(f"plate.element_size_m={COARSE_M[name]}", *changes)]
        printed = require_done(program("run", *case, "-o", tmp_path / name, "--overwrite")).stderr
        assert "\nwarning" not in printed, printed
        return tmp_path / name

    return go


@pytest.fixture
def run(folder):
    return lambda name, *changes: open_run(folder(name, *changes))


def test_every_example_is_here():
    assert sorted(COARSE_M) == sorted(path.parent.name for path in EXAMPLES.glob("*/case.toml"))


def test_granite_breaks_both_ways_below_the_rayleigh_speed(run):
    fault = run("granite")
    for direction in (-1, 1):
        front = longest(fault, direction)
        assert front.length_m > 0.95
        assert 0.7 * c_S(fault) < speed_at(front, 1 + 0.8 * direction) < 0.92 * c_S(fault)


def test_steel_slips_by_itself_far_from_the_edges_and_stops(run):
    block = run("steel")
    first = min(block.front_list, key=lambda front: front.onset_s[0])
    assert 0.1 < first.x_m[0] < 0.17
    assert "arrest" in {front["end"] for front in block.info["fronts"]}


def test_gel_on_a_rigid_base_passes_the_shear_wave_speed(run):
    gel = run("gel")
    assert 2 < c_S(gel) < 2.5
    front = longest(gel, 1)
    assert speed_at(front, 0.025) < c_S(gel) < speed_at(front, 0.065)


def test_pmma_a_second_front_starts_ahead_of_the_first(run):
    blocks = run("pmma")
    early, late = (onset_s(blocks, x) for x in (0.03, 0.08))
    assert 0.6 < (0.08 - 0.03) / (late - early) / c_S(blocks) < 1
    assert speed_at(longest(blocks, 1), 0.15) > 1.2 * c_S(blocks)


def test_rate_and_state_heals_behind_a_front_below_the_rayleigh_speed(run, tmp_path):
    blocks = run("rate-and-state")
    assert 0.75 < speed_at(longest(blocks, 1), 0.14) / c_S(blocks) < 0.92
    with h5py.File(tmp_path / "rate-and-state/interface.h5") as file:
        psi = file["psi"][:, int(np.argmin(np.abs(file["x_m"][:] - 0.1)))]
    assert psi.min() < 0.35 < 0.42 < psi[-1] < psi[0]


def test_supershear_both_ways_and_its_energies_balance(run):
    fault = run("supershear")
    for direction in (-1, 1):
        front = longest(fault, direction)
        assert speed_at(front, 0.075 + 0.065 * direction) > 1.41 * c_S(fault)
    balance = fault.balance
    assert np.max(np.abs(balance.imbalance_J_per_m)) < 1e-9 * balance.largest_J_per_m


def test_pulse_leaves_locked_interface_behind(run):
    strip = run("pulse")
    assert "pulse" in modes(strip)
    rate = np.abs(strip.history.slip_rate_m_per_s.to_numpy())
    row = np.searchsorted(strip.history.time_s, 110e-6)
    assert np.count_nonzero(rate[row] > 1e-2 * rate[row].max()) < 0.3 * rate.shape[1]


def test_arrest_lies_beyond_the_static_length_and_moves_with_d_c(run):
    half_m = longest(run("arrest"), 1).length_m
    assert 0.070 < half_m < 0.090
    shorter_m = longest(run("arrest", "friction.d_c_m=3.4e-6"), 1).length_m
    longer_m = longest(run("arrest", "friction.d_c_m=1.0e-6"), 1).length_m
    assert shorter_m < half_m < longer_m


def test_barrier_holds_the_front_back(run):
    blocks = run("barrier")
    before, behind = onset_s(blocks, 0.26), onset_s(blocks, 0.28)
    assert 0.02 / (behind - before) < 0.4 * c_S(blocks)
    assert onset_s(blocks, 0.38) < np.inf


def test_two_bodies_prefer_a_direction(run):
    pair = run("two-bodies")
    assert 0.9 < speed_at(longest(pair, 1), 0.12) / c_S(pair) < 1.05
    assert speed_at(longest(pair, -1), 0.02) > 1.3 * c_S(pair)


def test_the_record_tells_d_c(program, tmp_path):
    sweep, table = tmp_path / "out", tmp_path / "misfits.csv"
    varied = ["--vary", "friction.d_c_m=1.2e-6:2.2e-6:5"]
    coarse = sets(f"plate.element_size_m={COARSE_M['experiment']}")
    require_done(program("sweep", EXAMPLES / "experiment/case.toml", "-o", sweep, "-q", *varied, *coarse))
    require_done(program("compare", sweep, EXAMPLES / "experiment/record.csv", "--table", table))
    rows = [(float(row["friction.d_c_m"]), float(row["misfit"])) for row in rows_of(table)]
    nearest = min(rows, key=lambda row: row[1])
    assert len(rows) == 5 and nearest[0] in (1.2e-6, 1.45e-6) and nearest[1] < 0.6e-6


def test_precursors_grow_with_the_force_until_all_slides_below_mu_s(folder):
    sequence = slipfront.open(folder("precursors"))
    events = sequence.events
    assert list(events.is_global.to_numpy()) == [0] * (events.sizes["event"] - 1) + [1]
    large = events.isel(event=events.max_slip_m.to_numpy() > 1e-6)
    ends_m, friction = large.to_x_m.to_numpy(), large.friction_before.to_numpy()
    assert len(ends_m) >= 8
    assert np.all(np.diff(ends_m) >= 0) and np.all(np.diff(friction) > 0)
    assert ends_m[-2] < 0.6 * 0.2
    assert 0.32 < friction[-1] < 0.37
    # Fronts near c_S outrun what is predicted; those of the first events less.
    beyond_m = ends_m - large.predicted_to_x_m.to_numpy()
    assert np.nanmax(beyond_m[:3]) < np.nanmin(beyond_m[-4:]) and np.nanmin(beyond_m[-4:]) > 0.03


def test_stick_slip_runs_away_from_half_of_the_nucleation_length(folder):
    half_m, h_m = 0.051, COARSE_M["stick-slip"]
    sequence = slipfront.open(folder("stick-slip"))
    events = sequence.events
    assert events.sizes["event"] == 10
    assert events.is_global.to_numpy().tolist() == [0] + 9 * [1]
    np.testing.assert_allclose(events.begin_x_m[1:], 0.2, atol=h_m)
    np.testing.assert_allclose(np.diff(events.begin_s[5:]), 45, atol=3)
    for slow in sequence.slow:
        rate = np.abs(slow.slip_rate_m_per_s)
        at = rate.isel(time_s=-1)
        patch_m = at.x_m[at > 0.1 * at.max()]
        assert abs(float(patch_m[-1] - patch_m[0]) / 2 - half_m) < h_m
