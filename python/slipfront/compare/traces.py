# SPDX-License-Identifier: BSD-3-Clause
"""What a run computes at gauges and slip sensors beside their traces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar

from slipfront.compare.misfit import of_all, rms
from slipfront.errors import CaseError
from slipfront.gauges import Gauge, amplifier, filtered, gauges_of, smooth, weights
from slipfront.given import in_order, instance, number, shown
from slipfront.opened import OpenRun
from slipfront.records import Channel
from slipfront.tip_fit import correlated

LEAST_SHARED = 0.5  # of the shorter of record and run
SAME_PLACE_M = 1e-6
MOST_SHIFTS = 500  # to each side, before the best is refined
MOST_TIMES = 5000  # of a trace in that search


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

    def both(self, shift_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where both are: times, measured, computed, on the run's clock = the record's + shift, each about
        its own mean: gauges have no known zero. Empty where they share few times. [parts, times]"""
        own_s = self.time_s + shift_s
        at = (own_s >= self.run_s[0]) & (own_s <= self.run_s[-1])
        shared_s = np.ptp(own_s[at]) if at.any() else 0.0
        if shared_s < LEAST_SHARED * min(np.ptp(own_s), np.ptp(self.run_s)):
            at[:] = False
        record = self.measured[:, at]
        difference = record - np.array([np.interp(own_s[at], self.run_s, row) for row in self.computed])
        if at.any():
            record, difference = (a - a.mean(axis=1, keepdims=True) for a in (record, difference))
        return own_s[at], record, record - difference

    def misfit(self, shift_s: float) -> np.ndarray:
        """Of each part: rms of the difference over that of the record; infinite where they share few
        times."""
        _, record, run = self.both(shift_s)
        if record.shape[1] == 0:
            return np.full(len(self.parts), np.inf)
        power = np.maximum((record**2).mean(axis=1), 1e-300)
        return np.sqrt(((record - run) ** 2).mean(axis=1) / power)

    def error(self, shift_s: float) -> np.ndarray:
        """Standard errors of these; differences that follow one another count as fewer."""
        _, record, run = self.both(shift_s)
        n = [len(row) / correlated(row[None]) if row.any() else len(row) for row in record - run]
        return self.misfit(shift_s) / np.sqrt(2 * np.array(n))


