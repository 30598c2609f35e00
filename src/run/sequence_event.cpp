// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence_event.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/numbers.hpp"
#include "fronts/fit.hpp"

namespace slipfront::run {

record::SequenceEvent sequence_event(const Result& result, const InitialState& initial,
                                     const record::LoadingRow& before, const record::LoadingRow& after,
                                     const record::StaticState& tractions_after) {
  const auto& record = result.event.record;
  const auto& state = initial.supercritical;
  const auto is_inside = [&](std::int32_t node) { return state.is_inside(record.x_m[node]); };
  record::SequenceEvent e;
  e.begin_s = before.time_s;
  e.shear_m = before.shear_m;
  std::vector<bool> slips(record.x_m.size());
  std::vector<std::size_t> first;  // nodes that begin together
  double first_s = nan, last_s = nan;
  for (const auto& onset : record.onsets) {
    slips[onset.node] = true;
    if (!is_inside(onset.node)) continue;
    if (std::isnan(first_s)) first_s = onset.time_s;
    if (onset.time_s <= first_s + result.substep_s) first.push_back(static_cast<std::size_t>(onset.node));
  }
  if (!first.empty()) {
    // The first one along x where several patches begin.
    const auto begins = [&](std::size_t node) { return std::ranges::find(first, node) != first.end(); };
    auto from = first.front(), to = from;
    while (from > 0 && begins(from - 1)) --from;
    while (begins(to + 1)) ++to;
    e.begin_x_m = 0.5 * (record.x_m[from] + record.x_m[to]);
  }
  for (const auto& stop : record.stops)
    if (is_inside(stop.node)) last_s = stop.time_s;
  e.slip_s = last_s - first_s;
  e.is_global = 1;
  double drop_N_per_m = 0, patch_m = 0;
  for (std::size_t k = 0; k < slips.size(); ++k) {
    if (!slips[k]) {
      patch_m = 0;
      if (is_inside(static_cast<std::int32_t>(k))) e.is_global = 0;
      continue;
    }
    const double a = initial.tributary_m[k], slip_m = result.event.interface_at_end.slip_m[k];
    e.from_x_m = std::isnan(e.from_x_m) ? record.x_m[k] : e.from_x_m;
    e.to_x_m = record.x_m[k];
    e.length_m += a;
    e.longest_patch_m = std::max(e.longest_patch_m, patch_m += a);
    e.potency_m2 += slip_m * a;
    e.max_slip_m = std::max(e.max_slip_m, slip_m);
    drop_N_per_m += a * (state.tractions.t_s_Pa[k] - tractions_after.t_s_Pa[k]);
  }
  e.breakdown_work_J_per_m = result.event.breakdown.total_work_J_per_m(initial.tributary_m);
  e.nucleation_length_m = result.rupture.of_nodes.nucleation_length_m.value_or(nan);
  if (e.length_m > 0) {
    e.mean_slip_m = e.potency_m2 / e.length_m;
    e.stress_drop_Pa = drop_N_per_m / e.length_m;
  } else {
    e.is_global = 0;
  }
  e.normal_force_N_per_m = before.normal_force_N_per_m;
  e.shear_force_N_per_m = before.shear_force_N_per_m;
  e.friction_before = before.shear_over_normal;
  e.friction_after = after.shear_over_normal;
  e.released_J_per_m = before.energies.stored() - after.energies.stored();
  e.friction_work_J_per_m = -result.event.energies.back().friction_work;
  e.wave_loss_J_per_m = after.wave_loss_J_per_m - before.wave_loss_J_per_m;
  e.n_fronts = static_cast<double>(result.fronts.size());
  const auto longest =
      std::ranges::max_element(result.fronts, {}, [](const auto& f) { return f.points.size(); });
  if (longest != result.fronts.end()) {
    std::vector<double> speeds;
    for (const auto& point : longest->points) speeds.push_back(point.v_tip_m_per_s);
    e.median_speed_m_per_s = fronts::median(speeds);
  }
  return e;
}

}  // namespace slipfront::run
