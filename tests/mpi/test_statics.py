# SPDX-License-Identifier: BSD-3-Clause
"""Statics by PETSc, shared by processes, against the factorisation of one process."""

import math
import tomllib

import numpy as np
import pytest
from common import require_done, require_same_bytes, run_json, sets
from conftest import Mpirun

CASE = """\
title = "shared statics"

[plate]
element_size_m = 2e-3

[loading]
solver = "direct"

[event]
kind = "left"

[time]
end_s = 2e-4
quiet_s = inf
"""
# docs/statics-petsc.md: of a displacement in the energy norm, over the displacement's.
ACCURACY = 1e-10
GRADED = sets("plate.coarsenings=2", "plate.fine_height_m=0.02", "time.interface_substeps=2")
ON_BASE = sets(
    *("base.kind=body", "base.height_m=0.06", "base.youngs_modulus_Pa=5e9", "base.poissons_ratio=0.3"),
    *("base.density_kg_per_m3=1500", "base.stiffness_damping_s=1e-7"),
)
FILLET = sets("plate.corner=fillet")
PETSC = sets("loading.solver=petsc")


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


def table(folder, name):
    return np.genfromtxt(folder / name, delimiter=",", names=True, comments="#", dtype=None, encoding="utf-8")


def traction_tolerance_pa(folder):
    """A node's force differs by no more than sqrt(K_kk) times the error in the energy norm. Twice the strain
    energy is at most that of the loaded edge's largest displacement over the whole plate; K_kk is about E."""
    case = tomllib.loads((folder / "case.resolved.toml").read_text())
    plate, youngs_modulus_pa = case["plate"], case["material"]["youngs_modulus_Pa"]
    statics = run_json(folder)["statics"]
    shear_m = statics["critical_shear_m"]
    tilts = statics.get("loads", case["loading"])
    tilt_m = max(tilts["tilt_left_m"], tilts["tilt_right_m"])
    strain = (tilt_m + shear_m) / plate["height_m"]
    norm = math.sqrt(youngs_modulus_pa * strain**2 * plate["height_m"] * plate["width_m"])
    return 2 * math.sqrt(youngs_modulus_pa) * ACCURACY * norm / plate["element_size_m"]


def require_same_state(found, expected):
    a, b = table(found, "static.csv"), table(expected, "static.csv")
    assert np.array_equal(a["x_m"], b["x_m"])
    tolerance_pa = traction_tolerance_pa(expected)
    assert tolerance_pa < 1e-6 * b["p_s_Pa"].max()
    for name in ("t_s_Pa", "p_s_Pa"):
        assert np.abs(a[name] - b[name]).max() <= tolerance_pa, name
        # Another solver, indeed.
        assert np.abs(a[name] - b[name]).max() > 0, name
    # Open nodes have none; slipping ones have the friction's share of the pressure.
    assert np.array_equal(a["p_s_Pa"] == 0, b["p_s_Pa"] == 0)


def require_same_fronts(found, expected):
    a, b = table(found, "fronts.csv"), table(expected, "fronts.csv")
    assert a.size == b.size > 3
    step_s = run_json(expected)["dt_s"]
    assert np.array_equal(a["x_m"], b["x_m"])
    assert np.abs(a["onset_s"] - b["onset_s"]).max() <= 2 * step_s


def run(mpirun, n, case, out, *settings):
    arguments = ("run", case, "-o", out, "-q", *settings)
    require_done(mpirun.alone(*arguments) if n == 0 else mpirun(n, *arguments))
    return mpirun.folder / out


@pytest.mark.parametrize(
    "settings, processes",
    [((), (0, 2, 3)), (FILLET, (3,)), (ON_BASE, (3,)), (GRADED, (2,))],
    ids=["relief", "fillet", "base", "graded"],
)
def test_as_the_factorisation(mpirun, case, settings, processes):
    """0: without mpirun."""
    expected = run(mpirun, 0, case, "direct", *settings)
    for n in processes:
        found = run(mpirun, n, case, f"petsc-{n}", *settings, *PETSC)
        require_same_state(found, expected)
        require_same_fronts(found, expected)


