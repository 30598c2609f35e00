# SPDX-License-Identifier: BSD-3-Clause
"""Values of one key: `0.1,0.3,1`, `0.4:1.2:9`, `0.01:1:5:log`, and the range `0.4:1.2` of a sample."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipfront.files import DataError, is_number

MOST_POINTS = 1_000_000

DIGITS = 12  # of values between the ends of a range: 0.6, not 0.6000000000000001
LOG = "log"

#: What a key of a case file may be set to: a number, a word, a flag, or a list of numbers.
Value = float | int | bool | str | list[Any]


@dataclass(frozen=True)
class Range:
    """A key's range from which samples are drawn; `is_log`: evenly in the logarithm."""

    from_: float
    to: float
    is_log: bool

    def at(self, share: float) -> float:
        """The value at a share in [0, 1] of the way."""
        if self.is_log:
            return rounded(math.exp(math.log(self.from_) + share * math.log(self.to / self.from_)))
        return rounded(self.from_ + share * (self.to - self.from_))


def rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def value_of(text: str) -> Value:
    """A number, a flag or a word as a case file would have it."""
    text = text.strip()
    if text in ("true", "false"):
        return text == "true"
    try:
        return int(text)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        return text


def text_of(value: Value) -> str:
    """A value as the right side of `--set KEY=VALUE`."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)


def bounds(key: str, text: str, parts: list[str]) -> tuple[float, float, bool]:
    is_log = parts[-1] == LOG
    ends = [value_of(part) for part in parts[:2]]
    if len(ends) != 2 or not all(is_number(end) for end in ends):
        raise DataError(f"{key}={text}: the ends of a range are numbers")
    from_, to = (float(end) for end in ends)  # type: ignore[arg-type]
    if from_ == to:
        raise DataError(f"{key}={text}: the ends of the range are equal")
    if is_log and min(from_, to) <= 0:
        raise DataError(f"{key}={text}: the ends of a logarithmic range are greater than 0")
    return from_, to, is_log


def range_of(key: str, text: str) -> Range:
    """FROM:TO or FROM:TO:log."""
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2 and not (len(parts) == 3 and parts[2] == LOG):
        raise DataError(f"{key}={text}: a sample takes ranges, FROM:TO or FROM:TO:log")
    return Range(*bounds(key, text, parts))


def steps_of(key: str, text: str) -> list[Value]:
    """FROM:TO:COUNT or FROM:TO:COUNT:log, both ends included."""
    parts = [part.strip() for part in text.split(":")]
    n = value_of(parts[2]) if len(parts) > 2 else 0
    if len(parts) not in (3, 4) or (len(parts) == 4 and parts[3] != LOG):
        raise DataError(f"{key}={text}: values are A,B,C or FROM:TO:COUNT or FROM:TO:COUNT:log")
    if isinstance(n, bool) or not isinstance(n, int) or n < 2:
        raise DataError(f"{key}={text}: the count of values is a whole number from 2 on")
    if n > MOST_POINTS:
        raise DataError(f"{key}={text}: {n} values are more than {MOST_POINTS}")
    whole = Range(*bounds(key, text, parts))
    ends = [value_of(part) for part in parts[:2]]
    inside: list[Value] = [whole.at(k / (n - 1)) for k in range(1, n - 1)]
    values: list[Value] = [ends[0], *inside, ends[1]]
    if not whole.is_log and all(isinstance(end, int) for end in ends):
        values = [int(v) if isinstance(v, float) and v.is_integer() else v for v in values]
    return values if all(isinstance(v, int) for v in values) else [float(v) for v in values]  # type: ignore


def values_of(key: str, spec: Any) -> list[Value]:
    """The values that a text or a list of TOML stands for, in its order; none twice."""
    if isinstance(spec, list):
        values = list(spec)
    elif isinstance(spec, str) and ":" in spec:
        values = steps_of(key, spec)
    elif isinstance(spec, str):
        values = [value_of(part) for part in spec.split(",")]
    else:
        values = [spec]
    if not values or any(value == "" for value in values):
        raise DataError(f"{key}: a value is missing")
    texts = [text_of(value) for value in values]
    for text in texts:
        if texts.count(text) > 1:
            raise DataError(f"{key}: the value {text} is there twice")
    return values


def as_array(values: list[Value]) -> np.ndarray:
    """Values as numbers where all are, else as texts. [values]"""
    if all(is_number(value) for value in values):
        return np.array(values)
    return np.array([text_of(value) for value in values], dtype=object)
