# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront fronts ONSETS`: fronts in the onsets of an experiment."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from slipfront import command
from slipfront.command import MATERIAL, option
from slipfront.files import DataError
from slipfront.measures import LENGTHS_AND_TIMES, FrontSettings, find_fronts, slices_of
from slipfront.onsets import NONE, read_onsets
from slipfront.running import wave_speeds

COLUMNS = ("front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s")
SPEEDS = ("speed_m_per_s", "speed_low_m_per_s", "speed_high_m_per_s")  # of the whole front
TRACTIONS = ("t_s_Pa", "p_s_Pa")
OPTIONS = (*LENGTHS_AND_TIMES, "never_slipped", "place_error_m", "time_error_s")  # by their names in Python
SLOW = 1e-3  # of a wave speed: ruptures run at 0.01 and more of it; fronts below it creep
MARK = "# fronts by slipfront fronts\n"  # by it a file is known that may be replaced


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = command.Parser(
        prog="slipfront fronts",
        description="Finds the fronts in the times at which slip begins along an interface: speeds, ends. "
        "ONSETS, a CSV or .mat file, has columns of places and times with their units, such as x_mm and "
        "time_us, and perhaps t_s_MPa and p_s_MPa, the tractions before the event. Lines that start with # "
        "are passed over.",
    )
    parser.add_argument("onsets", metavar="ONSETS", type=Path)
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="CSV table, a row per front and place"
    )
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
    add("--time-error-s", type=float, help="the same of times; one alone: the other is exact")
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


def find(file: Path, options: argparse.Namespace) -> xr.Dataset:
    record = read_onsets(file, never_slipped=options.never_slipped)
    tractions = {name: record[name].to_numpy() for name in TRACTIONS if name in record}
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
            time_error_s=options.time_error_s,
            settings=FrontSettings(
                l_star_m=options.l_star_m,
                speed_interval=options.speed_interval,
                arrest_time_s=options.arrest_time_s,
                min_length_m=options.min_length_m,
            ),
        )
    except ValueError as error:
        raise DataError(f"{file}: {in_words(str(error))}") from None
    own = [note for note in found.attrs["notes"] if "without a time" not in note]  # the record says so
    found.attrs["notes"] = record.attrs["notes"] + own
    return found


def rows(fronts: xr.Dataset, c_L_m_per_s: float | None) -> str:
    """The table of points; what is undefined is empty."""
    columns = {name: fronts[name].to_numpy() for name in COLUMNS if name != "direction"}
    columns["direction"] = fronts["direction_of_point"].to_numpy()
    sizes = [part.stop - part.start for part in slices_of(fronts)]
    columns |= {name: np.repeat(fronts[name].to_numpy(), sizes) for name in SPEEDS}
    names = [*COLUMNS, *SPEEDS]
    if c_L_m_per_s is not None:
        columns["v_over_c_L"] = columns["v_tip_m_per_s"] / c_L_m_per_s
        names.append("v_over_c_L")
    with np.errstate(invalid="ignore", divide="ignore"):
        columns["static_ratio"] = (fronts["t_s_Pa"] / fronts["p_s_Pa"]).to_numpy()
    if np.isfinite(columns["static_ratio"]).any():
        names.append("static_ratio")
    return pd.DataFrame(columns)[names].to_csv(index=False, lineterminator="\n")


def in_words(text: str) -> str:
    """Options by their names on the command line."""
    return command.in_options(text, OPTIONS)


def speed_in_words(speed_and_interval: np.ndarray, of_waves: dict[str, float]) -> str:
    speed, low, high = speed_and_interval
    if not np.isfinite(speed):
        return "speed undefined"
    of_each = {name: speed / of_wave for name, of_wave in of_waves.items()}
    shares = ", ".join(
        f"{share:.2f} {n}" if share >= 0.1 else f"{share:.2g} {n}" for n, share in of_each.items()
    )
    share = f" ({shares})" if shares else ""
    above = f" to {high:.4g}" if np.isfinite(high) else " or more"
    interval = f", {low:.4g}{above}" if f"{low:.4g}" != f"{high:.4g}" else ""
    return f"speed {speed:.4g} m/s{interval}{share}"


def summary(fronts: xr.Dataset, of_waves: dict[str, float]) -> list[str]:
    """A line for each front, as `slipfront run` prints them; the kind of slip needs a history."""
    x, onset = fronts["x_m"].to_numpy(), fronts["onset_s"].to_numpy()
    speeds = np.array([fronts[name].to_numpy() for name in SPEEDS]).T
    ends = fronts["end"].to_numpy()
    notes = list(fronts.attrs["notes"])
    if not ends.size and any(note.startswith("no fronts: ") for note in notes):
        return [in_words(note) for note in notes]
    lines = [
        f"front {k}: x = {x[part.start]:.4f} to {x[part.stop - 1]:.4f} m, {1e6 * onset[part.start]:.1f} to "
        f"{1e6 * onset[part.stop - 1]:.1f} us, {speed_in_words(speed, of_waves)}, ends: {end}"
        for k, (part, speed, end) in enumerate(zip(slices_of(fronts), speeds, ends, strict=True))
    ]
    for k, line in enumerate(lines):  # doubts stand behind what they are about
        of_front = [note for note in notes if note.startswith(f"front {k}: ")]
        lines[k] = "; ".join([line, *(note.removeprefix(f"front {k}: ") for note in of_front)])
        notes = [note for note in notes if note not in of_front]
    used = fronts.attrs
    step = used["time_step_s"]
    lines.append(
        ", ".join(f"{name} {used[name]:.4g}" for name in LENGTHS_AND_TIMES)
        + (f"; intervals of speeds: times right to half of {step:.4g} s" if step > 0 else "")
    )
    if "c_L" in of_waves and (speeds[:, 0] > of_waves["c_L"]).any():
        notes.append(
            "a speed is above c_L: check the units of x and time; onsets may not be those of one front"
        )
    slowest = "c_S" if "c_S" in of_waves else "c_L"
    if of_waves and (speeds[:, 0] < SLOW * of_waves[slowest]).any():
        notes.append(
            f"a speed is below {SLOW:g} {slowest}: check the units of x and time, unless slip creeps"
        )
    return [in_words(line) for line in [*(lines if ends.size else ["no fronts", *lines]), *notes]]


def main(arguments: list[str]) -> int:
    options = parse(arguments)

    def work() -> list[str]:
        of_waves = wave_speeds_of(options)
        fronts = find(options.onsets, options)
        if options.output is not None:
            table = rows(fronts, of_waves.get("c_L"))
            command.write_own(options.output, MARK, table, "a table of slipfront fronts")
        return summary(fronts, of_waves)

    return command.run("slipfront fronts", work)
