# SPDX-License-Identifier: BSD-3-Clause
"""Maps of a sweep: results over two keys as colours, over one as points.

usage: python -m slipfront.sweep.maps PICTURE DIR, the folder of a sweep"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes as MplAxes
from matplotlib.collections import QuadMesh
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, command_to_draw, plain, write_results
from slipfront.files import DataError
from slipfront.sweep.outcome import NONE
from slipfront.sweep.tables import (
    UNDEFINED,
    Axis,
    axes_of,
    cells_of,
    constant,
    keys_of,
    read_dataset,
    shown_in,
)

if TYPE_CHECKING:
    import xarray as xr

#: What is drawn, in this order.
SHOWN = ("longest_front_slip", "longest_front_end", "longest_front_v_tip_median_over_c_L",
         "v_tip_largest_over_c_L", "slipped_share", "friction_work_J_per_m", "n_global_events",
         "largest_friction", "friction_at_rest_median", "longest_precursor_m")  # fmt: skip
COLOURS = ("#0072b2", "#d55e00", "#e8c35a", "#117733", "#dddddd")  # of words
COLUMNS = 2
PANEL_MM = 52.0
LOG_RATIO = 20  # of two values of a key from which its axis is logarithmic
MOST_VALUES = 100  # cells of a map whose values are written into them
VALUE_SIZE = 6.0  # points
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
MOST_TICKS = 7  # values of a key that are all written at its axis
WAVES = {
    "c_R": "top",
    "c_S": "bottom",
    "c_L": "bottom",
}  # where names are at their lines: c_R is close to c_S


def is_text(values: np.ndarray | xr.DataArray) -> bool:
    return values.dtype.kind not in "fiu"


def is_logarithmic(ascending: np.ndarray) -> bool:
    """Whether an axis of these values is to be logarithmic: they are more even there."""
    if is_text(ascending) or ascending[0] <= 0:
        return False
    if len(ascending) < 3:
        return bool(ascending[-1] / ascending[0] >= LOG_RATIO)
    unevenness = [steps.std() / steps.mean() for steps in map(np.diff, (np.log(ascending), ascending))]
    return bool(unevenness[0] < unevenness[1])


def edges(centres: np.ndarray, logarithmic: bool) -> np.ndarray:
    """Of cells around the centres, half way to the next. [centres + 1]"""
    c = np.log(centres) if logarithmic else np.asarray(centres, dtype=float)
    out = style.cell_edges(c) if len(c) > 1 else c + np.array([-0.5, 0.5])
    return np.exp(out) if logarithmic else out


def axis_of(column: xr.DataArray) -> np.ndarray:
    """Each value of a key once, numbers ascending, texts in the order of the table."""
    values = column.to_numpy()
    return np.array(list(dict.fromkeys(values))) if is_text(values) else np.unique(values)


def places(column: xr.DataArray, axis_shown: Axis) -> np.ndarray:
    """Where the values of a key are on its axis: numbers at themselves in its unit, texts side by side."""
    values = column.to_numpy()
    if not is_text(values):
        return axis_shown.factor * values
    axis = list(axis_of(column))
    return np.array([float(axis.index(value)) for value in values])


def numbers(result: xr.DataArray) -> np.ndarray:
    """A result's numbers in the unit that suits them; words' places in the list of them. NaN without."""
    words = result.attrs.get("words", "").split()
    if not words:
        return shown_in(result).factor * result.to_numpy()
    found = [float(words.index(word)) if word in words else np.nan for word in result.to_numpy().flat]
    return np.reshape(found, result.shape)


def waves_of(data: xr.Dataset, name: str) -> dict[str, float]:
    """Wave speeds to be marked in the scale of a result: of speeds over c_L, where the sweep knows them."""
    if not name.endswith("_over_c_L"):
        return {}
    speeds = {wave: data.attrs.get(f"{wave}_over_c_L") for wave in WAVES}
    return {wave: speed for wave, speed in speeds.items() if speed is not None}


def name_axis(ax: MplAxes, which: str, column: xr.DataArray, shown: Axis) -> None:
    ax.set(**{f"{which}label": plain(shown.label)})
    axis = ax.xaxis if which == "x" else ax.yaxis
    values = axis_of(column)
    if is_text(values):
        axis.set_ticks(range(len(values)), [plain(value) for value in values])
        return
    values = shown.factor * values
    if is_logarithmic(values):
        ax.set(**{f"{which}scale": "log"})
    if len(values) <= MOST_TICKS:
        axis.set_ticks(values, [f"{value:.4g}" for value in values])
        axis.set_ticks([], minor=True)


def mark_waves(ax: MplAxes, waves: dict[str, float]) -> None:
    """Lines in the scale of a speed; a name stands at the side that has room."""
    is_bar = ax.get_label() == "<colorbar>"
    for wave, level in waves.items():
        ax.axhline(level, color="white" if is_bar else "0.5", linewidth=0.8, gid=wave)
        name = rf"$c_\mathrm{{{wave[-1]}}}$"
        x, ha = (-0.2, "right") if is_bar else (1.01, "left")  # beside the scale's numbers
        ax.text(x, level, name, ha=ha, va=WAVES[wave], transform=ax.get_yaxis_transform())


def write_values(
    ax: MplAxes, drawn: QuadMesh, result: xr.DataArray, across: np.ndarray, up: np.ndarray
) -> None:
    """The value of each cell in it, dark on light or light on dark."""
    texts = np.reshape(cells_of(result, 3), result.shape)
    colours = np.reshape(drawn.to_rgba(numbers(result)), (*result.shape, 4))
    for (row, column), told in np.ndenumerate(texts):
        if told == UNDEFINED:
            continue
        light = colours[row, column, :3] @ LUMINANCE > 0.5
        look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": VALUE_SIZE}
        ax.text(
            float(across[column]),
            float(up[row]),
            plain(told),
            color="black" if light else "white",
            **look,
        )


def draw_map(figure: Figure, ax: MplAxes, data: xr.Dataset, name: str, x: str, y: str) -> None:
    """A panel: cells of a grid, else a dot for each point."""
    result = data[name]
    axes = axes_of(data)
    words = result.attrs.get("words", "").split()
    look: dict[str, Any] = {"cmap": colormaps["viridis"], "gid": name}
    if words:
        used = (*COLOURS[: len(words) - 1], COLOURS[-1]) if words[-1] == NONE else COLOURS[: len(words)]
        norm = BoundaryNorm(np.arange(len(words) + 1) - 0.5, len(words))
        look |= {"cmap": ListedColormap(used), "norm": norm}
    across, up = (places(data[key], axes[key]) for key in (x, y))
    if "point" in data.dims:
        values = numbers(result)
        drawn: Any = ax.scatter(across, up, c=values, s=14, **look)
    else:
        result = result.transpose(y, x)
        values = numbers(result)
        sides = [edges(at, is_logarithmic(data[key].to_numpy())) for at, key in ((across, x), (up, y))]
        drawn = ax.pcolormesh(*sides, values, rasterized=True, **look)
    name_axis(ax, "x", data[x], axes[x])
    name_axis(ax, "y", data[y], axes[y])
    if "point" not in data.dims and values.size <= MOST_VALUES:
        write_values(ax, drawn, result, across, up)
    finite = values[np.isfinite(values)]
    if len(finite) == 0 or finite.min() == finite.max():
        return
    bar = figure.colorbar(drawn, ax=ax, ticks=range(len(words)) if words else None)
    if words:
        bar.ax.set_yticklabels([word.replace("_", " ") for word in words])
    low, high = drawn.get_clim()
    mark_waves(bar.ax, {wave: v for wave, v in waves_of(data, name).items() if low <= v <= high})


def draw_line(ax: MplAxes, data: xr.Dataset, name: str, x: str) -> None:
    """A panel over one key."""
    words = data[name].attrs.get("words", "").split()
    shown = axes_of(data)[x]
    look = "o" if is_text(data[x]) or "point" in data.dims else "o-"
    ax.plot(places(data[x], shown), numbers(data[name]), look, color=COLOURS[0], gid=name)
    mark_waves(ax, waves_of(data, name))
    if words:
        ax.set_yticks(range(len(words)), [word.replace("_", " ") for word in words])
    name_axis(ax, "x", data[x], shown)


def in_words(data: xr.Dataset, same: dict[str, str]) -> str:
    """Results that are the same at all points."""
    return "the same at all points: " + "; ".join(
        f"{data[n].attrs['long_name']}: {v}" for n, v in same.items()
    )


def fixed(data: xr.Dataset, keys: list[str]) -> str:
    """Values of keys that are the same in all panels."""
    axes = axes_of(data)
    values = (data[key].item() for key in keys)
    return ", ".join(
        f"{axes[key].label}: {value if isinstance(value, str) else f'{axes[key].factor * value:.4g}'}"
        for key, value in zip(keys, values, strict=True)
    )


def draw(folder: Path, shown: tuple[str, ...] = SHOWN) -> Drawing:
    """Panels of results that the table has over the first two keys that vary, the first one up; of a single
    key over it. Other keys of a grid are at their first value."""
    data = read_dataset(folder)
    keys = list(keys_of(data))
    shown = tuple(name for name in shown if name in data)
    same = {name: told for name in shown if (told := constant(data[name])) is not None}
    shown = tuple(name for name in shown if name not in same)
    if not shown:
        raise DataError(f"{folder}: nothing to draw: {in_words(data, same)}")
    n_rows = -(-len(shown) // COLUMNS)
    figure = style.new_figure(style.PAGE_MM, PANEL_MM * n_rows)
    if "point" not in data.dims:
        data = data.isel(dict.fromkeys(keys[2:], 0))
        data = data.sortby([key for key in keys[:2] if not is_text(data[key])])
        if keys[2:]:
            figure.suptitle(plain(fixed(data, keys[2:])))
    for k, name in enumerate(shown):
        ax = figure.add_subplot(n_rows, COLUMNS, k + 1)
        unit = shown_in(data[name]).name
        ax.set_title(plain(data[name].attrs["long_name"]) + (f" ({unit})" if unit != "1" else ""), pad=3)
        if len(keys) == 1:
            draw_line(ax, data, name, keys[0])
        else:
            draw_map(figure, ax, data, name, keys[1], keys[0])
    if same:
        figure.supxlabel(plain(in_words(data, same)), fontsize=VALUE_SIZE, wrap=True)
    return Drawing(
        "sweep",
        figure,
        "Results over the keys that vary; white: no result. Wave speeds are marked in the scales of "
        "V<sub>tip</sub>/c<sub>L</sub> where the material does not vary.",
    )


main = command_to_draw(
    "slipfront.sweep.maps",
    "Draws maps of a sweep's results over the first two keys that vary.",
    "slipfront sweep",
    partial(write_results, draw=draw),
)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
