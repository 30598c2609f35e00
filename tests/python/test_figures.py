# SPDX-License-Identifier: BSD-3-Clause
"""The figures show what the files say, for a made-up output folder with known contents."""

from __future__ import annotations

import json
import re
import shutil

import draw as command
import h5py
import numpy as np
import pytest
from common import rows_of
from draw import draw_all, main
from drawing import criteria, events, studies
from drawing.html import statements_table, write_report
from drawing.results import read_results
from drawing.statements import STATEMENTS
from matplotlib.figure import Figure
from refusals import artist, change_json, gids, replace
from refusals import error_of_paper as one_error
from slipfront.figures.__main__ import main as draw_run
from slipfront.figures.drawing import Drawing
from slipfront.figures.main_fronts import drawn_fronts, main_fronts
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
    "fig1_setup", "fig2_static_ratio_mu_k_1.0", "fig3_three_events", "fig4_dynamic_ratio",
    "fig5_dynamic_criterion", "fig6_energy", "space_time_left", "space_time_spontaneous", "space_time_right",
    "space_time_spontaneous_mu_k_1.0", "energy_balance", "studies", "studies_criteria",
]  # fmt: skip


@pytest.fixture(scope="module")
def pristine(tmp_path_factory):
    """An output folder that no test may change."""
    return write_output(tmp_path_factory.mktemp("reproduction") / "out")


@pytest.fixture(scope="module")
def results(pristine):
    return read_results(pristine)


@pytest.fixture(scope="module")
def drawn(results):
    """Every figure by its name; to look at alone."""
    return {drawing.name: drawing for drawing in draw_all(results)}


@pytest.fixture(scope="module")
def made(pristine, tmp_path_factory):
    """The figures folder of the command, called once."""
    output = shutil.copytree(pristine, tmp_path_factory.mktemp("made") / "out")
    assert main([str(output), "--format", "png"]) == 0
    return output / "figures"


@pytest.fixture
def output(pristine, tmp_path):
    """A copy of it to change."""
    return shutil.copytree(pristine, tmp_path / "out")


def front_rows(folder, run: str, front_id: int) -> dict[str, np.ndarray]:
    """Columns of one front in fronts.csv, read here without the package."""
    rows = [row for row in rows_of(folder / run / "fronts.csv") if int(row["front_id"]) == front_id]
    names = [name for name in rows[0] if name != "speed_kind"]
    return {name: np.array([float(row[name]) if row[name] else np.nan for row in rows]) for name in names}


def counting(run: str, rows: dict[str, np.ndarray]) -> np.ndarray:
    """Nodes outside the trigger zone and its margin, 10 mm each, or the first 5 mm of a spontaneous front."""
    x = rows["x_m"]
    if run == "left":
        return x >= CONTACT_FROM_M + 0.02
    return x <= CONTACT_TO_M - 0.02 if run == "right" else np.abs(x - x[0]) >= 5e-3


def change_front_cells(file, change) -> None:
    """Rewrites fronts.csv with change(row), a dictionary, for each row; None drops the row."""
    rows = [change(row) for row in rows_of(file)]
    write_csv(file, FRONTS_HEADER, [list(row.values()) for row in rows if row is not None])


def report_of(output) -> str:
    """The report without pictures."""
    return write_report(read_results(output), [], output).read_text(encoding="utf-8")


