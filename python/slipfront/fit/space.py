# SPDX-License-Identifier: BSD-3-Clause
"""Ranges of free keys. A point is given by its shares of the ranges, from 0 to 1; the prior is uniform in
these: in the value, or in its logarithm."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from slipfront.sweep.points import Point, Range, made, range_of

SEED = 0


@dataclass(frozen=True)
class Space:
    ranges: dict[str, Range]  # by key

    @property
    def keys(self) -> list[str]:
        return list(self.ranges)

    @property
    def n(self) -> int:
        return len(self.ranges)

    def values(self, shares: np.ndarray) -> np.ndarray:
        """Of the keys. [..., keys] both"""
        columns = []
        for k, of in enumerate(self.ranges.values()):
            share = shares[..., k]
            if of.is_log:
                columns.append(of.from_ * (of.to / of.from_) ** share)
            else:
                columns.append(of.from_ + share * (of.to - of.from_))
        return np.stack(columns, axis=-1)

    def shares(self, values: np.ndarray) -> np.ndarray:
        """The other way round."""
        columns = []
        for k, of in enumerate(self.ranges.values()):
            value = values[..., k]
            if of.is_log:
                columns.append(np.log(value / of.from_) / np.log(of.to / of.from_))
            else:
                columns.append((value - of.from_) / (of.to - of.from_))
        return np.stack(columns, axis=-1)

    def points(self, shares: np.ndarray) -> list[Point]:
        """Runs at rows of shares. [points, keys]"""
        rows = ([of.at(float(s)) for of, s in zip(self.ranges.values(), row, strict=True)] for row in shares)
        return made(self.keys, rows)

    def sobol(self, count: int) -> np.ndarray:
        """The first points of Sobol's sequence, scrambled. [points, keys]"""
        power = int(np.ceil(np.log2(count)))
        return np.asarray(qmc.Sobol(self.n, rng=SEED).random_base2(power))[:count]


def space_of(free: Mapping[str, str]) -> Space:
    """Of texts FROM:TO or FROM:TO:log by key, from the lower end to the upper one."""
    ranges = (range_of(key, text) for key, text in free.items())
    rising = (Range(min(of.from_, of.to), max(of.from_, of.to), of.is_log) for of in ranges)
    return Space(dict(zip(free, rising, strict=True)))


def spread_out(candidates: np.ndarray, others: np.ndarray, count: int) -> np.ndarray:
    """So many of the candidates, each as far as possible from all others and from those before, over the
    candidates' standard deviations. [points, keys]"""
    scale = np.maximum(candidates.std(axis=0), 1e-9)
    left = candidates / scale
    nearest = np.full(len(left), np.inf)
    for row in others / scale:
        nearest = np.minimum(nearest, ((left - row) ** 2).sum(axis=1))
    chosen = []
    for _ in range(min(count, len(left))):
        k = int(np.argmax(nearest))
        if nearest[k] <= 0:
            break
        chosen.append(k)
        nearest = np.minimum(nearest, ((left - left[k]) ** 2).sum(axis=1))
    return candidates[chosen]
