# SPDX-License-Identifier: BSD-3-Clause
"""Writes the tables of docs/open-choices.md anew from a study of the open choices; the text stays."""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path
from typing import Any

from shared import renew_page, renew_tables

PAGE_WIDTH = 120  # of the docs' lines


def told(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.3g}"


def listed(values: list[Any]) -> str:
    return ", ".join(told(value) for value in values)


def range_of(values: list[Any]) -> str:
    """Of numbers the least and the largest."""
    is_range = len(values) == 2 and not any(isinstance(value, str) for value in values)
    return " to ".join(told(value) for value in values) if is_range else listed(values)


def table(header: list[str], rows: list[list[str]]) -> str:
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def in_use(choice: dict[str, Any], values: dict[str, Any]) -> bool:
    """Whether a choice has a part among such values."""
    return not choice["decided_by"] or values[choice["decided_by"]] in choice["counts_with"]


def choices(study: dict[str, Any]) -> str:
    region, chosen = study["region"], study["chosen"]
    rows = []
    for choice in study["choices"]:
        name = choice["name"]
        rows.append(
            [
                f"`{name}`",
                f"`{choice['key']}`",
                listed(choice["levels"]),
                choice["why"],
                told(choice["standard"]),
                range_of(region[name]) or "-",
                told(chosen["values"][name]) if chosen and in_use(choice, chosen["values"]) else "-",
            ]
        )
    return table(["choice", "key", "range", "reason", "standard", "region found", "chosen"], rows)


def fit_of(outcome: dict[str, Any]) -> list[str]:
    fit = outcome["fit"]
    if not fit:
        return ["-"] * 3
    return [f"{fit[k]['value']:.2f} [{fit[k]['low']:.2f}, {fit[k]['high']:.2f}]" for k in "abc"]


def outcomes(study: dict[str, Any]) -> str:
    rows = [["paper", "0.76 (band 0.07)", "1.80", "3.05", "", ""]]
    for name in ("standard", "chosen"):
        outcome = study[name]
        if outcome:
            holds = "hold" if outcome["constraints_hold"] else "do not all hold"
            rows.append([name, *fit_of(outcome), f"{100 * outcome['share_in_band']:.0f} %", holds])
    impossible = study["n_impossible"]
    counts = f"{study['n_samples']} samples, {study['n_runs']} runs"
    if study["quick"]:
        counts += " with elements of 4 mm, to try the command"
    if impossible:
        counts += f"; {impossible} more samples have fillets too small for their elements"
    counts += (
        f". Of the {study['n_triggers']} samples of triggers {study['n_triggers_with_fronts']} start a "
        f"front at both edges. All constraints hold for {study['n_region']} samples. Of these the paper's a, "
        f"b and c lie inside our intervals for {study['n_region_with_paper_fit']}, and at least 80 % of the "
        f"points in its band for {study['n_region_in_paper_band']}. C1 to C11 hold for "
        f"{study['n_triggers_slow_left']} of the {study['n_triggers']} trigger samples."
    )
    lines = textwrap.fill(counts, PAGE_WIDTH, break_on_hyphens=False)
    return lines + "\n\n" + table(["", "a", "b", "c", "points in the paper's band", "constraints"], rows)


def tables(study: dict[str, Any]) -> dict[str, str]:
    return {"choices": choices(study), "outcomes": outcomes(study)}


def write(results: Path, page: Path) -> None:
    renew_tables(results / "open_choices.json", page, "a study of the open choices", tables)


if __name__ == "__main__":
    sys.exit(renew_page(__file__, __doc__, "slipfront study open-choices", "docs/open-choices.md", write))
