# SPDX-License-Identifier: BSD-3-Clause
"""A sweep as a page of HTML: maps to choose and to point at, facts of each point, failures."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slipfront.report.page import Page, embedded, words
from slipfront.sweep.maps import axis_of, waves_of
from slipfront.sweep.outcome import QUANTITIES
from slipfront.sweep.tables import TEXTS, is_sweep, keys_of, read_dataset
from slipfront.sweep.work import DONE

if TYPE_CHECKING:
    import xarray as xr

FIRST = "longest_front_v_tip_median_over_c_L"
is_kind = is_sweep  # of the folders of `slipfront report`
COMBINED = {"grid": "all combinations", "zip": "values that go together", "sample": "a Latin hypercube"}

CHOICES = """\
<p class="choices">
<label>Result <select id="sweep-quantity"></select></label>
<label>across <select id="sweep-x"></select></label>
<label>up <select id="sweep-y"></select></label>
<span id="sweep-fixed"></span>
</p>
<div id="sweep-plot" class="plot" role="img" aria-label="Map of a result over two keys of the case"></div>
<div id="sweep-point" aria-live="polite"><p>Click on a point of the map for what is known of it.</p></div>"""


def shown(value: Any) -> Any:
    """A number, text, or null for what JSON does not have."""
    if isinstance(value, str):
        return value
    return float(value) if np.isfinite(value) else None


def sweep_data(data: xr.Dataset) -> dict[str, Any]:
    """All that the maps are drawn from, as JSON has it."""
    keys = keys_of(data)
    points = [
        {
            "index": k,
            "values": {key: shown(row[name]) for name, key in keys.items()},
            "cells": {q.name: shown(row[q.name]) for q in QUANTITIES},
            **{name: row[name] for name in TEXTS},
        }
        for k, row in enumerate(data.to_dataframe().reset_index().to_dict("records"))
    ]
    return {
        "is_grid": "point" not in data.dims,
        "keys": [
            {"name": key, "axis": [shown(v) for v in axis_of(data[name])]} for name, key in keys.items()
        ],
        "quantities": [
            {
                "name": q.name,
                "long_name": q.long_name,
                "unit": q.unit,
                "words": list(q.words),
                "waves": [{"name": name, "level": level} for name, level in waves_of(data, q.name).items()],
            }
            for q in QUANTITIES
        ],
        "first": FIRST,
        "points": points,
    }


def summary(data: xr.Dataset) -> str:
    n_failed = int((data.status != DONE).sum())
    failed = f", {n_failed} without results" if n_failed else ""
    told = f"{data.attrs['title']}, {COMBINED[data.attrs['combine']]}: {data.status.size} runs{failed}"
    return f"<p>{words(told)}. Definitions: docs/theory.md.</p>"


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


def sweep_section(data: xr.Dataset) -> str:
    """A piece of HTML that draws itself."""
    from plotly.offline import get_plotlyjs

    own = (resources.files("slipfront.sweep") / "page" / "sweep.js").read_text(encoding="utf-8")
    return "\n".join(
        [
            '<section id="sweep"><h2>Sweep</h2>',
            summary(data),
            CHOICES,
            failures(data),
            f'<script type="application/json" id="sweep-data">{embedded(sweep_data(data))}</script>',
            f"<script>{get_plotlyjs()}</script>",
            f"<script>(() => {{\n'use strict';\n{own}\n}})();</script>",
            "</section>",
        ]
    )


def page(folder: Path) -> Page:
    """The page of `slipfront report DIR`."""
    data = read_dataset(folder)
    return Page(title=data.attrs["title"], parts=[sweep_section(data)])
