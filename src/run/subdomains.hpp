// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "input/case.hpp"
#include "mesh/mesh.hpp"
#include "motion/distributed_stepper.hpp"
#include "processes/network.hpp"
#include "processes/processes.hpp"
#include "statics/distributed_field.hpp"

namespace slipfront::run {

/// Refuses what so many processes cannot share; builds the meshes for it.
/// @throws UserError
void require_divisible(const input::Case& config, const Processes& processes);

/// The bodies without their motion, divided among the processes. To be called by the leader, while the others
/// are in `serve`.
/// @param kept  this process's share of the displacements before the event; null where they are gathered
/// @throws UserError where the plate is too narrow for so many
std::unique_ptr<motion::DistributedStepper> new_distributed_stepper(
    const input::Case& config, const mesh::Mesh& plate, const std::optional<mesh::Mesh>& base,
    Processes& processes, const motion::Execution& execution, statics::DistributedFields* kept = nullptr);

/// The bodies that processes are to divide among themselves; their interfaces may be all that is held.
class GlobalBodies {
 public:
  GlobalBodies(const input::Case& config, const mesh::Mesh& plate, const std::optional<mesh::Mesh>& base);
  GlobalBodies(const GlobalBodies&) = delete;
  GlobalBodies& operator=(const GlobalBodies&) = delete;

  std::span<const motion::BodySource> bodies() const { return bodies_; }
  const mesh::Mesh& plate() const { return bodies_.front().mesh; }
  std::vector<motion::BodySteps> steps() const;
  /// @throws UserError where so many processes cannot share them
  motion::Partition divided(int n_processes, std::span<const motion::BodySteps> steps) const;

 private:
  const input::Case& config_;
  solid::Material base_material_;
  std::optional<mesh::Mesh> corners_;  ///< of a plate of which the interface alone is held
  std::vector<motion::BodySource> bodies_;
};

/// Some columns of the bodies as a subdomain has them, without neighbours: to be timed.
struct IsolatedSubdomain {
  mesh::Mesh plate;
  std::optional<mesh::Mesh> base;
  std::unique_ptr<motion::Stepper> stepper;
};
/// @param interface  of the plate, or all of it
/// @param steps      of the whole bodies
IsolatedSubdomain make_isolated_subdomain(const input::Case& config, const mesh::Mesh& interface,
                                          const std::vector<motion::BodySteps>& steps, solid::Span columns);

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
/// Between each process and the next one, then between the leader and each other one, one after the other. To
/// be called by the leader, as above.
std::vector<Link> measure_network(Processes& processes);
/// What the other ones do: their subdomains of what the leader runs, until it dismisses them.
void serve(Processes& processes);
void dismiss(Processes& processes);

}  // namespace slipfront::run
