// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "base/message.hpp"
#include "input/case.hpp"

namespace slipfront::input {

/// Reads a CSV file with a header of x_m and any of the law's parameters, and a row per position, x
/// ascending. Lines that are empty or begin with # are passed over. The file is read once: it may be a pipe.
/// @param law  the case's; parameters without a column keep its values
/// @throws UserError with file, line and what to do.
FrictionTable read_friction_table(const std::filesystem::path& file, const interface::FrictionLaw& law);

/// The table's place in messages.
Message in_friction_file(const std::filesystem::path& file);

/// What is wrong with a law's parameters; empty where nothing is.
std::string fault_of(const interface::FrictionLaw& law);

}  // namespace slipfront::input
