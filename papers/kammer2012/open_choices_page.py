# SPDX-License-Identifier: BSD-3-Clause
"""Renews tables and picture of open-choices.md from a study of the open choices; the text stays."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

from drawing import open_choices
from slipfront.figures.drawing import write_results
from slipfront.pages import Tables, command_to_renew, table, tables_of

PAGE_WIDTH = 120  # of the docs' lines
#: Tests of claims that were not used to choose.
EVIDENCE_CLAIMS = (
    "C12",
    "C14",
    "C15",
    "C16",
    "C17",
    "C18b",
    "C18c",
    "C19",
    "C19b",
    "C20",
    "C20b",
    "C21",
    "C21+",
)


def told(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.3g}"


def listed(values: list[Any]) -> str:
    return ", ".join(told(value) for value in values)


def range_of(values: list[Any]) -> str:
    """Of numbers the least and the largest."""
    is_range = len(values) == 2 and not any(isinstance(value, str) for value in values)
    return " to ".join(told(value) for value in values) if is_range else listed(values)


def in_use(choice: dict[str, Any], values: dict[str, Any], choices: dict[str, dict[str, Any]]) -> bool:
    """Whether a choice has a part among such values."""
    decider = choice["decided_by"]
    if not decider:
        return True
    return values[decider] in choice["counts_with"] and in_use(choices[decider], values, choices)


def choices(study: dict[str, Any]) -> str:
    chosen = study["chosen"]
    by_name = {choice["name"]: choice for choice in study["choices"]}
    rows = []
    for name, choice in by_name.items():
        rows.append(
            [
                f"`{name}`",
                f"`{choice['key']}`",
                listed(choice["levels"]),
                choice["why"],
                told(choice["standard"]),
                range_of(study["region"].get(name, [])) or "-",
                told(chosen["values"][name]) if chosen and in_use(choice, chosen["values"], by_name) else "-",
            ]
        )
    return table(["choice", "key", "range", "reason", "standard", "region", "chosen"], rows)


def fit_of(outcome: dict[str, Any]) -> list[str]:
    fit = outcome["fit"]
    if not fit:
        return ["-"] * 3
    return [f"{fit[k]['value']:.2f} [{fit[k]['low']:.2f}, {fit[k]['high']:.2f}]" for k in "abc"]


def number(value: float | None, form: str, factor: float = 1) -> str:
    return "-" if value is None else f"{factor * value:{form}}"


OUTCOME_HEADER = [
    "work (J/m)",
    "C25",
    "wave; lowest behind it (m/s)",
    "left maximum (c_L); over spontaneous, right",
    "C18b: rms (c_L), in the band",
    "a",
    "b",
    "c",
    "C18c: spread at equal energy rise, t_d/p_d, t_s/p_s",
]


def outcome_row(outcome: dict[str, Any]) -> list[str]:
    left, peak, gap = (outcome[k] for k in ("left_max_over_c_L", "circle_peak_m_per_s", "circle_gap"))
    others = [outcome[f"{event}_max_over_c_L"] for event in ("spontaneous", "right")]
    ratios = ", ".join(number(left / other if other else None, ".0f", 100) for other in others)
    spreads = (outcome[f"spread_at_{name}"] for name in ("energy_rise", "t_d_over_p_d", "t_s_over_p_s"))
    holds = outcome["claims"]["C25"]
    return [
        number(outcome["left_work_J_per_m"], ".0f"),
        "-" if holds is None else "holds" if holds else "does not",
        "none" if peak is None else f"{peak:.1f}; {peak * gap:.1f}",
        f"{number(left, '.2f')}; {ratios} %",
        f"{number((outcome['fit'] or {}).get('rms_over_c_L'), '.3f')}, "
        f"{number(outcome['share_in_band'], '.0f', 100)} %",
        *fit_of(outcome),
        ", ".join(number(spread, ".0f", 100) for spread in spreads) + " %",
    ]


def known(study: dict[str, Any]) -> str:
    """The left triggers by which the rule was found, and the chosen one."""

    def words(values: dict[str, Any]) -> str:
        end = "held" if values["left_end"] == "held" else f"{1e6 * values['left_duration_s']:.2g} us"
        amount = values[f"left_{values['left_form']}"]
        return f"{values['left_form']}: {1e3 * values['left_zone_m']:.2g} mm, {amount:.2g}, {end}"

    rows = [[words(outcome["values"]), *outcome_row(outcome)] for outcome in study["known"]]
    if chosen := study["chosen"]:
        rows.append([f"**chosen**, {words(chosen['values'])}", *outcome_row(chosen)])
    return table(["left trigger", *OUTCOME_HEADER], rows)


def meshes(study: dict[str, Any]) -> str:
    """The chosen triggers by element size."""

    def size_mm(outcome: dict[str, Any]) -> float:
        return 1e3 * outcome["values"]["element_size_m"]

    def differs_by_mesh(outcome: dict[str, Any]) -> bool:
        values, chosen = outcome["values"], study["chosen"]["values"]
        return {name for name in values if values[name] != chosen[name]} == {"element_size_m"}

    if not study["chosen"]:
        return "Nothing was chosen.\n"
    about = [outcome for outcome in study["about"] if differs_by_mesh(outcome)]
    outcomes = sorted([study["chosen"], *study["finer"], *about], key=size_mm)
    rows = []
    for outcome in outcomes:
        failing = [claim for claim in study["constraints"] if outcome["claims"][claim] is False]
        cells = [f"{size_mm(outcome):.3g} mm", *outcome_row(outcome)[1:]]
        rows.append([*cells, ", ".join(failing) or "none"])
    return table(["elements", *OUTCOME_HEADER[1:], "constraints that fail"], rows)


def outcomes(study: dict[str, Any]) -> str:
    impossible = study["n_impossible"]
    counts = f"{study['n_samples']} samples, {study['n_runs']} runs"
    if study["quick"]:
        counts += " with elements of 4 mm, to try the command"
    if impossible:
        counts += f"; {impossible} more samples have fillets too small for their elements"
    n = {name[2:]: value for name, value in study.items() if name.startswith("n_")}
    counts += (
        f". Of the {n['left']} left triggers {n['left_with_fronts']} start a front; the constraints but C25 "
        f"hold for {n['left_others_hold']}, all of them for {n['left_region']}, the region, of which "
        f"{n['left_alike']} have the most frequent form and end. Of the {n['right']} right triggers the "
        f"constraints hold for {n['right_region']}, {n['right_alike']} of them of the left one's form and "
        f"end. C1 to C11 hold for {n['triggers_slow_left']} of the first {n['triggers']} left ones (C11b)."
    )
    return textwrap.fill(counts, PAGE_WIDTH, break_on_hyphens=False) + "\n"


def told_range(values: list[float | None], factor: float, form: str, unit: str) -> str:
    """Median, and the least and the largest behind it."""
    if None in values:
        return "-"
    least, median, largest = (f"{factor * value:{form}}" for value in values if value is not None)
    return f"{median} {unit}".rstrip() + f" ({least} to {largest})"


def evidence(study: dict[str, Any]) -> str:
    """What was not used to choose, a column for each group of samples."""
    groups = study["evidence"]

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

    def of_fit(name: str) -> list[str]:
        return row(name, lambda group: told_range(group[name], 1, ".2f", ""))

    rows = [
        ["samples", *(str(group["n"]) for group in groups)],
        spread("(U_r-U_s)/U_s", "energy_rise"),
        spread("t_d/p_d", "t_d_over_p_d"),
        spread("t_s/p_s", "t_s_over_p_s"),
        row("points in the paper's band", lambda group: told_range(group["share_in_band"], 100, ".0f", "%")),
        *(of_fit(name) for name in "abc"),
        row("a, b and c of the paper in our intervals", lambda group: f"{group['n_paper_fit_in_intervals']}"),
        *(holding(claim) for claim in EVIDENCE_CLAIMS),
        row(
            "difference between kinds of slip (C21+)",
            lambda group: told_range(group["difference_of_kinds_over_c_L"], 1, ".2f", "c_L"),
        ),
    ]
    return table(["left triggers", *(group["samples"] for group in groups)], rows)


def tables(study: dict[str, Any]) -> Tables:
    parts = {"choices": choices, "outcomes": outcomes, "evidence": evidence, "known": known, "meshes": meshes}
    return {name: part(study) for name, part in parts.items()}


def write(results: Path, picture: Path) -> Tables:
    made = tables_of(results / open_choices.SUMMARY, "a study of the open choices", tables)
    write_results(picture, results, open_choices.draw)
    return made


if __name__ == "__main__":
    page = Path(__file__).with_name("open-choices.md")
    sys.exit(command_to_renew(__file__, __doc__, page, write, "open_choices.py"))
