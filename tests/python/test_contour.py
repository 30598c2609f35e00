# SPDX-License-Identifier: BSD-3-Clause
"""Energy release rate of a tip by the fields around it."""

from __future__ import annotations

import numpy as np
import pytest
import slipfront
from package_cases import refused
from slipfront.contour import contour_integral

GAMMA_J_PER_M2 = 0.2 * 5e6 * 2.2e-6 / 2  # (mu_s - mu_k) p d_c/2

PMMA = {"youngs_modulus_Pa": 5.6e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180}
CASE = {
    "plate": {"width_m": 0.14, "height_m": 0.02, "element_size_m": 0.5e-3, "corner": "none"}
    | {"sides": "absorbing", "top": "absorbing"},
    "material": {**PMMA, "stiffness_damping_s": 0.05e-6},
    "base": {"kind": "body", "height_m": 0.02, "bottom": "absorbing", **PMMA},
    "loading": {"method": "prestress"},
    "prestress": {"t_Pa": 2.35e6, "p_Pa": 5e6},
    "friction": {"law": "slip_weakening", "mu_s": 0.5, "mu_k": 0.3, "d_c_m": 2.2e-6, "cohesion_Pa": 0.5e6},
    "event": {"kind": "nucleation"},
    "nucleation": {"half_length_m": 0.02, "taper_m": 0.005},
    "time": {"end_s": 45e-6},
    "output": {"snapshot_times_s": [39e-6, 40e-6, 41e-6], "snapshot_stress": False},
}
AT_S = 40e-6


PLAIN = {"law": "slip_weakening", "mu_s": 0.6, "mu_k": 0.4, "d_c_m": 2.2e-6}
RIGID = CASE | {
    "base": {"kind": "rigid"},
    "friction": PLAIN,
    "time": {"end_s": 60e-6},
    "output": CASE["output"] | {"history_interval_s": 3e-6},  # p is found between rows, which the tip passes
    "nucleation": {"x_m": 0.05, "half_length_m": 0.02, "taper_m": 0.005},
}
PRESSED = {  # by statics: p is not uniform, corners are relieved
    "plate": {"width_m": 0.2, "height_m": 0.06, "element_size_m": 0.5e-3, "corner": "relief"},
    "base": {"kind": "rigid"},
    "material": CASE["material"],
    "loading": {"mean_pressure_Pa": 5e6, "shear_over_critical": 0.9},
    "friction": PLAIN | {"d_c_m": 1.5e-6},
    "event": CASE["event"],
    "nucleation": {"half_length_m": 0.015, "taper_m": 0.005},
    "time": {"end_s": 75e-6},
    "output": {"snapshot_times_s": [0.0, 59e-6, 60e-6, 61e-6]},
}

SPONTANEOUS = {name: table for name, table in PRESSED.items() if name != "nucleation"} | {
    "loading": {"mean_pressure_Pa": 5e6, "tilt_difference_m": 2e-5},
    "event": {"kind": "spontaneous"},
    "time": {"end_s": 120e-6},
    "output": {"snapshot_times_s": [0.0, 89e-6, 90e-6, 91e-6]},
}


def share_of_elements(found, size_m=0.5e-3):
    """What bilinear elements may be wrong by: the square of their size over the zone in which t falls."""
    return (size_m / found.breakdown_zone_m) ** 2


@pytest.fixture(scope="module")
def run():
    return slipfront.run(CASE)


@pytest.mark.parametrize("half_width_m", [9e-3, 14e-3, 19e-3])
@pytest.mark.parametrize("front", [0, 1])
def test_G_is_the_fracture_energy_of_slip_weakening_in_any_box(run, front, half_width_m):
    found = contour_integral(run, time_s=AT_S, front=front, half_width_m=half_width_m, height_m=half_width_m)
    bound = share_of_elements(found)
    assert found.G_J_per_m2 == pytest.approx(GAMMA_J_PER_M2, rel=bound)
    parts = [value for name, value in vars(found).items() if name.endswith("J_per_m2")][1:-1]
    assert len(parts) == 5 and sum(parts) == pytest.approx(found.G_J_per_m2)
    assert all(abs(part) > 2 * bound * GAMMA_J_PER_M2 for part in parts)  # none could be missing unnoticed


