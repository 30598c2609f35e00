# SPDX-License-Identifier: BSD-3-Clause
"""Onsets picked in the traces of recorded events: when a tip passes each gauge. docs/picks.md"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr

from slipfront.cutting import line_through
from slipfront.errors import CaseError
from slipfront.gauges import Gauge, from_arms
from slipfront.given import in_order, instance, number, shown
from slipfront.onsets import records_of_events
from slipfront.records import Channel, Event, gauge_of
from slipfront.units import attributes

#: What a trace is of, the best for onsets first, and how it is picked where nothing else is said.
KINDS = {
    "shear": "peak", "contact_area": "area", "slip": "threshold", "strain": "threshold",
    "acceleration": "aic",
}  # fmt: skip
WORDS = {
    "shear": "shear strain or stress", "contact_area": "contact area", "slip": "slip or displacement",
    "strain": "strain or stress without shear", "acceleration": "acceleration",
}  # fmt: skip
TIMES_NOISE = 5.0  # that a trace must stand out of its noise
HOLD = 5  # samples that a trace stays above the threshold
LEAST = 10  # samples of the quiet part
#: Of a top, in noises and in its height: how far below it a parabola goes.
BELOW, SHALLOW, DEEP = 4.0, 0.02, 0.15
OUT = 3.0  # standard errors beyond which a slope counts
NO_NOISE = 1e-6  # of a trace's range: numbers of a computation have rounding
GAUSSIAN, SUDDEN = 3.0, 3.0  # kurtosis of noise; times that in the quiet part, beyond it, that counts
RISE = 0.1  # of the largest rise of the kurtosis, that its beginning is known to


class Onset(NamedTuple):
    time_s: float
    error_s: float  # standard
    doubt: str = ""


@dataclass(frozen=True)
class Trace:
    """What is picked: its quiet part about 0, over its largest number."""

    kind: str
    name: str
    x_m: float
    y_m: float
    time_s: np.ndarray
    values: np.ndarray
    noise: float
    n_quiet: int  # samples
    lag_s: float
    flat_s: tuple[tuple[float, float], ...] = ()
    doubts: tuple[str, ...] = ()

    @property
    def step_s(self) -> float:
        return float(np.median(np.diff(self.time_s)))

    def flat_within(self, first_s: float, last_s: float) -> tuple[float, float] | None:
        return next((f for f in self.flat_s if f[0] <= last_s and f[1] >= first_s), None)


def trace_of(
    kind: str, name: str, place: tuple[float, float], time_s: np.ndarray, values: np.ndarray, *,
    lags_s: list[float], flat_s: Iterable[tuple[float, float]], doubts: Iterable[str] = (),
    quiet_s: tuple[float, float] | None,
) -> Trace | str:  # fmt: skip
    """The trace less its mean, or the line where that has a slope, over the quiet part; or what is wrong."""
    known = np.isfinite(values)
    time_s, values = time_s[known], values[known]
    if not len(values):
        return "has no values"
    if not np.ptp(values) > 0:
        return "is the same number throughout"
    values = values / np.abs(values).max()
    if quiet_s is not None:
        quiet = (time_s >= quiet_s[0]) & (time_s <= quiet_s[1])
    else:
        to_s = time_s[0] / 2 if time_s[0] < 0 else time_s[0] + (time_s[-1] - time_s[0]) / 10
        quiet = time_s <= to_s
    if quiet.sum() < LEAST:
        return f"{int(quiet.sum())} samples are quiet, {LEAST} are needed: give others by quiet_s"
    mean, noise, slope, error = line_through(time_s[quiet], values[quiet])
    line = slope * (time_s - time_s[quiet].mean()) if abs(slope) > OUT * error else 0.0
    rest = values - mean - line
    noise = max(noise, NO_NOISE * float(np.ptp(rest)))
    n_quiet = int(np.flatnonzero(quiet)[-1]) + 1
    lag_s = float(np.mean(lags_s)) if lags_s else 0.0
    return Trace(kind, name, *place, time_s, rest, noise, n_quiet, lag_s, tuple(flat_s), tuple(doubts))


def lags_of(channels: Iterable[Channel]) -> list[float]:
    return [1 / (2 * np.pi * c.bandwidth_Hz) for c in channels if c.bandwidth_Hz > 0]


def part_of(gauge: Gauge) -> tuple[str, np.ndarray, list[str]]:
    """The kind of a gauge's trace, its values, and doubts: shear where the gauge determines it."""
    if "xy" in gauge.values:
        return "shear", gauge.values["xy"], []
    arms = {float(part): v for part, v in gauge.values.items() if part not in ("xx", "yy")}
    if len(arms) == 3:
        doubts = ["its arms are at places of their own: shear as if at one"] if gauge.places_m else []
        return "shear", from_arms(arms)["xy"], doubts
    return "strain", gauge.values[gauge.parts[0]], []


