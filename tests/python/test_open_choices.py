# SPDX-License-Identifier: BSD-3-Clause
"""The figure of the open choices shows what the study's files say, and nothing that was not varied."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from drawing import open_choices
from matplotlib.colors import to_hex
from refusals import artist, change_json
from slipfront.figures.style import RC
from slipfront.files import DataError
from synthetic_study import write_open_choices


@pytest.fixture(autouse=True)
def style_of_figures():
    with matplotlib.rc_context(RC):
        yield


@pytest.fixture
def study(tmp_path):
    return write_open_choices(tmp_path / "study")


def test_cells_tell_where_a_verdict_turns_about_the_chosen_sample(study):
    figure = open_choices.draw(study).figure
    colours = {"C11:left_added": "TURNS_ON", "C11:left_zone_m": "FAILS"}
    for gid, colour in ({"C2:left_form": "TURNS_OFF", "C2:left_zone_m": "HOLDS"} | colours).items():
        cell = artist(figure, gid)
        assert to_hex(cell.get_facecolor()) == getattr(open_choices, colour) and not cell.get_hatch()
    assert artist(figure, "C2:corner").get_hatch()  # was not varied
    assert any(line.get_gid() == "chosen" for line in figure.axes[1].lines)


def test_nothing_is_varied_about_a_sample_that_was_not_chosen(study):
    change_json(study / "open_choices.json", lambda s: s.update(chosen=None))
    figure = open_choices.draw(study).figure
    assert artist(figure, "C2:left_form").get_hatch()
    assert not any(line.get_gid() == "chosen" for line in figure.axes[1].lines)


def test_every_sample_with_fronts_at_both_edges_is_a_point(study):
    figure = open_choices.draw(study).figure
    points = {line.get_gid(): line.get_xydata() for line in figure.axes[1].lines if line.get_gid()}
    expected = {
        "standard": [[0.9, 66]],
        "known": np.empty((0, 2)),
        "left trigger": np.empty((0, 2)),
        "right trigger": np.empty((0, 2)),
        "all": [[1.6, 31], [np.nan, 35]],
        "about the chosen": [[0, 83], [0.9, 66], [0.55, 60]],
        "finer": np.empty((0, 2)),
        "hold": [[0.6, 82], [0.55, 76], [0.5, 70]],
        "region": [[0.5, 75], [0.45, 80], [0.45, 80], [0.5, 70], [0.55, 70]],
        "chosen": [[0.5, 75]],
    }
    assert points.keys() == expected.keys()
    for name, xy in expected.items():
        np.testing.assert_allclose(points[name], xy, err_msg=name)


def test_left_triggers_that_add_a_traction_are_points_of_their_duration_and_impulse(study):
    lines = open_choices.draw(study).figure.axes[2].lines
    points = {line.get_gid(): line.get_xydata() for line in lines}
    expected = {
        "left:fail": np.empty((0, 2)),  # of other sets more than the left trigger varies
        "left:hold": [[open_choices.HELD_US, 200], [5, 123.46]],
        "left:region": [[5, 100]],
        "left:chosen": [[5, 100]],
    }
    assert points.keys() == expected.keys()
    for name, xy in expected.items():
        np.testing.assert_allclose(points[name], xy, err_msg=name)


def test_a_chosen_sample_that_the_table_lacks_is_refused(study):
    change_json(study / "open_choices.json", lambda s: s["chosen"]["values"].update(left_added=11.0))
    with pytest.raises(DataError, match="open_choices.csv: has no row of the chosen sample"):
        open_choices.draw(study)
