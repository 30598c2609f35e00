# SPDX-License-Identifier: BSD-3-Clause
"""One point, run by the program in a process of its own. What happens here happens on a worker, perhaps of
another machine, which shares the sweep's folder."""

from __future__ import annotations

import shutil
import signal
import subprocess
import time
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
    folder: Path
    stop: Path  # a file that asks to stop when it is there
    point: Point
    keep: str

    @property
    def place(self) -> Path:
        return places.place_of(self.folder, self.point)

    @property
    def command(self) -> list[str]:
        """Begins a run, or goes on with one that has come as far as its case."""
        begun = exists(self.place / UNFINISHED / places.CASE)
        how = ["--restart", str(self.place)] if begun else ["--overwrite", "-o", str(self.place)]
        settings = with_settings(self.settings + self.point.settings())
        run = [self.program, "run", self.case, *settings, *how, "--threads", "1", "--quiet"]
        # Asked to stop when its worker is killed, where the system can do that.
        setpriv = shutil.which("setpriv")
        parent = [setpriv, "--pdeathsig", "TERM"] if setpriv else []
        return [*parent, *run, "--state-dir", str(self.folder / places.STATES)]


@dataclass(frozen=True)
class Outcome:
    point: Point
    status: str  # DONE, FAILED, STOPPED
    message: str = ""


def finish(process: subprocess.Popen[str], stop: Path) -> tuple[int, str]:
    """Waits for a run; asks it to stop where that is wanted. Returns its exit code and its last line."""
    asked_at = None
    while True:
        try:
            _, errors = process.communicate(timeout=LOOK_EVERY_S)
            return process.returncode, last_line(errors)
        except subprocess.TimeoutExpired:
            pass
        if asked_at is None and exists(stop):
            asked_at = time.monotonic()
            process.terminate()
        elif asked_at is not None and time.monotonic() - asked_at > PATIENCE_S:
            process.kill()


def outcome_of(code: int, message: str, point: Point, stop_wanted: bool) -> Outcome:
    if code == 0:
        return Outcome(point, DONE)
    ended_by = -code if code < 0 else code - SIGNALLED
    if stop_wanted and ended_by in (signal.SIGTERM, signal.SIGKILL):
        return Outcome(point, STOPPED)
    if code < 0:
        hint = ", perhaps for want of memory" if -code == signal.SIGKILL else ""
        message = f"the program was ended by {signal.Signals(-code).name}{hint}"
    return Outcome(point, FAILED, message)


def run_program(task: Task) -> Outcome:
    process = subprocess.Popen(
        task.command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,  # Ctrl-C is the sweep's
    )
    try:
        code, message = finish(process, task.stop)
    except BaseException:
        process.terminate()
        process.wait()
        raise
    return outcome_of(code, message, task.point, exists(task.stop))


def run_point(task: Task) -> Outcome:
    """Runs a point, goes on with it, or finds it done. Errors are told by the outcome."""
    try:
        if exists(task.stop):
            return Outcome(task.point, STOPPED)
        if places.is_done(task.folder, task.point):
            outcome = Outcome(task.point, DONE)
        elif reason := places.blew_up(task.place):
            outcome = Outcome(task.point, FAILED, reason)
        else:
            outcome = run_program(task)
        if outcome.status == DONE and task.keep == "tables":
            places.thin_out(task.place)
    except (DataError, OSError) as error:
        outcome = Outcome(task.point, FAILED, str(error))
    return outcome
