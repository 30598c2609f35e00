# SPDX-License-Identifier: BSD-3-Clause
"""The figure of a convergence study shows what the files say, for made-up speeds with known limits."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import artist, change_json, gids, one_error, replace
from slipfront.figures import convergence
from slipfront.figures.__main__ import main
from synthetic import write_csv
from synthetic_study import C_L, HEADER, OWN, SIZES, WITHOUT, X_LEFT_M, X_RIGHT_M, limit_left, write_study


@pytest.fixture
def study(tmp_path):
    return write_study(tmp_path)


def bars(ax, gid) -> np.ndarray:
    """Bottom and top of the bars."""
    segments = artist(ax, gid).get_segments()
    return np.array([[s[0][1], s[1][1]] for s in segments])


def without(folder, *directions) -> None:
    """Forgets what the study says of fronts in some directions."""
    change_json(
        folder / "convergence.json",
        lambda study: [s.update(dict.fromkeys(directions, WITHOUT)) for s in study["sequences"]],
    )


def panels(folder):
    """[sequences][to -x, to +x, errors]"""
    return np.array(convergence.convergence(folder).figure.axes).reshape(3, 3)


def test_speeds_are_drawn_by_value_and_direction(study):
    left, right = panels(study)[0][:2]
    for k, h in enumerate(SIZES):
        line = artist(left, f"speed:-1:{k}")
        np.testing.assert_allclose(line.get_xdata(), 1e3 * X_LEFT_M)
        np.testing.assert_allclose(line.get_ydata(), (limit_left(X_LEFT_M) + 1e5 * h) / C_L)
        np.testing.assert_allclose(artist(right, f"speed:1:{k}").get_ydata(), (1000 + 200 * k) / C_L)


def test_error_bars_reach_from_the_cases_own_speed_to_the_limit(study):
    left, right = panels(study)[0][:2]
    limit = limit_left(X_LEFT_M) / C_L
    np.testing.assert_allclose(artist(left, "limit:-1").get_ydata(), limit)
    np.testing.assert_allclose(bars(left, "error:-1"), np.transpose([limit, limit + 200 / C_L]))
    assert len(bars(left, "bound:-1")) == 0
    # Without a limit: nothing extrapolated, bounds instead.
    assert np.isnan(artist(right, "limit:1").get_ydata()).all()
    assert len(bars(right, "error:1")) == 0
    np.testing.assert_allclose(bars(right, "bound:1"), [[1000 / C_L, 1400 / C_L]] * len(X_RIGHT_M))


def test_titles_tell_the_verdict(study):
    titles = [[ax.get_title(loc="left").replace("\n", " ") for ax in row[:2]] for row in panels(study)]
    assert titles[0] == ["to $-x$: not converged, error 8 %", "to $+x$: no limit, error at least 17 %"]
    assert titles[2] == ["to $-x$: converged, error 0.99 %", "to $+x$: too few stations"]
    assert "made up" in convergence.convergence(study).figure.get_suptitle()


def test_errors_fall_with_the_observed_order(study):
    ax = panels(study)[0][2]
    own = limit_left(X_LEFT_M) + 1e5 * SIZES[OWN]
    expected = [100 * np.median(1e5 * h / own) for h in SIZES]
    line = artist(ax, "median:-1")
    np.testing.assert_allclose(line.get_xdata(), SIZES)
    np.testing.assert_allclose(line.get_ydata(), expected)
    np.testing.assert_allclose(artist(ax, "order:-1").get_ydata(), expected)  # exactly first order
    np.testing.assert_allclose(artist(ax, "median:1").get_ydata(), 100 * np.array([400, 200, 400]) / 1200)
    assert "order:1" not in gids(ax)
    assert artist(ax, "tolerance").get_ydata()[0] == pytest.approx(2)


def test_step_size_falls_with_the_number_of_substeps(study):
    ax = panels(study)[1][2]
    np.testing.assert_allclose(artist(ax, "median:-1").get_xdata(), [1 / 9, 1 / 18, 1 / 36, 1 / 72])
    # The station without speeds counts in no median.
    own = 1000 * (1 + 0.1 / 18)
    np.testing.assert_allclose(artist(ax, "median:-1").get_ydata(), [1e4 / n / own for n in (9, 18, 36, 72)])


def test_the_limit_itself_has_no_place_on_the_axis_of_errors(study):
    row = panels(study)[2]
    np.testing.assert_allclose(artist(row[2], "median:-1").get_xdata(), [2e-7, 1e-7, 5e-8])
    median = artist(row[2], "median:-1")
    np.testing.assert_allclose(artist(row[2], "order:-1").get_ydata(), median.get_ydata())
    np.testing.assert_allclose(artist(row[0], "speed:-1:3").get_ydata(), 1000 / C_L)


def test_a_direction_without_enough_stations_is_left_out(study):
    without(study, "direction_+1")
    axes = convergence.convergence(study).figure.axes
    assert len(axes) == 6
    assert "median:1" not in gids(axes[1])


def test_command_draws_the_figure(study, capsys):
    assert main([str(study)]) == 0
    assert (study / "figures/convergence.png").read_bytes()[:4] == b"\x89PNG"
    assert (study / "figures/convergence.pdf").read_bytes()[:5] == b"%PDF-"
    assert str(study / "figures/convergence.png") in capsys.readouterr().out


@pytest.mark.parametrize(
    "file, old, new, says",
    [
        ("convergence.csv", "error_m_per_s", "error", "not a table"),
        ("convergence.csv", "0.02,-1,plate", "0.02,left,plate", "not a table"),
        ("convergence.json", "c_L_m_per_s", "c_X_m_per_s", "'c_L_m_per_s'"),
        ("convergence.json", "direction_+1", "direction", "'direction_+1'"),
        ("convergence.json", "{", "", "not JSON"),
    ],
)
def test_damaged_folder_gives_one_line(study, capsys, file, old, new, says):
    replace(study / file, old, new)
    error = one_error(capsys, study)
    assert str(study / file) in error and says in error
    assert not (study / "figures").exists()


def test_study_without_fronts_gives_one_line(study, capsys):
    write_csv(study / "convergence.csv", HEADER, [])
    without(study, "direction_+1", "direction_-1")
    assert "no front has a station" in one_error(capsys, study)
