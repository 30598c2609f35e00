# SPDX-License-Identifier: BSD-3-Clause
"""Sequences that tip, never end or are hardly meant: what is told, and that results are finite."""

import json
import os
import shutil
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest
from common import finished, refusal, require_done, rows_of, run_json, sets, wait_until_or_over
from hostile.trials import TRIES

CASES = Path(__file__).parent / "cases" / "sequences"
# Slow slip and an event in a fraction of a second.
STICK_SLIP = (CASES / "stick_slip.toml", *sets("plate.element_size_m=0.02", "sequence.max_events=2"))
# Two events of an instant.
STICKING = """\
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 10e-3}
base.kind = "rigid"
loading = {tilt_left_m = 0.37e-3, tilt_right_m = 0.037e-3}
friction.law = "velocity_weakening"
sequence.max_events = 2
"""


def require_finite_numbers(folder):
    """Of all tables and histories below a folder, but for fields that are empty."""
    for file in folder.rglob("*.csv"):
        for row in rows_of(file):
            numbers = [value for name, value in row.items() if value and not name.endswith(("phase", "kind"))]
            assert np.isfinite([float(value) for value in numbers]).all(), file
    for file in folder.rglob("interface.h5"):
        if file.stat().st_size > 8 and h5py.is_hdf5(file):
            with h5py.File(file) as data:
                assert np.isfinite(data["rows"]).all(), file


@pytest.mark.parametrize(
    "name, changes",
    [("nan_rc0_min", ["sequence.inertia_slip_rate_m_per_s=6e-5"]), ("tip_rs", []), ("tip_forever", [])],
)
def test_a_plate_that_tips_ends_its_sequence(program, tmp_path, name, changes):
    line = refusal(program("run", CASES / f"{name}.toml", "-o", "out", "-q", *sets(*changes)))
    assert "s after normal loading, at a shear of" in line and "the plate tips" in line
    require_finite_numbers(tmp_path)


@pytest.mark.parametrize(
    "name, told",
    [
        ("nan_rc0_min", "inertia_slip_rate_m_per_s is 7.233e-06 m/s, not above the speed of the load"),
        ("slow_slip_step_collapse", "the coefficient of steady sliding, by friction.f0 and friction.b, is -"),
        ("slow_slip_endless_untold", "friction does not weaken with the slip rate at any node"),
        ("single_precision_sequence", "time.precision = single"),
    ],
)
@pytest.mark.parametrize("command", ["validate", "info", "run"])
def test_what_comes_to_no_sequence_is_refused_before_it_runs(program, tmp_path, command, name, told):
    output = ["-o", "out"] if command == "run" else []
    assert told in refusal(program(command, CASES / f"{name}.toml", *output))
    assert not (tmp_path / "out").exists()


def test_steady_friction_along_x_has_to_be_above_0(program, write_case, tmp_path):
    (tmp_path / "f0.csv").write_text("x_m,f0\n0,0.6\n0.2,0.05\n0.4,0.6\n")
    case = (CASES / "stick_slip.toml").read_text().replace("[event]", 'file = "f0.csv"\n[event]')
    line = refusal(program("validate", write_case(case)))
    assert "the coefficient of steady sliding" in line and "must be above 0" in line


def test_a_rate_of_events_beyond_that_of_fronts_is_refused(program):
    changes = sets("sequence.inertia_slip_rate_m_per_s=10")
    line = refusal(program("validate", *STICK_SLIP, *changes))
    assert "beyond the rate of a front's tip" in line and "choose a smaller one" in line


STEADY = sets(
    *("friction.law=rate_and_state_aging", "friction.a=0.5", "friction.b=0.505", "friction.d_c_m=1e-3"),
    *("friction.V_i_m_per_s=1e-6", "loading.mean_pressure_Pa=1e8"),
)


def test_a_load_without_end_that_brings_steady_sliding_ends(program, write_case):
    """The block is far stiffer than (b - a) p/d_c."""
    line = refusal(program("run", write_case(STICKING), *STEADY, "-o", "out", "-q"))
    assert "the interface slips steadily" in line and "no event comes; give sequence.end_s" in line


def test_an_event_that_dead_loads_drive_on_is_told_from_one_that_needs_time(program, write_case):
    dead = sets(
        "loading.shear_stiffness_Pa_per_m=5e3", "loading.shear_speed_m_per_s=1.6e-6", "time.end_s=2e-3"
    )
    line = refusal(program("run", write_case(STICKING), *dead, "-o", "out", "-q"))
    assert "event 1 has not come to rest" in line and "slip does not slow down: the loads drive it on" in line
    early = sets("time.end_s=1.5e-4", "time.quiet_s=1.2e-4")
    line = refusal(program("run", write_case(STICKING), *early, "-o", "early", "-q"))
    assert "event 1 has not come to rest" in line and "choose a later time.end_s, a larger" in line


