# SPDX-License-Identifier: BSD-3-Clause
"""Which statements of the paper depend on what it leaves open."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from slipfront.figures.drawing import Drawing
from slipfront.figures.style import PAGE_MM, Look, new_figure
from slipfront.files import DataError, Table, read_json_table, read_table
from slipfront.folder import result_file

TABLE = "open_choices.csv"
SUMMARY = "open_choices.json"
#: Shares of samples for which a claim holds, and their headings.
SHARES = {
    "share_of_triggers": "% of left triggers",
    "share_of_triggers_with_fronts": "% of those with fronts",
    "share_of_all": "% of all choices",
}
HIGHEST_RATIO = 2.5  # the axis ends there at the latest
LARGEST_RATIO = 0.6  # of the left-triggered maximum to the smaller of the others, which C11 asks for
HOLDS, FAILS, TURNS_ON, TURNS_OFF = "#c7d9ec", "#f0c9b0", "#0072b2", "#b5420f"
NOT_VARIED: Look = {"facecolor": "white", "edgecolor": "0.75", "hatch": "/////", "linewidth": 0}
LINE_LENGTH, MOST_LINES = 5, 3  # of a cell's text
TYPE_PT = 6.5  # of all that is not set in the figures' own size
LINE_MM, CELL_MARGIN_MM = 2.5, 1.2  # of such type, and above and below a cell's lines together
SAMPLES_MM, REST_MM = 62.0, 78.0  # the samples; headings, legends and labels
#: Marker, colour and name of the sets of samples, those with the fewest on top.
SETS = {
    "all": ("x", "0.6", "all choices, space-filling"),
    "left trigger": (".", "#d55e00", "left triggers, space-filling"),
    "right trigger": ("1", "#e69f00", "right triggers, space-filling"),
    "about the chosen": ("^", "#44aa99", "one choice at a time about the chosen"),
    "known": ("v", "#882255", "left triggers compared in the page"),
    "finer": ("+", "#117733", "the chosen, elements of 0.5 and 0.333 mm"),
}
HOLDING: Look = {
    "marker": "o",
    "color": "#0072b2",
    "markersize": 3.5,
    "markerfacecolor": "none",
    "markeredgewidth": 0.8,
    "label": "all constraining claims but C25 hold",
}
REGION: Look = {"marker": "o", "color": "#0072b2", "markersize": 3.5, "label": "C25 holds, too: the region"}
DURATION_TICKS = {0.5: "0.5", 1: "1", 2: "2", 5: "5", 15: "15", 30: "held"}  # us
HELD_US = 30.0  # where held triggers are drawn
STANDARD: Look = {"marker": "*", "color": "black", "markersize": 7.0, "label": "this program's default"}
CHOSEN: Look = {
    "marker": "D",
    "color": "black",
    "markersize": 6.0,
    "markerfacecolor": "none",
    "markeredgewidth": 1.0,
}


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
        return f"{choice[:-2]} (µs)".replace("_", " ")
    return choice.replace("_", " ")


def varied_choices(table: Table, summary: dict[str, Any]) -> set[str]:
    """The choices that some sample changes by themselves, about the chosen one."""
    if not summary["chosen"]:
        return set()
    centre = chosen_row(table, summary["chosen"])
    rows = [row for row, name in enumerate(table.texts("set")) if name == "about the chosen"]
    columns = {name: table.texts(name) for name in table.header}
    return {name for name, texts in columns.items() if any(texts[row] != texts[centre] for row in rows)}


def cell_look(holds: bool, turns: bool) -> dict[str, Any]:
    colour = (TURNS_OFF if holds else TURNS_ON) if turns else (HOLDS if holds else FAILS)
    return {"facecolor": colour, "edgecolor": "white", "linewidth": 0.5}


def texts_of(row: dict[str, Any], summary: dict[str, Any]) -> list[str]:
    """A claim's cells, by choice: the levels at which its verdict turns."""
    turns = row["turns"]
    names = [choice["name"] for choice in summary["choices"]]
    return [cell_text([label(level, name) for level in turned_levels(turns, name)]) for name in names]


def row_edges_mm(summary: dict[str, Any]) -> np.ndarray:
    """Rows of the matrix as high as their cells with the most lines. [rows + 1]"""
    n_lines = [max(text.count("\n") + 1 for text in texts_of(row, summary)) for row in summary["matrix"]]
    return np.concatenate([[0.0], np.cumsum(LINE_MM * np.array(n_lines) + CELL_MARGIN_MM)])


def draw_matrix(ax: Axes, summary: dict[str, Any], varied: set[str]) -> None:
    choices, rows, edges = summary["choices"], summary["matrix"], row_edges_mm(summary)
    n_choices, middles = len(choices), (edges[1:] + edges[:-1]) / 2
    shares_x = n_choices + 0.55 + 0.8 * np.arange(len(SHARES))
    small: Look = {"fontsize": TYPE_PT, "ha": "center", "va": "center"}
    for y, row in enumerate(rows):
        for x, (choice, text) in enumerate(zip(choices, texts_of(row, summary), strict=True)):
            name = choice["name"]
            look = cell_look(row["holds"], bool(text)) if name in varied else NOT_VARIED
            ax.add_patch(
                Rectangle((x, edges[y]), 1, edges[y + 1] - edges[y], gid=f"{row['id']}:{name}", **look)
            )
            ax.text(x + 0.5, middles[y], text, color="white", linespacing=0.95, **small)
        for x, key in zip(shares_x, SHARES, strict=True):
            share = row[key]
            ax.text(x, middles[y], "" if share is None else f"{100 * share:.0f}", **small)
    ax.set_xlim(0, shares_x[-1] + 0.4)
    ax.set_ylim(edges[-1], 0)
    ax.set_yticks(middles, labels=[row["id"] for row in rows], fontsize=TYPE_PT)
    headings = [title(c["name"]) for c in choices] + list(SHARES.values())
    places = [*np.arange(n_choices) + 0.5, *shares_x]
    ax.set_xticks(places, labels=headings, rotation=65, ha="left", fontsize=TYPE_PT)
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
    ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.005), ncols=5, fontsize=TYPE_PT,
              columnspacing=1.0, handlelength=1.8)  # fmt: skip


