# SPDX-License-Identifier: BSD-3-Clause
"""Sequences of slip events from Python: run, gone on with, opened; what is damaged is refused; their page."""

from __future__ import annotations

import base64
import json
import re
import shutil

import numpy as np
import pytest
import slipfront
import xarray as xr
from common import refusal, require_same_bytes, rows_of
from package_cases import PLATE, TILT, program, refused, results_of, write_case
from refusals import flip, replace
from report_pages import data_of, page_of
from slipfront.figures.sequence import main
from slipfront.figures.sequence import sequence as draw
from slipfront.opened import open_run
from slipfront.read import ENERGY_TERMS
from slipfront.report import setup

N_EVENTS = 4
# A fraction of a second.
SEQUENCE = f"""\
title = "coarse sequence"
{PLATE}{TILT}plate.element_size_m = 4e-3
event.kind = "spontaneous"
sequence.max_events = {N_EVENTS}
"""
# Slow slip and two events in a second.
STICK_SLIP = """\
title = "coarse stick-slip"
plate = {width_m = 0.1, height_m = 0.05, element_size_m = 2e-3}
base.kind = "rigid"
material.stiffness_damping_s = 1e-6
loading.mean_pressure_Pa = 5e6
friction = {law = "rate_and_state_aging", a = 0.010, b = 0.015, d_c_m = 0.5e-6, V_i_m_per_s = 1e-6}
event.kind = "spontaneous"
sequence.max_events = 2
"""
TABLES = ("case.resolved.toml", "events.csv", "loading.csv")
RUN_TABLES = ("interface.h5", "fronts.csv", "fracture.csv", "energy.csv", "static.csv")
STORED = ("strain", "kinetic")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return results_of(tmp_path_factory.mktemp("sequence"), SEQUENCE)


@pytest.fixture(scope="module")
def stick_slip(tmp_path_factory):
    return results_of(tmp_path_factory.mktemp("stick_slip"), STICK_SLIP)


@pytest.fixture
def copy(folder, tmp_path):
    return shutil.copytree(folder, tmp_path / "out")


@pytest.fixture
def interrupted(tmp_path):
    """Its third event is under way."""

    def stop(part, _step, _total):
        if part == "event 3":
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        slipfront.run(write_case(tmp_path, SEQUENCE), output=tmp_path / "out", progress=stop)
    return tmp_path / "out"


def require_the_programs(ours, theirs):
    require_same_bytes(ours, theirs, *TABLES)
    for k in range(1, N_EVENTS + 1):
        require_same_bytes(*(place / f"events/{k:04}" for place in (ours, theirs)), *RUN_TABLES)


# Run, gone on with


def test_a_sequence_has_the_bytes_of_the_programs(folder, tmp_path):
    sequence = slipfront.run(SEQUENCE, output=tmp_path / "ours")
    assert isinstance(sequence, slipfront.OpenSequence) and sequence.status == "complete"
    require_the_programs(tmp_path / "ours", folder)


def test_a_sequence_in_a_temporary_folder_lasts_as_long_as_its_runs():
    run = slipfront.run(SEQUENCE).runs[0]
    assert float(run.history["slip_m"][-1].max()) > 0


def test_it_goes_on_as_if_it_had_never_stopped(folder, interrupted):
    sequence = slipfront.open(interrupted)
    assert (sequence.status, sequence.folder.name) == ("interrupted", "unfinished")
    assert len(sequence.runs) == sequence.events.sizes["event"] == 2
    assert slipfront.open(sequence.folder / "events" / "0003").status == "interrupted"
    resumed = slipfront.resume(interrupted)
    assert isinstance(resumed, slipfront.OpenSequence) and resumed.info["sessions"] == 2
    require_the_programs(interrupted, folder)
    assert repr(slipfront.resume(interrupted)) == repr(resumed)


def test_an_observer_sees_each_event(tmp_path):
    begun = []

    def look(state):
        if state.step == 0:
            begun.append(float(np.abs(state.slip_m).max()))

    slipfront.run(SEQUENCE, output=tmp_path / "out", observers=[(1.0, look)])
    assert begun == [0.0] * N_EVENTS


