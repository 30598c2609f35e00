# SPDX-License-Identifier: BSD-3-Clause
"""Cases at the ends of what is allowed, and words on loads to either side: no verdict where there is none."""

import re
from pathlib import Path

import pytest
from common import refusal, require_done, sets

CASES = Path(__file__).parent / "cases"


def line_of(printed, name):
    return re.search(rf"^{re.escape(name)}  +(.+)$", printed, re.MULTILINE)[1]


def test_no_verdict_on_sliding_where_no_node_can_slip(program):
    printed = require_done(program("info", CASES / "info_segv_min.toml")).stdout
    verdict = "no verdict: t is too far below the strength for any node to slip"
    assert line_of(printed, "uniform sliding") == verdict
    assert f"note: uniform sliding: {verdict}\n" in printed
    assert "nan" not in printed


def test_waves_that_cannot_be_told_apart_are_noted(program):
    """At one node; the verdict is that of another."""
    printed = require_done(program("info", CASES / "info_abort_roots_1.toml")).stdout
    why = "no verdict: growing waves cannot be told apart in double precision"
    assert re.search(rf"^note: uniform sliding with the friction at x = \S+ m: {why}$", printed, re.MULTILINE)
    assert line_of(printed, "uniform sliding").startswith("bounded, not resolved")


def test_statics_beyond_double_precision_are_refused(program):
    for command in (["info"], ["run", "-o", "out"], ["fracture"]):
        line = refusal(program(command[0], CASES / "abort_condensed.toml", *command[1:]))
        assert "no solution in double precision" in line or "--fracture-energy" in line


@pytest.mark.parametrize("V_i", ["1e-12", "1e-9", "1e-6", "1e-3"])
def test_the_worst_node_is_one_where_waves_grow(program, V_i):
    case = CASES / "weakening_between_strengthening.toml"
    printed = require_done(program("info", case, *sets(f"friction.V_i_m_per_s={V_i}"))).stdout
    assert line_of(printed, "uniform sliding").startswith("well-posed: long waves grow")
    assert line_of(printed, "  with the friction at") == "x = 0.104 m, the worst node"


def test_a_table_that_rises_again_has_the_fracture_energy_of_its_fall(program, write_case):
    pressed = (
        '[plate]\nelement_size_m = 2e-3\ncorner = "none"\nsides = "absorbing"\n[loading]\n'
        'method = "prestress"\n[prestress]\nt_Pa = 2.1e6\np_Pa = 5e6\n[event]\nkind = "nucleation"\n'
        '[friction]\nlaw = "slip_table"\n'
    )
    falls = require_done(
        program("info", write_case(pressed + "table_slip_m = [0, 4e-6]\ntable_mu = [0.6, 0.3]\n"))
    ).stdout
    rises = require_done(
        program("info", write_case(pressed + "table_slip_m = [0, 4e-6, 1]\ntable_mu = [0.6, 0.3, 0.4]\n"))
    ).stdout
    for name in ("nucleation length", "critical crack length", "process zone at rest"):
        assert line_of(rises, name) == line_of(falls, name)


PRESSED = (
    "plate.element_size_m=5e-3", "plate.corner=none", "plate.sides=absorbing", "loading.method=prestress",
    "prestress.p_Pa=5e6", "friction.law=slip_weakening", "friction.mu_s=0.6", "friction.mu_k=0.3",
)  # fmt: skip

OVERSTRESSED = ("event.kind=nucleation", "nucleation.form=overstress")


def notes_of(program, file, *settings):
    printed = require_done(program("validate", file, *sets(*PRESSED, *settings))).stdout
    return [line for line in printed.splitlines() if line.startswith("note: ")]


def test_words_follow_the_sign_of_the_load(program, coarse):
    """Mechanics mirror: so do the words."""
    settings = (*OVERSTRESSED, "nucleation.half_length_m=0.03")
    right = ("prestress.t_Pa=1.9e6", "nucleation.overstress_Pa=1e5")
    left = ("prestress.t_Pa=-1.9e6", "nucleation.overstress_Pa=-1e5")
    of_right, of_left = (notes_of(program, coarse, *settings, *signed) for signed in (right, left))
    assert "nucleation.overstress_Pa = 100000 brings t to no more than 0.667 of mu_s p" in "\n".join(of_right)
    assert "nucleation.overstress_Pa = -100000 brings -t to no more than 0.667 of mu_s p" in "\n".join(
        of_left
    )
    assert len(of_right) == len(of_left)
    run = require_done(program("run", coarse, "-o", "out", *sets(*PRESSED, *settings, *left))).stdout
    assert "prescribed tractions, t/p down to -0.38\n" in run


