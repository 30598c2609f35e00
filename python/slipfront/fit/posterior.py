# SPDX-License-Identifier: BSD-3-Clause
"""What records tell of the free keys: samples of the posterior, intervals, and what is not determined."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import emcee
import numpy as np

from slipfront.fit.space import Space

WALKERS = 40  # at least, as many at a time cost little more than one
BURN_IN = 0.3  # of the steps
LEVELS = (0.90, 0.68)
FLAT = 0.7  # of its range, beyond which an interval of 90 % (a uniform one has 0.9) does not determine a key
CUT = 0.03  # share of samples in a tenth of the interval of 90 % at an end of the range; 0.09 if uniform
ALIKE = 0.9  # correlation beyond which two keys trade off


def sampled(
    log_likelihood: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    steps: int,
    rng: np.random.Generator,
) -> tuple[np.ndarray, float]:
    """Samples of shares, uniform before the records, from places of some likelihood on; and how many of them
    are independent, by the autocorrelation. [samples, keys]"""
    n = start.shape[1]
    walkers = max(WALKERS, 4 * n)
    scale = np.maximum(start.std(axis=0), 1e-3)
    places = start[rng.integers(len(start), size=walkers)]
    tried = np.clip(places + 0.3 * scale * rng.normal(size=places.shape), 0, 1)
    known = np.isfinite(log_likelihood(tried))
    places[known] = tried[known]
    places = np.clip(places + 1e-9 * rng.normal(size=places.shape), 0, 1)
    alive = np.isfinite(log_likelihood(places))
    places = places[alive][np.arange(walkers) % alive.sum()]  # none begins where nothing is known

    def inside(shares: np.ndarray) -> np.ndarray:
        found = np.full(len(shares), -np.inf)
        at = ((shares >= 0) & (shares <= 1)).all(axis=1)
        if at.any():
            found[at] = log_likelihood(shares[at])
        return found

    sampler = emcee.EnsembleSampler(walkers, n, inside, vectorize=True)
    sampler.random_state = np.random.RandomState(int(rng.integers(2**31))).get_state()
    sampler.run_mcmc(places, steps, skip_initial_state_check=True)
    chain = sampler.get_chain(discard=int(BURN_IN * steps))
    time = float(np.max(emcee.autocorr.integrated_time(chain, tol=0, quiet=True)))
    flat = chain.reshape(-1, n)
    return flat, len(flat) / max(time, 1.0)


@dataclass(frozen=True)
class Marginal:
    """Of a key, or of a combination of keys: median and intervals by level."""

    name: str
    median: float
    intervals: dict[float, tuple[float, float]]
    is_determined: bool = True


def marginal(name: str, values: np.ndarray, width: float = np.nan) -> Marginal:
    """width: of the 90 % interval over the range that was allowed."""
    intervals = {}
    for level in LEVELS:
        low, high = np.quantile(values, [(1 - level) / 2, (1 + level) / 2])
        intervals[level] = float(low), float(high)
    return Marginal(name, float(np.median(values)), intervals, not width > FLAT)


def marginals(space: Space, samples: np.ndarray) -> list[Marginal]:
    values = space.values(samples)
    found = []
    for k, key in enumerate(space.keys):
        low, high = np.quantile(samples[:, k], [0.05, 0.95])
        found.append(marginal(key, values[:, k], float(high - low)))
    return found


def correlations(samples: np.ndarray) -> np.ndarray:
    """Of the keys' shares: of logarithms where a range is logarithmic. [keys, keys]"""
    return np.atleast_2d(np.corrcoef(samples, rowvar=False))


def at_an_end(space: Space, samples: np.ndarray, of: Marginal, k: int) -> str:
    """The end of its range that cuts a determined key's posterior, or ''."""
    if not of.is_determined:
        return ""
    wide = np.quantile(samples[:, k], 0.95) - np.quantile(samples[:, k], 0.05)
    for end, name in ((samples[:, k] < 0.1 * wide, "lower"), (samples[:, k] > 1 - 0.1 * wide, "upper")):
        if end.mean() > CUT:
            return name
    return ""
