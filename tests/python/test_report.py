# SPDX-License-Identifier: BSD-3-Clause
"""Pages of HTML: what they hold, what they refuse to replace, and what of the results they are drawn from."""

from __future__ import annotations

import base64
import re
import sys
from pathlib import Path

import common
import h5py
import numpy as np
import pytest
import slipfront
import xarray as xr
from package_cases import write_case
from refusals import change_json, flip, one_line
from report import KINDS
from report_pages import data_of, page_of
from slipfront import __main__ as package
from slipfront.opened import open_run
from slipfront.read import PROBE_FIELDS, Fields
from slipfront.report import history, picture_grid, run_data
from slipfront.report.command import main
from slipfront.report.numbers import listed, packed, unit
from slipfront.report.page import MARK, POLICY
from slipfront.report.study import STUDIES
from synthetic import write_checksums, write_output, write_run
from synthetic_study import write_interface_step, write_open_choices, write_study

PROBE_PARTS = {"probes-plot", "probes-change"}  # of the page of a run with probes alone
OTHER_PARTS = PROBE_PARTS | {
    "data",
    "run",
    "criteria-more",
    "fracture-plot",
    "forces-plot",
}  # that a page may lack
HOSTILE = '</script><script>alert(1)</script><b>"&\u202e'


@pytest.fixture
def run(tmp_path):
    write_run(tmp_path / "left", "left", 0.6, 20, 10, 30, 3)
    return tmp_path / "left"


def unpacked(field: dict) -> np.ndarray:
    shares = np.frombuffer(base64.b64decode(field["f2"]), "<f2").reshape(field["shape"])
    return field["largest"] * shares.astype(float)


def refusal(capsys, *arguments) -> str:
    """The one line on standard error of a call that is refused."""
    assert main([str(a) for a in arguments]) == 2
    out, error = capsys.readouterr()
    assert out == "" and error.count("\n") == 1
    return error


# The page of a run


def test_a_page_holds_the_record(run):
    data = data_of(page_of(run))["runs"][0]
    with h5py.File(run / "interface.h5") as file:
        rate, p, x, time = (file[name][()] for name in ("slip_rate_m_per_s", "p_Pa", "x_m", "time_s"))
    assert (data["units"]["x"], data["units"]["time"], data["units"]["traction"]) == ("mm", "µs", "MPa")
    np.testing.assert_allclose(data["history"]["x"], 1e3 * x, rtol=1e-4)
    np.testing.assert_allclose(data["history"]["time"], 1e6 * time, rtol=1e-4)
    np.testing.assert_allclose(unpacked(data["history"]["slip_rate"]), rate, rtol=1e-3, atol=1e-6)
    np.testing.assert_allclose(unpacked(data["history"]["p"]), 1e-6 * p, rtol=1e-3)
    assert data["static"]["coefficients"][0]["values"] == [1.3, 1.3]
    assert len(data["snapshots"]["frames"]) == data["snapshots"]["of"] == 3


def test_a_page_holds_the_fronts_in_full(run):
    fronts = data_of(page_of(run))["runs"][0]["fronts"]
    read = open_run(run).front_list
    assert [f["id"] for f in fronts] == [f.id for f in read] == [1]
    c_L = 1584.0
    v = np.array([np.nan if v is None else v for v in fronts[0]["v"]])
    far = read[0].x_m > 0.03  # beyond the trigger zone and its margin
    np.testing.assert_allclose(v[far], read[0].v_tip_m_per_s[far] / c_L, rtol=1e-4)
    assert np.isnan(v[read[0].x_m < 0.024]).all()
    assert fronts[0]["main"] and sum(fronts[0]["counts"]) > 10 and fronts[0]["symbol"] == "square-open"


