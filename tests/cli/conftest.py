# SPDX-License-Identifier: BSD-3-Clause
"""The built program, run as a user runs it. Its path is the environment variable SLIPFRONT."""

import os
import resource
import signal
import threading

import pytest
from common import COARSE, HANG_S, as_from_a_terminal, built, finished, start

as_from_a_terminal()


class Program:
    """Runs the program in a folder of its own."""

    def __init__(self, folder):
        self.path = built()
        self.folder = folder
        self.started = []

    def __call__(self, *arguments, memory_bytes=None, data_bytes=None, file_bytes=None, stack_bytes=None):
        def limit():
            if stack_bytes:
                resource.setrlimit(resource.RLIMIT_STACK, (stack_bytes, stack_bytes))
            if memory_bytes:
                resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
            if data_bytes:
                resource.setrlimit(resource.RLIMIT_DATA, (data_bytes, data_bytes))
            if file_bytes:
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writing fails instead
                resource.setrlimit(resource.RLIMIT_FSIZE, (file_bytes, file_bytes))

        return finished(self.start(*arguments, preexec_fn=limit))

    def start(self, *arguments, **options):
        """What has not ended by the end of the test is killed."""
        self.started.append(start(self.path, *arguments, cwd=self.folder, **options))
        return self.started[-1]


@pytest.fixture
def program(tmp_path):
    program = Program(tmp_path)
    yield program
    for process in program.started:
        process.kill()
        process.wait()


@pytest.fixture
def write_case(tmp_path):
    def write(text, name="case.toml"):
        case = tmp_path / name
        case.write_bytes(text if isinstance(text, bytes) else text.encode())
        return case

    return write


@pytest.fixture
def coarse(write_case):
    """A case file that takes a moment to run."""
    return write_case(COARSE, "coarse.toml")


@pytest.fixture
def pipe(tmp_path):
    """Makes a pipe in the file system that gives a text to the first who reads it."""
    writers = []

    def make(name, text):
        path = tmp_path / name
        os.mkfifo(path)
        writers.append(threading.Thread(target=lambda: path.write_text(text), daemon=True))
        writers[-1].start()
        return path

    yield make
    for writer in writers:
        writer.join(timeout=HANG_S)
        assert not writer.is_alive(), "nobody read the pipe"
