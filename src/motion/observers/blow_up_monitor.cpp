// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/blow_up_monitor.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace slipfront::motion {

namespace {

/// Most steps between two looks at the energy.
constexpr std::int64_t energy_check_interval = 100;

/// Energy may exceed what was supplied by this part of it,
constexpr double tolerated_excess = 0.01;
/// and by the coupling's work up to this part. That work swings with waves as short as the elements, by 1.2 %
/// where an undamped plate's edge is set in motion at once; where sub-cycling is unstable it grows beyond all
/// bounds.
constexpr double tolerated_coupling = 0.1;

/// A part of the energy that the tractions could bring about. They cancel at a node that sticks, but for
/// rounding, 1e-16 of them; the plate then moves with at most 1e-16 times the number of steps of the velocity
/// that they could give it, and has the square of that as its energy: 1e-12 leaves room for 1e10 steps. Slip
/// that matters releases far more: a drop of 1 % of the stress over 1 % of the plate's area is 1e-6.
constexpr double negligible_part = 1e-12;

/// Every step leaves 1e-16 of the terms: room for 1e10 steps. Single precision leaves more.
constexpr double balance_tolerance = 1e-6;

double supplied_J_per_m(const record::Energies& now, const record::Energies& start) {
  // Rounding may leave less than nothing of a plate at rest.
  return std::max(0.0, start.stored()) + std::abs(now.far_edge_work) + std::abs(now.trigger_work) +
         std::abs(now.prestress_work) + std::max(0.0, -now.machine);
}

/// What of the case gives the plate most of its energy.
const char* strongest_load(const record::Energies& now, const record::Energies& start) {
  struct Load {
    double energy_J_per_m;
    const char* keys;
  };
  const std::array<Load, 4> loads = {{
      {std::abs(now.trigger_work),
       "event.trigger_over_missing, trigger_over_strength or trigger_unloading, or nucleation.overstress_Pa "
       "or "
       "unloading_Pa of a patch"},
      {std::abs(now.prestress_work), "prestress.t_Pa, or the tractions in prestress.file"},
      {std::abs(now.far_edge_work), "loading.shear_speed_m_per_s"},
      {start.stored(),
       "loading.tilt_left_m and loading.tilt_right_m, or the force or pressures given instead"},
  }};
  return std::ranges::max_element(loads, {}, &Load::energy_J_per_m)->keys;
}

}  // namespace

bool BlowUpMonitor::after_step(const Now& /*now*/, const SlipRates& rates) {
  if (!rates.finite) {
    failure_ = "the slip rate is not a number";
  } else if (rates.fastest_m_per_s > c_L_m_per_s_) {
    failure_ = fmt::format("the slip rate has grown to {:.3g} m/s, above c_L", rates.fastest_m_per_s);
  }
  return failure_.empty();
}

std::int64_t BlowUpMonitor::steps_to_pause(const Now& now) const {
  return checked_step_ + energy_check_interval - now.step;
}

void BlowUpMonitor::at_pause(Pause& pause) {
  if (failure_.empty() && !pause.known_energies() && steps_to_pause(pause.now()) > 0) return;
  checked_step_ = pause.now().step;
  const auto& energies = pause.energies();
  if (failure_.empty()) failure_ = energy_failure(energies);
  if (!failure_.empty()) failure_ += "; " + remedy(energies);
}

std::optional<End> BlowUpMonitor::end(Pause& pause) {
  if (failure_.empty()) return {};
  return End{EventEnd::blow_up, fmt::format("the run blew up at step {} (t = {:.6g} s): {}", pause.now().step,
                                            pause.now().time_s(), failure_)};
}

/// The motion is not to be checked yet, and its energies balance.
void BlowUpMonitor::restored(Pause& pause) {
  const auto step = pause.now().step;
  require_possible(checked_step_ >= 0 && checked_step_ <= step && steps_to_pause(pause.now()) > 0, "steps");
  require_possible(balances(pause.energies()), "a motion");
}

bool BlowUpMonitor::balances(const record::Energies& now) const {
  double largest = 0;
  for (const auto& term : record::energy_terms)
    largest = std::max({largest, std::abs(now.*term.member), std::abs(start_.*term.member)});
  const double imbalance = std::abs(record::imbalance_J_per_m(now, start_));
  if (!std::isfinite(imbalance) || precision_ == Precision::single_precision) return std::isfinite(imbalance);
  const double tolerated = balance_tolerance * largest;
  return imbalance <= tolerated ||
         imbalance <= tolerated + negligible_part * stepper_.energy_of_tractions_J_per_m();
}

std::string BlowUpMonitor::energy_failure(const record::Energies& now) const {
  const double total = now.stored();
  if (!std::isfinite(total)) return "the energy is not a number";
  if (!is_from_nowhere(total, now))
    return balances(now) ? ""
                         : fmt::format("{:.4g} J/m of energy are left open", imbalance_J_per_m(now, start_));
  return fmt::format("the energy has grown to {:.4g} J/m with {:.4g} J/m supplied", total,
                     supplied_J_per_m(now, start_));
}

bool BlowUpMonitor::is_from_nowhere(double energy_J_per_m, const record::Energies& now) const {
  const double supplied = supplied_J_per_m(now, start_);
  return energy_J_per_m > (1 + tolerated_excess) * supplied +
                              std::clamp(now.coupling_work, 0.0, tolerated_coupling * supplied) +
                              negligible_part * stepper_.energy_of_tractions_J_per_m();
}

std::string BlowUpMonitor::remedy(const record::Energies& now) const {
  // Above the stable step, the strain energy between two places falls as the kinetic energy grows: their sum
  // tells nothing.
  const bool numerical = stepper_.lowest_step_s() > (1 + 1e-9) * stepper_.stable_step_s() ||
                         is_from_nowhere(std::max(now.kinetic, now.stored()), now);
  if (numerical) return "reduce time.step_factor";
  if (std::isfinite(now.stored()) && !balances(now)) return "start a new run";
  return fmt::format("the work of the loads accounts for the energy: reduce {}", strongest_load(now, start_));
}

}  // namespace slipfront::motion
