# SPDX-License-Identifier: BSD-3-Clause
"""Fracture mechanics of a run's fronts, and fronts predicted as cracks."""

from __future__ import annotations

import os
import re

import numpy as np
import pytest
import slipfront
import xarray as xr
from common import ROOT, refusal, require_done, rows_of, sets
from package_cases import program, write_case

PMMA = {"youngs_modulus_Pa": 5.6e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180.0}
DAMPED = PMMA | {"stiffness_damping_s": 0.05e-6}
BODIES = {"material": PMMA, "base": {"kind": "body", **PMMA}}
# Alike bodies; Gamma = (mu_s - mu_k) p d_c/2 = 1 J/m2, 10 elements in the process zone.
CASE = {
    "plate": {"width_m": 0.3, "height_m": 0.1, "element_size_m": 0.5e-3, "corner": "none"}
    | {"sides": "absorbing", "top": "absorbing"},
    "material": DAMPED,
    "base": {"kind": "body", "height_m": 0.1, "sides": "absorbing", "bottom": "absorbing", **DAMPED},
    "loading": {"method": "prestress"},
    "prestress": {"t_Pa": 2.35e6, "p_Pa": 5e6},
    "friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_k": 0.4, "d_c_m": 2e-6},
    "event": {"kind": "nucleation"},
    "nucleation": {"form": "weakened", "x_m": 0.15, "half_length_m": 16e-3, "taper_m": 4e-3},
    "time": {"end_s": 150e-6, "quiet_s": np.inf},
    "fronts": {"l_star_m": 3e-3},
    "output": {"history_interval_s": 0.5e-6},
}
GAMMA = 1.0
C_R = 1227.6


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return slipfront.run(CASE, output=tmp_path_factory.mktemp("fracture") / "out", progress=False)


def complete(run):
    """Points of the front to the right, outside the patch, whose breakdown came to its end."""
    table = run.fracture
    chosen = (table.breakdown_complete == 1) & (table.direction == 1) & (table.x_m > 0.18)
    return table.isel(point=chosen.to_numpy())


def test_breakdown_work_is_the_fracture_energy(run):
    points = complete(run)
    assert points.sizes["point"] > 60
    # Steps of slip in the zone: the work is of first order in them.
    np.testing.assert_allclose(points.breakdown_work_J_per_m2, GAMMA, rtol=1e-3)
    np.testing.assert_allclose(points.peak_t_Pa, 3e6, rtol=1e-6)
    np.testing.assert_allclose(points.residual_t_Pa, 2e6, rtol=1e-6)
    np.testing.assert_allclose(points.stress_drop_Pa, 0.35e6, rtol=1e-6)
    np.testing.assert_allclose(points.weakening_distance_m, 2e-6, rtol=1e-3)
    known = points.cohesive_zone_m.notnull().to_numpy()
    zone_m = points.v_tip_m_per_s * points.weakening_time_s
    np.testing.assert_allclose(points.cohesive_zone_m[known], zone_m[known])
    assert points.K_Pa_sqrt_m.attrs["units"] == "Pa m1/2"


def test_slip_behind_the_tip_gives_the_same_energy(run):
    points = complete(run)
    slow = points.isel(point=(points.v_tip_m_per_s < 0.9 * C_R).to_numpy())
    G = slow.G_slip_J_per_m2.dropna("point")
    assert G.sizes["point"] > 10
    # The cohesive zone is 5 % of the half-length.
    assert abs(float(G.median()) / GAMMA - 1) < 0.05


def test_friction_work_is_breakdown_and_heat(run):
    work = run.info["friction_work"]
    whole = -float(run.energies.friction_work_J_per_m[-1])
    assert work["breakdown_J_per_m"] + work["residual_J_per_m"] == pytest.approx(whole)
    # Every node that has broken takes Gamma, the weakened patch less.
    assert 0.9 * GAMMA * 0.24 < work["breakdown_J_per_m"] < GAMMA * 0.3