def test_a_page_begins_with_the_outcome_and_folds_fronts_of_the_trigger(run):
    text = page_of(run)
    told = re.search(r'<p class="outcome">(.*?)</p>', text)[1]
    front = open_run(run).front_list[0]
    assert f"ran from x = {1e3 * front.x_m[0]:.4g} mm to {1e3 * front.x_m[-1]:.4g} mm, " in told
    assert re.search(r"at [0-9.]+ m/s \([0-9.]+ c<sub>L</sub>, [0-9.]+ c<sub>S</sub>\) in the median", told)
    assert "<details>" not in text
    table = (run / "fronts.csv").read_text()
    kinds = "|".join(f",{kind}" for kind in ("front", "simultaneous", "path_end"))
    (run / "fronts.csv").write_text(re.sub(rf"({kinds})$", ",triggered", table, flags=re.MULTILINE))
    write_checksums(run)
    text = page_of(run)
    assert "No front left the trigger" in text and "did not leave the trigger: 1</summary>" in text


def test_a_page_needs_no_network(run):
    text = page_of(run)
    assert text.startswith(MARK) and f'content="{POLICY}"' in text
    assert not re.search(r'(?:src|href)="(?!#|data:)', text)
    # The plots that the script looks for, and controls that it wires.
    script = "".join(f.read_text() for f in Path(history.__file__).parent.glob("page/*.js"))
    wanted = set(re.findall(r"byId\('([\w-]+)'\)", script)) - OTHER_PARTS
    assert wanted and all(f'id="{name}"' in text for name in wanted)


def test_facts_and_warnings_are_told(run, capsys):
    told = {"title": "my case", "status": "interrupted", "reason": "signal 15", "steps": 1234}
    rupture = {"strength_excess_S": {"min": 0.5, "median": 1.25, "max": 4}, "regime": "sub-Rayleigh"}
    rupture |= {"nucleation_length_m": 0.0125, "griffith_half_length_m": 0.02, "process_zone_m": None}
    change_json(
        run / "run.json",
        lambda i: i.update(told, notes=[{"kind": "physics", "text": "mind this"}], rupture=rupture),
    )
    text = page_of(run)
    for part in (
        "my case",
        "abc1234",
        "1,234 steps",
        "interrupted at t = 250 µs",
        "signal 15",
        "S 0.5 to 4, median 1.25; nucleation length 12.5 mm; critical crack length 40 mm; sub-Rayleigh",
        '<p class="warning">mind this</p>',
    ):
        assert part in text
    assert "note: " in capsys.readouterr().out


def test_text_of_the_case_is_escaped(run):
    told = dict.fromkeys(("title", "compiler", "reason"), HOSTILE) | {"notes": [HOSTILE]}
    change_json(run / "run.json", lambda info: info.update(told, status="failed"))
    odd = run.rename(run.parent / "<!--<script>")
    text = page_of(odd)
    assert "alert(1)" in text and "<script>alert" not in text and "<b>&quot;" not in text
    assert "\u202e" not in text  # it would turn what follows
    assert "&lt;!--&lt;script&gt;" in text and text.count("<!--") == 1


def test_a_run_without_snapshots_and_fronts_has_a_page(run):
    (run / "fields.vtkhdf").unlink()
    header = (run / "fronts.csv").read_text().splitlines()[0]
    (run / "fronts.csv").write_text(header + "\n")
    text = page_of(run)
    data = data_of(text)["runs"][0]
    assert data["snapshots"] is None and data["fronts"] == [] and data["origin"] is None
    assert "has no snapshots" in text and 'id="snapshots-plot"' not in text


def write_probes(folder: Path, n_times: int = 11, n_probes: int = 2) -> dict[str, np.ndarray]:
    """Records that grow over time; returns them by field."""
    time_s = np.linspace(0, 250e-6, n_times)
    sizes = {"u": 1e-6, "v": 2.0, "strain": 1e-5, "stress": 1e5}
    fields = {}
    with h5py.File(folder / "probes.h5", "w") as file:
        file["name"] = [f"SG{k}" for k in range(n_probes)]
        file["x_m"], file["y_m"], file["time_s"] = 0.05 * np.arange(n_probes), np.full(n_probes, 5e-3), time_s
        for place, name in enumerate(PROBE_FIELDS):
            grow = 1 + np.linspace(0, 1, n_times)[:, None] * (1 + np.arange(n_probes))
            fields[name] = file[name] = (1 + place) * sizes[name.split("_")[0]] * grow
    return fields


