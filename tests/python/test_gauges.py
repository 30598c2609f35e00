# SPDX-License-Identifier: BSD-3-Clause
"""Strain gauges: the near-tip field fitted to made-up records and to a run's probes; records beside a run."""

from __future__ import annotations

import csv
import dataclasses

import numpy as np
import pytest
import slipfront
from slipfront import _core, gauges_command, tip_fit

PMMA = {"youngs_modulus_Pa": 5.65e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180.0}
OPTIONS = ["--youngs-modulus-pa", "5.65e9", "--poissons-ratio", "0.33", "--density-kg-per-m3", "1180"]
EQUAL = {"material": PMMA, "base": {"kind": "body", **PMMA}}
RIGID = {"material": PMMA}
TIME_S = np.arange(400) * 0.25e-6
TIP_S, SPEED, GAMMA = 52.3e-6, 900.0, 1.1


def record(case=EQUAL, direction=1, y_m=3.5e-3, tip_s=TIP_S, speed=SPEED, noise=0.0, seed=1, x_m=0.1):
    """The strains of a tip with the fracture energy GAMMA, with offsets and steps."""
    tip = _core.TipField(tip_fit.bodies_of(case), speed, direction)
    K = np.sqrt(GAMMA / tip.energy_per_K2)
    x = direction * speed * (tip_s - TIME_S)
    field = tip.strain_per_K(x, np.full_like(x, y_m))
    behind = np.arctan2(abs(y_m), direction * x) / np.pi
    random = np.random.default_rng(seed)
    values = {
        part: K * of + offset + step * behind + noise * random.standard_normal(x.size)
        for part, of, offset, step in zip(
            ("xx", "yy", "xy"), field, (2e-4, -5e-5, 1e-4), (1e-5, 0.0, -4e-5), strict=True
        )
    }
    return slipfront.Gauge("SG1", x_m, y_m, TIME_S, values)


@pytest.mark.parametrize("case, y_m", [(EQUAL, 3.5e-3), (EQUAL, -5e-3), (RIGID, 3.5e-3)])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_tip_without_noise_is_found(case, y_m, direction):
    fit = slipfront.fit_tip(record(case, direction, y_m), case)
    assert fit.direction == direction and fit.doubts == []
    # The search ends where a step lessens the sum of squares, here a rest of it, by 1e-9 of itself.
    assert fit.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=1e-4)
    assert fit.speed_m_per_s == pytest.approx(SPEED, rel=1e-4)
    assert fit.tip_s == pytest.approx(TIP_S, abs=1e-9)
    assert fit.offset["xx"] == pytest.approx(2e-4, rel=1e-3) and fit.step["xy"] == pytest.approx(
        -4e-5, rel=1e-2
    )


def test_errors_are_those_of_the_scatter():
    """Of many records with noise, each estimate is off by its error: the mean square of the quotient is 1."""
    fits = [slipfront.fit_tip(record(noise=5e-6, seed=k), EQUAL, direction=1, tip_s=TIP_S) for k in range(30)]
    for name, true in (("Gamma_J_per_m2", GAMMA), ("speed_m_per_s", SPEED), ("tip_s", TIP_S)):
        head, _, unit = name.partition("_")
        errors = np.array([getattr(f, f"{head}_error_{unit}") for f in fits])
        off = (np.array([getattr(f, name) for f in fits]) - true) / errors
        # chi-square of 30 degrees of freedom over 30: from 0.39 to 1.97 with 99.9 %.
        assert 0.39 < np.mean(off**2) < 1.97, name


def test_a_given_speed_is_kept():
    fit = slipfront.fit_tip(record(noise=1e-6), EQUAL, speed_m_per_s=SPEED)
    assert fit.speed_m_per_s == SPEED and np.isnan(fit.speed_error_m_per_s)
    free = slipfront.fit_tip(record(noise=1e-6), EQUAL)
    assert fit.Gamma_error_J_per_m2 < free.Gamma_error_J_per_m2


def test_two_passages_and_speeds_of_gauges():
    """A front to +x and, later, one to -x, past three gauges."""
    shown = []
    for k, x_m in enumerate((0.08, 0.1, 0.12)):
        there = record(tip_s=20e-6 + (x_m - 0.08) / 900, x_m=x_m)
        back = record(direction=-1, speed=1100.0, tip_s=75e-6 - (x_m - 0.08) / 1100, x_m=x_m)
        values = {part: there.values[part] + back.values[part] for part in there.values}
        shown.append(dataclasses.replace(there, name=f"SG{k + 1}", values=values))
    fits = slipfront.fit_tips(shown, EQUAL, passages=2, speed_m_per_s="gauges")
    assert [f.direction for f in fits] == [1, -1, 1, -1, -1, 1]
    # At SG2 they pass 15 us apart, which leaves its tips wrong by some 10 ns of the 22 us between gauges.
    assert [f.speed_m_per_s for f in fits] == pytest.approx([900, 1100, 900, 1100, 1100, 900], rel=2e-3)


