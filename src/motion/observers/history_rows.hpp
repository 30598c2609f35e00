// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>

#include "motion/observer.hpp"

namespace slipfront::motion {

/// Gives rows of the history to a function, at an interval, while steps are taken.
class HistoryRows final : public Observer {
 public:
  HistoryRows(double interval_s, std::function<void(const record::History& row)> take)
      : every_(interval_s), take_(std::move(take)) {}
  bool wants_row(const Now& now) const override { return every_.is_due(now); }
  void take_row(const record::History& row) override { take_(row); }

 private:
  Every every_;
  std::function<void(const record::History& row)> take_;
};

}  // namespace slipfront::motion
