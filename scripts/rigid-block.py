# SPDX-License-Identifier: BSD-3-Clause
"""A block behind a soft spring, loaded on, against the equation of a rigid one;
renews table and figure of docs/rigid-block.md."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import slipfront
from scipy.integrate import solve_ivp
from shared import renew_from_runs, write_figure
from slipfront.figures import style

# Low friction on a small block, which nothing shears as it is pressed: it slides as one.
E_PA, NU, RHO = 2.6e9, 0.0, 1200.0
WIDTH_M, HEIGHT_M, P_PA = 0.02, 0.01, 1e6
SPEED = 1e-9 * np.sqrt(E_PA / (RHO * (1 - NU**2)))  # of the machine, m/s
N, M = P_PA * WIDTH_M, RHO * WIDTH_M * HEIGHT_M  # per unit thickness
STIFFNESS = E_PA / (2 * (1 + NU)) * WIDTH_M / HEIGHT_M  # of the block across, Pa
A, B, V0 = 0.0010, 0.0015, 1e-6  # of rate and state
F0 = 0.06
INERTIA_FROM = 1e-6  # of the equation: slip rate, m/s
EVENTS = 6


@dataclass
class Cycles:
    """Events in their order. Arrays: [events]"""

    begin_s: np.ndarray
    lasts_s: np.ndarray  # of slip that is as fast as a tip counts
    before: np.ndarray  # force over normal force where it begins
    after: np.ndarray  # at rest
    fastest: np.ndarray  # slip rate, m/s
    time_s: np.ndarray  # of the curve of the force
    force: np.ndarray  # over the normal force


@dataclass
class States:
    """Effects and slips of the states of an aging law."""

    b: np.ndarray
    d_c_m: np.ndarray

    def friction(self) -> str:
        if len(self.b) == 1:
            return f'law = "rate_and_state_aging"\nb = {self.b[0]}\nd_c_m = {self.d_c_m[0]}'
        b, d_c_m = self.b.tolist(), self.d_c_m.tolist()
        return 'law = "rate_and_state_aging_two"\n' + "\n".join(
            f"b{k} = {b[k - 1]}\nd_c{k}_m = {d_c_m[k - 1]}" for k in (1, 2)
        )


def one(d_c_m: float) -> States:
    return States(np.array([B]), np.array([d_c_m]))


def case(softness: float, states: States, sequence: str, heavy: float = 0) -> str:
    """heavy: mass of the machine over that of the block."""
    return f"""
title = "block behind a spring"
[plate]
width_m = {WIDTH_M}
height_m = {HEIGHT_M}
element_size_m = 1e-3
corner = "none"
[base]
kind = "rigid"
[material]
youngs_modulus_Pa = {E_PA}
poissons_ratio = {NU}
density_kg_per_m3 = {RHO}
stiffness_damping_s = 1e-7
[loading]
mean_pressure_Pa = {P_PA}
shear_stiffness_Pa_per_m = {softness * STIFFNESS / WIDTH_M}
mass_kg_per_m2 = {heavy * M / WIDTH_M}
shear_speed_m_per_s = {SPEED}
edge_margin_m = {0.1 * WIDTH_M}
[friction]
{states.friction()}
a = {A}
f0 = {F0}
V0_m_per_s = {V0}
V_i_m_per_s = {V0}
[event]
kind = "spontaneous"
[time]
end_s = 50e-3
quiet_s = {max(0.1e-3, 2 * np.pi * np.sqrt(heavy * M / STIFFNESS))}
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
        events.slip_s.to_numpy(),
        events.friction_before.to_numpy(),
        events.friction_after.to_numpy(),
        np.array(fastest),
        loading.time_s.to_numpy(),
        loading.shear_over_normal.to_numpy(),
    )


