# SPDX-License-Identifier: BSD-3-Clause
"""Renews the tables of papers/kammer2012/open-choices.md from a study of the open choices; the text stays."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

from shared import renew_page, renew_tables

PAGE_WIDTH = 120  # of the docs' lines
#: Tests of claims that were not used to choose.
EVIDENCE_CLAIMS = ("C14", "C15", "C16", "C17", "C18c", "C19", "C19b", "C20", "C20b", "C21", "C21+")


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
            holds += ", Fig. 6 agrees" if outcome["agrees_with_fig6"] else ", Fig. 6 does not agree"
            rows.append([name, *fit_of(outcome), f"{100 * outcome['share_in_band']:.0f} %", holds])
    impossible = study["n_impossible"]
    counts = f"{study['n_samples']} samples, {study['n_runs']} runs"
    if study["quick"]:
        counts += " with elements of 4 mm, to try the command"
    if impossible:
        counts += f"; {impossible} more samples have fillets too small for their elements"
    n_constrained, n_region = study["n_constrained"], study["n_region"]
    if study["evidence"][0]["n"] == 0:
        region = "they are the region, since none agrees with Fig. 6"
    else:
        region = f"the {n_region} of them that agree with Fig. 6 are the region"
    counts += (
        f". Of the {study['n_triggers']} samples of triggers {study['n_triggers_with_fronts']} start a "
        f"front at both edges, and C1 to C11 hold for {study['n_triggers_slow_left']}. The constraining "
        f"claims hold for {n_constrained} samples; {region}."
    )
    lines = textwrap.fill(counts, PAGE_WIDTH, break_on_hyphens=False)
    return lines + "\n\n" + table(["", "a", "b", "c", "points in the paper's band", "constraints"], rows)


def told_range(values: list[float | None], factor: float, form: str, unit: str) -> str:
    """Median, and the least and the largest behind it."""
    if None in values:
        return "-"
    least, median, largest = (f"{factor * value:{form}}" for value in values if value is not None)
    return f"{median} {unit} ({least} to {largest})"


def evidence(study: dict[str, Any]) -> str:
    """What was not used to choose, a column for each group of samples."""
    groups = study["evidence"][:2]  # not those with the left trigger held and taken away

    def row(heading: str, cell: Callable[[dict[str, Any]], str]) -> list[str]:
        return [heading, *(cell(group) if group["n"] else "-" for group in groups)]

    def holding(claim: str) -> list[str]:
        def cell(group: dict[str, Any]) -> str:
            tested = group["claims"].get(claim)
            return f"{tested['n_holding']} of {tested['n']}" if tested else "-"

        return row(f"{claim} holds", cell)

    def spread(criterion: str, name: str) -> list[str]:
        return row(
            f"spread of V_tip at equal {criterion}",
            lambda group: told_range(group[f"spread_at_{name}"], 100, ".0f", "%"),
        )

    rows = [
        ["samples", *(str(group["n"]) for group in groups)],
        spread("(U_r-U_s)/U_s", "energy_rise"),
        spread("t_d/p_d", "t_d_over_p_d"),
        spread("t_s/p_s", "t_s_over_p_s"),
        row("a, b and c of the paper in our intervals", lambda group: f"{group['n_paper_fit_in_intervals']}"),
        *(holding(claim) for claim in EVIDENCE_CLAIMS),
        row(
            "difference between kinds of slip (C21+)",
            lambda group: told_range(group["difference_of_kinds_over_c_L"], 1, ".2f", "c_L"),
        ),
    ]
    return table(["samples for which hold", *(group["samples"] for group in groups)], rows)


def tables(study: dict[str, Any]) -> dict[str, str]:
    return {"choices": choices(study), "outcomes": outcomes(study), "evidence": evidence(study)}


def write(results: Path, page: Path) -> None:
    renew_tables(results / "open_choices.json", page, "a study of the open choices", tables)


if __name__ == "__main__":
    sys.exit(
        renew_page(
            __file__, __doc__, "slipfront study open-choices", "papers/kammer2012/open-choices.md", write
        )
    )
