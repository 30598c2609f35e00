# SPDX-License-Identifier: BSD-3-Clause
"""The figures show what the files say, for a made-up output folder with known contents."""

from __future__ import annotations

import csv
import json
import re
import shutil
from dataclasses import replace as replace_fields

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from slipfront.figures import balance, criteria, events, plate, space_time, studies
from slipfront.figures.__main__ import draw_all, main
from slipfront.figures.main_fronts import drawn_fronts, main_fronts
from slipfront.figures.results import read_results
from slipfront.figures.statements import STATEMENTS
from slipfront.figures.study import Study, StudyPoint
from slipfront.figures.style import DIRECTION_COLOURS, EVENT_STYLES, RC
from synthetic import (
    CONTACT_FROM_M,
    CONTACT_TO_M,
    ENERGY_HEADER,
    FRONTS_HEADER,
    MU_S,
    WAVE_SPEEDS,
    energy_rows,
    write_csv,
    write_fields,
    write_output,
)

C_L = WAVE_SPEEDS["c_L_m_per_s"]
FIGURES = [
    "fig1_setup",
    "fig2_static_ratio_mu_k_1.0",
    "fig3_three_events",
    "fig4_dynamic_ratio",
    "fig5_dynamic_criterion",
    "fig6_energy",
    "space_time_left",
    "space_time_spontaneous",
    "space_time_right",
    "space_time_spontaneous_mu_k_1.0",
    "energy_balance",
    "studies",
    "studies_criteria",
]


@pytest.fixture(scope="session")
def pristine(tmp_path_factory):
    """An output folder that no test may change."""
    return write_output(tmp_path_factory.mktemp("reproduction") / "out")


@pytest.fixture(scope="session")
def results(pristine):
    return read_results(pristine)


@pytest.fixture(autouse=True)
def coarse_pictures(monkeypatch):
    """Fewer dots than in print: the tests look at what is drawn, not at its pixels."""
    monkeypatch.setitem(RC, "savefig.dpi", 60)


@pytest.fixture
def output(pristine, tmp_path):
    """A copy of it to change."""
    return shutil.copytree(pristine, tmp_path / "out")


def front_rows(folder, run: str, front_id: int) -> dict[str, np.ndarray]:
    """Columns of one front in fronts.csv, read here without the package."""
    with open(folder / run / "fronts.csv", newline="") as stream:
        rows = [row for row in csv.DictReader(stream) if int(row["front_id"]) == front_id]
    names = [name for name in rows[0] if name != "speed_kind"]
    return {name: np.array([float(row[name]) if row[name] else np.nan for row in rows]) for name in names}


def shown(run: str, rows: dict[str, np.ndarray]) -> np.ndarray:
    """Outside the trigger zone and its margin, 10 mm each."""
    x = rows["x_m"]
    if run == "left":
        return x >= CONTACT_FROM_M + 0.02
    return x <= CONTACT_TO_M - 0.02 if run == "right" else np.full(len(x), True)


def at_nucleation(run: str, rows: dict[str, np.ndarray]) -> np.ndarray:
    """The first 5 mm of a spontaneous front."""
    return np.abs(rows["x_m"] - rows["x_m"][0]) < 5e-3 if run.startswith("spontaneous") else np.array(False)


def artist(figure: Figure, gid: str, panel: int = 0):
    found = figure.axes[panel].findobj(lambda a: a.get_gid() == gid)
    assert len(found) == 1, f"{len(found)} artists named {gid}"
    return found[0]


def gids(figure: Figure, panel: int = 0) -> set[str]:
    return {a.get_gid() for a in figure.axes[panel].findobj() if a.get_gid()}


def change_front_cells(file, change) -> None:
    """Rewrites fronts.csv with change(row), a dictionary, for each row; None drops the row."""
    with open(file, newline="") as stream:
        rows = [change(row) for row in csv.DictReader(stream)]
    write_csv(file, FRONTS_HEADER, [list(row.values()) for row in rows if row is not None])


# The command


def test_command_writes_figures_and_report(output, capsys):
    assert main([str(output)]) == 0
    made = output / "figures"
    for name in FIGURES:
        assert (made / f"{name}.png").read_bytes()[:4] == b"\x89PNG"
        assert (made / f"{name}.pdf").read_bytes()[:5] == b"%PDF-"
    pictures = {f"{name}.{kind}" for name in FIGURES for kind in ("png", "pdf")}
    assert {file.name for file in made.iterdir()} == {"index.html", *pictures}
    out = capsys.readouterr().out
    assert str(made) in out and str(made / "index.html") in out

    html = (made / "index.html").read_text(encoding="utf-8")
    assert html.count("<figure ") == len(FIGURES)
    assert html.count('src="data:image/png;base64,') == len(FIGURES)
    assert "http" not in html and "<script" not in html
    links = set(re.findall(r'href="([^"]+)"', html))
    assert {link for link in links if not link.startswith("#")} == {f"{name}.pdf" for name in FIGURES}
    assert all(f'id="{link[1:]}"' in html for link in links if link.startswith("#"))

    scorecard = html.split(">Scorecard</h2>")[1].split("</table>")[0]
    rows = re.findall(r"<tr><td>.*?</tr>", scorecard)
    assert len(rows) == 4
    assert "<td>C1+</td>" in rows[1]
    assert "c_L &lt; 1600 m/s &amp; more" in rows[0] and ">✓<" in rows[0] and "each within 1 m/s" in rows[0]
    assert ">✗<" in rows[2] and "<td>0.7123</td>" in rows[2]
    assert rows[3].count(">–<") == 2  # not measured, not decided
    assert "Of 3 statements 1 hold (✓), 1 do not (✗), 1 could not be decided (–)." in html
    assert "Rows with a + (1) are further tests" in html
    assert "<td>0.500</td><td>0.450 to 0.550</td><td>0.76 ± 0.07</td>" in html
    assert "Points: 512; rms about the fit: 0.081 c<sub>L</sub>; within the paper's band: 61 %" in html

    fronts = html.split(">Fronts</h2>")[1].split("</table>")[0]
    assert len(re.findall(r"<tr><td>", fronts)) == 1 + 4 + 1 + 3
    assert "slipfront 0.1.0, commit abc1234" in html
    timings = html.split(">Timings</h2>")[1]
    assert "<td>events</td><td>1.2</td>" in timings and "<td>21.8</td>" in timings


@pytest.mark.parametrize("kinds", [["svg"], ["png"]])
def test_kinds_of_pictures_are_chosen(output, kinds):
    assert main([str(output), *(word for kind in kinds for word in ("--format", kind))]) == 0
    made = {file.name for file in (output / "figures").iterdir()}
    assert made - {"index.html"} == {f"{name}.{kind}" for name in FIGURES for kind in kinds}
    assert ("index.html" in made) == ("png" in kinds)
    if "index.html" in made:
        assert ".pdf" not in (output / "figures/index.html").read_text(encoding="utf-8")


def test_an_unknown_kind_of_picture_is_refused(output):
    with pytest.raises(SystemExit) as refused:
        main([str(output), "--format", "bmp"])
    assert refused.value.code == 2 and not (output / "figures").exists()


