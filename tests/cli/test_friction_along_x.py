# SPDX-License-Identifier: BSD-3-Clause
"""Friction that varies along the interface, by a table and at random, and laws that are tables of slip."""

import re

import h5py
import numpy as np
import pytest
from common import refusal, require_done, require_same_bytes, rows_of, sets

CASE = """\
loading.method = "prestress"
prestress = {t_Pa = 2.1e6, p_Pa = 5e6}
event.kind = "nucleation"
nucleation = {x_m = 0.03, half_length_m = 0.015, taper_m = 5e-3}
time.end_s = 60e-6
[plate]
width_m = 0.1
height_m = 0.02
element_size_m = 1e-3
corner = "none"
sides = "absorbing"
top = "absorbing"
[base]
kind = "rigid"
[friction]
law = "slip_weakening"
file = "friction.csv"
between_rows = "stepwise"
d_c_m = 4e-6
"""
TABLE = "x_m,mu_s,mu_k\n0,0.6,0.3\n0.07,5,5\n0.1,5,5\n"
RESULTS = ("fronts.csv", "energy.csv", "static.csv", "interface.h5", "case.resolved.toml", "friction.csv")


@pytest.fixture
def case(write_case, tmp_path):
    (tmp_path / "friction.csv").write_text(TABLE)
    return write_case(CASE)


def test_a_barrier_from_a_table(program, case, tmp_path):
    require_done(program("run", case, "-o", "out", "-q"))
    assert (tmp_path / "out/friction.csv").read_text() == TABLE
    rows = rows_of(tmp_path / "out/static.csv")
    assert [float(row["mu_s"]) for row in rows] == [0.6] * 70 + [5] * 31
    assert {row["d_c_m"] for row in rows} == {"4e-06"}
    reached = [float(row["x_m"]) for row in rows_of(tmp_path / "out/fronts.csv")]
    assert max(reached) == pytest.approx(0.069)
    require_done(program("run", "out/case.resolved.toml", "-o", "again", "-q"))
    require_same_bytes(tmp_path / "out", tmp_path / "again", *RESULTS)


def steady_sliding(program, case, tmp_path, table, *settings):
    (tmp_path / "friction.csv").write_text(table)
    said = require_done(program("info", case, *sets(*settings))).stdout
    return re.search(r"^ *steady sliding +(.*)$", said, re.MULTILINE)[1]


def test_info_tells_where_friction_weakens_with_the_slip_rate(program, write_case, tmp_path):
    text = CASE.replace("slip_weakening", "rate_and_state_aging").replace("{x_m", '{form = "overstress", x_m')
    case = write_case(text)
    of_rows = {
        "0,0.016\n0.1,0.016\n": "velocity weakening (b > a) everywhere",
        "0,4e-3\n0.1,8e-3\n": "velocity strengthening (a >= b) everywhere",
        "0,4e-3\n0.03,0.016\n0.0705,4e-3\n0.1,4e-3\n": "velocity weakening (b > a) over 0.03 .. 0.07 m, "
        "strengthening elsewhere",
    }
    for rows, told in of_rows.items():
        assert steady_sliding(program, case, tmp_path, "x_m,b\n" + rows) == told
    flickering = "".join(f"{k / 100},{'0.016' if k % 2 else '4e-3'}\n" for k in range(11))
    assert "at 50 of 101 nodes" in steady_sliding(program, case, tmp_path, "x_m,b\n" + flickering)
    strong = 'friction.law="rate_and_state_strong"'
    said = steady_sliding(program, case, tmp_path, "x_m,b\n0,4e-3\n0.1,4e-3\n", strong)
    assert (
        said == "velocity strengthening (a >= b) everywhere; at 1 m/s velocity weakening (b > a) everywhere"
    )


def test_any_number_of_threads_gives_the_same_bytes(program, case, tmp_path):
    random = sets("friction.random_key=d_c_m", "friction.random_share=0.1")
    for n in (1, 3):
        require_done(program("run", case, "-o", f"out{n}", "-q", "--threads", n, *random))
    require_same_bytes(tmp_path / "out1", tmp_path / "out3", *RESULTS)


