# SPDX-License-Identifier: BSD-3-Clause
"""What reports and the package say of loads, stress and set-up of real runs, by the loading method."""

from __future__ import annotations

import base64
import math
import re

import numpy as np
import pytest
import slipfront
from common import require_done, run_json
from package_cases import CASE, TILT, program, results_of, write_case
from report_pages import data_of, page_of
from slipfront.opened import OpenRun, open_run
from slipfront.report import setup
from slipfront.report.run_data import wave_speeds
from slipfront.report.sketch import sketch
from slipfront.units import attributes, engineering, name_of, quantity

T_PA, P_PA = 2.4e6, 4e6
PAIR = """\
title = "polycarbonate on Homalite"
plate = {width_m = 0.15, height_m = 0.06, element_size_m = 3e-3, corner = "none"}
loading.method = "prestress"
prestress = {t_Pa = 2.4e6, p_Pa = 4e6}
event = {kind = "left", trigger_zone_m = 30e-3, trigger_over_missing = 2, trigger_ramp_s = 2e-6}
time.end_s = 100e-6
output.snapshot_times_s = [0.0, 50e-6]
probes = {x_m = [0.075, 0.0765], y_m = [0.0, -0.0015], names = ["interface", "base"]}
[material]
youngs_modulus_Pa = 2.4e9
poissons_ratio = 0.38
density_kg_per_m3 = 1200
stiffness_damping_s = 0
[base]
kind = "body"
height_m = 0.03
youngs_modulus_Pa = 4e9
poissons_ratio = 0.35
density_kg_per_m3 = 1230
stiffness_damping_s = 1e-8
bottom = "absorbing"
[friction]
law = "slip_weakening"
mu_s = 0.7
mu_k = 0.45
d_c_m = 10e-6
regularisation = "pressure"
relaxation_time_s = 2e-6
"""
TABLE = "x_m,t_Pa,p_Pa\n0,2.0e6,4e6\n0.15,2.4e6,5e6\n"


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    return results_of(tmp_path_factory.mktemp("pair"), PAIR)


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    place = tmp_path_factory.mktemp("table")
    (place / "loads.csv").write_text(TABLE)
    return results_of(place, PAIR.replace("{t_Pa = 2.4e6, p_Pa = 4e6}", '{file = "loads.csv"}'))


@pytest.fixture(scope="module")
def tilted(tmp_path_factory):
    return results_of(tmp_path_factory.mktemp("tilted"), CASE + "probes = {x_m = [0.1], y_m = [0.0]}\n")


def shown(folder):
    """The page of a run, beside its folder, and its data."""
    text = page_of(folder, folder.parent / "report.html")
    return re.sub(r"<script[\s\S]*?</script>", "", text), data_of(text)


def parts_of(data, name):
    (choice,) = (c for c in data["runs"][0]["probes"]["choices"] if c["name"] == name)
    return {part["label"]: part for part in choice["parts"]}


def first_row(part):
    packed = part["values"]
    return packed["largest"] * np.frombuffer(base64.b64decode(packed["f2"]), "<f2")[: packed["shape"][1]]


# Stress


def with_case(run: OpenRun, case: dict) -> OpenRun:
    """The run as it would be with another case."""
    other = OpenRun(run.place)
    other.__dict__["_case"] = case
    return other


def test_the_prestress_is_told_and_added(pair):
    told = {"recorded": True, "stress_xx_Pa": None, "stress_yy_Pa": -P_PA, "stress_xy_Pa": T_PA}
    assert run_json(pair)["prestress"] == told
    run = slipfront.open(pair)
    probes, whole = run.probes, run.absolute_stress(run.probes)
    assert (probes.stress_yy_Pa[0] == -P_PA).all() and (probes.stress_xy_Pa[0] == T_PA).all()
    assert (probes.stress_xx_Pa[0] == 0).all()
    # Hooke's law of plane stress, of the plate and of the base.
    E, nu = np.array([2.4e9, 4e9]), np.array([0.38, 0.35])
    for name, strain in (("xx", nu * P_PA / E), ("yy", -P_PA / E), ("xy", (1 + nu) * T_PA / E)):
        np.testing.assert_allclose(probes[f"strain_{name}"][0], strain, rtol=1e-12)
    np.testing.assert_array_equal(whole.stress_xy_Pa, probes.stress_xy_Pa)
    np.testing.assert_array_equal(whole.stress_yy_Pa, probes.stress_yy_Pa)
    assert np.isnan(whole.stress_xx_Pa).all() and (whole.stress_zz_Pa == 0).all()  # plane stress
    assert probes.u_x_m.attrs["long_name"].endswith("change since the start")
    assert "change" not in probes.stress_yy_Pa.attrs["long_name"]
    assert whole.stress_yy_Pa.attrs["long_name"].endswith("absolute")
    cells = run.snapshots
    assert cells.stress_yy_Pa.sizes == {"time_s": 2, "cell": 50 * 30}
    assert (cells.stress_yy_Pa[0] == -P_PA).all() and (cells.stress_xy_Pa[0] == T_PA).all()
    assert set(np.unique(cells.strain_yy[0])) == set(probes.strain_yy[0].values)
    np.testing.assert_array_equal(run.absolute_stress(cells).stress_yy_Pa, cells.stress_yy_Pa)
    with pytest.raises(slipfront.DataError, match="no stress"):
        run.absolute_stress(run.history)


