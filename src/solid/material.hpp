// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace slipfront::solid {

enum class Plane { stress, strain };

/// Isotropic linear elasticity of a body of unit thickness, with damping proportional to the stiffness.
struct Material {
  double youngs_modulus_Pa = 2.6e9;
  double poissons_ratio = 0.37;
  double density_kg_per_m3 = 1200;
  Plane plane = Plane::stress;
  double stiffness_damping_s = 0.05e-6;  ///< beta_R: the internal force is K (u + beta_R v)
};

double shear_modulus_Pa(const Material& material);
/// Stiffness of uniaxial strain within the plane: rho c_L^2.
double longitudinal_modulus_Pa(const Material& material);
/// Stiffness of uniaxial stress within the plane: E in plane stress, E/(1 - nu^2) in plane strain.
double uniaxial_modulus_Pa(const Material& material);
double longitudinal_speed_m_per_s(const Material& material);  ///< c_L in the plane chosen
double shear_speed_m_per_s(const Material& material);         ///< c_S
/// Velocity per traction of a shear wave: c_S/G, one over the impedance rho c_S.
double shear_admittance_m_per_Pa_s(const Material& material);
double rayleigh_speed_m_per_s(const Material& material);  ///< c_R, root of the Rayleigh function

/// Wave speeds in the plane chosen, m/s.
struct WaveSpeeds {
  double c_L = 0, c_S = 0, c_R = 0;
};
WaveSpeeds wave_speeds(const Material& material);

/// Plane elasticity matrix for (e_xx, e_yy, 2 e_xy), row-major, Pa.
std::array<double, 9> elasticity_Pa(const Material& material);

}  // namespace slipfront::solid
