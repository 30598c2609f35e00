# SPDX-License-Identifier: BSD-3-Clause
"""Points to workers and their outcomes back: Dask's scheduler, on this machine or any that it is told of."""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from slipfront.files import DataError, one_line
from slipfront.sweep.work import FAILED, Outcome, Task, run_point

ANSWER_S = 30  # of a scheduler elsewhere
SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Stop:
    """A file that asks the workers to stop, and whether a signal asked for it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.is_wanted = False

    def ask(self, *_: Any) -> None:
        self.is_wanted = True
        self.file.touch()

    @contextmanager
    def catching(self) -> Iterator[None]:
        """Signals ask to stop while this lasts; a thread other than the first one gets none."""
        wanted: list[signal.Signals] = []
        if threading.current_thread() is threading.main_thread():
            wanted = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]  # nohup
        self.file.unlink(missing_ok=True)
        before = {number: signal.signal(number, self.ask) for number in wanted}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
            self.file.unlink(missing_ok=True)


def ignore_interrupts() -> None:
    """In a worker of this machine: a terminal sends Ctrl-C to it, too."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def advice() -> str:
    """What to do where a local worker ends as it begins, by importing the script that started it."""
    script = sys.modules["__main__"]
    if getattr(script, "__file__", None) and script.__spec__ is None:
        return "a script calls a sweep under `if __name__ == '__main__':`"
    return "one has ended at its start: begin again, perhaps with fewer --workers"


@contextmanager
def client_of(scheduler: str | None, workers: int) -> Iterator[Any]:
    """A Dask client of a scheduler elsewhere, or of as many local processes as there are workers."""
    import dask
    from distributed import Client, LocalCluster

    dask.config.set({"distributed.worker.daemon": True, "distributed.admin.log-format": "%(message)s"})
    with ExitStack() as stack:
        try:
            if scheduler is None:
                cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address="127.0.0.1:0",
                    memory_limit=0,  # the runs' own processes have the memory
                    silence_logs=50,
                )
                client = stack.enter_context(Client(stack.enter_context(cluster)))
                client.run(ignore_interrupts)
            else:
                client = stack.enter_context(Client(scheduler, timeout=ANSWER_S))
                # The message is ours.
                logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        except (OSError, TimeoutError, ValueError) as error:
            where = scheduler or "local workers"
            raise DataError(f"{where}: no Dask scheduler answers: {error}") from None
        except RuntimeError as error:
            raise DataError(f"local workers do not start ({one_line(str(error))}); {advice()}") from None
        yield client


def outcomes(tasks: list[Task], scheduler: str | None, workers: int) -> Iterator[Outcome]:
    """Of each task, in the order in which they end. Dask tries a task again whose worker has died."""
    from distributed import as_completed

    with client_of(scheduler, workers) as client:
        futures = client.map(run_point, tasks, pure=False)
        for future in as_completed(futures):
            error = None if future.cancelled() else future.exception()
            if future.status == "finished":
                yield future.result()
            else:
                told = "the Dask scheduler is gone" if error is None else f"its worker ended: {error}"
                yield Outcome(tasks[futures.index(future)].point, FAILED, told)


def one_by_one(tasks: list[Task]) -> Iterator[Outcome]:
    """In this process, without Dask: a share of a job array."""
    yield from map(run_point, tasks)


def default_workers() -> int:
    return len(os.sched_getaffinity(0))
