// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "base/numbers.hpp"
#include "fracture/tip.hpp"
#include "fronts/front.hpp"
#include "record/breakdown.hpp"
#include "record/column.hpp"
#include "record/tip_slip.hpp"

namespace slipfront::fracture {

/// A front's passage over a node as that of the tip of a shear crack. What is undefined there is NaN.
struct Passage {
  double stress_drop_Pa = nan;
  double cohesive_zone_m = nan;
  double K_Pa_sqrt_m = nan;
  double G_slip_J_per_m2 = nan;
};

inline constexpr std::array<record::Column<Passage, double>, 4> passage_fields = {{
    {"stress_drop_Pa", "Pa", "t before the event less the residual traction", &Passage::stress_drop_Pa},
    {"cohesive_zone_m", "m", "length behind the tip in which friction weakens: v_tip times weakening_time",
     &Passage::cohesive_zone_m},
    {"K_Pa_sqrt_m", "Pa m1/2",
     "stress intensity factor of the breakdown work at v_tip, below the limiting speed",
     &Passage::K_Pa_sqrt_m},
    {"G_slip_J_per_m2", "J/m2", "energy release rate by the slip 1.5 to 4 cohesive zones behind the tip",
     &Passage::G_slip_J_per_m2},
}};

/// What a run knows of its interface besides the fronts.
struct Recorded {
  const std::vector<double>& x_m;  ///< [nodes]
  const record::Breakdown& breakdown;
  const record::TipSlip& tip_slip;
};

/// Tip states at all points of a front.
///
/// G_slip: at a row of tip_slip with its tip at the node slip^2 behind follows a parabola in r, whose slope
/// where it is 0 is slip_squared_per_G_and_distance times G; its curvature is that of a crack of finite
/// length. The speed is that of the least-squares line through the onsets within two cohesive zones.
/// Undefined from the limiting speed on.
std::vector<Passage> passages(const fronts::Front& front, const Recorded& recorded, const Bodies& bodies);

}  // namespace slipfront::fracture
