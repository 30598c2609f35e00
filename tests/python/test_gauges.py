# SPDX-License-Identifier: BSD-3-Clause
"""Strain gauges: the near-tip field fitted to made-up records and to a run's probes; records beside a run."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
import slipfront
from common import ROOT, rows_of
from package_cases import blocks
from package_cases import refused as one_refusal
from slipfront import gauges, gauges_command, near_tip, tip_fit

PMMA = {"youngs_modulus_Pa": 5.65e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180.0}
OPTIONS = ["--youngs-modulus-pa", "5.65e9", "--poissons-ratio", "0.33", "--density-kg-per-m3", "1180"]
EQUAL = {"material": PMMA, "base": {"kind": "body", **PMMA}}
RIGID = {"material": PMMA, "base": {"kind": "rigid"}}
TIME_S = np.arange(400) * 0.25e-6
TIP_S, SPEED, GAMMA = 52.3e-6, 900.0, 1.1


def record(
    case=EQUAL,
    direction=1,
    y_m=3.5e-3,
    tip_s=TIP_S,
    speed=SPEED,
    noise=0.0,
    seed=1,
    x_m=0.1,
    zone_m=0.0,
    **zone,
):
    """The strains of a tip with the fracture energy GAMMA, with offsets and steps."""
    tip = near_tip.TipField(near_tip.bodies_of(case), speed, direction, zone_m, **zone)
    x = direction * speed * (tip_s - TIME_S)
    field = np.sqrt(GAMMA) * tip.strain(x, np.full_like(x, y_m))
    behind = np.arctan2(abs(y_m), direction * x) / np.pi
    random = np.random.default_rng(seed)
    values = {
        part: of + offset + step * behind + noise * random.standard_normal(x.size)
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
    assert fit.offset["xx"] == pytest.approx(2e-4, rel=1e-3)
    assert fit.step["xy"] == pytest.approx(-4e-5, rel=1e-2)


@pytest.mark.parametrize(
    "noise, low_pass_Hz, zone_m", [(1e-6, None, 0), (5e-6, 200e3, 0), (2e-6, None, 5e-3)]
)
def test_errors_are_those_of_the_scatter(noise, low_pass_Hz, zone_m):
    """Of many records with noise, each estimate is off by its error: the mean square of the quotient is 1. A
    zone is fitted where there is one: that of a singular tip has one side alone."""
    records = [
        record(noise=noise, seed=k, zone_m=zone_m).prepared(low_pass_Hz=low_pass_Hz) for k in range(30)
    ]
    known = {"direction": 1, "tip_s": TIP_S} | ({} if zone_m else {"zone_m": 0})
    fits = [slipfront.fit_tip(gauge, EQUAL, **known) for gauge in records]
    if zone_m:
        low, zone, high = np.array([(f.zone_low_m, f.cohesive_zone_m, f.zone_high_m) for f in fits]).T
        off = (zone - zone_m) / np.where(zone > zone_m, zone - low, high - zone)
        assert 0.39 < np.mean(off**2) < 1.97
    for name, true in (("Gamma_J_per_m2", GAMMA), ("speed_m_per_s", SPEED), ("tip_s", TIP_S)):
        head, _, unit = name.partition("_")
        errors = np.array([getattr(f, f"{head}_error_{unit}") for f in fits])
        off = (np.array([getattr(f, name) for f in fits]) - true) / errors
        # chi-square of 30 degrees of freedom over 30: from 0.39 to 1.97 with 99.9 %.
        assert 0.39 < np.mean(off**2) < 1.97, name


def test_noise_takes_nothing_from_what_residuals_that_follow_one_another_add():
    """A residual of 100 s^2 that follows itself for 20 times, and white noise of as much."""
    random = np.random.default_rng(5)
    smooth = np.convolve(random.standard_normal(40_020), np.ones(20) / 20, "valid")[None, :40_000]
    smooth *= 10 / smooth.std()
    noisy = smooth + 10 * random.standard_normal(smooth.shape)
    # The sum of (1 - k/20) over all lags is 20; of both together 100 * 20 + 100.
    assert tip_fit.correlated(smooth) == pytest.approx(20, rel=0.1)
    assert tip_fit.correlated(noisy) * noisy.var() == pytest.approx(2100, rel=0.15)


def test_a_given_speed_is_kept():
    fit = slipfront.fit_tip(record(noise=1e-6), EQUAL, speed_m_per_s=SPEED)
    assert fit.speed_m_per_s == SPEED and np.isnan(fit.speed_error_m_per_s)
    free = slipfront.fit_tip(record(noise=1e-6), EQUAL)
    assert free.doubts == []
    assert fit.Gamma_error_J_per_m2 < free.Gamma_error_J_per_m2


def test_two_passages_and_speeds_of_gauges():
    """A front to +x and, later, one to -x, past three gauges."""
    shown = []
    for k, x_m in enumerate((0.08, 0.1, 0.12)):
        there = record(tip_s=20e-6 + (x_m - 0.08) / 900, x_m=x_m)
        back = record(direction=-1, speed=1100.0, tip_s=75e-6 - (x_m - 0.08) / 1100, x_m=x_m)
        values = {part: there.values[part] + back.values[part] for part in there.values}
        shown.append(dataclasses.replace(there, name=f"SG{k + 1}", values=values))
    fits = slipfront.fit_tips(shown, EQUAL, passages=2)
    assert [f.direction for f in fits] == [1, -1, 1, -1, -1, 1]
    assert [f.speed_m_per_s for f in fits] == pytest.approx([900, 1100, 900, 1100, 1100, 900], rel=2e-3)
    assert [f.Gamma_J_per_m2 for f in fits] == pytest.approx([GAMMA] * 6, rel=2e-3)
    assert not any("the tip's times" in doubt or "give passages" in doubt for f in fits for doubt in f.doubts)


GRANITE = {"youngs_modulus_Pa": 51e9, "poissons_ratio": 0.25, "density_kg_per_m3": 2630.0}


def granite_stress(y_m, seed, x_m=0.0, V=2404.0, Gamma=0.21, zone_m=13.8e-3, case=None):
    """Granite as in Kammer and McLaskey (2019), 1 kPa of noise, samples of 1 us."""
    time_s = np.arange(200) * 1e-6
    x = V * (100e-6 - time_s) + x_m
    tip = near_tip.TipField(near_tip.bodies_of(case or of_granite()), V, 1, zone_m)
    random = np.random.default_rng(seed)
    stress = np.sqrt(Gamma) * tip.stress(x, np.full_like(x, y_m)) + 1e3 * random.standard_normal((3, 200))
    return slipfront.Gauge(
        f"{1e3 * y_m:g} mm", x_m, y_m, time_s, dict(zip(("xx", "yy", "xy"), stress, strict=True)), False
    )


def of_granite():
    return {"material": GRANITE, "base": {"kind": "body", **GRANITE}}


@pytest.mark.parametrize("apart_m", [0.0, 0.05])
def test_a_zone_longer_than_the_gauges_are_high(apart_m):
    """Gauges 1, 5 and 10 mm high at one place or along x: each and together back to 2 %."""
    heights = (1e-3, 5e-3, 10e-3)
    shown = [granite_stress(y_m, k, k * apart_m) for k, y_m in enumerate(heights)]
    alone = slipfront.fit_tips(shown, of_granite())
    together = slipfront.fit_front(shown, of_granite(), alone=alone)
    one = slipfront.fit_front(shown, of_granite(), alone=alone, one_speed=True)
    for fit in (*alone, *together, *one):
        assert fit.doubts == []
        assert fit.Gamma_J_per_m2 == pytest.approx(0.21, rel=0.02)
        assert fit.cohesive_zone_m == pytest.approx(13.8e-3, rel=0.02)
        assert fit.speed_m_per_s == pytest.approx(2404, rel=0.002)
        assert fit.strength_drop_Pa == pytest.approx(0.451e6, rel=0.02)
    assert {f.together for f in together} == {3} and len({f.Gamma_J_per_m2 for f in together}) == 1
    assert together[0].Gamma_error_J_per_m2 < alone[2].Gamma_error_J_per_m2


def test_a_speed_along_x_and_a_zone_that_goes_with_it():
    """A front that speeds up past four gauges: Gamma and tau_p - tau_r are the same, X_c follows the
    speed."""
    x_m = np.array([0.0, 0.02, 0.04, 0.06])
    speeds = np.array([700.0, 800.0, 900.0, 1000.0])
    # dx/dt = 700 + 5000 x
    tips = 30e-6 + np.log(1 + 5000 * x_m / 700) / 5000
    drop = near_tip.TipField(near_tip.bodies_of(EQUAL), 900.0, 1, 3e-3).drop_per_root
    shown, zones = [], []
    for k in range(4):
        zones.append(
            (near_tip.TipField(near_tip.bodies_of(EQUAL), speeds[k], 1, 1.0).drop_per_root / drop) ** 2
        )
        made = record(tip_s=tips[k], speed=speeds[k], x_m=x_m[k], noise=1e-6, zone_m=zones[k], seed=k)
        shown.append(dataclasses.replace(made, name=f"SG{k}"))
    fits = slipfront.fit_front(shown, EQUAL)
    assert zones[0] > 1.2 * zones[3]
    assert [f.speed_m_per_s for f in fits] == pytest.approx(list(speeds), rel=0.02)
    assert [f.cohesive_zone_m for f in fits] == pytest.approx(zones, rel=0.05)
    assert fits[0].Gamma_J_per_m2 == pytest.approx(GAMMA, rel=0.03)


def test_above_the_shear_speed():
    """Equal bodies, V between c_S and c_L: Gamma and X_c of the field there."""
    gauge = record(speed=1700.0, zone_m=4e-3, noise=1e-6)
    fit = slipfront.fit_tip(gauge, EQUAL)
    assert fit.doubts == [] and np.isnan(fit.K_Pa_sqrt_m)
    assert fit.speed_m_per_s == pytest.approx(1700, rel=0.01)
    assert fit.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=0.03)
    assert fit.cohesive_zone_m == pytest.approx(4e-3, rel=0.05)


def test_a_zone_of_slip_alone_fits_its_own_records():
    gauge = record(zone_m=6e-3, zone="slip", noise=1e-6)
    by_slip, by_distance = (slipfront.fit_tip(gauge, EQUAL, zone=zone) for zone in ("slip", "linear"))
    assert by_slip.cohesive_zone_m == pytest.approx(6e-3, rel=0.02)
    assert by_slip.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=0.02)
    assert by_distance.cohesive_zone_m < 0.93 * 6e-3 and by_slip.residual_of_all < by_distance.residual_of_all


def test_what_the_record_does_not_determine():
    """A gauge 10 mm above a zone of 1 mm, with noise, sees none; xy alone with a free V trades all."""
    far = slipfront.fit_tip(record(y_m=10e-3, zone_m=1e-3, noise=2e-6), EQUAL)
    assert far.zone_high_m - far.zone_low_m > 0.5e-3  # of a zone of 1 mm
    assert far.Gamma_J_per_m2 == pytest.approx(GAMMA, abs=3 * far.Gamma_error_J_per_m2)
    alone = record(zone_m=8e-3, noise=1e-5)
    fit = slipfront.fit_tip(dataclasses.replace(alone, values={"xy": alone.values["xy"]}), EQUAL, direction=1)
    assert "xy alone hardly tells V" in "; ".join(fit.doubts)


def test_no_front_for_all_gauges():
    one, other = record(), dataclasses.replace(record(tip_s=TIP_S + 2e-6), name="SG2", x_m=0.12)
    with pytest.raises(slipfront.CaseError, match="make 1e\\+04 m/s, at which there is no field"):
        slipfront.fit_front([one, other], EQUAL)
    late = dataclasses.replace(record(tip_s=TIP_S - 20e-6), name="SG2", x_m=0.12)
    with pytest.raises(slipfront.CaseError, match="do not follow one another"):
        slipfront.fit_front([one, late], EQUAL)
    with pytest.raises(slipfront.CaseError, match="no front passes two gauges or more"):
        slipfront.fit_front([one], EQUAL)


@pytest.mark.parametrize(
    "late_us, y_m, doubts",
    [
        ((0, 0, 0), 3.5e-3, [[], [], []]),
        ((0, 15, 0), 3.5e-3, [[537.3], [537.3, 2769], [2769]]),
        ((0, 0, 0), 1.75e-3, [[900], [900, 900], [900]]),  # V is fitted as less than half
    ],
)
def test_times_at_neighbours_that_make_another_speed(late_us, y_m, doubts):
    shown = []
    for name, x_m, late in zip("ABC", (0.0, 0.02, 0.04), late_us, strict=True):
        gauge = record(tip_s=1e-6 * (30 + late) + x_m / 900, x_m=x_m, noise=1e-6)
        shown.append(dataclasses.replace(gauge, name=name, y_m=y_m))
    for fit, speeds in zip(slipfront.fit_tips(shown, EQUAL), doubts, strict=True):
        assert len(fit.doubts) == len(speeds)
        for doubt, speed in zip(fit.doubts, speeds, strict=True):
            found, above = re.fullmatch(
                r"the tip's times at . and . make (\S+) m/s(, above c_L, 2318 m/s,|) where the fits have V = "
                r"\S+ and \S+ m/s: check their clocks, places and heights y",
                doubt,
            ).groups()
            assert float(found) == pytest.approx(speed, rel=0.01) and bool(above) == (speed > 2318)


def test_a_second_passage_is_doubted():
    first = record(tip_s=35e-6, noise=1e-6)
    second = record(direction=-1, tip_s=65e-6, speed=1000.0)
    both = dataclasses.replace(first, values={p: v + second.values[p] for p, v in first.values.items()})
    (fit,) = slipfront.fit_tips([both], EQUAL)
    told = r"fronts at (\S+), (\S+) us explain more, with Gamma (\S+), (\S+) J/m2: give passages 2"
    numbers = [float(text) for text in re.fullmatch(told, fit.doubts[-1]).groups()]
    assert numbers == pytest.approx([35, 65, GAMMA, GAMMA], rel=0.1)
    for each in slipfront.fit_tips([both], EQUAL, passages=2):
        assert each.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=0.1)
        assert not any("give passages" in doubt for doubt in each.doubts)


def test_arms_at_wrong_places_turn_the_sign_of_K():
    turned = {part: -v for part, v in record(noise=1e-6).values.items()}
    gauge = dataclasses.replace(record(), values=turned)
    assert slipfront.fit_tip(gauge, EQUAL).doubts == ["K is negative: the body above slips to -x"]
    assert slipfront.fit_tip(dataclasses.replace(gauge, doubts=("arms",)), EQUAL).doubts == ["arms"]


@pytest.mark.parametrize("parts", [("xx",), ("xx", "yy"), ("xy",)])
def test_fewer_components_are_enough(parts):
    whole = record()
    fewer = dataclasses.replace(whole, values={p: whole.values[p] for p in parts})
    fit = slipfront.fit_tip(fewer, EQUAL, tip_s=TIP_S, direction=1)
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


def noise_alone(name="A", seed=3, smooth=1.0):
    """Of a gauge that no front passes."""
    kernel = tip_fit.gaussian(smooth)
    random = np.random.default_rng(seed)
    rows = random.standard_normal((3, TIME_S.size + len(kernel) - 1))
    values = (tip_fit.smooth(1e-5 * row, kernel) for row in rows)
    return slipfront.Gauge(name, 0.12, 3.5e-3, TIME_S, dict(zip(("xx", "yy", "xy"), values, strict=True)))


def test_a_record_of_something_else_is_doubted():
    random = np.random.default_rng(3)
    walk = {part: np.cumsum(random.standard_normal(TIME_S.size)) * 1e-6 for part in ("xx", "yy", "xy")}
    assert slipfront.fit_tip(slipfront.Gauge("A", 0, 3.5e-3, TIME_S, walk), EQUAL).doubts


@pytest.mark.parametrize("smooth", [0.0, 4.0])
@pytest.mark.parametrize("seed", range(2))
def test_a_gauge_that_no_front_passes(smooth, seed):
    fit = slipfront.fit_tip(noise_alone(seed=seed, smooth=smooth), EQUAL)
    assert not fit.has_tip and fit.direction == 0
    assert np.isnan([fit.Gamma_J_per_m2, fit.speed_m_per_s, fit.tip_s]).all()
    assert fit.doubts[0].startswith("no front passes: no change stands out of the noise")


def test_one_gauge_without_a_front_leaves_the_others():
    quiet = dataclasses.replace(record(), name="B", values={"xx": np.zeros(TIME_S.size)})
    gauges = [record(), noise_alone(), quiet, dataclasses.replace(record(tip_s=TIP_S + 20e-6), x_m=0.118)]
    fits = slipfront.fit_tips(gauges, EQUAL)
    assert [fit.has_tip for fit in fits] == [True, False, False, True]
    assert "nothing changes" in fits[2].doubts[0] and "give a larger r_max_m" in fits[2].doubts[0]
    two = slipfront.fit_tips([record()], EQUAL, passages=2)
    assert [fit.has_tip for fit in two] == [True, False]
    assert two[0].Gamma_J_per_m2 == pytest.approx(GAMMA, rel=1e-3)


def scaled(strain=1.0, y=1.0, time=1.0):
    gauge = record(noise=1e-6)
    values = {part: strain * v for part, v in gauge.values.items()}
    return dataclasses.replace(gauge, values=values, y_m=y * gauge.y_m, time_s=time * gauge.time_s)


def of_material(**factors):
    material = {name: value * factors.get(name, 1) for name, value in PMMA.items()}
    return {"material": material, "base": {"kind": "body", **material}}


@pytest.mark.parametrize(
    "gauge, bodies, doubt",
    [
        (scaled(), of_material(youngs_modulus_Pa=1e-9), "check the units of modulus and density"),
        (scaled(), of_material(youngs_modulus_Pa=1e3), "check the units of modulus and density"),
        (scaled(), of_material(density_kg_per_m3=1e-3), "check the units of modulus and density"),
        (scaled(strain=1e6), EQUAL, "check the units of strain"),
        (scaled(strain=1e3), EQUAL, "check the units of strain"),
        (scaled(strain=1e-6), EQUAL, "check the units of strain"),
        (scaled(y=1e-3), EQUAL, "check the units of y and time"),
        (scaled(y=1e3), EQUAL, "no front passes"),
        (scaled(y=1e6), EQUAL, "check the units of strain or stress, modulus and y"),
        (scaled(time=1e-6), EQUAL, "check the units of strain or stress, modulus and y"),
        (scaled(time=1e-3), EQUAL, "no front passes"),
        (scaled(time=1e6), EQUAL, "check the units of y and time"),
        (scaled(strain=100.0), EQUAL, "check its units"),  # numbers of percent
        (scaled(strain=0.01), EQUAL, "e-07, not from 1e-06 to 0.02: check the units of strain"),
    ],
)
def test_wrong_units_are_doubted(gauge, bodies, doubt):
    assert doubt in "; ".join(slipfront.fit_tip(gauge, bodies, direction=1).doubts)


def record_file(name):
    return slipfront.read_gauges(ROOT / "tests/python/gauge_records" / name)


def placed(tmp_path, name, arms_mm):
    """The record with a column for the place of each arm."""
    head, *rows = (ROOT / "tests/python/gauge_records" / name).read_text().splitlines()
    file = tmp_path / name
    names = ",".join(f"x_{arm}_mm" for arm in arms_mm)
    places = ",".join(str(x_mm) for x_mm in arms_mm.values())
    file.write_text("\n".join([f"{head},{names}", *(f"{row},{places}" for row in rows)]) + "\n")
    return file


@pytest.mark.parametrize(
    "name, arms_mm",
    [
        ("rosette_arms_at_one_place.csv", {"-45": 100}),
        ("rosette_arms_1mm_apart.csv", {"-45": 99, "90": 100, "45": 101}),
    ],
)
def test_arms_at_places_of_their_own(tmp_path, name, arms_mm):
    """A front at 900 m/s with Gamma = 1.1 J/m2; 2 ustrain of noise."""
    (gauge,) = slipfront.read_gauges(file := placed(tmp_path, name, arms_mm))
    fit = slipfront.fit_tip(gauge, EQUAL)
    assert fit.doubts == [] and fit.direction == 1
    assert fit.Gamma_J_per_m2 == pytest.approx(1.1, abs=2 * fit.Gamma_error_J_per_m2)
    assert fit.Gamma_error_J_per_m2 < 0.02
    assert fit.speed_m_per_s == pytest.approx(900, abs=2 * fit.speed_error_m_per_s)
    (without,) = record_file(name)
    assert "taken as at one place" in slipfront.fit_tip(without, EQUAL).doubts[-1]
    if len(arms_mm) == 1:
        return
    table, picture = tmp_path / "fits.csv", tmp_path / "fits.png"
    assert gauges_command.main([str(file), *OPTIONS, "-o", str(table), "--figure", str(picture)]) == 0
    (row,) = rows_of(table)
    assert abs(float(row["step_strain_xx"])) < 5e-6 and row["residual_xx"] == "" and picture.exists()


def test_arms_are_where_they_are():
    """Of a tip without noise: each arm sees the field of its own place, and the step there."""
    places = {"-45": (0.099, 3.5e-3), "90": (0.1, 4.5e-3), "45": (0.101, 3e-3)}
    values = {}
    for arm, (x_m, y_m) in places.items():
        at = record(y_m=y_m, tip_s=TIP_S + (x_m - 0.1) / SPEED).values
        values[arm] = sum(w * at[p] for w, p in zip(gauges.weights(arm), ("xx", "yy", "xy"), strict=True))
    gauge = slipfront.Gauge("SG1", 0.1, 3.5e-3, TIME_S, values, places_m=places)
    fit = slipfront.fit_tip(gauge, EQUAL)
    assert fit.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=1e-4) and fit.doubts == []
    assert fit.tip_s == pytest.approx(TIP_S, abs=1e-9)
    two = slipfront.fit_tips([gauge], EQUAL, passages=2)
    assert [f.has_tip for f in two] == [True, False]


def test_a_direction_by_the_order_of_arrivals():
    three = record_file("xy_only_front_to_minus_x.csv")
    alone = slipfront.fit_tips(three, EQUAL)
    assert [f.direction for f in alone] == [-1, -1, -1]
    fits = slipfront.fit_front(three, EQUAL, alone=alone)
    assert [f.speed_m_per_s for f in fits] == pytest.approx([900] * 3, rel=3e-3)
    assert all(f.doubts == [] for f in fits)
    assert fits[0].Gamma_J_per_m2 == pytest.approx(1.1, abs=2 * fits[0].Gamma_error_J_per_m2)
    (single,) = slipfront.fit_tips(three[:1], EQUAL)
    assert single.doubts == [
        "xy alone hardly tells V: give speed_m_per_s, or more gauges together",
        "xy alone does not tell which way: give direction",
    ]
    assert slipfront.fit_tip(three[0], EQUAL, speed_m_per_s=900, direction=-1).doubts == []


def test_a_zone_of_another_shape():
    """A gauge 3.5 mm above a zone of 14 mm of a shape that no fit has, Gamma = 1.1 J/m2: 7 % of the record
    are left, and X_c, twice the area, need not be 14 mm."""
    (fit,) = slipfront.fit_tips(record_file("cohesive_zone_14mm.csv"), EQUAL)
    assert fit.doubts == []
    assert fit.Gamma_J_per_m2 == pytest.approx(1.1, rel=0.1)
    assert 10e-3 < fit.cohesive_zone_m < 25e-3


def passed(gauge, smooth_s=None, leak_s=None):
    """A record behind a low-pass or high-pass of first order, from rest."""
    values = {}
    for part, v in gauge.values.items():
        made, dt = v - v[0], TIME_S[1]
        if smooth_s is not None:
            share, out = 1 - np.exp(-dt / smooth_s), 0.0
            made = np.array([out := out + share * (each - out) for each in made])
        if leak_s is not None:
            keep, out = np.exp(-dt / leak_s), 0.0
            made = np.array([out := keep * out + d for d in np.diff(made, prepend=0.0)])
        values[part] = made
    return dataclasses.replace(gauge, values=values)


def test_an_amplifier_of_known_bandwidth():
    """A low-pass of first order looks like a cohesive zone to a fit that does not know it."""
    slow = passed(record(noise=2e-6), smooth_s=5.3e-6)
    assert slipfront.fit_tip(slow, EQUAL).cohesive_zone_m > 8e-3
    fit = slipfront.fit_tip(dataclasses.replace(slow, bandwidth_Hz=30e3), EQUAL)
    assert fit.zone_high_m < 1e-3 and fit.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=0.06)


def test_an_amplifier_that_lets_no_constant_pass_is_doubted():
    """The doubt has the cut-off, and the Gamma that it hides."""
    fit = slipfront.fit_tip(passed(record(noise=2e-6), leak_s=8e-6), EQUAL)
    assert fit.Gamma_J_per_m2 < 0.7 * GAMMA
    (told,) = (doubt for doubt in fit.doubts if "high-pass" in doubt)
    hertz, Gamma = re.fullmatch(r"a \S+-pass of (\S+) Hz, .* makes Gamma (\S+) J/m2", told).groups()
    assert float(hertz) == pytest.approx(20e3, rel=0.1) and float(Gamma) == pytest.approx(GAMMA, rel=0.1)


def clipped(gauge, share):
    """At a share of the peak of each component about its median."""
    ends = {p: (np.median(v), share * gauge.peak(p)) for p, v in gauge.values.items()}
    values = {
        p: np.clip(v, a - b, a + b)
        for (p, v), (a, b) in zip(gauge.values.items(), ends.values(), strict=True)
    }
    return dataclasses.replace(gauge, values=values)


def test_flat_tops_are_doubted():
    """Before a filter and behind it, and in the rest that a passage leaves; other values have their own."""
    whole, flat = record(noise=1e-6), "the record is flat at an extreme from "
    gauge = clipped(whole, 0.4)
    fit = slipfront.fit_tip(gauge, EQUAL)
    assert fit.Gamma_J_per_m2 < 0.6 * GAMMA and any(doubt.startswith(flat) for doubt in fit.doubts)
    filtered = gauge.prepared(low_pass_Hz=200e3, shift_s=1e-6)
    assert any(doubt.startswith(flat) for doubt in slipfront.fit_tip(filtered, EQUAL).doubts)
    assert np.array(filtered.flat_s) == pytest.approx(np.array(gauge.flat_s) + 1e-6)
    assert tip_fit.without(gauge, near_tip.bodies_of(EQUAL), fit).flat_s == gauge.flat_s
    assert dataclasses.replace(gauge, values=whole.values).flat_s == ()


@pytest.mark.parametrize(
    "digit, noise", [(1e-6, 0.0), (5e-6, 0.0), (20e-6, 0.0), (5e-6, 5e-6), (0.1e-6, 2e-6)]
)
def test_a_converter_makes_no_flat_tops(digit, noise):
    gauge = record(noise=noise)
    rounded = {part: digit * np.round(v / digit) for part, v in gauge.values.items()}
    assert dataclasses.replace(gauge, values=rounded).flat_s == ()


def test_values_that_are_missing(tmp_path):
    """Times of a gauge at which any of its values misses are left out; so is an arm that has none."""
    gauge = record(noise=1e-6)
    values = {part: v.copy() for part, v in gauge.values.items()}
    values["xx"][50:60], values["yy"][:] = np.nan, np.nan
    made = dataclasses.replace(gauge, values=values)
    assert list(made.values) == ["xx", "xy"] and len(made.time_s) == len(TIME_S) - 10
    fit = slipfront.fit_tip(made, EQUAL)
    assert fit.Gamma_J_per_m2 == pytest.approx(GAMMA, rel=0.05) and fit.doubts == []
    values["xx"][190:220] = np.nan
    gap = slipfront.fit_tip(dataclasses.replace(gauge, values=values), EQUAL)
    assert "times of the record are up to 7.75 us apart" in "; ".join(gap.doubts)
    file = tmp_path / "gauges.csv"
    file.write_text(
        "x_m,y_m,time_s,stress_xy_MPa\n0,1e-3,0,1\n0,1e-3,1e-6,NaN\n0,1e-3,2e-6,\n0,1e-3,3e-6,2\n"
    )
    (read,) = slipfront.read_gauges(file)
    file.write_text("gauge," + file.read_text().replace("\n0,", "\nA,0,") + "B,0,1e-3,0,\nB,0,1e-3,1e-6,-\n")
    with pytest.warns(UserWarning, match="^B: passed over: it has no values$"):
        (read,) = slipfront.read_gauges(file)
    assert list(read.time_s) == [0, 3e-6] and list(read.values["xy"]) == [1e6, 2e6]


def test_a_speed_at_the_end_of_its_range_is_doubted():
    fit = slipfront.fit_tip(record(speed=1232.5), EQUAL)
    assert "V went to the end of its range, 0 to 1233" in "; ".join(fit.doubts)


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
        "strain_xx (%);eps_yy_percent;strain_xy_strain": (100 * xx, 100 * yy, xy),
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


ROSETTE = "x_m,y_m,time_s,strain_0,strain_45,strain_90"


@pytest.mark.parametrize(
    "text, why",
    [
        ("x_m,y_m,time_s\n0,1,0\n", "has none of strain, stress"),
        ("x_m,y_m,strain_xx\n0,1,0\n", "has the columns 'x_m', 'y_m', 'strain_xx'; wanted are gauge, x, y"),
        ("x_m,y_m,time_s,stress_xx\n0,1,0,1\n", "column 'stress_xx' names none of the units Pa, kPa, MPa"),
        ("x,y_m,time_s,strain_xx\n0,1,0,1\n", "wanted are gauge, x, y and time with their units and"),
        ("x_m,y_m,time_s,strain_xx,stress_yy (psi)\n0,1,0,1,1\n", r"'stress_yy \(psi\)' names none of the"),
        ("x_m,y_m,time_s,strain_xx,stress_yy_Pa\n0,1,0,1,1\n", "several kinds"),
        ("x_m,y_m,time_s,strain_0,strain_90\n0,1,0,1,1\n", "a rosette has three arms, not 2"),
        ("x_m,y_m,time_s,strain_0,strain_180,strain_90\n0,1,0,1,1,1\n", "do not determine the strain"),
        ("x_m,y_m,time_s,strain_xx\n0,1,0,\n", "no gauge has values"),
        ("x_m,y_m,time_s,strain_xx\n0,1,,1\n", "'time_s' has an empty cell"),
        (ROSETTE + ",x_30_m\n0,1,0,1,1,1,0\n", "'x_30' is the place of no arm"),
        (ROSETTE + ",y_0_m\n0,1,0,1,1,1,-1\n0,1,1,1,1,1,-1\n", "on its side"),
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
    probes = {
        "x_m": [0.0875, 0.1075, 0.1275, 0.1075], "y_m": [3.5e-3, 3.5e-3, 3.5e-3, -3.5e-3],
        "names": ["SG1", "SG2", "SG3", "below"], "interval_s": 0.25e-6,
    }  # fmt: skip
    case = blocks(1e-3, 0.05e-6, d_c_m=2.2e-6, half_length_m=0.02, end_s=140e-6) | {"probes": probes}
    return slipfront.run(case, output=tmp_path_factory.mktemp("gauges") / "out")


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


def test_the_front_of_a_run_where_no_tip_is_found(run):
    fit = slipfront.fit_tip(dataclasses.replace(noise_alone(), x_m=0.1075), EQUAL)
    told = gauges_command.with_fronts_of_run(fit, run).doubts[1]
    at = np.argmin(np.abs(run.fronts.x_m.values - 0.1075))
    onset_us, speed = 1e6 * run.fronts.onset_s.values[at], run.fronts.v_tip_m_per_s.values[at]
    assert re.fullmatch(rf"by the run front \d passes at {onset_us:.4g} us with {speed:.4g} m/s", told)


def refused(capsys, *arguments) -> str:
    assert gauges_command.main([str(a) for a in arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_the_command(run, fits, tmp_path, capsys):
    table, picture = tmp_path / "fits.csv", tmp_path / "fits.png"
    assert gauges_command.main([str(run.folder), "-o", str(table), "--figure", str(picture)]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].startswith("SG1: front to +x passes at ") and out[-1] == f"figure: {picture}"
    rows = rows_of(table)
    assert [float(row["Gamma_J_per_m2"]) for row in rows[: len(fits)]] == [f.Gamma_J_per_m2 for f in fits]
    assert [row["together"] for row in rows[len(fits) :]] == [str(len(fits))] * len(fits)
    assert re.search("SG1, .* together: front to .*, V = .*, Gamma = .* J/m2, X_c = .* mm, ", out[len(fits)])
    assert picture.read_bytes().startswith(b"\x89PNG")

    records = tmp_path / "records.csv"
    gauge = slipfront.gauges_of(run)[0]
    columns = (gauge.time_s, *gauge.values.values())
    rows = [
        f"{gauge.x_m},{gauge.y_m}," + ",".join(map(repr, map(float, row)))
        for row in zip(*columns, strict=True)
    ]
    records.write_text("\n".join(["x_m,y_m,time_s,strain_xx,strain_yy,strain_xy", *rows]))
    assert gauges_command.main([str(records), *OPTIONS, "--low-pass-hz", "3e5", "--zero-s", ",2e-5"]) == 0
    assert "the filter leaves" in capsys.readouterr().out

    of_record = (records, *OPTIONS)
    for arguments, said in (
        ((records,), "a record needs its bodies: give --youngs-modulus-pa, "),
        ((run.folder, *OPTIONS), "a run has its own bodies; leave out --youngs-modulus-pa, --poissons-ratio"),
        ((*of_record, "--shift-s", "B=1"), "names the gauge 'B'"),
        ((*of_record, "--stress"), "--stress is of a run"),
        ((*of_record, "--zero-s", "1,2"), "--zero-s is 1 to 2 s"),
        ((*of_record, "--r-max-m", "1e-3"), "--r-max-m is 0.001 m; it must be above the gauge's height"),
        ((run.folder, "-o", records), "not replaced"),
        ((tmp_path / "none.csv", *OPTIONS), "No such file"),
    ):
        assert said in refused(capsys, *arguments)


def test_the_table_of_a_rosette_with_a_dead_arm():
    of = record(noise=1e-7)
    normal, shear = (of.values["xx"] + of.values["yy"]) / 2, of.values["xy"]
    gauge = dataclasses.replace(of, values={"-45": normal - shear, "45": normal + shear})
    row = gauges_command.row_of(slipfront.fit_tip(gauge, EQUAL), True)
    assert row["Gamma_J_per_m2"] > 0 and row["offset_strain_xx"] == ""


@pytest.mark.parametrize(
    "options, why",
    [
        (["--zero-s", "1;2"], "'1;2' is not FROM,TO in s; give such as 0,20e-6"),
        (["--zero-s", "1"], "'1' is not FROM,TO in s"),
        (["--shift-s", "A=2us"], r"'A=2us' is not \[GAUGE=\]S with S in s; give such as 2e-6"),
        (["--zone", "round"], "argument --zone: invalid choice: 'round'"),
    ],
)
def test_options_refused(capsys, options, why):
    with pytest.raises(SystemExit, match="2"):
        gauges_command.parse(["records.csv", *options])
    (line,) = capsys.readouterr().err.splitlines()
    assert re.search(why, line) and any(option in line for option in options if option.startswith("--"))


def test_the_command_says_where_no_front_passes(tmp_path, capsys):
    records, table, picture = (tmp_path / name for name in ("records.csv", "fits.csv", "fits.png"))
    rows = ["gauge,x_m,y_m,time_s,strain_xx,strain_yy,strain_xy"]
    for gauge in (record(), noise_alone("quiet")):
        rows.append(f"dead,0,1e-3,{len(rows)},,,")
        columns = zip(gauge.time_s, *gauge.values.values(), strict=True)
        rows += [
            f"{gauge.name},{gauge.x_m},{gauge.y_m}," + ",".join(map(repr, map(float, c))) for c in columns
        ]
    records.write_text("\n".join(rows))
    said = [str(records), *OPTIONS, "-o", str(table), "--figure", str(picture)]
    assert gauges_command.main(said) == 0
    first, second, dead, *_ = capsys.readouterr().out.splitlines()
    assert dead == "dead: passed over: it has no values"
    assert first.startswith("SG1: front to +x") and second.startswith("quiet: no front passes: ")
    found, quiet = rows_of(table)
    assert float(found["Gamma_J_per_m2"]) == pytest.approx(GAMMA, rel=1e-3)
    assert quiet["Gamma_J_per_m2"] == quiet["tip_s"] == "" and quiet["direction"] == "0"
    records.write_text("\n".join(row for row in rows if not row.startswith("SG1")))
    picture.unlink()
    assert gauges_command.main(said) == 0
    (again, _, note) = capsys.readouterr().out.splitlines()
    assert again.startswith("quiet: no front passes: ")
    assert note == f"{picture}: not drawn: no gauge has a fit"
    assert not picture.exists()


def test_the_command_fits_a_front_of_a_run_above_the_shear_speed(tmp_path, capsys):
    places = {"probes.x_m": [0.076, 0.12], "probes.y_m": [2.5e-3, 2.5e-3], "probes.interval_s": 0.25e-6}
    changes = {"plate.element_size_m": 1e-3, "time.end_s": 40e-6, **places}
    fast = slipfront.run(ROOT / "examples/supershear/case.toml", changes, output=tmp_path / "out")
    assert gauges_command.main([str(fast.folder)]) == 0
    near, far, *_ = capsys.readouterr().out.splitlines()
    assert "does not apply" not in near  # inside the patch
    assert re.match(r"2: front to \+x passes at .* us, V = 1[6-9].. \+- .* m/s, Gamma = ", far)


GIVEN = record()


@pytest.mark.parametrize(
    "work, why",
    [
        (lambda: slipfront.Gauge(None, 0, 1e-3, TIME_S, {"xx": TIME_S}), "the name of a gauge is None"),
        (lambda: slipfront.Gauge("A", None, 1e-3, TIME_S, {"xx": TIME_S}), "gauge A: x_m is None"),
        (lambda: slipfront.Gauge("A", 0, "1", TIME_S, {"xx": TIME_S}), "gauge A: y_m is '1'"),
        (lambda: slipfront.Gauge("A", 0, 1e-3, None, {"xx": TIME_S}), "gauge A: time_s is None"),
        (lambda: slipfront.Gauge("A", 0, 1e-3, TIME_S, None), "gauge A: values is None; it must be"),
        (lambda: slipfront.Gauge("A", 0, 1e-3, TIME_S, {"xx": None}), r"gauge A: values\['xx'\] is None"),
        (lambda: slipfront.Gauge("A", 0, 1e-3, TIME_S, {"xx": ["a"] * 400}), r"\['xx'\] is not an array"),
        (lambda: GIVEN.prepared(shift_s=None), "shift_s is None; it must be a number"),
        (lambda: GIVEN.prepared(zero_s=1e-6), "zero_s is 1e-06; it must be a pair of times in s"),
        (lambda: GIVEN.prepared(zero_s=(0, None)), "an end of gauge SG1: zero_s is None"),
        (lambda: GIVEN.prepared(window_s=(0, 1, 2)), "window_s has 3 parts; it must be a pair of times in s"),
        (lambda: GIVEN.prepared(low_pass_Hz="1"), "low_pass_Hz is '1'; it must be a number"),
        (lambda: GIVEN.prepared(low_pass_Hz=1.0), "low_pass_Hz is 1 Hz; .* Hz: give one of these"),
        (lambda: slipfront.read_gauges(None), "file is None; it must be a path"),
        (lambda: slipfront.gauges_of(None), "run is None; it must be a slipfront.OpenRun"),
        (lambda: slipfront.fit_tip(None, EQUAL), "gauge is None; it must be a slipfront.Gauge"),
        (lambda: slipfront.fit_tip(GIVEN, None), "case is None"),
        (lambda: slipfront.fit_tip(GIVEN, EQUAL, tip_s="now"), "tip_s is 'now'; it must be a number"),
        (lambda: slipfront.fit_tip(GIVEN, EQUAL, step=None), "step is None; it must be True or False"),
        (lambda: slipfront.fit_tip(GIVEN, EQUAL, r_max_m="1"), "r_max_m is '1'; it must be a number"),
        (lambda: slipfront.fit_tip(GIVEN, EQUAL, direction=[1]), r"direction is \[1\]; it must be 1"),
        (lambda: slipfront.fit_tips(None, EQUAL), "gauges is None; it must be a list of gauges"),
        (lambda: slipfront.fit_tips(GIVEN, EQUAL), "it must be a list of gauges"),
        (lambda: slipfront.fit_tips([], EQUAL), "gauges is empty"),
        (lambda: slipfront.fit_tips([None], EQUAL), r"gauges\[0\] is None; it must be a slipfront.Gauge"),
        (lambda: slipfront.fit_tips([GIVEN], EQUAL, passages=None), "passages is None"),
        (lambda: slipfront.fit_tips([GIVEN], EQUAL, speed_m_per_s=[1]), r"speed_m_per_s is \[1\]"),
        (lambda: slipfront.compare_traces([GIVEN], None), "run is None; it must be a slipfront.OpenRun"),
        (lambda: slipfront.tip_field(EQUAL, None, 0, speed_m_per_s=1, Gamma_J_per_m2=1), "x_m is None"),
        (lambda: slipfront.tip_field(EQUAL, 0, 0, speed_m_per_s=None, Gamma_J_per_m2=1), "per_s is None"),
        (
            lambda: slipfront.tip_field(EQUAL, [0, 1], [0, 1, 2], speed_m_per_s=1, Gamma_J_per_m2=1),
            r"x_m has the shape \(2,\), y_m \(3,\)",
        ),
    ],
)  # fmt: skip
def test_what_is_no_gauge_is_refused(work, why):
    assert re.search(why, one_refusal(work))


def test_unequal_bodies_have_no_field():
    unequal = {"material": PMMA, "base": {"kind": "body", **PMMA, "youngs_modulus_Pa": 70e9}}
    with pytest.raises(slipfront.CaseError, match="the bodies differ"):
        slipfront.fit_tip(record(), unequal)
