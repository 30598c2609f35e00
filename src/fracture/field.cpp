// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/field.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/numbers.hpp"

namespace slipfront::fracture {

// u_x = phi_x + psi_y, u_y = phi_y - psi_x, phi = Re F(x + i a_d y), psi = Im G(x + i a_s y). In units of the
// shear modulus, with f = F'' and g = G'':
//   stress_xx = (1 - a_s^2 + 2 a_d^2) Re f + 2 a_s Re g
//   stress_yy = -(1 + a_s^2) Re f - 2 a_s Re g
//   stress_xy = -2 a_d Im f - (1 + a_s^2) Im g
// f and g go as -i/sqrt(2 pi z). Equal bodies have stress_yy = 0 at y = 0, so (1 + a_s^2) f + 2 a_s g = 0 as
// functions; the rigid plane has u_y = 0, so a_d f + g = 0. K at the tip gives their size.
TipField::TipField(const Bodies& bodies, double speed_m_per_s, int along_x)
    : material_(bodies.above), has_body_below_(bodies.below.has_value()), along_x_(along_x) {
  constexpr double at_rest = 1e-4;  // of c_S: the field differs by its square, and rounding by as much
  const double c_S = solid::shear_speed_m_per_s(material_),
               c_L = solid::longitudinal_speed_m_per_s(material_);
  const double v = std::max(speed_m_per_s, at_rest * c_S), m2 = v * v / (c_S * c_S);
  a_d_ = std::sqrt(1 - v * v / (c_L * c_L));
  a_s_ = std::sqrt(1 - m2);
  if (!has_body_below_) {
    f_ = 1 / (a_d_ * m2);
    g_ = -a_d_ * f_;
  } else {
    const double rayleigh = 4 * a_d_ * a_s_ - (2 - m2) * (2 - m2);
    f_ = 2 * a_s_ / rayleigh;
    g_ = -(2 - m2) / rayleigh;
  }
  const bool has_field = !has_body_below_ || stability::are_alike(bodies);
  if (!has_field || !(speed_m_per_s < limiting_speed_m_per_s(bodies))) f_ = g_ = nan;
}

PlaneTensor TipField::stress_per_K(double x_m, double y_m) const {
  if (!has_body_below_ && y_m < 0) return {nan, nan, nan, nan};
  const auto singular = [&](double a) {
    return Complex(0, -1) / std::sqrt(2 * std::numbers::pi * Complex(along_x_ * x_m, a * y_m));
  };
  const Complex f = f_ * singular(a_d_), g = g_ * singular(a_s_);
  const double s2 = a_s_ * a_s_;
  PlaneTensor s{along_x_ * ((1 - s2 + 2 * a_d_ * a_d_) * f.real() + 2 * a_s_ * g.real()),
                -along_x_ * ((1 + s2) * f.real() + 2 * a_s_ * g.real()), 0,
                -2 * a_d_ * f.imag() - (1 + s2) * g.imag()};
  if (material_.plane == solid::Plane::strain) s.zz = material_.poissons_ratio * (s.xx + s.yy);
  return s;
}

PlaneTensor TipField::strain_per_K(double x_m, double y_m) const {
  return solid::strain_of(stress_per_K(x_m, y_m), material_);
}

}  // namespace slipfront::fracture
