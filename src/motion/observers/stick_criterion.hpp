// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "base/numbers.hpp"
#include "motion/observer.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Share of the rate scale, see slip_rate_scale_m_per_s: some nanometres a second, less than where slip
/// begins by any margin of the load that counts.
inline constexpr double stuck_slip_fraction = 1e-9;

/// A part of the interface, m.
struct Interval {
  double from_m = 0, to_m = 0;
};

/// Criterion of the end of an event that equilibria follow: all nodes of a stretch have stuck for some time,
/// whatever waves are left, and none slips faster than equilibria may. Beside the stretch, at the edges of
/// contact, equilibria slip as well. Damped slip may fade without a stop: slow enough, it counts as stuck.
class StickCriterion final : public Observer {
 public:
  /// @param state  in which the event begins, all nodes sticking
  /// @param stuck_m_per_s  slip rate up to which all nodes count as stuck
  /// @param slow_m_per_s   slip rate up to which equilibria may slip
  StickCriterion(const statics::Equilibrium& state, const Interval& stretch, double quiet_s,
                 double stuck_m_per_s, double slow_m_per_s = infinity);

  void at_update(const SlipUpdate& seen) override;
  bool after_step(const Now& now, const SlipRates& rates) override;
  std::int64_t guaranteed_steps(const Now& now) const override;
  std::optional<End> end(Pause& pause) override;

  const char* name() const override { return "stick"; }
  void archive(StateArchive& archive) override { archive(is_slipping_, since_s_); }
  void restored(Pause& pause) override;

 private:
  bool is_at_rest(const Now& now) const { return now.time_s() - since_s_ > quiet_s_; }

  std::vector<std::uint8_t> is_within_;
  std::vector<std::uint8_t> is_slipping_;  ///< [nodes] of those within
  std::int64_t n_slipping_ = 0;            ///< the number of these
  double quiet_s_, stuck_m_per_s_, slow_m_per_s_;
  double since_s_ = 0;  ///< since then all nodes are stuck
};

}  // namespace slipfront::motion
