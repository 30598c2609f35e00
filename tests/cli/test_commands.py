# SPDX-License-Identifier: BSD-3-Clause
"""Commands, options, help and exit codes."""

import re

import pytest
from common import ROOT, refusal, require_done, sets

COMMANDS = ["run", "reproduce", "study", "verify", "info", "bench", "validate", "keys"]
PYTHON_COMMANDS = ["report", "fronts", "sweep"]
CASES = sorted((ROOT / "papers/kammer2012").glob("*.toml"))


def test_help_lists_every_command(program):
    printed = require_done(program("--help")).stdout.split("Subcommands:")[1]
    listed = re.findall(r"^  (\w+) {2,}\S", printed, re.MULTILINE)
    assert sorted(listed) == sorted(COMMANDS + PYTHON_COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command(program, command):
    result = program(command, "-h")
    assert (result.returncode, result.stderr) == (0, "")
    assert f"Usage: slipfront {command}" in result.stdout


def test_version(program):
    version = re.search(r"project\(slipfront VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    first, *options = require_done(program("--version")).stdout.splitlines()
    assert re.fullmatch(rf"slipfront {re.escape(version)} \(\S+\)", first)
    printed = dict(line.split(": ", 1) for line in options)
    assert list(printed) == ["compiler", "processor", "precision", "statics"]
    assert re.search(r"\d+\.\d+", printed["compiler"])
    assert re.fullmatch(r".+, vectors of (32|64) bytes", printed["processor"])
    assert re.search(r"Eigen 3\.\d", printed["statics"])


@pytest.mark.parametrize(
    "arguments, expected",
    [
        ([], "subcommand"),
        (["frobnicate"], "frobnicate"),
        (["--frobnicate"], "--frobnicate"),
        (["run"], "CASE"),
        (["run", "coarse.toml"], "--output"),
        (["run", "-o", "out"], "CASE"),
        (["run", "coarse.toml", "-o"], "--output"),
        (["run", "coarse.toml", "-o", "out", "--frobnicate"], "--frobnicate"),
        (["run", "coarse.toml", "another.toml", "-o", "out"], "another.toml"),
        (["run", "coarse.toml", "-o", "out", "--set"], "--set"),
        (["info"], "CASE"),
        (["validate"], "CASE"),
        (["keys", "plate"], "plate"),
        (["reproduce", "--threads", "0", "-o", "out"], "--threads"),
        (["reproduce", "--threads", "two", "-o", "out"], "--threads"),
        (["run", "--checkpoint-every", "-1", "-o", "out"], "--checkpoint-every: -1 is not"),
        (["run", "--checkpoint-every-simulated", "nan"], "--checkpoint-every-simulated: nan is not"),
        (["reproduce", "coarse.toml", "-o", "out"], "coarse.toml"),
        (["reproduce", "--sensitivity", "--regularised", "-o", "out"], "--sensitivity"),
    ],
)
def test_wrong_command_lines(program, coarse, arguments, expected):
    line = refusal(program(*arguments))
    assert expected in line and "--help" in line
    assert not (coarse.parent / "out").exists()


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_papers_cases_are_valid(program, case):
    result = program("validate", case)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.startswith(f"{case}: valid")


def test_info_tells_what_follows(program):
    printed = require_done(program("info", ROOT / "papers/kammer2012/left.toml")).stdout
    # Kammer et al. (2012), Table 1: c_L = 1584 m/s, c_S = 890 m/s.
    speed = {name: float(v) for name, v in re.findall(r"(c_[LSR]) +([0-9.]+) m/s", printed)}
    assert abs(speed["c_L"] - 1584) <= 1 and abs(speed["c_S"] - 890) <= 1
    assert speed["c_R"] < speed["c_S"]
    assert re.search(r"^nodes +45451 \(301 on the interface", printed, re.MULTILINE)
    for name in ("largest stable step", "memory", "expected time", "growth at two elements"):
        assert re.search(rf"^{name} +[0-9]", printed, re.MULTILINE), name


def test_info_tells_whether_sliding_is_well_posed(program, coarse):
    # On a rigid plane waves grow from mu = 1 on.
    for mu, verdict in ((0.9, "well-posed"), (1.3, "ill-posed")):
        case = sets("friction.law=coulomb", f"friction.mu={mu}", "material.stiffness_damping_s=0")
        printed = require_done(program("info", coarse, *case)).stdout
        assert re.search(rf"^uniform sliding +{verdict}", printed, re.MULTILINE)


def test_the_reference_page_is_current(program):
    assert program("keys").stdout == (ROOT / "docs/case-reference.md").read_text(), "run: make docs"
