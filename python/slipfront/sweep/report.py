# SPDX-License-Identifier: BSD-3-Clause
"""A sweep as part of a page of HTML: maps to choose and to point at, facts of each point, failures."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.report.page import Page, embedded, words
from slipfront.sweep.reading import Results, is_sweep, read_results
from slipfront.sweep.work import DONE

MOST_FAILURES = 100  # that are listed
PREFERRED = "longest_front_v_tip_median_over_c_L"

CHOICES = """\
<p class="choices">
<label>Result <select id="sweep-quantity"></select></label>
<label>across <select id="sweep-x"></select></label>
<label>up <select id="sweep-y"></select></label>
<span id="sweep-fixed"></span>
</p>
<div id="sweep-plot" class="plot" role="img" aria-label="Map of a result over two keys of the case"></div>
<div id="sweep-point" aria-live="polite"><p>Click on a point of the map for what is known of it.</p></div>"""


def is_kind(folder: Path) -> bool:
    return is_sweep(folder)


def shown(value: Any) -> Any:
    """A number, text, or null for what JSON does not have."""
    if isinstance(value, str):
        return value
    number = float(value)
    return number if np.isfinite(number) else None


def first_shown(results: Results) -> str:
    """The result that the page opens on: one that varies, the longest front's speed where that does."""
    by_name = {quantity.name: quantity for quantity in results.quantities}
    names = sorted(by_name, key=lambda name: name != PREFERRED)  # else in the order of the table
    for name in names:
        column = results.column(by_name[name])
        if len(np.unique(column[~np.isnan(column)])) > 1:
            return name
    return names[0]


def sweep_data(results: Results) -> dict[str, Any]:
    """All that the maps are drawn from, as JSON has it."""
    texts = {name: results.table.texts(name) for name in ("folder", "status", "message")}
    cells = {
        q.name: results.table.texts(q.name) if q.words else results.table.numbers(q.name)
        for q in results.quantities
    }
    points = [
        {
            "index": k,
            "values": {key: shown(values[k]) for key, values in results.values.items()},
            "cells": {name: shown(column[k]) for name, column in cells.items()},
            **{name: column[k] for name, column in texts.items()},
        }
        for k in range(len(results.table.rows))
    ]
    return {
        "is_grid": results.is_grid,
        "keys": [{"name": key, "axis": [shown(v) for v in results.axis(key)]} for key in results.keys],
        "quantities": [
            {
                "name": q.name,
                "long_name": q.long_name,
                "unit": q.unit,
                "words": list(q.words),
                "waves": [{"name": name, "level": level} for name, level in results.waves_of(q).items()],
            }
            for q in results.quantities
        ],
        "first": first_shown(results),
        "points": points,
    }


def summary(results: Results) -> str:
    status = results.table.texts("status")
    n_done = status.count(DONE)
    keys = ", ".join(f"<code>{words(key)}</code>" for key in results.keys)
    case = words(Path(results.definition["case"]).name)
    failed = f", {len(status) - n_done} without results" if n_done < len(status) else ""
    how = {"grid": "all combinations", "zip": "values that go together", "sample": "a Latin hypercube"}
    kind = how[results.definition["combine"]]
    return f"<p>{case} over {keys}, {kind}: {n_done} runs{failed}. Definitions: docs/theory.md.</p>"


def failures(results: Results) -> str:
    """Points without results, and why."""
    rows = [
        (folder, message)
        for folder, status, message in zip(
            *(results.table.texts(name) for name in ("folder", "status", "message")), strict=True
        )
        if status != DONE
    ]
    if not rows:
        return ""
    body = "".join(
        f"<tr><td>{words(folder)}</td><td>{words(message)}</td></tr>"
        for folder, message in rows[:MOST_FAILURES]
    )
    more = f"<p>and {len(rows) - MOST_FAILURES} more</p>" if len(rows) > MOST_FAILURES else ""
    return f"<h3>Points without results</h3><table><tr><th>Point</th><th>Why</th></tr>{body}</table>{more}"


def script() -> str:
    own = (resources.files("slipfront.sweep") / "page" / "sweep.js").read_text(encoding="utf-8")
    return f"<script>(() => {{\n'use strict';\n{own}\n}})();</script>"


def sweep_section(folder: Path, with_plotly: bool = True) -> str:
    """A piece of HTML that draws itself. Without its own Plotly the page loads Plotly before this piece."""
    results = read_results(folder)
    parts = [
        '<section id="sweep"><h2>Sweep</h2>',
        summary(results),
        CHOICES,
        failures(results),
        f'<script type="application/json" id="sweep-data">{embedded(sweep_data(results))}</script>',
    ]
    if with_plotly:
        from plotly.offline import get_plotlyjs

        parts.append(f"<script>{get_plotlyjs()}</script>")
    return "\n".join([*parts, script(), "</section>"])


def title_of(folder: Path) -> str:
    results = read_results(folder)
    return f"Sweep of {Path(results.definition['case']).name} over {', '.join(results.keys)}"


def page(folder: Path) -> Page:
    """The page of `slipfront report DIR`."""
    return Page(title=title_of(folder), parts=[sweep_section(folder)])