def test_a_table_may_be_a_pipe(program, case, pipe, tmp_path):
    pipe("pipe", TABLE)
    require_done(program("run", case, "-o", "piped", "-q", "--set", "friction.file=pipe"))
    require_done(program("run", case, "-o", "out", "-q"))
    require_same_bytes(tmp_path / "piped", tmp_path / "out", *RESULTS)


@pytest.mark.parametrize(
    "table, said",
    [
        ("x_m,mu\n0,1\n", 'friction.csv:1: has a column "mu"; the first line must be the header x_m and'),
        (None, "friction.csv: cannot be read"),
    ],
)
def test_a_wrong_table_is_named_with_the_line_of_its_key(program, case, tmp_path, table, said):
    (tmp_path / "friction.csv").unlink()
    if table:
        (tmp_path / "friction.csv").write_text(table)
    line = refusal(program("run", case, "-o", "out"))
    at = CASE.splitlines().index('file = "friction.csv"') + 1
    assert line.startswith(f"{case}:{at}: friction.file: ") and said in line
    assert not (tmp_path / "out").exists()
    assert refusal(program("validate", case)) == line


def test_a_random_field_out_of_range_is_named_with_its_place(program, case):
    random = sets("friction.random_key=mu_k", "friction.random_share=3")
    line = refusal(program("validate", case, *random))
    assert line.startswith("--set friction.random_share=3: friction.random_share: at x = ")
    assert line.endswith("; choose a smaller share")


def test_what_is_hardly_meant_is_told(program, case, tmp_path):
    (tmp_path / "friction.csv").write_text("x_m,mu_s\n0,0.6\n100,0.6\n")
    short = sets("friction.random_correlation_length_m=1e-5", "friction.random_share=0.01")
    printed = program("validate", case, *sets("friction.random_key=mu_s"), *short).stdout
    assert "the table of friction.file reaches from x = 0 to 100 m" in printed
    assert "random_correlation_length_m = 1e-05 m is below the element size" in printed


def test_info_names_the_worst_node(program, case, tmp_path):
    (tmp_path / "friction.csv").write_text("x_m,mu_s,mu_k\n0,0.6,0.3\n0.05,0.6,0.1\n0.07,5,1\n0.1,5,1\n")
    assert "with the friction at          x = 0.05 m, the worst node" in program("info", case).stdout


# --- Laws that the case file gives as tables

UNIFORM = CASE.replace('file = "friction.csv"\nbetween_rows = "stepwise"\n', "mu_s = 0.6\nmu_k = 0.3\n")
BY_TABLE = UNIFORM.replace(
    'law = "slip_weakening"\nmu_s = 0.6\nmu_k = 0.3\nd_c_m = 4e-6\n',
    'law = "slip_table"\ntable_slip_m = [0, 4e-6]\ntable_mu = [0.6, 0.3]\n',
)


def test_two_rows_repeat_linear_slip_weakening(program, write_case, tmp_path):
    slip_m = []
    for name, text in (("law", UNIFORM), ("table", BY_TABLE)):
        require_done(program("run", write_case(text, f"{name}.toml"), "-o", tmp_path / name))
        with h5py.File(tmp_path / name / "interface.h5") as file:
            slip_m.append(file["slip_m"][-1])
    assert slip_m[0].max() > 1e-5
    np.testing.assert_allclose(slip_m[1], slip_m[0], rtol=0, atol=1e-9 * slip_m[0].max())


def test_a_table_varies_along_the_interface_by_its_factor(program, write_case, tmp_path):
    (tmp_path / "factor.csv").write_text("x_m,mu_factor\n0,1\n0.07,5\n0.1,5\n")
    stepwise = 'file = "factor.csv"\nbetween_rows = "stepwise"\ntable_mu'
    case = write_case(BY_TABLE.replace("table_mu", stepwise))
    require_done(program("run", case, "-o", tmp_path / "out"))
    fronts = rows_of(tmp_path / "out" / "fronts.csv")
    assert 0.06 < max(float(row["x_m"]) for row in fronts) < 0.08


def test_tables_that_are_none_are_refused_with_their_line(program, write_case):
    line = refusal(program("validate", write_case(BY_TABLE.replace("[0.6, 0.3]", "[0.6, 0.3, 0.2]"))))
    assert "must be of one length" in line and "case.toml:" in line
    random = program("validate", write_case(BY_TABLE), "--set", "friction.random_key=table_mu")
    assert "the friction law slip_table has mu_factor" in refusal(random)
