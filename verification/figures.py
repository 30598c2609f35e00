# SPDX-License-Identifier: BSD-3-Clause
"""The charts of `slipfront-verify -o DIR`: theory as lines, the program's values as points.

usage: python verification/figures.py DIR FIGURES"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from slipfront import command
from slipfront.figures.drawing import Drawing
from slipfront.figures.style import COLUMN_MM, RC, new_figure
from slipfront.files import DataError, read_json_table
from slipfront.folder import read_list, result_file

COLOURS = ("#0072b2", "#d55e00", "#117733", "#882255", "#000000", "#88ccee", "#999933")
MARKERS = ("o", "s", "^", "v", "D", "x", "+")
MANY_POINTS = 60  # from here on a line shows more than points
MANY_LABELS = 4  # more of them go below the panel
LABEL_COLUMNS = 2
LABEL_MM = 4.5
CHARTS_IN_A_ROW = 3


def draw_chart(ax: Axes, chart: dict[str, Any]) -> None:
    n_program = n_theory = 0
    for curve in chart["curves"]:
        if curve["kind"] == "theory":
            ax.plot(
                curve["x"],
                curve["y"],
                color="0.3",
                linestyle=("-", "--", ":", "-.")[n_theory % 4],
                linewidth=0.8,
                label=curve["label"],
                zorder=1.5,
            )
            n_theory += 1
        else:
            many = len(curve["x"]) > MANY_POINTS
            ax.plot(
                curve["x"],
                curve["y"],
                color=COLOURS[n_program % 7],
                linestyle="-" if many else "none",
                marker=None if many else MARKERS[n_program % 7],
                markerfacecolor="none",
                label=curve["label"],
            )
            n_program += 1
    ax.set(xlabel=chart["x_label"], ylabel=chart["y_label"])
    for axis, log in ((ax.xaxis, chart["log_x"]), (ax.yaxis, chart["log_y"])):
        if not log:
            continue
        (ax.set_xscale if axis is ax.xaxis else ax.set_yscale)("log")
        low, high = axis.get_view_interval()
        if high < 100 * low:  # labels at powers of ten alone would be too few
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
    if n_labels(chart) <= MANY_LABELS:
        ax.legend()
    else:
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=LABEL_COLUMNS)


def n_labels(chart: dict[str, Any]) -> int:
    return sum(bool(curve["label"]) for curve in chart["curves"])


def draw(file: Path) -> Drawing:
    """One figure, a panel per chart, rows of at most CHARTS_IN_A_ROW."""
    results = read_json_table(result_file(file))
    try:
        charts = results["charts"]
        most = max((n_labels(chart) for chart in charts), default=0)
        below_mm = -(-most // LABEL_COLUMNS) * LABEL_MM if most > MANY_LABELS else 0
        columns = min(max(1, len(charts)), CHARTS_IN_A_ROW)
        rows = max(1, -(-len(charts) // columns))
        figure: Figure = new_figure(COLUMN_MM * columns, rows * (62 + below_mm))
        for k, chart in enumerate(charts):
            draw_chart(figure.add_subplot(rows, columns, k + 1), chart)
        name, title = results["name"], results["title"]
    except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise DataError(f"{file}: not a file of `slipfront-verify`: {error}") from None
    if name != file.stem:
        raise DataError(f"{file}: not a file of `slipfront-verify`: its name is '{name}'")
    return Drawing(name, figure, str(title))


def draw_all(results: Path, figures: Path) -> list[str]:
    """Writes a picture per file; returns what to print."""
    sums = read_list(results)
    names = [path.name for path in results.glob("*.json")] if sums is None else list(sums)
    files = sorted(results / name for name in names if name.endswith(".json"))
    if not files:
        raise DataError(f"{results}: no results of `slipfront-verify`")
    with command.publishing_into(figures) as folder, matplotlib.rc_context(RC):
        for file in files:
            drawing = draw(file)
            (folder / f"{drawing.name}.png").write_bytes(drawing.guarded_rendering(file, "png"))
    return [f"figures: {figures} ({len(files)})"]


def main(results: Path, figures: Path) -> int:
    return command.run("figures.py", lambda: draw_all(results, figures))


def parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python verification/figures.py",
        description="Draws the charts of `slipfront-verify -o DIR` as FIGURES/NAME.png.",
    )
    parser.add_argument("dir", metavar="DIR", type=Path, help="output folder of `slipfront-verify`")
    parser.add_argument("figures", metavar="FIGURES", type=Path, help="folder for the pictures")
    return parser.parse_args()


if __name__ == "__main__":
    options = parsed()
    sys.exit(main(options.dir, options.figures))
