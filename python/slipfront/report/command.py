# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront report DIR [-o FILE]`"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import matplotlib

from slipfront import command
from slipfront.figures.drawing import guarded
from slipfront.figures.style import RC
from slipfront.files import DataError, exists, is_folder
from slipfront.folder import LIST, read_list
from slipfront.report import run, sequence
from slipfront.report.page import Page, require_replaceable, write_page
from slipfront.report.study import STUDIES
from slipfront.sweep import report as sweep


class Kind(Protocol):
    """Folders of one kind, and their pages: a module or an object."""

    def is_kind(self, folder: Path, /) -> bool: ...
    def page(self, folder: Path, file: Path, /) -> Page: ...


#: The first kind that a folder is one of makes the page.
KINDS: tuple[Kind, ...] = (*STUDIES, sweep, sequence, run)
DEFAULT_NAME = "report.html"


def write_report(folder: Path, file: Path, kinds: Sequence[Kind]) -> list[str]:
    """Writes the page of a folder of results; returns what to print."""
    if not is_folder(folder):
        raise DataError(f"{folder}: no such folder; DIR is an output folder of slipfront")
    require_replaceable(file)
    kind = next((kind for kind in kinds if kind.is_kind(folder)), None)
    if kind is None:
        raise DataError(f"{folder}: holds no results of a run, a sequence, a study of a case or a sweep")
    with matplotlib.rc_context(RC):
        page = guarded(folder, lambda: kind.page(folder, file))
    notes = write_page(page, file)
    if exists(folder / "run.json") and read_list(folder) is None:
        notes.append(f"{folder}: has no {LIST}, so that its files cannot be checked")
    return notes


def main(arguments: list[str], kinds: Sequence[Kind] = KINDS, prog: str = "slipfront report") -> int:
    parser = command.Parser(
        prog=prog,
        description="Writes one page of HTML to look at results in a browser: diagrams to zoom into and to "
        "point at, facts, tables. It needs no network. An earlier report of that name is replaced, nothing "
        "else.",
    )
    parser.add_argument("dir", metavar="DIR", type=Path, help="output folder of a command")
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help=f"the page to write (default: DIR/{DEFAULT_NAME})"
    )
    options = parser.parse_args(arguments)
    file = options.output or options.dir / DEFAULT_NAME
    return command.run(prog, lambda: write_report(options.dir, file, kinds))
