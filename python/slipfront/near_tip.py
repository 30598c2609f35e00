# SPDX-License-Identifier: BSD-3-Clause
"""Stress and strain around the tip of a front that moves steadily, with a cohesive zone behind it.

Mode II between equal half-spaces below the Rayleigh speed and above the shear speed, or of a half-space on
the rigid plane below the shear speed. docs/gauges.md has formulas and sources."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad
from scipy.special import hyp2f1

from slipfront import _core
from slipfront.command import MATERIAL
from slipfront.errors import CaseError
from slipfront.fracture import case_of_bodies
from slipfront.gauges import COMPONENTS
from slipfront.given import array, flag, number, shown
from slipfront.opened import OpenRun
from slipfront.running import CaseLike

#: How strength falls behind the tip: linearly over the distance, or over slip, as under linear slip
#: weakening.
ZONES = ("linear", "slip")
#: The traction under linear slip weakening as sum of linear falls: their lengths over that of the whole,
#: their shares; and its area, twice, which is X_c over the whole.
SLIP_LENGTHS = np.array([0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0])
SLIP_SHARES = np.array(
    [-0.02778542, -0.05154394, -0.07954356, -0.06436257, -0.02547388, 0.028537, 0.10082967, 1.12337482]
)
SLIP_SHARES /= SLIP_SHARES.sum()
SLIP_AREA = float(SLIP_SHARES @ SLIP_LENGTHS)
AT_REST = 1e-4  # of c_S: the field differs from that at rest by its square, and rounding by as much
SERIES = [2 / ((2 * k + 1) * (2 * k + 3)) for k in range(9)]
FAR = 8.0  # |z|/X, square root, from which on a series takes the place of a difference of large numbers


@dataclass(frozen=True)
class Bodies:
    """Equal half-spaces, or one on the rigid plane."""

    youngs_modulus_Pa: float
    poissons_ratio: float
    density_kg_per_m3: float
    plane: str
    is_on_rigid: bool
    c_L_m_per_s: float
    c_S_m_per_s: float
    limit_m_per_s: float  #: of tips below the shear speed: c_R of equal bodies, c_S on the rigid plane

    @property
    def shear_modulus_Pa(self) -> float:
        return self.youngs_modulus_Pa / (2 * (1 + self.poissons_ratio))

    def ranges_m_per_s(self) -> list[tuple[float, float]]:
        """Of speeds that have a field."""
        fast = [] if self.is_on_rigid else [(self.c_S_m_per_s, self.c_L_m_per_s)]
        return [(0.0, self.limit_m_per_s), *fast]

    def strain(self, stress: np.ndarray) -> np.ndarray:
        """Of stress [xx yy xy, ...]."""
        E, nu = self.youngs_modulus_Pa, self.poissons_ratio
        if self.plane == "strain":
            E, nu = E / (1 - nu**2), nu / (1 - nu)
        xx, yy, xy = stress
        return np.array([(xx - nu * yy) / E, (yy - nu * xx) / E, (1 + nu) * xy / E])


def bodies_of(given: OpenRun | CaseLike | _core.Case | Bodies) -> Bodies:
    """See case_of_bodies; refused where they differ."""
    if isinstance(given, Bodies):
        return given
    case = case_of_bodies(given)
    tables = tomllib.loads(case.toml)
    above, base = tables["material"], tables["base"]
    own, other = ([float(of.get(name, np.nan)) for name in MATERIAL] for of in (above, base))
    is_on_rigid = base["kind"] == "rigid"
    if not is_on_rigid and not np.allclose(own, other, 1e-6, 0):
        raise CaseError("the bodies differ: the field is that of equal bodies or of one on a rigid plane")
    E, nu, rho = own
    waves, limit = case.wave_speeds, case.limiting_speed_m_per_s
    return Bodies(E, nu, rho, above["plane"], is_on_rigid, waves.c_L_m_per_s, waves.c_S_m_per_s, limit)


def linear_fall(z: np.ndarray, X_m: float | np.ndarray, q: float) -> np.ndarray:
    """The traction function of a zone in which the traction falls from 1 to 0 over the length X_m.

    P(z), z = x + i a_d y: on the interface ahead P is the traction; behind, at y = 0+, Re P + cot(pi q) Im P
    is, and Im P goes with the slope of slip. Far away P is proportional to z^-q."""
    z = z + 1e-12j * X_m  # above the cut behind the tip
    if q == 0.5:
        u = np.sqrt(z / X_m)
        far = np.abs(u) > FAR
        near = np.where(far, 1.0, u)
        found = (1 + near**2) * np.log((near + 1j) / (near - 1j)) / 2j - near
        if far.any():
            found[far] = np.polynomial.polynomial.polyval(-1 / u[far] ** 2, SERIES) / u[far]
        return 2 / np.pi * found
    ratio = -X_m / z
    whole = hyp2f1(1, q, 1 + q, ratio) / q - hyp2f1(1, 1 + q, 2 + q, ratio) / (1 + q)
    return np.sin(np.pi * q) / np.pi * (X_m / z) ** q * whole


def energy_of_fall(q: float) -> float:
    """Of linear_fall: the integral over the zone of traction times -Im P, with X_m = 1."""
    return 8 / (9 * np.pi) if q == 0.5 else float(fast_energies()(q))


@lru_cache(maxsize=1)
def fast_energies() -> np.polynomial.Chebyshev:
    """energy_of_fall over q."""

    def of(q: float) -> float:
        return quad(lambda s: -(1 - s) * float(linear_fall(np.array(complex(-s, 0)), 1.0, q).imag), 0, 1)[0]

    return np.polynomial.Chebyshev.interpolate(np.vectorize(of), 16, domain=[0.02, 0.5])


class TipField:
    """The field of a tip at the origin, over the square root of its fracture energy.

    Stress that adds to the state with the residual traction on the slipping side; traction positive on the
    body above that slips to +x, whichever way the front runs. Equal bodies: xx and yy are odd in y.

    zone_m: X_c, twice the area of (tau - tau_r)/(tau_p - tau_r) over the distance behind the tip; 0: a
    singular tip, which above c_S has no energy."""

    def __init__(
        self,
        bodies: Bodies,
        speed_m_per_s: float,
        direction: int = 1,
        zone_m: float = 0.0,
        zone: str = "linear",
    ) -> None:
        c_L, c_S, mu = bodies.c_L_m_per_s, bodies.c_S_m_per_s, bodies.shear_modulus_Pa
        v = max(speed_m_per_s, AT_REST * c_S)
        self.bodies, self.direction = bodies, direction
        self.is_fast = v > c_S
        m2 = (v / c_S) ** 2
        self.a_d = np.sqrt(1 - (v / c_L) ** 2)
        self.a_s = np.sqrt(abs(1 - m2))
        self.s2 = 1 - m2
        self.q = 0.5
        # u_x = phi_x + psi_y, u_y = phi_y - psi_x, phi = Re F(x + i a_d y), psi = Im G(x + i a_s y), in units
        # of the shear modulus; f = F'' = -i f_ P, g = G'' = -i g_ P. Equal bodies have stress_yy = 0 at y =
        # 0, the rigid plane u_y = 0. The slope of slip at the edge is -Im P/stiffness.
        if self.is_fast:  # psi = g(x + a_s y): waves that leave
            self.q = float(np.arctan2(4 * self.a_d * self.a_s, (2 - m2) ** 2) / np.pi)
            self.f, self.g = 1 / (2 * self.a_d), -(2 - m2) / (4 * self.a_d * self.a_s)
            self.stiffness_Pa = 2 * self.a_d * mu / m2
        elif bodies.is_on_rigid:
            self.f, self.g = 1 / (self.a_d * m2), -1 / m2
            self.stiffness_Pa = mu * self.a_d * m2 / (1 - self.a_d * self.a_s)
        else:
            rayleigh = 4 * self.a_d * self.a_s - (2 - m2) ** 2
            self.f, self.g = 2 * self.a_s / rayleigh, -(2 - m2) / rayleigh
            self.stiffness_Pa = mu * rayleigh / (2 * m2 * self.a_s)
        #: K over the square root of Gamma, Pa m^(1/2) per (J/m2)^(1/2); NaN above c_S.
        self.K_per_root = np.nan if self.is_fast else float(np.sqrt(4 * self.stiffness_Pa))
        self.zone_m = zone_m
        of_slip = zone == "slip" and not self.is_fast
        self.lengths = zone_m / SLIP_AREA * SLIP_LENGTHS if of_slip else np.array([zone_m])
        self.shares = SLIP_SHARES if of_slip else np.ones(1)
        if zone_m == 0:
            self.drop_per_root = float(np.inf)
        elif not self.is_fast:  # K of each fall
            of_K = self.shares @ np.sqrt(self.lengths) * 4 / 3 * np.sqrt(2 / np.pi)
            self.drop_per_root = self.K_per_root / float(of_K)
        else:
            self.drop_per_root = float(np.sqrt(self.stiffness_Pa / (zone_m * energy_of_fall(self.q))))

    def function(self, z: np.ndarray) -> np.ndarray:
        """The traction function P over the root of Gamma."""
        if self.zone_m == 0:
            return self.K_per_root / np.sqrt(2 * np.pi * z)
        return self.drop_per_root * (
            np.tensordot(self.shares, linear_fall(z, self.lengths[:, None, None], self.q), 1)
        )

    def stress(self, x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
        """Pa over the root of Gamma [xx yy xy, places]; NaN below the rigid plane. y = -0.0 is the edge of
        the body below."""
        x, y = self.direction * np.asarray(x_m, float), np.abs(np.asarray(y_m, float))
        side = self.direction * np.copysign(1.0, y_m)
        a_s, s2 = self.a_s, self.s2
        # Above c_S the second potential is of the place along a wave that leaves, which is real.
        at_s = x + a_s * y + 0j if self.is_fast else x + 1j * a_s * y
        P, P_s = self.function(np.array([x + 1j * self.a_d * y, at_s]))
        f = -1j * self.f * P
        g = self.g * P_s.imag
        g_i = g if self.is_fast else -self.g * P_s.real
        xx = (1 - s2 + 2 * self.a_d**2) * f.real + 2 * a_s * g
        yy = -(1 + s2) * f.real - 2 * a_s * g
        xy = -2 * self.a_d * f.imag - (1 + s2) * g_i
        found = np.array([side * xx, side * yy, xy])
        if self.bodies.is_on_rigid:
            found[:, np.broadcast_to(np.signbit(y_m), x.shape)] = np.nan
        return found

    def strain(self, x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
        """Over the root of Gamma [xx yy xy, places]; xy is half the engineering shear strain."""
        return self.bodies.strain(self.stress(x_m, y_m))


def tip_field(
    bodies: OpenRun | CaseLike,
    x_m: ArrayLike,
    y_m: ArrayLike,
    *,
    speed_m_per_s: float,
    Gamma_J_per_m2: float,
    cohesive_zone_m: float = 0.0,
    zone: str = "linear",
    direction: int = 1,
    stress: bool = False,
) -> dict[str, np.ndarray]:
    """Strain, or stress in Pa, that the tip of a front along direction adds to the state with the residual
    traction: xx, yy, xy at places from the tip. The body above slips to +x. NaN below a rigid plane.

    cohesive_zone_m: X_c behind the tip, 0 of a singular tip. zone: how the strength falls there, "linear"
    over the distance or over "slip"; above c_S over the distance."""
    of = bodies_of(bodies)
    V = number(speed_m_per_s, "speed_m_per_s", least=0, finite=True)
    X = number(cohesive_zone_m, "cohesive_zone_m", least=0, finite=True)
    root = np.sqrt(number(Gamma_J_per_m2, "Gamma_J_per_m2", least=0, finite=True))
    if direction not in (1, -1):
        raise CaseError(f"direction is {shown(direction)}; it must be 1 or -1")
    require_field(of, V, X, zone, "cohesive_zone_m")
    shapes = [
        np.asarray(number(of, name)) if np.ndim(of) == 0 else array(np.ravel(of), name).reshape(np.shape(of))
        for name, of in (("x_m", x_m), ("y_m", y_m))
    ]
    try:
        x, y = np.broadcast_arrays(*shapes)
    except ValueError:
        raise CaseError(
            f"x_m has the shape {shapes[0].shape}, y_m {shapes[1].shape}: give one of both"
        ) from None
    tip = TipField(of, V, direction, X, zone)
    found = root * (tip.stress if flag(stress, "stress") else tip.strain)(x.ravel(), y.ravel())
    return {part: values.reshape(x.shape) for part, values in zip(COMPONENTS, found, strict=True)}


def require_field(bodies: Bodies, speed_m_per_s: float, zone_m: float | None, zone: str, name: str) -> None:
    """Refuses a speed without a field, and a singular tip above c_S."""
    V, ranges = speed_m_per_s, bodies.ranges_m_per_s()
    if zone not in ZONES:
        raise CaseError(f"zone is {shown(zone)}; it must be one of {', '.join(ZONES)}")
    if not any(low < V < high or V == low == 0 for low, high in ranges):
        told = ", or from ".join(f"{low:.5g} to {high:.5g}" for low, high in ranges)
        raise CaseError(f"speed_m_per_s is {V:g} m/s; there is a field from {told} m/s")
    if bodies.c_S_m_per_s < V and zone_m == 0:
        raise CaseError(f"{name} is 0; above c_S a tip without a cohesive zone takes up no energy")
