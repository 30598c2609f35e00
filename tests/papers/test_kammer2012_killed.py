# SPDX-License-Identifier: BSD-3-Clause
"""A batch of runs whose process is killed goes on to the files of an undisturbed one."""

import sys

import pytest
from common import ROOT, WITH_PACKAGE, call, require_done, start, wait_until

BASES = [sys.executable, ROOT / "papers/kammer2012/bases.py", "--quick", "--threads", "1", "-o"]


def n_kept(folder):
    return len(list((folder / "unfinished/state/runs").glob("*.bin")))


@pytest.mark.slow
def test_a_batch_goes_on_where_it_was_killed(tmp_path):
    undisturbed, killed = tmp_path / "undisturbed", tmp_path / "killed"
    require_done(call(*BASES, undisturbed, env=WITH_PACKAGE))
    for n_runs in (1, 5):
        with start(*BASES, killed, env=WITH_PACKAGE) as process:
            wait_until(lambda n_runs=n_runs: n_kept(killed) >= n_runs, process)
            process.kill()
    require_done(call(*BASES, killed, env=WITH_PACKAGE))
    names = sorted(file.name for file in undisturbed.iterdir())
    assert sorted(file.name for file in killed.iterdir()) == names
    for name in names:
        assert (killed / name).read_bytes() == (undisturbed / name).read_bytes(), name
