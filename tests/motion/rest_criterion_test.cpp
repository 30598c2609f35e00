// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/rest_criterion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

class QuietRule : public ::testing::Test {
 protected:
  mesh::Mesh mesh_ = support::tiny_plate(mesh::Corner::none);
  solid::Material material_;
  Stepper stepper_{mesh_, material_, support::paper_law, {}};
  double mass_kg_ = std::reduce(stepper_.plate().mass_kg.begin(), stepper_.plate().mass_kg.end());
  /// Slip rates are small below 1 mm/s.
  RestCriterion rest_criterion_{stepper_, 1, 0, 1};
};

TEST_F(QuietRule, SlipThatGrowsIsNotQuietHoweverSlow) {
  for (int step = 1; step < 100; ++step)
    rest_criterion_.see_slip_rate(step, 1e-9 * std::pow(1.01, step));  // a tenth in ten steps
  EXPECT_GE(rest_criterion_.since_s(), 90);
}

TEST_F(QuietRule, SteadyAndDyingSlipIsLeftToItsSpeed) {
  rest_criterion_.see_slip_rate(1, 1e-4);
  EXPECT_EQ(rest_criterion_.since_s(), 1);
  for (int step = 2; step < 50; ++step) rest_criterion_.see_slip_rate(step, 1e-4);
  for (int step = 50; step < 100; ++step) rest_criterion_.see_slip_rate(step, 1e-4 / step);
  EXPECT_EQ(rest_criterion_.since_s(), 1);
  rest_criterion_.see_slip_rate(100, 1.2e-4 / 99);
  EXPECT_EQ(rest_criterion_.since_s(), 100);
}

TEST_F(QuietRule, WavesCountUntilAHundredthOfTheirVelocityIsLeft) {
  rest_criterion_.see_kinetic_energy(1, mass_kg_);
  rest_criterion_.see_kinetic_energy(2, 1.01e-4 * mass_kg_);
  EXPECT_EQ(rest_criterion_.since_s(), 2);
  rest_criterion_.see_kinetic_energy(3, 0.99e-4 * mass_kg_);
  EXPECT_EQ(rest_criterion_.since_s(), 2);
}

TEST_F(QuietRule, WavesTooWeakForTheStrengthDoNotCount) {
  // All of the plate at just less than a thousandth of the rate scale.
  rest_criterion_.see_kinetic_energy(1, 0.5 * mass_kg_ * 0.99e-6);
  EXPECT_EQ(rest_criterion_.since_s(), 0);
  rest_criterion_.see_kinetic_energy(2, 0.5 * mass_kg_ * 1.01e-6);
  EXPECT_EQ(rest_criterion_.since_s(), 2);
}

TEST_F(QuietRule, SlipFasterThanCreepAndItsBeginningsCount) {
  const auto since_s = [&](double time_s, bool moves, std::vector<SlipChange> changes) {
    rest_criterion_.at_update({time_s, moves, std::move(changes), {}});
    return rest_criterion_.since_s();
  };
  EXPECT_EQ(since_s(1, true, {}), 1);
  EXPECT_EQ(since_s(2, false, {{.begins = true}}), 2);
  EXPECT_EQ(since_s(3, false, {{.begins = false}}), 2);
}

TEST_F(QuietRule, CountsFromTheLastChangeOfTheTrigger) {
  RestCriterion triggered(stepper_, 1, 5, 1);
  triggered.see_slip_rate(1, 1);
  EXPECT_EQ(triggered.since_s(), 5);
}

TEST(SlipRateScale, IsTheMeanStrengthOverTheRadiationDamping) {
  statics::Equilibrium state;
  state.tractions.p_s_Pa = {1e6, 3e6, -1e6, 4e6};
  EXPECT_DOUBLE_EQ(slip_rate_scale_m_per_s(state, 0.5, {1000, 1e6}), 1);
}

}  // namespace
}  // namespace slipfront::motion
