// SPDX-License-Identifier: BSD-3-Clause
#include "motion/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/lanes.hpp"

namespace slipfront::motion {

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

Recorder::Recorder(const statics::Equilibrium& before, const PerNode& mu_s, int halo, double creep_m_per_s)
    : creep_m_per_s_(creep_m_per_s),
      previous_t_Pa_(before.tractions.t_s_Pa),
      previous_p_Pa_(before.tractions.p_s_Pa) {
  for (std::size_t i = 0; i < previous_p_Pa_.size(); ++i)
    previous_strength_Pa_.push_back(mu_s[i] * previous_p_Pa_[i]);
  record_.x_m = before.tractions.x_m;
  record_.halo = halo;
  for (const auto contact : before.contact) {
    previous_slipping_.push_back(contact == statics::Contact::slip);
    n_slipping_ += previous_slipping_.back();
  }
  has_slipped_.assign(record_.x_m.size(), 0);
  waiting_.resize(record_.x_m.size());
  around_waiting_.resize(record_.x_m.size() * n_around());
}

void Recorder::observe(double time_s, const interface::Interface& state, bool changed) {
  record_.resolution_s = std::max(record_.resolution_s, time_s - previous_time_s_);
  if (changed) take_changes(time_s, state);
  if (n_slipping_ > 0 && any_slips_faster(creep_m_per_s_, state)) last_motion_s_ = time_s;
  std::ranges::copy(state.t_Pa, previous_t_Pa_.begin());
  std::ranges::copy(state.p_Pa, previous_p_Pa_.begin());
  std::ranges::copy(state.strength_Pa, previous_strength_Pa_.begin());
  previous_time_s_ = time_s;
}

void Recorder::take_changes(double time_s, const interface::Interface& state) {
  std::vector<record::Traction> around(n_around());
  // The first onsets of this (sub-)step decide on what else of it is left out.
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (state.slipping[i] == 0 || previous_slipping_[i] != 0 || has_slipped_[i] != 0) continue;
    add_waiting(i, record_);
    waiting_[i] = {};
    const double onset_s = locate_onset(i, time_s, state, around);
    record_.onsets.push_back({static_cast<std::int32_t>(i), onset_s});
    record_.around.insert(record_.around.end(), around.begin(), around.end());
    last_first_onset_s_ = std::max(last_first_onset_s_, onset_s);
    last_onset_s_ = time_s;
    has_slipped_[i] = 1;
    previous_slipping_[i] = 1;
    ++n_slipping_;
  }
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (state.slipping[i] == previous_slipping_[i]) continue;
    if (state.slipping[i] != 0) {
      last_onset_s_ = time_s;
      take_change(i, {locate_onset(i, time_s, state, around), onset}, around);
      ++n_slipping_;
    } else {
      take_change(i, {time_s, stop}, {});
      --n_slipping_;
    }
    previous_slipping_[i] = state.slipping[i];
  }
}

void Recorder::take_change(std::size_t node, const Waiting& change,
                           std::span<const record::Traction> around) {
  auto& waiting = waiting_[node];
  // Without both changes the node is taken to slip, or to stick, from the one to the other. First onsets yet
  // to come are no earlier than the later one: it lies in this (sub-)step, and they in later ones.
  if (waiting.change != none && last_first_onset_s_ < waiting.time_s) {
    waiting = {};
    ++record_.n_onsets_left_out;  // one of the two is an onset
    return;
  }
  add_waiting(node, record_);
  waiting = change;
  std::ranges::copy(around, around_waiting_.begin() + static_cast<std::ptrdiff_t>(node * n_around()));
}

void Recorder::add_waiting(std::size_t node, record::SlipRecord& record) const {
  const auto& waiting = waiting_[node];
  const auto id = static_cast<std::int32_t>(node);
  if (waiting.change == stop) record.stops.push_back({id, waiting.time_s});
  if (waiting.change != onset) return;
  record.onsets.push_back({id, waiting.time_s});
  const auto first = around_waiting_.begin() + static_cast<std::ptrdiff_t>(node * n_around());
  record.around.insert(record.around.end(), first, first + static_cast<std::ptrdiff_t>(n_around()));
}

double Recorder::locate_onset(std::size_t node, double time_s, const interface::Interface& state,
                              std::span<record::Traction> around) const {
  // |t| / strength passes 1 between the last time and this one; a node without strength, open or not, has no
  // ratio to interpolate and begins to slip now.
  double part = 1;
  const double strength_before = previous_strength_Pa_[node], strength_now = state.strength_Pa[node];
  if (strength_before > 0 && strength_now > 0 && time_s > previous_time_s_) {
    const double before = std::abs(previous_t_Pa_[node]) / strength_before;
    const double now = state.demand_Pa[node] / strength_now;
    if (now > before) part = std::clamp((1 - before) / (now - before), 0.0, 1.0);
  }
  for (int k = -record_.halo; k <= record_.halo; ++k) {
    auto& at = around[static_cast<std::size_t>(k + record_.halo)];
    const auto i = static_cast<std::ptrdiff_t>(node) + k;
    if (i < 0 || i >= static_cast<std::ptrdiff_t>(state.size())) {
      at = {std::nan(""), std::nan("")};
      continue;
    }
    // At the node itself the traction rises to the strength, interpolated as the others.
    const double p = previous_p_Pa_[i] + part * (state.p_Pa[i] - previous_p_Pa_[i]);
    const double strength = strength_before + part * (strength_now - strength_before);
    const double t = k == 0 ? std::copysign(strength, state.t_Pa[i])
                            : previous_t_Pa_[i] + part * (state.t_Pa[i] - previous_t_Pa_[i]);
    at = {t, p};
  }
  return previous_time_s_ + part * (time_s - previous_time_s_);
}

record::SlipRecord Recorder::take(double end_time_s) const {
  record::SlipRecord record = record_;
  for (std::size_t i = 0; i < waiting_.size(); ++i) add_waiting(i, record);
  record.end_time_s = end_time_s;
  std::ranges::stable_sort(record.stops, {}, &record::Stop::time_s);
  // Onsets within one (sub-)step, and those that waited, are not in the order of time.
  std::vector<std::size_t> order(record.onsets.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return record.onsets[k].time_s; });
  record::SlipRecord sorted = record;
  for (std::size_t k = 0; k < order.size(); ++k) {
    sorted.onsets[k] = record.onsets[order[k]];
    std::ranges::copy(record.around_onset(order[k]),
                      sorted.around.begin() + static_cast<std::ptrdiff_t>(k * n_around()));
  }
  return sorted;
}

}  // namespace slipfront::motion
