// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

namespace slipfront {

/// Linear between places, constant beyond the first and the last.
/// @pre as many places, ascending, as values, at least one
inline double interpolated(const std::vector<double>& places, const std::vector<double>& values,
                           double place) {
  const auto next = std::ranges::upper_bound(places, place) - places.begin();
  if (next == 0) return values.front();
  if (next == std::ssize(places)) return values.back();
  const double part = (place - places[next - 1]) / (places[next] - places[next - 1]);
  return values[next - 1] + part * (values[next] - values[next - 1]);
}

}  // namespace slipfront
