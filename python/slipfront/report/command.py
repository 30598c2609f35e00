# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront report DIR [-o FILE]`"""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import matplotlib

from slipfront import command
from slipfront.figures.drawing import guarded
from slipfront.figures.style import RC
from slipfront.files import DataError, exists, is_folder
from slipfront.folder import LIST, read_list
from slipfront.report import reproduction, run, sequence, study
from slipfront.report.page import require_replaceable, write_page
from slipfront.sweep import report as sweep

#: Kinds of folders, the first that is one of them makes the page: is_kind(folder), page(folder, file).
KINDS: tuple[ModuleType, ...] = (reproduction, study, sweep, sequence, run)
DEFAULT_NAME = "report.html"


def write_report(folder: Path, file: Path) -> list[str]:
    """Writes the page of a folder of results; returns what to print."""
    if not is_folder(folder):
        raise DataError(f"{folder}: no such folder; DIR is an output folder of slipfront")
    require_replaceable(file)
    kind = next((kind for kind in KINDS if kind.is_kind(folder)), None)
    if kind is None:
        raise DataError(
            f"{folder}: holds no results of a run, a sequence, a study, a sweep or a reproduction"
        )
    with matplotlib.rc_context(RC):
        page = guarded(folder, lambda: kind.page(folder, file))
    notes = write_page(page, file)
    if exists(folder / "run.json") and read_list(folder) is None:
        notes.append(f"{folder}: has no {LIST}, so that its files cannot be checked")
    return notes


def main(arguments: list[str]) -> int:
    parser = command.Parser(
        prog="slipfront report",
        description="Writes one page of HTML to look at results in a browser: diagrams to zoom into and to "
        "point at, "
        "facts, tables. It needs no network. An earlier report of that name is replaced, nothing else.",
    )
    parser.add_argument(
        "dir", metavar="DIR", type=Path, help="output folder of slipfront run, study, sweep or reproduce"
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help=f"the page to write (default: DIR/{DEFAULT_NAME})"
    )
    options = parser.parse_args(arguments)
    file = options.output or options.dir / DEFAULT_NAME
    return command.run("slipfront report", lambda: write_report(options.dir, file))
