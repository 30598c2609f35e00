# SPDX-License-Identifier: BSD-3-Clause
"""The compiled program: where it is, in the installed package or the build folder of the sources; and called
as a user calls it."""

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

PLACES = ("bin/slipfront", "../../build/release/slipfront")
VARIABLE = "SLIPFRONT_PROGRAM"
GIGA = 1e9
NUMBER = r"([0-9.eE+-]+)"


def program() -> Path:
    """Raises Error where it is in neither place."""
    package = Path(__file__).resolve().parent
    for place in PLACES:
        file = package / place
        if file.is_file():
            return file
    raise Error(f"the program is not in {package / PLACES[0]}: install the package again, or `make program`")


def find_program() -> Path:
    """The one that was called, else the package's or the sources', else the first on the path."""
    if named := os.environ.get(VARIABLE):
        if not os.access(named, os.X_OK) or not Path(named).is_file():
            raise DataError(f"{named}: is no program")
        return Path(named).resolve()
    try:
        return program()
    except Error as error:
        if found := shutil.which("slipfront"):
            return Path(found)
        raise DataError(f"{error}, or set {VARIABLE} to its path") from None


def with_settings(settings: Iterable[str]) -> list[str]:
    return [part for setting in settings for part in ("--set", setting)]


def last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return one_line(lines[-1]) if lines else "no message"


def answer(program: Path, *arguments: str) -> str:
    """What a command of the program prints that takes a moment; signals from a terminal do not reach it."""
    try:
        result = subprocess.run(
            [str(program), *arguments],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,
        )
    except OSError as error:
        raise DataError(f"{program}: cannot be started: {error.strerror}") from None
    if result.returncode != 0:
        raise DataError(last_line(result.stderr))
    return result.stdout


def version_of(program: Path) -> str:
    return one_line(answer(program, "--version").split("\n", 1)[0])


@dataclass(frozen=True)
class Cost:
    """What `slipfront info` expects of a run; of a sequence disk and time are those of one event."""

    memory_bytes: float
    disk_bytes: float
    time_s: float
    is_sequence: bool


def cost_of(program: Path, case: Path, settings: Iterable[str]) -> Cost:
    told = answer(program, "info", str(case), *with_settings(settings))
    lines = (("memory", "GB", GIGA), ("disk", "GB", GIGA), ("expected time", "s", 1))
    numbers = []
    for name, unit, scale in lines:
        found = re.search(rf"^{name}\s+{NUMBER} {unit}\b", told, re.MULTILINE)
        if found is None:
            raise DataError(f"{program}: `info` tells no {name}: it is of another version")
        numbers.append(float(found[1]) * scale)
    memory_bytes, disk_bytes, time_s = numbers
    is_sequence = re.search(r"^sequence\b", told, re.MULTILINE) is not None
    return Cost(memory_bytes, disk_bytes, time_s, is_sequence)
