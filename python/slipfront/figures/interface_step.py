# SPDX-License-Identifier: BSD-3-Clause
"""Error of the front speeds against the cost of the step at the interface.

usage: python -m slipfront.figures.interface_step PICTURE DIR...
DIR: output folder of `slipfront study interface-step`"""

from __future__ import annotations

import sys
from pathlib import Path

import pandas as pd

from slipfront.figures.drawing import Drawing, command_to_draw, plain, write_results
from slipfront.figures.style import COLUMN_MM, V_NAME, new_figure
from slipfront.files import DataError, number, read_json_table, read_table
from slipfront.folder import result_file

TABLE = "interface_step.csv"
SUMMARY = "interface_step.json"
NUMBERS = ("interface_rows", "cost_over_plain", "median_error", "p90_error")
COLOURS = {0: "0.2", 1: "#88ccee", 2: "#0072b2", 4: "#d55e00", 8: "#117733"}


def read_rows(file: Path) -> pd.DataFrame:
    table = read_table(result_file(file))
    try:
        return pd.DataFrame({key: table.numbers(key) for key in NUMBERS} | {"kind": table.texts("kind")})
    except DataError as error:
        raise DataError(f"{error}; not a table of `slipfront study interface-step`") from None


def draw(folders: list[Path]) -> Drawing:
    """A panel per study: lines through the 90th percentiles, small marks for the medians."""
    figure = new_figure(COLUMN_MM * len(folders), 70)
    for k, folder in enumerate(folders):
        rows = read_rows(folder / TABLE)
        file = result_file(folder / SUMMARY)
        summary = read_json_table(file)
        ax = figure.add_subplot(1, len(folders), k + 1)
        without, layers = (rows[rows["kind"] == kind] for kind in ("plain", "layer"))
        groups = {0: without} | {int(n): points for n, points in layers.groupby("interface_rows")}
        for n_rows, points in groups.items():
            cost, colour = points["cost_over_plain"], COLOURS.get(n_rows, "0.6")
            label = (
                f"{n_rows} row{'s' if n_rows > 1 else ''} sub-cycled" if n_rows else "plain, smaller steps"
            )
            ax.plot(cost, 100 * points["p90_error"], "-o", color=colour, label=label)
            ax.plot(cost, 100 * points["median_error"], ".", color=colour, markersize=2)
        tolerance = number(file, summary, "tolerance")
        ax.axhline(100 * tolerance, color="0.5", linewidth=0.5, label=f"tolerance, {100 * tolerance:g} %")
        ax.set(
            xscale="log",
            yscale="log",
            title=plain(str(summary.get("title", ""))),
            xlabel="node updates over those of the plain scheme",
        )
        ax.set_xticks([1, 2, 4, 8], labels=["1", "2", "4", "8"])
        ax.minorticks_off()
        if k == 0:
            ax.set_ylabel(f"error of {V_NAME} (%)")
            ax.legend(
                title="lines: 90 % of stations within; dots: median", title_fontsize=7, loc="lower left"
            )
            ax.set_ylim(bottom=ax.get_ylim()[0] / 200)
    return Drawing("interface_step", figure, "")


def draw_one(folder: Path) -> Drawing:
    return draw([folder])


def write(picture: Path, folders: list[Path]) -> list[str]:
    return write_results(picture, folders[0], lambda _: draw(folders))


main = command_to_draw(
    "slipfront.figures.interface_step",
    "Draws the error of the front speeds against the cost of the step at the interface.",
    "`slipfront study interface-step`",
    write,
    several=True,
)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
