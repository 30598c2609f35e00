# SPDX-License-Identifier: BSD-3-Clause
"""The same from Python: a sweep as a function that returns its table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slipfront.errors import CaseError
from slipfront.given import flag, path, shown, table, text, whole

if TYPE_CHECKING:
    import xarray as xr


def plain(value: Any, key: str) -> Any:
    """A value, or a list of them, as a file of TOML could have it."""
    if hasattr(value, "__array__"):
        value = np.asarray(value).tolist()
    if isinstance(value, str | Path):
        return text(str(value), key)
    if isinstance(value, list | tuple | range):
        return [plain(each, key) for each in value]
    if isinstance(value, bool | int | float):
        return value
    raise CaseError(f"{key} is {shown(value)}: give numbers, texts, True, False, or a list of them")


def plain_table(given: Any, name: str) -> dict[str, Any]:
    return {text(key, f"a key of {name}"): plain(value, key) for key, value in table(given, name).items()}


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
    quiet: bool = False,
) -> xr.Dataset:
    """Runs a case over values of its keys, goes on with a sweep that was begun, and returns its table.

    case: a case file. vary: by key a list of values, or a text as `--vary` takes it. set: keys of all points.
    combine: "grid", "zip", or with `samples` "sample". output: the sweep's folder. keep: "all" or "tables".
    workers: runs at a time (default: processors); scheduler: address of a Dask scheduler instead.
    Points that fail have a `message` and no numbers. SI units; attributes `units` and `long_name`.

    Raises DataError where the sweep is refused, CaseError where an argument is none, KeyboardInterrupt where
    it was interrupted: the same call goes on.
    """
    from slipfront.sweep.definition import Sweep
    from slipfront.sweep.engine import default_workers
    from slipfront.sweep.sweeping import How, carry_out

    sweep = Sweep(
        case=path(case, "case"),
        vary=plain_table(vary, "vary"),
        set=plain_table({} if set is None else set, "set"),
        combine="sample" if whole(samples, "samples", least=0) else text(combine, "combine"),
        count=samples,
        seed=whole(seed, "seed", least=0),
        keep=text(keep, "keep"),
    )
    how = How(
        workers=default_workers() if workers is None else whole(workers, "workers", least=1),
        scheduler=None if scheduler is None else text(scheduler, "scheduler"),
        quiet=flag(quiet, "quiet"),
    )
    finished = carry_out(sweep, path(output, "output"), how)
    if finished.is_interrupted:
        raise KeyboardInterrupt
    for line in finished.told():
        how.tell(line)
    return open_sweep(output)


def open_sweep(folder: str | Path) -> xr.Dataset:
    """The table of a sweep that is done, compared with its checksum. Raises DataError."""
    from slipfront.sweep.tables import read_dataset

    return read_dataset(path(folder, "folder"))
