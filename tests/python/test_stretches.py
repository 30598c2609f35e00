# SPDX-License-Identifier: BSD-3-Clause
"""Stretches of one speed, series of events, and the stick-slips of Okubo, Yamashita and Fukuyama (2025)."""

from __future__ import annotations

import csv
import re

import numpy as np
import pytest
import slipfront
from common import ROOT
from slipfront import fronts_command
from slipfront.stretches import Onsets, stretches_of

LAB = ROOT / "examples/laboratory/onsets"
EVENTS = sorted(LAB.glob("event*.csv"))
CASES = ROOT / "tests/cli/cases"
PLACE_ERROR_M = 5e-3  # of the digitisation
TIME_ERROR_S = {1: 3e-5, 2: 8e-5, 3: 8e-5}  # by the authors' type: from the east, the west, both


def authors(file) -> tuple[int, float]:
    """Type and speed in the head of a file."""
    found = re.search(r"authors: type (\d), (\S+) m/s", file.read_text(encoding="utf-8"))
    return int(found[1]), float(found[2])


def number(file) -> int:
    return int(file.stem.removeprefix("event"))


def rows_of(file):
    lines = file.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def call(*arguments) -> int:
    return fronts_command.main([str(a) for a in arguments])


def printed(capsys, *arguments):
    assert call(*arguments) == 0
    return capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("n", [6, 17, 80])
@pytest.mark.parametrize("error_s", [None, 1e-4])
def test_a_uniform_front_stays_one_stretch(n, error_s):
    random = np.random.default_rng(n)
    errors = None if error_s is None else (0.0, np.full(n, error_s))
    parted = 0
    for _ in range(400):
        x = np.sort(random.uniform(0, 1, n))
        t = x / 100 + 1e-4 * random.standard_normal(n)
        parted += len(stretches_of(Onsets(x, t, 0.0, errors))) > 2
    assert parted <= 0.05 * 400


def test_a_step_of_the_clock_is_no_change_of_speed():
    x = np.arange(300) * 1e-3
    onset = np.floor(x / 430 / 5e-6) * 5e-6
    found = slipfront.find_fronts(x, onset)
    assert slipfront.speed_stretches(found).sizes["stretch"] == found.sizes["front"] == 1
    exact = slipfront.find_fronts(x, x / 430 + 1e-3)
    assert slipfront.speed_stretches(exact).sizes["stretch"] == 1


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("error_s", [None, 1e-4])
def test_a_change_is_found_where_it_is(way, error_s):
    """50 m/s up to 0.5 m, then 200: of 20 gauges within one of it, both speeds within their intervals."""
    random = np.random.default_rng(7)
    x = np.linspace(0, 1, 20)
    given = {} if error_s is None else {"time_error_s": error_s}
    right = 0
    for _ in range(100):
        run = x if way == 1 else 1 - x
        t = np.where(run < 0.5, run / 50, 0.01 + (run - 0.5) / 200) + 1e-4 * random.standard_normal(20)
        found = slipfront.find_fronts(x, t, **given)
        parts = slipfront.speed_stretches(found, **given)
        if parts.sizes["stretch"] != 2:
            continue
        border = (float(parts.x_to_m[0]) + float(parts.x_from_m[1])) / 2
        low, high = parts.speed_low_m_per_s.values, parts.speed_high_m_per_s.values
        right += abs(border - 0.5) < 1.1 / 19 and bool(((low < [50, 200]) & (high > [50, 200])).all())
        assert list(parts.direction) == [way, way]
        assert abs(float(parts.wait_s[1])) < 1.5e-3  # the border is off by up to a gap: 1/19 m at 50 m/s
    # Two intervals of 95 %, and 2 % are parted once more.
    assert right >= 85


