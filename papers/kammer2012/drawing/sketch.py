# SPDX-License-Identifier: BSD-3-Clause
"""Sketches of what is measured at the tip of a front, for insets: a row of nodes per instant."""

from __future__ import annotations

from matplotlib.axes import Axes
from slipfront.figures.style import Look

from drawing.paper_style import TIP_MARKER

N_NODES = 6


def nodes(ax: Axes, y: float, n_slipping: int, instant: str, measured: tuple[int, str] | None = None) -> None:
    """Nodes at an instant, filled where they slip, a triangle over the tip; what is measured in a ring."""
    look: Look = {"linestyle": "none", "marker": "o", "markersize": 4.5, "color": "0.2"}
    for first, last, face in ((0, n_slipping, "0.2"), (n_slipping, N_NODES, "white")):
        ax.plot(range(first, last), [y] * (last - first), markerfacecolor=face, zorder=3, **look)
    ax.plot([-0.5, N_NODES - 0.5], [y, y], color="0.2", linewidth=0.5, zorder=1)
    tip: Look = {"marker": TIP_MARKER, "markersize": 11, "markeredgewidth": 0.5}
    ax.plot(n_slipping, y + 0.22, color="0.2", markerfacecolor="white", linestyle="none", **tip)
    ax.text(-0.9, y, instant, ha="right", va="center")
    if measured is not None:
        node, text = measured
        ax.plot(node, y, markersize=9, markerfacecolor="none", marker="o", color="0.2", markeredgewidth=0.5)
        ax.text(N_NODES - 0.1, y, text, ha="left", va="center")


def frame(ax: Axes, left: float, right: float) -> None:
    ax.set(xlim=(left, right), ylim=(-0.45, 1.75), xticks=[], yticks=[])
    ax.spines[:].set(linewidth=0.4, color="0.6")


def dynamic_ratio(ax: Axes) -> None:
    """Fig. 4: t_d and p_d belong to the node ahead when the one before it begins to slip."""
    nodes(ax, 1, 3, "$t^{\\,i}$")
    nodes(ax, 0, 4, "$t^{\\,i+1}$", (4, "$t_d,\\ p_d$"))
    frame(ax, -2.6, N_NODES + 2)


def energies(ax: Axes) -> None:
    """Fig. 6: U_s and U_r belong to one node, when the tip reaches it and when the tip is about to go on."""
    nodes(ax, 1, 3, "tip arrives", (3, "$U_s(p_d, t_d)$"))
    nodes(ax, 0, 3, "about to go on", (3, "$U_r(p_r, \\mu_s p_r)$"))
    ax.plot(3, 0, marker="o", markersize=4.5, color="0.2", markerfacecolor="0.7", zorder=4)
    frame(ax, -6.6, N_NODES + 4.2)
