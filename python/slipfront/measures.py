# SPDX-License-Identifier: BSD-3-Clause
"""Fronts, criteria and fits of arrays from anywhere: experiments, other codes, runs. SI units; undefined is
NaN.

Definitions: docs/theory.md. All raise CaseError, a ValueError, where arrays do not fit each other."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.special import stdtrit

import slipfront.printed  # noqa: F401
from slipfront import _core
from slipfront.errors import CaseError
from slipfront.given import array, column, in_order, instance, number, refusing, shown, whole
from slipfront.onsets import NONE, without_marks
from slipfront.read import FRONT_COLUMNS, ratio
from slipfront.units import attributes, unit_of, variables

# Arrays by their names, such as a Dataset of OpenRun.
Arrays = Mapping[Any, Any]
NAN = float("nan")
Errors = tuple[float, np.ndarray]  # standard ones, of places and of each time
LENGTHS_AND_TIMES = ("l_star_m", "arrest_time_s", "min_length_m")  # of FrontSettings
DIGITS = 7  # of times at most, behind which rounding begins
WAITS = 5  # of a tip, in times that a front of the record takes for its least length
NORMAL_95 = 1.96  # standard errors to each side that hold 95 %
STEPS = 100  # of an iteration at most
UNEVEN = 10  # speeds within a front that differ as many times are those of no line

POINT_COLUMNS = (*(name for name in FRONT_COLUMNS if name not in ("front_id", "direction")), "slipping_share")


@dataclass(frozen=True)
class FrontSettings:
    """How fronts are found and measured.

    Lengths and times that are None are, for onsets, of the record's own spacing and delays, see find_fronts;
    for a history those of a case file, where a tip waits longer if slip spreads slowly."""

    l_star_m: float | None = None  # length over which the speed is taken; one element where that is longer
    speed_interval: str = "centred"  # about x; or "approach": from l* before x to x
    arrest_time_s: float | None = None  # a tip that waits longer for its next onset has arrested
    min_length_m: float | None = None  # shorter paths, or jumps ahead no longer than this, are no fronts
    crack_share: float = 0.5  # crack-like above this share of slipping length to distance run
    pulse_share: float = 0.2  # pulse-like below it
    # For the energy densities alone; NaN leaves them undefined.
    mu_s: float = NAN
    youngs_modulus_Pa: float = NAN
    poissons_ratio: float = NAN
    plane: str = "stress"

    def options(self) -> _core.FrontOptions:
        made = _core.FrontOptions()
        for name, allowed in (("speed_interval", ("centred", "approach")), ("plane", ("stress", "strain"))):
            if getattr(self, name) not in allowed:
                words = " or ".join(map(repr, allowed))
                raise CaseError(f"{name} is {shown(getattr(self, name))}; it must be {words}")
        made.speed_interval = _core.SpeedInterval[self.speed_interval]
        made.plane_strain = self.plane == "strain"
        for name in LENGTHS_AND_TIMES:
            if getattr(self, name) is not None:
                setattr(made, name, number(getattr(self, name), name, above=0))
        made.arrest_time_by_event = self.arrest_time_s is None
        for name in ("crack_share", "pulse_share"):
            setattr(made, name, number(getattr(self, name), name, least=0))
        if made.pulse_share > made.crack_share:
            raise CaseError(f"pulse_share {made.pulse_share} is above crack_share {made.crack_share}")
        for name, least, most in (
            ("mu_s", 0, np.inf),
            ("youngs_modulus_Pa", 0, np.inf),
            ("poissons_ratio", -1, 0.5),
        ):
            value = number(getattr(self, name), name)
            if not (np.isnan(value) or least < value < most):
                raise CaseError(f"{name} is {value}; it must be above {least} and below {most}, or NaN")
            setattr(made, name, value)
        return made


def as_dataset(fronts: list[_core.Front]) -> xr.Dataset:
    """Fronts as OpenRun.fronts has them, with slipping_share and accelerating."""

    def joined(name: str, dtype: Any = np.float64) -> np.ndarray:
        return np.concatenate([np.empty(0, dtype), *(getattr(front, name) for front in fronts)])

    sizes = [len(front.x_m) for front in fronts]
    ids = np.array([front.id for front in fronts], dtype=np.int64)
    directions = np.array([front.direction for front in fronts], dtype=np.int64)
    of_points: dict[str, np.ndarray] = {
        **{name: joined(name) for name in POINT_COLUMNS},
        "front_id": np.repeat(ids, sizes),
        "accelerating": joined("accelerating", np.bool_),
        "node": joined("node", np.int32),
        "direction_of_point": np.repeat(directions, sizes),
    }
    of_fronts = {
        "front": ids,
        "direction": directions,
        "end": np.array([front.end for front in fronts], dtype=np.str_),
        "mode": np.array([front.mode for front in fronts], dtype=np.str_),
    }
    found = xr.Dataset(variables(("point",), of_points) | variables(("front",), of_fronts))
    return found.set_coords(["x_m", "onset_s", "front_id"])


def options_of(settings: FrontSettings | None) -> _core.FrontOptions:
    return checked(settings).options()


def checked(settings: FrontSettings | None) -> FrontSettings:
    return FrontSettings() if settings is None else instance(settings, FrontSettings, "settings")


def settings_of_record(x_m: np.ndarray, onset_s: np.ndarray, given: FrontSettings) -> FrontSettings:
    """What is None becomes what suits the record, as find_fronts says."""
    if (slips := np.isfinite(onset_s)).sum() == 2:
        x_m, onset_s = x_m[slips], onset_s[slips]
    spacing = np.diff(x_m)
    usual = float(np.median(spacing)) if spacing.size else 1.0
    with np.errstate(invalid="ignore"):
        delay = np.abs(np.diff(onset_s))
    moves = np.isfinite(delay) & (delay > 0)
    extent = float(np.ptp(x_m)) if spacing.size else 1.0  # of two places their distance
    least = min(2 * usual, extent) if given.min_length_m is None else given.min_length_m
    slowness = float(np.median(delay[moves] / spacing[moves])) if moves.any() else 1.0
    length = max(least, min(float(spacing.max(initial=usual)), 5 * usual))
    own: dict[str, Any] = {
        "l_star_m": usual,
        "min_length_m": least,
        "arrest_time_s": WAITS * slowness * length,
    }
    return replace(given, **{name: value for name, value in own.items() if getattr(given, name) is None})


def time_step_s(x_m: np.ndarray, onset_s: np.ndarray) -> float:
    """The largest step of which all differences of times are multiples, such as a camera's; 0 where none is.

    Times of a front that is exactly uniform are multiples of its travel time between two places, which is no
    step of a clock: then the last digit that they have."""
    slipped = np.isfinite(onset_s)
    t = onset_s[slipped]
    differences = np.diff(np.unique(t))
    if differences.size == 0:
        return 0.0
    digits = int(np.floor(np.log10(differences.max()))) - np.arange(DIGITS)
    for digit in 10.0**digits:
        parts = differences / digit
        if np.all(np.abs(parts - np.round(parts)) < 0.01):
            break
    else:
        return 0.0
    slowness = np.abs(np.diff(t) / np.diff(x_m[slipped]))
    is_uniform = slowness.size > 2 and np.ptp(slowness) < 1e-6 * slowness.max()
    return float(digit if is_uniform else digit * np.gcd.reduce(np.round(parts).astype(np.int64)))


def slope_of_line(x: np.ndarray, t: np.ndarray, errors: Errors | None) -> float:
    """Of t over x: Deming's line, the sum of (t - slope x)^2 over the variance of this by the standard errors
    of x and t is least. Without errors each is the same share of its own spread, which makes the slope the
    geometric mean of t regressed on x and x on t. Times with an error each: see weighted_slope."""
    if errors is not None and np.ptp(errors[1]) > 0:
        return weighted_slope(x, t, errors)
    x, t = x - x.mean(), t - t.mean()
    xx, tt, xt = float(x @ x), float(t @ t), float(x @ t)
    if not xt > 0:
        return NAN
    of_x, of_t = (xx, tt) if errors is None else (errors[0] ** 2, float(errors[1][0]) ** 2)
    more = of_x * tt - of_t * xx
    root = float(np.hypot(more, 2 * np.sqrt(of_x * of_t) * xt))
    # The same root twice: neither form subtracts near equals.
    return (more + root) / (2 * of_x * xt) if more > 0 else 2 * of_t * xt / (root - more)


def weighted_slope(x: np.ndarray, t: np.ndarray, errors: Errors) -> float:
    """Deming's line where each time has an error of its own, by York's iteration: D. York et al., American
    Journal of Physics 72, 367 (2004)."""
    place, time = errors
    slope = float(np.polyfit(x, t, 1, w=1 / time)[0])
    for _ in range(STEPS):
        weight = 1 / (time**2 + (slope * place) ** 2)
        own_x, own_t = (v - np.average(v, weights=weight) for v in (x, t))
        beta = weight**2 * (own_x * time**2 + slope * own_t * place**2)
        last, slope = slope, float(beta @ own_t / (beta @ own_x))
        if abs(slope - last) <= 1e-12 * abs(slope):
            break
    return slope


def fitted_speed(
    run_m: np.ndarray, onset_s: np.ndarray, step_s: float, errors: Errors | None
) -> tuple[float, float, float]:
    """Speed of the line through onset over distance run, and its interval: what times wrong by up to half
    a step on either side can make of it, or, where that is wider, 95 % by the scatter about the line or by
    the errors."""
    if len(run_m) < 2:
        return NAN, NAN, NAN
    slope = slope_of_line(run_m, onset_s, errors)
    if not slope > 0:
        return NAN, NAN, NAN
    share = np.ones_like(run_m) if errors is None else 1 / (errors[1] ** 2 + (slope * errors[0]) ** 2)
    x, t = (v - np.average(v, weights=share) for v in (run_m, onset_s))
    squares = float(share * x @ x)
    weight = share * x / squares
    scatter = t - float(weight @ t) * x
    half = float(np.abs(weight).sum()) * step_s / 2
    if (freedom := len(x) - 2) > 0:
        error = float(np.sqrt(share * scatter @ scatter / freedom / squares))
        half = max(half, float(stdtrit(freedom, 0.975)) * error)
    if errors is not None:
        half = max(half, NORMAL_95 / float(np.sqrt(squares)))
    if half == 0 and freedom == 0:  # nothing tells how wrong two times are
        half = float("inf")
    return 1 / slope, 1 / (slope + half), 1 / (slope - half) if slope > half * (1 + 1e-9) else float("inf")


def slices_of(fronts: xr.Dataset) -> list[slice]:
    """The points of each front."""
    ends = np.searchsorted(fronts["front_id"].to_numpy(), fronts["front"].to_numpy(), side="right")
    return [slice(a, b) for a, b in zip([0, *ends], ends, strict=False)]


def on_own_line(fronts: xr.Dataset) -> np.ndarray:
    """Whether a point is on its front's line. A place that two fronts share, where they begin or meet, is on
    neither: slip began beside it, and at least one of them took another time to it than its speed says."""
    _, which, times = np.unique(fronts["node"].to_numpy(), return_inverse=True, return_counts=True)
    return times[which] == 1


def speed_of(
    fronts: xr.Dataset, points: np.ndarray, step_s: float, errors: Errors | None
) -> tuple[float, float, float]:
    """fitted_speed of some points of a front; errors: those of the record's nodes."""
    x, onset = fronts["x_m"].to_numpy()[points], fronts["onset_s"].to_numpy()[points]
    own = errors and (errors[0], errors[1][fronts["node"].to_numpy()[points]])
    return fitted_speed(np.abs(x - x[:1]), onset, step_s, own)


