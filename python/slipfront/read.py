# SPDX-License-Identifier: BSD-3-Clause
"""Reads the files of an output folder into arrays. SI units; undefined values are NaN."""

from __future__ import annotations

import csv
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

STATIC_COLUMNS = ("x_m", "t_s_Pa", "p_s_Pa")
FRONT_COLUMNS = (
    "front_id",
    "x_m",
    "onset_s",
    "direction",
    "v_tip_m_per_s",
    "t_s_Pa",
    "p_s_Pa",
    "t_d_Pa",
    "p_d_Pa",
    "t_r_Pa",
    "p_r_Pa",
    "U_s_J_per_m3",
    "U_r_J_per_m3",
)
# Columns of energy.csv without their unit, J per m of thickness.
ENERGY_TERMS = (
    "strain",
    "kinetic",
    "top_work",
    "trigger_work",
    "prestress_work",
    "friction_work",
    "contact_work",
    "damping_work",
    "boundary_work",
    "coupling_work",
)
VTK_QUAD = 9


class DataError(Exception):
    """A file is missing or not as expected; the message is one line that names it."""


def ratio(numerator: np.ndarray, denominator: np.ndarray) -> np.ndarray:
    """Quotient, NaN where the denominator is zero."""
    out = np.full(np.shape(numerator), np.nan)
    np.divide(numerator, denominator, out=out, where=np.asarray(denominator) != 0)
    return out


@dataclass(frozen=True)
class Front:
    """A front's passage over the nodes of the interface, in the order of travel. [points]"""

    id: int
    direction: int  # +1 or -1 along x; the imposed shear is to +1
    x_m: np.ndarray
    onset_s: np.ndarray
    v_tip_m_per_s: np.ndarray
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


@dataclass(frozen=True)
class Fields:
    """The mesh of fields.vtkhdf and the times of its steps; the fields themselves are read step by step."""

    file: Path
    points_m: np.ndarray  # [nodes, 2]
    cells: np.ndarray  # [cells, 4], counterclockwise
    time_s: np.ndarray  # [steps]

    def speed_m_per_s(self, step: int) -> np.ndarray:
        """Magnitude of the velocity at the nodes. [nodes]"""
        with open_hdf5(self.file) as file:
            group = file["VTKHDF"]
            n = len(self.points_m)
            first = int(dataset(group, "Steps/PointDataOffsets/velocity_m_per_s")[step])
            velocity = dataset(group, "PointData/velocity_m_per_s")[first : first + n]
        if len(velocity) != n:
            raise DataError(f"{self.file}: step {step} of velocity_m_per_s has {len(velocity)} rows, not {n}")
        return np.linalg.norm(velocity, axis=1)


@dataclass(frozen=True)
class History:
    """Slip rate and pressure along the interface over time, from interface.h5."""

    time_s: np.ndarray  # [times]
    x_m: np.ndarray  # [nodes]
    slip_rate_m_per_s: np.ndarray  # [times, nodes]
    p_Pa: np.ndarray  # [times, nodes]; zero where the contact is open


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
class Run:
    """One run's folder. `case` and `info` are case.resolved.toml and run.json as dictionaries."""

    name: str
    folder: Path
    case: dict
    info: dict
    static_x_m: np.ndarray  # [nodes]
    static_ratio: np.ndarray  # [nodes], t_s / p_s
    fronts: list[Front]
    history: History
    fields: Fields
    balance: Balance

    def parameter(self, key: str) -> float:
        """Number of a dotted key of the case file."""
        return number(self.folder / "case.resolved.toml", self.case, key)

    def fact(self, key: str) -> float:
        """Number of a dotted key of run.json."""
        return number(self.folder / "run.json", self.info, key)

    @property
    def c_L_m_per_s(self) -> float:
        return self.fact("wave_speeds.c_L_m_per_s")

    @property
    def kind(self) -> str:
        """What starts the event: left, right, spontaneous, ..."""
        return str(self.case.get("event", {}).get("kind"))

    @property
    def prescribed(self) -> bool:
        """Whether the tractions before the event were given, not found by tilting and shearing the plate."""
        return self.case.get("loading", {}).get("method") == "prestress"

    def end_of(self, front: Front) -> str | None:
        """How a front ends, from run.json; None where it is not told."""
        ends = (f.get("end") for f in self.info.get("fronts", []) if f.get("id") == front.id)
        return next(ends, None)


