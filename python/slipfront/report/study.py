# SPDX-License-Identifier: BSD-3-Clause
"""The pages of the studies: what was found in words and numbers, the figure, and the whole table."""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib

from slipfront.figures import convergence, interface_step
from slipfront.figures.drawing import Drawing
from slipfront.files import DataError, is_number, read_json_table, read_table
from slipfront.folder import belongs, result_file
from slipfront.report.page import Page, section, warnings_list, words
from slipfront.report.run import navigation
from slipfront.report.tables import formatted, table

FIGURE_DPI = 180
MOST_ROWS = 400  # of a table that is shown
PERCENT = 100


@dataclass(frozen=True)
class Study:
    """A kind of folders: the file that tells it, its figure, and pieces of HTML that say what came out."""

    summary: str
    points: str  # its table
    title: str
    draw: Callable[[Path], Drawing]
    verdicts: Callable[[dict[str, Any]], str]

    def is_kind(self, folder: Path) -> bool:
        return belongs(folder / self.summary)

    def page(self, folder: Path, _file: Path) -> Page:
        file = result_file(folder / self.summary)
        summary = read_json_table(file)
        try:
            verdicts = self.verdicts(summary)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise DataError(f"{file}: not as expected: {error}") from None
        title, told = str(summary.get("title", "")), summary.get("warnings", [])
        places = [("verdicts", "What was found"), ("figure", "Figure"), ("table", "Table")]
        return Page(
            title=f"{self.title}: {title}" if title else self.title,
            parts=[
                f"<p>{words(summary.get('version', ''))}</p>",
                warnings_list(told if isinstance(told, list) else []),
                navigation(places),
                section("verdicts", "What was found", verdicts),
                section("figure", "Figure", figure(self.draw(folder))),
                section("table", "Table", whole_table(folder / self.points)),
            ],
        )


def percent(value: Any) -> str:
    return f"{formatted(value, '.2g', PERCENT)} %" if is_number(value) else "–"


def shown_values(entry: dict[str, Any]) -> str:
    """The values of a parameter, the case's own in bold."""
    own = entry["case_value"]
    return ", ".join(f"<b>{v:.4g}</b>" if v == own else f"{v:.4g}" for v in entry["values"])


def convergence_verdicts(summary: dict[str, Any]) -> str:
    """How far the front speeds are from their limits, by parameter and direction."""
    rows = []
    for entry in summary["sequences"]:
        key = entry["parameter"]
        name = f"{convergence.NAMES.get(key, key)} <code>{words(key)}</code>"
        parts = {"both": entry, "to −x": entry["direction_-1"], "to +x": entry["direction_+1"]}
        for i, (fronts, part) in enumerate(parts.items()):
            stations = f"{part['n_stations']} of {part['n_stations_of_case']}"
            numbers = [
                percent(part["median_relative_error"]),
                formatted(part["median_order"], ".2g"),
                stations,
            ]
            first = [name, shown_values(entry)] if i == 0 else ["", ""]
            rows.append([*first, fronts, words(part["verdict"]), *map(words, numbers)])
    header = [
        "Parameter", "Values (SI), the case's own bold", "Fronts", "Verdict", "Median error", "Order",
        "Stations",
    ]  # fmt: skip
    return f"<p>Tolerance: {percent(summary['tolerance'])}.</p>" + table(header, rows)


def interface_step_verdicts(summary: dict[str, Any]) -> str:
    chosen = summary.get("chosen")
    if not isinstance(chosen, dict):
        return f"<p>No choice is within the tolerance of {percent(summary['tolerance'])}.</p>"
    return (
        f"<p>Cheapest choice for which 90 % of the stations are within {percent(summary['tolerance'])}: "
        f"time.step_factor = {chosen['step_factor']:g}, time.interface_rows = {chosen['interface_rows']}, "
        f"time.interface_substeps = {chosen['interface_substeps']}; 90 % of the stations within "
        f"{percent(chosen['p90_error'])} at {chosen['cost_over_plain']:.3g} times the cost of the plain "
        "scheme. A case with it: chosen.toml.</p>"
    )


STUDIES = (
    Study("convergence.json", "convergence.csv", "Convergence of the front speeds", convergence.convergence,
          convergence_verdicts),
    Study(interface_step.SUMMARY, interface_step.TABLE, "Error and cost of the step at the interface",
          interface_step.draw_one, interface_step_verdicts),
)  # fmt: skip


def figure(drawing: Drawing) -> str:
    with matplotlib.rc_context({"savefig.dpi": FIGURE_DPI}):
        image = base64.b64encode(drawing.rendered("png")).decode()
    alt = words(drawing.name)
    caption = f"<figcaption>{drawing.caption}</figcaption>" if drawing.caption else ""
    return f'<figure class="page"><img alt="{alt}" src="data:image/png;base64,{image}">{caption}</figure>'


def whole_table(file: Path) -> str:
    """The study's table, its columns with their units as they are in the file."""
    points = read_table(result_file(file))
    rows = [[words(cell) for cell in cells] for _, cells in points.rows[:MOST_ROWS]]
    left = len(points.rows) - len(rows)
    more = (
        f"<p>The first {len(rows)} of {len(points.rows)} rows; all are in {words(file.name)}.</p>"
        if left
        else ""
    )
    return more + table([words(name) for name in points.header], rows, kind="dense")
