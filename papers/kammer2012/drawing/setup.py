# SPDX-License-Identifier: BSD-3-Clause
"""The set-up: plate with mesh and loading, static stress ratio, friction law."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from slipfront.figures import style
from slipfront.figures.drawing import Drawing
from slipfront.figures.main_fronts import start
from slipfront.files import DataError
from slipfront.opened import OpenRun
from slipfront.read import Fields

from drawing import paper_style
from drawing.results import HIGH_MU_K, Results

NO_FIELDS = "no snapshots (fields.vtkhdf)"
GRID_LINES = 40  # about as many mesh lines across the plate stay readable


def edges(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All edges of the cells, each once, and whether it bounds only one cell. [edges, 2], [edges]"""
    ends = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, counts = np.unique(ends, axis=0, return_counts=True)
    return unique, counts == 1


def coarsening(columns: int, rows: int) -> int:
    """The common divisor of columns and rows nearest to columns / GRID_LINES: what is drawn stays square."""
    common = np.gcd(columns, rows)
    divisors = [k for k in range(1, common + 1) if common % k == 0]
    return min(divisors, key=lambda k: abs(k - columns / GRID_LINES))


def on_coarse_grid(ends: np.ndarray, columns: int, every: int) -> np.ndarray:
    """Whether an edge lies on every `every`-th line of the grid under the node numbers. [edges]"""
    i, j = ends % (columns + 1), ends // (columns + 1)
    along_row = (j[:, 0] == j[:, 1]) & (np.abs(i[:, 1] - i[:, 0]) == 1) & (j[:, 0] % every == 0)
    along_column = (i[:, 0] == i[:, 1]) & (np.abs(j[:, 1] - j[:, 0]) == 1) & (i[:, 0] % every == 0)
    return along_row | along_column


def static_maximum(run: OpenRun) -> int | None:
    """Index of the largest static ratio inside the interface, that is, without the margin at its ends."""
    x, ratio = run.x_m, run.static_ratio
    inside = (x >= run.fact("statics.inside_from_m")) & (x <= run.fact("statics.inside_to_m"))
    inside &= np.isfinite(ratio)
    return int(np.argmax(np.where(inside, ratio, -np.inf))) if inside.any() else None


def joined(segments: np.ndarray) -> np.ndarray:
    """Segments [n, 2, 2] as the points of one broken line: files of a few lines are small and quick."""
    return np.concatenate([segments, np.full((len(segments), 1, 2), np.nan)], axis=1).reshape(-1, 2)


def draw_edges(ax: Axes, segments: np.ndarray, **look: Any) -> None:
    ax.plot(*joined(segments).T, solid_capstyle="round", **look)


def draw_mesh(ax: Axes, fields: Fields, columns: int, rows: int) -> int:
    """Outline, every k-th grid line, and a magnified lower left corner with every cell; returns k."""
    if not (0 < columns <= len(fields.cells) and 0 < rows <= len(fields.cells)):
        raise DataError(f"{fields.file}: not the mesh of {columns} x {rows} cells that run.json gives")
    points = style.mm(fields.points_m)
    ends, boundary = edges(fields.cells)
    every = coarsening(columns, rows)
    inner = on_coarse_grid(ends, columns, every) & ~boundary
    draw_edges(ax, points[ends[inner]], color="0.6", linewidth=0.2, gid="mesh")
    draw_edges(ax, points[ends[boundary]], color="black", linewidth=0.7, gid="outline")

    width, height = np.ptp(points, axis=0)
    zoom = ax.inset_axes((0.28 * width, 0.24 * height, 0.44 * width, 0.58 * height), transform=ax.transData)
    near = (points[ends].min(axis=1) <= (0.06 * width, 0.08 * height)).all(axis=1)
    draw_edges(zoom, points[ends[near & ~boundary]], color="0.45", linewidth=0.3)
    draw_edges(zoom, points[ends[near & boundary]], color="black", linewidth=0.7)
    zoom.axhspan(-0.02 * height, 0, facecolor="0.9", edgecolor="0.3", hatch="//////", linewidth=0)
    zoom.axhline(0, color="black", linewidth=0.7)
    zoom.set(xlim=(-0.004 * width, 0.056 * width), ylim=(-0.008 * height, 0.0711 * height), aspect="equal")
    zoom.set(xticks=[], yticks=[])
    ax.indicate_inset_zoom(zoom, edgecolor="0.2", alpha=1, linewidth=0.5)
    return every


