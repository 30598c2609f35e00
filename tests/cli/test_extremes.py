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
        'plate = {element_size_m = 2e-3, corner = "none", sides = "absorbing"}\n'
        'loading.method = "prestress"\nprestress = {t_Pa = 2.1e6, p_Pa = 5e6}\n'
        'event.kind = "nucleation"\nfriction.law = "slip_table"\n'
    )
    falls, rises = (
        require_done(
            program(
                "info", write_case(pressed + f"friction.table_slip_m = {slip}\nfriction.table_mu = {mu}\n")
            )
        )
        for slip, mu in (([0, 4e-6], [0.6, 0.3]), ([0, 4e-6, 1], [0.6, 0.3, 0.4]))
    )
    for name in ("nucleation length", "critical crack length", "process zone at rest"):
        assert line_of(rises.stdout, name) == line_of(falls.stdout, name)


PRESSED = (
    "plate.element_size_m=5e-3", "plate.corner=none", "plate.sides=absorbing", "loading.method=prestress",
    "prestress.p_Pa=5e6", "friction.law=slip_weakening", "friction.mu_s=0.6", "friction.mu_k=0.3",
)  # fmt: skip
OVERSTRESSED = ("event.kind=nucleation", "nucleation.form=overstress", "nucleation.half_length_m=0.03")
TO_LEFT = (*OVERSTRESSED, "prestress.t_Pa=-1.9e6")
COHESIVE = ("friction.cohesion_Pa=1e6", "event.kind=none")


@pytest.mark.parametrize(
    "settings, told",
    [
        (
            (*OVERSTRESSED, "prestress.t_Pa=1.9e6", "nucleation.overstress_Pa=1e5"),
            "= 100000 brings t to no more than 0.667 of",
        ),
        ((*TO_LEFT, "nucleation.overstress_Pa=-1e5"), "= -100000 brings -t to no more than 0.667 of mu_s p"),
        ((*TO_LEFT, "nucleation.overstress_Pa=1e5"), "which acts against t, brings -t to no more than"),
        ((*TO_LEFT, "nucleation.overstress_Pa=8e6"), "acts against t: slip begins against the load"),
        ((*COHESIVE, "prestress.t_Pa=3.5e6"), "and t is below cohesion_Pa + mu_s p at all nodes inside"),
        (
            (*COHESIVE, "prestress.t_Pa=2.4e6"),
            "the residual strength cohesion_Pa + mu_k p is nowhere below t",
        ),
    ],
)
def test_notes_follow_the_sign_of_the_load_and_the_cohesion(program, coarse, settings, told):
    printed = require_done(program("validate", coarse, *sets(*PRESSED, *settings))).stdout
    assert any(told in line for line in printed.splitlines() if line.startswith("note: ")), printed


def test_words_follow_the_sign_of_the_load(program, coarse):
    """Mechanics mirror: so do the words."""
    right = sets(*PRESSED, *OVERSTRESSED, "prestress.t_Pa=1.9e6", "nucleation.overstress_Pa=1e5")
    left = sets(*PRESSED, *TO_LEFT, "nucleation.overstress_Pa=-1e5")
    n_notes = [
        require_done(program("validate", coarse, *case)).stdout.count("note: ") for case in (right, left)
    ]
    assert n_notes[0] == n_notes[1] > 0
    printed = require_done(program("run", coarse, "-o", "out", *left)).stdout
    assert "prescribed tractions, t/p down to -0.38\n" in printed


def test_a_forced_patch_that_comes_too_late_is_told(program):
    case = CASES / "forced_speed_km_per_s.toml"
    told = "the forced patch is not of nucleation.half_length_m = 0.02 m before 0.04 s"
    for command in (["validate"], ["info"], ["run", "-o", "out"]):
        coarse = sets("plate.element_size_m=4e-3")
        printed = require_done(program(command[0], case, *command[1:], *coarse)).stdout
        assert told in printed
        assert "fronts as cracks" not in printed
    assert told in refusal(program("fracture", case))
    in_time = require_done(program("fracture", case, *sets("nucleation.front_speed_m_per_s=500"))).stdout
    assert "front to +x" in in_time
    assert "front to +x" in require_done(program("fracture", case, "--x", "0.1")).stdout


def test_laws_with_a_state_borrow_nothing_from_others(program, write_case):
    case = write_case(
        'plate = {element_size_m = 4e-3, height_m = 0.04, corner = "none", sides = "absorbing"}\n'
        'loading.method = "prestress"\nprestress.p_Pa = 5e6\nevent.kind = "nucleation"\n'
        'nucleation.form = "overstress"\nfriction.d_c_m = 2e-6\n[base]\nkind = "body"\nheight_m = 0.04\n'
        "youngs_modulus_Pa = 2.6e9\npoissons_ratio = 0.37\ndensity_kg_per_m3 = 1200\n"
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
        (["base.youngs_modulus_Pa=5e6", "loading.mean_pressure_Pa=5e6"], "modulus of the base, beyond small"),
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
