// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/tip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipfront::fracture {
namespace {

solid::Material material(double nu, solid::Plane plane = solid::Plane::stress, double E_Pa = 3e9) {
  return {.youngs_modulus_Pa = E_Pa, .poissons_ratio = nu, .plane = plane};
}

/// In plane stress as in plane strain of this Poisson's ratio.
double plane_strain_nu(const solid::Material& m) {
  return m.plane == solid::Plane::strain ? m.poissons_ratio : m.poissons_ratio / (1 + m.poissons_ratio);
}

/// A_II(V) as Freund (1990) writes it.
double freund_A_II(const solid::Material& m, double v) {
  const double c_S = solid::shear_speed_m_per_s(m), c_L = solid::longitudinal_speed_m_per_s(m);
  const double a_d = std::sqrt(1 - v * v / (c_L * c_L)), a_s = std::sqrt(1 - v * v / (c_S * c_S));
  const double D = 4 * a_d * a_s - std::pow(1 + a_s * a_s, 2);
  return v * v * a_s / ((1 - plane_strain_nu(m)) * c_S * c_S * D);
}

/// k_II(V) by the trapezoidal rule in Freund's integral for S_+.
double freund_k_II(const solid::Material& m, double v) {
  const double a = 1 / solid::longitudinal_speed_m_per_s(m), b = 1 / solid::shear_speed_m_per_s(m);
  const double c = 1 / solid::rayleigh_speed_m_per_s(m), d = 1 / v;
  double sum = 0;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / n;
    const double s = 0.5 * (a + b) - 0.5 * (b - a) * std::cos(angle), s2 = s * s;
    const double f = std::atan(4 * s2 * std::sqrt((s2 - a * a) * (b * b - s2)) / std::pow(b * b - 2 * s2, 2));
    sum += f / (d - s) * 0.5 * (b - a) * std::sin(angle) / n;
  }
  return (1 - c * v) / std::sqrt(1 - b * v) * std::exp(sum);
}

TEST(Tip, AlikeBodiesAreThoseOfFreund) {
  for (const auto plane : {solid::Plane::stress, solid::Plane::strain}) {
    const auto m = material(0.33, plane);
    const Bodies bodies(m, m);
    EXPECT_NEAR(stiffness_Pa(bodies, 0), solid::uniaxial_modulus_Pa(m) / 4, 1e-6 * m.youngs_modulus_Pa);
    for (const double share : {0.05, 0.3, 0.6, 0.9, 0.98}) {
      const double v = share * solid::rayleigh_speed_m_per_s(m);
      const double A = freund_A_II(m, v), k = freund_k_II(m, v);
      EXPECT_NEAR(energy_factor(bodies, v), A, 1e-9 * A) << share;
      EXPECT_NEAR(speed_factor(bodies, v), A * k * k, 1e-7) << share;
    }
  }
}

/// k(V) of a crack on the rigid plane, verification/crack.md, by the midpoint rule.
double k_of_rigid_plane(const solid::Material& m, double v) {
  const double a = 1 / solid::longitudinal_speed_m_per_s(m), b = 1 / solid::shear_speed_m_per_s(m);
  constexpr int n = 20000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / n;
    const double s = 0.5 * (a + b) - 0.5 * (b - a) * std::cos(angle), s2 = s * s;
    sum += std::atan2(std::sqrt((s2 - a * a) * (b * b - s2)), s2) / (1 / v - s) * 0.5 * (b - a) *
           std::sin(angle) / n;
  }
  return std::sqrt(1 - v * a) * std::exp(-sum);
}

TEST(Tip, RigidPlaneHasNoRayleighSpeed) {
  const auto m = material(0.33);
  const Bodies bodies(m);
  const double G = solid::shear_modulus_Pa(m), c_S = solid::shear_speed_m_per_s(m);
  EXPECT_NEAR(stiffness_Pa(bodies, 0), 4 * G / (3 - 0.33), 1e-9 * G);
  EXPECT_DOUBLE_EQ(limiting_speed_m_per_s(bodies), c_S);
  for (const double share : {0.2, 0.9, 0.999}) {
    const double m_2 = share * share, c = c_S / solid::longitudinal_speed_m_per_s(m);
    const double a_d = std::sqrt(1 - m_2 * c * c), a_s = std::sqrt(1 - m_2);
    const double Y = G * a_d * m_2 / (1 - a_d * a_s);
    EXPECT_NEAR(stiffness_Pa(bodies, share * c_S), Y, 1e-9 * G) << share;
    const double k = k_of_rigid_plane(m, share * c_S);
    EXPECT_NEAR(speed_factor(bodies, share * c_S), k * k * stiffness_Pa(bodies, 0) / Y, 1e-6) << share;
  }
}

