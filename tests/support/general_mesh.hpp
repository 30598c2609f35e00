// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/reorder.hpp"

namespace slipfront::test {

/// For each node, whether it lies on an edge that belongs to one cell only, or belongs to none.
inline std::vector<bool> on_boundary(const mesh::Mesh& mesh) {
  std::map<std::pair<mesh::Node, mesh::Node>, int> cells_of_edge;
  for (const auto& cell : mesh.cells)
    for (std::size_t a = 0; a < 4; ++a) ++cells_of_edge[std::minmax(cell[a], cell[(a + 1) % 4])];
  auto is_on = mesh::orphans(mesh);
  for (const auto& [edge, n_cells] : cells_of_edge)
    if (n_cells == 1) is_on[edge.first] = is_on[edge.second] = true;
  return is_on;
}

/// A mesh that knows no grid: inner nodes moved at random by up to `moved_m` along x and y, all numbered at
/// random.
inline mesh::Mesh without_grid(mesh::Mesh mesh, double moved_m) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> shift_m(-moved_m, moved_m);
  const auto is_fixed = on_boundary(mesh);
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    if (is_fixed[n]) continue;
    mesh.x_m[n] += shift_m(random);
    mesh.y_m[n] += shift_m(random);
  }
  std::vector<mesh::Node> number(mesh.x_m.size());
  std::iota(number.begin(), number.end(), 0);
  std::ranges::shuffle(number, random);
  mesh::renumber(mesh, number);
  return mesh;
}

}  // namespace slipfront::test
