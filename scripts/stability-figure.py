#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws growth against wavenumber: stability_table > t.csv; scripts/stability-figure.py t.csv growth.png"""

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from shared import checked, run, write_figure


def main(table: Path, picture: Path) -> None:
    checked(picture)
    curves: dict[str, dict[str, tuple[list[float], list[float]]]] = {}  # x and y by body and law
    with open(table, newline="") as file:
        for row in csv.DictReader(file):
            curve = curves.setdefault(row["body"], {}).setdefault(row["law"], ([], []))
            curve[0].append(float(row["kH"]))
            curve[1].append(float(row["growth_H_over_c_S"]))
    laws = list(dict.fromkeys(law for body in curves.values() for law in body))
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, layout="constrained", dpi=110)
    for axis, (body, of_law) in zip(axes, sorted(curves.items()), strict=True):
        for law, (x, y) in of_law.items():
            # Delay of strength and of pressure agree where there is no slope: dashes show both.
            style = "--" if "pressure" in law else "-"
            axis.loglog(x, y, style, color=f"C{laws.index(law)}", label=law)
        axis.set(title=body, xlabel="k H")
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("fastest growth Re s H / c_S")
    handles = {label: h for axis in axes for h, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    axes[1].legend([handles[law] for law in laws], laws, fontsize=7)
    axes[0].set_ylim(1e-2, 1e5)
    write_figure(picture, figure)


if __name__ == "__main__":
    sys.exit(run(__file__, lambda: main(*map(Path, sys.argv[1:3]))))
