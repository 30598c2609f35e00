# SPDX-License-Identifier: BSD-3-Clause
"""What a page's plots of a run are drawn from, as values of JSON, in the units of `units_of`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipfront.figures.balance import TERMS
from slipfront.figures.main_fronts import away_from_trigger, counted, drawn_fronts, main_fronts, start
from slipfront.figures.style import DIRECTION_COLOURS
from slipfront.files import is_number
from slipfront.opened import OpenRun
from slipfront.read import Balance, Fields, Front, even, ratio
from slipfront.report.history import ThinHistory
from slipfront.report.numbers import Unit, listed, packed, packed_bytes, unit
from slipfront.report.picture_grid import codes, pixel_grid
from slipfront.report.setup import is_uniform
from slipfront.units import quantity

WAVES = ("c_L", "c_S", "c_R")
HIGHEST_V = (
    3.0  # over c_L: the axis ends there at the latest, as the speed diverges where fronts nucleate or meet
)
LARGEST_RISE = 5.0  # of the energy as well, where the stored energy vanishes
MOST_FRAMES = 40
STRIPED = (
    "damping_work",
    "contact_work",
    "boundary_work",
    "coupling_work",
)  # beside a plain term of similar colour
MOVES = 0.1  # of the scale's end, from which something is seen to move in a snapshot


@dataclass(frozen=True)
class FrontLook:
    """How a front is named and drawn; symbols are Plotly's."""

    label: str
    colour: str
    symbol: str


Look = Callable[[OpenRun, Front], FrontLook]
Units = dict[str, Unit]


def look_by_direction(run: OpenRun, front: Front) -> FrontLook:
    """Filled markers are fronts to -x, open ones those to +x, as in all figures."""
    colour = DIRECTION_COLOURS[front.direction]
    if front.direction < 0:
        return FrontLook(f"front {front.id}, to −x", colour, "circle")
    return FrontLook(f"front {front.id}, to +x", colour, "square-open")


def units_of(history: ThinHistory) -> Units:
    return {
        "x": unit("length", np.ptp(history.x_m)),
        "time": unit("time", history.time_s),
        "slip": unit("slip", history.slip_m),
        "traction": unit("traction", np.concatenate([history.t_Pa, history.p_Pa])),
        "speed": unit("speed", 0.0),
    }


def history_data(history: ThinHistory, units: Units) -> dict[str, Any]:
    return {
        "x": listed(history.x_m, units["x"].factor),
        "time": listed(history.time_s, units["time"].factor),
        "slip_rate": packed(history.slip_rate_m_per_s),
        "slip": packed(units["slip"].factor * history.slip_m),
        "t": packed(units["traction"].factor * history.t_Pa),
        "p": packed(units["traction"].factor * history.p_Pa),
    }


def coefficients(run: OpenRun, units: Units) -> list[dict[str, Any]]:
    """mu_s and mu_k along x, where the law has them: of the nodes where they vary, else of the case."""
    found = []
    for key in ("mu_s", "mu_k"):
        constant = run.entry("friction", key)
        if key in run.tractions:
            x, values = run.x_m, run.tractions[key].to_numpy()
        elif is_number(constant):
            x, values = run.x_m[[0, -1]], np.full(2, float(constant))
        else:
            continue
        found.append({"name": key, "x": listed(x, units["x"].factor), "values": listed(values)})
    return found


def front_data(run: OpenRun, front: Front, units: Units, look: Look) -> dict[str, Any]:
    """Points in the order of travel; what belongs to no criterion next to a trigger is null."""
    shown = away_from_trigger(run, front.x_m)
    drawn = look(run, front)
    is_main = front in main_fronts(run)
    count = counted(run, front) & shown if is_main else np.full(len(front.x_m), False)

    def beyond(values: np.ndarray) -> list[float | None]:
        return listed(np.where(shown, values, np.nan))

    return {
        "id": front.id,
        "label": drawn.label,
        "colour": drawn.colour,
        "symbol": drawn.symbol,
        "direction": front.direction,
        "main": is_main,
        "counts": [int(c) for c in count],
        "x": listed(front.x_m, units["x"].factor),
        "time": listed(front.onset_s, units["time"].factor),
        "v": beyond(front.v_tip_m_per_s / run.c_L_m_per_s),
        "static": beyond(front.static_ratio),
        "dynamic": beyond(front.dynamic_ratio),
        "rise": beyond(front.energy_rise),
    }


