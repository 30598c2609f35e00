// SPDX-License-Identifier: BSD-3-Clause
#include "fronts/fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "base/error.hpp"
#include "base/numbers.hpp"

namespace slipfront::fronts {
namespace {

// Limits of c times the range of s = sqrt(x), and the number of values tried between them.
constexpr double c_range_low = 0.01;
constexpr double c_range_high = 50.0;
constexpr Eigen::Index n_grid = 64;
constexpr int fit_bisections = 48;       // to rounding
constexpr int resample_bisections = 16;  // to 1e-5 of c, far below the intervals' own scatter

constexpr int n_curve_steps = 60;

/// All usable points. s is counted from its least value, so that exp(-c s) is at most 1 for every c.
struct Points {
  Eigen::ArrayXd s;
  Eigen::ArrayXd y;
  double s_min = 0;
  std::vector<Eigen::Index> n_in_series;
};

Points usable_points(std::span<const Series> series) {
  std::vector<double> s, y;
  Points points;
  for (const Series& one : series) {
    SLIPFRONT_ASSERT(one.x.size() == one.y.size(), "a series has one y for each x");
    const std::size_t before = s.size();
    for (std::size_t k = 0; k < one.x.size(); ++k) {
      if (!std::isfinite(one.x[k]) || !std::isfinite(one.y[k]) || one.x[k] < 0.0) continue;
      s.push_back(std::sqrt(one.x[k]));
      y.push_back(one.y[k]);
    }
    points.n_in_series.push_back(static_cast<Eigen::Index>(s.size() - before));
  }
  if (s.size() < 4) throw std::invalid_argument("fit_exponential: fewer than 4 usable points");
  const auto [low, high] = std::ranges::minmax(s);
  if (low == high) throw std::invalid_argument("fit_exponential: all points have the same x");
  points.s_min = low;
  points.s = Eigen::Map<Eigen::ArrayXd>(s.data(), std::ssize(s)) - low;
  points.y = Eigen::Map<Eigen::ArrayXd>(y.data(), std::ssize(y));
  return points;
}

/// exp(-c s) for a range of c. [points x n_grid]
struct Grid {
  Eigen::ArrayXd c;
  Eigen::MatrixXd z;
  Eigen::MatrixXd z_squared;
};

Grid make_grid(const Points& points) {
  Grid grid;
  const double range = points.s.maxCoeff();
  grid.c =
      Eigen::ArrayXd::LinSpaced(n_grid, std::log(c_range_low / range), std::log(c_range_high / range)).exp();
  grid.z.resize(points.s.size(), n_grid);
  for (Eigen::Index k = 0; k < n_grid; ++k) grid.z.col(k) = (-grid.c[k] * points.s).exp();
  grid.z_squared = grid.z.array().square();
  return grid;
}

struct Parameters {
  double a = nan, b = nan, c = nan;
  double sum_of_squares = nan;  // weighted
  double slope = nan;           // half the derivative of sum_of_squares by c
};

/// Best a and b (of exp(-c (s - s_min))) for a given c.
Parameters solve_linear(const Points& points, const Eigen::ArrayXd& weight, double c) {
  const Eigen::ArrayXd z = (-c * points.s).exp();
  const double total = weight.sum();
  const double z_mean = (weight * z).sum() / total;
  const double y_mean = (weight * points.y).sum() / total;
  const double zz = (weight * (z - z_mean).square()).sum();
  Parameters p;
  p.c = c;
  p.b = zz > 0.0 ? (weight * (z - z_mean) * (points.y - y_mean)).sum() / zz : nan;
  p.a = y_mean - p.b * z_mean;
  const Eigen::ArrayXd residual = points.y - p.a - p.b * z;
  p.sum_of_squares = (weight * residual.square()).sum();
  p.slope = p.b * (weight * residual * points.s * z).sum();
  return p;
}

/// Least squares of the weighted points: best c of the grid, then bisection on the slope between its
/// neighbours.
Parameters solve(const Points& points, const Grid& grid, const Eigen::ArrayXd& weight, int bisections) {
  const double total = weight.sum();
  const double y_mean = (weight * points.y).sum() / total;
  const Eigen::VectorXd weighted_y = weight * (points.y - y_mean);
  const Eigen::ArrayXd z_sum = grid.z.transpose() * weight.matrix();
  const Eigen::ArrayXd zy = grid.z.transpose() * weighted_y;
  const Eigen::ArrayXd zz = (grid.z_squared.transpose() * weight.matrix()).array() - z_sum.square() / total;
  Eigen::Index best = 0;
  (zy.square() / zz.max(std::numeric_limits<double>::min())).maxCoeff(&best);  // what the law explains

  double low = std::log(grid.c[std::max<Eigen::Index>(best - 1, 0)]);
  double high = std::log(grid.c[std::min(best + 1, n_grid - 1)]);
  for (int k = 0; k < bisections; ++k) {
    const double middle = 0.5 * (low + high);
    (solve_linear(points, weight, std::exp(middle)).slope > 0.0 ? high : low) = middle;
  }
  Parameters p = solve_linear(points, weight, std::exp(0.5 * (low + high)));
  p.b *= std::exp(p.c * points.s_min);
  return p;
}

/// How often a block bootstrap draws each point. A block that runs over the end of its series goes on at the
/// beginning; otherwise points near the ends, where the curve is often steepest, would be drawn too seldom.
Eigen::ArrayXd draw(const Points& points, int block_points, std::mt19937& random) {
  Eigen::ArrayXd weight = Eigen::ArrayXd::Zero(points.s.size());
  Eigen::Index offset = 0;
  for (const Eigen::Index n : points.n_in_series) {
    const Eigen::Index block = std::clamp<Eigen::Index>((n + 1) / 2, 1, block_points);
    for (Eigen::Index drawn = 0; drawn < n; drawn += block) {
      // By hand: what std::uniform_int_distribution gives differs between standard libraries.
      const auto start =
          static_cast<Eigen::Index>((std::uint64_t{random()} * static_cast<std::uint64_t>(n)) >> 32U);
      const Eigen::Index length = std::min(block, n - drawn);
      const Eigen::Index up_to_end = std::min(length, n - start);
      weight.segment(offset + start, up_to_end) += 1.0;
      weight.segment(offset, length - up_to_end) += 1.0;
    }
    offset += n;
  }
  return weight;
}

/// Quantile between sorted values, linear.
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

Estimate estimate(double value, std::vector<double> resampled, double confidence) {
  if (resampled.empty()) return {value, nan, nan};
  std::ranges::sort(resampled);
  return {value, quantile(resampled, 0.5 * (1.0 - confidence)),
          quantile(resampled, 0.5 * (1.0 + confidence))};
}

}  // namespace

double ExponentialFit::operator()(double x) const {
  return a.value + b.value * std::exp(-c.value * std::sqrt(x));
}

ExponentialFit fit_exponential(std::span<const Series> series, const BootstrapOptions& options) {
  SLIPFRONT_ASSERT(options.block_points > 0, "a block has points");
  SLIPFRONT_ASSERT(options.confidence > 0.0 && options.confidence < 1.0, "a confidence lies between 0 and 1");
  const Points points = usable_points(series);
  const Grid grid = make_grid(points);
  const Parameters best = solve(points, grid, Eigen::ArrayXd::Ones(points.s.size()), fit_bisections);

  std::mt19937 random(options.seed);
  std::vector<Parameters> resampled;
  for (int k = 0; k < options.resamples; ++k) {
    const Parameters p = solve(points, grid, draw(points, options.block_points, random), resample_bisections);
    if (std::isfinite(p.b)) resampled.push_back(p);  // else all drawn points are at one x
  }
  const auto estimated = [&](auto quantity) {
    std::vector<double> values(resampled.size());
    std::ranges::transform(resampled, values.begin(), quantity);
    return estimate(quantity(best), std::move(values), options.confidence);
  };
  ExponentialFit fit;
  fit.a = estimated([](const Parameters& p) { return p.a; });
  fit.b = estimated([](const Parameters& p) { return p.b; });
  fit.c = estimated([](const Parameters& p) { return p.c; });
  for (int k = 0; k <= n_curve_steps; ++k) {
    const double s = points.s_min + points.s.maxCoeff() * k / n_curve_steps;
    const auto y = estimated([s](const Parameters& p) { return p.a + p.b * std::exp(-p.c * s); });
    fit.curve.push_back({s * s, y});
  }
  fit.n_points = static_cast<std::size_t>(points.s.size());
  fit.rms = std::sqrt(best.sum_of_squares / static_cast<double>(fit.n_points));
  return fit;
}

}  // namespace slipfront::fronts
