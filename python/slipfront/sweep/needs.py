# SPDX-License-Identifier: BSD-3-Clause
"""What is known before the first run: whether all points are valid, and memory, disk and time added up."""

from __future__ import annotations

import os
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tqdm.auto import tqdm

from slipfront.files import DataError
from slipfront.sweep.definition import Sweep
from slipfront.sweep.points import Point
from slipfront.sweep.program import GIGA, Cost, answer, cost_of, with_settings
from slipfront.sweep.values import text_of

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


def require_valid(sweep: Sweep, program: Path, points: list[Point], quiet: bool) -> None:
    """Refuses the first point that the program refuses; none is run before all are checked."""
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
        for point, problem in zip(points, answers, strict=True):
            if problem is not None:
                pool.shutdown(cancel_futures=True)
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
