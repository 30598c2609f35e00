// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slipfront::record {

/// Slip behind the tips of slip at some times, one row per time and tip. A row is of a node that has begun to
/// slip for the first time since the times before, beside one that never has.
struct TipSlip {
  /// Nodes behind the tip's whose slip is kept, ascending from 1: all of the first ones, then some eight to
  /// an octave.
  std::vector<std::int32_t> steps_behind;
  std::vector<double> time_s;           ///< [rows]
  std::vector<std::int32_t> node;       ///< [rows] the last one that slips
  std::vector<std::int32_t> direction;  ///< [rows] +1 or -1 along x
  std::vector<double> slip_m;           ///< [rows x steps] not a number beyond nodes that have slipped

  std::size_t n_rows() const { return time_s.size(); }
  std::span<const double> slip_of(std::size_t row) const {
    return std::span(slip_m).subspan(row * steps_behind.size(), steps_behind.size());
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(steps_behind, time_s, node, direction, slip_m);
  }
};

/// As far as a thousand nodes.
inline std::vector<std::int32_t> default_steps_behind() {
  std::vector<std::int32_t> steps;
  for (double step = 1; step < 1025; step = std::max(step + 1, std::round(step * std::exp2(0.125))))
    steps.push_back(static_cast<std::int32_t>(step));
  return steps;
}

}  // namespace slipfront::record
