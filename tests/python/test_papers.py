# SPDX-License-Identifier: BSD-3-Clause
"""Papers that the Python package alone reproduces."""

import importlib.util
from pathlib import Path

import pytest

pytest.importorskip("slipfront._core")
ROOT = Path(__file__).resolve().parents[2]


def test_a_rupture_passes_the_shear_speed_where_andrews_expects_it():
    spec = importlib.util.spec_from_file_location("claims", ROOT / "papers/andrews1976/claims.py")
    claims = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(claims)
    rupture = claims.rupture(0.4, 1.5 * claims.expected(0.4))
    assert rupture.transition == pytest.approx(claims.expected(0.4), rel=claims.tolerance)
    assert claims.claims_of([rupture])[0].holds
