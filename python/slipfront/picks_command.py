# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront picks RECORDS`: onsets in the traces of records.nc."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from slipfront import command
from slipfront.errors import one_line
from slipfront.files import DataError
from slipfront.gauges_command import interval
from slipfront.picks import KINDS, METHODS, TIMES_NOISE, pick_events
from slipfront.records import Event, each_event

MARK = "# picks by slipfront picks\n"  # by it a file is known that may be replaced
COLUMNS = ("event", "gauge", "x_m", "y_m", "onset_s", "error_s", "by", "doubt")
OPTIONS = ("kind", "times_noise", "quiet_s")  # names in messages and their options


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = command.Parser(
        prog="slipfront picks",
        description="Picks the times at which a front passes the gauges of recorded events, with errors, for "
        "slipfront fronts. RECORDS is a file of slipfront records. docs/picks.md",
    )
    parser.add_argument("records", metavar="RECORDS", type=Path)
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help="CSV table, a row per event and "
                        "gauge, to look through and to edit")  # fmt: skip
    parser.add_argument("--figure", metavar="FILE", type=Path, help="record section: .png or .svg of one "
                        "event, .pdf with a page per event")  # fmt: skip
    parser.add_argument("--event", metavar="N", type=int, help="this one alone")
    parser.add_argument("--by", choices=tuple(METHODS), help="by default peak of shear, area of contact "
                        "area, threshold of slip and other strain, aic of acceleration")  # fmt: skip
    parser.add_argument("--kind", choices=tuple(KINDS), help="what is picked, by default the first of these "
                        "that an event has")  # fmt: skip
    parser.add_argument("--times-noise", metavar="K", type=float, default=TIMES_NOISE, help="that a trace "
                        f"stands out of its noise, and the threshold; default {TIMES_NOISE:g}")  # fmt: skip
    parser.add_argument("--quiet-s", metavar="FROM,TO", type=interval, help="times since the event's at "
                        "which nothing happens; by default the first half of what is before it")  # fmt: skip
    return parser.parse_args(arguments)


def events_of(options: argparse.Namespace) -> Iterator[Event]:
    """Those that are wanted, one after the other."""
    numbers = []
    for event in each_event(options.records):
        numbers.append(event.number)
        if options.event in (None, event.number):
            yield event
    if options.event is not None and options.event not in numbers:
        has = ", ".join(map(str, numbers)) or "none"
        raise DataError(f"{options.records}: has no event {options.event}; it has {has}")


def line_of_event(number: int, picks: xr.Dataset) -> str:
    onset, error = picks["onset_s"].to_numpy(), picks["error_s"].to_numpy()
    told = [
        f"event {number}: {len(onset)} pick{'' if len(onset) == 1 else 's'}, {1e6 * onset.min():.1f} to "
        f"{1e6 * onset.max():.1f} us, errors {1e6 * error.min():.2g} to {1e6 * error.max():.2g} us"
    ]
    doubts = zip(picks["gauge"].to_numpy(), picks["doubt"].to_numpy(), strict=True)
    return "; ".join([*told, *(f"{gauge}: {doubt}" for gauge, doubt in doubts if doubt)])


def work(options: argparse.Namespace) -> list[str]:
    if options.figure is not None:
        from slipfront.figures.drawing import checked

        checked(options.figure)
    picks = pick_events(
        events_of(options),
        by=options.by,
        kind=options.kind,
        times_noise=options.times_noise,
        quiet_s=options.quiet_s,
    )
    notes = picks.attrs["notes"]
    if not picks.sizes["pick"]:
        why = command.in_options(notes[-1], OPTIONS) if notes else "no events"
        raise DataError(f"{options.records}: nothing is picked: {why}")
    lines = [
        line_of_event(int(number), picks.isel(pick=picks["event"].to_numpy() == number))
        for number in np.unique(picks["event"].to_numpy())
    ]
    if options.output is not None:
        table = picks.to_dataframe()[list(COLUMNS)].to_csv(index=False, lineterminator="\n")
        command.write_own(options.output, MARK, table, "a table of slipfront picks")
    lines += notes
    if options.figure is not None:
        from slipfront.figures.picks import write_sections

        write_sections(options.figure, events_of(options), picks, options.quiet_s)
        lines.append(f"figure: {options.figure}")
    return [one_line(command.in_options(line, OPTIONS)) for line in lines]


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    return command.run("slipfront picks", lambda: command.by_options(lambda: work(options), OPTIONS))
