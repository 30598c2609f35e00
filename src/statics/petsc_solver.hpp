// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processes/processes.hpp"
#include "statics/petsc_equations.hpp"
#include "statics/pieces.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::statics {

/// Bytes of the equations of so many unknowns at their peak, in all processes together; and of the leader
/// besides, which divides the bodies and gathers displacements. The equilibria found not.
double petsc_bytes(double n_unknowns);
double divided_bytes(double n_unknowns);

/// Equilibria by PetscEquations: the leader's end, which divides the bodies, gives all processes the same
/// commands and puts together what they answer. Contact states remain its own.
class PetscSolver : public PlateSolver {
 public:
  /// @param processes  that are in serve_statics; null for this one alone
  PetscSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base, Processes* processes);
  ~PetscSolver() override;

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, bool sheared,
                                      const DisplacementOfBodies* start, int level) override;
  std::int64_t n_unknowns() const override { return n_unknowns_; }
  double bytes() const override;
  bool iterates() const override { return true; }
  int n_cycles() const override { return equations_->n_iterations(); }
  int n_levels() const override { return 1; }
  std::vector<std::size_t> interface_of(int) const override;

 private:
  friend class PetscLoadCase;
  enum class Command : int { build, begin, solve, displacements, drop, release };
  friend void serve_statics(Processes& processes);
  friend void release_statics(Processes& processes);

  /// Gives each process its parcel, or all the same one; carries out the own share and returns all answers.
  std::vector<Parcel> ask(Command command, std::vector<Parcel> given = std::vector<Parcel>(1));
  static Parcel carry_out(Command command, Parcel& given, std::unique_ptr<PetscEquations>& equations);

  const mesh::Mesh& plate_;
  const mesh::Mesh* base_;  ///< null on the rigid plane
  DividedBodies divided_;
  Processes* processes_;
  std::vector<std::vector<std::int32_t>> lower_;  ///< [pieces] places in mesh.lower of each
  std::unique_ptr<PetscEquations> equations_;
  std::int64_t n_unknowns_ = 0;
};

/// What the other processes do while the leader has a PetscSolver, until it releases them.
void serve_statics(Processes& processes);
void release_statics(Processes& processes);

}  // namespace slipfront::statics
