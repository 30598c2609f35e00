# SPDX-License-Identifier: BSD-3-Clause
"""What the commands of this folder share."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from pathlib import Path

import slipfront
from slipfront import command
from slipfront.errors import WriteError
from slipfront.running import Bar


def parser_of(description: str, output: str | None = None) -> ArgumentParser:
    """With the options that all commands have."""
    parser = command.Parser(description=description)
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, default=output, required=output is None,
        help="folder for the results",
    )  # fmt: skip
    parser.add_argument("--overwrite", action="store_true", help="replace the results that the folder holds")
    parser.add_argument("--threads", type=int, help="runs side by side; by default as many as processors")
    return parser


def run_command(parser: ArgumentParser, work: Callable[[Namespace], list[str]]) -> int:
    """Exit code of a command, which prints the lines of `work`, or its error as one line."""
    options = parser.parse_args()
    try:
        return command.run(parser.prog, lambda: work(options))
    except slipfront.Error as error:
        command.report_error(parser.prog, str(error))
        return command.NOT_WRITTEN if isinstance(error, WriteError) else command.REFUSED


class Progress:
    """Runs that are done: a bar on terminals, else a line at each tenth."""

    def __init__(self, total: int) -> None:
        self.total, self.done, self.bar = total, 0, Bar()

    def step(self, more: int = 0) -> None:
        """One is done. more: that there are to be."""
        self.done += 1
        self.bar("runs", self.done, self.total)
        tenth = max(1, self.total // 10)
        if not sys.stderr.isatty() and self.done % tenth == 0:
            command.write_line(sys.stderr, f"{self.done} of {self.total} runs")
