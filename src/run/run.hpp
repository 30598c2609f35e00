// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "advice/outlook.hpp"
#include "base/diagnostic.hpp"
#include "fracture/passage.hpp"
#include "fronts/front.hpp"
#include "motion/distributed_stepper.hpp"
#include "motion/event.hpp"
#include "problem/problem.hpp"
#include "record/sequence.hpp"
#include "results/contents.hpp"
#include "results/outputs.hpp"
#include "setup/initial_state.hpp"
#include "setup/snapshot_mesh.hpp"
#include "solid/material.hpp"

namespace slipfront::run {

/// What several ranks have spent on an event, since they began or went on with it.
struct SharedCost {
  motion::Partition partition;
  std::vector<motion::SubdomainCost> of_subdomains;
};

/// A run with all it found.
struct Result {
  Problem problem;
  solid::WaveSpeeds speeds;  ///< of the plate
  double stable_step_s = 0, step_s = 0, substep_s = 0;
  double node_updates_per_step = 0;
  double stepping_wall_s = 0;
  motion::Event event;
  results::KeptOutputs rows;  ///< those that were not written while it went
  std::vector<fronts::Front> fronts;
  std::vector<std::vector<fracture::Passage>> passages;  ///< of each front, at its points
  advice::RuptureOutlook rupture;
  Diagnostics notes;                 ///< see notes_of_case, and of the event
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

/// The case, the steps and an event, without fronts yet. Collective.
Result collect(const Problem& problem, const motion::TimeStepper& stepper, motion::Event event);
/// Finds the fronts of a result's event, and what its reader should know.
/// @param outlook  of its initial state
void analyse(Result& result, const InitialState& initial, const advice::RuptureOutlook& outlook);
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
results::SnapshotContents snapshot_contents(const Problem& problem, const setup::SnapshotMesh& mesh);

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

/// What to know of a sequence by its events.
Diagnostics notes_of_sequence(const Problem& problem, std::span<const record::SequenceEvent> events);

/// sequence.json, events.csv and loading.csv of a sequence so far.
/// @param end  why it ended, in words; empty before
void write_sequence(const std::filesystem::path& dir, const Problem& problem, const Diagnostics& notes,
                    std::span<const record::SequenceEvent> events,
                    std::span<const record::LoadingRow> loading, const std::string& end,
                    const Status& status);

}  // namespace slipfront::run
