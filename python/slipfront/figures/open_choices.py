# SPDX-License-Identifier: BSD-3-Clause
"""Which statements of the paper depend on what it leaves open.

usage: python -m slipfront.figures.open_choices PICTURE DIR
DIR: output folder of `slipfront study open-choices`"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from slipfront.figures.drawing import Drawing
from slipfront.figures.picture import command_to_draw, write_results
from slipfront.figures.style import PAGE_MM, Look, new_figure
from slipfront.files import DataError, Table, read_json_table, read_table
from slipfront.folder import result_file

TABLE = "open_choices.csv"
SUMMARY = "open_choices.json"
#: Shares of samples for which a claim holds, and their headings.
SHARES = {
    "share_of_triggers": "% of triggers",
    "share_of_triggers_with_fronts": "% of those with fronts",
    "share_of_all": "% of all choices",
}
HOLDS, FAILS, TURNS_ON, TURNS_OFF = "#c7d9ec", "#f0c9b0", "#0072b2", "#b5420f"
NOT_VARIED: Look = {"facecolor": "white", "edgecolor": "0.75", "hatch": "/////", "linewidth": 0}
LINE_LENGTH, MOST_LINES = 6, 3  # of a cell's text
#: Marker, colour and name of the sets of samples, those with the fewest on top.
SETS = {
    "all": ("x", "0.6", "all choices, space-filling"),
    "triggers": (".", "#d55e00", "triggers, space-filling"),
    "pairs": ("+", "#117733", "pairs"),
    "one at a time": ("v", "#882255", "one choice at a time"),
    "about the chosen": ("^", "#44aa99", "one at a time about the chosen"),
}
HOLDING: Look = {"marker": "o", "color": "#0072b2", "markersize": 3.0, "label": "all constraints hold"}
STANDARD: Look = {"marker": "*", "color": "black", "markersize": 7.0, "label": "the study's standard"}
CHOSEN: Look = {
    "marker": "D",
    "color": "black",
    "markersize": 6.0,
    "markerfacecolor": "none",
    "markeredgewidth": 1.0,
}


def about(row: dict[str, Any], summary: dict[str, Any]) -> dict[str, Any]:
    """Verdict and turns of a claim about the chosen sample; about the standard where none was chosen."""
    found: dict[str, Any] = row["about_chosen"] if summary["chosen"] else row
    return found


def turned_levels(turns: list[dict[str, Any]], choice: str) -> list[Any]:
    """The levels of a choice at which a claim's verdict is another one."""
    return [turn["level"] for turn in turns if turn["choice"] == choice]


def label(level: Any, key: str) -> str:
    """A level for a narrow cell: lengths in mm, times in us."""
    if isinstance(level, str):
        short = (
            level.replace("predictor_corrector", "p.-c.")
            .replace("weakened", "weak")
            .replace("approach", "appr.")
        )
        return short.replace("fillet ", "R").removesuffix(" mm")
    if key.endswith("_m"):
        return f"{1e3 * level:.3g}"
    if key.endswith("_s"):
        return f"{1e6 * level:.3g}"
    return f"{level:.3g}"


def cell_text(labels: list[str]) -> str:
    """Labels in short lines; what does not fit the cell becomes dots."""
    lines: list[str] = []
    for text in labels:
        if lines and len(lines[-1]) + 1 + len(text) <= LINE_LENGTH:
            lines[-1] += " " + text
        else:
            lines.append(text)
    return "\n".join(lines if len(lines) <= MOST_LINES else [*lines[: MOST_LINES - 1], "..."])


def title(choice: str) -> str:
    """A column's heading with the unit of its levels."""
    if choice == "corner":
        return "corner (R in mm)"
    if choice.endswith("_m"):
        return f"{choice[:-2]} (mm)".replace("_", " ")
    if choice.endswith("_s"):
        return f"{choice[:-2]} (us)".replace("_", " ")
    return choice.replace("_", " ")


def varied_choices(table: Table, summary: dict[str, Any]) -> set[str]:
    """The choices that some sample changes by themselves, about the same sample as `about`."""
    chosen = summary["chosen"]
    centre = chosen_row(table, chosen) if chosen else 0
    wanted = "about the chosen" if chosen else "one at a time"
    rows = [row for row, name in enumerate(table.texts("set")) if name == wanted]
    columns = {name: table.texts(name) for name in table.header}
    return {name for name, texts in columns.items() if any(texts[row] != texts[centre] for row in rows)}


def cell_look(holds: bool, turns: bool) -> dict[str, Any]:
    colour = (TURNS_OFF if holds else TURNS_ON) if turns else (HOLDS if holds else FAILS)
    return {"facecolor": colour, "edgecolor": "white", "linewidth": 0.5}


