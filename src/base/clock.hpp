// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace slipfront {

/// Wall time that no setting of the machine's clock changes.
using Clock = std::chrono::steady_clock;

inline double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

inline double seconds_since(Clock::time_point start) {
  return seconds_between(start, Clock::now());
}

}  // namespace slipfront
