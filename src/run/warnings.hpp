// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "input/case.hpp"

namespace slipfront::run {

/// What is allowed in a case but is hardly meant, a line each.
std::vector<std::string> warnings_of_case(const input::Case& config);

}  // namespace slipfront::run