def test_an_observer_ends_a_sequence_with_its_reason(tmp_path):
    with pytest.raises(slipfront.CaseError, match="an observer ended it at t = .* s: enough; the partial"):
        slipfront.run(SEQUENCE, output=tmp_path / "out", observers=[(0, lambda state: "enough")])


def test_a_sequence_that_is_complete_goes_on(folder, tmp_path):
    """By the package and by the command; the tables are those of one that was asked for from the start."""
    later = write_case(tmp_path, SEQUENCE.replace(f"events = {N_EVENTS}", f"events = {N_EVENTS + 1}"))
    whole = tmp_path / "whole"
    slipfront.run(later, output=whole, progress=False)
    for name in ("package", "command"):
        shutil.copytree(folder, tmp_path / name)
    run = slipfront.resume(tmp_path / "package", later, progress=False)
    assert len(run.runs) == N_EVENTS + 1
    program("run", later, "--restart", "command", "-q", cwd=tmp_path)
    for name in ("package", "command"):
        tables = ("events.csv", "loading.csv", f"events/000{N_EVENTS + 1}/fronts.csv")
        require_same_bytes(tmp_path / name, whole, *tables)
    slipfront.resume(tmp_path / "package", later, progress=False)  # is complete
    other = SEQUENCE.replace("4e-3", "5e-3")
    assert "is another case" in refused(lambda: slipfront.resume(tmp_path / "package", other, progress=False))


@pytest.mark.parametrize("study", ["convergence", "interface-step"])
def test_a_study_is_of_one_event(study, tmp_path):
    found = program("study", study, write_case(tmp_path, SEQUENCE), "-o", "out", cwd=tmp_path)
    assert "sequence.max_events is 4; a study is of one event" in refusal(found)


# Slip spreads from the pushed end past the margin, where the tilt lifts the other one.
SPREADING = """\
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 4e-3}
base.kind = "rigid"
friction = {law = "velocity_weakening", mu_s = 0.7, mu_k = 0.3}
event.kind = "spontaneous"
sequence.max_events = 6
[loading]
mean_pressure_Pa = 5e6
tilt_difference_m = -6.5e-4
pusher_from_m = 4e-3
pusher_to_m = 8e-3
edge_margin_m = 16e-3
"""


def test_events_before_one_that_is_not_found_stay(tmp_path):
    line = refusal(program("run", write_case(tmp_path, SPREADING), "-q", "-o", "out", cwd=tmp_path))
    told = r":\d+: event (\d) is not found: slip spreads .*; the partial results are in \S+/unfinished$"
    found = re.search(told, line)
    sequence = slipfront.open(tmp_path / "out")
    assert (sequence.status, len(sequence.runs)) == ("failed", int(found[1]) - 1)
    assert f"failed at event {found[1]} (" in page_of(tmp_path / "out")


# Opened


def test_tables_are_the_files(folder):
    sequence = slipfront.open(folder)
    for found, name in ((sequence.events, "events.csv"), (sequence.loading, "loading.csv")):
        rows = rows_of(folder / name)
        assert set(found.variables) == rows[0].keys()
        for column in rows[0].keys() - {"phase"}:
            expected = [float(row[column] or "nan") for row in rows]
            assert np.array_equal(found[column], expected, equal_nan=True)
            assert found[column].attrs["long_name"]
    phases = ["tilted", *["event_begins", "slip_ends", "at_rest"] * N_EVENTS]
    assert list(sequence.loading["phase"].to_numpy()) == phases
    assert sequence.events["event"].to_numpy().tolist() == [1, 2, 3, 4]
    units = {"potency_m2": "m2", "released_J_per_m": "J/m", "friction_before": "1", "begin_s": "s"}
    assert {name: sequence.events[name].attrs["units"] for name in units} == units
    assert sequence.info["events"] == N_EVENTS and sequence.case["sequence"]["max_events"] == N_EVENTS
    assert repr(sequence) == f"<slipfront sequence 'coarse sequence', 4 events, complete: {folder}>"


def test_runs_are_the_events(folder):
    sequence = slipfront.open(folder)
    assert [run.folder.name for run in sequence.runs] == ["0001", "0002", "0003", "0004"]
    assert sequence.runs[-1].folder == sequence.runs[3:][0].folder
    with pytest.raises(IndexError):
        sequence.runs[N_EVENTS]
    for k, run in enumerate(sequence.runs):
        event, slip = sequence.events.isel(event=k), sequence.slip.isel(event=k)
        assert np.array_equal(slip, run.history["slip_m"][-1])
        assert len(run.info["fronts"]) == event["n_fronts"]
        assert slip.max() == event["max_slip_m"]


