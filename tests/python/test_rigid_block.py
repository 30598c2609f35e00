# SPDX-License-Identifier: BSD-3-Clause
"""Cycles of slow slip and events against the equation of a rigid block behind a spring."""

from __future__ import annotations

import sys

import pytest
from common import ROOT, loaded_script

pytest.importorskip("scipy")


@pytest.fixture(scope="module")
def script():
    sys.path.insert(0, str(ROOT / "scripts"))
    yield loaded_script("scripts/rigid-block.py")
    sys.path.remove(str(ROOT / "scripts"))


def test_cycles_are_those_of_a_rigid_block(script, tmp_path):
    """The block yields by a hundredth of the spring, and slips not quite as one."""
    softness = 0.01
    cycles = script.program(script.case(softness, script.D_C_M, ""), tmp_path / "out")
    theory = script.equation(softness, script.D_C_M, script.END_S)
    found = script.differences(script.Compared(softness, cycles, theory))
    assert len(found) == 4
    for name, (value, solution) in found.items():
        assert value == pytest.approx(solution, rel=0.02), name


def test_a_stiff_spring_slides_steadily(script, tmp_path):
    cycles, _, steady = script.stable(0.03, tmp_path)
    assert len(cycles.begin_s) == 0
    assert cycles.force[-1] == pytest.approx(steady, rel=1e-3)
