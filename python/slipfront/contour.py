# SPDX-License-Identifier: BSD-3-Clause
"""Energy release rate of a front's tip from the fields around it. docs/contour.md derives it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import trapezoid

from slipfront.files import DataError
from slipfront.given import instance, number, whole
from slipfront.opened import OpenRun
from slipfront.read import require

ZONES = 5  # half the default box's width over the length in which friction weakens
SPEED_ZONES = 2  # to each side of the tip, over which its speed is taken
PLATEAU = 0.5  # share of the box, from its middle, in which the weight is 1
OVER = 0.01  # share of the fall of traction, or of slip, that counts as none
GAUSS = tuple((a, b) for a in (-(3**-0.5), 3**-0.5) for b in (-(3**-0.5), 3**-0.5))
BREAKDOWN = (
    "x_m", "breakdown_complete", "residual_coefficient", "peak_t_Pa", "residual_t_Pa", "cohesive_zone_m",
)  # fmt: skip
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)


@dataclass(frozen=True)
class ContourIntegral:
    """G and its parts, whose sum it is, in J/m2."""

    G_J_per_m2: float
    elastic_J_per_m2: float  # strain energy and work of the stress through the box's edge
    kinetic_J_per_m2: float  # kinetic energy through it
    unsteady_J_per_m2: float  # change of the momentum that moves with the box
    damping_J_per_m2: float  # less what the stiffness damping takes inside
    stress_drop_J_per_m2: float  # work of t before the event less the residual traction inside
    breakdown_J_per_m2: float  # what G is to be: work of t less the residual traction, by interface.h5
    time_s: float
    tip_m: float
    v_tip_m_per_s: float  # along x, below 0 to the left
    breakdown_zone_m: float  # behind the tip, in which t is above the residual traction
    half_width_m: float
    height_m: float
    n_snapshots: (
        int  # 3: with those before and after; 2: with one of them, to the first order in their distance
    )


@dataclass(frozen=True)
class Body:
    cells: np.ndarray  # [cells, 4]
    rho_kg_per_m3: float
    stiffness_Pa: np.ndarray  # [2, 2, 2, 2]
    damping_s: float


@dataclass(frozen=True)
class Box:
    """The weight q: 1 around the middle, 0 from the edges on."""

    x_m: float
    half_width_m: float
    height_m: float

    def weight(self, x_m: np.ndarray, y_m: np.ndarray | float) -> np.ndarray:
        def fall(share: np.ndarray | float) -> np.ndarray:
            beyond = np.clip((np.abs(share) - PLATEAU) / (1 - PLATEAU), 0, 1)
            return 0.5 * (1 + np.cos(np.pi * beyond))

        return fall((x_m - self.x_m) / self.half_width_m) * fall(y_m / self.height_m)


def stiffness_of(material: dict[str, Any], plane: str) -> np.ndarray:
    E, nu = material["youngs_modulus_Pa"], material["poissons_ratio"]
    G = E / (2 * (1 + nu))
    M = E / (1 - nu**2) if plane == "stress" else E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    one = np.eye(2)
    return (M - 2 * G) * np.einsum("ij,kl->ijkl", one, one) + G * (
        np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one)
    )


def shapes(corners: np.ndarray, point: tuple[float, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of bilinear cells at a point of the unit square: shape functions [4], their gradients [cells, 4, 2] and
    the area that the point stands for [cells]."""
    side = 1 + CORNERS * point
    slopes = 0.25 * CORNERS * side[:, ::-1]
    jacobian = np.einsum("ak,caj->ckj", slopes, corners)
    gradient = np.einsum("ak,cjk->caj", slopes, np.linalg.inv(jacobian))
    return 0.25 * side[:, 0] * side[:, 1], gradient, np.linalg.det(jacobian)


def at_nodes(cells: np.ndarray, values: np.ndarray, n_nodes: int) -> np.ndarray:
    """Mean over the cells of a node, 0 at nodes of none. [nodes, 2]"""
    sums, count = np.zeros((n_nodes, 2)), np.zeros((n_nodes, 1))
    for nodes in cells.T:
        np.add.at(sums, nodes, values)
        np.add.at(count, nodes, 1)
    return sums / np.maximum(count, 1)


