# SPDX-License-Identifier: BSD-3-Clause
"""The report: one page of HTML with every figure, its caption, the scorecard and the fronts."""

from __future__ import annotations

import base64
import re
from html import escape
from pathlib import Path
from typing import Any

from slipfront.figures.drawing import Drawing
from slipfront.figures.style import COLUMN_MM, TEXT_MM
from slipfront.report.tables import formatted, front_cells, table, text

from drawing.criteria import TAIL_M
from drawing.results import VARIATIONS, MainFrontsFit, Results
from drawing.statements import STATEMENTS
from drawing.studies import is_another, paper_values
from drawing.study import SPREADS

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #111; background: #fff; }
body { max-width: 84em; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.6em; } h2 { font-size: 1.25em; margin-top: 2.2em; }
figure { margin: 2em 0; } figure img { max-width: 100%; display: block; }
figcaption { font-size: 0.9em; color: #333; margin-top: 0.5em; max-width: 52em; }
.column img { width: 34em; } .text img { width: 44em; } .page img { width: 100%; }
@media (min-width: 70em) {
  .beside { display: grid; grid-template-columns: 3fr 2fr; column-gap: 2em; } .beside img { width: 100%; }
  .statements { grid-column: 2; grid-row: 1 / 3; }
}
.claims td { white-space: nowrap; } .claims td:nth-child(2) { white-space: normal; min-width: 20em; }
.claims summary { max-width: 38em; overflow: hidden; text-overflow: ellipsis; cursor: pointer; }
.claims [open] summary, .claims p { white-space: normal; max-width: 48em; margin: 0.3em 0; }
table { border-collapse: collapse; font-size: 0.87em; }
th, td { text-align: left; vertical-align: top; padding: 0.3em 0.7em; }
thead { border-bottom: 1px solid #111; } tbody tr { border-bottom: 1px solid #ddd; }
td.verdict { text-align: center; font-weight: bold; }
.yes { color: #117733; } .no { color: #b2182b; } .open { color: #666; }
.scroll { overflow-x: auto; }
.dense { font-size: 0.78em; } .dense th, .dense td { padding: 0.15em 0.35em; white-space: nowrap; }
.dense td[rowspan] { white-space: normal; min-width: 8em; border-right: 1px solid #ddd; }
.note { color: #555; } td .note { font-weight: normal; } .mark { color: #b2182b; font-weight: bold; }
nav a { margin-right: 1.2em; }
"""
VERDICTS = {
    True: ("✓", "yes", "holds"),
    False: ("✗", "no", "does not hold"),
    None: ("–", "open", "not decided"),
}
USED_TO_CHOOSE = ("=", "open", "used to choose what the paper leaves open")
STATEMENT_HEADER = ["The paper says", "This program", "", ""]


def is_used_to_choose(entry: dict[str, Any]) -> bool:
    """Whether a claim holds because the cases were chosen so."""
    return entry["holds"] is True and entry.get("used_to_choose") is True


def verdict_of(entry: dict[str, Any]) -> tuple[str, str, str]:
    """Sign, class and meaning of a row's verdict."""
    return USED_TO_CHOOSE if is_used_to_choose(entry) else VERDICTS.get(entry["holds"], VERDICTS[None])


def scorecard_table(scorecard: list[dict[str, Any]]) -> str:
    """A line for each claim, with the verdict that counts; behind it, folded away, its tests."""
    rows = []
    for counted in (entry for entry in scorecard if entry.get("counts", True) and not is_further_test(entry)):
        others = [e for e in scorecard if claim_of(e) == claim_of(counted) and e is not counted]
        rows.append(
            [
                *(text(counted[key]) for key in ("id", "claim", "paper")),
                verdict_cell(counted),
                f"<details><summary>{text(counted['measured'])}</summary>{tested(counted)}"
                + "".join(
                    f"<p>{sign_of(e)} {text(e['id'])}: {text(e['measured'])}</p>{tested(e)}" for e in others
                )
                + "</details>",
            ]
        )
    return variation_note(scorecard) + table(
        ["", "Claim", "Paper", "", "Measured; how tested"], rows, kind="claims"
    )


def claim_of(entry: dict[str, Any]) -> str:
    """The claim that a row tests: C18 of C18, C18+, C18b and C18c."""
    found = re.match(r"[A-Z]\d+", entry["id"])
    return found[0] if found else entry["id"]


def is_further_test(entry: dict[str, Any]) -> bool:
    return entry["id"].endswith("+") and "second_test_of" not in entry


def sign_of(entry: dict[str, Any]) -> str:
    sign, kind, meaning = verdict_of(entry)
    return f'<span class="{kind}" title="{meaning}">{sign}</span>'


def tested(entry: dict[str, Any]) -> str:
    """How a row was tested, why instead of its claim's first test, and how far its numbers move."""
    parts = [f"Test: {text(entry['how'])}."]
    if "second_test_of" in entry:
        parts.append(f"Instead of {escape(entry['second_test_of'])}: {escape(entry.get('why', ''))}.")
    for key, words in VARIATIONS.items():
        if moves := (entry.get(key) or {}).get("moves"):
            parts.append(f"{words} {text(moves)}.")
    return f'<p class="note">{" ".join(parts)}</p>'


def is_counted_second_test(entry: dict[str, Any]) -> bool:
    return "second_test_of" in entry and entry.get("counts", False)


def variation_note(scorecard: list[dict[str, Any]]) -> str:
    """Which runs the columns of the variations come from."""
    varied = {
        f"{entry[key]['parameter']} = {entry[key]['value']:.4g}"
        for entry in scorecard
        for key in VARIATIONS
        if key in entry
    }
    if not varied:
        return ""
    return (
        '<p class="note">Moves by: difference of each number from that of runs with '
        f"{escape(' and '.join(sorted(varied)))}, one at a time, in the same unit, and the verdict there "
        "where it is another. The paper's friction law has no limit with the mesh: these are no distances "
        "from a converged value.</p>"
    )


def scorecard_summary(scorecard: list[dict[str, Any]]) -> str:
    first = [e for e in scorecard if not e["id"].endswith("+") and "second_test_of" not in e]
    second = [e for e in scorecard if "second_test_of" in e]
    counted = [e for e in first if e.get("counts", True)] + [e for e in second if is_counted_second_test(e)]
    used = sum(is_used_to_choose(entry) for entry in counted)
    count = {key: sum(entry["holds"] is key for entry in counted) for key in (True, False)}
    rest = len(counted) - sum(count.values())
    summary = (
        f"Of {len(counted)} statements {count[True] - used} hold (✓), {count[False]} do not (✗), {rest} "
        "could not be decided (–)."
    )
    if used:
        summary += f" Used to choose what the paper leaves open (=): {used}."
    if second:
        held = sum(entry["holds"] is True and not is_used_to_choose(entry) for entry in first)
        summary += (
            f" Where the first test misjudges a statement a second one ({len(second)}) counts, once it was "
            f"done; by the first tests alone {held} hold."
        )
    added = len(scorecard) - len(first) - len(second)
    if added:
        summary += f" Rows with a + ({added}) are further tests of the same statement, not counted."
    return summary


def main_fronts_note(main_fit: MainFrontsFit) -> str:
    """The intervals of the second test's fit are in the scorecard's words alone."""
    return f'<p>{escape(main_fit.id)} in the scorecard: "{escape(main_fit.measured)}".</p>'


def fit_table(results: Results) -> str:
    """The fit to all points and the second test's beside the paper's."""
    fit = results.analysis["fit"] or {}  # its numbers were read already
    main_fit = results.main_fronts_fit
    rows = []
    for name in ("a", "b", "c"):
        own = fit.get(name)
        own = own if isinstance(own, dict) else {"value": own}
        interval = f"{formatted(own.get('low'), '.3f')} to {formatted(own.get('high'), '.3f')}"
        paper = f"{getattr(results.paper_fit, name):.2f}"
        if name == "a":
            paper += f" ± {results.paper_a_band:.2f}"
        rows.append([f"<i>{name}</i>", formatted(own.get("value"), ".3f"), interval, paper])
        if main_fit is not None:
            rows[-1].append(formatted(getattr(main_fit.fit, name), ".3f"))
    header = ["", "All points (C18)", "Confidence interval", "Paper"]
    if main_fit is not None:
        header.append(f"Main fronts without their last {1e3 * TAIL_M:g} mm ({escape(main_fit.id)})")
    return (
        table(header, rows) + f"<p>All points (C18). Points: {text(fit.get('n_points'))}; rms about the fit: "
        f"{formatted(fit.get('rms_over_c_L'), '.3f')} c<sub>L</sub>; within the paper's band: "
        f"{formatted(results.analysis.get('share_in_paper_band'), '.0f', 100)} % of the points.</p>"
        + (main_fronts_note(main_fit) if main_fit is not None else "")
    )


def spread_table(results: Results) -> str:
    labels = {
        "t_s_over_p_s": "t<sub>s</sub>/p<sub>s</sub>",
        "t_d_over_p_d": "t<sub>d</sub>/p<sub>d</sub>",
        "energy": "(U<sub>r</sub> − U<sub>s</sub>)/U<sub>s</sub>",
    }
    spread = results.analysis.get("spread")
    if not isinstance(spread, dict):
        return ""
    rows = [[labels.get(key, escape(key)), formatted(value, ".2f")] for key, value in spread.items()]
    return "<h2>Spread of the front speeds</h2>" + table(
        ["Events compared at equal", "Relative spread"], rows
    )


def front_table(results: Results) -> str:
    rows = [
        [escape(name), *front_cells(f)]
        for name, run in results.runs.items()
        for f in run.info.get("fronts", [])
    ]
    header = ["Event", "Front", "Direction", "From", "at", "to", "at", "End", "Slip"]
    return table(header, rows)


def percent(value: float | None) -> str:
    """A share as a change in per cent, with its sign."""
    shown = "–" if value is None else f"{100 * value:+.1f}".replace("-", "−")
    return "0.0" if shown in ("+0.0", "−0.0") else shown


STUDY_FRONTS = (("left", 1), ("spontaneous", -1), ("spontaneous", 1), ("right", -1))
STUDY_EVENTS = ("left", "spontaneous", "right")


def value_html(value: str, index: int, paper: dict[str, int]) -> str:
    """A study's value; bold where it is that of a run of the paper, with the events where they differ."""
    events = [event for event in paper if paper[event] == index]
    if not events:
        return escape(value)
    names = f' <span class="note">{", ".join(events)}</span>' if len(set(paper.values())) > 1 else ""
    return f"<b>{escape(value)}</b>{names}"


def study_table(results: Results) -> str:
    """One row for each value of each study."""
    rows = []
    for study in results.studies:
        paper = paper_values(results, study)
        unit = f" ({study.unit[0]})" if study.numeric and study.unit[0] else ""
        first = (
            f'<td rowspan="{len(study.points)}"><b>{escape(study.name.replace("_", " "))}</b>{unit}<br>'
            f'<span class="note">{escape(study.why)}; <code>{escape(study.parameter)}</code></span></td>'
        )
        for i, point in enumerate(study.points):
            cells = [first] if i == 0 else []
            cells.append(f"<td>{value_html(study.shown(point), i, paper)}</td>")
            for key in STUDY_FRONTS:
                front = point.fronts.get(key)
                if front is None:
                    cells.append("–")
                    continue
                numbers = f"{formatted(front.max_over_c_L, '.2f')} / {formatted(front.mean_over_c_L, '.2f')}"
                cells.append(f"<td>{numbers}*</td>" if is_another(results, point, *key) else numbers)
            cells += [percent(point.change.get(event)) for event in STUDY_EVENTS]
            cells += [
                formatted(point.rms_over_c_L, ".3f"),
                formatted(point.share_in_paper_band, ".0f", 100),
                *(formatted(point.spread[name], ".2f") for name in SPREADS),
            ]
            rows.append(cells)
    header = [
        "Study",
        "Value",
        "left",
        "spont. against",
        "spont. along",
        "right",
        "left",
        "spont.",
        "right",
        "rms (c<sub>L</sub>)",
        "band (%)",
        "t<sub>s</sub>/p<sub>s</sub>",
        "t<sub>d</sub>/p<sub>d</sub>",
        "energy",
    ]
    groups = [("", 2), ("V<sub>tip</sub>/c<sub>L</sub>, max / mean", 4), ("Change (%)", 3), ("Fit", 2)]
    return table(header, rows, [*groups, ("Spread", 3)], "dense")


def timing_table(results: Results) -> str:
    rows = [[escape(part), f"{seconds:.1f}"] for part, seconds in results.timings]
    rows.append(["<b>sum</b>", f"{sum(seconds for _, seconds in results.timings):.1f}"])
    return table(["Part", "Wall time (s)"], rows)


def origin(results: Results) -> str:
    """Which program made the runs; each distinct version once."""
    made = {(run.info.get("version"), run.info.get("commit")) for run in results.runs.values()}
    return ", ".join(
        f"slipfront {text(version)}, commit {text(commit)}" for version, commit in sorted(made, key=str)
    )


def verdict_cell(entry: dict[str, Any]) -> str:
    sign, kind, meaning = verdict_of(entry)
    return f'<td class="verdict {kind}" title="{meaning}">{sign}</td>'


def statements_table(drawing: Drawing, results: Results) -> str:
    """What the paper says of a figure beside what the scorecard finds; nothing for other figures."""
    rows = []
    for statement, claim in STATEMENTS.get(drawing.name, ()):
        for row in results.claims(claim):
            rows.append([statement, text(row["measured"]), verdict_cell(row), text(row["id"])])
            statement = "the same, second test"
    return f'<div class="statements">{table(STATEMENT_HEADER, rows)}</div>' if rows else ""


def figure_kind(drawing: Drawing) -> str:
    """Which width a figure has, so that its text appears at the same size as that of the others."""
    width_mm = 25.4 * drawing.figure.get_figwidth()
    return "column" if width_mm <= COLUMN_MM + 1 else "text" if width_mm <= TEXT_MM + 1 else "page"


def figure_html(drawing: Drawing, results: Results, png: bytes, pdf: str = "") -> str:
    """A figure with its caption and what the paper says of it; `pdf` is a file to link to."""
    image = base64.b64encode(png).decode()
    title = escape(drawing.name)
    number = re.match(r"fig(\d+)_", drawing.name)
    label = f"<b>Figure {number[1]} of the paper.</b> " if number else ""
    mark = (
        f'<span class="mark">{escape(drawing.mark.replace(chr(10), "; "))}.</span> ' if drawing.mark else ""
    )
    link = f' <a href="{escape(pdf)}">PDF</a>' if pdf else ""
    statements = statements_table(drawing, results)
    return (
        f'<figure id="{title}" class="{figure_kind(drawing)}{" beside" if statements else ""}">'
        f'<img alt="{title}" src="data:image/png;base64,{image}">\n'
        f"<figcaption>{mark}{label}{drawing.caption}{link}</figcaption>"
        f"{statements}</figure>"
    )


def figure_with_files(drawing: Drawing, results: Results, folder: Path) -> str:
    """A figure whose files are in the folder."""
    png, pdf = (folder / f"{drawing.name}.{kind}" for kind in ("png", "pdf"))
    return figure_html(drawing, results, png.read_bytes(), pdf.name if pdf.exists() else "")


def study_section(results: Results) -> list[str]:
    if not results.studies:
        return []
    return [
        '<h2 id="studies-table">Studies</h2>',
        "<p>How much the results depend on each parameter; bold: the value of the paper's runs, with their "
        "names where they differ. Speeds: of "
        "the longest front of an event in its direction, * where it starts more than 10 mm from that of the "
        "paper's run. Change: median over the interface of the change of V<sub>tip</sub> against the "
        "reference run. Fit: about each value's own a + b exp(−c √r), and the share of its points within the "
        "paper's band. Spread: median relative spread of V<sub>tip</sub> at equal criterion.</p>",
        study_table(results),
    ]


def timing_section(results: Results) -> list[str]:
    return ['<h2 id="timings">Timings</h2>', timing_table(results)] if results.timings else []


def navigation(results: Results) -> str:
    parts = [("figures", "Figures"), ("scorecard", "Scorecard"), ("fit", "Fit")]
    parts += [("studies-table", "Studies")] if results.studies else []
    parts += [("fronts", "Fronts")]
    parts += [("timings", "Timings")] if results.timings else []
    return "<nav>" + "".join(f'<a href="#{place}">{name}</a>' for place, name in parts) + "</nav>"


def write_report(results: Results, drawings: list[Drawing], folder: Path) -> Path:
    """Writes index.html beside the figures' files, with the images inside it."""
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8">',
        "<title>slipfront: slip fronts at a frictional interface</title>",
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<style>{STYLE}</style></head><body>",
        "<h1>Slip fronts at a frictional interface</h1>",
        "<p>Reproduction of Kammer, Yastrebov, Spijker, Molinari, <i>On the propagation of slip fronts at "
        f"frictional interfaces</i>, Tribology Letters 48, 27–32 (2012). Runs by {origin(results)}.</p>",
        *(f'<p class="mark">{escape(line)}</p>' for line in results.remarks),
        navigation(results),
        '<h2 id="figures">Figures</h2>',
        *(figure_with_files(drawing, results, folder) for drawing in drawings),
        '<h2 id="scorecard">Scorecard</h2>',
        f"<p>{scorecard_summary(results.scorecard)}</p>",
        scorecard_table(results.scorecard),
        '<h2 id="fit">Fit of the energy criterion</h2>',
        "<p>V<sub>tip</sub>/c<sub>L</sub> = a + b exp(−c √r), r = (U<sub>r</sub> − "
        "U<sub>s</sub>)/U<sub>s</sub></p>",
        fit_table(results),
        spread_table(results),
        *study_section(results),
        '<h2 id="fronts">Fronts</h2>',
        "<p>All fronts found, short ones included; direction +1 is that of the imposed shear.</p>",
        front_table(results),
        *timing_section(results),
        "</body></html>",
    ]
    file = folder / "index.html"
    file.write_text("\n".join(part for part in parts if part) + "\n", encoding="utf-8")
    return file
