# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront fit CASE RECORDS... --free KEY=FROM:TO[:log] -o DIR`: which values explain records."""

from __future__ import annotations

import argparse
import filecmp
import json
import os
import re
from collections.abc import Sequence
from contextlib import suppress
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from slipfront import command
from slipfront.compare.command import (
    OPTIONS,
    add_record_options,
    in_words,
    read_all,
    require_of_use,
)
from slipfront.compare.kinds import Cycles, Kind, Record
from slipfront.files import DataError, exists, is_folder, read_json_table
from slipfront.fit.fitting import RUNS, Asked, Fitting, runs_of_a_step
from slipfront.fit.mesh import finer_of
from slipfront.fit.outcome import outcome_of, write_results
from slipfront.fit.space import Space, space_of
from slipfront.sweep.command import once_each
from slipfront.sweep.engine import default_workers
from slipfront.sweep.points import MOST_POINTS, value_of
from slipfront.sweep.sweeping import How, array_script

NAME = "slipfront fit"
REQUEST = "request.json"
FIRST_A_KEY, BATCH_A_KEY, MOST_A_KEY = 16, 4, 100  # runs
OF_RESTART = ("most", "workers", "scheduler", "quiet")  # on which no result of a run depends
ANYHOW = (*OF_RESTART, "restart", "output", "slurm")  # that may differ from the fit which a folder holds
DESCRIPTION = """Finds which values of a case's keys explain an experiment's records: runs at points over the
ranges, then at those that the records leave, until what is left is known. Results in DIR: intervals,
correlations, what is not determined, the best case, a page. docs/fit.md"""


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    parser = command.Parser(prog=NAME, description=DESCRIPTION)
    add = parser.add_argument
    several: dict[str, Any] = {"action": "append", "default": []}
    add("case", metavar="CASE", type=Path, nargs="?", help="a case file")
    add("records", metavar="RECORDS", type=Path, nargs="*", help="as of slipfront compare: CSV, records.nc")
    add("-o", "--output", metavar="DIR", type=Path, help="folder of the fit; one that was begun goes on")
    add("--restart", metavar="DIR", type=Path, help="go on with the fit in this folder")
    add("--free", metavar="KEY=FROM:TO[:log]", help="a key and its range; repeat", **several)
    add("--set", metavar="KEY=VALUE", help="set another key of the case; repeat", **several)
    add("--clock", choices=("free", "run"), default="free", help="whether the records' clock is free, or "
        "time 0 is that of the run (default: free)")  # fmt: skip
    add("--gain", choices=("known", "free"), default="known", help="of traces: whether amplitudes count "
        "(default: known)")  # fmt: skip
    add("--fit-events", metavar="N,M-K", type=events, help="of records with several events, or of a table of "
        "events: those that are fitted (default: all)")  # fmt: skip
    add("--predict-events", metavar="N,M-K", type=events, help="those that are predicted, with their misfit")
    add("--first", metavar="N", type=int, help=f"runs over the whole ranges (default: {FIRST_A_KEY} a key)")
    add("--most", metavar="N", type=int, help=f"runs at most (default: {MOST_A_KEY} a key)")
    add("--workers", metavar="N", type=int, help="runs at a time, one thread each (default: processors)")
    add("--scheduler", metavar="ADDRESS", help="a Dask scheduler whose workers see DIR, not local ones")
    add("--slurm", metavar="FILE", type=Path, help="write a script for an array of Slurm jobs, which does "
        "the first runs; run nothing")  # fmt: skip
    add("-q", "--quiet", action="store_true", help="print nothing but errors")
    add_record_options(parser)
    return parser.parse_args(arguments)


def argument_words(name: str) -> str:
    """An argument as it is called on the command line."""
    return name.upper() if name in ("case", "records") else command.option(name)


def events(text: str) -> tuple[int, ...]:
    """Numbers and ranges of them."""
    found: list[int] = []
    for part in text.split(","):
        ends = re.fullmatch(r"\s*(\d{1,7})\s*(?:-\s*(\d{1,7})\s*)?", part, re.ASCII)
        if not ends:
            raise argparse.ArgumentTypeError(f"{text}: is not N,M-K, of numbers of seven digits at most")
        first, last = int(ends[1]), int(ends[2] or ends[1])
        if not 1 <= first <= last:
            raise argparse.ArgumentTypeError(f"{text}: events are numbered from 1, ranges rise")
        found += range(first, last + 1)
    if len(set(found)) < len(found):
        raise argparse.ArgumentTypeError(f"{text}: names an event twice")
    return tuple(found)


