// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "fronts/fit.hpp"

namespace slipfront::fronts {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double a = 0.76, b = 1.80, c = 3.05;

double law(double x) {
  return a + b * std::exp(-c * std::sqrt(x));
}

/// n points, evenly in sqrt(x) over (0, 1.2], on the law with correlated noise: each error keeps `memory` of
/// the one before.
Series noisy(int n, double sigma, double memory, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Series series;
  double error = sigma * normal(random);
  for (int k = 1; k <= n; ++k) {
    const double s = 1.2 * k / n;
    series.x.push_back(s * s);
    series.y.push_back(law(series.x.back()) + error);
    error = memory * error + std::sqrt(1 - memory * memory) * sigma * normal(random);
  }
  return series;
}

double width(const Estimate& estimate) {
  return estimate.high - estimate.low;
}
bool holds(const Estimate& estimate, double truth) {
  return estimate.low <= truth && truth <= estimate.high;
}

TEST(FitExponential, NoiselessData) {
  const std::vector<Series> series{noisy(60, 0.0, 0.0, 1), noisy(37, 0.0, 0.0, 1)};
  const ExponentialFit fit = fit_exponential(series);
  EXPECT_NEAR(fit.a.value, a, 1e-6);
  EXPECT_NEAR(fit.b.value, b, 1e-6);
  EXPECT_NEAR(fit.c.value, c, 1e-6);
  EXPECT_LT(fit.rms, 1e-9);
  EXPECT_EQ(fit.n_points, 97u);
  EXPECT_NEAR(fit(0.25), law(0.25), 1e-9);
  // Every resample of exact data has the same answer, to the 2^-16 of the search's first bracket (about 30 %
  // of c) in log c; a and b move with c by less than their own size.
  for (const Estimate& estimate : {fit.a, fit.b, fit.c}) EXPECT_LT(width(estimate), 2 * 0.3 / 65536 * c);
}

TEST(FitExponential, FarFromTheOriginAndOtherScales) {
  for (const double rate : {0.02, 40.0}) {  // rates that fit the range of x
    Series series;
    for (int k = 0; k < 50; ++k) {
      const double s = (0.5 + 0.05 * k) / rate;
      series.x.push_back(s * s);
      series.y.push_back(-2.0 + 5.0 * std::exp(-rate * s));
    }
    const ExponentialFit fit = fit_exponential({&series, 1}, {.resamples = 0});
    EXPECT_NEAR(fit.a.value, -2.0, 1e-6);
    EXPECT_NEAR(fit.b.value, 5.0, 1e-6);
    EXPECT_NEAR(fit.c.value / rate, 1.0, 1e-6);
    EXPECT_TRUE(std::isnan(fit.a.low) && std::isnan(fit.c.high));
  }
}

TEST(FitExponential, IsTheLeastSquaresSolution) {
  const Series series = noisy(200, 0.1, 0.0, 7);
  const ExponentialFit fit = fit_exponential({&series, 1}, {.resamples = 0});
  const auto sum_of_squares = [&](double a_, double b_, double c_) {
    double sum = 0;
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      const double r = series.y[k] - a_ - b_ * std::exp(-c_ * std::sqrt(series.x[k]));
      sum += r * r;
    }
    return sum;
  };
  const double least = sum_of_squares(fit.a.value, fit.b.value, fit.c.value);
  EXPECT_NEAR(fit.rms, std::sqrt(least / 200), 1e-12);
  for (const double step : {-1e-3, 1e-3}) {
    EXPECT_GT(sum_of_squares(fit.a.value + step, fit.b.value, fit.c.value), least);
    EXPECT_GT(sum_of_squares(fit.a.value, fit.b.value + step, fit.c.value), least);
    EXPECT_GT(sum_of_squares(fit.a.value, fit.b.value, fit.c.value + step), least);
  }
}

TEST(FitExponential, IntervalsHoldTheTruth) {
  // Of 95 % intervals some miss. 40 independent data sets: fewer than 32 hits have a probability of 0.01 %
  // for a coverage of 0.95, and of 5 % for one of 0.87, as a percentile bootstrap of this many points may
  // have.
  std::array<int, 4> hits{};
  for (unsigned seed = 0; seed < 40; ++seed) {
    const std::vector<Series> series{noisy(200, 0.05, 0.6, 2 * seed), noisy(200, 0.05, 0.6, 2 * seed + 1)};
    const ExponentialFit fit = fit_exponential(series, {.resamples = 200});
    hits[0] += holds(fit.a, a);
    hits[1] += holds(fit.b, b);
    hits[2] += holds(fit.c, c);
    hits[3] += holds(fit.curve[30].y, law(fit.curve[30].x));
  }
  for (const int n : hits) EXPECT_GE(n, 32);
}

