# SPDX-License-Identifier: BSD-3-Clause
"""Objects put together in Python: the examples, views, and what is refused."""

from __future__ import annotations

import _thread
import gc
import runpy
import threading

import numpy as np
import pytest
import slipfront
from common import ROOT
from package_cases import refused

EXAMPLES = ROOT / "examples/compose"
PLATE = {"width_m": 0.04, "height_m": 0.02, "element_size_m": 2e-3, "corner": "none"}


def example(name: str) -> dict:
    return runpy.run_path(str(EXAMPLES / f"{name}.py"))


def plate(**changes) -> slipfront.Body:
    return slipfront.Body(slipfront.Mesh(**PLATE | changes))


def stepper(**changes) -> slipfront.Stepper:
    return slipfront.Stepper(plate(), slipfront.Interface(law="coulomb", mu=0.6), **changes)


def slips_of_run(**tables) -> dict[int, np.ndarray]:
    """Of a case's event by the number of steps."""
    slips = {}

    def look(state):
        slips[state.step] = state.slip_m.copy()

    slipfront.run(tables, progress=False, observers=[(2e-6, look)])
    return slips


def require_same(composed: slipfront.Stepper, slips: dict[int, np.ndarray]) -> None:
    """Bit for bit, and there is slip."""
    for step, slip_m in slips.items():
        composed.advance(step - composed.step)
        assert np.array_equal(composed.slip_m, slip_m)
    assert len(slips) > 10 and slip_m.max() > 1e-6


@pytest.mark.parametrize("name", ["rigid_plane", "two_bodies"])
def test_a_rupture_is_that_of_its_case(name):
    made = example(name)
    material = made["PMMA"] | made.get("DAMPING", {})
    tables = {
        "plate": made["PLATE"],
        "material": material,
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": made["T_PA"], "p_Pa": made["P_PA"]},
        "friction": made["FRICTION"],
        "event": {"kind": "nucleation"},
        "nucleation": {"form": "weakened", "x_m": made["PATCH_M"], "half_length_m": made["HALF_LENGTH_M"]}
        | {"taper_m": 0},
        "time": {"end_s": 50e-6},
    }
    tables["base"] = {"kind": "rigid"}
    if name == "two_bodies":
        below = made["ALUMINIUM"] | made["DAMPING"]
        tables["base"] = {"kind": "body", "height_m": made["PLATE"]["height_m"], **below}
    require_same(made["compose"](), slips_of_run(**tables))


def test_a_law_with_a_state_moves_as_in_its_case():
    material = {"plane": "strain", "stiffness_damping_s": 2e-8}
    tables = {"plate": PLATE, "material": material, "base": {"kind": "rigid"}}
    law = {"law": "rate_and_state_slip", "d_c_m": 1e-6, "V_i_m_per_s": 0.1}
    body = slipfront.Body(slipfront.Mesh(**tables["plate"]), **tables["material"])
    with pytest.raises(slipfront.CaseError, match="friction.tip_slip_rate_m_per_s has no default here"):
        slipfront.Stepper(body, slipfront.Interface(**law))
    law["tip_slip_rate_m_per_s"] = 0.01
    composed = slipfront.Stepper(body, slipfront.Interface(**law))
    composed.start(t_Pa=3.6e6, p_Pa=5e6)  # more than steady sliding takes
    loading = {"loading": {"method": "prestress"}, "prestress": {"t_Pa": 3.6e6, "p_Pa": 5e6}}
    case = tables | loading | {"friction": law, "event": {"kind": "none"}, "time": {"end_s": 100e-6}}
    require_same(composed, slips_of_run(**case))


def test_a_law_in_python_moves_as_the_law_that_it_copies():
    mu_s, mu_k, d_c_m = 0.7, 0.4, 2e-6

    def mu(slip_rate_m_per_s, slip_m):
        return mu_s - (mu_s - mu_k) * np.minimum(slip_m / d_c_m, 1)

    slips = []
    of_registry = {"law": "slip_weakening", "mu_s": mu_s, "mu_k": mu_k, "d_c_m": d_c_m}
    for law in (of_registry, {"law": mu, "mu_k": mu_k}):
        made = slipfront.Stepper(plate(), slipfront.Interface(**law))
        made.start(1.2e6, 2e6, strength_fraction=np.where(made.x_m < 0.01, 0, 1))
        made.advance(100)
        slips.append(made.slip_m.copy())
    assert slips[0].max() > d_c_m
    np.testing.assert_allclose(slips[1], slips[0], atol=1e-9 * slips[0].max())


