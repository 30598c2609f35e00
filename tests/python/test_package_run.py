# SPDX-License-Identifier: BSD-3-Clause
"""Cases run from Python: the program's results, errors and checkpoints."""

from __future__ import annotations

import _thread
import gc
import re
import signal
import sys
import threading
import tomllib
from pathlib import Path

import numpy as np
import pytest
import slipfront
from common import (
    ROOT,
    WITH_PACKAGE,
    finished,
    refusal,
    require_done,
    require_same_bytes,
    sets,
    start,
    wait_until,
)
from package_cases import CASE, program, refused, write_case
from slipfront.running import toml_text
from slipfront.sweep.definition import flattened as values
from synthetic import interrupt

# What does not depend on when and where a run was done.
SAME_FILES = (
    *("case.resolved.toml", "static.csv", "fronts.csv", "fracture.csv", "energy.csv"),
    *("interface.h5", "fields.vtkhdf"),
)
# Long enough to be interrupted.
LONG = CASE.replace("5e-3", "2e-3") + "time = {end_s = 1.0, quiet_s = inf}\n"


def test_a_run_has_the_bytes_of_the_programs(tmp_path):
    case = write_case(tmp_path)
    require_done(program("run", case, "-q", "-o", "theirs", *sets("friction.mu_k=0.8"), cwd=tmp_path))
    run = slipfront.run(case, friction={"mu_k": 0.8}, output=tmp_path / "ours")
    require_same_bytes(tmp_path / "ours", tmp_path / "theirs", *SAME_FILES)
    assert run.status == "complete"
    assert run.case["friction"]["mu_k"] == 0.8


TIMES_S = [20e-6, 60e-6]


@pytest.mark.parametrize(
    "given",
    [
        lambda case: (case, {"friction.mu_k": 0.75, "friction": {"mu_s": 1.2}}),
        lambda case: (
            case.read_text(),
            {
                "friction.mu_k": np.float32(0.75),
                "friction.mu_s": 1.2,
                "output.snapshot_times_s": np.array(TIMES_S),
            },
        ),
        lambda case: (tomllib.loads(case.read_text()), {"friction": {"mu_k": 0.75, "mu_s": 1.2}}),
    ],
    ids=["path", "text", "dictionary"],
)
def test_a_case_may_be_given_as(tmp_path, given):
    case, changes = given(write_case(tmp_path))
    run = slipfront.run(case, changes, **{"time.end_s": 30e-6})
    assert (run.case["friction"]["mu_s"], run.case["friction"]["mu_k"]) == (1.2, 0.75)
    assert run.case["event"]["kind"] == "left"
    assert run.case["output"]["snapshot_times_s"] == TIMES_S
    assert run.case["time"]["end_s"] == 30e-6


def test_the_resolved_case_runs_again(tmp_path):
    first = slipfront.run(write_case(tmp_path), output=tmp_path / "first")
    slipfront.run(first.case, output=tmp_path / "second")
    require_same_bytes(tmp_path / "first", tmp_path / "second", *SAME_FILES)


@pytest.mark.parametrize(
    "key, value",
    [("friction.mu_j", 0.8), ("friction.mu_k", 900), ("friction.law", "glue"), ("plate.width_m", True)],
)
def test_errors_are_those_of_the_program(tmp_path, key, value):
    case = write_case(tmp_path)
    theirs = refusal(program("run", case, "-o", "out", *sets(f"{key}={toml_text(value)}"), cwd=tmp_path))
    ours = refused(lambda: slipfront.run(case, {key: value}, output=tmp_path / "ours"))
    assert ours == theirs.replace(f"--set {key}=", f"{key} = ")
    assert not (tmp_path / "ours").exists()


def test_errors_in_files_and_folders(tmp_path):
    case = write_case(tmp_path, "[plate]\nwidht_m = 0.2\n")
    theirs = refusal(program("run", case, "-o", "out", cwd=tmp_path))
    assert refused(lambda: slipfront.run(case)) == theirs
    by_text = "case:2: unknown key plate.widht_m; did you mean"
    assert refused(lambda: slipfront.run(case.read_text())).startswith(by_text)
    assert refused(lambda: slipfront.run({})).startswith("case: sets no key")
    dotted = "keys of [output] dotted"
    assert dotted in refused(lambda: slipfront.run(CASE, output={"history_interval_s": 1e-6}))


