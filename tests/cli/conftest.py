# SPDX-License-Identifier: BSD-3-Clause
"""The built program, run as a user runs it. Its path is the environment variable SLIPFRONT."""

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from hostile.trials import HANG_S, as_from_a_terminal

ROOT = Path(__file__).resolve().parents[2]

as_from_a_terminal()

# Elements of 5 mm: a run takes a few hundredths of a second.
COARSE = """\
title = "coarse"

[plate]
element_size_m = 5e-3

[friction]
law = "velocity_weakening"
mu_s = 1.3
mu_k = 0.6
"""

# A command's peak; Linux gives kB.
PEAK_BYTES = """\
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def settings(values):
    """Options that set keys of a case."""
    text = {key: f'"{value}"' if isinstance(value, str) else repr(value) for key, value in values.items()}
    return [part for key, value in text.items() for part in ("--set", f"{key}={value}")]


class Program:
    """Runs the program in a folder of its own."""

    def __init__(self, path, folder):
        self.path = path
        self.folder = folder
        self.started = []

    def __call__(self, *arguments, memory_bytes=None, file_bytes=None):
        def limit():
            if memory_bytes:
                resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
            if file_bytes:
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writing fails instead
                resource.setrlimit(resource.RLIMIT_FSIZE, (file_bytes, file_bytes))

        return subprocess.run(
            [self.path, *map(str, arguments)],
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=HANG_S,
            stdin=subprocess.DEVNULL,
            preexec_fn=limit,
        )

    def start(self, *arguments, **options):
        """What has not ended by the end of the test is killed."""
        process = subprocess.Popen(
            [self.path, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL, **options
        )
        self.started.append(process)
        return process

    def peak_bytes(self, *arguments) -> int:
        """Resident memory of a run at its peak. A process counts what its parent held when it was forked as
        its own: a small one between this one and the program keeps that out."""
        told = subprocess.run(
            [sys.executable, "-c", PEAK_BYTES, self.path, *map(str, arguments)],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            check=True,
            timeout=HANG_S,
        )
        return int(told.stdout.splitlines()[-1])


@pytest.fixture
def program(tmp_path):
    path = Path(os.environ.get("SLIPFRONT", ROOT / "build/release/slipfront")).resolve()
    if not (path.is_file() and os.access(path, os.X_OK)):
        pytest.fail(
            f"{path} is no program: build it (cmake --preset release && cmake --build --preset release) "
            "or set SLIPFRONT to its path",
            pytrace=False,
        )
    program = Program(path, tmp_path)
    yield program
    for process in program.started:
        process.kill()
        process.wait()


@pytest.fixture
def coarse(tmp_path):
    """A case file that takes a moment to run."""
    case = tmp_path / "coarse.toml"
    case.write_text(COARSE)
    return case


@pytest.fixture
def write_case(tmp_path):
    def write(text, name="case.toml"):
        case = tmp_path / name
        case.write_bytes(text if isinstance(text, bytes) else text.encode())
        return case

    return write
