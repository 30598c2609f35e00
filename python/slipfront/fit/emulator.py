# SPDX-License-Identifier: BSD-3-Clause
"""What runs would compute at points that were not run: Gaussian processes over the amplitudes of the runs'
principal components (Higdon et al. 2008), about a polynomial of second order."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

from slipfront.fit.likelihood import Part

MOST_COMPONENTS = 15
NOISE_DRAWS = 50
LEFT_OUT = (
    0.3  # of a standard error, root of the sum of squares over the values, that the components may leave
)


@dataclass(frozen=True)
class Reduced:
    """A part in the space of its components: the record, the mean run, the components, the same over errors,
    all in one orthogonal basis."""

    part: Part
    record: np.ndarray  # [basis]
    mean: np.ndarray  # [basis]
    components: np.ndarray  # [components, basis]
    left_out: float  # mean square that the components leave, over the errors

    def log_likelihood(self, amplitudes: np.ndarray, variances: np.ndarray) -> np.ndarray:
        """[points, components] both"""
        run = self.mean + amplitudes @ self.components
        squares = (self.part.left(self.record, run) ** 2).sum(axis=-1)
        unsure = variances @ (self.components**2).sum(axis=1) / self.part.n
        least = self.part.least_scale**2 + unsure + self.left_out
        return self.part.log_likelihood(squares, least)


class Emulator:
    """Of runs at shares [runs, keys] that computed values [runs, values of the part] for each part. Valid
    within their bounding box, where the nearest of all points has a run that the record can be compared with.
    """

    def __init__(
        self,
        parts: Sequence[Part],
        shares: np.ndarray,
        computed: Sequence[np.ndarray],
        lost: np.ndarray,
        margin: float,
    ) -> None:
        """lost: shares of points without such a run; margin: of the box's sides that it is wider by."""
        low, high = shares.min(axis=0), shares.max(axis=0)
        wide = np.maximum(high - low, 1e-6)
        self.low = np.clip(low - margin * wide, 0, 1)
        self.high = np.clip(high + margin * wide, 0, 1)
        places = self.placed(np.concatenate([shares, lost]))
        self.nearest, self.n_known = cKDTree(places), len(shares)
        known = places[: len(shares)]
        every = [part.reduced(rows) for part, rows in zip(parts, computed, strict=True)]
        values = np.concatenate(every, axis=1)
        mean = values.mean(axis=0)
        _, sizes, rows = np.linalg.svd(values - mean, full_matrices=False)
        left = np.append(np.cumsum(sizes[::-1] ** 2)[::-1], 0.0) / len(values)  # of a run
        n = min(int(np.argmax(left <= LEFT_OUT**2)), MOST_COMPONENTS, len(sizes))
        components = rows[:n]
        amplitudes = (values - mean) @ components.T
        beyond = values - mean - amplitudes @ components
        self.reduced: list[Reduced] = []
        ends = np.cumsum([0, *(part.n for part in parts)])
        for part, begin, end in zip(parts, ends[:-1], ends[1:], strict=True):
            own = slice(begin, end)
            stack = np.column_stack([part.reduced(part.measured), mean[own], components[:, own].T])
            basis = np.asarray(np.linalg.qr(stack, mode="r")).T
            left_out = float((beyond[:, own] ** 2).mean())
            self.reduced.append(Reduced(part, basis[0], basis[1], basis[2:], left_out))
        n_keys = known.shape[1]
        degree = 2 if 1.5 * (n_keys + 1) * (n_keys + 2) / 2 <= len(known) else 1
        self.pairs = [(i, j) for i in range(n_keys) for j in range(i, n_keys)] if degree == 2 else []
        terms = self.trend(known)
        self.coefficients = np.linalg.lstsq(terms, amplitudes, rcond=None)[0]
        rest = amplitudes - terms @ self.coefficients
        self.spread = np.maximum(rest.std(axis=0), 1e-12)
        self.processes = [Process(known, rest[:, k] / self.spread[k]) for k in range(n)]

    def placed(self, shares: np.ndarray) -> np.ndarray:
        """Within the box, from -1 to 1."""
        return 2 * (shares - self.low) / np.maximum(self.high - self.low, 1e-12) - 1

    def trend(self, places: np.ndarray) -> np.ndarray:
        """Terms of the polynomial. [points, terms]"""
        products = [places[:, i] * places[:, j] for i, j in self.pairs]
        return np.column_stack([np.ones(len(places)), places, *products])

    def predict(self, shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Amplitudes of the components and their variances. [points, components]"""
        at = self.placed(shares)
        values = self.trend(at) @ self.coefficients
        variances = np.zeros_like(values)
        for k, process in enumerate(self.processes):
            mean, variance = process.predict(at)
            values[:, k] += self.spread[k] * mean
            variances[:, k] = self.spread[k] ** 2 * variance
        return values, variances

    def noise_of_log_likelihood(self, shares: np.ndarray, rng: np.random.Generator) -> float:
        """Root mean square of what the runs' own noise, such as that of a mesh, adds to log L at shares."""
        amplitudes, variances = self.predict(shares)
        noise = self.spread * np.sqrt([process.noise for process in self.processes])
        drawn = amplitudes + noise * rng.normal(size=(NOISE_DRAWS, *amplitudes.shape))
        found = np.sum([one.log_likelihood(drawn, variances) for one in self.reduced], axis=0)
        return float(np.sqrt((found.std(axis=0) ** 2).mean()))

    def log_likelihood(self, shares: np.ndarray) -> np.ndarray:
        """-inf where the emulator knows nothing. [points]"""
        found = np.full(len(shares), -np.inf)
        inside = ((shares >= self.low) & (shares <= self.high)).all(axis=1)
        if inside.any():
            _, nearest = self.nearest.query(self.placed(shares[inside]))
            inside[inside] = nearest < self.n_known
        if inside.any():
            amplitudes, variances = self.predict(shares[inside])
            each = [one.log_likelihood(amplitudes, variances) for one in self.reduced]
            found[inside] = np.sum(each, axis=0)
        return found


class Process:
    """A Gaussian process whose parameters scikit-learn has found. Of the few points of a step of the sampler
    that library's own prediction takes ten times as long, as it checks its arguments."""

    def __init__(self, places: np.ndarray, values: np.ndarray) -> None:
        kernel = ConstantKernel(1.0, (1e-3, 1e3)) * Matern(np.full(places.shape[1], 2.0), (0.1, 1e3), nu=2.5)
        process = GaussianProcessRegressor(kernel + WhiteKernel(1e-2, (1e-8, 1.0)))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound is one without effect
            process.fit(places, values)
        found = process.kernel_
        self.variance = float(found.k1.k1.constant_value)
        self.lengths = np.atleast_1d(found.k1.k2.length_scale)
        self.noise = float(found.k2.noise_level)
        self.places = places / self.lengths
        self.weights = process.alpha_
        self.inverse = cho_solve((process.L_, True), np.eye(len(places)))

    def predict(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Means, and variances with those of the runs' own noise. [points]"""
        far = np.sqrt(5) * cdist(places / self.lengths, self.places)
        covariance = self.variance * (1 + far + far**2 / 3) * np.exp(-far)
        explained = ((covariance @ self.inverse) * covariance).sum(axis=1)
        return covariance @ self.weights, np.maximum(self.variance - explained, 0) + self.noise
