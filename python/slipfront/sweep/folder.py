# SPDX-License-Identifier: BSD-3-Clause
"""A sweep's folder: sweep.json says what the sweep is, points/NAME holds a run's results, points/NAME.error
the line that says why there are none.

Points are known by their name, their resolved case and their checksums."""

from __future__ import annotations

import fcntl
import hashlib
import json
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from slipfront import command
from slipfront.files import (
    DataError,
    exists,
    is_folder,
    one_line,
    read_bytes,
    read_json_table,
    read_text,
    read_toml,
)
from slipfront.folder import LIST, RUN, SEQUENCE, UNFINISHED, inside, problem, read_list, sha256
from slipfront.program import find_program, version_of
from slipfront.sweep.definition import ENTRIES, Sweep, flattened, is_value
from slipfront.sweep.points import Point, Value, text_of, value_of

DEFINITION = "sweep.json"
POINTS = "points"
STATES = "states"
LOCK = ".sweep.lock"
CASE = "case.resolved.toml"
LEFT_OUT = ("interface.h5", "fields.vtkhdf")  # with keep = "tables"

#: Types of its entries, beside the identity: those of a sweep's file, without the table of a sample.
DEFINED = {entry.removeprefix("sample."): kind for entry, kind in ENTRIES.items() if entry != "sample"}

#: What points of one folder have in common, and what is said of a folder where it is otherwise.
IDENTITY = {
    "program": "begun by another program",
    "program_sha256": "begun by another build of the program",
    "case_sha256": "of another case file, or its tables have changed",
    "set": "of other settings in [set] or --set",
}


def named_files(case: Path, values: list[Any]) -> list[Path]:
    """Files beside the case that texts in it name."""
    texts = [v for v in values if isinstance(v, str) and 0 < len(v) < 4096 and "\0" not in v]
    return sorted({file for file in (case.parent / text for text in texts) if file.is_file()})


def identity_of(sweep: Sweep, program: Path) -> dict[str, Any]:
    """By the names of IDENTITY. The case's checksum is also that of the files it names."""
    case = flattened(read_toml(sweep.case))
    varied = [value for point in sweep.points() for value in point.values.values()]
    sums = hashlib.sha256(read_bytes(sweep.case))
    for file in named_files(sweep.case, [*case.values(), *sweep.set.values(), *varied]):
        sums.update(sha256(file).encode())
    values = (version_of(program), sha256(program), sums.hexdigest(), sweep.settings())
    return dict(zip(IDENTITY, values, strict=True))


