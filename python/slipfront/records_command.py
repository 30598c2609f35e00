# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront records FILES`: files of a laboratory's recorders to the events of `records.nc`."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from slipfront import command
from slipfront.cutting import SHARE, write_records
from slipfront.errors import one_line
from slipfront.gauges_command import interval
from slipfront.recorders import open_recording
from slipfront.records import Channel, Event, each_event
from slipfront.units import quantity

#: Names in messages and their options.
OPTIONS = (
    "at_s", "trigger", "force_drop", "within_s", "before_s", "after_s", "zero_s", "take_drift", "header_line",
)  # fmt: skip


def times(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not T,T,... in s; give such as 0.02,0.5") from None


def channel_and_number(text: str) -> tuple[str, float | None]:
    """Of CHANNEL[,NUMBER]."""
    name, comma, value = text.rpartition(",")
    try:
        return (name, float(value)) if comma else (text, None)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}': '{value}' is not a number") from None


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = command.Parser(
        prog="slipfront records",
        description="Cuts events out of the files of transient recorders (MATLAB, HDF5, NetCDF, NPZ, TDMS, "
        "tables of text), calibrated, with their noise and drift, into a file of netCDF. docs/records.md",
    )
    parser.add_argument("files", metavar="FILE", type=Path, nargs="+", help="several: parts of one "
                        "experiment, or one file an event")  # fmt: skip
    parser.add_argument("--channels", metavar="TABLE", type=Path, help="what each channel is: .toml or .csv")
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help="the file to write, as records.nc")
    parser.add_argument("--list", action="store_true", help="print what the files hold, and nothing else")
    parser.add_argument("--figure", metavar="FILE", type=Path, help="traces: .png, .pdf or .svg")
    parser.add_argument("--header-line", metavar="N", type=int, help="of a table of text: the line with the "
                        "names of its columns; 0: none has them")  # fmt: skip
    add = parser.add_argument_group("where events are, by default one, the whole record").add_argument
    add("--at-s", metavar="T,T,...", type=times, help="times on the recorder's clock")
    add("--trigger", metavar="CHANNEL[,LEVEL]", type=channel_and_number, help="where it rises; LEVEL by "
        "default midway of its range")  # fmt: skip
    add("--force-drop", metavar="CHANNEL[,SHARE]", type=channel_and_number, help="where a force drops by a "
        f"share of its range, by default {SHARE:g}")  # fmt: skip
    add("--within-s", metavar="S", type=float, help="time in which it drops")
    add = parser.add_argument_group("of each event, since its time").add_argument
    add("--before-s", metavar="S", type=float, help="window before it")
    add("--after-s", metavar="S", type=float, help="window after it")
    add("--zero-s", metavar="FROM,TO", type=interval, help="subtract the mean over these times, measure "
        "noise and drift there; by default the first half of --before-s")  # fmt: skip
    add("--take-drift", action="store_true", help="subtract the drift, too")
    options = parser.parse_args(arguments)
    if not options.list and (options.channels is None or options.output is None):
        parser.error("give --channels TABLE and -o FILE, or --list to see what the files hold")
    return options


def lines_of_list(files: list[Path], header_line: int | None) -> Iterator[str]:
    for file in files:
        with open_recording(file, header_line) as held:
            yield f"{file}:"
            yield from (f"  {column}" for column in held.columns.values())


def line_of_event(event: Event) -> str:
    first = min((c.time_s[0] for c in event.channels.values()), default=np.nan)
    last = max((c.time_s[-1] for c in event.channels.values()), default=np.nan)
    told = (
        f"event {event.number}: at {event.time_s:.9g} s, {len(event.channels)} channels, "
        f"{quantity(first, 's')} to {quantity(last, 's')}, of {event.source}"
    )
    return "; ".join([told.replace("µ", "u"), *event.notes])


class Found:
    """What is told of a channel, over all events."""

    def __init__(self) -> None:
        self.unit, self.rate_Hz = "", np.nan
        self.noise: list[float] = []
        self.drifts: list[tuple[float, float]] = []
        self.saturated: list[int] = []

    def take(self, event: int, channel: Channel) -> None:
        self.unit = "" if channel.unit == "1" else f" {channel.unit}"
        self.rate_Hz = channel.sample_rate_Hz
        if channel.noise == channel.noise:
            self.noise.append(channel.noise)
            self.drifts.append((channel.drift_per_s, channel.drift_error_per_s))
        if channel.flat_s:
            self.saturated.append(event)

    def line(self, name: str) -> str:
        told = [f"{self.rate_Hz:.6g} Hz"]
        if self.noise:
            drift, error = max(self.drifts, key=lambda d: abs(d[0]))
            told += [
                f"noise {np.median(self.noise):.2g}{self.unit}",
                f"drift up to {drift:.2g} +- {error:.1g}{self.unit}/s",
            ]
        if self.saturated:
            told.append(f"saturated in event {', '.join(map(str, self.saturated))}")
        return f"{name}: {', '.join(told)}"


def work(options: argparse.Namespace) -> list[str]:
    if options.list:
        return list(lines_of_list(options.files, options.header_line))
    given: dict[str, Any] = {
        name: getattr(options, name)
        for name in ("at_s", "within_s", "before_s", "after_s", "zero_s", "take_drift", "header_line")
    }
    for name, of in (("trigger", "level"), ("force_drop", "share")):
        if (found := getattr(options, name)) is not None:
            given |= {name: found[0]} | ({of: found[1]} if found[1] is not None else {})
    if options.figure is not None:
        from slipfront.figures.drawing import checked

        checked(options.figure)
    notes = write_records(options.output, options.files, options.channels, **given)
    lines: list[str] = []
    channels: dict[str, Found] = {}
    for event in each_event(options.output):
        lines.append(line_of_event(event))
        for name, channel in event.channels.items():
            channels.setdefault(name, Found()).take(event.number, channel)
    lines += [found.line(name) for name, found in channels.items()]
    lines += notes
    if options.figure is not None:
        from slipfront.figures.drawing import write_results
        from slipfront.figures.records import MOST_EVENTS, MOST_ROWS, draw_records

        lines += write_results(options.figure, options.output, lambda file: draw_records(each_event(file)))
        if len(lines) > 0 and (event.number > MOST_EVENTS or len(channels) > MOST_ROWS):
            lines.append(f"the figure shows up to {MOST_EVENTS} events and {MOST_ROWS} gauges or channels")
    return [one_line(line) for line in lines]


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    return command.run("slipfront records", lambda: command.by_options(lambda: work(options), OPTIONS))