@pytest.mark.parametrize("which", ["folder", "stick_slip"])
def test_the_energies_balance(which, request):
    loading = slipfront.open(request.getfixturevalue(which)).loading
    terms = {term: loading[f"{term}_J_per_m"].to_numpy() for term in ENERGY_TERMS}
    change = sum(terms[term] - terms[term][0] for term in STORED)
    works = sum(values for term, values in terms.items() if term not in STORED)
    open_J_per_m = change - works + loading["wave_loss_J_per_m"].to_numpy()
    largest = max(np.abs(values).max() for values in terms.values())
    assert np.abs(open_J_per_m).max() < 1e-11 * largest
    assert np.abs(loading["imbalance_J_per_m"] - open_J_per_m).max() < 1e-13 * largest


def test_what_an_event_releases_is_what_the_loading_loses(folder):
    sequence = slipfront.open(folder)
    loading = sequence.loading
    strain = {
        phase: loading["strain_J_per_m"][(loading["phase"] == phase).to_numpy()].to_numpy()
        for phase in ("event_begins", "at_rest")
    }
    released = sequence.events["released_J_per_m"].to_numpy()
    np.testing.assert_allclose(strain["event_begins"] - strain["at_rest"], released, rtol=1e-9)
    losses = sequence.events["wave_loss_J_per_m"].sum()
    np.testing.assert_allclose(loading["wave_loss_J_per_m"][-1], losses, rtol=1e-9)


# Slow slip


def test_slow_slip_and_events_follow_one_another(stick_slip):
    sequence = slipfront.open(stick_slip)
    assert len(sequence.slow) == len(sequence.runs) == 2
    now_s, slip_m, rate_m_per_s, psi, touch = 0.0, 0.0, 0.0, sequence.slow[0]["psi"][0], slice(None)
    for slow, run, begin_s in zip(sequence.slow, sequence.runs, sequence.events["begin_s"], strict=True):
        event = run.history.load()
        since_row_s = float(slow["time_s"][0] - now_s)
        assert 0 <= since_row_s <= 1.001 * event["time_s"][1]
        np.testing.assert_allclose(slow["time_s"][-1], begin_s, rtol=1e-12)
        # The event's last row lies up to an interval before its end, in which slip slows down. Where
        # contact is open nothing holds the slip.
        expected_m = slip_m + since_row_s * rate_m_per_s
        off_m = np.abs(slow["slip_m"][0] - expected_m)[touch]
        assert off_m.max() <= 0.1 * since_row_s * np.abs(rate_m_per_s).max() + 1e-15
        np.testing.assert_allclose(slow["psi"][0], psi, rtol=1e-3)
        np.testing.assert_array_equal(slow["psi"][-1], event["psi"][0])
        # Velocities of an event are half a sub-step apart from its displacements.
        rate = event["slip_rate_m_per_s"][0].to_numpy()
        touch = (event["p_Pa"][0] > 0).to_numpy()
        off = np.abs(slow["slip_rate_m_per_s"][-1] - rate)[touch]
        assert off.max() < 0.05 * rate[touch].max()
        now_s = float(begin_s + event["time_s"][-1])
        slip_m, psi = slow["slip_m"][-1] + event["slip_m"][-1], event["psi"][-1]
        rate_m_per_s = event["slip_rate_m_per_s"][-1]
        touch = (event["p_Pa"][-1] > 0).to_numpy()


