# SPDX-License-Identifier: BSD-3-Clause
"""Misfits and their standard errors; what a run observes of a record, value by value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr

SE_OF_MEDIAN = 1.2533  # over that of the mean, of normal values
SIGMA_OF_MAD = 1.4826


@dataclass(frozen=True)
class Observed:
    """Values of a record that share a unit, an unknown constant and a quality, beside those of a run."""

    name: str
    unit: str  # of CF
    labels: list[str]  # of the values
    measured: np.ndarray  # NaN where a place never slips
    error: np.ndarray  # standard errors; NaN where they are not known
    computed: np.ndarray  # NaN where the run has none
    has_offset: bool = False  # as of a clock that does not know when the rupture began, or of a gauge's zero
    has_gain: bool = False  # whether an amplifier of unknown gain stands between both
    is_series: bool = True  # along x or over time, so that neighbours may be alike


class Estimate(NamedTuple):
    """A value with its standard error; NaN where it is not known."""

    value: float
    error: float

    def __str__(self) -> str:
        return f"{self.value:.4g} +- {self.error:.2g}" if self.error == self.error else f"{self.value:.4g}"


def rms(values: np.ndarray, errors: np.ndarray) -> Estimate:
    """Root of the mean square of independent values that have errors."""
    known = np.isfinite(values)
    values, errors = values[known], errors[known]
    if not values.size:
        return Estimate(np.nan, np.nan)
    value = float(np.sqrt(np.mean(values**2)))
    error = float(np.sqrt(np.sum((values * errors) ** 2))) / (values.size * value) if value > 0 else np.nan
    return Estimate(value, error)


def median_of(values: np.ndarray) -> Estimate:
    """The error from the scatter, by the median of its magnitude."""
    known = values[np.isfinite(values)]
    if not known.size:
        return Estimate(np.nan, np.nan)
    value = float(np.median(known))
    sigma = SIGMA_OF_MAD * float(np.median(np.abs(known - value)))
    error = SE_OF_MEDIAN * sigma / np.sqrt(known.size) if known.size > 2 and sigma > 0 else np.nan
    return Estimate(value, float(error))


def of_all(found: Estimate, unit: str) -> dict[str, xr.Variable]:
    """The two variables that every comparison has."""
    return {
        "misfit_of_all": xr.Variable((), found.value, {"units": unit}),
        "misfit_of_all_error": xr.Variable((), found.error, {"units": unit, "long_name": "standard error"}),
    }


def estimate_of(found: xr.Dataset, name: str = "misfit_of_all") -> Estimate:
    return Estimate(float(found[name]), float(found[f"{name}_error"]))
