#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws reflection against angle: reflection_table > t.csv; scripts/reflection-figure.py t.csv picture.png"""

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from shared import checked, run, write_figure


def main(table: Path, picture: Path) -> None:
    checked(picture)
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True, layout="constrained", dpi=110)
    for axis, incident in zip(axes, ("longitudinal", "shear"), strict=True):
        for k, reflected in enumerate(("longitudinal", "shear", "energy")):
            for source, style in (("theory", "-"), ("measured", "o")):
                mine = [r for r in rows if r["incident"] == incident and r["source"] == source]
                x = [float(r["angle_deg"]) for r in mine]
                y = [float(r[reflected]) for r in mine]
                name = "energy" if reflected == "energy" else f"{reflected} amplitude"
                label = name if source == "theory" else None
                axis.plot(x, y, style, color=f"C{k}", markersize=4, lw=1, label=label)
        axis.set(title=f"{incident} wave", xlabel="angle of incidence (degrees)", xlim=(0, 90), ylim=(0, 1))
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("reflected over incident")
    axes[0].plot([], [], "ko", markersize=4, label="measured")
    axes[0].legend(fontsize=8)
    write_figure(picture, figure)


if __name__ == "__main__":
    sys.exit(run(__file__, lambda: main(*map(Path, sys.argv[1:3]))))
