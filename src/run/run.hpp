// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fracture/passage.hpp"
#include "fronts/front.hpp"
#include "mesh/mesh.hpp"
#include "motion/event.hpp"
#include "problem/problem.hpp"
#include "record/sequence.hpp"
#include "results/contents.hpp"
#include "results/outputs.hpp"
#include "run/initial_state.hpp"
#include "run/mesh_choice.hpp"
#include "run/needs.hpp"
#include "run/outlook.hpp"
#include "run/snapshot_mesh.hpp"
#include "run/subdomains.hpp"
#include "stability/verdict.hpp"
#include "statics/statics.hpp"

namespace slipfront::run {

/// Wave speeds in the plane chosen, m/s.
struct WaveSpeeds {
  double c_L = 0, c_S = 0, c_R = 0;
};
WaveSpeeds wave_speeds(const solid::Material& material);

/// What several ranks have spent on an event, since they began or went on with it.
struct SharedCost {
  motion::Partition partition;
  std::vector<motion::SubdomainCost> of_subdomains;
};

/// A run with all it found.
struct Result {
  Problem problem;
  WaveSpeeds speeds;  ///< of the plate
  double stable_step_s = 0, step_s = 0, substep_s = 0;
  double node_updates_per_step = 0;
  double stepping_wall_s = 0;
  motion::Event event;
  results::KeptOutputs rows;  ///< those that were not written while it went
  std::vector<fronts::Front> fronts;
  std::vector<std::vector<fracture::Passage>> passages;  ///< of each front, at its points
  RuptureOutlook rupture;
  std::vector<std::string> warnings;
  std::optional<SharedCost> shared;  ///< of several ranks

  /// What cannot be made again from the case and the initial state, see analyse.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(stable_step_s, step_s, substep_s, node_updates_per_step, stepping_wall_s, event);
  }
};

/// An event that has come to its end, with the state in which it began, without displacements.
struct FinishedEvent {
  Result result;
  InitialState initial;
};

/// With which a case's event begins.
motion::Loads loads_of_event(const Problem& problem, const InitialState& initial);

/// The bodies in a case's initial state, about to move. Takes what only this needs out of the initial state:
/// displacements, nodes and cells, near 100 bytes a node. The initial state then serves for this event alone.
/// @param processes  the ranks that share it
std::unique_ptr<motion::TimeStepper> start_event(const Problem& problem, InitialState& initial,
                                                 const motion::Execution& execution = {},
                                                 Processes& processes = one_process());

/// Stepper of the same plate without its motion, which is to be read from where it was kept.
std::unique_ptr<motion::TimeStepper> make_stepper(const Problem& problem, InitialState& initial,
                                                  const motion::Execution& execution = {},
                                                  Processes& processes = one_process());

/// The event of a case, about to begin with a started stepper; see motion::EventRun.
/// @param sinks  of its outputs
motion::EventRun begin_event(const Problem& problem, const InitialState& initial,
                             motion::TimeStepper& stepper, const motion::Monitor& monitor,
                             const results::Sinks& sinks, motion::Observers more = {});

/// The case, the steps and an event, without fronts yet. Collective.
Result collect(const Problem& problem, const motion::TimeStepper& stepper, motion::Event event);
/// Finds the fronts of a result's event, and what its reader should know.
/// @param outlook  of its initial state
void analyse(Result& result, const InitialState& initial, const RuptureOutlook& outlook);
void analyse(Result& result, const InitialState& initial);

/// Computes the event of a case from its initial state and finds its fronts. A blow-up or an interruption
/// ends the event early; event.end says which.
/// @param started  by start_event
/// @param more    further observers
Result run_from(const Problem& problem, const InitialState& initial, motion::TimeStepper& started,
                const motion::Monitor& monitor, motion::Observers more = {});
/// Starts the event as well, and leaves the initial state as it is.
Result run_from(const Problem& problem, const InitialState& initial, const motion::Monitor& monitor,
                const motion::Execution& execution = {}, motion::Observers more = {});

/// Why an event ended, in words.
std::string end_of_event(const Result& result);

/// How a case's fronts are measured.
fronts::FrontOptions front_options(const Problem& problem, const InitialState& initial);

