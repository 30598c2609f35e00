# SPDX-License-Identifier: BSD-3-Clause
"""Pages of `slipfront report` in a real browser (`make report-trial`): they draw, and what is marked in one
plot is marked in all. Screenshots go to the folder that SLIPFRONT_SCREENSHOTS names."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from shared import HANG_S

ROOT = Path(__file__).parents[2]
PROGRAM = os.environ.get("SLIPFRONT", ROOT / "build/release/slipfront")
CASES = {
    "probes": ("cases/reference/gauges.toml", []),
    "one body": (
        "papers/kammer2012/left.toml",
        ["plate.element_size_m=2e-3", "fronts.l_star_m=2e-3"],
    ),
    "two bodies": (
        "cases/reference/bimaterial_f.toml",
        [
            "plate.element_size_m=2e-3",
            "output.history_interval_s=1e-6",
            "output.snapshot_times_s=[5e-5, 1e-4, 1.5e-4]",
        ],
    ),
}
#: Traces of the space-time diagram: the mark's x and y.
MARK = (
    "return document.getElementById(arguments[0]).data.filter(t => t.meta?.mark).map(t => [t.x[0], t.y[0]])"
)


def call(*arguments):
    environment = {**os.environ, "SLIPFRONT_PYTHON": sys.executable}
    subprocess.run(
        [PROGRAM, *map(str, arguments)],
        cwd=ROOT,
        env=environment,
        check=True,
        capture_output=True,
        timeout=HANG_S,
    )


@pytest.fixture(scope="session")
def pages(tmp_path_factory):
    """Pages of a run on a rigid plane, of one of two bodies, and of a reproduction."""
    folder = tmp_path_factory.mktemp("pages")
    found = {}
    for name, (case, settings) in CASES.items():
        results = folder / name.replace(" ", "_")
        call("run", case, "-o", results, "--quiet", *(word for s in settings for word in ("--set", s)))
        found[name] = results
    call("reproduce", "--quick", "-o", folder / "reproduction")
    found["reproduction"] = folder / "reproduction"
    for results in found.values():
        call("report", results)
    return {name: results / "report.html" for name, results in found.items()}


@pytest.fixture(scope="session")
def browser():
    options = webdriver.ChromeOptions()
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--window-size=1366,900",
        "--force-color-profile=srgb",
    ):
        options.add_argument(argument)
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
        wait(lambda: browser.execute_script("return document.body.dataset.drawn"))
        assert browser.execute_script("return document.body.dataset.drawn") == "all"
        return browser

    return open_page


def wait(condition):
    end = time.monotonic() + HANG_S
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


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


def point_in(browser, plot, x, y, axis=""):
    """Moves the mouse to a place of a plot, given in the units of its axes."""
    element = browser.find_element(By.ID, plot)
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
    left, top = browser.execute_script(
        "const p = arguments[0]._fullLayout, x = p['xaxis' + arguments[3]], y = p['yaxis' + arguments[3]];"
        "return [x._offset + x.d2p(arguments[1]), y._offset + y.d2p(arguments[2])]",
        *(element, x, y, axis),
    )
    size = element.size
    actions = ActionChains(browser)
    actions.move_to_element_with_offset(
        element, round(left - size["width"] / 2), round(top - size["height"] / 2)
    )
    return actions


@pytest.mark.parametrize("name", [*CASES, "reproduction"])
def test_a_page_draws_without_errors_and_without_a_network(opened, name):
    browser = opened(name)
    assert browser.get_log("browser") == []
    requests = [
        entry["message"]
        for entry in browser.get_log("performance")
        if "Network.requestWillBeSent" in entry["message"]
    ]
    assert not any('"url":"http' in message for message in requests)
    for plot in ("space-time", "profiles", "criteria", "energy", "snapshots"):
        drawn = browser.find_elements(By.CSS_SELECTOR, f"#{plot}-plot .main-svg")
        assert drawn, plot
    assert browser.execute_script("return document.documentElement.scrollWidth") <= 1366
    screenshot(browser, name)


def test_a_node_that_is_pointed_at_is_marked_everywhere(opened):
    browser = opened("one body")
    front = browser.execute_script(
        "const t = document.getElementById('criteria-plot').data.filter(t => t.meta?.front !== undefined);"
        "const k = t[0].y.findLastIndex(v => v > 0.7); return t.map(t => [t.x[k], t.y[k]])"
    )
    point_in(browser, "criteria-plot", *front[0]).perform()
    wait(lambda: browser.execute_script(MARK, "criteria-plot")[0][0] is not None)
    marks = browser.execute_script(MARK, "criteria-plot")
    words = browser.find_element(By.ID, "criteria-point").text
    assert len(marks) == 4 and len({y for _, y in marks}) == 1 and "V_tip" in words
    here = browser.execute_script(
        "const [x] = arguments; const t = document.getElementById('criteria-plot').data"
        ".filter(t => t.meta?.front !== undefined); const k = t[0].x.indexOf(x);"
        "return t.map(t => [t.x[k], t.y[k]])",
        marks[0][0],
    )
    assert here == marks
    assert browser.execute_script(MARK, "space-time-plot")[0][0] == marks[0][0]


def test_points_selected_in_one_panel_are_selected_in_all(opened):
    browser = opened("one body")
    browser.execute_script(
        "const p = document.getElementById('criteria-plot');"
        "const data = p.data.find(t => t.meta?.front !== undefined);"
        "p.emit('plotly_selected', {points: [3, 5].map(pointNumber => ({data, pointNumber}))})"
    )
    selected = browser.execute_script(
        "return document.getElementById('criteria-plot').data.filter(t => t.meta?.front === 0)"
        ".map(t => t.selectedpoints)"
    )
    assert selected == [[3, 5]] * 4


def test_the_slider_changes_the_curves_and_the_line_in_the_diagram(opened):
    browser = opened("one body")
    curve = "return Array.from(document.getElementById('profiles-plot').data.at(-3).y)"
    line = "return document.getElementById('space-time-plot').layout.shapes[0].y0"
    before, time_before = browser.execute_script(curve), browser.execute_script(line)
    browser.execute_script(
        "const s = document.getElementById('profiles-time'); s.value = Number(s.value) + 20;"
        "s.dispatchEvent(new Event('input'))"
    )
    assert browser.execute_script(curve) != before
    now = browser.execute_script(line)
    assert now > time_before
    assert float(browser.find_element(By.ID, "profiles-now").text.split()[0]) == pytest.approx(now, rel=1e-2)
    browser.find_element(By.ID, "profiles-keep").click()
    kept = browser.execute_script("return document.getElementById('profiles-plot').data.length")
    browser.find_element(By.ID, "profiles-clear").click()
    assert browser.execute_script("return document.getElementById('profiles-plot').data.length") == kept - 2


def test_the_diagram_shows_the_field_that_is_chosen(opened):
    browser = opened("two bodies")
    name = "return document.getElementById('space-time-plot').data[0].name"
    for field in ("ratio", "p", "slip", "slip_rate"):
        browser.find_element(By.CSS_SELECTOR, f"[data-field={field}]").click()
        wait(lambda field=field: browser.execute_script(name) == field)
        pressed = browser.find_elements(By.CSS_SELECTOR, "[aria-pressed=true]")
        assert [button.get_attribute("data-field") for button in pressed] == [field]
    assert browser.get_log("browser") == []


def test_the_snapshots_play_and_show_both_bodies(opened):
    browser = opened("two bodies")
    low, high = browser.execute_script(
        "const y = document.getElementById('snapshots-plot').data[0].y; return [y[0], y.at(-1)]"
    )
    assert low < -140 and high > 140
    darkest = "return document.getElementById('snapshots-plot')._fullData[0].colorscale[0]"
    assert browser.execute_script(darkest) == [0, "#000004"]  # the page's own scale was understood
    now = browser.find_element(By.ID, "snapshots-now")
    before = now.text
    button = browser.find_element(By.ID, "snapshots-play")
    browser.execute_script("arguments[0].click()", button)
    wait(lambda: now.text != before)
    browser.execute_script("arguments[0].click()", button)
    assert button.text == "play"


def test_the_records_of_probes_are_chosen(opened):
    browser = opened("probes")
    title = "return document.getElementById('probes-plot').layout.yaxis.title.text"
    first = (
        "return document.getElementById('probes-plot').data.filter(t => t.meta.panel === 0).map(t => t.y[0])"
    )
    assert "v<sub>x</sub> (m/s)" in browser.execute_script(title)
    button = browser.find_element(By.CSS_SELECTOR, "[data-probes=stress]")
    browser.execute_script("arguments[0].click()", button)
    wait(lambda: "σ<sub>xx</sub> (MPa)" in browser.execute_script(title))
    assert button.get_attribute("aria-pressed") == "true"
    before = browser.execute_script(first)
    assert len(before) == 5 and all(abs(value) > 0.1 for value in before)
    browser.execute_script("document.getElementById('probes-change').click()")
    wait(lambda: browser.execute_script(first) == [0] * 5)
    assert browser.get_log("browser") == []


def test_the_snapshots_open_where_something_moves(opened):
    browser = opened("probes")
    slowest, fastest = browser.execute_script(
        "const z = document.getElementById('snapshots-plot').data[0].z.flat().filter(v => v !== null);"
        "return [Math.min(...z), Math.max(...z)]"
    )
    assert fastest > 120 > slowest
    assert int(browser.find_element(By.ID, "snapshots-time").get_attribute("value")) > 0


def test_a_front_has_one_colour_in_all_plots(opened):
    browser = opened("two bodies")
    colours = (
        "const d = document.getElementById(arguments[0]).data.filter(t => t.meta?.front !== undefined);"
        "return Object.fromEntries(d.map(t => [t.meta.front, t[arguments[1]].color]))"
    )
    lines = browser.execute_script(colours, "space-time-plot", "line")
    assert len(set(lines.values())) == 2  # one for each direction
    assert lines == browser.execute_script(colours, "criteria-plot", "marker")


def test_another_run_of_a_reproduction_is_shown(opened):
    browser = opened("reproduction")
    data = "document.getElementById('space-time-plot').data"
    x = f"return {data}.find(t => t.meta?.front !== undefined).x[0]"
    left = browser.execute_script(x)
    browser.execute_script(
        "const s = document.getElementById('run'); s.value = '2'; s.dispatchEvent(new Event('change'))"
    )
    wait(lambda: browser.execute_script(x) > 100)
    assert left < 50 and browser.get_log("browser") == []
