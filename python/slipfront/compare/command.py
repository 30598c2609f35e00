# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront compare DIR RECORDS... [-o FILE]`: a run, a sequence or a sweep beside records."""

from __future__ import annotations

import argparse
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr

from slipfront import command
from slipfront.compare.cycles import SHARE, SKIPPED
from slipfront.compare.kinds import KINDS, Kind, Opened, Record, kind_of
from slipfront.compare.misfit import Estimate, estimate_of
from slipfront.compare.page import MARK as PAGE_MARK
from slipfront.compare.page import Part, page_of
from slipfront.compare.speeds import WITHIN
from slipfront.errors import Error
from slipfront.figures.drawing import ENDINGS, checked, guarded, write_results
from slipfront.figures.style import RC
from slipfront.files import DataError, exists, is_folder, is_number
from slipfront.folder import RUN, SEQUENCE, UNFINISHED
from slipfront.fronts_command import mark
from slipfront.gauges_command import add_preparation
from slipfront.opened_sequence import opened
from slipfront.report.page import require_replaceable, write_page
from slipfront.sweep import folder as sweep
from slipfront.sweep.points import Value, short_names, text_of

PAGES = (".html", ".htm")
ABOUT_ALL = 0.95  # of the most that a run shares with a record
MARK = "# misfits by slipfront compare\n"  # by it a file is known that may be replaced
#: Names in messages and their options.
OPTIONS = (
    "within_s", "ratio_within", "thickness_m", "skip_events", "low_pass_Hz", "zero_s", "window_s", "shift_s",
    "never_slipped", "drop_within_s", "drop_share",
)  # fmt: skip


@dataclass
class Target:
    """Results to compare: a run, a sequence or a point of a sweep; or why there are none."""

    name: str
    values: dict[str, Value] = field(default_factory=dict)  # of a sweep's keys
    runs: list[Opened] = field(default_factory=list)
    why_not: str = ""
    is_single: bool = True  # not several together

    @property
    def notes(self) -> list[str]:
        """That a run did not come to its end."""
        told = {run.status.replace("_", " ") for run in self.runs if run.status != "complete"}
        return [f"{self.name}: {', '.join(sorted(told))}: compared as far as it goes"] if told else []


@dataclass
class Compared:
    """A record and what each target makes of it, or why it makes none."""

    kind: Kind
    record: Record
    targets: list[Target]
    found: list[xr.Dataset | str]

    def misfit(self, k: int) -> Estimate:
        found = self.found[k]
        return Estimate(np.nan, np.nan) if isinstance(found, str) else estimate_of(found)

    @property
    def n_shared(self) -> list[int]:
        """Places, points or times that target and record both have, where that differs."""
        return [0 if isinstance(f, str) else int(f["n"]) if "n" in f else 1 for f in self.found]

    @property
    def eligible(self) -> list[int]:
        """Runs that share most with the record, as what shares less is easier to fit; no pool of them."""
        shared = [n if of.is_single else -1 for n, of in zip(self.n_shared, self.targets, strict=True)]
        known = [k for k in range(len(shared)) if shared[k] >= 0 and np.isfinite(self.misfit(k).value)]
        return [k for k in known if shared[k] >= ABOUT_ALL * max(shared)]

    @property
    def best(self) -> int | None:
        """The least misfit."""
        return min(self.eligible, key=lambda k: self.misfit(k).value, default=None)

    def best_in_words(self, k: int) -> str:
        """Which point is nearest, of how many, and whether a wider sweep may have a nearer one."""
        best, points = self.targets[k], [of for of in self.targets if of.is_single]
        told = ", ".join(f"{key} = {text_of(value)}" for key, value in best.values.items())
        if len(self.eligible) < len(points):
            told += f", of the {len(self.eligible)} points that share most with the record"
        at_end = []
        for key, value in best.values.items():
            every = sorted({of.values[key] for of in points if is_number(of.values[key])})
            if len(every) > 2 and value in (every[0], every[-1]):
                at_end.append(key)
        return f"nearest: {told}" + (
            f"; at the end of {', '.join(at_end)}: widen the sweep" if at_end else ""
        )