/// How a run stands, as run.json tells it.
struct Status {
  std::string name = "complete";  ///< running, interrupted, blew_up, failed, complete
  std::string reason = {};
  int sessions = 1;  ///< times that the run was begun or gone on with
};
/// The sessions that a run.json or sequence.json tells of; 0 where there is none, or a damaged one.
int sessions_of(const std::filesystem::path& file);
/// Status of a run that has ended.
Status status_of(const Result& result);
/// What it may write so.
results::Numbers numbers_of(const Status& status);

inline constexpr const char* run_file = "run.json";
/// Where a sequence has ended that is complete: from there it goes on when it is extended.
inline constexpr const char* end_file = "sequence.state";
/// What run.json is of a run, of a sequence.
inline constexpr const char* sequence_file = "sequence.json";
/// What a case's fields.vtkhdf holds besides.
results::SnapshotContents snapshot_contents(const Problem& problem, const SnapshotMesh& mesh);

/// static.csv: tractions of the common state and, where they vary, the parameters of friction.
void write_static(const std::filesystem::path& dir, const Problem& problem, const InitialState& initial);

/// Writes the run's folder, which is there: case.resolved.toml with its tables, run.json, interface.h5,
/// fronts.csv, static.csv, energy.csv, fields.vtkhdf where there are snapshots, and their checksums.
void write(const std::filesystem::path& dir, const Result& result, const InitialState& initial);
/// run.json, fronts.csv and energy.csv of a result that may go on. It needs no more than the first and the
/// last of the energies, which may be many.
void write_so_far(const std::filesystem::path& dir, const Result& result,
                  std::span<const record::Energies> energies, const InitialState& initial,
                  const Status& status);
/// run.json of a run without an event yet, or that has come to none.
void write_status(const std::filesystem::path& dir, const Problem& problem, const Status& status);

/// sequence.json, events.csv and loading.csv of a sequence so far.
/// @param end  why it ended, in words; empty before
void write_sequence(const std::filesystem::path& dir, const Problem& problem,
                    std::span<const record::SequenceEvent> events,
                    std::span<const record::LoadingRow> loading, const std::string& end,
                    const Status& status);

/// Derived quantities of a case, found without solving anything but the statics of loads given as forces.
struct Info {
  /// A division among ranks, and what a run by them takes.
  struct Shared {
    motion::Partition partition;
    double bytes_per_step = 0;     ///< that the rank with most neighbours sends in exchanges
    double expected_s = 0;         ///< as if messages took no time
    double efficiency = 0;         ///< share of the event's time that goes into own columns
    double root_memory_bytes = 0;  ///< of rank 0
    double memory_bytes = 0;       ///< of each other one
  };

  WaveSpeeds speeds;                                         ///< of the plate
  std::optional<WaveSpeeds> base_speeds;                     ///< of the body below
  std::optional<double> generalised_rayleigh_speed_m_per_s;  ///< of the two, where it exists
  std::int64_t n_nodes = 0, n_cells = 0, n_interface = 0;
  std::optional<std::int64_t> n_irregular;  ///< none where not all of the bodies was made
  double stable_step_s = 0, step_s = 0, substep_s = 0;
  std::vector<int> substeps_of_bodies;  ///< in a step of each, the plate first
  Needs needs;
  std::int64_t n_steps = 0;                                         ///< of the event, to time.end_s
  double node_updates = 0;                                          ///< of the event and of the ramp
  double memory_bytes = 0;                                          ///< the largest of statics and event
  statics::StaticSolver solver = statics::StaticSolver::automatic;  ///< of the statics, auto without any
  double solver_bytes = 0;                                          ///< of the statics, estimated
  double expected_s = 0;          ///< at the kernel rate measured on the spot, statics estimated
  double node_updates_per_s = 0;  ///< measured on the spot
  RuptureOutlook rupture;
  std::optional<MeshChoice> cheapest_mesh;
  stability::WellPosedness well_posedness;  ///< at the plate's nominal pressure; see its has_verdict
  /// Where friction varies along x the node of which that is, with the fastest growth; else not a number.
  double well_posedness_x_m = nan;
  std::optional<Shared> shared;
  std::optional<ResolvedLoads> loads;  ///< see loaded_state
  std::vector<std::string> notes;      ///< see notes_of_case
};

/// What a run takes. Of a case that root_has_interface_only only columns of one rank are made.
/// @param n_processes  ranks that are to share the run, each with a processor
/// @throws UserError where the plate cannot be divided among so many
Info info(const Problem& problem, const std::optional<int>& n_processes = {});

}  // namespace slipfront::run
