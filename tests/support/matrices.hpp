// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <vector>

#include "solid/element.hpp"
#include "support/plate.hpp"

namespace slipfront::test {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// K over all nodes, loaded edge included, x and y of each node in turn.
/// @param stiffness  of a cell, by its coordinates: entry (a, b) at 8 a + b
template <class Stiffness>
Sparse assembled(const mesh::Mesh& mesh, Stiffness&& stiffness, const std::vector<bool>& of_cells = {}) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!of_cells.empty() && !of_cells[c]) continue;
    const auto& cell = mesh.cells[c];
    const auto K = stiffness(solid::cell_coordinates(mesh, cell));
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        entries.emplace_back(2 * cell[a / 2] + a % 2, 2 * cell[b / 2] + b % 2, K.data()[8 * a + b]);
  }
  Sparse K(2 * mesh.n_nodes(), 2 * mesh.n_nodes());
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

inline Sparse assembled_stiffness(const mesh::Mesh& mesh, const solid::Material& material,
                                  const std::vector<bool>& of_cells = {}) {
  return assembled(
      mesh, [&](const solid::CellCoordinates& c) { return solid::cell_stiffness(c, material); }, of_cells);
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

}  // namespace slipfront::test
