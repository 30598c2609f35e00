# SPDX-License-Identifier: BSD-3-Clause
"""What all tests of this folder share."""

import pytest
from slipfront.figures.style import RC


@pytest.fixture(scope="session", autouse=True)
def coarse_pictures():
    """Fewer dots than in print: the tests look at what is drawn, not at its pixels."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(RC, "savefig.dpi", 20)
        yield
