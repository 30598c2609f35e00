# SPDX-License-Identifier: BSD-3-Clause
"""What may go wrong while several processes share a run: it ends with one line and the exit code of the
README, and nothing is lost that a run of one process would keep."""

import contextlib
import os
import re
import resource
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from conftest import AS_ROOT, ROOT, finished, send
from hostile.trials import HANG_S, TRIES, alone, difference, remove, wait_until

# Elements of 4 mm and 2000 steps: some tenths of a second on idle processors.
CASE = """\
title = "shared"

[plate]
element_size_m = 4e-3

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
# The statics take seconds, by the leader alone or shared; the event few steps.
SLOW_STATICS = {
    "direct": ("--set", "plate.element_size_m=5e-4", "--set", "loading.solver=direct"),
    "petsc": ("--set", "plate.element_size_m=5e-4", "--set", "loading.solver=petsc"),
}
# What mpirun, and not the program, says; it names the program's node before what its libraries tell.
OF_MPIRUN = re.compile(
    r"^(-{10,}|mpirun|\[|Primary job|a non-zero exit|the job to be terminated|\s*(Process name|Exit code):"
    r"|MPI_ABORT|with errorcode|NOTE: invoking|You may or may not|exactly when|$)"
)


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
            result = mpirun(2, "run", case, "-o", folder, "-q")
            assert result.returncode == 0, result.stderr
        return folder

    return results


def own_lines(result):
    """Lines on standard error that are not mpirun's."""
    return [line for line in result.stderr.splitlines() if not OF_MPIRUN.match(line)]


def one_line(result, code):
    """The only line of a run that ended with this code."""
    lines = own_lines(result)
    assert result.returncode == code, (result.returncode, result.stderr)
    assert len(lines) == 1, result.stderr
    return lines[0]


def wait_until_or_over(condition, process):
    wait_until(lambda: process.poll() is not None or condition())


