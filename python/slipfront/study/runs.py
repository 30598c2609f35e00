# SPDX-License-Identifier: BSD-3-Clause
"""What studies of a case share: arguments, runs, which are a sweep in DIR/runs, and files of results."""

from __future__ import annotations

import argparse
import json
import math
import shutil
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from slipfront import command
from slipfront.files import DataError, exists, is_folder, read_json_table
from slipfront.folder import UNFINISHED, publication
from slipfront.opened import open_run
from slipfront.program import answer, find_program, version_of, with_settings
from slipfront.read import longest_each_way
from slipfront.study.speeds import Run
from slipfront.sweep import folder as places
from slipfront.sweep.command import once_each
from slipfront.sweep.definition import Sweep, flattened
from slipfront.sweep.outcome import Slipped
from slipfront.sweep.points import Point, Value, text_of, value_of
from slipfront.sweep.sweeping import How, carry_out

RUNS = "runs"
#: Of any study; one of another kind may have been in the folder before.
FILES = ("convergence.csv", "convergence.json", "interface_step.csv", "interface_step.json", "chosen.toml")
#: Of all runs: a study reads no histories.
RECORDS: dict[str, Value] = {
    "output.history_interval_s": 1e-5,
    "output.snapshot_times_s": [],
    "output.snapshot_interval_s": "inf",
}


def numbers(kind: type) -> Callable[[str], list[Any]]:
    """The type of an option that takes A,B,C, numbers above 0."""

    def parse(text: str) -> list[Any]:
        try:
            values = [kind(part) for part in text.split(",")]
        except ValueError:
            values = [math.nan]
        if not all(0 < value < math.inf for value in values):
            whole = "whole " if kind is int else ""
            raise argparse.ArgumentTypeError(
                f"'{text}' is no {whole}number greater than 0, or a list of them"
            )
        return values

    return parse


def number_of(kind: type) -> Callable[[str], Any]:
    return lambda text: numbers(kind)(text)[-1]


def make_parser(
    name: str, description: str, tolerance: float, tolerance_help: str, threads: int
) -> command.Parser:
    parser = command.Parser(prog=f"slipfront study {name}", description=description)
    preset = "(default: %(default)s)"

    def add(*names: str, **options: Any) -> None:
        parser.add_argument(*names, **options)

    add("case", metavar="CASE", type=Path, help="case file (TOML)")
    add("-o", "--output", metavar="DIR", type=Path, required=True, help="folder for the results")
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="set a key of the case; repeat")
    add("--overwrite", action="store_true", help="replace a study of something else that DIR holds")
    add(
        "--tolerance",
        metavar="T",
        type=number_of(float),
        default=tolerance,
        help=f"{tolerance_help} {preset}",
    )
    add(
        "--station-spacing", metavar="M", type=number_of(float), default=2e-3, help=f"of stations, m {preset}"
    )
    add("--threads", metavar="N", type=number_of(int), default=threads, help=f"runs side by side {preset}")
    add("-q", "--quiet", action="store_true", help="print nothing but errors")
    return parser


