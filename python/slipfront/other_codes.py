# SPDX-License-Identifier: BSD-3-Clause
"""Histories of an interface that other codes wrote, as OpenRun.history has them: docs/other-codes.md.

slip_m, slip_rate_m_per_s, t_Pa and p_Pa over time_s and x_m; tractions are absolute, p is positive in
compression. All raise DataError where files are damaged or do not belong together."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_trapezoid

from slipfront.errors import CaseError
from slipfront.files import DataError, one_line, open_file, read_text
from slipfront.given import in_order, number, path, shown
from slipfront.read import require, require_ascending
from slipfront.units import variables

OFF_LINE = 1e-3  # share of a line's length that its places may be beside it
# Fortran writes 1.5D-07, and 1.5-107 where the exponent has three digits.
EXPONENT = re.compile(r"([\d.])[dD]?([+-]\d)")
Lines = list[tuple[int, str]]  # of a file: numbers and contents of those that are not empty


def lines_of(file: Path) -> Lines:
    text = read_text(file)
    require(text.strip(), file, "empty")
    require(text.endswith("\n"), file, "the last line is cut off")
    return [(k, line) for k, line in enumerate(text.splitlines(), start=1) if line.strip()]


def fortran_number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return float(EXPONENT.sub(r"\1e\2", cell))


def numbers(file: Path, lines: Lines, columns: int | None = None) -> np.ndarray:
    """Of lines with equally many numbers. [lines, columns]"""
    rows = []
    for k, line in lines:
        cells = line.replace(",", " ").split()
        columns = len(cells) if columns is None else columns
        if len(cells) != columns:
            raise DataError(f"{file}:{k}: {len(cells)} numbers in place of {columns}")
        try:
            rows.append(np.array([fortran_number(cell) for cell in cells]))
        except ValueError as error:
            raise DataError(f"{file}:{k}: {one_line(str(error))}") from None
    return np.array(rows).reshape(len(rows), columns or 0)


def along_line(files: list[Path], points_m: np.ndarray) -> np.ndarray:
    """Positions along the straight line of the points, upwards in the coordinate that changes most.

    files: that of each point, for messages. points_m: [points, coordinates]"""
    require(len(points_m) >= 2, files[0], "fewer than two places")
    require(np.isfinite(points_m), files[0], "a coordinate is not finite")
    one_end = points_m[np.argmax(np.linalg.norm(points_m - points_m[0], axis=1))]
    span = points_m[np.argmax(np.linalg.norm(points_m - one_end, axis=1))] - one_end
    length_m = float(np.linalg.norm(span))
    require(length_m > 0, files[0], "all places are one")
    unit = span / length_m * np.sign(span[np.argmax(np.abs(span))])
    from_end_m = points_m - one_end
    beside_m = np.linalg.norm(from_end_m - np.outer(from_end_m @ unit, unit), axis=1)
    worst = int(np.argmax(beside_m))
    if beside_m[worst] > OFF_LINE * length_m:
        raise DataError(
            f"{files[worst]}: the place {points_m[worst].tolist()} is {beside_m[worst]:.3g} m beside the "
            "straight line between those farthest apart; give those of one line alone"
        )
    return points_m @ unit


def history_of(
    file: Path, code: str, time_s: np.ndarray, x_m: np.ndarray, fields: dict[str, Any]
) -> xr.Dataset:
    """What all readers return. fields: [times, places] by the names of a history; places in any order."""
    require(len(time_s) >= 2, file, "fewer than two times")
    require_ascending(file, "time", time_s)
    order = np.argsort(x_m)
    require(np.diff(x_m[order]) > 0, file, "two places are one")
    for name, values in fields.items():
        require(np.isfinite(values), file, f"a value of {name} is missing or not finite")
    columns = {name: np.asarray(values, np.float64)[:, order] for name, values in fields.items()}
    axes = variables(("time_s",), {"time_s": time_s}) | variables(("x_m",), {"x_m": x_m[order]})
    return xr.Dataset(variables(("time_s", "x_m"), columns), axes, {"source": f"{code}: {file}"})


# ---- SEM2DPACK


def fortran_records(file: Path, header: Path, n_numbers: int) -> np.ndarray:
    """Unformatted records of n_numbers single precision numbers, of either byte order, with markers of 4 or 8
    bytes. [records, n_numbers]"""
    n_bytes = 4 * n_numbers
    with open_file(file) as stream:
        size = os.fstat(stream.fileno()).st_size
        require(size >= n_bytes + 8, file, f"cut off: shorter than a record of the NPTS of {header}")
        for order, marker in (("<", "i4"), (">", "i4"), ("<", "i8"), (">", "i8")):
            kind = np.dtype(
                [("head", order + marker), ("values", order + "f4", (n_numbers,)), ("tail", order + marker)]
            )
            stream.seek(0)
            first = np.fromfile(stream, kind, 1)
            if len(first) and first["head"][0] == first["tail"][0] == n_bytes:
                break
        else:
            raise DataError(
                f"{file}: its first record is not of {n_numbers} numbers of 4 bytes, the NPTS of {header}: "
                "of another run, or damaged"
            )
        require(size % kind.itemsize == 0, file, "cut off: it ends within a record")
        stream.seek(0)
        try:
            records = np.fromfile(stream, kind)
        except MemoryError:
            raise DataError(f"{file}: does not fit into memory") from None
    require((records["head"] == n_bytes) & (records["tail"] == n_bytes), file, "a record is damaged")
    return records["values"]


def read_sem2dpack(header: str | os.PathLike[str], *, first_time_s: float = 0.0) -> xr.Dataset:
    """The fault of a SEM2DPACK run (BC_DYNFLT), from FltXX_sem2d.hdr, FltXX_sem2d.dat, FltXX_init_sem2d.tab
    and, of adaptive time steps, FltXX_time_sem2d.tab in its folder.

    header: FltXX_sem2d.hdr. first_time_s: time of the first sample, ot1 of BC_DYNFLT, which the header does
    not hold; with adaptive steps the times are in a file.

    Format: sem2dpack, SRC/bc_dynflt.f90 and POST/sem2d_read_fault.m. Stresses of the .dat file are changes,
    tension is positive, and right-lateral slip and the traction that drives it are positive: as here."""
    file = path(header, "header")
    stem = file.name.removesuffix("_sem2d.hdr")
    require(stem != file.name, file, "not the name of a header, FltXX_sem2d.hdr")
    lines = lines_of(file)
    require(len(lines) >= 4, file, "fewer than the four lines of a header")
    sizes = numbers(file, lines[1:2])[0]
    require(np.isfinite(sizes) & (sizes >= 0), file, "a size in line 2 is negative or not finite")
    require(len(sizes) in (2, 4), file, "line 2 is neither NPTS NDAT NSAMP DELT nor NPTS NDAT")
    require(sizes[:3] == np.round(sizes[:3]), file, "a number of line 2 is not whole: NPTS, NDAT or NSAMP")
    require(sizes[0] >= 2, file, "NPTS is below 2")
    n_places, n_fields = int(sizes[0]), int(sizes[1])
    require(n_fields >= 5, file, f"NDAT = {n_fields}: not a fault with friction (BC_DYNFLT)")
    points_m = numbers(file, lines[4:], 2)
    require(
        len(points_m) == n_places, file, f"NPTS = {n_places}, but places of {len(points_m)} nodes: damaged"
    )

    table = file.with_name(f"{stem}_init_sem2d.tab")
    # A compiler may break long lines: numbers are counted, not lines.
    cells = [cell for line in lines_of(table) for cell in numbers(table, [line])[0]]
    n_columns = len(cells) // max(n_places, 1)
    require(
        n_columns >= 3 and n_columns * n_places == len(cells),
        table,
        f"not three or more numbers of {n_places} nodes",
    )
    require(np.isfinite(cells), table, "a value is not finite")
    t_0, s_0 = np.array(cells).reshape(n_places, n_columns).T[:2]

    data = file.with_name(f"{stem}_sem2d.dat")
    records = fortran_records(data, file, n_places)
    n_times = len(records) // n_fields
    require(n_times * n_fields == len(records), data, f"cut off: it ends within a time of {n_fields} records")
    slip, rate, t, s = (records[k::n_fields] for k in range(4))
    if len(sizes) == 2:
        times = file.with_name(f"{stem}_time_sem2d.tab")
        time_s = numbers(times, [(k, " ".join(line.split()[2:3])) for k, line in lines_of(times)], 1)[:, 0]
        require(len(time_s) == n_times, times, f"{len(time_s)} times, {data.name} has {n_times}")
    else:
        # The program rounds the number of samples in its own way: one more or fewer is whole.
        require(
            abs(n_times - sizes[2]) <= 1,
            data,
            f"{n_times} times, NSAMP of its header is {sizes[2]:g}: the run was stopped, or goes on; to read "
            "what there is, write the number of times into line 2 of the header",
        )
        first = number(first_time_s, "first_time_s", finite=True)
        time_s = first + sizes[3] * np.arange(n_times)
    fields = {"slip_m": slip, "slip_rate_m_per_s": rate, "t_Pa": t_0 + t, "p_Pa": -(s_0 + s)}
    return history_of(data, "SEM2DPACK", time_s, along_line([file] * n_places, points_m), fields)


# ---- uguca


def uguca_field(file: Path, form: str, shape: tuple[int, int]) -> np.ndarray:
    """A dumped field. [times, nodes]"""
    if form == "binary":
        with open_file(file) as stream:
            size, wanted = os.fstat(stream.fileno()).st_size, 4 * shape[0] * shape[1]
            told = f"{size} bytes, {shape[0]} times of {shape[1]} nodes take {wanted}"
            require(size == wanted, file, f"{told}: cut off, or of a run that goes on")
            return np.fromfile(stream, "<f4").reshape(shape)
    values = numbers(file, lines_of(file), shape[1])
    require(len(values) == shape[0], file, f"{len(values)} rows, there are {shape[0]} times: cut off")
    return values


def read_uguca(
    info: str | os.PathLike[str], *, below: str | None = None, p_Pa: float | None = None
) -> xr.Dataset:
    """The dump of a uguca run of a 2D problem, in any of its formats: cohesion_0, cohesion_1, top_disp_0 and
    top_velo_0, and of two materials bot_disp_0 and bot_velo_0.

    info: NAME.info. below: what is below the interface where nothing of it is dumped: "mirrored", the same
    material (UnimatShearInterface), whose slip is twice the displacement of the top, or "rigid"
    (DefRigInterface). p_Pa: the pressure, uniform and constant, where cohesion_1 is not dumped.

    Format: uguca, src/uca_dumper.cc; binary files are of a little-endian machine. Signs:
    src/interface_laws/linear_coulomb_friction_law.cc and src/half_space.cc; cohesion_0 holds the top back
    from +x, cohesion_1 is negative in compression."""
    file = path(info, "info")
    if below not in (None, "mirrored", "rigid"):
        raise CaseError(f"below is {shown(below)}; it must be 'mirrored' or 'rigid'")
    told = words_of(file)
    for key in ("time_description", "coord_description", "field_description", "folder_name", "output_format"):
        require(key in told, file, f"no entry '{key}': not the .info of a dump")
    require("rank_description" not in told, file, "a dump of several ranks, each its own files: not read")
    form = told["output_format"]
    require(form in ("ascii", "csv", "binary"), file, "output_format is not ascii, csv or binary")
    times, places, names = (file.parent / told[f"{key}_description"] for key in ("time", "coord", "field"))
    time_s = numbers(times, lines_of(times), 2)[:, 1]
    points_m = numbers(places, lines_of(places))
    x_m = along_line([places] * len(points_m), points_m)

    dumped = words_of(names)

    def field(name: str, otherwise: str) -> np.ndarray:
        require(name in dumped, names, f"'{name}' was not dumped: {otherwise}")
        place = file.parent / told["folder_name"] / dumped[name]
        values = uguca_field(place, form, (len(time_s), len(x_m)))
        require(np.isfinite(values), place, "a value is missing or not finite")
        return values

    def jump(name: str) -> np.ndarray:
        top = field(f"top_{name}", "dump it")
        if below is not None:
            return top if below == "rigid" else 2 * top
        return top - field(f"bot_{name}", "dump it, or set below to 'mirrored' or 'rigid'")

    t = field("cohesion_0", "dump it")
    fields = {"slip_m": jump("disp_0"), "slip_rate_m_per_s": jump("velo_0"), "t_Pa": t}
    if p_Pa is None:
        fields["p_Pa"] = -field(
            "cohesion_1", "dump it, or set p_Pa where the pressure is uniform and constant"
        )
    else:
        fields["p_Pa"] = np.full_like(t, number(p_Pa, "p_Pa", least=0, finite=True))
    return history_of(file, "uguca", time_s, x_m, fields)


def words_of(file: Path) -> dict[str, str]:
    """Lines of a word and what it stands for."""
    pairs = [line.split(maxsplit=1) for _, line in lines_of(file)]
    require(all(len(pair) == 2 for pair in pairs), file, "a line is not a name and its value")
    return {name: value.strip() for name, value in pairs}


# ---- SeisSol


@dataclass(frozen=True)
class Receiver:
    """A fault receiver of SeisSol."""

    file: Path
    head: Mapping[str, float]  # x1, x2, x3, P_0, T_s, T_d
    columns: Mapping[str, np.ndarray]  # [times]

    @property
    def time_s(self) -> np.ndarray:
        return self.columns["Time"]

    def column(self, name: str) -> np.ndarray:
        require(
            name in self.columns, self.file, f"no column '{name}': set its bit in the OutputMask of Pickpoint"
        )
        require(np.isfinite(self.columns[name]), self.file, f"a value of '{name}' is not finite")
        return self.columns[name]

    def whole(self, total: str, change: str, before: str) -> np.ndarray:
        """A traction: its total where there is one, which loads that grow in time are part of."""
        if total in self.columns:
            return self.column(total)
        require(before in self.head, self.file, f"no line '# {before}' and no column '{total}'")
        return self.column(change) + self.head[before]

    def slip_and_rate(self, along: str) -> tuple[np.ndarray, np.ndarray]:
        """Along strike, s, or dip, d. The rate is that at which slip grows, where there is slip: the column
        may be tens of mm/s long before slip grows, as it is in TPV104."""
        if f"Sl{along}" in self.columns:
            slip = self.column(f"Sl{along}")
            return slip, np.gradient(slip, self.time_s)
        v = self.column(f"SR{along}")
        return cumulative_trapezoid(v, self.time_s, initial=0), v

    def largest_slip_m(self, along: str) -> float:
        """0 where it is not told."""
        known = any(np.isfinite(self.columns.get(f"{name}{along}", np.nan)).all() for name in ("Sl", "SR"))
        return float(np.abs(self.slip_and_rate(along)[0]).max()) if known else 0.0


def read_receiver(file: Path) -> Receiver:
    names: list[str] = []
    head: dict[str, float] = {}
    rows = []
    for k, line in lines_of(file):
        if line.lstrip().startswith("VARIABLES"):
            names = re.findall(r'"([^"]*)"', line)
        elif line.lstrip().startswith("#"):
            # P_01, T_s1 and T_d1 in versions that can run several simulations at once.
            found = re.fullmatch(r"\s*#\s*(x[123]|P_0|T_[sd])1?\s+(\S+)\s*", line)
            if found:
                require(found[1] not in head, file, "of several receivers: let SeisSol write a file for each")
                head[found[1]] = float(numbers(file, [(k, found[2])], 1)[0, 0])
        elif not line.lstrip().startswith("TITLE"):
            rows.append((k, line))
    require("Time" in names, file, "no column 'Time': not a fault receiver of SeisSol")
    require(all(f"x{k}" in head for k in (1, 2, 3)), file, "no lines '# x1', '# x2', '# x3' with its place")
    columns = dict(zip(names, numbers(file, rows, len(names)).T, strict=True))
    require(len(rows) >= 2, file, "fewer than two times")
    require_ascending(file, "Time", columns["Time"])
    return Receiver(file, head, columns)


def common_times(receivers: list[Receiver]) -> np.ndarray:
    """Those of the receiver with most of them, as far as all have some. Steps may differ, records may not:
    local time steps begin and end within a step of one another."""
    longest = max(receivers, key=lambda r: len(r.time_s)).time_s
    step_s = max(float(np.diff(r.time_s).max()) for r in receivers)
    for end, word, of_others in ((0, "begins", min), (-1, "ends", max)):
        extreme_s = of_others(float(r.time_s[end]) for r in receivers)
        for r in receivers:
            if abs(r.time_s[end] - extreme_s) > step_s * (1 + 1e-9):
                raise DataError(
                    f"{r.file}: {word} at {r.time_s[end]:g} s, another receiver at {extreme_s:g} s: cut off, "
                    "or of another run"
                )
    start, stop = max(r.time_s[0] for r in receivers), min(r.time_s[-1] for r in receivers)
    return longest[(longest >= start) & (longest <= stop)]


def read_seissol_fault_receivers(
    files: Iterable[str | os.PathLike[str]], *, component: str = "strike"
) -> xr.Dataset:
    """Fault receivers of SeisSol on a straight line, NAME-faultreceiver-00001.dat and so on, a file each.
    Times are those of the receiver with most of them; the others are interpolated linearly.

    component: "strike" or "dip", of slip and shear traction. The slip rate is that at which slip grows, by
    central differences. In the attribute notes: where slip is larger along the other component.

    Format: SeisSol, src/DynamicRupture/Output/OutputManager.cpp and Documentation/fault-output.rst: Ts0, Td0
    and Pn0 are tractions, T_s, T_d and P_n their changes since those of the lines that begin with #. Signs:
    Documentation/dynamic-rupture.rst: negative in compression; along strike, where z points up, right-lateral
    slip and the traction that drives it are positive, as here; along dip they are left as they are."""
    if component not in ("strike", "dip"):
        raise CaseError(f"component is {shown(component)}; it must be 'strike' or 'dip'")
    places = [path(each, "a file") for each in in_order(files, "files", "a list of paths")]
    if len(places) < 2:
        raise CaseError(f"files has {len(places)} paths; it must have two or more")
    receivers = [read_receiver(each) for each in places]
    time_s = common_times(receivers)
    x_m = along_line(places, np.array([[r.head[f"x{k}"] for k in (1, 2, 3)] for r in receivers]))
    c = component[0]

    def over_time(values: Iterable[np.ndarray]) -> np.ndarray:
        pairs = zip(receivers, values, strict=True)
        return np.stack([np.interp(time_s, r.time_s, each) for r, each in pairs], axis=1)

    slips, rates = zip(*(r.slip_and_rate(c) for r in receivers), strict=True)
    fields = {
        "slip_m": over_time(slips),
        "slip_rate_m_per_s": over_time(rates),
        "t_Pa": over_time([r.whole(f"T{c}0", f"T_{c}", f"T_{c}") for r in receivers]),
        "p_Pa": -over_time([r.whole("Pn0", "P_n", "P_0") for r in receivers]),
    }
    history = history_of(places[0], "SeisSol", time_s, x_m, fields)
    other = {"strike": "dip", "dip": "strike"}[component]
    own_m = float(np.abs(fields["slip_m"]).max())
    other_m = max(r.largest_slip_m(other[0]) for r in receivers)
    history.attrs["notes"] = (
        [f"slip is up to {other_m:.3g} m along {other}, {own_m:.3g} m along {component}: set component to "
         f"'{other}' if that is meant"] if other_m > own_m else []
    )  # fmt: skip
    return history
