// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "mesh/mesh.hpp"
#include "verification/verification.hpp"

/// Convergence with the mesh, dt/h fixed.
namespace slipfront::verification {

/// Slope of log(error) over log(h) by least squares.
double observed_order(const std::vector<double>& h_m, const std::vector<double>& error);

/// A line of that slope through the last error.
Curve order_line(int order, const std::vector<double>& h_m, double last_error);

/// Step factor with which a mesh of the undamped material steps by step_s.
double factor_of_step(const mesh::Mesh& mesh, double step_s);

/// Steps of 0.85 h/c_L or less, at all meshes the same fraction of h, that end at time_s exactly.
struct Steps {
  int n = 0;
  double step_s = 0;
};
Steps steps_to(double time_s, double h_m, double coarsest_h_m);

/// Limit h -> 0 of a quantity known at element sizes 4 h, 2 h and h.
struct Limit {
  double value = 0;
  /// Difference to the value from the two coarser meshes alone, as between the last two diagonal entries of
  /// Romberg's table: an estimate, rather large, of the error left.
  double uncertainty = 0;
};

/// Richardson's extrapolation: errors of order n, then of order m, are eliminated.
inline Limit limit(double at_4h, double at_2h, double at_h, int n, int m) {
  const auto eliminate = [](double coarse, double fine, int order) {
    return fine + (fine - coarse) / (std::exp2(order) - 1);
  };
  const double from_coarser = eliminate(at_4h, at_2h, n);
  const double value = eliminate(from_coarser, eliminate(at_2h, at_h, n), m);
  return {value, std::abs(value - from_coarser)};
}

/// The same of a complex number. The error of either part may be as large as that of the other: the
/// uncertainty is that of the number.
struct ComplexLimit {
  std::complex<double> value;
  double uncertainty = 0;
};
inline ComplexLimit limit(const std::array<std::complex<double>, 3>& at, int n, int m) {
  const auto real = limit(at[0].real(), at[1].real(), at[2].real(), n, m);
  const auto imag = limit(at[0].imag(), at[1].imag(), at[2].imag(), n, m);
  return {{real.value, imag.value}, std::hypot(real.uncertainty, imag.uncertainty)};
}

}  // namespace slipfront::verification
