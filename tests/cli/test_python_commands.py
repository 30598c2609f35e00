# SPDX-License-Identifier: BSD-3-Clause
"""Subcommands that are Python modules: the interpreter that is chosen, and what it gets and gives."""

import os
import shutil
import signal
import subprocess
import sys

import pytest
from conftest import ROOT
from hostile.trials import HANG_S
from test_commands import PYTHON_COMMANDS, one_line

ECHO = '#!/bin/sh\nshift 2\nprintf "%s|" "$@"\nprintf "%s" "$PYTHONPATH"\n'


@pytest.fixture
def interpreter(tmp_path, monkeypatch):
    """Makes a script the interpreter."""

    def make(text):
        script = tmp_path / "interpreter"
        script.write_text(text)
        script.chmod(0o755)
        monkeypatch.setenv("SLIPFRONT_PYTHON", str(script))
        return script

    return make


@pytest.fixture
def elsewhere(program, tmp_path):
    """The program outside its source tree."""
    program.path = shutil.copy(program.path, tmp_path / "slipfront")
    return program


def in_tree(program):
    """Whether the program under test lies where a build puts it."""
    return program.path.parents[1].name == "build" and (program.path.parents[2] / "python/slipfront").is_dir()


@pytest.mark.parametrize("command", PYTHON_COMMANDS)
def test_arguments_are_passed_on_as_they_are(program, interpreter, monkeypatch, command):
    interpreter(ECHO)
    monkeypatch.setenv("PYTHONPATH", "/mine")
    arguments = ["--help", "a b", "-o", "", "--", "--set", "*", "ä"]
    result = program(command, *arguments)
    assert result.returncode == 0
    *passed, path = result.stdout.split("|")
    assert passed == [command, *arguments]
    first = f"{program.path.parents[2] / 'python'}:" if in_tree(program) else ""
    assert path == first + "/mine"


def test_outside_its_tree_the_program_leaves_the_path_alone(elsewhere, interpreter, monkeypatch):
    interpreter(ECHO)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    assert elsewhere("report", "DIR").stdout == "report|DIR|"


def test_without_a_name_python3_of_the_path_is_taken(elsewhere, tmp_path, monkeypatch):
    monkeypatch.delenv("SLIPFRONT_PYTHON", raising=False)
    (tmp_path / "bin").mkdir()
    python = tmp_path / "bin/python3"
    python.write_text("#!/bin/sh\necho mine\n")
    python.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}:{os.environ['PATH']}")
    assert elsewhere("report", "DIR").stdout == "mine\n"


@pytest.mark.parametrize("code", [0, 77])
def test_exit_codes_are_the_modules(program, interpreter, code):
    interpreter(f"#!/bin/sh\nexit {code}\n")
    assert program("report", "DIR").returncode == code


def test_signals_are_the_modules(program, interpreter):
    interpreter("#!/bin/sh\nkill -TERM $$\n")
    assert program("report", "DIR").returncode == -signal.SIGTERM


def test_an_interpreter_that_is_not_there_is_told(program, monkeypatch):
    monkeypatch.setenv("SLIPFRONT_PYTHON", "/nonexistent/python")
    line = one_line(program("report", "DIR"))
    assert "/nonexistent/python cannot be started: No such file" in line and "SLIPFRONT_PYTHON" in line


def test_a_missing_package_is_told(elsewhere, interpreter, tmp_path, monkeypatch):
    interpreter(f'#!/bin/sh\nexec "{sys.executable}" -S "$@"\n')  # without installed packages
    monkeypatch.delenv("PYTHONPATH", raising=False)
    elsewhere.folder = tmp_path / "here"
    (elsewhere.folder / "slipfront").mkdir(parents=True)  # results of that name are no package
    line = one_line(elsewhere("report", "DIR"))
    assert "report needs the Python package slipfront" in line and "-m pip install ." in line


def test_a_source_tree_without_packages_names_its_target(program, tmp_path, monkeypatch):
    tree = tmp_path / "tree"
    (tree / "build/release").mkdir(parents=True)
    (tree / "python").mkdir()
    (tree / "python/slipfront").symlink_to(ROOT / "python/slipfront")
    shutil.copy(program.path, tree / "build/release/slipfront")
    python = tmp_path / "bin/python3"
    python.parent.mkdir()
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" -S "$@"\n')
    python.chmod(0o755)
    monkeypatch.setenv("PATH", f"{python.parent}:{os.environ['PATH']}")
    monkeypatch.delenv("SLIPFRONT_PYTHON", raising=False)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    program.path = tree / "build/release/slipfront"
    assert f"'make module' in {tree} installs them all" in one_line(program("report", "DIR"))


ONSETS = "x_m,time_s\n0,0\n1e-2,1e-5\n2e-2,2e-5\n"
SWEEP = ["sweep", "coarse.toml", "--vary", "friction.mu_k=0.5,0.6", "--share", "1/1", "-o", "sweep"]
TELLING = [["fronts", "onsets.csv"], ["report", "out"], SWEEP, ["sweep", "--restart", "done"]]
TELLING += [["sweep", "--help"]]


@pytest.fixture
def telling(program, coarse, monkeypatch):
    """The program among what its commands in Python work on."""
    monkeypatch.setenv("SLIPFRONT_PYTHON", sys.executable)
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))
    (program.folder / "onsets.csv").write_text(ONSETS)
    assert program("run", "coarse.toml", "-o", "out").returncode == 0
    assert program(*SWEEP[:-1], "done").returncode == 0
    return program


@pytest.mark.slow
@pytest.mark.parametrize("is_closed", [False, True], ids=["full", "closed"])
def test_standard_output_that_cannot_be_written(telling, is_closed):
    """Exit code 1 and one line, for whatever is printed; what a command writes into files is there."""
    for arguments in TELLING:
        reading, writing = os.pipe() if is_closed else (-1, os.open("/dev/full", os.O_WRONLY))
        if is_closed:
            os.close(reading)
        command = telling.start(*arguments, stdout=writing, stderr=subprocess.PIPE, text=True)
        os.close(writing)
        (line,) = command.communicate(timeout=HANG_S)[1].splitlines()
        assert command.returncode == 1, arguments
        why = "Broken pipe" if is_closed else "No space left on device"
        assert line == f"slipfront {arguments[0]}: error: standard output: {why}"
    assert (telling.folder / "out/report.html").is_file()
    assert (telling.folder / "done/sweep.csv").is_file()
    assert len(list(telling.folder.glob("sweep/points/*/run.json"))) == 2


def test_a_page_is_written(program, coarse, monkeypatch):
    monkeypatch.setenv("SLIPFRONT_PYTHON", sys.executable)
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))
    assert program("run", "coarse.toml", "-o", "out").returncode == 0
    result = program("report", "out", "-o", "page.html")
    assert (result.returncode, result.stderr) == (0, "")
    assert (program.folder / "page.html").read_text(encoding="utf-8").count("<section") > 0
    assert "no such folder" in one_line(program("report", "nothing"))
