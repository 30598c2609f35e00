# SPDX-License-Identifier: BSD-3-Clause
"""A loading of one's own: fluid spreads along the interface from a well and takes the pressure off it."""

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
T_PA, P_PA, FLUID_PA = 1.2e6, 2e6, 0.6e6
WELL_M, WIDTH_M, DIFFUSIVITY_M2_PER_S = 0.1, 10e-3, 5.0
RISE_S, EVERY = 20e-6, 4


def pressure_Pa(x_m: np.ndarray, time_s: float) -> np.ndarray:
    """Of the contact: the fluid's rises at the well and spreads."""
    spread_m2 = WIDTH_M**2 + 4 * DIFFUSIVITY_M2_PER_S * time_s
    return P_PA - FLUID_PA * min(time_s / RISE_S, 1) * np.exp(-((x_m - WELL_M) ** 2) / spread_m2)


def compose() -> slipfront.Stepper:
    plate = slipfront.Body(slipfront.Mesh(**PLATE), **PMMA)
    stepper = slipfront.Stepper(plate, slipfront.Interface(**FRICTION))
    stepper.start(T_PA, pressure_Pa(stepper.x_m, 0))
    return stepper


def inject(stepper: slipfront.Stepper, end_s: float) -> float:
    """Until slip begins, or a time. Returns when it began, or NaN."""
    while stepper.time_s < end_s:
        stepper.set_tractions(T_PA, pressure_Pa(stepper.x_m, stepper.time_s))
        stepper.advance(EVERY)
        if stepper.slip_m.max() > 0:
            return stepper.time_s
    return float("nan")


def main() -> None:
    stepper = compose()
    began_s = inject(stepper, 30e-6)
    where_m = stepper.x_m[stepper.slip_m.argmax()]
    print(f"slip began at {began_s * 1e6:.2f} us, x = {where_m:.3f} m")


if __name__ == "__main__":
    main()
