# SPDX-License-Identifier: BSD-3-Clause
"""Points of a sweep: which settings each run has, and what its folder is called."""

from __future__ import annotations

import hashlib
import itertools
import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from slipfront.files import DataError
from slipfront.sweep.values import MOST_POINTS, Range, Value, name_text, same, text_of

LONGEST_NAME = 120


@dataclass(frozen=True)
class Point:
    """One run. `name` is that of its folder; `values` are by the keys that vary, in their order."""

    name: str
    values: dict[str, Value]

    @property
    def words(self) -> str:
        """Its values, to tell it by."""
        return ", ".join(f"{key} = {text_of(value)}" for key, value in self.values.items())

    def numbers(self) -> dict[str, str]:
        """Equal for points with equal values."""
        return {key: same(value) for key, value in self.values.items()}

    def settings(self) -> list[str]:
        return [f"{key}={text_of(value)}" for key, value in self.values.items()]


def short_names(keys: list[str]) -> dict[str, str]:
    """By key, its last part where that is its alone, else the whole key."""
    leaves = [key.rsplit(".", 1)[-1] for key in keys]
    return {key: leaf if leaves.count(leaf) == 1 else key for key, leaf in zip(keys, leaves, strict=True)}


def folder_name(values: Mapping[str, Value], text: Callable[[Value], str] = name_text) -> str:
    """`mu_k=0.6,alpha_m2_per_s2=1e-3`; of what no folder's name should hold, or long, a checksum."""
    short = short_names(list(values))
    name = ",".join(f"{short[key]}={text(value)}" for key, value in values.items())
    if len(name) <= LONGEST_NAME and re.fullmatch(r"[\w.,=+-]+", name, re.ASCII) and not name.startswith("."):
        return name
    whole = "\n".join(f"{key}={text_of(value)}" for key, value in values.items())
    return "point-" + hashlib.sha256(whole.encode()).hexdigest()[:24]


def made(keys: list[str], rows: list[tuple[Value, ...]]) -> list[Point]:
    """Points with short names, and with all digits where short ones would be the same."""
    all_values = [dict(zip(keys, row, strict=True)) for row in rows]
    names = [folder_name(values) for values in all_values]
    n_of = Counter(names)
    return [
        Point(name if n_of[name] == 1 else folder_name(values, text_of), values)
        for name, values in zip(names, all_values, strict=True)
    ]


def grid(vary: Mapping[str, list[Value]]) -> list[Point]:
    """All combinations; the last key varies fastest."""
    n = 1
    for values in vary.values():
        n *= len(values)
    if n > MOST_POINTS:
        raise DataError(f"{n} points are more than {MOST_POINTS}")
    return made(list(vary), list(itertools.product(*vary.values())))


def zipped(vary: Mapping[str, list[Value]]) -> list[Point]:
    """The first values of all keys, the second ones, and so on."""
    lengths = {key: len(values) for key, values in vary.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {n}" for key, n in lengths.items())
        raise DataError(f"lists that go together have as many values each: {told}")
    points = made(list(vary), list(zip(*vary.values(), strict=True)))
    n_of = Counter(tuple(point.numbers().values()) for point in points)
    for point in points:
        if n_of[tuple(point.numbers().values())] > 1:
            raise DataError(f"the point {point.words} is there twice")
    return points


def sample(vary: Mapping[str, Range], count: int, seed: int) -> list[Point]:
    """A Latin hypercube: of each key's range every one of `count` equal parts is met once."""
    from scipy.stats import qmc

    if not 1 <= count <= MOST_POINTS:
        raise DataError(f"a sample has from 1 to {MOST_POINTS} points, not {count}")
    shares = qmc.LatinHypercube(d=len(vary), rng=seed).random(count)
    rows: list[tuple[Value, ...]] = [
        tuple(r.at(share) for r, share in zip(vary.values(), row, strict=True)) for row in shares
    ]
    return made(list(vary), rows)