class Fields:
    """The snapshots of a run, as changes since the start, and integrals over them."""

    def __init__(self, run: OpenRun) -> None:
        file = run.folder / "fields.vtkhdf"
        snapshots = run.snapshots
        if snapshots is None:
            raise DataError(f"{file}: there is none; set output.snapshot_times_s")
        self.snapshots: xr.Dataset = snapshots
        self.time_s = snapshots["time_s"].to_numpy()
        self.x_m, self.y_m = snapshots["x_m"].to_numpy(), snapshots["y_m"].to_numpy()
        case = run.case
        self.is_change = case["loading"]["method"] == "prestress"
        require(
            self.is_change or self.time_s[0] == 0,
            file,
            "the state before the event counts, and there is no snapshot at time 0",
        )
        cells = snapshots["cell_nodes"].to_numpy()
        above = self.y_m[cells].mean(axis=1) > 0
        materials = [(cells[above], case["material"])]
        if not above.all():
            materials.append((cells[~above], case["base"]))
        plane = case["material"]["plane"]
        self.bodies = [
            Body(part, m["density_kg_per_m3"], stiffness_of(m, plane), m["stiffness_damping_s"])
            for part, m in materials
        ]
        self.faces = [self.face(body) for body in self.bodies]

    def face(self, body: Body) -> np.ndarray:
        """Nodes of a body on the interface, by x."""
        nodes = np.unique(body.cells)
        nodes = nodes[np.abs(self.y_m[nodes]) < 1e-9 * np.ptp(self.x_m)]
        return nodes[np.argsort(self.x_m[nodes])]

    def motion(self, step: int) -> tuple[np.ndarray, np.ndarray]:
        """Displacement since the start and velocity. [nodes, 2]"""
        at = self.snapshots.isel(time_s=step)
        u = at["displacement_m"].to_numpy().astype(float)
        if not self.is_change:
            u -= self.snapshots["displacement_m"].isel(time_s=0).to_numpy()
        return u, at["velocity_m_per_s"].to_numpy().astype(float)

    def slip(self, step: int) -> tuple[np.ndarray, np.ndarray]:
        """x and slip along the interface."""
        u = self.motion(step)[0][:, 0]
        x = self.x_m[self.faces[0]]
        slip = u[self.faces[0]]
        if len(self.faces) > 1:
            slip = slip - np.interp(x, self.x_m[self.faces[1]], u[self.faces[1]])
        return x, slip

    def holds(self, box: Box) -> bool:
        """Whether the box lies in the bodies."""
        x = self.x_m[self.faces[0]]
        inside = x[0] <= box.x_m - box.half_width_m and box.x_m + box.half_width_m <= x[-1]
        heights = [np.abs(self.y_m[body.cells]).max() for body in self.bodies]
        return bool(inside and box.height_m <= min(heights) * (1 + 1e-9))

    def integrals(self, step: int, box: Box, v_m_per_s: float) -> dict[str, float]:
        """Of a box that moves along x at v, each over both bodies, J/m2; momentum in J s/m3."""
        u, v = self.motion(step)
        q = box.weight(self.x_m, self.y_m)
        sums = dict.fromkeys(("elastic", "kinetic", "damping", "momentum"), 0.0)
        for body in self.bodies:
            cells = body.cells[np.any(q[body.cells] > 0, axis=1)]
            corners = np.stack([self.x_m[cells], self.y_m[cells]], axis=-1)
            # du/dx + v/V, 0 where the motion is steady: in the middle of cells, then averaged at nodes
            _, gradient, _ = shapes(corners, (0.0, 0.0))
            change = np.einsum("cai,ca->ci", u[cells], gradient[:, :, 0]) + v[cells].mean(axis=1) / v_m_per_s
            change = at_nodes(cells, change, len(u))
            for point in GAUSS:
                shape, gradient, area = shapes(corners, point)
                du, dv, dc = (np.einsum("cai,caj->cij", f[cells], gradient) for f in (u, v, change))
                dq = np.einsum("ca,caj->cj", q[cells], gradient)
                here_q, here_v = q[cells] @ shape, np.einsum("cai,a->ci", v[cells], shape)
                stress, damping = (np.einsum("ijkl,ckl->cij", body.stiffness_Pa, f) for f in (du, dv))
                damping *= body.damping_s
                momentum = body.rho_kg_per_m3 * np.sum(here_v * du[:, :, 0], axis=1)
                T = 0.5 * body.rho_kg_per_m3 * np.sum(here_v**2, axis=1)
                W = 0.5 * np.sum(stress * du, axis=(1, 2))
                flux = np.einsum("cij,ci,cj->c", stress + damping, du[:, :, 0], dq)
                taken = np.sum(damping * (dc - dv / v_m_per_s), axis=(1, 2))
                sums["elastic"] += np.sum(area * (flux - W * dq[:, 0]))
                sums["kinetic"] += np.sum(area * (T + v_m_per_s * momentum) * dq[:, 0])
                sums["damping"] += np.sum(area * taken * here_q)
                sums["momentum"] += np.sum(area * momentum * here_q)
        return {name: float(value) for name, value in sums.items()}


