// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "input/case.hpp"
#include "mesh/mesh.hpp"
#include "motion/parted_stepper.hpp"
#include "processes/network.hpp"
#include "processes/processes.hpp"

namespace slipfront::run {

/// Refuses what so many processes cannot share; builds the meshes for it.
/// @throws UserError
void require_divisible(const input::Case& config, const Processes& processes);

/// The bodies without their motion, divided among the processes. To be called by the leader, while the others
/// are in `serve`.
/// @throws UserError where the plate is too narrow for so many
std::unique_ptr<motion::PartedStepper> new_parted_stepper(const input::Case& config, const mesh::Mesh& plate,
                                                          const std::optional<mesh::Mesh>& base,
                                                          Processes& processes,
                                                          const motion::Execution& execution);

/// While it lives the other processes do their shares of static solutions by PETSc.
class SharedStatics {
 public:
  /// @param processes  null, or all in `serve`
  explicit SharedStatics(Processes* processes);
  SharedStatics(const SharedStatics&) = delete;
  SharedStatics& operator=(const SharedStatics&) = delete;
  ~SharedStatics();

 private:
  Processes* processes_;
};

/// What the process does first that leads.
/// @throws UserError where another process is another program; all are dismissed then
void lead(Processes& processes);
/// Between each process and the next one, one after the other. To be called by the leader, as above.
std::vector<Link> measure_network(Processes& processes);
/// What the other ones do: their parts of what the leader runs, until it dismisses them.
void serve(Processes& processes);
void dismiss(Processes& processes);

}  // namespace slipfront::run
