// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "fronts/fit.hpp"

namespace slipfront::fronts {
namespace {

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Ranks from 1; equal values share the mean of theirs.
std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return values[k]; });
  std::vector<double> rank(values.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (std::size_t k = begin; k < end; ++k) rank[order[k]] = 0.5 * static_cast<double>(begin + 1 + end);
    begin = end;
  }
  return rank;
}

/// y of each series sorted into bins of x of equal width over the range of all points. [bins][series][points]
using Binned = std::vector<std::vector<std::vector<double>>>;

Binned binned(std::span<const Series> series, int bins) {
  SLIPFRONT_ASSERT(bins > 0, "bins are counted from 1");
  const auto usable = [](const Series& one, std::size_t k) {
    return std::isfinite(one.x[k]) && std::isfinite(one.y[k]);
  };
  double low = infinity;
  double high = -low;
  for (const Series& one : series) {
    SLIPFRONT_ASSERT(one.x.size() == one.y.size(), "a series has one y for each x");
    for (std::size_t k = 0; k < one.x.size(); ++k) {
      if (!usable(one, k)) continue;
      low = std::min(low, one.x[k]);
      high = std::max(high, one.x[k]);
    }
  }
  Binned result(static_cast<std::size_t>(bins), std::vector<std::vector<double>>(series.size()));
  for (std::size_t i = 0; i < series.size(); ++i) {
    for (std::size_t k = 0; k < series[i].x.size(); ++k) {
      if (!usable(series[i], k)) continue;
      const double place = high > low ? (series[i].x[k] - low) / (high - low) * bins : 0.0;
      result[std::min(static_cast<std::size_t>(place), result.size() - 1)][i].push_back(series[i].y[k]);
    }
  }
  return result;
}

}  // namespace

double rank_correlation(std::span<const double> x, std::span<const double> y) {
  SLIPFRONT_ASSERT(x.size() == y.size(), "values come in pairs");
  std::vector<double> x_finite, y_finite;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!std::isfinite(x[k]) || !std::isfinite(y[k])) continue;
    x_finite.push_back(x[k]);
    y_finite.push_back(y[k]);
  }
  if (x_finite.size() < 3) return nan;
  const std::vector<double> x_rank = ranks(x_finite);
  const std::vector<double> y_rank = ranks(y_finite);
  const double middle = 0.5 * static_cast<double>(x_rank.size() + 1);
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t k = 0; k < x_rank.size(); ++k) {
    xx += (x_rank[k] - middle) * (x_rank[k] - middle);
    yy += (y_rank[k] - middle) * (y_rank[k] - middle);
    xy += (x_rank[k] - middle) * (y_rank[k] - middle);
  }
  return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : nan;
}

double median(std::span<const double> values) {
  std::vector<double> sorted;
  std::ranges::copy_if(values, std::back_inserter(sorted), [](double v) { return !std::isnan(v); });
  if (sorted.empty()) return nan;
  std::ranges::sort(sorted);
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

Spread spread_at_equal_x(std::span<const Series> series, int bins) {
  std::vector<double> relative;
  double sum_of_squares = 0;
  std::size_t n_points = 0;
  for (const auto& bin : binned(series, bins)) {
    std::vector<double> medians, all;
    for (const std::vector<double>& y : bin) {
      if (y.empty()) continue;
      medians.push_back(median(y));
      all.insert(all.end(), y.begin(), y.end());
    }
    if (medians.size() < 2) continue;
    const auto [smallest, largest] = std::ranges::minmax(medians);
    relative.push_back((largest - smallest) / mean(medians));
    const double bin_mean = mean(all);
    for (const double y : all) sum_of_squares += (y - bin_mean) * (y - bin_mean) / (bin_mean * bin_mean);
    n_points += all.size();
  }
  if (relative.empty()) return {nan, nan, 0};
  return {median(relative), std::sqrt(sum_of_squares / static_cast<double>(n_points)),
          static_cast<int>(relative.size())};
}

Ratio ratio_at_equal_x(const Series& a, const Series& b, int bins) {
  std::vector<double> ratios;
  const std::vector<Series> both{a, b};
  for (const auto& bin : binned(both, bins)) {
    if (!bin[0].empty() && !bin[1].empty()) ratios.push_back(median(bin[0]) / median(bin[1]));
  }
  if (ratios.empty()) return {nan, nan, nan, 0};
  const auto [low, high] = std::ranges::minmax(ratios);
  return {median(ratios), low, high, static_cast<int>(ratios.size())};
}

}  // namespace slipfront::fronts
