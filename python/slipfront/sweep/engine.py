# SPDX-License-Identifier: BSD-3-Clause
"""Points run by the program, each in a process of its own: some at a time on this machine, or by workers of
Dask, perhaps of other machines, which share the sweep's folder."""

from __future__ import annotations

import logging
import os
import shutil
import signal
import subprocess
import threading
import time
from collections.abc import Generator, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from slipfront.files import DataError, exists
from slipfront.folder import UNFINISHED
from slipfront.program import last_line, with_settings
from slipfront.sweep import folder as places
from slipfront.sweep.points import Point

LOOK_EVERY_S = 0.05
PATIENCE_S = 60  # of a run that is asked to stop, until it is ended
ANSWER_S = 30  # of a scheduler elsewhere
SIGNALLED = 128
SIGNALS = (signal.SIGINT, signal.SIGTERM)
DONE, FAILED, STOPPED = "done", "failed", "stopped"


@dataclass(frozen=True)
class Outcome:
    point: Point
    status: str  # DONE, FAILED, STOPPED
    message: str = ""


Outcomes = Generator[Outcome, None, None]


@dataclass(frozen=True)
class Task:
    """What a worker needs to know of a point; paths are the same on all machines."""

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


def run_program(task: Task) -> Outcome:
    """Waits for the program, and asks it to stop where that is wanted."""
    quiet: Any = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    # In a session of its own: Ctrl-C is the sweep's.
    process = subprocess.Popen(
        task.command, **quiet, encoding="utf-8", errors="replace", start_new_session=True
    )
    asked_at, errors = None, None
    try:
        while errors is None:
            try:
                _, errors = process.communicate(timeout=LOOK_EVERY_S)
            except subprocess.TimeoutExpired:
                if asked_at is None and exists(task.stop):
                    asked_at = time.monotonic()
                    process.terminate()
                elif asked_at is not None and time.monotonic() - asked_at > PATIENCE_S:
                    process.kill()
    except BaseException:
        process.terminate()
        process.wait()
        raise
    code = process.returncode
    if code == 0:
        return Outcome(task.point, DONE)
    ended_by = -code if code < 0 else code - SIGNALLED
    if exists(task.stop) and ended_by in (signal.SIGTERM, signal.SIGKILL):
        return Outcome(task.point, STOPPED)
    if code > 0:
        return Outcome(task.point, FAILED, last_line(errors))
    hint = ", perhaps for want of memory" if ended_by == signal.SIGKILL else ""
    return Outcome(task.point, FAILED, f"the program was ended by {signal.Signals(ended_by).name}{hint}")


@contextmanager
def stoppable(stop: Path) -> Iterator[threading.Event]:
    """While this lasts signals make the file that asks the workers to stop, and set the event; a thread other
    than the first one gets none."""
    asked = threading.Event()

    def ask(*_: Any) -> None:
        asked.set()
        stop.touch()

    is_first = threading.current_thread() is threading.main_thread()
    wanted = [n for n in SIGNALS if is_first and signal.getsignal(n) != signal.SIG_IGN]  # nohup
    stop.unlink(missing_ok=True)
    before = {number: signal.signal(number, ask) for number in wanted}
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        stop.unlink(missing_ok=True)


def outcomes(tasks: list[Task], workers: int, scheduler: str | None) -> Outcomes:
    """Of each task, in the order in which they end."""
    return (
        side_by_side(tasks, min(workers, len(tasks))) if scheduler is None else by_scheduler(tasks, scheduler)
    )


def side_by_side(tasks: list[Task], workers: int) -> Outcomes:
    """A thread waits for each run. Where nobody asks for more the runs are stopped."""
    with ThreadPoolExecutor(workers) as pool:
        try:
            for future in as_completed([pool.submit(run_point, task) for task in tasks]):
                yield future.result()
        except BaseException:
            tasks[0].stop.touch()
            raise


def by_scheduler(tasks: list[Task], scheduler: str) -> Outcomes:
    """Of a scheduler of Dask elsewhere, which tries a task again whose worker has died."""
    import dask
    from distributed import Client, as_completed

    dask.config.set({"distributed.admin.log-format": "%(message)s"})
    try:
        client = Client(scheduler, timeout=ANSWER_S)
    except (OSError, TimeoutError, ValueError) as error:
        raise DataError(f"{scheduler}: no Dask scheduler answers: {error}") from None
    with client:
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # the message is ours
        futures = client.map(run_point, tasks, pure=False)
        for future in as_completed(futures):
            if future.status == "finished":
                yield future.result()
                continue
            gone = future.cancelled()
            told = "the Dask scheduler is gone" if gone else f"its worker ended: {future.exception()}"
            yield Outcome(tasks[futures.index(future)].point, FAILED, told)


def default_workers() -> int:
    return len(os.sched_getaffinity(0))
