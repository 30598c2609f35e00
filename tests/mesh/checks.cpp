// SPDX-License-Identifier: BSD-3-Clause
#include "checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solid/element.hpp"

namespace slipfront::mesh {
namespace {

/// Of a to b with c to d.
double cross(const Mesh& mesh, Node a, Node b, Node c, Node d) {
  return (mesh.x_m[b] - mesh.x_m[a]) * (mesh.y_m[d] - mesh.y_m[c]) -
         (mesh.y_m[b] - mesh.y_m[a]) * (mesh.x_m[d] - mesh.x_m[c]);
}

}  // namespace

double area_m2(const Mesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c, d] : mesh.cells) area += 0.5 * cross(mesh, a, c, b, d);
  return area;
}

std::vector<Node> boundary_loop(const Mesh& mesh) {
  std::vector<std::pair<Node, Node>> edges;
  for (const Cell& cell : mesh.cells)
    for (int a = 0; a < 4; ++a) edges.emplace_back(cell[a], cell[(a + 1) % 4]);
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) {
    ADD_FAILURE() << "two cells run through an edge in the same direction";
    return {};
  }
  std::vector<Node> next(mesh.x_m.size(), -1);
  std::size_t n_boundary = 0;
  for (const auto& [from, to] : edges) {
    if (std::binary_search(edges.begin(), edges.end(), std::pair(to, from))) continue;
    if (next[from] != -1) {
      ADD_FAILURE() << "the boundary touches itself at node " << from;
      return {};
    }
    next[from] = to;
    ++n_boundary;
  }
  std::vector<Node> loop;
  Node n = mesh.interface_nodes.front();
  do {
    loop.push_back(n);
    n = next[n];
  } while (n != -1 && n != loop.front() && loop.size() <= n_boundary);
  if (n != loop.front() || loop.size() != n_boundary) {
    ADD_FAILURE() << "the boundary is not one closed loop";
    return {};
  }
  return loop;
}

std::vector<int> valences(const Mesh& mesh) {
  std::vector<int> count(mesh.x_m.size(), 0);
  for (const Cell& cell : mesh.cells)
    for (const Node n : cell) ++count[n];
  return count;
}

void expect_mirror_symmetry(const Mesh& mesh) {
  const Grid& grid = mesh.grid;
  const double width = mesh.x_m[mesh.far_edge_nodes.back()];
  const auto twin = [&](Node n) { return grid.node(grid.columns - n % grid.stride(), n / grid.stride()); };
  double largest_x = 0, largest_y = 0;
  for (Node n = 0; n < mesh.n_nodes(); ++n) {
    largest_x = std::max(largest_x, std::abs(mesh.x_m[n] + mesh.x_m[twin(n)] - width));
    largest_y = std::max(largest_y, std::abs(mesh.y_m[n] - mesh.y_m[twin(n)]));
  }
  EXPECT_LE(largest_x, 2 * std::numeric_limits<double>::epsilon() * width);
  EXPECT_EQ(largest_y, 0);

  std::vector<Cell> cells, twins;
  for (Cell cell : mesh.cells) {
    std::sort(cell.begin(), cell.end());
    cells.push_back(cell);
    for (Node& n : cell) n = twin(n);
    std::sort(cell.begin(), cell.end());
    twins.push_back(cell);
  }
  std::sort(cells.begin(), cells.end());
  std::sort(twins.begin(), twins.end());
  EXPECT_TRUE(cells == twins);
}

void expect_one_piece(const Mesh& mesh) {
  double least_jacobian_m2 = std::numeric_limits<double>::infinity();  // positive for convex cells
  for (const Cell& cell : mesh.cells)
    for (int a = 0; a < 4; ++a)
      least_jacobian_m2 =
          std::min(least_jacobian_m2, cross(mesh, cell[a], cell[(a + 1) % 4], cell[a], cell[(a + 3) % 4]));
  EXPECT_GT(least_jacobian_m2, 0);

  const std::vector<bool> orphan = orphans(mesh);
  std::vector<std::pair<double, double>> places;
  for (Node n = 0; n < mesh.n_nodes(); ++n)
    if (!orphan[n]) places.emplace_back(mesh.x_m[n], mesh.y_m[n]);
  std::sort(places.begin(), places.end());
  EXPECT_TRUE(std::adjacent_find(places.begin(), places.end()) == places.end());

  const auto &interface = mesh.interface_nodes, &far = mesh.far_edge_nodes;
  for (std::size_t i = 1; i < interface.size(); ++i)
    EXPECT_LT(mesh.x_m[interface[i - 1]], mesh.x_m[interface[i]]);
  // A hanging node is seen here: its edges would be a boundary.
  const std::vector<Node> loop = boundary_loop(mesh);
  ASSERT_GE(loop.size(), interface.size());
  EXPECT_TRUE(std::equal(interface.begin(), interface.end(), loop.begin()));
  EXPECT_NE(std::search(loop.begin(), loop.end(), far.rbegin(), far.rend()), loop.end());
}

double relative_stable_step(const Mesh& mesh) {
  const double h = mesh.grid.spacing_m;
  const double of_square = solid::cell_frequency_rad_per_s({0, 0, h, 0, h, h, 0, h}, {});
  const std::vector<bool> all(mesh.cells.size(), true);
  return of_square / std::max(of_square, solid::largest_cell_frequency_rad_per_s(mesh, {}, all));
}

}  // namespace slipfront::mesh
