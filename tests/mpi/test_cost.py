# SPDX-License-Identifier: BSD-3-Clause
"""What ranks cost: counted in run.json, predicted by info --processes."""

import json
import re

import pytest
from common import ROOT, refusal, require_done, run_json, sets
from conftest import Mpirun

CASE = (
    ROOT / "cases/reference/rigid_flat_a.toml",
    *sets("plate.element_size_m=1e-3", "time.end_s=0.2e-3", "time.interface_substeps=2"),
    *sets("time.interface_rows=2", "output.history_interval_s=4e-6"),
)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    mpirun = Mpirun(tmp_path_factory.mktemp("cost"))
    require_done(mpirun.alone("run", *CASE, "-o", 1, "-q"))
    for n in (2, 3):
        result = mpirun(n, "run", *CASE, "--threads", 1, "-o", n, "-q")
        assert (result.returncode, result.stderr) == (0, "")
    return [run_json(mpirun.folder / str(n)) for n in (1, 2, 3)]


def test_one_process_has_no_counters(runs):
    assert "processes" not in runs[0]


@pytest.mark.parametrize("n", [2, 3])
def test_run_json_tells_what_processes_cost(runs, n):
    run = runs[n - 1]
    cost = run["processes"]
    assert cost["count"] == n
    assert cost["steps"] == run["steps"]
    # 401 columns of nodes; a part has a halo beside each neighbour.
    assert sum(cost["own_columns"]) == 401
    halo = cost["halo_columns"][0]
    assert halo > 0
    assert cost["halo_columns"] == [halo] + [2 * halo] * (n - 2) + [halo]
    for times in ("computing_s", "waiting_in_exchanges_s", "waiting_in_collectives_s"):
        assert len(cost[times]) == n
        assert all(t > 0 for t in cost[times])
    longest, mean = max(cost["computing_s"]), sum(cost["computing_s"]) / n
    assert cost["imbalance_largest_over_mean"] == pytest.approx(longest / mean)
    # 121 rows of u and v go to each neighbour with every exchange, in two to eight messages.
    exchanges = 2 * (n - 1) * (cost["steps"] // cost["steps_per_exchange"]) / cost["steps"]
    # The rest: reports of at most 50 steps, up and down the tree, and energies.
    least_rest, most_rest = (2 * (n - 1) / steps for steps in (50, 5))
    assert 2 * exchanges + least_rest <= cost["messages_per_step"] <= 8 * exchanges + most_rest
    least = exchanges * halo * 121 * 4 * 8
    assert least <= cost["bytes_per_step"] < 1.5 * least
    # Of two processes both send the same halo; of three the middle one sends two.
    share = cost["bytes_per_step_of_busiest"] / cost["bytes_per_step"]
    assert share == pytest.approx(0.5, abs=0.1)
    assert 1 / n <= cost["messages_per_step_of_busiest"] / cost["messages_per_step"] < 0.6


def test_bench_tells_statics_as_json(mpirun):
    printed = json.loads(mpirun.alone("bench", "--statics", 50, "--solver", "direct", "--json").stdout)
    assert (printed["columns"], printed["rows"], printed["solver"]) == (50, 25, "direct")
    assert printed["critical_shear_m"] > 0


@pytest.mark.parametrize(
    "command, expected",
    [
        ("bench --statics 50 --threads 2", "--statics takes no --threads"),
        ("bench --solver direct", "without --statics takes no --solver"),
        ("info --processes 10000000", "choose at most"),
        ("info --processes 0", "--processes"),
    ],
)
def test_bench_and_info_refuse(mpirun, command, expected):
    name, *options = command.split()
    assert expected in refusal(mpirun.alone(name, *(CASE if name == "info" else ()), *options))


def predicted(mpirun, n):
    printed = require_done(mpirun.alone("info", *CASE, "--processes", n)).stdout
    return dict(re.findall(r"^  (.+?) {2,}(.+)$", printed, re.MULTILINE))


def test_info_predicts_what_a_run_counts(mpirun, runs):
    lines, cost = predicted(mpirun, 3), runs[2]["processes"]
    assert lines["exchange every"] == f"{cost['steps_per_exchange']} steps"
    assert f"and {cost['halo_columns'][0]} beside them" in lines["columns of nodes of each"]
    sent = float(lines["bytes sent per step"].split()[0])
    # Reports are not in it.
    assert 0.7 * sent <= cost["bytes_per_step_of_busiest"] < 1.5 * sent
