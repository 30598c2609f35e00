# SPDX-License-Identifier: BSD-3-Clause
"""Runs the paper's events on three meshes; renews table and picture of fracture.md."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import slipfront
from slipfront.figures import style
from slipfront.figures.drawing import write_figure
from slipfront.pages import Tables, command_to_renew, table

EVENTS = {
    "left": "left-triggered, mu_k = 0.6",
    "spontaneous": "spontaneous, mu_k = 0.6",
    "right": "right-triggered, mu_k = 0.6",
    "spontaneous_mu_k_1.0": "spontaneous, mu_k = 1.0",
}
COLOURS = dict(zip(EVENTS, ("#0072b2", "#009e73", "#d55e00", "#882255"), strict=True))
SIZES_M = (1e-3, 2e-3 / 3, 1e-3 / 3)
DRAWN_M = SIZES_M[1]
MOST_SPEED = 5.5  # drawn, over c_S


@dataclass
class MainFront:
    """The longest front of an event. Arrays: [points]"""

    event: str
    size_m: float
    speed: np.ndarray  # over c_S
    rise: np.ndarray  # of the energy density
    drop: np.ndarray  # of the stress, over that of the strength
    work_J_per_m2: np.ndarray
    zone_m: np.ndarray
    G_over_Gamma: np.ndarray  # of the crack at rest


def G_over_Gamma(
    run: slipfront.OpenRun, x_m: np.ndarray, direction: int, at_x_m: float | None = None
) -> np.ndarray:
    """Of a crack at rest that grows from `at_x_m`, along a front, by what friction took in its run. NaN
    beyond what is predicted."""
    predicted = slipfront.predict_fronts(run, at_x_m=at_x_m)
    same_way = predicted.isel(point=(predicted.direction == direction).to_numpy())
    if same_way.sizes["point"] == 0:
        return np.full(len(x_m), np.nan)
    ratio = same_way.G_static_J_per_m2 / same_way.fracture_energy_J_per_m2
    order = np.argsort(same_way.x_m.to_numpy())
    known = same_way.x_m.to_numpy()[order], ratio.to_numpy()[order]
    return np.interp(x_m, *known, left=np.nan, right=np.nan)


def correlation(a: np.ndarray, b: np.ndarray) -> str:
    """Of ranks, where both are known."""
    both = np.isfinite(a) & np.isfinite(b)
    return f"{slipfront.rank_correlation(a[both], b[both]):.2f}" if both.sum() > 2 else "-"


def main_front(event: str, size_m: float, case: Path, folder: Path) -> MainFront:
    result = slipfront.run(
        case, {"plate.element_size_m": size_m, "output.snapshot_times_s": []}, output=folder, progress=False
    )
    assert isinstance(result, slipfront.OpenRun)
    ids, counts = np.unique(result.fracture.front_id, return_counts=True)
    is_main = result.fracture.front_id == ids[counts.argmax()]
    points, fronts = (data.isel(point=is_main.to_numpy()) for data in (result.fracture, result.fronts))
    return MainFront(
        event,
        size_m,
        (points.v_tip_m_per_s / result.info["wave_speeds"]["c_S_m_per_s"]).to_numpy(),
        ((fronts.U_r_J_per_m3 - fronts.U_s_J_per_m3) / fronts.U_s_J_per_m3).to_numpy(),
        (points.stress_drop_Pa / (points.peak_t_Pa - points.residual_t_Pa)).to_numpy(),
        points.breakdown_work_J_per_m2.where(points.breakdown_complete == 1).to_numpy(),
        points.cohesive_zone_m.to_numpy(),
        G_over_Gamma(result, points.x_m.to_numpy(), int(points.direction[0])),
    )


def median(values: np.ndarray) -> str:
    """A dash where nothing is known."""
    known = values[np.isfinite(values)]
    return f"{np.median(known):.2g}" if len(known) else "-"


HEADER = [
    "event", "h", "Gamma (J/m2)", "X_c/h", "median speed/c_S", "below c_S", "median G_static/Gamma",
    "with (U_r-U_s)/U_s", "with drop/strength drop", "with G_static/Gamma",
]  # fmt: skip


def row(f: MainFront) -> list[str]:
    known = f.speed[np.isfinite(f.speed)]
    return [
        EVENTS[f.event],
        f"{1e3 * f.size_m:.2f} mm",
        f"{np.nanmedian(f.work_J_per_m2):.3f}",
        f"{np.nanmedian(f.zone_m) / f.size_m:.2g}",
        f"{np.median(known):.2f}",
        f"{np.mean(known < 1):.0%}",
        median(f.G_over_Gamma),
        *(correlation(f.speed, by) for by in (f.rise, f.drop, f.G_over_Gamma)),
    ]


def draw(fronts: list[MainFront], picture: Path) -> None:
    with matplotlib.rc_context(style.RC):
        figure = style.new_figure(2 * style.COLUMN_MM, 60)
        panels = figure.subplots(1, 3)
        for f in (f for f in fronts if f.size_m == DRAWN_M):
            for ax, x in zip(panels, (f.rise, f.drop, f.G_over_Gamma), strict=True):
                ax.plot(x, f.speed, ".", ms=2, color=COLOURS[f.event], label=EVENTS[f.event])
        labels = ("(U_r - U_s)/U_s", "stress drop / strength drop", "G at rest / fracture energy")
        for ax, label in zip(panels, labels, strict=True):
            ax.set(xlabel=label, ylim=(0, MOST_SPEED))
            ax.axhline(1, color="0.6", lw=0.6)
        panels[2].set_xscale("log")
        panels[0].set_ylabel("speed / c_S")
        panels[0].legend(fontsize=5, markerscale=3)
        write_figure(picture, figure)


def write(folder: Path, picture: Path) -> Tables:
    cases = Path(__file__).parent
    fronts = [
        main_front(event, size_m, cases / f"{event}.toml", folder / f"{event}-{size_m:.5f}")
        for event in EVENTS
        for size_m in SIZES_M
    ]
    draw(fronts, picture)
    return {"table": table(HEADER, [row(front) for front in fronts])}


if __name__ == "__main__":
    sys.exit(command_to_renew(__file__, __doc__, Path(__file__).with_name("fracture.md"), write))