def add_speeds(fronts: xr.Dataset, step_s: float, errors: Errors | None) -> None:
    own = on_own_line(fronts)
    parts = [np.arange(part.start, part.stop)[own[part]] for part in slices_of(fronts)]
    speeds = [speed_of(fronts, at, step_s, errors) for at in parts]
    columns = np.array(speeds, dtype=float).reshape(-1, 3).T
    for name, values in zip(
        ("speed_m_per_s", "speed_low_m_per_s", "speed_high_m_per_s"), columns, strict=True
    ):
        fronts[name] = ("front", values, attributes(name))


def errors_of(place_m: float | None, time_s: ArrayLike | None, n: int) -> Errors | None:
    """Of n nodes; those of times may differ."""
    if place_m is None and time_s is None:
        return None
    place = 0.0 if place_m is None else number(place_m, "place_error_m", least=0, finite=True)
    if time_s is None or np.ndim(time_s) == 0:
        one = 0.0 if time_s is None else number(time_s, "time_error_s", least=0, finite=True)
        if not (place or one):
            raise CaseError(
                "place_error_m and time_error_s are both 0: give one of them above it, or neither"
            )
        return place, np.full(n, one)
    each = array(time_s, "time_error_s", finite=True)
    if len(each) != n or not (each > 0).all():
        raise CaseError(f"time_error_s must be a number, or {n} of them above 0, one for each onset")
    return place, each


