# SPDX-License-Identifier: BSD-3-Clause
"""Files of transient recorders as named columns, read when they are wanted and only where. docs/records.md"""

from __future__ import annotations

import csv
import io
import logging
import math
import os
import re
import sys
import warnings
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd

from slipfront.channels import FORCES, VOLTAGES
from slipfront.files import (
    HDF5_MARK,
    LARGEST_PACKING,
    DataError,
    dataset,
    one_line,
    open_file,
    read_bytes,
    reading,
)
from slipfront.gauges import STRAINS
from slipfront.onsets import LENGTHS, NEVER, PRESSURES, TIMES, WORDS, in_si, name_and_unit

AT_512 = 512  # where that of a .mat file of version 7.3 stands
#: That are read, of HDF5: a damaged one of others can hold the library up.
ATTRIBUTES = (
    "NAME", "MATLAB_class", "MATLAB_empty", "units", "_FillValue", "missing_value", "scale_factor",
    "add_offset",
)  # fmt: skip
#: What arrays hold besides numbers, by the kind of their type.
OTHERS = {
    "c": "complex numbers", "O": "references or objects", "S": "texts", "U": "texts", "T": "texts",
    "V": "records of several fields", "M": "dates", "m": "time spans",
}  # fmt: skip
FORMS_READ = "MATLAB (.mat), HDF5, NetCDF, NPZ, TDMS and tables of text"
UNITS = {*TIMES, *VOLTAGES, *LENGTHS, *FORCES, *PRESSURES, *STRAINS} - {""}
LESS = "less than it claims: cut off or damaged"
HEAD_LINES = 500  # of a table of text, among which its numbers begin
SEPARATORS = (";", "\t", ",", "")  # of cells; without any of the others, blanks

#: An index of an array: an int or a slice for each dimension.
Index = tuple[int | slice, ...]


@dataclass(frozen=True)
class Column:
    """What a file holds under a name, and what the file itself says of it."""

    name: str
    shape: tuple[int, ...]
    read: Callable[[Index], np.ndarray]
    other: str = ""  # what it holds where these are no numbers
    unit: str = ""
    time: str = ""  # the column of its times
    step_s: float = np.nan  # without such a column, of even times
    first_s: float = 0.0

    def __str__(self) -> str:
        of = " x ".join(map(str, self.shape)) or "one number"
        told = [f"{one_line(self.name)}: {self.other + ', ' if self.other else ''}{of}"]
        told += [f"unit {one_line(self.unit)}"] if self.unit else []
        told += [f"times in {one_line(self.time)}"] if self.time else []
        told += [f"{1 / self.step_s:.9g} Hz"] if self.step_s > 0 else []
        return ", ".join(told)


@dataclass(frozen=True)
class Series:
    """The numbers of a column, or of a row or column of an array, one after the other."""

    file: Path
    column: Column
    n: int
    axis: int | None  # None: a single number
    at: Index  # an index with which `axis` is another's

    def read(self, first: int = 0, end: int | None = None) -> np.ndarray:
        index = list(self.at)
        if self.axis is not None:
            index[self.axis] = slice(first, self.n if end is None else end)
        with reading(self.file, "a file of a recorder"):
            values = np.asarray(self.column.read(tuple(index)))
            if values.dtype.kind not in "fiub":
                other = OTHERS.get(values.dtype.kind, "no numbers")
                raise DataError(f"{self.file}: '{one_line(self.column.name)}' holds {other}")
            return values.astype(float).ravel()


