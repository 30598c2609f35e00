# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of docs/scorecard.md anew from a reproduction's scorecard.json; the text below it stays.

The columns of the variations are there where `slipfront reproduce --sensitivity` has written them.

Usage: scorecard-page.py RESULTS docs/scorecard.md
"""

import json
import pathlib
import sys

results, page = map(pathlib.Path, sys.argv[1:])
scorecard = json.loads((results / "scorecard.json").read_text())
verdict = {True: "holds", False: "**does not hold**", None: "not tested"}
variations = {}  # heading by key
for row in scorecard:
    for key in ("mesh_variation", "step_variation"):
        if key in row:
            variations[key] = f"moves by, at {row[key]['parameter']} = {row[key]['value']:g}"


def moves(row: dict, key: str) -> str:
    text = row[key]["moves"] if key in row else ""
    return text.replace("there does not hold", "**there does not hold**") or "-"


header = ["id", "claim", "our figure", "verdict", *variations.values(), "test"]
rows = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
for row in scorecard:
    cells = (
        row["id"],
        f"{row['claim']} ({row['paper']})",
        row["measured"],
        verdict[row["holds"]],
        *(moves(row, key) for key in variations),
        row["how"],
    )
    rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
start, end = "<!-- table -->\n", "<!-- end of table -->"
before, rest = page.read_text().split(start)
page.write_text(before + start + "\n".join(rows) + "\n" + end + rest.split(end)[1])
