# SPDX-License-Identifier: BSD-3-Clause
"""Reads the files of an output folder into arrays. SI units; undefined values are NaN.

`python -m slipfront.read DIR` tells whether the files are those that the program wrote."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slipfront import command
from slipfront.files import (
    DataError,
    Table,
    dataset,
    is_folder,
    open_file,
    open_hdf5,
    read_bytes,
    read_json_table,
    read_table,
)
from slipfront.folder import LIST, RUN, SEQUENCE, UNFINISHED, belongs, result_file, verify_checksums

STATIC_COLUMNS = ("x_m", "t_s_Pa", "p_s_Pa")
FRONT_COLUMNS = (
    "front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s", "t_s_Pa", "p_s_Pa", "t_d_Pa", "p_d_Pa",
    "t_r_Pa", "p_r_Pa", "U_s_J_per_m3", "U_r_J_per_m3",
)  # fmt: skip
# Columns of fracture.csv that pages and tables take.
FRACTURE_COLUMNS = ("breakdown_work_J_per_m2", "cohesive_zone_m", "G_slip_J_per_m2")
# What the time says that a tip takes at a row of fronts.csv; there is a speed with the first alone.
SPEED_KINDS = ("front", "triggered", "simultaneous", "path_end")
# Data sets of interface.h5; per row after the time, each at all nodes, in this order.
HISTORY_FIELDS = ("slip_m", "slip_rate_m_per_s", "t_Pa", "p_Pa")
# Data sets of probes.h5, [times, probes].
PROBE_FIELDS = (
    "u_x_m", "u_y_m", "v_x_m_per_s", "v_y_m_per_s", "strain_xx", "strain_yy", "strain_zz", "strain_xy",
    "stress_xx_Pa", "stress_yy_Pa", "stress_zz_Pa", "stress_xy_Pa",
)  # fmt: skip
# Columns of energy.csv without their unit, J per m of thickness.
ENERGY_TERMS = (
    "strain", "kinetic", "machine", "top_work", "trigger_work", "prestress_work", "friction_work",
    "contact_work", "damping_work", "boundary_work", "coupling_work",
)  # fmt: skip
VTK_QUAD = 9
BLOCK_BYTES = 4096  # a head of a file of rows is of whole ones

BLEW_UP = "blew_up"  # its last numbers may be no numbers
# What a run.json tells of the run's end, by "status" or, in older folders, by "end"; None: all is well.
STATUSES = {
    "complete": None,
    "interrupted": "interrupted at",
    BLEW_UP: "blew up at",
    "failed": "failed at",
    "running": "still running or killed, results up to",
}
OLD_ENDS = {"interrupted": "interrupted", "blow_up": BLEW_UP}
WITHOUT_END = ("running", "failed")  # these may leave rows that are half written


def ratio(numerator: np.ndarray, denominator: np.ndarray) -> np.ndarray:
    """Quotient, NaN where the denominator is zero."""
    out = np.full(np.shape(numerator), np.nan)
    np.divide(numerator, denominator, out=out, where=np.asarray(denominator) != 0)
    return out


def even(n: int, most: int) -> np.ndarray:
    """At most so many of n, the first and the last among them."""
    return np.unique(np.round(np.linspace(0, n - 1, min(n, most))).astype(int))


def median(values: np.ndarray) -> float:
    """Of those that are defined; NaN without any."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) > 0 else np.nan


@dataclass(frozen=True)
class Front:
    """A front's passage over the nodes of the interface, in the order of travel. [points]"""

    id: int
    direction: int  # +1 or -1 along x; the imposed shear is to +1
    x_m: np.ndarray
    onset_s: np.ndarray
    v_tip_m_per_s: np.ndarray  # NaN where nothing travels
    speed_kind: np.ndarray  # one of SPEED_KINDS; empty texts of a program that did not tell them apart
    static_ratio: np.ndarray  # t_s / p_s
    dynamic_ratio: np.ndarray  # t_d / p_d
    energy_rise: np.ndarray  # (U_r - U_s) / U_s

    @property
    def length_m(self) -> float:
        return float(np.ptp(self.x_m))

    def tip_m(self, time_s: float) -> float | None:
        """Position of the tip, linear between onsets; None before the first and after the last of them."""
        if not self.onset_s[0] <= time_s <= self.onset_s[-1]:
            return None
        return float(np.interp(time_s, np.maximum.accumulate(self.onset_s), self.x_m))


def longest_each_way(fronts: Iterable[Front]) -> dict[int, Front]:
    """By direction; the first of equal ones."""
    return {front.direction: front for front in sorted(fronts, key=lambda front: (front.length_m, -front.id))}


