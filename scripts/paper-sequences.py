# SPDX-License-Identifier: BSD-3-Clause
"""Loads the paper's plate on through many events; renews figure and table of papers/kammer2012/sequences.md."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib
import numpy as np
import slipfront
from shared import between_marks, checked, renew, run, write_figure
from slipfront.figures import style

MU_K = (0.6, 1.0)
COLOURS = dict(zip(MU_K, ("#0072b2", "#d55e00"), strict=True))
LOCAL = 1.3  # mu_s
EVENTS = 100
LONG_M = 0.02  # fronts whose speeds are drawn
CHANGES = {
    "sequence.max_events": EVENTS,
    "loading.shear_speed_over_c_L": 1e-9,
    "time.end_s": 10e-3,
    "output.history_interval_s": 2e-6,
    "output.snapshot_times_s": [],
}
#: Kammer et al. (2012), Fig. 6: V/c_L = a + b (1 - exp(-c rise)) of the fit, with its band.
FIT_A, FIT_B, FIT_C, FIT_BAND = 0.76, 1.80, 3.05, 0.07


@dataclass
class Loaded:
    """The plate with one mu_k."""

    mu_k: float
    sequence: slipfront.OpenSequence
    rise: np.ndarray  # of the energy density, of points of long fronts
    speed: np.ndarray  # over c_L
    later: np.ndarray  # not of the first event

    @property
    def first_global(self) -> int:
        return int(np.argmax(self.sequence.events.is_global.to_numpy() == 1))


def loaded(mu_k: float, page: Path, folder: Path) -> Loaded:
    place = folder / f"mu_k_{mu_k}"
    if not place.exists():
        slipfront.run(page.parent / "spontaneous.toml", CHANGES | {"friction.mu_k": mu_k}, output=place, progress=False)
    sequence = slipfront.open(place)
    assert isinstance(sequence, slipfront.OpenSequence)
    rise, speed, later = [], [], []
    for k, event in enumerate(sequence.runs):
        fronts = event.fronts
        if "front_id" not in fronts:
            continue
        x_m = fronts.x_m.to_numpy()
        for i in np.unique(fronts.front_id):
            points = np.flatnonzero(fronts.front_id.to_numpy() == i)
            if np.ptp(x_m[points]) < LONG_M:
                continue
            of_front = fronts.isel(point=points)
            rise.append((of_front.U_r_J_per_m3 / of_front.U_s_J_per_m3 - 1).to_numpy())
            speed.append(of_front.v_tip_m_per_s.to_numpy() / event.info["wave_speeds"]["c_L_m_per_s"])
            later.append(np.full(len(points), k > 0))
    return Loaded(mu_k, sequence, np.concatenate(rise), np.concatenate(speed), np.concatenate(later))
