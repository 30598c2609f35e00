# SPDX-License-Identifier: BSD-3-Clause
"""The same from Python: a sweep as a function that returns its table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr


def run(
    case: str | Path,
    vary: Mapping[str, Any],
    output: str | Path,
    *,
    set: Mapping[str, Any] | None = None,
    combine: str = "grid",
    samples: int = 0,
    seed: int = 0,
    keep: str = "all",
    workers: int | None = None,
    scheduler: str | None = None,
    stop_after_failures: int | None = None,
    quiet: bool = False,
) -> xr.Dataset:
    """Runs a case over values of its keys, goes on with a sweep that was begun, and returns its table.

    case: a case file. vary: by key a list of values, or a text as `--vary` takes it. set: keys of all points.
    combine: "grid", "zip", or with `samples` "sample". output: the sweep's folder. keep: "all" or "tables".
    workers: runs at a time (default: processors); scheduler: address of a Dask scheduler instead.
    Points that fail have a `message` and no numbers. SI units; attributes `units` and `long_name`.

    Raises DataError where the sweep is refused, KeyboardInterrupt where it was interrupted: the same call
    goes on.
    """
    from slipfront.sweep.definition import Sweep
    from slipfront.sweep.engine import default_workers
    from slipfront.sweep.sweeping import How, carry_out, told

    sweep = Sweep(
        case=Path(case),
        vary={
            key: list(v) if not isinstance(v, str) and hasattr(v, "__iter__") else v
            for key, v in vary.items()
        },
        set=dict(set or {}),
        combine="sample" if samples else combine,
        count=samples,
        seed=seed,
        keep=keep,
        stop_after_failures=stop_after_failures,
    )
    how = How(workers=workers or default_workers(), scheduler=scheduler, quiet=quiet)
    finished = carry_out(sweep, Path(output), how)
    if finished.is_interrupted:
        raise KeyboardInterrupt
    for line in told(finished):
        how.tell(line)
    return open_sweep(output)


def open_sweep(folder: str | Path) -> xr.Dataset:
    """The table of a sweep that is done, compared with its checksum. Raises DataError."""
    from slipfront.sweep.tables import read_dataset

    return read_dataset(Path(folder))
