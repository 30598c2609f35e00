// SPDX-License-Identifier: BSD-3-Clause
#include "study/sequence.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace slipfront::study {
namespace {

using Three = std::array<double, 3>;

constexpr Three q{4, 2, 1};

Three power_law(const Three& at, double limit, double factor, double order) {
  Three f{};
  for (std::size_t k = 0; k < 3; ++k) f[k] = limit + factor * std::pow(at[k], order);
  return f;
}

// Tolerances: 60 halvings leave 1e-15 of the order; differences of values of order 1 lose six digits at most.
constexpr double rounding = 1e-9;

TEST(Extrapolation, FindsOrderAndLimitOfAPowerLaw) {
  for (const Three& at : {q, Three{0.3, 0.2, 0.15}, Three{1, 0.9, 0.2}})
    for (const double order : {0.5, 1.0, 1.7, 2.0})
      for (const double factor : {0.3, -0.02}) {
        const auto limit = extrapolate(at, power_law(at, 5, factor, order));
        EXPECT_EQ(limit.trend, Trend::monotone);
        EXPECT_NEAR(limit.order, order, rounding);
        EXPECT_NEAR(limit.value, 5, rounding);
      }
}

TEST(Extrapolation, TrustsNoOrderAboveTheSchemes) {
  const Three f = power_law(q, 5, 0.1, 6);
  const auto limit = extrapolate(q, f);
  EXPECT_NEAR(limit.order, 6, rounding);
  EXPECT_NEAR(limit.value, f[2] - (f[1] - f[2]) / 3, rounding);  // 2^2 - 1
}

TEST(Extrapolation, SeesNoLimitWhereDifferencesGrow) {
  const Three logarithm{-std::log(4), -std::log(2), 0};  // equal differences
  for (const Three& f : {power_law(q, 5, 0.1, -1), logarithm, Three{1, 1.1, 0.9}}) {
    const auto limit = extrapolate(q, f);
    EXPECT_EQ(limit.trend, Trend::growing);
    EXPECT_TRUE(std::isnan(limit.value));
    EXPECT_TRUE(std::isnan(limit.order));
  }
}

TEST(Extrapolation, PutsTheLimitOfAlternatingValuesBetweenTheLastTwo) {
  const Three f{1.4, 0.8, 1.1};
  const auto limit = extrapolate(q, f);
  EXPECT_EQ(limit.trend, Trend::alternating);
  EXPECT_DOUBLE_EQ(limit.value, 0.95);
  EXPECT_TRUE(std::isnan(limit.order));
  EXPECT_NEAR(error_of(0.8, limit, f), 0.15 + 0.15, rounding);
}

TEST(Extrapolation, TakesEqualValuesForTheirLimitAndMissingOnesForUnknown) {
  const auto limit = extrapolate(q, Three{3, 3, 3});
  EXPECT_EQ(limit.value, 3);
  EXPECT_EQ(limit.order, highest_order);
  const Three missing{3, undefined, 3};
  EXPECT_EQ(extrapolate(q, missing).trend, Trend::unknown);
  EXPECT_TRUE(std::isnan(error_of(3, extrapolate(q, missing), missing)));
}

TEST(Extrapolation, ErrorIsTheDistanceFromTheLimitOrWithoutOneTheSpread) {
  const Three f = power_law(q, 5, 0.1, 1), wild{1, 1.1, 0.7};
  EXPECT_NEAR(error_of(f[1], extrapolate(q, f), f), 0.2, rounding);
  EXPECT_NEAR(error_of(wild[1], extrapolate(q, wild), wild), 0.4, rounding);
}

constexpr Three halved{2, 1, 0.5};

/// Stations of one sequence, as the study makes them: the case is the middle value.
template <class Values>
Summary summary_of(int n, Values&& values, double tolerance = 0.02) {
  std::vector<StationSummary> stations;
  for (int k = 0; k < n; ++k) {
    const Three f = values(k);
    const auto limit = extrapolate(halved, f);
    stations.push_back({error_of(f[1], limit, f) / f[1], limit.order,
                        std::abs(f[0] - f[1]) / f[1] / std::log(2),
                        std::abs(f[1] - f[2]) / f[1] / std::log(2)});
  }
  return summarise(stations, n, tolerance);
}

TEST(Verdict, FollowsFromErrorAndGrowth) {
  const auto second = [&](double factor) {
    return summary_of(20, [&](int k) { return power_law(halved, 1 + 0.1 * k, factor, 2); });
  };
  EXPECT_EQ(second(0.01).verdict, Verdict::converged);
  EXPECT_NEAR(second(0.01).median_order, 2, 1e-6);
  EXPECT_NEAR(second(0.01).growth, 0.25, rounding);
  EXPECT_EQ(second(0.2).verdict, Verdict::not_converged);
  const auto diverging = summary_of(20, [&](int k) { return power_law(halved, 1 + 0.1 * k, 0.2, -1); });
  EXPECT_EQ(diverging.verdict, Verdict::no_limit);
  EXPECT_NEAR(diverging.growth, 2, rounding);
}

TEST(Verdict, NoiseOnAFirstOrderSequenceDoesNotTurnIt) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.003);
  const auto s = summary_of(80, [&](int) {
    auto f = power_law(halved, 1, 0.1, 1);
    for (double& v : f) v += noise(random);
    return f;
  });
  EXPECT_EQ(s.verdict, Verdict::not_converged);
  // A difference of 0.05 carries noise of 0.003 sqrt(2), a tenth: the order is known to about 0.2 at one
  // station; the median of 80 to a small part of that, and biased by less than it.
  EXPECT_NEAR(s.median_order, 1, 0.1);
  EXPECT_NEAR(s.median_relative_error, 0.1 / 1.1, 0.01);
}

TEST(Verdict, NeedsEnoughStations) {
  const auto good = [&](int) { return power_law(halved, 1, 0.01, 2); };
  EXPECT_EQ(summary_of(fewest_stations - 1, good, 0.02).verdict, Verdict::too_few_stations);
  const auto every_third = [&](int k) {
    auto f = good(k);
    if (k % 3 != 0) f[2] = undefined;
    return f;
  };
  const auto s = summary_of(30, every_third);
  EXPECT_EQ(s.n_stations, 10);
  EXPECT_EQ(s.verdict, Verdict::too_few_stations);
}

}  // namespace
}  // namespace slipfront::study