def number(file: Path, table: dict, key: str) -> float:
    value = table
    for part in key.split("."):
        if not isinstance(value, dict) or part not in value:
            raise DataError(f"{file}: no entry '{key}'")
        value = value[part]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise DataError(f"{file}: '{key}' is not a number")
    return float(value)


def open_text(file: Path):
    try:
        return open(file, encoding="utf-8", newline="")
    except OSError as error:
        raise DataError(f"{file}: {error.strerror}") from None


def read_toml(file: Path) -> dict:
    with open_text(file) as stream:
        try:
            return tomllib.loads(stream.read())
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise DataError(f"{file}: not TOML: {error}") from None


def read_json(file: Path):
    with open_text(file) as stream:
        try:
            return json.load(stream)
        except ValueError as error:
            raise DataError(f"{file}: not JSON: {error}") from None


def read_csv(file: Path, columns: tuple[str, ...]) -> dict[str, np.ndarray]:
    """The named columns as numbers, an empty cell as NaN; other columns are passed over."""
    with open_text(file) as stream:
        reader = csv.reader(stream)
        header = [name.strip() for name in next(reader, [])]
        for name in columns:
            if name not in header:
                raise DataError(f"{file}: no column '{name}'")
        rows = []
        for cells in reader:
            if not any(cell.strip() for cell in cells):
                continue
            if len(cells) != len(header):
                raise DataError(f"{file}:{reader.line_num}: {len(cells)} cells, the header has {len(header)}")
            row = []
            for name in columns:
                text = cells[header.index(name)].strip()
                try:
                    row.append(float(text) if text else np.nan)
                except ValueError:
                    raise DataError(
                        f"{file}:{reader.line_num}: '{text}' in column '{name}' is not a number"
                    ) from None
            rows.append(row)
    table = np.array(rows, dtype=float).reshape(-1, len(columns))
    return {name: table[:, i] for i, name in enumerate(columns)}


def open_hdf5(file: Path) -> h5py.File:
    if not file.exists():
        raise DataError(f"{file}: No such file or directory")
    try:
        return h5py.File(file, "r")
    except OSError:
        raise DataError(f"{file}: not an HDF5 file") from None


def dataset(group: h5py.Group, name: str) -> h5py.Dataset:
    found = group.get(name)
    if not isinstance(found, h5py.Dataset):
        raise DataError(f"{group.file.filename}: no data set '{name}' in '{group.name}'")
    return found


def read_fronts(file: Path) -> list[Front]:
    columns = read_csv(file, FRONT_COLUMNS)
    for name in ("front_id", "x_m", "onset_s", "direction"):
        if np.isnan(columns[name]).any():
            raise DataError(f"{file}: empty cell in column '{name}'")
    if (np.abs(columns["direction"]) != 1).any():
        raise DataError(f"{file}: a value other than 1 and -1 in column 'direction'")
    fronts = []
    ids = columns["front_id"]
    for front_id in dict.fromkeys(ids):  # in the order of the file
        c = {name: values[ids == front_id] for name, values in columns.items()}
        fronts.append(
            Front(
                id=int(front_id),
                direction=int(c["direction"][0]),
                x_m=c["x_m"],
                onset_s=c["onset_s"],
                v_tip_m_per_s=c["v_tip_m_per_s"],
                static_ratio=ratio(c["t_s_Pa"], c["p_s_Pa"]),
                dynamic_ratio=ratio(c["t_d_Pa"], c["p_d_Pa"]),
                energy_rise=ratio(c["U_r_J_per_m3"] - c["U_s_J_per_m3"], c["U_s_J_per_m3"]),
            )
        )
    return fronts


