# SPDX-License-Identifier: BSD-3-Clause
"""Single files as values. Whatever a file holds, it is read or refused with a DataError."""

from __future__ import annotations

import csv
import json
import math
import os
import re
import stat
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from slipfront.errors import Error
from slipfront.errors import one_line as one_line

HDF5_MARK = b"\x89HDF\r\n\x1a\n"  # at the beginning of a file
ROWS = "rows"  # the data set of a file of rows whose numbers others show
LARGEST_TEXT_BYTES = 2**30
LARGEST_PACKING = 1032  # of deflate: no data set unpacks to more than so many times its bytes in the file


class DataError(Error):
    """A file is missing or not as expected; the message is one line that names it."""


class NoRoom(DataError):
    """The system does not write: a full disk, a quota, a broken device. Exit code 1."""


def is_folder(path: Path) -> bool:
    try:
        return stat.S_ISDIR(os.stat(path).st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}") from None


def exists(path: Path) -> bool:
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}") from None
    return True


@contextmanager
def open_file(file: Path) -> Iterator[BufferedReader]:
    """A regular file's bytes. Pipes and devices, which would be waited for, are refused."""
    try:
        with open(os.open(file, os.O_RDONLY | os.O_NONBLOCK), "rb") as stream:
            mode = os.fstat(stream.fileno()).st_mode
            if stat.S_ISDIR(mode):
                raise DataError(f"{file}: Is a directory")
            if not stat.S_ISREG(mode):
                raise DataError(f"{file}: not a regular file")
            yield stream
    except OSError as error:
        raise DataError(f"{file}: {error.strerror}") from None


def read_bytes(file: Path) -> bytes:
    with open_file(file) as stream:
        if os.fstat(stream.fileno()).st_size > LARGEST_TEXT_BYTES:
            raise DataError(f"{file}: more than {LARGEST_TEXT_BYTES} bytes")
        try:
            return stream.read()
        except MemoryError:
            raise DataError(f"{file}: does not fit into memory") from None


def read_text(file: Path) -> str:
    data = read_bytes(file)
    if b"\0" in data:
        raise DataError(f"{file}: holds a byte 0: not a text file, or damaged")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise DataError(
            f"{file}:{line}: byte 0x{data[error.start]:02x} is not UTF-8: save the file as UTF-8"
        ) from None


def parse_toml(file: Path, text: str, parse_float: Callable[[str], Any] = float) -> dict[str, Any]:
    """The tables of a file's text; a mistake is told with its line."""
    try:
        return tomllib.loads(text, parse_float=parse_float)
    except RecursionError:
        raise DataError(f"{file}: not TOML: nested too deeply") from None
    except ValueError as error:
        told = one_line(str(error))
        found = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", told)
        if not found:
            raise DataError(f"{file}: not TOML: {told}") from None
        line = found[2] or text.rstrip("\n").count("\n") + 1
        where = f"column {found[3]}" if found[3] else "the end of the file"
        raise DataError(f"{file}:{line}: not TOML: {found[1]} at {where}; correct it there") from None


def read_toml(file: Path) -> dict[str, Any]:
    return parse_toml(file, read_text(file).replace("\r\n", "\n"))


def refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not a value of JSON")


def read_json(file: Path) -> Any:
    try:
        return json.loads(read_text(file), parse_constant=refuse_constant)
    except RecursionError:
        raise DataError(f"{file}: not JSON: nested too deeply") from None
    except ValueError as error:
        raise DataError(f"{file}: not JSON: {error}") from None


def read_json_table(file: Path) -> dict[str, Any]:
    table = read_json(file)
    if not isinstance(table, dict):
        raise DataError(f"{file}: not a JSON object")
    return table


def is_number(value: Any) -> bool:
    """Whether a value of JSON or TOML is a finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond the largest double
        return False


def number(file: Path, table: dict[str, Any], key: str, finite: bool = True) -> float:
    """Number of a dotted key of a file's table; inf is none unless `finite` is false."""
    value: Any = table
    for part in key.split("."):
        if not isinstance(value, dict) or part not in value:
            raise DataError(f"{file}: no entry '{key}'")
        value = value[part]
    if not is_number(value) and (finite or value not in (np.inf, -np.inf)):
        raise DataError(f"{file}: '{key}' is not a number")
    return float(value)


