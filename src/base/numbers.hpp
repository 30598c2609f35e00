// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace slipfront {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace slipfront
