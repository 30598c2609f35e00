# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront sweep SWEEP.toml -o DIR`, `slipfront sweep CASE.toml --vary KEY=VALUES ... -o DIR`"""

from __future__ import annotations

import argparse
import re
from dataclasses import replace
from pathlib import Path

from slipfront import command
from slipfront.files import DataError
from slipfront.sweep.definition import KEEPS, Sweep, is_sweep_file, read_sweep, setting
from slipfront.sweep.engine import default_workers
from slipfront.sweep.folder import read_definition
from slipfront.sweep.slurm import array_script
from slipfront.sweep.sweeping import Finished, How, carry_out, told
from slipfront.sweep.values import value_of

NAME = "slipfront sweep"
SOME_FAILED = 1
DESCRIPTION = "Runs a case over values of its keys, side by side, and makes one table of what came out."
VALUES = "VALUES: A,B,C or FROM:TO:COUNT or FROM:TO:COUNT:log; with --sample FROM:TO or FROM:TO:log."
CODES = (
    "Exit code 0: all points are done; 1: some failed, the tables list them; 2: refused; 130: interrupted."
)


def make_parser() -> command.Parser:
    parser = command.Parser(prog=NAME, description=f"{DESCRIPTION} {VALUES} {CODES}")
    add = parser.add_argument
    add("file", metavar="FILE", type=Path, nargs="?", help="a sweep (TOML), or a case with --vary")
    add("-o", "--output", metavar="DIR", type=Path, help="folder of the sweep; one that was begun goes on")
    add("--restart", metavar="DIR", type=Path, help="go on with the sweep in this folder")
    add("--vary", metavar="KEY=VALUES", action="append", default=[], help="a key and its values; repeat")
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="set a key of all points; repeat")
    add("--zip", action="store_true", help="first values of all keys together, second ones, ...: no grid")
    add("--sample", metavar="N", type=int, help="N points of a Latin hypercube over the ranges")
    add("--seed", metavar="S", type=int, help="of the sample (default: 0)")
    add("--keep", choices=KEEPS, help="all results of each run, or only the tables (default: all)")
    add("--stop-after-failures", metavar="N", type=int, help="begin no point after so many failures")
    add("--workers", metavar="N", type=int, help="runs at a time, one thread each (default: processors)")
    add(
        "--scheduler", metavar="ADDRESS", help="a Dask scheduler whose workers see DIR, instead of local ones"
    )
    add("--share", metavar="K/N", help="run only every N-th point from the K-th, for a job array; no tables")
    add(
        "--slurm",
        metavar="FILE",
        type=Path,
        help="write a script for an array of Slurm jobs, and run nothing",
    )
    add("-q", "--quiet", action="store_true", help="print nothing but errors")
    return parser


def once_each(settings: list[str], option: str) -> dict[str, str]:
    by_key: dict[str, str] = {}
    for text in settings:
        key, value = setting(text, option)
        if key in by_key:
            raise DataError(f"{option} {key} is there twice")
        by_key[key] = value
    return by_key


def combination(options: argparse.Namespace, sweep: Sweep) -> Sweep:
    """What the command line says of how values come together wins over the file."""
    if options.zip and options.sample is not None:
        raise DataError("--zip and --sample exclude each other")
    if options.zip:
        return replace(sweep, combine="zip")
    if options.sample is not None:
        sweep = replace(sweep, combine="sample", count=options.sample)
    if options.seed is not None:
        if sweep.combine != "sample":
            raise DataError("--seed is of a sample: give --sample N as well")
        sweep = replace(sweep, seed=options.seed)
    return sweep


def sweep_of(options: argparse.Namespace) -> Sweep:
    """Of a file of a sweep or a case, with what the command line adds."""
    sweep = read_sweep(options.file) if is_sweep_file(options.file) else Sweep(options.file, {})
    vary = once_each(options.vary, "--vary")
    common = {key: value_of(text) for key, text in once_each(options.set, "--set").items()}
    said = {*(f"vary.{key}" for key in vary), *(f"set.{key}" for key in common)}
    lines = {entry: line for entry, line in sweep.lines.items() if entry not in said}
    sweep = replace(sweep, vary=sweep.vary | vary, set=sweep.set | common, lines=lines)
    sweep = combination(options, sweep)
    if options.keep:
        sweep = replace(sweep, keep=options.keep)
    if options.stop_after_failures is not None:
        sweep = replace(sweep, stop_after_failures=options.stop_after_failures)
    return sweep


def share_of(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    if not found or not 1 <= int(found[1]) <= int(found[2]):
        raise DataError(f"--share {text}: is not K/N with K from 1 to N")
    return int(found[1]), int(found[2])


def asked_for(options: argparse.Namespace) -> tuple[Sweep, Path]:
    if options.restart is not None:
        if options.file or options.output or options.vary or options.set:
            raise DataError("--restart DIR goes on with what is in DIR: no FILE, --output, --vary or --set")
        return read_definition(options.restart), options.restart
    if options.file is None or options.output is None:
        raise DataError(f"FILE and --output DIR, or --restart DIR; see {NAME} --help")
    return sweep_of(options), options.output


def how_of(options: argparse.Namespace, output: command.Output) -> How:
    if options.workers is not None and options.workers < 1:
        raise DataError("--workers is a whole number from 1 on")
    return How(
        workers=1 if options.share else options.workers or default_workers(),
        scheduler=options.scheduler,
        share=share_of(options.share) if options.share else None,
        quiet=options.quiet,
        say=output.say,
    )


def exit_code(finished: Finished) -> int:
    if finished.is_interrupted:
        return command.INTERRUPTED
    return SOME_FAILED if finished.failures or finished.n_left else command.DONE


def main(arguments: list[str] | None = None) -> int:
    options = make_parser().parse_args(arguments)
    codes = [command.DONE]
    output = command.Output()

    def work() -> list[str]:
        sweep, folder = asked_for(options)
        if options.slurm is not None:
            return array_script(sweep, folder, options.slurm)
        finished = carry_out(sweep, folder, how_of(options, output))
        codes[0] = exit_code(finished)
        if finished.is_interrupted:
            raise_interrupted(finished)
        return [] if options.quiet else told(finished)

    def raise_interrupted(finished: Finished) -> None:
        command.report_error(
            NAME, f"interrupted, {finished.n_left} points are left; {NAME} --restart {folder_of(finished)}"
        )

    return command.run(NAME, work, output) or codes[0]


def folder_of(finished: Finished) -> Path:
    return finished.folder
