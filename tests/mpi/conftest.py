# SPDX-License-Identifier: BSD-3-Clause
"""The program that is built with MPI, started as several processes. Its path is the environment variable
SLIPFRONT_MPI."""

import contextlib
import os
import re
import subprocess
from pathlib import Path

import pytest
from common import as_from_a_terminal, built, call, finished, start

as_from_a_terminal()

# Open MPI refuses root otherwise.
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
# What mpirun, and not the program, says; it names the program's node before what its libraries tell.
OF_MPIRUN = re.compile(
    r"^(-{10,}|mpirun|\[|Primary job|a non-zero exit|the job to be terminated|\s*(Process name|Exit code):"
    r"|MPI_ABORT|with errorcode|NOTE: invoking|You may or may not|exactly when|$)"
)


def own(result):
    """A result without mpirun's lines on standard error."""
    lines = [line for line in result.stderr.splitlines() if not OF_MPIRUN.match(line)]
    return subprocess.CompletedProcess(result.args, result.returncode, result.stdout, "\n".join(lines))


class Mpirun:
    """Runs the program as n processes in a folder of its own: `mpirun(2, "run", case, "-o", "out")`."""

    def __init__(self, folder):
        self.program = built("SLIPFRONT_MPI", "build/mpi/slipfront")
        self.folder = folder

    def __call__(self, *arguments, **options):
        """@return as of subprocess.run; what hangs is ended, and fails the test"""
        with self.start(*arguments, **options) as process:
            return finished(process)

    def start(self, n, *arguments, programs=None, starter=(), **options):
        """`starter` are options of mpirun. Of `programs`, its own options before it, each is one process."""
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", *starter]
        if programs is None:
            command += ["-n", n, self.program, *arguments]
        else:
            for k, program in enumerate(programs):
                command += [*([":"] if k else []), "-n", 1, *program, *arguments]
        return start(*command, cwd=self.folder, env=os.environ | AS_ROOT, **options)

    def alone(self, *arguments):
        """The same program, as one process without mpirun."""
        return call(self.program, *arguments, cwd=self.folder)

    def processes(self):
        """Those of this program that mpirun has started here: their ids by their ranks."""
        found = {}
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError, StopIteration):  # ended meanwhile, or another one
                if (folder / "exe").readlink() == self.program and (folder / "cwd").readlink() == self.folder:
                    settings = (folder / "environ").read_bytes().split(b"\0")
                    rank = next(s for s in settings if s.startswith(b"OMPI_COMM_WORLD_RANK="))
                    found[int(rank.split(b"=")[1])] = int(folder.name)
        return found


def send(pid, signal_number):
    """To a process that may have ended; to none where there was none."""
    if pid is not None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal_number)


@pytest.fixture
def mpirun(tmp_path):
    return Mpirun(tmp_path)
