# SPDX-License-Identifier: BSD-3-Clause
"""A sweep from its definition to its tables, or to a script for an array of Slurm jobs, each of which runs a
share of the points. Before the first run: whether all points are valid; memory, disk and time added up."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import sys
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm.auto import tqdm

from slipfront import command
from slipfront.files import DataError
from slipfront.program import GIGA, VARIABLE, Cost, answer, cost_of, with_settings
from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep
from slipfront.sweep.engine import DONE, FAILED, Outcome, Task, outcomes, stoppable
from slipfront.sweep.points import Point, text_of
from slipfront.sweep.tables import collect, table_lines

#: Keys on which size, memory and number of steps do not depend: one point's cost stands for all.
CHEAP = re.compile(r"(friction|event|fronts|contact)\..*|title|loading\.tilt_\w+_m")
TABLE_BYTES = 2e6  # of all tables of a run


@dataclass(frozen=True)
class Needs:
    """Of all points that are still to be run."""

    n_points: int
    n_at_once: int
    memory_bytes: float  # of the runs at a time
    disk_bytes: float
    time_s: float  # of all runs one after the other
    of_events: bool = False  # whether disk and time of a point may be those of one event of a sequence

    @property
    def words(self) -> str:
        time_s = self.time_s / max(self.n_at_once, 1)
        time = f"{time_s:.0f} s" if time_s < 100 else f"{time_s / 60:.0f} min"
        of_events = "; of a sequence time and disk are those of one event" if self.of_events else ""
        return (
            f"{self.n_points} runs, {self.n_at_once} at a time: about {time}, {self.memory_bytes / GIGA:.2g} "
            f"GB of memory, {self.disk_bytes / GIGA:.2g} GB on disk at most{of_events}"
        )


def refused(
    sweep: Sweep, program: Path, points: list[Point], quiet: bool
) -> Generator[tuple[Point, str], None, None]:
    """Points that the program refuses, each with its reason."""
    common = sweep.settings()

    def check(point: Point) -> str | None:
        try:
            answer(program, "validate", str(sweep.case), *with_settings(common + point.settings()))
        except DataError as error:
            return str(error)
        return None

    hidden = True if quiet else None  # None: where there is no terminal
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        answers = tqdm(pool.map(check, points), "checked", len(points), leave=False, disable=hidden)
        try:
            for point, problem in zip(points, answers, strict=True):
                if problem is not None:
                    yield point, problem
        finally:
            pool.shutdown(cancel_futures=True)


def require_valid(sweep: Sweep, program: Path, points: list[Point], quiet: bool) -> None:
    """Refuses the first point that the program refuses; none is run before all are checked."""
    with closing(refused(sweep, program, points, quiet)) as found:
        for point, problem in found:
            raise DataError(told_of(sweep, point, problem))


def told_of(sweep: Sweep, point: Point, problem: str) -> str:
    """What the program has against a point, with the line of the sweep's file that says so."""
    for table, settings in (("set", sweep.settings()), ("vary", point.settings())):
        for setting in settings:
            line = sweep.lines.get(f"{table}.{setting.split('=', 1)[0]}")
            before = f"--set {setting}: "
            if line and problem.startswith(before):
                return f"{line}: point {point.words}: {problem.removeprefix(before)}"
    return f"point {point.words}: {problem}"


def needs_of(sweep: Sweep, program: Path, points: list[Point], workers: int) -> Needs:
    known: dict[tuple[str, ...], Cost] = {}
    each = []
    for point in points:
        kind = tuple(text_of(value) for key, value in point.values.items() if not CHEAP.fullmatch(key))
        if kind not in known:
            known[kind] = cost_of(program, sweep.case, sweep.settings() + point.settings())
        each.append(known[kind])
    n = min(workers, len(points))
    disk = sorted((cost.disk_bytes for cost in each), reverse=True)
    return Needs(
        n_points=len(points),
        n_at_once=n,
        memory_bytes=n * max((cost.memory_bytes for cost in each), default=0),
        disk_bytes=sum(disk if sweep.keep == "all" else disk[:n]) + TABLE_BYTES * len(points),
        time_s=sum(cost.time_s for cost in each),
        of_events=any(cost.is_sequence for cost in each),
    )


def available_memory_bytes() -> float:
    """Of this machine, of a container what its limit leaves; infinite where nothing tells."""
    limits = [float("inf")]
    try:
        found = re.search(r"^MemAvailable:\s+(\d+) kB", Path("/proc/meminfo").read_text(), re.MULTILINE)
        limits.append(float(found[1]) * 1024 if found else float("inf"))
        group = Path("/sys/fs/cgroup")
        limit, used = ((group / f"memory.{name}").read_text() for name in ("max", "current"))
        limits.append(float(limit) - float(used))
    except (OSError, ValueError):
        pass
    return min(limits)


