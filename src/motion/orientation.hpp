// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace slipfront::motion {

/// Bodies are numbered 0 above the interface and 1 below it. The one below is described upside down, y and
/// u_y pointing away from the interface into it. This is the sign of its u_y upwards and of its motion along
/// x in the relative one.
constexpr double sign_of_body(std::size_t body) {
  return body == 0 ? 1 : -1;
}

}  // namespace slipfront::motion
