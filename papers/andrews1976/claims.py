# SPDX-License-Identifier: BSD-3-Clause
"""When ruptures between equal half-spaces pass c_S: what Andrews 1976 and 1985 say, and what slipfront finds.

    python papers/andrews1976/claims.py [FOLDER]

runs a rupture for each strength excess S = (tau_s - tau_0)/(tau_0 - tau_r) and prints the claims; lengths
and a figure go to FOLDER, if given. Lengths are half-lengths over L_c, half the critical length of a crack.
"""

import csv
import math
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import slipfront

case = Path(__file__).with_name("transition.toml")
limit = 1.77  # below which ruptures pass c_S: Burridge 1973, Andrews 1985
# What counts as agreement: the curve was drawn through few runs, and how a rupture begins changes the length.
tolerance = 0.25
followed = 1.5  # ruptures are followed to as many expected lengths
length_above_limit = 40.0  # to which the rupture at S > 1.77 is followed
# Of the process zone at rest: for the place of the transition (docs/mesh.md), and for a rupture without one.
elements_below, elements_above = 16, 8


def expected(excess: float) -> float:
    """Length at which a rupture passes c_S: Andrews 1985."""
    return 9.8 * (limit - excess) ** -3


@dataclass(frozen=True)
class Rupture:
    """A rupture that was followed to a length, and the length at which its tip passes c_S, or NaN."""

    excess: float  # S
    length: float
    transition: float


def changes_of(excess: float, length: float) -> tuple[dict[str, Any], float]:
    """Changes of the case for a rupture that grows to a length, and L_c, m."""
    given = tomllib.loads(case.read_text())
    friction, p_Pa = given["friction"], given["prestress"]["p_Pa"]
    t_Pa = (friction["mu_s"] + excess * friction["mu_k"]) / (1 + excess) * p_Pa
    info = slipfront.info(case, {"prestress.t_Pa": t_Pa})
    L_c_m, zone_m = info.rupture.griffith_half_length_m, info.rupture.process_zone_m
    assert L_c_m is not None and zone_m is not None
    element_m = zone_m / (elements_below if excess < limit else elements_above)
    # Waves that the edges reflect meet the tip, which is slower than c_S, after the end.
    columns = 8 * math.ceil(1.3 * length * L_c_m / element_m / 4)
    height_m = 8 * math.ceil(columns / 24) * element_m
    growth_m_per_s = 0.3 * info.speeds.c_S_m_per_s
    return {
        "prestress.t_Pa": t_Pa,
        "plate.element_size_m": element_m,
        "plate.width_m": columns * element_m,
        "plate.height_m": height_m,
        "plate.coarsenings": 2,
        "base.height_m": height_m,
        "base.coarsenings": 2,
        "nucleation.x_m": columns / 2 * element_m,
        "nucleation.half_length_m": L_c_m,
        "nucleation.front_speed_m_per_s": growth_m_per_s,
        "nucleation.weakening_time_s": 0.3 * L_c_m / growth_m_per_s,
        "time.end_s": L_c_m / growth_m_per_s + 2 * length * L_c_m / info.speeds.c_S_m_per_s,
    }, L_c_m


def rupture(excess: float, length: float) -> Rupture:
    """Follows a rupture to a length."""
    changes, L_c_m = changes_of(excess, length)
    run = slipfront.run(case, changes, progress=False)
    assert isinstance(run, slipfront.OpenRun)
    lengths = np.abs(run.fronts.x_m.values - changes["nucleation.x_m"]) / L_c_m
    fast = run.fronts.v_tip_m_per_s.values > run.info["wave_speeds"]["c_S_m_per_s"]
    return Rupture(excess, lengths.max(), lengths[fast & (lengths > 1)].min(initial=np.inf))


@dataclass(frozen=True)
class Claim:
    """What a paper says, and whether it holds."""

    source: str
    text: str
    holds: bool
    measured: str


def claims_of(ruptures: list[Rupture]) -> list[Claim]:
    """The claims, tested by ruptures below and above the limit."""
    below = [r for r in ruptures if r.excess < limit]
    above = [r for r in ruptures if r.excess > limit]
    off = {r.excess: r.transition / expected(r.excess) - 1 for r in below}
    return [
        Claim(
            "Andrews 1976",
            f"below S = {limit} ruptures come to pass c_S",
            all(np.isfinite(r.transition) for r in below),
            "; ".join(f"S = {r.excess:g} at {r.transition:.3g} L_c" for r in below),
        ),
        Claim(
            "Burridge 1973, Andrews 1985",
            f"above S = {limit} they do not",
            all(np.isinf(r.transition) for r in above),
            "; ".join(
                f"S = {r.excess:g} not up to {r.length:.3g} L_c" for r in above if np.isinf(r.transition)
            ),
        ),
        Claim(
            "Andrews 1985",
            f"they do at 9.8 ({limit} - S)^-3 L_c (to {tolerance:.0%})",
            all(abs(value) <= tolerance for value in off.values()),
            "; ".join(f"S = {S:g} off by {value:+.0%}" for S, value in off.items()),
        ),
    ]


def draw(ruptures: list[Rupture], file: Path) -> None:
    """Lengths at the transition over S."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(5, 3.4), layout="constrained")
    excess = np.linspace(0.3, 1.25)
    axes.semilogy(
        excess, [expected(S) for S in excess], "k-", lw=1, label="9.8 (1.77 - S)$^{-3}$, Andrews 1985"
    )
    below = [r for r in ruptures if np.isfinite(r.transition)]
    axes.semilogy([r.excess for r in below], [r.transition for r in below], "o", label="slipfront")
    axes.set(xlabel="strength excess S", ylabel="half-length at c$_S$ over L$_c$")
    axes.legend(frameon=False)
    figure.savefig(file, dpi=160)


def main(folder: Path | None) -> None:
    ruptures = [rupture(excess, followed * expected(excess)) for excess in (0.4, 0.6, 0.8, 1.0)]
    ruptures.append(rupture(2.2, length_above_limit))
    claims = claims_of(ruptures)
    for claim in claims:
        print(
            f"{'holds' if claim.holds else 'DOES NOT HOLD'}: {claim.text} ({claim.source}). {claim.measured}"
        )
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "ruptures.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["S", "half_length_over_L_c", "transition_over_L_c", "expected_over_L_c"])
        rows.writerows(
            [r.excess, r.length, r.transition, expected(r.excess) if r.excess < limit else ""]
            for r in ruptures
        )
    draw(ruptures, folder / "transition.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