def require_memory(needs: Needs) -> None:
    """Refuses more runs at a time on this machine than its memory holds."""
    available = available_memory_bytes()
    if needs.memory_bytes <= available:
        return
    fit = int(available // (needs.memory_bytes / needs.n_at_once))
    how = f"--workers {fit}" if fit > 0 else "larger elements, or another machine"
    raise DataError(
        f"{needs.n_at_once} runs at a time need {needs.memory_bytes / GIGA:.3g} GB of memory, "
        f"{available / GIGA:.3g} GB are free: {how}"
    )


def require_disk(needs: Needs, folder: Path) -> None:
    place = next(place for place in (folder.resolve(), *folder.resolve().parents) if place.exists())
    free = shutil.disk_usage(place).free
    if needs.disk_bytes > free:
        raise DataError(
            f"{folder}: the sweep may need {needs.disk_bytes / GIGA:.3g} GB, {free / GIGA:.3g} GB are free: "
            'choose another folder, keep = "tables", fewer points, or longer output intervals'
        )


MOST_TOLD = 10  # failures that are listed

MOST_JOBS = 100
SPARE = 3  # times the expected time, since machines differ
LEAST_MINUTES = 10
MEGA = 1e6
WHAT = "a script of slipfront for Slurm"
WORKER_BYTES = 0.15 * GIGA  # of the sweep itself in a job

SLURM_MARK = "#!/bin/bash\n# An array of Slurm jobs by slipfront\n"  # of a script that may be replaced
SLURM_SCRIPT = """\
# {title}: {n_points} points in {n_jobs} shares. Submit with
#   sbatch {script}
# and when the array has ended go on (with points that a job did not come to, too):
#   {then}
#SBATCH --job-name=slipfront-sweep
#SBATCH --array=1-{n_jobs}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem={memory_mb}M
#SBATCH --time={minutes}
#SBATCH --output={log}
#SBATCH --signal=B:TERM@60
#SBATCH --requeue
export {variable}={program}
export PYTHONPATH={package}
# exec: Slurm's warning 60 s before the time is up is the sweep's; a job that runs again goes on.
exec {share}
"""


@dataclass(frozen=True)
class How:
    """How a sweep is carried out; no result depends on it."""

    workers: int
    scheduler: str | None = None
    share: tuple[int, int] | None = None  # the k-th of n, from 1
    quiet: bool = False
    say: Callable[[str], None] = print
    is_checked: bool = False  # whether points are known to be valid, and to have room
    has_tables: bool = True

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


def run_missing(folder: Path, tasks: list[Task], how: How) -> tuple[list[Outcome], bool]:
    """Outcomes of all tasks, and whether a signal has ended them. Why one has failed is kept beside it."""
    if not tasks:
        return [], False
    done = []
    hidden = True if how.quiet or sys.stderr is None else None  # None: where there is no terminal
    found = outcomes(tasks, how.workers, how.scheduler)
    with stoppable(tasks[0].stop) as asked, closing(found):
        for outcome in tqdm(found, "done", len(tasks), disable=hidden):
            done.append(outcome)
            file = places.error_file(folder, outcome.point)
            if outcome.status == FAILED:
                places.write_whole(file, outcome.message + "\n")
            elif outcome.status == DONE:
                file.unlink(missing_ok=True)
    return done, asked.is_set()


def carry_out(sweep: Sweep, folder: Path, how: How) -> Finished:
    """Runs what is missing, and makes the tables where nothing is left to be run.

    Raises DataError for what is refused; points that fail are told by the result."""
    program, identity = places.begun(sweep, folder)
    missing = missing_of(sweep, folder, how)
    if missing and not how.is_checked:
        check(sweep, folder, program, missing, how)
    with places.held(folder, shared=how.share is not None):
        places.write_definition(folder, sweep, identity)
        where, case = folder.resolve(), str(sweep.case.resolve())
        stop = where / ("stop" if how.share is None else "stop-{}-of-{}".format(*how.share))
        settings = sweep.settings()
        tasks = [Task(str(program), case, settings, where, stop, p, sweep.keep) for p in missing]
        ended, is_interrupted = run_missing(folder, tasks, how)
        table = None
        if how.has_tables and how.share is None and not is_interrupted:
            table = collect(folder, sweep, identity["program"])
            if (table.status == DONE).all():
                shutil.rmtree(folder / places.STATES, ignore_errors=True)
        return Finished(folder, ended, table, is_interrupted)


def array_script(sweep: Sweep, folder: Path, script: Path, then: Sequence[str] = ()) -> list[str]:
    """Checks all points, writes the folder's definition and the script; returns what to print.

    then: what is called when the array has ended, by default the sweep for its tables."""
    command.require_own(script, SLURM_MARK.encode(), WHAT)
    program, identity = places.begun(sweep, folder)
    points = sweep.points()
    require_valid(sweep, program, points, quiet=False)
    n_jobs = min(MOST_JOBS, len(points))
    needs = needs_of(sweep, program, points, n_jobs)
    require_disk(needs, folder)
    python = [sys.executable, "-m", "slipfront"]
    again = ["sweep", "--restart", str(folder.resolve())]
    package = shlex.quote(str(Path(__file__).resolve().parents[2]))
    text = SLURM_SCRIPT.format(
        title=sweep.case.name,
        n_points=len(points),
        n_jobs=n_jobs,
        script=script,
        then=f"PYTHONPATH={package} {shlex.join([*python, *(then or again)])}",
        memory_mb=int((needs.memory_bytes / n_jobs + WORKER_BYTES) / MEGA) + 1,
        minutes=max(LEAST_MINUTES, int(SPARE * needs.time_s / n_jobs / 60) + 1),
        log=shlex.quote(str(folder.resolve() / "slurm-%a.log")),
        variable=VARIABLE,
        program=shlex.quote(str(program)),
        package=package,
        share=f'{shlex.join([*python, *again])} --quiet --share "$SLURM_ARRAY_TASK_ID/{n_jobs}"',
    )
    with places.held(folder):
        places.write_definition(folder, sweep, identity)
    command.write_own(script, SLURM_MARK, text, WHAT)
    return [f"script: {script}, {n_jobs} jobs; submit it with sbatch"]
