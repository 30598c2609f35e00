# SPDX-License-Identifier: BSD-3-Clause
"""Renews the table of scorecard.md from a reproduction's scorecard.json; the text stays.

A first test whose claim is judged by a second one says so beside its verdict. The columns of the variations
are there where `reproduce.py --sensitivity` has written them."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from slipfront.pages import Tables, command_to_renew, table, tables_of

VERDICTS = {True: "holds", False: "**does not hold**", None: "not tested"}


def variations_of(scorecard: list[dict[str, Any]]) -> dict[str, str]:
    """Headings of the variations that were run, by their keys."""
    headings: dict[str, str] = {}
    for row in scorecard:
        for key in ("mesh_variation", "step_variation"):
            if key in row:
                headings[key] = f"moves by, at {row[key]['parameter']} = {row[key]['value']:g}"
    return headings


def moves(row: dict[str, Any], key: str) -> str:
    text = row[key]["moves"] if key in row else ""
    return text.replace("there does not hold", "**there does not hold**") or "-"


def verdict_of(row: dict[str, Any], judges: dict[str, str]) -> str:
    own = "used to choose" if row["holds"] and row.get("used_to_choose") else VERDICTS[row["holds"]]
    return own + (f"; {judges[row['id']]} counts" if row["id"] in judges else "")


def how(row: dict[str, Any]) -> str:
    """The test, and of a second one why the first misjudges."""
    return f"{row['how']}. Instead of {row['second_test_of']}: {row['why']}" if "why" in row else row["how"]


def tables(scorecard: list[dict[str, Any]]) -> Tables:
    judges = {
        row["second_test_of"]: row["id"] for row in scorecard if "second_test_of" in row and row["counts"]
    }
    variations = variations_of(scorecard)
    header = ["id", "claim", "our figure", "verdict", *variations.values(), "test"]
    rows = [
        [
            row["id"],
            f"{row['claim']} ({row['paper']})",
            row["measured"],
            verdict_of(row, judges),
            *(moves(row, key) for key in variations),
            how(row),
        ]
        for row in scorecard
    ]
    return {"table": table(header, rows)}


def write(results: Path, _: Path) -> Tables:
    return tables_of(results / "scorecard.json", "a scorecard", tables)


if __name__ == "__main__":
    page = Path(__file__).with_name("scorecard.md")
    sys.exit(command_to_renew(__file__, __doc__, page, write, "reproduce.py"))
