# SPDX-License-Identifier: BSD-3-Clause
"""Links, names and cases of the documentation's pages are those of the files."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from common import ROOT

DOCS = [ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *DOCS]
PROBLEMS = sorted(page.stem for page in (ROOT / "verification").glob("*.md") if page.stem != "README")


def anchors(page: Path) -> set[str]:
    """Of a page's headings, as GitHub forms them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    plain = (re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower() for heading in headings)
    return {re.sub(r"[^\w\- ]", "", heading.strip()).replace(" ", "-") for heading in plain}


def broken_links(page: Path) -> list[str]:
    broken = []
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        file, _, anchor = link.partition("#")
        if file.startswith(("http:", "https:")):
            continue
        target = page.parent / file if file else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(link)
    return broken


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    assert broken_links(page) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_nothing_is_taken_for_a_comment(page):
    """MyST leaves out lines that begin with a per cent sign."""
    assert re.findall(r"^\s*%.*$", page.read_text(encoding="utf-8"), re.MULTILINE) == []


def test_files_that_are_named_are_there():
    contributing = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = [ROOT / name for name in re.findall(r"`((?:src|tests|python|docs)/[\w./]+)`", contributing)]
    assert named
    assert [path for path in named if not path.exists()] == []


def test_every_law_has_its_page_its_row_and_its_place():
    """Laws of one kind share a page, whose title names them."""
    laws = re.findall(r'^With `law = "(\w+)"`', (ROOT / "docs/case-reference.md").read_text(), re.MULTILINE)
    table = (ROOT / "docs/friction/README.md").read_text(encoding="utf-8")
    contents = (ROOT / "docs/_toc.yml").read_text(encoding="utf-8")
    assert laws
    titles = {
        page.stem: page.read_text(encoding="utf-8").splitlines()[0]
        for page in (ROOT / "docs/friction").glob("*.md")
    }
    for law in laws:
        (page,) = (name for name, title in titles.items() if f"`{law}`" in title)
        assert f"`{law}`" in table and f"({page}.md)" in table
        assert f"docs/friction/{page}\n" in contents


def test_the_lines_of_cases_shown_are_in_their_files():
    pages = sorted((ROOT / "docs/examples").glob("*.md"))
    assert pages
    for page in pages:
        text = page.read_text(encoding="utf-8")
        if page.stem == "README":
            continue
        shown = "".join(re.findall(r"^```toml\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)).splitlines()
        case = (ROOT / "examples" / page.stem / "case.toml").read_text(encoding="utf-8").splitlines()
        settings = [line.partition("  #")[0] for line in case]
        assert len(shown) > 2 and [line for line in shown if line not in settings] == [], page
        assert f"figures/example_{page.stem.replace('-', '_')}.png" in text


def test_every_problem_has_its_page_its_picture_and_its_row():
    problems = (ROOT / "verification/verification.cpp").read_text(encoding="utf-8")
    assert sorted(re.findall(r'Verification\{"(\w+)"', problems)) == PROBLEMS
    trust = (ROOT / "docs/trust.md").read_text(encoding="utf-8")
    index = (ROOT / "verification/README.md").read_text(encoding="utf-8")
    for name in PROBLEMS:
        assert f"]({name}.md) |" in index
        assert f"](../verification/{name}.md) |" in trust
        page = (ROOT / f"verification/{name}.md").read_text(encoding="utf-8")
        assert f"figures/{name}.png" in page


def test_the_version_is_the_same_everywhere():
    version = re.search(r"project\(slipfront VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    date = re.search(r"^date-released: ([0-9-]+)$", citation, re.MULTILINE)[1]
    assert f"\nversion: {version}\n" in citation
    assert f"\n## {version} ({date})\n" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
