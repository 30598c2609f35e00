// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "input/friction_along_x.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "run/run.hpp"
#include "support/files.hpp"

namespace slipfront::test {

/// The paper's plate on a mesh that a run takes milliseconds for.
inline input::Case coarse_case(interface::EventKind event = interface::EventKind::spontaneous,
                               double element_size_m = 4e-3) {
  input::Case config;
  config.plate.element_size_m = element_size_m;
  config.event = event;
  return config;
}

/// Parameters of a case's velocity weakening.
struct LawOfCase {
  double &mu_s, &mu_k, &alpha_m2_per_s2;
};
inline LawOfCase law(input::Case& config) {
  auto& friction = config.friction;
  return {friction.parameter("mu_s"), friction.parameter("mu_k"), friction.parameter("alpha_m2_per_s2")};
}

/// Gives a case a table of friction.
inline void set_table(input::Case& config, const std::string& text) {
  const TemporaryFolder folder;
  const auto file = folder / "friction.csv";
  write_file(file, text);
  config.friction_along_x.file = file.string();
  config.friction_along_x.table = input::read_friction_table(file, config.friction);
}

inline bool go_on(std::int64_t, std::int64_t) {
  return true;
}

}  // namespace slipfront::test
