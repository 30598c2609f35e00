# SPDX-License-Identifier: BSD-3-Clause
"""What a run computes at gauges and slip sensors beside their traces."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar

from slipfront.compare.misfit import Observed, of_all, rms
from slipfront.errors import CaseError
from slipfront.gauges import (
    Gauge,
    amplifier,
    filtered,
    gauges_of,
    largest_departure,
    smooth,
    weights,
    worked_on,
)
from slipfront.given import in_order, instance, number, shown
from slipfront.opened import OpenRun
from slipfront.records import Channel
from slipfront.tip_fit import correlated

LEAST_SHARED = 0.5  # of the shorter of record and run
SAME_PLACE_M = 1e-6
MOST_SHIFTS = 4000  # that are tried, before the best is refined
MOST_TIMES = 1000  # of a trace in that search
AT_A_TIME = 64  # shifts, for the memory that these take
MOST_UNCOVERED = 0.9  # share of a record below which its cover is told


@dataclass(frozen=True)
class Trace:
    """What was recorded at a place, and what a run computes there, each on its own clock."""

    name: str
    x_m: float
    parts: list[str]  # components of strain or stress, angles of arms, or slip
    unit: str  # of CF
    time_s: np.ndarray
    measured: np.ndarray  # [parts, times]
    run_s: np.ndarray
    computed: np.ndarray  # [parts, times of the run]

    def thinned(self) -> Trace:
        """With no more than MOST_TIMES of its record."""
        each = -(-len(self.time_s) // MOST_TIMES)
        return replace(self, time_s=self.time_s[::each], measured=self.measured[:, ::each])

    def shared(self, own_s: np.ndarray) -> np.ndarray:
        """Which times of the record, on the run's clock, the run has as well; none where they are few.
        [..., times]"""
        at = (own_s >= self.run_s[0]) & (own_s <= self.run_s[-1])
        last_s, first_s = np.where(at, own_s, -np.inf).max(axis=-1), np.where(at, own_s, np.inf).min(axis=-1)
        least_s = LEAST_SHARED * min(np.ptp(self.time_s), np.ptp(self.run_s))
        return at & (last_s - first_s >= least_s)[..., None]

    def both(self, shift_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where both are: times, measured, computed, on the run's clock = the record's + shift, each about
        its own mean: gauges have no known zero. Empty where they share few times. [parts, times]"""
        own_s = self.time_s + shift_s
        at = self.shared(own_s)
        record = self.measured[:, at]
        difference = record - np.array([np.interp(own_s[at], self.run_s, row) for row in self.computed])
        if at.any():
            record, difference = (a - a.mean(axis=1, keepdims=True) for a in (record, difference))
        return own_s[at], record, record - difference

    def misfits(self, shifts_s: np.ndarray) -> np.ndarray:
        """Of each part: rms of the difference over that of the record; infinite where they share few
        times. [shifts, parts]"""
        own_s = self.time_s + shifts_s[:, None]
        at = self.shared(own_s)
        n = at.sum(axis=1)

        def square(values: np.ndarray) -> np.ndarray:
            """Mean square about the mean, where both are. [shifts]"""
            mean = (values * at).sum(axis=1) / np.maximum(n, 1)
            return (at * (values - mean[:, None]) ** 2).sum(axis=1) / np.maximum(n, 1)

        found = np.empty((len(shifts_s), len(self.parts)))
        for k, (measured, computed) in enumerate(zip(self.measured, self.computed, strict=True)):
            left = square(measured - np.interp(own_s, self.run_s, computed))
            power = square(np.broadcast_to(measured, own_s.shape))
            found[:, k] = np.where(n == 0, np.inf, np.sqrt(left / np.maximum(power, 1e-300)))
        return found

    def misfit(self, shift_s: float) -> np.ndarray:
        """The same of one shift. [parts]"""
        return self.misfits(np.array([shift_s]))[0]

    def error(self, shift_s: float) -> np.ndarray:
        """Standard errors of these; differences that follow one another count as fewer."""
        _, record, run = self.both(shift_s)
        n = [len(row) / correlated(row[None]) if row.any() else len(row) for row in record - run]
        return self.misfit(shift_s) / np.sqrt(2 * np.array(n))


def probes_of(run: OpenRun, is_strain: bool) -> list[Gauge]:
    try:
        return gauges_of(run, stress=not is_strain)
    except CaseError as error:
        told = str(error)
        raise CaseError(told if told.startswith(str(run.folder)) else f"{run.folder}: {told}") from None


