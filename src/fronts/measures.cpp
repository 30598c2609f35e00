// SPDX-License-Identifier: BSD-3-Clause
#include "fronts/measures.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.hpp"

namespace slipfront::fronts {
namespace {

constexpr std::size_t most_added_up = 256;
constexpr int stretch_side_points = 2;
constexpr std::size_t max_undefined_in_stretch = 2;

double least_squares_slope(std::span<const double> s, std::span<const double> y) {
  const auto n = static_cast<double>(s.size());
  double s_mean = 0, y_mean = 0;
  for (std::size_t k = 0; k < s.size(); ++k) {
    s_mean += s[k] / n;
    y_mean += y[k] / n;
  }
  double ss = 0, sy = 0;
  for (std::size_t k = 0; k < s.size(); ++k) {
    ss += (s[k] - s_mean) * (s[k] - s_mean);
    sy += (s[k] - s_mean) * (y[k] - y_mean);
  }
  return sy / ss;
}

/// Sums of the values before each place: slopes over many points without adding them up for each.
class SlopeSums {
 public:
  SlopeSums(std::span<const double> s, std::span<const double> y) {
    sums_.reserve(s.size() + 1);
    Sums sum;
    sums_.push_back(sum);
    for (std::size_t k = 0; k < s.size(); ++k) {
      const long double here = s[k], value = y[k];
      sum = {sum.s + here, sum.y + value, sum.ss + here * here, sum.sy + here * value};
      sums_.push_back(sum);
    }
  }
  double slope(std::size_t begin, std::size_t end) const {
    const Sums &a = sums_[begin], &b = sums_[end];
    const auto n = static_cast<long double>(end - begin);
    const long double s = b.s - a.s, y = b.y - a.y;
    return static_cast<double>((b.sy - a.sy - s * y / n) / (b.ss - a.ss - s * s / n));
  }

 private:
  struct Sums {
    long double s = 0, y = 0, ss = 0, sy = 0;
  };
  std::vector<Sums> sums_;
};

}  // namespace

double length_m(const Front& front) {
  return front.points.empty() ? 0.0 : std::abs(front.points.back().x_m - front.points.front().x_m);
}

std::vector<double> local_slopes(std::span<const double> s, std::span<const double> y, double half_width,
                                 int side_points) {
  SLIPFRONT_ASSERT(s.size() == y.size(), "one value for each place");
  std::vector<double> s_defined, y_defined;
  for (std::size_t k = 0; k < s.size(); ++k) {
    if (std::isnan(y[k])) continue;
    s_defined.push_back(s[k]);
    y_defined.push_back(y[k]);
  }
  const std::ptrdiff_t n = std::ssize(s_defined);
  const auto index_from = [&](double place) {
    return std::ranges::lower_bound(s_defined, place) - s_defined.begin();
  };
  const auto index_after = [&](double place) {
    return std::ranges::upper_bound(s_defined, place) - s_defined.begin();
  };

  std::optional<SlopeSums> sums;
  std::vector<double> slopes(s.size(), nan);
  for (std::size_t k = 0; k < s.size(); ++k) {
    const std::ptrdiff_t begin =
        std::max<std::ptrdiff_t>(0, std::min(index_from(s[k] - half_width), index_from(s[k]) - side_points));
    const std::ptrdiff_t end =
        std::min(n, std::max(index_after(s[k] + half_width), index_after(s[k]) + side_points));
    if (end - begin < 3) continue;
    const auto count = static_cast<std::size_t>(end - begin);
    if (count > most_added_up && !sums) sums.emplace(s_defined, y_defined);
    slopes[k] =
        count > most_added_up
            ? sums->slope(static_cast<std::size_t>(begin), static_cast<std::size_t>(end))
            : least_squares_slope({s_defined.data() + begin, count}, {y_defined.data() + begin, count});
  }
  return slopes;
}

std::vector<Stretch> find_stretches(std::span<const double> s_m, std::span<const double> falling,
                                    std::span<const double> rising, const StretchOptions& options) {
  SLIPFRONT_ASSERT(s_m.size() == falling.size() && s_m.size() == rising.size(), "one value for each place");
  const std::vector<double> fall_slope =
      local_slopes(s_m, falling, options.half_width_m, stretch_side_points);
  const std::vector<double> rise_slope = local_slopes(s_m, rising, options.half_width_m, stretch_side_points);

  std::vector<Stretch> stretches;
  bool open = false;
  Stretch current;
  const auto close = [&] {
    if (!open) return;
    open = false;
    current.length_m = s_m[current.last] - s_m[current.first];
    current.fall = falling[current.first] - falling[current.last];
    current.rise = rising[current.last] - rising[current.first];
    if (current.length_m >= options.min_length_m * (1.0 - 1e-6)) stretches.push_back(current);
  };
  for (std::size_t k = 0; k < s_m.size(); ++k) {
    if (std::isnan(falling[k]) || std::isnan(rising[k])) continue;
    if (!(fall_slope[k] < 0.0 && rise_slope[k] > 0.0)) {
      close();
      continue;
    }
    if (open && k - current.last > max_undefined_in_stretch + 1) close();
    if (!open) current = {k, k, 0.0, 0.0, 0.0};
    open = true;
    current.last = k;
  }
  close();
  return stretches;
}

}  // namespace slipfront::fronts