def add_record_options(parser: argparse.ArgumentParser) -> None:
    """How records are read and compared."""
    add = parser.add_argument
    add("--never-slipped", metavar="TIME", type=mark, help="as of slipfront fronts")
    add("--within-s", metavar="S", type=float, default=np.inf, help="of traces: largest shift of clocks that "
        "is tried, by default all that leave half of the shorter of record and run")  # fmt: skip
    add("--ratio-within", metavar="R", type=float, default=WITHIN, help="of speeds: nodes count whose stress "
        f"ratio is off by no more, by default {WITHIN}")  # fmt: skip
    add("--thickness-m", metavar="B", type=float, help="of a force in N: thickness of the bodies")
    add("--drop-within-s", metavar="S", type=float, help="of a record of the force: time in which it drops")
    add("--drop-share", metavar="X", type=float, default=SHARE, help="of its range by which it drops, by "
        f"default {SHARE}")  # fmt: skip
    add("--skip-events", metavar="N", type=int, default=SKIPPED, help="of cycles: first events left out on "
        f"both sides, by default {SKIPPED}")  # fmt: skip
    add_preparation(parser)


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = command.Parser(
        prog="slipfront compare",
        description="Puts a run, a sequence of events, or each point of a sweep beside an experiment's "
        "records and prints what is left between them, with its standard error. The columns of a record tell "
        "what it is: onsets, traces of strain gauges or slip (also of slipfront records), speeds over the "
        "ratio of shear to normal stress, a force of stick-slip or a table of its events. docs/compare.md",
    )
    parser.add_argument("dir", metavar="DIR", type=Path, help="results of a run, a sequence or a sweep")
    parser.add_argument("records", metavar="RECORDS", type=Path, nargs="+", help="CSV, .mat, or records.nc")
    add = parser.add_argument
    add("-o", "--output", metavar="FILE", type=Path, help="a page of HTML: misfits, tables, pictures; or the "
        "picture of a single record: .png, .pdf or .svg")  # fmt: skip
    add("--table", metavar="FILE", type=Path, help="CSV table of the misfits, a row per record and run")
    add("--event", metavar="N", type=int, help="of records with several events: this one alone")
    add_record_options(parser)
    return parser.parse_args(arguments)


def require_of_use(options: argparse.Namespace, plain: dict[str, Any], kinds: set[Kind]) -> None:
    """Refuses options that count with no record that is given. plain: values of the command's options where
    they are left out."""
    of_use = {name for kind in kinds for name in kind.options}
    for name in sorted({name for kind in KINDS for name in kind.options} & plain.keys() - of_use):
        if getattr(options, name) != plain[name]:
            of = ", ".join(kind.name.lower() for kind in KINDS if name in kind.options)
            raise DataError(
                f"{command.option(name)} counts with {of} alone, and no record is such; leave it out"
            )


def targets_in(folder: Path) -> list[Target]:
    if not is_folder(folder):
        raise DataError(f"{folder}: no such folder; DIR is an output folder of slipfront")
    if not exists(folder / sweep.DEFINITION):
        if not any(exists(folder / name) for name in (RUN, SEQUENCE, UNFINISHED)):
            raise DataError(
                f"{folder}: holds no results of a run, a sequence or a sweep; DIR is their folder"
            )
        return [Target(folder.absolute().name, runs=[opened(folder)])]
    made = []
    for point in sweep.read_definition(folder).points():
        place = sweep.place_of(folder, point)
        target = Target(point.name, dict(point.values))
        wrong = sweep.what_is_wrong(place, point)
        if wrong is None:
            target.runs = [opened(place)]
        else:
            target.why_not = sweep.failure_of(folder, point) or wrong
        made.append(target)
    return made


def compared(kind: Kind, record: Record, targets: list[Target], options: argparse.Namespace) -> Compared:
    """Of a single run an error is the command's; of a sweep it is told of its point."""
    found: list[xr.Dataset | str] = []
    if kind.pools and len(targets) > 1:
        runs = [run for target in targets for run in target.runs]
        targets = [*targets, Target("all points", runs=runs, is_single=False)]
    for target in targets:
        if not target.runs:
            found.append(target.why_not)
            continue
        try:
            found.append(kind.compare(target.runs, record.content, options))
        except Error as error:
            if len(targets) == 1:
                raise DataError(f"{record.label}: {in_words(str(error))}") from None
            found.append(str(error))
    if all(isinstance(one, str) for one in found):
        raise DataError(f"{record.label}: {in_words(str(found[0]))}")
    return Compared(kind, record, targets, found)


def rows_of(of: Compared) -> list[dict[str, object]]:
    rows = []
    for k, (target, found) in enumerate(zip(of.targets, of.found, strict=True)):
        value, error = of.misfit(k)
        row: dict[str, object] = {"record": of.record.label, "run": target.name}
        row |= {key: text_of(value) for key, value in target.values.items()}
        row |= {"misfit": value, "misfit_error": error, "unit": "", "shared": of.n_shared[k]}
        if isinstance(found, str):
            row["message"] = found
        else:
            row["unit"] = found["misfit_of_all"].attrs["units"]
            row["message"] = "; ".join(found.attrs["notes"])
        rows.append(row)
    return rows


