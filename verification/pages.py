# SPDX-License-Identifier: BSD-3-Clause
"""Puts numbers and picture of `slipfront-verify -o DIR` at the end of each page of verification."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from slipfront import command
from slipfront.files import DataError, read_text
from slipfront.pages import expecting, read_result, write_pages

MARK = "<!-- numbers -->"
MOST_ROWS = 8  # of a table; `slipfront-verify` prints every check


def shown(checks: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """All that fail, and up to MOST_ROWS in all: of each reason in turn the one nearest to its tolerance."""
    by_reason: dict[str, list[int]] = {}
    for i, c in enumerate(checks):
        by_reason.setdefault(c["reason"], []).append(i)

    def distance(i: int) -> float:
        c = checks[i]
        return abs(c["measured"] - c["expected"]) / c["tolerance"] if c["tolerance"] else 0.0

    turns = [
        (turn, i)
        for group in by_reason.values()
        for turn, i in enumerate(sorted(group, key=distance, reverse=True))
    ]
    kept = {i for _, i in sorted(turns)[:MOST_ROWS]} | {i for i, c in enumerate(checks) if not c["holds"]}
    return [checks[i] for group in by_reason.values() for i in group if i in kept]


def numbers(results: dict[str, Any]) -> str:
    checks = results["checks"]
    rows = shown(checks)
    lines = [f"![{results['title']}](figures/{results['name']}.png)", ""]
    if len(rows) < len(checks):
        lines += [
            f"The {len(rows)} of {len(checks)} checks that come nearest to their tolerances, by reason:",
            "",
        ]
    lines += ["| quantity | measured | expected | tolerance | its reason |", "|---|---|---|---|---|"]
    reason = None
    for c in rows:
        unit = f" {c['unit']}" if c["unit"] else ""
        mark = "" if c["holds"] else " **does not hold**"
        lines.append(
            f"| {c['quantity']} | {c['measured']:.6g}{unit}{mark} | {c['expected']:.6g} | "
            f"{c['tolerance']:.2g} | {c['reason'] if c['reason'] != reason else ''} |"
        )
        reason = c["reason"]
    return "\n".join(lines) + "\n"


def row_of(results: dict[str, Any], name: str) -> str:
    """Of the table of all problems."""
    holding = sum(c["holds"] for c in results["checks"])
    return f"| [{results['title']}]({name}) | {holding} of {len(results['checks'])} |"


def after_mark(page: Path, content: str) -> str:
    """The page's text with all that follows its mark replaced."""
    before, found, _ = read_text(page).partition(MARK)
    if not found:
        raise DataError(f"{page}: no line {MARK}")
    return f"{before}{MARK}\n\n{content}"


def write(results_dir: Path, pages: Path) -> list[str]:
    texts, rows = {}, []
    files = sorted(page for page in pages.glob("*.md") if page.stem != "README")
    if not files:
        raise DataError(f"{pages}: no pages of problems")
    for page in files:
        file = results_dir / f"{page.stem}.json"
        results = read_result(file)
        with expecting("a file of `slipfront-verify`", file):
            content = numbers(results)
            rows.append(row_of(results, page.name))
        texts[page.name] = after_mark(page, content)
    index = pages / "README.md"
    table = "\n".join(["| problem | checks that hold |", "|---|---|", *rows]) + "\n"
    texts[index.name] = after_mark(index, table)
    write_pages(pages, texts)
    return []


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", metavar="DIR", type=Path, help="output folder of `slipfront-verify`")
    parser.add_argument("pages", type=Path, help="verification")
    options = parser.parse_args()
    sys.exit(command.run("pages.py", lambda: write(options.results, options.pages)))
