# SPDX-License-Identifier: BSD-3-Clause
"""Records of strain gauges, of an experiment or a run's probes. docs/gauges.md

SI units; strain_xy is half the engineering shear strain, stress positive in tension; y counts from the
interface."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.errors import CaseError
from slipfront.files import DataError, one_line, read_table
from slipfront.given import array, flag, in_order, instance, number, path, table, text
from slipfront.onsets import (
    LENGTHS,
    PRESSURES,
    QUANTITIES,
    TIMES,
    columns_of,
    in_si,
    name_and_unit,
    numbers_of,
)
from slipfront.opened import OpenRun
from slipfront.read import require

COMPONENTS = ("xx", "yy", "xy")
STRAINS = {"": 1.0, "strain": 1.0, "ustrain": 1e-6, "microstrain": 1e-6, "mstrain": 1e-3, "percent": 1e-2}
#: A smooth top that a converter shows as k equal samples falls by at most (1 + 2/k)^2 of a digit within
#: the next sample, and one of rounding: from 3 samples on below 4 digits. What falls faster was cut off.
TOP_SAMPLES, TOP_DIGITS = 3, 4
LAGS = 6  # of a low-pass of first order that count
GAUGE_NAMES = ("gauge", "name", "probe", "station")
WANTED = (
    "gauge, x, y and time with their units and strain_xx, strain_yy, strain_xy, three strain_ANGLE of a "
    "rosette, or stress_xx_MPa and so on"
)


@dataclass(frozen=True)
class Gauge:
    """What was recorded at a place: some of the components xx, yy, xy of strain, or of stress in Pa; or
    strain along the arms of a rosette, named by their angles from +x towards +y in degrees, such as "-45".

    places_m: x and y of those that are at a place of their own. A time at which a value is NaN is left out,
    and so is a component that is NaN throughout."""

    name: str
    x_m: float
    y_m: float
    time_s: np.ndarray
    values: Mapping[str, np.ndarray]
    is_strain: bool = True
    smoothing_s: float = 0.0  # standard deviation of the filter that the record has passed
    places_m: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()  # of the record; they follow each fit to it
    bandwidth_Hz: float = np.inf  # of its amplifier, a low-pass of first order that lets 0.71 pass there
    #: First and last times of flat tops: the record was cut off there, before any filter.
    flat_s: tuple[tuple[float, float], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        of = f"gauge {text(self.name, 'the name of a gauge')}: "
        for name in ("x_m", "y_m"):
            number(getattr(self, name), f"{of}{name}")
        number(self.smoothing_s, f"{of}smoothing_s", least=0, finite=True)
        flag(self.is_strain, f"{of}is_strain")
        number(self.bandwidth_Hz, f"{of}bandwidth_Hz", above=0)
        values = table(self.values, f"{of}values")
        if not values or any(weights(name) is None for name in values):
            raise CaseError(
                f"{of}its components are {list(values)}; take some of xx, yy, xy, or angles of arms in deg"
            )
        if not np.isfinite([self.x_m, self.y_m]).all() or self.y_m == 0:
            raise CaseError(f"{of}is at x = {self.x_m}, y = {self.y_m} m; y must be finite and not 0")
        time_s = array(self.time_s, f"{of}time_s")
        made = {name: array(v, f"{of}values['{name}']") for name, v in values.items()}
        if any(a.shape != time_s.shape or np.isinf(a).any() for a in (time_s, *made.values())):
            raise CaseError(f"{of}times and values must be finite arrays of one length")
        made = {name: a for name, a in made.items() if not np.isnan(a).all()}
        if not made:
            raise CaseError(f"{of}has no values: leave it out")
        known = ~np.isnan([time_s, *made.values()]).any(axis=0)
        time_s, made = time_s[known], {name: a[known] for name, a in made.items()}
        if len(time_s) < 2 or not (np.diff(time_s) > 0).all():
            raise CaseError(f"{of}needs two times or more that ascend")
        places = {name: tuple(map(float, array(p, f"{of}places_m['{name}']", finite=True)))
                  for name, p in table(self.places_m, f"{of}places_m").items()}  # fmt: skip
        if not set(places) <= set(values) or any(
            len(p) != 2 or p[1] * self.y_m <= 0 for p in places.values()
        ):
            raise CaseError(f"{of}places_m must hold x and y of its components, on its side of the interface")
        object.__setattr__(self, "time_s", time_s)
        object.__setattr__(self, "values", made)
        object.__setattr__(self, "places_m", places)
        object.__setattr__(self, "flat_s", tuple(f for v in made.values() for f in flat_tops(time_s, v)))

    @property
    def parts(self) -> list[str]:
        """Its components in their order, or its arms."""
        return [p for p in COMPONENTS if p in self.values] or list(self.values)

    def changed(self, flat_s: Iterable[tuple[float, float]], **fields: Any) -> Gauge:
        """With other fields; flat tops are no longer seen in values that were worked on."""
        made = replace(self, **fields)
        object.__setattr__(made, "flat_s", tuple(flat_s))
        return made

    def prepared(
        self,
        *,
        shift_s: float = 0.0,
        zero_s: tuple[float, float] | None = None,
        low_pass_Hz: float | None = None,
        window_s: tuple[float, float] | None = None,
    ) -> Gauge:
        """The record with its clock moved by shift_s; less its mean over zero_s, which may begin at -inf;
        filtered; cut to window_s. The last three count on the clock moved.

        low_pass_Hz: of a Gaussian filter without phase, at which it lets 0.71 pass. Where times are uneven
        the record is first interpolated to even ones. A fit passes its field through the same filter."""
        time_s, values, own_s = worked_on(
            f"gauge {self.name}", self.time_s, dict(self.values), shift_s, zero_s, low_pass_Hz, window_s
        )
        flat_s = [(first + shift_s, last + shift_s) for first, last in self.flat_s]
        smoothing_s = float(np.hypot(self.smoothing_s, own_s))
        return self.changed(flat_s, time_s=time_s, values=values, smoothing_s=smoothing_s)

    def peak(self, part: str) -> float:
        """The largest departure of a component from its median."""
        return largest_departure(self.values[part])


def largest_departure(values: np.ndarray) -> float:
    """From the median."""
    return float(np.abs(values - np.median(values)).max())


def weights(part: str) -> np.ndarray | None:
    """Of xx, yy and xy in a component, or in the strain along an arm; None: it is neither."""
    if part in COMPONENTS:
        return np.eye(3)[COMPONENTS.index(part)]
    try:
        angle = np.radians(float(part))
    except (TypeError, ValueError):
        return None
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * c, s * s, 2 * s * c])


def flat_tops(time_s: np.ndarray, values: np.ndarray) -> list[tuple[float, float]]:
    """Where a record stays at its largest or smallest value, and comes and goes faster than a smooth top."""
    known = ~np.isnan(values)
    time_s, values = time_s[known], values[known]
    steps = np.abs(np.diff(values))
    if not steps.any():
        return []
    digit, found = steps[steps > 0].min(), []
    for top in (values.max(), values.min()):
        ends = np.flatnonzero(np.diff(np.pad((values == top).astype(int), 1)))
        for first, end in zip(ends[::2], ends[1::2], strict=True):
            beside = [steps[first - 1]] if first > 0 else []  # a record may begin at rest
            beside += [steps[end - 1]] if beside and end < len(values) else []
            if end - first >= TOP_SAMPLES and min(beside, default=0) > TOP_DIGITS * digit:
                found.append((float(time_s[first]), float(time_s[end - 1])))
    return found


def between(time_s: np.ndarray, ends_s: tuple[float, float], name: str) -> np.ndarray:
    pair = in_order(ends_s, name, "a pair of times in s")
    if len(pair) != 2:
        raise CaseError(f"{name} has {len(pair)} parts; it must be a pair of times in s")
    first, last = (number(end, f"an end of {name}") for end in pair)
    inside = (time_s >= first) & (time_s <= last)
    if np.count_nonzero(inside) < 2:
        raise CaseError(
            f"{name} is {first:g} to {last:g} s; the record goes from {time_s[0]:g} to {time_s[-1]:g} s: "
            "give two of its times or more"
        )
    return inside


def worked_on(
    of: str,
    time_s: np.ndarray,
    values: dict[str, np.ndarray],
    shift_s: float = 0.0,
    zero_s: tuple[float, float] | None = None,
    low_pass_Hz: float | None = None,
    window_s: tuple[float, float] | None = None,
) -> tuple[np.ndarray, dict[str, np.ndarray], float]:
    """Times and values as Gauge.prepared makes them, and the standard deviation of the filter."""
    time_s, own_s = time_s + number(shift_s, "shift_s", finite=True), 0.0
    if zero_s is not None:
        inside = between(time_s, zero_s, f"{of}: zero_s")
        values = {name: v - v[inside].mean() for name, v in values.items()}
    if low_pass_Hz is not None:
        cut_off = number(low_pass_Hz, "low_pass_Hz", above=0, finite=True)
        lowest = 1 / (time_s[-1] - time_s[0])
        highest = 0.5 * (len(time_s) - 1) * lowest
        if not lowest <= cut_off <= highest:
            raise CaseError(
                f"low_pass_Hz is {cut_off:g} Hz; the record of {of.removeprefix('gauge ')} resolves "
                f"{lowest:.4g} to {highest:.4g} Hz: give one of these"
            )
        own_s = float(np.sqrt(np.log(2)) / (2 * np.pi * cut_off))
        time_s, values = filtered(time_s, values, own_s)
    if window_s is not None:
        inside = between(time_s, window_s, f"{of}: window_s")
        time_s, values = time_s[inside], {name: v[inside] for name, v in values.items()}
    return time_s, values, own_s


def gaussian(width: float) -> np.ndarray:
    """Of a standard deviation in samples, an odd number of them."""
    n = int(np.ceil(4 * width))
    weights = np.exp(-0.5 * (np.arange(-n, n + 1) / max(width, 1e-9)) ** 2)
    return weights / weights.sum()


def amplifier(bandwidth_Hz: float, step_s: float, n: int) -> np.ndarray:
    """Weights of a low-pass of first order, of the present one of n samples and those before."""
    lag = 1 / (2 * np.pi * bandwidth_Hz * step_s)  # in samples
    past = np.exp(-np.arange(min(max(np.ceil(LAGS * lag), 1), n)) / lag)
    return past / past.sum()


def smooth(values: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    return np.convolve(values, kernel, "valid")


def filtered(
    time_s: np.ndarray, values: Mapping[str, np.ndarray], width_s: float
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Even times, and the values there behind a Gaussian filter of this standard deviation."""
    even_s = np.linspace(time_s[0], time_s[-1], len(time_s))
    kernel = gaussian(width_s / (even_s[1] - even_s[0]))
    even = {name: np.interp(even_s, time_s, v) for name, v in values.items()}
    n = len(kernel) // 2
    return even_s, {name: smooth(np.pad(v, n, "edge"), kernel) for name, v in even.items()}


