# SPDX-License-Identifier: BSD-3-Clause
"""Records of onsets: their forms and units, marks of places that never slip, settings of the record's own."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import slipfront
from common import ROOT
from slipfront import fronts_command

CASES = ROOT / "tests/cli/cases"
SLOW = CASES / "onsets_slow_30_m_per_s.csv"
X_M = [-0.02, -0.01, 0.0, 0.01, 0.02]
ONSET_S = [0.0, 1.25e-05, 2.5e-05, np.nan, 5e-05]


def printed(capsys, file, *options):
    assert fronts_command.main([str(file), *options]) == 0
    return capsys.readouterr().out.splitlines()


@pytest.mark.parametrize(
    "text",
    [
        "x_m,time_s\n-0.02,0\n-0.01,1.25e-5\n0,2.5e-5\n0.01,\n0.02,5e-5\n",
        "x_mm,time_us\n-20,0\n-10,12.5\n0,25\n10,nan\n20,50\n",
        "x (mm),onset [ms]\n-20,0\n-10,0.0125\n0,0.025\n10,-1\n20,0.05\n",
        "x / cm;t / µs\n-2;0\n-1;12,5\n0;25,0\n1;1e9\n2;50\n",
        "gauge\tposition_mm\tarrival_time_us\nA\t-20\t0\nB\t-10\t12,5\nC\t0\t25\nD\t10\tinf\nE\t20\t50\n",
        "x_km,time_seconds\n-2e-5,0\n-1e-5,1.25e-5\n0,2.5e-5\n1e-5,-\n2e-5,5e-5\n",
        "Position (mm),Time (us)\r\n-20,0\r\n-10,12.5\r\n0,25\r\n10,9999\r\n20,50\r\n",
    ],
)
def test_forms_and_units(tmp_path, text):
    file = tmp_path / "onsets.csv"
    file.write_text(text, encoding="utf-8")
    record = slipfront.read_onsets(file)
    assert np.allclose(record.x_m, X_M, rtol=1e-15, atol=0)
    assert np.allclose(record.onset_s, ONSET_S, rtol=1e-15, atol=0, equal_nan=True)
    (note,) = record.notes
    assert note.startswith("1 place ") and "never slipped" in note


def test_a_file_of_matlab(tmp_path):
    io = pytest.importorskip("scipy.io")
    file = tmp_path / "onsets.mat"
    io.savemat(file, {"x_mm": 1e3 * np.array([X_M]), "time_us": 1e6 * np.array([ONSET_S]).T, "fs": 1e6})
    record = slipfront.read_onsets(file)
    assert np.allclose(record.x_m, X_M, rtol=1e-15, atol=0)
    assert np.allclose(record.onset_s, ONSET_S, rtol=1e-15, atol=0, equal_nan=True)
    io.savemat(file, {"x": X_M, "time": ONSET_S})
    with pytest.raises(slipfront.Error, match=r"has the columns 'x', 'time'; wanted are"):
        slipfront.read_onsets(file)
    file.write_text("x_mm")
    with pytest.raises(slipfront.Error, match="damaged, or not a .mat file"):
        slipfront.read_onsets(file)


def test_no_record_is_refused(tmp_path):
    with pytest.raises(slipfront.CaseError, match="file is None; it must be a path"):
        slipfront.read_onsets(None)
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(slipfront.Error, match=r"empty\.csv: empty"):
        slipfront.read_onsets(tmp_path / "empty.csv")


@pytest.mark.parametrize(
    ("times", "mark", "never"),
    [
        ([0, 1, 2, -1, 4], None, 1),
        ([0, 1, 2, -1, 4], "none", 0),
        ([-2, -1, 0, 1, 2], None, 0),  # a clock that began later
        ([0, 1, 2, 1e9, 1e9], None, 2),
        ([0, 1, 2, 1e300, 1e300], None, 2),
        ([0, 1, 999, -1, 9999], None, 2),  # 999 is no farther from 1 than 9999 from it
        ([1e9, 1e9 + 1, 1e9 + 2, 1e9 + 3, 1e9 + 4], None, 0),
        ([0, 1, 77, 3, 4], 77, 1),
        ([0, np.inf, np.nan, 3, 4], None, 2),
    ],
)
def test_marks_of_places_that_never_slip(times, mark, never):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = slipfront.find_fronts(X_M, times, never_slipped=mark)
    counted = sum(int(note.split()[0]) for note in found.notes if "never slipped" in note)
    assert counted == never
    guessed = [note for note in found.notes if "taken as never slipped" in note]
    assert [str(each.message) for each in told] == guessed
    assert bool(guessed) == (bool(never) and mark is None and bool(np.isfinite(times).all()))


def test_a_slow_front_past_gauges(capsys):
    front, _ = printed(capsys, SLOW)
    assert front.startswith("front 0: x = 0.0000 to 0.2000 m, ")
    assert ", speed 30 m/s, " in front and front.endswith(", ends: record_edge")


def test_a_front_past_uneven_gauges():
    x = np.cumsum([0, 7, 13, 9, 12, 8, 11, 7, 13, 10, 9, 12, 8]) * 1e-3
    found = slipfront.find_fronts(x, x / 300)
    assert found.sizes == {"point": 13, "front": 1}
    assert float(found.speed_m_per_s[0]) == pytest.approx(300, rel=1e-9)
    assert found.l_star_m == pytest.approx(9.5e-3)
    assert found.min_length_m == pytest.approx(19e-3)
    assert found.arrest_time_s == pytest.approx(5 * 19e-3 / 300)


def test_options_that_lose_onsets_are_named(capsys):
    lines = printed(capsys, SLOW, "--arrest-time-s", "20e-6")
    assert lines[0] == "no fronts"
    assert (
        lines[-1]
        == "41 of 41 onsets in no front: 41 whose neighbours slip more than --arrest-time-s earlier or later"
    )
    lines = printed(capsys, SLOW, "--min-length-m", "1")
    assert lines[-1] == "41 of 41 onsets in no front: 41 on paths shorter than --min-length-m"


def test_onsets_beside_a_front_are_told():
    x = np.arange(40) * 1e-3
    onset = x / 1000
    onset[30:] = np.nan
    onset[35] = 1e-3  # alone
    onset[37:39] = 2e-3, 2.001e-3  # a pair
    found = slipfront.find_fronts(x, onset)
    assert list(found.end.values) == ["arrest"]
    assert found.notes[-1] == (
        "3 of 33 onsets in no front: 1 between places that never slip, 2 on paths shorter than min_length_m"
    )


@pytest.mark.parametrize("speed", [430.0, 900.0, 1310.0])
def test_times_of_frames_give_an_interval(speed):
    x = np.arange(200) * 1e-3
    frame = 5e-6
    onset = np.floor((x + 0.3e-3) / speed / frame) * frame
    found = slipfront.find_fronts(x, onset)
    assert found.time_step_s == pytest.approx(frame)
    k = int(np.argmax(np.diff([*np.searchsorted(found.front_id, found.front), found.sizes["point"]])))
    low, middle, high = (float(found[f"speed_{part}m_per_s"][k]) for part in ("low_", "", "high_"))
    assert low < speed < high
    # A line through times wrong by half a frame: 1.5 frames of the time that the front takes.
    duration = 0.2 / speed
    assert high - low < 1.1 * 2 * 1.5 * frame / duration * middle


def test_intervals_of_few_onsets_are_wide():
    def interval(onset_s):
        x = np.arange(len(onset_s)) * 1e-3
        return slipfront.find_fronts(
            x, onset_s, resolution_s=0.0, settings=slipfront.FrontSettings(min_length_m=1e-3)
        )

    three = interval([0.0, 1e-6, 3e-6])
    # Squares of times and places about their means 14/3 us2 and 2 mm2: slope sqrt(7/3) us/mm. About the line
    # of time on place 1/6 us2 of 1 degree of freedom; Student's t is a tangent.
    low = 1e3 / (np.sqrt(7 / 3) + np.tan(0.475 * np.pi) / np.sqrt(12))
    assert float(three.speed_low_m_per_s[0]) == pytest.approx(low, rel=1e-9)
    assert float(three.speed_high_m_per_s[0]) == np.inf
    two = interval([0.0, 1e-6])  # of a clock that is exact
    assert (float(two.speed_low_m_per_s[0]), float(two.speed_high_m_per_s[0])) == (0, np.inf)


def test_a_place_that_two_fronts_share_is_on_neither_line():
    """Slip begins between two of eight places and runs at 900 m/s to both sides."""
    record = slipfront.read_onsets(CASES / "onsets_bilateral_8_places.csv")
    found = slipfront.find_fronts(record.x_m, record.onset_s)
    assert found.sizes["point"] == 9  # one place in both
    assert found.speed_m_per_s.values == pytest.approx([900, 900], rel=1e-5)  # places have six digits
    # Of three places two are left, and of two one.
    x_m = np.array([0.0, 1.0, 2.0, 3.0])
    few = slipfront.find_fronts(
        x_m, [1e-3, 0.0, 1e-3, 2e-3], settings=slipfront.FrontSettings(min_length_m=0.5)
    )
    assert np.isnan(few.speed_m_per_s[0]) and float(few.speed_m_per_s[1]) == pytest.approx(1000)


def test_lines_by_the_errors_of_places_and_times():
    """A front past the gauges of a fault (Okubo, Yamashita and Fukuyama 2025, FB03-087, event 2); its authors
    regress place on time."""
    record = slipfront.read_onsets(CASES / "onsets_okubo_event02.csv")
    within = (record.x_m >= 0.5) & (record.x_m <= 2.0)
    x, t = record.x_m.values[within], record.onset_s.values[within]

    def speed(**errors):
        found = slipfront.find_fronts(x, t, **errors)
        assert found.sizes["point"] == x.size
        return float(found.speed_m_per_s[0])

    place_on_time, time_on_place = np.polyfit(t, x, 1)[0], 1 / np.polyfit(x, t, 1)[0]
    assert place_on_time == pytest.approx(28.8, abs=0.1)  # the authors' from places of their own
    assert speed(place_error_m=5e-3) == pytest.approx(place_on_time, rel=1e-9)
    assert speed(time_error_s=1e-4) == pytest.approx(time_on_place, rel=1e-9)
    assert speed() == pytest.approx(np.sqrt(place_on_time * time_on_place), rel=1e-9)
    # The closed form is the least of the weighted squares of the distances from the line.
    errors = {"place_error_m": 20e-3, "time_error_s": 1e-3}
    made = 1 / speed(**errors)

    def squares(slope):
        off = t - t.mean() - slope * (x - x.mean())
        return (off @ off) / (1e-6 + (slope * 20e-3) ** 2)

    assert squares(made) < min(squares(made * (1 + 1e-4)), squares(made * (1 - 1e-4)))
    for wrong, why in (
        ({"place_error_m": -1}, "place_error_m is -1; it must be at least 0"),
        ({"time_error_s": np.inf}, "time_error_s is inf; it must be finite"),
        ({"time_error_s": 0, "place_error_m": 0}, "both 0"),
    ):
        with pytest.raises(slipfront.CaseError, match=why):
            slipfront.find_fronts(x, t, **wrong)


def test_errors_on_the_command_line(capsys):
    file = CASES / "onsets_okubo_event02.csv"
    lines = [
        printed(capsys, file, *options)[0]
        for options in ((), ("--place-error-m", "5e-3"), ("--time-error-s", "1e-4"))
    ]
    assert len(set(lines)) == 3
    assert fronts_command.main([str(file), "--place-error-m", "0"]) == 2
    assert "--place-error-m and --time-error-s are both 0" in capsys.readouterr().err


def test_a_search_of_many_places_can_be_interrupted():
    """The signal comes before the search looks for one."""
    import signal

    x = np.linspace(0, 1, 20_000)
    handler = signal.getsignal(signal.SIGALRM)

    def stop(*_):
        raise KeyboardInterrupt

    from slipfront import _core

    options = _core.FrontOptions()
    ones = np.ones_like(x)
    signal.signal(signal.SIGALRM, stop)
    try:
        with pytest.raises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, 1e-3)
            while True:
                _core.find_fronts(x, x / 1000, ones, ones, 1.0, 0.0, options)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, handler)


@pytest.mark.parametrize(
    "onset_us, step",
    [
        ([0, 70, 140, 210, 280], 10e-6),  # uniform: the last digit, not the time from place to place
        ([0, 63, 141, 207, 283], 1e-6),  # rounded
        ([0, 65, 140, 210, 285], 5e-6),
        ([0, 70], 70e-6),  # nothing else is known
    ],
)
def test_the_step_of_times_is_that_of_the_clock(onset_us, step):
    found = slipfront.find_fronts(0.1 * np.arange(len(onset_us)), 1e-6 * np.array(onset_us))
    assert found.time_step_s == pytest.approx(step)


def test_a_record_from_right_to_left_is_turned_round(tmp_path):
    rows = ["1.0,9", "0.5,5", "0.0,1"]
    for name, order in (("down.csv", 1), ("up.csv", -1)):
        (tmp_path / name).write_text("\n".join(["x_mm,time_us", *rows[::order]]) + "\n")
    assert slipfront.read_onsets(tmp_path / "down.csv").equals(slipfront.read_onsets(tmp_path / "up.csv"))


def test_intervals_hold_the_errors_that_are_given():
    """Exact times of 1,000 m/s at places 2 mm apart with an error of 1 mm: 1.96 of it over the root of the
    sum of squares of the distances, 40 mm2."""
    x_m = 2e-3 * np.arange(5)
    given = {"resolution_s": 0.0, "place_error_m": 1e-3}
    fronts = slipfront.find_fronts(x_m, x_m / 1e3, never_slipped="none", **given)
    share = 1.96 * 1e-3 / np.sqrt(40e-6)
    assert float(fronts.speed_m_per_s[0]) == pytest.approx(1e3, rel=1e-12)
    assert float(fronts.speed_low_m_per_s[0]) == pytest.approx(1e3 / (1 + share), rel=1e-9)
    assert float(fronts.speed_high_m_per_s[0]) == pytest.approx(1e3 / (1 - share), rel=1e-9)


@pytest.mark.parametrize(
    "onset_s, doubt",
    [
        ([0.0, 1e-5, np.nan, np.nan, np.nan], "front 0: two onsets make its speed"),
        ([0.0, 1e-6, 2e-6, 42e-6, 82e-6], "front 0: v_tip is 250 to 1e+04 m/s: no one speed is that"),
    ],
)
def test_lines_that_say_little_are_in_doubt(onset_s, doubt):
    settings = slipfront.FrontSettings(arrest_time_s=1e-3, min_length_m=5e-3)
    found = slipfront.find_fronts(0.01 * np.arange(5), onset_s, settings=settings)
    assert any(note.startswith(doubt) for note in found.notes), found.notes
    even = slipfront.find_fronts(0.01 * np.arange(5), 1e-5 * np.arange(5), settings=settings)
    assert not any(note.startswith("front ") for note in even.notes)


def lines_of(tmp_path, capsys, times, *options):
    file = tmp_path / "onsets.csv"
    rows = [f"{20 * k},{time}" for k, time in enumerate(times)]
    file.write_text("\n".join(["x_mm,time_us", *rows]) + "\n")
    return printed(capsys, file, *options)


def test_two_places_make_a_front(tmp_path, capsys):
    """Its doubt stands in its own line."""
    front, used = lines_of(tmp_path, capsys, [0, 10])
    assert ", speed 2000 m/s, 1000 or more, " in front
    assert front.endswith("; two onsets make its speed, nothing tells whether they are of one front")
    assert "--min-length-m 0.02" in used


def test_onsets_at_one_time_are_told_in_one_line(tmp_path, capsys):
    assert lines_of(tmp_path, capsys, [7, 7, 7, 7]) == ["no fronts: all 4 onsets are at 7e-06 s"]


def test_speeds_far_below_those_of_waves_are_told(tmp_path, capsys):
    front, *_, note = lines_of(tmp_path, capsys, range(0, 100_000, 10_000), "--c-l-m-per-s", "5000")
    assert ", speed 2 m/s" in front and "(0.0004 c_L)" in front
    assert note == "a speed is below 0.001 c_L: check the units of x and time, unless slip creeps"
    front, _ = lines_of(tmp_path, capsys, range(0, 100, 10), "--c-l-m-per-s", "5000")
    assert "(0.40 c_L)" in front


def test_errors_that_are_missing_or_wrong_are_told(tmp_path):
    file = tmp_path / "onsets.csv"
    file.write_text("x_mm,time_us,error_us\n-20,0,2\n-10,12,\n0,25,1\n10,,\n20,50,3\n")
    record = slipfront.read_onsets(file)
    assert record.error_s.values.tolist() == pytest.approx([2e-6, 2e-6, 1e-6, 2e-6, 3e-6])
    told = "1 place without an error of its time: the median of the others counts"
    assert told in record.attrs["notes"]
    file.write_text("x_mm,time_us,error_us\n-20,0,2\n-10,12,0\n")
    with pytest.raises(slipfront.Error, match="an error of a time that is not above 0, at x = -10"):
        slipfront.read_onsets(file)