def draw_loading(ax: Axes, run: OpenRun, width: float, height: float) -> None:
    """Imposed displacement and velocity at the top edge; lengths of the arrows are not to scale."""
    left, right = (run.parameter(f"loading.tilt_{side}_m") for side in ("left", "right"))
    longest = 0.16 * height / max(left, right, 1e-30)
    x = np.linspace(0, width, 9)
    length = longest * (left + (right - left) * x / width)
    base = height * 1.015
    for xi, li in zip(x, length, strict=True):
        ax.annotate(
            "",
            (xi, base),
            (xi, base + li),
            arrowprops={
                "arrowstyle": "-|>,head_width=0.12,head_length=0.2",
                "lw": 0.6,
                "color": "black",
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )
    ax.plot(x, base + length, color="black", linewidth=0.6)
    ax.text(0, base + length[0] + 2, f"$u_y^1 = {1e3 * left:g}$ mm", ha="left", va="bottom")
    ax.text(width, base + length[-1] + 6, f"$u_y^2 = {1e3 * right:g}$ mm", ha="right", va="bottom")
    level = height * 1.3
    ax.annotate(
        "",
        (0.68 * width, level),
        (0.46 * width, level),
        arrowprops={"arrowstyle": "-|>,head_width=0.2,head_length=0.35", "lw": 1.2, "color": "black"},
    )
    ax.text(0.45 * width, level, "$v_x$", ha="right", va="center")


def dimension(ax: Axes, a: tuple[float, float], b: tuple[float, float], label: str, **text: Any) -> None:
    ax.annotate(
        "",
        a,
        b,
        arrowprops={
            "arrowstyle": "<|-|>,head_width=0.1,head_length=0.25",
            "lw": 0.5,
            "color": "black",
            "shrinkA": 0,
            "shrinkB": 0,
        },
    )
    ax.text(
        (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, label, ha="center", va="center", backgroundcolor="white", **text
    )


def draw_outline(ax: Axes, width: float, height: float) -> None:
    """In place of the mesh of a run without fields."""
    ax.add_patch(Rectangle((0, 0), width, height, fill=False, linewidth=0.7, gid="outline"))
    ax.text(width / 2, height / 2, NO_FIELDS, ha="center", va="center", color="0.45", gid="no_fields")


def draw_plate(ax: Axes, run: OpenRun) -> int | None:
    """Plate, mesh and loading; returns which grid lines are drawn, every k-th, None without a mesh."""
    width, height = 1e3 * run.parameter("plate.width_m"), 1e3 * run.parameter("plate.height_m")
    ax.add_patch(
        Rectangle(
            (-0.04 * width, -0.05 * height),
            1.08 * width,
            0.05 * height,
            facecolor="0.93",
            edgecolor="0.45",
            hatch="//////",
            linewidth=0,
        )
    )
    ax.plot([-0.04 * width, 1.04 * width], [0, 0], color="black", linewidth=0.7)
    every = None
    if run.fields is not None:
        every = draw_mesh(ax, run.fields, int(run.fact("mesh.columns")), int(run.fact("mesh.rows")))
    else:
        draw_outline(ax, width, height)
    draw_loading(ax, run, width, height)
    gap = 0.085 * height
    dimension(ax, (0, -2 * gap), (width, -2 * gap), f"$w = {width:g}$ mm")
    dimension(ax, (width + gap, 0), (width + gap, height), f"$h = {height:g}$ mm", rotation=90)
    where = start(run)
    if where is not None:
        style_of = paper_style.EVENT_STYLES[run.name]
        ax.add_patch(
            Circle(
                (1e3 * where[0], 0),
                0.035 * height,
                fill=False,
                edgecolor=style_of.colour,
                linewidth=1.1,
                zorder=5,
                gid="nucleation",
            )
        )
    ax.set(xlim=(-0.05 * width, width + 2 * gap), ylim=(-2.4 * gap, 1.36 * height), aspect="equal")
    ax.axis("off")
    return every


def draw_static_ratio(ax: Axes, run: OpenRun) -> None:
    ax.plot(style.mm(run.x_m), run.static_ratio, color="black", gid="static")
    mu_s = run.parameter("friction.mu_s")
    ax.axhline(mu_s, gid="mu_s", **style.REFERENCE)
    style.name_level(ax, mu_s, r"$\mu_s$")
    peak = static_maximum(run)
    if peak is not None:
        ax.plot(
            1e3 * run.x_m[peak],
            run.static_ratio[peak],
            "o",
            markersize=6,
            markerfacecolor="none",
            markeredgewidth=1.0,
            color="black",
            gid="maximum",
        )
    style.x_axis(ax, run)
    ax.set_ylabel(paper_style.STATIC_LABEL)
    finite = run.static_ratio[np.isfinite(run.static_ratio)]
    ax.set_ylim(0, 1.15 * max(mu_s, np.max(finite, initial=0.0)))


def friction_law(run: OpenRun, speed_m_per_s: np.ndarray) -> np.ndarray:
    """The velocity-weakening law with the run's parameters."""
    mu_s, mu_k = run.parameter("friction.mu_s"), run.parameter("friction.mu_k")
    drop = mu_s - mu_k
    return mu_k + drop * np.exp(-speed_m_per_s * np.sqrt(drop / run.parameter("friction.alpha_m2_per_s2")))


def draw_friction_law(ax: Axes, runs: list[OpenRun]) -> None:
    slowest = 1.0
    for run in runs:
        drop = run.parameter("friction.mu_s") - run.parameter("friction.mu_k")
        if drop > 0:
            slowest = max(slowest, np.sqrt(run.parameter("friction.alpha_m2_per_s2") / drop))
    v = np.linspace(0, 4 * slowest, 300)
    for run, line in zip(runs, ("-", (0, (4.5, 1.8))), strict=True):
        mu_k = run.parameter("friction.mu_k")
        colour = paper_style.EVENT_STYLES[run.name].colour
        mu = friction_law(run, v)
        ax.plot(v, mu, color=colour, linestyle=line, gid=run.name)
        ax.annotate(
            rf"$\mu_k = {mu_k}$",
            (v[-1], mu[-1]),
            xytext=(-2, 2),
            textcoords="offset points",
            ha="right",
            va="bottom",
        )
    alpha = sorted({run.parameter("friction.alpha_m2_per_s2") for run in runs})
    ax.annotate(
        r"$\alpha = $" + ", ".join(f"{a:g}" for a in alpha) + r" m$^2$/s$^2$",
        (0.97, 0.95),
        xycoords="axes fraction",
        ha="right",
        va="top",
    )
    mu_s = runs[0].parameter("friction.mu_s")
    ax.set(xlabel="$|v|$ (m/s)", ylabel=r"$\mu$", xlim=(0, v[-1]), ylim=(0, 1.15 * mu_s))


def setup(results: Results) -> Drawing:
    run = results.runs["spontaneous"]
    figure = style.new_figure(style.PAGE_MM, 72)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.9, 1])
    a, b, c = figure.add_subplot(grid[:, 0]), figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1])
    every = draw_plate(a, run)
    draw_static_ratio(b, run)
    draw_friction_law(c, [run, results.runs[HIGH_MU_K]])
    for ax, letter in ((a, "a"), (b, "b"), (c, "c")):
        style.panel_letter(ax, letter)
    columns, rows = int(run.fact("mesh.columns")), int(run.fact("mesh.rows"))
    lines = "every grid line" if every == 1 else f"one grid line in {every}"
    drawn = f"{lines} drawn; inset: every cell at the lower left corner" if every is not None else NO_FIELDS
    return Drawing(
        "fig1_setup",
        figure,
        f"(a) The plate on the rigid plane with its mesh of {columns} × {rows} cells ({drawn}), the "
        "displacement u<sub>y</sub> and the velocity v<sub>x</sub> imposed on the top edge (arrows not to "
        "scale) and the point where slip nucleates spontaneously (circle). (b) Static stress ratio along the "
        "interface and its maximum inside (circle). (c) Friction coefficient against slip rate for the two "
        "values of μ<sub>k</sub>.",
    )
