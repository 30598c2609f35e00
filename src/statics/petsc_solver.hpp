// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processes/processes.hpp"
#include "statics/distributed_field.hpp"
#include "statics/petsc_equations.hpp"
#include "statics/plate_solver.hpp"
#include "statics/subdomains.hpp"

namespace slipfront::statics {

/// One process's share in PETSc's equations.
class PetscSubdomain {
 public:
  /// @param kept  where it keeps what is found
  explicit PetscSubdomain(DistributedFields& kept) : kept_(kept) {}

  enum class Command : int { build, begin, solve, keep, gather, forget, drop, release };
  /// Carries out a command that all are given at the same time, but for release.
  MessageBuffer execute(Command command, MessageBuffer& given);
  int n_iterations() const { return equations_->n_iterations(); }

 private:
  void build(const Subdomain& subdomain);
  void begin(MessageBuffer& given);

  DistributedFields& kept_;
  std::unique_ptr<PetscEquations> equations_;
  std::int32_t first_ = 0;
  std::vector<double> x_m_, y_m_;  ///< [own pairs] of the plate's nodes; 0 for those of a base
  std::vector<Subdomain::Place> top_;
};

/// Equilibria by PetscEquations: the leader's end, which divides the bodies, gives all processes the same
/// commands and puts together what they answer. Contact states remain its own.
class PetscSolver : public PlateSolver {
 public:
  PetscSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base, const SharedBy& shared);
  ~PetscSolver() override;

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, EdgeMotion motion,
                                      const DisplacementOfBodies* start, int level) override;
  std::int64_t n_unknowns() const override { return n_unknowns_; }
  double bytes() const override;
  bool iterates() const override { return true; }
  int n_cycles() const override { return share_.n_iterations(); }
  int n_levels() const override { return 1; }
  std::vector<std::size_t> interface_of(int) const override;

 private:
  friend class PetscLoadCase;
  using Command = PetscSubdomain::Command;

  struct Edge {
    double from_m = 0, to_m = 0, y_m = 0;
  };
  static Edge loaded_edge(const mesh::Mesh& plate, std::span<const mesh::Plate> plates);

  /// Gives each process a buffer, carries out the own share and shows all answers, one by one.
  void ask(
      Command command, const std::function<MessageBuffer(int rank)>& given,
      const std::function<void(int rank, MessageBuffer& answer)>& take = [](int, MessageBuffer&) {});

  const mesh::Mesh& plate_;
  PartitionedBodies divided_;
  Processes* processes_;
  bool gathers_;
  DistributedFields own_kept_;  ///< where it gathers
  PetscSubdomain share_;
  Edge loaded_;
  std::vector<std::vector<std::int32_t>>
      interface_nodes_;  ///< [subdomains] places in mesh.interface_nodes of each
  std::int64_t n_unknowns_ = 0;
};

/// What the other processes do while the leader has a PetscSolver, until it releases them.
/// @param kept  where this one keeps its share of what is found
void serve_statics(Processes& processes, DistributedFields& kept);
void release_statics(Processes& processes);

}  // namespace slipfront::statics
