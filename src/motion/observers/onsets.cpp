// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/onsets.hpp"

#include <algorithm>
#include <numeric>

namespace slipfront::motion {

Onsets::Onsets(const std::vector<double>& x_m, int halo) {
  record_.x_m = x_m;
  record_.halo = halo;
  has_slipped_.assign(x_m.size(), 0);
  waiting_.resize(x_m.size());
  around_waiting_.resize(x_m.size() * n_around());
}

void Onsets::at_update(const SlipUpdate& seen) {
  record_.resolution_s = std::max(record_.resolution_s, seen.time_s - previous_time_s_);
  previous_time_s_ = seen.time_s;
  const auto for_each = [&](auto&& f) {
    std::size_t n_begun = 0;
    for (const auto& change : seen.changes) {
      std::span<const record::Traction> around;
      if (change.begins) around = std::span(seen.around).subspan(n_begun++ * n_around(), n_around());
      f(change, static_cast<std::size_t>(change.node), around);
    }
  };
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
    if (done[k++] == 0) take_change(node, {change.time_s, change.begins ? onset : stop}, around);
  });
}

void Onsets::archive(StateArchive& archive) {
  const auto x_m = record_.x_m;
  const int halo = record_.halo;
  archive(record_, previous_time_s_, last_first_onset_s_);
  require_possible(record_.x_m == x_m && record_.halo == halo, "a slip record");
  archive_vector(archive, has_slipped_);
  archive_vector(archive, waiting_);
  archive_vector(archive, around_waiting_);
}

void Onsets::restored(Pause& pause) {
  // Times within a sub-step are rounded.
  const double now_s = (1 + 1e-12) * pause.now().time_s();
  const auto is_change = [&](const auto& change) { return change.time_s <= now_s; };
  require_possible(
      record::is_consistent(record_) && previous_time_s_ <= now_s && last_first_onset_s_ <= now_s &&
          std::ranges::all_of(record_.onsets, is_change) && std::ranges::all_of(record_.stops, is_change) &&
          std::ranges::all_of(waiting_, is_change) &&
          std::ranges::all_of(waiting_, [](const Waiting& waiting) { return waiting.change <= stop; }),
      "a slip record");
}

void Onsets::take_change(std::size_t node, const Waiting& change, std::span<const record::Traction> around) {
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

void Onsets::add_waiting(std::size_t node, record::SlipRecord& record) const {
  const auto& waiting = waiting_[node];
  const auto id = static_cast<std::int32_t>(node);
  if (waiting.change == stop) record.stops.push_back({id, waiting.time_s});
  if (waiting.change != onset) return;
  record.onsets.push_back({id, waiting.time_s});
  const auto first = around_waiting_.begin() + static_cast<std::ptrdiff_t>(node * n_around());
  record.around.insert(record.around.end(), first, first + static_cast<std::ptrdiff_t>(n_around()));
}

record::SlipRecord Onsets::record_until(double end_time_s) const {
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
