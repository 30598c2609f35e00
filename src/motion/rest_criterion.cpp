// SPDX-License-Identifier: BSD-3-Clause
#include "motion/rest_criterion.hpp"

#include <algorithm>
#include <numeric>

namespace slipfront::motion {

double slip_rate_scale_m_per_s(const statics::Equilibrium& state, const PerNode& mu_s, const Waves& waves) {
  const auto& p_Pa = state.tractions.p_s_Pa;
  double strength_Pa = 0;
  for (std::size_t k = 0; k < p_Pa.size(); ++k) strength_Pa += mu_s[k] * std::max(0.0, p_Pa[k]);
  return strength_Pa / static_cast<double>(p_Pa.size()) / waves.radiation_damping_Pa_s_per_m;
}

RestCriterion::RestCriterion(const TimeStepper& stepper, double slip_rate_scale_m_per_s, double from_s)
    : from_s_(from_s), since_s_(from_s) {
  const double v = rest_slip_fraction * slip_rate_scale_m_per_s;
  negligible_kinetic_J_per_m_ = 0.5 * stepper.mass_kg_per_m() * v * v;
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