def test_a_wait_is_no_change_of_speed(tmp_path, capsys):
    x = np.linspace(0, 1, 16)
    t = x / 100 + np.where(x > 0.5, 3e-3, 0) + 1e-5 * np.random.default_rng(1).standard_normal(16)
    file = tmp_path / "waits.csv"
    file.write_text("x_m,time_s\n" + "".join(f"{a:.6f},{b:.9f}\n" for a, b in zip(x, t, strict=True)))
    (line, *_) = printed(capsys, file)
    assert "waits 0.003 s at x = 0.5000 m: " in line and ", then " in line and "changes" not in line


def test_places_without_a_line_make_no_stretch_of_their_own():
    """Of two places that two fronts share none is left on either line."""
    x_m = np.array([0.0, 1.0, 2.0, 3.0])
    settings = slipfront.FrontSettings(min_length_m=0.5)
    few = slipfront.find_fronts(x_m, [1e-3, 0.0, 1e-3, 2e-3], settings=settings)
    parts = slipfront.speed_stretches(few)
    assert list(parts.onsets) == [1, 2] and parts.type == "from inside"
    with pytest.raises(slipfront.CaseError, match="not those of find_fronts"):
        slipfront.speed_stretches(few.assign_attrs(notes=[]).drop_attrs())


# Errors of each onset


def test_onsets_count_by_their_errors():
    """Exact ones at 100 m/s and two that are wrong by 1 ms, and say so: the line is the exact one."""
    x = np.linspace(0, 1, 8)
    t, error_s = x / 100, np.full(8, 1e-7)
    t[[2, 5]] += [1e-3, -1e-3]
    error_s[[2, 5]] = 1e-3
    speed = slipfront.find_fronts(x, t, time_error_s=error_s, resolution_s=0.0)
    assert float(speed.speed_m_per_s[0]) == pytest.approx(100, rel=1e-5)
    plain = slipfront.find_fronts(x, t, time_error_s=1e-3, resolution_s=0.0)
    assert abs(float(plain.speed_m_per_s[0]) - 100) > 3
    # With errors of places, too: the line for which the weighted squares are least.
    found = slipfront.find_fronts(x, t, time_error_s=error_s, place_error_m=0.05, resolution_s=0.0)
    made = 1 / float(found.speed_m_per_s[0])

    def squares(slope):
        weight = 1 / (error_s**2 + (0.05 * slope) ** 2)
        off = t - slope * x
        return weight @ (off - np.average(off, weights=weight)) ** 2

    assert squares(made) < min(squares(made * (1 + 1e-4)), squares(made * (1 - 1e-4)))
    for wrong in ([1e-3] * 7, [0.0] * 8):
        with pytest.raises(slipfront.CaseError, match="time_error_s must be a number, or 8 of them above 0"):
            slipfront.find_fronts(x, t, time_error_s=wrong)


def test_two_onsets_of_many_places_make_a_front():
    x = np.linspace(0, 1, 11)
    onset = np.full(11, np.nan)
    onset[[3, 4]] = 0.0, 1e-3
    found = slipfront.find_fronts(x, onset)
    assert float(found.speed_m_per_s[0]) == pytest.approx(100)
    assert any("two onsets make its speed" in note for note in found.notes)


# Events


PICKS = """# picks by slipfront picks
event,gauge,x_m,y_m,onset_s,error_s,by,doubt
7,B,0.1,0.003,1e-3,1e-5,peak,
7,A,0.0,0.003,0,1e-5,peak,
7,C,0.2,0.003,2e-3,,peak,"its top, was cut off"
2,A,0.0,0.003,5e-3,1e-5,peak,
2,B,0.1,0.003,4e-3,2e-5,peak,
2,B2,0.1,-0.003,9e-3,1e-3,peak,
2,C,0.2,0.003,3e-3,1e-5,peak,
9,A,0.0,0.003,3e-3,1e-5,peak,
"""