def test_to_changes_of_older_files_the_state_before_is_added(pair, monkeypatch):
    run = slipfront.open(pair)
    monkeypatch.setattr(OpenRun, "records_prestress", False)
    probes, whole = run.probes, run.absolute_stress(run.probes)
    np.testing.assert_array_equal(whole.stress_yy_Pa, probes.stress_yy_Pa - P_PA)
    assert probes.stress_yy_Pa.attrs["long_name"].endswith("change since the start")


def test_the_absolute_stress_at_the_interface_is_its_tractions(pair):
    """Behind the front, where both are smooth: the change alone is far off. A cell's stress belongs to its
    centre in y, half an element of 3 mm away: 15 % of p."""
    run = slipfront.open(pair)
    whole = run.absolute_stress(run.probes).sel(probe="interface")
    history = run.history.sel(x_m=0.075).interp(time_s=whole.time_s)
    late = whole.time_s > 85e-6
    assert late.sum() > 10
    for stress, traction, sign in (("stress_yy_Pa", "p_Pa", -1), ("stress_xy_Pa", "t_Pa", 1)):
        np.testing.assert_allclose(whole[stress][late], sign * history[traction][late], atol=0.15 * P_PA)
        recorded = run.probes[stress].sel(probe="interface")
        assert (abs(recorded[late] - recorded[0] - sign * history[traction][late]) > 0.3 * P_PA).all()


def test_tractions_that_vary_leave_the_change_alone(table):
    assert set(run_json(table)["prestress"].values()) == {False, None}
    run = slipfront.open(table)
    whole = run.absolute_stress(run.probes)
    assert all(np.isnan(whole[name]).all() for name in ("stress_xx_Pa", "stress_yy_Pa", "stress_xy_Pa"))
    text, data = shown(table)
    assert all(part["before"] is None for part in parts_of(data, "stress").values())
    assert data["runs"][0]["probes"]["are_changes"] and 'id="probes-change"' not in text
    assert "vary along the interface leave the state in the bulk unknown" in text


def test_statics_record_the_whole_stress(tilted):
    assert "prestress" not in run_json(tilted)
    run = slipfront.open(tilted)
    whole = run.absolute_stress(run.probes)
    for name in whole:
        np.testing.assert_array_equal(whole[name], run.probes[name])
    assert "change" not in run.probes.stress_yy_Pa.attrs["long_name"]
    _, data = shown(tilted)
    assert not data["runs"][0]["probes"]["are_changes"]
    assert {part["before"] for part in parts_of(data, "stress").values()} == {0}


def test_the_report_has_the_change_and_what_is_added(pair):
    text, data = shown(pair)
    parts = parts_of(data, "stress")
    before = {label: part["before"] for label, part in parts.items()}
    assert before == {"σ<sub>xx</sub>": None, "σ<sub>yy</sub>": -4, "σ<sub>xy</sub>": 2.4}  # MPa
    assert all((first_row(part) == 0).all() for part in parts.values())
    assert all(part["before"] is None for part in parts_of(data, "strain").values())
    assert data["runs"][0]["probes"]["are_changes"] and 'id="probes-change"' in text
    assert "= −p = -4 MPa" in text and "the sum of the state before" not in text


# Set-up


def rows(folder):
    return dict(setup.rows(open_run(folder)))


def test_the_set_up_is_told_in_words_and_engineering_units(pair):
    told = rows(pair)
    for name, part in (
        (
            "Plate",
            "150 mm × 60 mm, plane stress; E = 2.4 GPa, ν = 0.38, ρ = 1200 kg/m³, no damping; upper edge",
        ),
        ("Base", "150 mm × 30 mm; E = 4 GPa, ν = 0.35, ρ = 1230 kg/m³, stiffness damping 10 ns"),
        ("Base", "lower edge absorbing, sides free"),
        ("Loads", "pressure p = 4 MPa, shear t = 2.4 MPa, prescribed, uniform"),
        ("Friction", "linearly with slip: μ<sub>s</sub> = 0.7, μ<sub>k</sub> = 0.45, d<sub>c</sub> = 10 µm"),
        ("Friction", "delay, t* = 2 µs"),
        ("Start", "trigger over 30 mm at the left edge: shear added, 2 times what is missing"),
        ("Start", "rising over 2 µs"),
    ):
        assert part in told[name]


