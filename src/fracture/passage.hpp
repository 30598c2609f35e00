// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "base/numbers.hpp"
#include "fracture/tip.hpp"
#include "fronts/front.hpp"
#include "record/breakdown.hpp"
#include "record/column.hpp"

namespace slipfront::fracture {

/// A front's passage over a node as that of the tip of a shear crack. What is undefined there is NaN.
struct Passage {
  double stress_drop_Pa = nan;
  double cohesive_zone_m = nan;
  double K_Pa_sqrt_m = nan;
};

inline constexpr std::array<record::Column<Passage, double>, 3> passage_fields = {{
    {"stress_drop_Pa", "Pa", "t before the event less the residual traction", &Passage::stress_drop_Pa},
    {"cohesive_zone_m", "m", "length behind the tip in which friction weakens: v_tip times weakening_time",
     &Passage::cohesive_zone_m},
    {"K_Pa_sqrt_m", "Pa m1/2",
     "stress intensity factor of the breakdown work at v_tip, below the shear speed", &Passage::K_Pa_sqrt_m},
}};

/// Of all points of a front.
/// @param breakdown  of the nodes of the interface
std::vector<Passage> passages(const fronts::Front& front, const record::Breakdown& breakdown,
                              const Bodies& bodies);

}  // namespace slipfront::fracture
