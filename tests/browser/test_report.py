# SPDX-License-Identifier: BSD-3-Clause
"""Pages of `slipfront report` in a real browser (`make report-trial`): they draw, and what is marked in one
plot is marked in all. Screenshots go to the folder that SLIPFRONT_SCREENSHOTS names."""

import os
import sys
from pathlib import Path

import pytest
from common import HANG_S, ROOT, WITH_PACKAGE, built, call, require_done, sets, wait_until
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

CASES = {
    "probes": ["cases/reference/gauges.toml"],
    "one body": ["papers/kammer2012/left.toml", *sets("plate.element_size_m=2e-3", "fronts.l_star_m=2e-3")],
    "two bodies": [
        "cases/reference/bimaterial_f.toml",
        *sets("plate.element_size_m=2e-3", "output.history_interval_s=1e-6"),
        *sets("output.snapshot_times_s=[5e-5, 1e-4, 1.5e-4]"),
        *sets("probes.x_m=[0.251, 0.301]", "probes.y_m=[0.005, -0.005]"),
    ],
}


SEQUENCE = [
    "papers/kammer2012/spontaneous.toml",
    *sets("plate.element_size_m=4e-3", "fronts.l_star_m=4e-3", "time.end_s=20e-3", "sequence.max_events=3"),
]
STICK_SLIP = ["examples/stick-slip/case.toml", *sets("plate.element_size_m=8e-3", "sequence.max_events=3")]
STABLE = [*STICK_SLIP, *sets("friction.a=0.02", "sequence.end_s=300", "friction.d_c_m=1e-5")]
PLOTS = {  # of other pages those of a run
    "sequence": ("forces", "extents", "slips"),
    "stick-slip": ("forces", "extents", "slips", "phases"),
    "stable sliding": ("forces", "phases"),
}
SWEPT = ["--vary", "friction.mu_k=0.5,0.7", "--vary", "event.trigger_zone_m=0.02,0.03"]


def data(plot):
    """What a plot draws, in the page's language."""
    return f"document.getElementById('{plot}-plot').data"


def mark(plot):
    """The mark's x and y in each panel."""
    return f"return {data(plot)}.filter(t => t.meta?.mark).map(t => [t.x[0], t.y[0]])"


FRONTS = f"{data('criteria')}.filter(t => t.meta?.front !== undefined)"


@pytest.fixture(scope="session")
def pages(tmp_path_factory):
    """Pages of a run on a rigid plane, of one of two bodies, of a reproduction, a sweep and sequences."""
    folder = tmp_path_factory.mktemp("pages")
    commands = {name: ["run", *case, "--quiet"] for name, case in CASES.items()}
    commands["reproduction"] = ["reproduce", "--quick"]
    commands["sequence"] = ["run", *SEQUENCE, "--quiet"]
    commands["stick-slip"] = ["run", *STICK_SLIP, "--quiet"]
    commands["stable sliding"] = ["run", *STABLE, "--quiet"]
    commands["sweep"] = ["sweep", *CASES["probes"], *SWEPT, "--quiet"]
    found = {}
    for name, command in commands.items():
        results = folder / name.replace(" ", "_")
        is_paper = name == "reproduction"
        report = [sys.executable, "papers/kammer2012/report.py"] if is_paper else [built(), "report"]
        for words in ([built(), *command, "-o", results], [*report, results]):
            require_done(call(*words, cwd=ROOT, env=WITH_PACKAGE))
        found[name] = results / "report.html"
    return found


@pytest.fixture(scope="session")
def browser():
    options = webdriver.ChromeOptions()
    for argument in ("headless=new", "no-sandbox", "window-size=1366,900", "force-color-profile=srgb"):
        options.add_argument(f"--{argument}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    driver.set_page_load_timeout(HANG_S)
    driver.set_script_timeout(HANG_S)
    yield driver
    driver.quit()


@pytest.fixture
def opened(browser, pages):
    """Opens a page and waits until it is drawn."""

    def open_page(name):
        browser.get_log("browser")
        browser.get(pages[name].as_uri())
        wait_until(lambda: browser.execute_script("return document.body.dataset.drawn"))
        assert browser.execute_script("return document.body.dataset.drawn") == "all"
        return browser

    return open_page


def screenshot(browser, name):
    folder = os.environ.get("SLIPFRONT_SCREENSHOTS")
    if not folder:
        return
    Path(folder).mkdir(parents=True, exist_ok=True)
    height = browser.execute_script("return document.documentElement.scrollHeight")
    browser.set_window_size(1366, min(height, 12000) + 150)
    browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => setTimeout(done))")
    browser.save_screenshot(str(Path(folder) / f"{name.replace(' ', '_')}.png"))
    browser.set_window_size(1366, 900)


def point_in(browser, plot, x, y):
    """Moves the mouse to a place of a plot, given in the units of its axes."""
    element = browser.find_element(By.ID, plot)
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
    left, top = browser.execute_script(
        "const {xaxis: x, yaxis: y} = arguments[0]._fullLayout;"
        "return [x._offset + x.d2p(arguments[1]), y._offset + y.d2p(arguments[2])]",
        *(element, x, y),
    )
    from_centre = round(left - element.size["width"] / 2), round(top - element.size["height"] / 2)
    ActionChains(browser).move_to_element_with_offset(element, *from_centre).perform()


