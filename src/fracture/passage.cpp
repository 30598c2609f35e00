// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/passage.hpp"

#include <cmath>

namespace slipfront::fracture {

std::vector<Passage> passages(const fronts::Front& front, const record::Breakdown& breakdown,
                              const Bodies& bodies) {
  std::vector<Passage> all;
  all.reserve(front.points.size());
  for (const auto& point : front.points) {
    const auto node = static_cast<std::size_t>(point.node);
    Passage here;
    if (breakdown.complete.at(node) != 0) {
      here.stress_drop_Pa = std::abs(point.t_s_Pa) - breakdown.residual_t_Pa[node];
      here.cohesive_zone_m = point.v_tip_m_per_s * breakdown.time_s[node];
      here.K_Pa_sqrt_m =
          stress_intensity_Pa_sqrt_m(bodies, point.v_tip_m_per_s, breakdown.work_J_per_m2[node]);
    }
    all.push_back(here);
  }
  return all;
}

}  // namespace slipfront::fracture