@pytest.mark.parametrize("parts", [("xx",), ("xx", "yy"), ("xy",)])
def test_fewer_components_are_enough(parts):
    whole = record()
    fit = slipfront.fit_tip(
        dataclasses.replace(whole, values={p: whole.values[p] for p in parts}),
        EQUAL,
        tip_s=TIP_S,
        direction=1,
    )
    assert fit.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=1e-3)


def test_a_fit_allows_for_the_filter():
    gauge = record()
    filtered = gauge.prepared(low_pass_Hz=80e3)
    assert filtered.peak("yy") < 0.8 * gauge.peak("yy")
    fit = slipfront.fit_tip(filtered, EQUAL)
    assert fit.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=1e-3)
    unaware = slipfront.fit_tip(dataclasses.replace(filtered, smoothing_s=0.0), EQUAL)
    assert abs(unaware.Gamma_J_per_m2 / GAMMA - 1) > 0.05


def test_what_the_filter_does_to_a_wave():
    """At its frequency it leaves the half power, without delay."""
    time_s = np.arange(4000) * 1e-7
    wave = np.sin(2 * np.pi * 50e3 * time_s)
    filtered = slipfront.Gauge("A", 0, 1, time_s, {"xx": wave}).prepared(low_pass_Hz=50e3)
    middle = slice(500, -500)
    assert filtered.values["xx"][middle] == pytest.approx(wave[middle] / np.sqrt(2), abs=1e-3)


def test_a_record_of_something_else_is_doubted():
    random = np.random.default_rng(3)
    walk = {part: np.cumsum(random.standard_normal(TIME_S.size)) * 1e-6 for part in ("xx", "yy", "xy")}
    assert slipfront.fit_tip(slipfront.Gauge("A", 0, 3.5e-3, TIME_S, walk), EQUAL).doubts


def lines(gauge, header, columns):
    rows = [
        f"{gauge.name};100;3,5;{1e6 * t:.2f};" + ";".join(c(k) for c in columns) for k, t in enumerate(TIME_S)
    ]
    return "\n".join([f"gauge;x (mm);y_mm;t / us;{header}", *(row.replace(".", ",") for row in rows)]) + "\n"


def test_forms_of_records(tmp_path):
    """Strain in ustrain, gamma, arms of a rosette; stress."""
    gauge = record()
    xx, yy, xy = (gauge.values[part] for part in ("xx", "yy", "xy"))
    forms = {
        "strain_xx (ustrain);eps_yy;gamma_xy": (1e6 * xx, yy, 2 * xy),
        "strain_-45_ustrain;strain_90_ustrain;strain_45_ustrain": (
            1e6 * (0.5 * (xx + yy) - xy), 1e6 * yy, 1e6 * (0.5 * (xx + yy) + xy)
        ),
    }  # fmt: skip
    for header, values in forms.items():
        file = tmp_path / "gauges.csv"
        file.write_text(lines(gauge, header, [lambda k, v=v: f"{v[k]:.12g}" for v in values]))
        (read,) = slipfront.read_gauges(file)
        assert (read.name, read.x_m, read.y_m, read.is_strain) == ("SG1", 0.1, 3.5e-3, True)
        assert read.time_s == pytest.approx(TIME_S, abs=1e-12)
        for part in gauge.values:
            assert read.values[part] == pytest.approx(gauge.values[part], abs=1e-12)
    file.write_text("x_m,y_m,time_s,stress_xy_MPa\n0,1e-3,0,1\n0,1e-3,1e-6,2\n")
    (read,) = slipfront.read_gauges(file)
    assert not read.is_strain and list(read.values["xy"]) == [1e6, 2e6]


