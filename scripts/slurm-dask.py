# SPDX-License-Identifier: BSD-3-Clause
"""Dask workers as Slurm's jobs, for `slipfront sweep --scheduler ADDRESS`: the address comes into a file.

`slurm-dask.py LOGS FILE` runs until it is ended; on another cluster change the resources below."""

import signal
import sys
from pathlib import Path

from dask_jobqueue.slurm import SLURMCluster

N_WORKERS = 2


def main(logs: str, file: str) -> None:
    with SLURMCluster(
        cores=1,
        processes=1,
        memory="1 GB",
        walltime="00:10:00",
        log_directory=logs,
        local_directory=logs,
        python=sys.executable,
        scheduler_options={"dashboard_address": "127.0.0.1:0"},
    ) as cluster:
        cluster.scale(N_WORKERS)
        Path(file).write_text(cluster.scheduler_address)
        signal.pause()


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    main(*sys.argv[1:])
