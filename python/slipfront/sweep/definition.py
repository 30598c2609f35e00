# SPDX-License-Identifier: BSD-3-Clause
"""What a sweep is: its case, what varies, and what is kept."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from slipfront.files import DataError, exists, parse_toml, read_text, read_toml
from slipfront.sweep.points import Point, Value, grid, range_of, sample, text_of, values_of, zipped

COMBINATIONS = ("grid", "zip", "sample")
KEEPS = ("all", "tables")
#: Of a file, by their dotted names.
ENTRIES = {"case": str, "combine": str, "keep": str, "set": dict, "vary": dict, "sample": dict,
           "sample.count": int, "sample.seed": int}  # fmt: skip
KINDS = {str: "a text", int: "a whole number", dict: "a table"}


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
    #: FILE:LINE by dotted entry, of what a file says.
    lines: dict[str, str] = field(default_factory=dict, compare=False, repr=False)

    @classmethod
    def of_points(cls, case: Path, points: Iterable[Point], settings: dict[str, Value]) -> Sweep:
        """A sweep of these points, which have values of the same keys."""
        rows = [point.values for point in points]
        return cls(case, {key: [row[key] for row in rows] for key in rows[0]}, settings, combine="zip")

    def settings(self) -> list[str]:
        """Those of all points, as `--set` takes them."""
        return [f"{key}={text_of(value)}" for key, value in self.set.items()]

    @contextmanager
    def at(self, entry: str) -> Iterator[None]:
        """Puts the place of an entry before what is refused meanwhile."""
        try:
            yield
        except DataError as error:
            raise DataError(f"{self.lines.get(entry, 'sweep')}: {error}") from None

    def refuse(self, entry: str, what: str) -> NoReturn:
        with self.at(entry):
            raise DataError(what)
        raise AssertionError

    def points(self) -> list[Point]:
        values: dict[str, Any] = {}
        is_sample, is_zip = self.combine == "sample", self.combine == "zip"
        for key, spec in self.vary.items():
            with self.at(f"vary.{key}"):
                values[key] = range_of(key, str(spec)) if is_sample else values_of(key, spec, is_zip)
        with self.at("sample" if is_sample else "vary"):
            if is_sample:
                return sample(values, self.count, self.seed)
            return zipped(values) if is_zip else grid(values)

    def require_sound(self) -> None:
        """Refuses what contradicts itself; keys and their values are the program's to judge."""
        if not self.vary:
            self.refuse("vary", "nothing varies: name at least one key with its values")
        for entry, value, known in (("combine", self.combine, COMBINATIONS), ("keep", self.keep, KEEPS)):
            if value not in known:
                self.refuse(entry, f"{entry} is one of {', '.join(known)}, not '{value}'")
        if self.seed < 0:
            self.refuse("sample.seed", "seed is a whole number from 0 on")
        for key in self.vary.keys() & self.set.keys():
            self.refuse(f"set.{key}", f"{key} both varies and is set")
        if not exists(self.case):
            self.refuse("case", f"{self.case}: No such file or directory")
        self.points()


def entries_of(table: dict[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys of a table and of those in it, the outer ones first; each as often as it is written."""
    for name, value in table.items():
        yield before + name, value
        if isinstance(value, dict):
            yield from entries_of(value, f"{before}{name}.")


def flattened(table: dict[str, Any]) -> dict[str, Any]:
    """Values of tables in tables by dotted keys."""
    return {key: value for key, value in entries_of(table) if not isinstance(value, dict)}


def is_value(value: Any) -> bool:
    """Whether a key of a case file may be set to it, or to each of it."""
    return (
        all(map(is_value, value)) if isinstance(value, list) else isinstance(value, bool | int | float | str)
    )


def settings_of(name: str, table: dict[str, Any], lines: dict[str, str]) -> dict[str, Any]:
    """Values of [set] or [vary] by dotted keys, each there once."""
    found: dict[str, Any] = {}
    for key, value in entries_of(table):
        if isinstance(value, dict):
            continue
        line = lines.get(f"{name}.{key}", lines[name])
        if key in found:
            raise DataError(
                f"{line}: {key} is there twice in [{name}], quoted and dotted; keep one of the two"
            )
        if not is_value(value):
            raise DataError(f"{line}: {key} is a date or a time; give numbers, texts, true, false or a list")
        found[key] = value
    return found


def lines_of(text: str) -> dict[str, int]:
    """The line of each dotted key of a text that is TOML. `tomllib` tells no lines."""
    found: dict[str, int] = {}
    header, begun, statement = "", 1, ""
    for number, line in enumerate(text.split("\n"), start=1):
        statement += line + "\n"
        try:
            keys = [key for key, _ in entries_of(tomllib.loads(statement))]
        except tomllib.TOMLDecodeError:
            continue  # a bracket or a quotation is still open
        if statement.lstrip().startswith("["):
            header = ""
        for key in keys:
            found.setdefault(header + key, begun)
        if statement.lstrip().startswith("[") and keys:
            header = keys[-1] + "."
        begun, statement = number + 1, ""
    return found


def is_sweep_file(file: Path) -> bool:
    """Whether a file of TOML is a sweep's, not a case: that has no entry `case` and no [vary]."""
    return not {"case", "vary"}.isdisjoint(read_toml(file))


def read_sweep(file: Path) -> Sweep:
    text = read_text(file).replace("\r\n", "\n")
    table = parse_toml(file, text)
    lines = {entry: f"{file}:{line}" for entry, line in lines_of(text).items()}
    of_sample = table.get("sample", {})
    entries = dict(table)
    if isinstance(of_sample, dict):
        entries |= {f"sample.{name}": value for name, value in of_sample.items()}
    for entry, value in entries.items():
        kind = ENTRIES.get(entry)
        if kind is None:
            raise DataError(f"{lines[entry]}: unknown entry '{entry}'; known are {', '.join(ENTRIES)}")
        if type(value) is not kind:
            raise DataError(f"{lines[entry]}: {entry} is {KINDS[kind]}")
    if not table.get("case"):
        raise DataError(f"{lines.get('case', file)}: case names the case file, relative to this one")
    if "sample" in table and table.get("combine", "sample") != "sample":
        raise DataError(f"{lines['combine']}: combine = '{table['combine']}' and [sample] exclude each other")
    return Sweep(
        case=file.parent / table["case"],
        vary=settings_of("vary", table.get("vary", {}), lines),
        set=settings_of("set", table.get("set", {}), lines),
        combine="sample" if "sample" in table else table.get("combine", "grid"),
        count=of_sample.get("count", 0),
        seed=of_sample.get("seed", 0),
        keep=table.get("keep", "all"),
        lines=lines,
    )
