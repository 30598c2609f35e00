# SPDX-License-Identifier: BSD-3-Clause
"""Writes a made-up output folder of `reproduce.py`: the right files and shapes, invented contents."""

from __future__ import annotations

import csv
import hashlib
import json
from pathlib import Path

import h5py
import numpy as np
from slipfront.figures.style import RC

# Fewer dots than in print: the tests look at what is drawn, not at its pixels.
RC["savefig.dpi"] = 20

WIDTH_M, HEIGHT_M = 0.2, 0.1
WAVE_SPEEDS = {"c_L_m_per_s": 1584.0, "c_S_m_per_s": 889.0, "c_R_m_per_s": 820.0}
MU_S = 1.3
CONTACT_FROM_M, CONTACT_TO_M, EDGE_MARGIN_M = 0.005, 0.2, 10e-3
E_PA, NU = 2.6e9, 0.37

FRONTS_HEADER = [
    "front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s", "t_s_Pa", "p_s_Pa", "t_d_Pa", "p_d_Pa",
    "t_r_Pa", "p_r_Pa", "U_s_J_per_m3", "U_r_J_per_m3", "speed_kind",
]  # fmt: skip


ENERGY_HEADER = [
    "time_s", "strain_J_per_m", "kinetic_J_per_m", "machine_J_per_m", "top_work_J_per_m",
    "trigger_work_J_per_m", "prestress_work_J_per_m", "friction_work_J_per_m", "contact_work_J_per_m",
    "damping_work_J_per_m", "boundary_work_J_per_m", "coupling_work_J_per_m", "imbalance_J_per_m",
]  # fmt: skip


def energy_rows(n: int = 6) -> list[list[float]]:
    """A plate that starts with 380 J/m, loses 90 to friction and 10 to damping; no trigger."""
    rows = []
    for k in range(n):
        share = k / (n - 1)
        strain, kinetic = 380 - 101 * share, 1e-5 + 2 * share
        friction, damping, top, coupling, landing = (a * share for a in (-90.0, -10.0, 0.8, 0.2, -1e-4))
        imbalance = 5e-10 if k > 0 else 0.0
        works = [top, 0, 0, friction, landing, damping, 0, coupling]
        rows.append([250e-6 * share, strain, kinetic, 0, *works, imbalance])
    return rows