# Aggregates that serve the free tilt make the preconditioner indefinite once shear holds the loaded edge.
LONG_ON_BASE = """\
[plate]
width_m = 0.496
height_m = 0.12
element_size_m = 1e-3
corner = "none"
coarsenings = 3
fine_height_m = 5e-3

[material]
stiffness_damping_s = 2e-7

[base]
kind = "body"
height_m = 0.034
youngs_modulus_Pa = 1e9
poissons_ratio = 0.33
density_kg_per_m3 = 1200
stiffness_damping_s = 1e-8

[loading]
tilt_left_m = 2.4e-4
tilt_right_m = 2.4e-4
top_during_tilt = "free"

[friction]
random_key = "mu_s"
random_share = 0.02
random_seed = 23
random_correlation_length_m = 3e-3

[event]
kind = "spontaneous"

[time]
end_s = 1e-6
interface_substeps = 3
"""


def test_edges_that_were_free(mpirun, case):
    case.write_text(LONG_ON_BASE)
    expected = run(mpirun, 0, case, "direct", *sets("loading.solver=direct"))
    found = run(mpirun, 2, case, "petsc", *PETSC)
    require_same_state(found, expected)


@pytest.mark.parametrize("n", [2, 3])
def test_equilibria(mpirun, n):
    """Each kind of body and contact, node by node: petsc_test.cpp."""
    result = Mpirun(mpirun.folder, mpirun.program.with_name("test_petsc"))(n)
    assert result.returncode == 0, result.stdout[-4000:] + result.stderr
    assert "[  PASSED  ]" in result.stdout


def test_options_of_petsc_change_nothing(mpirun, case, tmp_path, monkeypatch):
    plain = run(mpirun, 0, case, "plain", *PETSC)
    options = "-log_view -info -mg_levels_ksp_max_it 7 -pc_gamg_agg_nsmooths 0 -malloc_view -no_such_option"
    monkeypatch.setenv("PETSC_OPTIONS", options)
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in (".petscrc", "petscrc"):
        (tmp_path / name).write_text(options.replace(" -", "\n-") + "\n")
    result = mpirun.alone("run", case, "-o", "set", "-q", *PETSC)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    require_same_bytes(tmp_path / "set", plain, "static.csv")


def test_as_many_processes_give_the_same_again(mpirun, case):
    first, again = (run(mpirun, 2, case, name, *PETSC) for name in ("first", "again"))
    require_same_bytes(first, again, "static.csv", "fronts.csv", "interface.h5")


@pytest.mark.parametrize(
    "settings, n",
    [((), 3), (GRADED, 3), ((*ON_BASE, *sets("base.youngs_modulus_Pa=1e9")), 2)],
    ids=["relief", "graded", "soft base"],
)
def test_displacements_stay_where_they_are_found(mpirun, case, settings, n):
    """Where the state before the event is to be used again, the leader gathers them."""
    settings = (*settings, *PETSC, *sets("output.snapshot_times_s=[0, 1e-4]"))
    kept = run(mpirun, n, case, "kept", *settings)
    gathered = run(mpirun, n, case, "gathered", *settings, "--state-dir", "states")
    again = run(mpirun, 1, case, "again", *settings, "--state-dir", "states")
    for other in (gathered, again):
        require_same_bytes(kept, other, "static.csv", "fronts.csv", "interface.h5", "fields.vtkhdf")


@pytest.mark.parametrize("settings", [(), ON_BASE], ids=["relief", "base"])
def test_forces_as_the_factorisation(mpirun, case, settings):
    forces = sets("loading.mean_pressure_Pa=5e6", "loading.tilt_difference_m=3e-4")
    forces += sets("loading.shear_over_critical=0.9")
    expected = run(mpirun, 0, case, "direct", *settings, *forces)
    statics, nodes = run_json(expected)["statics"], table(expected, "static.csv")
    # The critical shear is that of the node at the peak, where t = mu_s p but for the errors of both.
    p_pa = nodes["p_s_Pa"][np.abs(nodes["x_m"] - statics["peak_x_m"]).argmin()]
    tolerance = 4 * traction_tolerance_pa(expected) / p_pa
    assert tolerance < 1e-5
    for n in (1, 3):
        found = run_json(run(mpirun, n, case, f"petsc-{n}", *settings, *forces, *PETSC))["statics"]["loads"]
        assert found["mean_pressure_Pa"] == pytest.approx(5e6, rel=1e-9)
        assert found == pytest.approx(statics["loads"], rel=tolerance)
    require_done(mpirun(3, "run", case, "-o", "again", "-q", *settings, *forces, *PETSC))
    require_same_bytes(mpirun.folder / "petsc-3", mpirun.folder / "again", "static.csv", "interface.h5")
