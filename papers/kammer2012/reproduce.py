# SPDX-License-Identifier: BSD-3-Clause
"""Everything behind the paper: runs its events and the studies around them, and tests its claims.

    python papers/kammer2012/reproduce.py [-o DIR] [--quick] ...

writes a folder for each run, scorecard.json, analysis.json and timings.json; an interrupted one goes on when
the command is given again."""

from __future__ import annotations

import sys
import time
from argparse import Namespace
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import circle
import slipfront
import xarray as xr
from analysis import write_analysis, write_json, write_scorecard
from commands import Progress, parser_of, run_command
from drawing.results import HIGH_MU_K
from events import Event
from scorecard import (
    Claim,
    LoadedOn,
    Reproduction,
    StudyEvents,
    TriggerSample,
    add_variation,
    describe,
    scorecard,
    summary,
)
from slipfront.compare.speeds import read_points
from slipfront.errors import BlowUpError

from cases import (
    EVENTS,
    Run,
    Study,
    Variation,
    paper_cases,
    regularised_studies,
    sequences,
    studies,
    variations,
)


class Runner:
    """Runs cases and writes each to its folder."""

    def __init__(self, batch: slipfront.Batch, total: int) -> None:
        self.batch, self.progress, self.blow_ups = batch, Progress(total), list[str]()

    def run(self, runs: list[Run]) -> list[Event]:
        """The events, in the order of the runs."""
        events: list[Event | None] = [None] * len(runs)
        cases = [run.case() for run in runs]

        def done(k: int, found: slipfront.BatchEvent) -> None:
            if found.blew_up:
                self.blow_ups.append(f"{runs[k].name}: {found.reason}")
            events[k] = circle.event_with_waves(runs[k].event, cases[k], found)
            self.progress.step()

        self.batch.run(cases, done, names=[run.name for run in runs])
        return [event for event in events if event is not None]

    def load_on(self, run: Run) -> LoadedOn:
        """Loads a plate on until all of it slips in one event."""
        found = self.batch.run_sequence(run.case(), run.name)
        self.progress.step()
        friction = found.case["friction"]
        largest = float(found.loading["shear_over_normal"].max())
        return LoadedOn(friction["mu_s"], friction["mu_k"], largest, found.events.sizes["event"])


def runs_of(list_of: list[Study], folder: str = "") -> list[Run]:
    """Those of studies as one list, so that the machine is busy to the end."""
    return [
        Run(f"{folder}studies/{study.name}/{point.value}/{run.name}", run.event, run.changes)
        for study in list_of
        for point in study.points
        for run in point.runs
    ]


def by_study(list_of: list[Study], events: list[Event]) -> dict[str, StudyEvents]:
    """The events of such a list."""
    rest: Iterator[Event] = iter(events)
    return {
        study.name: StudyEvents(study, [[next(rest) for _ in point.runs] for point in study.points])
        for study in list_of
    }


def runs_of_variation(variation: Variation) -> list[Run]:
    """All of a variation in its own folder: the events first."""
    folder = f"variations/{variation.name}/"
    events = [Run(folder + run.name, run.event, run.changes) for run in variation.events]
    return events + runs_of(variation.studies, folder)


def of_events(events: list[Event]) -> dict[str, Any]:
    """The paper's four events, which come first."""
    return dict(zip(("spontaneous", "left", "right", "spontaneous_mu_k_1"), events, strict=False))


class Laps:
    """The wall time of the parts of a reproduction, one after the other."""

    def __init__(self) -> None:
        self.last, self.timings = time.monotonic(), list[dict[str, str | float]]()

    def end(self, part: str) -> None:
        now = time.monotonic()
        self.timings.append({"part": part, "wall_s": now - self.last})
        self.last = now


def lines_of(claims: list[Claim]) -> list[str]:
    """The scorecard for people."""
    lines = ["", "Scorecard of Kammer, Yastrebov, Spijker, Molinari (2012)", ""]
    gap = " " * 22
    for c in claims:
        lines += [f"{c.id:<7}{c.verdict:<15}{c.claim} [{c.paper}]", f"{gap}{c.measured}"]
        if c.second_test_of:
            counts = ", counts in its place" if c.counts else ""
            lines.append(f"{gap}second test of {c.second_test_of}{counts}: {c.why}")
        for v in c.variations:
            if moves := describe(c, v):
                lines.append(f"{gap}at {v.variation.key} = {v.variation.value:g} it moves by: {moves}")
    return [*lines, "", summary(claims), ""]


