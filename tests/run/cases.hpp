// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "run/run.hpp"

namespace slipfront::test {

/// The paper's plate on a mesh that a run takes milliseconds for.
inline input::Case coarse_case(interface::EventKind event = interface::EventKind::spontaneous,
                               double element_size_m = 4e-3) {
  input::Case config;
  config.plate.element_size_m = element_size_m;
  config.event = event;
  return config;
}

inline interface::VelocityWeakening& law(input::Case& config) {
  return std::get<interface::VelocityWeakening>(config.friction);
}

inline bool go_on(std::int64_t, std::int64_t) {
  return true;
}

}  // namespace slipfront::test
