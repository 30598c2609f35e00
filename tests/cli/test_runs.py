# SPDX-License-Identifier: BSD-3-Clause
"""Runs from the command line: results, progress, interruption, blow-up."""

import csv
import ctypes
import fcntl
import json
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
from conftest import ROOT, settings
from hostile.trials import HANG_S, freeze, wait_until
from slipfront.figures import interface_step
from slipfront.figures.convergence import read_study
from slipfront.read import ENERGY_TERMS, HISTORY_FIELDS
from test_commands import one_line

SO_FAR = {"case.resolved.toml", "run.json", "interface.h5", "fronts.csv", "static.csv", "energy.csv"}
FILES = SO_FAR | {"checksums.sha256"}


def with_end(end_s):
    """A run to this time, with few rows of history."""
    return settings({"time.end_s": end_s, "time.quiet_s": math.inf, "output.history_interval_s": 1e-4})


# Hours, unless it is stopped.
LONG = [*with_end(1e3), *settings({"output.history_interval_s": 1, "output.energy_interval_s": 1})]


def files_in(folder):
    return {path.name for path in folder.iterdir()}


def summary(folder):
    return json.loads((folder / "run.json").read_text())


def catches_interrupts(pid):
    """Whether a process has taken SIGINT into its own hands (Linux)."""
    with open(f"/proc/{pid}/status") as status:
        caught = int(re.search(r"^SigCgt:\s*([0-9a-f]+)", status.read(), re.MULTILINE)[1], 16)
    return bool(caught >> (signal.SIGINT - 1) & 1)


def test_run_writes_its_folder(program, coarse, tmp_path):
    result = program("run", coarse, "-o", "deep/out")
    assert result.returncode == 0, result.stderr
    out = tmp_path / "deep/out"
    assert files_in(out) == FILES
    assert "reaches mu_s at x = " in result.stdout
    assert "results: deep/out" in result.stdout
    run = summary(out)
    assert run["end"] in ("end_time", "quiet")
    assert run["title"] == "coarse"
    for front in run["fronts"]:
        assert re.search(rf"^front {front['id']}: .*{front['mode']}", result.stdout, re.MULTILINE)


def test_fronts_file_has_its_columns(program, coarse, tmp_path):
    assert program("run", coarse, "-o", "out", "-q").returncode == 0
    with open(tmp_path / "out/fronts.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert ",".join(rows[0]) == (
        "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
        "U_s_J_per_m3,U_r_J_per_m3,speed_kind"
    )
    assert {row["front_id"] for row in rows} == {str(f["id"]) for f in summary(tmp_path / "out")["fronts"]}
    for row in rows:
        assert row["direction"] in ("1", "-1")
        assert row["speed_kind"] in ("front", "triggered", "simultaneous", "path_end")
        assert (row["v_tip_m_per_s"] != "") == (row["speed_kind"] == "front")
        if row["t_r_Pa"] and row["p_r_Pa"]:  # at the onset t = mu_s p
            assert abs(float(row["t_r_Pa"])) == pytest.approx(1.3 * float(row["p_r_Pa"]), rel=1e-12)


def test_energies_balance(program, coarse, tmp_path):
    keys = ("--set", "output.energy_interval_s=5e-6")
    assert program("run", coarse, "-o", "out", "-q", *keys).returncode == 0
    with open(tmp_path / "out/energy.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert ",".join(rows[0]) == (
        "time_s,strain_J_per_m,kinetic_J_per_m,top_work_J_per_m,trigger_work_J_per_m,prestress_work_J_per_m,"
        "friction_work_J_per_m,contact_work_J_per_m,damping_work_J_per_m,boundary_work_J_per_m,"
        "coupling_work_J_per_m,imbalance_J_per_m"
    )
    terms = [name.removesuffix("_J_per_m") for name in rows[0] if name.endswith("_J_per_m")]
    assert terms == [*ENERGY_TERMS, "imbalance"]
    assert list(summary(tmp_path / "out")["energy_at_end"]) == [f"{term}_J_per_m" for term in ENERGY_TERMS]
    assert len(rows) > 5
    assert float(rows[-1]["time_s"]) == summary(tmp_path / "out")["time_s"]
    largest = max(abs(float(row[name])) for row in rows for name in row if name.endswith("_J_per_m"))
    assert max(abs(float(row["imbalance_J_per_m"])) for row in rows) < 1e-10 * largest


