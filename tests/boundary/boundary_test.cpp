// SPDX-License-Identifier: BSD-3-Clause
#include "boundary/boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "mesh/plate.hpp"

namespace slipfront::boundary {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

mesh::Mesh graded_plate() {
  return mesh::make_plate(
      {.width_m = 0.04, .height_m = 0.02, .element_size_m = 1e-3, .coarsenings = 1, .fine_height_m = 6e-3});
}

TEST(Boundary, IsPrescribedAtTheFarEdgeUnderARigidMachine) {
  const auto mesh = graded_plate();
  const auto all = make_boundary(mesh, {});
  EXPECT_EQ(all.driven, mesh.far_edge_nodes);
  EXPECT_TRUE(all.nodes.empty());
}

TEST(Boundary, SharesTheStiffnessOfItsMachineAmongTheNodes) {
  const auto mesh = graded_plate();
  for (const Pusher& pusher : {Pusher{}, Pusher{2e-3, 0.02}, Pusher{2e-3, 9e-3}}) {
    const auto all = make_boundary(mesh, {3e9, 5e9, pusher, 40});
    EXPECT_TRUE(all.driven.empty());
    double x_N_per_m = 0, y_N_per_m = 0, machine_kg = 0;
    std::vector<mesh::Node> along_x, along_y;
    for (const auto& a : all.nodes) {
      x_N_per_m += a.spring_x_N_per_m.value_or(0);
      y_N_per_m += a.spring_y_N_per_m.value_or(0);
      machine_kg += a.machine_kg;
      if (a.spring_x_N_per_m) along_x.push_back(a.node);
      if (a.spring_y_N_per_m) along_y.push_back(a.node);
    }
    const double length_m = pusher.is_there() ? pusher.to_m - pusher.from_m : 0.04;
    EXPECT_NEAR(x_N_per_m, 3e9 * length_m, 3e9 * length_m * 100 * eps);
    EXPECT_NEAR(y_N_per_m, 5e9 * 0.04, 5e9 * 0.04 * 100 * eps);
    EXPECT_NEAR(machine_kg, 40 * length_m, 40 * length_m * 100 * eps);
    EXPECT_EQ(along_x, pusher.is_there() ? all.pushed : mesh.far_edge_nodes);
    EXPECT_EQ(along_y, mesh.far_edge_nodes);
    std::ranges::sort(along_x);
    EXPECT_EQ(std::ranges::adjacent_find(along_x), along_x.end());
  }
}

TEST(Boundary, HasTheNodesUnderThePusherUpwards) {
  const auto mesh = graded_plate();
  const auto pushed = pushed_nodes(mesh, {2e-3, 9e-3});
  ASSERT_GT(pushed.size(), 5U);
  for (std::size_t k = 0; k < pushed.size(); ++k) {
    EXPECT_EQ(mesh.x_m[pushed[k]], 0);
    EXPECT_GT(mesh.y_m[pushed[k]], k == 0 ? 2e-3 - eps : mesh.y_m[pushed[k - 1]]);
  }
  EXPECT_LT(mesh.y_m[pushed.back()], 9e-3 + eps);
}

}  // namespace
}  // namespace slipfront::boundary
