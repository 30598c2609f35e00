// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/observer.hpp"
#include "motion/observers/event_output.hpp"

namespace slipfront::motion {

/// Gives rows of the history to an output, at an interval.
class HistoryRows final : public Observer {
 public:
  HistoryRows(double interval_s, std::size_t n_nodes, EventOutput& output)
      : every_(interval_s), n_nodes_(n_nodes), output_(output) {}
  bool wants_row(const Now& now) const override { return every_.is_due(now); }
  void take_row(const record::History& row) override {
    output_.sample(row);
    last_ = row;
  }
  /// The last one, without places; empty before the first.
  const record::History& last() const { return last_; }

  const char* name() const override { return "history"; }
  void archive(StateArchive& archive) override {
    for (auto* values : record::members_of(last_, record::history_fields)) archive(*values);
    archive(last_.law_states);
  }
  void restored(Pause& /*pause*/) override {
    const std::size_t n_rows = last_.time_s.size();
    bool fits = n_rows <= 1;
    for (const auto& field : record::history_fields)
      fits = fits && (last_.*field.member).size() == n_rows * n_nodes_;
    require_possible(fits, "rows");
  }

 private:
  Every every_;
  std::size_t n_nodes_;
  EventOutput& output_;
  record::History last_;
};

}  // namespace slipfront::motion
