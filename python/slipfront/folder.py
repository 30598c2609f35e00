# SPDX-License-Identifier: BSD-3-Clause
"""A folder of results: where its files are, and whether they are those that the program wrote.

checksums.sha256 lists every file of a finished set with its SHA-256, as sha256sum does. publishing/ holds the
files of such a set that have not been moved to their place, unfinished/ a run or a sequence of events that
has not come to its end.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from slipfront import command
from slipfront.files import DataError, exists, is_folder, open_file, read_text

LIST = "checksums.sha256"
PUBLISHING = "publishing"
UNFINISHED = "unfinished"
RUN, SEQUENCE = "run.json", "sequence.json"  # what tells of one
RUN_FILES = (
    "run.json", "case.resolved.toml", "static.csv", "fronts.csv", "fracture.csv", "energy.csv",
    "interface.h5", "fields.vtkhdf", "probes.h5", "moment_rate.h5",
    "sequence.json", "events.csv", "loading.csv",
)  # fmt: skip


def inside(folder: Path, *names: str) -> Path:
    """A path below a folder to write or remove; refused where a link would lead it elsewhere."""
    path = folder
    for name in names:
        path /= name
        if path.is_symlink():
            raise DataError(f"{path}: is a link, which is not followed; move it away")
    return path


def located(path: Path) -> Path:
    """Where a file of a folder is now: a set that is being moved into the folder wins over what is there."""
    moving = path.parent / PUBLISHING / path.name
    return moving if exists(moving) else path


def read_list(folder: Path) -> dict[str, str] | None:
    """SHA-256 of each file of the set, by its name; None in a folder without a list, an older one."""
    file = located(folder / LIST)
    if not exists(file):
        return None
    sums: dict[str, str] = {}
    for line, text in enumerate(read_text(file).split("\n"), start=1):
        found = re.fullmatch(r"([0-9a-f]{64}) [ *](\S.*)", text)
        if found and ".." not in Path(found[2]).parts and not Path(found[2]).is_absolute():
            sums[found[2]] = found[1]
        elif text:
            raise DataError(f"{file}:{line}: not a line of sha256sum: the list was changed or damaged")
    if not sums:
        raise DataError(f"{file}: names no file: the list was cut off or damaged")
    return sums


def sha256(file: Path) -> str:
    with open_file(file) as stream:
        status = os.fstat(stream.fileno())
    return sha256_of(file, status.st_ino, status.st_size, status.st_mtime_ns)


@cache
def sha256_of(file: Path, inode: int, size: int, modified_ns: int) -> str:
    """Computed once for each state of a file."""
    with open_file(file) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def problem(folder: Path, name: str, expected: str) -> str | None:
    """What is wrong with a file of the list, in one line; None where nothing is."""
    file = located(folder / name)
    if not exists(file):
        return f"{file}: missing, though {LIST} names it; run the case again"
    if sha256(file) != expected:
        return f"{file}: does not match {LIST}: the file was changed or damaged; run the case again"
    return None


def result_file(path: Path, folder: Path | None = None) -> Path:
    """A result's file where it is now; refused where it is not as the list of the set's folder says, by
    default its own."""
    folder = path.parent if folder is None else folder
    name = path.relative_to(folder).as_posix()
    sums = read_list(folder)
    if sums is None:
        return located(path)
    if name not in sums:
        raise DataError(f"{path}: not in {LIST}: not of this set of results")
    wrong = problem(folder, name, sums[name])
    if wrong is not None:
        raise DataError(wrong)
    return located(path)


def belongs(path: Path) -> bool:
    """Whether a file that a set may lack is there, or is in the list and so should be."""
    sums = read_list(path.parent)
    return path.name in sums if sums is not None else exists(located(path))


def end_publication(folder: Path) -> None:
    """Moves a complete set, whose move may have been cut off, to its place; its list comes last."""
    publishing = inside(folder, PUBLISHING)
    if not is_folder(publishing):
        return
    for file in sorted(publishing.iterdir(), key=lambda file: file.name == LIST):
        os.replace(file, folder / file.name)
    publishing.rmdir()


@contextmanager
def publication(folder: Path, others: Mapping[str, str]) -> Iterator[Path]:
    """A folder to write a set of files into. At the end they appear in `folder` together, with their list;
    earlier ones stay until then.

    others: SHA-256 of files elsewhere that belong to the set."""
    made = inside(folder, UNFINISHED)
    try:
        end_publication(folder)
        shutil.rmtree(made, ignore_errors=True)
        made.mkdir()
        yield made
        sums = {file.name: sha256(file) for file in sorted(made.iterdir())} | dict(others)
        (made / LIST).write_text(
            "".join(f"{value}  {name}\n" for name, value in sums.items()), encoding="utf-8"
        )
        for file in made.iterdir():
            with open(file, "rb") as stream:
                os.fsync(stream.fileno())
        os.rename(made, folder / PUBLISHING)
        end_publication(folder)
    except OSError as error:
        raise command.not_written(folder, error) from None


def lists_under(folder: Path) -> list[Path]:
    """Folders with a list, the outermost first."""
    found = set()
    for place, _, files in os.walk(folder):
        if LIST in files:
            found.add(Path(place).parent if Path(place).name == PUBLISHING else Path(place))
    return sorted(found)


def verify_checksums(folder: Path) -> list[str]:
    """What does not match the lists of a folder and of those in it, a line each; empty where all does."""
    if not is_folder(folder):
        return [f"{folder}: no such folder"]
    folders = lists_under(folder)
    if not folders:
        return [f"{folder / LIST}: No such file: nothing to compare with"]
    problems: list[str] = []
    for place in folders:
        try:
            sums = read_list(place) or {}
            problems += filter(None, (problem(place, name, expected) for name, expected in sums.items()))
            others = (place / name for name in RUN_FILES if name not in sums)
            problems += [
                f"{file}: not in {LIST}: not of this set of results" for file in others if exists(file)
            ]
        except DataError as error:
            problems.append(str(error))
    return problems
