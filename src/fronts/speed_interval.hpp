// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront::fronts {

/// Where the length l* lies over which the tip's speed is taken, against the node at x.
enum class SpeedInterval {
  centred,   ///< x - l*/2 to x + l*/2
  approach,  ///< x - l* to x: from where t_d and p_d are taken to where t_r and p_r are
};

}  // namespace slipfront::fronts
