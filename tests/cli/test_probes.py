# SPDX-License-Identifier: BSD-3-Clause
"""Probes, snapshots at an interval with strain and stress, and what HDF5 files say of themselves."""

import h5py
import numpy as np
import pytest
from common import COARSE, notes_of, refusal, require_done, run_json, sets
from slipfront.opened import open_run
from slipfront.read import PROBE_FIELDS

PROBES = '[probes]\nx_m = [0.1, 0.05]\ny_m = [0.01, 0.0]\nnames = ["SG 1", "Kante ä"]\ninterval_s = 2e-6\n'
NO_FIELDS = ("name", "rows", "probe", "row_value")


@pytest.fixture
def probed(write_case):
    return write_case(COARSE + "\n" + PROBES)


def test_probes_have_names_places_units_and_rows(program, probed, tmp_path):
    require_done(program("run", probed, "-o", "out", "-q"))
    probes = open_run(tmp_path / "out").probes
    assert probes.probe.values.tolist() == ["SG 1", "Kante ä"]
    assert probes.x_m.values.tolist() == [0.1, 0.05] and probes.y_m.values.tolist() == [0.01, 0]
    assert probes.time_s[0] == 0 and np.all(np.diff(probes.time_s) > 1e-6)
    end_s = run_json(tmp_path / "out")["time_s"]
    assert end_s - 4e-6 < probes.time_s[-1] < end_s
    assert set(probes) == set(PROBE_FIELDS)
    with h5py.File(tmp_path / "out/probes.h5") as file:
        units = {name: file[name].attrs["unit"] for name in file if name not in NO_FIELDS}
        assert all(file[name].attrs["description"] for name in file)
    assert units.pop("time_s") == "s" and set(units) == {"x_m", "y_m", *PROBE_FIELDS}
    for name, unit in units.items():
        endings = {"Pa": "_Pa", "m/s": "_m_per_s", "m": "_m", "1": ("_xx", "_yy", "_zz", "_xy")}
        assert name.endswith(endings[unit])
    # At the interface t = -stress_xy where the plate slides to +x: the traction before the event.
    with h5py.File(tmp_path / "out/interface.h5") as file:
        node = int(np.argmin(np.abs(file["x_m"][:] - 0.05)))
        assert np.sign(probes["stress_xy_Pa"].values[0, 1]) == np.sign(file["t_Pa"][0, node])
        assert probes["stress_yy_Pa"].values[0, 1] == pytest.approx(-file["p_Pa"][0, node], rel=0.2)


def test_probes_far_from_a_prestressed_interface(program, tmp_path):
    (tmp_path / "case.toml").write_text(require_done(program("new", "two-bodies")).stdout)
    places = sets("probes.x_m=[0.05, 0.05]", "probes.y_m=[0.0101, -0.0303]")
    require_done(program("validate", "case.toml", *places))


def test_every_hdf5_file_says_where_it_comes_from(program, probed, tmp_path):
    require_done(program("run", probed, "-o", "out", "-q", *sets("output.snapshot_interval_s=20e-6")))
    case = (tmp_path / "out/case.resolved.toml").read_text(encoding="utf-8")
    version = run_json(tmp_path / "out")["version"]
    for name in ("interface.h5", "probes.h5", "fields.vtkhdf"):
        with h5py.File(tmp_path / "out" / name) as file:
            assert file.attrs["program"] == "slipfront" and file.attrs["version"] == version
            assert file.attrs["case"] == case and file.attrs["title"] == "coarse"
            assert file.attrs["units"].startswith("SI")


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_snapshots_have_strain_and_stress_of_the_cells(program, coarse, tmp_path, plane):
    keys = sets("output.snapshot_interval_s=20e-6", f"material.plane={plane}")
    require_done(program("run", coarse, "-o", "out", "-q", *keys))
    with h5py.File(tmp_path / "out/fields.vtkhdf") as file:
        group = file["VTKHDF"]
        times = group["Steps/Values"][:]
        assert times[:3] == pytest.approx([0, 20e-6, 40e-6], abs=5e-6)
        n_points, n_cells = int(group["NumberOfPoints"][0]), int(group["NumberOfCells"][0])
        cells = group["Connectivity"][:].reshape(-1, 4)
        xy, step = group["Points"][:, :2][cells], 1
        u = group["PointData/displacement_m"][step * n_points : (step + 1) * n_points, :2][cells]
        own = slice(step * n_cells, (step + 1) * n_cells)
        data = {name: values[own] for name, values in group["CellData"].items()}
        offsets = [k * n_cells for k in range(len(times))]
        for name in data:
            assert group["Steps/CellDataOffsets"][name][:].tolist() == offsets
    # The mean gradient over a parallelogram is that of the centre; all cells here are ones or nearly so.
    diagonals = np.stack([xy[:, 2] - xy[:, 0], xy[:, 3] - xy[:, 1]], axis=1)
    gradient = np.linalg.solve(diagonals, np.stack([u[:, 2] - u[:, 0], u[:, 3] - u[:, 1]], axis=1))
    assert data["strain_xx"] == pytest.approx(gradient[:, 0, 0], abs=1e-12)
    assert data["strain_yy"] == pytest.approx(gradient[:, 1, 1], abs=1e-12)
    assert data["strain_xy"] == pytest.approx(0.5 * (gradient[:, 0, 1] + gradient[:, 1, 0]), abs=1e-12)
    nu, young = 0.37, 2.6e9
    s_xx, s_yy, s_zz = data["stress_xx_Pa"], data["stress_yy_Pa"], data.get("stress_zz_Pa", 0)
    e_zz = data.get("strain_zz", 0)
    assert ("strain_zz" in data) == (plane == "stress") != ("stress_zz_Pa" in data)
    largest = np.abs(data["strain_yy"]).max()
    assert data["strain_xx"] == pytest.approx((s_xx - nu * (s_yy + s_zz)) / young, abs=1e-9 * largest)
    assert data["strain_yy"] == pytest.approx((s_yy - nu * (s_xx + s_zz)) / young, abs=1e-9 * largest)
    assert np.abs(e_zz - (s_zz - nu * (s_xx + s_yy)) / young).max() < 1e-9 * largest
    assert data["stress_xy_Pa"] * (1 + nu) / young == pytest.approx(data["strain_xy"], abs=1e-9 * largest)


