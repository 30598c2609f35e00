// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slipfront::fronts {

/// A value with a two-sided confidence interval.
struct Estimate {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// Points of one front, in the order of travel: neighbours are correlated, so resampling keeps blocks of
/// them.
struct Series {
  std::vector<double> x;
  std::vector<double> y;
};

/// A fitted curve at one x.
struct CurvePoint {
  double x = 0;
  Estimate y;
};

/// y = a + b exp(-c sqrt(x)), Kammer et al. 2012, Eq. 3.
struct ExponentialFit {
  Estimate a, b, c;
  std::vector<CurvePoint> curve;  ///< from the least to the largest x, at equal distances of sqrt(x)
  double rms = 0;                 ///< of the residuals
  std::size_t n_points = 0;
  double operator()(double x) const;
};

/// How the confidence intervals are found: circular moving block bootstrap, percentile method.
struct BootstrapOptions {
  int resamples = 400;    ///< 0: intervals are NaN
  int block_points = 15;  ///< neighbours kept together; at most half of a series
  double confidence = 0.95;
  std::uint32_t seed = 1;
};

/// Least squares over all points of all series. For a given c, a and b follow linearly; c is searched where
/// c (s_max - s_min) lies between 0.01 (a straight line in s = sqrt(x)) and 50 (a spike at the first point):
/// a value at one of these ends says that the points do not have the form of the law. Intervals: blocks of
/// neighbours are drawn with replacement within each series, taken as a ring, until it has its number of
/// points again. Points that are not finite or have x < 0 are left out. The same seed gives the same
/// intervals.
/// @throws std::invalid_argument for fewer than 4 usable points, or if all of them have the same x.
ExponentialFit fit_exponential(std::span<const Series> series, const BootstrapOptions& options = {});

/// Spearman's rank correlation, ties at their mean rank; NaN for fewer than 3 points or no spread. Pairs with
/// a value that is not finite are left out.
/// @pre x and y have the same size.
double rank_correlation(std::span<const double> x, std::span<const double> y);

/// Median (of the two middle values for an even count); NaN for an empty range. NaN values are left out.
double median(std::span<const double> values);

/// Spread of y over the series at equal x: x is cut into bins of equal width over the range of all points; in
/// each bin that at least two series reach, (largest - smallest series median) / mean of the series medians.
/// Points that are not finite are left out.
/// @pre bins > 0.
struct Spread {
  double median_relative = 0;  ///< median over the bins; NaN where no bin has two series
  /// Root mean square over the same bins of (point - mean of all points of the bin) / that mean.
  double rms_relative = 0;
  int n_bins = 0;  ///< bins with at least two series
};
Spread spread_at_equal_x(std::span<const Series> series, int bins);

/// Ratio of the medians of y, a over b, in bins of x as for spread_at_equal_x, where both have points; NaN
/// where none has.
/// @pre bins > 0.
struct Ratio {
  double median = 0;  ///< over the bins
  double low = 0;     ///< smallest ratio over the bins
  double high = 0;    ///< largest
  int n_bins = 0;
};
Ratio ratio_at_equal_x(const Series& a, const Series& b, int bins);

}  // namespace slipfront::fronts
