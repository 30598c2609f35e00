// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/energy_rows.hpp"

#include <algorithm>
#include <functional>

namespace slipfront::motion {

/// More rows than that, 9 GB of them, are no more than asked for.
static constexpr double max_rows_in_advance = 1e8;

EnergyRows::EnergyRows(const record::Energies& start, double interval_s, double step_s, double end_s)
    : every_(interval_s) {
  // All that may come at once: while it grew, the rows would be there twice.
  rows_.reserve(
      static_cast<std::size_t>(std::min(end_s / std::max(interval_s, step_s) + 3, max_rows_in_advance)));
  rows_.push_back(start);
}

void EnergyRows::restored(Pause& pause) {
  const auto are_ascending = [](const auto& a, const auto& b) { return a.time_s < b.time_s; };
  require_possible(
      !rows_.empty() && rows_.front().time_s == 0 && rows_.back().time_s <= pause.now().time_s() &&
          std::ranges::adjacent_find(rows_, std::not_fn(are_ascending)) == rows_.end(),
      "energies");
}

}  // namespace slipfront::motion
