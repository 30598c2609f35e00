// SPDX-License-Identifier: BSD-3-Clause
#include "checks.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slipfront::mesh {
namespace {

using Corners = Eigen::Matrix<double, 4, 2>;

Corners corners(const Mesh& mesh, const Cell& cell) {
  Corners at;
  for (int a = 0; a < 4; ++a) at.row(a) << mesh.x_m[cell[a]], mesh.y_m[cell[a]];
  return at;
}

double cross(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Largest eigenvalue of the element's M^-1 K for unit modulus and density.
double largest_eigenvalue(const Corners& at) {
  constexpr double nu = 0.37;
  Eigen::Matrix3d elasticity;
  elasticity << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
  elasticity /= 1 - nu * nu;
  const Eigen::RowVector4d xi_node(-1, 1, 1, -1);
  const Eigen::RowVector4d eta_node(-1, -1, 1, 1);
  Eigen::Matrix<double, 8, 8> stiffness = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> mass = Eigen::Matrix<double, 8, 1>::Zero();
  for (const double xi : {-std::sqrt(1.0 / 3), std::sqrt(1.0 / 3)})
    for (const double eta : {-std::sqrt(1.0 / 3), std::sqrt(1.0 / 3)}) {
      const Eigen::RowVector4d along = Eigen::RowVector4d::Ones() + xi * xi_node;
      const Eigen::RowVector4d across = Eigen::RowVector4d::Ones() + eta * eta_node;
      Eigen::Matrix<double, 2, 4> local;
      local << 0.25 * xi_node.cwiseProduct(across), 0.25 * eta_node.cwiseProduct(along);
      const Eigen::Matrix2d jacobian = local * at;
      const double det = jacobian.determinant();
      const Eigen::Matrix<double, 2, 4> gradient = jacobian.inverse() * local;
      Eigen::Matrix<double, 3, 8> strain = Eigen::Matrix<double, 3, 8>::Zero();
      for (int a = 0; a < 4; ++a) {
        strain(0, 2 * a) = strain(2, 2 * a + 1) = gradient(0, a);
        strain(1, 2 * a + 1) = strain(2, 2 * a) = gradient(1, a);
        const double share = 0.25 * along[a] * across[a] * det;
        mass[2 * a] += share;
        mass[2 * a + 1] += share;
      }
      stiffness += det * strain.transpose() * elasticity * strain;
    }
  const auto scale = mass.cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd scaled = scale * stiffness * scale;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

}  // namespace

double area_m2(const Mesh& mesh) {
  double area = 0;
  for (const Cell& cell : mesh.cells) {
    const Corners at = corners(mesh, cell);
    area += 0.5 * cross(at.row(2) - at.row(0), at.row(3) - at.row(1));
  }
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
  for (const Cell& cell : mesh.cells) {
    const Corners at = corners(mesh, cell);
    for (int a = 0; a < 4; ++a)
      least_jacobian_m2 = std::min(least_jacobian_m2,
                                   cross(at.row((a + 1) % 4) - at.row(a), at.row((a + 3) % 4) - at.row(a)));
  }
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
  Corners square;
  square << 0, 0, h, 0, h, h, 0, h;
  double largest = 0;
  for (const Cell& cell : mesh.cells) {
    Corners at = corners(mesh, cell);
    at.rowwise() -= Eigen::RowVector2d(at.row(0));
    if ((at - square).cwiseAbs().maxCoeff() > 1e-9 * h)  // the many regular cells need no eigenvalues
      largest = std::max(largest, largest_eigenvalue(at));
  }
  return std::sqrt(largest_eigenvalue(square) / std::max(largest, largest_eigenvalue(square)));
}

}  // namespace slipfront::mesh
