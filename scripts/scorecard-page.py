# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of docs/scorecard.md anew from a reproduction's scorecard.json; the text below it stays.

A first test whose claim is judged by a second one says so beside its verdict. The columns of the variations are there where `slipfront reproduce --sensitivity` has written them.

Usage: scorecard-page.py RESULTS docs/scorecard.md
"""

import json
import pathlib
import sys

results, page = map(pathlib.Path, sys.argv[1:])
scorecard = json.loads((results / "scorecard.json").read_text())
verdict = {True: "holds", False: "**does not hold**", None: "not tested"}
judges = {row["second_test_of"]: row["id"] for row in scorecard if "second_test_of" in row and row["counts"]}
variations = {}  # heading by key
for row in scorecard:
    for key in ("mesh_variation", "step_variation"):
        if key in row:
            variations[key] = f"moves by, at {row[key]['parameter']} = {row[key]['value']:g}"


def moves(row: dict, key: str) -> str:
    text = row[key]["moves"] if key in row else ""
    return text.replace("there does not hold", "**there does not hold**") or "-"


def verdict_of(row: dict) -> str:
    own = "used to choose" if row["holds"] and row.get("used_to_choose") else verdict[row["holds"]]
    return own + (f"; {judges[row['id']]} counts" if row["id"] in judges else "")


def how(row: dict) -> str:
    """The test, and of a second one why the first misjudges."""
    return f"{row['how']}. Instead of {row['second_test_of']}: {row['why']}" if "why" in row else row["how"]


header = ["id", "claim", "our figure", "verdict", *variations.values(), "test"]
rows = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
for row in scorecard:
    cells = (
        row["id"],
        f"{row['claim']} ({row['paper']})",
        row["measured"],
        verdict_of(row),
        *(moves(row, key) for key in variations),
        how(row),
    )
    rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
start, end = "<!-- table -->\n", "<!-- end of table -->"
before, rest = page.read_text().split(start)
page.write_text(before + start + "\n".join(rows) + "\n" + end + rest.split(end)[1])
