// SPDX-License-Identifier: BSD-3-Clause
#include "solid/element.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace slipfront::solid {

namespace {

constexpr double gauss = 0.57735026918962576;  // 1/sqrt(3)
constexpr std::array<std::array<double, 2>, 4> gauss_points = {
    {{-gauss, -gauss}, {gauss, -gauss}, {gauss, gauss}, {-gauss, gauss}}};
constexpr std::array<double, 4> xi_of_node = {-1, 1, 1, -1};
constexpr std::array<double, 4> eta_of_node = {-1, -1, 1, 1};

}  // namespace

bool is_square(const CellCoordinates& c, double h) {
  const CellCoordinates square = {0, 0, h, 0, h, h, 0, h};
  for (int k = 0; k < 8; ++k)
    if (std::abs(c[k] - c[k % 2] - square[k]) > square_tolerance * std::abs(h)) return false;
  return true;
}

bool is_square_of_grid(const mesh::Mesh& mesh, const mesh::Grid& grid, const mesh::Cell& cell) {
  const int stride = grid.stride();
  const mesh::Node corner = cell[0];
  return cell[1] == corner + 1 && cell[2] == corner + stride + 1 && cell[3] == corner + stride &&
         is_square(cell_coordinates(mesh, cell), grid.spacing_m);
}

CellShape cell_shape(const CellCoordinates& c, double xi, double eta) {
  CellShape s;
  std::array<double, 4> d_dxi{}, d_deta{};
  double x_xi = 0, x_eta = 0, y_xi = 0, y_eta = 0;
  for (int a = 0; a < 4; ++a) {
    s.value[a] = 0.25 * (1 + xi_of_node[a] * xi) * (1 + eta_of_node[a] * eta);
    d_dxi[a] = 0.25 * xi_of_node[a] * (1 + eta_of_node[a] * eta);
    d_deta[a] = 0.25 * eta_of_node[a] * (1 + xi_of_node[a] * xi);
    x_xi += d_dxi[a] * c[2 * a];
    x_eta += d_deta[a] * c[2 * a];
    y_xi += d_dxi[a] * c[2 * a + 1];
    y_eta += d_deta[a] * c[2 * a + 1];
  }
  s.jacobian = x_xi * y_eta - x_eta * y_xi;
  SLIPFRONT_ASSERT(s.jacobian > 0, "cell is not convex and counterclockwise");
  for (int a = 0; a < 4; ++a) {
    s.d_dx[a] = (y_eta * d_dxi[a] - y_xi * d_deta[a]) / s.jacobian;
    s.d_dy[a] = (x_xi * d_deta[a] - x_eta * d_dxi[a]) / s.jacobian;
  }
  return s;
}

std::optional<CellShape> cell_shape_at(const CellCoordinates& c, double x_m, double y_m) {
  constexpr int max_iterations = 30;
  constexpr double converged = 1e-14, tolerance = 1e-9, far = 2;
  double xi = 0, eta = 0;
  for (int k = 0; k < max_iterations; ++k) {
    std::array<double, 4> value{}, d_dxi{}, d_deta{};
    double x = -x_m, y = -y_m, x_xi = 0, x_eta = 0, y_xi = 0, y_eta = 0;
    for (int a = 0; a < 4; ++a) {
      value[a] = 0.25 * (1 + xi_of_node[a] * xi) * (1 + eta_of_node[a] * eta);
      d_dxi[a] = 0.25 * xi_of_node[a] * (1 + eta_of_node[a] * eta);
      d_deta[a] = 0.25 * eta_of_node[a] * (1 + xi_of_node[a] * xi);
      x += value[a] * c[2 * a], y += value[a] * c[2 * a + 1];
      x_xi += d_dxi[a] * c[2 * a], y_xi += d_dxi[a] * c[2 * a + 1];
      x_eta += d_deta[a] * c[2 * a], y_eta += d_deta[a] * c[2 * a + 1];
    }
    const double jacobian = x_xi * y_eta - x_eta * y_xi;
    if (!(jacobian > 0)) return std::nullopt;
    const double by_xi = (y_eta * x - x_eta * y) / jacobian, by_eta = (x_xi * y - y_xi * x) / jacobian;
    xi = std::clamp(xi - by_xi, -far, far);
    eta = std::clamp(eta - by_eta, -far, far);
    if (std::max(std::abs(by_xi), std::abs(by_eta)) < converged) break;
  }
  if (std::max(std::abs(xi), std::abs(eta)) > 1 + tolerance) return std::nullopt;
  return cell_shape(c, xi, eta);
}

PlaneTensor strain(const CellShape& shape, const std::array<double, 8>& u_m, const Material& material) {
  PlaneTensor e;
  for (int a = 0; a < 4; ++a) {
    e.xx += shape.d_dx[a] * u_m[2 * a];
    e.yy += shape.d_dy[a] * u_m[2 * a + 1];
    e.xy += 0.5 * (shape.d_dy[a] * u_m[2 * a] + shape.d_dx[a] * u_m[2 * a + 1]);
  }
  const double nu = material.poissons_ratio;
  if (material.plane == Plane::stress) e.zz = -nu / (1 - nu) * (e.xx + e.yy);
  return e;
}

PlaneTensor stress_Pa(const PlaneTensor& e, const Material& material) {
  const auto D = elasticity_Pa(material);
  PlaneTensor s{D[0] * e.xx + D[1] * e.yy, D[3] * e.xx + D[4] * e.yy, 0, 2 * D[8] * e.xy};
  if (material.plane == Plane::strain) s.zz = material.poissons_ratio * (s.xx + s.yy);
  return s;
}

