// SPDX-License-Identifier: BSD-3-Clause
#include "input/table_along_x.hpp"

#include <cmath>

#include "base/error.hpp"
#include "files/fields.hpp"
#include "files/text.hpp"

namespace slipfront::input {

double number_in(std::string_view field, std::string_view column, const std::string& at) {
  const auto number = files::number_of(field);
  if (!number)
    throw UserError("{}: {} is \"{}\"; it must be a finite number", at, column, files::shortened(field));
  return *number;
}

void require_at_most(double value, double most, std::string_view column, const std::string& at) {
  if (std::abs(value) > most)
    throw UserError("{}: {} is {}; its magnitude must be at most {:g}", at, column, value, most);
}

void require_ascending(double x_m, const std::vector<double>& rows_x_m, const std::string& at) {
  if (!rows_x_m.empty() && x_m <= rows_x_m.back())
    throw UserError("{}: x_m is {} after {}; write the rows with x ascending", at, x_m, rows_x_m.back());
}

void require_covers(const std::vector<double>& rows_x_m, const std::vector<double>& x_m,
                    const std::string& place) {
  const double tolerance_m = position_tolerance * (x_m.back() - x_m.front());
  if (rows_x_m.front() > x_m.front() + tolerance_m || rows_x_m.back() < x_m.back() - tolerance_m)
    throw UserError(
        "{}: covers x = {:.6g} to {:.6g} m, the interface reaches from {:.6g} to {:.6g} m; add rows", place,
        rows_x_m.front(), rows_x_m.back(), x_m.front(), x_m.back());
}

}  // namespace slipfront::input
