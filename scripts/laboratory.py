# SPDX-License-Identifier: BSD-3-Clause
"""Renews the pictures of docs/recorder-to-gamma.md and docs/compare.md from examples/laboratory.

usage: python scripts/laboratory.py [FOLDER] [--program SLIPFRONT]"""

import argparse
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[1]
LAB = ROOT / "examples/laboratory"
FIGURES = ROOT / "docs/figures"
WINDOW = "--channels {lab}/channels.csv --trigger trig --before-s 1e-3 --after-s 90e-6 --zero-s=-1e-3,-200e-6"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, help="where to work")
    parser.add_argument("--program", default="slipfront")
    options = parser.parse_args()
    with TemporaryDirectory() as temporary:
        folder = options.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)

        def call(*words: object) -> None:
            here = os.environ | {"PYTHONPATH": str(ROOT / "python")}
            subprocess.run([str(word) for word in words], check=True, cwd=folder, env=here)

        def slipfront(command: str) -> None:
            call(options.program, *command.format(lab=LAB, figures=FIGURES).split())

        slipfront("run {lab}/rosettes.toml -q --overwrite -o out")
        call(sys.executable, LAB / "recorder.py", "out", "daq.h5")
        slipfront(f"records daq.h5 {WINDOW} -o records.nc")
        slipfront("picks records.nc -o picks.csv --figure {figures}/record_section.png")
        onsets = " ".join(str(file) for file in sorted((LAB / "onsets").glob("*.csv")))
        slipfront(f"fronts {onsets} --place-error-m 5e-3 --figure {{figures}}/series.png")
        slipfront("run {lab}/machine.toml -q --overwrite -o machine")
        slipfront("compare machine {lab}/events.csv -o {figures}/stick_slip_compared.png")


if __name__ == "__main__":
    main()
