// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/numbers.hpp"

namespace slipfront::mesh {

std::vector<Grid> blocks(const Mesh& mesh) {
  std::vector<Grid> all = {mesh.grid};
  all.insert(all.end(), mesh.coarser.begin(), mesh.coarser.end());
  return all;
}

std::vector<bool> marked(const Mesh& mesh, const std::vector<Node>& nodes) {
  std::vector<bool> is_in(mesh.n_nodes(), false);
  for (const Node n : nodes) is_in[n] = true;
  return is_in;
}

std::vector<bool> orphans(const Mesh& mesh) {
  std::vector<bool> orphan(mesh.x_m.size(), true);
  for (const Cell& cell : mesh.cells)
    for (const Node n : cell) orphan[n] = false;
  return orphan;
}

std::vector<double> interface_x_m(const Mesh& mesh) {
  std::vector<double> x_m;
  for (const auto n : mesh.interface_nodes) x_m.push_back(mesh.x_m[n]);
  return x_m;
}

std::vector<double> tributary_lengths_m(const Mesh& mesh) {
  std::vector<double> length_m(mesh.interface_nodes.size(), 0.0);
  for (std::size_t i = 0; i + 1 < mesh.interface_nodes.size(); ++i) {
    const Node a = mesh.interface_nodes[i];
    const Node b = mesh.interface_nodes[i + 1];
    const double half = 0.5 * std::hypot(mesh.x_m[b] - mesh.x_m[a], mesh.y_m[b] - mesh.y_m[a]);
    length_m[i] += half;
    length_m[i + 1] += half;
  }
  if (mesh.period_m > 0) {
    const double half = 0.5 * (mesh.x_m[mesh.interface_nodes.front()] + mesh.period_m -
                               mesh.x_m[mesh.interface_nodes.back()]);
    length_m.front() += half;
    length_m.back() += half;
  }
  return length_m;
}

double distance_x_m(const Mesh& mesh, Node from, Node to) {
  const double distance = mesh.x_m[to] - mesh.x_m[from];
  if (mesh.period_m == 0 || std::abs(distance) < 0.5 * mesh.period_m) return distance;
  return distance - std::copysign(mesh.period_m, distance);
}

double min_side_m(const Mesh& mesh) {
  SLIPFRONT_ASSERT(!mesh.cells.empty(), "a mesh without cells has no sides");
  double min_square = infinity;
  for (const Cell& cell : mesh.cells)
    for (int corner = 0; corner < 4; ++corner) {
      const Node here = cell[corner], next = cell[(corner + 1) % 4];
      const double x = distance_x_m(mesh, here, next), y = mesh.y_m[next] - mesh.y_m[here];
      min_square = std::min(min_square, x * x + y * y);
    }
  return std::sqrt(min_square);
}

}  // namespace slipfront::mesh
