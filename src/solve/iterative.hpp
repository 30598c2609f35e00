// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "solve/multigrid.hpp"
#include "solve/plate_solver.hpp"

namespace slipfront::solve {

/// Bytes of the iterative statics at their peak.
double iterative_bytes(double n_unknowns);

/// The plate's equilibria by conjugate gradients with one multigrid cycle as preconditioner, without any
/// matrix; where nodes slip, whose friction makes the equations unsymmetric, by BiCGStab (van der Vorst, SIAM
/// J. Sci. Stat. Comput. 13, 631-644, 1992) with the same preconditioner.
class IterativeSolver : public PlateSolver {
 public:
  IterativeSolver(const mesh::Mesh& mesh, const solid::Material& material);

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, bool sheared,
                                      const solid::Field* start) override;
  std::int64_t n_unknowns() const override { return n_unknowns_; }
  double bytes() const override;
  bool iterates() const override { return true; }

  /// Fixes displacements: the loaded edge's, and those that the support does not leave free.
  void fix(TopConstraint constraint, const Support& support);
  /// Improves u, whose fixed displacements are right, until the rest is in equilibrium.
  /// @return multigrid cycles taken.
  /// @throws UserError where they do not suffice.
  int solve(double accuracy, solid::Field& u);
  /// Forces that u takes at the interface. [2 lower]
  Eigen::VectorXd interface_forces(const solid::Field& u) const;

  int n_cycles() const { return n_cycles_; }  ///< taken so far
  const Multigrid& multigrid() const { return multigrid_; }

 private:
  struct SlipRow {
    std::int32_t block_row;
    double factor;  ///< f_x + factor f_y = 0
  };
  /// q = A p for the free displacements, 0 at fixed ones; returns p . q, or p . K p of all displacements.
  template <class P>
  double multiply(const P& p, solid::Field& q, bool with_fixed);
  int conjugate_gradients(double accuracy, solid::Field& u);
  int bicgstab(double accuracy, solid::Field& u);

  const mesh::Mesh& mesh_;
  Multigrid multigrid_;
  ProductBuffer<double> buffer_;
  std::vector<std::uint8_t> fixed_;  ///< [block rows of the finest level] bit 0: x, bit 1: y
  std::vector<SlipRow> slip_;
  solid::Field residual_, direction_, product_, shadow_, second_;
  std::int64_t n_unknowns_ = 0;
  int n_cycles_ = 0;
};

}  // namespace slipfront::solve
