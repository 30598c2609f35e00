// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/interruption.hpp"
#include "motion/observer.hpp"

namespace slipfront::motion {

/// Steps a started stepper until one of a list of observers ends it.
class ObservedRun final : public SlipObserver {
 public:
  /// @param finder  of the state before the first step
  /// @param x_m     of the interface nodes
  ObservedRun(TimeStepper& stepper, SlipFinder finder, std::vector<double> x_m, Observers observers)
      : SlipObserver(std::move(finder)), stepper_(&stepper), observers_(std::move(observers)) {
    row_.x_m = std::move(x_m);
  }

  End run();

  void at_update(const SlipUpdate& seen) override {
    for (const auto& observer : observers_) observer->at_update(seen);
  }
  record::History* row() override;
  double* displacements(std::int64_t step) override;
  bool after_step(const SlipRates& rates) override;
  bool is_interrupted() override { return is_pause_wanted(); }
  std::int64_t guaranteed_steps() override;

  /// The observer of a kind that there is one of.
  template <class T>
  T& get() const {
    T* found = nullptr;
    for (const auto& observer : observers_)
      if (auto* of_kind = dynamic_cast<T*>(observer.get())) found = of_kind;
    SLIPFRONT_ASSERT(found != nullptr, "an observer of that kind");
    return *found;
  }

  /// All that changes during a run, in a pause, but for the stepper's.
  void archive(StateArchive& archive);
  /// After that was read. @throws StateError where the stepper's motion, restored before, does not come to it
  void require_restored();

 private:
  std::optional<End> end(Pause& pause);

  TimeStepper* stepper_;
  Observers observers_;
  record::History row_;  ///< of the step under way, where one is wanted
};

}  // namespace slipfront::motion
