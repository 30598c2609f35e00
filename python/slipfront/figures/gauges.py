# SPDX-License-Identifier: BSD-3-Clause
"""Records of strain gauges with the fitted field of a tip."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from slipfront.errors import CaseError
from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.gauges import COMPONENTS, Gauge
from slipfront.tip_fit import TipFit

MEASURED, MODEL, TOGETHER = "0.55", "#d55e00", "#0072b2"
MOST_ROWS = 8
AROUND = 1.5  # of the fit's duration that is shown


def rows_of_panels(
    gauges: list[Gauge],
    draw: Callable[[int, int, Axes, str, float], str],
    labels: tuple[tuple[str, str], ...],
) -> Drawing:
    """A row per gauge, a column per component; draw(row, k, axes, part, factor) returns the row's title."""
    parts = [part for part in COMPONENTS if any(part in gauge.values for gauge in gauges)]
    parts += dict.fromkeys(part for gauge in gauges for part in gauge.parts if part not in COMPONENTS)
    n = min(len(gauges), MOST_ROWS)
    figure = style.new_figure(style.PAGE_MM, 18 + 32 * n)
    axes = figure.subplots(n, len(parts), squeeze=False)
    for row in range(n):
        gauge = gauges[row]
        factor, unit = (1e6, "µε") if gauge.is_strain else (1e-6, "MPa")
        sign = r"\varepsilon" if gauge.is_strain else r"\sigma"
        for k, part in enumerate(parts):
            ax = axes[row, k]
            if part not in gauge.values:
                ax.set_axis_off()
                continue
            title = draw(row, k, ax, part, factor)
            ax.set_ylabel(rf"${sign}_{{{part}}}$ ({unit})")
            if k == 0:
                ax.set_title(title, loc="left")
            if row == n - 1:
                ax.set_xlabel("$t$ (µs)")
    style.legend_below(figure, [Line2D([], [], color=c, label=label) for c, label in labels], len(labels))
    return Drawing("gauges", figure, "")


def draw_fits(events: list[tuple[str, list[Gauge], list[TipFit]]]) -> Drawing:
    """What stands before an event's lines, its gauges, and their fits, alone and together."""
    shown = [
        (head, next(g for g in gauges if g.name == fit.gauge), fit, fits)
        for head, gauges, fits in events
        for fit in fits
        if fit.has_tip and fit.together == 1
    ]
    if not shown:
        raise CaseError("no front passes any of the gauges: there is no fit to draw")

    def draw(row: int, k: int, ax: Axes, part: str, factor: float) -> str:
        head, gauge, fit, fits = shown[row]
        half_s = AROUND * max(fit.tip_s - fit.time_s[0], fit.time_s[-1] - fit.tip_s)
        near = np.abs(gauge.time_s - fit.tip_s) <= half_s
        ax.plot(1e6 * gauge.time_s[near], factor * gauge.values[part][near], color=MEASURED)
        together = [f for f in fits if f.gauge == fit.gauge and f.together > 1]
        for each, color in zip((fit, *together), (MODEL, TOGETHER), strict=False):
            gaps = np.flatnonzero(np.diff(each.time_s) > 1.5 * np.median(np.diff(each.time_s))) + 1
            time_s, model = (np.insert(a, gaps, np.nan) for a in (each.time_s, each.fitted[part]))
            ax.plot(1e6 * time_s, factor * model, color=color, dashes=(3, 1) if each.together > 1 else ())
        ax.axvline(1e6 * fit.tip_s, **style.REFERENCE)
        return (
            f"{head}{plain(fit.gauge)}, $x$ = {1e3 * fit.x_m:.4g} mm: $\\Gamma$ = {fit.Gamma_J_per_m2:.3g} ± "
            f"{fit.Gamma_error_J_per_m2:.2g} J/m², $V$ = {fit.speed_m_per_s:.0f} m/s"
        )

    labels = ((MEASURED, "record"), (MODEL, "field of a tip, fitted to the gauge"))
    is_joint = any(fit.together > 1 for _, _, _, fits in shown for fit in fits)
    more = ((TOGETHER, "fitted to all gauges together"),) if is_joint else ()
    return rows_of_panels([gauge for _, gauge, _, _ in shown], draw, labels + more)