def traces_of(
    event: Event, quiet_s: tuple[float, float] | None
) -> Iterator[tuple[str, str, Callable[[], Trace | str]]]:
    """Kind and name of each trace of an event that has a place, and how to make it."""
    of_gauge: dict[str, list[Channel]] = {}
    for c in event.channels.values():
        if c.kind.startswith(("strain", "stress")):
            of_gauge.setdefault(c.gauge, []).append(c)
    for name, own in of_gauge.items():
        try:
            gauge = gauge_of(name, own)
            kind, values, doubts = part_of(gauge)
        except CaseError as error:  # one that is dead, or arms that determine nothing
            is_shear = len(own) == 3 or any(c.kind.endswith("xy") for c in own)
            yield "shear" if is_shear else "strain", name, lambda why=str(error): why  # type: ignore[misc]
            continue
        yield kind, gauge.name, lambda k=kind, g=gauge, v=values, d=doubts, own=own: trace_of(  # type: ignore[misc]
            k, g.name, (g.x_m, g.y_m), g.time_s, v, lags_s=lags_of(own), flat_s=g.flat_s,
            doubts=[*g.doubts, *d], quiet_s=quiet_s,
        )  # fmt: skip
    for c in event.channels.values():
        kind = {"displacement": "slip"}.get(c.kind, c.kind)
        if kind in ("slip", "contact_area", "acceleration") and np.isfinite(c.x_m):
            yield kind, c.name, lambda k=kind, c=c: trace_of(  # type: ignore[misc]
                k, c.name, (c.x_m, c.y_m), c.time_s, c.values, lags_s=lags_of([c]), flat_s=c.flat_s,
                quiet_s=quiet_s,
            )  # fmt: skip


def largest_fall(values: np.ndarray) -> tuple[int, int]:
    """Between which samples values fall most."""
    last = int(np.argmax(np.maximum.accumulate(values) - values))
    return int(np.argmax(values[: last + 1])), last


def smoothed(values: np.ndarray, width: int) -> np.ndarray:
    """Means over an odd number of samples."""
    half = width // 2
    total = np.cumsum(np.pad(values, (half + 1, half), "edge"))
    return (total[2 * half + 1 :] - total[: -2 * half - 1]) / (2 * half + 1)


