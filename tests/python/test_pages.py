# SPDX-License-Identifier: BSD-3-Clause
"""The scripts that renew pages: tables of checked results; a page is renewed whole or not at all."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from common import ROOT, WITH_PACKAGE, call, call_script, one_line, refusal
from synthetic import write_checksums
from synthetic_study import write_open_choices

SCRIPTS = ROOT / "scripts"
PAPER = "papers/kammer2012"
OLD = "x" * 8192 + "\n"  # of a page's text: more than a file may have on the full disk below
TEXTS = 5 * ("stale", "kept")  # within and behind a pair of marks


@dataclass
class Pages:
    """A script, its results and the pages that it renews."""

    script: str
    results: Path
    file: str  # of the results
    target: list[str | Path]  # arguments that name a page or a folder of pages
    page: Path
    marks: list[str]

    def run(self) -> subprocess.CompletedProcess:
        return call_script(self.script, self.results, *self.target)

    def refused(self, *says: str, code: int = 2, run=None) -> None:
        before = self.page.read_bytes()
        done = (run or self.run)()
        line = one_line(done, code)
        assert not done.stdout and line.startswith(f"{Path(self.script).name}: error: ")
        for part in says:
            assert part in line
        assert self.page.read_bytes() == before
        assert not list(self.page.parent.glob(".unfinished-*"))


def open_choices(folder: Path) -> Pages:
    results, page = write_open_choices(folder / "results"), folder / "page.md"
    tables = ("choices", "outcomes", "evidence", "known", "meshes")
    marks = [mark for table in tables for mark in (f"<!-- {table} -->", f"<!-- end of {table} -->")]
    script = f"{PAPER}/open_choices_page.py"
    return Pages(script, results, "open_choices.json", ["--page", page], page, marks)


def claim(name: str, holds: bool | None, **more) -> dict:
    row = {"id": name, "claim": "a|b", "paper": "Fig. 1", "measured": "0.79", "holds": holds, "how": "x"}
    return row | more


def scorecard(folder: Path, claims: list[dict] | None = None) -> Pages:
    results, page = folder / "results", folder / "page.md"
    results.mkdir()
    (results / "scorecard.json").write_text(json.dumps(claims or [claim("C1", True)]))
    marks = ["<!-- table -->", "<!-- end of table -->"]
    script = f"{PAPER}/scorecard_page.py"
    return Pages(script, results, "scorecard.json", ["--page", page], page, marks)


def verification(folder: Path) -> Pages:
    results, pages = folder / "results", folder / "pages"
    results.mkdir()
    pages.mkdir()
    check = {"quantity": "error", "unit": "", "measured": 1, "expected": 0, "tolerance": 2, "reason": "y"}
    summary = {"name": "column", "title": "Column", "checks": [check | {"holds": True}]}
    (results / "column.json").write_text(json.dumps(summary))
    (pages / "README.md").write_text(OLD + "<!-- numbers -->\nstale\n")
    marks = ["<!-- numbers -->"]
    return Pages("verification/pages.py", results, "column.json", [pages], pages / "column.md", marks)


@pytest.fixture(params=[open_choices, scorecard, verification])
def pages(request, tmp_path) -> Pages:
    made = request.param(tmp_path)
    made.page.write_text(
        OLD + "".join(f"{mark}\n{text}\n" for mark, text in zip(made.marks, TEXTS, strict=False))
    )
    write_checksums(made.results)
    return made


def test_a_page_is_renewed_once_and_for_all(pages):
    done = pages.run()
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    text = pages.page.read_text()
    assert text.startswith(OLD) and "stale" not in text and "|---|" in text
    assert all(text.count(mark) == 1 for mark in pages.marks)
    assert text.count("\nkept\n") == len(pages.marks) // 2
    assert pages.run().returncode == 0 and pages.page.read_text() == text


def test_the_tables_of_the_open_choices(tmp_path):
    pages = open_choices(tmp_path)
    pages.page.write_text("\n".join(pages.marks))
    assert pages.run().returncode == 0
    lines = pages.page.read_text().split("\n")
    assert "| `left_added` | `event.left_added` | 5, 10 | open | 5 | 9 to 10 | 10 |" in lines
    assert "| `corner` | `event.corner` | relief, fillet 10 mm | open | relief | - | relief |" in lines
    fit = "0.80 [0.70, 0.90] | 2.00 [1.90, 2.10] | 3.00 [2.90, 3.10]"
    row = f"does not | none | 1.20; 60, 40 % | 0.060, 75 % | {fit} | 12, 15, 18 % |"
    assert f"| added: 10 mm, 20, held | 156 | {row}" in lines
    chosen = row.replace("does not | none", "holds | 2.4; 0.6")
    assert f"| **chosen**, added: 10 mm, 10, 5 us | 156 | {chosen}" in lines
    of_sizes = [line for line in lines if " mm | " in line and line.startswith(("| 0.5", "| 1", "| 2"))]
    assert [line.split(" | ")[0] for line in of_sizes] == ["| 0.5 mm", "| 1 mm", "| 2 mm"]
    assert of_sizes[-1].endswith("| C11, C25 |")
    assert "| points in the paper's band | 80 % (70 to 90) | - |" in lines
    assert "| spread of V_tip at equal t_d/p_d | 4 % (2 to 5) | - |" in lines
    assert "| C18c holds | 1 of 2 | - |" in lines
    assert "| difference between kinds of slip (C21+) | 0.20 c_L (0.10 to 0.30) | - |" in lines


@pytest.fixture
def write_scorecard(tmp_path):
    """The table of a page renewed from these claims."""

    def write(claims: list[dict]) -> list[str]:
        pages = scorecard(tmp_path, claims)
        pages.page.write_text("\n".join(pages.marks))
        assert pages.run().returncode == 0
        return pages.page.read_text().split("\n")[1:-1]

    return write


def test_table_of_claims_and_variations(write_scorecard):
    mesh = {"parameter": "plate.element_size_m", "value": 1e-3, "moves": "0.11; there does not hold"}
    rows = write_scorecard([claim("C1", True, mesh_variation=mesh), claim("C2", False), claim("E1", None)])
    assert rows == [
        "| id | claim | our figure | verdict | moves by, at plate.element_size_m = 0.001 | test |",
        "|---|---|---|---|---|---|",
        "| C1 | a\\|b (Fig. 1) | 0.79 | holds | 0.11; **there does not hold** | x |",
        "| C2 | a\\|b (Fig. 1) | 0.79 | **does not hold** | - | x |",
        "| E1 | a\\|b (Fig. 1) | 0.79 | not tested | - | x |",
    ]


def test_table_tells_which_of_two_verdicts_counts(write_scorecard):
    second = {"second_test_of": "C2", "why": "the first | was blunt"}
    untested = {"second_test_of": "C1", "why": "nobody tried"}
    assert write_scorecard(
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


def test_all_pages_of_the_problems_are_renewed(tmp_path):
    pages = verification(tmp_path)
    pages.page.write_text("<!-- numbers -->")
    assert pages.run().returncode == 0
    assert "| error | 1 | 0 | 2 | y |" in pages.page.read_text()
    assert (pages.page.parent / "README.md").read_text().endswith("| [Column](column.md) | 1 of 1 |\n")


@pytest.mark.slow
def test_results_that_are_damaged_or_missing_are_refused(pages):
    file = pages.results / pages.file
    file.write_text(file.read_text().replace("1", "2", 1) + " ")
    pages.refused(f"{file}: does not match checksums.sha256")
    # In a folder of an older program, without checksums.
    (pages.results / "checksums.sha256").unlink()
    for text, says in (("[{", "not JSON"), ('{"checks": 1}', "not a"), ("[1]", "not a")):
        file.write_text(text)
        pages.refused(f"{file}: {says}")
    file.unlink()
    pages.refused(f"{file}: No such file or directory")


def test_a_page_without_its_marks_is_refused(pages):
    for mark in (pages.marks[0], pages.marks[-1]):
        text = pages.page.read_text()
        pages.page.write_text(text.replace(mark, ""))
        pages.refused(f"{pages.page}: no line", mark)
        pages.page.write_text(text)


def test_a_page_that_is_no_file_is_refused(pages):
    pages.page.rename(pages.page.with_name("other"))
    pages.page.symlink_to(pages.page.with_name("other"))
    pages.refused(f"{pages.page}: is there and not a regular file")
    assert pages.page.is_symlink()


def test_a_full_disk_leaves_the_page_as_it_was(pages):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    def run():
        command = (sys.executable, ROOT / pages.script, pages.results, *pages.target)
        return call(*command, preexec_fn=limit, env=WITH_PACKAGE | {"PYTHONDONTWRITEBYTECODE": "1"})

    pages.refused("File too large", code=1, run=run)


@pytest.mark.parametrize(
    "script",
    [
        f"{PAPER}/energy_criterion.py",
        f"{PAPER}/open_choices_page.py",
        f"{PAPER}/scorecard_page.py",
        "verification/pages.py",
    ],
)
def test_without_arguments_the_usage_is_told(script):
    done = call(sys.executable, ROOT / script, env=WITH_PACKAGE)
    assert done.returncode == 2 and "usage:" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("script", ["stability-figure.py", "reflection-figure.py"])
@pytest.mark.parametrize("name, says", [("picture", "must end with"), ("picture.png", "not a regular file")])
def test_scripts_that_draw_replace_pictures_alone(tmp_path, script, name, says):
    (tmp_path / "mine").write_text("mine")
    (tmp_path / name).symlink_to(tmp_path / "mine")
    assert says in refusal(call(sys.executable, SCRIPTS / script, tmp_path / "table.csv", tmp_path / name))
    assert (tmp_path / name).is_symlink() and (tmp_path / "mine").read_text() == "mine"
