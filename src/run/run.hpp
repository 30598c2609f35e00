// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fronts/front.hpp"
#include "io/case.hpp"
#include "mesh/mesh.hpp"
#include "run/needs.hpp"
#include "solve/event.hpp"
#include "solve/statics.hpp"
#include "stability/verdict.hpp"

namespace slipfront::run {

/// The loaded plate before any event: the same for all events of one plate, material, loading and mu_s, so
/// that it is computed once and shared. Where the tractions are prescribed, common and spontaneous are that
/// state.
struct InitialState {
  mesh::Mesh mesh;
  std::int64_t n_nodes = 0, n_cells = 0;
  std::vector<double> tributary_m;  ///< [lower]
  solve::Equilibrium common;        ///< at t/p = (1 - critical_margin) mu_s inside
  solve::Equilibrium spontaneous;   ///< at (1 + critical_margin) mu_s; by the ramp: just before mu_s
  bool prescribed = false;          ///< loading.method is prestress: no statics, no critical shear
  double critical_shear_m = 0;      ///< shear at t/p = mu_s inside, found directly
  std::int64_t n_unknowns = 0;
  solve::StaticSolver solver = solve::StaticSolver::automatic;  ///< of the statics, auto without any
  double solver_bytes = 0;                                      ///< held by it
  double wall_s = 0;
  std::optional<solve::Ramp> ramp;  ///< where loading.method is ramp
};

/// Checks what can be checked without solving anything: memory, geometry, rows of the interface layer.
/// @return the mesh.
/// @throws UserError
mesh::Mesh check(const io::Case& config);

/// @throws UserError, BlowUp, Interrupted as its parts do.
InitialState make_initial_state(const io::Case& config, const solve::Monitor& monitor,
                                const solve::Execution& execution = {});

/// A text that is the same for two cases if and only if they share their initial state.
std::string initial_state_key(const io::Case& config);

/// Wave speeds in the plane chosen, m/s.
struct WaveSpeeds {
  double c_L = 0, c_S = 0, c_R = 0;
};
WaveSpeeds wave_speeds(const solid::Material& material);

/// A run with all it found.
struct Result {
  io::Case config;
  WaveSpeeds speeds;
  double stable_step_s = 0, step_s = 0, substep_s = 0;
  double node_updates_per_step = 0;
  double stepping_wall_s = 0;
  solve::Event event;
  std::vector<fronts::Front> fronts;
  std::vector<std::string> warnings;
};

/// The plate in a case's initial state, about to move. Takes what only this needs out of the initial state:
/// displacements, nodes and cells, near 100 bytes a node. The initial state then serves for this event alone.
std::unique_ptr<solve::Stepper> start_event(const io::Case& config, InitialState& initial,
                                            const solve::Execution& execution = {});

/// Computes the event of a case from its initial state and finds its fronts. A blow-up or an interruption
/// ends the event early and is told by event.end.
/// @param started  by start_event
/// @param sink     takes samples and snapshots; without one the event keeps them
Result run_event(const io::Case& config, const InitialState& initial, solve::Stepper& started,
                 const solve::Monitor& monitor, solve::Sink* sink = nullptr);
/// Starts the event as well, and leaves the initial state as it is.
Result run_event(const io::Case& config, const InitialState& initial, const solve::Monitor& monitor,
                 const solve::Execution& execution = {});

/// How a case's fronts are measured.
fronts::FrontOptions front_options(const io::Case& config, const InitialState& initial);

/// Writes the run's folder: case.resolved.toml, run.json, interface.h5, fronts.csv, static.csv, and
/// fields.vtkhdf where there are snapshots. The folder must have been prepared (io::prepare_output_folder).
void write(const std::filesystem::path& dir, const Result& result, const InitialState& initial);
/// The same but for interface.h5 and fields.vtkhdf, which were written while the run went (io::ResultStream).
void write_beside_stream(const std::filesystem::path& dir, const Result& result, const InitialState& initial);

/// Derived quantities of a case, found without solving anything.
struct Info {
  WaveSpeeds speeds;
  std::int64_t n_nodes = 0, n_cells = 0, n_interface = 0, n_irregular = 0;
  double stable_step_s = 0, step_s = 0, substep_s = 0;
  Needs needs;
  std::int64_t n_steps = 0;                                     ///< of the event, to time.end_s
  double node_updates = 0;                                      ///< of the event and of the ramp
  double memory_bytes = 0;                                      ///< the largest of statics and event
  solve::StaticSolver solver = solve::StaticSolver::automatic;  ///< of the statics, auto without any
  double solver_bytes = 0;                                      ///< of the statics, estimated
  double expected_s = 0;                    ///< at the kernel rate measured on the spot, statics estimated
  double node_updates_per_s = 0;            ///< measured on the spot
  stability::WellPosedness well_posedness;  ///< at the plate's nominal pressure
};
Info info(const io::Case& config);

}  // namespace slipfront::run
