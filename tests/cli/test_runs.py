# SPDX-License-Identifier: BSD-3-Clause
"""Runs from the command line: results, progress, interruption, blow-up."""

import contextlib
import ctypes
import fcntl
import math
import os
import pty
import re
import signal
import struct
import subprocess
import termios
import time

import h5py
import numpy as np
import pytest
from common import (
    COARSE,
    ROOT,
    catches_interrupts,
    finished,
    freeze,
    one_line,
    require_done,
    require_same_bytes,
    rows_of,
    run_json,
    sets,
    settings,
    wait_until,
)
from conftest import Program
from slipfront.read import ENERGY_TERMS, HISTORY_FIELDS

SO_FAR = {f"{name}.csv" for name in ("fronts", "fracture", "static", "energy")}
SO_FAR |= {"case.resolved.toml", "run.json", "interface.h5"}
FILES = SO_FAR | {"checksums.sha256"}


def with_end(end_s):
    """A run to this time, with few rows of history."""
    return settings({"time.end_s": end_s, "time.quiet_s": math.inf, "output.history_interval_s": 1e-4})


# Hours, unless it is stopped.
LONG = [*with_end(1e3), *settings({"output.history_interval_s": 1, "output.energy_interval_s": 1})]


def files_in(folder):
    return {path.name for path in folder.iterdir()}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """What a run of the coarse case prints, and its folder."""
    program = Program(tmp_path_factory.mktemp("whole"))
    (program.folder / "coarse.toml").write_text(COARSE)
    result = program("run", "coarse.toml", "-o", "deep/out", *sets("output.energy_interval_s=5e-6"))
    return require_done(result).stdout, program.folder / "deep/out"


def test_run_writes_its_folder(whole):
    printed, out = whole
    assert files_in(out) == FILES
    assert "reaches mu_s at x = " in printed
    assert "results: deep/out" in printed
    run = run_json(out)
    assert run["end"] in ("end_time", "quiet")
    assert run["title"] == "coarse"
    for front in run["fronts"]:
        assert re.search(rf"^front {front['id']}: .*{front['mode']}", printed, re.MULTILINE)


def test_fronts_file_has_its_columns(whole):
    _, out = whole
    points = rows_of(out / "fronts.csv")
    assert ",".join(points[0]) == (
        "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
        "U_s_J_per_m3,U_r_J_per_m3,speed_kind"
    )
    assert {row["front_id"] for row in points} == {str(f["id"]) for f in run_json(out)["fronts"]}
    for row in points:
        assert row["direction"] in ("1", "-1")
        assert row["speed_kind"] in ("front", "triggered", "simultaneous", "path_end")
        assert (row["v_tip_m_per_s"] != "") == (row["speed_kind"] == "front")
        if row["t_r_Pa"] and row["p_r_Pa"]:  # at the onset t = mu_s p
            assert abs(float(row["t_r_Pa"])) == pytest.approx(1.3 * float(row["p_r_Pa"]), rel=1e-12)


def test_energies_balance(whole):
    _, out = whole
    times = rows_of(out / "energy.csv")
    assert list(times[0]) == ["time_s", *(f"{term}_J_per_m" for term in (*ENERGY_TERMS, "imbalance"))]
    run = run_json(out)
    assert list(run["energy_at_end"]) == [f"{term}_J_per_m" for term in ENERGY_TERMS]
    assert len(times) > 5
    assert float(times[-1]["time_s"]) == run["time_s"]
    largest = max(abs(float(row[name])) for row in times for name in list(row)[1:])
    assert max(abs(float(row["imbalance_J_per_m"])) for row in times) < 1e-10 * largest


def test_history_is_hdf5_with_units(whole):
    with h5py.File(whole[1] / "interface.h5") as file:
        assert {name: file[name].attrs["unit"] for name in file if not name.startswith("row")} == {
            "time_s": "s", "x_m": "m", "slip_m": "m", "slip_rate_m_per_s": "m/s", "t_Pa": "Pa", "p_Pa": "Pa",
        }  # fmt: skip
        time_s, x_m = file["time_s"][:], file["x_m"][:]
        assert np.all(np.diff(time_s) > 0)
        assert np.all(np.diff(x_m) > 0)
        assert set(file) == {"rows", "row_value", "time_s", "x_m", *HISTORY_FIELDS}
        for name in HISTORY_FIELDS:
            assert file[name].shape == (len(time_s), len(x_m))
            assert np.all(np.isfinite(file[name][:]))
        assert np.all(file["p_Pa"][:] >= 0)


