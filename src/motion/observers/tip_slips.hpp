// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "motion/observer.hpp"
#include "record/tip_slip.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Keeps slip behind the tips of slip, at an interval.
class TipSlips final : public Observer {
 public:
  TipSlips(const statics::Equilibrium& before, double interval_s);

  const record::TipSlip& record() const { return record_; }

  void at_update(const SlipUpdate& seen) override;
  bool wants_row(const Now& now) const override { return every_.is_due(now); }
  void take_row(const record::History& row) override;

  const char* name() const override { return "tip slips"; }
  void archive(StateArchive& archive) override;
  void restored(Pause& pause) override;

 private:
  bool slips_by(std::ptrdiff_t node, double time_s) const;
  void add(const record::History& row, std::ptrdiff_t node, int direction);

  Every every_;
  record::TipSlip record_;
  std::vector<double> onset_s_;      ///< first one, or none_s. [nodes]
  std::vector<std::int32_t> fresh_;  ///< nodes whose first onset no row has passed
};

/// Slip behind the tips at all rows of a history, in which a node slips while |slip rate| is above
/// threshold_m_per_s.
/// @pre matrices of matching sizes
record::TipSlip tip_slip_from_history(const record::History& history, double threshold_m_per_s);

}  // namespace slipfront::motion
