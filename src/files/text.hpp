// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/message.hpp"

namespace slipfront::files {

/// Reads a file from its beginning to its end, once: it may be a pipe. A byte order mark is left out.
/// @param shown       the file in messages
/// @param what        it is, for messages: "case file"
/// @param max_bytes  larger files are refused
/// @throws UserError
std::string read_text(const std::filesystem::path& file, const Message& shown, std::string_view what,
                      std::size_t max_bytes);

/// The line, from 1, of the first byte that is no UTF-8; 0 where all are.
int line_outside_utf8(std::string_view text);

/// The text for a message: control characters, line breaks among them, as spaces; what is no UTF-8 as "?".
std::string one_line(std::string_view text);

/// The same, cut where it is long.
std::string shortened(std::string_view text);

}  // namespace slipfront::files
