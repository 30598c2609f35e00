# SPDX-License-Identifier: BSD-3-Clause
"""Puts the numbers and the picture of `slipfront verify -o DIR` at the end of each page of docs/verification.

usage: verification-pages.py DIR docs/verification"""

import json
import sys
from pathlib import Path

MARK = "<!-- numbers -->"


def numbers(results: dict) -> str:
    lines = [
        f"![{results['title']}](../figures/verify_{results['name']}.png)",
        "",
        "| quantity | measured | expected | tolerance | its reason |",
        "|---|---|---|---|---|",
    ]
    for c in results["checks"]:
        unit = f" {c['unit']}" if c["unit"] else ""
        mark = "" if c["holds"] else " **does not hold**"
        lines.append(
            f"| {c['quantity']} | {c['measured']:.6g}{unit}{mark} | {c['expected']:.6g} | {c['tolerance']:.2g} | {c['reason']} |"
        )
    return "\n".join(lines) + "\n"


def main(results_dir: Path, pages: Path) -> None:
    rows = []
    for page in sorted(pages.glob("*.md")):
        if page.stem == "README":
            continue
        text = page.read_text()
        if MARK not in text:
            sys.exit(f"{page}: no line {MARK}")
        results = json.loads((results_dir / f"{page.stem}.json").read_text())
        page.write_text(text.split(MARK)[0] + MARK + "\n\n" + numbers(results))
        holding = sum(c["holds"] for c in results["checks"])
        rows.append(f"| [{results['title']}]({page.name}) | {holding} of {len(results['checks'])} |")
    index = pages / "README.md"
    text = index.read_text()
    index.write_text(
        text.split(MARK)[0] + MARK + "\n\n" + "\n".join(["| problem | checks that hold |", "|---|---|", *rows]) + "\n"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