def beside(measured: dict[str, Any] | None, folder: Path) -> xr.Dataset | None:
    """Measured speeds beside those of the run with mu_k = 1.0."""
    if measured is None:
        return None
    return slipfront.compare_speeds([slipfront.open(folder / HIGH_MU_K)], measured)


def given_triggers(options: Namespace) -> TriggerSample | None:
    if options.open_choices is None:
        return None
    if Path(options.open_choices).absolute() == Path(options.output).absolute():
        raise slipfront.CaseError(
            f"{options.output}: holds the study of the open choices; choose another folder"
        )
    from open_choices import read_trigger_sample

    return read_trigger_sample(options.open_choices, options.quick)


def reproduce(options: Namespace) -> list[str]:
    """Lines to print."""
    measured = options.experiment and read_points(options.experiment)
    triggers = given_triggers(options)
    events, around, loaded = (
        paper_cases(options.quick),
        regularised_studies() if options.regularised else studies(options.quick),
        sequences(options.quick),
    )
    varied = variations(options.quick) if options.sensitivity else []
    total = len(events) + len(runs_of(around)) + len(loaded) + sum(len(runs_of_variation(v)) for v in varied)
    flags = (f" --{name}" for name in ("quick", "regularised", "sensitivity") if getattr(options, name))
    laps = Laps()
    with slipfront.Batch(
        options.output, f"reproduce{''.join(flags)}", threads=options.threads, overwrite=options.overwrite
    ) as batch:
        runner = Runner(batch, total)
        four = runner.run(events)
        blew_up = list(runner.blow_ups)
        laps.end("statics, four events and their files")
        of_studies = by_study(around, runner.run(runs_of(around)))
        laps.end("studies")
        loaded_on = [runner.load_on(run) for run in loaded]
        laps.end("sequences")
        runs = Reproduction(
            **of_events(four),
            studies=of_studies,
            experiment=beside(measured, batch.folder),
            triggers=triggers,
            loaded_on=loaded_on,
        )
        claims = scorecard(runs)
        for variation in varied:
            there = runner.run(runs_of_variation(variation))
            # The triggers were not sampled on other meshes.
            of_studies = by_study(variation.studies, there[len(EVENTS) :])
            of_experiment = beside(measured, batch.folder / "variations" / variation.name)
            others = Reproduction(**of_events(there), studies=of_studies, experiment=of_experiment)
            add_variation(claims, variation, scorecard(others))
        if varied:
            laps.end("variations of mesh and step")
        write_scorecard(batch.folder / "scorecard.json", claims)
        write_analysis(batch.folder / "analysis.json", runs)
        laps.end("analysis and scorecard")
        write_json(batch.folder / "timings.json", laps.timings)
    if blew_up:
        raise BlowUpError(blew_up[0])
    return [
        *lines_of(claims),
        *(f"{lap['wall_s']:8.2f} s  {lap['part']}" for lap in laps.timings),
        f"{batch.n_runs} runs, {batch.n_quiet} of which ended before time.end_s since nothing moved",
        *(f"warning: {text}" for text in runner.blow_ups),
        f"results: {options.output}",
    ]


def main() -> int:
    parser = parser_of("Run everything behind the paper and test its claims.", "results")
    only = parser.add_mutually_exclusive_group()
    parser.add_argument("--quick", action="store_true", help="elements of 2 mm and fewer studies")
    only.add_argument(
        "--regularised",
        action="store_true",
        help="studies of friction that responds to pressure with a delay, over element size and delay, "
        "in place of the paper's",
    )
    only.add_argument(
        "--sensitivity",
        action="store_true",
        help="also with elements of 1 mm and with half the sub-steps: how far the scorecard's figures move",
    )
    parser.add_argument(
        "--experiment",
        metavar="FILE",
        type=Path,
        help="CSV of measured points for claim E1: static_ratio, v_over_c_L (or v_m_per_s)",
    )
    parser.add_argument(
        "--open-choices",
        metavar="DIR",
        type=Path,
        help="folder of open_choices.py, for claim C11b: the share of its triggers",
    )
    return run_command(parser, checked(reproduce))


def checked(work: Callable[[Namespace], list[str]]) -> Callable[[Namespace], list[str]]:
    def refusing(options: Namespace) -> list[str]:
        if options.quick and options.regularised:
            raise slipfront.CaseError("--regularised excludes --quick")
        return work(options)

    return refusing


if __name__ == "__main__":
    sys.exit(main())
