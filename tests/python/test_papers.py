# SPDX-License-Identifier: BSD-3-Clause
"""Papers that the Python package alone reproduces."""

import pytest
from common import loaded_script

pytest.importorskip("slipfront._core")


def test_a_rupture_passes_the_shear_speed_where_andrews_expects_it():
    claims = loaded_script("papers/andrews1976/claims.py")
    rupture = claims.rupture(0.4, 1.5 * claims.expected(0.4))
    assert rupture.transition == pytest.approx(claims.expected(0.4), rel=claims.tolerance)
    assert claims.claims_of([rupture])[0].holds
