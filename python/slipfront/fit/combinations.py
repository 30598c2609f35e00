# SPDX-License-Identifier: BSD-3-Clause
"""Combinations of keys that a rupture may tell where it does not tell the keys."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipfront.files import is_number
from slipfront.fit.posterior import ALIKE, Marginal, correlations, marginal
from slipfront.fit.space import Space

CLEAR = 0.5  # of the interval that a combination would have if its keys did not depend on each other
MOST_TOLD = 3
PRESSURES = ("prestress.p_Pa", "loading.mean_pressure_Pa")
Values = Mapping[str, Any]  # of keys, numbers or arrays over the samples


@dataclass(frozen=True)
class Combination:
    """Of keys of a case, whose values a function takes in their order; p stands for the pressure's key."""

    name: str
    unit: str
    keys: tuple[str, ...]
    laws: tuple[str, ...]  # for which it stands; none: for all that have the keys
    of: Callable[..., Any]


MU_S, MU_K, D_C, T, P = "friction.mu_s", "friction.mu_k", "friction.d_c_m", "prestress.t_Pa", "p"
A, B, E, NU = "friction.a", "friction.b", "material.youngs_modulus_Pa", "material.poissons_ratio"
LINEAR, EXPONENTIAL = ("slip_weakening",), ("slip_weakening_exponential",)
COMBINATIONS = (
    Combination("fracture energy (mu_s - mu_k) p d_c/2", "J/m2", (MU_S, MU_K, P, D_C), LINEAR,
                lambda s, k, p, d: (s - k) * p * d / 2),
    Combination("fracture energy (mu_s - mu_k) p d_c", "J/m2", (MU_S, MU_K, P, D_C), EXPONENTIAL,
                lambda s, k, p, d: (s - k) * p * d),
    Combination("weakening (mu_s - mu_k) p/d_c", "Pa/m", (MU_S, MU_K, P, D_C), LINEAR + EXPONENTIAL,
                lambda s, k, p, d: (s - k) * p / d),
    Combination("critical crack length G (mu_s - mu_k) p d_c/2/(t - mu_k p)^2, G shear modulus", "m",
                (MU_S, MU_K, P, D_C, T, E, NU), LINEAR,
                lambda s, k, p, d, t, e, nu: e / (4 + 4 * nu) * (s - k) * p * d / (t - k * p) ** 2),
    Combination("stress drop t - mu_k p", "Pa", (T, MU_K, P), (), lambda t, k, p: t - k * p),
    Combination("strength excess S = (mu_s p - t)/(t - mu_k p)", "", (MU_S, T, MU_K, P), (),
                lambda s, t, k, p: (s * p - t) / (t - k * p)),
    Combination("b - a", "", (A, B), (), lambda a, b: b - a),
    Combination("a/b", "", (A, B), (), lambda a, b: a / b),
    Combination("critical stiffness (b - a) p/d_c", "Pa/m", (A, B, P, D_C), (),
                lambda a, b, p, d: (b - a) * p / d),
)  # fmt: skip


def values_of(case: Values, space: Space, samples: np.ndarray) -> dict[str, Any]:
    """Numbers of a resolved case, over the samples where they are free; p by its key."""
    found = {key: value for key, value in case.items() if is_number(value)}
    found |= {"friction.law": case.get("friction.law")}
    for k, key in enumerate(space.keys):
        found[key] = space.values(samples)[:, k]
    pressure = next((key for key in PRESSURES if key in found), None)
    return found | ({P: found[pressure]} if pressure else {})


@dataclass(frozen=True)
class Combined:
    of: Combination
    marginal: Marginal
    clear: float  # its interval over that of keys that do not depend on each other


def combinations(case: Values, space: Space, samples: np.ndarray) -> list[Combined]:
    """Those of two free keys or more, the clearest first."""
    rng = np.random.default_rng(0)
    shuffled = np.column_stack([rng.permutation(column) for column in samples.T])
    values, apart, found = values_of(case, space, samples), values_of(case, space, shuffled), []
    free = {*space.keys} | ({P} if not {*PRESSURES}.isdisjoint(space.keys) else set())
    for one in COMBINATIONS:
        if len(free & {*one.keys}) < 2 or not {*one.keys} <= values.keys():
            continue
        if one.laws and values["friction.law"] not in one.laws:
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            own, other = (
                np.asarray(one.of(*(of[key] for key in one.keys)), dtype=float) for of in (values, apart)
            )
        if np.isfinite(own).all():
            wide = np.diff(np.nanquantile(other, [0.16, 0.84])).item()
            of = marginal(one.name, own)
            low, high = of.intervals[0.68]
            found.append(Combined(one, of, (high - low) / wide if wide > 0 else 1.0))
    return sorted(found, key=lambda one: one.clear)


def number(value: float) -> str:
    return f"{value:.4g}"


def in_words(of: Marginal, unit: str) -> str:
    low, high = of.intervals[0.90]
    return f"{of.name} = {number(of.median)} ({number(low)} to {number(high)})" + (f" {unit}" if unit else "")


def findings(
    space: Space,
    samples: np.ndarray,
    keys: list[Marginal],
    combined: list[Combined],
) -> list[str]:
    """What is not determined, what trades off, and what is determined instead."""
    told = [
        f"{of.name} is not determined: its interval of 90 % is most of the range that it was given"
        for of in keys
        if not of.is_determined
    ]
    alike, values = correlations(samples), space.values(samples)
    trading: set[str] = set()
    for i, first in enumerate(space.keys):
        for j in range(i + 1, space.n):
            second = space.keys[j]
            if abs(alike[i, j]) < ALIKE:
                continue
            trading |= {first, second}
            a, b = (values[:, k] / np.median(values[:, k]) for k in (i, j))
            slope = float(np.sign(alike[i, j]) * b.std() / a.std())
            way = "rises" if slope > 0 else "falls"
            told.append(
                f"{first} and {second} trade off (correlation {alike[i, j]:.2f}): "
                f"where {first} rises by 1 %, {second} {way} by {abs(slope):.2g} %"
            )
    undetermined = {of.name for of in keys if not of.is_determined}
    unsure = trading | undetermined
    clear = [one for one in combined if one.clear < CLEAR and unsure & {*one.of.keys}][:MOST_TOLD]
    told += [f"determined better than its keys: {in_words(of.marginal, of.of.unit)}" for of in clear]
    return told
