// SPDX-License-Identifier: BSD-3-Clause
#include "pair_by_eigenvectors.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>

namespace slipfront::stability {
namespace {

/// (u_x, u_y) of an edge y = 0 per (sigma_xy, sigma_yy) there, in a body y > 0 or y < 0.
Eigen::MatrixXcd displacement_per_stress(const solid::Material& material, double k, Complex s, bool above) {
  const Complex damped = 1.0 + material.stiffness_damping_s * s;
  const Complex M = damped * solid::longitudinal_modulus_Pa(material);
  const Complex G = damped * solid::shear_modulus_Pa(material);
  const Complex lambda = M - 2.0 * G, inertia = material.density_kg_per_m3 * s * s;
  const Complex ik{0, k};
  // Stresses in units of kG, lengths of 1/k.
  const Complex unit = k * G;
  Eigen::MatrixXcd d_dy(4, 4);
  d_dy << 0, -ik, unit / G, 0,           //
      -ik * lambda / M, 0, 0, unit / M,  //
      (inertia + k * k * (M - lambda * lambda / M)) / unit, 0, 0, -ik * lambda / M, 0, inertia / unit, -ik, 0;
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(d_dy / k);
  Eigen::MatrixXcd u(2, 2), stress(2, 2);
  int n = 0;
  for (int j = 0; j < 4; ++j) {
    if ((solver.eigenvalues()(j).real() < 0) != above) continue;
    u.col(n) = solver.eigenvectors().col(j).head(2);
    stress.col(n++) = solver.eigenvectors().col(j).tail(2) * unit;
  }
  return u * stress.inverse();
}

}  // namespace

Complex pair_by_eigenvectors(const Bodies& bodies, const Sliding& sliding, double k, Complex p) {
  const Complex s = p * k * solid::shear_speed_m_per_s(bodies.above);
  const Eigen::MatrixXcd relative =
      displacement_per_stress(bodies.above, k, s, true) - displacement_per_stress(*bodies.below, k, s, false);
  const Complex delay = sliding.relaxed == interface::Relaxed::none
                            ? Complex{1}
                            : sliding.relaxation_rate_per_s / (sliding.relaxation_rate_per_s + s);
  const Complex of_slip = sliding.pressure_Pa * (sliding.slope_s_per_m * s + sliding.slip_slope_per_m);
  const bool all_delayed = sliding.relaxed == interface::Relaxed::strength;
  // Conditions on (sigma_xy, sigma_yy), with p = -sigma_yy: nothing opens; the strength is sigma_xy.
  const double unit = k * solid::shear_modulus_Pa(bodies.above);
  Eigen::MatrixXcd conditions(2, 2);
  conditions.row(0) = relative.row(1) * unit;
  conditions.row(1) = -(all_delayed ? delay : Complex{1}) * of_slip * relative.row(0);
  conditions(1, 0) += 1.0;
  conditions(1, 1) += sliding.mu * delay;
  return conditions.determinant();
}

}  // namespace slipfront::stability
