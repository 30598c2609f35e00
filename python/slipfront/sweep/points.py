# SPDX-License-Identifier: BSD-3-Clause
"""Values of one key, `0.1,0.3,1`, `0.4:1.2:9`, `0.01:1:5:log`, the range `0.4:1.2` of a sample; and the
points of a sweep that they make: which settings each run has, and what its folder is called."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipfront.files import DataError, is_number

MOST_POINTS = 1_000_000
LOG = "log"

#: What a key of a case file may be set to: a number, a word, a flag, or a list of these.
Value = float | int | bool | str | list[Any]


def value_of(text: str) -> Value:
    """A number, a flag or a word as a case file would have it."""
    text = text.strip()
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def text_of(value: Value) -> str:
    """A value as the right side of `--set KEY=VALUE`; one text for one number, such as 1 for 1.0."""
    if isinstance(value, str):
        return value
    if isinstance(value, list):
        return f"[{', '.join(json.dumps(v) if isinstance(v, str) else text_of(v) for v in value)}]"
    if isinstance(value, bool | int):
        return str(value).lower()
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else float.__repr__(value)


@dataclass(frozen=True)
class Range:
    """A key's values from one end to the other; `is_log`: evenly in the logarithm."""

    from_: float
    to: float
    is_log: bool

    def at(self, share: float) -> float:
        """The value at a share in [0, 1] of the way, without digits of rounding."""
        if self.is_log:
            value = math.exp(math.log(self.from_) + share * math.log(self.to / self.from_))
        else:
            value = self.from_ + share * (self.to - self.from_)
        return float(f"{value:.12g}")


def range_of(key: str, text: str, parts: list[str] | None = None) -> Range:
    """FROM:TO or FROM:TO:log."""
    parts = [part.strip() for part in text.split(":")] if parts is None else parts
    is_log = parts[2:] == [LOG]
    if len(parts) != 2 and not is_log:
        raise DataError(f"{key}={text}: a sample takes ranges, FROM:TO or FROM:TO:log")
    from_, to = (value_of(part) for part in parts[:2])
    if not (is_number(from_) and is_number(to)):
        raise DataError(f"{key}={text}: the ends of a range are numbers")
    if from_ == to:
        raise DataError(f"{key}={text}: the ends of the range are equal")
    if is_log and min(from_, to) <= 0:  # type: ignore[operator]
        raise DataError(f"{key}={text}: the ends of a logarithmic range are greater than 0")
    found = Range(float(from_), float(to), is_log)  # type: ignore[arg-type]
    wide = found.to / found.from_ if is_log else found.to - found.from_
    if not math.isfinite(wide) or wide == 0:
        raise DataError(f"{key}={text}: the range is too wide to be divided")
    return found


def steps_of(key: str, text: str) -> list[Value]:
    """FROM:TO:COUNT or FROM:TO:COUNT:log, both ends included."""
    parts = [part.strip() for part in text.split(":")]
    if len(parts) < 3 or parts[3:] not in ([], [LOG]):
        raise DataError(f"{key}={text}: values are A,B,C or FROM:TO:COUNT or FROM:TO:COUNT:log")
    n = value_of(parts[2])
    if not isinstance(n, int) or not 2 <= n <= MOST_POINTS:
        raise DataError(f"{key}={text}: the count of values is a whole number from 2 to {MOST_POINTS}")
    whole = range_of(key, text, parts[:2] + parts[3:])
    inside = [whole.at(k / (n - 1)) for k in range(1, n - 1)]
    return [value_of(parts[0]), *inside, value_of(parts[1])]


def values_of(key: str, spec: Any, may_repeat: bool = False) -> list[Value]:
    """The values that a text or a list stands for, in its order."""
    if isinstance(spec, str):
        values = steps_of(key, spec) if ":" in spec else [value_of(part) for part in spec.split(",")]
    else:
        values = [
            value_of(v) if isinstance(v, str) else v for v in (spec if isinstance(spec, list) else [spec])
        ]
    if not values or "" in values:
        raise DataError(f"{key}: a value is missing")
    for text, n in Counter(map(text_of, values)).items():
        if n > 1 and not may_repeat:
            raise DataError(f"{key}: the value {text} is there twice")
    return values


def as_array(values: list[Value]) -> np.ndarray:
    """Values as numbers where all are, else as texts. [values]"""
    if all(is_number(value) for value in values):
        return np.array(values)
    return np.array([text_of(value) for value in values], dtype=object)


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