def rows_of(record: Record, wanted: tuple[int, ...]) -> Record:
    """Rows of a table of events."""
    n = len(record.content["begin_s"])
    if max(wanted) > n:
        raise DataError(f"{record.label}: has {n} events; there is no event {max(wanted)}")
    at = np.array(sorted(wanted)) - 1
    if (np.diff(at) != 1).any():
        raise DataError(f"{record.label}: events of a table follow each other: name them as N-M")
    content = {name: values[at] for name, values in record.content.items()}
    return record._replace(label=f"{record.label}, events {at[0] + 1}-{at[-1] + 1}", content=content)


def asked_of(options: argparse.Namespace, read: list[tuple[Kind, Record]]) -> Asked:
    """Records by what is to be done with their events."""
    if not options.fit_events and options.predict_events:
        raise DataError("--predict-events needs --fit-events, those that are fitted")
    if both := {*(options.fit_events or ())} & {*(options.predict_events or ())}:
        raise DataError(f"event {min(both)} is to be fitted and to be predicted; name it once")
    if not options.fit_events:
        return Asked(read, [True] * len(read), options)
    chosen: list[tuple[Kind, Record]] = []
    is_fitted: list[bool] = []
    for wanted, fitted in ((options.fit_events, True), (options.predict_events, False)):
        found: list[tuple[Kind, Record]] = []
        for kind, record in read:
            if wanted and isinstance(kind, Cycles):
                found.append((kind, rows_of(record, wanted)))
            elif wanted and record.event in wanted:
                found.append((kind, record))
            elif record.event is None and fitted and not isinstance(kind, Cycles):
                found.append((kind, record))  # a record of one event
        if wanted and not any(record.event in wanted or isinstance(kind, Cycles) for kind, record in found):
            raise DataError(f"no record has an event {wanted[0]}")
        chosen += found
        is_fitted += [fitted] * len(found)
    return Asked(chosen, is_fitted, options)


def require_different(files: Sequence[Path]) -> None:
    """Refuses a record that would count twice."""
    for one, other in combinations(files, 2):
        if filecmp.cmp(one, other, shallow=False):
            raise DataError(f"{other}: holds what {one} holds; leave it out")


def require_sound(options: argparse.Namespace) -> None:
    needed = {"CASE": options.case, "RECORDS": options.records, "--free KEY=FROM:TO": options.free,
              "--output DIR": options.output}  # fmt: skip
    if missing := [name for name, value in needed.items() if not value]:
        raise DataError(f"{', '.join(missing)}: not given; nor is --restart DIR; see {NAME} --help")
    if not exists(options.case):
        raise DataError(f"{options.case}: No such file or directory")
    for name in ("first", "most", "workers"):
        if getattr(options, name) is not None and getattr(options, name) < 1:
            raise DataError(f"--{name} is a whole number from 1 on")


def require_usable(folder: Path, arguments: Sequence[str]) -> None:
    """Refuses a folder of anything but this fit; runs alone may be there."""
    if not is_folder(folder):
        if os.path.lexists(folder):
            raise DataError(f"{folder}: is there and no folder; choose another name")
        return
    if not exists(folder / REQUEST):
        if any(entry.name != RUNS for entry in folder.iterdir()):
            raise DataError(f"{folder}: holds something, and no fit; choose another folder")
        return
    begun, wanted = (vars(of) for of in (request_of(folder), parse(arguments)))
    if other := [name for name in begun if name not in ANYHOW and str(begun[name]) != str(wanted[name])]:
        names = " and ".join(map(argument_words, other))
        raise DataError(f"{folder}: holds a fit with another {names}; choose another folder")


def request_of(folder: Path) -> argparse.Namespace:
    """The fit of a folder as it was asked for."""
    file = folder / REQUEST
    if not exists(file):
        raise DataError(f"{folder}: holds no fit")
    found = read_json_table(file).get("arguments")
    if not isinstance(found, list) or not all(isinstance(one, str) for one in found):
        raise DataError(f"{file}: not the request of a fit, or of another version")
    return parse(found)