def from_arms(arms: Mapping[float, np.ndarray]) -> dict[str, np.ndarray]:
    """Strain in the plane of three arms, by their angles from +x towards +y in degrees."""
    turned = np.array([weights(f"{angle:.9g}") for angle in arms])
    if abs(np.linalg.det(turned)) < 1e-3:
        raise CaseError(f"arms at {', '.join(f'{a:g}' for a in arms)} degrees do not determine the strain")
    return dict(zip(COMPONENTS, np.linalg.solve(turned, np.array(list(arms.values()))), strict=True))


def quantities(names: list[str]) -> dict[str, tuple[tuple[str, ...], dict[str, float]]]:
    """What columns may be called, as in onsets.QUANTITIES, and the arms of a rosette among them."""
    found: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
        "x_m": QUANTITIES["x_m"],
        "y_m": (("y", "height"), LENGTHS),
        "time_s": (("time", "t"), TIMES),
        "gamma_xy": (("gamma_xy",), STRAINS),
    }
    for part in COMPONENTS:
        found[f"strain_{part}"] = (f"strain_{part}", f"eps_{part}", f"epsilon_{part}"), STRAINS
        found[f"stress_{part}"] = (f"stress_{part}", f"sigma_{part}"), PRESSURES
    for name in names:
        for bare in (name_and_unit(name)[0], name.strip().lower()):
            if arm := re.fullmatch(r"(strain|eps|epsilon|x|y)_([+-]?\d+(?:\.\d+)?)(?:_?deg)?", bare):
                of, units = (arm[1], LENGTHS) if arm[1] in ("x", "y") else ("arm", STRAINS)
                found[f"{of} {float(arm[2]):g}"] = (bare,), units
    return found