def test_speeds_are_predicted(run):
    predicted = slipfront.predict_fronts(CASE)
    assert predicted.attrs["starts"] and predicted.attrs["arrests"] == []
    right = predicted.isel(point=(predicted.direction == 1).to_numpy())
    points = complete(run)
    inside = points.isel(point=((points.x_m > 0.2) & (points.x_m < 0.28)).to_numpy())
    expected = np.interp(inside.x_m, right.x_m, right.v_tip_m_per_s)
    ratio = inside.v_tip_m_per_s.to_numpy() / expected
    assert np.nanmedian(abs(ratio - 1)) < 0.1  # as far as the zone is short against the crack


def test_a_run_predicts_by_its_own_friction(run):
    by_law, by_run = slipfront.predict_fronts(CASE), slipfront.predict_fronts(run)
    np.testing.assert_array_equal(by_run.x_m, by_law.x_m)
    beyond = abs(by_run.x_m - 0.15) > 20e-3  # the taper has less
    np.testing.assert_allclose(by_run.fracture_energy_J_per_m2[beyond], GAMMA, rtol=1e-3)


def test_the_program_predicts_the_same(tmp_path):
    write_case(tmp_path, CASE)
    said = require_done(program("fracture", "case.toml", "-o", "fronts.csv", cwd=tmp_path)).stdout
    assert "first crack 0.0365 m: it runs" in said
    assert said.count("through to the end of the contact") == 2
    assert (tmp_path / "fronts.csv").read_text().startswith("# fronts by slipfront fracture\n")
    rows = rows_of(tmp_path / "fronts.csv")
    predicted = slipfront.predict_fronts(CASE)
    for name in ("x_m", "G_static_J_per_m2", "v_tip_m_per_s", "time_s"):
        np.testing.assert_array_equal([float(row[name]) for row in rows], predicted[name])
    info = require_done(program("info", "case.toml", cwd=tmp_path)).stdout
    assert "fronts as cracks                the first crack, 0.0365 m, runs\n" in info
    wide = sets("nucleation.half_length_m=0.2")
    said = require_done(program("fracture", "case.toml", *wide, cwd=tmp_path)).stdout
    assert said.endswith("first crack 0.3005 m: the whole interface\n")


def test_the_program_replaces_no_other_file(tmp_path):
    write_case(tmp_path, CASE)
    (tmp_path / "mine.csv").write_text("direction,x_m\n")
    said = refusal(program("fracture", "case.toml", "-o", "mine.csv", cwd=tmp_path))
    told = "mine.csv: is there and not a table of slipfront fracture: not replaced; give another name with -o"
    assert said == told and (tmp_path / "mine.csv").read_text() == "direction,x_m\n"
    os.mkfifo(tmp_path / "pipe")
    assert "pipe: is no regular file" in refusal(program("fracture", "case.toml", "-o", "pipe", cwd=tmp_path))
    for _ in range(2):
        require_done(program("fracture", "case.toml", "-o", "fronts.csv", cwd=tmp_path))


def test_a_short_crack_waits():
    predicted = slipfront.predict_fronts(CASE, at_x_m=0.15)
    assert not predicted.attrs["starts"]
    # Griffith: 2 E Gamma/(pi drop^2), to one element.
    griffith_m = 2 * 5.6e9 * GAMMA / (np.pi * 0.35e6**2)
    assert predicted.attrs["critical_length_m"] == pytest.approx(griffith_m, abs=0.5e-3)


def test_friction_that_does_not_weaken_is_a_barrier():
    changes = {"friction.mu_s": 0.4, "nucleation.form": "overstress", "prestress.t_Pa": 2.1e6}
    predicted = slipfront.predict_fronts(CASE, changes)
    assert not predicted.attrs["starts"] and np.isnan(predicted.attrs["critical_length_m"])


@pytest.mark.parametrize("width_m", [2.0065, 4.0])
def test_a_long_interface_has_larger_elements_and_says_so(width_m):
    """Whatever divides it."""
    predicted = slipfront.predict_fronts(CASE, plate={"width_m": width_m}, nucleation={"x_m": width_m / 2})
    assert predicted.attrs["starts"]
    assert ["what is shorter is smeared" in note for note in predicted.attrs["notes"]] == [True]
    assert predicted.attrs["first_length_m"] == pytest.approx(0.036, abs=3e-3)


