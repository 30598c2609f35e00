// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace slipfront::cli {

/// Prints what a command was asked to tell, to the end. @throws WriteError where standard output takes no
/// more; a reader who has gone (a closed pipe) wants no more.
void print_output(std::string_view text);

/// Flushes what has been printed before, with the same errors.
void finish_output();

}  // namespace slipfront::cli
