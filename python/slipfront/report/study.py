# SPDX-License-Identifier: BSD-3-Clause
"""The pages of the studies: what was found in words and numbers, the figure, and the whole table."""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib

from slipfront.figures import bases, convergence, interface_step, open_choices
from slipfront.figures.drawing import Drawing
from slipfront.figures.report import formatted, table
from slipfront.files import DataError, is_number, read_json_table, read_table
from slipfront.folder import belongs, result_file
from slipfront.report.page import Page, section, warnings_list, words
from slipfront.report.run import navigation

FIGURE_DPI = 180
MOST_ROWS = 400  # of a table that is shown
PERCENT = 100


@dataclass(frozen=True)
class Study:
    """A kind of study: the file that tells it, its figure, and pieces of HTML that say what came out."""

    summary: str
    points: str  # its table
    title: str
    draw: Callable[[Path], Drawing]
    verdicts: Callable[[dict[str, Any]], str]


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
        "Parameter",
        "Values (SI), the case's own bold",
        "Fronts",
        "Verdict",
        "Median error",
        "Order",
        "Stations",
    ]
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
        "scheme. "
        "A case with it: chosen.toml.</p>"
    )


def open_choices_verdicts(summary: dict[str, Any]) -> str:
    """For each claim, the share of samples for which it holds, and at which levels its verdict turns."""
    rows = []
    for row in summary["matrix"]:
        turns = ", ".join(f"{t['choice']} = {t['level']}" for t in row["turns"])
        shares = [f"{formatted(row[key], '.0f', PERCENT)}" for key in open_choices.SHARES]
        rows.append([words(row["id"]), "holds" if row["holds"] else "does not", words(turns or "–"), *shares])
    return table(["Claim", "Holds", "Turns at", *open_choices.SHARES.values()], rows)


def bases_verdicts(summary: dict[str, Any]) -> str:
    rows = []
    for base in summary["bases"]:
        ratio, change = base["speed_ratio"], base["pressure_change"]
        rows.append(
            [
                words(base["name"]),
                formatted(ratio["median"], ".2f"),
                percent(base["share_in_paper_band"]),
                percent(change["against"]),
                percent(change["along"]),
                words(base["n_points"]),
            ]
        )
    header = ["Base", "Speed against over along the shear", "Points in the paper's band",
              "Change of pressure against", "along", "Points"]  # fmt: skip
    return table(header, rows)


STUDIES = (
    Study("convergence.json", "convergence.csv", "Convergence of the front speeds", convergence.convergence,
          convergence_verdicts),
    Study(interface_step.SUMMARY, interface_step.TABLE, "Error and cost of the step at the interface",
          lambda folder: interface_step.draw([folder]), interface_step_verdicts),
    Study(open_choices.SUMMARY, open_choices.TABLE, "What the paper leaves open", open_choices.draw,
          open_choices_verdicts),
    Study(bases.SUMMARY, bases.POINTS, "The paper's events on deformable bases", bases.draw, bases_verdicts),
)  # fmt: skip


def study_of(folder: Path) -> Study | None:
    return next((study for study in STUDIES if belongs(folder / study.summary)), None)


def is_kind(folder: Path) -> bool:
    return study_of(folder) is not None


def figure(drawing: Drawing) -> str:
    with matplotlib.rc_context({"savefig.dpi": FIGURE_DPI}):
        image = base64.b64encode(drawing.rendered("png", Software=None)).decode()
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


def page(folder: Path, _file: Path) -> Page:
    study = study_of(folder)
    assert study is not None
    file = result_file(folder / study.summary)
    summary = read_json_table(file)
    try:
        verdicts = study.verdicts(summary)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise DataError(f"{file}: not as expected: {error}") from None
    title, told = str(summary.get("title", "")), summary.get("warnings", [])
    places = [("verdicts", "What was found"), ("figure", "Figure"), ("table", "Table")]
    return Page(
        title=f"{study.title}: {title}" if title else study.title,
        parts=[
            f"<p>{words(summary.get('version', ''))}</p>",
            warnings_list(told if isinstance(told, list) else []),
            navigation(places),
            section("verdicts", "What was found", verdicts),
            section("figure", "Figure", figure(study.draw(folder))),
            section("table", "Table", whole_table(folder / study.points)),
        ],
    )
