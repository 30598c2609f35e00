# SPDX-License-Identifier: BSD-3-Clause
"""Friction that varies along the interface, by a table and at random."""

import csv
import os
import threading

import pytest
from hostile.trials import HANG_S
from test_commands import one_line

CASE = """\
[plate]
width_m = 0.1
height_m = 0.02
element_size_m = 1e-3
corner = "none"
sides = "absorbing"
top = "absorbing"
[loading]
method = "prestress"
[prestress]
t_Pa = 2.1e6
p_Pa = 5e6
[friction]
law = "slip_weakening"
file = "friction.csv"
between_rows = "stepwise"
[event]
kind = "nucleation"
[nucleation]
x_m = 0.03
half_length_m = 0.015
taper_m = 5e-3
[time]
end_s = 60e-6
"""
TABLE = "x_m,mu_s,mu_k\n0,0.6,0.3\n0.07,5,5\n0.1,5,5\n"
RESULTS = ("fronts.csv", "energy.csv", "static.csv", "interface.h5", "case.resolved.toml", "friction.csv")


@pytest.fixture
def case(write_case, tmp_path):
    (tmp_path / "friction.csv").write_text(TABLE)
    return write_case(CASE)


def same_results(a, b):
    for name in RESULTS:
        assert (a / name).read_bytes() == (b / name).read_bytes(), name


def test_a_barrier_from_a_table(program, case, tmp_path):
    run = program("run", case, "-o", "out", "-q")
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "out/friction.csv").read_text() == TABLE
    with open(tmp_path / "out/static.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["mu_s"]) for row in rows] == [0.6] * 70 + [5] * 31
    assert {row["d_c_m"] for row in rows} == {"4e-06"}
    with open(tmp_path / "out/fronts.csv", newline="") as file:
        reached = [float(row["x_m"]) for row in csv.DictReader(file)]
    assert max(reached) == pytest.approx(0.069)
    again = program("run", "out/case.resolved.toml", "-o", "again", "-q")
    assert again.returncode == 0, again.stderr
    same_results(tmp_path / "out", tmp_path / "again")


def test_any_number_of_threads_gives_the_same_bytes(program, case, tmp_path):
    for n in (1, 3):
        settings = ("--set", "friction.random_key=d_c_m", "--set", "friction.random_share=0.1")
        run = program("run", case, "-o", f"out{n}", "-q", "--threads", n, *settings)
        assert run.returncode == 0, run.stderr
    same_results(tmp_path / "out1", tmp_path / "out3")


def test_a_table_may_be_a_pipe(program, case, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    writer = threading.Thread(target=lambda: (tmp_path / "pipe").write_text(TABLE), daemon=True)
    writer.start()
    piped = program("run", case, "-o", "piped", "-q", "--set", "friction.file=pipe")
    writer.join(timeout=HANG_S)
    assert piped.returncode == 0, piped.stderr
    assert program("run", case, "-o", "out", "-q").returncode == 0
    same_results(tmp_path / "piped", tmp_path / "out")


@pytest.mark.parametrize(
    "table, said",
    [
        (
            "x_m,mu\n0,1\n",
            'friction.csv:1: has a column "mu"; the first line must be the header x_m and any of',
        ),
        ("x_m,mu_s\n0,0.6\n0.1,0.2\n", "friction.csv:3: mu_k must be at most mu_s (mu_s = 0.2, mu_k = 0.3"),
        ("x_m,mu_s\n0,0.6\n0.05,0.6\n", "friction.csv: covers x = 0 to 0.05 m, the interface reaches"),
        (None, "friction.csv: cannot be read"),
    ],
)
def test_a_wrong_table_is_named_with_the_line_of_its_key(program, case, tmp_path, table, said):
    (tmp_path / "friction.csv").unlink()
    if table:
        (tmp_path / "friction.csv").write_text(table)
    line = one_line(program("run", case, "-o", "out"))
    at = CASE.splitlines().index('file = "friction.csv"') + 1
    assert line.startswith(f"{case}:{at}: friction.file: ") and said in line
    assert not (tmp_path / "out").exists()
    assert one_line(program("validate", case)) == line


def test_a_random_field_out_of_range_is_named_with_its_place(program, case):
    settings = ("--set", "friction.random_key=mu_k", "--set", "friction.random_share=3")
    line = one_line(program("validate", case, *settings))
    assert line.startswith("--set friction.random_share=3: friction.random_share: at x = ")
    assert line.endswith("; choose a smaller share")


def test_what_is_hardly_meant_is_told(program, case, tmp_path):
    (tmp_path / "friction.csv").write_text("x_m,mu_s\n0,0.6\n100,0.6\n")
    settings = ("--set", "friction.random_key=mu_s", "--set", "friction.random_correlation_length_m=1e-5")
    told = program("validate", case, *settings, "--set", "friction.random_share=0.01").stdout
    assert "the table of friction.file reaches from x = 0 to 100 m" in told
    assert "random_correlation_length_m = 1e-05 m is below the element size" in told


def test_a_tilt_beyond_small_strains_is_told(program, coarse):
    told = program("validate", coarse, "--set", "loading.tilt_left_m=0.03").stdout
    assert "presses the plate by 0.15 of Young's modulus, beyond small strains" in told
    assert "small strains" not in program("validate", coarse).stdout


def test_info_names_the_worst_node(program, case):
    assert "with the friction at          x = 0.07 m, the worst node" in program("info", case).stdout
