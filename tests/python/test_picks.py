# SPDX-License-Identifier: BSD-3-Clause
"""Onsets picked in traces of known ones: a tip past gauges of strain, slip and contact area beside them."""

from __future__ import annotations

import csv
import dataclasses

import h5py
import numpy as np
import pytest
import slipfront
from slipfront import fronts_command, picks_command
from slipfront.picks import pick, traces_of
from slipfront.records import Channel, Event, Writer

BODY = {"youngs_modulus_Pa": 5.65e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180.0}
CASE = {"material": BODY, "base": {"kind": "body", **BODY}}
Y_M, SPEED, NOISE, STEP_S = 3.5e-3, 800.0, 1e-6, 1e-6
TIME_S = np.arange(-1000, 1000) * STEP_S
X_M = np.linspace(0.02, 0.18, 9)
NUCLEATION_M = 0.08


def tip_times(event: int) -> np.ndarray:
    """Event 1 runs to +x, event 2 from the place of a gauge to both sides."""
    return (X_M if event == 1 else np.abs(X_M - NUCLEATION_M)) / SPEED + 1e-4


def shear(tip_s: float, direction: int = 1, time_s: np.ndarray = TIME_S) -> np.ndarray:
    """Of a tip that passes; the residual stress comes within the time of the gauge's height."""
    ahead = -SPEED * direction * (time_s - tip_s)
    field = slipfront.tip_field(CASE, ahead, np.full_like(ahead, Y_M), speed_m_per_s=SPEED,
                                Gamma_J_per_m2=1.1, direction=direction)  # fmt: skip
    return field["xy"] - 2e-5 * (1 + np.tanh((time_s - tip_s) * SPEED / Y_M))


def seen_peak_s() -> float:
    """From a tip that passes at 0 to its peak of shear, by fine samples."""
    time_s = np.linspace(-3e-5, 0, 30_001)
    return float(time_s[np.argmax(shear(0.0, time_s=time_s))])


def slip(tip_s: float) -> np.ndarray:
    return np.where(tip_s < TIME_S, 2e-5 * (1 - np.exp(-(TIME_S - tip_s) / 2e-4)), 0.0)


def area(tip_s: float) -> np.ndarray:
    return 1 - 0.1 * (1 + np.tanh((TIME_S - tip_s) / 5e-6))


MADE = {  # by kind: how a trace is made, its noise
    "strain_xy": (shear, NOISE),
    "slip": (slip, 1e-7),
    "contact_area": (area, 2e-3),
}


def event(number: int = 1, kinds=("strain_xy",), noise: float = 1.0, seed: int = 1, **fields) -> Event:
    random = np.random.default_rng(seed)
    channels = {}
    for k, (x_m, tip_s) in enumerate(zip(X_M, tip_times(number), strict=True)):
        for kind in kinds:
            make, own = MADE[kind]
            way = (-1,) if kind == "strain_xy" and number == 2 and x_m < NUCLEATION_M - 1e-9 else ()
            values = make(tip_s, *way) + noise * own * random.standard_normal(len(TIME_S))
            name = f"{kind}_{k}"
            channels[name] = Channel(name, kind, f"{kind[:2]}{k}", TIME_S, values, float(x_m), Y_M, **fields)
    return Event(number, 2.5 * number, channels, "made.h5")


def with_channel(of: Event, name: str, **fields) -> Event:
    changed = dataclasses.replace(of.channels[name], **fields)
    return dataclasses.replace(of, channels={**of.channels, name: changed})


def write(file, events):
    with h5py.File(file, "w") as hdf5:
        writer = Writer(hdf5, {})
        for one in events:
            for channel in one.channels.values():
                writer.put(one.number, one.time_s, channel)
            writer.end(one)
    return file


@pytest.fixture(scope="module")
def both():
    return [event(1), event(2, seed=2)]


# Methods