def test_loads_of_other_methods_are_told(table, tilted):
    told = rows(table)["Loads"]
    assert told == "pressure p 4 MPa to 5 MPa, shear t 2 MPa to 2.4 MPa along x, prescribed by a table"
    told = rows(tilted)
    assert told["Loads"].startswith(
        "upper edge pressed down 370 µm at its left end, 37 µm at its right, then moved"
    )
    assert told["Base"] == "rigid plane" and told["Friction"].startswith("weakens with the slip rate")


def test_forces_are_told_with_their_displacements(tmp_path):
    loading = "[loading]\nmean_pressure_Pa = 5e6\nshear_over_critical = 0.8\n"
    results_of(tmp_path, CASE.replace(TILT, "") + "time.end_s = 1e-5\n" + loading)
    told = rows(tmp_path / "out")["Loads"]
    pattern = (
        r"normal force 1 MN/m, a mean pressure of 5 MPa; shear force [0-9.]+ kN/m, 0\.8 of the critical one; "
        r"upper edge pressed down [0-9.]+ µm, then moved by [0-9.]+ µm to \+x; pressure p "
    )
    assert re.match(pattern, told), told
    found = slipfront.info(tmp_path / "case.toml").loads
    of_run = run_json(tmp_path / "out")["statics"]["loads"]
    assert {name: getattr(found, name) for name in of_run} == of_run
    assert "mean_pressure_Pa" in repr(slipfront.info(tmp_path / "case.toml"))
    assert slipfront.info(CASE).loads is None


@pytest.mark.parametrize(
    ("name", "keys", "says"),
    [
        ("loading", {"shear_stiffness_Pa_per_m": 1e9}, "; machine of stiffness 1 GPa/m along x"),
        ("loading", {"normal_stiffness_Pa_per_m": 2e9}, "; stiffness 2 GPa/m downwards"),
        ("loading", {"normal_stiffness_Pa_per_m": 0.0}, "; dead load"),
        ("loading", {"shear_stiffness_Pa_per_m": math.inf}, ""),
        (
            "sequence",
            {"times_s": [2, 10], "shears_m": [1e-6, 1e-6]},
            "; loaded along a path of 2 points to 1 µm at 10 s",
        ),
    ],
)
def test_the_machine_and_the_path_are_told(pair, name, keys, says):
    run = open_run(pair)
    case = run.case | {name: run.case.get(name, {}) | keys}
    assert setup.loads(with_case(run, case)) == setup.loads(run) + says


def test_info_tells_the_machine_and_the_path(tmp_path):
    loading = "loading = {shear_stiffness_Pa_per_m = 1e9, normal_stiffness_Pa_per_m = 0.0}\n"
    path = "sequence = {max_events = 2, times_s = [2, 10], shears_m = [1e-6, 1e-6]}\n"
    case = write_case(tmp_path, "base.kind = 'rigid'\nplate.element_size_m = 5e-3\n" + loading + path)
    printed = require_done(program("info", case, cwd=tmp_path)).stdout
    assert re.search(r"machine along x +1e\+09 Pa/m\n", printed), printed
    assert re.search(r"machine downwards +dead load\n", printed), printed
    assert re.search(r"path of the loading +2 points, to 1e-06 m at 10 s\n", printed), printed


def test_the_critical_crack_is_that_of_info(pair):
    lines = program("info", pair / "case.resolved.toml", cwd=pair).stdout
    whole_m = float(re.search(r"critical crack length\s+([\d.]+) m ", lines)[1])
    assert f"critical crack length {1e3 * whole_m:.3g} mm" in rows(pair)["Expected before the event"]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"kind": "spontaneous"}, "spontaneous: the shear just exceeds the critical one"),
        ({"trigger_form": "weakened"}, "30 mm at the left edge: μ = μ<sub>k</sub> from the start"),
        ({"trigger_form": "raised", "trigger_over_strength": 1.2}, "shear raised to 1.2 μ<sub>s</sub>p"),
        ({"kind": "nucleation"}, "patch around x = 75 mm, 7.5 mm to each side and a taper of 3.75 mm"),
    ],
)
def test_starts_are_told(pair, changes, says):
    run = open_run(pair)
    nucleation = {"form": "weakened", "x_m": 0.075, "half_length_m": 7.5e-3, "taper_m": 3.75e-3}
    case = run.case | {"event": run.case["event"] | changes, "nucleation": nucleation}
    assert says in setup.start(with_case(run, case))


