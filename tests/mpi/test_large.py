# SPDX-License-Identifier: BSD-3-Clause
"""Plates of so many squares, under given tractions, that the leader knows only their interfaces."""

import re
import sys

import pytest
from common import PEAK_BYTES, require_done, run_json
from test_same import require_same, stop_after_checkpoint

# 600,000 nodes.
PLATE = """\
title = "large"
[plate]
width_m = {width_m}
height_m = 0.6
element_size_m = 1e-3
corner = "none"
{plate}
[base]
{base}
[loading]
method = "prestress"
[prestress]
{prestress}
[friction]
law = "velocity_weakening"
mu_s = 0.6
mu_k = 0.1
[event]
kind = "nucleation"
[nucleation]
form = "overstress"
overstress_Pa = 1e6
x_m = {x_m}
half_length_m = 0.02
[time]
end_s = {end_s}
{time}
[output]
{output}
[probes]
x_m = [0.5, 0.3333, 0.501, 0.0, 1.0, 0.9996]
y_m = [0.0, 0.1, 0.25, 0.6, 0.3, {y_m}]
interval_s = 1e-6
{rest}
"""
UNIFORM = "t_Pa = 0.45e6\np_Pa = 1e6"
BASE = """
kind = "body"
youngs_modulus_Pa = 5e9
poissons_ratio = 0.3
density_kg_per_m3 = 1500
stiffness_damping_s = 1e-7
height_m = 0.55
"""
CASES = {
    "absorbing edges": {
        "plate": 'sides = "absorbing"\ntop = "absorbing"',
        "output": "snapshot_times_s = [0, 2.9e-5]",
    },
    "loaded edge, single precision": {
        "time": 'interface_substeps = 4\nprecision = "single"',
        "prestress": 'file = "prestress.csv"',
    },
    # The rupture passes the sides.
    "periodic, two bodies": {
        "plate": 'sides = "periodic"',
        "base": BASE + 'sides = "periodic"',
        "x_m": 0.99,
        "y_m": -0.2,
        "output": "snapshot_interval_s = 1.6e-5",
        "end_s": 2e-5,
    },
    # Then the leader has to know all cells: they are no squares, to the accuracy of these.
    "not quite squares": {"width_m": 1.0000003, "end_s": 6e-6},
}


# Where two parts meet in the patch of the event.
PROCESSES = dict.fromkeys(CASES, 3) | {"periodic, two bodies": 2}


def write_case(folder, name, **changes):
    values = {
        "width_m": 1.0,
        "base": 'kind = "rigid"',
        "prestress": UNIFORM,
        "x_m": 0.34,
        "y_m": 0.2,
        "end_s": 3e-5,
    }
    values |= dict.fromkeys(("plate", "time", "output", "rest"), "") | CASES[name] | changes
    (folder / "prestress.csv").write_text("x_m,t_Pa,p_Pa\n0,0.4e6,1e6\n0.6,0.46e6,1e6\n1,0.43e6,1.1e6\n")
    (folder / "case.toml").write_text(PLATE.format(**values))
    return folder / "case.toml"


@pytest.mark.parametrize("name", CASES)
def test_processes_change_nothing(name, tmp_path, mpirun):
    case = write_case(tmp_path, name)
    one = tmp_path / "one"
    require_done(mpirun.alone("run", case, "-o", one, "-q"))
    assert (one / "fronts.csv").read_text().count("\n") > 20
    several = tmp_path / "several"
    require_done(mpirun(PROCESSES[name], "run", case, "-o", several, "-q"))
    require_same(one, several, 1e-7 if "single" in name else 1e-13)


def test_any_number_of_processes_goes_on(tmp_path, mpirun):
    """Other than with few nodes a checkpoint of several processes has no displacements before the event."""
    case = write_case(tmp_path, "absorbing edges", end_s=1e-4)
    one, several = tmp_path / "one", tmp_path / "several"
    states = ("--state-dir", tmp_path / "states")
    often = ("--checkpoint-every-simulated", "20e-6")
    stop_after_checkpoint(mpirun, 2, several, "run", case, "-o", several, *states, *often)
    # One process begins with the state that two have left in the folder, and then with that of a checkpoint.
    require_done(mpirun.alone("run", case, "-o", one, "-q", *states))
    stop_after_checkpoint(mpirun, 1, several, "run", "--restart", several, *often)
    require_done(mpirun(3, "run", "--restart", several))
    require_same(one, several)


def told_by_info(mpirun, case, *options):
    result = require_done(mpirun.alone("info", case, *options))
    return dict(re.findall(r"^ *(.+?) {2,}(.+)$", result.stdout, re.MULTILINE))


def test_info_is_of_the_run(tmp_path, mpirun):
    case = write_case(tmp_path, "periodic, two bodies", end_s=3e-6)
    alone, shared = told_by_info(mpirun, case), told_by_info(mpirun, case, "--processes", 3)
    assert alone["nodes"].startswith(f"{1001 * (601 + 551)} (1000 on the interface, ")
    assert shared["nodes"] == f"{1001 * (601 + 551)} (1000 on the interface)"
    for key in ("cells", "largest stable step", "step", "steps to the end", "expected regime"):
        assert shared[key] == alone[key], key
    updates = [printed["node updates"].split(" at ")[0] for printed in (alone, shared)]
    assert updates[0] == updates[1]
    require_done(mpirun(3, "run", case, "-o", "out", "-q"))
    run = run_json(tmp_path / "out")
    assert shared["steps to the end"] == str(run["steps"])
    assert shared["exchange every"] == f"{run['processes']['steps_per_exchange']} steps"


def test_the_leader_holds_its_part_alone(tmp_path, mpirun):
    def peak_mb(n, output=""):
        case = write_case(tmp_path, "absorbing edges", end_s=3e-6, output=output)
        measured = [sys.executable, "-c", PEAK_BYTES, mpirun.program]
        programs = [measured, *([mpirun.program] for _ in range(n - 1))]
        run = ("run", case, "-o", f"by-{n}-{len(output)}", "-q")
        return 1e-6 * int(require_done(mpirun(n, *run, programs=programs)).stdout)

    mesh_and_state_mb = 64e-6 * 1001 * 601
    by_four = peak_mb(4)
    assert peak_mb(1) - by_four > mesh_and_state_mb
    # Fields of all nodes, and their mesh, pass through the leader some rows at a time.
    assert peak_mb(4, "snapshot_times_s = [1e-6, 2e-6]") - by_four < 0.5 * mesh_and_state_mb
