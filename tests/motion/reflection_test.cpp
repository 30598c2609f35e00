// SPDX-License-Identifier: BSD-3-Clause
#include "reflection.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slipfront::motion::test {
namespace {

const solid::Material material{.stiffness_damping_s = 0};
const double ratio = solid::longitudinal_speed_m_per_s(material) / solid::shear_speed_m_per_s(material);

TEST(ReflectionTheory, VanishesAtNormalIncidenceAndIsTotalAtGrazing) {
  for (const auto wave : {PlaneWave::longitudinal, PlaneWave::shear}) {
    const auto normal = theory(wave, 0, ratio);
    EXPECT_NEAR(std::abs(normal.longitudinal), 0, 1e-15);
    EXPECT_NEAR(std::abs(normal.shear), 0, 1e-15);
    const auto grazing = theory(wave, 1 - 1e-12, ratio);
    EXPECT_NEAR(std::abs(wave == PlaneWave::shear ? grazing.shear : grazing.longitudinal), 1, 1e-5);
  }
}

TEST(ReflectionTheory, NeverGivesMoreEnergyThanCame) {
  for (double sine = 0.01; sine < 1; sine += 0.01) {
    const double cos_in = std::sqrt(1 - sine * sine), cos_s = std::sqrt(1 - sine * sine / (ratio * ratio));
    const auto p = theory(PlaneWave::longitudinal, sine, ratio);
    EXPECT_LT(std::norm(p.longitudinal) + std::norm(p.shear) * cos_s / (ratio * cos_in), 1) << sine;
    const auto s = theory(PlaneWave::shear, sine, ratio);
    const double sin_p = sine * ratio;
    const double flux_p = sin_p < 1 ? ratio * std::sqrt(1 - sin_p * sin_p) / cos_in : 0;
    EXPECT_LT(std::norm(s.longitudinal) * flux_p + std::norm(s.shear), 1) << sine;
  }
}

// About 45 degrees; the shear wave is beyond its critical angle, 34 degrees. What the elements add, by their
// dispersion and the lumped mass of the edge, is of second order in element over wavelength: a quarter at
// half of it, less what the coarser mesh has of higher order.
TEST(Reflection, OfObliqueWavesConvergesToTheTheory) {
  for (const auto wave : {PlaneWave::longitudinal, PlaneWave::shear}) {
    const bool shear = wave == PlaneWave::shear;
    SCOPED_TRACE(shear ? "shear" : "longitudinal");
    double error[2];
    for (const int k : {0, 1}) {
      const int scale = 2 << k;
      const auto m = measure(wave, 14 * scale, 10.0 * scale, material);
      const auto expected = theory(wave, m.sine, ratio);
      error[k] = std::abs((shear ? m.shear : m.longitudinal) -
                          std::abs(shear ? expected.shear : expected.longitudinal));
      // The converted wave is shorter, 11 and 22 elements, and has the packet's finite width in q as well.
      EXPECT_TRUE(shear || std::abs(m.shear - std::abs(expected.shear)) <= 0.01) << m.shear;
    }
    EXPECT_LT(error[1], error[0] / 3);
  }
}

}  // namespace
}  // namespace slipfront::motion::test
