# SPDX-License-Identifier: BSD-3-Clause
"""The posterior of a fit's free keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import corner
import numpy as np
from matplotlib.ticker import FuncFormatter

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.sweep.points import short_names
from slipfront.units import engineering, name_of, unit_of

if TYPE_CHECKING:
    from slipfront.fit.space import Space

BEST = "#d55e00"
PLAIN = FuncFormatter(lambda value, _: f"{value:g}")
INSIDE = (0.68, 0.90)  # of the samples, within the contours


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
        max_n_ticks=4,
    )
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            if axis.get_scale() == "log":
                axis.set_major_formatter(PLAIN)
                axis.set_minor_formatter(PLAIN)
    return Drawing("corner", figure, "")
