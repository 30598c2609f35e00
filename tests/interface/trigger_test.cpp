// SPDX-License-Identifier: BSD-3-Clause
#include "interface/trigger.hpp"

#include <gtest/gtest.h>

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

TEST(TriggerFactor, WithoutARampIsAtOnceWhole) {
  const Trigger trigger{.ramp_s = 0};
  EXPECT_EQ(trigger_factor(trigger, 0), 1);
}

}  // namespace
}  // namespace slipfront::interface