def history_at(run: OpenRun, name: str, x_m: np.ndarray, time_s: float, v_m_per_s: float) -> np.ndarray:
    """Of the interface's history, linear in time in the frame of the tip."""
    history = run.history
    times, nodes = history["time_s"].to_numpy(), history["x_m"].to_numpy()
    after = int(np.clip(np.searchsorted(times, time_s), 1, len(times) - 1))
    share = np.clip((time_s - times[after - 1]) / (times[after] - times[after - 1]), 0, 1)
    rows = history[name][after - 1 : after + 1].to_numpy()
    moved = [
        np.interp(x_m + v_m_per_s * (t - time_s), nodes, row)
        for t, row in zip(times[after - 1 : after + 1], rows, strict=True)
    ]
    return (1 - share) * moved[0] + share * moved[1]


@dataclass(frozen=True)
class Tip:
    """A front's tip at a time."""

    x_m: float
    direction: int
    v_m_per_s: float  # along x
    zone_m: float  # in which friction weakens, by fracture.csv
    breakdown: dict[str, np.ndarray]  # columns of fracture.csv at nodes where it is complete, by x


def tip_of(run: OpenRun, front: int, time_s: float) -> Tip:
    fronts = {found.id: found for found in run.front_list}
    require(front in fronts, run.folder / "fronts.csv", f"no front {front}")
    path = fronts[front]
    x_tip = path.tip_m(time_s)
    if x_tip is None:
        raise DataError(
            f"{run.folder}: front {front} has no tip at {time_s:g} s: it runs from {path.onset_s[0]:g} to "
            f"{path.onset_s[-1]:g} s"
        )
    file = run.folder / "fracture.csv"
    table = run.fracture
    require("breakdown_complete" in table, file, "missing: the run is of an earlier version")
    columns = {name: table[name].to_numpy() for name in BREAKDOWN}
    rows = (table["front_id"].to_numpy() == front) & (columns["breakdown_complete"] == 1)
    require(rows.any(), file, f"friction of front {front} has not come down to a residual one anywhere")
    order = np.argsort(columns["x_m"][rows])
    breakdown = {name: values[rows][order] for name, values in columns.items()}
    zones = breakdown["cohesive_zone_m"]
    known = np.isfinite(zones)
    require(known.any(), file, f"front {front} has no cohesive zone")
    zone = float(np.interp(x_tip, breakdown["x_m"][known], zones[known]))
    away = np.abs(path.x_m - x_tip)
    near = np.argsort(away)[: max(4, int(np.sum(away <= SPEED_ZONES * zone)))]
    slowness = float(np.polyfit(path.x_m[near] - x_tip, path.onset_s[near] - time_s, 1)[0])
    require(slowness * path.direction > 0, run.folder / "fronts.csv", f"front {front} has no speed")
    return Tip(x_tip, path.direction, 1 / slowness, zone, breakdown)


