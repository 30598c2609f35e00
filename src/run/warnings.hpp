// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/case.hpp"

namespace slipfront::run {

/// What is allowed in a case but is hardly meant, a line each.
std::vector<std::string> warnings_of_case(const io::Case& config);

}  // namespace slipfront::run
