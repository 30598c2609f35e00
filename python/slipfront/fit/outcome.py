# SPDX-License-Identifier: BSD-3-Clause
"""A fit's files: fit.json, posterior.csv, best.toml, corner.png, fit.html."""

from __future__ import annotations

import argparse
import json
import shutil
from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from scipy.stats import chi2

from slipfront import command
from slipfront.compare.kinds import Opened
from slipfront.compare.page import Part as ShownPart
from slipfront.compare.page import part as shown
from slipfront.errors import Error
from slipfront.figures.drawing import Drawing, guarded
from slipfront.figures.fit import draw_corner
from slipfront.figures.style import RC
from slipfront.files import read_toml
from slipfront.fit.combinations import Combined, combinations, findings, number
from slipfront.fit.fitting import BETTER, RUNS, Asked, Fitting, Result
from slipfront.fit.likelihood import Part
from slipfront.fit.mesh import KEY as ELEMENT_SIZE
from slipfront.fit.mesh import Finer
from slipfront.fit.posterior import Marginal, at_an_end, correlations, marginals
from slipfront.fit.space import Space
from slipfront.opened_sequence import opened
from slipfront.report.page import Page, rendered, section, warnings_list, words
from slipfront.report.tables import table
from slipfront.sweep import folder as places
from slipfront.sweep.definition import flattened

MARK = "<!DOCTYPE html><!-- slipfront fit -->"
UNLIKELY = 1e-3  # probability of a chi2, below which the model does not explain a part
ALIKE = 4.0  # times, by which what is left of a part counts as fewer, from which it is no noise
MOST_SAMPLES = 4000  # of posterior.csv
FEW = 200  # independent samples
MOVED = 1.0  # of a key's standard deviation, by which a finer mesh may move it


@dataclass(frozen=True)
class Outcome:
    """A fit in words and numbers, with what its page shows."""

    keys: list[Marginal]
    finer: list[Marginal]  # of the keys, as a finer mesh is expected to give them; may be empty
    combined: list[Combined]
    entries: dict[str, Any]  # of fit.json
    lines: list[str]  # to print
    notes: list[str]
    pictures: list[ShownPart]
    best: Path  # folder of the best run


def key_lines(keys: list[Marginal], best: dict[str, Any]) -> list[str]:
    lines = []
    for of in keys:
        low, high = of.intervals[0.90]
        told = f"{of.name} = {number(of.median)}, 90 % within {number(low)} to {number(high)}"
        lines.append(f"{told}; best run {number(best[of.name])}")
    return lines


def quality(part: Part, run: np.ndarray) -> dict[str, Any]:
    """What the best run leaves of a part. [values]"""
    left = part.left(part.reduced(part.measured), part.reduced(run))
    squares = float((left**2).sum())
    scale = part.scale(squares)
    sigma = float(np.sqrt((part.sigma**2).mean()))
    rms = float(np.sqrt((left**2).mean())) * sigma
    found: dict[str, Any] = {
        "values": part.n,
        "values_that_count": part.freedom,
        "unit": part.unit,
        "rms_left": rms,
        "rms_over_deviation": rms / float(part.measured.std()) if part.measured.std() > 0 else None,
        "standard_error": sigma if part.has_error else None,
        "discrepancy": sigma * float(np.sqrt(max(scale**2 - 1, 0))) if part.has_error else rms,
    }
    if part.has_error:
        found["chi2"] = squares / part.alike
        found["probability_of_chi2"] = float(chi2.sf(squares / part.alike, part.freedom))
    return found


def quality_line(name: str, of: dict[str, Any]) -> str:
    told = f"{name}: the best run leaves {in_unit(of['rms_left'], of['unit'])} rms"
    if of["standard_error"] is not None:
        return f"{told}, {of['rms_left'] / of['standard_error']:.2f} times the standard errors"
    if of["rms_over_deviation"] is None:
        return told
    return f"{told}, {100 * of['rms_over_deviation']:.0f} % of its standard deviation"


def in_unit(value: float, unit: str) -> str:
    return number(value) if unit == "1" else f"{number(value)} {'%' if unit == 'percent' else unit}"


def misfits(parts: list[Part], of: dict[str, dict[str, Any]]) -> list[str]:
    """Parts that the model does not explain."""
    told = []
    for part in parts:
        chance = of[part.name].get("probability_of_chi2")
        if chance is not None and chance < UNLIKELY:
            told.append(
                f"the model does not explain {part.name}: by its errors alone what is left has a chance of "
                f"{chance:.1g}; another law, load or geometry may"
            )
        elif chance is None and part.alike > ALIKE:
            told.append(
                f"what is left of {part.name} is no noise: neighbours are alike, so that {part.n} values "
                f"count as {part.freedom:.0f}"
            )
    return told


