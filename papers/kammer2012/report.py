# SPDX-License-Identifier: BSD-3-Clause
"""Pages of HTML to look into a reproduction, the open choices or the bases in a browser:

    python papers/kammer2012/report.py DIR [-o FILE]

writes one file, as `slipfront report` does of other results, that needs no network."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib
from draw import draw_all
from drawing import bases, open_choices
from drawing import html as tables
from drawing.criteria import FIT_COLOUR
from drawing.paper_style import EVENT_STYLES
from drawing.results import Fit, Results, read_results
from slipfront.folder import belongs
from slipfront.opened import OpenRun, drawn_history
from slipfront.read import Front
from slipfront.report import run as single
from slipfront.report.command import main
from slipfront.report.history import ThinHistory, thinned
from slipfront.report.page import Page, section, warnings_list, words
from slipfront.report.run_data import (
    MEASURES,
    FrontLook,
    constant_fields,
    has_snapshots,
    run_data,
)
from slipfront.report.study import PERCENT, Study, percent
from slipfront.report.tables import formatted, table

MOST_TIMES, MOST_NODES = 220, 220  # of each run, so that the page stays small
FIGURE_DPI = 160  # as wide as the page
SYMBOLS = {
    "left": "square",
    "spontaneous": "circle",
    "right": "triangle-up",
    "spontaneous_mu_k_1.0": "diamond",
}
PLACES = [
    ("figures", "Figures"),
    ("scorecard", "Scorecard"),
    ("criteria", "Criteria"),
    ("runs", "Runs"),
    ("space-time", "Space-time"),
    ("profiles", "t/p at a time"),
    ("energy", "Energy"),
    ("snapshots", "Snapshots"),
    ("fit", "Fit"),
    ("fronts", "Fronts"),
]
INTRODUCTION = (
    "<p>Reproduction of Kammer, Yastrebov, Spijker, Molinari, <i>On the propagation of slip fronts at "
    "frictional "
    "interfaces</i>, Tribology Letters 48, 27–32 (2012).</p>"
)


def label(name: str) -> str:
    """An event's name without formulas."""
    return EVENT_STYLES[name].label.replace("$\\mu_k = 1.0$", "μ_k = 1.0")


def look(run: OpenRun, front: Front) -> FrontLook:
    """The event's colour; filled symbols are fronts against the imposed shear, open ones those along it."""
    against = front.direction < 0
    way = "to −x, against the shear" if against else "to +x, along the shear"
    symbol = SYMBOLS[run.name] + ("" if against else "-open")
    return FrontLook(f"front {front.id} {way}", EVENT_STYLES[run.name].front(front.direction).colour, symbol)


def fit_curves(results: Results) -> list[dict[str, Any]]:
    """The curves of Fig. 6."""

    def curve(name: str, fit: Fit, colour: str, dash: str) -> dict[str, Any]:
        return {"name": name, "a": fit.a, "b": fit.b, "c": fit.c, "colour": colour, "dash": dash}

    found = [curve("the paper's fit", results.paper_fit, "#888888", "solid")]
    if results.fit is not None:
        found.append(curve("fit to all points", results.fit, FIT_COLOUR, "dot"))
    if results.main_fronts_fit is not None:
        main_fit = results.main_fronts_fit
        found.append(curve(f"fit to main fronts ({main_fit.id})", main_fit.fit, FIT_COLOUR, "solid"))
    return found


def runs_table(results: Results) -> str:
    """A row for each run, and where the page of it alone comes from."""
    rows = []
    for name, run in results.runs.items():
        folder = words(results.folder / name)
        rows.append(
            [
                words(label(name)),
                words(run.info.get("title", "")),
                single.ending(run),
                str(len(run.front_list)),
                str(len(run.notes)),
                f"<code>slipfront report {folder}</code>",
            ]
        )
    return table(["Run", "Case", "End", "Fronts", "Notes", "A page of its own"], rows)


def run_list() -> str:
    label_and_list = '<label for="run">The diagrams below show the run</label> <select id="run"></select>'
    return f'<p class="runs">{label_and_list}</p>'


def figures(results: Results) -> list[str]:
    with matplotlib.rc_context({"savefig.dpi": FIGURE_DPI}):
        drawings = draw_all(results)
        return [tables.figure_html(d, results, d.rendered("png")) for d in drawings]


def runs_parts(results: Results, histories: list[ThinHistory]) -> list[str]:
    """The diagrams of one run at a time."""
    all_have_snapshots = all(has_snapshots(run) for run in results.runs.values())
    return [
        section("runs", "Runs", runs_table(results)),
        run_list(),
        single.space_time_section(single.thinning(histories[0]), constant_fields(histories)),
        single.profiles_section(histories[0]),
        single.energy_section(),
        single.snapshots_section(all_have_snapshots),
    ]


def reproduction(folder: Path, _file: Path) -> Page:
    results = read_results(folder)
    histories = [thinned(drawn_history(run), (MOST_TIMES, MOST_NODES)) for run in results.runs.values()]
    pairs = zip(results.runs.items(), histories, strict=True)
    runs = [run_data(run, history, look, label(name)) for (name, run), history in pairs]
    panels = [measure for measure in MEASURES if any(measure in run["panels"] for run in runs)]
    constant = constant_fields(histories)
    scorecard = section(
        "scorecard",
        "Scorecard",
        f"<p>{tables.scorecard_summary(results.scorecard)}</p>",
        tables.scorecard_table(results.scorecard),
    )
    return Page(
        title="Slip fronts at a frictional interface: reproduction",
        parts=[
            INTRODUCTION,
            f"<p>Runs by {tables.origin(results)}.</p>",
            warnings_list(results.remarks, "mark"),
            single.navigation(PLACES),
            section("figures", "Figures", *figures(results)),
            scorecard,
            single.criteria_section(panels, more="Fronts of all four runs; a click on a name hides them."),
            *runs_parts(results, histories),
            section(
                "fit", "Fit of the energy criterion", tables.fit_table(results), tables.spread_table(results)
            ),
            *tables.study_section(results),
            section("fronts", "Fronts", tables.front_table(results)),
            *tables.timing_section(results),
        ],
        data={
            "runs": runs,
            "fields": [field for field in single.FIELDS if field not in constant],
            "panels": panels,
            "folded": False,
            "fits": fit_curves(results),
        },
        notes=results.remarks,
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


KINDS = (
    SimpleNamespace(is_kind=lambda folder: belongs(folder / "scorecard.json"), page=reproduction),
    Study(open_choices.SUMMARY, open_choices.TABLE, "What the paper leaves open", open_choices.draw,
          open_choices_verdicts),
    Study(bases.SUMMARY, bases.POINTS, "The paper's events on deformable bases", bases.draw, bases_verdicts),
)  # fmt: skip

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:], KINDS, "report.py"))
