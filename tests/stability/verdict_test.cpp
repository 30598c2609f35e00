// SPDX-License-Identifier: BSD-3-Clause
#include "stability/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "interface/friction/coulomb.hpp"
#include "interface/friction/velocity_weakening.hpp"

namespace slipfront::stability {
namespace {

using interface::Coulomb;
using interface::VelocityWeakening;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double h = 0.667e-3;
constexpr double width = 0.2;

const solid::Material elastic{.stiffness_damping_s = 0};

TEST(WellPosedness, CoulombOnARigidPlane) {
  const auto low = well_posedness(elastic, Coulomb{0.9}, 5e6, h, width);
  EXPECT_FALSE(low.unbounded);
  EXPECT_EQ(low.growth_at_grid_per_s, 0);
  EXPECT_THAT(low.statement, StartsWith("well-posed"));
  const auto high = well_posedness(elastic, Coulomb{1.3}, 5e6, h, width);
  EXPECT_TRUE(high.unbounded);
  EXPECT_THAT(high.statement, StartsWith("ill-posed"));
  EXPECT_THAT(high.statement, HasSubstr("friction coupled to pressure"));
  // 0.106 k c_S, to the three decimals of the reference.
  const double k_c_S = std::numbers::pi / h * solid::shear_speed_m_per_s(elastic);
  EXPECT_NEAR(high.growth_at_grid_per_s / k_c_S, 0.106, 5e-4);
  EXPECT_EQ(high.weakening_over_radiation, 0);
}

TEST(WellPosedness, VelocityWeakeningAgainstRadiation) {
  // mu'(0) = -(mu_s - mu_k)^1.5/sqrt(alpha), G/c_S = sqrt(rho G).
  const auto& m = elastic;
  const auto w = well_posedness(m, VelocityWeakening{.mu_s = 0.9, .mu_k = 0.5}, 5e6, h, width);
  const double expected =
      std::pow(0.4, 1.5) / std::sqrt(0.1) * 5e6 / std::sqrt(m.density_kg_per_m3 * solid::shear_modulus_Pa(m));
  EXPECT_NEAR(w.weakening_over_radiation, expected, 1e-8 * expected);
  EXPECT_GT(expected, 1);
  EXPECT_TRUE(w.unbounded);
  EXPECT_TRUE(std::isinf(w.fastest_growth_per_s));
}

TEST(WellPosedness, SlipOfEqualBodiesDoesNotChangeThePressure) {
  const auto w =
      well_posedness({elastic, elastic}, VelocityWeakening{.mu_s = 0.65, .mu_k = 0.6}, 5e6, h, width);
  EXPECT_LT(w.weakening_over_radiation, 1);
  EXPECT_TRUE(w.unbounded);
  EXPECT_THAT(w.statement, HasSubstr("weakening with the slip rate feeds interface waves"));
}

TEST(WellPosedness, DampingGivesTheFastestWaveALength) {
  solid::Material m;
  m.stiffness_damping_s = 1e-7;
  const auto w = well_posedness(m, Coulomb{1.3}, 5e6, h, width);
  EXPECT_FALSE(w.unbounded);
  ASSERT_GT(w.fastest_wavelength_m, 0);
  const double c_S = solid::shear_speed_m_per_s(m);
  // Scales with beta_R c_S: growth beta_R is a function of beta_R c_S k alone.
  solid::Material twice = m;
  twice.stiffness_damping_s *= 2;
  const auto w2 = well_posedness(twice, Coulomb{1.3}, 5e6, h, width);
  // The search ends at a relative width of 1e-3.
  EXPECT_NEAR(w2.fastest_wavelength_m / w.fastest_wavelength_m, 2, 5e-3);
  EXPECT_NEAR(w.fastest_growth_per_s / w2.fastest_growth_per_s, 2, 1e-4);
  EXPECT_GT(w.fastest_wavelength_m, m.stiffness_damping_s * c_S);
  // No other wave grows faster.
  for (double k = 40; k < 1e7; k *= 1.07)
    if (const auto mode = fastest_growing_mode(m, w.sliding, k)) {
      EXPECT_LE(mode->growth_per_s(), w.fastest_growth_per_s * (1 + 1e-5)) << k;
    }
  EXPECT_DOUBLE_EQ(w.damping_length_m, 1e-7 * solid::longitudinal_speed_m_per_s(m));
  EXPECT_DOUBLE_EQ(w.damping_length_over_h, w.damping_length_m / h);
}

TEST(WellPosedness, DampingAloneDoesNotResolveStrongWeakening) {
  solid::Material m;
  const auto w = well_posedness(m, VelocityWeakening{}, 4.3e6, h, width);
  EXPECT_FALSE(w.unbounded);
  // Motion uniform in x: beta s = |m|^2 - 1; waves as long as the plate are close to it.
  const double uniform =
      (w.weakening_over_radiation * w.weakening_over_radiation - 1) / m.stiffness_damping_s;
  EXPECT_NEAR(w.fastest_growth_per_s, uniform, 1e-3 * uniform);
  EXPECT_DOUBLE_EQ(w.growth_in_crossing, w.fastest_growth_per_s * h / solid::longitudinal_speed_m_per_s(m));
  EXPECT_GT(w.growth_in_crossing, 1);
  EXPECT_THAT(w.statement, StartsWith("bounded, not resolved"));
}

}  // namespace
}  // namespace slipfront::stability
