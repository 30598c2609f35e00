// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/numbers.hpp"
#include "results/folder.hpp"
#include "run/checkpoint.hpp"
#include "run/run.hpp"

namespace slipfront::run {

/// What a run under way is asked for from outside.
enum class Request {
  none,
  keep,  ///< a checkpoint, now
  stop,  ///< a checkpoint, and an end
};

/// Threads of one run: one for so many nodes that a step takes longer than waking a thread does, few enough
/// to leave most of a large machine to others, and no more than processors.
int suitable_threads(const Problem& problem);

struct SessionOptions {
  std::optional<int> threads;                ///< by default suitable_threads
  double keep_every_wall_s = 300;            ///< wall time between checkpoints
  double keep_every_s = infinity;            ///< simulated time between them
  std::optional<std::string> shared_states;  ///< folder of SharedStates, see there
  /// Makes the state in which the event begins, on rank 0; else it is that of the case.
  std::function<InitialState()> initial_state;
  /// Makes further observers of the event, where it begins and where it goes on.
  std::function<motion::Observers()> observers;
  Processes* processes = &one_process();  ///< the ranks that share the event
};

/// All three are called by the thread that steps.
struct SessionHooks {
  /// Told the progress of "ramp" or "event".
  std::function<void(const char* part, std::int64_t step, std::int64_t total)> progress;
  std::function<Request()> request;
  std::function<void(const std::string& note)> note;
};

/// A run that has come to its end.
struct Finished {
  Result result;
  InitialState initial;
};

/// The kind of work that a run is, see results::ResultFolder.
inline constexpr const char* run_work = "run";

/// Runs a case of one event into its folder. While it goes, DIR/unfinished has the case, run.json with its
/// status, and what there is of the results; every now and then a checkpoint is kept there, from which resume
/// goes on. A run that is complete is published to DIR; one that was interrupted or blew up stays where it
/// is.
/// @throws UserError and BlowUp, nothing being kept but the reason where there was no event yet;
/// Interrupted in ramp or statics; WriteError, what there is being kept.
Finished run_into(results::ResultFolder& folder, const Problem& problem, const SessionOptions& options,
                  const SessionHooks& hooks);

/// Goes on with a run that was left unfinished, as if it had never stopped: from its last checkpoint that is
/// intact, or from its beginning where there is none. Ramps solve their statics again.
/// @param expected  a case that it must be, or null
/// @throws UserError where there is none, or it is one of another program or case
Finished resume(results::ResultFolder& folder, const Problem* expected, const SessionOptions& options,
                const SessionHooks& hooks);

/// Begins the work of a case in its folder.
/// @throws WriteError, nothing being kept
void begin_work(results::ResultFolder& folder, const Problem& problem);
/// The case of the work that was left unfinished in a folder.
/// @param expected  a case that it must be, or null
/// @throws UserError where there is none, or it is another case
Problem unfinished_case(const results::ResultFolder& folder, const Problem* expected);
/// That work, with its last checkpoint that is intact, or null.
struct UnfinishedWork {
  Problem problem;
  std::unique_ptr<Checkpoints::Checkpoint> kept;
  int sessions = 1;  ///< so far
};
/// @param note  receives a message for each damaged checkpoint
/// @throws UserError as unfinished_case, and where the checkpoint is of another program or case
UnfinishedWork load_unfinished(const results::ResultFolder& folder, const Problem* expected,
                               const std::function<void(const std::string&)>& note);

/// On the ranks but 0: their parts of the runs that rank 0 begins or goes on with, until it releases them.
void serve_ranks(Processes& processes);
void stop_ranks(Processes& processes);

/// What to tell of a run that has not come to its end, and how to go on with it.
std::string what_was_kept(const results::ResultFolder& folder);
std::string how_to_resume(const results::ResultFolder& folder);
/// @throws BlowUp, Interrupted where the event ended so, with what was kept.
void require_came_to_end(const Result& result, const results::ResultFolder& folder);

/// Whether a folder has the results of a run that is complete.
bool is_complete(const std::filesystem::path& dir);

}  // namespace slipfront::run
