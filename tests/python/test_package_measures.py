# SPDX-License-Identifier: BSD-3-Clause
"""Fronts, criteria, fits and claims of a user's own arrays, with known answers."""

from __future__ import annotations

import any_events
import numpy as np
import pytest
import slipfront
import xarray as xr
from package_cases import CASE
from slipfront.measures import energy_density_J_per_m3

X_M = np.linspace(0, 0.2, 101)
SETTINGS = slipfront.FrontSettings(l_star_m=5e-3)


def test_speeds_of_a_front_to_both_sides():
    onset_s = np.where(X_M >= 0.12, (X_M - 0.12) / 900, (0.12 - X_M) / 600)
    found = slipfront.find_fronts(X_M, onset_s, settings=SETTINGS)
    assert list(found.direction.values) == [-1, 1]
    for front, speed in zip(found.front, (600, 900), strict=True):
        v = found.v_tip_m_per_s[found.front_id == front]
        v = v[np.isfinite(v)]
        assert v.size > 20
        assert np.allclose(v, speed, rtol=1e-9)
    assert np.isnan(found.t_s_Pa).all() and np.isnan(found.p_s_Pa).all()
    assert found.v_tip_m_per_s.attrs["units"] == "m/s"


def test_ends_of_fronts():
    onset_s = X_M / 1000.0
    onset_s[60:] = np.nan

    def ends(**options):
        return [str(e) for e in slipfront.find_fronts(X_M, onset_s, settings=SETTINGS, **options).end.values]

    assert ends() == ["record_end"]
    assert ends(end_time_s=1e-3) == ["arrest"]
    p_s = np.where(np.arange(101) < 60, 1e6, 0.0)
    assert ends(end_time_s=1e-3, t_s_Pa=0.5 * p_s, p_s_Pa=p_s) == ["contact_end"]


def test_a_camera_does_not_resolve_what_is_faster_than_its_frames():
    onset_s = X_M / 1000.0
    resolved = slipfront.find_fronts(X_M, onset_s, settings=SETTINGS, resolution_s=1e-6)
    assert np.isfinite(resolved.v_tip_m_per_s).any()
    blurred = slipfront.find_fronts(X_M, onset_s, settings=SETTINGS, resolution_s=1e-4)
    assert not np.isfinite(blurred.v_tip_m_per_s).any()


def test_no_slip_no_fronts():
    found = slipfront.find_fronts(X_M, np.full_like(X_M, np.nan))
    assert found.sizes == {"point": 0, "front": 0}


@pytest.fixture(scope="module")
def run():
    """A run whose history is as fine as its steps, so that its onsets can be found in it again."""
    return slipfront.run(CASE, {"output.history_interval_s": 1e-7})


def elastic(run):
    return {name: run.case["material"][name] for name in ("youngs_modulus_Pa", "poissons_ratio")}


def test_fronts_in_a_history_are_those_of_the_run(run):
    settings = slipfront.FrontSettings(mu_s=run.case["friction"]["mu_s"], **elastic(run))
    found = slipfront.find_fronts_in_history(run.history, run.tractions, settings=settings)
    longest = int(run.fronts.front_id.to_series().value_counts().index[0])
    # Nodes of the trigger zone slip at once, and in which order the history does not tell.
    ours, theirs = (
        fronts.isel(point=((fronts.front_id == longest) & (fronts.x_m > 0.03)).values)
        for fronts in (found, run.fronts)
    )
    assert ours.sizes["point"] > 20
    assert np.array_equal(ours.x_m, theirs.x_m)
    # Onsets in the steps, seen through a history that is finer than these: within a step and an interval.
    assert np.abs(ours.onset_s - theirs.onset_s).max() < run.info["dt_s"] + 1e-7
    assert np.array_equal(ours.t_s_Pa, theirs.t_s_Pa)
    assert str(found.end.sel(front=longest).values) == str(run.fronts.end.sel(front=longest).values)


