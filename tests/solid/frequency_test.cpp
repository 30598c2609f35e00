// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "reference.hpp"
#include "solid/element.hpp"

namespace slipfront::solid {
namespace {

using mesh::Corner;
using test::tiny_plate;

/// Largest eigenfrequency of K u = omega^2 M u with the loaded edge held, from all eigenvalues.
double dense_largest_frequency(const mesh::Mesh& mesh, const Material& m) {
  const auto mass = lumped_mass(mesh, m);
  std::vector<Eigen::Index> free;
  std::vector<bool> held(mesh.n_nodes(), false);
  for (const auto n : mesh.far_edge_nodes) held[n] = true;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (!held[n] && mass[n] > 0) free.insert(free.end(), {2 * n, 2 * n + 1});
  const Eigen::MatrixXd K = reference::assembled_stiffness(mesh, m);
  Eigen::MatrixXd A = K(free, free);
  for (Eigen::Index r = 0; r < A.rows(); ++r)
    for (Eigen::Index c = 0; c < A.cols(); ++c) A(r, c) /= std::sqrt(mass[free[r] / 2] * mass[free[c] / 2]);
  return std::sqrt(
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues()(A.rows() - 1));
}

TEST(LargestFrequency, BoundsTheExactOneFromAboveClosely) {
  for (const auto& [corner, plane] :
       {std::pair(Corner::relief, Plane::stress), std::pair(Corner::fillet, Plane::strain)}) {
    SCOPED_TRACE(reference::name_of(corner));
    const Material m{.plane = plane};
    const auto mesh = tiny_plate(corner);
    const double exact = dense_largest_frequency(mesh, m);
    const double estimate = largest_frequency_rad_per_s(make_operator(mesh, m));
    // The residual tolerance of 1e-3 holds for the square of the frequency.
    EXPECT_GE(estimate, exact * (1 - 1e-12));
    EXPECT_LE(estimate, exact * (1 + 0.5e-3));
  }
}

TEST(FrequencyBound, LiesCloselyAboveTheFrequency) {
  for (const auto corner : {Corner::relief, Corner::fillet})
    for (const double element_m : {2e-3, 0.5e-3}) {
      SCOPED_TRACE(reference::name_of(corner));
      const Material m;
      const auto mesh = test::make_plate(0.1, 0.05, element_m, corner);
      const double above =
          frequency_bound_rad_per_s(mesh, m) / largest_frequency_rad_per_s(make_operator(mesh, m)) - 1;
      // Lanczos iterations give too much by up to 0.5e-3.
      EXPECT_GE(above, -0.6e-3);
      // What the parts' free boundaries add, and the iterations' tolerance again.
      EXPECT_LE(above, 2e-3);
    }
}

TEST(LargestFrequency, OfARegularMeshIsThatOfOneCell) {
  // A square of 2 x 2 Gauss points with lumped mass: 2 c_L / h, to half a per cent.
  const Material m;
  const auto mesh = reference::small_plate(Corner::none);
  const double omega = largest_frequency_rad_per_s(make_operator(mesh, m));
  EXPECT_NEAR(omega / (2 * longitudinal_speed_m_per_s(m) / 1e-3), 1, 5e-3);
}

/// Spectral radius of one step of u'' + beta omega^2 u' + omega^2 u = 0 with the damping on the last
/// half-step velocity: v += -dt omega^2 (u + beta v); u += dt v.
double amplification(double omega, double beta, double dt) {
  const double kick = dt * omega * omega;
  Eigen::Matrix2d step;  // (u, v)
  step << 1 - dt * kick, dt * (1 - kick * beta), -kick, 1 - kick * beta;
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(LargestCellFrequency, TellsCellsApartByEachCorner) {
  const Material m;
  constexpr CellCoordinates unit_square = {0, 0, 1, 0, 1, 1, 0, 1};
  for (int corner = 0; corner < 4; ++corner) {
    auto other = unit_square;
    for (int i = 2 * corner; i < 2 * corner + 2; ++i) other[i] += 0.3 - 0.6 * unit_square[i];  // inwards
    mesh::Mesh mesh;
    for (const auto& cell : {unit_square, other})
      for (int a = 0; a < 4; ++a) {
        mesh.x_m.push_back(cell[2 * a]);
        mesh.y_m.push_back(cell[2 * a + 1]);
      }
    mesh.cells = {{0, 1, 2, 3}, {4, 5, 6, 7}};
    const double of_other = cell_frequency_rad_per_s(other, m);
    ASSERT_GT(of_other, cell_frequency_rad_per_s(unit_square, m));
    EXPECT_NEAR(largest_cell_frequency_rad_per_s(mesh, m, {true, true}) / of_other, 1, 1e-12) << corner;
  }
}

TEST(StableStep, IsWhereTheAmplificationPassesOne) {
  const double omega = 3e6;
  EXPECT_DOUBLE_EQ(stable_step_s(omega, 0), 2 / omega);
  for (const double xi : {0.0, 0.01, 0.3, 1.0, 5.0}) {
    const double beta = 2 * xi / omega, dt = stable_step_s(omega, beta);
    EXPECT_NEAR(dt / (2 / omega * (std::sqrt(1 + xi * xi) - xi)), 1, 1e-13);
    EXPECT_LE(amplification(omega, beta, dt * (1 - 1e-6)), 1 + 1e-12) << xi;  // undamped: 1 to rounding
    EXPECT_GT(amplification(omega, beta, dt * (1 + 1e-6)), 1 + 1e-8) << xi;
  }
}

}  // namespace
}  // namespace slipfront::solid
