// SPDX-License-Identifier: BSD-3-Clause
#include "stability/compliance.hpp"

#include <algorithm>

namespace slipfront::stability {
namespace {

/// The plain quotient: moduli here are far from where squares overflow, for which the operator looks out.
Complex quotient(Complex a, Complex b) {
  return a * std::conj(b) / std::norm(b);
}

/// @param stiffness  G over that of the unit
Compliance half_space(const Waves& w, double stiffness) {
  // (1 - a_d a_s)/P^2, written so that nothing cancels at small P, and from it (P^2 + 2 - 2 a_d a_s)/P^2 and
  // Rayleigh's function over P^2.
  const Complex d = -quotient(1 + 1 / w.eta2 + w.P2 / w.eta2, 1.0 + w.a_d * w.a_s);
  const Complex coupling = 1.0 + 2.0 * d;
  const Complex rayleigh = w.P2 + 4.0 + 4.0 * d;
  return {-w.damped * w.a_s, -i_unit * w.damped * coupling, w.damped * w.a_d, d / stiffness,
          w.damped * w.damped * rayleigh * stiffness};
}

/// Seen upside down, as it is above its edge, the body below is under -t and p; u_y, too, has the other sign.
Compliance pair(const Compliance& a, const Compliance& b) {
  const auto sum = [&](Complex of_a, Complex of_b) { return of_a * b.denominator + of_b * a.denominator; };
  return {sum(a.xx, b.xx), sum(a.xy, -b.xy), sum(a.yy, b.yy),
          sum(a.determinant, b.determinant) + a.xx * b.yy + b.xx * a.yy + 2.0 * a.xy * b.xy,
          a.denominator * b.denominator};
}

}  // namespace

bool are_alike(const Bodies& bodies) {
  if (!bodies.below) return false;
  const auto is_near = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::abs(a); };
  const auto& [above, below] = std::pair(bodies.above, *bodies.below);
  return is_near(above.youngs_modulus_Pa, below.youngs_modulus_Pa) &&
         is_near(above.poissons_ratio, below.poissons_ratio) &&
         is_near(above.density_kg_per_m3, below.density_kg_per_m3);
}

Waves::Waves(const solid::Material& material, double wavenumber_per_m, Complex s_per_s)
    : eta2(solid::longitudinal_modulus_Pa(material) / solid::shear_modulus_Pa(material)),
      damped(1.0 + material.stiffness_damping_s * s_per_s) {
  const Complex p = s_per_s / (wavenumber_per_m * solid::shear_speed_m_per_s(material));
  P2 = quotient(p * p, damped);
  a_d = std::sqrt(1.0 + P2 / eta2);
  a_s = std::sqrt(1.0 + P2);
}

Compliance compliance(const Bodies& bodies, double wavenumber_per_m, Complex s_per_s) {
  const auto above = half_space(Waves(bodies.above, wavenumber_per_m, s_per_s), 1);
  if (!bodies.below) return above;
  const double stiffness = solid::shear_modulus_Pa(*bodies.below) / solid::shear_modulus_Pa(bodies.above);
  return pair(above, half_space(Waves(*bodies.below, wavenumber_per_m, s_per_s), stiffness));
}

std::optional<double> generalised_rayleigh_speed_m_per_s(const solid::Material& above,
                                                         const solid::Material& below) {
  Bodies bodies(above, below);
  bodies.above.stiffness_damping_s = bodies.below->stiffness_damping_s = 0;
  const auto yields = [&](double c) { return compliance(bodies, 1, {0, -c}).yy.real(); };
  // Positive up to the lower Rayleigh speed, then falling, up to the lower shear speed, where waves leave the
  // edge, or the higher Rayleigh speed, where it is negative.
  double low = std::min(solid::rayleigh_speed_m_per_s(above), solid::rayleigh_speed_m_per_s(below));
  double high = std::min(solid::shear_speed_m_per_s(above), solid::shear_speed_m_per_s(below));
  if (yields(high) >= 0) return std::nullopt;
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (yields(middle) > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace slipfront::stability