@dataclass(frozen=True)
class Fields:
    """The mesh of fields.vtkhdf and the times of its steps; the fields themselves are read step by step."""

    file: Path
    points_m: np.ndarray  # [nodes, 2]
    cells: np.ndarray  # [cells, 4], counterclockwise
    time_s: np.ndarray  # [steps]

    def speed_m_per_s(self, step: int) -> np.ndarray:
        """Magnitude of the velocity at the nodes. [nodes]"""
        n = len(self.points_m)
        with open_hdf5(self.file) as file:
            group = file["VTKHDF"]
            first = int(dataset(group, "Steps/PointDataOffsets/velocity_m_per_s", 1)[step])
            velocity = dataset(group, "PointData/velocity_m_per_s", 2)
            if not 0 <= first <= len(velocity) - n:
                raise DataError(f"{self.file}: step {step} of velocity_m_per_s has not {n} rows")
            speed = np.linalg.norm(velocity[first : first + n], axis=1)
        if not np.isfinite(speed).all():
            raise DataError(f"{self.file}: a number of step {step} of velocity_m_per_s is not finite")
        return speed


@dataclass(frozen=True)
class Balance:
    """energy.csv: changes of the stored energies, works done on the plate, and what they leave open."""

    time_s: np.ndarray  # [rows]
    terms: dict[str, np.ndarray]  # by the names of ENERGY_TERMS, J/m. [rows]
    imbalance_J_per_m: np.ndarray  # [rows]

    @property
    def largest_J_per_m(self) -> float:
        """Largest magnitude of any term at any time."""
        return max(float(np.max(np.abs(values))) for values in self.terms.values())


@dataclass(frozen=True)
class Place:
    """Where the results of a run or a sequence are and how it ended. `info` is run.json or sequence.json as a
    dictionary."""

    name: str
    folder: Path  # its own, or its unfinished/
    info: dict[str, Any]
    status: str  # one of STATUSES
    reason: str  # may be empty
    notes: tuple[str, ...]  # what a reader of the figures should know besides, a line each

    @property
    def growing(self) -> bool:
        """Whether files may end within a row."""
        return self.status in WITHOUT_END

    def mark(self, last_s: float) -> str:
        """How a run ended that did not come to its end, for titles; empty for a complete one."""
        ending = STATUSES[self.status]
        return "" if ending is None else f"{ending} t = {1e6 * last_s:.4g} µs"

    def with_reason(self, mark: str) -> str:
        """A mark with the reason, or a reason that begins as the mark does, and says it all."""
        if not self.reason:
            return mark
        return self.reason if self.reason.split()[:1] == mark.split()[:1] else f"{mark} ({self.reason})"

    def remarks(self, last_s: float) -> list[str]:
        """Lines to print beside the figures."""
        mark = self.mark(last_s)
        if not mark:
            return list(self.notes)
        told = f"{self.folder}: {self.with_reason(mark)}: the figures show what there is"
        return [told.replace("µs", "us"), *self.notes]


def entry(table: dict[str, Any], part: str, key: str) -> Any:
    """A key of a part of a file; None where there is none."""
    inner = table.get(part)
    return inner.get(key) if isinstance(inner, dict) else None


def read_columns(
    file: Path, columns: tuple[str, ...], growing: bool = False, finite: bool = True
) -> dict[str, np.ndarray]:
    """The named columns of a result's table as numbers; other columns are passed over."""
    table = read_table(result_file(file), growing=growing)
    return {name: table.numbers(name, finite) for name in columns}


def n_finite(*arrays: np.ndarray) -> int:
    """Number of rows before the first that holds a number that is not finite."""
    finite = np.all([np.isfinite(a).reshape(len(a), -1).all(axis=1) for a in arrays], axis=0)
    return len(finite) if finite.all() else int(np.argmin(finite))


def require(holds: Any, file: Path, what: str) -> None:
    """Refuses a file unless all of `holds` is true."""
    if not np.all(holds):
        raise DataError(f"{file}: {what}")


def require_ascending(file: Path, name: str, values: np.ndarray) -> None:
    require(np.isfinite(values), file, f"a value of {name} is missing or not finite")
    falls = np.flatnonzero(~(np.diff(values) > 0))
    if len(falls):
        before, after = values[falls[0]], values[falls[0] + 1]
        raise DataError(
            f"{file}: {name} does not ascend: {after:.6g} follows {before:.6g}; sort, one row for each"
        )


def read_static(file: Path) -> dict[str, np.ndarray]:
    columns = read_columns(file, STATIC_COLUMNS)
    require(len(columns["x_m"]) >= 2, file, "fewer than two rows")
    require_ascending(file, "x_m", columns["x_m"])
    return columns


def speed_kinds(table: Table) -> np.ndarray:
    """Column speed_kind of fronts.csv; empty texts in files of before there was one. [rows]"""
    if "speed_kind" not in table.header:
        return np.full(len(table.rows), "")
    kinds = np.array(table.texts("speed_kind"), dtype=str)
    require(np.isin(kinds, SPEED_KINDS), table.file, "a value of column 'speed_kind' is none of its words")
    return kinds


