# SPDX-License-Identifier: BSD-3-Clause
"""`python -m slipfront.figures DIR [--format KIND]`"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib

from slipfront import command
from slipfront.figures import balance, convergence, interface_step
from slipfront.figures.drawing import Drawing, guarded, kinds_of, list_of, parser_of_kinds
from slipfront.figures.style import RC
from slipfront.files import DataError, is_folder
from slipfront.folder import UNFINISHED, belongs, inside

#: The figure of a study, by the file that tells what a folder holds.
STUDIES = {"convergence.json": convergence.convergence, interface_step.SUMMARY: interface_step.draw_one}


def drawn(folder: Path) -> tuple[Drawing, list[str]]:
    """The one figure of a run or a study, and what to print beside it."""
    for summary, draw in STUDIES.items():
        if belongs(folder / summary):
            return draw(folder), []
    if belongs(folder / "energy.csv") or belongs(folder / UNFINISHED / "run.json"):
        return balance.balance_of_run(folder)
    if belongs(folder / "sweep.json"):
        raise DataError(f"{folder}: is of a sweep: python -m slipfront.sweep.maps PICTURE DIR draws it")
    what = "holds no results of a run or of a study of a case" if is_folder(folder) else "no such folder"
    raise DataError(f"{folder}: {what}")


def write_figure(folder: Path, kinds: Sequence[str]) -> list[str]:
    """Into DIR/figures; returns what to print."""
    with matplotlib.rc_context(RC):
        drawing, remarks = guarded(folder, lambda: drawn(folder))
        with command.publishing_into(inside(folder, "figures")) as made:
            drawing.save(made, kinds)
    others = f" (and {list_of(kinds[1:])})" if len(kinds) > 1 else ""
    lines = [f"figure: {folder / 'figures' / drawing.name}.{kinds[0]}{others}"]
    return lines + [f"note: {remark}" for remark in remarks]


def main(arguments: list[str] | None = None) -> int:
    parser = parser_of_kinds(
        "python -m slipfront.figures",
        "Draws the figure of a study of a case, or the energy balance of a single run, into DIR/figures.",
        "`slipfront study` or `slipfront run`",
    )
    options = parser.parse_args(arguments)
    return command.run("slipfront.figures", lambda: write_figure(options.dir, kinds_of(options)))


if __name__ == "__main__":
    sys.exit(main())