def doubts_of_speeds(fronts: xr.Dataset) -> list[str]:
    """Fronts whose line says little."""
    doubts = []
    for k, part in enumerate(slices_of(fronts)):
        v = fronts["v_tip_m_per_s"].to_numpy()[part]
        v = v[np.isfinite(v) & (v > 0)]
        if part.stop - part.start == 2:
            doubts.append(
                f"front {k}: two onsets make its speed, nothing tells whether they are of one front"
            )
        elif v.size and v.max() >= UNEVEN * v.min():
            doubts.append(
                f"front {k}: v_tip is {v.min():.3g} to {v.max():.3g} m/s: no one speed is that of the front"
            )
    return doubts


def notes_of_record(onset_s: np.ndarray, fronts: xr.Dataset, settings: FrontSettings) -> list[str]:
    """How many onsets are in no front, and why."""
    slips = np.isfinite(onset_s)
    alone = slips.copy()
    alone[fronts["node"].to_numpy()] = False
    n, n_alone = int(slips.sum()), int(alone.sum())
    if n_alone == 0:
        return []
    with np.errstate(invalid="ignore"):
        delay = np.abs(np.diff(onset_s))
    late = np.pad(np.isfinite(delay) & (delay > settings.arrest_time_s), 1)
    meets = np.pad(np.isfinite(delay) & (delay <= settings.arrest_time_s), 1)
    waits = alone & (late[:-1] | late[1:]) & ~(meets[:-1] | meets[1:])
    barred = alone & ~(late[:-1] | late[1:] | meets[:-1] | meets[1:])
    why = [
        f"{count} {text}"
        for count, text in (
            (waits.sum(), "whose neighbours slip more than arrest_time_s earlier or later"),
            (barred.sum(), "between places that never slip"),
            (n_alone - waits.sum() - barred.sum(), "on paths shorter than min_length_m"),
        )
        if count
    ]
    return [f"{n_alone} of {n} onset{'' if n == 1 else 's'} in no front: {', '.join(why)}"]