def test_the_sketch_is_to_scale(pair):
    text, _ = shown(pair)
    svg = re.search(r"<svg[\s\S]*?</svg>", text)[0]
    (w, h), (base_w, base_h) = (
        map(float, size) for size in re.findall(r'<rect [^>]*width="([\d.]+)" height="([\d.]+)"', svg)
    )
    assert w / h == pytest.approx(150 / 60, rel=1e-2)
    assert base_w == w and h / base_h == pytest.approx(2, rel=1e-2)
    assert svg.count("<circle") == 2 and "p = 4 MPa" in svg and ">base</text>" in svg


def test_the_sketch_shows_where_it_is_sheared(tilted):
    """By the top edge, or by the pusher at its heights and nothing else."""
    run = open_run(tilted)
    heights = {"pusher_from_m": 20e-3, "pusher_to_m": 60e-3}
    pushed = with_case(run, run.case | {"loading": run.case["loading"] | heights})
    rectangle = r'<rect x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"'
    (plate, _), (same, _, block) = (
        [[float(number) for number in found] for found in re.findall(rectangle, sketch(of))]
        for of in (run, pushed)
    )
    x, y, _, height = plate
    assert same == plate and block[0] + block[2] == x
    bottom, top = (y + height - 1e3 * at / 100 * height for at in heights.values())
    assert [block[1], block[1] + block[3]] == pytest.approx([top, bottom], abs=0.2)
    assert ">t</text>" in sketch(run) and ">t</text>" not in sketch(pushed)
    of_both = [sketch(of).count("marker-end") for of in (run, pushed)]
    assert of_both[0] == of_both[1]  # in place of that at the top


# Panels


def test_waves_of_both_bodies_and_of_the_pair_are_drawn(pair, tilted):
    info = run_json(pair)
    speeds = wave_speeds(open_run(pair))
    assert list(speeds) == ["c_L", "c_S", "c_R", "c_GR", "c_L of the base", "c_S of the base"]
    assert speeds["c_GR"] == info["base"]["generalised_rayleigh_speed_m_per_s"]
    assert speeds["c_L of the base"] == info["base"]["wave_speeds"]["c_L_m_per_s"]
    assert list(wave_speeds(open_run(tilted))) == ["c_L", "c_S", "c_R"]


def test_what_does_not_vary_is_no_panel(pair, tilted):
    """Uniform tractions: one static ratio, and the criteria are folded."""
    _, data = shown(pair)
    assert data["folded"] and "static" not in data["panels"] and data["panels"][0] == "x"
    _, data = shown(tilted)
    assert not data["folded"] and data["panels"] == ["x", "static", "dynamic", "rise"]


def test_constant_fields_are_sentences(tmp_path):
    """Nothing starts: the slip rate, the slip, p and t/p are the same everywhere."""
    keys = ("event.kind=none", "time.end_s=1e-5", "output.snapshot_times_s=[50e-6]")
    text, data = shown(results_of(tmp_path, PAIR, *keys))
    assert data["fields"] == [] and data["panels"] == [] and 'id="space-time-plot"' not in text
    assert "The pressure p is 4 MPa everywhere and at all times." in text
    assert "t/p is 0.6 everywhere and at all times." in text
    assert "No front has a speed to be drawn." in text and "Nothing moves in any snapshot." not in text


# Names and units


def test_every_data_set_has_the_attributes_of_cf(pair):
    run = slipfront.open(pair)
    for data in (run.history, run.tractions, run.fronts, run.energies, run.snapshots, run.probes):
        for name, variable in data.variables.items():
            assert variable.attrs.keys() >= {"units", "long_name"}, name
            assert "unit" not in variable.attrs and "description" not in variable.attrs
    name = "velocity of the plate along x relative to its base"
    assert run.history.slip_rate_m_per_s.attrs == {"units": "m/s", "long_name": name}


@pytest.mark.parametrize(
    ("value", "unit", "told"),
    [
        (2.4e9, "Pa", "2.4 GPa"),
        (0.15, "m", "150 mm"),
        (1.5, "m", "1.5 m"),
        (0.9999999, "m", "1 m"),
        (4e-6, "m", "4 µm"),
        (0.0, "Pa", "0 Pa"),
        (-4e6, "Pa", "-4 MPa"),
        (3e-12, "s", "0.003 ns"),
        (1200.0, "kg/m3", "1200 kg/m³"),
        (0.38, "1", "0.38"),
    ],
)
def test_quantities_are_in_engineering_units(value, unit, told):
    assert quantity(value, unit) == told


def test_keys_become_names_and_units():
    names = ("friction.d_c_m", "prestress.t_Pa", "friction.mu_k", "plate.element_size_m", "event.kind")
    assert [name_of(name) for name in names] == ["d_c", "t", "mu_k", "element size", "kind"]
    assert engineering("m", [1e-6, 9e-6]).name == "µm"
    assert attributes("t_s_Pa") == {"units": "Pa", "long_name": "tangential traction before the event"}