def loads_beside_friction(case: dict[str, Any], x_m: np.ndarray) -> tuple[float, float] | None:
    """Where an external traction acts on the interface, which the fields do not tell from friction."""
    event = case["event"]
    if event["kind"] == "nucleation" and case["nucleation"]["form"] in ("overstress", "unloaded"):
        patch = case["nucleation"]
        reach = patch["half_length_m"] + (patch["taper_m"] if patch["profile"] == "tapered" else 0)
        return patch["x_m"] - reach, patch["x_m"] + reach
    if event["kind"] in ("left", "right") and event["trigger_form"] != "weakened":
        zone = event["trigger_zone_m"]
        return (x_m[0], x_m[0] + zone) if event["kind"] == "left" else (x_m[-1] - zone, x_m[-1])
    return None


def cohesion_Pa(run: OpenRun, x_m: np.ndarray) -> np.ndarray:
    if "cohesion_Pa" in run.tractions:
        return np.interp(x_m, run.tractions["x_m"].to_numpy(), run.tractions["cohesion_Pa"].to_numpy())
    return np.full_like(x_m, run.case["friction"].get("cohesion_Pa", 0.0))


def contour_integral(
    run: OpenRun,
    *,
    time_s: float,
    front: int,
    half_width_m: float | None = None,
    height_m: float | None = None,
) -> ContourIntegral:
    """Energy release rate of a front's tip by the fields in a box around it: what flows through the box less
    what friction takes at the residual traction; for slip weakening the fracture energy.

    time_s: of a snapshot. Those before and after it, or one of them, tell the change that is not steady; the
    tip is to run at most half of half_width_m meanwhile.
    front: its id in fronts.csv.
    half_width_m: of the box to each side of the tip, by default five cohesive zones. Friction must come down
    within half of it. height_m: of the box above, and below, the interface; by default half_width_m.

    With tractions found by statics a snapshot at time 0 is needed. Raises DataError where there are no
    snapshots, the front has no tip at the time, or the box does not lie in the bodies or holds more than
    one tip. Derivation: docs/contour.md."""
    instance(run, OpenRun, "run")
    given = number(time_s, "time_s", least=0, finite=True)
    front = whole(front, "front", least=0)
    half_width = None if half_width_m is None else number(half_width_m, "half_width_m", above=0, finite=True)
    fields = Fields(run)
    step = int(np.argmin(np.abs(fields.time_s - given)))
    time = float(fields.time_s[step])
    require(
        abs(time - given) <= run.info["dt_s"],
        run.folder / "fields.vtkhdf",
        f"no snapshot at {given:g} s; the nearest is at {time:g} s",
    )
    tip = tip_of(run, front, time)
    half_width = ZONES * tip.zone_m if half_width is None else half_width
    height = half_width if height_m is None else number(height_m, "height_m", above=0, finite=True)
    box = Box(tip.x_m, half_width, height)
    if not fields.holds(box):
        raise DataError(
            f"{run.folder}: a box of {half_width:g} m to each side of the tip at {tip.x_m:g} m, and "
            f"{height:g} m high, does not lie in the bodies"
        )
    drop, breakdown, zone = works_on_the_interface(run, fields, step, tip, box)
    steady = fields.integrals(step, box, tip.v_m_per_s)
    near = neighbours(fields, step, box, tip.v_m_per_s)
    if len(near) < 2:
        raise DataError(
            f"{run.folder}: no snapshot within {PLATEAU * half_width / abs(tip.v_m_per_s):.2g} s of that at "
            f"{time:g} s; the change of the motion is not known"
        )
    momentum = [
        fields.integrals(k, moved(box, tip.v_m_per_s * (fields.time_s[k] - time)), tip.v_m_per_s)["momentum"]
        for k in near
    ]
    since = fields.time_s[near] - time
    scale = np.abs(since).max()
    rate = float(np.polyfit(since / scale, momentum, len(near) - 1)[-2] / scale)
    d = tip.direction
    parts = {
        "elastic_J_per_m2": d * steady["elastic"],
        "kinetic_J_per_m2": d * steady["kinetic"],
        "unsteady_J_per_m2": d * rate,
        "damping_J_per_m2": d * steady["damping"],
        "stress_drop_J_per_m2": d * drop,
    }
    return ContourIntegral(
        G_J_per_m2=float(sum(parts.values())),
        **parts,
        breakdown_J_per_m2=d * breakdown,
        time_s=time,
        tip_m=tip.x_m,
        v_tip_m_per_s=tip.v_m_per_s,
        breakdown_zone_m=zone,
        half_width_m=half_width,
        height_m=height,
        n_snapshots=len(near),
    )


