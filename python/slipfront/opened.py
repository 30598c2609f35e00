# SPDX-License-Identifier: BSD-3-Clause
"""A run's results as xarray's data sets, with units in the attributes, read when they are used."""

from __future__ import annotations

import os
import shutil
import weakref
from collections.abc import Callable
from copy import deepcopy
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from slipfront.files import DataError, Table, dataset, is_number, number, open_hdf5, read_table, read_toml
from slipfront.folder import belongs, result_file
from slipfront.notes import Note, notes_of
from slipfront.read import (
    BLEW_UP,
    HISTORY_FIELDS,
    PROBE_FIELDS,
    STATUSES,
    Balance,
    Fields,
    Front,
    Place,
    entry,
    is_open,
    n_finite,
    open_history,
    ratio,
    read_balance,
    read_fields,
    read_fracture,
    read_fronts,
    read_place,
    read_static,
    require,
    require_ascending,
    require_same_nodes,
)
from slipfront.units import attributes, variables

STRESSES = ("stress_xx_Pa", "stress_yy_Pa", "stress_zz_Pa", "stress_xy_Pa")
CHANGE = ", change since the start"


class Kept:
    """A folder that goes when nothing refers to this any more."""

    def __init__(self, folder: Path) -> None:
        self.remove = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)


def state_of(file: Path) -> tuple[int, int, int] | None:
    """What changes where a file is replaced or written to; None where there is none."""
    try:
        status = os.stat(file)
    except OSError:
        return None
    return status.st_ino, status.st_size, status.st_mtime_ns


class StoredArray(BackendArray):
    """Numbers in an HDF5 file that stay there until they are asked for."""

    def __init__(
        self,
        file: Path,
        shape: tuple[int, ...],
        dtype: np.dtype,
        read: Callable[[h5py.File, Any], np.ndarray],
        kept: Any,
    ) -> None:
        self.file, self.shape, self.dtype, self.read, self.kept = file, shape, dtype, read, kept
        self.state = state_of(file)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self.at)

    def at(self, key: tuple[Any, ...]) -> np.ndarray:
        if state_of(self.file) != self.state:
            raise DataError(f"{self.file}: was changed since the run was opened; open it again")
        with open_hdf5(self.file) as hdf5:
            return self.read(hdf5, key)


def stored(dims: tuple[str, ...], array: StoredArray, found: dict[str, str]) -> xr.Variable:
    return xr.Variable(dims, indexing.LazilyIndexedArray(array), found)


def text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def attributes_of(found: h5py.Dataset, name: str) -> dict[str, str]:
    """Those of a data set of the program by their names of the CF conventions."""
    names_in_file = {"units": "unit", "long_name": "description"}
    stated = {cf: text(found.attrs[own]) for cf, own in names_in_file.items() if own in found.attrs}
    if "long_name" in stated:
        stated["long_name"] = stated["long_name"].partition(", [")[0]  # the dimensions are xarray's
    return attributes(name, **stated)


def table_variables(table: Table, dim: str, finite: bool = True) -> dict[str, xr.Variable]:
    """The columns of a table: numbers, or texts where a column holds any."""
    columns = {}
    for name in table.header:
        try:
            values: Any = table.numbers(name, finite)
        except DataError:
            if not any(cell and cell[0].isalpha() for cell in table.texts(name)):
                raise
            values = np.array(table.texts(name), dtype=np.str_)
        columns[name] = xr.Variable((dim,), values, attributes(name))
    return columns


def read_case(folder: Path) -> dict[str, Any]:
    """Every key of the case of results; tables that it names by their whole paths."""
    case = read_toml(result_file(folder / "case.resolved.toml"))
    for table in case.values():
        if isinstance(table, dict) and table.get("file"):
            table["file"] = str(folder.absolute() / table["file"])
    return case