def test_history_is_hdf5_with_units(program, coarse, tmp_path):
    assert program("run", coarse, "-o", "out", "-q").returncode == 0
    with h5py.File(tmp_path / "out/interface.h5") as file:
        assert {name: file[name].attrs["unit"] for name in file} == {
            "time_s": "s", "x_m": "m", "slip_m": "m", "slip_rate_m_per_s": "m/s", "t_Pa": "Pa", "p_Pa": "Pa",
        }  # fmt: skip
        time_s, x_m = file["time_s"][:], file["x_m"][:]
        assert np.all(np.diff(time_s) > 0)
        assert np.all(np.diff(x_m) > 0)
        assert set(file) == {"time_s", "x_m", *HISTORY_FIELDS}
        for name in HISTORY_FIELDS:
            assert file[name].shape == (len(time_s), len(x_m))
            assert np.all(np.isfinite(file[name][:]))
        assert np.all(file["p_Pa"][:] >= 0)


def test_static_state_is_the_common_one(program, coarse, tmp_path):
    states = {}
    for kind in ("spontaneous", "left", "right"):
        assert program("run", coarse, "-o", kind, "-q", "--set", f"event.kind={kind}").returncode == 0
        states[kind] = (tmp_path / kind / "static.csv").read_bytes()
    assert states["left"] == states["spontaneous"] == states["right"]
    x, t, p = np.loadtxt(tmp_path / "left/static.csv", delimiter=",", skiprows=1, unpack=True)
    statics = summary(tmp_path / "left")["statics"]
    inside = (x >= statics["inside_from_m"]) & (x <= statics["inside_to_m"])
    # critical_margin is 1e-3; the equilibrium is solved to about 1e-10.
    assert np.max(t[inside] / p[inside]) == pytest.approx(0.999 * 1.3, rel=1e-9)


