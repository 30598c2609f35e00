# SPDX-License-Identifier: BSD-3-Clause
"""The paper's figures and a page of HTML with them: python papers/kammer2012/draw.py DIR"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib
from drawing import criteria, events, setup, space_time, studies
from drawing.html import write_report
from drawing.paper_style import EVENT_STYLES
from drawing.results import Results, read_results
from slipfront import command
from slipfront.figures.balance import Books, draw_balances
from slipfront.figures.drawing import Drawing, guarded, kinds_of, list_of, parser_of_kinds
from slipfront.figures.style import RC
from slipfront.folder import inside


def draw_all(results: Results) -> list[Drawing]:
    """Every figure, in the order of the report."""
    balances = [Books(name, EVENT_STYLES[name].label, run.balance) for name, run in results.runs.items()]
    drawings = [
        setup.setup(results),
        criteria.static_ratio_mu_k(results),
        events.three_events(results),
        criteria.dynamic_ratio_along_x(results),
        criteria.dynamic_criterion(results),
        criteria.energy(results),
        *(space_time.space_time(results, name) for name in results.runs),
        draw_balances(balances),
        *([studies.speeds(results), studies.criteria(results)] if results.studies else []),
    ]
    return [drawing.marked(results.mark) for drawing in drawings]


def write_figures(folder: Path, kinds: Sequence[str]) -> list[str]:
    """Into DIR/figures, with PNG among the kinds the page as well; returns what to print."""
    with matplotlib.rc_context(RC):
        results = read_results(folder)
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


def main(arguments: list[str] | None = None) -> int:
    parser = parser_of_kinds(
        "python papers/kammer2012/draw.py",
        "Draws the paper's figures and a page of HTML with them, which needs PNG, into DIR/figures.",
        "`reproduce.py`",
    )
    options = parser.parse_args(arguments)
    return command.run("draw.py", lambda: write_figures(options.dir, kinds_of(options)))


if __name__ == "__main__":
    sys.exit(main())
