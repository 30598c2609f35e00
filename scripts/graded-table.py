#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Front speeds in docs/mesh.md: V_tip of an event on graded plates against a uniform one, processor time.

    scripts/graded-table.py build/release/slipfront papers/kammer2012/left.toml

V_tip is compared node by node along the main front, away from the trigger and the edges. Times are the least
of the repetitions: of the whole command (statics, event, files) and, from run.json, of the event's steps.
"""

import argparse
import csv
import json
import os
import pathlib
import resource
import subprocess
import tempfile
from typing import Any

# Where the main front is compared: clear of the trigger zone with its margin, and of the far edge.
FROM_M, TO_M = 0.04, 0.19
Speeds = dict[float, float]  # V_tip by place
WIDTH_M = 0.2
SIZES_M = (2e-3 / 3, 1e-3 / 3)
GRADINGS: tuple[tuple[str, dict[str, str]], ...] = (
    ("uniform", {}),
    ("uniform, single precision", {"time.precision": "single"}),
    ("1 doubling above 10 mm", {"plate.coarsenings": "1"}),
    ("2 doublings above 10 mm", {"plate.coarsenings": "2"}),
    ("3 doublings above 10 mm", {"plate.coarsenings": "3"}),
    ("2 doublings above 5 mm", {"plate.coarsenings": "2", "plate.fine_height_m": "5e-3"}),
    ("2 doublings above 10 mm, one step", {"plate.coarsenings": "2", "time.local_steps": "false"}),
)


def run(
    program: str, case: str, settings: dict[str, str], folder: str, repetitions: int
) -> tuple[Speeds, dict[str, Any], float, float]:
    """V_tip by place, run.json, and the least processor times."""
    command = [program, "run", case, "-q", "--overwrite", "--threads", "1", "-o", folder]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    total_s, event_s = [], []
    for _ in range(repetitions):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        environment = os.environ | {"OMP_NUM_THREADS": "1"}
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        total_s.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
        summary = json.loads((pathlib.Path(folder) / "run.json").read_text())
        event_s.append(summary["wall_s"])
    fronts: dict[str, list[dict[str, str]]] = {}
    with open(pathlib.Path(folder) / "fronts.csv", encoding="utf-8") as file:
        for point in csv.DictReader(file):
            fronts.setdefault(point["front_id"], []).append(point)
    main = max(fronts.values(), key=len)
    speeds = {round(float(p["x_m"]), 9): float(p["v_tip_m_per_s"]) for p in main if p["v_tip_m_per_s"]}
    return speeds, summary, min(total_s), min(event_s)


def errors(speeds: Speeds, reference: Speeds) -> list[float]:
    """Median, 90th percentile and largest relative difference, in per cent."""
    e = sorted(abs(v / reference[x] - 1) for x, v in speeds.items() if x in reference and FROM_M < x < TO_M)
    return [100 * e[len(e) // 2], 100 * e[9 * len(e) // 10], 100 * e[-1]]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program")
    parser.add_argument("case")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument(
        "--sizes", type=float, nargs="+", default=SIZES_M, help="element sizes at the interface, m"
    )
    options = parser.parse_args()
    print(
        "| h at the interface | plate | nodes | largest step over the lowest | median error of V_tip | "
        "90 % below | largest | event (s) | whole run (s) |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for size_m in options.sizes:
            reference = None
            for name, settings in GRADINGS:
                columns = round(WIDTH_M / size_m)
                if columns % 2 ** int(settings.get("plate.coarsenings", 0)):
                    continue
                speeds, summary, total_s, event_s = run(
                    options.program,
                    options.case,
                    {"plate.element_size_m": repr(size_m)} | settings,
                    folder,
                    options.repetitions,
                )
                step = round(summary["dt_s"] / summary["stable_dt_s"] / 0.9)
                if reference is None:
                    reference = speeds
                    shown = " | | "
                else:
                    shown = " | ".join(f"{e:.3f} %" for e in errors(speeds, reference))
                print(
                    f"| {1e3 * size_m:.3f} mm | {name} | {summary['mesh']['nodes']} | {step} | {shown} | "
                    f"{event_s:.2f} | {total_s:.2f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
