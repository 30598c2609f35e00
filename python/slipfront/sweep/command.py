# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront sweep SWEEP.toml -o DIR`, `slipfront sweep CASE.toml --vary KEY=VALUES ... -o DIR`"""

from __future__ import annotations

import argparse
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

from slipfront import command
from slipfront.files import DataError
from slipfront.sweep.definition import KEEPS, Sweep, is_sweep_file, read_sweep
from slipfront.sweep.engine import default_workers
from slipfront.sweep.folder import read_definition
from slipfront.sweep.points import value_of
from slipfront.sweep.sweeping import How, array_script, carry_out

NAME = "slipfront sweep"
SOME_FAILED = 1
DESCRIPTION = """Runs a case over values of its keys, side by side, and makes one table of what came out.
VALUES: A,B,C or FROM:TO:COUNT or FROM:TO:COUNT:log; with --sample FROM:TO or FROM:TO:log. Exit code 0: all
points are done; 1: some failed, the tables list them; 2: refused; 130: interrupted."""


def make_parser() -> command.Parser:
    parser = command.Parser(prog=NAME, description=DESCRIPTION)

    def add(*names: str, **options: Any) -> None:
        parser.add_argument(*names, **options)

    several: dict[str, Any] = {"action": "append", "default": []}
    add("file", metavar="FILE", type=Path, nargs="?", help="a sweep (TOML), or a case with --vary")
    add("-o", "--output", metavar="DIR", type=Path, help="folder of the sweep; one that was begun goes on")
    add("--restart", metavar="DIR", type=Path, help="go on with the sweep in this folder")
    add("--vary", metavar="KEY=VALUES", help="a key and its values; repeat", **several)
    add("--set", metavar="KEY=VALUE", help="set a key of all points; repeat", **several)
    add("--zip", action="store_true", help="first values of all keys together, second ones, ...: no grid")
    add("--sample", metavar="N", type=int, help="N points of a Latin hypercube over the ranges")
    add("--seed", metavar="S", type=int, help="of the sample (default: 0)")
    add("--keep", choices=KEEPS, help="all results of each run, or only the tables (default: all)")
    add("--workers", metavar="N", type=int, help="runs at a time, one thread each (default: processors)")
    add("--scheduler", metavar="ADDRESS", help="a Dask scheduler whose workers see DIR, not local ones")
    add("--share", metavar="K/N", help="only every N-th point from the K-th, for a job array; no tables")
    add("--slurm", metavar="FILE", type=Path, help="write a script for an array of Slurm jobs; run nothing")
    add("-q", "--quiet", action="store_true", help="print nothing but errors")
    return parser


def once_each(settings: list[str], option: str) -> dict[str, str]:
    """KEY=VALUE of the command line by key."""
    by_key: dict[str, str] = {}
    for text in settings:
        key, _, value = (part.strip() for part in text.partition("="))
        if not key or not value:
            raise DataError(f"{option} {text}: is not KEY=VALUE")
        if key in by_key:
            raise DataError(f"{option} {key} is there twice")
        by_key[key] = value
    return by_key


def sweep_of(options: argparse.Namespace) -> Sweep:
    """Of a file of a sweep or a case, with what the command line adds, which wins over the file."""
    sweep = read_sweep(options.file) if is_sweep_file(options.file) else Sweep(options.file, {})
    vary = once_each(options.vary, "--vary")
    common = {key: value_of(text) for key, text in once_each(options.set, "--set").items()}
    said = {*(f"vary.{key}" for key in vary), *(f"set.{key}" for key in common)}
    changes: dict[str, Any] = {
        "vary": sweep.vary | vary,
        "set": sweep.set | common,
        "lines": {entry: line for entry, line in sweep.lines.items() if entry not in said},
    }
    if options.zip and options.sample is not None:
        raise DataError("--zip and --sample exclude each other")
    if options.zip:
        changes["combine"] = "zip"
    if options.sample is not None:
        changes |= {"combine": "sample", "count": options.sample}
    if options.seed is not None:
        if changes.get("combine", sweep.combine) != "sample":
            raise DataError("--seed is of a sample: give --sample N as well")
        changes["seed"] = options.seed
    if options.keep:
        changes["keep"] = options.keep
    return replace(sweep, **changes)


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


def main(arguments: list[str]) -> int:
    options = make_parser().parse_args(arguments)
    code = command.DONE
    output = command.Output()

    def work() -> list[str]:
        nonlocal code
        sweep, folder = asked_for(options)
        if options.slurm is not None:
            return array_script(sweep, folder, options.slurm)
        if options.workers is not None and options.workers < 1:
            raise DataError("--workers is a whole number from 1 on")
        share = share_of(options.share) if options.share else None
        workers = 1 if share else options.workers or default_workers()
        finished = carry_out(sweep, folder, How(workers, options.scheduler, share, options.quiet, output.say))
        if finished.is_interrupted:
            left = f"interrupted, {finished.n_left} points are left; {NAME} --restart {folder}"
            command.report_error(NAME, left)
            code = command.INTERRUPTED
        elif finished.failures or finished.n_left:
            code = SOME_FAILED
        return [] if options.quiet else finished.told()

    return command.run(NAME, work, output) or code
