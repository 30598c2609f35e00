# SPDX-License-Identifier: BSD-3-Clause
"""Which d_c brings the onsets of case.toml nearest to those of record.csv?

usage: python compare.py DIR [--program SLIPFRONT] [--set KEY=VALUE]...
Runs the case into DIR for each of several d_c and prints the rms of onset less record. The record's clock
and the run's are aligned by their mean, since an experiment does not know when its rupture began."""

import argparse
import csv
import subprocess
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
D_C_M = (1.2e-6, 1.45e-6, 1.7e-6, 1.95e-6, 2.2e-6)


def read_columns(file: Path, *names: str) -> list[np.ndarray]:
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    return [np.array([float(row[name]) for row in rows]) for name in names]


def onsets_s(folder: Path, x_m: np.ndarray) -> np.ndarray:
    """Onsets of the front to +x at the places of the record; NaN where it has not come."""
    front_x_m, onset_s, direction = read_columns(folder / "fronts.csv", "x_m", "onset_s", "direction")
    right = direction > 0
    order = np.argsort(front_x_m[right])
    return np.interp(x_m, front_x_m[right][order], onset_s[right][order], left=np.nan, right=np.nan)


def misfit_s(folder: Path) -> float:
    x_m, time_s = read_columns(HERE / "record.csv", "x_m", "time_s")
    late_s = onsets_s(folder, x_m) - time_s
    return float(np.std(late_s))  # NaN where a place was not reached


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dir", type=Path)
    parser.add_argument("--program", default="slipfront")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    options = parser.parse_args()
    print("d_c (µm)  rms (µs)")
    for d_c_m in D_C_M:
        folder = options.dir / f"d_c_{d_c_m:g}"
        changes = [
            word for change in [f"friction.d_c_m={d_c_m:g}", *options.set] for word in ("--set", change)
        ]
        command = [options.program, "run", HERE / "case.toml", "-o", folder, "--overwrite", *changes]
        subprocess.run(command, check=True, capture_output=True)
        print(f"{1e6 * d_c_m:8.2f}  {1e6 * misfit_s(folder):8.2f}", flush=True)


if __name__ == "__main__":
    main()
