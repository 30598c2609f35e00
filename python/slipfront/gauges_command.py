# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront gauges RECORDS`: the tips of fronts in records of strain gauges."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from slipfront import command
from slipfront.command import MATERIAL, option
from slipfront.errors import CaseError
from slipfront.files import DataError, is_folder
from slipfront.gauges import COMPONENTS, Gauge, from_arms, gauges_of, read_gauges
from slipfront.near_tip import ZONES, bodies_of
from slipfront.opened import OpenRun, open_run
from slipfront.records import each_event, is_records
from slipfront.tip_fit import TipFit, fit_front, fit_tips

MARK = "# gauges by slipfront gauges\n"  # by it a file is known that may be replaced
OF_FIT = (
    "tip_s", "tip_error_s", "speed_m_per_s", "speed_error_m_per_s", "K_Pa_sqrt_m", "Gamma_J_per_m2",
    "Gamma_error_J_per_m2", "cohesive_zone_m", "zone_low_m", "zone_high_m", "strength_drop_Pa",
)  # fmt: skip
#: Names in messages and their options.
OPTIONS = (
    "speed_m_per_s", "one_speed", "direction", "zone", "zone_m", "r_max_m", "passages", "low_pass_Hz",
    "zero_s", "window_s", "shift_s", "event",
)  # fmt: skip


def interval(text: str) -> tuple[float, float]:
    first, comma, last = text.partition(",")
    try:
        made = float(first or "-inf"), float(last or "inf")
    except ValueError:
        made = None
    if made is None or not comma:
        raise argparse.ArgumentTypeError(f"'{text}' is not FROM,TO in s; give such as 0,20e-6")
    return made


def shift(text: str) -> tuple[str | None, float]:
    """Of [GAUGE=]S."""
    name, equals, value = text.rpartition("=")
    try:
        return (name if equals else None), float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not [GAUGE=]S with S in s; give such as 2e-6 or SG3=2e-6"
        ) from None


def add_preparation(parser: argparse.ArgumentParser) -> Callable[..., Any]:
    """Options of what is done to records of gauges first, by `prepared`; returns what adds to their group."""
    add = parser.add_argument_group("preparation of the records").add_argument
    add("--shift-s", metavar="[GAUGE=]S", type=shift, action="append", default=[],
        help="added to the times of all gauges, or of one; repeatable")  # fmt: skip
    add("--zero-s", metavar="FROM,TO", type=interval, help="subtract the mean over these times")
    add("--low-pass-hz", metavar="F", type=float, help="Gaussian filter without phase; fits and runs pass it")
    add("--window-s", metavar="FROM,TO", type=interval, help="leave out all other times")
    return add


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = command.Parser(
        prog="slipfront gauges",
        description="Fits the near-tip field of a moving front to records of strain gauges, to each and to "
        "all together: fracture energy, cohesive zone, speed, time of the tip. RECORDS is a file of "
        "slipfront records, a CSV file with columns gauge, x_mm, y_mm, time_us and strain_xx, strain_yy, "
        "strain_xy or others that docs/gauges.md names, or a run's folder with probes.",
    )
    parser.add_argument("records", metavar="RECORDS", type=Path)
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help="CSV table, a row per gauge and "
                        "front")  # fmt: skip
    parser.add_argument("--figure", metavar="FILE", type=Path, help="records and fits: .png, .pdf or .svg")
    add = add_preparation(parser)
    add("--event", metavar="N", type=int, help="of a file of slipfront records: this event alone")
    add("--stress", action="store_true", help="of a run: take stress, not strain")
    add = parser.add_argument_group("fit").add_argument
    add("--speed-m-per-s", metavar="V", type=float, help="of the front; by default fitted")
    add("--one-speed", action="store_true", help="of all gauges together; by default V changes along x with "
        "the tip's times")  # fmt: skip
    add("--direction", type=int, choices=(1, -1), help="of the front along x; by default the better one")
    add("--zone", choices=ZONES, default="linear", help="how the strength falls behind the tip: linearly "
        "over the distance, the default, or over slip")  # fmt: skip
    add("--zone-m", metavar="X", type=float, help="length of the cohesive zone, 0: none; by default fitted")
    add("--r-max-m", metavar="R", type=float, help="leave out what is farther from the tip; by default 3 "
        "heights of the gauge and 2 cohesive zones")  # fmt: skip
    add("--no-step", action="store_true", help="no step of the residual stress")
    add("--passages", metavar="N", type=int, default=1, help="of fronts at each gauge")
    add = parser.add_argument_group("bodies, of a record; those of a run are its own").add_argument
    for name in MATERIAL:
        add(option(name), dest=name, type=float)
    add("--plane", choices=("stress", "strain"), help="by default stress")
    add("--base", choices=("equal", "rigid"), help="an equal body, the default, or a rigid plane")
    return parser.parse_args(arguments)


