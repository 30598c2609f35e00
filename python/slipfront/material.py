# SPDX-License-Identifier: BSD-3-Clause
"""What follows from materials and friction alone. Each table is given as in a case file, by keyword; what is
not given has the case file's default. All raise CaseError for what a case file may not hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from slipfront import _core
from slipfront.given import number, table
from slipfront.running import make_case

Table = Mapping[str, Any]
DEFAULT = {"plane": "stress"}  # a case sets at least one key


def wave_speeds(**material: Any) -> _core.WaveSpeeds:
    """Speeds of longitudinal, shear and Rayleigh waves, m/s: c_L_m_per_s, c_S_m_per_s, c_R_m_per_s.

    material: keys of [material], such as youngs_modulus_Pa=2.6e9, poissons_ratio=0.37,
    density_kg_per_m3=1200, plane="strain"."""
    return make_case({"material": {**DEFAULT, **material}}, None, {}).wave_speeds


def stable_step_s(element_size_m: float, **material: Any) -> float:
    """Largest stable time step of the explicit scheme in square elements, s; with the material's damping.

    The step of a plate may be smaller by what its corners ask for: `info` tells it."""
    size_m = number(element_size_m, "element_size_m", above=0, finite=True)
    return make_case({"material": {**DEFAULT, **material}}, None, {}).stable_step_s(size_m)


def well_posedness(
    friction: Table,
    *,
    pressure_Pa: float,
    element_size_m: float,
    longest_wavelength_m: float,
    material: Table | None = None,
    base: Table | None = None,
) -> _core.WellPosedness:
    """Whether slow uniform sliding under a friction law has a growth that a finer mesh would not change.

    friction, material, base: tables of a case file, base={"kind": "body", ...} for a second half-space.
    pressure_Pa: uniform, positive in compression. longest_wavelength_m: such as the length of the interface.
    Theory: docs/stability.md."""
    p_Pa = number(pressure_Pa, "pressure_Pa", above=0, finite=True)
    size_m = number(element_size_m, "element_size_m", above=0, finite=True)
    wavelength_m = number(longest_wavelength_m, "longest_wavelength_m", above=0, finite=True)
    given = {"friction": friction, "material": material, "base": base}
    tables = {name: table(value, name) for name, value in given.items() if value is not None}
    return make_case(tables, None, {}).well_posedness(p_Pa, size_m, wavelength_m)
