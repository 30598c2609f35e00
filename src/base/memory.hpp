// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront {

/// Memory that can be allocated without swapping, bytes (Linux: MemAvailable).
double available_memory_bytes();

}  // namespace slipfront
