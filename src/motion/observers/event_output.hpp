// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "motion/time_stepper.hpp"
#include "record/probes.hpp"
#include "record/record.hpp"

namespace slipfront::motion {

/// Takes what an event gives while it goes.
class EventOutput {
 public:
  virtual ~EventOutput() = default;
  /// One row of the history.
  virtual void sample(const record::History& row) = 0;
  /// It is time for a snapshot.
  virtual void snapshot(TimeStepper& stepper) = 0;
  /// Rows of what the stepper's probes record; not asked without probes.
  virtual void probe(const record::ProbeRecord& rows) = 0;
};

/// An output in memory.
struct KeptOutput final : EventOutput {
  record::History history;
  std::vector<Snapshot> snapshots;
  record::ProbeRecord probes;

  void sample(const record::History& row) override {
    history.law_states.resize(row.law_states.size());
    record::append_rows(members_of(history), members_of(row));
  }
  void snapshot(TimeStepper& stepper) override { snapshots.push_back(stepper.snapshot()); }
  void probe(const record::ProbeRecord& rows) override {
    record::append_rows(members_of(probes, record::probe_fields), members_of(rows, record::probe_fields));
  }
};

}  // namespace slipfront::motion
