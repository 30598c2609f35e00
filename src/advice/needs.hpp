// SPDX-License-Identifier: BSD-3-Clause
// What a run takes of memory, disk and time, predicted to some 30 %.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "base/budget.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "results/outputs.hpp"
#include "statics/settings.hpp"

namespace slipfront::advice {

/// Sizes on which the needs of a run depend.
struct Size {
  double n_nodes = 0;
  double n_base_nodes = 0;  ///< of n_nodes those of a base
  double n_interface = 0;
  double step_s = 0;
};

/// Size but for the step, from the bodies' measures alone: for refusals before anything is built.
Size mesh_size(const Problem& problem);
/// Size from the case alone, before there is a mesh: to a few per cent, but for the step of a fillet,
/// which is shorter, and of a graded plate, which may be longer.
Size estimated_size(const Problem& problem);

/// Whose memory it is: of one process, or of some of several ranks.
struct Holder {
  int n_processes = 1;
  int n_here = 1;        ///< of these
  bool has_root = true;  ///< whether rank 0 is among them
};

struct Needs {
  std::int64_t steps = 0;       ///< to time.end_s
  std::int64_t ramp_steps = 0;  ///< where loading.method is ramp
  double slow_steps = 0;        ///< of slow slip to the end of the loading, or to a first event
  Budget memory;                ///< of the statics or of the event, whichever takes more
  double statics_bytes = 0;     ///< of memory, while the statics are solved
  /// On disk, with what lies there beside the results.
  double slow_bytes = 0, checkpoint_bytes = 0, energy_bytes = 0;
  std::array<results::Forecast, results::outputs.size()> of_outputs;  ///< in their order
  const results::Forecast& of(const results::Output& output) const;

  double memory_bytes() const { return total_bytes(memory); }
  Budget disk() const;
  double disk_bytes() const { return total_bytes(disk()); }
};

/// @throws UserError where more steps are asked for than any machine takes.
Needs needs(const Problem& problem, const Size& size, const Holder& holder = {});

/// Needs of the statics of a plate without a base by one process.
double statics_bytes(statics::StaticSolver solver, double n_unknowns, double n_interface);
double statics_s(statics::StaticSolver solver, double n_unknowns);

/// Needs of the motion of so many nodes, while it is made.
double motion_bytes(double n_nodes);

/// Refuses a case that would not fit into the memory, or has more nodes than can be numbered, before anything
/// is built; what grows with its steps is left out.
/// @param processes  the ranks that share the run
/// @throws UserError naming what to change.
void require_memory_fits(const Problem& problem, const Processes& processes = one_process());

/// Refuses a case whose run would not fit into the memory or onto the disk of `folder`, which need not exist
/// yet.
/// @param processes  as above
/// @throws UserError naming what to change.
void require_fit(const Problem& problem, const std::filesystem::path& folder,
                 const Processes& processes = one_process());

}  // namespace slipfront::advice
