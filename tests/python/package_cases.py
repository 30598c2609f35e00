# SPDX-License-Identifier: BSD-3-Clause
"""Cases and the program for the tests of the package."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
import slipfront
from common import built, call, require_done, sets
from slipfront.running import flattened

#: The plate of Kammer et al. (2012), without its mesh and event.
PLATE = """\
plate.width_m = 0.2
plate.height_m = 0.1
plate.corner = "relief"
base.kind = "rigid"
friction.law = "velocity_weakening"
"""
TILT = "loading.tilt_left_m = 0.37e-3\nloading.tilt_right_m = 0.037e-3\n"
# A few hundredths of a second.
CASE = f"""\
title = "coarse"
{PLATE}{TILT}plate.element_size_m = 5e-3
event.kind = "left"
output.snapshot_times_s = [20e-6, 60e-6]
"""


def blocks(size_m: float, damping_s: float, d_c_m: float, half_length_m: float, end_s: float) -> dict:
    """Two blocks of PMMA that a front crosses to +x, without probes."""
    pmma = {"youngs_modulus_Pa": 5.65e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180}
    body = {"height_m": 0.06, "sides": "absorbing"}
    return {
        "plate": {"width_m": 0.15, "corner": "none", "element_size_m": size_m, "top": "absorbing", **body},
        "material": {"stiffness_damping_s": damping_s, **pmma},
        "base": {"kind": "body", "bottom": "absorbing", "stiffness_damping_s": damping_s, **body, **pmma},
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": 1.8e6, "p_Pa": 5e6},
        "friction": {"law": "slip_weakening", "mu_s": 0.5, "mu_k": 0.3, "d_c_m": d_c_m},
        "event": {"kind": "nucleation"},
        "nucleation": {"form": "weakened", "x_m": 0.03, "half_length_m": half_length_m, "taper_m": 5e-3},
        "time": {"end_s": end_s, "quiet_s": float("inf")},
    }


def program(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    return call(built(), *arguments, cwd=cwd)


def write_case(folder: Path, case: str | dict = CASE) -> Path:
    """A case's text, or its tables, as a file."""
    text = "".join(f"{key} = {value}\n" for key, value in flattened(case)) if isinstance(case, dict) else case
    file = folder / "case.toml"
    file.write_text(text, encoding="utf-8")
    return file


def results_of(folder: Path, case: str | dict = CASE, *settings: str) -> Path:
    """The folder of the program's run of a case."""
    require_done(program("run", write_case(folder, case), "-q", "-o", "out", *sets(*settings), cwd=folder))
    return folder / "out"


def refused(work, kind: type[slipfront.Error] = slipfront.Error) -> str:
    """The one line with which a call is refused."""
    with pytest.raises(kind) as error:
        work()
    told = str(error.value)
    assert told.encode() and "\n" not in told
    return told