@pytest.mark.parametrize(
    "text, why",
    [
        ("x_m,y_m,time_s\n0,1,0\n", "has none of strain, stress"),
        ("x_m,y_m,strain_xx\n0,1,0\n", "has the columns 'x_m', 'y_m', 'strain_xx'; wanted are gauge, x, y"),
        ("x_m,y_m,time_s,stress_xx\n0,1,0,1\n", "has none of strain, stress"),
        ("x_m,y_m,time_s,strain_xx,stress_yy_Pa\n0,1,0,1,1\n", "several kinds"),
        ("x_m,y_m,time_s,strain_0,strain_90\n0,1,0,1,1\n", "a rosette has three arms, not 2"),
        ("x_m,y_m,time_s,strain_0,strain_180,strain_90\n0,1,0,1,1,1\n", "do not determine the strain"),
        ("x_m,y_m,time_s,strain_xx\n0,1,0,\n", "'strain_xx' has an empty cell"),
        ("x_m,y_m,time_s,strain_xx\n0,1,0,1\n0,2,1,1\n", "is at more than one place"),
        ("x_m,y_m,time_s,strain_xx\n0,1,1,1\n0,1,1,1\n", "two times or more that ascend"),
        ("x_m,y_m,time_s,strain_xx\n0,0,1,1\n0,0,2,1\n", "y must be finite and not 0"),
        ("x_m,y_m,time_s,strain_xx,strain_xy,gamma_xy\n0,1,0,1,1,1\n", "both gamma_xy and strain_xy"),
    ],
)
def test_bad_records_are_refused(tmp_path, text, why):
    file = tmp_path / "gauges.csv"
    file.write_text(text)
    with pytest.raises(slipfront.Error, match=why):
        slipfront.read_gauges(file)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A front between two blocks of PMMA, probes on both sides; Gamma = (mu_s - mu_k) p d_c/2 = 1.1 J/m2."""
    size = {"element_size_m": 1e-3, "height_m": 0.06, "sides": "absorbing"}
    return slipfront.run(
        {
            "plate": {"width_m": 0.15, "corner": "none", "top": "absorbing", **size},
            "material": {"stiffness_damping_s": 0.05e-6, **PMMA},
            "base": {"kind": "body", "height_m": 0.06, "sides": "absorbing", "bottom": "absorbing",
                     "stiffness_damping_s": 0.05e-6, **PMMA},
            "loading": {"method": "prestress"},
            "prestress": {"t_Pa": 1.8e6, "p_Pa": 5e6},
            "friction": {"law": "slip_weakening", "mu_s": 0.5, "mu_k": 0.3, "d_c_m": 2.2e-6},
            "event": {"kind": "nucleation"},
            "nucleation": {"form": "weakened", "x_m": 0.03, "half_length_m": 0.02, "taper_m": 5e-3},
            "time": {"end_s": 140e-6, "quiet_s": float("inf")},
            "probes": {"x_m": [0.0875, 0.1075, 0.1275, 0.1075], "y_m": [3.5e-3, 3.5e-3, 3.5e-3, -3.5e-3],
                       "names": ["SG1", "SG2", "SG3", "below"], "interval_s": 0.25e-6},
        },
        output=tmp_path_factory.mktemp("gauges") / "out",
    )  # fmt: skip


@pytest.fixture(scope="module")
def fits(run):
    return slipfront.fit_tips(slipfront.gauges_of(run), run)


def test_the_fracture_energy_of_a_run(run, fits):
    """To what docs/gauges.md states of a steady field: Gamma to 40 %, V to 10 % of that of the onsets."""
    fronts = run.fronts
    at = (fronts.direction_of_point == 1).values
    for fit in fits:
        assert fit.direction == 1 and fit.doubts == []
        assert fit.Gamma_J_per_m2 == pytest.approx(1.1, rel=0.4)
        near = at & (np.abs(fronts.x_m.values - fit.x_m) < 5e-3)
        slowness = np.polyfit(fronts.x_m.values[near], fronts.onset_s.values[near], 1)[0]
        assert fit.speed_m_per_s == pytest.approx(1 / slowness, rel=0.1)
    above, below = fits[1], fits[3]  # mirror images
    assert below.Gamma_J_per_m2 == pytest.approx(above.Gamma_J_per_m2, rel=1e-6)
    # Stress is strain by Hooke's law: the same field, weighted otherwise.
    of_stress = slipfront.fit_tip(slipfront.gauges_of(run, stress=True)[1], run)
    assert of_stress.Gamma_J_per_m2 == pytest.approx(1.1, rel=0.4)


def test_a_run_beside_its_own_probes(run):
    found = slipfront.compare_gauges(slipfront.gauges_of(run), run)
    assert float(found.shift_s) == 0 and found.notes == []
    assert np.all(found.misfit == 0) and np.all(found.own_misfit == 0)


def test_the_shift_of_clocks_is_found(run):
    shifted = [g.prepared(shift_s=-7.3e-6, window_s=(20e-6, 110e-6)) for g in slipfront.gauges_of(run)]
    found = slipfront.compare_gauges(shifted, run)
    # Rows of probes lie at steps, so that both are linear between other times.
    assert float(found.shift_s) == pytest.approx(7.3e-6, abs=1e-9)
    assert float(found.misfit.max()) < 1e-2
    filtered = [g.prepared(low_pass_Hz=200e3) for g in shifted]
    assert float(slipfront.compare_gauges(filtered, run).misfit.max()) < 2e-2
    late = dataclasses.replace(shifted[0], time_s=shifted[0].time_s + 5e-6)
    found = slipfront.compare_gauges([late, *shifted[1:]], run)
    assert list(found.own_shift_s) == pytest.approx([2.3e-6, 7.3e-6, 7.3e-6, 7.3e-6], abs=1e-9)


def test_places_between_probes(run):
    computed = slipfront.gauges_of(run)
    with pytest.raises(slipfront.CaseError, match="no probe at gauge A"):
        slipfront.compare_gauges([dataclasses.replace(computed[0], name="A", x_m=0.0975)], run)
    with pytest.raises(slipfront.CaseError, match="share less than half"):
        slipfront.compare_gauges([computed[0].prepared(shift_s=1.0)], run)


def refused(capsys, *arguments) -> str:
    assert gauges_command.main([str(a) for a in arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_the_command(run, fits, tmp_path, capsys):
    table, picture = tmp_path / "fits.csv", tmp_path / "fits.png"
    assert gauges_command.main([str(run.folder), "-o", str(table), "--figure", str(picture)]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].startswith("SG1: front to +x passes at ") and out[-1] == f"figure: {picture}"
    rows = list(csv.DictReader(table.read_text().splitlines()[1:]))
    assert [float(row["Gamma_J_per_m2"]) for row in rows] == [f.Gamma_J_per_m2 for f in fits]
    assert picture.read_bytes().startswith(b"\x89PNG")

    records = tmp_path / "records.csv"
    gauge = slipfront.gauges_of(run)[0]
    columns = (gauge.time_s, *gauge.values.values())
    text = ["x_m,y_m,time_s,strain_xx,strain_yy,strain_xy"]
    text += [
        f"{gauge.x_m},{gauge.y_m}," + ",".join(repr(float(v)) for v in row)
        for row in zip(*columns, strict=True)
    ]
    records.write_text("\n".join(text))
    assert gauges_command.main([str(records), "--compare", str(run.folder), "-o", str(table)]) == 0
    assert "misfit xx 0 %, yy 0 %, xy 0 %" in capsys.readouterr().out
    assert gauges_command.main([str(records), *OPTIONS, "--low-pass-hz", "3e5", "--zero-s", ",2e-5"]) == 0
    assert "the filter leaves" in capsys.readouterr().out

    assert "a record needs its bodies: --youngs-modulus-pa, " in refused(capsys, records)
    assert "a run has its own bodies" in refused(capsys, run.folder, *OPTIONS)
    assert "names the gauge 'B'" in refused(capsys, records, *OPTIONS, "--shift-s", "B=1")
    assert "--zero-s is 1 to 2 s" in refused(capsys, records, *OPTIONS, "--zero-s", "1,2")
    assert "--r-max-m is 0.001; it must be above" in refused(capsys, records, *OPTIONS, "--r-max-m", "1e-3")
    assert "not replaced" in refused(capsys, run.folder, "-o", records)
    assert "No such file" in refused(capsys, tmp_path / "none.csv", *OPTIONS)


def test_the_field_of_a_tip():
    x_m = np.array([[1e-3, -1e-3], [4e-3, -4e-3]])
    ahead, slow = (
        slipfront.tip_field(EQUAL, x_m, 0.0, speed_m_per_s=v, Gamma_J_per_m2=GAMMA, stress=True)["xy"]
        for v in (900.0, 0.0)
    )
    assert ahead[0, 0] == pytest.approx(2 * ahead[1, 0], rel=1e-12)  # as 1/sqrt(x)
    assert np.abs(ahead[:, 1]).max() < 1e-9 * ahead[1, 0]
    # At rest Gamma = K^2/E in plane stress.
    assert slow[0, 0] == pytest.approx(np.sqrt(GAMMA * 5.65e9 / (2 * np.pi * 1e-3)), rel=1e-7)
    with pytest.raises(slipfront.CaseError, match="the field ends at 1233"):
        slipfront.tip_field(EQUAL, 1e-3, 1e-3, speed_m_per_s=1300, Gamma_J_per_m2=1)


def test_unequal_bodies_have_no_field():
    unequal = {"material": PMMA, "base": {"kind": "body", **PMMA, "youngs_modulus_Pa": 70e9}}
    with pytest.raises(slipfront.CaseError, match="the bodies differ"):
        slipfront.fit_tip(record(), unequal)
