// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/numbers.hpp"
#include "record/sequence.hpp"
#include "results/folder.hpp"
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
  /// Makes further observers of each event, where it begins and where it goes on.
  std::function<motion::Observers()> observers;
  Processes* processes = &one_process();  ///< the ranks that share the events
};

/// All are called by the thread that steps.
struct SessionHooks {
  /// Told the progress of a part, "ramp" or "event", in a sequence "event 1" and so on.
  std::function<void(const char* part, std::int64_t step, std::int64_t total)> progress;
  std::function<Request()> request;
  std::function<void(const std::string& note)> note;
  /// Told each event of a sequence that has come to rest, with its number from 1.
  std::function<void(std::size_t number, const record::SequenceEvent& event)> event_done = {};
};

/// A run that has come to its end.
struct Finished {
  FinishedEvent last;  ///< its event; of a sequence the last one of this session
  /// Of a sequence.
  std::vector<record::SequenceEvent> events = {};
  std::vector<record::LoadingRow> loading = {};
  Diagnostics notes = {};
  std::string end = {};  ///< why, in words
};

/// The kind of work that a run is, see results::ResultFolder.
inline constexpr const char* run_work = "run";

/// Runs a problem into its folder: one event, or a sequence of them, each in a folder of its own, events/0001
/// and so on. While it goes, DIR/unfinished has the case, run.json or sequence.json with its status, and what
/// there is of the results; every now and then a checkpoint is kept there, from which resume goes on. A run
/// that is complete is published to DIR; one that was interrupted or blew up stays where it is.
/// @throws UserError and BlowUp, nothing being kept but the reason where there was no event yet; of a
/// sequence also where an event does not come to rest, blows up, or is interrupted. Interrupted in ramp,
/// statics or slow slip; WriteError, what there is being kept.
Finished run_into(results::ResultFolder& folder, const Problem& problem, const SessionOptions& options,
                  const SessionHooks& hooks);

/// Goes on with a run that was left unfinished, as if it had never stopped: from its last checkpoint that is
/// intact, or from its beginning where there is none. Ramps solve their statics again.
/// Or goes on with a sequence that is complete, where its last event has left it, to a later end; its results
/// stay until it is complete again.
/// @param expected  a problem whose case it must be, or which continues the complete one; or null
/// @throws UserError where there is none, or it is one of another program or case, or finished parts were
/// changed
Finished resume(results::ResultFolder& folder, const Problem* expected, const SessionOptions& options,
                const SessionHooks& hooks);

/// Whether a folder's results are complete, so that there is nothing to go on with.
/// @param expected  a problem whose case they must be, or which continues them (see is_continuation); or null
/// @throws UserError where it is another one
bool is_done(const results::ResultFolder& folder, const Problem* expected);

/// Collective. @throws on rank 0 UserError where another rank is another program
void require_same_program(Processes& processes);
/// On the ranks but 0: their parts of the events that rank 0 begins or goes on with, until it releases them.
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
