# SPDX-License-Identifier: BSD-3-Clause
"""Events cut from the files of recorders: where they are, and each channel of each. docs/records.md"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from slipfront import command
from slipfront.channels import KINDS, Wiring, read_channels
from slipfront.errors import CaseError, one_line
from slipfront.files import DataError
from slipfront.folder import sha256
from slipfront.gauges import flat_tops
from slipfront.given import flag, in_order, number, path, text, whole
from slipfront.recorders import Recording, Series, open_recording, plain_unit, times_of
from slipfront.records import Channel, Event, Writer, require_own

MOST_EVENTS = 9999
SHARE = 0.1  # of the range of a force, by which it drops
HYSTERESIS = 0.1  # of the range of a trigger, by which it must fall below its level before it rises again
LEAST_OVER_NOISE = 5.0  # a drop of the force over the noise of its means
LEAST_OF_LINE = 3  # samples
OFF_RATE = 1e-3  # of a rate by the table, from that by the file
OFF_GRID = 1e-3  # of a sample, by which ends of a window may be off by rounding


@dataclass(frozen=True)
class Cutting:
    """Which events, and what about each; see `read_recorders`."""

    at_s: tuple[float, ...] | None = None
    trigger: str | None = None
    level: float | None = None
    force_drop: str | None = None
    share: float = SHARE
    within_s: float | None = None
    before_s: float | None = None
    after_s: float | None = None
    zero_s: tuple[float, float] | None = None
    take_drift: bool = False

    def __post_init__(self) -> None:
        ways = [name for name in ("at_s", "trigger", "force_drop") if getattr(self, name) is not None]
        if len(ways) > 1:
            raise CaseError(f"both {ways[0]} and {ways[1]} are given; one of them says where events are")
        if not ways and (self.before_s is not None or self.after_s is not None):
            raise CaseError("before_s and after_s are of events: give at_s, trigger or force_drop, too")
        if ways and (self.before_s is None or self.after_s is None):
            raise CaseError(f"{ways[0]} needs before_s and after_s, the window about each event")
        for name in ("before_s", "after_s", "within_s"):
            if getattr(self, name) is not None:
                number(getattr(self, name), name, least=0, finite=True)
        if ways and not self.before_s and not self.after_s:
            raise CaseError("before_s and after_s are both 0: nothing is left of an event")
        if (self.force_drop is None) != (self.within_s is None):
            raise CaseError("force_drop and within_s, the time in which the force drops, are given together")
        if not 0 < number(self.share, "share") < 1:
            raise CaseError(f"share is {self.share:g}; it must be between 0 and 1")
        if self.level is not None:
            number(self.level, "level", finite=True)
        flag(self.take_drift, "take_drift")
        if self.at_s is not None:
            at = [number(t, "at_s", finite=True) for t in in_order(self.at_s, "at_s", "a list of times in s")]
            if not at or not (np.diff(at) > 0).all():
                raise CaseError("at_s must hold times that ascend, one or more")
            object.__setattr__(self, "at_s", tuple(at))
        if self.zero_s is not None:
            ends = [number(t, "zero_s") for t in in_order(self.zero_s, "zero_s", "a pair of times in s")]
            if len(ends) != 2 or not ends[0] < ends[1]:
                raise CaseError("zero_s must be a pair of times in s, the second after the first")
            object.__setattr__(self, "zero_s", tuple(ends))
        if self.take_drift and self.zero == (np.inf, -np.inf):
            raise CaseError("take_drift needs zero_s, in which the drift is measured")

    @property
    def zero(self) -> tuple[float, float]:
        """Where zero and drift are measured, since the event's time; empty where there is none."""
        if self.zero_s is not None:
            return self.zero_s
        return (-self.before_s, -self.before_s / 2) if self.before_s else (np.inf, -np.inf)


@dataclass
class Part:
    """A channel in a file: its column and its times, on the recorder's clock."""

    wiring: Wiring
    series: Series
    time_s: np.ndarray
    factor: float

    def within(self, first_s: float, last_s: float) -> slice:
        off = OFF_GRID * float(np.median(np.diff(self.time_s[:1000]))) if len(self.time_s) > 1 else 0.0
        first, end = np.searchsorted(self.time_s, [first_s - off, last_s + off])
        return slice(int(first), int(end))

    def read(self, at: slice) -> np.ndarray:
        """In the kind's unit, NaN where the recorder has no finite number."""
        values = self.series.read(at.start, at.stop) * self.factor
        values[np.isinf(values)] = np.nan
        return values