TEST(FitExponential, CurveIsThatOfTheParameters) {
  const std::vector<Series> series{noisy(200, 0.05, 0.5, 3), noisy(150, 0.05, 0.5, 4)};
  const ExponentialFit fit = fit_exponential(series);
  ASSERT_EQ(fit.curve.size(), 61u);
  const double first = 1.2 / 200;
  for (std::size_t k = 0; k < fit.curve.size(); ++k) {
    const auto& [x, y] = fit.curve[k];
    EXPECT_NEAR(std::sqrt(x), first + (1.2 - first) / 60 * static_cast<double>(k), 1e-12);
    EXPECT_NEAR(y.value, fit(x), 1e-12);
    EXPECT_LT(y.low, y.value);
    EXPECT_GT(y.high, y.value);
  }
  // a, b and c vary together: amid the points the curve is known better than its asymptote.
  EXPECT_LT(width(fit.curve[30].y), 0.5 * width(fit.a));
}

TEST(FitExponential, IntervalsShrinkWithTheNumberOfPoints) {
  const Series few = noisy(100, 0.05, 0.0, 3);
  const Series many = noisy(1600, 0.05, 0.0, 4);
  const auto fit = fit_exponential({&many, 1});
  // A quarter from the number alone; more for few points, whose resamples often miss the steep start of the
  // curve.
  EXPECT_LT(width(fit.a), 0.25 * width(fit_exponential({&few, 1}).a));

  // Of independent errors and many points linear theory holds: covariance sigma^2 (J^T J)^-1, 1.96 standard
  // deviations to each side.
  std::array<std::array<double, 3>, 3> A{};  // J^T J
  for (const double x : many.x) {
    const double root = std::sqrt(x), decayed = std::exp(-c * root);
    const std::array row = {1.0, decayed, -b * root * decayed};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) A[i][j] += row[i] * row[j];
  }
  // Of the inverse's diagonal: a minor over the determinant.
  const auto minor = [&](std::size_t i, std::size_t j) { return A[i][i] * A[j][j] - A[i][j] * A[j][i]; };
  const double determinant = A[0][0] * minor(1, 2) - A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0]) +
                             A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0]);
  const auto expected_width = [&](double of_minor) {
    return 2 * 1.96 * 0.05 * std::sqrt(of_minor / determinant);
  };
  // A width from 107 blocks scatters by 7 %, and its quantiles from 400 resamples by 5 %: three of both
  // together.
  EXPECT_NEAR(width(fit.a) / expected_width(minor(1, 2)), 1.0, 0.26);
  EXPECT_NEAR(width(fit.b) / expected_width(minor(0, 2)), 1.0, 0.26);
  EXPECT_NEAR(width(fit.c) / expected_width(minor(0, 1)), 1.0, 0.26);
}

TEST(FitExponential, BlocksKeepCorrelation) {
  // Errors with a memory of 0.9 have a correlation length of 10 points. Single points drawn at random miss
  // it.
  const Series series = noisy(1000, 0.05, 0.9, 5);
  const double blocks = width(fit_exponential({&series, 1}, {.block_points = 40}).a);
  const double points = width(fit_exponential({&series, 1}, {.block_points = 1}).a);
  EXPECT_GT(blocks, 2 * points);  // sqrt((1 + 0.9) / (1 - 0.9)) = 4.4 in the limit of long series and blocks
}

TEST(FitExponential, SameSeedSameIntervals) {
  const Series series = noisy(100, 0.05, 0.5, 6);
  const auto one = fit_exponential({&series, 1}, {.seed = 3});
  const auto same = fit_exponential({&series, 1}, {.seed = 3});
  const auto other = fit_exponential({&series, 1}, {.seed = 4});
  EXPECT_EQ(one.c.low, same.c.low);
  EXPECT_EQ(one.a.high, same.a.high);
  EXPECT_NE(one.c.low, other.c.low);
  EXPECT_EQ(one.c.value, other.c.value);
}

TEST(FitExponential, UnusablePointsAreLeftOut) {
  Series series = noisy(50, 0.0, 0.0, 1);
  series.x.insert(series.x.end(), {nan, 1.0, -0.1, 1.0});
  series.y.insert(series.y.end(), {1.0, nan, 9.0, std::numeric_limits<double>::infinity()});
  const std::vector<Series> all{series, {}};
  const auto fit = fit_exponential(all);
  EXPECT_EQ(fit.n_points, 50u);
  EXPECT_NEAR(fit.c.value, c, 1e-6);
}

TEST(FitExponential, TooFewPoints) {
  EXPECT_THROW(fit_exponential({}), std::invalid_argument);
  const Series three{{1, 2, 3, nan}, {1, 2, 3, 4}};
  EXPECT_THROW(fit_exponential({&three, 1}), std::invalid_argument);
  const Series same_x{{1, 1, 1, 1, 1}, {1, 2, 3, 4, 5}};
  EXPECT_THROW(fit_exponential({&same_x, 1}), std::invalid_argument);
}

