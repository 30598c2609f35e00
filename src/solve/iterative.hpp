// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "solve/multigrid.hpp"
#include "solve/plate_solver.hpp"

namespace slipfront::solve {

/// Bytes of the iterative statics at their peak, the mesh and the equilibria included: 136 an unknown.
double iterative_bytes(double n_unknowns);

/// Equations of the plate on one level of the multigrid, without any matrix: conjugate gradients with one
/// multigrid cycle as preconditioner; where nodes slip, whose friction makes the equations unsymmetric,
/// BiCGStab (van der Vorst, SIAM J. Sci. Stat. Comput. 13, 631-644, 1992) with the same preconditioner.
class LevelEquations {
 public:
  LevelEquations(const mesh::Mesh& mesh, Multigrid& multigrid, int level);

  /// Fixes displacements: the loaded edge's, and those that the support does not leave free.
  void fix(TopConstraint constraint, const Support& support);
  /// Improves u, whose fixed displacements are right, until the rest is in equilibrium.
  /// @throws UserError where that takes too many cycles.
  void solve(double accuracy, solid::Field& u);
  /// Forces that u takes at the interface. [2 interface nodes of the level]
  Eigen::VectorXd interface_forces(const solid::Field& u) const;

  const GridLevel& grid() const { return grid_; }
  const Multigrid& multigrid() const { return multigrid_; }
  int level() const { return level_; }
  mesh::Node finest(mesh::Node n) const;  ///< node of the mesh at the place of the level's node
  const std::vector<mesh::Node>& lower() const { return lower_; }
  const std::vector<std::size_t>& in_mesh_lower() const { return in_mesh_lower_; }

 private:
  struct SlipRow {
    std::int32_t block_row;
    double factor;  ///< f_x + factor f_y = 0
  };
  /// q = A p for the free displacements, 0 at fixed ones; returns p . q, or with the forces at fixed ones.
  template <class P>
  double multiply(const P& p, solid::Field& q, bool with_fixed);
  void conjugate_gradients(double accuracy, solid::Field& u);
  void bicgstab(double accuracy, solid::Field& u);

  Multigrid& multigrid_;
  int level_;
  const GridLevel& grid_;
  std::vector<mesh::Node> lower_, top_;     ///< the level's nodes
  std::vector<std::size_t> in_mesh_lower_;  ///< [lower] places in mesh.lower
  ProductBuffer<double> buffer_;
  std::vector<std::uint8_t> fixed_;  ///< [block rows] bit 0: x, bit 1: y
  std::vector<SlipRow> slip_;
  solid::Field residual_, direction_, product_, shadow_, second_;
};

/// Equilibria by LevelEquations. Coarser levels with enough interface nodes give first guesses.
class IterativeSolver : public PlateSolver {
 public:
  IterativeSolver(const mesh::Mesh& mesh, const solid::Material& material);

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, bool sheared,
                                      const solid::Field* start, int level) override;
  std::int64_t n_unknowns() const override { return n_unknowns_; }
  double bytes() const override { return iterative_bytes(static_cast<double>(n_unknowns_)); }
  bool iterates() const override { return true; }
  int n_cycles() const override { return multigrid_.n_cycles(); }
  int n_levels() const override { return n_levels_; }
  std::vector<std::size_t> interface_of(int level) const override;

  Multigrid& multigrid() { return multigrid_; }

 private:
  const mesh::Mesh& mesh_;
  Multigrid multigrid_;
  std::int64_t n_unknowns_ = 0;
  int n_levels_ = 1;
};

}  // namespace slipfront::solve