@pytest.mark.parametrize(
    "changes, note",
    [
        ({"plate.sides": "periodic", "base.sides": "periodic"}, "periodic sides count as ends"),
        ({"prestress.t_rate_Pa_per_s": 1e9}, "count as at the start"),
        ({"prestress.t_Pa": 3.1e6}, "t is beyond mu_s p at 601 of 601 nodes inside"),
        ({"plate.top": "free"}, "edges are left out"),
        ({"nucleation.form": "overstress", "nucleation.overstress_Pa": 1e4}, "brings t to no more than"),
    ],
)
def test_what_it_leaves_out_is_noted(changes, note):
    notes = slipfront.predict_fronts(CASE, changes).attrs["notes"]
    assert any(note in each for each in notes)


def test_a_run_without_the_table_predicts_nothing(tmp_path):
    old = slipfront.run(CASE, {"time.end_s": 2e-6}, output=tmp_path / "out", progress=False)
    listed = tmp_path / "out/checksums.sha256"
    listed.write_text("".join(line for line in listed.open() if "fracture.csv" not in line))
    (tmp_path / "out/fracture.csv").unlink()
    old = slipfront.open(tmp_path / "out")
    assert len(old.fracture) == 0
    with pytest.raises(slipfront.CaseError, match="no fracture.csv with numbers"):
        slipfront.predict_fronts(old)


def test_rate_and_state_has_the_fracture_energy_of_its_state():
    case = ROOT / "examples/rate-and-state/case.toml"
    coarse = {"plate.element_size_m": 1e-3}
    run = slipfront.run(case, coarse, progress=False)
    points = run.fracture
    inside = (points.breakdown_complete == 1) & (points.x_m > 0.05) & (points.x_m < 0.13)
    points = points.isel(point=inside.to_numpy())
    predicted = slipfront.predict_fronts(case, coarse)
    assert any("slip at 1 m/s" in note for note in predicted.attrs["notes"])
    right = predicted.isel(point=(predicted.direction == 1).to_numpy())
    expected = np.interp(points.x_m, right.x_m, right.fracture_energy_J_per_m2)
    # Slip rates are not 1 m/s: psi_ss changes by b times their logarithm, a tenth of its fall.
    np.testing.assert_allclose(points.breakdown_work_J_per_m2, expected, rtol=0.2)


def test_the_sample_with_a_held_edge():
    edges = {"plate.top": "loaded", "plate.sides": "free", "base.bottom": "held", "base.sides": "free"}
    held = slipfront.predict_fronts(CASE, edges)
    assert held.attrs["bodies"] == "the sample, its far edges held"
    # Held edges take what the crack would release beyond them: it is twice as long as a body is high.
    both = (held, slipfront.predict_fronts(CASE))
    at = [data.isel(point=(data.direction == 1).to_numpy()) for data in both]
    G_held, G_open = (np.interp(0.25, data.x_m, data.G_static_J_per_m2) for data in at)
    assert G_held < G_open


def test_a_law_without_a_length_has_no_fracture_energy(tmp_path):
    case = CASE | {"friction": {"law": "velocity_weakening", "mu_s": 0.6, "mu_k": 0.4}}
    told = "no fracture energy of its own; give it by fracture_energy_J"
    with pytest.raises(slipfront.CaseError, match=told):
        slipfront.predict_fronts(case)
    assert slipfront.predict_fronts(case, fracture_energy_J_per_m2=GAMMA).attrs["starts"]
    write_case(tmp_path, case)
    said = refusal(program("fracture", "case.toml", cwd=tmp_path))
    assert re.match(r"case.toml:\d+: friction.law = .* give it by --fracture-energy$", said)
    assert refusal(program("fracture", "case.toml", "--fracture-energy", "-1", cwd=tmp_path))