@pytest.mark.parametrize("noise", [0.01, 1.0, 4.0])
def test_peaks_are_where_the_field_has_them(noise):
    """All are off by their errors: chi squared of 27 over 27 is below 2.3 with 99.99 %. Noise of 1 is 2.5 %
    of the peak."""
    off = []
    for seed in range(3):
        picks = slipfront.pick_events([event(noise=noise, seed=seed)])
        assert picks.sizes["pick"] == 9 and set(picks.by.values) == {"peak"}
        off.append((picks.onset_s.values - tip_times(1) - seen_peak_s()) / picks.error_s.values)
    assert np.mean(np.square(off)) < 2.3
    assert np.median(picks.error_s) < {0.01: 0.6e-6, 1.0: 1.5e-6, 4.0: 4e-6}[noise]


@pytest.mark.parametrize("sign", [1, -1])
def test_a_peak_counts_and_not_the_dip_behind_it(sign):
    """Near the interface a trace comes back from the dip by more than it fell to it."""
    made = event(noise=0.2)
    (name, channel), *_ = made.channels.items()
    peak_s, dip_s = tip_times(1)[0], tip_times(1)[0] + 12e-6
    shape = np.exp(-0.5 * ((TIME_S - peak_s) / 4e-6) ** 2) - 2 * np.exp(-0.5 * ((TIME_S - dip_s) / 4e-6) ** 2)
    values = sign * channel.values.max() * (shape + 2 * np.clip((TIME_S - dip_s) / 20e-6, 0, 1))
    found = slipfront.pick_events([with_channel(made, name, values=values)])
    at = int(np.argmin(np.abs(found.x_m.values - X_M[0])))
    assert float(found.onset_s[at]) == pytest.approx(peak_s, abs=1.5e-6)


def test_another_top_as_high_is_doubted():
    """A broad hump before the front's peak: which is it, the noise does not tell."""
    made = event(noise=0.2)
    (name, channel), *_ = made.channels.items()
    earlier_s = 40e-6
    tip_s = tip_times(1)[0] + seen_peak_s()
    hump = channel.values.max() * np.exp(-0.5 * ((TIME_S - tip_s + earlier_s) / 4e-6) ** 2)
    found = slipfront.pick_events([with_channel(made, name, values=np.maximum(channel.values, hump))])
    at = int(np.argmin(np.abs(found.x_m.values - X_M[0])))
    assert "as high within the noise" in str(found.doubt[at])
    assert float(found.error_s[at]) == pytest.approx(earlier_s, rel=0.2)
    assert (found.doubt.values == "").sum() == len(found.doubt) - 1


def test_a_peak_of_either_sign_is_found():
    turned = {name: dataclasses.replace(c, values=-c.values) for name, c in event().channels.items()}
    found = slipfront.pick_events([dataclasses.replace(event(), channels=turned)])
    assert np.array_equal(found.onset_s, slipfront.pick_events([event()]).onset_s)


def test_a_top_that_was_cut_off_is_in_doubt():
    whole = event(seed=2)
    values = whole.channels["strain_xy_4"].values
    cut_off = np.minimum(values, 0.6 * values.max())
    at = TIME_S[cut_off == cut_off.max()]
    flat = (float(at[0]), float(at[-1]))
    picks = slipfront.pick_events([with_channel(whole, "strain_xy_4", values=cut_off, flat_s=(flat,))])
    assert [bool(doubt) for doubt in picks.doubt.values] == [k == 4 for k in range(9)]
    assert str(picks.doubt.values[4]) == "its top was cut off"
    error = float(picks.error_s[4])
    assert error == pytest.approx(np.hypot((flat[1] - flat[0]) / 2, STEP_S / 2))
    assert abs(float(picks.onset_s[4]) - tip_times(1)[4] - seen_peak_s()) < error


def test_thresholds_are_passed_when_the_trace_is_so_large():
    """Slip begins at 0.1 m/s; 5 times the noise are 5 us of it, 8 times 8 us."""
    for times_noise in (5, 8):
        picks = slipfront.pick_events([event(kinds=("slip",))], times_noise=times_noise)
        assert set(picks.by.values) == {"threshold"}
        off = picks.onset_s.values - tip_times(1) - times_noise * 1e-6
        # Noise over slope is 1 us; 5 samples above the threshold may be later.
        assert np.abs(off).max() < 4e-6 and picks.error_s.values == pytest.approx(1.1e-6, rel=0.8)


