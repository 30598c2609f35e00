# SPDX-License-Identifier: BSD-3-Clause
"""A rupture of a plate on a rigid plane: it begins where friction is weakened and runs to both sides."""

from __future__ import annotations

import numpy as np
import slipfront

PLATE = {
    "width_m": 0.2,
    "height_m": 0.05,
    "element_size_m": 1e-3,
    "corner": "none",
    "sides": "absorbing",
    "top": "absorbing",
}
PMMA = {
    "youngs_modulus_Pa": 2.6e9,
    "poissons_ratio": 0.37,
    "density_kg_per_m3": 1200,
    "stiffness_damping_s": 0.1e-6,
}
FRICTION = {"law": "slip_weakening", "mu_s": 0.7, "mu_k": 0.4, "d_c_m": 4e-6}
T_PA, P_PA = 1.2e6, 2e6
PATCH_M, HALF_LENGTH_M = 0.1, 12.5e-3
SLIPPED_M = 0.1e-6


def compose() -> slipfront.Stepper:
    plate = slipfront.Body(slipfront.Mesh(**PLATE), **PMMA)
    stepper = slipfront.Stepper(plate, slipfront.Interface(**FRICTION))
    weakened = np.abs(stepper.x_m - PATCH_M) <= HALF_LENGTH_M
    stepper.start(T_PA, P_PA, strength_fraction=np.where(weakened, 0, 1))
    return stepper


def main() -> None:
    stepper = compose()
    for end_s in np.arange(10e-6, 60e-6, 10e-6):
        stepper.run_until(end_s)
        slipped = stepper.x_m[stepper.slip_m > SLIPPED_M]
        print(
            f"{stepper.time_s * 1e6:.1f} us: slip at x = {slipped.min():.3f} to {slipped.max():.3f} m, "
            f"up to {stepper.slip_m.max() * 1e6:.1f} um"
        )
    terms = stepper.energies()
    print(f"friction took {-terms['friction_work_J_per_m']:.3f} J/m")


if __name__ == "__main__":
    main()
