# SPDX-License-Identifier: BSD-3-Clause
"""The field of a tip with a cohesive zone: equations of motion, tractions, energy, limits."""

from __future__ import annotations

import numpy as np
import pytest
import slipfront
from scipy.integrate import quad
from slipfront import near_tip
from slipfront.near_tip import TipField

PMMA = {"youngs_modulus_Pa": 5.65e9, "poissons_ratio": 0.33, "density_kg_per_m3": 1180.0}


def bodies(plane="stress", rigid=False):
    base = {"kind": "rigid"} if rigid else {"kind": "body", **PMMA}
    return near_tip.bodies_of({"material": {**PMMA, "plane": plane}, "base": base})


def settings():
    """Bodies, speed, direction, zone and its kind: slow to fast."""
    for plane in ("stress", "strain"):
        for rigid in (False, True):
            of = bodies(plane, rigid)
            for share, zone_m in ((0.2, 0.0), (0.7, 0.4), (0.95, 0.4)):
                yield of, share * of.limit_m_per_s, 1, zone_m, "linear"
            yield of, 0.7 * of.limit_m_per_s, -1, 0.4, "slip"
            if not rigid:
                for share in (0.1, 0.6, 0.9):
                    yield of, of.c_S_m_per_s + share * (of.c_L_m_per_s - of.c_S_m_per_s), -1, 0.4, "linear"


def slope(of, h=1e-4):
    """By a central difference of fourth order."""
    return (8 * (of(h) - of(-h)) - (of(2 * h) - of(-2 * h))) / (12 * h)


@pytest.mark.parametrize("of, speed, direction, zone_m, zone", list(settings()))
def test_the_field_is_in_dynamic_equilibrium(of, speed, direction, zone_m, zone):
    """div stress = rho V^2 u_xx = rho V^2 (d strain_xx/dx, 2 d strain_xy/dx - d strain_xx/dy)."""
    tip = TipField(of, speed, direction, zone_m, zone)
    angles = np.array([0.2, 1.0, 2.0, 2.6] + ([] if of.is_on_rigid else [-0.7, -2.5]))
    x, y = np.cos(angles), np.sin(angles)
    dx = [slope(lambda d, f=f: f(x + d, y)) for f in (tip.stress, tip.strain)]
    dy = [slope(lambda d, f=f: f(x, y + d)) for f in (tip.stress, tip.strain)]
    inertia = of.density_kg_per_m3 * speed**2
    size = np.abs(dx[0]).max() + np.abs(dy[0]).max()
    assert np.abs(dx[0][0] + dy[0][2] - inertia * dx[1][0]).max() < 1e-7 * size
    assert np.abs(dx[0][2] + dy[0][1] - inertia * (2 * dx[1][2] - dy[1][0])).max() < 1e-7 * size


@pytest.mark.parametrize("of, speed, direction, zone_m, zone", list(settings()))
def test_tractions_and_energy_on_the_interface(of, speed, direction, zone_m, zone):
    """The traction falls from tau_p at the tip to 0, X_c is twice its area, and its work on slip is Gamma =
    1."""
    tip = TipField(of, speed, direction, zone_m, zone)
    ahead = np.array([1e-3, 0.5])
    if not of.is_on_rigid:
        assert (
            np.abs(tip.stress(direction * ahead, 0 * ahead)[1]).max()
            < 1e-9 * tip.stress(ahead, 0 * ahead)[2].max()
        )
    if zone_m == 0:
        assert tip.stress(direction * ahead, 0 * ahead)[2] * np.sqrt(2 * np.pi * ahead) == pytest.approx(
            tip.K_per_root, rel=1e-12
        )
        return
    s = (np.linspace(0, 1, 8001)[1:] ** 2) * 1.2 * tip.lengths.max()
    x, edge = -direction * s, np.zeros_like(s)
    tau = tip.stress(x, edge)[2]
    strained = tip.strain(x, edge)[0] - (0 if of.is_on_rigid else tip.strain(x, -edge)[0])
    assert 2 * np.trapezoid(tau, s) / tip.drop_per_root == pytest.approx(zone_m, rel=1e-4)
    assert np.abs(tau[s > tip.lengths.max()]).max() < 1e-9 * tip.drop_per_root
    assert np.trapezoid(tau * -direction * strained, s) == pytest.approx(1, rel=1e-4)


def test_a_zone_of_slip_is_that_of_linear_slip_weakening():
    """The traction is linear in slip, to the rounding of its few parts."""
    tip = TipField(bodies(), 900.0, 1, 1e-3, "slip")
    s = (np.linspace(0, 1, 4001)[1:] ** 2) * tip.lengths.max()
    edge = np.zeros_like(s)
    tau = tip.stress(-s, edge)[2] / tip.drop_per_root
    rate = tip.strain(-s, -edge)[0] - tip.strain(-s, edge)[0]
    slip = np.concatenate([[0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(s))])
    assert np.abs(tau - (1 - slip / slip[-1])).max() < 0.01