@pytest.mark.parametrize(
    "options, said",
    [
        ({"fracture_energy_J_per_m2": 0.0}, "must be above 0"),
        ({"fracture_energy_J_per_m2": "much"}, "must be a number"),
        ({"fracture_energy_J_per_m2": ([0.1, 0.0], [1.0, 1.0])}, "x ascending"),
        ({"fracture_energy_J_per_m2": ([0.0, 0.1], [1.0])}, "2 places and 1 values"),
        *(
            ({"fracture_energy_J_per_m2": given}, "a pair of arrays: places in m, and values")
            for given in ([1, 2], ([0.1], 2), (0.1, [2.0]))
        ),
        ({"residual_coefficient": np.nan}, "must be finite"),
        ({"at_x_m": np.inf}, "must be finite"),
        ({"residual_coefficient": -0.1}, "it must be from 0 to 100"),
        ({"residual_coefficient": 1e300}, "it must be from 0 to 100"),
        ({"at_x_m": 0.31}, "at_x_m is 0.31 m; the interface goes from 0 to 0.3 m"),
    ],
)
def test_options_refused(options, said):
    with pytest.raises(slipfront.CaseError, match=said):
        slipfront.predict_fronts(CASE, **options)


STEP_M, WIDTH_M, SPACING_M = 70e-3, 0.5, 0.5e-3


def stepped(before: float, beyond: float) -> np.ndarray:
    """By place: a value within STEP_M of the middle, another one beyond."""
    x_m = np.arange(0, WIDTH_M + SPACING_M / 2, SPACING_M)
    return np.where(abs(x_m - WIDTH_M / 2) < STEP_M, before, beyond)


@pytest.mark.slow
@pytest.mark.parametrize(
    "key, columns",
    [
        ("prestress", {"t_Pa": stepped(2.35e6, 1.75e6), "p_Pa": stepped(5e6, 5e6)}),
        ("prestress", {"t_Pa": stepped(2.35e6, 2.35e6), "p_Pa": stepped(5e6, 6.6e6)}),
        ("friction", {"d_c_m": stepped(2e-6, 24e-6)}),
    ],
    ids=["shear", "pressure", "fracture energy"],
)
def test_fronts_arrest_beyond_the_prediction_by_their_cohesive_zone(key, columns, tmp_path):
    """The table of docs/fracture.md. The tip is the head of the zone, and has momentum: two zones; where it
    meets longer ones less than one, which is 9 pi/32 mu* d_c/(strength drop) at rest."""
    x_m = np.arange(0, WIDTH_M + SPACING_M / 2, SPACING_M)
    file = tmp_path / "steps.csv"
    table = np.column_stack([x_m, *columns.values()])
    np.savetxt(file, table, delimiter=",", header=",".join(["x_m", *columns]), comments="")
    changes = {"plate.width_m": WIDTH_M, "plate.height_m": 0.15, "base.height_m": 0.15}
    changes |= {"nucleation.x_m": 0.25, "time.end_s": 500e-6, f"{key}.file": str(file)}
    case = {name: table for name, table in CASE.items() if name != "prestress" or key != name}
    predicted = slipfront.predict_fronts(case, changes)
    assert predicted.attrs["arrests"] == [-1, 1]
    right = predicted.isel(point=(predicted.direction == 1).to_numpy())
    expected_m = float(right.x_m[-1]) - 0.25
    run = slipfront.run(case, changes, progress=False)
    fronts = run.fronts
    assert [str(end) for end in fronts.end.values] == ["arrest", "arrest"]
    found_m = float(fronts.x_m.where(fronts.direction_of_point == 1).max()) - 0.25
    points = complete(run)
    most_m = 3 * float(points.cohesive_zone_m.median())
    if key == "friction":
        most_m = 9 * np.pi / 32 * (5.6e9 / 2) * 24e-6 / 1e6
    assert expected_m <= found_m < expected_m + most_m