def test_a_file_of_events(tmp_path, capsys):
    file = tmp_path / "picks.csv"
    file.write_text(PICKS)
    every = slipfront.read_onsets(file)
    assert list(every.event) == [2, 2, 2, 7, 7, 7, 9]
    assert every.notes == [
        "event 2: 1 more at a place that has one: that with the least error counts",
        "event 7: 1 place without an error of its time: the median of the others counts",
        "event 7: 1 place with a doubt on the onset",
    ]
    one = slipfront.read_onsets(file, event=7)
    assert list(one.x_m) == [0, 0.1, 0.2] and list(one.error_s) == [1e-5, 1e-5, 1e-5]  # C: the median
    out, series = tmp_path / "fronts.csv", tmp_path / "series.csv"
    two, seven, settings, nine = printed(capsys, file, "-o", out, "--series", series)
    assert two.startswith("event 2: from the right; front 0: x = 0.2000 to 0.0000 m, ")
    assert seven.startswith("event 7: from the left; ") and "speed 100 m/s, " in seven
    assert settings.startswith("--l-star-m 0.1, ")
    assert nine == "event 9: no fronts: 1 place with an onset"
    assert [r["event"] for r in rows_of(out)] == ["2"] * 3 + ["7"] * 3
    found = rows_of(series)
    assert [(r["event"], r["front"], r["stretch"], r["direction"], r["type"]) for r in found] == [
        ("2", "0", "0", "-1", "from the right"),
        ("7", "0", "0", "1", "from the left"),
    ]
    assert float(found[1]["x_from_m"]) == 0 and float(found[1]["speed_m_per_s"]) == pytest.approx(100)
    (only, *_) = printed(capsys, file, "--event", "7")
    assert only == seven


def test_the_interval_follows_from_the_errors_of_picks(tmp_path, capsys):
    """1.96 of 10 us over the root of the sum of squares of the distances, 0.02 m2, of 10 ms/m."""
    file = tmp_path / "picks.csv"
    file.write_text(PICKS)
    (line, *_) = printed(capsys, file, "--event", "7", "--resolution-s", "0")
    share = 1.96 * 1e-5 / np.sqrt(0.02) / 1e-2
    assert f", {100 / (1 + share):.4g} to {100 / (1 - share):.4g}, " in line


@pytest.mark.parametrize(
    "text, options, message",
    [
        (PICKS, ["--event", "3"], "has no event 3; it has 2, 7, 9"),
        (PICKS, ["--event", "9"], "1 place with an onset"),
        (PICKS.replace("7,A", "7.5,A"), [], "column 'event' holds what is no whole number from 0"),
        (PICKS.replace("0,1e-5", "0,0"), [], "holds an error of a time that is not above 0"),
        (PICKS.replace("0.2,0.003,2e-3", ",0.003,2e-3"), [], "a value of x_m is missing"),
        (PICKS.replace("error_s", "wrong"), [], "two onsets at x = 0.1 m in one event; delete one of their"),
        ("x_m,time_s\n0,0\n1,1\n", ["--event", "1"], "has no event 1; it has no events"),
        ("x_m,time_s\n0,0\n1,1\n", ["--x-range", "2,3"], "0 places with an onset from 2 to 3 m: no front"),
    ],
)
def test_mistakes_are_one_line(tmp_path, capsys, text, options, message):
    file = tmp_path / "picks.csv"
    file.write_text(text)
    assert call(file, *options) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    with pytest.raises(SystemExit):
        call(file, "--x-range", "3,2")
    assert "is not FROM,TO in m, ascending" in capsys.readouterr().err


def test_several_files_are_events_of_their_numbers(tmp_path, capsys):
    (tmp_path / "a").mkdir()
    for name in ("run3_event05.csv", "a/event5.csv", "without.csv"):
        (tmp_path / name).write_text("x_m,time_s\n0,0\n1,1e-3\n2,2e-3\n")
    first, again, without = (tmp_path / name for name in ("run3_event05.csv", "a/event5.csv", "without.csv"))
    assert call(first, again) == 2
    assert "event 5 is in" in capsys.readouterr().err
    assert call(first, without) == 2
    assert "without.csv: no number in its name, which would be its event's" in capsys.readouterr().err


