// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slipfront::io {

/// The fields of a line of comma-separated values, without blanks. An empty line has one empty field.
std::vector<std::string> fields_of(std::string_view line);

}  // namespace slipfront::io
