# SPDX-License-Identifier: BSD-3-Clause
"""Kinds of records: by what a file is known, how it is read and compared, and what is printed and drawn."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
import xarray as xr

from slipfront import command
from slipfront.channels import FORCES
from slipfront.compare.cycles import (
    NAMES,
    STEMS,
    both_sides,
    compare_cycles,
    events_of_force,
    name_of,
    observed_cycles,
)
from slipfront.compare.misfit import Estimate, Observed, estimate_of
from slipfront.compare.onsets import compare_onsets, observed_onsets
from slipfront.compare.speeds import RATIOS, SPEEDS, compare_speeds, points_of, read_points, runs_of
from slipfront.compare.traces import SlipSensor, compare_traces, observed_traces, sensor_of, traces_of
from slipfront.errors import CaseError, Error
from slipfront.figures.comparison import draw_cycles, draw_onsets, draw_speeds, draw_traces
from slipfront.figures.drawing import Drawing
from slipfront.files import DataError, one_line, read_table
from slipfront.gauges import Gauge, read_gauges
from slipfront.gauges_command import prepared
from slipfront.onsets import (
    LENGTHS,
    PRESSURES,
    TIMES,
    columns_of,
    in_si,
    name_and_unit,
    numbers_of,
    read_each,
)
from slipfront.opened import OpenRun
from slipfront.opened_sequence import OpenSequence
from slipfront.records import Event, each_event, is_records

SEPARATORS = ";\t,"
ROUNDING = 1e-9  # of a misfit in percent
OF_FORCE = {"time_s": (("time", "t"), TIMES), "force": (("force", "shear_force", "force_shear"), FORCES)}
#: Columns of a table of events.
OF_CYCLES: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    "begin_s": (("begin", "time", "t"), TIMES),
    "slip_m": (("slip", "mean_slip"), LENGTHS),
    "duration_s": (("duration", "slip_duration"), TIMES),
    **{
        name_of(form, stem): ((f"{form}_{stem}",), units)
        for form, units in (("friction", {"": 1.0}), ("stress", PRESSURES), ("force", FORCES))
        for stem in STEMS
    },
}
OTHERS = ("begin_s", "slip_m", "duration_s")  # than the shear
WANTED = (
    "x_m and time_s of onsets; gauge, x_m, y_m, time_s and strain_xx or others of gauges; time_s and "
    "force_N; begin_s and friction_before, stress_before_MPa, force_before_kN or others of events; or "
    "static_ratio and v_m_per_s"
)
Opened = OpenRun | OpenSequence


class Record(NamedTuple):
    """What is compared in one: of a file, of one of its events."""

    label: str
    content: Any
    notes: tuple[str, ...] = ()
    event: int | None = None


class Kind(Protocol):
    """Of records; a data set of a comparison has misfit_of_all and its error, and the notes."""

    name: str
    pools: bool  # whether several runs are compared together
    of_sequence: bool | None  # compared with a sequence of events, not with one event; None: with both
    options: tuple[str, ...]  # those of slipfront compare and fit that count with it

    def holds(self, names: Sequence[str]) -> bool:
        """Whether columns of these names, in small letters and without their units, are of this kind."""

    def read(self, file: Path, options: argparse.Namespace) -> list[Record]: ...
    def compare(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> xr.Dataset: ...
    def observed(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> list[Observed]:
        """The same value by value, of a fit, whose options tell what of clocks and amplifiers is known."""

    def lines(self, found: xr.Dataset) -> list[str]:
        """The misfit in a line, then its parts."""

    def draw(
        self, runs: list[Opened], record: Any, found: xr.Dataset, options: argparse.Namespace
    ) -> Drawing: ...


def header_of(file: Path) -> list[str]:
    header = read_table(file, by_hand=True, separators=SEPARATORS, header_only=True).header
    return [name for name in header if name]


def names_in(file: Path) -> list[str]:
    """Names of columns in small letters, whole and without their units."""
    return [bare for name in header_of(file) for bare in (name.strip().lower(), name_and_unit(name)[0])]


def columns_in(file: Path, quantities: Mapping[str, Any], needed: tuple[str, ...]) -> dict[str, np.ndarray]:
    table = read_table(file, by_hand=True, separators=SEPARATORS)
    names = [name for name in table.header if name]
    chosen = columns_of(file, names, dict(quantities), needed, WANTED)
    return {q: in_si(numbers_of(table, name, True), factor) for q, (name, factor) in chosen.items()}


def one_run(runs: list[Opened]) -> OpenRun:
    (run,) = runs
    if isinstance(run, OpenSequence):
        raise CaseError(
            f"{run.folder}: is a sequence; name one of its events, such as {run.folder / 'events' / '0001'}"
        )
    return run


def one_sequence(runs: list[Opened]) -> OpenSequence:
    (sequence,) = runs
    if not isinstance(sequence, OpenSequence):
        raise CaseError(f"{sequence.folder}: is a run; cycles are compared with a sequence of events")
    return sequence


class Traces:
    name = "Traces"
    pools = False
    of_sequence: bool | None = False
    options: tuple[str, ...] = ("within_s", "shift_s", "zero_s", "low_pass_hz", "window_s", "event",
                                "clock", "gain")  # fmt: skip

    def holds(self, names: Sequence[str]) -> bool:
        return any(name.startswith(("strain", "eps", "gamma_xy", "stress_", "sigma_")) for name in names)

    def read(self, file: Path, options: argparse.Namespace) -> list[Record]:
        if not is_records(file):
            if options.event is not None:
                raise DataError(f"{file}: has no events: leave out --event")
            gauges, told = prepared(read_gauges(file), options)
            return [Record(file.name, gauges, tuple(told))]
        found = [self.of_event(file, event, options) for event in each_event(file)
                 if options.event in (None, event.number)]  # fmt: skip
        if not found:
            raise DataError(f"{file}: has no event {options.event}")
        return found

    def of_event(self, file: Path, event: Event, options: argparse.Namespace) -> Record:
        given: list[Gauge | SlipSensor] = list(event.gauges())
        given += [sensor_of(c) for c in event.channels.values() if c.kind == "slip"]
        if not given:
            raise DataError(f"{file}: event {event.number} has no channel of strain, stress or slip")
        traces, told = prepared(given, options)
        others = {c.kind for c in event.channels.values()} - {"slip"}
        left_out = sorted(k for k in others if not k.startswith(("strain", "stress", "gamma")))
        if left_out:
            told.append(f"channels of {', '.join(left_out)} are not compared")
        return Record(f"{file.name}, event {event.number}", traces, tuple(told), event.number)

    def compare(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> xr.Dataset:
        return compare_traces(record, one_run(runs), within_s=options.within_s)

    def observed(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> list[Observed]:
        return observed_traces(
            record,
            one_run(runs),
            within_s=options.within_s,
            clock_is_known=options.clock == "run",
            gain_is_known=options.gain == "known",
        )

    def lines(self, found: xr.Dataset) -> list[str]:
        told = [
            f"misfit {in_percent(estimate_of(found))}, the run's clock less the record's "
            f"{1e6 * float(found.shift_s) + 0.0:.2f} us"
        ]
        for name in found.trace.values:
            at = found.sel(trace=name)
            parts = [p for p in found.component.values if np.isfinite(at.misfit.sel(component=p))]
            each = ", ".join(f"{p} {100 * float(at.misfit.sel(component=p)):.0f} %" for p in parts)
            own = ", ".join(f"{p} {100 * float(at.own_misfit.sel(component=p)):.0f} %" for p in parts)
            told.append(
                f"{name}: misfit {each}; by its own clock, {1e6 * float(at.own_shift_s):.2f} us, {own}"
            )
        return told

    def draw(
        self, runs: list[Opened], record: Any, found: xr.Dataset, options: argparse.Namespace
    ) -> Drawing:
        return draw_traces(traces_of(record, one_run(runs))[0], found)


class Speeds:
    name = "Speed over stress ratio"
    pools = True
    of_sequence: bool | None = None
    options: tuple[str, ...] = ("ratio_within",)

    def holds(self, names: Sequence[str]) -> bool:
        return not {*RATIOS}.isdisjoint(names) and not {v.lower() for v in SPEEDS}.isdisjoint(names)

    def read(self, file: Path, options: argparse.Namespace) -> list[Record]:
        return [Record(file.name, read_points(file))]

    def compare(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> xr.Dataset:
        return compare_speeds(runs, record, ratio_within=options.ratio_within)

    def observed(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> list[Observed]:
        found = self.compare(runs, record, options)
        ratio = found[found.attrs["ratio"]].to_numpy()
        return [
            Observed(
                "speeds",
                str(found["v_record"].attrs["units"]),
                [f"{found.attrs['ratio']} = {r:.6g}" for r in ratio],
                found["v_record"].to_numpy(),
                np.full(len(ratio), np.nan),
                found["v_runs"].to_numpy(),
                is_series=False,
            )
        ]

    def lines(self, found: xr.Dataset) -> list[str]:
        if not int(found.n):
            return [f"no front of the run at any ratio of the {found.sizes['point']} points"]
        bias = estimate_of(found, "deviation_of_all")
        return [
            f"median deviation of the speeds {in_percent(estimate_of(found))}, with its sign "
            f"{in_percent(bias)}, over the {int(found.n)} of {found.sizes['point']} points within the range "
            f"of {found.attrs['ratio']} of the run's fronts"
        ]

    def draw(
        self, runs: list[Opened], record: Any, found: xr.Dataset, options: argparse.Namespace
    ) -> Drawing:
        of = found.attrs["ratio"], found.attrs["speed"]
        points = np.concatenate([points_of(run, *of) for run in runs_of(runs)], axis=1)
        return draw_speeds(points, found)


class Cycles:
    name = "Stick-slip"
    pools = False
    of_sequence: bool | None = True
    options: tuple[str, ...] = ("thickness_m", "drop_within_s", "drop_share", "skip_events")

    def holds(self, names: Sequence[str]) -> bool:
        shear = (
            called for q, (all_called, _) in OF_CYCLES.items() if q not in OTHERS for called in all_called
        )
        return not {*OF_FORCE["force"][0], *shear, "begin"}.isdisjoint(names) and "x" not in names

    def read(self, file: Path, options: argparse.Namespace) -> list[Record]:
        if not set(names_in(file)) & set(OF_FORCE["force"][0]):
            if options.drop_within_s is not None:
                raise DataError(f"{file}: is a table of events: leave out --drop-within-s")
            return [Record(file.name, columns_in(file, OF_CYCLES, ("begin_s",)))]
        found = columns_in(file, OF_FORCE, ("time_s", "force"))
        if options.drop_within_s is None:
            raise DataError(
                f"{file}: a record of the force: give --drop-within-s, the time in which it drops"
            )
        given = {"drop_within_s": options.drop_within_s, "drop_share": options.drop_share}
        try:
            events = events_of_force(found["time_s"], found["force"], **given)
        except Error as error:
            raise DataError(f"{file}: {command.in_options(str(error), tuple(given))}") from None
        return [Record(file.name, events)]

    def compare(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> xr.Dataset:
        return compare_cycles(one_sequence(runs), record, **self.how(options))

    def observed(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> list[Observed]:
        return [observed_cycles(one_sequence(runs), record, **self.how(options))]

    def how(self, options: argparse.Namespace) -> dict[str, Any]:
        """Events of a record that were chosen by number all count."""
        chosen = 0 if getattr(options, "fit_events", None) else None
        return {
            "thickness_m": options.thickness_m,
            "skip_events": options.skip_events,
            "skip_of_record": chosen,
        }

    def lines(self, found: xr.Dataset) -> list[str]:
        told = [f"misfit {in_percent(estimate_of(found))}"]
        for q in map(str, found["quantity"].values):
            at = found.sel(quantity=q)
            unit = "" if at.unit.item() == "1" else f" {at.unit.item()}"
            sides = {
                side: f"{Estimate(float(at[f'mean_{side}']), float(at[f'mean_error_{side}']))}{unit}"
                for side in ("sequence", "record")
            }
            ratio = estimate_of(at, "ratio")
            told.append(f"{NAMES[q]} {sides['sequence']} beside {sides['record']} recorded, {ratio} times")
        return told

    def draw(
        self, runs: list[Opened], record: Any, found: xr.Dataset, options: argparse.Namespace
    ) -> Drawing:
        sides = both_sides(one_sequence(runs), record, **self.how(options))
        return draw_cycles(sides, found)


class Onsets:
    name = "Onsets"
    pools = False
    of_sequence: bool | None = False
    options: tuple[str, ...] = ("never_slipped", "event", "clock")

    def holds(self, names: Sequence[str]) -> bool:
        return any(name in OF_ONSETS for name in names)

    def read(self, file: Path, options: argparse.Namespace) -> list[Record]:
        each = read_each(file, options.never_slipped, options.event)
        return [
            Record(file.name if event is None else f"{file.name}, event {event}", record,
                   tuple(record.attrs["notes"]), event)
            for event, record in each.items()
        ]  # fmt: skip

    def compare(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> xr.Dataset:
        return compare_onsets(one_run(runs), record)

    def observed(self, runs: list[Opened], record: Any, options: argparse.Namespace) -> list[Observed]:
        return [observed_onsets(one_run(runs), record, clock_is_known=options.clock == "run")]

    def lines(self, found: xr.Dataset) -> list[str]:
        n = f"{int(found.n)} of {found.sizes['place']} places"
        if int(found.n) < 2:
            return [f"fronts of the run pass {n}: no misfit"]
        told = [f"standard deviation of the onsets {in_us(estimate_of(found))} over {n}"]
        if np.isfinite(found.reduced_chi2):
            told.append(f"their variance {float(found.reduced_chi2):.3g} of that of the record's errors")
        told.append(f"the run's clock less the record's {in_us(estimate_of(found, 'shift_s'))}")
        if np.isfinite(found.time_ratio):
            told.append(f"the run takes {estimate_of(found, 'time_ratio')} times as long")
        return [", ".join(told)]

    def draw(
        self, runs: list[Opened], record: Any, found: xr.Dataset, options: argparse.Namespace
    ) -> Drawing:
        return draw_onsets(one_run(runs), found)


OF_ONSETS = ("x", "position", "place", "distance")
#: The first that holds a file's columns is its kind.
KINDS: tuple[Kind, ...] = (Speeds(), Cycles(), Traces(), Onsets())


def in_percent(of: Estimate) -> str:
    value, error = (100 * part for part in of)
    if abs(value) < ROUNDING:
        return "0 %"
    return f"{value:.3g} +- {error:.2g} %" if error == error else f"{value:.3g} %"


def in_us(of: Estimate) -> str:
    return f"{Estimate(1e6 * of.value, 1e6 * of.error)} us"


def kind_of(file: Path) -> Kind:
    if is_records(file):
        return next(kind for kind in KINDS if isinstance(kind, Traces))
    if file.suffix.lower() == ".mat":
        return next(kind for kind in KINDS if isinstance(kind, Onsets))
    kind = next((kind for kind in KINDS if kind.holds(names_in(file))), None)
    if kind is None:
        has = ", ".join(f"'{one_line(name)}'" for name in header_of(file)) or "none"
        raise DataError(f"{file}: has the columns {has}; wanted are {WANTED}")
    return kind
