# SPDX-License-Identifier: BSD-3-Clause
"""Runs, sequences and sweeps beside records: what is left between them, its error, and what is refused."""

from __future__ import annotations

import dataclasses

import h5py
import numpy as np
import pandas as pd
import pytest
import slipfront
from common import built, rows_of
from package_cases import PLATE, TILT, blocks, results_of, write_case
from slipfront.compare import command
from slipfront.compare.onsets import onsets_at
from slipfront.compare.speeds import points_of
from slipfront.records import Writer
from slipfront.sweep import run as run_sweep

BLOCKS = blocks(2e-3, 0.1e-6, d_c_m=4e-6, half_length_m=0.025, end_s=180e-6)
PROBES = {
    "x_m": [0.0875, 0.1075, 0.1275, 0.109], "y_m": [5e-3, 5e-3, 5e-3, 5e-3],
    "names": ["SG1", "SG2", "SG3", "beside"], "interval_s": 0.25e-6,
}  # fmt: skip
SEQUENCE = f"""\
{PLATE}{TILT}plate.element_size_m = 4e-3
event.kind = "spontaneous"
sequence.max_events = 6
"""
PLACES_M = np.linspace(0.07, 0.145, 12)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A front between two blocks of PMMA."""
    return slipfront.run(BLOCKS | {"probes": PROBES}, output=tmp_path_factory.mktemp("compare") / "out")


@pytest.fixture(scope="module")
def sequence(tmp_path_factory):
    return slipfront.open(results_of(tmp_path_factory.mktemp("cycles"), SEQUENCE))


def record_of(run, shift_s=0.0, factor=1.0, error_s=0.0, seed=1):
    """Onsets as this run has them, on a clock that is late by -shift_s and runs by a factor."""
    noise_s = error_s * np.random.default_rng(seed).standard_normal(len(PLACES_M))
    return {"x_m": PLACES_M, "onset_s": factor * onsets_at(run, PLACES_M) - shift_s + noise_s}


# Onsets


def test_onsets_of_the_run_itself(run):
    found = slipfront.compare_onsets(run, record_of(run, shift_s=7e-6))
    assert float(found.shift_s) == pytest.approx(7e-6, abs=1e-12)
    assert float(found.misfit_of_all) < 1e-12 and int(found.n) == len(PLACES_M) and found.notes == []
    assert float(found.time_ratio) == pytest.approx(1, abs=1e-6)
    slower = slipfront.compare_onsets(run, record_of(run, factor=0.8))
    assert float(slower.time_ratio) == pytest.approx(1.25)
    assert float(slower.misfit_of_all) == pytest.approx(
        0.2 * np.std(onsets_at(run, PLACES_M), ddof=1), rel=1e-9
    )


def test_onsets_are_those_of_the_first_front_that_passes(run):
    fronts = run.fronts
    at = np.unique(fronts.x_m.values)[20]
    first = fronts.onset_s.values[np.isclose(fronts.x_m.values, at)].min()
    assert onsets_at(run, np.array([at, -1.0]))[0] == pytest.approx(first, abs=1e-15)
    assert np.isnan(onsets_at(run, np.array([at, -1.0]))[1])


def test_errors_of_onsets_are_those_of_many_records(run):
    made = [slipfront.compare_onsets(run, record_of(run, error_s=1e-6, seed=k)) for k in range(300)]
    values = {name: np.array([float(found[name]) for found in made])
              for name in ("misfit_of_all", "shift_s", "time_ratio")}  # fmt: skip
    assert np.sqrt(np.mean(values["misfit_of_all"] ** 2)) == pytest.approx(1e-6, rel=0.05)
    # How residuals of neighbours are alike, 12 places tell roughly.
    for name, of in values.items():
        told = np.median([float(found[f"{name}_error"]) for found in made])
        assert 0.85 * of.std() < told < 1.4 * of.std()
    smooth = [record_of(run) for _ in range(200)]
    for k, record in enumerate(smooth):
        phase, wave = 2 * np.pi * np.random.default_rng(k).random(), np.linspace(0, 4, len(PLACES_M))
        record["onset_s"] = record["onset_s"] + 1e-6 * np.sin(wave + phase)
    shifts = [slipfront.compare_onsets(run, record) for record in smooth]
    spread = np.std([float(found.shift_s) for found in shifts])
    assert np.median([float(found.shift_s_error) for found in shifts]) > 0.4 * spread
    weighted = slipfront.compare_onsets(run, record_of(run, error_s=1e-6) | {"error_s": np.full(12, 1e-6)})
    assert float(weighted.misfit_of_all) == pytest.approx(float(made[1].misfit_of_all))
    assert float(weighted.reduced_chi2) == pytest.approx(float(weighted.misfit_of_all) ** 2 / 1e-12)


def test_an_onset_weighs_by_its_error(run):
    record = record_of(run) | {"error_s": np.full(12, 1e-7)}
    record["onset_s"][3] += 1e-3
    record["error_s"][3] = 1.0
    assert float(slipfront.compare_onsets(run, record).misfit_of_all) < 1e-8


def test_places_that_only_one_has(run):
    record = record_of(run)
    record["x_m"] = np.array([-0.01, *record["x_m"][1:]])
    record["onset_s"][-1] = np.nan
    found = slipfront.compare_onsets(run, record)
    assert int(found.n) == 10 and np.isnan(found.run_s[0])
    assert found.notes == [
        "no front of the run passes 1 place of the record, x = -0.01 m",
        "fronts of the run pass, and slip is not recorded at, 1 place of the record, x = 0.145 m",
    ]
    none = slipfront.compare_onsets(run, {"x_m": [-2.0, -1.0], "onset_s": [0.0, 1.0]})
    assert int(none.n) == 0 and np.isnan(none.misfit_of_all)


# Traces


def test_a_run_beside_its_own_probes(run):
    found = slipfront.compare_traces(slipfront.gauges_of(run), run)
    assert float(found.shift_s) == 0 and found.notes == []
    assert np.all(found.misfit == 0) and np.all(found.own_misfit == 0)
    assert float(found.misfit_of_all) == 0


def test_the_shift_of_clocks_is_found(run):
    shifted = [g.prepared(shift_s=-7.3e-6, window_s=(20e-6, 110e-6)) for g in slipfront.gauges_of(run)]
    found = slipfront.compare_traces(shifted, run)
    # Rows of probes lie at steps, so that both are linear between other times.
    assert float(found.shift_s) == pytest.approx(7.3e-6, abs=1e-9)
    assert float(found.misfit.max()) < 1e-2
    filtered = [g.prepared(low_pass_Hz=200e3) for g in shifted]
    assert float(slipfront.compare_traces(filtered, run).misfit.max()) < 2e-2
    late = dataclasses.replace(shifted[0], time_s=shifted[0].time_s + 5e-6)
    found = slipfront.compare_traces([late, *shifted[1:]], run)
    assert list(found.own_shift_s) == pytest.approx([2.3e-6, 7.3e-6, 7.3e-6, 7.3e-6], abs=1e-9)


def test_the_error_of_a_misfit_is_that_of_many_records(run):
    (gauge, *_) = slipfront.gauges_of(run)
    noise = 0.5 * gauge.values["xy"].std()
    made = []
    for seed in range(150):
        rng = np.random.default_rng(seed)
        noisy = {"xy": gauge.values["xy"] + noise * rng.standard_normal(len(gauge.time_s))}
        made.append(slipfront.compare_traces([dataclasses.replace(gauge, values=noisy)], run, within_s=0))
    values = np.array([float(found.misfit_of_all) for found in made])
    assert values.mean() == pytest.approx(0.5 / np.sqrt(1.25), rel=0.03)
    # That of the record's own power, in the denominator, counts as well; it is as large, and against it.
    told = np.mean([float(found.misfit_of_all_error) for found in made])
    assert 0.5 * values.std() < told < 2 * values.std()


def test_arms_at_places_of_their_own_see_the_run_there(run):
    there, beside = (next(g for g in slipfront.gauges_of(run) if g.name == n) for n in ("SG2", "beside"))
    shear = {"45": there.values, "-45": beside.values}
    values = {
        arm: 0.5 * (of["xx"] + of["yy"]) + (1 if arm == "45" else -1) * of["xy"] for arm, of in shear.items()
    }
    places = {"45": (there.x_m, there.y_m), "-45": (beside.x_m, beside.y_m)}
    gauge = slipfront.Gauge("rosette", there.x_m, there.y_m, there.time_s, values, places_m=places)
    found = slipfront.compare_traces([gauge], run)
    assert list(found.component.values) == ["45", "-45"] and float(found.misfit.max()) < 1e-9
    together = dataclasses.replace(gauge, places_m={})
    assert float(slipfront.compare_traces([together], run).misfit.max()) > 0.05


def test_the_run_passes_the_amplifier_of_the_record(run):
    gauge = slipfront.gauges_of(run)[0]
    lag_s, step_s = 4e-6, float(np.diff(gauge.time_s).mean())
    kept = np.exp(-step_s / lag_s)
    slow = {}
    for part, values in gauge.values.items():
        passed = [values[0]]
        for value in values[1:]:
            passed.append(kept * passed[-1] + (1 - kept) * value)
        slow[part] = np.array(passed)
    recorded = dataclasses.replace(gauge, values=slow, bandwidth_Hz=1 / (2 * np.pi * lag_s))
    assert float(slipfront.compare_traces([recorded], run, within_s=0).misfit.max()) < 1e-2
    without = dataclasses.replace(recorded, bandwidth_Hz=np.inf)
    assert float(slipfront.compare_traces([without], run, within_s=0).misfit.max()) > 0.1


def test_slip_sensors(run):
    nodes = run.x_m[[40, 41]]
    slip = run.history.slip_m.isel(x_m=[40, 41]).mean("x_m").to_numpy()
    channel = slipfront.Channel(
        "eddy", "slip", "eddy", run.history.time_s.to_numpy() - 3e-6, slip + 1e-6, x_m=float(nodes.mean())
    )
    found = slipfront.compare_traces([channel], run)
    assert float(found.shift_s) == pytest.approx(3e-6, abs=1e-9) and float(found.misfit_of_all) < 1e-6
    with pytest.raises(slipfront.CaseError, match="eddy records slip at x = 1 m; the interface goes from 0"):
        slipfront.compare_traces([dataclasses.replace(channel, x_m=1.0)], run)


def test_places_between_probes(run):
    computed = slipfront.gauges_of(run)
    with pytest.raises(slipfront.CaseError, match="no probe at gauge A"):
        slipfront.compare_traces([dataclasses.replace(computed[0], name="A", x_m=0.0975)], run)
    far = computed[0].prepared(shift_s=1.0)
    with pytest.raises(
        slipfront.CaseError, match="SG1: .* half of their times at each shift .* 5e-05 s; widen"
    ):
        slipfront.compare_traces([far], run, within_s=5e-5)
    # A shift of any size is found; of several records it must be one.
    assert float(slipfront.compare_traces([far], run).shift_s) == pytest.approx(-1.0, abs=1e-9)
    with pytest.raises(slipfront.CaseError, match="SG1, SG2: .* any one shift of their clocks; move clocks"):
        slipfront.compare_traces([far, computed[1]], run)
    late = computed[0].prepared(shift_s=-4e-6)
    (note,) = slipfront.compare_traces([late], run, within_s=2e-6).notes
    assert note.startswith("shift at the end of its range, within_s = 2e-06 s: ") and "widen it" in note


# Speeds


def test_speeds_of_the_run_itself(sequence):
    event = max(sequence.runs, key=lambda of: of.fronts.sizes.get("point", 0))
    ratio, speed = points_of(event, "static_ratio", "v_m_per_s")
    at = np.array([np.median(ratio), ratio.max() + 0.5])
    median = np.median(speed[np.abs(ratio - at[0]) <= 0.02])
    found = slipfront.compare_speeds([event], {"static_ratio": at, "v_m_per_s": [1.25 * median, 1.0]})
    assert found.v_runs.values == pytest.approx([median, np.nan], nan_ok=True)
    assert float(found.misfit_of_all) == pytest.approx(0.2) and int(found.n) == 1
    assert float(found.deviation_of_all) == pytest.approx(-0.2)
    over_c_L = {"static_ratio": at[:1], "v_over_c_L": [median / event.c_L_m_per_s]}
    assert float(slipfront.compare_speeds([event], over_c_L).misfit_of_all) == pytest.approx(0, abs=1e-12)


def test_speeds_over_the_ratio_of_the_forces(sequence):
    found = slipfront.compare_speeds(
        [sequence], {"friction_before": sequence.events.friction_before.values, "v_m_per_s": np.ones(6)},
        ratio_within=5e-3,
    )  # fmt: skip
    runs = [points_of(run, "friction_before", "v_m_per_s") for run in sequence.runs]
    known = [of for of in runs if of.size]
    assert known and all(np.abs(of[0] - sequence.events.friction_before.values).min() < 5e-3 for of in known)
    assert int(found.n) >= len(known)


@pytest.mark.parametrize(
    "record, why",
    [
        ({"static_ratio": [1.0]}, "the record has none of v_m_per_s, v_over_c_L; give one of them"),
        ({"static_ratio": [1.0], "friction_before": [1.0], "v_m_per_s": [1.0]}, "has static_ratio and fric"),
        ({"static_ratio": [1.0], "v_m_per_s": [0.0]}, "v_m_per_s of the record must be above 0 and finite"),
        ({"static_ratio": [1.0, 2.0], "v_m_per_s": [1.0]}, "must be of one length"),
    ],
)
def test_points_that_are_refused(run, record, why):
    with pytest.raises(slipfront.CaseError, match=why):
        slipfront.compare_speeds([run], record)


# Cycles of stick-slip


def cycles_as_recorded(sequence):
    events = sequence.events
    return {
        "begin_s": events.begin_s.values, "friction_before": events.friction_before.values,
        "friction_after": events.friction_after.values, "slip_m": events.mean_slip_m.values,
        "duration_s": events.slip_s.values,
    }  # fmt: skip


def test_cycles_of_the_sequence_itself(sequence):
    record = cycles_as_recorded(sequence)
    found = slipfront.compare_cycles(sequence, record, skip_events=0)
    assert found.ratio.values == pytest.approx(np.ones(5)) and float(found.misfit_of_all) == 0
    drop = record["friction_before"] - record["friction_after"]
    counts = drop >= 0.1 * drop.max()
    assert found.n_record.sel(quantity="drop") == counts.sum()
    assert float(found.mean_record.sel(quantity="drop")) == pytest.approx(drop[counts].mean())
    at = found.sel(quantity="slip_m")
    slips = record["slip_m"][counts]
    assert float(at.deviation_record) == pytest.approx(slips.std(ddof=1))
    assert float(at.mean_error_record) == pytest.approx(slips.std(ddof=1) / np.sqrt(len(slips)))
    twice = slipfront.compare_cycles(sequence, record | {"slip_m": 2 * record["slip_m"]}, skip_events=0)
    assert float(twice.ratio.sel(quantity="slip_m")) == pytest.approx(0.5)
    assert float(twice.misfit_of_all) == pytest.approx(0.5 / np.sqrt(5))


def test_forces_and_stresses_are_those_of_the_sequence(sequence):
    events, loading = sequence.events, sequence.loading
    after = loading.shear_force_N_per_m.values[loading.phase.values == "at_rest"]
    begin_s = {"begin_s": events.begin_s.values}
    forces = {"force_before_N": 0.01 * events.shear_force_N_per_m.values, "force_after_N": 0.01 * after}
    found = slipfront.compare_cycles(sequence, begin_s | forces, thickness_m=0.01, skip_events=0)
    assert found.ratio.values == pytest.approx(np.ones(3)) and list(found.unit.values) == ["s", "N", "N"]
    width_m = sequence.entry("plate", "width_m")
    stress = {f"stress_{name}_Pa": 100 * forces[f"force_{name}_N"] / width_m for name in ("before", "after")}
    found = slipfront.compare_cycles(sequence, begin_s | stress, skip_events=0)
    assert found.ratio.values == pytest.approx(np.ones(3)) and list(found.unit.values) == ["s", "Pa", "Pa"]
    with pytest.raises(slipfront.CaseError, match="the record is of a force in N: give thickness_m"):
        slipfront.compare_cycles(sequence, begin_s | forces, skip_events=0)
    with pytest.raises(slipfront.CaseError, match="thickness_m is of forces in N; the record has the shear"):
        slipfront.compare_cycles(sequence, begin_s | stress, thickness_m=0.01)
    with pytest.raises(slipfront.CaseError, match="has the shear as force and as stress; give one"):
        slipfront.compare_cycles(sequence, begin_s | forces | stress)
    with pytest.raises(
        slipfront.CaseError, match="two behind the first 9 are needed: give a lower skip_events"
    ):
        slipfront.compare_cycles(sequence, begin_s | stress, skip_events=9)


def test_events_of_a_force():
    time_s = np.arange(0, 100, 0.02)
    force_N = 1000 + 100 * np.mod(time_s, 10) + np.random.default_rng(1).normal(0, 2, len(time_s))
    found = slipfront.events_of_force(time_s, force_N, drop_within_s=0.4)
    assert found["begin_s"] == pytest.approx(np.arange(10, 100, 10), abs=0.03)
    assert found["force_before_N"] == pytest.approx(np.full(9, 2000), abs=15)
    assert found["force_after_N"] == pytest.approx(np.full(9, 1000), abs=15)
    with pytest.raises(slipfront.Error, match="never drops by 0.1 of its range within drop_within_s = 0.4 s"):
        slipfront.events_of_force(time_s, 1000 + time_s, drop_within_s=0.4)


# The command


def called(capsys, *arguments):
    assert command.main([str(a) for a in arguments]) == 0
    return capsys.readouterr().out.splitlines()


def refused(capsys, *arguments):
    assert command.main([str(a) for a in arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


@pytest.fixture
def files(run, tmp_path):
    """A record of each kind."""
    made = {name: tmp_path / f"{name}.csv" for name in ("onsets", "gauges", "speeds")}
    pd.DataFrame(record_of(run, error_s=1e-6) | {"error_s": 1e-6}).rename(
        columns={"onset_s": "time_s"}
    ).to_csv(made["onsets"], index=False)
    gauge = slipfront.gauges_of(run)[0]
    of = {"x_m": gauge.x_m, "y_m": gauge.y_m, "time_s": gauge.time_s}
    pd.DataFrame(of | {f"strain_{part}": v for part, v in gauge.values.items()}).to_csv(
        made["gauges"], index=False
    )
    pd.DataFrame({"static_ratio": [0.36, 0.9], "v_m_per_s": [900.0, 900.0]}).to_csv(
        made["speeds"], index=False
    )
    return made


def test_a_run_beside_records_of_every_kind(run, files, tmp_path, capsys):
    page, table = tmp_path / "page.html", tmp_path / "misfits.csv"
    lines = called(capsys, run.folder, *files.values(), "-o", page, "--table", table)
    assert lines[0].startswith("onsets.csv: standard deviation of the onsets ")
    assert " over 12 of 12 places, their variance " in lines[0] and " times as long" in lines[0]
    assert lines[1] == "gauges.csv: misfit 0 %, the run's clock less the record's 0.00 us"
    assert lines[2].startswith("gauges.csv: gauge: misfit xx 0 %, yy 0 %, xy 0 %; by its own clock, 0.00 us")
    assert " over the 1 of 2 points within the range of static_ratio of the run's fronts" in lines[3]
    rows = rows_of(table)
    assert [row["record"] for row in rows] == ["onsets.csv", "gauges.csv", "speeds.csv"]
    assert [row["unit"] for row in rows] == ["s", "1", "1"]
    text = page.read_text()
    assert text.count('<img src="data:image/svg+xml;base64,') == 3 and "out beside records" in text
    assert text.startswith("<!DOCTYPE html>") and "http" not in text.split("<body>")[1].split("<img")[0]
    called(capsys, run.folder, files["onsets"], "-o", page)  # an earlier page of ours is replaced
    page.write_text("mine")
    assert "not replaced" in refused(capsys, run.folder, files["onsets"], "-o", page)
    assert "not replaced" in refused(capsys, run.folder, files["onsets"], "--table", page)
    picture = tmp_path / "page.png"
    called(capsys, run.folder, files["onsets"], "-o", picture)
    assert picture.read_bytes().startswith(b"\x89PNG")
    several = refused(capsys, run.folder, *files.values(), "-o", picture, "--table", tmp_path / "two.csv")
    assert "a picture is of one record, not of 3" in several and not (tmp_path / "two.csv").exists()
    late = ("--shift-s=-4e-6", "--within-s", "2e-6")
    assert any("end of its range, --within-s = 2e-06 s: " in line
               for line in called(capsys, run.folder, files["gauges"], *late))  # fmt: skip


def test_an_event_of_a_recorder(run, tmp_path, capsys):
    file, gauge = tmp_path / "records.nc", slipfront.gauges_of(run)[0]
    with h5py.File(file, "w") as hdf5:
        writer = Writer(hdf5, {})
        for number in (1, 2):
            channels = {
                f"strain_{p}": slipfront.Channel(
                    f"SG_{p}",
                    f"strain_{p}",
                    "SG",
                    gauge.time_s,
                    number * gauge.values[p],
                    gauge.x_m,
                    gauge.y_m,
                )
                for p in gauge.values
            }
            slip = run.history.slip_m.isel(x_m=40).to_numpy()
            channels["slip"] = slipfront.Channel(
                "slip", "slip", "slip", run.history.time_s.to_numpy(), number * slip, x_m=float(run.x_m[40])
            )
            channels["load"] = slipfront.Channel("load", "force_shear", "load", gauge.time_s, gauge.time_s)
            for channel in channels.values():
                writer.put(number, 0.0, channel)
            writer.end(slipfront.Event(number, 0.0, channels))
    lines = called(capsys, run.folder, file)
    assert lines[0].startswith("records.nc, event 1: misfit 0 %")
    assert "records.nc, event 1: channels of force_shear are not compared" in lines
    (second,) = (line for line in called(capsys, run.folder, file, "--event", 2) if ": slip: " in line)
    assert second.startswith("records.nc, event 2: slip: misfit slip 50 %")
    assert "has no event 3" in refused(capsys, run.folder, file, "--event", 3)


def test_the_best_point_of_a_sweep(run, files, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("SLIPFRONT_PROGRAM", str(built()))
    case = write_case(tmp_path, BLOCKS)
    folder, page, table = tmp_path / "sweep", tmp_path / "page.html", tmp_path / "misfits.csv"
    run_sweep(case, {"friction.d_c_m": [3e-6, 4e-6, 5e-6]}, folder, quiet=True)
    lines = called(capsys, folder, files["onsets"], files["speeds"], "-o", page, "--table", table)
    assert "onsets.csv: nearest: friction.d_c_m = 4e-06" in lines
    assert any(line.startswith("speeds.csv: all points: median deviation") for line in lines)
    rows = rows_of(table)
    assert [row["friction.d_c_m"] for row in rows[:3]] == ["3e-06", "4e-06", "5e-06"]
    misfits = [float(row["misfit"]) for row in rows[:3]]
    assert misfits[1] == min(misfits) and rows[6]["run"] == "all points"
    assert "Shown: d_c_m=4e-06, the least misfit." in page.read_text()
    gauges = refused(capsys, folder, files["gauges"])
    assert "the run has no probes; give its case a table [probes]" in gauges


def test_a_sequence_beside_its_force(sequence, files, tmp_path, capsys):
    record = cycles_as_recorded(sequence)
    events = tmp_path / "events.csv"
    pd.DataFrame(record).to_csv(events, index=False)
    page = tmp_path / "page.html"
    lines = called(capsys, sequence.folder, events, "--skip-events", 0, "-o", page)
    assert lines[0] == "events.csv: misfit 0 %"
    assert lines[1].startswith("events.csv: interval ") and " recorded, 1 +- " in lines[1]
    assert "<img" in page.read_text()
    time_s = np.linspace(0, 60, 6001)
    force = tmp_path / "force.csv"
    pd.DataFrame({"time_s": time_s, "force_kN": 5 + np.mod(time_s, 10)}).to_csv(force, index=False)
    given = (sequence.folder, force, "--skip-events", 0)
    assert "a record of the force: give --drop-within-s" in refused(capsys, *given)
    assert "give --thickness-m" in refused(capsys, *given, "--drop-within-s", 0.5)
    lines = called(capsys, *given, "--drop-within-s", 0.5, "--thickness-m", 0.01)
    assert any(" s beside 10 " in line for line in lines if ": interval " in line)
    told = refused(capsys, sequence.folder, files["onsets"])
    assert "is a sequence; name one of its events, such as " in told and "events/0001" in told
    assert "is a run; cycles are compared with a sequence" in refused(
        capsys, sequence.folder / "events/0001", events
    )


@pytest.mark.parametrize(
    "name, option, why",
    [
        ("onsets", "--thickness-m=1", "--thickness-m counts with stick-slip alone, and no record is such"),
        ("speeds", "--low-pass-hz=1e5", "--low-pass-hz counts with traces alone"),
        ("speeds", "--event=1", "--event counts with traces, onsets alone"),
        ("gauges", "--event=1", "has no events: leave out --event"),
        ("onsets", "--event=1", "has no column 'event'"),
    ],
)
def test_options_that_count_with_no_record(run, files, capsys, name, option, why):
    assert why in refused(capsys, run.folder, files[name], option)


@pytest.mark.parametrize(
    "text, why",
    [
        ("a,b\n1,2\n", "has the columns 'a', 'b'; wanted are x_m and time_s of onsets"),
        ("x_m,time_s\n1,\n2,\n", "no row has a time"),
        ("static_ratio,v_over_c_L\n1,0\n", "v_over_c_L of the record must be above 0"),
        ("time_s,force_N\n0,1\n", "give --drop-within-s"),
        ("gauge,x_m,y_m,time_s,strain_xx\nA,1,1,0,\n", "no gauge has values"),
        ("", "empty"),
    ],
)
def test_records_that_are_refused(run, tmp_path, capsys, text, why):
    file = tmp_path / "record.csv"
    file.write_text(text)
    told = refused(capsys, run.folder, file)
    assert why in told and "record.csv" in told
    assert "no such folder" in refused(capsys, tmp_path / "none", file)


def test_outputs_replace_nothing_but_their_own(run, files, tmp_path, capsys):
    record = tmp_path / "record.svg"
    record.write_text(files["onsets"].read_text())
    given = (run.folder, record)
    assert "is there and no picture: not replaced" in refused(capsys, *given, "-o", record)
    assert record.read_text() == files["onsets"].read_text()
    both = tmp_path / "x.html"
    assert "is named for the page and the table" in refused(capsys, *given, "-o", both, "--table", both)
    report = tmp_path / "report.html"
    report.write_text("<!DOCTYPE html><!-- slipfront report -->")
    assert "not replaced" in refused(capsys, *given, "-o", report)
    assert "ends with none of .html" in refused(capsys, *given, "-o", tmp_path / "page.jpg")
    assert "is given twice" in refused(capsys, *given, record)
    (tmp_path / "b").mkdir()
    (tmp_path / "b/record.svg").write_text(record.read_text())
    lines = called(capsys, *given, tmp_path / "b/record.svg")
    assert [line.split(":")[0] for line in lines] == [str(record), str(tmp_path / "b/record.svg")]
    assert "holds no results of a run, a sequence or a sweep" in refused(capsys, tmp_path, record)


def test_constant_and_double_traces(run):
    """One that does not change says nothing, and takes nothing from the others."""
    gauges = slipfront.gauges_of(run)
    late = [g.prepared(shift_s=-7e-6) for g in gauges]
    dead = dataclasses.replace(late[0], values=late[0].values | {"xx": np.zeros(len(late[0].time_s))})
    found = slipfront.compare_traces([dead, *late[1:]], run)
    assert float(found.shift_s) == pytest.approx(7e-6, abs=1e-9) and float(found.misfit_of_all) < 1e-2
    assert "SG1: xx does not change: left out" in found.notes
    with pytest.raises(slipfront.CaseError, match="several traces are called SG1"):
        slipfront.compare_traces([gauges[0], gauges[0]], run)
    slip = run.history.slip_m.isel(x_m=40).to_numpy()
    channel = slipfront.Channel("SG1", "slip", "SG1", run.history.time_s.to_numpy(), slip, x_m=run.x_m[40])
    assert list(slipfront.compare_traces([gauges[0], channel], run).trace.values) == ["SG1", "SG1, slip"]


def test_what_a_run_covers_is_told(run):
    (gauge, *_) = slipfront.gauges_of(run)
    longer = np.append(gauge.time_s, gauge.time_s[-1] + np.diff(gauge.time_s).mean() * np.arange(1, 400))
    values = {part: np.pad(v, (0, 399), "edge") for part, v in gauge.values.items()}
    found = slipfront.compare_traces([dataclasses.replace(gauge, time_s=longer, values=values)], run)
    assert float(found.covered[0]) == pytest.approx(len(gauge.time_s) / len(longer), abs=0.01)
    assert f"the run covers {100 * float(found.covered[0]):.0f} % of a record: SG1" in found.notes


def test_slip_is_prepared_as_gauges_are(run, tmp_path, capsys):
    file, gauge = tmp_path / "records.nc", slipfront.gauges_of(run)[0]
    time_s, slip = run.history.time_s.to_numpy(), run.history.slip_m.isel(x_m=40).to_numpy()
    channels = {
        "SG1": slipfront.Channel(
            "SG1", "strain_xy", "SG1", gauge.time_s, gauge.values["xy"], gauge.x_m, gauge.y_m
        ),
        "eddy": slipfront.Channel("eddy", "slip", "eddy", time_s, slip, x_m=float(run.x_m[40])),
    }
    with h5py.File(file, "w") as hdf5:
        writer = Writer(hdf5, {})
        for channel in channels.values():
            writer.put(1, 0.0, channel)
        writer.end(slipfront.Event(1, 0.0, channels))
    line = called(capsys, run.folder, file, "--shift-s=5e-6")[0]
    assert line.endswith(" %, the run's clock less the record's -5.00 us")
    assert float(line.partition("misfit ")[2].split()[0]) < 1e-3
    assert "slip 0 %" not in called(capsys, run.folder, file, "--shift-s=eddy=5e-6", "--within-s", "0")[-1]
    assert "--low-pass-hz is -3.0; it must be above 0" in refused(
        capsys, run.folder, file, "--low-pass-hz=-3"
    )


def test_a_run_that_did_not_come_to_its_end_is_told(files, tmp_path, capsys):
    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        slipfront.run(BLOCKS, output=tmp_path / "cut", progress=stop)
    lines = called(capsys, tmp_path / "cut", files["onsets"])
    assert "cut: interrupted: compared as far as it goes" in lines[-1]


def test_speeds_are_over_the_wave_speed_of_each_run(run, tmp_path):
    stiff = {name: dict(of) for name, of in BLOCKS.items()}
    for body in ("material", "base"):
        stiff[body] |= {"youngs_modulus_Pa": 4 * stiff[body]["youngs_modulus_Pa"]}
    other = slipfront.run(stiff, output=tmp_path / "stiff")
    record = {"static_ratio": [0.36], "v_over_c_L": [0.4]}
    one, two = (slipfront.compare_speeds(runs, record) for runs in ([run, other], [other, run]))
    assert float(one.v_runs[0]) == pytest.approx(float(two.v_runs[0]))


@pytest.mark.parametrize(
    "change, why",
    [
        ({"slip_m": [0.0] * 6}, "slip of the record is not above 0 in the mean"),
        ({"slip_m": [np.nan] * 6}, "slip_m of the record holds no number"),
        ({"slip_m": [np.inf] * 6}, "slip_m of the record holds inf"),
        ({"begin_s": [1, 2, 2, 3, 4, 5]}, "begin_s of the record must ascend"),
    ],
)
def test_events_that_are_refused(sequence, change, why):
    with pytest.raises(slipfront.CaseError, match=why):
        slipfront.compare_cycles(sequence, cycles_as_recorded(sequence) | change, skip_events=0)


def test_events_in_another_unit_are_doubted(sequence):
    record = cycles_as_recorded(sequence)
    (note,) = slipfront.compare_cycles(
        sequence, record | {"slip_m": 1e3 * record["slip_m"]}, skip_events=0
    ).notes
    assert note.startswith("slip: beyond 10 times each other; check units")
    (note,) = slipfront.compare_cycles(sequence, {"begin_s": record["begin_s"]}, skip_events=0).notes
    assert note.endswith("intervals alone")


@pytest.mark.parametrize(
    "work, why",
    [
        (lambda run: slipfront.compare_onsets(run, None), "record has no 'x_m'"),
        (
            lambda run: slipfront.compare_onsets(run, {"x_m": [0.0], "onset_s": [0.0], "error_s": [np.inf]}),
            "error_s",
        ),
        (
            lambda run: slipfront.compare_onsets(run, {"x_m": [0.0], "onset_s": [0.0], "error_s": [0.0]}),
            "above 0",
        ),
        (
            lambda run: slipfront.compare_onsets(run, {"x_m": [0, 1], "onset_s": [0, 1], "event": [1, 2]}),
            "several",
        ),
        (lambda run: slipfront.compare_speeds([run], None), "it must be a dictionary or data set of arrays"),
        (lambda run: slipfront.compare_speeds([None], {}), r"runs\[0\] is None"),
        (lambda run: slipfront.compare_cycles(run, {}), "sequence is "),
    ],
)
def test_arguments_that_are_refused(run, work, why):
    with pytest.raises(slipfront.CaseError, match=why):
        work(run)


def test_a_constant_clock_has_no_ratio(run):
    found = slipfront.compare_onsets(run, {"x_m": PLACES_M, "onset_s": np.full(len(PLACES_M), 12.3)})
    assert np.isnan(found.time_ratio)


def test_a_sweep_over_a_key_that_is_also_a_result(files, tmp_path, capsys, monkeypatch):
    """end_s is a key of the case and a column of the table."""
    monkeypatch.setenv("SLIPFRONT_PROGRAM", str(built()))
    case = write_case(tmp_path, BLOCKS)
    found = run_sweep(case, {"time.end_s": [20e-6, 180e-6]}, tmp_path / "ends", quiet=True)
    assert found.sizes["time.end_s"] == 2 and float(found.end_s[1]) == pytest.approx(180e-6, rel=0.01)
    lines = called(capsys, tmp_path / "ends", files["onsets"])
    assert (
        lines[-1]
        == "onsets.csv: nearest: time.end_s = 0.00018, of the 1 points that share most with the record"
    )
