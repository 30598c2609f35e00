// SPDX-License-Identifier: BSD-3-Clause
#include "study/convergence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "support/files.hpp"

namespace slipfront::study {
namespace {

using testing::ElementsAre;

input::Case coarse_case() {
  input::Case config;
  config.plate.element_size_m = 2.5e-3;
  return config;
}

std::vector<double> values(const Plan& plan) {
  std::vector<double> list;
  for (const auto& member : plan.members) list.push_back(member.value);
  return list;
}

TEST(ConvergencePlan, RefinesElementStepAndDamping) {
  const auto plans = plan_convergence(coarse_case(), {});
  ASSERT_EQ(plans.size(), 3U);
  EXPECT_THAT(values(plans[0]), ElementsAre(5e-3, 2.5e-3, 1.25e-3));
  EXPECT_THAT(values(plans[1]), ElementsAre(9, 18, 36, 72));
  EXPECT_THAT(plans[1].last, ElementsAre(1, 2, 3));
  EXPECT_EQ(plans[1].own, 1U);
  EXPECT_THAT(values(plans[2]), ElementsAre(2e-7, 1e-7, 5e-8, 0));
  EXPECT_THAT(plans[2].last, ElementsAre(0, 1, 2));
  for (const auto& plan : plans)
    for (const auto& member : plan.members) EXPECT_EQ(member.config.fronts.l_star_m, 5e-3);
}

TEST(ConvergencePlan, TakesTheStepItselfWithoutSubCyclingAndLeavesOutDampingThatIsNotThere) {
  auto config = coarse_case();
  config.time.interface_substeps = 1;
  config.material.stiffness_damping_s = 0;
  const auto plans = plan_convergence(config, {});
  ASSERT_EQ(plans.size(), 2U);
  EXPECT_EQ(plans[1].parameter, "time.step_factor");
  EXPECT_THAT(values(plans[1]), ElementsAre(0.9, 0.45, 0.225));
}

TEST(ConvergencePlan, RefusesElementSizesThatMakeNoSequence) {
  for (const std::vector<double>& sizes :
       {std::vector{5e-3, 2.5e-3}, {4e-3, 2e-3, 1e-3}, {5e-3, 2.5e-3, 2.5e-3}, {5e-3, 2.5e-3, -1e-3}})
    EXPECT_THROW(plan_convergence(coarse_case(), {.element_sizes_m = sizes}), UserError);
}

TEST(FrontSpeed, IsLinearBetweenThePointsOfAFront) {
  fronts::Front front;
  front.direction = -1;
  for (const auto& [x, v] : {std::pair{0.03, 100.0}, {0.02, 200.0}, {0.01, undefined}}) {
    fronts::FrontPoint point;
    point.x_m = x;
    point.v_tip_m_per_s = v;
    front.points.push_back(point);
  }
  EXPECT_NEAR(v_tip_at(front, 0.0225), 175, 1e-9);
  EXPECT_EQ(v_tip_at(front, 0.02), 200);
  EXPECT_TRUE(std::isnan(v_tip_at(front, 0.015)));
  EXPECT_TRUE(std::isnan(v_tip_at(front, 0.031)));
}

TEST(ConvergenceStudy, IsTheSameForAnyNumberOfThreads) {
  test::TemporaryFolder one, three;
  for (const auto& [dir, threads] : {std::pair{one.path(), 1}, {three.path(), 3}}) {
    ConvergenceOptions options;
    options.threads = threads;
    const auto config = coarse_case();
    const auto result = study_convergence(config, options, [](std::size_t, std::size_t) { return true; });
    EXPECT_EQ(result.counts.n_runs, 9U);  // 3 + 4 + 4, the case itself in all three
    EXPECT_FALSE(result.sequences[0].stations.empty());
    write_convergence(dir, config, result);
  }
  for (const char* name : {"convergence.csv", "convergence.json"})
    EXPECT_EQ(test::read_file(one.path() / name), test::read_file(three.path() / name)) << name;
}

TEST(ConvergenceStudy, CanBeInterrupted) {
  EXPECT_THROW(study_convergence(coarse_case(), {}, [](std::size_t done, std::size_t) { return done < 2; }),
               Interrupted);
}

}  // namespace
}  // namespace slipfront::study
