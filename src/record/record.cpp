// SPDX-License-Identifier: BSD-3-Clause
#include "record/record.hpp"

#include <algorithm>
#include <cmath>

namespace slipfront::record {

bool is_consistent(const SlipRecord& record) {
  const auto is_node = [&](const auto& change) {
    return change.node >= 0 && static_cast<std::size_t>(change.node) < record.x_m.size() &&
           std::isfinite(change.time_s);
  };
  return record.halo >= 0 && std::isfinite(record.resolution_s) &&
         record.around.size() == record.onsets.size() * (2 * static_cast<std::size_t>(record.halo) + 1) &&
         std::ranges::all_of(record.onsets, is_node) && std::ranges::all_of(record.stops, is_node);
}

}  // namespace slipfront::record
