# SPDX-License-Identifier: BSD-3-Clause
"""The posterior of a fit's free keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import corner
import numpy as np

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.sweep.points import short_names

if TYPE_CHECKING:
    from slipfront.fit.space import Space

BEST = "#d55e00"
INSIDE = (0.68, 0.90)  # of the samples, within the contours


def draw_corner(space: Space, samples: np.ndarray, best: Mapping[str, float]) -> Drawing:
    """Each key's marginal with its interval of 90 %, each pair's contours of 68 and 90 %, and the best run; keys
    with a logarithmic range by their logarithms. samples: shares [samples, keys]"""
    figure = style.new_figure(style.PAGE_MM, 40 + 38 * space.n, constrained=False)
    values = space.values(samples)
    is_log = [of.is_log for of in space.ranges.values()]
    shown = np.where(is_log, np.log10(np.where(is_log, values, 1.0)), values)
    short = short_names(space.keys)
    labels = [
        f"log10 {short[key]}" if log else short[key] for key, log in zip(space.keys, is_log, strict=True)
    ]
    at = np.array([best[key] for key in space.keys])
    at = np.where(is_log, np.log10(np.where(is_log, at, 1.0)), at)
    corner.corner(shown, fig=figure, labels=[plain(label) for label in labels], truths=at, truth_color=BEST,
                  quantiles=(0.05, 0.5, 0.95), levels=INSIDE, plot_datapoints=False, smooth=0.7,
                  label_kwargs={"fontsize": 8}, max_n_ticks=4)  # fmt: skip
    return Drawing("corner", figure, "")
