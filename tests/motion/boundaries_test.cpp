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
    constexpr double distance = 15e-3, lift = 1e-4;
    const solid::Material material{.stiffness_damping_s = 0};
    const double c =
        shear_ ? solid::shear_speed_m_per_s(material) : solid::longitudinal_speed_m_per_s(material);
    Stepper stepper(mesh, material, support::paper_law, time_);
    const support::GaussianPulse pulse{shear_, along_x, edge_m - distance, c, lift};
    const auto e = pulse.on(mesh, stepper.step_s());
    stepper.start(e, 1);
    Recorder recorder(e, 1.3, 0);
    while (c * stepper.time_s() < 2 * distance) stepper.advance(recorder);
    double largest = 0;
    for (const auto n : nodes)
      largest =
          std::max(largest, std::abs(along_x != shear_ ? stepper.u_m().x[n] : stepper.u_m().y[n] - lift));
    return largest / pulse.amplitude_m;
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
    Stepper stepper(mesh, {}, support::gentle_law, {.interface_substeps = 5});
    const auto e = support::in_flight(mesh, solid::Field(mesh.n_nodes()), start);
    stepper.start(e, 1);
    Recorder recorder(e, 1.3, 0);
    for (int step = 0; step < 100; ++step) stepper.advance(recorder);
    return stepper.u_m();
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