@pytest.mark.parametrize(
    "interval_s, work_error, time_error", [(0.5e-6, 0.05, 0.2), (0.2e-6, 0.01, 0.1), (0.1e-6, 0.005, 0.08)]
)
def test_a_history_gives_what_the_run_has(run, interval_s, work_error, time_error):
    """The table of docs/other-codes.md: the peak lies between two samples."""
    if interval_s != CASE["output"]["history_interval_s"]:
        run = slipfront.run(CASE, {"output.history_interval_s": interval_s}, progress=False)
    found = slipfront.fracture_of_history(run.history, run.fronts, run)
    np.testing.assert_array_equal(found.x_m, run.fracture.x_m)
    assert set(found.variables) == set(run.fracture.variables)
    assert [note.endswith("Gamma is rough") for note in found.notes] == [True] * (interval_s == 0.5e-6)
    both = (found.breakdown_complete == 1) & (run.fracture.breakdown_complete == 1)
    both &= np.abs(run.fracture.x_m - 0.15) > 0.03  # outside of the patch
    found, own = (of.isel(point=both.to_numpy()) for of in (found, run.fracture))
    for name, error in (
        ("breakdown_work_J_per_m2", work_error),
        ("weakening_distance_m", 2 * work_error),
        ("K_Pa_sqrt_m", work_error),
        ("weakening_time_s", time_error),
        ("cohesive_zone_m", time_error),
        ("G_slip_J_per_m2", 0.01),
    ):
        ratio = (found[name] / own[name]).dropna("point")
        assert ratio.sizes["point"] > 60 and abs(float(ratio.median()) - 1) < error, name
    np.testing.assert_allclose(found.residual_coefficient, own.residual_coefficient, rtol=1e-6)
    np.testing.assert_allclose(found.stress_drop_Pa, own.stress_drop_Pa, rtol=1e-3)


D_C_M, SLIP_RATE, FRONT_SPEED = 2e-6, 1.0, 500.0


def made_history(pressure_rise=0.0, interval_s=0.1e-6):
    """A front to each side at 500 m/s; friction falls from 0.6 to 0.4 over d_c, linear in slip, under a
    pressure that rises by a share over the same slip."""
    time_s, x_m = np.arange(0, 40e-6, interval_s), np.linspace(-5e-3, 5e-3, 41)
    slipping_s = np.round(time_s[:, None] - 5e-6 - np.abs(x_m) / FRONT_SPEED, 12)
    weakened = np.clip(SLIP_RATE * slipping_s / D_C_M, 0, 1)
    p_Pa = 5e6 * (1 + pressure_rise * weakened)
    return {
        "time_s": time_s,
        "x_m": x_m,
        "slip_m": SLIP_RATE * np.maximum(slipping_s, 0),
        "slip_rate_m_per_s": np.where(slipping_s > 0, SLIP_RATE, 0.0),
        "t_Pa": np.where(slipping_s >= 0, 0.6 - 0.2 * weakened, 0.45) * p_Pa,
        "p_Pa": p_Pa,
    }


def fronts_in(history):
    settings = slipfront.FrontSettings(l_star_m=1e-3, min_length_m=2e-3)
    return slipfront.find_fronts_in_history(history, settings=settings)


def fracture_in(history, **options):
    return slipfront.fracture_of_history(history, fronts_in(history), BODIES, **options)


@pytest.mark.parametrize("pressure_rise", [0.0, 0.3])
def test_a_history_of_known_fracture_energy(pressure_rise):
    found = fracture_in(made_history(pressure_rise))
    assert sorted(set(found.direction.values)) == [-1, 1]
    # Its slip is that of no elastic body.
    assert all(note.startswith("G by slip is ") for note in found.notes)
    assert (found.breakdown_complete == 1).all()
    # int (mu - mu_r) p d slip, mu - mu_r = 0.2 (1 - s), p = p_0 (1 + rise s) over s = slip/d_c. 20 trapezoids
    # of what is not linear leave 1/20^2 of it.
    gamma = 0.2 * 5e6 * D_C_M * (0.5 + pressure_rise / 6)
    np.testing.assert_allclose(found.breakdown_work_J_per_m2, gamma, rtol=2e-3)
    np.testing.assert_allclose(found.peak_t_Pa, 3e6, rtol=1e-9)
    np.testing.assert_allclose(found.residual_coefficient, 0.4, rtol=1e-9)
    np.testing.assert_allclose(found.stress_drop_Pa, 0.45 * 5e6 - found.residual_t_Pa, rtol=1e-9)
    known = found.v_tip_m_per_s.notnull()
    zone = (found.v_tip_m_per_s * found.weakening_time_s).where(known, drop=True)
    np.testing.assert_allclose(found.cohesive_zone_m.where(known, drop=True), zone)
    assert float(found.K_Pa_sqrt_m.median()) > 0


