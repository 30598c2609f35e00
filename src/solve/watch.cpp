// SPDX-License-Identifier: BSD-3-Clause
#include "solve/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slipfront::solve {

namespace {

/// Most steps between two looks at the energy.
constexpr std::int64_t energy_check_interval = 100;

}  // namespace

Watch::Watch(Stepper& stepper, double c_L_m_per_s) : Watch(stepper, c_L_m_per_s, stepper.energies(), 0) {}

Watch::Watch(Stepper& stepper, double c_L_m_per_s, const Energies& start, std::int64_t checked_step)
    : stepper_(stepper), c_L_m_per_s_(c_L_m_per_s), start_(start), checked_step_(checked_step) {}

bool Watch::look() {
  double fastest = 0;
  bool finite = true;
  for (const double v : stepper_.interface_state().slip_rate_m_per_s) {
    finite &= std::isfinite(v);
    fastest = std::max(fastest, std::abs(v));
  }
  if (!finite) {
    trouble_ = "the slip rate is not a number";
  } else if (fastest > c_L_m_per_s_) {
    trouble_ = fmt::format("the slip rate has grown to {:.3g} m/s, above c_L", fastest);
  }
  return trouble_.empty();
}

std::int64_t Watch::steps_to_check() const {
  return checked_step_ + energy_check_interval - stepper_.step();
}

std::string Watch::trouble(const Energies* known) {
  if (!trouble_.empty()) return trouble_;
  if (known == nullptr && steps_to_check() > 0) return {};
  checked_step_ = stepper_.step();
  const Energies e = known != nullptr ? *known : stepper_.energies();
  const double total = e.stored();
  if (!std::isfinite(total)) return "the energy is not a number";
  const double supplied =
      start_.stored() + std::abs(e.top_work) + std::abs(e.trigger_work) + std::abs(e.prestress_work);
  if (total > 1.01 * supplied)
    return fmt::format("the energy has grown to {:.4g} J/m with {:.4g} J/m supplied", total, supplied);
  return {};
}

std::string blow_up_message(const Stepper& stepper, const std::string& trouble) {
  return fmt::format("the run blew up at step {} (t = {:.6g} s): {}; reduce time.step_factor", stepper.step(),
                     stepper.time_s(), trouble);
}

}  // namespace slipfront::solve
