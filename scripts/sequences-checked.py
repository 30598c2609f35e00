# SPDX-License-Identifier: BSD-3-Clause
"""Lengths of precursors and of nucleation in sequences, and an explicit ramp, against what is expected of
them; renews tables and picture of docs/sequences-checked.md."""

from __future__ import annotations

import runpy
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import slipfront
from shared import renew_from_runs, write_figure
from slipfront.figures import style

ROOT = Path(__file__).resolve().parents[1]
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "k", "0.6", "#56b4e9")


def sequence_of(case: Any, changes: dict[str, Any], folder: Path) -> slipfront.OpenSequence:
    if not folder.exists():
        slipfront.run(case, changes, output=folder, progress=False)
    found = slipfront.open(folder)
    assert isinstance(found, slipfront.OpenSequence)
    return found


# Precursors: a block pushed at its side under a dead load.

PUSHED = ROOT / "examples/precursors/case.toml"
MESH_M, D_C_M = (1e-3, 0.5e-3), (2.2e-6, 1.1e-6)
COARSE: dict[str, Any] = {
    "plate.element_size_m": 2e-3,
    "time.interface_substeps": 4,
    "loading.critical_margin": 0.02,
}
LEAST_SLIP_M = 1e-6
SMALL = 0.1  # of the fracture energy, with which a crack crosses what would stop it
DAMPING_S = (0.08e-6, 6.4e-6, 12.8e-6)  # on the coarse mesh


@dataclass
class Precursors:
    """Events that slip more than LEAST_SLIP_M, until all slides. Arrays: [events]"""

    name: str
    sequence: slipfront.OpenSequence
    found_m: np.ndarray  # right end
    predicted_m: np.ndarray
    farthest_m: np.ndarray  # place where the crack's G at rest reaches its fracture energy
    zone_m: np.ndarray  # process zone at rest
    speed: np.ndarray  # over c_S
    force: np.ndarray  # over the normal force
    stopped: float  # longest slip of other events over the nucleation length
    ran: float  # shortest of these

    @property
    def beyond(self) -> np.ndarray:
        return (self.found_m - self.predicted_m) / self.zone_m

    @property
    def beyond_farthest(self) -> np.ndarray:
        return (self.found_m - self.farthest_m) / self.zone_m


def farthest(run: slipfront.OpenRun, at_x_m: float, predicted_m: float) -> float:
    """Last place to the right where G of a crack at rest is its fracture energy, over whatever stops it."""
    friction, tractions = run.case["friction"], run.tractions
    weakening = friction["mu_s"] - friction["mu_k"]
    energy = 0.5 * weakening * friction["d_c_m"] * tractions.p_s_Pa.to_numpy()
    crack = slipfront.predict_fronts(
        run,
        at_x_m=at_x_m,
        fracture_energy_J_per_m2=SMALL * float(np.median(energy)),
        residual_coefficient=friction["mu_k"],
    )
    right = crack.isel(point=(crack.direction == 1).to_numpy())
    x = right.x_m.to_numpy()
    grows = right.G_static_J_per_m2.to_numpy() >= np.interp(x, tractions.x_m.to_numpy(), energy)
    return float(np.fmax.reduce([predicted_m, *x[grows]]))


def precursors(name: str, changes: dict[str, Any], folder: Path) -> Precursors:
    loading = {"loading.normal_stiffness_Pa_per_m": 0.0, "loading.critical_margin": 0.005}
    sequence = sequence_of(PUSHED, loading | changes, folder)
    events = sequence.events
    counted = ((events.max_slip_m > LEAST_SLIP_M) & (events.is_global == 0)).to_numpy()
    over = (events.length_m / events.nucleation_length_m).to_numpy()
    begins, predicted = events.begin_x_m.to_numpy(), events.predicted_to_x_m.to_numpy()
    infos = [sequence.runs[k].info for k in map(int, np.flatnonzero(counted))]
    return Precursors(
        name,
        sequence,
        events.to_x_m.to_numpy()[counted],
        predicted[counted],
        np.array(
            [farthest(sequence.runs[k], begins[k], predicted[k]) for k in map(int, np.flatnonzero(counted))]
        ),
        np.array([i["rupture"]["process_zone_m"] for i in infos]),
        events.median_speed_m_per_s.to_numpy()[counted]
        / np.array([i["wave_speeds"]["c_S_m_per_s"] for i in infos]),
        events.friction_before.to_numpy()[counted],
        over[(events.max_slip_m <= LEAST_SLIP_M).to_numpy()].max(),
        over[counted].min(),
    )


