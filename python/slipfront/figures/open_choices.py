# SPDX-License-Identifier: BSD-3-Clause
"""Which statements of the paper depend on what it leaves open.

usage: python -m slipfront.figures.open_choices PICTURE DIR, output folder of `slipfront study open-choices`"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from slipfront import command
from slipfront.figures.drawing import Drawing, guarded
from slipfront.figures.style import PAGE_MM, RC, new_figure
from slipfront.files import read_json_table, read_table
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


def turned_levels(row: dict[str, Any], choice: str) -> list[Any]:
    """The levels of a choice at which a claim's verdict is another one."""
    return [turn["level"] for turn in row["turns"] if turn["choice"] == choice]


def label(level: Any, key: str) -> str:
    """A level for a narrow cell: lengths in mm, times in us."""
    if isinstance(level, str):
        return level.replace("predictor_corrector", "p.-c.").replace("fillet ", "R ").replace("weakened", "weak")
    if key.endswith("_m"):
        return f"{1e3 * level:.3g}"
    if key.endswith("_s"):
        return f"{1e6 * level:.3g}"
    return f"{level:.3g}"


def title(choice: str) -> str:
    """A column's heading with the unit of its levels."""
    if choice.endswith("_m"):
        return f"{choice[:-2]} (mm)".replace("_", " ")
    if choice.endswith("_s"):
        return f"{choice[:-2]} (us)".replace("_", " ")
    return choice.replace("_", " ")


def draw_matrix(ax: Axes, summary: dict[str, Any]) -> None:
    choices, rows = summary["choices"], summary["matrix"]
    n_choices = len(choices)
    for y, row in enumerate(rows):
        for x, choice in enumerate(choices):
            levels = turned_levels(row, choice["name"])
            colour = HOLDS if row["holds"] else FAILS
            if levels:
                colour = TURNS_OFF if row["holds"] else TURNS_ON
            ax.add_patch(
                matplotlib.patches.Rectangle((x, y), 1, 1, facecolor=colour, edgecolor="white", linewidth=0.5)
            )
            texts = [label(level, choice["name"]) for level in levels]
            if len(texts) > 3:
                texts = [*texts[:2], "..."]
            ax.text(x + 0.5, y + 0.5, "\n".join(texts), color="white", fontsize=4.5, ha="center", va="center",
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
    ax.legend(
        handles=[
            Patch(facecolor=HOLDS, label="holds at all levels"),
            Patch(facecolor=FAILS, label="holds at none"),
            Patch(facecolor=TURNS_OFF, label="holds, but not at these levels"),
            Patch(facecolor=TURNS_ON, label="holds at these levels only"),
        ],
        loc="upper center",
        bbox_to_anchor=(0.5, -0.005),
        ncols=4,
        fontsize=6,
    )


def draw_samples(ax: Axes, folder: Path, summary: dict[str, Any]) -> None:
    """The left-triggered maximum over the smaller of the other two against the share within the band."""
    table = read_table(result_file(folder / TABLE))
    left = table.numbers("left_max_over_c_L")
    others = np.minimum(table.numbers("spontaneous_max_over_c_L"), table.numbers("right_max_over_c_L"))
    share = 100 * table.numbers("share_in_band")
    hold = np.array(table.texts("constraints")) == "hold"
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(others > 0, left / others, np.nan)
    sets = np.array(table.texts("set"))
    for name, marker, colour in (("all", "x", "0.6"), ("triggers", ".", "#d55e00"), ("pairs", "+", "#117733")):
        where = (sets == name) & ~hold
        ax.plot(ratio[where], share[where], marker, color=colour, markersize=2.5, linestyle="none")
    ax.plot(ratio[hold], share[hold], "o", color="#0072b2", markersize=3, linestyle="none")
    ax.plot(ratio[0], share[0], "*", color="black", markersize=7, linestyle="none")
    ax.axvline(0.6, color="0.3", linewidth=0.6)
    ax.axhline(100 * summary["wanted_share_in_band"], color="0.3", linewidth=0.6)
    ax.set(xlabel="maximum of the left-triggered front over the smaller of the others",
           ylabel="points of the main fronts within the paper's band (%)", xlim=(0, 1.4), ylim=(0, 100))  # fmt: skip
    marks = [
        ("*", "black", "standard choices"),
        ("o", "#0072b2", "all constraints hold"),
        ("+", "#117733", "pairs"),
        (".", "#d55e00", "triggers, space-filling"),
        ("x", "0.6", "all choices, space-filling"),
    ]
    ax.legend(
        handles=[Line2D([], [], marker=m, color=c, linestyle="none", label=text) for m, c, text in marks],
        loc="center right",
    )


def draw(folder: Path) -> Figure:
    """Matrix of claims and choices above, all samples below."""
    summary = read_json_table(result_file(folder / SUMMARY))
    figure = new_figure(PAGE_MM, 215)
    grid = figure.add_gridspec(2, 1, height_ratios=(2.1, 1))
    draw_matrix(figure.add_subplot(grid[0]), summary)
    draw_samples(figure.add_subplot(grid[1]), folder, summary)
    return figure


def write(picture: Path, folder: Path) -> list[str]:
    """Writes the picture; returns what to print."""
    with matplotlib.rc_context(RC):
        drawing = guarded(folder, lambda: Drawing(picture.stem, draw(folder), ""))
        kind = picture.suffix.removeprefix(".") or "png"
        image = guarded(picture, lambda: drawing.rendered(kind, Software=None))
    with command.publishing_into(picture.parent) as target:
        (target / picture.name).write_bytes(image)
    return [f"figure: {picture}"]


def main(picture: Path, folder: Path) -> int:
    return command.run("slipfront.figures", lambda: write(picture, folder))


def parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m slipfront.figures.open_choices",
        description="Draws which statements of the paper depend on what it leaves open.",
    )
    parser.add_argument("picture", metavar="PICTURE", type=Path, help="the file to write, a PNG")
    parser.add_argument(
        "folder", metavar="DIR", type=Path, help="output folder of `slipfront study open-choices`"
    )
    return parser.parse_args()


if __name__ == "__main__":
    options = parsed()
    sys.exit(main(options.picture, options.folder))
