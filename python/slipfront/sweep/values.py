# SPDX-License-Identifier: BSD-3-Clause
"""Values of one key: `0.1,0.3,1`, `0.4:1.2:9`, `0.01:1:5:log`, and the range `0.4:1.2` of a sample."""

from __future__ import annotations

import json
import math
from collections import Counter
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
    return Range(float(from_), float(to), is_log)  # type: ignore[arg-type]


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
