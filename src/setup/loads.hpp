// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "problem/problem.hpp"
#include "statics/statics.hpp"

// Loads that a case gives as forces of the interface, per unit thickness.
namespace slipfront::setup {

/// What the forces of a case come to, and the displacements of the loaded edge that give them.
struct ResolvedLoads {
  double normal_force_N_per_m = 0;           ///< before any shear
  double mean_pressure_Pa = 0;               ///< the same over plate.width_m
  double tilt_left_m = 0, tilt_right_m = 0;  ///< down
  double shear_force_N_per_m = 0;            ///< of the subcritical state
  double shear_m = 0;                        ///< of the loaded edge to +x, in the subcritical state
  double critical_shear_force_N_per_m = 0;   ///< at which t/p first reaches mu_s inside
  double critical_shear_m = 0;               ///< the same of the loaded edge

  template <class Archive>
  void serialize(Archive& archive) {
    archive(normal_force_N_per_m, mean_pressure_Pa, tilt_left_m, tilt_right_m, shear_force_N_per_m, shear_m,
            critical_shear_force_N_per_m, critical_shear_m);
  }
};

/// Whether a case gives any load as a force.
bool has_forces(const Problem& problem);

/// The state before triggered events, by static equilibria: at the margin below the critical shear, or under
/// the shear force that the case gives.
/// @param critical  statics.shear_to(1)
/// @throws UserError where no shear gives that, or the force is beyond the critical one
statics::Equilibrium common_state(const Problem& problem, const statics::Statics& statics,
                                  const statics::Equilibrium& critical, std::span<const double> tributary_m);

/// @param subcritical       state before triggered events
/// @param tributary_m  [interface nodes]
ResolvedLoads resolved_loads(const Problem& problem, const statics::Statics& statics,
                             const statics::Equilibrium& critical, const statics::Equilibrium& subcritical,
                             std::span<const double> tributary_m);

}  // namespace slipfront::setup
