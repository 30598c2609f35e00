# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront fronts ONSETS`: fronts in the onsets of an experiment, of one event or a series."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from slipfront import command
from slipfront.command import MATERIAL, option
from slipfront.files import DataError, open_file
from slipfront.measures import LENGTHS_AND_TIMES, FrontSettings, find_fronts, slices_of
from slipfront.onsets import NONE, n_places, read_each
from slipfront.running import wave_speeds
from slipfront.stretches import speed_stretches

COLUMNS = ("front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s")
SPEEDS = ("speed_m_per_s", "speed_low_m_per_s", "speed_high_m_per_s")  # of a whole front, or a stretch
OF_SERIES = ("event", "front", "stretch", "x_from_m", "x_to_m", "onsets", *SPEEDS, "direction", "type")
TRACTIONS = ("t_s_Pa", "p_s_Pa")
OPTIONS = (*LENGTHS_AND_TIMES, "never_slipped", "place_error_m", "time_error_s")  # by their names in Python
SLOW = 1e-3  # of a wave speed: ruptures run at 0.01 and more of it; fronts below it creep
HDF5 = b"\x89HDF\r\n\x1a\n"  # with which records.nc begins
#: By these files are known that may be replaced.
MARK, SERIES_MARK = "# fronts by slipfront fronts\n", "# series by slipfront fronts\n"


@dataclass(frozen=True)
class Found:
    """Fronts of an event; its number is None in a record without events."""

    event: int | None
    record: xr.Dataset
    fronts: xr.Dataset
    stretches: xr.Dataset


def places(text: str) -> tuple[float, float]:
    first, comma, last = text.partition(",")
    try:
        made = float(first or "-inf"), float(last or "inf")
    except ValueError:
        made = (np.nan, np.nan)
    if not comma or not made[0] < made[1]:
        raise argparse.ArgumentTypeError(f"'{text}' is not FROM,TO in m, ascending; give such as 0.5,2")
    return made


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = command.Parser(
        prog="slipfront fronts",
        description="Finds the fronts in the times at which slip begins along an interface: speeds, ends. "
        "ONSETS, a CSV or .mat file, has columns of places and times with their units, such as x_mm and "
        "time_us, and perhaps error_us, event, t_s_MPa and p_s_MPa, the tractions before the event. Lines "
        "that start with # are passed over. Several files: one an event, of the last number in its name. "
        "Or records.nc of slipfront records, picked as slipfront picks does.",
    )
    parser.add_argument("onsets", metavar="ONSETS", type=Path, nargs="+")
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="CSV table, a row per front and place"
    )
    parser.add_argument("--series", metavar="FILE", type=Path, help="CSV table, a row per event, front and "
                        "stretch of one speed")  # fmt: skip
    parser.add_argument("--figure", metavar="FILE", type=Path, help="the fronts and speeds of all events: "
                        ".png, .pdf or .svg")  # fmt: skip
    parser.add_argument("--event", metavar="N", type=int, help="this one alone")
    parser.add_argument("--x-range", metavar="FROM,TO", type=places, help="places, in m, that count")
    add = parser.add_argument_group("how fronts are found; by default as the record suggests").add_argument
    add("--l-star-m", type=float, help="length for v_tip; by default the median spacing")
    add("--arrest-time-s", type=float, help="longest wait of a tip; by default 5 times what a front takes "
        "for its least length or the largest gap")  # fmt: skip
    add("--min-length-m", type=float, help="of a front; by default 2 median spacings, of two "
        "places their distance")  # fmt: skip
    add("--speed-interval", choices=("centred", "approach"), default="centred")
    add("--resolution-s", type=float, help="time between two frames; faster is not resolved")
    add("--end-time-s", type=float, help="end of the record, by default the last onset")
    add("--place-error-m", type=float, help="standard error of places, by which the line of a speed weighs "
        "them; by default it favours neither places nor times")  # fmt: skip
    add("--time-error-s", type=float, help="the same of times; one alone: the other is exact; by default "
        "the column error of ONSETS, where it has one")  # fmt: skip
    add("--never-slipped", metavar="TIME", type=mark, help="what the file has in place of a time where "
        "slip never begins, or none; by default -1, 999, 1e9 and the like if far from all times")  # fmt: skip
    speeds = parser.add_argument_group("wave speed, for V_tip/c_L: given, or of a material").add_argument
    speeds("--c-l-m-per-s", type=float, help="longitudinal wave speed")
    for name in MATERIAL:
        speeds(option(name), dest=name, type=float)
    speeds("--plane", choices=("stress", "strain"), help="of the material; by default stress")
    return parser.parse_args(arguments)