def draw_matrix(ax: Axes, summary: dict[str, Any], varied: set[str]) -> None:
    choices, rows = summary["choices"], summary["matrix"]
    n_choices = len(choices)
    for y, row in enumerate(rows):
        for x, choice in enumerate(choices):
            name = choice["name"]
            levels = turned_levels(about(row, summary)["turns"], name)
            look = cell_look(about(row, summary)["holds"], bool(levels)) if name in varied else NOT_VARIED
            ax.add_patch(Rectangle((x, y), 1, 1, gid=f"{row['id']}:{name}", **look))
            text = cell_text([label(level, name) for level in levels])
            ax.text(x + 0.5, y + 0.5, text, color="white", fontsize=4.5, ha="center", va="center",
                    linespacing=0.85)  # fmt: skip
        for x, key in enumerate(SHARES, start=n_choices):
            share = row[key]
            text = "" if share is None else f"{100 * share:.0f}"
            ax.text(x + 0.6, y + 0.5, text, fontsize=5.5, ha="center", va="center")
    ax.set_xlim(0, n_choices + len(SHARES) + 0.2)
    ax.set_ylim(len(rows), 0)
    ax.set_yticks(np.arange(len(rows)) + 0.5, labels=[row["id"] for row in rows], fontsize=5.5)
    headings = [title(c["name"]) for c in choices] + list(SHARES.values())
    places = [*np.arange(n_choices) + 0.5, *(n_choices + np.arange(len(SHARES)) + 0.6)]
    ax.set_xticks(places, labels=headings, rotation=55, ha="left", fontsize=5.5)
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    ax.spines[:].set_visible(False)
    handles = [
        Patch(facecolor=HOLDS, label="holds at all levels"),
        Patch(facecolor=FAILS, label="holds at none"),
        Patch(facecolor=TURNS_OFF, label="holds, but not at these levels"),
        Patch(facecolor=TURNS_ON, label="holds at these levels only"),
    ]
    if any(choice["name"] not in varied for choice in choices):
        handles.append(Patch(label="not varied by itself", **NOT_VARIED))
    ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.005), ncols=5, fontsize=6,
              columnspacing=1.0)  # fmt: skip


def trigger(values: dict[str, Any], edge: str) -> str:
    """How an edge is triggered, such as "left added 10 over 15 mm"."""
    form = values[f"{edge}_form"]
    amount = f" {values[f'{edge}_{form}']:.3g}" if f"{edge}_{form}" in values else ""
    return f"{edge} {form}{amount} over {1e3 * values[f'{edge}_zone_m']:.3g} mm"


def as_number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def is_same(value: Any, text: str) -> bool:
    """Whether a cell of the table shows the value."""
    return text == value if isinstance(value, str) else as_number(text) == value


def chosen_row(table: Table, chosen: dict[str, Any]) -> int:
    """The table's row of the sample that was chosen."""
    wanted = {"set": chosen["set"], **chosen["values"]}
    columns = {name: table.texts(name) for name in wanted}
    for row in range(len(table.rows)):
        if all(is_same(value, columns[name][row]) for name, value in wanted.items()):
            return row
    raise DataError(f"{table.file}: has no row of the chosen sample of {SUMMARY}")


def draw_samples(ax: Axes, table: Table, summary: dict[str, Any]) -> list[Line2D]:
    """The left-triggered maximum over the smaller of the other two against the share within the band.

    Returns the legend's entries.
    """
    left = table.numbers("left_max_over_c_L")
    others = np.minimum(table.numbers("spontaneous_max_over_c_L"), table.numbers("right_max_over_c_L"))
    share = 100 * table.numbers("share_in_band")
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(others > 0, left / others, np.nan)
    handles = []

    def draw_rows(rows: Any, gid: str, **look: Any) -> None:
        handles.extend(ax.plot(ratio[rows], share[rows], linestyle="none", gid=gid, **look))

    hold = np.array(table.texts("constraints")) == "hold"
    sets = np.array(table.texts("set"))
    for name, (marker, colour, words) in SETS.items():
        draw_rows((sets == name) & ~hold, name, marker=marker, color=colour, markersize=2.5, label=words)
    draw_rows(hold, "hold", **HOLDING)
    draw_rows([0], "standard", **STANDARD)
    if chosen := summary["chosen"]:
        words = ", ".join(trigger(chosen["values"], edge) for edge in ("left", "right"))
        draw_rows([chosen_row(table, chosen)], "chosen", **CHOSEN, label=f"chosen: {words}")
    ax.axvline(0.6, color="0.3", linewidth=0.6)
    ax.axhline(100 * summary["wanted_share_in_band"], color="0.3", linewidth=0.6)
    largest = np.max(ratio[np.isfinite(ratio)], initial=0.0)
    ax.set(xlabel="maximum of the left-triggered front over the smaller of the others",
           ylabel="points of the main fronts within the paper's band (%)",
           xlim=(-0.02, max(1.4, 1.02 * largest)), ylim=(0, 100))  # fmt: skip
    return handles[::-1]


def draw(folder: Path) -> Drawing:
    """Matrix of claims and choices above, all samples below."""
    summary = read_json_table(result_file(folder / SUMMARY))
    table = read_table(result_file(folder / TABLE))
    figure = new_figure(PAGE_MM, 240)
    grid = figure.add_gridspec(2, 1, height_ratios=(2.1, 1))
    draw_matrix(figure.add_subplot(grid[0]), summary, varied_choices(table, summary))
    handles = draw_samples(figure.add_subplot(grid[1]), table, summary)
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=6)
    return Drawing("open_choices", figure, "")


def write(picture: Path, folder: Path) -> list[str]:
    return write_results(picture, folder, draw)


def main(arguments: list[str] | None = None) -> int:
    return command_to_draw(
        "slipfront.figures.open_choices",
        "Draws which statements of the paper depend on what it leaves open.",
        "`slipfront study open-choices`",
        write,
        arguments,
    )


if __name__ == "__main__":
    sys.exit(main())