def components(where: Any, read: dict[str, np.ndarray]) -> tuple[dict[str, np.ndarray], bool]:
    """Those of strain or stress, or arms with places of their own, and whether they are of strain."""
    arms = {float(name[4:]): v for name, v in read.items() if name.startswith("arm ")}
    placed = [name for name in read if name[:2] in ("x ", "y ")]
    for name in placed:
        require(float(name[2:]) in arms, where, f"'{name.replace(' ', '_')}' is the place of no arm")
    strain = {part: read[f"strain_{part}"] for part in COMPONENTS if f"strain_{part}" in read}
    stress = {part: read[f"stress_{part}"] for part in COMPONENTS if f"stress_{part}" in read}
    if "gamma_xy" in read:
        require("xy" not in strain, where, "has both gamma_xy and strain_xy: leave one out")
        strain["xy"] = read["gamma_xy"] / 2
    kinds = [kind for kind in (strain, stress, arms) if kind]
    require(
        len(kinds) == 1,
        where,
        f"has {'several kinds' if kinds else 'none'} of strain, stress, arms of a rosette",
    )
    if arms:
        require(len(arms) == 3, where, f"a rosette has three arms, not {len(arms)}")
        try:
            made = from_arms(arms)
            return {f"{angle:g}": v for angle, v in arms.items()} if placed else made, True
        except CaseError as error:
            raise DataError(f"{where}: {error}") from None
    return strain or stress, bool(strain)