def find_fronts(
    x_m: ArrayLike,
    onset_s: ArrayLike,
    *,
    t_s_Pa: ArrayLike | None = None,
    p_s_Pa: ArrayLike | None = None,
    end_time_s: float | None = None,
    resolution_s: float | None = None,
    never_slipped: float | str | None = None,
    place_error_m: float | None = None,
    time_error_s: ArrayLike | None = None,
    settings: FrontSettings | None = None,
) -> xr.Dataset:
    """Fronts in the times at which slip begins along an interface.

    x_m: [nodes] ascending. onset_s: [nodes], NaN or infinite where a node never slips.
    t_s_Pa, p_s_Pa: [nodes] tractions before the event, p positive in compression; without them all nodes
    are in contact and the static ratio is undefined. Tractions at the tip need a history:
    find_fronts_in_history.
    end_time_s: end of the record, by default the last onset. A front that might go on is then "record_end".
    resolution_s: time between two looks at the interface, such as a camera's; v_tip_m_per_s from onsets
    that are less apart are undefined. Without it that of the fronts' speeds is the largest step of which
    all times are multiples; of an exactly uniform front the last digit of its times.
    never_slipped: the number in onset_s that marks a place that never slips; "none" if every number is a
    time. Without it -1, -99 and the like are such marks where all others are at least 0, and so are 999, 1e9
    farther from the others than these are from each other; a UserWarning says so.
    place_error_m, time_error_s: standard errors of x_m and onset_s, by which the line of each front's speed
    weighs them; one alone: the other is exact. Without them the line favours neither. time_error_s may be
    [nodes].
    settings: None in it are: l_star_m the median spacing; min_length_m twice that, of two places that
    slip their distance; arrest_time_s 5 times what a front takes, at the median speed between neighbours, for
    min_length_m or the largest spacing (at most 5 median ones) where that is longer.

    Returns a Dataset over `point` (front_id, x_m, onset_s, v_tip_m_per_s, ...) and `front`: direction, mode,
    end (arrest, meets_front, contact_end, record_edge, record_end), speed_m_per_s of the line through its
    own onsets with speed_low_m_per_s and speed_high_m_per_s. Attributes: the settings used; `notes`, how many
    places never slip, how many onsets are in no front, and why, and fronts whose line says little."""
    x, onset = array(x_m, "x_m", finite=True), array(onset_s, "onset_s")
    t_s = np.full_like(x, np.nan) if t_s_Pa is None else array(t_s_Pa, "t_s_Pa")
    p_s = np.ones_like(x) if p_s_Pa is None else array(p_s_Pa, "p_s_Pa")
    if np.any(p_s < 0):
        raise CaseError("p_s_Pa has negative values; pressure is positive in compression")
    if never_slipped is not None and never_slipped != NONE:
        never_slipped = number(never_slipped, "never_slipped")
    onset, notes = without_marks(onset, never_slipped)
    for note in notes:
        if "taken as" in note:
            warnings.warn(note, stacklevel=2)
    slips = onset[np.isfinite(onset)]
    last = float(slips.max()) if slips.size else 0.0
    end = last if end_time_s is None else number(end_time_s, "end_time_s", least=last)
    resolution = 0.0 if resolution_s is None else number(resolution_s, "resolution_s", least=0)
    errors = errors_of(place_error_m, time_error_s, len(onset))
    given = checked(settings)
    given.options()  # refuses what is wrong before it is used
    fits = len(x) == len(onset) > 1 and bool(np.all(np.diff(x) > 0))  # or the module refuses it
    used = settings_of_record(x, onset, given) if fits else given
    with refusing():
        options = used.options()
        options.whole_interface = False
        at_once = slips.size > 1 and bool(np.ptp(slips) == 0)
        fronts = _core.find_fronts(x, onset, t_s, p_s, end, resolution, options)
        found = as_dataset([] if at_once else fronts)
    if p_s_Pa is None:
        found["p_s_Pa"][:] = np.nan
    step = time_step_s(x, onset) if resolution_s is None else resolution
    add_speeds(found, step, errors)
    found.attrs = {name: getattr(used, name) for name in LENGTHS_AND_TIMES}
    found.attrs |= {
        "time_step_s": step,
        "notes": [*notes, *([f"no fronts: all {slips.size} onsets are at {slips[0]:.6g} s"] if at_once else
                            [*notes_of_record(onset, found, used), *doubts_of_speeds(found)])],
    }  # fmt: skip
    return found