def bodies(options: argparse.Namespace, run: OpenRun | None) -> Any:
    given = {
        name: getattr(options, name) for name in (*MATERIAL, "plane") if getattr(options, name) is not None
    }
    if run is not None:
        more = [option(name) for name in (*given, *(["base"] if options.base else []))]
        if more:
            raise DataError(f"a run has its own bodies; leave out {', '.join(more)}")
        return run
    missing = [option(name) for name in MATERIAL if name not in given]
    if missing:
        raise DataError(f"a record needs its bodies: give {', '.join(missing)}")
    plain = {name: value for name, value in given.items() if name != "plane"}
    base = {"kind": "rigid"} if options.base == "rigid" else {"kind": "body", **plain}
    return {"material": given, "base": base}


def prepared(gauges: list[Any], options: argparse.Namespace) -> tuple[list[Any], list[str]]:
    """Gauges, or others that are prepared and have peaks as they do."""
    names = {gauge.name for gauge in gauges}
    for name, _ in options.shift_s:
        if name is not None and name not in names:
            has = ", ".join(sorted(names))
            raise DataError(
                f"--shift-s names the gauge '{name}', which the records do not have; it is one of {has}"
            )
    made, notes = [], []
    for gauge in gauges:
        shift_s = sum(s for name, s in options.shift_s if name in (None, gauge.name))
        own = {"zero_s": options.zero_s, "window_s": options.window_s}
        plain = gauge.prepared(shift_s=shift_s, **own)
        made.append(plain)
        if options.low_pass_hz is not None:
            made[-1] = gauge.prepared(shift_s=shift_s, low_pass_Hz=options.low_pass_hz, **own)
            kept = [made[-1].peak(part) / plain.peak(part) for part in plain.values if plain.peak(part) > 0]
            notes.append(
                f"{gauge.name}: the filter leaves {100 * min(kept, default=1):.0f} % of the lowest-kept peak"
            )
    return made, notes


def in_components(of: dict[str, float]) -> dict[str, Any]:
    """Of components or of three arms; one arm or two make none."""
    if len(of) != 3 or next(iter(of)) in COMPONENTS:
        return of
    made = from_arms({float(arm): np.array([value]) for arm, value in of.items()})
    return {part: float(value[0]) for part, value in made.items()}


def row_of(fit: TipFit, is_strain: bool) -> dict[str, Any]:
    kind = "strain_{}" if is_strain else "stress_{}_Pa"
    row: dict[str, Any] = {
        name: getattr(fit, name) for name in ("gauge", "together", "x_m", "y_m", "direction", *OF_FIT)
    }
    row |= {"residual": fit.residual_of_all}
    offset, step = in_components(fit.offset), in_components(fit.step)
    for part in COMPONENTS:
        row[f"residual_{part}"] = fit.residual.get(part, "")
        row[f"offset_{kind.format(part)}"] = offset.get(part, "")
        row[f"step_{kind.format(part)}"] = step.get(part, "")
    return row | {"times": fit.n_times, "doubts": "; ".join(fit.doubts)}


def with_error(value: float, error: float) -> str:
    """An error that is not known is left out."""
    return f"{value:.4g} +- {error:.2g}" if error == error else f"{value:.4g}"


def with_fronts_of_run(fit: TipFit, run: OpenRun) -> TipFit:
    """The fit, with the run's fronts at its gauge: those too fast for the field; without a tip all."""
    limit, fronts = bodies_of(run).limit_m_per_s, run.fronts
    if fronts.sizes.get("point", 0) == 0:
        return fit
    height_m, off_m = abs(fit.y_m), np.abs(fronts["x_m"].to_numpy() - fit.x_m)
    at = fronts.isel(point=(off_m == off_m.min()) & (off_m < height_m))
    too_fast, others = [], []
    for front, onset_s, speed in zip(
        *(at[n].to_numpy() for n in ("front_id", "onset_s", "v_tip_m_per_s")), strict=True
    ):
        told = f"front {front} passes at {1e6 * onset_s:.4g} us with {speed:.4g} m/s"
        # NaN without a tip
        if (
            speed > limit
            and not abs(onset_s - fit.tip_s) > height_m / limit
            and not fit.speed_m_per_s > limit
        ):
            too_fast.append(f"{told}, above the limiting speed, {limit:.5g} m/s: the fit does not apply")
        elif not fit.has_tip:
            others.append(f"by the run {told}" if speed == speed else f"by the run {told.split(' with')[0]}")
    if too_fast:
        return replace(fit, doubts=too_fast + fit.doubts[0 if fit.has_tip else 1 :])
    return replace(fit, doubts=fit.doubts[:1] + others + fit.doubts[1:]) if others else fit


def zone_in_words(fit: TipFit) -> str:
    zone, low, high = (1e3 * z for z in (fit.cohesive_zone_m, fit.zone_low_m, fit.zone_high_m))
    if low == 0 < high:
        return f"X_c up to {high:.3g} mm"
    if zone == 0:
        return "no cohesive zone"
    between = f" ({low:.3g} to {high:.3g})" if low < high else ""
    return f"X_c = {zone:.3g}{between} mm, tau_p - tau_r = {1e-6 * fit.strength_drop_Pa:.3g} MPa"


