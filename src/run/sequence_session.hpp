// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "record/sequence.hpp"
#include "run/session.hpp"

namespace slipfront::run {

/// A sequence that has come to its end.
struct FinishedSequence {
  std::vector<record::SequenceEvent> events;
  std::vector<record::LoadingRow> loading;
  std::string end;  ///< why, in words
};

/// Called after each event, with its number from 1.
using EventDone = std::function<void(std::size_t number, const record::SequenceEvent& event)>;

/// Runs a case that is a sequence into its folder: events.csv, loading.csv, sequence.json, and each event in
/// a folder of its own, events/0001 and so on, as a run's. What was computed stays in DIR/unfinished until
/// all of it is published.
/// @throws UserError, also where an event does not come to rest; BlowUp, Interrupted, WriteError as run_into
FinishedSequence run_sequence_into(results::ResultFolder& folder, const Problem& problem,
                                   const SessionOptions& options, const SessionHooks& hooks,
                                   const EventDone& done);

/// Goes on with a sequence that was left unfinished, as if it had never stopped.
/// @param expected  a case that it must be, or null
/// @throws as resume
FinishedSequence resume_sequence(results::ResultFolder& folder, const Problem* expected,
                                 const SessionOptions& options, const SessionHooks& hooks,
                                 const EventDone& done);

}  // namespace slipfront::run
