# SPDX-License-Identifier: BSD-3-Clause
"""What may go wrong while several processes share a run: it ends with one line and the exit code of the
README, and nothing is lost that a run of one process would keep."""

import contextlib
import os
import re
import resource
import shutil
import signal
from pathlib import Path

import pytest
from common import (
    ROOT,
    call,
    finished,
    one_line,
    refusal,
    require_done,
    require_same_bytes,
    sets,
    wait_until,
    wait_until_or_over,
)
from conftest import own, send
from hostile.trials import TRIES, alone, difference, remove

# Elements of 4 mm and 2000 steps: some tenths of a second on idle processors.
CASE = """\
title = "shared"

[plate]
width_m = 0.2
height_m = 0.1
element_size_m = 4e-3

[base]
kind = "rigid"

[friction]
law = "velocity_weakening"

[event]
kind = "left"

[time]
end_s = 4e-3
quiet_s = inf

[output]
history_interval_s = 1e-5
snapshot_times_s = [1e-3, 3e-3]
"""
OFTEN = ("--checkpoint-every-simulated", "2e-4")
# The statics take seconds, the event few steps.
SLOW_STATICS = sets("plate.element_size_m=5e-4", "loading.solver=direct", "time.end_s=2e-5")


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory):
    """The folder of a run that nothing happens to; made when first asked for."""
    folder = tmp_path_factory.mktemp("undisturbed") / "out"

    def results(mpirun, case):
        if not folder.exists():
            require_done(mpirun(2, "run", case, "-o", folder, "-q"))
        return folder

    return results


def met(mpirun, condition, *arguments):
    """A run of two processes once a condition holds, and its own; again where it was over before. It may be
    over by the time that something is done to it."""
    for _ in range(TRIES):
        process = mpirun.start(2, "run", *arguments, "-o", "out", "-q")
        wait_until_or_over(condition, process)
        pids = mpirun.processes()
        if len(pids) == 2:
            return process, pids
        require_done(finished(process))
        remove(mpirun.folder / "out")
    pytest.fail("over too soon, each time")


def in_event(mpirun, case):
    """It has kept a checkpoint of its event."""
    state = mpirun.folder / "out/unfinished/state"
    return met(mpirun, lambda: any(state.glob("checkpoint-*.bin")), case, *OFTEN)


def in_statics(mpirun, case):
    return met(mpirun, (mpirun.folder / "out/unfinished/run.json").exists, case, *SLOW_STATICS)


def interrupted_line(result):
    """The only line of a run that SIGTERM has ended; none where it was done before."""
    return one_line(own(result), 128 + signal.SIGTERM) if result.returncode else ""


def require_killed(result, pids):
    """Or done before; no process is left in any case."""
    assert result.returncode in (0, 128 + signal.SIGKILL), result.stderr
    assert not own(result).stderr
    require_ended(pids.values())


def is_ended(pid):
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except OSError:
        return True


def require_ended(pids):
    """No process is left that waits for one that has gone."""
    wait_until(lambda: all(is_ended(pid) for pid in pids))


def require_goes_on(mpirun, case, undisturbed):
    """Going on with what was kept gives what an undisturbed run gives, bit for bit."""
    result = require_done(mpirun(2, "run", "--restart", "out", "-q"))
    assert not own(result).stderr
    require_undisturbed(mpirun, case, undisturbed)


def require_undisturbed(mpirun, case, undisturbed):
    """A run that was not stopped: every file, bit for bit."""
    assert not difference(alone(mpirun.folder / "out"), alone(undisturbed(mpirun, case)))


def require_no_core(folder):
    assert not list(folder.rglob("core*"))


# --- Command lines and cases

RUN = ["run", "case.toml", "-o", "out", "--state-dir", "states"]


def test_one_process_answers(mpirun):
    result = require_done(mpirun(2, "--version"))
    assert result.stdout == mpirun.alone("--version").stdout
    assert not own(result).stderr


@pytest.mark.parametrize(
    "n, command, expected",
    [
        (2, ["validate", "case.toml"], "start validate alone"),
        (2, ["sweep", "case.toml"], "start sweep alone"),
        (2, ["bench", "--statics", "50"], "start bench alone"),
        (2, [*RUN, "--set", "plate.sids=free"], "did you mean plate.sides?"),
        (4, RUN, "choose at most 2"),
    ],
)
def test_refused_commands_and_cases(mpirun, case, tmp_path, n, command, expected):
    assert expected in refusal(own(mpirun(n, *command)))
    # Before the statics, which would have been kept.
    assert list(tmp_path.iterdir()) == [case]


def test_blow_up(mpirun, case, tmp_path):
    unstable = sets("time.allow_unstable=true", "time.step_factor=1.4")
    result = mpirun(2, "run", case, "-o", "out", "-q", *unstable)
    assert "results are in out/unfinished" in one_line(own(result), 3)
    assert (tmp_path / "out/unfinished/run.json").is_file()