def all_precursors(folder: Path) -> list[Precursors]:
    found = [
        precursors(
            f"{1e3 * h:g} | {1e6 * d_c:g} | 0.08",
            {"plate.element_size_m": h, "friction.d_c_m": d_c},
            folder / f"pushed_{h}_{d_c}",
        )
        for h in MESH_M
        for d_c in D_C_M
    ]
    return found + [
        precursors(
            f"2 | 2.2 | {1e6 * damping:g}",
            COARSE | {"material.stiffness_damping_s": damping},
            folder / f"pushed_damped_{damping}",
        )
        for damping in DAMPING_S
    ]


def number(value: float, form: str) -> str:
    return format(value, form) if np.isfinite(value) else "-"


def precursor_table(found: list[Precursors]) -> str:
    text = (
        "| h (mm) | d_c (um) | damping (us) | process zone (mm) | precursors "
        "| beyond the end predicted, in zones: 1st to 6th | later, median "
        "| beyond the farthest place: 1st to 6th | later, median "
        "| speed over c_S: 1st to 6th | later, median "
        "| slip over the nucleation length: longest that stops, shortest of a precursor |\n"
        + "|---" * 12
        + "|\n"
    )
    for p in found:

        def columns(values: np.ndarray, form: str) -> str:
            first = ", ".join(number(v, form) for v in values[:6])
            return f"{first} | {np.nanmedian(values[6:]):{form}}"

        text += (
            f"| {p.name} | {1e3 * p.zone_m[0]:.1f} | {len(p.found_m)} | {columns(p.beyond, '.1f')} "
            f"| {columns(p.beyond_farthest, '.1f')} | {columns(p.speed, '.2f')} "
            f"| {p.stopped:.2f}, {p.ran:.2f} |\n"
        )
    return text


# Nucleation of rate and state between two equal bodies, where slip leaves the pressure as it is.

E_PA, RHO, P_PA, B = 2.6e9, 1200.0, 1e6, 0.02  # plane stress, Poisson's ratio 0
MU_PA = E_PA / 2  # traction over the slope of slip in a half-space
L_B_M = 0.01
NUCLEATION_D_C_M = L_B_M * B * P_PA / MU_PA
WIDTH_M, HEIGHT_M = 0.3, 0.1
NUCLEATIONS = (  # a/b, mesh (m), speed of the edge over c_L
    (0.2, 2e-3, 1e-14),
    (0.2, 1e-3, 1e-14),
    (0.3, 2e-3, 1e-14),
    (0.5, 2e-3, 1e-14),
    (0.6, 2e-3, 1e-14),
    (0.6, 2e-3, 1e-15),
    (0.7, 2e-3, 1e-14),
    (0.7, 1e-3, 1e-14),
    (0.7, 2e-3, 1e-15),
)
AT_M_PER_S = (1e-8, 1e-6, 1e-4, 1e-3)
SHAPE = 1.0701  # integral of V over its maximum and the half-length, Rubin and Ampuero's zone of fixed length
LEAST, HALF_OF_RATIO = 1.3774, 0.3781


def nucleation_case(ratio: float, h_m: float, speed: float, friction: Path) -> str:
    x = np.linspace(0, WIDTH_M, round(WIDTH_M / h_m) + 1)
    f0 = 0.4 + 0.005 * (1 + np.cos(2 * np.pi * x / WIDTH_M))  # least in the middle, where slip begins
    np.savetxt(friction, np.column_stack([x, f0]), "%.12g", ",", header="x_m,f0", comments="")
    return f"""
title = "nucleation between equal bodies, a/b = {ratio}"
[plate]
width_m = {WIDTH_M}
height_m = {HEIGHT_M}
element_size_m = {h_m}
corner = "none"
[material]
youngs_modulus_Pa = {E_PA}
poissons_ratio = 0.0
density_kg_per_m3 = {RHO}
stiffness_damping_s = 1e-6
[base]
kind = "body"
height_m = {HEIGHT_M}
youngs_modulus_Pa = {E_PA}
poissons_ratio = 0.0
density_kg_per_m3 = {RHO}
[loading]
mean_pressure_Pa = {P_PA}
shear_speed_m_per_s = {speed * np.sqrt(E_PA / RHO)}
edge_margin_m = 0.02
[friction]
law = "rate_and_state_aging"
a = {ratio * B}
b = {B}
d_c_m = {NUCLEATION_D_C_M}
V_i_m_per_s = {1e3 * speed}
file = "{friction.resolve()}"
[event]
kind = "spontaneous"
[time]
end_s = 0.03
[sequence]
max_events = 2
inertia_slip_rate_m_per_s = 0.01
"""


