// SPDX-License-Identifier: BSD-3-Clause
#include "motion/time_stepper.hpp"

#include <algorithm>

namespace slipfront::motion {

Snapshot TimeStepper::snapshot() const {
  auto values = snapshot_chunk(0);
  for (int k = 1; k < n_snapshot_chunks(); ++k) {
    const auto chunk = snapshot_chunk(k);
    values.insert(values.end(), chunk.begin(), chunk.end());
  }
  if (values.empty()) return {time_s(), {}, {}};
  const auto n = static_cast<std::size_t>(n_nodes());
  Snapshot all{time_s(), solid::Field(n), solid::Field(n)};
  auto from = values.begin();
  for (auto* component : {&all.u_m.x, &all.u_m.y, &all.v_m_per_s.x, &all.v_m_per_s.y}) {
    std::copy_n(from, n, component->begin());
    from += static_cast<std::ptrdiff_t>(n);
  }
  return all;
}

}  // namespace slipfront::motion
