# SPDX-License-Identifier: BSD-3-Clause
"""Friction laws in Python against the built-in ones that they copy."""

from __future__ import annotations

import numpy as np
import pytest
import slipfront
from package_cases import CASE

SHORT = {"time.end_s": 60e-6, "output.snapshot_times_s": []}
COULOMB = {**SHORT, "friction.law": "coulomb", "friction.mu": 1.3}
SLIP_WEAKENING = {
    **SHORT,
    "friction.law": "slip_weakening",
    "friction.mu_s": 1.3,
    "friction.mu_k": 0.6,
    "friction.d_c_m": 20e-6,
}

STRENGTH_RELAXED = {"friction.regularisation": "strength", "friction.relaxation_time_s": 1e-6}


def weakening(slip_rate_m_per_s, slip_m):
    return 0.6 + (1.3 - 0.6) * np.maximum(0, 1 - slip_m * (1 / 20e-6))


@pytest.mark.parametrize("algorithm", ["direct", "predictor_corrector"])
def test_a_constant_coefficient_is_coulombs_bit_for_bit(algorithm):
    changes = {**COULOMB, "contact.algorithm": algorithm}
    theirs = slipfront.run(CASE, changes)
    ours = slipfront.run_with_law(CASE, lambda rate, slip: 1.3, changes)
    assert float(theirs.history.slip_m.max()) > 0
    for name in ("slip_m", "slip_rate_m_per_s", "t_Pa", "p_Pa"):
        assert np.array_equal(ours.history[name], theirs.history[name]), name
    assert np.array_equal(ours.fronts.onset_s, theirs.fronts.onset_s)


def velocity_weakening(slip_rate_m_per_s, slip_m):
    return 0.6 + (1.3 - 0.6) * np.exp(-slip_rate_m_per_s * np.sqrt((1.3 - 0.6) / 0.1))


@pytest.mark.parametrize(
    "law, changes, least_m",
    [
        (weakening, SLIP_WEAKENING, 20e-6),
        (weakening, SLIP_WEAKENING | STRENGTH_RELAXED, 20e-6),
        # A last digit of mu that is rounded otherwise grows while nodes slip.
        (velocity_weakening, SHORT | {"time.end_s": 10e-6}, 0),
    ],
)
def test_a_copy_differs_by_rounding(law, changes, least_m):
    theirs = slipfront.run(CASE, changes)
    ours = slipfront.run_with_law(CASE, law, changes)
    scale = float(theirs.history.slip_m.max())
    assert scale > least_m
    assert np.abs(ours.history.slip_m - theirs.history.slip_m).max() < 1e-9 * scale


def test_the_arguments_are_arrays_over_the_nodes():
    seen = []

    def mu(slip_rate_m_per_s, slip_m):
        seen.append((slip_rate_m_per_s, slip_m))
        return np.full(slip_m.shape, 1.3)

    run = slipfront.run_with_law(CASE, mu, {**COULOMB, "time.end_s": 5e-6})
    n = run.history.sizes["x_m"]
    assert all(rate.shape == slip.shape == (n,) for rate, slip in seen[1:])
    assert max(slip.max() for _, slip in seen) > 0
    assert all((rate >= 0).all() and (slip >= 0).all() for rate, slip in seen)


def test_mistakes_of_a_law():
    def breaks(rate, slip):
        if len(slip) > 1:
            raise ZeroDivisionError("in the law")
        return 1.3

    with pytest.raises(ZeroDivisionError, match="in the law"):
        slipfront.run_with_law(CASE, breaks, COULOMB)
    for law, message in (
        (lambda rate, slip: 1.0, r"mu\(0, 0\) is 1.0, the case's coefficient at rest 1.3"),
        (lambda rate, slip: np.where(slip > 0, np.nan, 1.3), "mu must be at least 0 and a finite number"),
        (lambda rate, slip: np.where(slip > 0, np.inf, 1.3), "mu must be at least 0 and a finite number"),
        (lambda rate, slip: 1.3 + 0j * slip, "complex numbers"),
        (lambda rate, slip: np.ones(3), "mu has 3 values, not 1"),
        (1.3, "mu is 1.3; it must be a function"),
    ):
        with pytest.raises(slipfront.CaseError, match=message):
            slipfront.run_with_law(CASE, law, COULOMB)


def rate_and_state(a, b, d_c_m, f0, V0_m_per_s):
    """The aging law with its state's exact step, as the program has it."""

    def mu(slip_rate_m_per_s, psi):
        return a * np.arcsinh(slip_rate_m_per_s / (2 * V0_m_per_s) * np.exp(psi / a))

    def evolve(dt_s, slip_rate_m_per_s, psi):
        gone = slip_rate_m_per_s * dt_s / d_c_m
        lost = np.where(gone > 1e-140, -np.expm1(-gone) / np.maximum(slip_rate_m_per_s, 1e-150), dt_s / d_c_m)
        return f0 + b * np.log(np.exp((psi - f0) / b - gone) + V0_m_per_s * lost)

    return mu, evolve


def test_a_copy_of_the_aging_law_moves_as_it():
    law = {"a": 0.01, "b": 0.016, "d_c_m": 1e-6, "f0": 0.6, "V0_m_per_s": 1e-6}
    case = {
        "plate": {"width_m": 0.1, "height_m": 0.02, "element_size_m": 1e-3}
        | {"corner": "none", "sides": "absorbing", "top": "absorbing"},
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": 2.65e6, "p_Pa": 5e6},
        "friction": {"law": "rate_and_state_aging"} | law,
        "event": {"kind": "nucleation"},
        "nucleation": {"form": "overstress", "overstress_Pa": 1.1e6, "half_length_m": 10e-3},
        "time": {"end_s": 20e-6, "interface_substeps": 4},
    }
    mu, evolve = rate_and_state(**law)
    theirs = slipfront.run(case)
    ours = slipfront.run_with_law(case, mu, evolve=evolve)
    for name in ("slip_m", "slip_rate_m_per_s", "t_Pa", "psi"):
        scale = np.abs(theirs.history[name].values).max()
        # Rounding, and the slope of mu, which is a difference here, of nodes that creep.
        assert np.abs(ours.history[name] - theirs.history[name]).max() < 1e-10 * scale, name
    assert theirs.history.slip_m.max() > 1e-6 and theirs.history.slip_rate_m_per_s.max() > 0.1
    for wrong, message in (
        (1.0, "evolve is 1.0; it must be a function"),
        (lambda dt, rate, psi: np.nan, "evolve must be a finite number"),
    ):
        with pytest.raises(slipfront.CaseError, match=message):
            slipfront.run_with_law(case, mu, evolve=wrong)
    with pytest.raises(slipfront.CaseError, match="mu is 0.6 without slip"):
        slipfront.run_with_law(case, lambda rate, psi: 0.6, evolve=evolve)
    with pytest.raises(slipfront.CaseError, match="friction.law = coulomb has no state variable"):
        slipfront.run_with_law(CASE, mu, COULOMB, evolve=evolve)