def read_fronts(file: Path, growing: bool = False) -> list[Front]:
    table = read_table(result_file(file), growing=growing)
    columns = {name: table.numbers(name) for name in FRONT_COLUMNS}
    kinds = speed_kinds(table)
    for name in ("front_id", "x_m", "onset_s", "direction"):
        require(~np.isnan(columns[name]), file, f"empty cell in column '{name}'")
    ids = columns["front_id"]
    require(np.abs(columns["direction"]) == 1, file, "a value other than 1 and -1 in column 'direction'")
    require(
        (ids == np.round(ids)) & (np.abs(ids) < 2**31), file, "a value of column 'front_id' is not an integer"
    )
    fronts = []
    for front_id in dict.fromkeys(ids):  # in the order of the file
        c = {name: values[ids == front_id] for name, values in columns.items()}
        ahead = np.diff(c["x_m"]) * c["direction"][0] > 0
        require(ahead, file, f"front {int(front_id)} does not go on in its direction")
        require(c["direction"] == c["direction"][0], file, f"front {int(front_id)} has two directions")
        fronts.append(
            Front(
                id=int(front_id),
                direction=int(c["direction"][0]),
                x_m=c["x_m"],
                onset_s=c["onset_s"],
                v_tip_m_per_s=c["v_tip_m_per_s"],
                speed_kind=kinds[ids == front_id],
                static_ratio=ratio(c["t_s_Pa"], c["p_s_Pa"]),
                dynamic_ratio=ratio(c["t_d_Pa"], c["p_d_Pa"]),
                energy_rise=ratio(c["U_r_J_per_m3"] - c["U_s_J_per_m3"], c["U_s_J_per_m3"]),
            )
        )
    return fronts


def read_fracture(
    file: Path, fronts: list[Front], blew_up: bool = False
) -> dict[int, dict[str, np.ndarray]] | None:
    """FRACTURE_COLUMNS at the points of each front, by its id; NaN where the breakdown did not come to its
    end. None of a run by an earlier version."""
    if not belongs(file):
        return None
    names = ("front_id", "x_m", "breakdown_complete", *FRACTURE_COLUMNS)
    columns = read_columns(file, names, finite=not blew_up)
    points = np.array([(front.id, x) for front in fronts for x in front.x_m]).reshape(-1, 2)
    same = np.array_equal(points, np.column_stack([columns["front_id"], columns["x_m"]]))
    require(same, file, "its rows are not those of fronts.csv: the files are of two runs")
    done = columns["breakdown_complete"] == 1
    return {
        front.id: {
            name: np.where(done, columns[name], np.nan)[columns["front_id"] == front.id]
            for name in FRACTURE_COLUMNS
        }
        for front in fronts
    }


def is_open(file: Path) -> bool:
    """Whether a file of rows is not finished: it begins with the length of its head, not as HDF5 files do."""
    return head_bytes(file) is not None


def head_bytes(file: Path) -> int | None:
    """Where the rows begin of a file that is not finished; None of others."""
    with open_file(file) as stream:
        length = int.from_bytes(stream.read(8), "little")
    return length if length > 0 and length % BLOCK_BYTES == 0 else None


