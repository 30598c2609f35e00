// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/error.hpp"
#include "checks.hpp"
#include "mesh/reorder.hpp"
#include "support/plate.hpp"

namespace slipfront::mesh {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// 40 x 30 columns and rows of 1 mm; coarsened once or twice above 6 mm.
Plate graded(Corner corner, int coarsenings) {
  auto plate = test::plate_of(0.04, 0.03, 1e-3, corner);
  plate.relief_length_m = 4e-3;
  plate.relief_height_m = 0.4e-3;
  plate.relief_depth_m = 9e-3;  // through the first transition
  plate.fillet_radius_m = 2e-3;
  plate.coarsenings = coarsenings;
  plate.fine_height_m = 5.5e-3;
  return plate;
}

class Graded : public ::testing::TestWithParam<std::tuple<Corner, int>> {
 protected:
  Plate plate_ = graded(std::get<0>(GetParam()), std::get<1>(GetParam()));
  Mesh mesh_ = make_plate(plate_);
};

INSTANTIATE_TEST_SUITE_P(Plates, Graded,
                         ::testing::Values(std::tuple(Corner::none, 2), std::tuple(Corner::relief, 2),
                                           std::tuple(Corner::fillet, 1)));

TEST_P(Graded, OneConformingPieceOfTheWholePlate) {
  expect_one_piece(mesh_);
  EXPECT_EQ(mesh_.x_m[mesh_.far_edge_nodes.front()], 0);
  EXPECT_DOUBLE_EQ(mesh_.x_m[mesh_.far_edge_nodes.back()], plate_.width_m);
  for (const Node n : mesh_.far_edge_nodes) EXPECT_DOUBLE_EQ(mesh_.y_m[n], plate_.height_m);
  // The same polygon as without grading.
  auto plain = plate_;
  plain.coarsenings = 0;
  const double area = area_m2(make_plate(plain));
  EXPECT_NEAR(area_m2(mesh_), area, static_cast<double>(mesh_.cells.size()) * eps * area);
}

TEST_P(Graded, BlocksOfDoubledSquares) {
  const auto grids = blocks(mesh_);
  ASSERT_EQ(grids.size(), static_cast<std::size_t>(plate_.coarsenings) + 1);
  EXPECT_EQ(grids[0].rows, 6);  // 5.5 mm in whole elements, and 24 left for larger ones
  double y = 0;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const auto& g = grids[k];
    EXPECT_EQ(g.columns, 40 >> k);
    EXPECT_DOUBLE_EQ(g.spacing_m, std::ldexp(1e-3, static_cast<int>(k)));
    const Node at = g.node(g.columns / 2, 0);
    EXPECT_NEAR(mesh_.y_m[at], y, 1e-16);
    EXPECT_NEAR(mesh_.x_m[at], 0.02, 1e-16);
    y += (g.rows + 2) * g.spacing_m;
  }
  if (grids.size() == 3) {
    EXPECT_GE(grids[1].rows * grids[1].spacing_m, 8e-3);  // as high as what is below it
  }
}

TEST_P(Graded, TheTransitionDoesNotShortenTheStep) {
  if (std::get<0>(GetParam()) == Corner::none) {
    // Its worst cell is the square of the smaller side; rounding of the eigenvalues.
    EXPECT_NEAR(relative_stable_step(mesh_), 1, 1e-12);
  } else {
    EXPECT_GT(relative_stable_step(mesh_), 0.6);  // the least of a fillet, see fillet_test
  }
}

TEST(GradedPlate, ReliefIsMirrored) {
  const auto mesh = make_plate(graded(Corner::relief, 2));
  std::set<std::pair<double, double>> places;
  const auto place = [](double x, double y) { return std::pair(std::round(1e12 * x), std::round(1e12 * y)); };
  for (Node n = 0; n < mesh.n_nodes(); ++n) places.insert(place(mesh.x_m[n], mesh.y_m[n]));
  for (Node n = 0; n < mesh.n_nodes(); ++n)
    EXPECT_TRUE(places.contains(place(0.04 - mesh.x_m[n], mesh.y_m[n]))) << "node " << n;
}

