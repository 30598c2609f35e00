# SPDX-License-Identifier: BSD-3-Clause
"""Maps of a sweep: results over two keys as colours, over one as points.

usage: python -m slipfront.sweep.maps PICTURE DIR, the folder of a sweep"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap
from matplotlib.figure import Figure

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.figures.picture import command_to_draw, write_results
from slipfront.sweep.outcome import NONE, Quantity
from slipfront.sweep.points import short_names
from slipfront.sweep.reading import Results, read_results
from slipfront.sweep.values import text_of

#: What is drawn, in this order.
SHOWN = ("longest_front_slip", "longest_front_end", "longest_front_v_tip_median_over_c_L",
         "v_tip_largest_over_c_L", "slipped_share", "friction_work_J_per_m")  # fmt: skip
COLOURS = ("#0072b2", "#d55e00", "#e8c35a", "#117733", "#dddddd")  # of words
COLUMNS = 2
PANEL_MM = 52.0
LOG_RATIO = 20  # of two values of a key from which its axis is logarithmic
MOST_TICKS = 7  # values of a key that are all written at its axis
NO_RESULT = "#ffffff"
CLOSE = 0.06  # marks at a bar of colours that are closer, over its length, have one label


def unevenness(ascending: np.ndarray) -> float:
    steps = np.diff(ascending)
    return float(steps.std() / steps.mean())


def is_logarithmic(values: np.ndarray) -> bool:
    """Whether an axis of these values, ascending, is to be logarithmic: they are more even there."""
    if values.dtype == object or values.min() <= 0:
        return False
    if len(values) < 3:
        return bool(values.max() / values.min() >= LOG_RATIO)
    return unevenness(np.log(values)) < unevenness(values)


def edges(centres: np.ndarray, logarithmic: bool) -> np.ndarray:
    """Of cells around the centres, half way to the next. [centres + 1]"""
    c = np.log(centres) if logarithmic else np.asarray(centres, dtype=float)
    if len(c) == 1:
        width = 0.5 if logarithmic else max(abs(c[0]) * 0.05, 0.5)
        out = np.array([c[0] - width, c[0] + width])
    else:
        middle = (c[1:] + c[:-1]) / 2
        out = np.concatenate([[2 * c[0] - middle[0]], middle, [2 * c[-1] - middle[-1]]])
    return np.exp(out) if logarithmic else out


def chosen_points(results: Results, x: str, y: str) -> np.ndarray:
    """Points of a grid at which all keys but two have their first values. [points]"""
    chosen = np.full(len(results.table.rows), True)
    for key in results.keys:
        if key not in (x, y):
            chosen &= results.values[key] == results.axis(key)[0]
    return chosen


def grid_of(results: Results, quantity: Quantity, x: str, y: str) -> np.ndarray:
    """A quantity over two keys of a grid, NaN without. [y, x]"""
    column = results.column(quantity)
    across, up = results.axis(x), results.axis(y)
    cells = np.full((len(up), len(across)), np.nan)
    for point in np.flatnonzero(chosen_points(results, x, y)):
        i, j = (np.flatnonzero(axis == results.values[key][point])[0] for axis, key in ((up, y), (across, x)))
        cells[i, j] = column[point]
    return cells


def colours_of(quantity: Quantity) -> tuple[Colormap, BoundaryNorm | None]:
    if not quantity.words:
        return colormaps["viridis"], None
    n = len(quantity.words)
    has_none = quantity.words[-1] == NONE
    used = (*COLOURS[: n - 1], COLOURS[-1]) if has_none else COLOURS[:n]
    return ListedColormap(used), BoundaryNorm(np.arange(n + 1) - 0.5, n)


def name_axis(ax: Axes, which: str, key: str, values: np.ndarray) -> None:
    label = plain(key)
    if which == "x":
        ax.set_xlabel(label)
    else:
        ax.set_ylabel(label)
    axis = ax.xaxis if which == "x" else ax.yaxis
    if values.dtype == object:
        axis.set_ticks(range(len(values)), [plain(str(value)) for value in values])
        return
    if is_logarithmic(values):
        getattr(ax, f"set_{which}scale")("log")
    if len(values) <= MOST_TICKS:
        axis.set_ticks(values, [f"{value:.4g}" for value in values])
        axis.set_ticks([], minor=True)


def places(values: np.ndarray) -> np.ndarray:
    """Where the values of a key are on its axis."""
    return np.arange(len(values), dtype=float) if values.dtype == object else values


def merged(levels: dict[str, float], low: float, high: float) -> list[tuple[float, str]]:
    """Places and labels of the levels from low to high, in ascending order, close ones in one."""
    groups: list[list[str]] = []
    inside = [name for name, level in levels.items() if low <= level <= high]
    for name in inside:
        if groups and levels[name] - levels[groups[-1][-1]] < CLOSE * (high - low):
            groups[-1].append(name)
        else:
            groups.append([name])
    return [
        (
            float(np.mean([levels[name] for name in names])),
            ", ".join(rf"$c_\mathrm{{{name[-1]}}}$" for name in names),
        )
        for names in groups
    ]


def with_waves(low: float, high: float, levels: dict[str, float]) -> tuple[float, float]:
    """A range of speeds, out to the next wave speeds below and above it."""
    below = [level for level in levels.values() if level < low]
    above = [level for level in levels.values() if level > high]
    return max(below, default=low), min(above, default=high)


def mark_waves(ax: Axes, levels: dict[str, float], low: float, high: float) -> None:
    """Lines across a bar of colours, named at its left."""
    for name, level in levels.items():
        if low <= level <= high:
            outline = style.outlined("white", 2.0)
            ax.axhline(level, color="black", linewidth=0.8, path_effects=outline, gid=name)
    for level, label in merged(levels, low, high):
        ax.annotate(
            label,
            (0, level),
            xycoords=ax.get_yaxis_transform(),
            xytext=(-2, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            annotation_clip=False,
        )


def name_colours(figure: Figure, ax: Axes, drawn: Any, quantity: Quantity, waves: dict[str, float]) -> None:
    """A bar of colours with numbers or words; wave speeds are marked in that of a speed."""
    if not quantity.words:
        low, high = drawn.get_clim()
        low, high = with_waves(low, high, waves)
        drawn.set_clim(low, high)
        labels = [label for _, label in merged(waves, low, high)]
        pad = 0.02 + (0.03 + 0.04 * max(label.count(",") for label in labels) if labels else 0.0)
        mark_waves(figure.colorbar(drawn, ax=ax, pad=pad).ax, waves, low, high)
        return
    bar = figure.colorbar(drawn, ax=ax, pad=0.02, ticks=range(len(quantity.words)))
    bar.ax.set_yticklabels([word.replace("_", " ") for word in quantity.words])
    bar.ax.tick_params(length=0)


def draw_map(figure: Figure, ax: Axes, results: Results, quantity: Quantity, x: str, y: str) -> None:
    """A panel: cells of a grid, else a dot for each point."""
    colours, norm = colours_of(quantity)
    if results.is_grid:
        values = grid_of(results, quantity, x, y)
        across, up = results.axis(x), results.axis(y)
        sides = [edges(places(axis), is_logarithmic(axis)) for axis in (across, up)]
        ax.set_facecolor(NO_RESULT)
        drawn = ax.pcolormesh(*sides, values, cmap=colours, norm=norm, rasterized=True, gid=quantity.name)
    else:
        values = results.column(quantity)
        at = [results.values[key].astype(float) for key in (x, y)]
        drawn = ax.scatter(*at, c=values, cmap=colours, norm=norm, s=14, gid=quantity.name)  # type: ignore
    name_axis(ax, "x", x, results.axis(x))
    name_axis(ax, "y", y, results.axis(y))
    if np.isfinite(values).any():
        name_colours(figure, ax, drawn, quantity, results.waves_of(quantity))


def draw_line(ax: Axes, results: Results, quantity: Quantity, x: str) -> None:
    """A panel over one key."""
    values = results.values[x]
    places_of = {value: k for k, value in enumerate(results.axis(x))}
    at = np.array([places_of[v] for v in values]) if values.dtype == object else values
    ax.plot(at, results.column(quantity), "o", color=COLOURS[0], gid=quantity.name)
    for wave, level in results.waves_of(quantity).items():
        ax.axhline(level, linestyle=":" if wave == "c_R" else "-", gid=wave, **style.REFERENCE)
        style.name_level(ax, level, rf"$c_\mathrm{{{wave[-1]}}}$", below=wave == "c_R")
    if quantity.words:
        ax.set_yticks(range(len(quantity.words)), [word.replace("_", " ") for word in quantity.words])
    name_axis(ax, "x", x, results.axis(x))


def title_of(quantity: Quantity) -> str:
    unit = f" ({quantity.unit.replace(' m-1', '/m')})" if quantity.unit not in ("", "1") else ""
    return plain(quantity.long_name) + unit


def fixed_words(results: Results, shown: list[str]) -> str:
    """Keys of a grid that the map does not go over, and at which value it is."""
    short = short_names(results.keys)
    others = [key for key in results.keys if key not in shown]
    if not others or not results.is_grid:
        return ""
    return ", ".join(f"{short[key]} = {text_of(results.axis(key)[0])}" for key in others)


def draw(folder: Path, shown: tuple[str, ...] = SHOWN) -> Drawing:
    """Panels of results over the first two keys that vary, the first one up; of a single key over it."""
    results = read_results(folder)
    quantities = [quantity for quantity in results.quantities if quantity.name in shown]
    quantities.sort(key=lambda quantity: shown.index(quantity.name))
    n_rows = -(-len(quantities) // COLUMNS)
    figure = style.new_figure(style.PAGE_MM, PANEL_MM * n_rows)
    keys = results.keys[:2]
    for k, quantity in enumerate(quantities):
        ax = figure.add_subplot(n_rows, COLUMNS, k + 1)
        ax.set_title(title_of(quantity), pad=3)
        if len(keys) == 1:
            draw_line(ax, results, quantity, keys[0])
        else:
            draw_map(figure, ax, results, quantity, keys[1], keys[0])
    at = fixed_words(results, keys)
    if at:
        figure.suptitle(plain(at))
    return Drawing(
        "sweep",
        figure,
        "Results over the keys that vary; white: no result. Wave speeds are marked in the scales of "
        "V<sub>tip</sub>/c<sub>L</sub> where the material does not vary.",
    )


def main(arguments: list[str] | None = None) -> int:
    return command_to_draw(
        "slipfront.sweep.maps",
        "Draws maps of a sweep's results over the first two keys that vary.",
        "slipfront sweep",
        lambda picture, folder: write_results(picture, folder, draw),
        arguments,
    )


if __name__ == "__main__":
    sys.exit(main())
