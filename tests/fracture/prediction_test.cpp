// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "fracture/static_crack.hpp"

namespace slipfront::fracture {
namespace {

constexpr double h_m = 1e-3;
constexpr std::size_t n = 301, middle = 150;

/// Alike bodies under a uniform drop.
struct Sample {
  solid::Material material{.youngs_modulus_Pa = 3e9, .poissons_ratio = 0.33};
  Bodies bodies{material, material};
  std::vector<double> x_m = [] {
    std::vector<double> x;
    for (std::size_t k = 0; k < n; ++k) x.push_back(static_cast<double>(k) * h_m);
    return x;
  }();
  double drop_Pa = 2e5;
  CrackLoads loads{std::vector(n, 0.8e6 + drop_Pa), std::vector(n, 2e6), std::vector(n, 0.4),
                   std::vector(n, 0.0)};
  std::vector<double> energy = std::vector(n, G(20e-3));

  double G(double half_length_m) const {
    return drop_Pa * drop_Pa * std::numbers::pi * half_length_m / material.youngs_modulus_Pa;
  }
  Prediction predicted(std::size_t first, std::size_t last) const {
    return predict(response_of_half_spaces(bodies, x_m), loads, energy, first, last, SpeedLaw(bodies));
  }
};

TEST(Prediction, CriticalLengthIsGriffiths) {
  const Sample sample;
  const auto p = sample.predicted(middle - 5, middle + 5);
  EXPECT_FALSE(p.starts);
  EXPECT_DOUBLE_EQ(p.first_length_m, 11 * h_m);
  EXPECT_NEAR(p.critical_length_m, 40e-3, 1.5 * h_m);
  EXPECT_TRUE(sample.predicted(middle - 25, middle + 25).starts);
}

TEST(Prediction, SpeedLawIsTheInverseOfTheSpeedFactor) {
  const auto m = Sample().material;
  for (const auto& bodies : {Bodies(m), Bodies(m, m)}) {
    const SpeedLaw law(bodies);
    EXPECT_EQ(law.speed_m_per_s(1.2), 0);
    EXPECT_NEAR(speed_factor(bodies, law.speed_m_per_s(0.6)), 0.6, 1e-5);
  }
}

TEST(Prediction, FrontsOfAMirroredSampleAreMirrored) {
  // In the middle both tips are at their nodes at once; rounding must not let one go first.
  Sample sample;
  for (std::size_t k = 0; k < n; ++k) sample.energy[k] *= 1 + 1e-3 * static_cast<double>(k % 2);
  const auto p = sample.predicted(middle - 25, middle + 25);
  ASSERT_EQ(p.fronts.size(), 2U);
  ASSERT_EQ(p.fronts[0].points.size(), p.fronts[1].points.size());
  for (std::size_t k = 0; k < p.fronts[0].points.size(); ++k) {
    const auto &left = p.fronts[0].points[k], &right = p.fronts[1].points[k];
    EXPECT_NEAR(left.time_s, right.time_s, 1e-9 * right.time_s);
    EXPECT_NEAR(left.G_static_J_per_m2, right.G_static_J_per_m2, 1e-9 * right.G_static_J_per_m2);
  }
}

TEST(Prediction, SpeedsFollowTheEquationOfMotion) {
  const Sample sample;
  const auto p = sample.predicted(middle - 25, middle + 25);
  ASSERT_EQ(p.fronts.size(), 2U);
  for (const auto& front : p.fronts) {
    EXPECT_EQ(front.end, PredictedEnd::contact_end);
    const auto& point = front.points[80];
    const double share = sample.energy.front() / point.G_static_J_per_m2;
    EXPECT_NEAR(speed_factor(sample.bodies, point.v_tip_m_per_s), share, 1e-3);
    // The time is the sum of the node's ways.
    const auto& before = front.points[79];
    EXPECT_NEAR(point.time_s - before.time_s, h_m / point.v_tip_m_per_s, 0.02 * h_m / point.v_tip_m_per_s);
  }
}

TEST(Prediction, ArrestsBeforeATougherPart) {
  Sample sample;
  for (std::size_t k = 0; k < n; ++k)
    if (sample.x_m[k] > 0.25) sample.energy[k] = 100 * sample.G(1);
  const auto p = sample.predicted(middle - 25, middle + 25);
  ASSERT_EQ(p.fronts.size(), 2U);
  const auto& right = p.fronts[1];
  EXPECT_EQ(right.direction, 1);
  EXPECT_EQ(right.end, PredictedEnd::arrest);
  EXPECT_NEAR(right.points.back().x_m, 0.251, 1e-9);
  EXPECT_TRUE(std::isnan(right.points.back().time_s));
  EXPECT_EQ(p.fronts[0].end, PredictedEnd::contact_end);
}

TEST(Prediction, NoneWithoutADrop) {
  Sample sample;
  sample.loads.t_Pa.assign(n, 0.7e6);
  const auto p = sample.predicted(middle, middle);
  EXPECT_FALSE(p.starts);
  EXPECT_TRUE(std::isnan(p.critical_length_m));
  EXPECT_TRUE(p.fronts.empty());
}

}  // namespace
}  // namespace slipfront::fracture