@dataclass(frozen=True)
class Recording:
    """An open file."""

    file: Path
    columns: Mapping[str, Column]
    numbered: bool = False  # by their order, from 1, where a name is a number

    def find(self, name: str) -> Column | None:
        """By its name, `/` and `.` alike between groups, without the unit where one column has that name
        alone, or by its number."""
        plain = name.strip("/")
        for form in (name, plain, plain.replace(".", "/"), plain.replace("/", ".")):
            if form in self.columns:
                return self.columns[form]
        bare = [c for c in self.columns.values() if named(c.name) == (name.lower(), True)]
        if len(bare) == 1:
            return bare[0]
        k = int(name) if self.numbered and re.fullmatch(r"\d{1,6}", name) else 0
        return list(self.columns.values())[k - 1] if 0 < k <= len(self.columns) else None

    def has(self, name: str) -> bool:
        return self.find(name) is not None or self.find(split_index(name)[0]) is not None

    def series(self, name: str) -> Series:
        """Of a column, `name[:,3]` or `name[3,:]` of an array, counted from 0."""
        index: tuple[int, int] | None = None
        if (column := self.find(name)) is None:
            bare, index = split_index(name)
            column = self.find(bare)
        of = f"{self.file}: '{one_line(name)}'"
        if column is None:
            near = get_close_matches(name, self.columns, n=1)
            has = f"did you mean '{near[0]}'" if near else "it has " + listed(list(self.columns))
            raise DataError(f"{of} is no column; {has}")
        if column.other:
            raise DataError(f"{of} holds {column.other}")
        shape = column.shape
        if 0 in shape:
            raise DataError(f"{of} is empty")
        at: Index = tuple(slice(None) for _ in shape)
        if index is not None:
            runs, k = index
            if len(shape) != 2 or not 0 <= k < shape[1 - runs]:
                raise DataError(f"{of}: '{one_line(column.name)}' is {by(shape)}, which has no such part")
            at = (slice(None), k) if runs == 0 else (k, slice(None))
            return Series(self.file, column, shape[runs], runs, at)
        long = [k for k, n in enumerate(shape) if n != 1]
        if len(long) > 1:
            raise DataError(
                f"{of} is an array of {by(shape)}: name a row or column of two dimensions, as "
                f"'{one_line(name)}[:,0]'"
            )
        axis = long[0] if long else (0 if shape else None)
        at = tuple(slice(None) if k == axis else 0 for k in range(len(shape)))
        return Series(self.file, column, 1 if axis is None else shape[axis], axis, at)


def named(column: str) -> tuple[str, bool]:
    """The name in `CH1 (V)`, and whether a unit follows it."""
    name, unit = name_and_unit(column)
    return (name, True) if unit in UNITS else (column.strip().lower(), False)


def split_index(name: str) -> tuple[str, tuple[int, int] | None]:
    """Of `name[:,3]` the name, the dimension that runs and the index in the other one."""
    found = re.fullmatch(r"(.+)\[\s*(?::\s*,\s*(\d{1,9})|(\d{1,9})\s*,\s*:)\s*\]", name)
    if not found:
        return name, None
    return found[1], (0, int(found[2])) if found[2] else (1, int(found[3]))


def by(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))


def listed(names: list[str], most: int = 20) -> str:
    told = ", ".join(f"'{one_line(name)}'" for name in names[:most]) or "none"
    return told + (f" and {len(names) - most} more" if len(names) > most else "")


def word(value: Any) -> str:
    """An attribute as a text."""
    value = value.ravel()[0] if isinstance(value, np.ndarray) and value.size else value
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def plain_unit(text: str) -> str:
    """Of `[s]`, `seconds`, `seconds since 1970-01-01`; as it is where it is another's."""
    bare = text.partition(" since ")[0].strip(" ()[]")
    bare = bare.replace("µ", "u").replace("μ", "u").replace("%", "percent")
    return WORDS.get(bare.lower(), bare)


def unpacked(values: np.ndarray, attributes: Mapping[str, Any]) -> np.ndarray:
    """By the CF conventions: a value that stands for none is NaN; scale and offset are applied."""
    marks = [attributes[name] for name in ("_FillValue", "missing_value") if name in attributes]
    if not marks and "scale_factor" not in attributes and "add_offset" not in attributes:
        return values
    missing = np.isin(values, [np.ravel(mark)[0] for mark in marks])
    scale, offset = (
        float(np.ravel(attributes.get(name, default))[0])
        for name, default in (("scale_factor", 1.0), ("add_offset", 0.0))
    )
    return np.where(missing, np.nan, values * scale + offset)