def equation(softness: float, states: States, end_s: float, heavy: float = 0) -> Cycles:
    """Rate and state, aging law: without inertia below INERTIA_FROM, and by u, ln V and states above, each
    b ln(V0 theta/d_c). A machine with a mass is an equation more: the block couples it to the slip, and half
    of the block's mass is on either side."""
    K = softness * STIFFNESS
    if heavy > 0:
        K /= 1 + softness  # of both in series, without inertia
    n = len(states.b)

    def state_rates(state: np.ndarray, v: float) -> np.ndarray:
        return states.b / states.d_c_m * (V0 * np.exp(-state / states.b) - v)

    def slow_rate(t: float, u: float, *state: float) -> float:
        y, psi = K * (SPEED * t - u) / (N * A), F0 + sum(state)
        return V0 * (np.exp(y - psi / A) - np.exp(-y - psi / A))

    def slow(t: float, y: np.ndarray) -> list[float]:
        v = slow_rate(t, *y)
        return [v, *state_rates(y[1:], v)]

    def fast(t: float, y: np.ndarray) -> list[float]:
        u, ln_v, *state = y
        v = np.exp(ln_v)
        mu = A * np.arcsinh(0.5 * np.exp(ln_v - np.log(V0) + (F0 + sum(state)) / A))
        return [v, (K * (SPEED * t - u) - N * mu) / (M * v), *state_rates(np.array(state), v)]

    def coupled(t: float, y: np.ndarray) -> list[float]:
        u, ln_v, top, v_top, *state = y
        v, of_block = np.exp(ln_v), STIFFNESS * (top - u)
        mu = A * np.arcsinh(0.5 * np.exp(ln_v - np.log(V0) + (F0 + sum(state)) / A))
        pull = softness * STIFFNESS * (SPEED * t - top) - of_block
        return [v, (of_block - N * mu) / (0.5 * M * v), v_top, pull / ((heavy + 0.5) * M),
                *state_rates(np.array(state), v)]  # fmt: skip

    speeds_up: Callable[..., float] = lambda t, y: np.log(max(slow_rate(t, *y), 1e-99) / INERTIA_FROM)  # noqa: E731
    speeds_up.terminal, speeds_up.direction = True, 1  # type: ignore[attr-defined]
    slows_down: Callable[..., float] = lambda t, y: y[1] - np.log(0.5 * INERTIA_FROM)  # noqa: E731
    slows_down.terminal, slows_down.direction = True, -1  # type: ignore[attr-defined]
    t, u, state = 0.0, 0.0, np.zeros(n)
    parts = []
    while t < end_s:
        found = solve_ivp(
            slow, (t, end_s), [u, *state], "Radau", rtol=1e-9, atol=[1e-15] + n * [1e-11], events=speeds_up
        )
        rates = [slow_rate(*row) for row in zip(found.t, *found.y, strict=True)]
        parts.append(np.array([found.t, found.y[0], rates]))
        t, (u, *state) = found.t[-1], found.y[:, -1]
        if t >= end_s:
            break
        first, atol = [u, np.log(INERTIA_FROM)], [1e-15, 1e-8]
        if heavy > 0:
            top = u + K * (SPEED * t - u) / STIFFNESS
            first, atol = [*first, top, INERTIA_FROM], [*atol, 1e-15, 1e-12]
        found = solve_ivp(
            coupled if heavy > 0 else fast,
            (t, end_s),
            [*first, *state],
            "Radau",
            rtol=1e-9,
            atol=atol + n * [1e-11],
            events=slows_down,
        )
        parts.append(np.array([found.t, found.y[0], np.exp(found.y[1])]))
        t, u, state = found.t[-1], found.y[0, -1], found.y[len(first) :, -1]
    t, u, v = np.concatenate(parts, axis=1)
    return measured(t, K * (SPEED * t - u) / N, v)


def measured(t: np.ndarray, force: np.ndarray, v: np.ndarray) -> Cycles:
    up = np.flatnonzero((v[:-1] < THRESHOLD) & (v[1:] >= THRESHOLD))
    down = [k + int(np.argmax(v[k + 1 :] < 0.5 * THRESHOLD)) for k in up]
    return Cycles(
        t[up],
        np.array([lasts_s(t[a : b + 1], v[a : b + 1]) for a, b in zip(up, down, strict=True)]),
        force[up],
        np.array([force[k] for k in down]),
        np.array([v[a : b + 1].max() for a, b in zip(up, down, strict=True)]),
        t,
        force,
    )


def lasts_s(t: np.ndarray, v: np.ndarray) -> float:
    """Between the first and the last time at which slip is as fast as a tip counts, as `slip_s` has it."""
    fast = np.flatnonzero(v >= TIP)
    if not fast.size:
        return np.nan
    first, last = (
        float(np.interp(np.log(TIP), *ends))
        for ends in (
            (np.log(v[fast[0] - 1 : fast[0] + 1]), t[fast[0] - 1 : fast[0] + 1]),
            (np.log(v[fast[-1] : fast[-1] + 2][::-1]), t[fast[-1] : fast[-1] + 2][::-1]),
        )
    )
    return last - first


D_C_M = 0.7e-7
TWO = States(np.array([B - A, A]), np.array([2 * D_C_M, 0.5 * D_C_M]))
SOFT = (0.03, 0.01, 0.003)  # spring over block
HEAVY = 10  # machine over block
END_S = 130.0


