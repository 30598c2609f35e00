// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/stick_criterion.hpp"

#include <algorithm>

namespace slipfront::motion {

StickCriterion::StickCriterion(const statics::Equilibrium& state, const Interval& stretch, double quiet_s,
                               double stuck_m_per_s, double slow_m_per_s)
    : is_slipping_(state.contact.size()),
      quiet_s_(quiet_s),
      stuck_m_per_s_(stuck_m_per_s),
      slow_m_per_s_(slow_m_per_s) {
  for (const double x_m : state.tractions.x_m)
    is_within_.push_back(x_m >= stretch.from_m && x_m <= stretch.to_m ? 1 : 0);
}

void StickCriterion::at_update(const SlipUpdate& seen) {
  for (const auto& change : seen.changes) {
    const auto node = static_cast<std::size_t>(change.node);
    if (is_within_[node] == 0) continue;
    is_slipping_[node] = change.begins ? 1 : 0;
    n_slipping_ += change.begins ? 1 : -1;
    since_s_ = seen.time_s;
  }
}

bool StickCriterion::after_step(const Now& now, const SlipRates& rates) {
  if ((n_slipping_ > 0 && rates.fastest_slipping_m_per_s > stuck_m_per_s_) ||
      rates.fastest_in_contact_m_per_s > slow_m_per_s_)
    since_s_ = now.time_s();
  return !is_at_rest(now);
}

std::int64_t StickCriterion::guaranteed_steps(const Now& now) const {
  // A step less, since the sum may be rounded up.
  return std::max<std::int64_t>(steps_until(now, since_s_ + quiet_s_) - 1, 1);
}

std::optional<End> StickCriterion::end(Pause& pause) {
  if (!is_at_rest(pause.now())) return {};
  return End{EventEnd::quiet};
}

void StickCriterion::restored(Pause& pause) {
  require_possible(
      is_slipping_.size() == is_within_.size() && since_s_ >= 0 && since_s_ <= pause.now().time_s(),
      "times of slip");
  n_slipping_ = std::ranges::count(is_slipping_, 1);
}

}  // namespace slipfront::motion
