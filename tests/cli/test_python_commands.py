# SPDX-License-Identifier: BSD-3-Clause
"""Subcommands that are Python modules: the interpreter that is chosen, and what it gets and gives."""

import os
import shutil
import signal
import sys

import pytest
from common import ROOT, finished, one_line, refusal, require_done
from test_commands import PYTHON_COMMANDS, PYTHON_STUDIES

ECHO = '#!/bin/sh\nshift 2\nprintf "%s|" "$@"\nprintf "%s" "$PYTHONPATH"\n'
BARE = f'#!/bin/sh\nexec "{sys.executable}" -S "$@"\n'  # without installed packages


@pytest.fixture
def interpreter(tmp_path, monkeypatch):
    """Makes a script the interpreter: the one that is named, or python3 of the path."""

    def make(text, is_named=True):
        script = tmp_path / "bin/python3"
        script.parent.mkdir()
        # A named one is asked first whether it runs Python.
        script.write_text(text.replace("\n", f'\n[ $# = 2 ] && exec "{sys.executable}" "$@"\n', 1))
        script.chmod(0o755)
        if is_named:
            monkeypatch.setenv("SLIPFRONT_PYTHON", str(script))
        else:
            monkeypatch.delenv("SLIPFRONT_PYTHON", raising=False)
            monkeypatch.setenv("PATH", f"{script.parent}:{os.environ['PATH']}")

    return make


@pytest.fixture
def elsewhere(program, tmp_path):
    """The program outside its source tree."""
    program.path = shutil.copy(program.path, tmp_path / "slipfront")
    return program


def in_tree(program):
    """Whether the program under test lies where a build puts it."""
    return program.path.parents[1].name == "build" and (program.path.parents[2] / "python/slipfront").is_dir()


@pytest.mark.parametrize("command", PYTHON_COMMANDS + PYTHON_STUDIES)
def test_arguments_are_passed_on_as_they_are(program, interpreter, monkeypatch, command):
    interpreter(ECHO)
    monkeypatch.setenv("PYTHONPATH", "/mine")
    arguments = ["--help", "a b", "-o", "", "--", "--set", "*", "ä"]
    *passed, path = require_done(program(*command.split(), *arguments)).stdout.split("|")
    assert passed == [*command.split(), *arguments]
    first = f"{program.path.parents[2] / 'python'}:" if in_tree(program) else ""
    assert path == first + "/mine"


def test_outside_its_tree_the_program_leaves_the_path_alone(elsewhere, interpreter, monkeypatch):
    interpreter(ECHO)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    assert elsewhere("report", "DIR").stdout == "report|DIR|"


def test_without_a_name_python3_of_the_path_is_taken(elsewhere, interpreter):
    interpreter("#!/bin/sh\necho mine\n", is_named=False)
    assert elsewhere("report", "DIR").stdout == "mine\n"


@pytest.mark.parametrize("script, code", [("exit 77", 77), ("kill -TERM $$", -signal.SIGTERM)])
def test_exit_codes_and_signals_are_the_modules(program, interpreter, script, code):
    interpreter(f"#!/bin/sh\n{script}\n")
    assert program("report", "DIR").returncode == code


def test_an_interpreter_that_is_not_there_is_told(program, monkeypatch):
    monkeypatch.setenv("SLIPFRONT_PYTHON", "/nonexistent/python")
    line = refusal(program("report", "DIR"))
    assert "/nonexistent/python cannot be started: No such file" in line and "SLIPFRONT_PYTHON" in line


def test_a_program_that_is_no_interpreter_is_told(program, monkeypatch):
    monkeypatch.setenv("SLIPFRONT_PYTHON", "/bin/true")
    assert "SLIPFRONT_PYTHON is /bin/true, which does not run" in refusal(program("report", "DIR"))


def test_a_missing_package_is_told(elsewhere, interpreter, tmp_path, monkeypatch):
    interpreter(BARE)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    elsewhere.folder = tmp_path / "here"
    (elsewhere.folder / "slipfront").mkdir(parents=True)  # results of that name are no package
    line = refusal(elsewhere("report", "DIR"))
    assert "report needs the Python package slipfront" in line and "-m pip install ." in line


def test_a_source_tree_without_packages_names_its_target(program, interpreter, tmp_path, monkeypatch):
    tree = tmp_path / "tree"
    (tree / "build/release").mkdir(parents=True)
    (tree / "python").mkdir()
    (tree / "python/slipfront").symlink_to(ROOT / "python/slipfront")
    shutil.copy(program.path, tree / "build/release/slipfront")
    interpreter(BARE, is_named=False)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    program.path = tree / "build/release/slipfront"
    assert f"'make module' in {tree} installs them all" in refusal(program("report", "DIR"))


ONSETS = "x_m,time_s\n0,0\n1e-2,1e-5\n2e-2,2e-5\n"
SWEEP = ["sweep", "coarse.toml", "--vary", "friction.mu_k=0.5,0.6", "--share", "1/1", "-o", "sweep"]
TELLING = [["fronts", "onsets.csv"], ["report", "out"], SWEEP, ["sweep", "--restart", "done"]]
TELLING += [["sweep", "--help"]]


@pytest.fixture
def with_run(program, coarse, monkeypatch):
    """The program with its package, and a run in `out`."""
    monkeypatch.setenv("SLIPFRONT_PYTHON", sys.executable)
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))
    require_done(program("run", "coarse.toml", "-o", "out"))
    return program


@pytest.mark.slow
@pytest.mark.parametrize("is_closed", [False, True], ids=["full", "closed"])
def test_standard_output_that_cannot_be_written(with_run, is_closed):
    """Exit code 1 and one line, for whatever is printed; what a command writes into files is there."""
    (with_run.folder / "onsets.csv").write_text(ONSETS)
    require_done(with_run(*SWEEP[:-1], "done"))
    for arguments in TELLING:
        reading, writing = os.pipe() if is_closed else (-1, os.open("/dev/full", os.O_WRONLY))
        if is_closed:
            os.close(reading)
        command = with_run.start(*arguments, stdout=writing)
        os.close(writing)
        line = one_line(finished(command), 1)
        why = "Broken pipe" if is_closed else "No space left on device"
        assert line == f"slipfront {arguments[0]}: error: standard output: {why}"
    assert (with_run.folder / "out/report.html").is_file()
    assert (with_run.folder / "done/sweep.csv").is_file()
    assert len(list(with_run.folder.glob("sweep/points/*/run.json"))) == 2


def test_a_page_is_written(with_run):
    result = with_run("report", "out", "-o", "page.html")
    assert (result.returncode, result.stderr) == (0, "")
    assert "<section" in (with_run.folder / "page.html").read_text(encoding="utf-8")
    assert "no such folder" in refusal(with_run("report", "nothing"))
