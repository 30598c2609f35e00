// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "input/case.hpp"
#include "processes/message_buffer.hpp"

namespace slipfront::run {

/// The case itself and not its file, which the other machines may see late or not at all; without a table of
/// prescribed tractions.
void pack_case(const input::Case& config, MessageBuffer& to);
input::Case unpack_case(MessageBuffer& from);

}  // namespace slipfront::run
