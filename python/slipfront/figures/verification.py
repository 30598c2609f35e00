# SPDX-License-Identifier: BSD-3-Clause
"""The charts of `slipfront verify -o DIR`: theory as lines, the program's values as points.

usage: python -m slipfront.figures.verification DIR FIGURES"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from slipfront.figures.drawing import Drawing
from slipfront.figures.style import COLUMN_MM, RC, new_figure
from slipfront.read import DataError, read_json

COLOURS = ("#0072b2", "#d55e00", "#117733", "#882255", "#000000", "#88ccee", "#999933")
MARKERS = ("o", "s", "^", "v", "D", "x", "+")
MANY_POINTS = 60  # from here on a line shows more than points
MANY_LABELS = 4  # more of them go below the panel
LABEL_COLUMNS = 2
LABEL_MM = 4.5


def draw_chart(ax, chart: dict) -> None:
    n_program = n_theory = 0
    for curve in chart["curves"]:
        if curve["kind"] == "theory":
            ax.plot(curve["x"], curve["y"], color="0.3", linestyle=("-", "--", ":", "-.")[n_theory % 4],
                    linewidth=0.8, label=curve["label"], zorder=1.5)
            n_theory += 1
        else:
            many = len(curve["x"]) > MANY_POINTS
            ax.plot(curve["x"], curve["y"], color=COLOURS[n_program % 7], linestyle="-" if many else "none",
                    marker=None if many else MARKERS[n_program % 7], markerfacecolor="none", label=curve["label"])
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


def n_labels(chart: dict) -> int:
    return sum(bool(curve["label"]) for curve in chart["curves"])


def draw(file: Path) -> Drawing:
    """One figure, a panel per chart."""
    results = read_json(file)
    try:
        charts = results["charts"]
        most = max((n_labels(chart) for chart in charts), default=0)
        below_mm = -(-most // LABEL_COLUMNS) * LABEL_MM if most > MANY_LABELS else 0
        figure: Figure = new_figure(COLUMN_MM * max(1, len(charts)), 62 + below_mm)
        for k, chart in enumerate(charts):
            draw_chart(figure.add_subplot(1, len(charts), k + 1), chart)
        return Drawing(f"verify_{results['name']}", figure, results["title"])
    except (KeyError, TypeError) as error:
        raise DataError(f"{file}: not a file of `slipfront verify`: {error}") from None


def main(results: Path, figures: Path) -> int:
    files = sorted(results.glob("*.json"))
    if not files:
        print(f"slipfront.figures: error: {results}: no results of `slipfront verify`", file=sys.stderr)
        return 2
    figures.mkdir(parents=True, exist_ok=True)
    try:
        with matplotlib.rc_context(RC):
            for file in files:
                drawing = draw(file)
                drawing.figure.savefig(figures / f"{drawing.name}.png", metadata={"Software": None})
    except DataError as error:
        print(f"slipfront.figures: error: {error}", file=sys.stderr)
        return 2
    print(f"figures: {figures} ({len(files)})")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