def read_history(file: Path) -> History:
    with open_hdf5(file) as hdf5:
        time_s, x_m = (dataset(hdf5, name)[()] for name in ("time_s", "x_m"))
        rate, p = (dataset(hdf5, name)[()] for name in ("slip_rate_m_per_s", "p_Pa"))
    for name, data in (("slip_rate_m_per_s", rate), ("p_Pa", p)):
        if data.shape != (len(time_s), len(x_m)):
            raise DataError(f"{file}: {name} is {data.shape}, not {(len(time_s), len(x_m))}")
    if len(time_s) < 2 or len(x_m) < 2:
        raise DataError(f"{file}: fewer than two times or nodes")
    return History(time_s, x_m, rate, p)


def read_fields(file: Path) -> Fields:
    with open_hdf5(file) as hdf5:
        if "VTKHDF" not in hdf5:
            raise DataError(f"{file}: no group 'VTKHDF'")
        group = hdf5["VTKHDF"]
        n_points = int(dataset(group, "NumberOfPoints")[0])
        n_cells = int(dataset(group, "NumberOfCells")[0])
        points = dataset(group, "Points")[:n_points, :2]
        types = dataset(group, "Types")[:n_cells]
        offsets = dataset(group, "Offsets")[: n_cells + 1]
        connectivity = dataset(group, "Connectivity")[: 4 * n_cells]
        time_s = dataset(group, "Steps/Values")[()]
        dataset(group, "PointData/velocity_m_per_s")
    if (types != VTK_QUAD).any() or (np.diff(offsets) != 4).any() or len(connectivity) != 4 * n_cells:
        raise DataError(f"{file}: cells other than four-node quadrilaterals")
    return Fields(file, points, connectivity.reshape(-1, 4), time_s)


def read_balance(file: Path) -> Balance:
    columns = read_csv(file, ("time_s", *(f"{term}_J_per_m" for term in ENERGY_TERMS), "imbalance_J_per_m"))
    if len(columns["time_s"]) < 2:
        raise DataError(f"{file}: fewer than two rows")
    for name, values in columns.items():
        if np.isnan(values).any():
            raise DataError(f"{file}: empty cell in column '{name}'")
    terms = {term: columns[f"{term}_J_per_m"] for term in ENERGY_TERMS}
    return Balance(
        columns["time_s"], {term: v - v[0] for term, v in terms.items()}, columns["imbalance_J_per_m"]
    )


def read_run(folder: Path) -> Run:
    if not folder.is_dir():
        raise DataError(f"{folder}: no such folder; DIR is the output folder of `slipfront reproduce`")
    static = read_csv(folder / "static.csv", STATIC_COLUMNS)
    return Run(
        name=folder.name,
        folder=folder,
        case=read_toml(folder / "case.resolved.toml"),
        info=read_json(folder / "run.json"),
        static_x_m=static["x_m"],
        static_ratio=ratio(static["t_s_Pa"], static["p_s_Pa"]),
        fronts=read_fronts(folder / "fronts.csv"),
        history=read_history(folder / "interface.h5"),
        fields=read_fields(folder / "fields.vtkhdf"),
        balance=read_balance(folder / "energy.csv"),
    )


def read_experiment(file: Path, c_L_m_per_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Measured points (t_s / p_s, V_tip / c_L) from the columns static_ratio and v_over_c_L or v_m_per_s."""
    with open_text(file) as stream:
        header = [name.strip() for name in next(csv.reader(stream), [])]
    if "v_over_c_L" in header:
        columns = read_csv(file, ("static_ratio", "v_over_c_L"))
        return columns["static_ratio"], columns["v_over_c_L"]
    if "v_m_per_s" in header:
        columns = read_csv(file, ("static_ratio", "v_m_per_s"))
        return columns["static_ratio"], columns["v_m_per_s"] / c_L_m_per_s
    raise DataError(f"{file}: no column 'v_over_c_L' or 'v_m_per_s'")
