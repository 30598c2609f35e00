# SPDX-License-Identifier: BSD-3-Clause
"""Renews the table and the picture of bases.md from the results of `bases.py`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from drawing import bases
from slipfront.figures.drawing import write_results
from slipfront.files import DataError
from slipfront.pages import Tables, command_to_renew, table, tables_of

HEADER = ["base", "V against / along", "pressure against, along", "in the paper's band", "spread", "a, b, c"]


def number(value: float | None, factor: float = 1, digits: int = 2) -> str:
    return "-" if value is None else f"{factor * value:.{digits}f}"


def row(base: dict[str, Any]) -> list[str]:
    ratio, change, spread, fit = base["speed_ratio"], base["pressure_change"], base["spread"], base["fit"]
    abc = ", ".join(number(fit[k]["value"]) for k in "abc") if fit else "-"
    return [
        base["name"],
        f"{number(ratio['median'])} ({number(ratio['low'])} to {number(ratio['high'])})",
        f"{number(change['against'], 100, 1)} %, {number(change['along'], 100, 1)} %",
        f"{number(base['share_in_paper_band'], 100, 0)} % of {base['n_points']}",
        f"{number(spread['dynamic_ratio'])}, {number(spread['energy_rise'])}",
        abc,
    ]


def write(results: Path, picture: Path) -> Tables:
    file = results / bases.SUMMARY

    def tables(study: dict[str, Any]) -> Tables:
        content = table(HEADER, [row(base) for base in study["bases"]])
        if study["quick"]:
            raise DataError(f"{file}: of a quick study; renew the page with a full one")
        return {"table": content}

    made = tables_of(file, "a study of bases", tables)
    write_results(picture, results, bases.draw)
    return made


if __name__ == "__main__":
    page = Path(__file__).with_name("bases.md")
    sys.exit(command_to_renew(__file__, __doc__, page, write, "bases.py"))
