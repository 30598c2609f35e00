# SPDX-License-Identifier: BSD-3-Clause
"""Commands, options, help and exit codes."""

import re

import pytest
from common import ROOT, refusal, require_done, sets

COMMANDS = ["run", "study", "info", "fracture", "bench", "validate", "new", "keys"]
PYTHON_COMMANDS = ["report", "fronts", "gauges", "compare", "fit", "records", "picks", "sweep"]
PYTHON_STUDIES = ["study convergence", "study interface-step"]
CASES = sorted((ROOT / "papers/kammer2012").glob("*.toml"))


def test_help_lists_every_command(program):
    listed = re.findall(r"^  ([a-z]\w+) {2,}\S", require_done(program("--help")).stdout, re.MULTILINE)
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
        (["frobnicate", "--help"], "no subcommand frobnicate"),
        (["study", "frobnicate", "--help"], "no subcommand frobnicate"),
        (["--frobnicate"], "--frobnicate"),
        (["run"], "CASE"),
        (["run", "-o", "out"], "CASE"),
        (["run", "coarse.toml", "-o"], "--output"),
        (["run", "coarse.toml", "-o", "out", "--frobnicate"], "--frobnicate"),
        (["run", "coarse.toml", "another.toml", "-o", "out"], "another.toml"),
        (["run", "coarse.toml", "-o", "out", "--set"], "--set"),
        (["info"], "CASE"),
        (["validate"], "CASE"),
        (["new", "glue"], "two-bodies"),
        (["run", "coarse.toml", "--threads", "0", "-o", "out"], "--threads"),
        (["run", "coarse.toml", "--threads", "two", "-o", "out"], "--threads"),
        (["run", "--checkpoint-every", "-1", "-o", "out"], "--checkpoint-every: -1 is not"),
        (["run", "--checkpoint-every-simulated", "nan"], "--checkpoint-every-simulated: nan is not"),
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


@pytest.mark.parametrize(
    "part, least, most",
    [
        ("friction", 15, 80),
        ("friction.d_c_m", 6, 6),
        ("mu_k", 3, 9),
        ("plate.width_m", 1, 1),
        ("title", 1, 1),
    ],
)
def test_a_part_of_the_reference(program, part, least, most):
    """Its rows are those of the whole, under the same headings."""
    lines = require_done(program("keys", part)).stdout.splitlines()
    assert set(lines) <= set(require_done(program("keys")).stdout.splitlines())
    rows = [line for line in lines if line.startswith("| `")]
    assert least <= len(rows) <= most
    assert all(f"`{part.split('.')[-1]}`" in row for row in rows) or "." not in part


def test_no_part_of_the_reference(program):
    assert "did you mean friction.d_c_m?" in refusal(program("keys", "friction.dc"))
    assert "did you mean friction?" in refusal(program("keys", "fricton"))


KINDS = ("rigid", "two-bodies", "pressed", "gauges", "sequence", "stick-slip")


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_case_runs(program, tmp_path, kind):
    case = tmp_path / "mine.toml"
    case.write_text(require_done(program("new", kind)).stdout)
    assert require_done(program("validate", case)).stdout.startswith(f"{case}: valid")
    of_sequence = kind in ("sequence", "stick-slip")
    shorter = "sequence.max_events=2" if of_sequence else "time.end_s=20e-6"
    coarse = sets("plate.element_size_m=4e-3" if of_sequence else "plate.element_size_m=2e-3", shorter)
    require_done(program("run", case, "-q", "-o", "out", *coarse))


def test_the_first_kind_is_the_default(program):
    assert program("new").stdout == program("new", KINDS[0]).stdout


def test_results_go_into_a_folder_of_the_cases_name(program, coarse, pipe, tmp_path):
    (tmp_path / "cases").mkdir()
    coarse.rename(tmp_path / "cases/my.coarse.toml")
    require_done(program("run", "cases/my.coarse.toml", "-q"))
    assert (tmp_path / "my.coarse/run.json").is_file()
    assert "is not empty" in refusal(program("run", "cases/my.coarse.toml", "-q"))
    assert "is no regular file" in refusal(
        program("run", pipe("pipe", (tmp_path / "cases/my.coarse.toml").read_text()))
    )


def test_the_reference_page_is_current(program):
    assert program("keys").stdout == (ROOT / "docs/case-reference.md").read_text(), "run: make docs"
