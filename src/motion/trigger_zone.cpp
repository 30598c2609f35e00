// SPDX-License-Identifier: BSD-3-Clause
#include "motion/trigger_zone.hpp"

#include <algorithm>
#include <cmath>

#include "base/numbers.hpp"

namespace slipfront::motion {

std::vector<std::size_t> trigger_zone(const statics::Equilibrium& state, interface::EventKind kind,
                                      double zone_m) {
  const auto& x_m = state.tractions.x_m;
  std::vector<std::size_t> zone;
  if (kind != interface::EventKind::left && kind != interface::EventKind::right) return zone;
  const auto in_contact = [&](std::size_t k) { return state.contact[k] != statics::Contact::open; };
  double first = infinity, last = -first;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    if (!in_contact(k)) continue;
    first = std::min(first, x_m[k]);
    last = std::max(last, x_m[k]);
  }
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    const double from_edge = kind == interface::EventKind::left ? x_m[k] - first : last - x_m[k];
    if (in_contact(k) && from_edge <= zone_m * (1 + 1e-9)) zone.push_back(k);
  }
  return zone;
}

double load_direction(const statics::Equilibrium& state, std::span<const double> tributary_m,
                      std::span<const std::size_t> zone) {
  double force = 0;
  for (const auto k : zone) force += state.tractions.t_s_Pa[k] * tributary_m[k];
  return force < 0 ? -1 : 1;
}

namespace {

/// What `added` and `raised` add to a traction.
double trigger_traction_Pa(const interface::Trigger& trigger, double t_s_Pa, double strength_Pa) {
  // A node that slips before the event is at its strength but for this share of its traction.
  constexpr double rounding = 1e-9;
  const double added_Pa = trigger.form == interface::TriggerForm::added
                              ? trigger.amount * (strength_Pa - t_s_Pa)
                              : trigger.amount * strength_Pa - t_s_Pa;
  return added_Pa < -rounding * t_s_Pa ? 0 : added_Pa;
}

}  // namespace

std::vector<double> trigger_forces(const statics::Equilibrium& state, std::span<const double> tributary_m,
                                   interface::EventKind kind, const interface::Trigger& trigger,
                                   const PerNode& mu_s) {
  const auto& s = state.tractions;
  std::vector<double> force(s.x_m.size(), 0.0);
  if (trigger.form != interface::TriggerForm::added && trigger.form != interface::TriggerForm::raised)
    return force;
  const auto zone = trigger_zone(state, kind, trigger.zone_m);
  const double direction = load_direction(state, tributary_m, zone);
  for (const auto k : zone)
    force[k] = direction * trigger_traction_Pa(trigger, direction * s.t_s_Pa[k], mu_s[k] * s.p_s_Pa[k]) *
               tributary_m[k];
  return force;
}

int halo_for(const mesh::Mesh& mesh, double l_star_m) {
  return static_cast<int>(std::ceil(l_star_m / mesh.grid.spacing_m - 0.01)) + 1;
}

double last_change_s(const interface::Trigger& trigger) {
  const double ramp_s = std::isfinite(trigger.ramp_s) ? trigger.ramp_s : 0;
  return std::isfinite(trigger.duration_s) ? std::max(ramp_s, trigger.duration_s) : ramp_s;
}

}  // namespace slipfront::motion
