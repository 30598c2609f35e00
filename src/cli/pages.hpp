// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/program.hpp"

/// What is made of the command line's own declarations and installed with the program.
namespace slipfront::cli {

/// Section 1 of the manual, for man.
std::string man_page(const CommandDescription& program);

/// Completion for bash. @param keys  of a case file, which --set takes
std::string bash_completion(const CommandDescription& program, const std::vector<std::string>& keys);

}  // namespace slipfront::cli