def test_results_are_not_overwritten_unless_asked(tmp_path):
    case, out = write_case(tmp_path), tmp_path / "out"
    slipfront.run(case, output=out)
    theirs = refusal(program("run", case, "-o", out, cwd=tmp_path))
    assert refused(lambda: slipfront.run(case, output=out)) == theirs.replace("--overwrite", "overwrite=True")
    slipfront.run(case, output=out, overwrite=True)


def test_a_folder_in_use_is_refused(tmp_path):
    case = write_case(tmp_path)
    errors = []

    def again(part, step, total):
        if not errors:
            errors.append(refused(lambda: slipfront.run(case, output=tmp_path / "out", overwrite=True)))

    slipfront.run(case, output=tmp_path / "out", progress=again)
    assert "in use" in errors[0]
    assert slipfront.open(tmp_path / "out").status == "complete"


def test_blow_up(tmp_path):
    case = write_case(tmp_path)
    unstable = sets("time.allow_unstable=true", "time.step_factor=1.4")
    theirs = program("run", case, "-q", "-o", tmp_path / "theirs", *unstable, cwd=tmp_path)
    assert theirs.returncode == 3
    with pytest.raises(slipfront.BlowUpError) as error:
        changes = {"time.allow_unstable": True, "time.step_factor": 1.4}
        slipfront.run(case, changes, output=tmp_path / "ours")
    assert f"slipfront: {error.value}\n".replace("/ours/", "/theirs/") == theirs.stderr
    run = slipfront.open(tmp_path / "ours")
    assert run.status == "blew_up"
    assert np.isfinite(run.energies.kinetic_J_per_m).all()


def test_progress_is_told_and_its_error_ends_the_run(tmp_path):
    calls = []
    slipfront.run(write_case(tmp_path), progress=lambda *call: calls.append(call))
    part, step, total = calls[-1]
    assert part == "event"
    assert 0 < step <= total
    assert all(a[1] <= b[1] for a, b in zip(calls, calls[1:], strict=False))

    def fail(part, step, total):
        raise ZeroDivisionError("of the caller")

    with pytest.raises(ZeroDivisionError, match="of the caller"):
        slipfront.run(write_case(tmp_path), progress=fail)


def test_observers_are_shown_the_interface(tmp_path):
    case, seen, kept = write_case(tmp_path), [], []

    def look(state):
        seen.append((state.step, state.time_s))
        kept.append(state.slip_m)
        assert repr(state).startswith(f"<interface at step {state.step}, t = ")
        for field in (state.x_m, state.slip_m, state.slip_rate_m_per_s, state.t_Pa, state.p_Pa):
            assert len(field) == len(state.x_m)
            assert not field.flags.owndata  # no copy
            with pytest.raises(ValueError, match="read-only"):
                field[0] = 0

    run = slipfront.run(
        case, {"output.history_interval_s": 2e-6}, output=tmp_path / "out", observers=[(2e-6, look)]
    )
    assert np.array_equal([time_s for _, time_s in seen], run.history.time_s)
    assert np.array_equal(kept, run.history.slip_m)
    plain = slipfront.run(case, {"output.history_interval_s": 2e-6}, output=tmp_path / "plain")
    require_same_bytes(tmp_path / "out", tmp_path / "plain", *SAME_FILES)
    assert plain.info["end"] == run.info["end"]


def test_an_observer_ends_the_event(tmp_path):
    run = slipfront.run(
        write_case(tmp_path), observers=[(0, lambda state: "enough" if state.step == 7 else None)]
    )
    assert run.status == "complete"
    assert run.info["end"] == "observer"
    assert run.info["steps"] == 8
    assert run.info["end_reason"].endswith(": enough")