@dataclass
class Nucleation:
    """Slow slip before the first event. Arrays: [rows of the history]"""

    ratio: float  # a/b
    h_m: float
    speed: float  # of the edge over c_L
    sequence: slipfront.OpenSequence
    fastest: np.ndarray  # slip rate, m/s
    by_integral: np.ndarray  # half-length over L_b
    by_peaks: np.ndarray
    asymmetry: float  # of the slip after the first event

    @property
    def theory(self) -> float:
        return LEAST if self.ratio < HALF_OF_RATIO else 1 / (np.pi * (1 - self.ratio) ** 2)

    def at(self, fastest: float, values: np.ndarray) -> float:
        k = int(np.argmax(self.fastest >= fastest))
        return float(values[k])


def nucleation(ratio: float, h_m: float, speed: float, folder: Path) -> Nucleation:
    place = folder / f"nucleation_{ratio}_{h_m}_{speed}"
    friction = folder / f"f0_{h_m}.csv"
    text = "" if place.exists() else nucleation_case(ratio, h_m, speed, friction)
    sequence = sequence_of(text, {}, place)
    slow = sequence.slow[0]
    x, V, t = slow.x_m.to_numpy(), slow.slip_rate_m_per_s.to_numpy(), slow.t_Pa.to_numpy()
    middle = len(x) // 2
    peaks = x[middle + t[:, middle:].argmax(axis=1)] - x[t[:, : middle + 1].argmax(axis=1)]
    shape = SHAPE if ratio < HALF_OF_RATIO else np.pi / 2  # of a crack under uniform stress
    slip = sequence.slip.to_numpy()[0]
    return Nucleation(
        ratio,
        h_m,
        speed,
        sequence,
        V.max(axis=1),
        np.trapezoid(V, x, axis=1) / V.max(axis=1) / shape / L_B_M,
        peaks / 2 / L_B_M,
        float(abs(slip - slip[::-1]).max() / slip.max()),
    )


def nucleation_table(found: list[Nucleation]) -> str:
    text = "| a/b | h (mm) | edge (c_L) | theory | " + " | ".join(f"{v:g} m/s" for v in AT_M_PER_S)
    text += " | by peaks of t, at 0.001 m/s |\n" + "|---" * (5 + len(AT_M_PER_S)) + "|\n"
    for n in found:
        values = " | ".join(f"{n.at(v, n.by_integral):.2f}" for v in AT_M_PER_S)
        text += f"| {n.ratio} | {1e3 * n.h_m:g} | {n.speed:g} | {n.theory:.2f} | {values} "
        text += f"| {n.at(AT_M_PER_S[-1], n.by_peaks):.1f} |\n"
    return text


# An explicit ramp: the paper's plate on a coarse mesh, damped.

MARGINS_M = (0.005, 0.01, 0.02)
RAMPS = {8e-6: (1e-6, 3e-7, 1e-7), 16e-6: (1e-6, 3e-7, 1e-7)}  # speeds over c_L by the damping, s
SPAN_M, ROWS = 400e-6, 4000
LARGE_M2 = 1e-6  # potency from which events are compared
PLATE: dict[str, Any] = {
    "plate.width_m": 0.2,
    "plate.height_m": 0.1,
    "plate.element_size_m": 4e-3,
    "plate.corner": "relief",
    "base.kind": "rigid",
    "loading.tilt_left_m": 0.37e-3,
    "loading.tilt_right_m": 0.037e-3,
    "friction.law": "velocity_weakening",
    "event.kind": "spontaneous",
    "time.interface_substeps": 1,
}


