# SPDX-License-Identifier: BSD-3-Clause
"""Cases of any material and size: defaults that follow the plate, what is foreseen, and how events end."""

import re

import pytest
from common import refusal, require_done, run_json, sets

STEEL = """\
title = "steel block"
[plate]
width_m = 0.3
height_m = 0.15
element_size_m = 5e-3
[material]
youngs_modulus_Pa = 200e9
poissons_ratio = 0.3
density_kg_per_m3 = 7800
[loading]
tilt_left_m = 5e-6
tilt_right_m = 4e-6
[friction]
law = "slip_weakening"
mu_s = 0.6
mu_k = 0.3
d_c_m = 4e-7
"""
PRESTRESSED = """\
[plate]
element_size_m = 2e-3
corner = "none"
[loading]
method = "prestress"
[prestress]
t_Pa = {t}
p_Pa = 5e6
[friction]
law = "slip_weakening"
mu_s = 0.6
mu_k = 0.3
d_c_m = 4e-6
[event]
kind = "nucleation"
[nucleation]
half_length_m = {half}
taper_m = 0
"""


def test_slow_nucleation_in_a_stiff_block_is_followed(program, write_case, tmp_path):
    """It slips at less than a millimetre a second for longer than the quiet time before fronts form."""
    run = require_done(program("run", write_case(STEEL), "-o", "out"))
    result = run_json(tmp_path / "out")
    assert result["end"] == "end_time"
    assert f"ended: {result['end_reason']}\n" in run.stdout
    assert max(abs(f["end_x_m"] - f["start_x_m"]) for f in result["fronts"]) > 0.1
    resolved = (tmp_path / "out/case.resolved.toml").read_text()
    assert "\ntrigger_zone_m = 0.015" in resolved
    assert "mu_s" in run.stdout and "S before the event, inside: " in run.stdout


def test_a_quiet_end_says_why(program, write_case, tmp_path):
    text = PRESTRESSED.format(t=1e6, half=2e-3).split('"nucleation"')[0] + '"none"\n'
    run = require_done(program("run", write_case(text), "-o", "out"))
    result = run_json(tmp_path / "out")
    assert result["end"] == "quiet"
    assert "nothing had moved for time.quiet_s = 3e-05 s" in result["end_reason"]
    assert "ended: " + result["end_reason"] in run.stdout
    assert "no node slipped" in result["warnings"]
    assert any(w.startswith("no rupture: event.kind = none") for w in result["warnings"])


@pytest.mark.parametrize(
    ("t", "half", "note"),
    [
        (1.4e6, 20e-3, "the residual strength mu_k p is nowhere below t"),
        (2.1e6, 4e-3, "from which a crack runs (Griffith)"),
    ],
)
def test_why_nothing_will_rupture(program, write_case, tmp_path, t, half, note):
    case = write_case(PRESTRESSED.format(t=t, half=half))
    for command in ("validate", "info"):
        assert note in program(command, case).stdout
    run = program("run", case, "-o", "out")
    assert any(note in doubt for doubt in run_json(tmp_path / "out")["rupture"]["doubts"])
    assert any(note in line for line in run.stdout.splitlines() if line.startswith("note: "))
    assert any(note in warning for warning in run_json(tmp_path / "out")["warnings"])


def test_a_process_zone_that_is_not_resolved(program, write_case, tmp_path):
    case = write_case(PRESTRESSED.format(t=2.1e6, half=20e-3))
    note = "below 3 the mesh decides on fronts and their speeds"
    for command in (["validate", case], ["info", case], ["run", case, "-o", "out", "--overwrite"]):
        assert note not in program(*command).stdout
        printed = program(*command, *sets("friction.d_c_m=1e-6")).stdout
        assert f"note: the process zone has 0.766 elements at rest and fewer in motion; {note}\n" in printed


def test_slip_that_stays_where_it_is_triggered_has_no_speed(program, write_case):
    printed = program("run", write_case(PRESTRESSED.format(t=1.6e6, half=20e-3)), "-o", "out").stdout
    assert re.search(r"front 0: .*, nowhere beyond what triggers it, \w+, ends: arrest\n", printed), printed
    printed = program("run", write_case(PRESTRESSED.format(t=2.1e6, half=20e-3)), "-o", "runs").stdout
    c_L, c_S = map(float, re.search(r"front 0: .*, median speed (\S+) c_L, (\S+) c_S, ", printed).groups())
    assert c_S / c_L == pytest.approx(1584.4 / 889.2, rel=0.02)


def test_what_info_tells_of_a_rupture(program, write_case):
    printed = program("info", write_case(PRESTRESSED.format(t=2.1e6, half=20e-3))).stdout
    # S = (3 - 2.1)/(2.1 - 1.5); mu* = E on the rigid plane in plane stress
    assert "strength excess S               1.5, 1.5, 1.5" in printed
    assert "seismic ratio 1/(1 + S)         0.4, 0.4, 0.4" in printed
    assert f"nucleation length               {1.158 * 2.6e9 * 4e-6 / 1.5e6:.3g} m" in printed
    assert "critical crack length           0.0276 m" in printed
    assert "process zone at rest            0.00613 m, 3.06 elements" in printed
    assert "S < 1.77: fronts above c_S can form" in printed


def test_odd_numbers_are_asked_about(program, write_case):
    case = write_case("[plate]\nelement_size_m = 5e-3\n")

    def notes(*settings):
        return program("validate", case, *sets(*settings)).stdout

    assert "friction.mu_s = 70: " in notes("friction.mu_s=70")
    slip = ("friction.law=slip_weakening", "friction.d_c_m=1")
    assert "friction.d_c_m = 1: " in notes(*slip)
    assert "material.youngs_modulus_Pa = 200: " in notes("material.youngs_modulus_Pa=200")
    assert "event.trigger_zone_m = 0.004 m is less than two" in notes(
        "event.kind=left", "event.trigger_zone_m=4e-3"
    )
    assert "time.end_s = 0.0001 s is before a shear wave has crossed" in notes("time.end_s=1e-4")
    # From a patch 0.15 m from the farther end, at 889 m/s.
    patch = ("event.kind=nucleation", "nucleation.x_m=0.05", "nucleation.half_length_m=0.02")
    assert "is before a shear wave from the patch has reached both ends" in notes(*patch, "time.end_s=168e-6")
    assert "shear wave" not in notes(*patch, "time.end_s=169e-6")
    assert notes() == f"{case}: valid\n"


def test_keys_that_an_override_excludes_are_named(program, write_case):
    base = (
        '[plate]\nelement_size_m = 5e-3\n[base]\nkind = "body"\nheight_m = 0.1\nyoungs_modulus_Pa = 2e11\n'
        "poissons_ratio = 0.3\ndensity_kg_per_m3 = 7800\nstiffness_damping_s = 0\n"
    )
    case = write_case(base)
    printed = program("validate", case, *sets("base.kind=rigid")).stdout
    assert "note: base.height_m, base.youngs_modulus_Pa, " in printed
    assert "do not apply with --set base.kind=rigid and are left out\n" in printed
    assert "left out" not in program("validate", case).stdout


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("base.E", "base.youngs_modulus_Pa"),
        ("material.rho", "material.density_kg_per_m3"),
        ("material.nu", "material.poissons_ratio"),
    ],
)
def test_short_names_are_recognised(program, write_case, key, meant):
    case = write_case(f'base.kind = "body"\n{key} = 1\n')
    assert f"did you mean {meant}?" in refusal(program("validate", case))