PlaneTensor strain_of(const PlaneTensor& s, const Material& material) {
  const double P = longitudinal_modulus_Pa(material), G = shear_modulus_Pa(material);
  const double E = 4 * G * (P - G);  // times P: the uniaxial modulus of the plane
  PlaneTensor e{(P * s.xx - (P - 2 * G) * s.yy) / E, (P * s.yy - (P - 2 * G) * s.xx) / E, 0, s.xy / (2 * G)};
  if (material.plane == Plane::stress)
    e.zz = -material.poissons_ratio / material.youngs_modulus_Pa * (s.xx + s.yy);
  return e;
}

StrainAndStress strain_and_stress(const CellShape& shape, const std::array<double, 8>& u_m,
                                  const Material& material, const std::optional<UniformStress>& further,
                                  double time_s) {
  PlaneTensor e = strain(shape, u_m, material);
  PlaneTensor s = stress_Pa(e, material);
  if (!further) return {e, s};
  PlaneTensor of_all{0, further->yy_Pa + time_s * further->yy_Pa_per_s, 0,
                     further->xy_Pa + time_s * further->xy_Pa_per_s};
  if (material.plane == Plane::strain) of_all.zz = material.poissons_ratio * of_all.yy;
  const PlaneTensor strained = strain_of(of_all, material);
  for (const auto component : {&PlaneTensor::xx, &PlaneTensor::yy, &PlaneTensor::zz, &PlaneTensor::xy}) {
    e.*component += strained.*component;
    s.*component += of_all.*component;
  }
  return {e, s};
}

CellCoordinates cell_coordinates(const mesh::Mesh& mesh, const mesh::Cell& cell) {
  CellCoordinates c{};
  for (int a = 0; a < 4; ++a) {
    c[2 * a] = mesh.x_m[cell[0]] + mesh::distance_x_m(mesh, cell[0], cell[a]);
    c[2 * a + 1] = mesh.y_m[cell[a]];
  }
  return c;
}

CellStiffness cell_stiffness(const CellCoordinates& coordinates, const Material& material) {
  const auto D = elasticity_Pa(material);
  const double P = D[0], coupling = D[1], G = D[8];
  CellStiffness K{};
  for (const auto& [xi, eta] : gauss_points) {
    const CellShape s = cell_shape(coordinates, xi, eta);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const double xx = s.d_dx[a] * s.d_dx[b], xy = s.d_dx[a] * s.d_dy[b];
        const double yx = s.d_dy[a] * s.d_dx[b], yy = s.d_dy[a] * s.d_dy[b];
        K[(2 * a) * 8 + 2 * b] += (P * xx + G * yy) * s.jacobian;
        K[(2 * a) * 8 + 2 * b + 1] += (coupling * xy + G * yx) * s.jacobian;
        K[(2 * a + 1) * 8 + 2 * b] += (coupling * yx + G * xy) * s.jacobian;
        K[(2 * a + 1) * 8 + 2 * b + 1] += (P * yy + G * xx) * s.jacobian;
      }
    }
  }
  return K;
}

std::array<double, 4> cell_mass(const CellCoordinates& coordinates, const Material& material) {
  std::array<double, 4> m{};
  for (const auto& [xi, eta] : gauss_points) {
    const CellShape s = cell_shape(coordinates, xi, eta);
    for (int a = 0; a < 4; ++a) m[a] += material.density_kg_per_m3 * s.value[a] * s.jacobian;
  }
  return m;
}

double cell_frequency_rad_per_s(const CellCoordinates& coordinates, const Material& material) {
  const auto K = cell_stiffness(coordinates, material);
  const auto m = cell_mass(coordinates, material);
  Eigen::MatrixXd A(8, 8);
  for (int r = 0; r < 8; ++r)
    for (int c = 0; c < 8; ++c) A(r, c) = K[8 * r + c] / std::sqrt(m[r / 2] * m[c / 2]);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A, Eigen::EigenvaluesOnly);
  return std::sqrt(solver.eigenvalues()(7));
}

double largest_cell_frequency_rad_per_s(const mesh::Mesh& mesh, const Material& material,
                                        const std::vector<bool>& in_part) {
  // Most cells are congruent with one of the few before them.
  std::array<CellCoordinates, 8> known{};
  std::size_t n_known = 0;
  double largest = 0;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    if (!in_part[k]) continue;
    auto c = cell_coordinates(mesh, mesh.cells[k]);
    for (int i = 7; i >= 0; --i) c[i] -= c[i % 2];
    const double tolerance = 1e-9 * (std::abs(c[4]) + std::abs(c[5]));
    const auto is_congruent = [&](const CellCoordinates& other) {
      for (int i = 2; i < 8; ++i)
        if (std::abs(c[i] - other[i]) > tolerance) return false;
      return true;
    };
    const auto end = known.begin() + static_cast<std::ptrdiff_t>(std::min(n_known, known.size()));
    if (std::find_if(known.begin(), end, is_congruent) != end) continue;
    known[n_known++ % known.size()] = c;
    largest = std::max(largest, cell_frequency_rad_per_s(c, material));
  }
  return largest;
}

std::vector<double> lumped_mass(const mesh::Mesh& mesh, const Material& material) {
  std::vector<double> mass(mesh.n_nodes(), 0.0);
  for (const auto& cell : mesh.cells) {
    const auto m = cell_mass(cell_coordinates(mesh, cell), material);
    for (int a = 0; a < 4; ++a) mass[cell[a]] += m[a];
  }
  return mass;
}

}  // namespace slipfront::solid
