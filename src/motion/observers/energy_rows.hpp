// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "motion/observer.hpp"

namespace slipfront::motion {

/// Keeps the energies at the start, at an interval, and at the end.
class EnergyRows final : public Observer {
 public:
  /// @param end_s  makes room for all until then
  EnergyRows(const record::Energies& start, double interval_s, double step_s, double end_s)
      : every_(interval_s) {
    // Room for all rows at the start: a vector that grows holds them twice. At most 9 GB of them.
    constexpr double max_rows_in_advance = 1e8;
    rows_.reserve(
        static_cast<std::size_t>(std::min(end_s / std::max(interval_s, step_s) + 3, max_rows_in_advance)));
    rows_.push_back(start);
  }

  const std::vector<record::Energies>& rows() const { return rows_; }
  std::vector<record::Energies> take_rows() { return std::move(rows_); }

  std::int64_t steps_to_pause(const Now& now) const override { return every_.steps_to_next(now); }
  void at_pause(Pause& pause) override {
    if (every_.is_due(pause.now())) add(pause);
  }
  void at_end(Pause& pause) override { add(pause); }

  const char* name() const override { return "energies"; }
  void archive(StateArchive& archive) override { archive(rows_); }
  void restored(Pause& pause) override {
    const auto are_ascending = [](const auto& a, const auto& b) { return a.time_s < b.time_s; };
    require_possible(!rows_.empty() && rows_.front().time_s == 0 &&
                         rows_.back().time_s <= pause.now().time_s() &&
                         std::ranges::adjacent_find(rows_, std::not_fn(are_ascending)) == rows_.end(),
                     "energies");
  }

 private:
  void add(Pause& pause) {
    if (rows_.back().time_s < pause.now().time_s()) rows_.push_back(pause.energies());
  }

  Every every_;
  std::vector<record::Energies> rows_;
};

}  // namespace slipfront::motion
