// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/observer.hpp"
#include "motion/observers/event_output.hpp"

namespace slipfront::motion {

/// Gives rows of the history to an output, at an interval.
class HistoryRows final : public Observer {
 public:
  HistoryRows(double interval_s, EventOutput& output) : every_(interval_s), output_(output) {}
  bool wants_row(const Now& now) const override { return every_.is_due(now); }
  void take_row(const record::History& row) override { output_.sample(row); }

 private:
  Every every_;
  EventOutput& output_;
};

}  // namespace slipfront::motion
