# SPDX-License-Identifier: BSD-3-Clause
"""One point, run by the program in a process of its own. What happens here happens on a worker, perhaps of
another machine, which shares the sweep's folder."""

from __future__ import annotations

import shutil
import signal
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from slipfront.files import DataError, exists
from slipfront.folder import UNFINISHED
from slipfront.sweep import folder as places
from slipfront.sweep.points import Point
from slipfront.sweep.program import last_line, with_settings

LOOK_EVERY_S = 0.05
PATIENCE_S = 60  # of a run that is asked to stop, until it is ended
SIGNALLED = 128
DONE, FAILED, STOPPED = "done", "failed", "stopped"


@dataclass(frozen=True)
class Task:
    """What a worker needs to know; paths are the same on all machines."""

    program: str
    case: str
    settings: list[str]  # of all points
    folder: str
    stop: str  # a file that asks to stop when it is there
    point: Point
    keep: str


@dataclass(frozen=True)
class Outcome:
    name: str
    status: str  # DONE, FAILED, STOPPED
    message: str = ""
    wall_s: float = 0


def begun_with_parent(arguments: list[str]) -> list[str]:
    """The command, asked to stop when its worker is killed, where the system can do that."""
    setpriv = shutil.which("setpriv")
    return [setpriv, "--pdeathsig", "TERM", *arguments] if setpriv else arguments


def command_of(task: Task) -> list[str]:
    """Begins a run, or goes on with one that has come as far as its case."""
    place = places.place_of(Path(task.folder), task.point)
    begun = exists(place / UNFINISHED / places.CASE)
    how = ["--restart", str(place)] if begun else ["--overwrite", "-o", str(place)]
    states = str(Path(task.folder) / places.STATES)
    return begun_with_parent(
        [task.program, "run", task.case, *with_settings(task.settings + task.point.settings()), *how,
         "--threads", "1", "--quiet", "--state-dir", states]
    )  # fmt: skip


def is_stop_wanted(task: Task) -> bool:
    return exists(Path(task.stop))


def finish(process: subprocess.Popen[str], task: Task) -> tuple[int, str]:
    """Waits for a run; asks it to stop where that is wanted. Returns its exit code and its last line."""
    asked_at = None
    while True:
        try:
            _, errors = process.communicate(timeout=LOOK_EVERY_S)
            return process.returncode, last_line(errors)
        except subprocess.TimeoutExpired:
            pass
        if asked_at is None and is_stop_wanted(task):
            asked_at = time.monotonic()
            process.terminate()
        elif asked_at is not None and time.monotonic() - asked_at > PATIENCE_S:
            process.kill()


def outcome_of(code: int, message: str, point: Point, stop_wanted: bool, wall_s: float) -> Outcome:
    ended_by = -code if code < 0 else code - SIGNALLED
    if code == 0:
        return Outcome(point.name, DONE, wall_s=wall_s)
    if stop_wanted and ended_by in (signal.SIGTERM, signal.SIGKILL):
        return Outcome(point.name, STOPPED)
    if code < 0:
        name = signal.Signals(-code).name
        hint = ", perhaps for want of memory" if -code == signal.SIGKILL else ""
        return Outcome(point.name, FAILED, f"the program was ended by {name}{hint}", wall_s)
    return Outcome(point.name, FAILED, message, wall_s)


def run_program(task: Task) -> Outcome:
    start = time.monotonic()
    process = subprocess.Popen(
        command_of(task),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,  # Ctrl-C is the sweep's
    )
    try:
        code, message = finish(process, task)
    except BaseException:
        process.terminate()
        process.wait()
        raise
    return outcome_of(code, message, task.point, is_stop_wanted(task), time.monotonic() - start)


def run_point(task: Task) -> Outcome:
    """Runs a point, goes on with it, or finds it done. Errors are told by the outcome."""
    folder, point = Path(task.folder), task.point
    if is_stop_wanted(task):
        return Outcome(point.name, STOPPED)
    error = places.error_file(folder, point)
    try:
        if places.is_done(folder, point):
            outcome = Outcome(point.name, DONE)
        elif reason := places.blew_up(places.place_of(folder, point)):
            outcome = Outcome(point.name, FAILED, reason)
        else:
            outcome = run_program(task)
        if outcome.status == DONE and task.keep == "tables":
            places.thin_out(places.place_of(folder, point))
        if outcome.status == FAILED:
            places.write_whole(error, outcome.message + "\n")
        elif outcome.status == DONE:
            error.unlink(missing_ok=True)
    except (DataError, OSError) as reason:
        outcome = Outcome(point.name, FAILED, str(reason))
        with suppress(DataError):
            places.write_whole(error, str(reason) + "\n")
    return outcome
