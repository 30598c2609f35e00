// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/budget.hpp"
#include "input/case.hpp"
#include "processes/processes.hpp"

namespace slipfront::run {

/// Snapshots that a run takes.
struct SnapshotPlan {
  std::vector<double> times_s;
  std::vector<std::string> notes;  ///< which times are left out, and why
};

/// The times of output.snapshot_times_s and the multiples of output.snapshot_interval_s. Leaves out those
/// that a run does not reach, and those that fall into the step of an earlier one.
/// @throws UserError where the interval gives more than any disk holds
SnapshotPlan snapshot_plan(const input::Case& config, double step_s);

/// Listed times of snapshots after a time.
std::vector<double> snapshots_after(const input::Case& config, double time_s);

/// Sizes on which the needs of a run depend.
struct Size {
  double n_nodes = 0, n_cells = 0, n_interface = 0;
  double step_s = 0;
  double n_base_nodes = 0;   ///< of n_nodes those of a base
  double statics_share = 1;  ///< see statics::StaticsSize
  /// Of a run that several processes share: the nodes that those of this machine compute, over all. They tell
  /// snapshots in pieces.
  std::optional<double> parts_share = {};
  bool leads_by_interface = false, keeps_displacements = false;  ///< see there
};

/// The same from the case alone, before there is a mesh: to a few per cent, but for the step of a fillet,
/// which is shorter, and of a graded plate, which may be longer.
Size estimated_size(const input::Case& config);

/// The program, its libraries and its threads, before it has a case; those of MPI and PETSc take as much
/// again.
double program_bytes();

/// Of a node of the interface: its state, and the record of its slip.
double bytes_per_interface_node(const input::Case& config);

/// A checkpoint of several processes over that of one: it numbers its nodes.
inline constexpr double shared_checkpoint_bytes = 1.25;

/// Work, memory and space on disk that a run takes. Bytes on disk are the most that lies there at one time:
/// while they become the results, raw history and snapshots lie beside them.
struct Needs {
  std::int64_t steps = 0;       ///< to time.end_s
  std::int64_t ramp_steps = 0;  ///< where loading.method is ramp, from the critical shear of a coarse mesh
  double history_rows = 0, energy_rows = 0, snapshots = 0;
  std::vector<Budget> memory;  ///< of the stages of a run, one after the other
  double statics_bytes = 0;    ///< of it the peak of the statics
  double recorded_bytes = 0;   ///< of it rows of energies, and rows of history that wait to be written
  double history_bytes = 0, snapshot_bytes = 0, checkpoint_bytes = 0, energy_bytes = 0, probe_bytes = 0;

  double memory_bytes() const { return total_bytes(largest_of(memory)); }
  Budget disk() const;
  double disk_bytes() const { return total_bytes(disk()); }
};

/// What the leader holds of the cells at reliefs where it leads_by_interface, while the event begins.
double corner_bytes(const input::Case& config);

/// The peak of the statics, 0 without any.
double statics_bytes(const input::Case& config, const Size& size);

/// @throws UserError where more steps are asked for than any machine takes.
Needs needs(const input::Case& config, const Size& size);

/// Refuses statics by PETSc of more nodes than it can number the unknowns of.
/// @throws UserError
void require_numbers_of_petsc(const input::Case& config);

/// Refuses a case that would not fit into the memory, or has more nodes than can be numbered, before anything
/// is built; what grows with its steps is left out.
/// @param processes  that share the run, of which this one leads; null for this one alone
/// @param may_keep   see make_initial_state
/// @throws UserError naming what to change.
void require_memory_fits(const input::Case& config, const Processes* processes = nullptr,
                         bool may_keep = true);

/// Refuses a case whose run would not fit into the memory or onto the disk of `folder`, which need not exist
/// yet.
/// @param processes  as above
/// @throws UserError naming what to change.
void require_fit(const input::Case& config, const std::filesystem::path& folder,
                 const Processes* processes = nullptr, bool may_keep = true);

}  // namespace slipfront::run
