// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "fronts/front.hpp"

namespace slipfront::fronts {

/// The nodes a front passes, in the order of travel; the first is where it nucleates.
struct Path {
  int direction = 0;  ///< +1 or -1 along x
  std::vector<int> nodes;
  End end = End::record_end;
};

/// Calls a function once in so many pieces of work, such as nodes; one that throws ends the work.
class Pauses {
 public:
  explicit Pauses(const std::function<void()>& pause) : pause_(pause) {}
  void count() {
    if (++n_ % every == 0 && pause_) pause_();
  }

 private:
  static constexpr long every = 4096;
  const std::function<void()>& pause_;
  long n_ = 0;
};

/// Nodes no farther apart than this are within options.min_length_m: with an allowance for the rounding of
/// positions, so that a whole number of elements does not fall on either side by chance.
double reach_m(const FrontOptions& options);

/// Orders first onsets into paths, as find_fronts says; paths of any length, in the order of nucleation, the
/// left-going one of a pair first.
/// @param x_m            [nodes] ascending
/// @param first_onset_s  [nodes] infinite where a node never slips
/// @param p_s_Pa         [nodes] pressure before the event, to tell the end of contact
std::vector<Path> trace_paths(std::span<const double> x_m, std::span<const double> first_onset_s,
                              std::span<const double> p_s_Pa, double end_time_s, const FrontOptions& options);

}  // namespace slipfront::fronts