def read_gauges(file: str | Path) -> list[Gauge]:
    """The gauges of a CSV file (commas, or semicolons or tabs with decimal points or commas), a row per gauge
    and time: columns gauge, x_mm, y_mm, time_us and strain_xx, strain_yy, strain_xy, gamma_xy = 2 strain_xy,
    strain_-45, strain_90, strain_45 of the arms of a rosette, or stress_xx_MPa and so on. Units in the names,
    as read_onsets has them; strain has none, or ustrain, or percent. Arms that are not at one place have
    x_-45_mm, y_-45_mm and so on. Without the column gauge there is one. Empty cells, nan, NA and - are
    values that are missing: this time of the gauge is left out. A gauge without any value is passed over,
    and a UserWarning says so.

    Raises Error where the file is no such record."""
    file = path(file, "file")
    rows_of_file = read_table(file, by_hand=True, separators=";\t,")
    header = rows_of_file.header
    names = [name for name in header if name and name.strip().lower() not in GAUGE_NAMES]
    chosen = columns_of(file, names, quantities(names), ("x_m", "y_m", "time_s"), WANTED)
    read = {}
    for q, (name, factor) in chosen.items():
        is_value = q.startswith(("strain", "stress", "gamma", "arm"))
        read[q] = in_si(numbers_of(rows_of_file, name, is_value), factor)
        if not is_value:
            require(np.isfinite(read[q]), file, f"column '{one_line(name)}' has an empty cell")
    of_all, is_strain = components(file, read)
    arms = {q[4:]: v for q, v in read.items() if q.startswith("arm ")}
    column = next((name for name in header if name.strip().lower() in GAUGE_NAMES), None)
    labels = np.array(
        rows_of_file.texts(column) if column else ["gauge"] * len(rows_of_file.rows), dtype=np.str_
    )
    require(len(labels) > 0, file, "no rows")
    made: list[Gauge] = []
    for label in dict.fromkeys(labels.tolist()):
        rows = labels == label
        if all(np.isnan(v[rows]).all() for v in of_all.values()):
            warnings.warn(f"{one_line(label)}: passed over: it has no values", stacklevel=2)
            continue
        at = {q: v[rows] for q, v in read.items() if q in ("x_m", "y_m") or q[:2] in ("x ", "y ")}
        if any(np.ptp(v) > 0 for v in at.values()):
            raise DataError(f"{file}: gauge '{one_line(label)}' is at more than one place")
        x_m, y_m = (float(at[q][0]) for q in ("x_m", "y_m"))
        places: dict[str, tuple[float, float]] = {}
        doubts: tuple[str, ...] = ()
        if len(at) > 2:
            places = {
                arm: (float(at.get(f"x {arm}", [x_m])[0]), float(at.get(f"y {arm}", [y_m])[0]))
                for arm in arms
            }
        elif arms:
            doubts = (
                "arms of the rosette are taken as at one place; give that of each by columns such as "
                f"x_{next(iter(arms))}_mm: 1 mm apart they change Gamma",
            )
        try:
            own = {part: v[rows] for part, v in of_all.items()}
            gauge = Gauge(label, x_m, y_m, read["time_s"][rows], own, is_strain, 0.0, places, doubts)
            # Of arms that became components, those are cut off, not these.
            flat_s = [f for v in arms.values() for f in flat_tops(read["time_s"][rows], v[rows])]
            made.append(gauge.changed(flat_s) if arms else gauge)
        except CaseError as error:
            raise DataError(f"{file}: {error}") from None
    require(bool(made), file, "no gauge has values")
    return made


def some_gauges(given: Iterable[Gauge]) -> list[Gauge]:
    gauges = in_order(given, "gauges", "a list of gauges")
    if not gauges:
        raise CaseError("gauges is empty")
    return [instance(gauge, Gauge, f"gauges[{k}]") for k, gauge in enumerate(gauges)]


def gauges_of(run: OpenRun, *, stress: bool = False) -> list[Gauge]:
    """A run's probes as gauges of strain, or of stress. Raises CaseError for a run without probes."""
    probes = instance(run, OpenRun, "run").probes
    if probes is None:
        raise CaseError(f"{run.folder}: the run has no probes; give its case a table [probes]")
    of = "stress_{}_Pa" if flag(stress, "stress") else "strain_{}"
    found = []
    for name in probes.probe.values:
        at = probes.sel(probe=name)
        values = {part: at[of.format(part)].to_numpy() for part in COMPONENTS}
        found.append(
            Gauge(str(name), float(at.x_m), float(at.y_m), probes.time_s.to_numpy(), values, not stress)
        )
    return found
