# SPDX-License-Identifier: BSD-3-Clause
"""`python -m slipfront.figures DIR [--format KIND] [--experiment CSV]`"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib

from slipfront import command
from slipfront.figures import (
    balance,
    convergence,
    criteria,
    events,
    interface_step,
    open_choices,
    plate,
    space_time,
    studies,
)
from slipfront.figures.drawing import WITHOUT_DATE, Drawing, guarded
from slipfront.figures.picture import FIXED_NAMES
from slipfront.figures.report import write_report
from slipfront.figures.results import Results, read_results
from slipfront.figures.style import RC
from slipfront.files import DataError
from slipfront.folder import UNFINISHED, belongs, inside

BOTH = ("png", "pdf")


def draw_all(results: Results) -> list[Drawing]:
    """Every figure, in the order of the report."""
    drawings = [
        plate.setup(results),
        criteria.static_ratio_mu_k(results),
        events.three_events(results),
        criteria.dynamic_ratio_along_x(results),
        criteria.dynamic_criterion(results),
        criteria.energy(results),
        *(space_time.space_time(results, name) for name in results.runs),
        balance.balance(results),
        *([studies.speeds(results), studies.criteria(results)] if results.studies else []),
    ]
    return [drawing.marked(results.mark) for drawing in drawings]


def is_single_run(folder: Path) -> bool:
    return belongs(folder / "energy.csv") or belongs(folder / UNFINISHED / "run.json")


def list_of(kinds: Sequence[str]) -> str:
    return " and ".join(kind.upper() for kind in kinds)


def write_single(
    folder: Path, kinds: Sequence[str], draw: Callable[[], tuple[Drawing, list[str]]]
) -> list[str]:
    """The one figure of a run or a study; returns what to print."""
    drawing, remarks = guarded(folder, draw)
    with command.publishing_into(inside(folder, "figures")) as made:
        drawing.save(made, kinds)
    others = f" (and {list_of(kinds[1:])})" if len(kinds) > 1 else ""
    lines = [f"figure: {folder / 'figures' / drawing.name}.{kinds[0]}{others}"]
    return lines + [f"note: {remark}" for remark in remarks]


def write_reproduction(folder: Path, kinds: Sequence[str], experiment: Path | None) -> list[str]:
    """All figures of a reproduction and, with PNG among them, the report; returns what to print."""
    results = read_results(folder, experiment)
    drawings = guarded(folder, lambda: draw_all(results))
    with command.publishing_into(inside(folder, "figures")) as made:
        for drawing in drawings:
            drawing.save(made, kinds)
        if "png" in kinds:
            guarded(folder, lambda: write_report(results, drawings, made))
    return [
        f"figures: {folder / 'figures'} ({len(drawings)}, each as {list_of(kinds)})",
        *([f"report:  {folder / 'figures' / 'index.html'}"] if "png" in kinds else []),
        *(f"note: {remark}" for remark in results.remarks),
    ]


def write_figures(folder: Path, experiment: Path | None, kinds: Sequence[str] = BOTH) -> list[str]:
    """What a folder's files allow, told by a file of its own; returns what to print."""
    with matplotlib.rc_context({**RC, **FIXED_NAMES}):
        if belongs(folder / "convergence.json"):
            return write_single(folder, kinds, lambda: (convergence.convergence(folder), []))
        if belongs(folder / interface_step.SUMMARY):
            return write_single(folder, kinds, lambda: (interface_step.draw([folder]), []))
        if belongs(folder / open_choices.SUMMARY):
            return write_single(folder, kinds, lambda: (open_choices.draw(folder), []))
        if is_single_run(folder):
            return write_single(folder, kinds, lambda: balance.balance_of_run(folder))
        if belongs(folder / "sweep.json"):
            raise DataError(f"{folder}: is of a sweep: python -m slipfront.sweep.maps PICTURE DIR draws it")
        return write_reproduction(folder, kinds, experiment)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m slipfront.figures",
        description="Draws the figures and the report (HTML) of a reproduction, the figure of a "
        "study, or the energy balance of a single run, into DIR/figures.",
    )
    parser.add_argument(
        "dir",
        metavar="DIR",
        type=Path,
        help="output folder of `slipfront reproduce`, `slipfront study` or `slipfront run`",
    )
    parser.add_argument(
        "--format",
        choices=WITHOUT_DATE,
        action="append",
        help="kind of the pictures, may be given more than once (default: png and pdf); the report has PNG",
    )
    parser.add_argument(
        "--experiment",
        metavar="CSV",
        type=Path,
        help="measured points to draw into figure 2: columns static_ratio and v_over_c_L or v_m_per_s",
    )
    options = parser.parse_args(arguments)
    kinds = tuple(dict.fromkeys(options.format or BOTH))
    return command.run("slipfront.figures", lambda: write_figures(options.dir, options.experiment, kinds))


if __name__ == "__main__":
    sys.exit(main())