@dataclass
class Loaded:
    """Displacements since the first event begins, over it. Arrays: [events] or [points of the curve]"""

    name: str
    imbalance: float
    begin_m: np.ndarray  # of events above LARGE_M2
    potency_m2: np.ndarray
    shear_m: np.ndarray
    force: np.ndarray


def by_sequence(damping_s: float, margin_m: float, folder: Path) -> Loaded:
    changes = PLATE | {
        "loading.edge_margin_m": margin_m,
        "material.stiffness_damping_s": damping_s,
        "time.end_s": 0.2,
        "sequence.max_events": 16,
    }
    sequence = sequence_of({}, changes, folder / f"plate_{damping_s}_{margin_m}")
    events, loading = sequence.events, sequence.loading
    begin = events.shear_m.to_numpy()
    large = events.potency_m2.to_numpy() > LARGE_M2
    first = begin[large][0]
    return Loaded(
        f"{1e6 * damping_s:g} | sequence, margin {1e3 * margin_m:g} mm",
        sequence.info["imbalance_over_largest_energy"],
        begin[large] - first,
        events.potency_m2.to_numpy()[large],
        loading.shear_m.to_numpy() - first,
        loading.shear_over_normal.to_numpy(),
    )


def by_ramp(damping_s: float, speed: float, folder: Path) -> Loaded:
    c_L = np.sqrt(2.6e9 / (1200 * (1 - 0.37**2)))
    end_s = SPAN_M / (speed * c_L)
    changes = PLATE | {
        "material.stiffness_damping_s": damping_s,
        "loading.shear_speed_m_per_s": speed * c_L,
        "time.end_s": end_s,
        "time.quiet_s": np.inf,
        "output.history_interval_s": end_s / ROWS,
    }
    place = folder / f"ramp_{damping_s}_{speed}"
    if not place.exists():
        slipfront.run({}, changes, output=place, progress=False)
    ramp = slipfront.open(place)
    assert isinstance(ramp, slipfront.OpenRun)
    h = ramp.history
    shear = h.time_s.to_numpy() * speed * c_L
    slip, x = h.slip_m.to_numpy(), h.x_m.to_numpy()
    inside = (x > 0.01) & (x < x[-1] - 0.01)
    potency = slip[:, inside].sum(axis=1) * (x[1] - x[0])
    # A burst is a row or more between which potency grows, apart from others by more than 1 um of shear.
    grows = np.flatnonzero(np.diff(potency) > 1e-3 * LARGE_M2)
    bursts = np.split(grows, np.flatnonzero(np.diff(shear[grows]) > 1e-6) + 1)
    sums = np.array([potency[b[-1] + 1] - potency[b[0]] for b in bursts])
    begins = np.array([shear[b[0]] for b in bursts])
    energies = ramp.energies
    largest = max(float(abs(term - term[0]).max()) for term in energies.data_vars.values())
    return Loaded(
        f"{1e6 * damping_s:g} | ramp, {speed:g} c_L",
        float(abs(energies.imbalance_J_per_m).max()) / largest,
        begins[sums > LARGE_M2] - begins[sums > LARGE_M2][0],
        sums[sums > LARGE_M2],
        shear,
        h.t_Pa.to_numpy().sum(axis=1) / h.p_Pa.to_numpy().sum(axis=1),
    )


def ramp_table(found: list[Loaded]) -> str:
    text = "| damping (us) | by | 2nd event at (um) | its potency (mm2) | 3rd at | potency "
    text += "| 4th at | potency |\n|---|---|---|---|---|---|---|---|\n"
    for p in found:
        cells = [
            f"{1e6 * p.begin_m[k]:.1f} | {1e6 * p.potency_m2[k]:.1f}" if k < len(p.begin_m) else "- | -"
            for k in (1, 2, 3)
        ]
        text += f"| {p.name} | " + " | ".join(cells) + " |\n"
    return text


# What holds of all of them.