def test_an_error_of_an_observer_keeps_a_checkpoint(tmp_path):
    case, shown = write_case(tmp_path), []

    def fail(state):
        shown.append(state.time_s)
        if len(shown) == 5:
            raise ZeroDivisionError("of the caller")

    with pytest.raises(ZeroDivisionError, match="of the caller"):
        slipfront.run(case, output=tmp_path / "out", observers=[(2e-6, fail)])
    assert slipfront.open(tmp_path / "out").status == "interrupted"
    run = slipfront.resume(tmp_path / "out", observers=[(2e-6, fail)])
    assert run.info["sessions"] == 2
    assert all(a < b for a, b in zip(shown, shown[1:], strict=False))
    slipfront.run(case, output=tmp_path / "plain")
    require_same_bytes(tmp_path / "out", tmp_path / "plain", *SAME_FILES)


def test_the_state_of_a_law_is_in_the_history(tmp_path):
    """At the time of the tractions, which it makes with the mean of the slip rates before and after."""
    a, V0 = 0.01, 1e-6
    case = {
        "plate": {"width_m": 0.1, "height_m": 0.02, "element_size_m": 1e-3}
        | {"corner": "none", "sides": "absorbing", "top": "absorbing"},
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": 2.65e6, "p_Pa": 5e6},
        "friction": {"law": "rate_and_state_aging", "a": a, "V0_m_per_s": V0},
        "event": {"kind": "nucleation"},
        "nucleation": {"form": "overstress", "overstress_Pa": 1.1e6, "half_length_m": 10e-3},
        "time": {"end_s": 20e-6, "interface_substeps": 1},
        "output": {"history_interval_s": 1e-9},  # each step
    }
    shown = []

    def look(state):
        shown.append(state.law_states[0])
        if len(shown) == 10:
            raise ZeroDivisionError("of the caller")

    run = slipfront.run(case, output=tmp_path / "out")
    history = run.history.load()
    assert history.psi.attrs == {"units": "1", "long_name": "state of the surfaces"}
    rate = np.abs(history.slip_rate_m_per_s.values)
    slides = np.minimum(rate[1:], rate[:-1]) > 0.05  # where it is the mean
    mean = 0.5 * (rate[1:] + rate[:-1])
    t_Pa = history.p_Pa[1:] * a * np.arcsinh(mean / (2 * V0) * np.exp(history.psi[1:] / a))
    assert slides.sum() > 500
    assert np.allclose(t_Pa.values[slides], history.t_Pa.values[1:][slides], rtol=1e-13, atol=0)

    with pytest.raises(ZeroDivisionError):
        slipfront.run(case, output=tmp_path / "again", observers=[(0, look)])
    assert np.array_equal(shown, history.psi[:10])
    resumed = slipfront.resume(tmp_path / "again", threads=2)
    assert resumed.info["sessions"] == 2
    require_same_bytes(
        tmp_path / "out", tmp_path / "again", "interface.h5", "fronts.csv", "fracture.csv", "energy.csv"
    )

    (tmp_path / "again/checksums.sha256").unlink()
    interrupt(tmp_path / "again", "running")  # of whose history there are the rows alone
    growing = slipfront.open(tmp_path / "again")
    assert growing.status == "running"
    assert growing.history.equals(history)


def test_observers_that_are_none(tmp_path):
    case = write_case(tmp_path)
    for observers, text in (
        ([print], "observers has <built-in function print>"),
        ([(1e-6, 2)], "observers has (1e-06, 2); give pairs"),
        ([(-1, print)], "the interval of an observer is -1"),
        ([(0, lambda state: 3)], "an observer returned 3; it returns None, or why"),
        ([(0, lambda state: "a\ud800")], "an observer returned 'a\\ud800'; it returns None, or why"),
        ([(0, lambda state: "")], "an observer returned ''; it returns None, or why"),
    ):
        assert text in refused(lambda observers=observers: slipfront.run(case, observers=observers))