@pytest.mark.parametrize(
    "changes, told",
    [
        (["friction.V_i_m_per_s=1"], "no slow slip comes before an event; choose a smaller one, or press"),
        (["loading.shear_speed_m_per_s=47"], "the load moves at"),
        (["friction.theta_i_s=1e-15"], "normal loading alone lets the interface slip at"),
        (["sequence.times_s=[1,2]", "sequence.shears_m=[1e5,1e6]"], "it must be slower than c_L"),
    ],
)
def test_first_rates_and_loads_beyond_slow_slip_are_refused(program, changes, told):
    assert told in refusal(program("run", CASES / "granite.toml", *sets(*changes), "-o", "out", "-q"))


def test_a_path_that_ends_within_an_event_is_gone_to_its_end(program, write_case, tmp_path):
    """The events due on the rest of it come at once."""
    path = sets("sequence.times_s=[1e-3,1.1e-3]", "sequence.shears_m=[2.4e-4,15e-4]")
    path += sets("sequence.max_events=20")
    done = require_done(program("run", write_case(STICKING), *path, "-o", "out"))
    assert "no event begins before the loading ends" in done.stdout
    rows = rows_of(tmp_path / "out/loading.csv")
    assert np.all(np.diff([float(row["time_s"]) for row in rows]) >= 0)
    assert float(rows[-1]["shear_m"]) == pytest.approx(15e-4, rel=1e-9)
    assert rows[-1]["phase"] == "loaded" and len(rows_of(tmp_path / "out/events.csv")) > 1
    assert max(float(row["shear_over_normal"]) for row in rows) < 1.3  # mu_s


def test_a_loading_that_ends_within_an_event_ends_with_it(program, write_case, tmp_path):
    case = write_case(STICKING)
    require_done(program("run", case, "-o", "whole", "-q"))
    begins, ends = (float(rows_of(tmp_path / "whole/loading.csv")[k]["time_s"]) for k in (1, 2))
    within = sets(f"sequence.end_s={0.5 * (begins + ends)!r}")
    require_done(program("run", case, *within, "-o", "out", "-q"))
    rows = rows_of(tmp_path / "out/loading.csv")
    assert [row["phase"] for row in rows] == ["tilted", "event_begins", "slip_ends", "at_rest", "loaded"]
    assert rows[-1]["shear_m"] == rows[-2]["shear_m"]
    assert np.all(np.diff([float(row["time_s"]) for row in rows]) >= 0)


def test_a_case_that_was_changed_before_the_first_checkpoint_is_refused(program, write_case, tmp_path):
    case = write_case(STICKING)
    require_done(program("run", case, "-o", "done", "-q"))
    begun = tmp_path / "out/unfinished/state/begun.bin"
    for _ in range(TRIES):  # it may be over before
        shutil.rmtree(tmp_path / "out", ignore_errors=True)
        process = program.start("run", case, "-o", "out", "-q")
        wait_until_or_over(begun.exists, process)
        process.kill()
        finished(process)
        if begun.exists():
            break
    resolved = tmp_path / "out/unfinished/case.resolved.toml"
    for checkpoint in begun.parent.glob("checkpoint-*"):
        checkpoint.unlink()
    text = resolved.read_text()
    resolved.write_text(text.replace("mu_k = 0.6", "mu_k = 0.61"))
    assert "is another case than the one that was begun" in refusal(program("run", "--restart", "out", "-q"))
    resolved.write_text(text)
    require_done(program("run", "--restart", "out", "-q"))
    assert (tmp_path / "out/events.csv").read_bytes() == (tmp_path / "done/events.csv").read_bytes()