def test_far_from_the_zone_the_field_is_singular():
    whole, near = (TipField(bodies(), 900.0, 1, zone_m) for zone_m in (0.0, 1e-6))
    x, y = np.array([2e-3, -3e-3]), np.full(2, 3.5e-3)
    assert near.strain(x, y) == pytest.approx(whole.strain(x, y), rel=1e-3)


def test_the_energy_above_the_shear_speed_is_the_integral():
    for q in (0.05, 0.2, 0.45):
        behind = lambda s, q=q: -(1 - s) * float(near_tip.linear_fall(np.array(complex(-s, 0)), 1.0, q).imag)  # noqa: E731
        assert near_tip.energy_of_fall(q) == pytest.approx(quad(behind, 0, 1)[0], rel=1e-6)


def test_at_rest_as_in_textbooks():
    tip = TipField(bodies(), 0.0)
    angle = np.array([-2.5, -1.0, 0.3, 1.5, 3.0])
    xx, yy, xy = tip.stress(np.cos(angle), np.sin(angle)) / tip.K_per_root * np.sqrt(2 * np.pi)
    s, c = np.sin(angle / 2), np.cos(angle / 2)
    # At 1e-4 of c_S, whose square is 1e-8, times some ten.
    assert xx == pytest.approx(-s * (2 + c * np.cos(1.5 * angle)), abs=3e-7)
    assert yy == pytest.approx(s * c * np.cos(1.5 * angle), abs=3e-7)
    assert xy == pytest.approx(c * (1 - s * np.sin(1.5 * angle)), abs=3e-7)
    assert tip.K_per_root == pytest.approx(np.sqrt(PMMA["youngs_modulus_Pa"]), rel=1e-7)


def test_the_rigid_plane_holds_the_body_up():
    """u_y = 0 at y = 0: 2 strain_xy = du_x/dy, whose slope along x is that of strain_xx upwards."""
    tip = TipField(bodies(rigid=True), 800.0)
    h, x = 1e-4, np.array([-0.5, 0.5])
    along = slope(lambda d: 2 * tip.strain(x + d, np.zeros(2))[2])
    up = [tip.strain(x, np.full(2, k * h))[0] for k in range(3)]
    size = np.abs(along).max()
    assert along == pytest.approx((4 * up[1] - up[2] - 3 * up[0]) / (2 * h), abs=1e-4 * size)
    assert np.isnan(tip.stress(x, np.full(2, -0.1))).all()


def test_the_field_of_a_tip():
    equal = {"material": PMMA, "base": {"kind": "body", **PMMA}}
    x_m = np.array([[1e-3, -1e-3], [4e-3, -4e-3]])
    ahead, slow = (
        slipfront.tip_field(equal, x_m, 0.0, speed_m_per_s=v, Gamma_J_per_m2=1.1, stress=True)["xy"]
        for v in (900.0, 0.0)
    )
    assert ahead[0, 0] == pytest.approx(2 * ahead[1, 0], rel=1e-12)  # as 1/sqrt(x)
    assert np.abs(ahead[:, 1]).max() < 1e-9 * ahead[1, 0]
    # At rest Gamma = K^2/E in plane stress.
    assert slow[0, 0] == pytest.approx(np.sqrt(1.1 * 5.65e9 / (2 * np.pi * 1e-3)), rel=1e-7)
    given = {"Gamma_J_per_m2": 1.1, "cohesive_zone_m": 2e-3, "stress": True}
    zone = slipfront.tip_field(equal, [-1e-3, -2e-3], 0.0, speed_m_per_s=1500.0, **given)["xy"]
    assert zone[0] > 1e5 and abs(zone[1]) < 1e-6 * zone[0]


@pytest.mark.parametrize(
    "given, why",
    [
        ({"speed_m_per_s": 1260.0}, "there is a field from 0 to 1233.1, or from 1341.7 to 2318"),
        ({"speed_m_per_s": 1500.0}, "cohesive_zone_m is 0; above c_S"),
        ({"speed_m_per_s": 900.0, "zone": "round"}, "zone is 'round'; it must be one of linear, slip"),
    ],
)
def test_no_field(given, why):
    equal = {"material": PMMA, "base": {"kind": "body", **PMMA}}
    with pytest.raises(slipfront.CaseError, match=why):
        slipfront.tip_field(equal, 1e-3, 1e-3, Gamma_J_per_m2=1, **given)
