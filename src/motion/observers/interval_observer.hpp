// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "motion/observer.hpp"

namespace slipfront::motion {

/// Looks at the interface at an interval of simulated time, between steps: a base for observers of one's own.
class IntervalObserver : public Observer {
 public:
  explicit IntervalObserver(double interval_s) : every_(interval_s) {}

  /// @param row  the interface at the first step at or after a multiple of the interval, with its places; to
  ///             take or to read
  /// @param now  of that step, the last one before this pause
  /// @return why the event is to end here; empty to go on
  virtual std::string look(record::History& row, const Now& now, Pause& pause) = 0;

  bool wants_row(const Now& now) const final { return every_.is_due(now); }
  void take_row(const record::History& row) final { row_ = row; }
  std::int64_t steps_to_pause(const Now& now) const final {
    return every_.is_due(now) ? 1 : every_.steps_to_next(now) + 1;
  }
  void at_pause(Pause& pause) final {
    if (!row_) return;
    const Now now = pause.now();
    reason_ = look(*row_, {now.step - 1, now.step_s}, pause);
    row_.reset();
  }
  std::optional<End> end(Pause& /*pause*/) final {
    if (reason_.empty()) return {};
    return End{EventEnd::observer, reason_};
  }

 private:
  Every every_;
  std::optional<record::History> row_;  ///< of a step that has been taken since the last pause
  std::string reason_;
};

}  // namespace slipfront::motion