def test_other_threads_go_on_meanwhile(tmp_path):
    """Another thread interrupts a long run from within; with Python's lock held it could not."""

    def interrupt():
        wait_until(lambda: (tmp_path / "out/unfinished/energy.csv").exists() or ended.is_set())
        if not ended.is_set():
            _thread.interrupt_main()

    ended = threading.Event()
    thread = threading.Thread(target=interrupt)
    thread.start()
    try:
        with pytest.raises(KeyboardInterrupt, match="interrupted at t = "):
            slipfront.run(write_case(tmp_path, LONG), output=tmp_path / "out", progress=False)
    finally:
        ended.set()
        thread.join()


INTERRUPTED = """
import sys, slipfront
try:
    show = lambda *told: print(*told, flush=True)
    slipfront.run(sys.argv[1], output=sys.argv[2], threads=int(sys.argv[3]), progress=show)
except KeyboardInterrupt as error:
    print("KeyboardInterrupt:", error)
"""


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_keeps_a_checkpoint_and_resume_goes_on(tmp_path, threads):
    case = write_case(tmp_path, LONG)
    process = start(sys.executable, "-c", INTERRUPTED, case, tmp_path / "out", threads, env=WITH_PACKAGE)
    while not process.stdout.readline().startswith("event"):
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    last = require_done(finished(process)).stdout.splitlines()[-1]
    assert last.startswith("KeyboardInterrupt: interrupted at t = ")
    assert last.endswith(f'slipfront.resume("{tmp_path / "out"}") continues the run')

    so_far = slipfront.open(tmp_path / "out")
    assert so_far.status == "interrupted"
    assert 0 < float(so_far.history.time_s[-1]) < 1
    slip_m = so_far.history.slip_m.values

    # The rest of it would take long: what has gone on is interrupted again, later.
    def stop(part, step, total):
        if step > so_far.info["steps"]:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="interrupted at t = "):
        slipfront.resume(tmp_path / "out", progress=stop)
    later = slipfront.open(tmp_path / "out")
    assert later.info["sessions"] == 2
    assert later.info["steps"] > so_far.info["steps"]
    assert np.array_equal(later.history.slip_m[: len(slip_m)], slip_m)
    with pytest.raises(slipfront.DataError, match="was changed since the run was opened; open it again"):
        _ = so_far.history.p_Pa.values


def test_resume_opens_what_is_complete(tmp_path):
    slipfront.run(write_case(tmp_path), output=tmp_path / "out")
    assert slipfront.resume(tmp_path / "out").status == "complete"
    with pytest.raises(slipfront.CaseError, match="no unfinished run to continue"):
        slipfront.resume(tmp_path / "nothing")


def test_without_a_folder_results_go_with_what_was_read(tmp_path):
    run = slipfront.run(write_case(tmp_path))
    folder, history = run.folder, run.history
    del run
    gc.collect()
    assert folder.is_dir()
    assert float(history.slip_m.max()) > 0
    del history
    gc.collect()
    assert not folder.exists()


# --- Every key

