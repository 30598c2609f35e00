// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fronts/record.hpp"
#include "interface/interface.hpp"
#include "solve/statics.hpp"

namespace slipfront::solve {

/// Records beginnings and ends of slip while the run goes, located inside the (sub-)step.
class Recorder {
 public:
  /// @param before  the state at time 0, before the first (sub-)step; nodes that slip in it have no onset
  /// @param mu_s    coefficient at rest in that state
  /// @param creep_m_per_s  slip no faster than this does not count in last_motion_s
  /// @param halo    nodes on each side whose tractions are kept at an onset
  Recorder(const Equilibrium& before, double mu_s, int halo, double creep_m_per_s = 0);

  /// After a contact update whose tractions belong to time_s. `changed` is update_contact's answer.
  void observe(double time_s, const interface::Interface& state, bool changed);

  std::size_t n_slipping() const { return n_slipping_; }
  /// Last time at which a node slipped faster than creep; 0 before that.
  double last_motion_s() const { return last_motion_s_; }

  const fronts::SlipRecord& record() const { return record_; }
  fronts::SlipRecord take(double end_time_s);

 private:
  void add_onset(std::size_t node, double time_s, const interface::Interface& state);

  double creep_m_per_s_;
  double last_motion_s_ = 0;
  fronts::SlipRecord record_;
  double previous_time_s_ = 0;
  std::vector<double> previous_t_Pa_, previous_p_Pa_, previous_strength_Pa_;
  std::vector<std::uint8_t> previous_slipping_;
  std::size_t n_slipping_ = 0;
};

}  // namespace slipfront::solve
