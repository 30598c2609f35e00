// SPDX-License-Identifier: BSD-3-Clause
#include "solve/recorder.hpp"

#include <algorithm>
#include <cmath>

#include "base/lanes.hpp"

namespace slipfront::solve {

namespace {

bool any_slips_faster(double speed_m_per_s, const interface::Interface& s) {
  const auto in_lanes = [&](LanesMask slipping, Lanes slip_rate_m_per_s) {
    return any(slipping && absolute(slip_rate_m_per_s) > speed_m_per_s);
  };
  std::size_t i = 0;
  for (; i + lanes <= s.size(); i += lanes)
    if (in_lanes(load(&s.slipping[i]), load(&s.slip_rate_m_per_s[i]))) return true;
  const int rest = static_cast<int>(s.size() - i);
  return rest > 0 && in_lanes(load_part(&s.slipping[i], rest), load_part(&s.slip_rate_m_per_s[i], rest));
}

}  // namespace

Recorder::Recorder(const Equilibrium& before, double mu_s, int halo, double creep_m_per_s)
    : creep_m_per_s_(creep_m_per_s),
      previous_t_Pa_(before.tractions.t_s_Pa),
      previous_p_Pa_(before.tractions.p_s_Pa) {
  for (const double p : previous_p_Pa_) previous_strength_Pa_.push_back(mu_s * p);
  record_.x_m = before.tractions.x_m;
  record_.halo = halo;
  for (const auto contact : before.contact) {
    previous_slipping_.push_back(contact == Contact::slip);
    n_slipping_ += previous_slipping_.back();
  }
}

void Recorder::observe(double time_s, const interface::Interface& state, bool changed) {
  if (changed) {
    for (std::size_t i = 0; i < state.size(); ++i) {
      if (state.slipping[i] == previous_slipping_[i]) continue;
      if (state.slipping[i] != 0) {
        add_onset(i, time_s, state);
        ++n_slipping_;
      } else {
        record_.stops.push_back({static_cast<std::int32_t>(i), time_s});
        --n_slipping_;
      }
      previous_slipping_[i] = state.slipping[i];
    }
  }
  if (n_slipping_ > 0 && any_slips_faster(creep_m_per_s_, state)) last_motion_s_ = time_s;
  std::ranges::copy(state.t_Pa, previous_t_Pa_.begin());
  std::ranges::copy(state.p_Pa, previous_p_Pa_.begin());
  std::ranges::copy(state.strength_Pa, previous_strength_Pa_.begin());
  previous_time_s_ = time_s;
}

void Recorder::add_onset(std::size_t node, double time_s, const interface::Interface& state) {
  // |t| / strength passes 1 between the last time and this one; a node without strength, open or not, has no
  // ratio to interpolate and begins to slip now.
  double part = 1;
  const double strength_before = previous_strength_Pa_[node], strength_now = state.strength_Pa[node];
  if (strength_before > 0 && strength_now > 0 && time_s > previous_time_s_) {
    const double before = std::abs(previous_t_Pa_[node]) / strength_before;
    const double now = state.demand_Pa[node] / strength_now;
    if (now > before) part = std::clamp((1 - before) / (now - before), 0.0, 1.0);
  }
  record_.onsets.push_back(
      {static_cast<std::int32_t>(node), previous_time_s_ + part * (time_s - previous_time_s_)});
  for (int k = -record_.halo; k <= record_.halo; ++k) {
    const auto i = static_cast<std::ptrdiff_t>(node) + k;
    if (i < 0 || i >= static_cast<std::ptrdiff_t>(state.size())) {
      record_.around.push_back({std::nan(""), std::nan("")});
      continue;
    }
    // At the node itself the traction rises to the strength, interpolated as the others.
    const double p = previous_p_Pa_[i] + part * (state.p_Pa[i] - previous_p_Pa_[i]);
    const double strength = strength_before + part * (strength_now - strength_before);
    const double t = k == 0 ? std::copysign(strength, state.t_Pa[i])
                            : previous_t_Pa_[i] + part * (state.t_Pa[i] - previous_t_Pa_[i]);
    record_.around.push_back({t, p});
  }
}

fronts::SlipRecord Recorder::take(double end_time_s) {
  record_.end_time_s = end_time_s;
  // Onsets within one (sub-)step come in the order of nodes: put them in the order of time.
  std::vector<std::size_t> order(record_.onsets.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return record_.onsets[k].time_s; });
  fronts::SlipRecord sorted = record_;
  const std::size_t n = 2 * static_cast<std::size_t>(record_.halo) + 1;
  for (std::size_t k = 0; k < order.size(); ++k) {
    sorted.onsets[k] = record_.onsets[order[k]];
    std::ranges::copy(record_.around_onset(order[k]),
                      sorted.around.begin() + static_cast<std::ptrdiff_t>(k * n));
  }
  return sorted;
}

}  // namespace slipfront::solve