def wave_speeds(run: OpenRun) -> dict[str, float]:
    """By name, m/s: of the plate; of two bodies of different speeds also of the base, and the generalised
    Rayleigh speed of both."""
    speeds = {wave: run.fact(f"wave_speeds.{wave}_m_per_s") for wave in WAVES}
    below = run.info.get("base")
    if not isinstance(below, dict):
        return speeds
    joint: Any = below.get("generalised_rayleigh_speed_m_per_s")
    if is_number(joint) and not np.isclose(joint, speeds["c_R"], rtol=1e-3):
        speeds["c_GR"] = float(joint)
    of_base = {wave: run.fact(f"base.wave_speeds.{wave}_m_per_s") for wave in ("c_L", "c_S")}
    if any(not np.isclose(v, speeds[wave], rtol=1e-3) for wave, v in of_base.items()):
        speeds |= {f"{wave} of the base": v for wave, v in of_base.items()}
    return speeds


def wave_data(run: OpenRun, units: Units) -> list[dict[str, Any]]:
    """Speeds over c_L of the plate, and in the units of the space-time diagram."""
    per_unit = units["x"].factor / units["time"].factor
    return [
        {"name": wave, "over_c_L": speed / run.c_L_m_per_s, "slope": speed * per_unit, "m_per_s": speed}
        for wave, speed in wave_speeds(run).items()
    ]


CONSTANT = 1e-3  # relative spread below which a field is told in words: half a unit of its third digit


def constant_fields(histories: list[ThinHistory]) -> dict[str, str]:
    """Fields along the interface that are the same everywhere in all runs, by what to say of each."""

    def told(name: str, quantity_of: Callable[[ThinHistory], np.ndarray], unit: str) -> str | None:
        fields = [quantity_of(history) for history in histories]
        finite = np.concatenate([values[np.isfinite(values)] for values in fields])
        if len(finite) == 0:
            return f"{name} is nowhere defined: the contact is open."
        low, high = float(finite.min()), float(finite.max())
        if high - low > CONSTANT * max(abs(low), abs(high)):
            return None
        complete = all(np.isfinite(values).all() for values in fields)
        where = "everywhere and at all times" if complete else "wherever the contact is closed"
        return f"{name} is {quantity(high, unit, 3)} {where}."

    found = {
        "slip_rate": told("The slip rate", lambda h: h.slip_rate_m_per_s, "m/s"),
        "ratio": told("t/p", lambda h: ratio(h.t_Pa, h.p_Pa), "1"),
        "p": told("The pressure p", lambda h: h.p_Pa, "Pa"),
        # Rounding alone moves nodes that do not slip.
        "slip": told("The slip", lambda h: h.slip_m if h.slip_rate_m_per_s.any() else 0 * h.slip_m, "m"),
    }
    return {field: words for field, words in found.items() if words is not None}


MEASURES = ("x", "static", "dynamic", "rise")


def panels(fronts: list[dict[str, Any]]) -> list[str]:
    """Measures over which the fronts' speeds are worth a panel: they differ between points."""

    def values(measure: str) -> list[float]:
        return [
            v for f in fronts for v, speed in zip(f[measure], f["v"], strict=True) if None not in (v, speed)
        ]

    found = {measure: values(measure) for measure in MEASURES}
    return [m for m, v in found.items() if v and max(v) - min(v) > CONSTANT * max(map(abs, v))]


def given_to_the_rest(balance: Balance) -> dict[str, np.ndarray]:
    """What each term gives to all others since the start, J/m; the sum is minus the imbalance."""
    stored = ("strain", "kinetic", "machine")
    return {term: -values if term in stored else values for term, values in balance.terms.items()}


def energy_data(balance: Balance, units: Units) -> dict[str, Any]:
    largest = balance.largest_J_per_m or 1.0
    given = {term: values for term, values in given_to_the_rest(balance).items() if values.any()}
    return {
        "time": listed(balance.time_s, units["time"].factor),
        "largest": largest,
        "terms": [
            {
                "label": TERMS[term][0],
                "colour": TERMS[term][1],
                "striped": term in STRIPED,
                "values": listed(values),
            }
            for term, values in given.items()
        ],
        "imbalance": listed(np.abs(balance.imbalance_J_per_m) / largest),
        "coupling": listed(np.abs(balance.terms["coupling_work"]) / largest),
    }


def tips_at(run: OpenRun, time_s: float, units: Units, look: Look) -> list[dict[str, Any]]:
    found = []
    for front in drawn_fronts(run):
        tip_m = front.tip_m(time_s)
        if tip_m is not None:
            drawn = look(run, front)
            tip = {"x": tip_m * units["x"].factor, "direction": front.direction}
            found.append(tip | {"label": drawn.label, "colour": drawn.colour})
    return found


