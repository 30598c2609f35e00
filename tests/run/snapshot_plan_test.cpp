// SPDX-License-Identifier: BSD-3-Clause
#include "setup/snapshot_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases.hpp"

namespace slipfront::run {
namespace {

using problem::make_problem;
using test::coarse_case;
using test::go_on;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(SnapshotPlan, LeavesOutWhatTheRunCannotTake) {
  auto config = coarse_case();
  config.time.end_s = 100e-6;
  config.output.snapshot_times_s = {0, 0.5e-6, 10e-6, 10.5e-6, 11e-6, 100e-6, 101e-6, 1};
  // Steps of 1 us: at 0, 1, 10, 11 and 11 us.
  const auto plan = setup::snapshot_plan(make_problem(config), 1e-6);
  EXPECT_THAT(plan.times_s, ElementsAre(0, 0.5e-6, 10e-6, 10.5e-6, 100e-6));
  EXPECT_THAT(test::texts_of(plan.notes),
              ElementsAre(AllOf(HasSubstr("2 of 8"), HasSubstr("time.end_s = 0.0001")),
                          AllOf(HasSubstr("1 of 8"), HasSubstr("into the step"))));
  config.output.snapshot_times_s = {0, 10e-6};
  EXPECT_THAT(setup::snapshot_plan(make_problem(config), 1e-6).notes, IsEmpty());
}

TEST(SnapshotPlan, IsWhatARunTakesAndTells) {
  auto config = coarse_case();
  config.time.quiet_s = 1;
  config.output.snapshot_times_s = {0, 10e-6, 10.001e-6, 30e-6, 1};
  const auto initial = setup::make_initial_state(make_problem(config), go_on);
  const auto result = run_from(make_problem(config), initial, go_on);
  const auto plan = setup::snapshot_plan(make_problem(config), result.step_s);
  EXPECT_THAT(plan.notes, testing::SizeIs(2));
  EXPECT_EQ(test::snapshots_of(result, initial.n_nodes).size(), 3U);
  for (const auto& note : plan.notes) EXPECT_THAT(test::texts_of(result.notes), testing::Contains(note.text));
}

TEST(SnapshotPlan, TellsWhatAQuietEndLeavesOut) {
  auto config = coarse_case(interface::EventKind::none);
  // Nothing moves: tractions below the strength, the loaded edge still.
  config.plate.corner = mesh::Corner::none;
  config.loading.method = statics::LoadingMethod::prestress;
  config.loading.shear_speed_m_per_s = 0;
  config.prestress = {1e6, 5e6, "", {}};
  config.time.end_s = 1;
  config.output.snapshot_times_s = {0, 10e-6, 0.5, 1};
  const auto initial = setup::make_initial_state(make_problem(config), go_on);
  const auto result = run_from(make_problem(config), initial, go_on);
  ASSERT_EQ(result.event.end, motion::EventEnd::quiet);
  EXPECT_EQ(test::snapshots_of(result, initial.n_nodes).size(), 2U);
  EXPECT_THAT(test::texts_of(result.notes),
              testing::Contains(HasSubstr("2 of 4 output.snapshot_times_s are after the end")));
}

}  // namespace
}  // namespace slipfront::run
