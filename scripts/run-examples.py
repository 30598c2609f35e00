# SPDX-License-Identifier: BSD-3-Clause
"""Runs the worked cases of examples/ whole and draws their pictures.

usage: run-examples.py PROGRAM RESULTS FIGURES [NAME]..."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from slipfront.figures import rupture, sequence
from slipfront.figures.drawing import write_results
from slipfront.read import is_sequence

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def main() -> int:
    parser = argparse.ArgumentParser(
        description="Runs the worked cases of examples/ and draws their pictures."
    )
    parser.add_argument("program")
    parser.add_argument("results", type=Path, help="a folder for each case is made in it")
    parser.add_argument("figures", type=Path, help="example_NAME.png is written there")
    parser.add_argument(
        "names", nargs="*", default=sorted(f.parent.name for f in EXAMPLES.glob("*/case.toml"))
    )
    options = parser.parse_args()
    for name in options.names:
        folder = options.results / name
        folder.parent.mkdir(parents=True, exist_ok=True)
        command = [options.program, "run", EXAMPLES / name / "case.toml", "-o", folder, "--overwrite"]
        done = subprocess.run(command, check=False)
        if done.returncode != 0:
            return done.returncode
        draw = sequence.draw if is_sequence(folder) else rupture.draw
        write_results(options.figures / f"example_{name.replace('-', '_')}.png", folder, draw)
    return 0


if __name__ == "__main__":
    sys.exit(main())
