#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The table of docs/gauges.md: what gauges beside fronts with a known fracture energy give.

    PYTHONPATH=python scripts/gauge-table.py FOLDER

Runs fronts between two blocks of PMMA into FOLDER, unless they are there, and fits the field of a tip to
their probes. Gamma and X_c are known from fracture.csv. Damping is low: what it takes near a tip counts to
the Gamma that gauges see."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import slipfront
from slipfront.figures.drawing import write_results
from slipfront.figures.gauges import draw_fits
from slipfront.near_tip import ZONES
from slipfront.pages import table, with_tables

PAGE = Path(__file__).resolve().parent.parent / "docs" / "gauges.md"
FIGURE = PAGE.parent / "figures" / "gauges_fit.png"
OF_FIGURE = ("rupture, d_c = 2.2 um", 3.5e-3)  # the front, and about the height of the gauges
PMMA = {"youngs_modulus_Pa": 5.65e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180.0}
DAMPING = {"stiffness_damping_s": 0.01e-6}
HEIGHTS_M = (0.5e-3, 1e-3, 3.5e-3, 10e-3)
P_PA, MU_K = 5e6, 0.3
LEAST_ROWS = 2  # of elements below a gauge
LEAST_WAY = 4  # heights that a front has run from its patch when it comes to a gauge
FAST = 0.9  # of c_R, from which on the field lags behind a front that speeds up
WAVES = slipfront.wave_speeds(**PMMA)


def case(
    width_m: float,
    height_m: float,
    h_m: float,
    t_Pa: float,
    end_s: float,
    places_m: tuple[float, ...],
    **tables: Any,
) -> dict[str, Any]:
    """Two blocks under prescribed tractions; probes at the centres of elements."""
    at = [round(x / h_m) * h_m + h_m / 2 for x in places_m]
    plate = {"height_m": height_m, "coarsenings": 3, "fine_height_m": 12e-3}
    edges = tables.pop("edges", ("absorbing", "absorbing"))
    return {
        "plate": {"width_m": width_m, "element_size_m": h_m, "sides": "absorbing", "top": edges[0], **plate},
        "material": PMMA | DAMPING,
        "base": {"kind": "body", "sides": "absorbing", "bottom": edges[1], **plate, **PMMA, **DAMPING},
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": t_Pa, "p_Pa": P_PA},
        "event": {"kind": "nucleation"},
        "time": {"end_s": end_s, "quiet_s": float("inf")},
        "fronts": {"l_star_m": 2e-3, "arrest_time_s": 50e-6, "trigger_margin_m": 2e-3},
        "probes": {
            "x_m": [x for x in at for _ in HEIGHTS_M],
            "y_m": [y for _ in at for y in HEIGHTS_M],
            "interval_s": 0.25e-6,
        },
        **tables,
    }


def from_patch(x_m: float, half_m: float, d_c_m: float, **more: Any) -> dict[str, Any]:
    patch = {"form": "weakened", "x_m": x_m, "half_length_m": half_m, "taper_m": 5e-3}
    return {"nucleation": patch, "friction": {"mu_s": 0.5, "mu_k": MU_K, "d_c_m": d_c_m, **more}}


def problems(folder: Path) -> dict[str, dict[str, Any]]:
    """Cases by what the table calls them."""
    x_m = np.linspace(0, 0.6, 601)
    d_c_m = 35 * np.maximum(np.abs(x_m - 0.3), 5e-3) * 2 / (0.2 * P_PA)  # Gamma grows by 35 J/m3
    along = folder / "self-similar.csv"
    rows = (f"{x:.10g},{d:.10g}" for x, d in zip(x_m, d_c_m, strict=True))
    along.write_text("\n".join(["x_m,d_c_m", *rows]) + "\n", encoding="utf-8")
    V = 0.8 * WAVES.c_R_m_per_s
    forced = {"form": "forced", "x_m": 0.0, "half_length_m": 0.6, "taper_m": 0.0, "front_speed_m_per_s": V,
              "weakening_time_s": 6e-3 / V}  # fmt: skip
    rupture = (0.1, 0.12, 0.14, 0.16, 0.18)
    return {
        "rupture, d_c = 0.6 um": case(
            0.16, 0.06, 0.125e-3, 1.75e6, 140e-6, (0.062, 0.066, 0.07, 0.09, 0.11, 0.13),
            **from_patch(0.04, 12e-3, 0.6e-6),
        ),
        "rupture, d_c = 2.2 um": case(
            0.24, 0.08, 0.25e-3, 1.8e6, 220e-6, (0.08, *rupture), **from_patch(0.04, 20e-3, 2.2e-6)
        ),
        "rupture, d_c = 6 um": case(
            0.5, 0.2, 0.5e-3, 1.8e6, 480e-6, (0.2, 0.22, 0.24, 0.28, 0.32, 0.36),
            **from_patch(0.08, 50e-3, 6e-6),
        ),
        "grows from a point": case(
            0.6, 0.25, 0.25e-3, 1.85e6, 330e-6, (0.38, 0.4, 0.42, 0.44),
            **from_patch(0.3, 15e-3, 2e-6, file=str(along)),
        ),
        "driven along a strip": case(
            0.6, 0.06, 0.25e-3, 1.75e6, 0.55 / V, (0.3, 0.33, 0.36, 0.4), edges=("loaded", "held"),
            nucleation=forced, friction={"mu_s": 0.6, "mu_k": MU_K, "d_c_m": 1.0},
        ),
    }  # fmt: skip


