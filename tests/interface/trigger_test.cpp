// SPDX-License-Identifier: BSD-3-Clause
#include "interface/trigger.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slipfront::interface {
namespace {

TEST(TriggerFactor, RisesLinearlyThenHolds) {
  const Trigger trigger{.ramp_s = 4e-6};
  EXPECT_EQ(trigger_factor(trigger, 0), 0);
  EXPECT_DOUBLE_EQ(trigger_factor(trigger, 1e-6), 0.25);
  EXPECT_DOUBLE_EQ(trigger_factor(trigger, 3e-6), 0.75);
  EXPECT_EQ(trigger_factor(trigger, 4e-6), 1);
  EXPECT_EQ(trigger_factor(trigger, 1), 1);
}

TEST(TriggerFactor, IsTakenAwayAfterItsDuration) {
  const Trigger after{.ramp_s = 4e-6, .duration_s = 10e-6};
  EXPECT_EQ(trigger_factor(after, 9.99e-6), 1);
  EXPECT_EQ(trigger_factor(after, 10e-6), 0);
  const Trigger during{.ramp_s = 4e-6, .duration_s = 2e-6};
  EXPECT_DOUBLE_EQ(trigger_factor(during, 1.9e-6), 0.475);
  EXPECT_EQ(trigger_factor(during, 2e-6), 0);
}

TEST(TriggerFactor, RisesSmoothlyAsTPV101) {
  const Trigger trigger{.ramp = Ramp::smooth, .ramp_s = 2};
  EXPECT_EQ(trigger_factor(trigger, 0), 0);
  EXPECT_LT(trigger_factor(trigger, 1e-3), 1e-300);
  EXPECT_DOUBLE_EQ(trigger_factor(trigger, 1), std::exp(-1.0 / 3));  // (1 - 2)^2/(1 (1 - 4))
  EXPECT_NEAR(trigger_factor(trigger, 2 - 1e-4), 1, 1e-8);           // flat at the end
  EXPECT_EQ(trigger_factor(trigger, 2), 1);
}

TEST(TriggerFactor, WithoutARampIsAtOnceWhole) {
  const Trigger trigger{.ramp_s = 0};
  EXPECT_EQ(trigger_factor(trigger, 0), 1);
}

}  // namespace
}  // namespace slipfront::interface
