// SPDX-License-Identifier: BSD-3-Clause
#include "layer_by_elements.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numbers>

namespace slipfront::stability {

using std::complex;

std::vector<complex<double>> layer_eigenvalues_by_elements(const solid::Material& material,
                                                           const Sliding& sliding, double k, double height_m,
                                                           int n) {
  const double P = solid::longitudinal_modulus_Pa(material);
  const double G = solid::shear_modulus_Pa(material);
  const double lambda = P - 2 * G;
  const double h = height_m / n;
  const complex<double> ik{0, k};
  // Degrees of freedom: u_x, u_y of nodes 0 to n; the top and u_y at the interface are dropped afterwards.
  Eigen::MatrixXcd K = Eigen::MatrixXcd::Zero(2 * (n + 1), 2 * (n + 1));
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(2 * (n + 1));
  const double a[2][2] = {{h / 3, h / 6}, {h / 6, h / 3}};    // integral of N_i N_j
  const double b[2][2] = {{-0.5, 0.5}, {-0.5, 0.5}};          // of N_i N_j'
  const double c[2][2] = {{1 / h, -1 / h}, {-1 / h, 1 / h}};  // of N_i' N_j'
  for (int e = 0; e < n; ++e)
    for (int i = 0; i < 2; ++i) {
      mass(2 * (e + i)) += material.density_kg_per_m3 * h / 2;
      mass(2 * (e + i) + 1) += material.density_kg_per_m3 * h / 2;
      for (int j = 0; j < 2; ++j) {
        K(2 * (e + i), 2 * (e + j)) += P * k * k * a[i][j] + G * c[i][j];
        K(2 * (e + i) + 1, 2 * (e + j) + 1) += P * c[i][j] + G * k * k * a[i][j];
        K(2 * (e + i), 2 * (e + j) + 1) += ik * (G * b[j][i] - lambda * b[i][j]);
        K(2 * (e + i) + 1, 2 * (e + j)) += ik * (lambda * b[j][i] - G * b[i][j]);
      }
    }
  std::vector<int> kept = {0};
  for (int d = 2; d < 2 * n; ++d) kept.push_back(d);
  const int m = static_cast<int>(kept.size());
  const bool strength = sliding.relaxed == interface::Relaxed::strength;
  const bool pressure = sliding.relaxed == interface::Relaxed::pressure;
  const int size = 2 * m + (strength || pressure ? 1 : 0);
  // x = (u, v/R, z), s x = A x; z is the delayed strength or pressure over G k.
  const double R = solid::shear_speed_m_per_s(material) / height_m;
  const double beta = material.stiffness_damping_s;
  const double r = sliding.relaxation_rate_per_s;
  const double direct = sliding.pressure_Pa;
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(size, size);
  Eigen::RowVectorXcd friction = Eigen::RowVectorXcd::Zero(size);  // strength at once, in terms of x
  Eigen::RowVectorXcd reaction = Eigen::RowVectorXcd::Zero(size);  // pressure, in terms of x
  for (int i = 0; i < m; ++i) {
    A(i, m + i) = R;
    for (int j = 0; j < m; ++j) {
      A(m + i, j) = -K(kept[i], kept[j]) / (mass(kept[i]) * R);
      A(m + i, m + j) = -beta * K(kept[i], kept[j]) / mass(kept[i]);
    }
    reaction(i) = K(1, kept[i]);
    reaction(m + i) = beta * R * K(1, kept[i]);
  }
  const double scale = G * k;
  if (!pressure) friction = sliding.mu * reaction;
  friction(0) += direct * sliding.slip_slope_per_m;
  friction(m) += direct * sliding.slope_s_per_m * R;
  if (pressure) {
    A.row(size - 1) = r * reaction / scale;
    A(size - 1, size - 1) -= r;
    friction(size - 1) = sliding.mu * scale;
  }
  if (strength) {
    A.row(size - 1) = r * friction / scale;
    A(size - 1, size - 1) -= r;
    friction.setZero();
    friction(size - 1) = scale;
  }
  A.row(m) -= friction / (mass(0) * R);
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(A, false);
  std::vector<complex<double>> s(solver.eigenvalues().begin(), solver.eigenvalues().end());
  std::ranges::sort(s, [](auto x, auto y) { return x.real() > y.real(); });
  return s;
}

double smallest_stiffness(int n) {
  const double e = 1.0 / n;  // half an element
  Eigen::MatrixXd stiffness(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double d = 2 * e * (i - j);
      stiffness(i, j) = (1 / (d + e) - 1 / (d - e)) / (2 * std::numbers::pi);
    }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues()(0);
}

}  // namespace slipfront::stability
