# SPDX-License-Identifier: BSD-3-Clause
"""Where the compiled program is: in the installed package, or in the build folder of the sources."""

from __future__ import annotations

from pathlib import Path

from slipfront.errors import Error

PLACES = ("bin/slipfront", "../../build/release/slipfront")


def program() -> Path:
    """Raises Error where it is in neither place."""
    package = Path(__file__).resolve().parent
    for place in PLACES:
        file = package / place
        if file.is_file():
            return file
    raise Error(f"the program is not in {package / PLACES[0]}: install the package again, or `make program`")