def met(mpirun, condition, *arguments):
    """A run of two processes once a condition holds, and its own; again where it was over before. It may be
    over by the time that something is done to it."""
    for _ in range(TRIES):
        process = mpirun.start(
            2, "run", *arguments, "-o", "out", "-q", stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        wait_until_or_over(condition, process)
        pids = mpirun.processes()
        if len(pids) == 2:
            return process, pids
        result = finished(process)
        assert result.returncode == 0, result.stderr
        remove(mpirun.folder / "out")
    pytest.fail("over too soon, each time")


def in_event(mpirun, case):
    """It has kept a checkpoint of its event."""
    state = mpirun.folder / "out/unfinished/state"
    return met(mpirun, lambda: any(state.glob("checkpoint-*.bin")), case, *OFTEN)


def in_statics(mpirun, case, solver="direct"):
    settings = (*SLOW_STATICS[solver], "--set", "time.end_s=2e-5")
    return met(mpirun, (mpirun.folder / "out/unfinished/run.json").exists, case, *settings)


def interrupted_line(result):
    """The only line of a run that SIGTERM has ended; none where it was done before."""
    return one_line(result, 128 + signal.SIGTERM) if result.returncode else ""


def require_killed(result, pids):
    """Or done before; no process is left in any case."""
    assert result.returncode in (0, 128 + signal.SIGKILL), result.stderr
    assert not own_lines(result)
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
    result = mpirun(2, "run", "--restart", "out", "-q")
    assert result.returncode == 0, result.stderr
    assert not own_lines(result)
    require_undisturbed(mpirun, case, undisturbed)


def require_undisturbed(mpirun, case, undisturbed):
    """A run that was not stopped: every file, bit for bit."""
    assert not difference(alone(mpirun.folder / "out"), alone(undisturbed(mpirun, case)))


def require_no_core(folder):
    assert not list(folder.rglob("core*"))


# --- Command lines and cases


def test_one_process_answers(mpirun):
    result = mpirun(2, "--version")
    assert result.returncode == 0
    assert result.stdout == mpirun.alone("--version").stdout
    assert not own_lines(result)


@pytest.mark.parametrize("command", [["validate", "case.toml"], ["sweep", "case.toml"]])
def test_other_commands_are_refused(mpirun, case, command):
    result = mpirun(2, *command)
    assert f"start {command[0]} alone" in one_line(result, 2)
    assert result.stdout == ""


@pytest.mark.parametrize(
    "n, setting, told",
    [
        (2, "plate.sids=free", "did you mean plate.sides?"),
        (4, "title=x", "choose at most 2"),
    ],
)
def test_refused_cases(mpirun, case, tmp_path, n, setting, told):
    result = mpirun(n, "run", case, "-o", "out", "--set", setting, "--state-dir", "states")
    assert told in one_line(result, 2)
    # Before the statics, which would have been kept.
    assert sorted(p.name for p in tmp_path.iterdir()) == ["case.toml"]


def test_blow_up(mpirun, case, tmp_path):
    unstable = ("--set", "time.allow_unstable=true", "--set", "time.step_factor=1.4")
    result = mpirun(2, "run", case, "-o", "out", "-q", *unstable)
    assert "results are in out/unfinished" in one_line(result, 3)
    assert (tmp_path / "out/unfinished/run.json").is_file()


def test_different_programs(mpirun, case, tmp_path):
    other = tmp_path / "other"
    shutil.copy(mpirun.program, other)
    with other.open("ab") as file:
        file.write(b"another build")
    process = mpirun.start(
        2,
        *("run", case, "-o", "out"),
        programs=[[mpirun.program], [other]],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    line = one_line(finished(process), 2)
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
    process = mpirun.start(
        2,
        *with_table,
        programs=[["-wdir", folder, mpirun.program] for folder in (leader, other)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    result = finished(process)
    assert result.returncode == 0, result.stderr
    assert not list(other.iterdir())
    assert mpirun.alone(*with_table).returncode == 0
    for name in ("interface.h5", "fields.vtkhdf", "fronts.csv", "static.csv"):
        assert (leader / "out" / name).read_bytes() == (tmp_path / "out" / name).read_bytes(), name


# --- Processes that die


@pytest.mark.parametrize("rank", [0, 1])
def test_killed_in_the_event(mpirun, case, undisturbed, rank):
    process, pids = in_event(mpirun, case)
    send(pids[rank], signal.SIGKILL)
    require_killed(finished(process), pids)
    require_no_core(mpirun.folder)
    require_goes_on(mpirun, case, undisturbed)


@pytest.mark.parametrize("solver, rank", [("direct", 0), ("petsc", 1)])
def test_killed_in_the_statics(mpirun, case, rank, solver):
    process, pids = in_statics(mpirun, case, solver)
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
        assert "results are in out/unfinished" in line
        assert "--restart out" in line
    require_goes_on(mpirun, case, undisturbed)


@pytest.mark.parametrize("solver", SLOW_STATICS)
def test_interrupted_leader_in_the_statics(mpirun, case, solver):
    process, pids = in_statics(mpirun, case, solver)
    send(pids[0], signal.SIGTERM)
    if line := interrupted_line(finished(process)):
        assert "interrupted" in line


def test_checkpoint_on_request(mpirun, case, undisturbed):
    """Again where it was over before it was asked."""
    state = mpirun.folder / "out/unfinished/state"
    for _ in range(TRIES):
        process = mpirun.start(2, "run", case, "-o", "out", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        wait_until_or_over((state / "history.raw").exists, process)
        process.send_signal(signal.SIGUSR1)
        result = finished(process)
        assert result.returncode == 0, result.stderr
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
    subprocess.run(
        ["cc", "-shared", "-fPIC", ROOT / "tests/hostile/fault.c", "-o", library, "-ldl"], check=True
    )
    return library


def test_full_disk(mpirun, case, undisturbed, tmp_path, fault_library):
    settings = {"FAULT_BELOW": tmp_path / "out", "FAULT_AT": 200, "FAULT_MODE": "on", "FAULT_ERROR": 28}
    options = [text for name, value in settings.items() for text in ("-x", f"{name}={value}")]
    process = mpirun.start(
        2,
        *("run", case, "-o", "out", "-q", *OFTEN),
        starter=["-x", f"LD_PRELOAD={fault_library}", *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    line = one_line(finished(process), 1)
    assert "No space left on device" in line
    assert "--restart out" in line
    require_goes_on(mpirun, case, undisturbed)


def test_limit_of_file_sizes(mpirun, case, undisturbed):
    """It is below that of the files by which MPI shares memory, too."""
    limited = ["bash", "-c", 'ulimit -f 16; exec "$0" "$@"', mpirun.program]
    command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", "2", *limited]
    result = subprocess.run(
        [*map(str, command), "run", case, "-o", "out", "-q", *OFTEN],
        cwd=mpirun.folder,
        env=os.environ | AS_ROOT,
        capture_output=True,
        text=True,
        timeout=HANG_S,
    )
    assert result.returncode == 1
    assert "(File too large)" in result.stderr
    assert "--restart out" in result.stderr
    require_goes_on(mpirun, case, undisturbed)


# --- fields.vtkhdf, which all processes write


def fails_in_fields(mpirun, fault_library, case, rank, at, mode):
    """A run of two processes, of which one cannot write fields.vtkhdf from a call of the system on."""
    settings = {
        "LD_PRELOAD": fault_library,
        "FAULT_BELOW": mpirun.folder / "out/unfinished/fields.vtkhdf",
        "FAULT_AT": at,
        "FAULT_MODE": mode,
        "FAULT_ERROR": 28,
    }
    programs = [[mpirun.program], [mpirun.program]]
    programs[rank] = ["env", *(f"{name}={value}" for name, value in settings.items()), mpirun.program]
    process = mpirun.start(
        *(2, "run", case, "-o", "out", "-q", *OFTEN),
        programs=programs,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    return finished(process)


# Each process writes some 25 times, the leader after it has made the file.
@pytest.mark.parametrize(("rank", "at"), [(0, 1), (0, 40), (1, 1), (1, 24)])
def test_fields_that_one_process_cannot_write(mpirun, fault_library, case, undisturbed, rank, at):
    line = one_line(fails_in_fields(mpirun, fault_library, case, rank, at, "on"), 1)
    assert "fields.vtkhdf: cannot " in line
    assert ("process 1: " in line) == (rank == 1)
    assert "--restart out" in line
    require_goes_on(mpirun, case, undisturbed)


@pytest.mark.parametrize(("rank", "at"), [(0, 20), (1, 10)])
def test_killed_while_fields_are_written(mpirun, fault_library, case, undisturbed, rank, at):
    result = fails_in_fields(mpirun, fault_library, case, rank, at, "kill")
    assert result.returncode == 128 + signal.SIGKILL
    assert not own_lines(result)
    require_goes_on(mpirun, case, undisturbed)


OTHERS_DO_NOT_SEE = (
    "note: fields.vtkhdf is written by process 0 alone: others do not see out, or cannot write there"
)


def test_folder_that_others_do_not_see(mpirun, case, undisturbed):
    """As on machines without a common file system: the leader writes all files."""
    if subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode != 0:
        pytest.skip("no file system can be mounted here")
    folder = mpirun.folder / "out"
    folder.mkdir()
    elsewhere = f'mount -t tmpfs none {folder} && exec "$0" "$@"'
    process = mpirun.start(
        *(2, "run", case, "-o", "out"),
        programs=[[mpirun.program], ["unshare", "-m", "bash", "-c", elsewhere, mpirun.program]],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    result = finished(process)
    assert result.returncode == 0, result.stderr
    assert OTHERS_DO_NOT_SEE in result.stderr
    require_undisturbed(mpirun, case, undisturbed)


# The other process sees the files of the leader, and not the other way round, or cannot write there.
@pytest.mark.parametrize(
    "view",
    [
        "mount -t tmpfs none {own} && mkdir {own}/up {own}/work &&"
        " mount -t overlay none -o lowerdir={out},upperdir={own}/up,workdir={own}/work {out}",
        "mount --bind {out} {out} && mount -o remount,ro,bind {out}",
    ],
    ids=["overlay", "read-only"],
)
def test_folder_that_others_see_otherwise(mpirun, case, undisturbed, tmp_path, view):
    folder, own = mpirun.folder / "out", tmp_path / "own"
    folder.mkdir()
    own.mkdir()
    script = view.format(out=folder, own=own)
    if subprocess.run(["unshare", "-m", "bash", "-c", script], capture_output=True).returncode != 0:
        pytest.skip("no such file system can be mounted here")
    process = mpirun.start(
        *(2, "run", case, "-o", "out"),
        programs=[
            [mpirun.program],
            ["unshare", "-m", "bash", "-c", script + ' && exec "$0" "$@"', mpirun.program],
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    result = finished(process)
    assert result.returncode == 0, result.stderr
    assert OTHERS_DO_NOT_SEE in result.stderr
    require_undisturbed(mpirun, case, undisturbed)


@pytest.mark.parametrize("out", ["closed", "full"])
def test_output_that_nobody_takes(mpirun, case, undisturbed, out):
    """What one process prints of its run may be lost, too."""
    with open("/dev/full", "w") as full:
        process = mpirun.start(
            2,
            *("run", case, "-o", "out"),
            stdout=full,
            stderr=subprocess.PIPE,
            preexec_fn=(lambda: os.close(1)) if out == "closed" else None,
        )
        result = finished(process)
    assert result.returncode == 0, result.stderr
    require_undisturbed(mpirun, case, undisturbed)


@pytest.mark.parametrize(
    "rank, code, told",
    [
        # The limit may come before the statics ask how much memory there is, or after.
        (0, 2, "out of memory in the static solution|needs about .* GB of memory, .* are available"),
        (1, 1, "process 1: not enough memory"),
    ],
)
def test_no_memory(mpirun, case, rank, code, told):
    process, pids = in_statics(mpirun, case)
    with contextlib.suppress(OSError):  # it has ended meanwhile
        pages = int(Path(f"/proc/{pids[rank]}/statm").read_text().split()[0])
        limit = pages * resource.getpagesize()
        resource.prlimit(pids[rank], resource.RLIMIT_AS, (limit, limit))
    result = finished(process)
    if result.returncode != 0:
        assert re.search(told, one_line(result, code))
    require_ended(pids.values())
    require_no_core(mpirun.folder)