def beyond(shape: tuple[int, ...], n_stored: int) -> str:
    """What is told of an array that no file of so many bytes unpacks to, or that memory does not hold."""
    n_values = math.prod(shape)
    if n_values > LARGEST_PACKING * n_stored:
        return LESS
    fits = 8 * n_values <= os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return "" if fits else "more than fits into memory"


def unstored(found: h5py.Dataset, attributes: Mapping[str, Any]) -> str:
    """What is told of a data set that is not all in the file; parts never written would be read as zeros."""
    if found.external:
        return "values of other files: copy them into one"
    try:
        dataset(found.file, found.name, found.ndim)
    except DataError:
        return LESS
    if found.chunks and "_FillValue" not in attributes:
        chunks = (-(-n // of) for n, of in zip(found.shape, found.chunks, strict=True))
        if found.id.get_num_chunks() < math.prod(chunks):
            return LESS
    return beyond(found.shape, found.id.get_storage_size())


@contextmanager
def read_hdf5(file: Path, _: int | None) -> Iterator[Recording]:
    """HDF5, NetCDF-4 and MATLAB 7.3, whose arrays are turned as MATLAB shows them. What links lead to is not
    read: all that is, lies in the file."""
    with h5py.File(file, "r") as hdf5:
        columns: dict[str, Column] = {}

        def take(name: str, found: Any) -> None:
            if not isinstance(found, h5py.Dataset):
                return
            attributes = {name: found.attrs[name] for name in ATTRIBUTES if name in found.attrs}
            if word(attributes.get("NAME", "")).startswith("This is a netCDF dimension but not"):
                return
            of_matlab = word(attributes.get("MATLAB_class", ""))
            other = OTHERS.get(found.dtype.kind, "")
            if of_matlab in ("char", "cell", "struct", "function_handle"):
                other = f"{'texts' if of_matlab == 'char' else 'references'} (of class {of_matlab})"
            shape = found.shape
            if shape is None or "MATLAB_empty" in attributes:
                shape, other = (0,), "nothing"
            other = other or unstored(found, attributes)
            time = ""
            if found.ndim and len(found.dims[0]):
                scale = found.dims[0][0]
                if plain_unit(word(scale.attrs.get("units", ""))) in TIMES and scale.name != found.name:
                    time = scale.name.strip("/")
            turned = bool(of_matlab) and len(shape) > 1

            def read(index: Index) -> np.ndarray:
                values = hdf5[name][index[::-1] if turned else index]
                return unpacked(np.asarray(values), attributes)

            unit = word(attributes.get("units", ""))
            shown = shape[::-1] if turned else shape
            if not name.startswith("#refs#"):  # of MATLAB's own
                columns[name] = Column(name, shown, read, other, unit, time)

        hdf5.visititems(take)
        yield Recording(file, columns)


@contextmanager
def read_netcdf3(file: Path, _: int | None) -> Iterator[Recording]:
    from scipy.io import netcdf_file

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of views that are left when the file is closed
        with netcdf_file(str(file), "r", mmap=True) as held:
            columns: dict[str, Column] = {}
            for name, found in held.variables.items():
                attributes = dict(found._attributes)
                along = found.dimensions[0] if found.dimensions else ""
                scale = held.variables.get(along)
                is_time = scale is not None and along != name
                unit = word(getattr(scale, "units", "")) if is_time else ""

                def read(index: Index, found: Any = found, attributes: Any = attributes) -> np.ndarray:
                    values = np.array(found.data[index])  # a copy: the file is closed
                    return unpacked(values.astype(values.dtype.newbyteorder("=")), attributes)

                columns[name] = Column(
                    name, tuple(found.data.shape), read, OTHERS.get(found.data.dtype.kind, ""),
                    word(attributes.get("units", "")), along if plain_unit(unit) in TIMES else "",
                )  # fmt: skip
            yield Recording(file, columns)
            columns.clear()


@contextmanager
def read_mat5(file: Path, _: int | None) -> Iterator[Recording]:
    """MATLAB up to version 7: a variable at a time."""
    from scipy.io import loadmat, whosmat

    with open_file(file) as stream:
        size = os.fstat(stream.fileno()).st_size

        @lru_cache(maxsize=1)
        def loaded(variable: str) -> Any:
            stream.seek(0)
            return loadmat(stream, variable_names=[variable])[variable]

        def of_path(path: list[str]) -> Any:
            found = loaded(path[0])
            for part in path[1:]:
                found = found[part][0, 0]
            return found

        columns: dict[str, Column] = {}

        def take(path: list[str], shape: tuple[int, ...], other: str) -> None:
            name = ".".join(path)

            def read(index: Index) -> np.ndarray:
                return np.asarray(of_path(path)[index])

            columns[name] = Column(name, shape, read, other or beyond(shape, size))

        def take_fields(path: list[str], found: Any) -> None:
            for part in found.dtype.names or ():
                inner = found[part][0, 0]
                if getattr(inner, "dtype", None) is not None and inner.dtype.names and inner.shape == (1, 1):
                    take_fields([*path, part], inner)
                else:
                    kind = inner.dtype.kind if isinstance(inner, np.ndarray) else "O"
                    take([*path, part], np.shape(inner), OTHERS.get(kind, ""))

        for name, shape, kind in whosmat(stream):
            if kind == "struct" and tuple(shape) == (1, 1):
                take_fields([name], loaded(name))
            else:
                numbers = re.fullmatch(r"double|single|u?int\d+|logical", kind)
                take([name], tuple(shape), "" if numbers else f"no array of numbers but a {kind}")
        yield Recording(file, columns)


@contextmanager
def read_npz(file: Path, _: int | None) -> Iterator[Recording]:
    """Arrays of NumPy; objects, which would run code of the file, are not unpacked."""
    with zipfile.ZipFile(file) as packed, np.load(file, allow_pickle=False) as held:
        columns: dict[str, Column] = {}

        @lru_cache(maxsize=1)
        def loaded(name: str) -> np.ndarray:
            return np.asarray(held[name])

        for info in packed.infolist():
            if not info.filename.endswith(".npy"):
                continue
            name = info.filename.removesuffix(".npy")
            with packed.open(info) as member:
                version = np.lib.format.read_magic(member)
                header = np.lib.format.read_array_header_1_0 if version == (1, 0) else None
                shape, _, dtype = (header or np.lib.format.read_array_header_2_0)(member)

            def read(index: Index, name: str = name) -> np.ndarray:
                return loaded(name)[index]

            claims = math.prod(shape) * dtype.itemsize > info.file_size
            other = OTHERS.get(dtype.kind, "") or (LESS if claims else beyond(shape, info.compress_size))
            columns[name] = Column(name, shape, read, other)
        yield Recording(file, columns)


class Refusing(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        raise ValueError(record.getMessage()[:100])


@contextmanager
def refusing_warnings(logs: Any) -> Iterator[None]:
    """What npTDMS prints of a damaged file, and goes on, is refused meanwhile."""
    level, refusing = logs.console_handler.level, Refusing()
    logs.console_handler.setLevel(logging.CRITICAL)
    for log in logs.loggers.values():
        log.addHandler(refusing)
    try:
        yield
    finally:
        for log in logs.loggers.values():
            log.removeHandler(refusing)
        logs.console_handler.setLevel(level)


@contextmanager
def read_tdms(file: Path, _: int | None) -> Iterator[Recording]:
    """TDMS of LabVIEW. Channels that begin at different wf_start_time are on one clock, that of the first."""
    try:
        from nptdms import TdmsFile
        from nptdms.log import log_manager
    except ImportError:
        raise DataError(
            f"{file}: TDMS needs the Python package npTDMS: install it with '{sys.executable} -m pip install "
            "npTDMS'"
        ) from None
    # Of a stream: a file beside it, FILE_index, is not asked.
    with refusing_warnings(log_manager), open_file(file) as stream, TdmsFile.open(stream) as held:
        size = os.fstat(stream.fileno()).st_size
        channels = {f"{group.name}/{c.name}": c for group in held.groups() for c in group.channels()}
        starts = [c.properties[START] for c in channels.values() if START in c.properties]
        columns = {}
        for name, channel in channels.items():

            def read(index: Index, channel: Any = channel) -> np.ndarray:
                (part,) = index
                first, end, _ = part.indices(len(channel)) if isinstance(part, slice) else (part, part + 1, 1)
                return np.asarray(channel.read_data(first, end - first))

            has = channel.properties
            first_s = float(has.get("wf_start_offset", 0.0))
            if START in has:
                first_s += float((has[START] - min(starts)) / np.timedelta64(1, "ns")) * 1e-9
            other = OTHERS.get(getattr(channel.dtype, "kind", "O"), "")
            other = other or (LESS if len(channel) > 8 * size else "")  # digital lines are bits
            columns[name] = Column(
                name, (len(channel),), read, other, word(has.get("unit_string", "")),
                step_s=float(has.get("wf_increment", np.nan)), first_s=first_s,
            )  # fmt: skip
        yield Recording(file, columns)


START = "wf_start_time"


def cells_of(line: str, separator: str) -> list[str]:
    text = line if separator else " ".join(line.split())
    try:
        return [c.strip() for c in next(csv.reader([text.strip("\n")], delimiter=separator or " "), [])]
    except csv.Error:
        return []


def numbers_in(line: str, separator: str, texts: bool) -> tuple[int, bool]:
    """How many cells a line has, and whether its numbers have decimal commas; 0 of a line without numbers,
    or, unless columns of texts are among them, with others."""
    cells = cells_of(line, separator) if separator in line else []
    known = [c for c in cells if c.lower() not in NEVER or c.lower().endswith("inf")]
    best, comma = max((sum(is_decimal(c, comma) for c in known), not comma) for comma in (False, True))
    is_row = best > 0 if texts else 0 < best == len(known)
    return (len(cells) if is_row else 0), not comma


def is_decimal(cell: str, comma: bool) -> bool:
    try:
        float(cell.replace(",", ".", 1) if comma else cell)
    except ValueError:
        return False
    return True


@dataclass(frozen=True)
class Layout:
    """How a table of text is written."""

    first_line: int  # of the numbers, from 0
    separator: str
    n: int  # columns
    decimal_comma: bool
    header: list[str]
    units: list[str]


def header_cells(line: str, separator: str, n: int) -> list[str]:
    """Of a line above the numbers; names between blanks may hold single ones."""
    bare = line.lstrip("#%/! " if separator else "#%/! \t")
    cells = cells_of(bare, separator)
    wide = [] if separator or len(cells) == n else re.split(r"\s{2,}", bare.strip())
    return wide if len(wide) == n else cells


def layout_of(file: Path, lines: list[str], header_line: int | None) -> Layout:
    """header_line: from 1; 0: there is none; None: the line above the numbers that has as many cells."""
    for texts, k in product((False, True), range(header_line or 0, len(lines) - 1)):
        rows = [line for line in lines[k:] if line.strip()][: None if texts else 2]
        for separator in SEPARATORS:
            n = numbers_in(rows[0], separator, texts)[0] if len(rows) > 1 else 0
            found = [numbers_in(line, separator, texts) for line in rows] if n else []
            if n and all(count == n for count, _ in found):
                cells = [header_cells(line, separator, n) for line in lines[:k]]
                decimal = any(comma for _, comma in found)
                # Each line may end with a separator, the header without.
                widths = {n, n - (not any(cells_of(line, separator)[-1] for line in rows))}
                names, units = header_of(file, cells, widths, header_line)
                return Layout(k, separator, n, decimal, names, units)
    raise DataError(
        f"{file}: no two lines of numbers among the first {len(lines)}; forms read are {FORMS_READ}"
    )


def header_of(
    file: Path, above: list[list[str]], widths: set[int], header_line: int | None
) -> tuple[list[str], list[str]]:
    """Names and units of the columns, by the cells of the lines above the numbers."""
    if header_line:
        names = above[header_line - 1] if header_line <= len(above) else []
        if len(names) not in widths:
            raise DataError(
                f"{file}:{header_line}: the header has {len(names)} cells, the numbers have {max(widths)}"
            )
        units = next((cells for cells in above[header_line:] if len(cells) == len(names)), [])
        return names, units
    rows = list(enumerate(above, start=1))
    while rows and not any(rows[-1][1]):
        rows.pop()
    block: list[tuple[int, list[str]]] = []
    while header_line is None and rows and len(rows[-1][1]) in widths and any(rows[-1][1]):
        block.insert(0, rows.pop())
    has_units = len(block) > 1 and any(plain_unit(cell) in TIMES for cell in block[-1][1])
    names_at = block[:-1] if has_units else block
    if len(names_at) > 1:
        raise DataError(
            f"{file}:{names_at[0][0]}: this line and those up to {names_at[-1][0]} may be the header: give "
            "header_line, 0 where there is none"
        )
    return (names_at[0][1] if names_at else []), (block[-1][1] if has_units else [])


def cells_in_lines(body: bytes, separator: str) -> tuple[np.ndarray, np.ndarray]:
    """Of the lines that are not empty: their indices from 0, and the numbers of their cells."""
    signs = np.frombuffer(body, dtype=np.uint8)
    ends = np.flatnonzero(signs == ord("\n"))
    if not body.endswith(b"\n"):
        ends = np.append(ends, len(body))
    if separator:
        marks = np.flatnonzero(signs == ord(separator))
    else:
        blank = (signs == ord(" ")) | (signs == ord("\t")) | (signs == ord("\n"))
        marks = np.flatnonzero(~blank & np.append(True, blank[:-1]))
    counts = np.diff(np.searchsorted(marks, ends), prepend=0) + (1 if separator else 0)
    filled = np.diff(ends, prepend=-1) > 1 if separator else counts > 0
    return np.flatnonzero(filled), counts[filled]


@contextmanager
def read_text_table(file: Path, header_line: int | None) -> Iterator[Recording]:
    """Cells between semicolons, tabs, commas or blanks, perhaps with decimal commas, below lines of the
    recorder's own and names of the columns."""
    data = read_bytes(file)
    if b"\0" in data:
        raise DataError(f"{file}: not a file of the forms that are read: {FORMS_READ}")
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    body = io.BytesIO(data)
    raw = [body.readline() for _ in range(HEAD_LINES)]
    try:
        lines = [line.decode("utf-8-sig") for line in raw if line]
    except UnicodeDecodeError:
        lines = [line.decode("latin-1") for line in raw if line]
    of = layout_of(file, lines, header_line)
    begin = sum(map(len, raw[: of.first_line]))
    del body
    rows, counts = cells_in_lines(data[begin:], of.separator)
    if (wrong := np.flatnonzero(counts != of.n)).size:
        line = of.first_line + 1 + int(rows[wrong[0]])
        cut = ", and ends the file: cut off" if wrong[0] == len(rows) - 1 else ""
        raise DataError(f"{file}:{line}: {counts[wrong[0]]} cells, the lines before have {of.n}{cut}")
    table = pd.read_csv(
        io.BytesIO(data[begin:]), header=None, names=range(of.n), sep=of.separator or r"\s+",
        decimal="," if of.decimal_comma else ".", na_values=["-"], low_memory=False, encoding="latin-1",
        skipinitialspace=True, quoting=csv.QUOTE_NONE,
    )  # fmt: skip
    del data
    names = [*of.header, *[""] * (of.n - len(of.header))]
    columns: dict[str, Column] = {}
    for k, name in enumerate(names):
        known = name and names.count(name) == 1  # others go by their numbers
        label = name if known else str(k + 1)

        def read(index: Index, k: int = k, label: str = label) -> np.ndarray:
            values = table[k]
            if values.dtype.kind not in "fiub":
                bad = np.flatnonzero(pd.to_numeric(values, errors="coerce").isna() & values.notna())
                line = of.first_line + 1 + int(rows[bad[0]])
                shown = one_line(str(values.iloc[bad[0]]))
                raise DataError(f"{file}:{line}: '{shown}' in column '{one_line(label)}' is not a number")
            return values.to_numpy()[index]

        own = name_and_unit(name)[1] if named(name)[1] else ""
        unit = of.units[k] if k < len(of.units) else own
        columns[label] = Column(label, (len(table),), read, unit=unit.strip(" ()[]"))
    yield Recording(file, columns, numbered=True)


Opener = Callable[[Path, "int | None"], AbstractContextManager[Recording]]
#: By what a file begins with; all else is a table of text.
FORMS: tuple[tuple[Callable[[bytes], bool], Opener], ...] = (
    (lambda head: HDF5_MARK in (head[:8], head[AT_512 : AT_512 + 8]), read_hdf5),
    (lambda head: head.startswith(b"MATLAB 5.0"), read_mat5),
    (lambda head: head.startswith((b"CDF\x01", b"CDF\x02")), read_netcdf3),
    (lambda head: head.startswith(b"PK\x03\x04"), read_npz),
    (lambda head: head.startswith(b"TDSm"), read_tdms),
)


def file_head(file: Path) -> bytes:
    with open_file(file) as stream:
        return stream.read(AT_512 + 8)


@contextmanager
def open_recording(file: Path, header_line: int | None = None) -> Iterator[Recording]:
    """A recorder's file; what is no such file, or damaged, is refused.

    header_line: of a table of text, the line with the names of its columns, from 1; 0: there is none."""
    head = file_head(file)
    opener = next((opener for begins, opener in FORMS if begins(head)), read_text_table)
    what = "a file of a recorder"
    opened = opener(file, header_line)
    with reading(file, what):
        held = opened.__enter__()
    try:
        if not held.columns:
            raise DataError(f"{file}: holds no columns; forms read are {FORMS_READ}")
        yield held
    finally:
        opened.__exit__(None, None, None)


def times_of(recording: Recording, name: str, unit: str) -> np.ndarray:
    """The times of a column in s, by its own unit or the one that is given."""
    series = recording.series(name)
    of = f"{recording.file}: time '{one_line(name)}'"
    own = plain_unit(series.column.unit or name_and_unit(series.column.name)[1])
    if unit and own in TIMES and own != unit:
        raise DataError(
            f"{of} is in {own} by the file and in {unit} by the channels' table: correct it there"
        )
    if (unit or own) not in TIMES:
        raise DataError(f"{of} names none of the units {', '.join(TIMES)}: give it as time_s, time_us or so")
    time_s = in_si(series.read(), TIMES[unit or own])
    if not np.isfinite(time_s).all():
        raise DataError(f"{of} holds a value that is missing or not finite")
    falls = np.flatnonzero(~(np.diff(time_s) > 0))
    if falls.size:
        k = falls[0]
        raise DataError(
            f"{of} does not ascend: {time_s[k + 1]:.9g} follows {time_s[k]:.9g} s at its value {k + 2}; "
            "where times are even, give sample_rate_Hz instead"
        )
    return time_s
