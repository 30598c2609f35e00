# SPDX-License-Identifier: BSD-3-Clause
"""Cases of any material and size: defaults that follow the plate, what is foreseen, and how events end."""

import math
import re
from pathlib import Path

import pytest
from common import notes_of, refusal, require_done, run_json, sets

STEEL = """\
title = "steel block"
plate = {width_m = 0.3, height_m = 0.15, element_size_m = 5e-3}
material = {youngs_modulus_Pa = 200e9, poissons_ratio = 0.3, density_kg_per_m3 = 7800}
loading = {tilt_left_m = 5e-6, tilt_right_m = 4e-6}
friction = {law = "slip_weakening", mu_s = 0.6, mu_k = 0.3, d_c_m = 4e-7}
"""
PRESTRESSED = """\
plate = {{width_m = 0.2, height_m = 0.1, element_size_m = 2e-3}}
base.kind = "rigid"
loading.method = "prestress"
prestress = {{t_Pa = {t}, p_Pa = 5e6}}
friction = {{law = "slip_weakening", mu_s = 0.6, mu_k = 0.3, d_c_m = 4e-6}}
event.kind = "nucleation"
nucleation = {{half_length_m = {half}, taper_m = 0}}
"""
#: mu* of the default material on the rigid plane, 8 G/(3 - nu) in plane stress.
MODULUS_PA = 4 * 2.6e9 / ((1 + 0.37) * (3 - 0.37))


def test_slow_nucleation_in_a_stiff_block_is_followed(program, write_case, tmp_path):
    """It slips at less than a millimetre a second for longer than the quiet time before fronts form."""
    run = require_done(program("run", write_case(STEEL), "-o", "out"))
    result = run_json(tmp_path / "out")
    assert result["end"] == "end_time"
    assert f"ended: {result['end_reason']}\n" in run.stdout
    assert max(abs(f["end_x_m"] - f["start_x_m"]) for f in result["fronts"]) > 0.1
    resolved = (tmp_path / "out/case.resolved.toml").read_text()
    assert "\ntrigger_margin_m = 0.015" in resolved
    assert "mu_s" in run.stdout and "S before the event, inside: " in run.stdout


def test_a_quiet_end_says_why(program, write_case, tmp_path):
    text = PRESTRESSED.format(t=1e6, half=2e-3).split('"nucleation"')[0] + '"none"\n'
    run = require_done(program("run", write_case(text), "-o", "out"))
    result = run_json(tmp_path / "out")
    assert result["end"] == "quiet"
    assert "nothing had moved for time.quiet_s = 3e-05 s" in result["end_reason"]
    assert "ended: " + result["end_reason"] in run.stdout
    assert "no node slipped" in notes_of(result)
    assert any(w.startswith("no rupture: event.kind = none") for w in notes_of(result))


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
    assert any(note in warning for warning in notes_of(run_json(tmp_path / "out")))


def test_the_crack_of_the_sample_tells_whether_slip_may_stop(program, write_case):
    case = write_case(PRESTRESSED.format(t=2.1e6, half=4e-3))
    for command in (["validate", case], ["info", case], ["run", case, "-o", "out"]):
        printed = program(*command, *sets("plate.top=absorbing")).stdout
        told = r"the first crack, (\S+) m, is shorter than the (\S+) m from which it runs"
        noted = re.search(told, printed)
        assert 8e-3 <= float(noted[1]) < float(noted[2]) < 0.04
        assert "(Griffith)" not in printed


def test_a_process_zone_that_is_not_resolved(program, write_case, tmp_path):
    case = write_case(PRESTRESSED.format(t=2.1e6, half=20e-3))
    note = "below 3 the mesh decides on fronts and their speeds"
    for command in (["validate", case], ["info", case], ["run", case, "-o", "out", "--overwrite"]):
        assert note not in program(*command).stdout
        printed = program(*command, *sets("friction.d_c_m=1e-6")).stdout
        elements = 9 * math.pi / 32 * MODULUS_PA * 1e-6 / 1.5e6 / 2e-3
        of_zone = f"note: the process zone has {elements:.3g} elements at rest and fewer in motion"
        assert f"{of_zone}; {note}\n" in printed


