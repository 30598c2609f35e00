# SPDX-License-Identifier: BSD-3-Clause
"""Cycles of stick-slip: a record of the shear force, or a table of its events, beside a sequence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from slipfront.compare.misfit import Estimate, Observed, of_all, rms
from slipfront.cutting import drops
from slipfront.errors import CaseError
from slipfront.files import DataError
from slipfront.given import column, holds, instance, number, whole
from slipfront.opened_sequence import OpenSequence

SHARE = 0.1  # of the largest drop, from which an event counts
STEMS = ("before", "after", "drop")
FAR = 10.0  # times, beyond which a mean may be in another unit
SKIPPED = 2  # first events, which depend on how the sample was put together
#: How a record has the shear force, by the beginning of its columns, and the unit.
FORMS = {"friction": "", "stress": "Pa", "force": "N"}
#: Names of what is compared, each with the unit of CF; that of forces is the record's.
QUANTITIES = {"interval_s": "s", "before": "", "drop": "", "slip_m": "m", "duration_s": "s"}


#: Their names in words.
NAMES = {
    "interval_s": "interval",
    "before": "shear before",
    "drop": "drop",
    "slip_m": "slip",
    "duration_s": "duration",
}


def name_of(form: str, stem: str) -> str:
    """Of a column, such as force_before_N."""
    return "_".join(part for part in (form, stem, FORMS[form]) if part)


class Statistics(NamedTuple):
    """Of a quantity over the events that count."""

    n: int
    mean: Estimate
    deviation: float


def statistics(values: np.ndarray) -> Statistics:
    known = values[np.isfinite(values)]
    n = known.size
    deviation = float(known.std(ddof=1)) if n > 1 else np.nan
    mean = float(known.mean()) if n else np.nan
    return Statistics(n, Estimate(mean, deviation / np.sqrt(n) if n else np.nan), deviation)


def events_of_force(
    time_s: ArrayLike, force_N: ArrayLike, *, drop_within_s: float, drop_share: float = SHARE
) -> dict[str, np.ndarray]:
    """Events of a record of the shear force in N: begin_s where it drops by a share of its range or more
    within a time, force_before_N and force_after_N the highest and lowest value within that time on both
    sides, as means over a quarter of it, which flatten the corners of a slow record. [events] Raises Error
    where it never drops, or drops are within the noise."""
    time = column({"time_s": time_s}, "record", "time_s", finite=True)
    values = column({"force_N": force_N}, "record", "force_N")
    if len(time) != len(values) or len(time) < 2 or not (np.diff(time) > 0).all():
        raise CaseError("times of the force must ascend, with a value each, two or more")
    within = number(drop_within_s, "drop_within_s", above=0, finite=True)
    share = number(drop_share, "drop_share", above=0, finite=True)
    known = np.isfinite(values)
    time, values = time[known], values[known]
    try:
        begin_s = drops("the force", time, values, share, within)
    except DataError as error:
        told = str(error).replace("within_s", "drop_within_s").replace("larger share", "larger drop_share")
        raise CaseError(told) from None
    if not begin_s.size:
        raise CaseError(
            f"the force never drops by {share:g} of its range within drop_within_s = {within:g} s"
        )
    width = max(int(round(within / float(np.median(np.diff(time))))) // 4, 1)
    sums = np.cumsum(np.insert(values, 0, 0.0))
    means = (sums[width:] - sums[:-width]) / width
    before, after = [], []
    for begin in begin_s:
        first, at, end = np.searchsorted(time, [begin - within, begin, begin + within])
        before.append(means[max(first, 0) : max(at - width + 1, first + 1)].max())
        after.append(means[min(at, len(means) - 1) : max(end - width + 1, at + 1)].min())
    return {"begin_s": begin_s, "force_before_N": np.array(before), "force_after_N": np.array(after)}


Events = dict[str, np.ndarray]  # begin_s, and of before, after, drop, slip_m, duration_s what is known


def values_of(events: Events, quantity: str) -> np.ndarray:
    return np.diff(events["begin_s"]) if quantity == "interval_s" else events[quantity]


def counting(of: Events, skipped: int, what: str) -> Events:
    """Without the first events, and without those that drop little beside the largest."""
    of = dict(of)
    if "drop" not in of and "before" in of and "after" in of:
        of["drop"] = of["before"] - of["after"]
    kept = np.ones(len(of["begin_s"]), dtype=bool)
    if "drop" in of and kept.any():
        kept = ~(of["drop"] < SHARE * np.nanmax(of["drop"]))
    if kept.sum() < skipped + 2:
        raise CaseError(
            f"{what} has {kept.sum()} events with a drop of {SHARE:g} of the largest or more; two behind the "
            f"first {skipped} are needed: give a lower skip_events, or more events"
        )
    return {name: values[kept][skipped:] for name, values in of.items()}


def events_of_sequence(sequence: OpenSequence, form: str, thickness_m: float | None) -> Events:
    """The events of a sequence as a record of this form would have them."""
    events = sequence.events
    if form == "force" and thickness_m is None:
        raise CaseError("the record is of a force in N: give thickness_m, that of the bodies")
    per_length = {"force": thickness_m or 1.0, "stress": 1 / float(sequence.entry("plate", "width_m"))}
    if form in per_length:
        at_rest = sequence.loading["shear_force_N_per_m"][(sequence.loading["phase"] == "at_rest").to_numpy()]
        pair = events["shear_force_N_per_m"], at_rest[: events.sizes["event"]]
        before, after = (per_length[form] * force.to_numpy() for force in pair)
    else:
        before, after = (events[f"friction_{name}"].to_numpy() for name in ("before", "after"))
    return {
        "begin_s": events["begin_s"].to_numpy(), "before": before, "after": after,
        "slip_m": events["mean_slip_m"].to_numpy(), "duration_s": events["slip_s"].to_numpy(),
    }  # fmt: skip


def form_of(record: Mapping[str, Any]) -> str:
    """In which form a table of events has the force."""
    found = {form for form in FORMS if any(holds(record, "record", name_of(form, stem)) for stem in STEMS)}
    if len(found) > 1:
        raise CaseError(f"the record has the shear as {' and as '.join(sorted(found))}; give one of them")
    return found.pop() if found else "friction"


def both_sides(
    sequence: OpenSequence,
    record: Mapping[str, ArrayLike],
    thickness_m: float | None,
    skip_events: int,
    skip_of_record: int | None = None,
) -> dict[str, Events]:
    """Of record and sequence the events that count, the shear in the record's form."""
    instance(sequence, OpenSequence, "sequence")
    form = form_of(record)
    skipped = whole(skip_events, "skip_events", least=0)
    skipped_of_record = (
        skipped if skip_of_record is None else whole(skip_of_record, "skip_of_record", least=0)
    )
    if thickness_m is not None:
        number(thickness_m, "thickness_m", above=0, finite=True)
        if form != "force":
            raise CaseError(
                f"thickness_m is of forces in N; the record has the shear as {form}: leave it out"
            )
    of_record = {"begin_s": column(record, "record", "begin_s", finite=True)}
    shear = {name: name_of(form, name) for name in STEMS}
    for name, called in ({"slip_m": "slip_m", "duration_s": "duration_s"} | shear).items():
        if holds(record, "record", called):
            values = column(record, "record", called)
            if np.isinf(values).any() or np.isnan(values).all():
                raise CaseError(
                    f"{called} of the record holds {'inf' if np.isinf(values).any() else 'no number'}"
                )
            of_record[name] = values
    if len({len(values) for values in of_record.values()}) > 1:
        raise CaseError("columns of the record differ in length")
    if not (np.diff(of_record["begin_s"]) > 0).all():
        raise CaseError("begin_s of the record must ascend")
    of_sequence = events_of_sequence(sequence, form, thickness_m)
    return {
        "record": counting(of_record, skipped_of_record, "the record"),
        "sequence": counting(of_sequence, skipped, "the sequence"),
    }


