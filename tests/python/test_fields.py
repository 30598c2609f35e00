# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and animations of snapshots."""

from __future__ import annotations

import sys

import h5py
import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image
from refusals import one_line
from slipfront.figures import fields
from slipfront.files import DataError
from synthetic import seal, write_run


@pytest.fixture
def run(tmp_path):
    write_run(tmp_path / "output/left", "left", 0.6, 20, 10, 11, 8)
    seal(tmp_path / "output")
    return tmp_path / "output/left"


def test_every_panel_shows_the_speeds_of_its_step(run):
    figure = fields.draw(run).figure
    read = fields.read(run)
    steps = fields.chosen_steps(len(read.time_s))
    assert 1 < len(steps) <= fields.MOST_PANELS and steps[-1] == len(read.time_s) - 1
    for step in steps:
        picture = next(artist for artist in figure.findobj() if artist.get_gid() == f"step:{step}")
        assert np.array_equal(picture.get_array(), read.speed_m_per_s(step))


def test_the_interface_is_drawn_where_a_body_lies_below(run):
    def n_lines():
        figure = fields.draw(run).figure
        return sum(artist.get_gid() == "interface" for artist in figure.findobj())

    assert n_lines() == 0
    with h5py.File(run / "fields.vtkhdf", "r+") as file:
        points = file["VTKHDF/Points"]
        points[:, 1] = points[:, 1] - 0.5 * points[:, 1].max()
    seal(run.parent)
    assert n_lines() == len(fields.chosen_steps(len(fields.read(run).time_s)))


def test_an_animation_has_a_frame_per_snapshot(run, tmp_path, capsys):
    assert fields.main([str(tmp_path / "a.gif"), str(run)]) == 0
    with Image.open(tmp_path / "a.gif") as image:
        assert image.n_frames == len(fields.read(run).time_s)
    assert "animation" in capsys.readouterr().out


def test_a_run_without_snapshots_is_refused(run, tmp_path, capsys):
    (run / "fields.vtkhdf").unlink()
    seal(run.parent)
    assert fields.main([str(tmp_path / "f.png"), str(run)]) == 2
    assert "fields.vtkhdf" in one_line(capsys)


@pytest.mark.parametrize("n_cells", [2**53, 1, 0, -1])
def test_a_wrong_number_of_cells_is_refused(run, n_cells):
    with h5py.File(run / "fields.vtkhdf", "r+") as file:
        file["VTKHDF/NumberOfCells"][0] = n_cells
    seal(run.parent)
    with pytest.raises(DataError, match="cells other than four-node quadrilaterals"):
        fields.read(run)


def test_a_film_has_every_frame(run, tmp_path, monkeypatch):
    pictures = [Image.new("RGB", (65, 48), (80 * k, 0, 0)) for k in range(4)]
    monkeypatch.setattr(fields, "frames", lambda folder: pictures)
    for name in ("a.mp4", "b.mp4"):
        assert fields.main([str(tmp_path / name), str(run)]) == 0
    n_frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "a.mp4"))
    assert n_frames == len(pictures)
    assert seconds == pytest.approx(len(pictures) * fields.FRAME_MS / 1000, rel=0.02)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_without_an_encoder_a_film_is_refused(run, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    assert fields.main([str(tmp_path / "a.mp4"), str(run)]) == 2
    assert "pip install imageio-ffmpeg" in one_line(capsys)
    assert not (tmp_path / "a.mp4").exists()
