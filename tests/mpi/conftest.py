# SPDX-License-Identifier: BSD-3-Clause
"""The program that is built with MPI, started as several processes. Its path is the environment variable
SLIPFRONT_MPI."""

import contextlib
import os
import signal
import subprocess
from pathlib import Path

import pytest
from hostile.trials import HANG_S, as_from_a_terminal

ROOT = Path(__file__).resolve().parents[2]

as_from_a_terminal()

# Open MPI refuses root otherwise.
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Mpirun:
    """Runs the program as n processes in a folder of its own: `mpirun(2, "run", case, "-o", "out")`."""

    def __init__(self, program, folder):
        self.program = program
        self.folder = folder

    def __call__(self, n, *arguments, **options):
        """@return as of subprocess.run, with text; what hangs is ended, and fails the test"""
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
        with self.start(n, *arguments, **options) as process:
            return finished(process)

    def start(self, n, *arguments, programs=None, starter=(), **options):
        """`starter` are options of mpirun. Of `programs`, its own options before it, each is one process."""
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", *starter]
        if programs is None:
            command += ["-n", n, self.program, *arguments]
        else:
            for k, program in enumerate(programs):
                command += [*([":"] if k else []), "-n", 1, *program, *arguments]
        options = {"stdin": subprocess.DEVNULL, "text": True} | options
        return subprocess.Popen(
            list(map(str, command)),
            cwd=self.folder,
            env=os.environ | AS_ROOT,
            **options,
        )

    def alone(self, *arguments):
        """The same program, as one process without mpirun."""
        return subprocess.run(
            [self.program, *map(str, arguments)],
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=HANG_S,
            stdin=subprocess.DEVNULL,
        )

    def processes(self):
        """Those of this program that mpirun has started here: their ids by their ranks."""
        found = {}
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                if (folder / "exe").readlink() == self.program and (folder / "cwd").readlink() == self.folder:
                    settings = (folder / "environ").read_bytes().split(b"\0")
                    rank = next(s for s in settings if s.startswith(b"OMPI_COMM_WORLD_RANK="))
                    found[int(rank.split(b"=")[1])] = int(folder.name)
            except (OSError, StopIteration):
                pass  # ended meanwhile, or another one
        return found


def finished(process):
    """Waits for an mpirun; fails the test if it hangs."""
    try:
        out, err = process.communicate(timeout=HANG_S)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGTERM)  # ends its processes, too
        try:
            out, err = process.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
        pytest.fail(f"did not end within {HANG_S} s\n{out}\n{err}", pytrace=False)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def send(pid, signal_number):
    """To a process that may have ended; to none where there was none."""
    if pid is not None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal_number)


@pytest.fixture
def mpirun(tmp_path):
    path = Path(os.environ.get("SLIPFRONT_MPI", ROOT / "build/mpi/slipfront")).resolve()
    if not (path.is_file() and os.access(path, os.X_OK)):
        pytest.fail(
            f"{path} is no program: make build-mpi builds it, or set SLIPFRONT_MPI to its path", pytrace=False
        )
    return Mpirun(path, tmp_path)
