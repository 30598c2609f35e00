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
        (lambda rate, slip: np.where(slip > 0, np.nan, 1.3), "mu gives a value that is below 0 or not"),
        (lambda rate, slip: np.where(slip > 0, np.inf, 1.3), "mu gives a value that is below 0 or not"),
        (lambda rate, slip: 1.3 + 0j * slip, "complex numbers"),
        (lambda rate, slip: np.ones(3), "mu has 3 values, not 1"),
        (1.3, "mu is 1.3; it must be a function"),
    ):
        with pytest.raises(slipfront.CaseError, match=message):
            slipfront.run_with_law(CASE, law, COULOMB)


def rate_and_state(a, of_states, V0_m_per_s):
    """Aging laws of states f0 + b ln(V0 theta/d_c), with their exact steps, as the program has them.

    of_states: b, d_c_m and f0 of each"""

    def mu(slip_rate_m_per_s, *states):
        return a * np.arcsinh(slip_rate_m_per_s / (2 * V0_m_per_s) * np.exp(sum(states) / a))

    def evolve(dt_s, slip_rate_m_per_s, *states):
        after = []
        for psi, (b, d_c_m, f0) in zip(states, of_states, strict=True):
            gone = slip_rate_m_per_s * dt_s / d_c_m
            slow = np.maximum(slip_rate_m_per_s, 1e-150)
            lost = np.where(gone > 1e-140, -np.expm1(-gone) / slow, dt_s / d_c_m)
            after.append(f0 + b * np.log(np.exp((psi - f0) / b - gone) + V0_m_per_s * lost))
        return tuple(after) if len(after) > 1 else after[0]

    return mu, evolve


ONE_STATE = {"a": 0.01, "b": 0.016, "d_c_m": 1e-6, "f0": 0.6, "V0_m_per_s": 1e-6}
TWO_STATES = {"a": 0.01, "b1": 0.012, "b2": 0.006, "d_c1_m": 1e-6, "d_c2_m": 5e-6}
TWO_STATES |= {"f0": 0.6, "V0_m_per_s": 1e-6}


def event_under(friction):
    return {
        "plate": {"width_m": 0.1, "height_m": 0.02, "element_size_m": 1e-3}
        | {"corner": "none", "sides": "absorbing", "top": "absorbing"},
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": 2.65e6, "p_Pa": 5e6},
        "friction": friction,
        "event": {"kind": "nucleation"},
        "nucleation": {"form": "overstress", "overstress_Pa": 1.1e6, "half_length_m": 10e-3},
        "time": {"end_s": 20e-6, "interface_substeps": 4},
    }


@pytest.mark.parametrize(
    ("name", "law", "of_states"),
    [
        ("rate_and_state_aging", ONE_STATE, [(0.016, 1e-6, 0.6)]),
        ("rate_and_state_aging_two", TWO_STATES, [(0.012, 1e-6, 0.6), (0.006, 5e-6, 0)]),
    ],
)
def test_a_copy_of_a_law_with_states_moves_as_it(name, law, of_states):
    case = event_under({"law": name} | law)
    mu, evolve = rate_and_state(law["a"], of_states, law["V0_m_per_s"])
    theirs = slipfront.run(case)
    ours = slipfront.run_with_law(case, mu, evolve=evolve)
    states = ("psi",) if len(of_states) == 1 else ("psi_1", "psi_2")
    for field in ("slip_m", "slip_rate_m_per_s", "t_Pa", *states):
        scale = np.abs(theirs.history[field].values).max()
        # Rounding, and the slope of mu, which is a difference here, of nodes that creep.
        assert np.abs(ours.history[field] - theirs.history[field]).max() < 1e-10 * scale, field
    assert theirs.history.slip_m.max() > 1e-6 and theirs.history.slip_rate_m_per_s.max() > 0.1


def test_a_law_brings_states_of_its_own():
    """The law with two states in the place of that with one, in whose results it has names of its own."""
    a, V0, V_i, f0 = TWO_STATES["a"], 1e-6, 1e-9, 0.6
    b, d_c_m = (0.012, 0.006), (1e-6, 5e-6)
    mu, evolve = rate_and_state(a, [(b[0], d_c_m[0], f0), (b[1], d_c_m[1], 0)], V0)

    def initial(t_Pa, p_Pa):
        steady = f0 - b[0] * np.log(V_i / V0), -b[1] * np.log(V_i / V0)
        with np.errstate(all="ignore"):
            y = t_Pa / (a * p_Pa)
            log_older = (y * a + a * np.log(-np.expm1(-2 * y) * V0 / V_i) - sum(steady)) / sum(b)
        log_older = np.where((t_Pa > 0) & (p_Pa > 0), log_older, 0)
        return tuple(psi + of * log_older for psi, of in zip(steady, b, strict=True))

    theirs = slipfront.run(event_under({"law": "rate_and_state_aging_two"} | TWO_STATES))
    ours = slipfront.run_with_law(
        event_under({"law": "rate_and_state_aging"} | ONE_STATE | {"tip_slip_rate_m_per_s": 0.05}),
        mu,
        evolve=evolve,
        initial=initial,
        states={"young": "1", "old": "1"},
    )
    for field, of_theirs in (("slip_m", "slip_m"), ("young", "psi_1"), ("old", "psi_2")):
        scale = np.abs(theirs.history[of_theirs].values).max()
        assert np.abs(ours.history[field].values - theirs.history[of_theirs].values).max() < 1e-9 * scale
    assert "psi" not in ours.history
    assert ours.history.old.attrs["units"] == "1"


def test_mistakes_of_a_law_with_states():
    case = event_under({"law": "rate_and_state_aging"} | ONE_STATE)
    mu, evolve = rate_and_state(0.01, [(0.016, 1e-6, 0.6)], 1e-6)
    for wrong, message in (
        (1.0, "evolve is 1.0; it must be a function"),
        (lambda dt, rate, psi: np.nan, "evolve gives a value that is not"),
        (lambda dt, rate, psi: (psi, psi), "evolve returns 2 states; it must be a tuple of 1 states"),
    ):
        with pytest.raises(slipfront.CaseError, match=message):
            slipfront.run_with_law(case, mu, evolve=wrong)
    with pytest.raises(slipfront.CaseError, match="mu is 0.6 without slip"):
        slipfront.run_with_law(case, lambda rate, psi: 0.6, evolve=evolve)
    with pytest.raises(slipfront.CaseError, match="friction.law = coulomb has no state variable"):
        slipfront.run_with_law(CASE, mu, COULOMB, evolve=evolve)
    own = {"evolve": evolve, "initial": lambda t, p: 0.6, "states": {"psi": "1"}}
    for changed, message in (
        ({"states": ["psi_1", "psi_2"]}, "it must be units by names"),
        ({"states": None}, "need evolve, states and initial"),
        ({"initial": 0.6}, "initial is 0.6; it must be a function"),
        ({"states": {"t_Pa": "Pa"}}, "'t_Pa' cannot be a state's name"),
        ({"states": {"a": "1", "b": "1"}}, "initial returns one float; it must be a tuple of 2"),
    ):
        with pytest.raises(slipfront.CaseError, match=message):
            slipfront.run_with_law(case, mu, **(own | changed))
