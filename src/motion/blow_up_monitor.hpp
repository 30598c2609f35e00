// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "motion/settings.hpp"
#include "motion/time_stepper.hpp"

namespace slipfront::motion {

/// Monitors that the motion stays physical: slip rates below c_L, and no more energy than was there at the
/// start and has been supplied since.
class BlowUpMonitor {
 public:
  BlowUpMonitor(TimeStepper& stepper, double c_L_m_per_s);
  /// Continues from another monitor's start and last energy check.
  BlowUpMonitor(TimeStepper& stepper, double c_L_m_per_s, const record::Energies& start,
                std::int64_t checked_step);

  const record::Energies& start() const { return start_; }
  /// Step of the last energy check.
  std::int64_t checked_step() const { return checked_step_; }
  /// The energies of that check, if this monitor made it.
  const std::optional<record::Energies>& last() const { return last_; }
  /// Whether a saved motion can be one: it is not to be checked yet, and its energies balance.
  bool is_possible(Precision precision);
  /// Largest slip rate of nodes that slip, in the last check of the interface.
  double fastest_slip_m_per_s() const { return fastest_slip_m_per_s_; }

  /// Checks the interface's motion after a step. @return whether it is physical
  bool check(const SlipRates& rates);

  /// Steps to the next energy check.
  std::int64_t steps_to_check() const;

  /// Empty, or what is wrong with the motion and what to change.
  /// @param known  energies that were taken after this step for another purpose; null for none
  std::string failure(const record::Energies* known);

 private:
  std::string energy_failure(const record::Energies& now) const;
  /// Whether neither the start nor the loads account for an energy.
  bool is_from_nowhere(double energy_J_per_m, const record::Energies& now) const;
  std::string remedy(const record::Energies& now) const;

  TimeStepper& stepper_;
  double c_L_m_per_s_;
  record::Energies start_;
  std::int64_t checked_step_ = 0;
  std::optional<record::Energies> last_;
  double fastest_slip_m_per_s_ = 0;
  std::string failure_;  ///< found at the interface
};

std::string blow_up_message(const TimeStepper& stepper, const std::string& failure);

}  // namespace slipfront::motion