def test_report_lists_the_studies(output):
    assert main([str(output)]) == 0
    html = (output / "figures" / "index.html").read_text(encoding="utf-8")
    body = html.split(">Studies</h2>")[1].split("<tbody>")[1].split("</table>")[0]
    rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>.*?</tr>", body)]
    assert [len(row) for row in rows] == [14, 13, 13, 14, 14, 13]  # the name spans a study's rows
    fits = ["0.110", "50", "0.31", "0.20", "–"]
    speeds = ["1.20 / 0.72", "1.50 / 0.90", "1.35 / 0.81", "1.80 / 1.08"]
    assert rows[1] == ["<b>0.6</b>", *speeds, "0.0", "0.0", "0.0", *fits]  # bold: the paper's value
    assert rows[2][:5] == ["1.2", "7.50 / 4.50*", "–", "–", "–"]  # starts elsewhere; no front
    assert rows[3][1] == "1" and "(mm)" in rows[3][0] and rows[3][6] == "−2.0"
    assert rows[4][1] == "<b>relief</b>" and rows[5][0] == "fillet 2mm"


def test_folder_without_studies_and_timings_is_drawn(output):
    analysis = json.loads((output / "analysis.json").read_text())
    analysis["studies"] = []
    (output / "analysis.json").write_text(json.dumps(analysis))
    (output / "timings.json").unlink()
    assert main([str(output)]) == 0
    html = (output / "figures" / "index.html").read_text(encoding="utf-8")
    assert html.count("<figure ") == len(FIGURES) - 2
    assert "Studies</h2>" not in html and "Timings</h2>" not in html


def test_same_results_give_the_same_files(output, results):
    for drawing in (criteria.energy(results), events.three_events(results)):
        drawing.save(output)
        first = [(output / f"{drawing.name}.{kind}").read_bytes() for kind in ("png", "pdf")]
        drawing.save(output)
        assert first == [(output / f"{drawing.name}.{kind}").read_bytes() for kind in ("png", "pdf")]


# What the figures show


@pytest.mark.parametrize("front_id, direction", [(1, -1), (2, 1)])
def test_figure_2_shows_the_speeds_of_the_high_mu_k_run(pristine, results, front_id, direction):
    figure = criteria.static_ratio_mu_k(results).figure
    rows = front_rows(pristine, "spontaneous_mu_k_1.0", front_id)
    weak = at_nucleation("spontaneous_mu_k_1.0", rows)
    assert weak.any() and not weak.all()
    line = artist(figure, f"spontaneous_mu_k_1.0:{front_id}")
    ratio, v = rows["t_s_Pa"] / rows["p_s_Pa"], rows["v_tip_m_per_s"] / C_L
    np.testing.assert_allclose(line.get_xdata(), np.where(weak, np.nan, ratio))
    np.testing.assert_allclose(line.get_ydata(), np.where(weak, np.nan, v))
    assert np.isnan(line.get_ydata()[-1])
    assert rows["direction"][0] == direction
    assert line.get_linestyle() == ("-" if direction > 0 else "--")  # in the order of the text's words


def test_figure_2_shows_the_wave_speeds(results):
    figure = criteria.static_ratio_mu_k(results).figure
    for wave in ("c_L", "c_S", "c_R"):
        level = artist(figure, wave).get_ydata()[0]
        assert level == pytest.approx(WAVE_SPEEDS[f"{wave}_m_per_s"] / C_L)


def test_short_fronts_are_pale_or_left_out(results):
    run = results.runs["spontaneous"]
    assert [front.id for front in run.fronts] == [1, 2, 3, 4]
    assert [front.id for front in drawn_fronts(run)] == [1, 2, 4]
    assert {front.id for front in main_fronts(run)} == {1, 2}
    figure = events.three_events(results).figure
    names = gids(figure, panel=4)
    assert not any(name.startswith("spontaneous:3") for name in names)
    assert "spontaneous:4" not in names
    secondary = artist(figure, "spontaneous:4:other", 4)
    assert secondary.get_linewidth() < artist(figure, "spontaneous:1", 4).get_linewidth()
    assert not matplotlib.colors.same_color(secondary.get_color(), "black")
    assert secondary.get_marker() == "None"


def test_last_stretch_is_pale_in_figure_6_alone(pristine, results):
    rows = front_rows(pristine, "left", 1)
    tail = rows["x_m"] >= rows["x_m"][-1] - 20.001e-3
    v = rows["v_tip_m_per_s"] / C_L
    figure = criteria.energy(results).figure
    pale, strong = artist(figure, "left:1:tail"), artist(figure, "left:1")
    np.testing.assert_allclose(pale.get_ydata()[tail], v[tail])
    assert np.isnan(pale.get_ydata()[~tail]).all() and np.isnan(strong.get_ydata()[tail]).all()
    assert not matplotlib.colors.same_color(pale.get_color(), strong.get_color())
    for other, panel in ((criteria.dynamic_criterion(results), 0), (events.three_events(results), 4)):
        assert "left:1:tail" not in gids(other.figure, panel)
        assert np.isfinite(artist(other.figure, "left:1", panel).get_ydata()[tail][:-1]).all()


def test_nodes_of_main_fronts_that_do_not_count_are_pale(pristine, results):
    rows = front_rows(pristine, "spontaneous", 1)
    near = at_nucleation("spontaneous", rows)
    line = artist(criteria.dynamic_ratio_along_x(results).figure, "spontaneous:1:weak")
    wider = near | np.roll(near, 1)  # one more node, to meet the other line
    np.testing.assert_allclose(line.get_xdata(), np.where(wider, 1e3 * rows["x_m"], np.nan))
    assert line.get_linewidth() < 1 and line.get_zorder() < 2


def test_figure_6_shows_a_marker_per_node(pristine, results):
    figure = criteria.energy(results).figure
    for run, front_id in (("left", 1), ("spontaneous", 1), ("spontaneous", 2), ("right", 1)):
        points, pale = artist(figure, f"{run}:{front_id}"), artist(figure, f"{run}:{front_id}:tail")
        rows = front_rows(pristine, run, front_id)
        rise = (rows["U_r_J_per_m3"] - rows["U_s_J_per_m3"]) / rows["U_s_J_per_m3"]
        defined = np.isfinite(rise * rows["v_tip_m_per_s"]) & shown(run, rows) & ~at_nucleation(run, rows)
        drawn = sum(np.isfinite(np.column_stack(a.get_data())).all(axis=1).sum() for a in (points, pale))
        assert drawn == defined.sum() > 0
        assert points.get_linestyle() == "None" and points.get_markevery() is None


