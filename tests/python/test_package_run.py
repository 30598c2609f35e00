# SPDX-License-Identifier: BSD-3-Clause
"""Cases run from Python: the program's results, errors and checkpoints."""

from __future__ import annotations

import _thread
import gc
import signal
import subprocess
import sys
import threading
import time
import tomllib

import numpy as np
import pytest
import slipfront
from package_cases import CASE, ROOT, program, write_case
from shared import HANG_S
from slipfront.running import flattened, toml_text

# What does not depend on when and where a run was done.
SAME_FILES = (
    "case.resolved.toml",
    "interface.h5",
    "fronts.csv",
    "energy.csv",
    "static.csv",
    "fields.vtkhdf",
)
# Long enough to be interrupted.
LONG = CASE.replace("5e-3", "2e-3") + "\n[time]\nend_s = 1.0\nquiet_s = inf\n"


def contents(folder):
    return {name: (folder / name).read_bytes() for name in SAME_FILES}


def test_a_run_has_the_bytes_of_the_programs(tmp_path):
    case = write_case(tmp_path)
    assert (
        program("run", case, "-q", "-o", "theirs", "--set", "friction.mu_k=0.8", cwd=tmp_path).returncode == 0
    )
    run = slipfront.run(case, friction={"mu_k": 0.8}, output=tmp_path / "ours")
    assert contents(tmp_path / "ours") == contents(tmp_path / "theirs")
    assert run.status == "complete"
    assert run.case["friction"]["mu_k"] == 0.8


@pytest.mark.parametrize(
    "given",
    [
        lambda case: (case, {"friction.mu_k": 0.8, "friction": {"mu_s": 1.2}}),
        lambda case: (case.read_text(), {"friction.mu_k": np.float64(0.8), "friction.mu_s": 1.2}),
        lambda case: (tomllib.loads(case.read_text()), {"friction": {"mu_k": 0.8, "mu_s": 1.2}}),
    ],
    ids=["path", "text", "dictionary"],
)
def test_a_case_may_be_given_as(tmp_path, given):
    case, changes = given(write_case(tmp_path))
    run = slipfront.run(case, changes, **{"time.end_s": 30e-6})
    assert (run.case["friction"]["mu_s"], run.case["friction"]["mu_k"]) == (1.2, 0.8)
    assert run.case["event"]["kind"] == "left"
    assert run.case["output"]["snapshot_times_s"] == [20e-6, 60e-6]
    assert run.case["time"]["end_s"] == 30e-6


def test_the_resolved_case_runs_again(tmp_path):
    first = slipfront.run(write_case(tmp_path), output=tmp_path / "first")
    slipfront.run(first.case, output=tmp_path / "second")
    assert contents(tmp_path / "first") == contents(tmp_path / "second")


@pytest.mark.parametrize(
    "arguments",
    [
        ["friction.mu_j=0.8"],
        ["friction.mu_k=9"],
        ["friction.law=glue"],
        ["plate.width_m=true"],
    ],
)
def test_errors_are_those_of_the_program(tmp_path, arguments):
    case = write_case(tmp_path)
    pairs = [text.split("=") for text in arguments]
    theirs = program("run", case, "-o", "out", *(f"--set={text}" for text in arguments), cwd=tmp_path)
    assert theirs.returncode == 2
    with pytest.raises(slipfront.CaseError) as error:
        values = {"true": True, "9": 9, "0.8": 0.8}
        slipfront.run(case, {key: values.get(value, value) for key, value in pairs}, output=tmp_path / "ours")
    assert f"{error.value}\n" == theirs.stderr
    assert isinstance(error.value, ValueError)
    assert not (tmp_path / "ours").exists()


def test_errors_in_files_and_folders(tmp_path):
    case = write_case(tmp_path, "[plate]\nwidht_m = 0.2\n")
    theirs = program("run", case, "-o", "out", cwd=tmp_path)
    with pytest.raises(slipfront.CaseError) as error:
        slipfront.run(case)
    assert f"{error.value}\n" == theirs.stderr
    with pytest.raises(slipfront.CaseError, match=r"^case:2: unknown key plate.widht_m; did you mean"):
        slipfront.run(case.read_text())
    with pytest.raises(slipfront.CaseError, match="^case: sets no key"):
        slipfront.run({})
    with pytest.raises(slipfront.CaseError, match="plate.width_m is None: no value of a case file"):
        slipfront.run({"plate.width_m": None})
    with pytest.raises(slipfront.CaseError, match=r"keys of \[output\] dotted"):
        slipfront.run(CASE, output={"history_interval_s": 1e-6})


def test_results_are_not_overwritten_unless_asked(tmp_path):
    case = write_case(tmp_path)
    slipfront.run(case, output=tmp_path / "out")
    theirs = program("run", case, "-o", tmp_path / "out", cwd=tmp_path)
    with pytest.raises(slipfront.CaseError) as error:
        slipfront.run(case, output=tmp_path / "out")
    assert f"{error.value}\n" == theirs.stderr
    slipfront.run(case, output=tmp_path / "out", overwrite=True)


def test_a_folder_in_use_is_refused(tmp_path):
    case = write_case(tmp_path)
    errors = []

    def again(part, step, total):
        if not errors:
            with pytest.raises(slipfront.CaseError) as error:
                slipfront.run(case, output=tmp_path / "out", overwrite=True)
            errors.append(str(error.value))

    slipfront.run(case, output=tmp_path / "out", progress=again)
    assert "in use" in errors[0]
    assert slipfront.open(tmp_path / "out").status == "complete"


def test_blow_up(tmp_path):
    case = write_case(tmp_path)
    unstable = ["--set", "time.allow_unstable=true", "--set", "time.step_factor=1.4"]
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


def test_other_threads_go_on_meanwhile(tmp_path):
    """Another thread interrupts a long run from within; with Python's lock held it could not."""

    def interrupt():
        while not (tmp_path / "out/unfinished/energy.csv").exists() and not ended.is_set():
            time.sleep(0.01)
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
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, case, tmp_path / "out", str(threads)],
        stdout=subprocess.PIPE,
        text=True,
        env={"PYTHONPATH": str(ROOT / "python"), "PATH": ""},
    )
    while not process.stdout.readline().startswith("event"):
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    last = process.communicate(timeout=HANG_S)[0].splitlines()[-1]
    assert process.returncode == 0
    assert last.startswith("KeyboardInterrupt: interrupted at t = ")
    assert last.endswith(f"slipfront run --restart {tmp_path / 'out'} goes on with it")

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


def test_values_as_toml():
    assert toml_text(True) == "true"
    assert toml_text(np.float32(0.5)) == "0.5"
    assert toml_text(1e-6) == "1e-06"
    assert toml_text(float("inf")) == "inf"
    assert toml_text("left") == "left"
    assert toml_text("true") == '"true"'
    assert toml_text('a "b"\n') == '"a \\"b\\"\\n"'
    assert toml_text(np.array([1.0, 2.0])) == "[1.0, 2.0]"
    assert list(flattened({"a": {"b.c": 1}, "d": False})) == [("a.b.c", "1"), ("d", "false")]
