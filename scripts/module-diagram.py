#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the modules of src/CMakeLists.txt and what they see, without what follows from other arrows: renews
docs/figures/modules.svg, or writes FILE. Usage: module-diagram.py [FILE]"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WIDTH, ROW, BOX = 760, 64, (104, 28)  # pixels


def seen_by_modules() -> dict[str, set[str]]:
    text = (ROOT / "src/CMakeLists.txt").read_text(encoding="utf-8")
    calls = re.findall(r"^slipfront_module\((\w+)([^)]*)\)", text, re.MULTILINE)
    return {name: set(rest.partition("SEES")[2].partition("USES")[0].split()) for name, rest in calls}


def draw(sees: dict[str, set[str]]) -> str:
    level: dict[str, int] = {}
    below: dict[str, set[str]] = {}  # all that a module sees, through others too
    for name, seen in sees.items():
        level[name] = 1 + max((level[other] for other in seen), default=-1)
        below[name] = seen.union(*(below[other] for other in seen))
    arrows = {
        name: sorted(other for other in seen if not any(other in below[way] for way in seen))
        for name, seen in sees.items()
    }
    n_rows = 1 + max(level.values())
    places: dict[str, tuple[float, float]] = {}
    for row in range(n_rows):
        names = [name for name in sees if level[name] == row]
        # Above the middle of what they see, as far as the order from left to right goes.
        names.sort(key=lambda name: sum(places[o][0] for o in arrows[name]) / max(1, len(arrows[name])))
        for k, name in enumerate(names):
            places[name] = ((k + 0.5) * WIDTH / len(names), (n_rows - row - 0.5) * ROW)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {n_rows * ROW}" '
        f'width="{WIDTH}" font-family="sans-serif" font-size="14" text-anchor="middle">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for name, others in arrows.items():
        x, y = places[name]
        for other in others:
            to_x, to_y = places[other]
            ends = f'x1="{x:.0f}" y1="{y + BOX[1] / 2:.0f}" x2="{to_x:.0f}" y2="{to_y - BOX[1] / 2:.0f}"'
            lines.append(f'<line {ends} stroke="#888"/>')
    for name, (x, y) in places.items():
        box = f'x="{x - BOX[0] / 2:.0f}" y="{y - BOX[1] / 2:.0f}" width="{BOX[0]}" height="{BOX[1]}"'
        lines.append(f'<rect {box} rx="4" fill="#eef3f8" stroke="#456"/>')
        lines.append(f'<text x="{x:.0f}" y="{y + 5:.0f}">{name}</text>')
    return "\n".join([*lines, "</svg>", ""])


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs/figures/modules.svg"
    target.write_text(draw(seen_by_modules()), encoding="utf-8")