def test_static_state_is_the_common_one(program, coarse, tmp_path):
    states = {}
    for kind in ("spontaneous", "left", "right"):
        require_done(program("run", coarse, "-o", kind, "-q", "--set", f"event.kind={kind}"))
        states[kind] = (tmp_path / kind / "static.csv").read_bytes()
    assert states["left"] == states["spontaneous"] == states["right"]
    x, t, p = np.loadtxt(tmp_path / "left/static.csv", delimiter=",", skiprows=1, unpack=True)
    statics = run_json(tmp_path / "left")["statics"]
    inside = (x >= statics["inside_from_m"]) & (x <= statics["inside_to_m"])
    # critical_margin is 1e-3; the equilibrium is solved to about 1e-10.
    assert np.max(t[inside] / p[inside]) == pytest.approx(0.999 * 1.3, rel=1e-9)


def test_quiet_prints_nothing(program, coarse):
    """Of a plate with fillets, here."""
    result = program("run", coarse, "-o", "out", "--quiet", "--set", "plate.corner=fillet")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_resolved_case_runs_to_the_same_fronts(program, tmp_path):
    case = ROOT / "papers/kammer2012/left.toml"
    overrides = sets("plate.element_size_m=4e-3", "friction.mu_k=0.7")
    require_done(program("run", case, "-o", "a", "-q", *overrides))
    require_done(program("run", tmp_path / "a/case.resolved.toml", "-o", "b", "-q"))
    assert files_in(tmp_path / "a") == files_in(tmp_path / "b") == FILES | {"fields.vtkhdf"}
    same = ("fronts.csv", "static.csv", "case.resolved.toml", "interface.h5")
    require_same_bytes(tmp_path / "a", tmp_path / "b", *same)
    assert len((tmp_path / "a/fronts.csv").read_text().splitlines()) > 10


# Of one step of the ramp over the critical shear: how far it may go beyond.
@pytest.mark.parametrize(("speed", "beyond"), [(1.6, 0.02), (0.16, 0.002)])
def test_a_fast_ramp_ends_where_slip_begins_inside(program, coarse, tmp_path, speed, beyond):
    """In a step the node nearest to slip passes from below mu_s p to slip, and weakens at once."""
    case = sets("plate.element_size_m=4e-3", "loading.method=ramp", "event.kind=spontaneous")
    case += sets(f"loading.shear_speed_m_per_s={speed}")
    result = require_done(program("run", coarse, "-o", "out", *case))
    ramp = run_json(tmp_path / "out")["statics"]["ramp"]
    assert 0 <= ramp["relative_to_direct"] < beyond
    assert ramp["onsets_inside"] == 1
    assert "the ramp brings t/p inside to mu_s at" in result.stdout
    assert f"{ramp['onsets_before_critical'] - 1} at the edges, 1 inside" in result.stdout
    assert ("choose a lower loading.shear_speed_m_per_s" in result.stdout) == (speed == 1.6)
    assert ("slip at mu_s p, 1 of them within" in result.stdout) == (speed == 1.6)


def test_blow_up_keeps_what_there_is(program, coarse, tmp_path):
    unstable = sets("time.allow_unstable=true", "time.step_factor=1.4")
    line = one_line(program("run", coarse, "-o", "out", "-q", *unstable), 3)
    step = int(re.search(r"\bstep (\d+)\b", line)[1])
    assert "time.step_factor" in line and "results are in out/unfinished" in line
    assert files_in(tmp_path / "out/unfinished") == SO_FAR | {"state"}
    run = run_json(tmp_path / "out/unfinished")
    assert (run["end"], run["status"], run["steps"]) == ("blow_up", "blew_up", step)
    assert "blew up" in run["reason"]


