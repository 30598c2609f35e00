// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace slipfront::motion {

/// A time between two steps.
struct Now {
  std::int64_t step = 0;
  double step_s = 0;
  double time_s() const { return static_cast<double>(step) * step_s; }
};

/// Steps from time 0 to the first that is at time_s or later, but for rounding.
inline double steps_to(double time_s, double step_s) {
  return std::ceil(time_s / step_s * (1 - 1e-12));
}

/// More steps than any run takes.
inline constexpr std::int64_t many_steps = 10'000'000'000'000;

/// Steps, at least one, until the time is at least time_s.
inline std::int64_t steps_until(const Now& now, double time_s) {
  if (!(time_s < static_cast<double>(many_steps) * now.step_s)) return many_steps;
  auto step = static_cast<std::int64_t>(time_s / now.step_s) - 1;
  while (static_cast<double>(step) * now.step_s < time_s) ++step;
  return std::max<std::int64_t>(step - now.step, 1);
}

/// Multiples of an interval of time, from 0, as steps meet them: each by the first step at or after it; an
/// interval shorter than a step is one step.
class Every {
 public:
  explicit Every(double interval_s) : interval_s_(interval_s) {}

  bool is_due(const Now& now) const {
    if (now.step <= 0) return now.step == 0;
    return multiples_until(now) > multiples_until({now.step - 1, now.step_s});
  }
  /// To the next one that is due, at least one.
  std::int64_t steps_to_next(const Now& now) const {
    return steps_until(now, static_cast<double>(multiples_until(now) + 1) * interval_s(now));
  }

 private:
  double interval_s(const Now& now) const { return std::max(interval_s_, now.step_s); }
  std::int64_t multiples_until(const Now& now) const {
    const double time_s = now.time_s(), interval = interval_s(now);
    auto n = static_cast<std::int64_t>(time_s / interval);
    while (static_cast<double>(n + 1) * interval <= time_s) ++n;
    while (static_cast<double>(n) * interval > time_s) --n;
    return n;
  }

  double interval_s_;
};

}  // namespace slipfront::motion
