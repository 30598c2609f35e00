# SPDX-License-Identifier: BSD-3-Clause
"""The posterior of a fit's free keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import corner
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.sweep.points import short_names
from slipfront.units import engineering, name_of, unit_of

if TYPE_CHECKING:
    from slipfront.fit.space import Space

BEST = "#d55e00"
PLAIN = FuncFormatter(lambda value, _: f"{value:g}")
INSIDE = (0.68, 0.90)  # of the samples, within the contours
SHOWN = (0.001, 0.999)  # quantiles, between which axes go
LEGEND = "dashes: median and 90 %\ncontours: 68 and 90 %\norange: best run"


def draw_corner(space: Space, samples: np.ndarray, best: Mapping[str, float]) -> Drawing:
    """Each key's marginal with its interval of 90 %, each pair's contours of 68 and 90 %, and the best run;
    keys with a logarithmic range on logarithmic axes. samples: shares [samples, keys]"""
    figure = style.new_figure(style.PAGE_MM, 20 + 38 * space.n, constrained=False)
    short, units = short_names(space.keys), []
    values = space.values(samples)
    for k, key in enumerate(space.keys):
        units.append(engineering(unit_of(key.rsplit(".", 1)[-1]), values[:, k]))
    factors = np.array([unit.factor for unit in units])
    labels = [
        plain(f"{name_of(key)} ({unit.name})" if unit.name != "1" else short[key])
        for key, unit in zip(space.keys, units, strict=True)
    ]
    scales = ["log" if of.is_log else "linear" for of in space.ranges.values()]
    at = np.array([best[key] for key in space.keys])
    if space.n == 1:  # which corner does not draw
        ax = figure.subplots()
        ax.hist(values[:, 0] * factors[0], bins=30, histtype="step", color="black")
        ax.axvline(at[0] * factors[0], color=BEST)
        ax.set(xlabel=labels[0], xscale=scales[0], yticks=[])
        return Drawing("corner", figure, "")
    # The best run may be beyond nearly all samples.
    low, high = np.quantile(values * factors, SHOWN, axis=0)
    low, high = np.minimum(low, at * factors), np.maximum(high, at * factors)
    corner.corner(
        values * factors,
        fig=figure,
        labels=labels,
        truths=at * factors,
        truth_color=BEST,
        axes_scale=scales,
        quantiles=(0.05, 0.5, 0.95),
        levels=INSIDE,
        plot_datapoints=False,
        smooth=0.7,
        label_kwargs={"fontsize": 8},
        range=list(zip(low, high, strict=True)),
        max_n_ticks=4,
    )
    figure.subplots_adjust(left=0.16, bottom=0.16)
    for k, ax in enumerate(figure.axes):
        row, column = divmod(k, space.n)
        for axis, (first, last), is_outer in (
            (ax.xaxis, ax.get_xlim(), row == space.n - 1),
            (ax.yaxis, ax.get_ylim(), column == 0 and row > 0),
        ):
            if axis.get_scale() == "log":
                is_narrow = last < 10 * first  # than powers of ten are apart
                axis.set_major_locator(MaxNLocator(4) if is_narrow else LogLocator(subs=(1, 2, 5)))
                axis.set_minor_locator(NullLocator())
                axis.set_major_formatter(PLAIN if is_outer else NullFormatter())
    figure.text(0.98, 0.97, LEGEND, ha="right", va="top", fontsize=8)
    return Drawing("corner", figure, "")
