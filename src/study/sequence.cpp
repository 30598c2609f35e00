// SPDX-License-Identifier: BSD-3-Clause
#include "study/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.hpp"
#include "fronts/fit.hpp"

namespace slipfront::study {

Limit extrapolate(std::span<const double, 3> q, std::span<const double, 3> f) {
  SLIPFRONT_ASSERT(q[0] > q[1] && q[1] > q[2] && q[2] > 0, "step sizes must fall towards 0");
  if (!std::isfinite(f[0]) || !std::isfinite(f[1]) || !std::isfinite(f[2])) return {};
  const double first = f[0] - f[1], last = f[1] - f[2];
  if (last == 0) return {Trend::monotone, highest_order, f[2]};
  const double ratio = first / last;
  const double ratio_at_order_0 = std::log(q[0] / q[1]) / std::log(q[1] / q[2]);
  if (std::abs(ratio) <= ratio_at_order_0) return {Trend::growing, undefined, undefined};
  if (ratio < 0) return {Trend::alternating, undefined, 0.5 * (f[1] + f[2])};

  // Rising in p; in powers of ratios below 1, so that nothing overflows.
  const auto ratio_at_order = [&](double p) {
    return (std::pow(q[0] / q[1], p) - 1) / (1 - std::pow(q[2] / q[1], p));
  };
  double low = 0, high = 1;
  while (ratio_at_order(high) < ratio) high *= 2;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (ratio_at_order(middle) < ratio ? low : high) = middle;
  }
  const double order = 0.5 * (low + high);
  const double p = std::min(order, highest_order);
  return {Trend::monotone, order, f[2] - last / (std::pow(q[1] / q[2], p) - 1)};
}

double error_of(double value, const Limit& limit, std::span<const double, 3> f) {
  if (limit.trend == Trend::unknown) return undefined;
  if (limit.trend == Trend::growing)
    return std::max({std::abs(value - f[0]), std::abs(value - f[1]), std::abs(value - f[2])});
  const double distance = std::abs(value - limit.value);
  return limit.trend == Trend::alternating ? distance + 0.5 * std::abs(f[1] - f[2]) : distance;
}

std::string_view name(Verdict verdict) {
  switch (verdict) {
    case Verdict::converged:
      return "converged";
    case Verdict::not_converged:
      return "not converged";
    case Verdict::no_limit:
      return "no limit";
    case Verdict::too_few_stations:
      break;
  }
  return "too few stations";
}

Summary summarise(std::span<const StationSummary> stations, int n_wanted, double tolerance) {
  std::vector<double> errors, orders, first, last;
  for (const auto& s : stations) {
    if (!std::isfinite(s.relative_error)) continue;
    errors.push_back(s.relative_error);
    orders.push_back(s.order);
    first.push_back(s.first_difference);
    last.push_back(s.last_difference);
  }
  Summary summary;
  summary.n_stations = static_cast<int>(errors.size());
  summary.n_wanted = n_wanted;
  summary.median_relative_error = fronts::median(errors);
  summary.median_order = fronts::median(orders);
  if (const double d = fronts::median(first); d > 0) summary.growth = fronts::median(last) / d;
  if (summary.n_stations < fewest_stations || 2 * summary.n_stations < n_wanted) return summary;
  if (summary.median_relative_error <= tolerance)
    summary.verdict = Verdict::converged;
  else
    summary.verdict = summary.growth < 1 ? Verdict::not_converged : Verdict::no_limit;
  return summary;
}

}  // namespace slipfront::study