def test_slip_that_stays_where_it_is_triggered_has_no_speed(program, write_case):
    printed = program("run", write_case(PRESTRESSED.format(t=1.6e6, half=20e-3)), "-o", "out").stdout
    assert printed.startswith("no front left the trigger: slip stopped within it\n")
    assert re.search(r"\nfronts? [0-9, ]+: did not leave the trigger\n", printed), printed
    printed = program("run", write_case(PRESTRESSED.format(t=2.1e6, half=20e-3)), "-o", "runs").stdout
    told = r"median speed (\S+) m/s \((\S+) c_L, (\S+) c_S\)"
    v, c_L, c_S = map(float, re.search(r"\nfront 0: .*, " + told, printed).groups())
    assert (v / c_L, v / c_S) == pytest.approx((1584.4, 889.2), rel=0.02)
    assert re.match(
        r"a (crack|pulse|front) ran from x = .* mm to .* mm, .*, at .* m/s \(.* Gamma = ", printed
    )


def test_what_info_tells_of_a_rupture(program, write_case):
    printed = program("info", write_case(PRESTRESSED.format(t=2.1e6, half=20e-3))).stdout
    # S = (3 - 2.1)/(2.1 - 1.5)
    assert "strength excess S               1.5, 1.5, 1.5" in printed
    assert "seismic ratio 1/(1 + S)         0.4, 0.4, 0.4" in printed
    assert f"nucleation length               {1.158 * MODULUS_PA * 4e-6 / 1.5e6:.3g} m" in printed
    critical_m = 2 * MODULUS_PA * 1.5e6 * 4e-6 / (math.pi * 0.6e6**2)
    assert f"critical crack length           {critical_m:.3g} m" in printed
    zone_m = 9 * math.pi / 32 * MODULUS_PA * 4e-6 / 1.5e6
    assert f"process zone at rest            {zone_m:.3g} m, {zone_m / 2e-3:.3g} elements" in printed
    assert "S < 1.77: fronts above c_S can form" in printed


BLOCK = """\
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 5e-3}
base.kind = "rigid"
friction.law = "velocity_weakening"
"""
PRESSED = (
    *("plate.corner=none", "plate.sides=absorbing", "loading.method=prestress", "prestress.p_Pa=5e6"),
    *("prestress.t_Pa=2e6", "event.kind=nucleation"),
)
SLIP_WEAKENING = ("friction.law=slip_weakening", "material.stiffness_damping_s=1e-6")
# From a patch 0.15 m from the farther end, at 889 m/s.
PATCH = ("event.kind=nucleation", "nucleation.x_m=0.05", "nucleation.half_length_m=0.02")
ODD = [
    (["friction.mu_s=70"], "friction.mu_s = 70: "),
    ([*SLIP_WEAKENING, "friction.d_c_m=1"], "friction.d_c_m = 1: "),
    (
        ["loading.tilt_left_m=0.03", "loading.tilt_right_m=0"],
        "presses the plate by 0.15 of Young's modulus, beyond small strains",
    ),
    (["loading.mean_pressure_Pa=5"], "less than in any experiment: is loading.mean_pressure_Pa in Pa"),
    (["friction.law=rate_and_state_aging_two", "friction.d_c2_m=1e-3"], "friction.d_c2_m = 0.001: "),
    (["friction.law=rate_and_state_aging", "friction.V_i_m_per_s=1"], "friction.V_i_m_per_s = 1: "),
    (["loading.shear_speed_m_per_s=2"], "the load moves at up to 2 m/s, whose waves"),
    (["output.history_interval_s=0.5"], "output.history_interval_s = 0.5: "),
    (["material.youngs_modulus_Pa=200"], "material.youngs_modulus_Pa = 200: "),
    (["event.kind=left", "event.trigger_zone_m=4e-3"], "event.trigger_zone_m = 0.004 m is less than two"),
    (["time.end_s=1e-4"], "time.end_s = 0.0001 s is before a shear wave has crossed"),
    ([*PATCH, "time.end_s=168e-6"], "is before a shear wave from the patch has reached both ends"),
    (["time.end_s=150"], "times what a shear wave takes to cross the plate; is it in s?"),
    (["material.stiffness_damping_s=0.2", "time.end_s=1e-4"], "damps all waves shorter than 317 m"),
    ([*PRESSED, "prestress.p_Pa=5", "prestress.t_Pa=2"], "prestress.p_Pa = 5: less than 1e-7 of Young's"),
    ([*PRESSED, "nucleation.half_length_m=10"], "the patch is longer than the interface, 0.2 m"),
    ([*PRESSED, "plate.sides=free"], "free sides bear no shear"),
    ([*SLIP_WEAKENING, "material.stiffness_damping_s=5e-7"], "material.stiffness_damping_s = 5.63e-07 damps"),
]


