# SPDX-License-Identifier: BSD-3-Clause
"""The console script, `slipfront fronts`, the types of the compiled module, the page of the package."""

from __future__ import annotations

import re
import shutil
import sys

import numpy as np
import pytest
from common import ROOT, WITH_PACKAGE, built, call, refusal, require_done, rows_of
from package_cases import write_case
from refusals import one_line
from slipfront import fronts_command
from slipfront.__main__ import main

ONSETS = "# camera 3\nx_m,time_s\n" + "".join(f"{k * 2e-3},{abs(k - 20) * 2e-6}\n" for k in range(51))


@pytest.fixture
def onsets(tmp_path):
    file = tmp_path / "onsets.csv"
    file.write_text(ONSETS)
    return file


def test_fronts_of_an_experiment(onsets, tmp_path, capsys):
    out = tmp_path / "fronts.csv"
    assert main(["fronts", str(onsets), "-o", str(out), "--c-l-m-per-s", "2000"]) == 0
    lines = capsys.readouterr().out.splitlines()
    # The place where both begin is on neither line. Slopes of lines through 20 and 30 times right to 0.5 us
    # are right to 1/26.6 and 1/39.96 of 1 us/mm.
    low, high = (f"speed 1000 m/s, {interval} (0.50 c_L)" for interval in ("963.8 to 1039", "975.6 to 1026"))
    assert lines == [
        f"front 0: x = 0.0400 to 0.0000 m, 0.0 to 40.0 us, {low}, ends: record_edge",
        f"front 1: x = 0.0400 to 0.1000 m, 0.0 to 60.0 us, {high}, ends: record_edge",
        "--l-star-m 0.002, --arrest-time-s 2e-05, --min-length-m 0.004; intervals of speeds: times right to "
        "half of 1e-06 s",
    ]
    found = rows_of(out)
    speeds = ["speed_m_per_s", "speed_low_m_per_s", "speed_high_m_per_s"]
    columns = ["front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s", *speeds, "v_over_c_L"]
    assert list(found[0]) == columns
    speeds = [float(r["v_over_c_L"]) for r in found if r["v_over_c_L"]]
    assert len(speeds) > 40
    assert np.allclose(speeds, 0.5, rtol=1e-9)


def test_only_its_own_table_is_replaced(onsets, tmp_path, capsys):
    out, other = tmp_path / "fronts.csv", tmp_path / "other.html"
    other.write_text("mine")
    for _ in range(2):
        assert fronts_command.main([str(onsets), "-o", str(out)]) == 0
    capsys.readouterr()
    before = onsets.read_text()
    for file in (onsets, other):
        assert fronts_command.main([str(onsets), "-o", str(file)]) == 2
        assert "is there and not a table of slipfront fronts: not replaced" in capsys.readouterr().err
    assert (onsets.read_text(), other.read_text()) == (before, "mine")


def test_a_speed_above_the_longitudinal_one_is_told(tmp_path, capsys):
    """Milliseconds under the name of microseconds."""
    file = tmp_path / "onsets.csv"
    file.write_text("x_m,time_us\n0,0\n0.1,0.05\n0.2,0.1\n0.3,0.15\n")
    material = ["--youngs-modulus-pa", "60e9", "--poissons-ratio", "0.25", "--density-kg-per-m3", "2650"]
    assert fronts_command.main([str(file), *material]) == 0
    assert "a speed is above c_L: check the units of x and time" in capsys.readouterr().out


def test_a_material_and_tractions_make_points_to_compare(onsets, tmp_path):
    lines = onsets.read_text().splitlines()
    text = "\n".join([lines[1] + ",t_s_Pa,p_s_Pa", *(f"{line},3e6,4e6" for line in lines[2:])]) + "\n"
    onsets.write_text(text)
    out = tmp_path / "fronts.csv"
    material = ["--youngs-modulus-pa", "2.6e9", "--poissons-ratio", "0.37", "--density-kg-per-m3", "1200"]
    assert fronts_command.main([str(onsets), "-o", str(out), *material]) == 0
    points = rows_of(out)
    assert np.allclose([float(row["static_ratio"]) for row in points], 0.75)
    speeds = [float(row["v_over_c_L"]) for row in points if row["v_over_c_L"]]
    assert speeds == pytest.approx([1000 / 1584.4024039000517] * len(speeds), abs=1e-9) and speeds


