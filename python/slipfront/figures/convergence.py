# SPDX-License-Identifier: BSD-3-Clause
"""Front speed over the numerical parameters, from a folder of `slipfront study convergence`."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from slipfront.figures.drawing import Drawing
from slipfront.figures.style import PAGE_MM
from slipfront.read import DataError, open_text, read_json

COLOURS = ("#88ccee", "#332288", "#117733", "#cc6677")
NUMBERS = ("x_m", "direction", "value", "v_tip_m_per_s", "error_m_per_s")
HIGHEST_PERCENTILE = 98  # the speed diverges where fronts meet: the axis ends at this share of the points


def read_rows(file: Path) -> list[dict]:
    with open_text(file) as stream:
        rows = list(csv.DictReader(stream))
    try:
        return [{"parameter": r["parameter"], **{k: float(r[k] or "nan") for k in NUMBERS}} for r in rows]
    except (KeyError, ValueError, TypeError) as error:
        raise DataError(f"{file}: not a table of `slipfront study convergence`: {error}") from None


def shown(parameter: str, value: float) -> str:
    for ending, unit, factor in (("_m", " mm", 1e3), ("_s", " µs", 1e6)):
        if parameter.endswith(ending):
            return f"{factor * value:.3g}{unit}"
    return f"{value:.3g}"


def percent(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.2g} %"


def draw_sequence(ax, sequence: dict, rows: list[dict]) -> None:
    parameter, own = sequence["parameter"], sequence["case_value"]
    for direction in (-1, 1):
        for value, colour in zip(sequence["values"], COLOURS, strict=False):
            near = [
                r for r in rows if r["direction"] == direction and np.isclose(r["value"], value, rtol=1e-8)
            ]
            x, v, error = (
                np.array([r[key] for r in near]) for key in ("x_m", "v_tip_m_per_s", "error_m_per_s")
            )
            is_own = bool(np.isclose(value, own, rtol=1e-8))
            if is_own:
                ax.fill_between(1e3 * x, v - error, v + error, color="0.85", linewidth=0, gid="band")
            ax.plot(
                1e3 * x,
                v,
                color=colour,
                linewidth=1.6 if is_own else 0.8,
                label=shown(parameter, value) if direction == 1 else None,
            )
    ax.set_title(
        f"{parameter}: {sequence['verdict']}, median error {percent(sequence['median_relative_error'])}",
        loc="left",
    )
    ax.set_ylabel("$V_\\mathrm{tip}$ (m/s)")
    ax.legend(ncols=4, loc="upper center")


def convergence(folder: Path) -> Drawing:
    """A panel per sequence: V_tip(x) for each value, with the error band of the case's own (thick line)."""
    file = folder / "convergence.json"
    summary, rows = read_json(file), read_rows(folder / "convergence.csv")
    try:
        sequences = summary["sequences"]
        figure = Figure(figsize=(PAGE_MM / 25.4, 2.0 * len(sequences)), layout="constrained")
        axes = figure.subplots(len(sequences), 1, sharex=True, squeeze=False)[:, 0]
        speeds = [r["v_tip_m_per_s"] for r in rows if np.isfinite(r["v_tip_m_per_s"])]
        for ax, sequence in zip(axes, sequences, strict=True):
            draw_sequence(ax, sequence, [r for r in rows if r["parameter"] == sequence["parameter"]])
            if speeds:
                ax.set_ylim(0, 1.25 * np.percentile(speeds, HIGHEST_PERCENTILE))
        axes[-1].set_xlabel("$x$ (mm)")
    except (KeyError, TypeError) as error:
        raise DataError(f"{file}: not a result of `slipfront study convergence`: {error}") from None
    caption = "V_tip of the main fronts; grey: error band of the case's own value."
    return Drawing("convergence", figure, caption)
