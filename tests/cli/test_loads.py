# SPDX-License-Identifier: BSD-3-Clause
"""Loads that a case gives as forces: what is refused, what info and run.json tell of them."""

import re

import numpy as np
import pytest
from common import finished, refusal, require_done, require_same_bytes, run_json, sets, wait_until_or_over

CASE = """\
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 5e-3}
base.kind = "rigid"
friction.law = "velocity_weakening"
loading = {mean_pressure_Pa = 5e6, shear_over_critical = 0.8}
event.kind = "left"
time.end_s = 1e-4
"""
FORCE_N_PER_M = 5e6 * 0.2
RESULTS = ("case.resolved.toml", "interface.h5", "fronts.csv", "static.csv", "energy.csv")


@pytest.fixture
def case(write_case):
    return write_case(CASE)


def test_a_trigger_against_the_shear_is_told(program, case):
    note = "note: the trigger acts to -x, against the shear"
    lightly = "loading.shear_over_critical=0.1"  # less than compression pushes the corner outwards
    for command in (("info",), ("run", "--overwrite", "-o", "out")):
        assert note in require_done(program(*command, case, *sets(lightly))).stdout
        assert note not in require_done(program(*command, case, *sets(lightly, "event.kind=right"))).stdout


def force(folder, column):
    """Sum of a traction of static.csv over the interface, whose outer nodes have half an element."""
    table = np.genfromtxt(folder / "static.csv", delimiter=",", names=True, comments="#")
    return np.trapezoid(table[column], table["x_m"])


@pytest.mark.parametrize(
    "changes, message",
    [
        (("loading.tilt_left_m=1e-4",), "loading.tilt_left_m applies only with"),
        (("loading.critical_margin=0.1",), "loading.critical_margin applies only with"),
        (("loading.mean_pressure_Pa=0",), "loading.mean_pressure_Pa is 0 Pa; it must be greater than 0 Pa"),
        (("loading.shear_over_critical=1.5",), "loading.shear_over_critical is 1.5; it must be greater than"),
        (("loading.normal_force_N_per_m=-3",), "loading.normal_force_N_per_m is -3 N/m; it must be greater"),
        (("loading.shear_force_N_per_m=nan",), "loading.shear_force_N_per_m is nan N/m; it must be a finite"),
        (
            ("loading.normal_force_N_per_m=1e6", "loading.mean_pressure_Pa=1e6"),
            "mean_pressure_Pa applies only",
        ),
        (
            ("loading.method=ramp", "loading.shear_over_critical=0.5"),
            "loading.shear_over_critical applies only with loading.method = direct",
        ),
    ],
)
def test_loads_that_do_not_go_together(program, case, changes, message):
    for command in ("validate", "info"):
        assert message in refusal(program(command, case, *sets(*changes)))


def test_a_shear_beyond_the_critical_one(program, case, tmp_path):
    for command in (["info", case], ["run", case, "-o", "out"]):
        line = refusal(program(*command, *sets("loading.shear_force_N_per_m=1e8")))
        assert "loading.shear_force_N_per_m is 100000000 N/m, beyond the critical one" in line
    assert not (tmp_path / "out").exists()


def test_info_and_results_tell_the_same(program, case, tmp_path):
    printed = require_done(program("info", case)).stdout
    require_done(program("run", case, "-o", "out", "-q"))
    loads = run_json(tmp_path / "out")["statics"]["loads"]
    assert loads["normal_force_N_per_m"] == pytest.approx(FORCE_N_PER_M, rel=1e-9)
    assert loads["mean_pressure_Pa"] == pytest.approx(5e6, rel=1e-9)
    assert loads["shear_force_N_per_m"] == pytest.approx(force(tmp_path / "out", "t_s_Pa"), rel=1e-6)
    critical = loads["critical_shear_force_N_per_m"]
    assert loads["shear_force_N_per_m"] == pytest.approx(0.8 * critical, rel=1e-9)
    for name, keys in (
        ("normal force", ("normal_force_N_per_m", "mean_pressure_Pa")),
        ("  upper edge pressed down", ("tilt_left_m", "tilt_right_m")),
        ("shear force", ("shear_force_N_per_m", None, "critical_shear_force_N_per_m")),
        ("  upper edge then moved to \\+x", ("shear_m", "critical_shear_m")),
    ):
        line = re.search(rf"^{name} +(.*)$", printed, re.MULTILINE)[1]
        numbers = re.findall(r"[0-9][0-9.e+-]*", line)
        assert numbers == [f"{loads[key]:.6g}" if key else "0.8" for key in keys], name


