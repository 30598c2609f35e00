// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront {

/// Memory that can be allocated without swapping and within the process's limit, bytes (Linux: MemAvailable,
/// RLIMIT_AS, RLIMIT_DATA).
double available_memory_bytes();

/// Gives freed memory back to the system that the allocator keeps, since it may lie between what is in use.
void return_freed_memory();

}  // namespace slipfront