def wave_speeds_of(options: argparse.Namespace) -> dict[str, float]:
    """By their names; empty where neither the speed nor a material is given."""
    given = {name: getattr(options, name) for name in MATERIAL if getattr(options, name) is not None}
    if options.c_l_m_per_s is not None:
        if given:
            raise DataError("--c-l-m-per-s and a material are given; give one of them")
        if not 0 < options.c_l_m_per_s < np.inf:
            raise DataError(f"--c-l-m-per-s is {options.c_l_m_per_s}; it must be above 0 and finite")
        return {"c_L": float(options.c_l_m_per_s)}
    if not given:
        if options.plane is not None:
            raise DataError("--plane counts with a material alone; give one, or leave it out")
        return {}
    missing = [option(name) for name in MATERIAL if name not in given]
    if missing:
        raise DataError(f"a material needs {', '.join(missing)} as well")
    try:
        found = wave_speeds(**given, plane=options.plane or "stress")
    except ValueError as error:
        raise DataError(str(error)) from None
    return {name: getattr(found, f"{name}_m_per_s") for name in ("c_L", "c_S", "c_R")}


def mark(text: str) -> float | str:
    return NONE if text == NONE else float(text)


def is_of_records(file: Path) -> bool:
    with open_file(file) as stream:
        return stream.read(len(HDF5)) == HDF5


def records_of(options: argparse.Namespace, notes: list[str]) -> dict[int | None, tuple[Path, xr.Dataset]]:
    """What is known of each event, by its number, and of which file."""
    files: list[Path] = options.onsets
    found: dict[int | None, tuple[Path, xr.Dataset]] = {}
    for file in files:
        if is_of_records(file):
            from slipfront.picks import onsets_of, pick_events
            from slipfront.records import each_event

            picks = pick_events(each_event(file))
            notes += picks.attrs["notes"]
            each = onsets_of(picks)
        else:
            each = read_each(file, options.never_slipped)
        if len(files) > 1 and None in each:
            numbers = re.findall(r"\d+", file.stem)
            if not numbers:
                raise DataError(f"{file}: no number in its name, which would be its event's")
            each = {int(numbers[-1]): each[None]}
        for number, record in each.items():
            if number in found:
                raise DataError(f"{file}: event {number} is in {found[number][0]}, too; give one of them")
            found[number] = file, record
    if options.event is None:
        return dict(sorted(found.items(), key=lambda one: one[0] or 0))
    if options.event not in found:
        has = "no events" if None in found else ", ".join(f"{k}" for k in sorted(k for k in found if k))
        raise DataError(f"{files[0]}: has no event {options.event}; it has {has or 'none'}")
    return {options.event: found[options.event]}


def find(file: Path, event: int | None, record: xr.Dataset, options: argparse.Namespace) -> Found:
    where = f"{file}" if event is None else f"{file}: event {event}"
    notes = list(record.attrs["notes"])
    if options.x_range is not None:
        first, last = options.x_range
        inside = (record["x_m"] >= first) & (record["x_m"] <= last)
        record = record.isel(node=inside.to_numpy())
    tractions = {name: record[name].to_numpy() for name in TRACTIONS if name in record}
    error_s = options.time_error_s
    if error_s is None and "error_s" in record:
        error_s = record["error_s"].to_numpy()
    try:
        found = find_fronts(
            record["x_m"].to_numpy(),
            record["onset_s"].to_numpy(),
            t_s_Pa=tractions.get("t_s_Pa"),
            p_s_Pa=tractions.get("p_s_Pa"),
            end_time_s=options.end_time_s,
            resolution_s=options.resolution_s,
            never_slipped=NONE,
            place_error_m=options.place_error_m,
            time_error_s=error_s,
            settings=FrontSettings(
                l_star_m=options.l_star_m,
                speed_interval=options.speed_interval,
                arrest_time_s=options.arrest_time_s,
                min_length_m=options.min_length_m,
            ),
        )
        parts = speed_stretches(found, place_error_m=options.place_error_m, time_error_s=error_s)
    except ValueError as error:
        raise DataError(f"{where}: {in_words(str(error))}") from None
    own = [note for note in found.attrs["notes"] if "without a time" not in note]  # the record says so
    found.attrs["notes"] = notes + own
    return Found(event, record, found, parts)


def found_in(options: argparse.Namespace, notes: list[str]) -> Iterator[Found]:
    """Fronts of each event; those of which fewer than two onsets are known are told."""
    known = records_of(options, notes)
    for event, (file, record) in known.items():
        x = record["x_m"].to_numpy()[np.isfinite(record["onset_s"].to_numpy())]
        first, last = options.x_range or (-np.inf, np.inf)
        n = int(((x >= first) & (x <= last)).sum())
        if n >= 2:
            yield find(file, event, record, options)
        elif len(known) == 1:
            where = f" from {first:g} to {last:g} m" if options.x_range else ""
            raise DataError(f"{file}: {n_places(n)} with an onset{where}: no front")
        else:
            notes.append(f"event {event}: no fronts: {n_places(n)} with an onset")


