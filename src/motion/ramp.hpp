// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "base/per_node.hpp"
#include "motion/observed_run.hpp"
#include "motion/observers/progress.hpp"
#include "motion/stepper.hpp"
#include "record/record.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Relative distance to mu_s at which the ramp hands over to the spontaneous event.
inline constexpr double ramp_handover = 1e-5;

/// States that the explicit ramp reaches, and what happened on the way.
struct Ramp {
  statics::Equilibrium subcritical;    ///< at (1 - critical_margin) mu_s inside
  statics::Equilibrium supercritical;  ///< just before mu_s is reached inside
  record::SlipRecord record;           ///< of all slip during the ramp
  std::int64_t steps = 0;
  bool interrupted = false;

  /// Beginnings of slip inside: where it came within a step before t/p was seen near mu_s.
  std::uint64_t n_onsets_inside() const;
  /// Whether t/p passed from less than (1 - critical_margin) mu_s to slip within a step.
  bool passed_margin_in_a_step() const { return subcritical.shear_m == supercritical.shear_m; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(subcritical, supercritical, record, steps, interrupted);
  }
};

/// What a ramp begins with.
struct RampSetup {
  const statics::Equilibrium& tilted;
  const statics::Loading& loading;
  PerNode mu_s;  ///< of the interface nodes
  double top_speed_m_per_s, c_L_m_per_s;
  double expected_shear_m;  ///< at which mu_s is reached
};

/// A ramp under way: moves the loaded edge of the tilted plate at top_speed_m_per_s by explicit steps until
/// t/p inside the interface reaches mu_s.
class RampRun {
 public:
  /// @param stepper  started from the tilted state at the top's speed
  /// @throws UserError where it takes too many steps
  RampRun(Stepper& stepper, const RampSetup& setup, const Monitor& monitor);

  /// @throws BlowUp, and UserError where mu_s is not reached within twice the shear expected.
  Ramp run();

  /// All that changes while the monitor is asked, but for the stepper.
  void serialize(StateArchive& archive) {
    run_.archive(archive);
    if (archive.is_loading()) run_.require_restored();
  }

 private:
  Stepper& stepper_;
  ObservedRun run_;
};

}  // namespace slipfront::motion
