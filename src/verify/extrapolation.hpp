// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace slipfront::verify {

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

}  // namespace slipfront::verify