def observed_cycles(
    sequence: OpenSequence,
    record: Mapping[str, ArrayLike],
    *,
    thickness_m: float | None = None,
    skip_events: int = SKIPPED,
    skip_of_record: int | None = None,
) -> Observed:
    """Means over events, in percent of those of the record, whose standard errors are of its scatter."""
    found = compare_cycles(
        sequence,
        record,
        thickness_m=thickness_m,
        skip_events=skip_events,
        skip_of_record=skip_of_record,
    )
    scale = 0.01 * found["mean_record"].to_numpy()
    return Observed(
        "events",
        "percent",
        [NAMES[str(name)] for name in found["quantity"].values],
        np.full(len(scale), 100.0),
        found["mean_error_record"].to_numpy() / scale,
        found["mean_sequence"].to_numpy() / scale,
        is_series=False,
    )


def compare_cycles(
    sequence: OpenSequence,
    record: Mapping[str, ArrayLike],
    *,
    thickness_m: float | None = None,
    skip_events: int = SKIPPED,
    skip_of_record: int | None = None,
) -> xr.Dataset:
    """A sequence of slip events beside the events of a record, as statistics over them.

    record: begin_s, and of slip_m, duration_s and the shear before, after, drop what is known, this as
    shear over normal force, friction_before, ...; as mean stress over plate.width_m, stress_before_Pa; or as
    force_before_N, ..., which `events_of_force` finds in a record of the force. [events]
    thickness_m: of the bodies, for forces in N. skip_events: first ones left out on both sides, unless
    skip_of_record says how many of the record's, as of one that was cut out of a longer one. Events that
    drop by less than 0.1 of the largest are left out, too.

    Returns a Dataset over `quantity`: of record and sequence n, mean, its standard error and the standard
    deviation over the events; ratio, that of the means, 1 where they agree, with ratio_error. Of all:
    misfit_of_all, the root of the mean square of ratio - 1, with misfit_of_all_error."""
    sides = both_sides(sequence, record, thickness_m, skip_events, skip_of_record)
    form = form_of(record)
    names = [q for q in QUANTITIES if q == "interval_s" or q in sides["record"]]
    data: dict[str, list[float]] = {}
    for side, events in sides.items():
        for quantity in names:
            n, (mean, error), deviation = statistics(values_of(events, quantity))
            for key, value in (("n", n), ("mean", mean), ("mean_error", error), ("deviation", deviation)):
                data.setdefault(f"{key}_{side}", []).append(value)
    of = {name: np.array(values) for name, values in data.items()}
    if wrong := [name for name, mean in zip(names, of["mean_record"], strict=True) if not mean > 0]:
        raise CaseError(
            f"{NAMES[wrong[0]]} of the record is not above 0 in the mean: nothing to compare it with"
        )
    ratio = of["mean_sequence"] / of["mean_record"]
    shares = (of[f"mean_error_{side}"] / of[f"mean_{side}"] for side in sides)
    ratio_error = np.abs(ratio) * np.hypot(*shares)
    notes = []
    if far := [NAMES[name] for name, r in zip(names, ratio, strict=True) if not 1 / FAR < r < FAR]:
        notes.append(
            f"{', '.join(far)}: beyond {FAR:g} times each other; check units, and thickness_m of forces"
        )
    if len(names) == 1:
        notes.append("the record has neither shear before nor drop, slip or duration: intervals alone")
    units = [QUANTITIES[name] or FORMS[form] or "1" for name in names]
    return xr.Dataset(
        {name: ("quantity", values) for name, values in of.items()}
        | {
            "ratio": ("quantity", ratio, {"units": "1"}),
            "ratio_error": ("quantity", ratio_error, {"units": "1"}),
        }
        | of_all(rms(ratio - 1, ratio_error), "1"),
        {"quantity": names, "unit": ("quantity", units)},
        {"notes": notes},
    )
