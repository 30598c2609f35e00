// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "base/message.hpp"

namespace slipfront {

/// Memory that can be allocated without swapping, bytes (Linux: MemAvailable).
double available_memory_bytes();

/// Refuses work that needs more than nine tenths of the memory available, before anything is allocated.
/// @throws UserError "<what> needs ... GB, ... GB are available; <remedy>".
void require_memory(double bytes, std::string_view what, const Message& remedy);

}  // namespace slipfront
