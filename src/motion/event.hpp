// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/per_node.hpp"
#include "motion/observed_run.hpp"
#include "motion/observers/energy_rows.hpp"
#include "motion/observers/onsets.hpp"
#include "motion/observers/progress.hpp"
#include "motion/observers/rest_criterion.hpp"
#include "motion/observers/stick_criterion.hpp"
#include "motion/observers/tip_slips.hpp"
#include "record/breakdown.hpp"
#include "record/record.hpp"
#include "record/tip_slip.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// A slip event as it was computed.
struct Event {
  EventEnd end = EventEnd::end_time;
  std::string reason;  ///< of a blow-up or an observer: which step, and why
  std::int64_t steps = 0;
  double time_s = 0;
  double quiet_slip_rate_m_per_s = 0;  ///< slower slip that does not grow counts as none, see RestCriterion
  record::SlipRecord record;
  record::Breakdown breakdown;
  record::TipSlip tip_slip;
  record::History interface_at_end;        ///< see TimeStepper::interface_row
  std::vector<record::Energies> energies;  ///< at the start, at the given interval, and at the end

  template <class Archive>
  void serialize(Archive& archive) {
    archive(end, reason, steps, time_s, quiet_slip_rate_m_per_s, record, breakdown, tip_slip, energies);
  }
};

/// What an event begins with, and how it goes on.
struct EventSetup {
  const statics::Equilibrium& state;  ///< tractions and contact before it; its displacements are not needed
  PerNode mu_s;                       ///< of the interface nodes in that state
  Waves waves;
  double loads_settle_s;  ///< time from which the loads stay
  TimeStepping time;
  double tip_slip_interval_s = 0.5e-6, energy_interval_s = 20e-6;
  int halo = 0;  ///< nodes on each side whose tractions are kept at an onset
  /// The event ends when nodes between these places stick, see StickCriterion; none: see RestCriterion.
  std::optional<Interval> stop_window = {};
  double slow_m_per_s = infinity;  ///< with that: slip rate of an equilibrium
};

/// An event under way: steps a started stepper, with the observers of an event, until the end time, or until
/// nothing has moved for time.quiet_s after the trigger's loads last changed (RestCriterion), or until the
/// motion is none of a plate (BlowUpMonitor).
class EventRun {
 public:
  /// @param monitor  may interrupt it, for good; what is kept meanwhile can go on
  /// @param more     further observers, of outputs among them
  EventRun(TimeStepper& stepper, const EventSetup& setup, const Monitor& monitor, Observers more = {});

  /// To the end.
  Event run();

  const std::vector<record::Energies>& energies() const { return run_.get<EnergyRows>().rows(); }
  /// Record of what has happened so far.
  record::SlipRecord record() const { return run_.get<Onsets>().record_until(stepper_.time_s()); }
  const record::TipSlip& tip_slip() const { return run_.get<TipSlips>().record(); }

  /// All that changes while the monitor is asked, but for the stepper.
  void serialize(StateArchive& archive) { run_.archive(archive); }
  /// After that was read, with the stepper's motion restored.
  /// @throws StateError where that does not come to what was read
  void require_restored();

 private:
  Observers observers(const EventSetup& setup, const Monitor& monitor, Observers more);

  TimeStepper& stepper_;
  double quiet_slip_rate_m_per_s_;
  ObservedRun run_;
};

}  // namespace slipfront::motion
