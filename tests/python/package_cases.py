# SPDX-License-Identifier: BSD-3-Clause
"""Cases and the program for the tests of the package."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from shared import HANG_S

ROOT = Path(__file__).resolve().parents[2]

# A few hundredths of a second.
CASE = """\
title = "coarse"

[plate]
element_size_m = 5e-3

[event]
kind = "left"

[output]
snapshot_times_s = [20e-6, 60e-6]
"""


def program(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    path = Path(os.environ.get("SLIPFRONT", ROOT / "build/release/slipfront")).resolve()
    return subprocess.run(
        [path, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, timeout=HANG_S
    )


def write_case(folder: Path, text: str = CASE) -> Path:
    file = folder / "case.toml"
    file.write_text(text, encoding="utf-8")
    return file
