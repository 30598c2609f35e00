# SPDX-License-Identifier: BSD-3-Clause
"""A rupture between PMMA and aluminium: how far does it come on either side, and which body moves more?"""

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
PMMA = {"youngs_modulus_Pa": 2.6e9, "poissons_ratio": 0.37, "density_kg_per_m3": 1200}
ALUMINIUM = {"youngs_modulus_Pa": 70e9, "poissons_ratio": 0.33, "density_kg_per_m3": 2700}
DAMPING = {"stiffness_damping_s": 0.1e-6}
FRICTION = {"law": "slip_weakening", "mu_s": 0.7, "mu_k": 0.4, "d_c_m": 4e-6}
T_PA, P_PA = 1.2e6, 2e6
PATCH_M, HALF_LENGTH_M = 0.1, 12.5e-3
SLIPPED_M = 0.1e-6


def compose() -> slipfront.Stepper:
    mesh = slipfront.Mesh(**PLATE)  # of both: the body below is described upside down
    above, below = slipfront.Body(mesh, **PMMA, **DAMPING), slipfront.Body(mesh, **ALUMINIUM, **DAMPING)
    stepper = slipfront.Stepper(above, slipfront.Interface(**FRICTION), below)
    weakened = np.abs(stepper.x_m - PATCH_M) <= HALF_LENGTH_M
    stepper.start(T_PA, P_PA, strength_fraction=np.where(weakened, 0, 1))
    return stepper


def main() -> None:
    stepper = compose()
    stepper.run_until(50e-6)
    slipped = stepper.x_m[stepper.slip_m > SLIPPED_M]
    print(f"to the left {PATCH_M - slipped.min():.3f} m, to the right {slipped.max() - PATCH_M:.3f} m")
    for name, body in ("PMMA", 0), ("aluminium", 1):
        u_x_m, _ = stepper.displacement_m(body)
        print(f"{name} has moved by up to {np.abs(u_x_m).max() * 1e6:.2f} um")


if __name__ == "__main__":
    main()
