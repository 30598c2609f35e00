# SPDX-License-Identifier: BSD-3-Clause
"""What the size of the elements moves: the best run once more with half of it. The values of all points are
taken to change as those of the best run do, so that the posterior of the records less that change is about
what runs of the finer mesh give."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slipfront.files import DataError, read_toml
from slipfront.fit.fitting import LAST_STEPS, RUNS, Fitting, Ran, Result
from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep, flattened
from slipfront.sweep.points import made
from slipfront.sweep.sweeping import carry_out

KEY = "plate.element_size_m"
FOLDER = "finer"


@dataclass(frozen=True)
class Finer:
    """The posterior that a finer mesh is expected to give, within what the runs have covered."""

    element_size_m: float
    samples: np.ndarray  # shares [samples, keys]


def finer_of(fitting: Fitting, result: Result) -> Finer | str:
    """Or why there is none."""
    best = result.best
    case = flattened(read_toml(places.place_of(fitting.folder / RUNS, best.point) / places.CASE))
    half_m = 0.5 * float(case[KEY])
    if KEY in result.space.keys:
        return f"{KEY} is free"
    if not result.agrees:
        return "runs and what was expected of them do not agree"
    settings = {key: value for key, value in fitting.settings.items() if key != KEY}
    values = best.point.values | {KEY: half_m}
    (point,) = made(values, [values.values()])
    folder = fitting.folder / FOLDER
    # With another --most another run may be the best.
    points = {one.words: one for one in (*places.points_in(folder), point)}
    sweep = Sweep.of_points(fitting.case, points.values(), settings)
    fitting.how.tell(f"mesh: the best run with {KEY} = {half_m:g}")
    try:
        if carry_out(sweep, folder, replace(fitting.how, quiet=True, is_checked=False)).is_interrupted:
            raise KeyboardInterrupt
    except DataError as error:
        return str(error)
    ran = Ran(point, best.share)
    fitting.observe(ran, folder)
    if ran.why_not:
        return ran.why_not
    fitting.find_parts()
    before, after = fitting.computed([best]), fitting.computed([ran])
    if not all(np.isfinite(values).all() for values in after):
        return "it has no front where the record has one"
    moved = [
        replace(part, measured=part.measured - (finer[0] - coarser[0]))
        for part, coarser, finer in zip(fitting.parts, before, after, strict=True)
    ]
    samples, _ = fitting.sample(*fitting.trained(moved), LAST_STEPS)
    return Finer(half_m, samples)