def test_a_threshold_is_held():
    """A single large sample is no onset."""
    of = event(kinds=("slip",))
    values = of.channels["slip_3"].values.copy()
    values[1000] = 1e-5
    spiked = slipfront.pick_events([with_channel(of, "slip_3", values=values)])
    assert abs(float(spiked.onset_s[3]) - tip_times(1)[3]) < 1e-5


@pytest.mark.parametrize("by, late_s", [("aic", 6e-6), ("kurtosis", 8e-6)])
def test_sudden_beginnings(by, late_s):
    """They are seen when slip at 0.1 m/s has left its noise of 0.1 um."""
    picks = slipfront.pick_events([event(kinds=("slip",), seed=5)], by=by)
    off = picks.onset_s.values - tip_times(1)
    assert (off > -STEP_S).all() and (off < late_s).all()
    assert (picks.error_s.values >= STEP_S / 2).all() and (picks.error_s.values < 5e-6).all()


def test_aic_is_the_least_of_the_criterion():
    (trace, *_) = (make() for *_, make in traces_of(event(kinds=("slip",)), None))
    found = pick(trace, "aic")
    n = int(np.argmax(np.abs(trace.values))) + 1
    v = trace.values[:n]
    criterion = [k * np.log(v[:k].var()) + (n - k - 1) * np.log(v[k:].var()) for k in range(5, n - 1)]
    k = 5 + int(np.argmin(criterion))
    assert found.time_s == pytest.approx((TIME_S[k - 1] + TIME_S[k]) / 2, abs=1e-12)


@pytest.mark.parametrize("noise", [0.1, 1.0, 5.0])
def test_contact_area_falls_steepest_at_the_tip(noise):
    off = []
    for seed in range(3):
        picks = slipfront.pick_events([event(kinds=("contact_area",), noise=noise, seed=seed)])
        assert set(picks.by.values) == {"area"}
        off.append((picks.onset_s.values - tip_times(1)) / picks.error_s.values)
    assert np.mean(np.square(off)) < 2.3
    assert np.median(picks.error_s) < 3e-6


def test_the_delay_of_the_bandwidth_is_subtracted():
    known = slipfront.pick_events([event(bandwidth_Hz=50e3)])
    assert known.onset_s.values == pytest.approx(
        slipfront.pick_events([event()]).onset_s.values - 1 / (2 * np.pi * 50e3), abs=1e-12
    )


# What is picked


def test_the_best_kind_that_is_there_is_picked_and_told():
    kinds = ("strain_xy", "slip", "contact_area")
    picks = slipfront.pick_events([event(kinds=kinds)])
    assert picks.notes == [
        "9 picks by peak, of shear strain or stress",
        "not picked: 9 of slip or displacement (kind slip)",
        "not picked: 9 of contact area (kind contact_area)",
    ]
    assert set(slipfront.pick_events([event(kinds=kinds)], by="area").gauge.values) == {
        f"contact_area_{k}" for k in range(9)
    }
    assert set(slipfront.pick_events([event(kinds=kinds)], kind="slip").by.values) == {"threshold"}
    assert not any(
        "strain" in name for name in slipfront.pick_events([event(kinds=kinds)], by="kurtosis").gauge.values
    )


def test_arms_of_a_rosette_give_shear():
    """Three arms whose difference is shear."""
    channels, of = {}, event()
    for name, c in of.channels.items():
        for angle, share in ((-45.0, -1.0), (90.0, 0.0), (45.0, 1.0)):
            arm = f"{name}_{angle:g}"
            channels[arm] = dataclasses.replace(
                c, name=arm, kind="strain", angle_deg=angle, values=share * c.values
            )
    found = slipfront.pick_events([dataclasses.replace(of, channels=channels)])
    assert found.onset_s.values == pytest.approx(slipfront.pick_events([of]).onset_s.values, abs=1e-12)
    alone = {name: c for name, c in channels.items() if c.angle_deg == 45.0}
    one = slipfront.pick_events([dataclasses.replace(of, channels=alone)])
    assert one.notes[0] == "9 picks by threshold, of strain or stress without shear"


