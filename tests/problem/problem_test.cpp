// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem.hpp"

#include <gtest/gtest.h>

namespace slipfront::problem {
namespace {

TEST(Problem, NoProcessHoldsManySquaresUnderGivenTractions) {
  input::Case config;
  config.plate.element_size_m = 4e-3;
  config.plate.corner = mesh::Corner::relief;
  config.base.kind = input::BaseKind::rigid;
  config.loading.method = statics::LoadingMethod::prestress;
  EXPECT_FALSE(root_has_interface_only(make_problem(config), 4));  // few nodes
  config.plate.element_size_m = 0.1e-3;
  ASSERT_EQ(config.plate.corner, mesh::Corner::relief);
  EXPECT_TRUE(root_has_interface_only(make_problem(config), 4));
  EXPECT_FALSE(root_has_interface_only(make_problem(config), 1));
  auto deep = config, fillet = config, graded = config, stretched = config, tilted = config;
  stretched.plate.width_m *= 1 + 2e-9;
  EXPECT_FALSE(root_has_interface_only(make_problem(stretched), 4));
  stretched.plate.width_m = config.plate.width_m * (1 + 1e-11);
  EXPECT_TRUE(root_has_interface_only(make_problem(stretched), 4));
  deep.plate.relief_depth_m = deep.plate.height_m;
  EXPECT_FALSE(root_has_interface_only(make_problem(deep), 4));
  fillet.plate.corner = mesh::Corner::fillet;
  EXPECT_FALSE(root_has_interface_only(make_problem(fillet), 4));
  graded.plate.coarsenings = 1;
  EXPECT_FALSE(root_has_interface_only(make_problem(graded), 4));
  tilted.loading.method = statics::LoadingMethod::direct;
  EXPECT_FALSE(root_has_interface_only(make_problem(tilted), 4));
}

}  // namespace
}  // namespace slipfront::problem
