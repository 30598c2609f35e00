// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/plate.hpp"
#include "solid/element.hpp"
#include "solid/operator.hpp"

namespace slipfront::test {

inline mesh::Mesh make_plate(double width_m, double height_m, double element_m, mesh::Corner corner) {
  mesh::Plate plate;
  plate.width_m = width_m;
  plate.height_m = height_m;
  plate.element_size_m = element_m;
  plate.corner = corner;
  return mesh::make_plate(plate);
}

/// 21 x 11 nodes, small enough for dense matrices.
inline mesh::Mesh tiny_plate(mesh::Corner corner) {
  mesh::Plate plate;
  plate.width_m = 0.02;
  plate.height_m = 0.01;
  plate.element_size_m = 1e-3;
  plate.corner = corner;
  plate.fillet_radius_m = 3e-3;
  return mesh::make_plate(plate);
}

inline std::string name_of(mesh::Corner corner) {
  return corner == mesh::Corner::none ? "none" : corner == mesh::Corner::relief ? "relief" : "fillet";
}

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// K over all nodes, loaded edge included, x and y of each node in turn.
inline Sparse assembled_stiffness(const mesh::Mesh& mesh, const solid::Material& material,
                                  const std::vector<bool>& of_cells = {}) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!of_cells.empty() && !of_cells[c]) continue;
    const auto& cell = mesh.cells[c];
    const auto K = solid::cell_stiffness(solid::cell_coordinates(mesh, cell), material);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        entries.emplace_back(2 * cell[a / 2] + a % 2, 2 * cell[b / 2] + b % 2, K[8 * a + b]);
  }
  Sparse K(2 * mesh.n_nodes(), 2 * mesh.n_nodes());
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

inline Eigen::VectorXd flat(const solid::Field& u) {
  Eigen::VectorXd v(2 * u.size());
  for (std::size_t n = 0; n < u.size(); ++n) v(2 * n) = u.x[n], v(2 * n + 1) = u.y[n];
  return v;
}

inline double max_abs(const Eigen::MatrixXd& m) {
  double largest = 0;
  for (const double value : m.reshaped()) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Reproducible numbers in [-1, 1).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) / 4503599627370496.0 - 1;
  }

 private:
  std::uint64_t state_;
};

}  // namespace slipfront::test