def test_an_overstress_against_the_load_is_named(program, coarse):
    settings = (*OVERSTRESSED, "prestress.t_Pa=-1.9e6")
    notes = "\n".join(notes_of(program, coarse, *settings, "nucleation.overstress_Pa=1e5"))
    assert "which acts against t, brings -t to no more than" in notes
    notes = "\n".join(notes_of(program, coarse, *settings, "nucleation.overstress_Pa=8e6"))
    assert "acts against t: slip begins against the load" in notes


def test_cohesion_counts_in_words(program, coarse):
    cohesive = ("friction.cohesion_Pa=1e6", "event.kind=none")
    notes = "\n".join(notes_of(program, coarse, *cohesive, "prestress.t_Pa=3.5e6"))
    assert "event.kind = none, and t is below cohesion_Pa + mu_s p at all nodes inside" in notes
    notes = "\n".join(notes_of(program, coarse, *cohesive, "prestress.t_Pa=2.4e6"))
    assert "the residual strength cohesion_Pa + mu_k p is nowhere below t" in notes


def test_a_forced_patch_that_comes_too_late_is_told(program):
    case = CASES / "forced_speed_km_per_s.toml"
    told = "the forced patch is not of nucleation.half_length_m = 0.02 m before 0.04 s"
    for command in (["validate"], ["info"], ["run", "-o", "out"]):
        printed = require_done(
            program(command[0], case, *command[1:], *sets("plate.element_size_m=4e-3"))
        ).stdout
        assert told in printed
        assert "fronts as cracks" not in printed
    assert told in refusal(program("fracture", case))
    in_time = require_done(program("fracture", case, *sets("nucleation.front_speed_m_per_s=500"))).stdout
    assert "front to +x" in in_time
    assert "front to +x" in require_done(program("fracture", case, "--x", "0.1")).stdout


def test_laws_with_a_state_borrow_nothing_from_others(program, write_case):
    case = write_case(
        '[plate]\nelement_size_m = 4e-3\nheight_m = 0.04\ncorner = "none"\nsides = "absorbing"\n[loading]\n'
        'method = "prestress"\n[prestress]\np_Pa = 5e6\n[event]\nkind = "nucleation"\n[base]\n'
        'kind = "body"\nheight_m = 0.04\nyoungs_modulus_Pa = 2.6e9\npoissons_ratio = 0.37\n'
        'density_kg_per_m3 = 1200\n[nucleation]\nform = "overstress"\n[friction]\nd_c_m = 2e-6\n'
    )
    printed = {}
    for law in ("aging", "slip"):
        printed[law] = require_done(program("info", case, *sets(f"friction.law=rate_and_state_{law}"))).stdout
        assert "S < 1.77" not in printed[law]
        low = sets(f"friction.law=rate_and_state_{law}", "prestress.t_Pa=0.5e6")
        assert "S is beyond" not in require_done(program("validate", case, *low)).stdout
    assert "Rubin, Ampuero 2005" in line_of(printed["aging"], "nucleation length")
    assert line_of(printed["slip"], "nucleation length").startswith("unknown")


def test_a_trigger_longer_than_the_critical_crack_has_no_place_where_fronts_pass_c_S(program):
    case = CASES / "damping_supershear.toml"
    for half_length, is_longer in (("3e-3", False), ("20e-3", True)):
        printed = require_done(program("info", case, *sets(f"nucleation.half_length_m={half_length}"))).stdout
        assert ("times the critical length: no formula" in line_of(printed, "expected regime")) == is_longer


def test_a_fracture_energy_of_the_mesh_is_called_so(program, coarse, write_case):
    said = "(of this mesh: the law has no length)"
    trigger = sets("event.kind=left")
    assert said in require_done(program("run", coarse, "-o", "out", *trigger)).stdout
    slip = sets("friction.law=slip_weakening", "event.kind=left", "friction.d_c_m=4e-5")
    printed = require_done(program("run", coarse, "-o", "of_slip", *slip)).stdout
    assert said not in printed


@pytest.mark.parametrize(
    "changes, told",
    [
        (
            ["base.youngs_modulus_Pa=5e6", "loading.mean_pressure_Pa=5e6"],
            "of Young's modulus of the base, beyond small strains",
        ),
        (["material.poissons_ratio=0.4999", "material.plane=strain"], "too stiff (volumetric locking)"),
        (["friction.mu_s=0"], None),  # no strength that waves of the load could carry a part of
    ],
)
def test_notes_on_bodies_and_loads(program, write_case, changes, told):
    body = 'kind = "body"\nheight_m = 0.04\nyoungs_modulus_Pa = 2.6e9\npoissons_ratio = 0.37\n'
    text = f'[base]\n{body}density_kg_per_m3 = 1200\n[event]\nkind = "spontaneous"\n'
    text += '[friction]\nlaw = "slip_weakening"\nmu_k = 0\nd_c_m = 1e-6\n'
    case = write_case(text + "[sequence]\nmax_events = 2\n")
    printed = require_done(program("validate", case, *sets(*changes))).stdout
    assert " inf " not in printed and (told is None or told in printed)
