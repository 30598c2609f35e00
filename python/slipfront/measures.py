# SPDX-License-Identifier: BSD-3-Clause
"""Fronts, criteria and fits of arrays from anywhere: experiments, other codes, runs. SI units; undefined is
NaN.

Definitions: docs/theory.md. All raise CaseError, a ValueError, where arrays do not fit each other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

import slipfront.printed  # noqa: F401
from slipfront import _core
from slipfront.errors import CaseError
from slipfront.given import array, column, instance, number, refusing, shown, whole

# Arrays by their names, such as a Dataset of OpenRun.
Arrays = Mapping[Any, Any]
NAN = float("nan")

POINT_UNITS = {
    "x_m": "m",
    "onset_s": "s",
    "v_tip_m_per_s": "m/s",
    "t_s_Pa": "Pa",
    "p_s_Pa": "Pa",
    "t_d_Pa": "Pa",
    "p_d_Pa": "Pa",
    "t_r_Pa": "Pa",
    "p_r_Pa": "Pa",
    "U_s_J_per_m3": "J/m3",
    "U_r_J_per_m3": "J/m3",
    "slipping_share": "1",
}


@dataclass(frozen=True)
class FrontSettings:
    """How fronts are found and measured; the defaults are those of a case file."""

    l_star_m: float = 0.67e-3  # length over which the speed is taken; one element where that is longer
    speed_interval: str = "centred"  # about x; or "approach": from l* before x to x
    arrest_time_s: float = 20e-6  # a tip that waits longer for its next onset has arrested
    min_length_m: float = 2e-3  # shorter paths, or jumps ahead no longer than this, are no fronts
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
        for name in ("l_star_m", "arrest_time_s", "min_length_m"):
            setattr(made, name, number(getattr(self, name), name, above=0))
        for name in ("crack_share", "pulse_share"):
            setattr(made, name, number(getattr(self, name), name, least=0))
        if made.pulse_share > made.crack_share:
            raise CaseError(f"pulse_share {made.pulse_share} is above crack_share {made.crack_share}")
        for name in ("mu_s", "youngs_modulus_Pa", "poissons_ratio"):
            setattr(made, name, number(getattr(self, name), name))
        return made


def as_dataset(fronts: list[_core.Front]) -> xr.Dataset:
    """Fronts as OpenRun.fronts has them, with slipping_share and accelerating."""

    def joined(name: str, dtype: Any = np.float64) -> np.ndarray:
        return np.concatenate([np.empty(0, dtype), *(getattr(front, name) for front in fronts)])

    points = {
        name: xr.Variable(("point",), joined(name), {"unit": unit}) for name, unit in POINT_UNITS.items()
    }
    sizes = [len(front.x_m) for front in fronts]
    ids = np.array([front.id for front in fronts], dtype=np.int64)
    coordinates = {name: points.pop(name) for name in ("x_m", "onset_s")}
    coordinates["front_id"] = xr.Variable(("point",), np.repeat(ids, sizes))
    coordinates["front"] = xr.Variable(("front",), ids)
    points["accelerating"] = xr.Variable(("point",), joined("accelerating", np.bool_))
    points["node"] = xr.Variable(("point",), joined("node", np.int32))
    directions = np.array([front.direction for front in fronts], dtype=np.int64)
    points["direction_of_point"] = xr.Variable(("point",), np.repeat(directions, sizes))
    points["direction"] = xr.Variable(("front",), directions)
    points["end"] = xr.Variable(("front",), np.array([front.end for front in fronts], dtype=np.str_))
    points["mode"] = xr.Variable(("front",), np.array([front.mode for front in fronts], dtype=np.str_))
    return xr.Dataset(points, coordinates)


def options_of(settings: FrontSettings | None) -> _core.FrontOptions:
    if settings is None:
        return FrontSettings().options()
    return instance(settings, FrontSettings, "settings").options()


def find_fronts(
    x_m: ArrayLike,
    onset_s: ArrayLike,
    *,
    t_s_Pa: ArrayLike | None = None,
    p_s_Pa: ArrayLike | None = None,
    end_time_s: float | None = None,
    resolution_s: float = 0.0,
    settings: FrontSettings | None = None,
) -> xr.Dataset:
    """Fronts in the times at which slip begins along an interface.

    x_m: [nodes] ascending. onset_s: [nodes], NaN or infinite where a node never slips.
    t_s_Pa, p_s_Pa: [nodes] tractions before the event, p positive in compression; without them all nodes
    are in contact and the static ratio is undefined. Tractions at the tip need a history:
    find_fronts_in_history.
    end_time_s: end of the record, by default the last onset. A front that might go on is then "record_end".
    resolution_s: time between two looks at the interface, such as a camera's; speeds from onsets that are
    less apart are undefined.

    Returns a Dataset over `point` (front_id, x_m, onset_s, v_tip_m_per_s, ...) and `front` (direction, mode,
    end: arrest, meets_front, contact_end, record_end)."""
    x, onset = array(x_m, "x_m", finite=True), array(onset_s, "onset_s")
    t_s = np.full_like(x, np.nan) if t_s_Pa is None else array(t_s_Pa, "t_s_Pa")
    p_s = np.ones_like(x) if p_s_Pa is None else array(p_s_Pa, "p_s_Pa")
    last = float(onset[np.isfinite(onset)].max(initial=0.0))
    end = last if end_time_s is None else number(end_time_s, "end_time_s", least=last)
    resolution = number(resolution_s, "resolution_s", least=0)
    with refusing():
        found = as_dataset(_core.find_fronts(x, onset, t_s, p_s, end, resolution, options_of(settings)))
    if p_s_Pa is None:
        found["p_s_Pa"][:] = np.nan
    return found


HistoryArrays = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def history_arrays(history: Arrays) -> HistoryArrays:
    """time_s, x_m, slip_rate_m_per_s, t_Pa, p_Pa."""
    time_s, x_m = (column(history, "history", name, finite=True) for name in ("time_s", "x_m"))
    rate = column(history, "history", "slip_rate_m_per_s", dims=2, finite=True)
    t, p = (column(history, "history", name, dims=2) for name in ("t_Pa", "p_Pa"))
    return time_s, x_m, rate, t, p


def find_fronts_in_history(
    history: Arrays,
    tractions: Arrays | None = None,
    *,
    threshold_m_per_s: float = 1e-3,
    settings: FrontSettings | None = None,
) -> xr.Dataset:
    """Fronts in a history of an interface, with the tractions at their tips.

    history: time_s [times], x_m [nodes], slip_rate_m_per_s, t_Pa and p_Pa [times, nodes]; OpenRun.history
    is one.
    tractions: t_s_Pa and p_s_Pa [nodes] before the event; by default those of the first time.
    threshold_m_per_s: a node slips while its slip rate is above it.

    Returns a Dataset as find_fronts does. Onsets are as fine as the history is in time: those of
    OpenRun.fronts, located inside the time steps, are finer."""
    arrays = history_arrays(history)
    threshold = number(threshold_m_per_s, "threshold_m_per_s", above=0)
    if tractions is not None:
        t_s, p_s = (column(tractions, "tractions", name) for name in ("t_s_Pa", "p_s_Pa"))
    elif len(arrays[3]) and len(arrays[4]):
        t_s, p_s = arrays[3][0], arrays[4][0]
    else:
        raise CaseError("history holds no times")
    options = options_of(settings)
    with refusing():
        return as_dataset(_core.find_fronts_in_history(*arrays, t_s, p_s, threshold, options))


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
    values = {
        which.name: xr.Variable(("point",), _core.criterion(which=which, **columns), {"unit": "1"})
        for which in _core.Criterion
    }
    coordinates = fronts.coords if isinstance(fronts, xr.Dataset) else {}
    return xr.Dataset(values, {k: v for k, v in coordinates.items() if v.dims == ("point",)})


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


def given_in_order(values: Any, name: str, what: str) -> list[Any]:
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise CaseError(f"{name} is {shown(values)}; it must be {what}")
    try:
        return list(values)
    except TypeError:  # an array without dimensions
        raise CaseError(f"{name} is {shown(values)}; it must be {what}") from None


def as_series(series: Iterable[Series]) -> list[tuple[np.ndarray, np.ndarray]]:
    pairs = []
    for k, each in enumerate(given_in_order(series, "series", "a list of pairs (x, y)")):
        pair = given_in_order(each, f"series[{k}]", "a pair (x, y)")
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


def rank_correlation(x: ArrayLike, y: ArrayLike) -> float:
    """Spearman's, of pairs that are finite; NaN for fewer than three or no spread."""
    pair = array(x, "x"), array(y, "y")
    with refusing():
        return _core.rank_correlation(*pair)
