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
    const auto append = [&](const auto& column) {
      auto& to = history.*column.member;
      to.insert(to.end(), (row.*column.member).begin(), (row.*column.member).end());
    };
    append(record::history_time);
    for (const auto& field : record::history_fields) append(field);
  }
  void snapshot(TimeStepper& stepper) override { snapshots.push_back(stepper.snapshot()); }
  void probe(const record::ProbeRecord& rows) override {
    probes.time_s.insert(probes.time_s.end(), rows.time_s.begin(), rows.time_s.end());
    for (const auto& field : record::probe_fields) {
      auto& to = probes.*field.member;
      to.insert(to.end(), (rows.*field.member).begin(), (rows.*field.member).end());
    }
  }
};

}  // namespace slipfront::motion