@pytest.mark.parametrize(
    "text, options, message",
    [
        ("x_m,time_s\n0,0\n", [], "fewer than two rows"),
        ("x_m,time_s\n0,0\n0,1\n", [], "x_m does not ascend: 0 follows 0"),
        ("x_m,time_s\n0,\n1,\n", [], "no row has a time: nothing slips"),
        (
            "x_m,time\n0,0\n1,1\n",
            [],
            "has the columns 'x_m', 'time'; wanted are x and time with their units, such as x_m or x (mm), "
            "and time_s or time (us)",
        ),
        ("x_m,time_s,time_us\n0,0,0\n", [], "'time_s' and 'time_us' both may be onset_s; rename one of them"),
        ("x_m,time_s\n0,5,0,1\n", [], ":2: 4 cells, the header has 2; with decimal commas separate cells by"),
        ("x_m,time_s\n0,0\n1,later\n", [], ":3: 'later' in column 'time_s' is not a number"),
        (
            ONSETS,
            ["--poissons-ratio", "0.3"],
            "a material needs --youngs-modulus-pa, --density-kg-per-m3 as well",
        ),
        (ONSETS, ["--c-l-m-per-s", "-1"], "--c-l-m-per-s is -1.0; it must be above 0 and finite"),
        (ONSETS, ["--plane", "strain"], "--plane counts with a material alone"),
        (ONSETS, ["--l-star-m", "0"], "--l-star-m is 0.0; it must be above 0"),
    ],
)
def test_mistakes_are_one_line(onsets, capsys, text, options, message):
    onsets.write_text(text)
    assert fronts_command.main([str(onsets), *options]) == 2
    error = one_line(capsys)
    assert error.startswith("slipfront fronts: error: ") and message in error


def test_other_commands_are_the_programs(tmp_path):
    """Of the program that is tested, wherever it was built."""
    code = (
        f"import slipfront.program; slipfront.program.PLACES = ({str(built())!r},); "
        "from slipfront.__main__ import console; exit(console())"
    )
    command = (sys.executable, "-c", code, "validate", "nowhere.toml")
    assert refusal(call(*command, cwd=tmp_path, env=WITH_PACKAGE)).startswith("nowhere.toml: ")


def test_the_stubs_are_the_modules(tmp_path):
    stub = tmp_path / "_core.pyi"
    stubgen = (sys.executable, "-m", "nanobind.stubgen", "-q", "-m", "slipfront._core", "-o", stub)
    require_done(call(*stubgen, env=WITH_PACKAGE))
    assert stub.read_text() == (ROOT / "python/slipfront/_core.pyi").read_text(), "make stubs renews it"


def test_figures_do_not_need_the_module():
    code = (
        "import sys; import slipfront.figures.__main__, slipfront.read; "
        "sys.exit('slipfront._core' in sys.modules)"
    )
    require_done(call(sys.executable, "-c", code, env=WITH_PACKAGE))


def test_without_the_module_names_say_what_they_need(tmp_path):
    leave = shutil.ignore_patterns("_core.*.so", "__pycache__")
    shutil.copytree(ROOT / "python/slipfront", tmp_path / "slipfront", ignore=leave)
    for name in ("Mesh", "run", "find_fronts"):
        code = f"import slipfront; slipfront.DataError; slipfront.{name}"
        ended = call(sys.executable, "-c", code, env={**WITH_PACKAGE, "PYTHONPATH": str(tmp_path)})
        last = ended.stderr.splitlines()[-1]
        assert last.startswith(f"ImportError: slipfront.{name} needs the compiled module: "), ended.stderr


def test_the_names_of_the_package_are_all_there():
    import slipfront

    text = (ROOT / "python/slipfront/__init__.py").read_text()
    typed = re.findall(r"import \w+ as (\w+)", text)
    assert sorted(typed) == sorted(slipfront.__all__)
    assert all(getattr(slipfront, name) is not None for name in slipfront.__all__)
    assert dir(slipfront) == sorted(slipfront.__all__)
    with pytest.raises(AttributeError, match="no attribute 'fly'$"):
        _ = slipfront.fly
    with pytest.raises(AttributeError, match="no attribute 'fronts'; did you mean find_fronts"):
        _ = slipfront.fronts


def test_the_page_runs(tmp_path, monkeypatch, capsys):
    """The code of docs/python.md, in its order, and what its comments promise."""
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    write_case(tmp_path)
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        exec(block, names)
    assert names["run"].case["friction"]["mu_k"] == 0.8
    assert names["run"].history.slip_m.attrs["units"] == "m"
    assert len(names["sequence"].runs) == 3
    assert list(names["found"].direction.values) == [-1, 1]
    assert np.nanmax(np.abs(names["found"].v_tip_m_per_s - 900)) < 1e-6
    assert names["fit"].n_points > 4
    assert len(capsys.readouterr().out.splitlines()) == names["run"].fronts.sizes["front"]
