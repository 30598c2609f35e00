# SPDX-License-Identifier: BSD-3-Clause
"""What all commands of the package share: errors as one line, exit codes."""

from __future__ import annotations

import argparse
import errno
import os
import re
import stat
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NoReturn, TextIO

from slipfront.errors import CaseError
from slipfront.files import DataError, NoRoom, one_line, open_file

#: Arguments of a material, by the keys of a case.
MATERIAL = ("youngs_modulus_Pa", "poissons_ratio", "density_kg_per_m3")
DONE, NOT_WRITTEN, REFUSED, INTERRUPTED = 0, 1, 2, 130


def option(name: str) -> str:
    """Of the command line, by its name in Python."""
    return f"--{name.lower().replace('_', '-')}"


def in_options(text: str, names: tuple[str, ...]) -> str:
    """A message about arguments of a function, as one about options."""
    return re.sub(rf"\b({'|'.join(names)})\b", lambda found: option(found[0]), text)


def by_options(work: Callable[[], list[str]], names: tuple[str, ...]) -> list[str]:
    """What work returns; arguments that it refuses are named as options."""
    try:
        return work()
    except CaseError as error:
        raise DataError(in_options(str(error), names)) from None


def write_line(stream: TextIO | None, text: str) -> None:
    """A line on standard output or error, which may be closed (None), full or without some signs."""
    if stream is None:
        return
    encoding = getattr(stream, "encoding", None) or "utf-8"
    print(one_line(text).encode(encoding, "backslashreplace").decode(encoding), file=stream, flush=True)


def abandon(stream: TextIO) -> None:
    """Keeps the interpreter from writing, at its end, what could not be written before."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def report_error(name: str, text: str) -> None:
    try:
        write_line(sys.stderr, f"{name}: error: {text}")
    except OSError:
        abandon(sys.stderr)


class Output:
    """Lines on standard output. One that cannot be written costs no results: `problem` is told at the end."""

    problem: str | None = None

    def say(self, line: str) -> None:
        self.write(lambda: write_line(sys.stdout, line))

    def write(self, work: Callable[[], None]) -> None:
        if self.problem is not None:
            return
        try:
            work()
        except OSError as error:
            abandon(sys.stdout)
            self.problem = f"standard output: {error.strerror}"


class Parser(argparse.ArgumentParser):
    """Ends with exit code 1 where its help cannot be written; a wrong command line gives one line."""

    def error(self, message: str) -> NoReturn:
        report_error(self.prog, f"{message}; see {self.prog} --help")
        sys.exit(REFUSED)

    def print_help(self, file: Any = None) -> None:
        output = Output()
        output.write(lambda: print(self.format_help(), end="", file=file, flush=True))
        if output.problem is not None:
            report_error(self.prog, output.problem)
            sys.exit(NOT_WRITTEN)


def run(name: str, work: Callable[[], list[str]], output: Output | None = None) -> int:
    """Exit code of a command. Prints the lines that `work` returns, or its error as one line.

    output: what `work` prints with meanwhile."""
    output = output or Output()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of Matplotlib on odd numbers: errors are told below
            lines = work()
    except DataError as error:
        report_error(name, str(error))
        return NOT_WRITTEN if isinstance(error, NoRoom) else REFUSED
    except KeyboardInterrupt as error:
        report_error(name, str(error) or "interrupted")
        return INTERRUPTED
    except RuntimeError as error:
        if str(error) != "can't start new thread":
            raise
        report_error(name, "no more threads can be started; allow more, as by ulimit -u")
        return REFUSED
    for line in lines:
        output.say(line)
    if output.problem is not None:
        report_error(name, output.problem)
        return NOT_WRITTEN
    return DONE


def not_written(path: Path, error: OSError) -> DataError:
    kind = NoRoom if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EFBIG) else DataError
    return kind(f"{path}: cannot be written: {error.strerror or error}")


def replaceable(file: Path) -> Path:
    """The path of a file to write, unless a device, a pipe, a link or a folder is there."""
    try:
        is_regular = stat.S_ISREG(os.lstat(file).st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return file
    except OSError as error:
        raise DataError(f"{file}: {error.strerror}") from None
    if not is_regular:
        raise DataError(f"{file}: is there and not a regular file: not replaced")
    return file


def require_own(file: Path, mark: bytes, what: str) -> None:
    """Refuses a path where anything but a file of ours is: one that begins with the mark."""
    if replaceable(file).exists():
        with open_file(file) as stream:
            beginning = stream.read(len(mark))
        if beginning != mark:
            raise DataError(f"{file}: is there and not {what}: not replaced; give another name")


def write_own(file: Path, mark: str, text: str, what: str) -> None:
    """A file that begins with a mark, in place of one of ours alone."""
    require_own(file, mark.encode(), what)
    with publishing_into(file.parent) as made:
        (made / file.name).write_text(mark + text, encoding="utf-8")


@contextmanager
def publishing_into(folder: Path) -> Iterator[Path]:
    """A folder to write into, inside `folder`. At the end its files go there; after an error none does."""
    is_new = not os.path.lexists(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=folder, prefix=".unfinished-") as made:
            yield Path(made)
            for file in sorted(Path(made).iterdir()):
                os.replace(file, folder / file.name)
    except OSError as error:
        raise not_written(folder, error) from None
    finally:
        if is_new:
            with suppress(OSError):
                folder.rmdir()  # only an empty one goes