def is_parted(found: Found) -> bool:
    return found.stretches.sizes["stretch"] > found.fronts.sizes["front"]


def number_in_front(parts: xr.Dataset) -> np.ndarray:
    """Of each stretch, from 0 in each front."""
    front = parts["front"].to_numpy()
    return np.arange(len(front)) - np.searchsorted(front, front)


def rows(found: list[Found], c_L_m_per_s: float | None) -> str:
    """The table of points; what is undefined is empty. Events and stretches have columns where there are
    any."""
    tables = []
    for of in found:
        fronts, parts = of.fronts, of.stretches
        columns = {name: fronts[name].to_numpy() for name in COLUMNS if name != "direction"}
        columns["direction"] = fronts["direction_of_point"].to_numpy()
        sizes = [part.stop - part.start for part in slices_of(fronts)]
        columns |= {name: np.repeat(fronts[name].to_numpy(), sizes) for name in SPEEDS}
        at = parts["stretch_of_point"].to_numpy()
        columns["event"] = np.full(len(at), of.event)
        columns["stretch"] = number_in_front(parts)[at]
        columns |= {f"stretch_{name}": parts[name].to_numpy()[at] for name in SPEEDS}
        if c_L_m_per_s is not None:
            columns["v_over_c_L"] = columns["v_tip_m_per_s"] / c_L_m_per_s
        with np.errstate(invalid="ignore", divide="ignore"):
            columns["static_ratio"] = (fronts["t_s_Pa"] / fronts["p_s_Pa"]).to_numpy()
        tables.append(pd.DataFrame(columns))
    table = pd.concat(tables, ignore_index=True)
    names = [*COLUMNS, *SPEEDS]
    if any(of.event is not None for of in found):
        names.insert(0, "event")
    if any(map(is_parted, found)):
        names += ["stretch", *(f"stretch_{name}" for name in SPEEDS)]
    if c_L_m_per_s is not None:
        names.append("v_over_c_L")
    if np.isfinite(table["static_ratio"]).any():
        names.append("static_ratio")
    return table[names].to_csv(index=False, lineterminator="\n")


def series(found: list[Found]) -> str:
    """The table of stretches."""
    tables = [
        pd.DataFrame({name: of.stretches[name].to_numpy() for name in OF_SERIES
                      if name not in ("event", "stretch", "type")}
                     | {"event": of.event, "stretch": number_in_front(of.stretches),
                        "type": of.stretches.attrs["type"]})
        for of in found
    ]  # fmt: skip
    return pd.concat(tables)[list(OF_SERIES)].to_csv(index=False, lineterminator="\n")


def in_words(text: str) -> str:
    """Options by their names on the command line."""
    return command.in_options(text, OPTIONS)


def speed_in_words(speed_and_interval: np.ndarray, of_waves: dict[str, float]) -> str:
    speed, low, high = speed_and_interval
    if not np.isfinite(speed):
        return "undefined"
    of_each = {name: speed / of_wave for name, of_wave in of_waves.items()}
    shares = ", ".join(
        f"{share:.2f} {n}" if share >= 0.1 else f"{share:.2g} {n}" for n, share in of_each.items()
    )
    share = f" ({shares})" if shares else ""
    above = f" to {high:.4g}" if np.isfinite(high) else " or more"
    interval = f", {low:.4g}{above}" if f"{low:.4g}" != f"{high:.4g}" else ""
    return f"{speed:.4g} m/s{interval}{share}"


def border_in_words(before: xr.Dataset, behind: xr.Dataset) -> str:
    """What happens between two stretches of a front. Where their speeds may be the same the tip waits there,
    or slip begins ahead of it."""
    low, high = (max if name == SPEEDS[1] else min for name in SPEEDS[1:])
    differ = low(float(before[SPEEDS[1]]), float(behind[SPEEDS[1]])) > high(
        float(before[SPEEDS[2]]), float(behind[SPEEDS[2]])
    )
    wait_s = float(behind["wait_s"])
    what = "speed changes" if differ else f"{'waits' if wait_s > 0 else 'jumps ahead'} {abs(wait_s):.2g} s"
    return f"{what} at x = {(float(before['x_to_m']) + float(behind['x_from_m'])) / 2:.4f} m"