def rows_under(html: str, heading: str) -> list[list[str]]:
    """Cells of the table under a heading, by row."""
    body = html.split(f">{heading}</h2>")[1].split("<tbody>")[1].split("</table>")[0]
    return [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>.*?</tr>", body)]


# The command


def test_the_report_holds_all_and_needs_no_other_file(made):
    assert {file.name for file in made.iterdir()} == {"index.html", *(f"{name}.png" for name in FIGURES)}
    assert all(file.read_bytes()[:4] == b"\x89PNG" for file in made.glob("*.png"))
    html = (made / "index.html").read_text(encoding="utf-8")
    assert re.findall(r'<figure id="([^"]+)"', html) == FIGURES
    assert html.count('src="data:image/png;base64,') == len(FIGURES)
    assert "http" not in html and "<script" not in html
    links = re.findall(r'href="([^"]+)"', html)
    assert links and all(link[0] == "#" and f'id="{link[1:]}"' in html for link in links)


def test_the_report_has_the_numbers_of_the_files(pristine, tmp_path):
    html = write_report(read_results(pristine), [], tmp_path).read_text(encoding="utf-8")
    scorecard = rows_under(html, "Scorecard")
    assert [row[0] for row in scorecard] == ["C1", "C2", "E1"]  # C1+ is folded away
    assert scorecard[0][1:4] == ["c_L &lt; 1600 m/s &amp; more", "1584, 890", "✓"]
    tests = scorecard[0][4]
    assert tests.startswith("<details><summary>1584.2, 888.9</summary>")
    assert "Test: each within 1 m/s." in tests and "C1+: " in tests
    assert [row[3] for row in scorecard] == ["✓", "✗", "–"]
    assert [row[4].split("</summary>")[0].split(">")[-1] for row in scorecard[1:]] == ["0.7123", "–"]
    assert "Of 3 statements 1 hold (✓), 1 do not (✗), 1 could not be decided (–)." in html
    fit = rows_under(html, "Fit of the energy criterion")
    assert fit[0][1:] == ["0.500", "0.450 to 0.550", "0.76 ± 0.07"]
    assert "Points: 512; rms about the fit: 0.081 c<sub>L</sub>; within the paper's band: 61 %" in html
    assert len(rows_under(html, "Fronts")) == 1 + 4 + 1 + 3
    assert "slipfront 0.1.0, commit abc1234" in html
    assert rows_under(html, "Timings") == [["events", "1.2"], ["studies", "20.5"], ["<b>sum</b>", "21.8"]]

    rows = rows_under(html, "Studies")
    assert [len(row) for row in rows] == [14, 13, 13, 14, 14, 13]  # the name spans a study's rows
    fits = ["0.110", "50", "0.31", "0.20", "–"]
    speeds = ["1.20 / 0.72", "1.50 / 0.90", "1.35 / 0.81", "1.80 / 1.08"]
    assert rows[1] == ["<b>0.6</b>", *speeds, "0.0", "0.0", "0.0", *fits]  # bold: the paper's value
    assert rows[2][:5] == ["1.2", "7.50 / 4.50*", "–", "–", "–"]  # starts elsewhere; no front
    assert rows[3][1] == "1" and "(mm)" in rows[3][0] and rows[3][6] == "−2.0"
    assert rows[4][1] == "<b>relief</b>" and rows[5][0] == "fillet 2mm"


@pytest.mark.parametrize("kinds", [["svg"], ["png"], ["png", "pdf"]])
def test_kinds_of_pictures_are_chosen(output, monkeypatch, capsys, kinds):
    monkeypatch.setattr(command, "draw_all", lambda results: [criteria.energy(results)])
    assert main([str(output), *(word for kind in kinds for word in ("--format", kind))]) == 0
    files = {f"fig6_energy.{kind}" for kind in kinds} | ({"index.html"} if "png" in kinds else set())
    assert {file.name for file in (output / "figures").iterdir()} == files
    assert str(output / "figures") in capsys.readouterr().out
    if "png" in kinds:
        html = (output / "figures/index.html").read_text(encoding="utf-8")
        assert ('href="fig6_energy.pdf"' in html) == ("pdf" in kinds)


def test_an_unknown_kind_of_picture_is_refused(output):
    with pytest.raises(SystemExit) as refused:
        main([str(output), "--format", "bmp"])
    assert refused.value.code == 2 and not (output / "figures").exists()


def test_folder_without_studies_and_timings_is_drawn(output):
    change_json(output / "analysis.json", lambda analysis: analysis.update(studies=[]))
    (output / "timings.json").unlink()
    assert [drawing.name for drawing in draw_all(read_results(output))] == FIGURES[:-2]
    html = report_of(output)
    assert "Studies</h2>" not in html and "Timings</h2>" not in html


# The paper's figures


@pytest.mark.parametrize("front_id, direction", [(1, -1), (2, 1)])
def test_figure_2_shows_the_speeds_of_the_high_mu_k_run(pristine, drawn, front_id, direction):
    figure = drawn["fig2_static_ratio_mu_k_1.0"].figure
    rows = front_rows(pristine, "spontaneous_mu_k_1.0", front_id)
    counts = counting("spontaneous_mu_k_1.0", rows)
    assert counts.any() and not counts.all() and rows["direction"][0] == direction
    line = artist(figure, f"spontaneous_mu_k_1.0:{front_id}")
    ratio, v = rows["t_s_Pa"] / rows["p_s_Pa"], rows["v_tip_m_per_s"] / C_L
    np.testing.assert_allclose(line.get_xdata(), np.where(counts, ratio, np.nan))
    np.testing.assert_allclose(line.get_ydata(), np.where(counts, v, np.nan))
    for wave in ("c_L", "c_S", "c_R"):
        assert artist(figure, wave).get_ydata()[0] == pytest.approx(WAVE_SPEEDS[f"{wave}_m_per_s"] / C_L)


@pytest.mark.parametrize("run, front_id", [("left", 1), ("spontaneous", 1), ("spontaneous", 2), ("right", 1)])
def test_figures_3_to_6_show_the_three_events(pristine, drawn, run, front_id):
    rows = front_rows(pristine, run, front_id)
    v = rows["v_tip_m_per_s"] / C_L
    dynamic = rows["t_d_Pa"] / rows["p_d_Pa"]
    static = np.divide(rows["t_s_Pa"], rows["p_s_Pa"], out=np.full(len(v), np.nan), where=rows["p_s_Pa"] > 0)
    rise = (rows["U_r_J_per_m3"] - rows["U_s_J_per_m3"]) / rows["U_s_J_per_m3"]
    counts = counting(run, rows)
    before_end = np.abs(rows["x_m"] - rows["x_m"][-1]) > 20.001e-3  # every one of these fronts stops
    assert np.isnan(dynamic).any() and counts.sum() < len(v)
    for name, panel, x, y, shown in (
        ("fig3_three_events", 4, static, v, counts),
        ("fig4_dynamic_ratio", 0, 1e3 * rows["x_m"], dynamic, counts),
        ("fig5_dynamic_criterion", 0, dynamic, v, counts),
        ("fig6_energy", 0, rise, v, counts & before_end),
    ):
        line = artist(drawn[name].figure, f"{run}:{front_id}", panel)
        np.testing.assert_allclose(line.get_xdata(), np.where(shown, x, np.nan))
        np.testing.assert_allclose(line.get_ydata(), np.where(shown, y, np.nan))
    # The last stretch stands by itself in figure 6.
    tail = artist(drawn["fig6_energy"].figure, f"{run}:{front_id}:tail")
    np.testing.assert_allclose(tail.get_ydata(), np.where(counts & ~before_end, v, np.nan))


def test_short_fronts_are_apart_or_left_out(results, drawn):
    run = results.runs["spontaneous"]
    assert [front.id for front in run.front_list] == [1, 2, 3, 4]
    assert [front.id for front in drawn_fronts(run)] == [1, 2, 4]
    assert {front.id for front in main_fronts(run)} == {1, 2}
    names = gids(drawn["fig3_three_events"].figure, panel=4)
    assert not any(name.startswith("spontaneous:3") for name in names)
    assert "spontaneous:4" not in names and "spontaneous:4:other" in names


def test_figure_4_shows_the_static_ratio_and_mu_s(results, drawn):
    figure = drawn["fig4_dynamic_ratio"].figure
    run = results.runs["spontaneous"]
    static = artist(figure, "static")
    np.testing.assert_allclose(static.get_xdata(), 1e3 * run.x_m)
    np.testing.assert_allclose(static.get_ydata(), run.static_ratio)
    assert np.isnan(static.get_ydata()[0])  # no contact at the left edge node
    assert artist(figure, "mu_s").get_ydata()[0] == MU_S


def test_figure_6_shows_our_fit_and_the_papers_band(drawn):
    figure = drawn["fig6_energy"].figure
    fit = artist(figure, "fit")
    r = np.asarray(fit.get_xdata())
    np.testing.assert_allclose(fit.get_ydata(), 0.5 + 1.7 * np.exp(-2.0 * np.sqrt(r)))
    corners = artist(figure, "paper_band").get_paths()[0].vertices
    at_zero = corners[np.isclose(corners[:, 0], 0)][:, 1]
    assert (at_zero.min(), at_zero.max()) == pytest.approx((0.76 + 1.80 - 0.07, 0.76 + 1.80 + 0.07))
    assert not {"fit_interval", "main_fronts_fit"} & gids(figure)  # an older folder has none


def test_figure_6_shows_the_interval_of_our_fit(output):
    r, low, high = [0.1, 0.4, 0.9], [1.2, 0.9, 0.5], [1.6, 1.1, 0.8]
    points = zip(r, [1.4, 1, 0.6], low, high, strict=True)
    curve = [dict(zip(("x", "value", "low", "high"), point, strict=True)) for point in points]
    change_json(output / "analysis.json", lambda analysis: analysis.update(fit_curve=curve))
    corners = artist(criteria.energy(read_results(output)).figure, "fit_interval").get_paths()[0].vertices
    for x, bottom, top in zip(r, low, high, strict=True):
        there = corners[np.isclose(corners[:, 0], x)][:, 1]
        assert (there.min(), there.max()) == pytest.approx((bottom, top))


def test_the_fit_to_the_main_fronts_is_drawn_and_told(output):
    """C18b, whose fit is that of the main fronts."""
    values = {"rms": 0.065, "a": 0.8, "b": 2.14, "c": 3.56}
    row = {"id": "C18b", "claim": "x", "paper": "Fig. 6", "how": "y"}
    row["measured"] = "a = 0.80 [0.71, 0.86] & more"
    row |= {"holds": False, "counts": True, "second_test_of": "C18", "why": "z"}
    row["figures"] = [{"name": name, "value": value, "unit": ""} for name, value in values.items()]
    change_json(output / "scorecard.json", lambda scorecard: scorecard.append(row))
    drawing = criteria.energy(read_results(output))
    curve = artist(drawing.figure, "main_fronts_fit")
    r = np.asarray(curve.get_xdata())
    np.testing.assert_allclose(curve.get_ydata(), 0.8 + 2.14 * np.exp(-3.56 * np.sqrt(r)))
    assert "(C18b): a = 0.80 [0.71, 0.86] &amp; more." in drawing.caption
    html = report_of(output)
    assert rows_under(html, "Fit of the energy criterion") == [
        ["<i>a</i>", "0.500", "0.450 to 0.550", "0.76 ± 0.07", "0.800"],
        ["<i>b</i>", "1.700", "1.500 to 1.900", "1.80", "2.140"],
        ["<i>c</i>", "2.000", "1.800 to 2.200", "3.05", "3.560"],
    ]
    assert 'C18b in the scorecard: "a = 0.80 [0.71, 0.86] &amp; more".' in html
    change_json(output / "scorecard.json", lambda scorecard: scorecard[-1].update(figures=[{"name": "a"}, 1]))
    assert read_results(output).main_fronts_fit is None


def test_figure_6_without_a_fit(output):
    change_json(output / "analysis.json", lambda analysis: analysis.update(fit=None))
    drawing = criteria.energy(read_results(output))
    assert "fit" not in gids(drawing.figure) and "paper_band" in gids(drawing.figure)
    assert "Too few points" in drawing.caption


def test_caption_of_figure_6_has_the_numbers_of_the_file(output):
    new = {"a": (0.11, 0.12, 0.13), "b": (2.21, 2.22, 2.23), "c": (3.31, 3.32, 3.33)}
    fit = {name: dict(zip(("low", "value", "high"), v, strict=True)) for name, v in new.items()}
    paper = {"a": 0.71, "a_band": 0.09, "b": 1.72, "c": 3.73}

    def change(analysis):
        analysis["fit"] |= fit
        analysis["paper_fit"] = paper

    change_json(output / "analysis.json", change)
    caption = criteria.energy(read_results(output)).caption
    assert "a = 0.71 ± 0.09, b = 1.72, c = 3.73" in caption
    assert "a = 0.12 [0.11, 0.13], b = 2.22 [2.21, 2.23], c = 3.32 [3.31, 3.33]" in caption
    told = set(paper.values()) | {number for triple in new.values() for number in triple}
    assert {float(number) for number in re.findall(r"(?<![\w.])\d+\.\d\d(?!\d)", caption)} == told


def test_set_up_shows_maximum_nucleation_and_friction_law(drawn):
    figure = drawn["fig1_setup"].figure
    assert artist(figure, "nucleation").center == pytest.approx((145.0, 0.0))
    assert artist(figure, "maximum", 1).get_xdata()[0] == pytest.approx(145.0)
    for name, mu_k in (("spontaneous", 0.6), ("spontaneous_mu_k_1.0", 1.0)):
        law = artist(figure, name, 2)
        v, mu = np.asarray(law.get_xdata()), np.asarray(law.get_ydata())
        np.testing.assert_allclose(mu, mu_k + (1.3 - mu_k) * np.exp(-v * np.sqrt((1.3 - mu_k) / 0.1)))


def test_snapshots_are_chosen_by_the_fronts_positions(results):
    run = results.runs["left"]
    front = run.front_list[0]
    distance = [abs((front.tip_m(t) or np.inf) - 0.6 * 0.2) for t in run.fields.time_s]
    assert events.choose_step(run) == int(np.argmin(distance))

    run = results.runs["spontaneous"]
    time = run.fields.time_s[events.choose_step(run)]
    positions = [x for _, x in events.tips(run, time)]
    assert len(positions) == 2 and min(positions) > 0.01 and max(positions) < 0.19
    assert abs(time - 32e-6) <= 5e-6  # nucleation at 2 us, snapshots every 10 us


@pytest.mark.parametrize("panel, name", [(0, "left"), (1, "spontaneous"), (2, "right")])
def test_snapshots_show_speeds_starts_and_tips_of_the_step_chosen(results, drawn, panel, name):
    figure, run = drawn["fig3_three_events"].figure, results.runs[name]
    step = events.choose_step(run)
    colours = next(c for c in figure.axes[panel].collections if c.get_array() is not None)
    speed = run.fields.speed_m_per_s(step)
    assert speed.max() > 0.5
    np.testing.assert_allclose(colours.get_array(), speed)
    assert artist(figure, "start", panel).get_xdata()[0] == pytest.approx(1e3 * run.front_list[0].x_m[0])
    tips = events.tips(run, run.fields.time_s[step])
    assert tips
    for front, x_m in tips:
        assert artist(figure, f"tip:{front.id}", panel).get_xdata()[0] == pytest.approx(1e3 * x_m)
        tail, head = artist(figure, f"way:{front.id}", panel)._posA_posB
        assert np.sign(head[0] - tail[0]) == front.direction


def test_tip_is_interpolated_between_onsets(results):
    front = results.runs["left"].front_list[0]
    middle = 0.5 * (front.onset_s[3] + front.onset_s[4])
    assert front.tip_m(middle) == pytest.approx(0.5 * (front.x_m[3] + front.x_m[4]))
    assert front.tip_m(front.onset_s[-1] + 1e-9) is None
    assert front.tip_m(front.onset_s[0] - 1e-9) is None


def test_space_time_shows_onsets_and_slopes_of_the_wave_speeds(pristine, drawn):
    figure = drawn["space_time_right"].figure
    rows = front_rows(pristine, "right", 1)
    line = artist(figure, "right:1")
    np.testing.assert_allclose(line.get_xdata(), 1e3 * rows["x_m"])
    np.testing.assert_allclose(line.get_ydata(), 1e6 * rows["onset_s"])
    for wave in ("c_L", "c_S", "c_R"):
        x, t = artist(figure, f"{wave}:-1").get_data()
        assert (x[0], t[0]) == pytest.approx((1e3 * rows["x_m"][0], 1e6 * rows["onset_s"][0]))
        assert -1e3 * np.diff(x)[0] / np.diff(t)[0] == pytest.approx(WAVE_SPEEDS[f"{wave}_m_per_s"])


def test_space_time_masks_open_contact(results, drawn):
    history = results.runs["left"].history
    x_m, p_Pa, speed = (history[name].to_numpy() for name in ("x_m", "p_Pa", "slip_rate_m_per_s"))
    rate = artist(drawn["space_time_left"].figure, "rate").get_array()
    assert rate.mask[:, x_m < CONTACT_FROM_M].all()
    np.testing.assert_array_equal(rate.mask, p_Pa <= 0)
    fast = ~rate.mask & (np.abs(speed) > 0.1)
    assert fast.any()
    np.testing.assert_allclose(rate[fast], np.abs(speed)[fast])


# The report's tables


def test_report_tells_how_far_the_scorecard_moves(output):
    moved = {"parameter": "plate.element_size_m", "value": 1e-3, "measured": "1584.2", "holds": True}

    def change(scorecard):
        for row, moves in zip(scorecard[:2], ("< 0.001 m/s", ""), strict=True):
            row["mesh_variation"] = moved | {"differences": [0.25], "moves": moves}

    change_json(output / "scorecard.json", change)
    html = report_of(output)
    # Nothing moves in the second, the others were not run.
    assert html.count("With the mesh, moves by") == 1
    assert "With the mesh, moves by &lt; 0.001 m/s." in rows_under(html, "Scorecard")[0][4]
    assert "plate.element_size_m = 0.001" in html


def test_report_tells_which_of_two_verdicts_counts(output):
    second = {"claim": "claim", "paper": "Fig. 1", "measured": "0.5", "how": "better"}

    def change(scorecard):
        for row in scorecard:
            row["counts"] = row["id"] in ("C1", "E1")
        untried = {"id": "C1b", "holds": None, "counts": False, "second_test_of": "C1", "why": "untried"}
        tried = {"id": "C2b", "holds": True, "counts": True, "second_test_of": "C2", "why": "a < b"}
        scorecard += [second | untried, second | tried]

    change_json(output / "scorecard.json", change)
    html = report_of(output)
    rows = rows_under(html, "Scorecard")
    assert [row[0] for row in rows] == ["C1", "E1", "C2b"]
    assert rows[0][3] == "✓" and "Instead of C1: untried" in rows[0][4]  # that was not done
    assert rows[2][3] == "✓" and "Instead of C2: a &lt; b" in rows[2][4]
    assert "✗</span> C2: 0.7123" in rows[2][4]
    assert "Of 3 statements 2 hold (✓), 0 do not (✗), 1 could not be decided (–)." in html
    assert "by the first tests alone 1 hold." in html


def test_what_was_used_to_choose_is_not_counted_as_held(output):
    change_json(output / "scorecard.json", lambda scorecard: scorecard[0].update(used_to_choose=True))
    html = report_of(output)
    assert "Of 3 statements 0 hold (✓), 1 do not (✗)" in html
    assert "Used to choose what the paper leaves open (=): 1." in html
    assert rows_under(html, "Scorecard")[0][3] == "="


def test_statements_of_the_paper_stand_beside_the_scorecards_figures(output):
    claims = {"C18": ("rms 0.123 c_L & more", False), "C18b": ("rms 0.045 c_L", True), "C19": ("77 %", None)}
    rows = [
        {"id": name, "claim": "x", "paper": "Fig. 6", "measured": measured, "holds": holds, "how": "y"}
        for name, (measured, holds) in claims.items()
    ]
    rows[1]["second_test_of"] = "C18"
    (output / "scorecard.json").write_text(json.dumps(rows))
    results = read_results(output)
    html = statements_table(Drawing("fig6_energy", Figure(), ""), results)
    body = re.findall(r"<tr>(.*?)</tr>", html.split("<tbody>")[1])
    said = [statement for statement, _ in STATEMENTS["fig6_energy"]]
    assert [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in body] == [
        [said[0], "rms 0.123 c_L &amp; more", "✗", "C18"],
        ["the same, second test", "rms 0.045 c_L", "✓", "C18b"],
        [said[1], "77 %", "–", "C19"],
    ]
    # Claims that the file lacks.
    assert statements_table(Drawing("fig5_dynamic_criterion", Figure(), ""), results) == ""


def test_statements_are_of_figures_and_claims_that_exist():
    assert STATEMENTS.keys() <= set(FIGURES)
    claims = [claim for statements in STATEMENTS.values() for _, claim in statements]
    assert all(re.fullmatch(r"C([1-9]|1\d|2[0-5])|E1", claim) for claim in claims)


# Energy balance


def test_balance_shows_the_terms_as_changes(results, drawn):
    figure = drawn["energy_balance"].figure
    rows = np.array(energy_rows())
    n = len(results.runs)
    large = {"strain": 1, "friction_work": 7, "damping_work": 9}
    # The small ones over the largest, 101 J/m; terms that do not occur are left out.
    small = {"kinetic": 2.0, "top_work": 0.8, "contact_work": 1e-4, "coupling_work": 0.2, "imbalance": 5e-10}
    for panel, name in enumerate(results.runs):
        assert {g for g in gids(figure, panel) if ":" in g} == {f"{name}:{term}" for term in large}
        for term, column in large.items():
            line = artist(figure, f"{name}:{term}", panel)
            np.testing.assert_allclose(line.get_xdata(), 1e6 * rows[:, 0])
            np.testing.assert_allclose(line.get_ydata(), rows[:, column] - rows[0, column])
        assert {g for g in gids(figure, n + panel) if ":" in g} == {f"{name}:{term}" for term in small}
        for term, last in small.items():
            share = artist(figure, f"{name}:{term}", n + panel).get_ydata()
            assert np.isnan(share[0]) and share[-1] == pytest.approx(last / 101, rel=1e-4)


def test_balance_of_results_from_before_there_were_machines(output):
    machine = ENERGY_HEADER.index("machine_J_per_m")
    header, *rows = ([*row[:machine], *row[machine + 1 :]] for row in [ENERGY_HEADER, *energy_rows()])
    before = read_results(output).runs["left"].balance
    write_csv(output / "left" / "energy.csv", header, rows)
    now = read_results(output).runs["left"].balance
    for term, values in before.terms.items():
        np.testing.assert_array_equal(now.terms[term], values)


def test_caption_of_the_balance_has_the_imbalance_of_the_worst_row(output, drawn):
    caption = drawn["energy_balance"].caption
    assert "left-triggered: largest change 101 J/m, imbalance at most 5.0e-10 J/m or 5.0e-12 of it" in caption
    assert "coupling at the end 0.2 J/m" in caption
    rows = energy_rows()
    rows[2][-1] = -0.0101
    write_csv(output / "left" / "energy.csv", ENERGY_HEADER, rows)
    caption = {d.name: d for d in draw_all(read_results(output))}["energy_balance"].caption
    assert "left-triggered: largest change 101 J/m, imbalance at most 1.0e-02 J/m or 1.0e-04 of it" in caption


@pytest.mark.parametrize("still", [False, True])
def test_single_run_has_its_balance(output, capsys, still):
    run = output / "left"
    if still:
        write_csv(run / "energy.csv", ENERGY_HEADER, [[0] * 13, [1e-6] + [0] * 12])
    assert draw_run([str(run)]) == 0
    assert {file.name for file in (run / "figures").iterdir()} == {"energy_balance.png", "energy_balance.pdf"}
    assert (run / "figures/energy_balance.pdf").read_bytes()[:5] == b"%PDF-"
    assert str(run / "figures" / "energy_balance.png") in capsys.readouterr().out


# Studies: two panels each


def test_studies_show_speeds_and_changes(drawn):
    figure = drawn["studies"].figure
    for gid, y in (
        ("max:spontaneous:-1", [2.0, 1.5, np.nan]),
        ("max:spontaneous:1", [1.8, 1.35, np.nan]),
        ("mean:right:-1", [1.44, 1.08, np.nan]),
        ("max:left:1", [1.6, 1.2, np.nan]),  # the third starts elsewhere
        ("other:left:1", [np.nan, np.nan, np.nan]),  # and lies above the axis
    ):
        np.testing.assert_allclose(artist(figure, gid, 0).get_ydata(), y)
    np.testing.assert_allclose(artist(figure, "change:spontaneous", 1).get_ydata(), [9, 0, np.nan])


def test_studies_of_criteria_mark_the_papers_value(drawn):
    figure = drawn["studies_criteria"].figure
    assert artist(figure, "paper_value", 0).get_xdata()[0] == 1
    assert "paper_value" not in gids(figure, 2)  # 5 mm in the synthetic runs, not among the values
    assert artist(figure, "paper_value", 4).get_xdata()[0] == 0
    np.testing.assert_allclose(artist(figure, "rms").get_ydata(), [0.11, 0.11, np.nan])
    np.testing.assert_allclose(artist(figure, "spread:t_s_over_p_s", 1).get_ydata(), 0.31)
    assert np.isnan(artist(figure, "spread:energy", 1).get_ydata()).all()


def test_values_of_runs_that_differ_are_marked_by_run(output):
    """The study of the mesh becomes one of the trigger zone, in which the edges' runs differ."""

    def change(analysis):
        study = analysis["studies"][1]
        study |= {"name": "trigger_zone", "parameter": "event.trigger_zone_m"}
        (point,) = study["points"]
        study["points"] = [point | {"value": str(v), "number": v} for v in (0.005, 0.01, 0.015)]

    change_json(output / "analysis.json", change)
    for name, zone_m in (("left", 15e-3), ("right", 5e-3), ("spontaneous", 7e-3)):
        case = output / name / "case.resolved.toml"
        replace(case, "trigger_zone_m = 10e-3", f"trigger_zone_m = {zone_m}")
    results = read_results(output)
    for draw in (studies.speeds, studies.criteria):
        figure = draw(results).figure
        for event, index in (("left", 2), ("right", 0)):
            assert artist(figure, f"paper_value:{event}", 2).get_xdata()[0] == index
        assert not {"paper_value", "paper_value:spontaneous"} & gids(figure, 2)
        assert "paper_value" in gids(figure, 0)
    html = report_of(output)
    for value, run in ((15, "left"), (5, "right")):
        assert f'<td><b>{value}</b> <span class="note">{run}</span></td>' in html


# Missing data


def test_run_without_fronts_is_drawn(output):
    for name in ("left", "spontaneous", "spontaneous_mu_k_1.0"):
        change_front_cells(output / name / "fronts.csv", lambda row: None)
    drawings = draw_all(read_results(output))
    assert [drawing.name for drawing in drawings] == FIGURES
    assert not any(gid.startswith("spontaneous") for gid in gids(drawings[1].figure))
    assert all(drawing.rendered("png") for drawing in drawings[:7])


def test_lines_break_at_empty_cells(output):
    def with_hole(row):
        return row | {"v_tip_m_per_s": "", "t_d_Pa": ""} if abs(float(row["x_m"]) - 0.1) < 1e-6 else row

    change_front_cells(output / "left" / "fronts.csv", with_hole)
    line = artist(criteria.dynamic_criterion(read_results(output)).figure, "left:1")
    (at,) = np.flatnonzero(np.abs(front_rows(output, "left", 1)["x_m"] - 0.1) < 1e-6)
    points = np.column_stack(line.get_data())
    assert np.isnan(points[at]).all() and np.isfinite(points[at + 1]).all()


# Errors: one clear line, exit code 2


MISSING = [
    "left/fronts.csv", "left/interface.h5", "left/energy.csv", "left/static.csv", "left/run.json",
    "left/case.resolved.toml", "scorecard.json", "analysis.json",
]  # fmt: skip


@pytest.mark.parametrize("file", MISSING)
def test_a_missing_file_gives_one_line(output, capsys, file):
    (output / file).unlink()
    assert f"{output / file}: No such file" in one_error(capsys, output)
    assert not (output / "figures").exists()


def test_a_link_in_place_of_the_figures_is_not_followed(output, tmp_path_factory, capsys):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (output / "figures").symlink_to(elsewhere)
    assert f"{output / 'figures'}: is a link, which is not followed" in one_error(capsys, output)
    assert list(elsewhere.iterdir()) == []


def test_a_missing_folder_gives_one_line(output, capsys):
    shutil.rmtree(output / "right")
    assert f"{output / 'right'}: no such folder" in one_error(capsys, output)
    assert "nowhere: no such folder" in one_error(capsys, output / "nowhere")


HOLDS = '"holds": true'


@pytest.mark.parametrize(
    "file, old, new, says",
    [
        ("left/energy.csv", "coupling_work", "other_work", "no column 'coupling_work_J_per_m'"),
        ("left/energy.csv", "380.0,", ",", "in column 'strain_J_per_m'"),
        ("left/fronts.csv", "t_d_Pa", "t_x_Pa", "no column 't_d_Pa'"),
        ("left/fronts.csv", "\n1,", "\none,", "fronts.csv:2: 'one' in column 'front_id'"),
        ("left/fronts.csv", ",1,", ",0,", "column 'direction'"),
        ("left/static.csv", "x_m,", "x_m,more,", "static.csv:2: 3 cells, the header has 4"),
        ("left/case.resolved.toml", "title =", "title = =", "not TOML"),
        ("spontaneous/case.resolved.toml", "mu_k =", "mu_x =", "'friction.mu_k'"),
        ("left/run.json", "{", "[{", "not JSON"),
        ("left/run.json", '"statics"', '"dynamics"', "'statics.inside_from_m'"),
        ("left/run.json", "c_L_m", "c_X_m", "'wave_speeds.c_L_m_per_s'"),
        ("scorecard.json", '"claim"', '"blame"', "entry 1 has no 'claim'"),
        ("scorecard.json", HOLDS, f'{HOLDS}, "counts": 1', "'counts' is not true or false"),
        ("scorecard.json", HOLDS, f'{HOLDS}, "second_test_of": null', "'second_test_of' is not a text"),
        ("analysis.json", '"paper_fit"', '"other_fit"', "'paper_fit.a'"),
        ("analysis.json", '"speed_change": {"median"', '"speed_change": {"x"', "1 has"),
        ("analysis.json", '"points": [', '"points": [3, ', "study 1 is not as"),
        ("analysis.json", '"studies": ', '"fit_curve": [3], "studies": ', "'fit_curve'"),
        ("timings.json", '"wall_s"', '"wall"', "'wall_s'"),
    ],
)
def test_damaged_text_gives_one_line(output, capsys, file, old, new, says):
    replace(output / file, old, new)
    error = one_error(capsys, output)
    assert str(output / file) in error and says in error
    assert not (output / "figures").exists()


@pytest.mark.parametrize(
    "file, dataset",
    [
        ("left/interface.h5", "slip_rate_m_per_s"),
        ("left/interface.h5", "p_Pa"),
        ("left/fields.vtkhdf", "VTKHDF/Steps/Values"),
    ],
)
def test_damaged_hdf5_gives_one_line(output, capsys, file, dataset):
    with h5py.File(output / file, "r+") as hdf5:
        del hdf5[dataset]
    error = one_error(capsys, output)
    assert str(output / file) in error and f"'{dataset.removeprefix('VTKHDF/')}'" in error
    (output / file).write_text("text")
    assert f"{output / file}: damaged, or not an HDF5 file" in one_error(capsys, output)


def test_snapshots_that_are_none_give_one_line(output, capsys):
    write_fields(output / "right" / "fields.vtkhdf", 40, 20, np.array([]), [])
    assert "right/fields.vtkhdf: no snapshots" in one_error(capsys, output)
