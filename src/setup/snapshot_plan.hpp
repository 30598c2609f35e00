// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/diagnostic.hpp"
#include "problem/problem.hpp"

namespace slipfront::setup {

/// Snapshots that a run takes.
struct SnapshotPlan {
  std::vector<double> times_s;
  Diagnostics notes;  ///< which times are left out, and why
};

/// The times of output.snapshot_times_s and the multiples of output.snapshot_interval_s. Leaves out those
/// that a run does not reach, and those that fall into the step of an earlier one.
/// @throws UserError where the interval gives more than any disk holds
SnapshotPlan snapshot_plan(const Problem& problem, double step_s);

/// Listed times of snapshots after a time.
std::vector<double> snapshots_after(const Problem& problem, double time_s);

}  // namespace slipfront::setup