def front_in_words(found: Found, k: int, of_waves: dict[str, float]) -> str:
    """The speed of a front, or those of its stretches."""
    own = found.stretches.isel(stretch=found.stretches["front"].to_numpy() == k)
    each = [own.isel(stretch=i) for i in range(own.sizes["stretch"])]
    speeds = [speed_in_words(np.array([float(of[name]) for name in SPEEDS]), of_waves) for of in each]
    if len(each) == 1:
        return f"speed {speeds[0]}"
    borders = [border_in_words(*pair) for pair in zip(each, each[1:], strict=False)]
    told = " and ".join(borders).replace(" m and speed changes", " m and")
    return f"{told}: {', then '.join(speeds)}"


def notes_and_lines(found: Found, of_waves: dict[str, float]) -> tuple[list[str], list[str]]:
    """A line for each front, as `slipfront run` prints them (the kind of slip needs a history), with its
    doubts, and what else is to be said."""
    fronts = found.fronts
    x, onset = fronts["x_m"].to_numpy(), fronts["onset_s"].to_numpy()
    lines = [
        f"front {k}: x = {x[part.start]:.4f} to {x[part.stop - 1]:.4f} m, {1e6 * onset[part.start]:.1f} to "
        f"{1e6 * onset[part.stop - 1]:.1f} us, {front_in_words(found, k, of_waves)}, ends: {end}"
        for k, (part, end) in enumerate(zip(slices_of(fronts), fronts["end"].to_numpy(), strict=True))
    ]
    notes = list(fronts.attrs["notes"])
    own = found.stretches["front"].to_numpy()
    for k, line in enumerate(lines):  # doubts stand behind what they are about
        of_front = [note for note in notes if note.startswith(f"front {k}: ")]
        notes = [note for note in notes if note not in of_front]
        if (own == k).sum() > 1:
            of_front = [note for note in of_front if "no one speed" not in note]
        lines[k] = "; ".join([line, *(note.removeprefix(f"front {k}: ") for note in of_front)])
    speeds = found.stretches[SPEEDS[0]].to_numpy()
    if "c_L" in of_waves and (speeds > of_waves["c_L"]).any():
        notes.append(
            "a speed is above c_L: check the units of x and time; onsets may not be those of one front"
        )
    slowest = "c_S" if "c_S" in of_waves else "c_L"
    if of_waves and (speeds < SLOW * of_waves[slowest]).any():
        notes.append(
            f"a speed is below {SLOW:g} {slowest}: check the units of x and time, unless slip creeps"
        )
    return notes, lines


def settings_in_words(found: list[Found]) -> str:
    """Lengths and times used, with their range over events."""

    def words(values: list[float]) -> str:
        low, high = f"{min(values):.4g}", f"{max(values):.4g}"
        return low if low == high else f"{low} to {high}"

    used = {
        name: words([of.fronts.attrs[name] for of in found]) for name in (*LENGTHS_AND_TIMES, "time_step_s")
    }
    step = used.pop("time_step_s")
    told = ", ".join(f"{name} {text}" for name, text in used.items())
    return told + (f"; intervals of speeds: times right to half of {step} s" if step != "0" else "")


def summary(found: list[Found], of_waves: dict[str, float]) -> list[str]:
    """Of one event a line a front; of several a line an event."""
    if len(found) == 1 and found[0].event is None:
        (of,) = found
        notes, lines = notes_and_lines(of, of_waves)
        if not lines and any(note.startswith("no fronts: ") for note in notes):
            return [in_words(note) for note in notes]
        return [in_words(line) for line in [*(lines or ["no fronts"]), settings_in_words(found), *notes]]
    told = []
    for of in found:
        notes, lines = notes_and_lines(of, of_waves)
        kind = of.stretches.attrs["type"] or (
            "" if any("no fronts" in note for note in notes) else "no fronts"
        )
        told.append(f"event {of.event}: " + "; ".join(part for part in (kind, *lines, *notes) if part))
    return [in_words(line) for line in [*told, settings_in_words(found)]]


def main(arguments: list[str]) -> int:
    options = parse(arguments)

    def work() -> list[str]:
        of_waves = wave_speeds_of(options)
        if options.figure is not None:
            from slipfront.figures.drawing import checked

            checked(options.figure)
        notes: list[str] = []
        found = list(found_in(options, notes))
        if not found:
            raise DataError(f"{options.onsets[0]}: {notes[-1] if notes else 'no onsets'}")
        if options.output is not None:
            table = rows(found, of_waves.get("c_L"))
            command.write_own(options.output, MARK, table, "a table of slipfront fronts")
        if options.series is not None:
            command.write_own(options.series, SERIES_MARK, series(found), "a series of slipfront fronts")
        lines = summary(found, of_waves) + notes
        if options.figure is not None:
            from slipfront.figures.drawing import write_results
            from slipfront.figures.front_series import draw_series

            lines += write_results(options.figure, options.onsets[0], lambda _: draw_series(found))
        return lines

    return command.run("slipfront fronts", work)
