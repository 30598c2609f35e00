// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>

#include "motion/observer.hpp"

namespace slipfront::motion {

/// Asked once in a while during long work with the steps done and their total, which are 0 before the first
/// step; returns false to interrupt it.
using Monitor = std::function<bool(std::int64_t step, std::int64_t total)>;

/// Asks a monitor at an interval of steps, and where an interruption is wanted. It comes after all observers
/// that record: in it checkpoints are kept.
class Progress final : public Observer {
 public:
  Progress(const TimeStepper& stepper, std::int64_t interval, std::int64_t total, Monitor monitor)
      : asked_step_(stepper.step()), interval_(interval), total_(total), monitor_(std::move(monitor)) {}
  std::int64_t steps_to_pause(const Now& now) const override { return interval_ - now.step % interval_; }
  std::optional<End> end(Pause& pause) override {
    const auto step = pause.now().step;
    if (step == asked_step_ || (step % interval_ != 0 && !pause.stepper().is_interrupted())) return {};
    asked_step_ = step;
    if (monitor_(step, total_)) return {};
    return End{EventEnd::interrupted};
  }
  void restored(Pause& pause) override { asked_step_ = pause.now().step; }

 private:
  std::int64_t asked_step_, interval_, total_;
  Monitor monitor_;
};

}  // namespace slipfront::motion
