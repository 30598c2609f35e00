# SPDX-License-Identifier: BSD-3-Clause
"""scripts/scorecard-page.py renews the table of a page from scorecard.json and leaves its text alone."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts/scorecard-page.py"
PAGE = "# Scorecard\n\n<!-- table -->\nold\n<!-- end of table -->\n\nText | below.\n"


def claim(name: str, holds: bool | None, **more) -> dict:
    row = {"id": name, "claim": "a|b", "paper": "Fig. 1", "measured": "0.79", "holds": holds, "how": "x"}
    return row | more


@pytest.fixture
def write_page(tmp_path):
    def write(scorecard: list[dict]) -> list[str]:
        (tmp_path / "scorecard.json").write_text(json.dumps(scorecard))
        page = tmp_path / "page.md"
        page.write_text(PAGE)
        subprocess.run([sys.executable, SCRIPT, tmp_path, page], check=True)
        text = page.read_text()
        assert text.startswith("# Scorecard\n\n<!-- table -->\n")
        assert text.endswith("\n<!-- end of table -->\n\nText | below.\n")
        return text.split("<!-- table -->\n")[1].split("\n<!-- end")[0].split("\n")

    return write


def test_table_of_claims_and_variations(write_page):
    mesh = {"parameter": "plate.element_size_m", "value": 1e-3, "moves": "0.11; there does not hold"}
    rows = write_page([claim("C1", True, mesh_variation=mesh), claim("C2", False), claim("E1", None)])
    assert rows == [
        "| id | claim | our figure | verdict | moves by, at plate.element_size_m = 0.001 | test |",
        "|---|---|---|---|---|---|",
        "| C1 | a\\|b (Fig. 1) | 0.79 | holds | 0.11; **there does not hold** | x |",
        "| C2 | a\\|b (Fig. 1) | 0.79 | **does not hold** | - | x |",
        "| E1 | a\\|b (Fig. 1) | 0.79 | not tested | - | x |",
    ]


def test_table_tells_which_of_two_verdicts_counts(write_page):
    second = {"second_test_of": "C2", "why": "the first | was blunt"}
    untested = {"second_test_of": "C1", "why": "nobody tried"}
    assert write_page(
        [
            claim("C1", True, counts=True),
            claim("C1b", None, counts=False, **untested),
            claim("C2", False, counts=False),
            claim("C2+", False, counts=False),
            claim("C2b", True, counts=True, **second),
        ]
    )[2:] == [
        "| C1 | a\\|b (Fig. 1) | 0.79 | holds | x |",
        "| C1b | a\\|b (Fig. 1) | 0.79 | not tested | x. Instead of C1: nobody tried |",
        "| C2 | a\\|b (Fig. 1) | 0.79 | **does not hold**; C2b counts | x |",
        "| C2+ | a\\|b (Fig. 1) | 0.79 | **does not hold** | x |",
        "| C2b | a\\|b (Fig. 1) | 0.79 | holds | x. Instead of C2: the first \\| was blunt |",
    ]
