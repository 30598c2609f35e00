# SPDX-License-Identifier: BSD-3-Clause
"""Loads the paper's plate on; renews table and picture of sequences.md."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import slipfront
from drawing.results import PAPER_FIT
from slipfront.figures import style
from slipfront.figures.drawing import write_figure
from slipfront.pages import Tables, command_to_renew, table

from cases import C_L_M_PER_S
from fracture import G_over_Gamma, correlation

MU_K = (0.6, 1.0)
COLOURS = dict(zip(MU_K, ("#0072b2", "#d55e00"), strict=True))
LOCAL = 1.3  # mu_s
EVENTS = 100
LONG_M = 0.02  # of fronts whose speeds are drawn
DRAWN = 12  # global events of which they are
RISE_TO, FASTEST = 2.5, 3.0  # drawn; over c_L
CHANGES = {
    "sequence.max_events": EVENTS,
    "loading.shear_speed_m_per_s": 1e-9 * C_L_M_PER_S,
    "time.end_s": 10e-3,
    "output.history_interval_s": 2e-6,
    "output.snapshot_times_s": [],
}


@dataclass
class Front:
    """A long front. Arrays: [points]"""

    event: int  # of those drawn, from 0
    rise: np.ndarray  # of the energy density
    speed: np.ndarray  # over c_L
    G_over_Gamma: np.ndarray  # of the crack at rest


@dataclass
class Loaded:
    """The plate with one mu_k."""

    mu_k: float
    sequence: slipfront.OpenSequence
    fronts: list[Front]

    def column(self, name: str) -> np.ndarray:
        return self.sequence.events[name].to_numpy()

    @property
    def n_precursors(self) -> int:
        """Events before the first in which all nodes inside slip."""
        return int(np.argmax(self.column("is_global") == 1))


def long_fronts(sequence: slipfront.OpenSequence) -> list[Front]:
    found: list[Front] = []
    for event, begin_x_m, is_global in zip(
        sequence.runs, sequence.events.begin_x_m.to_numpy(), sequence.events.is_global.to_numpy(), strict=True
    ):
        number = len({f.event for f in found})
        for i in np.unique(event.fronts.front_id) if is_global and number < DRAWN else ():
            points = event.fronts.isel(point=(event.fronts.front_id == i).to_numpy())
            x_m = points.x_m.to_numpy()
            if np.ptp(x_m) < LONG_M or abs(x_m[0] - begin_x_m) > LONG_M:
                continue
            found.append(
                Front(
                    number,
                    (points.U_r_J_per_m3 / points.U_s_J_per_m3 - 1).to_numpy(),
                    points.v_tip_m_per_s.to_numpy() / event.info["wave_speeds"]["c_L_m_per_s"],
                    G_over_Gamma(event, x_m, int(np.sign(x_m[-1] - x_m[0])), begin_x_m),
                )
            )
    return found


def loaded(mu_k: float, folder: Path) -> Loaded:
    place = folder / f"mu_k_{mu_k}"
    if not place.exists():
        case = Path(__file__).with_name("spontaneous.toml")
        slipfront.run(case, CHANGES | {"friction.mu_k": mu_k}, output=place, progress=False)
    sequence = slipfront.open(place)
    assert isinstance(sequence, slipfront.OpenSequence)
    return Loaded(mu_k, sequence, long_fronts(sequence))


def with_speed(fronts: list[Front], name: str) -> str:
    """Correlation over all fronts."""
    return correlation(
        np.concatenate([getattr(f, name) for f in fronts]), np.concatenate([f.speed for f in fronts])
    )


HEADER = [
    "mu_k", "events before all slips", "longest of them (mm)", "largest F_S/F_N until then, over 1.3",
    "later: global events", "F_S/F_N where they begin", "at rest", "mean slip (um)",
    "speed with (U_r-U_s)/U_s", "with G_static/Gamma",
]  # fmt: skip


def row(p: Loaded) -> list[str]:
    n = p.n_precursors
    before, after = p.column("friction_before"), p.column("friction_after")
    is_global = p.column("is_global") == 1
    later = is_global & (np.arange(len(before)) > n)
    most = before[: n + 1].max()
    return [
        str(p.mu_k),
        str(n),
        f"{1e3 * p.column('length_m')[:n].max():.0f}" if n else "-",
        f"{most:.3f}, {most / LOCAL:.2f}",
        f"{later.sum()} of {len(before) - n - 1}",
        f"{np.median(before[later]):.3f}",
        f"{np.median(after[later]):.3f}",
        f"{1e6 * np.median(p.column('mean_slip_m')[later]):.0f}",
        with_speed(p.fronts, "rise"),
        with_speed(p.fronts, "G_over_Gamma"),
    ]


def draw(plates: list[Loaded], picture: Path) -> None:
    with matplotlib.rc_context(style.RC):
        figure = style.new_figure(2 * style.COLUMN_MM, 110)
        (force, extent), (rise, energy) = figure.subplots(2, 2)
        for p in plates:
            loading = p.sequence.loading
            colour = COLOURS[p.mu_k]
            force.plot(
                1e3 * loading.shear_m,
                loading.shear_over_normal,
                lw=0.6,
                color=colour,
                label=f"mu_k = {p.mu_k}",
            )
            for k, (left, right) in enumerate(zip(p.column("from_x_m"), p.column("to_x_m"), strict=True)):
                extent.plot([left, right], [p.column("friction_before")[k]] * 2, lw=0.5, color=colour)
            extent.plot(p.column("begin_x_m"), p.column("friction_before"), ".", ms=2, color="k")
            for f in p.fronts:
                # The first events stand out.
                marker = {"color": colour, "ms": 1.5} if f.event > 0 else {"color": "k", "ms": 2.5}
                rise.plot(f.rise, f.speed, ".", **marker)
                energy.plot(f.G_over_Gamma, f.speed, ".", **marker)
        x = np.linspace(0, RISE_TO, 100)
        rise.plot(x, PAPER_FIT(x), color="0.6", lw=1)
        force.axhline(LOCAL, color="0.6", lw=0.6)
        force.set(xlabel="displacement of the top edge (mm)", ylabel="F_S/F_N", ylim=(0, 1.4))
        force.legend(fontsize=6)
        extent.set(xlabel="x (m)", ylabel="F_S/F_N where an event begins")
        rise.set(xlabel="(U_r - U_s)/U_s", ylabel="speed / c_L", xlim=(0, RISE_TO), ylim=(0, FASTEST))
        energy.set(
            xlabel="G at rest / fracture energy", ylabel="speed / c_L", xscale="log", ylim=(0, FASTEST)
        )
        write_figure(picture, figure)


def write(folder: Path, picture: Path) -> Tables:
    plates = [loaded(mu_k, folder) for mu_k in MU_K]
    draw(plates, picture)
    return {"table": table(HEADER, [row(plate) for plate in plates])}


if __name__ == "__main__":
    sys.exit(command_to_renew(__file__, __doc__, Path(__file__).with_name("sequences.md"), write))
