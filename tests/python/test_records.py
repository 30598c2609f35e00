# SPDX-License-Identifier: BSD-3-Clause
"""Files of recorders, cut into calibrated events: one experiment in every form, and what is refused."""

from __future__ import annotations

import io
import os
import re
import sys
import zipfile

import h5py
import numpy as np
import pytest
import slipfront
import xarray as xr
from common import ROOT
from nptdms import ChannelObject, TdmsFile, TdmsWriter
from nptdms.log import log_manager
from package_cases import refused
from scipy.io import netcdf_file, savemat
from slipfront import channels, records_command
from slipfront.records import Channel

N, RATE_HZ, SLOW_HZ = 20_000, 1e6, 20e3
AT_S = (5e-3, 10e-3, 15e-3)  # of the events
SLOW_OFFSET_S = 0.3e-3  # what the clock of the load cell is behind
NOISE, DRIFT_PER_S, OFFSET = 2e-7, 5e-4, 3e-4  # of strain
STEP = {"SG_m45": 8e-5, "SG_90": -3e-5, "SG_45": 5e-5}  # of strain, at each event
V_PER_STRAIN = 5.0 * 100 * 2.1 / 4  # excitation, gain and gauge factor of a quarter bridge
FAST = ("SG_m45", "SG_90", "SG_45", "trig", "dead")
TABLE = """
[recorder]
excitation_V = 5
gain = 100
gauge_factor = 2.1
bridge = "quarter"
y_mm = 3.5
bandwidth_kHz = 500
{clock}

[[channel]]
name = "SG_m45"
{SG_m45}
kind = "strain"
gauge = "SG"
angle_deg = -45
x_mm = 99

[[channel]]
name = "SG_90"
{SG_90}
kind = "strain"
gauge = "SG"
angle_deg = 90
x_mm = 100

[[channel]]
name = "SG_45"
{SG_45}
kind = "strain"
gauge = "SG"
angle_deg = 45
x_mm = 101

[[channel]]
name = "F"
{F}
kind = "force_shear"
factor = 2e3
clock_offset_ms = 0.3
bandwidth_kHz = 5
{slow_clock}

[[channel]]
name = "trig"
{trig}
kind = "trigger"

[[channel]]
name = "dead"
{dead}
kind = "displacement"
factor = 1e-3
dead = true
"""


@pytest.fixture(scope="session")
def recorded() -> dict[str, np.ndarray]:
    """Volts: three arms, trigger and a dead channel on one clock, the load cell on another one."""
    random = np.random.default_rng(3)
    time_s = np.arange(N) / RATE_HZ
    steps = sum(0.5 * (1 + np.tanh((time_s - t) / 20e-6)) for t in AT_S)
    made = {}
    for name, step in STEP.items():
        strain = OFFSET + DRIFT_PER_S * time_s + step * steps + NOISE * random.standard_normal(N)
        made[name] = V_PER_STRAIN * strain
    made["trig"] = np.where(sum((time_s >= t) & (time_s < t + 2e-4) for t in AT_S), 5.0, 0.0)
    made["trig"] += 0.02 * random.standard_normal(N)
    made["dead"] = np.zeros(N)
    slow_s = np.arange(round(N * SLOW_HZ / RATE_HZ)) / SLOW_HZ
    held = slow_s + SLOW_OFFSET_S
    force_N = 1000 + 2e5 * held - sum(600.0 * (held >= t) for t in AT_S)
    made["F"] = (force_N + 5 * random.standard_normal(len(slow_s))) / 2e3
    return made | {"t": time_s, "t_slow": slow_s}


def table(columns="{}", clock='time_s = "t"', slow_clock='time_s = "t_slow"') -> str:
    own = {name: f'column = "{columns.format(name)}"' for name in (*FAST, "F")}
    return TABLE.format(clock=clock, slow_clock=slow_clock, **own)


def mat5(folder, v):
    savemat(folder / "a.mat", v, do_compression=True)
    return ["a.mat"], table()


def mat5_struct(folder, v):
    savemat(folder / "a.mat", {"s": {"daq": v}, "about": "texts"})
    clocks = {"clock": 'time_s = "s.daq.t"', "slow_clock": 'time_s = "s.daq.t_slow"'}
    return ["a.mat"], table("s.daq.{}", **clocks)