@pytest.mark.parametrize(
    "changes",
    [
        {"prestress": {"t_Pa": -2.25e6, "p_Pa": 5e6, "t_rate_Pa_per_s": -4e9}},  # to -2.41 MPa at the time
        {"friction": {"law": "slip_table", "table_slip_m": [0, 2.2e-6, 8e-6], "table_mu": [0.6, 0.4, 0.43]}},
    ],
    ids=["slip to -x under a growing load", "friction that rises again"],
)
def test_so_it_is_with(changes):
    found = contour_integral(slipfront.run(CASE | changes), time_s=AT_S, front=0, half_width_m=14e-3)
    assert found.G_J_per_m2 == pytest.approx(GAMMA_J_PER_M2, rel=share_of_elements(found))


def test_the_error_falls_with_the_square_of_the_element_size():
    def error(size_m):
        run = slipfront.run(CASE, {"plate.element_size_m": size_m})
        found = contour_integral(run, time_s=AT_S, front=1, half_width_m=12e-3)
        return abs(found.G_J_per_m2 / GAMMA_J_PER_M2 - 1)

    assert error(0.5e-3) < error(1e-3) / 3


@pytest.mark.parametrize(
    "case, time_s, front",
    [(RIGID, AT_S, 1), (PRESSED, 60e-6, 0), (SPONTANEOUS, 90e-6, 0)],
    ids=["prescribed", "statics", "spontaneous"],
)
def test_on_a_rigid_plane_friction_follows_the_pressure(case, time_s, front):
    run = slipfront.run(case)
    found = contour_integral(run, time_s=time_s, front=front, half_width_m=20e-3)
    points = run.fracture.isel(point=run.fracture.front_id == front)
    points = points.sortby("x_m")
    zone_m = np.copysign(found.breakdown_zone_m, found.v_tip_m_per_s)
    ends_m = [found.tip_m, found.tip_m - zone_m]
    work, other = np.interp(ends_m, points.x_m, points.breakdown_work_J_per_m2)
    # The work belongs to a place, G to a time, at which the zone has its length.
    assert found.G_J_per_m2 == pytest.approx(work, abs=abs(work - other) + share_of_elements(found) * work)


def refusal(run, kind=slipfront.DataError, **given):
    given = {"time_s": AT_S, "front": 1, "half_width_m": 14e-3} | given
    return refused(lambda: contour_integral(run, **given), kind)


def test_what_the_fields_do_not_tell_is_refused(run):
    assert "no snapshot at 3e-05 s; the nearest is at 3.9" in refusal(run, time_s=30e-6)
    assert "no front 7" in refusal(run, front=7)
    assert "0.021 m high, does not lie in the bodies" in refusal(run, height_m=0.021)
    assert "does not lie in the bodies" in refusal(run, half_width_m=25e-3)
    assert "take a wider box" in refusal(run, half_width_m=6e-3)
    assert "half_width_m is too small" in refusal(run, half_width_m=1e-5)
    assert "half_width_m is 0; it must be above 0" in refusal(run, slipfront.CaseError, half_width_m=0)
    assert "must be a slipfront.OpenRun" in refusal("out", slipfront.CaseError)


SHORT = {"output.snapshot_times_s": [14e-6, 15e-6]}
PUSHED = {"output.snapshot_times_s": [17e-6, 18e-6], "nucleation.form": "overstress"}


@pytest.mark.parametrize(
    "changes, given, told",
    [
        ({"output.snapshot_times_s": []}, {}, "fields.vtkhdf: there is none"),
        ({"output.snapshot_times_s": [30e-6, 40e-6]}, {}, "no snapshot within 7e-06 s of that at"),
        ({"nucleation.x_m": 0.12}, {}, "front 1 has no tip at 4.0"),
        (
            SHORT | {"nucleation.half_length_m": 0.016, "plate.width_m": 0.16},
            {"half_width_m": 0.05},
            "more than one tip",
        ),
        (PUSHED, {"half_width_m": 0.02}, "the zone of the trigger's or patch's traction"),
    ],
)
def test_a_run_that_does_not_tell_it_is_refused(changes, given, told):
    run = slipfront.run(CASE, changes | {"time.end_s": 41e-6})
    time_s = changes.get("output.snapshot_times_s", [AT_S])[-1:]
    assert told in refusal(run, time_s=time_s[0] if time_s else AT_S, height_m=0.014, **given)


def test_statics_need_the_state_before():
    run = slipfront.run(PRESSED, {"output.snapshot_times_s": [1e-6], "time.end_s": 2e-6})
    assert "no snapshot at time 0" in refusal(run)