def test_traces_without_a_pick_are_told():
    of = event()
    random = np.random.default_rng(4)
    silent = with_channel(of, "strain_xy_2", values=NOISE * random.standard_normal(len(TIME_S)))
    constant = with_channel(silent, "strain_xy_3", values=np.zeros(len(TIME_S)))
    rising = with_channel(
        constant, "strain_xy_5", values=np.maximum(TIME_S, 0) + NOISE * random.standard_normal(len(TIME_S))
    )
    dead = with_channel(rising, "strain_xy_7", values=np.full(len(TIME_S), np.nan))
    picks = slipfront.pick_events([dead])
    assert picks.sizes["pick"] == 5
    assert picks.notes[1:] == [
        "event 1: st2: no pick: no value before a fall stands 5 times the noise out",
        "event 1: st3: no pick: is the same number throughout",
        "event 1: st5: no pick: no value before a fall stands 5 times the noise out",
        "event 1: st7: no pick: gauge st7: has no values: leave it out",
    ]
    for by, why in (("threshold", "out for 5 samples"), ("aic", "nothing stands 5 times the noise out")):
        assert any(why in note for note in slipfront.pick_events([silent], by=by).notes)


def test_a_slope_of_the_quiet_part_is_no_onset():
    of = event(kinds=("slip",))
    drifts = with_channel(of, "slip_8", values=of.channels["slip_8"].values + 1e-3 * TIME_S)
    assert slipfront.pick_events([drifts]).onset_s.values == pytest.approx(
        slipfront.pick_events([of]).onset_s.values, abs=2e-6
    )


def test_other_parts_are_quiet_where_they_are_given():
    """What happens in the quiet part counts as noise."""
    of = event()
    noisy = of.channels["strain_xy_0"].values + 2e-5 * np.sin(2e5 * TIME_S) * (TIME_S < -6e-4)
    bad = with_channel(of, "strain_xy_0", values=noisy)
    assert "st0" not in slipfront.pick_events([bad]).gauge.values
    found = slipfront.pick_events([bad], quiet_s=(-5e-4, -1e-4))
    assert str(found.gauge.values[0]) == "st0"
    assert abs(float(found.onset_s[0]) - tip_times(1)[0] - seen_peak_s()) < 3e-6


@pytest.mark.parametrize(
    "options, why",
    [
        ({"by": "eye"}, "by is 'eye'; it must be one of peak, threshold, aic, kurtosis, area"),
        ({"kind": "light"}, "kind is 'light'; it must be one of shear, contact_area, "),
        ({"by": "area", "kind": "slip"}, "by is area, which picks contact area; kind is slip: leave one"),
        ({"by": "kurtosis", "kind": "shear"}, "by is kurtosis, which picks what begins suddenly"),
        ({"times_noise": 0}, "times_noise is 0; it must be above 0"),
        ({"quiet_s": (1, 0)}, r"quiet_s is \(1, 0\); it must be a pair of times in s that ascend"),
    ],
)
def test_wrong_arguments(both, options, why):
    with pytest.raises(slipfront.CaseError, match="events is None; it must be a list of events"):
        slipfront.pick_events(None)
    with pytest.raises(slipfront.CaseError, match=why):
        slipfront.pick_events(both, **options)


# The command


def call(*arguments) -> int:
    return picks_command.main([str(a) for a in arguments])