def test_the_page_of_other_codes_runs():
    """The last code of docs/other-codes.md, which takes a history of any origin."""
    text = (ROOT / "docs/other-codes.md").read_text(encoding="utf-8")
    *_, code = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    history = made_history()
    names = {"slipfront": slipfront, "history": history, "fronts": fronts_in(history)}
    exec(code, names)
    np.testing.assert_allclose(names["fracture"].breakdown_work_J_per_m2, 1.0, rtol=1e-6)


def test_slip_to_the_left_has_the_same_energy():
    history = made_history()
    for name in ("slip_m", "slip_rate_m_per_s", "t_Pa"):
        history[name] = -history[name]
    np.testing.assert_allclose(fracture_in(history).breakdown_work_J_per_m2, 1.0, rtol=1e-6)


def test_cohesion_is_no_part_of_the_coefficients():
    found = fracture_in(changed(t_Pa=made_history()["t_Pa"] + 1e6), cohesion_Pa=1e6)
    np.testing.assert_allclose(found.breakdown_work_J_per_m2, 1.0, rtol=1e-6)
    np.testing.assert_allclose(found.residual_coefficient, 0.4, rtol=1e-9)
    np.testing.assert_allclose(found.residual_t_Pa, 3e6, rtol=1e-9)


@pytest.mark.parametrize("share, notes", [(1.0, 0), (0.95, 0), (0.85, 1), (0.5, 1), (1.15, 1)])
def test_slip_that_its_rate_does_not_make(share, notes):
    """Slip of one side with the rate of both halves the work; worth a note from 10 % on."""
    found = fracture_in(changed(slip_m=share * made_history()["slip_m"]))
    np.testing.assert_allclose(found.breakdown_work_J_per_m2, share, rtol=1e-6)
    assert sum(note.startswith("slip_m grows by ") for note in found.notes) == notes


def changed(**new):
    return {**made_history(), **new}


@pytest.mark.parametrize(
    "history, said",
    [
        (None, "history has no 'time_s'"),
        ({k: v for k, v in made_history().items() if k != "slip_m"}, "history has no 'slip_m'"),
        (changed(slip_m=1e3 * made_history()["slip_m"]), "slip_m grows by .* give m, m/s and s"),
        (changed(time_s=1e6 * made_history()["time_s"]), "slip_m grows by .* give m, m/s and s"),
        (changed(t_Pa=np.full_like(made_history()["t_Pa"], np.nan)), r"history\['t_Pa'\] holds a value that"),
        (changed(p_Pa=made_history()["p_Pa"][:-1]), "must be an array"),
        (
            {k: v if k == "x_m" else v[:80] for k, v in made_history().items()},
            "no front's breakdown came to its end",
        ),
        (made_history(interval_s=2e-6), "the breakdown falls between them; give finer ones"),
    ],
)
def test_histories_refused(history, said):
    with pytest.raises(slipfront.CaseError, match=said):
        slipfront.fracture_of_history(history, fronts_in(made_history()), BODIES)


def test_predictions_and_notes_are_kept_in_netcdf(tmp_path):
    found = fracture_in(changed(slip_m=0.5 * made_history()["slip_m"]))
    assert len(found.notes) == 2
    predicted = slipfront.predict_fronts(CASE)
    for data in (found, predicted):
        data.to_netcdf(tmp_path / "made.nc", engine="h5netcdf")
        with xr.open_dataset(tmp_path / "made.nc", engine="h5netcdf") as kept:
            assert kept.equals(data)
            np.testing.assert_equal(np.atleast_1d(kept.attrs["notes"]), np.atleast_1d(data.attrs["notes"]))


def test_units_and_fronts_refused():
    history = made_history()
    fronts = fronts_in(history)
    in_MPa = xr.DataArray(history["t_Pa"] / 1e6, attrs={"units": "MPa"})
    for given, those, bodies, said in (
        (changed(t_Pa=in_MPa), fronts, BODIES, r"history\['t_Pa'\] is in MPa; give it in Pa"),
        (history, None, BODIES, "fronts has no 'front_id'"),
        (history, fronts.assign_coords(x_m=fronts.x_m + 1), BODIES, "no place of the history"),
        (history, fronts.isel(point=slice(0)), BODIES, "fronts: there are none"),
        (history, fronts.isel(point=slice(None, None, -1)), BODIES, "do not follow its direction"),
        (history, fronts, None, "case is None"),
    ):
        with pytest.raises(slipfront.CaseError, match=said):
            slipfront.fracture_of_history(given, those, bodies)
    pressures = changed(p_Pa=history["p_Pa"] / 1e6)
    note = slipfront.fracture_of_history(pressures, fronts, BODIES).notes[-1]
    assert note.startswith("residual_coefficient is 4e+05, not from") and "units of t_Pa and p_Pa" in note


