# SPDX-License-Identifier: BSD-3-Clause
"""Points to workers and their outcomes back: Dask's scheduler, on this machine or any that it is told of."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from slipfront.files import DataError, one_line
from slipfront.sweep.work import DONE, FAILED, STOPPED, Outcome, Task, run_point

ANSWER_S = 30  # of a scheduler elsewhere
SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Stop:
    """Asks the workers to stop, by a file that all of them see."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.is_interrupt = False
        self.forget()

    def ask(self) -> None:
        self.file.touch()

    def forget(self) -> None:
        self.file.unlink(missing_ok=True)

    def on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self.is_interrupt = True
        self.ask()


@contextmanager
def catching(stop: Stop) -> Iterator[None]:
    """Signals ask to stop while this lasts; a thread other than the first one gets none."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    wanted = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]  # as under nohup
    before = {number: signal.signal(number, stop.on_signal) for number in wanted}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def ignore_interrupts() -> None:
    """In a worker of this machine: a terminal sends Ctrl-C to it, too."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def client_of(scheduler: str | None, workers: int) -> Iterator[Any]:
    """A Dask client of a scheduler elsewhere, or of as many local processes as there are workers."""
    import dask
    from distributed import Client, LocalCluster

    dask.config.set({"distributed.worker.daemon": True, "distributed.admin.log-format": "%(message)s"})
    with ExitStack() as stack:
        try:
            if scheduler is None:
                cluster = stack.enter_context(
                    LocalCluster(
                        n_workers=workers,
                        threads_per_worker=1,
                        processes=True,
                        dashboard_address="127.0.0.1:0",
                        memory_limit=0,  # the runs' own processes have the memory
                        silence_logs=50,
                    )
                )
                client = stack.enter_context(Client(cluster))
                client.run(ignore_interrupts)
            else:
                client = stack.enter_context(Client(scheduler, timeout=ANSWER_S))
        except (OSError, TimeoutError, ValueError) as error:
            where = scheduler or "local workers"
            raise DataError(f"{where}: no Dask scheduler answers: {error}") from None
        except RuntimeError as error:  # a worker begins by importing the script that started it
            hint = "a script calls a sweep under `if __name__ == '__main__':`"
            raise DataError(f"local workers do not start ({one_line(str(error))}); {hint}") from None
        yield client


def outcomes(tasks: list[Task], scheduler: str | None, workers: int) -> Iterator[Outcome]:
    """Of each task, in the order in which they end."""
    from distributed import as_completed

    with client_of(scheduler, workers) as client:
        futures = client.map(run_point, tasks, pure=False)
        for future in as_completed(futures):
            error = future.exception()
            if error is None:
                yield future.result()
            else:
                yield Outcome(tasks[futures.index(future)].point.name, FAILED, f"its worker ended: {error}")


def one_by_one(tasks: list[Task]) -> Iterator[Outcome]:
    """In this process, without Dask: a share of a job array."""
    yield from map(run_point, tasks)


def run_all(
    found: Iterator[Outcome],
    stop: Stop,
    most_failures: int | None,
    tell: Callable[[int, int], None],
) -> list[Outcome]:
    """Outcomes of all points; none is begun any more once so many have failed."""
    done: list[Outcome] = []
    n_failed = 0
    with catching(stop):
        for outcome in found:
            done.append(outcome)
            n_failed += outcome.status == FAILED
            tell(sum(o.status != STOPPED for o in done), n_failed)
            if most_failures is not None and n_failed >= most_failures:
                stop.ask()
    return done


def default_workers() -> int:
    return len(os.sched_getaffinity(0))


__all__ = ["DONE", "FAILED", "STOPPED", "Stop", "default_workers", "one_by_one", "outcomes", "run_all"]
