// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "record/record.hpp"
#include "record/sequence.hpp"
#include "run/run.hpp"

namespace slipfront::run {

/// What events.csv tells of an event, but for its predicted ends.
/// @param initial          in which it has begun
/// @param before, after    rows of the loading where it begins and at rest behind it
/// @param tractions_after  of that equilibrium
record::SequenceEvent sequence_event(const Result& result, const InitialState& initial,
                                     const record::LoadingRow& before, const record::LoadingRow& after,
                                     const record::StaticState& tractions_after);

}  // namespace slipfront::run