def test_different_programs(mpirun, case, tmp_path):
    other = tmp_path / "other"
    shutil.copy(mpirun.program, other)
    with other.open("ab") as file:
        file.write(b"another build")
    line = refusal(own(mpirun(2, "run", case, "-o", "out", programs=[[mpirun.program], [other]])))
    assert "start the same program everywhere" in line
    assert len(set(re.findall(r"build ([0-9a-f]{16})", line))) == 2
    assert not (tmp_path / "out").exists()


def test_other_processes_read_no_file(mpirun, case, tmp_path):
    """Theirs may be other machines, on which paths lead elsewhere."""
    table = tmp_path / "friction.csv"
    table.write_text("x_m,mu_k\n0,0.6\n0.1,0.7\n0.2,0.5\n")
    with_table = ("run", case, "-q", "--set", f"friction.file={table}", "-o", "out")
    leader, other = tmp_path / "leader", tmp_path / "other"
    leader.mkdir()
    other.mkdir()
    programs = [["-wdir", folder, mpirun.program] for folder in (leader, other)]
    require_done(mpirun(2, *with_table, programs=programs))
    assert not list(other.iterdir())
    require_done(mpirun.alone(*with_table))
    names = ("interface.h5", "fields.vtkhdf", "fronts.csv", "fracture.csv", "static.csv")
    require_same_bytes(leader / "out", tmp_path / "out", *names)


# --- Processes that die


@pytest.mark.parametrize("rank", [0, 1])
def test_killed_in_the_event(mpirun, case, undisturbed, rank):
    process, pids = in_event(mpirun, case)
    send(pids[rank], signal.SIGKILL)
    require_killed(finished(process), pids)
    require_no_core(mpirun.folder)
    require_goes_on(mpirun, case, undisturbed)


@pytest.mark.parametrize("rank", [0, 1])
def test_killed_in_the_statics(mpirun, case, rank):
    process, pids = in_statics(mpirun, case)
    send(pids[rank], signal.SIGKILL)
    require_killed(finished(process), pids)
    require_no_core(mpirun.folder)


def test_killed_mpirun_leaves_nobody(mpirun, case, undisturbed):
    process, pids = in_event(mpirun, case)
    process.kill()
    process.wait()
    require_ended(pids.values())
    require_goes_on(mpirun, case, undisturbed)


# --- Signals


def test_interrupted_by_mpirun(mpirun, case, undisturbed):
    process, pids = in_event(mpirun, case)
    process.send_signal(signal.SIGINT)
    finished(process)
    require_ended(pids.values())
    require_no_core(mpirun.folder)
    require_goes_on(mpirun, case, undisturbed)


def test_interrupted_leader(mpirun, case, undisturbed):
    process, pids = in_event(mpirun, case)
    send(pids[0], signal.SIGTERM)
    if line := interrupted_line(finished(process)):
        assert "results are in out/unfinished" in line and "--restart out" in line
    require_goes_on(mpirun, case, undisturbed)


def test_interrupted_leader_in_the_statics(mpirun, case):
    process, pids = in_statics(mpirun, case)
    send(pids[0], signal.SIGTERM)
    if line := interrupted_line(finished(process)):
        assert "interrupted" in line


def test_checkpoint_on_request(mpirun, case, undisturbed):
    """Again where it was over before it was asked."""
    history = mpirun.folder / "out/unfinished/interface.h5"
    for _ in range(TRIES):
        process = mpirun.start(2, "run", case, "-o", "out")
        wait_until_or_over(history.exists, process)
        process.send_signal(signal.SIGUSR1)
        result = require_done(finished(process))
        require_undisturbed(mpirun, case, undisturbed)
        if re.search(r"note: checkpoint at t = \S+ s of the event", result.stderr):
            return
        remove(mpirun.folder / "out")
    pytest.fail("no checkpoint was told")


# --- Disks, streams, memory


@pytest.fixture(scope="session")
def fault_library(tmp_path_factory):
    """Put before the system's, it lets writing below a folder fail."""
    library = tmp_path_factory.mktemp("fault") / "fault.so"
    require_done(call("cc", "-shared", "-fPIC", ROOT / "tests/hostile/fault.c", "-o", library, "-ldl"))
    return library


@pytest.fixture
def faulty(mpirun, fault_library):
    """The program of which a call to the system goes wrong below a path, from that call on."""

    def command(below, at, mode="on"):
        fault = {"LD_PRELOAD": fault_library, "FAULT_BELOW": mpirun.folder / below, "FAULT_AT": at}
        fault |= {"FAULT_MODE": mode, "FAULT_ERROR": 28}
        return ["env", *(f"{name}={value}" for name, value in fault.items()), mpirun.program]

    return command


def test_full_disk(mpirun, case, undisturbed, faulty):
    result = mpirun(2, "run", case, "-o", "out", "-q", *OFTEN, programs=2 * [faulty("out", 200)])
    line = one_line(own(result), 1)
    assert "No space left on device" in line
    assert "--restart out" in line
    require_goes_on(mpirun, case, undisturbed)


