# SPDX-License-Identifier: BSD-3-Clause
"""What came out of a sweep as a small table to read in a terminal; sweep.csv has all of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slipfront.files import is_number
from slipfront.sweep.outcome import Cell
from slipfront.sweep.points import short_names
from slipfront.sweep.tables import TABLE, Row
from slipfront.sweep.values import name_text, same, text_of
from slipfront.sweep.work import DONE

MOST_ROWS = 30
WIDTH = 120  # signs of a line
LONGEST = 20  # signs of a cell
GAP = "  "
CUT = "..."
UNDEFINED = "-"

#: Results by the head of their column.
SHOWN = {
    "fronts": "n_fronts",
    "slip": "longest_front_slip",
    "length_m": "longest_front_length_m",
    "V_tip/c_L": "longest_front_v_tip_median_over_c_L",
    "end": "longest_front_end",
    "slipped": "slipped_share",
    "reached": "reached_ends",
}
ABOVE = "of the longest front (V_tip: median)"  # from its first column on, the second one


@dataclass(frozen=True)
class Column:
    head: str
    cells: list[str]  # empty where a point has no results
    is_right: bool  # numbers end below each other

    @property
    def width(self) -> int:
        return max(map(len, (self.head, *self.cells)))

    def at(self, text: str) -> str:
        return text.rjust(self.width) if self.is_right else text.ljust(self.width)


def cut(text: str) -> str:
    """The end of a long text: names of files differ there."""
    return text if len(text) <= LONGEST else CUT + text[len(CUT) - LONGEST :]


def key_column(rows: list[Row], key: str, head: str) -> Column:
    """Values as in the names of points, and with all digits where two would be the same."""
    values = [row.point.values[key] for row in rows]
    is_clear = len({name_text(value) for value in values}) == len({same(value) for value in values})
    texts = [name_text(value) if is_clear else text_of(value) for value in values]
    return Column(cut(head), [cut(text) for text in texts], all(map(is_number, values)))


def result_text(cell: Cell) -> str:
    if isinstance(cell, str):
        return cell
    return UNDEFINED if np.isnan(cell) else f"{cell:.3g}"


def result_column(rows: list[Row], head: str, name: str) -> Column:
    cells = [result_text(row.cells[name]) if row.status == DONE else "" for row in rows]
    is_word = any(isinstance(row.cells.get(name), str) for row in rows)
    return Column(head, cells, not is_word)


def width_of(columns: list[Column]) -> int:
    return sum(column.width for column in columns) + len(GAP) * (len(columns) - 1)


def line_of(columns: list[Column], texts: list[str]) -> str:
    return GAP.join(column.at(text) for column, text in zip(columns, texts, strict=True)).rstrip()


def table_lines(rows: list[Row], folder: Path) -> list[str]:
    """The keys that vary and what is asked first, a line per point; one without results has its status."""
    if not rows:
        return []
    shown = rows[:MOST_ROWS]
    results = [result_column(shown, head, name) for head, name in SHOWN.items()]
    keys = [key_column(shown, key, head) for key, head in short_names(list(rows[0].point.values)).items()]
    n_keys = len(keys)
    while len(keys) > 1 and width_of(keys + results) > WIDTH:
        keys.pop()
    columns = keys + results
    before = width_of([*keys, results[0]]) + len(GAP)
    lines = [" " * before + ABOVE, line_of(columns, [column.head for column in columns])]
    for k, row in enumerate(shown):
        if row.status == DONE:
            lines.append(line_of(columns, [column.cells[k] for column in columns]))
        else:
            lines.append(GAP.join([*(key.at(key.cells[k]) for key in keys), row.status]))
    if len(rows) > MOST_ROWS:
        lines.append(f"... {len(rows) - MOST_ROWS} more in {folder / TABLE}")
    if len(keys) < n_keys:
        lines.append(f"{len(keys)} of {n_keys} keys find room, all are in {folder / TABLE}")
    return lines