def ended_by(process, sent):
    """The last line on standard error of a run that a signal has ended."""
    process.send_signal(sent)
    ended = finished(process)
    assert (ended.returncode, ended.stdout) == (128 + sent, "")
    return ended.stderr.splitlines()[-1]


def has_checkpoint(folder):
    return any((folder / "out/unfinished/state").glob("checkpoint-*.bin"))


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
def test_interruption_keeps_what_there_is(program, coarse, tmp_path, sent):
    process = program.start("run", coarse, "-o", "out", *LONG, "--checkpoint-every-simulated", "1e-4")
    wait_until(lambda: has_checkpoint(tmp_path), process)
    printed = ended_by(process, sent)
    for part in ("interrupted at t = ", "results are in out/unfinished", "slipfront run --restart out"):
        assert part in printed
    assert files_in(tmp_path / "out/unfinished") == SO_FAR | {"state"}
    run = run_json(tmp_path / "out/unfinished")
    assert run["end"] == run["status"] == "interrupted"
    assert 1e-4 <= run["time_s"] < 1e3
    with h5py.File(tmp_path / "out/unfinished/interface.h5") as file:
        assert file["time_s"][-1] <= run["time_s"]
    # It is not lost by accident.
    assert "holds unfinished work" in program("run", coarse, "-o", "out", "-q").stderr
    require_done(program("run", coarse, "-o", "out", "-q", "--overwrite"))
    assert run_json(tmp_path / "out")["end"] != "interrupted"


def test_interruption_of_a_ramp(program, coarse, tmp_path):
    # Small steps make the ramp take hours.
    slow = sets("loading.method=ramp", "time.step_factor=1e-4")
    process = program.start("run", coarse, "-o", "out", "-q", *slow)
    wait_until((tmp_path / "out/unfinished/run.json").exists, process)
    process.send_signal(signal.SIGINT)
    assert "interrupted" in one_line(finished(process), 128 + signal.SIGINT)


def test_interruption_of_the_statics(program, coarse, tmp_path):
    slow = sets("plate.element_size_m=2.5e-4", "loading.solver=iterative")
    process = program.start("run", coarse, "-o", "out", *slow, *LONG)
    wait_until(lambda: catches_interrupts(process.pid), process)
    process.send_signal(signal.SIGUSR1)
    # The statics take seconds; where they were over before, it is the event.
    assert re.search("interrupted (in the statics|at t = )", ended_by(process, signal.SIGTERM))
    assert run_json(tmp_path / "out/unfinished")["status"] == "interrupted"


def test_a_checkpoint_on_demand_is_told(program, coarse, tmp_path):
    process = program.start("run", coarse, "-o", "out", *LONG)
    wait_until((tmp_path / "out/unfinished/energy.csv").exists, process)  # the event has begun
    process.send_signal(signal.SIGUSR1)
    wait_until(lambda: has_checkpoint(tmp_path), process)
    process.send_signal(signal.SIGTERM)
    note = r"^note: checkpoint at t = \S+ s of the event$"
    assert len(re.findall(note, finished(process).stderr, re.MULTILINE)) == 1


def test_a_checkpoint_on_demand_is_made_at_once(program, coarse, tmp_path):
    """Behind the step at which it is asked for, not behind the next of each 50 at which others are made."""
    process = program.start("run", coarse, "-o", "out", *sets("plate.element_size_m=1e-3"), *LONG)
    wait_until((tmp_path / "out/unfinished/energy.csv").exists, process)
    state = tmp_path / "out/unfinished/state"
    for n in range(1, 5):
        process.send_signal(signal.SIGUSR1)
        wait_until(lambda n=n: any(int(p.stem[-6:]) >= n for p in state.glob("checkpoint-*.bin")), process)
    process.send_signal(signal.SIGTERM)
    told = re.findall(r"^note: checkpoint at t = (\S+) s", finished(process).stderr, re.MULTILINE)
    step_s = run_json(tmp_path / "out/unfinished")["dt_s"]
    assert any(round(float(t_s) / step_s) % 50 for t_s in told)