HistoryArrays = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def field_of(history: Arrays, name: str, *, dims: int = 2, finite: bool = False) -> np.ndarray:
    """An array of a history, in the unit of its name; [times, nodes], where its dimensions have names in
    whatever order they are."""
    values = column(history, "history", name, dims=dims, finite=finite)
    given = history[name]
    unit = getattr(given, "attrs", {}).get("units", unit_of(name))
    if unit != unit_of(name):
        raise CaseError(f"history['{name}'] is in {unit}; give it in {unit_of(name)}")
    if dims == 2:
        along = [getattr(history[axis], "dims", ()) for axis in ("time_s", "x_m")]
        if getattr(given, "dims", ()) == along[1] + along[0] != along[0] + along[1]:
            return np.ascontiguousarray(values.T)
    return values


def history_arrays(history: Arrays) -> HistoryArrays:
    """time_s, x_m, slip_rate_m_per_s, t_Pa, p_Pa."""
    time_s, x_m = (field_of(history, name, dims=1, finite=True) for name in ("time_s", "x_m"))
    rate = field_of(history, "slip_rate_m_per_s", finite=True)
    t, p = (field_of(history, name) for name in ("t_Pa", "p_Pa"))
    return time_s, x_m, rate, t, p


def tractions_before(arrays: HistoryArrays, tractions: Arrays | None) -> tuple[np.ndarray, np.ndarray]:
    """t_s_Pa and p_s_Pa, by default those of the first time; refused where they have places of their own that
    are not those of the history."""
    _, x_m, _, t, p = arrays
    if tractions is None:
        if not (len(t) and len(p)):
            raise CaseError("history holds no times")
        return t[0], p[0]
    t_s, p_s = (column(tractions, "tractions", name) for name in ("t_s_Pa", "p_s_Pa"))
    if isinstance(tractions, Mapping) and "x_m" in tractions:
        own_m = column(tractions, "tractions", "x_m")
        if len(own_m) != len(x_m) or not np.allclose(own_m, x_m):
            raise CaseError("tractions['x_m'] differs from history['x_m']; give both at the same nodes")
    return t_s, p_s


