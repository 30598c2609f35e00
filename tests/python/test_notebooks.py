# SPDX-License-Identifier: BSD-3-Clause
"""The notebooks of docs/notebooks run, and what is stored of their output is small."""

from __future__ import annotations

import json

import pytest
from common import HANG_S, ROOT

FOLDER = ROOT / "docs/notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def test_they_are_named_on_their_page():
    page = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert NOTEBOOKS
    assert [n.name for n in NOTEBOOKS if f"({n.name})" not in page] == []


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda n: n.stem)
def test_stored_output_is_small_and_whole(notebook):
    cells = [c for c in json.loads(notebook.read_text(encoding="utf-8"))["cells"] if c["cell_type"] == "code"]
    assert notebook.stat().st_size < 200_000
    assert any(c["outputs"] for c in cells)
    assert all(c["execution_count"] == k + 1 for k, c in enumerate(cells))
    assert not [
        o for c in cells for o in c["outputs"] if o["output_type"] == "error" or o.get("name") == "stderr"
    ]


@pytest.mark.slow
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda n: n.stem)
def test_it_runs(notebook, monkeypatch):
    pytest.importorskip("slipfront._core")
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))
    book = nbformat.read(notebook, as_version=4)
    where = {"metadata": {"path": str(FOLDER)}}
    nbclient.NotebookClient(book, timeout=HANG_S, kernel_name="python3", resources=where).execute()
