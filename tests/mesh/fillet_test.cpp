// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/fillet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "checks.hpp"
#include "support/plate.hpp"

namespace slipfront::mesh {
namespace {

constexpr double pi = std::numbers::pi;

/// Radius in mm; elements along the plate's height of 40 mm.
class Fillet : public ::testing::TestWithParam<std::tuple<int, int>> {
 protected:
  const double radius_m = std::get<0>(GetParam()) * 1e-3;
  const Mesh mesh = make_plate(plate(Corner::fillet));
  const double h = mesh.grid.spacing_m;

  Plate plate(Corner corner) const {
    auto p = test::plate_of(0.08, 0.04, 0.04 / std::get<1>(GetParam()), corner);
    p.fillet_radius_m = radius_m;
    return p;
  }
  /// Chords of one quarter circle, from the lower nodes left of its end.
  int n_chords() const {
    return static_cast<int>(std::count_if(mesh.interface_nodes.begin(), mesh.interface_nodes.end(),
                                          [&](Node n) { return mesh.x_m[n] <= radius_m * (1 + 1e-9); })) -
           1;
  }
};

TEST_P(Fillet, IsOneConformingSymmetricPiece) {
  expect_one_piece(mesh);
  expect_mirror_symmetry(mesh);
  EXPECT_GE(relative_stable_step(mesh), 0.6);  // near the regular mesh's
}

TEST_P(Fillet, LowerSideIsBaseAndArcs) {
  const auto& lower = mesh.interface_nodes;
  const int n = n_chords();
  EXPECT_EQ(n % 2, 0);
  const std::size_t last = lower.size() - 1;
  const double tolerance = 1e-12 * radius_m;
  for (int a = 0; a <= n; ++a) {  // equal angles from the vertical edge to the base
    const double angle = pi / 2 * a / n;
    EXPECT_NEAR(mesh.x_m[lower[a]], radius_m * (1 - std::cos(angle)), tolerance);
    EXPECT_NEAR(mesh.y_m[lower[a]], radius_m * (1 - std::sin(angle)), tolerance);
    EXPECT_NEAR(mesh.x_m[lower[last - a]], 0.08 - radius_m * (1 - std::cos(angle)), tolerance);
    EXPECT_NEAR(mesh.y_m[lower[last - a]], radius_m * (1 - std::sin(angle)), tolerance);
  }
  // The ends are the tangent points, exactly.
  EXPECT_EQ(mesh.x_m[lower[0]], 0);
  EXPECT_EQ(mesh.y_m[lower[0]], radius_m);
  EXPECT_EQ(mesh.x_m[lower[n]], radius_m);
  for (std::size_t i = n; i <= last - n; ++i) EXPECT_EQ(mesh.y_m[lower[i]], 0);
}

TEST_P(Fillet, AreaAndLengthAreThoseOfThePolygon) {
  const int n = n_chords();
  const double angle = pi / 2 / n;
  // The chords' inside: a quarter of the square around the circle becomes n triangles.
  const double corner = radius_m * radius_m * (1 - 0.5 * n * std::sin(angle));
  const double area = 0.08 * 0.04 - 2 * corner;
  EXPECT_NEAR(area_m2(mesh), area, static_cast<double>(mesh.cells.size()) * eps * area);

  const double length = 0.08 - 2 * radius_m + 2 * n * 2 * radius_m * std::sin(angle / 2);
  const std::vector<double> tributary = tributary_lengths_m(mesh);
  ASSERT_EQ(tributary.size(), mesh.interface_nodes.size());
  EXPECT_NEAR(std::accumulate(tributary.begin(), tributary.end(), 0.0), length,
              static_cast<double>(tributary.size()) * eps * length);
  EXPECT_NEAR(tributary.front(), radius_m * std::sin(angle / 2), 1e-12 * radius_m);
}

TEST_P(Fillet, FoldsTheCornersAndLeavesTheRestAlone) {
  const Mesh regular = make_plate(plate(Corner::none));
  const long cut = std::max(1L, std::lround((2 - pi / 2) / 2 * radius_m / h));
  EXPECT_EQ(mesh.cells.size(), regular.cells.size() - static_cast<std::size_t>(2 * cut * cut));
  const std::vector<bool> orphan = orphans(mesh);
  EXPECT_EQ(std::count(orphan.begin(), orphan.end(), true), 2 * cut * (cut + 1));

  std::vector<bool> on_boundary(mesh.x_m.size(), false);
  for (const Node n : boundary_loop(mesh)) on_boundary[n] = true;
  const std::vector<int> valence = valences(mesh);
  int n_three = 0;
  const double reach = 1.25 * radius_m + 5 * h;  // of the re-shaped patches
  double moved_afar = 0;
  for (Node n = 0; n < mesh.n_nodes(); ++n) {
    if (orphan[n]) {  // in the middle of an arc
      EXPECT_NEAR(mesh.y_m[n], radius_m * (1 - std::numbers::sqrt2 / 2), 1e-15);
    } else if (!on_boundary[n] && valence[n] != 4) {
      ASSERT_EQ(valence[n], 3);
      ++n_three;
    }
    const double x = regular.x_m[n], y = regular.y_m[n];
    if (y > reach || (x > reach && x < 0.08 - reach))
      moved_afar = std::max({moved_afar, std::abs(mesh.x_m[n] - x), std::abs(mesh.y_m[n] - y)});
  }
  EXPECT_EQ(n_three, 2);
  EXPECT_EQ(moved_afar, 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Fillet,
                         ::testing::Combine(::testing::Values(2, 10), ::testing::Values(20, 30, 120)));

TEST(FilletLimits, RadiiBetweenWorkToo) {
  // From the smallest radius allowed to 20 elements, in steps that meet every change of the fold's numbers.
  auto plate = test::plate_of(0.1, 0.05, 1e-3, Corner::fillet);
  for (double radius = 0.75; radius < 20; radius *= 1.04) {
    plate.fillet_radius_m = radius * 1e-3;
    EXPECT_GE(relative_stable_step(make_plate(plate)), 0.6) << "radius " << radius << " elements";
  }
}

TEST(FilletLimits, LargestRadiusIsGood) {
  auto plate = test::plate_of(0.06, 0.05, 1e-3, Corner::fillet);
  plate.fillet_radius_m = 27e-3;  // three elements of base and of edge are left at each corner
  const Mesh mesh = make_plate(plate);
  EXPECT_GE(relative_stable_step(mesh), 0.6);
  EXPECT_FALSE(boundary_loop(mesh).empty());
}

}  // namespace
}  // namespace slipfront::mesh