def find_fronts_in_history(
    history: Arrays,
    tractions: Arrays | None = None,
    *,
    threshold_m_per_s: float = 1e-3,
    tip: str = "slip_rate",
    settings: FrontSettings | None = None,
) -> xr.Dataset:
    """Fronts in a history of an interface, with the tractions at their tips.

    history: time_s [times], x_m [nodes], slip_rate_m_per_s, t_Pa and p_Pa [times, nodes]; OpenRun.history
    is one.
    tractions: t_s_Pa and p_s_Pa [nodes] before the event; by default those of the first time.
    threshold_m_per_s: a node slips while its slip rate is above it.
    tip: "slip_rate" where this passes the threshold, or, for nodes that never stick, "peak": where |t_Pa| is
    largest from the stop before up to the largest slip rate before the next stop, at the top of the parabola
    through three times.

    Returns a Dataset as find_fronts does. Onsets are as fine as the history is in time: those of
    OpenRun.fronts, located inside the time steps, are finer."""
    arrays = history_arrays(history)
    threshold = number(threshold_m_per_s, "threshold_m_per_s", above=0)
    if tip not in ("slip_rate", "peak"):
        raise CaseError(f"tip is {tip!r}; it must be 'slip_rate' or 'peak'")
    t_s, p_s = tractions_before(arrays, tractions)
    options = options_of(settings)
    with refusing():
        found = _core.find_fronts_in_history(*arrays, t_s, p_s, threshold, tip == "peak", options)
        return as_dataset(found)


def criteria(fronts: Arrays) -> xr.Dataset:
    """The three criteria of Kammer et al. 2012 at the points of fronts: static_ratio t_s/p_s, dynamic_ratio
    t_d/p_d and energy_rise (U_r - U_s)/U_s, of a Dataset of fronts or arrays of those names. [points]"""
    columns = {
        name: column(fronts, "fronts", name)
        for name in ("t_s_Pa", "p_s_Pa", "t_d_Pa", "p_d_Pa", "U_s_J_per_m3", "U_r_J_per_m3")
    }
    if len({len(values) for values in columns.values()}) > 1:
        lengths = ", ".join(f"{name} {len(values)}" for name, values in columns.items())
        raise CaseError(f"fronts: its arrays differ in length: {lengths}")
    c = {name: np.asarray(values, dtype=float) for name, values in columns.items()}
    found = {
        "static_ratio": ratio(c["t_s_Pa"], c["p_s_Pa"]),
        "dynamic_ratio": ratio(c["t_d_Pa"], c["p_d_Pa"]),
        "energy_rise": ratio(c["U_r_J_per_m3"] - c["U_s_J_per_m3"], c["U_s_J_per_m3"]),
    }
    coordinates = fronts.coords if isinstance(fronts, xr.Dataset) else {}
    return xr.Dataset(
        variables(("point",), found), {k: v for k, v in coordinates.items() if v.dims == ("point",)}
    )