@pytest.mark.parametrize(
    "both, code",
    [
        ((signal.SIGINT, signal.SIGQUIT), -signal.SIGQUIT),
        ((signal.SIGHUP, signal.SIGTERM), 128 + signal.SIGTERM),  # may belong to one event
    ],
    ids=["keys", "others"],
)
def test_only_a_second_key_ends_the_program_at_once(program, coarse, both, code):
    """Both wait for its main thread while it stands still: that of the lower number comes first."""
    process = program.start("run", coarse, "-o", "out", "-q", *LONG)
    wait_until(lambda: catches_interrupts(process.pid), process)
    assert freeze(process)
    for sent in both:
        assert ctypes.CDLL(None).tgkill(process.pid, process.pid, sent) == 0
    process.send_signal(signal.SIGCONT)
    assert finished(process).returncode == code


def test_what_is_ignored_from_the_start_stays_so(program, coarse):
    """As under nohup."""

    def ignore():
        signal.signal(signal.SIGHUP, signal.SIG_IGN)

    process = program.start("run", coarse, "-o", "out", "-q", *LONG, preexec_fn=ignore, restore_signals=False)
    wait_until(lambda: catches_interrupts(process.pid), process)
    process.send_signal(signal.SIGHUP)
    ended_by(process, signal.SIGTERM)


PROGRESS = r"event: \d+ %, [0-9.e+]+ steps/s, \S+( s)? to go"


@pytest.mark.slow
def test_progress_without_a_terminal_is_plain_lines(program, coarse, tmp_path):
    """A line comes after 10 s, which the program here stands still."""
    process = program.start("run", coarse, "-o", "out", *with_end(1))
    history = tmp_path / "out/unfinished/interface.h5"
    wait_until(lambda: history.exists() and history.stat().st_size > 1 << 17, process)  # behind its head
    assert freeze(process)
    time.sleep(10)
    process.send_signal(signal.SIGCONT)
    line = process.stderr.readline()
    ended_by(process, signal.SIGTERM)
    assert re.fullmatch(PROGRESS + "\n", line)


def test_progress_on_a_terminal(program, coarse):
    terminal, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    streams = {"stdout": subprocess.DEVNULL, "stderr": slave}
    process = program.start("run", coarse, "-o", "out", *with_end(0.1), **streams)
    os.close(slave)
    shown = b""
    with contextlib.suppress(OSError), open(terminal, "rb", buffering=0) as stream:  # the other end is closed
        while chunk := stream.read(4096):
            shown += chunk
    require_done(finished(process))
    text = shown.decode()
    assert "\r\x1b[Kevent" in text
    percentages = [int(n) for n in re.findall(r"event: (\d+) %", text)]
    assert percentages == sorted(percentages)
    assert re.search(PROGRESS, text)
    assert text.endswith("\n")


PRESTRESSED = """
loading.method = "prestress"
prestress.file = "table.csv"
base.kind = "rigid"
friction = {law = "slip_weakening", mu_k = 0.3, regularisation = "pressure", relaxation_time_s = 2e-6}
event.kind = "nucleation"
nucleation = {x_m = 0.05, half_length_m = 0.015, taper_m = 5e-3}
time.end_s = 60e-6
[plate]
width_m = 0.1
height_m = 0.02
element_size_m = 1e-3
corner = "none"
sides = "periodic"
top = "absorbing"
"""


def test_prescribed_tractions_from_a_table(program, write_case, tmp_path):
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases/table.csv").write_text("x_m,t_Pa,p_Pa\n0,2.1e6,5e6\n0.1,2.3e6,5e6\n")
    write_case(PRESTRESSED, "cases/c.toml")
    run = require_done(program("run", "cases/c.toml", "-o", "out"))
    assert "prescribed tractions, t/p up to 0.4596 at x = 99 mm" in run.stdout
    static = rows_of(tmp_path / "out/static.csv")
    assert len(static) == 100
    assert float(static[50]["t_s_Pa"]) == pytest.approx(2.2e6, rel=1e-12)
    assert {front["direction"] for front in run_json(tmp_path / "out")["fronts"]} == {-1, 1}

    require_done(program("run", "out/case.resolved.toml", "-o", "again", "-q"))
    same = ("fronts.csv", "fracture.csv", "energy.csv", "static.csv", "interface.h5", "case.resolved.toml")
    require_same_bytes(tmp_path / "out", tmp_path / "again", *same)
