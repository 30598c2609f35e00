# SPDX-License-Identifier: BSD-3-Clause
"""The figure and the page of the study of bases."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from common import call_script, refusal, require_done
from drawing import bases
from synthetic import write_checksums

HEADER = "base,event,direction,x_m,v_tip_over_c_L,t_d_over_p_d,energy_rise,p_r_over_p_s,in_tail"


@pytest.fixture
def study(tmp_path) -> Path:
    folder = tmp_path / "bases"
    folder.mkdir()
    estimate = {"value": 0.5, "low": 0.4, "high": 0.6}
    known = {
        "speed_ratio": {"median": 0.94, "low": 0.9, "high": 1.0},
        "pressure_change": {"along": 0.02, "against": -0.25},
        "spread": {"static_ratio": 0.1, "dynamic_ratio": 0.2, "energy_rise": 0.3},
    }
    empty = {name: dict.fromkeys(values) for name, values in known.items()}
    known["speed_ratio"]["n_bins"], empty["speed_ratio"]["n_bins"] = 3, 0
    known |= {"name": "soft", "rigid": False, "share_in_paper_band": 0.3, "n_points": 2}
    known["fit"] = dict.fromkeys("abc", estimate)
    empty |= {"name": "rigid", "rigid": True, "share_in_paper_band": None, "n_points": 0, "fit": None}
    (folder / "bases.json").write_text(json.dumps({"quick": False, "bases": [known, empty]}))
    rows = [
        "soft,left,1,0.05,0.9,1.0,0.3,1.02,0",
        "soft,right,-1,0.06,1.1,,0.2,0.75,0",
        "soft,right,-1,0.07,,1,,0.8,1",
    ]
    (folder / "bases_points.csv").write_text("\n".join([HEADER, *rows]) + "\n")
    write_checksums(folder)
    return folder


def test_points_are_drawn_by_base_and_direction(study):
    figure = bases.draw(study).figure

    def points(gid):
        (line,) = [artist for artist in figure.findobj() if artist.get_gid() == gid]
        return list(line.get_xdata()), list(line.get_ydata())

    assert points("soft:energy_rise:1:0") == ([0.3], [0.9])
    assert points("soft:x_mm:-1:0") == ([pytest.approx(60)], [0.75])
    assert np.isnan(points("soft:t_d_over_p_d:-1:0")[0]).all()
    assert points("rigid:x_mm:1:0") == ([], [])


@pytest.fixture
def page(tmp_path) -> Path:
    page = tmp_path / "page.md"
    page.write_text("above\n<!-- table -->\nold\n<!-- end of table -->\nbelow\n")
    return page


def renewed(study, page):
    return call_script("papers/kammer2012/bases_page.py", study, "--page", page)


def test_a_damaged_study_is_refused(study, page):
    (study / "bases_points.csv").write_text("changed")
    assert "bases_points.csv" in refusal(renewed(study, page))
    assert "\nold\n" in page.read_text() and not (page.parent / "figures/page.png").exists()


def test_the_page_has_a_row_per_base(study, page):
    require_done(renewed(study, page))
    assert (page.parent / "figures/page.png").is_file()
    text = page.read_text()
    soft = "| soft | 0.94 (0.90 to 1.00) | -25.0 %, 2.0 % | 30 % of 2 | 0.20, 0.30 | 0.50, 0.50, 0.50 |"
    assert soft in text
    assert "| rigid | - (- to -) | - %, - % | - % of 0 | -, - | - |" in text
    assert text.startswith("above\n") and text.endswith("below\n") and "old" not in text