def test_mistakes_of_a_law_in_python():
    def of_nothing(slip_rate_m_per_s, slip_m):
        return 0.6 if slip_m.max() == 0 else np.nan

    refused(lambda: slipfront.Interface(law=lambda rate: 0.6), TypeError)
    with pytest.raises(slipfront.CaseError, match=r"mu_s follows from the law, as mu\(0, 0\); remove it"):
        slipfront.Interface(law=of_nothing, mu_s=0.6)
    with pytest.raises(slipfront.CaseError, match="with a law in Python it must be 1"):
        slipfront.Stepper(plate(), slipfront.Interface(law=of_nothing), threads=2)
    made = slipfront.Stepper(plate(), slipfront.Interface(law=of_nothing))
    made.start(1.3e6, 2e6)
    with pytest.raises(slipfront.CaseError, match="mu gives a value that is below 0 or not finite"):
        made.advance(100)
    with pytest.raises(slipfront.CaseError, match="the stepper has failed"):
        made.advance(1)


def test_a_start_from_statics_is_that_of_its_case():
    tables = {
        "plate": PLATE | {"width_m": 0.1, "height_m": 0.05, "corner": "relief"},
        "material": {"plane": "strain", "stiffness_damping_s": 5e-8},
        "base": {"kind": "rigid"},
        "friction": {"law": "velocity_weakening", "mu_s": 0.9},
        "time": {"end_s": 100e-6},
    }
    body = slipfront.Body(slipfront.Mesh(**tables["plate"]), **tables["material"])
    composed = slipfront.Stepper(body, slipfront.Interface(**tables["friction"]))
    composed.start_from_statics(1 + 1e-3, tilt_left_m=1e-4, tilt_right_m=5e-5)
    assert composed.t_Pa.max() > 0 and composed.slip_m.max() == 0
    loading = {"tilt_left_m": 1e-4, "tilt_right_m": 5e-5}
    require_same(composed, slips_of_run(**tables, loading=loading, event={"kind": "spontaneous"}))


def test_the_examples_tell_what_they_find(capsys):
    for name in ("rigid_plane", "two_bodies", "own_loading"):
        example(name)["main"]()
    told = capsys.readouterr().out
    assert told.count(" us: slip at x = ") == 5 and "aluminium has moved" in told


def test_a_loading_of_ones_own_begins_slip_where_and_when_friction_says():
    made = example("own_loading")
    composed = made["compose"]()
    began_s = made["inject"](composed, 30e-6)
    # The plate is at rest until then: the contact bears the pressure that is given.
    needed_Pa = made["T_PA"] / made["FRICTION"]["mu_s"]
    set_s = np.arange(0, composed.step, made["EVERY"]) * composed.step_s
    overcome_s = next(s for s in set_s if made["pressure_Pa"](made["WELL_M"], s) < needed_Pa)
    assert began_s == pytest.approx(overcome_s + made["EVERY"] * composed.step_s, rel=1e-12)
    assert composed.x_m[composed.slip_m.argmax()] == made["WELL_M"]


def test_energies_balance():
    made = example("rigid_plane")
    composed = made["compose"]()
    composed.run_until(30e-6)
    terms = composed.energies()
    assert terms["friction_work_J_per_m"] < 0 < terms["kinetic_J_per_m"]
    # Rounding, 1e-16 of the terms in each of some 60 steps.
    assert abs(terms["imbalance_J_per_m"]) < 1e-12 * terms["prestress_work_J_per_m"]


def test_views_follow_the_stepper_and_outlive_their_names():
    body = plate(sides="periodic", top="free")
    composed = slipfront.Stepper(body, slipfront.Interface(law="coulomb", mu=0.6))
    composed.start(0.5e6, 1e6)
    views = [composed.slip_m, composed.t_Pa, *composed.displacement_m(), *composed.velocity_m_per_s()]
    assert all(np.shares_memory(composed.displacement_m()[k], views[2 + k]) for k in (0, 1))
    composed.set_tractions(0.7e6, 1e6)
    assert composed.advance(50) == 50 and composed.step == 50
    assert np.array_equal(views[0], views[2][: len(views[0])]) and views[0].min() > 0
    # All of it slides: shear alone, which does not change the pressure.
    assert (composed.slip_rate_m_per_s > 0).all()
    assert np.allclose(views[1], 0.6e6, rtol=1e-9) and np.allclose(composed.p_Pa, 1e6, rtol=1e-9)
    for view in views:
        with pytest.raises(ValueError, match="read-only"):
            view[0] = 1
        with pytest.raises(ValueError, match="WRITEABLE"):
            view.flags.writeable = True
    kept = views[2].copy()
    del composed
    gc.collect()
    assert np.array_equal(views[2], kept)


def test_a_mesh_outlives_its_name():
    mesh = slipfront.Mesh(**PLATE)
    x_m, cells = mesh.x_m, mesh.cells
    assert np.allclose(x_m[mesh.interface_nodes], np.linspace(0, 0.04, 21), rtol=1e-15)
    assert cells.shape == (200, 4) and cells.max() + 1 == len(x_m) == len(mesh.y_m)
    del mesh
    gc.collect()
    assert x_m[20] == 0.04


def test_objects_are_printed_as_what_they_were_made_of():
    friction = slipfront.Interface(law="coulomb", mu=0.6)
    made = '<interface: contact.algorithm = direct, friction.law = "coulomb", friction.mu = 0.6>'
    assert repr(friction) == made
    assert repr(stepper()).startswith("<stepper at step 0: plate.width_m = 0.04, ")
    assert repr(slipfront.Mesh()) == "<mesh>"


