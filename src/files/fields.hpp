// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slipfront::files {

/// Calls take(line, fields) for every line of comma-separated values, lines counted from 1. Lines that are
/// empty or begin with # are passed over. Fields come without the blanks around them.
void for_each_row(std::string_view text,
                  const std::function<void(int line, const std::vector<std::string_view>& fields)>& take);

/// The number that a field is; nothing where it is no finite decimal number.
std::optional<double> number_of(std::string_view field);

}  // namespace slipfront::files
