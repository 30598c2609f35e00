# SPDX-License-Identifier: BSD-3-Clause
"""A sweep as a page of HTML: maps to choose and to point at, facts of each point, failures."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from slipfront.files import exists
from slipfront.report.page import Page, embedded, words
from slipfront.report.tables import table
from slipfront.sweep.engine import DONE
from slipfront.sweep.maps import SHOWN, axis_of, waves_of
from slipfront.sweep.outcome import QUANTITIES, Quantity
from slipfront.sweep.tables import (
    PRINTED,
    TEXTS,
    axes_of,
    cells_of,
    constant,
    is_sweep,
    keys_of,
    read_dataset,
    shown_in,
)

if TYPE_CHECKING:
    import xarray as xr

FIRST = "longest_front_v_tip_median_over_c_L"
is_kind = is_sweep  # of the folders of `slipfront report`
COMBINED = {"grid": "all combinations", "zip": "values that go together", "sample": "a Latin hypercube"}

MOST_ROWS = 1000  # of the table of points

CHOICES = """\
<p class="choices">
<label>Result <select id="sweep-quantity"></select></label>
<label>across <select id="sweep-x"></select></label>
<label>up <select id="sweep-y"></select></label>
<span id="sweep-fixed"></span>
</p>
<div id="sweep-plot" class="plot" role="img" aria-label="A result over keys of the case"></div>
<div id="sweep-point" aria-live="polite"><p>Click on a point for what is known of it.</p></div>"""


def shown(value: Any) -> Any:
    """A number, text, or null for what JSON does not have."""
    if isinstance(value, str):
        return value
    return float(value) if np.isfinite(value) else None


def report_of(folder: Path, place: str, page: Path) -> str | None:
    """The address of a point's own report from the page; None where there is none."""
    file = folder / place / "report.html"
    if not exists(file):
        return None
    return quote(os.path.relpath(file.resolve(), page.parent.resolve()).replace(os.sep, "/"))


def results_of(data: xr.Dataset) -> list[Quantity]:
    """Those that the table has: of runs, of sequences, or of an earlier version."""
    return [q for q in QUANTITIES if q.name in data]


def sweep_data(data: xr.Dataset, folder: Path, page: Path) -> dict[str, Any]:
    """All that the maps are drawn from, as JSON has it; `page` is where it will lie. A result that is the
    same at all points has no map."""
    keys, axes = keys_of(data), axes_of(data)
    results = results_of(data)
    data = data.transpose(*data.sizes)  # in the order of the rows
    cells = {q.name: cells_of(data[q.name]) for q in results}
    rows = data.to_dataframe().reset_index().to_dict("records")
    points = [
        {
            "index": k,
            "values": {key: shown(row[name]) for name, key in keys.items()},
            "cells": {q.name: shown(row[q.name]) for q in results},
            "texts": {q.name: cells[q.name][k] for q in results},
            "report": report_of(folder, row["folder"], page),
            **{name: row[name] for name in TEXTS},
        }
        for k, row in enumerate(rows)
    ]
    return {
        "is_grid": "point" not in data.dims,
        "keys": [
            {
                "name": key,
                "label": axes[name].label,
                "factor": axes[name].factor,
                "axis": [shown(v) for v in axis_of(data[name])],
            }
            for name, key in keys.items()
        ],
        "quantities": [
            {
                "name": q.name,
                "long_name": q.long_name,
                "unit": shown_in(data[q.name]).name,
                "factor": shown_in(data[q.name]).factor,
                "words": list(q.words),
                "constant": constant(data[q.name]),
                "waves": [{"name": name, "level": level} for name, level in waves_of(data, q.name).items()],
            }
            for q in results
        ],
        "first": FIRST,
        "points": points,
    }


def summary(data: xr.Dataset) -> str:
    n_failed = int((data.status != DONE).sum())
    failed = f", {n_failed} without results" if n_failed else ""
    told = f"{data.attrs['title']}, {COMBINED[data.attrs['combine']]}: {data.status.size} runs{failed}"
    return f"<p>{words(told)}. Definitions: docs/theory.md.</p>"


def same_everywhere(told: dict[str, Any]) -> str:
    """Results that do not differ, in words."""
    parts = [f"{q['long_name']}: {q['constant']}" for q in told["quantities"] if q["constant"] is not None]
    return f"<p>The same at all points: {words('; '.join(parts))}.</p>" if parts else ""


def failures(data: xr.Dataset) -> str:
    """Points without results, and why."""
    texts = (data[name].to_numpy().ravel() for name in ("folder", "message", "status"))
    cells = [
        f"<tr><td>{words(f)}</td><td>{words(m)}</td></tr>"
        for f, m, s in zip(*texts, strict=True)
        if s != DONE
    ]
    head = "<tr><th>Point</th><th>Why</th></tr>"
    return f"<h3>Points without results</h3><table>{head}{''.join(cells)}</table>" if cells else ""


def with_unit(quantity: dict[str, Any]) -> str:
    return (
        f"{quantity['long_name']} ({quantity['unit']})" if quantity["unit"] != "1" else quantity["long_name"]
    )


def table_of_points(told: dict[str, Any]) -> str:
    """A row per point: its report, its values of the keys, and what differs of the main results."""
    results = [q for q in told["quantities"] if q["name"] in {*PRINTED, *SHOWN} and q["constant"] is None]
    head = ["Point", *(key["label"] for key in told["keys"]), "status", *map(with_unit, results)]
    rows = []
    for point in told["points"][:MOST_ROWS]:
        place, address = words(point["folder"]), point["report"]
        link = f'<a href="{words(address)}">{place}</a>' if address else place
        values = [
            value if isinstance(value, str) else f"{value * key['factor']:.6g}"
            for key in told["keys"]
            for value in [point["values"][key["name"]]]
        ]
        rows.append(
            [link, *map(words, [*values, point["status"], *(point["texts"][q["name"]] for q in results)])]
        )
    n = len(told["points"])
    more = f"<p>The first {MOST_ROWS} of {n} points; all are in sweep.csv.</p>" if n > MOST_ROWS else ""
    how = (
        "<p>A link leads to the report of a run; where there is none, <code>slipfront report</code> with the "
        "point's folder makes it.</p>"
    )
    return f"<h3>Points</h3>{how}{table(list(map(words, head)), rows)}{more}"


def sweep_section(data: xr.Dataset, folder: Path, page: Path) -> str:
    """A piece of HTML that draws itself."""
    from plotly.offline import get_plotlyjs

    own = (resources.files("slipfront.sweep") / "page" / "sweep.js").read_text(encoding="utf-8")
    told = sweep_data(data, folder, page)
    head = ['<section id="sweep"><h2>Sweep</h2>', summary(data)]
    rest = [same_everywhere(told), failures(data), table_of_points(told)]
    if all(q["constant"] is not None for q in told["quantities"]):
        return "\n".join([*head, *rest, "</section>"])
    return "\n".join(
        [
            *head,
            CHOICES,
            *rest,
            f'<script type="application/json" id="sweep-data">{embedded(told)}</script>',
            f"<script>{get_plotlyjs()}</script>",
            f"<script>(() => {{\n'use strict';\n{own}\n}})();</script>",
            "</section>",
        ]
    )


def page(folder: Path, file: Path) -> Page:
    """The page of `slipfront report DIR`."""
    data = read_dataset(folder)
    return Page(title=data.attrs["title"], parts=[sweep_section(data, folder, file)])
