// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <stdexcept>
#include <vector>

namespace slipfront::stability {

using Complex = std::complex<double>;

/// Zeros that rounding does not let tell apart, such as of numbers at the end of the range of a double.
struct Inseparable : std::runtime_error {
  Inseparable() : std::runtime_error("growing waves cannot be told apart in double precision") {}
};

/// Part of the right half-plane: min_modulus < |p| < max_modulus, Re p > min_growth |p|. Points nearer to the
/// imaginary axis count as neutral: branch points and the resonances of an undamped body lie on it.
struct Sector {
  double min_modulus = 1e-8;
  double max_modulus = 1e9;
  double min_growth = 1e-6;
  /// Largest |d(phase of f)/dp| of an oscillating f, such as a layer's height: contours are sampled finely
  /// enough to follow it.
  double phase_rate = 0;
};

/// All zeros of an analytic function in a sector, by the argument principle: the sector is cut in log p until
/// each part holds one zero, which Newton's method then finds. Multiple zeros appear once each time.
/// @param expected  places of zeros; where Newton's method finds them all from there, nothing is cut
/// @throws Inseparable
std::vector<Complex> zeros_by_argument_principle(const std::function<Complex(Complex)>& f,
                                                 const Sector& sector,
                                                 std::span<const Complex> expected = {});

}  // namespace slipfront::stability