@pytest.mark.parametrize("run, front_id", [("left", 1), ("spontaneous", 1), ("spontaneous", 2), ("right", 1)])
def test_figures_3_to_6_show_the_three_events(pristine, results, run, front_id):
    rows = front_rows(pristine, run, front_id)
    v = rows["v_tip_m_per_s"] / C_L
    dynamic = rows["t_d_Pa"] / rows["p_d_Pa"]
    static = np.divide(rows["t_s_Pa"], rows["p_s_Pa"], out=np.full(len(v), np.nan), where=rows["p_s_Pa"] > 0)
    energy = (rows["U_r_J_per_m3"] - rows["U_s_J_per_m3"]) / rows["U_s_J_per_m3"]
    assert np.isnan(dynamic).any() and np.isfinite(dynamic).any()
    strong = shown(run, rows) & ~at_nucleation(run, rows)
    before_end = np.abs(rows["x_m"] - rows["x_m"][-1]) > 20.001e-3  # every one of these fronts stops
    assert strong.sum() < len(v)
    for figure, panel, x, y, drawn in (
        (events.three_events(results).figure, 4, static, v, strong),
        (criteria.dynamic_ratio_along_x(results).figure, 0, 1e3 * rows["x_m"], dynamic, strong),
        (criteria.dynamic_criterion(results).figure, 0, dynamic, v, strong),
        (criteria.energy(results).figure, 0, energy, v, strong & before_end),
    ):
        line = artist(figure, f"{run}:{front_id}", panel)
        np.testing.assert_allclose(line.get_xdata(), np.where(drawn, x, np.nan))
        np.testing.assert_allclose(line.get_ydata(), np.where(drawn, y, np.nan))


def test_figure_4_shows_the_static_ratio_and_mu_s(results):
    figure = criteria.dynamic_ratio_along_x(results).figure
    run = results.runs["spontaneous"]
    static = artist(figure, "static")
    np.testing.assert_allclose(static.get_xdata(), 1e3 * run.static_x_m)
    np.testing.assert_allclose(static.get_ydata(), run.static_ratio)
    assert np.isnan(static.get_ydata()[0])  # no contact at the left edge node
    assert artist(figure, "mu_s").get_ydata()[0] == MU_S


def test_figure_6_shows_our_fit_and_the_papers_band(results):
    figure = criteria.energy(results).figure
    fit = artist(figure, "fit")
    r = np.asarray(fit.get_xdata())
    np.testing.assert_allclose(fit.get_ydata(), 0.5 + 1.7 * np.exp(-2.0 * np.sqrt(r)))
    corners = artist(figure, "paper_band").get_paths()[0].vertices
    at_zero = corners[np.isclose(corners[:, 0], 0)][:, 1]
    assert at_zero.min() == pytest.approx(0.76 + 1.80 - 0.07)
    assert at_zero.max() == pytest.approx(0.76 + 1.80 + 0.07)


def test_figure_6_shows_the_interval_of_our_fit(output, results):
    assert "fit_interval" not in gids(criteria.energy(results).figure)  # an older folder tells none
    file = output / "analysis.json"
    analysis = json.loads(file.read_text())
    r, low, high = [0.1, 0.4, 0.9], [1.2, 0.9, 0.5], [1.6, 1.1, 0.8]
    keys = ("x", "value", "low", "high")
    analysis["fit_curve"] = [
        dict(zip(keys, point, strict=True)) for point in zip(r, [1.4, 1, 0.6], low, high, strict=True)
    ]
    file.write_text(json.dumps(analysis))
    corners = artist(criteria.energy(read_results(output)).figure, "fit_interval").get_paths()[0].vertices
    for x, bottom, top in zip(r, low, high, strict=True):
        there = corners[np.isclose(corners[:, 0], x)][:, 1]
        assert (there.min(), there.max()) == pytest.approx((bottom, top))


def add_second_test(output, **change):
    """C18b, whose fit is that of the main fronts."""
    file = output / "scorecard.json"
    values = {"rms": 0.065, "a": 0.8, "b": 2.14, "c": 3.56}
    row = {
        "id": "C18b",
        "claim": "x",
        "paper": "Fig. 6",
        "measured": "a = 0.80 [0.71, 0.86] & more",
        "how": "y",
    }
    row |= {"holds": False, "counts": True, "second_test_of": "C18", "why": "z"}
    row["figures"] = [{"name": name, "value": value, "unit": ""} for name, value in values.items()]
    file.write_text(json.dumps([*json.loads(file.read_text()), row | change]))
    return read_results(output)


def test_figure_6_shows_the_fit_to_the_main_fronts(output, results):
    assert "main_fronts_fit" not in gids(criteria.energy(results).figure)  # an older folder has none
    drawing = criteria.energy(add_second_test(output))
    curve = artist(drawing.figure, "main_fronts_fit")
    r = np.asarray(curve.get_xdata())
    np.testing.assert_allclose(curve.get_ydata(), 0.8 + 2.14 * np.exp(-3.56 * np.sqrt(r)))
    texts = [text.get_text() for text in drawing.figure.legends[0].get_texts()]
    assert texts[-2:] == ["fit to all points (C18)", "fit to main fronts (C18b)"]
    assert (
        "all points of the program's fronts, those of the thin lines too (C18, the first test)"
        in drawing.caption
    )
    assert "main fronts without their last 20 mm (C18b): a = 0.80 [0.71, 0.86] &amp; more." in drawing.caption


def test_a_second_test_without_numbers(output):
    assert add_second_test(output, figures=[{"name": "a", "value": 0.8}, 1]).main_fronts_fit is None