def test_quiet_prints_nothing(program, coarse):
    result = program("run", coarse, "-o", "out", "--quiet")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_resolved_case_runs_to_the_same_fronts(program, tmp_path):
    case = ROOT / "papers/kammer2012/left.toml"
    overrides = ["--set", "plate.element_size_m=4e-3", "--set", "friction.mu_k=0.7"]
    assert program("run", case, "-o", "a", "-q", *overrides).returncode == 0
    assert program("run", tmp_path / "a/case.resolved.toml", "-o", "b", "-q").returncode == 0
    assert files_in(tmp_path / "a") == files_in(tmp_path / "b") == FILES | {"fields.vtkhdf"}
    for name in ("fronts.csv", "static.csv", "case.resolved.toml"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name
    assert len((tmp_path / "a/fronts.csv").read_text().splitlines()) > 10
    with h5py.File(tmp_path / "a/interface.h5") as a, h5py.File(tmp_path / "b/interface.h5") as b:
        for name in a:
            assert np.array_equal(a[name][:], b[name][:]), name


def test_overrides_win_over_the_file(program, coarse, tmp_path):
    arguments = ["--set", "friction.mu_k=0.9", "--set", "friction.mu_k=1.0", "--set", "title=by hand"]
    assert program("run", coarse, "-o", "out", "-q", *arguments).returncode == 0
    resolved = (tmp_path / "out/case.resolved.toml").read_text()
    assert re.search(r"^mu_k = 1\b", resolved, re.MULTILINE)
    assert re.search(r'^title = "by hand"', resolved, re.MULTILINE)


def test_coulomb_friction_by_overrides(program, coarse, tmp_path):
    """The file's parameters of its own law do not stand in the way."""
    result = program("run", coarse, "-o", "out", "--set", "friction.law=coulomb", "--set", "friction.mu=0.9")
    assert result.returncode == 0, result.stderr
    peak = summary(tmp_path / "out")["statics"]["common_peak_t_over_p"]
    assert peak == pytest.approx(0.999 * 0.9, rel=1e-9)
    assert re.search(r'^law = "coulomb"', (tmp_path / "out/case.resolved.toml").read_text(), re.MULTILINE)


@pytest.mark.parametrize("corner", ["none", "relief", "fillet"])
def test_every_corner_runs(program, coarse, corner):
    result = program("run", coarse, "-o", "out", "-q", "--set", f"plate.corner={corner}")
    assert (result.returncode, result.stderr) == (0, "")


def test_ramp_agrees_with_the_direct_way(program, coarse, tmp_path):
    result = program("run", coarse, "-o", "out", "--set", "loading.method=ramp")
    assert result.returncode == 0, result.stderr
    ramp = summary(tmp_path / "out")["statics"]["ramp"]
    assert abs(ramp["relative_to_direct"]) < 0.005
    assert "the ramp brings t/p inside to mu_s at" in result.stdout


# Of one step of the ramp over the critical shear: how far it may go beyond.
@pytest.mark.parametrize(("speed", "beyond"), [(1e-3, 0.02), (1e-4, 0.002)])
def test_a_fast_ramp_ends_where_slip_begins_inside(program, coarse, tmp_path, speed, beyond):
    """In a step the node nearest to slip passes from below mu_s p to slip, and weakens at once."""
    sets = settings(
        {
            "plate.element_size_m": 4e-3,
            "loading.method": "ramp",
            "loading.shear_speed_over_c_L": speed,
            "event.kind": "spontaneous",
        }
    )
    result = program("run", coarse, "-o", "out", *sets)
    assert result.returncode == 0, result.stderr
    ramp = summary(tmp_path / "out")["statics"]["ramp"]
    assert 0 <= ramp["relative_to_direct"] < beyond
    assert ramp["onsets_inside"] == 1
    assert f"{ramp['onsets_before_critical'] - 1} at the edges, 1 inside" in result.stdout
    assert ("choose a lower loading.shear_speed_over_c_L" in result.stdout) == (speed == 1e-3)
    assert ("slip at mu_s p, 1 of them within" in result.stdout) == (speed == 1e-3)


def test_blow_up_keeps_what_there_is(program, coarse, tmp_path):
    result = program(
        "run", coarse, "-o", "out", "-q", "--set", "time.allow_unstable=true", "--set", "time.step_factor=1.4"
    )
    assert result.returncode == 3
    lines = result.stderr.splitlines()
    assert len(lines) == 1
    step = int(re.search(r"\bstep (\d+)\b", lines[0])[1])
    assert "time.step_factor" in lines[0]
    assert "results are in out/unfinished" in lines[0]
    assert files_in(tmp_path / "out/unfinished") == SO_FAR | {"state"}
    run = summary(tmp_path / "out/unfinished")
    assert run["end"] == "blow_up"
    assert run["status"] == "blew_up"
    assert run["steps"] == step
    assert any("blew up" in warning for warning in run["warnings"])


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
def test_interruption_keeps_what_there_is(program, coarse, tmp_path, sent):
    often = ("--checkpoint-every-simulated", "1e-4")
    process = program.start(
        "run", coarse, "-o", "out", *LONG, *often, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    wait_until(lambda: any((tmp_path / "out/unfinished/state").glob("checkpoint-*.bin")), process)
    process.send_signal(sent)
    output, errors = process.communicate(timeout=HANG_S)
    assert process.returncode == 128 + sent
    assert output == ""
    last = errors.splitlines()[-1]
    assert "interrupted at t = " in last
    assert "results are in out/unfinished" in last
    assert "slipfront run --restart out" in last
    assert files_in(tmp_path / "out/unfinished") == SO_FAR | {"state"}
    run = summary(tmp_path / "out/unfinished")
    assert run["end"] == run["status"] == "interrupted"
    assert 1e-4 <= run["time_s"] < 1e3
    with h5py.File(tmp_path / "out/unfinished/interface.h5") as file:
        assert file["time_s"][-1] <= run["time_s"]
    # It is not lost by accident.
    assert "holds unfinished work" in program("run", coarse, "-o", "out", "-q").stderr
    assert program("run", coarse, "-o", "out", "-q", "--overwrite").returncode == 0
    assert summary(tmp_path / "out")["end"] != "interrupted"


def test_interruption_of_a_ramp(program, coarse, tmp_path):
    # Small steps make the ramp take hours.
    process = program.start(
        "run", coarse, "-o", "out", "-q", "--set", "loading.method=ramp", "--set", "time.step_factor=1e-4",
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    wait_until((tmp_path / "out/unfinished/run.json").exists, process)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=HANG_S)
    assert process.returncode == 130
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert "interrupted" in errors


def test_interruption_of_the_statics(program, coarse, tmp_path):
    process = program.start(
        "run", coarse, "-o", "out",
        "--set", "plate.element_size_m=2.5e-4", "--set", "loading.solver=iterative",
        *LONG, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    wait_until(lambda: catches_interrupts(process.pid), process)
    process.send_signal(signal.SIGUSR1)
    process.send_signal(signal.SIGTERM)
    output, errors = process.communicate(timeout=HANG_S)
    assert process.returncode == 128 + signal.SIGTERM
    assert output == ""
    # The statics take seconds; where they were over before, it is the event.
    assert re.search("interrupted (in the statics|at t = )", errors.splitlines()[-1])
    assert summary(tmp_path / "out/unfinished")["status"] == "interrupted"


def test_a_checkpoint_on_demand_is_told(program, coarse, tmp_path):
    process = program.start("run", coarse, "-o", "out", *LONG, stderr=subprocess.PIPE, text=True)
    wait_until((tmp_path / "out/unfinished/energy.csv").exists, process)  # the event has begun
    process.send_signal(signal.SIGUSR1)
    wait_until(lambda: any((tmp_path / "out/unfinished/state").glob("checkpoint-*.bin")), process)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=HANG_S)
    assert len(re.findall(r"^note: checkpoint at t = \S+ s of the event$", errors, re.MULTILINE)) == 1


def test_second_interrupt_ends_the_program(program, coarse):
    """Both wait for its main thread while it stands still: that of the lower number comes first."""
    process = program.start("run", coarse, "-o", "out", "-q", *LONG)
    wait_until(lambda: catches_interrupts(process.pid), process)
    assert freeze(process)
    for sent in (signal.SIGINT, signal.SIGTERM):
        assert ctypes.CDLL(None).tgkill(process.pid, process.pid, sent) == 0
    process.send_signal(signal.SIGCONT)
    assert process.wait(timeout=HANG_S) == -signal.SIGTERM


def test_what_is_ignored_from_the_start_stays_so(program, coarse):
    """As under nohup."""
    process = program.start(
        "run", coarse, "-o", "out", "-q", *LONG,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),
        restore_signals=False, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    wait_until(lambda: catches_interrupts(process.pid), process)
    process.send_signal(signal.SIGHUP)
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=HANG_S) == 128 + signal.SIGTERM


def test_progress_without_a_terminal_is_plain_lines(program, coarse):
    result = program("run", coarse, "-o", "out", *with_end(0.1))
    assert result.returncode == 0
    assert "\r" not in result.stderr
    assert "\033" not in result.stderr
    lines = result.stderr.splitlines()
    assert 1 <= len(lines) <= 10
    for line in lines:
        assert re.fullmatch(r"event: \d+ %, \S+ steps/s, \S+( s)? to go", line)


def test_progress_on_a_terminal(program, coarse):
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    process = program.start(
        "run", coarse, "-o", "out", *with_end(0.1), stdout=subprocess.DEVNULL, stderr=slave
    )
    os.close(slave)
    shown = b""
    try:
        while True:
            try:
                chunk = os.read(master, 4096)
            except OSError:  # the other end is closed
                break
            if not chunk:
                break
            shown += chunk
        assert process.wait(timeout=HANG_S) == 0
    finally:
        os.close(master)
    text = shown.decode()
    assert "\r\x1b[Kevent" in text
    percentages = [int(n) for n in re.findall(r"event: (\d+) %", text)]
    assert percentages == sorted(percentages)
    assert re.search(r"event: \d+ %, [0-9.e+]+ steps/s, \S+( s)? to go", text)
    assert text.endswith("\n")


def test_reproduce_quick(program, tmp_path):
    points = tmp_path / "points.csv"
    rows = "".join(f"{0.5 + 0.05 * k},1.0\n" for k in range(16))
    points.write_text("# by hand\nstatic_ratio,v_over_c_L\n" + rows)
    result = program("reproduce", "--quick", "-o", "out", "--threads", "2", "--experiment", points)
    assert result.returncode == 0, result.stderr
    claims = json.loads((tmp_path / "out/scorecard.json").read_text())
    assert next(claim for claim in claims if claim["id"] == "E1")["holds"] is not None
    assert {f"C{k}" for k in range(1, 24)} | {"E1"} <= {claim["id"] for claim in claims}
    for claim in claims:
        held = "used to choose" if claim.get("used_to_choose") else "holds"
        verdict = {True: held, False: "does not hold", None: "not tested"}[claim["holds"]]
        assert re.search(
            rf"^{re.escape(claim['id'])} +{verdict} +{re.escape(claim['claim'])}", result.stdout, re.MULTILINE
        )
        assert claim["measured"] in result.stdout
    assert "results: out" in result.stdout

    def judged(claim):
        return "used" if claim["holds"] and claim.get("used_to_choose") else claim["holds"]

    counted = [judged(claim) for claim in claims if claim["counts"] and claim["id"] != "E1"]
    first = [judged(claim) for claim in claims if re.fullmatch(r"C\d+", claim["id"])]
    assert len(counted) == len(first) == 23
    assert (
        f"Of the paper's 23 claims {counted.count(True)} hold, {counted.count(False)} do not, "
        in result.stdout
    )
    assert (
        f"by the first tests alone {first.count(True)} hold, {first.count(False)} do not, " in result.stdout
    )
    for folder in ("spontaneous", "left", "right", "spontaneous_mu_k_1.0"):
        assert files_in(tmp_path / "out" / folder) >= FILES


@pytest.mark.slow
def test_reproduce_can_be_interrupted(program, tmp_path):
    """Once its events are done, before what else it computes."""
    names = ("spontaneous", "left", "right", "spontaneous_mu_k_1.0")
    events = [tmp_path / "out/unfinished" / name for name in names]
    process = program.start(
        "reproduce", "-o", "out", stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    # Its list of checksums is a run's last file.
    while process.poll() is None and not all((e / "checksums.sha256").exists() for e in events):
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=HANG_S)
    if process.returncode == 0:  # it was done before
        assert (tmp_path / "out/scorecard.json").exists()
        return
    assert process.returncode == 130
    assert output == ""
    assert "interrupted" in errors.splitlines()[-1]
    for folder in events:
        assert files_in(folder) >= FILES
        assert summary(folder)["end"] != "interrupted"
    assert not (tmp_path / "out/scorecard.json").exists()


def test_convergence_study_and_its_figure_agree(program, coarse, tmp_path):
    """The medians that the figure draws from the table are those that the program tells."""
    sizes = "5e-3,2.5e-3,2e-3"
    result = program("study", "convergence", coarse, "-o", "out", "--threads", "2", "--element-sizes", sizes)
    assert result.returncode == 0, result.stderr
    told = json.loads((tmp_path / "out/convergence.json").read_text())["sequences"]
    study = read_study(tmp_path / "out")
    assert [s.parameter for s in study.sequences] == [s["parameter"] for s in told]
    compared = 0
    for entry, sequence in zip(told, study.sequences, strict=True):
        for direction in study.directions():
            error = entry[f"direction_{direction:+d}"]["median_relative_error"]
            if error is None:
                continue
            # Ten digits in the table.
            assert sequence.median_error(direction)[sequence.own] == pytest.approx(error, rel=1e-6)
            compared += 1
    assert compared >= 3


@pytest.mark.parametrize("event, n_quiet", [("left", 0), ("none", 9)])
def test_a_study_tells_how_many_runs_ended_early(program, coarse, tmp_path, event, n_quiet):
    sizes = "5e-3,2.5e-3,2e-3"
    result = program(
        "study", "convergence", coarse, "--set", f"event.kind={event}", "-o", "out", "--element-sizes", sizes
    )
    assert f"\n9 runs, {n_quiet} of which ended before time.end_s since nothing moved\n" in result.stdout
    told = json.loads((tmp_path / "out/convergence.json").read_text())
    assert (told["n_runs"], told["n_quiet"]) == (9, n_quiet)
    assert ("note: no front of the case's own run" in result.stdout) == (event == "none")


def test_sizes_of_a_study_that_do_not_fit_are_the_options(program, coarse):
    told = one_line(
        program("study", "convergence", coarse, "-o", "out", "--element-sizes", "5e-3,7e-3,2.5e-3")
    )
    assert (
        "element size 0.007 m of the study, see --element-sizes: plate.element_size_m = 0.007 does not"
        in told
    )


def test_reproduce_tells_how_far_the_scorecard_moves(program, tmp_path):
    result = program("reproduce", "--quick", "--sensitivity", "-o", "out", "--threads", "2")
    assert result.returncode == 0
    assert "at plate.element_size_m = 0.004 it moves by" in result.stdout
    row = next(r for r in json.loads((tmp_path / "out/scorecard.json").read_text()) if r["id"] == "C11")
    assert row["mesh_variation"]["differences"][0] > 0
    refused = program("reproduce", "--sensitivity", "--regularised", "-o", "other")
    assert refused.returncode == 2 and "--sensitivity" in refused.stderr


PRESTRESSED = """
[plate]
width_m = 0.1
height_m = 0.02
element_size_m = 1e-3
corner = "none"
sides = "periodic"
top = "absorbing"
[loading]
method = "prestress"
[prestress]
file = "table.csv"
[friction]
law = "slip_weakening"
regularisation = "pressure"
relaxation_time_s = 2e-6
[event]
kind = "nucleation"
[nucleation]
x_m = 0.05
half_length_m = 0.015
taper_m = 5e-3
[time]
end_s = 60e-6
"""


def test_prescribed_tractions_from_a_table(program, write_case, tmp_path):
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases/table.csv").write_text("x_m,t_Pa,p_Pa\n0,2.1e6,5e6\n0.1,2.3e6,5e6\n")
    write_case(PRESTRESSED, "cases/c.toml")
    run = program("run", "cases/c.toml", "-o", "out")
    assert run.returncode == 0, run.stderr
    assert "prescribed tractions, t/p up to 0.4596 at x = 0.099 m" in run.stdout
    with open(tmp_path / "out/static.csv", newline="") as file:
        static = list(csv.DictReader(file))
    assert len(static) == 100
    assert float(static[50]["t_s_Pa"]) == pytest.approx(2.2e6, rel=1e-12)
    assert {front["direction"] for front in summary(tmp_path / "out")["fronts"]} == {-1, 1}

    again = program("run", "out/case.resolved.toml", "-o", "again", "-q")
    assert again.returncode == 0, again.stderr
    for name in ("fronts.csv", "energy.csv", "static.csv", "interface.h5", "case.resolved.toml"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


def test_wrong_table_is_named_with_the_line_of_its_key(program, write_case, tmp_path):
    (tmp_path / "table.csv").write_text("x_m,t_Pa,p_Pa\n0,2.1e6,5e6\n0.05,2.3e6,5e6\n")
    case = write_case(PRESTRESSED)
    line = PRESTRESSED.splitlines().index('file = "table.csv"') + 1
    for command in (["run", case, "-o", "out"], ["validate", case], ["info", case]):
        failed = program(*command)
        assert failed.returncode == 2
        assert f"{case}:{line}: prestress.file: " in failed.stderr
        assert "table.csv: covers x = 0 to 0.05 m" in failed.stderr
    assert not (tmp_path / "out").exists()


def test_open_choices_are_judged_and_handed_to_the_scorecard(program, tmp_path):
    result = program("study", "open-choices", "--quick", "-o", "choices", "--threads", "2")
    assert result.returncode == 0, result.stderr
    summary = json.loads((tmp_path / "choices/open_choices.json").read_text())
    rows = list(csv.DictReader((tmp_path / "choices/open_choices.csv").open()))
    assert len(rows) == summary["n_samples"]
    assert f"{summary['n_samples']} samples of {len(summary['choices'])} choices" in result.stdout
    # Shares of the matrix are those of the table.
    for row in summary["matrix"]:
        verdicts = [r[row["id"]] for r in rows if r["set"] == "all" and r[row["id"]]]
        assert row["share_of_all"] == pytest.approx(verdicts.count("holds") / len(verdicts))
        assert row["holds"] == (rows[0][row["id"]] == "holds")
    result = program("reproduce", "--quick", "-o", "out", "--open-choices", "choices")
    assert result.returncode == 0, result.stderr
    claims = {c["id"]: c for c in json.loads((tmp_path / "out/scorecard.json").read_text())}
    assert f"of {summary['n_triggers']} triggers" in claims["C11b"]["measured"]
    for arguments, said in (
        (["--quick", "-o", "choices", "--overwrite", "--open-choices", "choices"], "choose another"),
        (["-o", "again", "--open-choices", "choices"], "is a quick study"),
        (["--quick", "-o", "again", "--open-choices", ""], "is empty; give a path"),
        (["--quick", "-o", "again", "--experiment", ""], "is empty; give a path"),
    ):
        result = program("reproduce", *arguments)
        assert result.returncode == 2, arguments
        assert said in result.stderr
        assert not (tmp_path / "again").exists()
    (tmp_path / "choices/open_choices.csv").write_text("changed")
    result = program("reproduce", "--quick", "-o", "again", "--open-choices", "choices")
    assert result.returncode == 2
    assert "choices/open_choices.csv" in result.stderr


def test_interface_step_study_writes_a_case_that_runs(program, coarse, tmp_path):
    options = ("--rows", "2", "--substeps", "2,4", "--tolerance", "0.5")
    result = program("study", "interface-step", coarse, "-o", "out", *options)
    assert result.returncode == 0, result.stderr
    assert "cheapest within 50 %" in result.stdout
    picture = tmp_path / "picture.png"
    assert interface_step.main(picture, [tmp_path / "out"]) == 0
    assert picture.is_file()
    assert program("run", "out/chosen.toml", "-o", "again", "-q").returncode == 0
    chosen = json.loads((tmp_path / "out/interface_step.json").read_text())["chosen"]
    assert chosen["p90_error"] <= 0.5
