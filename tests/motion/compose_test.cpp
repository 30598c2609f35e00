// SPDX-License-Identifier: BSD-3-Clause
// The examples that put the library's objects together, and a friction law that the registry lacks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "examples/compose/gradual_weakening.hpp"
#include "examples/compose/rupture.hpp"
#include "interface/node_laws.hpp"

namespace slipfront::motion {
namespace {

constexpr interface::SlipWeakening linear { .mu_s = 0.7, .mu_k = 0.4, .d_c_m = 4e-6 };
const solid::Material pmma;

std::ptrdiff_t n_slipped(const std::vector<double>& first_s) {
  return std::ranges::count_if(first_s, [](double time_s) { return std::isfinite(time_s); });
}

TEST(Compose, ARuptureRunsToBothSidesSlowerThanWaves) {
  const auto first_s = rupture(linear, std::array{pmma});
  const double c_L = solid::longitudinal_speed_m_per_s(pmma);
  constexpr std::size_t middle = 100, edge = 12;  // elements of 1 mm
  for (const std::size_t beyond : {20U, 30U, 40U})
    for (const auto k : {middle - beyond, middle + beyond}) {
      ASSERT_TRUE(std::isfinite(first_s[k])) << k;
      EXPECT_GT(first_s[k], static_cast<double>(beyond - edge) * 1e-3 / c_L) << k;
    }
}

TEST(Compose, TwoEqualBodiesRuptureSymmetrically) {
  const auto first_s = rupture(linear, std::array{pmma, pmma});
  EXPECT_GT(n_slipped(first_s), 60);
  // Slip between equal bodies leaves the pressure as it is. Rounding may move an onset by a sub-step of 27
  // ns.
  for (std::size_t k = 0; k < first_s.size(); ++k) {
    const double mirrored_s = first_s[first_s.size() - 1 - k];
    EXPECT_TRUE(first_s[k] == mirrored_s || std::abs(first_s[k] - mirrored_s) < 30e-9) << k;
  }
}

TEST(Compose, ShearThatIsTakenAwayStopsTheRupture) {
  const auto whole = rupture(linear, std::array{pmma}), stopped = rupture(linear, std::array{pmma}, 30e-6);
  for (std::size_t k = 0; k < whole.size(); ++k)
    if (whole[k] < 30e-6) {
      EXPECT_EQ(stopped[k], whole[k]);
    }
  EXPECT_LT(n_slipped(stopped), n_slipped(whole));
  EXPECT_GT(n_slipped(stopped), 25);
}

TEST(Compose, ALawOfOnesOwnActsAsOneOfTheRegistry) {
  const GradualWeakening law;
  const auto mu = law.evaluator();
  EXPECT_DOUBLE_EQ(mu(0.0, 0.0), law.mu_s);
  EXPECT_DOUBLE_EQ(mu(0.0, law.slip_scale_m), law.mu_k + (law.mu_s - law.mu_k) / 4);
  const auto in_lanes = interface::in_lanes(interface::FrictionLaw(law), law);
  const SimdVector zero{};
  EXPECT_DOUBLE_EQ(in_lanes.mu(zero, zero + law.slip_scale_m)[0], mu(0.0, law.slip_scale_m));
  EXPECT_EQ(interface::FrictionLaw(law).name(), "gradual_weakening");
  const auto friction = without_registry(law);
  EXPECT_EQ(interface::static_coefficient(friction), law.mu_s);
  EXPECT_EQ(interface::kinetic_coefficient(friction), law.mu_k);
  // As much fracture energy as linear weakening over twice the slip: a rupture, somewhat another one.
  const auto own = rupture(friction, std::array{pmma}), other = rupture(linear, std::array{pmma});
  EXPECT_GT(n_slipped(own), 60);
  EXPECT_NE(own, other);
}

}  // namespace
}  // namespace slipfront::motion
