// SPDX-License-Identifier: BSD-3-Clause
#include "run/choices.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "cases.hpp"

namespace slipfront::run {
namespace {

using test::coarse_case;

TEST(SuitableThreads, AreOneForSmallPlates) {
  const int processors = static_cast<int>(std::thread::hardware_concurrency());
  EXPECT_EQ(suitable_threads(coarse_case(interface::EventKind::left, 1e-3)), 1);
  EXPECT_EQ(suitable_threads(coarse_case(interface::EventKind::left, 2.0 / 3e3)), std::min(2, processors));
  EXPECT_EQ(suitable_threads(coarse_case(interface::EventKind::left, 1e-4)), std::min(4, processors));
}

TEST(Choices, TheStateBeforeIsKeptByThoseWhoFindIt) {
  auto config = test::coarse_case();
  EXPECT_FALSE(has_distributed_displacements(config, 4));
  config.loading.solver = statics::StaticSolver::petsc;
  EXPECT_TRUE(has_distributed_displacements(config, 4));
  EXPECT_FALSE(has_distributed_displacements(config, 1));
  auto free_top = config, ramp = config;
  free_top.loading.top_during_tilt = statics::TopEdge::free;
  EXPECT_FALSE(has_distributed_displacements(free_top, 4));
  ramp.loading.method = statics::LoadingMethod::ramp;
  EXPECT_FALSE(has_distributed_displacements(ramp, 4));
}

TEST(Choices, NoProcessHoldsManySquaresWhereAllKeepTheStateBefore) {
  auto config = test::coarse_case();
  config.loading.solver = statics::StaticSolver::petsc;
  EXPECT_FALSE(leader_has_interface_only(config, 4));  // few nodes
  config.plate.element_size_m = 0.1e-3;
  ASSERT_EQ(config.plate.corner, mesh::Corner::relief);
  EXPECT_TRUE(leader_has_interface_only(config, 4));
  EXPECT_FALSE(leader_has_interface_only(config, 1));
  EXPECT_FALSE(leader_has_interface_only(config, 4, false));
  auto deep = config, fillet = config, graded = config, stretched = config;
  stretched.plate.width_m *= 1 + 2e-9;
  EXPECT_FALSE(leader_has_interface_only(stretched, 4));
  stretched.plate.width_m = config.plate.width_m * (1 + 1e-11);
  EXPECT_TRUE(leader_has_interface_only(stretched, 4));
  deep.plate.relief_depth_m = deep.plate.height_m;
  EXPECT_FALSE(leader_has_interface_only(deep, 4));
  fillet.plate.corner = mesh::Corner::fillet;
  EXPECT_FALSE(leader_has_interface_only(fillet, 4));
  graded.plate.coarsenings = 1;
  EXPECT_FALSE(leader_has_interface_only(graded, 4));
}

}  // namespace
}  // namespace slipfront::run
