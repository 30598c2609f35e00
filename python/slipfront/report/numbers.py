# SPDX-License-Identifier: BSD-3-Clause
"""Numbers for a page: in units that suit their size, and in few characters."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from slipfront.units import Unit as Unit

DIGITS = 5  # of a number that is written out: more than a screen shows


#: For each quantity, units from small to large, with the largest number that each is used for, in SI.
UNITS: dict[str, tuple[tuple[float, Unit], ...]] = {
    "length": ((20.0, Unit("mm", 1e3)), (2e3, Unit("m", 1.0)), (np.inf, Unit("km", 1e-3))),
    "time": ((20e-3, Unit("µs", 1e6)), (5.0, Unit("ms", 1e3)), (np.inf, Unit("s", 1.0))),
    "slip": ((2e-3, Unit("µm", 1e6)), (0.5, Unit("mm", 1e3)), (np.inf, Unit("m", 1.0))),
    "traction": ((2e3, Unit("Pa", 1.0)), (2e5, Unit("kPa", 1e-3)), (np.inf, Unit("MPa", 1e-6))),
    "strain": ((2e-3, Unit("10⁻⁶", 1e6)), (np.inf, Unit("10⁻³", 1e3))),
    "force": ((2e3, Unit("N/m", 1.0)), (2e6, Unit("kN/m", 1e-3)), (np.inf, Unit("MN/m", 1e-6))),
    "speed": ((np.inf, Unit("m/s", 1.0)),),
}


def unit(quantity: str, values: ArrayLike) -> Unit:
    """The unit in which the largest of the values is a handy number."""
    numbers = np.abs(np.asarray(values, dtype=float))
    largest = np.max(numbers[np.isfinite(numbers)], initial=0.0)
    return next(unit for limit, unit in UNITS[quantity] if largest <= limit)


def listed(values: ArrayLike, factor: float = 1.0) -> list[float | None]:
    """Numbers for JSON; what is not finite is null."""
    numbers = factor * np.asarray(values, dtype=float)
    return [float(f"{v:.{DIGITS}g}") if np.isfinite(v) else None for v in numbers.ravel()]


def packed(values: np.ndarray) -> dict[str, Any]:
    """An array as half-precision shares of its largest magnitude, three digits each, in base64."""
    largest = float(np.max(np.abs(values), initial=0.0)) or 1.0
    shares = (values / largest).astype("<f2")
    return {
        "largest": largest,
        "shape": list(values.shape),
        "f2": base64.b64encode(shares.tobytes()).decode(),
    }


def packed_bytes(codes: np.ndarray) -> str:
    return base64.b64encode(codes.astype(np.uint8).tobytes()).decode()