def test_a_run_predicts_where_it_knows_friction(run):
    notes = slipfront.predict_fronts(run).attrs["notes"]
    assert any(note.startswith("friction beyond ") for note in notes)
    with pytest.raises(slipfront.Error, match="friction of an opened run is what it came to"):
        slipfront.predict_fronts(run, {"friction.mu_k": 0.2})


def test_what_a_trigger_takes_away_does_not_count():
    pushed = {"nucleation.form": "overstress", "nucleation.overstress_Pa": 1.2e6}
    stays = slipfront.predict_fronts(CASE, pushed)
    goes = slipfront.predict_fronts(CASE, pushed, event={"trigger_duration_s": 3e-6})
    assert float(stays.G_static_J_per_m2[0]) > 2 * float(goes.G_static_J_per_m2[0])


def test_a_patch_across_a_seam_is_refused():
    seam = {"plate.sides": "periodic", "base.sides": "periodic", "nucleation.x_m": 0.0}
    with pytest.raises(slipfront.Error, match="seam of a periodic plate"):
        slipfront.predict_fronts(CASE, seam)


def test_slip_before_the_event_changes_nothing(run):
    history = run.history.load()
    moved = history.assign(slip_m=history.slip_m + 1e-3)
    before, after = (slipfront.fracture_of_history(h, run.fronts, run) for h in (history, moved))
    np.testing.assert_allclose(after.G_slip_J_per_m2, before.G_slip_J_per_m2, rtol=1e-6)


def test_histories_are_told_by_names_and_units(run):
    history = run.history.load()
    fronts = slipfront.find_fronts_in_history(history)
    xr.testing.assert_equal(slipfront.find_fronts_in_history(history.transpose()), fronts)
    wrong = history.assign_coords(x_m=history.x_m.assign_attrs(units="mm"))
    with pytest.raises(slipfront.Error, match=r"history\['x_m'\] is in mm; give it in m"):
        slipfront.find_fronts_in_history(wrong)


def test_bodies_that_do_not_belong_to_a_history_are_noted(run):
    soft = {"youngs_modulus_Pa": 1.12e9, "poissons_ratio": 0.33, "density_kg_per_m3": 236}
    bodies = {"material": soft, "base": {"kind": "body", **soft}}
    found = slipfront.fracture_of_history(run.history, run.fronts, bodies)
    assert any("times the breakdown work: check units, bodies" in note for note in found.notes)


TOUGH_ENDS = (np.array([0.0, 0.0799, 0.08, 0.22, 0.2201, 0.3]), np.array([1e3, 1e3, GAMMA, GAMMA, 1e3, 1e3]))


@pytest.mark.parametrize(
    "changes, doubt",
    [
        ({}, None),
        ({"prestress.t_Pa": 2.5e6}, "S = 1, below 1.77"),
        ({"nucleation.form": "overstress", "nucleation.overstress_Pa": 1e6}, "the trigger's force"),
    ],
)
def test_no_arrest_is_foretold_where_statics_do_not_tell_it(changes, doubt):
    """Where the bodies get tougher."""
    predicted = slipfront.predict_fronts(CASE, changes, fracture_energy_J_per_m2=TOUGH_ENDS)
    found = predicted.attrs
    assert found["arrests"] == [-1, 1]
    last = predicted.isel(point=np.isnan(predicted.time_s).to_numpy())
    np.testing.assert_allclose(last.x_m, [0.079, 0.221], atol=0.6e-3)
    assert [doubt in told for told in found["doubts_of_arrest"]] == ([] if doubt is None else [True])
    assert any(note.startswith("no arrest is predicted") for note in found["notes"]) == (doubt is not None)


