# SPDX-License-Identifier: BSD-3-Clause
"""A block behind a soft spring, loaded on: sequences against the ordinary differential equation of a rigid block;
renews table and figure of verification/stick_slip.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib
import numpy as np
import slipfront
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from shared import between_marks, checked, renew, run, write_figure
from slipfront.figures import style

E_PA, NU, RHO = 2.6e9, 0.37, 1200.0
WIDTH_M, HEIGHT_M, P_PA = 0.06, 0.01, 1e6
SPEED_OVER_C_L = 1e-9
SPEED = SPEED_OVER_C_L * np.sqrt(E_PA / (RHO * (1 - NU**2)))  # of the machine, m/s
N, M = P_PA * WIDTH_M, RHO * WIDTH_M * HEIGHT_M  # per unit thickness
STIFFNESS = E_PA / (2 * (1 + NU)) * WIDTH_M / HEIGHT_M  # of the block across
A, B, V0 = 0.010, 0.015, 1e-6  # of rate and state
F0 = 0.6
MU_S, MU_K, HEALING, HEALING_S = 0.6, 0.5, 0.01, 10.0
INERTIA_FROM = 1e-6  # of the equation: slip rate, m/s
MARGIN = 1e-3  # of load, behind which an event begins
EVENTS = 6


@dataclass
class Cycles:
    """Events in their order. Arrays: [events]"""

    begin_s: np.ndarray
    before: np.ndarray  # force over normal force where it begins
    after: np.ndarray  # at rest
    fastest: np.ndarray  # slip rate, m/s
    time_s: np.ndarray  # of the curve of the force
    force: np.ndarray  # over the normal force


def case(softness: float, friction: str, sequence: str) -> str:
    return f"""
