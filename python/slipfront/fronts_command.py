# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront fronts ONSETS.csv`: fronts in the onsets of an experiment."""

from __future__ import annotations

import argparse
import csv
import io
from pathlib import Path

import numpy as np
import xarray as xr

from slipfront import command
from slipfront.files import DataError, Table, read_table
from slipfront.material import wave_speeds
from slipfront.measures import FrontSettings, find_fronts
from slipfront.read import require, require_ascending

COLUMNS = ("front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s")
TRACTIONS = ("t_s_Pa", "p_s_Pa")
MARK = "# fronts by slipfront fronts\n"  # by it a file is known that may be replaced
MATERIAL = ("youngs_modulus_Pa", "poissons_ratio", "density_kg_per_m3")


def parse(arguments: list[str]) -> argparse.Namespace:
    settings = FrontSettings()
    parser = command.Parser(
        prog="slipfront fronts",
        description="Finds the fronts in the times at which slip begins along an interface: speeds, ends. "
        "ONSETS.csv has the columns x_m and time_s, empty where a place never slips, perhaps t_s_Pa and "
        "p_s_Pa, the tractions before the event. Lines that start with # are passed over.",
    )
    parser.add_argument("onsets", metavar="ONSETS.csv", type=Path)
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="CSV table, a row per front and place"
    )
    add = parser.add_argument_group("how fronts are found").add_argument
    add("--l-star-m", type=float, default=settings.l_star_m, help="length for the speed (%(default)s m)")
    add("--arrest-time-s", type=float, default=settings.arrest_time_s, help="longest wait (%(default)s s)")
    add("--min-length-m", type=float, default=settings.min_length_m, help="of a front (%(default)s m)")
    add("--speed-interval", choices=("centred", "approach"), default=settings.speed_interval)
    add("--resolution-s", type=float, default=0.0, help="time between two frames; faster is not resolved")
    add("--end-time-s", type=float, help="end of the record, by default the last onset")
    speeds = parser.add_argument_group("wave speed, for V_tip/c_L: given, or of a material").add_argument
    speeds("--c-l-m-per-s", type=float, help="longitudinal wave speed")
    for name in MATERIAL:
        speeds(f"--{name.lower().replace('_', '-')}", dest=name, type=float)
    speeds("--plane", choices=("stress", "strain"), default="stress")
    return parser.parse_args(arguments)


def longitudinal_speed_m_per_s(options: argparse.Namespace) -> float | None:
    """None where neither the speed nor a material is given."""
    given = {name: getattr(options, name) for name in MATERIAL if getattr(options, name) is not None}
    if options.c_l_m_per_s is not None:
        if given:
            raise DataError("--c-l-m-per-s and a material are given; give one of them")
        if not 0 < options.c_l_m_per_s < np.inf:
            raise DataError(f"--c-l-m-per-s is {options.c_l_m_per_s}; it must be above 0 and finite")
        return float(options.c_l_m_per_s)
    if not given:
        return None
    missing = [f"--{name.lower().replace('_', '-')}" for name in MATERIAL if name not in given]
    if missing:
        raise DataError(f"a material needs {', '.join(missing)} as well")
    try:
        return wave_speeds(**given, plane=options.plane).c_L_m_per_s
    except ValueError as error:
        raise DataError(str(error)) from None


def read_onsets(file: Path) -> Table:
    table = read_table(file, by_hand=True)
    require_ascending(file, "x_m", table.numbers("x_m"))
    require(len(table.rows) >= 2, file, "fewer than two rows")
    onset = table.numbers("time_s")
    require(np.isfinite(onset).any(), file, "no row has a time: nothing slips")
    return table


def find(table: Table, options: argparse.Namespace) -> xr.Dataset:
    tractions = {name: table.numbers(name) for name in TRACTIONS if name in table.header}
    try:
        return find_fronts(
            table.numbers("x_m"),
            table.numbers("time_s"),
            t_s_Pa=tractions.get("t_s_Pa"),
            p_s_Pa=tractions.get("p_s_Pa"),
            end_time_s=options.end_time_s,
            resolution_s=options.resolution_s,
            settings=FrontSettings(
                l_star_m=options.l_star_m,
                speed_interval=options.speed_interval,
                arrest_time_s=options.arrest_time_s,
                min_length_m=options.min_length_m,
            ),
        )
    except ValueError as error:
        raise DataError(f"{table.file}: {error}") from None


def rows(fronts: xr.Dataset, c_L_m_per_s: float | None) -> str:
    """The table of points; what is undefined is empty."""
    columns = {name: fronts[name].to_numpy() for name in COLUMNS if name != "direction"}
    columns["direction"] = fronts["direction_of_point"].to_numpy()
    names = list(COLUMNS)
    if c_L_m_per_s is not None:
        columns["v_over_c_L"] = columns["v_tip_m_per_s"] / c_L_m_per_s
        names.append("v_over_c_L")
    with np.errstate(invalid="ignore", divide="ignore"):
        columns["static_ratio"] = (fronts["t_s_Pa"] / fronts["p_s_Pa"]).to_numpy()
    if np.isfinite(columns["static_ratio"]).any():
        names.append("static_ratio")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    for row in zip(*(columns[name].tolist() for name in names), strict=True):
        writer.writerow("" if value != value else repr(value) for value in row)
    return text.getvalue()


def summary(fronts: xr.Dataset, c_L_m_per_s: float | None) -> list[str]:
    """A line for each front, as `slipfront run` prints them; the kind of slip needs a history."""
    lines = []
    for k, front in enumerate(fronts["front"].to_numpy()):
        points = fronts.isel(point=fronts["front_id"].to_numpy() == front, front=k)
        x, onset = points["x_m"].to_numpy(), points["onset_s"].to_numpy()
        speeds = points["v_tip_m_per_s"].to_numpy()
        speeds = speeds[np.isfinite(speeds)]
        speed = "speed undefined"
        if speeds.size > 0:
            median = float(np.median(speeds))
            share = f" ({median / c_L_m_per_s:.2f} c_L)" if c_L_m_per_s is not None else ""
            speed = f"median speed {median:.4g} m/s{share}"
        lines.append(
            f"front {front}: x = {x[0]:.4f} to {x[-1]:.4f} m, {1e6 * onset[0]:.1f} to "
            f"{1e6 * onset[-1]:.1f} us, {speed}, ends: {points['end'].item()}"
        )
    return lines or ["no fronts: no path of onsets is as long as --min-length-m"]


def main(arguments: list[str]) -> int:
    options = parse(arguments)

    def work() -> list[str]:
        c_L_m_per_s = longitudinal_speed_m_per_s(options)
        fronts = find(read_onsets(options.onsets), options)
        if options.output is not None:
            write(options.output, rows(fronts, c_L_m_per_s))
        return summary(fronts, c_L_m_per_s)

    return command.run("slipfront fronts", work)


def write(file: Path, text: str) -> None:
    command.require_own(file, MARK.encode(), "a table of slipfront fronts")
    with command.publishing_into(file.parent) as made:
        (made / file.name).write_text(MARK + text, encoding="utf-8")
