// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "mesh/plate.hpp"
#include "mesh/reorder.hpp"
#include "solid/element.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"
#include "support/matrices.hpp"

// The finite elements written a second time, with B matrices and any number of Gauss points, slow and plain.
namespace slipfront::solid::reference {

using test::flat;
using test::max_abs;
using test::name_of;

inline Eigen::Matrix3d elasticity(const Material& m) {
  // The inverse of the compliance, so that nothing is shared with the code under test.
  const double nu = m.poissons_ratio;
  Eigen::Matrix3d compliance;
  if (m.plane == Plane::stress) {
    compliance << 1, -nu, 0, -nu, 1, 0, 0, 0, 2 * (1 + nu);
  } else {
    compliance << 1 - nu * nu, -nu * (1 + nu), 0, -nu * (1 + nu), 1 - nu * nu, 0, 0, 0, 2 * (1 + nu);
  }
  return (compliance / m.youngs_modulus_Pa).inverse();
}

/// Points and weights on [-1, 1].
inline std::vector<std::array<double, 2>> gauss_rule(int n) {
  if (n == 2) return {{-std::sqrt(1.0 / 3), 1}, {std::sqrt(1.0 / 3), 1}};
  return {{-std::sqrt(0.6), 5.0 / 9}, {0, 8.0 / 9}, {std::sqrt(0.6), 5.0 / 9}};
}

/// Calls f(N, B, weight x Jacobian) at each Gauss point of the cell.
template <class F>
void at_gauss_points(const CellCoordinates& c, int n, F&& f) {
  Eigen::Matrix<double, 4, 2> X;
  for (int a = 0; a < 4; ++a) X.row(a) << c[2 * a], c[2 * a + 1];
  for (const auto& [xi, w_xi] : gauss_rule(n)) {
    for (const auto& [eta, w_eta] : gauss_rule(n)) {
      Eigen::Vector4d N;
      N << (1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta);
      Eigen::Matrix<double, 4, 2> dN;
      dN << -(1 - eta), -(1 - xi), 1 - eta, -(1 + xi), 1 + eta, 1 + xi, -(1 + eta), 1 - xi;
      N /= 4;
      dN /= 4;
      const Eigen::Matrix2d J = X.transpose() * dN;  // dx/dxi
      const Eigen::Matrix<double, 4, 2> G = dN * J.inverse();
      Eigen::Matrix<double, 3, 8> B = Eigen::Matrix<double, 3, 8>::Zero();
      for (int a = 0; a < 4; ++a) {
        B(0, 2 * a) = B(2, 2 * a + 1) = G(a, 0);
        B(1, 2 * a + 1) = B(2, 2 * a) = G(a, 1);
      }
      f(N, B, w_xi * w_eta * J.determinant());
    }
  }
}

inline Eigen::MatrixXd stiffness(const CellCoordinates& c, const Material& m, int n_gauss) {
  const Eigen::Matrix3d D = elasticity(m);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(8, 8);
  at_gauss_points(c, n_gauss, [&](const Eigen::Vector4d&, const Eigen::Matrix<double, 3, 8>& B, double w) {
    K += w * B.transpose() * D * B;
  });
  return K;
}

inline double area_m2(const CellCoordinates& c) {
  return 0.5 * ((c[4] - c[0]) * (c[7] - c[3]) - (c[6] - c[2]) * (c[5] - c[1]));
}

inline double area_m2(const mesh::Mesh& mesh) {
  double area = 0;
  for (const auto& cell : mesh.cells) area += area_m2(cell_coordinates(mesh, cell));
  return area;
}

/// K over all nodes, loaded edge included, x and y of each node in turn.
inline test::Sparse assembled_stiffness(const mesh::Mesh& mesh, const Material& m) {
  return test::assembled(mesh, [&](const CellCoordinates& c) { return stiffness(c, m, 2); });
}

/// A plate of 40 mm x 20 mm with 1 mm cells.
inline mesh::Mesh small_plate(mesh::Corner corner) {
  return test::make_plate(0.04, 0.02, 1e-3, corner);
}

/// The plates on which the operator is tested: plain ones by their corners, a graded one, one numbered at
/// random, one that also has its inner nodes moved at random, so that no two cells are similar.
enum class Form { none, relief, fillet, graded, shuffled, distorted };

inline Field random_field(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  Field u(n);
  for (std::size_t k = 0; k < n; ++k) u.x[k] = random(), u.y[k] = random();
  return u;
}

inline std::string name_of(Form form) {
  constexpr std::array<const char*, 6> names = {"none",   "relief",   "fillet",
                                                "graded", "shuffled", "distorted"};
  return names[static_cast<std::size_t>(form)];
}

/// Numbers the nodes at random and turns the cells round to begin with any of their nodes.
inline void shuffle(mesh::Mesh& mesh, std::uint64_t seed) {
  Random random(seed);
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(0.5 * (random() + 1) * static_cast<double>(n));
  };
  std::vector<mesh::Node> number(mesh.x_m.size());
  std::iota(number.begin(), number.end(), 0);
  for (std::size_t k = number.size(); k > 1; --k) std::swap(number[k - 1], number[below(k)]);
  mesh::renumber(mesh, number);
  for (std::size_t k = mesh.cells.size(); k > 1; --k) std::swap(mesh.cells[k - 1], mesh.cells[below(k)]);
  for (auto& cell : mesh.cells)
    std::rotate(cell.begin(), cell.begin() + static_cast<std::ptrdiff_t>(below(4)), cell.end());
}

/// Moves the inner nodes of a plain plate by up to `share` of an element along x and y.
inline void distort(mesh::Mesh& mesh, double share, std::uint64_t seed) {
  Random random(seed);
  for (int j = 1; j < mesh.grid.rows; ++j)
    for (int i = 1; i < mesh.grid.columns; ++i) {
      mesh.x_m[mesh.grid.node(i, j)] += share * mesh.grid.spacing_m * random();
      mesh.y_m[mesh.grid.node(i, j)] += share * mesh.grid.spacing_m * random();
    }
}

inline mesh::Mesh small_plate(Form form) {
  if (form <= Form::fillet) return small_plate(static_cast<mesh::Corner>(form));
  if (form == Form::graded) {
    auto plate = test::plate_of(0.04, 0.032, 1e-3, mesh::Corner::relief);
    plate.coarsenings = 2;
    plate.fine_height_m = 5e-3;
    plate.relief_depth_m = 8e-3;  // bends the lower transition
    return mesh::make_plate(plate);
  }
  auto mesh = small_plate(mesh::Corner::none);
  if (form == Form::distorted) distort(mesh, 0.2, 7);
  shuffle(mesh, 8);
  mesh::renumber(mesh, mesh::near_numbers(mesh));
  return mesh;
}

}  // namespace slipfront::solid::reference