TEST(GradedPlate, EndsWithHalfAUnitWhereColumnsAreNoMultipleOfFour) {
  auto plate = graded(Corner::none, 1);
  plate.width_m = 0.042;
  const auto mesh = make_plate(plate);
  EXPECT_FALSE(boundary_loop(mesh).empty());
  EXPECT_NEAR(area_m2(mesh), 0.042 * 0.03, static_cast<double>(mesh.cells.size()) * eps * 0.042 * 0.03);
  EXPECT_NEAR(relative_stable_step(mesh), 1, 1e-12);
}

TEST(GradedPlate, AbsorbingEdgesAreCoveredOnce) {
  for (const double width_m : {0.04, 0.042}) {
    auto plate = graded(Corner::none, 1);
    plate.width_m = width_m;
    plate.sides = Sides::absorbing;
    plate.top = Top::absorbing;
    double left_m = 0, right_m = 0, top_m = 0;
    const auto mesh = make_plate(plate);
    for (const auto& a : mesh.absorbing_nodes) {
      (mesh.x_m[a.node] == 0 ? left_m : right_m) += a.side_m;
      top_m += a.top_m;
    }
    EXPECT_NEAR(left_m, 0.03, 100 * eps);
    EXPECT_NEAR(right_m, 0.03, 100 * eps);
    EXPECT_NEAR(top_m, width_m, 100 * eps);
  }
}

TEST(GradedPlate, PeriodicSidesJoinEveryBlock) {
  auto plate = graded(Corner::none, 2);
  plate.sides = Sides::periodic;
  const auto mesh = make_plate(plate);
  const auto orphan = orphans(mesh);
  for (const auto& grid : blocks(mesh))
    for (int j = 0; j <= grid.rows; ++j)
      EXPECT_TRUE(orphan[grid.node(grid.columns, j)] && !orphan[grid.node(0, j)]) << j;
  plate.width_m = 0.042;
  EXPECT_THAT([&] { make_plate(plate); },
              ThrowsMessage<UserError>(HasSubstr("multiple of 8 columns of elements, not 42;")));
}

TEST(GradedPlate, SaysWhatDoesNotFit) {
  auto plate = graded(Corner::none, 4);
  EXPECT_THAT([&] { make_plate(plate); }, ThrowsMessage<UserError>(HasSubstr("no room for the largest")));
  plate.height_m = 0.4;
  EXPECT_THAT([&] { make_plate(plate); },
              ThrowsMessage<UserError>(HasSubstr("multiple of 16 columns of elements, not 40;")));
  plate = graded(Corner::fillet, 1);
  plate.fillet_radius_m = 5e-3;
  EXPECT_THAT([&] { make_plate(plate); }, ThrowsMessage<UserError>(HasSubstr("plate.fine_height_m")));
}

TEST(Reorder, KeepsTheMeshAndBringsNeighboursTogether) {
  auto mesh = make_plate(graded(Corner::fillet, 1));
  const double area = area_m2(mesh);
  std::vector<Node> shuffled(mesh.x_m.size());
  std::iota(shuffled.begin(), shuffled.end(), 0);
  for (std::size_t k = shuffled.size(); k > 1; --k)  // a fixed pseudo-random permutation
    std::swap(shuffled[k - 1], shuffled[(k * 2654435761U) % k]);
  renumber(mesh, shuffled);
  const auto reach = [&] {
    Node largest = 0;
    for (const auto& cell : mesh.cells)
      largest = std::max(largest, *std::ranges::max_element(cell) - *std::ranges::min_element(cell));
    return largest;
  };
  const auto loop_places = [&] {
    std::vector<double> x;
    for (const Node n : boundary_loop(mesh)) x.push_back(mesh.x_m[n]);
    return x;
  };
  const auto places = loop_places();
  EXPECT_GT(reach(), mesh.n_nodes() / 2);
  const auto number = near_numbers(mesh);
  auto sorted = number;
  std::ranges::sort(sorted);
  for (std::size_t k = 0; k < sorted.size(); ++k) ASSERT_EQ(sorted[k], static_cast<Node>(k));
  renumber(mesh, number);
  EXPECT_DOUBLE_EQ(area_m2(mesh), area);
  EXPECT_EQ(loop_places(), places);
  // About two levels, each at most a row of the plate long.
  EXPECT_LE(reach(), 3 * 41);
}

}  // namespace
}  // namespace slipfront::mesh
