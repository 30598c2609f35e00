# SPDX-License-Identifier: BSD-3-Clause
"""Points of a sweep: which settings each run has, and what its folder is called."""

from __future__ import annotations

import hashlib
import itertools
import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from slipfront.files import DataError
from slipfront.sweep.values import MOST_POINTS, Range, Value, text_of

LONGEST_NAME = 120


@dataclass(frozen=True)
class Point:
    """One run. `name` is that of its folder; `values` are by the keys that vary, in their order."""

    name: str
    values: dict[str, Value]

    @property
    def words(self) -> str:
        return ", ".join(f"{key} = {text_of(value)}" for key, value in self.values.items())

    def settings(self) -> list[str]:
        return [f"{key}={text_of(value)}" for key, value in self.values.items()]


def short_names(keys: list[str]) -> dict[str, str]:
    """By key, its last part where that is its alone, else the whole key."""
    leaves = [key.rsplit(".", 1)[-1] for key in keys]
    return {key: leaf if leaves.count(leaf) == 1 else key for key, leaf in zip(keys, leaves, strict=True)}


def folder_name(values: Mapping[str, Value]) -> str:
    """`mu_k=0.6,alpha_m2_per_s2=0.001`; of what no folder's name should hold, or long, a checksum."""
    short = short_names(list(values))
    name = ",".join(f"{short[key]}={text_of(value)}" for key, value in values.items())
    if len(name) <= LONGEST_NAME and re.fullmatch(r"[\w.,=+-]+", name, re.ASCII) and not name.startswith("."):
        return name
    whole = "\n".join(f"{key}={text_of(value)}" for key, value in values.items())
    return "point-" + hashlib.sha256(whole.encode()).hexdigest()[:24]


def made(keys: Iterable[str], rows: Iterable[Iterable[Value]]) -> list[Point]:
    all_values = [dict(zip(keys, row, strict=True)) for row in rows]
    return [Point(folder_name(values), values) for values in all_values]


def grid(vary: Mapping[str, list[Value]]) -> list[Point]:
    """All combinations; the last key varies fastest."""
    n = math.prod(map(len, vary.values()))
    if n > MOST_POINTS:
        raise DataError(f"{n} points are more than {MOST_POINTS}")
    return made(vary, itertools.product(*vary.values()))


def zipped(vary: Mapping[str, list[Value]]) -> list[Point]:
    """The first values of all keys, the second ones, and so on."""
    if len(set(map(len, vary.values()))) > 1:
        told = ", ".join(f"{key} has {len(values)}" for key, values in vary.items())
        raise DataError(f"lists that go together have as many values each: {told}")
    points = made(vary, zip(*vary.values(), strict=True))
    n_of = Counter(point.words for point in points)
    if twice := next((words for words, n in n_of.items() if n > 1), None):
        raise DataError(f"the point {twice} is there twice")
    return points


def sample(vary: Mapping[str, Range], count: int, seed: int) -> list[Point]:
    """A Latin hypercube: of each key's range every one of `count` equal parts is met once."""
    from scipy.stats import qmc

    if not 1 <= count <= MOST_POINTS:
        raise DataError(f"a sample has a count of 1 to {MOST_POINTS} points, not {count}")
    shares = qmc.LatinHypercube(d=len(vary), rng=seed).random(count)
    return made(vary, ([r.at(s) for r, s in zip(vary.values(), row, strict=True)] for row in shares))