def opening_s(run: OpenRun, history: ThinHistory) -> float:
    """The time that a page shows first: when the first of the main fronts is half-way; without any, that of
    the largest slip rate."""
    fronts = main_fronts(run) or drawn_fronts(run)
    if fronts:
        return float(min(0.5 * (front.onset_s[0] + front.onset_s[-1]) for front in fronts))
    fastest = np.argmax(np.max(np.abs(history.slip_rate_m_per_s), axis=1))
    return float(history.time_s[fastest])


def opening_frame(time_s: np.ndarray, fastest: np.ndarray, largest: float, wanted_s: float) -> int:
    """Of the snapshots in which something is seen to move, the one nearest to a time."""
    moving = np.flatnonzero(fastest >= MOVES * largest)
    candidates = moving if len(moving) > 0 else np.arange(len(time_s))
    return int(candidates[np.argmin(np.abs(time_s[candidates] - wanted_s))])


def snapshot_data(run: OpenRun, fields: Fields, units: Units, look: Look, wanted_s: float) -> dict[str, Any]:
    """Speed of the particles in every snapshot, or in MOST_FRAMES of them."""
    grid = pixel_grid(fields)
    steps = even(len(fields.time_s), MOST_FRAMES).tolist()
    pictures = [grid.means(fields.speed_m_per_s(step)) for step in steps]
    # The scale leaves out the fastest thousandth, of the pixels of the fastest picture.
    fastest = np.array([np.nanquantile(picture, 0.999) for picture in pictures])
    still = not fastest.any()
    largest = float(np.max(fastest)) or 1.0
    return {
        "still": still,
        "x": listed(grid.x_m, units["x"].factor),
        "y": listed(grid.y_m, units["x"].factor),
        "two_bodies": bool(grid.y_m[0] < 0),
        "largest": largest,
        "of": len(fields.time_s),
        "opening": opening_frame(fields.time_s[steps], fastest, largest, wanted_s),
        "frames": [
            {
                "time": fields.time_s[step] * units["time"].factor,
                "codes": packed_bytes(codes(picture, largest)),
                "tips": tips_at(run, fields.time_s[step], units, look),
            }
            for step, picture in zip(steps, pictures, strict=True)
        ],
    }


def ratio_limit(run: OpenRun, history: ThinHistory) -> float:
    """End of the axis of t/p: it goes to infinity where the contact opens."""
    mu_s = run.entry("friction", "mu_s")
    static = run.static_ratio[np.isfinite(run.static_ratio)]
    moving = ratio(history.t_Pa, history.p_Pa)
    quantiles = np.nanquantile(np.abs(moving), 0.99) if np.isfinite(moving).any() else 0.0
    known = (
        [1.15 * mu_s] if is_number(mu_s) else [float(np.max(np.abs(static), initial=0.0)), float(quantiles)]
    )
    return max(known) or 1.0


def has_snapshots(run: OpenRun) -> bool:
    return run.fields is not None and len(run.fields.time_s) > 0


def run_data(
    run: OpenRun, history: ThinHistory, look: Look = look_by_direction, name: str = ""
) -> dict[str, Any]:
    """All that a run's plots show; `name` is what a page with several runs calls it."""
    units, began = units_of(history), start(run)
    opening = opening_s(run, history)
    origin = None if began is None else [began[0] * units["x"].factor, began[1] * units["time"].factor]
    snapshots = run.fields if has_snapshots(run) else None
    fronts = [front_data(run, front, units, look) for front in drawn_fronts(run)]
    return {
        "name": name,
        "units": {quantity: unit.name for quantity, unit in units.items()},
        "history": history_data(history, units),
        "static": {
            "x": listed(run.x_m, units["x"].factor),
            "ratio": listed(run.static_ratio),
            "coefficients": coefficients(run, units),
        },
        "ratio_limit": ratio_limit(run, history),
        "waves": wave_data(run, units),
        "origin": origin,
        "opening": opening * units["time"].factor,
        "highest_v": HIGHEST_V,
        "largest_rise": LARGEST_RISE,
        "fronts": fronts,
        "panels": panels(fronts),
        "folded": is_uniform(run),
        "energy": energy_data(run.balance, units),
        "snapshots": snapshot_data(run, snapshots, units, look, opening) if snapshots is not None else None,
    }