def test_cases_without_forces_tell_nothing_of_them(program, coarse, tmp_path):
    assert "normal force" not in require_done(program("info", coarse)).stdout
    require_done(program("run", coarse, "-o", "out", "-q"))
    assert "loads" not in run_json(tmp_path / "out")["statics"]
    assert "mean_pressure" not in (tmp_path / "out/case.resolved.toml").read_text()


def test_an_override_takes_the_place_of_the_displacements(program, write_case):
    coarse = write_case("[plate]\nelement_size_m = 5e-3\n")
    result = require_done(program("validate", coarse, *sets("loading.mean_pressure_Pa=5e6")))
    assert "not apply" not in result.stdout
    by_displacement = coarse.read_text() + "[loading]\ntilt_left_m = 1e-4\ntilt_right_m = 1e-4\n"
    coarse.write_text(by_displacement)
    result = require_done(program("validate", coarse, *sets("loading.mean_pressure_Pa=5e6")))
    assert "loading.tilt_left_m, loading.tilt_right_m of the case file do not apply" in result.stdout


def test_the_resolved_case_runs_again_and_a_stopped_run_goes_on(program, case, tmp_path):
    slow = sets("plate.element_size_m=1e-3", "time.quiet_s=inf", "output.history_interval_s=1e-5")
    require_done(program("run", case, "-o", "whole", "-q", *slow))
    require_done(program("run", tmp_path / "whole/case.resolved.toml", "-o", "again", "-q"))
    require_same_bytes(tmp_path / "again", tmp_path / "whole", *RESULTS)
    process = program.start("run", case, "-o", "out", "-q", *slow, "--checkpoint-every-simulated", "1e-5")
    wait_until_or_over(lambda: any((tmp_path / "out/unfinished/state").glob("checkpoint-*.bin")), process)
    process.kill()
    finished(process)
    require_done(program("run", "--restart", "out", "-q"))
    require_same_bytes(tmp_path / "out", tmp_path / "whole", *RESULTS)
    loads = [run_json(tmp_path / name)["statics"]["loads"] for name in ("whole", "again", "out")]
    assert loads[0] == loads[1] == loads[2]


def test_info_of_forces_is_of_the_tractions_that_they_give(program, case, tmp_path):
    law = sets("friction.law=slip_weakening", "friction.d_c_m=1e-6", "friction.mu_s=1.3")
    told = re.search(r"strength excess S +\S+, (\S+), ", require_done(program("info", case, *law)).stdout)
    require_done(program("run", case, "-q", "-o", "out", *law))
    of_run = run_json(tmp_path / "out")["rupture"]["strength_excess_S"]["median"]
    assert told[1] == f"{of_run:.3g}"


def test_the_upper_edge_moves_during_the_event_unless_it_is_held(program, case, tmp_path):
    held = sets("loading.shear_speed_m_per_s=0")
    for settings, moves in (((), True), (held, False)):
        info = require_done(program("info", case, *settings)).stdout
        assert bool(re.search(r"upper edge during the event +moves to \+x at 1\.58 mm/s", info)) == moves
        run = require_done(program("run", case, "-o", f"{moves}", *settings)).stdout
        assert ("the upper edge moves to +x at 1.58 mm/s during the event" in run) == moves
        table = np.genfromtxt(tmp_path / f"{moves}/energy.csv", delimiter=",", names=True, comments="#")
        assert bool(table["top_work_J_per_m"][-1]) == moves


@pytest.mark.parametrize("of_motion", ["loading.method=ramp", "event.kind=spontaneous"])
def test_an_edge_that_is_held_brings_nothing_to_slip(program, coarse, of_motion):
    line = refusal(program("validate", coarse, *sets("loading.shear_speed_m_per_s=0", of_motion)))
    assert "loading.shear_speed_m_per_s is 0; that holds the top edge still" in line


def test_a_place_inside_beyond_its_strength_is_told(program, case):
    """Slip that spreads from the edge of a flat block brings a place inside beyond mu_s first."""
    settings = sets("plate.element_size_m=1e-3", "event.kind=none", "loading.shear_over_critical=0.99")
    info = require_done(program("info", case, *settings)).stdout
    assert re.search(r"note: t is beyond mu_s p at \d+ of \d+ nodes inside: they slip at once", info)
