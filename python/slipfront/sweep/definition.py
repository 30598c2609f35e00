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

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from slipfront.files import DataError, exists, parse_toml, read_text, read_toml
from slipfront.sweep.lines import lines_of
from slipfront.sweep.points import Point, grid, sample, zipped
from slipfront.sweep.values import Value, Written, range_of, text_of, values_of

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
    #: FILE:LINE by dotted entry, of what a file says.
    lines: dict[str, str] = field(default_factory=dict, compare=False, repr=False)

    def place(self, entry: str) -> str:
        """Where an entry is said, for messages."""
        return self.lines.get(entry, "sweep")

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


@contextmanager
def told_at(place: str) -> Iterator[None]:
    """Puts a place before what is refused meanwhile."""
    try:
        yield
    except DataError as error:
        raise DataError(f"{place}: {error}") from None


def require_sound(sweep: Sweep) -> Sweep:
    """Refuses what contradicts itself, before anything is run; keys and values are the program's to judge."""
    at = sweep.place
    if not sweep.vary:
        raise DataError(f"{at('vary')}: nothing varies: name at least one key with its values")
    if sweep.combine not in COMBINATIONS:
        words = ", ".join(COMBINATIONS)
        raise DataError(f"{at('combine')}: combine is one of {words}, not '{sweep.combine}'")
    if sweep.keep not in KEEPS:
        raise DataError(f"{at('keep')}: keep is one of {', '.join(KEEPS)}, not '{sweep.keep}'")
    if sweep.stop_after_failures is not None and sweep.stop_after_failures < 1:
        raise DataError(f"{at('stop_after_failures')}: stop_after_failures is a whole number from 1 on")
    if sweep.seed < 0:
        raise DataError(f"{at('sample.seed')}: seed is a whole number from 0 on")
    for key in sweep.vary:
        if key in sweep.set:
            raise DataError(f"{at(f'set.{key}')}: {key} both varies and is set")
    if not exists(sweep.case):
        place = f"{at('case')}: " if "case" in sweep.lines else ""
        raise DataError(f"{place}{sweep.case}: No such file or directory")
    for key, spec in sweep.vary.items():
        with told_at(at(f"vary.{key}")):
            if sweep.combine == "sample":
                range_of(key, str(spec))
            else:
                values_of(key, spec)
    with told_at(at("sample" if sweep.combine == "sample" else "vary")):
        sweep.points()
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


@dataclass(frozen=True)
class Entries:
    """A table of a file, whose mistakes are told with their lines."""

    file: Path
    lines: dict[str, str]  # FILE:LINE by dotted entry
    table: dict[str, Any]
    name: str = ""  # of a table in the file

    def refuse(self, entry: str, what: str) -> NoReturn:
        whole = f"{self.name}.{entry}" if self.name else entry
        raise DataError(f"{self.lines.get(whole, self.lines.get(self.name, str(self.file)))}: {what}")

    def require_known(self, known: tuple[str, ...]) -> None:
        where = f" in [{self.name}]" if self.name else ""
        for entry in self.table:
            if entry not in known:
                self.refuse(entry, f"unknown entry '{entry}'{where}; known are {', '.join(known)}")

    def inner(self, name: str) -> Entries:
        table = self.table.get(name, {})
        if not isinstance(table, dict):
            self.refuse(name, f"[{name}] is a table")
        return Entries(self.file, self.lines, table, name)

    def text(self, entry: str, default: str) -> str:
        value = self.table.get(entry, default)
        if not isinstance(value, str) or not value:
            self.refuse(entry, f"{entry} is a text")
        return value

    def whole_number(self, entry: str, default: int | None) -> int | None:
        value = self.table.get(entry, default)
        if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
            self.refuse(entry, f"{entry} is a whole number")
        return value


def is_sweep_file(file: Path) -> bool:
    """Whether a file of TOML is a sweep's, not a case: that has no entry `case` and no [vary]."""
    table = read_toml(file)
    return "case" in table or "vary" in table


def read_sweep(file: Path) -> Sweep:
    text = read_text(file).replace("\r\n", "\n")
    table = parse_toml(file, text)
    entries = Entries(file, {entry: f"{file}:{line}" for entry, line in lines_of(text).items()}, table)
    entries.require_known(ENTRIES)
    of_sample, common = entries.inner("sample"), entries.inner("set")
    entries.inner("vary")
    of_sample.require_known(SAMPLE_ENTRIES)
    if "case" not in table:
        entries.refuse("case", "case names the case file, relative to this one")
    if of_sample.table and table.get("combine", "sample") != "sample":
        entries.refuse("combine", f"combine = '{table['combine']}' and [sample] exclude each other")
    count = of_sample.whole_number("count", 0)
    if "sample" in table and not count:
        of_sample.refuse("count", "[sample] needs count, the number of points")
    as_written = parse_toml(file, text, Written).get("vary", {})
    return Sweep(
        case=file.parent / entries.text("case", ""),
        vary=flattened(as_written),
        set=flattened(common.table),
        combine="sample" if of_sample.table else entries.text("combine", "grid"),
        count=count or 0,
        seed=of_sample.whole_number("seed", 0) or 0,
        keep=entries.text("keep", "all"),
        stop_after_failures=entries.whole_number("stop_after_failures", None),
        lines=entries.lines,
    )


def setting(text: str, option: str) -> tuple[str, str]:
    """KEY=VALUE of the command line."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip() or not value.strip():
        raise DataError(f"{option} {text}: is not KEY=VALUE")
    return key.strip(), value.strip()
