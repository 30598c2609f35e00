# SPDX-License-Identifier: BSD-3-Clause
"""A page as one file of HTML. Nothing in it is fetched from elsewhere when it is looked at."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

from plotly.offline import get_plotlyjs

from slipfront import command
from slipfront.files import one_line

#: The beginning of every page, by which a page of ours is known.
MARK = "<!DOCTYPE html><!-- slipfront report -->"
#: In the order in which they use each other.
SCRIPTS = (
    "data.js", "space_time.js", "profiles.js", "criteria.js", "fracture.js", "energy.js", "snapshots.js",
    "probes.js", "sequence.js", "page.js",
)  # fmt: skip
#: The browser itself refuses whatever would come from a network.
POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
PLOTLY_MB = 4.8


@dataclass(frozen=True)
class Page:
    """Title as plain text; parts are pieces of HTML; data is what the plots in them are drawn from."""

    title: str
    parts: list[str]
    data: dict[str, Any] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)  # to print beside the file's name
    mark: str = MARK

    @property
    def has_plots(self) -> bool:
        return bool(self.data)


def words(text: Any) -> str:
    """Text of a case or a folder's name as a piece of HTML."""
    return escape(one_line(str(text)))


def section(place: str, heading: str, *parts: str) -> str:
    return f'<section id="{place}"><h2>{heading}</h2>\n' + "\n".join(parts) + "\n</section>"


def warnings_list(lines: list[str], kind: str = "warning") -> str:
    """Lines of plain text, such as what a run warns of; nothing where there is none."""
    return "".join(f'<p class="{kind}">{words(line)}</p>' for line in lines)


def facts_table(rows: list[tuple[str, str]]) -> str:
    """Names and values, both pieces of HTML."""
    body = "\n".join(f'<tr><th scope="row">{name}</th><td>{value}</td></tr>' for name, value in rows)
    return f'<table class="facts">\n{body}\n</table>'


def plot(name: str, what: str) -> str:
    """Where the script draws; `what` is read out in place of the picture."""
    return f'<div class="plot" id="{name}" role="img" aria-label="{what}"></div>'


def own_file(name: str) -> str:
    return (resources.files("slipfront.report") / "page" / name).read_text(encoding="utf-8")


def embedded(data: dict[str, Any]) -> str:
    """JSON inside a script, which no text in it can end."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def scripts(page: Page) -> list[str]:
    if not page.has_plots:
        return []
    own = "\n".join(own_file(name) for name in SCRIPTS)
    return [
        f'<script type="application/json" id="data">{embedded(page.data)}</script>',
        f"<script>{get_plotlyjs()}</script>",
        f"<script>(() => {{\n'use strict';\n{own}\n}})();</script>",
    ]


def closing(n_bytes: float, page: Page) -> str:
    plotly = f", {PLOTLY_MB} MB of it the library Plotly, which draws it" if page.has_plots else ""
    size = f"{n_bytes / 1e6 + (PLOTLY_MB if page.has_plots else 0):.1f}"
    return f"<footer>This page is one file of {size} MB{plotly}. It uses no network.</footer>"


def rendered(page: Page) -> str:
    title = words(page.title)
    body = "\n".join(part for part in page.parts if part)
    data = embedded(page.data) if page.has_plots else ""
    lines = [
        page.mark,
        '<html lang="en"><head><meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{title}</title>",
        f"<style>{own_file('page.css')}</style></head><body>",
        f"<h1>{title}</h1>",
        body,
        closing(len((body + data).encode()), page),
        *scripts(page),
        "</body></html>",
    ]
    return "\n".join(lines) + "\n"


def require_replaceable(file: Path, mark: str = MARK, what: str = "a report") -> None:
    """Refuses a path where anything but a page with our mark is."""
    command.require_own(file, mark.encode(), what)


def write_page(page: Page, file: Path) -> list[str]:
    """Writes it whole or not at all, in place of one with its mark; returns what to print."""
    require_replaceable(file, page.mark)
    text = rendered(page).encode()
    with command.publishing_into(file.parent) as made:
        (made / file.name).write_bytes(text)
    return [f"report: {file} ({len(text) / 1e6:.1f} MB)", *(f"note: {note}" for note in page.notes)]