def test_criteria(run):
    values = slipfront.criteria(run.fronts)
    fronts = run.fronts
    assert np.array_equal(values.static_ratio, fronts.t_s_Pa / fronts.p_s_Pa, equal_nan=True)
    assert np.array_equal(values.dynamic_ratio, fronts.t_d_Pa / fronts.p_d_Pa, equal_nan=True)
    rise = (fronts.U_r_J_per_m3 - fronts.U_s_J_per_m3) / fronts.U_s_J_per_m3
    assert np.array_equal(values.energy_rise, rise, equal_nan=True)
    assert np.isfinite(values.energy_rise).any()
    # U of the run's own points.
    U = energy_density_J_per_m3(fronts.t_d_Pa, fronts.p_d_Pa, **elastic(run))
    assert np.allclose(U, fronts.U_s_J_per_m3, rtol=1e-14, equal_nan=True)


def test_arrays_of_the_module_are_views():
    options = SETTINGS.options()
    from slipfront import _core

    ones = np.ones_like(X_M)
    (front,) = _core.find_fronts(X_M, X_M / 1000, ones, ones, 1.0, 0.0, options)
    a, b = front.x_m, front.x_m
    assert np.shares_memory(a, b)
    assert not a.flags.owndata and not a.flags.writeable
    del front
    assert np.allclose(a, X_M, rtol=0, atol=0)


def test_the_fit_finds_the_law_it_is_given():
    x = np.linspace(0.05, 3, 60)
    y = 0.7 + 1.9 * np.exp(-2.5 * np.sqrt(x))
    fit = slipfront.fit_exponential([(x[:30], y[:30]), (x[30:], y[30:])], resamples=50)
    assert [fit.a.value, fit.b.value, fit.c.value] == pytest.approx([0.7, 1.9, 2.5], rel=1e-6)
    assert fit.n_points == 60
    assert np.allclose(fit(x), y, rtol=1e-6)
    x_of_curve, y_of_curve, low, high = fit.curve()
    assert x_of_curve[[0, -1]] == pytest.approx([0.05, 3])
    assert np.allclose(y_of_curve, fit(x_of_curve))
    assert len(low) == len(high) == len(y_of_curve)
    assert [fit.a.low, fit.a.high] == pytest.approx([0.7, 0.7], rel=1e-6)
    with pytest.raises(ValueError, match="4"):
        slipfront.fit_exponential([(x[:3], y[:3])])
    with pytest.raises(ValueError, match="y has 2 values, not 3"):
        slipfront.fit_exponential([(x[:3], y[:2])])


def test_spread_and_rank():
    x = np.linspace(0, 1, 40)
    spread = slipfront.spread_at_equal_x([(x, np.full(40, 0.9)), (x, np.full(40, 1.1))], bins=4)
    assert spread.median_relative == pytest.approx(0.2)
    assert spread.n_bins == 4
    assert slipfront.rank_correlation(x, -(x**3)) == pytest.approx(-1)


def test_claims_of_four_events():
    """Of a coarse mesh: what each claim comes to there is the program's business."""
    outcomes = {}
    for name, changes in {
        "spontaneous": {"event.kind": "spontaneous"},
        "left": {"event.kind": "left"},
        "right": {"event.kind": "right"},
        "spontaneous_mu_k_1": {"event.kind": "spontaneous", "friction.mu_k": 1.0},
    }.items():
        event = slipfront.run(CASE, changes)
        outcomes[name] = any_events.outcome(event.case, event.history, event.tractions, name=name)
        assert outcomes[name].peak_x_m == pytest.approx(event.info["statics"]["peak_x_m"])
    claims = any_events.scorecard(**outcomes)
    by_id = {claim.id: claim for claim in claims}
    assert by_id["C1"].holds is not None
    assert by_id["C1"].how
    untested = [claim.id for claim in claims if claim.holds is None]
    assert "E1" in untested
    collapse = any_events.collapse(outcomes.values())
    assert collapse.n_points > 0
    assert collapse.fronts["energy_rise"].n_bins >= 0


