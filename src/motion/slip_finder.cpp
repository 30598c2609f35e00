// SPDX-License-Identifier: BSD-3-Clause
#include "motion/slip_finder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/lanes.hpp"
#include "base/numbers.hpp"

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
  for (std::size_t i = 0; i < memory_.p_Pa.size(); ++i) {
    const double strength_Pa = mu_s[i] * memory_.p_Pa[i];
    memory_.strength_Pa.push_back(strength_Pa);
    memory_.onset_ratio.push_back(strength_Pa > 0 ? std::abs(memory_.t_Pa[i]) / strength_Pa : 0);
  }
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
  std::ranges::copy(state.onset_ratio, memory_.onset_ratio.begin());
  memory_.time_s = time_s;
}

void SlipFinder::locate_onset(SlipChange& onset, double time_s, const interface::Interface& state,
                              std::span<record::Traction> around) const {
  const auto node = static_cast<std::size_t>(onset.node);
  // The ratio passes 1 between the last time and this one; a node without strength, open or not, has none to
  // interpolate and begins to slip now.
  double part = 1;
  const double strength_before = memory_.strength_Pa[node], strength_now = state.strength_Pa[node];
  if (strength_before > 0 && strength_now > 0 && time_s > memory_.time_s) {
    const double before = memory_.onset_ratio[node], now = state.onset_ratio[node];
    if (now > before) part = std::clamp((1 - before) / (now - before), 0.0, 1.0);
  }
  for (int k = -halo_; k <= halo_; ++k) {
    auto& at = around[static_cast<std::size_t>(k + halo_)];
    const auto i = static_cast<std::ptrdiff_t>(node) + k;
    if (i < static_cast<std::ptrdiff_t>(first_) || i >= static_cast<std::ptrdiff_t>(end_)) {
      at = {nan, nan};
      continue;
    }
    at = record::between({memory_.t_Pa[i], memory_.p_Pa[i]}, {state.t_Pa[i], state.p_Pa[i]}, part);
    // At the node itself the traction rises to the strength, interpolated as the others.
    const double strength = strength_before + part * (strength_now - strength_before);
    if (k == 0) at.t_Pa = std::copysign(strength, state.t_Pa[i]);
  }
  onset.time_s = memory_.time_s + part * (time_s - memory_.time_s);
  onset.share = part;
}

void SlipFinder::archive(StateArchive& archive) {
  archive(memory_.time_s);
  for (auto* values : {&memory_.t_Pa, &memory_.p_Pa, &memory_.strength_Pa, &memory_.onset_ratio})
    archive_vector(archive, *values);
  archive_vector(archive, memory_.slipping);
  if (archive.is_loading()) count_slipping();
}

}  // namespace slipfront::motion