TEST(Tip, RigidPlaneIsTheLimitOfStiffBase) {
  const auto m = material(0.33);
  auto base = material(0.33, solid::Plane::stress, 3e13);
  base.density_kg_per_m3 = 1e7;
  const Bodies rigid(m), stiff(m, base);
  for (const double share : {0.2, 0.5, 0.8}) {
    const double v = share * solid::shear_speed_m_per_s(m);
    EXPECT_NEAR(stiffness_Pa(stiff, v), stiffness_Pa(rigid, v), 1e-3 * stiffness_Pa(rigid, v));
    EXPECT_NEAR(speed_factor(stiff, v), speed_factor(rigid, v), 1e-3);
  }
}

TEST(Tip, BodiesThatAreAlmostAlikeAsAlikeOnes) {
  const auto m = material(0.3);
  auto other = m;
  other.youngs_modulus_Pa *= 1.0001;
  const double v = 0.6 * solid::shear_speed_m_per_s(m);
  EXPECT_NEAR(speed_factor(Bodies(m, other), v), speed_factor(Bodies(m, m), v), 1e-4);
}

TEST(Tip, SlowPairsHaveAPoleAndAZero) {
  // Steel on aluminium has Stoneley's and the generalised Rayleigh wave.
  auto steel = material(0.29, solid::Plane::strain, 200e9),
       aluminium = material(0.33, solid::Plane::strain, 70e9);
  steel.density_kg_per_m3 = 7850;
  aluminium.density_kg_per_m3 = 2700;
  const Bodies bodies(aluminium, steel);
  const double limit = limiting_speed_m_per_s(bodies);
  EXPECT_LT(limit, solid::shear_speed_m_per_s(aluminium));
  double last = 1;
  for (const double share : {0.001, 0.2, 0.4, 0.6, 0.8, 0.9, 0.99}) {
    const double g = speed_factor(bodies, share * limit);
    EXPECT_GT(g, 0) << share;
    EXPECT_LT(g, last) << share;
    last = g;
  }
  EXPECT_LT(last, 0.1);
}

TEST(Tip, EnergyAndIntensityAreInverse) {
  const auto m = material(0.37);
  for (const auto& bodies : {Bodies(m), Bodies(m, m)}) {
    const double v = 0.7 * solid::shear_speed_m_per_s(m);
    const double G = energy_release_rate_J_per_m2(bodies, v, 1.5e5);
    EXPECT_NEAR(stress_intensity_Pa_sqrt_m(bodies, v, G), 1.5e5, 1e-6);
    // Slip and stress of a tip: (K/Y) sqrt(2 r/pi).
    EXPECT_NEAR(slip_squared_per_G_and_distance(bodies, v) * G,
                2 / std::numbers::pi * std::pow(1.5e5 / stiffness_Pa(bodies, v), 2), 1e-16);
  }
}

TEST(Tip, ExponentOfSlip) {
  const auto m = material(0.33);
  const Bodies alike(m, m), rigid(m);
  const double c_S = solid::shear_speed_m_per_s(m);
  EXPECT_NEAR(slip_exponent(alike, 0.5 * c_S, 0.6, Direction::with_slip), 0.5, 1e-9);
  EXPECT_NEAR(slip_exponent(alike, std::sqrt(2) * c_S, 0.6, Direction::with_slip), 0.5, 1e-9);
  // Freund (1979): tan(pi q) = 4 a_d a_s/(1 - a_s^2)^2 of the stress exponent q, a_s^2 = V^2/c_S^2 - 1.
  const double v = 1.2, c = c_S / solid::longitudinal_speed_m_per_s(m);
  const double a_d = std::sqrt(1 - v * v * c * c), a_s = std::sqrt(v * v - 1);
  const double q = std::atan(4 * a_d * a_s / std::pow(1 - a_s * a_s, 2)) / std::numbers::pi;
  for (const auto direction : {Direction::with_slip, Direction::against_slip})
    EXPECT_NEAR(slip_exponent(alike, v * c_S, 0.6, direction), 1 - q, 1e-9);
  // On the rigid plane p = +- i k N slip, N = 2 G (1 - 2 nu)/(3 - 4 nu) of the plane-strain nu.
  const double nu = plane_strain_nu(m);
  const double eps = std::atan(0.6 * (1 - 2 * nu) / (2 * (1 - nu))) / std::numbers::pi;
  EXPECT_NEAR(slip_exponent(rigid, 1e-6 * c_S, 0.6, Direction::with_slip), 0.5 - eps, 1e-6);
  EXPECT_NEAR(slip_exponent(rigid, 1e-6 * c_S, 0.6, Direction::against_slip), 0.5 + eps, 1e-6);
}

}  // namespace
}  // namespace slipfront::fracture