BODIES = """
event.kind = "left"
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 5e-3, corner = "none"}
loading = {method = "prestress", shear_speed_m_per_s = 0.0}
time.end_s = 1e-5
[base]
kind = "body"
height_m = 0.08
coarsenings = 1
fine_height_m = 0.03
sides = "free"
bottom = "free"
youngs_modulus_Pa = 5e9
poissons_ratio = 0.3
density_kg_per_m3 = 2000.0
stiffness_damping_s = 2e-7
"""
UNIFORM = "prestress = {t_Pa = 5e5, p_Pa = 2e6}" + BODIES
NUCLEATED = UNIFORM.replace('event.kind = "left"', 'event.kind = "nucleation"')
# Between them they set every key, most to something else than its default.
CASES = {
    "ramp": """
title = 'true, "in quotes" \\ and ü'
contact.algorithm = "predictor_corrector"
friction = {law = "velocity_weakening", mu_s = 1.2, mu_k = 0.7, alpha_m2_per_s2 = 0.2}
[plate]
width_m = 0.21
height_m = 0.09
element_size_m = 3e-3
coarsenings = 1
fine_height_m = 0.012
corner = "relief"
relief_length_m = 6e-3
relief_height_m = 1e-4
relief_depth_m = 0.01
sides = "free"
top = "loaded"
[material]
youngs_modulus_Pa = 3e9
poissons_ratio = 0.35
density_kg_per_m3 = 1180.0
plane = "strain"
stiffness_damping_s = 2e-7
[loading]
tilt_left_m = 3e-4
tilt_right_m = 4e-5
top_during_tilt = "free"
method = "direct"
solver = "direct"
shear_speed_m_per_s = 2e-6
edge_margin_m = 0.011
critical_margin = 2e-3
[event]
kind = "right"
trigger_form = "raised"
trigger_zone_m = 0.02
trigger_over_strength = 2.0
trigger_ramp_s = 4e-6
trigger_duration_s = 2e-5
[time]
step_factor = 0.8
allow_unstable = true
precision = "double"
interface_rows = 3
interface_substeps = 4
local_steps = false
end_s = 3e-5
quiet_s = inf
[fronts]
l_star_m = 3e-3
speed_interval = "approach"
arrest_time_s = 1e-5
min_length_m = 4e-3
crack_share = 0.6
pulse_share = 0.1
trigger_margin_m = 5e-3
[output]
history_interval_s = 1e-6
snapshot_times_s = [1e-5, 2e-5]
snapshot_interval_s = 1.5e-5
snapshot_stress = false
energy_interval_s = 1e-5
moment_rate = true
[probes]
x_m = [0.05, 0.1, 0.15, 0.16]
y_m = [0.01, 0.01, 0.02, 0.02]
interval_s = 1e-6
names = ["SG1", "true", "1e-3", "a, 'b' [c]"]
""",
    "pressure": """
event.kind = "right"
plate = {element_size_m = 5e-3}
time = {end_s = 1e-5, stepper = "plain"}
loading = {mean_pressure_Pa = 5e6, tilt_difference_m = 2e-4, shear_over_critical = 0.8}
""",
    "force": """
event = {kind = "left", trigger_over_missing = 3.0}
plate = {element_size_m = 5e-3, width_m = 0.2, height_m = 0.1, corner = "fillet", fillet_radius_m = 0.02}
base.kind = "rigid"
friction.law = "velocity_weakening"
time.end_s = 1e-5
loading = {normal_force_N_per_m = 1e6, shear_force_N_per_m = 5e5}
""",
    "bodies": NUCLEATED
    + """
[friction]
law = "slip_weakening"
mu_s = 0.7
mu_k = 0.2
d_c_m = 5e-6
regularisation = "pressure"
relaxation_length_m = 1e-4
relaxation_slip_rate_m_per_s = 0.01
relaxation_time_s = 1e-6
random_key = "mu_s"
random_share = 0.02
random_correlation_length_m = 0.02
random_seed = 7
[nucleation]
form = "overstress"
x_m = 0.11
half_length_m = 0.01
taper_m = 5e-3
overstress_Pa = 2e6
""",
    "tables": """
prestress = {file = "tractions.csv"}
friction = {law = "coulomb", mu = 0.5, file = "friction.csv", between_rows = "stepwise"}
"""
    + BODIES,
    "healing": 'friction = {law = "slip_weakening_healing", mu_s = 0.7, mu_k = 0.2, d_c_m = 5e-6}\n'
    + UNIFORM,
    "slip_table": """
friction = {law = "slip_table", mu_factor = 0.9, table_slip_m = [0.0, 1e-6, 1e-5], table_mu = [0.7, 0.4, 0.3]}
"""
    + UNIFORM,
    "slip_rate_table": UNIFORM
    + """
[friction]
law = "slip_rate_table"
mu_factor = 0.9
table_slip_rate_m_per_s = [0.0, 0.2, 1.0]
table_mu = [0.7, 0.4, 0.3]
""",
    "forced": NUCLEATED
    + """
[friction]
law = "slip_weakening_exponential"
mu_s = 0.7
mu_k = 0.2
d_c_m = 5e-6
cohesion_Pa = 1e5
regularisation = "initial_pressure"
[nucleation]
form = "forced"
profile = "smooth"
front_speed_m_per_s = 500.0
weakening_time_s = 1e-6
""",
    "state": """
event.trigger_ramp = "smooth"
friction = {law = "rate_and_state_aging", theta_i_s = 0.1}
"""
    + UNIFORM.replace("t_Pa = 5e5", "t_rate_Pa_per_s = 1e9, p_rate_Pa_per_s = 1e9"),
    "strong": UNIFORM
    + """
[friction]
law = "rate_and_state_strong"
a = 0.01
b = 0.014
d_c_m = 1e-6
f0 = 0.7
V0_m_per_s = 1e-5
V_i_m_per_s = 1e-8
f_w = 0.1
V_w_m_per_s = 0.2
tip_slip_rate_m_per_s = 0.05
""",
    "two states": UNIFORM
    + """
[friction]
law = "rate_and_state_aging_two"
b1 = 0.01
b2 = 0.005
d_c1_m = 1e-6
d_c2_m = 1e-5
tip_slip_rate_m_per_s = 0.05
""",
    "sequence": """
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 4e-3, corner = "relief"}
base.kind = "rigid"
friction.law = "velocity_weakening"
event.kind = "spontaneous"
[sequence]
max_events = 3
end_s = 500.0
to_global_sliding = true
healing_per_e_fold = 0.01
healing_time_s = 2.0
[loading]
pusher_from_m = 8e-3
pusher_to_m = 16e-3
shear_stiffness_Pa_per_m = 1.25e11
normal_stiffness_Pa_per_m = 0.0
pressures_x_m = [0.05, 0.15]
pressures_Pa = [4e6, 6e6]
mass_kg_per_m2 = 20.0
""",
    "unloaded edge": UNIFORM.replace(
        'event.kind = "left"', 'event = {kind = "left", trigger_form = "unloaded", trigger_unloading = 0.5}'
    ),
    "unloaded patch": NUCLEATED
    + """
[nucleation]
form = "unloaded"
unloading_Pa = 5e5
""",
    "slow slip": """
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 4e-3}
base.kind = "rigid"
loading.mean_pressure_Pa = 5e6
friction = {law = "rate_and_state_aging", a = 0.01, b = 0.015, d_c_m = 1e-6, V_i_m_per_s = 1e-6}
event.kind = "spontaneous"
[sequence]
max_events = 2
end_s = 1.0
inertia_slip_rate_m_per_s = 5e-3
times_s = [0.5, 2.0]
shears_m = [0.0, 1e-6]
""",
}