def moved(box: Box, by_m: float) -> Box:
    return Box(box.x_m + by_m, box.half_width_m, box.height_m)


def neighbours(fields: Fields, step: int, box: Box, v_m_per_s: float) -> list[int]:
    """The snapshot with those next to it that lie near enough for its change in time."""

    def is_near(k: int) -> bool:
        if not 0 <= k < len(fields.time_s):
            return False
        way = v_m_per_s * (fields.time_s[k] - fields.time_s[step])
        return abs(way) <= PLATEAU * box.half_width_m and fields.holds(moved(box, way))

    return [k for k in (step - 1, step, step + 1) if k == step or is_near(k)]


def works_on_the_interface(
    run: OpenRun, fields: Fields, step: int, tip: Tip, box: Box
) -> tuple[float, float, float]:
    """-int q (t before the event - residual t) d(slip)/dx dx, the same of t - residual t, and the length of
    the breakdown zone."""
    folder: Path = run.folder
    case = run.case
    time = float(fields.time_s[step])
    x, slip = fields.slip(step)
    inside = np.abs(x - box.x_m) <= box.half_width_m * (1 + 1e-9)
    x, slip = x[inside], slip[inside]
    behind = tip.direction * (tip.x_m - x)
    require(
        (behind < 0).any() and (behind > 0).any(), folder, "no node in the box: half_width_m is too small"
    )
    loaded = loads_beside_friction(case, run.tractions["x_m"].to_numpy())
    if loaded is not None and loaded[0] < x[-1] and x[0] < loaded[1]:
        raise DataError(f"{folder}: the box reaches into the zone of the trigger's or patch's traction")
    largest = np.abs(slip).max()
    one_tip = np.abs(slip[behind < 0]).max() <= OVER * largest <= np.abs(slip[np.argmax(behind)])
    require(one_tip, folder, "slip ahead of the tip, or none behind it: more than one tip in the box")
    t, p = (history_at(run, name, x, time, tip.v_m_per_s) for name in ("t_Pa", "p_Pa"))
    b = {name: np.interp(x, tip.breakdown["x_m"], values) for name, values in tip.breakdown.items()}
    residual = cohesion_Pa(run, x) + b["residual_coefficient"] * p
    excess = np.abs(t) - residual
    done = behind[(behind > 0) & (excess <= OVER * (b["peak_t_Pa"] - b["residual_t_Pa"]))]
    zone = float(done.min()) if done.size else np.inf
    if zone > PLATEAU * box.half_width_m:
        raise DataError(
            f"{folder}: friction is above the residual one beyond {PLATEAU * box.half_width_m:g} m behind "
            "the tip, half of half_width_m; take a wider box"
        )
    sign = np.sign(slip[np.argmax(np.abs(slip))])
    residual = np.where(behind < zone, sign * residual, t)
    require(p > 0, folder, "the interface opens in the box")
    if case["event"]["kind"] == "spontaneous":  # begins beyond the common state
        before = history_at(run, "t_Pa", x, 0.0, 0.0)
    else:
        before = np.interp(x, run.tractions["x_m"].to_numpy(), run.tractions["t_s_Pa"].to_numpy())
    before = before + case.get("prestress", {}).get("t_rate_Pa_per_s", 0.0) * time

    def work(stress_Pa: np.ndarray) -> float:
        return -float(trapezoid(box.weight(x, 0.0) * stress_Pa, slip))

    return work(before - residual), work(t - residual), zone
