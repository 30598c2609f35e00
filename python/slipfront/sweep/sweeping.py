# SPDX-License-Identifier: BSD-3-Clause
"""A sweep from its definition to its tables."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm.auto import tqdm

from slipfront.sweep import engine
from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep
from slipfront.sweep.needs import needs_of, require_disk, require_memory, require_valid
from slipfront.sweep.points import Point
from slipfront.sweep.program import find_program
from slipfront.sweep.tables import collect, table_lines
from slipfront.sweep.work import DONE, FAILED, Outcome, Task

MOST_TOLD = 10  # failures that are listed


@dataclass(frozen=True)
class How:
    """How a sweep is carried out; no result depends on it."""

    workers: int
    scheduler: str | None = None
    share: tuple[int, int] | None = None  # the k-th of n, from 1
    quiet: bool = False
    say: Callable[[str], None] = print

    def tell(self, line: str) -> None:
        if not self.quiet:
            self.say(line)


@dataclass(frozen=True)
class Finished:
    """How a sweep, or a share of one, ended."""

    folder: Path
    outcomes: list[Outcome]
    table: Any  # a DataFrame; None without tables
    is_interrupted: bool

    @property
    def failures(self) -> list[Outcome]:
        return [outcome for outcome in self.outcomes if outcome.status == FAILED]

    @property
    def n_left(self) -> int:
        return sum(outcome.status not in (DONE, FAILED) for outcome in self.outcomes)

    def told(self) -> list[str]:
        """What to print at the end."""
        lines = [] if self.table is None else table_lines(self.table, self.folder)
        failures = self.failures
        lines += [f"failed: {one.point.words}: {one.message}" for one in failures[:MOST_TOLD]]
        if len(failures) > MOST_TOLD:
            lines.append(f"and {len(failures) - MOST_TOLD} more; the tables list all")
        return lines if self.table is None else [*lines, f"results: {self.folder}"]


def missing_of(sweep: Sweep, folder: Path, how: How) -> list[Point]:
    """Points of this share that have no results yet; what is done is thinned out as `keep` says."""
    k, n = how.share or (1, 1)
    missing = []
    for point in sweep.points()[k - 1 :: n]:
        if not places.is_done(folder, point):
            missing.append(point)
        elif sweep.keep == "tables":
            places.thin_out(places.place_of(folder, point))
    return missing


def check(sweep: Sweep, folder: Path, program: Path, missing: list[Point], how: How) -> None:
    """Refuses a sweep before its first run, and says what it will take."""
    require_valid(sweep, program, missing, how.quiet)
    needs = needs_of(sweep, program, missing, how.workers)
    if how.scheduler is None:
        require_memory(needs)
    require_disk(needs, folder)
    how.tell(needs.words)


def run_missing(sweep: Sweep, folder: Path, tasks: list[Task], how: How) -> tuple[list[Outcome], bool]:
    """Outcomes of all tasks, and whether a signal has ended them. Why one has failed is kept beside it."""
    if not tasks:
        return [], False
    stop = engine.Stop(tasks[0].stop)
    if how.scheduler is not None:
        found = engine.by_scheduler(tasks, how.scheduler)
    else:
        found = engine.side_by_side(tasks, min(how.workers, len(tasks)))
    done = []
    hidden = True if how.quiet or sys.stderr is None else None  # None: where there is no terminal
    with stop.catching(), closing(found):
        for outcome in tqdm(found, "done", len(tasks), disable=hidden):
            done.append(outcome)
            file = places.error_file(folder, outcome.point)
            if outcome.status == FAILED:
                places.write_whole(file, outcome.message + "\n")
            elif outcome.status == DONE:
                file.unlink(missing_ok=True)
    return done, stop.is_wanted


def carry_out(sweep: Sweep, folder: Path, how: How) -> Finished:
    """Runs what is missing, and makes the tables where nothing is left to be run.

    Raises DataError for what is refused; points that fail are told by the result."""
    sweep.require_sound()
    program = find_program()
    identity = places.identity_of(sweep, program)
    places.require_usable(folder, sweep, identity)
    missing = missing_of(sweep, folder, how)
    if missing:
        check(sweep, folder, program, missing, how)
    with places.held(folder, shared=how.share is not None):
        places.write_definition(folder, sweep, identity)
        where, case = folder.resolve(), str(sweep.case.resolve())
        stop = where / ("stop" if how.share is None else "stop-{}-of-{}".format(*how.share))
        settings = sweep.settings()
        tasks = [Task(str(program), case, settings, where, stop, p, sweep.keep) for p in missing]
        outcomes, is_interrupted = run_missing(sweep, folder, tasks, how)
        table = None
        if how.share is None and not is_interrupted:
            table = collect(folder, sweep, identity["program"])
            if (table.status == DONE).all():
                shutil.rmtree(folder / places.STATES, ignore_errors=True)
        return Finished(folder, outcomes, table, is_interrupted)
