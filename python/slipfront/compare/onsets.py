# SPDX-License-Identifier: BSD-3-Clause
"""Onsets of a run's fronts beside those of a record."""

from __future__ import annotations

import numpy as np
import xarray as xr

from slipfront.compare.misfit import Estimate, Observed, of_all
from slipfront.errors import CaseError
from slipfront.given import column, holds, instance
from slipfront.measures import Arrays
from slipfront.opened import OpenRun
from slipfront.tip_fit import correlated
from slipfront.units import attributes

ROUNDING = 1e-9  # of times


def onsets_at(run: OpenRun, x_m: np.ndarray) -> np.ndarray:
    """When the first front of a run passes places, linear between its nodes; NaN where none does. [places]"""
    found = np.full(len(x_m), np.inf)
    for front in run.front_list:
        order = np.argsort(front.x_m)
        x, onset_s = front.x_m[order], front.onset_s[order]
        found = np.minimum(found, np.interp(x_m, x, onset_s, left=np.inf, right=np.inf))
    return np.where(np.isfinite(found), found, np.nan)


def places_in_words(x_m: np.ndarray) -> str:
    if len(x_m) == 1:
        return f"1 place of the record, x = {x_m[0]:.4g} m"
    return f"{len(x_m)} places of the record, x = {x_m[0]:.4g} to {x_m[-1]:.4g} m"


def record_of(record: Arrays) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """x_m, onset_s and error_s of one event, this where it is known. [places]"""
    x_m, record_s = column(record, "record", "x_m"), column(record, "record", "onset_s")
    has_errors = holds(record, "record", "error_s")
    error_s = column(record, "record", "error_s", finite=True) if has_errors else None
    if len(x_m) != len(record_s) or (error_s is not None and len(error_s) != len(x_m)):
        raise CaseError("x_m, onset_s and error_s of the record must be of one length")
    if error_s is not None and not (error_s > 0).all():
        raise CaseError("error_s of the record must be above 0")
    if "event" in record and len(np.unique(column(record, "record", "event"))) > 1:
        raise CaseError("the record has several events; take one, as by read_onsets(file, event=...)")
    return x_m, record_s, error_s


def observed_onsets(run: OpenRun, record: Arrays, *, clock_is_known: bool = False) -> Observed:
    """Onsets in s value by value. clock_is_known: whether the record's clock begins with the run's."""
    x_m, record_s, error_s = record_of(record)
    along = np.argsort(x_m, kind="stable")
    return Observed(
        "onsets",
        "s",
        [f"x = {x:.6g} m" for x in x_m[along]],
        record_s[along],
        np.full(len(x_m), np.nan) if error_s is None else error_s[along],
        onsets_at(run, x_m[along]),
        has_offset=not clock_is_known,
    )


def compare_onsets(run: OpenRun, record: Arrays) -> xr.Dataset:
    """The onsets of a run's fronts beside those of one event, as `read_onsets` has them: x_m, onset_s, NaN
    where a place never slips, and perhaps error_s, standard errors, which weight them. [places]

    The clocks are aligned by the mean, since an experiment does not know when its rupture began.
    Returns a Dataset over `place`: x_m, record_s, its error_s, run_s, NaN where no front passes, and
    residual_s = run_s - shift_s - record_s. Of all: misfit_of_all, the standard deviation of the residuals in
    s, NaN below two places that both have; shift_s, the run's clock less the record's; time_ratio, the slope
    of run_s over record_s, above 1 where the run's fronts are slower, NaN below three places; each with
    _error, its standard error by the scatter. reduced_chi2, where the record has errors: 1 where these
    explain the residuals. `notes` names places that only one of both has."""
    instance(run, OpenRun, "run")
    x_m, record_s, known_error_s = record_of(record)
    has_errors = known_error_s is not None
    error_s = np.ones(len(x_m)) if known_error_s is None else known_error_s
    run_s = onsets_at(run, x_m)
    both = np.isfinite(record_s) & np.isfinite(run_s)
    notes = [
        f"{what} {places_in_words(x_m[of])}"
        for what, of in (
            ("no front of the run passes", np.isfinite(record_s) & np.isnan(run_s)),
            ("fronts of the run pass, and slip is not recorded at,", np.isnan(record_s) & np.isfinite(run_s)),
        )
        if of.any()
    ]
    n, order = int(both.sum()), np.argsort(x_m[both], kind="stable")
    weight = (error_s.min() / error_s[both]) ** 2
    residual_s = np.full(len(x_m), np.nan)
    shift, misfit, slope, chi2 = (Estimate(np.nan, np.nan) for _ in range(4))
    if n > 0:
        shift_s = float(np.average(run_s[both] - record_s[both], weights=weight))
        residual_s = run_s - shift_s - record_s
    if n > 1:
        left = residual_s[both]
        square = float(np.average(left**2, weights=weight)) * n / (n - 1)
        # Residuals of neighbours that are alike count as fewer.
        alike = correlated((np.sqrt(weight) * left)[order][None]) if square > 0 else 1.0
        misfit = Estimate(np.sqrt(square), np.sqrt(square * alike / (2 * (n - 1))))
        shift = Estimate(
            shift_s, float(np.sqrt((weight**2 * left**2).sum() * alike * n / (n - 1)) / weight.sum())
        )
        if has_errors:
            chi2 = Estimate(float(((left / error_s[both]) ** 2).sum() / (n - 1)), np.nan)
    centred = record_s[both] - np.average(record_s[both], weights=weight) if n > 2 else np.zeros(1)
    if np.ptp(centred) > ROUNDING * np.abs(record_s[both]).max(initial=0.0):
        norm = float((weight * centred**2).sum())
        gain = float((weight * centred * left).sum()) / norm
        rest = left - gain * centred
        alike = correlated((np.sqrt(weight) * rest)[order][None]) if rest.any() else 1.0
        scatter = float((weight * rest**2).sum()) / (n - 2)
        slope = Estimate(1 + gain, float(np.sqrt(scatter * alike / norm)))
    of_places = {"x_m": x_m, "record_s": record_s, "run_s": run_s, "residual_s": residual_s}
    if has_errors:
        of_places["error_s"] = error_s
    return xr.Dataset(
        {name: ("place", values, attributes(name)) for name, values in of_places.items()}
        | of_all(misfit, "s")
        | {
            "shift_s": ((), shift.value, {"units": "s"}),
            "shift_s_error": ((), shift.error, {"units": "s"}),
            "time_ratio": ((), slope.value, {"units": "1"}),
            "time_ratio_error": ((), slope.error, {"units": "1"}),
            "reduced_chi2": ((), chi2.value, {"units": "1"}),
            "n": ((), n, {"long_name": "places that both have"}),
        },
        attrs={"notes": notes},
    )
