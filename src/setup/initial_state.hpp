// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "motion/ramp.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "setup/loads.hpp"
#include "setup/meshes.hpp"
#include "statics/statics.hpp"

namespace slipfront::setup {

/// What the statics have taken.
struct StaticsCost {
  std::int64_t n_unknowns = 0;
  statics::StaticSolver solver = statics::StaticSolver::automatic;  ///< automatic without any statics
  double solver_bytes = 0;                                          ///< held by it
  double wall_s = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(n_unknowns, solver, solver_bytes, wall_s);
  }
};

/// The loaded plate before any event: the same for all events of one plate, material, loading and mu_s, so
/// that it is computed once and shared. Where the tractions are prescribed, subcritical and supercritical are
/// that state, and there is no critical shear.
struct InitialState {
  mesh::Mesh mesh;                        ///< of the plate
  std::optional<mesh::Mesh> base;         ///< of the body below, upside down; none on the rigid plane
  std::int64_t n_nodes = 0, n_cells = 0;  ///< of both
  std::vector<double> tributary_m;        ///< [interface nodes]
  /// At t/p = (1 - critical_margin) mu_s inside, or under a given shear force.
  statics::Equilibrium subcritical;
  statics::Equilibrium supercritical;  ///< at (1 + critical_margin) mu_s; by the ramp: just before mu_s;
                                       ///< under a given shear force the subcritical one
  /// By how much mu_s has grown at rest [interface nodes]; none where it does not.
  std::vector<double> healed;
  /// States of friction, as in motion::Loads.
  std::vector<std::vector<double>> law_states;
  double critical_shear_m = 0;  ///< shear at t/p = mu_s inside, found directly, or behind slow slip
  StaticsCost cost;
  std::optional<motion::Ramp> ramp;    ///< where loading.method is ramp
  std::optional<ResolvedLoads> loads;  ///< where the case gives forces

  /// The state in which an event begins.
  const statics::Equilibrium& before(interface::EventKind event) const {
    return event == interface::EventKind::spontaneous ? supercritical : subcritical;
  }
  statics::Equilibrium& before(interface::EventKind event) {
    return event == interface::EventKind::spontaneous ? supercritical : subcritical;
  }
  /// Releases the displacements of all states but one.
  void release_displacements(const statics::Equilibrium* but = nullptr);

  /// All but the meshes.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(n_nodes, n_cells, tributary_m, subcritical, supercritical, healed, law_states, critical_shear_m,
            cost, ramp, loads);
  }
};

/// The bodies of a case without any load, after check.
InitialState unloaded_state(const Problem& problem, const Processes& processes = one_process());
/// Statics of a state's bodies, which have to stay where they are.
/// @throws as statics::Statics
statics::Statics statics_of(const Problem& problem, const InitialState& initial,
                            statics::Statics::MayContinue may_continue);
/// The solver that a problem's loading and shape ask for.
statics::StaticSolver wanted_solver(const Problem& problem);
/// Notes in a state by which solver it is found.
void describe_solver(const Problem& problem, const statics::Statics& statics, InitialState& initial);

/// Shown a ramp before its first step, with the monitor that is asked in it yet to be called.
using RampBegins = std::function<void(motion::Stepper& stepper, motion::RampRun& ramp)>;

/// @param processes  as above
/// @throws UserError, BlowUp, Interrupted as its parts do.
InitialState make_initial_state(const Problem& problem, const motion::Monitor& monitor,
                                const motion::Execution& execution = {}, const RampBegins& ramp_begins = {},
                                const Processes& processes = one_process());

struct LoadedState {
  ResolvedLoads loads;
  statics::Equilibrium subcritical;  ///< see InitialState
};
/// What the forces of a case come to, by its statics; under loading.method = ramp as if it was direct. None
/// where it gives none.
std::optional<LoadedState> loaded_state(const Problem& problem, const Meshes& meshes);

}  // namespace slipfront::setup

namespace slipfront {
using setup::InitialState;
}
