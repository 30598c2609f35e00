# SPDX-License-Identifier: BSD-3-Clause
"""Friction laws that the case file gives as tables."""

import h5py
import numpy as np
from test_commands import one_line
from test_friction_along_x import CASE

UNIFORM = CASE.replace(
    'file = "friction.csv"\nbetween_rows = "stepwise"\n', "mu_s = 0.6\nmu_k = 0.3\nd_c_m = 4e-6\n"
)
BY_TABLE = UNIFORM.replace(
    'law = "slip_weakening"\nmu_s = 0.6\nmu_k = 0.3\nd_c_m = 4e-6\n',
    'law = "slip_table"\ntable_slip_m = [0, 4e-6]\ntable_mu = [0.6, 0.3]\n',
)


def test_two_rows_repeat_linear_slip_weakening(program, write_case, tmp_path):
    slip_m = []
    for name, text in (("law", UNIFORM), ("table", BY_TABLE)):
        assert program("run", write_case(text, f"{name}.toml"), "-o", tmp_path / name).returncode == 0
        with h5py.File(tmp_path / name / "interface.h5") as file:
            slip_m.append(file["slip_m"][-1])
    assert slip_m[0].max() > 1e-5
    np.testing.assert_allclose(slip_m[1], slip_m[0], rtol=0, atol=1e-9 * slip_m[0].max())


def test_a_table_varies_along_the_interface_by_its_factor(program, write_case, tmp_path):
    (tmp_path / "factor.csv").write_text("x_m,mu_factor\n0,1\n0.07,5\n0.1,5\n")
    case = write_case(
        BY_TABLE.replace("table_mu", 'file = "factor.csv"\nbetween_rows = "stepwise"\ntable_mu')
    )
    assert program("run", case, "-o", tmp_path / "out").returncode == 0
    fronts = (tmp_path / "out" / "fronts.csv").read_text()
    assert "0.06" in fronts
    assert "0.08" not in fronts


def test_tables_that_are_none_are_refused_with_their_line(program, write_case):
    for good, wrong, words in (
        ("[0.6, 0.3]", "[0.6, 0.3, 0.2]", "must be of one length"),
        ("[0.6, 0.3]", "[0.3, 0.6]", "must be largest in its first row"),
        ("[0, 4e-6]", "[4e-6, 0]", "must begin with 0 and ascend"),
        ("[0.6, 0.3]", "[0.6, -0.3]", "it must be at least 0"),
        ("[0.6, 0.3]", '"0.6"', "must be a list of numbers"),
    ):
        done = program("validate", write_case(BY_TABLE.replace(good, wrong)))
        assert done.returncode == 2
        assert words in one_line(done)
        assert "case.toml:" in done.stderr
    done = program("validate", write_case(BY_TABLE), "--set", "friction.random_key=table_mu")
    assert done.returncode == 2
    assert "the friction law slip_table has mu_factor" in one_line(done)
