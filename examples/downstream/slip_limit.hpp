// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>

#include "motion/observers/interval_observer.hpp"

/// Ends an event when a node has slipped so far.
class SlipLimit final : public slipfront::motion::IntervalObserver {
 public:
  SlipLimit(double limit_m, double interval_s) : IntervalObserver(interval_s), limit_m_(limit_m) {}

  std::string look(slipfront::record::History& row, const slipfront::motion::Now& /*now*/,
                   slipfront::motion::Pause& /*pause*/) override {
    const auto k = std::ranges::max_element(row.slip_m) - row.slip_m.begin();
    if (row.slip_m[k] < limit_m_) return {};
    return "slip has reached its limit at x = " + std::to_string(row.x_m[k]) + " m";
  }

 private:
  double limit_m_;
};