@pytest.mark.parametrize(("settings", "note"), ODD)
def test_odd_numbers_are_asked_about(program, write_case, settings, note):
    case = write_case(BLOCK)
    printed = program("validate", case, *sets(*settings)).stdout
    assert any(note in line for line in printed.splitlines() if line.startswith("note: ")), printed


def test_a_sound_case_has_no_notes(program, write_case):
    case = write_case(BLOCK)
    damped = "material.stiffness_damping_s=2e-6"
    assert program("validate", case, *sets(damped)).stdout == f"{case}: valid\n"
    printed = program("validate", case, *sets(*PATCH, damped, "time.end_s=169e-6")).stdout
    assert "shear wave" not in printed


def test_a_machine_too_stiff_for_events_is_told(program, write_case):
    """Under uniform slip: H/G of the block, and what the machine yields, against d_c/((b - a) p)."""
    slow = '[friction]\nlaw = "rate_and_state_aging"\na = 0.01\nb = 0.02\n[sequence]\nmax_events = 2\n'
    block = (
        "plate = {width_m = 0.1, height_m = 0.05, element_size_m = 2e-3}\nbase.kind = 'rigid'\n"
        "loading.mean_pressure_Pa = 5e6\n"
    )
    case = write_case(block + slow)
    modulus_Pa = 2.6e9 / (2 * 1.37)
    stiff_m = (0.02 - 0.01) * 5e6 / (modulus_Pa / 0.05)
    note = "block and machine have 1.25 times the critical stiffness (b - a) p/d_c"
    assert note in told_notes(program, case, f"friction.d_c_m={1.25 * stiff_m}")
    assert "critical stiffness" not in told_notes(program, case, f"friction.d_c_m={0.8 * stiff_m}")
    yielding = (f"friction.d_c_m={1.25 * stiff_m}", "loading.shear_stiffness_Pa_per_m=1e10")
    assert "critical stiffness" not in told_notes(program, case, *yielding)


CASES = Path(__file__).parent / "cases"


def told_notes(program, file, *settings):
    notes = []
    for command in ("info", "validate"):
        printed = require_done(program(command, file, *sets(*settings))).stdout
        notes.append([line for line in printed.splitlines() if line.startswith("note: ")])
    assert notes[0] == notes[1]
    return "\n".join(notes[0])


def test_the_base_is_damped_as_the_plate_unless_it_is_said(program, write_case):
    case = CASES / "equal_bodies_unequal_damping.toml"
    note = "of one material, but material.stiffness_damping_s is 3e-07 and base.stiffness_damping_s 1e-07"
    assert note in told_notes(program, case)
    same = write_case("".join(line for line in case.open() if "stiffness_damping_s" not in line))
    assert "of one material" not in told_notes(program, same)