def pictures_of(asked: Asked, run: Opened) -> list[ShownPart]:
    """The best run beside each record."""
    found = []
    for (kind, record), is_fitted in zip(asked.records, asked.is_fitted, strict=True):
        data = kind.compare([run], record.content, asked.options)
        what = "" if is_fitted else ", predicted"
        drawing = kind.draw([run], record.content, data, asked.options)
        found.append(ShownPart(f"{kind.name}: {record.label}{what}", "", kind.lines(data),
                               [*record.notes, *data.attrs["notes"]], data, drawing))  # fmt: skip
    return found


def doubts_of(result: Result, keys: list[Marginal]) -> list[str]:
    notes = []
    if not result.agrees:
        expected = (
            "no round has tested it"
            if np.isinf(result.disagreement)
            else f"by {result.disagreement:.1f} of log L"
        )
        notes.append(
            f"runs and what was expected of them do not agree ({expected}): allow more runs by --most"
        )
    if result.n_independent < FEW:
        notes.append(f"only {result.n_independent:.0f} independent samples: intervals are rough")
    notes += [
        f"the posterior of {key} goes on beyond the runs: allow more by --most" for key in result.at_ends
    ]
    for k, of in enumerate(keys):
        if end := at_an_end(result.space, result.samples, of, k):
            notes.append(f"the {end} end of its range cuts the posterior of {of.name}: widen the range")
    check = result.check
    if check is None:
        notes.append("least squares of runs failed: a run beside the best one has no comparison")
    elif check.gain > BETTER:
        notes.append(
            f"least squares of runs is better by {check.gain:.1f} of log L than the place that was expected"
        )
    return notes


def mesh_doubts(space: Space, samples: np.ndarray, finer: Finer | str) -> list[str]:
    """What a finer mesh would change."""
    if isinstance(finer, str):
        return [f"what the mesh moves is not known: {finer}"]
    moved = (np.median(finer.samples, axis=0) - np.median(samples, axis=0)) / samples.std(axis=0)
    to = space.values(np.median(finer.samples, axis=0)[None])[0]
    changes = [
        f"{key} to {number(value)}, by {abs(by):.2g} of its standard deviations"
        for key, value, by in zip(space.keys, to, moved, strict=True)
        if abs(by) > MOVED
    ]
    if not changes:
        return []
    size = f"{ELEMENT_SIZE} = {finer.element_size_m:g}"
    return [f"{size} would move {'; '.join(changes)}: fit again with it"]


def outcome_of(
    options: argparse.Namespace, asked: Asked, fitting: Fitting, result: Result, finer: Finer | str
) -> Outcome:
    space, samples, best = result.space, result.samples, result.best
    place = places.place_of(fitting.folder / RUNS, best.point)
    case = flattened(read_toml(place / places.CASE))
    keys = marginals(space, samples)
    combined = combinations(case, space, samples)
    told = findings(space, samples, keys, combined)
    runs = fitting.computed([best])
    of_parts = {part.name: quality(part, rows[0]) for part, rows in zip(result.parts, runs, strict=True)}
    told += misfits(result.parts, of_parts) + result.left_out
    with matplotlib.rc_context(RC):
        try:
            pictures = guarded(place, lambda: pictures_of(asked, opened(place)))
        except Error as error:
            pictures = []
            told.append(f"the best run cannot be shown beside the records: {error}")
    notes = mesh_doubts(space, samples, finer) + doubts_of(result, keys)
    of_finer = [] if isinstance(finer, str) else marginals(space, finer.samples)
    check = result.check
    values = {key: float(value) for key, value in best.point.values.items()}  # type: ignore[arg-type]
    lines = key_lines(keys, values)
    lines += [quality_line(name, of) for name, of in of_parts.items()]
    for (_, record), is_fitted, picture in zip(asked.records, asked.is_fitted, pictures, strict=False):
        if not is_fitted:
            lines.append(f"predicted: {record.label}: {picture.lines[0]}")
    entries = {
        "case": str(options.case.resolve()),
        "set": fitting.settings,
        "records": [record.label for _, record in asked.records],
        "predicted": [record.label for _, record in asked.predicted],
        "free": {key: options_range(of) for key, of in space.ranges.items()},
        "parameters": {of.name: entry(of) | {"is_determined": of.is_determined} for of in keys},
        "combinations": {one.of.name: entry(one.marginal) | {"unit": one.of.unit, "clear": one.clear}
                         for one in combined},
        "finer_mesh": None if isinstance(finer, str) else {
            "element_size_m": finer.element_size_m, **{of.name: entry(of) for of in of_finer}},
        "correlations": correlations(samples).round(6).tolist(),
        "best": {"values": values, "log_likelihood": float(result.log_likelihood.max()),
                 "folder": f"{RUNS}/{places.POINTS}/{best.point.name}"},
        "parts": of_parts,
        "misfits": {p.heading: {"misfit": float(p.found["misfit_of_all"]),
                                "misfit_error": float(p.found["misfit_of_all_error"]),
                                "unit": str(p.found["misfit_of_all"].attrs["units"])} for p in pictures},
        "least_squares": None if check is None else {
            "values": dict(zip(space.keys, map(float, space.values(check.share)), strict=True)),
            "gain_of_log_likelihood": check.gain,
            "moved_over_deviations": dict(zip(
                space.keys, map(float, check.moved / samples.std(axis=0)), strict=True)),
            "deviations_over_posterior": dict(zip(
                space.keys, map(float, check.deviations / samples.std(axis=0)), strict=True)),
        },
        "runs": {"all": len(result.ran), "left_out": sum(bool(ran.why_not) for ran in result.ran),
                 "rounds": result.rounds, "expected_log_likelihood_off_by": result.disagreement,
                 "noise_of_log_likelihood": result.noise,
                 "independent_samples": result.n_independent},
        "findings": told,
        "notes": notes,
    }  # fmt: skip
    lines += [*told, *(f"note: {note}" for note in notes)]
    return Outcome(keys, of_finer, combined, entries, lines, notes, pictures, place)


