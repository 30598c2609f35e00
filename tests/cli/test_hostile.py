# SPDX-License-Identifier: BSD-3-Clause
"""A share of the trials of tests/hostile: whatever happens to a run, its results are right or it is refused.
`make hostile` does them all."""

import pytest
from hostile import damage, disk, energy, faults, folders, kills, repeats, sweeps
from hostile.trials import Bench, hold, remove, scratch_folder

pytestmark = pytest.mark.slow


@pytest.fixture
def bench(program):
    shim = program.path.with_name("slipfront_fault.so")
    if not shim.is_file():
        pytest.fail(f"{shim} is missing: build slipfront_fault", pytrace=False)
    bench = Bench(program.path, shim, scratch_folder())
    yield bench
    remove(bench.scratch)


def all_hold(trials):
    outcome = hold("", trials)
    assert outcome.passed > 0
    assert not outcome.failures, "\n".join(outcome.failures)


@pytest.mark.parametrize("over_results", [False, True])
def test_failing_calls(bench, over_results):
    setting = faults.run_setting(bench, over_results)
    all_hold(faults.trials(setting, faults.FAILURES, every=31))


@pytest.mark.parametrize("over_results", [False, True])
def test_deaths_while_results_are_made_and_published(bench, over_results):
    setting = faults.run_setting(bench, over_results)
    all_hold(faults.trials(setting, faults.DEATHS, every=5, among=slice(-60, None)))


def test_power_lost_between_checkpoints(bench):
    setting = faults.run_setting(bench, False)
    all_hold(faults.trials(setting, [("power", 0)], every=7))


def test_deaths_while_earlier_work_is_removed(bench):
    setting = faults.run_over_work_setting(bench)
    all_hold(faults.trials(setting, faults.DEATHS[:1] + faults.FAILURES[:1], among=slice(24)))


def test_deaths_of_a_verification(bench):
    all_hold(faults.trials(faults.verify_setting(bench), faults.DEATHS, every=5))


def test_small_and_full_disks(bench):
    if reason := disk.is_allowed(bench):
        pytest.skip(f"no file system can be mounted here: {reason}")
    all_hold(disk.trials(bench, 6, 8))


@pytest.mark.parametrize("kind", ["graded", "single_precision", "prestressed_absorbing"])
def test_deaths_at_random_moments(bench, kind):
    all_hold(kills.trials(bench, 2, kinds=(kind,)))


def test_cut_off_and_given_again(bench):
    all_hold(repeats.trials(bench, 4))


def test_damaged_states(bench):
    all_hold(damage.trials(bench, every=4))


def test_forged_checkpoints(bench):
    all_hold(damage.forged_trials(bench, 12))


def test_two_processes_in_one_folder(bench):
    all_hold(folders.process_trials(bench, 4))


def test_foreign_files_of_reserved_names(bench):
    all_hold(folders.foreign_trials(bench, every=5))


def test_signals(bench):
    all_hold(folders.signal_trials(bench, names=("HUP", "XFSZ"), kinds=("triggered",)))


def test_closed_streams_and_readers_who_go(bench):
    all_hold(folders.stream_trials(bench))


def test_sweeps(bench):
    all_hold(sweeps.trials(bench, 1, n_points=40))


def test_energy_balance_of_random_cases(bench):
    all_hold(energy.balance_trials(bench, 25))


def test_results_do_not_depend_on_the_number_of_threads(bench):
    all_hold(energy.thread_trials(bench, kinds=("fillet", "graded", "ramp", "prestressed_periodic")))
