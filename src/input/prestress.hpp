// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "input/case.hpp"

namespace slipfront::input {

/// Reads a CSV file with the header x_m,t_Pa,p_Pa and a row per position, x ascending, p > 0. Lines that are
/// empty or begin with # are passed over. The file is read once: it may be a pipe.
/// @throws UserError with file, line and what to do.
PrestressTable read_prestress(const std::filesystem::path& file);

/// Tractions of the table at the positions x_m, linear between its rows.
/// @throws UserError where the table does not reach from the first to the last of them.
record::StaticState prestress_at(const Prestress& prestress, const std::vector<double>& x_m);

}  // namespace slipfront::input