def about_top(values: np.ndarray, noise: float, top: int) -> tuple[int, int, int]:
    """The sample at a top, the first one about it and the end of them: down to 4 times the noise below it, at
    least 2 and at most 15 % of its height. Where that is less than the noise needs, means over some samples
    decide."""
    depth = float(np.clip(BELOW * noise, SHALLOW * values[top], DEEP * values[top]))
    width = 2 * min(int((BELOW * noise / depth) ** 2 / 2), len(values) // 20) + 1
    shown = smoothed(values, width)
    near = slice(max(top - width, 0), top + width + 1)
    top = near.start + int(np.argmax(shown[near]))
    below = shown < shown[top] - depth
    first = int(np.flatnonzero(below[:top])[-1]) + 1 if below[:top].any() else 0
    end = top + int(np.flatnonzero(below[top:])[0]) if below[top:].any() else len(values)
    return top, max(min(first, top - 2), 0), min(max(end, top + 3), len(values))


def top_of(time_s: np.ndarray, values: np.ndarray, noise: float, top: int) -> tuple[Onset, float, float]:
    """Of the parabola through the samples about a top, and the first and last times of these.

    The error is that of the parabola's top by the noise, or by the scatter about it where this is more; how
    far a cubic moves the top, since tops are uneven; and half a sample."""
    step_s = float(np.median(np.diff(time_s)))
    top, first, end = about_top(values, noise, top)
    t, w = time_s[first:end] - time_s[top], values[first:end]
    ends_s = float(time_s[first]), float(time_s[end - 1])
    half_s = max(float(t[-1] - t[0]), step_s) / 2
    made = None
    if len(t) > 2:
        u = t / half_s
        design = np.stack([u**2, u, np.ones_like(u)], axis=1)
        (a, b, c), *_ = np.linalg.lstsq(design, w, rcond=None)
        if a < 0 and u[0] <= -b / (2 * a) <= u[-1]:
            made = -b / (2 * a)
    if made is None:
        return Onset(float(time_s[top]), half_s, "its top is no parabola"), *ends_s
    rest = w - design @ [a, b, c]
    scatter = max(noise, float(np.sqrt(rest @ rest / (len(t) - 3))) if len(t) > 3 else 0.0)
    gradient = np.array([b / (2 * a**2), -1 / (2 * a), 0.0])
    error = scatter * float(np.sqrt(gradient @ np.linalg.inv(design.T @ design) @ gradient))
    moved = 0.0
    if len(t) > 4:
        slopes = np.polyder(np.polyfit(u, w, 3))
        bend = np.polyder(slopes)
        tops = [r.real for r in np.roots(slopes) if abs(r.imag) < 1e-9 and np.polyval(bend, r.real) < 0]
        moved = min((abs(r - made) for r in tops), default=1.0)
    error_s = half_s * min(float(np.hypot(error, moved)), 1.0)
    return Onset(float(time_s[top] + made * half_s), float(np.hypot(error_s, step_s / 2))), *ends_s


def top_before_fall(trace: Trace, times_noise: float) -> tuple[int, int] | None:
    """The sample with the largest value of either sign from which the trace falls most, and the sign.

    A dip follows a tip's peak, and the trace comes back from it: where the fall to the dip is half of that
    rise or more, the peak counts."""
    found = []
    for sign in (1, -1):
        w = sign * trace.values
        first, last = largest_fall(w)
        least = times_noise * trace.noise
        if w[first] > least and w[first] - w[last] > 2 * least:  # noise alone falls by some 8 times itself
            found.append((float(w[first] - w[last]), first, last, sign))
    if not found:
        return None
    (most, first, _, sign), *rest = sorted(found, reverse=True)
    for fall, peak, dip, sign_of_peak in rest:
        if abs(dip - first) > HOLD or 2 * fall < most:
            continue
        is_quiet = np.abs(trace.values[peak:dip]) < times_noise * trace.noise
        if 2 * np.count_nonzero(is_quiet) < dip - peak:  # of one passage, not of something earlier
            return peak, sign_of_peak
    return first, sign


def peak(trace: Trace, times_noise: float) -> Onset | str:
    """The largest value of either sign from which the trace falls most."""
    found = top_before_fall(trace, times_noise)
    if found is None:
        return f"no value before a fall stands {times_noise:g} times the noise out"
    top, sign = found
    made, first_s, last_s = top_of(trace.time_s, sign * trace.values, trace.noise, top)
    if flat := trace.flat_within(first_s, last_s):
        half_s = (flat[1] - flat[0]) / 2
        return Onset(flat[0] + half_s, float(np.hypot(half_s, trace.step_s / 2)), "its top was cut off")
    beside = np.abs(trace.time_s - made.time_s) > last_s - first_s
    means = smoothed(sign * trace.values, HOLD)
    as_high = trace.time_s[beside & (means > np.interp(made.time_s, trace.time_s, means) - trace.noise)]
    if not as_high.size or made.doubt:
        return made
    far_s = max(as_high - made.time_s, key=abs)
    doubt = f"as high within the noise {1e6 * abs(far_s):.3g} us {'later' if far_s > 0 else 'earlier'}"
    return made._replace(error_s=float(np.hypot(made.error_s, far_s)), doubt=doubt)


def threshold(trace: Trace, times_noise: float) -> Onset | str:
    """Where the trace passes times_noise times its noise to either side, and stays there for 5 samples."""
    size, level = np.abs(trace.values), times_noise * trace.noise
    above = np.convolve(size > level, np.ones(HOLD), "valid") > HOLD - 0.5
    if not above.any():
        return f"nothing stands {times_noise:g} times the noise out for {HOLD} samples"
    i = int(np.argmax(above))
    if i == 0:
        return f"stands {times_noise:g} times the noise out from the beginning"
    near = slice(max(i - 2, 0), i + 3)
    slope = float(np.polyfit(trace.time_s[near] - trace.time_s[i], size[near], 1)[0])
    share = (level - size[i - 1]) / (size[i] - size[i - 1])
    at_s = float(trace.time_s[i - 1] + share * (trace.time_s[i] - trace.time_s[i - 1]))
    error_s = trace.noise / slope if slope > 0 else np.inf
    longest_s = float(trace.time_s[-1] - trace.time_s[0])
    return Onset(at_s, float(np.hypot(min(error_s, longest_s), trace.step_s / 2)))


def up_to_largest(trace: Trace, times_noise: float) -> int | str:
    """Samples up to that which is farthest from the quiet part, of shear up to its peak."""
    size = np.abs(trace.values)
    top = int(np.argmax(size))
    if trace.kind == "shear" and (found := top_before_fall(trace, times_noise)):
        top = found[0]
    if not size[top] > times_noise * trace.noise:
        return f"nothing stands {times_noise:g} times the noise out"
    if top < trace.n_quiet:
        return "is largest in its quiet part: give another one by quiet_s"
    return top + 1


def aic(trace: Trace, times_noise: float) -> Onset | str:
    """Where two pieces with a variance each explain the trace best, up to its largest value, of shear its
    peak: the least of k log var(1..k) + (n - k - 1) log var(k+1..n) (Maeda 1985). The error is the standard
    deviation of the time by the weights exp(-AIC/2), and half a sample."""
    n = up_to_largest(trace, times_noise)
    if isinstance(n, str):
        return n
    v = trace.values[:n] / trace.noise

    def variances(of: np.ndarray) -> np.ndarray:
        k = np.arange(1, n + 1)
        return np.maximum(np.cumsum(of**2) / k - (np.cumsum(of) / k) ** 2, NO_NOISE)

    k = np.arange(LEAST // 2, n - 1)
    before, behind = variances(v)[k - 1], variances(v[::-1])[::-1][k]
    criterion = k * np.log(before) + (n - k - 1) * np.log(behind)
    least = int(np.argmin(criterion))
    times_s = (trace.time_s[k - 1] + trace.time_s[k]) / 2
    weight = np.exp(-(criterion - criterion[least]) / 2)
    spread_s = np.sqrt(np.average((times_s - times_s[least]) ** 2, weights=weight))
    return Onset(float(times_s[least]), float(np.hypot(spread_s, trace.step_s / 2)))


def kurtosis(trace: Trace, times_noise: float) -> Onset | str:
    """Where the rise to the largest value begins of a characteristic function: the kurtosis of the samples of
    a sliding window, a quarter of the quiet part long, over its largest value in the quiet part (Baillard et
    al. 2014; they sum all rises, to which single large samples of noise add). The error is the time of the
    first tenth of the rise, and half a sample."""
    n = up_to_largest(trace, times_noise)
    if isinstance(n, str):
        return n
    width = min(max(trace.n_quiet // 4, 2 * LEAST), n // 2)
    v = trace.values[:n] / trace.noise
    m1, m2, m3, m4 = (windowed(v**p, width) for p in (1, 2, 3, 4))
    variance = np.maximum(m2 - m1**2, NO_NOISE)
    fourth = m4 - 4 * m1 * m3 + 6 * m1**2 * m2 - 3 * m1**4
    # Of a variance that is a rest of large numbers the kurtosis is unknown: as that of noise.
    values = np.where(variance > NO_NOISE * m2, fourth / variance**2, GAUSSIAN)
    level = values[: max(trace.n_quiet - width, 1)].max()
    last = int(np.argmax(values))
    if not values[last] - GAUSSIAN > SUDDEN * (level - GAUSSIAN):
        return f"its kurtosis rises to {values[last]:.3g}, in the quiet part to {level:.3g}: nothing sudden"
    first = int(np.flatnonzero(values[:last] <= level)[-1]) + 1
    reached = values[first : last + 1] >= level + RISE * (values[last] - level)
    at = first + width - 1  # the last sample of its window
    rise_s = float(trace.time_s[at + int(np.argmax(reached))] - trace.time_s[at])
    return Onset(float(trace.time_s[at]), float(np.hypot(rise_s, trace.step_s / 2)))


def windowed(values: np.ndarray, width: int) -> np.ndarray:
    """Means over windows, by their last samples."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    return (total[width:] - total[:-width]) / width


def area(trace: Trace, times_noise: float) -> Onset | str:
    """Of the largest fall, where it is steepest: the top of the slopes of lines through few samples, as many
    as make the steepest 5 times its error."""
    first, last = largest_fall(trace.values)
    if not trace.values[first] - trace.values[last] > times_noise * trace.noise:
        return f"no fall is {times_noise:g} times the noise"
    width, n = 3, len(trace.values)
    while True:
        about = np.arange(width) - (width - 1) / 2
        slopes = -np.convolve(trace.values, about[::-1] / (about @ about), "valid")
        error = trace.noise / float(np.sqrt(about @ about))
        at = np.arange(len(slopes)) + width // 2
        inside = (at >= first) & (at <= last)
        top = int(np.argmax(np.where(inside, slopes, -np.inf)))
        if slopes[top] > TIMES_NOISE * error or 2 * width >= min(last - first + 1, n // 2):
            break
        width = 2 * width + 1
    made, *_ = top_of(trace.time_s[at], slopes, error, top)
    # Slopes of lines that share samples err together.
    return made._replace(error_s=made.error_s * float(np.sqrt(width)))


METHODS: Mapping[str, Callable[[Trace, float], Onset | str]] = {
    "peak": peak, "threshold": threshold, "aic": aic, "kurtosis": kurtosis, "area": area,
}  # fmt: skip
#: Methods of one kind alone.
OF_KIND = {"peak": "shear", "area": "contact_area"}


def pick(trace: Trace, by: str, times_noise: float = TIMES_NOISE) -> Onset | str:
    """The onset in a trace, less the delay of its bandwidth, that of a low pass of first order; or why there
    is none."""
    found = METHODS[by](trace, times_noise)
    if isinstance(found, str):
        return found
    doubts = [found.doubt, *trace.doubts]
    flat = trace.flat_within(found.time_s - found.error_s, found.time_s + found.error_s)
    if flat and by != "peak":
        doubts.append(f"the recorder was at the end of its range from {flat[0]:.6g} to {flat[1]:.6g} s")
    told = "; ".join(doubt for doubt in doubts if doubt)
    return Onset(found.time_s - trace.lag_s, found.error_s, told)


def kind_of(kinds: set[str], by: str | None, kind: str | None) -> str | None:
    """Of the traces that are picked, the best that an event has."""
    wanted = kind or OF_KIND.get(by or "")
    return next(
        (k for k in KINDS if k in kinds and wanted in (None, k) and not (k == "shear" and by == "kurtosis")),
        None,
    )


def checked(by: str | None, kind: str | None) -> None:
    for name, value, allowed in (("by", by, METHODS), ("kind", kind, KINDS)):
        if value is not None and value not in allowed:
            raise CaseError(f"{name} is {shown(value)}; it must be one of {', '.join(allowed)}")
    if by in OF_KIND and kind not in (None, OF_KIND[by]):
        raise CaseError(
            f"by is {by}, which picks {WORDS[OF_KIND[by]]}; kind is {kind}: leave one of them out"
        )
    if by == "kurtosis" and kind == "shear":
        raise CaseError("by is kurtosis, which picks what begins suddenly; shear rises long before a tip")


def pick_events(
    events: Iterable[Event],
    *,
    by: str | None = None,
    kind: str | None = None,
    times_noise: float = TIMES_NOISE,
    quiet_s: tuple[float, float] | None = None,
) -> xr.Dataset:
    """Onsets in the traces of events, those of `read_records` or `read_recorders` (docs/picks.md).

    by: "peak" of shear strain or stress, "threshold", "aic", "kurtosis" of all but shear, or "area", the
    steepest fall of contact area; by default what suits the kind. kind: of the traces that are picked:
    "shear", "contact_area", "slip", "strain", "acceleration"; by default the first that an event has.
    times_noise: that a trace must stand out of its noise, and the threshold. quiet_s: a pair of times since
    the event's between which nothing happens; by default the first half of what is before the event, of a
    record without that the first tenth.

    Returns a Dataset over `pick`: event, gauge, x_m, y_m, onset_s since the event's time, error_s, by, doubt.
    Its attribute `notes` says what was picked, and which traces have no pick and why."""
    checked(by, kind)
    least = number(times_noise, "times_noise", above=0, finite=True)
    if quiet_s is not None:
        pair = [number(end, "quiet_s") for end in in_order(quiet_s, "quiet_s", "a pair of times in s")]
        if len(pair) != 2 or not pair[0] < pair[1]:
            raise CaseError(f"quiet_s is {shown(quiet_s)}; it must be a pair of times in s that ascend")
        quiet_s = pair[0], pair[1]
    if not isinstance(events, Iterable):
        raise CaseError(f"events is {shown(events)}; it must be a list of events")
    rows: list[tuple[int, str, float, float, float, float, str, str]] = []
    picked: Counter[tuple[str, str]] = Counter()
    left: Counter[str] = Counter()
    without: list[str] = []
    for event in events:
        instance(event, Event, "an event")
        found = list(traces_of(event, quiet_s))
        of = kind_of({k for k, *_ in found}, by, kind)
        if of is None:
            wanted = kind or OF_KIND.get(by or "")
            what = WORDS[wanted] if wanted else "strain, contact area, slip or acceleration"
            without.append(f"event {event.number}: no pick: no channel of {what} with a place")
            continue
        method = by or KINDS[of]
        for own, name, make in found:
            if own != of:
                left[own] += 1
                continue
            trace = make()
            onset = trace if isinstance(trace, str) else pick(trace, method, least)
            if isinstance(onset, str) or isinstance(trace, str):
                without.append(f"event {event.number}: {name}: no pick: {onset}")
                continue
            rows.append((event.number, name, trace.x_m, trace.y_m, onset.time_s, onset.error_s, method,
                         onset.doubt))  # fmt: skip
            picked[method, of] += 1
    notes = [f"{n} picks by {method}, of {WORDS[of]}" for (method, of), n in picked.items()]
    notes += [f"not picked: {n} of {WORDS[of]} (kind {of})" for of, n in left.items()]
    names = ("event", "gauge", "x_m", "y_m", "onset_s", "error_s", "by", "doubt")
    columns = zip(*rows, strict=True) if rows else [[]] * len(names)
    types = (np.int64, np.str_, float, float, float, float, np.str_, np.str_)
    made = {
        name: ("pick", np.array(list(values), dtype=kind_of_number), attributes(name))
        for name, values, kind_of_number in zip(names, columns, types, strict=True)
    }
    return xr.Dataset(made, attrs={"notes": [*notes, *without]})


def onsets_of(picks: xr.Dataset) -> dict[int | None, xr.Dataset]:
    """Picks as records of onsets, by events, as read_each reads them."""
    read = {name: picks[name].to_numpy() for name in ("x_m", "onset_s", "error_s")}
    return records_of_events("picks", read, picks["event"].to_numpy(), picks["doubt"].to_numpy())