def computed_at(run: OpenRun, gauge: Gauge, place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Times, and xx, yy, xy of a run's probes at a place [3, times]: a probe there, or linear between two of
    its height that are no farther apart than this."""
    x_m, y_m = place
    probes = [g for g in gauges_of(run, stress=not gauge.is_strain) if abs(g.y_m - y_m) < SAME_PLACE_M]
    left = max((g for g in probes if g.x_m <= x_m + SAME_PLACE_M), key=lambda g: g.x_m, default=None)
    right = min((g for g in probes if g.x_m >= x_m - SAME_PLACE_M), key=lambda g: g.x_m, default=None)
    if left is None or right is None or right.x_m - left.x_m > abs(y_m) + SAME_PLACE_M:
        raise CaseError(
            f"{run.folder}: no probe at gauge {gauge.name}, x = {x_m:g}, y = {y_m:g} m, nor two of this "
            "height on both sides, no farther apart than it"
        )
    apart_m = right.x_m - left.x_m
    share = float(np.clip((x_m - left.x_m) / apart_m, 0, 1)) if apart_m > 0 else 0.0
    pair = zip(left.values.values(), right.values.values(), strict=True)
    return left.time_s, np.array([(1 - share) * a + share * b for a, b in pair])


def trace_of_gauge(gauge: Gauge, run: OpenRun) -> Trace:
    """The probes pass the record's filter and its amplifier, a low-pass of first order."""
    rows = []
    for part in gauge.parts:
        of_part = weights(part)
        assert of_part is not None  # as the gauge was made
        run_s, components = computed_at(run, gauge, gauge.places_m.get(part, (gauge.x_m, gauge.y_m)))
        rows.append(of_part @ components)
    if gauge.smoothing_s > 0:
        run_s, values = filtered(run_s, dict(zip(gauge.parts, rows, strict=True)), gauge.smoothing_s)
        rows = list(values.values())
    if gauge.bandwidth_Hz < np.inf:
        past = amplifier(gauge.bandwidth_Hz, (run_s[-1] - run_s[0]) / (len(run_s) - 1))
        rows = [smooth(np.pad(row, (len(past) - 1, 0), "edge"), past) for row in rows]
    computed = np.array(rows)
    measured = np.array([gauge.values[part] for part in gauge.parts])
    unit = "1" if gauge.is_strain else "Pa"
    return Trace(gauge.name, gauge.x_m, gauge.parts, unit, gauge.time_s, measured, run_s, computed)


def trace_of_slip(channel: Channel, run: OpenRun) -> Trace:
    history = run.history
    if not run.x_m[0] <= channel.x_m <= run.x_m[-1]:
        raise CaseError(
            f"{run.folder}: {channel.name} records slip at x = {channel.x_m:g} m; the interface goes from "
            f"{run.x_m[0]:g} to {run.x_m[-1]:g} m"
        )
    known = np.isfinite(channel.values)
    nodes = np.clip(np.searchsorted(run.x_m, channel.x_m) + np.array([-1, 0]), 0, len(run.x_m) - 1)
    pair = history["slip_m"].isel(x_m=nodes).to_numpy()
    apart_m = float(np.diff(run.x_m[nodes])[0])
    share = (channel.x_m - run.x_m[nodes[0]]) / apart_m if apart_m > 0 else 0.0
    computed = (1 - share) * pair[:, 0] + share * pair[:, 1]
    return Trace(
        channel.name, channel.x_m, ["slip"], "m", channel.time_s[known], channel.values[None, known],
        history["time_s"].to_numpy(), computed[None],
    )  # fmt: skip


def traces_of(records: Iterable[Gauge | Channel], run: OpenRun) -> list[Trace]:
    instance(run, OpenRun, "run")
    given = in_order(records, "records", "a list of gauges, or of channels of slip")
    if not given:
        raise CaseError("records is empty")
    made = []
    for k, record in enumerate(given):
        if isinstance(record, Gauge):
            made.append(trace_of_gauge(record, run))
        elif isinstance(record, Channel) and record.kind == "slip":
            made.append(trace_of_slip(record, run))
        else:
            raise CaseError(f"records[{k}] is {shown(record)}; it must be a gauge, or a channel of slip")
    return made


def best_shift(traces: list[Trace], within_s: float) -> float:
    """That of the least mean square of all misfits: of even shifts, by some of the times, then between the
    neighbours of the best by all."""

    def cost(shift_s: float, of: list[Trace] = traces) -> float:
        return float(np.mean([np.mean(trace.misfit(shift_s) ** 2) for trace in of]))

    if within_s == 0:
        return 0.0
    step = min(float(np.median(np.diff(trace.time_s))) for trace in traces)
    n = int(np.ceil(within_s / max(step, within_s / MOST_SHIFTS)))
    shifts = np.linspace(-within_s, within_s, 2 * n + 1)
    thin = [trace.thinned() for trace in traces]
    k = int(np.argmin([cost(s, thin) for s in shifts]))
    ends = shifts[max(k - 1, 0)], shifts[min(k + 1, 2 * n)]
    refined = minimize_scalar(cost, bounds=ends, method="bounded", options={"xatol": 1e-6 * step}).x
    return float(min((shifts[k], refined), key=cost))


def compare_traces(
    records: Iterable[Gauge | Channel], run: OpenRun, *, within_s: float = 50e-6
) -> xr.Dataset:
    """A run beside traces: its probes at the places of gauges, its slip at those of slip sensors.

    records: gauges, as `read_gauges` and `Event.gauges` have them, and channels of kind slip.
    within_s: the largest shift of the clock that is tried; 0: none. The probes pass the filter that
    `prepared` has put on a record, and its amplifier of bandwidth_Hz.

    Returns a Dataset over `trace` and `component`: misfit at the shift common to all, rms of the difference
    over that of the record, both about their means, 0 where they agree, and misfit_error, its standard
    error; own_misfit at each trace's own shift; shift_s and own_shift_s: the run's clock less the record's.
    NaN for components that were not recorded. Of all: misfit_of_all, the root of their mean square, with
    misfit_of_all_error. `notes` says what speaks against the comparison."""
    traces = traces_of(records, run)
    within = number(within_s, "within_s", least=0, finite=True)
    shift = best_shift(traces, within)
    if not np.isfinite(traces[0].misfit(shift)).all():
        raise CaseError(
            f"records and run share less than half of their times at each shift of the clock up to within_s "
            f"= {within:g} s; widen it, or move the records' clock by shift_s, in s"
        )
    own = [best_shift([trace], within) for trace in traces]
    parts = list(dict.fromkeys(part for trace in traces for part in trace.parts))
    found = {name: np.full((len(traces), len(parts)), np.nan)
             for name in ("misfit", "misfit_error", "own_misfit")}  # fmt: skip
    for k, trace in enumerate(traces):
        at = [parts.index(part) for part in trace.parts]
        found["misfit"][k, at], found["misfit_error"][k, at] = trace.misfit(shift), trace.error(shift)
        found["own_misfit"][k, at] = trace.misfit(own[k])
    shifts = {"all together": shift} | {t.name: s for t, s in zip(traces, own, strict=True)}
    ends = [name for name, s in shifts.items() if within > 0 and abs(s) > 0.999 * within]
    notes = []
    if ends:
        notes.append(f"shift at the end of its range, within_s = {within:g} s: {', '.join(ends)}; widen it")
    large = [t.name for k, t in enumerate(traces) if np.nanmax(found["misfit"][k]) > 1]
    if large:
        notes.append(f"the run explains nothing of a component of {', '.join(large)}")
    total = rms(found["misfit"].ravel(), found["misfit_error"].ravel())
    return xr.Dataset(
        {name: (("trace", "component"), values, {"units": "1"}) for name, values in found.items()}
        | {"own_shift_s": ("trace", own, {"units": "s"}), "shift_s": ((), shift, {"units": "s"})}
        | of_all(total, "1"),
        {"trace": [t.name for t in traces], "component": parts, "x_m": ("trace", [t.x_m for t in traces])},
        {"notes": notes},
    )
