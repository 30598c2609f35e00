# SPDX-License-Identifier: BSD-3-Clause
"""Points to runs at a time on this machine, or to the workers of Dask, and their outcomes back."""

from __future__ import annotations

import logging
import os
import signal
import threading
from collections.abc import Generator, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from slipfront.files import DataError
from slipfront.sweep.work import FAILED, Outcome, Task, run_point

ANSWER_S = 30  # of a scheduler elsewhere
SIGNALS = (signal.SIGINT, signal.SIGTERM)
Outcomes = Generator[Outcome, None, None]


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


@contextmanager
def client_of(scheduler: str) -> Iterator[Any]:
    """A Dask client of a scheduler elsewhere."""
    import dask
    from distributed import Client

    dask.config.set({"distributed.admin.log-format": "%(message)s"})
    try:
        client = Client(scheduler, timeout=ANSWER_S)
    except (OSError, TimeoutError, ValueError) as error:
        raise DataError(f"{scheduler}: no Dask scheduler answers: {error}") from None
    with client:
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # the message is ours
        yield client


def by_scheduler(tasks: list[Task], scheduler: str) -> Outcomes:
    """Of each task, in the order in which they end. Dask tries a task again whose worker has died."""
    from distributed import as_completed

    with client_of(scheduler) as client:
        futures = client.map(run_point, tasks, pure=False)
        for future in as_completed(futures):
            error = None if future.cancelled() else future.exception()
            if future.status == "finished":
                yield future.result()
            else:
                told = "the Dask scheduler is gone" if error is None else f"its worker ended: {error}"
                yield Outcome(tasks[futures.index(future)].point, FAILED, told)


def side_by_side(tasks: list[Task], workers: int) -> Outcomes:
    """Of each task, in the order in which they end; a thread waits for each run. Where nobody asks for more
    the runs are stopped."""
    with ThreadPoolExecutor(workers) as pool:
        try:
            for future in as_completed([pool.submit(run_point, task) for task in tasks]):
                yield future.result()
        except BaseException:
            tasks[0].stop.touch()
            raise


def default_workers() -> int:
    return len(os.sched_getaffinity(0))