def test_threads_and_calls_do_not_change_the_motion():
    ends = []
    for threads, calls in ((1, [60]), (2, [1, 9, 50])):
        body = plate(width_m=0.2, height_m=0.1)
        composed = slipfront.Stepper(body, slipfront.Interface(), threads=threads, interface_substeps=6)
        composed.start(0.5e6, 1e6, shear_speed_m_per_s=0.1)
        for n in calls:
            composed.advance(n)
        ends.append(np.concatenate(composed.displacement_m()))
    assert np.array_equal(*ends) and ends[0].max() > 0


@pytest.mark.parametrize(
    "work, says",
    [
        (lambda: slipfront.Mesh(widht_m=0.1), "unknown key plate.widht_m; did you mean plate.width_m?"),
        (lambda: slipfront.Mesh(width_m=-1), "plate.width_m is -1 m; it must be greater than 0 m"),
        (lambda: slipfront.Mesh(width_m=0.1, element_size_m=0.03), "plate.element_size_m"),
        (lambda: slipfront.Mesh(**PLATE | {"width_m": 1e9, "height_m": 1e9}), "nodes, choose a larger one"),
        (lambda: slipfront.Body(slipfront.Mesh(**PLATE), E=1), "did you mean material.youngs_modulus_Pa?"),
        (lambda: slipfront.Interface(law="glue"), 'friction.law is "glue"; it must be one of'),
        (lambda: slipfront.Interface(law="slip_table", table_mu=[0.6]), "must be of one length"),
        (lambda: slipfront.Interface(contact="penalty"), 'contact.algorithm is "penalty"'),
        (lambda: stepper(step_factor=2), "time.step_factor is 2, beyond the stable step"),
        (lambda: stepper(end_s=1), "time.end_s does nothing here"),
        (lambda: stepper(threads=0), "threads is 0; it must be at least 1"),
        (lambda: stepper(interface_rows=99), "time.interface_rows"),
        (lambda: stepper(below=plate(width_m=0.02)), "do not face each other"),
        (lambda: stepper(below=plate(corner="relief", relief_length_m=4e-3)), "do not face each other"),
        (lambda: stepper().advance(1), "has not started; call start"),
        (lambda: stepper().slip_m, "has not started; call start"),
        (lambda: stepper().start([1, 2], 1e6), "t_Pa has 2 values; give a number, or one for each of 21"),
        (lambda: stepper().start(np.nan, 1e6), "t_Pa holds a value that is not finite"),
        (lambda: stepper().start(0, 0), "p_Pa must be above 0"),
        (lambda: stepper().start(0, 1e6, strength_fraction=2), "strength_fraction must be between 0 and 1"),
        (lambda: stepper().start_from_statics(method="ramp"), "loading.method must be direct here"),
        (lambda: stepper().start_from_statics(tilt_left_m=1), "loading.tilt_left_m"),
    ],
)
def test_what_cannot_be_is_refused(work, says):
    assert says in refused(work, slipfront.CaseError)


def test_what_a_started_stepper_refuses():
    composed = stepper()
    composed.start(0, 1e6)
    for work, says in (
        (lambda: composed.start(0, 1e6), "has started already"),
        (lambda: composed.advance(-1), "-1 steps are asked for"),
        (lambda: composed.run_until(np.nan), "nan steps are asked for"),
        (lambda: composed.run_until(np.inf), "inf steps are asked for"),
    ):
        with pytest.raises(slipfront.CaseError, match=says):
            work()
    with pytest.raises(IndexError, match="body is 0"):
        composed.displacement_m(1)
    assert composed.run_until(10.5 * composed.step_s) == 11
    assert composed.run_until(11 * composed.step_s) == composed.run_until(0) == 0


def test_a_motion_that_blows_up_is_told_once_and_for_all():
    composed = stepper(step_factor=1.5, allow_unstable=True, interface_substeps=1)
    composed.start(0.7e6, 1e6)
    with pytest.raises(slipfront.BlowUpError, match="reduce time.step_factor"):
        composed.advance(10_000)
    with pytest.raises(slipfront.CaseError, match="has failed; make another one"):
        composed.advance(1)


def test_other_threads_go_on_and_ctrl_c_ends_an_advance():
    composed = stepper()
    composed.start(0, 1e6)
    told = []

    def meanwhile():
        while composed.step == 0:
            pass
        told.append(refused(lambda: composed.advance(1), slipfront.CaseError))
        _thread.interrupt_main()

    other = threading.Thread(target=meanwhile)
    other.start()
    with pytest.raises(KeyboardInterrupt, match="interrupted after step"):
        composed.advance(10**12)
    other.join()
    assert told == [
        "the stepper is already advancing: do not call it from its friction law or from another thread"
    ]
    step = composed.step
    assert composed.advance(2) == 2 and composed.step == step + 2