def lines_of(of: Compared) -> list[str]:
    head = f"{of.record.label}: "
    if len(of.targets) == 1:
        (found,) = of.found
        assert not isinstance(found, str)
        notes = [*of.record.notes, *found.attrs["notes"], *of.targets[0].notes]
        return [head + line for line in (*of.kind.lines(found), *map(in_words, notes))]
    short = short_names(list(of.targets[0].values))
    lines = []
    for target, found in zip(of.targets, of.found, strict=True):
        values = (f"{short[key]} = {text_of(value)}" for key, value in target.values.items())
        name = ", ".join(values) or target.name
        told = [found] if isinstance(found, str) else [of.kind.lines(found)[0], *found.attrs["notes"]]
        lines.append(f"{head}{name}: {'; '.join([*told, *(target.notes if target.is_single else [])])}")
    if of.best is not None:
        lines.append(head + of.best_in_words(of.best))
    return lines + [head + in_words(note) for note in of.record.notes]


def part_of(of: Compared, options: argparse.Namespace) -> Part:
    """Of the page: a record beside the target that is nearest to it."""
    known = [k for k, found in enumerate(of.found) if not isinstance(found, str)]
    k = known[0] if of.best is None else of.best
    found, target = of.found[k], of.targets[k]
    assert not isinstance(found, str)
    return Part(
        heading=f"{of.kind.name}: {of.record.label}",
        run=target.name if len(of.targets) > 1 else "",
        lines=of.kind.lines(found),
        notes=[*map(in_words, [*of.record.notes, *found.attrs["notes"]]), *target.notes],
        found=found,
        drawing=of.kind.draw(target.runs, of.record.content, found, options),
    )


def read_all(options: argparse.Namespace) -> tuple[list[tuple[Kind, Record]], list[str]]:
    """Records with their kinds, and warnings of their files."""
    files = [file.resolve() for file in options.records]
    if twice := next((file for file in files if files.count(file) > 1), None):
        raise DataError(f"{twice}: is given twice; leave it out once")
    names, read = [file.name for file in files], []
    with warnings.catch_warnings(record=True) as passed_over:
        warnings.simplefilter("always")
        for file in options.records:
            kind = kind_of(file)
            for record in kind.read(file, options):
                if names.count(file.name) > 1:
                    record = record._replace(label=record.label.replace(file.name, str(file), 1))
                read.append((kind, record))
    return read, [str(told.message) for told in passed_over]


def is_picture(options: argparse.Namespace) -> bool:
    return options.output is not None and options.output.suffix.lower() in ENDINGS


def require_writable(options: argparse.Namespace, n_records: int) -> None:
    """Refuses outputs before anything is compared."""
    output, table_file = options.output, options.table
    if output is not None and table_file is not None and output.resolve() == table_file.resolve():
        raise DataError(f"{output}: is named for the page and the table; give two names")
    if is_picture(options):
        checked(output)
        if n_records > 1:
            raise DataError(f"{output}: a picture is of one record, not of {n_records}; write .html")
    elif output is not None:
        if output.suffix.lower() not in PAGES:
            raise DataError(f"{output}: ends with none of {', '.join((*PAGES, *ENDINGS))}")
        require_replaceable(output, PAGE_MARK, "a page of slipfront compare")
    if table_file is not None:
        command.require_own(table_file, MARK.encode(), "a table of slipfront compare")


def work(options: argparse.Namespace) -> list[str]:
    targets = targets_in(options.dir)
    read, lines = read_all(options)
    plain = vars(parse([str(options.dir), *map(str, options.records)]))
    require_of_use(options, plain, {kind for kind, _ in read})
    require_writable(options, len(read))
    every = [compared(kind, record, targets, options) for kind, record in read]
    for of in every:
        lines += lines_of(of)
    table = pd.DataFrame([row for of in every for row in rows_of(of)])
    if is_picture(options):
        lines += write_results(options.output, options.dir, lambda _: part_of(every[0], options).drawing)
    elif options.output is not None:
        of_sweep = table if len(targets) > 1 else None
        with matplotlib.rc_context(RC):
            page = guarded(
                options.dir, lambda: page_of(options.dir, [part_of(of, options) for of in every], of_sweep)
            )
        lines += write_page(page, options.output)
    if options.table is not None:
        text = table.to_csv(index=False, lineterminator="\n")
        command.write_own(options.table, MARK, text, "a table of slipfront compare")
    return lines


def in_words(text: str) -> str:
    """Options by their names on the command line."""
    return command.in_options(text, OPTIONS)


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    return command.run("slipfront compare", lambda: command.by_options(lambda: work(options), OPTIONS))
