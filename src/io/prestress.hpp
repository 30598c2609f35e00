// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "fronts/record.hpp"

namespace slipfront::io {

/// Tractions along an interface before the event, as given in a table. [rows]
using PrestressTable = fronts::StaticState;

/// Reads a CSV file with the header x_m,t_Pa,p_Pa and a row per position, x ascending, p > 0. Lines that are
/// empty or begin with # are passed over.
/// @throws UserError with file, line and what to do.
PrestressTable read_prestress(const std::filesystem::path& file);

/// Tractions at the positions x_m, linear between the rows of the table.
/// @throws UserError where the table does not reach from the first to the last of them.
fronts::StaticState prestress_at(const PrestressTable& table, const std::vector<double>& x_m,
                                 const std::filesystem::path& file);

}  // namespace slipfront::io
