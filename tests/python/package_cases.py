# SPDX-License-Identifier: BSD-3-Clause
"""Cases and the program for the tests of the package."""

from __future__ import annotations

import subprocess
from pathlib import Path

from common import built, call

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
    return call(built(), *arguments, cwd=cwd)


def write_case(folder: Path, text: str = CASE) -> Path:
    file = folder / "case.toml"
    file.write_text(text, encoding="utf-8")
    return file
