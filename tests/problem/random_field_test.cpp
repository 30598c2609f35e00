// SPDX-License-Identifier: BSD-3-Clause
#include "problem/random_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace slipfront::problem {
namespace {

constexpr double l_m = 10e-3;
constexpr int n_seeds = 2000;
/// Chances of a wrong alarm below 1e-6 each.
constexpr double n_deviations = 5;

/// Mean over the seeds.
template <class F>
double mean(double period_m, F&& of_field) {
  double sum = 0;
  for (int seed = 0; seed < n_seeds; ++seed)
    sum += of_field(RandomField(l_m, period_m, static_cast<std::uint64_t>(seed)));
  return sum / n_seeds;
}

/// Of an average over the seeds of what has this variance.
double deviation(double variance) {
  return std::sqrt(variance / n_seeds);
}

TEST(RandomField, HasMean0Variance1AndItsCorrelation) {
  for (const double x_m : {0.0, 0.5 * l_m, l_m, 2 * l_m, 5 * l_m}) {
    const double at_m = 0.03;
    EXPECT_NEAR(mean(0, [&](const RandomField& f) { return f(at_m + x_m); }), 0, n_deviations * deviation(1));
    // A product of two Gaussian values has the variance 1 + rho^2.
    const double rho = std::exp(-0.5 * (x_m / l_m) * (x_m / l_m));
    EXPECT_NEAR(mean(0, [&](const RandomField& f) { return f(at_m) * f(at_m + x_m); }), rho,
                n_deviations * deviation(1 + rho * rho));
  }
}

TEST(RandomField, IsGaussian) {
  // The fourth moment of a normal number is 3, and the variance of its fourth power 105 - 9.
  EXPECT_NEAR(mean(0, [](const RandomField& f) { return std::pow(f(0.02), 4); }), 3,
              n_deviations * deviation(96));
  EXPECT_NEAR(mean(0, [](const RandomField& f) { return std::pow(f(0.02), 3); }), 0,
              n_deviations * deviation(15));
}

TEST(RandomField, RepeatsWithItsPeriod) {
  constexpr double period_m = 0.1;
  for (int seed = 0; seed < 5; ++seed) {
    const RandomField f(l_m, period_m, static_cast<std::uint64_t>(seed));
    for (const double x_m : {0.0, 0.013, 0.07}) EXPECT_NEAR(f(x_m), f(x_m + period_m), 1e-11);
  }
  for (const double x_m : {0.0, l_m, period_m - l_m, 0.5 * period_m}) {
    const double across_m = std::min(x_m, period_m - x_m);
    const double rho = std::exp(-0.5 * (across_m / l_m) * (across_m / l_m));
    EXPECT_NEAR(mean(period_m, [&](const RandomField& f) { return f(0) * f(x_m); }), rho,
                n_deviations * deviation(1 + rho * rho) + 1.3 * (l_m / period_m) * (l_m / period_m));
  }
}

TEST(RandomField, OfAPeriodHasTheNearestWavesThatRepeat) {
  // The mean over a period is that of the waves of less than half a turn in it.
  constexpr double period_m = 2.5 * l_m;
  constexpr int n_places = 32;  // more than any wave's turns
  const double share = std::erf(std::numbers::pi * l_m / (period_m * std::numbers::sqrt2));
  EXPECT_NEAR(mean(period_m,
                   [](const RandomField& f) {
                     double sum = 0;
                     for (int k = 0; k < n_places; ++k) sum += f(k * period_m / n_places);
                     return std::pow(sum / n_places, 2);
                   }),
              share, n_deviations * deviation(2 * share * share));
}

TEST(RandomField, IsOfItsSeed) {
  EXPECT_EQ(RandomField(l_m, 0, 7)(0.01), RandomField(l_m, 0, 7)(0.01));
  EXPECT_NE(RandomField(l_m, 0, 7)(0.01), RandomField(l_m, 0, 8)(0.01));
}

}  // namespace
}  // namespace slipfront::problem
