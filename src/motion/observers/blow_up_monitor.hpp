// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "motion/observer.hpp"
#include "motion/settings.hpp"

namespace slipfront::motion {

/// Monitors that the motion stays physical: in every step numbers finite and slip rates below c_L, and
/// whenever energies are known and at least every 100 steps no more energy than was there at the start and
/// has been supplied since, but for 1 %, and terms that close the balance.
class BlowUpMonitor final : public Observer {
 public:
  /// @param start  energies at time 0
  BlowUpMonitor(TimeStepper& stepper, double c_L_m_per_s, Precision precision, const record::Energies& start)
      : stepper_(stepper), c_L_m_per_s_(c_L_m_per_s), precision_(precision), start_(start) {}

  bool after_step(const Now& now, const SlipRates& rates) override;
  std::int64_t steps_to_pause(const Now& now) const override;
  void at_pause(Pause& pause) override;
  std::optional<End> end(Pause& pause) override;

  const char* name() const override { return "blow-up"; }
  void archive(StateArchive& archive) override { archive(start_, checked_step_); }
  void restored(Pause& pause) override;
  /// Whether energies close the balance since the start, up to rounding; in single precision whether they are
  /// numbers.
  bool balances(const record::Energies& now) const;

 private:
  std::string energy_failure(const record::Energies& now) const;
  /// Whether neither the start nor the loads account for an energy.
  bool is_from_nowhere(double energy_J_per_m, const record::Energies& now) const;
  std::string remedy(const record::Energies& now) const;

  TimeStepper& stepper_;
  double c_L_m_per_s_;
  Precision precision_;
  record::Energies start_;
  std::int64_t checked_step_ = 0;  ///< of the last look at the energies
  std::string failure_;            ///< what is wrong with the motion and, once it is known, what to change
};

}  // namespace slipfront::motion