title = "block behind a spring"
[plate]
width_m = {WIDTH_M}
height_m = {HEIGHT_M}
element_size_m = 1e-3
corner = "none"
[material]
youngs_modulus_Pa = {E_PA}
poissons_ratio = {NU}
density_kg_per_m3 = {RHO}
stiffness_damping_s = 1e-7
[loading]
mean_pressure_Pa = {P_PA}
shear_stiffness_Pa = {softness * STIFFNESS}
shear_speed_over_c_L = {SPEED_OVER_C_L}
critical_margin = {MARGIN}
edge_margin_m = 2e-3
[friction]
{friction}
[event]
kind = "spontaneous"
[time]
end_s = 50e-3
quiet_s = 0.1e-3
[output]
history_interval_s = 5e-6
[sequence]
max_events = {EVENTS}
{sequence}
"""


def program(text: str, folder: Path) -> Cycles:
    if not folder.exists():
        slipfront.run(text, output=folder, progress=False)
    sequence = slipfront.open(folder)
    assert isinstance(sequence, slipfront.OpenSequence)
    events, loading = sequence.events, sequence.loading
    fastest = [float(run.history.slip_rate_m_per_s.max()) for run in sequence.runs]
    return Cycles(
        events.begin_s.to_numpy(),
        events.friction_before.to_numpy(),
        events.friction_after.to_numpy(),
        np.array(fastest),
        loading.time_s.to_numpy(),
        loading.shear_over_normal.to_numpy(),
    )


def with_state(softness: float, d_c_m: float, threshold: float, end_s: float) -> Cycles:
    """Rate and state, aging law: without inertia below INERTIA_FROM, and by u, ln V and psi above."""
    K = softness * STIFFNESS

    def psi_rate(psi: float, v: float) -> float:
        return B * (V0 / d_c_m * np.exp((F0 - psi) / B) - v / d_c_m)

    def slow_rate(t: float, u: float, psi: float) -> float:
        y = K * (SPEED * t - u) / (N * A)
        return V0 * (np.exp(y - psi / A) - np.exp(-y - psi / A))

    def slow(t: float, y: np.ndarray) -> list[float]:
        v = slow_rate(t, *y)
        return [v, psi_rate(y[1], v)]

    def fast(t: float, y: np.ndarray) -> list[float]:
        u, ln_v, psi = y
        v = np.exp(ln_v)
        mu = A * np.arcsinh(0.5 * np.exp(ln_v - np.log(V0) + psi / A))
        return [v, (K * (SPEED * t - u) - N * mu) / (M * v), psi_rate(psi, v)]

    speeds_up: Callable[..., float] = lambda t, y: np.log(max(slow_rate(t, *y), 1e-99) / INERTIA_FROM)  # noqa: E731
    speeds_up.terminal, speeds_up.direction = True, 1  # type: ignore[attr-defined]
    slows_down: Callable[..., float] = lambda t, y: y[1] - np.log(0.5 * INERTIA_FROM)  # noqa: E731
    slows_down.terminal, slows_down.direction = True, -1  # type: ignore[attr-defined]
    t, u, psi = 0.0, 0.0, F0
    parts = []
    while t < end_s:
        found = solve_ivp(
            slow, (t, end_s), [u, psi], "Radau", rtol=1e-9, atol=[1e-15, 1e-11], events=speeds_up
        )
        rates = [slow_rate(*row) for row in zip(found.t, *found.y, strict=True)]
        parts.append(np.array([found.t, found.y[0], rates]))
        t, (u, psi) = found.t[-1], found.y[:, -1]
        if t >= end_s:
            break
        first = [u, np.log(INERTIA_FROM), psi]
        found = solve_ivp(
            fast, (t, end_s), first, "Radau", rtol=1e-9, atol=[1e-15, 1e-8, 1e-11], events=slows_down
        )
        parts.append(np.array([found.t, found.y[0], np.exp(found.y[1])]))
        t, u, psi = found.t[-1], found.y[0, -1], found.y[2, -1]
    t, u, v = np.concatenate(parts, axis=1)
    return measured(t, K * (SPEED * t - u) / N, v, threshold)


def measured(t: np.ndarray, force: np.ndarray, v: np.ndarray, threshold: float) -> Cycles:
    up = np.flatnonzero((v[:-1] < threshold) & (v[1:] >= threshold))
    down = [k + int(np.argmax(v[k + 1 :] < 0.5 * threshold)) for k in up]
    return Cycles(
        t[up],
        force[up],
        np.array([force[k] for k in down]),
        np.array([v[a : b + 1].max() for a, b in zip(up, down, strict=True)]),
        t,
        force,
    )


def with_healing(softness: float, d_c_m: float) -> Cycles:
    """Linear slip weakening from mu_s, which grows at rest."""
    K = softness * STIFFNESS
    u, rests_s = 0.0, 0.0
    rows: list[tuple[float, float]] = []
    events = []
    for _ in range(EVENTS):

        def strength(t: float, since: float = rests_s) -> float:
            return MU_S + HEALING * np.log1p((t - since) / HEALING_S)

        critical = brentq(lambda t, u=u: K * (SPEED * t - u) - N * strength(t), rests_s, 1e6)
        mu_s = strength(critical)
        begin = (mu_s * (1 + MARGIN) * N / K + u) / SPEED
        rows += [(rests_s, K * (SPEED * rests_s - u) / N), (begin, K * (SPEED * begin - u) / N)]

        def rates(t: float, y: np.ndarray, u: float = u, mu_s: float = mu_s, begin: float = begin) -> list[float]:
            slip, v = y
            mu = mu_s + (MU_K - mu_s) * min(slip / d_c_m, 1)
            return [v, (K * (SPEED * (begin + t) - u - slip) - N * mu) / M]

        stops: Callable[..., float] = lambda t, y: y[1]  # noqa: E731
        stops.terminal, stops.direction = True, -1  # type: ignore[attr-defined]
        found = solve_ivp(rates, (0, 1), [0.0, 0.0], rtol=1e-10, atol=1e-14, events=stops, max_step=1e-5)
        u += found.y[0, -1]
        rests_s = begin + found.t[-1]
        events.append((begin, rows[-1][1], K * (SPEED * rests_s - u) / N, found.y[1].max()))
    columns = np.array(events).T
    return Cycles(*columns, *np.array(rows).T)


D_C_M = 1e-6
SOFT = (0.03, 0.01)  # spring over block
END_S = 1300.0


def of_state(d_c_m: float) -> str:
    return (
        f'law = "rate_and_state_aging"\na = {A}\nb = {B}\nf0 = {F0}\nV0_m_per_s = {V0}\nV_i_m_per_s = {V0}\n'
        f"d_c_m = {d_c_m}"
    )


OF_HEALING = f'law = "slip_weakening_healing"\nmu_s = {MU_S}\nmu_k = {MU_K}\nd_c_m = {D_C_M}'
HEALS = f"healing_per_e_fold = {HEALING}\nhealing_time_s = {HEALING_S}"
THRESHOLD = 0.1 * A * P_PA / (E_PA / (2 * (1 + NU)) / np.sqrt(E_PA / (2 * (1 + NU) * RHO)))


@dataclass
class Compared:
    name: str
    softness: float
    program: Cycles
    equation: Cycles


def critical_d_c_m(softness: float) -> float:
    """Of the spring that is as stiff as friction weakens; the block yields, too."""
    return (B - A) * N / (softness * STIFFNESS / (1 + softness))


def compared(folder: Path) -> list[Compared]:
    found = []
    for softness in SOFT:
        ours = program(case(softness, OF_HEALING, HEALS), folder / f"healing_{softness}")
        found.append(Compared("healing", softness, ours, with_healing(softness, D_C_M)))
        ours = program(case(softness, of_state(D_C_M), ""), folder / f"state_{softness}")
        found.append(
            Compared("rate and state", softness, ours, with_state(softness, D_C_M, THRESHOLD, END_S / (softness / SOFT[-1])))
        )
    return found


def stable(softness: float, folder: Path) -> tuple[Cycles, Cycles, float]:
    """Twice the critical d_c: no events, and the force of steady sliding at the machine's speed."""
    d_c_m = 2 * critical_d_c_m(softness)
    ours = program(case(softness, of_state(d_c_m), f"end_s = {END_S}"), folder / f"stable_{softness}")
    return ours, with_state(softness, d_c_m, THRESHOLD, END_S), F0 + (A - B) * np.log(SPEED / V0)


