// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>

#include "base/per_node.hpp"
#include "motion/observer.hpp"
#include "motion/stepper.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Relative distance to mu_s at which the ramp hands over to the spontaneous event.
inline constexpr double ramp_handover = 1e-5;

/// Finds the states of a ramp in which t/p inside reaches (1 - critical_margin) mu_s and mu_s, where it ends.
class RampStates final : public Observer {
 public:
  /// What they are; empty before.
  struct Found {
    statics::Equilibrium common, spontaneous;
  };

  /// @param stepper  started from `tilted` at the top's speed
  /// @param expected_shear_m  after twice as much it fails. @throws UserError where that takes too many steps
  RampStates(const Stepper& stepper, const statics::Equilibrium& tilted, const statics::Loading& loading,
             const PerNode& mu_s, double top_speed_m_per_s, double c_L_m_per_s, double expected_shear_m);

  std::int64_t expected_steps() const { return max_steps_ / 2; }
  Found take() { return std::move(found_); }

  bool after_step(const Now& now, const SlipRates& rates) override;
  std::int64_t steps_to_pause(const Now& now) const override;
  void at_pause(Pause& pause) override;
  /// @throws UserError where mu_s is not reached
  std::optional<End> end(Pause& pause) override;

  const char* name() const override { return "ramp"; }
  void archive(StateArchive& archive) override { archive(found_.common, has_common_, from_m_, to_m_); }
  void restored(Pause& pause) override;

 private:
  statics::Equilibrium state_now() const;
  /// Whether t/p is so large a share of mu_s anywhere inside, or a node there slips.
  bool reaches(double share) const;

  const Stepper& stepper_;
  const statics::Equilibrium& tilted_;
  const statics::Loading& loading_;
  PerNode mu_s_;
  double top_speed_m_per_s_, expected_shear_m_;
  std::int64_t max_steps_;
  Found found_;
  bool has_common_ = false, reaches_common_ = false, reaches_handover_ = false;
  /// The contact's extent changes slowly; the peak is looked for between bounds that are renewed at times.
  double from_m_, to_m_;
};

}  // namespace slipfront::motion