@dataclass
class Window:
    """An event to be cut."""

    event: Event
    parts: list[Part]
    first_s: float  # since the event's time
    last_s: float
    told: dict[str, list[str]] = field(default_factory=dict)  # notes, each with the channels that it is of

    def note(self, what: str, channel: str) -> None:
        self.told.setdefault(what, []).append(channel)

    def finished(self) -> Event:
        notes = [f"{', '.join(names)}: {what}" for what, names in self.told.items()]
        return replace(self.event, notes=(*self.event.notes, *notes))


def rises(time_s: np.ndarray, values: np.ndarray, level: float) -> np.ndarray:
    """Where a trigger rises through a level, linear between samples, after it was below it by HYSTERESIS."""
    known = np.isfinite(values)
    time_s, values = time_s[known], values[known]
    marks = np.where(values >= level, 1, np.where(values < level - HYSTERESIS * np.ptp(values), -1, 0))
    at = np.flatnonzero(marks)
    k = at[1:][(marks[at[1:]] == 1) & (marks[at[:-1]] == -1)]
    share = (level - values[k - 1]) / (values[k] - values[k - 1])
    return np.asarray(time_s[k - 1] + share * (time_s[k] - time_s[k - 1]))


def drops(where: str, time_s: np.ndarray, force: np.ndarray, share: float, within_s: float) -> np.ndarray:
    """Where a force drops by a share of its range within a time: of each such drop the time that best parts
    the force into a higher and a lower mean. Drops that follow within the time are one."""
    known = np.isfinite(force)
    time_s, force = time_s[known], force[known]
    n = int(round(within_s / float(np.median(np.diff(time_s))))) if len(force) > 1 else 0
    if not 2 <= n <= len(force) // 3:
        raise DataError(
            f"{where}: within_s is {within_s:g} s, {n} of its {len(force)} samples; give two or more, and a "
            "third of the record at most"
        )
    width = max(n // 4, 1)  # of means, against noise
    sums = np.cumsum(np.insert(force - force.mean(), 0, 0.0))
    means = (sums[width:] - sums[:-width]) / width
    least = share * float(np.ptp(means))
    noise = 1.4826 * float(np.median(np.abs(np.diff(force)))) / np.sqrt(width)
    if least <= LEAST_OVER_NOISE * noise:
        raise DataError(
            f"{where}: a drop by {share:g} of its range, {least:.3g} N, is within the noise, {noise:.2g} N "
            "in means over a quarter of within_s; give a larger share or within_s"
        )
    over = np.flatnonzero(means[:-n] - means[n:] >= least)
    found = []
    for run in np.split(over, np.flatnonzero(np.diff(over) > n) + 1) if over.size else []:
        first, end = run[0], run[-1] + n + width
        part = force[first:end]
        k = np.arange(1, len(part))
        excess = np.cumsum(part)[:-1] - k * part.mean()
        found.append(time_s[first + k[np.argmax(excess**2 / (k * (len(part) - k)))]])
    return np.array(found)


def level_of(part: Part, values: np.ndarray, given: float | None) -> float:
    if np.isnan(values).all() or np.nanmax(values) == np.nanmin(values):
        raise DataError(f"{part.wiring.where}: the trigger does not change")
    if given is not None:
        return given
    return float((np.nanmax(values) + np.nanmin(values)) / 2)


def times_of_events(parts: list[Part], cutting: Cutting) -> tuple[np.ndarray, list[str]]:
    """On the recorder's clock, and what is said of how they were found."""
    name = cutting.trigger if cutting.trigger is not None else cutting.force_drop
    if name is None:
        return np.array(cutting.at_s or (0.0,)), []
    part = next(part for part in parts if part.wiring.name == name)
    values = part.read(slice(0, part.series.n))
    if cutting.trigger is not None:
        level = level_of(part, values, cutting.level)
        found = rises(part.time_s, values, level)
        midway = ", midway of its range" if cutting.level is None else ""
        told = f"events where '{one_line(name)}' rises through {level:.6g}{midway}"
        none = f"never rises through {level:.6g}: give another level"
    else:
        assert cutting.within_s is not None
        found = drops(part.wiring.where, part.time_s, values, cutting.share, cutting.within_s)
        told = (
            f"events where '{one_line(name)}' drops by {cutting.share:g} of its range or more within "
            f"{cutting.within_s:g} s"
        )
        none = f"never drops by {cutting.share:g} of its range within {cutting.within_s:g} s"
    if not found.size:
        raise DataError(f"{part.wiring.where}: {none}")
    return found, [told]


def parted(wirings: list[Wiring], recordings: list[Recording]) -> list[dict[str, Recording]]:
    """Of each experiment the file of each channel: all are in one, or each file is an experiment."""
    where: dict[str, list[Recording]] = {}
    for wiring in wirings:
        fitting = [r for r in recordings if fnmatch(r.file.name, wiring.file or "*")]
        if not fitting:
            raise DataError(f"{wiring.where}: no file has a name like '{one_line(wiring.file)}'")
        holding = [r for r in fitting if r.has(wiring.column)]
        if not holding:
            if len(fitting) == 1:
                fitting[0].series(wiring.column)  # says what is there
            names = ", ".join(str(r.file) for r in fitting)
            raise DataError(f"{wiring.where}: none of {names} has '{one_line(wiring.column)}'")
        where[wiring.name] = holding
    if all(len(holding) == 1 for holding in where.values()):
        idle = [r.file for r in recordings if all(r is not holding[0] for holding in where.values())]
        if idle:
            raise DataError(f"{idle[0]}: none of the channels is in it: leave it out")
        return [{name: holding[0] for name, holding in where.items()}]
    short = next((w for w in wirings if len(where[w.name]) < len(recordings)), None)
    if short is None:
        return [dict.fromkeys(where, recording) for recording in recordings]
    several = next(w for w in wirings if len(where[w.name]) > 1)
    raise DataError(
        f"{several.where}: is in {' and '.join(str(r.file) for r in where[several.name][:2])}, while "
        f"'{one_line(short.name)}' is in {len(where[short.name])} of {len(recordings)} files: say by the key "
        "file which one, or give files of one recorder, an event each"
    )


class Clocks:
    """Times of channels; those of one column or rate are one array."""

    def __init__(self) -> None:
        self.known: dict[Any, np.ndarray] = {}

    def of(self, wiring: Wiring, recording: Recording, series: Series) -> np.ndarray:
        column, n = series.column, series.n
        if wiring.time:
            key: Any = (recording.file, wiring.time, wiring.time_unit)
        elif wiring.sample_rate_Hz is not None:
            if abs(wiring.sample_rate_Hz * column.step_s - 1) > OFF_RATE:
                raise DataError(
                    f"{wiring.where}: sample_rate_Hz is {wiring.sample_rate_Hz:g}, by the file it is "
                    f"{1 / column.step_s:.9g}: leave it out, or correct it"
                )
            key = (n, wiring.sample_rate_Hz, wiring.first_time_s)
        elif column.time:
            key = (recording.file, column.time, "")
        elif column.step_s > 0:
            key = (n, 1 / column.step_s, column.first_s)
        else:
            raise DataError(
                f"{wiring.where}: its times are not known: give time, a column, or sample_rate_Hz"
            )
        if key not in self.known:
            is_column = isinstance(key[0], Path)
            self.known[key] = times_of(recording, *key[1:]) if is_column else even_times(*key)
        time_s = self.known[key]
        if len(time_s) != n:
            raise DataError(f"{wiring.where}: {n} values, but {len(time_s)} times")
        moved = (key, wiring.clock_offset_s) if wiring.clock_offset_s else key
        if moved not in self.known:
            self.known[moved] = time_s + wiring.clock_offset_s
        return self.known[moved]


def even_times(n: int, rate_Hz: float, first_s: float) -> np.ndarray:
    """A rate that is whole but for rounding, as one over a step is, is whole."""
    whole = round(rate_Hz)
    time_s = np.arange(n, dtype=float)
    time_s /= whole if abs(rate_Hz - whole) <= 1e-9 * rate_Hz else rate_Hz
    time_s += first_s
    return time_s


def line_through(time_s: np.ndarray, values: np.ndarray) -> tuple[float, float, float, float]:
    """Mean, noise, slope and its error; NaN what so few samples do not tell."""
    known = ~np.isnan(values)
    time_s, values = time_s[known], values[known]
    if len(values) < LEAST_OF_LINE:
        return float(values.mean()) if len(values) else np.nan, np.nan, np.nan, np.nan
    about = time_s - time_s.mean()
    squares = float(about @ about)
    mean = float(values.mean())
    slope = float(about @ (values - mean)) / squares
    rest = values - mean - slope * about
    noise = float(np.sqrt(rest @ rest / (len(values) - 2)))
    return mean, noise, slope, noise / float(np.sqrt(squares))


@np.errstate(over="ignore", invalid="ignore")  # of absurd numbers
def cut(part: Part, window: Window, cutting: Cutting) -> Channel | None:
    """A channel of an event; None where it has nothing to show there."""
    wiring, kind = part.wiring, KINDS[part.wiring.kind]
    zero_at = window.event.time_s
    at = part.within(zero_at + window.first_s, zero_at + window.last_s)
    if at.stop - at.start < 2:
        window.note("left out: not recorded in the window", wiring.name)
        return None
    time_s, values = part.time_s[at] - zero_at, part.read(at)
    if np.isnan(values).all():
        window.note("left out: no value in the window", wiring.name)
        return None
    if missing := int(np.isnan(values).sum()):
        window.note(f"{missing} of {len(values)} values missing or infinite", wiring.name)
    if wiring.kind != "trigger" and np.nanmin(values) == np.nanmax(values):
        window.note("does not change: dead, or not connected", wiring.name)
    if window.first_s > -np.inf:
        step = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
        if time_s[0] > window.first_s + 1.5 * step or time_s[-1] < window.last_s - 1.5 * step:
            window.note(f"window shortened to the record, {time_s[0]:.6g} to {time_s[-1]:.6g} s", wiring.name)
    flat_s = tuple(flat_tops(time_s, values)) if wiring.kind != "trigger" else ()
    first, last = cutting.zero
    inside = (time_s >= first) & (time_s <= last)
    mean, noise, slope, error = line_through(time_s[inside], values[inside])
    level = np.nan
    if kind.is_zeroed and first < last:
        if np.isnan(mean):
            window.note("not zeroed: no value in the zero window", wiring.name)
        else:
            level = mean
            values = values - mean
            if cutting.take_drift and slope == slope:
                middle = float(time_s[inside & ~np.isnan(values)].mean())
                values = values - slope * (time_s - middle)
    return Channel(
        wiring.name, wiring.stored_kind, wiring.gauge, time_s, values, wiring.x_m, wiring.y_m,
        wiring.angle_deg, wiring.bandwidth_Hz, level, noise, slope, error,
        drift_taken=bool(cutting.take_drift and level == level and slope == slope), flat_s=flat_s,
    )  # fmt: skip


@dataclass
class Cuts:
    """What is cut: the events without channels yet, and the channels, one at a time."""

    files: list[Path]
    windows: list[Window]
    notes: list[str]
    cutting: Cutting

    def channels(self) -> Iterator[tuple[Window, Channel]]:
        """All events of one channel before the next: so are files read in which one variable is one piece."""
        by_part: dict[int, list[tuple[Window, Part]]] = {}
        for window in self.windows:
            for part in window.parts:
                by_part.setdefault(id(part), []).append((window, part))
        for pairs in by_part.values():
            for window, part in pairs:
                if (channel := cut(part, window, self.cutting)) is not None:
                    yield window, channel


def windows_of(
    parts: list[Part], cutting: Cutting, source: str, before: int, notes: list[str]
) -> list[Window]:
    """Of one experiment, numbered after those before."""
    times, told = times_of_events(parts, cutting)
    notes += [f"{source}: {line}" for line in told]
    first = -np.inf if cutting.before_s is None else -cutting.before_s
    last = np.inf if cutting.after_s is None else cutting.after_s
    if before + len(times) > MOST_EVENTS:
        raise DataError(f"{source}: {len(times)} events, more than {MOST_EVENTS}: noise? give another level")
    made = []
    for k, time_s in enumerate(map(float, times)):
        slices = [part.within(time_s + first, time_s + last) for part in parts]
        if all(at.stop <= at.start for at in slices):
            raise DataError(f"{source}: nothing was recorded about the event at {time_s:.9g} s")
        overlap = [
            f"window overlaps that of event {before + 1 + other}"
            for other in (k - 1, k + 1)
            if 0 <= other < len(times) and abs(times[other] - time_s) < last - first
        ]
        event = Event(before + k + 1, time_s, {}, source, tuple(overlap))
        made.append(Window(event, parts, first, last))
    return made


@contextmanager
def cuts(files: list[Path], table: Path, cutting: Cutting, header_line: int | None = None) -> Iterator[Cuts]:
    """The events of recorders' files, which are open meanwhile."""
    wirings = read_channels(table)
    live = [wiring for wiring in wirings if not wiring.dead]
    dead = [wiring.name for wiring in wirings if wiring.dead]
    notes = [f"dead, left out: {', '.join(map(one_line, dead))}"] if dead else []
    if not live:
        raise DataError(f"{table}: all channels are dead")
    for option in ("trigger", "force_drop"):
        name = getattr(cutting, option)
        if name is not None and name not in [wiring.name for wiring in live]:
            state = "is dead" if name in dead else "is no channel"
            raise DataError(
                f"{table}: '{one_line(name)}', by which events are cut, {state}; there are "
                + ", ".join(one_line(wiring.name) for wiring in live)
            )
    if len({file.resolve() for file in files}) < len(files):
        raise DataError(f"{files[0]}: a file is named twice")
    with ExitStack() as opened:
        recordings = [opened.enter_context(open_recording(file, header_line)) for file in files]
        windows: list[Window] = []
        try:
            for experiment in parted(live, recordings):
                parts = parts_of(live, experiment)
                source = ", ".join(dict.fromkeys(r.file.name for r in experiment.values()))
                windows += windows_of(parts, cutting, source, len(windows), notes)
            first, last = cutting.zero
            if first < last:
                notes.append(f"zero, noise and drift by {first:g} to {last:g} s since the event's time")
            else:
                notes.append("nothing subtracted, noise and drift not measured: no zero_s is given")
            yield Cuts(files, windows, notes, cutting)
        except MemoryError:
            raise DataError(f"{files[0]}: a channel does not fit into memory") from None


def parts_of(live: list[Wiring], experiment: Mapping[str, Recording]) -> list[Part]:
    clocks, parts = Clocks(), []
    for wiring in live:
        recording = experiment[wiring.name]
        series = recording.series(wiring.column)
        time_s = clocks.of(wiring, recording, series)
        parts.append(Part(wiring, series, time_s, wiring.per_recorded(plain_unit(series.column.unit))))
    return parts


def arguments(
    files: Any, channels: Any, header_line: int | None, options: Mapping[str, Any]
) -> tuple[list[Path], Path, Cutting, int | None]:
    listed = [files] if isinstance(files, str | os.PathLike) else in_order(files, "files", "a list of files")
    if not listed:
        raise CaseError("files is empty")
    for name in ("trigger", "force_drop"):
        if options.get(name) is not None:
            text(options[name], name)
    cutting = Cutting(**options)
    if header_line is not None:
        whole(header_line, "header_line", least=0)
    return [path(f, "files") for f in listed], path(channels, "channels"), cutting, header_line


def read_recorders(
    files: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    channels: str | os.PathLike[str],
    *,
    header_line: int | None = None,
    **options: Any,
) -> list[Event]:
    """The events in files of transient recorders (MATLAB, HDF5, NetCDF, NPZ, TDMS, tables of text), by a
    table of their channels, TOML or CSV (docs/records.md).

    header_line: of a table of text, the line with the names of the columns, from 1; 0: there is none.

    Where events are, one of: at_s, times on the recorder's clock; trigger, a channel that rises through
    level, by default midway of its range; force_drop, a channel that drops by share of its range (0.1) within
    within_s. Without any the whole record is the one event. before_s and after_s: the window about each.
    zero_s: a pair of times since the event's; the mean there is subtracted from all but forces, contact area
    and trigger, noise and drift are measured there; by default the first half of before_s. take_drift: the
    drift is subtracted, too.

    Raises Error where a file is no such record."""
    made: dict[int, dict[str, Channel]] = {}
    with cuts(*arguments(files, channels, header_line, options)) as found:
        for window, channel in found.channels():
            made.setdefault(window.event.number, {})[channel.name] = channel
        return [replace(w.finished(), channels=made.get(w.event.number, {})) for w in found.windows]


def write_records(
    output: str | os.PathLike[str],
    files: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    channels: str | os.PathLike[str],
    *,
    header_line: int | None = None,
    **options: Any,
) -> list[str]:
    """Writes what `read_recorders` returns to a file of netCDF, a channel at a time; returns notes.

    Raises Error where a file is no record of a recorder, or another's is at the place of the output."""
    output = path(output, "output")
    given = arguments(files, channels, header_line, options)
    require_own(output)
    if any(output.resolve() == file.resolve() for file in (*given[0], given[1])):
        raise DataError(f"{output}: is read: give another name for the output")
    with cuts(*given) as found, command.publishing_into(output.parent) as folder:
        attributes: dict[str, Any] = {
            "source_files": [file.name for file in found.files],
            "source_sha256": [sha256(file) for file in found.files],
            "channels_file": given[1].name,
            "channels_sha256": sha256(given[1]),
            "notes": "\n".join(found.notes),
        }
        if found.cutting.zero[0] < found.cutting.zero[1]:
            attributes["zero_s"] = np.array(found.cutting.zero)
        with h5py.File(folder / output.name, "w") as hdf5:
            writer = Writer(hdf5, attributes)
            for window, channel in found.channels():
                writer.put(window.event.number, window.event.time_s, channel)
            for window in found.windows:
                writer.end(window.finished())
    return found.notes