def change(browser, control, value, event):
    """Gives a control another value; `value` may speak of it as s."""
    element = f"const s = document.getElementById('{control}'); s.value = {value};"
    browser.execute_script(f"{element} s.dispatchEvent(new Event('{event}'))")


@pytest.mark.parametrize("name", [*CASES, "reproduction", "sequence", "stick-slip", "stable sliding"])
def test_a_page_draws_without_errors_and_without_a_network(opened, name):
    browser = opened(name)
    assert browser.get_log("browser") == []
    requests = [
        entry["message"]
        for entry in browser.get_log("performance")
        if "Network.requestWillBeSent" in entry["message"]
    ]
    assert not any('"url":"http' in message for message in requests)
    for plot in PLOTS.get(name, ("space-time", "profiles", "criteria", "energy", "snapshots")):
        drawn = browser.find_elements(By.CSS_SELECTOR, f"#{plot}-plot .main-svg")
        assert drawn, plot
    assert browser.execute_script("return document.documentElement.scrollWidth") <= 1366
    screenshot(browser, name)


def test_a_node_that_is_pointed_at_is_marked_everywhere(opened):
    browser = opened("one body")
    front = browser.execute_script(
        f"const t = {FRONTS}[0], k = t.y.findLastIndex(v => v > 0.7); return [t.x[k], t.y[k]]"
    )
    point_in(browser, "criteria-plot", *front)
    wait_until(lambda: browser.execute_script(mark("criteria"))[0][0] is not None)
    marks = browser.execute_script(mark("criteria"))
    words = browser.find_element(By.ID, "criteria-point").text
    assert len(marks) == 4 and len({y for _, y in marks}) == 1 and "V_tip" in words
    here = browser.execute_script(
        f"const t = {FRONTS}, k = t[0].x.indexOf(arguments[0]); return t.map(t => [t.x[k], t.y[k]])",
        marks[0][0],
    )
    assert here == marks
    assert browser.execute_script(mark("space-time"))[0][0] == marks[0][0]
    energy, speed = browser.execute_script(mark("fracture"))
    assert energy[0] == speed[0] == marks[0][0] and speed[1] == marks[0][1] and energy[1] > 0


def test_points_selected_in_one_panel_are_selected_in_all(opened):
    browser = opened("one body")
    browser.execute_script(
        f"const data = {FRONTS}[0], p = document.getElementById('criteria-plot');"
        "p.emit('plotly_selected', {points: [3, 5].map(pointNumber => ({data, pointNumber}))})"
    )
    selected = f"return {data('criteria')}.filter(t => t.meta?.front === 0).map(t => t.selectedpoints)"
    assert browser.execute_script(selected) == [[3, 5]] * 4


def test_the_slider_changes_the_curves_and_the_line_in_the_diagram(opened):
    browser = opened("one body")
    curve = f"return Array.from({data('profiles')}.at(-3).y)"
    line = "return document.getElementById('space-time-plot').layout.shapes[0].y0"
    before, time_before = browser.execute_script(curve), browser.execute_script(line)
    change(browser, "profiles-time", "Number(s.value) + 20", "input")
    assert browser.execute_script(curve) != before
    now = browser.execute_script(line)
    assert now > time_before
    assert float(browser.find_element(By.ID, "profiles-now").text.split()[0]) == pytest.approx(now, rel=1e-2)
    browser.find_element(By.ID, "profiles-keep").click()
    number = f"return {data('profiles')}.length"
    kept = browser.execute_script(number)
    browser.find_element(By.ID, "profiles-clear").click()
    assert browser.execute_script(number) == kept - 2


def test_the_diagram_shows_the_field_that_is_chosen(opened):
    browser = opened("two bodies")
    name = f"return {data('space-time')}[0].name"
    for field in ("ratio", "p", "slip", "slip_rate"):
        browser.find_element(By.CSS_SELECTOR, f"[data-field={field}]").click()
        wait_until(lambda field=field: browser.execute_script(name) == field)
        pressed = browser.find_elements(By.CSS_SELECTOR, "[data-field][aria-pressed=true]")
        assert [button.get_attribute("data-field") for button in pressed] == [field]
    assert browser.get_log("browser") == []


def test_the_snapshots_play_and_show_both_bodies(opened):
    browser = opened("two bodies")
    low, high = browser.execute_script(f"const y = {data('snapshots')}[0].y; return [y[0], y.at(-1)]")
    assert low < -140 and high > 140
    darkest = "return document.getElementById('snapshots-plot')._fullData[0].colorscale[0]"
    assert browser.execute_script(darkest) == [0, "#000004"]  # the page's own scale was understood
    now = browser.find_element(By.ID, "snapshots-now")
    before = now.text
    button = browser.find_element(By.ID, "snapshots-play")
    browser.execute_script("arguments[0].click()", button)
    wait_until(lambda: now.text != before)
    browser.execute_script("arguments[0].click()", button)
    assert button.text == "play"