def computed_at(
    run: OpenRun, every: list[Gauge], name: str, place: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Times, and xx, yy, xy of a run's probes at the place of a gauge [3, times]: a probe there, or linear
    between two of its height that are no farther apart than this."""
    x_m, y_m = place
    probes = [g for g in every if abs(g.y_m - y_m) < SAME_PLACE_M]
    left = max((g for g in probes if g.x_m <= x_m + SAME_PLACE_M), key=lambda g: g.x_m, default=None)
    right = min((g for g in probes if g.x_m >= x_m - SAME_PLACE_M), key=lambda g: g.x_m, default=None)
    if left is None or right is None or right.x_m - left.x_m > abs(y_m) + SAME_PLACE_M:
        raise CaseError(
            f"{run.folder}: no probe at gauge {name}, x = {x_m:g}, y = {y_m:g} m, nor two of this "
            "height on both sides, no farther apart than it"
        )
    apart_m = right.x_m - left.x_m
    share = float(np.clip((x_m - left.x_m) / apart_m, 0, 1)) if apart_m > 0 else 0.0
    pair = zip(left.values.values(), right.values.values(), strict=True)
    return left.time_s, np.array([(1 - share) * a + share * b for a, b in pair])


@dataclass(frozen=True)
class SlipSensor:
    """A record of slip in m at a place of the interface."""

    name: str
    x_m: float
    time_s: np.ndarray
    values: dict[str, np.ndarray]  # of slip alone, as a gauge has components
    smoothing_s: float = 0.0
    bandwidth_Hz: float = np.inf

    def prepared(self, **how: Any) -> SlipSensor:
        """As Gauge.prepared."""
        time_s, values, own_s = worked_on(self.name, self.time_s, self.values, **how)
        return replace(
            self, time_s=time_s, values=values, smoothing_s=float(np.hypot(self.smoothing_s, own_s))
        )

    def peak(self, part: str) -> float:
        return largest_departure(self.values[part])


def sensor_of(channel: Channel) -> SlipSensor:
    """A channel of kind slip."""
    if channel.kind != "slip":
        raise CaseError(f"channel {channel.name} is of kind {channel.kind}; slip alone is compared")
    known = np.isfinite(channel.values)
    if np.count_nonzero(known) < 2:
        raise CaseError(f"channel {channel.name} has fewer than two values")
    bandwidth_Hz = channel.bandwidth_Hz if channel.bandwidth_Hz > 0 else np.inf
    values = {"slip": channel.values[known]}
    return SlipSensor(channel.name, channel.x_m, channel.time_s[known], values, bandwidth_Hz=bandwidth_Hz)


def slip_at(run: OpenRun, sensor: SlipSensor) -> tuple[np.ndarray, np.ndarray]:
    """Times, and slip [1, times], linear between the nodes about the sensor."""
    history, x_m = run.history, run.x_m
    if not x_m[0] <= sensor.x_m <= x_m[-1]:
        raise CaseError(
            f"{run.folder}: {sensor.name} records slip at x = {sensor.x_m:g} m; the interface goes from "
            f"{x_m[0]:g} to {x_m[-1]:g} m"
        )
    right = int(np.clip(np.searchsorted(x_m, sensor.x_m), 1, len(x_m) - 1))
    share = (sensor.x_m - x_m[right - 1]) / (x_m[right] - x_m[right - 1])
    pair = history["slip_m"].isel(x_m=[right - 1, right]).to_numpy()
    return history["time_s"].to_numpy(), ((1 - share) * pair[:, 0] + share * pair[:, 1])[None]


def strain_at(run: OpenRun, gauge: Gauge, probes: list[Gauge]) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the components or arms of a gauge by a run's probes [parts, times]."""
    rows = []
    for part in gauge.parts:
        of_part = weights(part)
        assert of_part is not None  # as the gauge was made
        place = gauge.places_m.get(part, (gauge.x_m, gauge.y_m))
        time_s, components = computed_at(run, probes, gauge.name, place)
        rows.append(of_part @ components)
    return time_s, np.array(rows)


def trace_of(record: Gauge | SlipSensor, run: OpenRun, probes: Callable[[bool], list[Gauge]]) -> Trace:
    """The run passes the record's filter and its amplifier, a low-pass of first order. probes: of the run, of
    strain or of stress."""
    if isinstance(record, Gauge):
        parts, unit = record.parts, "1" if record.is_strain else "Pa"
        run_s, computed = strain_at(run, record, probes(record.is_strain))
    else:
        parts, unit = ["slip"], "m"
        run_s, computed = slip_at(run, record)
    if record.smoothing_s > 0:
        run_s, values = filtered(run_s, dict(zip(parts, computed, strict=True)), record.smoothing_s)
        computed = np.array(list(values.values()))
    if record.bandwidth_Hz < np.inf:
        step_s = (run_s[-1] - run_s[0]) / (len(run_s) - 1)
        past = amplifier(record.bandwidth_Hz, step_s, len(run_s))
        computed = np.array([smooth(np.pad(row, (len(past) - 1, 0), "edge"), past) for row in computed])
    measured = np.array([record.values[part] for part in parts])
    return Trace(record.name, record.x_m, parts, unit, record.time_s, measured, run_s, computed)


def traces_of(records: Iterable[Gauge | SlipSensor | Channel], run: OpenRun) -> tuple[list[Trace], list[str]]:
    """Those that change, each with a name of its own, and notes."""
    instance(run, OpenRun, "run")
    given = in_order(records, "records", "a list of gauges, or of channels of slip")
    if not given:
        raise CaseError("records is empty")
    made, notes = [], []
    probes = cache(partial(probes_of, run))  # reading them takes longer than all else
    for k, record in enumerate(given):
        of = sensor_of(record) if isinstance(record, Channel) else record
        if not isinstance(of, Gauge | SlipSensor):
            raise CaseError(f"records[{k}] is {shown(record)}; it must be a gauge, or a channel of slip")
        trace = trace_of(of, run, probes)
        changes = [bool(np.ptp(row) > 0) for row in trace.measured]
        if constant := [part for part, does in zip(trace.parts, changes, strict=True) if not does]:
            notes.append(f"{trace.name}: {', '.join(constant)} does not change: left out")
        if any(changes):
            kept = [part for part, does in zip(trace.parts, changes, strict=True) if does]
            made.append(replace(trace, parts=kept, measured=trace.measured[changes],
                                computed=trace.computed[changes]))  # fmt: skip
    if not made:
        raise CaseError("no trace of the records changes")
    names = [trace.name for trace in made]
    made = [replace(t, name=f"{t.name}, slip") if names.count(t.name) > 1 and t.unit == "m" else t
            for t in made]  # fmt: skip
    names = [trace.name for trace in made]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise CaseError(f"several traces are called {', '.join(twice)}; rename all but one")
    return made, notes


def shifts_of(traces: list[Trace], within_s: float) -> tuple[float, float]:
    """First and last shift, up to within_s, at which records and run share LEAST_SHARED of the shorter."""
    first, last = -within_s, within_s
    for trace in traces:
        (a, b), (c, d) = trace.time_s[[0, -1]], trace.run_s[[0, -1]]
        least_s = LEAST_SHARED * min(b - a, d - c)
        first, last = max(first, c - b + least_s), min(last, d - a - least_s)
    if first > last:
        up_to = f"each shift of the clock up to within_s = {within_s:g} s; widen it, or"
        shifts = "any one shift of their clocks;" if within_s == np.inf else up_to
        raise CaseError(
            f"{', '.join(trace.name for trace in traces)}: records and run share less than half of their "
            f"times at {shifts} move clocks by shift_s, in s, or leave a record out"
        )
    return first, last


def best_shift(traces: list[Trace], within_s: float) -> float:
    """That of the least mean square of all misfits: of even shifts, by some of the times, then between the
    neighbours of the best by all."""
    first, last = shifts_of(traces, within_s)

    def costs(shifts_s: np.ndarray, of: list[Trace]) -> np.ndarray:
        found = np.mean([(trace.misfits(shifts_s) ** 2).mean(axis=1) for trace in of], axis=0)
        return np.where(np.isfinite(found), found, np.inf)

    def cost(shift_s: float) -> float:
        return float(costs(np.array([shift_s]), traces)[0])

    if within_s == 0:
        return 0.0
    if first == last:
        return first
    step = min(float(np.median(np.diff(trace.time_s))) for trace in traces)
    n = int(np.ceil((last - first) / max(step, (last - first) / MOST_SHIFTS)))
    shifts = np.union1d(np.linspace(first, last, n + 1), [0.0] if first <= 0 <= last else [])
    thin = [trace.thinned() for trace in traces]
    some = np.array_split(shifts, -(-len(shifts) // AT_A_TIME))
    k = int(np.argmin(np.concatenate([costs(of, thin) for of in some])))
    ends = shifts[max(k - 1, 0)], shifts[min(k + 1, len(shifts) - 1)]
    refined = minimize_scalar(cost, bounds=ends, method="bounded", options={"xatol": 1e-6 * step}).x
    return float(min((shifts[k], refined), key=cost))


FITTED_TIMES = 200  # of a trace, value by value


def observed_traces(
    records: Iterable[Gauge | SlipSensor | Channel],
    run: OpenRun,
    *,
    within_s: float = np.inf,
    clock_is_known: bool = False,
    gain_is_known: bool = True,
) -> list[Observed]:
    """Components of traces value by value, at the shift common to all; before the run begins its first value,
    beyond its end its last one.

    clock_is_known: whether the records' clock begins with the run's; gain_is_known: whether amplitudes count.
    """
    traces, _ = traces_of(records, run)
    shift_s = 0.0 if clock_is_known else best_shift(traces, within_s)
    found = []
    for trace in traces:
        each = -(-len(trace.time_s) // FITTED_TIMES)
        time_s = trace.time_s[::each]
        for part, measured, computed in zip(trace.parts, trace.measured, trace.computed, strict=True):
            found.append(
                Observed(
                    f"{trace.name} {part}" if part != "slip" else trace.name,
                    trace.unit,
                    [f"t = {t:.6g} s" for t in time_s],
                    measured[::each],
                    np.full(len(time_s), np.nan),
                    np.interp(time_s + shift_s, trace.run_s, computed),
                    has_offset=True,
                    has_gain=not gain_is_known,
                )
            )
    return found


def compare_traces(
    records: Iterable[Gauge | SlipSensor | Channel], run: OpenRun, *, within_s: float = np.inf
) -> xr.Dataset:
    """A run beside traces: its probes at the places of gauges, its slip at those of slip sensors.

    records: gauges, as `read_gauges` and `Event.gauges` have them, and channels of kind slip.
    within_s: the largest shift of the clock that is tried, by default all that leave half of the shorter of
    record and run; 0: none. The run passes the filter that `prepared` has put on a record, and its amplifier
    of bandwidth_Hz.

    Returns a Dataset over `trace` and `component`: misfit at the shift common to all, rms of the difference
    over that of the record, both about their means, 0 where they agree, and misfit_error, its standard
    error; own_misfit at each trace's own shift; shift_s and own_shift_s: the run's clock less the record's.
    NaN for components that were not recorded. Of all: misfit_of_all, the root of their mean square, with
    misfit_of_all_error; covered, the share of a record's times that the run has. A component that does not
    change is left out. `notes` says what speaks against the comparison."""
    traces, notes = traces_of(records, run)
    within = number(within_s, "within_s", least=0)
    shift = best_shift(traces, within)
    own = [best_shift([trace], within) for trace in traces]
    parts = list(dict.fromkeys(part for trace in traces for part in trace.parts))
    found = {name: np.full((len(traces), len(parts)), np.nan)
             for name in ("misfit", "misfit_error", "own_misfit")}  # fmt: skip
    for k, trace in enumerate(traces):
        at = [parts.index(part) for part in trace.parts]
        found["misfit"][k, at], found["misfit_error"][k, at] = trace.misfit(shift), trace.error(shift)
        found["own_misfit"][k, at] = trace.misfit(own[k])
    shifts = {"all together": shift} | {t.name: s for t, s in zip(traces, own, strict=True)}
    ends = [name for name, s in shifts.items() if 0 < within < np.inf and abs(s) > 0.999 * within]
    if ends:
        notes.append(f"shift at the end of its range, within_s = {within:g} s: {', '.join(ends)}; widen it")
    large = [t.name for k, t in enumerate(traces) if np.nanmax(found["misfit"][k]) > 1]
    if large:
        notes.append(f"the run explains nothing of a component of {', '.join(large)}")
    shared = np.array([len(trace.both(shift)[0]) for trace in traces])
    covered = shared / np.array([len(trace.time_s) for trace in traces])
    if (covered < MOST_UNCOVERED).any():
        notes.append(
            f"the run covers {100 * covered.min():.0f} % of a record: {traces[covered.argmin()].name}"
        )
    total = rms(found["misfit"].ravel(), found["misfit_error"].ravel())
    return xr.Dataset(
        {name: (("trace", "component"), values, {"units": "1"}) for name, values in found.items()}
        | {"own_shift_s": ("trace", own, {"units": "s"}), "shift_s": ((), shift, {"units": "s"})}
        | {"covered": ("trace", covered, {"units": "1", "long_name": "share of the record's times"})}
        | {"n": ((), int(shared.sum()), {"long_name": "times that both have"})}
        | of_all(total, "1"),
        {"trace": [t.name for t in traces], "component": parts, "x_m": ("trace", [t.x_m for t in traces])},
        {"notes": notes},
    )