def differences(c: Compared) -> dict[str, tuple[float, float]]:
    """Program and equation, of the last of the events, which repeat."""
    ours, theirs = c.program, c.equation
    at = EVENTS - 1

    def of(cycles: Cycles) -> list[float]:
        interval = cycles.begin_s[at] - cycles.begin_s[at - 1]
        return [interval, cycles.before[at], cycles.before[at] - cycles.after[at], cycles.fastest[at]]

    names = ("interval (s)", "F_S/F_N where it begins", "its drop", "largest slip rate (m/s)")
    return dict(zip(names, zip(of(ours), of(theirs), strict=True), strict=True))


def table(found: list[Compared], steady: tuple[Cycles, Cycles, float]) -> str:
    text = "| friction | spring over block | quantity | program | equation | off |\n|---|---|---|---|---|---|\n"
    for c in found:
        for name, (ours, theirs) in differences(c).items():
            text += f"| {c.name} | {c.softness} | {name} | {ours:.5g} | {theirs:.5g} | {ours / theirs - 1:+.2%} |\n"
    ours, theirs, expected = steady
    text += (
        f"| rate and state, stable | {SOFT[0]} | events | {len(ours.begin_s)} | {len(theirs.begin_s)} | |\n"
        f"| | | F_S/F_N at the end; steady {expected:.5f} | {ours.force[-1]:.5f} | {theirs.force[-1]:.5f} "
        f"| {ours.force[-1] / theirs.force[-1] - 1:+.3%} |\n"
    )
    return text


def draw(found: list[Compared], picture: Path) -> None:
    with matplotlib.rc_context(style.RC):
        figure = style.new_figure(2 * style.COLUMN_MM, 90)
        for axes, c in zip(figure.subplots(2, 2).T.flat, found, strict=True):
            last = c.program.time_s[-1]
            axes.plot(c.equation.time_s, c.equation.force, color="0.6", lw=2, label="rigid block")
            axes.plot(c.program.time_s, c.program.force, "k-", lw=0.6, label="program")
            axes.set(xlim=(0, last), xlabel="time (s)", ylabel="F_S/F_N")
            axes.set_title(f"{c.name}, spring {c.softness} of the block", fontsize=7)
        figure.axes[0].legend(fontsize=6)
        write_figure(picture, figure)


def renew_page(page: Path, picture: Path, folder: Path | None) -> None:
    checked(picture)
    with TemporaryDirectory() as temporary:
        place = folder or Path(temporary)
        found = compared(place)
        steady = stable(SOFT[0], place)
        draw(found, picture)
        renew(page, lambda text: between_marks(page, text, "table", table(found, steady)))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path, help="verification/stick_slip.md")
    parser.add_argument("picture", type=Path)
    parser.add_argument("--runs", type=Path, help="folder for the sequences")
    options = parser.parse_args()
    return run(__file__, lambda: renew_page(options.page, options.picture, options.runs))


if __name__ == "__main__":
    sys.exit(main())
