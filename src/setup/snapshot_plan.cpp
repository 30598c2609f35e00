// SPDX-License-Identifier: BSD-3-Clause
#include "setup/snapshot_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.hpp"
#include "motion/every.hpp"

namespace slipfront::setup {

namespace {

/// A time at which a snapshot is asked for, by the list or by the interval.
struct Asked {
  double time_s = 0;
  bool is_listed = true;
};

/// All of them, ascending.
std::vector<Asked> asked_snapshots(const Problem& problem, double step_s) {
  constexpr double max_snapshots = 1e7;
  std::vector<Asked> asked;
  for (const double time_s : problem.output.snapshot_times_s) asked.push_back({time_s, true});
  const double interval_s = std::max(problem.output.snapshot_interval_s, step_s);
  if (std::isinf(interval_s)) return asked;
  const double n = std::floor(problem.time.end_s / interval_s * (1 + 1e-12));
  if (n > max_snapshots)
    throw UserError("{} = {:g} s gives {:.3g} snapshots until {} = {:g} s; choose a longer one",
                    Key("output.snapshot_interval_s"), problem.output.snapshot_interval_s, n,
                    Key("time.end_s"), problem.time.end_s);
  for (double k = 0; k <= n; ++k) asked.push_back({std::min(k * interval_s, problem.time.end_s), false});
  std::ranges::stable_sort(asked, {}, &Asked::time_s);
  return asked;
}

}  // namespace

SnapshotPlan snapshot_plan(const Problem& problem, double step_s) {
  SnapshotPlan plan;
  const auto n_listed = problem.output.snapshot_times_s.size();
  std::int64_t n_late = 0, n_near = 0;
  double last_step = -1;
  for (const auto& [time_s, is_listed] : asked_snapshots(problem, step_s)) {
    const double step = motion::steps_to(time_s, step_s);
    if (time_s > problem.time.end_s) {
      ++n_late;
    } else if (step == last_step) {
      n_near += is_listed ? 1 : 0;
    } else {
      plan.times_s.push_back(time_s);
      last_step = step;
    }
  }
  if (n_late > 0)
    plan.notes.add(Diagnostic::output,
                   "{} of {} output.snapshot_times_s are left out: they are after time.end_s = {:g}", n_late,
                   n_listed, problem.time.end_s);
  if (n_near > 0)
    plan.notes.add(Diagnostic::output,
                   "{} of {} output.snapshot_times_s are left out: they fall into the step of {:.4g} s of "
                   "the time before",
                   n_near, n_listed, step_s);
  return plan;
}

std::vector<double> snapshots_after(const Problem& problem, double time_s) {
  std::vector<double> after_s;
  for (const double listed_s : problem.output.snapshot_times_s)
    if (listed_s > time_s) after_s.push_back(listed_s);
  return after_s;
}

}  // namespace slipfront::setup
