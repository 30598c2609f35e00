# SPDX-License-Identifier: BSD-3-Clause
"""The page of a comparison."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from slipfront.figures.drawing import Drawing
from slipfront.report.page import Page, section, warnings_list, words
from slipfront.report.tables import table

MARK = "<!DOCTYPE html><!-- slipfront compare -->"
MOST_ROWS = 200


@dataclass(frozen=True)
class Part:
    """A record beside a run: what is printed of it, the data set and the picture."""

    heading: str
    run: str  # of a sweep the point that is shown
    lines: list[str]
    notes: list[str]
    found: xr.Dataset
    drawing: Drawing


def cell(value: object) -> str:
    if isinstance(value, float | np.floating):
        return f"{value:.4g}" if np.isfinite(value) else "–"
    return words(value)


def html_of(rows: pd.DataFrame) -> str:
    shown = rows.head(MOST_ROWS)
    more = f"<p>{len(rows) - MOST_ROWS} more rows are left out.</p>" if len(rows) > MOST_ROWS else ""
    cells = [[cell(value) for value in row] for row in shown.itertuples(index=False)]
    return table([words(name) for name in shown.columns], cells) + more


def known_rows(of: xr.Dataset) -> list[str]:
    """Variables over all dimensions: where none is known there is no row."""
    return [str(name) for name in of.data_vars if len(of[name].dims) == len(of.dims)]


def part(of: Part, place: str) -> str:
    image = b64encode(of.drawing.rendered("svg")).decode()
    picture = (
        f'<img src="data:image/svg+xml;base64,{image}" alt="{words(of.heading)}" style="max-width:100%">'
    )
    variables = of.found[[name for name in of.found.data_vars if of.found[name].dims]]
    rows = variables.to_dataframe().dropna(how="all", subset=known_rows(variables)).reset_index()
    shown = f"<p>Shown: {words(of.run)}, the least misfit.</p>" if of.run else ""
    told = "".join(f"<p>{words(line)}.</p>" for line in of.lines)
    return section(place, words(of.heading), shown, told, warnings_list(of.notes), picture, html_of(rows))


def page_of(folder: Path, parts: list[Part], misfits: pd.DataFrame | None) -> Page:
    """misfits: of a sweep, a row per record and point."""
    made = [part(of, f"record{k}") for k, of in enumerate(parts)]
    if misfits is not None:
        made.insert(0, section("misfits", "Misfits", html_of(misfits)))
    return Page(f"{folder.absolute().name} beside records", made, mark=MARK)