def test_probes_are_shown_where_there_are_any(run):
    text = page_of(run)
    assert "probes" not in data_of(text)["runs"][0]
    assert not any(f'id="{part}"' in text for part in PROBE_PARTS)
    fields = write_probes(run)
    text = page_of(run)
    data = data_of(text)["runs"][0]["probes"]
    assert all(f'id="{part}"' in text for part in PROBE_PARTS)
    assert data["names"] == ["SG0", "SG1"] and data["x"] == [0, 50] and data["y"] == [5, 5]
    np.testing.assert_allclose(data["time"], np.linspace(0, 250, 11), rtol=1e-4)
    choices = {choice["name"]: choice for choice in data["choices"]}
    for choice, factor, unit_told, names in (
        ("velocity", 1, "m/s", ("v_x_m_per_s", "v_y_m_per_s")),
        ("strain", 1e6, "10⁻⁶", ("strain_xx", "strain_yy", "strain_xy")),
        ("stress", 1e-6, "MPa", ("stress_xx_Pa", "stress_yy_Pa", "stress_xy_Pa")),
    ):
        assert choices[choice]["unit"] == unit_told
        for part, name in zip(choices[choice]["parts"], names, strict=True):
            np.testing.assert_allclose(unpacked(part["values"]), factor * fields[name], rtol=1e-3)


def test_what_is_thinned_is_told(tmp_path):
    write_run(tmp_path / "left", "left", 0.6, 20, 10, 900, 1)
    write_probes(tmp_path / "left", 2500, 30)
    text = page_of(tmp_path / "left")
    data = data_of(text)["runs"][0]
    assert "one in 3 of 900 times" in text and data["history"]["p"]["shape"] == [300, 21]
    assert data["probes"]["choices"][0]["parts"][0]["values"]["shape"] == [834, 24]
    assert "the first 24 of 30 probes and one in 3 of 2500 times" in text


def test_probes_that_are_not_finite_are_refused(run, capsys):
    write_probes(run)
    with h5py.File(run / "probes.h5", "r+") as file:
        file["strain_xx"][3, 1] = np.nan
    assert "probes.h5: a value of strain_xx is not finite" in refusal(capsys, run)
    change_json(run / "run.json", lambda info: info.update(status="blew_up"))
    assert len(data_of(page_of(run))["runs"][0]["probes"]["time"]) == 3


# Fronts as cracks

CRACK = """\
title = "crack"
[plate]
width_m = 0.2
height_m = 0.1
element_size_m = 4e-3
[base]
kind = "rigid"
[loading]
method = "prestress"
[prestress]
p_Pa = 5e6
t_Pa = 3.8e6
[friction]
law = "slip_weakening"
mu_s = 1.0
mu_k = 0.6
d_c_m = 8e-6
[event]
kind = "nucleation"
[nucleation]
x_m = 0.1
half_length_m = 0.02
taper_m = 0.02
[time]
end_s = 110e-6
"""


@pytest.fixture
def crack(tmp_path):
    """A run whose breakdown comes to its end at some nodes and at others does not."""
    slipfront.run(write_case(tmp_path, CRACK), output=tmp_path / "crack")
    return tmp_path / "crack"


def test_a_page_holds_fracture_energy_and_what_is_predicted(crack):
    run = slipfront.open(crack)
    points = run.fracture.to_dataframe()
    points.loc[points.breakdown_complete != 1, ["breakdown_work_J_per_m2", "G_slip_J_per_m2"]] = np.nan
    text = page_of(crack)
    data = data_of(text)["runs"][0]
    for front in data["fronts"]:
        own = points[points.front_id == front["id"]]
        for name, column in (("gamma", "breakdown_work_J_per_m2"), ("g_slip", "G_slip_J_per_m2")):
            np.testing.assert_allclose(np.array(front[name], float), own[column], rtol=1e-4)
        assert 0 < own.breakdown_work_J_per_m2.count() < len(own) and own.G_slip_J_per_m2.any()
        medians = (own[name].median() for name in ("breakdown_work_J_per_m2", "G_slip_J_per_m2"))
        assert "".join(f"<td>{value:.3g}</td>" for value in medians) in text
    predicted = slipfront.predict_fronts(run)
    told = {name: np.array(v, float) for name, v in data["fracture"]["prediction"].items()}
    at = np.isfinite(told["x"])
    assert np.count_nonzero(~at) == 1  # between the directions
    c_L = run.info["wave_speeds"]["c_L_m_per_s"]
    np.testing.assert_allclose(told["x"][at], 1e3 * predicted.x_m, rtol=1e-4)
    np.testing.assert_allclose(told["at_rest"][at], predicted.G_static_J_per_m2, rtol=1e-4)
    np.testing.assert_allclose(told["v"][at], predicted.v_tip_m_per_s / c_L, rtol=1e-4)