@pytest.fixture
def tables(tmp_path, monkeypatch):
    """The tables of the cases, in the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tractions.csv").write_text("x_m,t_Pa,p_Pa\n0,1e5,2e6\n0.2,2e5,2e6\n")
    (tmp_path / "friction.csv").write_text("x_m,mu\n0,0.5\n0.1,0.6\n0.2,0.6\n")


@pytest.mark.parametrize("name", CASES)
def test_a_case_comes_back_from_its_run_and_runs_again(tables, name):
    given = values(tomllib.loads(CASES[name]))
    first = slipfront.run(given)
    second = slipfront.run(first.case)
    resolved, again = values(first.case), values(second.case)
    for key in resolved:
        if key.endswith(".file") and given.get(key):  # each run has its copy
            texts = [Path(of[key]).read_text() for of in (resolved, again, given)]
            assert texts[0] == texts[1] == texts[2]
        else:
            assert again[key] == resolved[key] == given.get(key, resolved[key]), key
    assert given.keys() <= resolved.keys()


def test_the_cases_set_every_key():
    rows = re.findall(r"^(?:## \[(\w+)\]|\| `(\w+)` \|)", program("keys", cwd=ROOT).stdout, re.MULTILINE)
    table, every = "", set()
    for name, key in rows:
        table = name or table
        if key:
            every.add(f"{table}.{key}" if table else key)
    assert len(every) > 80
    assert every - {key for case in CASES.values() for key in values(tomllib.loads(case))} == set()