def test_the_loading_has_slow_slip(stick_slip):
    sequence = slipfront.open(stick_slip)
    loading = sequence.loading
    creeps = loading.isel(row=(loading["phase"] == "creeps").to_numpy())
    assert (np.diff(loading["time_s"]) >= 0).all()
    for k, slow in enumerate(sequence.slow):
        rows = creeps.isel(row=(creeps["event"] == k).to_numpy())
        assert rows.sizes["row"] > 10
        assert slow["time_s"][0] <= rows["time_s"].min() and rows["time_s"].max() <= slow["time_s"][-1]
        rates = rows["fastest_slip_rate_m_per_s"].to_numpy()
        nodes = xr.DataArray(np.full(slow.sizes["x_m"], 2e-3), dims="x_m")
        nodes[[0, -1]] /= 2
        # Where the fastest rate has doubled or halved, or the force has turned by a hundredth of a.
        factors, friction = rates[1:] / rates[:-1], rows["shear_over_normal"].to_numpy()
        of_slow = (slow["t_Pa"] @ nodes / (slow["p_Pa"] @ nodes)).to_numpy()
        turns, since_s = np.flatnonzero((factors < 2) & (factors > 0.5)) + 1, 0.0
        for row in turns:
            until_s = float(rows["time_s"][row])
            passed = of_slow[((slow["time_s"] >= since_s) & (slow["time_s"] <= until_s)).to_numpy()]
            assert max(passed.max() - friction[row], friction[row] - passed.min()) > 0.5e-4
            since_s = until_s
        assert len(turns) < len(factors) / 4
        # Force and fastest rate of the history at the times of both.
        times = (np.round(of["time_s"], 9) for of in (rows, slow))
        _, i, j = np.intersect1d(*times, return_indices=True)
        assert len(i) > 3
        np.testing.assert_allclose((slow["t_Pa"] @ nodes)[j], rows["shear_force_N_per_m"][i], rtol=1e-6)
        np.testing.assert_allclose(np.abs(slow["slip_rate_m_per_s"][j]).max("x_m"), rates[i], rtol=1e-6)


def test_only_a_law_with_a_state_has_slow_slip(folder):
    sequence = slipfront.open(folder)
    assert len(sequence.slow) == 0 and sequence.slow[:] == []
    assert not (folder / "slow").exists()


def test_slow_slip_behind_the_last_event(tmp_path):
    found = slipfront.run(STICK_SLIP + "sequence.end_s = 120.0\n", output=tmp_path / "out")
    assert (len(found.runs), len(found.slow)) == (1, 2)
    assert float(found.slow[-1]["time_s"][-1]) == 120
    assert found.loading["phase"][-1] == "loaded"


def test_slow_slip_goes_on_as_if_it_had_never_stopped(stick_slip, tmp_path):
    def stop(part, step, _total):
        if part == "event 2" and step > 0:
            raise RuntimeError("enough")

    place = tmp_path / "out"
    with pytest.raises(RuntimeError, match="enough"):
        slipfront.run(STICK_SLIP, output=place, progress=stop)
    assert len(slipfront.open(place).slow) == 1
    slipfront.resume(place)
    require_same_bytes(place, stick_slip, *TABLES)
    for k in ("0001", "0002"):
        require_same_bytes(place / "slow" / k, stick_slip / "slow" / k, "interface.h5")


# Refused


def test_a_file_that_is_missing_or_changed_is_refused(copy):
    flip(copy / "loading.csv")
    (copy / "events.csv").unlink()
    sequence = slipfront.open(copy)
    assert "loading.csv: does not match checksums.sha256" in refused(lambda: sequence.loading)
    assert "events.csv: missing" in refused(lambda: sequence.events)
    (copy / "sequence.json").unlink()
    assert "sequence.json: missing" in refused(lambda: slipfront.open(copy))


def test_an_event_that_is_missing_or_of_another_sequence_is_refused(copy):
    shutil.rmtree(copy / "events/0003")
    shutil.rmtree(copy / "events/0004")
    shutil.copytree(copy / "events/0001", copy / "events/0004")
    flip(copy / "events/0002/interface.h5")
    runs = slipfront.open(copy).runs
    assert "0003/checksums.sha256: missing" in refused(lambda: runs[2])
    assert "0004/checksums.sha256: does not match" in refused(lambda: runs[3])
    assert "interface.h5: does not match" in refused(lambda: runs[1].history)
    assert runs[0].status == "complete"


def test_slow_slip_that_is_missing_or_was_changed_is_refused(stick_slip, tmp_path):
    copied = shutil.copytree(stick_slip, tmp_path / "out")
    shutil.rmtree(copied / "slow/0001")
    flip(copied / "slow/0002/interface.h5")
    slow = slipfront.open(copied).slow
    assert "slow/0002/interface.h5: does not match checksums.sha256" in refused(lambda: slow[1])
    assert "slow/0001/interface.h5: missing" in refused(lambda: slow[0])


