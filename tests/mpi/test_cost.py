# SPDX-License-Identifier: BSD-3-Clause
"""What processes cost: counted in run.json, measured by bench --network, predicted by info --processes."""

import json
import os
import re
import shutil
import statistics
import subprocess
from pathlib import Path

import pytest
from conftest import AS_ROOT
from hostile.trials import HANG_S

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("SLIPFRONT_MPI", ROOT / "build" / "mpi" / "slipfront"))
pytestmark = pytest.mark.skipif(
    not PROGRAM.is_file() or shutil.which("mpirun") is None, reason="needs mpirun and a program built for MPI"
)

CASE = ROOT / "cases" / "reference" / "rigid_flat_a.toml"
KEYS = [
    "plate.element_size_m=1e-3",
    "time.end_s=0.2e-3",
    "time.interface_substeps=2",
    "time.interface_rows=2",
    "output.history_interval_s=4e-6",
]
SETS = [word for key in KEYS for word in ("--set", key)]


def alone(*args):
    command = [PROGRAM, *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, timeout=HANG_S, check=False)


def together(n, *args):
    command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(n), PROGRAM, *map(str, args)]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=HANG_S, env=os.environ | AS_ROOT, check=False
    )


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cost")
    for n in (2, 3):
        result = together(n, "run", CASE, *SETS, "--threads", 1, "-o", folder / str(n), "-q")
        assert (result.returncode, result.stderr) == (0, "")
    assert alone("run", CASE, *SETS, "-o", folder / "1", "-q").returncode == 0
    return [json.loads((folder / str(n) / "run.json").read_text()) for n in (1, 2, 3)]


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
    for times in ("computing_s", "waiting_in_exchanges_s", "waiting_in_commands_s"):
        assert len(cost[times]) == n
        assert all(t > 0 for t in cost[times])
    longest, mean = max(cost["computing_s"]), sum(cost["computing_s"]) / n
    assert cost["imbalance_largest_over_mean"] == pytest.approx(longest / mean)
    # 121 rows of u and v go to each neighbour with every exchange, in two to eight messages.
    exchanges = 2 * (n - 1) * (cost["steps"] // cost["steps_per_exchange"]) / cost["steps"]
    # The rest: commands of at most 50 steps and their answers, and energies.
    least_rest, most_rest = (2 * (n - 1) / steps for steps in (50, 5))
    assert 2 * exchanges + least_rest <= cost["messages_per_step"] <= 8 * exchanges + most_rest
    least = exchanges * halo * 121 * 4 * 8
    assert least <= cost["bytes_per_step"] < 1.5 * least
    # Of two processes both send the same halo; of three the middle one sends two.
    share = cost["bytes_per_step_of_busiest"] / cost["bytes_per_step"]
    assert share == pytest.approx(0.5, abs=0.1)
    assert 1 / n <= cost["messages_per_step_of_busiest"] / cost["messages_per_step"] < 0.6


def test_bench_measures_between_neighbours_and_from_the_leader():
    n = 3
    result = together(n, "bench", "--network", "--json")
    assert (result.returncode, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert told["processes"] == n
    neighbours, of_leader = [(k, k + 1) for k in range(n - 1)], [(0, k) for k in range(2, n)]
    assert [(link["from"], link["to"]) for link in told["links"]] == neighbours + of_leader
    for part in (neighbours, [(0, 1), *of_leader]):
        in_part = [link for link in told["links"] if (link["from"], link["to"]) in part]
        assert told["latency_s"] >= statistics.median(link["latency_s"] for link in in_part)
    for link in [told, *told["links"]]:
        assert link["latency_s"] > 0 and link["bandwidth_bytes_per_s"] > 0


def test_bench_prints_what_info_takes():
    result = together(2, "bench", "--network")
    assert (result.returncode, result.stderr) == (0, "")
    told = re.search(r"^info (--latency-s \S+ --bandwidth-bytes-per-s \S+)$", result.stdout, re.MULTILINE)
    assert alone("info", CASE, *SETS, "--processes", 2, *told[1].split()).returncode == 0


def test_bench_of_a_network_needs_processes():
    result = alone("bench", "--network")
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert "mpirun -n 2 or more" in result.stderr


@pytest.mark.parametrize("words", ["--network", "--statics 50 --solver petsc"])
def test_bench_that_cannot_tell_fails(words):
    """Within each process: mpirun reads what they print."""
    command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", "2", "bash", "-c"]
    command.append(f"exec {PROGRAM} bench {words} > /dev/full")
    result = subprocess.run(command, env=os.environ | AS_ROOT, capture_output=True, text=True, timeout=HANG_S)
    assert result.returncode == 1
    assert "slipfront: standard output cannot be written (No space left on device)" in result.stderr


@pytest.mark.parametrize(
    "words, refused",
    [
        ("--network --statics 50", "--network takes no --statics"),
        ("--statics 50 --threads 2", "--statics takes no --threads"),
        ("--solver direct", "without --statics takes no --solver"),
    ],
)
def test_bench_measures_one_thing_at_a_time(words, refused):
    result = alone("bench", *words.split())
    assert result.returncode == 2
    assert refused in result.stderr


def test_bench_tells_statics_as_json():
    told = json.loads(alone("bench", "--statics", 50, "--solver", "direct", "--json").stdout)
    assert (told["columns"], told["rows"], told["solver"]) == (50, 25, "direct")
    assert told["critical_shear_m"] > 0


def predicted(n, *options):
    result = alone("info", CASE, *SETS, "--processes", n, *options)
    assert (result.returncode, result.stderr) == (0, "")
    lines = re.findall(r"^  (.+?) {2,}(.+)$", result.stdout, re.MULTILINE)
    return dict(lines)


def test_info_predicts_what_a_run_counts(runs):
    lines, cost = predicted(3), runs[2]["processes"]
    assert lines["exchange every"] == f"{cost['steps_per_exchange']} steps"
    assert f"and {cost['halo_columns'][0]} beside them" in lines["columns of nodes of each"]
    sent = float(lines["bytes sent per step"].split()[0])
    # Commands and answers are not in it.
    assert 0.7 * sent <= cost["bytes_per_step_of_busiest"] < 1.5 * sent


def test_info_follows_the_network():
    def expected_s(*options):
        return float(re.fullmatch(r"(\S+) s", predicted(3, *options)["expected time"])[1])

    # So slow that no computing meanwhile hides it.
    assert expected_s("--latency-s", 1e3) > expected_s("--latency-s", 1e-6)
    assert expected_s("--bandwidth-bytes-per-s", 1) > expected_s("--bandwidth-bytes-per-s", 1e9)


@pytest.mark.parametrize(
    "options, told",
    [
        (["--processes", 300], "choose at most"),
        (["--processes", 0], "--processes"),
        (["--processes", 2, "--latency-s", 0], "--latency-s"),
        (["--processes", 2, "--bandwidth-bytes-per-s", "inf"], "finite"),
    ],
)
def test_info_refuses(options, told):
    result = alone("info", CASE, *SETS, *options)
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert told in result.stderr
