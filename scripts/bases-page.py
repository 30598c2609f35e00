#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Renews the table of docs/bases.md from the results of `slipfront study base`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from shared import DataError, between_marks, expecting, read_result, renew, run


def number(value: float | None, factor: float = 1, digits: int = 2) -> str:
    return "-" if value is None else f"{factor * value:.{digits}f}"


def row(base: dict[str, Any]) -> str:
    ratio, change, spread, fit = base["speed_ratio"], base["pressure_change"], base["spread"], base["fit"]
    abc = ", ".join(number(fit[k]["value"]) for k in "abc") if fit else "-"
    cells = [
        base["name"],
        f"{number(ratio['median'])} ({number(ratio['low'])} to {number(ratio['high'])})",
        f"{number(change['against'], 100, 1)} %, {number(change['along'], 100, 1)} %",
        f"{number(base['share_in_paper_band'], 100, 0)} % of {base['n_points']}",
        f"{number(spread['dynamic_ratio'])}, {number(spread['energy_rise'])}",
        abc,
    ]
    return "| " + " | ".join(cells) + " |\n"


def table(study: dict[str, Any]) -> str:
    text = "| base | V against / along | pressure against, along | in the paper's band | spread | a, b, c |\n"
    text += "|---|---|---|---|---|---|\n"
    return text + "".join(row(base) for base in study["bases"])


def write(results: Path, page: Path) -> None:
    file = results / "bases.json"
    study = read_result(file)
    with expecting("a study of bases", file):
        content = table(study)
        quick = bool(study["quick"])
    if quick:
        raise DataError(f"{file}: of a quick study; renew the page with a full one")
    renew(page, lambda text: between_marks(page, text, "table", content))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="output folder of `slipfront study base`")
    parser.add_argument("page", type=Path, help="docs/bases.md")
    options = parser.parse_args()
    sys.exit(run(__file__, lambda: write(options.results, options.page)))
