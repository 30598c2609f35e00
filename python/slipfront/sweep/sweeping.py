# SPDX-License-Identifier: BSD-3-Clause
"""A sweep from its definition to its tables."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from slipfront.sweep import engine
from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep, require_sound
from slipfront.sweep.glance import table_lines
from slipfront.sweep.needs import needs_of, require_disk, require_memory, require_valid
from slipfront.sweep.points import Point
from slipfront.sweep.program import find_program, key_facts
from slipfront.sweep.progress import Progress
from slipfront.sweep.tables import Row, collect
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
    """How a sweep, or a share of one, ended. `rows` are there where its tables are."""

    folder: Path
    rows: list[Row]
    n_done: int
    failures: list[tuple[str, str]]  # a point's words, and why
    n_left: int
    is_interrupted: bool


def tasks_of(sweep: Sweep, folder: Path, program: Path, points: list[Point], how: How) -> list[Task]:
    where = folder.resolve()
    case, stop = str(sweep.case.resolve()), str(places.stop_file(where, how.share))
    return [Task(str(program), case, sweep.settings(), str(where), stop, p, sweep.keep) for p in points]


def missing_of(sweep: Sweep, folder: Path, how: How) -> list[Point]:
    """Points of this share that have no results yet; what is done is thinned out as `keep` says."""
    points = sweep.points()
    if how.share is not None:
        k, n = how.share
        points = points[k - 1 :: n]
    missing = []
    for point in points:
        if not places.is_done(folder, point):
            missing.append(point)
        elif sweep.keep == "tables":
            places.thin_out(places.place_of(folder, point))
    return missing


def check(sweep: Sweep, folder: Path, program: Path, missing: list[Point], how: How) -> None:
    """Refuses a sweep before its first run, and says what it will take."""
    if not missing:
        return
    checking = Progress("checked", len(missing), how.quiet)
    require_valid(sweep, program, missing, checking.update)
    needs = needs_of(sweep, program, missing, how.workers)
    if how.scheduler is None:
        require_memory(needs, how.workers)
    require_disk(needs, folder)
    how.tell(needs.words(how.workers))


def run_missing(sweep: Sweep, folder: Path, tasks: list[Task], how: How) -> tuple[list[Outcome], bool]:
    stop = engine.Stop(places.stop_file(folder, how.share))
    progress = Progress("done", len(tasks), how.quiet)
    if how.share is not None or not tasks:
        found = engine.one_by_one(tasks)
    else:
        found = engine.outcomes(tasks, how.scheduler, min(how.workers, len(tasks)))
    try:
        outcomes = engine.run_all(found, stop, sweep.stop_after_failures, progress.update)
    finally:
        progress.close()
        stop.forget()
    return outcomes, stop.is_interrupt


def carry_out(sweep: Sweep, folder: Path, how: How) -> Finished:
    """Runs what is missing, and makes the tables where nothing is left to be run.

    Raises DataError for what is refused; points that fail are told by the result."""
    require_sound(sweep)
    program = find_program()
    identity = places.identity_of(sweep, program)
    places.require_usable(folder, sweep, identity)
    missing = missing_of(sweep, folder, how)
    check(sweep, folder, program, missing, how)
    with places.held(folder, shared=how.share is not None):
        places.write_definition(folder, sweep, identity)
        tasks = tasks_of(sweep, folder, program, missing, how)
        outcomes, is_interrupted = run_missing(sweep, folder, tasks, how)
        return ending(sweep, folder, program, how, outcomes, is_interrupted)


def ending(
    sweep: Sweep, folder: Path, program: Path, how: How, outcomes: list[Outcome], is_interrupted: bool
) -> Finished:
    words = {point.name: point.words for point in sweep.points()}
    failures = [(words[o.name], o.message) for o in outcomes if o.status == FAILED]
    n_done = sum(o.status == DONE for o in outcomes)
    n_left = len(outcomes) - n_done - len(failures)
    rows: list[Row] = []
    if how.share is None and not is_interrupted:
        rows = collect(folder, sweep, program, key_facts(program))
        if all(row.status == DONE for row in rows):
            shutil.rmtree(folder / places.STATES, ignore_errors=True)
    return Finished(folder, rows, n_done, failures, n_left, is_interrupted)


def told(finished: Finished) -> list[str]:
    """What to print at the end."""
    lines = table_lines(finished.rows, finished.folder)
    lines += [f"failed: {words}: {message}" for words, message in finished.failures[:MOST_TOLD]]
    if len(finished.failures) > MOST_TOLD:
        lines.append(f"and {len(finished.failures) - MOST_TOLD} more; the tables list all")
    if finished.n_left and not finished.is_interrupted:
        lines.append(f"{finished.n_left} points were not begun after {len(finished.failures)} failures")
    if finished.rows:
        lines.append(f"results: {finished.folder}")
    return lines