def mat73(folder, v):
    """As MATLAB writes it: a column of N x 1 is 1 x N in HDF5; the arms are columns of one array."""
    with h5py.File(folder / "a.mat", "w", userblock_size=512) as made:
        arms = np.array([v[name] for name in STEP])
        for name, values in {**v, "arms": arms}.items():
            of = made.create_dataset(name, data=np.atleast_2d(values))
            of.attrs["MATLAB_class"] = np.bytes_("double")
        made["text"] = np.array([[97, 98]], np.uint16)
        made["text"].attrs["MATLAB_class"] = np.bytes_("char")
        inner = made.create_dataset("#refs#/a", data=np.ones((1, 2)))
        refs = made.create_dataset("cells", data=np.array([[inner.ref]], dtype=h5py.ref_dtype))
        refs.attrs["MATLAB_class"] = np.bytes_("cell")
    with open(folder / "a.mat", "r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    text = table()
    for k, name in enumerate(STEP):
        text = text.replace(f'column = "{name}"', f'column = "arms[:,{k}]"')
    return ["a.mat"], text


def hdf5(folder, v):
    with h5py.File(folder / "a.h5", "w") as made:
        for name, values in v.items():
            made[f"/daq/{name}"] = values
        made["/daq/arms"] = np.column_stack([v[name] for name in STEP])
    text = table("/daq/{}", 'time_s = "/daq/t"', 'time_s = "daq/t_slow"')
    return ["a.h5"], text.replace('column = "/daq/SG_90"', 'column = "/daq/arms[:,1]"')


def npz(folder, v):
    np.savez_compressed(folder / "a.npz", **v)
    return ["a.npz"], table()


def netcdf3(folder, v):
    with netcdf_file(folder / "a.nc", "w") as made:
        made.createDimension("t", None)  # unlimited, as recorders have it
        made.createDimension("t_slow", len(v["t_slow"]))
        for name in (*FAST, "F", "t", "t_slow"):
            of = made.createVariable(name, "d", ("t_slow" if name in ("F", "t_slow") else "t",))
            of[:] = v[name] * (1e6 if name == "t" else 1)
        made.variables["t"].units = "microseconds since 2026-01-01 00:00:00"
        made.variables["t_slow"].units = "s"
    return ["a.nc"], table(clock="", slow_clock="")


def netcdf4(folder, v):
    data = {name: ("t", v[name]) for name in FAST} | {"F": ("t_slow", v["F"])}
    times = {"t": ("t", 1e3 * v["t"], {"units": "ms"}), "t_slow": ("t_slow", v["t_slow"], {"units": "s"})}
    packed = {"dtype": "float64", "scale_factor": 0.5, "add_offset": 1.0, "_FillValue": -9e9}
    xr.Dataset(data, times).to_netcdf(folder / "a.nc", engine="h5netcdf", encoding={"SG_45": packed})
    return ["a.nc"], table(clock="", slow_clock="")


def tdms(folder, v):
    with TdmsWriter(folder / "a.tdms") as made:
        for first in (0, N // 2):  # in two segments, as it is streamed
            made.write_segment(
                [
                    ChannelObject(
                        "daq",
                        name,
                        v[name][first : first + N // 2],
                        {"wf_increment": 1e-6, "wf_start_offset": 0.0},
                    )
                    for name in FAST
                ]
            )
        slow = {"wf_increment": 1 / SLOW_HZ, "wf_start_offset": 0.0}
        made.write_segment([ChannelObject("slow", "F", v["F"], slow)])
    return ["a.tdms"], table("daq/{}", "", "").replace("daq/F", "slow/F")


def written(file, columns, *, separator, comma=False, head="", header=None):
    rows = ["" if header is None else separator.join(header)] if header else []
    for row in zip(*columns, strict=True):
        cells = [repr(float(value)) for value in row]
        rows.append(separator.join(cell.replace(".", ",") if comma else cell for cell in cells))
    file.write_text(head + "\n".join(rows) + "\n", encoding="latin-1")


def csv_files(folder, v):
    fast = [v["t"], *(v[name] for name in FAST)]
    written(folder / "a.csv", fast, separator=",", header=["t_s", *FAST])
    written(folder / "slow.csv", [v["t_slow"], v["F"]], separator=",", header=["t_slow (s)", "F"])
    return ["a.csv", "slow.csv"], table(clock='time = "t"', slow_clock='time = "t_slow"')


def semicolons(folder, v):
    """Decimal commas below a preamble, names and units."""
    head = (
        "Recorder 5\nRate;1000000\nµ is no UTF-8 here\n\n"
        + ";".join(["t", *FAST])
        + "\n(ms)"
        + ";(V)" * len(FAST)
        + "\n\n"
    )
    fast = [1e3 * v["t"], *(v[name] for name in FAST)]
    written(folder / "a.txt", fast, separator=";", comma=True, head=head)
    written(folder / "slow.txt", [v["t_slow"], v["F"]], separator="\t", comma=True, head="# t_slow\tF\n")
    return ["a.txt", "slow.txt"], table(clock='time = "t"')


def blanks(folder, v):
    """Without a header."""
    written(folder / "a.dat", [v["t"], *(v[name] for name in FAST)], separator="  ")
    written(folder / "slow.dat", [v["F"]], separator=" ")
    text = table(clock='time_s = "1"', slow_clock="sample_rate_kHz = 20\nfile = 'slow*'")
    for k, name in enumerate(FAST):
        text = text.replace(f'column = "{name}"', f"column = {k + 2}\nfile = 'a.*'")
    return ["a.dat", "slow.dat"], text.replace('column = "F"', "column = 1")


FORMS = (mat5, mat5_struct, mat73, hdf5, npz, netcdf3, netcdf4, tdms, csv_files, semicolons, blanks)
WINDOW = {"trigger": "trig", "before_s": 2e-3, "after_s": 1e-3}


@pytest.fixture
def experiment(tmp_path, recorded):
    """Files of a form and the table of their channels."""

    def make(form=npz, change=lambda text: text):
        names, text = form(tmp_path, recorded)
        (tmp_path / "channels.toml").write_text(change(text))
        return [tmp_path / name for name in names], tmp_path / "channels.toml"

    return make


@pytest.fixture(scope="session")
def events(tmp_path_factory, recorded):
    folder = tmp_path_factory.mktemp("npz")
    names, text = npz(folder, recorded)
    (folder / "channels.toml").write_text(text)
    return slipfront.read_recorders([folder / names[0]], folder / "channels.toml", **WINDOW)


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
def test_one_experiment_is_the_same_in_every_form(experiment, events, form):
    found = slipfront.read_recorders(*experiment(form), **WINDOW)
    assert [event.notes for event in found] == [event.notes for event in events]
    for event, other in zip(found, events, strict=True):
        assert list(event.channels) == ["SG_m45", "SG_90", "SG_45", "F", "trig"]
        assert event.time_s == pytest.approx(other.time_s, abs=1e-12)
        for name, channel in event.channels.items():
            same = other.channels[name]
            np.testing.assert_allclose(channel.time_s, same.time_s, atol=1e-12, rtol=0)
            scale = np.abs(same.values).max()
            np.testing.assert_allclose(channel.values, same.values, atol=1e-10 * scale, rtol=0)
            assert channel.noise == pytest.approx(same.noise, rel=1e-8)


def test_events_are_at_the_trigger_with_known_strain_noise_and_drift(events):
    # A rise from 0 to 5 V between two samples passes 2.5 V half a sample before the second.
    assert [e.time_s for e in events] == pytest.approx([t - 0.5e-6 for t in AT_S], abs=0.1e-6)
    for event in events:
        for name, step in STEP.items():
            channel = event.channels[name]
            n = round(1e-3 * RATE_HZ)  # the first half of before_s
            time_s = channel.time_s
            assert (time_s[0], time_s[-1]) == pytest.approx((-2e-3, 1e-3), abs=2e-6)
            behind = (time_s > 0.2e-3).nonzero()[0]
            expected = step + DRIFT_PER_S * (time_s[behind].mean() + 1.5e-3)
            assert channel.values[behind].mean() == pytest.approx(expected, abs=5 * NOISE / np.sqrt(n))
            # The standard deviation of n normal numbers is known to 1/sqrt(2 n) of it: 5 of these errors.
            assert channel.noise == pytest.approx(NOISE, rel=5 / np.sqrt(2 * n))
            assert channel.drift_error_per_s == pytest.approx(NOISE * np.sqrt(12 / n) / 1e-3, rel=0.15)
            assert abs(channel.drift_per_s - DRIFT_PER_S) < 5 * channel.drift_error_per_s
            assert channel.bandwidth_Hz == 500e3 and channel.unit == "1"
        force = event.channels["F"]
        assert np.isnan(force.zero_level) and force.values.min() > 900
        assert force.noise == pytest.approx(5, rel=0.8)  # of 20 samples


def test_a_drift_is_taken_off_where_this_is_asked(experiment):
    (event, *_) = slipfront.read_recorders(*experiment(), **WINDOW, take_drift=True)
    channel = event.channels["SG_45"]
    assert channel.drift_taken and not event.channels["F"].drift_taken
    behind = channel.time_s > 0.2e-3
    # The slope's error over the 2.1 ms from the middle of the zero window.
    assert channel.values[behind].mean() == pytest.approx(
        STEP["SG_45"], abs=5 * channel.drift_error_per_s * 2.1e-3
    )


def test_the_clocks_of_two_recorders_are_one(experiment, events):
    """The force drops by 600 N between the two samples about the event's time."""
    for event in events:
        force = event.channels["F"]
        k = np.argmin(np.diff(force.values))
        assert force.time_s[k] - 1e-6 <= 0 <= force.time_s[k + 1] + 1e-6


def test_events_by_times_and_by_drops_of_the_force(experiment):
    given = experiment()
    at = slipfront.read_recorders(*given, at_s=[5e-3, 15e-3], before_s=1e-3, after_s=1e-3)
    assert [e.time_s for e in at] == [5e-3, 15e-3] and [e.number for e in at] == [1, 2]
    drops = slipfront.read_recorders(*given, force_drop="F", within_s=1e-3, before_s=1e-3, after_s=1e-3)
    # The sample with which the lower force begins: at most one sample late.
    assert len(drops) == 3
    assert all(0 <= e.time_s - t <= 1 / SLOW_HZ for e, t in zip(drops, AT_S, strict=True))
    told = refused(
        lambda: slipfront.read_recorders(
            *given, force_drop="F", share=0.9, within_s=1e-3, before_s=1e-3, after_s=1e-3
        )
    )
    assert "channel 'F': never drops by 0.9 of its range" in told
    told = refused(
        lambda: slipfront.read_recorders(
            *given, force_drop="F", share=1e-3, within_s=1e-3, before_s=1e-3, after_s=1e-3
        )
    )
    assert "within the noise" in told


def test_a_rate_that_the_file_gainsays_is_refused(experiment):
    given = experiment(tdms, lambda text: text.replace("[recorder]", "[recorder]\nsample_rate_kHz = 100"))
    told = refused(lambda: slipfront.read_recorders(*given))
    assert "'SG_m45': sample_rate_Hz is 100000, by the file it is 1000000: leave it out" in told


def test_files_of_tdms_are_on_one_clock(tmp_path):
    begin = np.datetime64("2026-01-01T00:00:00.000000")
    with TdmsWriter(tmp_path / "a.tdms") as made:
        for name, late_us in (("A", 250), ("B", 0)):
            own = {"wf_increment": 1e-4, "wf_start_time": begin + np.timedelta64(late_us, "us")}
            made.write_segment([ChannelObject("g", name, np.arange(5.0), own)])
    (tmp_path / "c.csv").write_text("name,column,kind,factor\nA,g/A,slip,1\nB,g/B,slip,1\n")
    (event,) = slipfront.read_recorders(tmp_path / "a.tdms", tmp_path / "c.csv")
    assert event.channels["A"].time_s[0] == pytest.approx(250e-6, abs=1e-12)
    assert event.channels["B"].time_s[0] == 0


def test_tdms_that_was_cut_off_is_refused_and_its_package_named(experiment, monkeypatch):
    printed = io.StringIO()
    monkeypatch.setattr(log_manager.console_handler, "stream", printed)
    files, channel_table = experiment(tdms)
    files[0].write_bytes(files[0].read_bytes()[:-40])
    assert "has less data than expected" in refused(lambda: slipfront.read_recorders(files, channel_table))
    files[0].write_bytes(files[0].read_bytes()[:-3500])
    told = refused(lambda: slipfront.read_recorders(files, channel_table))
    assert "damaged" in told or "cut off" in told
    assert printed.getvalue() == ""
    with TdmsFile.open(files[0]):  # of others it prints as before
        assert "WARNING" in printed.getvalue()
    monkeypatch.setitem(sys.modules, "nptdms", None)
    assert "pip install npTDMS" in refused(lambda: slipfront.read_recorders(files, channel_table))


def test_without_a_cut_the_record_is_the_event(experiment):
    (event,) = slipfront.read_recorders(*experiment())
    channel = event.channels["SG_45"]
    assert event.time_s == 0 and len(channel.values) == N and np.isnan(channel.zero_level)
    assert channel.values[0] == pytest.approx(OFFSET, abs=5 * NOISE)
    (zeroed,) = slipfront.read_recorders(*experiment(), zero_s=(0, 4e-3))
    assert zeroed.channels["SG_45"].zero_level == pytest.approx(OFFSET + 2e-3 * DRIFT_PER_S, abs=NOISE)


def test_a_channel_that_does_not_change_is_told(experiment):
    (file,), channel_table = experiment(npz)
    held = dict(np.load(file))
    held[FAST[0]] = np.full_like(held[FAST[0]], 0.3)
    np.savez(file, **held)
    found = slipfront.read_recorders([file], channel_table, **WINDOW)
    told = [
        [note for note in event.notes if "does not change: dead, or not connected" in note] for event in found
    ]
    assert found and all(len(notes) == 1 for notes in told)


def test_windows_that_overlap_or_leave_the_record_are_told(experiment):
    found = slipfront.read_recorders(*experiment(), trigger="trig", before_s=4e-3, after_s=6e-3)
    assert "window overlaps that of event 2" in found[0].notes
    assert any("SG_45" in note and "window shortened to the record" in note for note in found[2].notes)
    assert not any("shortened" in note for note in found[0].notes[:1])


def test_a_rosette_is_a_gauge_with_places_of_its_arms(events):
    (gauge,) = events[0].gauges()
    assert gauge.name == "SG" and gauge.parts == ["-45", "90", "45"] and gauge.is_strain
    assert gauge.places_m == {"-45": (0.099, 3.5e-3), "90": (0.1, 3.5e-3), "45": (0.101, 3.5e-3)}
    assert (gauge.x_m, gauge.y_m) == pytest.approx((0.1, 3.5e-3))
    np.testing.assert_array_equal(gauge.values["90"], events[0].channels["SG_90"].values)


def test_arms_at_one_place_are_components_and_two_stay_arms(experiment):
    def together(text):
        return text.replace("x_mm = 99\n", "x_mm = 100\n").replace("x_mm = 101\n", "x_mm = 100\n")

    (event, *_) = slipfront.read_recorders(*experiment(change=together), **WINDOW)
    (gauge,) = event.gauges()
    arms = {name: event.channels[name].values for name in STEP}
    assert gauge.parts == ["xx", "yy", "xy"]
    np.testing.assert_allclose(gauge.values["yy"], arms["SG_90"], atol=1e-15)
    # Along +-45 deg strain is (xx + yy)/2 +- xy.
    np.testing.assert_allclose(gauge.values["xy"], (arms["SG_45"] - arms["SG_m45"]) / 2, atol=1e-15)

    def without_one(text):
        return together(text).replace("angle_deg = 90\n", "angle_deg = 90\ndead = true\n")

    (event, *_) = slipfront.read_recorders(*experiment(change=without_one), **WINDOW)
    assert event.gauges()[0].parts == ["-45", "45"]


def test_files_of_one_recorder_are_an_event_each(experiment, tmp_path, recorded):
    (file,), channel_table = experiment()
    second = tmp_path / "b.npz"
    np.savez(second, **{**recorded, "SG_45": 2 * recorded["SG_45"]})
    found = slipfront.read_recorders([file, second], channel_table, at_s=[10e-3], before_s=1e-3, after_s=1e-3)
    assert [(e.number, e.source) for e in found] == [(1, "a.npz"), (2, "b.npz")]
    one, two = (e.channels["SG_45"].values for e in found)
    np.testing.assert_allclose(two, 2 * one, atol=1e-15)
    np.savez(second, **{name: v for name, v in recorded.items() if name != "F"})
    told = refused(lambda: slipfront.read_recorders([file, second], channel_table))
    assert "is in" in told and "'F' is in 1 of 2 files: say by the key file which one" in told


BRIDGE = {"excitation_V": 5, "gain": 100, "gauge_factor": 2.0}
ARM = {"name": "A", "kind": "strain", "angle_deg": 0, "x_m": 0, "y_m": 1}


@pytest.mark.parametrize("bridge, strain", [("quarter", 4e-3), ("half", 2e-3), ("full", 1e-3)])
def test_bridges_by_hand(bridge, strain):
    """1 V behind a gain of 100 is 10 mV; of 5 V that is 2 mV/V; 4 * 2e-3 / (1, 2, 4 arms * 2)."""
    wiring = channels.wiring_of("t", {**ARM, **BRIDGE, "bridge": bridge}, {})
    assert wiring.per_recorded("") == pytest.approx(strain)
    assert wiring.per_recorded("mV") == pytest.approx(strain / 1000)
    turned = channels.wiring_of("t", {**ARM, **BRIDGE, "bridge": bridge, "polarity": -1.0}, {})
    assert turned.per_recorded("V") == pytest.approx(-strain)
    assert "recorded in N, not in volts" in refused(lambda: wiring.per_recorded("N"))


def test_factors_and_units_of_the_file():
    def factor(unit="", **own):
        return channels.wiring_of("t", {"name": "A", "x_m": 0.0, "y_m": 1.0, **own}, {}).per_recorded(unit)

    assert factor(kind="gamma_xy", factor=3.0) == 1.5
    assert factor("kN", kind="force_normal") == 1e3
    assert factor("kN", kind="force_normal", factor=2.0) == 2.0
    assert factor("ustrain", kind="strain_xx", polarity=-1.0) == -1e-6
    assert factor(kind="trigger") == 1.0
    for kind, what in (("strain_xx", "strain in 1"), ("force_shear", "force in N"), ("slip", "slip in m")):
        assert f"factor = 1 if the file holds {what}" in refused(lambda kind=kind: factor(kind=kind))


def test_a_table_of_csv_says_the_same(experiment, events):
    (file,), channel_table = experiment()
    read = channels.read_channels(channel_table)
    names = ("name", "kind", "gauge", "angle_deg", "factor", "excitation_V", "gain", "gauge_factor", "bridge",
             "time", "clock_offset_s", "dead", "x_m", "y_m")  # fmt: skip
    rows = [";".join([*names[:9], "time_s", *names[10:]])]
    for wiring in read:
        cells = [getattr(wiring, name) for name in names]
        rows.append(";".join("" if c is None or c != c else str(c).replace(".", ",") for c in cells))
    other = channel_table.with_suffix(".csv")
    other.write_text("# of two recorders\n" + "\n".join(rows) + "\n")
    found = slipfront.read_recorders(file, other, **WINDOW)
    for event, same in zip(found, events, strict=True):
        np.testing.assert_array_equal(event.channels["SG_90"].values, same.channels["SG_90"].values)
        np.testing.assert_array_equal(event.channels["F"].time_s, same.channels["F"].time_s)


def test_flat_tops_are_found_before_the_zero_is_taken(experiment, tmp_path, recorded):
    (file,), channel_table = experiment()
    clipped = np.minimum(recorded["SG_m45"], recorded["SG_m45"].max() - 0.3 * np.ptp(recorded["SG_m45"]))
    np.savez(file, **{**recorded, "SG_m45": clipped})
    found = slipfront.read_recorders(file, channel_table, **WINDOW)
    assert not found[0].channels["SG_m45"].flat_s and not found[2].channels["SG_90"].flat_s
    ((first, last),) = found[2].channels["SG_m45"].flat_s
    assert abs(first) < 50e-6 and last == found[2].channels["SG_m45"].time_s[-1]
    assert found[2].gauges()[0].flat_s == ((first, last),)


# The file


def call(*arguments):
    return records_command.main([str(a) for a in arguments])


def command(files, channel_table, output):
    return call(
        *files,
        "--channels",
        channel_table,
        "--trigger",
        "trig",
        "--before-s",
        "2e-3",
        "--after-s",
        "1e-3",
        "-o",
        output,
    )


def test_the_file_holds_the_events_and_xarray_reads_it(experiment, events, tmp_path, capsys):
    files, channel_table = experiment()
    output = tmp_path / "records.nc"
    assert command(files, channel_table, output) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0].startswith("event 1: at 0.00499") and "5 channels, -1.999 ms to 999.5 us" in told[0]
    assert any(line.startswith("SG_90: 1e+06 Hz, noise 2e-07, drift up to 0.0005") for line in told)
    assert "zero, noise and drift by -0.002 to -0.001 s since the event's time" in told
    assert "dead, left out: dead" in told and any("midway of its range" in line for line in told)
    found = slipfront.read_records(output)
    for event, same in zip(found, events, strict=True):
        assert list(event.channels) == list(same.channels)
        assert (event.time_s, event.source, event.notes) == (same.time_s, same.source, same.notes)
        for name, channel in event.channels.items():
            for field in channel.__dataclass_fields__:
                np.testing.assert_array_equal(getattr(channel, field), getattr(same.channels[name], field))
    with xr.open_dataset(output, group="event_0002", engine="h5netcdf") as data:
        assert data.SG_90.dims == ("time",) and data.F.dims == ("time_2",)
        assert data.SG_90.attrs["units"] == "1" and data.F.attrs["units"] == "N" and data.time.units == "s"
        assert data.SG_90.attrs["gauge"] == "SG" and data.SG_90.attrs["angle_deg"] == 90
        assert data.SG_90.attrs["x_m"] == 0.1 and data.SG_90.attrs["noise"] == pytest.approx(NOISE, rel=0.15)
        assert data.time.attrs["recorder_time_of_zero_s"] == events[1].time_s
        np.testing.assert_array_equal(data.SG_90, events[1].channels["SG_90"].values)
    with xr.open_dataset(output, engine="h5netcdf") as root:
        assert root.attrs["Conventions"] == "CF-1.11" and tuple(root.attrs["zero_s"]) == (-2e-3, -1e-3)
        assert len(root.attrs["source_sha256"]) in (1, 64)


def test_the_same_input_gives_the_same_bytes(experiment, tmp_path):
    given = experiment()
    output = tmp_path / "records.nc"
    assert command(*given, output) == 0
    first = output.read_bytes()
    os.utime(given[0][0], (0, 0))
    assert command(*given, output) == 0
    assert output.read_bytes() == first


def test_nothing_but_own_files_is_replaced(experiment, tmp_path, capsys):
    given = experiment(hdf5)
    for other in ("text.nc", "other.nc"):
        with h5py.File(tmp_path / "other.nc", "w") as made:
            made["a"] = 1
        (tmp_path / "text.nc").write_text("mine")
        before = (tmp_path / other).read_bytes()
        assert command(*given, tmp_path / other) == 2
        assert "not replaced" in capsys.readouterr().err
        assert (tmp_path / other).read_bytes() == before
    output = tmp_path / "records.nc"
    assert command(*given, output) == 0
    kept = output.read_bytes()
    given[1].write_text(given[1].read_text().replace('"/daq/trig"', '"/daq/t_slow"'))
    assert command(*given, output) == 2  # its trigger has other times
    assert output.read_bytes() == kept and not list(tmp_path.glob(".unfinished*"))


def test_what_files_hold_is_listed(experiment, capsys):
    files, _ = experiment(tdms)
    assert call(*files, "--list") == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == f"{files[0]}:" and "  daq/SG_90: 20000, 1000000 Hz" in told
    files, _ = experiment(mat73)
    assert call(*files, "--list") == 0
    told = capsys.readouterr().out
    assert (
        "arms: 20000 x 3\n" in told and "text: texts (of class char), 2 x 1" in told and "#refs#" not in told
    )
    files, _ = experiment(semicolons)
    assert call(files[0], "--list") == 0
    assert "  SG_90: 20000, unit V\n" in capsys.readouterr().out


def test_traces_are_drawn(experiment, tmp_path, capsys):
    files, channel_table = experiment()
    picture = tmp_path / "traces.png"
    assert call(*files, "--channels", channel_table, "-o", tmp_path / "r.nc", "--figure", picture) == 0
    assert picture.read_bytes().startswith(b"\x89PNG") and f"figure: {picture}" in capsys.readouterr().out


def test_the_page_has_all_keys_and_kinds_and_its_example_runs(tmp_path, recorded):
    page = (ROOT / "docs/records.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`(\w+)`", page))
    assert set(channels.KEYS) <= named and set(channels.KINDS) <= named
    assert {
        name for name in Channel.__dataclass_fields__ if name not in ("name", "time_s", "values")
    } <= named
    own = tmp_path / "channels.toml"
    own.write_text(re.search(r"^```toml\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)[1])
    with h5py.File(tmp_path / "daq.h5", "w") as made:
        made["/daq/t"], made["/daq/ch0"], made["/daq/ch7"] = (
            recorded[name] for name in ("t", "SG_45", "trig")
        )
    written(tmp_path / "load.csv", [recorded["F"]], separator=",", header=["shear (V)"])
    found = slipfront.read_recorders([tmp_path / "daq.h5", tmp_path / "load.csv"], own, **WINDOW)
    assert [event.source for event in found] == ["daq.h5, load.csv"] * 3
    assert found[0].channels["F_S"].values.max() == pytest.approx(2000, abs=50)  # before the drop


# What is refused


def test_options_that_do_not_belong_together(experiment, tmp_path, capsys):
    files, channel_table = experiment()
    window = ["--before-s", "1", "--after-s", "1"]
    plain = [*files, "--channels", channel_table, "-o", tmp_path / "r.nc"]
    for more, told in (
        (["--at-s", "1,2", "--trigger", "trig"], "both --at-s and --trigger are given"),
        (["--trigger", "trig"], "--trigger needs --before-s and --after-s"),
        (["--before-s", "1"], "--before-s and --after-s are of events: give --at-s"),
        (["--force-drop", "F", *window], "--force-drop and --within-s"),
        (["--trigger", "none", *window], "'none', by which events are cut, is no channel"),
        (["--trigger", "dead", *window], "'dead', by which events are cut, is dead"),
        (["--trigger", "trig,99", *window], "never rises through 99"),
        (["--at-s", "77", *window], "nothing was recorded about the event at 77 s"),
        (["--take-drift"], "--take-drift needs --zero-s"),
    ):  # fmt: skip
        assert call(*plain, *more) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1 and told in error, error
    with pytest.raises(SystemExit) as ended:
        call(*files)
    assert ended.value.code == 2 and "--list" in capsys.readouterr().err


@pytest.mark.parametrize(
    "old, new, told",
    [
        ("gain = 100", "gian = 100", "[recorder]: unknown key 'gian'; did you mean gain?"),
        ("gain = 100", "gain = 0", "gain is 0; it must be above 0"),
        ("gain = 100", "gain = 'x'", "gain is 'x'; it must be a number"),
        ("gain = 100\n", "", "channel 'SG_m45': the bridge is not complete: give gain"),
        ("bridge = \"quarter\"", 'bridge = "third"', "bridge is 'third'; it is one of quarter, half, full"),
        ('kind = "trigger"', 'kind = "triger"', "unknown kind 'triger'; did you mean trigger?"),
        ('kind = "trigger"', "", "channel 'trig': has no kind"),
        ('kind = "trigger"', 'kind = "trigger"\ngain = 2', "gain is of strain gauges; give factor for"),
        ("angle_deg = 45", "", "channel 'SG_45': give angle_deg of the arm"),
        ("angle_deg = 45", "angle_deg = 270", "gauge 'SG' has two channels of one angle"),
        ("x_mm = 101", "", "channel 'SG_45': give its place, x_m and y_m"),
        ("y_mm = 3.5", "y_mm = 0", "y_m is 0, on the interface"),
        ("x_mm = 101", "x_mm = 101\ny_mm = -3", "gauge 'SG' is on both sides of the interface"),
        ("x_mm = 101", "x_mm = 101\nx_m = 0.1", "x_m is given twice, once as 'x_m'"),
        ('name = "SG_45"', 'name = "SG_90"', "two channels 'SG_90'"),
        ('name = "SG_45"', 'name = "time_2"', "no channel of records.nc has such a name"),
        ('column = "SG_45"', 'column = "SG_46"', "'SG_46' is no column; did you mean 'SG_45'"),
        ('column = "SG_45"', 'column = "SG_45[:,1]"', "'SG_45' is 20000, which has no such part"),
        ('time_s = "t"', 'time_s = "t"\nsample_rate_Hz = 5', "has both a column of times and sample_rate_Hz"),
        ('time_s = "t"', 'time = "t"', "time 't' names none of the units s, ms, us, ns"),
        ('time_s = "t"', "first_time_s = 1", "[recorder]: first_time_s is of times by sample_rate_Hz"),
        ('time_s = "t"', "", "channel 'SG_m45': its times are not known"),
        ('time_s = "t"', 'time_s = "SG_90"', "time 'SG_90' does not ascend"),
        ('time_s = "t"', 'time_s = "t_slow"', "channel 'SG_m45': 20000 values, but 400 times"),
        ("factor = 2e3\n", "", "'F': how a recorded number becomes force_shear is not known: give"),
        ("dead = true", "dead = 1", "dead is 1; it must be true or false"),
        ("[recorder]", "[recorder", ":2: not TOML"),
        ("[recorder]", "[recoder]", "unknown 'recoder'"),
    ],
)  # fmt: skip
def test_tables_that_are_refused(experiment, old, new, told):
    files, channel_table = experiment(change=lambda text: text.replace(old, new, 1))
    error = refused(lambda: slipfront.read_recorders(files, channel_table, **WINDOW))
    assert "channels.toml" in error or "a.npz" in error
    assert told in error


@pytest.mark.parametrize("level", [None, 2.0])
def test_a_trigger_without_values_is_refused(experiment, recorded, level):
    (file,), channel_table = experiment()
    np.savez(file, **{**recorded, "trig": np.full(N, np.nan)})
    told = refused(lambda: slipfront.read_recorders(file, channel_table, **WINDOW, level=level))
    assert "channel 'trig': the trigger does not change" in told


def test_lines_of_a_csv_table_are_told(experiment, tmp_path):
    files, _ = experiment()
    own = tmp_path / "channels.csv"
    for text, told in (
        ("name,kind,factor\nA,slip,1\nB,slip,x\n", ":3: 'x' in column 'factor' is not a number"),
        ("name,kind,dead\nA,slip,perhaps\n", ":2: dead is 'perhaps'; it must be true or false"),
        ("name,kind\nA\n", ":2: 1 cells, the header has 2"),
        ("name,kind\n", "has no channels"),
        ("name,kind,fabtor\nA,slip,1\n", ":2: unknown key 'fabtor'; did you mean factor?"),
    ):
        own.write_text(text)
        error = refused(lambda: slipfront.read_recorders(files, own))
        assert error.startswith(str(own)) and told in error


HELD = {
    "nan": np.full(50, np.nan), "empty": np.empty(0), "complex": np.ones(50, complex),
    "texts": np.array(["a"] * 50), "cube": np.ones((5, 5, 2)), "flat": np.ones((5, 10)),
    "good": np.arange(50.0),
    "falling": np.arange(50.0)[::-1], "holes": np.where(np.arange(50) % 7, 1.0, np.nan) * np.arange(50.0),
    "infinite": np.where(np.arange(50) == 9, np.inf, 1.0 * np.arange(50)),
}  # fmt: skip


def as_npz(folder):
    np.savez(folder / "a.npz", **HELD)
    return folder / "a.npz"


def as_mat(folder):
    savemat(folder / "a.mat", HELD)
    return folder / "a.mat"


def as_hdf5(folder):
    with h5py.File(folder / "a.h5", "w") as made:
        for name, values in HELD.items():
            made[name] = [str(v) for v in values] if name == "texts" else values
    return folder / "a.h5"


@pytest.mark.parametrize("write", [as_npz, as_mat, as_hdf5], ids=lambda f: f.__name__)
def test_arrays_that_are_no_records_are_refused(tmp_path, write):
    file = write(tmp_path)
    own = tmp_path / "c.toml"

    def read(name, clock="sample_rate_Hz = 10"):
        own.write_text(f'[[channel]]\nname = "{name}"\nkind = "slip"\nfactor = 1\n{clock}\n')
        return slipfront.read_recorders(file, own)

    assert "holds complex numbers" in refused(lambda: read("complex"))
    assert "is empty" in refused(lambda: read("empty"))
    told = refused(lambda: read("texts"))
    assert "holds texts" in told or "but a char" in told or "holds references or objects" in told
    assert "is an array of 5 x 5 x 2" in refused(lambda: read("cube"))
    assert "'flat[:,0]'" in refused(lambda: read("flat"))
    assert "does not ascend" in refused(lambda: read("good", 'time_s = "falling"'))
    assert "missing or not finite" in refused(lambda: read("good", 'time_s = "holes"'))
    (event,) = read("holes")
    assert "holes: 8 of 50 values missing or infinite" in event.notes
    (event,) = read("infinite")
    assert np.isnan(event.channels["infinite"].values[9])
    (event,) = read("flat[2,:]")
    assert len(event.channels["flat[2,:]"].values) == 10
    (event,) = read("nan")
    assert event.channels == {} and event.notes == ("nan: left out: no value in the window",)


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
def test_cut_and_damaged_files_are_read_or_refused(experiment, form, recorded):
    """Any part of a file, and any with changed bytes, ends in events or in one line."""
    files, channel_table = experiment(form)
    whole, random = files[0].read_bytes(), np.random.default_rng(7)
    for trial in range(24):
        data = bytearray(whole)
        if trial < 12:
            data = data[: int(len(data) * trial / 12)]
        elif form is not netcdf4:  # some references of HDF5, changed, hold its library up
            for k in random.integers(0, min(len(data), 4000), 8):
                data[k] ^= int(random.integers(1, 256))
        files[0].write_bytes(data)
        try:
            slipfront.read_recorders(files, channel_table, at_s=[5e-3], before_s=1e-3, after_s=1e-3)
        except slipfront.Error as error:
            assert "\n" not in str(error)


def test_objects_of_a_file_are_not_unpickled(tmp_path):
    class Bomb:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "ran"),)

    np.savez(tmp_path / "a.npz", good=np.arange(5.0), bad=np.array([Bomb()], dtype=object))
    (tmp_path / "c.csv").write_text("name,kind,factor,sample_rate_Hz\nbad,slip,1,10\n")
    told = refused(lambda: slipfront.read_recorders(tmp_path / "a.npz", tmp_path / "c.csv"))
    assert "holds references or objects" in told and not (tmp_path / "ran").exists()
    (tmp_path / "c.csv").write_text("name,kind,factor,sample_rate_Hz\ngood,slip,1,10\n")
    (event,) = slipfront.read_recorders(tmp_path / "a.npz", tmp_path / "c.csv")
    assert event.channels["good"].values[-1] == 4


def claiming(shape, n_bytes):
    """A member of an archive whose header claims a shape."""
    member = io.BytesIO()
    np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": shape})
    return member.getvalue() + b"\0" * n_bytes


def test_shapes_that_no_file_holds_are_refused(tmp_path):
    own = tmp_path / "c.csv"
    own.write_text("name,kind,factor,sample_rate_Hz\nx,slip,1,10\n")
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("x.npy", claiming((10**13,), 800))
    assert "holds less than it claims" in refused(lambda: slipfront.read_recorders(tmp_path / "a.npz", own))
    with h5py.File(tmp_path / "a.h5", "w") as made:
        made.create_dataset("x", (10**12,), chunks=(10**6,), dtype="f8", compression="gzip")[:10] = 1
    assert "holds less than it claims" in refused(lambda: slipfront.read_recorders(tmp_path / "a.h5", own))
    with h5py.File(tmp_path / "a.h5", "w") as made:  # its recorder stopped in between
        made.create_dataset("x", (300,), chunks=(100,), dtype="f8")[:200] = 1
    assert "holds less than it claims" in refused(lambda: slipfront.read_recorders(tmp_path / "a.h5", own))
    with h5py.File(tmp_path / "b.h5", "w") as made:
        made.create_dataset("x", (50,), dtype="f8", external=[(str(tmp_path / "secret"), 0, 400)])
    (tmp_path / "secret").write_bytes(b"\1" * 400)
    assert "values of other files" in refused(lambda: slipfront.read_recorders(tmp_path / "b.h5", own))
    with h5py.File(tmp_path / "c.h5", "w") as made:
        made["x"] = h5py.ExternalLink("a.h5", "x")
        made["y"] = np.ones(5)
    assert "'x' is no column" in refused(lambda: slipfront.read_recorders(tmp_path / "c.h5", own))


def test_structs_of_references_are_refused(experiment):
    files, channel_table = experiment(mat73, lambda text: text.replace('"arms[:,1]"', '"cells"'))
    told = refused(lambda: slipfront.read_recorders(files, channel_table))
    assert "'cells' holds references (of class cell)" in told


TEXTS = {
    "ragged": ("t_s,A\n0,1\n1,2\n2\n3,4\n", ":4: 1 cells, the lines before have 2"),
    "cut": ("t_s,A\n0,1\n1,2\n2", ":4: 1 cells, the lines before have 2, and ends the file: cut off"),
    "words": ("t_s,A\n0,1\n1,2\n2,over\n", ":4: 'over' in column 'A' is not a number"),
    "prose": ("nothing\nhere\n", "no two lines of numbers"),
    "two heads": ("a,b\nt_s,A\n0,1\n1,2\n", ":1: this line and those up to 2 may be the header"),
    "twice": ("t_s,A,A\n0,1,2\n1,2,3\n", "'A' is no column"),
    "bytes": ("t_s,A\0\n0,1\n", "not a file of the forms that are read"),
    "empty": ("", "no two lines of numbers"),
    "bare time": ("t,A\n0,1\n1,2\n", "names none of the units"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_texts_that_are_refused(tmp_path, name):
    text, told = TEXTS[name]
    (tmp_path / "a.csv").write_text(text)
    (tmp_path / "c.csv").write_text("name,kind,factor,time\nA,slip,1,t\n")
    error = refused(lambda: slipfront.read_recorders(tmp_path / "a.csv", tmp_path / "c.csv"))
    assert error.startswith(str(tmp_path / "a.csv")) and told in error, error


def test_texts_of_several_hands(tmp_path):
    """Each holds t = 0, 1, 2 s and A = 1.5, nan, 3.5 mm."""
    (tmp_path / "c.csv").write_text("name,kind,factor,time\nA,slip,1e-3,t\n")
    for text, line in (
        ("t_s;A\r\n0;1,5\r\n1;\r\n2;3,5\r\n", None),
        ('"t (s)","A"\n0,1.5\n1,NaN\n2,3.5', None),
        ("t_ms\tA\n0\t1.5\n1000\t\n2000\t3.5\n\n", None),
        ("% made by hand\n% t_s  A\n 0  1.5\n 1  nan\n 2  3.5\n", None),
        ("a,b\nt_s,A\n0,1.5\n1,-\n2,3.5\n", 2),
        ("t,A\ns,mm\n0,1.5\n1,\n2,3.5\n", None),
        ("Rate;5\nt_s;day;A\n0;1.1.2026;1,5\n1;1.1.2026;\n2;1.1.2026;3,5\n", None),
        ("t_s;A\n0;1,5;\n1;;\n2;3,5;\n", None),
        ("t (s)   A (mm)\n0 1.5\n1 nan\n2 3.5\n", None),
    ):
        (tmp_path / "a.txt").write_bytes(text.encode())
        (event,) = slipfront.read_recorders(tmp_path / "a.txt", tmp_path / "c.csv", header_line=line)
        np.testing.assert_array_equal(event.channels["A"].time_s, [0, 1, 2])
        np.testing.assert_allclose(event.channels["A"].values, [1.5e-3, np.nan, 3.5e-3])


def test_records_that_are_none_are_refused(tmp_path, experiment):
    given = experiment()
    output = tmp_path / "records.nc"
    assert command(*given, output) == 0
    whole = output.read_bytes()
    for wrong in (whole[: len(whole) // 2], b"text", b""):
        output.write_bytes(wrong)
        assert str(output) in refused(lambda: slipfront.read_records(output))
    with h5py.File(output, "w") as made:
        made["a"] = 1.0
    assert "no records of slipfront records" in refused(lambda: slipfront.read_records(output))
    output.write_bytes(whole)
    with h5py.File(output, "r+") as made:
        made["event_0001/F"].attrs["kind"] = "none"
    assert "'event_0001/F' is no channel" in refused(lambda: slipfront.read_records(output))
