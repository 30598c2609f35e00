// SPDX-License-Identifier: BSD-3-Clause
#include "verification/scattering.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slipfront::verification {
namespace {

using Complex = std::complex<double>;
constexpr double k_x = 50;
const solid::Material pmma{};
const solid::Material aluminium{.youngs_modulus_Pa = 70e9, .poissons_ratio = 0.33, .density_kg_per_m3 = 2700};

double omega_at(const solid::Material& material, Kind kind, double angle) {
  return k_x * speed_m_per_s(material, kind) / std::sin(angle);
}

/// Over that of a wave of amplitude 1, per omega^2/2.
double flux(const solid::Material& m, Kind kind, double omega) {
  const double c = speed_m_per_s(m, kind);
  return m.density_kg_per_m3 * c * c / omega * leaving_k_y(m, kind, k_x, omega).real();
}

TEST(Scattering, AtTheNormalFollowsTheImpedances) {
  for (const Kind kind : kinds) {
    const double omega = omega_at(pmma, kind, 1e-7);
    const auto a = scattered({pmma, aluminium}, kind, k_x, omega);
    const double Z_1 = pmma.density_kg_per_m3 * speed_m_per_s(pmma, kind);
    const double Z_2 = aluminium.density_kg_per_m3 * speed_m_per_s(aluminium, kind);
    // The polarisation of either kind turns round with the wave.
    EXPECT_NEAR(of(a, 0, kind).real(), (Z_2 - Z_1) / (Z_1 + Z_2), 1e-6);
    EXPECT_NEAR(std::abs(of(a, 1, kind)), 2 * Z_1 / (Z_1 + Z_2), 1e-6);
  }
}

TEST(Scattering, BetweenEqualBodiesIsNone) {
  for (const Kind kind : kinds) {
    const Kind other = kind == Kind::longitudinal ? Kind::shear : Kind::longitudinal;
    const auto a = scattered({pmma, pmma}, kind, k_x, omega_at(pmma, kind, 0.5));
    EXPECT_NEAR(std::abs(of(a, 1, kind)), 1, 1e-14);
    for (const auto& none : {of(a, 0, kind), of(a, 0, other), of(a, 1, other)})
      EXPECT_LT(std::abs(none), 1e-14);
  }
}

TEST(Scattering, OnNothingIsThatOfAFreeEdge) {
  auto nothing = pmma;
  nothing.youngs_modulus_Pa *= 1e-12;
  nothing.density_kg_per_m3 *= 1e-12;
  const double omega = omega_at(pmma, Kind::longitudinal, 0.6);
  const double a = leaving_k_y(pmma, Kind::longitudinal, k_x, omega).real();
  const double b = leaving_k_y(pmma, Kind::shear, k_x, omega).real();
  const double square = std::pow(b * b - k_x * k_x, 2), product = 4 * k_x * k_x * a * b;
  const auto amplitude = scattered({pmma, nothing}, Kind::longitudinal, k_x, omega);
  EXPECT_NEAR(std::abs(of(amplitude, 0, Kind::longitudinal) - (product - square) / (product + square)), 0,
              1e-10);
}

/// With an elastic line at the interface it does to first order.
TEST(Scattering, KeepsTheFluxOfEnergy) {
  const std::array bodies = {pmma, aluminium};
  for (const Kind kind : kinds)
    for (const double angle : {0.1, 0.4, 0.8, 1.2}) {  // below and beyond the critical angles
      const double omega = omega_at(pmma, kind, angle);
      const auto a = scattered(bodies, kind, k_x, omega);
      const auto change = change_by({{{0.01, 1e-12, 3e-12}, {0.02, 2e-13, 1e-13}}}, bodies, kind, k_x, omega);
      double sum = 0, changed = 0, size = 0;
      for (int body = 0; body < 2; ++body)
        for (const Kind out : kinds) {
          const Complex both = std::conj(of(a, body, out)) * of(change, body, out);
          const double flux_out = flux(bodies[body], out, omega);
          sum += std::norm(of(a, body, out)) * flux_out;
          changed += both.real() * flux_out;
          size += std::abs(both) * flux_out;
        }
      EXPECT_NEAR(sum / flux(pmma, kind, omega), 1, 1e-13);
      if (angle > 1) continue;
      EXPECT_GT(size, 0);
      EXPECT_LT(std::abs(changed), 1e-12 * size);
    }
}

TEST(Scattering, ByAnElasticLineInOneBodyIsThatOfAPlane) {
  // A P wave along y in one medium passes a line with compliance e: reflected and lost is i omega Z e/2.
  const std::array bodies = {pmma, pmma};
  const double omega = omega_at(pmma, Kind::longitudinal, 1e-7), e = 1e-20;
  const double Z = pmma.density_kg_per_m3 * speed_m_per_s(pmma, Kind::longitudinal);
  const auto change = change_by({{{0, e, e}, {}}}, bodies, Kind::longitudinal, k_x, omega);
  const double size = 0.5 * omega * Z * e;
  EXPECT_NEAR(std::abs(of(change, 0, Kind::longitudinal)), size, 1e-6 * size);
  EXPECT_NEAR(std::abs(of(change, 1, Kind::longitudinal)), size, 1e-6 * size);
}

}  // namespace
}  // namespace slipfront::verification
