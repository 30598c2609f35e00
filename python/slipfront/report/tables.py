# SPDX-License-Identifier: BSD-3-Clause
"""Values of JSON files and tables of them as pieces of HTML."""

from __future__ import annotations

from html import escape
from typing import Any

from slipfront.files import is_number
from slipfront.units import quantity


def text(value: Any) -> str:
    """A value of a JSON file for the page: floats to 4 digits, null as a dash."""
    if value is None:
        return "–"
    return escape(f"{value:.4g}" if isinstance(value, float) else str(value))


def formatted(value: Any, form: str, factor: float = 1.0) -> str:
    """A number of a JSON file in a given form; null or none as a dash."""
    return f"{factor * value:{form}}" if is_number(value) else "–"


def table(
    header: list[str], rows: list[list[str]], groups: list[tuple[str, int]] | None = None, kind: str = ""
) -> str:
    """Cells are pieces of HTML; one that starts with <td is taken as it is. Groups head several columns."""
    head = "".join(f"<th>{h}</th>" for h in header)
    body = "\n".join(
        "<tr>" + "".join(c if c.startswith("<td") else f"<td>{c}</td>" for c in row) + "</tr>" for row in rows
    )
    above = "".join(f'<th colspan="{n}">{name}</th>' for name, n in groups or [])
    head = (f"<tr>{above}</tr>" if above else "") + f"<tr>{head}</tr>"
    opening = f'<table class="{kind}">' if kind else "<table>"
    return f'<div class="scroll">{opening}\n<thead>{head}</thead>\n<tbody>\n{body}\n</tbody></table></div>'


def front_cells(f: dict[str, Any]) -> list[str]:
    """A front of run.json."""
    return [
        text(f.get("id")),
        {1: "to +x", -1: "to −x"}.get(f.get("direction", 0), "–"),
        *(
            quantity(f[key], unit) if is_number(f.get(key)) else "–"
            for key, unit in (("start_x_m", "m"), ("start_s", "s"), ("end_x_m", "m"), ("end_s", "s"))
        ),
        text(f.get("end")).replace("_", " "),
        text(f.get("mode")),
    ]
