// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "motion/settings.hpp"
#include "statics/settings.hpp"

namespace slipfront::bench {

/// Arrays that a sweep reads and writes for every node: u_x, u_y, v_x, v_y, each once in and once out.
inline constexpr double bytes_per_node_update = 8 * sizeof(double);

struct Options {
  int threads = 2;     ///< the most that are measured
  bool large = false;  ///< also 10,000 x 5,000 cells, some 7 GB
};

/// The rate of one way to step a plate.
struct Rate {
  std::string path;
  int columns = 0, rows = 0;  ///< cells
  int threads = 1;
  int steps_per_sweep = 1;
  double node_updates_per_s = 0;
  /// What bounds it: the bandwidth for one step per sweep of a plate in memory, otherwise the stencil alone
  /// on rows in the nearest cache.
  double bound_per_s = 0;
  /// Growth of the process by this plate over its nodes; 0 where too small to measure.
  double bytes_per_node = 0;
};

/// The default case from normal loading to its fronts, nothing written.
struct EventRun {
  int columns = 0, rows = 0;
  int threads = 1;
  double statics_s = 0, event_s = 0;
  double node_updates_per_s = 0;  ///< of the event
};

/// The plate of Kammer et al. (2012), tilted and sheared to the critical, the subcritical and the
/// supercritical state.
struct StaticsRun {
  int columns = 0, rows = 0;
  std::string solver;
  double unknowns = 0;
  double wall_s = 0, processor_s = 0;
  std::int64_t cycles = 0;  ///< of the iterative solver
  double peak_bytes = 0;    ///< of the process
  double critical_shear_m = 0;
};
/// @throws UserError where the memory does not suffice.
StaticsRun measure_statics(int columns, statics::StaticSolver solver);

struct Results {
  double bandwidth_bytes_per_s = 0;  ///< of one thread, over arrays far larger than the caches
  double bandwidth_all_threads_bytes_per_s = 0;
  double stencil_alone_per_s = 0;  ///< of one thread
  std::vector<Rate> rates;
  std::vector<EventRun> events;
};

/// Measures all of it; medians of 5. `progress` receives the name of what comes next.
/// @throws UserError where the memory does not suffice.
Results measure(const Options& options, const std::function<void(const std::string&)>& progress);

}  // namespace slipfront::bench