def restarted(given: argparse.Namespace) -> argparse.Namespace:
    """The fit of a folder as it was asked for, but for how it is carried out."""
    folder, plain = given.restart, vars(parse([]))
    changed = [name for name, value in vars(given).items() if name != "restart" and value != plain[name]]
    for name in changed:
        if name not in OF_RESTART:
            raise DataError(f"--restart DIR goes on with the fit in DIR: leave out {argument_words(name)}")
    options = request_of(folder)
    options.output, options.slurm = folder, None
    for name in changed:
        setattr(options, name, getattr(given, name))
    return options


def whole(options: argparse.Namespace, arguments: Sequence[str]) -> list[str]:
    """The command line, with whole paths."""
    files = {path: str(path.resolve()) for path in (options.case, *options.records)}
    return [files.get(Path(argument), argument) for argument in arguments]


def write_request(folder: Path, arguments: Sequence[str]) -> None:
    with command.publishing_into(folder) as made:
        text = json.dumps({"arguments": arguments}, indent=2) + "\n"
        (made / REQUEST).write_text(text, encoding="utf-8")


def discard_request(folder: Path) -> None:
    """Of a fit that was refused before it ran anything."""
    if not exists(folder / RUNS):
        (folder / REQUEST).unlink(missing_ok=True)
        with suppress(OSError):
            folder.rmdir()  # only an empty one goes


def first_and_most(options: argparse.Namespace, space: Space) -> tuple[int, int]:
    """Runs over the whole ranges, and runs at most."""
    first, most = options.first or FIRST_A_KEY * space.n, options.most or MOST_A_KEY * space.n
    last = runs_of_a_step(space.n)
    if first + last > most:
        raise DataError(f"--most is {most} runs: fewer than --first, {first}, and {last} of the last check")
    if most > MOST_POINTS:
        raise DataError(f"--most is {most} runs; {MOST_POINTS} at most")
    return first, most


def fitting_of(options: argparse.Namespace, space: Space, asked: Asked, how: How, most: int) -> Fitting:
    settings = {key: value_of(text) for key, text in once_each(options.set, "--set").items()}
    if both := settings.keys() & space.keys:
        raise DataError(f"{min(both)} is both free and set")
    return Fitting(options.case, settings, space, asked, options.output, how, most)


def work(options: argparse.Namespace, arguments: Sequence[str], output: command.Output) -> list[str]:
    is_restarted = options.restart is not None
    if is_restarted:
        options = restarted(options)
    require_sound(options)
    folder = options.output
    if not is_restarted:
        arguments = whole(options, arguments)
        require_usable(folder, arguments)
    space = space_of(once_each(options.free, "--free"))
    options.event = None
    read, lines = read_all(options)
    plain = vars(parse([str(options.case), *map(str, options.records)]))
    require_of_use(options, plain, {kind for kind, _ in read})
    require_different(options.records)
    asked = asked_of(options, read)
    lines += [f"{record.label}: {in_words(note)}" for _, record in asked.records for note in record.notes]
    workers = options.workers or default_workers()
    how = How(workers, options.scheduler, None, options.quiet, output.say, has_tables=False)
    first, most = first_and_most(options, space)
    fitting = fitting_of(options, space, asked, how, most)
    if not is_restarted:
        write_request(folder, arguments)
    try:
        if options.slurm is not None:
            points = space.points(space.sobol(first))
            then = ["fit", "--restart", str(folder.resolve())]
            return array_script(fitting.sweep(points), folder / RUNS, options.slurm, then)
        for line in lines:
            how.tell(line)
        result = fitting.carry_out(first, BATCH_A_KEY * space.n, how.tell)
        outcome = outcome_of(options, asked, fitting, result, finer_of(fitting, result))
        write_results(folder, outcome, result)
    except DataError:
        discard_request(folder)
        raise
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted; {NAME} --restart {folder} goes on") from None
    return [] if options.quiet else [*outcome.lines, f"results: {folder}"]


def main(arguments: list[str]) -> int:
    # Several of its small matrices at a time are slower than one.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    options = parse(arguments)
    output = command.Output()
    return command.run(
        NAME, lambda: command.by_options(lambda: work(options, arguments, output), OPTIONS), output
    )