def test_a_page_draws_no_cross_where_no_arrest_is_foretold(crack, monkeypatch):
    predict = slipfront.predict_fronts
    for doubts in ([], ["S = 1"]):

        def predicted(run, doubts=doubts):
            found = predict(run)
            found.attrs |= {"arrests": [1], "doubts_of_arrest": doubts}
            return found

        monkeypatch.setattr(slipfront, "predict_fronts", predicted)
        text = page_of(crack)
        arrests = data_of(text)["runs"][0]["fracture"]["prediction"]["arrests"]
        assert (len(arrests), "; arrest at x = " in text) == ((0, False) if doubts else (1, True))


def test_a_page_says_why_nothing_is_predicted(crack):
    (crack / "checksums.sha256").unlink()
    case = crack / "case.resolved.toml"
    case.write_text(case.read_text().replace("slip_weakening", "not_a_law"))
    text = page_of(crack)
    assert data_of(text)["runs"][0]["fracture"]["prediction"] is None
    assert "No prediction: " in text and "not_a_law" in text


def test_a_page_of_a_run_that_blew_up_leaves_out_what_is_no_number(crack):
    (crack / "checksums.sha256").unlink()
    file = crack / "fracture.csv"
    lines = file.read_text().splitlines()
    at = lines[0].split(",").index("breakdown_work_J_per_m2")
    done = next(k for k, line in enumerate(lines[1:]) if line.split(",")[at + 6] == "1")
    cells = lines[1 + done].split(",")
    cells[at] = "inf"
    file.write_text("\n".join([*lines[: 1 + done], ",".join(cells), *lines[2 + done :]]) + "\n")
    change_json(crack / "run.json", lambda info: info.update(status="blew_up"))
    text = page_of(crack)
    fronts = data_of(text)["runs"][0]["fronts"]
    gamma = [value for front in sorted(fronts, key=lambda f: f["id"]) for value in front["gamma"]]
    assert gamma[done] is None and sum(value is not None for value in gamma) > 10
    assert "No prediction: " in text


def test_a_page_without_breakdown_or_of_an_older_run(crack, capsys):
    (crack / "checksums.sha256").unlink()
    file = crack / "fracture.csv"
    head, *rows = file.read_text().splitlines()
    at = head.split(",").index("breakdown_complete")
    none = [",".join("0" if k == at else cell for k, cell in enumerate(row.split(","))) for row in rows]
    file.write_text("\n".join([head, *none]) + "\n")
    assert "The breakdown of no front that is drawn came to its end." in page_of(crack)
    capsys.readouterr()
    file.write_text("\n".join([head, *rows[1:]]) + "\n")
    assert "its rows are not those of fronts.csv" in refusal(capsys, crack)
    file.unlink()
    text = page_of(crack)
    assert "Γ" not in text and 'href="#fracture"' not in text


# What is refused, and what is replaced


def test_a_page_is_replaced_and_nothing_else(run, tmp_path, capsys):
    file = tmp_path / "page.html"
    page_of(run, file)
    page_of(run, file)
    file.write_text("<!DOCTYPE html>mine")
    capsys.readouterr()
    assert "not a report: not replaced" in refusal(capsys, run, "-o", file)
    assert file.read_text() == "<!DOCTYPE html>mine"
    link = tmp_path / "link.html"
    link.symlink_to(file)
    assert "not a regular file" in refusal(capsys, run, "-o", link)
    assert "cannot be written" in refusal(capsys, run, "-o", file / "page.html")


def test_what_holds_no_results_is_refused(tmp_path, capsys):
    assert "no such folder" in refusal(capsys, tmp_path / "none")
    assert "holds no results" in refusal(capsys, tmp_path)


