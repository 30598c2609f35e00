# SPDX-License-Identifier: BSD-3-Clause
"""The picture of a run at a glance."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import one_line
from slipfront.figures.rupture import main, rupture, unit
from slipfront.opened import open_run
from synthetic import write_run


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results") / "left"
    write_run(folder, "left", 0.6, 40, 20, 26, 2)
    return folder


def test_fronts_and_speeds_are_those_of_the_run(folder):
    run = open_run(folder)
    left, right, *_ = rupture(run).figure.axes
    onsets = {line.get_gid(): line for line in left.lines}
    speeds = {line.get_gid(): line for line in right.lines}
    c_S = run.fact("wave_speeds.c_S_m_per_s")
    assert run.front_list
    for front in run.front_list:
        np.testing.assert_allclose(onsets[f"front:{front.id}"].get_xdata(), 1e3 * front.x_m)
        np.testing.assert_allclose(onsets[f"front:{front.id}"].get_ydata(), 1e6 * front.onset_s)
        np.testing.assert_allclose(speeds[f"speed:{front.id}"].get_ydata(), front.v_tip_m_per_s / c_S)
    assert speeds["c_S"].get_ydata()[0] == 1
    assert speeds["c_L"].get_ydata()[0] == pytest.approx(run.c_L_m_per_s / c_S)


@pytest.mark.parametrize(
    "largest, expected",
    [(2.0, (1, "m")), (0.2, (1e3, "mm")), (0.12, (1e3, "mm")), (2e-4, (1e6, "µm")), (1e-8, (1e9, "nm"))],
)
def test_units_have_few_digits(largest, expected):
    assert unit(largest, "m") == expected


def test_nodes_faster_than_the_axis_are_counted(folder):
    run = open_run(folder)
    front = run.front_list[0]
    front.v_tip_m_per_s[5:7] = 2 * run.c_L_m_per_s
    assert rupture(run).figure.axes[1].get_title(loc="right") == "2 nodes above the axis"


def test_the_picture_is_written_and_a_missing_run_refused(folder, tmp_path, capsys):
    assert main([str(tmp_path / "a.png"), str(folder)]) == 0
    assert (tmp_path / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert main([str(tmp_path / "b.png"), str(tmp_path / "nowhere")]) == 2
    one_line(capsys)
    assert not (tmp_path / "b.png").exists()