def stored_history(file: Path, kept: Any, attrs: dict[str, str], finite: bool = True) -> xr.Dataset:
    """A finished interface.h5, whose fields stay there until they are asked for; then they are refused where
    they are to be finite and are not."""
    with open_hdf5(file) as hdf5:
        coordinates = {
            name: xr.Variable((name,), dataset(hdf5, name, 1)[()], attributes_of(hdf5[name], name))
            for name in ("time_s", "x_m")
        }
        for name, values in coordinates.items():
            require_ascending(file, name, values.to_numpy())
        shape = len(coordinates["time_s"]), len(coordinates["x_m"])
        for name in HISTORY_FIELDS:
            found = dataset(hdf5, name, 2).shape
            require(found == shape, file, f"{name} is {found}, not {shape}")

        def field(name: str) -> xr.Variable:
            def read(stored_in: h5py.File, key: Any) -> np.ndarray:
                values = stored_in[name][key]
                if finite and name in HISTORY_FIELDS:
                    require(np.isfinite(values), file, f"a value of {name} is not finite")
                return values

            found = dataset(hdf5, name, 2)
            array = StoredArray(file, found.shape, found.dtype, read, kept)
            return stored(("time_s", "x_m"), array, attributes_of(found, name))

        fields = {
            name: field(name)
            for name, found in hdf5.items()
            if isinstance(found, h5py.Dataset) and found.shape == shape
        }
    return xr.Dataset(fields, coordinates, attrs)


class Opened:
    """What OpenRun and OpenSequence have in common."""

    def __init__(self, place: Place, kept: Kept | None = None) -> None:
        self.place = place
        self._kept = kept

    @property
    def name(self) -> str:
        """That of its folder."""
        return self.place.name

    @property
    def folder(self) -> Path:
        """Where the files are: its folder, or unfinished/ in it."""
        return self.place.folder

    @property
    def info(self) -> dict[str, Any]:
        """run.json: version, mesh, wave speeds, steps, statics, energies, fronts, notes; or sequence.json:
        version, end, wave speeds, number of events, largest friction, last state, imbalance of energy,
        notes."""
        return deepcopy(self.place.info)  # what others read stays as the file has it

    @property
    def notes(self) -> list[Note]:
        """What to know of the results: as of `slipfront.info`, and of what happened in the run."""
        return notes_of(self.info)

    @property
    def status(self) -> str:
        """How it ended: complete, interrupted, blew_up, failed, or running."""
        return self.place.status

    @cached_property
    def _case(self) -> dict[str, Any]:
        return read_case(self.folder)

    @property
    def case(self) -> dict[str, Any]:
        """Every key of the case, as nested dictionaries; `slipfront.run` takes it. Tables that it names
        are copies in the folder, by their whole paths."""
        return deepcopy(self._case)

    def entry(self, table: str, key: str) -> Any:
        """A key of a table of the case; None where it has none."""
        return entry(self._case, table, key)

    @property
    def title(self) -> str:
        """That of the case; may be empty."""
        return str(self._case.get("title", ""))

    @property
    def kind(self) -> str:
        """What starts the event: left, right, spontaneous, ..."""
        return str(self.entry("event", "kind"))

    @property
    def prescribed(self) -> bool:
        """Whether the tractions before the event were given, not found by tilting and shearing the plate."""
        return bool(self.entry("loading", "method") == "prestress")

    def _attributes(self) -> dict[str, str]:
        return {"title": self.title, "status": self.status, "folder": str(self.folder)}


