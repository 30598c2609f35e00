# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront compare DIR RECORDS... [-o FILE]`: a run, a sequence or a sweep beside records."""

from __future__ import annotations

import argparse
import warnings
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr

from slipfront import command
from slipfront.compare.cycles import SKIPPED
from slipfront.compare.kinds import KINDS, Kind, Opened, Record, kind_of
from slipfront.compare.misfit import Estimate, estimate_of
from slipfront.compare.page import Part, page_of
from slipfront.compare.speeds import WITHIN
from slipfront.errors import Error
from slipfront.figures.drawing import ENDINGS, guarded, write_results
from slipfront.figures.style import RC
from slipfront.files import DataError, is_folder
from slipfront.fronts_command import mark
from slipfront.gauges_command import add_preparation
from slipfront.opened_sequence import opened
from slipfront.report.page import require_replaceable, write_page
from slipfront.sweep import folder as sweep
from slipfront.sweep.points import short_names, text_of
from slipfront.sweep.tables import is_sweep

MARK = "# misfits by slipfront compare\n"  # by it a file is known that may be replaced
#: Names in messages and their options.
OPTIONS = (
    "within_s", "ratio_within", "thickness_m", "skip_events", "low_pass_Hz", "zero_s", "window_s", "shift_s",
    "never_slipped", "drop_within_s",
)  # fmt: skip


@dataclass
class Target:
    """Results to compare: a run, a sequence or a point of a sweep; or why there are none."""

    name: str
    values: dict[str, str] = field(default_factory=dict)  # of a sweep's keys
    runs: list[Opened] = field(default_factory=list)
    why_not: str = ""


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
        """Places or points that target and record both have, where that differs: fewer are easier to fit."""
        return [0 if isinstance(f, str) else int(f["n"]) if "n" in f else 1 for f in self.found]

    @property
    def best(self) -> int | None:
        """The least misfit of the targets that share most with the record."""
        shared = self.n_shared
        known = [k for k in range(len(shared))
                 if shared[k] == max(shared) and np.isfinite(self.misfit(k).value)]  # fmt: skip
        return min(known, key=lambda k: self.misfit(k).value, default=None)


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
    add("--never-slipped", metavar="TIME", type=mark, help="as of slipfront fronts")
    add("--within-s", metavar="S", type=float, default=50e-6, help="of traces: largest shift of clocks that "
        "is tried, by default 50e-6")  # fmt: skip
    add("--ratio-within", metavar="R", type=float, default=WITHIN, help="of speeds: nodes count whose stress "
        f"ratio is off by no more, by default {WITHIN}")  # fmt: skip
    add("--thickness-m", metavar="B", type=float, help="of a force in N: thickness of the bodies")
    add("--drop-within-s", metavar="S", type=float, help="of a record of the force: time in which it drops")
    add("--skip-events", metavar="N", type=int, default=SKIPPED, help="of cycles: first events left out on "
        f"both sides, by default {SKIPPED}")  # fmt: skip
    add_preparation(parser)
    return parser.parse_args(arguments)


def require_of_use(options: argparse.Namespace, kinds: set[Kind]) -> None:
    """Refuses options that count with no record that is given."""
    plain = vars(parse([str(options.dir), *map(str, options.records)]))
    of_use = {name for kind in kinds for name in kind.options}
    for name in {name for kind in KINDS for name in kind.options} - of_use:
        if getattr(options, name) != plain[name]:
            of = ", ".join(kind.name.lower() for kind in KINDS if name in kind.options)
            raise DataError(
                f"{command.option(name)} counts with {of} alone, and no record is such; leave it out"
            )


def targets_in(folder: Path) -> list[Target]:
    if not is_folder(folder):
        raise DataError(f"{folder}: no such folder; DIR is an output folder of slipfront")
    if not is_sweep(folder):
        return [Target(folder.absolute().name, runs=[opened(folder)])]
    made = []
    for point in sweep.read_definition(folder).points():
        place = sweep.place_of(folder, point)
        target = Target(point.name, {key: text_of(value) for key, value in point.values.items()})
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
        targets = [*targets, Target("all points", runs=[run for target in targets for run in target.runs])]
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
        row: dict[str, object] = {"record": of.record.label, "run": target.name, **target.values}
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
        return [head + line for line in (*of.kind.lines(found), *of.record.notes, *found.attrs["notes"])]
    short = short_names(list(of.targets[0].values))
    lines = []
    for target, found in zip(of.targets, of.found, strict=True):
        name = ", ".join(f"{short[key]} = {value}" for key, value in target.values.items()) or target.name
        lines.append(f"{head}{name}: {found if isinstance(found, str) else of.kind.lines(found)[0]}")
    if of.best is not None:
        best = of.targets[of.best]
        words = ", ".join(f"{key} = {value}" for key, value in best.values.items())
        lines.append(f"{head}least misfit: {words or best.name}")
    return lines + [head + note for note in of.record.notes]


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
        notes=[*of.record.notes, *found.attrs["notes"]],
        found=found,
        drawing=of.kind.draw(target.runs, of.record.content, found, options),
    )


def work(options: argparse.Namespace) -> list[str]:
    is_picture = options.output is not None and options.output.suffix.lower() in ENDINGS
    if options.output is not None and not is_picture:
        require_replaceable(options.output)
    if options.table is not None:
        command.require_own(options.table, MARK.encode(), "a table of slipfront compare")
    targets = targets_in(options.dir)
    with warnings.catch_warnings(record=True) as passed_over:
        warnings.simplefilter("always")
        read = [
            (kind, record)
            for file in options.records
            for kind in [kind_of(file)]
            for record in kind.read(file, options)
        ]
    require_of_use(options, {kind for kind, _ in read})
    every = [compared(kind, record, targets, options) for kind, record in read]
    lines = [str(told.message) for told in passed_over]
    for of in every:
        lines += lines_of(of)
    table = pd.DataFrame([row for of in every for row in rows_of(of)])
    if options.table is not None:
        text = table.to_csv(index=False, lineterminator="\n")
        command.write_own(options.table, MARK, text, "a table of slipfront compare")
    if is_picture:
        if len(every) > 1:
            raise DataError(f"{options.output}: a picture is of one record, not of {len(every)}; write .html")
        lines += write_results(options.output, options.dir, lambda _: part_of(every[0], options).drawing)
    elif options.output is not None:
        with matplotlib.rc_context(RC):
            parts = guarded(options.dir, lambda: [part_of(of, options) for of in every])
            page = page_of(options.dir, parts, table if len(targets) > 1 else None)
        lines += write_page(page, options.output)
    return [in_words(line) for line in lines]


def in_words(text: str) -> str:
    """Options by their names on the command line."""
    return command.in_options(text, OPTIONS)


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    return command.run("slipfront compare", lambda: command.by_options(lambda: work(options), OPTIONS))
