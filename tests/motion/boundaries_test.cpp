// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "motion/stepper.hpp"
#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

using mesh::Sides;
using mesh::Top;

mesh::Mesh plate(double width_m, double height_m, Sides sides, Top top) {
  auto plate = support::plate_of(width_m, height_m, 1e-3);
  plate.sides = sides;
  plate.top = top;
  return mesh::make_plate(plate);
}

/// Whether shear, and sub-steps.
class Absorption : public ::testing::TestWithParam<std::tuple<bool, int>> {
 protected:
  bool shear_ = std::get<0>(GetParam());
  TimeStepping time_{.interface_substeps = std::get<1>(GetParam())};

  /// Sends a Gaussian pulse of uniform motion, 15 mm before the edge, along x or y; returns what is left of
  /// it over its amplitude among `nodes` when its reflection would be back where it started.
  double reflected(const mesh::Mesh& mesh, bool along_x, const std::vector<mesh::Node>& nodes,
                   double edge_m) const {
    constexpr double distance = 15e-3, lift = 1e-4, amplitude = 1e-6;
    const solid::Material material{.stiffness_damping_s = 0};
    const double c =
        shear_ ? solid::shear_speed_m_per_s(material) : solid::longitudinal_speed_m_per_s(material);
    Stepper stepper(mesh, material, support::paper_law, time_);
    solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
    const auto orphan = mesh::orphans(mesh);
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
      if (orphan[n]) continue;
      const auto at = [&](double time_s) {
        const double place_m = (along_x ? mesh.x_m : mesh.y_m)[n];
        return amplitude * std::exp(-0.5 * std::pow((place_m - edge_m + distance - c * time_s) / 4e-3, 2));
      };
      u.y[n] = lift;
      (along_x != shear_ ? u.x : u.y)[n] += at(0);
      // The velocity belongs to half a step earlier.
      (along_x != shear_ ? v.x : v.y)[n] = (at(0) - at(-stepper.step_s())) / stepper.step_s();
    }
    support::UnderWay pulse(std::move(stepper), support::in_flight(mesh, u, v), 1);
    pulse.advance_to(2 * distance / c);
    const auto& left = pulse.stepper.u_m();
    double largest = 0;
    for (const auto n : nodes)
      largest = std::max(largest, std::abs(along_x != shear_ ? left.x[n] : left.y[n] - lift));
    return largest / amplitude;
  }
};
INSTANTIATE_TEST_SUITE_P(Waves, Absorption, ::testing::Combine(::testing::Bool(), ::testing::Values(1, 5)));

// At normal incidence the dashpots match the impedance of a wave of infinite length; the element's dispersion
// leaves a reflection of order (k h)^2, here with k h about 1/4.
constexpr double little = 0.01;

TEST_P(Absorption, OfTheTopInAPeriodicPlate) {
  // Four columns: the whole plate is one column of waves.
  const auto mesh = plate(4e-3, 0.06, Sides::periodic, Top::absorbing);
  std::vector<mesh::Node> column;
  for (int j = 20; j <= 60; ++j) column.push_back(mesh.grid.node(2, j));
  EXPECT_LT(reflected(mesh, false, column, 0.06), little);
}

TEST_P(Absorption, OfTheSides) {
  // The plate is so high that nothing from its lower and upper edge is in the middle yet.
  const auto mesh = plate(0.06, 0.12, Sides::absorbing, Top::absorbing);
  std::vector<mesh::Node> row;
  for (int i = 20; i <= 60; ++i) row.push_back(mesh.grid.node(i, 60));
  EXPECT_LT(reflected(mesh, true, row, 0.06), little);
}

TEST(Periodic, PlateHasNoSeam) {
  // A random motion and the same one moved on by three columns stay the same motion.
  const auto mesh = plate(0.02, 0.01, Sides::periodic, Top::loaded);
  const auto& grid = mesh.grid;
  const auto moved = [&](mesh::Node n) {
    return grid.node((n % grid.stride() + 3) % grid.columns, n / grid.stride());
  };
  const auto orphan = mesh::orphans(mesh);
  solid::Field v(mesh.n_nodes()), v_moved(mesh.n_nodes());
  Random random(3);
  for (mesh::Node n = 0; n < mesh.far_edge_nodes.front(); ++n) {
    if (orphan[n]) continue;
    v_moved.x[moved(n)] = v.x[n] = random();
    v_moved.y[moved(n)] = v.y[n] = random();
  }
  const auto run = [&](const solid::Field& start) {
    support::UnderWay way({mesh, {}, support::gentle_law, {.interface_substeps = 5}},
                          support::in_flight(mesh, solid::Field(mesh.n_nodes()), start), 1);
    way.advance(100);
    return way.stepper.u_m();
  };
  const auto u = run(v), u_moved = run(v_moved);
  double largest = 0, difference = 0;
  for (mesh::Node n = 0; n < mesh.far_edge_nodes.front(); ++n) {
    if (orphan[n]) continue;
    const auto m = moved(n);
    largest = std::max(largest, std::abs(u.x[n]));
    difference = std::max({difference, std::abs(u.x[n] - u_moved.x[m]), std::abs(u.y[n] - u_moved.y[m])});
  }
  EXPECT_GT(largest, 1e-7);
  // Shared stencils at one place, own ones at the other: rounding, which the law does not amplify.
  EXPECT_LT(difference, 1e-9 * largest);
}

}  // namespace
}  // namespace slipfront::motion
