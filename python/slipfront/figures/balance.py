# SPDX-License-Identifier: BSD-3-Clause
"""Where the energy of a run goes, and what its books leave open."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from slipfront.figures import style
from slipfront.figures.drawing import Drawing, plain
from slipfront.opened import open_run
from slipfront.read import ENERGY_TERMS, Balance

SMALL = 0.02  # a term that never exceeds this share of the largest is drawn below, where it can be seen
# No two terms share both a hue and a dash for eyes without red or green receptors.
TERMS: dict[str, tuple[str, str, style.Line]] = {
    "strain": ("strain energy", "#000000", "-"),
    "kinetic": ("kinetic energy", "#0072b2", "-"),
    "machine": ("loading machine", "#882255", (0, (7, 1.5, 1, 1.5))),
    "friction_work": ("friction", "#d55e00", (0, (5, 1.5))),
    "damping_work": ("damping", "#009e73", (0, (7, 1.5, 1, 1.5, 1, 1.5))),
    "trigger_work": ("trigger", "#882255", (0, (1, 1.2))),
    "top_work": ("top edge", "#e69f00", (0, (1, 1.2))),
    "prestress_work": ("prescribed tractions", "#56b4e9", (0, (1, 1.2))),
    "contact_work": ("closing gaps", "#aa4499", (0, (6, 1.5, 1, 1.5))),
    "boundary_work": ("absorbing edges", "#56b4e9", (0, (6, 1.5, 1, 1.5))),
    "coupling_work": ("sub-steps (error)", "#e69f00", "-"),
}
IMBALANCE: tuple[str, str, style.Line] = ("imbalance", "#cc3311", "-")
assert set(TERMS) == set(ENERGY_TERMS)


@dataclass(frozen=True)
class Books:
    """The balance of one run and what it is called."""

    name: str
    label: str  # for Matplotlib
    balance: Balance

    def share(self, values: np.ndarray) -> np.ndarray:
        """Magnitude over the largest change."""
        return np.abs(values) / (self.balance.largest_J_per_m or 1.0)


def draw_large(ax: Axes, books: Books) -> list[str]:
    """Changes of the large terms over time; returns their names."""
    large = [t for t in TERMS if np.max(books.share(books.balance.terms[t])) > SMALL]
    for term in large:
        _, colour, line = TERMS[term]
        values = books.balance.terms[term]
        ax.plot(1e6 * books.balance.time_s, values, color=colour, linestyle=line, gid=f"{books.name}:{term}")
    ax.axhline(0, **style.REFERENCE)
    return large


def draw_small(ax: Axes, books: Books, large: list[str]) -> list[str]:
    """Magnitude over the largest term, on a log axis: the small terms, the coupling, and the imbalance."""
    small = [t for t in TERMS if (t not in large or t == "coupling_work") and books.balance.terms[t].any()]
    lines = {term: (TERMS[term], books.balance.terms[term]) for term in small}
    lines["imbalance"] = (IMBALANCE, books.balance.imbalance_J_per_m)
    for name, ((_, colour, line), values) in lines.items():
        share = books.share(values)
        ax.plot(
            1e6 * books.balance.time_s,
            np.where(share > 0, share, np.nan),  # zero has no logarithm
            color=colour,
            linestyle=line,
            marker="." if name == "imbalance" else None,
            gid=f"{books.name}:{name}",
        )
    ax.set(yscale="log", ylim=(1e-16, 1), xlabel="$t$ (µs)", yticks=10.0 ** np.arange(-16, 1, 4))
    ax.minorticks_off()
    return [*small, "imbalance"]


def closing(books: Books) -> str:
    """The end of the books in words."""
    b = books.balance
    worst = float(np.max(np.abs(b.imbalance_J_per_m)))
    label = books.label.replace("$\\mu_k", "μ<sub>k</sub>").replace("$", "")
    return (
        f"{label}: largest change {b.largest_J_per_m:.3g} J/m, imbalance at most {worst:.1e} J/m or "
        f"{np.max(books.share(b.imbalance_J_per_m)):.1e} of it, coupling at the end "
        f"{b.terms['coupling_work'][-1]:.2g} J/m"
    )


def draw_balances(every: list[Books]) -> Drawing:
    """A column for each run."""
    width_mm = max(style.COLUMN_MM, style.PAGE_MM * len(every) / 4)
    figure = style.new_figure(width_mm, 100 if len(every) > 1 else 120)  # alone, its legend takes more rows
    panels = figure.subplots(2, len(every), squeeze=False, sharex="col")
    drawn: set[str] = set()
    for column, books in enumerate(every):
        upper, lower = panels[:, column]
        large = draw_large(upper, books)
        drawn |= {*large, *draw_small(lower, books, large)}
        upper.set_title(books.label)
        lower.set_xlim(0, 1e6 * books.balance.time_s[-1])
        if column > 0:
            lower.set_yticklabels([])
    panels[0, 0].set_ylabel("change, or work done (J/m)")
    panels[1, 0].set_ylabel("magnitude / largest change")
    figure.align_ylabels(panels[:, 0])
    styles = {name: TERMS[name] for name in TERMS if name in drawn} | {"imbalance": IMBALANCE}
    handles = [
        Line2D([], [], color=c, linestyle=line, label=label, marker="." if name == "imbalance" else None)
        for name, (label, c, line) in styles.items()
    ]
    n_columns = 2 if len(every) == 1 else 1 + len(every)
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), n_columns))
    return Drawing(
        "energy_balance",
        figure,
        "Energy over time, per unit thickness. Above: change of the stored energies since the start, and the "
        "works done on the plate; what leaves it is negative. Closing gaps: what is lost where the plate "
        "lands on its base again. Below, on a logarithmic scale and over the largest change above: terms of "
        f"at most {100 * SMALL:g} % of it, the coupling between the sub-cycled layer and the other cells, an "
        "error of the time stepping, and the imbalance: change less all works, each computed by itself. "
        f"{'; '.join(closing(books) for books in every)}.",
    )


def balance_of_run(folder: Path) -> tuple[Drawing, list[str]]:
    """One run, of any case, and what to print beside it."""
    run = open_run(folder)
    last_s = run.balance.time_s[-1]
    name = folder.resolve().name
    drawing = draw_balances([Books(name, plain(name), run.balance)])
    return drawing.marked(run.place.mark(last_s)), run.place.remarks(last_s)