class Study:
    """A study of a case in a folder."""

    def __init__(self, options: argparse.Namespace, say: Callable[[str], None]) -> None:
        self.options = options
        self.folder: Path = options.output
        self.say = say
        self.set = {key: value_of(text) for key, text in once_each(options.set, "--set").items()}
        self.program = find_program()
        self.case = flattened(tomllib.loads(self.resolved({})))  # all its keys
        if (n := self.case.get("sequence.max_events", 1)) != 1:
            told = f"sequence.max_events is {n}; a study is of one event: set it to 1"
            raise DataError(f"{options.case}: {told}")

    def resolved(self, changes: Mapping[str, Value]) -> str:
        """The case with some keys changed, every key with its value."""
        settings = [f"{key}={text_of(value)}" for key, value in (self.set | dict(changes)).items()]
        return answer(
            self.program, "validate", str(self.options.case), *with_settings(settings), "--resolved"
        )

    def require_room(self, sweep: Sweep) -> None:
        """Refuses a folder of something else. A study of another case goes where that is wanted."""
        runs = self.folder / RUNS
        begun = exists(runs / places.DEFINITION)
        found = {entry.name for entry in self.folder.iterdir()} if is_folder(self.folder) else set()
        if found - {RUNS} and not begun:
            raise DataError(f"{self.folder}: is not empty and holds no study; choose another folder")
        try:
            places.require_usable(runs, sweep, places.identity_of(sweep, self.program))
        except DataError as error:
            if not begun:
                raise
            if not self.options.overwrite:
                raise DataError(f"{error}, or --overwrite") from None
            with places.held(runs):
                shutil.rmtree(runs)

    def run(
        self, points: Sequence[Mapping[str, Value]], common: Mapping[str, Value], lines: Mapping[str, str]
    ) -> list[Run]:
        """Runs of all points, which set the same keys; those that are done are kept.

        lines: options of the command line by the keys that they vary."""
        settings = self.set | RECORDS | dict(common)
        sweep = Sweep(
            case=self.options.case,
            vary={key: [point[key] for point in points] for key in points[0]},
            set={key: value for key, value in settings.items() if key not in points[0]},
            combine="zip",
            keep="tables",
            lines={f"vary.{key}": option for key, option in lines.items()},
        )
        self.require_room(sweep)
        how = How(self.options.threads, quiet=self.options.quiet, say=self.say)
        if carry_out(sweep, self.folder / RUNS, how).is_interrupted:
            raise KeyboardInterrupt("interrupted; runs that are done are kept: the same command goes on")
        runs = [self.read(point) for point in sweep.points()]
        if all(run.blow_up for run in runs):
            raise DataError(
                f"{self.options.case}: all runs of the study blow up; the first: {runs[0].blow_up}"
            )
        return runs

    def read(self, point: Point) -> Run:
        place = places.place_of(self.folder / RUNS, point)
        wrong = places.what_is_wrong(place, point)
        if wrong is None:
            run, margin_m = open_run(place), self.case["fronts.trigger_margin_m"]
            left_out_m = [(a - margin_m, b + margin_m) for a, b in Slipped(run).driven_m]
            return Run(run.info, longest_each_way(run.front_list), left_out_m)
        if reason := places.blew_up(place):
            return Run(read_json_table(place / UNFINISHED / "run.json"), {}, [], reason)
        raise DataError(f"{point.words}: {places.failure_of(self.folder / RUNS, point) or wrong}")

    def publish(self, texts: Mapping[str, str]) -> None:
        """Writes the files of its results; those of an earlier study that this has not are removed."""
        with places.held(self.folder / RUNS), publication(self.folder, {}) as made:
            for name, text in texts.items():
                (made / name).write_text(text, encoding="utf-8")
        for name in set(FILES) - texts.keys():
            (self.folder / name).unlink(missing_ok=True)

    def summary(self, runs: Sequence[Run], warnings: Sequence[str], found: Mapping[str, Any]) -> str:
        """JSON of what was found."""
        about = {
            "version": version_of(self.program),
            "title": self.case["title"],
            "tolerance": self.options.tolerance,
            "station_spacing_m": self.options.station_spacing,
            "n_runs": len(runs),
            "n_quiet": n_quiet(runs),
            "warnings": warnings,
        }
        return json.dumps(about | dict(found), indent=2, ensure_ascii=False) + "\n"


def n_quiet(runs: Sequence[Run]) -> int:
    return sum(run.info.get("end") == "quiet" for run in runs)


def number(value: Any) -> Any:
    """As JSON has it: null where undefined."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def printed(value: float, unit: str = "", factor: float = 1) -> str:
    """As a printed table has it."""
    return f"{factor * value:.3g}{unit}" if math.isfinite(value) else "-"


#: Of a study: what it prints first, its table, and its warnings.
Printed = tuple[str, list[str], list[str], list[Run]]


def main(parser: command.Parser, arguments: list[str], work: Callable[[Study], Printed]) -> int:
    """Exit code of a study, whose work writes its results."""
    options = parser.parse_args(arguments)
    output = command.Output()

    def lines() -> list[str]:
        first, table, warnings, runs = work(Study(options, output.say))
        ends = f"{len(runs)} runs, {n_quiet(runs)} of which ended before time.end_s since nothing moved"
        notes = [f"note: {warning}" for warning in warnings]
        return [] if options.quiet else [first, ends, "", *table, *notes, f"results: {options.output}"]

    return command.run(parser.prog, lines, output)