def test_the_program_says_so(tmp_path):
    """A barrier by friction that does not weaken."""
    write_case(tmp_path, CASE)
    (tmp_path / "mu_s.csv").write_text("x_m,mu_s\n0,0.4\n0.05,0.4\n0.051,0.6\n0.249,0.6\n0.25,0.4\n0.3,0.4\n")
    for command in ("info", "fracture"):
        changes = sets("prestress.t_Pa=2.5e6", "friction.file=mu_s.csv")
        said = require_done(program(command, "case.toml", *changes, cwd=tmp_path)).stdout
        assert "arrests at" not in said and "no arrest is predicted" in said


#: A strip: G is the same all along.
STRIP = {
    "plate": {"width_m": 0.2, "height_m": 0.007, "element_size_m": 0.5e-3, "corner": "none"},
    "base": {"kind": "body", "height_m": 0.007, **PMMA},
    "material": PMMA,
    "loading": {"method": "prestress"},
    "prestress": {"t_Pa": 2.35e6, "p_Pa": 5e6},
    "friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_k": 0.4, "d_c_m": 2e-8},
    "event": {"kind": "nucleation"},
    "nucleation": {"x_m": 0.1, "half_length_m": 40e-3},
}


def test_the_sample_counts_as_it_is():
    """Its height, too: elements of a third of the size change G by their own error alone."""

    def G(h_m):
        found = slipfront.predict_fronts(STRIP, plate={"element_size_m": h_m})
        assert not any("elements are" in note for note in found.attrs["notes"])
        x_m, G = (found[name][found.direction == 1] for name in ("x_m", "G_static_J_per_m2"))
        return float(np.interp(0.17, x_m, G))

    # A strip, both of whose far edges are held: t^2 H/(2 G_s) of each body.
    strip = 2 * 0.35e6**2 * 0.007 / (2 * 5.6e9 / (2 * 1.33))
    assert G(0.5e-3) == pytest.approx(strip, rel=0.02)
    assert G(0.25e-3) == pytest.approx(strip, rel=0.01)


def test_what_is_larger_is_said_with_its_error():
    found = slipfront.predict_fronts(STRIP, plate={"width_m": 0.9}, nucleation={"x_m": 0.45})
    note = next(note for note in found.attrs["notes"] if note.startswith("elements are"))
    change = float(re.search(r"heights change by (\S+) %", note)[1])
    assert change < 3


def test_on_the_rigid_plane_the_error_of_the_mesh_is_told():
    case = STRIP | {"base": {"kind": "rigid"}}
    found = [slipfront.predict_fronts(case, plate={"element_size_m": h}) for h in (0.5e-3, 0.25e-3)]
    note = next(note for note in found[0].attrs["notes"] if note.startswith("slip changes the pressure"))
    told = float(re.search(r"by (\S+) % for", note)[1])
    G = [float(f.G_static_J_per_m2[(f.direction == 1).to_numpy()][0]) for f in found]
    assert 0.5 * told < abs(100 * (G[0] / G[1] - 1)) < 2 * told


def test_nucleation_length_of_an_edge_is_of_a_patch_from_it():
    """Whatever the trigger's zone."""
    case = {name: table for name, table in STRIP.items() if name != "nucleation"}
    lengths = []
    for zone_m in (5e-3, 20e-3):
        edge = {"event": {"kind": "left", "trigger_zone_m": zone_m}}
        found = slipfront.predict_fronts(case | edge, {"friction.d_c_m": 2e-6})
        lengths.append(found.attrs["nucleation_length_m"])
    assert lengths[0] == lengths[1]


def test_a_prediction_by_a_run_without_a_length_says_so(tmp_path):
    note = "the friction law has no length: its fracture energy is that of the run's mesh"
    friction = {"friction": {"law": "velocity_weakening"}, "base": {"kind": "rigid"}}
    case = {"plate": {"element_size_m": 5e-3}, "event": {"kind": "left"}} | friction
    of_mesh = slipfront.run(case, output=tmp_path / "out", progress=False)
    assert note in slipfront.predict_fronts(of_mesh).attrs["notes"]
    assert note not in slipfront.predict_fronts(of_mesh, fracture_energy_J_per_m2=GAMMA).attrs["notes"]