def line_of(fits: list[TipFit]) -> str:
    """Of a gauge, or of those that were fitted together."""
    fit, names = fits[0], ", ".join(f.gauge for f in fits)
    if not fit.has_tip:
        return in_words(f"{names}: {'; '.join(fit.doubts)}")
    to = f"front to {'+x' if fit.direction > 0 else '-x'}"
    Gamma = f"Gamma = {with_error(fit.Gamma_J_per_m2, fit.Gamma_error_J_per_m2)} J/m2, {zone_in_words(fit)}"
    residual = f"residual {100 * fit.residual_of_all:.0f} %"
    V = with_error(fit.speed_m_per_s, fit.speed_error_m_per_s)
    if len(fits) == 1:
        told = f"{names}: {to} passes at {with_error(1e6 * fit.tip_s, 1e6 * fit.tip_error_s)} us, V = {V} m/s"
    else:
        speeds = [f.speed_m_per_s for f in fits]
        V = V if f"{min(speeds):.4g}" == f"{max(speeds):.4g}" else f"{speeds[0]:.4g} to {speeds[-1]:.4g}"
        told = f"{names} together: {to}, V = {V} m/s"
    doubts = dict.fromkeys(doubt for f in fits for doubt in f.doubts)
    return in_words("; ".join([f"{told}, {Gamma}, {residual}", *doubts]))


def events_of(options: argparse.Namespace, run: OpenRun | None) -> list[tuple[str, list[Gauge]]]:
    """What stands before the lines of an event, and its gauges."""
    if run is None and is_records(options.records):
        events = [e for e in each_event(options.records) if options.event in (None, e.number)]
        if not events:
            raise DataError(f"{options.records}: has no event {options.event}")
        return [(f"event {event.number}: ", event.gauges()) for event in events]
    if options.event is not None:
        raise DataError(f"{options.records}: is no file of slipfront records: leave out --event")
    return [("", read_gauges(options.records) if run is None else gauges_of(run, stress=options.stress))]


def fitted(
    gauges: list[Gauge], options: argparse.Namespace, run: OpenRun | None
) -> tuple[list[str], list[TipFit]]:
    """Of each gauge, and of all together."""
    settings = {
        "speed_m_per_s": options.speed_m_per_s, "direction": options.direction, "zone": options.zone,
        "zone_m": options.zone_m, "r_max_m": options.r_max_m, "step": not options.no_step,
    }  # fmt: skip
    of = bodies_of(bodies(options, run))
    alone = fit_tips(gauges, of, passages=options.passages, **settings)
    fits = alone if run is None else [with_fronts_of_run(fit, run) for fit in alone]
    lines = [line_of([fit]) for fit in fits]
    if options.passages == 1 and sum(fit.has_tip for fit in alone) > 1:
        try:
            together = fit_front(gauges, of, alone=alone, one_speed=options.one_speed, **settings)
            lines.append(line_of(together))
            fits = fits + together
        except CaseError as error:
            lines.append(in_words(f"together: {error}"))
    return lines, fits


def work(options: argparse.Namespace) -> list[str]:
    run = open_run(options.records) if is_folder(options.records) else None
    if run is None and options.stress:
        raise DataError("--stress is of a run; a record holds what its columns say: leave it out")
    with warnings.catch_warnings(record=True) as passed_over:
        warnings.simplefilter("always")
        events = events_of(options, run)
    lines, notes, rows, shown = [], [str(told.message) for told in passed_over], [], []
    for head, read in events:
        gauges, told = prepared(read, options)
        notes += [head + note for note in told]
        of_event, fits = fitted(gauges, options, run)
        is_strain = {gauge.name: gauge.is_strain for gauge in gauges}
        lines += [head + line for line in of_event]
        rows += [({"event": int(head[6:-2])} if head else {}) | row_of(f, is_strain[f.gauge]) for f in fits]
        shown += [(head, gauges, fits)]
    if options.output is not None:
        text = pd.DataFrame(rows).to_csv(index=False, lineterminator="\n")
        command.write_own(options.output, MARK, text, "a table of slipfront gauges")
    if options.figure is not None and not any(f.has_tip for _, _, fits in shown for f in fits):
        notes.append(f"{options.figure}: not drawn: no gauge has a fit")
    elif options.figure is not None:
        from slipfront.figures.drawing import write_results
        from slipfront.figures.gauges import draw_fits

        notes += write_results(options.figure, options.records, lambda _: draw_fits(shown))
    return [*lines, *notes]


def in_words(text: str) -> str:
    """Options by their names on the command line."""
    return command.in_options(text, OPTIONS)


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    return command.run("slipfront gauges", lambda: command.by_options(lambda: work(options), OPTIONS))
