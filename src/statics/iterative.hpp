// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "statics/bodies_on_grid.hpp"
#include "statics/multigrid.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::statics {

/// Equations of the plate, and of a base below it, on one level of the multigrid, without any matrix:
/// conjugate gradients with one multigrid cycle as preconditioner; where nodes slip, whose friction makes the
/// equations unsymmetric, BiCGStab (van der Vorst, SIAM J. Sci. Stat. Comput. 13, 631-644, 1992) with the
/// same preconditioner.
class LevelEquations {
 public:
  LevelEquations(const BodiesOnGrid& bodies, Multigrid& multigrid, threads::Team& team, int level);

  /// Fixes displacements: the loaded edge's, those that the support does not leave free, and the edge's that
  /// holds a base.
  void fix(TopConstraint constraint, const Support& support);
  /// Improves u, whose fixed displacements are right, until the rest is in equilibrium.
  /// @throws UserError where that takes too many cycles.
  void solve(double accuracy, solid::Field& u);
  /// Relative displacement of the plate at the interface. [2 interface nodes of the level]
  Eigen::VectorXd at_interface(const solid::Field& u) const;
  /// Forces on the plate that u takes at the interface. [2 interface nodes of the level]
  Eigen::VectorXd interface_forces(const solid::Field& u) const;

  const GridLevel& grid() const { return grid_; }
  const Multigrid& multigrid() const { return multigrid_; }
  int level() const { return level_; }
  mesh::Node finest(mesh::Node n) const;  ///< the finest grid's node at the place of the level's node
  const std::vector<mesh::Node>& loaded() const { return loaded_; }  ///< nodes of the loaded edge
  const std::vector<mesh::Node>& held() const { return held_; }      ///< nodes at which a base is held
  const std::vector<mesh::Node>& interface_nodes() const { return interface_nodes_; }
  const std::vector<std::size_t>& in_mesh_interface() const { return in_mesh_interface_; }

 private:
  /// Calls f(i, a_x, a_y) with row j of A p in the precision T: friction added, 0 at fixed displacements. i
  /// stands for several columns where a_x is a vector.
  template <class T, class P, class F>
  void for_products(int j, const Rows<const P>& p, F&& f) const;
  /// r = -A u; returns u . K u.
  double start_residual(const solid::Field& u);
  /// direction = z + beta direction; returns direction . A direction.
  double next_direction(double beta);
  /// u += step z, r -= step A z; returns the new r . shadow, where there is one.
  double take_step(double step, const GridField<float>& z, solid::Field& u);
  void add_z(solid::Field& u);
  void conjugate_gradients(double accuracy, solid::Field& u);
  void bicgstab(double accuracy, solid::Field& u);
  // Of bicgstab, with v = product_:
  /// direction = shadow = r; returns r . shadow.
  double start_shadow();
  /// direction = r + beta (direction - omega v).
  void next_direction(double beta, double omega);
  /// v = A z; returns v . shadow.
  double multiply_z();
  /// That for which r - step A z is smallest.
  double best_step_along_z();
  /// Calls f(row) -> two terms for all rows and returns the sums of the terms.
  template <class F>
  std::array<double, 2> sum_rows(F&& f);

  /// What a thread needs for its sweeps.
  struct Workspace {
    RowRing<float> direction;
    RowsBeside<float> beside;
  };

  const BodiesOnGrid& bodies_;
  Multigrid& multigrid_;
  threads::Team& team_;
  int level_;
  const GridLevel& grid_;
  int parts_;
  std::vector<mesh::Node> interface_nodes_, loaded_, held_;  ///< the level's nodes
  std::vector<std::size_t> in_mesh_interface_;  ///< [interface nodes] places in mesh.interface_nodes
  std::vector<std::array<float, 4>> blocks_f_;
  std::vector<std::uint8_t> fixed_;  ///< [block rows] bit 0: x, bit 1: y
  std::vector<double> slip_;         ///< [block rows] factor of f_y, 0 where the node does not slip
  std::vector<float> slip_f_;
  bool slips_ = false;
  std::vector<Workspace> workspace_;            ///< [threads]
  std::vector<std::array<double, 2>> row_sum_;  ///< [rows]
  /// The residual is that of u up to rounding in double precision, since both change by the same step of the
  /// same direction, however the direction was rounded.
  solid::Field residual_;
  GridField<float> direction_, shadow_, product_;
};

/// Equilibria by LevelEquations. Coarser levels with enough interface nodes give first guesses.
class IterativeSolver : public PlateSolver {
 public:
  IterativeSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base,
                  int threads = threads::Team::processors());

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, EdgeMotion motion,
                                      const DisplacementOfBodies* start, int level) override;
  std::int64_t n_unknowns() const override { return n_unknowns_; }
  double bytes() const override;
  bool iterates() const override { return true; }
  int n_cycles() const override { return multigrid_.n_cycles(); }
  int n_levels() const override { return n_levels_; }
  std::vector<std::size_t> interface_of(int level) const override;

  const BodiesOnGrid& bodies() const { return bodies_; }
  Multigrid& multigrid() { return multigrid_; }
  threads::Team& team() { return team_; }

 private:
  std::vector<double> gap_m_;  ///< [interface nodes]
  BodiesOnGrid bodies_;
  threads::Team team_;
  Multigrid multigrid_;
  std::int64_t n_unknowns_ = 0;
  int n_levels_ = 1;
};

}  // namespace slipfront::statics