@pytest.mark.parametrize("name", ["events", "events/0001", "slow", "slow/0001", "events/0001/unfinished"])
@pytest.mark.parametrize("work", ["unfinished", "publishing"])
def test_links_in_unfinished_work_are_refused(program, tmp_path, work, name):
    """Before anything that they lead to is touched."""
    for folder in (".", "0001", "state", "unfinished/state"):
        (tmp_path / "mine" / folder).mkdir(parents=True, exist_ok=True)
        for file in ("run.json", "interface.h5", "kind", "checksums.sha256", "case.resolved.toml"):
            (tmp_path / "mine" / folder / file).write_text("precious")
    require_done(program("run", *STICK_SLIP, "-o", "done", "-q"))
    unfinished = tmp_path / "out" / work
    (unfinished / "state").mkdir(parents=True)
    (unfinished / "state" / "kind").write_text("run\n")
    for done in ("case.resolved.toml", "checksums.sha256"):
        (unfinished / done).write_bytes((tmp_path / "done" / done).read_bytes())
    (unfinished / name).parent.mkdir(parents=True, exist_ok=True)
    os.symlink(tmp_path / "mine", unfinished / name)
    for arguments in (["--restart", "out"], [*STICK_SLIP, "-o", "out", "--overwrite"]):
        line = refusal(program("run", *arguments, "-q"))
        told = f"out/{work}/{name}: is not a file of slipfront, which needs the name; move it away"
        assert line.endswith(told)
    kept = [path.read_text() for path in (tmp_path / "mine").rglob("*") if path.is_file()]
    assert kept == ["precious"] * 20


def test_rows_of_slow_slip_are_thinned_and_foretold(program, tmp_path):
    case = [CASES / "velocity_steps_disk.toml", *sets("plate.element_size_m=5e-3", "plate.height_m=25e-3")]
    printed = require_done(program("info", *case)).stdout
    forecast = next(line for line in printed.splitlines() if line.startswith("slow slip"))
    assert "to the end of the loading" in forecast
    foretold_GB = float(forecast.split("loading, ")[1].split(" GB")[0])
    require_done(program("run", *case, "-o", "out", "-q"))
    with h5py.File(tmp_path / "out/slow/0001/interface.h5") as data:
        t = data["time_s"][:]
    all_rows = 4096
    assert all_rows < len(t) < 2 * all_rows
    size_GB = (tmp_path / "out/slow/0001/interface.h5").stat().st_size * 1e-9
    assert 0.4 * size_GB < foretold_GB < 3 * size_GB
    assert t[-1] == 420


@pytest.mark.parametrize("name", ["breakdown_negative_healing", "hardening_fracture_csv"])
def test_breakdown_is_empty_where_friction_has_not_fallen(program, tmp_path, name):
    require_done(program("run", CASES / f"{name}.toml", "-o", "out", "-q"))
    rows = rows_of(tmp_path / "out" / "fracture.csv")
    names = ("breakdown_work_J_per_m2", "weakening_distance_m", "weakening_time_s")
    known = [[float(row[name]) for row in rows if row[name]] for name in names]
    assert all((np.array(values) > 0).all() and max(values, default=0) < 1e6 for values in known)
    assert len(known[0]) < len(rows)
    of_all = run_json(tmp_path / "out")["friction_work"]["breakdown_J_per_m"]
    assert of_all is None if name == "hardening_fracture_csv" else of_all > 0


def test_events_count_by_their_longest_patch(program, tmp_path):
    case = [
        CASES / "symmetric_patch_sequence.toml",
        *sets("plate.element_size_m=4e-3", "sequence.max_events=2"),
    ]
    printed = require_done(program("run", *case, "-o", "out")).stdout
    of_case = [line for line in program("validate", *case).stdout.splitlines() if line.startswith("note: ")]
    assert of_case and set(of_case) <= set(printed.splitlines())
    assert "\n1 of them longer than the nucleation length, or global\n" in printed
    first, second = rows_of(tmp_path / "out" / "events.csv")
    # Two patches, at the ends of what the first one has broken.
    assert float(second["longest_patch_m"]) < 0.6 * float(second["length_m"])
    assert float(first["longest_patch_m"]) == float(first["length_m"])
    assert float(first["begin_x_m"]) == pytest.approx(0.2, abs=1e-9)  # the middle


def test_events_of_a_block_that_slips_as_one_count(program, tmp_path):
    """On a soft machine it does though it is shorter than the nucleation length."""
    soft = sets(
        "loading.shear_stiffness_Pa_per_m=5e10", "friction.d_c_m=4e-6", "material.stiffness_damping_s=4e-6"
    )
    result = program("run", *STICK_SLIP, *soft, *sets("time.end_s=0.03"), "-o", "out")
    assert "\n2 of them longer than the nucleation length, or global\n" in require_done(result).stdout
    for event in rows_of(tmp_path / "out" / "events.csv"):
        assert event["is_global"] == "1"
        assert float(event["nucleation_length_m"]) > float(event["longest_patch_m"])


def test_info_and_fracture_take_a_sequence_that_runs(program):
    case = [CASES / "tip_rs.toml", *sets("sequence.end_s=100")]
    for command in ("info", "fracture"):
        printed = require_done(program(command, *case)).stdout
        assert "note: no static state to predict from: " in printed


