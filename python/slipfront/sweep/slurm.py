# SPDX-License-Identifier: BSD-3-Clause
"""A script for an array of Slurm jobs, each of which runs a share of the points."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from slipfront.sweep import folder as places
from slipfront.sweep.definition import Sweep
from slipfront.sweep.needs import needs_of, require_disk, require_valid
from slipfront.sweep.program import GIGA, VARIABLE, find_program

MOST_JOBS = 100
SPARE = 3  # times the expected time, since machines differ
LEAST_MINUTES = 10
MEGA = 1e6
WORKER_BYTES = 0.15 * GIGA  # of the sweep itself in a job

TEXT = """\
#!/bin/bash
# {title}: {n_points} points in {n_jobs} shares. Submit with
#   sbatch {script}
# and when the array has ended, make the tables (it runs points that a job did not come to):
#   {collect}
#SBATCH --job-name=slipfront-sweep
#SBATCH --array=1-{n_jobs}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem={memory_mb}M
#SBATCH --time={minutes}
#SBATCH --output={log}
#SBATCH --signal=B:TERM@60
#SBATCH --requeue
export {variable}={program}
export PYTHONPATH={package}
# exec: Slurm's warning 60 s before the time is up is the sweep's; a job that runs again goes on.
exec {share}
"""


def array_script(sweep: Sweep, folder: Path, script: Path) -> list[str]:
    """Checks all points, writes the folder's definition and the script; returns what to print."""
    sweep.require_sound()
    program = find_program()
    identity = places.identity_of(sweep, program)
    places.require_usable(folder, sweep, identity)
    points = sweep.points()
    require_valid(sweep, program, points, quiet=False)
    n_jobs = min(MOST_JOBS, len(points))
    needs = needs_of(sweep, program, points, n_jobs)
    require_disk(needs, folder)
    python = [sys.executable, "-m", "slipfront", "sweep", "--restart", str(folder.resolve())]
    package = shlex.quote(str(Path(__file__).resolve().parents[2]))
    text = TEXT.format(
        title=sweep.case.name,
        n_points=len(points),
        n_jobs=n_jobs,
        script=script,
        collect=f"PYTHONPATH={package} {shlex.join(python)}",
        memory_mb=int((needs.memory_bytes / n_jobs + WORKER_BYTES) / MEGA) + 1,
        minutes=max(LEAST_MINUTES, int(SPARE * needs.time_s / n_jobs / 60) + 1),
        log=shlex.quote(str(folder.resolve() / "slurm-%a.log")),
        variable=VARIABLE,
        program=shlex.quote(str(program)),
        package=package,
        share=f'{shlex.join(python)} --quiet --share "$SLURM_ARRAY_TASK_ID/{n_jobs}"',
    )
    with places.held(folder):
        places.write_definition(folder, sweep, identity)
    places.write_whole(script, text)
    return [f"script: {script}, {n_jobs} jobs; submit it with sbatch"]
