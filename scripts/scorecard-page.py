# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of docs/scorecard.md anew from a reproduction's scorecard.json; the text below it stays.

Usage: scorecard-page.py RESULTS docs/scorecard.md
"""

import json
import pathlib
import sys

results, page = map(pathlib.Path, sys.argv[1:])
verdict = {True: "holds", False: "**does not hold**", None: "not tested"}
rows = ["| id | claim | our figure | verdict | test |", "|---|---|---|---|---|"]
for row in json.loads((results / "scorecard.json").read_text()):
    cells = (row["id"], f"{row['claim']} ({row['paper']})", row["measured"], verdict[row["holds"]], row["how"])
    rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
start, end = "<!-- table -->\n", "<!-- end of table -->"
before, rest = page.read_text().split(start)
page.write_text(before + start + "\n".join(rows) + "\n" + end + rest.split(end)[1])
