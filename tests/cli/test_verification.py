# SPDX-License-Identifier: BSD-3-Clause
"""The program that solves problems with known answers, beside the program."""

import json

import pytest
from common import ROOT, refusal, require_done


@pytest.fixture
def verify(program):
    program.path = program.path.with_name("slipfront-verify")
    return program


def test_every_problem_with_a_page_is_named(verify):
    listed = [line.split()[0] for line in require_done(verify("--list")).stdout.splitlines()]
    pages = {page.stem for page in (ROOT / "verification").glob("*.md")} - {"README"}
    assert sorted(listed) == sorted(pages)


def test_problems_are_added_to_a_folder(verify, tmp_path):
    for name in ("plane_waves", "symmetry"):
        printed = require_done(verify("--quick", name, "-o", "out")).stdout.splitlines()
        results = json.loads((tmp_path / f"out/{name}.json").read_text())
        assert (results["name"], results["effort"], results["holds"]) == (name, "quick", True)
        assert printed[0] == f"{name}: {results['title']}"
        assert printed[-1] == f"all {len(results['checks'])} checks hold"
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "plane_waves.json",
        "symmetry.json",
        "checksums.sha256",
    }


@pytest.mark.parametrize("arguments, option", [(["frobnicate"], "--list"), (["--frobnicate"], "--help")])
def test_wrong_command_lines(verify, arguments, option):
    line = refusal(verify(*arguments))
    assert line.startswith("slipfront-verify: ") and "frobnicate" in line and option in line