@pytest.mark.parametrize(
    "old, new, told",
    [
        ("\n2,", "\n3,", "its events are not numbered from 1"),
        ("\n2,", "\n2.5,", "a value of column 'event' is no number of events"),
        ("event,", "events,", "no column 'event'"),
    ],
)
def test_a_table_without_a_list_that_makes_no_sense_is_refused(copy, old, new, told):
    (copy / "checksums.sha256").unlink()
    replace(copy / "events.csv", old, new)
    assert f"events.csv: {told}" in refused(lambda: slipfront.open(copy).events)


def test_readers_of_one_run_name_the_events(folder):
    assert "of a sequence of events; name the folder of one of them" in refused(lambda: open_run(folder))


# The page


def test_the_page_holds_each_event(folder, tmp_path):
    sequence = slipfront.open(folder)
    text = page_of(folder, tmp_path / "page.html")
    data = data_of(text)["sequence"]
    assert data["units"] == {"x": "mm", "time": "s", "slip": "µm", "force": "kN/m"}
    assert data["strength"] == sequence.case["friction"]["mu_s"]
    rests = sequence.loading.isel(row=(sequence.loading["phase"] == "at_rest").to_numpy())
    for name, of in (("force_before", sequence.events), ("force_after", rests)):
        force = 1e-3 * of["shear_force_N_per_m"]
        np.testing.assert_allclose([event[name] for event in data["events"]], force, rtol=1e-4)
    assert [event["number"] for event in data["events"]] == [1, 2, 3, 4]
    ratios = {"time": "begin_s", "before": "friction_before", "after": "friction_after"}
    places = {"from": "from_x_m", "to": "to_x_m", "begin": "begin_x_m"}
    for name, column in (ratios | places).items():
        factor = 1e3 if name in places else 1
        drawn = [event[name] for event in data["events"]]
        np.testing.assert_allclose(drawn, factor * sequence.events[column], rtol=1e-4)
    np.testing.assert_allclose(data["slip"]["after"], 1e6 * np.cumsum(sequence.slip, axis=0), rtol=1e-4)
    assert {len(values) for values in data["loading"].values()} == {1 + 2 * N_EVENTS}
    assert data["phases"] is None and 'id="phases-plot"' not in text
    rows = re.findall(r"<tr><td>(\d+)</td>", text)
    assert rows == ["1", "2", "3", "4"]
    for part in ("coarse sequence", "complete: sequence.max_events = 4 was reached", "where event 1 begins"):
        assert part in text


def test_what_the_page_leaves_out_is_told(folder, tmp_path, monkeypatch):
    for name, most in (("MOST_NODES", 20), ("MOST_CURVES", 2), ("MOST_ROWS", 3)):
        monkeypatch.setattr(f"slipfront.report.sequence.{name}", most)
    text = page_of(folder, tmp_path / "page.html")
    slip = data_of(text)["sequence"]["slip"]
    assert "2 of 4 events are drawn. 20 of 51 nodes are drawn." in text
    assert "The first 3 of 4 events." in text and len(re.findall(r"<tr><td>\d+</td>", text)) == 3
    assert len(slip["x"]) == 20 and (slip["x"][0], slip["x"][-1]) == (0, 200) and slip["events"] == [1, 4]
    last = 1e6 * slipfront.open(folder).slip.sum("event")
    np.testing.assert_allclose(slip["after"][1][::19], last[::50], rtol=1e-4)


