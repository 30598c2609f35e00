// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/per_node.hpp"
#include "motion/observer.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Waves in the bodies of an event.
struct Waves {
  double c_L_m_per_s = 0;  ///< of the faster body
  /// Traction per slip rate of shear waves that leave the interface at right angles: G/c_S on the rigid
  /// plane.
  double radiation_damping_Pa_s_per_m = 0;
};

/// Slip no faster than this part of the rate scale, and waves no stronger than this part of the stress at the
/// strength, are too little to count: they change tractions by less than the margin by which a plate about to
/// slip is short of its strength.
inline constexpr double rest_slip_fraction = 1e-3;
/// Kinetic energy over the event's largest below which waves no longer count: velocities of a hundredth.
inline constexpr double rest_kinetic_fraction = 1e-4;
/// Slip that has become faster by this part, however slow it is, nucleates.
inline constexpr double rest_growth = 0.1;

/// The slip rate that sends waves as strong as the strength: the mean of mu_s p over the interface, over the
/// radiation damping.
double slip_rate_scale_m_per_s(const statics::Equilibrium& state, const PerNode& mu_s, const Waves& waves);

/// Criterion of rest: nothing moves and nothing can (docs/numerics.md, End of an event). Times are those of
/// the event, s.
class RestCriterion final : public Observer {
 public:
  /// @param from_s   the loads of the trigger change until then
  /// @param quiet_s  after so long without motion the event ends
  RestCriterion(const TimeStepper& stepper, double slip_rate_scale_m_per_s, double from_s, double quiet_s);

  void at_update(const SlipUpdate& seen) override;
  bool after_step(const Now& now, const SlipRates& rates) override;
  std::int64_t guaranteed_steps(const Now& now) const override;
  void at_pause(Pause& pause) override;
  std::optional<End> end(Pause& pause) override;

  /// After each step: the fastest slip, to see whether it grows.
  void see_slip_rate(double time_s, double fastest_m_per_s);
  /// Where the kinetic energy is known. J/m
  void see_kinetic_energy(double time_s, double kinetic_J_per_m);
  /// Since when there has been nothing of all this.
  double since_s() const { return since_s_; }

  const char* name() const override { return "rest"; }
  void archive(StateArchive& archive) override {
    archive(since_s_, slowest_m_per_s_, largest_kinetic_J_per_m_);
  }
  void restored(Pause& pause) override;

 private:
  bool is_at_rest(const Now& now) const { return now.time_s() - since_s_ > quiet_s_; }

  double negligible_kinetic_J_per_m_;
  double from_s_, quiet_s_, since_s_;
  double slowest_m_per_s_ = 0;  ///< the least of the fastest slip rates since then
  double largest_kinetic_J_per_m_ = 0;
};

}  // namespace slipfront::motion
