// SPDX-License-Identifier: BSD-3-Clause
#include "motion/step_plan.hpp"

#include <gmock/gmock.h>

namespace slipfront::motion {
namespace {

using testing::ElementsAre;

TEST(StepPlan, OfOneBodyFollowsItsCoarsestBlock) {
  const auto plan =
      step_plan(std::vector{BodySteps{2e-6, {1, 1, 2, 4}}}, {.step_factor = 0.5, .interface_substeps = 18});
  EXPECT_EQ(plan.stable_step_s, 2e-6);
  EXPECT_EQ(plan.lowest_step_s, 1e-6);
  EXPECT_EQ(plan.step_s, 4e-6);
  EXPECT_EQ(plan.period, 72);
  EXPECT_DOUBLE_EQ(plan.substep_s(), 1e-6 / 18);
  const auto& body = plan.bodies.front();
  EXPECT_THAT(body.block_periods, ElementsAre(18, 18, 36, 72));
  EXPECT_DOUBLE_EQ(body.level_step_s(36), 2e-6);
  EXPECT_TRUE(body.has_common_step);
}

TEST(StepPlan, BodiesMeetAtTheShortestCommonStep) {
  const auto plan = step_plan(std::vector<BodySteps>{{3.5e-6, {1}}, {1e-6, {1, 2}}},
                              {.step_factor = 1, .interface_substeps = 5});
  EXPECT_EQ(plan.lowest_step_s, 1e-6);
  EXPECT_THAT(plan.bodies[0].block_periods, ElementsAre(15));
  EXPECT_THAT(plan.bodies[1].block_periods, ElementsAre(5, 10));
  EXPECT_EQ(plan.period, 30);
  EXPECT_DOUBLE_EQ(plan.step_s, 6e-6);
  EXPECT_DOUBLE_EQ(plan.bodies[0].step_s, 3e-6);
  EXPECT_FALSE(plan.bodies[0].has_common_step);
  EXPECT_FALSE(plan.bodies[1].has_common_step);
}

TEST(StepPlan, AMuchSlowerBodyTakesSixteenStepsOfTheFasterOne) {
  const auto plan = step_plan(std::vector<BodySteps>{{1e-6, {1}}, {1e-3, {1}}}, {.interface_substeps = 1});
  EXPECT_THAT(plan.bodies[1].block_periods, ElementsAre(16));
  EXPECT_FALSE(plan.bodies[0].has_common_step);
  EXPECT_TRUE(plan.bodies[1].has_common_step);
}

}  // namespace
}  // namespace slipfront::motion