def ledger_table(pushed: list[Precursors], slow: list[Nucleation], loaded: list[Loaded], folder: Path) -> str:
    def worst(values: list[float]) -> str:
        return f"{max(values):.0e}"

    block = runpy.run_path(str(ROOT / "scripts/rigid-block.py"), run_name="rigid_block")
    cycles = block["program"](block["case"](0.01, block["D_C_M"], ""), folder / "state_0.01")
    intervals = np.diff(cycles.begin_s)
    imbalance = "imbalance_over_largest_energy"
    return (
        "| what | measured |\n|---|---|\n"
        "| imbalance over the largest term, pushed block "
        f"| {worst([p.sequence.info[imbalance] for p in pushed])} |\n"
        f"| the same, nucleation | {worst([n.sequence.info[imbalance] for n in slow])} |\n"
        f"| the same, plate by sequence and by ramp | {worst([p.imbalance for p in loaded])} |\n"
        "| mirrored slip of the first event between equal bodies, largest difference over the largest slip, "
        f"a/b up to 0.5 | {worst([n.asymmetry for n in slow if n.ratio <= 0.5])} |\n"
        f"| the same, a/b = 0.6 and 0.7 | {worst([n.asymmetry for n in slow if n.ratio > 0.5])} |\n"
        "| last interval of a [rigid block](rigid-block.md) over the one before, less 1 "
        f"| {intervals[-1] / intervals[-2] - 1:.0e} |\n"
    )


def draw(pushed: list[Precursors], slow: list[Nucleation], loaded: list[Loaded], picture: Path) -> None:
    with matplotlib.rc_context(style.RC):
        figure = style.new_figure(2 * style.COLUMN_MM, 120)
        (ends, beyond), (lengths, force) = figure.subplots(2, 2)
        for k, p in enumerate(pushed):
            marker = {"color": COLOURS[k], "ls": "-" if k < 4 else ":", "lw": 0.8}
            name = p.name.replace(" | ", ", ")
            ends.plot(p.force, 1e3 * p.found_m, marker="o", ms=2, label=name, **marker)
            ends.plot(p.force, 1e3 * p.predicted_m, "_", ms=5, color=marker["color"])
            beyond.plot(p.speed, p.beyond, "o", ms=2.5, color=marker["color"])
            beyond.plot(p.speed, p.beyond_farthest, "o", ms=2.5, mfc="none", mew=0.5, color=marker["color"])
        beyond.axhline(2, color="0.6", lw=0.6)
        ends.set(xlabel="F_S/F_N", ylabel="right end (mm), predicted: ticks", title="(a)")
        ends.legend(fontsize=5, title="h (mm), d_c (um), damping (us)", title_fontsize=5)
        beyond.set(xlabel="median speed / c_S", ylabel="beyond predicted, in process zones", title="(b)")
        for k, n in enumerate(n for n in slow if n.h_m == 2e-3 and n.speed == 1e-14):
            late = n.fastest > 1e-10
            lengths.semilogx(
                n.fastest[late], n.by_integral[late], lw=0.8, color=COLOURS[k], label=f"a/b = {n.ratio}"
            )
            lengths.axhline(n.theory, color=COLOURS[k], lw=0.5, ls="--")
        lengths.set(xlabel="largest slip rate (m/s)", ylabel="half-length / L_b", ylim=(0, 4.5), title="(c)")
        lengths.legend(fontsize=5)
        drawn = [p for p in loaded if p.name.startswith("16 ") and "margin 5" not in p.name]
        for k, one in enumerate(drawn):
            label = one.name.split(" | ")[1]
            force.plot(1e6 * one.shear_m, one.force, lw=0.6, color=COLOURS[k], label=label)
        force.set(
            xlabel="displacement (um)", ylabel="F_S/F_N", xlim=(-20, 1e6 * SPAN_M), ylim=(0.3, 1), title="(d)"
        )
        force.legend(fontsize=5)
        write_figure(picture, figure)


def write(place: Path, picture: Path) -> dict[str, str]:
    pushed = all_precursors(place)
    slow = [nucleation(*one, place) for one in NUCLEATIONS]
    loaded = [
        one
        for damping_s, speeds in RAMPS.items()
        for one in (
            *(by_sequence(damping_s, margin_m, place) for margin_m in MARGINS_M),
            *(by_ramp(damping_s, v, place) for v in speeds),
        )
    ]
    draw(pushed, slow, loaded, picture)
    return {
        "precursors": precursor_table(pushed),
        "nucleation": nucleation_table(slow),
        "ramp": ramp_table(loaded),
        "ledger": ledger_table(pushed, slow, loaded, place),
    }


if __name__ == "__main__":
    sys.exit(renew_from_runs(__file__, __doc__, "sequences-checked.md", write))
