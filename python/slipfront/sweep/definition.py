# SPDX-License-Identifier: BSD-3-Clause
"""What a sweep is: its case, what varies, and what is kept. From a file SWEEP.toml or from the command line.

case = "left.toml"                    # path, relative to this file
combine = "grid"                      # all combinations; or "zip": first values together, second, ...
keep = "tables"                       # or "all": histories and snapshots, too
stop_after_failures = 10              # no new point is begun then

[set]                                 # of all points, beside what the case says
output.snapshot_times_s = []

[vary]
friction.mu_k = "0.4:1.2:9"           # from, to, count
friction.alpha_m2_per_s2 = [0.01, 0.03, 0.1]

[sample]                              # instead of combine: a Latin hypercube over ranges "FROM:TO[:log]"
count = 50
seed = 1
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from slipfront.files import DataError, exists, read_toml
from slipfront.sweep.points import Point, grid, sample, zipped
from slipfront.sweep.values import Value, range_of, text_of, values_of

COMBINATIONS = ("grid", "zip", "sample")
KEEPS = ("all", "tables")
ENTRIES = ("case", "combine", "keep", "stop_after_failures", "set", "vary", "sample")
SAMPLE_ENTRIES = ("count", "seed")


@dataclass(frozen=True)
class Sweep:
    """A sweep as it is asked for. `vary` has values, or for a sample the text of a range, by key."""

    case: Path
    vary: dict[str, Any]
    set: dict[str, Value] = field(default_factory=dict)
    combine: str = "grid"
    count: int = 0  # of a sample
    seed: int = 0
    keep: str = "all"
    stop_after_failures: int | None = None

    @property
    def keys(self) -> list[str]:
        return list(self.vary)

    def settings(self) -> list[str]:
        """Those of all points, as `--set` takes them."""
        return [f"{key}={text_of(value)}" for key, value in self.set.items()]

    def points(self) -> list[Point]:
        if self.combine == "sample":
            ranges = {key: range_of(key, str(text)) for key, text in self.vary.items()}
            return sample(ranges, self.count, self.seed)
        values = {key: values_of(key, spec) for key, spec in self.vary.items()}
        return zipped(values) if self.combine == "zip" else grid(values)


def require_sound(sweep: Sweep, place: str) -> Sweep:
    """Refuses what contradicts itself, before anything is run; keys and values are the program's to judge."""
    if not sweep.vary:
        raise DataError(f"{place}: nothing varies: name at least one key with its values")
    if sweep.combine not in COMBINATIONS:
        raise DataError(f"{place}: combine is one of {', '.join(COMBINATIONS)}, not '{sweep.combine}'")
    if sweep.keep not in KEEPS:
        raise DataError(f"{place}: keep is one of {', '.join(KEEPS)}, not '{sweep.keep}'")
    if sweep.stop_after_failures is not None and sweep.stop_after_failures < 1:
        raise DataError(f"{place}: stop_after_failures is a whole number from 1 on")
    if sweep.seed < 0:
        raise DataError(f"{place}: seed is a whole number from 0 on")
    for key in sweep.vary:
        if key in sweep.set:
            raise DataError(f"{place}: {key} both varies and is set")
    if not exists(sweep.case):
        raise DataError(f"{sweep.case}: No such file or directory")
    try:
        sweep.points()
    except DataError as error:
        raise DataError(f"{place}: {error}") from None
    return sweep


def flattened(table: dict[str, Any], before: str = "") -> dict[str, Any]:
    """Values of tables in tables by dotted keys."""
    flat: dict[str, Any] = {}
    for name, value in table.items():
        if isinstance(value, dict):
            flat |= flattened(value, f"{before}{name}.")
        else:
            flat[before + name] = value
    return flat


def require_entries(file: Path, table: dict[str, Any], known: tuple[str, ...], where: str) -> None:
    for name in table:
        if name not in known:
            raise DataError(f"{file}: unknown entry '{name}'{where}; known are {', '.join(known)}")


def inner_table(file: Path, table: dict[str, Any], name: str) -> dict[str, Any]:
    inner = table.get(name, {})
    if not isinstance(inner, dict):
        raise DataError(f"{file}: [{name}] is a table")
    return inner


def whole_number(file: Path, table: dict[str, Any], name: str, default: int | None) -> int | None:
    value = table.get(name, default)
    if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
        raise DataError(f"{file}: {name} is a whole number")
    return value


def is_sweep_file(file: Path) -> bool:
    """Whether a file of TOML is a sweep's, not a case: that has no entry `case` and no [vary]."""
    table = read_toml(file)
    return "case" in table or "vary" in table


def read_sweep(file: Path) -> Sweep:
    table = read_toml(file)
    require_entries(file, table, ENTRIES, "")
    of_sample = inner_table(file, table, "sample")
    require_entries(file, of_sample, SAMPLE_ENTRIES, " in [sample]")
    case = table.get("case")
    if not isinstance(case, str) or not case:
        raise DataError(f"{file}: case names the case file, relative to this one")
    if of_sample and "combine" in table and table["combine"] != "sample":
        raise DataError(f"{file}: combine = '{table['combine']}' and [sample] exclude each other")
    count = whole_number(file, of_sample, "count", 0)
    if of_sample and not count:
        raise DataError(f"{file}: [sample] needs count, the number of points")
    return Sweep(
        case=file.parent / case,
        vary=flattened(inner_table(file, table, "vary")),
        set=flattened(inner_table(file, table, "set")),
        combine="sample" if of_sample else str(table.get("combine", "grid")),
        count=count or 0,
        seed=whole_number(file, of_sample, "seed", 0) or 0,
        keep=str(table.get("keep", "all")),
        stop_after_failures=whole_number(file, table, "stop_after_failures", None),
    )


def setting(text: str, option: str) -> tuple[str, str]:
    """KEY=VALUE of the command line."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip() or not value.strip():
        raise DataError(f"{option} {text}: is not KEY=VALUE")
    return key.strip(), value.strip()