AGING = (CASES / "stick_slip.toml").read_text()
PUSHED = ["loading.mean_pressure_Pa=5e6", "loading.pusher_from_m=5e-3", "loading.pusher_to_m=0.1"]
FAST = ["sequence.times_s=[1e-6]", "sequence.shears_m=[20e-6]"]


@pytest.mark.parametrize(
    "base, changes, told",
    [
        (STICKING, ["time.quiet_s=1e-6"], "time.quiet_s = 1e-06 s is far below 4 H/c_S"),
        (STICKING, FAST, "the load moves at up to 20 m/s"),
        (STICKING, ["loading.shear_speed_m_per_s=0.16"], "the load moves at up to"),
        (STICKING, ["sequence.times_s=[1e6]", "sequence.shears_m=[0.9]"], "sequence.shears_m up to = 0.9: "),
        (STICKING, ["sequence.healing_per_e_fold=10"], "sequence.healing_per_e_fold = 10: "),
        (STICKING, ["material.poissons_ratio=-0.999"], "material.poissons_ratio = -0.999: "),
        (STICKING, ["plate.element_size_m=5e-3", *PUSHED], "the pusher covers 95 % of the side"),
        (AGING, ["friction.tip_slip_rate_m_per_s=1e-3"], "friction.tip_slip_rate_m_per_s = 0.001: far below"),
        (AGING, ["plate.element_size_m=0.04"], "the outcome and not its digits alone"),
    ],
)
def test_what_is_hardly_meant_is_told(program, write_case, base, changes, told):
    case = write_case(base)
    assert told not in require_done(program("validate", case)).stdout or told.startswith("the outcome")
    assert told in require_done(program("validate", case, *sets(*changes))).stdout


def test_wave_loss_is_right_to_half_a_step(program, tmp_path):
    """It is below 0 in these events, by less than what friction takes in half a step where they begin."""
    changes = sets("sequence.inertia_slip_rate_m_per_s=3.2e-5", "sequence.max_events=2")
    changes += sets("time.precision=double", "time.interface_substeps=1")
    require_done(program("run", CASES / "wave_loss_negative.toml", *changes, "-o", "out", "-q"))
    for number, event in enumerate(rows_of(tmp_path / "out" / "events.csv"), 1):
        folder = tmp_path / f"out/events/{number:04}"
        with h5py.File(folder / "interface.h5") as data:
            element_m = data["x_m"][1] - data["x_m"][0]
            power_W_per_m = (data["slip_rate_m_per_s"][0] * data["t_Pa"][0]).sum() * element_m
        half_step_J_per_m = 0.5 * run_json(folder)["dt_s"] * power_W_per_m
        assert 0 < -float(event["wave_loss_J_per_m"]) < half_step_J_per_m
        assert half_step_J_per_m < 0.03 * float(event["friction_work_J_per_m"])


def test_changes_of_contact_come_in_time(program, tmp_path):
    """Slip is so slow at first that its steps are long; points on the line of the path cut them."""
    case = CASES / "wave_loss_negative.toml"
    changes = sets("sequence.inertia_slip_rate_m_per_s=3.2e-5", "sequence.max_events=2")
    changes += sets("time.precision=double", "time.interface_substeps=1")
    path = tomllib.loads(case.read_text())["sequence"]
    begins_s = []
    for middle_s in ([], [9.0], [33.0, 40.0]):
        times_s = [path["times_s"][0], *middle_s, path["times_s"][1]]
        shears_m = np.interp(times_s, path["times_s"], path["shears_m"]).tolist()
        finer = sets(f"sequence.times_s={times_s}", f"sequence.shears_m={shears_m}")
        require_done(program("run", case, *changes, *finer, "-o", "out", "--overwrite", "-q"))
        begins_s.append(float(rows_of(tmp_path / "out" / "events.csv")[0]["begin_s"]))
    assert begins_s == pytest.approx([begins_s[0]] * 3, rel=3e-4)


def test_energies_of_small_motions_need_double_precision(program, tmp_path):
    case = [CASES / "single_precision_sequence.toml", *sets("sequence.max_events=1", "time.end_s=2e-4")]
    printed = require_done(program("run", *case, "-o", "out")).stdout
    assert "note: time.precision = single leaves" in printed
    double = require_done(program("run", *case, "-o", "double", *sets('time.precision="double"'))).stdout
    assert "time.precision" not in double


def test_results_of_a_sequence_are_finite(program, tmp_path):
    require_done(program("run", *STICK_SLIP, "-o", "out", "-q"))
    require_finite_numbers(tmp_path / "out")
    assert json.loads((tmp_path / "out/sequence.json").read_text())["imbalance_over_largest_energy"] < 1e-9
