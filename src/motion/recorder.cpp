// SPDX-License-Identifier: BSD-3-Clause
#include "motion/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/lanes.hpp"

namespace slipfront::motion {

namespace {

bool any_slips_faster(double speed_m_per_s, const interface::Interface& s, std::size_t first,
                      std::size_t end) {
  const auto in_lanes = [&](SimdMask slipping, SimdVector slip_rate_m_per_s) {
    return any(slipping && absolute(slip_rate_m_per_s) > speed_m_per_s);
  };
  std::size_t i = first;
  for (; i + lanes <= end; i += lanes)
    if (in_lanes(load(&s.slipping[i]), load(&s.slip_rate_m_per_s[i]))) return true;
  const int rest = static_cast<int>(end - i);
  return rest > 0 &&
         in_lanes(load_partial(&s.slipping[i], rest), load_partial(&s.slip_rate_m_per_s[i], rest));
}

}  // namespace

SlipFinder::SlipFinder(const statics::Equilibrium& before, const PerNode& mu_s, int halo,
                       double creep_m_per_s)
    : end_(before.contact.size()), halo_(halo), creep_m_per_s_(creep_m_per_s) {
  memory_.t_Pa = before.tractions.t_s_Pa;
  memory_.p_Pa = before.tractions.p_s_Pa;
  for (std::size_t i = 0; i < memory_.p_Pa.size(); ++i)
    memory_.strength_Pa.push_back(mu_s[i] * memory_.p_Pa[i]);
  for (const auto contact : before.contact) memory_.slipping.push_back(contact == statics::Contact::slip);
  count_slipping();
}

SlipFinder::SlipFinder(Memory memory, std::size_t first, std::size_t end, int halo, double creep_m_per_s)
    : memory_(std::move(memory)), first_(first), end_(end), halo_(halo), creep_m_per_s_(creep_m_per_s) {
  count_slipping();
}

void SlipFinder::count_slipping() {
  n_slipping_ = 0;
  for (std::size_t i = first_; i < end_; ++i) n_slipping_ += memory_.slipping[i];
}

void SlipFinder::find(double time_s, const interface::Interface& state, bool changed, SlipUpdate& seen) {
  seen.time_s = time_s;
  seen.changes.clear();
  seen.around.clear();
  for (std::size_t i = first_; changed && i < end_; ++i) {
    if (state.slipping[i] == memory_.slipping[i]) continue;
    SlipChange change{static_cast<std::int32_t>(i), state.slipping[i] != 0, time_s, 1};
    if (change.begins) {
      seen.around.resize(seen.around.size() + n_around());
      locate_onset(change, time_s, state, std::span(seen.around).last(n_around()));
      ++n_slipping_;
    } else {
      --n_slipping_;
    }
    seen.changes.push_back(change);
    memory_.slipping[i] = state.slipping[i];
  }
  seen.moves = n_slipping_ > 0 && any_slips_faster(creep_m_per_s_, state, first_, end_);
  std::ranges::copy(state.t_Pa, memory_.t_Pa.begin());
  std::ranges::copy(state.p_Pa, memory_.p_Pa.begin());
  std::ranges::copy(state.strength_Pa, memory_.strength_Pa.begin());
  memory_.time_s = time_s;
}

void SlipFinder::locate_onset(SlipChange& onset, double time_s, const interface::Interface& state,
                              std::span<record::Traction> around) const {
  const auto node = static_cast<std::size_t>(onset.node);
  // |t| / strength passes 1 between the last time and this one; a node without strength, open or not, has no
  // ratio to interpolate and begins to slip now.
  double part = 1;
  const double strength_before = memory_.strength_Pa[node], strength_now = state.strength_Pa[node];
  if (strength_before > 0 && strength_now > 0 && time_s > memory_.time_s) {
    const double before = std::abs(memory_.t_Pa[node]) / strength_before;
    const double now = state.trial_traction_Pa[node] / strength_now;
    if (now > before) part = std::clamp((1 - before) / (now - before), 0.0, 1.0);
  }
  for (int k = -halo_; k <= halo_; ++k) {
    auto& at = around[static_cast<std::size_t>(k + halo_)];
    const auto i = static_cast<std::ptrdiff_t>(node) + k;
    if (i < static_cast<std::ptrdiff_t>(first_) || i >= static_cast<std::ptrdiff_t>(end_)) {
      at = {std::nan(""), std::nan("")};
      continue;
    }
    at = traction_between({memory_.t_Pa[i], memory_.p_Pa[i]}, {state.t_Pa[i], state.p_Pa[i]}, part);
    // At the node itself the traction rises to the strength, interpolated as the others.
    const double strength = strength_before + part * (strength_now - strength_before);
    if (k == 0) at.t_Pa = std::copysign(strength, state.t_Pa[i]);
  }
  onset.time_s = memory_.time_s + part * (time_s - memory_.time_s);
  onset.share = part;
}

Recorder::Recorder(const statics::Equilibrium& before, const PerNode& mu_s, int halo, double creep_m_per_s)
    : finder_(before, mu_s, halo, creep_m_per_s) {
  record_.x_m = before.tractions.x_m;
  record_.halo = halo;
  n_slipping_ = static_cast<std::size_t>(std::ranges::count(before.contact, statics::Contact::slip));
  has_slipped_.assign(record_.x_m.size(), 0);
  waiting_.resize(record_.x_m.size());
  around_waiting_.resize(record_.x_m.size() * n_around());
}

void Recorder::observe(double time_s, const interface::Interface& state, bool changed) {
  finder_.find(time_s, state, changed, seen_);
  consume(seen_);
}

void Recorder::consume(const SlipUpdate& seen) {
  record_.resolution_s = std::max(record_.resolution_s, seen.time_s - previous_time_s_);
  previous_time_s_ = seen.time_s;
  if (seen.moves) last_motion_s_ = seen.time_s;
  const auto for_each = [&](auto&& f) {
    std::size_t n_begun = 0;
    for (const auto& change : seen.changes) {
      std::span<const record::Traction> around;
      if (change.begins) around = std::span(seen.around).subspan(n_begun++ * n_around(), n_around());
      f(change, static_cast<std::size_t>(change.node), around);
    }
  };
  for (const auto& change : seen.changes)
    if (change.begins) {
      ++n_slipping_;
    } else {
      --n_slipping_;
    }
  const auto is_first = [&](const SlipChange& change) {
    return change.begins && has_slipped_[static_cast<std::size_t>(change.node)] == 0;
  };
  // The first onsets of this (sub-)step decide on what else of it is left out.
  std::vector<std::uint8_t>& done = is_first_;
  done.clear();
  for_each([&](const SlipChange& change, std::size_t node, std::span<const record::Traction> around) {
    done.push_back(is_first(change));
    if (!is_first(change)) return;
    add_waiting(node, record_);
    waiting_[node] = {};
    record_.onsets.push_back({change.node, change.time_s});
    record_.around.insert(record_.around.end(), around.begin(), around.end());
    last_first_onset_s_ = std::max(last_first_onset_s_, change.time_s);
    has_slipped_[node] = 1;
  });
  std::size_t k = 0;
  for_each([&](const SlipChange& change, std::size_t node, std::span<const record::Traction> around) {
    if (change.begins) last_onset_s_ = seen.time_s;
    if (done[k++] == 0) take_change(node, {change.time_s, change.begins ? onset : stop}, around);
  });
}

bool Recorder::is_possible_at(double time_s) const {
  // Times within a sub-step are rounded.
  const auto is_past = [time_s](double past_s) { return past_s <= (1 + 1e-12) * time_s; };
  const auto is_change = [&](const auto& change) { return is_past(change.time_s); };
  return std::isfinite(time_s) && record::is_consistent(record_) && n_slipping_ <= record_.x_m.size() &&
         is_past(last_motion_s_) && is_past(last_onset_s_) && is_past(previous_time_s_) &&
         is_past(last_first_onset_s_) && std::ranges::all_of(record_.onsets, is_change) &&
         std::ranges::all_of(record_.stops, is_change) && std::ranges::all_of(waiting_, is_change) &&
         std::ranges::all_of(waiting_, [](const Waiting& waiting) { return waiting.change <= stop; });
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

record::SlipRecord Recorder::record_until(double end_time_s) const {
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
