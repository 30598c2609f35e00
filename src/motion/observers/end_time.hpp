// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/observer.hpp"

namespace slipfront::motion {

/// Ends a run after a number of steps.
class EndTime final : public Observer {
 public:
  explicit EndTime(std::int64_t n_steps) : n_steps_(n_steps) {}
  std::int64_t steps_to_pause(const Now& now) const override { return n_steps_ - now.step; }
  std::optional<End> end(Pause& pause) override {
    if (pause.now().step < n_steps_) return {};
    return End{EventEnd::end_time};
  }
  void restored(Pause& pause) override {
    require_possible(pause.now().step >= 0 && pause.now().step <= n_steps_, "steps");
  }

 private:
  std::int64_t n_steps_;
};

}  // namespace slipfront::motion
