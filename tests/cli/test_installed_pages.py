# SPDX-License-Identifier: BSD-3-Clause
"""What is installed beside the program and made by it: manual page and completion."""

import re
import shutil

import pytest
from common import call, require_done
from test_commands import COMMANDS, PYTHON_COMMANDS, PYTHON_STUDIES

STUDIES = ["convergence", "interface-step"]


@pytest.fixture
def page(program, tmp_path):
    """A page as the program prints it, as text and as a file."""

    def read(name):
        result = require_done(program("page", name))
        assert result.stderr == ""
        file = tmp_path / name
        file.write_text(result.stdout, encoding="utf-8")
        return result.stdout, file

    return read


@pytest.fixture
def complete(page):
    """Completes a command line as an interactive bash would: words, the last one being typed."""
    _, file = page("bash")

    def completed(*words):
        line = " ".join(f"'{word}'" for word in words)
        script = f"""
        compopt() {{ :; }}
        source {file}
        COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}
        _slipfront
        printf '%s\\n' "${{COMPREPLY[@]}}"
        """
        result = require_done(call("bash", "-c", script))
        assert result.stderr == ""
        return set(result.stdout.split())

    return completed


def options_in_help(program, *command):
    printed = program(*command, "--help").stdout
    return set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", printed, re.MULTILINE))


def test_the_command_is_not_in_the_help(program):
    assert not re.search(r"^  page\b", program("--help").stdout, re.MULTILINE)


def test_the_man_page_has_every_command_and_option(program, page):
    text, _ = page("man")
    sections = dict(
        re.findall(r'^\.SS "slipfront ([^"]*)"\n(.*?)(?=^\.S[SH] |\Z)', text, re.MULTILINE | re.DOTALL)
    )
    sections = {name.replace("\\-", "-"): body.replace("\\-", "-") for name, body in sections.items()}
    assert set(sections) == {*COMMANDS, *PYTHON_COMMANDS, *(f"study {study}" for study in STUDIES)}
    # What is in Python tells its options itself.
    for name in sections.keys() - {*PYTHON_COMMANDS, *PYTHON_STUDIES}:
        body = sections[name]
        titles = " ".join(re.findall(r"^\\fB(.*)$", body, re.MULTILINE))
        assert set(re.findall(r"--[a-z-]+", titles)) == options_in_help(program, *name.split()), name


@pytest.mark.skipif(not shutil.which("man"), reason="no man")
def test_man_finds_nothing_to_warn_of(page):
    _, file = page("man")
    plain = {"MANROFFSEQ": "", "MANWIDTH": "80", "LC_ALL": "C.UTF-8", "PATH": "/usr/bin:/bin"}
    result = require_done(call("man", "--warnings", "-l", file, env=plain))
    assert result.stderr == ""
    assert "slipfront run" in result.stdout


def test_completion_of_commands(complete):
    assert complete("slipfront", "") == {*COMMANDS, *PYTHON_COMMANDS}
    assert complete("slipfront", "rep") == {"report"}
    assert complete("slipfront", "study", "") == set(STUDIES)
    assert complete("slipfront", "study", "co") == {"convergence"}


@pytest.mark.parametrize("command", [["run"], ["bench"]], ids=" ".join)
def test_completion_of_options(program, complete, command):
    assert complete("slipfront", *command, "--") == options_in_help(program, *command)


def test_completion_of_values(complete):
    assert complete("slipfront", "bench", "--solver", "") == {"auto", "direct", "iterative"}
    assert complete("slipfront", "run", "--set", "friction.mu") >= {"friction.mu_s=", "friction.mu_k="}
    assert complete("slipfront", "run", "--output", "") == set()
