// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "record/record.hpp"

namespace slipfront::results {

/// Numbers that are all different, most with no shorter decimal.
inline record::History made_history(std::size_t n_rows, std::size_t n_nodes, std::size_t first_row = 0) {
  record::History h;
  for (std::size_t i = 0; i < n_nodes; ++i) h.x_m.push_back(0.1 * static_cast<double>(i));
  for (std::size_t k = first_row; k < first_row + n_rows; ++k) {
    h.time_s.push_back(1e-6 * static_cast<double>(k));
    for (std::size_t i = 0; i < n_nodes; ++i)
      for (std::size_t f = 0; f < record::history_fields.size(); ++f)
        (h.*record::history_fields[f].member)
            .push_back(static_cast<double>(k * n_nodes + i) + 0.2 * static_cast<double>(f));
  }
  return h;
}

inline bool equal(const record::History& a, const record::History& b) {
  return a.time_s == b.time_s && a.x_m == b.x_m &&
         std::ranges::all_of(record::history_fields,
                             [&](const auto& field) { return a.*field.member == b.*field.member; });
}

}  // namespace slipfront::results