def test_picks_of_a_file_become_fronts(tmp_path, capsys, both):
    file, out = write(tmp_path / "records.nc", both), tmp_path / "picks.csv"
    assert call(file, "-o", out) == 0
    first, second, kinds = capsys.readouterr().out.splitlines()
    assert first.startswith("event 1: 9 picks, 1") and second.startswith("event 2: 9 picks, ")
    assert kinds == "18 picks by peak, of shear strain or stress"
    text = out.read_text()
    assert text.startswith("# picks by slipfront picks\nevent,gauge,x_m,y_m,onset_s,error_s,by,doubt\n")
    rows = list(csv.DictReader(text.splitlines()[1:]))
    found = slipfront.pick_events(both)
    assert [float(row["onset_s"]) for row in rows] == found.onset_s.values.tolist()
    assert fronts_command.main([str(out)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("event 1: from the left; ") and lines[1].startswith("event 2: from inside; ")
    # The file of records is picked by the same method, which is told.
    assert fronts_command.main([str(file)]) == 0
    assert capsys.readouterr().out.splitlines() == [*lines, kinds]
    # Edited by hand: a row deleted, a time changed.
    edited = [row for row in text.splitlines() if not row.startswith("1,st4,")]
    out.write_text("\n".join(edited).replace("2,st0,0.02,0.0035,", "2,st0,0.02,0.0035,-") + "\n")
    record = slipfront.read_onsets(out)
    assert int((record.event == 1).sum()) == 8
    assert float(record.onset_s[record.event == 2][0]) == -found.onset_s.values[9]


def test_speeds_of_picks_are_those_of_the_tip(both):
    """All peaks come equally early, before each passing tip."""
    for number, ways in ((1, [1]), (2, [-1, 1])):
        picks = slipfront.pick_events([both[number - 1]])
        fronts = slipfront.find_fronts(picks.x_m, picks.onset_s, time_error_s=picks.error_s, resolution_s=0)
        assert list(fronts.direction) == ways
        assert (fronts.speed_low_m_per_s < SPEED).all() and (fronts.speed_high_m_per_s > SPEED).all()
        assert fronts.speed_m_per_s.values == pytest.approx(SPEED, rel=0.03)


def test_sections_are_drawn(tmp_path, capsys, both):
    from matplotlib.colors import to_hex
    from slipfront.figures.picks import draw_section
    from slipfront.figures.style import DIRECTION_COLOURS

    file = write(tmp_path / "records.nc", both)
    pages = tmp_path / "sections.pdf"
    assert call(file, "--figure", pages) == 0
    assert pages.read_bytes().count(b"/Type /Page ") == 2
    first = pages.read_bytes()
    assert call(file, "--figure", pages) == 0 and pages.read_bytes() == first
    assert call(file, "--figure", tmp_path / "a.png") == 2
    assert "one picture of 2 events: give one by --event, or a .pdf" in capsys.readouterr().err
    assert call(file, "--event", "2", "--figure", tmp_path / "a.png") == 0
    figure = draw_section(both[1], slipfront.pick_events(both[1:]))
    (ax,) = figure.axes
    lines = [line for line in ax.lines if (line.get_gid() or "").startswith("stretch")]
    assert [to_hex(line.get_color()) for line in lines] == [DIRECTION_COLOURS[-1], DIRECTION_COLOURS[1]]
    t, x = (np.diff(v)[0] for v in lines[1].get_data())  # us and mm
    assert 1e3 * x / t == pytest.approx(SPEED, rel=0.03)
    assert sum("m/s" in text.get_text() for text in ax.texts) == 2
    # Each trace is drawn.
    assert {f"st{k}" for k in range(9)} <= {text.get_text() for text in ax.texts}


def test_mistakes_of_the_command_are_one_line(tmp_path, capsys, both):
    file = write(tmp_path / "records.nc", both)
    other = tmp_path / "mine.csv"
    other.write_text("mine")
    (tmp_path / "text.nc").write_text("text")
    nowhere = dataclasses.replace(both[0], channels={
        "F": Channel("F", "force_shear", "F", TIME_S, np.zeros(len(TIME_S)))
    })  # fmt: skip
    for arguments, message in (
        ([file, "-o", other], "mine.csv: is there and not a table of slipfront picks: not replaced"),
        ([file, "--event", "4"], "has no event 4; it has 1, 2"),
        (
            [file, "--kind", "slip"],
            "nothing is picked: event 2: no pick: no channel of slip or displacement with",
        ),
        ([file, "--by", "area", "--kind", "shear"], "--kind is shear: leave one of them out"),
        ([file, "--quiet-s", "5,6"], "0 samples are quiet, 10 are needed: give others by --quiet-s"),
        ([file, "--figure", "a.txt"], "the picture's name must end with"),
        ([tmp_path / "text.nc"], "text.nc: damaged, or not an HDF5 file"),
        ([write(tmp_path / "f.nc", [nowhere])], "no channel of strain, contact area, slip or acceleration"),
    ):
        assert call(*arguments) == 2, arguments
        error = capsys.readouterr().err
        assert message in error and error.count("\n") == 1