class OpenRun(Opened):
    """The results of a run. Undefined numbers are NaN; a file is read, and compared with its checksum, when
    what it holds is first asked for. Raises DataError where a file is missing, damaged or of another
    run."""

    def __repr__(self) -> str:
        return f"<slipfront run '{self.title or self.name}', {self.status}: {self.folder}>"

    def checked(self) -> OpenRun:
        """The same; all its files but the probes are compared with their checksums now, and read but for
        history and fields."""
        for name in ("case", "tractions", "front_list", "history", "fields", "balance"):
            getattr(self, name)
        return self

    @property
    def mark(self) -> str:
        """For titles: how a run ended that did not come to its end; empty for a complete one."""
        return self.place.mark(self._last_s)

    @property
    def _last_s(self) -> float:
        """Of the history of a run that did not come to its end; any number of a complete one."""
        return 0.0 if STATUSES[self.status] is None else float(drawn_history(self)["time_s"][-1])

    @property
    def remarks(self) -> list[str]:
        """Lines to print beside figures."""
        lines = self.place.remarks(self._last_s)
        if any((front.speed_kind == "").any() for front in self.front_list):
            lines.append(
                f"{self.folder / 'fronts.csv'}: of a program that did not tell nodes released by the "
                "trigger or at once from a front: the fastest speeds may be of such"
            )
        return lines

    def parameter(self, key: str) -> float:
        """Number of a dotted key of the case, inf among them."""
        return number(self.folder / "case.resolved.toml", self._case, key, finite=False)

    def fact(self, key: str) -> float:
        """Number of a dotted key of run.json."""
        return number(self.folder / "run.json", self.place.info, key)

    @property
    def c_L_m_per_s(self) -> float:
        """Longitudinal wave speed of the plate."""
        return self.fact("wave_speeds.c_L_m_per_s")

    @property
    def prestress(self) -> dict[str, float] | None:
        """The state before the event that prescribed tractions leave out of displacements, Pa by the names of
        the records; NaN where they determine none. None without prescribed tractions."""
        if not self.prescribed:
            return None
        stored = self.place.info.get("prestress")  # absent from files of earlier versions
        found = stored if isinstance(stored, dict) else {}
        before: dict[str, Any] = {n: found.get(n) for n in PROBE_FIELDS if n.startswith("stress")}
        if self.entry("material", "plane") == "stress":
            before["stress_zz_Pa"] = 0.0
        return {name: float(value) if is_number(value) else np.nan for name, value in before.items()}

    @property
    def records_prestress(self) -> bool:
        """Whether recorded strain and stress hold it; else they are the change from it, as in older files."""
        return entry(self.place.info, "prestress", "recorded") is True

    @property
    def is_of_sequence(self) -> bool:
        """Whether the run is an event of a sequence: its case alone does not lead to it."""
        return bool((self.entry("sequence", "max_events") or 1) > 1)

    @cached_property
    def tractions(self) -> xr.Dataset:
        """static.csv: t_s_Pa and p_s_Pa before the event over x_m, and what varies of friction."""
        file = self.folder / "static.csv"
        read_static(file)  # for its checks
        return self._from_table(file, "x_m")

    @property
    def x_m(self) -> np.ndarray:
        """Places of the nodes. [nodes]"""
        return self.tractions["x_m"].to_numpy()

    @property
    def static_ratio(self) -> np.ndarray:
        """t_s/p_s; NaN where p_s is 0. [nodes]"""
        return ratio(self.tractions["t_s_Pa"].to_numpy(), self.tractions["p_s_Pa"].to_numpy())

    @cached_property
    def history(self) -> xr.Dataset:
        """interface.h5: slip_m, slip_rate_m_per_s, t_Pa, p_Pa and the states of the friction law over time_s
        and x_m. The slip rate belongs to half a (sub-)step later than the time. Of a run that is not over:
        what there is of it."""
        file, blew_up = result_file(self.folder / "interface.h5"), self.status == BLEW_UP
        if is_open(file):
            found = self._open_history(file)
        else:
            found = stored_history(file, self._kept, self._attributes(), finite=not blew_up)
            require_same_nodes(file, found["x_m"].to_numpy(), self.x_m)
        if blew_up:  # as far as it is finite
            columns = (found[name].to_numpy() for name in ("time_s", *found))
            found = found.isel(time_s=slice(n_finite(*columns)))
        return found

    @property
    def interface(self) -> xr.Dataset:
        """The history, by the name of its file."""
        return self.history

    @cached_property
    def front_list(self) -> list[Front]:
        """fronts.csv, a Front each."""
        file, growing = self.folder / "fronts.csv", self.place.growing
        return [] if growing and not belongs(file) else read_fronts(file, growing)

    def told(self, front: Front, name: str) -> str | None:
        """What run.json says of a front in a word: how it ends, its mode; None where it says nothing."""
        known = (f.get(name) for f in self.place.info.get("fronts", []) if f.get("id") == front.id)
        return next(known, None)

    @cached_property
    def fronts(self) -> xr.Dataset:
        """fronts.csv over `point`, a front's points in the order of travel: front_id, x_m, onset_s,
        v_tip_m_per_s, tractions (_s before the event, _d at l* ahead of the tip, _r at the onset), energy
        densities U. Over `front`: direction, end and mode of each, by its id."""
        file = self.folder / "fronts.csv"
        if not self.front_list and not belongs(file):
            return xr.Dataset(attrs=self._attributes())
        found = self._of_points(file).rename(direction="direction_of_point")
        whole = self.info.get("fronts", [])
        told = [f.get(name) for f in whole for name in ("id", "direction", "end", "mode")]
        plain = all(cell is None or isinstance(cell, int | str) for cell in told)
        require(plain, self.folder / "run.json", "an entry of 'fronts' is neither a number nor a text")
        names = {"front": "id", "direction": "direction", "end": "end", "mode": "mode"}
        of_fronts = {name: [f.get(key) for f in whole] for name, key in names.items()}
        return found.assign(variables(("front",), of_fronts))

    @cached_property
    def fracture(self) -> xr.Dataset:
        """fracture.csv over `point`, the points of `fronts`: front_id, x_m, onset_s, v_tip_m_per_s, breakdown
        work, peak and residual traction, weakening distance and time, stress drop, cohesive zone, stress
        intensity factor, energy release rate by the slip behind the tip (docs/fracture.md). Empty of a run
        by an earlier version."""
        file = self.folder / "fracture.csv"
        if not belongs(file):
            return xr.Dataset(attrs=self._attributes())
        return self._of_points(file)

    @cached_property
    def breakdown(self) -> dict[int, dict[str, np.ndarray]] | None:
        """FRACTURE_COLUMNS at the points of each front, by its id; NaN where the breakdown did not come to an
        end. None of a run whose tables may end anywhere, or by an earlier version."""
        if self.place.growing:
            return None
        return read_fracture(self.folder / "fracture.csv", self.front_list, self.status == BLEW_UP)

    @cached_property
    def energies(self) -> xr.Dataset:
        """energy.csv over time_s: energies, works since the start and what they leave open, J/m of
        thickness."""
        blew_up = self.status == BLEW_UP
        energies = self._from_table(self.folder / "energy.csv", "time_s", finite=not blew_up)
        if blew_up:
            n = n_finite(*(energies[name].to_numpy() for name in energies.variables))
            energies = energies.isel(time_s=slice(n))
        return energies

    @cached_property
    def balance(self) -> Balance:
        """The same by the names of the terms, as changes since the start."""
        return read_balance(self.folder / "energy.csv", self.place.growing, self.status == BLEW_UP)

    @cached_property
    def fields(self) -> Fields | None:
        """Mesh and times of the snapshots, whose speeds are read step by step. None of a run without any."""
        file = self._finished("fields.vtkhdf")
        return None if file is None else read_fields(file)

    @cached_property
    def snapshots(self) -> xr.Dataset | None:
        """fields.vtkhdf over time_s, node and component (x, y): displacement_m, velocity_m_per_s; over time_s
        and cell strain and stress (see absolute_stress), where the case has output.snapshot_stress; x_m and
        y_m of the nodes, and cell_nodes, four of each cell counterclockwise. None of a run without
        snapshots."""
        mesh = self.fields
        if mesh is None:
            return None
        n_nodes = len(mesh.points_m)
        x_m, y_m = mesh.points_m.T
        coordinates = variables(("node",), {"x_m": x_m, "y_m": y_m})
        coordinates |= variables(("time_s",), {"time_s": mesh.time_s})
        coordinates |= variables(("component",), {"component": ["x", "y"]})
        found = variables(("cell", "corner"), {"cell_nodes": mesh.cells})
        with open_hdf5(mesh.file) as hdf5:
            for kind, dim, size in (("Point", "node", n_nodes), ("Cell", "cell", len(mesh.cells))):
                for name in hdf5["VTKHDF/Steps"].get(f"{kind}DataOffsets", ()):
                    shape = len(mesh.time_s), size
                    found[name] = self._stored_snapshots(mesh.file, hdf5, f"{kind}Data", name, dim, shape)
        return xr.Dataset(found, coordinates, self._attributes())

    @cached_property
    def probes(self) -> xr.Dataset | None:
        """probes.h5 over time_s and probe, by its name, with the places x_m and y_m: displacement, velocity,
        strain, stress; see absolute_stress. None of a run without probes."""
        file = self._finished("probes.h5")
        if file is None:
            return None
        with open_hdf5(file) as hdf5:
            require("name" in hdf5, file, "no data set 'name'")
            names = [str(name) for name in hdf5["name"].asstr()[()]]
            x_m, y_m, time_s = (dataset(hdf5, name, 1)[()] for name in ("x_m", "y_m", "time_s"))
            require(len(x_m) == len(y_m) == len(names), file, "names and places differ in number")
            records = {}
            for name in PROBE_FIELDS:
                found, shape = dataset(hdf5, name, 2), (len(time_s), len(names))
                require(found.shape == shape, file, f"{name} is {found.shape}; it must be {shape}")
                records[name] = xr.Variable(("time_s", "probe"), found[()], self._of_motion(found, name))
        coordinates = variables(("probe",), {"probe": names, "x_m": x_m, "y_m": y_m})
        coordinates |= variables(("time_s",), {"time_s": time_s})
        return xr.Dataset(records, coordinates, self._attributes())

    @cached_property
    def moment_rate(self) -> xr.Dataset | None:
        """moment_rate.h5 over time_s: potency rate and moment rate, and the potency rates that far receivers
        of S waves see along the interface. None of a run without output.moment_rate."""
        file = self._finished("moment_rate.h5")
        if file is None:
            return None
        with open_hdf5(file) as hdf5:
            columns = {
                name: xr.Variable(("time_s",), found[()], attributes_of(found, name))
                for name, found in hdf5.items()
                if found.ndim == 1 and found.shape == hdf5["time_s"].shape and name != "row_value"
            }
        return xr.Dataset(columns, attrs=self._attributes())

    def absolute_stress(self, records: xr.Dataset | None) -> xr.Dataset:
        """The whole stress of `probes` or `snapshots`, Pa, positive in tension: as it is recorded, but NaN
        where prescribed tractions determine no state before the event: stress_xx_Pa, stress_zz_Pa in plane
        strain, and all of tractions that vary along x. To files of versions that recorded the change the
        state of run.info["prestress"] is added. Raises DataError where the records have no stress."""
        before = self.prestress
        if records is None:
            raise DataError(f"{self.folder}: the run has no such records")
        names = [name for name in STRESSES if name in records]
        require(bool(names), self.folder, "these records have no stress")
        whole = {}
        for name in names:
            attrs = records[name].attrs
            long_name = str(attrs.get("long_name", "")).removesuffix(CHANGE)
            added = 0.0 if before is None else before[name]
            if self.records_prestress:
                added *= 0.0  # is there; what is not known stays NaN
            whole[name] = (records[name] + added).assign_attrs(
                attrs | {"long_name": f"{long_name}, absolute"}
            )
        return xr.Dataset(whole, attrs=records.attrs)

    def _finished(self, name: str) -> Path | None:
        """A file of rows; None where the run has none, or goes on."""
        file = self.folder / name
        return result_file(file) if belongs(file) and not is_open(result_file(file)) else None

    def _from_table(self, file: Path, dim: str, finite: bool = True) -> xr.Dataset:
        table = read_table(result_file(file), growing=self.place.growing)
        columns = table_variables(table, dim, finite)
        require(dim in columns, file, f"no column '{dim}'")
        return xr.Dataset(columns, attrs=self._attributes())

    def _of_points(self, file: Path) -> xr.Dataset:
        """A table of the points of fronts."""
        points = table_variables(read_table(result_file(file), growing=self.place.growing), "point")
        points["front_id"] = points["front_id"].astype(np.int64)
        return xr.Dataset(points, attrs=self._attributes()).set_coords(["front_id", "x_m", "onset_s"])

    def _of_motion(self, found: h5py.Dataset, name: str) -> dict[str, str]:
        """Attributes of what counts from the state before the event, where that is not the unloaded one."""
        attrs = attributes_of(found, name)
        of_state = () if self.records_prestress else ("strain", "stress")
        changes = ("u_", "displacement", *of_state)
        if name.startswith(changes) and self.prescribed:
            attrs["long_name"] += CHANGE
        return attrs

    def _stored_snapshots(
        self, file: Path, hdf5: h5py.File, kind: str, name: str, dim: str, shape: tuple[int, ...]
    ) -> xr.Variable:
        n_times, n_rows = shape
        starts = dataset(hdf5, f"VTKHDF/Steps/{kind}Offsets/{name}", 1)[()]
        path = f"VTKHDF/{kind}/{name}"
        found = hdf5[path]
        is_vector = found.ndim == 2
        dataset(hdf5, path, found.ndim)
        inside = (starts >= 0) & (starts <= len(found) - n_rows)
        require(len(starts) == n_times and inside.all(), file, f"a snapshot's {name} is not in the file")

        def read(h: h5py.File, key: tuple[Any, ...]) -> np.ndarray:
            at, rest = key[0], key[1:]
            first = starts[at]
            if np.ndim(first) == 0:
                return snapshot(h, int(first), rest)
            return np.stack([snapshot(h, int(s), rest) for s in first])

        def snapshot(h: h5py.File, first: int, rest: tuple[Any, ...]) -> np.ndarray:
            rows = h[path][first : first + n_rows]
            return (rows[:, :2] if is_vector else rows)[rest]

        shape = (*shape, 2) if is_vector else shape
        dims = ("time_s", dim, "component")[: len(shape)]
        array = StoredArray(file, shape, found.dtype, read, self._kept)
        return stored(dims, array, self._of_motion(found, name))

    def _open_history(self, file: Path) -> xr.Dataset:
        time_s, fields = open_history(file, self.x_m)
        for name in HISTORY_FIELDS if self.status != BLEW_UP else ():
            require(np.isfinite(fields[name]), file, f"a value of {name} is not finite")
        coordinates = variables(("time_s",), {"time_s": time_s}) | {"x_m": self.tractions["x_m"].variable}
        return xr.Dataset(variables(("time_s", "x_m"), fields), coordinates, self._attributes())


def open_run(folder: Path, kept: Kept | None = None) -> OpenRun:
    """The run in a folder; that of a sequence is refused."""
    return OpenRun(read_place(folder), kept)


def drawn_history(run: OpenRun) -> xr.Dataset:
    """The history, refused where a picture would have fewer than two times or nodes."""
    history, file = run.history, run.folder / "interface.h5"
    require(min(history.sizes["time_s"], history.sizes["x_m"]) >= 2, file, "fewer than two times or nodes")
    require_ascending(file, "time_s", history["time_s"].to_numpy())
    return history