def test_limit_of_file_sizes(mpirun, case, undisturbed):
    """It is below that of the files by which MPI shares memory, too."""
    limited = ["bash", "-c", 'ulimit -f 128; exec "$0" "$@"', mpirun.program]
    result = mpirun(2, "run", case, "-o", "out", "-q", *OFTEN, programs=[limited, limited])
    assert result.returncode == 1
    assert "(File too large)" in result.stderr
    assert "--restart out" in result.stderr
    require_goes_on(mpirun, case, undisturbed)


# --- fields.vtkhdf, which all processes write


def fails_in_fields(mpirun, faulty, case, rank, *fault):
    """A run of two processes, of which one cannot write fields.vtkhdf from a call of the system on."""
    programs = [[mpirun.program], [mpirun.program]]
    programs[rank] = faulty("out/unfinished/fields.vtkhdf", *fault)
    return own(mpirun(2, "run", case, "-o", "out", "-q", *OFTEN, programs=programs))


# Each process writes some 20 times behind the rows, which the leader has written before.
@pytest.mark.parametrize(("rank", "at"), [(0, 1), (0, 30), (1, 1), (1, 19)])
def test_fields_that_one_process_cannot_write(mpirun, faulty, case, undisturbed, rank, at):
    line = one_line(fails_in_fields(mpirun, faulty, case, rank, at), 1)
    assert "fields.vtkhdf: cannot " in line
    assert ("rank 1: " in line) == (rank == 1)
    assert "--restart out" in line
    require_goes_on(mpirun, case, undisturbed)


@pytest.mark.parametrize(("rank", "at"), [(0, 20), (1, 10)])
def test_killed_while_fields_are_written(mpirun, faulty, case, undisturbed, rank, at):
    result = fails_in_fields(mpirun, faulty, case, rank, at, "kill")
    assert (result.returncode, result.stderr) == (128 + signal.SIGKILL, "")
    require_goes_on(mpirun, case, undisturbed)


OTHERS_DO_NOT_SEE = (
    "note: fields.vtkhdf is written by rank 0 alone: others do not see out/unfinished, or cannot write there"
)


@pytest.mark.parametrize(
    "view",
    [
        # As on machines without a common file system.
        "mount -t tmpfs none {out}",
        # The other process sees the files of the leader, and not the other way round, or cannot write there.
        "mount -t tmpfs none {own} && mkdir {own}/up {own}/work &&"
        " mount -t overlay none -o lowerdir={out},upperdir={own}/up,workdir={own}/work {out}",
        "mount --bind {out} {out} && mount -o remount,ro,bind {out}",
    ],
    ids=["unseen", "overlay", "read-only"],
)
def test_folder_that_others_see_otherwise(mpirun, case, undisturbed, tmp_path, view):
    """The leader writes all files."""
    folder, own_folder = mpirun.folder / "out", tmp_path / "own"
    folder.mkdir()
    own_folder.mkdir()
    script = view.format(out=folder, own=own_folder)
    if call("unshare", "-m", "bash", "-c", script).returncode != 0:
        pytest.skip("no such file system can be mounted here")
    elsewhere = ["unshare", "-m", "bash", "-c", script + ' && exec "$0" "$@"', mpirun.program]
    result = require_done(mpirun(2, "run", case, "-o", "out", programs=[[mpirun.program], elsewhere]))
    assert OTHERS_DO_NOT_SEE in result.stderr
    require_undisturbed(mpirun, case, undisturbed)


@pytest.mark.parametrize("out", ["closed", "full"])
def test_output_that_nobody_takes(mpirun, case, undisturbed, out):
    """What one process prints of its run may be lost, too."""
    close = (lambda: os.close(1)) if out == "closed" else None
    with open("/dev/full", "w") as full:
        require_done(mpirun(2, "run", case, "-o", "out", stdout=full, preexec_fn=close))
    require_undisturbed(mpirun, case, undisturbed)


@pytest.mark.parametrize(
    "rank, code, expected",
    [
        # The limit may come before the statics ask how much memory there is, or after.
        (0, 2, "out of memory in the static solution|needs about .* GB of memory, .* are available"),
        (1, 1, "rank 1: not enough memory"),
    ],
)
def test_no_memory(mpirun, case, rank, code, expected):
    process, pids = in_statics(mpirun, case)
    with contextlib.suppress(OSError):  # it has ended meanwhile
        pages = int(Path(f"/proc/{pids[rank]}/statm").read_text().split()[0])
        limit = pages * resource.getpagesize()
        resource.prlimit(pids[rank], resource.RLIMIT_AS, (limit, limit))
    result = finished(process)
    if result.returncode != 0:
        assert re.search(expected, one_line(own(result), code))
    require_ended(pids.values())
    require_no_core(mpirun.folder)