def test_wave_speeds_are_those_of_a_run(run):
    material = run.case["material"]
    speeds = slipfront.wave_speeds(**material)
    told = run.info["wave_speeds"]
    for name in ("c_L_m_per_s", "c_S_m_per_s", "c_R_m_per_s"):
        assert getattr(speeds, name) == told[name]
    with pytest.raises(slipfront.CaseError, match="material.poissons_ratio"):
        slipfront.wave_speeds(poissons_ratio=0.7)


@pytest.mark.parametrize("damping", [{}, {"stiffness_damping_s": 5e-8}])
def test_stable_step_of_a_plate_without_corners(damping):
    case = {"plate": {"element_size_m": 2.5e-3}, "material": damping}
    info = slipfront.info(case)
    # Blocks of 32 x 32 squares and the plate's 40 x 20: within 1e-3 of each other.
    assert slipfront.stable_step_s(2.5e-3, **damping) == pytest.approx(info.stable_step_s, rel=2e-3)
    assert info.n_nodes == 2 * 41 * 21
    assert info.memory_bytes > 0


def test_well_posedness_is_that_of_the_case():
    plate = {"pressure_Pa": 5e6, "element_size_m": 5e-3, "longest_wavelength_m": 0.2}
    verdict = slipfront.well_posedness({"law": "velocity_weakening"}, **plate)
    assert verdict.unbounded == slipfront.info(CASE).well_posedness.unbounded
    stable = slipfront.well_posedness({"law": "coulomb", "mu": 0.1}, **plate)
    assert stable.weakening_over_radiation == 0
    assert stable.statement != verdict.statement


def test_outlook_of_a_case_is_that_of_its_run():
    """Tractions are given: nothing is found out in the run."""
    case = {
        "plate": {"element_size_m": 5e-3, "corner": "none"},
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": 1.9e6, "p_Pa": 5e6},
        "friction": {"law": "slip_weakening", "mu_s": 0.5, "mu_k": 0.3, "d_c_m": 1.5e-6},
        "event": {"kind": "nucleation"},
    }
    rupture = slipfront.info(case).rupture
    told = slipfront.run(case, progress=False).info["rupture"]
    assert told["strength_excess_S"]["median"] == pytest.approx(1.5)
    for name, value in told.items():
        ours = getattr(rupture, name)
        if isinstance(value, dict):
            ours = {key: getattr(ours, key) for key in value}
        assert ours == pytest.approx(value), name


EQUAL = {
    "kind": "body",
    "height_m": 0.1,
    "youngs_modulus_Pa": 2.6e9,
    "poissons_ratio": 0.37,
    "density_kg_per_m3": 1200,
}


@pytest.mark.parametrize(
    ("changed", "least_elements"),
    [
        ({"base": EQUAL}, 6),  # S = 3
        ({"prestress": {"t_Pa": 2.2e6, "p_Pa": 5e6}, "base": EQUAL}, 16),  # S = 0.6, equal bodies
        # On a rigid plane 0.1 h/c_S of damping times c_L is 2 % of the zone: c_L/c_S = sqrt(2/(1 - nu)).
        ({"plate": {"sides": "periodic"}, "base": {"kind": "rigid"}}, 5 * np.sqrt(2 / (1 - 0.37))),
    ],
)
def test_the_cheapest_mesh_resolves_the_process_zone(changed, least_elements):
    case = {
        "plate": {"element_size_m": 2e-3, "corner": "none"},
        "loading": {"method": "prestress"},
        "prestress": {"t_Pa": 1.75e6, "p_Pa": 5e6},
        "friction": {
            "law": "slip_weakening",
            "mu_s": 0.5,
            "mu_k": 0.3,
            "d_c_m": 3e-6,
            "regularisation": "none",
        },
        "event": {"kind": "nucleation"},
    }
    for table, keys in changed.items():
        case[table] = {**case.get(table, {}), **keys}
    info = slipfront.info(case)
    found = info.cheapest_mesh
    zone_m = info.rupture.process_zone_m
    assert found.coarsenings == 2
    assert found.process_zone_elements == pytest.approx(zone_m / found.element_size_m)
    assert least_elements <= found.process_zone_elements < 1.1 * least_elements
    case["plate"] |= {"element_size_m": found.element_size_m, "coarsenings": 2}
    if case["base"]["kind"] == "body":
        case["base"]["coarsenings"] = 2
    taken = slipfront.info(case)
    assert taken.n_nodes == found.n_nodes
    assert taken.cheapest_mesh.element_size_m == pytest.approx(found.element_size_m, rel=1e-12)


