// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/tip_slips.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/numbers.hpp"

namespace slipfront::motion {

namespace {
constexpr double never_s = std::numeric_limits<double>::max();
}

TipSlips::TipSlips(const statics::Equilibrium& before, double interval_s) : every_(interval_s) {
  record_.steps_behind = record::default_steps_behind();
  for (const auto contact : before.contact)
    onset_s_.push_back(contact == statics::Contact::slip ? 0 : never_s);
}

void TipSlips::at_update(const SlipUpdate& seen) {
  for (const auto& change : seen.changes) {
    auto& onset_s = onset_s_[static_cast<std::size_t>(change.node)];
    if (!change.begins || onset_s != never_s) continue;
    onset_s = change.time_s;
    fresh_.push_back(change.node);
  }
}

bool TipSlips::slips_by(std::ptrdiff_t node, double time_s) const {
  return onset_s_[static_cast<std::size_t>(node)] <= time_s;
}

void TipSlips::take_row(const record::History& row) {
  const double time_s = row.time_s.front();
  const auto passed =
      std::stable_partition(fresh_.begin(), fresh_.end(), [&](auto node) { return !slips_by(node, time_s); });
  const auto last = std::ssize(onset_s_) - 1;
  for (auto at = passed; at != fresh_.end(); ++at) {
    if (*at < last && !slips_by(*at + 1, time_s)) add(row, *at, 1);
    if (*at > 0 && !slips_by(*at - 1, time_s)) add(row, *at, -1);
  }
  fresh_.erase(passed, fresh_.end());
}

void TipSlips::add(const record::History& row, std::ptrdiff_t node, int direction) {
  record_.time_s.push_back(row.time_s.front());
  record_.node.push_back(static_cast<std::int32_t>(node));
  record_.direction.push_back(direction);
  std::ptrdiff_t at = node;
  bool has_slipped = true;
  for (const auto steps : record_.steps_behind) {
    for (const auto goal = node - direction * steps; has_slipped && at != goal;) {
      at -= direction;
      has_slipped = at >= 0 && at < std::ssize(onset_s_) && slips_by(at, row.time_s.front());
    }
    record_.slip_m.push_back(has_slipped ? row.slip_m[static_cast<std::size_t>(at)] : nan);
  }
}

void TipSlips::archive(StateArchive& archive) {
  const auto steps = record_.steps_behind;
  archive(record_);
  require_possible(record_.steps_behind == steps, "slip behind tips");
  archive_vector(archive, onset_s_);
  archive(fresh_);
}

void TipSlips::restored(Pause& pause) {
  const auto n = record_.n_rows();
  const auto is_node = [&](auto node) { return node >= 0 && node < std::ssize(onset_s_); };
  require_possible(
      record_.node.size() == n && record_.direction.size() == n &&
          record_.slip_m.size() == n * record_.steps_behind.size() &&
          std::ranges::all_of(record_.node, is_node) && std::ranges::all_of(fresh_, is_node) &&
          std::ranges::all_of(record_.direction, [](int d) { return d == 1 || d == -1; }) &&
          std::ranges::all_of(record_.time_s, [&](double t) { return t <= pause.now().time_s(); }),
      "slip behind tips");
}

record::TipSlip tip_slip_from_history(const record::History& history, double threshold_m_per_s) {
  const std::size_t n = history.x_m.size();
  statics::Equilibrium before;
  before.contact.assign(n, statics::Contact::stick);
  TipSlips observer(before, 0);
  for (std::size_t row = 0; row < history.time_s.size(); ++row) {
    SlipUpdate seen;
    seen.time_s = history.time_s[row];
    for (std::size_t i = 0; i < n; ++i)
      if (std::abs(history.slip_rate_m_per_s[row * n + i]) > threshold_m_per_s)
        seen.changes.push_back({static_cast<std::int32_t>(i), true, seen.time_s});
    observer.at_update(seen);
    record::History at_row;
    at_row.time_s = {seen.time_s};
    const auto* slip_m = history.slip_m.data() + row * n;
    at_row.slip_m.assign(slip_m, slip_m + n);
    observer.take_row(at_row);
  }
  return observer.record();
}

}  // namespace slipfront::motion
