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

TEST(Choices, NoProcessHoldsManySquaresUnderGivenTractions) {
  auto config = test::coarse_case();
  config.loading.method = statics::LoadingMethod::prestress;
  EXPECT_FALSE(root_has_interface_only(config, 4));  // few nodes
  config.plate.element_size_m = 0.1e-3;
  ASSERT_EQ(config.plate.corner, mesh::Corner::relief);
  EXPECT_TRUE(root_has_interface_only(config, 4));
  EXPECT_FALSE(root_has_interface_only(config, 1));
  auto deep = config, fillet = config, graded = config, stretched = config, tilted = config;
  stretched.plate.width_m *= 1 + 2e-9;
  EXPECT_FALSE(root_has_interface_only(stretched, 4));
  stretched.plate.width_m = config.plate.width_m * (1 + 1e-11);
  EXPECT_TRUE(root_has_interface_only(stretched, 4));
  deep.plate.relief_depth_m = deep.plate.height_m;
  EXPECT_FALSE(root_has_interface_only(deep, 4));
  fillet.plate.corner = mesh::Corner::fillet;
  EXPECT_FALSE(root_has_interface_only(fillet, 4));
  graded.plate.coarsenings = 1;
  EXPECT_FALSE(root_has_interface_only(graded, 4));
  tilted.loading.method = statics::LoadingMethod::direct;
  EXPECT_FALSE(root_has_interface_only(tilted, 4));
}

}  // namespace
}  // namespace slipfront::run