def test_the_cheapest_mesh_has_the_rows_that_are_sub_cycled():
    case = {
        "plate": {"width_m": 0.2, "height_m": 0.08},
        "material": {"youngs_modulus_Pa": 50e9, "poissons_ratio": 0.25, "density_kg_per_m3": 2650},
        "loading": {"mean_pressure_Pa": 5e6},
        "friction": {"mu_s": 0.7, "mu_k": 0.5, "d_c_m": 3e-6},
    }
    for base in ({}, {"kind": "rigid"}):
        found = slipfront.info(case, base=base).cheapest_mesh
        size = {"element_size_m": found.element_size_m, "coarsenings": found.coarsenings}
        like = base or {"coarsenings": found.coarsenings}
        assert slipfront.info(case, plate=size, base=like).n_nodes == found.n_nodes


def test_datasets_of_others_do():
    history = xr.Dataset(
        {
            "slip_rate_m_per_s": (("t", "x"), np.outer(np.arange(4) > 1, np.ones(3)) * 1.0),
            "t_Pa": (("t", "x"), np.ones((4, 3))),
            "p_Pa": (("t", "x"), np.full((4, 3), 2.0)),
        },
        {"time_s": ("t", np.arange(4.0)), "x_m": ("x", np.arange(3.0))},
    )
    found = slipfront.find_fronts_in_history(history, settings=slipfront.FrontSettings(min_length_m=1.0))
    assert np.array_equal(np.unique(found.t_s_Pa), [1.0])
    with pytest.raises(ValueError, match="threshold_m_per_s is 0; it must be above 0"):
        slipfront.find_fronts_in_history(history, threshold_m_per_s=0)


def test_a_tip_where_the_traction_peaks():
    """The threshold does not matter, as it does not to the tip of a rupture under rate and state."""
    run = slipfront.run(
        {
            "plate": {"width_m": 0.2, "height_m": 0.05, "element_size_m": 1e-3}
            | {"corner": "none", "sides": "absorbing", "top": "absorbing"},
            "loading": {"method": "prestress"},
            "prestress": {"t_Pa": 2.65e6, "p_Pa": 5e6},
            "friction": {"law": "rate_and_state_aging"},
            "base": {"kind": "rigid"},
            "event": {"kind": "nucleation"},
            "nucleation": {"form": "overstress", "overstress_Pa": 1.1e6, "half_length_m": 10e-3},
            "time": {"end_s": 80e-6},
            "output": {"history_interval_s": 0.25e-6},
        }
    )

    def onsets(threshold_m_per_s, tip):
        fronts = slipfront.find_fronts_in_history(
            run.history, threshold_m_per_s=threshold_m_per_s, tip=tip
        ).sortby("x_m")
        return fronts.onset_s.values[(fronts.x_m > 0.13) & (fronts.x_m < 0.16)]

    low, high = onsets(1e-3, "peak"), onsets(0.1, "peak")
    assert len(low) > 25
    assert np.array_equal(low, high)
    # The slip rate passes each threshold before that, the higher one later.
    assert (onsets(1e-3, "slip_rate") < onsets(0.1, "slip_rate")).all()
    assert (onsets(0.1, "slip_rate") < low).all()
    with pytest.raises(slipfront.CaseError, match="tip is 'top'; it must be 'slip_rate' or 'peak'"):
        onsets(1e-3, "top")