def test_the_page_shows_slow_slip(stick_slip, tmp_path, monkeypatch):
    sequence = slipfront.open(stick_slip)
    rows_of_a_phase = 40
    monkeypatch.setattr("slipfront.report.sequence.MOST_ROWS_OF_PHASES", 4 * rows_of_a_phase)
    text = page_of(stick_slip, tmp_path / "page.html")
    assert 'id="phases-plot"' in text and '<a href="#phases">' in text
    data = data_of(text)["sequence"]
    shown = sequence.loading.isel(row=(sequence.loading["phase"] != "slip_ends").to_numpy())
    np.testing.assert_allclose(data["loading"]["ratio"], shown["shear_over_normal"], rtol=1e-4, atol=1e-9)
    # Behind the first event: what has slipped slowly before it, and in it.
    after = sequence.slow[0]["slip_m"][-1] + sequence.runs[0].history["slip_m"][-1]
    np.testing.assert_allclose(data["slip"]["after"][0], 1e6 * after, rtol=1e-4, atol=1e-6)
    phases = data["phases"]
    np.testing.assert_allclose(phases["borders"], np.linspace(0, 4, 4 * rows_of_a_phase + 1), atol=1e-4)
    codes = np.frombuffer(base64.b64decode(phases["rates"]), np.uint8).reshape(4, rows_of_a_phase, -1)
    times = np.array(phases["time"], float).reshape(4, -1)
    for k in range(2):
        begin_s = float(sequence.events["begin_s"][k])
        for history, from_s, row in (
            (sequence.slow[k], 0, 2 * k),
            (sequence.runs[k].history, begin_s, 2 * k + 1),
        ):
            ends = history.isel(time_s=[0, -1])
            np.testing.assert_allclose(times[row][[0, -1]], from_s + ends["time_s"], rtol=1e-9)
            power = np.log10(np.clip(np.abs(ends["slip_rate_m_per_s"]), 1e-12, 1)).to_numpy()
            expected = np.where(ends["p_Pa"] > 0, np.round(254 * (power + 12) / 12), 255)
            np.testing.assert_array_equal(codes[row][[0, -1]], expected)


def test_no_shear_is_critical_behind_slow_slip(stick_slip, folder):
    told = [dict(setup.rows(open_run(place / "events/0002")))["Loads"] for place in (stick_slip, folder)]
    assert ["shear force" in loads for loads in told] == [True, False]
    assert not any("of the critical" in loads for loads in told)


def test_of_slow_slip_the_page_has_few_loads(stick_slip, tmp_path, monkeypatch):
    monkeypatch.setattr("slipfront.report.sequence.MOST_CREEPS", 5)
    loading = data_of(page_of(stick_slip, tmp_path / "page.html"))["sequence"]["loading"]
    assert {len(values) for values in loading.values()} == {1 + 2 * 2 + 5}


def test_the_page_of_a_sequence_that_is_not_over(interrupted):
    text = page_of(interrupted)
    assert len(data_of(text)["sequence"]["events"]) == 2
    assert "<h1>coarse sequence: interrupted at event 3</h1>" in text
    assert "<b>interrupted in event 3 at t = " in text and "event 3 (" not in text


def test_the_page_of_a_sequence_without_an_event(interrupted):
    place = interrupted / "unfinished"
    for name in ("events.csv", "loading.csv"):
        head = (place / name).read_text().split("\n")[0]
        (place / name).write_text(head + "\n")
    info = json.loads((place / "sequence.json").read_text())
    kept = ("version", "title", "status", "reason", "sessions", "end", "wave_speeds")
    (place / "sequence.json").write_text(json.dumps({k: info[k] for k in kept} | {"status": "running"}))
    text = page_of(interrupted)
    assert "No event is complete." in text and 'class="plot"' not in text
    assert "still running or killed, results up to event 0" in text


def test_stable_sliding_is_shown_without_an_event(tmp_path):
    changes = {"friction.a": 0.02, "sequence.end_s": 40}
    slipfront.run(write_case(tmp_path, STICK_SLIP), changes, output=tmp_path / "out", progress=False)
    text = page_of(tmp_path / "out", tmp_path / "page.html")
    shown = data_of(text)["sequence"]
    assert '<p class="outcome">No event.</p>' in text and 'class="sketch"' in text
    assert all(f'<th scope="row">{name}</th>' in text for name in ("Plate", "Loads", "Friction", "Start"))
    plots = ("forces", "extents", "slips", "phases")
    assert [name for name in plots if f'id="{name}-plot"' in text] == ["forces", "phases"]
    loading = slipfront.open(tmp_path / "out").loading
    np.testing.assert_allclose(shown["loading"]["ratio"], loading["shear_over_normal"], rtol=1e-4, atol=1e-9)
    assert shown["phases"]["borders"][-1] == 1
    force, phases, _ = draw(slipfront.open(tmp_path / "out")).figure.axes
    np.testing.assert_array_equal(force.lines[0].get_ydata(), loading["shear_over_normal"])
    assert phases.get_xlim() == (0, 100)