def test_the_records_of_probes_are_chosen(opened):
    browser = opened("probes")
    title = "return document.getElementById('probes-plot').layout.yaxis.title.text"
    first = f"return {data('probes')}.filter(t => t.meta.panel === 0).map(t => t.y[0])"
    assert "v<sub>x</sub> (m/s)" in browser.execute_script(title)
    button = browser.find_element(By.CSS_SELECTOR, "[data-probes=stress]")
    browser.execute_script("arguments[0].click()", button)
    wait_until(lambda: "σ<sub>xx</sub> (MPa)" in browser.execute_script(title))
    assert button.get_attribute("aria-pressed") == "true"
    before = browser.execute_script(first)
    assert len(before) == 5 and all(abs(value) > 0.1 for value in before)
    browser.execute_script("document.getElementById('probes-change').click()")
    wait_until(lambda: browser.execute_script(first) == [0] * 5)
    assert browser.get_log("browser") == []


def test_prescribed_tractions_have_absolute_stress_and_changes(opened):
    """Of uniform ones: -p and t before anything has changed; sigma_xx and strain as changes alone."""
    browser = opened("two bodies")
    titles = (
        "const l = document.getElementById('probes-plot').layout;"
        "return [l.yaxis, l.yaxis2, l.yaxis3].map(a => a.title.text)"
    )
    first = f"return [0, 1, 2].map(k => {data('probes')}.find(t => t.meta.panel === k).y[0])"
    browser.execute_script("document.querySelector('[data-probes=stress]').click()")
    whole = ["Δσ<sub>xx</sub> (MPa)", "σ<sub>yy</sub> (MPa)", "σ<sub>xy</sub> (MPa)"]
    wait_until(lambda: browser.execute_script(titles) == whole)
    assert browser.execute_script(first) == pytest.approx([0, -5, 2.1])
    browser.execute_script("document.getElementById('probes-change').click()")
    wait_until(lambda: all(title.startswith("Δ") for title in browser.execute_script(titles)))
    assert browser.execute_script(first) == [0, 0, 0]


def test_the_criteria_are_folded_under_uniform_tractions(opened):
    browser = opened("two bodies")
    panels = f"return new Set({FRONTS}.map(t => t.xaxis)).size"
    assert browser.execute_script(panels) == 1
    browser.execute_script("document.getElementById('criteria-more').click()")
    wait_until(lambda: browser.execute_script(panels) == 3)  # the static ratio is one number
    assert browser.get_log("browser") == []


def test_a_sweep_has_values_in_its_cells_and_lines(browser, pages):
    browser.get_log("browser")
    browser.get(pages["sweep"].as_uri())
    wait_until(lambda: browser.execute_script("return document.body.dataset.sweep"))
    (drawn,) = browser.execute_script(f"return {data('sweep')}.map(t => [t.type, t.texttemplate, t.x, t.y])")
    assert drawn == ["heatmap", "%{text}", [20, 30], [0.5, 0.7]]  # mm, and mu_k
    cells = browser.execute_script(f"return {data('sweep')}[0].text.flat()")
    rows = browser.find_elements(By.CSS_SELECTOR, "#sweep tbody tr")
    assert len(rows) == len(cells) == 4 and all(any(cell in row.text for row in rows) for cell in cells)
    change(browser, "sweep-y", "''", "change")
    lines = f"return {data('sweep')}.map(t => [t.mode, t.name, t.x])"
    expected = [["lines+markers", f"mu_k: {mu_k}", [20, 30]] for mu_k in (0.5, 0.7)]
    wait_until(lambda: browser.execute_script(lines) == expected)
    assert browser.get_log("browser") == []


def test_the_snapshots_open_where_something_moves(opened):
    browser = opened("probes")
    slowest, fastest = browser.execute_script(
        f"const z = {data('snapshots')}[0].z.flat().filter(v => v !== null);"
        "return [Math.min(...z), Math.max(...z)]"
    )
    assert fastest > 120 > slowest
    assert int(browser.find_element(By.ID, "snapshots-time").get_attribute("value")) > 0


def test_a_front_has_one_colour_in_all_plots(opened):
    browser = opened("two bodies")

    def colours(plot, drawn):
        return browser.execute_script(
            f"const d = {data(plot)}.filter(t => t.meta?.front !== undefined);"
            f"return Object.fromEntries(d.map(t => [t.meta.front, t.{drawn}.color]))"
        )

    lines = colours("space-time", "line")
    assert len(set(lines.values())) == 2  # one for each direction
    assert lines == colours("criteria", "marker")


def test_another_run_of_a_reproduction_is_shown(opened):
    browser = opened("reproduction")
    x = f"return {data('space-time')}.find(t => t.meta?.front !== undefined).x[0]"
    left = browser.execute_script(x)
    change(browser, "run", "'2'", "change")
    wait_until(lambda: browser.execute_script(x) > 100)
    assert left < 50 and browser.get_log("browser") == []
