# SPDX-License-Identifier: BSD-3-Clause
"""The figure and the page of the study of bases."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from slipfront.figures import bases
from synthetic import write_checksums

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
HEADER = "base,event,direction,x_m,v_tip_over_c_L,t_d_over_p_d,energy_rise,p_r_over_p_s,in_tail"


@pytest.fixture
def study(tmp_path) -> Path:
    folder = tmp_path / "bases"
    folder.mkdir()
    estimate = {"value": 0.5, "low": 0.4, "high": 0.6}
    known = {
        "name": "soft",
        "rigid": False,
        "speed_ratio": {"median": 0.94, "low": 0.9, "high": 1.0, "n_bins": 3},
        "pressure_change": {"along": 0.02, "against": -0.25},
        "share_in_paper_band": 0.3,
        "n_points": 2,
        "fit": {"a": estimate, "b": estimate, "c": estimate},
        "spread": {"static_ratio": 0.1, "dynamic_ratio": 0.2, "energy_rise": 0.3},
    }
    empty = {
        "name": "rigid",
        "rigid": True,
        "speed_ratio": {"median": None, "low": None, "high": None, "n_bins": 0},
        "pressure_change": {"along": None, "against": None},
        "share_in_paper_band": None,
        "n_points": 0,
        "fit": None,
        "spread": {"static_ratio": None, "dynamic_ratio": None, "energy_rise": None},
    }
    (folder / "bases.json").write_text(json.dumps({"quick": False, "bases": [known, empty]}))
    rows = [
        "soft,left,1,0.05,0.9,1.0,0.3,1.02,0",
        "soft,right,-1,0.06,1.1,,0.2,0.75,0",
        "soft,right,-1,0.07,,1,,0.8,1",
    ]
    (folder / "bases_points.csv").write_text("\n".join([HEADER, *rows]) + "\n")
    write_checksums(folder)
    return folder


def line(figure, gid: str):
    return next(artist for artist in figure.findobj() if artist.get_gid() == gid)


def test_points_are_drawn_by_base_and_direction(study):
    figure = bases.draw(study).figure
    along = line(figure, "soft:energy_rise:1:0")
    assert along.get_xdata() == pytest.approx([0.3]) and along.get_ydata() == pytest.approx([0.9])
    against = line(figure, "soft:x_mm:-1:0")
    assert against.get_xdata() == pytest.approx([60]) and against.get_ydata() == pytest.approx([0.75])
    assert np.isnan(line(figure, "soft:t_d_over_p_d:-1:0").get_xdata()).all()
    assert len(line(figure, "rigid:x_mm:1:0").get_xdata()) == 0


def test_a_damaged_study_is_refused(study, capsys, tmp_path):
    (study / "bases_points.csv").write_text("changed")
    assert bases.main([str(tmp_path / "f.png"), str(study)]) == 2
    assert "bases_points.csv" in capsys.readouterr().err
    assert not (tmp_path / "f.png").exists()


def test_the_page_has_a_row_per_base(study, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(SCRIPTS))
    module = importlib.import_module("bases-page")
    page = tmp_path / "page.md"
    page.write_text("above\n<!-- table -->\nold\n<!-- end of table -->\nbelow\n")
    module.write(study, page)
    text = page.read_text()
    assert (
        "| soft | 0.94 (0.90 to 1.00) | -25.0 %, 2.0 % | 30 % of 2 | 0.20, 0.30 | 0.50, 0.50, 0.50 |" in text
    )
    assert "| rigid | - (- to -) | - %, - % | - % of 0 | -, - | - |" in text
    assert text.startswith("above\n") and text.endswith("below\n") and "old" not in text
    sys.modules.pop("bases-page")
