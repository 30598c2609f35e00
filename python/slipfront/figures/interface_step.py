# SPDX-License-Identifier: BSD-3-Clause
"""Error of the front speeds against the cost of the step at the interface.

usage: python -m slipfront.figures.interface_step PICTURE DIR..., output folders of `slipfront study interface-step`"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from slipfront.figures.style import COLUMN_MM, RC, new_figure
from slipfront.read import DataError, open_text, read_json

COLOURS = {1: "#88ccee", 2: "#0072b2", 4: "#d55e00", 8: "#117733"}


def read_rows(file: Path) -> list[dict]:
    with open_text(file) as stream:
        rows = list(csv.DictReader(stream))
    try:
        return [
            {
                "kind": row["kind"],
                "rows": int(row["interface_rows"]),
                "substeps": int(row["interface_substeps"]),
                **{key: float(row[key]) for key in ("cost_over_plain", "median_error", "p90_error")},
            }
            for row in rows
        ]
    except (KeyError, ValueError, TypeError) as error:
        raise DataError(f"{file}: not a table of `slipfront study interface-step`: {error}") from None


def draw(folders: list[Path]) -> Figure:
    """A panel per study: lines through the 90th percentiles, small marks for the medians."""
    figure = new_figure(COLUMN_MM * len(folders), 70)
    for k, folder in enumerate(folders):
        rows = read_rows(folder / "interface_step.csv")
        summary = read_json(folder / "interface_step.json")
        ax = figure.add_subplot(1, len(folders), k + 1)
        groups = [("plain", 0)] + sorted({("layer", r["rows"]) for r in rows if r["kind"] == "layer"})
        for kind, n_rows in groups:
            points = [r for r in rows if r["kind"] == kind and (kind == "plain" or r["rows"] == n_rows)]
            cost = [r["cost_over_plain"] for r in points]
            colour = "0.2" if kind == "plain" else COLOURS.get(n_rows, "0.6")
            label = "plain, smaller steps" if kind == "plain" else f"{n_rows} row{'s' if n_rows > 1 else ''} sub-cycled"
            ax.plot(cost, [100 * r["p90_error"] for r in points], "-o", color=colour, label=label)
            ax.plot(cost, [100 * r["median_error"] for r in points], ".", color=colour, markersize=2)
        ax.axhline(100 * summary["tolerance"], color="0.5", linewidth=0.5)
        ax.set(xscale="log", yscale="log", title=summary["title"], xlabel="node updates over those of the plain scheme")
        ax.set_xticks([1, 2, 4, 8], labels=["1", "2", "4", "8"])
        ax.minorticks_off()
        if k == 0:
            ax.set_ylabel("error of V_tip (%)")
            ax.legend(title="lines: 90 % of stations within; dots: median", title_fontsize=6, loc="lower left")
            ax.set_ylim(bottom=ax.get_ylim()[0] / 20)
    return figure


def main(picture: Path, folders: list[Path]) -> int:
    try:
        with matplotlib.rc_context(RC):
            draw(folders).savefig(picture, metadata={"Software": None})
    except DataError as error:
        print(f"slipfront.figures: error: {error}", file=sys.stderr)
        return 2
    print(f"figure: {picture}")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), [Path(folder) for folder in sys.argv[2:]]))
