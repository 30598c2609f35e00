// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/plate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/error.hpp"
#include "checks.hpp"
#include "support/plate.hpp"

namespace slipfront::mesh {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Plate small_plate(Corner corner) {
  return test::plate_of(0.04, 0.02, 0.02 / 30, corner);
}

std::string error_of(const Plate& plate) {
  try {
    make_plate(plate);
  } catch (const UserError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Plate, NumbersNodesAndCellsRowByRow) {
  const Mesh mesh = make_plate(test::plate_of(3, 2, 1));
  EXPECT_EQ(mesh.grid.columns, 3);
  EXPECT_EQ(mesh.grid.rows, 2);
  EXPECT_EQ(mesh.grid.spacing_m, 1);
  EXPECT_THAT(mesh.x_m, ElementsAre(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3));
  EXPECT_THAT(mesh.y_m, ElementsAre(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2));
  EXPECT_THAT(mesh.cells, ElementsAre(Cell{0, 1, 5, 4}, Cell{1, 2, 6, 5}, Cell{2, 3, 7, 6}, Cell{4, 5, 9, 8},
                                      Cell{5, 6, 10, 9}, Cell{6, 7, 11, 10}));
  EXPECT_THAT(mesh.interface_nodes, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(mesh.far_edge_nodes, ElementsAre(8, 9, 10, 11));
  EXPECT_THAT(tributary_lengths_m(mesh), ElementsAre(0.5, 1, 1, 0.5));
}

TEST(Plate, CellsAreCongruentToRounding) {
  const Mesh mesh = make_plate(small_plate(Corner::none));
  const double h = mesh.grid.spacing_m;
  double worst = 0;
  for (const Cell& cell : mesh.cells) {
    worst = std::max(worst, std::abs(mesh.x_m[cell[1]] - mesh.x_m[cell[0]] - h));
    worst = std::max(worst, std::abs(mesh.y_m[cell[3]] - mesh.y_m[cell[0]] - h));
  }
  EXPECT_LE(worst, 2 * eps * 0.04);  // two coordinates, each of a rounded product and a rounded quotient
  EXPECT_EQ(mesh.x_m[mesh.grid.columns], 0.04);
  EXPECT_EQ(mesh.y_m[mesh.far_edge_nodes.front()], 0.02);
}

TEST(Plate, TakesAnElementSizeThatFitsToOneInAMillion) {
  const Mesh mesh = make_plate(test::plate_of(0.2, 0.1, 0.0013333333));
  EXPECT_EQ(mesh.grid.columns, 150);
  EXPECT_EQ(mesh.grid.rows, 75);
  EXPECT_EQ(mesh.grid.spacing_m, 0.2 / 150);
}

TEST(Plate, ReliefIsACircleTangentToTheBase) {
  const Plate plate = small_plate(Corner::relief);
  const Mesh mesh = make_plate(plate);
  const double length = 5e-3, height = 0.5e-3;
  const double radius = (length * length + height * height) / (2 * height);
  EXPECT_DOUBLE_EQ(radius, 25.25e-3);
  int n_on_arc = 0;
  for (const Node n : mesh.interface_nodes) {
    const double d = length - std::min(mesh.x_m[n], plate.width_m - mesh.x_m[n]);
    if (d > 0) {
      // The centre is right above the tangent point.
      EXPECT_NEAR(std::hypot(d, radius - mesh.y_m[n]), radius, 1e-15);
      EXPECT_GT(mesh.y_m[n], 0);
      ++n_on_arc;
    } else {
      EXPECT_EQ(mesh.y_m[n], 0);
    }
  }
  EXPECT_EQ(n_on_arc, 2 * 8);  // columns 0 to 7 of 0.667 mm
  EXPECT_NEAR(mesh.y_m[0], height, 1e-18);
  EXPECT_NEAR(mesh.y_m[mesh.grid.columns], height, 1e-18);
}

TEST(Plate, ReliefFadesOutWithHeight) {
  Plate plate = small_plate(Corner::relief);
  plate.element_size_m = 1e-3;
  const Mesh mesh = make_plate(plate);
  // Edge column: 0.5 mm times 1 - y/10 mm.
  EXPECT_NEAR(mesh.y_m[mesh.grid.node(0, 1)], 1e-3 + 0.45e-3, 1e-17);
  EXPECT_NEAR(mesh.y_m[mesh.grid.node(40, 6)], 6e-3 + 0.2e-3, 1e-17);
  plate.corner = Corner::none;
  const Mesh regular = make_plate(plate);
  EXPECT_EQ(mesh.x_m, regular.x_m);
  for (Node n = 0; n < mesh.n_nodes(); ++n) {
    const double inside = std::min(mesh.x_m[n], 0.04 - mesh.x_m[n]);
    if (inside > 5.0001e-3 || regular.y_m[n] >= 10e-3) {
      EXPECT_EQ(mesh.y_m[n], regular.y_m[n]);
    }
  }
}

/// See fillet_test for the third one.
class WellFormed : public ::testing::TestWithParam<Corner> {};
INSTANTIATE_TEST_SUITE_P(Corners, WellFormed, ::testing::Values(Corner::none, Corner::relief));

TEST_P(WellFormed, OneConformingSymmetricPiece) {
  const Mesh mesh = make_plate(small_plate(GetParam()));
  expect_one_piece(mesh);
  expect_mirror_symmetry(mesh);
  EXPECT_EQ(mesh.x_m[mesh.interface_nodes.front()], 0);
  EXPECT_DOUBLE_EQ(mesh.x_m[mesh.interface_nodes.back()], 0.04);
}

TEST(Plate, OrphansAreNodesWithoutCells) {
  Mesh mesh = make_plate(small_plate(Corner::none));
  std::vector<bool> orphan = orphans(mesh);
  EXPECT_EQ(std::count(orphan.begin(), orphan.end(), true), 0);
  mesh.cells.erase(mesh.cells.begin());  // only the corner node belonged to it alone
  orphan = orphans(mesh);
  EXPECT_TRUE(orphan[0]);
  EXPECT_EQ(std::count(orphan.begin(), orphan.end(), true), 1);
}

TEST(Plate, FreeTopIsNeitherLoadedNorAbsorbs) {
  auto plate = small_plate(Corner::none);
  plate.top = Top::free;
  EXPECT_TRUE(make_plate(plate).far_edge_nodes.empty());
  EXPECT_TRUE(make_plate(plate).absorbing_nodes.empty());
  // The upper ends of absorbing sides move and so absorb, too.
  plate.sides = Sides::absorbing;
  double side_m = 0;
  for (const auto& a : make_plate(plate).absorbing_nodes) {
    side_m += a.side_m;
    EXPECT_EQ(a.top_m, 0);
  }
  EXPECT_NEAR(side_m, 2 * plate.height_m, 100 * eps);
}

TEST(Plate, AbsorbsAlongItsWholeTop) {
  for (const Sides sides : {Sides::free, Sides::periodic}) {
    auto plate = small_plate(Corner::none);
    plate.top = Top::absorbing;
    plate.sides = sides;
    double top_m = 0;
    for (const auto& a : make_plate(plate).absorbing_nodes) top_m += a.top_m;
    EXPECT_NEAR(top_m, plate.width_m, 100 * eps);
  }
}

TEST(MinSide, OfAHandMadeCell) {
  Mesh mesh;  // its upper side is the shortest
  mesh.x_m = {0, 2, 1, 0};
  mesh.y_m = {0, 0, 1.5, 1.25};
  mesh.cells = {{0, 1, 2, 3}};
  EXPECT_NEAR(min_side_m(mesh), std::hypot(1, 0.25), 1e-15);
}

TEST(PlateErrors, NameTheKeyAndSayWhatToDo) {
  struct Case {
    double Plate::*member;
    double value;
    std::string key, text;
  };
  const std::string positive = " must be a positive length";
  for (const auto& [member, value, key, text] : std::initializer_list<Case>{
           // 200 mm/286 and 200 mm/284: the plate is twice as wide as high, so its columns are even.
           {&Plate::element_size_m, 0.0007, "plate.element_size_m", "0.0006993007"},
           {&Plate::element_size_m, 0.0007, "plate.element_size_m", "0.00070422535"},
           {&Plate::element_size_m, 0.15, "plate.element_size_m", "nearest that fit are 0.1"},
           {&Plate::element_size_m, 1e-7, "plate.element_size_m", "larger"},
           {&Plate::element_size_m, -1, "plate.element_size_m" + positive, ""},
           {&Plate::width_m, std::numeric_limits<double>::quiet_NaN(), "plate.width_m" + positive, ""},
           // No common measure with the height.
           {&Plate::width_m, 0.1 * std::numbers::pi, "plate.element_size_m", "nearest that fit"},
           {&Plate::height_m, 0, "plate.height_m" + positive, ""},
           {&Plate::relief_length_m, 0, "plate.relief_length_m" + positive, ""},
           {&Plate::relief_length_m, 0.5e-3, "plate.relief_length_m", "shorter than an element"},
           {&Plate::relief_length_m, 0.1, "plate.relief_length_m", "flat base"},
           {&Plate::relief_height_m, -1e-3, "plate.relief_height_m" + positive, ""},
           {&Plate::relief_height_m, 3e-3, "plate.relief_height_m", "too steep"},
           {&Plate::relief_depth_m, 0.11, "plate.relief_depth_m", "does not fit"},
           {&Plate::relief_depth_m, 0.9e-3, "plate.relief_depth_m", "at least twice"}}) {
    auto plate = test::plate_of(0.2, 0.1, 2e-3 / 3, Corner::relief);
    plate.*member = value;
    EXPECT_THAT(error_of(plate), AllOf(HasSubstr(key), HasSubstr(text)));
  }
  Plate plate;
  plate.relief_depth_m = 0.9e-3;
  plate.corner = Corner::none;  // the relief's keys do not matter then
  EXPECT_EQ(error_of(plate), "no error");
}

TEST(PlateErrors, FilletHasToFit) {
  const auto error = [](double element_size_m, double radius_m) {
    auto plate = test::plate_of(0.2, 0.1, element_size_m, Corner::fillet);
    plate.fillet_radius_m = radius_m;
    return error_of(plate);
  };
  EXPECT_THAT(error(2e-3, 1.4e-3), AllOf(HasSubstr("plate.fillet_radius_m"), HasSubstr("at least 0.0015")));
  // 100 mm less three elements.
  EXPECT_THAT(error(2e-3, 0.095), AllOf(HasSubstr("plate.fillet_radius_m"), HasSubstr("at most 0.094")));
  EXPECT_EQ(error(2e-3, 0.094), "no error");
  EXPECT_THAT(error(2e-3, -1), HasSubstr("plate.fillet_radius_m must be a positive length"));
  EXPECT_THAT(error(0.05, 5e-3), AllOf(HasSubstr("plate.element_size_m"), HasSubstr("too large")));
}

}  // namespace
}  // namespace slipfront::mesh