THRESHOLD = 0.1 * A * P_PA / (E_PA / (2 * (1 + NU)) / np.sqrt(E_PA / (2 * (1 + NU) * RHO)))
TIP = 10 * THRESHOLD


@dataclass
class Compared:
    name: str
    program: Cycles
    equation: Cycles


def critical_d_c_m(softness: float) -> float:
    """Of the spring that is as stiff as friction weakens; the block yields, too."""
    return (B - A) * N / (softness * STIFFNESS / (1 + softness))


def compared(folder: Path) -> list[Compared]:
    found = []
    for softness in SOFT:
        ours = program(case(softness, one(D_C_M), ""), folder / f"state_{softness}")
        found.append(
            Compared(f"{softness}", ours, equation(softness, one(D_C_M), END_S * SOFT[1] / softness))
        )
    ours = program(case(SOFT[1], one(D_C_M), "", HEAVY), folder / "heavy")
    theirs = equation(SOFT[1], one(D_C_M), END_S, HEAVY)
    found.append(Compared(f"{SOFT[1]}, machine {HEAVY} times as heavy as the block", ours, theirs))
    ours = program(case(SOFT[1], TWO, ""), folder / "two")
    found.append(Compared(f"{SOFT[1]}, two states", ours, equation(SOFT[1], TWO, END_S)))
    return found


def stable(softness: float, folder: Path) -> tuple[Cycles, Cycles, float]:
    """Twice the critical d_c: no events, and the force of steady sliding at the machine's speed."""
    d_c_m = 2 * critical_d_c_m(softness)
    states = one(d_c_m)
    ours = program(case(softness, states, f"end_s = {END_S}"), folder / f"stable_{softness}")
    return ours, equation(softness, states, END_S), F0 + (A - B) * np.log(SPEED / V0)


def differences(c: Compared) -> dict[str, tuple[float, float]]:
    """Program and equation, of the last of the events, which repeat."""
    ours, theirs = c.program, c.equation
    at = EVENTS - 1

    def of(cycles: Cycles) -> list[float]:
        interval = cycles.begin_s[at] - cycles.begin_s[at - 1]
        drop = cycles.before[at] - cycles.after[at]
        return [interval, cycles.before[at], drop, cycles.fastest[at], cycles.lasts_s[at]]

    names = (
        "interval (s)", "F_S/F_N where it begins", "its drop", "largest slip rate (m/s)", "slip lasts (s)",
    )  # fmt: skip
    return dict(zip(names, zip(of(ours), of(theirs), strict=True), strict=True))


def table(found: list[Compared], steady: tuple[Cycles, Cycles, float]) -> str:
    text = "| spring over block | quantity | program | equation | off |\n|---|---|---|---|---|\n"
    for c in found:
        for name, (value, solution) in differences(c).items():
            text += f"| {c.name} | {name} | {value:.5g} | {solution:.5g} "
            text += f"| {value / solution - 1:+.2%} |\n"
    ours, theirs, expected = steady
    text += (
        f"| {SOFT[0]}, stable | events | {len(ours.begin_s)} | {len(theirs.begin_s)} | |\n"
        f"| | F_S/F_N at the end; steady {expected:.5f} | {ours.force[-1]:.5f} | {theirs.force[-1]:.5f} "
        f"| {ours.force[-1] / theirs.force[-1] - 1:+.3%} |\n"
    )
    return text


def draw(found: list[Compared], picture: Path) -> None:
    with matplotlib.rc_context(style.RC):
        figure = style.new_figure(2 * style.COLUMN_MM, 55)
        for axes, c in zip(figure.subplots(1, 3).flat, found[:3], strict=True):
            last = c.program.time_s[-1]
            axes.plot(c.equation.time_s, c.equation.force, color="0.6", lw=2, label="rigid block")
            axes.plot(c.program.time_s, c.program.force, "k-", lw=0.6, label="program")
            axes.set(xlim=(0, last), xlabel="time (s)", ylabel="F_S/F_N")
            axes.set_title(f"spring {c.name} of the block", fontsize=7)
        figure.axes[0].legend(fontsize=6)
        write_figure(picture, figure)


def write(folder: Path, picture: Path) -> dict[str, str]:
    found, steady = compared(folder), stable(SOFT[0], folder)
    draw(found, picture)
    return {"table": table(found, steady)}


if __name__ == "__main__":
    sys.exit(renew_from_runs(__file__, __doc__, "rigid-block.md", write))