def options_range(of: Any) -> dict[str, Any]:
    return {"from": of.from_, "to": of.to, "is_log": of.is_log}


def entry(of: Marginal) -> dict[str, Any]:
    return {"median": of.median} | {
        f"interval_{100 * level:.0f}": list(ends) for level, ends in of.intervals.items()
    }


def plain(value: Any) -> Any:
    """JSON has neither infinity nor NaN."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def page_of(outcome: Outcome, corner: Drawing) -> Page:
    rows = []
    finer = {of.name: number(of.median) for of in outcome.finer}
    for of in outcome.keys:
        (low, high), (low68, high68) = of.intervals[0.90], of.intervals[0.68]
        best = number(outcome.entries["best"]["values"][of.name])
        rows.append([words(of.name), number(of.median), f"{number(low68)} to {number(high68)}",
                     f"{number(low)} to {number(high)}", best, finer.get(of.name, "–")])  # fmt: skip
    head = ["key or combination", "median", "68 %", "90 %", "best run", "median, elements half as large"]
    image = b64encode(corner.rendered("svg")).decode()
    picture = f'<img src="data:image/svg+xml;base64,{image}" alt="posterior" style="max-width:100%">'
    for one in outcome.combined:
        of, unit = one.marginal, f" {one.of.unit}" if one.of.unit else ""
        ends = (" to ".join(map(number, of.intervals[level])) + unit for level in (0.68, 0.90))
        rows.append([words(of.name), number(of.median) + unit, *ends, "–", "–"])
    told = "".join(f"<p>{words(line)}.</p>" for line in outcome.entries["findings"])
    parts = []
    for name, of in outcome.entries["parts"].items():
        error = "–" if of["standard_error"] is None else in_unit(of["standard_error"], of["unit"])
        counted = f"{of['values_that_count']:.1f}"
        parts.append([words(name), str(of["values"]), counted, in_unit(of["rms_left"], of["unit"]), error])
    left = ["part", "values", "that count", "left by the best run", "standard error"]
    made = [
        section("keys", "Free keys", table(head, rows), told, warnings_list(outcome.notes), picture),
        section("parts", "What is left", table(left, parts)),
        *(shown(of, f"record{k}") for k, of in enumerate(outcome.pictures)),
    ]
    return Page("Fit to records", made, mark=MARK)


def write_results(folder: Path, outcome: Outcome, result: Result) -> None:
    """All files of the fit, whole or none."""
    rng = np.random.default_rng(0)
    n = min(MOST_SAMPLES, len(result.samples))
    some = result.space.values(result.samples[np.sort(rng.choice(len(result.samples), n, replace=False))])
    with matplotlib.rc_context(RC):
        corner = guarded(
            folder, lambda: draw_corner(result.space, result.samples, outcome.entries["best"]["values"])
        )
        text = guarded(folder, lambda: rendered(page_of(outcome, corner)))
        image = corner.rendered("png")
    with command.publishing_into(folder) as made:
        entries = json.dumps(plain(outcome.entries), indent=2, allow_nan=False)
        (made / "fit.json").write_text(entries + "\n", encoding="utf-8")
        pd.DataFrame(some, columns=result.space.keys).to_csv(made / "posterior.csv", index=False)
        shutil.copyfile(outcome.best / places.CASE, made / "best.toml")
        (made / "corner.png").write_bytes(image)
        (made / "fit.html").write_text(text, encoding="utf-8")
