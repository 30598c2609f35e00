// SPDX-License-Identifier: BSD-3-Clause
#include "setup/loads.hpp"

#include "base/error.hpp"

namespace slipfront::setup {

bool has_forces(const Problem& problem) {
  const auto& loading = problem.loading;
  return statics::normal_force_N_per_m(loading, problem.width_m()) || statics::is_sheared_by_force(loading);
}

statics::Equilibrium common_state(const Problem& problem, const statics::Statics& statics,
                                  const statics::Equilibrium& critical, std::span<const double> tributary_m) {
  const auto& loading = problem.loading;
  if (!statics::is_sheared_by_force(loading)) return statics.shear_to(1 - loading.critical_margin);
  constexpr double rounding = 1e-9;
  const double critical_N_per_m = statics::contact_force(critical, tributary_m).shear_N_per_m;
  if (loading.shear_over_critical)
    return statics.shear_to_force(*loading.shear_over_critical * critical_N_per_m);
  const double wanted_N_per_m = *loading.shear_force_N_per_m;
  if (wanted_N_per_m > (1 + rounding) * critical_N_per_m)
    throw UserError(
        "{} is {:.10g} N/m, beyond the critical one, {:.10g} N/m, at which t/p inside reaches mu_s; reduce "
        "it, "
        "or set {} = spontaneous without it",
        Key("loading.shear_force_N_per_m"), wanted_N_per_m, critical_N_per_m, Key("event.kind"));
  return statics.shear_to_force(wanted_N_per_m);
}

ResolvedLoads resolved_loads(const Problem& problem, const statics::Statics& statics,
                             const statics::Equilibrium& critical, const statics::Equilibrium& subcritical,
                             std::span<const double> tributary_m) {
  const double normal_N_per_m = statics::contact_force(statics.tilted(), tributary_m).normal_N_per_m;
  return {normal_N_per_m,
          normal_N_per_m / problem.width_m(),
          statics.loading().tilt_left_m,
          statics.loading().tilt_right_m,
          statics::contact_force(subcritical, tributary_m).shear_N_per_m,
          subcritical.shear_m,
          statics::contact_force(critical, tributary_m).shear_N_per_m,
          critical.shear_m};
}

}  // namespace slipfront::setup