def test_report_tells_both_fits(output):
    add_second_test(output)
    assert main([str(output)]) == 0
    html = (output / "figures/index.html").read_text(encoding="utf-8").split('<h2 id="fit">')[1]
    table, rest = html.split("</table>")[:2]
    header = re.findall(r"<th>(.*?)</th>", table)
    assert header[1] == "All points (C18)" and header[4] == "Main fronts without their last 20 mm (C18b)"
    rows = [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", table)[1:]]
    assert rows == [
        ["<i>a</i>", "0.500", "0.450 to 0.550", "0.76 ± 0.07", "0.800"],
        ["<i>b</i>", "1.700", "1.500 to 1.900", "1.80", "2.140"],
        ["<i>c</i>", "2.000", "1.800 to 2.200", "3.05", "3.560"],
    ]
    assert 'C18b in the scorecard: "a = 0.80 [0.71, 0.86] &amp; more".' in rest


def test_figure_6_without_a_fit(output):
    analysis = json.loads((output / "analysis.json").read_text())
    analysis["fit"] = None
    (output / "analysis.json").write_text(json.dumps(analysis))
    drawing = criteria.energy(read_results(output))
    assert "fit" not in gids(drawing.figure)
    assert "paper_band" in gids(drawing.figure)
    assert "Too few points" in drawing.caption


def test_set_up_shows_maximum_nucleation_and_friction_law(results):
    figure = plate.setup(results).figure
    assert artist(figure, "nucleation").center == pytest.approx((145.0, 0.0))
    assert artist(figure, "maximum", 1).get_xdata()[0] == pytest.approx(145.0)
    for name, mu_k in (("spontaneous", 0.6), ("spontaneous_mu_k_1.0", 1.0)):
        law = artist(figure, name, 2)
        v, mu = np.asarray(law.get_xdata()), np.asarray(law.get_ydata())
        np.testing.assert_allclose(mu, mu_k + (1.3 - mu_k) * np.exp(-v * np.sqrt((1.3 - mu_k) / 0.1)))


def test_mesh_lines_are_those_of_the_grid(results):
    run = results.runs["spontaneous"]
    ends, boundary = plate.edges(run.fields.cells)
    assert len(ends) == 40 * 21 + 41 * 20 and boundary.sum() == 2 * (40 + 20)
    assert plate.on_coarse_grid(ends, columns=40, every=1).all()
    assert plate.on_coarse_grid(ends, columns=40, every=10).sum() == 40 * 3 + 20 * 5
    assert plate.coarsening(300, 150) == 6
    assert plate.coarsening(40, 20) == 1


def test_snapshots_are_chosen_by_the_fronts_positions(results):
    run = results.runs["left"]
    front = run.fronts[0]
    chosen = events.choose_step(run)
    distance = [abs((front.tip_m(t) or np.inf) - 0.6 * 0.2) for t in run.fields.time_s]
    assert chosen == int(np.argmin(distance))

    run = results.runs["spontaneous"]
    time = run.fields.time_s[events.choose_step(run)]
    positions = [x for _, x in events.tips(run, time)]
    assert len(positions) == 2 and min(positions) > 0.01 and max(positions) < 0.19
    assert abs(time - 32e-6) <= 5e-6  # nucleation at 2 us, snapshots every 10 us


def test_snapshots_mark_start_and_tips(results):
    figure = events.three_events(results).figure
    for panel, (name, marker) in enumerate((("left", "s"), ("spontaneous", "o"), ("right", "^"))):
        run = results.runs[name]
        begin = artist(figure, "start", panel)
        assert begin.get_marker() == marker
        assert begin.get_xdata()[0] == pytest.approx(1e3 * run.fronts[0].x_m[0])
        time = run.fields.time_s[events.choose_step(run)]
        for front, x_m in events.tips(run, time):
            assert artist(figure, f"tip:{front.id}", panel).get_xdata()[0] == pytest.approx(1e3 * x_m)
            tail, head = artist(figure, f"way:{front.id}", panel)._posA_posB
            assert np.sign(head[0] - tail[0]) == front.direction


def test_snapshot_shows_the_magnitude_of_the_step_chosen(results):
    run = results.runs["right"]
    step = events.choose_step(run)
    figure = events.three_events(results).figure
    colours = next(c for c in figure.axes[2].collections if c.get_array() is not None)
    speed = run.fields.speed_m_per_s(step)
    assert speed.max() > 0.5
    np.testing.assert_allclose(colours.get_array(), speed)
    assert colours.get_clim() == (0, 2)


def test_tip_is_interpolated_between_onsets(results):
    front = results.runs["left"].fronts[0]
    middle = 0.5 * (front.onset_s[3] + front.onset_s[4])
    assert front.tip_m(middle) == pytest.approx(0.5 * (front.x_m[3] + front.x_m[4]))
    assert front.tip_m(front.onset_s[-1] + 1e-9) is None
    assert front.tip_m(front.onset_s[0] - 1e-9) is None


def test_space_time_shows_onsets_and_slopes_of_the_wave_speeds(pristine, results):
    figure = space_time.space_time(results, "right").figure
    rows = front_rows(pristine, "right", 1)
    line = artist(figure, "right:1")
    np.testing.assert_allclose(line.get_xdata(), 1e3 * rows["x_m"])
    np.testing.assert_allclose(line.get_ydata(), 1e6 * rows["onset_s"])
    for wave in ("c_L", "c_S", "c_R"):
        x, t = artist(figure, f"{wave}:-1").get_data()
        assert (x[0], t[0]) == pytest.approx((1e3 * rows["x_m"][0], 1e6 * rows["onset_s"][0]))
        assert -1e3 * np.diff(x)[0] / np.diff(t)[0] == pytest.approx(WAVE_SPEEDS[f"{wave}_m_per_s"])
    assert "c_L:1" not in gids(figure)  # it starts next to the right edge


def test_fronts_have_the_same_colours_in_all_figures(results):
    looks = EVENT_STYLES["spontaneous"].fronts
    for drawing, panel in (
        (space_time.space_time(results, "spontaneous"), 0),
        (events.three_events(results), 4),
        (criteria.dynamic_ratio_along_x(results), 0),
        (criteria.dynamic_criterion(results), 0),
        (criteria.energy(results), 0),
    ):
        for front_id, way in ((1, -1), (2, 1)):
            assert artist(drawing.figure, f"spontaneous:{front_id}", panel).get_color() == looks[way].colour
    figure = space_time.space_time(results, "spontaneous").figure
    handles = figure.legends[0].legend_handles
    told = {text.get_text(): h for h, text in zip(handles, figure.legends[0].get_texts(), strict=True)}
    assert told["front to $-x$"].get_color() == looks[-1].colour
    assert told["front to $+x$"].get_color() == looks[1].colour
    assert "contact open" in told and r"$c_\mathrm{R}$" in told


def test_legends_are_inside_the_figures(results):
    with matplotlib.rc_context(RC):
        for drawing in (
            events.three_events(results),
            criteria.static_ratio_mu_k(results),
            criteria.dynamic_ratio_along_x(results),
            criteria.dynamic_criterion(results),
            criteria.energy(results),
            space_time.space_time(results, "spontaneous"),
        ):
            figure = drawing.figure
            figure.draw_without_rendering()
            for legend in (*figure.legends, *(ax.get_legend() for ax in figure.axes if ax.get_legend())):
                box = legend.get_window_extent()
                assert box.x0 >= 0 and box.x1 <= figure.bbox.x1, drawing.name
                assert box.y0 >= 0 and box.y1 <= figure.bbox.y1, drawing.name


def test_space_time_masks_open_contact(results):
    history = results.runs["left"].history
    drawn = artist(space_time.space_time(results, "left").figure, "rate").get_array()
    assert drawn.mask[:, history.x_m < CONTACT_FROM_M].all()
    np.testing.assert_array_equal(drawn.mask, history.p_Pa <= 0)
    fast = ~drawn.mask & (np.abs(history.slip_rate_m_per_s) > 0.1)
    assert fast.any()
    np.testing.assert_allclose(drawn[fast], np.abs(history.slip_rate_m_per_s)[fast])


def test_arrows_stay_inside_the_frame(results):
    figure = events.three_events(results).figure
    for panel in range(3):
        for gid in gids(figure, panel):
            if gid.startswith("way:"):
                ends = [x for x, _ in artist(figure, gid, panel)._posA_posB]
                assert min(ends) >= 0 and max(ends) <= 200


def test_direction_is_told_by_the_markers_filling(results):
    figure = events.three_events(results).figure
    against = artist(figure, "spontaneous:1", 4).get_markerfacecolor()
    along = artist(figure, "spontaneous:2", 4).get_markerfacecolor()
    assert matplotlib.colors.same_color(along, "white") and not matplotlib.colors.same_color(against, "white")


def test_points_outside_the_axes_are_counted(output):
    fast = {"v_tip_m_per_s": repr(3.5 * C_L)}
    change_front_cells(
        output / "left" / "fronts.csv", lambda row: row | fast if 0.079 < float(row["x_m"]) < 0.091 else row
    )
    drawing = criteria.dynamic_criterion(read_results(output))
    assert drawing.figure.axes[0].get_ylim() == (0, 3)
    assert re.search(r" 3 of \d+ points lie outside the axes", drawing.caption)


def count_in_caption(caption: str) -> tuple[int, int]:
    found = re.search(r" (\d+) of (\d+) points lie outside the axes", caption)
    return (int(found[1]), int(found[2])) if found else (0, 0)


def test_a_single_outlier_does_not_set_the_axis(output, results):
    usual = criteria.dynamic_criterion(results)
    fast = {"v_tip_m_per_s": repr(10 * C_L)}
    change_front_cells(
        output / "left" / "fronts.csv", lambda row: row | fast if abs(float(row["x_m"]) - 0.1) < 1e-6 else row
    )
    drawing = criteria.dynamic_criterion(read_results(output))
    top = drawing.figure.axes[0].get_ylim()[1]
    assert top == pytest.approx(usual.figure.axes[0].get_ylim()[1], rel=0.05)
    assert count_in_caption(drawing.caption)[0] == count_in_caption(usual.caption)[0] + 1


def test_axes_hold_the_main_fronts(pristine, results):
    drawing = criteria.energy(results)
    ax = drawing.figure.axes[0]
    assert ax.get_xlim()[0] == 0
    outside, total = count_in_caption(drawing.caption)
    defined = beyond = 0
    for run, ids in (("left", (1,)), ("spontaneous", (1, 2, 4)), ("right", (1,))):
        for front_id in ids:
            rows = front_rows(pristine, run, front_id)
            v = rows["v_tip_m_per_s"] / C_L
            rise = (rows["U_r_J_per_m3"] - rows["U_s_J_per_m3"]) / rows["U_s_J_per_m3"]
            use = shown(run, rows) & np.isfinite(v * rise)
            defined += use.sum()
            beyond += (use & ((v > ax.get_ylim()[1]) | (rise > ax.get_xlim()[1]))).sum()
    assert (outside, total) == ((beyond, defined) if beyond else (0, 0))
    assert beyond <= 0.05 * defined


def test_report_tells_how_far_the_scorecard_moves(output):
    file = output / "scorecard.json"
    scorecard = json.loads(file.read_text())
    for row in scorecard[:2]:
        row["mesh_variation"] = {
            "parameter": "plate.element_size_m",
            "value": 1e-3,
            "measured": "1584.2",
            "holds": True,
            "differences": [0.25],
            "moves": "< 0.001 m/s" if row["id"] == "C1" else "",
        }
    file.write_text(json.dumps(scorecard))
    assert main([str(output)]) == 0
    html = (output / "figures/index.html").read_text(encoding="utf-8")
    rows = re.findall(r"<tr>.*?</tr>", html.split(">Scorecard</h2>")[1].split("</table>")[0])
    assert "<th>With the mesh, moves by</th><th>How tested</th>" in rows[0]
    assert "<td>&lt; 0.001 m/s</td><td>each within 1 m/s</td>" in rows[1]
    assert "<td>–</td><td>otherwise</td>" in rows[2]  # nothing moves
    assert "<td>–</td><td>ratio</td>" in rows[3]  # not run
    assert "runs with plate.element_size_m = 0.001, one at a time" in html


def test_report_tells_which_of_two_verdicts_counts(output):
    file = output / "scorecard.json"
    scorecard = json.loads(file.read_text())
    for row in scorecard:
        row["counts"] = row["id"] in ("C1", "E1")
    second = {"claim": "claim", "paper": "Fig. 1", "measured": "0.5", "how": "better"}
    scorecard.append(
        second | {"id": "C1b", "holds": None, "counts": False, "second_test_of": "C1", "why": "untried"}
    )
    scorecard.append(
        second | {"id": "C2b", "holds": True, "counts": True, "second_test_of": "C2", "why": "a < b"}
    )
    file.write_text(json.dumps(scorecard))
    assert main([str(output)]) == 0
    html = (output / "figures/index.html").read_text(encoding="utf-8")
    rows = re.findall(r"<tr><td>.*?</tr>", html.split(">Scorecard</h2>")[1].split("</table>")[0])
    assert ">✓</td>" in rows[0]  # its second test was not done
    assert '>✗<br><span class="note">C2b counts</span></td>' in rows[2]
    assert 'better<br><span class="note">Instead of C1: untried</span>' in rows[4]
    assert ">✓</td>" in rows[5] and "Instead of C2: a &lt; b" in rows[5]
    assert "Of 3 statements 2 hold (✓), 0 do not (✗), 1 could not be decided (–)." in html
    assert "a second one (2) counts, once it was done; by the first tests alone 1 hold." in html
    assert "Rows with a + (1) are further tests" in html


def test_report_tells_what_was_used_to_choose(output):
    file = output / "scorecard.json"
    scorecard = json.loads(file.read_text())
    for row in scorecard:
        row["counts"] = not row["id"].endswith("+")
    held = [row for row in scorecard if row["holds"] is True and row["counts"]]
    held[0]["used_to_choose"] = True
    file.write_text(json.dumps(scorecard))
    assert main([str(output)]) == 0
    html = (output / "figures/index.html").read_text(encoding="utf-8")
    assert f"{len(held) - 1} hold (✓)" in html
    assert "Used to choose what the paper leaves open (=): 1." in html
    assert 'title="used to choose what the paper leaves open">=</td>' in html


# Captions


CAPTION_NUMBER = r"(?<![\w.])\d+\.\d\d(?!\d)"


def test_caption_of_figure_6_has_the_numbers_of_the_file(output):
    file = output / "analysis.json"
    analysis = json.loads(file.read_text())
    new = {"a": (0.11, 0.12, 0.13), "b": (2.21, 2.22, 2.23), "c": (3.31, 3.32, 3.33)}
    analysis["fit"] |= {name: dict(zip(("low", "value", "high"), v, strict=True)) for name, v in new.items()}
    analysis["paper_fit"] = {"a": 0.71, "a_band": 0.09, "b": 1.72, "c": 3.73}
    file.write_text(json.dumps(analysis))
    caption = criteria.energy(read_results(output)).caption
    assert "a = 0.71 ± 0.09, b = 1.72, c = 3.73" in caption
    assert "a = 0.12 [0.11, 0.13], b = 2.22 [2.21, 2.23], c = 3.32 [3.31, 3.33]" in caption
    told = {0.71, 0.09, 1.72, 3.73} | {number for triple in new.values() for number in triple}
    assert {float(number) for number in re.findall(CAPTION_NUMBER, caption)} == told


def statement_rows(output, figure: str) -> list[list[str]]:
    assert main([str(output)]) == 0
    html = (output / "figures/index.html").read_text(encoding="utf-8")
    body = html.split(f'<figure id="{figure}"')[1].split("</figure>")[0].split("<tbody>")
    rows = re.findall(r"<tr>(.*?)</tr>", body[1]) if len(body) > 1 else []
    return [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in rows]


def test_statements_of_the_paper_stand_beside_the_scorecards_figures(output):
    claims = {"C18": ("rms 0.123 c_L & more", False), "C18b": ("rms 0.045 c_L", True), "C19": ("77 %", None)}
    rows = [
        {"id": name, "claim": "x", "paper": "Fig. 6", "measured": measured, "holds": holds, "how": "y"}
        for name, (measured, holds) in claims.items()
    ]
    rows[1]["second_test_of"] = "C18"
    (output / "scorecard.json").write_text(json.dumps(rows))
    found = statement_rows(output, "fig6_energy")
    said = [statement for statement, _ in STATEMENTS["fig6_energy"]]
    assert found == [
        [said[0], "rms 0.123 c_L &amp; more", "✗", "C18"],
        ["the same, second test", "rms 0.045 c_L", "✓", "C18b"],
        [said[1], "77 %", "–", "C19"],
    ]
    assert statement_rows(output, "fig5_dynamic_criterion") == []  # claims that the file lacks


def test_statements_have_no_numbers_of_their_own_and_known_claims():
    for name, statements in STATEMENTS.items():
        assert name in FIGURES
        for statement, claim in statements:
            assert not re.search(r"\d", statement)
            assert re.fullmatch(r"C([1-9]|1\d|2[0-3])|E1", claim)


# Energy balance


def test_balance_shows_the_terms_as_changes(results):
    figure = balance.balance(results).figure
    rows = np.array(energy_rows())
    n = len(results.runs)
    column = {"strain": 1, "kinetic": 2, "friction_work": 6, "damping_work": 8}
    for panel, name in enumerate(results.runs):
        assert {g for g in gids(figure, panel) if ":" in g} == {f"{name}:{term}" for term in column} - {
            f"{name}:kinetic"  # 2 of 101 J/m
        }
        for term in column.keys() - {"kinetic"}:
            line = artist(figure, f"{name}:{term}", panel)
            np.testing.assert_allclose(line.get_xdata(), 1e6 * rows[:, 0])
            np.testing.assert_allclose(line.get_ydata(), rows[:, column[term]] - rows[0, column[term]])
        # The small ones over the largest, 101 J/m; terms that do not occur are left out.
        small = {"kinetic": 2.0, "top_work": 0.8, "contact_work": 1e-4, "coupling_work": 0.2}
        small["imbalance"] = 5e-10
        assert {g for g in gids(figure, n + panel) if ":" in g} == {f"{name}:{term}" for term in small}
        for term, last in small.items():
            share = artist(figure, f"{name}:{term}", n + panel).get_ydata()
            assert np.isnan(share[0]) and share[-1] == pytest.approx(last / 101, rel=1e-4)
        assert figure.axes[n + panel].get_yscale() == "log"


def test_caption_of_the_balance_has_the_closing_figure(results):
    caption = balance.balance(results).caption
    assert "left-triggered: largest change 101 J/m, imbalance at most 5.0e-10 J/m or 5.0e-12 of it" in caption
    assert "coupling at the end 0.2 J/m" in caption
    assert "spontaneous, μ<sub>k</sub> = 1.0: largest" in caption


def test_imbalance_is_that_of_the_worst_row(output):
    file = output / "left" / "energy.csv"
    rows = energy_rows()
    rows[2][-1] = -0.0101
    write_csv(file, ENERGY_HEADER, rows)
    caption = balance.balance(read_results(output)).caption
    assert "left-triggered: largest change 101 J/m, imbalance at most 1.0e-02 J/m or 1.0e-04 of it" in caption


def test_single_run_has_its_balance(output, capsys):
    run = output / "left"
    assert main([str(run)]) == 0
    assert {file.name for file in (run / "figures").iterdir()} == {"energy_balance.png", "energy_balance.pdf"}
    assert str(run / "figures" / "energy_balance.png") in capsys.readouterr().out


def test_legend_of_the_balance_is_inside_the_figure(results):
    one = balance.Books("left", "left", results.runs["left"].balance)
    with matplotlib.rc_context(RC):
        for figure in (balance.balance(results).figure, balance.draw_balances([one]).figure):
            figure.canvas.draw()
            box = figure.legends[0].get_window_extent()
            assert box.x0 >= 0 and box.x1 <= figure.bbox.x1 and box.y0 >= 0


# Severe red and green blindness in linear RGB: Machado, Oliveira and Fernandes (2009).
BLINDNESS = {
    "protan": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deutan": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
}


def lab(colour: str, blindness: str) -> np.ndarray:
    """CIE L*a*b* of a colour as somebody with the blindness sees it."""
    rgb = np.array(matplotlib.colors.to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(np.array(BLINDNESS[blindness]) @ linear, 0, 1)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    t = np.array(to_xyz) @ seen / [0.9505, 1.0, 1.089]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def distance(colour: str, other: str, blindness: str) -> float:
    return float(np.linalg.norm(lab(colour, blindness) - lab(other, blindness)))


@pytest.mark.parametrize("blindness", BLINDNESS)
def test_fronts_of_an_event_differ_for_the_colour_blind(blindness):
    for name in ("spontaneous", "spontaneous_mu_k_1.0"):
        against, along = (EVENT_STYLES[name].front(way).colour for way in (-1, 1))
        assert distance(against, along, blindness) > 24
    assert distance(*DIRECTION_COLOURS.values(), blindness) > 50


@pytest.mark.parametrize("blindness", BLINDNESS)
def test_terms_of_the_balance_differ_for_the_colour_blind(blindness):
    looks = list(balance.TERMS.values())
    for i, (label, colour, line) in enumerate(looks):
        for other_label, other_colour, other_line in looks[i + 1 :]:
            distance = np.linalg.norm(lab(colour, blindness) - lab(other_colour, blindness))
            assert line != other_line or distance > 25, f"{label}, {other_label}"
    friction, damping = balance.TERMS["friction_work"], balance.TERMS["damping_work"]
    assert friction[2] != damping[2]
    assert np.linalg.norm(lab(friction[1], blindness) - lab(damping[1], blindness)) > 25


def test_run_in_which_nothing_happens_has_a_balance(output):
    write_csv(output / "left" / "energy.csv", ENERGY_HEADER, [[0] * 12, [1e-6] + [0] * 11])
    assert main([str(output / "left")]) == 0


# Studies


def study_panels(figure: Figure, index: int) -> tuple[int, int]:
    return 2 * index, 2 * index + 1


def test_studies_show_speeds_and_changes(results):
    figure = studies.speeds(results).figure
    upper, lower = study_panels(figure, 0)
    for gid, y in (
        ("max:spontaneous:-1", [2.0, 1.5, np.nan]),
        ("max:spontaneous:1", [1.8, 1.35, np.nan]),
        ("mean:right:-1", [1.44, 1.08, np.nan]),
        ("max:left:1", [1.6, 1.2, np.nan]),  # the third starts elsewhere
        ("other:left:1", [np.nan, np.nan, np.nan]),  # and lies above the axis
    ):
        np.testing.assert_allclose(artist(figure, gid, upper).get_ydata(), y)
    assert artist(figure, "other:left:1:above", upper).get_text() == "7.5↑"
    np.testing.assert_allclose(artist(figure, "change:spontaneous", lower).get_ydata(), [9, 0, np.nan])
    assert [label.get_text() for label in figure.axes[lower].get_xticklabels()] == ["0.4", "0.6", "1.2"]
    assert artist(figure, "max:spontaneous:-1", upper).get_linestyle() == "-"


def test_legends_of_studies_tell_lines_and_bands(results):
    for drawing, wanted in (
        (studies.speeds(results), {r"$c_\mathrm{L}$; no change", "band: change within 1 %"}),
        (studies.criteria(results), {"band: half width of the paper's"}),
    ):
        told = {text.get_text() for text in drawing.figure.legends[0].get_texts()}
        assert wanted | {"value of the paper's runs"} <= told


def test_studies_of_words_have_no_lines(results):
    figure = studies.speeds(results).figure
    upper, lower = study_panels(figure, 2)
    assert artist(figure, "max:spontaneous:-1", upper).get_linestyle() == "None"
    labels = [label.get_text() for label in figure.axes[lower].get_xticklabels()]
    assert labels == ["relief", "fillet\n2mm"]


def test_studies_are_named_in_words(results):
    figure = studies.speeds(results).figure
    titles = [figure.axes[study_panels(figure, i)[0]].get_title(loc="left") for i in range(3)]
    assert titles == [r"kinetic friction $\mu_k$", "element size (mm)", "rounding of the corners"]
    shown_texts = [text for ax in figure.axes for text in ax.findobj(matplotlib.text.Text) if text.get_text()]
    for study in results.studies:
        assert not any(study.parameter in text.get_text() for text in shown_texts)


def legend_place(results, n_studies: int) -> tuple[Figure, object]:
    many = replace_fields(results, studies=(results.studies * n_studies)[:n_studies])
    with matplotlib.rc_context(RC):
        figure = studies.speeds(many).figure
        figure.canvas.draw()
        return figure, figure.legends[0].get_window_extent()


@pytest.mark.parametrize("n_studies", [3, 4, 5, 13])
def test_legend_of_studies_takes_free_room(results, n_studies):
    figure, legend = legend_place(results, n_studies)
    boxes = [ax.get_tightbbox() for ax in figure.axes]
    assert not any(legend.overlaps(box) for box in boxes)
    assert legend.x0 >= 0 and legend.y0 >= 0 and legend.x1 <= figure.bbox.x1 and legend.y1 <= figure.bbox.y1


def test_numbers_above_the_axis_stand_side_by_side(results):
    ax = Figure().subplots()
    for gid in ("first", "second"):
        values = [9.0, 1.0, 8.0]
        studies.draw_values(ax, results.studies[0], values, 0.0, 4.0, gid, linestyle="-", color="black")
    offsets = [(text.get_gid(), text.xy[0], text.xyann[0]) for text in ax.texts]
    assert offsets == [
        ("first:above", 0, 12.0),
        ("first:above", 2, 12.0),
        ("second:above", 0, 19.5),
        ("second:above", 2, 19.5),
    ]


def test_numbers_above_the_axis_lie_on_no_marker(results):
    figure = studies.speeds(results).figure
    with matplotlib.rc_context(RC):
        figure.canvas.draw()
    ax = figure.axes[study_panels(figure, 0)[0]]
    numbers = [t.get_window_extent() for t in ax.texts if str(t.get_gid()).endswith(":above")]
    points = [ax.transData.transform(xy) for line in ax.lines[:-2] for xy in line.get_xydata()]
    assert numbers and points
    assert not any(number.contains(*xy) for number in numbers for xy in points)


def test_studies_mark_the_papers_value(results):
    figure = studies.criteria(results).figure
    assert artist(figure, "paper_value", 0).get_xdata()[0] == 1
    assert "paper_value" not in gids(figure, 2)  # 5 mm in the synthetic runs, not among the values
    assert artist(figure, "paper_value", 4).get_xdata()[0] == 0
    np.testing.assert_allclose(artist(figure, "rms").get_ydata(), [0.11, 0.11, np.nan])
    np.testing.assert_allclose(artist(figure, "spread:t_s_over_p_s", 1).get_ydata(), 0.31)
    assert np.isnan(artist(figure, "spread:energy", 1).get_ydata()).all()


def studies_of_trigger(output):
    """The study of the mesh becomes one of the trigger zone, in which the edges' runs differ."""
    analysis = json.loads((output / "analysis.json").read_text())
    study = analysis["studies"][1]
    study |= {"name": "trigger_zone", "parameter": "event.trigger_zone_m"}
    (point,) = study["points"]
    study["points"] = [point | {"value": str(v), "number": v} for v in (0.005, 0.01, 0.015)]
    (output / "analysis.json").write_text(json.dumps(analysis))
    for name, zone_m in (("left", 15e-3), ("right", 5e-3), ("spontaneous", 7e-3)):
        case = output / name / "case.resolved.toml"
        text, n = re.subn(r"(?m)^trigger_zone_m = .*$", f"trigger_zone_m = {zone_m}", case.read_text())
        assert n == 1
        case.write_text(text)
    return read_results(output)


def test_studies_mark_the_values_of_runs_that_differ_in_their_colours(output):
    results = studies_of_trigger(output)
    for draw in (studies.speeds, studies.criteria):
        figure = draw(results).figure
        panel = study_panels(figure, 1)[0]
        for event, index in (("left", 2), ("right", 0)):
            stripe = artist(figure, f"paper_value:{event}", panel)
            assert stripe.get_xdata()[0] == index and stripe.get_color() == EVENT_STYLES[event].colour
        assert not {"paper_value", "paper_value:spontaneous"} & gids(figure, panel)
        assert "paper_value" in gids(figure, 0)
        texts = [text.get_text() for text in figure.legends[0].get_texts()]
        assert texts[-3:] == [
            f"value of the {x}" for x in ("paper's runs", "left-triggered run", "right-triggered run")
        ]


def test_report_names_the_runs_whose_values_differ(output):
    studies_of_trigger(output)
    assert main([str(output)]) == 0
    html = (output / "figures/index.html").read_text(encoding="utf-8")
    assert '<td><b>15</b> <span class="note">left</span></td>' in html
    assert '<td><b>5</b> <span class="note">right</span></td>' in html
    assert "<td>10</td>" in html
    assert "<td><b>0.6</b></td>" in html  # the same in all events


# Missing data


def test_run_without_fronts_is_drawn(output):
    for name in ("left", "spontaneous", "spontaneous_mu_k_1.0"):
        change_front_cells(output / name / "fronts.csv", lambda row: None)
    assert main([str(output)]) == 0
    drawings = draw_all(read_results(output))
    assert not any(gid.startswith("spontaneous") for gid in gids(drawings[1].figure))


def test_lines_break_at_empty_cells(output):
    hole = {"v_tip_m_per_s": "", "t_d_Pa": ""}
    change_front_cells(
        output / "left" / "fronts.csv", lambda row: row | hole if abs(float(row["x_m"]) - 0.1) < 1e-6 else row
    )
    line = artist(criteria.dynamic_criterion(read_results(output)).figure, "left:1")
    at = [i for i, x in enumerate(front_rows(output, "left", 1)["x_m"]) if abs(x - 0.1) < 1e-6]
    assert len(at) == 1
    assert np.isnan(line.get_xdata()[at]).all() and np.isnan(line.get_ydata()[at]).all()
    assert np.isfinite(line.get_xdata()[at[0] + 1]) and np.isfinite(line.get_ydata()[at[0] + 1])


# Experimental data


@pytest.mark.parametrize("column, factor", [("v_over_c_L", 1.0), ("v_m_per_s", C_L)])
def test_experiment_is_drawn_over_figure_2(pristine, tmp_path, column, factor):
    file = tmp_path / "measured.csv"
    write_csv(file, ["static_ratio", column], [[0.7, 0.25 * factor], [1.1, 0.5 * factor]])
    points = artist(criteria.static_ratio_mu_k(read_results(pristine, file)).figure, "experiment")
    np.testing.assert_allclose(points.get_xdata(), [0.7, 1.1])
    np.testing.assert_allclose(points.get_ydata(), [0.25, 0.5])


def test_without_a_file_no_experiment_is_drawn(results):
    drawing = criteria.static_ratio_mu_k(results)
    assert "experiment" not in gids(drawing.figure)
    assert "No file of experimental data was given" in drawing.caption
    assert any("no experimental data given" in text.get_text() for text in drawing.figure.axes[0].texts)


# Errors: one clear line, exit code 2


def remove(path):
    def act(output):
        target = output / path
        shutil.rmtree(target) if target.is_dir() else target.unlink()

    return act


def replace(path, old, new):
    def act(output):
        text = (output / path).read_text()
        assert old in text
        (output / path).write_text(text.replace(old, new, 1))

    return act


def overwrite(path, text):
    return lambda output: (output / path).write_text(text)


def drop_dataset(path, name):
    def act(output):
        import h5py

        with h5py.File(output / path, "r+") as file:
            del file[name]

    return act


@pytest.mark.parametrize(
    "damage, file, says",
    [
        (remove("right"), "right", "no such folder"),
        (remove("left/fronts.csv"), "left/fronts.csv", "No such file"),
        (remove("left/interface.h5"), "left/interface.h5", "No such file"),
        (remove("left/energy.csv"), "left/energy.csv", "No such file"),
        (
            replace("left/energy.csv", "coupling_work", "other_work"),
            "left/energy.csv",
            "no column 'coupling_work_J_per_m'",
        ),
        (replace("left/energy.csv", "380.0,", ","), "left/energy.csv", "in column 'strain_J_per_m'"),
        (remove("scorecard.json"), "scorecard.json", "No such file"),
        (remove("analysis.json"), "analysis.json", "No such file"),
        (replace("left/fronts.csv", "t_d_Pa", "t_x_Pa"), "left/fronts.csv", "no column 't_d_Pa'"),
        (replace("left/fronts.csv", "\n1,", "\none,"), "left/fronts.csv:2", "'one' in column 'front_id'"),
        (replace("left/static.csv", "x_m,", "x_m,more,"), "left/static.csv:2", "3 cells, the header has 4"),
        (
            replace("spontaneous/case.resolved.toml", "mu_k =", "mu_x ="),
            "spontaneous/case.resolved.toml",
            "'friction.mu_k'",
        ),
        (overwrite("left/case.resolved.toml", "a = = 1"), "left/case.resolved.toml", "not TOML"),
        (replace("left/fronts.csv", ",1,", ",0,"), "left/fronts.csv", "column 'direction'"),
        (overwrite("left/run.json", "{"), "left/run.json", "not JSON"),
        (overwrite("left/run.json", "{}"), "left/run.json", "'statics.inside_from_m'"),
        (replace("left/run.json", "c_L_m", "c_X_m"), "left/run.json", "'wave_speeds.c_L_m_per_s'"),
        (overwrite("left/interface.h5", "text"), "left/interface.h5", "not an HDF5 file"),
        (drop_dataset("left/interface.h5", "slip_rate_m_per_s"), "left/interface.h5", "'slip_rate_m_per_s'"),
        (drop_dataset("left/interface.h5", "p_Pa"), "left/interface.h5", "'p_Pa'"),
        (drop_dataset("left/fields.vtkhdf", "VTKHDF/Steps/Values"), "left/fields.vtkhdf", "'Steps/Values'"),
        (overwrite("scorecard.json", '[{"id": "C1"}]'), "scorecard.json", "entry 1 has no 'claim'"),
        (
            replace("scorecard.json", '"holds": true', '"holds": true, "counts": 1'),
            "scorecard.json",
            "'counts' is not true or false",
        ),
        (
            replace("scorecard.json", '"holds": true', '"holds": true, "second_test_of": null'),
            "scorecard.json",
            "'second_test_of' is not a text",
        ),
        (overwrite("analysis.json", '{"fit": null}'), "analysis.json", "'paper_fit.a'"),
        (
            replace("analysis.json", '"speed_change": {"median"', '"speed_change": {"x"'),
            "analysis.json",
            "1 has",
        ),
        (replace("analysis.json", '"points": [', '"points": [3, '), "analysis.json", "study 1 is not as"),
        (
            replace("analysis.json", '"studies": ', '"fit_curve": [3], "studies": '),
            "analysis.json",
            "'fit_curve'",
        ),
        (overwrite("timings.json", '[{"part": "a"}]'), "timings.json", "'wall_s'"),
    ],
)
def test_damaged_folder_gives_one_line(output, capsys, damage, file, says):
    damage(output)
    assert main([str(output)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and error.startswith("slipfront.figures: error: ")
    assert str(output / file) in error and says in error
    assert not (output / "figures").exists()


def test_missing_output_folder_gives_one_line(tmp_path, capsys):
    assert main([str(tmp_path / "nowhere")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "nowhere: no such folder" in error


@pytest.mark.parametrize(
    "text, says", [(None, "No such file"), ("static_ratio\n1\n", "'v_over_c_L' or 'v_m_per_s'")]
)
def test_bad_experiment_gives_one_line(output, tmp_path, capsys, text, says):
    file = tmp_path / "measured.csv"
    if text is not None:
        file.write_text(text)
    assert main([str(output), "--experiment", str(file)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and str(file) in error and says in error


def test_folder_without_snapshots_gives_one_line(output, capsys):
    write_fields(output / "right" / "fields.vtkhdf", 40, 20, np.array([]), [])
    assert main([str(output)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "right/fields.vtkhdf: no snapshots" in error


def test_small_lengths_are_shown_in_micrometres():
    def shown(*values_m):
        points = [StudyPoint(f"{v}", v, {}, {}, None, None, {}) for v in values_m]
        study = Study("relaxation_length", "friction.relaxation_length_m", "", points)
        return study.unit[0], [study.shown(point) for point in points]

    assert shown(1e-8, 3e-6) == ("µm", ["0.01", "3"])
    assert shown(1e-8, 3e-3) == ("mm", ["1e-05", "3"])
