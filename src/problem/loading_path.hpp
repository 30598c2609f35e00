// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "input/case.hpp"

namespace slipfront::problem {

/// Where along x the loading of a sequence has brought the top edge, the pusher or the machine, over the time
/// since normal loading: sequence.times_s and shears_m, linear between, or at a constant speed.
class LoadingPath {
 public:
  LoadingPath(const input::Sequence& sequence, double shear_speed_m_per_s);

  /// The loading's: sequence.end_s, and at most the last of the times.
  double end_s() const { return end_s_; }
  double shear_m(double time_s) const;
  /// The first time at which it is there, at least `after_s`; infinite where it never is.
  double time_s(double shear_m, double after_s) const;
  /// Where the straight part ends that begins at a time, at most at end_s.
  double part_end_s(double time_s) const;
  /// Speed from a place at a time to where the path is at the end of that part.
  double speed_m_per_s(double time_s, double shear_m) const;
  double fastest_m_per_s() const;

 private:
  double speed_m_per_s_;
  std::vector<double> times_s_, shears_m_;  ///< from 0 on; empty at a constant speed
  double end_s_;
};

}  // namespace slipfront::problem
