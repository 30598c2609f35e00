// SPDX-License-Identifier: BSD-3-Clause
#include "solid/material.hpp"

#include <cmath>

namespace slipfront::solid {

double shear_modulus_Pa(const Material& m) {
  return m.youngs_modulus_Pa / (2 * (1 + m.poissons_ratio));
}

double longitudinal_modulus_Pa(const Material& m) {
  const double nu = m.poissons_ratio;
  return m.plane == Plane::stress ? m.youngs_modulus_Pa / (1 - nu * nu)
                                  : m.youngs_modulus_Pa * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
}

double uniaxial_modulus_Pa(const Material& m) {
  const double P = longitudinal_modulus_Pa(m);
  const double G = shear_modulus_Pa(m);
  return 4 * G * (P - G) / P;
}

double longitudinal_speed_m_per_s(const Material& m) {
  return std::sqrt(longitudinal_modulus_Pa(m) / m.density_kg_per_m3);
}

double shear_speed_m_per_s(const Material& m) {
  return std::sqrt(shear_modulus_Pa(m) / m.density_kg_per_m3);
}

double shear_admittance_m_per_Pa_s(const Material& m) {
  return shear_speed_m_per_s(m) / shear_modulus_Pa(m);
}

double rayleigh_speed_m_per_s(const Material& m) {
  const double c_L = longitudinal_speed_m_per_s(m);
  const double c_S = shear_speed_m_per_s(m);
  // (2 - c^2/c_S^2)^2 - 4 sqrt(1 - c^2/c_L^2) sqrt(1 - c^2/c_S^2) is negative below c_R, positive above.
  const auto rayleigh = [&](double c) {
    const double s = c * c / (c_S * c_S);
    return (2 - s) * (2 - s) - 4 * std::sqrt(1 - c * c / (c_L * c_L)) * std::sqrt(1 - s);
  };
  double low = 0.1 * c_S;
  double high = c_S;
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (rayleigh(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

WaveSpeeds wave_speeds(const Material& m) {
  return {longitudinal_speed_m_per_s(m), shear_speed_m_per_s(m), rayleigh_speed_m_per_s(m)};
}

std::array<double, 9> elasticity_Pa(const Material& m) {
  const double P = longitudinal_modulus_Pa(m);
  const double G = shear_modulus_Pa(m);
  const double coupling = P - 2 * G;
  return {P, coupling, 0, coupling, P, 0, 0, 0, G};
}

}  // namespace slipfront::solid