def trigger(values: dict[str, Any], edge: str) -> str:
    """How an edge is triggered, such as "left added 10 over 15 mm for 5 µs"."""
    form = values[f"{edge}_form"]
    place = f"over {1e3 * values[f'{edge}_zone_m']:.3g} mm"
    if f"{edge}_{form}" not in values:
        return f"{edge} {form} {place}"
    is_held = values[f"{edge}_end"] == "held"
    end = "held" if is_held else f"for {1e6 * values[f'{edge}_duration_s']:.3g} µs"
    return f"{edge} {form} {values[f'{edge}_{form}']:.3g} {place} {end}"


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


def kept(table: Table) -> tuple[np.ndarray, np.ndarray]:
    """Rows whose constraining claims but C25 hold, and those for which C25 holds as well."""
    hold, region = (np.array(table.texts(f"constraints{name}")) == "hold" for name in ("_but_C25", ""))
    return hold, region


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

    hold, region = kept(table)
    sets = np.array(table.texts("set"))
    for name, (marker, colour, words) in SETS.items():
        draw_rows((sets == name) & ~hold, name, marker=marker, color=colour, markersize=2.5, label=words)
    draw_rows(hold & ~region, "hold", **HOLDING)
    draw_rows(region, "region", **REGION)
    draw_rows([0], "standard", **STANDARD)
    if chosen := summary["chosen"]:
        words = ",\n".join(trigger(chosen["values"], edge) for edge in ("left", "right"))
        draw_rows([chosen_row(table, chosen)], "chosen", **CHOSEN, label=f"chosen: {words}")
    wanted = 100 * summary["wanted_share_in_band"]
    limit: Look = {"color": "0.3", "linewidth": 0.6}
    ax.axvline(LARGEST_RATIO, **limit)
    ax.axhline(wanted, **limit)
    words = f"limits: {LARGEST_RATIO:g} of C11; {wanted:.0f} % of C18b, not used"
    handles.insert(0, Line2D([], [], label=words, **limit))
    largest = np.max(ratio[np.isfinite(ratio)], initial=0.0)
    beyond = int(np.sum(ratio > HIGHEST_RATIO))
    if beyond:
        ax.annotate(
            f"{beyond} beyond the axis →", (0.995, 0.02), xycoords="axes fraction", ha="right", color="0.3"
        )
    ax.set(xlabel="maximum of the left-triggered front over the smaller of the others",
           ylabel="points of the main fronts within the paper's band (%)",
           xlim=(-0.02, np.clip(1.02 * largest, 1.4, HIGHEST_RATIO)), ylim=(0, 100))  # fmt: skip
    return handles[::-1]


def draw_left_triggers(ax: Axes, table: Table, summary: dict[str, Any]) -> None:
    """Zone times amount over the duration, of the left triggers that add a traction."""
    hold, region = kept(table)
    is_added = np.array(table.texts("left_form")) == "added"
    shown = is_added & np.isin(np.array(table.texts("set")), ("left trigger", "known"))
    impulse = 1e3 * table.numbers("left_zone_m") * table.numbers("left_added")
    is_held = np.array(table.texts("left_end")) == "held"
    duration = np.where(is_held, HELD_US, 1e6 * table.numbers("left_duration_s"))
    looks: list[tuple[str, np.ndarray, Look]] = [
        ("fail", ~hold, {"marker": ".", "color": "0.6", "markersize": 2.5}),
        ("hold", hold & ~region, HOLDING),
        ("region", region, REGION),
    ]
    for name, rows, look in looks:
        ax.plot(duration[shown & rows], impulse[shown & rows], linestyle="none", gid=f"left:{name}", **look)
    if chosen := summary["chosen"]:
        row = chosen_row(table, chosen)
        ax.plot(duration[row], impulse[row], linestyle="none", gid="left:chosen", **CHOSEN)
    ax.set(xlabel="duration of the left trigger (µs)", ylabel="its zone times the amount that it adds (mm)",
           xscale="log", yscale="log")  # fmt: skip
    ax.set_xticks(list(DURATION_TICKS), labels=list(DURATION_TICKS.values()))
    ax.minorticks_off()


def draw(folder: Path) -> Drawing:
    """Matrix of claims and choices above; below, all samples, and those of the left trigger."""
    summary = read_json_table(result_file(folder / SUMMARY))
    table = read_table(result_file(folder / TABLE))
    matrix_mm = row_edges_mm(summary)[-1]
    figure = new_figure(PAGE_MM, matrix_mm + SAMPLES_MM + REST_MM)
    grid = figure.add_gridspec(2, 2, height_ratios=(matrix_mm, SAMPLES_MM), width_ratios=(3, 2))
    draw_matrix(figure.add_subplot(grid[0, :]), summary, varied_choices(table, summary))
    handles = draw_samples(figure.add_subplot(grid[1, 0]), table, summary)
    draw_left_triggers(figure.add_subplot(grid[1, 1]), table, summary)
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=TYPE_PT)
    return Drawing("open_choices", figure, "")