@dataclass(frozen=True)
class Table:
    """A CSV file. Empty lines and those that start with # are passed over."""

    file: Path
    header: list[str]
    rows: list[tuple[int, list[str]]]  # the line's number and its cells
    decimal_comma: bool = False  # numbers may have a comma in place of the point

    def index(self, column: str) -> int:
        if column not in self.header:
            raise DataError(f"{self.file}: no column '{column}'")
        return self.header.index(column)

    def texts(self, column: str) -> list[str]:
        i = self.index(column)
        return [cells[i] for _, cells in self.rows]

    def numbers(self, column: str, finite: bool = True) -> np.ndarray:
        """An empty cell is NaN; nan and inf are refused unless `finite` is false. [rows]"""
        i = self.index(column)
        return np.array(
            [self.number(line, column, cells[i], finite) for line, cells in self.rows], dtype=float
        )

    def number(self, line: int, column: str, text: str, finite: bool) -> float:
        if not text:
            return np.nan
        try:
            decimal = text.replace(",", ".", 1) if self.decimal_comma else text
            value = float(decimal) if text.isascii() and "_" not in text else None
        except ValueError:
            value = None
        if value is None or (finite and not np.isfinite(value)):
            raise DataError(f"{self.file}:{line}: '{one_line(text)}' in column '{column}' is not a number")
        return value


def split_line(file: Path, line: int, text: str, separator: str = ",") -> list[str]:
    """Cells of one line: no quotation goes on into the next."""
    try:
        return [cell.strip() for cell in next(csv.reader([text], delimiter=separator, strict=True), [])]
    except csv.Error as error:
        raise DataError(f"{file}:{line}: not a line of CSV: {error}") from None


def read_table(
    file: Path,
    by_hand: bool = False,
    growing: bool = False,
    separators: str = ",",
    header_only: bool = False,
) -> Table:
    """A table of the program ends with a whole line, or it was cut off; one made by hand need not.

    Of a growing one, which a run still appends to or was killed over, a cut line at the end is passed over.
    Cells are separated by the first of the separators that the header has, the last where it has none;
    numbers may have a decimal comma where that is no comma.
    """
    text = read_text(file)
    if growing:
        text = text[: text.rfind("\n") + 1]
    elif text and not by_hand and not text.endswith("\n"):
        raise DataError(f"{file}: the last line is cut off")
    header: list[str] | None = None
    separator = separators[-1]
    rows = []
    for line, content in enumerate(re.split(r"\r\n|\r|\n", text), start=1):
        if not content.strip() or content.lstrip().startswith("#"):
            continue
        if header is None:
            separator = next((sign for sign in separators if sign in content), separator)
            header = split_line(file, line, content, separator)
            if header_only:
                break
            continue
        cells = split_line(file, line, content, separator)
        if not any(cells):
            continue
        if len(cells) != len(header):
            commas = "; with decimal commas separate cells by semicolons" if separator == "," else ""
            raise DataError(f"{file}:{line}: {len(cells)} cells, the header has {len(header)}{commas}")
        rows.append((line, cells))
    if header is None:
        raise DataError(f"{file}: empty")
    for name in header:
        if name and header.count(name) > 1:
            raise DataError(f"{file}: two columns '{one_line(name)}'")
    return Table(file, header, rows, separator != ",")


@contextmanager
def reading(file: Path, what: str) -> Iterator[None]:
    """What a library says of a damaged file, in whatever exception, becomes a DataError."""
    try:
        yield
    except DataError:
        raise
    except MemoryError:
        raise DataError(f"{file}: does not fit into memory") from None
    except Exception as error:  # libraries raise what they happen to: OSError, KeyError, ValueError, ...
        told = one_line(str(error)) or type(error).__name__
        raise DataError(f"{file}: damaged, or not {what}: {told}") from None


@contextmanager
def open_hdf5(file: Path) -> Iterator[h5py.File]:
    """An HDF5 file, damaged ones refused."""
    with open_file(file):
        pass
    with reading(file, "an HDF5 file"), h5py.File(file, "r") as hdf5:
        yield hdf5


def dataset(group: h5py.Group, name: str, dimensions: int) -> h5py.Dataset:
    """A data set of numbers, all of which lie in the file."""
    file = group.file.filename
    found = group.get(name)
    if not isinstance(found, h5py.Dataset):
        raise DataError(f"{file}: no data set '{name}' in '{group.name}'")
    if found.dtype.kind not in "fiub" or found.ndim != dimensions:
        raise DataError(f"{file}: '{name}' is not an array of numbers with {dimensions} dimensions")
    source = group.file.get(ROWS) if found.is_virtual else found
    stored = source.id.get_storage_size() if isinstance(source, h5py.Dataset) else 0
    if math.prod(found.shape) * found.dtype.itemsize > stored * (
        1 if packing(found) == 0 else LARGEST_PACKING
    ):
        raise DataError(
            f"{file}: '{name}' is {found.shape}, more than the file holds of it: cut off or damaged"
        )
    return found


def packing(found: h5py.Dataset) -> int:
    """Number of filters, such as a compression, that a data set's bytes go through."""
    return found.id.get_create_plist().get_nfilters()
