// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront {

/// Memory that can be allocated without swapping and within the process's limit, bytes (Linux: MemAvailable,
/// RLIMIT_AS).
double available_memory_bytes();

}  // namespace slipfront
