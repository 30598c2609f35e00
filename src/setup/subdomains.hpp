// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "motion/distributed_stepper.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "setup/initial_state.hpp"

namespace slipfront::setup {

/// Refuses what so many ranks cannot share; builds the meshes for it.
/// @throws UserError
void require_divisible(const Problem& problem, const Processes& processes);

/// The bodies without their motion, and their probes, each rank with its subdomain. Collective.
/// @param initial  on rank 0; the others get all of it but meshes and displacements
/// @throws UserError where the plate is too narrow for so many
std::unique_ptr<motion::DistributedStepper> new_distributed_stepper(const Problem& problem,
                                                                    InitialState& initial,
                                                                    Processes& processes,
                                                                    const motion::Execution& execution);

/// The bodies of a case; their interfaces may be all that is held.
class GlobalBodies {
 public:
  GlobalBodies(const Problem& problem, const mesh::Mesh& plate, const std::optional<mesh::Mesh>& base);
  GlobalBodies(const GlobalBodies&) = delete;
  GlobalBodies& operator=(const GlobalBodies&) = delete;

  std::span<const motion::BodySource> bodies() const { return bodies_; }
  const mesh::Mesh& plate() const { return bodies_.front().mesh; }
  std::vector<motion::BodySteps> steps() const;
  /// @throws UserError where so many ranks cannot share them
  motion::Partition divided(int n_processes, std::span<const motion::BodySteps> steps) const;

 private:
  const Problem& problem_;
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
IsolatedSubdomain make_isolated_subdomain(const Problem& problem, const mesh::Mesh& interface,
                                          const std::vector<motion::BodySteps>& steps, solid::Span columns);

}  // namespace slipfront::setup