def static_state(x_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """t_s, p_s with t_s / p_s largest, 1.2987, at x = 144 mm; no contact at the left edge node."""
    x_mm = 1e3 * x_m
    known_x = [0, 20, 60, 100, 120, 144, 170, 190, 200]
    known_ratio = [0.30, 0.48, 0.68, 0.98, 1.16, 1.2987, 1.01, 0.44, 0.30]
    fine = np.arange(-30.0, 231.0)
    rough = np.interp(fine, known_x, known_ratio)
    width = 0.01 if len(x_m) < 100 else 6.0
    kernel = np.exp(-0.5 * ((np.arange(-15, 16)) / width) ** 2)
    ratio = np.interp(x_mm, fine, np.convolve(rough, kernel / kernel.sum(), "same"))
    p = 5.6e6 * (1.4 - 4 * x_m) * np.where(x_m > 0, 1, 0)
    return ratio * p, p


def speed_m_per_s(x_m: np.ndarray, origin_m: float, direction: int) -> np.ndarray:
    t_s, p_s = static_state(x_m)
    r = np.divide(t_s, p_s, out=np.zeros_like(p_s), where=p_s > 0)
    run = np.abs(x_m - origin_m)
    lag = 1 - 0.45 * np.exp(-run / 0.05) if origin_m < 0.1 or origin_m > 0.16 else 1.0
    wiggle = 1 + 0.01 * np.sin(2 * np.pi * run / 0.004)
    of_ratio = 0.5 + 0.75 * (r / 1.3) ** 4
    return WAVE_SPEEDS["c_L_m_per_s"] * of_ratio * (1.2 if direction < 0 else 0.85) * lag * wiggle


def make_front(
    front_id: int, x_m: np.ndarray, direction: int, origin_m: float, end_m: float, start_s: float
) -> list:
    """Rows of fronts.csv for a front from origin to end."""
    low, high = min(origin_m, end_m) - 1e-9, max(origin_m, end_m) + 1e-9
    path = x_m[(x_m >= low) & (x_m <= high)][::direction]
    v = speed_m_per_s(path, origin_m, direction)
    onset = start_s + np.concatenate([[0], np.cumsum(np.abs(np.diff(path)) * 0.5 * (1 / v[1:] + 1 / v[:-1]))])
    t_s, p_s = static_state(path)
    ratio_s = np.divide(t_s, p_s, out=np.zeros_like(p_s), where=p_s > 0)
    p_d = 0.9 * p_s
    t_d = p_d * np.minimum(1.28, 0.25 + 0.8 * ratio_s * (0.9 if direction > 0 else 1.0))
    p_r = 0.95 * p_s
    u_s = (2 * (1 + NU) * t_d**2 + p_d**2) / (2 * E_PA)
    u_r = (2 * (1 + NU) * (MU_S * p_r) ** 2 + p_r**2) / (2 * E_PA)
    rows = []
    near = 2.5 * (x_m[1] - x_m[0]) if len(x_m) < 100 else 10e-3
    for k in range(len(path)):
        undefined = abs(path[k] - origin_m) < near or p_s[k] <= 0
        speed = "" if k in (0, len(path) - 1) else v[k]
        known = [t_d[k], p_d[k], MU_S * p_r[k], p_r[k], u_s[k], u_r[k]]
        dynamic = [""] * len(known) if undefined else known
        kind = "path_end" if speed == "" else "front"
        rows.append([front_id, path[k], onset[k], direction, speed, t_s[k], p_s[k], *dynamic, kind])
    return rows


def write_csv(file: Path, header: list[str], rows: list) -> None:
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(rows)


def case_text(kind: str, mu_k: float, columns: int) -> str:
    return f"""title = "synthetic"
[plate]
width_m = {WIDTH_M}
height_m = {HEIGHT_M}
element_size_m = {WIDTH_M / columns}
corner = "relief"
[material]
youngs_modulus_Pa = {E_PA}
poissons_ratio = {NU}
[loading]
tilt_left_m = 0.37e-3
tilt_right_m = 0.037e-3
edge_margin_m = 10e-3
[friction]
law = "velocity_weakening"
mu_s = {MU_S}
mu_k = {mu_k}
alpha_m2_per_s2 = 0.1
[event]
kind = "{kind}"
trigger_zone_m = 10e-3
[fronts]
trigger_margin_m = 10e-3
"""


def write_fields(file: Path, columns: int, rows: int, times: np.ndarray, fronts: list) -> None:
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    x, y = (WIDTH_M / columns * i).ravel(), (HEIGHT_M / rows * j).ravel()
    edge = np.minimum(x, WIDTH_M - x)
    rise = 0.5e-3 * np.clip(1 - edge / 5e-3, 0, None) ** 2 * np.clip(1 - y / 10e-3, 0, None)
    n = len(x)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    cells = np.stack([corner, corner + 1, corner + columns + 2, corner + columns + 1], axis=1)
    velocity = np.zeros((len(times), n, 3))
    for step, time in enumerate(times):
        for front in fronts:
            onset = np.array([float(row[2]) for row in front])
            path = np.array([float(row[1]) for row in front])
            live = onset <= time
            if not live.any():
                continue
            origin, tip = path[0], np.interp(time, onset, path)
            run = np.hypot(x - origin, y) / (WAVE_SPEEDS["c_L_m_per_s"] * max(time - onset[0], 1e-7))
            near_tip = np.exp(-((x - tip) ** 2 + y**2) / 2e-5) * 1.2
            behind = 0.9 * np.exp(-y / 0.02) * (np.abs(x - origin) < np.abs(tip - origin))
            ring = 0.7 * np.exp(-(((run - 1) / 0.06) ** 2)) + 0.4 * np.exp(-(((run - 0.56) / 0.08) ** 2))
            way = (x - origin) * front[0][3] >= 0
            velocity[step, :, 0] += np.where(way, near_tip + behind + ring, 0)
    with h5py.File(file, "w") as hdf5:
        g = hdf5.create_group("VTKHDF")
        g.attrs["Version"] = np.array([2, 0])
        g.attrs["Type"] = np.bytes_("UnstructuredGrid")
        g["NumberOfPoints"], g["NumberOfCells"] = np.array([n]), np.array([len(cells)])
        g["NumberOfConnectivityIds"] = np.array([4 * len(cells)])
        g["Points"] = np.stack([x, y + rise, np.zeros(n)], axis=1)
        g["Connectivity"], g["Offsets"] = cells.ravel(), 4 * np.arange(len(cells) + 1)
        g["Types"] = np.full(len(cells), 9, dtype=np.uint8)
        g["PointData/velocity_m_per_s"] = velocity.reshape(-1, 3)
        g["PointData/displacement_m"] = 0 * velocity.reshape(-1, 3)
        steps = g.create_group("Steps")
        steps.attrs["NSteps"] = len(times)
        steps["Values"] = times
        for name in ("velocity_m_per_s", "displacement_m"):
            steps[f"PointDataOffsets/{name}"] = n * np.arange(len(times))


def told_of(front: list) -> dict:
    """What run.json tells of a front."""
    (front_id, x_m, start_s, direction), (_, end_m, end_s) = front[0][:4], front[-1][:3]
    end = "contact_end" if abs(end_m - 0.1) > 0.08 else "meets_front"
    told = {"id": front_id, "direction": direction, "start_x_m": x_m, "start_s": start_s}
    return told | {"end_x_m": end_m, "end_s": end_s, "end": end, "mode": "crack"}


def write_run(
    folder: Path, kind: str, mu_k: float, columns: int, rows: int, n_times: int, snapshots: int
) -> None:
    folder.mkdir(parents=True)
    x_m = np.linspace(0, WIDTH_M, columns + 1)
    t_s, p_s = static_state(x_m)
    write_csv(folder / "static.csv", ["x_m", "t_s_Pa", "p_s_Pa"], list(zip(x_m, t_s, p_s, strict=True)))
    (folder / "case.resolved.toml").write_text(case_text(kind, mu_k, columns))

    peak = x_m[np.argmin(np.abs(x_m - 0.144))]
    if kind == "left":
        fronts = [make_front(1, x_m, 1, 0.010, 0.190, 4e-6)]
    elif kind == "right":
        fronts = [make_front(1, x_m, -1, 0.190, 0.010, 4e-6)]
    else:
        against_end = 0.010 if mu_k < 0.9 else 0.110
        fronts = [make_front(1, x_m, -1, peak, against_end, 2e-6), make_front(2, x_m, 1, peak, 0.2, 2e-6)]
        # Short fronts of their own: one in the table but not in the drawings, one drawn as a secondary front.
        fronts.append(make_front(3, x_m, -1, x_m[1] + 1e-12, 0.0, 0.0))
        if mu_k < 0.9:
            fronts.append(make_front(4, x_m, 1, 0.030, 0.045, 120e-6))
    write_csv(folder / "fronts.csv", FRONTS_HEADER, [row for front in fronts for row in front])
    info = {
        "version": "0.1.0",
        "commit": "abc1234",
        "wave_speeds": WAVE_SPEEDS,
        "mesh": {"columns": columns, "rows": rows},
        "statics": {
            "inside_from_m": CONTACT_FROM_M + EDGE_MARGIN_M,
            "inside_to_m": CONTACT_TO_M - EDGE_MARGIN_M,
        },
        "fronts": [told_of(front) for front in fronts],
    }
    (folder / "run.json").write_text(json.dumps(info))
    write_csv(folder / "energy.csv", ENERGY_HEADER, energy_rows())

    time_s = np.linspace(0, 250e-6, n_times)
    rate = np.zeros((n_times, columns + 1))
    for front in fronts:
        path, onset = (np.array([float(row[c]) for row in front]) for c in (1, 2))
        order = np.argsort(path)
        first = np.interp(x_m, path[order], onset[order], left=np.inf, right=np.inf)
        since = time_s[:, None] - first[None, :]
        with np.errstate(over="ignore", invalid="ignore"):
            rate += np.where(since >= 0, 0.4 + 3 * np.exp(-since / 8e-6), 0)
    with h5py.File(folder / "interface.h5", "w") as hdf5:
        for name, data, unit in (
            ("time_s", time_s, "s"),
            ("x_m", x_m, "m"),
            ("slip_m", np.zeros_like(rate), "m"),
            ("slip_rate_m_per_s", rate, "m/s"),
            ("t_Pa", np.zeros_like(rate), "Pa"),
            ("p_Pa", np.where(x_m < CONTACT_FROM_M, 0, 5e6) + 0 * rate, "Pa"),
        ):
            hdf5[name] = data
            hdf5[name].attrs["unit"] = unit
    write_fields(folder / "fields.vtkhdf", columns, rows, np.linspace(5e-6, 245e-6, snapshots), fronts)


FIT = {"a": (0.5, 0.45, 0.55), "b": (1.7, 1.5, 1.9), "c": (2.0, 1.8, 2.2)}


def study_front(direction: int, start_m: float, largest: float) -> dict:
    place = {"direction": direction, "start_x_m": start_m, "end_x_m": start_m + 0.04 * direction}
    speeds = {"mean_v_over_c_L": 0.6 * largest, "max_v_over_c_L": largest, "x_of_max_m": start_m}
    return place | speeds | {"end": "arrest", "mode": "crack"}


def study_point(value: str, number: float | None, change: float | None, events: dict[str, list]) -> dict:
    return {
        "value": value,
        "number": number,
        "events": [
            {"event": name, "fronts": fronts, "speed_change": {"median": change, "n_points": 9}}
            for name, fronts in events.items()
        ],
        "fit": {"rms_over_c_L": 0.11, "n_points": 9} if change is not None else None,
        "share_in_paper_band": 0.5,
        "spread": {"t_s_over_p_s": 0.31, "t_d_over_p_d": 0.2, "energy": None},
    }


def studies() -> list[dict]:
    """A study by numbers and one by words."""

    def events(largest: float, left_start_m: float = 0.010) -> dict[str, list]:
        short = study_front(-1, 0.1, 9.9) | {"end_x_m": 0.09}  # beside the longest in its direction
        return {
            "left": [study_front(1, left_start_m, 0.8 * largest)],
            "spontaneous": [study_front(-1, 0.145, largest), study_front(1, 0.145, 0.9 * largest), short],
            "right": [study_front(-1, 0.190, 1.2 * largest)],
        }

    elsewhere = {"left": [study_front(1, 0.14, 7.5)], "spontaneous": []}
    friction = [
        study_point("0.4", 0.4, 0.09, events(2.0)),
        study_point("0.6", 0.6, 0.0, events(1.5)),
        study_point("1.2", 1.2, None, elsewhere),
    ]
    mesh = [study_point("0.001", 0.001, -0.02, events(1.4))]
    corner = [
        study_point("relief", None, 0.0, events(1.5)),
        study_point("fillet_2mm", 0.002, 0.01, events(1.6)),
    ]
    return [
        {"name": "mu_k", "parameter": "friction.mu_k", "why": "kind of slip", "points": friction},
        {"name": "element_size", "parameter": "plate.element_size_m", "why": "mesh", "points": mesh},
        {"name": "corner", "parameter": "plate.corner", "why": "rounding", "points": corner},
    ]


def write_output(
    folder: Path, columns: int = 40, rows: int = 20, n_times: int = 26, snapshots: int = 25
) -> Path:
    """The whole output folder; returns it."""
    for name, kind, mu_k in (
        ("left", "left", 0.6),
        ("spontaneous", "spontaneous", 0.6),
        ("right", "right", 0.6),
        ("spontaneous_mu_k_1.0", "spontaneous", 1.0),
    ):
        write_run(folder / name, kind, mu_k, columns, rows, n_times, snapshots)
    names = ("id", "claim", "paper", "measured", "holds", "how")
    rows = [
        ("C1", "c_L < 1600 m/s & more", "1584, 890", "1584.2, 888.9", True, "each within 1 m/s"),
        ("C1+", "claim one, other test", "1584, 890", "1584.2", True, "otherwise"),
        ("C2", "claim two", 0.6, 0.712345, False, "ratio"),
        ("E1", "claim three", "agrees", None, None, "not tested"),
    ]
    scorecard = [dict(zip(names, row, strict=True)) for row in rows]
    (folder / "scorecard.json").write_text(json.dumps(scorecard))
    analysis = {
        "fit": {
            **{name: dict(zip(("value", "low", "high"), v, strict=True)) for name, v in FIT.items()},
            "rms_over_c_L": 0.081,
            "n_points": 512,
        },
        "paper_fit": {"a": 0.76, "a_band": 0.07, "b": 1.80, "c": 3.05},
        "share_in_paper_band": 0.61,
        "spread": {"t_s_over_p_s": 0.5, "t_d_over_p_d": 0.3, "energy": 0.1},
        "studies": studies(),
    }
    (folder / "analysis.json").write_text(json.dumps(analysis))
    timings = [{"part": "events", "wall_s": 1.25}, {"part": "studies", "wall_s": 20.5}]
    (folder / "timings.json").write_text(json.dumps(timings))
    return folder


# The layout with checksums and unfinished runs

# Of a file of rows that is not finished: its length, as far as a whole block.
OPEN_HEAD = (4096).to_bytes(8, "little").ljust(4096, b"\0")


def write_checksums(folder: Path, leave_out: tuple[str, ...] = ()) -> Path:
    """checksums.sha256 over the files of a folder, as sha256sum writes it."""
    names = sorted(
        f.name for f in folder.iterdir() if f.is_file() and f.name not in ("checksums.sha256", *leave_out)
    )
    sums = [(hashlib.sha256((folder / name).read_bytes()).hexdigest(), name) for name in names]
    file = folder / "checksums.sha256"
    file.write_text("".join(f"{digest}  {name}\n" for digest, name in sums))
    return file


def seal(output: Path) -> Path:
    """A reproduction's folder as the program finishes it: a list beside every set of files."""
    for run in output.iterdir():
        if (run / "run.json").is_file():
            set_status(run, "complete", "")
            write_checksums(run)
    write_checksums(output)
    return output


def set_status(folder: Path, status: str, reason: str) -> None:
    info = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps(info | {"status": status, "reason": reason}))


def reopen_history(folder: Path) -> None:
    """interface.h5 as it is while the run goes."""
    with h5py.File(folder / "interface.h5") as hdf5:
        states = json.loads((folder / "run.json").read_text()).get("law_states", [])
        columns = [hdf5[name][()] for name in ("slip_m", "slip_rate_m_per_s", "t_Pa", "p_Pa", *states)]
        rows = np.concatenate([hdf5["time_s"][()][:, None], *columns], axis=1)
    (folder / "interface.h5").write_bytes(OPEN_HEAD + rows.astype("<f8").tobytes())


def interrupt(run: Path, status: str, reason: str = "") -> Path:
    """Moves a run's results into its unfinished/, as a run leaves them that did not come to its end."""
    unfinished = run / "unfinished"
    unfinished.mkdir()
    for file in [f for f in run.iterdir() if f.is_file()]:
        file.rename(unfinished / file.name)
    set_status(unfinished, status, reason)
    if status in ("running", "failed"):
        reopen_history(unfinished)
        (unfinished / "fields.vtkhdf").write_bytes(OPEN_HEAD)
    return unfinished
