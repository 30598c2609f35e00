# SPDX-License-Identifier: BSD-3-Clause
"""Recorded events as values, and `records.nc`, the file that keeps them. docs/records.md

SI units; strain_xy is half the engineering shear strain, stress positive in tension; y counts from the
interface, times from the event's."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from slipfront import command
from slipfront.channels import KINDS
from slipfront.files import HDF5_MARK, DataError, dataset, exists, open_file, open_hdf5
from slipfront.gauges import COMPONENTS, Gauge, from_arms
from slipfront.given import path

FORMAT = 1  # of records.nc
#: Attributes of a variable that are left out where they are not known.
NUMBERS = (
    "x_m", "y_m", "angle_deg", "bandwidth_Hz", "zero_level", "noise", "drift_per_s", "drift_error_per_s",
)  # fmt: skip


@dataclass(frozen=True)
class Channel:
    """What one channel recorded of an event, in the unit of its kind (`unit`); a missing value is NaN."""

    name: str
    kind: str  # one of those in docs/records.md
    gauge: str  # that it is an arm or a component of
    time_s: np.ndarray  # since the event's time
    values: np.ndarray
    x_m: float = np.nan
    y_m: float = np.nan
    angle_deg: float = np.nan  # of an arm, from +x towards +y
    bandwidth_Hz: float = np.nan
    zero_level: float = np.nan  # that was subtracted
    noise: float = np.nan  # standard deviation about the line of the drift, before the event
    drift_per_s: float = np.nan
    drift_error_per_s: float = np.nan  # of white noise
    drift_taken: bool = False  # whether the drift was subtracted, too
    #: First and last times at which the recorder was at the end of its range.
    flat_s: tuple[tuple[float, float], ...] = ()

    @property
    def unit(self) -> str:
        return KINDS[self.kind].unit

    @property
    def sample_rate_Hz(self) -> float:
        return float(1 / np.median(np.diff(self.time_s)))


@dataclass(frozen=True)
class Event:
    """An event of an experiment: what was recorded about a time."""

    number: int  # from 1
    time_s: float  # of its zero, on the recorder's clock
    channels: Mapping[str, Channel]
    source: str = ""  # names of the files
    notes: tuple[str, ...] = ()

    def gauges(self) -> list[Gauge]:
        """Its channels of strain and stress as gauges. Three arms at one place are xx, yy, xy; arms at places
        of their own, and one arm or two, stay arms."""
        parts: dict[str, list[Channel]] = {}
        for channel in self.channels.values():
            if channel.kind.startswith(("strain", "stress")):
                parts.setdefault(channel.gauge, []).append(channel)
        return [gauge_of(name, channels) for name, channels in parts.items()]


def gauge_of(name: str, channels: list[Channel]) -> Gauge:
    is_strain = channels[0].kind.startswith("strain")
    time_s, doubts = channels[0].time_s, []
    if any(not np.array_equal(c.time_s, time_s) for c in channels):
        first, last = max(c.time_s[0] for c in channels), min(c.time_s[-1] for c in channels)
        time_s = time_s[(time_s >= first) & (time_s <= last)]
        doubts = ["its channels have clocks of their own: linear between their times"]
    made = [np.interp(time_s, c.time_s, c.values) for c in channels]
    flat_s = [ends for c in channels for ends in c.flat_s]
    places: dict[str, tuple[float, float]] = {}
    at = [(c.x_m, c.y_m) for c in channels]
    x_m, y_m = at[0] if len(set(at)) == 1 else map(float, np.mean(at, axis=0))
    if channels[0].kind == "strain":
        values = {f"{c.angle_deg:g}": v for c, v in zip(channels, made, strict=True)}
        if len(set(at)) > 1:
            places = dict(zip(values, at, strict=True))
        elif len(channels) == 3:
            values = from_arms({c.angle_deg: v for c, v in zip(channels, made, strict=True)})
    else:
        of = {c.kind.partition("_")[2]: v for c, v in zip(channels, made, strict=True)}
        values = {part: of[part] for part in COMPONENTS if part in of}
    bandwidths = {c.bandwidth_Hz for c in channels if c.bandwidth_Hz == c.bandwidth_Hz}
    if len(bandwidths) > 1:
        doubts.append(f"its channels differ in bandwidth: fits take {min(bandwidths):g} Hz for all")
    bandwidth_Hz = min(bandwidths, default=np.inf)
    gauge = Gauge(name, x_m, y_m, time_s, values, is_strain, 0.0, places, tuple(doubts), bandwidth_Hz)
    return gauge.changed(flat_s)


def attributes_of(channel: Channel) -> dict[str, Any]:
    kind = KINDS[channel.kind]
    made: dict[str, Any] = {"units": kind.unit, "long_name": kind.long_name}
    made |= {"kind": channel.kind, "gauge": channel.gauge}
    made |= {n: float(v) for n in NUMBERS if (v := getattr(channel, n)) == v}
    if channel.drift_taken:
        made["drift_taken"] = "yes"
    if channel.flat_s:
        made["flat_s"] = np.ravel(channel.flat_s)
    return made


class Writer:
    """Writes records.nc channel by channel, in any order of events."""

    def __init__(self, hdf5: h5py.File, attributes: Mapping[str, Any]) -> None:
        self.hdf5 = hdf5
        hdf5.attrs.update({"Conventions": "CF-1.11", "source": "slipfront records", "format": FORMAT})
        hdf5.attrs.update(attributes)
        self.clocks: dict[int, list[tuple[str, np.ndarray]]] = {}

    def group(self, number: int) -> h5py.Group:
        name = f"event_{number:04d}"
        return self.hdf5[name] if name in self.hdf5 else self.hdf5.create_group(name, track_order=True)

    def put(self, number: int, event_s: float, channel: Channel) -> None:
        group = self.group(number)
        clocks = self.clocks.setdefault(number, [])
        scale = next((n for n, time_s in clocks if np.array_equal(time_s, channel.time_s)), None)
        if scale is None:
            scale = "time" if not clocks else f"time_{len(clocks) + 1}"
            clocks.append((scale, channel.time_s))
            made = group.create_dataset(scale, data=channel.time_s)
            made.make_scale(scale)
            made.attrs.update({
                "units": "s", "long_name": "time since the event's", "axis": "T",
                "recorder_time_of_zero_s": event_s,
            })  # fmt: skip
        made = group.create_dataset(channel.name, data=channel.values)
        made.dims[0].attach_scale(group[scale])
        made.attrs.update(attributes_of(channel))

    def end(self, event: Event) -> None:
        """What is known of an event when all of its channels are there."""
        told = {"event_time_s": event.time_s, "source_files": event.source, "notes": "\n".join(event.notes)}
        self.group(event.number).attrs.update(told)


def is_records(file: Path) -> bool:
    """Whether a file is one of HDF5, as records.nc is."""
    with open_file(file) as stream:
        return stream.read(len(HDF5_MARK)) == HDF5_MARK


def require_own(file: Path) -> None:
    """Refuses a path where anything but records of ours is."""
    if exists(command.replaceable(file)):
        try:
            with open_hdf5(file) as hdf5:
                is_own = hdf5.attrs.get("source") == "slipfront records"
        except DataError:
            is_own = False
        if not is_own:
            raise DataError(f"{file}: is there and no records of slipfront: not replaced; give another name")


def text_of(attributes: Any, name: str) -> str:
    value = attributes.get(name, "")
    return value if isinstance(value, str) else ""


def number_of(attributes: Any, name: str) -> float:
    value = attributes.get(name, np.nan)
    return float(value) if np.ndim(value) == 0 and np.asarray(value).dtype.kind in "fiu" else np.nan


def channel_of(file: Path, found: h5py.Dataset) -> Channel:
    name = found.name.rpartition("/")[2]
    of = f"{file}: '{found.name.strip('/')}'"
    kind = text_of(found.attrs, "kind")
    if kind not in KINDS or not len(found.dims) or not len(found.dims[0]):
        raise DataError(f"{of} is no channel: its kind or its time is missing")
    values = dataset(found.parent, name, 1)[()]
    time_s = dataset(found.parent, found.dims[0][0].name.rpartition("/")[2], 1)[()]
    if len(values) != len(time_s) or len(values) < 2 or not (np.diff(time_s) > 0).all():
        raise DataError(f"{of} has not as many values as times that ascend, two or more")
    flat = np.ravel(found.attrs.get("flat_s", ()))
    return Channel(
        name, kind, text_of(found.attrs, "gauge") or name, time_s.astype(float), values.astype(float),
        drift_taken=text_of(found.attrs, "drift_taken") == "yes",
        flat_s=tuple((float(a), float(b)) for a, b in zip(flat[::2], flat[1::2], strict=True)),
        **{n: number_of(found.attrs, n) for n in NUMBERS},
    )  # fmt: skip


def each_event(file: Path) -> Iterator[Event]:
    """The events of records.nc, one after the other."""
    with open_hdf5(file) as hdf5:
        if hdf5.attrs.get("source") != "slipfront records" or hdf5.attrs.get("format") != FORMAT:
            raise DataError(f"{file}: no records of slipfront records, or of another version")
        groups = sorted(name for name in hdf5 if re.fullmatch(r"event_\d{4}", name))
    for name in groups:
        with open_hdf5(file) as hdf5:
            group = hdf5[name]
            made = [channel_of(file, found) for key, found in group.items()
                    if isinstance(found, h5py.Dataset) and not re.fullmatch(r"time(_\d+)?", key)]  # fmt: skip
            notes = text_of(group.attrs, "notes")
            event = Event(
                int(name[-4:]), number_of(group.attrs, "event_time_s"), {c.name: c for c in made},
                text_of(group.attrs, "source_files"), tuple(notes.split("\n")) if notes else (),
            )  # fmt: skip
        yield event


def read_records(file: str | os.PathLike[str]) -> list[Event]:
    """The events of a file of `slipfront records`. Raises Error where it is no such file."""
    return list(each_event(path(file, "file")))
