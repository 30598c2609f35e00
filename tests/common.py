# SPDX-License-Identifier: BSD-3-Clause
"""What tests of several folders need: programs as users run them, how they end, what their folders hold."""

import contextlib
import csv
import importlib.util
import io
import json
import os
import re
import runpy
import signal
import subprocess
import sys
import time
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[1]
#: What takes longer hangs.
HANG_S = 900
#: Python's environment with this source tree's package.
WITH_PACKAGE = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "SLIPFRONT_PYTHON": sys.executable}

#: Elements of 5 mm: a run takes a few hundredths of a second.
COARSE = """\
title = "coarse"

[plate]
width_m = 0.2
height_m = 0.1
element_size_m = 5e-3
corner = "relief"

[base]
kind = "rigid"

[loading]
tilt_left_m = 0.37e-3
tilt_right_m = 0.037e-3

[friction]
law = "velocity_weakening"
mu_s = 1.3
mu_k = 0.6
"""

#: Runs a command, and prints its peak of resident memory, B. What its parent held when it was forked counts
#: as its own: this one, which is small, stands between. Linux gives kB.
PEAK_BYTES = """\
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def built(variable="SLIPFRONT", place="build/release/slipfront"):
    """Path of a program: that of an environment variable, or where a build puts it."""
    path = Path(os.environ.get(variable, ROOT / place)).resolve()
    assert path.is_file() and os.access(path, os.X_OK), (
        f"no program: build {path}, or set {variable} to another"
    )
    return path


def loaded_script(path):
    """A script of this tree as a module."""
    spec = importlib.util.spec_from_file_location(Path(path).stem.replace("-", "_"), ROOT / path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where its data classes look for their names
    spec.loader.exec_module(module)
    del sys.modules[spec.name]
    return module


def as_from_a_terminal():
    """In the background of a shell some signals are ignored, and the program leaves them so."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for each in (signal.SIGQUIT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(each, signal.SIG_DFL)


def start(*command, **options):
    """A process whose output is read as text."""
    streams = {
        "stdin": subprocess.DEVNULL,
        "stdout": subprocess.PIPE,
        "stderr": subprocess.PIPE,
        "text": True,
    }
    return subprocess.Popen(list(map(str, command)), **streams | options)


def finished(process):
    """Waits for a process. What hangs is ended, and fails the test. @return as of subprocess.run"""
    try:
        out, err = process.communicate(timeout=HANG_S)
    except subprocess.TimeoutExpired:
        process.terminate()  # mpirun ends its processes, too
        try:
            out, err = process.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
        raise AssertionError(f"did not end within {HANG_S} s: {process.args}\n{out}\n{err}") from None
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def call(*command, **options):
    with start(*command, **options) as process:
        return finished(process)


def call_script(path, *arguments):
    """A script of this tree as it is run by itself, but in this process. @return as of subprocess.run"""
    command, out, err = [str(ROOT / path), *map(str, arguments)], io.StringIO(), io.StringIO()
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        mock.patch.object(sys, "argv", command),
    ):
        try:
            runpy.run_path(command[0], run_name="__main__")
            code = 0
        except SystemExit as end:
            code = end.code
    return subprocess.CompletedProcess(command, code, out.getvalue(), err.getvalue())


def require_done(result):
    assert result.returncode == 0, f"{result.args}\n{result.stderr}"
    return result


def one_line(result, *codes):
    """The only line on standard error of a call that ended with one of these codes."""
    lines = result.stderr.splitlines()
    assert result.returncode in codes and len(lines) == 1, result
    return lines[0]


def refusal(result):
    """The same of what the user did wrong: nothing is printed."""
    line = one_line(result, 2)
    assert not result.stdout, result
    return line


def wait_until(condition, process=None):
    """Without the process, if there is one, ending before."""
    end = time.monotonic() + HANG_S
    while not condition():
        assert process is None or process.poll() is None, "ended before"
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.002)


def wait_until_or_over(condition, process):
    wait_until(lambda: process.poll() is not None or condition())


def freeze(process):
    """Lets a process stand still, with all its threads, until SIGCONT. @return False where it is over"""
    process.send_signal(signal.SIGSTOP)
    if process.returncode is not None:
        return False
    state = os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
    return state.si_code == os.CLD_STOPPED


def catches_interrupts(pid):
    """Whether a process has taken SIGINT into its own hands (Linux)."""
    status = Path(f"/proc/{pid}/status").read_text()
    caught = int(re.search(r"^SigCgt:\s*([0-9a-f]+)", status, re.MULTILINE)[1], 16)
    return bool(caught >> (signal.SIGINT - 1) & 1)


def settings(values):
    """Options that set keys of a case."""
    text = {key: f'"{value}"' if isinstance(value, str) else repr(value) for key, value in values.items()}
    return [part for key, value in text.items() for part in ("--set", f"{key}={value}")]


def sets(*assignments):
    """The same of texts KEY=VALUE."""
    return [part for text in assignments for part in ("--set", text)]


def run_json(folder):
    return json.loads((folder / "run.json").read_text())


def notes_of(info):
    """Texts of the notes in a run.json or sequence.json."""
    return [note["text"] for note in info["notes"]]


def rows_of(file):
    """Rows of a table, by the names of its columns."""
    with open(file, newline="") as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def require_same_bytes(a, b, *names):
    """Files of two folders."""
    for name in names:
        assert (a / name).read_bytes() == (b / name).read_bytes(), name
