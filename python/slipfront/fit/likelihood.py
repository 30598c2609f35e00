# SPDX-License-Identifier: BSD-3-Clause
"""How probable a run makes the records.

A measured value differs from the run's by noise of its known standard error, and by what the model leaves
out: a factor s >= 1 on that error, one for each part of the records, whose prior is uniform in its logarithm.
Where no error is known, s is the whole of it. The unknown constant of a part and its gain are fitted, s is
integrated, both in closed form. Residuals of neighbours that are alike count as fewer: n/c of n values, with
c from the autocorrelation of what the best run leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import gammainc, gammaln, hyp1f1

from slipfront.compare.misfit import Observed
from slipfront.files import DataError
from slipfront.tip_fit import correlated

LEAST_SCALE = 1e-3  # of a part's own deviation: errors that are not known are no smaller


def log_gammainc(a: float, x: np.ndarray) -> np.ndarray:
    """Logarithm of the regularised lower incomplete gamma function, by its series where it may underflow."""
    x = np.maximum(x, 1e-300)
    with np.errstate(divide="ignore", invalid="ignore"):
        series = a * np.log(x) - x - gammaln(a + 1) + np.log(hyp1f1(1.0, a + 1, np.minimum(x, a + 1)))
        return np.where(x < a + 1, series, np.log(gammainc(a, x)))


@dataclass(frozen=True)
class Part:
    """Values of a record that count together, those that all runs have."""

    name: str
    place: tuple[int, int]  # number of the record, and of the part in it
    used: np.ndarray  # which of its values
    unit: str
    labels: list[str]
    measured: np.ndarray
    sigma: np.ndarray  # standard errors where they are known, else the part's standard deviation
    has_error: bool
    has_offset: bool
    has_gain: bool
    is_series: bool
    alike: float = 1.0  # c

    @property
    def n(self) -> int:
        return len(self.measured)

    @property
    def freedom(self) -> float:
        """Values that count, less what is fitted away."""
        return max(self.n - self.has_offset - self.has_gain, 0.5) / self.alike

    @property
    def least_scale(self) -> float:
        return 1.0 if self.has_error else LEAST_SCALE

    def reduced(self, rows: np.ndarray) -> np.ndarray:
        """Values over their errors, about their weighted mean where a constant is unknown. [..., values]"""
        over = rows / self.sigma
        if not self.has_offset:
            return over
        weight = 1 / self.sigma
        return over - ((over @ weight) / (weight @ weight))[..., None] * weight

    def left(self, record: np.ndarray, run: np.ndarray) -> np.ndarray:
        """Record less run times its gain, both reduced, or both in one orthogonal basis. [..., values]"""
        if not self.has_gain:
            return record - run
        gain = np.maximum(run @ record, 0) / np.maximum((run**2).sum(axis=-1), 1e-300)
        return record - gain[..., None] * run

    def log_likelihood(self, squares: np.ndarray, least_square: np.ndarray | float) -> np.ndarray:
        """Of sums of squares of what is left, s integrated from the root of least_square on. Up to a constant
        of the record."""
        half = self.freedom / 2
        squares = np.maximum(squares / self.alike, 1e-12)
        return -half * np.log(squares) + log_gammainc(half, squares / (2 * least_square))

    def scale(self, squares: float) -> float:
        """The most probable s."""
        return float(np.sqrt(max(squares / self.alike / self.freedom, self.least_scale**2)))


def part_of(observed: Observed, name: str, place: tuple[int, int], used: np.ndarray) -> Part:
    measured, error = observed.measured[used], observed.error[used]
    has_error = bool(np.isfinite(error).all())
    labels = [label for label, is_used in zip(observed.labels, used, strict=True) if is_used]
    if not has_error and np.isfinite(error).any():
        without = labels[int(np.argmin(np.isfinite(error)))]
        raise DataError(f"{name}: {without} has no error, and others have one: give all or none")
    deviation = float(measured.std()) or float(np.abs(measured).max(initial=0.0)) or 1.0
    return Part(
        name=name,
        place=place,
        used=used,
        unit=observed.unit,
        labels=labels,
        measured=measured,
        sigma=error if has_error else np.full(len(measured), deviation),
        has_error=has_error,
        has_offset=observed.has_offset,
        has_gain=observed.has_gain,
        is_series=observed.is_series,
    )


def alike_of(part: Part, run: np.ndarray) -> float:
    """c of what a run leaves of a part. [values]"""
    left = part.left(part.reduced(part.measured), part.reduced(run))
    return correlated(left[None]) if part.is_series and part.n > 3 and left.any() else 1.0
