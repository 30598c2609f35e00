# SPDX-License-Identifier: BSD-3-Clause
"""Values of one key: `0.1,0.3,1`, `0.4:1.2:9`, `0.01:1:5:log`, and the range `0.4:1.2` of a sample."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipfront.files import DataError, is_number

MOST_POINTS = 1_000_000

DIGITS = 12  # of values between the ends of a range and of results: 0.6, not 0.6000000000000001
NAME_DIGITS = 6  # of these in names, where that tells them apart
LOG = "log"

#: What a key of a case file may be set to: a number, a word, a flag, or a list of numbers.
Value = float | int | bool | str | list[Any]


@dataclass(frozen=True)
class Range:
    """A key's range from which samples are drawn; `is_log`: evenly in the logarithm."""

    from_: float
    to: float
    is_log: bool

    def at(self, share: float) -> Written:
        """The value at a share in [0, 1] of the way."""
        if self.is_log:
            return rounded(math.exp(math.log(self.from_) + share * math.log(self.to / self.from_)))
        return rounded(self.from_ + share * (self.to - self.from_))


class Written(float):
    """A number and how it is written in names: as the user did, or short."""

    text: str

    def __new__(cls, value: float | str, text: str | None = None) -> Written:
        made = super().__new__(cls, value)
        made.text = str(value).strip() if text is None else text
        return made


def rounded(value: float) -> Written:
    return Written(f"{value:.{DIGITS}g}", f"{value:.{NAME_DIGITS}g}")


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


def as_written(text: str) -> Value:
    """The same, a number with its text."""
    value = value_of(text)
    return Written(text) if isinstance(value, float) and math.isfinite(value) else value


def text_of(value: Value) -> str:
    """A value as the right side of `--set KEY=VALUE`; one text for one number, however it was written."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return float.__repr__(value)
    return json.dumps(value)


def short_text(value: float) -> str:
    """The shortest text of a number within DIGITS digits."""
    return text_of(float(f"{value:.{DIGITS}g}"))


def name_text(value: Value) -> str:
    """A value as it is in the name of a point: 1e-5, not 1e-05."""
    text = value.text if isinstance(value, Written) else text_of(value)
    return re.sub(r"(?<=\d)e([+-]?)0*(?=\d)", r"e\1", text) if isinstance(value, float) else text


def same(value: Value) -> str:
    """Equal for equal values, such as 1 and 1.0."""
    return text_of(float(value)) if is_number(value) else text_of(value)  # type: ignore[arg-type]


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
    ends = [as_written(part) for part in parts[:2]]
    inside: list[Value] = [whole.at(k / (n - 1)) for k in range(1, n - 1)]
    values = [ends[0], *inside, ends[1]]
    if not whole.is_log and all(isinstance(end, int) for end in ends):
        values = [int(v) if isinstance(v, float) and v.is_integer() else v for v in values]
    return values


def values_of(key: str, spec: Any) -> list[Value]:
    """The values that a text or a list of TOML stands for, in its order; none twice."""
    if isinstance(spec, list):
        values = [as_written(value) if isinstance(value, str) else value for value in spec]
    elif isinstance(spec, str) and ":" in spec:
        values = steps_of(key, spec)
    elif isinstance(spec, str):
        values = [as_written(part) for part in spec.split(",")]
    else:
        values = [spec]
    if not values or any(value == "" for value in values):
        raise DataError(f"{key}: a value is missing")
    for text, n in Counter(map(same, values)).items():
        if n > 1:
            raise DataError(f"{key}: the value {text} is there twice")
    return values


def as_array(values: list[Value]) -> np.ndarray:
    """Values as numbers where all are, else as texts. [values]"""
    if all(is_number(value) for value in values):
        return np.array(values)
    return np.array([text_of(value) for value in values], dtype=object)