TEST(RankCorrelation, HandValues) {
  const auto of = [](const std::vector<double>& x, const std::vector<double>& y) {
    return rank_correlation(x, y);
  };
  EXPECT_DOUBLE_EQ(of({1, 2, 3, 4}, {1, 8, 27, 64}), 1.0);
  EXPECT_DOUBLE_EQ(of({1, 2, 3}, {5, 4, 1}), -1.0);
  // Ranks 1 2 3 4 5 against 2 1 4 3 5: 1 - 6 * 4 / (5 * 24) = 0.8.
  EXPECT_NEAR(of({10, 20, 30, 40, 50}, {2, 1, 4, 3, 5}), 0.8, 1e-15);
  // Ties: ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4: covariance 4.5, sums of squares 4.5 and 5.
  EXPECT_NEAR(of({1, 2, 2, 3}, {1, 2, 3, 4}), 4.5 / std::sqrt(4.5 * 5.0), 1e-15);
  EXPECT_TRUE(std::isnan(of({}, {})));
  EXPECT_TRUE(std::isnan(of({1, 2}, {1, 2})));
  EXPECT_TRUE(std::isnan(of({1, 1, 1}, {1, 2, 3})));
  EXPECT_DOUBLE_EQ(of({1, 2, nan, 3}, {1, 2, -9, 3}), 1.0);
}

TEST(Median, HandValues) {
  EXPECT_DOUBLE_EQ(median(std::vector{3.0, 1.0, 2.0}), 2.0);
  EXPECT_DOUBLE_EQ(median(std::vector{4.0, 1.0, 3.0, 2.0}), 2.5);
  EXPECT_DOUBLE_EQ(median(std::vector{4.0, nan, 2.0}), 3.0);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Spread, HandValues) {
  // Two bins of x over [0, 2]. First: medians 2 and 4 of y 1 2 3 and 4: (4 - 2) / 3, mean of points 2.5.
  // Second: the first series alone, not counted.
  const std::vector<Series> two_bins{{{0.0, 0.2, 0.4, 2.0}, {1, 2, 3, 50}}, {{0.9}, {4}}};
  const Spread first = spread_at_equal_x(two_bins, 2);
  EXPECT_EQ(first.n_bins, 1);
  EXPECT_DOUBLE_EQ(first.median_relative, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(first.rms_relative, std::sqrt((2.25 + 0.25 + 0.25 + 2.25) / 4) / 2.5);

  // The same with 10 and 30 in the second bin, (30 - 10) / 20, the right end included: median of 2/3 and 1.
  const std::vector<Series> both{{{0.0, 0.2, 0.4, 2.0}, {1, 2, 3, 10}}, {{0.9, 1.5, nan}, {4, 30, 7}}};
  const Spread second = spread_at_equal_x(both, 2);
  EXPECT_EQ(second.n_bins, 2);
  EXPECT_DOUBLE_EQ(second.median_relative, 2.5 / 3.0);
  EXPECT_DOUBLE_EQ(second.rms_relative, std::sqrt((5.0 / 6.25 + 2 * 0.25) / 6));
}

TEST(Spread, NoCommonBin) {
  EXPECT_EQ(spread_at_equal_x({}, 5).n_bins, 0);
  const std::vector<Series> apart{{{0, 1}, {1, 1}}, {{9, 10}, {2, 2}}};
  EXPECT_EQ(spread_at_equal_x(apart, 5).n_bins, 0);
  EXPECT_TRUE(std::isnan(spread_at_equal_x(apart, 5).median_relative));
  EXPECT_EQ(spread_at_equal_x(apart, 1).n_bins, 1);
}

TEST(Ratio, HandValues) {
  // Three bins over [0, 3]: medians 2 / 1, 6 / 2 and no point of b.
  const Series first{{0.0, 0.5, 0.6, 1.5, 3.0}, {1, 2, 3, 6, 8}};
  const Series second{{0.1, 1.1, 1.9}, {1, 1, 3}};
  const Ratio ratio = ratio_at_equal_x(first, second, 3);
  EXPECT_EQ(ratio.n_bins, 2);
  EXPECT_DOUBLE_EQ(ratio.median, 2.5);
  EXPECT_DOUBLE_EQ(ratio.low, 2.0);
  EXPECT_DOUBLE_EQ(ratio.high, 3.0);
  EXPECT_EQ(ratio_at_equal_x({}, {}, 3).n_bins, 0);
  EXPECT_TRUE(std::isnan(ratio_at_equal_x({}, {}, 3).median));
}

}  // namespace
}  // namespace slipfront::fronts