@contextmanager
def held(folder: Path, shared: bool = False) -> Iterator[None]:
    """A sweep's folder, made where it is missing; refused where another sweep works in it.

    Those that take shares of one sweep hold it together."""
    try:
        for name in (POINTS, STATES):
            inside(folder, name).mkdir(parents=True, exist_ok=True)
        lock = open(inside(folder, LOCK), "a")  # noqa: SIM115
    except OSError as error:
        raise DataError(f"{folder}: cannot be written: {error.strerror}") from None
    with lock:
        try:
            fcntl.flock(lock, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except OSError:
            raise DataError(f"{folder}: another sweep is at work in it") from None
        yield


def begun(sweep: Sweep, folder: Path) -> tuple[Path, dict[str, Any]]:
    """The program and what points have in common, of a sweep that is sound and a folder that may hold it."""
    sweep.require_sound()
    program = find_program()
    identity = identity_of(sweep, program)
    require_usable(folder, sweep, identity)
    return program, identity


def require_usable(folder: Path, sweep: Sweep, identity: dict[str, Any]) -> None:
    """Refuses a folder of something else, or of a sweep whose points are other runs.

    Also one with points that this sweep has not: its tables would lose them."""
    file = folder / DEFINITION
    if not exists(file):
        if is_folder(folder) and any(entry.name not in (POINTS, STATES, LOCK) for entry in folder.iterdir()):
            raise DataError(f"{folder}: holds something, and no sweep; choose another folder")
        return
    found = read_json_table(file).get("identity")
    if not isinstance(found, dict):
        raise DataError(f"{file}: no entry 'identity'")
    for name, otherwise in IDENTITY.items():
        if found.get(name) != identity[name]:
            raise DataError(f"{folder}: holds a sweep {otherwise}; choose another folder")
    points = {point.words for point in sweep.points()}
    for point in read_definition(folder).points():
        if point.words not in points:
            lost = f"holds a sweep with the point {point.name}, which this one has not"
            raise DataError(f"{folder}: {lost}; choose another folder")


def write_whole(file: Path, text: str) -> None:
    """A file that is there completely, or not at all."""
    fresh = command.replaceable(file).with_name(f".{file.name}.{os.getpid()}")
    try:
        fresh.unlink(missing_ok=True)
        fresh.write_text(text, encoding="utf-8")
        os.replace(fresh, file)
    except OSError as error:
        with suppress(OSError):
            fresh.unlink(missing_ok=True)
        raise command.not_written(file, error) from None


def as_json(value: Any) -> Any:
    """JSON has no infinity: its text."""
    if isinstance(value, dict):
        return {key: as_json(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [as_json(inner) for inner in value]
    return text_of(value) if isinstance(value, float) and not math.isfinite(value) else value


def write_definition(folder: Path, sweep: Sweep, identity: dict[str, Any]) -> None:
    own = {name: value for name, value in asdict(sweep).items() if name != "lines"}
    entries = as_json(own | {"case": str(sweep.case.resolve()), "identity": identity})
    write_whole(folder / DEFINITION, json.dumps(entries, indent=2, allow_nan=False) + "\n")


def read_definition(folder: Path) -> Sweep:
    file = folder / DEFINITION
    if not exists(file):
        raise DataError(f"{folder}: holds no sweep")
    entries = read_json_table(file)
    entries.pop("identity", None)
    known = all(type(value) is DEFINED.get(name) for name, value in entries.items())
    settings = [value for name in ("vary", "set") if known for value in entries.get(name, {}).values()]
    if not known or not {"case", "vary"} <= entries.keys() or not all(map(is_value, settings)):
        raise DataError(f"{file}: not the definition of a sweep, or of another version")
    return Sweep(**entries | {"case": Path(entries["case"])})


def points_in(folder: Path) -> list[Point]:
    """Of the sweep that a folder holds; none where it holds none."""
    return read_definition(folder).points() if exists(folder / DEFINITION) else []


def place_of(folder: Path, point: Point) -> Path:
    return inside(folder, POINTS, point.name)


def error_file(folder: Path, point: Point) -> Path:
    return folder / POINTS / f"{point.name}.error"


def has_value(case: dict[str, Any], key: str, value: Value) -> bool:
    """Whether a resolved case has a key's value; 1 is 1.0, and `inf` a number."""
    wanted = value_of(value) if isinstance(value, str) else value
    return case.get(key) in (wanted, value)


def damage(place: Path) -> str | None:
    """What is wrong with a folder's files, also with those of the events of a sequence, in one line."""
    sums = read_list(place) if is_folder(place) else None
    if sums is None:
        return "no results"
    for name, expected in sums.items():
        wrong = problem(place, name, expected)
        if wrong is None and Path(name).name == LIST:
            wrong = damage((place / name).parent)
        if wrong:
            return wrong
    return None


def what_is_wrong(place: Path, point: Point) -> str | None:
    """Why a folder does not hold a point's complete results, in one line; None where it does."""
    if wrong := damage(place):
        return wrong
    case = flattened(read_toml(place / CASE))
    for key, value in point.values.items():
        if not has_value(case, key, value):
            return f"{place / CASE}: {key} is not {text_of(value)}: results of another point"
    return None


def is_done(folder: Path, point: Point) -> bool:
    place = place_of(folder, point)
    try:
        return what_is_wrong(place, point) is None
    except DataError:
        return False


def write_list(place: Path, sums: dict[str, str]) -> None:
    """Where it is not as it should be."""
    if sums != read_list(place):
        write_whole(place / LIST, "".join(f"{value}  {name}\n" for name, value in sums.items()))


def thin_out(place: Path) -> None:
    """Takes histories and snapshots out of a point's results and of its events'; lists are shortened first.
    While those of events change, the point's names none of them: an end meanwhile leaves no list wrong."""
    kept = {name: value for name, value in (read_list(place) or {}).items() if name not in LEFT_OUT}
    events = sorted(inside(place, "events").glob(f"*/{LIST}"))
    if any(not (read_list(event.parent) or {}).keys().isdisjoint(LEFT_OUT) for event in events):
        write_list(place, {name: value for name, value in kept.items() if Path(name).name != LIST})
    for event in events:
        thin_out(inside(place, "events", event.parent.name))
    write_list(place, kept | {event.relative_to(place).as_posix(): sha256(event) for event in events})
    for name in LEFT_OUT:
        (place / name).unlink(missing_ok=True)


def failure_of(folder: Path, point: Point) -> str | None:
    """Why a point has failed, in one line; None where it has not, or not yet."""
    file = error_file(folder, point)
    return one_line(read_text(file).strip()) if exists(file) else None


def blew_up(place: Path) -> str | None:
    """The reason of a run or a sequence that blew up, and would do so again."""
    for name in (RUN, SEQUENCE):
        file = place / UNFINISHED / name
        try:
            info = read_json_table(file) if exists(file) else {}
        except DataError:
            continue
        if info.get("status") == "blew_up":
            return str(info.get("reason"))
    return None
