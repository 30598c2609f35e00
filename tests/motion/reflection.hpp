// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

#include "solid/material.hpp"

namespace slipfront::motion::test {

enum class PlaneWave { longitudinal, shear };

/// Amplitudes of displacement of the reflected waves over that of the incident one.
struct Reflection {
  std::complex<double> longitudinal, shear;
};

/// Plane wave on an edge with the dashpots of Lysmer and Kuhlemeyer (1969), in closed form; the derivation is
/// in docs/prestress.md. `sine` is that of the angle of incidence, from the normal.
Reflection theory(PlaneWave incident, double sine, double c_L_over_c_S);

/// The same measured on the plate: a packet of the given wavelength is sent to the absorbing top of a plate
/// with periodic sides, whose width makes the angle, and what has come back is split into plane waves.
struct Measurement {
  double sine = 0;                     ///< of the angle of incidence
  double longitudinal = 0, shear = 0;  ///< magnitudes
};

/// @param columns     of elements in one horizontal wavelength; 0 for normal incidence
/// @param wavelength  in elements
Measurement measure(PlaneWave incident, int columns, double wavelength, const solid::Material& material);

}  // namespace slipfront::motion::test