def test_strain_and_stress_can_be_left_out(program, coarse, tmp_path):
    keys = sets("output.snapshot_interval_s=50e-6", "output.snapshot_stress=false")
    require_done(program("run", coarse, "-o", "out", "-q", *keys))
    with h5py.File(tmp_path / "out/fields.vtkhdf") as file:
        assert "CellData" not in file["VTKHDF"]


def test_times_after_the_end_are_told(program, coarse, tmp_path):
    # Tractions below the strength under a still edge: the event ends at once.
    keys = sets(
        *("plate.corner=none", "loading.method=prestress", "prestress.t_Pa=1e6", "prestress.p_Pa=5e6"),
        *("event.kind=none", "time.end_s=1", "output.snapshot_times_s=[1e-5, 0.7, 0.9]"),
    )
    done = require_done(program("run", coarse, "-o", "out", *keys))
    assert "2 of 3 output.snapshot_times_s are after the end of the event" in done.stdout
    run = run_json(tmp_path / "out")
    assert run["snapshot_times_after_the_event_s"] == [0.7, 0.9]
    assert any("2 of 3 output.snapshot_times_s" in warning for warning in notes_of(run))


@pytest.mark.parametrize(
    ("table", "line", "says"),
    [
        ("x_m = [0.1, 0.3]\ny_m = [0.01, 0.0]", 1, "probes.x_m has 0.3 m; it must be in the plate"),
        ("x_m = [0.1]\ny_m = [-0.01]", 2, "probes.y_m has -0.01 m; it must be in the plate"),
        ("x_m = [0.1]\ny_m = [0.01, 0.0]", 1, "give both the same number of values"),
        ('x_m = [0.1]\ny_m = [0.0]\nnames = ["a", "b"]', 3, "has 2 names for 1 places"),
        ('x_m = [0, 0.1]\ny_m = [0.1, 0]\nnames = ["a", "a"]', 3, 'has the name "a" twice'),
        ("x_m = [0.1]\ny_m = [0.0]\nnames = [1]", 3, "must be a list of strings, is a list of numbers"),
        # Beyond a rounded corner.
        ("x_m = [1e-4]\ny_m = [1e-5]", 1, "the probe 1 at (0.0001, 1e-05) m lies outside the plate; move it"),
    ],
)
def test_wrong_probes_are_refused_with_their_line(program, write_case, tmp_path, table, line, says):
    text = COARSE + "\n[probes]\n"
    case = write_case(text + table + "\n")
    for command in (("run", case, "-o", "out"), ("validate", case)):
        printed = refusal(program(*command, "--set", "plate.corner=relief"))
        assert printed.startswith(f"{case}:{text.count(chr(10)) + line}: ") and says in printed
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("y_m, n_near", [("[0.01, 0.0]", 0), ("[0.004, 0.0]", 1), ("[0.004, 0.002]", 2)])
def test_probes_within_two_elements_of_the_interface_are_noted(program, probed, y_m, n_near):
    places = sets("plate.element_size_m=5e-3", f"probes.y_m={y_m}")
    printed = require_done(program("validate", probed, *places)).stdout
    note = f"note: probes: {n_near} of 2 are less than two elements, 0.01 m, from the interface"
    assert (note in printed) == (n_near > 0)
