// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/rest_criterion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipfront::motion {

double slip_rate_scale_m_per_s(const statics::Equilibrium& state, const PerNode& mu_s, const Waves& waves) {
  const auto& p_Pa = state.tractions.p_s_Pa;
  double strength_Pa = 0;
  for (std::size_t k = 0; k < p_Pa.size(); ++k) strength_Pa += mu_s[k] * std::max(0.0, p_Pa[k]);
  return strength_Pa / static_cast<double>(p_Pa.size()) / waves.radiation_damping_Pa_s_per_m;
}

RestCriterion::RestCriterion(const TimeStepper& stepper, double slip_rate_scale_m_per_s, double from_s,
                             double quiet_s)
    : from_s_(from_s), quiet_s_(quiet_s), since_s_(from_s) {
  const double v = rest_slip_fraction * slip_rate_scale_m_per_s;
  negligible_kinetic_J_per_m_ = 0.5 * stepper.mass_kg_per_m() * v * v;
}

void RestCriterion::at_update(const SlipUpdate& seen) {
  if (seen.moves || std::ranges::any_of(seen.changes, &SlipChange::begins))
    since_s_ = std::max(since_s_, seen.time_s);
}

bool RestCriterion::after_step(const Now& now, const SlipRates& rates) {
  see_slip_rate(now.time_s(), rates.fastest_slipping_m_per_s);
  return !is_at_rest(now);
}

std::int64_t RestCriterion::guaranteed_steps(const Now& now) const {
  // A step less, since the sum may be rounded up.
  return std::max<std::int64_t>(steps_until(now, since_s_ + quiet_s_) - 1, 1);
}

void RestCriterion::at_pause(Pause& pause) {
  if (pause.known_energies())
    see_kinetic_energy(pause.now().time_s(), pause.known_energies()->kinetic);
  else if (is_at_rest(pause.now()))
    see_kinetic_energy(pause.now().time_s(), pause.stepper().kinetic_energy_J_per_m());
}

std::optional<End> RestCriterion::end(Pause& pause) {
  if (!is_at_rest(pause.now())) return {};
  return End{EventEnd::quiet};
}

/// The trigger may yet act.
void RestCriterion::restored(Pause& pause) {
  require_possible(since_s_ >= from_s_ && since_s_ <= std::max(pause.now().time_s(), from_s_) &&
                       slowest_m_per_s_ >= 0 && std::isfinite(slowest_m_per_s_) &&
                       largest_kinetic_J_per_m_ >= 0 && std::isfinite(largest_kinetic_J_per_m_),
                   "times of motion");
}

void RestCriterion::see_slip_rate(double time_s, double fastest_m_per_s) {
  if (fastest_m_per_s > (1 + rest_growth) * slowest_m_per_s_) {
    since_s_ = std::max(since_s_, time_s);
    slowest_m_per_s_ = fastest_m_per_s;
  }
  slowest_m_per_s_ = std::min(slowest_m_per_s_, fastest_m_per_s);
}

void RestCriterion::see_kinetic_energy(double time_s, double kinetic_J_per_m) {
  largest_kinetic_J_per_m_ = std::max(largest_kinetic_J_per_m_, kinetic_J_per_m);
  const double counts =
      std::max(negligible_kinetic_J_per_m_, rest_kinetic_fraction * largest_kinetic_J_per_m_);
  if (kinetic_J_per_m > counts) since_s_ = std::max(since_s_, time_s);
}

}  // namespace slipfront::motion
