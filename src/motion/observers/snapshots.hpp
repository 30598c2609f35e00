// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "motion/observer.hpp"
#include "motion/observers/event_output.hpp"

namespace slipfront::motion {

/// Gives snapshots to an output, each after the first step at or after its time.
class Snapshots final : public Observer {
 public:
  /// @param times_s  ascending
  Snapshots(std::vector<double> times_s, EventOutput& output)
      : times_s_(std::move(times_s)), output_(output) {}
  std::int64_t steps_to_pause(const Now& now) const override {
    return next_ < times_s_.size() ? steps_until(now, times_s_[next_]) : many_steps;
  }
  void at_pause(Pause& pause) override {
    for (; next_ < times_s_.size() && pause.now().time_s() >= times_s_[next_]; ++next_)
      output_.snapshot(pause.stepper());
  }
  const char* name() const override { return "snapshots"; }
  void archive(StateArchive& archive) override { archive(next_); }
  /// All that were due have been taken.
  void restored(Pause& pause) override {
    const double now_s = pause.now().time_s();
    require_possible(next_ <= times_s_.size() && (next_ == 0 || times_s_[next_ - 1] <= now_s) &&
                         (next_ == times_s_.size() || times_s_[next_] > now_s),
                     "snapshots");
  }

 private:
  std::vector<double> times_s_;
  EventOutput& output_;
  std::uint64_t next_ = 0;
};

}  // namespace slipfront::motion