@pytest.mark.parametrize("name", ["interface.h5", "fronts.csv", "energy.csv", "static.csv", "fields.vtkhdf"])
def test_a_damaged_folder_is_refused(run, capsys, name):
    write_checksums(run)
    flip(run / name)
    assert f"{run / name}: does not match checksums.sha256" in refusal(capsys, run)
    assert not (run / "report.html").exists()


def test_a_folder_without_checksums_is_told(run, capsys):
    for is_listed in (False, True):
        if is_listed:
            write_checksums(run)
        page_of(run)
        assert ("has no checksums.sha256" in capsys.readouterr().out) != is_listed


def test_wrong_shapes_are_refused(run, capsys):
    with h5py.File(run / "interface.h5", "r+") as file:
        slip = file["slip_m"][:, 1:]
        del file["slip_m"]
        file["slip_m"] = slip
    assert "slip_m is (30, 20), not (30, 21)" in refusal(capsys, run)


# Other kinds of folders


def test_the_page_of_a_reproduction(tmp_path):
    write_output(tmp_path / "out", columns=20, rows=10, n_times=8, snapshots=2)
    text = page_of(tmp_path / "out", kinds=KINDS)
    data = data_of(text)
    names = ["left-triggered", "spontaneous", "right-triggered", "spontaneous, μ_k = 1.0"]
    assert [run["name"] for run in data["runs"]] == names
    assert {name: data["fits"][0][name] for name in "abc"} == {"a": 0.76, "b": 1.8, "c": 3.05}
    assert "Of 3 statements 1 hold (✓)" in text and "c_L &lt; 1600 m/s &amp; more" in text
    assert text.count("<img ") == 13 and 'id="run"' in text


@pytest.mark.parametrize(
    "write, says, n_tables",
    [
        (write_study, "no limit", 2),
        (write_interface_step, "No choice is within the tolerance of 1 %", 1),
        (write_open_choices, "left_added = 5.0", 2),
    ],
)
def test_the_pages_of_studies(tmp_path, write, says, n_tables):
    folder = write(tmp_path / "study")
    text = page_of(folder, kinds=(*STUDIES, *KINDS))
    assert says in text and text.count("<img ") == 1 and text.count("<table") == n_tables
    assert "<script" not in text


def test_a_study_with_other_entries_is_refused(tmp_path, capsys):
    folder = write_study(tmp_path / "study")
    (folder / "convergence.json").write_text('{"sequences": 1, "tolerance": 0.1}')
    assert "convergence.json: not" in refusal(capsys, folder)


# What a page is drawn from


def test_thinning_keeps_the_fastest_of_each_block():
    values = np.zeros((7, 5))
    values[0, 1], values[1, 0], values[3, 4], values[6, 2] = 2, -3, 5, -1
    thin = history.largest_of_blocks(values, 2, 2)
    expected = np.zeros((4, 3))
    expected[0, 0], expected[1, 2], expected[3, 1] = -3, 5, -1
    np.testing.assert_array_equal(thin, expected)


@pytest.mark.parametrize("at_once", [1, 10, 2**22])
def test_thinning_does_not_depend_on_the_rows_read_at_once(monkeypatch, at_once):
    monkeypatch.setattr(history, "ROWS_AT_ONCE", at_once)
    rng = np.random.default_rng(1)
    fields = {name: rng.normal(size=(23, 11)) for name in history.HISTORY_FIELDS}
    time_s, x_m = np.arange(23.0), np.arange(11.0)
    variables = {name: (("time_s", "x_m"), values) for name, values in fields.items()}
    thin = history.thinned(xr.Dataset(variables, {"time_s": time_s, "x_m": x_m}), (8, 4))
    assert (thin.times_in_block, thin.nodes_in_block) == (3, 3)
    np.testing.assert_array_equal(thin.time_s, [1, 4, 7, 10, 13, 16, 19, 21])
    np.testing.assert_array_equal(thin.x_m, [1, 4, 7, 9])
    np.testing.assert_array_equal(thin.t_Pa, fields["t_Pa"][np.ix_(thin.time_s.astype(int), [1, 4, 7, 9])])
    expected = history.largest_of_blocks(fields["slip_rate_m_per_s"], 3, 3)
    np.testing.assert_array_equal(thin.slip_rate_m_per_s, expected)


