// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace slipfront::problem {

/// A Gaussian random function of position with mean 0, variance 1 and correlation exp(-x^2/(2 l^2)) over the
/// seeds: a sum of cosines of random wavenumbers and phases (Shinozuka 1971), the same for any nodes. One
/// that repeats has wavenumbers rounded to multiples of 2 pi/period, which changes its correlation by at most
/// 1.3 (l/period)^2.
class RandomField {
 public:
  /// @param period_m  0 for a field that does not repeat
  RandomField(double correlation_length_m, double period_m, std::uint64_t seed);
  double operator()(double x_m) const;

 private:
  std::vector<double> turns_per_m_, turns_;  ///< of each cosine: its wavenumber and phase over 2 pi
};

}  // namespace slipfront::problem