def energy_density_J_per_m3(
    t_Pa: ArrayLike,
    p_Pa: ArrayLike,
    *,
    youngs_modulus_Pa: float,
    poissons_ratio: float,
    plane: str = "stress",
) -> np.ndarray:
    """Heuristic energy density of tractions, J/m3: Kammer et al. 2012, Eq. 2. Shape of t_Pa and p_Pa
    together."""
    t, p = np.broadcast_arrays(np.asarray(t_Pa, np.float64), np.asarray(p_Pa, np.float64))
    pair = array(t.ravel(), "t_Pa"), array(p.ravel(), "p_Pa")
    density = _core.energy_density_J_per_m3(*pair, youngs_modulus_Pa, poissons_ratio, plane == "strain")
    return density.reshape(t.shape)


Series = tuple[ArrayLike, ArrayLike]
evaluate = _core.ExponentialFit.__call__


def fitted(fit: _core.ExponentialFit, x: ArrayLike) -> Any:
    """y of a fit at a number or an array of any shape."""
    if np.ndim(x) == 0:
        return float(evaluate(fit, array(number(x, "x"), "x"))[0])
    return evaluate(fit, array(np.ravel(x), "x")).reshape(np.shape(x))


_core.ExponentialFit.__call__ = fitted  # type: ignore[method-assign, assignment]


def as_series(series: Iterable[Series]) -> list[tuple[np.ndarray, np.ndarray]]:
    pairs = []
    for k, each in enumerate(in_order(series, "series", "a list of pairs (x, y)")):
        pair = in_order(each, f"series[{k}]", "a pair (x, y)")
        if len(pair) != 2:
            raise CaseError(f"series[{k}] has {len(pair)} parts; it must be a pair (x, y)")
        pairs.append((array(pair[0], f"x of series[{k}]"), array(pair[1], f"y of series[{k}]")))
    return pairs


def fit_exponential(
    series: Iterable[Series],
    *,
    resamples: int = 400,
    block_points: int = 15,
    confidence: float = 0.95,
    seed: int = 1,
) -> _core.ExponentialFit:
    """Fits y = a + b exp(-c sqrt(x)), Kammer et al. 2012, Eq. 3: V_tip/c_L over the energy rise.

    series: (x, y) of each front, its points in the order of travel. Intervals by a block bootstrap: blocks
    of block_points neighbours, drawn `resamples` times within each series. Points that are not finite or
    have x < 0 are left out. Raises CaseError for fewer than four points, or if all have one x."""
    n = whole(resamples, "resamples", least=0), whole(block_points, "block_points", least=1)
    share = number(confidence, "confidence")
    start = whole(seed, "seed", least=0, most=2**32 - 1)
    with refusing():
        return _core.fit_exponential(as_series(series), *n, share, start)


def spread_at_equal_x(series: Iterable[Series], *, bins: int = 20) -> _core.Spread:
    """Spread of y between series at equal x, over bins of equal width: how well x orders y."""
    n = whole(bins, "bins", least=1)
    with refusing():
        return _core.spread_at_equal_x(as_series(series), n)


def ratio_at_equal_x(a: Series, b: Series, *, bins: int = 20) -> _core.Ratio:
    """Ratio of the medians of y, a over b, two pairs (x, y), in bins of x as for spread_at_equal_x."""
    n = whole(bins, "bins", least=1)
    with refusing():
        return _core.ratio_at_equal_x(as_series([a, b]), n)


def falls_while_rises(
    s_m: ArrayLike, falling: ArrayLike, rising: ArrayLike, *, min_length_m: float = 5e-3
) -> np.ndarray:
    """Lengths of the stretches of a path over which one quantity falls while another rises, by smoothed
    slopes. s_m: ascending [points]; points where a quantity is NaN are left out."""
    arrays = array(s_m, "s_m"), array(falling, "falling"), array(rising, "rising")
    length = number(min_length_m, "min_length_m", least=0)
    with refusing():
        return _core.falls_while_rises(*arrays, length)


def rank_correlation(x: ArrayLike, y: ArrayLike) -> float:
    """Spearman's, of pairs that are finite; NaN for fewer than three or no spread."""
    pair = array(x, "x"), array(y, "y")
    with refusing():
        return _core.rank_correlation(*pair)