def test_the_picture_shows_the_tables(folder, tmp_path, capsys):
    sequence = slipfront.open(folder)
    events = sequence.events
    force, extents, slip = draw(sequence).figure.axes
    np.testing.assert_array_equal(force.lines[0].get_ydata(), sequence.loading.shear_over_normal)
    for k, line in enumerate(extents.collections[0].get_segments()):
        np.testing.assert_allclose(line[:, 0], 1e3 * np.array([events.from_x_m[k], events.to_x_m[k]]))
        np.testing.assert_array_equal(line[:, 1], events.friction_before[k])
    assert len(slip.lines) == N_EVENTS
    np.testing.assert_allclose(slip.lines[-1].get_ydata(), 1e6 * sequence.slip.sum("event"))
    assert main([str(tmp_path / "a.png"), str(folder)]) == 0
    assert (tmp_path / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert main([str(tmp_path / "b.png"), str(folder / "events/0001")]) == 2
    assert "b.png" not in [file.name for file in tmp_path.iterdir()]
    capsys.readouterr()


def test_the_picture_shows_slow_slip(stick_slip):
    sequence = slipfront.open(stick_slip)
    force, phases, _, slip, bar = draw(sequence).figure.axes
    assert len(force.lines[0].get_ydata()) == sequence.loading.sizes["row"]
    after = sequence.slow[1]["slip_m"][-1] + sequence.runs[1].history["slip_m"][-1]
    np.testing.assert_allclose(slip.lines[-1].get_ydata(), 1e6 * after)
    image = phases.collections[0]
    rates = image.get_array()
    assert np.ma.max(rates) <= 1 and np.ma.min(rates) >= 1e-12
    first = np.clip(np.abs(sequence.slow[0]["slip_rate_m_per_s"][0]), 1e-12, 1)
    np.testing.assert_allclose(rates[0], first)
    edges = image.get_coordinates()
    assert (edges[0, 0, 1], edges[-1, 0, 1]) == (0, 4)
    begins = [f"{k}: {t:.6g} s" for k, t in enumerate(sequence.events["begin_s"].to_numpy(), 1)]
    assert [label.get_text() for label in phases.get_yticklabels()] == begins
    assert "m/s" in bar.get_ylabel()


WEAKENING = f"""
{PLATE.replace('friction.law = "velocity_weakening"', "")}{TILT}plate.element_size_m = 2e-3
material.stiffness_damping_s = 1e-6
friction = {{law = "slip_weakening", mu_s = 0.7, mu_k = 0.5, d_c_m = 4e-6}}
event.kind = "spontaneous"
loading.critical_margin = 0.05
sequence.max_events = 6
"""


def test_extents_of_events_are_those_of_cracks_in_the_tractions_before(tmp_path):
    sequence = slipfront.run(write_case(tmp_path, WEAKENING), output=tmp_path / "out", progress=False)
    events = sequence.events
    d_c_m, three_process_zones_m = 4e-6, 0.015
    nucleated = (events.longest_patch_m > events.nucleation_length_m).to_numpy()  # others stop before
    assert (nucleated == (events.mean_slip_m > d_c_m)).all() and not nucleated.all()
    ran = np.flatnonzero(nucleated)
    assert len(ran) > 1
    for end in ("from_x_m", "to_x_m"):
        off_m = (events[end] - events[f"predicted_{end}"]).to_numpy()[ran]
        assert (np.abs(off_m) < three_process_zones_m).all()
    later = sequence.runs[ran[-1]]
    by_law = {"fracture_energy_J_per_m2": 0.2, "residual_coefficient": 0.5}
    in_its_state = slipfront.predict_fronts(later, **by_law)
    in_the_first = slipfront.predict_fronts(later.case, **by_law, at_x_m=later.info["statics"]["peak_x_m"])
    assert "of the first event of the sequence" in in_the_first.attrs["notes"]
    assert "of the first event of the sequence" not in in_its_state.attrs["notes"]
    # In the first event's state no crack runs from there.
    assert in_its_state.attrs["starts"] and not in_the_first.attrs["starts"]
