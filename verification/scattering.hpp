// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>

#include "solid/material.hpp"

/// Plane waves at the bond between two half-spaces, each described with y pointing away from it, as in
/// motion::Body: the one below is upside down. verification/bonded_waves.md.
namespace slipfront::verification {

using Complex = std::complex<double>;

enum class Kind { longitudinal, shear };
inline constexpr std::array kinds = {Kind::longitudinal, Kind::shear};

double speed_m_per_s(const solid::Material& material, Kind kind);

/// k_y of a wave exp(i (k_x x + k_y y - omega t)) that leaves the bond; imaginary where it clings to it.
Complex leaving_k_y(const solid::Material& material, Kind kind, double k_x, double omega_rad_per_s);

/// Amplitudes over that of the incident wave, each with the polarisation (k_x, k_y) c/omega or (-k_y, k_x)
/// c/omega: [body, above first][kind].
using Scattered = std::array<std::array<Complex, 2>, 2>;
inline Complex of(const Scattered& a, int body, Kind kind) {
  return a[body][static_cast<std::size_t>(kind)];
}
inline Complex& of(Scattered& a, int body, Kind kind) {
  return a[body][static_cast<std::size_t>(kind)];
}

/// Of a wave in the body above that goes towards the bond.
Scattered scattered(const std::array<solid::Material, 2>& bodies, Kind incident, double k_x,
                    double omega_rad_per_s);

/// A line along x in a body that gives way per traction on it, m/Pa.
struct Compliance {
  double y_m = 0, along_m_per_Pa = 0, across_m_per_Pa = 0;
};

/// What one such line in each body adds to the amplitudes of the waves that leave, to first order.
Scattered change_by(const std::array<Compliance, 2>& lines, const std::array<solid::Material, 2>& bodies,
                    Kind incident, double k_x, double omega_rad_per_s);

}  // namespace slipfront::verification
