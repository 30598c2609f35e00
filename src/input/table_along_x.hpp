// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "base/message.hpp"

// What tables of quantities along the interface have in common. `at` is the place of a row, with its key and
// file, `place` that of the table, in messages.
namespace slipfront::input {

/// Tolerance over the interface's length: positions in a table are written with few digits.
inline constexpr double position_tolerance = 1e-6;

/// @throws UserError where a field is no finite number
double number_in(std::string_view field, std::string_view column, const Message& at);

/// @throws UserError
void require_at_most(double value, double most, std::string_view column, const Message& at);

/// Refuses a position that does not come after those of the rows before. @throws UserError
void require_ascending(double x_m, const std::vector<double>& rows_x_m, const Message& at);

/// Refuses rows that do not reach from the first to the last of the positions x_m, but for the tolerance.
/// @throws UserError
void require_covers(const std::vector<double>& rows_x_m, const std::vector<double>& x_m,
                    const Message& place);

}  // namespace slipfront::input
