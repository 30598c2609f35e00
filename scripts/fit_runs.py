# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts that try `slipfront fit` share: a fit in a folder, and what its fit.json says."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from shared import DataError
from slipfront.fit.command import FIRST_A_KEY
from slipfront.fit.space import space_of
from slipfront.sweep.definition import Sweep
from slipfront.sweep.folder import LOCK
from slipfront.sweep.sweeping import How, carry_out

ROOT = Path(__file__).resolve().parents[1]
POSTERIOR = "posterior.csv"
RUNS = "runs"
WORKERS = 2  # runs, or fits, at a time


def first_runs(case: Path, free: Mapping[str, str], runs: Path) -> None:
    """Those over the whole ranges, which several fits share."""
    space = space_of(free)
    sweep = Sweep.of_points(case, space.points(space.sobol(FIRST_A_KEY * space.n)), {})
    carry_out(sweep, runs, How(WORKERS, quiet=True, has_tables=False))


def begin(folder: Path, runs: Path) -> None:
    """A fit's folder that has runs already."""
    folder.mkdir(parents=True)
    # Links, but for the lock: that of one fit would hold all.
    left_out = shutil.ignore_patterns(LOCK)
    shutil.copytree(runs, folder / RUNS, copy_function=os.link, ignore=left_out)


def fit(
    case: Path,
    records: Sequence[Path],
    free: Mapping[str, str],
    folder: Path,
    *options: str,
    first: Path | None = None,
) -> dict[str, Any]:
    """fit.json of a fit; one that ended is kept, one that did not begins anew, with the runs of `first`.
    Of its runs only what it found is kept."""
    result = folder / "fit.json"
    if not result.exists() or (folder / RUNS).exists():
        shutil.rmtree(folder, ignore_errors=True)
        if first is not None:
            begin(folder, first)
        words = [str(case), *map(str, records), "-o", str(folder), "-q", *options]
        words += [word for key, text in free.items() for word in ("--free", f"{key}={text}")]
        here = os.environ | {"PYTHONPATH": str(ROOT / "python"), "OMP_NUM_THREADS": "1"}
        done = subprocess.run(
            [sys.executable, "-m", "slipfront", "fit", *words], capture_output=True, text=True, env=here
        )
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
            raise DataError(f"{folder}: {lines[-1]}")
        shutil.rmtree(folder / RUNS)
    found: dict[str, Any] = json.loads(result.read_text(encoding="utf-8"))
    return found


def share_of_range(found: Mapping[str, Any], key: str, values: Sequence[float]) -> np.ndarray:
    """Of values of a key, in the logarithm where its range is."""
    of = found["free"][key]
    space = space_of({key: f"{of['from']}:{of['to']}" + (":log" if of["is_log"] else "")})
    return space.shares(np.asarray(values)[:, None])[:, 0]


def width(found: Mapping[str, Any], key: str, level: int = 90) -> float:
    """Of an interval, over the range."""
    low, high = share_of_range(found, key, found["parameters"][key][f"interval_{level}"])
    return float(high - low)
