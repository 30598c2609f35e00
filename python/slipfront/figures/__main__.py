# SPDX-License-Identifier: BSD-3-Clause
"""`python -m slipfront.figures DIR [--experiment CSV]`"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import matplotlib

from slipfront.figures import balance, convergence, criteria, events, plate, space_time, studies
from slipfront.figures.drawing import Drawing
from slipfront.figures.report import write_report
from slipfront.figures.results import Results, read_results
from slipfront.figures.style import RC
from slipfront.read import DataError


# Folders with a figure of their own, told by a file.
SINGLE = {"convergence.json": convergence.convergence, "energy.csv": balance.balance_of_run}


def draw_all(results: Results) -> list[Drawing]:
    """Every figure, in the order of the report."""
    return [
        plate.setup(results),
        criteria.static_ratio_mu_k(results),
        events.three_events(results),
        criteria.dynamic_ratio_along_x(results),
        criteria.dynamic_criterion(results),
        criteria.energy(results),
        *(space_time.space_time(results, name) for name in results.runs),
        balance.balance(results),
        *([studies.speeds(results), studies.criteria(results)] if results.studies else []),
    ]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m slipfront.figures",
        description="Draws the figures (PNG, PDF) and the report (HTML) of a reproduction, the figure of a "
        "convergence study, or the energy balance of a single run, into DIR/figures.",
    )
    parser.add_argument(
        "dir",
        metavar="DIR",
        type=Path,
        help="output folder of `slipfront reproduce`, `slipfront study convergence` or `slipfront run`",
    )
    parser.add_argument(
        "--experiment",
        metavar="CSV",
        type=Path,
        help="measured points to draw into figure 2: columns static_ratio and v_over_c_L or v_m_per_s",
    )
    options = parser.parse_args(arguments)
    folder = options.dir / "figures"
    try:
        for file, draw in SINGLE.items():
            if not (options.dir / file).is_file():
                continue
            with matplotlib.rc_context(RC):
                drawing = draw(options.dir)
                folder.mkdir(exist_ok=True)
                drawing.save(folder)
            print(f"figure: {folder / drawing.name}.png (and PDF)")
            return 0
        results = read_results(options.dir, options.experiment)
        with matplotlib.rc_context(RC):
            drawings = draw_all(results)
            folder.mkdir(exist_ok=True)
            for drawing in drawings:
                drawing.save(folder)
        report = write_report(results, drawings, folder)
    except DataError as error:
        print(f"slipfront.figures: error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"slipfront.figures: error: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    print(f"figures: {folder} ({len(drawings)}, each as PNG and PDF)")
    print(f"report:  {report}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