def test_what_damping_and_mesh_decide_of_supershear(program):
    case = CASES / "damping_supershear.toml"
    both = ("material.stiffness_damping_s={0}", "base.stiffness_damping_s={0}")
    damping = "it changes speeds and whether and where fronts pass c_S"
    mesh = "the place where fronts pass c_S, where S < 1.77, needs 16"
    for beta, is_noted in (("0", False), ("1e-7", True), ("3e-7", True)):
        settings = [key.format(beta) for key in both]
        notes = told_notes(program, case, *settings)
        assert (damping in notes) == is_noted
        assert mesh in notes
        assert mesh not in told_notes(program, case, *settings, "friction.d_c_m=12e-6")


def test_undamped_sliding_that_changes_the_pressure_needs_damping(program):
    case = CASES / "undamped_coupled.toml"
    advised = re.search(r"(material.stiffness_damping_s) = (\S+) damps them", told_notes(program, case))
    # Rounded up to three digits: 0.1 h/c_S.
    assert advised and 0.05e-3 / 889.2 <= float(advised[2]) < 1.01 * 0.05e-3 / 889.1
    assert "damps them" not in told_notes(program, case, "=".join(advised.groups()))
    # Where the response is delayed there is nothing to damp.
    delayed = ("friction.regularisation=pressure", "friction.relaxation_time_s=1e-6")
    assert "damps them" not in told_notes(program, case, *delayed)


def test_advice_on_damping_satisfies_both_bounds(program):
    # Plexiglass on steel: both bounds count the waves of the slower body.
    base = "base.kind=body base.youngs_modulus_Pa=2e11 base.poissons_ratio=0.3 base.density_kg_per_m3=7800"
    for size, remedy in (("1e-3", "plate.element_size_m, which"), ("2.5e-4", "stiffness_damping_s")):
        changes = (*base.split(), "base.height_m=0.12", f"plate.element_size_m={size}")
        case = CASES / "undamped_coupled.toml"
        damped = (*changes, "material.stiffness_damping_s=1.13e-7")  # 0.1 h/c_S at 1 mm
        notes = told_notes(program, case, *damped)
        assert f"choose a smaller {remedy}" in notes and "damps them" not in notes
        length = re.search(r"beta_R c_L +(\S+ m)", program("info", case, *sets(*damped)).stdout)[1]
        assert f"beta_R c_L = {length} is" in notes


def test_the_verdict_is_of_places_that_can_slip(program):
    printed = program("info", CASES / "tpv6_barrier_verdict.toml").stdout
    assert re.search(r"^uniform sliding +well-posed", printed, re.MULTILINE), printed
    x_m = float(re.search(r"with the friction at +x = (\S+) m", printed)[1])
    assert 15e3 <= x_m <= 45e3


def test_no_formula_of_equal_bodies_is_taken_for_others(program):
    case = CASES / "damping_supershear.toml"
    told = (
        r"fronts above c_S can form, without damping about \S+ m from a nucleation of the critical length on"
    )
    assert re.search(told, program("info", case).stdout)
    steel = sets("base.youngs_modulus_Pa=210e9", "base.density_kg_per_m3=7800")
    unlike = program("info", case, *steel).stdout
    assert "between equal bodies" in unlike and "no formula" in unlike


def test_rows_of_a_stepwise_table_that_end_at_a_node_are_named(program, write_case, tmp_path):
    (tmp_path / "mu.csv").write_text("x_m,mu_s\n0,0.7\n0.1000001,0.8\n0.152,0.7\n0.2,0.7\n")
    case = write_case(PRESTRESSED.format(t=2.1e6, half=20e-3))
    table = ("friction.file=mu.csv", "friction.between_rows=stepwise")
    notes = told_notes(program, case, *table)
    assert "the row at x = 0.1000001 m counts for the node at 0.1 m" in notes
    assert notes.count("counts for the node") == 1


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
