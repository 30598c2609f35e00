# SPDX-License-Identifier: BSD-3-Clause
"""Cycles of slow slip and events against the equation of a rigid block behind a spring."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import slipfront
from common import ROOT, loaded_script

pytest.importorskip("scipy")


@pytest.fixture(scope="module")
def script():
    sys.path.insert(0, str(ROOT / "scripts"))
    yield loaded_script("scripts/rigid-block.py")
    sys.path.remove(str(ROOT / "scripts"))


@pytest.mark.parametrize(("n_states", "heavy"), [(1, 0), (2, 0), (1, 10)])
def test_cycles_are_those_of_a_rigid_block(script, tmp_path, n_states, heavy):
    """The block yields by a hundredth of the spring, and slips not quite as one."""
    softness = 0.01
    states = script.one(script.D_C_M) if n_states == 1 else script.TWO
    cycles = script.program(script.case(softness, states, "", heavy), tmp_path / "out")
    theory = script.equation(softness, states, script.END_S, heavy)
    found = script.differences(script.Compared("", cycles, theory))
    assert len(found) == 5
    for name, (value, solution) in found.items():
        assert value == pytest.approx(solution, rel=0.02), name


@pytest.mark.slow  # 400,000 calls of a function
def test_cycles_by_a_law_in_python(script, tmp_path):
    """The law with two states, as functions, in a sequence: slow slip and events."""
    of = script.TWO

    def mu(rate, *states):
        return script.A * np.arcsinh(rate / (2 * script.V0) * np.exp((script.F0 + sum(states)) / script.A))

    def evolve(dt_s, rate, *states):
        gone = [rate * dt_s / d_c_m for d_c_m in of.d_c_m]
        grown = [
            np.where(x > 1e-140, -np.expm1(-x) / np.maximum(rate, 1e-150), dt_s / d_c_m)
            for x, d_c_m in zip(gone, of.d_c_m, strict=True)
        ]
        parts = zip(states, of.b, gone, grown, strict=True)
        return tuple(b * np.log(np.exp(state / b - x) + script.V0 * g) for state, b, x, g in parts)

    events = ("max_events = 6", "max_events = 2")
    theirs = script.program(script.case(0.01, of, "").replace(*events), tmp_path / "out")
    ours = slipfront.run_with_law(
        script.case(0.01, script.one(script.D_C_M), "").replace(*events),
        mu,
        evolve=evolve,
        initial=lambda t_Pa, p_Pa: tuple(np.zeros_like(t_Pa) for _ in of.b),
        states={"first": "1", "second": "1"},
        progress=False,
    )
    # Steps of slow slip follow from the case's own a and d_c, to 1e-5.
    np.testing.assert_allclose(ours.events.begin_s, theirs.begin_s, rtol=1e-5)
    np.testing.assert_allclose(ours.events.friction_after, theirs.after, rtol=1e-4)
    assert {"first", "second"} <= set(ours.slow[1].data_vars) & set(ours.runs[1].history.data_vars)


def test_a_stiff_spring_slides_steadily(script, tmp_path):
    cycles, _, steady = script.stable(0.03, tmp_path)
    assert len(cycles.begin_s) == 0
    assert cycles.force[-1] == pytest.approx(steady, rel=1e-3)
