# SPDX-License-Identifier: BSD-3-Clause
"""All trials in full: python -m hostile PROGRAM; tests/cli/test_hostile.py has a share of them.

The last line tells how many held."""

import sys
from pathlib import Path

from common import as_from_a_terminal

from . import damage, disk, energy, faults, folders, kills, repeats, sweeps
from .trials import Bench, hold, remove, scratch_folder

#: At every call; the other ways at every fifth.
AT_EVERY_CALL = [faults.FAILURES[0], faults.FAILURES[3], faults.DEATHS[0]]
AT_SOME = [way for way in faults.FAILURES + faults.DEATHS if way not in AT_EVERY_CALL]


def parts(bench):
    """Titles, and what makes the trials."""
    for over in (False, True):
        setting = faults.run_setting(bench, over)
        yield f"failing calls and deaths, {setting.name}", faults.trials(setting, AT_EVERY_CALL)
        yield f"other failures, {setting.name}", faults.trials(setting, AT_SOME, every=5)
    setting = faults.run_over_work_setting(bench)
    yield f"failing calls and deaths, {setting.name}", faults.trials(setting, AT_EVERY_CALL, among=slice(40))
    setting = faults.verify_setting(bench)
    yield f"failing calls and deaths, {setting.name}", faults.trials(setting, faults.FAILURES + faults.DEATHS)
    if reason := disk.is_allowed(bench):
        print(f"small and full disks: left out, no file system can be mounted here: {reason}")
    else:
        yield "small and full disks", disk.trials(bench, 80, 40)
    yield "deaths at random moments", kills.trials(bench, 100)
    yield "cut off and given again", repeats.trials(bench, 8)
    yield "damaged states, event", damage.trials(bench)
    yield "damaged states, prestressed", damage.trials(bench, seed=2, kind="prestressed_absorbing", every=3)
    yield "forged checkpoints", damage.forged_trials(bench, 100)
    yield "two processes", folders.process_trials(bench, 20)
    yield "foreign files", folders.foreign_trials(bench)
    yield "signals", folders.signal_trials(bench)
    yield "streams", folders.stream_trials(bench)
    yield "sweeps", sweeps.trials(bench, 10)
    yield "energy balance", energy.balance_trials(bench, 200)
    yield "numbers of threads", energy.thread_trials(bench)


def main(program):
    as_from_a_terminal()
    bench = Bench(
        Path(program).resolve(), Path(program).resolve().with_name("slipfront_fault.so"), scratch_folder()
    )
    try:
        outcomes = [hold(title, trials) for title, trials in parts(bench)]
    finally:
        remove(bench.scratch)
    n_failed = sum(len(outcome.failures) for outcome in outcomes)
    print(f"{sum(outcome.passed for outcome in outcomes)} passed, {n_failed} failed")
    return int(n_failed > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
