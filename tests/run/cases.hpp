// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "run/run.hpp"
#include "setup/cases.hpp"

namespace slipfront::test {

inline run::Result run_case(const input::Case& config) {
  const auto problem = make_problem(config);
  return run::run_from(problem, setup::make_initial_state(problem, go_on), go_on);
}

}  // namespace slipfront::test
