#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Renews the table of papers/kammer2012/bases.md from the results of `slipfront study base`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from shared import DataError, renew_page, renew_tables


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

    def tables(study: dict[str, Any]) -> dict[str, str]:
        content = table(study)
        if study["quick"]:
            raise DataError(f"{file}: of a quick study; renew the page with a full one")
        return {"table": content}

    renew_tables(file, page, "a study of bases", tables)


if __name__ == "__main__":
    sys.exit(renew_page(__file__, __doc__, "slipfront study base", "papers/kammer2012/bases.md", write))
