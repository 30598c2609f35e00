// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "motion/plain_stepper.hpp"
#include "motion/ramp.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "run/loads.hpp"
#include "statics/statics.hpp"

namespace slipfront::run {

/// The loaded plate before any event: the same for all events of one plate, material, loading and mu_s, so
/// that it is computed once and shared. Where the tractions are prescribed, subcritical and supercritical are
/// that state.
struct InitialState {
  mesh::Mesh mesh;                        ///< of the plate
  std::optional<mesh::Mesh> base;         ///< of the body below, upside down; none on the rigid plane
  std::int64_t n_nodes = 0, n_cells = 0;  ///< of both
  std::vector<double> tributary_m;        ///< [interface nodes]
  /// At t/p = (1 - critical_margin) mu_s inside, or under a given shear force.
  statics::Equilibrium subcritical;
  statics::Equilibrium supercritical;  ///< at (1 + critical_margin) mu_s; by the ramp: just before mu_s;
                                       ///< under a given shear force the subcritical one
  bool prescribed = false;             ///< loading.method is prestress: no statics, no critical shear
  std::vector<double> mu_s;            ///< [interface nodes] where friction varies along x, else none
  /// By how much mu_s has grown at rest [interface nodes]; none where it does not.
  std::vector<double> healed;
  /// States of friction, as in motion::Loads.
  std::vector<std::vector<double>> law_states;
  double critical_shear_m = 0;  ///< shear at t/p = mu_s inside, found directly, or behind slow slip
  std::int64_t n_unknowns = 0;
  statics::StaticSolver solver = statics::StaticSolver::automatic;  ///< of the statics, auto without any
  double solver_bytes = 0;                                          ///< held by it
  double wall_s = 0;
  std::optional<motion::Ramp> ramp;    ///< where loading.method is ramp
  std::optional<ResolvedLoads> loads;  ///< where the case gives forces

  /// Releases the displacements of all states but one.
  void release_displacements(const statics::Equilibrium* but = nullptr);

  /// All but the meshes.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(n_nodes, n_cells, tributary_m, subcritical, supercritical, prescribed, mu_s, healed, law_states,
            critical_shear_m, n_unknowns, solver, solver_bytes, wall_s, ramp, loads);
  }
};

/// The plate's mesh, and that of the body below where there is one, upside down.
struct Meshes {
  mesh::Mesh plate;
  std::optional<mesh::Mesh> base;
  std::vector<double> mu_s = {};  ///< as in InitialState
};

/// Checks what can be checked without solving anything: memory, geometry, rows of the interface layer. The
/// meshes are those of the interfaces alone where root_has_interface_only says so.
/// @param processes  the ranks that share the run
/// @throws UserError
Meshes check(const Problem& problem, const Processes& processes = one_process());

/// Checks the interfaces alone, whatever the memory.
Meshes check_interfaces(const Problem& problem);

/// Numbers of a body of which the interface may be all that is held.
std::int64_t n_nodes_of(const mesh::Mesh& mesh);
std::int64_t n_cells_of(const mesh::Mesh& mesh);

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

/// Where a case's probes lie in its bodies, of which the interfaces may be all that is held.
/// @throws UserError where one lies outside
std::vector<motion::Probe> probes_of(const Problem& problem, const mesh::Mesh& plate,
                                     const std::optional<mesh::Mesh>& base);

/// The bodies without their motion.
std::unique_ptr<motion::Stepper> new_stepper(const Problem& problem, const mesh::Mesh& plate,
                                             const std::optional<mesh::Mesh>& base,
                                             const std::vector<double>& healed = {},
                                             const motion::Execution& execution = {});
std::unique_ptr<motion::PlainStepper> new_plain_stepper(const Problem& problem, const mesh::Mesh& plate,
                                                        const std::optional<mesh::Mesh>& base,
                                                        const std::vector<double>& healed = {});
/// A new stepper, fast or by the plain scheme, as the problem says.
std::unique_ptr<motion::TimeStepper> new_time_stepper(const Problem& problem, const InitialState& initial,
                                                      const motion::Execution& execution = {});

}  // namespace slipfront::run
