# SPDX-License-Identifier: BSD-3-Clause
"""What a sweep will need, known before its first run: points checked, memory, disk and time added up."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from slipfront.files import DataError
from slipfront.sweep.definition import Sweep
from slipfront.sweep.points import Point
from slipfront.sweep.program import GIGA, Cost, cost_of, problem_of
from slipfront.sweep.values import text_of

#: Keys on which size, memory and number of steps do not depend: one point's cost stands for all.
CHEAP_TABLES = ("friction", "event", "fronts", "contact")
CHEAP_KEYS = ("title", "loading.tilt_left_m", "loading.tilt_right_m")
WORKER_BYTES = 0.15 * GIGA  # of a Dask worker beside its run
TABLE_BYTES = 4000.0  # of all tables of a run, by nodes of the interface
LEAST_BYTES = 1e5


@dataclass(frozen=True)
class Needs:
    """Of all points that are still to be run."""

    n_points: int
    memory_bytes: float  # of the largest run
    disk_bytes: float  # what stays, and what lies there while runs go
    expected_s: float  # of all runs one after the other

    def words(self, workers: int) -> str:
        time = duration_words(self.expected_s / min(workers, max(self.n_points, 1)))
        memory = min(workers, self.n_points) * self.memory_bytes / GIGA
        return (
            f"{self.n_points} runs, {min(workers, self.n_points)} at a time: about {time}, "
            f"{memory:.2g} GB of memory, {self.disk_bytes / GIGA:.2g} GB on disk at most"
        )


def duration_words(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 6000:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def matters(key: str) -> bool:
    return key not in CHEAP_KEYS and key.split(".")[0] not in CHEAP_TABLES


def first_problem(
    sweep: Sweep, program: Path, points: list[Point], tell: Callable[[int], None]
) -> tuple[Point, str] | None:
    """The first point that the program refuses, and why; none is run before all are checked."""
    common = sweep.settings()

    def check(point: Point) -> str | None:
        return problem_of(program, sweep.case, common + point.settings())

    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        answers = pool.map(check, points)
        try:
            for n, (point, problem) in enumerate(zip(points, answers, strict=True), start=1):
                tell(n)
                if problem is not None:
                    return point, problem
        finally:
            pool.shutdown(cancel_futures=True)
    return None


def require_valid(sweep: Sweep, program: Path, points: list[Point], tell: Callable[[int], None]) -> None:
    found = first_problem(sweep, program, points, tell)
    if found is not None:
        raise DataError(told_of(sweep, *found))


def told_of(sweep: Sweep, point: Point, problem: str) -> str:
    """What the program has against a point, with the line of the sweep's file that says so."""
    for table, settings in (("set", sweep.settings()), ("vary", point.settings())):
        for setting in settings:
            line = sweep.lines.get(f"{table}.{setting.split('=', 1)[0]}")
            before = f"--set {setting}: "
            if line and problem.startswith(before):
                return f"{line}: point {point.words}: {problem.removeprefix(before)}"
    return f"point {point.words}: {problem}"


def costs(sweep: Sweep, program: Path, points: Iterable[Point]) -> list[Cost]:
    """Of each point; asked once for those that can only cost the same. [points]"""
    known: dict[tuple[str, ...], Cost] = {}
    answers = []
    for point in points:
        key = tuple(text_of(value) for name, value in point.values.items() if matters(name))
        if key not in known:
            known[key] = cost_of(program, sweep.case, sweep.settings() + point.settings())
        answers.append(known[key])
    return answers


def kept_bytes(cost: Cost, keep: str) -> float:
    """What lies there of a run that is done."""
    return LEAST_BYTES + TABLE_BYTES * cost.n_nodes + (cost.result_bytes if keep == "all" else 0)


def needs_of(sweep: Sweep, program: Path, points: list[Point], workers: int) -> Needs:
    each = costs(sweep, program, points)
    kept = sum(kept_bytes(cost, sweep.keep) for cost in each)
    at_work = sum(sorted((cost.peak_disk_bytes for cost in each), reverse=True)[:workers])
    return Needs(
        n_points=len(points),
        memory_bytes=max((cost.memory_bytes for cost in each), default=0) + WORKER_BYTES,
        disk_bytes=kept + at_work,
        expected_s=sum(cost.expected_s for cost in each),
    )


def available_memory_bytes() -> float:
    """Of this machine, of a container what its limit leaves; infinite where nothing tells."""
    limits = [float("inf")]
    try:
        found = re.search(r"^MemAvailable:\s+(\d+) kB", Path("/proc/meminfo").read_text(), re.MULTILINE)
        if found:
            limits.append(float(found[1]) * 1024)
        group = Path("/sys/fs/cgroup")
        limits.append(
            float((group / "memory.max").read_text()) - float((group / "memory.current").read_text())
        )
    except (OSError, ValueError):
        pass
    return min(limits)


def require_memory(needs: Needs, workers: int) -> None:
    """Refuses more runs at a time on this machine than its memory holds."""
    available = available_memory_bytes()
    if min(workers, needs.n_points) * needs.memory_bytes <= available:
        return
    fit = int(available // needs.memory_bytes)
    how = f"--workers {fit}" if fit > 0 else "larger elements, or another machine"
    raise DataError(
        f"{workers} runs at a time need {workers * needs.memory_bytes / GIGA:.3g} GB of memory, "
        f"{available / GIGA:.3g} GB are free: {how}"
    )


def require_disk(needs: Needs, folder: Path) -> None:
    place = folder.resolve()
    while not place.exists():
        place = place.parent
    free = shutil.disk_usage(place).free
    if needs.disk_bytes > free:
        raise DataError(
            f"{folder}: the sweep may need {needs.disk_bytes / GIGA:.3g} GB, {free / GIGA:.3g} GB are free: "
            'choose another folder, keep = "tables", fewer points, or longer output intervals'
        )
