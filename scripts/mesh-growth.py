# SPDX-License-Identifier: BSD-3-Clause
"""Growth of the shortest waves that the mesh carries, on uniform sliding with a constant friction
coefficient below 1, where the half-space is stable. Prints the table of verification/growing_modes.md.

usage: mesh-growth.py PROGRAM

A periodic plate with an absorbing top slides uniformly; what grows, grows from rounding. Growth: slope of
the logarithm of the largest Fourier amplitude of the slip rate over time, between rounding and a thousandth
of the sliding speed."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

N = 60  # elements along the plate
H_M = 1e-3
C_S_M_PER_S = 889.2
END_S = 2e-3
P_PA, EXCESS_PA = 1e6, 0.05e6  # pressure; driving traction beyond the strength
CASE = f"""
[plate]
width_m = {N * H_M}
height_m = {N * H_M}
element_size_m = {H_M}
corner = "none"
sides = "periodic"
top = "absorbing"
[loading]
method = "prestress"
[prestress]
p_Pa = {P_PA}
[friction]
law = "coulomb"
[event]
kind = "none"
[time]
end_s = {END_S}
quiet_s = inf
[output]
history_interval_s = 2e-6
"""
TIME = H_M / C_S_M_PER_S
PLAIN = ["time.interface_substeps=1"]
COLUMNS = {
    "no damping": [*PLAIN, "material.stiffness_damping_s=0"],
    "step 0.1 of the stable one": [*PLAIN, "material.stiffness_damping_s=0", "time.step_factor=0.1"],
    "4 rows x 18 sub-steps": ["material.stiffness_damping_s=0"],
    "predictor_corrector": [
        *PLAIN,
        "material.stiffness_damping_s=0",
        'contact.algorithm="predictor_corrector"',
    ],
    **{f"beta_R c_S/h = {b}": [*PLAIN, f"material.stiffness_damping_s={b * TIME}"] for b in (0.03, 0.1)},
    "response delayed by h/c_S": [
        *PLAIN,
        "material.stiffness_damping_s=0",
        'friction.regularisation="strength"',
        f"friction.relaxation_time_s={TIME}",
    ],
}


def growth(program: str, folder: Path, mu: float, settings: list[str]) -> str:
    """In c_S/h, with the wavelength in elements."""
    case = folder / "case.toml"
    case.write_text(CASE)
    settings = [f"friction.mu={mu}", f"prestress.t_Pa={mu * P_PA + EXCESS_PA}", *settings]
    command = [program, "run", str(case), "-q", "--overwrite", "-o", str(folder / "run")]
    subprocess.run([*command, *(a for s in settings for a in ("--set", s))], check=True)
    with h5py.File(folder / "run/interface.h5") as file:
        time_s, rate = file["time_s"][()], file["slip_rate_m_per_s"][:, :N]
    waves = np.abs(np.fft.rfft(rate, axis=1))[:, 1:] / N
    largest = waves.max(axis=1)
    speed = EXCESS_PA / (1200 * C_S_M_PER_S)
    if largest.max() < 1e-3 * speed:
        return f"below {np.log(1e-3 * speed / largest[1]) / (END_S / TIME):.3f}"
    grown = int(np.argmax(largest > 1e-3 * speed))
    first = int(np.argmax(largest > 1e-12))
    slope = np.polyfit(time_s[first:grown], np.log(largest[first:grown]), 1)[0]
    return f"{slope * TIME:.3f} ({N / (1 + np.argmax(waves[grown])):.1f})"


def main(program: str) -> None:
    print("| mu | " + " | ".join(COLUMNS) + " |")
    print("|---|" + "---|" * len(COLUMNS))
    with tempfile.TemporaryDirectory() as folder:
        for mu in (0.1, 0.3, 0.6, 0.9):
            cells = [growth(program, Path(folder), mu, settings) for settings in COLUMNS.values()]
            print(f"| {mu} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