def grid_of(points: np.ndarray, cells: list) -> picture_grid.PixelGrid:
    return picture_grid.pixel_grid(
        Fields(Path("none"), np.array(points, float), np.array(cells), np.zeros(1))
    )


def test_a_linear_field_is_itself_in_every_pixel():
    """Cells of different sizes: one of 2 x 1, two of 1 x 0.5 above each half of it."""
    points = [(0, 0), (2, 0), (2, 1), (0, 1), (1, 1), (1, 1.5), (0, 1.5), (2, 1.5)]
    grid = grid_of(points, [[0, 1, 2, 3], [3, 4, 5, 6], [4, 2, 7, 5]])
    x, y = np.array(points).T
    expected = grid.x_m[None, :] + 3 * grid.y_m[:, None]
    side = grid.x_m[1] - grid.x_m[0]
    assert (grid.n_points > 0).all()
    np.testing.assert_allclose(grid.means(x + 3 * y), expected, atol=4 * side)


def test_two_bodies_do_not_mix_in_a_pixel():
    points = [(0, 0), (3, 0), (3, 1), (0, 1), (0, -1), (3, -1), (3, 0), (0, 0)]
    grid = grid_of(points, [[0, 1, 2, 3], [4, 5, 6, 7]])
    picture = grid.means(np.array([1.0, 1, 1, 1, 2, 2, 2, 2]))
    np.testing.assert_allclose(picture, np.where(grid.y_m[:, None] > 0, 1.0, 2.0) + 0 * grid.x_m)


def test_pixels_without_material_are_empty():
    points = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (3, 0), (3, 1), (2, 1)]
    grid = grid_of(points, [[0, 1, 2, 3], [4, 5, 6, 7]])
    codes = picture_grid.codes(grid.means(np.ones(8)), 4.0)
    gap = (grid.x_m > 1) & (grid.x_m < 2)
    assert (codes[:, gap] == picture_grid.EMPTY).all()
    assert (codes[:, ~gap] == picture_grid.WHITE // 2).all()  # the root of a quarter


def test_what_the_terms_give_adds_up_to_the_imbalance(run):
    balance = open_run(run).balance
    total = sum(run_data.given_to_the_rest(balance).values())
    stored = balance.terms["strain"] + balance.terms["kinetic"]
    works = sum(v for term, v in balance.terms.items() if term not in ("strain", "kinetic"))
    np.testing.assert_allclose(total, works - stored, atol=1e-12)
    assert total[-1] == pytest.approx(-(stored - works)[-1]) and abs(stored[-1]) > 1


def test_numbers_are_short_and_units_suit_them():
    assert listed([1 / 3, np.nan, np.inf, 0]) == [0.33333, None, None, 0.0]
    values = np.array([[1e-3, -2.5], [0.0, 7.0]])
    np.testing.assert_allclose(unpacked(packed(values)), values, rtol=1e-3)
    assert unit("length", [0.2]).name == "mm" and unit("length", [30e3]).name == "km"
    assert unit("time", [160e-6]).name == "µs" and unit("time", [12.0]).name == "s"
    assert unit("traction", [5e6]).name == "MPa" and unit("slip", []).name == "µm"


# The package's commands


def test_a_command_is_found_by_its_name(run, capsys):
    assert package.main(["report", str(run)]) == 0
    assert "report: " in capsys.readouterr().out


@pytest.mark.parametrize("arguments, told", [([], "usage"), (["frobnicate"], "frobnicate"), (["-x"], "-x")])
def test_an_unknown_command_is_refused(capsys, arguments, told):
    assert package.main(arguments) == 2
    error = one_line(capsys)
    assert told in error and "report" in error


def test_a_missing_package_is_named(run):
    without = "import sys; sys.modules['plotly'] = None; from slipfront.__main__ import main; "
    script = without + "sys.exit(main(['report', 'x']))"
    line = common.refusal(common.call(sys.executable, "-c", script, env=common.WITH_PACKAGE))
    assert f"report: needs the Python package plotly: install it with '{sys.executable} -m pip" in line
