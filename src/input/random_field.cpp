// SPDX-License-Identifier: BSD-3-Clause
#include "input/random_field.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace slipfront::input {
namespace {

/// The excess of the field's fourth moment over a Gaussian's is -1.5 over their number.
constexpr int n_cosines = 2000;
constexpr double two_pi = 2 * std::numbers::pi;

/// Within [0, 1). Distributions of the standard library differ between libraries.
double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11U) * 0x1p-53;
}

/// Of mean 0 and variance 1 (Box and Muller 1958).
double normal(std::mt19937_64& random) {
  const double radius = std::sqrt(-2 * std::log(1 - uniform(random)));
  return radius * std::cos(two_pi * uniform(random));
}

}  // namespace

RandomField::RandomField(double correlation_length_m, double period_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (int k = 0; k < n_cosines; ++k) {
    double wavenumber_per_m = normal(random) / correlation_length_m;
    if (period_m > 0) wavenumber_per_m = two_pi / period_m * std::round(wavenumber_per_m * period_m / two_pi);
    cosines_.push_back({wavenumber_per_m, two_pi * uniform(random)});
  }
}

double RandomField::operator()(double x_m) const {
  double sum = 0;
  for (const auto& [wavenumber_per_m, phase] : cosines_) sum += std::cos(wavenumber_per_m * x_m + phase);
  return std::sqrt(2.0 / n_cosines) * sum;
}

}  // namespace slipfront::input