def known(run: slipfront.OpenRun, x_m: float) -> tuple[float, float, float]:
    """V, Gamma and X_c of the front to +x at a place, from its onsets and breakdown 3 mm to both sides."""
    near = run.fracture.isel(point=(abs(run.fracture.x_m - x_m) < 3e-3) & (run.fracture.direction == 1))
    V = 1 / np.polyfit(near.x_m.to_numpy(), near.onset_s.to_numpy(), 1)[0]
    Gamma, weakens_s = (float(near[n].median()) for n in ("breakdown_work_J_per_m2", "weakening_time_s"))
    return float(V), Gamma, float(V) * weakens_s


def begins_m(given: dict[str, Any]) -> float:
    """Where the front begins: the end of its patch; of a driven one the edge."""
    patch = given["nucleation"]
    return (
        0.0 if patch["form"] == "forced" else float(patch["x_m"] + patch["half_length_m"] + patch["taper_m"])
    )


def row_of(name: str, run: slipfront.OpenRun, gauges: list[slipfront.Gauge]) -> list[str]:
    V, Gamma, zone = np.array([known(run, gauge.x_m) for gauge in gauges]).T
    alone = slipfront.fit_tips(gauges, run, direction=1)
    of_each = np.array([fit.Gamma_J_per_m2 for fit in alone]) / Gamma
    together = []
    for kind in ZONES:
        try:
            fits = slipfront.fit_front(gauges, run, alone=alone, direction=1, zone=kind)
        except slipfront.CaseError:
            together.append("refused")
            continue
        of_zone = np.median([fit.cohesive_zone_m for fit in fits]) / np.median(zone)
        together.append(f"{fits[0].Gamma_J_per_m2 / Gamma.mean():.2f}, {of_zone:.2f}")
    share = V / WAVES.c_R_m_per_s
    return [
        name, f"{1e3 * np.median(zone):.2g}", f"{share.min():.2f} to {share.max():.2f}",
        f"{1e3 * abs(gauges[0].y_m):.2g}",
        f"{np.nanmedian(of_each):.2f}, {np.nanmin(of_each):.2f} to {np.nanmax(of_each):.2f}", *together,
    ]  # fmt: skip


def draw(gauges: list[slipfront.Gauge], run: slipfront.OpenRun) -> None:
    """The first gauges that the front passes, with their fits, alone and together."""
    alone = slipfront.fit_tips(gauges, run, direction=1)
    together = slipfront.fit_front(gauges, run, alone=alone, direction=1)
    write_results(FIGURE, run.folder, lambda _: draw_fits([("", gauges, alone + together)]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for name, given in problems(folder).items():
        there = folder / name.replace(" ", "-")
        run = slipfront.open(there) if (there / "run.json").exists() else slipfront.run(given, output=there)
        assert isinstance(run, slipfront.OpenRun)
        gauges = slipfront.gauges_of(run)
        if name == OF_FIGURE[0]:
            draw([g for g in gauges if abs(g.y_m - OF_FIGURE[1]) < 0.2e-3][:3], run)
        for fast in (False, True):
            heights = {
                gauge.y_m for gauge in gauges if gauge.y_m > LEAST_ROWS * given["plate"]["element_size_m"]
            }
            for y_m in sorted(heights):
                own = [g for g in gauges if g.y_m == y_m and g.x_m - begins_m(given) > LEAST_WAY * y_m]
                own = [g for g in own if (known(run, g.x_m)[0] > FAST * WAVES.c_R_m_per_s) == fast]
                if len(own) > 2:
                    rows.append(row_of(name, run, own))
                    print(rows[-1], flush=True)
    header = ["front", "X_c (mm)", "V/c_R", "height (mm)", "Gamma of each gauge", "together: Gamma, X_c",
              "zone of slip: Gamma, X_c"]  # fmt: skip
    PAGE.write_text(
        with_tables(PAGE, PAGE.read_text("utf-8"), {"known": table(header, rows)}), encoding="utf-8"
    )


if __name__ == "__main__":
    main()
