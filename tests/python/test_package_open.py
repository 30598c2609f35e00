# SPDX-License-Identifier: BSD-3-Clause
"""Results opened with xarray: all fields, their units, lazily; damage is refused."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
import slipfront
import xarray as xr
from common import rows_of
from package_cases import CASE, results_of, write_case
from slipfront.units import unit_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return results_of(tmp_path_factory.mktemp("opened"))


def columns(file):
    rows = rows_of(file)
    texts = {"speed_kind"} & rows[0].keys()
    found = {name: np.array([r[name] for r in rows]) for name in texts}
    return found | {
        name: np.array([float(r[name] or "nan") for r in rows]) for name in rows[0].keys() - texts
    }


def test_the_history_is_the_files_and_read_when_used(folder):
    history = slipfront.open(folder).history
    with h5py.File(folder / "interface.h5") as file:
        for name in ("slip_m", "slip_rate_m_per_s", "t_Pa", "p_Pa"):
            assert not history[name].variable._in_memory
            assert history[name].dims == ("time_s", "x_m")
            assert history[name].attrs["units"] == file[name].attrs["unit"]
            assert history[name].attrs["long_name"]
            part = history[name][3:20:4, ::-2]
            assert np.array_equal(part, file[name][3:20:4][:, ::-2])
            assert not history[name].variable._in_memory
            assert np.array_equal(history[name], file[name])
        assert np.array_equal(history.time_s, file["time_s"])
        assert np.array_equal(history.x_m, file["x_m"])
    picked = history.slip_m.sel(x_m=[0.1, 0.05], method="nearest").isel(time_s=[5, 2, 2])
    assert np.array_equal(picked, history.slip_m.values[[5, 2, 2]][:, [20, 10]])


def test_results_are_found_from_another_working_folder(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(folder.parent)
    run = slipfront.open("out")
    monkeypatch.chdir(tmp_path)
    assert run.history.slip_m.values.shape == (run.history.sizes["time_s"], run.history.sizes["x_m"])
    assert run.fronts.sizes["point"] > 0
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    # An observer may change it, too.
    moves = [(1.0, lambda state: monkeypatch.chdir(elsewhere))]
    made = slipfront.run(CASE, output="made", observers=moves)
    assert made.folder == tmp_path / "made" and made.fronts.sizes["point"] > 0


def test_netcdf_finds_the_dimensions(folder):
    with xr.open_dataset(folder / "interface.h5", engine="h5netcdf") as found:
        history = slipfront.open(folder).history
        assert found.slip_m.dims == ("time_s", "x_m") and found.rows.dims == ("time_s", "row_value")
        for name in ("time_s", "x_m", "slip_m", "p_Pa"):
            assert np.array_equal(found[name], history[name])
    with h5py.File(folder / "interface.h5") as file:
        assert file["t_Pa"].dims[1].keys() == ["x_m"] and file["x_m"].is_scale


def test_tables_are_the_files(folder):
    run = slipfront.open(folder)
    for found, name, dim in ((run.tractions, "static.csv", "x_m"), (run.energies, "energy.csv", "time_s")):
        expected = columns(folder / name)
        assert set(found.variables) == set(expected)
        for column, values in expected.items():
            assert found[column].dims == (dim,)
            assert found[column].attrs["units"] == unit_of(column)
            assert np.array_equal(found[column], values, equal_nan=True)


def test_fronts_are_the_files(folder):
    run = slipfront.open(folder)
    expected = columns(folder / "fronts.csv")
    for column, values in expected.items():
        name = "direction_of_point" if column == "direction" else column
        assert np.array_equal(run.fronts[name], values, equal_nan=values.dtype.kind == "f")
    assert run.fronts.v_tip_m_per_s.attrs["units"] == "m/s"
    assert [str(end) for end in run.fronts.end.values] == [f["end"] for f in run.info["fronts"]]
    assert list(run.fronts.front) == [f["id"] for f in run.info["fronts"]]


def test_snapshots(folder):
    snapshots = slipfront.open(folder).snapshots
    with h5py.File(folder / "fields.vtkhdf") as file:
        group = file["VTKHDF"]
        n = snapshots.sizes["node"]
        velocity = group["PointData/velocity_m_per_s"][()].reshape(2, n, 3)[:, :, :2]
        points = group["Points"][()]
    assert not snapshots.velocity_m_per_s.variable._in_memory
    assert np.array_equal(snapshots.velocity_m_per_s[1, 10:20], velocity[1, 10:20])
    assert np.array_equal(snapshots.velocity_m_per_s.sel(component="x"), velocity[:, :, 0])
    assert np.array_equal(snapshots.velocity_m_per_s, velocity)
    assert np.array_equal(snapshots.y_m, points[:n, 1])
    assert snapshots.displacement_m.attrs["units"] == "m"
    assert snapshots.cell_nodes.sizes == {"cell": 40 * 20, "corner": 4}


def test_a_run_without_snapshots_and_probes(tmp_path):
    run = slipfront.run(CASE.replace("[20e-6, 60e-6]", "[]"), output=tmp_path / "out")
    assert run.snapshots is None and run.probes is None
    assert float(run.history.slip_m.max()) > 0


def test_friction_that_varies_is_there(tmp_path):
    (tmp_path / "friction.csv").write_text("x_m,mu_s\n0,1.2\n0.2,1.4\n")
    run = slipfront.run(write_case(tmp_path), {"friction.file": "friction.csv"})
    assert run.tractions.mu_s.attrs["units"] == "1"
    assert np.interp(0.1, run.tractions.x_m, run.tractions.mu_s) == pytest.approx(1.3, rel=1e-12)


def test_damage_is_refused_when_the_file_is_used(tmp_path):
    run = slipfront.run(write_case(tmp_path), output=tmp_path / "out")
    file = tmp_path / "out/energy.csv"
    file.write_text(file.read_text().replace("0", "1", 1))
    again = slipfront.open(run.folder)
    assert again.history.sizes["x_m"] == 41
    with pytest.raises(slipfront.DataError, match=r"energy.csv: does not match checksums.sha256"):
        _ = again.energies
    with pytest.raises(slipfront.DataError, match="no such folder"):
        slipfront.open(tmp_path / "nowhere")


def test_what_is_not_there_is_refused_by_a_line(folder, tmp_path):
    run = slipfront.open(folder)
    assert run.parameter("loading.shear_stiffness_Pa_per_m") == np.inf
    assert run.probes is None
    with pytest.raises(slipfront.DataError, match="the run has no such records"):
        run.absolute_stress(run.probes)
    (tmp_path / "sweep.json").write_text("{}")
    with pytest.raises(slipfront.DataError, match=r"is a sweep; open it by slipfront.sweep.open_sweep"):
        slipfront.open(tmp_path)


@pytest.mark.parametrize("missing", ["time_s", "x_m", "slip_rate_m_per_s", "p_Pa"])
def test_a_history_without_an_array_is_refused(folder, missing):
    run = slipfront.open(folder)
    arrays = {
        name: run.history[name].to_numpy() for name in ("time_s", "x_m", "slip_rate_m_per_s", "t_Pa", "p_Pa")
    }
    del arrays[missing]
    with pytest.raises(slipfront.CaseError, match=missing):
        slipfront.event_of_history(run.case, arrays)


def test_units_of_names():
    names = ("U_s_J_per_m3", "friction_work_J_per_m", "v_m_per_s", "t_Pa", "d_c_m", "mu_s")
    assert [unit_of(name) for name in names] == ["J/m3", "J/m", "m/s", "Pa", "m", "1"]


def test_moment_rate(tmp_path):
    run = slipfront.open(results_of(tmp_path, CASE + "output.moment_rate = true\n"))
    rates = run.moment_rate
    assert set(rates) == {
        *("potency_rate_m2_per_s", "moment_rate_N_per_s"),
        *("right_potency_rate_m2_per_s", "left_potency_rate_m2_per_s"),
    }
    assert rates.moment_rate_N_per_s.attrs["units"] == "N/s"
    assert rates.potency_rate_m2_per_s.attrs["long_name"] == "slip rate, summed over the interface"
    interval_s = float(rates.time_s[1] - rates.time_s[0])
    potency = [float(rates[name].sum()) * interval_s for name in rates if name.endswith("m2_per_s")]
    assert potency == pytest.approx([potency[0]] * 3, rel=1e-9) and potency[0] > 0


def test_probes(tmp_path):
    case = CASE + 'probes = {x_m = [0.05, 0.1], y_m = [0.01, 0.02], names = ["left", "middle"]}\n'
    probes = slipfront.open(results_of(tmp_path, case)).probes
    assert list(probes.probe.values) == ["left", "middle"]
    assert probes.x_m.values.tolist() == [0.05, 0.1]
    with h5py.File(tmp_path / "out/probes.h5") as file:
        assert np.array_equal(probes.stress_xy_Pa, file["stress_xy_Pa"])
        assert np.array_equal(probes.time_s, file["time_s"])
    assert probes.stress_xy_Pa.sel(probe="middle").attrs["units"] == "Pa"
