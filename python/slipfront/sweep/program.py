# SPDX-License-Identifier: BSD-3-Clause
"""The compiled program, called as a user calls it: what it says of a case before it is run."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from slipfront.errors import Error
from slipfront.files import DataError, one_line
from slipfront.program import program as own_program

VARIABLE = "SLIPFRONT_PROGRAM"
GIGA = 1e9


def find_program() -> Path:
    """The one that was called, else the package's or the sources', else the first on the path."""
    named = os.environ.get(VARIABLE)
    if named:
        return usable(Path(named))
    try:
        return own_program()
    except Error as error:
        found = shutil.which("slipfront")
        if found is None:
            raise DataError(f"{error}, or set {VARIABLE} to its path") from None
        return Path(found)


def usable(file: Path) -> Path:
    if not (file.is_file() and os.access(file, os.X_OK)):
        raise DataError(f"{file}: is no program")
    return file.resolve()


def with_settings(settings: Iterable[str]) -> list[str]:
    return [part for setting in settings for part in ("--set", setting)]


def call(program: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs a command of the program that takes a moment; signals from a terminal do not reach it."""
    try:
        return subprocess.run(
            [str(program), *arguments],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,
        )
    except OSError as error:
        raise DataError(f"{program}: cannot be started: {error.strerror}") from None


def last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return one_line(lines[-1]) if lines else "no message"


def problem_of(program: Path, case: Path, settings: Iterable[str]) -> str | None:
    """What `slipfront validate` says against a case, in one line; None where nothing."""
    result = call(program, "validate", str(case), *with_settings(settings))
    return None if result.returncode == 0 else last_line(result.stderr)


def version_of(program: Path) -> str:
    result = call(program, "--version")
    if result.returncode != 0:
        raise DataError(f"{program}: is not slipfront: {last_line(result.stderr)}")
    return one_line(result.stdout.split("\n", 1)[0])


@dataclass(frozen=True)
class Cost:
    """What `slipfront info` expects of a run. Bytes on disk: the most while it goes, and of its results."""

    memory_bytes: float
    peak_disk_bytes: float
    result_bytes: float  # histories and snapshots, before they are packed
    expected_s: float
    n_nodes: int  # of the interface


NUMBER = r"([0-9.eE+-]+)"
COST_LINES = {
    "memory": rf"^memory\s+{NUMBER} GB",
    "disk": rf"^disk\s+{NUMBER} GB",
    "history": rf"rows of history {NUMBER}",
    "snapshots": rf"snapshots {NUMBER}",
    "time": rf"^expected time\s+{NUMBER} s",
    "nodes": r"\((\d+) on the interface",
}


def cost_of(program: Path, case: Path, settings: Iterable[str]) -> Cost:
    result = call(program, "info", str(case), *with_settings(settings))
    if result.returncode != 0:
        raise DataError(last_line(result.stderr))
    numbers = {}
    for name, pattern in COST_LINES.items():
        found = re.search(pattern, result.stdout, re.MULTILINE)
        if found is None:
            raise DataError(f"{program}: `info` tells no {name}: it is of another version")
        numbers[name] = float(found[1])
    return Cost(
        memory_bytes=numbers["memory"] * GIGA,
        peak_disk_bytes=numbers["disk"] * GIGA,
        result_bytes=(numbers["history"] + numbers["snapshots"]) * GIGA,
        expected_s=numbers["time"],
        n_nodes=int(numbers["nodes"]),
    )


@dataclass(frozen=True)
class KeyFacts:
    """What `slipfront keys` says of a key."""

    unit: str
    meaning: str


def key_facts(program: Path) -> dict[str, KeyFacts]:
    """By key."""
    facts: dict[str, KeyFacts] = {}
    table = ""
    for line in call(program, "keys").stdout.splitlines():
        if heading := re.match(r"#+ .*?\[(\w+)\]", line):
            table = heading[1] + "."
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 6 and re.fullmatch(r"`\w+`", cells[0]):
            facts.setdefault(table + cells[0].strip("`"), KeyFacts(cells[2], cells[5].replace("\\|", "|")))
    return facts
