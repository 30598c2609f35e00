# SPDX-License-Identifier: BSD-3-Clause
"""The commands and files of docs/tutorial.md, as a reader enters them."""

import re
import shutil
import sys
from dataclasses import dataclass

import pytest
from common import ROOT, WITH_PACKAGE, call, require_done
from slipfront.opened import open_run

pytestmark = pytest.mark.slow

TUTORIAL = ROOT / "docs/tutorial.md"

CHECK = """\
#include "interface/friction/slip_gradual.hpp"
#include <cmath>
int main() {
  const slipfront::interface::SlipGradual law;
  const auto mu = law.evaluator();
  const bool right = mu(0., 0.) == law.mu_s && std::abs(mu(1., 2e-6) - 0.375) < 1e-15;
  return right ? 0 : 1;
}
"""


@dataclass(frozen=True)
class Block:
    language: str
    text: str
    file: str  # what the text before it saves it as; empty for none
    left_out: bool


def blocks() -> list[Block]:
    page = TUTORIAL.read_text(encoding="utf-8")
    found = []
    position = 0
    for match in re.finditer(r"^```(\w+)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
        before = page[position : match.start()]
        position = match.end()
        named = re.findall(r"[sS]ave\w*\s+(?:this\s+one\s+|this\s+|it\s+)?as\s+`([^`]+)`", before)
        left_out = before.rstrip().split("\n")[-1].startswith("<!-- not run:")
        found.append(Block(match[1], match[2], named[-1] if named else "", left_out))
    return found


@pytest.fixture
def shell(program, tmp_path):
    """Runs commands with the names that the tutorial uses."""
    names = tmp_path / "bin"
    names.mkdir()
    (names / "slipfront").symlink_to(program.path)
    (names / "python").write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    (names / "python").chmod(0o755)
    work = tmp_path / "work"
    work.mkdir()
    environment = WITH_PACKAGE | {"PATH": f"{names}:{WITH_PACKAGE['PATH']}", "MPLBACKEND": "agg"}

    def run(text: str):
        return call("bash", "-euo", "pipefail", "-c", text, cwd=work, env=environment)

    run.folder = work
    return run


def test_all_of_it_runs(shell):
    for block in blocks():
        if block.language in ("toml", "python"):
            (shell.folder / block.file).write_text(block.text)
        elif block.language == "sh" and not block.left_out:
            require_done(shell(block.text))
    for picture in ("first", "picture", "aluminium", "tail", "block", "fine/figures/energy_balance"):
        assert (shell.folder / f"{picture}.png").stat().st_size > 10_000
    runs = ("first", "aluminium", "stuck", "tail", "fine")
    reached = {name: open_run(shell.folder / name) for name in runs}
    for name, run in reached.items():
        ends_m = [f.x_m[-1] for f in run.front_list]
        assert (max(ends_m) > 0.19 and min(ends_m) < 0.01) == (name != "stuck"), name
    arrivals_s = [
        next(f.onset_s[-1] for f in reached[name].front_list if f.direction < 0) for name in ("first", "tail")
    ]
    assert round(1e6 * (arrivals_s[0] - arrivals_s[1])) == 9
    first, fine = (next(f for f in reached[n].front_list if f.direction > 0) for n in ("first", "fine"))
    assert abs(first.onset_s[-1] / fine.onset_s[-1] - 1) < 0.05


def test_the_output_shown_is_that_of_the_run(shell):
    files = {b.file: b.text for b in blocks() if b.language == "toml"}
    (shell.folder / "my.toml").write_text(files["my.toml"])
    printed = shell("slipfront run my.toml -o first").stdout.splitlines()
    shown = next(b.text for b in blocks() if "results: first" in b.text and b.language == "text").splitlines()
    without_times = [line for line in shown if "wall time" not in line]
    assert [line for line in without_times if line not in printed] == []
    (shell.folder / "my.toml").write_text(files["my.toml"].replace("width_m", "widht_m"))
    error = next(b.text for b in blocks() if "widht_m" in b.text)
    assert shell("slipfront validate my.toml").stderr == error


@pytest.mark.skipif(shutil.which("g++") is None, reason="no g++")
def test_the_law_in_cpp_compiles(tmp_path):
    law = next(b for b in blocks() if b.language == "cpp")
    header = tmp_path / law.file
    header.parent.mkdir(parents=True)
    header.write_text(law.text)
    (tmp_path / "check.cpp").write_text(CHECK)
    warnings = ("-Wall", "-Werror", "-Wno-psabi")
    includes = (f"-I{tmp_path}/src", f"-I{ROOT}/src")
    files = (tmp_path / "check.cpp", "-o", tmp_path / "check")
    require_done(call("g++", "-std=c++20", *warnings, *includes, *files))
    require_done(call(tmp_path / "check"))