def open_history(file: Path, x_m: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times and, by name, HISTORY_FIELDS and the law's states [times, nodes] of an open interface.h5; a cut
    row is left out."""
    facts = file.parent / "run.json"
    states = read_json_table(facts).get("law_states", [])
    is_list = isinstance(states, list) and all(isinstance(name, str) for name in states)
    require(is_list, facts, "'law_states' are not names")
    names = (*HISTORY_FIELDS, *states)
    data = read_bytes(file)[head_bytes(file) :]
    n = len(x_m)
    width = 1 + len(names) * n
    n_rows = len(data) // (8 * width)
    rows = np.frombuffer(data, dtype="<f8", count=n_rows * width).reshape(n_rows, width)
    fields = {name: rows[:, 1 + k * n : 1 + (k + 1) * n] for k, name in enumerate(names)}
    return rows[:, 0], fields


def read_fields(file: Path) -> Fields:
    file = result_file(file)
    with open_hdf5(file) as hdf5:
        if "VTKHDF" not in hdf5:
            raise DataError(f"{file}: no group 'VTKHDF'")
        group = hdf5["VTKHDF"]
        n_points = int(dataset(group, "NumberOfPoints", 1)[0])
        n_cells = int(dataset(group, "NumberOfCells", 1)[0])
        points = dataset(group, "Points", 2)[:, :2]
        types = dataset(group, "Types", 1)[()]
        offsets = dataset(group, "Offsets", 1)[()]
        connectivity = dataset(group, "Connectivity", 1)[()]
        time_s = dataset(group, "Steps/Values", 1)[()]
        starts = dataset(group, "Steps/PointDataOffsets/velocity_m_per_s", 1)[()]
        velocity = dataset(group, "PointData/velocity_m_per_s", 2).shape
    require(
        n_points > 0 and points.shape == (n_points, 2),
        file,
        "the points are not as many as NumberOfPoints says",
    )
    require(np.isfinite(points), file, "a coordinate is not finite")
    complete = len(types) == n_cells > 0 and len(offsets) == n_cells + 1 and len(connectivity) == 4 * n_cells
    require(
        complete and (types == VTK_QUAD).all() and np.array_equal(offsets, 4 * np.arange(n_cells + 1)),
        file,
        "cells other than four-node quadrilaterals",
    )
    require((connectivity >= 0) & (connectivity < n_points), file, "a cell has a node that does not exist")
    require_ascending(file, "the time of the snapshots", time_s)
    inside = (starts >= 0) & (starts <= velocity[0] - n_points)
    require(
        len(starts) == len(time_s) and inside.all(), file, "a snapshot's velocity_m_per_s is not in the file"
    )
    return Fields(file, points, connectivity.reshape(-1, 4).astype(np.int64), time_s)


def read_balance(file: Path, growing: bool = False, blew_up: bool = False) -> Balance:
    table = read_table(result_file(file), growing=growing)
    names = ("time_s", *(f"{term}_J_per_m" for term in ENERGY_TERMS), "imbalance_J_per_m")
    older = {"machine_J_per_m"} - set(table.header)  # results from before there were machines
    columns = {name: table.numbers(name, finite=not blew_up) for name in names if name not in older}
    columns |= {name: np.zeros(len(columns["time_s"])) for name in older}
    if blew_up:
        n = n_finite(*columns.values())
        columns = {name: values[:n] for name, values in columns.items()}
    require(len(columns["time_s"]) >= 2, file, "fewer than two rows")
    for name, values in columns.items():
        require(~np.isnan(values), file, f"empty cell in column '{name}'")
    require_ascending(file, "time_s", columns["time_s"])
    terms = {term: columns[f"{term}_J_per_m"] for term in ENERGY_TERMS}
    return Balance(
        columns["time_s"], {term: v - v[0] for term, v in terms.items()}, columns["imbalance_J_per_m"]
    )


def is_sequence(folder: Path) -> bool:
    """Whether the results that read_place takes from a folder are those of a sequence of events."""
    place = folder if belongs(folder / RUN) or belongs(folder / SEQUENCE) else folder / UNFINISHED
    return belongs(place / SEQUENCE)


def read_place(folder: Path, status_file: str = RUN) -> Place:
    """The complete results in the folder of a run or, where there are none, those in its unfinished/; of a
    sequence with SEQUENCE as status_file."""
    if not is_folder(folder):
        raise DataError(f"{folder}: no such folder; name the output folder of a run")
    if status_file == RUN and is_sequence(folder):
        raise DataError(f"{folder}: is of a sequence of events; name the folder of one of them, in events/")
    place, notes = folder, []
    if is_folder(folder / UNFINISHED):
        if belongs(folder / status_file):
            notes = [f"{folder / UNFINISHED}: another run, not finished: the figures show the complete one"]
        else:
            place = folder / UNFINISHED
    file = place / status_file
    info = read_json_table(result_file(file))
    status = info.get("status", OLD_ENDS.get(str(info.get("end")), "complete"))
    reason = info.get("reason", "")
    require(
        isinstance(status, str) and status in STATUSES, file, "'status' is not one of " + ", ".join(STATUSES)
    )
    require(isinstance(reason, str), file, "'reason' is not a text")
    if place != folder and status == "complete":
        notes = [f"{place}: a finished run that was not moved to its place"]
    fronts = info.get("fronts", [])
    require(
        isinstance(fronts, list) and all(isinstance(f, dict) for f in fronts), file, "'fronts' is not a list"
    )
    return Place(folder.name or folder.resolve().name, place, info, status, reason, tuple(notes))


def require_same_nodes(file: Path, x_m: np.ndarray, static_x_m: np.ndarray) -> None:
    same = len(x_m) == len(static_x_m) and np.allclose(x_m, static_x_m)
    require(same, file, "its nodes are not those of static.csv: the files are of two runs")


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m slipfront.read",
        description=f"Tells whether the files of a folder match its {LIST}: exit code 0 if so, else 1.",
    )
    parser.add_argument("dir", metavar="DIR", type=Path, help="output folder of slipfront")
    folder = parser.parse_args(arguments).dir
    problems: list[str] = []

    def compare() -> list[str]:
        problems.extend(verify_checksums(folder))
        return problems or [f"{folder}: all files match {LIST}"]

    return command.run("slipfront.read", compare) or int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
