# SPDX-License-Identifier: BSD-3-Clause
"""A sequence of slip events as xarray's data sets, and each of its events as a run."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TypeVar, overload

import numpy as np
import xarray as xr

from slipfront.files import Table, exists, read_table
from slipfront.folder import LIST, SEQUENCE, read_list, result_file
from slipfront.given import kept_path
from slipfront.opened import Kept, Opened, OpenRun, open_run, stored_history, table_variables
from slipfront.read import is_sequence, read_place, require
from slipfront.units import attributes

# Words for the columns of events.csv and loading.csv that mean something else there, or are theirs alone.
EVENT_NAMES = {
    "event": "number of the event",
    "begin_s": "time since normal loading at which the event begins",
    "shear_m": "displacement of the top edge or the pusher to +x when it begins",
    "begin_x_m": "where slip begins inside; the middle of nodes that begin together",
    "from_x_m": "left end of what slips",
    "to_x_m": "right end of what slips",
    "length_m": "length of the interface that slips",
    "longest_patch_m": "length of the longest stretch of it without a gap",
    "nucleation_length_m": "nucleation length before the event: what slips over less stops by itself",
    "is_global": "1 where all nodes inside slip",
    "potency_m2": "slip at rest, summed over the interface",
    "mean_slip_m": "potency over the length",
    "max_slip_m": "largest slip at rest",
    "normal_force_N_per_m": "normal force where the event begins",
    "shear_force_N_per_m": "shear force where the event begins",
    "friction_before": "shear over normal force where the event begins",
    "friction_after": "shear over normal force at rest",
    "stress_drop_Pa": "tangential traction before less that at rest, mean over what slips",
    "released_J_per_m": "energy stored in bodies and machine before less that at rest",
    "friction_work_J_per_m": "energy that friction takes",
    "breakdown_work_J_per_m": "energy that friction takes above the residual traction",
    "wave_loss_J_per_m": "energy of the waves left at the end of the event",
    "slip_s": "time from the first beginning of slip to its last end",
    "n_fronts": "fronts found",
    "median_speed_m_per_s": "median speed of the longest front",
}
LOADING_NAMES = {
    "event": "number of events that have begun",
    "phase": "where the loading stands",
    "time_s": "time since normal loading",
    "shear_m": "displacement of the top edge or the pusher to +x since normal loading",
    "normal_force_N_per_m": "sum of the pressure over the interface",
    "shear_force_N_per_m": "sum of the tangential traction",
    "shear_over_normal": "shear over normal force",
    "normal_force_x_m": "where along the interface the normal force acts",
    "fastest_slip_rate_m_per_s": "slip rate of the fastest node, of a law with a state",
    "pressure_moment_N": "moment of the pressure about the middle of the interface",
    "shear_height_m": "height at which the shear force acts on the plate",
    "wave_loss_J_per_m": "energy of waves left at the ends of the events so far or radiated by slow slip",
}


def named(variables: dict[str, xr.Variable], names: dict[str, str]) -> dict[str, xr.Variable]:
    """The same with other words."""
    for name, variable in variables.items():
        if name in names:
            variable.attrs = attributes(name, long_name=names[name])
    return variables


def numbers_of_events(table: Table) -> np.ndarray:
    """Column `event`, integers. [rows]"""
    numbers = table.numbers("event")
    whole = np.isfinite(numbers) & (numbers >= 0) & (numbers == np.round(numbers))
    require(whole, table.file, "a value of column 'event' is no number of events")
    return numbers.astype(np.int64)


Part = TypeVar("Part")


class Parts(Sequence[Part]):
    """Parts of a sequence of events, each opened by its number, from 1, when it is asked for."""

    def __init__(self, n: int, open_part: Callable[[int], Part], what: str) -> None:
        self._n, self._open, self._what = n, open_part, what

    def __len__(self) -> int:
        return self._n

    @overload
    def __getitem__(self, index: int) -> Part: ...
    @overload
    def __getitem__(self, index: slice) -> list[Part]: ...
    def __getitem__(self, index: int | slice) -> Part | list[Part]:
        at = range(self._n)[index]
        return self._open(at + 1) if isinstance(at, int) else [self._open(k + 1) for k in at]

    def __repr__(self) -> str:
        return f"<{self._n} {self._what}>"


class OpenSequence(Opened):
    """The results of a sequence of slip events. Undefined numbers are NaN; a file is read, and compared with
    its checksum, when what it holds is first asked for. Raises DataError where a file is missing, damaged or
    of another sequence."""

    def __repr__(self) -> str:
        n = self.place.info.get("events", 0)
        return f"<slipfront sequence '{self.title or self.name}', {n} events, {self.status}: {self.folder}>"

    @cached_property
    def events(self) -> xr.Dataset:
        """events.csv over `event`, from 1: when, where and under which loads each begins, extent, slip,
        forces, energies, fronts. Those that have come to rest."""
        table = self._table("events.csv")
        numbers = numbers_of_events(table)
        ascend = np.array_equal(numbers, np.arange(1, len(numbers) + 1))
        require(ascend, table.file, "its events are not numbered from 1")
        variables = named(table_variables(table, "event"), EVENT_NAMES)
        variables["event"] = xr.Variable(("event",), numbers, variables["event"].attrs)
        return xr.Dataset(variables, attrs=self._attributes())

    @cached_property
    def loading(self) -> xr.Dataset:
        """loading.csv over `row`: forces and energies of the tilted sample, and where each event begins, ends
        to slip and is at rest. `phase`: tilted, event_begins, slip_ends, at_rest, loaded, creeps; `event`:
        the number of those that have begun."""
        table = self._table("loading.csv")
        variables = table_variables(table, "row")
        variables["event"] = xr.Variable(("row",), numbers_of_events(table))
        variables["phase"] = xr.Variable(("row",), np.array(table.texts("phase"), dtype=np.str_))
        return xr.Dataset(named(variables, LOADING_NAMES), attrs=self._attributes())

    @property
    def runs(self) -> Sequence[OpenRun]:
        """The runs of `events`, in order; runs[0] is that of event 1. An event under way is none of them."""

        def open_event(number: int) -> OpenRun:
            event = self.folder / f"events/{number:04}"
            result_file(
                event / LIST, self.folder
            )  # refuses that of another sequence: the list has its checksum
            return open_run(event, self._kept)

        return Parts(self.events.sizes["event"], open_event, f"runs: {self.folder / 'events'}")

    @property
    def slow(self) -> Sequence[xr.Dataset]:
        """Under a law with a state the slow slip before each event, as OpenRun.history, with time and slip
        since normal loading; slow[0] precedes event 1. Where sequence.end_s ends the loading, the one behind
        the last event too. find_fronts_in_history finds slow fronts in it. Empty under other laws."""
        folder, n_events = self.folder, self.events.sizes["event"]
        behind_the_last = self.status == "complete" and exists(folder / f"slow/{n_events + 1:04}")
        listed = any(name.startswith("slow/") for name in read_list(folder) or ())
        n_phases = n_events + behind_the_last if listed or exists(folder / "slow") else 0

        def open_phase(number: int) -> xr.Dataset:
            file = result_file(folder / f"slow/{number:04}/interface.h5", folder)
            history = stored_history(file, self._kept, self._attributes())
            history["time_s"].attrs["long_name"] = "time since normal loading"
            return history

        return Parts(n_phases, open_phase, f"histories of slow slip: {folder / 'slow'}")

    @cached_property
    def slip(self) -> xr.DataArray:
        """Slip of each event when it is over, over `event` and x_m: the last row of its history."""
        rows = [run.history["slip_m"].isel(time_s=-1, drop=True).load() for run in self.runs]
        for run, row in zip(self.runs, rows, strict=True):
            same = np.array_equal(row["x_m"], rows[0]["x_m"])
            require(same, run.folder / "interface.h5", "its nodes are not those of the first event")
        if not rows:
            empty = np.empty((0, 0))
            return xr.DataArray(empty, {"event": [], "x_m": []}, ("event", "x_m"), "slip_m")
        found = xr.concat(rows, self.events["event"])
        found.attrs = attributes("slip_m", long_name="slip of the event")
        return found

    def _table(self, name: str) -> Table:
        return read_table(result_file(self.folder / name))


def open_sequence(folder: Path, kept: Kept | None = None) -> OpenSequence:
    """The sequence in a folder."""
    return OpenSequence(read_place(folder, SEQUENCE), kept)


def opened(folder: Path, kept: Kept | None = None) -> OpenRun | OpenSequence:
    """By what the folder holds."""
    require(not (folder / "sweep.json").exists(), folder, "is a sweep; open it by slipfront.sweep.open_sweep")
    if is_sequence(folder):
        return open_sequence(folder, kept)
    return open_run(folder, kept)


def open(folder: str | os.PathLike[str]) -> OpenRun | OpenSequence:
    """Opens the results of a run or a sequence, whoever has made them; where there are unfinished ones and
    no complete ones, those. Raises DataError where there are none."""
    return opened(kept_path(folder, "folder"))