# The laboratory's


@pytest.mark.parametrize("file", EVENTS, ids=lambda file: file.stem)
def test_fronts_of_the_laboratory(file):
    """One front, from the authors' side, or two that meet."""
    record = slipfront.read_onsets(file)
    found = slipfront.find_fronts(record.x_m, record.onset_s)
    kind, _ = authors(file)
    parts = slipfront.speed_stretches(found)
    assert parts.type == {1: "from the right", 2: "from the left", 3: "from both ends"}[kind]
    assert list(found.end.values) == (["meets_front"] * 2 if kind == 3 else ["record_edge"])


@pytest.mark.parametrize("file", [f for f in EVENTS if authors(f)[0] != 3], ids=lambda file: file.stem)
def test_speeds_are_the_authors(file):
    """On their range of x, place regressed on time. The standard error of the slope by the digitisation is
    that of the places, and that of the times at the speed, over the root of the sum of squares of the
    distances; two of it."""
    kind, speed = authors(file)
    record = slipfront.read_onsets(file)
    first, last = (2, 3) if kind == 1 else (0.5, 2)
    inside = ((record.x_m >= first) & (record.x_m <= last)).values
    x, t = record.x_m.values[inside], record.onset_s.values[inside]
    found = slipfront.find_fronts(x, t, place_error_m=PLACE_ERROR_M)
    assert found.sizes == {"point": len(x), "front": 1}
    error = np.hypot(PLACE_ERROR_M, abs(speed) * TIME_ERROR_S[kind]) / np.sqrt(np.sum((x - x.mean()) ** 2))
    made = float(found.speed_m_per_s[0]) * int(found.direction[0])
    assert made == pytest.approx(speed, rel=2 * error)
    assert 2 * error < 0.025


def test_a_front_of_the_laboratory_that_changes_its_speed(tmp_path, capsys):
    """Event 30 runs at 12 to 30 m/s, then at 110 to 360."""
    (line, _) = printed(capsys, LAB / "event30.csv", "-o", tmp_path / "fronts.csv")
    assert "speed changes at x = 1.9050 m: 20.29 m/s, 17.62 to 23.93, then 144.4 m/s, 127 to 167.2, " in line
    assert "no one speed" not in line
    rows = rows_of(tmp_path / "fronts.csv")
    assert [r["stretch"] for r in rows] == ["0"] * 7 + ["1"] * 10
    assert float(rows[-1]["stretch_speed_m_per_s"]) == pytest.approx(144.4, rel=1e-3)


def test_a_series_is_drawn(tmp_path, capsys):
    from slipfront.figures.front_series import draw_series

    picture, series = tmp_path / "series.svg", tmp_path / "series.csv"
    *lines, last = printed(capsys, *EVENTS, "--figure", picture, "--series", series)
    assert last == f"figure: {picture}" and picture.read_text().startswith("<?xml")
    assert [int(line.split()[1][:-1]) for line in lines[:6]] == [number(f) for f in EVENTS]
    assert len(rows_of(series)) == 14
    options = fronts_command.parse([str(file) for file in EVENTS])
    figure = draw_series(list(fronts_command.found_in(options, []))).figure
    left, right = figure.axes[:2]
    assert [text.get_text() for text in left.get_yticklabels()] == [str(number(f)) for f in EVENTS]
    marks = [line.get_marker() for line in left.lines if line.get_marker() in "<>"]
    assert marks == [">", "<", ">", "<", ">", ">", ">"]
    assert len(right.containers) == 14


def test_two_fronts_from_inside_as_before(capsys):
    lines = printed(capsys, CASES / "onsets_bilateral_8_places.csv")
    assert [line.split("speed ")[1][:7] for line in lines[:2]] == ["900 m/s"] * 2
